//! The channel: all memory for one group of axes that follow one program, and the three handles that an
//! application holds: planner, interpolator and operator.
//!
//! The front page of the crate runs one program. This example runs a program and then single lines:
//!
//! ```
//! use glidepath::{AxisData, AxisKind, AxisName, Channel, ChannelData, Handles};
//! use glidepath::{Interpolator, MachineData, Planner, Position, Progress, State};
//!
//! fn finish(planner: &mut Planner<'_, &'static [u8], 1, 120>, interpolator: &mut Interpolator<'_, 1>) {
//!     while !matches!(planner.poll(), Ok(Progress::Done)) {
//!         interpolator.tick();
//!     }
//!     while interpolator.tick() != State::Idle {}
//! }
//!
//! let axis = AxisData::new(AxisName::new("X").unwrap(), AxisKind::Linear);
//! let machine = MachineData { axes: [axis], channel: ChannelData::new() };
//! let mut memory = Channel::<1, 120>::new(); // in firmware: a static
//! let program: &'static [u8] = b"G01 X10 F1000\nM30\n";
//! let Handles { mut planner, mut interpolator, .. } =
//!     memory.split(&machine, [Position::ZERO], program).unwrap();
//! finish(&mut planner, &mut interpolator);
//!
//! planner.continue_with(b"G91 X5").unwrap(); // feed and G01 stay in force
//! finish(&mut planner, &mut interpolator);
//! assert_eq!(interpolator.set_points()[0], Position::from_num(15));
//! ```
mod beside;
mod check;
mod error;
#[cfg(feature = "examine")]
mod examine;
mod filter;
#[cfg(feature = "grbl")]
mod force;
#[cfg(feature = "kinematics")]
mod kinematics;
#[cfg(feature = "plc")]
mod log;
mod memory;
#[cfg(feature = "plc")]
mod repeat;
mod rest;

use beside::Beside;
pub use beside::MoveError;
pub use error::{Error, MachineError};
#[cfg(feature = "plc")]
pub use log::Inquiry;
pub use memory::{Channel, FilteredHandles, Handles};
pub use rest::{Busy, GoOnError, PositionError, ZeroOffsetError};

use crate::fir::{FilterPlan, Unfiltered};
use crate::machine::{Synch, functions};
use crate::math::divide::div_wide;
use crate::math::wide::mul_shift;
use crate::nc::{
    Command, Contour, ContourMethod, Decoder, DwellTime, Head, Hsc, HscMethod, Motion, NcError, NcWarning,
    NcWarningKind, Place, SlopeType, Spline, Step, Text,
};
pub use crate::plan::PlannedBlock;
use crate::plan::{MotionError, Planning, Work};
#[cfg(feature = "plc")]
use crate::rt_loop::LoopError;
use crate::slope::profile::Unplannable;
use crate::technology::Function;

/// What one call of [`Planner::poll`] has done, and when to call again.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Progress {
    /// A bounded piece of work is done, and there is more. Call again at once.
    Working,
    /// There is nothing to do now: the queue is full, program text is missing, or the axes stand for a feed hold or an
    /// acknowledgement. Call again after some ticks.
    Waiting,
    /// A span of motion blocks now has its speed profile; [`Planner::planned`] returns it. Call again at
    /// once.
    Planned,
    /// An acknowledgement came in time, so the span that was planned last has a faster profile now. Call
    /// again at once.
    Replanned,
    /// The program contains a doubtful word. The program continues. Call again at once.
    Warning(NcWarning),
    /// Program text is late. The axes stop at the end of the known path, and resume when text arrives. Each
    /// such stop is reported once.
    Starved,
    /// The planner was called too rarely: the axes stopped on the path, and resume now. Each such stop is
    /// reported once.
    Late,
    /// The motion is slower than programmed. There are two possible reasons. A stop from the programmed speed
    /// would need more than 126 pieces of a speed profile (30 in a small build). Or the stop would lead
    /// beyond the path that the interpolator knows. The planner reports this once, and again only after the
    /// programmed speed was possible in between.
    Slower,
    /// A defect of the planner. The filtered axis with this index deviated by more than AX_DEV of `#FILTER`,
    /// or its acceleration exceeded 0.25 mm per cycle², which its filter cannot process. The planner reports
    /// this once until `#FILTER` changes the filters. [`Planner::filter_deviation`] gives the deviation.
    Deviated(usize),
    /// The program has ended and all motion is planned. Keep calling while the axes move: commands of the operator
    /// still act.
    Done,
}

/// Progress of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    Open,
    /// The last stop is being planned.
    Ending,
    Ended,
}

/// A function that waits for room in the queue.
#[derive(Clone, Copy)]
struct Held {
    n: u32,
    function: Function,
    in_motion: bool,
    /// Whether the motion waits for this function, whatever the machine data say.
    #[cfg(feature = "grbl")]
    pauses: bool,
}

impl Held {
    fn new(head: &Head, function: Function) -> Self {
        Self {
            n: head.n,
            function,
            in_motion: head.in_motion,
            #[cfg(feature = "grbl")]
            pauses: false,
        }
    }
}

/// Reads the program and plans the motion. This handle belongs to a task or to the main loop.
///
/// One channel lives from power-up to power-off. The channel is *at rest* ([`Self::is_at_rest`]) when the
/// axes stand still and all commands read so far are carried out. The channel is at rest before the first
/// program, at the end of a program, after a refused line, after an abort, and while a stream has no text. At
/// rest, the planner takes the next text. The new motion begins exactly where the axes are.
///
/// | call | text | modal functions, F, G92, P parameters, contour mode, slope, weights |
/// |---|---|---|
/// | [`Self::load`] | a new one, from its start | as at program start |
/// | [`Self::load_next`] | the same one, after the program that has ended | as at program start |
/// | [`Self::continue_with`] | a new one, from its start | stay in force: single lines (MDI) |
/// | [`Self::go_on`] | the same one, after the refused line | as before the refused line |
///
/// Program start is ISG's initial state. Words: G01, G17, G71, G90, G359, G260 and no F. Zero offset: G53, or
/// that of P-ZERO-00002. Slope: that of P-CHAN-00071. No weights (G130…) and no `#VECTOR LIMIT` are in force,
/// and all axes belong to the channel. Zero offsets, positions, override and reduced speed belong to the
/// machine: no program resets them.
///
/// An abort, or a plan that failed, stops the axes before some lines that are already read. The modal state
/// after these lines does not fit the position of the axes. So [`Self::continue_with`] then begins with the
/// state of program start. An abort at rest has the same effect.
pub struct Planner<
    'a,
    T: Text,
    const AXES: usize,
    const BLOCKS: usize,
    F = Unfiltered,
    const OVERLAYS: usize = 0,
> {
    decoder: Decoder<'a, T, AXES>,
    planning: Planning<'a, AXES, BLOCKS>,
    cycle_us: u32,
    /// P-CHAN-00600 has FCT_PTP.
    ptp: bool,
    /// P-CHAN-00600 has FCT_SURFACE.
    surface: bool,
    source: Source,
    /// A function for which the ring of actions has no room.
    held: Option<Held>,
    /// Axes given away by `#PUT AX`, bit i for axis i.
    released: u32,
    /// Whether the modal state does not belong to the position of the axes: after an abort, or after a plan
    /// that failed.
    lost: bool,
    filters: F,
    /// Motions of single axes, independent of the path.
    beside: Beside<'a, OVERLAYS>,
    /// The last command, while a program is only checked.
    #[cfg(feature = "examine")]
    seen: Option<Command<AXES>>,
    /// Whether the last command of a run is kept too.
    #[cfg(feature = "examine")]
    watches: bool,
    /// Real-time loops.
    #[cfg(feature = "plc")]
    loops: repeat::Loops<'a, AXES>,
}

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Carries `command` out before the first line, as if the program began with it. Call `begin_with` before the
    /// first [`Self::poll`]. A program that [`Self::load`] starts begins without `command`.
    #[cfg(feature = "grbl")]
    pub fn begin_with(&mut self, command: Command<AXES>) {
        self.decoder.begin_with(command);
    }

    /// Does a bounded amount of work. Call `poll` until it returns [`Progress::Waiting`] or [`Progress::Done`].
    /// `docs/figures.md` has the instruction count of the longest call.
    ///
    /// # Errors
    /// A line is refused. The motion before the line stays valid and ends in a stop. Further calls plan this
    /// motion, up to [`Progress::Done`]. At rest, [`Self::go_on`] continues after the line, and
    /// [`Self::load`] takes another program.
    pub fn poll(&mut self) -> Result<Progress, Error> {
        if OVERLAYS > 0 { self.poll_both() } else { self.poll_path() }
    }

    /// Does one piece of work for the path, or for the limits that a PLC moves.
    #[cfg(feature = "plc")]
    #[cfg_attr(feature = "fast", inline(always))]
    fn poll_path(&mut self) -> Result<Progress, Error> {
        if self.planning.watch_limits(false) {
            return Ok(Progress::Working);
        }
        let progress = self.poll_motion();
        let is_free = matches!(progress, Ok(Progress::Waiting | Progress::Done));
        if is_free && self.planning.watch_limits(true) { Ok(Progress::Working) } else { progress }
    }

    /// Does one piece of work for the path.
    #[cfg(not(feature = "plc"))]
    #[inline(always)]
    fn poll_path(&mut self) -> Result<Progress, Error> {
        self.poll_motion()
    }

    /// Does one piece of work for the path.
    #[cfg_attr(feature = "fast", inline(always))]
    fn poll_motion(&mut self) -> Result<Progress, Error> {
        // At rest, there is no motion to hold or to abort.
        if self.source == Source::Ended && self.planning.is_idle() {
            if self.filters.is_pending() {
                return Ok(self.change_filters());
            }
            if !self.beside.is_free() {
                return self.wait_beside();
            }
            self.forget_abort();
            #[cfg(feature = "plc")]
            self.planning.settle_log();
            return Ok(self.done());
        }
        if self.settles_at_gate() {
            return Ok(Progress::Waiting);
        }
        match self.planning.work() {
            Ok(Work::Working) => return Ok(Progress::Working),
            Ok(Work::Waiting) => return Ok(Progress::Waiting),
            Ok(Work::Planned) => return Ok(Progress::Planned),
            Ok(Work::Replanned) => return Ok(Progress::Replanned),
            Ok(Work::Hungry | Work::Starved) => {}
            Ok(Work::Late) => return Ok(Progress::Late),
            Ok(Work::Slower) => return Ok(Progress::Slower),
            Ok(Work::Aborted) => {
                self.lose();
                #[cfg(feature = "plc")]
                self.planning.cut_log();
                return Ok(Progress::Working);
            }
            Ok(Work::Refused) => return Err(self.refuse_curve()),
            Err(error) => {
                self.lose();
                self.planning.drop_ahead();
                return Err(match error {
                    Unplannable::Broken => Error::Unplannable,
                    Unplannable::TooSlow => Error::ReducedTooSlow,
                });
            }
        }
        #[cfg(feature = "kinematics")]
        if self.switches() {
            return Ok(Progress::Working);
        }
        #[cfg(feature = "plc")]
        if self.planning.waits_for_log() || self.still_moves() {
            return Ok(Progress::Waiting);
        }
        if let Some(axis) = self.filters.beyond() {
            return Ok(Progress::Deviated(axis));
        }
        if self.filters.is_pending() {
            return Ok(self.change_filters());
        }
        if let Some(held) = self.held {
            return Ok(self.output_held(held));
        }
        if !self.beside.is_free() && (self.beside.pending.is_some() || self.source != Source::Open) {
            return self.wait_beside();
        }
        #[cfg(feature = "plc")]
        if self.loops.repeat() {
            return self.repeat();
        }
        match self.source {
            Source::Open => self.decode(),
            Source::Ending => {
                self.source = Source::Ended;
                Ok(Progress::Working)
            }
            Source::Ended => Ok(Progress::Done),
        }
    }

    /// Returns the next report, or `Done`: all work is done. Reports about the last curves come first.
    #[cold]
    fn done(&mut self) -> Progress {
        match self.planning.last_remark() {
            Some((kind, place)) => Progress::Warning(NcWarning { place, kind }),
            None => Progress::Done,
        }
    }

    /// Whether the axes stand still because of a feed hold.
    pub fn is_holding(&self) -> bool {
        self.planning.is_holding() && self.filters.is_settled()
    }

    /// Whether the axes stand still because the operator has not acknowledged a function:
    /// [`Operator::awaited`](crate::operator::Operator::awaited).
    pub fn is_waiting(&self) -> bool {
        self.planning.is_waiting() && self.filters.is_settled()
    }

    /// Number of ticks, at least 1, after which [`Self::poll`] should be called again. The value is valid
    /// after [`Progress::Waiting`], for a task that sleeps in between. The motion is the same as with a call
    /// after each tick.
    ///
    /// Commands of the operator, acknowledgements and new program text act at the next call of
    /// [`Self::poll`]. So the task that gives them has to wake the planner's task. Returns `None` if the axes
    /// stand still and only one of these three events lets them move again.
    pub fn wakes_after(&self) -> Option<u32> {
        let stands =
            self.is_waiting() || self.is_holding() || (self.is_at_rest() && self.filters.is_settled());
        (!stands).then(|| if self.beside.is_free() { self.planning.ticks_of_reserve() } else { 1 })
    }

    /// The span of motion blocks that was planned last. The value is valid from [`Progress::Planned`] or
    /// [`Progress::Replanned`] until the next call of [`Self::poll`].
    pub fn planned(&self) -> PlannedBlock {
        self.planning.planned()
    }

    /// Number of curves written into the queue since the split. For simulators: a controller does not need
    /// this call.
    #[doc(hidden)]
    pub fn curves(&self) -> u32 {
        self.planning.curves()
    }

    /// Cost of the search for a stop in the last call, in units of about 100 instructions of a Cortex-M4. For tests: a
    /// controller does not need this call.
    #[doc(hidden)]
    pub fn searched(&self) -> u32 {
        self.planning.searched()
    }

    /// The point of a curve at `part` 2^16ths of the curve's length, and its motion block. Returns `None` if
    /// the curve is no longer in the queue.
    #[doc(hidden)]
    pub fn point(&self, curve: u32, part: u32) -> Option<(u32, [crate::quantity::Position; AXES])> {
        self.planning.point(curve, part)
    }

    /// Decodes a line. The decoder reads a line in one step and returns its first command in another; a short
    /// line takes one call. A separate function, so that its stack frame does not exist during planning.
    #[inline(never)]
    fn decode(&mut self) -> Result<Progress, Error> {
        #[cfg(feature = "plc")]
        if self.loops.flushes && self.decoder.is_between_lines() {
            self.loops.flushes = false;
            self.flush_and_wait();
            return Ok(Progress::Working);
        }
        for _ in 0..2 {
            if self.decoder.restricts() && self.ends_row() {
                break;
            }
            let step = self.decoder.step();
            match step {
                Ok(Step::Working) => {}
                Ok(Step::Late) => return Ok(self.go_without()),
                _ => return self.perform(&step),
            }
            if !self.decoder.has_done_little() {
                break;
            }
        }
        Ok(Progress::Working)
    }

    /// Ends the run of blocks that smoothing holds back, before a command that changes the dynamics. The held
    /// blocks keep the dynamics that were in force. Returns whether the run must be planned first.
    #[cold]
    #[inline(never)]
    fn ends_row(&mut self) -> bool {
        let changes = self.decoder.restriction().is_some_and(|command| self.planning.changes(&command));
        changes && self.planning.end_row()
    }

    /// Handles late program text.
    #[inline(never)]
    fn go_without(&mut self) -> Progress {
        match self.planning.go_without() {
            Work::Waiting => Progress::Waiting,
            Work::Starved => Progress::Starved,
            _ => Progress::Working,
        }
    }

    /// Carries out a step of the decoder. The step is a reference because a command is large. Not inlined, so
    /// that its stack frame is gone while text is decoded.
    #[inline(never)]
    fn perform(&mut self, step: &Result<Step<AXES>, NcError>) -> Result<Progress, Error> {
        #[cfg(feature = "examine")]
        self.see(step);
        let result = match step {
            Ok(Step::Working | Step::Late) => Ok(Progress::Working),
            Ok(Step::Warning(warning)) => Ok(Progress::Warning(*warning)),
            Ok(Step::Command(command)) => self.execute(command),
            #[cfg(feature = "plc")]
            Ok(Step::End) if let Some(place) = self.unclosed_loop() => {
                Err(Error::Loop(place, LoopError::Unclosed))
            }
            Ok(Step::End) => {
                #[cfg(feature = "plc")]
                if self.decoder.setup().given.late_sync_ready {
                    self.planning.demand_all();
                }
                self.end();
                Ok(Progress::Working)
            }
            Err(error) => Err(Error::Nc(error.clone())),
        };
        if result.is_err() {
            self.refuse();
        }
        result
    }

    /// Refuses the current line: the motion stops after the last block before it.
    #[cold]
    fn refuse(&mut self) {
        self.decoder.refuse();
        #[cfg(feature = "plc")]
        self.break_loop();
        self.held = None;
        self.end();
    }

    /// Refuses the curve of a corner because of a software limit.
    #[cold]
    #[inline(never)]
    fn refuse_curve(&mut self) -> Error {
        self.refuse();
        #[cfg(feature = "kinematics")]
        if let Some((place, error)) = self.planning.take_unsplit() {
            return self.error(place, MotionError::Split(error));
        }
        match self.planning.take_refused() {
            Some((place, beyond)) => self.error(place, MotionError::Beyond(beyond)),
            None => Error::Unplannable,
        }
    }

    /// The error for a refused motion.
    #[cold]
    fn error(&self, place: Place, error: MotionError) -> Error {
        match error {
            MotionError::Beyond(beyond) => {
                let name = self.decoder.setup().names.get(beyond.axis).copied();
                Error::SoftwareLimit(place, name.unwrap_or_default(), beyond)
            }
            #[cfg(feature = "kinematics")]
            MotionError::Split(split) => {
                let name = self.decoder.setup().names.get(split.axis());
                Error::NoTransformation(place, name.copied().unwrap_or_default(), split)
            }
            _ => Error::Motion(place, error),
        }
    }

    /// Drops the lines that were read beyond the coming stop.
    #[cold]
    fn lose(&mut self) {
        self.beside.stop();
        #[cfg(feature = "plc")]
        self.loops.forget();
        self.source = Source::Ended;
        self.held = None;
        self.lost = true;
        self.filters.cancel();
        self.decoder.refuse();
    }

    /// Stops after the last block, with a tick that shows the end.
    fn end(&mut self) {
        self.planning.rest(1);
        self.source = Source::Ending;
    }

    fn execute(&mut self, command: &Command<AXES>) -> Result<Progress, Error> {
        #[cfg(feature = "plc")]
        if self.loops.read() {
            return self.keep(command);
        }
        #[cfg(feature = "examine")]
        self.see_done(command);
        let Command::Motion(motion) = command else { return self.carry_out(command) };
        if self.moves_released(motion) {
            self.planning.drop_motion();
            return Err(Error::Motion(motion.place, MotionError::Released));
        }
        if OVERLAYS > 0 && self.joins(motion) {
            return Ok(Progress::Working);
        }
        #[cfg(feature = "plc")]
        if motion.kind != crate::nc::MotionKind::Rapid {
            self.planning.demand(false);
        }
        self.planning.take(motion).map_err(|e| self.error_of(motion, e))?;
        if motion.exact_stop && (OVERLAYS > 0 || self.settling() > 0) {
            self.stop_exactly();
        }
        if let Some(kind) = self.planning.remark() {
            return Ok(Progress::Warning(NcWarning { place: motion.place, kind }));
        }
        Ok(Progress::Working)
    }

    /// Carries out any command except a motion. A separate function, so that its stack frame does not exist
    /// during motions.
    #[inline(never)]
    fn carry_out(&mut self, command: &Command<AXES>) -> Result<Progress, Error> {
        let refuse = |name| Err(Error::NotAvailable(command.place(), name));
        #[cfg(feature = "kinematics")]
        self.check_under(command)?;
        let isg = functions::ISG.is_built();
        match command {
            Command::Dwell(head, DwellTime::Seconds(time)) => {
                let at_corner = self.planning.rounds();
                // Converts 2^-32 s to µs and then to ticks, rounded up.
                let us = mul_shift(time.to_bits().max(0), 1_000_000, 32).unsigned_abs();
                let cycle = u64::from(self.cycle_us);
                self.planning.rest(div_wide(0, us + cycle - 1, cycle) + self.settling());
                if at_corner {
                    let kind = NcWarningKind::DwellAtCorner;
                    return Ok(Progress::Warning(NcWarning { place: head.place, kind }));
                }
            }
            Command::Dwell(_, DwellTime::Revolutions(_)) => return refuse("G04 S (revolutions)"),
            Command::M(_, 0) => return refuse("M00"),
            Command::M(_, 1) => return refuse("M01"),
            Command::M(head, code) => return Ok(self.output(Held::new(head, Function::M(*code)))),
            Command::H(head, code) => return Ok(self.output(Held::new(head, Function::H(*code)))),
            Command::Spindle(head, speed) => {
                return Ok(self.output(Held::new(head, Function::Spindle(*speed))));
            }
            Command::Tool(head, tool) => return Ok(self.output(Held::new(head, Function::Tool(*tool)))),
            Command::Slope(..) | Command::Weight(..) | Command::VectorLimit(..) if isg => {
                self.restrict(command)?;
            }
            Command::PutAxes(_, axes) if isg => {
                self.released |= axes;
                self.planning.keep_corner();
                self.join(*axes);
            }
            Command::CallAxes(_, axes) if isg => {
                self.released &= !axes;
                self.planning.keep_corner();
                self.join(*axes);
            }
            Command::FlushWait(_) if isg => self.flush_and_wait(),
            Command::Oscillation(..) | Command::Independent(..) if isg && OVERLAYS > 0 => {
                self.hold_back(command)
            }
            Command::WaitIndependent(_, axes) if isg => self.wait_independent(*axes),
            // The exact stop was taken together with the motion. The other commands switch functions off that
            // this version cannot switch on.
            Command::ExactStop(..) | Command::ProgramEnd(..) => {}
            Command::Contour(head, contour) if isg || functions::DIALECTS.is_built() => {
                self.contour(head, contour)?
            }
            Command::Spline(head, spline) if isg => return self.spline(head, spline),
            Command::Hsc(head, hsc) if isg => return self.hsc(head, hsc),
            Command::Filter(head, filter) if isg && (F::EXIST || !command.switches_off()) => {
                return self.filter(head, filter);
            }
            Command::Filter(..) if command.switches_off() => {}
            #[cfg(feature = "kinematics")]
            Command::Kinematics(head, kinematics) => self.transform(head, *kinematics)?,
            #[cfg(not(feature = "kinematics"))]
            Command::Kinematics(_, crate::nc::Kinematics::Off) => {}
            #[cfg(feature = "plc")]
            Command::ContourLog(..) | Command::DistanceClear(_) => self.log(command)?,
            #[cfg(feature = "plc")]
            Command::RtWhile(head, modulo) => self.begin_loop(head, Some(*modulo))?,
            #[cfg(feature = "plc")]
            Command::RtEndWhile(head) => self.begin_loop(head, None)?,
            #[cfg(feature = "grbl")]
            Command::Pause(..) | Command::Output(..) | Command::WaitInput(..) => {
                return self.put_out(command);
            }
            #[cfg(any(feature = "grbl", feature = "plc"))]
            Command::Message(_) => {}
            #[cfg(feature = "plc")]
            Command::Flush(_) => self.planning.keep_corner(),
            #[cfg(feature = "plc")]
            Command::ExplicitSynch(_) => self.planning.demand(true),
            _ => return refuse(command.name()),
        }
        Ok(Progress::Working)
    }

    /// Stops the path and the single axes.
    #[inline(always)]
    fn flush_and_wait(&mut self) {
        self.planning.rest(0);
        self.join(u32::MAX);
        #[cfg(feature = "plc")]
        self.wait_for_standstill();
    }

    /// Carries out a pause, an output or a wait for an input, in a dialect other than ISG's.
    #[cfg(feature = "grbl")]
    fn put_out(&mut self, command: &Command<AXES>) -> Result<Progress, Error> {
        let held = match command {
            Command::Pause(head, code) => Held { pauses: true, ..Held::new(head, Function::M(*code)) },
            Command::WaitInput(head, wait) => {
                Held { pauses: true, ..Held::new(head, Function::Input(*wait)) }
            }
            Command::Output(head, function, at_once) => {
                if *at_once {
                    self.planning.keep_corner();
                }
                Held::new(head, *function)
            }
            _ => return Ok(Progress::Working),
        };
        Ok(self.output(held))
    }

    fn contour(&mut self, head: &Head, contour: &Contour) -> Result<(), Error> {
        if contour.method == Some(ContourMethod::Ptp) && !self.ptp {
            return Err(Error::NotEnabled(head.place, PTP_NEEDS));
        }
        if contour.method == Some(ContourMethod::DistMaster) && !self.planning.has_master() {
            return Err(Error::NotEnabled(head.place, MASTER_NEEDS));
        }
        self.look_ahead(head)?;
        let taken = self.planning.contour(contour, head.in_motion);
        taken.map_err(|error| Error::Spline(head.place, error))
    }

    fn spline(&mut self, head: &Head, spline: &Spline<AXES>) -> Result<Progress, Error> {
        self.look_ahead(head)?;
        let remark = self.planning.spline(spline).map_err(|error| Error::Spline(head.place, error))?;
        let place = head.place;
        Ok(remark.map_or(Progress::Working, |kind| Progress::Warning(NcWarning { place, kind })))
    }

    fn hsc(&mut self, head: &Head, hsc: &Hsc) -> Result<Progress, Error> {
        // Switching off and setting parameters have no precondition.
        if hsc.switch == Some(true) {
            self.check_method(self.planning.hsc_method(hsc))
                .map_err(|needs| Error::NotEnabled(head.place, needs))?;
        }
        self.look_ahead(head)?;
        if self.planning.hsc(hsc).map_err(|error| Error::Spline(head.place, error))? {
            return Ok(Progress::Working);
        }
        let kind = NcWarningKind::HscIsOn;
        Ok(Progress::Warning(NcWarning { place: head.place, kind }))
    }

    /// Checks that a method of `#HSC` is available. The error names what the method needs.
    fn check_method(&self, method: HscMethod) -> Result<(), &'static str> {
        match method {
            HscMethod::Surface => {
                functions::SURFACE.check()?;
                if !self.surface {
                    return Err(SURFACE_NEEDS);
                }
                if self.planning.measures_space() { Ok(()) } else { Err(SURFACE_MEASURES) }
            }
            HscMethod::Bspline | HscMethod::Op(2) => functions::SPLINES.check(),
            HscMethod::Op(_) => Ok(()),
        }
    }

    /// Sets slope, weights and limits along the path, for the following blocks.
    fn restrict(&mut self, command: &Command<AXES>) -> Result<(), Error> {
        match command {
            Command::Slope(_, slope) => {
                if !slope.default && slope.kind == Some(SlopeType::Hsc) {
                    functions::HSC.check().map_err(|needs| Error::NotEnabled(command.place(), needs))?;
                }
                self.planning.set_slope(slope);
                self.watch_filters();
            }
            Command::Weight(head, weight) => {
                self.look_ahead(head)?;
                self.planning.weigh(weight);
                self.watch_filters();
            }
            Command::VectorLimit(head, limit) => {
                let others = [
                    (limit.radial_acc, "#VECTOR LIMIT RADIAL_ACC"),
                    (limit.radial_jerk, "#VECTOR LIMIT RADIAL_JERK"),
                    (limit.jerk, "#VECTOR LIMIT JERK"),
                    (limit.trans_acc, "#VECTOR LIMIT TRANS_ACC"),
                ];
                if let Some((_, name)) = others.into_iter().find(|(given, _)| limit.on && given.is_some()) {
                    return Err(Error::NotAvailable(command.place(), name));
                }
                self.planning.dynamics().limit(limit).map_err(|_| Error::PathAcceleration(head.place))?;
            }
            _ => {}
        }
        Ok(())
    }

    fn error_of(&self, motion: &Motion<AXES>, error: MotionError) -> Error {
        let of_centre = matches!(error, MotionError::Path(path) if path.concerns_centre());
        self.error(if of_centre { motion.centre } else { motion.place }, error)
    }

    /// Whether the motion moves an axis that the program has given away.
    fn moves_released(&self, motion: &Motion<AXES>) -> bool {
        self.released != 0 && self.released & self.planning.moved(motion) != 0
    }

    /// Checks the motion of a line that also has a command which changes modal state. If the motion is
    /// refused, the command must not be carried out.
    #[inline(never)]
    fn look_ahead(&self, head: &Head) -> Result<(), Error> {
        match self.decoder.motion() {
            Some(motion) if head.in_motion => {
                if self.moves_released(&motion) {
                    return Err(Error::Motion(motion.place, MotionError::Released));
                }
                self.planning.look_at(&motion).map_err(|e| self.error_of(&motion, e))
            }
            _ => Ok(()),
        }
    }

    fn output(&mut self, held: Held) -> Progress {
        self.held = None;
        let setup = self.decoder.setup();
        let synch = match held.function {
            Function::M(code) => setup.m_synch.of(code),
            Function::H(code) => setup.h_synch.of(code),
            Function::Spindle(_) | Function::Tool(_) => Synch::Mos,
            #[cfg(feature = "grbl")]
            Function::Digital(..) | Function::Analog(..) | Function::Input(_) => Synch::Mos,
        };
        #[cfg(feature = "grbl")]
        let synch = if held.pauses { Synch::MnsSns } else { synch };
        #[cfg(feature = "plc")]
        {
            let setup = self.decoder.setup();
            self.loops.flushes |= match held.function {
                Function::M(code) => setup.m_synch.flushes(code),
                Function::H(code) => setup.h_synch.flushes(code),
                _ => false,
            };
        }
        let Held { n, function, in_motion, .. } = held;
        if self.planning.output(n, function, synch, in_motion).is_err() {
            self.held = Some(held);
            return Progress::Working;
        }
        #[cfg(feature = "plc")]
        if synch.is_shifted() {
            let setup = self.decoder.setup();
            self.planning.shift(match function {
                Function::M(code) => setup.m_synch.shift(code),
                Function::H(code) => setup.h_synch.shift(code),
                _ => 0,
            });
        }
        Progress::Working
    }

    /// Outputs a function for which there was no room before: motion and acknowledgements have made room. A
    /// separate call, because [`Self::output`] has the command on the stack.
    #[inline(never)]
    fn output_held(&mut self, held: Held) -> Progress {
        let progress = self.output(held);
        if self.held.is_some() && self.planning.make_room() == Work::Waiting {
            return Progress::Waiting;
        }
        progress
    }
}

const PTP_NEEDS: &str = "#CONTOUR MODE [PTP] is not enabled; expected FCT_PTP in configuration.path_preparation.function (P-CHAN-00600)";

const SURFACE_NEEDS: &str = "#HSC [SURFACE] is not enabled; expected FCT_SURFACE in configuration.path_preparation.function (P-CHAN-00600)";

const SURFACE_MEASURES: &str =
    "#HSC [SURFACE] needs the main axes as feed axes (P-CHAN-00011, default_feed_axis)";

const MASTER_NEEDS: &str = "#CONTOUR MODE [DIST_MASTER] needs a master axis; expected one feed axis alone (P-CHAN-00011, default_feed_axis = 1), marked as master axis (P-AXIS-00015, kenngr.achs_mode = 0x10000001)";
