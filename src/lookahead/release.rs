//! Releases the first span of the ring (a run of blocks with one speed profile), with all data for its
//! profile. When a command changes the speed, this file also tells whether another profile of the span keeps
//! the limits of all its blocks.
use super::block::{AnchorMarks, Block, Marks};
use super::ease::Ease;
use super::law;
use super::planned::Planned;
use super::ring::Ring;
use crate::dynamics::{OverrideRange, Passing};
use crate::math::float::{max, min, to_f32};
use crate::quantity::{DISTANCE_LSB, Distance, Speed, speed_f32};
use crate::slope::limits::{Limits, ROUNDED};

/// The span (run of blocks with one speed profile) that leaves the look-ahead next, with all data for its
/// speed profile.
#[derive(Clone, Copy, Debug)]
pub struct ReleasedSpan {
    /// Number of blocks in the span.
    pub blocks: u16,
    /// Path length of the span.
    pub length: Distance,
    /// Limits that all blocks of the span permit; the speed is that of the fastest block.
    pub limits: Limits,
    /// Deceleration that all blocks permit, also in a curve with CONST_VEL. The deceleration of the planned
    /// profile may be lower: `limits`.
    pub a_down: f32,
    /// Speeds that hold for all blocks of the span, for a profile that differs from the planned one.
    pub slow: Slow,
    /// Speed at the start of the span.
    pub v_in: Speed,
    /// Speed at the end of the span.
    pub v_out: Speed,
    /// Whether all blocks keep their limits with the speeds at both ends.
    pub checked: Checked,
    /// Turns of the path inside the span, and common properties of the span's blocks.
    pub marks: SpanMarks,
    /// How the speed of the fastest block follows the override.
    pub override_range: OverrideRange,
    /// The block after the span.
    pub next: Behind,
    /// Highest speed of the span while reduced speed is on, mm/tick.
    pub v_reduced: f32,
    /// The planned override for which the look-ahead planned the speeds; 1 is 100 %.
    pub level: f32,
}

/// Whether a check has shown that all blocks of a span keep their limits. There are two answers: for the
/// current speeds at both ends, and for those at release. Without such a check, the limits surely hold only
/// up to a speed: the start speed or the lowest block speed, whichever is higher.
#[derive(Clone, Copy, Debug)]
pub struct Checked(u8);

impl Checked {
    const NOW: u8 = 1;
    const RELEASED: u8 = 2;

    /// Whether all blocks keep their limits with the current speeds at the ends.
    pub const fn now(self) -> bool {
        self.0 & Self::NOW != 0
    }

    /// Whether all blocks keep their limits with the speeds at release.
    pub const fn released(self) -> bool {
        self.0 & Self::RELEASED != 0
    }

    /// The state at release, checked or not.
    const fn at_release(now: bool) -> Self {
        Self(if now { Self::NOW | Self::RELEASED } else { 0 })
    }

    /// Marks that the check does not hold for the current speeds.
    pub const fn lose(&mut self) {
        self.0 &= Self::RELEASED;
    }

    /// Returns to the result of the check for the speeds at release.
    pub const fn restore(&mut self) {
        *self = Self::at_release(self.released());
    }
}

/// Properties of a span in one byte: whether the path turns at its transitions, and whether its blocks are
/// rapid motion.
#[derive(Clone, Copy, Debug)]
pub struct SpanMarks(u8);

impl SpanMarks {
    const SMOOTH: u8 = 1;
    const KNEES: u8 = 2;
    const PASSING: u8 = 4;
    const TRADES: u8 = 16;
    const BOUGHT: u8 = 32;
    const RAPID: u8 = 64;
    const FEED: u8 = 128;

    /// The marks of a span that begins with the block `first`. `any`: marks of any block; `all`: marks that
    /// all blocks have.
    fn new(first: &Block, any: AnchorMarks, all: AnchorMarks) -> Self {
        let marks = [
            (first.is(Marks::SMOOTH), Self::SMOOTH),
            (any.has_knee(), Self::KNEES),
            (first.trades(), Self::TRADES),
            (any.is_bought(), Self::BOUGHT),
            (any.is_rapid(), Self::RAPID),
            (!all.is_rapid(), Self::FEED),
        ];
        let marks = marks.into_iter().fold(0, |all, (on, mark)| if on { all | mark } else { all });
        Self(marks | (first.joint.passing().number() * Self::PASSING))
    }

    /// The part of a deceleration that may pass the span's start, as a factor from 1/2 to 1. Valid only if
    /// [`Self::is_smooth`] is true.
    pub fn passing(self) -> f32 {
        Passing::numbered((self.0 / Self::PASSING) & 3).part()
    }

    /// Whether a deceleration may pass the span's start.
    pub const fn is_smooth(self) -> bool {
        self.0 & Self::SMOOTH != 0
    }

    /// Whether the path turns at the start of any block of the span, so that the transition there reserves a
    /// part of the limits.
    pub const fn has_knees(self) -> bool {
        self.0 & Self::KNEES != 0
    }

    /// Whether the limits of the whole span trade speed for acceleration. Acceleration a is then permitted
    /// only below the highest speed: v + a²/2j is at most the speed of the limits.
    pub const fn trades(self) -> bool {
        self.0 & Self::TRADES != 0
    }

    /// Whether the limits of at least one block of the span trade speed for acceleration, as in
    /// [`Self::trades`].
    pub const fn trades_somewhere(self) -> bool {
        self.0 & Self::BOUGHT != 0
    }

    /// Whether the span is rapid motion; `None` if only a part of it is.
    pub const fn rapid(self) -> Option<bool> {
        match self.0 & (Self::RAPID | Self::FEED) {
            Self::RAPID => Some(true),
            Self::FEED | 0 => Some(false),
            _ => None,
        }
    }
}

/// Speeds up to which a span keeps the limits of all its blocks, for a profile that differs from the planned
/// one.
#[derive(Clone, Copy, Debug)]
pub struct Slow {
    /// The lowest permitted speed of a block in the span, mm/tick.
    pub least: f32,
    /// The lowest speed of the span's blocks. A slow block of which only a part belongs to the span counts
    /// too. Set only for several blocks.
    pub shared: f32,
    /// Constant highest speed that the rest of the span may have ([`ReleasedSpan::cruises`]), mm/tick; 0 if
    /// unknown.
    pub cruise: f32,
    /// Highest speed of a profile that begins or continues at another speed than planned, mm/tick; `f32::MAX`
    /// without such a limit.
    pub ceiling: f32,
}

/// Conditions under which a new profile surely stays below the planned one.
#[derive(Clone, Copy, Debug)]
pub struct GoingOn {
    /// Highest speed of the new profile, mm/tick.
    pub v: f32,
    /// How the profile may accelerate up to this speed.
    pub gain: Gain,
}

/// How a new profile below the planned one may accelerate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gain {
    /// Without further limits: the planned profile does not accelerate any more.
    Free,
    /// With the limits of the planned profile.
    Alike,
    /// With the limits of the planned profile, and half of the jerk while acceleration rises.
    Gentle,
}

/// The block after a span.
#[derive(Clone, Copy, Debug)]
pub struct Behind {
    /// Permitted speed of that block, mm/tick; 0 at a stop.
    pub v: f32,
    /// How that speed follows the override.
    pub override_range: OverrideRange,
}

/// The speed at the end of a span.
enum Ends {
    /// The planned speed at the start of the next block.
    AsPlanned,
    /// Another speed, or there is no next block.
    Otherwise,
}

impl ReleasedSpan {
    /// An empty span; all bits zero.
    pub const BLANK: Self = Self {
        blocks: 0,
        length: Distance::ZERO,
        limits: Limits::NOTHING,
        a_down: 0.0,
        slow: Slow { least: 0.0, shared: 0.0, cruise: 0.0, ceiling: 0.0 },
        v_in: Speed::ZERO,
        v_out: Speed::ZERO,
        checked: Checked(0),
        marks: SpanMarks(0),
        override_range: OverrideRange::BLANK,
        next: Behind { v: 0.0, override_range: OverrideRange::BLANK },
        v_reduced: 0.0,
        level: 0.0,
    };

    /// Raises the planned override of the span to `level`, and the speed limits with it.
    pub fn raise(&mut self, level: f32) {
        let risen = |v: f32, h: OverrideRange| max(v, v * (h.raised(level) / h.raised(self.level)) * ROUNDED);
        self.limits.v = risen(self.limits.v, self.override_range);
        self.next.v = risen(self.next.v, self.next.override_range);
        self.level = level;
    }

    /// Whether the span has blocks with different speeds.
    pub fn is_uneven(&self) -> bool {
        self.blocks > 1 && self.limits.varies() && self.slow.shared < self.limits.v
    }

    /// Speed of the planned profile (mm/tick) if the profile has its constant highest speed at the distance
    /// `at` from its start. 0 if the profile still speeds up or already brakes there. `at`: LSB 2^-44 mm. The
    /// profile covers `length` and begins at the speed `v_in`. All blocks from `at` to the braking permit the
    /// returned speed.
    pub fn cruises(&self, length: i64, v_in: Speed, at: i64) -> f32 {
        let span = law::Span { length, limits: self.limits, kept: true };
        let law = law::Law::new(&span, v_in, self.v_out, true);
        let at = to_f32(at) * DISTANCE_LSB;
        if law.reaches_at() <= at && at <= law.brakes_at() { law.peak() } else { 0.0 }
    }

    /// Conditions for a new profile that continues the span from the distance `at` on, where it begins with
    /// the speed `v` and zero acceleration. With these conditions, the new profile is nowhere faster than the
    /// planned profile. The planned profile covers `length` and begins at the speed `v_in`. Returns `None` if
    /// no conditions are known.
    ///
    /// - Case 1: the planned profile speeds up, is at least as fast, and began at most at the speed `v`.
    ///   Condition: the planned highest speed. At each speed, the new profile has at most the acceleration of
    ///   the planned one, because both have the same limits. Both begin to accelerate with the same jerk, the
    ///   new one at a higher speed. Both end on the curve a² = 2j(v_max − v). So the new profile reaches each
    ///   speed later.
    /// - Case 2: the planned profile speeds up and began faster than `v`. Condition: the planned highest
    ///   speed, and half of the jerk. The new profile has the larger acceleration only up to the speed v_in +
    ///   (v_in − v), where both accelerations are equal. If the planned profile reaches its largest
    ///   acceleration a before this speed, then only up to v_in + a²/2j. At this speed, the new profile has
    ///   its smallest delay. The delay is at least `at`, and in the second case (v_in − v − a²/2j)²/2a more.
    /// - Case 3: the planned profile has its highest speed. Condition: this speed, with any acceleration.
    /// - Case 4: the planned profile brakes and is at least as fast. Condition: the current speed. A new
    ///   profile without acceleration has to brake earlier than a profile that already brakes.
    pub fn go_on(&self, length: i64, v_in: Speed, at: i64, v: Speed) -> Option<GoingOn> {
        let span = law::Span { length, limits: self.limits, kept: true };
        let mut law = law::Law::new(&span, v_in, self.v_out, true);
        let (at, slow) = (to_f32(at) * DISTANCE_LSB, speed_f32(v.to_bits()));
        let (gain, below) = if at > law.brakes_at() {
            (Gain::Free, at <= law.passes(slow)[1])
        } else if at > law.reaches_at() {
            (Gain::Free, true)
        } else if v < v_in {
            (Gain::Gentle, true)
        } else {
            (Gain::Alike, law.passes(slow)[0] <= at)
        };
        below.then(|| GoingOn { v: law.peak(), gain })
    }

    /// Limits of the span, and the deceleration of a braking that replaces the span's profile.
    pub const fn braking(&self) -> (&Limits, f32) {
        (&self.limits, self.a_down)
    }

    /// Whether the span is long enough to brake from `v_in` to `v_out`.
    pub fn can_leave(&self, v_in: Speed, v_out: Speed) -> bool {
        law::can_leave(&self.limits, self.length.to_bits(), v_in, v_out)
    }

    /// Whether the last `left` of the span (2^-44 mm) is long enough to brake from `v` to the end speed.
    pub fn can_slow_within(&self, left: i64, v: Speed) -> bool {
        law::can_leave(&self.limits, left, v, self.v_out)
    }

    /// Highest speed at the span's start, at most the planned start speed, from which the span can brake to
    /// its end speed.
    pub fn enter(&self) -> Speed {
        law::enter(&self.limits, self.length.to_bits(), self.v_out, self.v_in)
    }

    /// Highest speed at the span's end, at most `next`, that the span reaches from its start speed.
    pub fn reach(&self, next: Speed) -> Speed {
        law::leave(&self.limits, self.length.to_bits(), true, self.v_in, next).unwrap_or(Speed::ZERO)
    }

    /// Highest speed at the span's end, at most the planned end speed, that the span reaches from `v_in`.
    /// `v_in` is at most the planned start speed.
    #[inline(never)]
    pub fn leave(&self, v_in: Speed) -> Speed {
        law::leave(&self.limits, self.length.to_bits(), false, v_in, self.v_out).unwrap_or(Speed::ZERO)
    }
}

impl<const AXES: usize, const BLOCKS: usize> Ring<'_, AXES, BLOCKS> {
    /// Fills `release` with the first span of the ring and its final end speed. Returns the first block, or
    /// `None` if the ring is empty. Afterwards, call [`Self::drop_first`] for each block of the span.
    pub fn release(&mut self, release: &mut ReleasedSpan) -> Option<&Block> {
        let ends = Self::span_of(self.blocks_from(0, self.blocks.len()), release, true, Some(self.start))?;
        release.level = self.level;
        release.v_reduced = self.tail.slowest.least;
        if self.scope.stale && release.blocks > 1 {
            release.checked = Checked(0);
        }
        if let Some(next) = self.blocks.get_mut(usize::from(release.blocks)) {
            match ends {
                Ends::AsPlanned => next.start_as_planned(),
                Ends::Otherwise => next.start_at(release.v_out),
            }
        }
        // The blocks of the span leave the ring before the next call.
        self.start = release.v_out;
        self.scope.stale = false;
        self.blocks.front()
    }

    /// Fills `release` with the planned span that begins `at` blocks after the first block, from the last
    /// complete plan. Returns `false` if there is no such span. Do not call this function while a plan is in
    /// progress.
    pub fn planned(&self, at: usize, release: &mut ReleasedSpan) -> bool {
        release.level = self.level;
        release.v_reduced = self.tail.slowest.least;
        let start = (at == 0).then_some(self.start);
        Self::span_of(self.blocks_from(at, self.scope.end), release, true, start).is_some()
    }

    /// As [`Self::planned`], without values that belong to the whole ring. If `ends` is false,
    /// [`ReleasedSpan::v_out`] is left out, which saves most of the work.
    pub fn scan(&self, at: usize, release: &mut ReleasedSpan, ends: bool) -> bool {
        let start = (at == 0).then_some(self.start);
        Self::span_of(self.blocks_from(at, self.scope.end), release, ends, start).is_some()
    }

    /// The blocks from number `at` up to, not including, number `end`, counted from the front. Blocks before
    /// `at` cost nothing.
    #[cfg_attr(feature = "fast", inline(always))]
    fn blocks_from(&self, at: usize, end: usize) -> impl Iterator<Item = &Block> {
        let (front, back) = self.blocks.as_slices();
        let [front, back] = [(front, 0), (back, front.len())].map(|(slice, before)| {
            let [from, to] = [at, end].map(|k| k.saturating_sub(before).min(slice.len()));
            slice.get(from..to).unwrap_or_default()
        });
        front.iter().chain(back)
    }

    /// The span at the front of these blocks, without values that belong to the whole ring. `start`: speed at its
    /// start, if not the planned one.
    #[cfg_attr(feature = "fast", inline(always))]
    fn span_of<'a>(
        mut ring: impl Iterator<Item = &'a Block>,
        release: &mut ReleasedSpan,
        ends: bool,
        start: Option<Speed>,
    ) -> Option<Ends> {
        let first = ring.next()?;
        let next = release.gather(first, ring);
        release.v_in = start.unwrap_or_else(|| first.v_in.speed_by_call());
        Some(release.end(first, next, ends))
    }
}

impl ReleasedSpan {
    /// Collects all blocks of the span, from the first one on. Returns the block after the span, if there is
    /// one.
    #[inline(never)]
    fn gather<'a>(&mut self, first: &Block, mut ring: impl Iterator<Item = &'a Block>) -> Option<&'a Block> {
        let mut ease = Ease::NONE;
        let (mut blocks, mut length) = (1u16, first.length());
        let mut v_least = first.speed();
        let mut override_range = first.override_range;
        // Written in place, because the stack is deep here.
        self.limits = first.limits();
        let (mut any, mut all) = (first.joint, first.joint);
        let next = loop {
            match ring.next() {
                Some(block) if !block.is(Marks::ANCHOR) => {
                    if blocks == 1 {
                        ease = block.ease();
                    }
                    v_least = min(v_least, min(block.cap, block.speed()));
                    block.join_to(&mut self.limits);
                    override_range.join(block.override_range);
                    (any, all) = (any.or(block.joint), all.and(block.joint));
                    length += block.length;
                    blocks += 1;
                }
                next => break next,
            }
        };
        v_least = min(v_least, self.limits.v);
        self.a_down = max(self.limits.loose.get(), self.limits.a_down);
        if blocks > 1 {
            self.limits.ease(ease);
            self.slow.shared = v_least;
        }
        (self.blocks, self.length) = (blocks, Distance::from_bits(length));
        self.slow = Slow { least: v_least, cruise: 0.0, ceiling: f32::MAX, ..self.slow };
        self.override_range = override_range;
        self.checked = Checked::at_release(first.is(Marks::CHECKED) || blocks == 1);
        self.marks = SpanMarks::new(first, any, all);
        next
    }

    /// Sets the end speed, the data of both ends, and the data of the next block. A separate function, so
    /// that only one of both stack frames exists at a time.
    #[inline(never)]
    fn end(&mut self, first: &Block, next: Option<&Block>, ends: bool) -> Ends {
        let v_in = self.v_in;
        if self.blocks > 1 {
            // A lent piece next to the span belongs to a slow block. This block's lowest speed is that of its
            // ends.
            if first.is_continued() {
                self.slow.shared = min(self.slow.shared, speed_f32(v_in.to_bits()));
            }
            if let Some(next) = next.filter(|next| next.is_continued()) {
                self.slow.shared = min(self.slow.shared, speed_f32(next.v_in.speed_by_call().to_bits()));
            }
        }
        let (mut v_out, mut as_planned) = (Speed::ZERO, false);
        self.next.v = 0.0;
        if let Some(next) = next {
            (self.next.v, self.next.override_range) = (next.v(), next.override_range);
            let planned = next.v_in.max(Planned::ZERO).speed();
            v_out = planned;
            if ends || first.is(Marks::FLAT) {
                let kept = first.is(Marks::KEPT) || self.blocks > 1;
                let length = self.length.to_bits();
                v_out = law::leave(&self.limits, length, kept, v_in, planned).unwrap_or(Speed::ZERO);
            }
            as_planned = next.v_in.is_some() && v_out == planned;
        }
        if first.is(Marks::FLAT) {
            // For any end speeds, the span may be as fast as all of its blocks permit.
            let known = max(self.slow.least, speed_f32(v_in.max(v_out).to_bits()));
            self.limits.v = min(self.limits.v, known);
        }
        self.v_out = v_out;
        if as_planned { Ends::AsPlanned } else { Ends::Otherwise }
    }
}
