//! Machine data: limits of the axes and settings of the channel. Names, ids and units are those of ISG's
//! parameter lists.
//!
//! Start with the ISG defaults and set what your machine has:
//!
//! ```
//! use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
//! use glidepath::Channel;
//!
//! let x = AxisData {
//!     vb_max: 250_000, // P-AXIS-00212: 250 mm/s
//!     a_beschl: 2000,  // P-AXIS-00001: 2000 mm/s²
//!     a_brems: 2000,   // P-AXIS-00002
//!     a_max: 3000,     // P-AXIS-00008: in curves
//!     ..AxisData::new(AxisName::new("X").unwrap(), AxisKind::Linear)
//! };
//! let channel = ChannelData { slope_profile: 1, ..ChannelData::new() }; // P-CHAN-00071: TRAPEZ
//! let machine = MachineData { axes: [x], channel };
//! assert_eq!(Channel::<1, 120>::check(&machine), Ok(()));
//!
//! let wrong = MachineData { axes: [AxisData { a_max: 0, ..x }], channel };
//! let error = Channel::<1, 120>::check(&wrong).unwrap_err();
//! assert!(error.to_string().starts_with("dynamik.a_max (P-AXIS-00008) = 0 is outside 1"));
//! ```
//!
//! [`parameter`] lists all parameters with unit, range and default. [`functions`] lists the functions that a
//! build may leave out.

#[cfg(feature = "grbl")]
mod foreign;
pub mod functions;
#[cfg(feature = "plc")]
mod interpolator;
pub mod parameter;
mod planned;
mod synch;
mod travel;

#[cfg(feature = "grbl")]
pub use foreign::{Dialect, ForeignAxis, ForeignChannel, MORE_OFFSETS, TOOLS, ToolLengths};
#[cfg(feature = "plc")]
pub use interpolator::{FB_STORAGE_MIN, INTERPOLATOR_FUNCTIONS, InterpolatorData, InterpolatorFunctions};
pub use planned::{Adjusted, SHORTEST_RAMP};
#[cfg(feature = "plc")]
pub use synch::SHIFT_MAX;
pub use synch::{SYNCHRONISED, Synch, SynchTable};
pub(crate) use travel::of_tenths;
pub use travel::{Beyond, Travel};

/// The name of an axis: a letter, then letters or digits, for example `X`, `C`, `X1`. Unused bytes are zero.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AxisName(pub [u8; 4]);

impl AxisName {
    /// Makes a name of one to four letters or digits that begins with a letter, or returns `None`.
    pub const fn new(name: &str) -> Option<Self> {
        let bytes = name.as_bytes();
        if bytes.is_empty() || bytes.len() > 4 || !bytes[0].is_ascii_alphabetic() {
            return None;
        }
        let mut out = [0; 4];
        let mut i = 0;
        while i < bytes.len() {
            if !bytes[i].is_ascii_alphanumeric() {
                return None;
            }
            out[i] = bytes[i].to_ascii_uppercase();
            i += 1;
        }
        Some(Self(out))
    }

    /// Whether the name begins with a letter that has another meaning in programs, for example F. A path axis
    /// cannot have such a name.
    pub fn is_reserved(&self) -> bool {
        b"DEFGHIJKLMNPRST".contains(&self.0[0])
    }

    /// The name as text, one to four letters and digits.
    pub fn as_str(&self) -> &str {
        let mut len = 0;
        while len < 4 && self.0[len] != 0 {
            len += 1;
        }
        self.0.get(..len).and_then(|b| core::str::from_utf8(b).ok()).unwrap_or("")
    }
}

/// The type of an axis (ISG: ACHSTYP_TRANSLATOR, ACHSTYP_ROTATOR, ACHSTYP_SPINDEL).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AxisKind {
    /// A linear axis, in millimetres.
    #[default]
    Linear,
    /// A rotary axis, in degrees.
    Rotary,
    /// A spindle, in degrees; a spindle takes no part in the path.
    Spindle,
}

/// Machine data of one axis.
///
/// Units: speeds in µm/s (rotary: 0.001°/s), accelerations in mm/s² (rotary: °/s²), ramp times in µs. A ramp time is the
/// time in which acceleration rises from zero to its limit: jerk = acceleration / ramp time.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AxisData {
    /// Name of the axis in programs and traces.
    pub name: AxisName,
    /// Whether the axis is linear, rotary or a spindle.
    pub kind: AxisKind,
    /// P-AXIS-00209 `vb_eilgang`: rapid speed.
    pub vb_eilgang: u32,
    /// P-AXIS-00212 `dynamik.vb_max`: largest speed.
    pub vb_max: u32,
    /// P-AXIS-00008 `dynamik.a_max`: largest acceleration, tangential and normal together.
    pub a_max: u32,
    /// P-AXIS-00199 `dynamik.tr_geom`: geometric ramp time, which limits the jerk in curves; 0: as `tr_min`.
    pub tr_geom: u32,
    /// P-AXIS-00201 `dynamik.tr_min`: smallest ramp time.
    pub tr_min: u32,
    /// P-AXIS-00013 `dynamik.a_trans_weight`: acceleration permitted at a corner without a curve, in 0.1 % of
    /// the acceleration of the axis. The speed of the axis may jump there by this acceleration times the
    /// cycle; jerk is then not limited. 0: the step of speed is small enough for the jerk limit.
    pub a_trans_weight: u32,
    /// P-AXIS-00001 `slope_profil.a_beschl`: acceleration at feed.
    pub a_beschl: u32,
    /// P-AXIS-00002 `slope_profil.a_brems`: deceleration at feed.
    pub a_brems: u32,
    /// P-AXIS-00004 `slope_profil.a_grenz`: acceleration and deceleration in rapid motion.
    pub a_grenz: u32,
    /// P-AXIS-00195 `slope_profil.tr_beschl_ab`: ramp time while acceleration decreases.
    pub tr_beschl_ab: u32,
    /// P-AXIS-00196 `slope_profil.tr_beschl_zu`: ramp time while acceleration increases.
    pub tr_beschl_zu: u32,
    /// P-AXIS-00197 `slope_profil.tr_brems_ab`: ramp time while deceleration decreases.
    pub tr_brems_ab: u32,
    /// P-AXIS-00198 `slope_profil.tr_brems_zu`: ramp time while deceleration increases.
    pub tr_brems_zu: u32,
    /// P-AXIS-00200 `slope_profil.tr_grenz`: ramp time of rapid motion.
    pub tr_grenz: u32,
    /// P-AXIS-00154 `dynamik.r_trans_weight`: part of the jerk limit that a tangential transition may use, in 0.1 %; 0:
    /// all. The parameter acts only with P-CHAN-00009.
    pub r_trans_weight: u32,
    /// P-AXIS-00293 `dynamik.tr_w_min`: smallest ramp time that a weight (G132, G133) may give; 0: as `tr_min`.
    pub tr_w_min: u32,
    /// P-AXIS-00214 `vb_max_red`: largest speed while reduced speed is on; 0: no reduction.
    pub vb_max_red: u32,
    /// P-AXIS-00011 and 00012 `lslope_profil.a_stufe_1`, `a_stufe_2`: accelerations of the slope STEP at feed, below and
    /// above `vb_stufe_1_2`.
    pub a_stufe: [u32; 2],
    /// P-AXIS-00282 and 00283 `lslope_profil.d_stufe_1`, `d_stufe_2`: decelerations of STEP at feed; 0: as `a_stufe`.
    pub d_stufe: [u32; 2],
    /// P-AXIS-00221 `lslope_profil.vb_stufe_1_2`: speed between stage 1 and stage 2, the two values of
    /// `a_stufe` and `d_stufe`.
    pub vb_stufe_1_2: u32,
    /// P-AXIS-00005 and 00006 `lslope_profil.a_grenz_stufe_1`, `a_grenz_stufe_2`: accelerations of STEP in rapid motion.
    pub a_grenz_stufe: [u32; 2],
    /// P-AXIS-00280 and 00281 `lslope_profil.d_grenz_stufe_1`, `d_grenz_stufe_2`: decelerations of STEP in rapid motion; 0: as
    /// `a_grenz_stufe`.
    pub d_grenz_stufe: [u32; 2],
    /// P-AXIS-00211 `lslope_profil.vb_grenz_stufe_1_2`: speed between both stages of STEP in rapid motion.
    pub vb_grenz_stufe_1_2: u32,
    /// P-AXIS-00015 `kenngr.achs_mode`: a bit mask of [`MODE_LINEAR`] and [`MODE_MASTER`].
    pub achs_mode: u32,
    /// P-CHAN-00011 `default_feed_axis`: whether the feed counts along this axis. If no axis has this mark,
    /// the feed counts along the main axes.
    pub default_feed_axis: bool,
    /// P-ZERO-00003 `np_grp[i].achse[j].versch`: zero offsets of G54…G59 (i = 1…6), 0.1 µm (rotary: 0.0001°).
    pub versch: [i32; ZERO_OFFSETS],
    /// P-AXIS-00177 `kenngr.swe_neg`: negative software limit, 0.1 µm (rotary: 0.0001°), machine coordinates;
    /// −[`NO_LIMIT`]: none.
    pub swe_neg: i32,
    /// P-AXIS-00178 `kenngr.swe_pos`: positive software limit, above the negative one; [`NO_LIMIT`]: none.
    pub swe_pos: i32,
    /// The filter for the set points of the axis.
    pub filter: FilterData,
    /// Data that only programs of LinuxCNC and Grbl need.
    #[cfg(feature = "grbl")]
    pub foreign: ForeignAxis,
}

/// The type of a filter (P-AXIS-00586).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FilterType {
    /// 0: no filter.
    #[default]
    None,
    /// 1: moving average.
    Average,
    /// 2: Gauss.
    Gauss,
    /// 3: windowed sinc, an ideal low-pass of limited length.
    Sinc,
    /// 4: time delay.
    Delay,
}

impl FilterType {
    /// The type with this number, 0…4; other numbers give [`Self::None`].
    pub const fn of_number(number: u8) -> Self {
        match number {
            1 => Self::Average,
            2 => Self::Gauss,
            3 => Self::Sinc,
            4 => Self::Delay,
            _ => Self::None,
        }
    }
}

/// The filter for the set points of an axis (`filter_fir`). A program may override all values except the type
/// (`#FILTER`).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FilterData {
    /// P-AXIS-00573 `filter_fir.enable`: whether the filter is on at program start.
    pub enable: bool,
    /// P-AXIS-00586 `filter_fir.type`: the type of the filter.
    pub kind: FilterType,
    /// P-AXIS-00587 `filter_fir.order`: the order, 0…200 (time delay: 0…100). 0: [`Self::order_time_us`]
    /// gives the order.
    pub order: u8,
    /// P-AXIS-00590 `filter_fir.share`: how strongly the filter acts, percent.
    pub share: u8,
    /// P-AXIS-00593 `filter_fir.quality`: width of a Gauss filter, in thousandths, 1…1000.
    pub quality_milli: u16,
    /// P-AXIS-00591 `filter_fir.order_time`: the order as a time, µs. A time below one cycle switches the
    /// filter off.
    pub order_time_us: u32,
    /// P-AXIS-00585 `filter_fir.fcut`: cut-off frequency of a windowed sinc, in thousandths of Hz.
    pub fcut_milli: u32,
}

impl FilterData {
    /// The ISG defaults: no filter.
    pub const NONE: Self = Self {
        enable: false,
        kind: FilterType::None,
        order: 0,
        share: 100,
        quality_milli: 1000,
        order_time_us: 0,
        fcut_milli: 30_000,
    };
}

/// The value of a disabled software limit: ±100 000 mm or degrees, in 0.1 µm. This is Glidepath's default; ISG's
/// default is ±10 m.
pub const NO_LIMIT: i32 = 1_000_000_000;

/// Number of zero offsets: G54…G59.
pub const ZERO_OFFSETS: usize = 6;

/// P-AXIS-00015: positions are not reduced to one turn. Glidepath treats every axis in this way.
pub const MODE_LINEAR: u32 = 0x1;

/// P-AXIS-00015: master axis of `#CONTOUR MODE [DIST_MASTER]`, if this axis is the only feed axis. ISG's documents
/// describe this mark without its bit; Glidepath uses the highest bit of ISG's range.
pub const MODE_MASTER: u32 = 0x1000_0000;

/// Limits of the slope STEP for one axis, at feed or in rapid motion.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Stages {
    /// Accelerations below and above `change_over`, mm/s² (rotary: °/s²).
    pub a: [u32; 2],
    /// Decelerations below and above `change_over`, mm/s² (rotary: °/s²).
    pub d: [u32; 2],
    /// Speed at which the second acceleration and deceleration begin, µm/s (rotary: 0.001°/s).
    pub change_over: u32,
}

impl AxisData {
    /// An axis with the ISG defaults.
    pub const fn new(name: AxisName, kind: AxisKind) -> Self {
        Self {
            name,
            kind,
            vb_eilgang: 166_666,
            vb_max: 200_000,
            a_max: 1000,
            tr_geom: 10_000,
            tr_min: 10_000,
            a_trans_weight: 0,
            a_beschl: 1000,
            a_brems: 1000,
            a_grenz: 1000,
            tr_beschl_ab: 50_000,
            tr_beschl_zu: 50_000,
            tr_brems_ab: 50_000,
            tr_brems_zu: 50_000,
            tr_grenz: 10_000,
            r_trans_weight: 1000,
            tr_w_min: 0,
            vb_max_red: 0,
            a_stufe: [1000; 2],
            d_stufe: [0; 2],
            vb_stufe_1_2: 100_000,
            a_grenz_stufe: [1000; 2],
            d_grenz_stufe: [0; 2],
            vb_grenz_stufe_1_2: 100_000,
            achs_mode: MODE_LINEAR,
            default_feed_axis: false,
            versch: [0; ZERO_OFFSETS],
            swe_neg: -NO_LIMIT,
            swe_pos: NO_LIMIT,
            filter: FilterData::NONE,
            #[cfg(feature = "grbl")]
            foreign: ForeignAxis::NONE,
        }
    }

    /// The geometric ramp time in µs: P-AXIS-00199, or P-AXIS-00201 if P-AXIS-00199 is 0.
    pub const fn geometric_ramp(&self) -> u32 {
        if self.tr_geom == 0 { self.tr_min } else { self.tr_geom }
    }

    /// Sets accelerations and decelerations of all slopes to `percent` of their values, at most P-AXIS-00008.
    /// Values above 0 stay at least 1 mm/s².
    pub(crate) fn weigh(&mut self, percent: u32) {
        let a_max = self.a_max;
        let weighted = |a: u32| {
            let part = u64::from(a) * u64::from(percent) / 100;
            (part.max(u64::from(a > 0)) as u32).min(a_max)
        };
        for a in [&mut self.a_beschl, &mut self.a_brems, &mut self.a_grenz] {
            *a = weighted(*a);
        }
        for stages in [&mut self.a_stufe, &mut self.d_stufe, &mut self.a_grenz_stufe, &mut self.d_grenz_stufe]
        {
            *stages = stages.map(weighted);
        }
    }

    /// The accelerations of the slope STEP, at feed or in rapid motion. A programmed deceleration of 0 means
    /// that of the acceleration. All values are at most P-AXIS-00008, and the change-over is at most
    /// P-AXIS-00212.
    pub const fn stages(&self, rapid: bool) -> Stages {
        let (a, d, change_over) = if rapid {
            (self.a_grenz_stufe, self.d_grenz_stufe, self.vb_grenz_stufe_1_2)
        } else {
            (self.a_stufe, self.d_stufe, self.vb_stufe_1_2)
        };
        let d = [if d[0] == 0 { a[0] } else { d[0] }, if d[1] == 0 { a[1] } else { d[1] }];
        Stages {
            a: [least(a[0], self.a_max), least(a[1], self.a_max)],
            d: [least(d[0], self.a_max), least(d[1], self.a_max)],
            change_over: least(change_over, self.vb_max),
        }
    }
}

const fn least(a: u32, b: u32) -> u32 {
    if a < b { a } else { b }
}

/// The unit of path accelerations in machine data and in `#VECTOR LIMIT`.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AccelerationUnit {
    /// MM_M2: mm/min².
    #[default]
    MmMin2,
    /// MM_S2: mm/s².
    MmS2,
}

/// Machine data of the channel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ChannelData {
    /// Interpolation cycle, µs, 100…10 000.
    pub cycle_us: u32,
    /// Blocks of look-ahead (P-STUP-00071, P-CHAN-00650/00653): 10 to the `BLOCKS` of the channel.
    pub look_ahead: u32,
    /// P-CHAN-00108 `prog_start.feedrate_factor`, in thousandths. 100 000: F in mm/min. 100: F in m/min.
    pub feedrate_factor_milli: u32,
    /// P-CHAN-00071 `prog_start.slope.profile`, the slope at program start: 0 STEP, 1 TRAPEZ, 2 SIN2, 3 HSC.
    pub slope_profile: u8,
    /// P-CHAN-00001 `prog_start.slope.acceleration`: what G130 and G131 weight. 0: both, 1: acceleration, 2:
    /// deceleration.
    pub acceleration_weight: u8,
    /// P-CHAN-00073 `prog_start.slope.ramp_time`: what G132 and G133 weight. 0: all ramps, 1: P-AXIS-00196,
    /// 2: P-AXIS-00195, 3: P-AXIS-00198, 4: P-AXIS-00197.
    pub ramp_weight: u8,
    /// P-CHAN-00009 `corr_v_trans_jerk`: whether jerk is limited at tangential transitions between lines and
    /// arcs (P-AXIS-00154). If `false`, the motion passes such a transition as fast as acceleration permits,
    /// and jerk is not limited there.
    pub corr_v_trans_jerk: bool,
    /// P-CHAN-00066 `override_weight_prog_feed`. 0: the override acts on the speed that the axes permit. 1:
    /// the override acts on the programmed feed. 2: as 1 while reduced speed is on, otherwise as 0.
    pub override_weight_prog_feed: u8,
    /// P-CHAN-00002 `vector.acceleration`: limit of the path acceleration, in thousandths of
    /// [`Self::vector_unit`].
    pub vector_acceleration_milli: u64,
    /// P-CHAN-00208 `vector.deceleration`: limit of the path deceleration, in thousandths of
    /// [`Self::vector_unit`].
    pub vector_deceleration_milli: u64,
    /// P-CHAN-00090 `vector.velocity`: limit of the path speed, in thousandths of mm/min.
    pub vector_velocity_milli: u64,
    /// P-CHAN-00351 `vector.acc_dec_unit`: unit of the limits of acceleration and deceleration.
    pub vector_unit: AccelerationUnit,
    /// P-CHAN-00350 `vector.cir_radial_acc_limit`: whether the limit of path acceleration also limits
    /// acceleration across the path, on arcs.
    pub cir_radial_acc_limit: bool,
    /// P-CHAN-00110 `check_jerk_on_poly_path`: jerk limit in corner curves: 0 none, 1 from the geometric ramp
    /// time, 2 from the ramp times.
    pub check_jerk_on_poly_path: u8,
    /// `merge_chords`, not an ISG parameter: with `#CONTOUR MODE [DEV]` nearly straight chords become one line. The
    /// line uses at most this percentage of PATH_DEV and TRACK_DEV, 0…75; curves at its ends use the rest. 0: chords
    /// are not merged.
    pub merge_chords: u8,
    /// P-CHAN-00239 `hsc.bspline.auto_contour_mode`: corners where the HSC B-spline is interrupted. 0: they
    /// stay sharp. 1: they are rounded. 2: they are rounded only at arcs.
    pub auto_contour_mode: u8,
    /// P-CHAN-00041 `m_synch[n]`: synchronisation of M functions.
    pub m_synch: SynchTable,
    /// P-CHAN-00027 `h_synch[n]`: synchronisation of H functions.
    pub h_synch: SynchTable,
    /// P-CHAN-00600 `configuration.path_preparation.function`: whether it contains FCT_PTP, so that `#CONTOUR
    /// MODE [PTP]` is permitted.
    pub ptp: bool,
    /// P-CHAN-00600: whether it contains FCT_SURFACE, so that `#HSC [SURFACE]` is permitted.
    pub surface: bool,
    /// P-CHAN-00451 `mode_implicite_sync_indp_asyn_axis`: which block waits for an independent axis. `true`:
    /// a block that names the axis. `false`: a block that moves the axis.
    pub joins_named: bool,
    /// P-CHAN-00297 `mode_exact_stop_indp_axis`: which word waits for independent axes. 0: `#WAIT INDP`, for
    /// the named axes. 1: also an exact stop (G60, G360), for all axes. 2: `#WAIT INDP`, for all axes.
    pub exact_stop_indp: u8,
    /// P-ZERO-00002 `default_index`: the zero offset at program start: 0 for G53 (none), 1…6 for G54…G59.
    pub default_index: u8,
    /// Additional functions of the interpolator for a PLC.
    #[cfg(feature = "plc")]
    pub interpolator: InterpolatorData,
    /// The dialect of programs, and data that only dialects other than ISG's need.
    #[cfg(feature = "grbl")]
    pub foreign: ForeignChannel,
}

impl ChannelData {
    /// The ISG defaults and a cycle of 1 ms.
    pub const fn new() -> Self {
        Self {
            cycle_us: 1000,
            look_ahead: 120,
            feedrate_factor_milli: 100_000,
            slope_profile: 0,
            acceleration_weight: 0,
            ramp_weight: 0,
            corr_v_trans_jerk: false,
            override_weight_prog_feed: 0,
            vector_acceleration_milli: 100_000_000_000,
            vector_deceleration_milli: 100_000_000_000,
            vector_velocity_milli: 2_000_000_000_000,
            vector_unit: AccelerationUnit::MmMin2,
            cir_radial_acc_limit: false,
            check_jerk_on_poly_path: 1,
            merge_chords: 0,
            m_synch: SynchTable::NONE,
            h_synch: SynchTable::NONE,
            auto_contour_mode: 0,
            ptp: false,
            surface: false,
            joins_named: false,
            exact_stop_indp: 0,
            default_index: 0,
            #[cfg(feature = "plc")]
            interpolator: InterpolatorData::ISG,
            #[cfg(feature = "grbl")]
            foreign: ForeignChannel::ISG,
        }
    }
}

impl Default for ChannelData {
    fn default() -> Self {
        Self::new()
    }
}

/// Machine data of a channel and its `AXES` axes. The first three linear axes are the main axes. Path length is measured
/// along the feed axes (P-CHAN-00011).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MachineData<const AXES: usize> {
    /// Machine data of each axis, in the order of the set points.
    pub axes: [AxisData; AXES],
    /// Machine data for all axes together.
    pub channel: ChannelData,
}

impl<const AXES: usize> MachineData<AXES> {
    /// Index of the axis called `name`.
    pub fn axis(&self, name: AxisName) -> Option<usize> {
        self.axes.iter().position(|a| a.name == name)
    }

    /// Indices of the main axes: the first three linear axes.
    pub fn main_axes(&self) -> [Option<usize>; 3] {
        let mut main = [None; 3];
        let linear = self.axes.iter().enumerate().filter(|(_, a)| a.kind == AxisKind::Linear);
        for (slot, (i, _)) in main.iter_mut().zip(linear) {
            *slot = Some(i);
        }
        main
    }
}
