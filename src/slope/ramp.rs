//! A change of speed: its duration and its distance, for given limits. All values are `f32`, in ticks and mm.
//! [`super::profile`] turns the times into integers.
//!
//! **TRAPEZ, HSC, SIN2** ([`JerkLimited`]): acceleration rises to a plateau, stays there, and falls to zero.
//!
//! - The plateau is a; the full ramps take the times t_rise and t_fall.
//! - A change of speed that just reaches the plateau is full = a (t_rise + t_fall)/2, for any shape of the
//!   ramps ([`RampShape`]).
//! - For a change dv = v1 − v0 of at least full, the plateau lasts (dv − full)/a.
//! - For a smaller change, both ramps are shorter by the factor k = √(dv/full), and the peak acceleration is
//!   k·a.
//!
//! Let t1, t2, t3 be the times of the three parts, ap the peak acceleration, and q the constant of the shape
//! (1/6 for linear ramps). Then the distance is
//!
//! ```text
//! S = v0 (t1+t2+t3) + ap (q t1² + t1 t2/2 + t2²/2 + t1 t3/2 + t2 t3 + (1/2 − q) t3²)
//! ```
//!
//! **STEP** ([`Stepped`]): the acceleration is a1 below the change-over speed and a2 above. In each part, v1²
//! = v0² + 2 a S.
//!
//! A braking is computed as the same motion backward, from its lower speed.
use super::ramp_shape::RampShape;
use crate::machine::functions::{STEP_BUILT, StepBuilt};
use crate::math::float::{max, min};
use crate::math::root::{cbrt_guess, sqrt_f32};

/// How the speed changes between two values, in `f32`, for planning. All functions see a ramp from its lower
/// speed, also that of a braking. Units: mm, ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ramp {
    /// The slopes TRAPEZ, SIN2 and HSC.
    JerkLimited(JerkLimited),
    /// The slope STEP.
    Stepped(Stepped),
}

impl Ramp {
    /// A ramp that permits no change of speed.
    pub const NONE: Self = match STEP_BUILT {
        Some(built) => Self::Stepped(Stepped { a: [0.0; 2], change_over: 0.0, built }),
        None => Self::JerkLimited(JerkLimited {
            shape: RampShape::Linear,
            a: 0.0,
            rise: 0.0,
            fall: 0.0,
            full: 0.0,
            cubic: 0.0,
        }),
    };

    /// The ramp with the same mean jerks, but with constant jerk in each part.
    pub fn linear(self) -> Self {
        match self {
            Self::JerkLimited(ramp) => Self::JerkLimited(JerkLimited::new(
                RampShape::Linear,
                ramp.a,
                ramp.a / ramp.rise,
                ramp.a / ramp.fall,
            )),
            Self::Stepped(_) => self,
        }
    }

    /// Path length (mm) of the change by `dv` (mm/tick) from the lower speed `low` on, and the derivative of
    /// this length by `dv`.
    pub fn distance(&self, low: f32, dv: f32) -> [f32; 2] {
        match self {
            Self::JerkLimited(ramp) => ramp.distance(low, dv),
            Self::Stepped(ramp) => ramp.distance(low, dv),
        }
    }

    /// Duration of a change by `dv`, ticks. For STEP, the result is 0 and must not be used: call
    /// [`Self::duration`].
    pub fn time(&self, dv: f32) -> f32 {
        match self {
            Self::JerkLimited(ramp) => ramp.times(dv).iter().sum(),
            Self::Stepped(_) => 0.0,
        }
    }

    /// Duration in ticks of the change by `dv` (mm/tick) from the lower speed `low` on.
    pub fn duration(&self, low: f32, dv: f32) -> f32 {
        match self {
            Self::JerkLimited(ramp) => ramp.times(dv).iter().sum(),
            Self::Stepped(ramp) => {
                let [below, above] = ramp.parts(low, dv);
                below / ramp.a[0] + above / ramp.a[1]
            }
        }
    }

    /// Path length (mm) from the lower speed `low` to the point where a change by `total` has gained `dv`
    /// (mm/tick).
    pub fn passes(&self, low: f32, total: f32, dv: f32) -> f32 {
        match self {
            Self::JerkLimited(ramp) => ramp.passes(low, total, dv),
            Self::Stepped(ramp) => ramp.distance(low, max(dv, 0.0))[0],
        }
    }

    /// Largest acceleration of the ramp, mm/tick².
    pub fn acceleration(&self) -> f32 {
        match self {
            Self::JerkLimited(ramp) => ramp.a,
            Self::Stepped(ramp) => max(ramp.a[0], ramp.a[1]),
        }
    }

    /// Largest change of speed (mm/tick) from the lower speed `low` on that the ramp reaches within `length`
    /// mm. The result is rounded down by 2^-21 of its value.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn reach(&self, low: f32, length: f32) -> f32 {
        let dv = match self {
            Self::JerkLimited(ramp) => ramp.reach(low, length),
            Self::Stepped(ramp) => ramp.reach(low, length),
        };
        dv * (1.0 - 1.0 / 2_097_152.0)
    }
}

/// The ramp of the slope STEP: two constant accelerations, and the speed between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepped {
    /// Accelerations below and above `change_over`, mm/tick².
    pub a: [f32; 2],
    /// Speed at which the second acceleration follows the first, mm/tick.
    pub change_over: f32,
    /// Marks that the build has STEP.
    pub built: StepBuilt,
}

impl Stepped {
    /// Divides a change by `dv` from `low` on: how much of it is below the change-over speed, and how much
    /// above. A small change is accurate only to 2^-23 of the speed, so distances and plan must use the same
    /// parts.
    pub fn parts(&self, low: f32, dv: f32) -> [f32; 2] {
        let below = min(max(self.change_over - low, 0.0), dv);
        [below, dv - below]
    }

    pub(super) fn distance(&self, low: f32, dv: f32) -> [f32; 2] {
        let [below, above] = self.parts(low, dv);
        let middle = low + below;
        let length = below * (low + 0.5 * below) / self.a[0] + above * (middle + 0.5 * above) / self.a[1];
        [length, (low + dv) / if above > 0.0 { self.a[1] } else { self.a[0] }]
    }

    fn reach(&self, low: f32, length: f32) -> f32 {
        let below = self.change_over - low;
        let mut gain = 0.0;
        let mut rest = length;
        if below > 0.0 {
            let first = below * (low + 0.5 * below) / self.a[0];
            if length <= first {
                return gained_over(low, self.a[0] * length);
            }
            (gain, rest) = (below, length - first);
        }
        gain + gained_over(low + gain, self.a[1] * rest)
    }

    /// The highest peak of a motion that gains speed from `low` with the ramp `up` and brakes to `low` with
    /// the ramp `down`. Both together take `length` mm. Returns the height of the peak above `low`, mm/tick.
    pub fn peak(up: &Self, down: &Self, low: f32, length: f32) -> f32 {
        // Length per half the square of the speed, for both ramps together.
        let both = |stage: usize| 1.0 / (1.0 / up.a[stage] + 1.0 / down.a[stage]);
        let change_over = min(up.change_over, down.change_over);
        Self { a: [both(0), both(1)], change_over, built: up.built }.reach(low, length)
    }
}

/// Change of speed from `low` on, if half the square of the speed grows by `half`.
fn gained_over(low: f32, half: f32) -> f32 {
    2.0 * half / max(low + sqrt_f32(low * low + 2.0 * half), f32::MIN_POSITIVE)
}

/// The ramp of the slopes with jerk limit: acceleration rises, is constant (the plateau), and falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JerkLimited {
    shape: RampShape,
    /// Plateau acceleration, mm/tick².
    a: f32,
    /// Duration of the ramp at the lower speed if the plateau is reached, ticks.
    rise: f32,
    /// Duration of the ramp at the higher speed if the plateau is reached, ticks.
    fall: f32,
    /// The least change of speed that reaches the plateau acceleration, mm/tick: a (rise + fall)/2.
    pub full: f32,
    /// Path length of this change if it begins at a stop, mm: a (q·rise² + rise·fall/2 + (1/2 − q)·fall²).
    pub cubic: f32,
}

impl JerkLimited {
    /// The ramp with the plateau acceleration `a` (mm/tick²), and with the mean jerks `j_low` at the lower
    /// speed and `j_high` at the higher speed (mm/tick³).
    pub fn new(shape: RampShape, a: f32, j_low: f32, j_high: f32) -> Self {
        let [q, q_mirrored] = shape.distances();
        let rise = a / j_low;
        let fall = a / j_high;
        Self {
            shape,
            a,
            rise,
            fall,
            full: 0.5 * a * (rise + fall),
            cubic: a * (rise * rise * q + 0.5 * rise * fall + fall * fall * q_mirrored),
        }
    }

    /// How acceleration rises and falls: linear or by a sine square.
    pub fn shape(&self) -> RampShape {
        self.shape
    }

    /// Durations of the parts of a change by `dv` (mm/tick), in ticks: the ramp at the lower speed, the
    /// plateau, the ramp at the higher speed.
    pub fn times(&self, dv: f32) -> [f32; 3] {
        if dv >= self.full {
            [self.rise, (dv - self.full) / self.a, self.fall]
        } else {
            let k = sqrt_f32(max(dv, 0.0) / self.full);
            [k * self.rise, 0.0, k * self.fall]
        }
    }

    /// Path length of the change by `dv` from `low` on, and its derivative by `dv`.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn distance(&self, low: f32, dv: f32) -> [f32; 2] {
        let linear = low * (self.rise + self.fall);
        if dv >= self.full {
            let hold = (dv - self.full) / self.a;
            let length =
                linear + low * hold + self.cubic + self.a * hold * (0.5 * (self.rise + hold) + self.fall);
            [length, low / self.a + 0.5 * self.rise + hold + self.fall]
        } else {
            let k = sqrt_f32(max(dv, f32::MIN_POSITIVE) / self.full);
            let square = self.cubic * k * k;
            [k * (linear + square), (linear + 3.0 * square) / (2.0 * k * self.full)]
        }
    }

    /// Path length from `low` to the point where a change by `total` has gained `dv`.
    fn passes(&self, low: f32, total: f32, dv: f32) -> f32 {
        if dv <= 0.0 {
            return 0.0;
        }
        let (k, hold) = if total >= self.full {
            (1.0, (total - self.full) / self.a)
        } else {
            (sqrt_f32(total / self.full), 0.0)
        };
        let (a, rise) = (k * self.a, k * self.rise);
        let risen = 0.5 * a * rise;
        if dv <= risen {
            let [u, s] = self.shape.reaches(dv / risen);
            return rise * (low * u + risen * s);
        }
        if dv <= risen + a * hold {
            let t = (dv - risen) / a;
            return rise * (low + risen * (2.0 * self.shape.distances()[0])) + t * (low + 0.5 * (risen + dv));
        }
        let left = max(total - dv, 0.0);
        let fallen = 0.5 * a * k * self.fall;
        let [u, s] = self.shape.reaches(min(left / fallen, 1.0));
        self.distance(low, total)[0] - k * self.fall * ((low + total) * u - fallen * s)
    }

    /// Duration of both ramps together if the plateau is reached, ticks.
    pub fn time(&self) -> f32 {
        self.rise + self.fall
    }

    /// Largest change of speed from `low` on within `length`.
    ///
    /// Below `full`, the result is the root k of cubic·k³ + low·(rise + fall)·k = length. The left side grows
    /// and is convex, so Newton's method converges from an upper bound.
    #[cfg_attr(feature = "fast", inline(always))]
    fn reach(&self, low: f32, length: f32) -> f32 {
        let linear = low * (self.rise + self.fall);
        let rest = length - (linear + self.cubic);
        if rest >= 0.0 {
            // a/2·hold² + (low + a·rise/2 + a·fall)·hold = rest
            let b = low + self.a * (0.5 * self.rise + self.fall);
            self.full + self.a * (2.0 * rest) / (b + sqrt_f32(b * b + 2.0 * self.a * rest))
        } else {
            let k = root_of_cubic(linear, 0.0, self.cubic, length);
            k * k * self.full
        }
    }
}

/// The root u > 0 of c3·u³ + c2·u² + c1·u = length. The left side grows and is convex, so Newton's method
/// converges from above. Newton's method starts at the least u with c3·u³, c2·u² or c1·u equal to `length`.
/// This start is at most 1.9 times the result. The relative error of the steps is 23 %, 2.3 %, 2.6e-4,
/// 1.5e-7.
pub fn root_of_cubic(c1: f32, c2: f32, c3: f32, length: f32) -> f32 {
    let mut u = cbrt_guess(length / c3);
    if length < c1 * u {
        u = length / c1;
    }
    if length < c2 * u * u {
        u = sqrt_f32(length / c2);
    }
    for _ in 0..4 {
        let cubic = c3 * u * u;
        let square = c2 * u;
        let mean = cubic + square + c1;
        u -= (mean * u - length) / (mean + (2.0 * cubic + square));
    }
    u
}
