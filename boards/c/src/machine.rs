//! Machine data as C structs, their defaults, and the functions that check them.
use crate::built;
use crate::message;
use crate::result::Outcome;
use crate::{AXES, BLOCKS};
use core::ffi::c_char;
use core::fmt::{self, Display, Formatter};
use glidepath::channel::MachineError;
use glidepath::machine::{AccelerationUnit, AxisData, AxisKind, AxisName, ChannelData, FilterData};
use glidepath::machine::{FilterType, MachineData, Synch, SynchTable};

/// Highest number of functions in a table of synchronisations.
pub const SYNCHRONISED: usize = 32;

/// Zero offsets G54…G59.
pub const ZERO_OFFSETS: usize = 6;

/// A linear axis: millimetres.
pub const LINEAR: u32 = 0;
/// A rotary axis: degrees.
pub const ROTARY: u32 = 1;
/// A spindle, which does not move along the path.
pub const SPINDLE: u32 = 2;

/// The filter of the set points of an axis. `#FILTER` in a program overrides all fields except the
/// type.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Filter {
    /// P-AXIS-00573: 1 if the filter is on at program start.
    pub enable: u32,
    /// P-AXIS-00586: 0 none, 1 moving average, 2 Gauss, 3 windowed sinc, 4 time delay.
    pub kind: u32,
    /// P-AXIS-00587: order of the filter, 0…200, below GP_TAPS; 0: the order follows from order_time_us.
    pub order: u32,
    /// P-AXIS-00590: effectiveness, percent.
    pub share: u32,
    /// P-AXIS-00593: width of a Gauss kernel, in thousandths, 1…1000.
    pub quality_milli: u32,
    /// P-AXIS-00591: the order as a time, µs; below a cycle: no filter.
    pub order_time_us: u32,
    /// P-AXIS-00585: cut-off frequency of a windowed sinc, in thousandths of Hz.
    pub fcut_milli: u32,
}

/// One axis. Speeds in µm/s (rotary: 0.001°/s), accelerations in mm/s² (°/s²), ramp times in µs. Call
/// `gp_machine_defaults` first, which sets the ISG defaults.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Axis {
    /// Name in programs: one to four letters or digits, the first a letter, followed by zeros.
    pub name: [c_char; 4],
    /// GP_LINEAR, GP_ROTARY or GP_SPINDLE.
    pub kind: u32,
    /// P-AXIS-00209: rapid speed.
    pub vb_eilgang: u32,
    /// P-AXIS-00212: highest speed.
    pub vb_max: u32,
    /// P-AXIS-00008: highest acceleration, tangential and normal together.
    pub a_max: u32,
    /// P-AXIS-00199: geometric ramp time, which limits the jerk from the curvature of the path; 0: tr_min.
    pub tr_geom: u32,
    /// P-AXIS-00201: lowest ramp time.
    pub tr_min: u32,
    /// P-AXIS-00013: permitted acceleration at a corner without a curve, 0.1 %; 0: the limits of jerk apply
    /// there too.
    pub a_trans_weight: u32,
    /// P-AXIS-00001: acceleration at feed.
    pub a_beschl: u32,
    /// P-AXIS-00002: deceleration at feed.
    pub a_brems: u32,
    /// P-AXIS-00004: acceleration and deceleration in rapid motion.
    pub a_grenz: u32,
    /// P-AXIS-00195: ramp time, acceleration decreases.
    pub tr_beschl_ab: u32,
    /// P-AXIS-00196: ramp time, acceleration increases.
    pub tr_beschl_zu: u32,
    /// P-AXIS-00197: ramp time, deceleration decreases.
    pub tr_brems_ab: u32,
    /// P-AXIS-00198: ramp time, deceleration increases.
    pub tr_brems_zu: u32,
    /// P-AXIS-00200: ramp time of rapid motion.
    pub tr_grenz: u32,
    /// P-AXIS-00154: permitted part of the jerk at a tangential transition, 0.1 %; 0: the whole jerk.
    pub r_trans_weight: u32,
    /// P-AXIS-00293: lowest ramp time at feed that a weight (G132, G133) may cause; 0: tr_min.
    pub tr_w_min: u32,
    /// P-AXIS-00214: highest speed while reduced speed is on; 0: no limit.
    pub vb_max_red: u32,
    /// P-AXIS-00011 and 00012: accelerations of the slope STEP at feed.
    pub a_stufe: [u32; 2],
    /// P-AXIS-00282 and 00283: decelerations of the slope STEP at feed; 0: as a_stufe.
    pub d_stufe: [u32; 2],
    /// P-AXIS-00221: speed at which the slope STEP changes from stage 1 to stage 2 at feed.
    pub vb_stufe_1_2: u32,
    /// P-AXIS-00005 and 00006: accelerations of the slope STEP in rapid motion.
    pub a_grenz_stufe: [u32; 2],
    /// P-AXIS-00280 and 00281: decelerations of the slope STEP in rapid motion; 0: as a_grenz_stufe.
    pub d_grenz_stufe: [u32; 2],
    /// P-AXIS-00211: speed at which the slope STEP changes from stage 1 to stage 2 in rapid motion.
    pub vb_grenz_stufe_1_2: u32,
    /// P-AXIS-00015: axis mode: 1, plus 0x10000000 for the master axis of DIST_MASTER.
    pub achs_mode: u32,
    /// P-CHAN-00011: 1 if the feed refers to this axis. If no axis has 1, the feed refers to the main axes.
    pub default_feed_axis: u32,
    /// P-ZERO-00003: zero offsets of G54…G59, 0.1 µm (rotary: 0.0001°).
    pub versch: [i32; ZERO_OFFSETS],
    /// P-AXIS-00177: negative software limit, 0.1 µm (rotary: 0.0001°); -1000000000: none.
    pub swe_neg: i32,
    /// P-AXIS-00178: positive software limit; 1000000000: none.
    pub swe_pos: i32,
    /// The filter of the axis's set points.
    pub filter: Filter,
}

/// The synchronisation of one M or H function.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Synchronisation {
    /// Number of the function.
    pub code: u32,
    /// 0 NO_SYNCH, 1 MOS, 2 MVS_SVS, 4 MVS_SNS, 8 MNS_SNS. A function that is not in the table is MOS.
    pub kind: u32,
}

/// A table of synchronisations.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Synchronisations {
    /// Number of used entries.
    pub count: u32,
    /// The functions.
    pub functions: [Synchronisation; SYNCHRONISED],
}

/// The channel.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Parameters {
    /// Interpolation cycle, µs, 100…10000.
    pub cycle_us: u32,
    /// P-STUP-00071: blocks of look-ahead, 10…GP_BLOCKS.
    pub look_ahead: u32,
    /// P-CHAN-00108: 100 = F in mm/min, 0.1 = F in m/min; here in thousandths.
    pub feedrate_factor_milli: u32,
    /// P-CHAN-00071: 0 STEP, 1 TRAPEZ, 2 SIN2, 3 HSC.
    pub slope_profile: u32,
    /// P-CHAN-00001: G130 and G131 weight 0 both, 1 acceleration, 2 deceleration.
    pub acceleration_weight: u32,
    /// P-CHAN-00073: G132 and G133 weight 0 all ramps, 1 P-AXIS-00196, 2 00195, 3 00198, 4 00197.
    pub ramp_weight: u32,
    /// P-CHAN-00009: 1 if the jerk of tangential transitions between lines and arcs is limited.
    pub corr_v_trans_jerk: u32,
    /// P-CHAN-00066: 0 if the override acts on the limits of the axes, 1 if it acts on the programmed feed,
    /// 2 as 1 while the speed is reduced.
    pub override_weight_prog_feed: u32,
    /// P-CHAN-00351: unit of the next two fields: 0 mm/min², 1 mm/s².
    pub vector_unit: u32,
    /// P-CHAN-00350: 1 if the limit of path acceleration acts on arcs too.
    pub cir_radial_acc_limit: u32,
    /// P-CHAN-00002: highest path acceleration, in thousandths.
    pub vector_acceleration_milli: u64,
    /// P-CHAN-00208: highest path deceleration, in thousandths.
    pub vector_deceleration_milli: u64,
    /// P-CHAN-00090: highest path speed, in thousandths of mm/min.
    pub vector_velocity_milli: u64,
    /// P-CHAN-00110: jerk in the curves of corners: 0 not limited, 1 limited by the geometric ramp time, 2
    /// by the ramp times.
    pub check_jerk_on_poly_path: u32,
    /// merge_chords: highest distance between chords and the line that replaces them, in percent of
    /// PATH_DEV, 0…75.
    pub merge_chords: u32,
    /// P-CHAN-00239: corners at which the HSC B-spline is off: 0 they stay sharp, 1 they are rounded, 2
    /// they are rounded next to arcs.
    pub auto_contour_mode: u32,
    /// P-CHAN-00600: 1 if FCT_PTP is active.
    pub ptp: u32,
    /// P-CHAN-00600: 1 if FCT_SURFACE is active.
    pub surface: u32,
    /// P-ZERO-00002: zero offset at program start: 0 none, 1…6 G54…G59.
    pub default_index: u32,
    /// P-CHAN-00041: synchronisation of M functions.
    pub m_synch: Synchronisations,
    /// P-CHAN-00027: synchronisation of H functions.
    pub h_synch: Synchronisations,
}

/// The machine data. The first three linear axes are the main axes. The storage keeps a copy of the
/// machine data.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Machine {
    /// The axes.
    pub axes: [Axis; AXES],
    /// The channel.
    pub channel: Parameters,
}

/// Sets all machine data to the ISG defaults: linear axes X, Y, Z, A, B, C, …, a cycle of 1 ms.
///
/// Context: any. Returns GP_RESULT_NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_machine_defaults(machine: *mut Machine) -> Outcome {
    // SAFETY: the pointer is null or points to a machine.
    let Some(machine) = (unsafe { machine.as_mut() }) else { return Outcome::Null };
    for (axis, letter) in machine.axes.iter_mut().zip(b"XYZABCUVW") {
        *axis = Axis::DEFAULT;
        if let Some(name) = axis.name.first_mut() {
            *name = *letter as c_char;
        }
    }
    machine.channel = Parameters::DEFAULT;
    Outcome::Ok
}

/// Checks machine data. `axis` returns the index of the faulty axis, or -1 if the fault belongs to no
/// axis. `message`, with room for `size` bytes, returns the parameter, its value and its range. Both
/// may be NULL.
///
/// Context: any task; about 1 KB of stack. Returns GP_RESULT_NULL, GP_RESULT_MACHINE_DATA.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_check(
    machine: *const Machine,
    axis: *mut i32,
    message: *mut c_char,
    size: usize,
) -> Outcome {
    // SAFETY: the pointer is null or points to a machine.
    let Some(machine) = (unsafe { machine.as_ref() }) else { return Outcome::Null };
    let fault = match machine.read() {
        Ok(data) => match built::check(&data) {
            Ok(()) => return Outcome::Ok,
            Err(error) => Fault::Data(error),
        },
        Err(fault) => fault,
    };
    let index = fault.axis();
    if !axis.is_null() {
        // SAFETY: it points to memory for one.
        unsafe { axis.write(index.map_or(-1, |k| k as i32)) };
    }
    // SAFETY: the caller says how much there is.
    unsafe { message::write(message, size, &fault) };
    Outcome::MachineData
}

/// Why machine data are refused.
pub enum Fault {
    /// The library says so.
    Data(MachineError),
    /// The name of the axis with this index is not one.
    Name(usize),
    /// This number of an axis, or of the channel, is not one of those expected.
    Number(Option<usize>, &'static str, u32, &'static str),
}

impl Fault {
    fn axis(&self) -> Option<usize> {
        match self {
            Self::Data(MachineError::Axis(k, _) | MachineError::Filter(k, _)) | Self::Name(k) => Some(*k),
            Self::Number(axis, ..) => *axis,
            Self::Data(_) => None,
        }
    }
}

impl Display for Fault {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if let Some(k) = self.axis() {
            write!(f, "axes[{k}]: ")?;
        }
        match self {
            Self::Data(error) => error.fmt(f),
            Self::Name(_) => f.write_str("name; expected one to four letters or digits, the first a letter"),
            Self::Number(_, name, value, expected) => write!(f, "{name} = {value}; expected {expected}"),
        }
    }
}

/// A switch.
fn switch(axis: Option<usize>, name: &'static str, value: u32) -> Result<bool, Fault> {
    if value > 1 { Err(Fault::Number(axis, name, value, "0 or 1")) } else { Ok(value == 1) }
}

/// A number whose range the library checks: more than it holds stays beyond that.
fn small(value: u32) -> u8 {
    value.min(255) as u8
}

impl Filter {
    const DEFAULT: Self = {
        let FilterData { share, quality_milli, order_time_us, fcut_milli, .. } = FilterData::NONE;
        Self {
            enable: 0,
            kind: 0,
            order: 0,
            share: share as u32,
            quality_milli: quality_milli as u32,
            order_time_us,
            fcut_milli,
        }
    };

    fn read(&self, k: usize) -> Result<FilterData, Fault> {
        if self.kind > 4 {
            let name = "filter_fir.type (P-AXIS-00586)";
            return Err(Fault::Number(Some(k), name, self.kind, "0…4"));
        }
        Ok(FilterData {
            enable: switch(Some(k), "filter_fir.enable (P-AXIS-00573)", self.enable)?,
            kind: FilterType::of_number(small(self.kind)),
            order: small(self.order),
            share: small(self.share),
            quality_milli: self.quality_milli.min(u16::MAX.into()) as u16,
            order_time_us: self.order_time_us,
            fcut_milli: self.fcut_milli,
        })
    }
}

impl Axis {
    const DEFAULT: Self = {
        Self {
            name: [0; 4],
            kind: LINEAR,
            vb_eilgang: DATA.vb_eilgang,
            vb_max: DATA.vb_max,
            a_max: DATA.a_max,
            tr_geom: DATA.tr_geom,
            tr_min: DATA.tr_min,
            a_trans_weight: DATA.a_trans_weight,
            a_beschl: DATA.a_beschl,
            a_brems: DATA.a_brems,
            a_grenz: DATA.a_grenz,
            tr_beschl_ab: DATA.tr_beschl_ab,
            tr_beschl_zu: DATA.tr_beschl_zu,
            tr_brems_ab: DATA.tr_brems_ab,
            tr_brems_zu: DATA.tr_brems_zu,
            tr_grenz: DATA.tr_grenz,
            r_trans_weight: DATA.r_trans_weight,
            tr_w_min: DATA.tr_w_min,
            vb_max_red: DATA.vb_max_red,
            a_stufe: DATA.a_stufe,
            d_stufe: DATA.d_stufe,
            vb_stufe_1_2: DATA.vb_stufe_1_2,
            a_grenz_stufe: DATA.a_grenz_stufe,
            d_grenz_stufe: DATA.d_grenz_stufe,
            vb_grenz_stufe_1_2: DATA.vb_grenz_stufe_1_2,
            achs_mode: DATA.achs_mode,
            default_feed_axis: DATA.default_feed_axis as u32,
            versch: DATA.versch,
            swe_neg: DATA.swe_neg,
            swe_pos: DATA.swe_pos,
            filter: Filter::DEFAULT,
        }
    };

    fn read(&self, k: usize) -> Result<AxisData, Fault> {
        let bytes = self.name.map(|letter| u8::from_ne_bytes(letter.to_ne_bytes()));
        let length = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
        let name = bytes.get(..length).and_then(|name| core::str::from_utf8(name).ok());
        let name = name.and_then(AxisName::new).ok_or(Fault::Name(k))?;
        let kind = match self.kind {
            LINEAR => AxisKind::Linear,
            ROTARY => AxisKind::Rotary,
            SPINDLE => AxisKind::Spindle,
            kind => return Err(Fault::Number(Some(k), "kind", kind, "0 linear, 1 rotary or 2 spindle")),
        };
        Ok(AxisData {
            name,
            kind,
            vb_eilgang: self.vb_eilgang,
            vb_max: self.vb_max,
            a_max: self.a_max,
            tr_geom: self.tr_geom,
            tr_min: self.tr_min,
            a_trans_weight: self.a_trans_weight,
            a_beschl: self.a_beschl,
            a_brems: self.a_brems,
            a_grenz: self.a_grenz,
            tr_beschl_ab: self.tr_beschl_ab,
            tr_beschl_zu: self.tr_beschl_zu,
            tr_brems_ab: self.tr_brems_ab,
            tr_brems_zu: self.tr_brems_zu,
            tr_grenz: self.tr_grenz,
            r_trans_weight: self.r_trans_weight,
            tr_w_min: self.tr_w_min,
            vb_max_red: self.vb_max_red,
            a_stufe: self.a_stufe,
            d_stufe: self.d_stufe,
            vb_stufe_1_2: self.vb_stufe_1_2,
            a_grenz_stufe: self.a_grenz_stufe,
            d_grenz_stufe: self.d_grenz_stufe,
            vb_grenz_stufe_1_2: self.vb_grenz_stufe_1_2,
            achs_mode: self.achs_mode,
            default_feed_axis: switch(Some(k), "default_feed_axis (P-CHAN-00011)", self.default_feed_axis)?,
            versch: self.versch,
            swe_neg: self.swe_neg,
            swe_pos: self.swe_pos,
            filter: self.filter.read(k)?,
        })
    }
}

const DATA: AxisData = AxisData::new(AxisName([b'X', 0, 0, 0]), AxisKind::Linear);
const CHANNEL: ChannelData = ChannelData::new();

impl Synchronisations {
    const NONE: Self = Self { count: 0, functions: [Synchronisation { code: 0, kind: 0 }; SYNCHRONISED] };

    fn read(&self, name: &'static str) -> Result<SynchTable, Fault> {
        if self.count as usize > SYNCHRONISED {
            return Err(Fault::Number(None, name, self.count, "32 functions at most"));
        }
        let mut table = SynchTable::NONE;
        for function in self.functions.iter().take(self.count as usize) {
            let synch = Synch::ALL.iter().find(|(.., value)| *value == function.kind);
            let Some((synch, ..)) = synch else {
                return Err(Fault::Number(None, name, function.kind, "a synchronisation: 0, 1, 2, 4 or 8"));
            };
            let Ok(code) = u16::try_from(function.code) else {
                return Err(Fault::Number(None, name, function.code, "a function up to 65535"));
            };
            table = table.with(code, *synch);
        }
        Ok(table)
    }
}

impl Parameters {
    const DEFAULT: Self = Self {
        cycle_us: CHANNEL.cycle_us,
        look_ahead: if BLOCKS < 120 { BLOCKS as u32 } else { 120 },
        feedrate_factor_milli: CHANNEL.feedrate_factor_milli,
        slope_profile: CHANNEL.slope_profile as u32,
        acceleration_weight: CHANNEL.acceleration_weight as u32,
        ramp_weight: CHANNEL.ramp_weight as u32,
        corr_v_trans_jerk: CHANNEL.corr_v_trans_jerk as u32,
        override_weight_prog_feed: CHANNEL.override_weight_prog_feed as u32,
        vector_unit: 0,
        cir_radial_acc_limit: CHANNEL.cir_radial_acc_limit as u32,
        vector_acceleration_milli: CHANNEL.vector_acceleration_milli,
        vector_deceleration_milli: CHANNEL.vector_deceleration_milli,
        vector_velocity_milli: CHANNEL.vector_velocity_milli,
        check_jerk_on_poly_path: CHANNEL.check_jerk_on_poly_path as u32,
        merge_chords: CHANNEL.merge_chords as u32,
        auto_contour_mode: CHANNEL.auto_contour_mode as u32,
        ptp: CHANNEL.ptp as u32,
        surface: CHANNEL.surface as u32,
        default_index: CHANNEL.default_index as u32,
        m_synch: Synchronisations::NONE,
        h_synch: Synchronisations::NONE,
    };

    fn read(&self) -> Result<ChannelData, Fault> {
        let switch = |name, value| switch(None, name, value);
        let is_mm_s2 = switch("vector_unit (P-CHAN-00351)", self.vector_unit)?;
        // Beyond what a signed number holds is beyond the range as well.
        let most = |value: u64| value.min(i64::MAX as u64);
        Ok(ChannelData {
            cycle_us: self.cycle_us,
            look_ahead: self.look_ahead,
            feedrate_factor_milli: self.feedrate_factor_milli,
            slope_profile: small(self.slope_profile),
            acceleration_weight: small(self.acceleration_weight),
            ramp_weight: small(self.ramp_weight),
            corr_v_trans_jerk: switch("corr_v_trans_jerk (P-CHAN-00009)", self.corr_v_trans_jerk)?,
            override_weight_prog_feed: small(self.override_weight_prog_feed),
            vector_unit: if is_mm_s2 { AccelerationUnit::MmS2 } else { AccelerationUnit::MmMin2 },
            cir_radial_acc_limit: switch("cir_radial_acc_limit (P-CHAN-00350)", self.cir_radial_acc_limit)?,
            vector_acceleration_milli: most(self.vector_acceleration_milli),
            vector_deceleration_milli: most(self.vector_deceleration_milli),
            vector_velocity_milli: most(self.vector_velocity_milli),
            check_jerk_on_poly_path: small(self.check_jerk_on_poly_path),
            merge_chords: small(self.merge_chords),
            auto_contour_mode: small(self.auto_contour_mode),
            ptp: switch("ptp (P-CHAN-00600)", self.ptp)?,
            surface: switch("surface (P-CHAN-00600)", self.surface)?,
            default_index: small(self.default_index),
            m_synch: self.m_synch.read("m_synch (P-CHAN-00041)")?,
            h_synch: self.h_synch.read("h_synch (P-CHAN-00027)")?,
            ..CHANNEL
        })
    }
}

impl Machine {
    /// As the library has them.
    ///
    /// # Errors
    /// A name or a number that the library cannot even hold.
    pub fn read(&self) -> Result<MachineData<AXES>, Fault> {
        let mut axes = [DATA; AXES];
        for (k, (to, from)) in axes.iter_mut().zip(&self.axes).enumerate() {
            *to = from.read(k)?;
        }
        Ok(MachineData { axes, channel: self.channel.read()? })
    }
}
