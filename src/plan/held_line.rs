//! The block held back: as long as blocks go on in a straight line with the same feed, they become one
//! ([`Stretch`]).
//!
//! Nothing is lost by it: what belongs to the point between two blocks (an exact stop, an event, other
//! dynamics, contour mode) comes before the second one, and lets the first one go. A line grows until it is
//! twice as long as the ways to its speed and from it, and until a knee at its end, of what its tolerance
//! leaves open, is too small to be seen. So a long straight line is handed on while it is being read, and two
//! pieces are a whole ring ([`crate::lookahead::Ring::is_full`]).
use super::intake::Pass;
use super::{Planning, to_f32};
use crate::dynamics::{OverrideRange, Permitted, Share};
use crate::lookahead::SLOWEST;
use crate::math::float::max;
use crate::path::{Element, Piece, Straight, Stretch, TOLERANCE_MM};
use crate::quantity::{DISTANCE_LSB, Position};
use crate::slope::limits::Limits;

/// Such a block, or none. Written and read in its place: it is large.
pub(super) struct HeldLine<const AXES: usize> {
    /// There is one.
    is_held: bool,
    /// It stands for several, and is long enough.
    long: bool,
    curve: Curve<AXES>,
    limits: Permitted,
    pass: Pass,
}

impl<const AXES: usize> HeldLine<AXES> {
    pub const fn none() -> Self {
        Self {
            is_held: false,
            long: false,
            curve: Curve::Line(Stretch::BLANK),
            limits: (Limits::WIDEST, Share::WHOLE, OverrideRange::NONE),
            pass: Pass { feed: None, n: 0, number: 0, stop: false },
        }
    }

    /// Whether there is none.
    pub const fn is_none(&self) -> bool {
        !self.is_held
    }

    /// Forgets it.
    pub const fn clear(&mut self) {
        self.is_held = false;
    }
}

enum Curve<const AXES: usize> {
    Line(Stretch<AXES>),
    /// Only where the look-ahead had no room for two.
    Arc(Element<AXES>),
}

/// A line is long enough with so many ways to its speed and from it.
const WAYS: f32 = 2.0;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Holds a line back; what was held back before goes on.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn hold_line(&mut self, line: &Straight<AXES>, limits: &Permitted, pass: Pass) {
        self.let_go();
        let held = &mut self.intake.held;
        if let Curve::Line(stretch) = &mut held.curve {
            stretch.begin(&self.intake.programmed, line);
        } else {
            let mut stretch = Stretch::BLANK;
            stretch.begin(&self.intake.programmed, line);
            held.curve = Curve::Line(stretch);
        }
        (held.is_held, held.long, held.limits, held.pass) = (true, false, *limits, pass);
    }

    /// An arc goes on behind what was held back.
    pub(super) fn pass_arc(
        &mut self,
        element: &Element<AXES>,
        limits: &Permitted,
        pass: Pass,
        target: &[Position; AXES],
    ) {
        self.let_go();
        if self.lookahead.ring.is_full() {
            *self.intake.held =
                HeldLine { is_held: true, long: false, curve: Curve::Arc(*element), limits: *limits, pass };
        } else {
            self.entrance().0.push_arc(element, limits, &pass, pass.number, Some(target));
        }
    }

    /// The line held back becomes one with this one behind it; `false` if it does not.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn join_held(
        &mut self,
        line: &Straight<AXES>,
        target: &[Position; AXES],
        pass: &Pass,
    ) -> bool {
        let held = &self.intake.held;
        let Curve::Line(stretch) = &held.curve else { return false };
        held.is_held
            && !held.long
            && held.pass.feed == pass.feed
            && !held.pass.stop
            && stretch.goes_on(line)
            && !self.functions.are_open()
            && !self.queue.segments.is_crowded(pass.number)
            && self.lengthen(target, pass)
    }

    #[inline(never)]
    fn lengthen(&mut self, target: &[Position; AXES], pass: &Pass) -> bool {
        let held = &mut self.intake.held;
        let Curve::Line(stretch) = &mut held.curve else { return false };
        let Some(grown) = stretch.with(target, &self.measure) else { return false };
        let limits = self.dynamics.line(grown.tangent(), pass.feed);
        let length = to_f32(grown.length().to_bits());
        if length > limits.0.v * SLOWEST {
            return false;
        }
        let Limits { v, .. } = limits.0;
        let ways = max(limits.0.speed_up().distance(0.0, v)[0], limits.0.brake().distance(0.0, v)[0]);
        let enough = max(WAYS * ways, v * self.dynamics.smoothing(TOLERANCE_MM, pass.feed.is_none()));
        stretch.become_line(&grown);
        (held.limits, held.pass, held.long) = (limits, *pass, length * DISTANCE_LSB >= enough);
        true
    }

    /// What is held back goes into the look-ahead, which has room.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn let_go(&mut self) {
        if self.intake.held.is_held {
            self.pass_on();
        }
    }

    #[inline(never)]
    fn pass_on(&mut self) {
        match &self.intake.held.curve {
            Curve::Line(_) => self.pass_line_on(),
            Curve::Arc(_) => self.pass_arc_on(),
        }
    }

    // Two calls: what the one has on the stack is not below the other.

    #[inline(never)]
    fn pass_line_on(&mut self) {
        let (mut entrance, held) = self.entrance();
        let HeldLine { curve, limits, pass, long, .. } = held;
        if let Curve::Line(stretch) = curve {
            let (shape, ends) = &stretch.line().parts();
            let (timed, bent, trades, flows, through) = (false, false, false, false, false);
            let (length, continued, entry, exit) = (shape.length, false, ends, ends);
            let piece = Piece { shape, length, continued, entry, exit, timed, bent, trades, flows, through };
            #[cfg(feature = "plc")]
            let is_done = entrance.push_parted(&piece, limits, pass, pass.number, None);
            #[cfg(not(feature = "plc"))]
            let is_done = false;
            if !is_done {
                entrance.push_here(&piece, limits, pass, (pass.number, *long), None);
            }
        }
        self.intake.held.clear();
    }

    #[inline(never)]
    fn pass_arc_on(&mut self) {
        let (mut entrance, held) = self.entrance();
        if let Curve::Arc(element) = &held.curve {
            entrance.push_arc(element, &held.limits, &held.pass, held.pass.number, None);
        }
        self.intake.held.clear();
    }

    /// What is held back gets the limits of now.
    pub(super) fn renew_held(&mut self) {
        let held = &mut self.intake.held;
        held.limits = match &held.curve {
            Curve::Line(stretch) => self.dynamics.element(&stretch.line().element(), held.pass.feed),
            Curve::Arc(element) => self.dynamics.element(element, held.pass.feed),
        };
    }

    /// The block held back ends in a standstill.
    pub(super) fn stop_held(&mut self) {
        self.intake.held.pass.stop = true;
    }
}
