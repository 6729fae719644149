//! ISG's control unit `contour_lookahead` (manual FCT-C40). Through this unit, a PLC requests entries of the
//! log, and a semaphore shows when the response is complete.
//!
//! | ISG's name | call |
//! |---|---|
//! | `semaphor_rw` | [`ControlUnit::request`] sets it, [`ControlUnit::serve`] clears it, [`ControlUnit::is_pending`] reads it |
//! | `request.start_position`, `request.length` | arguments of [`ControlUnit::request`] |
//! | `response.block[i]` | [`ControlUnit::response`] |
//! | `state` (HLI_CONTOUR_LOOKAHEAD_STATE) | [`ControlUnit::state`] |
//!
//! Distances are in 0.1 µm, as in ISG's interface. One task makes requests, and the planner's task serves
//! them; both may be the same task.
use super::entry::{BlockType, Entry, ProgramDistance};
use super::reader::ContourReader;
use super::table::Slot;
use core::sync::atomic::{AtomicU32, Ordering};

/// The error of a request while the previous request is not answered yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pending;

impl core::fmt::Display for Pending {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the last request is not answered yet; expected semaphor_rw FALSE")
    }
}

impl core::error::Error for Pending {}

/// The state of the log, as ISG's control unit `contour_lookahead` shows it to a PLC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitState {
    /// Distance at which the known path ends (max_dist_prog_start), 0.1 µm.
    pub max_dist_prog_start: f64,
    /// Number of entries in the log by index (mode 1).
    pub count_logged_blocks: u32,
    /// Whether the program has switched the log on and not off again.
    pub f_log_is_active: bool,
}

/// 0.1 µm per millimetre.
pub(super) const TENTHS: f64 = 10_000.0;

/// The control unit `contour_lookahead` with room for `BLOCKS` blocks in a response (usually 20).
///
/// All bits are zero when new.
pub struct ControlUnit<const BLOCKS: usize> {
    /// The semaphore: 1 is TRUE.
    semaphore: AtomicU32,
    /// start_position and length, as halves of their bits.
    request: [AtomicU32; 4],
    block: [Slot; BLOCKS],
}

impl<const BLOCKS: usize> ControlUnit<BLOCKS> {
    /// A unit without a request.
    pub const fn new() -> Self {
        Self {
            semaphore: AtomicU32::new(0),
            request: [const { AtomicU32::new(0) }; 4],
            block: [const { Slot::new() }; BLOCKS],
        }
    }

    /// Whether a request waits for its answer: `semaphor_rw`.
    pub fn is_pending(&self) -> bool {
        self.semaphore.load(Ordering::Acquire) != 0
    }

    /// Makes a request. Only the PLC calls this function. With `length` 0 (mode 1), `start_position` is the
    /// index of the first entry. With any other `length` (mode 2), the request is for elements in
    /// `start_position .. start_position + length`, 0.1 µm.
    ///
    /// # Errors
    /// The previous request is not answered yet; nothing has changed.
    pub fn request(&self, start_position: f64, length: f64) -> Result<(), Pending> {
        if self.is_pending() {
            return Err(Pending);
        }
        let halves =
            [start_position, length].map(f64::to_bits).map(|bits| [bits as u32, (bits >> 32) as u32]);
        let words = halves.iter().flatten();
        self.request.iter().zip(words).for_each(|(word, value)| word.store(*value, Ordering::Relaxed));
        self.semaphore.store(1, Ordering::Release);
        Ok(())
    }

    /// Answers the request, if there is one, and clears the semaphore. Only the task of the planner calls
    /// this function. Blocks without an element have type 0. If the first elements of mode 2 are no longer in
    /// the window, the answer begins with the remaining ones. Returns `true` if there was a request. The work
    /// is bounded: the call reads each entry at most once.
    #[allow(clippy::double_comparisons)]
    pub fn serve(&self, contour: &ContourReader<'_>) -> bool {
        if !self.is_pending() {
            return false;
        }
        let mut words = [0u32; 4];
        words.iter_mut().zip(&self.request).for_each(|(to, from)| *to = from.load(Ordering::Relaxed));
        let [s0, s1, l0, l1] = words.map(u64::from);
        let (start, length) = (f64::from_bits(s1 << 32 | s0), f64::from_bits(l1 << 32 | l0));
        // Both comparisons are false for NaN, which counts as mode 1 from the first entry.
        if length > 0.0 || length < 0.0 {
            let [from, to] = [start, start + length].map(|at| ProgramDistance::from_mm(at / TENTHS));
            let mut elements = contour.elements(from, to).filter_map(Result::ok);
            self.fill(|_| elements.next());
        } else {
            let first = start as u32;
            self.fill(|i| contour.logged(first.checked_add(i)?));
        }
        self.semaphore.store(0, Ordering::Release);
        true
    }

    fn fill(&self, mut next: impl FnMut(u32) -> Option<Entry>) {
        for (i, slot) in (0..).zip(&self.block) {
            slot.set(next(i).unwrap_or_default().to_words());
        }
    }

    /// Block `i` of the response. Returns `None` while the request is pending, or if there is no such block.
    /// Only the PLC calls this function.
    pub fn response(&self, i: usize) -> Option<Entry> {
        if self.is_pending() {
            return None;
        }
        self.block.get(i).map(|slot| Entry::of_words(slot.get()))
    }

    /// The blocks of the response, up to the first unused one.
    pub fn blocks(&self) -> impl Iterator<Item = Entry> {
        (0..BLOCKS).map_while(|i| self.response(i)).take_while(|entry| entry.block_type != BlockType::None)
    }

    /// The current state of the log, for the PLC.
    pub fn state(contour: &ContourReader<'_>) -> UnitState {
        let log = contour.log_state();
        UnitState {
            max_dist_prog_start: contour.reach().to_mm() * TENTHS,
            count_logged_blocks: log.entries,
            f_log_is_active: log.active,
        }
    }
}

impl<const BLOCKS: usize> Default for ControlUnit<BLOCKS> {
    fn default() -> Self {
        Self::new()
    }
}
