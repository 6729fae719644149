//! The block held back: as long as blocks go on in a straight line with the same feed, they become one ([`Stretch`]).
//!
//! Nothing is lost by it: what belongs to the point between two blocks (an exact stop, an event, other dynamics, contour mode)
//! comes before the second one, and lets the first one go. A line grows until it is twice as long as the ways to its speed and
//! from it, and until a knee at its end, of what its tolerance leaves open, is too small to be seen. So a long straight line is
//! handed on while it is being read, and two pieces are a whole ring ([`crate::lookahead::Lookahead::is_full`]).
use super::{Data, Motion, Permitted, Planning, SLOWEST, max, to_f32};
use crate::lookahead::Limits;
use crate::path::{Element, Straight, Stretch, TOLERANCE_MM};

/// Such a block.
pub(super) struct Held<const AXES: usize> {
    curve: Curve<AXES>,
    limits: Permitted,
    data: Data,
    /// It stands for several, and is long enough.
    long: bool,
}

enum Curve<const AXES: usize> {
    Line(Stretch<AXES>),
    /// Only where the look-ahead had no room for two.
    Arc(Element<AXES>),
}

/// A line is long enough with so many ways to its speed and from it.
const WAYS: f32 = 2.0;

const LSB_44: f32 = 1.0 / (1u64 << 44) as f32;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Holds a line back; what was held back before goes on, unless both are one.
    pub(super) fn hold_line(
        &mut self,
        line: &Straight<AXES>,
        limits: &Permitted,
        motion: &Motion<AXES>,
        data: &Data,
    ) {
        if let Some(held) = &self.held
            && let Curve::Line(stretch) = &held.curve
            && held.data.feed == data.feed
            && !held.data.stop
            && !self.functions.are_open()
            && stretch.goes_on(line)
            && self.lengthen(motion, data)
        {
            return;
        }
        self.let_go();
        let stretch = Stretch::new(&self.programmed, line);
        self.held = Some(Held { curve: Curve::Line(stretch), limits: *limits, data: *data, long: false });
    }

    /// An arc goes on behind what was held back.
    pub(super) fn pass_arc(&mut self, element: &Element<AXES>, limits: &Permitted, data: &Data) {
        self.let_go();
        if self.lookahead.is_full() {
            self.held = Some(Held { curve: Curve::Arc(*element), limits: *limits, data: *data, long: false });
        } else {
            self.entrance().0.push(element, limits, data, data.number, false);
        }
    }

    /// The line held back becomes one with the block behind it; `false` if it does not.
    #[inline(never)]
    fn lengthen(&mut self, motion: &Motion<AXES>, data: &Data) -> bool {
        let Some(held) = &mut self.held else { return false };
        let Curve::Line(stretch) = &held.curve else { return false };
        // What the look-ahead counts in a block.
        let counts = data.number.wrapping_sub(self.numbered) < u32::from(u16::MAX);
        if held.long || !counts {
            return false;
        }
        let Some(grown) = stretch.with(&motion.target, &self.main) else { return false };
        let limits = self.dynamics.element(&grown.line().element(), data.feed);
        let length = to_f32(grown.line().length().to_bits());
        if length > limits.0.v * SLOWEST {
            return false;
        }
        let Limits { v, .. } = limits.0;
        let ways = max(limits.0.speed_up().distance(0.0, v)[0], limits.0.brake().distance(0.0, v)[0]);
        let enough = max(WAYS * ways, v * self.dynamics.smoothing(TOLERANCE_MM, data.feed.is_none()));
        *held = Held { curve: Curve::Line(grown), limits, data: *data, long: length * LSB_44 >= enough };
        true
    }

    /// What is held back goes into the look-ahead, which has room.
    pub(super) fn let_go(&mut self) {
        if self.held.is_some() {
            self.pass_on();
        }
    }

    /// Read in its place: it is large.
    #[inline(never)]
    fn pass_on(&mut self) {
        let (mut entrance, held) = self.entrance();
        let Some(Held { curve, limits, data, long }) = held else { return };
        match curve {
            Curve::Line(stretch) => {
                entrance.push(&stretch.line().element(), limits, data, data.number, *long);
            }
            Curve::Arc(element) => entrance.push(element, limits, data, data.number, false),
        }
        self.held = None;
    }

    /// What is held back gets the limits of now.
    pub(super) fn renew_held(&mut self) {
        let Some(held) = &mut self.held else { return };
        held.limits = match &held.curve {
            Curve::Line(stretch) => self.dynamics.element(&stretch.line().element(), held.data.feed),
            Curve::Arc(element) => self.dynamics.element(element, held.data.feed),
        };
    }

    /// The block held back ends in a standstill.
    pub(super) fn stop_held(&mut self) {
        if let Some(held) = &mut self.held {
            held.data.stop = true;
        }
    }
}
