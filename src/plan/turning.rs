//! Adds up the angle that consecutive arcs turn about one centre. The limits of an arc depend on this angle
//! ([`crate::path::Circle::turn`]).
use crate::nc::Plane;
use crate::path::Element;
use crate::quantity::Position;

/// Centres of arcs that are closer than this in both axes count as one: 2^-9 mm, more than the error of
/// coordinates with three decimals.
const ONE_CENTRE: u64 = 1 << 23;

/// The last arc.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    centre: [Position; 2],
    plane: Plane,
    clockwise: bool,
    /// Number of the motion block after the arc.
    behind: u32,
    /// Radians up to the end of the arc.
    turn: f32,
}

impl Turning {
    /// No arc yet.
    pub const NONE: Self =
        Self { centre: [Position::ZERO; 2], plane: Plane::G17, clockwise: false, behind: 0, turn: 0.0 };

    /// Adds the arc of motion block `number`, and continues the sum if the arc continues the arc before.
    pub fn go_on<const AXES: usize>(
        &mut self,
        element: &mut Element<AXES>,
        (centre, plane, clockwise): ([Position; 2], Plane, bool),
        number: u32,
    ) {
        let Some(circle) = &mut element.circle else { return };
        let near = |(a, b): (&Position, &Position)| a.to_bits().abs_diff(b.to_bits()) < ONE_CENTRE;
        let is_one = self.behind == number
            && self.turn > 0.0
            && self.plane == plane
            && self.clockwise == clockwise
            && self.centre.iter().zip(&centre).all(near);
        if is_one {
            circle.turn += self.turn;
        }
        *self = Self { centre, plane, clockwise, behind: number.wrapping_add(1), turn: circle.turn };
    }
}
