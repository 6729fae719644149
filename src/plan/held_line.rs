//! The held line: consecutive blocks on a straight line with the same feed become one long line
//! ([`Stretch`]). So a short ring of blocks covers a long path.
//!
//! A command between two blocks (an exact stop, a function, other dynamics, contour mode) releases the held
//! line before the next block comes. So a command keeps its point of the path. The line stops growing as soon
//! as both conditions hold:
//!
//! - The line is at least twice as long as the path for reaching its speed, and as the path for braking from
//!   its speed.
//! - The line lasts so long that the rounding of its end point causes no step of speed above the limits
//!   ([`crate::dynamics::Dynamics::smoothing`]).
//!
//! Two such lines suffice for a full plan, and count as a full ring ([`crate::lookahead::Ring::is_full`]). So
//! the planner can release the first part of a long straight while later blocks are still being read.
use super::intake::Pass;
use super::{Planning, to_f32};
use crate::dynamics::{OverrideRange, Permitted, Share};
use crate::lookahead::SLOWEST;
use crate::math::float::max;
use crate::path::{Element, Piece, Straight, Stretch, TOLERANCE_MM};
use crate::quantity::{DISTANCE_LSB, Position};
use crate::slope::limits::Limits;

/// The held line, or none. Written and read in place, because it is large.
pub(super) struct HeldLine<const AXES: usize> {
    /// Whether a line is held.
    is_held: bool,
    /// Whether the line replaces several blocks and is long enough.
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

    /// Whether no line is held.
    pub const fn is_none(&self) -> bool {
        !self.is_held
    }

    /// Drops the held line.
    pub const fn clear(&mut self) {
        self.is_held = false;
    }
}

enum Curve<const AXES: usize> {
    Line(Stretch<AXES>),
    /// An arc that waits; only if the look-ahead had no room for two blocks.
    Arc(Element<AXES>),
}

/// A line is long enough at this multiple of the distances to reach its speed and to brake from it.
const WAYS: f32 = 2.0;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Holds a line, and releases the line held before.
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

    /// Passes an arc to the look-ahead, after the held line.
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

    /// Whether a PLC reads the path: each block then stays an element of its own, with its N number.
    #[inline(always)]
    const fn is_logged(&self) -> bool {
        #[cfg(feature = "plc")]
        if self.intake.plc.recorder.is_some() {
            return true;
        }
        false
    }

    /// Joins the line to the held line. Returns `false` if this is not possible.
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
            && !self.is_logged()
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

    /// Moves the held line into the look-ahead, which must have room.
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

    // Two calls, so that the stack frame of the first is gone before the second begins.

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

    /// Computes the limits of the held line again.
    pub(super) fn renew_held(&mut self) {
        let held = &mut self.intake.held;
        held.limits = match &held.curve {
            Curve::Line(stretch) => self.dynamics.element(&stretch.line().element(), held.pass.feed),
            Curve::Arc(element) => self.dynamics.element(element, held.pass.feed),
        };
    }

    /// Demands a stop at the end of the held line.
    pub(super) fn stop_held(&mut self) {
        self.intake.held.pass.stop = true;
    }
}
