//! Spans whose time law may still change: the interrupt has not left them.
use crate::lookahead::{Pace, ReleasedSpan};
use crate::math::float::{min, to_f32};
use crate::quantity::{Distance, Speed};
use crate::queue::SEGMENTS;
use crate::slope::brake::SHORT;

/// Such a span.
#[derive(Clone, Copy, Debug)]
pub(super) struct CommittedSpan {
    pub span: ReleasedSpan,
    /// Path distance of its start, or of where it goes on after a standstill.
    pub start: Distance,
    /// Its first tick, and the time from its start to it.
    pub first: u32,
    pub next: u64,
    /// Ticks of rest behind it.
    pub rest: u64,
    /// What its law was made with: speed at its start and at its end, the highest one permitted, the
    /// operator's pace.
    pub enters: Speed,
    pub leaves: Speed,
    pub limit: f32,
    pub pace: Pace,
    /// As it was released: start, speed planned there, whether that keeps the limits of all blocks.
    released: (Distance, Speed, bool),
}

impl CommittedSpan {
    /// It is released, at `start`.
    pub const fn begin(&mut self, start: Distance) {
        (self.start, self.rest) = (start, 0);
        self.released = (start, self.span.v_in, self.span.checked);
    }

    /// It gets another law before it has begun: nothing of it is behind.
    pub const fn restore(&mut self) {
        let end = self.end();
        (self.start, self.span.v_in, self.span.checked) = self.released;
        self.span.length = Distance::from_bits(end.wrapping_sub(self.start.to_bits()));
        (self.span.slow.ceiling, self.span.slow.cruise) = (f32::MAX, 0.0);
    }

    /// What is left of it from the path distance `at` on may be as fast as the law planned for all of it,
    /// where that cruises.
    pub fn look(&mut self, at: i64) {
        let (start, v_in, checked) = self.released;
        let [length, at] = [self.end(), at].map(|x| x.wrapping_sub(start.to_bits()));
        let known = checked && at > 0 && self.span.is_uneven();
        self.span.slow.cruise = if known { self.span.cruises(length, v_in, at) } else { 0.0 };
    }

    /// Its start, up to path distance `start`, is behind: it goes on there, at the speed `v_in`.
    pub fn begin_at(&mut self, start: i64, v_in: Speed) {
        let left = self.end().wrapping_sub(start);
        self.start = Distance::from_bits(start);
        let span = &mut self.span;
        span.length = Distance::from_bits(left);
        span.v_in = v_in;
        span.checked = false;
        if left < SHORT {
            // Most of it at constant speed, which takes up the rounding of the rest.
            let limits = &span.limits;
            let part = to_f32(left) * (0.125 / (1u64 << 44) as f32);
            let v = min(limits.speed_up().reach(0.0, part), limits.brake().reach(0.0, part));
            span.slow.ceiling = min(span.slow.ceiling, v);
        }
    }

    /// Highest speed at its start as it was released, from which its end speed can be reached.
    fn enter_released(&self) -> Speed {
        let (start, v_in, _) = self.released;
        let length = Distance::from_bits(self.end().wrapping_sub(start.to_bits()));
        ReleasedSpan { length, v_in, ..self.span }.enter()
    }

    /// Path distance of its end.
    pub const fn end(&self) -> i64 {
        self.start.to_bits().wrapping_add(self.span.length.to_bits())
    }
}

/// As many as curves fit in the queue: each span not yet begun has one there.
const SLOTS: usize = SEGMENTS;

/// All of them, in a ring: written in place.
pub(super) struct CommittedSpans {
    slots: [CommittedSpan; SLOTS],
    front: usize,
    len: usize,
}

impl CommittedSpans {
    /// None; all bits zero.
    pub const fn new() -> Self {
        const { assert!(SLOTS.is_power_of_two()) };
        let blank = CommittedSpan {
            span: ReleasedSpan::BLANK,
            start: Distance::ZERO,
            first: 0,
            next: 0,
            rest: 0,
            enters: Speed::ZERO,
            leaves: Speed::ZERO,
            limit: 0.0,
            pace: Pace::BLANK,
            released: (Distance::ZERO, Speed::ZERO, false),
        };
        Self { slots: [blank; SLOTS], front: 0, len: 0 }
    }

    /// Forgets all of them.
    pub const fn clear(&mut self) {
        (self.front, self.len) = (0, 0);
    }

    pub const fn len(&self) -> usize {
        self.len
    }

    /// Apart from one slot for a way to a standstill in reserve.
    pub const fn is_full(&self) -> bool {
        self.len >= SLOTS - 1
    }

    /// The one `k` behind the front.
    #[inline(always)]
    pub fn get(&self, k: usize) -> Option<&CommittedSpan> {
        if k < self.len { self.slots.get((self.front + k) % SLOTS) } else { None }
    }

    /// The one `k` behind the front, to change it.
    #[inline(always)]
    pub fn get_mut(&mut self, k: usize) -> Option<&mut CommittedSpan> {
        if k < self.len { self.slots.get_mut((self.front + k) % SLOTS) } else { None }
    }

    /// The slot behind the last one, for the next one; it counts after [`Self::push`].
    #[inline(always)]
    pub fn spare(&mut self) -> Option<&mut CommittedSpan> {
        if self.len == SLOTS { None } else { self.slots.get_mut((self.front + self.len) % SLOTS) }
    }

    /// Takes in what is in [`Self::spare`].
    pub const fn push(&mut self) {
        if self.len < SLOTS {
            self.len += 1;
        }
    }

    /// The first one is over.
    pub const fn drop_first(&mut self) {
        if self.len > 0 {
            self.front = (self.front + 1) % SLOTS;
            self.len -= 1;
        }
    }

    /// Those from the one `k` behind the front on.
    pub fn from(&mut self, k: usize) -> impl Iterator<Item = &mut CommittedSpan> {
        let (front, len) = (self.front, self.len);
        let slots = self.slots.iter_mut().enumerate();
        slots
            .filter(move |(slot, _)| (k..len).contains(&(slot.wrapping_sub(front) % SLOTS)))
            .map(|(_, committed)| committed)
    }

    /// The first `count` are to end at no more than `v_out`, and to be no faster before than that permits.
    pub fn lower(&mut self, count: usize, mut v_out: Speed) {
        for k in (0..count).rev() {
            let Some(committed) = self.get_mut(k) else { return };
            committed.span.v_out = committed.span.v_out.min(v_out);
            let v_in = committed.span.enter();
            let begins = committed.enter_released();
            if v_in >= committed.span.v_in && begins >= committed.released.1 {
                return;
            }
            committed.span.v_in = committed.span.v_in.min(v_in);
            committed.released.1 = begins;
            v_out = committed.released.1;
        }
    }

    /// Only the first ones are left, so many.
    pub fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len);
    }
}
