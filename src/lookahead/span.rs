//! Finds the speeds at the anchors (transitions where acceleration is zero), and decides which transitions
//! are anchors.
//!
//! The path between two anchors is a span. The planner first makes a profile for the whole span, from its
//! length, its end speeds and the speed of its fastest block. This profile may be too fast for slower blocks
//! inside the span. For the slowest of them, new anchors limit the speed:
//!
//! | the profile is too fast | new anchors |
//! |---|---|
//! | at the start or at the end of the block | at this end |
//! | only between both ends | at both ends; or, with HSC and NO_OPT=0, none: the profile is limited to the speed of the block |
//!
//! The planner then makes new profiles for the parts. So acceleration is zero only where a limit is reached,
//! and not at every end of a block. An anchor stays until its block leaves the ring, unless [`super::ease`]
//! finds a faster profile without it.
//!
//! A released plan must stay possible when more blocks come. But a block may keep its limit only because the
//! motion brakes for a stop soon after it. With more blocks, this stop moves away. So the planner relies on
//! the braking at the end of a span only if the speed at that end is final. Otherwise the block gets its
//! anchors at once. If one span fills the ring, it is divided where its braking would begin, or after the
//! first quarter of the ring.
use super::block::{Block, Marks};
use super::ease::Trial;
use super::law::{Law, RISE, Span};
use super::plan::{Pass, Plan, spend};
use super::planned::{Planned, settled};
use super::ring::Ring;
use crate::machine::functions;
use crate::math::float::to_f32;
use crate::quantity::{DISTANCE_LSB, Speed, speed_bits};
use crate::slope::limits::Limits;

/// The pass from the end to the front.
pub(super) struct Backward {
    /// Remaining blocks.
    left: usize,
    /// The part of the current span that the pass has covered, its end, and the speed there.
    span: Span,
    to: usize,
    v_out: Speed,
    /// Anchors after this block are always planned. Other anchors are planned as long as speeds change.
    until: usize,
    /// Whether the current span has another end speed or other blocks than before.
    changed: bool,
    /// Whether spans before that of [`Forward`] are unchanged, unless this pass reaches them.
    again: bool,
}

/// The pass from the front to the end.
pub(super) struct Forward {
    /// First block of the current span, and the first block not yet passed.
    from: usize,
    next: usize,
    span: Span,
    v_in: Speed,
    v_out: Speed,
    /// Whether later blocks can no longer change any speed up to the start of the span. The second value is
    /// for the end of the span.
    firm: [bool; 2],
    /// The last anchor with a final speed, up to the start of the span. The second value is for the
    /// end of the span.
    last: [usize; 2],
}

/// The comparison of the blocks of one span, from its start.
pub(super) struct Inside {
    law: Law,
    /// Distance at which the profile begins to brake.
    brakes_at: f32,
    /// The current block, and its distance from the start of the span.
    block: usize,
    at: i64,
    /// The slowest blocks for which the profile is too fast.
    worst: Option<Worst>,
    /// The block at which to cut the span.
    cut: usize,
    /// Data for a span with many parts of one curve, which only HSC has.
    calm: [Calm; functions::HSC.room(1)],
}

/// The part of a profile with constant speed, if parts of one curve lie there. A cut of the span there saves
/// time: the limits at one end of the span then do not slow the other end.
#[derive(Clone, Copy)]
struct Calm {
    /// Distance at which the gain of speed ends.
    from: f32,
    /// The first and the last block of that part.
    blocks: Option<[usize; 2]>,
    /// Limits of the blocks before the first one, and of the blocks from the last one on.
    sides: [Limits; 2],
}

impl Calm {
    const NONE: Self = Self { from: f32::MAX, blocks: None, sides: [Limits::WIDEST; 2] };

    /// Adds a block. `calm`: the block begins in the part of constant speed.
    fn take(&mut self, k: usize, calm: bool, block: &Block) {
        let [before, behind] = &mut self.sides;
        if calm {
            self.blocks = Some([self.blocks.map_or(k, |[first, _]| first), k]);
            *behind = block.limits();
        } else if self.blocks.is_some() {
            block.join_to(behind);
        } else {
            block.join_to(before);
        }
    }

    /// The blocks at which a cut saves time. `law` is the profile of the span, `limits` its limits.
    fn cuts(&self, law: &Law, limits: &Limits) -> [Option<usize>; 2] {
        let Some([first, last]) = self.blocks else { return [None; 2] };
        let [v_in, v_out] = law.ends();
        let gains = |side: &Limits, v: f32| law.peak() > v * RISE && side.is_stronger(limits);
        let [before, behind] = &self.sides;
        [gains(before, v_in).then_some(first), gains(behind, v_out).then_some(last)]
    }
}

/// Consecutive blocks with one limit that a profile exceeds.
#[derive(Clone, Copy)]
struct Worst {
    /// The first block, and the block after the last one. For a transition, both numbers are the block after
    /// it.
    first: usize,
    behind: usize,
    v: f32,
    /// Distances of both blocks from the start of the span.
    at: [i64; 2],
}

/// Work of four steps, in the unit of [`spend`]: add a block, find a speed, make a profile, compare a block
/// with a profile.
const ADD: usize = 3;
const RAMP: usize = 14;
const LAW: usize = 50;
const COMPARE: usize = 8;

impl Backward {
    pub const NONE: Self =
        Self { left: 0, span: Span::NONE, to: 0, v_out: Speed::ZERO, until: 0, changed: true, again: false };

    /// A pass over `left` blocks, from the speed at their end. Anchors after `until` are always planned.
    pub fn new(left: usize, until: usize, v_out: Speed) -> Self {
        Self { left, to: left, until, v_out, ..Self::NONE }
    }
}

impl Forward {
    pub const NONE: Self = Self {
        from: 0,
        next: 0,
        span: Span::NONE,
        v_in: Speed::ZERO,
        v_out: Speed::ZERO,
        firm: [true; 2],
        last: [0; 2],
    };

    /// Goes on to the previous span, whose end speed is `v_out`.
    fn pass(&mut self, v_out: Speed) {
        (self.from, self.span, self.v_in) = (self.next, Span::NONE, v_out);
        (self.firm[0], self.last[0]) = (self.firm[1], self.last[1]);
    }
}

impl Inside {
    pub const NONE: Self = Self {
        law: Law::NONE,
        brakes_at: 0.0,
        block: 0,
        at: 0,
        worst: None,
        cut: 0,
        calm: [Calm::NONE; functions::HSC.room(1)],
    };
}

impl<const AXES: usize, const BLOCKS: usize> Ring<'_, AXES, BLOCKS> {
    /// Continues the pass from the end to the front.
    pub(super) fn backward(&mut self, plan: &mut Plan, work: &mut usize) {
        while *work > 0 {
            let pass = &mut plan.backward;
            spend(work, ADD);
            let Some(left) = pass.left.checked_sub(1) else { return self.start_forward(plan) };
            pass.left = left;
            let last = self.scope.open && left + 1 == self.blocks.len();
            let share = self.tail.share(last);
            let Some(block) = self.blocks.get_mut(left) else { return self.start_forward(plan) };
            pass.span.add(block, share);
            if left > 0 && !block.is(Marks::ANCHOR) {
                continue;
            }
            spend(work, RAMP);
            if pass.changed {
                block.marks.set(Marks::CHECKED, false);
            }
            let mut span = pass.span;
            span.limits.ease(self.ease(left));
            // The start speed of the first block is already decided.
            if left == 0 {
                self.raise_first_span(&span, pass.v_out);
                return self.start_forward(plan);
            }
            let Some(block) = self.blocks.get_mut(left) else { return self.start_forward(plan) };
            // A speed of the last plan stays possible, but new anchors after it may have to be removed. A
            // flat span keeps its profile: if it were faster, the removed anchors would be needed again.
            let (mut v, mut v_out) = (block.v_old, Speed::ZERO);
            if !(block.is(Marks::FLAT) && v.is_some()) {
                let entered = span.enter(pass.v_out, block.cap());
                (v, v_out) = (Planned::below(entered), settled(entered));
            }
            if v <= block.v_old {
                v = block.v_old;
                v_out = v.speed();
            }
            block.marks.set(Marks::KEPT, true);
            pass.changed = v != block.v_in;
            if !pass.changed && left <= pass.until {
                return self.start_forward(plan);
            }
            block.v_in = v;
            pass.v_out = v_out;
            (pass.span, pass.to) = (Span::NONE, left);
        }
    }

    /// Raises the start speed of the first block, as far as the end of its span permits. The call is repeated
    /// if the span gets another end.
    fn raise_first_span(&mut self, span: &Span, v_out: Speed) {
        let Some(block) = self.blocks.front_mut() else { return };
        block.marks.set(Marks::KEPT, true);
        let Some(reach) = self.scope.free else { return };
        let v = span.enter(v_out, block.cap()).min(reach);
        block.marks.set(Marks::CHECKED, false);
        self.start = v;
    }

    /// Begins another pass from the front, after the trial of an anchor. The backward pass has no span to hand over.
    pub(super) fn forward_again(&self, plan: &mut Plan) {
        plan.backward = Backward { left: usize::MAX, ..Backward::NONE };
        self.start_forward(plan);
    }

    fn start_forward(&self, plan: &mut Plan) {
        plan.pass = Pass::Forward;
        let forward = &mut plan.forward;
        if plan.backward.again && plan.backward.left > 0 && plan.backward.left == forward.from {
            (forward.next, forward.span) = (forward.from, Span::NONE);
            return;
        }
        let v_in = self.first_speed();
        *forward = Forward { v_in, ..Forward::NONE };
    }

    /// Continues the pass from the front to the end.
    pub(super) fn forward(&mut self, plan: &mut Plan, work: &mut usize) {
        while *work > 0 {
            let pass = &mut plan.forward;
            spend(work, 1);
            let checked = match self.blocks.get(pass.from) {
                Some(first) => first.is(Marks::CHECKED),
                None if pass.last[0] > 1 && self.counts.untried > 0 => {
                    if let Some(tries) = plan.tries.first_mut() {
                        tries.trial = Trial::new(pass.last[0]);
                    }
                    plan.pass = Pass::Trial;
                    return;
                }
                None => return plan.complete(self),
            };
            if checked {
                pass.next = self.anchor_behind(pass.from);
                spend(work, (pass.next - pass.from) / 4);
            } else if pass.next == pass.from && pass.from == plan.backward.left {
                // This span was the last one of the backward pass.
                pass.next = plan.backward.to;
                pass.span = Span { kept: true, ..plan.backward.span };
            } else if let Some(block) = self.blocks.get(pass.next)
                && (pass.next == pass.from || !block.is(Marks::ANCHOR))
            {
                spend(work, ADD);
                let last = self.scope.open && pass.next + 1 == self.blocks.len();
                let share = self.tail.share(last);
                pass.span.add(block, share);
                pass.next += 1;
                continue;
            }
            // The span is complete.
            let end = self.blocks.get(pass.next);
            let planned = end.map_or(Speed::ZERO, |end| end.v_in.speed());
            let last = !self.scope.open || end.is_some_and(|end| planned.to_bits() == speed_bits(end.cap));
            pass.firm[1] = pass.firm[0] && last;
            pass.last[1] = if last { pass.next } else { pass.last[0] };
            if checked {
                let reached = end.filter(|end| end.v_reached != end.v_in);
                pass.pass(reached.map_or(planned, |end| end.v_reached.speed_by_call()));
                continue;
            }
            spend(work, RAMP);
            if self.span(plan, planned) {
                return spend(work, LAW);
            }
        }
    }

    /// Plans a span that has changed. Returns `false` for a single block, which needs no profile and is
    /// skipped.
    fn span(&mut self, plan: &mut Plan, planned: Speed) -> bool {
        let pass = &mut plan.forward;
        let single = pass.next - pass.from == 1;
        if !single {
            pass.span.limits.ease(self.ease(pass.from));
        }
        let Some(v_out) = pass.span.leave(pass.v_in, planned) else {
            self.go_back(plan);
            return true;
        };
        if let Some(end) = self.blocks.get_mut(pass.next) {
            let reached = if v_out == planned { end.v_in } else { Planned::below(v_out) };
            if reached != end.v_reached {
                end.marks.set(Marks::CHECKED, false);
            }
            end.v_reached = reached;
        }
        pass.v_out = v_out;
        if single {
            self.span_done(pass);
            return false;
        }
        let flat = self.blocks.get(pass.from).is_some_and(|first| first.is(Marks::FLAT));
        if flat {
            pass.span.limits.flatten(pass.v_in, v_out);
        }
        // A flat span only brakes, as in the last plan.
        let law = Law::new(&pass.span, pass.v_in, v_out, pass.firm[1] || flat);
        let brakes_at = law.brakes_at();
        plan.inside = Inside { law, brakes_at, block: pass.from, ..Inside::NONE };
        if let Some(calm) = plan.inside.calm.first_mut()
            && self.blocks.get(pass.next.saturating_sub(1)).is_some_and(|last| last.joint.flows())
        {
            calm.from = plan.inside.law.reaches_at();
        }
        plan.pass = Pass::Inside;
        true
    }

    /// Handles a span that is too short for its change of speed. The last plan was possible, so the new part
    /// is withdrawn.
    fn go_back(&mut self, plan: &mut Plan) {
        let Forward { from, next, .. } = plan.forward;
        if self.scope.free.take().is_some() {
            // The last plan began at a stop.
            if let Some(first) = self.blocks.front_mut() {
                self.start = Speed::ZERO;
                first.marks.set(Marks::CHECKED, false);
            }
            self.plan_again(plan, 0, self.blocks.len());
            plan.backward.again = false;
            return;
        }
        if from < self.scope.end && self.scope.end < next {
            // All blocks of the span together permit less than the blocks up to the end of the last plan.
            self.set_anchor(self.scope.end);
            return self.plan_again(plan, from, next);
        }
        let to = self.anchor_behind(next);
        match self.blocks.get_mut(next) {
            Some(end) if end.is(Marks::FRESH) && next != self.scope.end => {
                end.give_way();
                self.counts.untried -= usize::from(end.joint.is_open()).min(self.counts.untried);
                self.counts.through += 1;
                if let Some(first) = self.blocks.get_mut(from) {
                    first.marks.set(Marks::FLAT, true);
                }
                self.plan_again(plan, from, to);
            }
            // A defect, which the check of the profile will report.
            _ => plan.complete(self),
        }
    }

    /// Handles a flat span that does not brake enough for a block inside. It did so in the last plan, so the
    /// end speed of the span is lowered.
    fn slow_down(&mut self, plan: &mut Plan) {
        let Forward { from, next, .. } = plan.forward;
        let to = self.anchor_behind(next);
        match self.blocks.get_mut(next) {
            Some(end) if end.is(Marks::FRESH) && next != self.scope.end => {
                end.give_way();
                self.counts.untried -= usize::from(end.joint.is_open()).min(self.counts.untried);
                self.counts.through += 1;
                self.plan_again(plan, from, to);
            }
            Some(end) if end.v_in > end.v_old.max(Planned::ZERO) => {
                end.v_in = end.v_old.max(Planned::ZERO);
                end.marks.set(Marks::CHECKED, false);
                self.plan_again(plan, from, next);
            }
            // A defect; the limits of the slowest block contain it.
            _ => plan.complete(self),
        }
    }

    /// The first anchor after a block, or the end of the ring.
    pub(super) fn anchor_behind(&self, block: usize) -> usize {
        (block + 1..self.blocks.len())
            .find(|&k| self.blocks.get(k).is_some_and(|block| block.is(Marks::ANCHOR)))
            .unwrap_or(self.blocks.len())
    }

    fn span_done(&mut self, pass: &mut Forward) {
        if let Some(first) = self.blocks.get_mut(pass.from) {
            first.marks.set(Marks::CHECKED, true);
        }
        pass.pass(pass.v_out);
    }

    /// Compares the blocks of a span with the span's profile.
    pub(super) fn inside(&mut self, plan: &mut Plan, work: &mut usize) {
        let Forward { from, next: to, .. } = plan.forward;
        let batch = self.batch();
        while *work > 0 {
            let pass = &mut plan.inside;
            spend(work, COMPARE);
            if pass.block >= to {
                return self.inside_done(plan);
            }
            let Some(block) = self.blocks.get(pass.block) else { return plan.complete(self) };
            let before = pass.at;
            pass.at += block.length;
            let [start, end] = [before, pass.at].map(|at| to_f32(at) * DISTANCE_LSB);
            let slowest = pass.worst.map_or(f32::MAX, |worst| worst.v);
            if pass.block > from {
                if block.cap < slowest && !pass.law.keeps(block.cap, start, start) {
                    pass.worst =
                        Some(Worst { first: pass.block, behind: pass.block, v: block.cap, at: [before; 2] });
                }
                if pass.block >= batch && (pass.cut == 0 || start <= pass.brakes_at) {
                    pass.cut = pass.block;
                }
            }
            if let Some(calm) = pass.calm.first_mut()
                && calm.from < f32::MAX
            {
                let is_calm =
                    pass.block > from && block.joint.flows() && start >= calm.from && start <= pass.brakes_at;
                calm.take(pass.block, is_calm, block);
            }
            let v = block.speed();
            match &mut pass.worst {
                // The next block has the same limit.
                Some(worst) if worst.v == v && worst.behind == pass.block => {
                    worst.behind += 1;
                    worst.at[1] = pass.at;
                }
                worst => {
                    if v < worst.map_or(f32::MAX, |worst| worst.v) && !pass.law.keeps(v, start, end) {
                        let (first, behind) = (pass.block, pass.block + 1);
                        *worst = Some(Worst { first, behind, v, at: [before, pass.at] });
                    }
                }
            }
            pass.block += 1;
        }
    }

    fn inside_done(&mut self, plan: &mut Plan) {
        let Forward { from, next: to, firm: [_, firm], .. } = plan.forward;
        let Inside { worst, cut, .. } = plan.inside;
        let flat = self.blocks.get(from).is_some_and(|block| block.is(Marks::FLAT));
        if let Some(worst) = worst {
            let Worst { first, behind, v, .. } = worst;
            if flat {
                return self.slow_down(plan);
            }
            let [enters, leaves] = self.too_fast(plan, &worst);
            if !enters
                && !leaves
                && firm
                && self.blocks.get(first).is_some_and(|block| block.may_have_valleys())
            {
                self.lower_peak(from, v);
                return self.plan_again(plan, from, to);
            }
            for (block, needed) in [(first, enters || !leaves), (behind, leaves || !enters)] {
                if needed && from < block && block < to {
                    self.set_anchor(block);
                }
            }
            return self.plan_again(plan, from, to);
        }
        if !flat && self.cut_where_calm(plan) {
            return self.plan_again(plan, from, to);
        }
        let batch = self.batch();
        if !firm && !flat && from < batch && cut > from {
            let mut cut = cut;
            if !plan.inside.law.slows_down() {
                // The end of the worst blocks is no better place than the first quarter.
                cut = batch;
            } else if let Some(block) = self.blocks.get_mut(cut) {
                // Acceleration is zero there in any case, so no other profile is faster.
                block.joint.close();
            }
            self.set_anchor(cut);
            return self.plan_again(plan, from, to);
        }
        self.span_done(&mut plan.forward);
        plan.pass = Pass::Forward;
    }

    /// Cuts a span of one curve in its part of constant speed, if the cut saves time.
    fn cut_where_calm(&mut self, plan: &Plan) -> bool {
        let Forward { from, next: to, span, .. } = &plan.forward;
        let mut found = false;
        let Some(calm) = plan.inside.calm.first() else { return false };
        for cut in calm.cuts(&plan.inside.law, &span.limits).into_iter().flatten() {
            if let Some(block) = self.blocks.get_mut(cut)
                && *from < cut
                && cut < *to
                && !block.is(Marks::ANCHOR)
            {
                // Acceleration is zero there in any case, so no other profile is faster.
                block.joint.close();
                self.set_anchor(cut);
                found = true;
            }
        }
        found
    }

    /// Whether the profile of a span is too fast at the start of block `first` and at the start of block
    /// `behind`; each counts only if it is inside the span. If blocks may be cut, the result names only one
    /// of them: the block that the profile reaches with acceleration.
    fn too_fast(&self, plan: &mut Plan, worst: &Worst) -> [bool; 2] {
        let Forward { from, next: to, .. } = plan.forward;
        let &Worst { first, behind, v, at } = worst;
        let Inside { law, brakes_at, .. } = &mut plan.inside;
        let [enter, leave] = at.map(|at| to_f32(at) * DISTANCE_LSB);
        let enters = first > from && !law.keeps(v, enter, enter);
        let leaves = behind < to && !law.keeps(v, leave, leave);
        let may_have_valleys = || self.blocks.get(first).is_some_and(|block| block.may_have_valleys());
        if !(enters && leaves && law.is_firm() && may_have_valleys()) {
            [enters, leaves]
        } else if enter >= *brakes_at {
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
            block.forget();
            self.counts.untried += usize::from(block.joint.is_open());
            self.counts.through -= 1;
        }
    }

    /// Plans again from the new anchors between the blocks `from` and `to`.
    fn plan_again(&self, plan: &mut Plan, from: usize, to: usize) {
        let v_out = self.blocks.get(to).map_or(Speed::ZERO, |end| end.v_in.speed_by_call());
        plan.backward = Backward { again: true, ..Backward::new(to, from, v_out) };
        plan.pass = Pass::Backward;
    }
}
