//! Passes actions (functions of the program at points of the path) from the planner through the interrupt to
//! the operator.
//!
//! An action stays in one place of the memory, and no action is copied. Three counters say which side owns a
//! place, and each counter has one writer:
//!
//! | counter | written by | counts the actions that |
//! |---|---|---|
//! | `put` | the planner | have been put in |
//! | `due` | the interrupt | are due |
//! | `taken` | the operator | have been taken |
//!
//! When the motion reaches the point of an action, the interrupt writes the tick number into the place and
//! increments `due`. The operator may take a due action at any later time.
#![allow(unsafe_code)]
use super::{ACTIONS, PlacedAction};
use crate::quantity::{Distance, Position};
#[cfg(feature = "grbl")]
use crate::technology::InputWait;
use crate::technology::{Action, Function, Ticket};
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU32, Ordering};

const MASK: u32 = ACTIONS as u32 - 1;

/// Static memory of the actions (functions of the program at points of the path), shared by planner,
/// interrupt and operator.
pub struct Actions {
    put: AtomicU32,
    due: AtomicU32,
    taken: AtomicU32,
    places: [UnsafeCell<Record>; ACTIONS],
}

/// An action in memory. Nested enums would take a quarter more memory.
#[derive(Clone, Copy)]
struct Record {
    distance: Distance,
    value: i64,
    n: u32,
    kind: u16,
    ticket: Ticket,
    /// The tick at which the action became due. The interrupt writes this field while the planner may read
    /// other fields.
    tick: u32,
}

impl Record {
    const BLANK: Self =
        Self { distance: Distance::ZERO, value: 0, n: 0, kind: 0, ticket: Ticket::NONE, tick: 0 };

    fn new(placed: &PlacedAction) -> Self {
        let PlacedAction { distance, n, action: Action::Out(function, ticket) } = *placed;
        let (kind, value) = match function {
            Function::M(code) => (0, code.into()),
            Function::H(code) => (1, code.into()),
            Function::Spindle(speed) => (2, speed.to_bits()),
            Function::Tool(tool) => (3, tool.into()),
            #[cfg(feature = "grbl")]
            Function::Digital(port, on) => (4, i64::from(port) << 1 | i64::from(on)),
            #[cfg(feature = "grbl")]
            Function::Input(wait) => (
                5 | u16::from(wait.port) << 8 | u16::from(wait.is_analog) << 7,
                i64::from(wait.mode) << 32 | i64::from(wait.timeout_ms),
            ),
            #[cfg(feature = "grbl")]
            Function::Analog(port, value) => (6 | u16::from(port) << 8, value.to_bits()),
        };
        Self { distance, value, n, kind, ticket, tick: 0 }
    }

    fn placed(self) -> PlacedAction {
        let Self { distance, value, n, kind, ticket, .. } = self;
        let function = match kind {
            0 => Function::M(value as u16),
            1 => Function::H(value as u16),
            2 => Function::Spindle(Position::from_bits(value)),
            #[cfg(feature = "grbl")]
            4 => Function::Digital((value >> 1) as u8, value & 1 != 0),
            #[cfg(feature = "grbl")]
            kind if kind & 0x7f == 5 => Function::Input(InputWait {
                port: (kind >> 8) as u8,
                is_analog: kind & 0x80 != 0,
                mode: (value >> 32) as u8,
                timeout_ms: value as u32,
            }),
            #[cfg(feature = "grbl")]
            kind if kind & 0x7f == 6 => Function::Analog((kind >> 8) as u8, Position::from_bits(value)),
            _ => Function::Tool(value as u32),
        };
        PlacedAction { distance, n, action: Action::Out(function, ticket) }
    }
}

// SAFETY: only the one planner writes a place, while `put - taken` says that no other side owns the place.
// Only the one interrupt and the one operator read it, while they own it. The counters pass the place on with
// release and acquire.
unsafe impl Sync for Actions {}

/// The planner's handle: puts actions in, in the order of their points along the path.
pub struct Scheduler<'a>(&'a Actions);

/// The operator's handle: takes the actions that are due.
pub struct Outlet<'a>(&'a Actions);

impl Actions {
    /// Memory without actions; all bits are zero.
    pub const fn blank() -> Self {
        const { assert!(ACTIONS.is_power_of_two()) };
        let [put, due, taken] = [const { AtomicU32::new(0) }; 3];
        Self { put, due, taken, places: [const { UnsafeCell::new(Record::BLANK) }; ACTIONS] }
    }

    /// Drops all actions. Call this function before the three sides run.
    pub(super) fn reset(&mut self) {
        for counter in [&mut self.put, &mut self.due, &mut self.taken] {
            *counter.get_mut() = 0;
        }
    }

    /// The handles of planner and operator. The handle of the interrupt is part of [`super::Shared`]. The
    /// caller makes only one of each.
    pub(super) const fn ends(&self) -> (Scheduler<'_>, Outlet<'_>) {
        (Scheduler(self), Outlet(self))
    }

    fn record(&self, number: u32) -> *mut Record {
        // The mask is below the length, so the optimiser removes the check.
        self.places[(number & MASK) as usize].get()
    }
}

impl Scheduler<'_> {
    /// Number of further actions that can be put in now.
    pub fn room(&self) -> u32 {
        let put = self.0.put.load(Ordering::Relaxed);
        (ACTIONS as u32).wrapping_sub(put.wrapping_sub(self.0.taken.load(Ordering::Acquire)))
    }

    /// Appends an action. Its point must not lie before the point of the last action.
    ///
    /// # Errors
    /// There is no room. The error returns the action.
    pub fn push(&mut self, placed: PlacedAction) -> Result<(), PlacedAction> {
        if self.room() == 0 {
            return Err(placed);
        }
        let put = self.0.put.load(Ordering::Relaxed);
        // SAFETY: the operator has given the place back, and there is only one planner. The counter hands the
        // place over below.
        unsafe { *self.0.record(put) = Record::new(&placed) };
        self.0.put.store(put.wrapping_add(1), Ordering::Release);
        Ok(())
    }

    /// The number of the first action that is not due yet. Actions are numbered from 0 since `Rings::split`.
    pub fn first_open(&self) -> u32 {
        self.0.due.load(Ordering::Acquire)
    }

    /// The path distance of the action with this number, if the action has been put in and is not due yet.
    /// The action may become due during the call.
    pub fn open(&self, number: u32) -> Option<Distance> {
        let put = self.0.put.load(Ordering::Relaxed);
        let open = put.wrapping_sub(self.first_open());
        if put.wrapping_sub(number).wrapping_sub(1) >= open {
            return None;
        }
        // SAFETY: only this handle writes places, and needs `&mut self` for that. The other sides read too.
        Some(unsafe { (*self.0.record(number)).distance })
    }

    /// The path distance of the last action, if it is not due yet.
    #[cfg(feature = "plc")]
    pub fn last_open(&self) -> Option<Distance> {
        self.open(self.0.put.load(Ordering::Relaxed).wrapping_sub(1))
    }

    /// Withdraws the actions from `number` on. None of them may be due, or become due. The running tick may
    /// still read them, so call [`super::Clock::settle`] before other actions take their places.
    pub fn withdraw(&mut self, number: u32) {
        if self.0.put.load(Ordering::Relaxed).wrapping_sub(number) <= ACTIONS as u32 {
            self.0.put.store(number, Ordering::Release);
        }
    }
}

/// Functions for the interrupt. There is one interrupt.
impl Actions {
    /// Whether an action is not due yet. Runs in the tick.
    #[inline(always)]
    pub(super) fn is_armed(&self) -> bool {
        self.put.load(Ordering::Relaxed) != self.due.load(Ordering::Relaxed)
    }

    /// Marks the actions at or before `distance` as due in the tick with this number. Runs in the tick and
    /// takes about a dozen instructions per action, for at most [`super::ACTIONS`] actions.
    #[inline(never)]
    pub(super) fn reach(&self, distance: i64, tick: u32) {
        let mut due = self.due.load(Ordering::Relaxed);
        let put = self.put.load(Ordering::Acquire);
        for _ in 0..ACTIONS {
            if due == put {
                return;
            }
            let record = self.record(due);
            // SAFETY: the action is put in and not due. So the operator does not know the place, and the
            // planner does not change it.
            let point = unsafe { (*record).distance };
            if distance.wrapping_sub(point.to_bits()) < 0 {
                return;
            }
            // SAFETY: as above. The planner reads only the distance of the record.
            unsafe { (*record).tick = tick };
            due = due.wrapping_add(1);
            self.due.store(due, Ordering::Release);
        }
    }
}

/// The delay of actions if filters follow the path. An action becomes due when the filtered axes reach its
/// point, which is later than the path does.
#[derive(Clone, Copy, Debug)]
pub struct Lag {
    /// The number of the first action whose point the path has not reached.
    reached: u32,
    /// Ticks between the time when the path passes a point and the time when the axes pass it.
    pub delay: u32,
}

impl Lag {
    /// The state before the first action; all bits are zero.
    pub const NONE: Self = Self { reached: 0, delay: 0 };
}

impl Actions {
    /// As [`Self::reach`], with filters after the path: an action becomes due when the path, delayed by the
    /// filters, has reached its point. If the path stops at the point, the action becomes due when the axes
    /// have stopped too.
    #[inline(never)]
    pub(super) fn reach_later(&self, distance: i64, tick: u32, lag: &mut Lag, settled: bool) {
        let mut due = self.due.load(Ordering::Relaxed);
        let put = self.put.load(Ordering::Acquire);
        for _ in 0..ACTIONS {
            let record = self.record(lag.reached);
            // SAFETY: the action is put in and not due. So the operator does not know the place, and the
            // planner does not change it.
            if lag.reached == put || distance.wrapping_sub(unsafe { (*record).distance }.to_bits()) < 0 {
                break;
            }
            // SAFETY: as above. The planner reads only the distance of the record.
            unsafe { (*record).tick = tick.wrapping_add(lag.delay) };
            lag.reached = lag.reached.wrapping_add(1);
        }
        for _ in 0..ACTIONS {
            if due == lag.reached {
                return;
            }
            let record = self.record(due);
            // SAFETY: as above.
            let (point, from) = unsafe { ((*record).distance, (*record).tick) };
            let is_there = distance == point.to_bits();
            if !(is_there && settled) && (is_there || (tick.wrapping_sub(from) as i32) < 0) {
                return;
            }
            // SAFETY: as above.
            unsafe { (*record).tick = tick };
            due = due.wrapping_add(1);
            self.due.store(due, Ordering::Release);
        }
    }
}

impl Outlet<'_> {
    /// Takes the oldest due action, with the number of the tick that made it due. `None` if no action is due.
    /// Only one caller may take actions.
    pub fn take(&self) -> Option<(PlacedAction, u32)> {
        let taken = self.0.taken.load(Ordering::Relaxed);
        if self.0.due.load(Ordering::Acquire) == taken {
            return None;
        }
        // SAFETY: the action is due and not taken, so the operator owns the place until the counter moves on.
        let record = unsafe { *self.0.record(taken) };
        self.0.taken.store(taken.wrapping_add(1), Ordering::Release);
        Some((record.placed(), record.tick))
    }
}
