//! G7 and G8: a programmed X is a diameter or a radius.
use super::block::Block;
use super::words::{Meaning, group};
use crate::nc::interpreter::Interpreter;
use crate::nc::number::Number;
use crate::nc::{Fault, NcErrorKind};

/// Most digits after the decimal point of a halved number.
const PLACES: u8 = 19;

/// Half of a number. The result is exact if the digits suffice.
fn half(number: Number) -> Number {
    match number {
        Number::Decimal { negative, mantissa, scale } if scale < PLACES => match mantissa.checked_mul(5) {
            Some(mantissa) => Number::Decimal { negative, mantissa, scale: scale + 1 },
            None => Number::Real(number.real() / 2.0),
        },
        _ => Number::Real(number.real() / 2.0),
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Halves X words while G7 is in force, because they are diameters. A word that changes the mode must not
    /// be in a block with X. LinuxCNC reads X in the mode before the block, but grblHAL in the mode after the
    /// block.
    pub(super) fn take_diameter(&self, block: &mut Block<AXES>) -> Result<(), Fault> {
        let now = self.modal.diameter;
        let changes = block.said(group::LATHE).filter(|said| said.word.meaning != Meaning::Diameter(now));
        let axis = self.letters.axis(b'X');
        let Some(given) = axis.and_then(|axis| block.axes.get_mut(axis)).and_then(Option::as_mut) else {
            return Ok(());
        };
        if let Some(said) = changes {
            return said.span.fault(NcErrorKind::Conflict("X: LinuxCNC and grblHAL read it otherwise"));
        }
        if now {
            given.number = half(given.number);
        }
        Ok(())
    }
}
