//! The shortest stop from a speed and an acceleration, in closed form.
//!
//! An acceleration above zero first falls to zero. The deceleration then rises to its peak, stays there, and
//! falls to zero as the speed does. All three changes of acceleration are linear in time: a ramp of SIN2
//! lasts as long and gains the same speed.
use super::profile::Ramps;

/// Result of a stop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stop {
    /// Time until standstill.
    pub time: f64,
    /// Distance until standstill.
    pub way: f64,
}

impl Stop {
    /// Time during which the acceleration goes from `a` to `end`.
    fn after(self, v: &mut f64, a: f64, end: f64, time: f64) -> Self {
        let way = time * (*v + time * (2.0 * a + end) / 6.0);
        *v += time * (a + end) / 2.0;
        Self { time: self.time + time, way: self.way + way }
    }

    /// With limited jerk, from the speed `v` and the acceleration `a`; `accelerate.down` is the ramp in which
    /// the acceleration falls.
    ///
    /// A motion whose deceleration can no longer fall to zero in its own ramp before it stands stops with the
    /// deceleration it has, which then falls evenly.
    pub fn with_jerk(mut v: f64, a: f64, accelerate: Ramps, brake: Ramps) -> Self {
        let mut stop = Self::default();
        if a > 0.0 {
            stop = stop.after(&mut v, a, 0.0, a * accelerate.down / accelerate.a);
        }
        let begun = (-a).max(0.0);
        let [rise, fall] = [brake.up, brake.down].map(|ramp| brake.a / ramp);
        if v <= begun * begun / (2.0 * fall) {
            let time = if begun > 0.0 { 2.0 * v / begun } else { 0.0 };
            return stop.after(&mut v, -begun, 0.0, time);
        }
        // v = (b² - begun²) / 2 rise + b² / 2 fall, if the peak b stays below what is permitted.
        let free = ((v + begun * begun / (2.0 * rise)) / (0.5 / rise + 0.5 / fall)).sqrt();
        let peak = free.min(brake.a).max(begun);
        stop = stop.after(&mut v, -begun, -peak, (peak - begun) / rise);
        let left = v - peak * peak / (2.0 * fall);
        stop = stop.after(&mut v, -peak, -peak, (left / peak).max(0.0));
        stop.after(&mut v, -peak, 0.0, peak / fall)
    }

    /// With STEP: decelerations below and above a speed.
    pub fn with_steps(v: f64, brake: [f64; 2], change_over: f64) -> Self {
        let [below, above] = [v.min(change_over), (v - change_over).max(0.0)];
        let mut v = v;
        let fast = Self::default().after(&mut v, -brake[1], -brake[1], above / brake[1]);
        fast.after(&mut v, -brake[0], -brake[0], below / brake[0])
    }
}
