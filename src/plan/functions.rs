//! M, H, S and T on their way from the program to a point of the path, and the gates at which the motion
//! waits.
//!
//! A function belongs between two motion blocks, which counts as the number of motion blocks before it.
//! Contour mode decides which element of the path begins there. When that element goes into the look-ahead
//! the place of the function is known, and it goes into the queue: the motion may come there without the
//! planner. The element may be marked as a *gate*: it is not handed on, and the motion is planned to stand
//! still before it, until all acknowledgements demanded there have come.
use super::Function;
use crate::control::{Control, OPEN};
use crate::machine::Synch;
use crate::quantity::Distance;
use crate::queue::{ACTIONS, PlacedAction, Scheduler};
use crate::technology::{Action, Ticket};
use heapless::Vec;

/// A function that is not in the queue yet, or whose gate is still to come. Packed: there are many of them.
#[derive(Clone, Copy, Debug)]
#[repr(C, packed(4))]
struct Entry {
    n: u32,
    function: Function,
    ticket: Ticket,
    /// Motion blocks before it, and before its gate.
    out: u32,
    gate: u32,
    /// The motion it was programmed with is still to come; and is before its gate.
    unsettled: bool,
    spans: bool,
    /// Its gate is known.
    gated: bool,
    /// It is in the queue.
    placed: bool,
}

/// Functions and gates.
pub(super) struct Functions {
    entries: Vec<Entry, ACTIONS>,
    /// The gates in the look-ahead in order, with their open acknowledgements, a bit each; and those demanded
    /// where everything taken in ends.
    gates: Vec<u32, OPEN>,
    last: u32,
    sequence: u8,
}

/// Not later: numbers of motion blocks.
const fn reaches(number: u32, other: u32) -> bool {
    number.wrapping_sub(other) as i32 >= 0
}

impl Functions {
    /// No functions; all bits zero.
    pub const fn new() -> Self {
        Self { entries: Vec::new(), gates: Vec::new(), last: 0, sequence: 0 }
    }

    /// Takes in a function between the motion blocks `number` - 1 and `number`; `room` is that of the ring of
    /// actions. `in_motion`: it was programmed together with a motion.
    ///
    /// # Errors
    /// No room.
    pub fn take(
        &mut self,
        (n, function, synch): (u32, Function, Synch),
        (number, in_motion): (u32, bool),
        (room, control): (u32, &Control),
    ) -> Result<(), ()> {
        if self.entries.len() >= room as usize {
            return Err(());
        }
        let mut ticket = Ticket::NONE;
        if synch.waits() {
            ticket = control.acknowledgements().plan(function, self.sequence).ok_or(())?;
            self.sequence = self.sequence.wrapping_add(1);
        }
        let entry = Entry {
            n,
            function,
            ticket,
            out: number,
            gate: number,
            unsettled: in_motion && synch.is_before(),
            spans: synch == Synch::MvsSns,
            gated: !ticket.waits(),
            placed: false,
        };
        self.entries.push(entry).map_err(|_| ())
    }

    /// The motion that they were programmed with is there: `moved`, it has path; `rounds`, its end is to be
    /// rounded.
    pub fn settle(&mut self, moved: bool, rounds: bool) {
        for entry in self.entries.iter_mut().filter(|entry| entry.unsettled) {
            entry.unsettled = false;
            if entry.spans && moved {
                entry.gate = entry.gate.wrapping_add(1);
                entry.out = if rounds { entry.gate } else { entry.out };
            }
        }
    }

    /// Whether one is still to be given its place or its gate.
    pub fn are_open(&self) -> bool {
        self.entries.iter().any(|entry| !entry.placed || !entry.gated)
    }

    /// Whether an acknowledgement is demanded of one that is still to be given its place or its gate.
    pub fn are_awaited(&self) -> bool {
        self.entries.iter().any(|entry| !entry.gated && entry.ticket.waits())
    }

    /// The motion that they were programmed with is refused.
    pub fn drop_unsettled(&mut self, control: &Control) {
        for entry in self.entries.iter().filter(|entry| entry.unsettled) {
            control.acknowledgements().give_back(entry.ticket);
        }
        self.entries.retain(|entry| !entry.unsettled);
    }

    /// The motion that they belong to is forgotten before their place was known.
    pub fn drop_unplaced(&mut self, control: &Control) {
        for entry in self.entries.iter().filter(|entry| !entry.placed) {
            control.acknowledgements().give_back(entry.ticket);
        }
        self.entries.retain(|entry| entry.placed);
    }

    /// The next element of the path begins at `distance`: all that has no more than `due` motion blocks
    /// before it goes into the queue, which has room for it. Whether the element is a gate.
    pub fn before(&mut self, due: u32, distance: Distance, queue: &mut Scheduler<'_>) -> bool {
        if self.entries.is_empty() && self.last == 0 {
            return false;
        }
        self.place(due, distance, queue);
        let gate = core::mem::take(&mut self.last);
        // There is room: a gate has a bit of its own.
        gate != 0 && self.gates.push(gate).is_ok()
    }

    /// All blocks taken in end at `distance`, after `number` motion blocks. Returns whether the motion waits there.
    pub fn at_end(&mut self, number: u32, distance: Distance, queue: &mut Scheduler<'_>) -> bool {
        self.place(number, distance, queue);
        self.last != 0
    }

    /// Gives functions their place, and gates to `last`.
    fn place(&mut self, due: u32, distance: Distance, queue: &mut Scheduler<'_>) {
        for entry in &mut self.entries {
            if !entry.placed && reaches(due, entry.out) {
                entry.placed = true;
                let Entry { n, function, ticket, .. } = *entry;
                let _ = queue.push(PlacedAction { distance, n, action: Action::Out(function, ticket) });
            }
            if entry.placed && !entry.gated && reaches(due, entry.gate) {
                entry.gated = true;
                self.last |= entry.ticket.bit();
            }
        }
        self.tidy();
    }

    /// An element with no more than `due` motion blocks before it is only examined: functions and gates before it have
    /// their place. They wait for [`Self::drop_passed`].
    #[cfg(feature = "examine")]
    pub fn pass_by(&mut self, due: u32) {
        for entry in &mut self.entries {
            entry.placed |= reaches(due, entry.out);
            entry.gated |= entry.placed && reaches(due, entry.gate);
        }
    }

    /// Functions of examined elements are put out and acknowledged at once.
    #[cfg(feature = "examine")]
    pub fn drop_passed(&mut self, control: &Control) {
        if self.entries.is_empty() {
            return;
        }
        for entry in self.entries.iter().filter(|entry| entry.placed && entry.gated) {
            control.acknowledgements().give_back(entry.ticket);
        }
        self.tidy();
    }

    /// What is in the queue stays as long as its gate is still to come.
    fn tidy(&mut self) {
        self.entries.retain(|entry| !entry.placed || !entry.gated);
    }

    /// These acknowledgements have come; calls `open` with the number of every gate in the look-ahead that is
    /// open now, counted without those already open.
    pub fn answer(&mut self, bits: u32, mut open: impl FnMut(usize)) {
        for entry in self.entries.iter_mut().filter(|entry| entry.ticket.bit() & bits != 0) {
            // Acknowledged before its gate was known: it needs none.
            entry.gated = true;
        }
        self.last &= !bits;
        let mut gate = 0;
        for _ in 0..OPEN {
            let Some(mask) = self.gates.get_mut(gate) else { break };
            *mask &= !bits;
            if *mask == 0 {
                self.gates.remove(gate);
                open(gate);
            } else {
                gate += 1;
            }
        }
        self.tidy();
    }

    /// Whether the motion is to wait where everything taken in ends.
    pub const fn waits(&self) -> bool {
        self.last != 0
    }

    /// Forgets all of them.
    pub fn clear(&mut self, control: &Control) {
        control.acknowledgements().clear();
        self.forget();
    }

    /// Forgets all functions where none is planned.
    pub fn forget(&mut self) {
        self.entries.clear();
        self.gates.clear();
        self.last = 0;
    }
}
