//! The plan of the ring: speeds at the anchors, and which transitions are anchors.
//!
//! Valleys first: a span is planned as if only its ends and its highest speed counted. If that breaks the limit of a
//! block inside, those ends of the slowest such block become anchors at which it is too fast (both, if it is too fast only
//! between them), and all sides are planned again. Acceleration
//! then vanishes only where a limit is met, not wherever a block ends. An anchor stays one until it leaves the ring, unless
//! [`super::ease`] finds a faster law without it.
//!
//! What has left the ring must not become impossible by what comes later. So a block that is slow enough only
//! because the plan ends in a standstill behind it becomes an anchor at once; only where the speed at the end of a
//! span is final, the slowing down before it counts. And when a ring is full of one span, it is cut where its slowing down would
//! begin, or behind the first quarter.
use super::ease::Trial;
use super::{Block, Limits, Lookahead, Marks, Share, UNPLANNED, max, min};
use crate::math::float::to_f32;
use crate::quantity::Speed;
use crate::slope::profile::{peak_above, speed_bits, speed_f32};
use crate::slope::ramp::Ramp;

/// Blocks without an anchor between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// Path length, LSB 2^-44 mm.
    pub length: i64,
    /// What all of them permit; of the speeds the highest.
    pub limits: Limits,
    /// The speed at its start may have been planned for another end speed.
    kept: bool,
}

impl Default for Span {
    fn default() -> Self {
        Self::NONE
    }
}

/// Where the plan stands.
#[derive(Clone, Copy, Debug)]
pub(super) enum Pass {
    /// Complete.
    Done,
    /// Every transition is an anchor: from the end to the front, so many blocks and the speed at the end of the last of
    /// them.
    Blocks(usize, Speed),
    /// Speeds from which the plan can still stop, from the end to the front.
    Backward(Backward),
    /// Speeds that can be reached, from the front to the end.
    Forward(Forward),
    /// The blocks of one span against its law.
    Inside(Inside),
    /// Two spans against one law.
    Trial(Trial),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Backward {
    /// Blocks still to pass.
    left: usize,
    /// What of the span at hand was passed, and the speed at its end.
    span: Span,
    v_out: Speed,
    /// Anchors behind this block are planned in any case, the others as long as something changes.
    until: usize,
    /// The span at hand has another end speed or other blocks than before.
    changed: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Forward {
    /// First block of the span at hand, and the first one not yet passed.
    from: usize,
    next: usize,
    span: Span,
    v_in: Speed,
    /// All speeds up to here are final, whatever comes.
    firm: bool,
    /// The last anchor with a final speed.
    last: usize,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Inside {
    forward: Forward,
    law: Law,
    /// Block to look at, and its distance from the start of the span.
    block: usize,
    at: i64,
    /// The slowest blocks that the law is too fast for: first, behind the last, their limit.
    worst: Option<(usize, usize, f32)>,
    /// Where to cut the span.
    cut: usize,
}

/// The law of a span: from one speed up to a peak and down to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law {
    up: Ramp,
    down: Ramp,
    v_in: f32,
    v_out: f32,
    peak: f32,
    length: f32,
    /// The slowing down is final.
    firm: bool,
    /// The limit asked for last, where it is reached and where it is left.
    asked: [f32; 3],
}

/// Blocks per call: with each of them about 500 instructions, fewer would cost as much for the call as for the blocks.
const STEPS: usize = 16;
/// What one call does with spans, LSB about 32 instructions: a call and the copies of the state cost 1,500.
const WORK: usize = 600;
/// What it is to take in a block, to find a speed, to make a law, and to compare a block with it.
const ADD: usize = 3;
const RAMP: usize = 14;
const LAW: usize = 50;
const COMPARE: usize = 8;

/// Some of the work of a call is done.
pub(super) fn spend(work: &mut usize, part: usize) {
    *work = work.saturating_sub(part);
}

/// Steps of the search for an end speed.
const LEAVE_STEPS: usize = 24;

/// Less is no rise of speed.
const RISE: f32 = 1.0 + 1.0 / 1024.0;

/// A distance in a span is good to this part of its length.
const DISTANCE: f32 = 1.0 / 1_048_576.0;

const LSB_44: f32 = 1.0 / (1u64 << 44) as f32;

impl Span {
    /// No block.
    pub const NONE: Self = Self { length: 0, limits: Limits::WIDEST, kept: false };

    /// Takes in a block. `share`: blocks may follow it, and their transition may need its part.
    pub fn add(&mut self, block: &Block, share: Option<&Share>) {
        match share {
            None if self.length == 0 => self.limits = block.limits,
            None => self.limits.join(&block.limits),
            Some(share) => {
                let limits = block.limits.shared(share);
                if self.length == 0 {
                    self.limits = limits;
                } else {
                    self.limits.join(&limits);
                }
            }
        }
        self.kept = block.is(Marks::KEPT) || self.length > 0;
        self.length += block.length;
    }

    /// Takes in a piece of a block beside it.
    pub fn add_piece(&mut self, limits: &Limits, length: i64) {
        let v = self.limits.v;
        self.limits.join(limits);
        self.limits.v = v;
        self.kept = true;
        self.length += length;
    }

    /// Loses a piece at an end.
    pub fn shorten(&mut self, length: i64) {
        self.kept = true;
        self.length -= length;
    }

    /// Takes in the span behind it.
    pub fn append(&mut self, other: &Self) {
        self.limits.join(&other.limits);
        self.kept = true;
        self.length += other.length;
    }

    fn millimetres(&self) -> f32 {
        to_f32(self.length) * LSB_44
    }

    pub fn faster(&self, ramp: &Ramp, low: Speed, cap: f32) -> Speed {
        faster(ramp, self.millimetres(), low, cap)
    }

    /// Highest speed at its start, at most `cap`, from which it can slow down to `v_out`. What it leaves unused may lower its highest
    /// speed below `cap`.
    pub fn enter(&self, v_out: Speed, cap: f32) -> Speed {
        self.faster(&self.limits.brake(), v_out, min(cap, self.limits.v))
    }

    /// Highest speed at its end, at most `next`; `None` if it is too short to stop.
    pub fn leave(&self, v_in: Speed, next: Speed) -> Option<Speed> {
        leave(&self.limits, self.length, self.kept, v_in, next)
    }

    /// Whether it permits both speeds and is long enough from one to the other.
    pub fn joins(&self, v_in: Speed, v_out: Speed) -> bool {
        if v_in.max(v_out).to_bits() > speed_bits(self.limits.v) {
            false
        } else if v_out < v_in {
            loses(&self.limits.brake(), self.millimetres(), v_in, v_out)
        } else {
            self.faster(&self.limits.speed_up(), v_in, self.limits.v) >= v_out
        }
    }
}

impl Law {
    pub fn new(span: &Span, v_in: Speed, v_out: Speed, firm: bool) -> Self {
        let (up, down) = (span.limits.speed_up(), span.limits.brake());
        let (v_in, v_out) = (v_in.to_bits(), v_out.to_bits());
        let low = v_in.max(v_out);
        let peak = low + peak_above(&up, &down, [v_in, v_out, low], span.length, span.limits.v);
        let [v_in, v_out, peak] = [v_in, v_out, peak].map(speed_f32);
        Self { up, down, v_in, v_out, peak, length: span.millimetres(), firm, asked: [f32::MAX; 3] }
    }

    /// Highest speed.
    pub fn peak(&self) -> f32 {
        self.peak
    }

    /// Duration, ticks.
    pub fn time(&self) -> f32 {
        let [gained, lost] = [self.peak - self.v_in, self.peak - self.v_out];
        let way = self.up.distance(self.v_in, gained)[0] + self.down.distance(self.v_out, lost)[0];
        self.up.time(gained) + self.down.time(lost) + max(self.length - way, 0.0) / self.peak
    }

    /// Where the speeding up ends.
    pub fn reaches_at(&self) -> f32 {
        self.up.distance(self.v_in, self.peak - self.v_in)[0]
    }

    /// Where the slowing down begins.
    pub fn brakes_at(&self) -> f32 {
        self.length - self.down.distance(self.v_out, self.peak - self.v_out)[0]
    }

    /// Whether its end is slower than its peak.
    fn slows_down(&self) -> bool {
        self.peak > self.v_out * RISE
    }

    /// Whether speed stays at or below `v` between the distances `from` and `to` from its start.
    pub fn keeps(&mut self, v: f32, from: f32, to: f32) -> bool {
        if v >= self.peak {
            return true;
        }
        if self.asked[0] != v {
            let reached = self.up.passes(self.v_in, self.peak - self.v_in, v - self.v_in);
            let left = self.length - self.down.passes(self.v_out, self.peak - self.v_out, v - self.v_out);
            self.asked = [v, reached, left];
        }
        let near = DISTANCE * self.length;
        to + near <= self.asked[1] || (self.firm && from - near >= self.asked[2])
    }
}

impl<const AXES: usize, const BLOCKS: usize> Lookahead<AXES, BLOCKS> {
    /// Begins to plan.
    pub(super) fn begin(&mut self) {
        let left = self.blocks.len();
        self.pass = if self.through == 0 {
            self.blockwise = true;
            Pass::Blocks(left, Speed::ZERO)
        } else {
            if self.blockwise {
                self.blockwise = false;
                for block in &mut self.blocks {
                    block.v_old = block.v_in;
                    block.marks.set(Marks::CHECKED, false);
                }
            }
            let span = Span::default();
            let until = left.min(core::mem::replace(&mut self.until, usize::MAX));
            Pass::Backward(Backward { left, span, v_out: Speed::ZERO, until, changed: true })
        };
    }

    /// Goes on; `true` when the plan is complete.
    pub(super) fn step(&mut self) -> bool {
        match self.pass {
            Pass::Blocks(left, v_out) => self.blocks(left, v_out),
            Pass::Done => true,
            _ => self.spans(),
        }
    }

    /// The same with spans of several blocks: as much as one call may do.
    #[inline(never)]
    fn spans(&mut self) -> bool {
        // Copied once in and out, as each call has its own cost too.
        let mut pass = self.pass;
        let mut work = WORK;
        while work > 0 {
            let next = match &mut pass {
                Pass::Backward(pass) => self.backward(pass, &mut work),
                Pass::Forward(pass) => self.forward(pass, &mut work),
                Pass::Inside(pass) => self.inside(pass, &mut work),
                Pass::Trial(pass) => self.trials(pass, &mut work),
                Pass::Done | Pass::Blocks(..) => break,
            };
            if let Some(next) = next {
                pass = next;
            }
        }
        self.pass = pass;
        matches!(self.pass, Pass::Done)
    }

    fn blocks(&mut self, mut left: usize, mut v_out: Speed) -> bool {
        for _ in 0..STEPS {
            // The first block's start is already decided.
            if left <= 1 {
                self.raise_first(v_out);
                return self.blocks_done();
            }
            left -= 1;
            let last = left + 1 == self.blocks.len();
            let Some(block) = self.blocks.get_mut(left) else { continue };
            let share = self.last.as_ref().filter(|_| last && self.open).map(|last| &last.share);
            let brake = share.map_or(block.limits, |share| block.limits.shared(share)).brake();
            let v = faster(&brake, length_mm(block), v_out, block.cap());
            // With no acceleration at both ends, slowing down by less may take longer: where the largest acceleration
            // is not reached, the distance from v to w goes with (v + w)·√(v − w), which grows with w up to about v/2.
            // What was planned with a lower end speed stays possible, and is not taken back.
            block.marks.set(Marks::KEPT, v < block.v_in);
            let v = v.max(block.v_in);
            if v == block.v_in && left <= self.until {
                return self.blocks_done();
            }
            block.v_in = v;
            v_out = v;
        }
        self.pass = Pass::Blocks(left, v_out);
        false
    }

    fn blocks_done(&mut self) -> bool {
        self.end = self.blocks.len();
        self.until = usize::MAX;
        self.pass = Pass::Done;
        true
    }

    /// Another one, or none if this one goes on.
    fn backward(&mut self, pass: &mut Backward, work: &mut usize) -> Option<Pass> {
        while *work > 0 {
            spend(work, ADD);
            let Some(left) = pass.left.checked_sub(1) else { return Some(self.start_forward()) };
            pass.left = left;
            let last = self.open && left + 1 == self.blocks.len();
            let share = self.last.as_ref().filter(|_| last).map(|last| &last.share);
            let Some(block) = self.blocks.get_mut(left) else { return Some(self.start_forward()) };
            pass.span.add(block, share);
            if left > 0 && !block.is(Marks::ANCHOR) {
                continue;
            }
            spend(work, RAMP);
            if pass.changed {
                block.marks.set(Marks::CHECKED, false);
            }
            let ease = self.ease(left);
            pass.span.limits.ease(ease);
            let Some(block) = self.blocks.get_mut(left) else { return Some(self.start_forward()) };
            // The first block's start is already decided.
            if left == 0 {
                self.raise_first_span(pass);
                return Some(self.start_forward());
            }
            // What was possible stays possible, see `blocks`; new anchors behind it may have to give way.
            // A flat span goes on as the plan before had it: faster, the anchors that gave way would be needed again.
            let v = if block.is(Marks::FLAT) && block.v_old > UNPLANNED {
                block.v_old
            } else {
                pass.span.enter(pass.v_out, block.cap()).max(block.v_old)
            };
            block.marks.set(Marks::KEPT, true);
            pass.changed = v != block.v_in;
            if !pass.changed && left <= pass.until {
                return Some(self.start_forward());
            }
            block.v_in = v;
            pass.v_out = v;
            pass.span = Span::default();
        }
        None
    }

    /// The first block's start may rise: to what its end permits.
    fn raise_first(&mut self, v_out: Speed) {
        let last = self.open && self.blocks.len() == 1;
        let share = self.last.as_ref().filter(|_| last).map(|last| &last.share);
        let Some(block) = self.blocks.front_mut() else { return };
        // Decided with another speed at its end.
        block.marks.set(Marks::KEPT, true);
        let Some(reach) = self.free.take() else { return };
        let brake = share.map_or(block.limits, |share| block.limits.shared(share)).brake();
        let v = faster(&brake, length_mm(block), v_out, block.cap()).min(reach);
        block.v_in = v.max(block.v_in);
    }

    /// The same for a span; again where it gets other ends.
    fn raise_first_span(&mut self, pass: &Backward) {
        let Some(block) = self.blocks.front_mut() else { return };
        block.marks.set(Marks::KEPT, true);
        let Some(reach) = self.free else { return };
        let v = pass.span.enter(pass.v_out, block.cap()).min(reach);
        block.marks.set(Marks::CHECKED, false);
        block.v_in = v;
    }

    fn start_forward(&self) -> Pass {
        let v_in = self.blocks.front().map_or(Speed::ZERO, |block| block.v_in);
        Pass::Forward(Forward { from: 0, next: 0, span: Span::default(), v_in, firm: true, last: 0 })
    }

    /// The same.
    fn forward(&mut self, pass: &mut Forward, work: &mut usize) -> Option<Pass> {
        while *work > 0 {
            spend(work, 1);
            let checked = match self.blocks.get(pass.from) {
                Some(first) => first.is(Marks::CHECKED),
                None if pass.last > 1 && self.untried > 0 => return Some(Pass::Trial(Trial::new(pass.last))),
                None => return Some(self.complete()),
            };
            if let Some(block) = self.blocks.get(pass.next)
                && (pass.next == pass.from || !block.is(Marks::ANCHOR))
            {
                if !checked {
                    spend(work, ADD);
                    let last = self.open && pass.next + 1 == self.blocks.len();
                    let share = self.last.as_ref().filter(|_| last).map(|last| &last.share);
                    pass.span.add(block, share);
                }
                pass.next += 1;
                continue;
            }
            // The span is complete.
            let end = self.blocks.get(pass.next);
            let last = !self.open || end.is_some_and(|end| end.v_in.to_bits() == speed_bits(end.cap));
            pass.firm &= last;
            if last {
                pass.last = pass.next;
            }
            if checked {
                pass.v_in = end.map_or(Speed::ZERO, |end| end.v_reached);
                (pass.from, pass.span) = (pass.next, Span::default());
                continue;
            }
            spend(work, RAMP);
            if let Some(next) = self.span(pass) {
                spend(work, LAW);
                return Some(next);
            }
        }
        None
    }

    /// Plans a span that has changed; `None` if it is one block, which needs no law.
    fn span(&mut self, pass: &mut Forward) -> Option<Pass> {
        let single = pass.next - pass.from == 1;
        if !single {
            pass.span.limits.ease(self.ease(pass.from));
        }
        let planned = self.blocks.get(pass.next).map_or(Speed::ZERO, |end| end.v_in);
        let Some(v_out) = pass.span.leave(pass.v_in, planned) else { return Some(self.go_back(pass)) };
        if let Some(end) = self.blocks.get_mut(pass.next) {
            if v_out != end.v_reached {
                end.marks.set(Marks::CHECKED, false);
            }
            end.v_reached = v_out;
        }
        if single {
            self.span_done(pass, v_out);
            return None;
        }
        let flat = self.blocks.get(pass.from).is_some_and(|first| first.is(Marks::FLAT));
        if flat {
            pass.span.limits.flatten(pass.v_in, v_out);
        }
        // A flat span only slows down, as the plan before did.
        let law = Law::new(&pass.span, pass.v_in, v_out, pass.firm || flat);
        pass.v_in = v_out;
        let block = pass.from;
        Some(Pass::Inside(Inside { forward: *pass, law, block, at: 0, worst: None, cut: 0 }))
    }

    /// A span is too short for its change of speed. The plan before was possible: what is new gives way.
    fn go_back(&mut self, pass: &Forward) -> Pass {
        let &Forward { from, next, .. } = pass;
        if self.free.take().is_some() {
            // The plan before began at rest.
            if let Some(first) = self.blocks.front_mut() {
                first.v_in = Speed::ZERO;
                first.marks.set(Marks::CHECKED, false);
            }
            return self.plan_again(0, self.blocks.len());
        }
        if from < self.end && self.end < next {
            // All blocks of the span together permit less than those before the end of that plan.
            self.set_anchor(self.end);
            return self.plan_again(from, next);
        }
        let to = self.anchor_behind(next);
        match self.blocks.get_mut(next) {
            Some(end) if end.is(Marks::FRESH) && next != self.end => {
                end.give_way();
                self.untried -= usize::from(end.joint.is_open()).min(self.untried);
                self.through += 1;
                if let Some(first) = self.blocks.get_mut(from) {
                    first.marks.set(Marks::FLAT, true);
                }
                self.plan_again(from, to)
            }
            // A defect, which the verification of the profile will report.
            _ => self.complete(),
        }
    }

    /// A flat span does not slow down enough for a block inside. The plan before did: its end gives way.
    fn slow_down(&mut self, pass: &Forward) -> Pass {
        let &Forward { from, next, .. } = pass;
        let to = self.anchor_behind(next);
        match self.blocks.get_mut(next) {
            Some(end) if end.is(Marks::FRESH) && next != self.end => {
                end.give_way();
                self.untried -= usize::from(end.joint.is_open()).min(self.untried);
                self.through += 1;
                self.plan_again(from, to)
            }
            Some(end) if end.v_in > end.v_old.max(Speed::ZERO) => {
                end.v_in = end.v_old.max(Speed::ZERO);
                end.marks.set(Marks::CHECKED, false);
                self.plan_again(from, next)
            }
            // A defect, which the limits of its slowest block contain.
            _ => self.complete(),
        }
    }

    /// The first anchor behind a block, or the end of the ring.
    pub(super) fn anchor_behind(&self, block: usize) -> usize {
        (block + 1..self.blocks.len())
            .find(|&k| self.blocks.get(k).is_some_and(|block| block.is(Marks::ANCHOR)))
            .unwrap_or(self.blocks.len())
    }

    fn span_done(&mut self, pass: &mut Forward, v_out: Speed) {
        if let Some(first) = self.blocks.get_mut(pass.from) {
            first.marks.set(Marks::CHECKED, true);
        }
        (pass.from, pass.span, pass.v_in) = (pass.next, Span::default(), v_out);
    }

    fn inside(&mut self, pass: &mut Inside, work: &mut usize) -> Option<Pass> {
        let Forward { from, next: to, .. } = pass.forward;
        let batch = self.batch();
        while *work > 0 {
            spend(work, COMPARE);
            if pass.block >= to {
                return Some(self.inside_done(pass));
            }
            let Some(block) = self.blocks.get(pass.block) else { return Some(self.complete()) };
            let start = to_f32(pass.at) * LSB_44;
            pass.at += block.length;
            let end = to_f32(pass.at) * LSB_44;
            let slowest = pass.worst.map_or(f32::MAX, |(.., v)| v);
            if pass.block > from {
                if block.cap < slowest && !pass.law.keeps(block.cap, start, start) {
                    pass.worst = Some((pass.block, pass.block, block.cap));
                }
                if pass.block >= batch && (pass.cut == 0 || start <= pass.law.brakes_at()) {
                    pass.cut = pass.block;
                }
            }
            let v = block.limits.v;
            match &mut pass.worst {
                // The limit goes on.
                Some((_, behind, slowest)) if *slowest == v && *behind == pass.block => *behind += 1,
                worst => {
                    if v < worst.map_or(f32::MAX, |(.., v)| v) && !pass.law.keeps(v, start, end) {
                        *worst = Some((pass.block, pass.block + 1, v));
                    }
                }
            }
            pass.block += 1;
        }
        None
    }

    fn inside_done(&mut self, pass: &mut Inside) -> Pass {
        let Forward { from, next: to, firm, v_in, .. } = pass.forward;
        let flat = self.blocks.get(from).is_some_and(|block| block.is(Marks::FLAT));
        if let Some((first, behind, v)) = pass.worst {
            if flat {
                return self.slow_down(&pass.forward);
            }
            let [enters, leaves] = self.too_fast(pass, first, behind, v);
            if !enters
                && !leaves
                && firm
                && self.blocks.get(first).is_some_and(|block| block.limits.may_dip())
            {
                self.lower_peak(from, v);
                return self.plan_again(from, to);
            }
            for (block, needed) in [(first, enters || !leaves), (behind, leaves || !enters)] {
                if needed && from < block && block < to {
                    self.set_anchor(block);
                }
            }
            return self.plan_again(from, to);
        }
        let batch = self.batch();
        if !firm && !flat && from < batch && pass.cut > from {
            let mut cut = pass.cut;
            if !pass.law.slows_down() {
                // Its end is no better a place than the first quarter.
                cut = batch;
            } else if let Some(block) = self.blocks.get_mut(cut) {
                // Acceleration vanishes there anyway: no other law is faster.
                block.joint.close();
            }
            self.set_anchor(cut);
            return self.plan_again(from, to);
        }
        self.span_done(&mut pass.forward, v_in);
        Pass::Forward(pass.forward)
    }

    /// Whether the law of a span is too fast at the start of the block `first`, and at that of `behind`, both inside. Where it is at
    /// both, and blocks may be cut, it begins with the one that the law comes to with acceleration.
    fn too_fast(&self, pass: &Inside, first: usize, behind: usize, v: f32) -> [bool; 2] {
        let Forward { from, next: to, .. } = pass.forward;
        let mut at = 0;
        let mut places = [0; 2];
        for k in from..behind {
            let Some(block) = self.blocks.get(k) else { break };
            at += block.length;
            if k + 1 == first {
                places[0] = at;
            }
        }
        places[1] = at;
        let mut law = pass.law;
        let [enter, leave] = places.map(|at| to_f32(at) * LSB_44);
        let enters = first > from && !law.keeps(v, enter, enter);
        let leaves = behind < to && !law.keeps(v, leave, leave);
        let may_dip = || self.blocks.get(first).is_some_and(|block| block.limits.may_dip());
        if !(enters && leaves && law.firm && may_dip()) {
            [enters, leaves]
        } else if enter >= law.brakes_at() {
            [true, false]
        } else {
            [leave > law.reaches_at(), true]
        }
    }

    fn set_anchor(&mut self, block: usize) {
        if let Some(block) = self.blocks.get_mut(block)
            && !block.is(Marks::ANCHOR)
        {
            block.marks.set(Marks::ANCHOR | Marks::FRESH, true);
            block.marks.set(Marks::CHECKED, false);
            block.v_reached = UNPLANNED;
            self.untried += usize::from(block.joint.is_open());
            self.through -= 1;
        }
    }

    /// There are new anchors between the blocks `from` and `to`.
    fn plan_again(&self, from: usize, to: usize) -> Pass {
        let v_out = self.blocks.get(to).map_or(Speed::ZERO, |end| end.v_in);
        Pass::Backward(Backward { left: to, span: Span::default(), v_out, until: from, changed: true })
    }

    pub(super) fn complete(&mut self) -> Pass {
        self.end = self.blocks.len();
        self.free = None;
        for block in self.blocks.iter_mut().filter(|block| block.is(Marks::ANCHOR)) {
            block.marks.set(Marks::FRESH, false);
            block.v_old = block.v_reached;
        }
        Pass::Done
    }

    /// How many blocks may leave: all if none follows, otherwise the spans that begin in the first quarter.
    pub(super) fn ready(&self) -> usize {
        if !self.open {
            return self.blocks.len();
        }
        let batch = self.batch();
        (batch..self.blocks.len())
            .find(|&k| self.blocks.get(k).is_some_and(|b| b.is(Marks::ANCHOR)))
            .unwrap_or(batch)
    }
}

/// Highest speed at the end of a span, at most `next`, that can be reached from `v_in`; `None` if it is too short even for
/// a standstill. `kept`: the speed at its start may have been planned for another end speed.
#[inline(always)]
pub(super) fn leave(limits: &Limits, length: i64, kept: bool, v_in: Speed, next: Speed) -> Option<Speed> {
    let length = to_f32(length) * LSB_44;
    if next >= v_in {
        return Some(faster(&limits.speed_up(), length, v_in, limits.v).min(next));
    }
    if kept { slow_down(limits, length, v_in, next) } else { Some(next) }
}

/// The same where that is slower than `v_in`, whose plan may have had another end speed.
#[inline(never)]
fn slow_down(limits: &Limits, length: f32, v_in: Speed, next: Speed) -> Option<Speed> {
    let brake = limits.brake();
    let possible = |v_out: Speed| loses(&brake, length, v_in, v_out);
    if possible(next) {
        return Some(next);
    }
    // The speed was planned with a lower one here, where slowing down is quicker.
    let (mut low, mut high) = (0, next.to_bits());
    for _ in 0..LEAVE_STEPS {
        let middle = low + (high - low) / 2;
        if possible(Speed::from_bits(middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    let v_out = Speed::from_bits(low);
    (low > 0 || possible(v_out)).then_some(v_out)
}

/// Highest speed at the start of a span, at most `v_in`, from which it can slow down to `v_out`.
pub(super) fn enter(limits: &Limits, length: i64, v_out: Speed, v_in: Speed) -> Speed {
    let gain = ramp_gain(&limits.brake(), v_out, to_f32(length) * LSB_44);
    Speed::from_bits(v_out.to_bits().saturating_add(gain)).min(v_in)
}

/// Whether a span is long enough to slow down from `v_in` to `v_out`.
pub(super) fn can_leave(limits: &Limits, length: i64, v_in: Speed, v_out: Speed) -> bool {
    loses(&limits.brake(), to_f32(length) * LSB_44, v_in, v_out)
}

fn loses(brake: &Ramp, length: f32, v_in: Speed, v_out: Speed) -> bool {
    let gain = ramp_gain(brake, v_out, length);
    v_out.to_bits().saturating_add(gain + (gain >> 21)) >= v_in.to_bits()
}

/// Highest speed, at most `cap`, from which a ramp leads to `low` within a length in mm, or the other way round.
///
/// The change itself is rounded, not the speed: at high speed over short blocks it is far below the speed's LSB in
/// `f32`.
#[inline(always)]
fn faster(ramp: &Ramp, length: f32, low: Speed, cap: f32) -> Speed {
    let cap = speed_bits(cap);
    if low.to_bits() >= cap {
        return Speed::from_bits(cap);
    }
    Speed::from_bits(low.to_bits().saturating_add(ramp_gain(ramp, low, length)).min(cap))
}

/// Change of speed from `low` on, rounded down by 2^-21.
#[inline(always)]
fn ramp_gain(ramp: &Ramp, low: Speed, length: f32) -> i64 {
    speed_bits(ramp.reach(speed_f32(low.to_bits()), length))
}

/// Path length, mm.
pub(super) fn length_mm(block: &Block) -> f32 {
    to_f32(block.length) * LSB_44
}
