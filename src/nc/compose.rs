//! Makes commands from the words of a block: offsets, dwell, weights of the dynamics, and the motion. Also
//! converts inches to millimetres (G70, G20).
use super::block::{Given, Item, ItemKind, Use, Words, put_before, weight};
use super::flow::Ending;
use super::interpreter::{Gathered, Interpreter, Next};
use super::line::Line;
use super::modal::{COORDINATE_MAX, Mode};
use super::number::Factor;
use super::{ArcBy, DwellTime, Fault, Motion, MotionKind, NcErrorKind, NcWarningKind, Span};
use crate::machine::AxisKind;
use crate::quantity::{Feed, Position};
use core::cell::Cell;

impl<const AXES: usize> Interpreter<AXES> {
    /// Appends the commands of a block to the queue of the decoder. The order is: G words with a command of
    /// their own, weights, S and T; then motion or dwell; then M and H functions.
    #[inline(never)]
    pub fn finish(&mut self, w: &mut Words<AXES>, line: &Line) -> Result<Next, Fault> {
        if let Some(given) = w.spindle.take() {
            if w.consumer == Use::Dwell {
                let turns = self.time(given, "dwell", "revolutions")?;
                put_before(
                    &mut self.queue,
                    &mut w.before,
                    w.consumer_span,
                    ItemKind::Dwell(DwellTime::Revolutions(turns)),
                )?;
            } else {
                let Some(speed) = given.number.fixed(Factor::ONE).filter(|s| *s >= Position::ZERO) else {
                    return given.span.fault(NcErrorKind::Range {
                        what: "S",
                        min: 0,
                        max: 2_147_483_647,
                        unit: "1/min",
                        above: false,
                    });
                };
                put_before(&mut self.queue, &mut w.before, given.span, ItemKind::Spindle(speed))?;
                let (items, _) = self.queue.as_mut_slices();
                move_into_order(items.get_mut(..usize::from(w.before)).unwrap_or_default());
            }
        }
        if let Some(given) = w.radius {
            let radius = given.number.fixed(self.length_factor());
            let radius = radius.filter(|r| *r != Position::ZERO && in_range(*r));
            let Some(radius) = radius else {
                let is_zero = given.number.fixed(self.length_factor()) == Some(Position::ZERO);
                let zero = NcErrorKind::Expected("a radius that is not 0");
                return given.span.fault(if is_zero { zero } else { coordinate("R", "mm") });
            };
            self.modal.radius = Some(radius);
            if w.consumer != Use::Motion
                || !matches!(self.modal.mode, Mode::Clockwise | Mode::Counterclockwise)
            {
                self.warn(line, given.span, NcWarningKind::RadiusAlone);
            }
        }
        match w.consumer {
            Use::Motion => self.motion_of(w, line)?,
            Use::Dwell => self.dwell_of(w, line)?,
            Use::Shift => self.shift_of(w)?,
            Use::Weight(_) => self.weights_of(w)?,
        }
        if w.consumer != Use::Motion
            && let Some(given) = w.centre.iter().flatten().next()
        {
            return given.span.fault(NcErrorKind::ArcWordAlone);
        }
        if let (Some(span), false) = (w.exact_stop, self.moves) {
            return span.fault(NcErrorKind::ExactStopAlone);
        }
        let Some(ending) = w.ends else { return Ok(Next::Line) };
        if ending == Ending::Subroutine && self.flow.frames.is_empty() {
            self.warn(line, w.end_span, NcWarningKind::MainEnds);
        }
        if ending == Ending::Program && !self.flow.frames.is_empty() {
            let span = self.queue.iter().rev().find(|i| matches!(i.kind, ItemKind::ProgramEnd(_)));
            self.warn(line, span.map_or(Span::default(), |i| i.span), NcWarningKind::EndInSubroutine);
        }
        Ok(self.end_by_word(ending))
    }

    /// The length unit in force: inch or millimetre.
    pub fn length_factor(&self) -> Factor {
        if self.modal.inch { Factor::INCH } else { Factor::ONE }
    }

    /// Unit of an axis; inch applies only to linear axes.
    pub fn axis_factor(&self, axis: usize) -> Factor {
        match self.setup.kinds.get(axis) {
            Some(AxisKind::Linear) => self.length_factor(),
            _ => Factor::ONE,
        }
    }

    /// Sum of the zero offset and the G92 offset of an axis.
    pub fn offset(&self, axis: usize) -> Position {
        let set = self.modal.zero_set.and_then(|set| self.setup.zero_offsets.get(set));
        let zero = set.and_then(|set| set.get(axis)).copied().unwrap_or(Position::ZERO);
        #[cfg(feature = "grbl")]
        let zero = zero.wrapping_add(self.more_offset(axis));
        // Two coordinates cannot overflow.
        zero.wrapping_add(self.modal.shift.get(axis).copied().unwrap_or(Position::ZERO))
    }

    /// The value of an axis word in the axis' unit.
    pub fn axis_value(&self, axis: usize, given: Given) -> Result<Position, Fault> {
        let value = given.number.fixed(self.axis_factor(axis)).filter(|v| in_range(*v));
        value.ok_or(Fault { span: given.span, kind: self.coordinate_of(axis) })
    }

    pub fn coordinate_of(&self, axis: usize) -> NcErrorKind {
        let linear = self.setup.kinds.get(axis) == Some(&AxisKind::Linear);
        coordinate("coordinate", if linear { "mm" } else { "deg" })
    }

    /// Reads G04.
    fn dwell_of(&mut self, w: &mut Words<AXES>, line: &Line) -> Result<(), Fault> {
        let mut time = w.time.map(|given| (given, None));
        for (axis, given) in w.axes.iter().enumerate() {
            let Some(given) = *given else { continue };
            match time {
                None => time = Some((given, Some(axis))),
                Some((_, None)) => return given.span.fault(NcErrorKind::Twice("time of G04")),
                Some((first, Some(_))) => {
                    let extra = if first.span.at < given.span.at { given } else { first };
                    if first.span.at > given.span.at {
                        time = Some((given, Some(axis)));
                    }
                    self.warn(line, extra.span, NcWarningKind::DwellExtraAxis);
                }
            }
        }
        let dwell = self.queue.iter().any(|item| matches!(item.kind, ItemKind::Dwell(_)));
        match time {
            Some((given, _)) if !dwell => {
                let seconds = self.time(given, "time of G04", "s")?;
                put_before(
                    &mut self.queue,
                    &mut w.before,
                    w.consumer_span,
                    ItemKind::Dwell(DwellTime::Seconds(seconds)),
                )
            }
            Some((given, _)) => given.span.fault(NcErrorKind::Twice("time of G04")),
            None if dwell => Ok(()),
            None => w.consumer_span.fault(NcErrorKind::Missing("a time in seconds")),
        }
    }

    fn time(&self, given: Given, what: &'static str, unit: &'static str) -> Result<Position, Fault> {
        let value = given.number.fixed(Factor::ONE).filter(|t| *t >= Position::ZERO && in_range(*t));
        let max = COORDINATE_MAX.unsigned_abs();
        let kind = NcErrorKind::Range { what, min: 0, max, unit, above: false };
        value.ok_or(Fault { span: given.span, kind })
    }

    /// Carries out G92: sets the additional offset of the named axes (absolute with G90, added with G91). No
    /// axis moves.
    fn shift_of(&mut self, w: &Words<AXES>) -> Result<(), Fault> {
        if w.first.is_none() {
            return w.consumer_span.fault(NcErrorKind::Missing("axis offsets"));
        }
        for (axis, given) in w.axes.iter().enumerate() {
            let Some(given) = *given else { continue };
            let value = self.axis_value(axis, given)?;
            let kind = self.coordinate_of(axis);
            let relative = self.modal.relative;
            if let Some(shift) = self.modal.shift.get_mut(axis) {
                *shift = if relative { shift.saturating_add(value) } else { value };
                if !in_range(*shift) {
                    return given.span.fault(kind);
                }
            }
        }
        Ok(())
    }

    /// Carries out G130, G132 and G232.
    fn weights_of(&mut self, w: &Words<AXES>) -> Result<(), Fault> {
        if w.first.is_none() {
            return w.consumer_span.fault(NcErrorKind::Missing("axis weights in percent"));
        }
        for (slot, given) in self.values.iter_mut().zip(&w.axes) {
            *slot = match given {
                Some(given) => Some(weight(*given)?),
                None => None,
            };
        }
        Ok(())
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Makes the motion of G00…G03 from the axis words of the block.
    pub fn motion_of(&mut self, w: &mut Words<AXES>, line: &Line) -> Result<(), Fault> {
        let mode = self.modal.mode;
        let arc = matches!(mode, Mode::Clockwise | Mode::Counterclockwise);
        let centre = w.centre.iter().flatten().next().copied();
        if let (Some(given), false) = (centre, arc) {
            return given.span.fault(NcErrorKind::ArcWordAlone);
        }
        let Some(first) = w.first else { return Ok(()) };
        let span = w.mode_span.filter(|mode| mode.at < first.at).unwrap_or(first);
        let (mut target, mut named) = (self.position, 0);
        for (axis, given) in w.axes.iter().enumerate() {
            let Some(given) = *given else { continue };
            named |= 1_u32.wrapping_shl(axis as u32);
            let value = self.axis_value(axis, given)?;
            let offset = self.offset(axis);
            let kind = self.coordinate_of(axis);
            let relative = self.modal.relative;
            let left = if relative { given.number.rest(self.axis_factor(axis), value) } else { 0 };
            if let (Some(slot), Some(rest)) = (target.get_mut(axis), self.rests.get_mut(axis)) {
                *slot = if relative {
                    slot.saturating_add(value).saturating_add(carry(rest, left))
                } else {
                    *rest = 0;
                    value.saturating_add(offset)
                };
                if !in_range(*slot) {
                    return given.span.fault(kind);
                }
            }
        }
        let still = !arc && target == self.position;
        let needs_feed = self.modal.feed.is_none() && !still;
        let kind = match mode {
            Mode::Rapid => MotionKind::Rapid,
            Mode::Unprogrammed | Mode::UnprogrammedTold if needs_feed => {
                if mode == Mode::Unprogrammed {
                    self.warn(line, span, NcWarningKind::RapidWithoutFeed);
                    self.modal.mode = Mode::UnprogrammedTold;
                }
                MotionKind::Rapid
            }
            Mode::Line | Mode::Unprogrammed | Mode::UnprogrammedTold => MotionKind::Line,
            Mode::Clockwise | Mode::Counterclockwise => MotionKind::Arc {
                plane: self.modal.plane,
                clockwise: mode == Mode::Clockwise,
                by: self.arc(w, &target, span)?,
            },
        };
        if kind != MotionKind::Rapid && needs_feed {
            return span.fault(NcErrorKind::NoFeed);
        }
        let place = line.place(span);
        let centre = if arc { w.centre_span().map(|span| line.place(span)) } else { None };
        self.gathered = Gathered::Motion(Cell::new(Motion {
            n: self.n,
            place,
            centre: centre.unwrap_or(place),
            kind,
            target,
            feed: self.modal.feed.unwrap_or(Feed::ZERO),
            exact_stop: self.modal.exact_stop || w.exact_stop.is_some(),
            named,
        }));
        self.moves = true;
        self.position = target;
        put_before(&mut self.queue, &mut w.before, span, ItemKind::Motion)
    }

    /// Centre or radius of an arc to `target`. A coordinate of the centre that is not programmed is that of
    /// the start.
    fn arc(&self, w: &Words<AXES>, target: &[Position; AXES], span: Span) -> Result<ArcBy, Fault> {
        let plane = self.modal.plane.main_axes();
        let mut axes = [0; 2];
        for (slot, main) in axes.iter_mut().zip(plane) {
            match self.setup.main.get(main).copied().flatten() {
                Some(axis) => *slot = axis,
                None => return span.fault(NcErrorKind::NoMainAxis),
            }
        }
        let of = |positions: &[Position; AXES], axis: usize| {
            positions.get(axis).copied().unwrap_or(Position::ZERO)
        };
        for (i, given) in w.centre.iter().enumerate() {
            if let (Some(given), false) = (given, plane.contains(&i)) {
                return given.span.fault(NcErrorKind::OutsidePlane);
            }
        }
        if let Some(given) = w.centre.iter().flatten().next() {
            if w.radius.is_some() {
                return given.span.fault(NcErrorKind::ArcTwice);
            }
            let mut centre = [Position::ZERO; 2];
            for ((slot, main), axis) in centre.iter_mut().zip(plane).zip(axes) {
                let start = of(&self.position, axis);
                *slot = match w.centre.get(main).copied().flatten() {
                    None => start,
                    Some(given) => {
                        let value = self.axis_value(axis, given)?;
                        let base = if self.modal.centre_absolute { self.offset(axis) } else { start };
                        value.saturating_add(base)
                    }
                };
            }
            return Ok(ArcBy::Centre(centre));
        }
        let Some(radius) = self.modal.radius else { return span.fault(NcErrorKind::ArcUndefined) };
        if axes.iter().all(|axis| of(target, *axis) == of(&self.position, *axis)) {
            return span.fault(NcErrorKind::FullCircleByRadius);
        }
        Ok(ArcBy::Radius(radius))
    }
}

/// Moves the last item to its place in the order of the text.
fn move_into_order(items: &mut [Item]) {
    let Some(mut last) = items.last().copied() else { return };
    for item in items.iter_mut() {
        if item.span.at > last.span.at {
            core::mem::swap(item, &mut last);
        }
    }
    if let Some(slot) = items.last_mut() {
        *slot = last;
    }
}

/// Adds the rounding remainder `left` to the remainders so far, and returns whole LSBs.
pub(super) fn carry(rest: &mut i32, left: i64) -> Position {
    let sum = i64::from(*rest).wrapping_add(left);
    let whole = sum.wrapping_add(1 << 31) >> 32;
    *rest = sum.wrapping_sub(whole << 32) as i32;
    Position::from_bits(whole)
}

/// Whether the value is inside ±[`COORDINATE_MAX`].
pub(super) fn in_range(value: Position) -> bool {
    const MAX: u64 = (COORDINATE_MAX as u64) << 32;
    value.to_bits().unsigned_abs() <= MAX
}

fn coordinate(what: &'static str, unit: &'static str) -> NcErrorKind {
    NcErrorKind::Range { what, min: -COORDINATE_MAX, max: COORDINATE_MAX.unsigned_abs(), unit, above: false }
}
