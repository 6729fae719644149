//! Computes the taps of one axis, from the type and order of its filter and from the delay that all axes of
//! the channel have. The taps are integers whose sum is [`ONE`].
//!
//! The weight of a tap at the distance d (cycles) from the centre, for a filter of N + 1 taps:
//!
//! | type | weight |
//! |---|---|
//! | moving average | 1 |
//! | Gauss | exp(−d²/2σ²), σ = QUALITY·N/6 |
//! | windowed sinc | sin(2π·FCUT·T·d)/(π·d) times Blackman's window over N + 2 cycles; T: cycle time |
//!
//! With SHARE p, the output is p times the filter plus 1 − p times the set point with the same delay. The
//! rounding of all taps is added to the centre tap, so the sum is exact.
//!
//! A filter delays by N/2 cycles. If N is even for one axis and odd for another one, the delays differ by
//! half a cycle. Then each tap is averaged with its neighbour, which delays by another half cycle.
use super::design::Design;
use super::{AxisWords, Kind, Layout, ONE};
use crate::machine::FilterType;
use crate::math::float::to_f32;
use crate::math::trig::sin_cos;

/// Largest number of taps on one side, plus the centre, plus one for half a cycle.
const SIDE: usize = super::MAX_ORDER as usize / 2 + 2;

/// Largest travel within a window whose mean is a running sum, mm or degrees.
pub(super) const LONGEST_SUM: f32 = 4096.0;

/// The samples that an axis uses, in a channel with a delay of `delay` half cycles. `reach`: largest travel
/// of the axis per cycle, mm.
pub(super) fn layout(design: &Design, delay: u32, reach: f32) -> Layout {
    let odd = (delay ^ design.delay()) & 1;
    let order = own_order(design);
    if order == 0 && odd == 0 {
        return Layout { kind: Kind::Delay, newest: delay / 2, length: 1 };
    }
    let length = order + 1 + odd;
    let newest = (delay - order - odd) / 2;
    let mean = design.kind == FilterType::Average && design.share >= 1.0;
    let runs = mean && odd == 0 && order > 1 && reach * (length as f32) < LONGEST_SUM;
    Layout { kind: if runs { Kind::Mean } else { Kind::Taps }, newest, length }
}

/// A time delay has no taps, except for half a cycle.
fn own_order(design: &Design) -> u32 {
    if design.kind == FilterType::Delay { 0 } else { design.order }
}

/// As [`layout`], and writes the taps.
pub(super) fn build<const TAPS: usize>(
    design: &Design,
    delay: u32,
    reach: f32,
    words: &AxisWords<TAPS>,
) -> Layout {
    let layout = layout(design, delay, reach);
    if layout.kind == Kind::Taps {
        let order = own_order(design);
        let mut weights = [0.0; SIDE];
        let sum = weigh(design, order, layout.length - 1 - order, &mut weights);
        quantise(&weights, layout.length, sum, if order == 0 { 1.0 } else { design.share }, words);
    }
    layout
}

/// Weights of the outer taps and of the centre. Returns the sum of all taps.
fn weigh(design: &Design, order: u32, odd: u32, weights: &mut [f32; SIDE]) -> f32 {
    let side = order / 2 + 1;
    match design.kind {
        FilterType::Gauss => gauss(design.quality, order, weights),
        FilterType::Sinc => {
            for (k, weight) in (0..side).zip(weights.iter_mut()) {
                *weight = sinc(design.cut_off, order, order - 2 * k);
            }
        }
        _ => weights.iter_mut().take(side as usize).for_each(|weight| *weight = 1.0),
    }
    if odd == 1 {
        average(order, weights);
    }
    let length = order + 1 + odd;
    let pairs = length / 2;
    let mut sum = 0.0;
    for (k, weight) in (0..length - pairs).zip(weights.iter()) {
        sum += if k < pairs { 2.0 * *weight } else { *weight };
    }
    sum
}

/// Replaces the taps w by (w(k) + w(k − 1))/2, which adds one tap.
fn average(order: u32, weights: &mut [f32; SIDE]) {
    // After the centre, the weights repeat in reverse order.
    let side = (order / 2) as usize;
    let mut before = 0.0;
    for weight in weights.iter_mut().take(side + 1) {
        let own = *weight;
        *weight = 0.5 * (own + before);
        before = own;
    }
    // An odd order had two centre taps; the second one is now the centre.
    if order & 1 == 1
        && let Some(centre) = weights.get_mut(side + 1)
    {
        *centre = before;
    }
}

/// Weights of a Gauss filter, from the outside to the centre.
fn gauss(quality: f32, order: u32, weights: &mut [f32; SIDE]) {
    let sigma = quality * (order as f32) * (1.0 / 6.0);
    let half = 0.5 / (sigma * sigma);
    let factor = exponential(2.0 * half);
    // The ratio of neighbours changes by a constant factor per cycle.
    let mut ratio = if order & 1 == 0 { exponential(half) } else { factor };
    let mut weight = 1.0;
    for slot in weights.iter_mut().take((order / 2 + 1) as usize).rev() {
        *slot = weight;
        weight *= ratio;
        ratio *= factor;
        if weight < 1e-12 {
            (weight, ratio) = (0.0, 0.0);
        }
    }
}

/// exp(−x), x ≥ 0; relative error below 10^-5.
fn exponential(x: f32) -> f32 {
    if x > 40.0 {
        return 0.0;
    }
    let z = x * (1.0 / 128.0);
    let mut e = 1.0 - z * (1.0 - z * (0.5 - z * (1.0 / 6.0 - z * (1.0 / 24.0))));
    for _ in 0..7 {
        e *= e;
    }
    e
}

/// Weight of a windowed sinc at `twice`/2 cycles from the centre.
fn sinc(cut_off: f32, order: u32, twice: u32) -> f32 {
    const UNIT: f32 = 1.0 / (1u64 << 62) as f32;
    // Revolutions per half cycle, LSB 2^-64.
    let turn = u64::from((cut_off * 2_147_483_648.0) as u32) << 32;
    let window = (u64::MAX / (u64::from(order) + 2) / 2).wrapping_mul(u64::from(twice));
    let cosine = to_f32(sin_cos(window).1) * UNIT;
    let shape = 0.42 + 0.5 * cosine + 0.08 * (2.0 * cosine * cosine - 1.0);
    if twice == 0 {
        return 2.0 * cut_off * shape;
    }
    let sine = to_f32(sin_cos(turn.wrapping_mul(u64::from(twice))).0) * UNIT;
    shape * sine / (core::f32::consts::PI * 0.5 * twice as f32)
}

/// Rounds the weights to integers whose sum is [`ONE`].
fn quantise<const TAPS: usize>(
    weights: &[f32; SIDE],
    length: u32,
    sum: f32,
    share: f32,
    words: &AxisWords<TAPS>,
) {
    // All pairs except the centre pair, or the single centre tap, which is stored as two halves.
    let outer = (length.div_ceil(2) as usize).saturating_sub(1);
    let scale = share * ONE as f32 / sum;
    let mut rest = ONE / 2;
    for (k, weight) in weights.iter().enumerate().take(outer) {
        let scaled = weight * scale;
        let rounded = if scaled < 0.0 { -((0.5 - scaled) as i32) } else { (scaled + 0.5) as i32 };
        words.set_pair(k, rounded);
        rest -= rounded;
    }
    words.set_pair(outer, rest);
}
