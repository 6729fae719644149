//! The planner without the NC language: from motion blocks to pieces in the queue. Each call does a bounded
//! amount of work.
//!
//! | file | what it decides |
//! |---|---|
//! | `intake`, `held_line` | how a motion block enters; which straight blocks become one |
//! | `functions`, `acknowledge` | where functions are output; how the motion waits at a gate (synchronisation point) and continues |
//! | `committed` | which spans have a profile that may still change |
//! | `law` | which profile a span gets if the planned one does not fit |
//! | `hold`, `descent`, `short_stop` | how the motion stops, through which spans, and whether it can stop sooner |
//! | `search` | how much of the search for a stop one call does |
//! | `pace` | what override and reduced speed change in the queue |
//! | `change` | when new pieces become valid for the interrupt |
//! | `reserve`, `slower` | how the motion stops without the planner; what happens if this stop has no room |
//! | `late` | what happens when text or room for functions is missing |
//! | `turning` | how far consecutive arcs turn about one centre |
//! | `forecast` | answers to a PLC about the coming motion (feature `plc`) |
//! | `examine` | how a program is checked without a plan (feature `examine`) |
//! | `log` | the log of the path ahead for a PLC (feature `plc`) |
//! | `transform` | how elements of tool tip and angles become elements of the axes (feature `kinematics`) |
//! | `seam` | how long a real-time loop waits before it decides (feature `plc`) |
//! | `stand` | where the axes stand at rest, and where a new program begins |
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
mod limits;
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

/// The stage of the ring of blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
enum RingStage {
    /// The ring takes blocks.
    Filling,
    /// A backward pass plans the speeds of the blocks.
    Passing,
    /// This number of blocks is still to be released, span by span.
    Releasing(usize),
}

/// The result of a call of [`Planning::work`] and similar functions. An application with a channel gets
/// `Progress` instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work {
    /// The call did some work, and there is more to do: call again.
    Working,
    /// The queue is full: the call did no work. Call again after some ticks.
    Waiting,
    /// A span has got its speed profile: [`Planning::planned`] returns it.
    Planned,
    /// The span planned last has got another profile, which ends faster: an acknowledgement came in time, so
    /// the motion does not stop.
    Replanned,
    /// The planner needs the next block; there is no other work.
    Hungry,
    /// The motion stops at the end of the last block, because no further block is known.
    Starved,
    /// The planner was called so rarely that the motion stopped on its path. The motion resumes now.
    Late,
    /// The planner slows the motion down, because a stop from the current speed has no room in the reserve.
    Slower,
    /// The motion has stopped, and the remaining blocks are dropped. The cause is an abort, or a plan that
    /// failed.
    Aborted,
    /// The curve of a corner leads beyond a software limit. The motion ends before it:
    /// [`Planning::take_refused`].
    Refused,
}

/// Static memory for the large parts of a [`Planning`]. All bits are zero when new, so the memory takes no
/// flash.
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
    /// Memory without blocks.
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

/// The planner without the NC language: takes motion blocks and functions, and fills the queue for the
/// interrupt. The large parts lie in a [`PlanningMemory`].
pub struct Planning<'a, const AXES: usize, const BLOCKS: usize> {
    measure: Measure,
    dynamics: &'a mut Dynamics<AXES>,
    intake: Intake<'a, AXES>,
    lookahead: Lookahead<'a, AXES, BLOCKS>,
    task: Task,
    profile: Profile,
    frontier: Frontier,
    /// Released spans that the interrupt has not passed. The first of them have a profile:
    /// [`Frontier::planned`].
    committed: &'a mut CommittedSpans,
    /// Path distance up to which the look-ahead has been released.
    handed: Distance,
    supply: Supply,
    orders: Orders,
    functions: &'a mut Functions,
    reserve: &'a mut Reserve,
    report: Report,
    queue: Sender<'a, AXES>,
}

/// The entry of blocks.
struct Intake<'a, const AXES: usize> {
    machine: &'a MachineData<AXES>,
    /// End of the last block.
    programmed: [Position; AXES],
    /// End of the curves in the look-ahead.
    entered: [Position; AXES],
    /// Number of motion blocks taken.
    taken: u32,
    smoothing: &'a mut Smoothing<AXES>,
    /// The line that waits for the next one, only while contour mode is off.
    held: &'a mut HeldLine<AXES>,
    turning: Turning,
    /// Software limits, and the last refusal because of them.
    travel: Travel<AXES>,
    refused: Option<(Place, Beyond)>,
    uniform: Uniform,
    #[cfg(feature = "plc")]
    plc: log::Plc<'a>,
    /// Memory for a forecast of the stop by a hold.
    #[cfg(feature = "plc")]
    inquiry: Option<&'a mut Inquiry>,
    /// Supervision of the limits that a PLC moves.
    #[cfg(feature = "plc")]
    watch: Option<limits::Watch<'a, AXES>>,
    #[cfg(feature = "kinematics")]
    transform: transform::Transform<'a, AXES>,
}

#[cfg(not(feature = "kinematics"))]
impl<const AXES: usize> Intake<'_, AXES> {
    /// The end of the last block becomes the end of the curves in the look-ahead.
    #[inline(always)]
    const fn stand(&mut self) {
        self.programmed = self.entered;
    }
}

/// The blocks to which the current dynamics apply.
#[derive(Clone, Copy, Debug)]
struct Uniform {
    /// The first block to which the current dynamics apply.
    since: u32,
    /// Whether curves have to keep the jerk of the ramp times (CHECK_JERK=2).
    by_ramps: bool,
}

/// Current and pending work on the ring.
#[derive(Clone, Copy, Debug)]
struct Task {
    stage: RingStage,
    /// Whether all blocks are to be released, down to a stop.
    flush: bool,
    /// Ticks of dwell after the stop.
    rest: u64,
    /// Whether a gate has opened, so that the look-ahead is planned again.
    reopened: bool,
    /// Whether the gate at the first block is open. The profile before this gate is then made again too.
    joining: bool,
    /// Whether the motion stops, or will stop, before the first block or at the end; a tick then shows the
    /// stop.
    stood: bool,
    /// The instant at which the queue ends, if the axes stopped there and nothing has moved since.
    shifted: Option<u32>,
    /// A planned override that the ring could not follow, and the instant at which the queue ended at that
    /// time.
    refused_level: Option<(u32, f32)>,
}

/// The end of the profiles in the queue.
#[derive(Clone, Copy, Debug)]
struct Frontier {
    /// Cuts the last profile into pieces.
    emitter: Emitter,
    /// Number of spans with a profile; the emitter has the last of these profiles.
    planned: usize,
    /// Speed at the end of that profile.
    speed: Speed,
    /// Ticks of dwell after that profile that are not in the queue yet.
    pending_dwell: u64,
    /// Instant up to which pieces are in the queue.
    end: u32,
    /// Whether the profile ends in a stop.
    stops: bool,
    /// Whether the queue ends with a dwell or a standstill.
    rests: bool,
}

/// The operator's commands, and their effect on the motion.
#[derive(Clone, Debug)]
struct Orders {
    mode: Mode,
    /// The commands as read last.
    word: u32,
    /// The commands at the last call that waited.
    rested: u32,
    /// The effect of the commands on the speed.
    pace: Pace,
    /// Whether a profile could not be made: the motion stops, and the remaining blocks are dropped.
    failed: bool,
    /// Ticks from a command to the change.
    lead: u32,
    /// Whether a change was tried in this call and nothing changed. Other work then has this call.
    trying: bool,
    yields: bool,
    /// The search for a stop.
    search: Search,
    /// Whether profiles are made only for a question of the PLC and not for the interrupt.
    #[cfg(feature = "plc")]
    asking: bool,
    /// Whether a hold keeps the current profile to its end.
    #[cfg(feature = "plc")]
    settled: bool,
}

/// How often the queue was low since the planner began to take blocks.
#[derive(Clone, Copy, Debug)]
struct Supply {
    /// Number of ticks with a low queue.
    low: u32,
    /// The last tick with a low queue.
    seen: u32,
}

/// Data for reports about the program.
#[derive(Clone, Copy, Debug)]
struct Report {
    /// Number of motion blocks in spans whose profile has begun.
    begun: u32,
    planned: Planned,
    /// Whether the last released span still has no profile.
    is_due: bool,
}

/// The speed profile of one span, for reports and simulators. A span is a run of motion blocks with one
/// profile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PlannedBlock {
    /// Number of the first motion block in the span, counted from 0 since `Channel::split`.
    pub block: u32,
    /// Number of motion blocks that begin in the span.
    pub blocks: u32,
    /// N number of the first motion block in the span.
    pub n: u32,
    /// Path length of the span.
    pub length: Distance,
    /// Speed at the start of the span.
    pub v_in: Speed,
    /// Highest speed in the span.
    pub v_peak: Speed,
    /// Speed at the end of the span.
    pub v_out: Speed,
    /// Duration of the span.
    pub time: Time,
    /// Time from the stop to the tick at which the next motion may begin, if the span ends in a stop.
    pub wait: Time,
}

/// Program data of the span planned last. The other data of [`PlannedBlock`] are computed on demand.
#[derive(Clone, Copy, Debug, Default)]
struct Planned {
    number: u32,
    blocks: u32,
    n: u32,
}

impl Task {
    /// Blocks are being taken.
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
    /// The state at standstill, with an empty queue.
    fn start() -> Self {
        let emitter = Emitter::new();
        Self { emitter, planned: 0, speed: Speed::ZERO, pending_dwell: 0, end: 0, stops: false, rests: true }
    }
}

/// The large parts of a [`Planning`], made in its memory.
struct Large<'a, const AXES: usize, const BLOCKS: usize> {
    lookahead: &'a mut LookaheadMemory<BLOCKS>,
    committed: &'a mut CommittedSpans,
    functions: &'a mut Functions,
    dynamics: &'a mut Dynamics<AXES>,
    smoothing: &'a mut Smoothing<AXES>,
    held: &'a mut HeldLine<AXES>,
    reserve: &'a mut Reserve,
}

/// Makes a value in its memory. A separate function, so that only its own stack frame holds the value before
/// the copy.
#[inline(never)]
fn filled<T>(memory: &mut MaybeUninit<T>, make: impl FnOnce() -> T) -> &mut T {
    memory.write(make())
}

/// Pieces per call. The queue of a small build is a quarter of the size; with fewer pieces per call, it is
/// filled better.
const PIECES: u32 = if crate::machine::functions::IS_SMALL { 4 } else { 8 };

/// Places of the queue that always stay free for a change of profiles.
const KEPT_FREE: u32 = PIECES + 2;

/// Longest standstill in one piece, ticks.
const LONGEST_REST: u64 = 65_535;

impl<'a, const AXES: usize, const BLOCKS: usize> Planning<'a, AXES, BLOCKS> {
    /// Makes a planner for a machine whose axes stand at `start`. Earlier contents of `memory` do not matter.
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

    /// As [`Self::new`], with the large parts in their places.
    #[inline(never)]
    fn with(
        large: Large<'a, AXES, BLOCKS>,
        machine: &'a MachineData<AXES>,
        start: [Position; AXES],
        #[cfg_attr(not(feature = "driven"), expect(unused_mut))] mut queue: Sender<'a, AXES>,
    ) -> Self {
        let Large { lookahead, committed, functions, dynamics, smoothing, held, reserve } = large;
        committed.clear();
        functions.forget();
        let measure = Measure::of(machine);
        #[cfg(feature = "driven")]
        queue.segments.set_measure(Some(measure));
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
                #[cfg(feature = "plc")]
                watch: None,
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
                rested: Control::NORMAL,
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

    /// Cost of the search for a stop in the last call, in units of about 100 instructions of a Cortex-M4.
    pub const fn searched(&self) -> u32 {
        self.orders.search.spent()
    }

    /// Demands a stop after the blocks taken so far, followed by a dwell of `ticks` ticks. The next
    /// [`Work::Hungry`] comes when stop and dwell are in the queue.
    pub fn rest(&mut self, ticks: u64) {
        self.task.flush = true;
        self.task.rest = ticks;
    }

    /// Does a bounded part of the pending work.
    ///
    /// # Errors
    /// [`Unplannable`]: the check of a plan has found a defect of the planner, or a block takes too long at
    /// reduced speed. The motion stops as with an abort, and a later call returns [`Work::Aborted`].
    pub fn work(&mut self) -> Result<Work, Unplannable> {
        let work = self.step()?;
        // A call that has read new commands counts as work, so that a call that waits is short.
        if matches!(work, Work::Waiting) && self.orders.rested != self.orders.word {
            self.orders.rested = self.orders.word;
            return Ok(Work::Working);
        }
        Ok(work)
    }

    /// [`Self::work`], which may also wait after it has read new commands.
    fn step(&mut self) -> Result<Work, Unplannable> {
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
        // This also happens if the queue has no room: the interrupt may reach the stop before the next call.
        self.end_law();
        // Room is checked first, so that no piece is made in vain. A call makes several pieces, because each
        // call has a fixed cost.
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

    /// Emits the first pieces of a motion. These pieces wait until the plan in progress is complete, because
    /// their stop is unknown before.
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

    /// Does one step of the plan of the ring.
    fn step_pass(&mut self) {
        if let Some(blocks) = self.lookahead.step_pass() {
            self.task.stage = RingStage::Releasing(blocks);
            self.reserve.try_again();
        }
    }

    /// Ends a profile that stops and is in the queue. The next motion begins at a tick; the reserve holds the
    /// tick of the stop.
    #[cfg_attr(feature = "fast", inline(always))]
    fn end_law(&mut self) {
        if self.frontier.stops && self.frontier.emitter.is_done() {
            self.frontier.emitter.settle();
            (self.frontier.stops, self.frontier.rests) = (false, true);
            self.keep_end();
        }
    }

    /// Puts pieces into the queue, at most the number of one call. Returns `false` if the profile is
    /// completely in the queue.
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

    /// Puts a piece into the queue, which must have room.
    fn put(&mut self, phase: Phase) {
        self.frontier.end = self.frontier.end.wrapping_add(clock::TICK * u32::from(phase.ticks));
        let _ = self.queue.phases.push(phase);
        self.pass_end();
    }

    /// Puts a standstill at the path distance `at` into the queue, as one piece. The queue must have room.
    /// Returns the remaining ticks.
    fn put_rest(&mut self, at: Distance, ticks: u64) -> u64 {
        let now = ticks.min(LONGEST_REST);
        if now > 0 {
            self.put(Phase { distance: at, ticks: now as u16, ..Phase::BLANK });
            self.frontier.rests = true;
        }
        ticks - now
    }

    /// The next step after the last profile is in the queue.
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
            // A span of many blocks was released at once and uses more of the curve queue than its share.
            // This room has to become free first.
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

    /// Does one step of the smoother, or takes one of its elements, if there is work.
    fn round_off(&mut self) -> bool {
        self.intake.smoothing.work(self.dynamics) || self.pass_smoothed()
    }

    /// Takes blocks, or plans the ring if there is no room for another block.
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
        #[cfg(feature = "plc")]
        if self.task.flush {
            let end = self.queue.segments.end();
            self.functions.shift_before_end(self.intake.taken, end, &mut self.queue.actions);
        }
        if self.task.flush && self.lookahead.ring.is_empty() {
            return self.come_to_rest();
        }
        // A stop has to use the known blocks: a corner that is held back waits for the remaining program
        // text.
        if self.task.flush || self.orders.mode.stopping { self.begin_pass() } else { Work::Hungry }
    }

    /// Plans again before a release, because gates have opened, or because the planned override has changed.
    #[inline(never)]
    fn plan_anew(&mut self) -> Work {
        self.task.reopened = false;
        if self.task.flush {
            return self.begin_pass();
        }
        // The plan includes as many blocks as the ring can hold.
        self.task.stage = RingStage::Filling;
        Work::Working
    }

    fn begin_pass(&mut self) -> Work {
        self.follow_level();
        // The planned override is lower: the rest of this change comes first.
        self.task.reopened = self.lookahead.is_lowering();
        if self.task.reopened {
            return Work::Working;
        }
        self.lookahead.begin_pass(self.is_open());
        self.task.stage = RingStage::Passing;
        Work::Working
    }

    /// Whether more blocks enter the ring: from the program, or from the smoother.
    pub(super) fn is_open(&self) -> bool {
        #[cfg(feature = "kinematics")]
        if self.intake.transform.is_busy() {
            return true;
        }
        !self.task.flush || self.intake.smoothing.holds() || !self.intake.held.is_none()
    }

    /// Makes the final plan of the ring's first span.
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
        // The queue is full. This tells a rarely called planner the time between its calls.
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
        // This span never had a profile before, and all earlier spans have one.
        self.orders.mode.uneven = false;
        self.report.is_due = !self.lay().map_err(|error| self.fail_to_plan(error))?;
        Ok(if self.report.is_due { Work::Working } else { Work::Planned })
    }

    /// Releases the first `blocks` blocks of the look-ahead. Their curves have been in the queue since they
    /// entered the look-ahead.
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

    /// Stores the number, the blocks and the N number of a span. The span begins on the curve with the number
    /// `first` and ends on the last released curve.
    fn name(&mut self, first: u32, blocks: usize) {
        let segments = &self.queue.segments;
        let Some(first) = segments.recent(first) else { return };
        let mut last = first;
        if blocks > 1 {
            last = segments.recent(segments.handed().wrapping_sub(1)).unwrap_or(first);
        }
        let (number, last) = (segments.block_of(first.segment), segments.block_of(last.segment));
        let begun = last.wrapping_add(1);
        // A line that replaces several blocks has the number of the last one.
        let merged = number.wrapping_sub(self.report.begun) as i32 > 0;
        self.report.planned = Planned {
            number: if merged { self.report.begun } else { number },
            blocks: begun.wrapping_sub(self.report.begun),
            n: first.segment.n,
        };
        self.report.begun = begun;
    }

    /// Number of curves that the planner has released to the interrupt since the start of the channel.
    pub fn curves(&self) -> u32 {
        self.queue.segments.handed()
    }

    /// A point of a released curve, and the number of its motion block. The point lies at `part`/2^16 of the
    /// curve's length; `curve` counts from 0, as in [`Self::curves`].
    pub fn point(&self, curve: u32, part: u32) -> Option<(u32, [Position; AXES])> {
        let track = self.queue.segments.recent(curve)?;
        let distance = (i128::from(track.segment.length()) * i128::from(part)) >> 16;
        Some((self.queue.segments.block_of(track.segment), track.point(distance as i64)))
    }

    /// The profile of the span planned last. Call this function only after [`Work::Planned`], before the next
    /// call of [`Self::work`].
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

    /// Puts a standstill at the end of the released path into the queue, as one piece. There is room: checked
    /// at the start of the call. Returns the remaining ticks.
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
