//! The PLC's end: what comes, by distance or by index.
use super::entry::{BlockType, Entry, ProgramDistance};
use super::recorder::{ACTIVE, CLOSED};
use super::table::{Row, Table};
use crate::quantity::Distance;

/// Reads the log. `Copy`, `Send` and `Sync`: any number of contexts may read, interrupts too.
#[derive(Clone, Copy)]
pub struct ContourReader<'a> {
    window: Table<'a>,
    log: Table<'a>,
}

/// The elements wanted are no longer in the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Forgotten {
    /// The first distance that the window still has; all before it is forgotten.
    pub first: ProgramDistance,
}

impl core::fmt::Display for Forgotten {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let mm = self.first.to_mm();
        write!(f, "elements before {mm} mm are forgotten; ask sooner, or give ContourMemory a larger WINDOW")
    }
}

impl core::error::Error for Forgotten {}

/// State of the log of mode 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LogState {
    /// Entries of the log: count_logged_blocks.
    pub entries: u32,
    /// Entries that had no room: give [`super::ContourMemory`] a larger `LOG`.
    pub without_room: u32,
    /// LOG ON is read and LOG OFF is not: f_log_is_active.
    pub active: bool,
    /// LOG OFF is read. Another LOG ON does nothing before CLEAR.
    pub closed: bool,
}

impl<'a> ContourReader<'a> {
    pub(super) const fn new(window: Table<'a>, log: Table<'a>) -> Self {
        Self { window, log }
    }

    /// How far the path is known, from program start or the last #DISTANCE PROG START CLEAR that is read:
    /// max_dist_prog_start. Override, hold, dwell and waiting functions do not change it. It falls only at program
    /// start, at such a CLEAR, and where an abort takes back what was read.
    pub fn reach(&self) -> ProgramDistance {
        ProgramDistance::from_bits(self.window.row().reach)
    }

    /// The elements that lie in `from..to`, in their order. They count from the last #DISTANCE PROG START CLEAR that is
    /// read. The answer ends at [`Self::reach`] if `to` is beyond it.
    ///
    /// # Errors
    /// In place of elements that are forgotten comes [`Forgotten`]; the elements behind them follow.
    pub fn elements(&self, from: ProgramDistance, to: ProgramDistance) -> Elements<'a> {
        let row = self.window.row();
        Elements { window: self.window, next: newest(&row), from, to, end: false, due: ProgramDistance::ZERO }
    }

    /// The entry of the log with this index, from 0 at LOG ON. It stays until CLEAR or the next program start.
    pub fn logged(&self, index: u32) -> Option<Entry> {
        let row = self.log.row();
        let number = row.first.wrapping_add(index);
        let entry = self.log.get(number).filter(|_| index < row.end.wrapping_sub(row.first))?;
        // Cleared meanwhile: numbers of a new log begin elsewhere.
        (self.log.row().first == row.first).then_some(entry)
    }

    /// The state of the log.
    pub fn log_state(&self) -> LogState {
        let row = self.log.row();
        LogState {
            entries: row.end.wrapping_sub(row.first),
            without_room: row.mark,
            active: row.flags == ACTIVE,
            closed: row.flags == CLOSED,
        }
    }

    /// Distance from program start, or from the last #DISTANCE PROG START CLEAR passed, for the path distance of
    /// [`crate::Status`]: dist_prog_start. On a polynomial it is exact at both ends and grows as the path
    /// distance does. Reads the elements from that place to the end of what is known.
    ///
    /// # Errors
    /// The element there is no longer in the window.
    pub fn distance(&self, path: Distance) -> Result<ProgramDistance, Forgotten> {
        let row = self.window.row();
        let (mut at, mut ahead) = (row.end, row.path.wrapping_sub(path.to_bits()));
        if ahead <= 0 {
            return Ok(ProgramDistance::from_bits(row.reach));
        }
        let mut first = ProgramDistance::from_bits(row.reach);
        while at != row.first {
            at = at.wrapping_sub(1);
            let Some(entry) = self.window.get(at) else { break };
            first = entry.start;
            if !entry.block_type.is_element() {
                continue;
            }
            let planned = entry.planned;
            if ahead <= planned {
                // The part that is left of it.
                let part = if planned == 0 { 0.0 } else { ahead as f64 / planned as f64 };
                let left = (entry.length.to_bits() as f64 * part) as i64;
                return Ok(ProgramDistance::from_bits(entry.end().to_bits().wrapping_sub(left)));
            }
            ahead = ahead.wrapping_sub(planned);
        }
        Err(Forgotten { first })
    }
}

/// The first entry of the newest stretch of the window, behind the last CLEAR.
const fn newest(row: &Row) -> u32 {
    let (kept, marked) = (row.end.wrapping_sub(row.first), row.end.wrapping_sub(row.mark));
    if marked < kept { row.mark } else { row.first }
}

/// Elements in an interval of distances, in their order.
pub struct Elements<'a> {
    window: Table<'a>,
    next: u32,
    from: ProgramDistance,
    to: ProgramDistance,
    end: bool,
    /// Where the next element has to begin, or begins later where some are forgotten.
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
                // The writer has gone past it.
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
            // The first element of a stretch begins at 0.
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
