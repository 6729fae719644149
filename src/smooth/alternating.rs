//! `#HSC \[BSPLINE\]` with P-CHAN-00239: the B-spline smooths lines, and contour mode rounds the corners at
//! both ends of an arc.
//!
//! The ends of lines become points of the B-spline. Contour mode works with the tolerances of the spline, as
//! after `#CONTOUR MODE [DEV PATH_DEV=X TRACK_DEV=Y RELEVANT_PATH=X RELEVANT_TRACK=Y]`. X and Y are PATH_DEV
//! and TRACK_DEV of `#HSC`. With P-CHAN-00239 = 1, contour mode also takes lines that the spline cannot use,
//! for example a line that moves no axis of the path.
//!
//! A line between other lines and an arc is halved. The half away from the arc is the first or the last line
//! of the spline. The half at the arc is a block of contour mode, and the corner's curve takes at most half
//! of it. Both curves are straight where the halves meet.
use super::contour::{Contouring, Settings};
use super::halved::{Waiting, halve};
use super::spline::{Mode, Rules, Splining, Start, is_leg};
use super::{Form, Parting, ProgrammedBlock, Smoothed, Smoother};
use crate::dynamics::Dynamics;
use crate::nc::{Contour, ContourMethod, NcWarningKind, Place};
use crate::path::Measure;
use crate::quantity::Position;

/// The active smoother.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "one of both is at work at a time, in static memory")]
enum Turn<const AXES: usize> {
    /// No smoother is active yet.
    None,
    /// The B-spline.
    Curve(Splining<AXES>),
    /// Contour mode.
    Corner(Contouring<AXES>),
}

/// The smoothing stage of the HSC B-spline, with contour mode at the ends of arcs and at points that the
/// spline would pass exactly.
#[derive(Clone, Copy, Debug)]
pub struct Alternating<const AXES: usize> {
    measure: Measure,
    rules: Rules,
    /// Settings of contour mode.
    settings: Settings,
    turn: Turn<AXES>,
    /// The last line, or its half after a corner.
    last: Option<Waiting<AXES>>,
    /// The block after the waiting line. This block waits until all work before it is done.
    next: Option<Waiting<AXES>>,
    /// Set if no block follows for now; the value tells whether the motion stops.
    ending: Option<bool>,
    /// The warning about a corner.
    remark: Option<NcWarningKind>,
}

impl<const AXES: usize> Alternating<AXES> {
    /// A smoother with the settings of contour mode from [`settings`].
    #[inline(always)]
    pub const fn new(measure: Measure, rules: Rules, settings: Settings) -> Self {
        Self {
            measure,
            rules,
            settings,
            turn: Turn::None,
            last: None,
            next: None,
            ending: None,
            remark: None,
        }
    }

    /// Whether contour mode takes the block and rounds the corners at both of its ends.
    fn is_beside(&self, block: &ProgrammedBlock<AXES>) -> bool {
        block.form != Form::Line || (self.rules.rounds && !is_leg(&self.measure, block))
    }

    /// Whether the active smoother has no work left.
    fn is_done(&self) -> bool {
        match &self.turn {
            Turn::None => true,
            Turn::Curve(curve) => curve.is_empty(),
            Turn::Corner(corner) => corner.is_empty(),
        }
    }

    /// The B-spline begins.
    #[cold]
    #[inline(never)]
    fn begin_curve(&mut self) {
        if let Turn::Corner(corner) = &mut self.turn {
            self.remark = corner.remark();
        }
        let start = Start { mode: Mode::Control(self.rules), slope: None, entry: None };
        let check_jerk = self.settings.check_jerk_of_channel();
        self.turn = Turn::Curve(Splining::new(self.measure, check_jerk, &start));
    }

    /// Contour mode begins.
    #[cold]
    #[inline(never)]
    fn begin_corner(&mut self) {
        self.turn = Turn::Corner(Contouring::with(self.measure, &self.settings));
    }

    /// Makes the waiting line a leg of the curve. Call this function only if there is no work, and contour
    /// mode holds no block.
    fn lay(&mut self, dynamics: &Dynamics<AXES>) {
        if !matches!(self.turn, Turn::Curve(_)) {
            self.begin_curve();
        }
        if let (Turn::Curve(curve), Some((line, parting))) = (&mut self.turn, &self.last) {
            curve.take(line, dynamics, *parting);
        }
        self.last = None;
    }

    /// Makes the waiting line a block of contour mode. Call this function only if there is no work, and the
    /// curve holds no block.
    fn round(&mut self, dynamics: &Dynamics<AXES>) {
        if !matches!(self.turn, Turn::Corner(_)) {
            self.begin_corner();
        }
        if let (Turn::Corner(corner), Some((line, parting))) = (&mut self.turn, &self.last) {
            corner.take(line, dynamics, *parting);
        }
        self.last = None;
    }

    /// Ends the active smoother inside the waiting line, of which half is left.
    fn end(&mut self, dynamics: &Dynamics<AXES>) {
        let Some((line, parting)) = &mut self.last else { return };
        let rest = halve(line, &self.measure);
        match &mut self.turn {
            Turn::None => {}
            Turn::Curve(curve) => {
                curve.take(line, dynamics, *parting);
                curve.cancel();
            }
            Turn::Corner(corner) => {
                corner.take(line, dynamics, *parting);
                corner.cancel();
            }
        }
        if let Some(rest) = rest {
            rest.follow(line);
            *parting = Parting::None;
        } else {
            self.last = None;
        }
    }

    /// Takes the block after the waiting line, when everything before is done. Returns whether a block was
    /// taken.
    fn let_in(&mut self, beside: bool, dynamics: &Dynamics<AXES>) -> bool {
        let is_done = match &self.turn {
            Turn::Corner(corner) if beside => !corner.hands_out(),
            _ => self.is_done(),
        };
        if !is_done {
            return false;
        }
        if beside {
            let goes_out = self.last.is_some();
            self.round(dynamics);
            if goes_out {
                // The waiting line has gone to contour mode; the next call takes the next block.
                return true;
            }
            if let (Turn::Corner(corner), Some((block, parting))) = (&mut self.turn, &self.next) {
                corner.take(block, dynamics, *parting);
            }
        } else {
            self.lay(dynamics);
            self.last = self.next;
        }
        self.next = None;
        true
    }

    /// Continues when the active smoother has no work. Returns whether there was work.
    fn go_on(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        if let Some((next, _)) = &self.next {
            return self.let_in(self.is_beside(next), dynamics);
        }
        let Some(stop) = self.ending.take() else { return false };
        match &self.turn {
            Turn::None | Turn::Curve(_) => self.lay(dynamics),
            Turn::Corner(_) => self.round(dynamics),
        }
        match &mut self.turn {
            Turn::None => {}
            Turn::Curve(curve) => curve.flush(stop),
            Turn::Corner(corner) => corner.flush(stop),
        }
        true
    }
}

impl<const AXES: usize> Smoother<AXES> for Alternating<AXES> {
    #[inline(never)]
    fn take(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>, parting: Parting) {
        let beside = self.is_beside(block);
        let waits = match &mut self.turn {
            Turn::None | Turn::Curve(_) if !beside => {
                self.lay(dynamics);
                &mut self.last
            }
            Turn::Curve(curve) if !curve.is_empty() => {
                self.end(dynamics);
                &mut self.next
            }
            // A spline over the waiting line alone is not needed.
            Turn::None | Turn::Curve(_) => &mut self.next,
            Turn::Corner(corner) if self.last.is_none() && beside => {
                return corner.take(block, dynamics, parting);
            }
            Turn::Corner(_) if self.last.is_none() => &mut self.last,
            Turn::Corner(_) => {
                if beside {
                    self.round(dynamics);
                } else {
                    self.end(dynamics);
                }
                &mut self.next
            }
        };
        *waits = Some((*block, parting));
    }

    fn work(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        let works = match &mut self.turn {
            Turn::None => false,
            Turn::Curve(curve) => curve.work(dynamics),
            Turn::Corner(corner) => corner.work(dynamics),
        };
        works || self.go_on(dynamics)
    }

    fn emit(&mut self, into: impl FnOnce(&Smoothed<'_, AXES>)) -> bool {
        match &mut self.turn {
            Turn::None => false,
            Turn::Curve(curve) => curve.emit(into),
            Turn::Corner(corner) => corner.emit(into),
        }
    }

    fn flush(&mut self, stop: bool) {
        if self.holds() {
            self.ending = Some(stop || self.ending == Some(true));
        }
    }

    fn cancel(&mut self) {
        self.flush(false);
    }

    fn clear(&mut self) {
        self.turn = Turn::None;
        (self.last, self.next, self.ending) = (None, None, None);
    }

    fn restart(&mut self) {
        self.clear();
    }

    fn place(&self) -> Option<Place> {
        match &self.turn {
            Turn::None => None,
            Turn::Curve(curve) => curve.place(),
            Turn::Corner(corner) => corner.place(),
        }
    }

    fn remark(&mut self) -> Option<NcWarningKind> {
        match &mut self.turn {
            Turn::Corner(corner) => self.remark.take().or_else(|| corner.remark()),
            Turn::None | Turn::Curve(_) => self.remark.take(),
        }
    }

    fn is_idle(&self) -> bool {
        false
    }

    fn is_empty(&self) -> bool {
        self.is_done() && self.last.is_none() && self.next.is_none()
    }

    fn rounds(&self) -> bool {
        match (&self.next, &self.turn) {
            (Some((next, _)), _) => self.is_beside(next) && !next.data.stop,
            (None, Turn::Corner(corner)) => self.last.is_none() && corner.rounds(),
            (None, Turn::None | Turn::Curve(_)) => false,
        }
    }

    fn holds(&self) -> bool {
        !self.is_empty()
    }

    fn gives_way(&mut self) -> bool {
        // No: the path must not depend on the arrival time of text.
        false
    }
}

/// Settings of contour mode at arcs. `own` has the values that the rules do not give.
#[inline(never)]
pub fn settings(rules: &Rules, own: &Settings) -> Settings {
    let [path, track] = [rules.path_dev, rules.track_dev]
        .map(|mm| Some(Position::from_bits((mm * (1u64 << 32) as f32) as i64)));
    own.on_with(&Contour {
        method: Some(ContourMethod::Dev),
        path_dev: path,
        track_dev: track,
        relevant_path: path,
        relevant_track: track,
        ..Contour::default()
    })
}
