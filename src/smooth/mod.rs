//! Smoothing of the path: from programmed blocks to the elements that are driven.
//!
//! A [`Smoother`] takes programmed blocks, holds back as many as it needs to know, works on them a bounded
//! piece per call, and emits elements. Stages above know [`Smoothing`], not which kind is at work.
//!
//! What a build leaves out ([`crate::machine::functions`]) is a kind without values (`absent.rs`), at the only place
//! where kinds are named, below.
#![cfg_attr(
    not(all(feature = "contour", feature = "surface", feature = "splines")),
    allow(dead_code, clippy::large_enum_variant, reason = "what is left out is not used, and has no size")
)]
#[cfg(not(all(feature = "surface", feature = "splines")))]
mod absent;
mod alternating;
pub mod contour;
#[cfg(feature = "splines")]
mod direct;
mod edged;
mod halved;
pub mod spline;
#[cfg(not(feature = "contour"))]
mod straight;
pub mod surface;

#[cfg(not(feature = "surface"))]
use absent::Absent as Edged;
#[cfg(not(feature = "splines"))]
use absent::{Absent as Alternating, Absent as Splining};
#[cfg(feature = "splines")]
use alternating::Alternating;
#[cfg(feature = "contour")]
use contour::Contouring;
#[cfg(feature = "surface")]
use edged::Edged;
#[cfg(feature = "splines")]
use spline::Splining;
#[cfg(not(feature = "contour"))]
use straight::Straight as Contouring;

use crate::dynamics::{Curving, Dynamics, Known};
use crate::nc::{Contour, ContourMethod, ContourSwitch, Hsc, HscMethod, NcWarningKind, Place, Plane};
use crate::path::{Element, End, Measure};
use crate::quantity::Position;
use contour::Preset;
#[cfg(feature = "splines")]
use spline::{DirectParameters, Start};
use spline::{HscParameters, Mode};

/// How a block was programmed, to make the rest of it again.
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

/// Data that go with a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Data {
    /// Feed, mm/min; rapid without.
    pub feed: Option<f32>,
    /// Programmed N number.
    pub n: u32,
    /// Place of the block in the text.
    pub place: Place,
    /// Motion blocks before it.
    pub number: u32,
    /// Whether the block ends in an exact stop.
    pub stop: bool,
}

impl Data {
    /// Of no block.
    pub(crate) const BLANK: Self = Self {
        feed: None,
        n: 0,
        place: Place { line: 0, column: 0, offset: 0, length: 0, file: 0 },
        number: 0,
        stop: false,
    };
}

/// A block as it was programmed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgrammedBlock<const AXES: usize> {
    /// The curve of the block.
    pub element: Element<AXES>,
    /// Start of the curve.
    pub from: [Position; AXES],
    /// End of the curve.
    pub to: [Position; AXES],
    /// How the block was programmed.
    pub form: Form,
    /// Data of the block.
    pub data: Data,
}

/// An element for the look-ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothed<'a, const AXES: usize> {
    /// The curve.
    pub element: &'a Element<AXES>,
    /// End of the element, if it is known, to the last bit.
    pub end: Option<&'a [Position; AXES]>,
    /// Data of its block.
    pub data: &'a Data,
    /// Set for a part of the curve in a corner.
    pub curving: Option<Curving>,
    /// Functions with no more motion blocks before them come before it.
    pub due: u32,
    /// Limits of the element, if they are known already.
    pub known: Option<&'a Known>,
}

/// Half way from one point to another.
fn middle<const AXES: usize>(from: &[Position; AXES], to: &[Position; AXES]) -> [Position; AXES] {
    let mut middle = *from;
    for (x, to) in middle.iter_mut().zip(to) {
        *x = Position::from_bits(x.to_bits() + (to.to_bits().saturating_sub(x.to_bits()) >> 1));
    }
    middle
}

/// What separates a block from the one before.
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
    /// #CONTOUR MODE, G61, G261, and #HSC \[OPMODE=1\].
    Contour(Contouring<AXES>),
    /// G151, #HSC \[BSPLINE\], #HSC \[OPMODE=2\].
    Spline(Splining<AXES>),
    /// #HSC \[BSPLINE\] with P-CHAN-00239.
    Alternating(Alternating<AXES>),
    /// #HSC \[SURFACE\].
    Surface(Edged<AXES>),
}

impl<const AXES: usize> Kind<AXES> {
    /// Becomes contour mode with these settings: in its place, if it is that already.
    #[inline(never)]
    fn begin_contour(&mut self, measure: Measure, settings: &contour::Settings) {
        match self {
            Self::Contour(contouring) => contouring.begin(settings),
            kind => *kind = Self::Contour(Contouring::with(measure, settings)),
        }
    }
}

/// A kind that is to be at work as soon as nothing is held back.
#[derive(Debug)]
enum Wanted<const AXES: usize> {
    /// Contour mode as it is in force.
    Contour,
    /// #HSC \[OPMODE=1\].
    Rounding,
    /// A spline.
    #[cfg(feature = "splines")]
    Spline(Start<AXES>),
    /// #HSC \[SURFACE\].
    #[cfg(feature = "surface")]
    Surface,
}

/// What the program has switched on beside contour mode.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Selected {
    /// Nothing.
    None,
    /// G151.
    Spline,
    /// #HSC.
    Hsc(HscMethod),
}

/// Why a command about splines is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SplineError {
    /// Less points than the curve needs: those that there are, and those it needs.
    TooFewPoints {
        /// Since it was switched on.
        points: u32,
        /// At least.
        needed: u32,
    },
    /// 120255: contour mode or #HSC while a spline is on, or the other way round.
    InSpline,
    /// 120370: G150 or G151 while #HSC is on.
    InHsc,
    /// Path length counts along more than three axes.
    FeedAxes,
}

/// State of the program where it switches a spline on.
#[derive(Clone, Copy, Debug)]
pub struct Before<'a, const AXES: usize> {
    /// Motion blocks taken in.
    pub taken: u32,
    /// End of the last one.
    pub exit: Option<&'a End<AXES>>,
}

/// The smoother at work, and what each of the others is to begin with.
#[derive(Debug)]
pub struct Smoothing<const AXES: usize> {
    measure: Measure,
    kind: Kind<AXES>,
    /// Contour mode while another kind is at work.
    contour: contour::Settings,
    #[cfg(feature = "splines")]
    spline: DirectParameters<AXES>,
    hsc: HscParameters,
    #[cfg(feature = "surface")]
    surface: surface::Parameters,
    selected: Selected,
    wanted: Option<Wanted<AXES>>,
}

impl<const AXES: usize> Smoothing<AXES> {
    /// Contour mode, off; `auto_contour_mode`: P-CHAN-00239.
    // In place, in every build: as a result it would be on the stack twice.
    #[inline(always)]
    pub fn new(measure: Measure, preset: Preset, auto_contour_mode: u8) -> Self {
        Self {
            measure,
            contour: contour::Settings::off(preset),
            kind: Kind::Contour(Contouring::new(measure, preset)),
            #[cfg(feature = "splines")]
            spline: DirectParameters::at_start(),
            hsc: HscParameters::new(auto_contour_mode),
            #[cfg(feature = "surface")]
            surface: surface::Parameters::new(preset.check_jerk),
            selected: Selected::None,
            wanted: None,
        }
    }

    /// Takes in a command of contour mode. `in_motion`: it stands in a block with a motion.
    ///
    /// # Errors
    /// It would round corners of a spline.
    pub fn contour(&mut self, command: &Contour, in_motion: bool) -> Result<(), SplineError> {
        let rounds = matches!(command.switch, Some(ContourSwitch::Block | ContourSwitch::On));
        if rounds && self.selected == Selected::Spline {
            return Err(SplineError::InSpline);
        }
        match &mut self.kind {
            Kind::Contour(contouring) if self.selected == Selected::None && self.wanted.is_none() => {
                contouring.command(command, in_motion);
            }
            _ => {
                self.contour.command(command);
                if self.selected == Selected::None && self.contour.is_on() {
                    self.want(Wanted::Contour);
                }
            }
        }
        Ok(())
    }

    /// Path length counts along three axes at most.
    fn check_axes(&self) -> Result<(), SplineError> {
        let fed = (0..AXES).filter(|k| self.measure.feeds(*k)).count();
        if fed > 3 { Err(SplineError::FeedAxes) } else { Ok(()) }
    }

    /// Whether a direct spline is on.
    #[cfg(feature = "plc")]
    pub fn has_spline(&self) -> bool {
        self.selected == Selected::Spline
    }

    /// Whether contour mode is in force.
    fn rounds_corners(&self) -> bool {
        self.rounding().is_on()
    }

    /// Contour mode, at work or not.
    fn rounding(&self) -> contour::Settings {
        match &self.kind {
            Kind::Contour(contouring) if self.wanted.is_none() => contouring.settings(),
            _ => self.contour,
        }
    }

    /// Axes that a block may move although it ends on them where it begins, bit i for axis i: by the interim point
    /// of POS, or by a vector at an end of a spline.
    #[inline(never)]
    pub fn swung(&self) -> u32 {
        let swings = self.measure.main.places().into_iter().zip(self.rounding().swings());
        let swung = swings.filter(|(_, swings)| *swings).filter_map(|(axis, _)| axis);
        let given = (0..AXES).filter(|k| self.leans(*k));
        swung.chain(given).fold(0, |axes, k| axes | 1u32.wrapping_shl(k as u32))
    }

    /// Takes in parameters of #HSC, and its switch. What is held back ends where it was programmed to.
    ///
    /// While HSC is on, its parameters stay: `false` if the command gives some.
    ///
    /// # Errors
    /// It is refused, and nothing has changed.
    pub fn hsc(&mut self, command: &Hsc) -> Result<bool, SplineError> {
        let on = matches!(self.selected, Selected::Hsc(_));
        if self.selected == Selected::Spline {
            return if command.switch == Some(false) { Ok(true) } else { Err(SplineError::InSpline) };
        }
        let gives = command.gives_parameters();
        if on && gives && command.switch != Some(false) {
            return Ok(false);
        }
        let method = self.method(command);
        if command.switch == Some(true) && method != HscMethod::Surface {
            self.check_axes()?;
        }
        if gives {
            self.hsc.update(command);
            #[cfg(feature = "surface")]
            if method == HscMethod::Surface {
                self.surface.update(command);
            }
        }
        match command.switch {
            Some(true) if !on => self.begin_hsc(method),
            Some(false) if on => {
                self.selected = Selected::None;
                self.want(Wanted::Contour);
            }
            _ => {}
        }
        Ok(true)
    }

    fn begin_hsc(&mut self, method: HscMethod) {
        #[cfg(feature = "splines")]
        let spline = |mode: Mode| Wanted::Spline(Start { mode, slope: None, entry: None });
        let wanted = match method {
            #[cfg(feature = "surface")]
            HscMethod::Surface => Wanted::Surface,
            #[cfg(feature = "splines")]
            HscMethod::Bspline => spline(Mode::Control(self.hsc.rules)),
            #[cfg(feature = "splines")]
            HscMethod::Op(2) => spline(Mode::Interpolating(self.hsc.conterror_mm())),
            // What is not compiled in does not come here.
            _ => Wanted::Rounding,
        };
        self.keep_contour();
        self.selected = Selected::Hsc(method);
        self.want(wanted);
    }

    /// The method that #HSC ON takes with this command.
    pub fn method(&self, command: &Hsc) -> HscMethod {
        command.method.unwrap_or(self.hsc.method)
    }

    /// Whether a direct B-spline is on, which has no arcs.
    pub fn refuses_arcs(&self) -> bool {
        self.selected == Selected::Spline && self.spline_mode() == Some(Mode::Direct)
    }

    fn spline_mode(&self) -> Option<Mode> {
        match (&self.wanted, &self.kind) {
            #[cfg(feature = "splines")]
            (Some(Wanted::Spline(start)), _) => Some(start.mode),
            (None, Kind::Spline(splining)) => Some(splining.mode()),
            _ => None,
        }
    }

    /// Another kind is to be at work. What is held back ends where it was programmed to.
    fn want(&mut self, wanted: Wanted<AXES>) {
        self.cancel();
        self.wanted = Some(wanted);
    }

    /// What is in force of contour mode stays for later. Only where nothing is selected beside it.
    fn keep_contour(&mut self) {
        if let (Kind::Contour(contouring), None) = (&self.kind, &self.wanted) {
            self.contour = contouring.settings();
        }
    }

    /// Another kind gets to work. Only when nothing is held back.
    #[cold]
    #[inline(never)]
    fn change(&mut self, wanted: &Wanted<AXES>) {
        match wanted {
            Wanted::Contour => self.begin_contour(),
            Wanted::Rounding => self.begin_rounding(),
            #[cfg(feature = "splines")]
            Wanted::Spline(Start { mode: Mode::Control(rules), .. }) if rules.rounds_arcs => {
                self.begin_alternating(rules);
            }
            #[cfg(all(feature = "surface", feature = "splines"))]
            Wanted::Spline(Start { mode: Mode::Control(rules), .. }) if rules.is_bounded() => {
                self.begin_bounded(rules);
            }
            #[cfg(feature = "splines")]
            Wanted::Spline(start) => self.begin_curve(start),
            #[cfg(feature = "surface")]
            Wanted::Surface => self.begin_surface(),
        }
    }

    // One at a time on the stack, and nothing twice.

    #[inline(never)]
    fn begin_contour(&mut self) {
        self.kind.begin_contour(self.measure, &self.contour);
    }

    #[inline(never)]
    fn begin_rounding(&mut self) {
        let settings = self.settings_of_hsc();
        self.kind.begin_contour(self.measure, &settings);
    }

    /// Contour mode as #HSC \[OPMODE=1\] has it.
    #[inline(never)]
    fn settings_of_hsc(&self) -> contour::Settings {
        let dev = Contour {
            method: Some(ContourMethod::Dev),
            path_dev: Some(self.hsc.conterror),
            ..Contour::default()
        };
        self.contour.on_with(&dev)
    }

    #[cfg(feature = "splines")]
    #[inline(never)]
    fn begin_curve(&mut self, start: &Start<AXES>) {
        let check_jerk = self.contour.check_jerk_of_channel();
        self.kind = Kind::Spline(Splining::new(self.measure, check_jerk, start));
    }

    /// A B-spline inside a tolerance: the kernels of Surface are its curves, and edges have those of contour mode.
    #[cfg(all(feature = "surface", feature = "splines"))]
    #[inline(never)]
    fn begin_bounded(&mut self, rules: &spline::Rules) {
        let parameters = surface::Parameters::of_spline(rules, self.contour.check_jerk_of_channel());
        self.kind = Kind::Surface(Edged::new(self.measure, &parameters));
    }

    #[cfg(feature = "splines")]
    #[inline(never)]
    fn begin_alternating(&mut self, rules: &spline::Rules) {
        let settings = alternating::settings(rules, &self.contour);
        self.lay_alternating(rules, &settings);
    }

    #[cfg(feature = "splines")]
    #[inline(never)]
    fn lay_alternating(&mut self, rules: &spline::Rules, settings: &contour::Settings) {
        self.kind = Kind::Alternating(Alternating::new(self.measure, *rules, *settings));
    }

    #[cfg(feature = "surface")]
    #[inline(never)]
    fn begin_surface(&mut self) {
        self.kind = Kind::Surface(Edged::new(self.measure, &self.surface));
    }
}

/// What the kind at work does.
macro_rules! at_work {
    ($smoothing:ident, $kind:ident => $what:expr) => {
        match &mut $smoothing.kind {
            Kind::Contour($kind) => $what,
            Kind::Spline($kind) => $what,
            Kind::Alternating($kind) => $what,
            Kind::Surface($kind) => $what,
        }
    };
    (ref $smoothing:ident, $kind:ident => $what:expr) => {
        match &$smoothing.kind {
            Kind::Contour($kind) => $what,
            Kind::Spline($kind) => $what,
            Kind::Alternating($kind) => $what,
            Kind::Surface($kind) => $what,
        }
    };
}

impl<const AXES: usize> Smoother<AXES> for Smoothing<AXES> {
    fn take(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>, parting: Parting) {
        if let Some(wanted) = self.wanted.take() {
            self.change(&wanted);
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
        self.wanted = None;
        self.selected = Selected::None;
        self.restart_direct();
        self.hsc = self.hsc.restarted();
        #[cfg(feature = "surface")]
        self.surface.restart();
        self.contour = self.contour.restarted();
        self.change(&Wanted::Contour);
    }

    fn place(&self) -> Option<Place> {
        at_work!(ref self, kind => kind.place())
    }

    fn remark(&mut self) -> Option<NcWarningKind> {
        at_work!(self, kind => kind.remark())
    }

    #[cfg_attr(feature = "fast", inline(always))]
    fn is_idle(&self) -> bool {
        self.wanted.is_none() && at_work!(ref self, kind => kind.is_idle())
    }

    #[cfg_attr(feature = "fast", inline(always))]
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
