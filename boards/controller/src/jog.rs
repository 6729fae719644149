//! Reads the words of a jog, `$J=`.
use crate::motion::{Jog, Modal};
use crate::number::decimal;
use glidepath::machine::AxisName;
use glidepath::quantity::{Feed, Position};

const LETTER: u8 = 1;
const NUMBER: u8 = 2;
const FORBIDDEN: u8 = 16;
const TWO_OF_A_GROUP: u8 = 21;
const NO_FEED: u8 = 22;
const REPEATED: u8 = 25;
const NO_AXIS: u8 = 26;
const LINE_NUMBER: u8 = 27;

/// Nanometres: the decimals that a word keeps.
const PLACES: u32 = 6;

/// The words of a jog, with lengths in the unit of the line.
#[derive(Clone, Copy)]
struct Words<const AXES: usize> {
    axes: [Option<i64>; AXES],
    feed: Option<i64>,
    inch: Option<bool>,
    incremental: Option<bool>,
    machine: bool,
    has_number: bool,
}

/// Reads the text after `$J=`, in Grbl's form: without blanks, in upper case.
///
/// # Errors
/// Grbl's error number.
pub fn read<const AXES: usize>(
    text: &[u8],
    names: &[AxisName; AXES],
    modal: &Modal,
) -> Result<Jog<AXES>, u8> {
    let mut words = Words {
        axes: [None; AXES],
        feed: None,
        inch: None,
        incremental: None,
        machine: false,
        has_number: false,
    };
    let mut rest = text;
    while let Some((letter, tail)) = rest.split_first() {
        if !letter.is_ascii_uppercase() {
            return Err(LETTER);
        }
        let (value, tail) = decimal(tail, PLACES).ok_or(NUMBER)?;
        words.take(*letter, value, names)?;
        rest = tail;
    }
    let feed = words.feed.ok_or(NO_FEED)?;
    if words.axes.iter().all(Option::is_none) {
        return Err(NO_AXIS);
    }
    let inch = words.inch.unwrap_or(modal.inch);
    // Words have up to 15 digits, so a product with 127 does not overflow.
    let length = |nano: i64| {
        let nano = (i128::from(nano) * if inch { 254 } else { 10 }) << 32;
        // Rounds to nearest, ties away from zero.
        let half = if nano < 0 { -5_000_000 } else { 5_000_000 };
        let bits = (nano + half).checked_div(10_000_000).unwrap_or(0);
        i64::try_from(bits).map(Position::from_bits).map_err(|_| NUMBER)
    };
    let mut axes = [None; AXES];
    for (axis, word) in axes.iter_mut().zip(words.axes) {
        *axis = word.map(length).transpose()?;
    }
    let feed: Feed = length(feed)?;
    if feed <= Feed::ZERO {
        return Err(NO_FEED);
    }
    let incremental = words.incremental.unwrap_or(modal.incremental) && !words.machine;
    Ok(Jog { axes, incremental, machine: words.machine, feed })
}

impl<const AXES: usize> Words<AXES> {
    fn take(&mut self, letter: u8, value: i64, names: &[AxisName; AXES]) -> Result<(), u8> {
        let axis = names.iter().position(|name| name.0 == [letter, 0, 0, 0]);
        if let Some(axis) = axis.and_then(|axis| self.axes.get_mut(axis)) {
            return axis.replace(value).map_or(Ok(()), |_| Err(REPEATED));
        }
        match letter {
            b'F' if value < 0 => Err(4),
            b'F' => self.feed.replace(value).map_or(Ok(()), |_| Err(REPEATED)),
            b'N' if !(0..=9_999_999_000_000).contains(&value) => Err(LINE_NUMBER),
            b'N' if self.has_number => Err(REPEATED),
            b'N' => {
                self.has_number = true;
                Ok(())
            }
            b'G' => match value {
                20_000_000 | 21_000_000 => {
                    let inch = value == 20_000_000;
                    self.inch.replace(inch).map_or(Ok(()), |_| Err(TWO_OF_A_GROUP))
                }
                90_000_000 | 91_000_000 => {
                    let ways = value == 91_000_000;
                    self.incremental.replace(ways).map_or(Ok(()), |_| Err(TWO_OF_A_GROUP))
                }
                53_000_000 if self.machine => Err(TWO_OF_A_GROUP),
                53_000_000 => {
                    self.machine = true;
                    Ok(())
                }
                _ => Err(FORBIDDEN),
            },
            _ => Err(FORBIDDEN),
        }
    }
}
