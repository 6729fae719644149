//! Seeded random programs.
use super::{By, Kind, Move, NM, Plane, Program};
use std::f64::consts::TAU;

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers everywhere, from one seed.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of `seed`.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly spread in 0…1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly spread between two bounds.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Evenly spread in orders of magnitude.
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low.ln(), high.ln())).exp()
    }

    /// True once in `n`.
    pub fn once_in(&mut self, n: u64) -> bool {
        self.bits().is_multiple_of(n)
    }
}

/// Contents of a random program.
#[derive(Clone, Copy, Debug)]
pub struct Mix {
    /// Axes of the machine, the first three main.
    pub axes: usize,
    /// Blocks.
    pub blocks: usize,
    /// Shortest and longest block, mm.
    pub length: [f64; 2],
    /// Lowest and highest feed, mm/min.
    pub feed: [f64; 2],
    /// One arc in this many blocks; 0 for none.
    pub arcs: u64,
    /// One rapid in this many blocks; 0 for none.
    pub rapids: u64,
    /// One exact stop in this many blocks; 0 for none.
    pub stops: u64,
    /// Smallest and largest radius of an arc, mm.
    pub radius: [f64; 2],
    /// Smallest and largest travel of a rotary axis that moves alone, degrees.
    pub turn: [f64; 2],
    /// Limit of most corner angles, rad; one angle in eight is arbitrary.
    pub knee: f64,
    /// Highest travel of a rotary axis together with main axes, degrees per mm.
    pub spin: f64,
}

impl Mix {
    /// A mixture of all elements.
    pub fn general(axes: usize, blocks: usize) -> Self {
        Self {
            axes,
            blocks,
            length: [0.002, 60.0],
            feed: [100.0, 40_000.0],
            arcs: 4,
            rapids: 7,
            stops: 20,
            radius: [0.3, 60.0],
            turn: [1.0, 90.0],
            knee: 0.3,
            spin: 1.0,
        }
    }

    /// Short blocks of a surface: small corners, one feed.
    pub fn surface(axes: usize, blocks: usize) -> Self {
        Self {
            axes,
            blocks,
            length: [0.05, 1.5],
            feed: [8_000.0, 8_000.0],
            arcs: 0,
            rapids: 0,
            stops: 0,
            radius: [0.3, 60.0],
            turn: [1.0, 90.0],
            knee: 0.05,
            spin: 1.0,
        }
    }
}

impl Mix {
    /// A mixture for [`super::machines::arbitrary`].
    pub fn arbitrary(axes: usize, seed: u64) -> Self {
        let mut r = Random::new(!seed);
        let mut mix = if r.once_in(3) { Self::surface(axes, 300) } else { Self::general(axes, 60) };
        if r.once_in(3) {
            mix.length = [0.000_01, 0.5];
        }
        if r.once_in(4) {
            mix.knee = 0.001;
        }
        mix.feed[0] = mix.feed[0].max(1000.0);
        mix
    }
}

/// The random program of a seed. Programs of different seeds differ in all values; a seed always gives the
/// same program.
pub fn program(seed: u64, mix: Mix) -> Program {
    let mut r = Random::new(seed);
    let mut program = Program::new(format!("random {seed}"), mix.axes);
    for nm in &mut program.start {
        *nm = nanometres(r.between(-50.0, 50.0));
    }
    let linear = mix.axes.min(3);
    let mut heading = r.between(0.0, TAU);
    let mut pitch: f64 = 0.0;
    for _ in 0..mix.blocks {
        let once = |r: &mut Random, n: u64| n > 0 && r.once_in(n);
        let from = program.end().to_vec();
        let mut to = from.clone();
        let length = r.magnitude(mix.length[0], mix.length[1]);
        let bend = if r.once_in(8) { 3.1 } else { mix.knee };
        heading += r.between(-bend, bend);
        pitch = if linear == 3 { (pitch + r.between(-bend, bend)).clamp(-1.5, 1.5) } else { 0.0 };
        let direction = [heading.cos() * pitch.cos(), heading.sin() * pitch.cos(), pitch.sin()];
        let one_axis = linear == 1;
        for k in 0..linear {
            let d = if one_axis { if r.once_in(2) { 1.0 } else { -1.0 } } else { direction[k] };
            to[k] += nanometres(length * d);
        }
        // Keeps a long program near the middle of the machine.
        for nm in to.iter_mut().take(linear) {
            if nm.abs() > 500 * NM {
                *nm = nm.signum() * nanometres(r.between(300.0, 450.0));
            }
        }
        for nm in to.iter_mut().skip(linear) {
            if r.once_in(3) {
                *nm += nanometres(r.between(-1.0, 1.0) * length * mix.spin);
                if nm.abs() > 50_000 * NM {
                    *nm = 0;
                }
            }
        }
        // Sometimes only tracking axes move.
        if mix.axes > 3 && r.once_in(15) {
            to[..linear].copy_from_slice(&from[..linear]);
            to[3] += nanometres(r.between(mix.turn[0], mix.turn[1]));
        }
        let kind = if linear >= 2 && once(&mut r, mix.arcs) {
            arc(&mut r, &from, &mut to, linear, mix.radius)
        } else if once(&mut r, mix.rapids) {
            Kind::Rapid
        } else {
            Kind::Line
        };
        if let Kind::Arc { .. } = kind {
            heading = r.between(0.0, TAU);
        }
        let feed = r.magnitude(mix.feed[0], mix.feed[1]).round();
        let stop = once(&mut r, mix.stops);
        program.moves.push(Move { kind, target: to, feed, stop });
    }
    program
}

/// An arc that starts in `from`; sets the plane's coordinates of `to`. The third main axis keeps its travel
/// (helix).
fn arc(r: &mut Random, from: &[i64], to: &mut [i64], linear: usize, [least, most]: [f64; 2]) -> Kind {
    let plane = match (linear, r.bits() % 4) {
        (3, 0) => Plane::Zx,
        (3, 1) => Plane::Yz,
        _ => Plane::Xy,
    };
    let axes = plane.axes();
    let clockwise = r.once_in(2);
    let radius = r.magnitude(least, most);
    let start = r.between(0.0, TAU);
    let full = r.once_in(6);
    let by_radius = !full && r.once_in(3);
    // The text rounds to nanometres, and with a radius the centre is ill-defined near half and whole circles,
    // so these are avoided.
    let sweep = match (by_radius, r.once_in(3)) {
        (true, false) => r.between(0.1, 2.8),
        (true, true) => r.between(3.5, 5.9),
        (false, _) => r.between(0.01, 6.2),
    };
    let sign = if clockwise { -1.0 } else { 1.0 };
    let offset = [-radius * start.cos(), -radius * start.sin()].map(nanometres);
    let end = start + sign * sweep;
    for (i, unit) in [end.cos(), end.sin()].into_iter().enumerate() {
        to[axes[i]] = from[axes[i]] + offset[i] + nanometres(radius * unit);
        if full {
            to[axes[i]] = from[axes[i]];
        }
    }
    let by = if by_radius {
        By::Radius(if sweep > 3.15 { -nanometres(radius) } else { nanometres(radius) })
    } else {
        By::Offset(offset)
    };
    Kind::Arc { plane, clockwise, by }
}

fn nanometres(mm: f64) -> i64 {
    (mm * NM as f64).round() as i64
}
