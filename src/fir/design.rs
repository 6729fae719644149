//! Finds type, order and shape of each axis's filter, from the machine data and the `#FILTER` command.
use crate::machine::{FilterData, FilterType};
use crate::math::float::to_f32;
use crate::nc::{self, Value};
use crate::quantity::Position;

/// The reason why the filters of the machine data, or of `#FILTER`, are not possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FilterError {
    /// The channel has no memory for filters ([`crate::channel::Channel::split_filtered`]).
    NoMemory,
    /// `#FILTER ON`, but no axis has a filter type in its machine data (P-AXIS-00586).
    NoType,
    /// The order of a filter is too high. The values are: index of the axis, order, highest order. The last
    /// value tells which bound is exceeded: `true` for the memory of [`super::Filters`], `false` for the
    /// filter type.
    Order(usize, u32, u32, bool),
    /// The acceleration of the axis with this index (P-AXIS-00008) is above 0.25 mm or degrees per cycle².
    Acceleration(usize),
    /// `#FILTER` sets ACC_FACT above 1, but P-AXIS-00013 is not given for the filtered axis with this index.
    NoTransitionWeight(usize),
    /// AX_DEV is neither 0 nor between 0.00001 and 1000 mm.
    Tolerance,
}

impl FilterError {
    /// Index of the axis that causes the error; `None` if the error is not about one axis.
    pub const fn axis(&self) -> Option<usize> {
        match self {
            Self::Order(axis, ..) | Self::Acceleration(axis) | Self::NoTransitionWeight(axis) => Some(*axis),
            Self::NoMemory | Self::NoType | Self::Tolerance => None,
        }
    }
}

impl core::fmt::Display for FilterError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NoMemory => f.write_str("filters need memory that this channel does not have"),
            Self::NoType => f.write_str(
                "#FILTER ON needs a filter type on an axis; expected filter_fir.type (P-AXIS-00586) of 1 to 4",
            ),
            Self::Order(_, order, most, false) => {
                write!(f, "filter order {order}; expected at most {most} (P-AXIS-00587, P-AXIS-00591)")
            }
            Self::Order(_, order, most, true) => {
                write!(f, "filter order {order}; expected at most {most}, the memory compiled in")
            }
            Self::Acceleration(_) => f.write_str(
                "a filter needs dynamik.a_max (P-AXIS-00008) of at most 0.25 mm or degrees per cycle²; lower it, or cycle_us",
            ),
            Self::NoTransitionWeight(_) => f.write_str(
                "ACC_FACT above 1 needs dynamik.a_trans_weight (P-AXIS-00013) above 0 on every filtered axis",
            ),
            Self::Tolerance => f.write_str("AX_DEV out of range; expected 0 or 0.00001 to 1000 mm"),
        }
    }
}

impl core::error::Error for FilterError {}

/// The filter of one axis, from machine data and `#FILTER`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Design {
    pub kind: FilterType,
    /// Order; 0: the axis is not filtered.
    pub order: u32,
    /// Effectiveness of the filter, 0 to 1; 1 filters completely.
    pub share: f32,
    /// Cut-off frequency times cycle time, at most 0.5.
    pub cut_off: f32,
    pub quality: f32,
}

impl Design {
    pub const NONE: Self = Self { kind: FilterType::None, order: 0, share: 1.0, cut_off: 0.5, quality: 1.0 };

    /// The filter of an axis from its machine data and the `#FILTER` command.
    pub fn of(data: &FilterData, given: &nc::Filter, cycle_us: u32) -> Self {
        let cycles = |us: u32| us.checked_div(cycle_us).unwrap_or(0);
        let order = match (given.order, given.order_time_us) {
            (Some(order), _) => u32::from(order),
            (None, Some(time)) => cycles(whole(time)),
            (None, None) if data.order > 0 => u32::from(data.order),
            (None, None) => cycles(data.order_time_us),
        };
        let share = given.share.map_or(f32::from(data.share), real) * 0.01;
        let fcut = given.fcut.map_or(data.fcut_milli as f32 * 1e-3, real);
        let quality = given.quality.map_or(f32::from(data.quality_milli) * 1e-3, real);
        let cut_off = fcut * (cycle_us as f32 * 1e-6);
        let cut_off = if cut_off < 0.5 { cut_off } else { 0.5 };
        if data.kind == FilterType::None || order == 0 || share <= 0.0 && data.kind != FilterType::Delay {
            return Self { order: 0, ..Self::NONE };
        }
        Self { kind: data.kind, order, share, cut_off, quality }
    }

    /// Group delay in half cycles.
    pub const fn delay(&self) -> u32 {
        match self.kind {
            FilterType::None => 0,
            FilterType::Delay => 2 * self.order,
            _ => self.order,
        }
    }

    /// Highest order of the filter type.
    pub const fn highest(&self) -> u32 {
        if matches!(self.kind, FilterType::Delay) { super::MAX_DELAY } else { super::MAX_ORDER }
    }
}

/// Replaces the values in `given` by those that the command has.
pub(super) fn merge(given: &mut nc::Filter, command: &nc::Filter) {
    if command.order.is_some() || command.order_time_us.is_some() {
        (given.order, given.order_time_us) = (command.order, command.order_time_us);
    }
    given.switch = command.switch.or(given.switch);
    given.share = command.share.or(given.share);
    given.ax_dev = command.ax_dev.or(given.ax_dev);
    given.fcut = command.fcut.or(given.fcut);
    given.acc_fact = command.acc_fact.or(given.acc_fact);
    given.quality = command.quality.or(given.quality);
}

/// AX_DEV, LSB 2^-32 mm; 0: not monitored.
pub(super) fn tolerance(given: &nc::Filter) -> Result<i64, FilterError> {
    const LEAST: i64 = (1i64 << 32) / 100_000;
    match given.ax_dev.map_or(0, Position::to_bits) {
        0 => Ok(0),
        bits if !(LEAST..=1000 << 32).contains(&bits) => Err(FilterError::Tolerance),
        bits => Ok(bits),
    }
}

/// ACC_FACT.
pub(super) fn acc_fact(given: &nc::Filter) -> f32 {
    given.acc_fact.map_or(1.0, real)
}

fn real(value: Value) -> f32 {
    to_f32(value.to_bits()) * (1.0 / 4_294_967_296.0)
}

fn whole(value: Value) -> u32 {
    u32::try_from(value.to_bits() >> 32).unwrap_or(0)
}
