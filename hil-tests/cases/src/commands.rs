//! Programs with an operator who gives commands all the time: what a call of the planner costs that carries
//! one out.
//!
//! How many schedules there are is said when this is built: `COMMAND_SEEDS=100 cargo xtask hil --commands` is the long
//! search.
use super::Case;
use super::run::{Failure, Outcome, Watch, drive_with};
use glidepath::channel::Channel;
use glidepath::machine::MachineData;
use glidepath::operator::Operator;
use glidepath::quantity::Position;

/// Ticks from one command to the next of the even schedule: no multiple of what programs repeat.
const EVERY: u32 = 37;

/// Ticks from one command to the next of a random schedule, at most.
const APART: u32 = 50;

/// Random schedules of each case.
pub const SEEDS: u32 = match option_env!("COMMAND_SEEDS") {
    Some(text) => number(text.as_bytes()),
    None => 4,
};

const fn number(digits: &[u8]) -> u32 {
    let (mut value, mut k) = (0, 0);
    while k < digits.len() {
        value = 10 * value + (digits[k] - b'0') as u32;
        k += 1;
    }
    value
}

/// No command comes later, ticks.
const UNTIL: u32 = 6000;

/// When which command comes.
struct Schedule {
    /// 0: evenly, each command in turn.
    seed: u32,
    drawn: u32,
    next: u32,
}

impl Schedule {
    const fn new(seed: u32) -> Self {
        Self { seed, drawn: seed.wrapping_mul(0x9e37_79b9) | 1, next: 1 }
    }

    /// Evenly below `of`: Marsaglia's xorshift, 2003.
    const fn draw(&mut self, of: u32) -> u32 {
        self.drawn ^= self.drawn << 13;
        self.drawn ^= self.drawn >> 17;
        self.drawn ^= self.drawn << 5;
        self.drawn % of
    }

    fn act<const AXES: usize>(&mut self, operator: &Operator<'_, AXES>, tick: u32) {
        let is_over = tick >= UNTIL;
        if self.seed == 0 || is_over {
            if tick.is_multiple_of(EVERY) {
                give(operator, if is_over { 8 } else { tick / EVERY % 8 });
            }
        } else if tick >= self.next {
            self.next = tick + 1 + self.draw(APART);
            match self.draw(9) {
                8 => operator.set_override(10 + self.draw(1491) as u16),
                which => give(operator, which),
            }
        }
    }
}

/// Runs a case as [`super::run()`] does, with an operator who gives commands: override, feed hold, reduced speed. With the
/// seed 0 one comes every 37 ticks, each in turn; with another one a random one 1 to 50 ticks behind the one before.
///
/// # Errors
/// The case was refused or does not end.
pub fn commanded<const AXES: usize, const BLOCKS: usize, W: Watch<AXES>>(
    channel: &mut Channel<AXES, BLOCKS>,
    machine: &MachineData<AXES>,
    case: &Case,
    seed: u32,
    watch: &mut W,
) -> Result<Outcome, Failure> {
    let start = [Position::ZERO; AXES];
    let mut handles = channel.split(machine, start, case.text).map_err(Failure::Machine)?;
    let mut schedule = Schedule::new(seed);
    let outcome = drive_with(&mut handles, watch, |operator, tick| schedule.act(operator, tick))?;
    // In a feed hold nothing is to be done.
    Ok(Outcome { starved: 0, ..outcome })
}

fn give<const AXES: usize>(operator: &Operator<'_, AXES>, which: u32) {
    match which {
        0 => operator.set_override(700),
        1 => operator.set_override(1500),
        2 => operator.feed_hold(),
        3 => operator.resume(),
        4 => operator.set_reduced(true),
        5 => operator.set_reduced(false),
        6 => operator.set_override(50),
        7 => operator.set_override(1000),
        _ => {
            operator.resume();
            operator.set_reduced(false);
            operator.set_override(1000);
        }
    }
}
