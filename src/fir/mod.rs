//! FIR filters of the axes. They smooth the set points between the path and the drives.
//!
//! A channel with filters is made by [`Channel::split_filtered`](crate::channel::Channel::split_filtered),
//! with memory for the samples:
//!
//! ```
//! use glidepath::fir::Filters;
//! use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, FilterData, FilterType, MachineData};
//! use glidepath::{Channel, Handles, Position, Progress, State};
//!
//! let filter = FilterData { enable: true, kind: FilterType::Average, order: 8, ..FilterData::NONE };
//! let x = AxisData { filter, ..AxisData::new(AxisName::new("X").unwrap(), AxisKind::Linear) };
//! let machine = MachineData { axes: [x], channel: ChannelData { slope_profile: 1, ..ChannelData::new() } };
//! let program: &[u8] = b"G01 X5 F600\nM30\n";
//! let (mut memory, mut filters) = (Channel::<1, 120>::new(), Filters::<1, 32>::new());
//! let handles = memory.split_filtered(&mut filters, &machine, [Position::ZERO], program).unwrap();
//! let Handles { mut planner, mut interpolator, .. } = handles;
//! while planner.poll().unwrap() != Progress::Done {
//!     interpolator.tick();
//! }
//! while interpolator.tick() != State::Idle {} // Settling: the filter empties
//! assert_eq!(interpolator.set_points()[0], Position::from_num(5));
//! ```
//!
//! | file | what it holds |
//! |---|---|
//! | `design` | type, order and shape of each axis's filter, from machine data and `#FILTER` |
//! | `kernel` | taps: symmetric integers whose sum is one |
//! | `shape` | the deviation that the taps cause, and the limits for the plan |
//! | `bank` | in the planner: `#FILTER`, and the change of coefficients at a stop |
//! | `step` | in the interrupt: one set point per axis and tick |
//! | `samples` | memory of the last ticks of an axis |
//! | `mean`, `taps` | the output of one tick |
//!
//! **Delay.** A filter of order N has N + 1 symmetric taps and a delay of N/2 cycles. A pure time delay of
//! order N delays by N cycles. All axes get the longest delay of any axis, so the path keeps its shape. After
//! the last motion, the axes reach the exact end of the path within the length of the filter.
//!
//! **Memory.** [`Filters`] is static memory of `TAPS` samples per axis. `TAPS` is even, and the highest order
//! is `TAPS` − 1. Each tap takes 10 bytes per axis: 8 for the sample and 2 for the coefficient. A channel
//! without filters uses [`Unfiltered`], which takes neither memory nor instructions.
//!
//! **Rounding.** The remainder of each rounding is added to the next set point. So the error of a set point
//! is less than one LSB (2^-32 mm), and the error of its third difference is less than 8 LSB. The planner
//! reserves this part of the jerk limit.
mod bank;
mod design;
mod kernel;
mod mean;
mod samples;
mod shape;
mod step;
mod taps;

pub use bank::{Bank, Fate};
pub use design::FilterError;
pub use shape::Watch;
pub(crate) use shape::{CLOSE, GOING_ON, SHORT};
pub use step::Filtered;
pub(crate) use taps::REACH;

use crate::machine::MachineData;
use crate::nc;
use crate::quantity::Position;
use crate::queue::Lag;
use bank::Settings;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use step::State;

/// Sum of the taps of an axis: a gain of 1, LSB 2^-15.
pub const ONE: i32 = 1 << 15;

/// Highest order of a filter (P-AXIS-00587).
pub const MAX_ORDER: u32 = 200;
/// Highest order of a time delay (type 4): the delay in ticks.
pub const MAX_DELAY: u32 = 100;

/// The interrupt's handle of the filters. Each tick calls [`Self::step`] or [`Self::rest`], after the path.
pub trait FilterTick<const AXES: usize> {
    /// Filters the set points `points` of one tick. `distance`: path distance, LSB 2^-44 mm. `beside`:
    /// whether a single axis moves independently of the path.
    fn step(&mut self, points: &[Position; AXES], distance: i64, beside: bool);

    /// Filters a tick in which the unfiltered set points `path` stand still. Returns whether filtered set
    /// points may still move.
    fn rest(&mut self, path: &[Position; AXES]) -> bool;

    /// The filtered set points of the last tick, for the drives; mm or degrees.
    fn set_points<'b>(&'b self, path: &'b [Position; AXES]) -> &'b [Position; AXES];

    /// How much later M, H, S and T functions become due because of the filters, and whether the filters have
    /// settled. `None` without filters.
    fn lag(&mut self) -> Option<(&mut Lag, bool)>;
}

/// The planner's handle of the filters. Without filters, no call has an effect.
pub trait FilterPlan<const AXES: usize> {
    /// Whether the channel has filters.
    const EXIST: bool;

    /// Takes a `#FILTER` command. The new filters are in force when [`Self::work`] has done all steps of the
    /// change.
    ///
    /// # Errors
    /// The command cannot be carried out; nothing changes.
    fn command(&mut self, command: &nc::Filter) -> Result<Fate, FilterError>;

    /// Returns to the filters of the machine data, as at program start.
    fn restart(&mut self);

    /// Drops the last command, if its filters are not in force yet. Used after an abort.
    fn cancel(&mut self);

    /// Prepares for a change of position without motion: the filters are off until [`Self::work`] is done.
    /// Call this function only while the filters are settled.
    fn suspend(&mut self);

    /// Whether a change of coefficients is in progress.
    fn is_pending(&self) -> bool;

    /// Whether the axes stand still at the end of the path. Call this function only while the path stands
    /// still.
    fn is_settled(&self) -> bool;

    /// Does a bounded step of the change of coefficients. Call this function only while the filters are
    /// settled. Returns `false` if a tick must pass first.
    fn work(&mut self) -> bool;

    /// Cycles from the last motion of the path until the axes stand still.
    fn window(&self) -> u32;

    /// Limits for the plan, because of the filter of this axis; `None` if the axis has no filter.
    fn watch(&self, axis: usize) -> Option<Watch>;

    /// The part of AX_DEV (0 to 1) that is left for a step of speed of the axis. Before and after the step,
    /// the acceleration changes with at most `jerk` (mm/tick³).
    fn corner(&self, axis: usize, jerk: f32) -> f32;

    /// Delay of all axes in half cycles, and AX_DEV in mm, both as in force; 0 if there is none.
    fn in_force(&self) -> (u32, Position);

    /// Index of the first axis that has exceeded AX_DEV since the last change of the filters. After each
    /// change, the call returns an axis at most once.
    fn beyond(&mut self) -> Option<usize>;

    /// Largest distance between the filtered set point of an axis and the unfiltered set point with the same
    /// delay, mm or degrees. The distance is measured since the last change of the filters, and only while
    /// AX_DEV is given.
    fn deviation(&self, axis: usize) -> Position;
}

/// The filters of a channel that has none: set points stay as they are.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unfiltered;

impl<const AXES: usize> FilterTick<AXES> for Unfiltered {
    #[inline(always)]
    fn step(&mut self, _: &[Position; AXES], _: i64, _: bool) {}

    #[inline(always)]
    fn rest(&mut self, _: &[Position; AXES]) -> bool {
        false
    }

    #[inline(always)]
    fn set_points<'b>(&'b self, path: &'b [Position; AXES]) -> &'b [Position; AXES] {
        path
    }

    #[inline(always)]
    fn lag(&mut self) -> Option<(&mut Lag, bool)> {
        None
    }
}

impl<const AXES: usize> FilterPlan<AXES> for Unfiltered {
    const EXIST: bool = false;

    fn command(&mut self, _: &nc::Filter) -> Result<Fate, FilterError> {
        Err(FilterError::NoMemory)
    }

    fn restart(&mut self) {}

    fn cancel(&mut self) {}

    fn suspend(&mut self) {}

    fn is_pending(&self) -> bool {
        false
    }

    fn is_settled(&self) -> bool {
        true
    }

    fn work(&mut self) -> bool {
        true
    }

    fn window(&self) -> u32 {
        0
    }

    fn watch(&self, _: usize) -> Option<Watch> {
        None
    }

    fn corner(&self, _: usize, _: f32) -> f32 {
        1.0
    }

    fn in_force(&self) -> (u32, Position) {
        (0, Position::ZERO)
    }

    fn beyond(&mut self) -> Option<usize> {
        None
    }

    fn deviation(&self, _: usize) -> Position {
        Position::ZERO
    }
}

/// Memory of the filters of a channel with `AXES` axes, up to the order `TAPS` − 1; `TAPS` is even. All bits are zero
/// when new, so a static value lies in `.bss`.
pub struct Filters<const AXES: usize, const TAPS: usize> {
    words: Words<AXES, TAPS>,
    state: State<AXES, TAPS>,
}

impl<const AXES: usize, const TAPS: usize> Filters<AXES, TAPS> {
    /// Memory with all filters off.
    pub const fn new() -> Self {
        Self { words: Words::new(), state: State::new() }
    }

    /// Checks that the memory suffices for the filters that machine data enable. A loader uses this check to
    /// report faults before anything starts.
    ///
    /// # Errors
    /// As [`Self::split`].
    pub fn check(machine: &MachineData<AXES>) -> Result<(), FilterError> {
        Settings::new(machine).check::<TAPS>(&nc::Filter::default())
    }

    /// Returns the planner's handle and the interrupt's handle of the filters that machine data enable. The
    /// axes are at `start`.
    ///
    /// # Errors
    /// The memory is too small for the machine data.
    pub fn split(
        &mut self,
        machine: &MachineData<AXES>,
        start: &[Position; AXES],
    ) -> Result<(Bank<'_, AXES, TAPS>, Filtered<'_, AXES, TAPS>), FilterError> {
        *self = Self::new();
        let Self { words, state } = self;
        let words = &*words;
        let bank = Bank::new(words, Settings::new(machine))?;
        Ok((bank, Filtered::new(words, state, start)))
    }
}

impl<const AXES: usize, const TAPS: usize> Default for Filters<AXES, TAPS> {
    fn default() -> Self {
        Self::new()
    }
}

/// The kind of an axis' filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A delay by [`Layout::newest`], without a filter.
    #[default]
    Delay,
    /// Mean of the window.
    Mean,
    /// Symmetric taps.
    Taps,
}

/// The samples that the filter of an axis uses; ages are in ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Layout {
    pub kind: Kind,
    /// Age of the newest sample.
    pub newest: u32,
    /// Number of samples.
    pub length: u32,
}

/// Memory that planner and interrupt share. The planner writes its words one by one, while the path stands
/// still and the filters have settled. The interrupt writes `done` and `deviation` of each axis.
struct Words<const AXES: usize, const TAPS: usize> {
    axes: [AxisWords<TAPS>; AXES],
    /// Number of the planner's last change. The planner also writes the words that follow, down to `done`.
    asked: AtomicU32,
    /// Whether any axis is filtered or delayed.
    runs: AtomicU32,
    /// Longest delay, in half cycles, and length of the window.
    delay: AtomicU32,
    window: AtomicU32,
    /// AX_DEV, LSB 2^-22 mm ([`bank::COARSE`]); 0: not monitored.
    tolerance: AtomicU32,
    /// Words of the interrupt: number of the change in force; and 1 from the start of a motion until the
    /// filters have settled.
    done: AtomicU32,
    unsettled: AtomicU32,
}

struct AxisWords<const TAPS: usize> {
    kind: AtomicU32,
    newest: AtomicU32,
    length: AtomicU32,
    /// Two bytes for each pair of taps, the outermost pair first. A single centre tap is a pair of two
    /// halves.
    taps: [AtomicU8; TAPS],
    /// Word of the interrupt: largest deviation; LSB: see [`bank::COARSE`].
    deviation: AtomicU32,
}

impl<const AXES: usize, const TAPS: usize> Words<AXES, TAPS> {
    const fn new() -> Self {
        let [asked, runs, delay, window, tolerance, done, unsettled] = [const { AtomicU32::new(0) }; 7];
        Self {
            axes: [const { AxisWords::new() }; AXES],
            asked,
            runs,
            delay,
            window,
            tolerance,
            done,
            unsettled,
        }
    }
}

impl<const TAPS: usize> AxisWords<TAPS> {
    const fn new() -> Self {
        let [kind, newest, length, deviation] = [const { AtomicU32::new(0) }; 4];
        Self { kind, newest, length, taps: [const { AtomicU8::new(0) }; TAPS], deviation }
    }

    /// One tap of each pair, from the outside to the centre.
    fn pairs(&self) -> impl Iterator<Item = i32> {
        let bytes = self.taps.as_chunks::<2>().0.iter();
        let tap = |bytes: &[AtomicU8; 2]| {
            i16::from_ne_bytes(bytes.each_ref().map(|byte| byte.load(Ordering::Relaxed)))
        };
        bytes.map(move |bytes| tap(bytes).into())
    }

    fn set_pair(&self, number: usize, tap: i32) {
        if let Some(bytes) = self.taps.as_chunks::<2>().0.get(number) {
            for (byte, value) in bytes.iter().zip((tap as i16).to_ne_bytes()) {
                byte.store(value, Ordering::Relaxed);
            }
        }
    }

    fn set_layout(&self, layout: &Layout) {
        self.kind.store(layout.kind as u32, Ordering::Relaxed);
        self.newest.store(layout.newest, Ordering::Relaxed);
        self.length.store(layout.length, Ordering::Relaxed);
    }

    fn layout(&self) -> Layout {
        let [kind, newest, length] =
            [&self.kind, &self.newest, &self.length].map(|word| word.load(Ordering::Relaxed));
        let kind = match kind {
            0 => Kind::Delay,
            1 => Kind::Mean,
            _ => Kind::Taps,
        };
        Layout { kind, newest, length }
    }
}
