//! Canned drilling cycles (G73, G74, G81 to G89): reads their words, and begins the holes. `course.rs`
//! returns the motions one by one.
use super::Cycle;
use super::block::Block;
use super::course::{Acts, Course, CycleKind, Holes, Stage};
use crate::nc::block::Given;
use crate::nc::compose::in_range;
use crate::nc::interpreter::Interpreter;
use crate::nc::number::Factor;
use crate::nc::{Fault, NcErrorKind, Span};
use crate::quantity::Position;

/// Distance above the last depth where drilling of a deep hole continues, and retract distance of a chip
/// break: 0.01 inch.
const BACK: Position = Position::from_bits(0x4106_24dd);

/// Largest number of holes by L.
const REPEATS: u32 = 10_000;

impl<const AXES: usize> Interpreter<AXES> {
    /// Carries out a block with axis words while a cycle is active: begins its holes.
    pub(super) fn drill(
        &mut self,
        kind: CycleKind,
        block: &mut Block<AXES>,
        span: Span,
    ) -> Result<Course<AXES>, Fault> {
        let axes = self.axes_of_plane(span)?;
        let [.., axis] = axes;
        let here = self.position.get(axis).copied().unwrap_or_default();
        let known = self.foreign.now.cycle.filter(|cycle| cycle.kind == kind);
        let from = self.foreign.now.cycle.map_or(here, |cycle| cycle.from);
        let cycle = self.cycle_of(kind, block, (known, from, axis), span)?;
        let fanuc = self.setup.foreign.dialect().is_fanuc();
        let by_k = if fanuc { block.take(b'K') } else { None };
        let repeats = match by_k.or_else(|| block.take(b'L')) {
            Some(given) => {
                let count = self.whole(given, "L", REPEATS)?;
                if count == 0 && !fanuc {
                    return given.span.fault(NcErrorKind::Expected("L of 1 and more"));
                }
                count
            }
            None => 1,
        };
        let relative = self.modal.relative;
        let base = if relative { from } else { self.offset(axis) };
        let r = cycle.r.saturating_add(base);
        let bottom = cycle.bottom.saturating_add(if relative { r } else { base });
        if r < bottom {
            return span.fault(NcErrorKind::Expected("R above the bottom of the hole"));
        }
        if !in_range(r) || !in_range(bottom) {
            return span.fault(self.coordinate_of(axis));
        }
        if self.modal.feed.is_none() {
            return span.fault(NcErrorKind::NoFeed);
        }
        self.needs_turning(span)?;
        let turn = self.turn_of(kind, span)?;
        if repeats == 0 {
            // Fanuc stores the words but does not drill.
            self.foreign.now.cycle = Some(cycle);
            return Ok(Course::None);
        }
        let (hole, step) = self.first_hole(block, axes, repeats)?;
        let clear = match (self.foreign.now.to_level, fanuc) {
            (true, _) => r,
            (false, true) => from,
            (false, false) => from.max(r),
        };
        self.foreign.now.cycle = Some(cycle);
        if let Some(rest) = self.rests.get_mut(axis) {
            *rest = 0;
        }
        Ok(Course::Holes(Holes {
            kind,
            axes,
            step,
            hole,
            r,
            bottom,
            clear,
            peck: cycle.peck,
            rest: 0,
            back: if kind == CycleKind::Break { cycle.back } else { BACK },
            dwell: cycle.dwell,
            left: repeats,
            depth: r,
            acts: Acts { turn, to_level: fanuc, done: 0 },
            stage: if from < r && !fanuc { Stage::Lift } else { Stage::Over },
        }))
    }

    /// Direction of the spindle after the hole.
    fn turn_of(&self, kind: CycleKind, span: Span) -> Result<u16, Fault> {
        let spindle = self.foreign.now.spindle;
        let fanuc = self.setup.foreign.dialect().is_fanuc();
        match kind {
            CycleKind::Tap | CycleKind::TapLeft => {
                let (wanted, missing) = match kind {
                    CycleKind::Tap => (3, "M3 before tapping"),
                    _ => (4, "M4 before left-hand tapping"),
                };
                // On Fanuc, the cycle starts the spindle itself.
                if spindle != wanted && !fanuc {
                    return span.fault(NcErrorKind::Missing(missing));
                }
                Ok(wanted)
            }
            CycleKind::BoreStop if spindle == 0 => span.fault(NcErrorKind::Missing("M3 or M4 before G86")),
            _ => Ok(spindle),
        }
    }

    /// Axes of the active plane, and the axis across the plane.
    pub(super) fn axes_of_plane(&self, span: Span) -> Result<[usize; 3], Fault> {
        let [first, second] = self.modal.plane.main_axes();
        let places = [first, second, 3 - first - second];
        let mut axes = [0; 3];
        for (slot, place) in axes.iter_mut().zip(places) {
            match self.setup.main.get(place).copied().flatten() {
                Some(axis) => *slot = axis,
                None => return span.fault(NcErrorKind::NoMainAxis),
            }
        }
        Ok(axes)
    }

    /// Reads the words of a cycle. A missing word keeps its value from the block before.
    fn cycle_of(
        &self,
        kind: CycleKind,
        block: &mut Block<AXES>,
        (known, from, axis): (Option<Cycle>, Position, usize),
        span: Span,
    ) -> Result<Cycle, Fault> {
        let missing = |what| Fault { span, kind: NcErrorKind::Missing(what) };
        let level = |given: Given| self.axis_value(axis, given);
        let r = block.take(b'R').map(level).transpose()?.or(known.map(|cycle| cycle.r));
        let bottom = block.axes.get(axis).copied().flatten().map(level).transpose()?;
        let mut cycle = Cycle {
            kind,
            r: r.ok_or(missing("R, the level above the hole"))?,
            bottom: bottom.or(known.map(|cycle| cycle.bottom)).ok_or(missing("the bottom of the hole"))?,
            peck: (Position::ZERO, 0),
            back: known.map_or(BACK, |cycle| cycle.back),
            dwell: Position::ZERO,
            from,
        };
        if kind.pecks() {
            let peck = match block.take(b'Q') {
                Some(given) => {
                    let peck = self.above_zero(given, axis, "Q")?;
                    Some((peck, given.number.rest(self.axis_factor(axis), peck)))
                }
                None => known.map(|cycle| cycle.peck),
            };
            cycle.peck = peck.ok_or(missing("Q, the depth of a peck"))?;
        }
        if kind == CycleKind::Break
            && let Some(given) = block.take(b'D')
        {
            cycle.back = self.above_zero(given, axis, "D")?;
        }
        let fanuc = self.setup.foreign.dialect().is_fanuc();
        if kind.dwells() || fanuc && kind.pecks() {
            let is_ms = block.is_pointless(b'P');
            let dwell = block.take(b'P').map(|given| self.seconds(given, is_ms)).transpose()?;
            let least = if kind.needs_dwell() { None } else { Some(Position::ZERO) };
            let dwell = dwell.or(known.map(|cycle| cycle.dwell)).or(least);
            cycle.dwell = dwell.ok_or(missing("P, seconds"))?;
        }
        Ok(cycle)
    }

    fn above_zero(&self, given: Given, axis: usize, what: &'static str) -> Result<Position, Fault> {
        let value =
            given.number.fixed(self.axis_factor(axis)).filter(|v| *v > Position::ZERO && in_range(*v));
        let kind = NcErrorKind::Range { what, min: 0, max: 100_000, unit: "mm", above: true };
        value.ok_or(Fault { span: given.span, kind })
    }

    /// P in seconds. `is_ms`: the programmed value is in milliseconds.
    pub(super) fn seconds(&self, given: Given, is_ms: bool) -> Result<Position, Fault> {
        let factor = if is_ms { Factor::new(1, 1000) } else { Factor::ONE };
        let value = given.number.fixed(factor).filter(|v| *v >= Position::ZERO && in_range(*v));
        let kind = NcErrorKind::Range { what: "P", min: 0, max: 100_000, unit: "s", above: false };
        value.ok_or(Fault { span: given.span, kind })
    }

    /// Start position for the first hole, and the step from hole to hole.
    #[expect(clippy::type_complexity, reason = "two pairs that the caller takes apart at once")]
    fn first_hole(
        &mut self,
        block: &Block<AXES>,
        axes: [usize; 3],
        repeats: u32,
    ) -> Result<([Position; 2], [(Position, i64); 2]), Fault> {
        let (mut hole, mut step) = ([Position::ZERO; 2], [(Position::ZERO, 0); 2]);
        for (axis, given) in block.axes.iter().enumerate() {
            if let (Some(given), false) = (given, axes.contains(&axis)) {
                return given.span.fault(NcErrorKind::Conflict("a cycle, which moves the main axes alone"));
            }
        }
        for ((hole, step), axis) in hole.iter_mut().zip(&mut step).zip(axes) {
            *hole = self.position.get(axis).copied().unwrap_or_default();
            let Some(given) = block.axes.get(axis).copied().flatten() else { continue };
            let value = self.axis_value(axis, given)?;
            let last = if self.modal.relative {
                *step = (value, given.number.rest(self.axis_factor(axis), value));
                let way = i128::from(value.to_bits()) * i128::from(repeats) + i128::from(hole.to_bits());
                Position::from_bits(way.clamp(i128::from(i64::MIN), i128::from(i64::MAX)) as i64)
            } else {
                *hole = value.saturating_add(self.offset(axis));
                if let Some(rest) = self.rests.get_mut(axis) {
                    *rest = 0;
                }
                *hole
            };
            if !in_range(last) {
                return given.span.fault(self.coordinate_of(axis));
            }
        }
        Ok((hole, step))
    }
}
