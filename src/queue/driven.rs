//! How far the feed axes have really moved since the start, for the operator (feature `driven`). This length
//! is called travel here.
//!
//! On a line or an arc, the path distance is the travel of the feed axes. In a curve that is planned over
//! time, the path distance is time multiplied by the feed, and the axes move less. So each curve has a
//! [`Drive`]. A [`Drive`] stores the travel at the start, in the middle and at the end of the curve. It also
//! stores how much the travel grows there with the path distance.
//!
//! In each half of the curve, the travel is the cubic polynomial with these values at both ends. If a curve
//! over time brakes on a straight line, the result is exact, because the axes follow a cubic there. The
//! interrupt does no work for this. A reader finds the current curve from the number of curves that the
//! interrupt has passed.
//!
//! With the feature `plc`, [`super::arc_length`] replaces the cubics by the length of the curve itself.
#[cfg(feature = "plc")]
pub(super) use super::arc_length::{Drive, WORDS};
#[cfg(not(feature = "plc"))]
use crate::math::float::{max, min, to_f32, to_i64};
#[cfg(not(feature = "plc"))]
use crate::path::{Measure, Shape};
#[cfg(not(feature = "plc"))]
use crate::quantity::Position;
use core::sync::atomic::{AtomicU32, Ordering};

/// Number of words in a [`Drive`].
#[cfg(not(feature = "plc"))]
const WORDS: usize = 10;

/// Weights of the slopes at the ends of eight parts of a curve, for the mean of each half (Boole's rule).
#[cfg(not(feature = "plc"))]
const WEIGHTS: [[f32; 2]; 9] = [
    [7.0, 0.0],
    [32.0, 0.0],
    [12.0, 0.0],
    [32.0, 0.0],
    [7.0, 7.0],
    [0.0, 32.0],
    [0.0, 12.0],
    [0.0, 32.0],
    [0.0, 7.0],
];
#[cfg(not(feature = "plc"))]
const PARTS: i64 = WEIGHTS.len() as i64 - 1;
#[cfg(not(feature = "plc"))]
const WHOLE: f32 = 90.0;

/// The driven distance of one curve as a function of its path distance, LSB 2^-44 mm.
#[cfg(not(feature = "plc"))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Drive {
    /// Path distance at the start of the curve.
    start: i64,
    /// Driven distance at the start of the curve.
    driven: i64,
    /// Half of the path length, mm; 0 if driven distance and path distance grow equally.
    half: f32,
    /// Driven length of each half, mm.
    travel: [f32; 2],
    /// Travel per path distance at the start, in the middle and at the end.
    slopes: [f32; 3],
}

#[cfg(not(feature = "plc"))]
impl Drive {
    /// For a curve whose driven distance equals its path distance.
    pub const fn plain(start: i64, driven: i64) -> Self {
        Self { start, driven, half: 0.0, travel: [0.0; 2], slopes: [1.0; 3] }
    }

    /// The drive of a curve. `start` and `driven`: path distance and driven distance at the start of the
    /// curve.
    #[inline(never)]
    pub fn of<const AXES: usize>(
        (shape, base): (&Shape<AXES>, &[Position; AXES]),
        measure: &Measure,
        [start, driven]: [i64; 2],
    ) -> Self {
        let length = shape.length.to_bits();
        // As in [`super::cells::Track::slope`]: 12 bits or more.
        let by = (length >> 10).max((length >> 4).min(1 << 30)).max(1);
        let scale = 1.0 / to_f32(2 * by);
        let half = 0.5 * to_f32(length);
        let (mut travel, mut slopes) = ([0.0; 2], [0.0; 3]);
        for (k, weights) in (0..).zip(WEIGHTS) {
            let at = (length / PARTS).wrapping_mul(k).wrapping_add(length % PARTS * k / PARTS);
            let [from, to] = [at.wrapping_sub(by), at.wrapping_add(by)].map(|at| shape.placed(at, base));
            let mut chord = [0i64; AXES];
            for ((chord, from), to) in chord.iter_mut().zip(&from).zip(&to) {
                *chord = to.to_bits().wrapping_sub(from.to_bits());
            }
            let slope = to_f32(measure.path(&chord).to_bits()) * scale;
            for (travel, weight) in travel.iter_mut().zip(weights) {
                *travel += weight / WHOLE * half * slope;
            }
            if k % (PARTS / 2) == 0
                && let Some(kept) = slopes.get_mut((k / (PARTS / 2)) as usize)
            {
                *kept = slope;
            }
        }
        Self { start, driven, half, travel, slopes }
    }

    /// The driven distance at a path distance inside the curve.
    pub fn at(&self, distance: i64) -> i64 {
        let along = distance.wrapping_sub(self.start);
        let Self { half, travel: [first, second], slopes: [s0, s1, s2], .. } = *self;
        if half == 0.0 {
            return self.driven.wrapping_add(along);
        }
        let part = max(0.0, min(2.0, to_f32(along) / half));
        let gone = if part <= 1.0 {
            cubic(part, first, [s0 * half, s1 * half])
        } else {
            first + cubic(part - 1.0, second, [s1 * half, s2 * half])
        };
        self.driven.wrapping_add(to_i64(gone))
    }

    /// The driven distance at the end of a curve with this path length.
    pub fn end(&self, length: i64) -> i64 {
        self.at(self.start.wrapping_add(length))
    }

    const fn to_words(self) -> [u32; WORDS] {
        let Self { start, driven, half, travel: [first, second], slopes: [s0, s1, s2] } = self;
        [
            start as u32,
            (start >> 32) as u32,
            driven as u32,
            (driven >> 32) as u32,
            half.to_bits(),
            first.to_bits(),
            second.to_bits(),
            s0.to_bits(),
            s1.to_bits(),
            s2.to_bits(),
        ]
    }

    const fn of_words([a, b, c, d, half, first, second, s0, s1, s2]: [u32; WORDS]) -> Self {
        Self {
            start: ((b as u64) << 32 | a as u64) as i64,
            driven: ((d as u64) << 32 | c as u64) as i64,
            half: f32::from_bits(half),
            travel: [f32::from_bits(first), f32::from_bits(second)],
            slopes: [f32::from_bits(s0), f32::from_bits(s1), f32::from_bits(s2)],
        }
    }
}

/// The cubic over 0 to 1 from 0 to `travel` with these slopes at both ends; the result is between 0 and
/// `travel`.
#[cfg(not(feature = "plc"))]
fn cubic(part: f32, travel: f32, [first, last]: [f32; 2]) -> f32 {
    let (square, cube) = (3.0 * travel - 2.0 * first - last, first + last - 2.0 * travel);
    max(0.0, min(travel, part * (first + part * (square + part * cube))))
}

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
