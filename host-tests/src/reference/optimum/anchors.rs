//! Motions made of speed changes with zero acceleration at both ends, between anchors: what simple planners
//! do. They keep all limits and so bound the optimum from above; the search for it starts from one.
use super::{Block, Limits};
use crate::reference::profile::{PathState, Profile, reach};

/// Distances and speeds that count as equal, in mm and as a part.
const SAME_PLACE: f64 = 1e-9;
const SAME_SPEED: f64 = 1e-7;

/// A point of the path with a given speed and zero acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Anchor {
    s: f64,
    v: f64,
}

/// Where blocks begin, and the end of the path.
pub fn borders(blocks: &[Block]) -> Vec<f64> {
    let ends = blocks.iter().scan(0.0, |s, block| {
        *s += block.length;
        Some(*s)
    });
    std::iter::once(0.0).chain(ends).collect()
}

/// Lowers the speeds of all but the first and the last anchor, which are at rest, until each can be reached
/// from its neighbours.
fn lower(anchors: &mut [Anchor], limits: &Limits) {
    let (up, down) = (limits.accelerate(), limits.brake().reversed());
    let inner = 1..anchors.len() - 1;
    for i in inner.clone().rev() {
        let (here, next) = (anchors[i], anchors[i + 1]);
        anchors[i].v = here.v.min(reach(next.s - here.s, next.v, here.v.max(next.v), down));
    }
    for i in inner {
        let (before, here) = (anchors[i - 1], anchors[i]);
        anchors[i].v = here.v.min(reach(here.s - before.s, before.v, here.v.max(before.v), up));
    }
}

/// The fastest motion between two anchors that can be reached from each other.
fn between(from: Anchor, to: Anchor, v_max: f64, limits: &Limits) -> Profile {
    Profile::fastest(to.s - from.s, from.v, to.v, v_max, limits.accelerate(), limits.brake())
        .expect("speeds have been lowered")
}

/// The fastest motion with zero acceleration at every block end.
pub fn at_borders(blocks: &[Block], limits: &Limits) -> Vec<Profile> {
    let slower = blocks.windows(2).map(|b| b[0].speed.min(b[1].speed));
    let speeds = std::iter::once(0.0).chain(slower).chain([0.0]);
    let mut anchors: Vec<Anchor> =
        borders(blocks).into_iter().zip(speeds).map(|(s, v)| Anchor { s, v }).collect();
    lower(&mut anchors, limits);
    anchors.windows(2).zip(blocks).map(|(a, block)| between(a[0], a[1], block.speed, limits)).collect()
}

/// A motion with zero acceleration only where a block holds it back: begins with standstill at both ends of
/// the path, takes the slowest block that is passed too fast between two anchors, and makes that end of it an
/// anchor, with its speed, where the speed is too high (both ends if the speed is too high at both, or only
/// inside); until no block is.
pub fn in_valleys(blocks: &[Block], limits: &Limits) -> Vec<Profile> {
    let borders = borders(blocks);
    let mut anchors = vec![Anchor { s: 0.0, v: 0.0 }, Anchor { s: borders[blocks.len()], v: 0.0 }];
    loop {
        lower(&mut anchors, limits);
        let mut profiles = Vec::with_capacity(anchors.len() - 1);
        let mut found = Vec::new();
        let mut lowered = false;
        for i in 1..anchors.len() {
            let (from, to) = (anchors[i - 1], anchors[i]);
            let first = borders[1..].partition_point(|&b| b <= from.s + SAME_PLACE);
            let covered = first..borders[..blocks.len()].partition_point(|&b| b < to.s - SAME_PLACE);
            let v_max = blocks[covered.clone()].iter().map(|b| b.speed).fold(0.0, f64::max);
            let profile = between(from, to, v_max, limits);
            profiles.push(profile);
            let course = Course::new(std::slice::from_ref(&profile));
            let arrival = |border: f64| course.arrival(border.clamp(from.s, to.s) - from.s);
            // Speeds at both ends of a block and the highest inside.
            let speeds = |b: usize| {
                let (enter, leave) = (arrival(borders[b]), arrival(borders[b + 1]));
                let ends = [profile.at(enter).v, profile.at(leave).v];
                let peak = enter <= profile.time() - profile.fall.time() && leave >= profile.rise.time();
                (ends, if peak { profile.v_peak } else { ends[0].max(ends[1]) })
            };
            let too_fast = covered
                .filter(|&b| speeds(b).1 > blocks[b].speed * (1.0 + SAME_SPEED))
                .min_by(|&a, &b| blocks[a].speed.total_cmp(&blocks[b].speed));
            let Some(b) = too_fast else { continue };
            let v = blocks[b].speed;
            let over = speeds(b).0.map(|end| end > v * (1.0 + SAME_SPEED));
            for (end, near) in [(0, i - 1), (1, i)] {
                let s = borders[b + end];
                if !over[end] && over[1 - end] {
                    continue;
                }
                if s > from.s + SAME_PLACE && s < to.s - SAME_PLACE {
                    found.push(Anchor { s, v });
                } else if anchors[near].v > v {
                    anchors[near].v = v;
                    lowered = true;
                }
            }
        }
        if found.is_empty() && !lowered {
            return profiles;
        }
        anchors.extend(found);
        anchors.sort_by(|a, b| a.s.total_cmp(&b.s));
    }
}

/// Profiles one after the other.
pub struct Course<'a> {
    profiles: &'a [Profile],
    /// Distance and time at the start of each, and at the end.
    starts: Vec<[f64; 2]>,
}

impl<'a> Course<'a> {
    /// Lays them end to end.
    pub fn new(profiles: &'a [Profile]) -> Self {
        let ends = profiles.iter().scan([0.0; 2], |at, profile| {
            *at = [at[0] + profile.length, at[1] + profile.time()];
            Some(*at)
        });
        Self { profiles, starts: std::iter::once([0.0; 2]).chain(ends).collect() }
    }

    /// Duration.
    pub fn time(&self) -> f64 {
        self.starts[self.profiles.len()][1]
    }

    /// Path values at a time.
    pub fn at(&self, t: f64) -> PathState {
        let i = self.starts.partition_point(|p| p[1] <= t).clamp(1, self.profiles.len()) - 1;
        let state = self.profiles[i].at(t - self.starts[i][1]);
        PathState { s: state.s + self.starts[i][0], ..state }
    }

    /// When a distance is reached.
    pub fn arrival(&self, s: f64) -> f64 {
        let i = self.starts.partition_point(|p| p[0] <= s).clamp(1, self.profiles.len()) - 1;
        let (mut low, mut high) = (self.starts[i][1], self.starts[i + 1][1]);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if self.at(middle).s < s { low = middle } else { high = middle }
        }
        high
    }
}
