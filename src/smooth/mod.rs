//! Smoothing of the path: from programmed blocks to the elements that are driven.
//!
//! A [`Smoother`] takes programmed blocks, holds back as many as it needs to know, works on them a bounded
//! piece per call, and emits elements. Stages above know [`Smoothing`], not which kind is at work. Contour
//! mode is the kind there is.
pub mod contour;

use crate::dynamics::{Curving, Dynamics};
use crate::nc::{Contour, NcWarningKind, Place, Plane};
use crate::path::{Element, Measure};
use crate::quantity::Position;
use contour::Contouring;

/// How a block was programmed, to make its rest anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Straight.
    Line,
    /// About a centre.
    Arc {
        /// In the two axes of the plane.
        centre: [Position; 2],
        /// Its plane.
        plane: Plane,
        /// G02.
        clockwise: bool,
    },
}

/// What goes with a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Data {
    /// Feed, mm/min; rapid without.
    pub feed: Option<f32>,
    /// Programmed N number.
    pub n: u32,
    /// Where it stands in the text.
    pub place: Place,
    /// Motion blocks before it.
    pub number: u32,
    /// It ends in an exact stop.
    pub stop: bool,
}

/// A block as it was programmed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgrammedBlock<const AXES: usize> {
    /// Its curve.
    pub element: Element<AXES>,
    /// Where that begins.
    pub from: [Position; AXES],
    /// Where it ends.
    pub to: [Position; AXES],
    /// How it was programmed.
    pub form: Form,
    /// What goes with it.
    pub data: Data,
}

/// An element on its way to the look-ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothed<'a, const AXES: usize> {
    /// The curve.
    pub element: &'a Element<AXES>,
    /// What goes with it.
    pub data: &'a Data,
    /// Set for a part of the curve in a corner.
    pub curving: Option<Curving>,
    /// Functions with no more motion blocks before them come before it.
    pub due: u32,
}

/// A stage between programmed blocks and the look-ahead.
pub trait Smoother<const AXES: usize> {
    /// Takes in the next block; only when [`Self::work`] has nothing to do and [`Self::emit`] no more.
    /// `parted`: functions stand between it and the block before.
    fn take(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>, parted: bool);

    /// Does a bounded piece of work. `false` if nothing is to be done, and only then [`Self::emit`] knows
    /// what goes on.
    fn work(&mut self, dynamics: &Dynamics<AXES>) -> bool;

    /// Hands the next element `into` the look-ahead, where it lies; `false` if none goes on before another
    /// block comes.
    fn emit(&mut self, into: impl FnOnce(&Smoothed<'_, AXES>)) -> bool;

    /// Holds nothing back any longer; `stop` demands a standstill at the end of the last block.
    fn flush(&mut self, stop: bool);

    /// The last block ends where it was programmed to. If it is left out, the corner before it stays.
    fn cancel(&mut self);

    /// Forgets what it holds.
    fn clear(&mut self);

    /// Off, with the parameters of program start. Only when it holds nothing.
    fn restart(&mut self);

    /// Where the block held back stands in the text: the one behind the corner that is emitted.
    fn place(&self) -> Option<Place>;

    /// What is to be said about the curve that the last block led to, once.
    fn remark(&mut self) -> Option<NcWarningKind>;

    /// Whether a block can go past this stage: nothing is held back, and its end is not rounded. Asked only
    /// when [`Self::emit`] has no more.
    fn is_idle(&self) -> bool;

    /// Whether nothing is to be done and nothing goes on before another block comes.
    fn is_empty(&self) -> bool;

    /// Whether the end of the last block is to be rounded.
    fn rounds(&self) -> bool;

    /// Whether a block is held back.
    fn holds(&self) -> bool;
}

/// The smoother at work, in one memory for all kinds.
#[derive(Clone, Copy, Debug)]
pub enum Smoothing<const AXES: usize> {
    /// #CONTOUR MODE, G61, G261.
    Contour(Contouring<AXES>),
}

impl<const AXES: usize> Smoothing<AXES> {
    /// Contour mode, off; `check_jerk` is P-CHAN-00110.
    pub fn new(measure: Measure, check_jerk: u8) -> Self {
        Self::Contour(Contouring::new(measure, check_jerk))
    }

    /// Takes in a command of contour mode. `in_motion`: it stands in a block with a motion.
    pub fn contour(&mut self, command: &Contour, in_motion: bool) {
        let Self::Contour(contouring) = self;
        contouring.command(command, in_motion);
    }
}

impl<const AXES: usize> Smoother<AXES> for Smoothing<AXES> {
    fn take(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>, parted: bool) {
        let Self::Contour(contouring) = self;
        contouring.take(block, dynamics, parted);
    }

    fn work(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        let Self::Contour(contouring) = self;
        contouring.work(dynamics)
    }

    fn emit(&mut self, into: impl FnOnce(&Smoothed<'_, AXES>)) -> bool {
        let Self::Contour(contouring) = self;
        contouring.emit(into)
    }

    fn flush(&mut self, stop: bool) {
        let Self::Contour(contouring) = self;
        contouring.flush(stop);
    }

    fn cancel(&mut self) {
        let Self::Contour(contouring) = self;
        contouring.cancel();
    }

    fn clear(&mut self) {
        let Self::Contour(contouring) = self;
        contouring.clear();
    }

    fn restart(&mut self) {
        let Self::Contour(contouring) = self;
        contouring.restart();
    }

    fn place(&self) -> Option<Place> {
        let Self::Contour(contouring) = self;
        contouring.place()
    }

    fn remark(&mut self) -> Option<NcWarningKind> {
        let Self::Contour(contouring) = self;
        contouring.remark()
    }

    #[inline(always)]
    fn is_idle(&self) -> bool {
        let Self::Contour(contouring) = self;
        contouring.is_idle()
    }

    #[inline(always)]
    fn is_empty(&self) -> bool {
        let Self::Contour(contouring) = self;
        contouring.is_empty()
    }

    fn rounds(&self) -> bool {
        let Self::Contour(contouring) = self;
        contouring.rounds()
    }

    fn holds(&self) -> bool {
        let Self::Contour(contouring) = self;
        contouring.holds()
    }
}
