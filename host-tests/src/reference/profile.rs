//! Speed profiles in closed form, or from the integral of their acceleration.
//!
//! TRAPEZ and SIN2: a speed change from v0 up to v1 raises the acceleration to `a` within `up`, holds it and
//! lowers it within `down`. Its area, `v1 - v0`, is `a (up + down) / 2` when the peak is just reached. Below
//! that both ramps keep their shape and shrink by the same factor, above it the peak is held. Braking is the
//! same motion with time reversed. A ramp of SIN2 is linear between the values of sin² at eighths of its
//! time.
//!
//! STEP: one acceleration below the change-over speed and another above it.
//!
//! Length and time have the units of the caller.

/// Steps of bisection: 2^-80 of any bracket is below the last bit of an `f64`.
const BISECTIONS: usize = 80;

/// Acceleration and the times in which it rises from and falls back to zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramps {
    /// Largest acceleration.
    pub a: f64,
    /// Time from zero to `a`.
    pub up: f64,
    /// Time from `a` to zero.
    pub down: f64,
}

impl Ramps {
    /// The ramps with time reversed.
    pub fn reversed(self) -> Self {
        Self { a: self.a, up: self.down, down: self.up }
    }
}

/// The law of a change of speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slope {
    /// TRAPEZ.
    Trapez(Ramps),
    /// SIN2.
    Sin2(Ramps),
    /// STEP: accelerations below and above a speed.
    Step([f64; 2], f64),
}

impl From<Ramps> for Slope {
    fn from(ramps: Ramps) -> Self {
        Self::Trapez(ramps)
    }
}

impl Slope {
    /// The slope with time reversed.
    pub fn reversed(self) -> Self {
        match self {
            Self::Trapez(ramps) => Self::Trapez(ramps.reversed()),
            Self::Sin2(ramps) => Self::Sin2(ramps.reversed()),
            step @ Self::Step(..) => step,
        }
    }
}

/// Pieces of a ramp of SIN2.
const EIGHTHS: usize = 8;

/// A time during which acceleration changes linearly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Section {
    /// Duration.
    pub time: f64,
    /// Acceleration at its start and at its end.
    pub a: [f64; 2],
}

impl Section {
    /// Speed and distance `t` after its start with the speed `v`.
    fn after(&self, v: f64, t: f64) -> PathState {
        let [a, end] = self.a;
        let jerk = if self.time > 0.0 { (end - a) / self.time } else { 0.0 };
        PathState {
            s: t * (v + t * (a / 2.0 + t * jerk / 6.0)),
            v: v + t * (a + t * jerk / 2.0),
            a: a + t * jerk,
        }
    }
}

/// A monotone change of speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Highest reached acceleration.
    pub a_peak: f64,
    /// Duration of the rising ramp, of constant acceleration, and of the falling ramp; for STEP, of both
    /// stages with 0 between them.
    pub times: [f64; 3],
    /// Distance covered.
    pub distance: f64,
    /// The whole of it, piece by piece.
    pub sections: [Section; 2 * EIGHTHS + 1],
}

impl Change {
    /// The fastest change from `v0` to `v1 >= v0`.
    pub fn new(v0: f64, v1: f64, slope: impl Into<Slope>) -> Self {
        let dv = v1 - v0;
        if dv <= 0.0 {
            return Self::default();
        }
        let mut change = Self::default();
        let nodes = match slope.into() {
            Slope::Step(a, change_over) => {
                let middle = change_over.clamp(v0, v1);
                let times = [(middle - v0) / a[0], (v1 - middle) / a[1]];
                for (section, (a, time)) in change.sections.iter_mut().zip(a.into_iter().zip(times)) {
                    *section = Section { time, a: [a; 2] };
                }
                change.times = [times[0], 0.0, times[1]];
                change.a_peak = if times[1] == 0.0 { a[0] } else { a[0].max(a[1]) };
                None
            }
            Slope::Trapez(ramps) => Some((ramps, vec![0.0, 1.0])),
            Slope::Sin2(ramps) => {
                let eighth = std::f64::consts::FRAC_PI_2 / EIGHTHS as f64;
                Some((ramps, (0..=EIGHTHS).map(|k| (k as f64 * eighth).sin().powi(2)).collect()))
            }
        };
        if let Some((ramps, nodes)) = nodes {
            let full = ramps.a * (ramps.up + ramps.down) / 2.0;
            let (scale, hold) =
                if dv >= full { (1.0, (dv - full) / ramps.a) } else { ((dv / full).sqrt(), 0.0) };
            let (a, up, down) = (ramps.a * scale, ramps.up * scale, ramps.down * scale);
            let pieces = nodes.len() - 1;
            for (k, node) in nodes.windows(2).enumerate() {
                let [low, high] = [a * node[0], a * node[1]];
                change.sections[k] = Section { time: up / pieces as f64, a: [low, high] };
                change.sections[2 * pieces - k] = Section { time: down / pieces as f64, a: [high, low] };
            }
            change.sections[pieces] = Section { time: hold, a: [a; 2] };
            (change.a_peak, change.times) = (a, [up, hold, down]);
        }
        change.distance = change.along(v0, change.time()).s;
        change
    }

    /// Duration.
    pub fn time(&self) -> f64 {
        self.times.iter().sum()
    }

    /// Path values `t` after its start at the speed `v0`; before it, constant speed.
    pub fn along(&self, v0: f64, t: f64) -> PathState {
        let mut state = PathState { s: 0.0, v: v0, a: 0.0 };
        if t <= 0.0 {
            return PathState { s: v0 * t, ..state };
        }
        let mut left = t;
        for section in self.sections.iter().filter(|section| section.time > 0.0) {
            let step = section.after(state.v, left.min(section.time));
            state = PathState { s: state.s + step.s, ..step };
            left -= section.time;
            if left <= 0.0 {
                break;
            }
        }
        state
    }
}

/// Path values at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathState {
    /// Distance from the start of the block.
    pub s: f64,
    /// Speed.
    pub v: f64,
    /// Acceleration.
    pub a: f64,
}

/// The speed profile of one block: up to a peak speed, constant, then down to the end speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    /// Speed at the start.
    pub v_in: f64,
    /// Highest speed.
    pub v_peak: f64,
    /// Speed at the end.
    pub v_out: f64,
    /// Length.
    pub length: f64,
    /// From `v_in` to `v_peak`.
    pub rise: Change,
    /// Time at `v_peak`.
    pub cruise: f64,
    /// From `v_out` to `v_peak`, with time running backward.
    pub fall: Change,
}

impl Profile {
    /// The fastest speed profile over `length` with speed at most `v_max`; `None` if the end speeds differ
    /// too much for the length. `brake` has the rise and fall of the deceleration in the order of time.
    pub fn fastest(
        length: f64,
        v_in: f64,
        v_out: f64,
        v_max: f64,
        accelerate: impl Into<Slope>,
        brake: impl Into<Slope>,
    ) -> Option<Self> {
        let (accelerate, brake) = (accelerate.into(), brake.into());
        let through = |v: f64| {
            let rise = Change::new(v_in, v, accelerate);
            let fall = Change::new(v_out, v, brake.reversed());
            (rise, fall, length - rise.distance - fall.distance)
        };
        let lowest = v_in.max(v_out);
        // A block that just fits may not fit after the rounding of its end speeds.
        if through(lowest).2 < -1e-9 * length || lowest > v_max * (1.0 + 1e-12) {
            return None;
        }
        let v_peak = largest(lowest, v_max.max(lowest), |v| through(v).2 >= 0.0);
        let (rise, fall, rest) = through(v_peak);
        let cruise = if v_peak > 0.0 { (rest / v_peak).max(0.0) } else { 0.0 };
        Some(Self { v_in, v_peak, v_out, length, rise, cruise, fall })
    }

    /// The speed profile with a given peak speed; the rest of the length is travelled at this speed.
    pub fn with_peak(
        length: f64,
        v_in: f64,
        v_out: f64,
        v_peak: f64,
        accelerate: impl Into<Slope>,
        brake: impl Into<Slope>,
    ) -> Self {
        let (accelerate, brake) = (accelerate.into(), brake.into());
        let rise = Change::new(v_in, v_peak, accelerate);
        let fall = Change::new(v_out, v_peak, brake.reversed());
        let cruise = ((length - rise.distance - fall.distance) / v_peak).max(0.0);
        Self { v_in, v_peak, v_out, length, rise, cruise, fall }
    }

    /// Duration.
    pub fn time(&self) -> f64 {
        self.rise.time() + self.cruise + self.fall.time()
    }

    /// Path values `t` after the start. Outside the profile: at the start or end point, or further at the end
    /// speed.
    pub fn at(&self, t: f64) -> PathState {
        let left = self.time() - t;
        if t < self.rise.time() {
            return self.rise.along(self.v_in, t);
        }
        if left < self.fall.time() {
            let back = self.fall.along(self.v_out, left);
            return PathState { s: self.length - back.s, v: back.v, a: -back.a };
        }
        let on = t - self.rise.time();
        PathState { s: self.rise.distance + self.v_peak * on, v: self.v_peak, a: 0.0 }
    }
}

/// The highest speed that can be reached from `v0` within `length`, at most `v_max`.
pub fn reach(length: f64, v0: f64, v_max: f64, slope: impl Into<Slope>) -> f64 {
    let slope = slope.into();
    if v_max <= v0 {
        return v_max;
    }
    largest(v0, v_max, |v| Change::new(v0, v, slope).distance <= length)
}

/// The largest value in the bracket that fits, where `fits` holds below some value and not above it.
pub fn largest(mut low: f64, mut high: f64, fits: impl Fn(f64) -> bool) -> f64 {
    if fits(high) {
        return high;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if fits(middle) { low = middle } else { high = middle }
    }
    low
}

/// Time of the optimal rest-to-rest move of `length` with one acceleration and one ramp time: the three cases
/// of the double-S in closed form (constant speed reached; acceleration reached; neither), for `v >= a *
/// ramp`.
pub fn rest_to_rest(length: f64, v: f64, a: f64, ramp: f64) -> f64 {
    assert!(v >= a * ramp, "other cases than the three below");
    if length >= v * (v / a + ramp) {
        length / v + v / a + ramp
    } else if length >= 2.0 * a * ramp * ramp {
        let b = a * ramp;
        let peak = ((b * b + 4.0 * a * length).sqrt() - b) / 2.0;
        2.0 * (peak / a + ramp)
    } else {
        (32.0 * length * ramp / a).cbrt()
    }
}
