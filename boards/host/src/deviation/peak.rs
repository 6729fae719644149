//! The largest deviation between the points of a curve, on the curve itself.
//!
//! The points around the largest deviation are known, and the points between which the nearest block changes.
//! Around them the curve is evaluated at more points, and golden sections enclose the largest value. Golden
//! sections need no derivative, which does not exist at a cusp.
use super::{CHORDS, Deviation, Measured, NOTHING};

/// A position on a curve, as part of its length.
const WHOLE: u32 = 1 << 16;
/// Number of parts between two points.
const STEP: u32 = WHOLE / CHORDS;
/// Number of places between two points for the first search.
const FINER: u32 = 8;
/// The smaller part of a golden section.
const GOLDEN: f64 = 0.381_966_011_250_105;

/// The part of the curve with the largest `value` between two points and one point around them, and this
/// value; `None` if the curve is no longer stored.
/// there; `None` where the curve is no longer there.
pub fn around(first: usize, last: usize, value: impl Fn(u32) -> Option<f64>) -> Option<(u32, f64)> {
    let [low, high] = [first.saturating_sub(1), last + 1].map(|k| (k as u32).min(CHORDS) * STEP);
    let mut best = (low, value(low)?);
    for part in (low..=high).step_by((STEP / FINER) as usize) {
        let here = value(part)?;
        if here > best.1 {
            best = (part, here);
        }
    }
    let (mut low, mut high) = ((best.0.max(STEP / FINER)) - STEP / FINER, (best.0 + STEP / FINER).min(WHOLE));
    let section = |low: u32, high: u32| (f64::from(high - low) * GOLDEN) as u32;
    while high - low > 2 {
        let less = section(low, high).max(1);
        let [left, right] = [low + less, high - less];
        let [at_left, at_right] = [value(left)?, value(right)?];
        for here in [(left, at_left), (right, at_right)] {
            if here.1 > best.1 {
                best = here;
            }
        }
        if at_left > at_right {
            high = right;
        } else {
            low = left;
        }
    }
    Some(best)
}

/// The deviation of a point, measured from a point of its curve; 0 if not compared.
type Of<'a> = &'a dyn Fn(&Measured, &Measured) -> f64;

impl Deviation {
    /// Finds the largest deviations of a curve between its points `measured`: of the main axes, and of each
    /// other axis.
    /// other one.
    pub(super) fn peaks(
        &self,
        block: usize,
        measured: &[Measured],
        exact: &dyn Fn(u32) -> Option<Vec<f64>>,
    ) -> Vec<Measured> {
        let axes = measured.first().map_or(0, |first| first.track.len());
        let mut peaks = self.peaks_of(block, measured, exact, &|one, _| one.seen.distance);
        // If two places of the path are equally near, another axis may have two values. Then only the value next
        // to the block of the measured points counts.
        for peak in &mut peaks {
            peak.track.clear();
        }
        let stretches = measured.windows(2).map(|two| (two[1].seen.part - two[0].seen.part).abs());
        let stretch = stretches.fold(0.0, f64::max).min(0.5);
        for axis in 0..axes {
            let track = |one: &Measured, from: &Measured| {
                let beside =
                    one.seen.block == from.seen.block && (one.seen.part - from.seen.part).abs() <= stretch;
                let value = one.track.get(axis).copied().flatten().filter(|_| beside);
                value.unwrap_or(0.0)
            };
            peaks.extend(self.peaks_of(block, measured, exact, &track));
        }
        peaks
    }

    /// Finds the largest deviation of one of them.
    fn peaks_of(
        &self,
        block: usize,
        measured: &[Measured],
        exact: &dyn Fn(u32) -> Option<Vec<f64>>,
        of: Of<'_>,
    ) -> Vec<Measured> {
        let at = |k: usize| measured.get(k).map_or(0.0, |one| of(one, one));
        let mut peaks = Vec::new();
        for (k, one) in measured.iter().enumerate() {
            let is_seen = one.smoothed && at(k) > NOTHING;
            let is_largest = (k == 0 || at(k) > at(k - 1)) && at(k) >= at(k + 1);
            let next = measured.get(k + 1).filter(|next| next.seen.block != one.seen.block);
            let last = if next.is_some() { k + 1 } else { k };
            let value = |part: u32| Some(of(&self.measure(block, &exact(part)?), one));
            if is_seen
                && (is_largest || next.is_some())
                && let Some((part, value)) = around(k, last, value)
                && value > at(k)
            {
                peaks.extend(exact(part).map(|all| self.measure(block, &all)));
            }
        }
        peaks
    }
}
