//! Rules of Fanuc's controllers that the other dialects do not have: numbers without a decimal point, and
//! words with another meaning, for example X of G4 and P of M98.
use super::block::Block;
use super::words::{Meaning, group};
use crate::machine::AxisKind;
use crate::nc::block::Given;
#[cfg(feature = "fanuc")]
use crate::nc::cursor::Cursor;
use crate::nc::interpreter::Interpreter;
use crate::nc::line::Line;
use crate::nc::number::Number;
#[cfg(feature = "fanuc")]
use crate::nc::number::Plain;
use crate::nc::{Fault, NcErrorKind, NcWarningKind, Span};

/// Moves the decimal point `places` digits to the left.
fn shift(given: &mut Given, places: u8) -> bool {
    match &mut given.number {
        Number::Decimal { mantissa, scale: scale @ 0, .. } => {
            *scale = places;
            *mantissa != 0
        }
        _ => false,
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Whether a plain number before the cursor counts in the least increment: it is not 0, and has no decimal
    /// point. Blocks with such numbers take the slow path of the decoder.
    #[cfg(feature = "fanuc")]
    #[inline(always)]
    pub fn counts_increments(&self, c: &Cursor<'_>, number: &Plain) -> bool {
        let is_whole = number.scale == 0 && number.mantissa != 0;
        is_whole && self.setup.foreign.dialect().is_fanuc() && !c.is_behind_point()
    }

    /// Converts numbers without a decimal point: lengths count in 0.001 mm or 0.0001 inch, angles in 0.001
    /// degrees. `inch`: unit of the block.
    pub(super) fn least_increments(&mut self, block: &mut Block<AXES>, inch: bool, line: &Line) {
        if !self.setup.foreign.dialect().is_fanuc() || block.pointless == 0 {
            return;
        }
        let places = if inch { 4 } else { 3 };
        let dwells = block.said(group::NON_MODAL).is_some_and(|said| said.word.meaning == Meaning::Dwell);
        let motion = block.said(group::MOTION).map(|said| said.word.meaning);
        let drills = match motion {
            Some(motion) => matches!(motion, Meaning::Cycle(_)),
            None => self.foreign.now.cycle.is_some() && block.said(group::CYCLE_END).is_none(),
        };
        let mode = block.said(group::ONCE).is_some_and(|said| said.word.meaning == Meaning::Mode);
        let mut told: Option<Span> = None;
        for letter in b'A'..=b'Z' {
            if !block.is_pointless(letter) {
                continue;
            }
            let places = match letter {
                b'I' | b'J' | b'R' => places,
                b'K' if !drills => places,
                b'Q' if !mode => places,
                b'F' if self.foreign.now.by_time => continue,
                b'F' if self.foreign.now.per_turn => places - if inch { 0 } else { 1 },
                b'F' if inch => 2,
                // P and X of G4 count milliseconds.
                b'A'..=b'C' | b'U'..=b'Z' if !dwells => places,
                _ => continue,
            };
            let axis = self.letters.axis(letter);
            let rotary = axis.and_then(|axis| self.setup.kinds.get(axis)) == Some(&AxisKind::Rotary);
            let slot = match axis {
                Some(axis) => block.axes.get_mut(axis).and_then(Option::as_mut),
                None => block.value_mut(letter),
            };
            if let Some(given) = slot
                && shift(given, if rotary { 3 } else { places })
            {
                told = told.or(Some(given.span));
            }
        }
        if let (Some(span), false) = (told, self.foreign.told_increments) {
            self.foreign.told_increments = true;
            self.warn(line, span, NcWarningKind::LeastIncrement);
        }
    }

    /// Drops letters that Fanuc accepts without effect: D without G41, and H0.
    pub(super) fn drop_unused(&mut self, block: &mut Block<AXES>) {
        if !self.setup.foreign.dialect().is_fanuc() {
            return;
        }
        let _ = block.take(b'D');
        if block.value(b'H').is_some_and(|given| given.number.real() == 0.0) {
            let _ = block.take(b'H');
        }
        if block.said(group::ONCE).is_some_and(|said| said.word.meaning == Meaning::Mode) {
            let _ = (block.take(b'P'), block.take(b'Q'), block.take(b'E'));
        }
    }

    /// Checks P of G30. Only P2 is possible, which means the same as no P.
    pub(super) fn second_place(&self, place: u8, block: &mut Block<AXES>) -> Result<(), Fault> {
        if place == 0 || !self.setup.foreign.dialect().is_fanuc() {
            return Ok(());
        }
        match block.take(b'P') {
            Some(given) if given.number.real() != 2.0 => {
                let what = "third and further reference points";
                given.span.fault(NcErrorKind::Known { what, hint: "G30 P2" })
            }
            _ => Ok(()),
        }
    }

    /// X or U of G4, and whether the value counts milliseconds.
    pub(super) fn dwell_by_axis(&self, block: &mut Block<AXES>) -> Option<(Given, bool)> {
        if !self.setup.foreign.dialect().is_fanuc() {
            return None;
        }
        for letter in [b'X', b'U'] {
            let given = match self.letters.axis(letter) {
                Some(axis) => block.axes.get_mut(axis).and_then(Option::take),
                None => block.take(letter),
            };
            if let Some(given) = given {
                if block.axes.iter().all(Option::is_none) {
                    block.first = None;
                }
                return Some((given, block.is_pointless(letter)));
            }
        }
        None
    }

    /// Splits P of M98 into the number of the program (last four digits) and the number of calls (digits
    /// before).
    pub(super) const fn called_by(number: u32) -> (u32, u32) {
        let (times, program) = (number / 10_000, number % 10_000);
        (program, if times == 0 { 1 } else { times })
    }
}
