//! Override and reduced speed in laws that are already in the queue.
//!
//! The planner finds the motion a few ticks ahead, as for a feed hold, and has the interrupt change over there.
//! Either the motion slows down to the new speed from there on, or its acceleration ends. The rest of the span then
//! has a law of its own with the new speed. The change begins with the next span where too little of this one is left,
//! or where the motion slows down in it anyway, unless that is at a crawl. Spans without a law get the right one when
//! it is made.
use super::committed::CommittedSpan;
use super::descent::Descent;
use super::{Brake, Commands, Planning, Speed, Work, clock};
use crate::lookahead::Block;
use crate::math::float::{max, min};
use crate::nc::SlopeType;
use crate::quantity::{speed_bits, speed_f32};

/// A law that was made for so many times less speed ends even where it slows down.
const CRAWL: f32 = 2.0;

/// Ticks of motion in the queue that are enough, with HSC.
const AHEAD: u32 = 1024;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// The pace of the commands, for all laws to be made. `false`: it is the one of before.
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

    /// The level that the pace needs. Below 100 % there is none but with HSC: the others have spans of one
    /// speed.
    pub(super) fn level(&self) -> f32 {
        let level = self.orders.pace.level();
        if self.dynamics.slope() == SlopeType::Hsc { level } else { max(level, 1.0) }
    }

    /// Whether there is so much motion in the queue that no other span of HSC is handed on: it keeps the
    /// level it was planned for.
    pub(super) fn keeps_ahead(&self, now: u32) -> bool {
        self.frontier.end.wrapping_sub(now) > clock::TICK * AHEAD
            && self.lookahead.ring.first().is_some_and(Block::varies)
    }

    /// The ring is planned for the level of now, if the motion enters it slowly enough. Only when all laws
    /// are made, before a plan begins.
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
            // With a higher override again, they do not end faster than what is behind begins.
            self.committed.lower(self.frontier.planned, self.lookahead.ring.first_speed());
        }
        self.dynamics.set_level(max(level, 1.0));
        self.renew_held();
    }

    /// The speed at which the last law would end if the override took nothing from it. One of another pace gets another
    /// end.
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

    /// Whether the ring is planned for another level than that of now, may be able to follow it, and there is time.
    pub(super) fn has_other_level(&self) -> bool {
        let level = self.level();
        level != self.lookahead.ring.level()
            && self.task.refused_level != Some((self.frontier.end, level))
            && self.is_far(self.frontier.end)
    }

    /// The ring is planned anew for the level of now, if it can follow that. To know takes a look at all blocks: it is
    /// asked once for each end of the queue.
    pub(super) fn try_level(&mut self) -> Work {
        let (ring, level) = (&self.lookahead.ring, self.level());
        if level > ring.level() || self.frontier.speed <= ring.entry_for(level) {
            return self.plan_anew();
        }
        self.task.refused_level = Some((self.frontier.end, level));
        Work::Working
    }

    /// Its law was made for another pace, and is not the one of now.
    fn differs(&self, committed: &CommittedSpan) -> bool {
        let v = self.orders.pace.limit(&committed.span);
        let slower =
            || committed.leaves.to_bits() > speed_bits(min(v, self.orders.pace.next(&committed.span)));
        committed.pace != self.orders.pace.key() && (v != committed.limit || slower())
    }

    /// A slowing down inside the span `k` from the instant `at` on, to the pace of now.
    #[inline(never)]
    fn slower_from(&mut self, k: usize, at: u32) -> Option<Brake> {
        let motion = self.motion_at(at)?;
        let begins = self.committed.begins(k);
        let committed = self.committed.get_mut(k)?;
        committed.look(begins, motion.distance);
        let v = self.orders.pace.limit(&committed.span);
        let target = speed_bits(v);
        // It slows down as it is, unless that takes many times longer.
        let crawls = v > CRAWL * committed.limit;
        if motion.accel < 0 && motion.speed <= target && !crawls {
            return None;
        }
        let (end, v_out) = (committed.end(), committed.span.v_out.to_bits());
        let brake = Brake::plan(&mut self.profile, &motion, end, v_out, committed.span.braking(), target)?;
        let goes = motion.accel >= 0 || motion.speed > target || brake.ends_at_once(&motion, end);
        goes.then_some(brake)
    }

    /// Laws of now in place of those in the queue, from the first one that differs on.
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
