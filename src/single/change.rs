//! Changes the motion of a single axis that the interrupt already executes: stops the axis, ends an
//! oscillation after its cycle, or changes the speed.
//!
//! Only one change is in progress at a time, and the planner tries at most one change per tick. If the
//! current stroke already brakes, the stroke stays unchanged.
use super::{Goal, Single, has_room, place, stroke};
use crate::math::float::max;
use crate::quantity::{Distance, Speed, speed_bits, speed_f32};
use crate::queue::{Change, OVERLAY_PHASES, OverlaySender, Phase, Slot, TooLate, clock, fine, set_point};
use crate::slope::brake::{Brake, Motion, SHORT};
use crate::slope::emit::Emitter;
use crate::slope::limits::Limits;
use crate::slope::profile::Profile;

/// Ticks from a command to the change. In this time, the planner makes the new profile.
const REACTION: u32 = 4;

/// Largest number of halvings of a raised speed.
const SLOWER: usize = 6;

/// The motion of the axis at a future instant. Distance and speed are positive in the direction of the
/// motion.
struct Ahead {
    /// Number of the stroke, and the instant of the change.
    k: usize,
    at: u32,
    /// Position of the axis at that instant, and end position of its stroke.
    from: i64,
    to: i64,
    backward: bool,
    /// Motion at that instant; its distance is 0, and its speed is not negative.
    motion: Motion,
}

/// What replaces the rest of a stroke: first the pieces of the emitter, then this profile, then a standstill.
struct Law {
    from: i64,
    backward: bool,
    then: Option<(Profile, i64, i64)>,
}

impl Single {
    /// Stops the axis as soon as its limits permit. Returns whether the axis stands.
    pub(super) fn halt(&mut self, overlay: &mut OverlaySender<'_>) -> bool {
        self.drop_laying();
        if self.rests(overlay) {
            return true;
        }
        let Some(ahead) = self.attempt(overlay) else { return false };
        if ahead.motion.is_rest() {
            let goal = self.behind(ahead.k);
            self.cut(overlay, (ahead.k, ahead.at), goal, None, ahead.from);
            return false;
        }
        let limits = &self.limits.limits;
        let room = (ahead.to - ahead.from).abs();
        let mut profile = Profile::default();
        let brake = (ahead.motion.accel >= 0)
            .then(|| Brake::down_to(&mut profile, &ahead.motion, room, (limits, limits.a_down), 0))
            .flatten();
        let Some(brake) = brake else {
            self.end_with(overlay, &ahead);
            return false;
        };
        self.emit_from_here();
        self.emitter.begin_brake(&profile, &brake);
        let way = if ahead.backward { -brake.end } else { brake.end };
        let stands = fine(set_point(ahead.from.wrapping_add(way)));
        let mut goal = self.handed.strokes.get(ahead.k).copied().flatten().map_or(Goal::Rest, |s| s.before);
        if let Goal::Swing(swing) = &mut goal {
            (swing.rest, swing.share) = (0, 0);
        }
        let law = Law { from: ahead.from, backward: ahead.backward, then: None };
        self.cut(overlay, (ahead.k, ahead.at), goal, Some(law), stands);
        false
    }

    /// Whether the oscillation has to end with the current stroke, while the next stroke is already in the
    /// queue.
    pub(super) fn is_to_end_here(&self) -> bool {
        match (&self.handed.strokes, &self.laying) {
            ([Some(_), Some(next)], _) if next.before.is_ended() => self.handed.tried != Some(next.end),
            (_, Some(laying)) => laying.before.is_ended(),
            _ => false,
        }
    }

    /// Withdraws the strokes after the current one, if there is time.
    pub(super) fn drop_next(&mut self, overlay: &mut OverlaySender<'_>) -> bool {
        self.drop_laying();
        if let [Some(_), Some(next)] = self.handed.strokes
            && next.before.is_ended()
        {
            if let Some(ahead) = self.attempt(overlay)
                && ahead.k == 0
            {
                self.end_with(overlay, &ahead);
            }
            if self.handed.cut.is_none() && self.is_begun(overlay) {
                // It is too late: the axis continues to the end of the cycle that has begun.
                self.handed.tried = Some(next.end);
            }
            return false;
        }
        true
    }

    /// Whether the next stroke begins within the time that a change takes.
    fn is_begun(&self, overlay: &OverlaySender<'_>) -> bool {
        let at = overlay.clock.now().wrapping_add(clock::TICK * REACTION);
        self.handed.strokes[0].is_none_or(|stroke| !clock::is_before(at, stroke.end))
    }

    /// Changes the speed of the current stroke to `v`. Returns whether the speed has changed.
    pub(super) fn adjust(&mut self, overlay: &mut OverlaySender<'_>, v: f32) -> bool {
        self.drop_laying();
        if self.rests(overlay) {
            return false;
        }
        let Some(ahead) = self.attempt(overlay) else { return false };
        if ahead.motion.is_rest() || ahead.motion.accel < 0 {
            self.end_with(overlay, &ahead);
            return false;
        }
        let room = (ahead.to - ahead.from).abs();
        let mut limits = Limits { v, ..self.limits.limits };
        let mut profile = Profile::default();
        let mut then = None;
        if v < self.made {
            let brake =
                Brake::plan(&mut profile, &ahead.motion, room, 0, (&limits, limits.a_down), speed_bits(v));
            let Some(brake) = brake else { return false };
            let left = room - brake.end;
            if brake.tail > 0 || brake.v_out <= 0 || left < SHORT {
                return false;
            }
            limits.v = max(v, speed_f32(brake.v_out));
            let mut rest = Profile::default();
            let (length, v_in) = (Distance::from_bits(left), Speed::from_bits(brake.v_out));
            if rest.plan(length, v_in, Speed::ZERO, &limits).is_err() {
                return false;
            }
            self.emit_from_here();
            self.emitter.begin_brake(&profile, &brake);
            then = Some((rest, brake.end, left));
        } else {
            let v_in = Speed::from_bits(ahead.motion.speed);
            if ahead.motion.accel > 0 || room < SHORT {
                return false;
            }
            let length = Distance::from_bits(room);
            let mut planned = profile.plan(length, v_in, Speed::ZERO, &limits);
            for _ in 0..SLOWER {
                if planned.is_err() || stroke::is_short(&profile) {
                    break;
                }
                // A lower speed is tried, until there is room for the pieces.
                limits.v = 0.5 * (limits.v + speed_f32(v_in.to_bits()));
                planned = profile.plan(length, v_in, Speed::ZERO, &limits);
            }
            if planned.is_err() {
                return false;
            }
            self.emit_from_here();
            self.emitter.begin(&profile, Distance::ZERO, Distance::from_bits(room));
        }
        let mut goal = self.behind(ahead.k);
        if let Goal::Swing(swing) = &mut goal {
            swing.rest = self.course.waits[usize::from(swing.to_first)] >> 32;
        }
        let law = Law { from: ahead.from, backward: ahead.backward, then };
        let done = self.cut(overlay, (ahead.k, ahead.at), goal, Some(law), ahead.to);
        if done {
            self.made = v;
        }
        done
    }

    /// Lets the pieces start at a tick. Pieces of a change without room are dropped.
    fn emit_from_here(&mut self) {
        self.emitter = Emitter::new();
        self.emitter.resume_at(0);
    }

    /// The goal after the stroke `k`.
    fn behind(&self, k: usize) -> Goal {
        self.handed.strokes.get(k + 1).copied().flatten().map_or(self.goal, |next| next.before)
    }

    /// The motion at the instant of a change that is decided now; `None` if no change is possible now.
    fn attempt(&mut self, overlay: &OverlaySender<'_>) -> Option<Ahead> {
        let now = overlay.clock.now();
        if self.handed.cut.is_some() || self.handed.tried == Some(now) {
            return None;
        }
        self.handed.tried = Some(now);
        let at = now.wrapping_add(clock::TICK * REACTION);
        let ends = self.handed.strokes.map(|stroke| stroke.map(|stroke| stroke.end));
        let (k, end) = ends
            .into_iter()
            .enumerate()
            .find_map(|(k, end)| end.filter(|end| clock::is_before(at, *end)).map(|end| (k, end)))?;
        let motion = self.motion_at(overlay, at)?;
        let to = self.motion_at(overlay, end.wrapping_sub(clock::TICK))?.distance;
        let backward = motion.speed < 0;
        let turned = |x: i64| if backward { -x } else { x };
        let seen = Motion { distance: 0, speed: turned(motion.speed), accel: turned(motion.accel) };
        Some(Ahead { k, at, from: motion.distance, to, backward, motion: seen })
    }

    /// The motion at an instant that the queue covers.
    fn motion_at(&self, overlay: &OverlaySender<'_>, at: u32) -> Option<Motion> {
        let mut start = self.handed.end;
        let mut number = overlay.pieces.count();
        for _ in 0..OVERLAY_PHASES {
            number = number.wrapping_sub(1);
            let mut phase = *overlay.pieces.recent(number)?;
            start = start.wrapping_sub(clock::TICK * u32::from(phase.ticks));
            if clock::is_before(at, start) {
                continue;
            }
            phase.advance((at.wrapping_sub(start) / clock::TICK) as u16);
            return Some(Motion {
                distance: phase.distance.to_bits(),
                speed: phase.speed.to_bits(),
                accel: 2 * phase.half_accel.to_bits(),
            });
        }
        None
    }

    /// Withdraws the pieces after the stroke of `ahead`.
    fn end_with(&mut self, overlay: &mut OverlaySender<'_>, ahead: &Ahead) {
        if let (0, [Some(stroke), Some(next)]) = (ahead.k, self.handed.strokes) {
            self.cut(overlay, (0, stroke.end), next.before, None, ahead.to);
        }
    }

    /// Cuts the stroke `k` at the instant `at`, or at its end. From there on, the axis follows `law`, if
    /// given, and then stands still at `stands`, with `goal` as its next goal. Returns `false`, and changes
    /// nothing, if there is no room or if it is too late.
    fn cut(
        &mut self,
        overlay: &mut OverlaySender<'_>,
        (k, at): (usize, u32),
        goal: Goal,
        law: Option<Law>,
        stands: i64,
    ) -> bool {
        // There must be room for the barrier and the standstill.
        if !has_room(overlay, 1) {
            return false;
        }
        let change = Change::begin(&mut overlay.pieces);
        let mut end = at;
        let fits = law.is_none_or(|law| self.put_law(overlay, &law, &mut end));
        let rest = Phase { distance: Distance::from_bits(stands), ticks: 1, ..Phase::BLANK };
        if !fits || !has_room(overlay, 0) || overlay.pieces.push(rest).is_err() {
            change.abandon(&mut overlay.pieces, overlay.clock);
            return false;
        }
        end = end.wrapping_add(clock::TICK);
        match change.commit(at, &mut overlay.pieces, overlay.clock) {
            Err(TooLate) => false,
            Ok(cut) => {
                self.handed.cut = Some(cut);
                self.handed.end = end;
                for (number, stroke) in self.handed.strokes.iter_mut().enumerate().skip(k) {
                    *stroke = stroke.filter(|_| number == k).map(|stroke| super::Stroke { end, ..stroke });
                }
                (self.at, self.goal) = (stands, goal);
                true
            }
        }
    }

    /// Writes all pieces of a profile. Returns `false` if there is no room.
    fn put_law(&mut self, overlay: &mut OverlaySender<'_>, law: &Law, end: &mut u32) -> bool {
        let mut then = law.then.as_ref();
        loop {
            while self.emitter.has_piece() {
                if !has_room(overlay, 0) {
                    return false;
                }
                let emitter = &mut self.emitter;
                let put = overlay.pieces.push_with(|phase| {
                    emitter.step(phase);
                    place(phase, law.from, law.backward);
                    *end = end.wrapping_add(clock::TICK * u32::from(phase.ticks));
                });
                if !put {
                    return false;
                }
            }
            let Some((profile, start, length)) = then.take() else { return true };
            self.emitter.begin(profile, Distance::from_bits(*start), Distance::from_bits(*length));
        }
    }
}
