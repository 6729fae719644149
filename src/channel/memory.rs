//! The memory of a channel, and what is made in it.
use super::check::check;
use super::{MachineError, Planner, Source};
use crate::machine::MachineData;
use crate::nc::{Decoder, DecoderMemory, Setup, Text};
use crate::operator::Operator;
use crate::plan::{Planning, PlanningMemory};
use crate::quantity::Position;
use crate::queue::Rings;
use crate::tick::Interpolator;

/// All memory of planner, interrupt and operator, for `AXES` axes. `BLOCKS` is the look-ahead of its planner.
///
/// All bits are zero when new, so that a static one lies in `.bss`. [`Self::split`] makes the handles in it:
/// what they are beside that are some hundred bytes.
pub struct Channel<const AXES: usize, const BLOCKS: usize> {
    rings: Rings<AXES, BLOCKS>,
    decoder: DecoderMemory<AXES>,
    planning: PlanningMemory<AXES, BLOCKS>,
}

/// The handles of a channel. Each belongs to one context; all are `Send`.
pub struct Handles<'a, T: Text, const AXES: usize, const BLOCKS: usize> {
    /// Where time is not critical: a main loop, a task, a low-priority interrupt.
    pub planner: Planner<'a, T, AXES, BLOCKS>,
    /// The timer interrupt: of higher priority than the planner, or on another core.
    pub interpolator: Interpolator<'a, AXES>,
    /// Whoever gives commands and carries out functions: a PLC task, a serial task, another core.
    pub operator: Operator<'a, AXES>,
}

impl<const AXES: usize, const BLOCKS: usize> Channel<AXES, BLOCKS> {
    /// An empty channel.
    pub const fn new() -> Self {
        Self { rings: Rings::new(), decoder: DecoderMemory::new(), planning: PlanningMemory::new() }
    }

    /// The three handles: `text` will be decoded and planned for `machine`, which stands at `start`.
    ///
    /// # Errors
    /// Machine data out of range, or that this version cannot work with.
    pub fn split<'a, T: Text>(
        &'a mut self,
        machine: &MachineData<AXES>,
        start: [Position; AXES],
        text: T,
    ) -> Result<Handles<'a, T, AXES, BLOCKS>, MachineError> {
        check::<AXES, BLOCKS>(machine)?;
        let Self { rings, decoder, planning } = self;
        let (sender, receiver, panel) = rings.split();
        let (interpolator, operator) = (Interpolator::new(receiver, start), Operator::new(panel));
        // Last, so that it is made where it stays: it is large.
        Ok(Handles {
            planner: Planner {
                decoder: Decoder::new(decoder, Setup::new(machine, start), text),
                planning: Planning::new(planning, machine, start, sender),
                cycle_us: machine.channel.cycle_us,
                ptp: machine.channel.ptp,
                surface: machine.channel.surface,
                source: Source::Open,
                held: None,
                released: 0,
                lost: false,
            },
            interpolator,
            operator,
        })
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
