//! Weights of the program: G130…G134, G231…G233, G338 and G339 change accelerations and ramp times of the
//! axes, in percent of the machine data.
//!
//! A weight refers to the machine data, not to an earlier weight: 50 % twice is 50 %. An axis that the
//! command does not name gets 100 %. A weight acts on the following blocks, up to the end of the program.
//! Weighted values stay inside these bounds:
//!
//! | value | lower bound | upper bound |
//! |---|---|---|
//! | accelerations | 1 mm/s² | P-AXIS-00008 |
//! | ramp times at feed | the larger one of P-AXIS-00201 and P-AXIS-00293 | 2^32 µs |
//! | rapid and geometric ramp time | P-AXIS-00201 | 2^32 µs |
//!
//! If the machine data of a ramp time are below the lower bound, they are the bound. P-CHAN-00001 selects
//! whether the weight acts on acceleration, deceleration or both; P-CHAN-00073 selects one of the four ramps
//! at feed, or all. G338 acts as G133, and G339 as G233.
use crate::machine::{AxisData, ChannelData};
use crate::math::divide::div_wide;
use crate::math::wide::mul_shift;
use crate::nc::{Value, Weight, WeightKind};

/// 100 %, in thousandths of a percent.
const FULL: u32 = 100_000;

/// The weights of one axis, thousandths of a percent.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AxisWeights {
    acceleration: u32,
    rapid_acceleration: u32,
    ramp: u32,
    rapid_ramp: u32,
    geometric_ramp: u32,
}

/// The weights of all axes (G130…G134, G231…G233, G338, G339): accelerations and ramp times, as a percentage
/// of the machine data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<const AXES: usize> {
    axes: [AxisWeights; AXES],
}

impl<const AXES: usize> Weights<AXES> {
    /// All weights at 100 %, as at program start.
    pub const fn new() -> Self {
        let axis = AxisWeights {
            acceleration: FULL,
            rapid_acceleration: FULL,
            ramp: FULL,
            rapid_ramp: FULL,
            geometric_ramp: FULL,
        };
        Self { axes: [axis; AXES] }
    }

    /// Whether a command changes any weight.
    pub fn differ(&self, weight: &Weight<AXES>) -> bool {
        let mut other = *self;
        other.set(weight);
        other != *self
    }

    /// Applies a weight command: sets one kind of weight for all axes. An axis without a value in the command
    /// gets 100 %.
    pub fn set(&mut self, weight: &Weight<AXES>) {
        for (axis, percent) in self.axes.iter_mut().zip(&weight.percent) {
            let weight_of = match weight.kind {
                WeightKind::Acceleration | WeightKind::AccelerationAll => &mut axis.acceleration,
                WeightKind::RapidAcceleration => &mut axis.rapid_acceleration,
                WeightKind::RampTime | WeightKind::RampTimeAll | WeightKind::G338 => &mut axis.ramp,
                WeightKind::RapidRampTime | WeightKind::RapidRampTimeAll | WeightKind::G339 => {
                    &mut axis.rapid_ramp
                }
                WeightKind::GeometricRampTime => &mut axis.geometric_ramp,
            };
            *weight_of = percent.map_or(FULL, thousandths);
        }
    }

    /// The machine data of the axis with the index `axis`, multiplied by its weights.
    pub fn apply(&self, axis: usize, data: &AxisData, channel: &ChannelData) -> AxisData {
        let mut out = *data;
        let Some(weights) = self.axes.get(axis) else { return out };
        let a = |value: u32, weight: u32| weigh(value, weight).min(data.a_max).max(1);
        let (feed, rapid) = (data.stages(false), data.stages(true));
        if channel.acceleration_weight != 2 {
            out.a_beschl = a(data.a_beschl, weights.acceleration);
            out.a_stufe = feed.a.map(|value| a(value, weights.acceleration));
        }
        if channel.acceleration_weight != 1 {
            out.a_brems = a(data.a_brems, weights.acceleration);
            out.d_stufe = feed.d.map(|value| a(value, weights.acceleration));
        } else {
            // These values are not copied from weighted accelerations.
            out.d_stufe = feed.d;
        }
        out.a_grenz = a(data.a_grenz, weights.rapid_acceleration);
        out.a_grenz_stufe = rapid.a.map(|value| a(value, weights.rapid_acceleration));
        out.d_grenz_stufe = rapid.d.map(|value| a(value, weights.rapid_acceleration));

        let shortest = data.tr_min.max(data.tr_w_min);
        // In the order of P-CHAN-00073.
        let ramps =
            [&mut out.tr_beschl_zu, &mut out.tr_beschl_ab, &mut out.tr_brems_zu, &mut out.tr_brems_ab];
        for (number, ramp) in (1..).zip(ramps) {
            if channel.ramp_weight == 0 || channel.ramp_weight == number {
                *ramp = weigh(*ramp, weights.ramp).max(shortest.min(*ramp));
            }
        }
        out.tr_grenz = weigh(data.tr_grenz, weights.rapid_ramp).max(data.tr_min.min(data.tr_grenz));
        let geometric = data.geometric_ramp();
        out.tr_geom = weigh(geometric, weights.geometric_ramp).max(data.tr_min.min(geometric));
        out
    }
}

impl<const AXES: usize> Default for Weights<AXES> {
    fn default() -> Self {
        Self::new()
    }
}

/// Percent, LSB 2^-32, as thousandths. The decoder bounds it to 10 000 %.
fn thousandths(percent: Value) -> u32 {
    u32::try_from(mul_shift(percent.to_bits(), 1000, 32)).unwrap_or(FULL)
}

/// A value times a weight, rounded to nearest; at most 2^32 - 1.
fn weigh(value: u32, weight: u32) -> u32 {
    // Both factors have 32 bits, so the product plus half of it fits.
    let product = u64::from(value).wrapping_mul(u64::from(weight));
    let weighted = div_wide(0, product.saturating_add(u64::from(FULL / 2)), u64::from(FULL));
    u32::try_from(weighted).unwrap_or(u32::MAX)
}
