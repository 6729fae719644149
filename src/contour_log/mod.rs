//! A log that shows a PLC the elements of the path before the axes reach them (feature `plc`).
//!
//! The planner writes an entry for each curve that enters the look-ahead. Any thread, interrupt or core may
//! read the entries. Neither side waits for the other.
//!
//! | file | content |
//! |---|---|
//! | `entry` | an element or a mark of the log, in 44 bytes |
//! | `table` | tables of entries, each with one writer and any number of readers |
//! | `geometry` | radius and angle of a curve, and its change of direction from the curve before |
//! | `recorder` | the planner's handle: which entry goes into which table |
//! | `reader` | the PLC's handle: [`ContourReader::elements`], [`ContourReader::logged`], [`ContourReader::reach`] |
//! | `question` | questions about the coming motion, and their answers |
//! | `limits` | limits of axis positions that the PLC moves |
//! | `hli` | the structures of ISG's interface to a PLC, under ISG's names |
//! | `unit` | request and response, as in ISG's control unit `contour_lookahead` |
//!
//! There are two tables. The *window* has the latest elements of the path. A PLC finds them by distance from
//! program start (ISG's mode 2). The *log* has the elements between the program's commands `#CONTOUR
//! LOOKAHEAD LOG ON` and `OFF`. A PLC finds them by index (ISG's mode 1).
mod entry;
mod geometry;
mod hli;
mod limits;
mod question;
mod reader;
mod recorder;
mod table;
mod unit;

pub use entry::{BlockType, Entry, ProgramDistance};
pub use hli::{
    HliContourLookaheadBlock, HliContourLookaheadRequest, HliContourLookaheadResponse,
    HliContourLookaheadState,
};
pub(crate) use limits::LimitsNow;
pub use limits::{LimitState, PositionLimits, Side};
pub use question::{Moment, Question, QuestionUnit, Unknown};
pub use reader::{ContourReader, Elements, Forgotten, LogState};
pub(crate) use recorder::Passed;
#[doc(hidden)]
pub use recorder::Turn;
pub use recorder::{Crowded, Recorder};
pub use unit::{ControlUnit, Pending, UnitState};

use table::{Head, Slot, Table};

/// Memory of the log: `WINDOW` elements by distance, and `LOG` entries by index. Each entry takes 44 bytes.
///
/// Both numbers are 0 or a power of two. All bits are zero when new, so a static memory lies in `.bss`.
pub struct ContourMemory<const WINDOW: usize, const LOG: usize> {
    window: (Head, [Slot; WINDOW]),
    log: (Head, [Slot; LOG]),
}

impl<const WINDOW: usize, const LOG: usize> ContourMemory<WINDOW, LOG> {
    /// Entries have 32-bit numbers that wrap around; a power of two divides 2^32.
    const EVEN: () = assert!(
        (WINDOW == 0 || WINDOW.is_power_of_two()) && (LOG == 0 || LOG.is_power_of_two()),
        "expected 0 or a power of two"
    );

    /// Empty memory.
    pub const fn new() -> Self {
        let () = Self::EVEN;
        Self {
            window: (Head::new(), [const { Slot::new() }; WINDOW]),
            log: (Head::new(), [const { Slot::new() }; LOG]),
        }
    }

    /// Empties the memory and returns the handles of planner and PLC. The recorder is for
    /// [`crate::Planner::log_contour`].
    pub fn split(&mut self) -> (Recorder<'_>, ContourReader<'_>) {
        // In place: an empty table needs no cleared slots, and a new memory would be on the stack.
        (self.window.0, self.log.0) = (Head::new(), Head::new());
        let window = Table::new(&self.window.0, &self.window.1);
        let log = Table::new(&self.log.0, &self.log.1);
        (Recorder::new(window, log), ContourReader::new(window, log))
    }
}

impl<const WINDOW: usize, const LOG: usize> Default for ContourMemory<WINDOW, LOG> {
    fn default() -> Self {
        Self::new()
    }
}
