//! Takes the motion blocks of the program, makes their geometry and finds their limits. The blocks then go to
//! the smoothing stage, to the held line (`held_line`), or into the look-ahead.
use super::Planning;
use super::functions::Functions;
use super::held_line::HeldLine;
use crate::dynamics::{Dynamics, Permitted};
#[cfg(feature = "kinematics")]
use crate::kinematics::SplitError;
use crate::lookahead::{Ring, SLOWEST};
use crate::machine::{Beyond, Synch, Travel};
use crate::math::float::to_f32;
use crate::nc::{
    ArcBy, Contour, Hsc, HscMethod, Motion, MotionKind, NcWarningKind, Place, Plane, Restriction, Slope,
    Spline, Weight,
};
use crate::path::{self, Element, PathError, Piece};
use crate::quantity::{Distance, Position};
use crate::queue::{CurveProducer, Function, Scheduler};
use crate::smooth::{Before, Data, Form, Parting, ProgrammedBlock, Smoothed, Smoother, SplineError};

/// The reason why the planner refuses a motion block of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MotionError {
    /// The path module cannot make a curve from the block, for example because the radii of an arc differ.
    Path(PathError),
    /// The feed of the block is zero.
    NoFeed,
    /// The block would take more than 2^26 ticks at its highest permitted speed.
    TooSlow,
    /// The motion of a single axis would take longer than the planner permits.
    StrokeTooSlow,
    /// The block moves an axis that has been released from the channel, so its position is not known.
    Released,
    /// The block is an arc inside a direct B-spline, which takes only lines (ISG's message 120254).
    ArcInSpline,
    /// The block leads an axis beyond a software limit.
    Beyond(Beyond),
    /// With an active transformation: the curve cannot become a motion of the axes.
    #[cfg(feature = "kinematics")]
    Split(SplitError),
}

impl From<PathError> for MotionError {
    fn from(error: PathError) -> Self {
        Self::Path(error)
    }
}

impl From<Beyond> for MotionError {
    fn from(error: Beyond) -> Self {
        Self::Beyond(error)
    }
}

/// Data of a block for the look-ahead.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// Feed, mm/min; `None` for rapid motion.
    pub feed: Option<f32>,
    /// Programmed N number.
    pub n: u32,
    /// Number of motion blocks before this one.
    pub number: u32,
    /// Whether the block ends in an exact stop.
    pub stop: bool,
}

/// Access to the look-ahead and to the other parts that a block enters.
pub(super) struct Entrance<'a, 'q, const AXES: usize, const BLOCKS: usize> {
    pub(super) ring: &'a mut Ring<'q, AXES, BLOCKS>,
    functions: &'a mut Functions,
    dynamics: &'a mut Dynamics<AXES>,
    pub(super) segments: &'a mut CurveProducer<'q, AXES>,
    actions: &'a mut Scheduler<'q>,
    entered: &'a mut [Position; AXES],
    #[cfg(feature = "plc")]
    pub(super) plc: &'a mut super::log::Plc<'q>,
}

impl<const AXES: usize, const BLOCKS: usize> Entrance<'_, '_, AXES, BLOCKS> {
    /// Checks that an element, such as the curve of a corner, stays inside the software limits.
    #[inline(never)]
    fn stays(&self, element: &Element<AXES>, travel: &Travel<AXES>) -> Result<(), Beyond> {
        let from = &*self.entered;
        travel.curve(from, |axis| element.bent_range(axis, from, travel.of(axis, from)))
    }

    /// Limits of an element that the motion may pass within the window of the filters.
    #[cold]
    #[inline(never)]
    fn shorten(&self, element: &Piece<'_, AXES>, limits: &Permitted) -> Option<Permitted> {
        let length = to_f32(element.shape.length.to_bits()) * (1.0 / (1u64 << 44) as f32);
        self.dynamics.shorten(limits, length, !element.shape.is_line())
    }

    /// Takes an element of the smoother.
    #[inline(never)]
    fn take(&mut self, smoothed: &Smoothed<'_, AXES>) {
        #[cfg(feature = "examine")]
        if self.ring.examines() {
            return self.pass_by(&smoothed.element.piece(), smoothed.due, smoothed.end);
        }
        let Smoothed { element, end, data, curving, due, known } = smoothed;
        let known = known.and_then(|known| self.dynamics.recall(known));
        let made;
        let limits = match (known, &element.bounds, curving) {
            (Some(known), ..) => known,
            (None, Some(bounds), Some(curving)) => {
                made = self.dynamics.polynomial(element.shape.length, bounds, data.feed, *curving);
                &made
            }
            _ => {
                made = self.dynamics.element(element, data.feed);
                &made
            }
        };
        let Data { feed, n, number, stop, .. } = **data;
        let pass = Pass { feed, n, number, stop };
        match element.circle {
            None => self.push(&element.piece(), limits, &pass, *due, *end),
            Some(_) => self.push_arc(element, limits, &pass, *due, *end),
        }
    }

    /// Puts an element into queue and look-ahead. `due`: functions with at most this number of motion blocks
    /// before them become due where the element begins. `end`: the end of the element, if known.
    #[inline(never)]
    pub fn push(
        &mut self,
        piece: &Piece<'_, AXES>,
        limits: &Permitted,
        pass: &Pass,
        due: u32,
        end: Option<&[Position; AXES]>,
    ) {
        #[cfg(feature = "plc")]
        if self.push_parted(piece, limits, pass, due, end) {
            return;
        }
        self.push_here(piece, limits, pass, (due, false), end);
    }

    /// Puts an arc into queue and look-ahead. After two turns of its circle, the arc becomes two blocks.
    #[inline(never)]
    pub fn push_arc(
        &mut self,
        element: &Element<AXES>,
        limits: &Permitted,
        pass: &Pass,
        due: u32,
        end: Option<&[Position; AXES]>,
    ) {
        let mut piece = element.piece();
        #[cfg(feature = "examine")]
        if self.ring.examines() {
            return self.pass_by(&piece, due, end);
        }
        let turns = if self.ring.has_room_for_two() { self.dynamics.turns(element, pass.feed) } else { None };
        let Some(turns) = turns else { return self.push(&piece, limits, pass, due, end) };
        // A function before this point acts after the curve before.
        if !self.functions.are_open() {
            self.ring.rejoin(&piece, pass.feed.is_none(), &turns, self.dynamics);
        }
        let length = piece.length.to_bits();
        piece.length = Distance::from_bits(length - turns.run_out);
        self.push(&piece, &turns.steady, &Pass { stop: false, ..*pass }, due, end);
        let before = self.ring.before_run_out(turns.run_out);
        piece.length = Distance::from_bits(turns.run_out);
        (piece.entry, piece.continued) = (&element.exit, true);
        self.push(&piece, &turns.end, pass, due, end);
        self.ring.run_out(before);
    }

    /// Replaces queue and look-ahead for an element that is only checked.
    #[cfg(feature = "examine")]
    fn pass_by(&mut self, element: &Piece<'_, AXES>, due: u32, end: Option<&[Position; AXES]>) {
        if !element.continued {
            self.functions.pass_by(due);
            match end {
                Some(end) => *self.entered = *end,
                None => {
                    let base = element.shape.base(self.entered);
                    element.shape.end(&base, self.entered);
                }
            }
        }
        self.ring.pass_by(element.exit);
        self.dynamics.settle();
    }

    /// Puts an element into queue and look-ahead. Inline, so that the code for a line contains no work for
    /// curves.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn push_here(
        &mut self,
        element: &Piece<'_, AXES>,
        limits: &Permitted,
        pass: &Pass,
        (due, long): (u32, bool),
        end: Option<&[Position; AXES]>,
    ) {
        #[cfg(feature = "examine")]
        if self.ring.examines() {
            return self.pass_by(element, due, end);
        }
        let short = if self.dynamics.is_watched() { self.shorten(element, limits) } else { None };
        let limits = short.as_ref().unwrap_or(limits);
        if !element.continued {
            let gate = self.functions.before(due, self.segments.end(), self.actions);
            let base = element.shape.base(self.entered);
            #[cfg(feature = "plc")]
            let from = self.segments.driven_end();
            // There is room: the caller has checked this.
            let _ = self.segments.push(element.shape, &base, pass.n, pass.number);
            #[cfg(feature = "plc")]
            self.record(element, from, pass);
            match end {
                Some(end) => *self.entered = *end,
                None => element.shape.end(&base, self.entered),
            }
            self.ring.before(gate);
        }
        self.ring.push(element, limits, pass.feed, self.dynamics, long);
        self.dynamics.settle();
        if pass.stop {
            self.ring.stop_here();
        }
    }
}

impl<'q, const AXES: usize, const BLOCKS: usize> Planning<'q, AXES, BLOCKS> {
    /// Takes a motion block of the program. Call this function only after [`super::Work::Hungry`].
    ///
    /// # Errors
    /// The block is refused and nothing has changed.
    pub fn take(&mut self, motion: &Motion<AXES>) -> Result<(), MotionError> {
        let result = self.take_motion(motion);
        if result.is_err() {
            self.drop_motion();
        }
        result
    }

    fn take_motion(&mut self, motion: &Motion<AXES>) -> Result<(), MotionError> {
        let feed = match motion.kind {
            MotionKind::Rapid => None,
            _ => Some(to_f32(motion.feed.to_bits()) * (1.0 / 4_294_967_296.0)),
        };
        #[cfg(feature = "kinematics")]
        if self.is_transformed() {
            return self.take_transformed(motion, feed);
        }
        match motion.kind {
            MotionKind::Rapid | MotionKind::Line if self.intake.smoothing.is_idle() => {
                self.take_line(motion, feed)
            }
            MotionKind::Rapid | MotionKind::Line => self.round_line(motion, feed),
            MotionKind::Arc { plane, clockwise, by } => {
                if self.intake.smoothing.refuses_arcs() {
                    return Err(MotionError::ArcInSpline);
                }
                let centre = self.centre(motion, (plane, clockwise, by))?;
                if self.intake.smoothing.is_idle() {
                    self.take_arc(motion, feed, (centre, plane, clockwise))
                } else {
                    self.round_arc(motion, feed, (centre, plane, clockwise))
                }
            }
        }
    }

    /// Takes a line. Neither this function nor the next one is inlined, so that only one of their stack
    /// frames exists at a time.
    #[inline(never)]
    fn take_line(&mut self, motion: &Motion<AXES>, feed: Option<f32>) -> Result<(), MotionError> {
        let (from, to) = (&self.intake.programmed, &motion.target);
        self.intake.travel.line(from, to)?;
        let Some(line) = path::straight(from, to, &self.measure)? else {
            self.join_last(motion);
            return Ok(());
        };
        let pass = self.pass(motion, feed)?;
        if self.join_held(&line, &motion.target, &pass) {
            self.functions.settle(true, false);
        } else {
            let limits = self.dynamics.line(line.tangent(), feed);
            Self::in_time(limits.0.v, line.length())?;
            self.functions.settle(true, false);
            self.hold_line(&line, &limits, pass);
        }
        self.advance(motion);
        Ok(())
    }

    /// Passes a line to the smoother.
    #[inline(never)]
    fn round_line(&mut self, motion: &Motion<AXES>, feed: Option<f32>) -> Result<(), MotionError> {
        let (from, to) = (&self.intake.programmed, &motion.target);
        self.intake.travel.line(from, to)?;
        let mut block = self.programmed(Form::Line, motion, feed);
        if path::line_to([from, to], &self.measure, &mut block.element)? {
            self.pass(motion, feed)?;
            let Element { shape, entry, .. } = &block.element;
            Self::in_time(self.dynamics.speed_of_line(&entry.tangent, feed), shape.length)?;
            self.round(&block);
            self.advance(motion);
        } else {
            self.join_last(motion);
        }
        Ok(())
    }

    /// Handles a line on which no axis moves: its functions and its exact stop belong to the block before.
    pub(super) fn join_last(&mut self, motion: &Motion<AXES>) {
        self.functions.settle(false, false);
        if motion.exact_stop {
            self.stop_before();
        }
    }

    /// Takes an arc. Not inlined; otherwise lines would save its registers too.
    #[inline(never)]
    fn take_arc(
        &mut self,
        motion: &Motion<AXES>,
        feed: Option<f32>,
        (centre, plane, clockwise): ([Position; 2], Plane, bool),
    ) -> Result<(), MotionError> {
        // Made in its final place, because an element is large.
        let mut element = Element::BLANK;
        let ends = [&self.intake.programmed, &motion.target];
        path::arc_to(ends, (centre, plane, clockwise), &self.measure, &mut element)?;
        self.intake.turning.go_on(&mut element, (centre, plane, clockwise), self.intake.taken);
        let (limits, pass) = self.look_over(motion, feed, &element, &centre)?;
        self.functions.settle(true, false);
        self.pass_arc(&element, &limits, pass, &motion.target);
        self.advance(motion);
        Ok(())
    }

    /// Passes an arc to the smoother.
    #[inline(never)]
    fn round_arc(
        &mut self,
        motion: &Motion<AXES>,
        feed: Option<f32>,
        (centre, plane, clockwise): ([Position; 2], Plane, bool),
    ) -> Result<(), MotionError> {
        let mut block = self.programmed(Form::Arc { centre, plane, clockwise }, motion, feed);
        let ends = [&self.intake.programmed, &motion.target];
        path::arc_to(ends, (centre, plane, clockwise), &self.measure, &mut block.element)?;
        self.intake.turning.go_on(&mut block.element, (centre, plane, clockwise), self.intake.taken);
        self.look_over(motion, feed, &block.element, &centre)?;
        self.round(&block);
        self.advance(motion);
        Ok(())
    }

    /// Checks whether an arc may be driven. Returns its limits and its data.
    #[cfg_attr(feature = "fast", inline(always))]
    fn look_over(
        &self,
        motion: &Motion<AXES>,
        feed: Option<f32>,
        element: &Element<AXES>,
        centre: &[Position; 2],
    ) -> Result<(Permitted, Pass), MotionError> {
        if self.intake.travel.is_limited() {
            self.stays(motion, element, centre)?;
        }
        let pass = self.pass(motion, feed)?;
        let limits = self.dynamics.element(element, feed);
        Self::in_time(limits.0.v, element.shape.length)?;
        Ok((limits, pass))
    }

    /// The centre of an arc.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn centre(
        &self,
        motion: &Motion<AXES>,
        (plane, clockwise, by): (Plane, bool, ArcBy),
    ) -> Result<[Position; 2], PathError> {
        match by {
            ArcBy::Centre(centre) => Ok(centre),
            ArcBy::Radius(radius) => {
                let (from, to) = (&self.intake.programmed, &motion.target);
                path::centre_of_radius(from, to, radius, plane, clockwise, &self.measure.main)
            }
        }
    }

    /// Checks that an arc stays inside the software limits.
    #[inline(never)]
    fn stays(
        &self,
        motion: &Motion<AXES>,
        element: &Element<AXES>,
        centre: &[Position; 2],
    ) -> Result<(), Beyond> {
        let (from, to) = (&self.intake.programmed, &motion.target);
        self.intake.travel.curve(from, |axis| element.arc_range(axis, from, to, centre))
    }

    /// Checks a motion without taking it. A line of the program may contain commands and a motion. The caller
    /// checks the motion first, so that no command of a refused line acts.
    ///
    /// # Errors
    /// Returns why the motion is refused.
    #[inline(never)]
    pub fn look_at(&self, motion: &Motion<AXES>) -> Result<(), MotionError> {
        let (from, to) = (&self.intake.programmed, &motion.target);
        if let MotionKind::Arc { plane, clockwise, by } = motion.kind {
            let centre = self.centre(motion, (plane, clockwise, by))?;
            let mut element = Element::BLANK;
            path::arc_to([from, to], (centre, plane, clockwise), &self.measure, &mut element)?;
            #[cfg(feature = "kinematics")]
            if self.is_transformed() {
                return Ok(());
            }
            return Ok(self.stays(motion, &element, &centre)?);
        }
        #[cfg(feature = "kinematics")]
        if self.is_transformed() {
            return path::straight_line(from, to, &self.measure).map(|_| ()).map_err(MotionError::from);
        }
        self.intake.travel.line(from, to)?;
        path::straight_line(from, to, &self.measure)?;
        Ok(())
    }

    /// Drops the motion of the current line, and the functions that the line has before its motion.
    pub fn drop_motion(&mut self) {
        self.functions.drop_unsettled(self.queue.control);
    }

    /// Demands an exact stop at the end of the last block.
    fn stop_before(&mut self) {
        self.intake.smoothing.flush(true);
        self.stop_held();
        if !self.intake.smoothing.holds() && self.intake.held.is_none() {
            self.lookahead.ring.stop_here();
        }
    }

    /// Which axes the block moves: bit i is set if axis i moves. An arc moves both axes of its plane, even if
    /// it ends where it begins. In a block with a spline, or with a curve of POS, an axis may also move and
    /// return to its start.
    pub fn moved(&self, motion: &Motion<AXES>) -> u32 {
        let turned = match motion.kind {
            MotionKind::Arc { plane, .. } => plane.main_axes().map(|place| self.measure.main.get(place)),
            _ => [None; 2],
        };
        let ends = motion.target.iter().zip(&self.intake.programmed);
        let moves = |(k, (to, from))| to != from || turned.contains(&Some(k));
        let moved = ends.enumerate().filter(|end| moves(*end));
        let moved =
            moved.fold(self.intake.smoothing.swung(), |axes, (k, _)| axes | 1u32.wrapping_shl(k as u32));
        #[cfg(feature = "kinematics")]
        let moved = self.kinematic().map_or(moved, |kinematic| kinematic.carried(moved));
        moved
    }

    /// Changes contour mode (rounding of corners). Call this function only after [`super::Work::Hungry`].
    /// `in_motion`: the command is part of a motion block.
    ///
    /// # Errors
    /// A spline is on.
    pub fn contour(&mut self, contour: &Contour, in_motion: bool) -> Result<(), SplineError> {
        self.let_go();
        self.intake.uniform.by_ramps |= contour.check_jerk == Some(2);
        self.intake.smoothing.contour(contour, in_motion)
    }

    /// Carries out a command of direct splines and returns a warning about it, if any. Call this function
    /// only after [`super::Work::Hungry`].
    ///
    /// # Errors
    /// The command is refused and nothing has changed.
    pub fn spline(&mut self, command: &Spline<AXES>) -> Result<Option<NcWarningKind>, SplineError> {
        self.let_go();
        let exit = self.lookahead.ring.exit();
        #[cfg(feature = "kinematics")]
        let exit = if self.is_transformed() { self.intake.transform.exit() } else { exit };
        let before = Before { taken: self.intake.taken, exit };
        self.intake.smoothing.spline(command, &before)
    }

    /// Carries out `#HSC`. Call this function only after [`super::Work::Hungry`]. Returns `false` if `#HSC`
    /// is already on and keeps its parameters.
    ///
    /// # Errors
    /// The command is refused and nothing has changed.
    pub fn hsc(&mut self, hsc: &Hsc) -> Result<bool, SplineError> {
        self.let_go();
        self.intake.smoothing.hsc(hsc)
    }

    /// The smoothing method that `#HSC ON` selects with these parameters.
    pub fn hsc_method(&self, hsc: &Hsc) -> HscMethod {
        self.intake.smoothing.method(hsc)
    }

    /// Whether the feed refers to the main axes; Surface requires this.
    pub fn measures_space(&self) -> bool {
        self.measure.is_space()
    }

    /// Whether the machine has a master axis; DIST_MASTER requires one.
    pub fn has_master(&self) -> bool {
        self.measure.master().is_some()
    }

    /// Whether contour mode is to round the end of the last block.
    pub fn rounds(&self) -> bool {
        self.intake.smoothing.rounds()
    }

    /// The warning about the corner before the last motion, for example that it gets no curve. Each warning
    /// is returned once.
    pub fn remark(&mut self) -> Option<NcWarningKind> {
        self.intake.smoothing.remark()
    }

    /// The last warning about a corner, and the block of this corner. Call this function after the whole
    /// program.
    pub fn last_remark(&mut self) -> Option<(NcWarningKind, Place)> {
        let kind = self.remark()?;
        Some((kind, self.intake.smoothing.place().unwrap_or_default()))
    }

    /// Keeps the end of the last block exact, without a corner curve. Call this function only after
    /// [`super::Work::Hungry`].
    pub fn keep_corner(&mut self) {
        self.let_go();
        self.intake.smoothing.cancel();
    }

    /// Ends a run of blocks that the smoothing stage holds back, before a change of the dynamics. The held
    /// blocks are planned with the current dynamics, and the corner at their end stays sharp. Returns `false`
    /// if no block is held. Call this function only after [`super::Work::Hungry`].
    pub fn end_row(&mut self) -> bool {
        self.let_go();
        if !self.intake.smoothing.holds() {
            return false;
        }
        self.intake.smoothing.cancel();
        !self.intake.smoothing.is_empty()
    }

    /// Whether a command of the program changes the dynamics of the blocks that follow.
    pub(crate) fn changes(&self, command: &Restriction<AXES>) -> bool {
        self.dynamics.differ(self.intake.machine, command)
    }

    /// Checks that a block of this length takes at most 2^26 ticks at the speed `v`.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn in_time(v: f32, length: Distance) -> Result<(), MotionError> {
        if to_f32(length.to_bits()) > v * SLOWEST { Err(MotionError::TooSlow) } else { Ok(()) }
    }

    /// The data of a block for the look-ahead.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn pass(&self, motion: &Motion<AXES>, feed: Option<f32>) -> Result<Pass, MotionError> {
        // A block without motion needs no feed, and never reaches this place.
        if feed.is_some_and(|feed| feed <= 0.0) {
            return Err(MotionError::NoFeed);
        }
        Ok(Pass { feed, n: motion.n, number: self.intake.taken, stop: motion.exact_stop })
    }

    /// A block for the smoother, without its element. The caller fills in the element, because an argument
    /// would be copied.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn programmed(
        &self,
        form: Form,
        motion: &Motion<AXES>,
        feed: Option<f32>,
    ) -> ProgrammedBlock<AXES> {
        let (from, to) = (self.intake.programmed, motion.target);
        let data = Data {
            feed,
            n: motion.n,
            place: motion.place,
            number: self.intake.taken,
            stop: motion.exact_stop,
        };
        ProgrammedBlock { element: Element::BLANK, from, to, form, data }
    }

    /// Passes a block to the smoother.
    pub(super) fn round(&mut self, block: &ProgrammedBlock<AXES>) {
        let parting = if self.functions.are_awaited() {
            Parting::Awaited
        } else if self.functions.are_open() || self.queue.segments.is_crowded(block.data.number) {
            Parting::Functions
        } else {
            Parting::None
        };
        self.intake.smoothing.take(block, self.dynamics, parting);
        self.functions.settle(true, self.intake.smoothing.rounds());
    }

    /// Counts a block that has been taken.
    pub(super) fn advance(&mut self, motion: &Motion<AXES>) {
        self.intake.programmed = motion.target;
        self.intake.taken = self.intake.taken.wrapping_add(1);
    }

    /// Sets the slope of the blocks that follow. `#SLOPE DEFAULT` selects the slope of P-CHAN-00071. Call
    /// this function only after [`super::Work::Hungry`].
    pub fn set_slope(&mut self, command: &Slope) {
        let machine = self.intake.machine;
        self.dynamics().set_slope(machine, command);
    }

    /// Sets the weights of the axes for the blocks that follow. Call this function only after
    /// [`super::Work::Hungry`].
    pub fn weigh(&mut self, weight: &Weight<AXES>) {
        let machine = self.intake.machine;
        self.dynamics().weigh(machine, weight);
    }

    /// The dynamics with all filters removed; the caller sets new filters. Call this function only after
    /// [`super::Work::Hungry`].
    pub fn unwatched(&mut self) -> &mut Dynamics<AXES> {
        let machine = self.intake.machine;
        let dynamics = self.dynamics();
        dynamics.unwatch(machine);
        dynamics
    }

    /// The dynamics, for a change of the path limits of the blocks that follow. Call this function only after
    /// [`super::Work::Hungry`].
    pub fn dynamics(&mut self) -> &mut Dynamics<AXES> {
        self.let_go();
        self.intake.uniform.since = self.intake.taken;
        self.dynamics
    }

    /// Access to the look-ahead, and the line that is held back before it.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn entrance(&mut self) -> (Entrance<'_, 'q, AXES, BLOCKS>, &HeldLine<AXES>) {
        let Self { lookahead, functions, dynamics, intake, queue, .. } = self;
        #[cfg(feature = "plc")]
        let plc = &mut intake.plc;
        let super::Intake { entered, held, .. } = intake;
        let (segments, actions) = (&mut queue.segments, &mut queue.actions);
        let ring = &mut lookahead.ring;
        let entrance = Entrance {
            ring,
            functions,
            dynamics,
            segments,
            actions,
            entered,
            #[cfg(feature = "plc")]
            plc,
        };
        (entrance, held)
    }

    /// Passes the next element of the smoother to the look-ahead. Returns `false` if there is no element.
    #[inline(never)]
    pub(super) fn pass_smoothed(&mut self) -> bool {
        #[cfg(feature = "kinematics")]
        if self.is_transformed() {
            return self.transform_smoothed();
        }
        let Self { lookahead, functions, dynamics, intake, queue, .. } = self;
        #[cfg(feature = "plc")]
        let plc = &mut intake.plc;
        let super::Intake { entered, smoothing, travel, .. } = intake;
        let (segments, actions) = (&mut queue.segments, &mut queue.actions);
        let ring = &mut lookahead.ring;
        let mut entrance = Entrance {
            ring,
            functions,
            dynamics,
            segments,
            actions,
            entered,
            #[cfg(feature = "plc")]
            plc,
        };
        let mut beyond = None;
        let emitted = smoothing.emit(|smoothed| {
            if travel.is_limited()
                && smoothed.curving.is_some()
                && let Err(error) = entrance.stays(smoothed.element, travel)
            {
                beyond = Some((smoothed.data.place, error));
            } else {
                entrance.take(smoothed);
            }
        });
        if let Some((place, beyond)) = beyond {
            self.drop_curve(place, beyond);
        }
        emitted
    }

    /// Refuses the curve of a corner that leads beyond a software limit. The motion ends before this curve,
    /// and all later blocks are dropped.
    #[cold]
    #[inline(never)]
    fn drop_curve(&mut self, place: Place, beyond: Beyond) {
        self.intake.refused = Some((self.intake.smoothing.place().unwrap_or(place), beyond));
        self.forget_ahead();
    }

    /// Drops blocks that have been taken and are not in the look-ahead.
    pub(super) fn forget_ahead(&mut self) {
        self.intake.smoothing.clear();
        self.intake.held.clear();
        self.functions.drop_unplaced(self.queue.control);
        self.intake.stand();
    }

    /// Takes a function (M, H, S or T) that becomes due between the last block and the next one. `in_motion`:
    /// the line of the function also has a motion. Call this function only after [`super::Work::Hungry`].
    ///
    /// # Errors
    /// Returns the function if there is no room. Call [`Self::make_room`], then call `output` again.
    pub fn output(
        &mut self,
        n: u32,
        function: Function,
        synch: Synch,
        in_motion: bool,
    ) -> Result<(), Function> {
        if synch == Synch::NoSynch {
            return Ok(());
        }
        self.let_go();
        let room = self.queue.actions.room();
        let taken = self.functions.take(
            (n, function, synch),
            (self.intake.taken, in_motion),
            (room, self.queue.control),
        );
        taken.map_err(|()| function)
    }

    /// Sets how far before its place the function of the last [`Self::output`] is output. `shift`: this path
    /// length, 0.1 µm.
    #[cfg(feature = "plc")]
    pub fn shift(&mut self, shift: u32) {
        self.functions.shift(shift);
    }

    /// Demands the acknowledgement of all functions with late synchronisation, for the end of the program.
    /// Call this function only after [`super::Work::Hungry`].
    #[cfg(feature = "plc")]
    pub fn demand_all(&mut self) {
        self.functions.demand_all(self.intake.taken);
    }

    /// Demands the acknowledgement of functions with late synchronisation: the motion waits for it before the
    /// next motion block. `explicit`: `true` for functions that `#EXPL SYN` acknowledges (MVS_SLP), `false`
    /// for functions that are acknowledged before the next block at feed (MVS_SLM). Call this function only
    /// after [`super::Work::Hungry`].
    #[cfg(feature = "plc")]
    pub fn demand(&mut self, explicit: bool) {
        if self.functions.are_late(explicit) {
            self.let_go();
            self.functions.demand(self.intake.taken, explicit);
        }
    }
}
