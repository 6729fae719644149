//! Machines with rotary axes, with a forward transformation by matrices and the standard library's sines.
//! This code shares only machine data with the library.
use glidepath::Position;
use glidepath::kinematics::{AXES, CaHead, Chain, Universal, UniversalAxis, Vector};

type Matrix = [[f64; 4]; 4];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

fn shift(v: [f64; 3]) -> Matrix {
    let [x, y, z] = v;
    [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]]
}

/// The matrix of a turn about the unit vector (x, y, z) through the origin.
fn turn([x, y, z]: [f64; 3], degrees: f64) -> Matrix {
    let (s, c) = degrees.to_radians().sin_cos();
    let v = 1.0 - c;
    [
        [c + x * x * v, x * y * v - z * s, x * z * v + y * s, 0.0],
        [y * x * v + z * s, c + y * y * v, y * z * v - x * s, 0.0],
        [z * x * v - y * s, z * y * v + x * s, c + z * z * v, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

fn reference_universal(machine: &Universal, axes: &[f64; AXES]) -> [f64; 3] {
    let mut product = shift([0.0; 3]);
    for &index in machine.chain.iter().take(usize::from(machine.number_of_axes)) {
        let axis = &machine.axis[usize::from(index)];
        let length = axis.orientation.iter().map(|x| x * x).sum::<f64>().sqrt();
        let u = axis.orientation.map(|x| x / length);
        let q = axes[usize::from(index)];
        let point = axis.point.map(|x| f64::from(x) / 1e4);
        let step = if axis.kind == 1 {
            shift(u.map(|u| u * q))
        } else {
            times(&times(&shift(point), &turn(u, q)), &shift(point.map(|x| -x)))
        };
        product = times(&product, &step);
    }
    let tip = machine.zero_position.map(|x| f64::from(x) / 1e4);
    let product = times(&product, &shift(tip));
    [product[0][3], product[1][3], product[2][3]]
}

fn reference_head(machine: &CaHead, axes: &[f64; AXES]) -> [f64; 3] {
    let p = machine.param.map(|x| f64::from(x) / 1e4);
    let [x, y, z, c, a, _] = *axes;
    let steps = [
        shift([x, y, z]),
        shift([p[6], p[7], 0.0]),
        turn([0.0, 0.0, 1.0], c + p[3]),
        shift([p[5], p[4], -p[1]]),
        turn([1.0, 0.0, 0.0], a + p[2]),
        shift([0.0, p[8], -p[0]]),
    ];
    let product = steps.iter().fold(shift([0.0; 3]), |product, step| times(&product, step));
    [product[0][3], product[1][3], product[2][3]]
}

/// A machine with a separate forward transformation.
#[derive(Clone, Debug)]
pub enum Machine {
    /// Type 9.
    Head(CaHead),
    /// Type 91.
    Universal(Box<Universal>),
}

impl Machine {
    /// The library's chain for this machine.
    pub fn chain(&self) -> Chain {
        match self {
            Self::Head(machine) => Chain::ca_head(machine),
            Self::Universal(machine) => Chain::universal(machine),
        }
        .expect("a machine")
    }

    /// The tip, mm, by matrices.
    pub fn tip(&self, axes: &[Position; AXES]) -> [f64; 3] {
        let axes = axes.map(|x| x.to_num::<f64>());
        match self {
            Self::Head(machine) => reference_head(machine, &axes),
            Self::Universal(machine) => reference_universal(machine, &axes),
        }
    }
}

/// Three linear axes along x, y and z, followed by rotary axes: direction and point.
pub fn universal(chain: [u8; 6], rotary: &[([f64; 3], [i32; 3])]) -> Box<Universal> {
    let linear = |k: usize| UniversalAxis {
        kind: 1,
        orientation: std::array::from_fn(|i| f64::from(u8::from(i == k))),
        point: [0; 3],
    };
    let axis = std::array::from_fn(|k| match rotary.get(k.wrapping_sub(3)) {
        Some((orientation, point)) => UniversalAxis { kind: 2, orientation: *orientation, point: *point },
        None => linear(k % 3),
    });
    let number_of_axes = 3 + rotary.len() as u8;
    Box::new(Universal {
        number_of_axes,
        chain,
        axis,
        zero_orientation: [0.0, 0.0, 2.0],
        zero_position: [0, 0, -500_000],
    })
}

/// Along x.
pub const X: [f64; 3] = [1.0, 0.0, 0.0];
/// Along z.
pub const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// CA head, BC trunnion, AC table, head and table, one rotary table, six axes askew.
pub fn machines() -> [Machine; 6] {
    let head = [1_500_000, 400_000, 0, 900_000, 1_200, -3_400, 20_000, -10_000, 700];
    [
        Machine::Head(CaHead { param: head }),
        Machine::Universal(universal(
            [4, 3, 0, 1, 2, 5],
            &[([0.0, -1.0, 0.0], [10_000, 0, -900_000]), ([0.0, 0.0, -1.0], [-7, 123_456, 0])],
        )),
        Machine::Universal(universal(
            [4, 3, 2, 1, 0, 5],
            &[([-1.0, 0.0, 0.0], [0, 4_000, -600_000]), ([0.0, 0.0, -1.0], [2_000, 0, 0])],
        )),
        Machine::Universal(universal(
            [4, 0, 1, 2, 3, 5],
            &[(X, [0, 0, 800_000]), (Z, [300_000, -200_000, 0])],
        )),
        Machine::Universal(universal([3, 1, 0, 2, 4, 5], &[([0.0, 0.0, -1.0], [100_000, 0, 0])])),
        Machine::Universal(universal(
            [5, 0, 1, 2, 3, 4],
            &[
                (Z, [50_000, 0, 0]),
                ([0.0, 1.0, 1.0], [0, 20_000, 900_000]),
                ([0.3, -0.2, 1.0], [-40_000, 0, 0]),
            ],
        )),
    ]
}

/// A sequence of numbers from a seed (SplitMix64).
pub struct Numbers(pub u64);

impl Numbers {
    /// A number between -most and most.
    pub fn within(&mut self, most: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        most * (((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
    }

    /// A tip and three angles.
    pub fn pose(&mut self, place: f64, angle: f64) -> (Vector, [Position; 3]) {
        let tip = Vector::new(self.within(place), self.within(place), self.within(place));
        (tip, [(); 3].map(|()| Position::from_num(self.within(angle))))
    }
}

/// How far a point is from a tip, mm.
pub fn distance([x, y, z]: [f64; 3], tip: Vector) -> f64 {
    ((x - tip.x).powi(2) + (y - tip.y).powi(2) + (z - tip.z).powi(2)).sqrt()
}
