//! Feed and spindle speed that depend on each other: F per revolution (G95), and constant surface speed
//! (G96).
use super::block::Block;
use crate::machine::functions;
use crate::nc::interpreter::{Gathered, Interpreter};
use crate::nc::{Fault, Motion, MotionKind, NcErrorKind, Span, real};
use crate::quantity::{Feed, Position};

/// The values of G96: surface speed, mm/min, and highest spindle speed, 1/min. Without a programmed one, the
/// highest spindle speed is infinite.
#[derive(Clone, Copy, PartialEq)]
pub(in crate::nc) struct Surface {
    pub speed: f64,
    pub most: f64,
}

/// 2^32: converts a number to LSB.
const BITS: f64 = 4_294_967_296.0;

impl<const AXES: usize> Interpreter<AXES> {
    /// F in mm/min. With G95, this is the feed at the programmed spindle speed.
    pub(super) fn path_feed(&self) -> Feed {
        let feed = self.modal.feed.unwrap_or(Feed::ZERO);
        if !functions::DIALECTS.is_built() || !self.foreign.now.per_turn {
            return feed;
        }
        // A value below 2^63 times a value below 2^63.
        let product = (i128::from(feed.to_bits()) * i128::from(self.foreign.now.speed.to_bits())) >> 32;
        Feed::from_bits(i64::try_from(product).unwrap_or(i64::MAX).max(1))
    }

    /// Checks that the spindle turns if F is per revolution.
    pub(super) fn needs_turning(&self, span: Span) -> Result<(), Fault> {
        let now = &self.foreign.now;
        if functions::DIALECTS.is_built() && now.per_turn && (now.spindle == 0 || now.speed == Position::ZERO)
        {
            return span.fault(NcErrorKind::Missing("S above 0 and M3 or M4 before it: F is per revolution"));
        }
        Ok(())
    }

    /// With G95, sets the feed of the motion per minute.
    pub(super) fn feed_of_turns(&mut self, span: Span) -> Result<(), Fault> {
        let Gathered::Motion(cell) = &self.gathered else { return Ok(()) };
        let motion = cell.get();
        if functions::DIALECTS.is_built()
            && self.foreign.now.per_turn
            && self.moves
            && motion.kind != MotionKind::Rapid
        {
            self.needs_turning(span)?;
            cell.set(Motion { feed: self.path_feed(), ..motion });
        }
        Ok(())
    }

    /// Carries out G96 with S and D, and G97.
    pub(super) fn choose_surface(
        &mut self,
        on: bool,
        block: &mut Block<AXES>,
        span: Span,
    ) -> Result<(), Fault> {
        if !on {
            self.foreign.now.surface = None;
            return Ok(());
        }
        let most = block.take(b'D').map_or(f64::INFINITY, |given| given.number.real());
        if block.value(b'S').is_none() {
            return span.fault(NcErrorKind::Missing("S, the speed of the surface"));
        }
        self.foreign.now.surface = Some(Surface { speed: 0.0, most });
        Ok(())
    }

    /// The spindle speed for G96 at the position of the axes.
    pub(super) fn speed_of_surface(&self, surface: Surface, span: Span) -> Result<Position, Fault> {
        let axis = self.setup.main.first().copied().flatten().unwrap_or_default();
        let place = self.position.get(axis).copied().unwrap_or_default().saturating_sub(self.offset(axis));
        let around = real::abs(place.to_bits() as f64 / BITS) * core::f64::consts::TAU;
        let free = if around > 0.0 { surface.speed / around } else { f64::INFINITY };
        let speed = if free > surface.most { surface.most } else { free };
        if !(0.0..1e9).contains(&speed) {
            return span.fault(NcErrorKind::Missing("D, the highest spindle speed, so near to X0"));
        }
        Ok(Position::from_bits(real::round(speed * BITS) as i64))
    }
}
