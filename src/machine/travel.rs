//! Software limits of the axes: P-AXIS-00177 and P-AXIS-00178.
//!
//! The limits are machine positions, without offsets. An axis may move exactly up to a limit. The whole path
//! of a block is checked before the block is planned. An axis that is already beyond a limit may only move
//! back.
use super::{MachineData, NO_LIMIT};
use crate::math::divide::div_wide;
use crate::quantity::Position;

/// A path that would lead an axis beyond its software limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Beyond {
    /// Index of the axis, from 0.
    pub axis: usize,
    /// The position that the axis would reach: machine coordinates, LSB 2^-32 mm or degrees.
    pub position: i64,
    /// The software limit, LSB 2^-32 mm or degrees.
    pub limit: i64,
}

impl Beyond {
    /// Whether the axis would exceed its positive limit, and not its negative one.
    pub const fn is_positive(&self) -> bool {
        self.position > self.limit
    }
}

/// The software limits of all axes, against which the planner checks the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel<const AXES: usize> {
    /// Negative and positive limit.
    limits: [[Position; 2]; AXES],
    /// Whether any axis has a limit.
    is_limited: bool,
}

/// A value in 0.1 µm or 0.0001° as a position, rounded to nearest.
pub(crate) fn of_tenths(tenths: i32) -> Position {
    const UNIT: u64 = 10_000;
    // A tenth is never exactly between two positions, because 10^4 has factors other than 2.
    let bits = div_wide(0, (u64::from(tenths.unsigned_abs()) << 32) + UNIT / 2, UNIT) as i64;
    Position::from_bits(if tenths < 0 { -bits } else { bits })
}

/// An excess of less than a nanometre is permitted: rounding of an arc's centre can cause up to 2^-20 mm.
const ROUNDING: i64 = 1 << 12;

impl<const AXES: usize> Travel<AXES> {
    /// The software limits of these machine data.
    pub fn new(machine: &MachineData<AXES>) -> Self {
        let limit = |tenths: i32, none| if tenths.abs() >= NO_LIMIT { none } else { of_tenths(tenths) };
        let limits =
            machine.axes.map(|axis| [limit(axis.swe_neg, Position::MIN), limit(axis.swe_pos, Position::MAX)]);
        let is_limited = limits.iter().any(|limits| *limits != [Position::MIN, Position::MAX]);
        Self { limits, is_limited }
    }

    /// Whether any axis has a software limit.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn is_limited(&self) -> bool {
        self.is_limited
    }

    /// Checks a straight path.
    ///
    /// # Errors
    /// Returns the first axis that would leave its limits.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn line(&self, from: &[Position; AXES], to: &[Position; AXES]) -> Result<(), Beyond> {
        if self.is_limited { self.way(from, to) } else { Ok(()) }
    }

    #[inline(never)]
    fn way(&self, from: &[Position; AXES], to: &[Position; AXES]) -> Result<(), Beyond> {
        (0..AXES).try_for_each(|axis| self.axis(axis, from, [to.get(axis); 2].map(|x| x.copied()), 0))
    }

    /// Checks a curve that begins at `from`. `range` gives the least and the greatest coordinate of an axis on the curve.
    ///
    /// # Errors
    /// Returns the first axis that would leave its limits by more than a nanometre.
    pub fn curve(
        &self,
        from: &[Position; AXES],
        range: impl Fn(usize) -> [Option<Position>; 2],
    ) -> Result<(), Beyond> {
        (0..AXES).try_for_each(|axis| self.axis(axis, from, range(axis), ROUNDING))
    }

    /// The lowest and the highest coordinate that an axis may reach on a path that begins at `from`.
    pub fn of(&self, axis: usize, from: &[Position; AXES]) -> [Position; 2] {
        let ([least, most], from) = match (self.limits.get(axis), from.get(axis)) {
            (Some(limits), Some(from)) => (*limits, *from),
            _ => return [Position::MIN, Position::MAX],
        };
        [least.min(from), most.max(from)]
    }

    fn axis(
        &self,
        axis: usize,
        from: &[Position; AXES],
        [low, high]: [Option<Position>; 2],
        more: i64,
    ) -> Result<(), Beyond> {
        let [least, most] = self.of(axis, from);
        let limits = self.limits.get(axis).map_or([0; 2], |limits| limits.map(Position::to_bits));
        let is_below = |a: Position, b: Position| a.to_bits().saturating_add(more) < b.to_bits();
        let beyond = |position: Position, limit| Beyond { axis, position: position.to_bits(), limit };
        match (low, high) {
            (Some(low), _) if is_below(low, least) => Err(beyond(low, limits[0])),
            (_, Some(high)) if is_below(most, high) => Err(beyond(high, limits[1])),
            _ => Ok(()),
        }
    }
}
