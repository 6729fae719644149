//! `#HSC \[SURFACE\]`: Surface smooths runs of lines, and contour mode rounds the corners where its curve is
//! better.
//!
//! Contour mode rounds a corner between two lines if the corner is an edge (`surface/edges.rs`), by the
//! method DEV with the tolerances of Surface. If an arc stays exact, contour mode also rounds the transitions
//! at both ends of the arc, except with CIR_MODE=0. At a tangential transition, its curve leads from one
//! curvature to the other.
//!
//! A line with an edge at one end is halved. The half away from the edge is the first or the last chord of a
//! run of Surface. The half at the edge is a block of contour mode, and the corner's curve may take nearly
//! all of it. Both curves are straight where the halves meet.
use super::contour::{Contouring, Settings};
use super::halved::{Waiting, halve};
use super::surface::{Edges, Parameters, Surface, Used};
use super::{Form, Parting, ProgrammedBlock, Smoothed, Smoother};
use crate::dynamics::Dynamics;
use crate::nc::{NcWarningKind, Place};
use crate::path::Measure;

/// The active smoother.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "one of both is at work at a time, in static memory")]
enum Turn<const AXES: usize> {
    /// Surface.
    Surface(Surface<AXES>),
    /// Contour mode.
    Corner(Contouring<AXES>),
}

/// The smoothing stage of `#HSC [SURFACE]` with contour mode at sharp corners.
#[derive(Debug)]
pub struct Edged<const AXES: usize> {
    measure: Measure,
    parameters: Parameters,
    turn: Turn<AXES>,
    /// The last line before an edge, or its half there; after an edge, the last line.
    last: Option<Waiting<AXES>>,
    /// Whether that line is half a line.
    half: bool,
    /// If this line replaces merged lines: the share of the tolerance that they use.
    used: Used,
    /// The block after that line. This block waits until all work before it is done.
    next: Option<Waiting<AXES>>,
    /// Set if no block follows for now; the value tells whether the motion stops.
    ending: Option<bool>,
    /// The warning about a corner.
    remark: Option<NcWarningKind>,
}

impl<const AXES: usize> Edged<AXES> {
    /// A smoother with these parameters.
    #[inline(always)]
    pub fn new(measure: Measure, parameters: &Parameters) -> Self {
        Self {
            measure,
            parameters: *parameters,
            turn: Turn::Surface(Surface::new(measure, parameters)),
            last: None,
            half: false,
            used: Used::NOTHING,
            next: None,
            ending: None,
            remark: None,
        }
    }

    fn edges(&self) -> Edges<'_> {
        Edges::new(&self.parameters, &self.measure)
    }

    #[cold]
    #[inline(never)]
    fn begin_surface(&mut self) {
        if let Turn::Corner(corner) = &mut self.turn {
            self.remark = self.remark.or(corner.remark());
        }
        self.turn = Turn::Surface(Surface::new(self.measure, &self.parameters));
    }

    #[cold]
    #[inline(never)]
    fn begin_corner(&mut self) {
        if let Turn::Surface(surface) = &mut self.turn {
            self.remark = self.remark.or(surface.remark());
        }
        let settings = Settings::at_edges(self.parameters.check_jerk());
        self.turn = Turn::Corner(Contouring::with(self.measure, &settings));
    }

    /// Passes the waiting line to contour mode, as half a line or as a whole line. `rapid`: the block after
    /// it is rapid motion.
    #[inline(never)]
    fn round(&mut self, rapid: bool, half: bool, dynamics: &Dynamics<AXES>) {
        let Some((line, parting)) = &self.last else { return };
        let tolerance = self.edges().tolerance(rapid && line.data.feed.is_none(), self.used);
        if let Turn::Corner(corner) = &mut self.turn {
            corner.tolerate([tolerance.path, tolerance.track], half);
            corner.take(line, dynamics, *parting);
        }
    }

    /// Whether a block makes an edge with the last line of a run; the run then ends before that line. A
    /// separate function, because the rest of the line is large.
    #[inline(never)]
    fn leave(&mut self, block: &ProgrammedBlock<AXES>, parting: Parting, dynamics: &Dynamics<AXES>) -> bool {
        let Turn::Surface(surface) = &mut self.turn else { return false };
        let Some((half, used)) = surface.leave(block, dynamics, &mut self.last) else { return false };
        (self.half, self.used) = (half, used);
        self.wait(block, parting);
        true
    }

    /// Stores a block that waits. A separate function, because it has two callers.
    #[inline(never)]
    fn wait(&mut self, block: &ProgrammedBlock<AXES>, parting: Parting) {
        self.next = Some((*block, parting));
    }

    /// Takes a block after the waiting line, which belongs to contour mode.
    #[inline(never)]
    fn follow(&mut self, block: &ProgrammedBlock<AXES>, parting: Parting, dynamics: &Dynamics<AXES>) {
        let rapid = block.data.feed.is_none();
        let Some((line, _)) = &mut self.last else {
            self.next = Some((*block, parting));
            return;
        };
        let edges = Edges::new(&self.parameters, &self.measure);
        if parting != Parting::Awaited && edges.between(line, block, dynamics) {
            self.round(rapid, false, dynamics);
            (self.last, self.used) = (Some((*block, parting)), Used::NOTHING);
            return;
        }
        self.end(dynamics);
        self.next = Some((*block, parting));
    }

    /// Handles a waiting line without an edge at its end: half of the line goes to contour mode, and the
    /// other half waits.
    #[inline(never)]
    fn end(&mut self, dynamics: &Dynamics<AXES>) {
        let Some((line, _)) = &mut self.last else { return };
        let whole = line.data.stop && !self.parameters.stands() || line.form != Form::Line;
        let rest = if whole { None } else { halve(line, &self.measure) };
        self.round(false, rest.is_some(), dynamics);
        if let Turn::Corner(corner) = &mut self.turn {
            corner.cancel();
        }
        match (rest, &mut self.last) {
            (Some(rest), Some((line, parting))) => {
                rest.follow(line);
                *parting = Parting::None;
            }
            _ => self.last = None,
        }
    }

    /// Continues when the active smoother has no work. Returns whether there was work.
    fn go_on(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        let busy = match &self.turn {
            Turn::Surface(surface) => surface.hands_out(),
            Turn::Corner(corner) => corner.hands_out(),
        };
        if busy || self.next.is_none() && self.ending.is_none() {
            return false;
        }
        self.change(dynamics)
    }

    /// Passes the waiting line to the active smoother, or changes to the other smoother.
    #[cold]
    #[inline(never)]
    fn change(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        let Some((next, parting)) = &self.next else {
            let Some(stop) = self.ending.take() else { return false };
            self.round(false, false, dynamics);
            self.last = None;
            match &mut self.turn {
                Turn::Surface(surface) => surface.flush(stop),
                Turn::Corner(corner) => corner.flush(stop),
            }
            return true;
        };
        let edges = Edges::new(&self.parameters, &self.measure);
        match &mut self.turn {
            Turn::Surface(surface) if self.last.is_none() && !edges.keeps(next) => {
                surface.take(next, dynamics, *parting);
                self.next = None;
            }
            Turn::Surface(surface) => {
                if surface.holds() {
                    return false;
                }
                let rapid = next.data.feed.is_none();
                self.begin_corner();
                self.round(rapid, self.half, dynamics);
                (self.last, self.used) = (self.next.take(), Used::NOTHING);
            }
            Turn::Corner(corner) => {
                if corner.holds() {
                    return false;
                }
                self.begin_surface();
                if let (Turn::Surface(surface), Some((line, _))) = (&mut self.turn, &self.last) {
                    surface.take_half(line, dynamics);
                }
                self.last = None;
            }
        }
        true
    }
}

impl<const AXES: usize> Smoother<AXES> for Edged<AXES> {
    #[inline(never)]
    fn take(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>, parting: Parting) {
        if matches!(self.turn, Turn::Corner(_)) {
            self.follow(block, parting, dynamics);
            return;
        }
        if parting != Parting::Awaited && self.leave(block, parting, dynamics) {
            return;
        }
        if self.edges().keeps(block) {
            self.wait(block, parting);
        }
        if let Turn::Surface(surface) = &mut self.turn {
            if self.next.is_some() {
                surface.flush(false);
            } else {
                surface.take(block, dynamics, parting);
            }
        }
    }

    fn work(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        let works = match &mut self.turn {
            Turn::Surface(surface) => surface.work(dynamics),
            Turn::Corner(corner) => corner.work(dynamics),
        };
        works || self.go_on(dynamics)
    }

    fn emit(&mut self, into: impl FnOnce(&Smoothed<'_, AXES>)) -> bool {
        match &mut self.turn {
            Turn::Surface(surface) => surface.emit(into),
            Turn::Corner(corner) => corner.emit(into),
        }
    }

    fn flush(&mut self, stop: bool) {
        if let (Turn::Surface(surface), None) = (&mut self.turn, &self.next) {
            surface.flush(stop);
        } else if self.holds() {
            self.ending = Some(stop || self.ending == Some(true));
        }
    }

    fn cancel(&mut self) {
        self.flush(false);
    }

    fn clear(&mut self) {
        (self.last, self.next, self.ending) = (None, None, None);
        match &mut self.turn {
            Turn::Surface(surface) => surface.clear(),
            Turn::Corner(_) => self.begin_surface(),
        }
    }

    fn restart(&mut self) {
        self.clear();
    }

    fn place(&self) -> Option<Place> {
        match &self.turn {
            Turn::Surface(surface) => surface.place(),
            Turn::Corner(corner) => corner.place(),
        }
    }

    fn remark(&mut self) -> Option<NcWarningKind> {
        self.remark.take().or_else(|| match &mut self.turn {
            Turn::Surface(surface) => surface.remark(),
            Turn::Corner(corner) => corner.remark(),
        })
    }

    fn is_idle(&self) -> bool {
        false
    }

    fn is_empty(&self) -> bool {
        !self.holds()
    }

    fn rounds(&self) -> bool {
        false
    }

    fn holds(&self) -> bool {
        let at_work = match &self.turn {
            Turn::Surface(surface) => surface.holds(),
            Turn::Corner(corner) => !corner.is_empty(),
        };
        at_work || self.last.is_some() || self.next.is_some()
    }

    fn gives_way(&mut self) -> bool {
        if let (Turn::Surface(surface), None) = (&mut self.turn, &self.next) {
            return surface.gives_way();
        }
        let waits = self.holds() && self.ending.is_none();
        self.flush(false);
        waits
    }
}
