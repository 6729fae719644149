//! `#` parameters: `#1` to `#30` of the current call, other numbers up to `#4999`, named ones, and those that
//! report the state (from `#5000` on).
use super::Interpreter;
use crate::machine::MORE_OFFSETS;
use crate::nc::cursor::Cursor;
use crate::nc::flow::hash;
use crate::nc::{Fault, NcErrorKind, Plane, real};
use crate::quantity::Position;
use heapless::Vec;

/// The parameter that hides `(DEBUG, …)`: 0 hides the comments. The program may write this parameter.
const DEBUG_SHOWN: u32 = 5599;

/// Number of arguments of a call, `#1`…`#30`.
pub(super) const ARGUMENTS: usize = 30;

/// Longest name of a parameter or a subroutine, characters.
const NAME: usize = 63;

/// In the table of parameters, the index of a named parameter has this bit. So it is above all numbers.
const NAMED: u32 = 1 << 31;

/// Bits of a name's hash. A program has about ten names, so two names with equal hashes are not expected.
const HASH: u32 = (1 << 27) - 1;

/// The name between `<` and `>`, in upper case.
pub(super) struct Name {
    letters: Vec<u8, NAME>,
}

impl Name {
    /// Whether the name begins with `_`: such names are valid in the program and all subroutines.
    fn is_global(&self) -> bool {
        self.letters.first() == Some(&b'_')
    }

    /// The error if the name has no value.
    pub fn unset(&self) -> NcErrorKind {
        let of_machine = [&b"_HAL["[..], b"_INI["].iter().any(|lead| self.letters.starts_with(lead));
        if of_machine {
            let what = "a value of LinuxCNC's HAL or INI";
            return NcErrorKind::Known { what, hint: "the number itself" };
        }
        NcErrorKind::NameUnset
    }

    pub fn hash(&self) -> u32 {
        let hash = hash(&self.letters);
        (hash ^ hash >> 32) as u32
    }

    /// Index in the table. `level` is the call level, 0 outside of subroutines.
    pub fn index(&self, level: usize) -> u32 {
        let level = if self.is_global() { 0 } else { level as u32 + 1 };
        NAMED | (level & 15) << 27 | self.hash() & HASH
    }
}

/// Reads `<name>`.
pub(super) fn name(c: &mut Cursor<'_>) -> Result<Name, Fault> {
    let mark = c.mark();
    c.require(b'<', "< and a name")?;
    let mut letters = Vec::new();
    while !matches!(c.peek(), b'>' | 0) {
        if letters.push(c.peek_upper()).is_err() {
            return c.since(mark).fault(NcErrorKind::NameTooLong);
        }
        c.bump();
    }
    c.require(b'>', "> behind the name")?;
    if letters.is_empty() {
        return c.since(mark).fault(NcErrorKind::Expected("a name"));
    }
    Ok(Name { letters })
}

/// Letters of axes, in the order of LinuxCNC's tables.
const AXES_IN_ORDER: &[u8; 9] = b"XYZABCUVW";

impl<const AXES: usize> Interpreter<AXES> {
    /// Reads the number of a parameter that a program may write: 1 to 4999.
    pub(super) fn target(&self, c: &mut Cursor<'_>) -> Result<u32, Fault> {
        let mark = c.mark();
        c.require(b'#', "#")?;
        if c.peek() == b'<' {
            let name = name(c)?;
            if self.state_named(&name).is_some() {
                return c.since(mark).fault(READ_ONLY);
            }
            return Ok(name.index(self.foreign.calls.level()));
        }
        let value = self.evaluate(c)?;
        match number_of(value) {
            Some(number) if number < 5000 || number == DEBUG_SHOWN => Ok(number),
            Some(_) => c.since(mark).fault(READ_ONLY),
            None => c.since(mark).fault(NcErrorKind::ParameterIndex),
        }
    }

    /// Writes a parameter.
    pub(super) fn assign(&mut self, index: u32, value: f64) -> Result<(), NcErrorKind> {
        let slot = (index as usize).checked_sub(1).and_then(|k| self.foreign.calls.locals.get_mut(k));
        match slot {
            Some(slot) => *slot = value,
            None => self.calculator.parameters.set(index, value)?,
        }
        Ok(())
    }

    /// The value of `#n`; 0 if nothing was written.
    pub(super) fn numbered(&self, n: f64) -> Result<f64, NcErrorKind> {
        let number = number_of(n).ok_or(NcErrorKind::ParameterIndex)?;
        if let Some(local) = (number as usize).checked_sub(1).and_then(|k| self.foreign.calls.locals.get(k)) {
            return Ok(*local);
        }
        if number == DEBUG_SHOWN {
            return Ok(self.calculator.parameters.get(number).unwrap_or(1.0));
        }
        if number >= 5000 {
            return self.state_numbered(number).ok_or(NcErrorKind::Known {
                what: "this parameter",
                hint: "#1 to #4999, or one of docs/dialects.md",
            });
        }
        Ok(self.calculator.parameters.get(number).unwrap_or(0.0))
    }

    /// The value of `#<name>`; `None` if it has no value.
    pub(super) fn named(&self, name: Name) -> Option<f64> {
        let index = name.index(self.foreign.calls.level());
        self.state_named(&name).or_else(|| self.calculator.parameters.get(index).ok())
    }

    /// The value of a parameter as a comment names it, without `#`: `100`, or `<name>`.
    #[cfg(feature = "dialects")]
    pub(in crate::nc) fn parameter(&self, text: &[u8]) -> Option<f64> {
        let Some(rest) = text.strip_prefix(b"<") else {
            let number = core::str::from_utf8(text).ok()?.parse::<u32>().ok()?;
            return self.numbered(f64::from(number)).ok();
        };
        let letters = rest.strip_suffix(b">")?.iter().filter(|byte| !matches!(byte, b' ' | b'\t'));
        self.named(Name { letters: letters.map(u8::to_ascii_uppercase).collect() })
    }

    /// Parameters from 5000 on, which report the state. Lengths are in the unit in force.
    fn state_numbered(&self, number: u32) -> Option<f64> {
        let letter = |at: u32| AXES_IN_ORDER.get(at as usize).copied();
        let foreign = &self.foreign.now;
        let of = |places: &[Position; AXES], at: u32| self.length_along(places, letter(at)?);
        match number {
            5161..=5169 => of(self.setup.foreign.stored.first()?, number - 5161),
            5181..=5189 => of(self.setup.foreign.stored.get(1)?, number - 5181),
            5210 => Some(if foreign.here_off { 0.0 } else { 1.0 }),
            5211..=5219 => of(&foreign.here, number - 5211),
            5220 => Some(self.modal.zero_set.unwrap_or(0) as f64 + 1.0),
            5221..=5390 => {
                let (set, at) = ((number - 5221) / 20, (number - 5221) % 20);
                let (set, sets) = (set as usize, self.setup.zero_offsets.len());
                if at == 9 {
                    return Some(0.0);
                }
                let places = match set.checked_sub(sets) {
                    None => self.setup.zero_offsets.get(set)?,
                    Some(more) if more < MORE_OFFSETS => self.setup.foreign.offsets.get(more)?,
                    Some(_) => return None,
                };
                of(places, at)
            }
            5400 => Some(f64::from(foreign.tool.loaded)),
            5401..=5409 => of(&foreign.length, number - 5401),
            5420..=5428 => self.place_along(letter(number - 5420)?),
            _ => None,
        }
    }

    /// Named parameters that report the state.
    fn state_named(&self, name: &Name) -> Option<f64> {
        let truth = |b: bool| Some(if b { 1.0 } else { 0.0 });
        let now = &self.foreign.now;
        match name.letters.as_slice() {
            b"_METRIC" => truth(!self.modal.inch),
            b"_IMPERIAL" => truth(self.modal.inch),
            b"_ABSOLUTE" => truth(!self.modal.relative),
            b"_INCREMENTAL" => truth(self.modal.relative),
            b"_INVERSE_TIME" => truth(now.by_time),
            b"_UNITS_PER_MINUTE" => truth(!now.by_time && !now.per_turn),
            b"_UNITS_PER_REV" => truth(now.per_turn),
            b"_SPINDLE_RPM_MODE" => truth(now.surface.is_none()),
            b"_SPINDLE_CSS_MODE" => truth(now.surface.is_some()),
            b"_CCOMP" => Some(400.0),
            b"_LATHE_DIAMETER_MODE" => truth(self.modal.diameter),
            b"_LATHE_RADIUS_MODE" => truth(!self.modal.diameter),
            b"_SPEED_OVERRIDE" | b"_FEED_OVERRIDE" | b"_FEED_HOLD" => Some(1.0),
            b"_ADAPTIVE_FEED" => Some(0.0),
            b"_TOOL_OFFSET" => truth(now.length.iter().any(|length| *length != Position::ZERO)),
            b"_RETRACT_R_PLANE" => truth(now.to_level),
            b"_RETRACT_OLD_Z" => truth(!now.to_level),
            b"_MIST" => truth(now.coolant & 1 != 0),
            b"_FLOOD" => truth(now.coolant & 2 != 0),
            b"_RPM" => Some(now.speed.to_bits() as f64 / 4_294_967_296.0),
            b"_MOTION_MODE" => Some(f64::from(self.in_force().motion())),
            b"_FEED" => self.feed_in_unit(),
            b"_IJK_ABSOLUTE_MODE" => truth(self.modal.centre_absolute),
            b"_SPINDLE_ON" => truth(now.spindle != 0),
            b"_SPINDLE_CW" => truth(now.spindle == 3),
            b"_COORD_SYSTEM" => Some(match self.modal.zero_set.unwrap_or(0) {
                set @ 0..=5 => 540.0 + 10.0 * set as f64,
                set => 585.0 + set as f64,
            }),
            b"_PLANE" => Some(match self.modal.plane {
                Plane::G17 => 170.0,
                Plane::G18 => 180.0,
                Plane::G19 => 190.0,
            }),
            b"_CALL_LEVEL" => Some(self.foreign.calls.level() as f64),
            b"_VALUE" => Some(self.foreign.calls.value),
            b"_VALUE_RETURNED" => truth(self.foreign.calls.returned),
            b"_CURRENT_TOOL" | b"_CURRENT_POCKET" => Some(f64::from(now.tool.loaded)),
            b"_SELECTED_TOOL" | b"_SELECTED_POCKET" => Some(f64::from(now.tool.selected)),
            b"_TASK" => Some(1.0),
            b"_REMAP_LEVEL" => Some(0.0),
            b"_VMAJOR" => Some(2.9),
            b"_VMINOR" => Some(0.0),
            [b'_', letter] if AXES_IN_ORDER.contains(letter) => self.place_along(*letter),
            [b'_', b'A', b'B', b'S', b'_', letter] if AXES_IN_ORDER.contains(letter) => {
                self.length_along(&self.position, *letter)
            }
            _ => None,
        }
    }

    /// F in the unit of the program.
    fn feed_in_unit(&self) -> Option<f64> {
        let feed = self.modal.feed?.to_bits() as f64 / 4_294_967_296.0;
        Some(if self.modal.inch && !self.foreign.now.by_time { feed / 25.4 } else { feed })
    }

    /// A length of an axis in the unit in force; 0 if the machine does not have the axis. Returns `None` for
    /// X while G7 is in force.
    fn length_along(&self, places: &[Position; AXES], letter: u8) -> Option<f64> {
        if self.modal.diameter && letter == b'X' {
            return None;
        }
        let Some(axis) = self.letters.axis(letter) else { return Some(0.0) };
        let mm = places.get(axis)?.to_bits() as f64 / 4_294_967_296.0;
        let factor = self.axis_factor(axis);
        Some(mm * f64::from(factor.denominator) / f64::from(factor.numerator))
    }

    /// Position of the axis in program coordinates.
    fn place_along(&self, letter: u8) -> Option<f64> {
        let Some(axis) = self.letters.axis(letter) else { return Some(0.0) };
        let mut places = self.position;
        let slot = places.get_mut(axis)?;
        *slot = slot.saturating_sub(self.offset(axis));
        self.length_along(&places, letter)
    }
}

/// The error for writing a parameter that reports the state.
const READ_ONLY: NcErrorKind =
    NcErrorKind::Known { what: "a value for a parameter that tells the state", hint: "#1 to #4999" };

/// A whole number above 0. `value` may differ from it as far as LinuxCNC permits.
fn number_of(value: f64) -> Option<u32> {
    let whole = real::round(value);
    (real::abs(value - whole) < 1e-4 && (1.0..1e6).contains(&whole)).then_some(whole as u32)
}
