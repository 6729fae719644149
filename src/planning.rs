//! From motion blocks to the queue: path, look-ahead and slope in a row, a bounded piece of work per call.
mod acknowledge;
mod flight;
mod functions;
mod held;
mod hold;
mod pace;

use crate::channel::PlannedBlock;
use crate::control::{Commands, Control};
use crate::lookahead::{Dynamics, Lookahead, Pace, Permitted, max, min};
use crate::machine::{MachineData, Synch};
use crate::math::float::to_f32;
use crate::nc::{ArcBy, Contour, Motion, MotionKind, NcWarningKind, SlopeType};
use crate::path::contour::{Block, Contouring, Data, Form, Outgoing};
use crate::path::{self, Element, PathError};
use crate::quantity::{Distance, Position, Speed, Time};
use crate::queue::{Function, Phase, Sender, Slot, clock};
use crate::slope::brake::{Brake, Motion as Instant};
use crate::slope::emit::Emitter;
use crate::slope::profile::{Profile, Unplannable, speed_f32};
use flight::Flights;
use functions::Functions;
use held::Held;
use hold::Mode;

/// Where the ring is handed on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// Blocks are taken in.
    Filling,
    /// The ring is planned.
    Passing,
    /// That many blocks still leave, span by span.
    Releasing(usize),
}

/// What a call achieved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work {
    /// Something; there is more.
    Working,
    /// The queue is full: nothing was done.
    Waiting,
    /// A span has its time law: [`Planning::planned`].
    Planned,
    /// That span has another one: it ends faster.
    Replanned,
    /// Nothing is left to do but to take in the next block.
    Hungry,
    /// It stands still, and what was taken in is forgotten, as the operator wanted.
    Aborted,
}

/// A motion block that has no path or no speed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MotionError {
    /// It has no curve.
    Path(PathError),
    /// Its feed is zero.
    NoFeed,
    /// It would take more than 2^26 ticks.
    TooSlow,
    /// It moves an axis that was given away.
    Released,
}

impl From<PathError> for MotionError {
    fn from(error: PathError) -> Self {
        Self::Path(error)
    }
}

/// Path, look-ahead, slope and the planner's end of the queue.
pub struct Planning<'a, const AXES: usize, const BLOCKS: usize> {
    main: [Option<usize>; 3],
    dynamics: Dynamics<AXES>,
    /// End of the last block taken in.
    programmed: [Position; AXES],
    contouring: Contouring<AXES>,
    /// Waits for the next one, only while contour mode is idle.
    held: Held<AXES>,
    lookahead: Lookahead<AXES, BLOCKS>,
    stage: Stage,
    /// Everything taken in is to be handed on down to a standstill.
    flush: bool,
    profile: Profile,
    emitter: Emitter,
    /// Blocks of the span handed to the emitter whose curves are not in the queue yet.
    curves: usize,
    /// The last span handed to the emitter ends in a standstill.
    stops: bool,
    /// Ticks to rest after the standstill.
    rest: u64,
    /// Spans released and not yet left by the interrupt; of so many the law was made, the last one's is with the emitter.
    flights: Flights,
    laid: usize,
    /// Speed at the end of that law.
    speed: Speed,
    /// Ticks of rest that belong behind it.
    owed: u64,
    /// Instant up to which pieces are in the queue.
    end: u32,
    mode: Mode,
    /// The operator's commands as they were seen last, and what they make of the speed.
    word: u32,
    pace: Pace,
    functions: Functions,
    /// A gate is open: what is in the look-ahead is planned again. At the first block: also the law that ends there.
    reopened: bool,
    joining: bool,
    /// It stands, or will stand, before the first block or at the end, with a tick that shows it.
    stood: bool,
    /// End of the last block handed on, and its path distance.
    position: [Position; AXES],
    distance: Distance,
    /// Motion blocks taken in.
    taken: u32,
    /// Those whose time law has begun.
    begun: u32,
    /// Those before that of the element handed on last, and of the one that went into the look-ahead last.
    number: u32,
    numbered: u32,
    planned: Planned,
    queue: Sender<'a, AXES>,
}

/// What goes with a block into the look-ahead.
#[derive(Clone, Copy, Debug)]
struct Pass {
    /// Feed, mm/min; rapid without.
    feed: Option<f32>,
    /// Programmed N number.
    n: u32,
    /// Motion blocks before it.
    number: u32,
    /// It ends in an exact stop.
    stop: bool,
}

/// The way into the look-ahead.
struct Entrance<'a, const AXES: usize, const BLOCKS: usize> {
    lookahead: &'a mut Lookahead<AXES, BLOCKS>,
    functions: &'a mut Functions,
    dynamics: &'a mut Dynamics<AXES>,
    numbered: &'a mut u32,
}

impl<const AXES: usize, const BLOCKS: usize> Entrance<'_, AXES, BLOCKS> {
    #[inline(never)]
    fn push(&mut self, element: &Element<AXES>, limits: &Permitted, pass: &Pass, due: u32) {
        self.push_here(element, limits, pass, due, false);
    }

    /// The same, inline: of a line only what lines have is made.
    #[inline(always)]
    fn push_here(&mut self, element: &Element<AXES>, limits: &Permitted, pass: &Pass, due: u32, long: bool) {
        // More than fits is made up for later.
        let ahead = pass.number.wrapping_sub(*self.numbered).min(u32::from(u16::MAX));
        *self.numbered = self.numbered.wrapping_add(ahead);
        let numbers = (ahead as u16, pass.n);
        self.lookahead.before(self.functions.before(due));
        self.lookahead.push(element, limits, pass.feed.is_none(), self.dynamics, numbers, long);
        self.dynamics.settle();
        if pass.stop {
            self.lookahead.stop_here();
        }
    }
}

/// What the span planned last was called in the program: the rest of [`PlannedBlock`] is put together when it is asked for.
#[derive(Clone, Copy, Debug, Default)]
struct Planned {
    number: u32,
    blocks: u32,
    n: u32,
}

/// Path distance (LSB 2^-44 mm) per speed (mm/tick) of a block of 2^26 ticks.
const SLOWEST: f32 = (1u64 << 44) as f32 * (1u64 << 26) as f32;

/// Pieces of time per call.
const PIECES: u32 = 8;

/// Pieces that the queue has room for at any time, for a new law in place of one that is already there.
const RESERVE: u32 = PIECES + 2;

/// Curves per call.
const CURVES: u32 = 4;

/// Longest rest handed over at once, ticks.
const LONGEST_REST: u64 = 65_535;

impl<'a, const AXES: usize, const BLOCKS: usize> Planning<'a, AXES, BLOCKS> {
    /// At rest at `start`.
    pub fn new(machine: &MachineData<AXES>, start: [Position; AXES], queue: Sender<'a, AXES>) -> Self {
        Self {
            main: machine.main_axes(),
            dynamics: Dynamics::new(machine),
            programmed: start,
            contouring: Contouring::new(machine.main_axes(), machine.channel.check_jerk_on_poly_path),
            held: Held::none(),
            lookahead: Lookahead::new(machine.channel.look_ahead as usize),
            stage: Stage::Filling,
            flush: false,
            profile: Profile::default(),
            emitter: Emitter::new(),
            curves: 0,
            stops: false,
            rest: 0,
            flights: Flights::new(),
            laid: 0,
            speed: Speed::ZERO,
            owed: 0,
            end: 0,
            mode: Mode::RUN,
            word: Control::NORMAL,
            pace: Pace::new(machine.channel.override_weight_prog_feed),
            functions: Functions::new(),
            reopened: false,
            joining: false,
            stood: false,
            position: start,
            distance: Distance::ZERO,
            taken: 0,
            begun: 0,
            number: 0,
            numbered: 0,
            planned: Planned::default(),
            queue,
        }
    }

    /// Takes in a motion block. Only after [`Work::Hungry`].
    ///
    /// # Errors
    /// The block is refused and leaves no trace.
    pub fn take(&mut self, motion: &Motion<AXES>) -> Result<(), MotionError> {
        let result = self.take_motion(motion);
        if result.is_err() {
            self.functions.drop_unsettled(self.queue.control);
        }
        // Without path: with the block before.
        self.functions.settle(false, false);
        result
    }

    fn take_motion(&mut self, motion: &Motion<AXES>) -> Result<(), MotionError> {
        let feed = match motion.kind {
            MotionKind::Rapid => None,
            _ => Some(to_f32(motion.feed.to_bits()) * (1.0 / 4_294_967_296.0)),
        };
        let (from, to) = (&self.programmed, &motion.target);
        match motion.kind {
            MotionKind::Rapid | MotionKind::Line => {
                if let Some(line) = path::straight(from, to, &self.main)? {
                    let pass = self.pass(motion, feed)?;
                    if !self.contouring.is_idle() {
                        let element = line.element();
                        Self::in_time(&self.dynamics.element(&element, feed), line.length())?;
                        self.round(&element, Form::Line, motion, feed)?;
                    } else if self.join_held(&line, &motion.target, &pass) {
                        self.functions.settle(true, false);
                    } else {
                        let limits = self.dynamics.line(line.tangent(), line.length(), feed);
                        Self::in_time(&limits, line.length())?;
                        self.functions.settle(true, false);
                        self.hold_line(&line, &limits, pass);
                    }
                    self.advance(motion);
                } else if motion.exact_stop {
                    // At the end of the block before.
                    self.contouring.release(true);
                    self.stop_held();
                    if !self.contouring.holds() && self.held.is_none() {
                        self.lookahead.stop_here();
                    }
                }
            }
            MotionKind::Arc { plane, clockwise, by } => {
                let centre = match by {
                    ArcBy::Centre(centre) => centre,
                    ArcBy::Radius(radius) => {
                        path::centre_of_radius(from, to, radius, plane, clockwise, &self.main)?
                    }
                };
                let element = path::arc(from, to, centre, plane, clockwise, &self.main)?;
                let pass = self.pass(motion, feed)?;
                let limits = self.dynamics.element(&element, feed);
                Self::in_time(&limits, element.shape.length)?;
                if self.contouring.is_idle() {
                    self.functions.settle(true, false);
                    self.pass_arc(&element, &limits, pass);
                } else {
                    self.round(&element, Form::Arc { centre, plane, clockwise }, motion, feed)?;
                }
                self.advance(motion);
            }
        }
        Ok(())
    }

    /// Whether the block moves one of these axes: bit i for axis i.
    pub fn moves(&self, motion: &Motion<AXES>, axes: u32) -> bool {
        let ends = motion.target.iter().zip(&self.programmed);
        axes != 0 && ends.enumerate().any(|(k, (to, from))| to != from && axes >> k.min(31) & 1 == 1)
    }

    /// Contour mode changes. Only after [`Work::Hungry`]; `in_motion`: the command stands in a motion block.
    pub fn contour(&mut self, contour: &Contour, in_motion: bool) {
        self.let_go();
        self.contouring.command(contour, in_motion);
    }

    /// What is to be said about the curve that the last motion led to.
    pub fn remark(&mut self) -> Option<NcWarningKind> {
        self.contouring.remark()
    }

    /// The block taken in last ends where it was programmed to. Only after [`Work::Hungry`].
    pub fn keep_corner(&mut self) {
        self.let_go();
        self.contouring.cancel();
    }

    /// A block of that length does not take too long.
    #[inline(always)]
    fn in_time(limits: &Permitted, length: Distance) -> Result<(), MotionError> {
        if to_f32(length.to_bits()) > limits.0.v * SLOWEST { Err(MotionError::TooSlow) } else { Ok(()) }
    }

    /// What goes with a block.
    #[inline(always)]
    fn pass(&self, motion: &Motion<AXES>, feed: Option<f32>) -> Result<Pass, MotionError> {
        // A block without motion needs no feed: it does not come here.
        if feed.is_some_and(|feed| feed <= 0.0) {
            return Err(MotionError::NoFeed);
        }
        Ok(Pass { feed, n: motion.n, number: self.taken, stop: motion.exact_stop })
    }

    /// Contour mode takes a block.
    fn round(
        &mut self,
        element: &Element<AXES>,
        form: Form,
        motion: &Motion<AXES>,
        feed: Option<f32>,
    ) -> Result<(), MotionError> {
        let (from, to) = (self.programmed, motion.target);
        let data =
            Data { feed, n: motion.n, place: motion.place, number: self.taken, stop: motion.exact_stop };
        let parted = self.functions.are_open();
        self.contouring.take(&Block { element: *element, from, to, form, data }, &self.dynamics, parted);
        self.functions.settle(true, self.contouring.rounds());
        Ok(())
    }

    /// A block has been taken in.
    fn advance(&mut self, motion: &Motion<AXES>) {
        self.programmed = motion.target;
        self.taken = self.taken.wrapping_add(1);
    }

    /// Blocks that follow run with this slope, or with that of P-CHAN-00071. Only after [`Work::Hungry`].
    pub fn set_slope(&mut self, slope: Option<SlopeType>) {
        self.let_go();
        self.dynamics.set_slope(slope);
    }

    /// The dynamics, for weights and path limits of the blocks that follow. Only after [`Work::Hungry`].
    pub fn dynamics(&mut self) -> &mut Dynamics<AXES> {
        self.let_go();
        &mut self.dynamics
    }

    /// The way into the look-ahead, and what is held back before it.
    #[inline(always)]
    fn entrance(&mut self) -> (Entrance<'_, AXES, BLOCKS>, &Held<AXES>) {
        let Self { lookahead, functions, dynamics, numbered, held, .. } = self;
        (Entrance { lookahead, functions, dynamics, numbered }, held)
    }

    /// Takes over an element from contour mode.
    #[inline(never)]
    fn push_outgoing(&mut self, outgoing: &Outgoing<AXES>) {
        let Outgoing { element, data, curving, due } = outgoing;
        let limits = match (&element.bounds, curving) {
            (Some(bounds), Some(curving)) => self.dynamics.polynomial(element, bounds, data.feed, *curving),
            _ => self.dynamics.element(element, data.feed),
        };
        let Data { feed, n, number, stop, .. } = *data;
        self.entrance().0.push(element, &limits, &Pass { feed, n, number, stop }, *due);
    }

    /// Hands over what is to happen between the last block taken in and the next one; `in_motion`: it was programmed together
    /// with a motion. Only after [`Work::Hungry`].
    ///
    /// # Errors
    /// The function back, if there is no room: [`Self::rest`], and again when there is.
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
        let room = self.queue.events.room();
        let taken =
            self.functions.take((n, function, synch), (self.taken, in_motion), (room, self.queue.control));
        taken.map_err(|()| function)
    }

    /// Demands a standstill after the blocks taken in, and that many ticks of rest. The next [`Work::Hungry`] comes
    /// when all of it is in the queue.
    pub fn rest(&mut self, ticks: u64) {
        self.flush = true;
        self.rest = ticks;
    }

    /// Goes on.
    ///
    /// # Errors
    /// [`Unplannable`]: a defect of the planner, found by its own verification. Nothing more is planned.
    pub fn work(&mut self) -> Result<Work, Unplannable> {
        if let Some(work) = self.attend() {
            return Ok(work);
        }
        // Asked first: what the queue has no room for is not made. Several at once: each call has its own cost.
        if self.queue.phases.room() < PIECES + RESERVE {
            return Ok(Work::Waiting);
        }
        if self.curves > 0 && !self.queue.segments.is_full() {
            for _ in 0..CURVES {
                if self.curves > 0 && !self.queue.segments.is_full() {
                    self.curve();
                }
            }
            return Ok(Work::Working);
        }
        let before = self.end;
        if !self.emitter.is_done() && self.hand_out() {
            return if self.end == before { Ok(Work::Waiting) } else { Ok(Work::Working) };
        }
        if self.stops {
            self.emitter.settle();
            self.stops = false;
        }
        self.go_on()
    }

    /// Pieces of time into the queue, as many as a call makes; `false` if the law is handed out. Where the queue has no
    /// room for all curves of the span at hand, only those that need no more.
    fn hand_out(&mut self) -> bool {
        if self.curves > 0 {
            let mut phase = Phase::BLANK;
            for _ in 0..PIECES {
                if !self.emitter.has_piece() {
                    return false;
                }
                if !self.emitter.step_until(&mut phase, self.distance) {
                    return true;
                }
                self.put(phase);
            }
            return true;
        }
        let mut ticks = 0;
        let more = self.emitter.hand_out(&mut self.queue.phases, PIECES, &mut ticks);
        self.end = self.end.wrapping_add(clock::TICK * ticks);
        more
    }

    /// Puts a piece in. There is room.
    fn put(&mut self, phase: Phase) {
        self.end = self.end.wrapping_add(clock::TICK * u32::from(phase.ticks));
        let _ = self.queue.phases.push(phase);
    }

    /// Rests at the path distance `at`, as long as a piece can. There is room. Ticks left.
    fn put_rest(&mut self, at: Distance, ticks: u64) -> u64 {
        let now = ticks.min(LONGEST_REST);
        if now > 0 {
            self.put(Phase { distance: at, ticks: now as u16, ..Phase::BLANK });
        }
        ticks - now
    }

    /// The first block of the ring becomes a curve in the queue. There is room.
    fn curve(&mut self) {
        self.curves -= 1;
        let Some(block) = self.lookahead.first() else { return };
        if block.has_functions() {
            self.functions.pass(self.distance, &mut self.queue.events);
        }
        let base = block.shape.base(&self.position);
        self.number = self.number.wrapping_add(u32::from(block.ahead));
        let (start, number) = (self.distance, self.number);
        let _ = self.queue.segments.push_with(|segment| {
            segment.shape.assign(&block.shape);
            segment.base = base;
            segment.start = start;
            segment.n = block.n;
            segment.block = number;
        });
        let length = block.shape.length.to_bits();
        block.shape.end(&base, &mut self.position);
        self.distance = Distance::from_bits(self.distance.to_bits().wrapping_add(length));
        self.lookahead.drop_first();
    }

    /// The next step once the last span is handed out.
    fn go_on(&mut self) -> Result<Work, Unplannable> {
        let behind = self.laid != self.flights.len() || self.curves > 0 || self.owed > 0;
        if (behind || self.mode.stopping)
            && let Some(work) = self.catch_up()?
        {
            return Ok(work);
        }
        match self.stage {
            Stage::Passing => {
                if let Some(blocks) = self.lookahead.step_pass() {
                    self.stage = Stage::Releasing(blocks);
                }
                Ok(Work::Working)
            }
            Stage::Releasing(0) => {
                self.stage = Stage::Filling;
                Ok(Work::Working)
            }
            Stage::Releasing(_) if self.reopened => Ok(self.plan_anew()),
            Stage::Releasing(left) => self.release(left),
            Stage::Filling if self.lookahead.is_full() => Ok(self.begin_pass()),
            Stage::Filling => Ok(self.fill()),
        }
    }

    /// A piece of contour mode's work, if there is any: making a curve, or handing an element on.
    #[inline(never)]
    fn round_off(&mut self) -> bool {
        if self.contouring.go_on(&self.dynamics) {
            return true;
        }
        let Some(outgoing) = self.contouring.outgoing() else { return false };
        self.push_outgoing(&outgoing);
        true
    }

    /// There is room in the look-ahead.
    fn fill(&mut self) -> Work {
        if !self.contouring.is_empty() && self.round_off() {
            return Work::Working;
        }
        if self.flush && self.contouring.holds() {
            self.contouring.release(false);
            return Work::Working;
        }
        if self.flush && !self.held.is_none() {
            self.let_go();
            return Work::Working;
        }
        if self.flush && self.lookahead.is_empty() {
            return self.come_to_rest();
        }
        // On the way to a standstill what is there has to do: a corner that is held back waits for the rest.
        if self.flush || self.mode.stopping { self.begin_pass() } else { Work::Hungry }
    }

    /// Instead of handing on what was planned with gates that are open now.
    fn plan_anew(&mut self) -> Work {
        self.reopened = false;
        if self.flush {
            return self.begin_pass();
        }
        // With all that the ring can hold.
        self.stage = Stage::Filling;
        Work::Working
    }

    fn begin_pass(&mut self) -> Work {
        self.reopened = false;
        self.lookahead.begin_pass(!self.flush);
        self.stage = Stage::Passing;
        Work::Working
    }

    /// Plans the first span of the ring for good.
    #[inline(never)]
    fn release(&mut self, left: usize) -> Result<Work, Unplannable> {
        if self.lookahead.first().is_some_and(|first| first.is_gate()) {
            return Ok(self.wait());
        }
        self.trim();
        if self.queue.segments.is_full() || self.flights.is_full() {
            return Ok(Work::Waiting);
        }
        let Some(flight) = self.flights.spare() else { return Ok(Work::Waiting) };
        let Some(first) = self.lookahead.release(&mut flight.span) else {
            self.stage = Stage::Filling;
            return Ok(Work::Working);
        };
        flight.begin(self.distance);
        let span = &flight.span;
        self.stage = Stage::Releasing(left.saturating_sub(span.blocks));
        let [number, last] = span.ahead.map(|ahead| self.number.wrapping_add(ahead));
        let begun = last.wrapping_add(1);
        let planned = &mut self.planned;
        // A line that stands for several has the number of its last block.
        let merged = number.wrapping_sub(self.begun) as i32 > 0;
        planned.number = if merged { self.begun } else { number };
        planned.blocks = begun.wrapping_sub(self.begun);
        planned.n = first.n;
        self.begun = begun;
        self.curves = span.blocks;
        self.flights.push();
        self.stood = false;
        if let Err(error) = self.lay() {
            self.give_up();
            return Err(error);
        }
        self.curve();
        Ok(Work::Planned)
    }

    /// Where the operator's commands go.
    pub fn control(&self) -> &'a Control {
        self.queue.control
    }

    /// The span planned last. Only after [`Work::Planned`], before the next call of [`Self::work`].
    pub fn planned(&self) -> PlannedBlock {
        let Planned { number, blocks, n } = self.planned;
        let flight = self.flights.len().checked_sub(1).and_then(|last| self.flights.get(last));
        let (length, v_in) =
            flight.map_or_else(Default::default, |flight| (flight.span.length, flight.enters));
        PlannedBlock {
            block: number,
            blocks,
            n,
            length,
            v_in,
            v_peak: self.profile.peak(),
            v_out: self.speed,
            time: self.profile.time(),
            wait: if self.stops { self.emitter.wait() } else { Time::ZERO },
        }
    }

    fn come_to_rest(&mut self) -> Work {
        if self.functions.at_end(self.taken, self.distance, &mut self.queue.events) {
            return self.stand();
        }
        let left = self.stay(self.rest);
        self.rest = left;
        self.flush = left > 0;
        Work::Working
    }

    /// Stays where everything handed on ends, as long as a piece can. There is room: asked at the beginning of the call.
    /// Ticks left.
    fn stay(&mut self, ticks: u64) -> u64 {
        let left = self.put_rest(self.distance, ticks);
        if let Some(flight) = self.flights.len().checked_sub(1).and_then(|last| self.flights.get_mut(last)) {
            flight.rest += ticks - left;
        }
        left
    }
}
