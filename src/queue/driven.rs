//! How far the feed axes have really moved since the start, for the operator (feature `driven`). This length
//! is called travel here.
//!
//! On a line or an arc, the path distance is the travel of the feed axes. In a curve that is planned over
//! time, the path distance is time multiplied by the feed, and the axes move less. So each curve has a
//! [`Drive`]: the length of the curve itself (`arc_length.rs`). The interrupt does no work for this. A reader
//! finds the current curve from the number of curves that the interrupt has passed.
pub(super) use super::arc_length::{Drive, WORDS};
use core::sync::atomic::{AtomicU32, Ordering};

/// A drive in memory. The planner writes it before the interrupt can reach its curve.
pub(super) struct Kept([AtomicU32; WORDS]);

impl Kept {
    pub const fn new() -> Self {
        Self([const { AtomicU32::new(0) }; WORDS])
    }
}

/// The drives of all curves in a ring. The number of a curve, from 0 since `Rings::split`, selects its drive.
#[derive(Clone, Copy)]
pub(super) struct Drives<'a> {
    kept: &'a [Kept],
    /// Number of curves that the interrupt has passed.
    taken: &'a AtomicU32,
}

impl<'a> Drives<'a> {
    /// Drives (driven distances of curves) stored in `kept`, which has at least as many places as the ring
    /// has slots.
    pub const fn new(kept: &'a [Kept], taken: &'a AtomicU32) -> Self {
        Self { kept, taken }
    }

    /// Resets all drives: driven distance equals path distance.
    pub fn clear(&self) {
        for number in 0..self.kept.len() as u32 {
            self.set(number, &Drive::plain(0, 0));
        }
    }

    fn place(&self, number: u32) -> Option<&'a Kept> {
        let index = number.checked_rem(self.kept.len() as u32)?;
        self.kept.get(index as usize)
    }

    /// Writes the drive of the curve with this number.
    pub fn set(&self, number: u32, drive: &Drive) {
        if let Some(Kept(words)) = self.place(number) {
            words.iter().zip(drive.to_words()).for_each(|(word, value)| word.store(value, Ordering::Relaxed));
        }
    }

    /// The drive of the curve with this number.
    pub fn get(&self, number: u32) -> Drive {
        let Some(Kept(kept)) = self.place(number) else { return Drive::plain(0, 0) };
        let mut words = [0; WORDS];
        words.iter_mut().zip(kept).for_each(|(value, word)| *value = word.load(Ordering::Relaxed));
        Drive::of_words(words)
    }

    /// Driven distance at a path distance on the interrupt's current curve.
    pub fn at(&self, distance: i64) -> i64 {
        self.get(self.taken.load(Ordering::Acquire)).at(distance)
    }
}
