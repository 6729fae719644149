//! The parameter table: name in a machine file, ISG id, unit, range, default, and the field it sets.
use super::{AxisData, ChannelData};

/// What a loader needs to know of one parameter of `Target` ([`AxisData`] or [`ChannelData`]).
pub struct Parameter<Target> {
    /// ISG id, `P-AXIS-…` or `P-CHAN-…`; empty where ISG has none.
    pub id: &'static str,
    /// Dotted name inside its table, `slope_profil.a_beschl`.
    pub name: &'static str,
    /// Unit of the value in the file.
    pub unit: &'static str,
    /// Smallest value, in thousandths of the unit.
    pub min_milli: i64,
    /// Largest value, in thousandths of the unit.
    pub max_milli: i64,
    /// Whether decimals are accepted (three at most).
    pub decimals: bool,
    /// Stores a value given in thousandths of the unit and inside the range.
    pub set: fn(&mut Target, i64),
    /// Reads the value back, in thousandths of the unit.
    pub get: fn(&Target) -> i64,
}

macro_rules! parameters {
    ($target:ty: $($id:literal $name:literal [$unit:literal] $min:literal ..= $max:literal => $field:ident),+ $(,)?) => {
        &[$(Parameter {
            id: $id, name: $name, unit: $unit,
            min_milli: $min * 1000, max_milli: $max * 1000, decimals: false,
            set: |t, milli| t.$field = (milli / 1000) as u32,
            get: |t| t.$field as i64 * 1000,
        }),+]
    };
}

/// Axis parameters, in the order of the ISG ids. Ranges of [`crate::machine`] fields that depend on one another
/// (accelerations up to `a_max`, ramp times from `tr_min`, speeds up to `vb_max`) are checked by [`check_axis`].
pub const AXIS: &[Parameter<AxisData>] = parameters!(AxisData:
    "P-AXIS-00001" "slope_profil.a_beschl" ["mm/s²"] 1..=100_000_000 => a_beschl,
    "P-AXIS-00002" "slope_profil.a_brems" ["mm/s²"] 1..=100_000_000 => a_brems,
    "P-AXIS-00004" "slope_profil.a_grenz" ["mm/s²"] 1..=100_000_000 => a_grenz,
    "P-AXIS-00008" "dynamik.a_max" ["mm/s²"] 1..=100_000_000 => a_max,
    "P-AXIS-00013" "dynamik.a_trans_weight" ["0.1 %"] 0..=1000 => a_trans_weight,
    "P-AXIS-00195" "slope_profil.tr_beschl_ab" ["µs"] 1..=4_294_967_295 => tr_beschl_ab,
    "P-AXIS-00196" "slope_profil.tr_beschl_zu" ["µs"] 1..=4_294_967_295 => tr_beschl_zu,
    "P-AXIS-00197" "slope_profil.tr_brems_ab" ["µs"] 1..=4_294_967_295 => tr_brems_ab,
    "P-AXIS-00198" "slope_profil.tr_brems_zu" ["µs"] 1..=4_294_967_295 => tr_brems_zu,
    "P-AXIS-00199" "dynamik.tr_geom" ["µs"] 0..=4_294_967_295 => tr_geom,
    "P-AXIS-00200" "slope_profil.tr_grenz" ["µs"] 1..=4_294_967_295 => tr_grenz,
    "P-AXIS-00201" "dynamik.tr_min" ["µs"] 1..=4_294_967_295 => tr_min,
    "P-AXIS-00209" "vb_eilgang" ["µm/s"] 1..=2_000_000_000 => vb_eilgang,
    "P-AXIS-00212" "dynamik.vb_max" ["µm/s"] 1..=2_000_000_000 => vb_max,
);

/// Channel parameters.
pub const CHANNEL: &[Parameter<ChannelData>] = &[
    Parameter {
        id: "",
        name: "cycle_us",
        unit: "µs",
        min_milli: 100_000,
        max_milli: 10_000_000,
        decimals: false,
        set: |t, milli| t.cycle_us = (milli / 1000) as u32,
        get: |t| t.cycle_us as i64 * 1000,
    },
    Parameter {
        id: "P-STUP-00071",
        name: "look_ahead",
        unit: "blocks",
        min_milli: 10_000,
        max_milli: 10_000_000,
        decimals: false,
        set: |t, milli| t.look_ahead = (milli / 1000) as u32,
        get: |t| t.look_ahead as i64 * 1000,
    },
    Parameter {
        id: "P-CHAN-00108",
        name: "prog_start.feedrate_factor",
        unit: "100: mm/min, 0.1: m/min",
        min_milli: 1,
        max_milli: 1_000_000,
        decimals: true,
        set: |t, milli| t.feedrate_factor_milli = milli as u32,
        get: |t| t.feedrate_factor_milli as i64,
    },
    Parameter {
        id: "P-CHAN-00071",
        name: "prog_start.slope.profile",
        unit: "0 STEP, 1 TRAPEZ, 2 SIN2, 3 HSC",
        min_milli: 0,
        max_milli: 3_000,
        decimals: false,
        set: |t, milli| t.slope_profile = (milli / 1000) as u8,
        get: |t| t.slope_profile as i64 * 1000,
    },
    Parameter {
        id: "P-CHAN-00110",
        name: "check_jerk_on_poly_path",
        unit: "0 no, 1 geometric ramp time, 2 ramp times",
        min_milli: 0,
        max_milli: 2_000,
        decimals: false,
        set: |t, milli| t.check_jerk_on_poly_path = (milli / 1000) as u8,
        get: |t| t.check_jerk_on_poly_path as i64 * 1000,
    },
];

/// A value outside a range that depends on another parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RangeError {
    /// ISG id of the parameter refused.
    pub id: &'static str,
    /// Its name.
    pub name: &'static str,
    /// The value given.
    pub value: i64,
    /// The smallest value allowed.
    pub min: i64,
    /// The largest value allowed.
    pub max: i64,
    /// Name of the parameter, or the reason, that sets the bound.
    pub because: &'static str,
}

/// Checks the ranges that depend on other parameters and on the cycle time.
///
/// # Errors
/// The first parameter out of its range.
pub fn check_axis(axis: &AxisData, channel: &ChannelData) -> Result<(), RangeError> {
    let a_max = i64::from(axis.a_max);
    let tr_min = i64::from(axis.tr_min);
    let v_max = i64::from(axis.vb_max);
    // Quantities per tick have six integer bits with sign; half of it is left to sums.
    let cycle = i64::from(channel.cycle_us);
    let v_number = 16_000_000_000 / cycle;
    let a_number = (16_000_000_000_000 / (cycle * cycle)).min(100_000_000);
    let rows = [
        (
            "P-AXIS-00212",
            "dynamik.vb_max",
            v_max,
            1,
            v_number * 1000 / 1000,
            "cycle_us: at most 16 mm per tick",
        ),
        ("P-AXIS-00008", "dynamik.a_max", a_max, 1, a_number, "cycle_us: at most 16 mm/tick²"),
        ("P-AXIS-00001", "slope_profil.a_beschl", i64::from(axis.a_beschl), 1, a_max, "dynamik.a_max"),
        ("P-AXIS-00002", "slope_profil.a_brems", i64::from(axis.a_brems), 1, a_max, "dynamik.a_max"),
        ("P-AXIS-00004", "slope_profil.a_grenz", i64::from(axis.a_grenz), 1, a_max, "dynamik.a_max"),
        (
            "P-AXIS-00195",
            "slope_profil.tr_beschl_ab",
            i64::from(axis.tr_beschl_ab),
            tr_min,
            i64::from(u32::MAX),
            "dynamik.tr_min",
        ),
        (
            "P-AXIS-00196",
            "slope_profil.tr_beschl_zu",
            i64::from(axis.tr_beschl_zu),
            tr_min,
            i64::from(u32::MAX),
            "dynamik.tr_min",
        ),
        (
            "P-AXIS-00197",
            "slope_profil.tr_brems_ab",
            i64::from(axis.tr_brems_ab),
            tr_min,
            i64::from(u32::MAX),
            "dynamik.tr_min",
        ),
        (
            "P-AXIS-00198",
            "slope_profil.tr_brems_zu",
            i64::from(axis.tr_brems_zu),
            tr_min,
            i64::from(u32::MAX),
            "dynamik.tr_min",
        ),
        ("P-AXIS-00209", "vb_eilgang", i64::from(axis.vb_eilgang), 1, v_max, "dynamik.vb_max"),
    ];
    for (id, name, value, min, max, because) in rows {
        if value < min || value > max {
            return Err(RangeError { id, name, value, min, max, because });
        }
    }
    Ok(())
}
