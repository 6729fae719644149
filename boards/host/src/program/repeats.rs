//! Detects endless programs: counts commands of lines that are carried out again.
use glidepath::nc::Place;

/// More commands than one line can have.
const LINE: u32 = 64;

/// Counts the commands of repeated lines, so that a program counts as endless by its repeats and not by its
/// length.
#[derive(Default)]
pub struct Repeats {
    /// Offsets of the commands so far, one bit per byte of a file: an eighth of its text.
    seen: Vec<Vec<u64>>,
    last: Option<(u16, u32)>,
    /// Whether the current line is carried out for the first time.
    is_new: bool,
    /// Number of consecutive commands at the current place.
    row: u32,
    count: u64,
}

impl Repeats {
    /// Records a command. Returns the number of repeated commands so far.
    pub fn add(&mut self, place: Place) -> u64 {
        let here = (place.file, place.offset);
        if self.last == Some(here) {
            // Either commands of one line, or of a loop of one line.
            self.row += 1;
        } else {
            (self.last, self.row) = (Some(here), 1);
            self.is_new = self.mark(here);
        }
        self.count += u64::from(!self.is_new || self.row > LINE);
        self.count
    }

    /// Whether this is the first command at this place.
    fn mark(&mut self, (file, offset): (u16, u32)) -> bool {
        let (file, word, bit) = (usize::from(file), offset as usize / 64, 1_u64 << (offset % 64));
        if self.seen.len() <= file {
            self.seen.resize_with(file + 1, Vec::new);
        }
        let words = &mut self.seen[file];
        if words.len() <= word {
            words.resize((word + 1).max(2 * words.len()), 0);
        }
        let is_new = words[word] & bit == 0;
        words[word] |= bit;
        is_new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_programs_are_not_endless_and_loops_are_counted() {
        let place = |offset| Place { offset, ..Place::NONE };
        let mut repeats = Repeats::default();
        // Three commands per line.
        assert!((0..1_500_000).all(|i| repeats.add(place(10 * (i / 3))) == 0));
        // Back to a line, and twice over two.
        let again = [30, 30, 40, 50, 40, 50].map(|offset| repeats.add(place(offset)));
        assert_eq!(again, [1, 2, 3, 4, 5, 6]);
        // A loop of one line.
        let mut repeats = Repeats::default();
        let last = (0..1000).map(|_| repeats.add(place(7))).last();
        assert_eq!(last, Some(1000 - u64::from(LINE)));
    }
}
