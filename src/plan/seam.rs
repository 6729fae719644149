//! The seam between two passes of a real-time loop: how long the planner can do without knowing what follows.
//!
//! What was taken in waits in the look-ahead. Of it the planner hands on only what a longer path would not make
//! faster: behind the blocks handed on there is always enough path to stop. When there is not enough any more, and the
//! queue runs low, the flag decides on the next pass.
//!
//! So the decision comes [`SOON`] ticks and about twice the path to a standstill ahead, in whole blocks of the
//! look-ahead. A line or an arc that is longer becomes two blocks.
use super::intake::{Entrance, Pass};
use super::{Planning, clock};
use crate::contour_log::{Crowded, Turn};
use crate::dynamics::Permitted;
use crate::lookahead::WAYS;
use crate::path::Piece;
use crate::quantity::{Distance, Position};

/// Ticks of motion in the queue below which the next pass is decided on: time to take it in and to plan a full ring.
const SOON: u32 = 128;

/// What is to be done at a seam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seam {
    /// There is time: nothing was done.
    Wait,
    /// Something was done; there is more.
    Working,
    /// What follows has to be known now.
    Decide,
}

/// That much longer than the path that has to be known, rounding included.
const SPARE: f32 = 1.0625;

impl<const AXES: usize, const BLOCKS: usize> Entrance<'_, '_, AXES, BLOCKS> {
    /// A line or an arc of a real-time loop becomes two blocks, if it is long: the second one has the path to a
    /// standstill. `false`: it does not, and nothing was done.
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
    /// What is to be done while it is not known what follows. Only after [`super::Work::Hungry`].
    pub fn seam(&mut self) -> Seam {
        // A line that goes on in the next pass is not one element with it.
        self.let_go();
        let now = self.queue.clock.now();
        // The queue is low on purpose.
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

    /// A pass of a real-time loop begins behind the last motion block taken in, or the last one ends there.
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

    /// Whether a spline is on.
    pub fn has_spline(&self) -> bool {
        self.intake.smoothing.has_spline()
    }
}
