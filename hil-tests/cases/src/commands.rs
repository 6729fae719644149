//! Programs with an operator who gives commands all the time: what a call of the planner costs that carries
//! one out.
use super::Case;
use super::run::{Failure, Outcome, Watch, drive_with};
use glidepath::channel::Channel;
use glidepath::machine::MachineData;
use glidepath::operator::Operator;
use glidepath::quantity::Position;

/// Ticks from one command to the next: no multiple of what programs repeat.
const EVERY: u32 = 37;

/// No command comes later, ticks.
const UNTIL: u32 = 6000;

/// Runs a case as [`super::run()`] does, with a command of the operator every 37 ticks: override, feed hold,
/// reduced speed, each in turn.
///
/// # Errors
/// The case was refused or does not end.
pub fn commanded<const AXES: usize, const BLOCKS: usize, W: Watch<AXES>>(
    channel: &mut Channel<AXES, BLOCKS>,
    machine: &MachineData<AXES>,
    case: &Case,
    watch: &mut W,
) -> Result<Outcome, Failure> {
    let start = [Position::ZERO; AXES];
    let mut handles = channel.split(machine, start, case.text).map_err(Failure::Machine)?;
    let outcome = drive_with(&mut handles, watch, |operator, tick| {
        if tick % EVERY == 0 {
            give(operator, if tick < UNTIL { tick / EVERY % 8 } else { 8 });
        }
    })?;
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
