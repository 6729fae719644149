//! Reads plain lines in one pass: lines of N, G00 or G01, F and axis words alone, with decimals directly
//! after the letters.
//!
//! Most lines of most programs are plain. If a line contains other text or an error,
//! [`Interpreter::plain_block`] changes nothing. Then `block.rs` and `compose.rs` read or refuse the line.
use super::compose::{carry, in_range};
use super::cursor::Cursor;
use super::interpreter::{Gathered, Interpreter};
use super::line::Line;
use super::modal::{Before, COORDINATE_MAX, Mode};
use super::number::Factor;
use super::{Motion, MotionKind};
use crate::quantity::{Feed, Position};
use core::cell::Cell;

/// Cost of a word, in the unit of [`super::calculator`].
const WORD: u32 = 2;

/// The largest coordinate.
const MAX: Position = Position::const_from_int(COORDINATE_MAX as i64);

/// Number of axes that this file distinguishes.
const MOST_AXES: u8 = 32;

/// Letters of the alphabet.
const LETTERS: usize = 26;

/// The axis that a single letter names, by letter. If the letter also begins the name of another axis, it is
/// left out.
pub(super) struct Letters([u8; LETTERS]);

impl Letters {
    /// All bits zero.
    pub const BLANK: Self = Self([0; LETTERS]);

    /// The table for these axis names.
    pub fn new<'a>(names: impl Iterator<Item = &'a [u8; 4]> + Clone) -> Self {
        let mut letters = [u8::MAX; LETTERS];
        for (slot, letter) in letters.iter_mut().zip(b'A'..) {
            let mut named = names.clone().zip(0..MOST_AXES).filter(|(name, _)| name[0] == letter);
            if let (Some(([_, 0, ..], axis)), None) = (named.next(), named.next()) {
                *slot = axis;
            }
        }
        Self(letters)
    }

    pub fn axis(&self, letter: u8) -> Option<usize> {
        let axis = self.0.get(usize::from(letter.wrapping_sub(b'A')))?;
        (*axis != u8::MAX).then_some(usize::from(*axis))
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// The target of an axis for a plain coordinate; `to` is the previous target. Returns `None` if the
    /// coordinate is not plain. `rest`: rounding remainder.
    #[cfg_attr(feature = "fast", inline(always))]
    fn plain_coordinate(
        &self,
        c: &mut Cursor<'_>,
        axis: usize,
        (to, rest): (Position, &mut i32),
    ) -> Option<Position> {
        let sign = c.raw();
        if matches!(sign, b'-' | b'+') {
            c.bump();
        }
        let (decimal, factor) = (c.plain_decimal()?, self.axis_factor(axis));
        #[cfg(feature = "fanuc")]
        if self.counts_increments(c, &decimal) {
            return None;
        }
        let bits = decimal.bits(factor)?;
        if bits > MAX.to_bits() {
            return None;
        }
        let value = Position::from_bits(if sign == b'-' { -bits } else { bits });
        let from = if self.modal.relative {
            let left = decimal.rest(factor, bits);
            to.wrapping_add(carry(rest, if sign == b'-' { -left } else { left }))
        } else {
            *rest = 0;
            self.offset(axis)
        };
        // Three coordinates cannot overflow.
        let slot = value.wrapping_add(from);
        in_range(slot).then_some(slot)
    }

    /// The feed of a plain F. Returns `None` if it is not plain.
    #[inline(always)]
    fn plain_feed(&self, c: &mut Cursor<'_>) -> Option<Feed> {
        let decimal = c.plain_decimal()?;
        #[cfg(feature = "fanuc")]
        if self.modal.inch && self.counts_increments(c, &decimal) {
            return None;
        }
        let bits = decimal.bits(self.feed_factor())?;
        (bits != 0).then(|| Feed::from_bits(bits))
    }

    /// Carries out a plain block with a motion; the caller then returns this motion. Returns `None`, and
    /// changes nothing, if the line is not plain.
    #[inline(never)]
    pub fn plain_block(&mut self, line: &Line) -> Option<()> {
        let mut c = Cursor::new(line.bytes());
        let (mut n, mut mode, mut feed, mut first) = (0, None, None, None);
        let (mut target, mut rests) = (self.position, self.rests);
        let mut given = 0;
        let mut work = 0;
        loop {
            let mark = c.mark_at_once();
            let letter = c.raw().to_ascii_uppercase();
            if letter == 0 {
                break;
            }
            c.bump();
            match letter {
                b'N' if work == 0 => n = c.plain_whole()?,
                b'G' if mode.is_none() => {
                    let of = match c.plain_whole()? {
                        0 => Mode::Rapid,
                        1 => Mode::Line,
                        _ => return None,
                    };
                    mode = Some((of, c.word_from(mark)));
                }
                b'F' if feed.is_none() => feed = Some(self.plain_feed(&mut c)?),
                _ => {
                    let axis = self.letters.axis(letter)?;
                    let bit = 1_u32.wrapping_shl(axis as u32);
                    let (slot, rest) = (target.get_mut(axis)?, rests.get_mut(axis)?);
                    *slot = self.plain_coordinate(&mut c, axis, (*slot, rest))?;
                    if given & bit != 0 {
                        return None;
                    }
                    given |= bit;
                    if first.is_none() {
                        first = Some(c.word_from(mark));
                    }
                }
            }
            work += WORD;
        }
        let g = mode.map(|(_, span)| span);
        let mode = mode.map_or(self.modal.mode, |(mode, _)| mode);
        let feed = feed.or(self.modal.feed);
        let first = first?;
        let kind = match mode {
            Mode::Rapid => MotionKind::Rapid,
            Mode::Line | Mode::Unprogrammed | Mode::UnprogrammedTold
                if feed.is_some() || target == self.position =>
            {
                MotionKind::Line
            }
            _ => return None,
        };
        let place = line.place(g.filter(|g| g.at < first.at).unwrap_or(first));
        self.gathered = Gathered::Motion(Cell::new(Motion {
            n,
            place,
            centre: place,
            kind,
            target,
            feed: feed.unwrap_or(Feed::ZERO),
            exact_stop: self.modal.exact_stop,
            named: given,
        }));
        (self.position, self.rests) = (target, rests);
        self.n = n;
        self.moves = true;
        self.before = Before::Feed(self.modal.mode, self.modal.feed);
        self.modal.mode = mode;
        self.modal.feed = feed;
        self.calculator.charge(work);
        Some(())
    }

    /// Factor from F to mm/min (°/min): P-CHAN-00108, or in other dialects the length unit.
    pub fn feed_factor(&self) -> Factor {
        #[cfg(feature = "grbl")]
        if !self.is_isg() {
            return self.length_factor();
        }
        Factor::new(100_000, self.setup.feedrate_factor_milli.max(1))
    }
}
