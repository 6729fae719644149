//! The distance that the axes have driven inside a curve, as the length of the curve itself (feature `driven`).
//!
//! Each curve has a [`Drive`]: its driven length, and the square of the driven speed over its path distance
//! ([`Shape::squared_speed`]). The length up to a point is the integral of the speed, divided by the integral over the
//! whole curve. So the ends are exact, and rounding stays below 2^-20 of the curve's length inside.
//!
//! A reader integrates a quarter of the curve at most, in [`PANELS`] panels. The planner stores the share of the length
//! at the end of each quarter. Inside a panel the speed counts as linear in each half, so the length never decreases.
use crate::math::float::{max, min, to_f32, to_i64};
use crate::math::root::sqrt_f32;
use crate::path::speed::SQUARED;
use crate::path::{Measure, Shape};
use crate::quantity::Position;

/// Number of words in a [`Drive`].
pub const WORDS: usize = 20;

/// Number of chords for the length of a curve. With half this number, the error is about four times as large.
const CHORDS: i64 = 64;

/// Number of panels in a quarter of a curve.
const PANELS: u8 = 8;

/// Width of a panel, as a part of the curve.
const WIDTH: f32 = 0.25 / PANELS as f32;

/// Points and weights of Gauss's rule for a panel of width 1.
const RULE: [(f32, f32); 3] = [(0.112_701_67, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_35, 5.0 / 18.0)];

/// The driven distance of one curve over its path distance, LSB 2^-44 mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drive {
    /// Path distance at the start of the curve.
    start: i64,
    /// Driven distance at the start of the curve.
    driven: i64,
    /// Path length of the curve; 0 if driven distance and path distance grow equally.
    length: i64,
    /// Driven length of the curve.
    travel: i64,
    /// Share of the driven length up to the end of the first three quarters.
    quarters: [f32; 3],
    /// The square of the driven speed.
    squared: [f32; SQUARED],
}

impl Drive {
    /// The drive of a curve whose driven distance equals its path distance.
    pub const fn plain(start: i64, driven: i64) -> Self {
        Self { start, driven, length: 0, travel: 0, quarters: [0.0; 3], squared: [0.0; SQUARED] }
    }

    /// The drive of a curve. `start` and `driven`: path distance and driven distance at the start of the
    /// curve.
    #[inline(never)]
    pub fn of<const AXES: usize>(
        (shape, base): (&Shape<AXES>, &[Position; AXES]),
        measure: &Measure,
        [start, driven]: [i64; 2],
    ) -> Self {
        let (length, travel) = (shape.length.to_bits(), chords(shape, base, measure));
        let squared = shape.squared_speed(measure);
        let mut sums = [0.0; 4];
        let mut sum = 0.0;
        for (to, from) in sums.iter_mut().zip([0.0, 0.25, 0.5, 0.75]) {
            for panel in 0..PANELS {
                sum += panel_of(&squared, from + WIDTH * f32::from(panel));
            }
            *to = sum;
        }
        let [first, second, third, _] = sums;
        // Without any speed, the length grows evenly.
        let quarters = if sum > 0.0 { [first / sum, second / sum, third / sum] } else { [0.25, 0.5, 0.75] };
        Self { start, driven, length, travel, quarters, squared }
    }

    /// The driven distance at a path distance inside the curve.
    pub fn at(&self, distance: i64) -> i64 {
        let along = distance.wrapping_sub(self.start);
        if self.length == 0 {
            return self.driven.wrapping_add(along);
        }
        if along >= self.length {
            return self.driven.wrapping_add(self.travel);
        }
        let part = max(0.0, to_f32(along) / to_f32(self.length));
        let gone = to_i64(to_f32(self.travel) * self.share(part));
        self.driven.wrapping_add(gone.min(self.travel))
    }

    /// Share of the driven length up to a part of the path length, 0 to 1.
    fn share(&self, part: f32) -> f32 {
        let [first, second, third] = self.quarters;
        let (from, lower, upper) = if part < 0.25 {
            (0.0, 0.0, first)
        } else if part < 0.5 {
            (0.25, first, second)
        } else if part < 0.75 {
            (0.5, second, third)
        } else {
            (0.75, third, 1.0)
        };
        let inside = min(1.0, (part - from) / WIDTH / f32::from(PANELS));
        let panels = inside * f32::from(PANELS);
        let (mut sum, mut before) = (0.0, 0.0);
        for panel in 0..PANELS {
            let at = from + WIDTH * f32::from(panel);
            let made = panel_of(&self.squared, at);
            let rest = panels - f32::from(panel);
            if rest >= 1.0 {
                before += made;
            } else if rest > 0.0 {
                before += made * self.inside(at, rest);
            }
            sum += made;
        }
        let share = if sum > 0.0 { min(1.0, before / sum) } else { inside };
        min(upper, lower + (upper - lower) * share)
    }

    /// Share of the length of the panel that begins at `at`, up to a part of the panel.
    fn inside(&self, at: f32, part: f32) -> f32 {
        let [first, second, third] = [0.0, 0.5 * WIDTH, WIDTH].map(|by| speed(&self.squared, at + by));
        let whole = 0.25 * (first + 2.0 * second + third);
        let gone = if part <= 0.5 {
            part * (first + (second - first) * part)
        } else {
            let rest = part - 0.5;
            0.25 * (first + second) + rest * (second + (third - second) * rest)
        };
        if whole > 0.0 { min(1.0, gone / whole) } else { part }
    }

    /// The driven distance at the end of a curve with this path length.
    pub fn end(&self, length: i64) -> i64 {
        self.at(self.start.wrapping_add(length))
    }

    pub const fn to_words(self) -> [u32; WORDS] {
        let Self { start, driven, length, travel, quarters: [q0, q1, q2], squared } = self;
        let [s0, s1, s2, s3, s4, s5, s6, s7, s8] = squared;
        [
            start as u32,
            (start >> 32) as u32,
            driven as u32,
            (driven >> 32) as u32,
            length as u32,
            (length >> 32) as u32,
            travel as u32,
            (travel >> 32) as u32,
            q0.to_bits(),
            q1.to_bits(),
            q2.to_bits(),
            s0.to_bits(),
            s1.to_bits(),
            s2.to_bits(),
            s3.to_bits(),
            s4.to_bits(),
            s5.to_bits(),
            s6.to_bits(),
            s7.to_bits(),
            s8.to_bits(),
        ]
    }

    pub fn of_words(words: [u32; WORDS]) -> Self {
        let [a, b, c, d, e, f, g, h, q0, q1, q2, s0, s1, s2, s3, s4, s5, s6, s7, s8] = words;
        Self {
            start: whole(a, b),
            driven: whole(c, d),
            length: whole(e, f),
            travel: whole(g, h),
            quarters: [q0, q1, q2].map(f32::from_bits),
            squared: [s0, s1, s2, s3, s4, s5, s6, s7, s8].map(f32::from_bits),
        }
    }
}

const fn whole(lower: u32, upper: u32) -> i64 {
    ((upper as u64) << 32 | lower as u64) as i64
}

/// The speed at a part of the path length, by Clenshaw's scheme.
fn speed(squared: &[f32; SQUARED], part: f32) -> f32 {
    let u = 2.0 * part - 1.0;
    let [first, rest @ ..] = squared;
    let (mut b1, mut b2) = (0.0, 0.0);
    for c in rest.iter().rev() {
        (b1, b2) = (c + 2.0 * u * b1 - b2, b1);
    }
    sqrt_f32(max(0.0, first + u * b1 - b2))
}

/// The integral of the speed over the panel that begins at `at`, in units of the panel's width.
fn panel_of(squared: &[f32; SQUARED], at: f32) -> f32 {
    RULE.iter().fold(0.0, |sum, (point, weight)| sum + weight * speed(squared, at + WIDTH * point))
}

/// The length of a curve along the axes of the path measure, LSB 2^-44 mm.
fn chords<const AXES: usize>(shape: &Shape<AXES>, base: &[Position; AXES], measure: &Measure) -> i64 {
    let (mut fine, mut coarse) = (0i64, 0i64);
    let length = shape.length.to_bits();
    let mut last = shape.placed(0, base);
    let mut even = last;
    for i in 1..=CHORDS {
        let at = (length / CHORDS).wrapping_mul(i).wrapping_add(length % CHORDS * i / CHORDS);
        let point = shape.placed(at, base);
        fine = fine.wrapping_add(chord(&last, &point, measure));
        if i & 1 == 0 {
            coarse = coarse.wrapping_add(chord(&even, &point, measure));
            even = point;
        }
        last = point;
    }
    fine.wrapping_add(fine.wrapping_sub(coarse) / 3)
}

fn chord<const AXES: usize>(from: &[Position; AXES], to: &[Position; AXES], measure: &Measure) -> i64 {
    let mut travel = [0i64; AXES];
    for ((travel, from), to) in travel.iter_mut().zip(from).zip(to) {
        *travel = to.to_bits().wrapping_sub(from.to_bits());
    }
    measure.path(&travel).to_bits()
}
