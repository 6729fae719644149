//! Places the functions of the program (M, H, S, T) on the path, and finds the synchronisation points, which
//! the code calls gates.
//!
//! In the program, a function is between two motion blocks. Its place is the number of motion blocks before
//! it. Smoothing decides which element of the path begins at this place. When this element enters the
//! look-ahead, its start is the point of the function, and the function enters the queue. From then on, the
//! interrupt outputs the function without the planner.
//!
//! If a function needs an acknowledgement, an element becomes a gate. The planner does not release a gate
//! until all acknowledgements have come. Until then, the motion is planned to stop before the gate.
use super::Function;
use crate::control::{Control, OPEN};
use crate::machine::Synch;
use crate::quantity::Distance;
use crate::queue::{ACTIONS, PlacedAction, Scheduler};
use crate::technology::{Action, Ticket};
use heapless::Vec;

/// A function that is not in the queue yet, or whose gate is not known yet. Packed, because there are many.
#[derive(Clone, Copy, Debug)]
#[repr(C, packed(4))]
struct Entry {
    n: u32,
    function: Function,
    ticket: Ticket,
    /// Number of motion blocks before the function, and number of motion blocks before its gate.
    out: u32,
    gate: u32,
    /// Whether the motion of the same line has not come yet, and whether that motion is before the gate.
    unsettled: bool,
    spans: bool,
    /// Whether the gate is known.
    gated: bool,
    /// Whether the function is in the queue.
    placed: bool,
    /// Whether the motion block that needs the acknowledgement is not known yet: [`Functions::demand`].
    #[cfg(feature = "plc")]
    late: bool,
    /// MVS_SLP: whether #EXPL SYN names that block; otherwise the block is the next motion at feed.
    #[cfg(feature = "plc")]
    explicit: bool,
    /// The function is output so far before its place, 0.1 µm.
    #[cfg(feature = "plc")]
    shift: u32,
}

impl Entry {
    /// Whether the motion block of its gate is known.
    const fn has_gate(&self) -> bool {
        #[cfg(feature = "plc")]
        if self.late {
            return false;
        }
        true
    }

    /// The point at which the function is output, if its place is at `distance`. Functions come out in the order of the
    /// program: not before `last`, the last one in the queue that is not due.
    #[cfg(feature = "plc")]
    fn point(&self, distance: Distance, last: Option<Distance>) -> Distance {
        if self.shift == 0 {
            return distance;
        }
        let shift = (i128::from(self.shift) << 44) / TENTHS_PER_MM;
        let point = distance.to_bits().wrapping_sub(shift as i64);
        let point = last.map_or(point, |last| {
            let ahead = last.to_bits().wrapping_sub(point);
            point.wrapping_add(ahead.max(0))
        });
        Distance::from_bits(point)
    }
}

/// 0.1 µm in a millimetre.
#[cfg(feature = "plc")]
const TENTHS_PER_MM: i128 = 10_000;

/// Functions that are not in the queue yet, functions whose gate is not known yet, and the gates.
pub(super) struct Functions {
    entries: Vec<Entry, ACTIONS>,
    /// The gates in the look-ahead in order, each as a set of bits, one per missing acknowledgement. Also the
    /// acknowledgements demanded at the end of all blocks.
    gates: Vec<u32, OPEN>,
    last: u32,
    sequence: u8,
}

/// Whether `number` is not later than `other`. Both are numbers of motion blocks.
const fn reaches(number: u32, other: u32) -> bool {
    number.wrapping_sub(other) as i32 >= 0
}

impl Functions {
    /// No functions; all bits zero.
    pub const fn new() -> Self {
        Self { entries: Vec::new(), gates: Vec::new(), last: 0, sequence: 0 }
    }

    /// Takes a function that the program has between the motion blocks `number` − 1 and `number`. `room`:
    /// number of free places for functions in the queue. `in_motion`: the line of the function also has a
    /// motion.
    ///
    /// # Errors
    /// There is no room.
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
            #[cfg(feature = "plc")]
            late: synch.is_late(),
            #[cfg(feature = "plc")]
            explicit: synch.is_explicit(),
            #[cfg(feature = "plc")]
            shift: 0,
        };
        self.entries.push(entry).map_err(|_| ())
    }

    /// Sets how far before its place the last function that was taken is output. `shift`: this path length,
    /// 0.1 µm.
    #[cfg(feature = "plc")]
    pub fn shift(&mut self, shift: u32) {
        if let Some(entry) = self.entries.last_mut() {
            entry.shift = shift;
        }
    }

    /// Puts all functions into the queue if one of them is to be output before its place. The point of such a
    /// function may still be ahead of the motion. `due`: number of all blocks that were taken; all of them
    /// are in the look-ahead and end at `distance`. The gates of these functions get their places later.
    #[cfg(feature = "plc")]
    pub fn shift_before_end(&mut self, due: u32, distance: Distance, queue: &mut Scheduler<'_>) {
        if self.entries.iter().any(|entry| entry.shift != 0 && !entry.placed) {
            self.put(due, distance, queue);
            self.tidy();
        }
    }

    /// Demands the acknowledgement of all functions with late synchronisation. The motion waits for the
    /// acknowledgements before the motion block `number`. For the end of the program.
    #[cfg(feature = "plc")]
    pub fn demand_all(&mut self, number: u32) {
        for entry in self.entries.iter_mut().filter(|entry| entry.late) {
            (entry.late, entry.gate) = (false, number);
        }
    }

    /// Completes the functions of a line when the line's motion has been taken. `moved`: whether the motion
    /// has a path. `rounds`: whether contour mode is to round the end of the motion.
    pub fn settle(&mut self, moved: bool, rounds: bool) {
        for entry in self.entries.iter_mut().filter(|entry| entry.unsettled) {
            entry.unsettled = false;
            if entry.spans && moved {
                entry.gate = entry.gate.wrapping_add(1);
                entry.out = if rounds { entry.gate } else { entry.out };
            }
        }
    }

    /// Demands the acknowledgement of functions with late synchronisation: the motion waits for it before the
    /// motion block `number`. `explicit`: `true` for functions that `#EXPL SYN` acknowledges (MVS_SLP),
    /// `false` for functions that are acknowledged before the next block at feed (MVS_SLM). Returns whether
    /// there are any.
    #[cfg(feature = "plc")]
    pub fn demand(&mut self, number: u32, explicit: bool) -> bool {
        let late = |entry: &&mut Entry| entry.late && entry.explicit == explicit;
        let mut any = false;
        for entry in self.entries.iter_mut().filter(late) {
            (entry.late, entry.gate, any) = (false, number, true);
        }
        any
    }

    /// Whether functions with late synchronisation wait for a call of [`Self::demand`] with this value of
    /// `explicit`.
    #[cfg(feature = "plc")]
    pub fn are_late(&self, explicit: bool) -> bool {
        self.entries.iter().any(|entry| entry.late && entry.explicit == explicit)
    }

    /// Whether the point of a function on the path, or its gate, is not known yet.
    pub fn are_open(&self) -> bool {
        self.entries.iter().any(|entry| !entry.placed || (!entry.gated && entry.has_gate()))
    }

    /// Whether a function whose gate is not known yet demands an acknowledgement.
    pub fn are_awaited(&self) -> bool {
        self.entries.iter().any(|entry| !entry.gated && entry.has_gate() && entry.ticket.waits())
    }

    /// Drops the functions of a line whose motion was refused.
    pub fn drop_unsettled(&mut self, control: &Control) {
        for entry in self.entries.iter().filter(|entry| entry.unsettled) {
            control.acknowledgements().give_back(entry.ticket);
        }
        self.entries.retain(|entry| !entry.unsettled);
    }

    /// Drops the functions that are not in the queue yet, because their motion is dropped.
    pub fn drop_unplaced(&mut self, control: &Control) {
        for entry in self.entries.iter().filter(|entry| !entry.placed) {
            control.acknowledgements().give_back(entry.ticket);
        }
        self.entries.retain(|entry| entry.placed);
    }

    /// Puts functions into the queue when the next element of the path is known; the element begins at
    /// `distance`. All functions with at most `due` motion blocks before them belong there. The queue must
    /// have room. Returns whether the element is a gate.
    pub fn before(&mut self, due: u32, distance: Distance, queue: &mut Scheduler<'_>) -> bool {
        if self.entries.is_empty() && self.last == 0 {
            return false;
        }
        self.place(due, distance, queue);
        let gate = core::mem::take(&mut self.last);
        // There is room, because each gate has at least one bit.
        gate != 0 && self.gates.push(gate).is_ok()
    }

    /// Puts the functions after the last block into the queue. All blocks end at `distance`, after `number`
    /// motion blocks. Returns whether the motion waits there for acknowledgements.
    pub fn at_end(&mut self, number: u32, distance: Distance, queue: &mut Scheduler<'_>) -> bool {
        self.place(number, distance, queue);
        self.last != 0
    }

    /// Gives functions with at most `due` motion blocks before them their place.
    #[cfg(feature = "plc")]
    fn put(&mut self, due: u32, distance: Distance, queue: &mut Scheduler<'_>) {
        for entry in self.entries.iter_mut().filter(|entry| !entry.placed && reaches(due, entry.out)) {
            entry.placed = true;
            let distance = entry.point(distance, queue.last_open());
            let Entry { n, function, ticket, .. } = *entry;
            let _ = queue.push(PlacedAction { distance, n, action: Action::Out(function, ticket) });
        }
    }

    /// Gives functions their place, and adds gates to `last`.
    fn place(&mut self, due: u32, distance: Distance, queue: &mut Scheduler<'_>) {
        #[cfg(feature = "plc")]
        self.put(due, distance, queue);
        for entry in &mut self.entries {
            #[cfg(not(feature = "plc"))]
            if !entry.placed && reaches(due, entry.out) {
                entry.placed = true;
                let Entry { n, function, ticket, .. } = *entry;
                let _ = queue.push(PlacedAction { distance, n, action: Action::Out(function, ticket) });
            }
            if entry.placed && !entry.gated && entry.has_gate() && reaches(due, entry.gate) {
                entry.gated = true;
                self.last |= entry.ticket.bit();
            }
        }
        self.tidy();
    }

    /// As [`Self::before`], for an element that is only examined. Functions and gates before it get their
    /// place, and wait for [`Self::drop_passed`].
    #[cfg(feature = "examine")]
    pub fn pass_by(&mut self, due: u32) {
        for entry in &mut self.entries {
            entry.placed |= reaches(due, entry.out);
            entry.gated |= entry.placed && entry.has_gate() && reaches(due, entry.gate);
        }
    }

    /// Outputs and acknowledges the functions of examined elements at once, because there is no motion.
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

    /// Removes completed entries. A function in the queue stays until its gate is known.
    fn tidy(&mut self) {
        self.entries.retain(|entry| !entry.placed || !entry.gated);
    }

    /// Takes acknowledgements: a set of bits, one for each function. Calls `open` for every gate in the
    /// look-ahead that opens now, with the gate's number among the gates that are still closed.
    pub fn answer(&mut self, bits: u32, mut open: impl FnMut(usize)) {
        for entry in self.entries.iter_mut().filter(|entry| entry.ticket.bit() & bits != 0) {
            // The acknowledgement came before the gate was known, so no gate is needed.
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

    /// Whether the motion has to wait for acknowledgements at the end of all blocks.
    pub const fn waits(&self) -> bool {
        self.last != 0
    }

    /// Drops all functions.
    pub fn clear(&mut self, control: &Control) {
        control.acknowledgements().clear();
        self.forget();
    }

    /// Drops all functions. Call this function only if none of them needs an acknowledgement; otherwise call
    /// [`Self::clear`].
    pub fn forget(&mut self) {
        self.entries.clear();
        self.gates.clear();
        self.last = 0;
    }
}
