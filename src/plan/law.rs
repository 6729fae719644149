//! Makes the speed profile of the next span that has none.
//!
//! The look-ahead plans a profile for the whole span, for its start speed, and for one override. After a
//! stop, a change of override or a slower span, these conditions no longer hold. The planned profile is then
//! replaced by one of the following:
//!
//! - For a span of several blocks: the planned profile or its rest, slowed down by the override. Or another
//!   profile that is nowhere faster ([`CommittedSpan::go_on`]). So no block has to be compared again.
//! - A profile from the current speed, up to a speed limit that every block permits. For several blocks, this
//!   limit is the speed of the slowest block, or the constant speed of the planned profile
//!   ([`CommittedSpan::look`]).
//! - A braking to this speed limit, if the motion is faster.
use super::change::Pending;
use super::committed::CommittedSpan;
use super::hold::NOTHING;
use super::{Brake, Instant, Planning, Speed, Time, Unplannable};
use crate::lookahead::{Gain, GoingOn};
use crate::math::float::{max, min, size_f32, to_f32};
use crate::quantity::{DISTANCE_LSB, speed_bits, speed_f32};

/// Longest duration of a profile that is scaled in speed: 2^26 ticks.
const LONGEST: Time = Time::from_bits(1 << (26 + 36));

/// How far a replacement reaches the planned end speed.
#[derive(Clone, Copy, PartialEq)]
enum Fit {
    /// The profile reaches the planned end speed, or keeps its current one.
    Whole,
    /// The profile reaches a lower end speed.
    Part,
}

/// The result of the search for a profile that differs from the planned one.
enum Made {
    /// The speeds of the profile are known.
    Suited(Fit),
    /// The profile is ready.
    Planned,
    /// Another profile that ends inside the span is ready, and goes to the queue.
    Otherwise,
    /// The search continues.
    Later,
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Makes the profile of the next span that has none. Returns `false`, and changes nothing, if the search
    /// continues.
    pub(super) fn lay(&mut self) -> Result<bool, Unplannable> {
        let made = self.make_law();
        self.note_passed();
        made
    }

    /// As [`Self::lay`], but leaves later spans unchanged ([`Self::note_passed`]). Returns `false` if the
    /// search continues.
    pub(super) fn make_law(&mut self) -> Result<bool, Unplannable> {
        let (k, v_in) = (self.frontier.planned, self.frontier.speed);
        let (end, next) = (self.frontier.end, self.frontier.emitter.next());
        let Some(mut committed) = self.committed.get_mut(k) else { return Ok(true) };
        (committed.first, committed.next, committed.enters, committed.pace) =
            (end, next, v_in, self.orders.pace.key());
        let span = &committed.span;
        let as_planned = v_in == span.v_in && span.checked.now() && self.orders.pace.is_planned(span);
        (committed.limit, committed.leaves) = (min(span.limits.v, span.slow.ceiling), span.v_out);
        let mut made = Made::Suited(Fit::Whole);
        if !as_planned || self.orders.mode.stopping || self.orders.mode.uneven {
            made = self.stretch(k).unwrap_or_else(|| self.suit(k));
            let Some(same) = self.committed.get_mut(k) else { return Ok(true) };
            committed = same;
        }
        let span = &mut committed.span;
        let fit = match made {
            Made::Otherwise => return Ok(true),
            Made::Later => return Ok(false),
            Made::Planned => Fit::Whole,
            Made::Suited(fit) => {
                let permitted = core::mem::replace(&mut span.limits.v, committed.limit);
                let planned = self.profile.plan(span.length, v_in, committed.leaves, &span.limits);
                span.limits.v = permitted;
                planned?;
                fit
            }
        };
        self.frontier.emitter.begin(&self.profile, committed.start, span.length);
        self.frontier.planned = k + 1;
        self.frontier.pending_dwell = u64::from(committed.rest);
        self.frontier.speed = committed.leaves;
        self.frontier.stops = self.frontier.speed == Speed::ZERO;
        if fit == Fit::Part {
            self.lower();
        }
        Ok(true)
    }

    /// Gives the span `k` its planned profile, or the rest of it, scaled by a part of the speed. The part
    /// must be the current override, or fit the start speed.
    #[inline(never)]
    fn stretch(&mut self, k: usize) -> Option<Made> {
        let begins = self.committed.begins(k);
        let committed = self.committed.get_mut(k)?;
        if committed.span.blocks == 1 {
            return None;
        }
        committed.look(begins, committed.start.to_bits());
        if self.orders.mode.stopping {
            return None;
        }
        if let Some(made) = self.go_on_as_planned(k) {
            return Some(made);
        }
        let committed = self.committed.get_mut(k)?;
        let (span, v_in) = (&mut committed.span, committed.enters);
        if self.orders.pace.is_planned(span) && v_in >= span.v_in {
            return None;
        }
        if let Some(part) = self.orders.pace.stretch(span, v_in) {
            let [from, to] = [span.v_in, span.v_out].map(Speed::to_bits);
            // The end speed comes from the scaled change of speed. A scaled end speed would have a far larger
            // rounding error.
            let change = speed_bits(speed_f32((to - from).abs()) * part);
            let leaves = v_in.to_bits() + if to < from { -change } else { change };
            if self.plan_at(k, part, None, Speed::from_bits(leaves.max(0))) {
                return Some(Made::Planned);
            }
        }
        self.committed.get_mut(k)?.span.slow.cruise = 0.0;
        None
    }

    /// Gives the rest of the span `k` a profile that is at most as fast as the planned one, at the current
    /// part of the speed.
    #[inline(never)]
    fn go_on_as_planned(&mut self, k: usize) -> Option<Made> {
        let begins = self.committed.begins(k);
        let committed = self.committed.get(k)?;
        let part = self.orders.pace.steady(&committed.span)?;
        let v = Speed::from_bits(speed_bits(speed_f32(committed.enters.to_bits()) / part));
        let most = committed.go_on(begins, v)?;
        let v_out = speed_bits(speed_f32(committed.span.v_out.to_bits()) * part);
        if !self.plan_at(k, part, Some(&most), Speed::from_bits(v_out)) {
            return None;
        }
        let CommittedSpan { span, limit, .. } = self.committed.get_mut(k)?;
        // At a low override, this profile gains speed slowly. A profile at the speed of the slowest block may
        // take less time.
        let way = to_f32(span.length.to_bits()) * DISTANCE_LSB;
        let ticks = size_f32(self.profile.time().to_bits()) * (1.0 / (1u64 << 36) as f32);
        if ticks * (span.slow.shared * part) > way {
            return None;
        }
        span.slow.ceiling = max(span.slow.ceiling, *limit);
        Some(Made::Planned)
    }

    /// Gives the span `k` a profile with its limits and those of `most`, scaled by `part`, with the end speed
    /// `v_out`. Returns `false` if there is no such profile.
    #[inline(never)]
    fn plan_at(&mut self, k: usize, part: f32, most: Option<&GoingOn>, v_out: Speed) -> bool {
        let Some(committed) = self.committed.get_mut(k) else { return false };
        let (span, v_in) = (&committed.span, committed.enters);
        let mut limits = span.limits.at_part(part);
        if let Some(most) = most {
            limits.v = min(limits.v, most.v * part);
            match most.gain {
                Gain::Free => limits.gain_like(&span.limits),
                Gain::Alike => {}
                Gain::Gentle => limits.gain_gently(),
            }
        }
        committed.leaves = v_out.min(span.v_out);
        committed.limit = limits.v;
        let planned = self.profile.plan(span.length, v_in, committed.leaves, &limits);
        planned.is_ok() && self.profile.time() <= LONGEST
    }

    /// Finds speed limit and end speed of a replacement for the profile of span `k`. The result may also be a
    /// braking.
    #[inline(never)]
    fn suit(&mut self, k: usize) -> Made {
        let Some(committed) = self.committed.get_mut(k) else { return Made::Otherwise };
        let (end, v_in) = (committed.end(), committed.enters);
        let full = self.orders.pace.is_planned(&committed.span);
        let span = &mut committed.span;
        let mut v = self.orders.pace.limit(span);
        let expected = if full { span.v_in } else { span.v_in.min(Speed::from_bits(speed_bits(v))) };
        let lowered = v_in != expected || !span.checked.now();
        if lowered && span.blocks > 1 {
            let known = max(span.slow.least, speed_f32(v_in.to_bits()));
            span.slow.ceiling = min(span.slow.ceiling, max(known, span.slow.cruise));
            v = min(v, span.slow.ceiling);
        }
        committed.limit = v;
        let motion = Instant { distance: committed.start.to_bits(), speed: v_in.to_bits(), accel: 0 };
        let planned = span.v_out.to_bits();
        let too_fast = !full && speed_bits(v) < v_in.to_bits();
        if self.orders.mode.stopping {
            let Ok(descent) = self.descend(k, &motion) else { return Made::Later };
            if let Some(descent) = descent {
                self.go_down(k, &descent);
                return Made::Otherwise;
            }
        } else if too_fast
            && let Some(brake) =
                Brake::plan(&mut self.profile, &motion, end, planned, span.braking(), speed_bits(v))
        {
            self.brake(k, &brake);
            return Made::Otherwise;
        }
        if self.orders.mode.stopping || too_fast {
            v = max(v, speed_f32(v_in.to_bits()));
        }
        let Some(CommittedSpan { span, .. }) = self.committed.get(k) else { return Made::Otherwise };
        let mut v_out = span.v_out;
        let mut reached = true;
        if lowered {
            let least = v_in.min(v_out);
            v_out = span.leave(v_in).min(Speed::from_bits(speed_bits(v))).max(least);
            reached = v_out == span.v_out;
        }
        if !full || self.orders.mode.uneven {
            let mut v_next = min(v, self.orders.pace.next(span));
            if span.limits.varies() {
                v_next = min(v_next, speed_f32(span.v_out.to_bits()) * self.orders.pace.part(span.level));
            }
            let v_next = Speed::from_bits(speed_bits(v_next));
            let slower = v_out.min(v_next);
            reached |= slower == v_next;
            if slower >= v_in || span.can_leave(v_in, slower) {
                v_out = slower;
            } else if let Some(brake) =
                Brake::plan(&mut self.profile, &motion, end, planned, span.braking(), slower.to_bits())
            {
                self.brake(k, &brake);
                return Made::Otherwise;
            }
        }
        if let Some(committed) = self.committed.get_mut(k) {
            (committed.limit, committed.leaves) = (v, v_out);
        }
        Made::Suited(if reached { Fit::Whole } else { Fit::Part })
    }

    /// Gives the span `k` a braking, whose first tick is known. The rest of the span gets its own profile.
    #[inline(never)]
    pub(super) fn brake(&mut self, k: usize, brake: &Brake) {
        self.frontier.emitter.begin_brake(&self.profile, brake);
        let Some(committed) = self.committed.get_mut(k) else { return };
        let v_out = Speed::from_bits(brake.v_out);
        self.frontier.speed = v_out;
        self.frontier.stops = v_out == Speed::ZERO;
        let left = committed.end().wrapping_sub(brake.end);
        if left > NOTHING {
            committed.begin_at(brake.end, v_out);
            self.frontier.planned = k;
            self.frontier.pending_dwell = 0;
            self.orders.mode.halting = self.frontier.stops;
            return;
        }
        self.frontier.planned = k + 1;
        self.frontier.pending_dwell = u64::from(committed.rest);
        committed.leaves = v_out;
        self.lower();
    }

    /// Lowers the first speed of the ring, because the current profile ends slower than planned. If the
    /// profile is not valid yet, the ring changes only when the profile becomes valid.
    pub(super) fn lower(&mut self) {
        #[cfg(feature = "plc")]
        if self.orders.asking {
            return;
        }
        if self.frontier.planned != self.committed.len() || self.reserve.is_made() {
            return;
        }
        if !self.reserve.pending.as_mut().is_some_and(Pending::lower_later) {
            self.committed.lower(self.frontier.planned, self.frontier.speed);
            self.lookahead.start_at(self.frontier.speed);
        }
    }
}
