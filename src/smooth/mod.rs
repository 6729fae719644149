//! Smoothing of the path: from programmed blocks to the elements that are driven.
//!
//! A [`Smoother`] takes programmed blocks, holds back as many as it needs to know, works on them a bounded
//! piece per call, and emits elements. Stages above know [`Smoothing`], not which kind is at work.
pub mod contour;
pub mod surface;

use crate::dynamics::{Curving, Dynamics};
use crate::nc::{Contour, Hsc, HscMethod, NcWarningKind, Place, Plane};
use crate::path::{Element, Measure};
use crate::quantity::Position;
use contour::Contouring;
use surface::Surface;

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

/// What stands between a block and the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parting {
    /// Nothing.
    None,
    /// Functions.
    Functions,
    /// Functions, of which an acknowledgement is waited for.
    Awaited,
}

/// A stage between programmed blocks and the look-ahead.
pub trait Smoother<const AXES: usize> {
    /// Takes in the next block; only when [`Self::work`] has nothing to do and [`Self::emit`] no more.
    fn take(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>, parting: Parting);

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

    /// The text is late, and the motion would stand still for it: whether what is held back now goes on.
    fn gives_way(&mut self) -> bool;
}

/// The kinds, in one memory.
#[derive(Debug)]
enum Kind<const AXES: usize> {
    /// #CONTOUR MODE, G61, G261.
    Contour(Contouring<AXES>),
    /// #HSC \[SURFACE\].
    Surface(Surface<AXES>),
}

/// The smoother at work, and what each of the others is to begin with.
#[derive(Debug)]
pub struct Smoothing<const AXES: usize> {
    measure: Measure,
    kind: Kind<AXES>,
    /// Contour mode while another kind is at work.
    contour: contour::Settings,
    surface: surface::Parameters,
    /// The kind of HSC that ON selects.
    method: HscMethod,
    /// What is to be at work as soon as nothing is held back: HSC, or contour mode.
    wanted: Option<bool>,
}

impl<const AXES: usize> Smoothing<AXES> {
    /// Contour mode, off; `check_jerk` is P-CHAN-00110.
    pub fn new(measure: Measure, check_jerk: u8) -> Self {
        let contouring = Contouring::new(measure, check_jerk);
        Self {
            measure,
            contour: contouring.settings(),
            kind: Kind::Contour(contouring),
            surface: surface::Parameters::new(check_jerk),
            method: HscMethod::Surface,
            wanted: None,
        }
    }

    /// Takes in a command of contour mode. `in_motion`: it stands in a block with a motion.
    pub fn contour(&mut self, command: &Contour, in_motion: bool) {
        match &mut self.kind {
            Kind::Contour(contouring) => contouring.command(command, in_motion),
            Kind::Surface(_) => self.contour.command(command),
        }
    }

    /// Whether HSC is on, or will be behind the blocks held back.
    pub fn is_hsc(&self) -> bool {
        self.wanted.unwrap_or(matches!(self.kind, Kind::Surface(_)))
    }

    /// Takes in parameters of #HSC, and its switch. What is held back ends where it was programmed to.
    ///
    /// While HSC is on, its parameters stay: `false` if the command gives some.
    pub fn hsc(&mut self, command: &Hsc) -> bool {
        let (on, gives) = (self.is_hsc(), command.gives_parameters());
        if on && gives && command.switch != Some(false) {
            return false;
        }
        if gives {
            self.method = command.method.unwrap_or(self.method);
            self.surface.update(command);
        }
        if let Some(switch) = command.switch.filter(|switch| *switch != on) {
            self.cancel();
            self.wanted = Some(switch);
        }
        true
    }

    /// Another kind gets to work. Only when nothing is held back.
    #[cold]
    #[inline(never)]
    fn change(&mut self, hsc: bool) {
        if let Kind::Contour(contouring) = &self.kind {
            self.contour = contouring.settings();
        }
        self.kind = if hsc {
            Kind::Surface(Surface::new(self.measure, &self.surface))
        } else {
            Kind::Contour(Contouring::with(self.measure, &self.contour))
        };
    }
}

/// What the kind at work does.
macro_rules! at_work {
    ($smoothing:ident, $kind:ident => $what:expr) => {
        match &mut $smoothing.kind {
            Kind::Contour($kind) => $what,
            Kind::Surface($kind) => $what,
        }
    };
    (ref $smoothing:ident, $kind:ident => $what:expr) => {
        match &$smoothing.kind {
            Kind::Contour($kind) => $what,
            Kind::Surface($kind) => $what,
        }
    };
}

impl<const AXES: usize> Smoother<AXES> for Smoothing<AXES> {
    fn take(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>, parting: Parting) {
        if let Some(hsc) = self.wanted.take() {
            self.change(hsc);
        }
        at_work!(self, kind => kind.take(block, dynamics, parting));
    }

    fn work(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        at_work!(self, kind => kind.work(dynamics))
    }

    fn emit(&mut self, into: impl FnOnce(&Smoothed<'_, AXES>)) -> bool {
        at_work!(self, kind => kind.emit(into))
    }

    fn flush(&mut self, stop: bool) {
        at_work!(self, kind => kind.flush(stop));
    }

    fn cancel(&mut self) {
        at_work!(self, kind => kind.cancel());
    }

    fn clear(&mut self) {
        at_work!(self, kind => kind.clear());
    }

    fn restart(&mut self) {
        if matches!(self.kind, Kind::Surface(_)) {
            self.change(false);
        }
        self.wanted = None;
        self.surface.restart();
        self.method = HscMethod::Surface;
        at_work!(self, kind => kind.restart());
    }

    fn place(&self) -> Option<Place> {
        at_work!(ref self, kind => kind.place())
    }

    fn remark(&mut self) -> Option<NcWarningKind> {
        at_work!(self, kind => kind.remark())
    }

    #[inline(always)]
    fn is_idle(&self) -> bool {
        self.wanted.is_none() && at_work!(ref self, kind => kind.is_idle())
    }

    #[inline(always)]
    fn is_empty(&self) -> bool {
        at_work!(ref self, kind => kind.is_empty())
    }

    fn rounds(&self) -> bool {
        at_work!(ref self, kind => kind.rounds())
    }

    fn holds(&self) -> bool {
        at_work!(ref self, kind => kind.holds())
    }

    fn gives_way(&mut self) -> bool {
        at_work!(self, kind => kind.gives_way())
    }
}
