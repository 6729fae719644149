//! A block that waits for the next one, and the blocks behind it that are left out because they are short.
use super::curve::{Main, size};
use super::{Block, Data, Form, LSB_32, LSB_44, Outgoing, Parameters};
use crate::lookahead::max;
use crate::math::float::to_f32;
use crate::nc::ContourMethod;
use crate::path::{Element, PathError, arc, line};
use crate::quantity::Position;

/// A block whose end waits for the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Held<const AXES: usize> {
    pub block: Block<AXES>,
    /// Path length as programmed, LSB 2^-44 mm.
    pub length: i64,
    /// How its end is rounded; not at all without.
    pub rule: Option<Parameters>,
    /// End of the blocks left out behind it, and what goes with the last of them.
    pub skipped: Option<([Position; AXES], Data)>,
}

impl<const AXES: usize> Held<AXES> {
    /// Whether the way from one point to another is irrelevant: along the main axes and every other one.
    fn is_irrelevant(from: &[Position; AXES], to: &[Position; AXES], rule: &Parameters, main: &Main) -> bool {
        let mut travel = [0.0; AXES];
        for (travel, (from, to)) in travel.iter_mut().zip(from.iter().zip(to)) {
            *travel = to_f32(to.to_bits().saturating_sub(from.to_bits())) * LSB_32;
        }
        let mut others = travel.iter().enumerate().filter(|(k, _)| !main.contains(&Some(*k)));
        size(main, &travel) <= rule.relevant_path && others.all(|(_, x)| max(*x, -*x) <= rule.relevant_track)
    }

    /// Whether the next block is left out: it is short, and ends no further from the end of this one.
    pub fn leaves_out(&self, next: &Block<AXES>, rule: &Parameters, main: &Main) -> bool {
        let arc = next.form != Form::Line;
        let short = !arc || to_f32(next.element.shape.length.to_bits()) * LSB_44 <= rule.relevant_path;
        rule.method != ContourMethod::Pos
            && short
            && Self::is_irrelevant(&next.from, &next.to, rule, main)
            && Self::is_irrelevant(&self.block.to, &next.to, rule, main)
    }

    /// Whether it is too short to begin a curve.
    pub fn is_short(&self, rule: &Parameters) -> bool {
        rule.method != ContourMethod::Pos && to_f32(self.length) * LSB_44 <= rule.relevant_path
    }

    /// Whether it is straight.
    pub fn is_line(&self) -> bool {
        self.block.form == Form::Line
    }

    /// Whether it is a rapid one.
    pub fn is_rapid(&self) -> bool {
        self.block.data.feed.is_none()
    }

    /// The block on its way out.
    pub fn outgoing(&self) -> Outgoing<AXES> {
        let Block { element, data, .. } = self.block;
        Outgoing { element, data, curving: None, due: data.number }
    }

    /// The line in place of the blocks left out.
    pub fn bridge(&self, main: &Main) -> Option<Outgoing<AXES>> {
        let (to, data) = self.skipped?;
        let element = line(&self.block.to, &to, main).ok().flatten()?;
        Some(Outgoing { element, data, curving: None, due: data.number })
    }

    /// The rest of the block from a point on it.
    pub fn renewed(&self, from: &[Position; AXES], main: &Main) -> Result<Element<AXES>, PathError> {
        if *from == self.block.from {
            return Ok(self.block.element);
        }
        match self.block.form {
            Form::Line => Ok(line(from, &self.block.to, main)?.unwrap_or(self.block.element)),
            Form::Arc { centre, plane, clockwise } => {
                arc(from, &self.block.to, centre, plane, clockwise, main)
            }
        }
    }
}
