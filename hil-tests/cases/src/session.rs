//! One channel from power-up to power-off: program, M30, next program, refused line, next line, abort, set
//! position, next program, feed hold. Its text lies in memory, or arrives over a line with so many bytes a
//! tick: the set points are the same.
use super::run::{Failure, Outcome, Watch, poll, tick};
use glidepath::channel::{Channel, Error, Handles, Planner, Progress};
use glidepath::digest::Digest;
use glidepath::machine::MachineData;
use glidepath::nc::{Feeder, Stream, Text, TextError, Window};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::tick::{Interpolator, State};

/// Bytes of the window on the line, and those that arrive in a tick.
pub const WINDOW: usize = 256;
const BYTES: usize = 11;

/// Two programs, one behind the other; the second one has a line that no machine understands. Each begins
/// with a dwell, in which the line brings what follows: text that comes late would slow the motion down.
const TWO: &[u8] = b"%FIRST
N10 G04 0.5
N20 G54 G01 X20 Y5 F12000
N30 G261 X40
N40 Y30
N50 G02 X60 Y50 I20 J0
N60 G260 G91 G00 X-7.5
N70 G01 X-10.25 Z3 G131 60
N80 M30
%SECOND
N10 G04 0.5
N20 G01 X30 F6000
N30 G91 G00 X5 Y5 Q7
N40 Y12.5
N50 G03 X10 Y32.5 R20
N60 M30
";

/// Where the refused line, and the word in it, stands.
const REFUSED: [u32; 2] = [13, 19];

/// A program that is aborted, ticks after it began.
const ABORTED: &[u8] = b"N10 G04 0.3
N20 G91 G54 G01 X100 Y40 F20000
N30 X-100
N40 G04 100
N50 M30
";
const ABORT: u32 = 560;

/// A program that is held, ticks after it began, for so long.
const HELD: &[u8] = b"N10 G04 0.3
N20 G01 X40 Y10 Z-1 F15000
N30 G03 X60 Y30 J20
N40 G01 X0
N50 M30
";
const HOLD: u32 = 480;
const HOLD_FOR: u32 = 700;

/// Ticks of one part.
const TICK_LIMIT: u32 = 100_000;

/// Where text comes from.
enum Supply<'a> {
    Memory(&'static [u8]),
    Line(Stream<'a, WINDOW>),
}

impl Text for Supply<'_> {
    fn read(&mut self, file: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        match self {
            Self::Memory(text) => text.read(file, offset, buffer),
            Self::Line(stream) => stream.read(file, offset, buffer),
        }
    }

    fn pass(&mut self, file: u16, offset: u32) {
        if let Self::Line(stream) = self {
            stream.pass(file, offset);
        }
    }

    fn holds(&self, file: u16, offset: u32) -> bool {
        match self {
            Self::Memory(_) => true,
            Self::Line(stream) => stream.holds(file, offset),
        }
    }

    fn start(&mut self) -> u32 {
        match self {
            Self::Memory(text) => text.start(),
            Self::Line(stream) => stream.start(),
        }
    }

    fn next_program(&mut self) -> Option<u32> {
        match self {
            Self::Memory(_) => None,
            Self::Line(stream) => stream.next_program(),
        }
    }
}

/// The line: what has not been sent yet.
struct Line<'a> {
    feeder: Feeder<'a, WINDOW>,
    text: &'static [u8],
}

impl Line<'_> {
    /// A tick's worth of bytes.
    fn send(&mut self) {
        let now = self.text.get(..BYTES).unwrap_or(self.text);
        let sent = self.feeder.push(now);
        self.text = self.text.get(sent..).unwrap_or(&[]);
    }
}

struct Session<'a, 'w, const AXES: usize, const BLOCKS: usize, W> {
    planner: Planner<'a, Supply<'w>, AXES, BLOCKS>,
    interpolator: Interpolator<'a, AXES>,
    operator: Operator<'a, AXES>,
    line: Option<Line<'w>>,
    outcome: Outcome,
    watch: W,
}

impl<const AXES: usize, const BLOCKS: usize, W: Watch<AXES>> Session<'_, '_, AXES, BLOCKS, W> {
    /// Runs until nothing is left to do, or for so many ticks of motion; the first refusal.
    fn run(&mut self, ticks: u32) -> Result<Option<Error>, Failure> {
        let (until, mut refused) = (self.outcome.ticks.saturating_add(ticks), None);
        for _ in 0..TICK_LIMIT {
            let mut done = false;
            while !done {
                let before = self.watch.now();
                let result = poll(&mut self.planner);
                let cost = self.watch.now().wrapping_sub(before);
                self.watch.polled(cost, &result);
                match result {
                    Ok(Progress::Waiting) => break,
                    Ok(Progress::Done) => done = true,
                    Ok(Progress::Planned) => self.outcome.blocks += self.planner.planned().blocks,
                    Ok(_) => {}
                    Err(error) => refused = refused.or(Some(error)),
                }
            }
            if self.tick() == State::Idle && done || self.outcome.ticks >= until {
                return Ok(refused);
            }
        }
        Err(Failure::Endless)
    }

    fn tick(&mut self) -> State {
        if let Some(line) = &mut self.line {
            line.send();
        }
        let before = self.watch.now();
        let state = tick(&mut self.interpolator);
        let cost = self.watch.now().wrapping_sub(before);
        if state == State::Active {
            self.outcome.ticks += 1;
            self.outcome.digest.add(self.interpolator.set_points());
            self.watch.ticked(cost, self.interpolator.set_points());
        }
        state
    }

    /// The same to the end, with nothing refused.
    fn finish(&mut self) -> Result<(), Failure> {
        self.run(u32::MAX)?.map_or(Ok(()), |error| Err(Failure::Program(error)))
    }

    /// Another text.
    fn load(&mut self, text: &'static [u8]) -> Result<(), Failure> {
        let loaded = match &mut self.line {
            Some(line) => {
                line.feeder.restart();
                line.text = text;
                self.planner.load_next().is_ok()
            }
            None => self.planner.load(Supply::Memory(text)).is_ok(),
        };
        expect(loaded, "a program is taken at rest")
    }

    fn script(&mut self) -> Result<(), Failure> {
        self.finish()?;
        expect(self.planner.load_next().is_ok(), "the next program of the same text")?;
        let refused = self.run(u32::MAX)?.map(|error| error.place());
        expect(refused.map(|place| [place.line, place.column]) == Some(REFUSED), "one line is refused")?;
        expect(self.planner.go_on().is_ok(), "the next line")?;
        self.finish()?;

        self.load(ABORTED)?;
        self.run(ABORT)?;
        self.operator.abort();
        self.finish()?;
        expect(self.planner.position() == self.interpolator.set_points(), "it knows where it stands")?;

        for (axis, position) in [(0, Position::lit("12.5")), (2, Position::lit("-3"))] {
            expect(self.planner.set_position(axis, position).is_ok(), "a position is set at rest")?;
        }
        self.load(HELD)?;
        self.run(HOLD)?;
        self.operator.feed_hold();
        for _ in 0..HOLD_FOR {
            let waits = |progress| matches!(progress, Progress::Waiting | Progress::Done);
            while !waits(self.planner.poll().map_err(Failure::Program)?) {}
            self.tick();
        }
        expect(self.planner.is_holding(), "it stands in the hold")?;
        self.operator.resume();
        self.finish()
    }
}

fn expect(is_so: bool, what: &'static str) -> Result<(), Failure> {
    if is_so { Ok(()) } else { Err(Failure::Session(what)) }
}

/// Runs it on three axes or more; over a line, if there is a window for it.
///
/// # Errors
/// What did not happen as it should.
pub fn session<const AXES: usize, const BLOCKS: usize, W: Watch<AXES>>(
    channel: &mut Channel<AXES, BLOCKS>,
    machine: &MachineData<AXES>,
    window: Option<&mut Window<WINDOW>>,
    watch: W,
) -> Result<Outcome, Failure> {
    let (supply, line) = match window {
        Some(window) => {
            let (feeder, stream) = window.split();
            (Supply::Line(stream), Some(Line { feeder, text: TWO }))
        }
        None => (Supply::Memory(TWO), None),
    };
    let Handles { planner, interpolator, operator } =
        channel.split(machine, [Position::ZERO; AXES], supply).map_err(Failure::Machine)?;
    let outcome = Outcome { ticks: 0, starved: 0, blocks: 0, digest: Digest::new() };
    let mut session = Session { planner, interpolator, operator, line, outcome, watch };
    session.script()?;
    Ok(session.outcome)
}
