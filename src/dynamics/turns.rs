//! Arcs of a circle that has gone on for two turns.
//!
//! Such an arc may be as fast as a circle that never ends, but for its end: if the circle ends there, too, the motion
//! slows down from a lower speed. Near the highest speed there is next to no jerk against the motion
//! ([`super::arc`]), so that loses least.
use super::arc::{MOST_TURNS, NEARLY, TWO_TURNS};
use super::{Dynamics, Permitted};
use crate::math::float::{max, size_f32, to_bits};
use crate::nc::SlopeType;
use crate::path::{Circle, Element};
use core::f32::consts::{PI, TAU};

/// Radians of an arc that is worth it.
const OWN: f32 = PI / NEARLY;
/// The end has a speed that is lower than that part of the others, and is so much longer than its ramp.
const LOWER: f32 = 0.97;
const LONGER: f32 = 1.02;
const DISTANCE_LSB: f32 = 1.0 / (1u64 << 44) as f32;

/// What such an arc permits.
pub struct Turns {
    /// But for its end.
    pub steady: Permitted,
    /// At its end.
    pub end: Permitted,
    /// Length of the end, LSB 2^-44 mm: less than half.
    pub run_out: i64,
}

impl<const AXES: usize> Dynamics<AXES> {
    /// What an arc permits behind two turns of its circle; `None` if it is shorter, or gains nothing by it. `feed`:
    /// as in [`Self::element`], of which it does the work twice.
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
