//! Reads the words of a block in ISG's language: G and M words, F, S, T, axis words. Modal state changes
//! here; the motion and the other commands are made in `compose.rs`.
use super::cursor::Cursor;
use super::expression::{expression, parameter_target};
use super::flow::Ending;
use super::interpreter::{Gathered, Interpreter, Next};
use super::line::Line;
use super::modal::{Before, Mode};
use super::number::{Factor, Number};
use super::{DwellTime, Fault, NcErrorKind, NcWarningKind, Plane, Span, WeightKind};
use crate::machine::functions;
use crate::quantity::{Feed, Position};
use core::cell::Cell;
use heapless::Deque;

/// One result of a block: a command or a motion. Packed to save memory, because there are many.
#[derive(Clone, Copy)]
#[repr(C, packed(4))]
pub(super) struct Item {
    pub span: Span,
    pub kind: ItemKind,
}

/// The results of a block, in order.
pub(super) type Items = Deque<Item, { super::BLOCK_WORDS }>;

/// The kind of a result. The interpreter stores values that are too large for this type.
#[derive(Clone, Copy)]
pub(super) enum ItemKind {
    /// A G word with its own typed command.
    Switch(u16),
    /// G131, G133, G134, G231, G233, G338, G339.
    WeightAll(WeightKind, Position),
    /// G130, G132, G232; the interpreter keeps the values.
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
    /// M0, M1, M6, M60 of other dialects.
    #[cfg(feature = "grbl")]
    Pause(u16),
    /// M62 to M68 of other dialects; the interpreter keeps the values.
    #[cfg(feature = "grbl")]
    Output,
    /// G38.n: the digit after the point.
    #[cfg(feature = "grbl")]
    Probe(u8),
    /// The comment of the line, if it is a message.
    #[cfg(feature = "grbl")]
    Message,
    /// G64 with its largest deviation.
    #[cfg(feature = "grbl")]
    Blend(Position),
}

/// An address and its value.
#[derive(Clone, Copy)]
pub(super) struct Given {
    pub number: Number,
    pub span: Span,
}

/// What the axis words of a block are used for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    Motion,
    Dwell,
    Shift,
    Weight(WeightKind),
}

/// The words of one block, as far as they are read.
pub(super) struct Words<const AXES: usize> {
    pub axes: [Option<Given>; AXES],
    /// The first axis word.
    pub first: Option<Span>,
    pub centre: [Option<Given>; 3],
    pub radius: Option<Given>,
    pub spindle: Option<Given>,
    pub time: Option<Given>,
    pub consumer: Use,
    pub consumer_span: Span,
    pub mode_span: Option<Span>,
    pub exact_stop: Option<Span>,
    /// Groups of G words that were seen, and F, one bit each.
    pub groups: u16,
    /// Number of items in the interpreter's queue that act before the motion.
    pub before: u8,
    pub ends: Option<Ending>,
    pub end_span: Span,
}

/// A block that is not completely read: reading continues in the next call.
pub(super) struct Waiting<const AXES: usize> {
    words: Words<AXES>,
    /// First value: start of the first word. Second value: start of the next word.
    first: u16,
    next: u16,
}

/// Cost of a word without its value, in the unit of [`super::calculator`].
const WORD: u32 = 16;

impl<const AXES: usize> Words<AXES> {
    /// A block without words.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn new() -> Self {
        Self {
            axes: [None; AXES],
            first: None,
            centre: [None; 3],
            radius: None,
            spindle: None,
            time: None,
            consumer: Use::Motion,
            consumer_span: Span { at: 0, len: 0 },
            mode_span: None,
            exact_stop: None,
            groups: 0,
            before: 0,
            ends: None,
            end_span: Span { at: 0, len: 0 },
        }
    }

    /// R, or the span from the first to the last of I, J and K.
    pub fn centre_span(&self) -> Option<Span> {
        let words = || self.centre.iter().chain([&self.radius]).flatten().map(|given| given.span);
        let at = words().map(|span| span.at).min()?;
        let end = words().map(|span| span.at.saturating_add(span.len)).max()?;
        Some(Span { at, len: end.saturating_sub(at) })
    }
}

/// Groups of G words: a block may hold one word of each group.
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
    /// The word F.
    pub const F: u16 = 2048;
}

/// G words of ISG's language that Glidepath does not have, sorted.
const OTHER_G: [u16; 76] = [
    5, 8, 9, 10, 11, 12, 13, 20, 21, 22, 23, 25, 26, 33, 40, 41, 42, 51, 52, 63, 66, 68, 69, 74, 80, 81, 82,
    83, 84, 85, 86, 87, 88, 89, 96, 97, 98, 99, 100, 101, 102, 106, 107, 108, 112, 115, 116, 117, 135, 136,
    137, 138, 139, 140, 141, 159, 163, 164, 165, 166, 167, 193, 196, 200, 201, 202, 236, 237, 238, 239, 293,
    301, 302, 303, 900, 901,
];

impl<const AXES: usize> Interpreter<AXES> {
    /// Reads a block of words.
    pub fn words(&mut self, c: &mut Cursor<'_>, line: &Line) -> Result<Next, Fault> {
        let mut w = Words::new();
        let mut first = c.mark();
        // Checked first, because it is large.
        if self.gathered.waits() {
            let next;
            [first, next] = self.take_up(&mut w);
            c.back_to(next);
        } else {
            self.before = Before::All(self.modal);
            self.queue.clear();
        }
        while !c.at_end() {
            let mark = c.mark();
            let result = if self.calculator.affords(WORD) {
                self.word(c, line, &mut w)
            } else {
                self.calculator.halt()
            };
            if self.calculator.is_halted() {
                self.lay_aside(&mut w, [first, mark]);
                return self.calculator.halt();
            }
            if let Some(single) = result? {
                if usize::from(single.at) != first {
                    return single.fault(NcErrorKind::NotAlone("an axis command"));
                }
                c.require_end("an axis command")?;
                return Ok(Next::Line);
            }
            self.calculator.complete();
            if let Some((span, value)) = self.computed.take() {
                self.warn(line, span, NcWarningKind::Computed(value));
            }
        }
        self.finish(&mut w, line)
    }

    // The following functions are not inlined, so that only one of their stack frames exists at a time.

    /// Stores the block, which continues in another call at the word `next`. `first`: its first word.
    #[inline(never)]
    fn lay_aside(&mut self, words: &mut Words<AXES>, [first, next]: [usize; 2]) {
        let words = core::mem::replace(words, Words::new());
        self.gathered =
            Gathered::Waiting(Cell::new(Waiting { words, first: first as u16, next: next as u16 }));
    }

    /// Restores the block that was stored.
    #[inline(never)]
    fn take_up(&mut self, words: &mut Words<AXES>) -> [usize; 2] {
        let Some(waiting) = self.gathered.take_up() else { return [0; 2] };
        *words = waiting.words;
        [waiting.first, waiting.next].map(usize::from)
    }

    /// Reads one word. An axis command in brackets writes itself to [`Gathered::Single`]; its span is
    /// returned.
    fn word(&mut self, c: &mut Cursor<'_>, line: &Line, w: &mut Words<AXES>) -> Result<Option<Span>, Fault> {
        let mark = c.mark();
        #[cfg(feature = "plc")]
        if self.is_calculation(c)? {
            return Ok(None);
        }
        if let Some(axis) = self.axis_here(c) {
            if c.peek() == b'[' && self.axis_command(c, line, axis, mark)? {
                return Ok(Some(c.since(mark)));
            }
            let given = self.value(c, mark)?;
            w.first.get_or_insert(given.span);
            put(w.axes.get_mut(axis), given, "axis")?;
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
                if !functions::EXPRESSIONS.is_built() {
                    c.rest_of_word().needs(functions::EXPRESSIONS)?;
                }
                let target = parameter_target(c, &self.calculator)?;
                c.require(b'=', "= behind the parameter")?;
                let value = expression(c, &self.calculator)?.real();
                self.calculator
                    .parameters
                    .set(target, value)
                    .map_err(|kind| Fault { span: c.since(mark), kind })?;
            }
            b'F' => {
                let given = self.value(c, mark)?;
                if w.groups & group::F != 0 {
                    return given.span.fault(NcErrorKind::Twice("F"));
                }
                w.groups |= group::F;
                self.modal.feed = Some(self.feed(given)?);
            }
            b'E' => {
                let given = self.value(c, mark)?;
                put_before(&mut self.queue, &mut w.before, given.span, ItemKind::EndFeed)?;
            }
            b'I' | b'J' | b'K' => {
                let given = self.value(c, mark)?;
                put(w.centre.get_mut(usize::from(letter - b'I')), given, "centre")?;
                w.first.get_or_insert(given.span);
            }
            b'R' => {
                let given = self.value(c, mark)?;
                put(Some(&mut w.radius), given, "radius")?;
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
                let code = code as u16;
                #[cfg(feature = "plc")]
                self.check_shift(true, code, span)?;
                let before = self.setup.h_synch.of(code).is_before();
                put_where(&mut self.queue, before.then_some(&mut w.before), span, ItemKind::H(code))?;
            }
            b'T' => {
                let (code, span) = self.code(c, mark, "T", 999_999_999)?;
                put_before(&mut self.queue, &mut w.before, span, ItemKind::Tool(code))?;
            }
            b'D' => {
                let (code, span) = self.code(c, mark, "D", 999)?;
                put_before(&mut self.queue, &mut w.before, span, ItemKind::ToolOffset(code))?;
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

    /// Carries out an assignment to a V. variable, if there is one. The lines of a real-time loop are read
    /// only once. So the loop must not contain assignments to V. variables or P parameters.
    #[cfg(feature = "plc")]
    #[inline(never)]
    fn is_calculation(&mut self, c: &mut Cursor<'_>) -> Result<bool, Fault> {
        let is_variable = super::variable::is_here(c);
        if self.in_loop && (is_variable || c.peek_upper() == b'P') {
            return c.rest_of_word().fault(NcErrorKind::InLoop);
        }
        if is_variable {
            if !functions::EXPRESSIONS.is_built() {
                c.rest_of_word().needs(functions::EXPRESSIONS)?;
            }
            self.assign_variable(c)?;
        }
        Ok(is_variable)
    }

    /// The axis whose name is at the cursor. A name of several letters needs `=` or `[` after it.
    pub fn axis_here(&self, c: &mut Cursor<'_>) -> Option<usize> {
        let mark = c.mark();
        let letter = c.peek_upper();
        let mut single = None;
        for (i, name) in self.setup.names.iter().enumerate() {
            let [first, second, ..] = name.0;
            if first != letter {
                continue;
            }
            if second == 0 {
                single = Some(i);
            } else if c.eat_words(name.as_str()) && matches!(c.peek(), b'=' | b'[') {
                return Some(i);
            }
            c.back_to(mark);
        }
        if single.is_some() {
            c.bump();
        }
        single
    }

    /// The value after an address, with or without `=`.
    fn value(&mut self, c: &mut Cursor<'_>, mark: usize) -> Result<Given, Fault> {
        c.eat(b'=');
        let from = c.mark();
        let number = expression(c, &self.calculator)?;
        if !matches!(number, Number::Decimal { .. }) && is_bare_arithmetic(c.part(c.since(from))) {
            let value = number.real() * 1000.0;
            self.computed = Some((c.since(mark), (value + if value < 0.0 { -0.5 } else { 0.5 }) as i32));
        }
        Ok(Given { number, span: c.since(mark) })
    }

    /// A whole number after an address.
    fn code(
        &mut self,
        c: &mut Cursor<'_>,
        mark: usize,
        what: &'static str,
        max: u32,
    ) -> Result<(u32, Span), Fault> {
        let given = self.value(c, mark)?;
        let Some(value) = given.number.whole() else { return given.span.fault(NcErrorKind::NotWhole(what)) };
        match u32::try_from(value) {
            Ok(value) if value <= max => Ok((value, given.span)),
            _ => given.span.fault(NcErrorKind::Range { what, min: 0, max, unit: "", above: false }),
        }
    }

    /// F in mm/min (°/min), with the factor of P-CHAN-00108.
    fn feed(&self, given: Given) -> Result<Feed, Fault> {
        match given.number.fixed(self.feed_factor()) {
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

    /// An M function comes after the motion, unless P-CHAN-00041 places it before.
    fn m_word(&mut self, w: &mut Words<AXES>, code: u32, span: Span) -> Result<(), Fault> {
        let code = code as u16;
        let ending = match code {
            2 | 30 => Some(Ending::Program),
            17 | 29 => Some(Ending::Subroutine),
            _ => None,
        };
        #[cfg(feature = "plc")]
        if ending == Some(Ending::Subroutine) && self.in_loop {
            return span.fault(NcErrorKind::InLoop);
        }
        if let Some(ending) = ending {
            w.end_span = span;
            if w.ends.replace(ending).is_some() {
                return span.fault(NcErrorKind::Twice("program end"));
            }
            if ending == Ending::Program {
                put_where(&mut self.queue, None, span, ItemKind::ProgramEnd(code))?;
            }
            return Ok(());
        }
        #[cfg(feature = "grbl")]
        if code == 0 || code == 1 {
            // M01 pauses only with its switch.
            if code == 0 || self.setup.foreign.optional_stop {
                put_where(&mut self.queue, None, span, ItemKind::Pause(code))?;
            }
            return Ok(());
        }
        #[cfg(feature = "plc")]
        self.check_shift(false, code, span)?;
        let before = self.setup.m_synch.of(code).is_before();
        put_where(&mut self.queue, before.then_some(&mut w.before), span, ItemKind::M(code))
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
                    // The word must not change state before its value is read: see `calculator`.
                    let time = self.value(c, mark);
                    if time.is_err() {
                        w.consumer = Use::Motion;
                    }
                    w.time = Some(time?);
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
                put_before(&mut self.queue, &mut w.before, span, ItemKind::Switch(60))?;
                group::EXACT
            }
            359 | 360 => {
                m.exact_stop = number == 360;
                put_before(&mut self.queue, &mut w.before, span, ItemKind::Switch(number as u16))?;
                group::EXACT
            }
            61 | 260 | 261 => {
                if number != 260 {
                    span.needs(functions::CONTOUR)?;
                }
                put_before(&mut self.queue, &mut w.before, span, ItemKind::Switch(number as u16))?;
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
                put_before(&mut self.queue, &mut w.before, span, ItemKind::Switch(number as u16))?;
                group::FEED
            }
            150 | 151 => {
                if number == 151 {
                    span.needs(functions::SPLINES)?;
                }
                put_before(&mut self.queue, &mut w.before, span, ItemKind::Switch(number as u16))?;
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
            return span.fault(NcErrorKind::Twice("G word of this group"));
        }
        w.groups |= group;
        Ok(())
    }

    /// Reads the weights, in percent, of G130…G134, G231…G233, G338 or G339.
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
            return put_before(&mut self.queue, &mut w.before, span, ItemKind::WeightAxes(kind));
        }
        if !matches!(c.peek_upper(), b'0'..=b'9' | b'.' | b'+' | b'-' | b'=' | b'[' | b'P') {
            return span.fault(NcErrorKind::Missing("a weight in percent"));
        }
        let given = self.value(c, mark)?;
        let percent = weight(given)?;
        put_before(&mut self.queue, &mut w.before, given.span, ItemKind::WeightAll(kind, percent))
    }
}

/// Whether a text of digits, points, blanks and operators is an expression: it has an operator after a digit.
#[cold]
#[inline(never)]
fn is_bare_arithmetic(text: &[u8]) -> bool {
    let plain = |byte: &u8| matches!(byte, b'0'..=b'9' | b'.' | b' ' | b'+' | b'-' | b'*' | b'/');
    let number = text.iter().position(|byte| byte.is_ascii_digit());
    let behind = number.and_then(|at| text.get(at..)).unwrap_or(&[]);
    text.iter().all(plain) && behind.iter().any(|byte| matches!(byte, b'+' | b'-' | b'*' | b'/'))
}

/// Whether a line ends with a checksum: a plain number after an address, then `*` and up to three digits.
/// Returns the byte where the checksum begins.
#[cold]
#[inline(never)]
pub(super) fn checksum_of(text: &[u8]) -> Option<usize> {
    let end = text.iter().rposition(|byte| *byte != b' ')? + 1;
    let star = text.iter().rposition(|byte| *byte == b'*')?;
    let digits = text.get(star + 1..end).unwrap_or(&[]);
    if digits.is_empty() || digits.len() > 3 || !digits.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let before = text.get(..star).unwrap_or(&[]).trim_ascii_end();
    let is_number = |byte: &u8| byte.is_ascii_digit() || *byte == b'.';
    let letter = before.iter().rposition(|byte| !is_number(byte))?;
    if letter + 1 == before.len() {
        return None;
    }
    let signed = before.get(..=letter).unwrap_or(&[]).trim_ascii_end();
    let named = match signed.split_last() {
        Some((b'+' | b'-' | b'=', rest)) => rest.trim_ascii_end(),
        _ => signed,
    };
    let named = match named.split_last() {
        Some((b'=', rest)) => rest,
        _ => named,
    };
    let address = named.last().is_some_and(|byte| byte.is_ascii_alphabetic() && !matches!(byte, b'P' | b'p'));
    address.then_some(star)
}

/// Marks the axis words of the block as used for one purpose. A second purpose is refused.
fn consume<const AXES: usize>(w: &mut Words<AXES>, by: Use, span: Span) -> Result<(), Fault> {
    if w.consumer != Use::Motion {
        return span.fault(NcErrorKind::Conflict("another use of its axis words"));
    }
    w.consumer = by;
    w.consumer_span = span;
    Ok(())
}

/// Inserts an item behind the other items that come before the motion, and counts it.
pub(super) fn put_before(
    queue: &mut Items,
    before: &mut u8,
    span: Span,
    kind: ItemKind,
) -> Result<(), Fault> {
    put_where(queue, Some(before), span, kind)
}

/// Inserts an item before the motion, or at the end.
fn put_where(queue: &mut Items, before: Option<&mut u8>, span: Span, kind: ItemKind) -> Result<(), Fault> {
    let mut item = Item { span, kind };
    if let Some(before) = before {
        for behind in queue.iter_mut().skip(usize::from(*before)) {
            core::mem::swap(behind, &mut item);
        }
        *before = before.saturating_add(1);
    }
    queue.push_back(item).map_err(|_| Fault { span, kind: NcErrorKind::BlockTooFull })
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

/// A weight: above 0, and at most 10 000 %.
pub(super) fn weight(given: Given) -> Result<Position, Fault> {
    let value = given.number.fixed(Factor::ONE);
    let value = value.filter(|v| *v > Position::ZERO && *v <= Position::const_from_int(10_000));
    let kind = NcErrorKind::Range { what: "weight", min: 0, max: 10_000, unit: "%", above: true };
    value.ok_or(Fault { span: given.span, kind })
}
