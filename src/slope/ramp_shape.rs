//! Shapes of a ramp: how acceleration rises from zero to its peak. A falling ramp is the mirror image.
//!
//! Let u be the time within the ramp, from 0 to 1. The acceleration is peak·f(u), with f(0) = 0, f(1) = 1 and
//! f(u) + f(1 − u) = 1. So every shape gains the speed peak·time/2. Between equally spaced nodes, f is a
//! straight line. So the distance between two nodes is a cubic of time, which the interrupt can execute
//! exactly.
//!
//! | shape | nodes | f at the nodes | mean speed gained, as part of all | highest jerk, as part of peak/time |
//! |---|---|---|---|---|
//! | [`RampShape::Linear`] | 0, 1 | u | 1/3 | 1 |
//! | [`RampShape::SineSquare`] | 0, 1/8, … 1 | sin²(πu/2) | 0.29994 | 1.5307; limits count with π/2, the value of the sine |
//!
//! The chords of [`RampShape::SineSquare`] differ from sin² by at most 0.95 % of the peak acceleration. The
//! mean speed differs from that of the sine (1/2 − 2/π² of the speed gained) by 0.26 % of the speed gained.
//! If both ramps of a change are equally long, these errors cancel: time and distance are those of the sine.
use crate::machine::functions;
use crate::math::float::{max, min, to_f32};
use crate::math::root::sqrt_f32;
use crate::math::wide::mul_near;

/// How acceleration rises and falls in a ramp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RampShape {
    /// TRAPEZ and HSC: the jerk is constant.
    #[default]
    Linear,
    /// SIN2: acceleration follows a sine square.
    SineSquare,
}

/// Pieces of [`RampShape::SineSquare`]: 2^3.
const PIECES: usize = 8;
const PIECES_LOG2: u32 = 3;

/// 1, LSB 2^-62.
const ONE: i64 = 1 << 62;

/// sin²(kπ/16), LSB 2^-62; each value and its mirror image add up to 1.
const SINE_SQUARE: [i64; PIECES + 1] = [
    0,
    0x026f_9430_cd72_b9d7,
    0x095f_6199_80c4_336f,
    0x13c1_0eac_a8ab_4e97,
    ONE / 2,
    0x2c3e_f153_5754_b169,
    0x36a0_9e66_7f3b_cc91,
    0x3d90_6bcf_328d_4629,
    ONE,
];

/// One piece: acceleration from one node to the next.
#[derive(Clone, Copy)]
struct Piece {
    /// f at the start of the piece, and the increase of f within the piece.
    f: i64,
    gain: i64,
    /// Speed and distance up to the start of the piece, as in [`Bent`].
    speed: i64,
    distance: i64,
}

const BLANK: Piece = Piece { f: 0, gain: 0, speed: 0, distance: 0 };

/// The pieces of [`RampShape::SineSquare`]: exact integrals between the nodes, except for the last bits of a
/// division.
const TABLE: [Piece; PIECES] = {
    let n = PIECES as i64;
    let mut table = [BLANK; PIECES];
    let (mut speed, mut distance) = (0, 0);
    let mut k = 0;
    while k < PIECES {
        let (f, gain) = (SINE_SQUARE[k], SINE_SQUARE[k + 1] - SINE_SQUARE[k]);
        table[k] = Piece { f, gain, speed, distance };
        distance += (speed + (f + gain / 3) / n) / n;
        speed += (2 * f + gain) / n;
        k += 1;
    }
    table
};

/// Values of a ramp that gains the speed 1 in the time 1, LSB 2^-62.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bent {
    /// Speed gained.
    pub speed: i64,
    /// Path distance of a motion with that speed, from standstill.
    pub distance: i64,
    /// Half the acceleration.
    pub half_accel: i64,
    /// An eighth of half the jerk; 8 is the number of pieces of a sine ramp.
    pub jerk: i64,
}

impl RampShape {
    /// The shape itself; [`Self::Linear`] in a build without the slope SIN2.
    #[inline(always)]
    pub const fn built(self) -> Self {
        if functions::SLOPES.is_built() { self } else { Self::Linear }
    }

    /// Mean of the speed gained over the time of the ramp, as a part of the whole gain, LSB 2^-62.
    pub const fn mean(self) -> i64 {
        match self.built() {
            Self::Linear => ONE / 3,
            Self::SineSquare => {
                let last = TABLE[PIECES - 1];
                let n = PIECES as i64;
                last.distance + (last.speed + (last.f + last.gain / 3) / n) / n
            }
        }
    }

    /// Path length of a ramp, divided by peak acceleration times time squared. First value, q: a ramp from a
    /// stop. Second value, 1/2 − q: the mirrored ramp, in which acceleration falls to zero.
    pub const fn distances(self) -> [f32; 2] {
        match self.built() {
            Self::Linear => [1.0 / 6.0, 1.0 / 3.0],
            Self::SineSquare => [0.149_970_8, 0.350_029_2],
        }
    }

    /// Ratio of the highest jerk to the mean jerk (peak acceleration divided by time), as limits assume it. 1
    /// for a linear ramp, π/2 for a sine square.
    pub const fn peak_jerk(self) -> f32 {
        match self.built() {
            Self::Linear => 1.0,
            Self::SineSquare => core::f32::consts::FRAC_PI_2,
        }
    }

    /// The time u (0 to 1) at which a ramp from a stop has gained the part `gained` of its speed. Second
    /// value: the path length up to that time, in the unit of [`Bent`].
    pub fn reaches(self, gained: f32) -> [f32; 2] {
        match self.built() {
            Self::Linear => {
                let u = sqrt_f32(gained);
                [u, u * gained * (1.0 / 3.0)]
            }
            Self::SineSquare => {
                const LSB: f32 = 1.0 / ONE as f32;
                const N: f32 = PIECES as f32;
                let mut at = [1.0, 0.299_941_6];
                for (k, piece) in TABLE.iter().enumerate().rev() {
                    let rest = gained - to_f32(piece.speed) * LSB;
                    if rest > 0.0 || k == 0 {
                        // x in the piece: (f + gain·x/2)·x = rest·n/2.
                        let [f, gain] = [piece.f, piece.gain].map(|x| to_f32(x) * LSB);
                        // Above 0, because the divisor in the first piece is the root of this value.
                        let rest = max(rest, 1e-30) * (0.5 * N);
                        let x = 2.0 * rest / (f + sqrt_f32(f * f + 2.0 * gain * rest));
                        let x = min(x, 1.0);
                        let [speed, distance] = [piece.speed, piece.distance].map(|x| to_f32(x) * LSB);
                        let inside = x * (speed + x * (f + gain * x * (1.0 / 3.0)) * (1.0 / N));
                        at = [(k as f32 + x) * (1.0 / N), distance + inside * (1.0 / N)];
                        break;
                    }
                }
                at
            }
        }
    }
}

/// Index of the piece of [`RampShape::SineSquare`] that begins or continues at `u` (LSB 2^-62, 0 to 1).
/// `reversed`: time runs backward, so at a node the piece that ends there counts.
pub fn sine_piece(u: i64, reversed: bool) -> usize {
    let u = if reversed { u - 1 } else { u };
    ((u.max(0) >> (62 - PIECES_LOG2)) as usize).min(PIECES - 1)
}

/// The time of node `node` (0 to 8) in a sine ramp that lasts `time`. The nodes are the ends of the pieces.
pub fn sine_node(time: u64, node: usize) -> u64 {
    let node = node as u64;
    (time >> PIECES_LOG2) * node + (((time & (PIECES as u64 - 1)) * node) >> PIECES_LOG2)
}

/// The ramp of [`RampShape::SineSquare`] at the time `u` (LSB 2^-62, 0 to 1), which is in piece `k`; accurate
/// to 2^-59.
pub fn sine_square(u: i64, k: usize) -> Bent {
    // Product of two numbers with LSB 2^-62.
    let by = |x: i64, y: i64| mul_near(x, y) << 2;
    let piece = TABLE.get(k).copied().unwrap_or(BLANK);
    let x = (u - ((k as i64) << (62 - PIECES_LOG2))) << PIECES_LOG2;
    let grown = by(piece.gain, x);
    let speed = by(piece.f + grown / 2, x) >> (PIECES_LOG2 - 1);
    let bent = by(piece.f + grown / 3, x) >> PIECES_LOG2;
    Bent {
        speed: piece.speed + speed,
        distance: piece.distance + (by(piece.speed + bent, x) >> PIECES_LOG2),
        half_accel: piece.f + grown,
        jerk: piece.gain,
    }
}
