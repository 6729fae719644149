//! Blocks that consist of several motions: G28 and G30, arcs of several turns, spirals, and canned cycles.
//! Each call returns one motion, dwell or spindle command.
use crate::machine::functions;
use crate::math::angle::atan2_turns;
use crate::nc::compose::carry;
use crate::nc::{ArcBy, MotionKind, Plane, real};
use crate::quantity::Position;

/// The kind of a canned drilling cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum CycleKind {
    /// G81: drill to the bottom, out in rapid motion. The numbers start at 1, so that all bytes are zero if
    /// there is no cycle ([`super::Foreign::BLANK`]).
    Drill = 1,
    /// G82: drill, with a dwell at the bottom.
    Dwell,
    /// G83: drill in pecks, each followed by a motion out to R.
    Peck,
    /// G73: drill in pecks, each followed by a short motion back, to break the chip.
    Break,
    /// G85: bore, out at feed.
    Bore,
    /// G89: bore, with a dwell at the bottom, out at feed.
    BoreDwell,
    /// G86: bore, with a dwell and a stop of the spindle at the bottom, out in rapid motion.
    BoreStop,
    /// G84: tap a right-hand thread.
    Tap,
    /// G74: tap a left-hand thread.
    TapLeft,
}

impl CycleKind {
    /// Whether the cycle has a dwell at the bottom.
    pub const fn dwells(self) -> bool {
        matches!(self, Self::Dwell | Self::BoreDwell | Self::BoreStop | Self::Tap | Self::TapLeft)
    }

    /// Whether the cycle needs P.
    pub const fn needs_dwell(self) -> bool {
        matches!(self, Self::Dwell | Self::BoreDwell)
    }

    /// Whether the spindle reverses at the bottom, for the motion out of the hole.
    const fn taps(self) -> bool {
        matches!(self, Self::Tap | Self::TapLeft)
    }

    /// Whether the cycle drills in pecks.
    pub const fn pecks(self) -> bool {
        matches!(self, Self::Peck | Self::Break)
    }
}

/// A block that is carried out in several parts. All bytes of `None` are zero: [`super::Foreign::BLANK`].
#[derive(Clone, Copy)]
#[repr(u8)]
pub enum Course<const AXES: usize> {
    None,
    /// G28 or G30: first to the intermediate point, if the block gives one, then to the stored position.
    Home {
        way: Option<[Position; AXES]>,
        to: [Position; AXES],
    },
    Turns(Turns<AXES>),
    Spiral(Spiral<AXES>),
    Holes(Holes<AXES>),
}

/// One part of a block.
#[derive(Clone, Copy)]
pub enum Part<const AXES: usize> {
    Motion(MotionKind, [Position; AXES]),
    /// A dwell, s.
    Dwell(Position),
    /// An M function of the spindle.
    M(u16),
}

impl<const AXES: usize> Course<AXES> {
    /// The next part, from position `at`; `None` when the block is done. `rests`: rounding remainders of
    /// increments.
    pub fn next(&mut self, at: &[Position; AXES], rests: &mut [i32; AXES]) -> Option<Part<AXES>> {
        match self {
            Self::None => None,
            Self::Turns(_) | Self::Holes(_) if !functions::DIALECTS.is_built() => None,
            Self::Home { way, to } => {
                let (target, last) = match way.take() {
                    Some(way) if way != *at => (way, false),
                    _ => (*to, true),
                };
                if last {
                    *self = Self::None;
                }
                Some(Part::Motion(MotionKind::Rapid, target))
            }
            Self::Turns(turns) => turns.next(),
            Self::Spiral(spiral) => spiral.next(),
            Self::Holes(holes) => holes.next(at, rests),
        }
    }

    /// Whether the block has parts.
    pub const fn is_some(&self) -> bool {
        !matches!(self, Self::None)
    }
}

/// An arc of several turns: full circles, then the arc as programmed.
#[derive(Clone, Copy)]
pub struct Turns<const AXES: usize> {
    pub start: [Position; AXES],
    pub end: [Position; AXES],
    /// Axes of the plane.
    pub axes: [usize; 2],
    pub centre: [Position; 2],
    pub plane: Plane,
    pub clockwise: bool,
    /// Number of full circles before the arc.
    pub full: u32,
    pub done: u32,
}

impl<const AXES: usize> Turns<AXES> {
    fn next(&mut self) -> Option<Part<AXES>> {
        if self.done > self.full {
            return None;
        }
        self.done += 1;
        let last = self.done > self.full;
        let target = if last { self.end } else { self.behind(self.done) };
        let by = ArcBy::Centre(self.centre);
        let kind = MotionKind::Arc { plane: self.plane, clockwise: self.clockwise, by };
        Some(Part::Motion(kind, target))
    }

    /// Distance from the centre to a point, along an axis of the plane.
    fn off_centre(&self, point: &[Position; AXES], k: usize) -> i64 {
        let (axis, centre) = (self.axes.get(k), self.centre.get(k));
        let at = axis.and_then(|axis| point.get(*axis)).copied().unwrap_or_default();
        at.saturating_sub(centre.copied().unwrap_or_default()).to_bits()
    }

    fn direction(&self, point: &[Position; AXES]) -> u64 {
        atan2_turns(self.off_centre(point, 1), self.off_centre(point, 0))
    }

    /// Distance of a point from the centre, mm.
    pub fn radius(&self, point: &[Position; AXES]) -> f64 {
        let [x, y] = [0, 1].map(|k| self.off_centre(point, k) as f64 / 4_294_967_296.0);
        real::sqrt(x * x + y * y)
    }

    /// The angle of the arc without full circles, LSB 2^-48 revolutions, above 0.
    fn angle(&self) -> u64 {
        let turned = self.direction(&self.end).wrapping_sub(self.direction(&self.start));
        let turned = if self.clockwise { turned.wrapping_neg() } else { turned };
        // Rounded to nearest; an angle of nearly zero is a full circle.
        match ((turned >> 15) + 1) >> 1 {
            0 => 1 << 48,
            angle => angle,
        }
    }

    /// Position of all axes after `turns` full circles. Axes outside the plane move in proportion to the
    /// angle.
    fn behind(&self, turns: u32) -> [Position; AXES] {
        let whole = (i128::from(self.full) << 48) + i128::from(self.angle());
        let part = i128::from(turns) << 48;
        let mut target = self.start;
        for (axis, (slot, end)) in target.iter_mut().zip(&self.end).enumerate() {
            if self.axes.contains(&axis) {
                continue;
            }
            // A value below 2^50 times a value below 2^62.
            let travel = i128::from(end.to_bits()) - i128::from(slot.to_bits());
            // `whole` is above 0, because the angle is above 0.
            let gone = (travel * part * 2 + whole).checked_div_euclid(whole * 2).unwrap_or(0);
            *slot = Position::from_bits(slot.to_bits().saturating_add(gone as i64));
        }
        target
    }
}

/// An arc whose radius changes linearly with its angle, carried out as several arcs.
#[derive(Clone, Copy)]
pub struct Spiral<const AXES: usize> {
    /// The arc as it was programmed.
    pub turns: Turns<AXES>,
    /// Radius at the start and at the end, mm.
    pub radii: [f64; 2],
    /// Number of arcs; a whole number.
    pub count: f64,
}

impl<const AXES: usize> Spiral<AXES> {
    fn next(&mut self) -> Option<Part<AXES>> {
        let Turns { plane, clockwise, centre, end, done, .. } = self.turns;
        let (done, last) = (done + 1, f64::from(done + 1) >= self.count);
        if f64::from(done) > self.count {
            return None;
        }
        self.turns.done = done;
        let target = if last { end } else { self.behind(f64::from(done) / self.count) };
        Some(Part::Motion(MotionKind::Arc { plane, clockwise, by: ArcBy::Centre(centre) }, target))
    }

    /// Position of all axes after the share `part` (0 to 1) of the angle.
    fn behind(&self, part: f64) -> [Position; AXES] {
        let turns = &self.turns;
        let degrees = |turns: u64, lsb: f64| turns as f64 * 360.0 / lsb;
        let from = degrees(turns.direction(&turns.start) >> 11, 9_007_199_254_740_992.0);
        let swept = degrees(turns.angle(), 281_474_976_710_656.0) * part;
        let angle = if turns.clockwise { from - swept } else { from + swept };
        let (sin, cos) = real::sin_cos(angle).unwrap_or((0.0, 1.0));
        let [first, last] = self.radii;
        let radius = first + (last - first) * part;
        let bits = |mm: f64| real::round(mm * 4_294_967_296.0) as i64;
        let mut target = turns.start;
        for (axis, (slot, end)) in target.iter_mut().zip(&turns.end).enumerate() {
            let travel = (end.to_bits().saturating_sub(slot.to_bits())) as f64 * part;
            *slot = Position::from_bits(slot.to_bits().saturating_add(real::round(travel) as i64));
            for ((own, centre), along) in turns.axes.iter().zip(turns.centre).zip([cos, sin]) {
                if *own == axis {
                    *slot = Position::from_bits(centre.to_bits().saturating_add(bits(radius * along)));
                }
            }
        }
        target
    }
}

/// A peck that ends within a nanometre of the bottom is the last one; the value covers rounding.
const NEAR: Position = Position::from_bits(1 << 12);

/// Actions of the spindle in a hole.
#[derive(Clone, Copy)]
pub struct Acts {
    /// M3 or M4: direction of the spindle after the hole.
    pub turn: u16,
    /// Whether tapping retracts at feed only to R, where the spindle reverses.
    pub to_level: bool,
    /// Number of actions done at the bottom, or after the hole.
    pub done: u8,
}

/// Holes of a canned cycle, in machine coordinates.
#[derive(Clone, Copy)]
pub struct Holes<const AXES: usize> {
    pub kind: CycleKind,
    /// Axes of the plane, and axis of the hole.
    pub axes: [usize; 3],
    /// Step from hole to hole, and its rounding remainder.
    pub step: [(Position, i64); 2],
    /// The current hole in the plane.
    pub hole: [Position; 2],
    pub r: Position,
    pub bottom: Position,
    /// Position of the tool after the hole.
    pub clear: Position,
    /// Depth of a peck, and its rounding remainder.
    pub peck: (Position, i64),
    /// Rounding remainder of the pecks of this hole.
    pub rest: i32,
    pub back: Position,
    pub dwell: Position,
    pub acts: Acts,
    /// Number of remaining holes.
    pub left: u32,
    /// Current depth.
    pub depth: Position,
    pub stage: Stage,
}

/// The next step of a cycle.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Up to R, before the first hole.
    Lift,
    /// Move over the hole.
    Over,
    /// Rapid motion down to R.
    Down,
    Feed,
    /// Out to R between pecks.
    Back,
    /// Down again, close to the last depth.
    Again,
    /// Retract a short distance, to break the chip.
    Break,
    Bottom,
    Out,
    /// Actions of the spindle outside the hole.
    Outside,
    /// From R to the end position of the hole.
    Clear,
    End,
}

impl<const AXES: usize> Holes<AXES> {
    fn next(&mut self, at: &[Position; AXES], rests: &mut [i32; AXES]) -> Option<Part<AXES>> {
        loop {
            let mut target = *at;
            let rapid = match self.stage {
                Stage::End if self.left == 0 => return None,
                Stage::End | Stage::Over => {
                    self.over(&mut target, rests);
                    self.stage = Stage::Down;
                    true
                }
                Stage::Bottom | Stage::Outside => {
                    if let Some(part) = self.do_act() {
                        return Some(part);
                    }
                    continue;
                }
                _ => {
                    let (level, rapid) = self.level();
                    let [.., axis] = self.axes;
                    if let Some(slot) = target.get_mut(axis) {
                        *slot = level;
                    }
                    rapid
                }
            };
            if target != *at {
                return Some(Part::Motion(if rapid { MotionKind::Rapid } else { MotionKind::Line }, target));
            }
        }
    }

    /// The next action at standstill, at the bottom or outside the hole. Returns `None` if there is no
    /// further action.
    fn do_act(&mut self) -> Option<Part<AXES>> {
        let dwell = || Some(Part::Dwell(self.dwell));
        let back = if self.acts.turn == 3 { 4 } else { 3 };
        let act = self.acts.done;
        self.acts.done += 1;
        let part = match (self.stage, self.kind, act) {
            (Stage::Bottom, kind, 0) if kind.taps() => Some(Part::M(5)),
            (Stage::Bottom, kind, 1) if kind.taps() => Some(Part::M(back)),
            (Stage::Bottom, kind, 2) if kind.taps() && self.dwell > Position::ZERO => dwell(),
            (Stage::Bottom, CycleKind::BoreStop, 0) if self.dwell > Position::ZERO => dwell(),
            (Stage::Bottom, CycleKind::BoreStop, 0) => {
                self.acts.done = 2;
                Some(Part::M(5))
            }
            (Stage::Bottom, CycleKind::BoreStop, 1) => Some(Part::M(5)),
            (Stage::Bottom, CycleKind::Dwell | CycleKind::BoreDwell, 0) => dwell(),
            (Stage::Bottom, kind, 0) if kind.pecks() && self.dwell > Position::ZERO => dwell(),
            (Stage::Outside, kind, 0) if kind.taps() => Some(Part::M(5)),
            (Stage::Outside, kind, 1) if kind.taps() => Some(Part::M(self.acts.turn)),
            (Stage::Outside, CycleKind::BoreStop, 0) => Some(Part::M(self.acts.turn)),
            _ => None,
        };
        if part.is_none() {
            self.acts.done = 0;
            self.stage = if self.stage == Stage::Bottom { Stage::Out } else { Stage::Clear };
        }
        part
    }

    /// Begins the next hole.
    fn over(&mut self, target: &mut [Position; AXES], rests: &mut [i32; AXES]) {
        self.left = self.left.saturating_sub(1);
        for ((hole, (step, left)), axis) in self.hole.iter_mut().zip(self.step).zip(self.axes) {
            if let (Some(rest), Some(slot)) = (rests.get_mut(axis), target.get_mut(axis)) {
                *hole = hole.saturating_add(step).saturating_add(carry(rest, left));
                *slot = *hole;
            }
        }
    }

    /// The next level along the axis of the hole, and whether the motion there is rapid.
    fn level(&mut self) -> (Position, bool) {
        let stage = self.stage;
        let (level, rapid, next) = match stage {
            Stage::Lift => (self.r, true, Stage::Over),
            Stage::Down => {
                (self.depth, self.rest) = (self.r, 0);
                (self.r, true, Stage::Feed)
            }
            Stage::Feed => {
                let (peck, left) = self.peck;
                let peck = peck.saturating_add(carry(&mut self.rest, left));
                let depth = self.depth.saturating_sub(peck);
                let depth = if depth <= self.bottom.saturating_add(NEAR) { self.bottom } else { depth };
                self.depth = if self.kind.pecks() { depth } else { self.bottom };
                let next = match self.kind {
                    _ if self.depth <= self.bottom => Stage::Bottom,
                    CycleKind::Break => Stage::Break,
                    _ => Stage::Back,
                };
                (self.depth, false, next)
            }
            Stage::Back => (self.r, true, Stage::Again),
            Stage::Again | Stage::Break => {
                (self.depth.saturating_add(self.back).min(self.r), true, Stage::Feed)
            }
            Stage::Out => match self.kind {
                CycleKind::Bore => (self.r, false, Stage::Clear),
                CycleKind::BoreDwell => (self.clear, false, Stage::End),
                CycleKind::BoreStop => (self.clear, true, Stage::Outside),
                kind if kind.taps() => {
                    (if self.acts.to_level { self.r } else { self.clear }, false, Stage::Outside)
                }
                _ => (self.clear, true, Stage::End),
            },
            _ => (self.clear, true, Stage::End),
        };
        self.stage = next;
        (level, rapid)
    }
}
