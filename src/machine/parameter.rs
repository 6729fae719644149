//! The table of all machine data: name in a machine file, ISG number, unit, range, default, and the field
//! that the parameter sets.
use super::{AccelerationUnit, AxisData, ChannelData, FilterType, MODE_LINEAR, MODE_MASTER, NO_LIMIT};

/// A row of the table: one parameter of `Target` ([`AxisData`] or [`ChannelData`]). Loaders of machine files
/// use it.
pub struct Parameter<Target> {
    /// ISG id, `P-AXIS-…` or `P-CHAN-…`; empty if ISG has none.
    pub id: &'static str,
    /// Dotted name inside its table, for example `slope_profil.a_beschl`.
    pub name: &'static str,
    /// Unit of the value in the file.
    pub unit: &'static str,
    /// Smallest value, in thousandths of the unit.
    pub min_milli: i64,
    /// Largest value, in thousandths of the unit.
    pub max_milli: i64,
    /// Whether decimals are accepted (three at most).
    pub decimals: bool,
    /// Words for the values 0, 1, … in the file; an empty list means a number.
    pub words: &'static [&'static str],
    /// Whether several words may be joined by a bar (`|`). The words then mean 1, 2, 4, … and the value is
    /// their sum. The first word must always be given.
    pub joined: bool,
    /// Stores a value given in thousandths of the unit and inside the range.
    pub set: fn(&mut Target, i64),
    /// Reads the value back, in thousandths of the unit.
    pub get: fn(&Target) -> i64,
}

macro_rules! parameters {
    ($target:ty: $($id:literal $name:literal [$unit:literal] $min:literal ..= $max:literal
        => $field:ident $([$index:literal])?),+ ; $($more:expr),* $(,)?) => {
        &[$(Parameter {
            id: $id, name: $name, unit: $unit,
            min_milli: $min * 1000, max_milli: $max * 1000, decimals: false, words: &[], joined: false,
            set: |t, milli| t.$field $([$index])? = (milli / 1000) as u32,
            get: |t| t.$field $([$index])? as i64 * 1000,
        }),+ $(, $more)*]
    };
}

/// Axis parameters, in the order of the ISG ids. [`check_axis`] checks ranges that depend on other fields:
/// accelerations up to `a_max`, ramp times from `tr_min`, speeds up to `vb_max`.
pub const AXIS: &[Parameter<AxisData>] = parameters!(AxisData:
    "P-AXIS-00001" "slope_profil.a_beschl" ["mm/s²"] 1..=100_000_000 => a_beschl,
    "P-AXIS-00002" "slope_profil.a_brems" ["mm/s²"] 1..=100_000_000 => a_brems,
    "P-AXIS-00004" "slope_profil.a_grenz" ["mm/s²"] 1..=100_000_000 => a_grenz,
    "P-AXIS-00005" "lslope_profil.a_grenz_stufe_1" ["mm/s²"] 1..=100_000_000 => a_grenz_stufe[0],
    "P-AXIS-00006" "lslope_profil.a_grenz_stufe_2" ["mm/s²"] 1..=100_000_000 => a_grenz_stufe[1],
    "P-AXIS-00008" "dynamik.a_max" ["mm/s²"] 1..=100_000_000 => a_max,
    "P-AXIS-00011" "lslope_profil.a_stufe_1" ["mm/s²"] 1..=100_000_000 => a_stufe[0],
    "P-AXIS-00012" "lslope_profil.a_stufe_2" ["mm/s²"] 1..=100_000_000 => a_stufe[1],
    "P-AXIS-00013" "dynamik.a_trans_weight" ["0.1 %"] 0..=1000 => a_trans_weight,
    "P-AXIS-00015" "kenngr.achs_mode" ["bit mask: 1 linear, 0x10000000 master axis"] 1..=0x1000_0001 => achs_mode,
    "P-AXIS-00154" "dynamik.r_trans_weight" ["0.1 %"] 0..=1000 => r_trans_weight,
    "P-AXIS-00195" "slope_profil.tr_beschl_ab" ["µs"] 1..=4_294_967_295 => tr_beschl_ab,
    "P-AXIS-00196" "slope_profil.tr_beschl_zu" ["µs"] 1..=4_294_967_295 => tr_beschl_zu,
    "P-AXIS-00197" "slope_profil.tr_brems_ab" ["µs"] 1..=4_294_967_295 => tr_brems_ab,
    "P-AXIS-00198" "slope_profil.tr_brems_zu" ["µs"] 1..=4_294_967_295 => tr_brems_zu,
    "P-AXIS-00199" "dynamik.tr_geom" ["µs"] 0..=4_294_967_295 => tr_geom,
    "P-AXIS-00200" "slope_profil.tr_grenz" ["µs"] 1..=4_294_967_295 => tr_grenz,
    "P-AXIS-00201" "dynamik.tr_min" ["µs"] 1..=4_294_967_295 => tr_min,
    "P-AXIS-00209" "vb_eilgang" ["µm/s"] 1..=2_000_000_000 => vb_eilgang,
    "P-AXIS-00211" "lslope_profil.vb_grenz_stufe_1_2" ["µm/s"] 1..=2_000_000_000 => vb_grenz_stufe_1_2,
    "P-AXIS-00212" "dynamik.vb_max" ["µm/s"] 1..=2_000_000_000 => vb_max,
    "P-AXIS-00214" "vb_max_red" ["µm/s"] 0..=2_000_000_000 => vb_max_red,
    "P-AXIS-00221" "lslope_profil.vb_stufe_1_2" ["µm/s"] 1..=2_000_000_000 => vb_stufe_1_2,
    "P-AXIS-00280" "lslope_profil.d_grenz_stufe_1" ["mm/s²"] 0..=100_000_000 => d_grenz_stufe[0],
    "P-AXIS-00281" "lslope_profil.d_grenz_stufe_2" ["mm/s²"] 0..=100_000_000 => d_grenz_stufe[1],
    "P-AXIS-00282" "lslope_profil.d_stufe_1" ["mm/s²"] 0..=100_000_000 => d_stufe[0],
    "P-AXIS-00283" "lslope_profil.d_stufe_2" ["mm/s²"] 0..=100_000_000 => d_stufe[1],
    "P-AXIS-00293" "dynamik.tr_w_min" ["µs"] 0..=4_294_967_295 => tr_w_min;
    Parameter {
        set: |t, milli| t.default_feed_axis = milli != 0,
        get: |t| t.default_feed_axis as i64 * 1000,
        ..plain("P-CHAN-00011", "default_feed_axis", "0 no, 1 the feed counts along it", 0, 1000)
    },
    zero_offset::<0>("np_grp.1.versch"),
    zero_offset::<1>("np_grp.2.versch"),
    zero_offset::<2>("np_grp.3.versch"),
    zero_offset::<3>("np_grp.4.versch"),
    zero_offset::<4>("np_grp.5.versch"),
    zero_offset::<5>("np_grp.6.versch"),
    Parameter {
        set: |t, milli| t.swe_neg = (milli / 1000) as i32,
        get: |t| t.swe_neg as i64 * 1000,
        ..software_limit("P-AXIS-00177", "kenngr.swe_neg")
    },
    Parameter {
        set: |t, milli| t.swe_pos = (milli / 1000) as i32,
        get: |t| t.swe_pos as i64 * 1000,
        ..software_limit("P-AXIS-00178", "kenngr.swe_pos")
    },
    Parameter {
        set: |t, milli| t.filter.enable = milli != 0,
        get: |t| t.filter.enable as i64 * 1000,
        ..plain("P-AXIS-00573", "filter_fir.enable", "0 off, 1 on at program start", 0, 1000)
    },
    Parameter {
        decimals: true,
        set: |t, milli| t.filter.fcut_milli = milli as u32,
        get: |t| t.filter.fcut_milli as i64,
        ..plain("P-AXIS-00585", "filter_fir.fcut", "Hz", 1000, 1_000_000_000)
    },
    Parameter {
        set: |t, milli| t.filter.kind = FilterType::of_number((milli / 1000) as u8),
        get: |t| t.filter.kind as i64 * 1000,
        ..plain("P-AXIS-00586", "filter_fir.type", FILTER_TYPES, 0, 4000)
    },
    Parameter {
        set: |t, milli| t.filter.order = (milli / 1000) as u8,
        get: |t| t.filter.order as i64 * 1000,
        ..plain("P-AXIS-00587", "filter_fir.order", "", 0, 200_000)
    },
    Parameter {
        set: |t, milli| t.filter.share = (milli / 1000) as u8,
        get: |t| t.filter.share as i64 * 1000,
        ..plain("P-AXIS-00590", "filter_fir.share", "%", 0, 100_000)
    },
    Parameter {
        set: |t, milli| t.filter.order_time_us = (milli / 1000) as u32,
        get: |t| t.filter.order_time_us as i64 * 1000,
        ..plain("P-AXIS-00591", "filter_fir.order_time", "µs", 0, 2_000_000_000)
    },
    Parameter {
        decimals: true,
        set: |t, milli| t.filter.quality_milli = milli as u16,
        get: |t| t.filter.quality_milli as i64,
        ..plain("P-AXIS-00593", "filter_fir.quality", "", 1, 1000)
    },
);

/// Highest order of a time delay.
const LONGEST_DELAY: u8 = 100;

const FILTER_TYPES: &str = "0 none, 1 moving average, 2 Gauss, 3 windowed sinc, 4 time delay";

/// The row of a software limit. A value at an end of the range means no limit.
const fn software_limit(id: &'static str, name: &'static str) -> Parameter<AxisData> {
    const LARGEST: i64 = NO_LIMIT as i64 * 1000;
    plain(id, name, "0.1 µm or 0.0001°", -LARGEST, LARGEST)
}

/// Largest zero offset, in 0.1 µm or 0.0001°: a coordinate, 100 000 mm or degrees.
const ZERO_OFFSET_MAX: i64 = 1_000_000_000;

/// The row of a zero offset, G54…G59 (`SET` 0…5).
const fn zero_offset<const SET: usize>(name: &'static str) -> Parameter<AxisData> {
    const LARGEST: i64 = ZERO_OFFSET_MAX * 1000;
    Parameter {
        set: |t, milli| t.versch[SET] = (milli / 1000) as i32,
        get: |t| t.versch[SET] as i64 * 1000,
        ..plain("P-ZERO-00003", name, "0.1 µm or 0.0001°", -LARGEST, LARGEST)
    }
}

/// Channel parameters.
pub const CHANNEL: &[Parameter<ChannelData>] = &[
    Parameter {
        set: |t, milli| t.cycle_us = (milli / 1000) as u32,
        get: |t| t.cycle_us as i64 * 1000,
        ..plain("", "cycle_us", "µs", 100_000, 10_000_000)
    },
    Parameter {
        set: |t, milli| t.look_ahead = (milli / 1000) as u32,
        get: |t| t.look_ahead as i64 * 1000,
        ..plain("P-STUP-00071", "look_ahead", "blocks", 10_000, 10_000_000)
    },
    Parameter {
        decimals: true,
        set: |t, milli| t.feedrate_factor_milli = milli as u32,
        get: |t| t.feedrate_factor_milli as i64,
        ..plain("P-CHAN-00108", "prog_start.feedrate_factor", "100: mm/min, 0.1: m/min", 1, 1_000_000)
    },
    Parameter {
        set: |t, milli| t.slope_profile = (milli / 1000) as u8,
        get: |t| t.slope_profile as i64 * 1000,
        ..plain("P-CHAN-00071", "prog_start.slope.profile", "0 STEP, 1 TRAPEZ, 2 SIN2, 3 HSC", 0, 3000)
    },
    Parameter {
        set: |t, milli| t.acceleration_weight = (milli / 1000) as u8,
        get: |t| t.acceleration_weight as i64 * 1000,
        ..plain("P-CHAN-00001", "prog_start.slope.acceleration", "0 both, 1 a_beschl, 2 a_brems", 0, 2000)
    },
    Parameter {
        set: |t, milli| t.ramp_weight = (milli / 1000) as u8,
        get: |t| t.ramp_weight as i64 * 1000,
        ..plain(
            "P-CHAN-00073",
            "prog_start.slope.ramp_time",
            "0 all, 1 tr_beschl_zu, 2 tr_beschl_ab, 3 tr_brems_zu, 4 tr_brems_ab",
            0,
            4000,
        )
    },
    Parameter {
        set: |t, milli| t.corr_v_trans_jerk = milli != 0,
        get: |t| t.corr_v_trans_jerk as i64 * 1000,
        ..plain("P-CHAN-00009", "corr_v_trans_jerk", "0 off, 1 on", 0, 1000)
    },
    Parameter {
        set: |t, milli| t.joins_named = milli != 0,
        get: |t| t.joins_named as i64 * 1000,
        ..plain(
            "P-CHAN-00451",
            "mode_implicite_sync_indp_asyn_axis",
            "a motion waits for a single axis 0 that it moves, 1 that it names",
            0,
            1000,
        )
    },
    Parameter {
        set: |t, milli| t.exact_stop_indp = (milli / 1000) as u8,
        get: |t| t.exact_stop_indp as i64 * 1000,
        ..plain(
            "P-CHAN-00297",
            "mode_exact_stop_indp_axis",
            "0 none, 1 exact stop waits for independent axes, 2 #WAIT INDP waits for all of them",
            0,
            2000,
        )
    },
    Parameter {
        set: |t, milli| t.override_weight_prog_feed = (milli / 1000) as u8,
        get: |t| t.override_weight_prog_feed as i64 * 1000,
        ..plain("P-CHAN-00066", "override_weight_prog_feed", "", 0, 2000)
    },
    Parameter {
        decimals: true,
        set: |t, milli| t.vector_acceleration_milli = milli as u64,
        get: |t| t.vector_acceleration_milli as i64,
        ..plain("P-CHAN-00002", "vector.acceleration", VECTOR_UNIT, 0, VECTOR_MAX_MILLI)
    },
    Parameter {
        decimals: true,
        set: |t, milli| t.vector_deceleration_milli = milli as u64,
        get: |t| t.vector_deceleration_milli as i64,
        ..plain("P-CHAN-00208", "vector.deceleration", VECTOR_UNIT, 1, VECTOR_MAX_MILLI)
    },
    Parameter {
        decimals: true,
        set: |t, milli| t.vector_velocity_milli = milli as u64,
        get: |t| t.vector_velocity_milli as i64,
        ..plain("P-CHAN-00090", "vector.velocity", "mm/min", 0, VECTOR_MAX_MILLI)
    },
    Parameter {
        words: &["MM_M2", "MM_S2"],
        set: |t, milli| {
            t.vector_unit = if milli == 0 { AccelerationUnit::MmMin2 } else { AccelerationUnit::MmS2 };
        },
        get: |t| (t.vector_unit == AccelerationUnit::MmS2) as i64 * 1000,
        ..plain("P-CHAN-00351", "vector.acc_dec_unit", "", 0, 1000)
    },
    Parameter {
        set: |t, milli| t.cir_radial_acc_limit = milli != 0,
        get: |t| t.cir_radial_acc_limit as i64 * 1000,
        ..plain("P-CHAN-00350", "vector.cir_radial_acc_limit", "0 lines only, 1 arcs too", 0, 1000)
    },
    Parameter {
        set: |t, milli| t.check_jerk_on_poly_path = (milli / 1000) as u8,
        get: |t| t.check_jerk_on_poly_path as i64 * 1000,
        ..plain(
            "P-CHAN-00110",
            "check_jerk_on_poly_path",
            "0 no, 1 geometric ramp time, 2 ramp times",
            0,
            2_000,
        )
    },
    Parameter {
        set: |t, milli| t.merge_chords = (milli / 1000) as u8,
        get: |t| t.merge_chords as i64 * 1000,
        ..plain("", "merge_chords", "percent of PATH_DEV", 0, 75_000)
    },
    Parameter {
        set: |t, milli| t.auto_contour_mode = (milli / 1000) as u8,
        get: |t| t.auto_contour_mode as i64 * 1000,
        ..plain(
            "P-CHAN-00239",
            "hsc.bspline.auto_contour_mode",
            "0 off, 1 every deselection, 2 those beside arcs",
            0,
            2_000,
        )
    },
    Parameter {
        words: &["FCT_DEFAULT", "FCT_PTP", "FCT_SURFACE"],
        joined: true,
        set: |t, milli| {
            let words = milli / 1000;
            (t.ptp, t.surface) = (words & 2 != 0, words & 4 != 0);
        },
        get: |t| (1 + t.ptp as i64 * 2 + t.surface as i64 * 4) * 1000,
        ..plain("P-CHAN-00600", "configuration.path_preparation.function", "", 0, 8000)
    },
    Parameter {
        set: |t, milli| t.default_index = (milli / 1000) as u8,
        get: |t| t.default_index as i64 * 1000,
        ..plain("P-ZERO-00002", "default_index", "0 G53, 1…6 G54…G59", 0, 6000)
    },
];

/// Axis parameters for dialects other than ISG's; they have no ISG ids.
#[cfg(feature = "grbl")]
pub const AXIS_FOREIGN: &[Parameter<AxisData>] = &[
    Parameter {
        set: |t, milli| t.foreign.versch[0] = (milli / 1000) as i32,
        get: |t| t.foreign.versch[0] as i64 * 1000,
        ..place("np_grp.7.versch")
    },
    Parameter {
        set: |t, milli| t.foreign.versch[1] = (milli / 1000) as i32,
        get: |t| t.foreign.versch[1] as i64 * 1000,
        ..place("np_grp.8.versch")
    },
    Parameter {
        set: |t, milli| t.foreign.versch[2] = (milli / 1000) as i32,
        get: |t| t.foreign.versch[2] as i64 * 1000,
        ..place("np_grp.9.versch")
    },
    Parameter {
        set: |t, milli| t.foreign.stored[0] = (milli / 1000) as i32,
        get: |t| t.foreign.stored[0] as i64 * 1000,
        ..place("g28")
    },
    Parameter {
        set: |t, milli| t.foreign.stored[1] = (milli / 1000) as i32,
        get: |t| t.foreign.stored[1] as i64 * 1000,
        ..place("g30")
    },
];

/// The row of a stored position of an axis.
#[cfg(feature = "grbl")]
const fn place(name: &'static str) -> Parameter<AxisData> {
    plain("", name, "0.1 µm or 0.0001°", -ZERO_OFFSET_MAX * 1000, ZERO_OFFSET_MAX * 1000)
}

/// Channel parameters for dialects other than ISG's; they have no ISG ids.
#[cfg(feature = "grbl")]
pub const CHANNEL_FOREIGN: &[Parameter<ChannelData>] = &[
    Parameter {
        set: |t, milli| t.foreign.blend_tolerance_um = (milli / 1000) as u32,
        get: |t| t.foreign.blend_tolerance_um as i64 * 1000,
        ..plain("", "blend_tolerance", "µm", 1000, 10_000_000)
    },
    Parameter {
        set: |t, milli| t.foreign.block_delete = milli != 0,
        get: |t| t.foreign.block_delete as i64 * 1000,
        ..plain("", "block_delete", "0 no, 1 lines that begin with / are left out", 0, 1000)
    },
    Parameter {
        set: |t, milli| t.foreign.optional_stop = milli != 0,
        get: |t| t.foreign.optional_stop as i64 * 1000,
        ..plain("", "optional_stop", "0 no, 1 M1 pauses", 0, 1000)
    },
];

/// Channel parameters of the interpolator's functions for a PLC. The second names of these parameters are
/// those of ISG's start-up data.
#[cfg(feature = "plc")]
pub const CHANNEL_PLC: &[Parameter<ChannelData>] = &[
    Parameter {
        words: super::INTERPOLATOR_FUNCTIONS,
        set: |t, milli| {
            t.interpolator.functions = super::InterpolatorFunctions::of_bits((milli / 1000) as u32);
            if let Some(blocks) = t.interpolator.functions.look_ahead() {
                t.look_ahead = blocks;
            }
        },
        get: |t| t.interpolator.functions.bits() as i64 * 1000,
        ..plain("P-CHAN-00650", "configuration.interpolator.function", "", 0, 65_535_000)
    },
    Parameter {
        set: |t, milli| t.interpolator.log_max = (milli / 1000) as u32,
        get: |t| t.interpolator.log_max as i64 * 1000,
        ..plain(
            "P-CHAN-00658",
            "configuration.interpolator.contour_lookahead_log_max",
            "elements",
            0,
            LARGEST_UNS32,
        )
    },
    Parameter {
        set: |t, milli| t.interpolator.fb_storage_size = (milli / 1000) as u32,
        get: |t| t.interpolator.fb_storage_size as i64 * 1000,
        ..plain("P-STUP-00033", "fb_storage_size", "bytes", 0, LARGEST_UNS32)
    },
    Parameter {
        set: |t, milli| t.interpolator.late_sync_ready = milli != 0,
        get: |t| t.interpolator.late_sync_ready as i64 * 1000,
        ..plain("P-CHAN-00033", "prog_start.late_sync_ready", "", 0, 1000)
    },
];

#[cfg(feature = "plc")]
const LARGEST_UNS32: i64 = u32::MAX as i64 * 1000;

const VECTOR_UNIT: &str = "mm/min² or mm/s², by vector.acc_dec_unit";
/// Largest path limit, in thousandths: 2·10^9. ISG gives no bound for this value.
const VECTOR_MAX_MILLI: i64 = 2_000_000_000_000;

/// The row of a parameter with whole numbers. The caller replaces `set` and `get`.
const fn plain<Target>(
    id: &'static str,
    name: &'static str,
    unit: &'static str,
    min_milli: i64,
    max_milli: i64,
) -> Parameter<Target> {
    Parameter {
        id,
        name,
        unit,
        min_milli,
        max_milli,
        decimals: false,
        words: &[],
        joined: false,
        set: |_, _| {},
        get: |_| 0,
    }
}

/// A parameter of the machine data has a value outside its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RangeError {
    /// ISG id of the parameter.
    pub id: &'static str,
    /// Name of the parameter.
    pub name: &'static str,
    /// The value in the machine data, in the unit of its field.
    pub value: i64,
    /// The smallest permitted value.
    pub min: i64,
    /// The largest permitted value.
    pub max: i64,
    /// What sets the range: another parameter, or a reason in words.
    pub because: &'static str,
}

/// Checks the range of every parameter of an axis, and the ranges that depend on other parameters.
///
/// # Errors
/// Returns the first parameter out of its range.
pub fn check_axis(axis: &AxisData) -> Result<(), RangeError> {
    check_all(axis, AXIS)?;
    let shortest = (axis.tr_min, "dynamik.tr_min");
    check_between(axis, "slope_profil.a_", None, (axis.a_max, "dynamik.a_max"))?;
    check_between(axis, "slope_profil.tr_", Some(shortest), (u32::MAX, "its range"))?;
    check_between(axis, "vb_eilgang", None, (axis.vb_max, "dynamik.vb_max"))?;
    check_between(axis, "vb_max_red", None, (axis.vb_max, "dynamik.vb_max"))?;
    if axis.achs_mode == 0 || axis.achs_mode & !(MODE_LINEAR | MODE_MASTER) != 0 {
        return Err(RangeError {
            id: "P-AXIS-00015",
            name: "kenngr.achs_mode",
            value: i64::from(axis.achs_mode),
            min: i64::from(MODE_LINEAR),
            max: i64::from(MODE_LINEAR | MODE_MASTER),
            because: "the bits of this version",
        });
    }
    if axis.swe_neg >= axis.swe_pos {
        return Err(RangeError {
            id: "P-AXIS-00177",
            name: "kenngr.swe_neg",
            value: i64::from(axis.swe_neg),
            min: -i64::from(NO_LIMIT),
            max: i64::from(axis.swe_pos) - 1,
            because: "kenngr.swe_pos",
        });
    }
    if axis.filter.kind == FilterType::Delay && axis.filter.order > LONGEST_DELAY {
        return Err(RangeError {
            id: "P-AXIS-00587",
            name: "filter_fir.order",
            value: i64::from(axis.filter.order),
            min: 0,
            max: i64::from(LONGEST_DELAY),
            because: "filter_fir.type 4",
        });
    }
    let ramps = [axis.tr_beschl_ab, axis.tr_beschl_zu, axis.tr_brems_ab, axis.tr_brems_zu];
    let shortest = ramps.into_iter().fold(u32::MAX, u32::min);
    if axis.tr_w_min != 0 && (axis.tr_w_min < axis.tr_min || axis.tr_w_min > shortest) {
        return Err(RangeError {
            id: "P-AXIS-00293",
            name: "dynamik.tr_w_min",
            value: i64::from(axis.tr_w_min),
            min: i64::from(axis.tr_min),
            max: i64::from(shortest),
            because: "dynamik.tr_min and the shortest ramp at feed",
        });
    }
    check_stages(axis)
}

/// Checks every parameter of a table against its range.
///
/// # Errors
/// Returns the first parameter out of its range.
pub fn check_all<Target>(target: &Target, table: &[Parameter<Target>]) -> Result<(), RangeError> {
    for parameter in table {
        let milli = (parameter.get)(target);
        if milli < parameter.min_milli || milli > parameter.max_milli {
            let [value, min, max] =
                [milli, parameter.min_milli, parameter.max_milli].map(|milli| milli / 1000);
            let (id, name) = (parameter.id, parameter.name);
            return Err(RangeError { id, name, value, min, max, because: "its range" });
        }
    }
    Ok(())
}

/// Checks the axis parameters whose names begin with `names`, against bounds that other parameters give.
fn check_between(
    axis: &AxisData,
    names: &str,
    least: Option<(u32, &'static str)>,
    (most, limits): (u32, &'static str),
) -> Result<(), RangeError> {
    for parameter in AXIS.iter().filter(|parameter| parameter.name.starts_with(names)) {
        let value = (parameter.get)(axis) / 1000;
        let min = least.map_or(parameter.min_milli / 1000, |(min, _)| i64::from(min));
        let max = i64::from(most);
        if !(min..=max).contains(&value) {
            let because = least.map_or(limits, |(_, because)| because);
            return Err(RangeError { id: parameter.id, name: parameter.name, value, min, max, because });
        }
    }
    Ok(())
}

/// Checks the parameters of STEP. [`AxisData::stages`] lowers default values to `a_max` and `vb_max`. Other
/// values above these limits are refused.
fn check_stages(axis: &AxisData) -> Result<(), RangeError> {
    let default = AxisData::new(axis.name, axis.kind);
    check_given_stages(axis, |parameter| (parameter.get)(axis) != (parameter.get)(&default))
}

/// Checks the STEP parameters that the machine file gives, even if a given value equals the default.
///
/// # Errors
/// Returns the first parameter beyond `a_max` or `vb_max`.
pub fn check_given_stages(
    axis: &AxisData,
    is_given: impl Fn(&Parameter<AxisData>) -> bool,
) -> Result<(), RangeError> {
    for parameter in AXIS.iter().filter(|parameter| parameter.name.starts_with("lslope_profil.")) {
        let value = (parameter.get)(axis) / 1000;
        let of_speed = parameter.unit == "µm/s";
        let (max, because) =
            if of_speed { (axis.vb_max, "dynamik.vb_max") } else { (axis.a_max, "dynamik.a_max") };
        let (min, max) = (parameter.min_milli / 1000, i64::from(max));
        if !(min..=max).contains(&value) && is_given(parameter) {
            return Err(RangeError { id: parameter.id, name: parameter.name, value, min, max, because });
        }
    }
    Ok(())
}
