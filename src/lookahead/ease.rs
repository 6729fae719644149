//! Removes anchors (points where acceleration has to be zero) if one profile for the spans on both sides
//! takes less time.
//!
//! At an anchor, acceleration falls to zero and rises again. This takes time. Two kinds of anchors are tried:
//!
//! - An end of a slow block, between this block and a faster part of the path ([`super::span`]). Without the
//!   anchor, one profile covers the slow block and the faster part. To stay below the limit in the slow
//!   block, the profile uses less acceleration or deceleration than permitted. Or the highest speed of the
//!   profile is that of the slow block.
//! - A transition between two blocks whose accelerations differ clearly ([`super::append`]).
//!
//! Each anchor is tried once, as soon as the speeds up to the next anchor are final. The first profile uses
//! all acceleration that the blocks permit, and is compared with every block. If the profile is too fast in a
//! block while the speed changes, the secant method finds the largest acceleration that keeps the limit. The
//! steps of this search are 1/256 of the permitted acceleration. If the profile is too fast at its peak, its
//! highest speed is lowered. Then the new profile is compared with every block. The anchor stays if no
//! profile keeps all limits after [`ROUNDS`] rounds, or if the profile takes longer than the plan with the
//! anchor.
use super::block::Marks;
use super::law::{Law, RISE, Span};
use super::plan::spend;
use super::planned::Planned;
use super::ring::Ring;
use super::valley::{self, Valley};
use crate::math::float::{max, min, to_f32};
use crate::math::root::sqrt_f32;
use crate::quantity::{DISTANCE_LSB, Speed, speed_f32};
use crate::slope::limits::Limits;

impl Limits {
    /// Lowers the limits by an ease.
    pub(super) fn ease(&mut self, ease: Ease) {
        let ([up, down], v) = ease.parts();
        self.a_up *= up;
        self.a_down *= down;
        self.loose.scale(min(up, down));
        self.v = min(self.v, v);
    }
}

/// The margin that the profile of a span keeps below the span's limits. The second block of the span stores
/// this margin, in the memory that an anchor uses for its speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ease {
    /// How much less acceleration and deceleration the profile uses, as a part of the limits, LSB 2^-8.
    less: [u8; 2],
    /// Highest speed of the profile, mm/tick.
    v: f32,
}

impl Ease {
    /// No margin: the span uses all of its limits.
    pub const NONE: Self = Self { less: [0; 2], v: f32::MAX };

    /// The margin from the two numbers that [`Self::kept`] returned.
    pub fn of([v, less]: [u32; 2]) -> Self {
        let [up, down, ..] = less.to_le_bytes();
        Self { less: [up, down], v: f32::from_bits(v) }
    }

    /// The margin as two numbers for the memory of a block; the second one is never zero.
    pub fn kept(self) -> [u32; 2] {
        let [up, down] = self.less;
        [self.v.to_bits(), u32::from_le_bytes([up, down, 0, 1])]
    }

    /// The same margin, with the highest speed multiplied by `part`.
    pub fn scaled(self, part: f32) -> Self {
        Self { v: if self.v < f32::MAX { self.v * part } else { self.v }, ..self }
    }

    /// The parts of acceleration and deceleration that the profile may use (0 to 1), and its highest speed.
    pub fn parts(self) -> ([f32; 2], f32) {
        (self.less.map(|less| 1.0 - f32::from(less) * (1.0 / 256.0)), self.v)
    }
}

/// Largest margin: a sixteenth of the acceleration is left.
const MOST: u8 = 240;
/// Number of blocks per step: blocks that are only counted, and blocks that are compared with a profile.
const WALK: usize = 32;
const STEPS: usize = 8;
/// Work of a step that searches for an anchor, and work of any other step; the unit is about 32 instructions.
const SEEK: usize = 20;
pub(super) const TRIAL: usize = 120;
/// Number of stored profiles, a power of 2; and the mark for none.
const KNOWN: usize = 4;
const UNKNOWN: (usize, f32, f32) = (usize::MAX, 0.0, 0.0);
/// Profiles per step.
const LAWS: usize = 4;
/// Largest number of rounds that lower the acceleration because of a block.
pub(super) const ROUNDS: u8 = 4;
/// Longest joined span: the depth of the ring divided by this number.
const PART: usize = 2;
/// If the speed planned at the end of a span exceeds the speed reached before by more than this ratio,
/// another forward pass is worth its work.
const HARDLY: f32 = 1.004;
/// Ratio of times above which there is no gain.
pub(super) const GAIN: f32 = 1.0 - 1.0 / 65_536.0;

/// A limit that a profile exceeds while its speed changes.
#[derive(Clone, Copy, Debug)]
struct Excess {
    /// Distance between the limit and the end of the span at which this change of speed begins or ends.
    way: f32,
    /// The permitted speed.
    v: f32,
    /// Twice the acceleration that would keep the limit without ramps.
    a: f32,
    /// The change of speed up to the limit.
    dv: f32,
    /// [`Law::margin`] at this place. The value is negative, because the profile exceeds the limit.
    margin: f32,
}

/// The next step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step {
    /// Search the next anchor to try, from block `next` on.
    Seek,
    /// Collect the blocks of both spans.
    Gather,
    /// Compare the profile with the blocks.
    Compare,
    /// Search the acceleration (0) or deceleration (1) for the worst limit. The first number of
    /// [`Ease::less`] is too small, the second is large enough. The last field is the next trial, if known.
    Search(usize, [u8; 2], Option<u8>),
    /// The anchor stays. Try to move it into the slow block: see [`super::valley`].
    Valley(valley::Step),
    /// A removed anchor permits a higher speed at the end of its span: the forward pass runs again.
    Faster,
}

/// Tries to remove the anchors one after the other, from the front to the last anchor with a final speed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trial {
    pub step: Step,
    /// First block of the first span, the anchor after this span, and the end of the second span.
    pub from: usize,
    pub at: usize,
    pub to: usize,
    pub cursor: Place,
    /// The last anchor with a final speed.
    pub last: usize,
    /// Both spans. After the comparison begins, the first one is the joined span.
    pub spans: [Span; 2],
    /// Speeds at the ends of both spans.
    pub speeds: [Speed; 3],
    /// Time of the current plan.
    pub time: f32,
    pub ease: Ease,
    pub law: Law,
    pub search: Search,
    pub fit: Fit,
    /// Stored profiles of planned spans: first block, highest speed, time. The index is the remainder of the
    /// first block's number.
    known: [(usize, f32, f32); KNOWN],
    /// Whether this is the first pass, which tries only anchors whose speed is below their limit.
    first: bool,
}

/// A block that is being compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub next: usize,
    /// Distance from the start of the span, LSB 2^-44 mm.
    pub way: i64,
}

/// The search for the limits that a profile may use.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search {
    /// The worst limits that the profile exceeds while the speed rises, and while the speed falls.
    worst: [Option<Excess>; 2],
    /// The last trial and its margin to the limit.
    point: [f32; 2],
    /// Remaining rounds.
    pub rounds: u8,
}

/// Data to fit a profile to the blocks of one span.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// Length of the profile before its first block, LSB 2^-44 mm.
    pub head: i64,
    /// Whether the span belongs to a valley.
    pub fitting: bool,
}

impl Trial {
    pub const NONE: Self = Self {
        step: Step::Seek,
        from: 0,
        at: 0,
        to: 0,
        cursor: Place { next: 1, way: 0 },
        last: 0,
        spans: [Span::NONE; 2],
        speeds: [Speed::ZERO; 3],
        time: 0.0,
        ease: Ease::NONE,
        law: Law::NONE,
        search: Search { worst: [None; 2], point: [0.0; 2], rounds: 0 },
        fit: Fit { head: 0, fitting: false },
        known: [UNKNOWN; KNOWN],
        first: true,
    };

    /// A pass that tries all anchors up to the block `last`.
    pub fn new(last: usize) -> Self {
        Self { last, ..Self::NONE }
    }

    /// The profile of both spans with the acceleration of `ease`. Returns `None` if the profile does not
    /// reach the speed at the end. The end speed stays, because later blocks rely on it.
    fn law(&self, ease: Ease) -> Option<Law> {
        let [v_in, _, v_end] = self.speeds;
        let mut span = self.spans[0];
        span.limits.ease(ease);
        span.joins(v_in, v_end).then(|| Law::new(&span, v_in, v_end, true))
    }

    /// Drops the stored profiles. Call this function when the plan has changed.
    pub fn forget(&mut self) {
        self.known = [UNKNOWN; KNOWN];
    }

    /// Begins to compare a profile with all blocks.
    fn compare(&mut self, law: Law) {
        self.step = Step::Compare;
        self.law = law;
        (self.cursor.next, self.cursor.way) = (self.from, self.fit.head);
        self.search.worst = [None; 2];
    }
}

impl Excess {
    /// The excess over the limit `v` between two distances. Also returns its side: 0 if the speed rises, 1 if
    /// the speed falls. Returns `None` if a lower acceleration does not help.
    fn new(law: &mut Law, v: f32, [from, to]: [f32; 2], length: f32) -> Option<(usize, Self)> {
        let [v_in, v_out] = law.ends();
        let (side, way, low, at) = if to <= law.reaches_at() {
            (0, to, v_in, to)
        } else if from >= law.brakes_at() {
            (1, length - from, v_out, from)
        } else {
            return None;
        };
        let dv = v - low;
        (v > low).then(|| (side, Self { way, v, a: dv * (v + low) / way, dv, margin: law.margin(v, at) }))
    }
}

impl Excess {
    /// Approximate [`Ease::less`] that just keeps the limit. The guess leaves out the ramp at the higher
    /// speed, and uses the mean of both end speeds as mean speed. With jerk j and time t, a·t − a²/(2j) = dv.
    fn guess(&self, limits: &Limits, side: usize) -> u8 {
        let (a, j) = if side == 0 { (limits.a_up, limits.jerk(0)) } else { (limits.a_down, limits.jerk(3)) };
        let t = 2.0 * self.dv / self.a;
        let needed = j * (t - sqrt_f32(max(t * t - 2.0 * self.dv / j, 0.0)));
        let part = min(max(needed / a, 0.0), 1.0);
        ((256.0 * (1.0 - part)) as u8).saturating_add(1)
    }
}

impl<const AXES: usize, const BLOCKS: usize> Ring<'_, AXES, BLOCKS> {
    /// Does some steps of a trial. Returns `true` when all anchors are tried, or speeds behind a removed one may rise.
    #[inline(never)]
    pub(super) fn trials(&mut self, pass: &mut Trial, valley: &mut Valley, work: &mut usize) -> bool {
        while *work > 0 {
            spend(work, if matches!(pass.step, Step::Seek) { SEEK } else { TRIAL });
            match pass.step {
                Step::Seek => {
                    if self.seek(pass, valley) {
                        return true;
                    }
                }
                Step::Gather => self.gather(pass),
                Step::Compare => self.compare(pass, valley),
                Step::Search(side, between, first) => self.search(pass, side, between, first),
                Step::Valley(step) => self.valley(pass, valley, step),
                Step::Faster => return true,
            }
        }
        false
    }

    /// The ease of the span that begins with the block `from`.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn ease(&self, from: usize) -> Ease {
        match self.blocks.get(from + 1) {
            Some(second) if !second.is(Marks::ANCHOR) => second.ease(),
            _ => Ease::NONE,
        }
    }

    /// Limits the highest speed of the span that begins with the block `from`.
    pub(super) fn lower_peak(&mut self, from: usize, v: f32) {
        let mut ease = self.ease(from);
        ease.v = v;
        if let Some(second) = self.blocks.get_mut(from + 1) {
            second.keep_ease(ease);
        }
    }

    /// Moves on to the next anchor to try. Returns `true` if there is none.
    fn seek(&mut self, pass: &mut Trial, valley: &mut Valley) -> bool {
        for _ in 0..WALK {
            if pass.cursor.next >= pass.last && core::mem::take(&mut pass.first) {
                (pass.from, pass.cursor.next) = (0, 1);
            }
            if pass.cursor.next >= pass.last {
                return true;
            }
            let Some(block) = self.blocks.get(pass.cursor.next) else { return true };
            let anchor = block.is(Marks::ANCHOR);
            let untried = block.joint.is_open()
                && !(pass.first
                    && block.may_have_valleys()
                    && speed_f32(block.v_reached.speed_by_call().to_bits()) * RISE >= block.cap());
            if anchor && untried && self.is_planned(pass.from) && self.is_planned(pass.cursor.next) {
                pass.at = pass.cursor.next;
                if pass.first && block.may_have_valleys() {
                    self.look_further(pass, valley);
                    return false;
                }
                pass.cursor.next = pass.from;
                pass.spans = [Span::NONE; 2];
                pass.step = Step::Gather;
                return false;
            }
            if anchor {
                pass.from = pass.cursor.next;
            }
            pass.cursor.next += 1;
        }
        false
    }

    /// Whether the span that begins with block `k` keeps the limits of all its blocks at the highest possible
    /// speed.
    pub(super) fn is_planned(&self, k: usize) -> bool {
        self.blocks.get(k).is_some_and(|block| block.is(Marks::CHECKED) && !block.is(Marks::FLAT))
    }

    /// Final speed at an anchor, or at the end of the ring.
    pub(super) fn final_speed(&self, k: usize) -> Speed {
        match self.blocks.get(k) {
            Some(_) if k == 0 => self.start,
            Some(block) => block.v_reached.speed_by_call(),
            None => Speed::ZERO,
        }
    }

    /// Keeps the anchor and ends its trial.
    fn keep_anchor(&mut self, pass: &mut Trial) {
        if self.blocks.get(pass.at).is_some_and(|block| block.may_have_valleys()) {
            if pass.first && !pass.fit.fitting {
                (pass.from, pass.cursor.next) = (pass.at, pass.at + 1);
                pass.step = Step::Seek;
            } else {
                pass.step =
                    Step::Valley(if pass.fit.fitting { valley::Step::Weigh } else { valley::Step::Look });
            }
            return;
        }
        self.pass_anchor(pass);
    }

    /// Goes on to the next anchor; the current one is not tried again.
    pub(super) fn pass_anchor(&mut self, pass: &mut Trial) {
        if let Some(block) = self.blocks.get_mut(pass.at) {
            block.joint.close();
            self.counts.untried = self.counts.untried.saturating_sub(1);
        }
        pass.from = pass.at;
        pass.cursor.next = pass.at + 1;
        pass.step = Step::Seek;
    }

    /// Collects the blocks of both spans.
    fn gather(&mut self, pass: &mut Trial) {
        for _ in 0..WALK {
            match self.blocks.get(pass.cursor.next) {
                Some(block) if pass.cursor.next <= pass.at || !block.is(Marks::ANCHOR) => {
                    let last = self.scope.open && pass.cursor.next + 1 == self.blocks.len();
                    let share = self.tail.share(last);
                    let [first, second] = &mut pass.spans;
                    if pass.cursor.next < pass.at { first } else { second }.add(block, share);
                    pass.cursor.next += 1;
                }
                _ => return self.weigh(pass),
            }
        }
    }

    /// Starts the comparison: both spans are known, and the second one ends at block `next`.
    fn weigh(&mut self, pass: &mut Trial) {
        let to = pass.cursor.next;
        pass.to = to;
        let speeds = [pass.from, pass.at, to].map(|k| self.final_speed(k));
        if to > pass.last || to - pass.from > self.depth / PART {
            return self.keep_anchor(pass);
        }
        let [first, second] = pass.spans;
        let (before, time) = self.law_of(pass, pass.from, first, [speeds[0], speeds[1]]);
        let (behind, time_behind) = self.law_of(pass, pass.at, second, [speeds[1], speeds[2]]);
        let v = speed_f32(speeds[1].to_bits()) * RISE;
        // If the profiles on both sides are faster than the anchor, the anchor stays. Exception: the anchor
        // could be faster than planned, and may become the place before a valley.
        let slow = self.blocks.get(pass.at).is_some_and(|at| at.may_have_valleys() && at.cap() > v);
        if before > v && behind > v && !slow {
            return self.keep_anchor(pass);
        }
        let [first, second] = &mut pass.spans;
        first.append(second);
        pass.speeds = speeds;
        pass.time = (time + time_behind) * GAIN;
        (pass.ease, pass.search.rounds) = (Ease::NONE, ROUNDS);
        self.try_law(pass);
    }

    /// Highest speed and time of the planned profile of the span that begins with the block `from`.
    pub(super) fn law_of(
        &self,
        pass: &mut Trial,
        from: usize,
        mut span: Span,
        [v_in, v_out]: [Speed; 2],
    ) -> (f32, f32) {
        let known = &mut pass.known[from % KNOWN];
        if known.0 != from {
            span.limits.ease(self.ease(from));
            let law = Law::new(&span, v_in, v_out, true);
            *known = (from, law.peak(), law.time());
        }
        (known.1, known.2)
    }

    /// Begins to compare the profile of the current acceleration with all blocks, if the profile saves time.
    pub(super) fn try_law(&mut self, pass: &mut Trial) {
        match pass.law(pass.ease) {
            Some(law) if law.time() < pass.time => pass.compare(law),
            _ => self.keep_anchor(pass),
        }
    }

    /// Compares the profile with some of the blocks.
    fn compare(&mut self, pass: &mut Trial, valley: &mut Valley) {
        let length = to_f32(pass.spans[0].length) * DISTANCE_LSB;
        for _ in 0..STEPS {
            let block = match self.blocks.get(pass.cursor.next) {
                Some(block) if pass.cursor.next < pass.to => block,
                _ => return self.compared(pass, valley),
            };
            let start = to_f32(pass.cursor.way.max(0)) * DISTANCE_LSB;
            pass.cursor.way += block.length;
            let end = to_f32(pass.cursor.way.min(pass.spans[0].length)) * DISTANCE_LSB;
            let cap = if pass.cursor.next > pass.from { block.cap() } else { f32::MAX };
            for (v, places) in [(cap, [start; 2]), (block.speed(), [start, end])] {
                if pass.law.keeps(v, places[0], places[1]) {
                    continue;
                }
                let Some((side, excess)) = Excess::new(&mut pass.law, v, places, length) else {
                    return self.slow_peak(pass, v);
                };
                if let Some(worst) = pass.search.worst.get_mut(side)
                    && worst.is_none_or(|worst| excess.a < worst.a)
                {
                    *worst = Some(excess);
                }
            }
            pass.cursor.next += 1;
        }
    }

    /// Lowers the highest speed to `v`, because the peak lies in a block of this speed.
    fn slow_peak(&mut self, pass: &mut Trial, v: f32) {
        let ends = pass.speeds[0].max(pass.speeds[2]);
        if pass.search.rounds == 0 || v < speed_f32(ends.to_bits()) {
            return self.keep_anchor(pass);
        }
        pass.search.rounds -= 1;
        pass.ease.v = v;
        self.try_law(pass);
    }

    /// Evaluates the comparison after all blocks.
    fn compared(&mut self, pass: &mut Trial, valley: &mut Valley) {
        let [up, down] = pass.search.worst;
        if up.is_none() && down.is_none() {
            return if pass.fit.fitting { self.fitted(pass, valley) } else { self.do_without(pass) };
        }
        if pass.search.rounds == 0 {
            return self.keep_anchor(pass);
        }
        pass.search.rounds -= 1;
        let side = usize::from(up.is_none());
        let less = pass.ease.less[side];
        let (Some(worst), false) = (up.or(down), less >= MOST) else { return self.keep_anchor(pass) };
        pass.search.point = [f32::from(less), worst.margin];
        pass.step = Step::Search(side, [less, MOST], Some(worst.guess(&pass.spans[0].limits, side)));
    }

    /// Does some steps of the search.
    fn search(
        &mut self,
        pass: &mut Trial,
        side: usize,
        [mut fast, mut slow]: [u8; 2],
        mut first: Option<u8>,
    ) {
        let Some(Excess { way, v, .. }) = pass.search.worst.get(side).copied().flatten() else {
            return self.keep_anchor(pass);
        };
        let length = to_f32(pass.spans[0].length) * DISTANCE_LSB;
        let at = if side == 0 { way } else { length - way };
        for _ in 0..LAWS {
            if slow - fast <= 1 {
                pass.ease.less[side & 1] = slow;
                return self.try_law(pass);
            }
            let less = first.take().unwrap_or(fast + (slow - fast) / 2).max(fast + 1).min(slow - 1);
            let mut ease = pass.ease;
            ease.less[side & 1] = less;
            // A profile that does not reach the planned end speed keeps the limit.
            let margin = pass.law(ease).map_or(f32::MAX, |mut law| law.margin(v, at));
            if margin == f32::MAX {
                slow = less;
                continue;
            }
            let [x, before] = core::mem::replace(&mut pass.search.point, [f32::from(less), margin]);
            let per_step = (margin - before) / (f32::from(less) - x);
            if margin >= 0.0 {
                slow = less;
                if margin < per_step {
                    // The margin one step smaller is too fast.
                    fast = less - 1;
                }
            } else {
                fast = less;
            }
            // The root of the secant, rounded up.
            let root = f32::from(less) - margin / per_step;
            first = (root > 0.0 && root < f32::from(MOST)).then(|| root as u8 + 1);
        }
        pass.step = Step::Search(side, [fast, slow], first);
    }

    /// Updates the plan after a change of the span that begins with the anchor `block`; `v_out` is its
    /// planned end speed. Computes the permitted start speed.
    pub(super) fn renew(&mut self, block: usize, span: &Span, v_out: Speed) {
        let cap = self.blocks.get(block).map_or(0.0, |block| block.cap());
        if block > 0
            && let Some(block) = self.blocks.get_mut(block)
        {
            let v = Planned::below_by_call(span.enter(v_out, cap));
            block.v_in = v.min(block.v_in).max(block.v_reached);
        }
    }

    /// Removes the anchor, because the profile keeps all limits and is faster.
    fn do_without(&mut self, pass: &mut Trial) {
        let to = pass.to;
        pass.known[pass.at % KNOWN] = UNKNOWN;
        pass.known[pass.from % KNOWN] = (pass.from, pass.law.peak(), pass.law.time());
        if let Some(block) = self.blocks.get_mut(pass.at) {
            block.give_way();
            block.joint.close();
            self.counts.untried = self.counts.untried.saturating_sub(1);
            self.counts.through += 1;
        }
        let mut span = pass.spans[0];
        span.limits.ease(pass.ease);
        self.renew(pass.from, &span, pass.speeds[2]);
        // The marks of the second span are no longer valid.
        if pass.at + 1 < to
            && let Some(second) = self.blocks.get_mut(pass.at + 1)
        {
            second.forget();
        }
        if let Some(second) = self.blocks.get_mut(pass.from + 1) {
            second.keep_ease(pass.ease);
        }
        pass.cursor.next = pass.at + 1;
        pass.step = Step::Seek;
        let Some(end) = self.blocks.get_mut(to) else { return };
        let [planned, reached] = [end.v_in, end.v_reached].map(|v| speed_f32(v.speed_by_call().to_bits()));
        if planned <= reached * HARDLY {
            end.v_in = end.v_reached;
            return;
        }
        // The new profile may be faster there, and so the spans behind.
        pass.step = Step::Faster;
        if let Some(first) = self.blocks.get_mut(pass.from) {
            first.marks.set(Marks::CHECKED, false);
        }
    }
}
