//! The words of a block: addresses, modal state, and the motion they make together.
use super::cursor::Cursor;
use super::expression::{expression, parameter_target};
use super::interpreter::{Interpreter, Next, Phase};
use super::line::Line;
use super::number::{Factor, Number};
use super::{
    ArcBy, DwellTime, Fault, Motion, MotionKind, NcErrorKind, NcWarningKind, Plane, Span, WeightKind,
};
use crate::machine::AxisKind;
use crate::quantity::{Feed, Position};
use heapless::Vec;

/// Largest coordinate, mm or degrees.
pub const COORDINATE_MAX: i32 = 100_000;

/// G00…G03.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    Rapid,
    Line,
    Clockwise,
    Counterclockwise,
}

/// What stays in force from block to block.
pub(super) struct Modal<const AXES: usize> {
    pub mode: Mode,
    pub plane: Plane,
    pub relative: bool,
    pub centre_absolute: bool,
    pub inch: bool,
    pub feed: Option<Feed>,
    pub exact_stop: bool,
    /// 0…5 for G54…G59, `None` for G53.
    pub zero_set: Option<usize>,
    /// G92.
    pub shift: [Position; AXES],
    pub radius: Option<Position>,
}

impl<const AXES: usize> Modal<AXES> {
    /// At program start: G01, G17, G53, G71, G90, G94, G162, G260, G150, G359.
    pub const fn new() -> Self {
        Self {
            mode: Mode::Line,
            plane: Plane::G17,
            relative: false,
            centre_absolute: false,
            inch: false,
            feed: None,
            exact_stop: false,
            zero_set: None,
            shift: [Position::ZERO; AXES],
            radius: None,
        }
    }
}

/// One thing a block makes the decoder hand out.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub span: Span,
    pub kind: ItemKind,
}

/// What it is; larger values wait in the interpreter.
#[derive(Clone, Copy)]
pub(super) enum ItemKind {
    /// G word with a typed command of its own.
    Switch(u16),
    /// G131, G133, G134, G231, G233, G338, G339.
    WeightAll(WeightKind, Position),
    /// G130, G132, G232 with the interpreter's values.
    WeightAxes(WeightKind),
    EndFeed,
    Spindle(Position),
    Tool(u32),
    ToolOffset(u32),
    Dwell(DwellTime),
    Motion,
    M(u16),
    H(u16),
    ProgramEnd(u16),
}

/// An address and its value.
#[derive(Clone, Copy)]
struct Given {
    number: Number,
    span: Span,
}

/// What uses the axis words of a block.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    Motion,
    Dwell,
    Shift,
    Weight(WeightKind),
}

/// The words of one block.
struct Words<const AXES: usize> {
    axes: [Option<Given>; AXES],
    /// Axes in the order of the text.
    first: Option<Span>,
    centre: [Option<Given>; 3],
    radius: Option<Given>,
    spindle: Option<Given>,
    time: Option<Given>,
    consumer: Use,
    consumer_span: Span,
    mode_span: Option<Span>,
    exact_stop: Option<Span>,
    /// Groups of G words seen, one bit each.
    groups: u16,
    before: Vec<Item, { super::BLOCK_WORDS }>,
    after: Vec<Item, { super::BLOCK_WORDS }>,
    ends: Option<Ending>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Ending {
    Subroutine,
    Program,
}

/// Groups of G words of which a block holds one.
mod group {
    pub const MODE: u16 = 1;
    pub const PLANE: u16 = 2;
    pub const DIMENSION: u16 = 4;
    pub const UNIT: u16 = 8;
    pub const ZERO: u16 = 16;
    pub const CENTRE: u16 = 32;
    pub const EXACT: u16 = 64;
    pub const CONTOUR: u16 = 128;
    pub const SPLINE: u16 = 256;
    pub const FEED: u16 = 512;
    pub const CONSUMER: u16 = 1024;
}

/// G words of the language without a function here (ISG's list), sorted.
const OTHER_G: [u16; 76] = [
    5, 8, 9, 10, 11, 12, 13, 20, 21, 22, 23, 25, 26, 33, 40, 41, 42, 51, 52, 63, 66, 68, 69, 74, 80, 81, 82,
    83, 84, 85, 86, 87, 88, 89, 96, 97, 98, 99, 100, 101, 102, 106, 107, 108, 112, 115, 116, 117, 135, 136,
    137, 138, 139, 140, 141, 159, 163, 164, 165, 166, 167, 193, 196, 200, 201, 202, 236, 237, 238, 239, 293,
    301, 302, 303, 900, 901,
];

impl<const AXES: usize> Interpreter<AXES> {
    /// A block of words.
    pub fn words(&mut self, c: &mut Cursor<'_>, line: &Line) -> Result<Next, Fault> {
        let mut w = Words {
            axes: [None; AXES],
            first: None,
            centre: [None; 3],
            radius: None,
            spindle: None,
            time: None,
            consumer: Use::Motion,
            consumer_span: Span::default(),
            mode_span: None,
            exact_stop: None,
            groups: 0,
            before: Vec::new(),
            after: Vec::new(),
            ends: None,
        };
        while !c.at_end() {
            if let Some(single) = self.word(c, line, &mut w)? {
                if w.first.is_some() || !w.before.is_empty() || !w.after.is_empty() {
                    return single.fault(NcErrorKind::NotAlone("an axis command"));
                }
                c.require_end("an axis command")?;
                return Ok(Next::Line);
            }
        }
        self.finish(w, line)
    }

    /// Reads one word. An axis bracket command puts itself into `single`; its span comes back.
    fn word(&mut self, c: &mut Cursor<'_>, line: &Line, w: &mut Words<AXES>) -> Result<Option<Span>, Fault> {
        let mark = c.mark();
        if let Some(axis) = self.axis_here(c) {
            if let Some(command) = self.axis_command(c, line, axis, mark)? {
                self.single = Some(command);
                return Ok(Some(c.since(mark)));
            }
            let given = self.value(c, mark)?;
            w.first.get_or_insert(given.span);
            put(w.axes.get_mut(axis), given, "an axis")?;
            return Ok(None);
        }
        let letter = c.peek_upper();
        if !letter.is_ascii_alphabetic() {
            return c.expected("an address such as G, X, F or M");
        }
        if letter != b'P' {
            c.bump();
        }
        match letter {
            b'G' => self.g_word(c, w, mark)?,
            b'P' => {
                let target = parameter_target(c, &self.parameters)?;
                c.require(b'=', "= behind the parameter")?;
                let value = expression(c, &self.parameters)?.real();
                self.parameters.set(target, value).map_err(|kind| Fault { span: c.since(mark), kind })?;
            }
            b'F' => {
                let given = self.value(c, mark)?;
                self.modal.feed = Some(self.feed(given)?);
            }
            b'E' => {
                let given = self.value(c, mark)?;
                push(&mut w.before, given.span, ItemKind::EndFeed)?;
            }
            b'I' | b'J' | b'K' => {
                let given = self.value(c, mark)?;
                put(w.centre.get_mut(usize::from(letter - b'I')), given, "the centre")?;
                w.first.get_or_insert(given.span);
            }
            b'R' => {
                let given = self.value(c, mark)?;
                put(Some(&mut w.radius), given, "the radius")?;
            }
            b'S' => {
                let given = self.value(c, mark)?;
                put(Some(&mut w.spindle), given, "S")?;
            }
            b'M' => {
                let (code, span) = self.code(c, mark, "M", 999)?;
                self.m_word(w, code, span)?;
            }
            b'H' => {
                let (code, span) = self.code(c, mark, "H", 999)?;
                push(&mut w.after, span, ItemKind::H(code as u16))?;
            }
            b'T' => {
                let (code, span) = self.code(c, mark, "T", 999_999_999)?;
                push(&mut w.before, span, ItemKind::Tool(code))?;
            }
            b'D' => {
                let (code, span) = self.code(c, mark, "D", 999)?;
                push(&mut w.before, span, ItemKind::ToolOffset(code))?;
            }
            b'V' if c.raw() == b'.' => {
                c.back_to(mark);
                return c.rest_of_word().fault(NcErrorKind::NotAvailable("variable"));
            }
            b'N' => {
                let _ = c.rest_of_word();
                c.back_to(mark);
                return c.here().fault(NcErrorKind::Expected("N first in its block"));
            }
            b'L' => {
                c.back_to(mark);
                return c.here().fault(NcErrorKind::NotAlone("a call"));
            }
            b'A' | b'B' | b'C' | b'U' | b'V' | b'W' | b'X' | b'Y' | b'Z' | b'Q' => {
                return c.since(mark).fault(NcErrorKind::AxisNotHere);
            }
            _ => {
                c.back_to(mark);
                return c.here().fault(NcErrorKind::UnknownWord);
            }
        }
        Ok(None)
    }

    /// The axis whose name stands here; names of more than one letter need `=` or `[` behind them.
    pub fn axis_here(&self, c: &mut Cursor<'_>) -> Option<usize> {
        let mark = c.mark();
        let mut single = None;
        for (i, name) in self.setup.names.iter().enumerate() {
            let name = name.as_str();
            c.back_to(mark);
            if name.len() == 1 && c.peek_upper() == name.as_bytes().first().copied().unwrap_or(0) {
                single = Some(i);
            } else if name.len() > 1 && c.eat_words(name) && matches!(c.peek(), b'=' | b'[') {
                return Some(i);
            }
        }
        c.back_to(mark);
        if single.is_some() {
            c.bump();
        }
        single
    }

    /// The value behind an address, with or without `=`.
    fn value(&self, c: &mut Cursor<'_>, mark: usize) -> Result<Given, Fault> {
        c.eat(b'=');
        let number = expression(c, &self.parameters)?;
        Ok(Given { number, span: c.since(mark) })
    }

    /// A whole number behind an address.
    fn code(
        &self,
        c: &mut Cursor<'_>,
        mark: usize,
        what: &'static str,
        max: u32,
    ) -> Result<(u32, Span), Fault> {
        let given = self.value(c, mark)?;
        let Some(value) = given.number.whole() else { return given.span.fault(NcErrorKind::NotWhole(what)) };
        match u32::try_from(value) {
            Ok(value) if value <= max => Ok((value, given.span)),
            _ => given.span.fault(NcErrorKind::Range {
                what,
                min: 0,
                max: i64::from(max),
                unit: "",
                above: false,
            }),
        }
    }

    /// F in mm/min (°/min): P-CHAN-00108 is the factor.
    fn feed(&self, given: Given) -> Result<Feed, Fault> {
        let factor = Factor { numerator: 100_000, denominator: self.setup.feedrate_factor_milli.max(1) };
        match given.number.fixed(factor) {
            Some(feed) if feed > Feed::ZERO => Ok(feed),
            _ => given.span.fault(NcErrorKind::Range {
                what: "F",
                min: 0,
                max: 2_147_483_647,
                unit: "mm/min",
                above: true,
            }),
        }
    }

    /// M functions go behind the motion but those the set-up wants before it.
    fn m_word(&mut self, w: &mut Words<AXES>, code: u32, span: Span) -> Result<(), Fault> {
        let code = code as u16;
        let ending = match code {
            2 | 30 => Some(Ending::Program),
            17 | 29 => Some(Ending::Subroutine),
            _ => None,
        };
        if let Some(ending) = ending {
            if w.ends.replace(ending).is_some() {
                return span.fault(NcErrorKind::Twice("the end"));
            }
            if ending == Ending::Program {
                push(&mut w.after, span, ItemKind::ProgramEnd(code))?;
            }
            return Ok(());
        }
        let list = if self.setup.m_before.contains(&code) { &mut w.before } else { &mut w.after };
        push(list, span, ItemKind::M(code))
    }

    fn g_word(&mut self, c: &mut Cursor<'_>, w: &mut Words<AXES>, mark: usize) -> Result<(), Fault> {
        let number = c.whole("G number")?;
        if c.raw() == b'.' {
            let _ = c.decimal();
            return c.since(mark).fault(NcErrorKind::UnknownG);
        }
        let span = c.since(mark);
        let m = &mut self.modal;
        let group = match number {
            0..=3 => {
                m.mode = match number {
                    0 => Mode::Rapid,
                    1 => Mode::Line,
                    2 => Mode::Clockwise,
                    _ => Mode::Counterclockwise,
                };
                w.mode_span = Some(span);
                group::MODE
            }
            4 => {
                consume(w, Use::Dwell, span)?;
                if matches!(c.peek_upper(), b'0'..=b'9' | b'.' | b'+' | b'-' | b'=' | b'[' | b'P') {
                    w.time = Some(self.value(c, mark)?);
                }
                group::CONSUMER
            }
            17..=19 => {
                m.plane = match number {
                    17 => Plane::G17,
                    18 => Plane::G18,
                    _ => Plane::G19,
                };
                group::PLANE
            }
            53 => {
                m.zero_set = None;
                group::ZERO
            }
            54..=59 => {
                m.zero_set = Some(number as usize - 54);
                group::ZERO
            }
            60 => {
                w.exact_stop = Some(span);
                push(&mut w.before, span, ItemKind::Switch(60))?;
                group::EXACT
            }
            359 | 360 => {
                m.exact_stop = number == 360;
                push(&mut w.before, span, ItemKind::Switch(number as u16))?;
                group::EXACT
            }
            61 | 260 | 261 => {
                push(&mut w.before, span, ItemKind::Switch(number as u16))?;
                group::CONTOUR
            }
            70 | 71 => {
                m.inch = number == 70;
                group::UNIT
            }
            90 | 91 => {
                m.relative = number == 91;
                group::DIMENSION
            }
            92 => {
                consume(w, Use::Shift, span)?;
                group::CONSUMER
            }
            94 => group::FEED,
            93 | 95 | 194 => {
                push(&mut w.before, span, ItemKind::Switch(number as u16))?;
                group::FEED
            }
            150 | 151 => {
                push(&mut w.before, span, ItemKind::Switch(number as u16))?;
                group::SPLINE
            }
            161 | 162 => {
                m.centre_absolute = number == 161;
                group::CENTRE
            }
            130..=134 | 231..=233 | 338 | 339 => return self.weight_word(c, w, number as u16, mark, span),
            _ if OTHER_G.iter().any(|g| u32::from(*g) == number) => {
                return span.fault(NcErrorKind::NotAvailable("G word"));
            }
            _ => return span.fault(NcErrorKind::UnknownG),
        };
        if w.groups & group != 0 {
            return span.fault(NcErrorKind::Twice("a G word of one group"));
        }
        w.groups |= group;
        Ok(())
    }

    /// G130…G134, G231…G233, G338, G339: weights in percent.
    fn weight_word(
        &mut self,
        c: &mut Cursor<'_>,
        w: &mut Words<AXES>,
        number: u16,
        mark: usize,
        span: Span,
    ) -> Result<(), Fault> {
        let Some(kind) = WeightKind::from_g(number) else { return span.fault(NcErrorKind::UnknownG) };
        if kind.per_axis() {
            consume(w, Use::Weight(kind), span)?;
            return push(&mut w.before, span, ItemKind::WeightAxes(kind));
        }
        if !matches!(c.peek_upper(), b'0'..=b'9' | b'.' | b'+' | b'-' | b'=' | b'[' | b'P') {
            return span.fault(NcErrorKind::Missing("a weight in percent"));
        }
        let given = self.value(c, mark)?;
        let percent = weight(given)?;
        push(&mut w.before, given.span, ItemKind::WeightAll(kind, percent))
    }

    /// Turns the words into items in order: switches and weights, then motion or dwell, then M and H.
    fn finish(&mut self, mut w: Words<AXES>, line: &Line) -> Result<Next, Fault> {
        if let Some(given) = w.spindle.take() {
            if w.consumer == Use::Dwell {
                let turns = self.time(given, "revolutions")?;
                push(&mut w.before, w.consumer_span, ItemKind::Dwell(DwellTime::Revolutions(turns)))?;
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
                push(&mut w.before, given.span, ItemKind::Spindle(speed))?;
            }
        }
        if let Some(given) = w.radius {
            let radius = given.number.fixed(self.length_factor());
            let radius = radius.filter(|r| *r != Position::ZERO && in_range(*r));
            let Some(radius) = radius else { return given.span.fault(coordinate("R", "mm")) };
            self.modal.radius = Some(radius);
        }
        match w.consumer {
            Use::Motion => self.motion_of(&mut w, line)?,
            Use::Dwell => self.dwell_of(&mut w, line)?,
            Use::Shift => self.shift_of(&w)?,
            Use::Weight(_) => self.weights_of(&w)?,
        }
        if w.consumer != Use::Motion {
            if let Some(given) = w.centre.iter().flatten().next() {
                return given.span.fault(NcErrorKind::ArcWordAlone);
            }
        }
        if let (Some(span), false) = (w.exact_stop, self.moves) {
            return span.fault(NcErrorKind::ExactStopAlone);
        }
        for item in w.before.iter().chain(&w.after) {
            let full = self.queue.push_back(*item).is_err();
            if full {
                return item.span.fault(NcErrorKind::BlockTooFull);
            }
        }
        Ok(match w.ends {
            Some(Ending::Program) => {
                if !self.flow.frames.is_empty() {
                    let span = w.after.iter().rev().find(|i| matches!(i.kind, ItemKind::ProgramEnd(_)));
                    self.warn(line, span.map_or(Span::default(), |i| i.span), NcWarningKind::EndInSubroutine);
                }
                self.phase = Phase::Ended;
                Next::Line
            }
            Some(Ending::Subroutine) => self.finish_program(),
            None => Next::Line,
        })
    }

    /// Inch or millimetre.
    pub fn length_factor(&self) -> Factor {
        if self.modal.inch { Factor::INCH } else { Factor::ONE }
    }

    /// Unit of an axis: inch concerns linear axes only.
    pub fn axis_factor(&self, axis: usize) -> Factor {
        match self.setup.kinds.get(axis) {
            Some(AxisKind::Linear) => self.length_factor(),
            _ => Factor::ONE,
        }
    }

    /// Zero offset and G92 of an axis.
    pub fn offset(&self, axis: usize) -> Position {
        let set = self.modal.zero_set.and_then(|set| self.setup.zero_offsets.get(set));
        let zero = set.and_then(|set| set.get(axis)).copied().unwrap_or(Position::ZERO);
        zero.saturating_add(self.modal.shift.get(axis).copied().unwrap_or(Position::ZERO))
    }

    /// The value of an axis word in the axis' unit.
    fn axis_value(&self, axis: usize, given: Given) -> Result<Position, Fault> {
        let value = given.number.fixed(self.axis_factor(axis)).filter(|v| in_range(*v));
        value.ok_or(Fault { span: given.span, kind: self.coordinate_of(axis) })
    }

    fn coordinate_of(&self, axis: usize) -> NcErrorKind {
        let linear = self.setup.kinds.get(axis) == Some(&AxisKind::Linear);
        coordinate("coordinate", if linear { "mm" } else { "deg" })
    }

    /// G04.
    fn dwell_of(&mut self, w: &mut Words<AXES>, line: &Line) -> Result<(), Fault> {
        let mut time = w.time.map(|given| (given, None));
        for (axis, given) in w.axes.iter().enumerate() {
            let Some(given) = *given else { continue };
            match time {
                None => time = Some((given, Some(axis))),
                Some((_, None)) => return given.span.fault(NcErrorKind::Twice("the time of G04")),
                Some((first, Some(_))) => {
                    let extra = if first.span.at < given.span.at { given } else { first };
                    if first.span.at > given.span.at {
                        time = Some((given, Some(axis)));
                    }
                    self.warn(line, extra.span, NcWarningKind::DwellExtraAxis);
                }
            }
        }
        let dwell = w.before.iter().any(|item| matches!(item.kind, ItemKind::Dwell(_)));
        match time {
            Some((given, _)) if !dwell => {
                let seconds = self.time(given, "time of G04")?;
                push(&mut w.before, w.consumer_span, ItemKind::Dwell(DwellTime::Seconds(seconds)))
            }
            Some((given, _)) => given.span.fault(NcErrorKind::Twice("the time of G04")),
            None if dwell => Ok(()),
            None => w.consumer_span.fault(NcErrorKind::Missing("a time in seconds")),
        }
    }

    fn time(&self, given: Given, what: &'static str) -> Result<Position, Fault> {
        let value = given.number.fixed(Factor::ONE).filter(|t| *t >= Position::ZERO && in_range(*t));
        let max = i64::from(COORDINATE_MAX);
        let kind = NcErrorKind::Range { what, min: 0, max, unit: "", above: false };
        value.ok_or(Fault { span: given.span, kind })
    }

    /// G92: the additional offset of the axes named, absolute with G90, added with G91; no motion.
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

    /// G130, G132, G232.
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
    /// G00…G03 with the axis words of the block.
    fn motion_of(&mut self, w: &mut Words<AXES>, line: &Line) -> Result<(), Fault> {
        let mode = self.modal.mode;
        let arc = matches!(mode, Mode::Clockwise | Mode::Counterclockwise);
        let centre = w.centre.iter().flatten().next().copied();
        if let (Some(given), false) = (centre, arc) {
            return given.span.fault(NcErrorKind::ArcWordAlone);
        }
        let Some(first) = w.first else { return Ok(()) };
        let span = w.mode_span.filter(|mode| mode.at < first.at).unwrap_or(first);
        let mut target = self.position;
        for (axis, given) in w.axes.iter().enumerate() {
            let Some(given) = *given else { continue };
            let value = self.axis_value(axis, given)?;
            let offset = self.offset(axis);
            let kind = self.coordinate_of(axis);
            if let Some(slot) = target.get_mut(axis) {
                *slot = if self.modal.relative {
                    slot.saturating_add(value)
                } else {
                    value.saturating_add(offset)
                };
                if !in_range(*slot) {
                    return given.span.fault(kind);
                }
            }
        }
        let kind = match mode {
            Mode::Rapid => MotionKind::Rapid,
            Mode::Line => MotionKind::Line,
            Mode::Clockwise | Mode::Counterclockwise => MotionKind::Arc {
                plane: self.modal.plane,
                clockwise: mode == Mode::Clockwise,
                by: self.arc(w, &target, span)?,
            },
        };
        let still = !arc && target == self.position;
        if mode != Mode::Rapid && self.modal.feed.is_none() && !still {
            return span.fault(NcErrorKind::NoFeed);
        }
        self.motion = Some(Motion {
            n: self.n,
            place: line.place(span),
            kind,
            target,
            feed: self.modal.feed.unwrap_or(Feed::ZERO),
            exact_stop: self.modal.exact_stop || w.exact_stop.is_some(),
        });
        self.moves = true;
        self.position = target;
        push(&mut w.before, span, ItemKind::Motion)
    }

    /// Centre or radius of an arc to `target`. Coordinates of the centre that are not programmed are the start's.
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

/// Claims the axis words of the block.
fn consume<const AXES: usize>(w: &mut Words<AXES>, by: Use, span: Span) -> Result<(), Fault> {
    if w.consumer != Use::Motion {
        return span.fault(NcErrorKind::Conflict("another use of its axis words"));
    }
    w.consumer = by;
    w.consumer_span = span;
    Ok(())
}

fn push<const SIZE: usize>(list: &mut Vec<Item, SIZE>, span: Span, kind: ItemKind) -> Result<(), Fault> {
    list.push(Item { span, kind }).map_err(|_| Fault { span, kind: NcErrorKind::BlockTooFull })
}

/// Stores a word that a block may hold once.
fn put(slot: Option<&mut Option<Given>>, given: Given, what: &'static str) -> Result<(), Fault> {
    match slot {
        Some(slot) if slot.is_some() => given.span.fault(NcErrorKind::Twice(what)),
        Some(slot) => {
            *slot = Some(given);
            Ok(())
        }
        None => given.span.fault(NcErrorKind::UnknownWord),
    }
}

/// A weight: above 0 to 10 000 %.
fn weight(given: Given) -> Result<Position, Fault> {
    let value = given.number.fixed(Factor::ONE);
    let value = value.filter(|v| *v > Position::ZERO && *v <= Position::const_from_int(10_000));
    let kind = NcErrorKind::Range { what: "weight", min: 0, max: 10_000, unit: "%", above: true };
    value.ok_or(Fault { span: given.span, kind })
}

/// Inside ±[`COORDINATE_MAX`].
pub(super) fn in_range(value: Position) -> bool {
    let max = Position::const_from_int(COORDINATE_MAX as i64);
    value >= -max && value <= max
}

fn coordinate(what: &'static str, unit: &'static str) -> NcErrorKind {
    let max = i64::from(COORDINATE_MAX);
    NcErrorKind::Range { what, min: -max, max, unit, above: false }
}
