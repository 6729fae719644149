//! The effect of override (P-CHAN-00066) and reduced speed (P-AXIS-00214) on the speed of a block.
//!
//! | P-CHAN-00066 | speed |
//! |---|---|
//! | 0 | min(v_prog, v_max) · override |
//! | 1 | min(v_prog · override, v_max) |
//! | 2 | as 1 while the speed is reduced, as 0 otherwise |
//!
//! v_prog is the programmed feed. v_max is the limit of the machine on the block; no speed exceeds v_max.
//! Reduced speed limits min(v_prog, v_max) in mode 0, and v_max in mode 1. The limit is the speed at which
//! every axis keeps its P-AXIS-00214. In rapid motion, v_prog is v_max.
//!
//! The ring is planned for a *level*, the planned override. When a plan begins, the level follows the
//! override. In mode 0, the level is at least 100 %. In mode 1, and in mode 2 while the speed is reduced, the
//! override acts on the programmed feed only. Then the level is at least 25 %. If the override falls below
//! the level, the profile of a span applies it. So a falling override acts at once, and every planned speed
//! stays possible. The level falls when the motion enters the ring at a speed that is low enough
//! ([`super::Lookahead::set_level`]). The limits of an arc or a curve hold up to the level at which the
//! element entered the ring, at least 100 %. After the level has risen, only new blocks are faster.
//!
//! A span of HSC has blocks of several speeds, and a profile that keeps each limit in its place. With an
//! override below the level, the span uses this profile at a part of its speed, s(t · part). All
//! accelerations are then lower, and each block has its part of the speed. The start speed of the span must
//! be the same part of its planned speed. So such spans also end at that part, with any P-CHAN-00066. After a
//! hold or a change of override, the rest of a span uses a profile below the planned one
//! ([`ReleasedSpan::go_on`]). While the speed is reduced, or if there is no such profile, the slowest block
//! limits the speed.
//!
//! Reduced speed limits the whole ring: no span is faster than the reduced speed of the slowest known block.
//! So there is always time to brake to the speed of the next block.
//!
//! A *cap* is a speed limit for all spans, for any command. The planner sets a cap if a stop from a higher
//! speed has no room in the memory of [`crate::queue::Keeper`]. A cap acts like a lower feed, and also limits
//! rapid motion.
//!
//! An override alone makes no span longer than 2^26 ticks: a lower override has no further effect. Reduced
//! speed has no such bound.
use super::ReleasedSpan;
use crate::control::{Commands, FULL_OVERRIDE};
use crate::dynamics::OverrideRange;
use crate::math::float::{max, min, to_f32};
use crate::quantity::{Speed, speed_f32};

/// The lowest reduced speed of the last blocks. Their number is between one and two ring lengths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slowest {
    /// Lowest reduced speed of all counted blocks.
    pub least: f32,
    /// Number of blocks in the current group; a full group has as many blocks as the ring.
    blocks: usize,
    /// Lowest reduced speed of the current group.
    now: f32,
    /// Lowest reduced speed of the group before.
    before: f32,
}

impl Slowest {
    pub const NONE: Self = Self { least: f32::MAX, blocks: 0, now: f32::MAX, before: f32::MAX };

    /// Adds a block. `v` is its speed, planned for the override `level`; `depth` is the size of the ring in
    /// blocks.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn take(&mut self, override_range: OverrideRange, v: f32, level: f32, depth: usize) {
        if override_range.is_reduced() || self.least < f32::MAX {
            self.count(override_range, v, level, depth);
        }
    }

    #[inline(never)]
    fn count(&mut self, override_range: OverrideRange, v: f32, level: f32, depth: usize) {
        if let Some(v) = override_range.reduced(v, level) {
            self.now = min(self.now, v);
        }
        self.least = min(self.now, self.before);
        self.blocks += 1;
        if self.blocks >= depth {
            (self.blocks, self.before, self.now) = (0, self.now, f32::MAX);
        }
    }
}

/// A profile may be scaled by the override so far that it is slower than this part of the slowest block's
/// speed. The profile of the slowest block then replaces it.
const SLOWER: f32 = 0.75;
/// Factors with a smaller ratio count as equal, because roundings add up from span to span.
const SAME: f32 = 1.0 + 1.0 / 262_144.0;
/// The same margin, doubled.
const LESS: f32 = 1.0 - 1.0 / 131_072.0;

/// The lowest planned override. A released span keeps its planned override, and must end in time when the
/// override rises.
const LEAST_LEVEL: f32 = 0.25;

/// Ratio of path distance (LSB 2^-44 mm) to speed (mm/tick) of a block that takes 2^26 ticks.
pub(crate) const SLOWEST: f32 = (1u64 << 44) as f32 * (1u64 << 26) as f32;

/// The operator's current influence on the speed: override, reduced speed, and a cap that the planner sets if
/// stops have no room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Override, 0…2.
    over: f32,
    /// P-CHAN-00066.
    mode: u8,
    reduced: bool,
    /// Whether there is neither a reduced speed nor a cap.
    free: bool,
    /// Highest speed of all spans, mm/tick.
    cap: f32,
    key: u32,
}

impl Pace {
    /// The state with an override of 100 %. `mode`: the value of P-CHAN-00066.
    pub const fn new(mode: u8) -> Self {
        let cap = f32::MAX;
        Self { over: 1.0, mode, reduced: false, free: true, cap, key: Self::word(1.0, false, cap) }
    }

    /// The state in one word, for a comparison; P-CHAN-00066 is left out, because it never changes. With a
    /// cap, two different states may rarely give the same word. Then a profile stays unchanged, inside all
    /// limits.
    pub const fn key(&self) -> u32 {
        self.key
    }

    const fn word(over: f32, reduced: bool, cap: f32) -> u32 {
        // An override is not negative.
        (over.to_bits() | (reduced as u32) << 31) ^ (cap.to_bits() ^ f32::MAX.to_bits()).rotate_left(16)
    }

    /// Highest speed of all spans, mm/tick; `f32::MAX`: none.
    pub const fn cap(&self) -> f32 {
        self.cap
    }

    /// Sets the highest speed of all spans, mm/tick; `f32::MAX`: none.
    pub const fn set_cap(&mut self, cap: f32) {
        self.cap = cap;
        self.renew();
    }

    const fn renew(&mut self) {
        self.free = !self.reduced && self.cap == f32::MAX;
        self.key = Self::word(self.over, self.reduced, self.cap);
    }

    /// Whether the cap makes the span slower.
    const fn is_capped(&self, span: &ReleasedSpan) -> bool {
        self.cap < span.limits.v
    }

    /// Takes over the operator's override and reduced speed. An override of 0 is a feed hold, and leaves the
    /// override unchanged here.
    pub fn follow(&mut self, commands: &Commands) {
        if commands.feed > 0 {
            self.over = f32::from(commands.feed) / f32::from(FULL_OVERRIDE);
        }
        self.reduced = commands.reduced;
        self.renew();
    }

    /// The override for which the look-ahead is to be planned now; 1 is 100 %.
    pub fn level(&self) -> f32 {
        if self.is_of_program() { max(LEAST_LEVEL, self.over) } else { max(1.0, self.over) }
    }

    /// Whether a plan for the override `level` runs at its planned speed.
    #[cfg_attr(feature = "fast", inline(always))]
    fn is_full(&self, level: f32) -> bool {
        self.over == level && self.free && (level >= 1.0 || self.mode == 1)
    }

    /// Whether the span runs at its planned speed: neither override nor reduced speed nor cap changes it.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_planned(&self, span: &ReleasedSpan) -> bool {
        self.is_full(span.level) && (span.level >= 1.0 || self.slowest(span) <= span.limits.v)
            || (self.cap < f32::MAX && self.is_planned_below(span))
    }

    /// As [`Self::is_planned`], if there is a cap.
    #[cold]
    #[inline(never)]
    fn is_planned_below(&self, span: &ReleasedSpan) -> bool {
        let free = Self { free: !self.reduced, ..*self };
        !self.is_capped(span)
            && free.is_full(span.level)
            && (span.level >= 1.0 || self.slowest(span) <= span.limits.v)
    }

    /// Highest speed of a span with the current override, reduced speed and cap, mm/tick.
    pub fn limit(&self, span: &ReleasedSpan) -> f32 {
        let v = if self.is_planned(span) { span.limits.v } else { self.slowed(span) };
        min(v, span.slow.ceiling)
    }

    /// Speed limit below which an override alone does not slow the span.
    fn slowest(&self, span: &ReleasedSpan) -> f32 {
        let v = if span.is_uneven() { max(span.slow.shared, span.slow.cruise) } else { span.limits.v };
        let full = if span.level < 1.0 { v / span.override_range.raised(span.level) } else { v };
        min(full, to_f32(span.length.to_bits()) * (1.0 / SLOWEST))
    }

    fn slowed(&self, span: &ReleasedSpan) -> f32 {
        let v = if span.is_uneven() { max(span.slow.shared, span.slow.cruise) } else { span.limits.v };
        let slowest = self.slowest(span);
        let part = if span.is_uneven() {
            self.part(span.level)
        } else {
            self.factor(span.override_range, span.level)
        };
        self.reduce(span, max(v * part, slowest), slowest)
    }

    /// For a span with several feeds: the factor by which its planned profile is slowed down, if the motion
    /// enters the span at `v_in`. Returns `None` if the slowest feed has to limit the span instead: from
    /// another start speed, the slowed profile would not keep all feeds.
    pub fn stretch(&self, span: &ReleasedSpan, v_in: Speed) -> Option<f32> {
        if !span.is_uneven() || span.slow.ceiling < f32::MAX || self.reduced || self.is_capped(span) {
            return None;
        }
        let most = self.part(span.level);
        let begins = if span.v_in == Speed::ZERO {
            most
        } else {
            speed_f32(v_in.to_bits()) / speed_f32(span.v_in.to_bits())
        };
        let as_planned = span.checked.now() && v_in <= span.v_in;
        // A profile far below its planned speed may be faster than the slowest block.
        let slower = if self.is_planned(span) { f32::MAX } else { most * SLOWER };
        let fast = slower <= begins || span.slow.shared < 0.5 * begins * span.limits.v;
        (as_planned && fast && begins <= most * SAME).then(|| min(begins, 1.0))
    }

    /// For the rest of a span: the factor by which its planned profile is slowed down. Returns `None` if the
    /// slowest block has to limit the rest instead.
    pub fn steady(&self, span: &ReleasedSpan) -> Option<f32> {
        if self.is_planned(span) {
            return Some(1.0);
        }
        (!self.reduced && !self.is_capped(span)).then(|| self.part(span.level))
    }

    /// The factor by which the override slows spans that were planned for `level`, 0 to 1. All spans of HSC
    /// end at this part of their planned end speed, so that the next span starts as planned. The factor is
    /// slightly lower than the ratio of the overrides, to leave room for rounding.
    pub fn part(&self, level: f32) -> f32 {
        let level = if self.is_of_program() { level } else { max(1.0, level) };
        if self.over >= level { 1.0 } else { self.over / level * LESS }
    }

    /// Highest speed of the block after a span with the current override, reduced speed and cap, mm/tick.
    pub fn next(&self, span: &ReleasedSpan) -> f32 {
        self.reduce(span, span.next.v * self.factor(span.next.override_range, span.level), 0.0)
    }

    /// Whether the override acts on the programmed feed only (mode 1).
    fn is_of_program(&self) -> bool {
        self.mode == 1 || (self.mode == 2 && self.reduced)
    }

    /// Lowers `v` to the current limits. Neither override nor cap lowers the speed below `slowest`, so that a
    /// profile of the span is always possible.
    fn reduce(&self, span: &ReleasedSpan, v: f32, slowest: f32) -> f32 {
        let v = min(v, max(self.cap, slowest));
        if !self.reduced {
            return v;
        }
        let over = if self.is_of_program() { 1.0 } else { min(self.over, 1.0) };
        min(v, max(span.v_reduced * over, min(span.v_reduced, slowest)))
    }

    /// The currently permitted part of a speed that was planned for the override `level`, at most 1.
    fn factor(&self, override_range: OverrideRange, level: f32) -> f32 {
        let [above, below] = override_range.parts();
        let over = if self.is_of_program() { self.over / below } else { self.over };
        min(min(over, above) / override_range.raised(level), 1.0)
    }
}
