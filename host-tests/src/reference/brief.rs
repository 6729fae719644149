//! How fast short blocks may follow each other: 31 in a row take a tick at least.
//!
//! A block is short if it may be passed in less than the 20th part of a tick, with any override. It then
//! takes
//!
//! - next to nothing, if it is shorter than an eighth of the last one that did not, if at most ten of the
//!   thirty before it did, and if none of them took less than a 20th part otherwise;
//! - else the 20th part of a tick, if one of the thirty before it took next to nothing;
//! - else the 31st part.

/// Blocks looked back at.
const BEFORE: usize = 30;
/// Of 31 blocks so many may take next to nothing.
const MOST_BRIEF: usize = 11;
/// Lengths per tick.
const ALL: f64 = 31.0;
const OTHERS: f64 = 20.0;
const BRIEF: f64 = 262_144.0;

/// How a block is held.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Not, or with the 20th part of a tick.
    Slow,
    /// With the 31st part.
    Quick,
    /// It takes next to nothing.
    Brief,
}

/// All blocks up to the last one.
#[derive(Clone, Debug, Default)]
pub struct Row {
    kinds: Vec<Kind>,
    /// Of the last one that is not brief; none yet.
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
