//! Merges blocks that continue in a straight line. A line that the program has cut into pieces is then as
//! fast as the whole line, and the look-ahead covers more path.
//!
//! One line from the start `P0` of the first block to the end of the last block may replace all blocks. The
//! condition is that every point left out is within the tolerance of 1.14 nm on each main axis. The check does
//! not need the points themselves. Each point `Pi` was the end of the merged line before the next block
//! joined: `Pi = P0 + Ti·si`, with path length `si` and tangent `Ti` of that line.
//!
//! At the path distance `si`, a line with the tangent `T` is `|T − Ti|·si` away from `Pi`, axis by axis. So
//! each point permits the tangents within `tolerance/si` of `Ti`. For all points together, this is one
//! interval per axis, and only this interval is stored.
//!
//! The place of a point along the path is known only within the tolerance. So a tracking axis that moves `t`
//! times as far as the path has `1 + t` times the tolerance. Main axes have the tolerance alone, whatever the
//! feed axes are.
//!
//! The order of the points stays the same: the path length grows with every block, and the tangent changes by
//! less than 1/4 on every feed axis. So no block goes back.
use super::Measure;
use super::line::{Straight, straight};
use crate::math::float::{to_bits, to_f32};
use crate::quantity::{DISTANCE_LSB, Distance, Position};

/// Permitted distance of a point from the line, LSB of a position: 1.14 nm on every axis, less than 2 nm on
/// three axes. Points that are rounded to six decimals have errors of 0.5 nm. On a straight line, they are up
/// to 1.37 nm away from lines through the other points, usually less than half of that.
const TOLERANCE: i64 = 4900;

/// [`TOLERANCE`] in mm, reduced by the rounding of derived values.
pub(crate) const TOLERANCE_MM: f32 = TOLERANCE as f32 / 4_294_967_296.0 * (1.0 - 1.0 / 1_048_576.0);

/// Longest line, LSB 2^-44 mm: 1 m. Tangents are accurate to 2^-39; over this length, the error is a
/// five-hundredth of the tolerance.
const LONGEST: i64 = 1 << 54;

/// Half of the largest change of the tangent on a feed axis. Below: the factor by which [`Stretch::goes_on`]
/// widens its bound.
const TURN: f32 = 0.125;
const LOOSE: f32 = 2.0;

/// A line that may still grow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch<const AXES: usize> {
    start: [Position; AXES],
    line: Straight<AXES>,
    /// Whether the line consists of a single block.
    alone: bool,
    /// Smallest and largest tangents that all points left out permit, LSB 2^-40; valid for several blocks.
    low: [i64; AXES],
    high: [i64; AXES],
}

impl<const AXES: usize> Stretch<AXES> {
    /// An empty line.
    pub(crate) const BLANK: Self = Self {
        start: [Position::ZERO; AXES],
        line: Straight::BLANK,
        alone: true,
        low: [0; AXES],
        high: [0; AXES],
    };

    /// Begins a line that is a single block.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn begin(&mut self, start: &[Position; AXES], line: &Straight<AXES>) {
        (self.start, self.line, self.alone) = (*start, *line, true);
    }

    /// The line.
    pub(crate) fn line(&self) -> &Straight<AXES> {
        &self.line
    }

    /// Whether the block `next` may be part of the line. If not, a call of [`Self::with`] is useless.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn goes_on(&self, next: &Straight<AXES>) -> bool {
        // `next` leads from the end of this line to the end of the common line, whose tangent is within
        // tolerance/s of this tangent. The tangent of `next`, of length l, may differ from the common one by
        // tolerance/l. The bound is the sum of both.
        let (s, l) = (millimetres(self.line.length), millimetres(next.length));
        let most = LOOSE * TOLERANCE_MM * (s + l);
        // Both sides times s·l.
        let scale = s * l * (1.0 / (1u64 << 40) as f32);
        let bound = if most < TURN * s * l { most } else { return false };
        for (here, there) in self.line.tangent.iter().zip(&next.tangent) {
            let turn = there.wrapping_sub(*here);
            if to_f32(turn.wrapping_abs()) * scale > bound * wide(*here) {
                return false;
            }
        }
        true
    }

    /// The line to `target`, the end of `next`, if this line may replace all blocks. Call
    /// [`Self::become_line`] with the result; without a result, begin a new line. Call this function only if
    /// [`Self::goes_on`] returns `true` for the block.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn with(&mut self, target: &[Position; AXES], measure: &Measure) -> Option<Straight<AXES>> {
        let line = straight(&self.start, target, measure).ok()??;
        if line.length <= self.line.length || line.length.to_bits() > LONGEST {
            return None;
        }
        let room = TOLERANCE_MM / millimetres(self.line.length);
        if core::mem::take(&mut self.alone) {
            (self.low, self.high) = ([i64::MIN; AXES], [i64::MAX; AXES]);
        }
        let bounds = self.low.iter_mut().zip(&mut self.high);
        let tangents = self.line.tangent.iter().zip(&line.tangent);
        for (k, ((low, high), (old, new))) in bounds.zip(tangents).enumerate() {
            let room = to_bits::<40>(if measure.main.contains(k) { room } else { room * wide(*old) });
            (*low, *high) = ((*low).max(old.wrapping_sub(room)), (*high).min(old.wrapping_add(room)));
            if *new < *low || *new > *high {
                return None;
            }
        }
        Some(line)
    }

    /// Takes the line over all blocks.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn become_line(&mut self, line: &Straight<AXES>) {
        self.line = *line;
    }
}

#[cfg_attr(feature = "fast", inline(always))]
fn millimetres(length: Distance) -> f32 {
    to_f32(length.to_bits()) * DISTANCE_LSB
}

/// 1 + |t| for a tangent t.
#[cfg_attr(feature = "fast", inline(always))]
fn wide(tangent: i64) -> f32 {
    1.0 + to_f32(tangent.wrapping_abs()) * (1.0 / (1u64 << 40) as f32)
}
