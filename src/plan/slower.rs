//! Slows the motion down if the stop of a new reserve has no room, until the stops fit.
//!
//! A stop has no room in two cases: it needs more pieces than the memory has ([`crate::queue::Keeper`]), or
//! it ends beyond the curves that the interrupt knows. The planner then takes these steps:
//!
//! 1. Set a speed cap for all profiles ([`crate::lookahead::Pace::set_cap`]), at 0.7 of the speed at which
//!    the stop begins.
//! 2. Withdraw the pieces that are not valid yet. All pieces after the start of the reserve in force are of
//!    this kind, because the interrupt would leave the queue there.
//! 3. Make these profiles and the reserve again. If the new stop has no room either, repeat the steps with a
//!    lower cap.
//!
//! The reserve in force stays meanwhile. If no new reserve is complete in time, the interrupt uses the
//! reserve in force, and the axes stop.
//!
//! A start after a standstill, or a new profile by a command, is withdrawn and tried again in the same way.
//!
//! When a new reserve leaves room, the planner raises the cap by a step. So the speed settles where the stops
//! just fit.
use super::committed::CommittedSpan;
use super::{Brake, Instant, KEPT_FREE, PIECES, Planning, RingStage, Speed, clock};
use crate::math::float::{max, min};
use crate::math::root::sqrt_f32;
use crate::quantity::{speed_bits, speed_f32};
use crate::queue::{PHASES, WAY_PIECES};

/// Each try has this part of the speed of the try before.
const PART: f32 = 0.7;
/// No try is below this part of the speed at which the reserve in force begins. The next profile begins at
/// that speed in any case, so its stop hardly gets shorter.
const LEAST_PART: f32 = 1.0 / 4.0;

/// Number of pieces, about three quarters of the room for a stop. If a stop has fewer pieces, the cap rises
/// to the speed whose stop has this number. The number of pieces grows with the square of the speed.
const FULL: f32 = WAY_PIECES as f32 * (100.0 / 128.0);

/// Lowest cap: an LSB of the path distance per tick, mm, which is a standstill. Nothing is faster than
/// [`MOST`], so from there on there is no cap.
const LEAST: f32 = 1.0 / (1u64 << 44) as f32;
const MOST: f32 = 256.0;

/// Margin for rounding of a speed.
const CLOSE: f32 = 1.0 + 1.0 / 65_536.0;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Handles a reserve without room. Always returns `false`.
    #[cold]
    #[inline(never)]
    pub(super) fn fail(&mut self) -> bool {
        self.drop_aside();
        let end = self.frontier.end;
        let v = self.motion_at(end).map_or(0.0, |motion| speed_f32(motion.speed));
        let is_above = v > self.orders.pace.cap() * CLOSE;
        if self.reserve.pending.is_some() {
            let starts = !self.reserve.renews_law();
            if self.task.stage == RingStage::Passing && !starts {
                // A stop may be found when the plan of the look-ahead is complete.
                self.reserve.waits = true;
                self.undo();
            } else if !starts {
                // The earlier state is restored and continues. The planner tries again when the motion is
                // slower.
                self.undo();
                if !is_above {
                    self.slow(v);
                }
            } else if self.slow(v) {
                self.undo();
                self.start_slower();
            } else if self.hand_over(None) {
                self.take_over();
            }
        } else {
            self.reserve.failed = Some(end);
            if !(is_above && self.has_room()) && self.slow(v) {
                self.go_back();
            }
        }
        self.orders.mode.busy |= self.reserve.slowed;
        false
    }

    /// Whether profiles that enter the queue have not yet come down to the speed that may permit a stop.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn comes_down(&self) -> bool {
        let cap = self.orders.pace.cap();
        cap < f32::MAX && speed_f32(self.frontier.speed.to_bits()) > cap * CLOSE && self.has_room()
    }

    /// Whether the next piece has room in the reserve.
    fn has_room(&self) -> bool {
        self.queue.phases.room() >= PIECES + KEPT_FREE
            && !self.committed.is_full()
            && !self.queue.segments.is_sated()
    }

    /// Lowers the cap to a part of `v`, and below the cap tried before. Returns `false` if the cap cannot be
    /// lower.
    fn slow(&mut self, v: f32) -> bool {
        let cap = self.orders.pace.cap();
        let v = if v > 0.0 { min(v, cap) } else { cap };
        let start = self.reserve.kept.and_then(|way| self.motion_at(way.at));
        let start = start.map_or(0.0, |motion| speed_f32(motion.speed));
        if v == f32::MAX || v * PART < max(LEAST, start * LEAST_PART) {
            return false;
        }
        self.reserve.slowed |= cap == f32::MAX;
        self.orders.pace.set_cap(v * PART);
        true
    }

    /// Raises the cap after a complete reserve, if the reserve left much room.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn rise(&mut self) {
        if self.orders.pace.cap() < f32::MAX {
            self.rise_a_step();
        }
    }

    #[cold]
    #[inline(never)]
    fn rise_a_step(&mut self) {
        let rise = FULL / self.queue.reserve.written().max(1) as f32;
        if rise > 1.0 {
            let cap = self.orders.pace.cap() * sqrt_f32(rise);
            self.orders.pace.set_cap(if cap < MOST { cap } else { f32::MAX });
        }
    }

    /// Makes the emitter's profile again, which begins at a stop, together with the profiles before it that
    /// have no tick.
    fn start_slower(&mut self) {
        let at = self.frontier.end;
        let Some(mut k) = self.frontier.planned.checked_sub(1) else { return };
        let has_no_tick = |before: &CommittedSpan| before.first == at && before.leaves > Speed::ZERO;
        while k > 0 && self.committed.get(k - 1).is_some_and(has_no_tick) {
            k -= 1;
        }
        self.begin_again(k);
    }

    /// Makes the span `k` the next one that gets a profile, from its start.
    fn begin_again(&mut self, k: usize) {
        let Some(committed) = self.committed.get(k) else { return };
        (self.frontier.planned, self.frontier.speed) = (k, committed.enters);
        self.frontier.emitter.resume_at(committed.next);
        (self.frontier.stops, self.frontier.pending_dwell) = (false, 0);
        self.orders.mode.uneven = true;
        self.committed.restore_from(k + 1);
    }

    /// Withdraws the pieces after the start of the reserve in force. New profiles replace them.
    fn go_back(&mut self) {
        let Some(at) = self.reserve.kept.map(|way| way.at) else { return };
        let mode = &self.orders.mode;
        let commanded = mode.stopping || mode.halting || self.task.joining || self.reserve.behind.is_some();
        if commanded || self.queue.clock.has_left() || !clock::is_before(self.queue.clock.now(), at) {
            return;
        }
        let Some(motion) = self.motion_at(at) else { return };
        let planned = self.frontier.planned;
        let ahead = |committed: &CommittedSpan| committed.end().wrapping_sub(motion.distance) > 0;
        let Some(k) = (0..planned).find(|&k| self.committed.get(k).is_some_and(ahead)) else { return };
        let ends = |k: usize| {
            let stands = |committed: &CommittedSpan| committed.leaves == Speed::ZERO && k + 1 < planned;
            self.committed.get(k).is_some_and(|committed| committed.rest > 0 || stands(committed))
        };
        if (k..planned).any(ends) {
            return;
        }
        let begins = self.committed.get(k).is_some_and(|committed| committed.first == at);
        if !begins && self.slow_down_from(k, at, &motion) {
            return;
        }
        let begins_behind = |committed: &CommittedSpan| !clock::is_before(committed.first, at);
        let next =
            (k..planned).rev().take_while(|&k| self.committed.get(k).is_some_and(begins_behind)).last();
        if let Some(next) = next
            && let Some(first) = self.committed.get(next).map(|committed| committed.first)
            && self.take_back_from(first)
        {
            self.begin_again(next);
        }
    }

    /// Brakes to the permitted speed from the instant `at` on, inside the span `k`. Returns `false` if the
    /// motion already does so, or cannot.
    fn slow_down_from(&mut self, k: usize, at: u32, motion: &Instant) -> bool {
        let begins = self.committed.begins(k);
        let Some(committed) = self.committed.get_mut(k) else { return false };
        let before = *committed;
        if committed.start.to_bits().wrapping_sub(motion.distance) > 0 {
            // The span was slowed down before, and begins anew.
            committed.restore(begins);
        }
        committed.look(begins, motion.distance);
        let (end, span) = (committed.end(), &committed.span);
        let target = speed_bits(self.orders.pace.limit(span));
        let slows = motion.accel < 0 && motion.speed <= target;
        let (v_out, limits) = (span.v_out.to_bits(), span.braking());
        let brake = if slows {
            None
        } else {
            Brake::plan(&mut self.profile, motion, end, v_out, limits, target)
                .filter(|brake| motion.accel >= 0 || motion.speed > target || brake.ends_at_once(motion, end))
        };
        let Some(brake) = brake.filter(|_| self.take_back_from(at)) else {
            if let Some(committed) = self.committed.get_mut(k) {
                *committed = before;
            }
            return false;
        };
        if let Some(committed) = self.committed.get_mut(k)
            && clock::is_before(at, committed.first)
        {
            committed.first = at;
        }
        self.frontier.emitter.resume_at(0);
        self.frontier.stops = false;
        self.orders.mode.uneven = true;
        self.brake(k, &brake);
        self.committed.restore_from(k + 1);
        true
    }

    /// Withdraws the pieces from the instant `at` on. They are after the start of the reserve in force, where
    /// the interrupt leaves the queue. Returns `false` if no piece begins there.
    fn take_back_from(&mut self, at: u32) -> bool {
        let (mut start, mut number) = (self.frontier.end, self.queue.phases.count());
        for _ in 0..PHASES {
            if start == at {
                break;
            }
            number = number.wrapping_sub(1);
            let Some(ticks) = self.queue.phases.recent(number).map(|phase| phase.ticks) else { return false };
            start = start.wrapping_sub(clock::TICK * u32::from(ticks));
        }
        if start != at {
            return false;
        }
        self.queue.phases.withdraw(number);
        // On another core, a tick in progress may still read the queue.
        self.queue.clock.settle();
        self.frontier.end = at;
        true
    }
}
