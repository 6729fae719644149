//! The law of the next span that has none: the one planned, or what has to take its place.
//!
//! A law is planned for the speed at which its span is entered, all of the span, and the pace of then. Behind a
//! standstill, a change of the pace or a span that ended slower it is another one:
//!
//! - of several blocks, what is left of the planned law, or one below it at each place, at a part of its speed: any
//!   other law would have to be compared with every block again ([`CommittedSpan::go_on`]);
//! - else one within the limit that the pace has for it, entered at the speed of now: of several blocks that of the
//!   slowest one, or the speed at which the planned law cruises ([`CommittedSpan::look`]);
//! - or a slowing down to that limit.
use super::change::Pending;
use super::committed::CommittedSpan;
use super::hold::NOTHING;
use super::{Brake, Instant, Planning, Speed, Time, Unplannable};
use crate::lookahead::{Gain, GoingOn};
use crate::math::float::{max, min, size_f32, to_f32};
use crate::quantity::{DISTANCE_LSB, speed_bits, speed_f32};

/// No law at a part of its speed is longer: 2^26 ticks.
const LONGEST: Time = Time::from_bits(1 << (26 + 36));

/// How far a new law follows the planned one.
#[derive(Clone, Copy, PartialEq)]
enum Fit {
    /// Its end speed, or that of now.
    Whole,
    /// A lower one.
    Part,
}

/// What became of the law of a span that is not the one planned.
enum Made {
    /// Its speeds are known.
    Suited(Fit),
    /// It is in the profile.
    Planned,
    /// Another one took its place, up to somewhere in the span: it is handed out.
    Otherwise,
    /// It is still being looked for.
    Later,
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Makes the law of the next span that has none. `false`: it is still being looked for, and nothing has changed.
    pub(super) fn lay(&mut self) -> Result<bool, Unplannable> {
        let made = self.make_law();
        self.note_passed();
        made
    }

    /// Makes the law of the next span that has none, and leaves spans behind it as they are
    /// ([`Self::note_passed`]). `false`: it is still being looked for.
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

    /// Makes the law of the span `k` the one planned, or what is left of that, at a part of its speed, if
    /// that is the one of now, or the one at which the span is entered.
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
            // The change is what has to fit: of the end speed alone it would be rounded by far more.
            let change = speed_bits(speed_f32((to - from).abs()) * part);
            let leaves = v_in.to_bits() + if to < from { -change } else { change };
            if self.plan_at(k, part, None, Speed::from_bits(leaves.max(0))) {
                return Some(Made::Planned);
            }
        }
        self.committed.get_mut(k)?.span.slow.cruise = 0.0;
        None
    }

    /// Makes the law of what is left of the span `k` one that is below what was planned for all of it, at the part of
    /// its speed that is the one of now.
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
        // At a low override it gains speed so slowly that the slowest block may be sooner at the end.
        let way = to_f32(span.length.to_bits()) * DISTANCE_LSB;
        let ticks = size_f32(self.profile.time().to_bits()) * (1.0 / (1u64 << 36) as f32);
        if ticks * (span.slow.shared * part) > way {
            return None;
        }
        span.slow.ceiling = max(span.slow.ceiling, *limit);
        Some(Made::Planned)
    }

    /// Makes the law of the span `k` one with its limits, and those of `most`, at a part of their speed, that ends at
    /// `v_out`. `false`: there is none.
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

    /// What the law of the span `k` may be when it is not the one planned: its limit and its end speed. It may slow
    /// down instead.
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

    /// The law of the span `k` is a slowing down. Its first tick is known. What it leaves of the span gets a
    /// law of its own.
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

    /// The law at hand ends slower than it was planned: what is still in the ring begins so, and relies on
    /// it. Where that law does not count yet, so once it does: all may still be as it was before.
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
