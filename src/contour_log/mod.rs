//! The contour known in advance, for a PLC: elements of the path before the axes reach them.
//!
//! The planner writes an entry for each curve that goes into the look-ahead. Any other context reads them: a thread,
//! an interrupt, another core. Nobody waits for anybody.
//!
//! | file | what is in it |
//! |---|---|
//! | `entry` | an element or a mark of the log, and its 48 bytes |
//! | `table` | rows of entries with one writer and any number of readers |
//! | `geometry` | length, radius, angle and knee of a curve |
//! | `recorder` | the planner's end: which entry goes into which table |
//! | `reader` | the PLC's end: [`ContourReader::elements`], [`ContourReader::logged`], [`ContourReader::reach`] |
//! | `question` | questions about what comes, and their answers |
//! | `unit` | request and response of the control unit, as in the texts of ISG |
//!
//! There are two tables. The *window* has the latest elements of the path, found by distance from program start
//! (mode 2). The *log* has the elements between `#CONTOUR LOOKAHEAD LOG ON` and `OFF`, found by index (mode 1).
mod entry;
mod geometry;
mod question;
mod reader;
mod recorder;
mod table;
mod unit;

pub use entry::{BlockType, Entry, ProgramDistance};
pub use question::{Moment, Question, QuestionUnit, Unknown};
pub use reader::{ContourReader, Elements, Forgotten, LogState};
pub(crate) use recorder::Passed;
#[doc(hidden)]
pub use recorder::Turn;
pub use recorder::{Crowded, Recorder};
pub use unit::{ControlUnit, Pending, UnitState};

use table::{Head, Slot, Table};

/// Memory of the log: `WINDOW` elements by distance, `LOG` entries by index. Each entry takes 48 bytes.
///
/// Both numbers are 0 or a power of two. All bits are zero when new, so that a static one lies in `.bss`.
pub struct ContourMemory<const WINDOW: usize, const LOG: usize> {
    window: (Head, [Slot; WINDOW]),
    log: (Head, [Slot; LOG]),
}

impl<const WINDOW: usize, const LOG: usize> ContourMemory<WINDOW, LOG> {
    /// Entries have numbers of 32 bits that wrap: a power of two divides them evenly.
    const EVEN: () = assert!(
        (WINDOW == 0 || WINDOW.is_power_of_two()) && (LOG == 0 || LOG.is_power_of_two()),
        "expected 0 or a power of two"
    );

    /// Nothing is in it.
    pub const fn new() -> Self {
        let () = Self::EVEN;
        Self {
            window: (Head::new(), [const { Slot::new() }; WINDOW]),
            log: (Head::new(), [const { Slot::new() }; LOG]),
        }
    }

    /// Both ends, emptied: the recorder is for [`crate::Planner::log_contour`].
    pub fn split(&mut self) -> (Recorder<'_>, ContourReader<'_>) {
        // In place: an empty table needs no empty slots, and a new one would be on the stack.
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
