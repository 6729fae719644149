//! A span (consecutive blocks with one speed profile) in the look-ahead, and its speed profile. The speed
//! rises from the start speed to a peak and falls to the end speed.
use super::block::{Block, Marks};
use super::planned::settled;
use crate::dynamics::Share;
use crate::math::float::{max, min, to_f32};
use crate::quantity::{DISTANCE_LSB, Speed, speed_bits, speed_f32};
use crate::slope::limits::Limits;
use crate::slope::profile::peak_above;
use crate::slope::ramp::Ramp;

/// Consecutive blocks without an anchor between them; one profile covers them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// Path length, LSB 2^-44 mm.
    pub length: i64,
    /// Limits that all blocks of the span permit; the speed is that of the fastest block.
    pub limits: Limits,
    /// Whether the speed at the span's start may have been planned for another end speed than the current
    /// one.
    pub kept: bool,
}

/// The speed profile of a span: from one speed up to a peak and down to another speed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law {
    up: Ramp,
    down: Ramp,
    v_in: f32,
    v_out: f32,
    peak: f32,
    length: f32,
    /// Whether the end speed is final, so that the braking at the end of the profile will not change.
    firm: bool,
    /// The limit of the last query, and the distances at which the profile reaches and leaves this limit.
    asked: [f32; 3],
}

/// Steps of the search for an end speed.
const LEAVE_STEPS: usize = 24;

/// A higher speed counts as a rise only above this ratio.
pub(super) const RISE: f32 = 1.0 + 1.0 / 1024.0;

/// Accuracy of a distance in a span, as a part of the span's length.
const DISTANCE: f32 = 1.0 / 1_048_576.0;

impl Span {
    /// A span without blocks.
    pub const NONE: Self = Self { length: 0, limits: Limits::WIDEST, kept: false };

    #[cfg_attr(feature = "fast", inline(always))]
    /// Adds a block at the end of the span. `share` is for the last block of the ring, if more blocks may
    /// follow: the limits that the transition at its end leaves to the speed profile.
    pub fn add(&mut self, block: &Block, share: Option<&Share>) {
        match share {
            None if self.length == 0 => self.limits = block.limits(),
            None => block.join_to(&mut self.limits),
            Some(share) => self.add_last(block, share),
        }
        self.kept = block.is(Marks::KEPT) || self.length > 0;
        self.length += block.length;
    }

    /// Adds the limits of the last block of the ring.
    #[inline(never)]
    fn add_last(&mut self, block: &Block, share: &Share) {
        let limits = block.limits_by_call().shared(share);
        if self.length == 0 {
            self.limits = limits;
        } else {
            self.limits.join(&limits);
        }
    }

    /// Adds a part of a neighbouring block, with these limits and this length (LSB 2^-44 mm).
    pub fn add_piece(&mut self, limits: &Limits, length: i64) {
        let v = self.limits.v;
        self.limits.join(limits);
        self.limits.v = v;
        self.kept = true;
        self.length += length;
    }

    /// Removes a piece of this length (LSB 2^-44 mm) from an end of the span.
    pub fn shorten(&mut self, length: i64) {
        self.kept = true;
        self.length -= length;
    }

    /// Adds the span after this one: both become one span.
    pub fn append(&mut self, other: &Self) {
        self.limits.join(&other.limits);
        self.kept = true;
        self.length += other.length;
    }

    fn millimetres(&self) -> f32 {
        to_f32(self.length) * DISTANCE_LSB
    }

    pub fn faster(&self, ramp: &Ramp, low: Speed, cap: f32) -> Speed {
        faster(ramp, self.millimetres(), low, cap)
    }

    /// Highest speed at the span's start, at most `cap`, from which the span can brake to `v_out`. The result
    /// is also at most the speed limit of the span.
    pub fn enter(&self, v_out: Speed, cap: f32) -> Speed {
        let mut room = None;
        let limits = self.limits.near(v_out, &mut room);
        self.faster(&limits.brake(), v_out, min(cap, limits.v))
    }

    /// Highest speed at the span's end, at most `next`, if the span starts at `v_in`. Returns `None` if the
    /// span is too short even for a stop.
    pub fn leave(&self, v_in: Speed, next: Speed) -> Option<Speed> {
        leave(&self.limits, self.length, self.kept, v_in, next)
    }

    /// Whether the limits permit both speeds, and the length suffices for the change between them.
    pub fn joins(&self, v_in: Speed, v_out: Speed) -> bool {
        let (low, high) = (v_in.min(v_out), v_in.max(v_out));
        let mut room = None;
        let limits = self.limits.between([v_in, v_out], self.millimetres(), &mut room);
        let ramp = if v_out < v_in { limits.brake() } else { limits.speed_up() };
        let [low_f32, dv] = [low.to_bits(), high.to_bits() - low.to_bits()].map(speed_f32);
        high.to_bits() <= speed_bits(self.limits.v) && ramp.distance(low_f32, dv)[0] <= self.millimetres()
    }
}

impl Law {
    /// The profile of an empty span.
    pub const NONE: Self = Self {
        up: Ramp::NONE,
        down: Ramp::NONE,
        v_in: 0.0,
        v_out: 0.0,
        peak: 0.0,
        length: 0.0,
        firm: false,
        asked: [f32::MAX; 3],
    };

    pub fn new(span: &Span, v_in: Speed, v_out: Speed, firm: bool) -> Self {
        let mut room = None;
        let limits = span.limits.between([v_in, v_out], span.millimetres(), &mut room);
        let (up, down) = (limits.speed_up(), limits.brake());
        let (v_in, v_out) = (v_in.to_bits(), v_out.to_bits());
        let low = v_in.max(v_out);
        let peak = low + peak_above(&up, &down, [v_in, v_out, low], span.length, limits.v);
        let [v_in, v_out, peak] = [v_in, v_out, peak].map(speed_f32);
        Self { up, down, v_in, v_out, peak, length: span.millimetres(), firm, asked: [f32::MAX; 3] }
    }

    /// Whether the end speed is final, so that the braking at the end of the profile will not change.
    pub fn is_firm(&self) -> bool {
        self.firm
    }

    /// Speeds at both ends of the span, mm/tick.
    pub fn ends(&self) -> [f32; 2] {
        [self.v_in, self.v_out]
    }

    /// Highest speed of the profile, mm/tick.
    pub fn peak(&self) -> f32 {
        self.peak
    }

    /// Duration of the profile, ticks.
    pub fn time(&self) -> f32 {
        let [gained, lost] = [self.peak - self.v_in, self.peak - self.v_out];
        let way = self.up.distance(self.v_in, gained)[0] + self.down.distance(self.v_out, lost)[0];
        self.up.time(gained) + self.down.time(lost) + max(self.length - way, 0.0) / self.peak
    }

    /// Distance from the span's start at which the profile reaches its peak, mm.
    pub fn reaches_at(&self) -> f32 {
        self.up.distance(self.v_in, self.peak - self.v_in)[0]
    }

    /// Distance from the span's start at which the braking begins, mm.
    pub fn brakes_at(&self) -> f32 {
        self.length - self.down.distance(self.v_out, self.peak - self.v_out)[0]
    }

    /// Whether the end speed is below the peak.
    pub fn slows_down(&self) -> bool {
        self.peak > self.v_out * RISE
    }

    /// Whether the speed surely stays at or below `v` between the distances `from` and `to` (mm) from the
    /// span's start. The braking counts only if it is final.
    #[inline]
    pub fn keeps(&mut self, v: f32, from: f32, to: f32) -> bool {
        if v >= self.peak {
            return true;
        }
        let near = DISTANCE * self.length;
        let [reached, left] = self.passes(v);
        to + near <= reached || (self.firm && from - near >= left)
    }

    /// How far the place `at` (mm from the span's start) is outside the part in which the profile is faster
    /// than `v`. The result is in mm, and negative if the profile is too fast at `at`. The braking counts
    /// only if it is final.
    pub fn margin(&mut self, v: f32, at: f32) -> f32 {
        if v >= self.peak {
            return f32::MAX;
        }
        let near = DISTANCE * self.length;
        let [reached, left] = self.passes(v);
        let before = reached - (at + near);
        if self.firm { max(before, (at - near) - left) } else { before }
    }

    /// Distances from the span's start (mm) at which the profile first reaches the speed `v` and last leaves
    /// it; `v` is below the peak.
    pub fn passes(&mut self, v: f32) -> [f32; 2] {
        if self.asked[0] != v {
            let reached = self.up.passes(self.v_in, self.peak - self.v_in, v - self.v_in);
            let left = self.length - self.down.passes(self.v_out, self.peak - self.v_out, v - self.v_out);
            self.asked = [v, reached, left];
        }
        [self.asked[1], self.asked[2]]
    }
}

/// Highest speed at the end of a span, at most `next`, that can be reached from `v_in`. Returns `None` if the
/// span is too short even for a stop. The result is a speed that can be stored ([`super::planned`]), or
/// `v_in`. `kept`: the speed at the span's start may have been planned for another end speed.
#[cfg_attr(feature = "fast", inline(always))]
pub(super) fn leave(limits: &Limits, length: i64, kept: bool, v_in: Speed, next: Speed) -> Option<Speed> {
    let length = to_f32(length) * DISTANCE_LSB;
    if next >= v_in {
        let mut room = None;
        let limits = limits.near(v_in, &mut room);
        let v = faster(&limits.speed_up(), length, v_in, limits.v);
        if v >= next {
            return Some(next);
        }
        // Not below the start speed, because the length may not suffice for a lower speed.
        return Some(if v > v_in { settled(v).max(v_in) } else { v });
    }
    if kept { slow_down(limits, length, v_in, next) } else { Some(next) }
}

/// Speed at the end of a span that starts at `v_in` and brakes: `next`, or the highest lower speed that the
/// length permits. Returns `None` if there is no such speed.
#[inline(never)]
fn slow_down(limits: &Limits, length: f32, v_in: Speed, next: Speed) -> Option<Speed> {
    let brake = limits.loose_brake();
    let possible = |v_out: Speed| loses(&brake, length, v_in, v_out);
    if possible(next) {
        return Some(next);
    }
    // The start speed was planned with a lower end speed, which needs less braking distance.
    let (mut low, mut high) = (0, next.to_bits());
    for _ in 0..LEAVE_STEPS {
        let middle = settled(Speed::from_bits(low + (high - low) / 2)).to_bits();
        if possible(Speed::from_bits(middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    let v_out = Speed::from_bits(low);
    (low > 0 || possible(v_out)).then_some(v_out)
}

/// Highest speed at the start of a span, at most `v_in`, from which the span can brake to `v_out`.
pub(super) fn enter(limits: &Limits, length: i64, v_out: Speed, v_in: Speed) -> Speed {
    let gain = ramp_gain(&limits.loose_brake(), v_out, to_f32(length) * DISTANCE_LSB);
    Speed::from_bits(v_out.to_bits().saturating_add(gain)).min(v_in)
}

/// Whether a span is long enough to brake from `v_in` to `v_out`.
pub(super) fn can_leave(limits: &Limits, length: i64, v_in: Speed, v_out: Speed) -> bool {
    loses(&limits.loose_brake(), to_f32(length) * DISTANCE_LSB, v_in, v_out)
}

fn loses(brake: &Ramp, length: f32, v_in: Speed, v_out: Speed) -> bool {
    let gain = ramp_gain(brake, v_out, length);
    v_out.to_bits().saturating_add(gain).saturating_add(gain >> 21) >= v_in.to_bits()
}

/// Highest speed, at most `cap`, that differs from `low` by a change with `ramp` within `length` (mm). The
/// change may be a braking to `low` or a gain of speed from `low`.
///
/// The change of speed is rounded, not the speed. At high speed over short blocks, the change is far below
/// the LSB of the speed in `f32`.
#[cfg_attr(feature = "fast", inline(always))]
pub(super) fn faster(ramp: &Ramp, length: f32, low: Speed, cap: f32) -> Speed {
    let cap = speed_bits(cap);
    if low.to_bits() >= cap {
        return Speed::from_bits(cap);
    }
    Speed::from_bits(low.to_bits().saturating_add(ramp_gain(ramp, low, length)).min(cap))
}

/// Change of speed from `low` on within `length`, rounded down by 2^-21.
#[cfg_attr(feature = "fast", inline(always))]
fn ramp_gain(ramp: &Ramp, low: Speed, length: f32) -> i64 {
    speed_bits(ramp.reach(speed_f32(low.to_bits()), length))
}

/// Path length, mm.
pub(super) fn length_mm(block: &Block) -> f32 {
    to_f32(block.length) * DISTANCE_LSB
}
