//! The limits inside an arc: its highest speed, and the acceleration and jerk that remain for changes of
//! speed.
//!
//! On an arc of radius r, the path passes through every direction of the plane. With the speed v, the
//! acceleration a and the jerk j along the arc, an axis has at most
//!
//! - the acceleration √(a² + (v²/r)²),
//! - the jerk √((j − v³/r²)² + (3·v·a/r)²).
//!
//! Let B be the jerk that an axis may have ([`super`]). At the speed V with V³ = B·r², the curvature alone
//! uses all of B.
//!
//! **Acceleration near the highest speed.** A speed profile has zero acceleration at its highest speed v. Let
//! n be the highest jerk against the motion. Then the acceleration is at most √(2·n·(v − w)) at a lower speed
//! w. So nearly no acceleration remains near v.
//!
//! **Two jerk limits.** A jerk against the motion adds to the jerk of the curvature, but a jerk with the
//! motion, p, reduces it. So n and p have different limits. With w and v in units of V, and n and p in units
//! of B, the conditions are
//!
//! (n + w³)² + 9·w²·2·n·(v − w) ≤ 1,  max(p − w³, w³)² + 9·w²·2·min(n·(v − w), p·w) ≤ 1
//!
//! for every w from 0 to v. For some values of v, [`LEVELS`] has the n and p with which a start from
//! standstill takes the least time. These values also fulfil the conditions at lower speeds and with lower
//! jerks.
//!
//! **Choice of the speed.** A higher speed leaves less jerk and takes longer to reach. So the best speed
//! depends on the length of the arc. Of the speeds in [`SPEEDS`], the one with the least time is taken. An
//! arc that continues the circle of the arc before counts together with this arc.
//!
//! These limits do not cover an acceleration that passes the end of an arc: see [`Share::passing`].
use super::Share;
use super::permitted::{ARC_PART, ARC_SLOPE_PART, SURELY};
use crate::math::float::{max, min};
use crate::math::root::{cbrt_f32, sqrt_f32};
use crate::slope::limits::{Limits, SlopeLaw, lower};
use core::f32::consts::{FRAC_PI_4, PI, TAU};

/// A speed, the highest jerk against the motion and the highest jerk with the motion, in units of V and B.
struct Level {
    v: f32,
    against: f32,
    along: f32,
}

const fn level(v: f32, against: f32, along: f32) -> Level {
    Level { v, against, along }
}

/// From the highest speed to the lowest.
const LEVELS: [Level; 11] = [
    level(0.986, 0.0404, 0.80),
    level(0.957, 0.1223, 0.95),
    level(0.918, 0.2241, 0.87),
    level(0.868, 0.3408, 0.78),
    level(0.810, 0.3983, 0.78),
    level(0.740, 0.4491, 0.81),
    level(0.671, 0.5444, 0.82),
    level(0.592, 0.6776, 0.84),
    level(0.500, 0.7788, 0.89),
    level(0.400, 0.8939, 0.93),
    level(0.300, 0.9535, 0.97),
];
/// Highest permitted part of V. Also the highest part of the speed at which the curvature uses all of the
/// acceleration.
pub(super) const HIGHEST: f32 = 0.985;
/// Parts of the highest speed to try. An arc of two turns tries only the first two.
const SPEEDS: [f32; 8] = [1.0, 0.971, 0.93, 0.88, 0.82, 0.75, 0.68, 0.6];
const LONG: usize = 2;
/// Times with a smaller difference count as equal, and the higher speed is taken.
const CLEARLY: f32 = 1.0 - 1.0 / 4096.0;
/// The angle of two turns, radians. Longer arcs count as two turns.
pub(super) const TWO_TURNS: f32 = 4.0 * PI;
pub(super) const MOST_TURNS: f32 = 64.0 * PI;
/// Angles whose ratio is below this value count as equal.
pub(super) const NEARLY: f32 = 1.001;

/// A circle in the plane of two axes, and the limits of these axes.
pub(super) struct Bend {
    /// Curvature of the path, 1/mm; for a helix share²/r.
    pub curvature: f32,
    /// Part of the path that lies in the plane.
    pub share: f32,
    /// Radians from the start of the circle to the end of the arc.
    pub turn: f32,
    /// Acceleration of the speed profile, and the largest acceleration of the axes, mm/tick².
    pub normal: f32,
    pub a_max: f32,
    /// B, mm/tick³; `None` with a slope without jerk limit.
    pub budget: Option<f32>,
    /// Whether acceleration may begin at once at a transition. Then the motion need not enter the arc at a
    /// low speed.
    pub is_free: bool,
}

impl Bend {
    /// The speed V, mm/tick.
    fn jerk_speed(&self, budget: f32) -> f32 {
        cbrt_f32(budget * self.share / (self.curvature * self.curvature))
    }

    /// Acceleration along the path that is left at the speed `v`, mm/tick².
    fn along(&self, v: f32) -> f32 {
        let across = v * v * self.curvature;
        sqrt_f32(max(self.a_max * self.a_max - across * across, 0.0)) / self.share
    }

    /// The angle for the limits, radians: the next lower one of a list. So pieces of one arc have equal
    /// limits.
    fn turns(&self) -> f32 {
        let mut turn = FRAC_PI_4;
        while turn < MOST_TURNS && 2.0 * turn <= self.turn * NEARLY {
            turn *= 2.0;
        }
        turn
    }

    /// Acceleration along the path that may pass the ends of an arc at this speed and jerk, mm/tick². The
    /// condition is √((j + v³/r²)² + (3·v·a/r)²) ≤ B.
    fn passing(&self, v: f32, jerk: f32, budget: f32) -> f32 {
        let twist = self.curvature * self.curvature / self.share;
        let both = jerk * self.share + twist * v * v * v;
        SURELY * sqrt_f32(max(budget * budget - both * both, 0.0)) / (3.0 * v * self.curvature)
    }
}

impl Limits {
    /// Lowers the limits for an arc. `share`: the limits that its transitions leave.
    pub(super) fn bend(&mut self, share: &mut Share, bend: &Bend) {
        let most = min(self.a_up, self.a_down);
        let highest = bend.budget.map_or(f32::MAX, |budget| bend.jerk_speed(budget));
        self.v = min(self.v, HIGHEST * highest);
        // Roots are computed only where the result may be lower.
        if self.v * self.v * bend.curvature >= SURELY * HIGHEST * HIGHEST * bend.normal {
            let normal = min(bend.normal, HIGHEST * HIGHEST * bend.a_max);
            self.v = min(self.v, sqrt_f32(normal / bend.curvature));
        }
        let turn = bend.turns();
        // With STEP, acceleration has no ramp, and the motion passes most arcs without a change of speed.
        let turn = if bend.budget.is_none() { max(turn, TAU) } else { turn };
        let length = turn * bend.share / bend.curvature;
        let mut best = (f32::MAX, *self);
        for (k, part) in SPEEDS.into_iter().enumerate() {
            if k == LONG && turn * NEARLY >= TWO_TURNS {
                break;
            }
            let with = self.bent(bend, self.v * part, highest);
            let time = with.time(length, bend.is_free);
            if time < CLEARLY * best.0 {
                best = (time, with);
            } else if CLEARLY * time > best.0 {
                // With falling speed, the time first falls and then rises.
                break;
            }
            if k == 0 && with.leaves_all_of(self) {
                break;
            }
        }
        *self = best.1;
        let a = min(self.a_up, self.a_down);
        self.curve(a, min(most, SURELY * bend.a_max / bend.share), true);
        let (Some(budget), SlopeLaw::JerkLimited { shape, j, .. }) = (bend.budget, &self.law) else { return };
        let jerk = shape.peak_jerk() * j.iter().copied().fold(0.0, max);
        share.j = min(share.j, ARC_SLOPE_PART / shape.peak_jerk() * budget / bend.share);
        share.v = min(share.v, cbrt_f32(ARC_PART) * highest);
        share.passing = min(share.passing, bend.passing(self.v, jerk, budget));
    }

    /// The limits at this speed; `highest` is V.
    fn bent(&self, bend: &Bend, v: f32, highest: f32) -> Self {
        let mut limits = Self { v, ..*self };
        limits.lower_accelerations(bend.along(v));
        if let (Some(budget), SlopeLaw::JerkLimited { shape, j, .. }) = (bend.budget, &mut limits.law) {
            let [against, along] = LEVELS
                .iter()
                .take_while(|level| v <= level.v * highest)
                .last()
                .map_or([0.0; 2], |level| [level.against, level.along]);
            let unit = budget / (shape.peak_jerk() * bend.share);
            let [against, along] = [against * unit, along * unit];
            lower(j, [along, against, against, along]);
        }
        limits
    }

    /// Whether the limits equal those of `other` except for the speed.
    fn leaves_all_of(&self, other: &Self) -> bool {
        self.a_up >= other.a_up && self.a_down >= other.a_down && self.law == other.law
    }

    /// Approximate ticks over a length from stop to stop. `entered`: the motion has the full speed at one
    /// end.
    fn time(&self, length: f32, entered: bool) -> f32 {
        let ramp = self.speed_up();
        let [way, _] = ramp.distance(0.0, self.v);
        let takes = ramp.duration(0.0, self.v);
        if entered {
            return length / self.v + (takes - way / self.v);
        }
        if 2.0 * way <= length {
            return 2.0 * takes + (length - 2.0 * way) / self.v;
        }
        2.0 * takes * cbrt_f32(length / (2.0 * way))
    }
}
