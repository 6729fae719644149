//! From motion blocks to the queue: path, look-ahead and slope in a row, a bounded piece of work per call.
//!
//! | file | what it decides |
//! |---|---|
//! | `intake`, `held_line` | how a motion block comes in; which straight blocks become one |
//! | `functions`, `acknowledge` | where functions come out; how the motion waits at a gate and goes on |
//! | `committed` | which spans have a law that may still change |
//! | `hold`, `descent`, `short_stop` | how the motion stops, through which spans, and whether it can stop sooner |
//! | `search` | how much of that one call does |
//! | `pace` | what override and reduced speed change in the queue |
//! | `change` | when new pieces count for the interrupt |
//! | `reserve`, `slower` | how the motion stops without the planner; what becomes of it where that has no room |
//! | `late` | what happens when text or room for functions is missing |
//! | `forecast` | what a PLC asks about what comes (feature `plc`) |
//! | `examine` | how a program is checked without a plan (feature `examine`) |
//! | `log` | what the PLC is told of the path ahead (feature `plc`) |
//! | `transform` | how elements of tip and angles become those of the axes (feature `kinematics`) |
//! | `seam` | how long a real-time loop waits with its decision (feature `plc`) |
//! | `stand` | where the axes stand at rest, and what a new program begins with |
mod acknowledge;
mod change;
mod committed;
mod descent;
#[cfg(feature = "examine")]
mod examine;
#[cfg(feature = "plc")]
mod forecast;
mod functions;
mod held_line;
mod hold;
mod intake;
mod late;
mod law;
#[cfg(feature = "plc")]
mod log;
mod pace;
mod reserve;
#[cfg(feature = "plc")]
mod seam;
mod search;
mod short_stop;
mod slower;
mod stand;
#[cfg(feature = "kinematics")]
mod transform;
mod turning;

#[cfg(feature = "plc")]
pub use crate::contour_log::Turn;
use crate::control::{Commands, Control};
use crate::dynamics::Dynamics;
use crate::lookahead::{Lookahead, LookaheadMemory, Pace};
use crate::machine::{Beyond, MachineData, Travel};
use crate::math::float::to_f32;
use crate::nc::Place;
use crate::path::Measure;
use crate::quantity::{Distance, Position, Speed, Time};
use crate::queue::{Function, Phase, Sender, Slot, clock};
use crate::slope::brake::{Brake, Motion as Instant};
use crate::slope::emit::Emitter;
use crate::slope::profile::{Profile, Unplannable};
pub use crate::smooth::SplineError;
use crate::smooth::contour::Preset;
use crate::smooth::{Smoother, Smoothing};
use committed::CommittedSpans;
use core::mem::MaybeUninit;
#[cfg(feature = "plc")]
pub use forecast::Inquiry;
use functions::Functions;
use held_line::HeldLine;
use hold::{Mode, REACTION};
pub use intake::MotionError;
use reserve::{FAR, Reserve};
#[cfg(feature = "plc")]
pub use seam::Seam;
use search::Search;
#[cfg(feature = "kinematics")]
pub use transform::{Split, SwitchError};
use turning::Turning;

/// Where the ring is handed on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum RingStage {
    /// Blocks are taken in.
    Filling,
    /// The ring is planned.
    Passing,
    /// That many blocks still leave, span by span.
    Releasing(usize),
}

/// The result of a call.
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
    /// It comes to a standstill where the last block ends: there is no other yet.
    Starved,
    /// It got no time for so long that the motion came to a standstill on its way. It goes on.
    Late,
    /// From its speed there is no way to a standstill that has room: it is slower until there is.
    Slower,
    /// It stands still, and what was taken in is forgotten, as the operator wanted or because a plan failed.
    Aborted,
    /// The curve of a corner leads beyond a software limit. The motion ends before it:
    /// [`Planning::take_refused`].
    Refused,
}

/// Memory of a [`Planning`], which makes in it what is large. All bits zero when new, so that it takes no
/// room in flash.
pub struct PlanningMemory<const AXES: usize, const BLOCKS: usize> {
    lookahead: LookaheadMemory<BLOCKS>,
    committed: CommittedSpans,
    functions: Functions,
    dynamics: MaybeUninit<Dynamics<AXES>>,
    smoothing: MaybeUninit<Smoothing<AXES>>,
    held: MaybeUninit<HeldLine<AXES>>,
    reserve: MaybeUninit<Reserve>,
}

impl<const AXES: usize, const BLOCKS: usize> PlanningMemory<AXES, BLOCKS> {
    /// Empty memory.
    pub const fn new() -> Self {
        Self {
            lookahead: LookaheadMemory::new(),
            committed: CommittedSpans::new(),
            functions: Functions::new(),
            dynamics: MaybeUninit::uninit(),
            smoothing: MaybeUninit::uninit(),
            held: MaybeUninit::uninit(),
            reserve: MaybeUninit::uninit(),
        }
    }
}

impl<const AXES: usize, const BLOCKS: usize> Default for PlanningMemory<AXES, BLOCKS> {
    fn default() -> Self {
        Self::new()
    }
}

/// Path, look-ahead, slope and the planner's end of the queue. What is large of it lies in a
/// [`PlanningMemory`].
pub struct Planning<'a, const AXES: usize, const BLOCKS: usize> {
    measure: Measure,
    dynamics: &'a mut Dynamics<AXES>,
    intake: Intake<'a, AXES>,
    lookahead: Lookahead<'a, AXES, BLOCKS>,
    task: Task,
    profile: Profile,
    frontier: Frontier,
    /// Spans released that the interrupt has not left. The first of them have a law: [`Frontier::planned`].
    committed: &'a mut CommittedSpans,
    /// Path distance up to which the look-ahead is handed on.
    handed: Distance,
    supply: Supply,
    orders: Orders,
    functions: &'a mut Functions,
    reserve: &'a mut Reserve,
    report: Report,
    queue: Sender<'a, AXES>,
}

/// Where blocks come in.
struct Intake<'a, const AXES: usize> {
    machine: &'a MachineData<AXES>,
    /// End of the last block taken in.
    programmed: [Position; AXES],
    /// Where the curves end that have gone into the look-ahead.
    entered: [Position; AXES],
    /// Motion blocks taken in.
    taken: u32,
    smoothing: &'a mut Smoothing<AXES>,
    /// Waits for the next one, only while contour mode is idle.
    held: &'a mut HeldLine<AXES>,
    turning: Turning,
    /// Software limits, and what was refused for them.
    travel: Travel<AXES>,
    refused: Option<(Place, Beyond)>,
    uniform: Uniform,
    #[cfg(feature = "plc")]
    plc: log::Plc<'a>,
    /// Memory for the question of the standstill.
    #[cfg(feature = "plc")]
    inquiry: Option<&'a mut Inquiry>,
    #[cfg(feature = "kinematics")]
    transform: transform::Transform<'a, AXES>,
}

#[cfg(not(feature = "kinematics"))]
impl<const AXES: usize> Intake<'_, AXES> {
    /// What was taken in ends where the curves of the look-ahead end.
    #[inline(always)]
    const fn stand(&mut self) {
        self.programmed = self.entered;
    }
}

/// The blocks whose limits are those of now.
#[derive(Clone, Copy, Debug)]
struct Uniform {
    /// The first of them.
    since: u32,
    /// Curves were asked to keep the jerk of the ramp times (CHECK_JERK=2).
    by_ramps: bool,
}

/// What is being done with the ring, and what is to be done.
#[derive(Clone, Copy, Debug)]
struct Task {
    stage: RingStage,
    /// Everything taken in is to be handed on down to a standstill.
    flush: bool,
    /// Ticks to rest after the standstill.
    rest: u64,
    /// A gate is open: what is in the look-ahead is planned again.
    reopened: bool,
    /// The gate at the first block is open: the law that ends there is made again too.
    joining: bool,
    /// The motion stands, or will stand, before the first block or at the end, with a tick that shows it.
    stood: bool,
    /// The instant at which the queue ends, if nothing has moved since the axes came to stand there.
    shifted: Option<u32>,
    /// A level that the ring cannot follow, and the instant at which the queue ends then.
    refused_level: Option<(u32, f32)>,
}

/// Where laws end: of what is behind, nothing is in the queue.
#[derive(Clone, Copy, Debug)]
struct Frontier {
    /// Cuts the last law into pieces.
    emitter: Emitter,
    /// Spans that have a law. The last of these laws is with the emitter.
    planned: usize,
    /// Speed at the end of that law.
    speed: Speed,
    /// Ticks of rest that belong behind it.
    pending_dwell: u64,
    /// Instant up to which pieces are in the queue.
    end: u32,
    /// The law ends in a standstill.
    stops: bool,
    /// What is in the queue ends at rest.
    rests: bool,
}

/// The operator's commands, and what they make of the motion.
#[derive(Clone, Debug)]
struct Orders {
    mode: Mode,
    /// The commands as they were seen last.
    word: u32,
    /// What they make of the speed.
    pace: Pace,
    /// A law could not be made: the motion stops, and what was taken in is forgotten.
    failed: bool,
    /// Ticks from a command to the change.
    lead: u32,
    /// A change is being tried; the last try changed nothing, and other work has this call.
    trying: bool,
    yields: bool,
    /// For a way down.
    search: Search,
    /// Laws are made for a question of the PLC: they do not count.
    #[cfg(feature = "plc")]
    asking: bool,
    /// A hold keeps the law at hand up to its end.
    #[cfg(feature = "plc")]
    settled: bool,
}

/// How often the queue was found low since blocks are taken in.
#[derive(Clone, Copy, Debug)]
struct Supply {
    /// In so many ticks.
    low: u32,
    /// The last one.
    seen: u32,
}

/// What is told about the program.
#[derive(Clone, Copy, Debug)]
struct Report {
    /// Motion blocks whose time law has begun.
    begun: u32,
    planned: Planned,
    /// The law of the span released last is still being looked for.
    is_due: bool,
}

/// The speed profile of one span of motion blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PlannedBlock {
    /// The first motion block, counted from 0 since the split.
    pub block: u32,
    /// Number of blocks that begin in the span.
    pub blocks: u32,
    /// Programmed N number of the first.
    pub n: u32,
    /// Path length.
    pub length: Distance,
    /// Speed at its start.
    pub v_in: Speed,
    /// Highest speed.
    pub v_peak: Speed,
    /// Speed at its end.
    pub v_out: Speed,
    /// Duration.
    pub time: Time,
    /// If the span ends in a stop: time from there to the tick at which the next motion may begin.
    pub wait: Time,
}

/// What the span planned last was called in the program: the rest of [`PlannedBlock`] is put together when it
/// is asked for.
#[derive(Clone, Copy, Debug, Default)]
struct Planned {
    number: u32,
    blocks: u32,
    n: u32,
}

impl Task {
    /// Blocks are taken in.
    const NONE: Self = Self {
        stage: RingStage::Filling,
        flush: false,
        rest: 0,
        reopened: false,
        joining: false,
        stood: false,
        shifted: None,
        refused_level: None,
    };
}

impl Frontier {
    /// At rest; nothing is in the queue.
    fn start() -> Self {
        let emitter = Emitter::new();
        Self { emitter, planned: 0, speed: Speed::ZERO, pending_dwell: 0, end: 0, stops: false, rests: true }
    }
}

/// What is large of a [`Planning`], made in its memory.
struct Large<'a, const AXES: usize, const BLOCKS: usize> {
    lookahead: &'a mut LookaheadMemory<BLOCKS>,
    committed: &'a mut CommittedSpans,
    functions: &'a mut Functions,
    dynamics: &'a mut Dynamics<AXES>,
    smoothing: &'a mut Smoothing<AXES>,
    held: &'a mut HeldLine<AXES>,
    reserve: &'a mut Reserve,
}

/// What is made in its memory. A call of its own: what it is on the stack until then is there alone.
#[inline(never)]
fn filled<T>(memory: &mut MaybeUninit<T>, make: impl FnOnce() -> T) -> &mut T {
    memory.write(make())
}

/// Pieces of time per call. The queue of a small build has a quarter of the room: fewer at once fill more of it.
const PIECES: u32 = if crate::machine::functions::IS_SMALL { 4 } else { 8 };

/// Pieces that the queue has room for at any time, for a new law in place of one that is already there.
const KEPT_FREE: u32 = PIECES + 2;

/// Longest rest handed over at once, ticks.
const LONGEST_REST: u64 = 65_535;

impl<'a, const AXES: usize, const BLOCKS: usize> Planning<'a, AXES, BLOCKS> {
    /// Planning of a machine that stands at `start`. Earlier contents of `memory` do not matter.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn new(
        memory: &'a mut PlanningMemory<AXES, BLOCKS>,
        machine: &'a MachineData<AXES>,
        start: [Position; AXES],
        queue: Sender<'a, AXES>,
    ) -> Self {
        let PlanningMemory { lookahead, committed, functions, dynamics, smoothing, held, reserve } = memory;
        let dynamics = filled(dynamics, || Dynamics::new(machine));
        let channel = &machine.channel;
        let chords = f32::from(channel.merge_chords) * 0.01;
        let preset = Preset { check_jerk: channel.check_jerk_on_poly_path, chords };
        let measure = Measure::of(machine);
        let smoothing = filled(smoothing, || Smoothing::new(measure, preset, channel.auto_contour_mode));
        let (held, reserve) = (filled(held, HeldLine::none), filled(reserve, Reserve::none));
        let large = Large { lookahead, committed, functions, dynamics, smoothing, held, reserve };
        Self::with(large, machine, start, queue)
    }

    /// With what is large in its place.
    #[inline(never)]
    fn with(
        large: Large<'a, AXES, BLOCKS>,
        machine: &'a MachineData<AXES>,
        start: [Position; AXES],
        queue: Sender<'a, AXES>,
    ) -> Self {
        let Large { lookahead, committed, functions, dynamics, smoothing, held, reserve } = large;
        committed.clear();
        functions.forget();
        let measure = Measure::of(machine);
        let depth = queue.segments.ahead().min(machine.channel.look_ahead as usize);
        let travel = Travel::new(machine);
        let pace = Pace::new(machine.channel.override_weight_prog_feed);
        Self {
            measure,
            dynamics,
            intake: Intake {
                machine,
                programmed: start,
                entered: start,
                taken: 0,
                smoothing,
                held,
                travel,
                refused: None,
                turning: Turning::NONE,
                uniform: Uniform { since: 0, by_ramps: machine.channel.check_jerk_on_poly_path == 2 },
                #[cfg(feature = "plc")]
                plc: log::Plc::NONE,
                #[cfg(feature = "plc")]
                inquiry: None,
                #[cfg(feature = "kinematics")]
                transform: transform::Transform::new(start),
            },
            lookahead: Lookahead::new(lookahead, depth),
            task: Task::NONE,
            profile: Profile::default(),
            frontier: Frontier::start(),
            committed,
            handed: Distance::ZERO,
            supply: Supply { low: 0, seen: 0 },
            orders: Orders {
                mode: Mode::RUN,
                word: Control::NORMAL,
                pace,
                failed: false,
                lead: REACTION,
                trying: false,
                yields: false,
                search: Search::none(),
                #[cfg(feature = "plc")]
                asking: false,
                #[cfg(feature = "plc")]
                settled: false,
            },
            functions,
            reserve,
            report: Report { begun: 0, planned: Planned::default(), is_due: false },
            queue,
        }
    }

    /// Cost of the last call's search for a stop, in about 100 instructions of a Cortex-M4.
    pub const fn searched(&self) -> u32 {
        self.orders.search.spent()
    }

    /// Demands a stop after the blocks taken in, and that many ticks of dwell. The next [`Work::Hungry`] comes when all
    /// of it is in the queue.
    pub fn rest(&mut self, ticks: u64) {
        self.task.flush = true;
        self.task.rest = ticks;
    }

    /// Goes on.
    ///
    /// # Errors
    /// [`Unplannable`]: a defect of the planner, found by its own verification, or a reduced speed at which a
    /// block takes too long. The motion comes to a standstill as with an abort: [`Work::Aborted`] follows.
    pub fn work(&mut self) -> Result<Work, Unplannable> {
        #[cfg(feature = "examine")]
        if self.lookahead.ring.examines() {
            return Ok(self.examine());
        }
        if self.lookahead.is_lowering() {
            self.lookahead.complete_level();
            return Ok(Work::Working);
        }
        if let Some(work) = self.attend() {
            return Ok(work);
        }
        // Also where the queue has no room: the interrupt may come to the standstill before the next call.
        self.end_law();
        // Asked first: what the queue has no room for is not made. Several at once: each call has its own
        // cost.
        if self.queue.phases.room() < PIECES + KEPT_FREE {
            return Ok(self.wait_a_while());
        }
        if !self.frontier.emitter.is_done() {
            if self.frontier.rests && self.frontier.emitter.has_piece() {
                return Ok(self.start());
            }
            if self.hand_out() {
                if !self.reserve.is_kept() {
                    self.secure(self.reserve.near);
                }
                return Ok(Work::Working);
            }
            self.end_law();
        }
        self.go_on()
    }

    /// The first pieces of a motion. With a plan that is at work it waits: the way to its end is not known.
    fn start(&mut self) -> Work {
        if self.task.stage == RingStage::Passing && !self.orders.mode.stopping {
            self.step_pass();
            return Work::Working;
        }
        if !self.begin_start() {
            return Work::Waiting;
        }
        self.hand_out();
        if self.reserve.pending.is_some() {
            self.secure_change();
        } else if !self.reserve.is_kept() {
            self.secure(self.reserve.near);
        }
        Work::Working
    }

    /// A piece of the plan of the ring.
    fn step_pass(&mut self) {
        if let Some(blocks) = self.lookahead.step_pass() {
            self.task.stage = RingStage::Releasing(blocks);
            self.reserve.try_again();
        }
    }

    /// Where a law that ends in a standstill is handed out, what follows begins at a tick, and the end itself
    /// is in reserve.
    #[cfg_attr(feature = "fast", inline(always))]
    fn end_law(&mut self) {
        if self.frontier.stops && self.frontier.emitter.is_done() {
            self.frontier.emitter.settle();
            (self.frontier.stops, self.frontier.rests) = (false, true);
            self.keep_end();
        }
    }

    /// Pieces of time into the queue, as many as a call makes; `false` if the law is handed out.
    fn hand_out(&mut self) -> bool {
        let mut ticks = 0;
        let more = self.frontier.emitter.hand_out(&mut self.queue.phases, PIECES, &mut ticks);
        self.frontier.end = self.frontier.end.wrapping_add(clock::TICK * ticks);
        if ticks > 0 {
            self.frontier.rests = false;
            self.pass_end();
        }
        more
    }

    /// Puts a piece in. There is room.
    fn put(&mut self, phase: Phase) {
        self.frontier.end = self.frontier.end.wrapping_add(clock::TICK * u32::from(phase.ticks));
        let _ = self.queue.phases.push(phase);
        self.pass_end();
    }

    /// Rests at the path distance `at`, as long as a piece can. There is room. Ticks left.
    fn put_rest(&mut self, at: Distance, ticks: u64) -> u64 {
        let now = ticks.min(LONGEST_REST);
        if now > 0 {
            self.put(Phase { distance: at, ticks: now as u16, ..Phase::BLANK });
            self.frontier.rests = true;
        }
        ticks - now
    }

    /// The next step once the last span is handed out.
    fn go_on(&mut self) -> Result<Work, Unplannable> {
        if self.orders.failed && !self.orders.mode.stopping {
            return Ok(self.wait_a_while());
        }
        let behind = self.frontier.planned != self.committed.len() || self.frontier.pending_dwell > 0;
        if (behind || self.orders.mode.stopping)
            && let Some(work) = self.catch_up()?
        {
            return Ok(work);
        }
        match self.task.stage {
            RingStage::Passing => {
                self.step_pass();
                Ok(Work::Working)
            }
            // A span of many blocks was handed on at once: what it took of the room of others comes back
            // first.
            RingStage::Releasing(0) if self.queue.segments.is_over() => Ok(self.wait_a_while()),
            RingStage::Releasing(0) => {
                if self.secure(self.reserve.near.max(FAR)) {
                    return Ok(Work::Working);
                }
                self.task.stage = RingStage::Filling;
                (self.supply.seen, self.supply.low) = (self.queue.clock.now(), 0);
                Ok(Work::Working)
            }
            RingStage::Releasing(_) if self.task.reopened && !self.queue.segments.is_over() => {
                Ok(self.plan_anew())
            }
            RingStage::Releasing(_) if self.has_other_level() && !self.queue.segments.is_over() => {
                Ok(self.try_level())
            }
            RingStage::Releasing(left) => self.release(left),
            RingStage::Filling => Ok(self.fill()),
        }
    }

    /// A piece of the smoother's work, if there is any, or an element that goes on.
    fn round_off(&mut self) -> bool {
        self.intake.smoothing.work(self.dynamics) || self.pass_smoothed()
    }

    /// Blocks are taken in, or the ring is planned if there is no room for another one.
    fn fill(&mut self) -> Work {
        if self.lookahead.ring.is_full() || self.queue.segments.is_ahead_full() || self.runs_dry() {
            return self.begin_pass();
        }
        if self.lookahead.ring.is_empty() {
            self.follow_level();
        }
        #[cfg(feature = "kinematics")]
        if self.intake.transform.is_busy() {
            return self.pass_transformed();
        }
        if !self.intake.smoothing.is_empty() && self.round_off() {
            return if self.intake.refused.is_some() { Work::Refused } else { Work::Working };
        }
        if self.task.flush && self.intake.smoothing.holds() {
            self.intake.smoothing.flush(false);
            return Work::Working;
        }
        if self.task.flush && !self.intake.held.is_none() {
            self.let_go();
            return Work::Working;
        }
        if self.task.flush && self.lookahead.ring.is_empty() {
            return self.come_to_rest();
        }
        // On the way to a standstill what is there has to do: a corner that is held back waits for the rest.
        if self.task.flush || self.orders.mode.stopping { self.begin_pass() } else { Work::Hungry }
    }

    /// Instead of handing on what was planned with gates that are open now, or for another level.
    #[inline(never)]
    fn plan_anew(&mut self) -> Work {
        self.task.reopened = false;
        if self.task.flush {
            return self.begin_pass();
        }
        // With all that the ring can hold.
        self.task.stage = RingStage::Filling;
        Work::Working
    }

    fn begin_pass(&mut self) -> Work {
        self.follow_level();
        // The level is lower: the rest of that comes first.
        self.task.reopened = self.lookahead.is_lowering();
        if self.task.reopened {
            return Work::Working;
        }
        self.lookahead.begin_pass(self.is_open());
        self.task.stage = RingStage::Passing;
        Work::Working
    }

    /// Whether more blocks come into the ring: of the program, or of what the smoother still holds of it.
    pub(super) fn is_open(&self) -> bool {
        #[cfg(feature = "kinematics")]
        if self.intake.transform.is_busy() {
            return true;
        }
        !self.task.flush || self.intake.smoothing.holds() || !self.intake.held.is_none()
    }

    /// Plans the first span of the ring for good.
    #[inline(never)]
    fn release(&mut self, left: usize) -> Result<Work, Unplannable> {
        if self.lookahead.ring.first().is_some_and(|first| first.is_gate()) {
            return Ok(self.wait());
        }
        let now = self.trim();
        if self.secure_at(now, self.reserve.near) {
            return Ok(Work::Working);
        }
        if self.keeps_ahead(now) {
            return Ok(self.wait_a_while());
        }
        // The queue is full: a planner that is called rarely learns so how long it is away.
        if self.queue.segments.is_sated() || self.committed.is_full() {
            return Ok(self.wait_a_while());
        }
        let level = self.level();
        let Some(committed) = self.committed.spare() else { return Ok(Work::Waiting) };
        let Some(first) = self.lookahead.ring.release(&mut committed.span) else {
            self.task.stage = RingStage::Filling;
            return Ok(Work::Working);
        };
        committed.begin(self.handed);
        if committed.span.level < level {
            committed.span.raise(level);
        }
        let blocks = usize::from(committed.span.blocks);
        self.task.stage = RingStage::Releasing(left.saturating_sub(blocks));
        let first = self.queue.segments.handed().wrapping_sub(u32::from(first.is_continued()));
        self.hand_on(blocks);
        self.name(first, blocks);
        self.committed.push();
        self.task.stood = false;
        if self.reserve.behind.is_some() && self.is_behind(self.frontier.planned) {
            self.frontier.planned += 1;
            return Ok(Work::Working);
        }
        // All before it have a law, and this one had none before.
        self.orders.mode.uneven = false;
        self.report.is_due = !self.lay().map_err(|error| self.fail_to_plan(error))?;
        Ok(if self.report.is_due { Work::Working } else { Work::Planned })
    }

    /// The first blocks of the look-ahead leave it, so many: their curves have been in the queue since they
    /// came into it.
    fn hand_on(&mut self, blocks: usize) {
        let mut curves = 0;
        for _ in 0..blocks {
            let Some(block) = self.lookahead.ring.first() else { break };
            curves += u32::from(!block.is_continued());
            self.handed = Distance::from_bits(self.handed.to_bits().wrapping_add(block.length()));
            self.lookahead.ring.drop_first();
        }
        self.queue.segments.hand_on(curves);
    }

    /// Keeps the number, the blocks and the N number of a span. It begins on the curve with the number
    /// `first` and ends on the last one handed on.
    fn name(&mut self, first: u32, blocks: usize) {
        let segments = &self.queue.segments;
        let Some(first) = segments.recent(first) else { return };
        let mut last = first;
        if blocks > 1 {
            last = segments.recent(segments.handed().wrapping_sub(1)).unwrap_or(first);
        }
        let (number, last) = (segments.block_of(first.segment), segments.block_of(last.segment));
        let begun = last.wrapping_add(1);
        // A line that stands for several has the number of its last block.
        let merged = number.wrapping_sub(self.report.begun) as i32 > 0;
        self.report.planned = Planned {
            number: if merged { self.report.begun } else { number },
            blocks: begun.wrapping_sub(self.report.begun),
            n: first.segment.n,
        };
        self.report.begun = begun;
    }

    /// Curves handed on since the split.
    pub fn curves(&self) -> u32 {
        self.queue.segments.handed()
    }

    /// A point of a curve handed on, at `part` 2^16ths of its length, and its motion block.
    pub fn point(&self, curve: u32, part: u32) -> Option<(u32, [Position; AXES])> {
        let track = self.queue.segments.recent(curve)?;
        let distance = (i128::from(track.segment.length()) * i128::from(part)) >> 16;
        Some((self.queue.segments.block_of(track.segment), track.point(distance as i64)))
    }

    /// The span planned last. Only after [`Work::Planned`], before the next call of [`Self::work`].
    pub fn planned(&self) -> PlannedBlock {
        let Planned { number, blocks, n } = self.report.planned;
        let committed = self.committed.len().checked_sub(1).and_then(|last| self.committed.get(last));
        let (length, v_in) =
            committed.map_or_else(Default::default, |committed| (committed.span.length, committed.enters));
        PlannedBlock {
            block: number,
            blocks,
            n,
            length,
            v_in,
            v_peak: self.profile.peak(),
            v_out: self.frontier.speed,
            time: self.profile.time(),
            wait: if self.frontier.stops { self.frontier.emitter.wait() } else { Time::ZERO },
        }
    }

    fn come_to_rest(&mut self) -> Work {
        if self.functions.at_end(self.intake.taken, self.handed, &mut self.queue.actions) {
            return self.stand();
        }
        let left = self.stay(self.task.rest);
        self.task.rest = left;
        self.task.flush = left > 0;
        Work::Working
    }

    /// Stays where everything handed on ends, as long as a piece can. There is room: asked at the beginning
    /// of the call. Ticks left.
    fn stay(&mut self, ticks: u64) -> u64 {
        let left = self.put_rest(self.handed, ticks);
        if let Some(committed) =
            self.committed.len().checked_sub(1).and_then(|last| self.committed.get_mut(last))
        {
            let more = u32::try_from(ticks - left).unwrap_or(u32::MAX);
            committed.rest = committed.rest.saturating_add(more);
        }
        left
    }
}
