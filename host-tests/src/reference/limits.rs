//! What the axes permit along the path of one block and at its joints. Path values per tick.
use super::geometry::{Element, Shape};
use super::profile::Ramps;
use crate::tolerance::JERK_MARGIN;
use glidepath::machine::AxisData;

/// Permitted path values of one block, per tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockLimits {
    /// Speed.
    pub v: f64,
    /// Acceleration with the ramp times it rises and falls with.
    pub accelerate: Ramps,
    /// Deceleration.
    pub brake: Ramps,
}

/// One axis' limits per tick, from the units of the machine data.
#[derive(Clone, Copy, Debug)]
pub struct AxisLimits {
    /// Speed at feed and in rapid motion.
    pub v: [f64; 2],
    /// Acceleration and deceleration at feed, and in rapid motion.
    pub a: [f64; 3],
    /// Ramp times: acceleration up, down, deceleration up, down, rapid.
    pub ramps: [f64; 5],
    /// Largest acceleration.
    pub a_max: f64,
    /// Ramp time of the contour's jerk.
    pub tr_geom: f64,
    /// Part of the acceleration permitted at a knee; 0 for cycle over ramp time.
    pub knee_weight: f64,
}

impl AxisLimits {
    /// Of a machine's axis, for a cycle in µs.
    pub fn new(axis: &AxisData, cycle_us: u32) -> Self {
        let t = f64::from(cycle_us) * 1e-6;
        let v = |um_s: u32| f64::from(um_s) * 1e-3 * t;
        let a = |mm_s2: u32| f64::from(mm_s2) * t * t;
        let ramp = |us: u32| f64::from(us) * 1e-6 / t;
        Self {
            v: [v(axis.vb_max), v(axis.vb_eilgang)],
            a: [a(axis.a_beschl), a(axis.a_brems), a(axis.a_grenz)],
            ramps: [
                ramp(axis.tr_beschl_zu),
                ramp(axis.tr_beschl_ab),
                ramp(axis.tr_brems_zu),
                ramp(axis.tr_brems_ab),
                ramp(axis.tr_grenz),
            ],
            a_max: a(axis.a_max),
            tr_geom: ramp(axis.tr_geom),
            knee_weight: f64::from(axis.a_trans_weight) / 1000.0,
        }
    }
}

/// Length along which a block's speeds count.
pub fn path_length(element: &Element) -> f64 {
    let main = element.main_length();
    if main > 0.0 { main } else { element.tracking_length() }
}

/// Largest share of the path speed that each axis can have within the block.
pub fn shares(element: &Element) -> Vec<f64> {
    let length = path_length(element);
    (0..element.from.len())
        .map(|k| match &element.shape {
            Shape::Arc { axes, radius, sweep, .. } if axes.contains(&k) => {
                radius[0].max(radius[1]) * sweep.abs() / length
            }
            _ => element.travel(k).abs() / length,
        })
        .collect()
}

/// Limits of a straight block: each quantity is that of the axis that reaches its own first.
pub fn line(element: &Element, axes: &[AxisLimits], cycle_us: u32) -> BlockLimits {
    let shares = shares(element);
    let least = |limit: &dyn Fn(&AxisLimits) -> f64| {
        let each = axes.iter().zip(&shares).filter(|(_, d)| **d > 0.0);
        each.map(|(axis, d)| limit(axis) / d).fold(f64::INFINITY, f64::min)
    };
    // Quantity for G00, or for feed.
    let rapid = element.feed.is_none();
    let a = |i: usize| least(&|axis| axis.a[if rapid { 2 } else { i }]);
    let jerk = |i: usize, ramp: usize| {
        let each =
            |axis: &AxisLimits| if rapid { axis.a[2] / axis.ramps[4] } else { axis.a[i] / axis.ramps[ramp] };
        least(&each) * (1.0 - JERK_MARGIN)
    };
    let ramps = |i: usize| Ramps { a: a(i), up: a(i) / jerk(i, 2 * i), down: a(i) / jerk(i, 2 * i + 1) };
    let programmed = element.feed.map_or(f64::INFINITY, |f| f / 60.0 * f64::from(cycle_us) * 1e-6);
    let v = least(&|axis| axis.v[usize::from(rapid)]).min(programmed);
    BlockLimits { v, accelerate: ramps(0), brake: ramps(1) }
}
