//! How fast short blocks may follow each other: 31 consecutive blocks take at least one tick.
//!
//! A block is short if it may be passed in less than the 20th part of a tick, with any override. A short
//! block then takes
//!
//! - next to nothing, if it is shorter than an eighth of the last one that did not, if at most ten of the
//!   thirty before it did, and if none of them took less than a 20th part otherwise;
//! - else the 20th part of a tick, if one of the thirty before it took next to nothing;
//! - else the 31st part.

/// Number of earlier blocks that count.
const BEFORE: usize = 30;
/// Number of blocks among 31 that may take next to nothing.
const MOST_BRIEF: usize = 11;
/// Lengths per tick.
const ALL: f64 = 31.0;
const OTHERS: f64 = 20.0;
const BRIEF: f64 = 262_144.0;

/// The minimum time of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// None, or the 20th part of a tick.
    Slow,
    /// With the 31st part.
    Quick,
    /// Next to nothing.
    Brief,
}

/// State of all blocks up to the last one.
#[derive(Clone, Debug, Default)]
pub struct Row {
    kinds: Vec<Kind>,
    /// Length of the last block that is not brief; none yet.
    length: Option<f64>,
}

impl Row {
    /// Whether the last block takes next to nothing.
    pub fn is_brief(&self) -> bool {
        self.kinds.last() == Some(&Kind::Brief)
    }

    /// The highest speed of the next block, which any override could make as fast as `highest`.
    pub fn take(&mut self, length: f64, highest: f64) -> f64 {
        let before = &self.kinds[self.kinds.len().saturating_sub(BEFORE)..];
        let number = |kind| before.iter().filter(|k| **k == kind).count();
        let (brief, quick) = (number(Kind::Brief), number(Kind::Quick));
        let far_shorter = self.length.is_none_or(|last| length < last / 8.0);
        let (kind, most) = if highest <= OTHERS * length {
            (Kind::Slow, f64::INFINITY)
        } else if quick == 0 && brief < MOST_BRIEF && far_shorter {
            (Kind::Brief, BRIEF * length)
        } else if brief > 0 {
            (Kind::Slow, OTHERS * length)
        } else {
            (Kind::Quick, ALL * length)
        };
        self.kinds.push(kind);
        if kind != Kind::Brief {
            self.length = Some(length);
        }
        most
    }
}
