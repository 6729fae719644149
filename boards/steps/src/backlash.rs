//! Compensates backlash: when an axis reverses, the motor additionally moves through the play of the drive
//! train.
//!
//! An axis counts as reversed when its set point has come back by one count (one step of the motor) from its
//! furthest position. The play is then added to the motion of the motor, or removed again. This additional
//! motion goes from rest to rest, with a constant acceleration and a speed limit.
use crate::counter::Counter;

/// Play of an axis, and the speed at which it is taken up.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Backlash {
    /// Width of the play, 0.1 µm (rotary: 0.0001°), 0…1,000,000; 0: none.
    pub width: u32,
    /// Largest speed at which the play is taken up, µm/s (0.001°/s), in addition to the motion of the axis.
    pub speed: u32,
    /// Acceleration of this motion, mm/s² (°/s²).
    pub accel: u32,
    /// The flank on which the axis stands at the start: `true` after a motion in the positive direction.
    pub starts_positive: bool,
}

impl Backlash {
    /// No play.
    pub const NONE: Self = Self { width: 0, speed: 0, accel: 0, starts_positive: false };
}

/// The play taken up so far, in grains of the axis. A positive flank is `width` grains ahead of a negative
/// one.
#[derive(Clone, Copy, Debug)]
pub struct TakeUp {
    width: i64,
    /// Change of speed per tick, grains.
    rate: i64,
    /// Largest speed, in rates.
    fastest: i64,
    /// Grains of a count.
    count: i64,
    /// The amount added to the set point now, 0…`width`.
    added: i64,
    /// Speed, in rates.
    speed: i64,
    /// Whether the axis is on the positive flank.
    is_positive: bool,
    /// Distance of the set point from its furthest position, grains.
    back: i64,
}

impl TakeUp {
    /// `width`, `speed` (per tick) and `rate` (per tick²) in grains, rounded; rates of 0 are 1.
    pub fn new(data: &Backlash, counter: &Counter, [width, speed, rate]: [i64; 3]) -> Self {
        let speed = speed.max(1);
        let rate = rate.clamp(1, speed);
        Self {
            width,
            rate,
            fastest: speed.checked_div(rate).unwrap_or(1),
            count: counter.unit() as i64,
            added: if data.starts_positive { width } else { 0 },
            speed: 0,
            is_positive: data.starts_positive,
            back: 0,
        }
    }

    /// The amount added to the set point now, grains.
    pub fn added(&self) -> i64 {
        self.added
    }

    /// Moves the set point by `grains`. Returns the additional motion of the motor in this tick.
    pub fn step(&mut self, grains: i64) -> i64 {
        if self.width == 0 {
            return 0;
        }
        let against = if self.is_positive { -grains } else { grains };
        self.back = (self.back + against).max(0);
        if self.back >= self.count {
            self.is_positive = !self.is_positive;
            self.back = 0;
        }
        let goal = if self.is_positive { self.width } else { 0 };
        let left = goal - self.added;
        if left == 0 && self.speed == 0 {
            return 0;
        }
        let step = self.toward(left);
        self.added += step;
        step
    }

    /// One tick of the motion to a goal `left` away: grains.
    fn toward(&mut self, left: i64) -> i64 {
        let sign = if left < 0 || left == 0 && self.speed < 0 { -1 } else { 1 };
        let (left, speed) = (left * sign, self.speed * sign);
        // The distance at `speed` and at each lower speed down to a stop.
        let way = |speed: i64| self.rate * (speed * (speed + 1) / 2);
        let speed = if speed < 0 {
            // Away from the goal: brakes first.
            speed + 1
        } else {
            let wanted = [speed + 1, speed, speed - 1];
            let fits = |speed: &i64| (1..=self.fastest).contains(speed) && way(*speed) <= left;
            wanted.into_iter().find(fits).unwrap_or(0)
        };
        self.speed = speed * sign;
        // A distance below the first rate is covered at once.
        let step = if speed == 0 && left < self.rate { left } else { speed * self.rate };
        step * sign
    }
}
