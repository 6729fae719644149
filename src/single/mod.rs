//! Motion of a single axis, independent of the path: oscillation, independent motion, jog and homing.
//!
//! An application moves an axis by [`Planner::move_axis`](crate::channel::Planner::move_axis) while the path
//! stands still:
//!
//! ```
//! use glidepath::{AxisData, AxisKind, AxisName, Channel, ChannelData, Handles};
//! use glidepath::{MachineData, Position, Progress, State};
//!
//! let axis = |name| AxisData::new(AxisName::new(name).unwrap(), AxisKind::Linear);
//! let machine = MachineData { axes: [axis("X"), axis("Y")], channel: ChannelData::new() };
//! let mut memory = Channel::<2, 120, 1>::new(); // one axis at a time may move alone
//! let program: &[u8] = b"M30\n";
//! let handles = memory.split(&machine, [Position::ZERO; 2], program).unwrap();
//! let Handles { mut planner, mut interpolator, .. } = handles;
//! while planner.poll().unwrap() != Progress::Done || !planner.is_at_rest() {
//!     interpolator.tick();
//! }
//!
//! planner.move_axis(1, Position::from_num(-3), Some(Position::from_num(600))).unwrap(); // Y to -3 mm at 600 mm/min
//! while planner.poll().unwrap() != Progress::Done {
//!     interpolator.tick();
//! }
//! while interpolator.tick() != State::Idle {}
//! assert_eq!(interpolator.set_points()[1], Position::from_num(-3));
//! ```
//!
//! A [`Single`] takes a goal (a position, or an oscillation) and the limits of the axis. [`Single::work`]
//! writes pieces of a speed profile into the queue of that axis ([`crate::queue::Overlay`]). A motion
//! consists of *strokes*: motions from stop to stop. A stroke enters the queue as a whole, and the next
//! stroke enters before the current one ends. If the planner gets no time, the axis stops at the end of its
//! stroke.
//!
//! An oscillation has the slope of P-CHAN-00071. An independent axis has this slope or a slope of its own.
//! The last tick of a stroke outputs exactly the end position, so a stroke lasts a whole number of ticks. The
//! programmed time of a stroke is rounded to ticks. The remainder is added to the next stroke, so an
//! oscillation keeps its frequency.
//!
//! After a feed hold, an abort, `OFF INSTANT` or `OFF FEED`, the axis brakes inside its limits
//! ([`crate::slope::brake::Brake`]). Braking begins a few ticks after the command. An axis that is already
//! braking finishes its stroke.
mod change;
mod stroke;

use crate::math::float::min;
use crate::quantity::{Accel, Distance, Jerk, Position, Speed, speed_bits};
use crate::queue::{Cut, OverlaySender, Phase, Slot, clock, fine, set_point};
use crate::slope::emit::{Emitter, TICK};
use crate::slope::limits::Limits;
use crate::slope::profile::{Profile, Unplannable};

/// Largest number of pieces in a stroke, including its standstill. A stroke with more pieces gets a lower
/// speed, so that a stop always has room after it. SIN2 needs up to 36 pieces.
const PIECES_OF_A_STROKE: u32 = 36;

/// Largest number of halvings of a motion that takes too long for one stroke. The axis stops in between.
const HALVES: usize = 12;

/// Largest number of pieces that one call of [`Single::work`] makes.
const PIECES: u32 = 8;

/// The next stroke enters the queue when this number of pieces is left.
const FEW: u32 = 6;

/// Number of strokes in the queue: the current one and the next one.
const STROKES: usize = 2;

/// Longest standstill in one piece, ticks.
const LONGEST_REST: u64 = 65_535;

/// What an axis at standstill does next.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Goal {
    /// None.
    Rest,
    /// Move to this position.
    To(Position),
    /// The next stroke of an oscillation.
    Swing(Swing),
}

/// State of an oscillation.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Swing {
    /// Whether the next stroke leads to the first position.
    to_first: bool,
    /// Number of remaining strokes to the second position, if they are counted.
    left: Option<u32>,
    /// Dwell before the next stroke, ticks.
    rest: u64,
    /// Rounding remainder of earlier strokes, as a fraction of a tick, LSB 2^-32.
    share: u64,
}

/// An oscillation: a single axis moves to and fro between two positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillating {
    /// The two positions at which the axis reverses, mm or degrees: the first and the second one.
    pub ends: [Position; 2],
    /// Dwell at the first and at the second position, LSB 2^-32 tick.
    pub waits: [u64; 2],
    /// Speed of the axis, or the period of the oscillation including both dwells.
    pub pace: Pace,
    /// Number of periods; `None`: until the program ends the oscillation.
    pub count: Option<u32>,
}

/// The demanded speed of a single axis, or the demanded duration of its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// Speed of the axis, mm/tick or degrees/tick.
    Speed(f32),
    /// Duration, LSB 2^-32 tick.
    Time(u64),
}

/// Limits of an axis that moves alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Limits of speed, acceleration and jerk; the unit of time is one tick.
    pub limits: Limits,
    /// Reduced speed (P-AXIS-00214), mm/tick or degrees/tick.
    pub v_reduced: f32,
}

/// The operator's commands in force, as far as they act on single axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wishes {
    /// Whether the axes are to stop.
    pub hold: bool,
    /// Whether reduced speed is on.
    pub reduced: bool,
    /// Feed override, 0…2000, LSB 0.1 %.
    pub feed: u16,
}

/// A stroke in the queue.
#[derive(Clone, Copy, Debug)]
struct Stroke {
    /// The goal before the stroke.
    before: Goal,
    /// The instant after the last tick of the stroke.
    end: u32,
}

/// The stroke whose pieces are being written.
#[derive(Clone, Copy, Debug)]
struct Laying {
    /// The goal before the stroke, and the start position of the stroke.
    before: Goal,
    from: i64,
    /// Whether the stroke moves in negative direction.
    backward: bool,
    /// End position of the stroke.
    to: i64,
    /// Number of ticks with pieces, and number of ticks without pieces yet. The latter includes the
    /// standstill after the stroke.
    ticks: u32,
    left: u32,
    /// Number of finished pieces.
    ready: u32,
}

/// How a motion ends before its goal, if it does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ending {
    /// The motion reaches its goal.
    None,
    /// The motion ends where it stops.
    Here,
    /// After its stop the axis moves to a position at this speed.
    Then(Position, f32),
}

/// The strokes of an oscillation.
#[derive(Clone, Copy, Debug)]
struct Course {
    ends: [Position; 2],
    waits: [u64; 2],
    /// Duration of a stroke in ticks, LSB 2^-32; `None` for the shortest possible duration.
    stroke: Option<u64>,
    /// Duration of a stroke that the limits of the axis determine, ticks.
    limited: Option<u32>,
}

/// Plans the motion of one axis; its queue, the overlay, passes the motion to the interrupt.
#[derive(Clone, Copy, Debug)]
pub struct Single {
    axis: Option<u8>,
    /// Whether the interrupt has a stroke of this motion.
    shown: bool,
    limits: AxisLimits,
    /// Programmed speed of strokes, and whether the override acts.
    v: f32,
    obeys: bool,
    /// The speed of the strokes in the queue.
    made: f32,
    goal: Goal,
    course: Course,
    ending: Ending,
    /// Whether the oscillation ends with its cycle.
    finishes: bool,
    /// End position of the planned strokes.
    at: i64,
    emitter: Emitter,
    laying: Option<Laying>,
    handed: Handed,
    /// The clock's count of idle ticks at the end of the motion.
    stood: Option<u32>,
}

/// The part of the motion that is in the queue.
#[derive(Clone, Copy, Debug)]
struct Handed {
    strokes: [Option<Stroke>; STROKES],
    /// The instant after the last piece in the queue.
    end: u32,
    cut: Option<Cut>,
    /// The instant of the last cut that was tried.
    tried: Option<u32>,
}

impl Single {
    /// No axis, and no motion.
    pub const NONE: Self = Self {
        axis: None,
        shown: false,
        limits: AxisLimits { limits: Limits::NOTHING, v_reduced: 0.0 },
        v: 0.0,
        obeys: false,
        made: 0.0,
        goal: Goal::Rest,
        course: Course { ends: [Position::ZERO; 2], waits: [0; 2], stroke: None, limited: None },
        ending: Ending::None,
        finishes: false,
        at: 0,
        emitter: Emitter::new(),
        laying: None,
        handed: Handed { strokes: [None; STROKES], end: 0, cut: None, tried: None },
        stood: None,
    };

    /// Index of the axis that moves on its own, also while a feed hold stops this motion; `None` if there is
    /// no motion.
    pub const fn axis(&self) -> Option<usize> {
        match self.axis {
            Some(axis) => Some(axis as usize),
            None => None,
        }
    }

    /// Whether the interrupt has received the motion. Also `true` if there is no motion.
    pub const fn is_shown(&self) -> bool {
        self.shown || matches!((self.goal, self.laying), (Goal::Rest, None))
    }

    /// Moves `axis` from its position `from` to `target`. `obeys`: whether the override acts. Returns `false`
    /// if the limits of the axis do not permit the demanded speed; the axis then moves as fast as its limits
    /// permit.
    ///
    /// # Errors
    /// [`Unplannable`]: the motion would take too long.
    pub fn go(
        &mut self,
        axis: u8,
        [from, target]: [Position; 2],
        pace: Pace,
        limits: &AxisLimits,
    ) -> Result<bool, Unplannable> {
        self.begin(axis, from, limits);
        let length = (fine(target) - fine(from)).abs();
        let mut profile = Profile::default();
        let (v, within) = match pace {
            Pace::Speed(v) => (v, v <= limits.limits.v),
            Pace::Time(time) => {
                stroke::plan_short(&mut profile, length.max(1), &limits.limits)?;
                let within = profile.time().to_bits() >> 4 <= time;
                let time = stroke::in_ticks(time.min(1 << 59) << 4);
                (
                    if within { stroke::speed_for(length, time, &limits.limits) } else { limits.limits.v },
                    within,
                )
            }
        };
        stroke::plan(&mut profile, length.max(1), &Limits { v: min(v, limits.limits.v), ..limits.limits })?;
        (self.axis, self.v, self.obeys, self.goal) = (Some(axis), v, true, Goal::To(target));
        Ok(within)
    }

    /// Starts an oscillation of `axis`, which is at `from`. Returns `false` if the limits of the axis do not
    /// permit the demanded speed.
    ///
    /// # Errors
    /// [`Unplannable`]: a stroke would take too long.
    pub fn oscillate(
        &mut self,
        axis: u8,
        from: Position,
        how: &Oscillating,
        limits: &AxisLimits,
    ) -> Result<bool, Unplannable> {
        self.begin(axis, from, limits);
        let [first, second] = how.ends.map(fine);
        // Each motion of an oscillation is a single stroke.
        let length = (second - first).abs();
        let mut profile = Profile::default();
        let v_most = stroke::plan_short(&mut profile, length, &limits.limits)?;
        let most = Limits { v: v_most, ..limits.limits };
        let (mut v, mut stroke, mut limited) = (v_most, None, None);
        match how.pace {
            Pace::Speed(wanted) => {
                v = min(wanted, v_most);
                stroke::plan(&mut profile, length, &Limits { v, ..most })?;
                // A slightly lower peak counts as rounding.
                if speed_bits(wanted * CLOSE) > profile.peak().to_bits() {
                    limited = Some(0);
                }
            }
            Pace::Time(period) => {
                let time = period.saturating_sub(how.waits[0]).saturating_sub(how.waits[1]) / 2;
                if time >> 32 >= u64::from(stroke::ticks(&profile)) {
                    v = stroke::speed_for(length, (time >> 32) as f32 * SOONER, &most);
                    stroke = Some(time);
                } else {
                    limited = Some(stroke::fastest(&profile));
                }
            }
        }
        stroke::plan_short(&mut profile, length, &Limits { v, ..most })?;
        (self.axis, self.v, self.obeys) = (Some(axis), v, false);
        let within = limited.is_none();
        self.course =
            Course { ends: how.ends, waits: how.waits, stroke, limited: limited.filter(|t| *t > 0) };
        self.goal = Goal::Swing(Swing { to_first: true, left: how.count, rest: 0, share: 0 });
        Ok(within)
    }

    fn begin(&mut self, axis: u8, from: Position, limits: &AxisLimits) {
        let handed = Handed { strokes: [None; STROKES], tried: None, ..self.handed };
        *self = Self { handed, limits: *limits, at: fine(from), axis: Some(axis), ..Self::NONE };
    }

    /// Ends the oscillation after the current cycle: the axis stops on the second position.
    pub fn finish(&mut self) {
        if core::mem::replace(&mut self.finishes, true) {
            return;
        }
        for goal in self.handed.strokes.iter_mut().flatten().map(|stroke| &mut stroke.before) {
            goal.end_cycle();
        }
        if let Some(laying) = &mut self.laying {
            laying.before.end_cycle();
        }
        self.goal.end_cycle();
    }

    /// Brakes the axis. The axis stays where it stops. No effect on an axis that already stands still.
    pub fn stop(&mut self) {
        let handed = self.handed.strokes.iter().any(Option::is_some);
        if handed || self.laying.is_some() || self.goal != Goal::Rest {
            self.ending = Ending::Here;
        }
    }

    /// Ends the oscillation at once: the axis brakes, and then moves to the second position at the speed `v`
    /// (mm/tick).
    pub fn leave(&mut self, v: f32) {
        if matches!(self.ending, Ending::None) && self.is_swinging() {
            self.ending = Ending::Then(self.course.ends[1], v);
        }
    }

    /// Whether the axis oscillates.
    pub fn is_swinging(&self) -> bool {
        let of = |goal: &Goal| matches!(goal, Goal::Swing(_));
        of(&self.goal)
            || self.laying.is_some_and(|laying| of(&laying.before))
            || self.handed.strokes.iter().flatten().any(|stroke| of(&stroke.before))
    }

    /// Position of the axis, if its motion has been over for at least `settling` ticks; otherwise `None`.
    /// `settling` is the time in which the filter of the axis settles.
    pub fn stands(&mut self, overlay: &OverlaySender<'_>, settling: u32) -> Option<Position> {
        let over = self.goal == Goal::Rest && self.laying.is_none() && self.ending == Ending::None;
        if !over || overlay.clock.now() != self.handed.end {
            self.stood = None;
            return None;
        }
        let idle = overlay.clock.idle();
        let rested = idle.wrapping_sub(*self.stood.get_or_insert(idle));
        // If the interrupt never had the motion, no filter has to settle.
        let settled = !self.shown || rested >= clock::TICK * settling;
        settled.then(|| set_point(self.at))
    }

    /// Gives the axis back to the path.
    pub fn release(&mut self) {
        self.axis = None;
    }

    /// Whether the axis stands still until a command of the operator changes.
    pub fn rests(&self, overlay: &OverlaySender<'_>) -> bool {
        overlay.clock.now() == self.handed.end
    }

    /// Does a bounded step of planning. Returns `false` if there is nothing to do now.
    ///
    /// # Errors
    /// [`Unplannable`] means a defect of the planner. The axis stops at the end of the queued strokes.
    pub fn work(&mut self, overlay: &mut OverlaySender<'_>, wishes: &Wishes) -> Result<bool, Unplannable> {
        let Some(axis) = self.axis else { return Ok(false) };
        self.trim(overlay);
        let hold = wishes.hold || self.obeys && wishes.feed == 0;
        if hold || self.ending != Ending::None {
            if !self.halt(overlay) {
                return Ok(false);
            }
            match core::mem::replace(&mut self.ending, Ending::None) {
                Ending::None => return Ok(false),
                Ending::Here => self.goal = Goal::Rest,
                Ending::Then(target, v) => {
                    (self.goal, self.v, self.obeys) = (Goal::To(target), v, true);
                }
            }
            return Ok(true);
        }
        let v = self.speed(wishes);
        if v != self.made && self.handed.strokes[0].is_some() && self.adjust(overlay, v) {
            return Ok(true);
        }
        if self.is_to_end_here() {
            return Ok(self.drop_next(overlay));
        }
        match &self.laying {
            Some(laying) if laying.left > 0 => Ok(self.cut_pieces(overlay)),
            Some(_) => Ok(self.hand_over(overlay, axis)),
            None => self.lay(v),
        }
    }

    /// The speed of strokes with the current commands: override and reduced speed.
    fn speed(&self, wishes: &Wishes) -> f32 {
        let share = if self.obeys { f32::from(wishes.feed) * 1e-3 } else { 1.0 };
        let v = min(self.v * share, self.limits.limits.v);
        if wishes.reduced { min(v, self.limits.v_reduced) } else { v }
    }

    /// Plans the next stroke, if there is one.
    fn lay(&mut self, v: f32) -> Result<bool, Unplannable> {
        let before = self.goal;
        if v != self.made && self.handed.strokes[0].is_some() {
            // Queued strokes stay unchanged; the new speed acts after the next stop.
            return Ok(false);
        }
        self.made = v;
        match self.goal {
            Goal::Rest => Ok(false),
            Goal::To(target) => {
                self.goal = Goal::Rest;
                self.lay_stroke(before, target, v, u64::from)?;
                if self.at != fine(target) {
                    self.goal = before;
                }
                Ok(true)
            }
            Goal::Swing(swing) if swing.left == Some(0) => {
                // Checked before the dwell, because there is no dwell after the last stroke. After a hold,
                // the axis may be elsewhere.
                let is_there = self.at == fine(self.course.ends[1]);
                let again = Goal::Swing(Swing { left: Some(1), ..swing });
                self.goal = if is_there { Goal::Rest } else { again };
                Ok(true)
            }
            Goal::Swing(swing) if swing.rest > 0 => {
                let ticks = swing.rest.min(LONGEST_REST);
                self.goal = Goal::Swing(Swing { rest: swing.rest - ticks, ..swing });
                self.laying = Some(Laying {
                    before,
                    from: self.at,
                    backward: false,
                    to: self.at,
                    ticks: 0,
                    left: ticks as u32,
                    ready: 0,
                });
                self.emitter = Emitter::new();
                Ok(true)
            }
            Goal::Swing(swing) => self.lay_swing(before, swing, v),
        }
    }

    /// Plans the next stroke of an oscillation.
    fn lay_swing(&mut self, before: Goal, swing: Swing, v: f32) -> Result<bool, Unplannable> {
        let Course { ends: [first, second], waits, stroke, limited } = self.course;
        let (target, other, wait) =
            if swing.to_first { (first, second, waits[0]) } else { (second, first, waits[1]) };
        let left = if swing.to_first { swing.left } else { swing.left.map(|left| left.saturating_sub(1)) };
        let ends = !swing.to_first && left == Some(0);
        // From another position, or at a lower speed than planned, the stroke takes its own time.
        let is_whole = self.at == fine(other) && v >= self.v;
        let time = stroke.filter(|_| is_whole);
        let share = if is_whole { swing.share } else { 0 };
        let mut spare = 0;
        let rest = self.lay_stroke(before, target, v, |ticks| {
            let exact = match (time, limited.filter(|_| is_whole)) {
                (Some(time), _) => share + time,
                (None, Some(limited)) => u64::from(limited) << 32,
                (None, None) => share + (u64::from(ticks) << 32),
            };
            let all = if ends { exact } else { exact + wait };
            spare = all & 0xffff_ffff;
            (all >> 32).max(u64::from(ticks))
        })?;
        if self.at != fine(target) {
            self.goal = before;
            return Ok(true);
        }
        let next = Swing { to_first: !swing.to_first, left, rest, share: spare };
        self.goal = if ends { Goal::Rest } else { Goal::Swing(next) };
        Ok(true)
    }

    /// Plans a stroke to `target` and the standstill after it. `all` converts the ticks of the stroke to the
    /// ticks of both. If the standstill is too long for a piece, a part is left for later. If the stroke
    /// takes too long, it ends before the target, at [`Self::at`].
    fn lay_stroke(
        &mut self,
        before: Goal,
        target: Position,
        v: f32,
        all: impl FnOnce(u32) -> u64,
    ) -> Result<u64, Unplannable> {
        let (from, mut to) = (self.at, fine(target));
        if to == from {
            return Ok(0);
        }
        let mut profile = Profile::default();
        let limits = Limits { v, ..self.limits.limits };
        let mut planned = stroke::plan_short(&mut profile, (to - from).abs(), &limits);
        for _ in 0..HALVES {
            if planned != Err(Unplannable::TooSlow) {
                break;
            }
            to = fine(set_point(from + (to - from) / 2));
            planned = stroke::plan_short(&mut profile, (to - from).abs(), &limits);
        }
        if let Err(error) = planned {
            self.goal = Goal::Rest;
            return Err(error);
        }
        let length = (to - from).abs();
        let moves = stroke::ticks(&profile);
        let all = if to == fine(target) { all(moves) } else { moves.into() };
        let ticks = all.min(u64::from(moves) + LONGEST_REST - 1);
        self.emitter = Emitter::new();
        self.emitter.resume_at(TICK);
        self.emitter.begin(&profile, Distance::ZERO, Distance::from_bits(length));
        let backward = to < from;
        self.laying = Some(Laying { before, from, backward, to, ticks: 0, left: ticks as u32, ready: 0 });
        self.at = to;
        Ok(all - ticks)
    }

    /// Writes pieces of the planned stroke, at most the number for one call. Returns `false` if there is no
    /// room.
    fn cut_pieces(&mut self, overlay: &mut OverlaySender<'_>) -> bool {
        let Self { laying: Some(laying), emitter, .. } = self else { return false };
        let mut done = false;
        for _ in 0..PIECES {
            if !has_room(overlay, laying.ready) {
                return done;
            }
            let is_rest = !emitter.has_piece();
            let Laying { from, backward, to, ticks, left, ready, .. } = laying;
            let filled = overlay.pieces.fill_ahead(*ready, |phase| {
                if is_rest {
                    let rest = u64::from(*left).clamp(1, LONGEST_REST) as u16;
                    *phase = Phase { distance: Distance::from_bits(*to), ticks: rest, ..Phase::BLANK };
                } else {
                    emitter.step(phase);
                    place(phase, *from, *backward);
                }
                *ticks += u32::from(phase.ticks);
                *left = left.saturating_sub(u32::from(phase.ticks));
            });
            if !filled {
                return done;
            }
            *ready += 1;
            done = true;
            if is_rest {
                break;
            }
            // The last tick is a tick of standstill.
            *left = (*left).max(1);
        }
        done
    }

    /// Puts the planned stroke into the queue before the current one ends.
    fn hand_over(&mut self, overlay: &mut OverlaySender<'_>, axis: u8) -> bool {
        let Some(laying) = self.laying else { return false };
        let Some(slot) = self.handed.strokes.iter_mut().find(|slot| slot.is_none()) else { return false };
        if overlay.pieces.len() > FEW {
            return false;
        }
        self.handed.end = self.handed.end.wrapping_add(clock::TICK * laying.ticks);
        *slot = Some(Stroke { before: laying.before, end: self.handed.end });
        overlay.pieces.put_in(laying.ready);
        overlay.take_over(axis);
        self.shown = true;
        self.laying = None;
        true
    }

    /// Drops strokes and a cut that are over.
    fn trim(&mut self, overlay: &OverlaySender<'_>) {
        let now = overlay.clock.now();
        if self.handed.cut.is_some_and(|Cut(at)| clock::is_before(at, now)) {
            overlay.clock.withdraw();
            self.handed.cut = None;
        }
        let [first, second] = &mut self.handed.strokes;
        while first.is_some_and(|first| !clock::is_before(now, first.end)) {
            *first = second.take();
        }
    }

    /// Drops the planned stroke, which is not in the queue yet.
    fn drop_laying(&mut self) {
        if let Some(laying) = self.laying.take() {
            (self.goal, self.at) = (laying.before, laying.from);
        }
    }
}

impl Goal {
    /// Whether an oscillation has ended: its next stroke would lead to the first position.
    const fn is_ended(self) -> bool {
        matches!(self, Self::Swing(Swing { to_first: true, left: Some(0), .. }))
    }

    /// Ends an oscillation with the current cycle: no further stroke to the first position begins.
    fn end_cycle(&mut self) {
        if let Self::Swing(Swing { to_first, left, .. }) = self {
            *left = Some(u32::from(!*to_first));
        }
    }
}

/// Whether there is room for another piece after the finished ones. The place of the current piece must stay
/// unchanged, because [`Single::motion_at`] reads it.
fn has_room(overlay: &OverlaySender<'_>, ready: u32) -> bool {
    overlay.pieces.room() > ready + 1
}

/// Converts a piece of a stroke into positions of the axis, from the start position of the stroke.
fn place(phase: &mut Phase, from: i64, backward: bool) {
    let distance = phase.distance.to_bits();
    if !backward {
        phase.distance = Distance::from_bits(from.wrapping_add(distance));
        return;
    }
    phase.distance = Distance::from_bits(from.wrapping_sub(distance));
    phase.speed = Speed::from_bits(-phase.speed.to_bits());
    phase.half_accel = Accel::from_bits(-phase.half_accel.to_bits());
    phase.sixth_jerk = Jerk::from_bits(-phase.sixth_jerk.to_bits());
}

/// A speed above this part of the demanded speed counts as reached.
const CLOSE: f32 = 1.0 - 1.0 / 65_536.0;

/// A stroke of whole ticks is planned slightly faster by this ratio, so that rounding does not make it a tick
/// longer.
const SOONER: f32 = 1.0 - 1.0 / 65_536.0;
