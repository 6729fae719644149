//! An overlay: the motion of a single axis that is independent of the path, passed from the planner to the
//! interrupt.
//!
//! An overlay has its own pieces, which give the position of the axis, and its own clock. This clock counts
//! the ticks that use a piece of the overlay, whether the path moves or not. The planner always writes a
//! whole motion from stop to stop. So the interrupt can finish the motion without the planner. The axis
//! belongs to the overlay, also at standstill, until the planner returns the axis to the path.
//!
//! A command that changes the motion uses a cut, as for the path ([`super::time`]).
use super::word::Word;
use super::{Clock, Consumer, Phase, Producer, Ring, Slot};
use crate::quantity::Position;
use core::sync::atomic::{AtomicU32, Ordering};

/// Number of pieces in an overlay (the motion of a single axis that is independent of the path).
pub const OVERLAY_PHASES: usize = 64;

/// No axis.
const NONE: u32 = 0;

/// Additional fraction bits of the position in a piece, compared with a [`Position`]: LSB 2^-44 and not
/// 2^-32.
const FINER: u32 = 12;

/// Converts a position to the unit of an overlay's pieces: LSB 2^-44 mm or degrees.
pub const fn fine(position: Position) -> i64 {
    position.to_bits() << FINER
}

/// Converts a value of an overlay's piece (LSB 2^-44 mm or degrees) to a set point, rounded to nearest.
pub const fn set_point(fine: i64) -> Position {
    Position::from_bits((fine + (1 << (FINER - 1))) >> FINER)
}

/// Memory for the motion of a single axis that is independent of the path. Planner and interrupt share this
/// memory; all bits are zero when new.
pub struct Overlay {
    pieces: Ring<Phase, OVERLAY_PHASES>,
    clock: Clock,
    /// The axis that the overlay moves, counted from 1. The planner writes this word.
    axis: AtomicU32,
}

/// The planner's handle of an overlay.
pub struct OverlaySender<'a> {
    /// Writes the pieces of the axis motion.
    pub pieces: Producer<'a, Phase, OVERLAY_PHASES>,
    /// The clock of the overlay, and the tick of a change of its plan (the cut).
    pub clock: &'a Clock,
    axis: &'a AtomicU32,
}

/// The interrupt's handle of an overlay.
pub struct OverlayReceiver<'a> {
    phase: Phase,
    pieces: Consumer<'a, Phase, OVERLAY_PHASES>,
    clock: &'a Clock,
    axis: &'a AtomicU32,
    /// Number of ticks evaluated in the current piece.
    done: u16,
    /// The set point of the last tick.
    stands: Position,
}

impl Overlay {
    /// Memory for an overlay without motion; all bits are zero.
    pub const fn new() -> Self {
        Self { pieces: Ring::new(), clock: Clock::blank(), axis: AtomicU32::ZERO }
    }

    /// Empties the overlay. Call this function before both sides run.
    fn reset(&mut self) {
        self.pieces.split();
        self.clock.reset();
        self.axis = AtomicU32::new(NONE);
    }

    /// The planner's handle. The caller makes only one.
    const fn sender(&self) -> OverlaySender<'_> {
        let (pieces, _) = self.pieces.ends();
        OverlaySender { pieces, clock: &self.clock, axis: &self.axis }
    }

    /// The interrupt's handle. The caller makes only one.
    const fn receiver(&self) -> OverlayReceiver<'_> {
        let (_, pieces) = self.pieces.ends();
        let (clock, axis) = (&self.clock, &self.axis);
        OverlayReceiver { phase: Phase::BLANK, pieces, clock, axis, done: 0, stands: Position::ZERO }
    }
}

/// Empties all overlays and returns both handles of each.
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
    /// Lets the interrupt move this axis with the overlay from the next tick on. The overlay must already
    /// hold a piece.
    pub fn take_over(&self, axis: u8) {
        self.axis.store(u32::from(axis) + 1, Ordering::Release);
    }

    /// Returns the axis to the path. The axis must stand at the position from which the planner of the path
    /// continues.
    pub fn give_back(&self) {
        self.axis.store(NONE, Ordering::Release);
    }
}

impl OverlayReceiver<'_> {
    /// Does one tick: if the overlay has an axis, writes the set point of that axis. Returns whether the tick
    /// used a piece.
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
