//! The memory of a channel, and the handles that `split` makes from it: planner, interpolator and operator.
use super::beside::Beside;
use super::check::check;
use super::{MachineError, Planner, Source};
use crate::fir::{Bank, FilterError, FilterPlan, FilterTick, Filtered, Filters, Unfiltered};
use crate::machine::{MachineData, functions};
use crate::nc::{Decoder, DecoderMemory, Text};
use crate::operator::Operator;
use crate::path::Measure;
use crate::plan::{Planning, PlanningMemory};
use crate::quantity::Position;
use crate::queue::{Overlay, Rings, overlay_ends};
use crate::single::Single;
use crate::tick::Interpolator;
use core::mem::MaybeUninit;

/// All memory of planner, interpolator and operator.
///
/// | parameter | meaning |
/// |---|---|
/// | `AXES` | number of axes |
/// | `BLOCKS` | largest look-ahead, in blocks; at least [`look_ahead`](crate::ChannelData::look_ahead); bytes per block: `docs/memory.md` |
/// | `OVERLAYS` | axes that may move independently of the path at the same time (oscillation, jog); about 3.5 KB each |
///
/// A new channel is all zero. In a `static` the channel lies in `.bss`: it takes RAM and no flash. [`Self::split`]
/// makes the handles. The planner handle has less than two kilobytes, each other handle less than 200 bytes.
pub struct Channel<const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize = 0> {
    rings: Rings<AXES, BLOCKS>,
    decoder: DecoderMemory<AXES>,
    planning: PlanningMemory<AXES, BLOCKS>,
    overlays: [Overlay; OVERLAYS],
    singles: MaybeUninit<[Single; OVERLAYS]>,
}

/// The three handles of a channel. Each handle belongs to one task or interrupt; all are `Send`.
pub struct Handles<
    'a,
    T: Text,
    const AXES: usize,
    const BLOCKS: usize,
    P = Unfiltered,
    I = Unfiltered,
    const OVERLAYS: usize = 0,
> {
    /// Handle for the main loop, a task or a low-priority interrupt.
    pub planner: Planner<'a, T, AXES, BLOCKS, P, OVERLAYS>,
    /// Handle for the timer interrupt. That interrupt has a higher priority than the planner, or runs on
    /// another core.
    pub interpolator: Interpolator<'a, AXES, I, OVERLAYS>,
    /// Handle for the task that gives commands and carries out functions: a PLC task, a serial task, or
    /// another core.
    pub operator: Operator<'a, AXES>,
}

/// The handles of a channel with filters of an order up to `TAPS` − 1.
pub type FilteredHandles<
    'a,
    T,
    const AXES: usize,
    const BLOCKS: usize,
    const TAPS: usize,
    const OVERLAYS: usize = 0,
> = Handles<'a, T, AXES, BLOCKS, Bank<'a, AXES, TAPS>, Filtered<'a, AXES, TAPS>, OVERLAYS>;

/// The handles of a channel without filters.
pub type PlainHandles<'a, T, const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> =
    Handles<'a, T, AXES, BLOCKS, Unfiltered, Unfiltered, OVERLAYS>;

impl<const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> Channel<AXES, BLOCKS, OVERLAYS> {
    /// An empty channel.
    pub const fn new() -> Self {
        Self {
            rings: Rings::new(),
            decoder: DecoderMemory::new(),
            planning: PlanningMemory::new(),
            overlays: [const { Overlay::new() }; OVERLAYS],
            singles: MaybeUninit::uninit(),
        }
    }

    /// Checks machine data before anything starts. [`Self::split`] and [`Self::split_filtered`] check the filters,
    /// because they know the memory for filters.
    ///
    /// # Errors
    /// Machine data are out of range, or this build cannot work with them.
    pub fn check(machine: &MachineData<AXES>) -> Result<(), MachineError> {
        check::<AXES, BLOCKS>(machine)
    }

    /// Makes the three handles. The planner reads the program `text` and uses the machine data `machine`; the
    /// axes are at `start` (mm or degrees). The machine data are not copied, so constant data stay in flash.
    ///
    /// # Errors
    /// Machine data are out of range, or this build cannot work with them.
    pub fn split<'a, T: Text>(
        &'a mut self,
        machine: &'a MachineData<AXES>,
        start: [Position; AXES],
        text: T,
    ) -> Result<PlainHandles<'a, T, AXES, BLOCKS, OVERLAYS>, MachineError> {
        check::<AXES, BLOCKS>(machine)?;
        if let Some(axis) = machine.axes.iter().position(|axis| axis.filter.enable) {
            return Err(MachineError::Filter(axis, FilterError::NoMemory));
        }
        Ok(self.handles(machine, start, text, (Unfiltered, Unfiltered)))
    }

    /// Makes the three handles as [`Self::split`] does, with filters of the axes ([`crate::fir`]) in the
    /// memory `filters`.
    ///
    /// # Errors
    /// As [`Self::split`], or a filter of the machine data needs more memory than `filters` has.
    pub fn split_filtered<'a, T: Text, const TAPS: usize>(
        &'a mut self,
        filters: &'a mut Filters<AXES, TAPS>,
        machine: &'a MachineData<AXES>,
        start: [Position; AXES],
        text: T,
    ) -> Result<FilteredHandles<'a, T, AXES, BLOCKS, TAPS, OVERLAYS>, MachineError> {
        check::<AXES, BLOCKS>(machine)?;
        functions::FILTERS.check().map_err(MachineError::NotBuilt)?;
        let ends = filters.split(machine, &start);
        let ends = ends.map_err(|error| MachineError::Filter(error.axis().unwrap_or(0), error))?;
        let mut handles = self.handles(machine, start, text, ends);
        handles.planner.watch_filters();
        Ok(handles)
    }

    /// A separate function, so that the handles are made in the caller's memory.
    #[inline(never)]
    fn handles<'a, T: Text, P: FilterPlan<AXES>, I: FilterTick<AXES>>(
        &'a mut self,
        machine: &'a MachineData<AXES>,
        start: [Position; AXES],
        text: T,
        (filters, filtered): (P, I),
    ) -> Handles<'a, T, AXES, BLOCKS, P, I, OVERLAYS> {
        let Self { rings, decoder, planning, overlays, singles } = self;
        let (sender, receiver, panel) = rings.split();
        let (to_overlays, overlays) = overlay_ends(overlays);
        let interpolator = Interpolator::with_overlays(receiver, start, filtered, overlays);
        let operator = Operator::new(panel, Measure::of(machine));
        // The planner comes last, so that this large value is made in its final place.
        Handles {
            planner: Planner {
                decoder: Decoder::of_machine(decoder, machine, start, text),
                planning: Planning::new(planning, machine, start, sender),
                cycle_us: machine.channel.cycle_us,
                ptp: machine.channel.ptp,
                surface: machine.channel.surface,
                source: Source::Open,
                held: None,
                released: 0,
                lost: false,
                filters,
                #[cfg(feature = "plc")]
                loops: super::repeat::Loops::NONE,
                beside: Beside::new(singles.write([Single::NONE; OVERLAYS]), to_overlays, &machine.channel),
                #[cfg(feature = "examine")]
                seen: None,
                #[cfg(feature = "examine")]
                watches: false,
            },
            interpolator,
            operator,
        }
    }

    /// Makes only a decoder, in the memory of this channel, to check `text` before a run.
    pub fn decode<'a, T: Text>(
        &'a mut self,
        machine: &MachineData<AXES>,
        start: [Position; AXES],
        text: T,
    ) -> Decoder<'a, T, AXES> {
        Decoder::of_machine(&mut self.decoder, machine, start, text)
    }
}

impl<const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> Default
    for Channel<AXES, BLOCKS, OVERLAYS>
{
    fn default() -> Self {
        Self::new()
    }
}
