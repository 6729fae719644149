//! Applies a change of override or of reduced speed to profiles that are already in the queue.
//!
//! The planner computes the motion a few ticks ahead, as for a feed hold, and the interrupt changes to a new
//! profile there. In the new profile, the motion brakes to the new speed; if the override rises, only its
//! acceleration ends. The rest of the span then gets another profile for the new speed. The change begins
//! only with the next span if the current one is nearly over, or already brakes. A span that already brakes
//! changes only if its old speed limit is far below the new one. Spans without a profile get theirs later,
//! for the new speed.
use super::committed::CommittedSpan;
use super::descent::Descent;
use super::{Brake, Commands, Planning, Speed, Work, clock};
use crate::lookahead::Block;
use crate::math::float::{max, min};
use crate::nc::SlopeType;
use crate::quantity::{speed_bits, speed_f32};

/// A profile that brakes is replaced if it was made for a speed lower by this factor.
const CRAWL: f32 = 2.0;

/// Ticks of motion in the queue that are enough with HSC.
const AHEAD: u32 = 1024;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Sets the override for all later profiles. Returns `false` if the override has not changed.
    pub(super) fn set_pace(&mut self, commands: &Commands) -> bool {
        let before = self.orders.pace;
        self.orders.pace.follow(commands);
        if self.orders.pace == before {
            return false;
        }
        let level = self.level();
        for committed in self.committed.from(0).filter(|committed| committed.span.level < level) {
            committed.span.raise(level);
        }
        if self.lookahead.ring.is_empty() {
            self.follow_level();
        }
        self.orders.mode.adjusting = true;
        true
    }

    /// The planned override for the current override. Only HSC has values below 100 %: spans of other slopes
    /// have a single speed.
    pub(super) fn level(&self) -> f32 {
        let level = self.orders.pace.level();
        if self.dynamics.slope() == SlopeType::Hsc { level } else { max(level, 1.0) }
    }

    /// Whether the queue has so much motion that no further span of HSC is released. A released span keeps
    /// its planned override.
    pub(super) fn keeps_ahead(&self, now: u32) -> bool {
        self.frontier.end.wrapping_sub(now) > clock::TICK * AHEAD
            && self.lookahead.ring.first().is_some_and(Block::varies)
    }

    /// Plans the ring for the current planned override, if the motion enters the ring slowly enough. Call
    /// this function only when all profiles are made, before a plan begins.
    pub(super) fn follow_level(&mut self) {
        let (before, level) = (self.lookahead.ring.level(), self.level());
        let empty = self.lookahead.ring.is_empty();
        let made = self.frontier.planned == self.committed.len();
        if level == before || !(empty || made) {
            return;
        }
        let ends = [self.frontier.speed, self.unslowed_end(level)];
        if !self.lookahead.set_level(level, ends) {
            return;
        }
        if level < before && !empty {
            // If the override rises again, these spans must not end faster than the next block begins.
            self.committed.lower(self.frontier.planned, self.lookahead.ring.first_speed());
        }
        self.dynamics.set_level(max(level, 1.0));
        self.renew_held();
    }

    /// The speed at which the last profile would end without the effect of the override. If the profile was
    /// made for another override, there is no limit.
    fn unslowed_end(&self, level: f32) -> Speed {
        let v = self.frontier.speed;
        let last = self.committed.len().checked_sub(1).and_then(|k| self.committed.get(k));
        let part = self.orders.pace.part(level);
        if last.is_some_and(|last| last.pace != self.orders.pace.key()) {
            Speed::from_bits(i64::MAX)
        } else if part < 1.0 {
            Speed::from_bits(speed_bits(speed_f32(v.to_bits()) / part)).max(v)
        } else {
            v
        }
    }

    /// Whether the ring is planned for another override than the current one, may be able to follow, and has
    /// time.
    pub(super) fn has_other_level(&self) -> bool {
        let level = self.level();
        level != self.lookahead.ring.level()
            && self.task.refused_level != Some((self.frontier.end, level))
            && self.is_far(self.frontier.end)
    }

    /// Plans the ring for the current planned override, if the ring can follow. The check looks at all
    /// blocks, so it is done once for each end of the queue.
    pub(super) fn try_level(&mut self) -> Work {
        let (ring, level) = (&self.lookahead.ring, self.level());
        if level > ring.level() || self.frontier.speed <= ring.entry_for(level) {
            return self.plan_anew();
        }
        self.task.refused_level = Some((self.frontier.end, level));
        Work::Working
    }

    /// Whether the profile was made for another override and has to change.
    fn differs(&self, committed: &CommittedSpan) -> bool {
        let v = self.orders.pace.limit(&committed.span);
        let slower =
            || committed.leaves.to_bits() > speed_bits(min(v, self.orders.pace.next(&committed.span)));
        committed.pace != self.orders.pace.key() && (v != committed.limit || slower())
    }

    /// A braking inside the span `k` from the instant `at` on, to the current speed limit.
    #[inline(never)]
    fn slower_from(&mut self, k: usize, at: u32) -> Option<Brake> {
        let motion = self.motion_at(at)?;
        let begins = self.committed.begins(k);
        let committed = self.committed.get_mut(k)?;
        committed.look(begins, motion.distance);
        let v = self.orders.pace.limit(&committed.span);
        let target = speed_bits(v);
        // The existing braking stays, unless it is slower by [`CRAWL`].
        let crawls = v > CRAWL * committed.limit;
        if motion.accel < 0 && motion.speed <= target && !crawls {
            return None;
        }
        let (end, v_out) = (committed.end(), committed.span.v_out.to_bits());
        let brake = Brake::plan(&mut self.profile, &motion, end, v_out, committed.span.braking(), target)?;
        let goes = motion.accel >= 0 || motion.speed > target || brake.ends_at_once(&motion, end);
        goes.then_some(brake)
    }

    /// Replaces the profiles in the queue, beginning with the first one that differs.
    #[inline(never)]
    pub(super) fn adjust(&mut self) -> Option<Work> {
        let (at, later) = self.attempt()?;
        let mut left = false;
        let mut next = later;
        if let Some((k, committed)) = later.checked_sub(1).and_then(|k| Some((k, self.committed.get(k)?))) {
            if committed.first == at {
                next = k;
            } else if self.differs(committed) && at != self.frontier.end {
                left = true;
                if let Some(brake) = self.slower_from(k, at) {
                    return self.change(k, at, Some(Descent::inside(brake)));
                }
            }
        }
        let other =
            (next..self.frontier.planned).find(|&k| self.committed.get(k).is_some_and(|f| self.differs(f)));
        if let Some(k) = other {
            let k = self.with_tick(k);
            if let Some(first) = self.committed.get(k).map(|committed| committed.first) {
                return if self.is_far(first) { None } else { self.change(k, first, None) };
            }
        }
        self.orders.mode.adjusting = left;
        None
    }
}
