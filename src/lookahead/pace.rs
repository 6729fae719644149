//! The speed of blocks and spans under the override (0…200 %) and under reduced speed (P-AXIS-00214).
//!
//! P-CHAN-00066 selects on which speed the override acts:
//!
//! | P-CHAN-00066 | speed of a block |
//! |---|---|
//! | 0 | min(v_prog, v_max) · override, at most v_max |
//! | 1 | min(v_prog · override, v_max) |
//! | 2 | as 1 while the speed is reduced, as 0 otherwise |
//!
//! v_prog is the programmed feed; in rapid motion, v_prog is v_max. v_max is the limit of the machine on the
//! block. While the speed is reduced, v_red is a further limit: the highest speed at which every axis keeps
//! its P-AXIS-00214. In mode 0, an override below 100 % also lowers v_red.
//!
//! **Planned override.** All blocks in the ring are planned for the same override, the *level*. The level
//! follows the operator's override, but changes only between two plans of the ring. In mode 0, the level is
//! at least 100 %. The same holds in mode 2 without reduced speed, and always with the slopes STEP, TRAPEZ
//! and SIN2. Otherwise the level is at least 25 %.
//!
//! If the override falls below the level, the blocks keep their planned speeds. The profile of each span then
//! applies the lower override, so the motion slows down at once. The level falls as soon as the last released
//! span ends slowly enough for the first block of the ring at the new level
//! ([`super::Lookahead::set_level`]). When the level rises, the planned speeds of the blocks in the ring may
//! rise too. But the limits of an arc or a curve are computed once, when its block enters the ring. They are
//! for the level of that time, at least for 100 %. So a level above this makes only new arcs and curves
//! faster.
//!
//! **Spans with several feeds.** With HSC, a span may contain blocks of different speeds, and its profile
//! keeps the limit of each block. If the override is below the level, the span uses the same profile in slow
//! motion: s(part · t), with part = override / level. Then the speed of each block is multiplied by `part`,
//! and all accelerations are lower. The motion must enter the span at `part` times the planned start speed.
//! So with HSC every span also ends at `part` times its planned end speed, for each value of P-CHAN-00066.
//! After a feed hold or a change of override, the rest of the span gets a new profile, nowhere faster than
//! the planned one ([`ReleasedSpan::go_on`]). If there is no such profile, or while the speed is reduced, the
//! speed limit of the slowest block holds for the whole span.
//!
//! **Reduced speed** applies to the whole ring: no span is faster than the lowest v_red of all known blocks.
//! So there is always room to brake to the speed of the next block.
//!
//! **Cap.** The planner sets a speed limit for all spans, the *cap*, if the stop from a higher speed needs
//! more memory than [`crate::queue::Keeper`] has. A cap also limits rapid motion.
//!
//! A very low override does not stretch a span to more than 2^26 ticks: lower values have no further effect.
//! Reduced speed has no such bound.
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
