//! P-CHAN-00239: the HSC B-spline and contour mode by turns. Lines become points of the curve; where an arc
//! begins or ends, contour mode takes over with the tolerance of the curve, as with
//! `#CONTOUR MODE [DEV PATH_DEV=X TRACK_DEV=Y RELEVANT_PATH=X RELEVANT_TRACK=Y]`, X and Y those of #HSC.
//!
//! A line with an arc on one side is halved: one half is the last or the first leg of the curve, the other one a
//! block of contour mode, of which a corner takes half at most. Both go straight where they meet.
use super::contour::{Contouring, Settings};
use super::spline::{Rules, Splining};
use super::{Form, Parting, ProgrammedBlock, Smoothed, Smoother};
use crate::dynamics::Dynamics;
use crate::nc::{Contour, ContourMethod, NcWarningKind, Place};
use crate::path::{Measure, line};
use crate::quantity::Position;

/// Which of the two is at work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    /// The B-spline.
    Curve,
    /// Contour mode.
    Corner,
}

/// A block that waits, and what stands before it.
type Waiting<const AXES: usize> = (ProgrammedBlock<AXES>, Parting);

/// The stage.
#[derive(Clone, Copy, Debug)]
pub struct Alternating<const AXES: usize> {
    measure: Measure,
    rules: Rules,
    curve: Splining<AXES>,
    corner: Contouring<AXES>,
    turn: Turn,
    /// The last line, or the half of it behind a corner.
    last: Option<Waiting<AXES>>,
    /// The block behind it, until what is before it is done.
    next: Option<Waiting<AXES>>,
    /// Nothing follows for now; `true` demands a standstill.
    ending: Option<bool>,
}

impl<const AXES: usize> Alternating<AXES> {
    /// On. `settings`: of contour mode, for what the tolerance does not say.
    pub fn new(measure: Measure, curve: Splining<AXES>, rules: Rules, settings: &Settings) -> Self {
        let [path, track] = [rules.path_dev, rules.track_dev]
            .map(|mm| Some(Position::from_bits((mm * (1u64 << 32) as f32) as i64)));
        let dev = Contour {
            method: Some(ContourMethod::Dev),
            path_dev: path,
            track_dev: track,
            relevant_path: path,
            relevant_track: track,
            ..Contour::default()
        };
        let corner = Contouring::with(measure, &settings.on_with(&dev));
        Self { measure, rules, curve, corner, turn: Turn::Curve, last: None, next: None, ending: None }
    }

    /// Whether the curve is deselected for this block, and the corners beside it are rounded.
    fn is_beside(&self, block: &ProgrammedBlock<AXES>) -> bool {
        block.form != Form::Line || (self.rules.rounds && !self.curve.is_leg(block))
    }

    /// Both halves of a line.
    fn halves(&self, block: &ProgrammedBlock<AXES>) -> Option<[ProgrammedBlock<AXES>; 2]> {
        let mut middle = block.from;
        for (x, to) in middle.iter_mut().zip(&block.to) {
            *x = Position::from_bits(x.to_bits() + (to.to_bits().saturating_sub(x.to_bits()) >> 1));
        }
        let first = line(&block.from, &middle, &self.measure).ok()??;
        let second = line(&middle, &block.to, &self.measure).ok()??;
        let data = super::Data { stop: false, ..block.data };
        Some([
            ProgrammedBlock { element: first, to: middle, data, ..*block },
            ProgrammedBlock { element: second, from: middle, ..*block },
        ])
    }

    /// The line that waits is a leg of the curve. Only when nothing is to be done.
    fn lay(&mut self, dynamics: &Dynamics<AXES>) {
        self.turn = Turn::Curve;
        if let Some((line, parting)) = self.last.take() {
            self.curve.take(&line, dynamics, parting);
        }
    }

    /// The line that waits is a block of contour mode. Only when nothing is to be done.
    fn round(&mut self, dynamics: &Dynamics<AXES>) {
        self.turn = Turn::Corner;
        if let Some((line, parting)) = self.last.take() {
            self.corner.take(&line, dynamics, parting);
        }
    }

    /// The curve ends, in the line that waits if there is more of it.
    fn end_curve(&mut self, dynamics: &Dynamics<AXES>) {
        let Some((line, parting)) = self.last else { return };
        if self.curve.is_empty() {
            return;
        }
        if let Some([first, second]) = self.halves(&line) {
            self.curve.take(&first, dynamics, parting);
            self.last = Some((second, Parting::None));
        }
        self.curve.cancel();
    }

    /// Contour mode ends in the line that waits.
    fn end_corner(&mut self, dynamics: &Dynamics<AXES>) {
        let Some((line, parting)) = self.last.take() else { return };
        let halves = self.halves(&line);
        let first = halves.as_ref().map_or(&line, |[first, _]| first);
        self.corner.take(first, dynamics, parting);
        self.corner.cancel();
        self.last = halves.map(|[_, second]| (second, Parting::None));
    }

    /// The block behind the line that waits comes in, when what is before it is done. Whether it does.
    fn let_in(&mut self, block: &Waiting<AXES>, dynamics: &Dynamics<AXES>) -> bool {
        let (block, parting) = block;
        let beside = self.is_beside(block);
        let is_done = match self.turn {
            Turn::Curve => self.curve.is_empty(),
            Turn::Corner if beside => !self.corner.hands_out(),
            Turn::Corner => self.corner.is_empty(),
        };
        if !is_done {
            return false;
        }
        self.next = None;
        if beside {
            self.round(dynamics);
            self.corner.take(block, dynamics, *parting);
        } else {
            self.lay(dynamics);
            self.last = Some((*block, *parting));
        }
        true
    }

    /// What is left when the one at work has nothing to do. Whether there is something.
    fn go_on(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        if let Some(next) = self.next {
            return self.let_in(&next, dynamics);
        }
        let Some(stop) = self.ending.take() else { return false };
        match self.turn {
            Turn::Curve => {
                self.lay(dynamics);
                self.curve.flush(stop);
            }
            Turn::Corner => {
                self.round(dynamics);
                self.corner.flush(stop);
            }
        }
        true
    }
}

impl<const AXES: usize> Smoother<AXES> for Alternating<AXES> {
    #[inline(never)]
    fn take(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>, parting: Parting) {
        let waiting = Some((*block, parting));
        if self.turn == Turn::Corner && self.last.is_none() && self.corner.is_empty() {
            self.turn = Turn::Curve;
        }
        match (self.turn, self.is_beside(block)) {
            (Turn::Curve, true) => {
                self.end_curve(dynamics);
                self.next = waiting;
            }
            (Turn::Curve, false) => {
                self.lay(dynamics);
                self.last = waiting;
            }
            (Turn::Corner, false) if self.last.is_none() => self.last = waiting,
            (Turn::Corner, true) if self.last.is_none() => self.corner.take(block, dynamics, parting),
            (Turn::Corner, beside) => {
                if beside {
                    self.round(dynamics);
                } else {
                    self.end_corner(dynamics);
                }
                self.next = waiting;
            }
        }
    }

    fn work(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        let works = match self.turn {
            Turn::Curve => self.curve.work(dynamics),
            Turn::Corner => self.corner.work(dynamics),
        };
        works || self.go_on(dynamics)
    }

    fn emit(&mut self, into: impl FnOnce(&Smoothed<'_, AXES>)) -> bool {
        match self.turn {
            Turn::Curve => self.curve.emit(into),
            Turn::Corner => self.corner.emit(into),
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
        self.curve.clear();
        self.corner.clear();
        (self.turn, self.last, self.next, self.ending) = (Turn::Curve, None, None, None);
    }

    fn restart(&mut self) {
        self.clear();
    }

    fn place(&self) -> Option<Place> {
        match self.turn {
            Turn::Curve => self.curve.place(),
            Turn::Corner => self.corner.place(),
        }
    }

    fn remark(&mut self) -> Option<NcWarningKind> {
        self.corner.remark()
    }

    fn is_idle(&self) -> bool {
        false
    }

    fn is_empty(&self) -> bool {
        let is_empty = match self.turn {
            Turn::Curve => self.curve.is_empty(),
            Turn::Corner => self.corner.is_empty(),
        };
        is_empty && self.last.is_none() && self.next.is_none()
    }

    fn rounds(&self) -> bool {
        match &self.next {
            Some((next, _)) => self.is_beside(next) && !next.data.stop,
            None => self.last.is_none() && self.turn == Turn::Corner && self.corner.rounds(),
        }
    }

    fn holds(&self) -> bool {
        !self.is_empty()
    }

    fn gives_way(&mut self) -> bool {
        // The path does not depend on when the text comes.
        false
    }
}
