//! Limits of axis positions that a PLC moves (FCT_DYN_POS_LIMIT): a feed hold that stops the axes before a limit.
//!
//! In each tick the planner asks where the axes would stand if a feed hold came a little later: the question
//! `Standstill` with a lead. If the way to this stop exceeds a limit, the hold comes now. The lead is the number of
//! ticks that the last answer took, and at least one. The axes so stand before the limit, at most as far as they drive
//! in these ticks. The stop is that of a feed hold, and keeps all limits of the axes.
//!
//! The hold ends when the PLC has changed a limit and the way ahead is free.
use super::{Inquiry, Planning, clock};
use crate::contour_log::{LimitState, LimitsNow, PositionLimits, Side, Unknown};
use crate::machine::InterpolatorFunctions as Functions;
use crate::queue::Cut;

/// Points of the way to the stop that are compared with the limits.
const POINTS: i64 = 20;

/// While the planner has other work, one call of so many serves the limits.
const EVERY: u8 = 8;

/// Highest lead, ticks.
const FURTHEST: u32 = 64;

/// Ticks after a start in which the axes may move before they can stop again.
const START: u32 = 6;

/// The supervision of the limits.
pub(super) struct Watch<'q, const AXES: usize> {
    limits: &'q PositionLimits<AXES>,
    /// Changes of the limits that are known while a limit holds the axes.
    known: u32,
    /// The instant of the last question, and whether the question is answered.
    asked: u32,
    answered: bool,
    /// Ticks by which a question looks ahead.
    lead: u32,
    /// Calls since the last question.
    calls: u8,
}

impl<'q, const AXES: usize, const BLOCKS: usize> Planning<'q, AXES, BLOCKS> {
    /// Lets a PLC limit the positions of axes. `inquiry`: memory for the question where a hold would stop the axes.
    ///
    /// # Errors
    /// FCT_DYN_POS_LIMIT is not in P-CHAN-00650.
    pub fn set_limits(
        &mut self,
        limits: &'q PositionLimits<AXES>,
        inquiry: &'q mut Inquiry,
    ) -> Result<(), Unknown> {
        if !self.intake.machine.channel.interpolator.has(Functions::DYN_POS_LIMIT) {
            return Err(Unknown::NotEnabled("FCT_DYN_POS_LIMIT"));
        }
        limits.tell(LimitState::Free);
        self.set_inquiry(inquiry);
        // No instant is odd, so the first question is due.
        self.intake.watch = Some(Watch { limits, known: 0, asked: 1, answered: true, lead: 1, calls: EVERY });
        Ok(())
    }

    /// Compares the way to the next stop with the limits. `is_free`: whether the planner has no other work. Returns
    /// whether the call was used.
    #[inline(always)]
    pub fn watch_limits(&mut self, is_free: bool) -> bool {
        if self.intake.watch.is_none() { false } else { self.watch(is_free) }
    }

    #[inline(never)]
    fn watch(&mut self, is_free: bool) -> bool {
        let Some(mut watch) = self.intake.watch.take() else { return false };
        let used = self.supervise(&mut watch, is_free);
        self.intake.watch = Some(watch);
        used
    }

    fn supervise(&mut self, watch: &mut Watch<'q, AXES>, is_free: bool) -> bool {
        if self.queue.control.is_limited() {
            self.stay_within_limits(watch);
            return false;
        }
        let now = self.queue.clock.now();
        watch.calls = watch.calls.saturating_add(1);
        if watch.answered && (now == watch.asked || (!is_free && watch.calls < EVERY)) {
            return false;
        }
        if self.is_idle()
            || self.reserve.is_made()
            || self.reserve.pending.is_some()
            || self.queue.clock.has_left()
        {
            return false;
        }
        let Some(limits) = watch.limits.now() else { return false };
        if limits.are_none() {
            return false;
        }
        if watch.answered {
            (watch.asked, watch.answered) = (now, false);
        }
        let stop = self.standstill_after(watch.asked, watch.lead);
        if stop == Err(Unknown::Searching) {
            return true;
        }
        (watch.answered, watch.calls) = (true, 0);
        let Ok(stands) = stop else { return false };
        let took = now.wrapping_sub(watch.asked) / clock::TICK;
        watch.lead = (took + 1).min(FURTHEST);
        let motion = self.motion_at(now);
        let here = motion.map_or_else(|| self.motion_end(), |motion| motion.distance);
        let mut way = stands.wrapping_sub(here).max(0);
        if motion.is_none_or(|motion| motion.is_rest()) {
            way = way.max(self.start_way());
        }
        let Some((axis, side)) = self.first_beyond(&limits, here, way) else { return false };
        watch.known = watch.limits.changes();
        watch.limits.tell(LimitState::Braking(axis, side));
        self.queue.control.limit(true);
        // The hold is carried out in the next call, before the next tick.
        true
    }

    /// The path distance of the stop if a hold came `lead` ticks after the instant `asked`.
    fn standstill_after(&mut self, asked: u32, lead: u32) -> Result<i64, Unknown> {
        if self.orders.mode.is_standing() {
            return Ok(self.motion_end());
        }
        let Some(inquiry) = self.intake.inquiry.take() else { return Err(Unknown::NotPlanned) };
        let known = self.try_hold((asked, lead), inquiry);
        if !matches!(known, Err(Unknown::Searching)) {
            inquiry.end_trial();
        }
        self.intake.inquiry = Some(inquiry);
        known.map(|(_, stands)| stands)
    }

    /// The first limit that a point of the path exceeds, from a path distance over a way.
    fn first_beyond(&self, limits: &LimitsNow<AXES>, here: i64, way: i64) -> Option<(usize, Side)> {
        (0..=POINTS).find_map(|k| {
            let along = (way / POINTS).wrapping_mul(k).wrapping_add(way % POINTS * k / POINTS);
            let (_, _, point) = self.place(here.wrapping_add(along))?;
            limits.beyond(&point)
        })
    }

    /// A way in which the axes can start and stop again, LSB 2^-44 mm.
    fn start_way(&self) -> i64 {
        let machine = self.intake.machine;
        let accel = machine.axes.iter().map(|axis| axis.a_max.max(axis.a_grenz)).max().unwrap_or(0);
        let us = u64::from(machine.channel.cycle_us) * u64::from(self.orders.lead + START);
        // mm/s² times µs², divided by 10^12 and times 2^44.
        let way = u128::from(accel) * u128::from(us) * u128::from(us);
        i64::try_from((way << 44) / 1_000_000_000_000).unwrap_or(i64::MAX)
    }

    /// While a limit holds the axes: tells the state, and ends the hold when the PLC has made the way free.
    fn stay_within_limits(&mut self, watch: &mut Watch<'q, AXES>) {
        if self.is_idle() {
            self.queue.control.limit(false);
            watch.limits.tell(LimitState::Free);
            return;
        }
        let now = self.queue.clock.now();
        // Pieces before a change are not in the order of time.
        if self.orders.mode.cut.is_some_and(|Cut(at)| clock::is_before(now.wrapping_sub(clock::TICK), at)) {
            return;
        }
        let Some(limits) = watch.limits.now() else { return };
        if !self.orders.mode.is_standing() {
            // The stop is not known yet, or the axes pass the limit before it.
            let next = now.wrapping_add(clock::TICK);
            let here = self.motion_at(next).map(|motion| motion.distance);
            if let Some((axis, side)) = here.and_then(|here| self.first_beyond(&limits, here, 0)) {
                watch.limits.tell(LimitState::Exceeded(axis, side));
            }
            return;
        }
        let end = self.motion_end();
        let changes = watch.limits.changes();
        let (LimitState::Braking(axis, side)
        | LimitState::Standing(axis, side)
        | LimitState::Exceeded(axis, side)) = watch.limits.state()
        else {
            return;
        };
        if self.is_holding() && changes != watch.known {
            watch.known = changes;
            if self.first_beyond(&limits, end, self.start_way()).is_none() {
                watch.limits.tell(LimitState::Free);
                self.queue.control.limit(false);
                return;
            }
        }
        // The axes may pass a limit on the way to a stop inside of the limit.
        let here = self.motion_at(now).map_or(end, |motion| motion.distance);
        let state = match self.first_beyond(&limits, here, end.wrapping_sub(here).max(0)) {
            _ if matches!(watch.limits.state(), LimitState::Exceeded(..)) => return,
            Some((axis, side)) => LimitState::Exceeded(axis, side),
            None if self.is_holding() => LimitState::Standing(axis, side),
            None => LimitState::Braking(axis, side),
        };
        watch.limits.tell(state);
    }
}
