//! The homing cycle, which finds the positions of the limit switches.
//!
//! The third axis goes first, then all others together. Each axis moves to its switch, brakes, and moves away
//! from the switch. The axis then approaches the switch again slowly, and moves away again. The timer
//! interrupt stores the position at which the input changes. This stored position counts as the position of
//! the switch, so the braking distance causes no error.
use super::Machine;
use crate::motion;
use glidepath::channel::MoveError;
use glidepath::quantity::{Feed, Position};
use glidepath::tick::State;

/// The current step of an axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Step {
    /// The previous motion brakes.
    Begin,
    /// The axis moves toward the switch, fast or slowly.
    Approach(Visit),
    /// The axis pulls off, to the distance `$27` from the switch.
    PullOff(Visit),
    /// The interrupt takes over the new coordinates.
    Take,
    /// The axes stand still for `$26` before they pull off, or before the second approach.
    Settle(Visit, bool),
}

/// The first approach finds the switch, the second approach measures its position.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Visit {
    First,
    Second,
}

/// A homing cycle.
#[derive(Clone, Copy, Debug)]
pub struct Homing<const AXES: usize> {
    step: Step,
    /// Axes of the current pass, bit i for axis i.
    pass: u32,
    /// Axes of later passes.
    left: u32,
    /// Axes of the current pass that have not started the motion of this step.
    starts: u32,
    /// Latched positions of the switches, in machine coordinates before homing.
    seen: [Option<Position>; AXES],
    /// Tick at which the current pause ends.
    until: u32,
}

/// Alarm: the switch is still on after the pull-off.
const STILL_ON: u8 = 8;

/// Alarm: the switch was not found.
const NOT_FOUND: u8 = 9;

impl<const AXES: usize> Homing<AXES> {
    /// Homes all axes: the third axis, then the others.
    pub fn new() -> Self {
        let all = 1_u32.checked_shl(AXES as u32).map_or(u32::MAX, |bit| bit - 1);
        let first = all & 0b100;
        Self { step: Step::Begin, pass: first, left: all & !first, starts: 0, seen: [None; AXES], until: 0 }
    }

    fn axes(&self) -> impl Iterator<Item = usize> + use<AXES> {
        let pass = self.pass;
        (0..AXES).filter(move |axis| pass >> axis & 1 == 1)
    }
}

/// A length of the settings, in 0.001 mm.
fn length(milli: u64) -> Position {
    Position::from_bits((((i128::from(milli) << 32) + 500) / 1000) as i64)
}

impl<const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> Machine<'_, AXES, BLOCKS, OVERLAYS> {
    /// Does the next step of the cycle.
    pub(super) fn follow_homing(&mut self) {
        let Some(mut homing) = self.cycles.homing else { return };
        if let Step::Approach(_) = homing.step {
            self.stop_at_switches(&mut homing);
        }
        let stands = self.planner.is_at_rest() && self.operator.status().state == State::Idle;
        let done = match homing.starts {
            0 if stands => self.next_step(&mut homing),
            0 => Ok(false),
            _ => self.start(&mut homing).map(|()| false),
        };
        self.cycles.homing = Some(homing);
        match done {
            Ok(false) => return,
            Ok(true) => self.cycles.homed = motion::Homing::Done,
            Err(alarm) => self.cycles.homed = motion::Homing::Failed(alarm),
        }
        self.cycles.homing = None;
        self.line.end = Some(super::End::Aborted);
        self.work();
    }

    /// Whether the timer interrupt takes over new coordinates while the axes stand still. The change of the
    /// set points in the next tick is then no motion.
    pub fn is_relocating(&self) -> bool {
        self.cycles.homing.is_some_and(|homing| homing.step == Step::Take)
    }

    /// Stops the axes whose switch is on.
    fn stop_at_switches(&mut self, homing: &mut Homing<AXES>) {
        for axis in homing.axes() {
            let (Some(edge), Some(seen)) = (self.inputs.limit(axis), homing.seen.get_mut(axis)) else {
                continue;
            };
            if edge.is_on && seen.is_none() {
                *seen = edge.place.get(axis).copied();
                self.planner.stop_axis(axis);
            }
        }
    }

    /// Chooses the next step at standstill. Returns `true` at the end of the cycle.
    fn next_step(&mut self, homing: &mut Homing<AXES>) -> Result<bool, u8> {
        match homing.step {
            Step::Begin if homing.pass == 0 => {
                (homing.pass, homing.left) = (homing.left, 0);
                if homing.pass == 0 {
                    return Ok(true);
                }
            }
            Step::Begin => self.approach(homing, Visit::First)?,
            Step::Approach(visit) => {
                // If a switch was on from the start, its position is the current one.
                self.stop_at_switches(homing);
                if homing.axes().any(|axis| !matches!(homing.seen.get(axis), Some(Some(_)))) {
                    return Err(NOT_FOUND);
                }
                self.settle(homing, visit, true);
            }
            Step::Settle(visit, true) if self.has_settled(homing) => self.pull_off(homing, visit)?,
            Step::Settle(_, false) if self.has_settled(homing) => {
                if homing.axes().any(|axis| self.inputs.limit(axis).is_some_and(|edge| edge.is_on)) {
                    return Err(STILL_ON);
                }
                self.approach(homing, Visit::Second)?;
            }
            Step::Settle(..) => {}
            Step::PullOff(Visit::First) => self.settle(homing, Visit::First, false),
            Step::PullOff(Visit::Second) => {
                if homing.axes().any(|axis| self.inputs.limit(axis).is_some_and(|edge| edge.is_on)) {
                    return Err(STILL_ON);
                }
                self.set_places(homing)?;
                homing.step = Step::Take;
            }
            Step::Take if self.operator.status().set_points == *self.planner.position() => {
                (homing.pass, homing.left, homing.step) = (homing.left, 0, Step::Begin);
                return Ok(homing.pass == 0);
            }
            Step::Take => {}
        }
        Ok(false)
    }

    fn settle(&self, homing: &mut Homing<AXES>, visit: Visit, then_pulls: bool) {
        let cycle_us = u64::from(self.data.channel.cycle_us.max(1));
        let us = u64::from(self.settings.debounce_ms) * 1000;
        let ticks = us.checked_div(cycle_us).unwrap_or(0) as u32;
        homing.until = self.operator.status().ticks.wrapping_add(ticks) & TICKS;
        homing.step = Step::Settle(visit, then_pulls);
    }

    fn has_settled(&self, homing: &Homing<AXES>) -> bool {
        let left = homing.until.wrapping_sub(self.operator.status().ticks) & TICKS;
        left == 0 || left > TICKS / 2
    }

    /// +1 if the switch lies in the positive direction, else -1.
    fn direction(&self, axis: usize) -> i64 {
        if u32::from(self.settings.homing_mask) >> axis & 1 == 1 { -1 } else { 1 }
    }

    fn approach(&mut self, homing: &mut Homing<AXES>, visit: Visit) -> Result<(), u8> {
        (homing.seen, homing.step, homing.starts) = ([None; AXES], Step::Approach(visit), homing.pass);
        for axis in homing.axes() {
            if self.inputs.limit(axis).is_some_and(|edge| edge.is_on) {
                // The position of the switch is the current position of the axis.
                if let (Some(seen), Some(at)) = (homing.seen.get_mut(axis), self.planner.position().get(axis))
                {
                    *seen = Some(*at);
                    homing.starts &= !(1 << axis);
                }
            }
        }
        self.start(homing)
    }

    /// Starts the motion to the distance `$27` from the switch.
    fn pull_off(&mut self, homing: &mut Homing<AXES>, visit: Visit) -> Result<(), u8> {
        (homing.step, homing.starts) = (Step::PullOff(visit), homing.pass);
        self.start(homing)
    }

    /// Starts the axes that have not started yet, one axis per call of the planner.
    fn start(&mut self, homing: &mut Homing<AXES>) -> Result<(), u8> {
        let starts = homing.starts;
        for axis in (0..AXES).filter(|axis| starts >> axis & 1 == 1) {
            let Some((target, feed_milli)) = self.goal_of(homing, axis) else { continue };
            let feed = Feed::from_bits(((i128::from(feed_milli) << 32) / 1000) as i64);
            match self.planner.seek_axis(axis, target, Some(feed)) {
                Ok(()) => homing.starts &= !(1 << axis),
                Err(MoveError::NotAtRest) => break,
                // The machine cannot move this distance or at this speed.
                Err(_) => return Err(NOT_FOUND),
            }
        }
        self.work();
        Ok(())
    }

    /// Target of an axis in this step, and its speed in 0.001 mm/min.
    fn goal_of(&self, homing: &Homing<AXES>, axis: usize) -> Option<(Position, u32)> {
        let settings = &self.settings;
        let from = self.planner.position().get(axis).copied()?;
        let travel = settings.axes.get(axis).map_or(0, |axis| u64::from(axis.travel_milli));
        let (way, feed) = match homing.step {
            Step::Approach(Visit::First) => (travel * 3 / 2, settings.seek_milli),
            Step::Approach(Visit::Second) => (u64::from(settings.pull_off_milli) * 5, settings.locate_milli),
            _ => {
                let seen = homing.seen.get(axis).copied()??;
                return Some((seen.saturating_sub(self.way_off(axis)), settings.seek_milli));
            }
        };
        let way = Position::from_bits(length(way).to_bits() * self.direction(axis));
        Some((from.saturating_add(way), feed))
    }

    fn way_off(&self, axis: usize) -> Position {
        let way = length(u64::from(self.settings.pull_off_milli));
        Position::from_bits(way.to_bits() * self.direction(axis))
    }

    /// The axes stand at the distance `$27` from their switches. Here the machine coordinates begin.
    fn set_places(&mut self, homing: &Homing<AXES>) -> Result<(), u8> {
        for axis in homing.axes() {
            let travel = self.settings.axes.get(axis).map_or(0, |axis| u64::from(axis.travel_milli));
            let switch = if self.direction(axis) > 0 {
                Position::ZERO
            } else {
                Position::from_bits(-length(travel).to_bits())
            };
            let place = switch.saturating_sub(self.way_off(axis));
            self.planner.set_position(axis, place).map_err(|_| NOT_FOUND)?;
        }
        Ok(())
    }
}

/// Compares tick numbers, which wrap at 2^31.
const TICKS: u32 = (1 << 31) - 1;
