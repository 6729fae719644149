//! What the examples of RTIC, Embassy, FreeRTOS and C do, in one loop: text over a line, an operator's panel, functions
//! that are carried out by a task. The commands come at points of the motion, and motion begins when the text for it is
//! there, so that the set points do not depend on who runs when.
use super::run::{Failure, Outcome, Watch};
use glidepath::channel::{Channel, Error, Handles, Planner, Progress};
use glidepath::digest::Digest;
use glidepath::machine::{ChannelData, MachineData, Synch, SynchTable};
use glidepath::nc::{Feeder, Stream, Window};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::technology::Function;
use glidepath::tick::State;

/// The program.
pub const TASKS: &[u8] = include_bytes!("../../../boards/tasks/tasks.nc");

/// Behind each part of the program: ASCII's end of text. The window takes a part when it is whole.
pub const END_OF_PART: u8 = 3;

/// Where the second part begins, and the line at which the motion stands when it is sent.
pub const SECOND_PART: &[u8] = b"N90";
const SENT_AT: u32 = 80;

/// Bytes of the window; a part has at most half of them.
const WINDOW: usize = 512;

/// Functions of the program.
const FUNCTIONS: u32 = 4;

/// How the program arrives.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Bytes per tick.
    pub bytes: usize,
    /// Ticks from N80 to the first byte of the second part.
    pub late: u32,
}

impl Line {
    /// 115,200 baud at 1 ms.
    pub const SERIAL: Self = Self { bytes: 11, late: 300 };
}

/// Ticks that M26 takes, and that the motion stands in the hold.
const CARRIED_OUT: u32 = 50;
const HELD: u32 = 100;

/// Longer than it takes.
const LIMIT: u32 = 100_000;

/// [`super::AXES_3`], and the motion waits for M26.
pub const TASKS_MACHINE: MachineData<3> = MachineData {
    channel: ChannelData { m_synch: SynchTable::NONE.with(26, Synch::MvsSvs), ..super::AXES_3.channel },
    ..super::AXES_3
};

/// Who presses buttons.
#[derive(Default)]
struct Panel {
    step: u8,
    rested: u32,
}

impl Panel {
    fn look(&mut self, operator: &Operator<'_, 3>) {
        let status = operator.status();
        match self.step {
            0 if status.n == 40 => operator.set_override(500),
            1 if status.n == 60 => operator.feed_hold(),
            2 if status.state == State::Idle => {
                self.rested += 1;
                if self.rested < HELD {
                    return;
                }
                operator.set_override(1000);
                operator.resume();
            }
            _ => return,
        }
        self.step += 1;
    }
}

/// Who carries functions out.
#[derive(Default)]
struct Functions {
    seen: u32,
    at_hand: Option<(Function, u32)>,
}

impl Functions {
    fn look(&mut self, operator: &Operator<'_, 3>, sender: &mut Sender) -> Result<(), Failure> {
        while let Some(output) = operator.output() {
            self.seen += 1;
            sender.hears_of(output.n);
            if output.waits {
                self.at_hand = Some((output.function, CARRIED_OUT));
            }
        }
        let Some((function, left)) = self.at_hand else { return Ok(()) };
        if left == CARRIED_OUT && !sender.take_part() {
            return Ok(());
        }
        self.at_hand = (left > 0).then_some((function, left.saturating_sub(1)));
        if left == 0 && operator.acknowledge(function).is_err() {
            return Err(Failure::Session("the motion waits for M26"));
        }
        Ok(())
    }
}

/// Who sends the program, in two parts.
struct Sender {
    line: Line,
    parts: [&'static [u8]; 2],
    /// Bytes of the part at hand that have arrived.
    arrived: usize,
    /// Parts asked for, arrived, and taken by M26.
    wanted: usize,
    whole: usize,
    taken: usize,
}

impl Sender {
    fn new(line: Line) -> Self {
        let second = TASKS.windows(SECOND_PART.len()).position(|word| word == SECOND_PART);
        let (first, second) = TASKS.split_at_checked(second.unwrap_or(0)).unwrap_or_default();
        Self { line, parts: [first, second], arrived: 0, wanted: 1, whole: 0, taken: 0 }
    }

    fn hears_of(&mut self, n: u32) {
        if n == SENT_AT {
            self.wanted = 2;
        }
    }

    fn take_part(&mut self) -> bool {
        let is_there = self.whole > self.taken;
        self.taken += usize::from(is_there);
        is_there
    }

    fn send(&mut self, feeder: &mut Feeder<'_, WINDOW>) {
        let Some(part) = self.parts.get(self.whole).filter(|_| self.whole < self.wanted) else { return };
        if self.whole == 1 && self.line.late > 0 {
            self.line.late -= 1;
            return;
        }
        self.arrived += self.line.bytes;
        if self.arrived >= part.len() && feeder.push(part) == part.len() {
            self.arrived = 0;
            self.whole += 1;
        }
    }
}

/// Runs the program as the examples do.
///
/// # Errors
/// What did not happen as it should.
pub fn tasks<const BLOCKS: usize>(
    channel: &mut Channel<3, BLOCKS>,
    window: &mut Window<WINDOW>,
    line: Line,
    watch: &mut impl Watch<3>,
) -> Result<Outcome, Failure> {
    let (mut feeder, stream) = window.split();
    let handles = channel.split(&TASKS_MACHINE, [Position::ZERO; 3], stream).map_err(Failure::Machine)?;
    let Handles { mut planner, mut interpolator, operator } = handles;
    let mut outcome = Outcome { ticks: 0, starved: 0, blocks: 0, digest: Digest::new() };
    let (mut panel, mut functions, mut sender) = (Panel::default(), Functions::default(), Sender::new(line));
    for _ in 0..LIMIT {
        sender.send(&mut feeder);
        functions.look(&operator, &mut sender)?;
        panel.look(&operator);
        let done = plan(&mut planner, &mut outcome).map_err(Failure::Program)?;
        let state = interpolator.tick();
        if state == State::Active {
            outcome.ticks += 1;
            outcome.digest.add(interpolator.set_points());
            watch.ticked(0, interpolator.set_points());
        } else if done {
            let is_whole = functions.seen == FUNCTIONS && panel.step == 3;
            return if is_whole { Ok(outcome) } else { Err(Failure::Session("hold and functions")) };
        }
    }
    Err(Failure::Endless)
}

/// Plans until the queue is full; whether the program has ended.
fn plan<const BLOCKS: usize>(
    planner: &mut Planner<'_, Stream<'_, WINDOW>, 3, BLOCKS>,
    outcome: &mut Outcome,
) -> Result<bool, Error> {
    loop {
        match planner.poll()? {
            Progress::Waiting => return Ok(false),
            Progress::Done => return Ok(true),
            Progress::Planned => outcome.blocks += planner.planned().blocks,
            _ => {}
        }
    }
}
