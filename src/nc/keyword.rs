//! Reads keyword lists in square brackets, for example `[DEV, PATH_DEV 5 RELEVANT_PATH=2]`. All commands use
//! this reader.
use super::calculator::Calculator;
use super::compose::in_range;
use super::cursor::Cursor;
use super::expression::expression;
use super::function::{Limit, SlopeType, Tangent, Value};
use super::number::Factor;
use super::{Fault, NcErrorKind, Span};
use crate::quantity::Position;

/// Factors for programmed values.
#[derive(Clone, Copy)]
pub(super) struct Units {
    /// Factor for positions of the axis or of the main axes.
    pub length: Factor,
    /// Factor for feeds.
    pub feed: Factor,
}

/// Range and unit of a number.
#[derive(Clone, Copy)]
pub(super) struct Range {
    pub min: i32,
    pub max: i32,
    /// Whether the least value itself is refused.
    pub above: bool,
    /// Whether -1 is also accepted, which means not monitored.
    pub or_off: bool,
    pub unit: &'static str,
    pub factor: Factor,
}

impl Range {
    pub const fn new(min: i32, max: i32, unit: &'static str) -> Self {
        Self { min, max, above: false, or_off: false, unit, factor: Factor::ONE }
    }

    pub const fn above(self) -> Self {
        Self { above: true, ..self }
    }

    pub const fn or_off(self) -> Self {
        Self { or_off: true, ..self }
    }

    pub const fn times(self, factor: Factor) -> Self {
        Self { factor, ..self }
    }
}

/// Range of lengths and distances.
pub(super) const MILLIMETRES: Range = Range::new(0, 100_000, "mm");
/// Range of angles.
pub(super) const DEGREES: Range = Range::new(0, 360, "deg");
/// Range of shares.
pub(super) const PERCENT: Range = Range::new(0, 100, "%");
/// Range of coordinates.
pub(super) const COORDINATE: Range = Range::new(-100_000, 100_000, "mm or deg");

/// What the value of a keyword is, and where it is stored.
pub(super) enum Slot<'a> {
    /// The keyword has no value.
    Done,
    /// The keyword, or an equivalent one, was given before.
    Twice,
    /// The keyword does not fit the method or switch with this name.
    Mismatch(&'static str),
    Number(&'a mut Option<Position>, Range),
    /// 0 or 1.
    Flag(&'a mut Option<bool>),
    /// A whole number from 0 to this maximum.
    Level(&'a mut Option<u8>, u8),
    Count(&'a mut Option<u32>),
    Real(&'a mut Option<f64>),
    /// A value; without one, the limit of the channel applies.
    Limit(&'a mut Option<Limit>),
    Slope(&'a mut Option<SlopeType>),
    Tangent(&'a mut Option<Tangent>),
}

/// A command with keywords.
pub(super) trait Keywords {
    /// Name of the command, for messages.
    const COMMAND: &'static str;
    /// Keywords of the command.
    const LIST: &'static [&'static str];

    /// The destination of the value of `keyword` (from [`Self::LIST`]). `first`: whether this is the first
    /// keyword.
    fn slot(&mut self, keyword: &'static str, first: bool, units: Units) -> Slot<'_>;
}

/// Cost of a keyword without its value, in the unit of [`super::calculator`].
const KEYWORD: u32 = 15;

/// Reads `[…]` into `target`.
pub(super) fn list<K: Keywords>(
    c: &mut Cursor<'_>,
    calculator: &Calculator,
    units: Units,
    target: &mut K,
) -> Result<(), Fault> {
    c.require(b'[', "[ and keywords")?;
    list_inside(c, calculator, units, target)
}

/// As [`list`], after the opening bracket.
pub(super) fn list_inside<K: Keywords>(
    c: &mut Cursor<'_>,
    calculator: &Calculator,
    units: Units,
    target: &mut K,
) -> Result<(), Fault> {
    let mut first = true;
    while let Some((keyword, mark, name)) = next(c, calculator, K::COMMAND, K::LIST)? {
        value(c, calculator, target.slot(keyword, first, units), mark, name)?;
        first = false;
    }
    Ok(())
}

/// Reads the next keyword and returns the keyword, its start and its place. Returns `None` after the closing
/// bracket.
#[inline(never)]
fn next(
    c: &mut Cursor<'_>,
    calculator: &Calculator,
    command: &'static str,
    keywords: &'static [&'static str],
) -> Result<Option<(&'static str, usize, Span)>, Fault> {
    while c.eat(b',') {}
    if c.eat(b']') {
        return Ok(None);
    }
    if c.at_end() {
        return c.expected("]");
    }
    let mark = c.mark();
    calculator.charge(KEYWORD);
    let Some(keyword) = keyword(c, keywords) else {
        c.back_to(mark);
        return c.here().fault(NcErrorKind::UnknownKeyword { command, keywords });
    };
    Ok(Some((keyword, mark, c.since(mark))))
}

/// The keyword at the cursor; its value may follow without a blank (`X110`, `XP5`).
fn keyword(c: &mut Cursor<'_>, known: &[&'static str]) -> Option<&'static str> {
    let mark = c.mark();
    let whole = c.identifier(24);
    let length = whole.bytes().len();
    for cut in (1..=length).rev() {
        let head = whole.bytes().get(..cut).unwrap_or(&[]);
        let next = whole.bytes().get(cut).copied().unwrap_or(b' ');
        if cut < length && !next.is_ascii_digit() && next != b'P' {
            continue;
        }
        if let Some(found) = known.iter().find(|k| k.as_bytes() == head) {
            c.back_to(mark);
            c.identifier(cut);
            return Some(found);
        }
    }
    None
}

/// Reads the value of a keyword into its slot.
#[inline(never)]
fn value(
    c: &mut Cursor<'_>,
    calculator: &Calculator,
    slot: Slot<'_>,
    mark: usize,
    name: Span,
) -> Result<(), Fault> {
    let twice = NcErrorKind::Twice("keyword");
    let whole = |c: &mut Cursor<'_>, max: u32| -> Result<u32, Fault> {
        c.eat(b'=');
        let number = expression(c, calculator)?;
        let span = c.since(mark);
        let Some(n) = number.whole() else { return span.fault(NcErrorKind::NotWhole("it")) };
        match u32::try_from(n) {
            Ok(n) if n <= max => Ok(n),
            _ => span.fault(NcErrorKind::Range { what: "value", min: 0, max, unit: "", above: false }),
        }
    };
    match slot {
        Slot::Done => Ok(()),
        Slot::Twice => name.fault(twice),
        Slot::Mismatch(with) => name.fault(NcErrorKind::KeywordMismatch { with }),
        Slot::Number(Some(_), _)
        | Slot::Flag(Some(_))
        | Slot::Level(Some(_), _)
        | Slot::Count(Some(_))
        | Slot::Real(Some(_))
        | Slot::Limit(Some(_))
        | Slot::Slope(Some(_))
        | Slot::Tangent(Some(_)) => name.fault(twice),
        Slot::Number(to, range) => {
            *to = Some(number(c, calculator, mark, range)?);
            Ok(())
        }
        Slot::Flag(to) => {
            *to = Some(whole(c, 1)? == 1);
            Ok(())
        }
        Slot::Level(to, max) => {
            *to = Some(whole(c, u32::from(max))? as u8);
            Ok(())
        }
        Slot::Count(to) => {
            *to = Some(whole(c, u32::MAX)?);
            Ok(())
        }
        Slot::Real(to) => {
            c.eat(b'=');
            *to = Some(expression(c, calculator)?.real());
            Ok(())
        }
        Slot::Limit(to) => {
            let given = matches!(c.peek_upper(), b'=' | b'0'..=b'9' | b'.' | b'+' | b'-' | b'[' | b'P');
            let range = Range::new(0, i32::MAX, "").above();
            *to = Some(if given { Limit::Is(number(c, calculator, mark, range)?) } else { Limit::Channel });
            Ok(())
        }
        Slot::Slope(to) => {
            c.eat(b'=');
            let names = [
                ("STEP", SlopeType::Step),
                ("TRAPEZ", SlopeType::Trapez),
                ("SIN2", SlopeType::Sin2),
                ("HSC", SlopeType::Hsc),
            ];
            *to = Some(choice(c, &names, "STEP, TRAPEZ, SIN2 or HSC")?);
            Ok(())
        }
        Slot::Tangent(to) => {
            c.eat(b'=');
            let names =
                [("AUTO", Tangent::Auto), ("TANGENTIAL", Tangent::Tangential), ("USER", Tangent::User)];
            *to = Some(choice(c, &names, "AUTO, TANGENTIAL or USER")?);
            Ok(())
        }
    }
}

/// Reads a number and checks its range.
pub(super) fn number(
    c: &mut Cursor<'_>,
    calculator: &Calculator,
    mark: usize,
    range: Range,
) -> Result<Value, Fault> {
    c.eat(b'=');
    let given = expression(c, calculator)?.fixed(range.factor);
    let (min, max) = (Value::from_num(range.min), Value::from_num(range.max));
    let inside = |v: &Value| {
        let low = if range.above { *v > min } else { *v >= min };
        low && *v <= max || range.or_off && *v == -Value::ONE
    };
    given.filter(inside).ok_or(Fault {
        span: c.since(mark),
        kind: NcErrorKind::Range {
            what: "value",
            min: range.min,
            max: range.max.unsigned_abs(),
            unit: match (range.or_off, range.unit) {
                (true, "mm") => "mm, or -1",
                (true, _) => "deg, or -1",
                _ => range.unit,
            },
            above: range.above,
        },
    })
}

/// Reads one of these names.
fn choice<V: Copy>(c: &mut Cursor<'_>, names: &[(&str, V)], expected: &'static str) -> Result<V, Fault> {
    let mark = c.mark();
    let word = c.identifier(24);
    match names.iter().find(|(name, _)| word.is(name)) {
        Some((_, value)) => Ok(*value),
        None => {
            c.back_to(mark);
            c.expected(expected)
        }
    }
}

/// Checks that a sum of positions is still a coordinate.
pub(super) fn checked(value: Position, span: Span) -> Result<Position, Fault> {
    if in_range(value) {
        return Ok(value);
    }
    span.fault(NcErrorKind::Range { what: "coordinate", min: -100_000, max: 100_000, unit: "", above: false })
}
