//! Answers the questions of a PLC about the coming motion (feature `plc`). A PLC asks for the state at a
//! later tick, for the next block at feed, or for the point where a feed hold would stop the axes.
//!
//! The first two answers are read from the pieces in the queue. For the third answer, the planner makes the
//! profiles of a feed hold on a copy of its spans ([`Inquiry`]). These profiles do not enter the queue. With
//! FCT_CALC_POS_V_0 in the machine data (P-CHAN-00650), a feed hold keeps its first stop, and does not search
//! for a shorter one. So the axes stop at the point of the answer.
use super::committed::CommittedSpans;
use super::hold::Mode;
use super::search::{Later, Search};
use super::{Distance, Frontier, Instant, KEPT_FREE, Phase, Planning, Profile, RingStage, Speed, clock};
use crate::contour_log::{Moment, Question, Unknown};
use crate::machine::InterpolatorFunctions as Functions;
use crate::quantity::Position;
use crate::queue::{Cut, PHASES};

/// Largest number of profiles of a stop.
const LAWS: usize = 64;

/// Memory for the question where a hold would stop the axes: a copy of the state that a hold changes.
pub struct Inquiry {
    spans: CommittedSpans,
    trial: Option<Trial>,
}

/// A trial of a hold, between two calls.
struct Trial {
    frontier: Frontier,
    mode: Mode,
    search: Search,
    profile: Profile,
    behind: Option<i64>,
    step: Step,
    /// State of the look-ahead at the start of the trial; a change ends the trial.
    handed: Distance,
    stage: RingStage,
    /// The instant of the question, and the ticks from there to the hold.
    asked: u32,
    ahead: u32,
}

#[derive(Clone, Copy)]
enum Step {
    /// Leave the current profile at the instant `at`, inside span `k`.
    Leave { k: usize, at: u32, motion: Instant },
    /// Leave the current profile at the start of this span.
    Enter(usize),
    /// Make profiles for spans without one.
    Laws,
}

impl Inquiry {
    /// Memory that holds no question yet.
    pub const fn new() -> Self {
        Self { spans: CommittedSpans::new(), trial: None }
    }

    /// Ends the trial, because its question is answered.
    pub(super) fn end_trial(&mut self) {
        self.trial = None;
    }
}

impl Default for Inquiry {
    fn default() -> Self {
        Self::new()
    }
}

impl<'q, const AXES: usize, const BLOCKS: usize> Planning<'q, AXES, BLOCKS> {
    /// Gives the planner the memory for the question FCT_CALC_POS_V_0: where would a feed hold stop the axes?
    pub fn set_inquiry(&mut self, inquiry: &'q mut Inquiry) {
        self.intake.inquiry = Some(inquiry);
    }

    /// Whether a hold keeps the stop with which it begins (FCT_CALC_POS_V_0, FCT_DYN_POS_LIMIT).
    pub(super) const fn keeps_stop(&self) -> bool {
        let interpolator = &self.intake.machine.channel.interpolator;
        interpolator.has(Functions::CALC_POS_V_0) || interpolator.has(Functions::DYN_POS_LIMIT)
    }

    /// Marks the current profile as final for a hold, if `stays` is true and a hold keeps the stop with which
    /// it begins. The profile is as slow at its end as a hold can be.
    pub(super) const fn settle(&mut self, stays: bool) {
        self.orders.settled = stays && self.keeps_stop();
    }

    /// Answers a question of a PLC about the coming motion.
    ///
    /// # Errors
    /// Returns [`Unknown`] if the planner has no answer now, or if P-CHAN-00650 does not enable the question.
    #[inline(never)]
    pub fn forecast(&mut self, question: Question) -> Result<Moment<AXES>, Unknown> {
        let (function, is_read) = match question {
            Question::StateAt(_) => (Functions::CALC_STATE_AT_T, true),
            Question::NextFeed => (Functions::CALC_TIME, true),
            Question::Standstill => (Functions::CALC_POS_V_0, false),
        };
        if !self.intake.machine.channel.interpolator.has(function) {
            return Err(Unknown::NotEnabled(question.function()));
        }
        if self.reserve.is_made() || self.reserve.pending.is_some() || self.queue.clock.has_left() {
            return Err(Unknown::Busy);
        }
        let now = self.queue.clock.now();
        // Pieces before a change are not in the order of time.
        let last = now.wrapping_sub(clock::TICK);
        if is_read && self.orders.mode.cut.is_some_and(|Cut(at)| clock::is_before(last, at)) {
            return Err(Unknown::Busy);
        }
        match question {
            Question::StateAt(ticks) => self.state_at(now, ticks),
            Question::NextFeed => self.next_feed(now),
            Question::Standstill => self.standstill(now),
        }
    }

    /// Number of planned ticks from now on.
    fn ticks_planned(&self, now: u32) -> u32 {
        if clock::is_before(now, self.frontier.end) {
            self.frontier.end.wrapping_sub(now) / clock::TICK
        } else {
            0
        }
    }

    fn state_at(&self, now: u32, ticks: u32) -> Result<Moment<AXES>, Unknown> {
        let planned = self.ticks_planned(now);
        if ticks == 0 || ticks > planned {
            return Err(Unknown::Beyond { ticks: planned });
        }
        let at = now.wrapping_add(clock::TICK * (ticks - 1));
        let motion = self.motion_at(at).ok_or(Unknown::Busy)?;
        let before = self.motion_at(at.wrapping_sub(clock::TICK));
        let mut moment = self.moment(now, at, motion.distance).ok_or(Unknown::NotPlanned)?;
        moment.speed = Speed::from_bits(motion.speed);
        let from = before.and_then(|before| self.place(before.distance));
        if let Some((_, _, from)) = from {
            let mut travel = [0; AXES];
            for (travel, (to, from)) in travel.iter_mut().zip(moment.set_points.iter().zip(&from)) {
                *travel = to.to_bits().wrapping_sub(from.to_bits());
            }
            // Converts from LSB 2^-44 to 2^-58 mm per tick, as in the status.
            moment.speed = Speed::from_bits(self.measure.path(&travel).to_bits().saturating_mul(1 << 14));
        }
        Ok(moment)
    }

    /// The state at an instant, with speed and acceleration zero.
    fn moment(&self, now: u32, at: u32, distance: i64) -> Option<Moment<AXES>> {
        let (n, block, set_points) = self.place(distance)?;
        let ticks = at.wrapping_sub(now) / clock::TICK + 1;
        let tick = now.wrapping_add(self.queue.clock.idle()) / clock::TICK;
        let tick = tick.wrapping_add(ticks - 1) & (u32::MAX >> 1);
        let distance = Distance::from_bits(distance);
        Some(Moment { tick, ticks, set_points, n, block, distance, speed: Speed::ZERO })
    }

    /// N number, motion block and point at a path distance.
    pub(super) fn place(&self, distance: i64) -> Option<(u32, u32, [Position; AXES])> {
        let segments = &self.queue.segments;
        // At the end of all curves, the last curve counts.
        let number =
            segments.ends_behind(distance).or_else(|| segments.ends_behind(distance.wrapping_sub(1)))?;
        let number = segments.curve_of(number);
        let track = segments.recent(number)?;
        let along = distance.wrapping_sub(segments.start(number));
        Some((track.segment.n, segments.block_of(track.segment), track.point(along)))
    }

    /// The first tick of the next motion block that is not rapid motion.
    fn next_feed(&self, now: u32) -> Result<Moment<AXES>, Unknown> {
        let beyond = Unknown::Beyond { ticks: self.ticks_planned(now) };
        let here = self.motion_at(now).ok_or(beyond)?.distance;
        let (_, mut block, _) = self.place(here).ok_or(Unknown::NotPlanned)?;
        let segments = &self.queue.segments;
        let mut number = segments.ends_behind(here).ok_or(beyond)?;
        let start = loop {
            number = segments.after(number);
            let start = segments.start(number);
            if (number.wrapping_sub(segments.handed()) as i32) >= 0 || self.motion_end() <= start {
                return Err(beyond);
            }
            let next = self.block_of(number).ok_or(beyond)?;
            if next != block && !self.is_rapid(number, next) {
                break start;
            }
            block = next;
        };
        let at = self.instant_of(self.frontier.end, start).ok_or(beyond)?;
        let ticks = at.wrapping_sub(now) / clock::TICK + 1;
        self.state_at(now, ticks)
    }

    /// Path distance at the end of the queue.
    pub(super) fn motion_end(&self) -> i64 {
        self.motion_at(self.frontier.end).map_or(i64::MIN, |motion| motion.distance)
    }

    fn block_of(&self, number: u32) -> Option<u32> {
        let segments = &self.queue.segments;
        segments.recent(number).map(|track| segments.block_of(track.segment))
    }

    /// Whether a motion block is rapid motion, from the spans of its curves beginning with `first`. The curve
    /// of a corner next to a block at feed has no effect.
    fn is_rapid(&self, first: u32, block: u32) -> bool {
        let segments = &self.queue.segments;
        let mut number = first;
        while (number.wrapping_sub(segments.handed()) as i32) < 0 && self.block_of(number) == Some(block) {
            if self.is_in_rapid_span(segments.start(number)) {
                return true;
            }
            number = segments.after(number);
        }
        false
    }

    fn is_in_rapid_span(&self, distance: i64) -> bool {
        let ends_behind = |k: &usize| {
            self.committed.get(*k).is_some_and(|committed| committed.end().wrapping_sub(distance) > 0)
        };
        let span = (0..self.committed.len()).find(ends_behind).and_then(|k| self.committed.get(k));
        span.is_some_and(|committed| committed.span.marks.rapid() == Some(true))
    }

    /// The first instant at which the motion reaches a path distance. `end`: the instant at which the queue
    /// ends.
    fn instant_of(&self, end: u32, distance: i64) -> Option<u32> {
        let mut start = end;
        let mut number = self.queue.phases.count();
        for _ in 0..PHASES {
            number = number.wrapping_sub(1);
            let phase: &Phase = self.queue.phases.recent(number)?;
            start = start.wrapping_sub(clock::TICK * u32::from(phase.ticks));
            if phase.at(0).wrapping_sub(distance) >= 0 {
                continue;
            }
            // At the first tick of the piece, the motion has not reached the distance.
            let (mut before, mut beyond) = (0u16, phase.ticks);
            while beyond - before > 1 {
                let half = before + (beyond - before) / 2;
                if phase.at(half).wrapping_sub(distance) >= 0 { beyond = half } else { before = half }
            }
            return Some(start.wrapping_add(clock::TICK * u32::from(beyond)));
        }
        None
    }

    /// Whether the motion stands for a tick at a path distance, at the end of a piece of the queue.
    fn rests_at(&self, distance: i64) -> bool {
        let mut number = self.queue.phases.count();
        (0..PHASES).any(|_| {
            number = number.wrapping_sub(1);
            self.queue.phases.recent(number).is_some_and(|phase| {
                let Phase { distance: at, speed, ticks, .. } = *phase;
                ticks > 0 && speed == Speed::ZERO && at.to_bits() == distance
            })
        })
    }

    /// The state at the stop if a hold came now.
    fn standstill(&mut self, now: u32) -> Result<Moment<AXES>, Unknown> {
        if self.orders.mode.is_standing() {
            // A hold in force keeps its stop.
            let at = self.frontier.end.wrapping_sub(clock::TICK);
            let at = if clock::is_before(at, now) { now } else { at };
            let stands = self.motion_end();
            return self.moment(now, at, stands).ok_or(Unknown::NotPlanned);
        }
        let Some(inquiry) = self.intake.inquiry.take() else {
            return Err(Unknown::NotEnabled(Question::Standstill.function()));
        };
        let known = self.try_hold((now, 0), inquiry);
        if !matches!(known, Err(Unknown::Searching)) {
            inquiry.trial = None;
        }
        self.intake.inquiry = Some(inquiry);
        let (at, stands) = known?;
        let at = if clock::is_before(at, now) { now } else { at };
        self.moment(now, at, stands).ok_or(Unknown::NotPlanned)
    }

    /// The instant and the path distance of the stop, if a hold came `ahead` ticks after the instant `now`.
    pub(super) fn try_hold(
        &mut self,
        (now, ahead): (u32, u32),
        inquiry: &mut Inquiry,
    ) -> Result<(u32, i64), Unknown> {
        let Inquiry { spans, trial } = inquiry;
        let is_same = |trial: &Trial| {
            (trial.handed, trial.stage, trial.ahead) == (self.handed, self.task.stage, ahead)
                && clock::is_before(now, trial.asked.wrapping_add(clock::TICK << 10))
        };
        if !trial.as_ref().is_some_and(is_same) {
            *trial = Some(self.begin_trial(now, ahead)?);
            spans.copy_from(self.committed);
        }
        let Some(trial) = trial else { return Err(Unknown::Searching) };
        self.swap(trial, spans);
        self.orders.asking = true;
        self.orders.search.begin_call();
        let found = self.go_on_trying(&mut trial.step, trial.frontier.end);
        self.orders.asking = false;
        self.swap(trial, spans);
        found
    }

    fn swap(&mut self, trial: &mut Trial, spans: &mut CommittedSpans) {
        core::mem::swap(&mut self.frontier, &mut trial.frontier);
        core::mem::swap(&mut self.orders.mode, &mut trial.mode);
        core::mem::swap(&mut self.orders.search, &mut trial.search);
        core::mem::swap(&mut self.profile, &mut trial.profile);
        core::mem::swap(&mut self.reserve.behind, &mut trial.behind);
        core::mem::swap(self.committed, spans);
    }

    /// The instant at which a hold `ahead` ticks from now would change the plan, and the span at this instant.
    fn begin_trial(&mut self, now: u32, ahead: u32) -> Result<Trial, Unknown> {
        self.trim();
        let waits = self.reserve.waits && self.task.stage == RingStage::Passing;
        let cut = self.orders.mode.cut.is_some();
        if waits || cut || self.orders.mode.stopping || self.queue.phases.room() < KEPT_FREE {
            return Err(Unknown::Busy);
        }
        let at = now.wrapping_add(clock::TICK * (self.orders.lead + ahead));
        let at = if clock::is_before(at, self.frontier.end) { at } else { self.frontier.end };
        let begins_behind =
            |k: &usize| self.committed.get(*k).is_none_or(|committed| clock::is_before(at, committed.first));
        let later = (0..self.frontier.planned).find(begins_behind).unwrap_or(self.frontier.planned);
        let inside = later.checked_sub(1).and_then(|k| Some((k, self.committed.get(k)?.first)));
        let step = match inside {
            Some((k, first)) if first == at => Step::Enter(k),
            Some((k, _)) => Step::Leave { k, at, motion: self.motion_at(at).ok_or(Unknown::Busy)? },
            None => Step::Enter(later),
        };
        Ok(Trial {
            frontier: self.frontier,
            mode: self.orders.mode.stop(),
            search: Search::none(),
            profile: self.profile,
            behind: self.reserve.behind,
            step,
            handed: self.handed,
            stage: self.task.stage,
            asked: now,
            ahead,
        })
    }

    /// Continues the trial from the start of span `k`, or of the next span with a tick. If there is no such
    /// span, it continues from the end of the planned motion.
    fn enter(&mut self, k: usize) {
        let k = self.with_tick(k);
        let frontier = &mut self.frontier;
        if let Some(committed) = self.committed.get(k).filter(|_| k < frontier.planned) {
            (frontier.end, frontier.planned) = (committed.first, k);
            frontier.emitter.resume_at(committed.next);
            (frontier.speed, frontier.pending_dwell) = (committed.enters, 0);
            self.committed.restore_from(k + 1);
        } else {
            self.skip_law();
        }
    }

    /// Continues with the profiles of a hold, until the stop is known. `end`: the instant at which the queue
    /// ends.
    fn go_on_trying(&mut self, step: &mut Step, end: u32) -> Result<(u32, i64), Unknown> {
        match *step {
            Step::Leave { k, at, motion } => {
                match self.descend(k, &motion) {
                    Err(Later) => return Err(Unknown::Searching),
                    Ok(Some(descent)) => {
                        (self.frontier.end, self.frontier.planned) = (at, k);
                        self.frontier.emitter.resume_at(0);
                        self.go_down(k, &descent);
                        self.skip_law();
                        if self.frontier.end == at && self.frontier.planned == k && !self.orders.mode.halting
                        {
                            // If a braking is too short for a tick, the rest of the span brakes, as in a
                            // hold.
                            if let Some(committed) = self.committed.get(k) {
                                let (distance, speed) =
                                    (committed.start.to_bits(), self.frontier.speed.to_bits());
                                self.stay_within(k, &Instant { distance, speed, accel: 0 });
                            }
                            if self.make_law() != Ok(true) {
                                return Err(Unknown::Busy);
                            }
                            self.skip_law();
                        }
                        if self.frontier.end == at && self.frontier.speed != Speed::ZERO {
                            // A hold would begin a tick later.
                            return Err(Unknown::Busy);
                        }
                        self.committed.restore_from(k + 1);
                        self.note_passed();
                    }
                    Ok(None) => self.enter(k + 1),
                }
            }
            Step::Enter(k) => self.enter(k),
            Step::Laws => {}
        }
        if !matches!(core::mem::replace(step, Step::Laws), Step::Laws)
            && let Some(stands) = self.stands_at()
        {
            // If the motion stops without the hold, the stop comes before a dwell.
            let at = self.frontier.end;
            let begins = self.instant_of(end, stands).filter(|begins| clock::is_before(*begins, at));
            let by_itself = begins.filter(|_| self.rests_at(stands));
            return Ok((by_itself.unwrap_or(at), stands));
        }
        for _ in 0..LAWS {
            if let Some(stands) = self.stands_at() {
                return Ok((self.frontier.end, stands));
            }
            if self.frontier.planned >= self.committed.len() {
                return Err(Unknown::NotPlanned);
            }
            match self.make_law() {
                Ok(true) => {}
                Ok(false) => return Err(Unknown::Searching),
                Err(_) => return Err(Unknown::NotPlanned),
            }
            self.skip_law();
            self.note_passed();
        }
        Err(Unknown::NotPlanned)
    }

    /// Treats the emitter's profile as if it were in the queue.
    fn skip_law(&mut self) {
        let ticks = self.frontier.emitter.skip();
        self.frontier.end = self.frontier.end.wrapping_add(clock::TICK * ticks);
    }

    /// Path distance of the stop, if the profiles reach a stop.
    fn stands_at(&self) -> Option<i64> {
        let Frontier { planned, speed, .. } = self.frontier;
        if self.orders.mode.halting {
            return self.committed.get(planned).map(|span| span.start.to_bits()).or(self.reserve.behind);
        }
        let ended = planned.checked_sub(1).and_then(|k| self.committed.get(k));
        let next = self.committed.get(planned).map(|span| span.start.to_bits());
        (speed == Speed::ZERO).then(|| ended.map(|span| span.end()).or(next)).flatten()
    }
}
