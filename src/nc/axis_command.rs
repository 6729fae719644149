//! Reads the commands of a single axis in brackets: oscillation `X[OSC …]` and independent motion `X[INDP_SYN
//! …]`, `X[INDP_ASYN …]`.
use super::cursor::Cursor;
use super::function::*;
use super::interpreter::{Gathered, Interpreter};
use super::keyword::{COORDINATE, Keywords, Range, Slot, Units, checked, list_inside};
use super::line::Line;
use super::number::Factor;
use super::{Command, Fault, Head, NcErrorKind, NcWarningKind, Span};
use crate::machine::{AxisKind, functions};
use crate::quantity::Position;
use core::cell::Cell;

/// Keywords of OSC.
#[derive(Default)]
struct OscWords {
    on: bool,
    off: bool,
    instant: bool,
    offsets: bool,
    short: bool,
    feed: Option<Value>,
    frequency: Option<Value>,
    period: Option<Value>,
    first: Option<Position>,
    second: Option<Position>,
    zero: Option<Position>,
    excursion: Option<Position>,
    first_wait: Option<Value>,
    second_wait: Option<Value>,
    count: Option<u32>,
}

const SECONDS: Range = Range::new(0, 100_000, "s");
const FEED: Range = Range::new(0, i32::MAX, "mm/min").above();

impl Keywords for OscWords {
    const COMMAND: &'static str = "OSC";
    const LIST: &'static [&'static str] = &[
        "ON",
        "OFF",
        "INSTANT",
        "FEED",
        "FREQ",
        "TIME",
        "1ST_POS",
        "2ND_POS",
        "ZERO_POS",
        "EXCUR",
        "1ST_DELT",
        "2ND_DELT",
        "NBR_OSC",
        "INCL_OFFSETS",
        "SHORT",
    ];

    fn slot(&mut self, keyword: &'static str, _: bool, units: Units) -> Slot<'_> {
        let coordinate = COORDINATE.times(units.length);
        let mark = match keyword {
            "ON" | "OFF" if self.on || self.off => return Slot::Twice,
            "ON" => &mut self.on,
            "OFF" => &mut self.off,
            "FEED" => return Slot::Number(&mut self.feed, FEED.times(units.feed)),
            "INSTANT" if self.on => return Slot::Mismatch("OSC ON"),
            "INSTANT" => &mut self.instant,
            _ if self.off => return Slot::Mismatch("OSC OFF"),
            "FREQ" => return Slot::Number(&mut self.frequency, Range::new(0, 1000, "Hz").above()),
            "TIME" => return Slot::Number(&mut self.period, SECONDS.above()),
            "1ST_POS" => return Slot::Number(&mut self.first, coordinate),
            "2ND_POS" => return Slot::Number(&mut self.second, coordinate),
            "ZERO_POS" => return Slot::Number(&mut self.zero, coordinate),
            "EXCUR" => return Slot::Number(&mut self.excursion, coordinate),
            "1ST_DELT" => return Slot::Number(&mut self.first_wait, SECONDS),
            "2ND_DELT" => return Slot::Number(&mut self.second_wait, SECONDS),
            "NBR_OSC" => return Slot::Count(&mut self.count),
            "INCL_OFFSETS" => &mut self.offsets,
            _ => &mut self.short,
        };
        if *mark {
            return Slot::Twice;
        }
        *mark = true;
        Slot::Done
    }
}

/// Keywords of INDP.
#[derive(Default)]
struct IndependentWords {
    words: Independent,
    motion: bool,
    dimension: bool,
    offsets: bool,
    feed_acceleration: Option<Value>,
    rapid_acceleration: Option<Value>,
    /// A known keyword that Glidepath does not have.
    other: Option<&'static str>,
}

const WEIGHT: Range = Range::new(0, 1000, "%").above();

impl Keywords for IndependentWords {
    const COMMAND: &'static str = "INDP";
    const LIST: &'static [&'static str] = &[
        "G00",
        "G01",
        "G0",
        "G1",
        "G100",
        "G90",
        "G91",
        "POS",
        "POSITION",
        "FEED",
        "TIME",
        "FEED_MAX_WEIGHT",
        "SLOPE_TYPE",
        "M",
        "H",
        "DRY_RUN",
        "ACC_WEIGHT",
        "RAPID_ACC_WEIGHT",
        "INCL_OFFSETS",
    ];

    fn slot(&mut self, keyword: &'static str, _: bool, units: Units) -> Slot<'_> {
        let (seen, choice, value) = match keyword {
            "POS" | "POSITION" => {
                return Slot::Number(&mut self.words.position, COORDINATE.times(units.length));
            }
            "FEED" => return Slot::Number(&mut self.words.feed, FEED.times(units.feed)),
            "TIME" => return Slot::Number(&mut self.words.time, SECONDS.above()),
            "FEED_MAX_WEIGHT" => {
                return Slot::Number(&mut self.words.weight, Range::new(0, 100, "%").above());
            }
            "SLOPE_TYPE" => return Slot::Slope(&mut self.words.slope),
            "ACC_WEIGHT" => return Slot::Number(&mut self.feed_acceleration, WEIGHT),
            "RAPID_ACC_WEIGHT" => return Slot::Number(&mut self.rapid_acceleration, WEIGHT),
            "M" => return Slot::Count(&mut self.words.m),
            "H" => return Slot::Count(&mut self.words.h),
            "G100" | "DRY_RUN" => {
                self.other = Some(keyword);
                return Slot::Done;
            }
            "INCL_OFFSETS" if self.offsets => return Slot::Twice,
            "INCL_OFFSETS" => {
                self.offsets = true;
                return Slot::Done;
            }
            "G90" | "G91" => (&mut self.dimension, &mut self.words.relative, keyword == "G91"),
            _ => (&mut self.motion, &mut self.words.rapid, matches!(keyword, "G00" | "G0")),
        };
        if *seen {
            return Slot::Twice;
        }
        *seen = true;
        *choice = value;
        Slot::Done
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Units for keywords of an axis.
    pub fn units(&self, axis: usize) -> Units {
        let denominator = self.setup.feedrate_factor_milli.max(1);
        Units { length: self.axis_factor(axis), feed: Factor { numerator: 100_000, denominator } }
    }

    /// Reads a command in brackets after an axis name into `single`, if there is one. Returns whether there
    /// was a command; without one, the cursor stays.
    pub fn axis_command(
        &mut self,
        c: &mut Cursor<'_>,
        line: &Line,
        axis: usize,
        mark: usize,
    ) -> Result<bool, Fault> {
        let bracket = c.mark();
        if !c.eat(b'[') {
            return Ok(false);
        }
        let word = c.identifier(24);
        let is_command = word.is("OSC") || word.is("INDP_SYN") || word.is("INDP_ASYN") || word.is("INDP");
        if is_command && !functions::BESIDE.is_built() {
            c.since(mark).needs(functions::BESIDE)?;
            return Ok(false);
        }
        #[cfg(feature = "plc")]
        if word.is("SYNC") {
            return c.since(mark).fault(NcErrorKind::NotAvailable("FCT_SYNC: an axis that joins the path,"));
        }
        if word.is("INDP") {
            return c.since(mark).fault(NcErrorKind::Missing("INDP_SYN or INDP_ASYN"));
        }
        if word.is("OSC") {
            self.oscillation(c, line, axis, mark)?;
            return Ok(true);
        }
        if is_command {
            self.motion_beside(c, line, (axis, !word.is("INDP_ASYN")), mark)?;
            return Ok(true);
        }
        c.back_to(bracket);
        Ok(false)
    }

    // The following functions are not inlined, so that only one of their stack frames exists at a time.

    #[inline(never)]
    fn motion_beside(
        &mut self,
        c: &mut Cursor<'_>,
        line: &Line,
        (axis, synchronous): (usize, bool),
        mark: usize,
    ) -> Result<(), Fault> {
        let mut target = IndependentWords::default();
        (target.words.axis, target.words.synchronous) = (axis, synchronous);
        list_inside(c, &self.calculator, self.units(axis), &mut target)?;
        self.move_beside(&target, line, c.since(mark))
    }

    #[inline(never)]
    fn move_beside(&mut self, target: &IndependentWords, line: &Line, span: Span) -> Result<(), Fault> {
        let words = self.independent(target, span)?;
        self.gathered = Gathered::Single(Cell::new(Command::Independent(self.head_of(line, span), words)));
        Ok(())
    }

    /// The motion of an independent axis; its end is in machine coordinates.
    fn independent(&self, target: &IndependentWords, span: Span) -> Result<Independent, Fault> {
        let mut words = target.words;
        if let Some(word) = target.other {
            return span.fault(NcErrorKind::NotAvailable(word));
        }
        if !target.dimension {
            words.relative = self.modal.relative;
        }
        let speeds = [words.feed, words.time, words.weight].iter().flatten().count();
        if !target.motion {
            words.rapid = speeds == 0;
        }
        if words.rapid && speeds > 0 {
            return span.fault(NcErrorKind::Independent("G00 has no FEED, TIME or FEED_MAX_WEIGHT"));
        }
        if !words.rapid && speeds != 1 {
            return span.fault(NcErrorKind::Independent("G01 has one of FEED, TIME and FEED_MAX_WEIGHT"));
        }
        if words.weight.is_some_and(|weight| weight >= 100) {
            return span.fault(NcErrorKind::Independent("FEED_MAX_WEIGHT is below 100"));
        }
        if [words.m, words.h].iter().flatten().any(|code| *code > 999) {
            return span.fault(NcErrorKind::Independent("M and H are 0 to 999"));
        }
        words.acceleration = if words.rapid { target.rapid_acceleration } else { target.feed_acceleration };
        let Some(position) = words.position else { return span.fault(NcErrorKind::Missing("POS")) };
        let from = match (words.relative, target.offsets) {
            (true, _) => self.position.get(words.axis).copied().unwrap_or_default(),
            (false, true) => self.offset(words.axis),
            (false, false) => Position::ZERO,
        };
        words.position = Some(checked(position.saturating_add(from), span)?);
        Ok(words)
    }

    #[inline(never)]
    fn oscillation(
        &mut self,
        c: &mut Cursor<'_>,
        line: &Line,
        axis: usize,
        mark: usize,
    ) -> Result<(), Fault> {
        let mut w = OscWords::default();
        let mut units = self.units(axis);
        if units.length == Factor::INCH {
            // FEED is in inch/min with G70.
            units.feed.numerator = 2_540_000;
        }
        list_inside(c, &self.calculator, units, &mut w)?;
        self.oscillate(&w, line, axis, c.since(mark))
    }

    #[inline(never)]
    fn oscillate(&mut self, w: &OscWords, line: &Line, axis: usize, span: Span) -> Result<(), Fault> {
        let action = if w.on {
            self.oscillation_on(w, axis, span)?
        } else if w.off {
            match (w.feed, w.instant) {
                (Some(_), true) => return span.fault(NcErrorKind::Conflict("INSTANT and FEED")),
                (Some(feed), _) => OscillationAction::OffFeed(feed),
                (None, true) => OscillationAction::OffInstant,
                (None, false) => OscillationAction::Off,
            }
        } else {
            return span.fault(NcErrorKind::Missing("ON or OFF"));
        };
        if let OscillationAction::On { second, .. } = action {
            // The oscillation ends at the second position, except with OFF INSTANT, where the planner knows
            // the end.
            self.stand_there(axis, second);
        }
        if w.short && self.setup.kinds.get(axis) == Some(&AxisKind::Linear) {
            self.warn(line, span, NcWarningKind::ShortLinear);
        }
        let head = self.head_of(line, span);
        self.gathered = Gathered::Single(Cell::new(Command::Oscillation(head, Oscillation { axis, action })));
        Ok(())
    }

    fn oscillation_on(&self, w: &OscWords, axis: usize, span: Span) -> Result<OscillationAction, Fault> {
        let speed = match (w.feed, w.frequency, w.period) {
            (Some(feed), None, None) => OscillationSpeed::Feed(feed),
            (None, Some(frequency), None) => OscillationSpeed::Frequency(frequency),
            (None, None, Some(period)) => OscillationSpeed::Period(period),
            (None, None, None) => return span.fault(NcErrorKind::OscillationSpeed),
            _ => return span.fault(NcErrorKind::Conflict("more than one of FEED, FREQ, TIME")),
        };
        let (first, second) = match (w.first, w.second, w.zero, w.excursion) {
            (Some(first), Some(second), None, None) => (first, second),
            (None, None, Some(zero), Some(excursion)) => {
                (zero.saturating_sub(excursion), zero.saturating_add(excursion))
            }
            _ => return span.fault(NcErrorKind::Missing("1ST_POS and 2ND_POS, or ZERO_POS and EXCUR")),
        };
        let offset = if w.offsets { self.offset(axis) } else { Position::ZERO };
        let first = checked(first.saturating_add(offset), span)?;
        let second = checked(second.saturating_add(offset), span)?;
        if first == second {
            return span.fault(NcErrorKind::Missing("two different positions"));
        }
        // The decoder does not know whether an axis is a modulo axis. The decoder only knows that a linear
        // axis does not count turns.
        if w.short && self.setup.kinds.get(axis) == Some(&AxisKind::Rotary) {
            let turn = Position::const_from_int(360);
            if [first, second].iter().any(|p| *p < Position::ZERO || *p > turn) {
                return span.fault(NcErrorKind::OscillationModulo);
            }
        }
        Ok(OscillationAction::On {
            first,
            second,
            speed,
            first_wait: w.first_wait.unwrap_or(Value::ZERO),
            second_wait: w.second_wait.unwrap_or(Value::ZERO),
            count: w.count,
            short: w.short,
        })
    }

    /// Block number and place of a command that begins at `span`.
    pub fn head_of(&self, line: &Line, span: Span) -> Head {
        Head { n: self.n, place: line.place(span), in_motion: false }
    }
}
