//! TRAPEZ: the change of speed whose acceleration rises, holds and falls linearly.
//!
//! From v0 to v1 > v0 with plateau a and jerks j_rise, j_fall: t_rise = a/j_rise, t_fall = a/j_fall,
//! full = a (t_rise + t_fall)/2. If dv ≥ full the plateau lasts (dv − full)/a; else both ramps shrink by
//! k = √(dv/full) and the acceleration peaks at k·a. Distance, with the times t1, t2, t3 of the three parts,
//!
//! ```text
//! S = v0 (t1+t2+t3) + ap (t1²/6 + t1 t2/2 + t2²/2 + t1 t3/2 + t2 t3 + t3²/3)
//! ```
//!
//! A slowing down is the same motion backward: the ramp that ends it comes first. All of it is `f32` in ticks: it
//! decides times, which the integers of [`super::profile`] then take as given.
use crate::lookahead::max;
use crate::math::root::{cbrt_guess, sqrt_f32};

/// A slope between two speeds, seen from the lower one. Times in ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// Plateau acceleration.
    a: f32,
    /// Full length of the ramp at the lower speed.
    rise: f32,
    /// Full length of the ramp at the higher speed.
    fall: f32,
    /// Change of speed that reaches the plateau: a (rise + fall)/2.
    pub full: f32,
    /// Distance of that change from standstill: a (rise²/6 + rise·fall/2 + fall²/3).
    pub cubic: f32,
}

impl Ramp {
    /// Slope with plateau `a` and the jerks of its ramp at the lower and at the higher speed.
    pub fn new(a: f32, j_low: f32, j_high: f32) -> Self {
        let rise = a / j_low;
        let fall = a / j_high;
        Self {
            a,
            rise,
            fall,
            full: 0.5 * a * (rise + fall),
            cubic: a * (rise * rise * (1.0 / 6.0) + 0.5 * rise * fall + fall * fall * (1.0 / 3.0)),
        }
    }

    /// Times of the ramp at the lower speed, of the plateau and of the ramp at the higher speed.
    pub fn times(&self, dv: f32) -> [f32; 3] {
        if dv >= self.full {
            [self.rise, (dv - self.full) / self.a, self.fall]
        } else {
            let k = sqrt_f32(max(dv, 0.0) / self.full);
            [k * self.rise, 0.0, k * self.fall]
        }
    }

    /// Path length of the change by `dv` from `low` on, and its derivative by `dv`.
    pub fn distance(&self, low: f32, dv: f32) -> [f32; 2] {
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

    /// Path length from `low` to where a change by `total` has gained `dv`.
    pub fn passes(&self, low: f32, total: f32, dv: f32) -> f32 {
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
            let t = sqrt_f32(2.0 * dv * self.rise / self.a);
            return t * (low + dv * (1.0 / 3.0));
        }
        if dv <= risen + a * hold {
            let t = (dv - risen) / a;
            return rise * (low + risen * (1.0 / 3.0)) + t * (low + 0.5 * (risen + dv));
        }
        let left = max(total - dv, 0.0);
        let t = sqrt_f32(2.0 * left * self.fall / self.a);
        self.distance(low, total)[0] - t * (low + total - left * (1.0 / 3.0))
    }

    /// Both ramps in full.
    pub fn time(&self) -> f32 {
        self.rise + self.fall
    }

    /// Largest change of speed from `low` on within `length`, rounded down by 2^-21.
    ///
    /// Below `full` it is the root k of cubic·k³ + low·(rise + fall)·k = length: increasing and convex, so that
    /// Newton's method from an upper bound falls onto it.
    pub fn reach(&self, low: f32, length: f32) -> f32 {
        let linear = low * (self.rise + self.fall);
        let rest = length - (linear + self.cubic);
        let dv = if rest >= 0.0 {
            // a/2·hold² + (low + a·rise/2 + a·fall)·hold = rest
            let b = low + self.a * (0.5 * self.rise + self.fall);
            self.full + self.a * (2.0 * rest) / (b + sqrt_f32(b * b + 2.0 * self.a * rest))
        } else {
            let k = root_of_cubic([linear, 0.0, self.cubic], length);
            k * k * self.full
        };
        dv * (1.0 - 1.0 / 2_097_152.0)
    }
}

/// The root u > 0 of c3·u³ + c2·u² + c1·u = length. The left side grows and is convex: Newton's method falls onto the
/// root from the smallest root of its terms taken alone, at most 1.9 times as large; its error falls to
/// 23 %, 2.3 %, 2.6e-4, 1.5e-7.
pub fn root_of_cubic([c1, c2, c3]: [f32; 3], length: f32) -> f32 {
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
