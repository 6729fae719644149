//! The transformation of machines with rotary axes (feature `kinematics`): elements of tool tip and angles
//! become elements of the axes.
//!
//! While a transformation is active, intake and smoothing use workpiece coordinates. The main axes then hold
//! the position of the tool tip, and the rotary axes hold their angles. After smoothing, each element is
//! split into polynomials of the axes ([`Splitter`]), one polynomial per call. If an axis has a software
//! limit, all polynomials of the element are checked before the first one enters the look-ahead.
//!
//! A command that changes the transformation takes effect at a standstill, after all blocks before the
//! command.
use super::intake::Pass;
use super::{Intake, MotionError, Planning, Work};
use crate::dynamics::{Curving, Near};
use crate::kinematics::element::widened;
use crate::kinematics::{Kinematic, SplitError, Splitter};
use crate::machine::Beyond;
use crate::nc::{Motion, MotionKind, Place};
use crate::path::{self, Element, End, Passage};
use crate::quantity::{Distance, Position};
use crate::smooth::{Data, Form, ProgrammedBlock, Smoothed, Smoother};

/// The reason why `#KIN ID` or `#TRAFO` does not change the transformation (machines with rotary axes).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SwitchError {
    /// Another transformation, with this identifier, is still active (ISG's message 20687).
    Active(u16),
    /// The machine data have no transformation with this identifier.
    Unknown(u16),
    /// The program has selected no transformation, and the machine data have no default (P-CHAN-00032).
    None,
}

impl core::fmt::Display for SwitchError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Active(id) => {
                write!(f, "kinematic {id} is active; expected #TRAFO OFF before another one is selected")
            }
            Self::Unknown(id) => {
                write!(f, "the machine has no kinematic {id}; expected the id of a trafo[] (P-CHAN-00262)")
            }
            Self::None => f.write_str(
                "no kinematic is selected; expected #KIN ID before, or kinematik_id (P-CHAN-00032)",
            ),
        }
    }
}

impl core::error::Error for SwitchError {}

/// How many curves of the tool tip have been transformed, and into how many curves of the axes, for reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Split {
    /// Number of curves of the programmed path.
    pub elements: u32,
    /// Number of polynomials for the axes into which the curves were split.
    pub polynomials: u32,
}

/// An element that is being split.
struct Job<'a> {
    splitter: Splitter<'a>,
    /// Path length of the element.
    length: Distance,
    /// Largest ratio of the speed along the curve to the path speed.
    fastest: f32,
    /// How the motion passes the element, where the smoother decides that: at one speed, or with acceleration at
    /// both ends.
    passage: Option<Passage>,
    data: Data,
    curving: Curving,
    due: u32,
    /// Whether the polynomials are being checked, before the first of them enters the look-ahead.
    is_checking: bool,
}

impl Job<'_> {
    /// Path length of polynomial `number`. The sum of these lengths is exactly the length of the element.
    fn length_of(&self, number: u32) -> Distance {
        let (length, cells) = (self.length.to_bits(), i64::from(self.splitter.cells().max(1)));
        let (part, rest) = (length / cells, length % cells);
        // The rest times the number is below 2^32.
        let upto = |number: i64| part * number + rest * number / cells;
        let number = i64::from(number);
        Distance::from_bits(upto(number + 1) - upto(number))
    }
}

/// State of the transformation.
pub(super) struct Transform<'a, const AXES: usize> {
    sets: &'a [Kinematic],
    /// P-CHAN-00032; 0 for none.
    default_id: u16,
    /// #KIN ID; 0 for none.
    selected: u16,
    active: Option<&'a Kinematic>,
    /// The transformation that becomes active after the blocks before the command; `Some(None)` for none.
    wanted: Option<Option<&'a Kinematic>>,
    /// End of the elements that have been passed on, and their direction there, in workpiece coordinates.
    stands: [Position; AXES],
    exit: Option<End<AXES>>,
    job: Option<Job<'a>>,
    refused: Option<(Place, SplitError)>,
    split: Split,
}

impl<'a, const AXES: usize> Transform<'a, AXES> {
    /// A stage with the axes at `start` and no transformations.
    pub const fn new(start: [Position; AXES]) -> Self {
        Self {
            sets: &[],
            default_id: 0,
            selected: 0,
            active: None,
            wanted: None,
            stands: start,
            exit: None,
            job: None,
            refused: None,
            split: Split { elements: 0, polynomials: 0 },
        }
    }

    /// Whether an element is being split, or a refused element has not been reported yet.
    pub const fn is_busy(&self) -> bool {
        self.job.is_some() || self.refused.is_some()
    }

    /// Direction at the end of the last element, in workpiece coordinates; `None` before the first element.
    pub const fn exit(&self) -> Option<&End<AXES>> {
        self.exit.as_ref()
    }

    fn find(&self, id: u16) -> Result<&'a Kinematic, SwitchError> {
        let sets = self.sets;
        sets.iter().find(|set| set.id == id).ok_or(SwitchError::Unknown(id))
    }

    /// Drops the current element. The elements that follow begin at `stands`.
    fn forget(&mut self, stands: &[Position; AXES]) {
        (self.job, self.wanted, self.exit, self.stands) = (None, None, None, *stands);
    }

    /// Begins to split an element; the axes are at `entered` where the element begins.
    fn begin(
        &mut self,
        smoothed: &Smoothed<'_, AXES>,
        entered: &[Position; AXES],
        (check_jerk, is_limited): (u8, bool),
    ) -> Result<(), SplitError> {
        let Some(kinematic) = self.active else { return Ok(()) };
        let Smoothed { element, end, data, curving, due, .. } = *smoothed;
        let course = kinematic.course(element, &self.stands);
        let splitter = Splitter::new(&kinematic.chain, course)?.starting_at(widened(entered));
        let base = element.shape.base(&self.stands);
        match end {
            Some(end) => self.stands = *end,
            None => element.shape.end(&base, &mut self.stands),
        }
        let curving = curving
            .map_or(Curving { jerk: check_jerk.max(1), constant: None, near: Near::NONE }, |curving| {
                Curving { constant: None, ..curving }
            });
        self.exit = Some(element.exit);
        let fastest = element.bounds.as_ref().map_or(1.0, |bounds| bounds.fastest);
        let passage = element.bounds.as_ref().map(|bounds| bounds.passage);
        let passage = passage.filter(|passage| matches!(passage, Passage::Through | Passage::Steady));
        self.job = Some(Job {
            splitter,
            length: element.shape.length,
            fastest,
            passage,
            data: *data,
            curving,
            due,
            is_checking: is_limited,
        });
        Ok(())
    }
}

impl<const AXES: usize> Intake<'_, AXES> {
    /// Sets the programmed position to the end of the curves in the look-ahead.
    pub(super) fn stand(&mut self) {
        let entered = self.entered;
        let stands = self.transform.active.and_then(|active| active.workpiece(&entered));
        self.programmed = stands.unwrap_or(entered);
        self.transform.forget(&self.programmed);
    }
}

/// The result for the next polynomial.
enum Next<const AXES: usize> {
    /// The polynomial enters the look-ahead. `is_last`: it is the last one of its element.
    Passes {
        element: Element<AXES>,
        end: [Position; AXES],
        is_last: bool,
    },
    /// The polynomial has been checked.
    Looked,
    /// The polynomial leads an axis beyond its software limit.
    Beyond(Beyond),
    Refused(SplitError),
}

impl<'a, const AXES: usize, const BLOCKS: usize> Planning<'a, AXES, BLOCKS> {
    /// Sets the transformations of the machine, and the identifier of the default one (P-CHAN-00032; 0 for
    /// none).
    pub fn set_kinematics(&mut self, sets: &'a [Kinematic], default_id: u16) {
        (self.intake.transform.sets, self.intake.transform.default_id) = (sets, default_id);
    }

    /// Whether the machine has transformations.
    pub const fn has_kinematics(&self) -> bool {
        !self.intake.transform.sets.is_empty()
    }

    /// Whether a transformation is active: program positions are then those of the tool tip.
    pub const fn is_transformed(&self) -> bool {
        self.intake.transform.active.is_some()
    }

    /// The active transformation, or `None`.
    pub const fn kinematic(&self) -> Option<&'a Kinematic> {
        self.intake.transform.active
    }

    /// How many curves have been transformed since the start of the channel, and into how many polynomials.
    pub const fn split(&self) -> Split {
        self.intake.transform.split
    }

    /// Positions of the axes at the end of the blocks that are in the look-ahead.
    pub const fn axes(&self) -> &[Position; AXES] {
        &self.intake.entered
    }

    /// Carries out `#KIN ID`: selects a data set of the machine.
    ///
    /// # Errors
    /// There is no such data set, or another one is active.
    pub fn select(&mut self, id: u16) -> Result<(), SwitchError> {
        let transform = &mut self.intake.transform;
        if let Some(active) = transform.active.filter(|active| active.id != id) {
            return Err(SwitchError::Active(active.id));
        }
        transform.selected = transform.find(id)?.id;
        Ok(())
    }

    /// Carries out `#TRAFO ON`: the transformation becomes active after the blocks before the command
    /// ([`Self::switches`]).
    ///
    /// # Errors
    /// No data set is selected, or another one is active.
    pub fn switch_on(&mut self) -> Result<&'a Kinematic, SwitchError> {
        let transform = &mut self.intake.transform;
        let id = if transform.selected != 0 { transform.selected } else { transform.default_id };
        if id == 0 {
            return Err(SwitchError::None);
        }
        let kinematic = transform.find(id)?;
        match transform.active {
            Some(active) if active.id != id => Err(SwitchError::Active(active.id)),
            Some(_) => Ok(kinematic),
            None => {
                transform.wanted = Some(Some(kinematic));
                self.rest(0);
                Ok(kinematic)
            }
        }
    }

    /// Drops a pending change of the transformation, because its line is refused.
    pub fn forget_switch(&mut self) {
        self.intake.transform.wanted = None;
    }

    /// Carries out `#TRAFO OFF`: the transformation ends after the blocks before the command
    /// ([`Self::switches`]).
    pub fn switch_off(&mut self) {
        if self.is_transformed() {
            self.intake.transform.wanted = Some(None);
            self.rest(0);
        }
    }

    /// Changes the transformation, if `#TRAFO` has demanded a change. Call this function only after
    /// [`Work::Hungry`]. Returns `true` if the transformation has changed; program positions then mean other
    /// axis positions.
    pub fn switches(&mut self) -> bool {
        let Some(wanted) = self.intake.transform.wanted.take() else { return false };
        self.intake.transform.active = wanted;
        self.intake.stand();
        self.dynamics().set_transformed(wanted.is_some());
        #[cfg(feature = "driven")]
        self.measure_driven();
        self.lookahead.ring.forget_exit();
        true
    }

    /// Ends the transformation and its selection. Call this function only at standstill.
    pub(super) fn end_transformation(&mut self) {
        let transform = &mut self.intake.transform;
        transform.selected = 0;
        if transform.active.take().is_some() {
            self.intake.stand();
            self.dynamics.set_transformed(false);
            #[cfg(feature = "driven")]
            self.measure_driven();
        }
    }

    /// Sets how driven distance is counted. Under a transformation, path distance is the distance of the tool
    /// tip and counts directly.
    #[cfg(feature = "driven")]
    fn measure_driven(&mut self) {
        let measure = self.intake.transform.active.is_none().then_some(self.measure);
        self.queue.segments.set_measure(measure);
    }

    /// Takes a motion in workpiece coordinates.
    #[inline(never)]
    pub(super) fn take_transformed(
        &mut self,
        motion: &Motion<AXES>,
        feed: Option<f32>,
    ) -> Result<(), MotionError> {
        let mut block = self.programmed(Form::Line, motion, feed);
        let (from, to) = (block.from, block.to);
        match motion.kind {
            MotionKind::Rapid | MotionKind::Line => {
                if !path::line_to([&from, &to], &self.measure, &mut block.element)? {
                    self.join_last(motion);
                    return Ok(());
                }
            }
            MotionKind::Arc { plane, clockwise, by } => {
                if self.intake.smoothing.refuses_arcs() {
                    return Err(MotionError::ArcInSpline);
                }
                let centre = self.centre(motion, (plane, clockwise, by))?;
                let arc = (centre, plane, clockwise);
                path::arc_to([&from, &to], arc, &self.measure, &mut block.element)?;
                self.intake.turning.go_on(&mut block.element, arc, self.intake.taken);
                block.form = Form::Arc { centre, plane, clockwise };
            }
        }
        self.pass(motion, feed)?;
        let Element { shape, .. } = &block.element;
        Self::in_time(self.dynamics.programmed(feed), shape.length)?;
        if self.intake.smoothing.is_idle() {
            self.transform_block(&block).map_err(MotionError::Split)?;
            self.functions.settle(true, false);
        } else {
            self.round(&block);
        }
        self.advance(motion);
        Ok(())
    }

    /// Takes a block that no smoother changes.
    fn transform_block(&mut self, block: &ProgrammedBlock<AXES>) -> Result<(), SplitError> {
        let smoothed = Smoothed {
            element: &block.element,
            end: Some(&block.to),
            data: &block.data,
            curving: None,
            due: block.data.number,
            known: None,
        };
        let rules = (self.intake.machine.channel.check_jerk_on_poly_path, self.intake.travel.is_limited());
        let Intake { transform, entered, .. } = &mut self.intake;
        transform.begin(&smoothed, entered, rules)
    }

    /// Takes the next element of the smoother. Returns `false` if there is no element.
    #[inline(never)]
    pub(super) fn transform_smoothed(&mut self) -> bool {
        let rules = (self.intake.machine.channel.check_jerk_on_poly_path, self.intake.travel.is_limited());
        let Intake { transform, entered, smoothing, .. } = &mut self.intake;
        smoothing.emit(|smoothed| {
            if let Err(error) = transform.begin(smoothed, entered, rules) {
                transform.refused = Some((smoothed.data.place, error));
            }
        })
    }

    /// Makes the next polynomial of the current element and passes it on.
    #[inline(never)]
    pub(super) fn pass_transformed(&mut self) -> Work {
        let next = if self.intake.transform.refused.is_some() { None } else { self.next_polynomial() };
        let Some(Job { data, curving, due, .. }) = &self.intake.transform.job else {
            self.forget_ahead();
            return Work::Refused;
        };
        let (data, curving, due) = (*data, *curving, *due);
        match next {
            Some(Next::Passes { element, end, is_last }) => {
                let limits = match &element.bounds {
                    Some(bounds) => {
                        self.dynamics.polynomial(element.shape.length, bounds, data.feed, curving)
                    }
                    None => self.dynamics.line(&element.entry.tangent, data.feed),
                };
                let Data { feed, n, number, stop, .. } = data;
                let pass = Pass { feed, n, number, stop: stop && is_last };
                self.entrance().0.push(&element.piece(), &limits, &pass, due, Some(&end));
                self.intake.transform.split.polynomials += 1;
                if is_last {
                    self.intake.transform.job = None;
                    self.intake.transform.split.elements += 1;
                }
                Work::Working
            }
            Some(Next::Looked) => Work::Working,
            Some(Next::Beyond(beyond)) => {
                self.intake.refused = Some((data.place, beyond));
                self.forget_ahead();
                Work::Refused
            }
            Some(Next::Refused(error)) => {
                self.intake.transform.refused = Some((data.place, error));
                self.forget_ahead();
                Work::Refused
            }
            None => {
                self.forget_ahead();
                Work::Refused
            }
        }
    }

    /// Makes or checks the next polynomial.
    #[inline(never)]
    fn next_polynomial(&mut self) -> Option<Next<AXES>> {
        let Intake { transform, entered, travel, .. } = &mut self.intake;
        let job = transform.job.as_mut()?;
        let number = job.splitter.made();
        let cell = match job.splitter.step()? {
            Ok(cell) => cell,
            Err(error) => return Some(Next::Refused(error)),
        };
        let mut element = Element::BLANK;
        let kind = (job.fastest, job.splitter.is_straight());
        if cell.become_element(&mut element, job.length_of(number), kind).is_none() {
            return Some(Next::Refused(SplitError::TooCurved));
        }
        if let (Some(passage), Some(bounds)) = (job.passage, &mut element.bounds) {
            bounds.passage = passage;
        }
        let [start, end] = cell.span();
        let is_last = number + 1 >= job.splitter.cells();
        if !job.is_checking {
            return Some(Next::Passes { element, end, is_last });
        }
        let inside = if element.bounds.is_some() {
            travel.curve(&start, |axis| element.bent_range(axis, &start, travel.of(axis, &start)))
        } else {
            travel.line(&start, &end)
        };
        if let Err(beyond) = inside {
            return Some(Next::Beyond(beyond));
        }
        if is_last {
            job.is_checking = false;
            job.splitter = match job.splitter.again(widened(entered)) {
                Ok(splitter) => splitter,
                Err(error) => return Some(Next::Refused(error)),
            };
        }
        Some(Next::Looked)
    }

    /// The place of an element that the transformation refused, and the reason. Each refusal is returned
    /// once.
    pub fn take_unsplit(&mut self) -> Option<(Place, SplitError)> {
        self.intake.transform.refused.take()
    }
}
