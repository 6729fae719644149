//! A table of entries with one writer and any number of readers, without locks.
//!
//! Entries are numbered in order, modulo 2^32. The head of the table tells which numbers are valid. The table
//! has two places for its head: the writer fills the hidden place and then makes this place visible. So a
//! reader always finds a complete head, also if it interrupts the writer. A reader on another core reads the
//! head again if another head became visible during the read.
//!
//! The writer may overwrite an entry while a reader reads it. So a reader checks the head after the read. The
//! entry is valid only if its number is still in the table.
use super::entry::Entry;
use core::sync::atomic::{AtomicU32, Ordering, fence};

/// Memory of one [`Entry`].
pub struct Slot([AtomicU32; Entry::WORDS]);

impl Slot {
    pub const fn new() -> Self {
        Self([const { AtomicU32::new(0) }; Entry::WORDS])
    }

    pub fn set(&self, words: [u32; Entry::WORDS]) {
        self.0.iter().zip(words).for_each(|(word, value)| word.store(value, Ordering::Relaxed));
    }

    pub fn get(&self) -> [u32; Entry::WORDS] {
        let mut words = [0; Entry::WORDS];
        words.iter_mut().zip(&self.0).for_each(|(value, word)| *value = word.load(Ordering::Relaxed));
        words
    }
}

/// Which entries a table contains, and where the path of the table ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Row {
    /// Number of the first valid entry.
    pub first: u32,
    /// Number after the last valid entry.
    pub end: u32,
    /// Distance from program start to the end of the table, LSB 2^-24 mm.
    pub reach: i64,
    /// Driven distance at `reach`, LSB 2^-44 mm.
    pub driven: i64,
    /// For the window: the number after the last `#DISTANCE PROG START CLEAR`. For the log: number of entries
    /// without room.
    pub mark: u32,
    /// State of the log: 0 (not switched on yet), `ACTIVE` or `CLOSED` of `recorder.rs`.
    pub flags: u32,
}

const ROW: usize = 8;

impl Row {
    const fn to_words(self) -> [u32; ROW] {
        let Self { first, end, reach, driven, mark, flags } = self;
        [first, end, reach as u32, (reach >> 32) as u32, driven as u32, (driven >> 32) as u32, mark, flags]
    }

    const fn of_words([first, end, r0, r1, d0, d1, mark, flags]: [u32; ROW]) -> Self {
        let reach = ((r1 as u64) << 32 | r0 as u64) as i64;
        let driven = ((d1 as u64) << 32 | d0 as u64) as i64;
        Self { first, end, reach, driven, mark, flags }
    }
}

/// The head of a table: two places, and the number of the visible one.
pub struct Head {
    shown: AtomicU32,
    rows: [[AtomicU32; ROW]; 2],
}

impl Head {
    pub const fn new() -> Self {
        Self { shown: AtomicU32::new(0), rows: [const { [const { AtomicU32::new(0) }; ROW] }; 2] }
    }

    const fn place(&self, turn: u32) -> &[AtomicU32; ROW] {
        let [even, odd] = &self.rows;
        if turn & 1 == 0 { even } else { odd }
    }

    fn show(&self, row: Row) {
        let turn = self.shown.load(Ordering::Relaxed).wrapping_add(1);
        // A reader that sees a later word also sees that the earlier place is visible.
        fence(Ordering::Release);
        self.place(turn)
            .iter()
            .zip(row.to_words())
            .for_each(|(word, value)| word.store(value, Ordering::Relaxed));
        self.shown.store(turn, Ordering::Release);
    }

    fn row(&self) -> Row {
        loop {
            let turn = self.shown.load(Ordering::Acquire);
            let mut words = [0; ROW];
            words
                .iter_mut()
                .zip(self.place(turn))
                .for_each(|(value, word)| *value = word.load(Ordering::Relaxed));
            fence(Ordering::Acquire);
            if self.shown.load(Ordering::Relaxed) == turn {
                return Row::of_words(words);
            }
            core::hint::spin_loop();
        }
    }
}

/// A table of entries, for one writer and any number of readers.
#[derive(Clone, Copy)]
pub struct Table<'a> {
    head: &'a Head,
    slots: &'a [Slot],
}

impl<'a> Table<'a> {
    pub const fn new(head: &'a Head, slots: &'a [Slot]) -> Self {
        Self { head, slots }
    }

    /// Number of entries for which the table has room.
    pub const fn room(&self) -> usize {
        self.slots.len()
    }

    /// Which entries are valid now.
    pub fn row(&self) -> Row {
        self.head.row()
    }

    fn slot(&self, number: u32) -> Option<&'a Slot> {
        let room = u32::try_from(self.slots.len()).ok().filter(|room| *room > 0)?;
        self.slots.get((number % room) as usize)
    }

    /// Appends an entry to `row`. If the table already has `room` entries, the first one is dropped. Only the
    /// writer calls this function.
    pub fn push(&self, row: &mut Row, entry: &Entry, room: usize) {
        let Some(slot) = self.slot(row.end).filter(|_| room > 0) else {
            row.end = row.end.wrapping_add(1);
            row.first = row.end;
            return;
        };
        if row.end.wrapping_sub(row.first) as usize >= room {
            row.first = row.first.wrapping_add(1);
            self.head.show(*row);
        }
        fence(Ordering::Release);
        slot.set(entry.to_words());
        row.end = row.end.wrapping_add(1);
    }

    /// Makes `row` visible. Only the writer calls this function.
    pub fn show(&self, row: &Row) {
        self.head.show(*row);
    }

    /// The entry with this number, if it is in the table. For readers.
    pub fn get(&self, number: u32) -> Option<Entry> {
        let words = self.slot(number)?.get();
        fence(Ordering::Acquire);
        let row = self.head.row();
        let inside = number.wrapping_sub(row.first) < row.end.wrapping_sub(row.first);
        inside.then(|| Entry::of_words(words))
    }
}
