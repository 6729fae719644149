//! Moves anchors (points where acceleration is zero) from the ends of a slow block into the block, if this
//! saves time. This is done with the slope HSC and NO_OPT=0.
//!
//! An anchor at the end of a slow block makes acceleration zero just where the speed reaches the block's
//! limit. The fastest motion brakes farther into the slow block, and speeds up again before the block's end.
//! So the anchor moves into the slow block, and gets a lower speed: the block becomes a *valley*. The part
//! between the anchor and the end of the block is *lent* to the span of the faster block. In this span, the
//! limit of the lent part is not checked, because the lower speed at the anchor keeps the limit.
//!
//! **Size.** Let J be the jerk, V the speed limit of the slow block, and V − h the speed at the anchor. The
//! ramp from the anchor to the end of the block takes t = √(2h/J) and covers t·(V − 2h/3).
//!
//! **Why the limit holds.** A motion starts at the anchor with the speed w and zero acceleration. At the
//! distance s = w·t + J·t³/6, its speed is at most v = w + J·t²/2. At a given s, v grows with w where w >
//! v/2, and falls where w is smaller. So the highest v belongs to the largest or to the smallest w. For w = V
//! − h, v is V at the end of the block. For w = 0, v is below V if h ≤ V/8. So any motion with zero
//! acceleration and at most the speed V − h at the anchor keeps the limit. The same holds backward, for a
//! motion that brakes to the anchor. This also covers a hold, another override, and new blocks after the lent
//! part. When the planned override changes, the slow block gets all of its lent parts back
//! ([`super::Lookahead::set_level`]).
//!
//! **Choice.** A valley costs time inside the slow block and saves time outside. If the faster block has the
//! speed F, the best h is about V·(1 − V/F)/4, at most V/8. A slow block that is too short for two anchors
//! gets one valley from end to end. The planner tries up to three valleys, and uses the first one that takes
//! less time than the current plan. The speeds at the other ends of the spans stay, because later blocks rely
//! on them.
//!
//! **Memory.** A block that is cut uses two places of the ring. Both parts share its curve.
//!
//! An anchor may also move for another reason: [`mod@self::shift`].
mod shift;

use super::block::{Block, Marks};
use super::ease::{self, Ease, GAIN, Trial};
use super::law::{Law, RISE, Span, length_mm};
use super::planned::Planned;
use super::ring::Ring;
use crate::math::float::{max, min, to_bits};
use crate::math::root::sqrt_f32;
use crate::quantity::{Speed, speed_bits};

/// Places of the ring that stay free for cuts.
pub(super) const SPARE: usize = 8;
/// Blocks per call that are counted.
const WALK: usize = 32;
/// Valleys to try: a factor for the best depth, and whether both sides have the same depth.
const DEPTHS: [(f32, bool); 3] = [(1.0, false), (1.0, true), (0.4, false)];
/// Speeds with a smaller ratio count as equal.
const SAME: f32 = 1.0 + 1.0 / 65_536.0;
/// Deepest valley, as a part of the speed. Up to 0.133, a motion from a stop at the anchor also keeps the
/// limit.
const DEEPEST: f32 = 0.125;
/// Depth of the best valley, for a slow block whose speed is small compared with the fast block.
const BEST: f32 = 1.0 / 3.9;
/// A valley is shorter by this factor than its jerk permits.
const SHORTER: f32 = 1.0 - 1.0 / 1024.0;

/// A ramp from the anchor, which has a lower speed and zero acceleration, up to the limit at the end of a
/// slow block.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    /// Speed at the anchor.
    v: f32,
    /// Distance of the anchor from the end of the block.
    way: f32,
}

impl Side {
    /// `v`: limit; `j`: jerk; `t`: time from the anchor to the end of the block.
    fn new(v: f32, j: f32, t: f32) -> Self {
        let gain = 0.5 * j * t * t;
        Self { v: v - gain, way: t * (v - gain * (2.0 / 3.0)) * SHORTER }
    }

    /// Time of the best ramp for a span with this peak; `a` is the largest acceleration.
    fn best(v: f32, peak: f32, j: f32, a: f32, part: f32) -> f32 {
        let depth = v * part * min(DEEPEST, BEST * max(0.0, 1.0 - v / peak));
        min(sqrt_f32(2.0 * depth / j), a / j)
    }

    /// Time of a ramp that covers this distance.
    fn fill(v: f32, j: f32, way: f32) -> f32 {
        let mut t = way / v;
        for _ in 0..3 {
            let square = j * t * t;
            t += (way - t * (v - square * (1.0 / 3.0))) / (v - square);
        }
        t
    }
}

/// The next step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step {
    /// Find out which span is slow.
    Look,
    /// Collect the blocks.
    TakeIn,
    /// Compute the time of the current plan.
    Measure,
    /// Compute the depth, or the distance by which the anchor moves.
    Weigh,
    /// Fit the profile of one of the spans to its blocks.
    Fit(u8),
    /// Make the change.
    Do,
}

impl Step {
    /// The next step after the profile of this span fits its blocks.
    const fn behind(which: u8) -> Self {
        if which < 3 { Self::Fit(which + 1) } else { Self::Do }
    }
}

/// Up to three spans; the middle one is slow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Valley {
    /// The span whose profile is being fitted to its blocks: before the slow one (1), after it (2), or the
    /// slow one (3).
    fitting: u8,
    /// Number of valleys tried.
    tried: u8,
    /// First blocks of the spans, and the end of the last span.
    edges: [usize; 4],
    spans: [Span; 3],
    speeds: [Speed; 4],
    /// Highest speeds of the spans on both sides.
    peaks: [f32; 2],
    /// Time of the current plan. Then times of the new profiles: of the span before the slow one, of the span
    /// after it, and of the slow span.
    before: f32,
    times: [f32; 3],
    cut: Cut,
    eases: [Ease; 3],
    shift: Shift,
}

/// The cuts of a slow block.
#[derive(Clone, Copy, Debug)]
struct Cut {
    /// Distances of the cuts from the block's start and from its end.
    cuts: [i64; 2],
    /// Speeds at the cuts.
    v: [f32; 2],
    /// Whether there is only one valley, from end to end.
    meet: bool,
}

/// The shift of an anchor, if it moves in place of a valley.
#[derive(Clone, Copy, Debug)]
struct Shift {
    on: bool,
    /// The old place of the anchor, and the number of whole blocks by which it moves.
    was: usize,
    moved: i64,
    /// The search for the new place: number of steps, distances into the block, and the best speed and time
    /// found.
    steps: u8,
    between: [i64; 2],
    best: Option<(Speed, f32)>,
}

impl Cut {
    const NONE: Self = Self { cuts: [0; 2], v: [0.0; 2], meet: false };
}

impl Shift {
    const NONE: Self = Self { on: false, was: 0, moved: 0, steps: 0, between: [0; 2], best: None };
}

impl Valley {
    pub const NONE: Self = Self {
        fitting: 0,
        tried: 0,
        edges: [0; 4],
        spans: [Span::NONE; 3],
        speeds: [Speed::ZERO; 4],
        peaks: [0.0; 2],
        before: 0.0,
        times: [0.0; 3],
        cut: Cut::NONE,
        eases: [Ease::NONE; 3],
        shift: Shift::NONE,
    };

    /// Sum of the times of all new profiles.
    fn time(&self) -> f32 {
        self.times.iter().sum()
    }

    fn enters(&self) -> bool {
        self.edges[0] < self.edges[1]
    }

    fn leaves(&self) -> bool {
        self.edges[2] < self.edges[3]
    }
}

impl<const AXES: usize, const BLOCKS: usize> Ring<'_, AXES, BLOCKS> {
    /// Does one step.
    pub(super) fn valley(&mut self, pass: &mut Trial, valley: &mut Valley, step: Step) {
        match step {
            Step::Look => self.look(pass, valley),
            Step::TakeIn => self.take_in(pass, valley),
            Step::Measure => self.measure(pass, valley),
            Step::Fit(which) => self.fit(pass, valley, which),
            Step::Do if valley.shift.on => self.do_shift(pass, valley),
            Step::Do => self.do_valley(pass, valley),
            Step::Weigh if valley.shift.on => self.weigh_shift(pass, valley),
            Step::Weigh => self.weigh_dip(pass, valley),
        }
    }

    /// Goes on to the next anchor. `tried`: the current anchor is not tried again.
    fn leave_anchor(&mut self, pass: &mut Trial, valley: &mut Valley, tried: bool) {
        (pass.fit.fitting, pass.fit.head) = (false, 0);
        *valley = Valley::NONE;
        if tried {
            return self.pass_anchor(pass);
        }
        (pass.from, pass.cursor.next) = (pass.at, pass.at + 1);
        pass.step = ease::Step::Seek;
    }

    fn limit(&self, k: usize) -> f32 {
        self.blocks.get(k).map_or(0.0, |block| block.v())
    }

    fn look(&mut self, pass: &mut Trial, valley: &mut Valley) {
        let at = pass.at;
        let to = self.anchor_behind(at);
        if to > pass.last || at == 0 {
            return self.leave_anchor(pass, valley, true);
        }
        let (before, behind) = (self.limit(at - 1), self.limit(at));
        let v = min(before, behind);
        if self.final_speed(at) <= Speed::ZERO || self.blocks.get(at).is_none_or(|at| v > at.cap() * SAME) {
            return self.leave_anchor(pass, valley, true);
        }
        let mut edges = [pass.from, at, to, to];
        if before > v * RISE {
            // The anchor moves into the slow span after it.
            let leaves = to < self.blocks.len()
                && self.limit(to) > self.limit(to - 1) * RISE
                && self.blocks.get(to).is_some_and(|block| {
                    block.cap() * SAME >= self.limit(to - 1)
                        && block.may_have_valleys()
                        && block.joint.is_open()
                });
            if leaves {
                let behind = self.anchor_behind(to);
                if behind > pass.last {
                    return self.leave_anchor(pass, valley, false);
                }
                if self.is_planned(to) {
                    edges[3] = behind;
                }
            }
        } else if behind > v * RISE {
            edges = [pass.from, pass.from, at, to];
        } else {
            return self.leave_anchor(pass, valley, true);
        }
        let [a, b, c, d] = edges;
        let checked =
            [(a, b), (b, c), (c, d)].into_iter().all(|(from, to)| from == to || self.is_planned(from));
        let last = self.scope.open && d == self.blocks.len();
        if !checked || last || self.blocks.len() + 2 > self.blocks.capacity() {
            return self.leave_anchor(pass, valley, true);
        }
        *valley = Valley { edges, ..Valley::NONE };
        pass.cursor.next = a;
        pass.step = ease::Step::Valley(Step::TakeIn);
    }

    fn take_in(&mut self, pass: &mut Trial, valley: &mut Valley) {
        let [_, b, c, d] = valley.edges;
        for _ in 0..WALK {
            if pass.cursor.next >= d {
                let known = valley.shift.moved > 0;
                pass.step = ease::Step::Valley(if known { Step::Weigh } else { Step::Measure });
                return;
            }
            let Some(block) = self.blocks.get(pass.cursor.next) else {
                return self.leave_anchor(pass, valley, true);
            };
            let [first, middle, last] = &mut valley.spans;
            let span = if pass.cursor.next < b {
                first
            } else if pass.cursor.next < c {
                middle
            } else {
                last
            };
            span.add(block, None);
            pass.cursor.next += 1;
        }
    }

    fn measure(&mut self, pass: &mut Trial, valley: &mut Valley) {
        valley.speeds = valley.edges.map(|k| self.final_speed(k));
        let [a, b, c, d] = valley.edges;
        let [v0, v1, v2, v3] = valley.speeds;
        let [first, middle, last] = valley.spans;
        let spans = [(a, b, first, v0, v1), (b, c, middle, v1, v2), (c, d, last, v2, v3)];
        for (k, (from, to, span, v_in, v_out)) in spans.into_iter().enumerate() {
            if from == to {
                continue;
            }
            let (peak, time) = self.law_of(pass, from, span, [v_in, v_out]);
            valley.before += time;
            match k {
                0 => valley.peaks[0] = peak,
                2 => valley.peaks[1] = peak,
                _ => {}
            }
        }
        pass.step = ease::Step::Valley(Step::Weigh);
    }

    /// Tries the next depth.
    fn weigh_dip(&mut self, pass: &mut Trial, valley: &mut Valley) {
        let [a, b, c, d] = valley.edges;
        let (Some(first), Some(last)) = (self.blocks.get(b), self.blocks.get(c - 1)) else {
            return self.leave_anchor(pass, valley, true);
        };
        let lengths = [first, last].map(length_mm);
        let [first_limits, last_limits] = [first, last].map(Block::limits_by_call);
        let [j_in, j_out] = [first_limits.jerk(3), last_limits.jerk(0)];
        let [v_in, v_out] = [first_limits.v, last_limits.v];
        if let Some(&(part, common)) = DEPTHS.get(usize::from(valley.tried)) {
            valley.tried += 1;
            pass.step = ease::Step::Valley(Step::Weigh);
            let peaks = valley.peaks;
            let t_in = if a < b { Side::best(v_in, peaks[0], j_in, first_limits.a_down, part) } else { 0.0 };
            let t_out = if c < d { Side::best(v_out, peaks[1], j_out, last_limits.a_up, part) } else { 0.0 };
            let (t_in, t_out) = if common {
                if a == b || c == d || v_in != v_out {
                    return;
                }
                let depth = 0.25 * (j_in * t_in * t_in + j_out * t_out * t_out);
                (sqrt_f32(2.0 * depth / j_in), sqrt_f32(2.0 * depth / j_out))
            } else {
                (t_in, t_out)
            };
            let mut enter = Side::new(v_in, j_in, t_in);
            let mut leave = Side::new(v_out, j_out, t_out);
            let mut meet = false;
            if b + 1 == c {
                // A single block: two valleys, or one from end to end.
                let most = lengths[0] * (1.0 - 1.0 / 16.0);
                if a < b && c < d && enter.way + leave.way > most {
                    meet = true;
                    let t = Side::fill(v_in, max(j_in, j_out), 0.5 / SHORTER * lengths[0]);
                    enter = Side::new(v_in, max(j_in, j_out), t);
                    leave = enter;
                } else if enter.way > most {
                    enter = Side::new(v_in, j_in, Side::fill(v_in, j_in, most));
                } else if leave.way > most {
                    leave = Side::new(v_out, j_out, Side::fill(v_out, j_out, most));
                }
            } else {
                let most = lengths.map(|length| length * (1.0 - 1.0 / 16.0));
                if enter.way > most[0] {
                    enter = Side::new(v_in, j_in, Side::fill(v_in, j_in, most[0]));
                }
                if leave.way > most[1] {
                    leave = Side::new(v_out, j_out, Side::fill(v_out, j_out, most[1]));
                }
            }
            // Without a gain, the next depth is tried.
            let _ = self.try_dip(pass, valley, [enter, leave], meet);
            return;
        }
        self.leave_anchor(pass, valley, true);
    }

    /// Tries a valley with these speeds and distances. Returns `None` if there is no gain.
    fn try_dip(
        &mut self,
        pass: &mut Trial,
        valley: &mut Valley,
        [enter, leave]: [Side; 2],
        meet: bool,
    ) -> Option<()> {
        let [a, b, c, d] = valley.edges;
        let (first, last) = (self.blocks.get(b)?, self.blocks.get(c - 1)?);
        let mut slow = valley.spans[1];
        valley.cut.cuts = [enter, leave].map(|side| to_bits::<44>(side.way));
        if meet {
            valley.cut.cuts[0] = slow.length / 2;
            valley.cut.cuts[1] = slow.length - valley.cut.cuts[0];
        }
        let [mut v_in, mut v_out] = [valley.speeds[1], valley.speeds[2]];
        valley.cut.meet = meet;
        valley.cut.v = [enter.v, leave.v];
        valley.times = [0.0; 3];
        valley.eases = [self.ease(a), self.ease(c), self.ease(b)];
        if a < b {
            if valley.cut.cuts[0] <= 0 {
                return None;
            }
            v_in = Speed::from_bits(speed_bits(enter.v));
            let mut fast = valley.spans[0];
            fast.add_piece(&first.limits_by_call(), valley.cut.cuts[0]);
            fast.limits.ease(valley.eases[0]);
            if !fast.joins(valley.speeds[0], v_in) {
                return None;
            }
            valley.times[0] = Law::new(&fast, valley.speeds[0], v_in, true).time();
            slow.shorten(valley.cut.cuts[0]);
        }
        if c < d {
            if valley.cut.cuts[1] <= 0 {
                return None;
            }
            v_out = Speed::from_bits(speed_bits(leave.v));
            let mut fast = valley.spans[2];
            fast.add_piece(&last.limits_by_call(), valley.cut.cuts[1]);
            fast.limits.ease(valley.eases[1]);
            if !fast.joins(v_out, valley.speeds[3]) {
                return None;
            }
            valley.times[1] = Law::new(&fast, v_out, valley.speeds[3], true).time();
            slow.shorten(valley.cut.cuts[1]);
        }
        if !meet {
            if slow.length <= 0 {
                return None;
            }
            slow.limits.ease(self.ease(b));
            if !slow.joins(v_in, v_out) {
                return None;
            }
            valley.times[2] = Law::new(&slow, v_in, v_out, true).time();
        }
        if valley.time() >= valley.before * GAIN {
            return None;
        }
        pass.step = ease::Step::Valley(Step::Fit(1));
        Some(())
    }

    /// Fits the profile of one of the outer spans to its blocks.
    fn fit(&mut self, pass: &mut Trial, valley: &mut Valley, which: u8) {
        let [a, b, c, d] = valley.edges;
        (valley.fitting, pass.fit.fitting) = (which, true);
        let (from, to, cut, mut span, ease) = match which {
            1 => (a, b, valley.cut.cuts[0], valley.spans[0], valley.eases[0]),
            2 => (c, d, valley.cut.cuts[1], valley.spans[2], valley.eases[1]),
            _ => (b, c, 0, valley.spans[1], valley.eases[2]),
        };
        if to <= from + 1 && (cut <= 0 || !valley.shift.on) {
            pass.step = ease::Step::Valley(Step::behind(which));
            return;
        }
        let Some(block) = self.blocks.get(if which == 1 { b } else { c - 1 }) else {
            return self.leave_anchor(pass, valley, true);
        };
        let [enter, leave] = valley.cut.v.map(|v| Speed::from_bits(speed_bits(v)));
        let [v_in, v_out] = match which {
            1 => [valley.speeds[0], enter],
            2 => [leave, valley.speeds[3]],
            _ => [
                if valley.enters() { enter } else { valley.speeds[1] },
                if valley.leaves() { leave } else { valley.speeds[2] },
            ],
        };
        pass.speeds = [v_in, v_out, v_out];
        // A moved anchor adds a piece, which is compared too.
        let (mut from, mut to) = (from, to);
        let mut before = 0;
        if valley.shift.on && cut > 0 {
            if which == 1 {
                to += 1;
            } else {
                from -= 1;
                before = block.length;
            }
        }
        pass.fit.head = match which {
            1 => 0,
            2 => cut - before,
            _ => {
                let [near, far] =
                    [(valley.enters(), valley.cut.cuts[0]), (valley.leaves(), valley.cut.cuts[1])]
                        .map(|(is, cut)| if is { cut } else { 0 });
                span.shorten(near + far);
                -near
            }
        };
        if cut > 0 {
            span.add_piece(&block.limits_by_call(), cut);
        } else {
            span.shorten(-cut);
        }
        pass.spans[0] = span;
        pass.ease = ease;
        // The time that the other profiles leave for this span.
        if let Some(time) = valley.times.get_mut(usize::from(which) - 1) {
            *time = 0.0;
        }
        pass.time = valley.before * GAIN - valley.time();
        (pass.from, pass.to) = (from, to);
        pass.search.rounds = ease::ROUNDS;
        self.try_law(pass);
    }

    /// Continues after a profile has been fitted: it keeps the limits of the blocks.
    pub(super) fn fitted(&mut self, pass: &mut Trial, valley: &mut Valley) {
        if let Some(time) = valley.times.get_mut(usize::from(valley.fitting) - 1) {
            *time = pass.law.time();
        }
        let [first, behind, middle] = &mut valley.eases;
        *match valley.fitting {
            1 => first,
            2 => behind,
            _ => middle,
        } = pass.ease;
        pass.step = ease::Step::Valley(Step::behind(valley.fitting));
    }

    /// Cuts a block at a distance from its start. The rest becomes the next block.
    fn cut(&mut self, k: usize, distance: i64) {
        let Some(block) = self.blocks.get_mut(k) else { return };
        let mut piece = *block;
        piece.length = block.length - distance;
        piece.go_on();
        piece.highest = f32::MAX;
        block.length = distance;
        piece.marks = Marks::default();
        piece.marks.set(Marks::LONG, block.is(Marks::LONG));
        piece.marks.set(Marks::CHECKED | Marks::SMOOTH, true);
        block.marks.set(Marks::LONG, false);
        piece.give_way();
        if self.insert(k + 1, piece) {
            self.counts.through += 1;
        }
    }

    /// Makes the start of block `k` a permanent anchor with the speed `v`.
    fn dip_at(&mut self, k: usize, v: f32) {
        let Some(block) = self.blocks.get_mut(k) else { return };
        let speed = Planned::below_by_call(Speed::from_bits(speed_bits(v)));
        block.marks.set(Marks::ANCHOR | Marks::CHECKED, true);
        (block.v_in, block.v_reached, block.v_old) = (speed, speed, speed);
        block.cap = v;
        block.joint.close();
        self.counts.through -= 1;
    }

    /// Removes the limit of the transition at the start of block `k`.
    fn open_up(&mut self, k: usize, cap: f32) {
        let Some(block) = self.blocks.get_mut(k) else { return };
        let open = block.joint.is_open();
        block.give_way();
        block.joint.close();
        block.cap = cap;
        self.counts.through += 1;
        self.counts.untried -= usize::from(open).min(self.counts.untried);
    }

    /// Lends the block `k` to a faster span.
    fn lend(&mut self, k: usize) {
        if let Some(block) = self.blocks.get_mut(k) {
            block.joint.lend();
        }
    }

    fn do_valley(&mut self, pass: &mut Trial, valley: &mut Valley) {
        let plan = *valley;
        let [a, b, mut c, d] = plan.edges;
        let mut at = b;
        let mut cuts = 0;
        pass.forget();
        pass.step = ease::Step::Valley(Step::Do);
        if plan.enters() {
            self.cut(b, plan.cut.cuts[0]);
            cuts += 1;
            c += 1;
            self.open_up(b, self.limit(b - 1));
            self.lend(b);
            at = b + 1;
            self.dip_at(at, plan.cut.v[0]);
            self.keep_ease(a, plan.eases[0]);
            self.keep_ease(at, plan.eases[2]);
            let mut span = plan.spans[0];
            if let Some(piece) = self.blocks.get(b) {
                span.add(piece, None);
            }
            span.limits.ease(plan.eases[0]);
            self.renew(a, &span, Speed::from_bits(speed_bits(plan.cut.v[0])));
            if plan.leaves() {
                // The next call cuts the other end of the slow block.
                valley.edges = [at, at, c, d + 1];
                pass.last += 1;
                return;
            }
        }
        if plan.leaves() {
            self.keep_ease(b, plan.eases[2]);
            at = c - 1;
            if !plan.cut.meet {
                let length = self.blocks.get(at).map_or(0, |block| block.length);
                self.cut(at, length - plan.cut.cuts[1]);
                cuts += 1;
                (at, c) = (c, c + 1);
                self.dip_at(at, plan.cut.v[1]);
            }
            self.lend(at);
            self.open_up(c, self.limit(c));
            if let Some(block) = self.blocks.get_mut(c + 1)
                && !block.is(Marks::ANCHOR)
            {
                block.forget();
            }
            self.keep_ease(at, plan.eases[1]);
        }
        // The end of the span keeps its speed, although the new profile might permit a higher one.
        if let Some(end) = self.blocks.get_mut(d + cuts) {
            end.v_in = end.v_reached;
        }
        pass.last += cuts;
        (pass.from, pass.cursor.next) = (at, at + 1);
        (pass.fit.fitting, pass.fit.head) = (false, 0);
        *valley = Valley::NONE;
        pass.step = ease::Step::Seek;
    }

    /// Stores the ease of the span that begins with this block.
    fn keep_ease(&mut self, from: usize, ease: Ease) {
        if let Some(second) = self.blocks.get_mut(from + 1)
            && !second.is(Marks::ANCHOR)
        {
            second.keep_ease(ease);
        }
    }
}
