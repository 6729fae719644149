//! What the examples of RTIC, Embassy, FreeRTOS and C do, in one loop: text over a line, an operator's panel, functions
//! that are carried out by a task. The commands come at points of the motion, so that the set points do not depend
//! on who runs when.
use super::run::{Failure, Outcome, Watch};
use glidepath::channel::{Channel, Error, Handles, Planner, Progress};
use glidepath::digest::Digest;
use glidepath::machine::{ChannelData, MachineData, Synch, SynchTable};
use glidepath::nc::{Stream, Window};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::technology::Function;
use glidepath::tick::State;

/// The program.
pub const TASKS: &[u8] = include_bytes!("../../../boards/tasks/tasks.nc");

/// Bytes of the window, and those that arrive in a tick: 115,200 baud at 1 ms.
const WINDOW: usize = 256;
const BYTES: usize = 11;

/// Functions of the program.
const FUNCTIONS: u32 = 3;

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
    fn look(&mut self, operator: &Operator<'_, 3>) -> Result<(), Failure> {
        while let Some(output) = operator.output() {
            self.seen += 1;
            if output.waits {
                self.at_hand = Some((output.function, CARRIED_OUT));
            }
        }
        let Some((function, left)) = self.at_hand else { return Ok(()) };
        self.at_hand = (left > 0).then_some((function, left.saturating_sub(1)));
        if left == 0 && operator.acknowledge(function).is_err() {
            return Err(Failure::Session("the motion waits for M26"));
        }
        Ok(())
    }
}

/// Runs the program as the examples do.
///
/// # Errors
/// What did not happen as it should.
pub fn tasks<const BLOCKS: usize>(
    channel: &mut Channel<3, BLOCKS>,
    window: &mut Window<WINDOW>,
    watch: &mut impl Watch<3>,
) -> Result<Outcome, Failure> {
    let (mut feeder, stream) = window.split();
    let handles = channel.split(&TASKS_MACHINE, [Position::ZERO; 3], stream).map_err(Failure::Machine)?;
    let Handles { mut planner, mut interpolator, operator } = handles;
    let mut outcome = Outcome { ticks: 0, starved: 0, blocks: 0, digest: Digest::new() };
    let (mut panel, mut functions, mut rest) = (Panel::default(), Functions::default(), TASKS);
    for _ in 0..LIMIT {
        let sent = feeder.push(rest.get(..BYTES).unwrap_or(rest));
        rest = rest.get(sent..).unwrap_or_default();
        functions.look(&operator)?;
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
