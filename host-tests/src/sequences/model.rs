//! The modal state, and the positions of the axes, according to the lines.
use crate::cases::random::Random;

/// Positions are in eighths of a millimetre: exact as decimals and as set points.
pub const EIGHTH: u32 = 29;

/// A random number of them, up to `most` either way.
pub fn eighths(random: &mut Random, most: i64) -> i64 {
    (random.bits() % (2 * most as u64 + 1)) as i64 - most
}

/// As a decimal.
pub fn decimal(eighths: i64) -> String {
    format!("{}", eighths as f64 / 8.0)
}

/// A set point.
pub fn bits(eighths: i64) -> i64 {
    eighths << EIGHTH
}

/// Modal functions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modal {
    /// G91.
    pub relative: bool,
    /// G54…G59, from 0.
    pub zero: Option<usize>,
    /// G92, eighths.
    pub shift: [i64; 3],
    /// Whether a feed is set.
    pub feed: bool,
    /// G00, G01, G02, G03.
    pub mode: u8,
    /// Corners may be rounded.
    pub smooth: bool,
}

impl Modal {
    /// At program start.
    pub const START: Self =
        Self { relative: false, zero: None, shift: [0; 3], feed: false, mode: 1, smooth: false };
}

/// A part of the programmed path: a line, or an arc around a centre in X and Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// Where it begins and ends.
    pub ends: [[i64; 3]; 2],
    /// Its centre, and its radius.
    pub arc: Option<([f64; 2], f64)>,
}

impl Element {
    /// How far a point is from it, mm; from an arc in X and Y.
    pub fn distance(&self, point: &[i64]) -> f64 {
        let mm = |bits: i64| bits as f64 / (1_u64 << 32) as f64;
        let off = |k: usize| mm(point[k] - self.ends[0][k]);
        if let Some((centre, radius)) = self.arc {
            return ((mm(point[0]) - centre[0]).hypot(mm(point[1]) - centre[1]) - radius).abs();
        }
        let way: [f64; 3] = std::array::from_fn(|k| mm(self.ends[1][k] - self.ends[0][k]));
        let length: f64 = way.iter().map(|x| x * x).sum();
        let along: f64 = (0..3).map(|k| way[k] * off(k)).sum();
        let part = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
        (0..3).map(|k| (off(k) - part * way[k]).powi(2)).sum::<f64>().sqrt()
    }
}

/// The state of the machine.
#[derive(Clone, Debug)]
pub struct Model {
    /// Set points.
    pub at: [i64; 3],
    /// An axis whose oscillation was broken off is anywhere.
    pub known: [bool; 3],
    /// Zero offsets, eighths.
    pub zeros: [[i64; 3]; 6],
    /// Modal state.
    pub modal: Modal,
}

/// The expected effect of lines.
#[derive(Clone, Debug, Default)]
pub struct Effect {
    /// The path, without smoothing.
    pub path: Vec<Element>,
    /// The lowest and highest place of each axis.
    pub reach: [[i64; 2]; 3],
    /// Numbers of M functions, and those of H functions + 1000.
    pub outputs: Vec<u16>,
    /// Whether axes move independently of the path.
    pub beside: bool,
    /// Corners may be rounded.
    pub smooth: bool,
    /// A line was refused.
    pub refused: bool,
}

impl Effect {
    /// Nothing, from where the axes stand.
    pub fn new(model: &Model) -> Self {
        Self { reach: model.at.map(|at| [at; 2]), smooth: model.modal.smooth, ..Self::default() }
    }

    /// An axis comes there.
    pub fn reaches(&mut self, axis: usize, at: i64) {
        let [low, high] = &mut self.reach[axis];
        (*low, *high) = ((*low).min(at), (*high).max(at));
    }
}

impl Model {
    /// The offset of an axis, set points.
    pub fn offset(&self, axis: usize) -> i64 {
        let zero = self.modal.zero.map_or(0, |set| self.zeros[set][axis]);
        bits(zero + self.modal.shift[axis])
    }

    /// A motion to `to`, along a line or an arc.
    pub fn moves(&mut self, to: [i64; 3], arc: Option<([f64; 2], f64)>, effect: &mut Effect) {
        if let Some((centre, radius)) = arc {
            for (axis, centre) in centre.into_iter().enumerate() {
                for at in [centre - radius, centre + radius] {
                    // Rounded outward.
                    effect.reaches(axis, (at * (1_u64 << 32) as f64).round() as i64 + (at.signum() as i64));
                }
            }
        }
        for (axis, to) in to.into_iter().enumerate() {
            effect.reaches(axis, to);
        }
        effect.path.push(Element { ends: [self.at, to], arc });
        self.at = to;
    }
}
