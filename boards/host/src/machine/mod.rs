//! Machine data from a TOML file, under the ISG names.
//!
//! Tables are named as in the parameter path, without `getriebe[i].`: `[axis.X.dynamik]` with `a_max = 6000`.
//! The order of the axes is that of the file. A parameter that is left out has the ISG default. An unknown
//! parameter is refused.

mod explain;
mod from;
mod kinematics;
mod later;
mod load;
mod new;
mod plain;
mod sheet;
mod steps;
mod words;

use crate::diagnose::Diagnostic;
use crate::dialect::Choice;
use crate::smooth::Smooth;
pub use explain::explain;
pub use from::from;
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::nc::SlopeType;
use glidepath_steps::AxisSteps;
pub use kinematics::Kinematics;
pub use load::{Overrides, load};
pub use new::{Options, new};

/// A machine whose number of axes is known only at run time.
pub struct Machine {
    /// The axes, in the order of the file; 1…[`MAX_AXES`].
    pub axes: Vec<AxisData>,
    /// The channel.
    pub channel: ChannelData,
    /// The step output of each axis, for `--vcd`.
    pub steps: Vec<AxisSteps>,
    /// The name for messages: the file name.
    pub name: String,
    /// Warnings about its data.
    pub warnings: Vec<Diagnostic>,
    /// The dialect of programs, according to its data.
    pub dialect: Choice,
    /// The smoothing that programs without smoothing begin with.
    pub smooth: Option<Smooth>,
    /// Its transformations.
    pub kinematics: Kinematics,
    /// Variables V.E. with their first values.
    pub variables: Vec<(&'static str, f64)>,
    /// Parameters that the file gives, with their line.
    pub given: Vec<(String, usize)>,
}

/// The largest number of axes this board is compiled for.
pub const MAX_AXES: usize = 6;

impl Machine {
    /// Three linear axes as in the examples of FCT-D3 §4 (row D3-236), at a cycle of 1 ms, with the slope
    /// TRAPEZ, feed in mm/min. Rapid motion has the acceleration and ramp time of the feed, and the highest
    /// speed.
    pub fn built_in() -> Self {
        let axis = |name| AxisData {
            vb_eilgang: 1_000_000,
            vb_max: 1_000_000,
            a_max: 6000,
            a_beschl: 2000,
            a_brems: 2000,
            a_grenz: 2000,
            tr_geom: 10_000,
            tr_beschl_ab: 150_000,
            tr_beschl_zu: 150_000,
            tr_brems_ab: 150_000,
            tr_brems_zu: 150_000,
            tr_grenz: 150_000,
            ..AxisData::new(name, AxisKind::Linear)
        };
        let axes: Vec<_> = ["X", "Y", "Z"].into_iter().filter_map(AxisName::new).map(axis).collect();
        let steps = (0..axes.len()).map(steps::preset).collect();
        // Jerk is limited at tangential transitions of lines and arcs too; by default (P-CHAN-00009 = 0) it
        // is not limited there.
        let channel =
            ChannelData { slope_profile: 1, corr_v_trans_jerk: true, surface: true, ..ChannelData::new() };
        Self {
            axes,
            channel,
            steps,
            name: "built-in three-axis machine".into(),
            warnings: Vec::new(),
            dialect: Choice::Auto,
            smooth: None,
            kinematics: Kinematics::default(),
            variables: Vec::new(),
            given: Vec::new(),
        }
    }

    /// The same machine, with a smoothing for programs without smoothing.
    pub fn smoothed(&self, smooth: Option<Smooth>) -> Self {
        Self {
            axes: self.axes.clone(),
            channel: self.channel,
            steps: self.steps.clone(),
            name: self.name.clone(),
            warnings: Vec::new(),
            dialect: self.dialect,
            smooth,
            kinematics: self.kinematics.clone(),
            variables: self.variables.clone(),
            given: Vec::new(),
        }
    }

    /// The machine data for a known number of axes; `None` if the number differs.
    pub fn data<const AXES: usize>(&self) -> Option<MachineData<AXES>> {
        let axes = <[AxisData; AXES]>::try_from(self.axes.as_slice()).ok()?;
        Some(MachineData { axes, channel: self.channel })
    }

    /// Indices of the main axes: the first three linear ones.
    pub fn main_axes(&self) -> Vec<usize> {
        let linear = self.axes.iter().enumerate().filter(|(_, axis)| axis.kind == AxisKind::Linear);
        linear.map(|(index, _)| index).take(3).collect()
    }

    /// Indices of the feed axes (P-CHAN-00011), or of the main axes if there are no feed axes.
    pub fn feed_axes(&self) -> Vec<usize> {
        let feed = self.axes.iter().enumerate().filter(|(_, axis)| axis.default_feed_axis);
        let feed: Vec<usize> = feed.map(|(index, _)| index).collect();
        if feed.is_empty() { self.main_axes() } else { feed }
    }

    /// The slope at program start: P-CHAN-00071.
    pub fn slope(&self) -> SlopeType {
        SlopeType::of_profile(self.channel.slope_profile)
    }

    /// Cycle time in seconds.
    pub fn cycle_s(&self) -> f64 {
        f64::from(self.channel.cycle_us) / 1e6
    }
}

/// Limits of one axis: mm/s, mm/s², mm/s³ (rotary: degrees).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// P-AXIS-00212.
    pub speed: f64,
    /// P-AXIS-00209.
    pub speed_rapid: f64,
    /// P-AXIS-00008: highest acceleration, tangential and normal together.
    pub accel: f64,
    /// P-AXIS-00001, or the larger stage of STEP.
    pub accel_feed: f64,
    /// P-AXIS-00002, or the larger stage.
    pub brake_feed: f64,
    /// P-AXIS-00004, or the largest stage.
    pub accel_rapid: f64,
    /// Highest jerk of the slope at feed.
    pub ramp_feed: f64,
    /// Highest jerk of the slope in rapid motion.
    pub ramp_rapid: f64,
    /// Highest jerk of slope and contour together at feed: with the geometric ramp time (P-AXIS-00199) if
    /// this is shorter.
    pub jerk_feed: f64,
    /// The same in rapid motion.
    pub jerk_rapid: f64,
    /// The larger value of feed and rapid motion.
    pub jerk: f64,
}

impl Limits {
    /// The larger value of each limit.
    pub fn or(self, other: Self) -> Self {
        Self {
            speed: self.speed.max(other.speed),
            speed_rapid: self.speed_rapid.max(other.speed_rapid),
            accel: self.accel.max(other.accel),
            accel_feed: self.accel_feed.max(other.accel_feed),
            brake_feed: self.brake_feed.max(other.brake_feed),
            accel_rapid: self.accel_rapid.max(other.accel_rapid),
            ramp_feed: self.ramp_feed.max(other.ramp_feed),
            ramp_rapid: self.ramp_rapid.max(other.ramp_rapid),
            jerk_feed: self.jerk_feed.max(other.jerk_feed),
            jerk_rapid: self.jerk_rapid.max(other.jerk_rapid),
            jerk: self.jerk.max(other.jerk),
        }
    }
}

/// The limits of an axis. The jerk of a slope is acceleration divided by ramp time, times a factor of its
/// shape.
pub fn limits(axis: &AxisData, slope: SlopeType) -> Limits {
    let [up, down] = [[axis.tr_beschl_zu, axis.tr_beschl_ab], [axis.tr_brems_zu, axis.tr_brems_ab]];
    let shortest = |ramps: [u32; 2]| ramps[0].min(ramps[1]);
    let (up, down, shape) = match slope {
        SlopeType::Trapez => (shortest(up), shortest(down), 1.0),
        // The longest of all ramp times.
        SlopeType::Hsc => {
            let longest = up.into_iter().chain(down).max().unwrap_or(0);
            (longest, longest, 1.0)
        }
        // The steepest point of a · sin²(πt/2T).
        SlopeType::Sin2 => (shortest(up), shortest(down), std::f64::consts::FRAC_PI_2),
        // Acceleration changes in a step.
        SlopeType::Step => (0, 0, f64::INFINITY),
    };
    let over = |accel: u32, ramp: u32| f64::from(accel) * 1e6 / f64::from(ramp.max(1));
    let ([accel, brake], rapid) = if slope == SlopeType::Step {
        let [feed, rapid] = [axis.stages(false), axis.stages(true)];
        (
            [feed.a, feed.d].map(|[one, two]| one.max(two)),
            rapid.a.into_iter().chain(rapid.d).max().unwrap_or(0),
        )
    } else {
        ([axis.a_beschl, axis.a_brems], axis.a_grenz)
    };
    let contour = |accel: u32| over(accel, axis.geometric_ramp());
    let ramp_feed = shape * over(accel, up).max(over(brake, down));
    let ramp_rapid = shape * over(rapid, axis.tr_grenz);
    let jerk_feed = ramp_feed.max(contour(accel.max(brake)));
    let jerk_rapid = ramp_rapid.max(contour(rapid));
    Limits {
        speed: f64::from(axis.vb_max) / 1e3,
        speed_rapid: f64::from(axis.vb_eilgang) / 1e3,
        accel: f64::from(axis.a_max),
        accel_feed: f64::from(accel),
        brake_feed: f64::from(brake),
        accel_rapid: f64::from(rapid),
        ramp_feed,
        ramp_rapid,
        jerk_feed,
        jerk_rapid,
        jerk: jerk_feed.max(jerk_rapid),
    }
}

/// The name of the slope in programs.
pub fn slope_name(slope: SlopeType) -> &'static str {
    match slope {
        SlopeType::Step => "STEP",
        SlopeType::Trapez => "TRAPEZ",
        SlopeType::Sin2 => "SIN2",
        SlopeType::Hsc => "HSC",
    }
}

/// Calls a function that is generic in the number of axes with the number of axes of a machine.
macro_rules! with_axes {
    ($machine:expr, $function:ident($($argument:expr),*)) => {
        match $machine.axes.len() {
            1 => $function::<1>($($argument),*),
            2 => $function::<2>($($argument),*),
            3 => $function::<3>($($argument),*),
            4 => $function::<4>($($argument),*),
            5 => $function::<5>($($argument),*),
            6 => $function::<6>($($argument),*),
            other => unreachable!("{other} axes: the loader accepts 1 to 6"),
        }
    };
}
pub(crate) use with_axes;
