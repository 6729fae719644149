//! Values of P parameters, of `#` parameters from `#31` on, and of `V.P.` and `V.L.` variables: a sorted
//! table with room for 128 values.
use super::NcErrorKind;
use crate::machine::functions;
use heapless::Vec;

/// Largest number of parameters with a value.
pub const PARAMETERS: usize = functions::EXPRESSIONS.room(128);

/// A parameter with its value. Packed to save memory, because there are many entries.
#[derive(Clone, Copy)]
#[repr(C, packed(4))]
struct Entry {
    index: u32,
    value: f64,
}

/// Values of the P parameters written so far.
pub(super) struct Parameters {
    entries: Vec<Entry, PARAMETERS>,
}

impl Parameters {
    pub const fn new() -> Self {
        Self { entries: Vec::new() }
    }

    /// Removes all values.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Removes the values of the parameters with an index from `first` to `last`.
    #[cfg(any(feature = "grbl", feature = "plc"))]
    pub fn forget(&mut self, first: u32, last: u32) {
        self.entries.retain(|entry| !(first..=last).contains(&{ entry.index }));
    }

    /// The value of a parameter.
    pub fn get(&self, index: u32) -> Result<f64, NcErrorKind> {
        let found = self.entries.binary_search_by_key(&index, |e| e.index);
        found
            .ok()
            .and_then(|at| self.entries.get(at))
            .map(|e| e.value)
            .ok_or(NcErrorKind::ParameterUnset(index))
    }

    /// Writes a parameter.
    pub fn set(&mut self, index: u32, value: f64) -> Result<(), NcErrorKind> {
        match self.entries.binary_search_by_key(&index, |e| e.index) {
            Ok(at) => {
                if let Some(entry) = self.entries.get_mut(at) {
                    entry.value = value;
                }
                Ok(())
            }
            Err(at) => {
                // Shifts the tail by one: at most PARAMETERS moves.
                let mut entry = Entry { index, value };
                for slot in self.entries.iter_mut().skip(at) {
                    core::mem::swap(slot, &mut entry);
                }
                self.entries.push(entry).map_err(|_| NcErrorKind::TooManyParameters)
            }
        }
    }
}

/// A parameter index from the result of an expression: a whole number above 0; a fraction is cut off.
pub(super) fn index(value: f64) -> Result<u32, NcErrorKind> {
    // V.P. and V.L. use this index and all larger ones.
    #[cfg(feature = "plc")]
    if value >= f64::from(super::variable::NAMED) {
        return Err(NcErrorKind::ParameterIndex);
    }
    if (1.0..4e9).contains(&value) { Ok(value as u32) } else { Err(NcErrorKind::ParameterIndex) }
}
