//! Planner and interpolator: wiring only, all that an application holds.
//!
//! The front page of the crate shows how they are used.
use crate::control::Control;
use crate::machine::parameter::{CHANNEL, RangeError, check_all, check_axis};
use crate::machine::{AxisKind, AxisName, MachineData, SYNCHRONISED, Synch};
use crate::math::divide::div_wide;
use crate::math::wide::mul_shift;
use crate::nc::{
    Command, ContourMethod, Decoder, DecoderMemory, DwellTime, Head, Kinematics, NcError, NcWarning,
    NcWarningKind, Place, Setup, Spline, Step, Text,
};
use crate::path::measure::FEED_AXES;
use crate::planning::{MotionError, Planning, PlanningMemory, Work};
use crate::quantity::{Distance, Position, Speed, Time};
use crate::queue::{Function, Rings};
use crate::slope::profile::Unplannable;
use crate::tick::Interpolator;

/// All memory of planner and interrupt, for `AXES` axes. `BLOCKS` is the look-ahead of its planner.
///
/// All bits are zero when new, so that a static one lies in `.bss`. [`Self::split`] makes both halves in it: what they are beside that are
/// some hundred bytes.
pub struct Channel<const AXES: usize, const BLOCKS: usize> {
    rings: Rings<AXES, BLOCKS>,
    decoder: DecoderMemory<AXES>,
    planning: PlanningMemory<AXES, BLOCKS>,
}

impl<const AXES: usize, const BLOCKS: usize> Channel<AXES, BLOCKS> {
    /// An empty channel.
    pub const fn new() -> Self {
        Self { rings: Rings::new(), decoder: DecoderMemory::new(), planning: PlanningMemory::new() }
    }

    /// The two halves: `text` will be decoded and planned for `machine`, which stands at `start`.
    ///
    /// # Errors
    /// Machine data out of range, or that this version cannot work with.
    pub fn split<'a, T: Text>(
        &'a mut self,
        machine: &MachineData<AXES>,
        start: [Position; AXES],
        text: T,
    ) -> Result<(Planner<'a, T, AXES, BLOCKS>, Interpolator<'a, AXES>), MachineError> {
        check::<AXES, BLOCKS>(machine)?;
        let Self { rings, decoder, planning } = self;
        let (sender, receiver) = rings.split();
        let planner = Planner {
            decoder: Decoder::new(decoder, Setup::new(machine, start), text),
            planning: Planning::new(planning, machine, start, sender),
            cycle_us: machine.channel.cycle_us,
            ptp: machine.channel.ptp,
            source: Source::Open,
            held: None,
            released: 0,
        };
        Ok((planner, Interpolator::new(receiver, start)))
    }

    /// A decoder alone, in the memory of this channel: to look through `text` before it is run.
    pub fn decode<'a, T: Text>(
        &'a mut self,
        machine: &MachineData<AXES>,
        start: [Position; AXES],
        text: T,
    ) -> Decoder<'a, T, AXES> {
        Decoder::new(&mut self.decoder, Setup::new(machine, start), text)
    }
}

impl<const AXES: usize, const BLOCKS: usize> Default for Channel<AXES, BLOCKS> {
    fn default() -> Self {
        Self::new()
    }
}

/// Machine data that cannot be worked with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MachineError {
    /// A parameter of the axis with this index is out of range.
    Axis(usize, RangeError),
    /// A parameter of the channel is out of range.
    Channel(RangeError),
    /// Two axes have this name.
    Name(AxisName),
    /// The name begins like another address of the language.
    Reserved(AxisName),
    /// This parameter gives the function with this number a synchronisation that this version does not have.
    Synch(&'static str, u16, Synch),
    /// This parameter names too many functions.
    TooManySynch(&'static str),
}

impl core::fmt::Display for MachineError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Axis(_, e) | Self::Channel(e) => write!(
                f,
                "{} ({}) = {} is outside {}…{}, bound by {}",
                e.name, e.id, e.value, e.min, e.max, e.because
            ),
            Self::Name(name) => write!(f, "two axes are called {}", name.as_str()),
            Self::Reserved(name) => write!(
                f,
                "axis {}: {} is an address of the language; expected a name that begins with A, B, C, O, Q, U, V, W, X, Y or Z",
                name.as_str(),
                char::from(name.0[0])
            ),
            Self::Synch(name, code, synch) => {
                write!(f, "{name}[{code}] = {} is known, not available in this version", synch.name())
            }
            Self::TooManySynch(name) => write!(f, "{name}: more than {SYNCHRONISED} functions"),
        }
    }
}

impl core::error::Error for MachineError {}

fn check<const AXES: usize, const BLOCKS: usize>(machine: &MachineData<AXES>) -> Result<(), MachineError> {
    let channel = &machine.channel;
    check_all(channel, CHANNEL).map_err(MachineError::Channel)?;
    if channel.look_ahead as usize > BLOCKS {
        return Err(MachineError::Channel(RangeError {
            id: "P-STUP-00071",
            name: "look_ahead",
            value: channel.look_ahead.into(),
            min: 10,
            max: BLOCKS as i64,
            because: "the memory compiled in",
        }));
    }
    for (name, table) in [("m_synch", &channel.m_synch), ("h_synch", &channel.h_synch)] {
        if table.overflows() {
            return Err(MachineError::TooManySynch(name));
        }
        if let Some((code, synch)) = table.entries().find(|entry| !entry.1.is_available()) {
            return Err(MachineError::Synch(name, *code, *synch));
        }
    }
    for (k, axis) in machine.axes.iter().enumerate() {
        if axis.kind != AxisKind::Spindle {
            if b"DEFGHIJKLMNPRST".contains(&axis.name.0[0]) {
                return Err(MachineError::Reserved(axis.name));
            }
            check_axis(axis).map_err(|e| MachineError::Axis(k, e))?;
        }
        if axis.default_feed_axis && (axis.kind == AxisKind::Spindle || k >= FEED_AXES) {
            let (id, name, because) =
                ("P-CHAN-00011", "default_feed_axis", "the axes of a path: 32, no spindle");
            return Err(MachineError::Axis(k, RangeError { id, name, value: 1, min: 0, max: 0, because }));
        }
        if machine.axes.iter().skip(k + 1).any(|other| other.name == axis.name) {
            return Err(MachineError::Name(axis.name));
        }
    }
    Ok(())
}

/// What one call of [`Planner::poll`] achieved.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Progress {
    /// A bounded piece of work is done and there is more: call again.
    Working,
    /// The queue is full, the program text has nothing yet, or the motion stands still for a feed hold or an acknowledgement: call
    /// again after some ticks.
    Waiting,
    /// A motion block was planned for good: [`Planner::planned`].
    Planned,
    /// The same block has another law: an acknowledgement lets it end faster.
    Replanned,
    /// The program holds something doubtful; it goes on.
    Warning(NcWarning),
    /// The program text comes late: the motion comes to a standstill at the end of what there is, and goes on when there is more.
    /// Said once for each standstill.
    Starved,
    /// The planner got no time for so long that the motion came to a standstill on its way; it goes on. Said once for each standstill.
    Late,
    /// The program has ended and everything is handed to the interpolator. Commands of the operator still act on that: go on
    /// calling as long as it moves.
    Done,
}

/// The time law of one motion block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PlannedBlock {
    /// Its first motion block, counted from 0 since program start.
    pub block: u32,
    /// How many begin in it.
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
    /// Where it ends in a standstill: time from there to the tick at which the next motion may begin.
    pub wait: Time,
}

/// Why a program was refused.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Error {
    /// The text is not a program.
    Nc(NcError),
    /// A command that the language knows and this version does not do: its place and name.
    NotAvailable(Place, &'static str),
    /// A function that the machine data do not enable: its place, and what it needs.
    NotEnabled(Place, &'static str),
    /// A motion block without path or speed.
    Motion(Place, MotionError),
    /// ACC or DEC of #VECTOR LIMIT is below 1 mm/s².
    PathAcceleration(Place),
    /// While the speed is reduced (P-AXIS-00214), a block takes more than 2^27 ticks.
    ReducedTooSlow,
    /// The plan of a block failed its verification: a defect of the planner.
    Unplannable,
}

impl Error {
    /// The word it is about.
    pub fn place(&self) -> Place {
        match self {
            Self::Nc(e) => e.place,
            Self::NotAvailable(place, _)
            | Self::NotEnabled(place, _)
            | Self::Motion(place, _)
            | Self::PathAcceleration(place) => *place,
            Self::ReducedTooSlow | Self::Unplannable => Place::default(),
        }
    }
}

impl core::fmt::Display for Error {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Nc(e) => e.fmt(f),
            Self::NotAvailable(_, name) => write!(f, "{name} is known, not available in this version"),
            Self::NotEnabled(_, needs) => f.write_str(needs),
            Self::Motion(_, MotionError::Path(e)) => e.fmt(f),
            Self::Motion(_, MotionError::NoFeed) => f.write_str("the feed is 0; expected F above 0"),
            Self::Motion(_, MotionError::Released) => {
                f.write_str("an axis that moves here was released by #PUT AX; fetch it with #CALL AX")
            }
            Self::Motion(_, MotionError::TooSlow) => f.write_str(
                "at this feed the block takes more than 67 108 864 ticks; raise F or split the block",
            ),
            Self::PathAcceleration(_) => f.write_str(
                "limit of path acceleration too low; expected ACC and DEC of 1 mm/s² (3600 mm/min²) at least",
            ),
            Self::ReducedTooSlow => f.write_str(
                "at the reduced speed a block takes more than 134 217 728 ticks; raise vb_max_red (P-AXIS-00214) or the override",
            ),
            Self::Unplannable => {
                f.write_str("internal: the plan of a block broke a limit and is not executed")
            }
        }
    }
}

impl core::error::Error for Error {}

/// Why a zero offset was not set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ZeroOffsetError {
    /// Axes move or will move by blocks that are read already.
    NotAtRest,
    /// There are the sets 0…5 and the axes of the machine, and offsets to ±100 000 mm or degrees.
    Range,
}

impl core::fmt::Display for ZeroOffsetError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NotAtRest => "a zero offset is set at rest, when all blocks read are executed",
            Self::Range => {
                "no such zero offset; expected set 0…5, an axis of the machine, at most 100 000 mm or degrees"
            }
        })
    }
}

impl core::error::Error for ZeroOffsetError {}

/// Where the program stands.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    Open,
    /// The last standstill is being planned.
    Ending,
    Ended,
}

/// A function that waits for its place.
#[derive(Clone, Copy)]
struct Held {
    n: u32,
    function: Function,
    in_motion: bool,
}

impl Held {
    fn new(head: &Head, function: Function) -> Self {
        Self { n: head.n, function, in_motion: head.in_motion }
    }
}

/// The half of a channel that works ahead: text to time law, a bounded piece per call. What is large of it lies in the [`Channel`].
pub struct Planner<'a, T: Text, const AXES: usize, const BLOCKS: usize> {
    decoder: Decoder<'a, T, AXES>,
    planning: Planning<'a, AXES, BLOCKS>,
    cycle_us: u32,
    /// FCT_PTP of P-CHAN-00600.
    ptp: bool,
    source: Source,
    /// A function that the ring of events did not take.
    held: Option<Held>,
    /// Axes given away by #PUT AX, bit i for axis i.
    released: u32,
}

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize> Planner<'a, T, AXES, BLOCKS> {
    /// Does a bounded piece of work. Call it in a loop while it says [`Progress::Working`] or [`Progress::Planned`].
    ///
    /// # Errors
    /// The program is refused; what was planned before stays valid and comes to a standstill. Further calls go on
    /// with planning that rest and end in [`Progress::Done`].
    pub fn poll(&mut self) -> Result<Progress, Error> {
        // After an abort there is nothing to hold.
        if self.source == Source::Ended && self.planning.is_idle() {
            return Ok(Progress::Done);
        }
        match self.planning.work() {
            Ok(Work::Working) => return Ok(Progress::Working),
            Ok(Work::Waiting) => return Ok(Progress::Waiting),
            Ok(Work::Planned) => return Ok(Progress::Planned),
            Ok(Work::Replanned) => return Ok(Progress::Replanned),
            Ok(Work::Hungry | Work::Starved) => {}
            Ok(Work::Late) => return Ok(Progress::Late),
            Ok(Work::Aborted) => {
                self.source = Source::Ended;
                self.held = None;
                return Ok(Progress::Working);
            }
            Err(error) => {
                self.source = Source::Ended;
                return Err(match error {
                    Unplannable::Broken => Error::Unplannable,
                    Unplannable::TooSlow => Error::ReducedTooSlow,
                });
            }
        }
        if let Some(held) = self.held {
            return Ok(self.output(held));
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

    /// Where the operator's commands go.
    pub fn control(&self) -> &'a Control {
        self.planning.control()
    }

    /// Sets the offset of an axis in one of the zero offsets, 0…5 for G54…G59 (P-ZERO-00003, here mm or degrees). It counts from
    /// the next line of the program on, also where that zero offset is in force; nothing moves.
    ///
    /// # Errors
    /// The axes do not stand with all blocks executed that were read: before the first call of [`Self::poll`] they do, at the end of
    /// the program, and where the program text is late. Or there is no such zero offset.
    pub fn set_zero_offset(
        &mut self,
        set: usize,
        axis: usize,
        offset: Position,
    ) -> Result<(), ZeroOffsetError> {
        if self.held.is_some() || !self.decoder.is_between_lines() || !self.planning.is_at_rest() {
            return Err(ZeroOffsetError::NotAtRest);
        }
        if self.decoder.set_zero_offset(set, axis, offset) { Ok(()) } else { Err(ZeroOffsetError::Range) }
    }

    /// Whether the motion stands still in a feed hold.
    pub fn is_holding(&self) -> bool {
        self.planning.is_holding()
    }

    /// Whether the motion stands still because a function is not acknowledged: [`Control::awaited`].
    pub fn is_waiting(&self) -> bool {
        self.planning.is_waiting()
    }

    /// The span of motion blocks planned last. Only after [`Progress::Planned`] or [`Progress::Replanned`], before the next call
    /// of [`Self::poll`].
    pub fn planned(&self) -> PlannedBlock {
        self.planning.planned()
    }

    /// Understanding a line and handing its first command out are two steps of the decoder: one call, if the line is short.
    fn decode(&mut self) -> Result<Progress, Error> {
        for _ in 0..2 {
            let step = self.decoder.step();
            if !matches!(step, Ok(Step::Working)) {
                return self.perform(&step);
            }
            if !self.decoder.has_done_little() {
                break;
            }
        }
        Ok(Progress::Working)
    }

    /// By reference: a command is large.
    fn perform(&mut self, step: &Result<Step<AXES>, NcError>) -> Result<Progress, Error> {
        let result = match step {
            Ok(Step::Working) => Ok(Progress::Working),
            Ok(Step::Warning(warning)) => Ok(Progress::Warning(*warning)),
            Ok(Step::Command(command)) => self.execute(command),
            Ok(Step::Late) => Ok(match self.planning.go_without() {
                Work::Waiting => Progress::Waiting,
                Work::Starved => Progress::Starved,
                _ => Progress::Working,
            }),
            Ok(Step::End) => {
                self.end();
                Ok(Progress::Working)
            }
            Err(error) => Err(Error::Nc(error.clone())),
        };
        if result.is_err() {
            self.end();
        }
        result
    }

    /// Stands still after what was taken in, for the one tick that shows it.
    fn end(&mut self) {
        self.planning.rest(1);
        self.source = Source::Ending;
    }

    fn execute(&mut self, command: &Command<AXES>) -> Result<Progress, Error> {
        let refuse = |name| Err(Error::NotAvailable(command.place(), name));
        match command {
            Command::Motion(motion) => {
                if self.planning.moves(motion, self.released) {
                    return Err(Error::Motion(motion.place, MotionError::Released));
                }
                self.planning.take(motion).map_err(|e| {
                    let of_centre = matches!(e, MotionError::Path(path) if path.concerns_centre());
                    Error::Motion(if of_centre { motion.centre } else { motion.place }, e)
                })?;
                if let Some(kind) = self.planning.remark() {
                    return Ok(Progress::Warning(NcWarning { place: motion.place, kind }));
                }
            }
            Command::Dwell(head, DwellTime::Seconds(time)) => {
                let at_corner = self.planning.rounds();
                // 2^-32 s to µs to ticks, up
                let us = mul_shift(time.to_bits().max(0), 1_000_000, 32).unsigned_abs();
                let cycle = u64::from(self.cycle_us);
                self.planning.rest(div_wide(0, us + cycle - 1, cycle));
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
            Command::Slope(_, slope) if slope.default => self.planning.set_slope(None, false),
            Command::Slope(_, slope) => {
                let kind = slope.kind.unwrap_or(self.planning.dynamics().slope());
                self.planning.set_slope(Some(kind), slope.no_opt == Some(false));
            }
            Command::Weight(_, weight) => self.planning.dynamics().weigh(weight),
            Command::VectorLimit(head, limit) => {
                let others = [
                    (limit.radial_acc, "#VECTOR LIMIT RADIAL_ACC"),
                    (limit.radial_jerk, "#VECTOR LIMIT RADIAL_JERK"),
                    (limit.jerk, "#VECTOR LIMIT JERK"),
                    (limit.trans_acc, "#VECTOR LIMIT TRANS_ACC"),
                ];
                if let Some((_, name)) = others.into_iter().find(|(given, _)| limit.on && given.is_some()) {
                    return refuse(name);
                }
                self.planning.dynamics().limit(limit).map_err(|_| Error::PathAcceleration(head.place))?;
            }
            Command::PutAxes(_, axes) => {
                self.released |= axes;
                self.planning.keep_corner();
            }
            Command::CallAxes(_, axes) => {
                self.released &= !axes;
                self.planning.keep_corner();
            }
            Command::FlushWait(_) => self.planning.rest(0),
            // Exact stop came with the motion; the others switch off what this version cannot switch on.
            Command::ExactStop(..) | Command::ProgramEnd(..) => {}
            Command::Contour(head, contour) => {
                if contour.method == Some(ContourMethod::Ptp) && !self.ptp {
                    return Err(Error::NotEnabled(command.place(), PTP_NEEDS));
                }
                if contour.method == Some(ContourMethod::DistMaster) && !self.planning.has_master() {
                    return Err(Error::NotEnabled(command.place(), MASTER_NEEDS));
                }
                self.planning.contour(contour, head.in_motion);
            }
            Command::Spline(_, Spline::Off) | Command::Kinematics(_, Kinematics::Off) => {}
            _ => return refuse(command.name()),
        }
        Ok(Progress::Working)
    }

    fn output(&mut self, held: Held) -> Progress {
        self.held = None;
        let setup = self.decoder.setup();
        let synch = match held.function {
            Function::M(code) => setup.m_synch.of(code),
            Function::H(code) => setup.h_synch.of(code),
            Function::Spindle(_) | Function::Tool(_) => Synch::Mos,
        };
        let Held { n, function, in_motion } = held;
        if self.planning.output(n, function, synch, in_motion).is_err() {
            // Motion and acknowledgements make room: let all of it run.
            self.held = Some(held);
            self.planning.rest(0);
            return Progress::Waiting;
        }
        Progress::Working
    }
}

const PTP_NEEDS: &str = "#CONTOUR MODE [PTP] is not enabled; expected FCT_PTP in configuration.path_preparation.function (P-CHAN-00600)";

const MASTER_NEEDS: &str = "#CONTOUR MODE [DIST_MASTER] needs a master axis; expected one feed axis alone (P-CHAN-00011, default_feed_axis = 1), marked as master axis (P-AXIS-00015, kenngr.achs_mode = 0x10000001)";
