//! An overlay: the motion of one axis beside the path, from the planner to the interrupt.
//!
//! It has pieces of time of its own, whose distance is the position of the axis, and a clock of its own: time
//! passes for it in every tick that finds a piece, whether the path moves or not. A motion is put in as a
//! whole, from rest to rest: what the interrupt has is enough to come to rest, whatever the planner does.
//! Until the planner gives the axis back the interrupt keeps it, also at rest.
//!
//! A change of what is put in is a cut, as for the path ([`super::time`]).
use super::word::Word;
use super::{Clock, Consumer, Phase, Producer, Ring, Slot};
use crate::quantity::Position;
use core::sync::atomic::{AtomicU32, Ordering};

/// Pieces of time handed over for an axis.
pub const OVERLAY_PHASES: usize = 64;

/// No axis.
const NONE: u32 = 0;

/// Bits that the position in a piece has more than a [`Position`]: 2^-44 for 2^-32.
const FINER: u32 = 12;

/// A position as a piece of an overlay has it, LSB 2^-44 mm or degrees.
pub const fn fine(position: Position) -> i64 {
    position.to_bits() << FINER
}

/// The set point of such a position, to nearest.
pub const fn set_point(fine: i64) -> Position {
    Position::from_bits((fine + (1 << (FINER - 1))) >> FINER)
}

/// Memory of an overlay, shared by planner and interrupt; all bits zero when new.
pub struct Overlay {
    pieces: Ring<Phase, OVERLAY_PHASES>,
    clock: Clock,
    /// The axis it moves, from 1. Written by the planner.
    axis: AtomicU32,
}

/// The planner's end.
pub struct OverlaySender<'a> {
    /// Pieces of time.
    pub pieces: Producer<'a, Phase, OVERLAY_PHASES>,
    /// Ticks of its own, and the cut.
    pub clock: &'a Clock,
    axis: &'a AtomicU32,
}

/// The interrupt's end.
pub struct OverlayReceiver<'a> {
    phase: Phase,
    pieces: Consumer<'a, Phase, OVERLAY_PHASES>,
    clock: &'a Clock,
    axis: &'a AtomicU32,
    /// Ticks of the piece evaluated.
    done: u16,
    /// The set point of the last tick.
    stands: Position,
}

impl Overlay {
    /// Memory for one; all bits zero.
    pub const fn new() -> Self {
        Self { pieces: Ring::new(), clock: Clock::blank(), axis: AtomicU32::ZERO }
    }

    /// Nothing is in it. Before both sides run.
    fn reset(&mut self) {
        self.pieces.split();
        self.clock.reset();
        self.axis = AtomicU32::new(NONE);
    }

    /// The planner's end. There is one.
    const fn sender(&self) -> OverlaySender<'_> {
        let (pieces, _) = self.pieces.ends();
        OverlaySender { pieces, clock: &self.clock, axis: &self.axis }
    }

    /// The interrupt's end. There is one.
    const fn receiver(&self) -> OverlayReceiver<'_> {
        let (_, pieces) = self.pieces.ends();
        let (clock, axis) = (&self.clock, &self.axis);
        OverlayReceiver { phase: Phase::BLANK, pieces, clock, axis, done: 0, stands: Position::ZERO }
    }
}

/// Empties all overlays and gives both ends of each.
pub fn overlay_ends<const OVERLAYS: usize>(
    memory: &mut [Overlay; OVERLAYS],
) -> ([OverlaySender<'_>; OVERLAYS], [OverlayReceiver<'_>; OVERLAYS]) {
    memory.iter_mut().for_each(Overlay::reset);
    let memory = &*memory;
    (memory.each_ref().map(Overlay::sender), memory.each_ref().map(Overlay::receiver))
}

impl Default for Overlay {
    fn default() -> Self {
        Self::new()
    }
}

impl OverlaySender<'_> {
    /// The interrupt moves this axis from its next tick on. A piece is in.
    pub fn take_over(&self, axis: u8) {
        self.axis.store(u32::from(axis) + 1, Ordering::Release);
    }

    /// The path has the axis again, which stands where the path has it.
    pub fn give_back(&self) {
        self.axis.store(NONE, Ordering::Release);
    }
}

impl OverlayReceiver<'_> {
    /// The set point of its axis at this tick, if it has one; whether it takes time of a piece.
    #[inline(always)]
    pub fn step<const AXES: usize>(&mut self, set_points: &mut [Position; AXES]) -> bool {
        let axis = self.axis.load(Ordering::Acquire);
        if axis == NONE {
            return false;
        }
        let moves = self.advance();
        if let Some(slot) = set_points.get_mut((axis - 1) as usize) {
            *slot = self.stands;
        }
        moves
    }

    #[inline(always)]
    fn advance(&mut self) -> bool {
        let instant = self.clock.begin();
        if let Some(number) = self.clock.cut(instant) {
            self.pieces.jump(number);
            self.done = u16::MAX;
        }
        if self.done >= self.phase.ticks {
            if !self.pieces.pop_into(&mut self.phase, |phase| phase.ticks > 0) {
                self.clock.rest();
                return false;
            }
            self.done = 0;
        }
        self.stands = set_point(self.phase.at(self.done));
        self.done += 1;
        self.clock.pass();
        true
    }
}
