//! Moves an anchor (a transition where acceleration is zero) into the next or previous block, if this saves
//! time.
//!
//! The speed at an anchor may be below its limit, because the path on one side is too short to reach this
//! limit. The motion takes less time if acceleration is zero inside the faster block on the other side
//! instead. So the anchor moves into this block, as far as the limit at its old place permits.
use super::{Shift, Step, Valley};
use crate::lookahead::block::Marks;
use crate::lookahead::ease::{self, Ease, Trial};
use crate::lookahead::law::{Law, RISE, Span};
use crate::lookahead::ring::Ring;
use crate::math::float::to_f32;
use crate::quantity::{DISTANCE_LSB, Speed, speed_bits, speed_f32};
use crate::slope::limits::{Limits, ROUNDED};

/// Largest number of whole blocks by which an anchor moves; number of steps of the search for its place in
/// the next block; steps per call.
const MOVES: u8 = 4;
const SHIFTS: u8 = 12;
const LAWS: usize = 2;
/// An anchor moves only if the ratio of the new time to the old one is below this value.
const WORTH: f32 = 0.995;

impl<const AXES: usize, const BLOCKS: usize> Ring<'_, AXES, BLOCKS> {
    /// Handles an anchor that is slower than its limit.
    pub(in crate::lookahead) fn look_further(&mut self, pass: &mut Trial, valley: &mut Valley) {
        let (from, at) = (pass.from, pass.at);
        let to = self.anchor_behind(at);
        if to > pass.last || at == from || self.blocks.len() + 1 > self.blocks.capacity() {
            return self.try_knee(pass, valley);
        }
        let shift = Shift { on: true, was: at, ..Shift::NONE };
        *valley = Valley { edges: [from, at, at, to], shift, ..Valley::NONE };
        pass.cursor.next = from;
        pass.step = ease::Step::Valley(Step::TakeIn);
    }

    /// Continues with a knee.
    fn try_knee(&mut self, pass: &mut Trial, valley: &mut Valley) {
        (pass.fit.fitting, pass.fit.head) = (false, 0);
        *valley = Valley::NONE;
        pass.cursor.next = pass.from;
        pass.spans = [Span::NONE; 2];
        pass.step = ease::Step::Gather;
    }

    /// Moves the anchor into the faster block next to it, as far as the limit at the block's end permits. The
    /// anchor stays if no shift is possible.
    pub(super) fn weigh_shift(&mut self, pass: &mut Trial, valley: &mut Valley) {
        let moves = if pass.fit.fitting { None } else { self.search_shift(pass, valley) };
        if moves.is_none() {
            (pass.from, pass.at) = (valley.edges[0], valley.shift.was);
            self.try_knee(pass, valley);
        }
    }

    /// Whether the anchor moves into the block before or after it. This depends on whether the motion speeds
    /// up to the anchor or brakes from it.
    fn shifts_early(&self, valley: &Valley) -> Option<bool> {
        let high = speed_f32(valley.speeds[1].to_bits()) * RISE;
        match [valley.peaks[0] > high, valley.peaks[1] > high] {
            [true, false] => Some(true),
            [false, true] => Some(false),
            _ => None,
        }
    }

    /// Speed at the anchor, and time of the profile that ends there, if the anchor moves by `way` into a
    /// block. Returns `None` if this profile is too fast at the anchor's old place.
    fn shifted(&self, valley: &Valley, limits: &Limits, early: bool, way: i64) -> Option<(Speed, f32)> {
        let mut span = valley.spans[if early { 2 } else { 0 }];
        let at = to_f32(if early { valley.shift.moved + way } else { span.length - valley.shift.moved })
            * DISTANCE_LSB;
        if way > 0 {
            span.add_piece(limits, way);
        }
        span.limits.ease(valley.eases[usize::from(early)]);
        let [v_from, .., v_end] = valley.speeds;
        let ramp = if early { span.limits.brake() } else { span.limits.speed_up() };
        let v = span.faster(&ramp, if early { v_end } else { v_from }, limits.v);
        let [from, to] = if early { [v, v_end] } else { [v_from, v] };
        let mut law = Law::new(&span, from, to, true);
        let cap = self.blocks.get(valley.shift.was)?.cap();
        law.keeps(cap, at, at).then(|| (v, law.time()))
    }

    /// Continues the search. Returns `None` if the anchor stays.
    fn search_shift(&mut self, pass: &mut Trial, valley: &mut Valley) -> Option<()> {
        let early = self.shifts_early(valley)?;
        let [a, b, _, d] = valley.edges;
        let block = self.blocks.get(if early { b - 1 } else { b })?;
        let (limits, length) = (block.limits_by_call(), block.length);
        if valley.shift.steps == 0 {
            if valley.shift.moved == 0 {
                valley.eases = [self.ease(a), self.ease(b), Ease::NONE];
            }
            let more = if early { b - 1 > a } else { b + 1 < d };
            if more && valley.tried < MOVES && self.shifted(valley, &limits, early, length).is_some() {
                valley.tried += 1;
                valley.shift.moved += length;
                let b = if early { b - 1 } else { b + 1 };
                valley.edges = [a, b, b, d];
                valley.spans = [Span::NONE; 3];
                pass.cursor.next = a;
                pass.step = ease::Step::Valley(Step::TakeIn);
                return Some(());
            }
            valley.shift.best =
                if valley.shift.moved > 0 { self.shifted(valley, &limits, early, 0) } else { None };
            valley.shift.between = [0, length / 16 * 15];
        }
        for _ in 0..LAWS {
            if valley.shift.steps >= SHIFTS {
                return self.try_shift(pass, valley, early);
            }
            valley.shift.steps += 1;
            let [near, far] = valley.shift.between;
            let middle = near + (far - near) / 2;
            match self.shifted(valley, &limits, early, middle) {
                Some(found) => {
                    valley.shift.between[0] = middle;
                    valley.shift.best = Some(found);
                }
                None => valley.shift.between[1] = middle,
            }
        }
        pass.step = ease::Step::Valley(Step::Weigh);
        Some(())
    }

    /// Tries the shift. Returns `None` if there is no gain.
    fn try_shift(&mut self, pass: &mut Trial, valley: &mut Valley, early: bool) -> Option<()> {
        let [_, b, ..] = valley.edges;
        let [v_from, .., v_end] = valley.speeds;
        let (w, time) = valley.shift.best?;
        let near = valley.shift.between[0];
        if near == 0 && self.blocks.get(b).is_none_or(|at| w > Speed::from_bits(speed_bits(at.cap()))) {
            return None;
        }
        valley.cut.cuts = if early { [-near, near] } else { [near, -near] };
        let speed = speed_f32(w.to_bits()) * ROUNDED;
        valley.cut.v = [speed; 2];
        let w = Speed::from_bits(speed_bits(speed));
        let mut other = valley.spans[if early { 0 } else { 2 }];
        other.shorten(near);
        other.limits.ease(valley.eases[usize::from(!early)]);
        let [from, to] = if early { [v_from, w] } else { [w, v_end] };
        if !other.joins(from, to) {
            return None;
        }
        let other = Law::new(&other, from, to, true).time();
        valley.times = if early { [other, time, 0.0] } else { [time, other, 0.0] };
        if valley.time() >= valley.before * WORTH {
            return None;
        }
        pass.step = ease::Step::Valley(Step::Fit(1));
        Some(())
    }

    pub(super) fn do_shift(&mut self, pass: &mut Trial, valley: &mut Valley) {
        let plan = *valley;
        pass.forget();
        let [a, b, _, _] = plan.edges;
        let mut was = plan.shift.was;
        let at = if plan.cut.cuts[0] == 0 {
            b
        } else {
            let early = plan.cut.cuts[0] < 0;
            let k = if early { b - 1 } else { b };
            let length = self.blocks.get(k).map_or(0, |block| block.length);
            self.cut(k, if early { length + plan.cut.cuts[0] } else { plan.cut.cuts[0] });
            was += usize::from(early);
            pass.last += 1;
            k + 1
        };
        let early = at < was;
        // This is the old place of the anchor.
        let cap = self.blocks.get(was).map_or(0.0, |block| block.cap);
        self.open_up(was, cap);
        let (cap_here, open_here) =
            self.blocks.get(at).map_or((0.0, false), |block| (block.cap, block.joint.is_open()));
        self.dip_at(at, plan.cut.v[0]);
        if let Some(block) = self.blocks.get_mut(at) {
            let is_cut = plan.cut.cuts[0] != 0;
            block.cap = if is_cut { block.v() } else { cap_here };
            if is_cut || open_here {
                block.joint.open();
                self.counts.untried += 1;
            }
        }
        if early
            && let Some(block) = self.blocks.get_mut(was + 1)
            && !block.is(Marks::ANCHOR)
        {
            block.forget();
        }
        self.keep_ease(at, plan.eases[1]);
        self.keep_ease(a, plan.eases[0]);
        // The end of the span keeps its speed, although the new profile might permit a higher one.
        let end = plan.edges[3] + usize::from(plan.cut.cuts[0] != 0);
        if let Some(end) = self.blocks.get_mut(end) {
            end.v_in = end.v_reached;
        }
        (pass.from, pass.at) = (a, at);
        self.try_knee(pass, valley);
    }
}
