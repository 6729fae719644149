//! Limits of axis positions that a PLC moves during the motion (FCT_DYN_POS_LIMIT).
//!
//! ```
//! use glidepath::contour_log::{LimitState, PositionLimits, Side};
//! use glidepath::quantity::Position;
//!
//! static LIMITS: PositionLimits<3> = PositionLimits::new();
//!
//! // planner.limit_positions(&LIMITS, inquiry), once, before the first poll
//! LIMITS.set(0, Side::High, Some(Position::from_num(120))); // the PLC: X stays at or below 120 mm
//! assert_eq!(LIMITS.state(), LimitState::Free);
//! LIMITS.set(0, Side::High, None); // the motion goes on
//! ```
use crate::quantity::Position;
use core::sync::atomic::{AtomicU32, Ordering};

/// The side of a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The lower limit, ISG's `dyn_pos_limit_low`.
    Low,
    /// The upper limit, ISG's `dyn_pos_limit_high`.
    High,
}

/// What the planner does because of a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitState {
    /// No limit stops the axes.
    Free,
    /// The axes brake, and stop before this limit.
    Braking(usize, Side),
    /// The axes stand still before this limit.
    Standing(usize, Side),
    /// The axes pass this limit before they stop: the limit came too late for their dynamics. The state stays until the
    /// motion goes on.
    Exceeded(usize, Side),
}

/// A limit: its value and whether the limit is in force.
struct Limit {
    is_set: AtomicU32,
    value: [AtomicU32; 2],
}

impl Limit {
    const fn new() -> Self {
        Self { is_set: AtomicU32::new(0), value: [const { AtomicU32::new(0) }; 2] }
    }
}

/// The limits of all axes. The PLC writes them; the planner reads them and writes the state. Any context may read.
pub struct PositionLimits<const AXES: usize> {
    axes: [[Limit; 2]; AXES],
    /// Number of changes. It is odd while a limit is being written.
    changes: AtomicU32,
    /// The planner's word.
    state: AtomicU32,
}

/// Limits at one moment: low and high for each axis, LSB of a position.
pub(crate) struct LimitsNow<const AXES: usize> {
    axes: [[Option<i64>; 2]; AXES],
}

impl<const AXES: usize> LimitsNow<AXES> {
    /// Whether no limit is in force.
    pub fn are_none(&self) -> bool {
        self.axes.iter().flatten().all(Option::is_none)
    }

    /// The first limit that a point exceeds.
    pub fn beyond(&self, point: &[Position; AXES]) -> Option<(usize, Side)> {
        for (axis, ([low, high], at)) in self.axes.iter().zip(point).enumerate() {
            if low.is_some_and(|low| at.to_bits() < low) {
                return Some((axis, Side::Low));
            }
            if high.is_some_and(|high| at.to_bits() > high) {
                return Some((axis, Side::High));
            }
        }
        None
    }
}

impl<const AXES: usize> PositionLimits<AXES> {
    /// No limit is in force.
    pub const fn new() -> Self {
        Self {
            axes: [const { [const { Limit::new() }; 2] }; AXES],
            changes: AtomicU32::new(0),
            state: AtomicU32::new(0),
        }
    }

    /// Sets a limit of an axis, mm or degrees; `None` ends the limit. An axis without a place has no effect. Only one
    /// task or interrupt calls this function.
    pub fn set(&self, axis: usize, side: Side, value: Option<Position>) {
        let Some([low, high]) = self.axes.get(axis) else { return };
        let limit = if side == Side::Low { low } else { high };
        let changes = self.changes.load(Ordering::Relaxed);
        self.changes.store(changes.wrapping_add(1), Ordering::Relaxed);
        core::sync::atomic::fence(Ordering::Release);
        let bits = value.unwrap_or(Position::ZERO).to_bits();
        for (word, value) in limit.value.iter().zip([bits as u32, (bits >> 32) as u32]) {
            word.store(value, Ordering::Relaxed);
        }
        limit.is_set.store(value.is_some().into(), Ordering::Relaxed);
        self.changes.store(changes.wrapping_add(2), Ordering::Release);
    }

    /// What the planner does because of the limits.
    pub fn state(&self) -> LimitState {
        let word = self.state.load(Ordering::Acquire);
        let side = if word & 0x10 == 0 { Side::Low } else { Side::High };
        let axis = (word >> 8) as usize;
        match word & 0xF {
            1 => LimitState::Braking(axis, side),
            2 => LimitState::Standing(axis, side),
            3 => LimitState::Exceeded(axis, side),
            _ => LimitState::Free,
        }
    }

    /// Tells the PLC the state. Only the planner calls this function.
    pub(crate) fn tell(&self, state: LimitState) {
        let word =
            |kind: u32, axis: usize, side| kind | u32::from(side == Side::High) << 4 | (axis as u32) << 8;
        let word = match state {
            LimitState::Free => 0,
            LimitState::Braking(axis, side) => word(1, axis, side),
            LimitState::Standing(axis, side) => word(2, axis, side),
            LimitState::Exceeded(axis, side) => word(3, axis, side),
        };
        self.state.store(word, Ordering::Release);
    }

    /// Number of changes of the limits.
    pub(crate) fn changes(&self) -> u32 {
        self.changes.load(Ordering::Acquire)
    }

    /// All limits; `None` while the PLC writes one.
    pub(crate) fn now(&self) -> Option<LimitsNow<AXES>> {
        let changes = self.changes();
        let mut axes = [[None; 2]; AXES];
        for (to, limit) in axes.iter_mut().flatten().zip(self.axes.iter().flatten()) {
            let [lower, upper] = &limit.value;
            let bits =
                u64::from(upper.load(Ordering::Relaxed)) << 32 | u64::from(lower.load(Ordering::Relaxed));
            *to = (limit.is_set.load(Ordering::Relaxed) != 0).then_some(bits as i64);
        }
        core::sync::atomic::fence(Ordering::Acquire);
        (changes & 1 == 0 && self.changes.load(Ordering::Relaxed) == changes).then_some(LimitsNow { axes })
    }
}

impl<const AXES: usize> Default for PositionLimits<AXES> {
    fn default() -> Self {
        Self::new()
    }
}
