//! The shortest stop on a path, by search: a feed hold passes the points that a run without commands passes, at the part `r`
//! of their speed. With `q = dr/dt` and `u = dq/dt`, an axis `x` of the run has in the hold
//!
//! - the acceleration `x″·r² + x′·q`,
//! - the jerk `x‴·r³ + 3·x″·r·q + x′·u`.
//!
//! The search goes along the path in equal steps. At each step it keeps, for each small range of `r` and `q`, the motion that
//! came there first, and goes on from it with several `u` that the jerk of every axis permits. From each state it also tries
//! to stand: at constant `q`, then with one `u` down to rest. Every motion found is possible at the ends of all steps, so the
//! shortest one is not below what the axes permit; how far it is above depends on the ranges and steps.
use crate::check::Limits;
use std::collections::BTreeMap;

/// Steps of the path, as parts of a time at full speed.
const STEPS: f64 = 24.0;
/// Ranges of `r` and `q`.
const CELLS: f64 = 100.0;
/// Values of `u` that are tried, beside the least and the largest one.
const TRIED: usize = 9;
/// The jerk in the last part of a stop, as a multiple of that which lasts until it stands.
const ENDS: [f64; 7] = [1.0, 1.3, 1.8, 2.5, 4.0, 7.0, 15.0];

/// A place of the path: per axis speed, acceleration and jerk of the run without commands.
pub type Place = Vec<[f64; 3]>;

#[derive(Clone, Copy, Debug)]
struct State {
    r: f64,
    q: f64,
    time: f64,
}

/// The path and the limits of its axes.
pub struct Path<'a> {
    /// The places, a tick apart.
    pub places: &'a [Place],
    /// Limits of each axis.
    pub limits: &'a [Limits],
    /// Seconds per tick.
    pub cycle: f64,
}

impl Path<'_> {
    fn place(&self, ticks: f64) -> &Place {
        &self.places[(ticks.round() as usize).min(self.places.len() - 1)]
    }

    /// The least and the largest `u`, if any.
    fn range(&self, ticks: f64, r: f64, q: f64) -> Option<[f64; 2]> {
        let mut range = [-1e12_f64, 1e12];
        for ([v, a, j], limit) in self.place(ticks).iter().zip(self.limits) {
            if (a * r * r + v * q).abs() > limit.a * (1.0 + 1e-6) + 1e-3 {
                return None;
            }
            let (curve, most) = (j * r.powi(3) + 3.0 * a * r * q, limit.jerk * (1.0 + 1e-6) + 5.0);
            if v.abs() < 1e-6 {
                if curve.abs() > most {
                    return None;
                }
                continue;
            }
            let ends = [(-most - curve) / v, (most - curve) / v];
            range[0] = range[0].max(ends[0].min(ends[1]));
            range[1] = range[1].min(ends[0].max(ends[1]));
        }
        (range[0] <= range[1]).then_some(range)
    }

    fn permits(&self, ticks: f64, r: f64, q: f64, u: f64) -> bool {
        self.range(ticks, r, q).is_some_and(|[least, most]| least <= u && u <= most)
    }

    /// Stops from a state: time, and ticks of the path.
    fn stands(&self, at: f64, State { r, q, .. }: State) -> Option<[f64; 2]> {
        let mut best: Option<[f64; 2]> = None;
        for times in ENDS {
            let u = times * q * q / (2.0 * r);
            let ramp = r / times;
            let (holds, falls) = ((r - ramp) / -q, -q / u);
            let held = holds * 0.5 * (r + ramp) / self.cycle;
            let passed = |part: f64| (ramp * falls / 3.0) * (1.0 - (1.0 - part).powi(3)) / self.cycle;
            let is_held = times == 1.0
                || [0.0, 0.25, 0.5, 0.75, 1.0].iter().all(|part| {
                    let low = r + q * holds * part;
                    self.permits(at + holds * part * 0.5 * (r + low) / self.cycle, low, q, 0.0)
                });
            let is_ended = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0].iter().all(|part| {
                let left = 1.0 - part;
                self.permits(at + held + passed(*part), ramp * left * left, q * left, u)
            });
            let time = holds + falls;
            if is_held && is_ended && best.is_none_or(|best| time < best[0]) {
                best = Some([time, held + passed(1.0)]);
            }
        }
        best
    }

    /// Time (s) and path (ticks of the run without commands) of the shortest stops that the search finds, each alone. `about`:
    /// the time of a stop, s.
    pub fn shortest(&self, about: f64) -> Option<[f64; 2]> {
        let step = (about / self.cycle / STEPS).max(0.5);
        let scale = 0.25 * about;
        let mut states = vec![State { r: 1.0, q: 0.0, time: 0.0 }];
        let (mut best, mut least) = (f64::INFINITY, f64::INFINITY);
        for k in 0.. {
            let at = f64::from(k) * step;
            if at + 1.0 > self.places.len() as f64
                || at > least.min(1e9) && states.iter().all(|s| s.time > best)
            {
                break;
            }
            let mut next: BTreeMap<(i32, i32), State> = BTreeMap::new();
            for state in &states {
                if state.time >= best && at >= least {
                    continue;
                }
                if state.q < 0.0
                    && let Some([time, ticks]) = self.stands(at, *state)
                {
                    best = best.min(state.time + time);
                    least = least.min(at + ticks);
                }
                let Some([low, high]) = self.range(at, state.r, state.q) else { continue };
                let bound = 30.0 / about.powi(2);
                let [low, high] = [low.max(-bound), high.min(bound)];
                for n in 0..=TRIED {
                    let u = if n == TRIED { 0.0 } else { low + (high - low) * n as f64 / (TRIED - 1) as f64 };
                    if u < low || u > high {
                        continue;
                    }
                    let State { r, q, time } = *state;
                    let way = step * self.cycle;
                    let mut dt = way / r;
                    for _ in 0..6 {
                        let passed = dt * (r + dt * (0.5 * q + dt * u / 6.0));
                        let speed = r + dt * (q + 0.5 * dt * u);
                        dt += (way - passed) / speed.max(0.02);
                    }
                    let (to, turns) = (r + dt * (q + 0.5 * dt * u), q + dt * u);
                    if !(dt.is_finite() && dt > 0.0 && dt < about) || to < 0.02 || turns > 0.0 || to > 1.0 {
                        continue;
                    }
                    if !self.permits(at + step, to, turns, u) {
                        continue;
                    }
                    let t = 0.5 * dt;
                    if !self.permits(at + 0.5 * step, r + t * (q + 0.5 * t * u), q + t * u, u) {
                        continue;
                    }
                    let cell = ((to * CELLS) as i32, (-turns * scale * CELLS) as i32);
                    let came = State { r: to, q: turns, time: time + dt };
                    let kept = next.entry(cell).or_insert(came);
                    if came.time < kept.time {
                        *kept = came;
                    }
                }
            }
            states = next.into_values().collect();
            if states.is_empty() || k > 2000 {
                break;
            }
        }
        best.is_finite().then_some([best, least])
    }
}
