//! Variables that a program shares with the application (feature `plc`): `V.E.name` with any name, and
//! `V.RTG.LOOP.ENABLED`, which tells whether real-time loops repeat.
//!
//! The application declares its variables, and passes them to the planner once
//! ([`Planner::variables`](crate::Planner::variables)). Any task, interrupt or core may read a variable. A
//! variable has one value that the PLC writes, and one that the program writes. A reader gets the value that
//! was written last.
//!
//! ```
//! use glidepath::variable::{Access, Variable};
//!
//! static VARIABLES: [Variable; 2] =
//!     [Variable::new("THICKNESS", Access::Read), Variable::new("PARTS", Access::ReadWrite)];
//!
//! VARIABLES[0].set(2.5); // the PLC: V.E.THICKNESS is 2.5 for the lines read from now on
//! assert_eq!(VARIABLES[0].get(), 2.5);
//! ```
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering, fence};

/// Whether a program may write a variable of the application.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// The program may read the variable.
    Read,
    /// The program may read and write the variable.
    ReadWrite,
}

/// A number with one writer. A reader never gets a half-written number.
///
/// There are two places. Readers use the shown place. The writer fills the other place, and then shows that
/// one. If a write comes during a read, the reader reads again.
struct Side {
    shown: AtomicU32,
    /// For each place: low and high half of the number, and a stamp. The stamp increases with each write of
    /// the PLC or of the program.
    places: [[AtomicU32; 3]; 2],
}

impl Side {
    const fn new() -> Self {
        Self { shown: AtomicU32::new(0), places: [const { [const { AtomicU32::new(0) }; 3] }; 2] }
    }

    fn place(&self, turn: u32) -> &[AtomicU32; 3] {
        let [even, odd] = &self.places;
        if turn & 1 == 0 { even } else { odd }
    }

    fn write(&self, value: f64, stamp: u32) {
        let turn = self.shown.load(Ordering::Relaxed).wrapping_add(1);
        let bits = value.to_bits();
        fence(Ordering::Release);
        let words = [bits as u32, (bits >> 32) as u32, stamp];
        self.place(turn).iter().zip(words).for_each(|(to, word)| to.store(word, Ordering::Relaxed));
        self.shown.store(turn, Ordering::Release);
    }

    /// The last value that was written, and its stamp.
    fn read(&self) -> (f64, u32) {
        loop {
            let turn = self.shown.load(Ordering::Acquire);
            let mut words = [0; 3];
            let place = self.place(turn);
            words.iter_mut().zip(place).for_each(|(to, word)| *to = word.load(Ordering::Relaxed));
            fence(Ordering::Acquire);
            if self.shown.load(Ordering::Relaxed) == turn {
                let [low, high, stamp] = words;
                return (f64::from_bits(u64::from(high) << 32 | u64::from(low)), stamp);
            }
            core::hint::spin_loop();
        }
    }
}

/// A variable `V.E.…` of the program.
pub struct Variable {
    name: &'static str,
    access: Access,
    plc: Side,
    program: Side,
}

impl Variable {
    /// Makes the variable `V.E.name` with the value 0. A name has at most 63 characters: letters, digits, `_`
    /// and `.`. Upper and lower case are equal.
    pub const fn new(name: &'static str, access: Access) -> Self {
        Self { name, access, plc: Side::new(), program: Side::new() }
    }

    /// The name of the variable, without `V.E.`.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// Writes the variable. Only one task or interrupt of the PLC at a time may call this function. A program
    /// sees the value in the lines that the planner reads from now on.
    pub fn set(&self, value: f64) {
        self.write(&self.plc, value);
    }

    /// The value that PLC or program wrote last; if both wrote at the same time, the value of the PLC.
    pub fn get(&self) -> f64 {
        let ((plc, stamp), (program, other)) = (self.plc.read(), self.program.read());
        if (stamp.wrapping_sub(other) as i32) >= 0 { plc } else { program }
    }

    /// Writes the variable on behalf of the program.
    pub(crate) fn assign(&self, value: f64) {
        self.write(&self.program, value);
    }

    fn write(&self, side: &Side, value: f64) {
        let (a, b) = (self.plc.read().1, self.program.read().1);
        let last = if (a.wrapping_sub(b) as i32) >= 0 { a } else { b };
        side.write(value, last.wrapping_add(1));
    }

    /// Whether the variable has this `name`, which is in upper case.
    pub(crate) fn is(&self, name: &[u8]) -> bool {
        self.name.as_bytes().eq_ignore_ascii_case(name)
    }

    /// Whether a program may write the variable.
    pub(crate) const fn is_writable(&self) -> bool {
        matches!(self.access, Access::ReadWrite)
    }
}

/// The variable `V.RTG.LOOP.ENABLED`: real-time loops repeat while it is true. Each word has one writer.
pub(crate) struct LoopFlag {
    /// The PLC's value.
    enabled: AtomicBool,
    /// The value of `written` at the PLC's last write. The PLC writes this word.
    seen: AtomicU32,
    /// Number of writes by the program, times two, plus the value. The planner writes this word.
    written: AtomicU32,
}

impl LoopFlag {
    /// A flag that is false.
    pub const fn new() -> Self {
        Self { enabled: AtomicBool::new(false), seen: AtomicU32::new(0), written: AtomicU32::new(0) }
    }

    /// The value that was written last.
    pub fn get(&self) -> bool {
        let written = self.written.load(Ordering::Acquire);
        if self.seen.load(Ordering::Acquire) == written {
            self.enabled.load(Ordering::Acquire)
        } else {
            written & 1 != 0
        }
    }

    /// Writes the flag on behalf of the PLC.
    pub fn set(&self, on: bool) {
        self.enabled.store(on, Ordering::Release);
        self.seen.store(self.written.load(Ordering::Acquire), Ordering::Release);
    }

    /// Writes the flag on behalf of the program.
    pub fn assign(&self, on: bool) {
        let count = (self.written.load(Ordering::Relaxed) >> 1).wrapping_add(1);
        self.written.store(count << 1 | u32::from(on), Ordering::Release);
    }
}
