//! Converts port words to the levels of pins, for receivers that take levels: a simulator, a shift register,
//! a PIO.
/// The levels of the pins of a port.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Levels(pub u16);

impl Levels {
    /// The levels after a word.
    #[must_use]
    pub const fn behind(self, word: u32) -> Self {
        let (set, reset) = (word as u16, (word >> 16) as u16);
        // If both bits are set, BSRR sets the pin.
        Self(self.0 & !reset | set)
    }

    /// Whether the pin is high.
    pub const fn is_high(self, bit: u8) -> bool {
        self.0 & 1 << (bit & 15) != 0
    }
}
