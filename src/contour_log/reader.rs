//! The PLC's handle of the log: reads the elements of the path ahead, by distance or by index.
use super::entry::{BELOW, BlockType, Entry, ProgramDistance};
use super::recorder::{ACTIVE, CLOSED};
use super::table::{Row, Table};
use crate::quantity::Distance;

/// The PLC's handle of the log. The type is `Copy`, `Send` and `Sync`: any number of tasks, interrupts and
/// cores may read at the same time.
#[derive(Clone, Copy)]
pub struct ContourReader<'a> {
    window: Table<'a>,
    log: Table<'a>,
}

/// The error of a request for elements that the window does not contain any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Forgotten {
    /// The first distance that the window still contains.
    pub first: ProgramDistance,
}

impl core::fmt::Display for Forgotten {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let mm = self.first.to_mm();
        write!(f, "elements before {mm} mm are forgotten; ask sooner, or give ContourMemory a larger WINDOW")
    }
}

impl core::error::Error for Forgotten {}

/// State of the log by index (mode 1). The program switches this log on and off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LogState {
    /// Number of entries in the log; ISG's count_logged_blocks.
    pub entries: u32,
    /// Number of entries that are missing because the log was full. A larger `LOG` of
    /// [`super::ContourMemory`] avoids this.
    pub without_room: u32,
    /// Whether the program has switched the log on and not off again; ISG's f_log_is_active.
    pub active: bool,
    /// Whether the program has switched the log off. Another LOG ON has no effect before CLEAR.
    pub closed: bool,
}

impl<'a> ContourReader<'a> {
    pub(super) const fn new(window: Table<'a>, log: Table<'a>) -> Self {
        Self { window, log }
    }

    /// The distance at which the known path ends, ISG's max_dist_prog_start. The distance counts from program
    /// start, or from the last `#DISTANCE PROG START CLEAR` that was read. Override, feed hold, dwell and
    /// waiting functions do not change this distance. The distance decreases at program start, at such a
    /// CLEAR, and at each pass of a loop with `#RT WHILE MODULO`. It also decreases when an abort drops lines
    /// already read.
    pub fn reach(&self) -> ProgramDistance {
        ProgramDistance::from_bits(self.window.row().reach)
    }

    /// The elements that overlap `from..to`, in order. Distances count from the last `#DISTANCE PROG START
    /// CLEAR` that was read. The answer ends at [`Self::reach`] if `to` is beyond it.
    ///
    /// # Errors
    /// The iterator returns [`Forgotten`] in place of elements that are no longer in the window; later
    /// elements follow.
    pub fn elements(&self, from: ProgramDistance, to: ProgramDistance) -> Elements<'a> {
        let row = self.window.row();
        Elements { window: self.window, next: newest(&row), from, to, end: false, due: ProgramDistance::ZERO }
    }

    /// The entry of the log with this index, counted from 0 at LOG ON. The entry stays until CLEAR or the
    /// next program start.
    pub fn logged(&self, index: u32) -> Option<Entry> {
        let row = self.log.row();
        let number = row.first.wrapping_add(index);
        let entry = self.log.get(number).filter(|_| index < row.end.wrapping_sub(row.first))?;
        // If the log was cleared during the read, the numbers of the new log begin elsewhere.
        (self.log.row().first == row.first).then_some(entry)
    }

    /// Number of entries and state of the log by index.
    pub fn log_state(&self) -> LogState {
        let row = self.log.row();
        LogState {
            entries: row.end.wrapping_sub(row.first),
            without_room: row.mark,
            active: row.flags == ACTIVE,
            closed: row.flags == CLOSED,
        }
    }

    /// Converts the driven distance `distance` of [`crate::Status`] to ISG's dist_prog_start. This is the
    /// distance from program start, or from the last passed `#DISTANCE PROG START CLEAR`. The call reads all
    /// elements from that place to the end of the known path.
    ///
    /// # Errors
    /// The element at this distance is no longer in the window.
    pub fn distance(&self, driven: Distance) -> Result<ProgramDistance, Forgotten> {
        let row = self.window.row();
        let left = row.driven.wrapping_sub(driven.to_bits());
        if left <= 0 {
            return Ok(ProgramDistance::from_bits(row.reach));
        }
        // Rounded up, so that the end of each element is exact.
        let mut left = left.saturating_add((1 << BELOW) - 1) >> BELOW;
        let (mut at, mut first) = (row.end, ProgramDistance::from_bits(row.reach));
        while at != row.first {
            at = at.wrapping_sub(1);
            let Some(entry) = self.window.get(at) else { break };
            first = entry.start;
            if !entry.block_type.is_element() {
                continue;
            }
            let length = entry.length.to_bits();
            if left <= length {
                return Ok(ProgramDistance::from_bits(entry.end().to_bits().wrapping_sub(left)));
            }
            left = left.wrapping_sub(length);
        }
        Err(Forgotten { first })
    }
}

/// The first entry of the window after the last CLEAR.
const fn newest(row: &Row) -> u32 {
    let (kept, marked) = (row.end.wrapping_sub(row.first), row.end.wrapping_sub(row.mark));
    if marked < kept { row.mark } else { row.first }
}

/// Iterator over the elements in an interval of distances, in the order of the path.
pub struct Elements<'a> {
    window: Table<'a>,
    next: u32,
    from: ProgramDistance,
    to: ProgramDistance,
    end: bool,
    /// Start of the next element. If the next element begins later, elements are missing.
    due: ProgramDistance,
}

impl Iterator for Elements<'_> {
    type Item = Result<Entry, Forgotten>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.end {
            let row = self.window.row();
            if row.end.wrapping_sub(self.next) == 0 {
                break;
            }
            let Some(entry) = self.window.get(self.next) else {
                // The writer has overwritten the element.
                let row = self.window.row();
                if self.next.wrapping_sub(row.first) < row.end.wrapping_sub(row.first) {
                    continue;
                }
                if row.end == row.first {
                    break;
                }
                self.next = newest(&row);
                continue;
            };
            if entry.block_type == BlockType::Clear || entry.start >= self.to {
                break;
            }
            // After a CLEAR, the first element begins at 0.
            if entry.start > self.due && self.from < entry.start {
                self.due = entry.start;
                return Some(Err(Forgotten { first: entry.start }));
            }
            self.next = self.next.wrapping_add(1);
            self.due = entry.end();
            if entry.end() > self.from {
                return Some(Ok(entry));
            }
        }
        self.end = true;
        None
    }
}
