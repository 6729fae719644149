//! Computes how much of both blocks the curve of a corner takes, and what is left of the blocks.
use super::curve::Side;
use super::held_block::HeldBlock;
use super::{ONE_44, Parameters};
use crate::math::float::{max, min, to_f32, to_i64};
use crate::nc::ContourMethod;
use crate::path::poly::Knot;
use crate::path::{Measure, Passage};
use crate::quantity::{DISTANCE_LSB, Distance, Position};

/// If the rest of a block between two corners is at most 2^-14 of the block's length, the second corner takes
/// this rest too. This is far below the margin of the tolerance.
const SLIVER: u32 = 14;

/// A curve over time leaves at least 2^-18 of the distance to each neighbouring curve; rounding needs this
/// length.
const SCRAP: u32 = 18;

/// Smallest length that a corner leaves of a block that DIST_WEIGHT divides, LSB 2^-44 mm: four steps of a
/// position.
const LEFT: i64 = 1 << 14;

/// Largest change of a block's length if the block is halved and made again, LSB 2^-44 mm.
const HALVED: i64 = 64;

/// Shortest corner distance worth a curve, mm.
pub(super) const SHORTEST: f32 = 1e-5;

/// If the blocks have this multiple of the corner distance left, the speed changes before and after the
/// curve, and is constant inside it.
const BESIDE: i64 = 4;

/// π/2.
const QUARTER: f32 = core::f32::consts::FRAC_PI_2;

/// How far a curve may reach into both blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Room {
    /// Largest corner distances, mm.
    pub most: [f32; 2],
    /// Whether the corner may take half of the block: neither DIST_WEIGHT nor a quarter of a turn limits it.
    whole: [bool; 2],
    /// Corner distances that the program demands, or the largest ones if a tolerance decides, mm.
    pub distances: [f32; 2],
}

/// Lengths that a corner takes from its blocks, LSB 2^-44 mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    pub before: i64,
    pub behind: i64,
}

impl Room {
    /// The room between blocks of these programmed lengths, LSB 2^-44 mm. The room is the blocks' shares,
    /// less REMAIN_PART, and at most a quarter of a turn.
    pub(super) fn new<const AXES: usize>(
        lengths: [(i64, &Side<AXES>); 2],
        parts: [f32; 2],
        rule: &Parameters,
    ) -> Self {
        let mut most = [0.0; 2];
        let mut whole = [false; 2];
        for (((most, whole), (length, side)), part) in most.iter_mut().zip(&mut whole).zip(lengths).zip(parts)
        {
            *most = to_f32(length) * DISTANCE_LSB * (2.0 * part * rule.share);
            *whole = part == 0.5;
            if side.rate * *most > QUARTER {
                *most = QUARTER / side.rate;
                *whole = false;
            }
        }
        Self { most, whole, distances: rule.distances(most) }
    }

    /// The smaller distance.
    pub(super) fn least(&self) -> f32 {
        min(self.most[0], self.most[1])
    }

    /// The lengths that a curve over arc length takes. The arguments are results of the search: the share of
    /// the distances, and the permitted distance of the elements.
    pub(super) fn cut<const AXES: usize>(
        &self,
        held: &HeldBlock<AXES>,
        next: &HeldBlock<AXES>,
        rule: &Parameters,
        (part, slack): (f32, f32),
    ) -> Option<(Cut, f32)> {
        let distances = self.distances.map(|c| c * part);
        // With POS and without distances, the curve swings out from the corner itself.
        let most = max(distances[0], distances[1]);
        if most < SHORTEST && (most > 0.0 || rule.method != ContourMethod::Pos) {
            return None;
        }
        let bits = |i: usize, length: i64| {
            if self.whole[i] && distances[i] >= self.most[i] && rule.share >= 0.5 {
                length / 2
            } else if rule.weighs() {
                to_i64(distances[i] * ONE_44).min(weighed(length))
            } else {
                to_i64(distances[i] * ONE_44).min(length / 2)
            }
        };
        let [mut before, behind] = [bits(0, held.length), bits(1, next.length)];
        let left = held.block.element.shape.length.to_bits();
        before = before.min(left);
        if left - before <= held.length >> SLIVER {
            before = left;
        }
        Some((Cut { before, behind }, slack))
    }
}

/// The largest length that a corner takes from a block that DIST_WEIGHT divides. Without this bound, the rest
/// could be a line without motion.
fn weighed(length: i64) -> i64 {
    (length - (length >> SCRAP).max(LEFT)).max(length / 2)
}

impl Cut {
    /// Whether both lengths are equal except for a negligible difference.
    pub(super) fn is_even(&self) -> bool {
        let more = self.before - self.behind;
        more.abs() <= self.before >> SCRAP
    }

    /// Takes equal lengths of both blocks, so that no sliver of either is left. Returns the length.
    pub(super) fn even<const AXES: usize>(
        held: &HeldBlock<AXES>,
        next: &HeldBlock<AXES>,
        rule: &Parameters,
        mut reach: i64,
    ) -> (Self, i64) {
        let left = held.block.element.shape.length.to_bits();
        let half = if rule.weighs() { weighed(next.length) } else { next.length / 2 };
        // The rest between two curves, caused by rounding, would be too short for their speed.
        let slack = if rule.weighs() { 0 } else { half >> SCRAP };
        if rule.weighs() {
            reach = reach.min(half);
        }
        // In `f32`, the rounded distance may be longer than the line.
        reach = reach.min(left);
        let all = if left <= half.saturating_add(slack.max(HALVED)) { left } else { half };
        let more = all - reach;
        if more > 0 && more <= all >> SCRAP {
            reach = all;
        }
        // The rest of a halved line may differ from its half by a few LSB.
        let before = if left - reach <= HALVED { left } else { reach };
        (Self { before, behind: reach.min(half + slack) }, reach)
    }
}

/// The knots where a curve leaves one block and enters the other. Returns `false` if there are no such knots.
#[inline(never)]
pub(super) fn ends<const AXES: usize>(
    held: &HeldBlock<AXES>,
    next: &HeldBlock<AXES>,
    cut: Cut,
    measure: &Measure,
    [from, to]: [&mut Knot<AXES>; 2],
) -> bool {
    to.position = begin(next, cut);
    let Ok(end) = next.entry_at(&to.position, measure) else { return false };
    to.end = end;
    leave(held, cut, from);
    true
}

/// As [`ends`], and the second block becomes its rest after the curve.
#[inline(never)]
pub(super) fn enter<const AXES: usize>(
    held: &HeldBlock<AXES>,
    next: &mut HeldBlock<AXES>,
    cut: Cut,
    measure: &Measure,
    [from, to]: [&mut Knot<AXES>; 2],
) -> bool {
    to.position = begin(next, cut);
    if next.renew(&to.position, cut.behind, measure).is_err() {
        return false;
    }
    to.end = next.block.element.entry;
    leave(held, cut, from);
    true
}

/// The knot where a curve leaves the first block.
#[inline(always)]
fn leave<const AXES: usize>(held: &HeldBlock<AXES>, cut: Cut, knot: &mut Knot<AXES>) {
    let element = &held.block.element;
    let rest = element.shape.length.to_bits() - cut.before;
    if rest > 0 {
        knot.position = element.shape.point(rest, &held.block.from);
        knot.end = element.end_at(rest);
    } else {
        (knot.position, knot.end) = (held.block.from, element.entry);
    }
}

/// The point where the curve enters the second block.
#[inline(always)]
fn begin<const AXES: usize>(next: &HeldBlock<AXES>, cut: Cut) -> [Position; AXES] {
    let from = &next.block.from;
    if cut.behind > 0 { next.block.element.shape.point(cut.behind, from) } else { *from }
}

impl Cut {
    /// Reduces both blocks to their rests outside a curve between these knots. `constant`: the curve has a
    /// constant speed. Returns how the speed behaves in the curve, or `None` if the second block has no rest.
    pub(super) fn part<const AXES: usize>(
        self,
        held: &mut HeldBlock<AXES>,
        next: &mut HeldBlock<AXES>,
        [from, to]: [&Knot<AXES>; 2],
        (measure, constant): (&Measure, bool),
    ) -> Option<Passage> {
        next.renew(&to.position, self.behind, measure).ok()?;
        Some(self.leave(held, next, from, constant))
    }

    /// Reduces the first block to its rest before the curve's knot. Returns how the speed behaves in the
    /// curve.
    pub(super) fn leave<const AXES: usize>(
        self,
        held: &mut HeldBlock<AXES>,
        next: &HeldBlock<AXES>,
        from: &Knot<AXES>,
        constant: bool,
    ) -> Passage {
        let rest = held.block.element.shape.length.to_bits() - self.before;
        held.block.element.shape.length = Distance::from_bits(rest);
        if rest > 0 {
            held.block.element.exit = from.end;
        }
        // The next corner may take half of the second block.
        let beside = rest.min(next.block.element.shape.length.to_bits() - next.length / 2);
        if constant {
            Passage::Constant
        } else if beside >= self.before.max(self.behind) / BESIDE {
            Passage::Steady
        } else {
            Passage::Varying
        }
    }
}
