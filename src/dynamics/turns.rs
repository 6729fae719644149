//! Limits of an arc on a circle that has already turned twice.
//!
//! Such an arc may be as fast as an endless circle, except near its end. The circle may end there, and the
//! motion may have to brake. Near the highest speed of an arc, the curvature leaves nearly no jerk for
//! braking ([`super::arc`]). So the last part of the arc has limits of its own: a lower speed, and more jerk
//! for braking. They are chosen for the least time.
use super::arc::{MOST_TURNS, NEARLY, TWO_TURNS};
use super::{Dynamics, Permitted};
use crate::math::float::{max, size_f32, to_bits};
use crate::nc::SlopeType;
use crate::path::{Circle, Element};
use core::f32::consts::{PI, TAU};

/// Shortest arc for which this applies, radians.
const OWN: f32 = PI / NEARLY;
/// First value: the speed at the end is below this part of the other speed. Second value: the end is longer
/// than the braking ramp by this factor.
const LOWER: f32 = 0.97;
const LONGER: f32 = 1.02;
const DISTANCE_LSB: f32 = 1.0 / (1u64 << 44) as f32;

/// Limits of an arc on a circle that has already turned twice, in two parts: all of the arc but its end, and
/// the end.
pub struct Turns {
    /// Limits of the arc without its end.
    pub steady: Permitted,
    /// Limits of the end of the arc, which may be the end of the circle.
    pub end: Permitted,
    /// Length of the end, LSB 2^-44 mm: less than half of the arc.
    pub run_out: i64,
}

impl<const AXES: usize> Dynamics<AXES> {
    /// Limits of an arc after two turns of its circle. Returns `None` if the circle has turned less, if the
    /// arc is shorter than half a turn, or if two parts gain no time. `feed`: as in [`Self::element`]. The
    /// cost is twice that of [`Self::element`].
    #[inline(never)]
    pub fn turns(&self, element: &Element<AXES>, feed: Option<f32>) -> Option<Turns> {
        let circle = element.circle.as_ref()?;
        let length = size_f32(element.shape.length.to_bits().unsigned_abs()) * DISTANCE_LSB;
        let own = length * circle.share;
        if NEARLY * circle.turn < TWO_TURNS
            || own < OWN * circle.radius
            || self.slope == SlopeType::Step
            || self.watched.is_some()
        {
            return None;
        }
        let of = |turn: f32| self.arc(&element.entry.tangent, &Some(Circle { turn, ..*circle }), feed);
        let (steady, end) = (of(MOST_TURNS), of(TAU));
        let v = end.0.v;
        if v > LOWER * steady.0.v {
            return None;
        }
        let ways = [end.0.speed_up(), end.0.brake()].map(|ramp| ramp.distance(0.0, v)[0]);
        let run_out = LONGER * max(ways[0], ways[1]);
        (2.0 * run_out < length).then(|| Turns { steady, end, run_out: to_bits::<44>(run_out) })
    }
}
