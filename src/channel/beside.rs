//! Motions of single axes that are independent of the path: oscillations, independent axes, jog.
//!
//! A command for a single axis waits until the path stops at the programmed point. Then the axis moves on its
//! own, in an overlay (a queue of its own). The path planner goes on at once, as if the axis were already at
//! its target. If the program has another command for that axis, this command waits for the end of the axis's
//! motion. An oscillation ends in one of these ways:
//!
//! | the program or the operator gives | what an oscillating axis does |
//! |---|---|
//! | a motion that moves the axis (P-CHAN-00451), another command for it, `#PUT AX`, `#CALL AX`, `#FLUSH&WAIT`, `#FILTER`, the program end, a refused line | finishes the current cycle and stops on the second position; the program waits |
//! | `OFF` | the same, but the program does not wait |
//! | `OFF FEED` | brakes, then goes to the second position |
//! | `OFF INSTANT`, an abort | brakes, and stands there |
//!
//! A feed hold stops all single axes. After a resume, each axis continues to its target. The override acts on
//! independent axes, but not on oscillations, whose time is programmed. Reduced speed (P-AXIS-00214) acts on
//! all single axes.
use super::{Error, Held, Planner, Progress, Source};
use crate::fir::FilterPlan;
use crate::machine::{AxisKind, ChannelData};
use crate::math::divide::div_wide;
use crate::math::wide::mul_wide;
use crate::nc::{
    COORDINATE_MAX, Command, Head, Independent, Motion, NcWarning, NcWarningKind, Oscillation,
    OscillationAction, OscillationSpeed, Place, Text,
};
use crate::plan::MotionError;
use crate::quantity::{Feed, Position};
use crate::queue::OverlaySender;
use crate::single::{AxisLimits, Oscillating, Pace, Single, Wishes};
use crate::technology::Function;

/// The event for which the program waits, while the path stops.
#[derive(Clone, Copy)]
pub(super) enum Pending {
    Oscillation(Head, Oscillation),
    Independent(Head, Independent),
    /// Waits until the interrupt has taken the motion of this axis to this position. Then waits for the axes
    /// in the last field.
    Start(usize, Position, u32),
    /// Waits for the ends of the motions of these axes.
    End(u32),
    /// As [`Self::End`], before the motion of the current line.
    Join(u32),
}

/// The reason why [`Planner::move_axis`] refuses a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MoveError {
    /// The program has not ended, the path or this axis moves, or the motion of another single axis has not
    /// begun yet.
    NotAtRest,
    /// The machine has no such axis, or position or feed is out of range.
    Range,
    /// The motion leads beyond a software limit, or takes too long.
    Motion(MotionError),
    /// The largest number of single axes (`OVERLAYS` of [`crate::Channel`]) already moves.
    Full,
}

impl core::fmt::Display for MoveError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NotAtRest => "a single axis is moved at rest, when all blocks read are executed",
            Self::Range => "no such motion; expected an axis of the machine, a position up to 100 000 mm or degrees and a feed above 0",
            Self::Motion(MotionError::Beyond(_)) => "the axis would come beyond its software limit",
            Self::Motion(_) => "the motion takes more than 134 217 728 ticks; raise the feed",
            Self::Full => "no overlay is free; expected fewer axes at once, or more OVERLAYS of the channel",
        })
    }
}

impl core::error::Error for MoveError {}

/// Single axes and their overlays.
pub(super) struct Beside<'a, const OVERLAYS: usize> {
    singles: &'a mut [Single; OVERLAYS],
    overlays: [OverlaySender<'a>; OVERLAYS],
    pub(super) pending: Option<Pending>,
    /// P-CHAN-00451.
    joins_named: bool,
    /// P-CHAN-00297.
    exact_stop: u8,
    /// Whether the next piece of work belongs to a single axis.
    turn: bool,
}

impl<'a, const OVERLAYS: usize> Beside<'a, OVERLAYS> {
    pub(super) const fn new(
        singles: &'a mut [Single; OVERLAYS],
        overlays: [OverlaySender<'a>; OVERLAYS],
        channel: &ChannelData,
    ) -> Self {
        let (joins_named, exact_stop) = (channel.joins_named, channel.exact_stop_indp);
        Self { singles, overlays, pending: None, joins_named, exact_stop, turn: false }
    }

    /// Whether no single axis moves or waits to move.
    pub(super) fn is_free(&self) -> bool {
        OVERLAYS == 0 || self.pending.is_none() && self.axes() == 0
    }

    /// Axes with their own motion: bit i is axis i.
    fn axes(&self) -> u32 {
        let bits = self.singles.iter().filter_map(Single::axis).map(bit);
        bits.fold(0, |axes, bit| axes | bit)
    }

    fn of(&mut self, axis: usize) -> Option<&mut Single> {
        self.singles.iter_mut().find(|single| single.axis() == Some(axis))
    }

    fn free(&mut self) -> Option<&mut Single> {
        self.singles.iter_mut().find(|single| single.axis().is_none())
    }

    /// The axis whose motion is about to begin.
    const fn starting(&self) -> u32 {
        if let Some(Pending::Start(axis, ..)) = self.pending { bit(axis) } else { 0 }
    }

    /// Stops all single axes, and drops pending commands.
    pub(super) fn stop(&mut self) {
        self.pending = None;
        self.singles.iter_mut().filter(|single| single.axis().is_some()).for_each(Single::stop);
    }

    /// Ends the oscillations of these axes with their current cycle.
    fn finish(&mut self, axes: u32) {
        let of = |single: &&mut Single| single.axis().is_some_and(|axis| bit(axis) & axes != 0);
        self.singles.iter_mut().filter(of).for_each(Single::finish);
    }
}

const fn bit(axis: usize) -> u32 {
    1u32.wrapping_shl(axis as u32)
}

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Does one piece of work, alternately for the path and for a single axis.
    pub(super) fn poll_both(&mut self) -> Result<Progress, Error> {
        if self.beside.axes() != 0 && self.planning.commands().abort {
            self.beside.stop();
        }
        if core::mem::take(&mut self.beside.turn) && self.tend()? {
            return Ok(Progress::Working);
        }
        self.beside.turn = true;
        let progress = self.poll_path()?;
        if matches!(progress, Progress::Waiting | Progress::Done) && self.tend()? {
            return Ok(Progress::Working);
        }
        Ok(progress)
    }

    /// Axes that move independently of the path: bit i is axis i. For simulators: a controller does not need
    /// this call.
    #[doc(hidden)]
    pub fn beside(&self) -> u32 {
        self.beside.axes()
    }

    /// Does one piece of work for a single axis; returns `false` if there is none.
    fn tend(&mut self) -> Result<bool, Error> {
        // Jog after a new position was set: the filters start again before the jog begins.
        if self.filters.is_pending() && self.beside.starting() != 0 {
            return Ok(false);
        }
        let commands = self.planning.commands();
        let wishes =
            Wishes { hold: commands.hold || commands.abort, reduced: commands.reduced, feed: commands.feed };
        let Beside { singles, overlays, .. } = &mut self.beside;
        let mut done = Ok(false);
        for (single, overlay) in singles.iter_mut().zip(overlays) {
            done = single.work(overlay, &wishes);
            if done != Ok(false) {
                break;
            }
        }
        match done {
            Ok(done) => Ok(self.settle_beside() || done),
            Err(_) => {
                self.lose();
                self.planning.drop_ahead();
                Err(Error::Unplannable)
            }
        }
    }

    /// Returns axes to the path after their motion has ended. Returns whether there was such an axis.
    fn settle_beside(&mut self) -> bool {
        let settling = self.filters.window();
        let Beside { singles, overlays, pending, .. } = &mut self.beside;
        let mut done = false;
        for (single, overlay) in singles.iter_mut().zip(overlays) {
            let Some(axis) = single.axis() else { continue };
            let Some(stands) = single.stands(overlay, settling) else { continue };
            if matches!(pending, Some(Pending::Start(starts, ..)) if *starts == axis) {
                continue;
            }
            if self.planning.stands().get(axis) != Some(&stands) {
                if !self.planning.is_at_rest() || !self.planning.set_position(axis, stands) {
                    continue;
                }
                self.decoder.set_position(axis, stands);
                #[cfg(feature = "kinematics")]
                if self.planning.is_transformed() {
                    self.decoder.stand_at(*self.planning.position());
                }
            }
            overlay.give_back();
            single.release();
            done = true;
        }
        done
    }

    /// Tells the decoder the end position of an axis' single motion.
    #[cfg(not(feature = "kinematics"))]
    #[inline(always)]
    fn learn(&mut self, axis: usize, position: Position) {
        self.decoder.set_position(axis, position);
    }

    /// Keeps a command for a single axis until the path stops.
    pub(super) fn hold_back(&mut self, command: &Command<AXES>) {
        match command {
            Command::Oscillation(head, oscillation) => {
                self.wait_for(Pending::Oscillation(*head, *oscillation))
            }
            Command::Independent(head, independent) => {
                self.wait_for(Pending::Independent(*head, *independent))
            }
            _ => {}
        }
    }

    /// Lets the program continue when the path stops.
    pub(super) fn wait_for(&mut self, pending: Pending) {
        self.beside.pending = Some(pending);
        self.planning.rest(1);
    }

    /// Waits for the ends of the motions of these axes, if there are any.
    pub(super) fn join(&mut self, axes: u32) {
        if OVERLAYS > 0 && self.beside.axes() & axes != 0 {
            self.wait_for(Pending::End(axes));
        }
    }

    /// Whether the motion moves or names (P-CHAN-00451) axes that have their own motion. The path motion then
    /// waits for the ends of these motions.
    pub(super) fn joins(&mut self, motion: &Motion<AXES>) -> bool {
        let axes = self.beside.axes();
        if self.beside.joins_named && axes & motion.named != 0 {
            self.wait_for(Pending::Join(axes & motion.named));
            return true;
        }
        let joins = axes != 0 && axes & self.planning.moved(motion) != 0;
        if joins {
            self.wait_for(Pending::Join(axes & self.planning.moved(motion)));
        }
        joins
    }

    /// Lets single axes finish their motions. Returns whether no axis moves any more. A jog that has not
    /// begun waits.
    pub(super) fn ends_beside(&mut self) -> bool {
        let begun = self.beside.axes() & !self.beside.starting();
        let free = OVERLAYS == 0 || begun == 0;
        if !free {
            self.beside.finish(begun);
        }
        free
    }

    /// Continues work that waits for the path or for single axes.
    pub(super) fn wait_beside(&mut self) -> Result<Progress, Error> {
        if !self.planning.is_at_rest() {
            return Ok(Progress::Waiting);
        }
        let done = match self.beside.pending {
            None => {
                self.beside.finish(u32::MAX);
                return Ok(Progress::Waiting);
            }
            Some(Pending::Oscillation(head, oscillation)) => self.begin_oscillation(&head, &oscillation),
            Some(Pending::Independent(head, independent)) => self.begin_independent(&head, &independent),
            Some(Pending::Start(axis, end, awaited)) => Ok(self.start(axis, end, awaited)),
            Some(Pending::End(axes) | Pending::Join(axes)) => {
                self.beside.finish(axes);
                if self.beside.axes() & axes != 0 {
                    return Ok(Progress::Waiting);
                }
                let joins = matches!(self.beside.pending.take(), Some(Pending::Join(_)));
                match self.decoder.motion() {
                    Some(motion) if joins => self.execute(&Command::Motion(motion)),
                    _ => Ok(Progress::Working),
                }
            }
        };
        if done.is_err() {
            self.beside.pending = None;
            self.refuse();
        }
        done
    }

    /// Sets the path's position of the axis to the end of the single motion, after the interrupt has taken
    /// that motion.
    fn start(&mut self, axis: usize, end: Position, awaited: u32) -> Progress {
        let shows = self.beside.of(axis).is_none_or(|single| single.is_shown());
        if !shows {
            return Progress::Waiting;
        }
        if self.planning.stands().get(axis) != Some(&end) && !self.planning.set_position(axis, end) {
            return Progress::Waiting;
        }
        self.learn(axis, end);
        self.beside.pending = (awaited != 0).then_some(Pending::End(awaited));
        Progress::Working
    }

    fn begin_oscillation(&mut self, head: &Head, oscillation: &Oscillation) -> Result<Progress, Error> {
        let axis = oscillation.axis;
        let OscillationAction::On { first, second, speed, first_wait, second_wait, count, short } =
            oscillation.action
        else {
            return Ok(self.end_oscillation(axis, &oscillation.action));
        };
        if self.beside.axes() & bit(axis) != 0 {
            self.beside.finish(bit(axis));
            return Ok(Progress::Waiting);
        }
        let from = self.from(axis, head.place)?;
        let mut ends = [first, second];
        if short {
            ends[0] = nearest(from, ends[0]);
            ends[1] = nearest(ends[0], ends[1]);
        }
        for end in ends {
            self.planning.may_go(axis, end).map_err(|beyond| self.error(head.place, beyond.into()))?;
        }
        let pace = match speed {
            OscillationSpeed::Feed(feed) => Pace::Speed(self.planning.speed_of(feed)),
            // Converts 2^-32 Hz to ticks, LSB 2^-32.
            OscillationSpeed::Frequency(frequency) => {
                let cycles =
                    u64::try_from(frequency.to_bits()).unwrap_or(0).saturating_mul(self.cycle_us.into());
                Pace::Time(div_wide(1_000_000, 0, cycles))
            }
            OscillationSpeed::Period(period) => Pace::Time(self.ticks_of(period)),
        };
        let waits = [self.ticks_of(first_wait), self.ticks_of(second_wait)];
        let limits = self.limits_of(axis, false, None, 100);
        let Some(single) = self.beside.free() else { return Err(Error::NotEnabled(head.place, FULL)) };
        let how = Oscillating { ends, waits, pace, count };
        let within = single
            .oscillate(axis as u8, from, &how, &limits)
            .map_err(|_| Error::Motion(head.place, MotionError::StrokeTooSlow))?;
        self.beside.pending = Some(Pending::Start(axis, ends[1], 0));
        Ok(said(within, head.place, NcWarningKind::OscillationLimited))
    }

    /// Carries out OFF.
    fn end_oscillation(&mut self, axis: usize, action: &OscillationAction) -> Progress {
        self.beside.pending = None;
        let v = match action {
            OscillationAction::OffFeed(feed) => self.planning.speed_of(*feed),
            _ => 0.0,
        };
        let Some(single) = self.beside.of(axis) else { return Progress::Working };
        match action {
            OscillationAction::OffFeed(_) => single.leave(v),
            OscillationAction::OffInstant => {
                single.stop();
                self.beside.pending = Some(Pending::End(bit(axis)));
            }
            _ => single.finish(),
        }
        Progress::Working
    }

    fn begin_independent(&mut self, head: &Head, independent: &Independent) -> Result<Progress, Error> {
        let axis = independent.axis;
        if self.beside.axes() & bit(axis) != 0 {
            self.beside.finish(bit(axis));
            return Ok(Progress::Waiting);
        }
        let from = self.from(axis, head.place)?;
        if let Some(function) = self.next_function(head, independent) {
            return Ok(self.output(function));
        }
        let target = independent.position.unwrap_or(from);
        let percent = independent.acceleration.map_or(100, |percent| percent.to_num::<u32>().max(1));
        let limits = self.limits_of(axis, independent.rapid, independent.slope, percent);
        let v = limits.limits.v;
        let pace = match (independent.feed, independent.time, independent.weight) {
            (Some(feed), ..) => Pace::Speed(self.planning.speed_of(feed)),
            (_, Some(time), _) => Pace::Time(self.ticks_of(time)),
            (.., Some(percent)) => Pace::Speed(v * percent.to_num::<f32>() * 0.01),
            _ => Pace::Speed(v),
        };
        self.planning.may_go(axis, target).map_err(|beyond| self.error(head.place, beyond.into()))?;
        let Some(single) = self.beside.free() else { return Err(Error::NotEnabled(head.place, FULL)) };
        let within = single
            .go(axis as u8, [from, target], pace, &limits)
            .map_err(|_| Error::Motion(head.place, MotionError::StrokeTooSlow))?;
        let awaited = if independent.synchronous { bit(axis) } else { 0 };
        self.beside.pending = Some(Pending::Start(axis, target, awaited));
        // A feed above the limit of the axis is lowered, as on the path.
        let is_time = independent.time.is_some();
        Ok(said(within || !is_time, head.place, NcWarningKind::MotionLimited))
    }

    /// Returns the next function for output before the motion of an independent axis; each function is
    /// returned once.
    fn next_function(&mut self, head: &Head, independent: &Independent) -> Option<Held> {
        let mut left = *independent;
        let function = match (left.m.take(), left.h) {
            (Some(code), _) => Function::M(code as u16),
            (None, Some(code)) => {
                left.h = None;
                Function::H(code as u16)
            }
            (None, None) => return None,
        };
        self.beside.pending = Some(Pending::Independent(*head, left));
        Some(Held::new(head, function))
    }

    /// Carries out `#WAIT INDP` for these axes, or for all axes (P-CHAN-00297 = 2).
    pub(super) fn wait_independent(&mut self, axes: u32) {
        self.await_independent(if self.beside.exact_stop == WAITS_FOR_ALL { u32::MAX } else { axes });
    }

    /// Carries out an exact stop after the last motion: filters settle. With P-CHAN-00297 = 1, independent
    /// axes also finish their motions.
    #[inline(never)]
    pub(super) fn stop_exactly(&mut self) {
        if self.beside.exact_stop == STOPS_WITH_PATH {
            self.await_independent(u32::MAX);
        }
        if self.settling() > 0 {
            self.planning.rest(self.settling());
        }
    }

    /// Lets the program continue when these axes have finished their motions. Oscillating axes do not count.
    fn await_independent(&mut self, axes: u32) {
        let awaited = self.beside.singles.iter().filter(|single| !single.is_swinging());
        let moving = awaited.filter_map(Single::axis).fold(0, |axes, axis| axes | bit(axis));
        self.join(axes & moving);
    }

    /// The start position of an axis that is about to move alone.
    fn from(&self, axis: usize, place: Place) -> Result<Position, Error> {
        if self.released & bit(axis) != 0 {
            return Err(Error::Motion(place, MotionError::Released));
        }
        match self.planning.stands().get(axis) {
            Some(from) if self.decoder.setup().kinds.get(axis) != Some(&AxisKind::Spindle) => Ok(*from),
            _ => Err(Error::NotAvailable(place, "a motion of this axis on its own")),
        }
    }

    fn limits_of(
        &self,
        axis: usize,
        rapid: bool,
        slope: Option<crate::nc::SlopeType>,
        percent: u32,
    ) -> AxisLimits {
        let (limits, v_reduced) = self
            .planning
            .single(axis, rapid, slope, percent)
            .unwrap_or((crate::slope::limits::Limits::WIDEST, f32::MAX));
        AxisLimits { limits, v_reduced }
    }

    /// A time in s, LSB 2^-32, as ticks with the same LSB.
    fn ticks_of(&self, time: Position) -> u64 {
        let (hi, lo) = mul_wide(u64::try_from(time.to_bits()).unwrap_or(0), 1_000_000);
        div_wide(hi, lo, self.cycle_us.into())
    }

    /// Moves one axis independently of the path, after the end of a program: for jog and homing. `target` is
    /// in machine coordinates, mm or degrees. `feed` is in mm/min or degrees/min; without a feed the axis
    /// moves at rapid speed.
    ///
    /// [`Self::poll`] carries the motion out and returns [`Progress::Waiting`] until the axis stops. Feed hold,
    /// override, reduced speed and abort act on this motion. Several axes may move at the same time.
    ///
    /// # Errors
    /// Returns [`MoveError`] with the reason; nothing changes.
    pub fn move_axis(&mut self, axis: usize, target: Position, feed: Option<Feed>) -> Result<(), MoveError> {
        self.start_alone(axis, target, feed, true)
    }

    /// Moves one axis as [`Self::move_axis`] does, but without a check of the software limits. For homing:
    /// the machine searches its switches and does not know its position yet.
    ///
    /// # Errors
    /// Returns [`MoveError`] with the reason; nothing changes.
    #[cfg(feature = "grbl")]
    pub fn seek_axis(&mut self, axis: usize, target: Position, feed: Option<Feed>) -> Result<(), MoveError> {
        self.start_alone(axis, target, feed, false)
    }

    #[inline(always)]
    fn start_alone(
        &mut self,
        axis: usize,
        target: Position,
        feed: Option<Feed>,
        inside: bool,
    ) -> Result<(), MoveError> {
        self.end_by_abort();
        let busy = self.beside.pending.is_some() || self.beside.axes() & bit(axis) != 0;
        if busy || self.source != Source::Ended || !self.planning.is_at_rest() {
            return Err(MoveError::NotAtRest);
        }
        const MAX: Position = Position::const_from_int(COORDINATE_MAX as i64);
        let is_far = target > MAX || target < -MAX;
        if axis >= AXES || is_far || feed.is_some_and(|feed| feed <= 0) {
            return Err(MoveError::Range);
        }
        let from = self.from(axis, Place::NONE).map_err(|_| MoveError::Range)?;
        if inside {
            self.planning.may_go(axis, target).map_err(|beyond| MoveError::Motion(beyond.into()))?;
        }
        let limits = self.limits_of(axis, feed.is_none(), None, 100);
        let pace = Pace::Speed(feed.map_or(limits.limits.v, |feed| self.planning.speed_of(feed)));
        let single = self.beside.free().ok_or(MoveError::Full)?;
        single
            .go(axis as u8, [from, target], pace, &limits)
            .map_err(|_| MoveError::Motion(MotionError::StrokeTooSlow))?;
        // An abort that was given before this call does not end this motion.
        self.forget_abort();
        self.beside.pending = Some(Pending::Start(axis, target, 0));
        Ok(())
    }

    /// Carries out an abort at rest in this call: the rest of the program is dropped. So the result does not
    /// depend on the time of the planner's next call.
    fn end_by_abort(&mut self) {
        let rests = self.planning.is_at_rest() && self.beside.is_free();
        if self.source != Source::Ended && rests && self.planning.commands().abort {
            self.lose();
        }
    }

    /// Stops an axis that [`Self::move_axis`] moves. The axis brakes inside its limits and stays at the stop.
    pub fn stop_axis(&mut self, axis: usize) {
        if self.source == Source::Ended
            && let Some(single) = self.beside.of(axis)
        {
            single.stop();
            if matches!(self.beside.pending, Some(Pending::Start(starts, ..)) if starts == axis) {
                self.beside.pending = None;
            }
        }
    }
}

/// Returns a warning if a motion exceeds the limits.
const fn said(within: bool, place: Place, kind: NcWarningKind) -> Progress {
    if within { Progress::Working } else { Progress::Warning(NcWarning { place, kind }) }
}

/// The position nearest to `from` that differs from `position` by whole turns.
fn nearest(from: Position, position: Position) -> Position {
    const TURN: i64 = 360 << 32;
    let way = (position.to_bits() - from.to_bits()).rem_euclid(TURN);
    let way = if way > TURN / 2 { way - TURN } else { way };
    Position::from_bits(from.to_bits() + way)
}

/// P-CHAN-00297: an exact stop on the path also waits for independent axes.
const STOPS_WITH_PATH: u8 = 1;

/// P-CHAN-00297: `#WAIT INDP` waits for all independent axes.
const WAITS_FOR_ALL: u8 = 2;

const FULL: &str = "all overlays of the channel are at work; expected fewer axes that move alone at once, or more OVERLAYS of the channel";
