//! Refusals of a channel for an NC text.
use glidepath::channel::{Channel, Error, Handles, Progress};
use glidepath::machine::MachineData;
use glidepath::quantity::Position;

/// Number of planner calls after which a text has ended.
const MOST_CALLS: usize = 1_000_000;

/// Reason for which a text, from zero on, is refused, if it is refused.
pub fn refusal<const AXES: usize>(text: &str, machine: &MachineData<AXES>) -> Option<Error> {
    let mut channel: Box<Channel<AXES, 120>> = Box::new(Channel::new());
    let Handles { mut planner, mut interpolator, .. }: Handles<'_, &[u8], AXES, 120> =
        channel.split(machine, [Position::ZERO; AXES], text.as_bytes()).expect("machine data");
    for _ in 0..MOST_CALLS {
        match planner.poll() {
            Ok(Progress::Done) => return None,
            Ok(_) => _ = interpolator.tick(),
            Err(error) => return Some(error),
        }
    }
    panic!("no end: {text}");
}

/// The same for a text that must be refused.
pub fn refused<const AXES: usize>(text: &str, machine: &MachineData<AXES>) -> Error {
    refusal(text, machine).unwrap_or_else(|| panic!("{text} is accepted"))
}
