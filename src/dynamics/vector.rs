//! `#VECTOR LIMIT`: limits of speed and acceleration along the path, for the blocks that follow. These limits
//! can only lower what the axes permit.
//!
//! - ACC, DEC and VEL are switched on and off separately; ALL means all three. Without a value they have the
//!   values of the channel: P-CHAN-00002, P-CHAN-00208, P-CHAN-00090.
//! - Speeds are in mm/min. Accelerations are in mm/min² or, with P-CHAN-00351, in mm/s². If no main axis
//!   moves, degrees replace millimetres.
//! - With the keyword RAPID, the limits act on rapid motion only; with FEED RAPID, on feed and rapid motion;
//!   without both, on feed motion only. OFF without FEED and RAPID ends the limits of feed and rapid motion.
//! - A limit of acceleration does not change the ramp times, so it lowers the jerk in the same ratio.
//! - ACC acts on lines, and on arcs if P-CHAN-00350 is set.
use crate::dynamics::MARGIN;
use crate::machine::{AccelerationUnit, ChannelData};
use crate::math::float::{min, to_f32};
use crate::nc::{Limit, VectorLimit};
use crate::slope::limits::{Limits, SlopeLaw};

/// The error of a `#VECTOR LIMIT` command: an acceleration is below 1 mm/s², the least one of machine data,
/// or a speed is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLow;

/// Limits along the path of one kind of motion, per tick; `f32::MAX` without limit.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PathLimit {
    v: f32,
    a_up: f32,
    a_down: f32,
}

impl PathLimit {
    const NONE: Self = Self { v: f32::MAX, a_up: f32::MAX, a_down: f32::MAX };
}

/// The limits along the path that `#VECTOR LIMIT` has set, for feed and rapid motion.
#[derive(Clone, Copy, Debug)]
pub struct PathLimits {
    feed: PathLimit,
    rapid: PathLimit,
    channel: PathLimit,
    /// 1 mm/min in mm/tick.
    speed_unit: f32,
    /// A unit of P-CHAN-00351 in mm/tick².
    acceleration_unit: f32,
    /// 1 mm/s² in mm/tick².
    least: f32,
    /// P-CHAN-00350.
    arcs: bool,
}

impl PathLimits {
    /// The state at program start: only the limits of the machine data are in force.
    pub fn new(channel: &ChannelData) -> Self {
        let cycle_s = channel.cycle_us as f32 * 1e-6;
        let least = cycle_s * cycle_s;
        let acceleration_unit = match channel.vector_unit {
            AccelerationUnit::MmMin2 => least * (1.0 / 3600.0),
            AccelerationUnit::MmS2 => least,
        };
        let speed_unit = cycle_s * (1.0 / 60.0);
        let milli = |value: u64| to_f32(value.min(i64::MAX as u64) as i64) / 1000.0;
        Self {
            feed: PathLimit::NONE,
            rapid: PathLimit::NONE,
            channel: PathLimit {
                v: milli(channel.vector_velocity_milli) * speed_unit,
                a_up: milli(channel.vector_acceleration_milli) * acceleration_unit,
                a_down: milli(channel.vector_deceleration_milli) * acceleration_unit,
            },
            speed_unit,
            acceleration_unit,
            least,
            arcs: channel.cir_radial_acc_limit,
        }
    }

    /// Whether a command changes any limit, or would be refused.
    pub fn differ(&self, command: &VectorLimit) -> bool {
        let mut other = *self;
        other.set(command).is_err() || other.feed != self.feed || other.rapid != self.rapid
    }

    /// Applies a `#VECTOR LIMIT` command: sets or removes the limits that it names.
    ///
    /// # Errors
    /// An acceleration is too low or a speed is 0; nothing has changed.
    pub fn set(&mut self, command: &VectorLimit) -> Result<(), TooLow> {
        let all = command.all.then_some(Limit::Channel);
        let value = |given: Option<Limit>, channel: f32, unit: f32| match given.or(all)? {
            _ if !command.on => Some(f32::MAX),
            Limit::Channel => Some(channel * MARGIN),
            Limit::Is(value) => Some(to_f32(value.to_bits()) * (1.0 / 4_294_967_296.0) * unit * MARGIN),
        };
        let v = value(command.vel, self.channel.v, self.speed_unit);
        let a_up = value(command.acc, self.channel.a_up, self.acceleration_unit);
        let a_down = value(command.dec, self.channel.a_down, self.acceleration_unit);
        let too_low = |a: f32| a < self.least * (MARGIN * MARGIN);
        if [a_up, a_down].into_iter().flatten().any(too_low) || v.is_some_and(|v| v <= 0.0) {
            return Err(TooLow);
        }
        let both = command.feed == command.rapid && (command.feed || !command.on);
        let rapid = command.rapid || both;
        let feed = command.feed || both || !rapid;
        for (chosen, limits) in [(feed, &mut self.feed), (rapid, &mut self.rapid)] {
            if chosen {
                limits.v = v.unwrap_or(limits.v);
                limits.a_up = a_up.unwrap_or(limits.a_up);
                limits.a_down = a_down.unwrap_or(limits.a_down);
            }
        }
        Ok(())
    }

    fn of(&self, rapid: bool) -> &PathLimit {
        if rapid { &self.rapid } else { &self.feed }
    }

    /// Highest path speed (VEL), mm/tick; `f32::MAX` without a limit.
    pub fn speed(&self, rapid: bool) -> f32 {
        self.of(rapid).v
    }

    /// Highest path acceleration (ACC), mm/tick²; `f32::MAX` without a limit.
    pub fn acceleration(&self, rapid: bool) -> f32 {
        self.of(rapid).a_up
    }

    /// Highest path deceleration (DEC), mm/tick²; `f32::MAX` without a limit.
    pub fn deceleration(&self, rapid: bool) -> f32 {
        self.of(rapid).a_down
    }

    /// Lowers the accelerations of a block to ACC and DEC, and the jerks of their ramps in the same ratio.
    /// `arc`: whether the block is an arc; without P-CHAN-00350, ACC does not act on arcs.
    pub fn lower(&self, limits: &mut Limits, rapid: bool, arc: bool) {
        let path = self.of(rapid);
        let a_up = if !arc || self.arcs { path.a_up } else { f32::MAX };
        let jerk_limited = matches!(limits.law, SlopeLaw::JerkLimited { .. });
        limits.loose.lower(min(a_up, path.a_down));
        if jerk_limited && a_up >= limits.a_up && path.a_down >= limits.a_down {
            return;
        }
        let parts = [lower(&mut limits.a_up, a_up), lower(&mut limits.a_down, path.a_down)];
        match &mut limits.law {
            SlopeLaw::JerkLimited { j, .. } => {
                for (j, part) in j.iter_mut().zip([parts[0], parts[0], parts[1], parts[1]]) {
                    *j *= part;
                }
            }
            SlopeLaw::Stepped { a_up: upper_up, a_down: upper_down, still, .. } => {
                lower(upper_up, a_up);
                lower(upper_down, path.a_down);
                lower(still, path.a_down);
            }
        }
    }
}

/// Lowers `a` to `limit`. Returns the ratio of the new value to the old one.
fn lower(a: &mut f32, limit: f32) -> f32 {
    if limit >= *a {
        return 1.0;
    }
    let part = limit / *a;
    *a = limit;
    part
}
