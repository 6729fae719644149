//! Smoothing of the path: turns programmed blocks into the elements that the axes follow.
//!
//! A [`Smoother`] takes programmed blocks, and holds back as many as the smoothing needs. The smoother works
//! on these blocks in bounded steps, and emits elements. There are smoothers for contour mode, for Surface,
//! for splines, and for the B-spline with P-CHAN-00239. Other stages use only [`Smoothing`], which contains
//! the active smoother.
//!
//! A build may leave out kinds of smoothing ([`crate::machine::functions`]). A type without values replaces
//! such a kind (`absent.rs`). Only this file names the kinds.
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
#[cfg(all(feature = "kinematics", feature = "surface"))]
mod row;
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

/// Whether a block is a line or an arc. From this form, the rest of a shortened block is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A straight line.
    Line,
    /// An arc about a centre.
    Arc {
        /// Centre of the arc in the two axes of the plane, mm.
        centre: [Position; 2],
        /// Plane of the arc.
        plane: Plane,
        /// Whether the arc is clockwise (G02).
        clockwise: bool,
    },
}

/// Data of a programmed block for the later stages, without its geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Data {
    /// Feed, mm/min; `None` for rapid motion.
    pub feed: Option<f32>,
    /// N number of the block in the program.
    pub n: u32,
    /// Place of the block in the text.
    pub place: Place,
    /// Number of motion blocks before this block, counted since the split.
    pub number: u32,
    /// Whether the block ends in an exact stop.
    pub stop: bool,
}

impl Data {
    /// Data without a block.
    pub(crate) const BLANK: Self = Self {
        feed: None,
        n: 0,
        place: Place { line: 0, column: 0, offset: 0, length: 0, file: 0 },
        number: 0,
        stop: false,
    };
}

/// A motion block before smoothing: its geometry, its programmed form and its data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgrammedBlock<const AXES: usize> {
    /// The geometry of the block: a line or an arc.
    pub element: Element<AXES>,
    /// Start of the block, mm or degrees.
    pub from: [Position; AXES],
    /// End of the block, mm or degrees.
    pub to: [Position; AXES],
    /// The programmed form: line or arc. From this form, a part of the block can be computed.
    pub form: Form,
    /// Feed, N number and place of the block.
    pub data: Data,
}

/// The result of smoothing: an element of the path for the look-ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothed<'a, const AXES: usize> {
    /// The geometry of the element.
    pub element: &'a Element<AXES>,
    /// Exact end of the element, if known.
    pub end: Option<&'a [Position; AXES]>,
    /// Feed, N number and place of the block to which the element belongs.
    pub data: &'a Data,
    /// Additional limits inside the curve of a corner; `None` if the element is not part of such a curve.
    pub curving: Option<Curving>,
    /// A number of motion blocks. If no more motion blocks are before a function in the program, the function
    /// acts before the element.
    pub due: u32,
    /// Limits of the element, if already known.
    pub known: Option<&'a Known>,
}

/// The point half way between two points.
fn middle<const AXES: usize>(from: &[Position; AXES], to: &[Position; AXES]) -> [Position; AXES] {
    let mut middle = *from;
    for (x, to) in middle.iter_mut().zip(to) {
        *x = Position::from_bits(x.to_bits() + (to.to_bits().saturating_sub(x.to_bits()) >> 1));
    }
    middle
}

/// The kind of commands that the program has between a block and the block before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parting {
    /// No command.
    None,
    /// Functions.
    Functions,
    /// M, H, S or T functions, at least one with an acknowledgement.
    Awaited,
}

/// A smoothing stage: takes programmed blocks, and emits elements for the look-ahead.
pub trait Smoother<const AXES: usize> {
    /// Takes the next block. Call this function only if [`Self::work`] has no work and [`Self::emit`] has no
    /// element.
    fn take(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>, parting: Parting);

    /// Does a bounded step of work. Returns `false` if there is no work; only then may [`Self::emit`] be
    /// called.
    fn work(&mut self, dynamics: &Dynamics<AXES>) -> bool;

    /// Calls `into` with the next element. Returns `false`, without a call, if the stage has to take another
    /// block first.
    fn emit(&mut self, into: impl FnOnce(&Smoothed<'_, AXES>)) -> bool;

    /// Ends the wait for further blocks, so that all held blocks are emitted. `stop`: whether the motion
    /// stops at the end of the last block.
    fn flush(&mut self, stop: bool);

    /// Gives no curve to the end of the last block, so the motion passes its programmed point.
    fn cancel(&mut self);

    /// Drops all held blocks and elements, as an abort demands.
    fn clear(&mut self);

    /// Switches the smoother off and restores the parameters of program start. Call this function only if no
    /// block is held.
    fn restart(&mut self);

    /// Place in the text of the held block, which is the block after the corner that is being emitted. `None`
    /// if no block is held.
    fn place(&self) -> Option<Place>;

    /// The warning about the curve before the last block, if there is one. Each warning is returned once.
    fn remark(&mut self) -> Option<NcWarningKind>;

    /// Whether the next block can bypass this stage: no block is held, and the end of the next block is not
    /// rounded. Call this function only if [`Self::emit`] has no element.
    fn is_idle(&self) -> bool;

    /// Whether there is neither work nor an element until another block comes.
    fn is_empty(&self) -> bool;

    /// Whether the end of the last block gets a curve.
    fn rounds(&self) -> bool;

    /// Whether a block is held back.
    fn holds(&self) -> bool;

    /// Called when program text is late and the motion would stop. Returns whether the stage releases its
    /// held blocks now.
    fn gives_way(&mut self) -> bool;
}

/// The current smoother. All kinds share the same memory.
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
    /// Changes to contour mode with these settings; in place if contour mode is already active.
    #[inline(never)]
    fn begin_contour(&mut self, measure: Measure, settings: &contour::Settings) {
        match self {
            Self::Contour(contouring) => contouring.begin(settings),
            kind => *kind = Self::Contour(Contouring::with(measure, settings)),
        }
    }
}

/// The kind of smoother that replaces the current one when no block is held.
#[derive(Debug)]
enum Wanted<const AXES: usize> {
    /// Contour mode with the current settings.
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

/// The smoothing function that the program has switched on, besides contour mode.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Selected {
    /// No other function.
    None,
    /// G151.
    Spline,
    /// #HSC.
    Hsc(HscMethod),
}

/// The reason why a spline command is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SplineError {
    /// The program has given fewer points than the curve needs.
    TooFewPoints {
        /// Number of points since the spline was switched on.
        points: u32,
        /// Smallest number of points that the curve needs.
        needed: u32,
    },
    /// ISG's error 120255: contour mode or `#HSC` is switched on during a spline, or a spline while contour
    /// mode is on.
    InSpline,
    /// ISG's error 120370: G150 or G151 while `#HSC` is on.
    InHsc,
    /// The feed refers to more than three axes, and a spline permits at most three.
    FeedAxes,
}

/// The motion before the place where the program switches a spline on.
#[derive(Clone, Copy, Debug)]
pub struct Before<'a, const AXES: usize> {
    /// Number of motion blocks that the program has had so far.
    pub taken: u32,
    /// End of the last block: direction and curvature; `None` if there is no block.
    pub exit: Option<&'a End<AXES>>,
}

/// The smoothing stage of a channel: the current smoother, and the parameters of the others.
#[derive(Debug)]
pub struct Smoothing<const AXES: usize> {
    measure: Measure,
    kind: Kind<AXES>,
    /// Settings of contour mode while another kind is active.
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
    /// Starts with contour mode, switched off. `auto_contour_mode`: value of P-CHAN-00239. Inline, so that
    /// the value is made in place; a returned value would be on the stack twice.
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

    /// Takes a command of contour mode. `in_motion`: whether the command is in a block with a motion.
    ///
    /// # Errors
    /// The command switches contour mode on while a spline is on.
    pub fn contour(&mut self, command: &Contour, in_motion: bool) -> Result<(), SplineError> {
        let rounds = matches!(command.switch, Some(ContourSwitch::Block | ContourSwitch::On));
        if rounds && self.selected == Selected::Spline {
            return Err(SplineError::InSpline);
        }
        #[cfg(all(feature = "kinematics", feature = "surface"))]
        if self.is_row() {
            self.change_row(command);
            return Ok(());
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

    /// Checks that path length counts along at most three axes.
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

    /// Settings of contour mode, active or not.
    fn rounding(&self) -> contour::Settings {
        match &self.kind {
            Kind::Contour(contouring) if self.wanted.is_none() => contouring.settings(),
            _ => self.contour,
        }
    }

    /// Axes that a block may move although its start and end positions are equal for them: bit i is axis i.
    /// The cause is an interim point of POS, or a vector at an end of a spline.
    #[inline(never)]
    pub fn swung(&self) -> u32 {
        let swings = self.measure.main.places().into_iter().zip(self.rounding().swings());
        let swung = swings.filter(|(_, swings)| *swings).filter_map(|(axis, _)| axis);
        let given = (0..AXES).filter(|k| self.leans(*k));
        swung.chain(given).fold(0, |axes, k| axes | 1u32.wrapping_shl(k as u32))
    }

    /// Takes a command `#HSC`: its parameters, and ON or OFF. The held blocks end at their programmed points.
    ///
    /// While HSC is on, its parameters stay unchanged. Returns `false` if the command tries to change them.
    ///
    /// # Errors
    /// The command is refused; nothing has changed.
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
            // Kinds that are not compiled in never arrive here.
            _ => Wanted::Rounding,
        };
        self.keep_contour();
        self.selected = Selected::Hsc(method);
        self.want(wanted);
    }

    /// The method that `#HSC ON` selects with this command.
    pub fn method(&self, command: &Hsc) -> HscMethod {
        command.method.unwrap_or(self.hsc.method)
    }

    /// Whether a direct B-spline is on, which permits no arcs.
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

    /// Selects another kind. The held blocks end at their programmed points.
    fn want(&mut self, wanted: Wanted<AXES>) {
        self.cancel();
        self.wanted = Some(wanted);
    }

    /// Saves the settings of contour mode for later. Call this function only if no other function is
    /// selected.
    fn keep_contour(&mut self) {
        if let (Kind::Contour(contouring), None) = (&self.kind, &self.wanted) {
            self.contour = contouring.settings();
        }
    }

    /// Changes to another kind. Call this function only if no block is held.
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

    // Only one kind at a time is on the stack.

    #[inline(never)]
    fn begin_contour(&mut self) {
        self.kind.begin_contour(self.measure, &self.contour);
    }

    #[inline(never)]
    fn begin_rounding(&mut self) {
        let settings = self.settings_of_hsc();
        self.kind.begin_contour(self.measure, &settings);
    }

    /// Contour mode with the settings of `#HSC \[OPMODE=1\]`.
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

    /// Begins a B-spline inside a tolerance. The smoothing curves of Surface make its curves, and contour
    /// mode rounds its edges.
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

/// Calls a function of the current smoother.
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
        #[cfg(all(feature = "kinematics", feature = "surface"))]
        self.choose_row(dynamics);
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
        #[cfg(all(feature = "kinematics", feature = "surface"))]
        if self.is_row() {
            return false;
        }
        at_work!(self, kind => kind.gives_way())
    }
}
