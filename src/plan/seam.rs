//! Decides as late as possible whether a real-time loop repeats (feature `plc`). At the end of each pass of
//! the loop (the seam), the planner must know whether another pass follows. The PLC says so in the variable
//! V.RTG.LOOP.ENABLED.
//!
//! While the decision is open, the planner releases only blocks that a longer path would not make faster.
//! After these blocks, the known path is always long enough for a stop. The planner decides when the
//! remaining path is no longer long enough and the queue holds at most [`SOON`] ticks of motion. This is
//! about two braking distances and [`SOON`] ticks before the seam, rounded up to whole blocks of the
//! look-ahead. To keep this distance short, a long line or arc is divided into two blocks.
use super::intake::{Entrance, Pass};
use super::{Planning, clock};
use crate::contour_log::{Crowded, Turn};
use crate::dynamics::Permitted;
use crate::lookahead::WAYS;
use crate::path::Piece;
use crate::quantity::{Distance, Position};

/// Ticks of motion in the queue below which the planner decides on the next pass. In this time, the planner
/// takes the pass and plans a full ring.
const SOON: u32 = 128;

/// What the caller does next at the end of a pass of a real-time loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seam {
    /// The queue holds enough motion: the call did no work. Call again after a tick.
    Wait,
    /// The call did some work, and there is more to do: call again.
    Working,
    /// The loop has to decide now whether another pass follows.
    Decide,
}

/// Factor for the path that must be known; it includes rounding.
const SPARE: f32 = 1.0625;

impl<const AXES: usize, const BLOCKS: usize> Entrance<'_, '_, AXES, BLOCKS> {
    /// Divides a long line or arc of a real-time loop into two blocks; the second one has the length of a
    /// stop. Returns `false`, and does nothing, if the element is too short.
    #[inline(never)]
    pub(super) fn push_parted(
        &mut self,
        piece: &Piece<'_, AXES>,
        limits: &Permitted,
        pass: &Pass,
        due: u32,
        end: Option<&[Position; AXES]>,
    ) -> bool {
        let is_plain = piece.shape.is_line() || piece.shape.turn().is_some();
        if !self.plc.parts || piece.continued || !is_plain || !self.ring.has_room_for_two() {
            return false;
        }
        let v = limits.0.v;
        let way = limits.0.brake().distance(0.0, v)[0] * (WAYS * SPARE);
        let (whole, last) = (piece.length.to_bits(), (way * (1u64 << 44) as f32) as i64);
        if whole / 2 <= last {
            return false;
        }
        let first = Piece { length: Distance::from_bits(whole - last), entry: piece.entry, ..*piece };
        self.push_here(&first, limits, &Pass { stop: false, ..*pass }, (due, false), end);
        let rest = Piece { length: Distance::from_bits(last), continued: true, entry: piece.exit, ..*piece };
        self.push_here(&rest, limits, pass, (due, false), None);
        self.ring.continue_last();
        true
    }
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Continues with the released path while it is not decided whether another pass of a real-time loop
    /// follows. Call this function only after [`super::Work::Hungry`].
    pub fn seam(&mut self) -> Seam {
        // If a line continues in the next pass, its parts stay separate elements.
        self.let_go();
        let now = self.queue.clock.now();
        // The queue is low intentionally, so this does not count as a late planner.
        (self.supply.seen, self.supply.low) = (now, 0);
        if self.frontier.end.wrapping_sub(now) > clock::TICK * SOON {
            return match self.wait_a_while() {
                super::Work::Waiting => Seam::Wait,
                _ => Seam::Working,
            };
        }
        if !self.lookahead.ring.is_long_enough() {
            return Seam::Decide;
        }
        self.begin_pass();
        Seam::Working
    }

    /// Begins a pass of a real-time loop after the last motion block, or ends the last pass there. The log of
    /// the path records this.
    ///
    /// # Errors
    /// Too many commands of the log wait for one motion block.
    pub fn turn(&mut self, turn: Turn, modulo: bool) -> Result<(), Crowded> {
        self.intake.plc.parts = turn != Turn::End;
        let taken = self.intake.taken;
        self.intake.plc.recorder.as_mut().map_or(Ok(()), |recorder| recorder.turn(taken, turn, modulo))?;
        self.settle_log();
        Ok(())
    }

    /// Whether a spline is on. Its curve depends on later blocks.
    pub fn has_spline(&self) -> bool {
        self.intake.smoothing.has_spline()
    }
}
