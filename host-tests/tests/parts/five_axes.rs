//! Machines with rotary axes beside a forward transformation of matrices and the standard library's sines.
use glidepath::Position;
use glidepath::kinematics::{AXES, CaHead, Chain, Course, Splitter, Universal, UniversalAxis, Vector};

/// 5 nm in mm.
const NEAR: f64 = 5e-6;

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

enum Machine {
    Head(CaHead),
    Universal(Box<Universal>),
}

impl Machine {
    fn chain(&self) -> Chain {
        match self {
            Self::Head(machine) => Chain::ca_head(machine),
            Self::Universal(machine) => Chain::universal(machine),
        }
        .expect("a machine")
    }

    fn tip(&self, axes: &[Position; AXES]) -> [f64; 3] {
        let axes = axes.map(|x| x.to_num::<f64>());
        match self {
            Self::Head(machine) => reference_head(machine, &axes),
            Self::Universal(machine) => reference_universal(machine, &axes),
        }
    }
}

fn universal(chain: [u8; 6], rotary: &[([f64; 3], [i32; 3])]) -> Box<Universal> {
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

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// CA head, BC trunnion, AC table, head and table, one rotary table, six axes askew.
fn machines() -> [Machine; 6] {
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
struct Numbers(u64);

impl Numbers {
    fn within(&mut self, most: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        most * (((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
    }

    fn pose(&mut self, place: f64, angle: f64) -> (Vector, [Position; 3]) {
        let tip = Vector::new(self.within(place), self.within(place), self.within(place));
        (tip, [(); 3].map(|()| Position::from_num(self.within(angle))))
    }
}

fn distance([x, y, z]: [f64; 3], tip: Vector) -> f64 {
    ((x - tip.x).powi(2) + (y - tip.y).powi(2) + (z - tip.z).powi(2)).sqrt()
}

fn poses(count: u32) {
    let mut numbers = Numbers(43);
    for (m, machine) in machines().iter().enumerate() {
        let chain = machine.chain();
        for _ in 0..count / 6 + 1 {
            let (tip, angles) = numbers.pose(1_000.0, 720.0);
            let axes = chain.inverse(tip, &angles).expect("in range");
            let off = distance(machine.tip(&axes), tip);
            assert!(off < NEAR, "machine {m}: {off} mm at {tip:?} {angles:?}");
            let own = chain.forward(&axes).0;
            assert!(distance(machine.tip(&axes), own) < NEAR, "machine {m}: forward at {axes:?}");
        }
    }
}

#[test]
fn forward_of_inverse_is_the_tip() {
    poses(12_000);
}

#[test]
#[ignore = "a million poses"]
fn forward_of_inverse_is_the_tip_a_million_times() {
    poses(1_000_000);
}

#[test]
fn the_tip_stays_on_its_line() {
    let mut numbers = Numbers(9);
    for (m, machine) in machines().iter().enumerate() {
        let chain = machine.chain();
        for _ in 0..20 {
            let from = numbers.pose(300.0, 90.0);
            let far = numbers.pose(20.0, 40.0);
            let to = (from.0.plus(far.0), [0, 1, 2].map(|k| from.1[k] + far.1[k]));
            let mut splitter = Splitter::new(&chain, Course::line(from, to)).expect("a course");
            let count = splitter.cells();
            assert!((1..200).contains(&count), "machine {m}: {count} cells");
            let mut end = chain.inverse(from.0, &from.1).expect("in range");
            for n in 0..count {
                let cell = splitter.step().expect("a cell").expect("made");
                assert_eq!(cell.start, end, "machine {m}: cells meet");
                for part in 0..=16 {
                    let share = (f64::from(n) + f64::from(part) / 16.0) / f64::from(count);
                    let axes = cell.at(i64::from(part) << 58);
                    let tip = from.0.plus(to.0.minus(from.0).times(share));
                    let off = distance(machine.tip(&axes), tip);
                    assert!(off < NEAR, "machine {m}: {off} mm off, cell {n} of {count}, part {part}");
                    for (k, axis) in axes.iter().enumerate() {
                        let [least, most] = cell.range(k).expect("an axis");
                        assert!((least..=most).contains(axis), "machine {m}, axis {k}: outside its range");
                    }
                }
                end = cell.end();
            }
            assert!(splitter.step().is_none());
            assert_eq!(end, chain.inverse(to.0, &to.1).expect("in range"), "machine {m}: the end");
        }
    }
}

#[test]
fn a_direction_gives_the_angles_nearest_to_the_last() {
    let mut numbers = Numbers(5);
    for machine in &machines()[..4] {
        let chain = machine.chain();
        for _ in 0..500 {
            let (tip, angles) = numbers.pose(100.0, 170.0);
            let direction = chain.forward(&chain.inverse(tip, &angles).expect("in range")).1;
            let Ok(found) = chain.angles(direction, &angles) else { panic!("{angles:?}: not reached") };
            for (a, b) in found.iter().zip(&angles) {
                assert!((*a - *b).abs().to_num::<f64>() < 1e-5, "{found:?} for {angles:?}");
            }
        }
        let along = chain.angles(Vector::new(0.0, 0.0, 1.0), &[Position::ZERO; 3]);
        assert!(along.is_err_and(|error| error.to_string().contains("singular")), "{along:?}");
    }
}

#[test]
fn machine_data_that_contradict_are_refused_by_name() {
    let good = *universal([4, 0, 1, 2, 3, 5], &[(X, [0; 3]), (Z, [0; 3])]);
    let refused = |change: fn(&mut Universal), name: &str| {
        let mut machine = good;
        change(&mut machine);
        let error = Chain::universal(&machine).expect_err(name).to_string();
        assert!(error.contains(name), "{error}");
    };
    refused(|m| m.number_of_axes = 7, "00289");
    refused(|m| m.chain[1] = 4, "each axis once");
    refused(|m| m.chain[1] = 5, "below number_of_axes");
    refused(|m| m.chain = [0, 4, 1, 2, 3, 5], "side by side");
    refused(|m| m.axis[0].kind = 3, "00291");
    refused(|m| m.axis[0].kind = 2, "three linear axes");
    refused(|m| m.axis[0].orientation = [0.0, 1.0, 0.0], "span space");
    refused(|m| m.axis[3].orientation = [0.0, 0.0, -3.0], "rotary axis before it");
    refused(|m| m.axis[3].orientation = [f64::NAN, 0.0, 0.0], "00292");
    refused(|m| m.axis[3].point[2] = i32::MIN, "00293");
    refused(|m| m.zero_orientation = [1.0, 0.0, 0.0], "does not tilt");
    refused(|m| m.zero_orientation = [0.0; 3], "00285");
    let mut param = [0; 9];
    param[3] = 3_600_001;
    assert!(Chain::ca_head(&CaHead { param }).expect_err("HD4").to_string().contains("index 3"));
}
