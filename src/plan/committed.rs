//! The committed spans: spans that the look-ahead has released and that the interrupt has not passed. A
//! command may still change their profiles.
use crate::lookahead::{GoingOn, ReleasedSpan};
use crate::machine::functions;
use crate::math::float::{min, to_f32};
use crate::quantity::{Distance, Speed};
use crate::queue::MAX_CURVES_PER_TICK;
use crate::slope::brake::SHORT;

/// A committed span.
#[derive(Clone, Copy, Debug)]
pub(super) struct CommittedSpan {
    pub span: ReleasedSpan,
    /// Path distance of the span's start, or of the place where it continues after a stop.
    pub start: Distance,
    /// The first tick of the span, and the time from the span's start to this tick.
    pub first: u32,
    pub next: u64,
    /// Ticks of dwell after the span that are already in the queue. Before the dwell begins, this number is
    /// below 2^32.
    pub rest: u32,
    /// Conditions for which the profile was made: speeds at the start and end of the span, and the highest
    /// permitted speed. `pace`: override and reduced speed as one word ([`crate::lookahead::Pace::key`]).
    pub enters: Speed,
    pub leaves: Speed,
    pub limit: f32,
    pub pace: u32,
    /// Speed at the start of the span, as planned at release. `span.checked` says whether all blocks keep
    /// their limits with this speed. The span was released at the end of the span before
    /// ([`CommittedSpans::begins`]).
    released: Speed,
}

impl CommittedSpan {
    /// Prepares a span that has just left the look-ahead. `start`: path distance of its start.
    pub const fn begin(&mut self, start: Distance) {
        (self.start, self.rest) = (start, 0);
        self.released = self.span.v_in;
    }

    /// Returns to the state at release, for a new profile before the span has begun. `begins`: path distance
    /// at which the span was released.
    pub const fn restore(&mut self, begins: i64) {
        let end = self.end();
        (self.start, self.span.v_in) = (Distance::from_bits(begins), self.released);
        self.span.checked.restore();
        self.span.length = Distance::from_bits(end.wrapping_sub(self.start.to_bits()));
        (self.span.slow.ceiling, self.span.slow.cruise) = (f32::MAX, 0.0);
    }

    /// Notes the constant highest speed of the planned profile, if the rest of the span from the path
    /// distance `at` on may have this speed. `begins`: path distance at which the span was released.
    pub fn look(&mut self, begins: i64, at: i64) {
        let [length, at] = [self.end(), at].map(|x| x.wrapping_sub(begins));
        let known = self.span.checked.released() && at > 0 && self.span.is_uneven();
        self.span.slow.cruise = if known { self.span.cruises(length, self.released, at) } else { 0.0 };
    }

    /// Conditions under which the rest of the span, entered at the speed `v`, stays below its planned
    /// profile. Returns `None` if no conditions are known. `begins`: path distance at which the span was
    /// released.
    #[inline(never)]
    pub fn go_on(&self, begins: i64, v: Speed) -> Option<GoingOn> {
        let [length, at] = [self.end(), self.start.to_bits()].map(|x| x.wrapping_sub(begins));
        let known = self.span.checked.released() && at > 0 && self.span.is_uneven();
        let is_long = self.span.length.to_bits() >= SHORT;
        if known && is_long { self.span.go_on(length, self.released, at, v) } else { None }
    }

    /// Moves the start of the span to the path distance `start`, where the motion continues at the speed
    /// `v_in`.
    pub fn begin_at(&mut self, start: i64, v_in: Speed) {
        let left = self.end().wrapping_sub(start);
        self.start = Distance::from_bits(start);
        let span = &mut self.span;
        span.length = Distance::from_bits(left);
        span.v_in = v_in;
        span.checked.lose();
        if left < SHORT {
            // Most of the rest has constant speed, which absorbs rounding.
            let limits = &span.limits;
            let part = to_f32(left) * (0.125 / (1u64 << 44) as f32);
            let v = min(limits.speed_up().reach(0.0, part), limits.brake().reach(0.0, part));
            span.slow.ceiling = min(span.slow.ceiling, v);
        }
    }

    /// Highest speed at the start of the released span from which the profile can reach the span's end speed.
    fn enter_released(&self, begins: i64) -> Speed {
        let length = Distance::from_bits(self.end().wrapping_sub(begins));
        ReleasedSpan { length, v_in: self.released, ..self.span }.enter()
    }

    /// Speed at the span's start, as planned at release.
    pub const fn planned(&self) -> Speed {
        self.released
    }

    /// Path distance of the span's end.
    pub const fn end(&self) -> i64 {
        self.start.to_bits().wrapping_add(self.span.length.to_bits())
    }
}

/// Number of slots. More spans than a tick can pass have room, so the queue holds at least a tick of motion
/// even with the shortest spans. One slot stays free for the reserve. These slots take most of the planner's
/// memory, so a small build has as few as possible.
const SLOTS: usize = MAX_CURVES_PER_TICK as usize + if functions::IS_SMALL { 3 } else { 8 };
const _: () = assert!(SLOTS > MAX_CURVES_PER_TICK as usize + 2);

/// The index `k` slots after `front`.
const fn behind(front: usize, k: usize) -> usize {
    let slot = front + k;
    if slot >= SLOTS { slot - SLOTS } else { slot }
}

/// All committed spans, in a ring. Spans are written in place, because they are large.
pub(super) struct CommittedSpans {
    slots: [CommittedSpan; SLOTS],
    front: usize,
    len: usize,
    /// Path distance at which the first span was released.
    begins: i64,
}

impl CommittedSpans {
    /// No spans; all bits zero.
    pub const fn new() -> Self {
        let blank = CommittedSpan {
            span: ReleasedSpan::BLANK,
            start: Distance::ZERO,
            first: 0,
            next: 0,
            rest: 0,
            enters: Speed::ZERO,
            leaves: Speed::ZERO,
            limit: 0.0,
            pace: 0,
            released: Speed::ZERO,
        };
        Self { slots: [blank; SLOTS], front: 0, len: 0, begins: 0 }
    }

    /// Copies the spans of another ring.
    #[cfg(feature = "plc")]
    pub const fn copy_from(&mut self, other: &Self) {
        self.slots = other.slots;
        (self.front, self.len, self.begins) = (other.front, other.len, other.begins);
    }

    /// Removes all spans.
    pub const fn clear(&mut self) {
        (self.front, self.len) = (0, 0);
    }

    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether only one slot is free, which is kept for the reserve.
    pub const fn is_full(&self) -> bool {
        self.len >= SLOTS - 1
    }

    /// Path distance at which span `k`, counted from the front, was released.
    pub fn begins(&self, k: usize) -> i64 {
        k.checked_sub(1).and_then(|before| self.get(before)).map_or(self.begins, CommittedSpan::end)
    }

    /// Returns span `k` and all later spans to their state at release, for new profiles. None of them may
    /// have begun.
    pub fn restore_from(&mut self, k: usize) {
        let mut begins = self.begins(k);
        for k in k..self.len {
            let Some(committed) = self.get_mut(k) else { return };
            committed.restore(begins);
            begins = committed.end();
        }
    }

    /// Span `k`, counted from the front.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn get(&self, k: usize) -> Option<&CommittedSpan> {
        if k < self.len { self.slots.get(behind(self.front, k)) } else { None }
    }

    /// Span `k`, counted from the front, to change it.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn get_mut(&mut self, k: usize) -> Option<&mut CommittedSpan> {
        if k < self.len { self.slots.get_mut(behind(self.front, k)) } else { None }
    }

    /// The free slot after the last span, to write a span into. [`Self::push`] then adds this span.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn spare(&mut self) -> Option<&mut CommittedSpan> {
        if self.len == SLOTS { None } else { self.slots.get_mut(behind(self.front, self.len)) }
    }

    /// Adds the span that was written into [`Self::spare`].
    pub fn push(&mut self) {
        if self.len < SLOTS {
            self.len += 1;
        }
        if self.len == 1 {
            self.begins = self.get(0).map_or(0, |first| first.start.to_bits());
        }
    }

    /// Removes the first span, which the motion has passed.
    pub fn drop_first(&mut self) {
        if self.len > 0 {
            self.begins = self.begins(1);
            self.front = behind(self.front, 1);
            self.len -= 1;
        }
    }

    /// Span `k` and all later ones.
    pub fn from(&mut self, k: usize) -> impl Iterator<Item = &mut CommittedSpan> {
        self.among(k, self.len)
    }

    /// The spans `from` to `to`, without `to`, counted from the front.
    pub fn among(&mut self, from: usize, to: usize) -> impl Iterator<Item = &mut CommittedSpan> {
        let (front, to) = (self.front, to.min(self.len));
        let slots = self.slots.iter_mut().enumerate();
        slots
            .filter(move |(slot, _)| (from..to).contains(&behind(*slot, SLOTS - front)))
            .map(|(_, committed)| committed)
    }

    /// Limits the speed at the end of the first `count` spans to `v_out`. Earlier speeds are lowered as far
    /// as needed, so that each span can brake to its end speed.
    pub fn lower(&mut self, count: usize, mut v_out: Speed) {
        for k in (0..count).rev() {
            let start = self.begins(k);
            let Some(committed) = self.get_mut(k) else { return };
            committed.span.v_out = committed.span.v_out.min(v_out);
            let v_in = committed.span.enter();
            let begins = committed.enter_released(start);
            if v_in >= committed.span.v_in && begins >= committed.released {
                return;
            }
            committed.span.v_in = committed.span.v_in.min(v_in);
            committed.released = begins;
            v_out = committed.released;
        }
    }

    /// Keeps only the first `len` spans.
    pub fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len);
    }
}
