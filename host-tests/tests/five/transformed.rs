//! Programs under a transformation: the tip on its path by matrices, and the limits of every axis at every tick.
use glidepath::kinematics::{AXES, Kinematic};
use glidepath::machine::{AxisKind, MachineData};
use glidepath::quantity::Position;
use host_tests::cases::machines;
use host_tests::check;
use host_tests::five_axes::{self, Machine, Numbers};
use host_tests::operate::{Act, Operated, operate_transformed};
use host_tests::properties::permitted;
use std::fmt::Write;

const BLOCKS: usize = 120;

/// How far the tip may be from its path, mm: the bound of the library, and the rounding of set points.
const NEAR: f64 = 10e-6;

/// The axes of a machine, six at most: three linear and three rotary ones.
pub fn axes(slope: u8) -> MachineData<AXES> {
    let mut machine = machines::machine::<AXES>(1000, |_, _| {});
    for (k, axis) in machine.axes.iter_mut().enumerate() {
        machines::accelerations(axis, 2000, 6000);
        machines::ramps(axis, 60_000);
        (axis.vb_max, axis.vb_eilgang) = (500_000, 500_000);
        axis.tr_geom = 10_000;
        if k >= 3 {
            axis.kind = AxisKind::Rotary;
            (axis.vb_max, axis.vb_eilgang) = (120_000, 120_000);
        }
    }
    machine.channel.slope_profile = slope;
    (machine.channel.surface, machine.channel.ptp) = (true, true);
    machine
}

fn run(
    machine: &Machine,
    data: &MachineData<AXES>,
    text: &str,
    acts: &[(usize, Act)],
) -> Result<Operated, String> {
    let kinematics = [Kinematic::new(9, &machine.chain(), data).map_err(|e| e.to_string())?];
    let start = [Position::ZERO; AXES];
    operate_transformed::<AXES, BLOCKS>(text, start, data, &kinematics, (acts, 1000), 4_000_000)
}

/// Limits of every axis at every tick.
fn keeps_limits(data: &MachineData<AXES>, run: &Operated) -> Result<(), String> {
    let slope = data.channel.slope_profile;
    let limits: Vec<_> = data.axes.iter().map(|axis| permitted(axis, slope, true, true, true)).collect();
    check::limits(&run.trace, &limits).map(|_| ())
}

/// The axes at a tick.
fn row(run: &Operated, tick: usize) -> [Position; AXES] {
    let mut row = run.trace.row(tick);
    std::array::from_fn(|_| Position::from_bits(row.next().unwrap_or(0)))
}

/// Tip (mm) and angles (degree).
type Pose = [f64; AXES];

fn pose(machine: &Machine, axes: &[Position; AXES]) -> Pose {
    let [x, y, z] = machine.tip(axes);
    let [.., a, b, c] = axes.map(|x| x.to_num::<f64>());
    [x, y, z, a, b, c]
}

/// A block of a program.
#[derive(Clone, Copy, Debug)]
struct Block {
    from: Pose,
    to: Pose,
    /// Centre and direction (1: counter-clockwise) of an arc in X and Y.
    arc: Option<([f64; 2], f64)>,
}

impl Block {
    /// Angle of an arc, radians.
    fn sweep(&self, centre: [f64; 2], sense: f64) -> f64 {
        let at = |p: &Pose| (p[1] - centre[1]).atan2(p[0] - centre[0]);
        let turn = (sense * (at(&self.to) - at(&self.from))).rem_euclid(std::f64::consts::TAU);
        if turn < 1e-9 { std::f64::consts::TAU } else { turn }
    }

    fn point(&self, share: f64) -> Pose {
        let mut p: Pose = std::array::from_fn(|k| self.from[k] + share * (self.to[k] - self.from[k]));
        if let Some((centre, sense)) = self.arc {
            let [x, y] = [self.from[0] - centre[0], self.from[1] - centre[1]];
            let (s, c) = (sense * share * self.sweep(centre, sense)).sin_cos();
            (p[0], p[1]) = (centre[0] + x * c - y * s, centre[1] + x * s + y * c);
        }
        p
    }

    /// Path length, or degrees where the tip stands.
    fn length(&self) -> f64 {
        let square =
            |range: std::ops::Range<usize>| range.map(|k| (self.to[k] - self.from[k]).powi(2)).sum::<f64>();
        match self.arc {
            Some((centre, sense)) => {
                let r = (self.from[0] - centre[0]).hypot(self.from[1] - centre[1]);
                (r * self.sweep(centre, sense)).hypot(self.to[2] - self.from[2])
            }
            None if square(0..3) > 0.0 => square(0..3).sqrt(),
            None => square(3..AXES).sqrt(),
        }
    }

    /// The share of the block nearest to a pose.
    fn share(&self, p: &Pose) -> f64 {
        let still = self.arc.is_none() && (0..3).all(|k| self.to[k] == self.from[k]);
        let range = if still { 3..AXES } else { 0..3 };
        let share = match self.arc {
            Some((centre, sense)) => {
                let at = |p: &Pose| (p[1] - centre[1]).atan2(p[0] - centre[0]);
                let turn = (sense * (at(p) - at(&self.from))).rem_euclid(std::f64::consts::TAU);
                let sweep = self.sweep(centre, sense);
                if turn > 0.5 * (sweep + std::f64::consts::TAU) { 0.0 } else { turn / sweep }
            }
            None => {
                let dot = |a: &dyn Fn(usize) -> f64, b: &dyn Fn(usize) -> f64| {
                    range.clone().map(|k| a(k) * b(k)).sum::<f64>()
                };
                let d = |k: usize| self.to[k] - self.from[k];
                dot(&|k| p[k] - self.from[k], &d) / dot(&d, &d)
            }
        };
        share.clamp(0.0, 1.0)
    }

    /// How far a pose is off, mm and degree.
    fn off(&self, p: &Pose) -> (f64, f64) {
        // A full circle ends where it begins.
        let [a, b, c] = [self.share(p), 0.0, 1.0].map(|share| self.off_at(p, share));
        let better =
            |a: (f64, f64), b: (f64, f64)| if b.0 < NEAR && (a.0 >= NEAR || b.1 < a.1) { b } else { a };
        better(better(a, b), c)
    }

    fn off_at(&self, p: &Pose, share: f64) -> (f64, f64) {
        let on = self.point(share);
        let tip = (0..3).map(|k| (p[k] - on[k]).powi(2)).sum::<f64>().sqrt();
        // What the tip does not tell of the share the angles do not tell either.
        let per = self.length().max(1e-9);
        let turn = (3..AXES)
            .map(|k| (p[k] - on[k]).abs() - NEAR * (self.to[k] - self.from[k]).abs() / per)
            .fold(0.0, f64::max);
        (tip, turn)
    }
}

/// A random program: text and blocks.
fn program(seed: u64, start: Pose, count: usize, smooth: &str) -> (String, Vec<Block>) {
    let mut r = Numbers(seed);
    let mut text = format!("N1 G90\nN5 A{:.3} B{:.3} C{:.3} F20000\n", start[3], start[4], start[5]);
    let _ = write!(text, "#TRAFO ON\nG01 X{:.3} Y{:.3} Z{:.3}\n{smooth}\n", start[0], start[1], start[2]);
    let (mut at, mut blocks) = (start, Vec::new());
    let round = |x: f64| (x * 1000.0).round() / 1000.0;
    for _ in 0..count {
        let kind = r.within(10.0);
        let feed = 200.0 * (1.0 + r.within(0.9)) * if r.within(1.0) > 0.0 { 100.0 } else { 3.0 };
        let size = if r.within(1.0) > 0.0 { 20.0 } else { 0.5 };
        let mut to = at;
        let turns = r.within(1.0) > -0.4;
        for k in 3..AXES {
            if turns {
                let most = if r.within(1.0) > 0.5 { 40.0 } else { 2.0 };
                to[k] = round(at[k] + r.within(most));
            }
        }
        let arc = (kind > 4.0).then(|| {
            let centre = [round(at[0] + r.within(size) + 0.05), round(at[1] + r.within(size))];
            let sense = if r.within(1.0) > 0.0 { 1.0 } else { -1.0 };
            // A point of the circle where decimals end: the start, or the opposite one.
            if r.within(1.0) > 0.0 {
                (to[0], to[1]) = (round(2.0 * centre[0] - at[0]), round(2.0 * centre[1] - at[1]));
            }
            to[2] = round(at[2] + if r.within(1.0) > 0.0 { r.within(size) } else { 0.0 });
            (centre, sense)
        });
        if arc.is_none() && kind > -8.0 {
            for k in 0..3 {
                to[k] = round(at[k] + r.within(size));
            }
        }
        if at == to && arc.is_none() {
            continue;
        }
        let g = match arc {
            Some((_, sense)) if sense < 0.0 => "G02",
            Some(_) => "G03",
            None if r.within(1.0) > 0.9 => "G00",
            None => "G01",
        };
        let _ = write!(text, "{g}");
        for (k, name) in ["X", "Y", "Z", "A", "B", "C"].into_iter().enumerate() {
            let _ = write!(text, " {name}{:.3}", to[k]);
        }
        if let Some((centre, _)) = arc {
            let _ = write!(text, " I{:.3} J{:.3}", centre[0] - at[0], centre[1] - at[1]);
        }
        let _ = writeln!(text, " F{feed:.0}");
        blocks.push(Block { from: at, to, arc });
        at = to;
    }
    text += "#TRAFO OFF\nM30\n";
    (text, blocks)
}

/// The tip keeps to the blocks, in their order: largest deviations, mm and degree. `from`: the first tick.
fn follows(machine: &Machine, run: &Operated, blocks: &[Block], from: usize) -> Result<(f64, f64), String> {
    let (mut block, mut most) = (0, (0.0f64, 0.0f64));
    for tick in from..run.trace.len() {
        let p = pose(machine, &row(run, tick));
        let ahead = block..blocks.len().min(block + 6);
        let fits = |k: &usize| {
            let (tip, turn) = blocks[*k].off(&p);
            tip < NEAR && turn < 1e-8
        };
        let tip = |k: &usize| blocks[*k].off(&p).0;
        let near = ahead.clone().filter(fits).min_by(|a, b| tip(a).total_cmp(&tip(b)));
        match near {
            Some(found) => {
                let (tip, turn) = blocks[found].off(&p);
                // An end is a start too: only what is behind counts as passed.
                (block, most) =
                    (ahead.clone().find(fits).unwrap_or(found), (most.0.max(tip), most.1.max(turn)));
            }
            None => {
                let off: Vec<_> = ahead.map(|k| blocks[k].off(&p)).collect();
                return Err(format!("tick {tick}: {p:?} is off block {block}: {off:?} {:?}", blocks[block]));
            }
        }
    }
    Ok(most)
}

/// The tick at which the tip comes to the start of the blocks, after the transformation is on.
fn begins(machine: &Machine, run: &Operated, start: &Pose) -> usize {
    let at = |tick: usize| {
        let p = pose(machine, &row(run, tick));
        (0..AXES).map(|k| (p[k] - start[k]).abs()).fold(0.0, f64::max) < 0.2 * NEAR
    };
    (0..run.trace.len()).find(|tick| at(*tick)).unwrap_or(run.trace.len())
}

fn start_of(r: &mut Numbers) -> Pose {
    let round = |x: f64| (x * 1000.0).round() / 1000.0;
    std::array::from_fn(|k| round(if k < 3 { r.within(200.0) } else { r.within(90.0) }))
}

/// Random programs without smoothing; every third with commands.
fn random(from: u64, count: u64) {
    let machines = five_axes::machines();
    let (mut off, mut ticks) = (0.0f64, 0);
    for seed in from..from + count {
        let machine = &machines[(seed % 6) as usize];
        let data = axes([1, 3, 2][(seed / 6 % 3) as usize]);
        let mut r = Numbers(seed ^ 0x5a5a);
        let start = start_of(&mut r);
        let (text, blocks) = program(seed, start, 12, "");
        let whole = run(machine, &data, &text, &[]).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
        let judge = |run: &Operated| {
            keeps_limits(&data, run).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
            let first = begins(machine, run, &start);
            let most = follows(machine, run, &blocks, first);
            most.unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}")).0
        };
        off = off.max(judge(&whole));
        ticks += whole.trace.len();
        let end = row(&whole, whole.trace.len() - 1);
        let mut acts = Vec::new();
        let mut at = 0;
        for _ in 0..4 {
            at += (whole.trace.len() as f64 * 0.15 * (1.0 + r.within(1.0))) as usize;
            match (r.within(4.0) + 4.0) as usize {
                0 | 1 => acts.extend([(at, Act::Hold), (at + 300, Act::Resume)]),
                2 | 3 => acts.push((at, Act::Override((500.0 + r.within(450.0)) as u16))),
                4 | 5 => acts.push((at, Act::Stall(200))),
                _ => acts.push((at, Act::Starve(100))),
            }
        }
        acts.sort_by_key(|(at, _)| *at);
        let disturbed =
            run(machine, &data, &text, &acts).unwrap_or_else(|e| panic!("seed {seed}: {e} {acts:?}\n{text}"));
        off = off.max(judge(&disturbed));
        assert_eq!(row(&disturbed, disturbed.trace.len() - 1), end, "seed {seed}: the end");
        let stop = [(at.min(whole.trace.len() * 2 / 3), Act::Abort)];
        let aborted = run(machine, &data, &text, &stop).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        off = off.max(judge(&aborted));
    }
    println!("{count} programs, {ticks} ticks: tip off by {:.3} nm at most", off * 1e6);
}

/// A number of the environment.
fn wanted(name: &str, without: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(without)
}

/// D3-009: elements are split until the tip keeps to its path.
#[test]
fn random_programs_keep_to_their_path_and_limits() {
    random(0, 18);
}

#[test]
#[ignore = "3,000 random programs"]
fn random_programs_keep_to_their_path_and_limits_3000_times() {
    random(wanted("GLIDEPATH_FROM", 1_000), wanted("GLIDEPATH_SEEDS", 3_000));
}

/// Commands of smoothing, and how far the tip may then be from the programmed lines, mm.
const SMOOTHING: [(&str, f64); 8] = [
    ("#CONTOUR MODE ON [DEV PATH_DEV=0.05]", 0.05),
    ("#CONTOUR MODE ON [DEV PATH_DEV=0.02 TRACK_DEV=0.1]", 0.02),
    ("#CONTOUR MODE ON [PTP PATH_DEV=0.05]", 0.05),
    ("#CONTOUR MODE ON [DIST PRE_DIST=0.3 POST_DIST=0.5]", f64::INFINITY),
    ("#CONTOUR MODE ON [DIST_SOFT PATH_DIST=0.5]", f64::INFINITY),
    ("#CONTOUR MODE ON [POS PRE_DIST=0.4 POST_DIST=0.4]", f64::INFINITY),
    ("#HSC ON [SURFACE PATH_DEV=0.05]", 0.05),
    ("#HSC ON [BSPLINE PATH_DEV=0.05]", 0.05),
];

/// The method with this tolerance of the angles, degree.
const TRACKED: usize = 1;
const TRACK_DEV: f64 = 0.1;

/// The part of both tolerances that a pose uses at the best place of the lines.
fn used(blocks: &[Block], p: &Pose, [dev, track]: [f64; 2]) -> f64 {
    let part = |block: &Block, share: f64| {
        let (tip, turn) = block.off_at(p, share);
        (tip / dev).max(turn / track)
    };
    let of = |block: &Block| {
        // Both parts are convex over the share.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if part(block, a) < part(block, b) { high = b } else { low = a }
        }
        part(block, 0.5 * (low + high))
    };
    blocks.iter().filter(|b| b.off_at(p, b.share(p)).0 < dev).map(of).fold(f64::INFINITY, f64::min)
}

/// A random program of lines: short ones with small turns, and long ones. One of `between` stands before every sixth
/// line.
fn lines(seed: u64, start: Pose, smooth: &str, between: &[&str]) -> (String, Vec<Block>) {
    let (mut r, mut of) = (Numbers(seed), Numbers(seed ^ 0x77));
    let mut text = format!("N1 G90\nG00 A{:.3} B{:.3} C{:.3}\n", start[3], start[4], start[5]);
    let _ = write!(
        text,
        "#TRAFO ON\nG00 X{:.3} Y{:.3} Z{:.3}\nG04 0.01\nG01 F6000\n{smooth}\n",
        start[0], start[1], start[2]
    );
    let (mut at, mut blocks) = (start, Vec::new());
    let round = |x: f64| (x * 1000.0).round() / 1000.0;
    let mut heading: [f64; 3] = [1.0, 0.3, 0.1];
    for _ in 0..30 {
        let long = r.within(1.0) > 0.7;
        let length = if long { 8.0 + r.within(7.0) } else { 0.4 + r.within(0.2) };
        let knee = if r.within(1.0) > 0.6 { 1.5 } else { 0.1 };
        for x in &mut heading {
            *x += r.within(knee);
        }
        let size = heading.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut to = at;
        for k in 0..3 {
            to[k] = round(at[k] + length * heading[k] / size);
        }
        for k in 3..AXES {
            to[k] = round(at[k] + r.within(if long { 10.0 } else { 0.3 }));
        }
        if !between.is_empty() && of.within(1.0) > 2.0 / 3.0 {
            let place = (of.within(0.5) + 0.5) * between.len() as f64;
            text += between[(place as usize).min(between.len() - 1)];
        }
        let _ = write!(text, "G01");
        for (k, name) in ["X", "Y", "Z", "A", "B", "C"].into_iter().enumerate() {
            let _ = write!(text, " {name}{:.3}", to[k]);
        }
        text.push('\n');
        blocks.push(Block { from: at, to, arc: None });
        at = to;
    }
    text += "#CONTOUR MODE OFF\n#HSC OFF\n#TRAFO OFF\nM30\n";
    (text, blocks)
}

/// Smoothed programs: the tip inside its tolerance, the limits of every axis, with commands and without.
fn smoothed(from: u64, count: u64) {
    let machines = five_axes::machines();
    let (mut worst, mut ticks) = ([0.0f64; SMOOTHING.len()], [0; SMOOTHING.len()]);
    for seed in from..from + count {
        let machine = &machines[(seed / 8 % 6) as usize];
        let data = axes([3, 1, 2][(seed / 3 % 3) as usize]);
        let method = (seed % 8) as usize;
        let (smooth, dev) = SMOOTHING[method];
        let mut r = Numbers(seed ^ 0x1234);
        let start = start_of(&mut r);
        let (text, blocks) = lines(seed, start, smooth, &[]);
        let whole = run(machine, &data, &text, &[]).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
        ticks[method] += whole.trace.len();
        let at = |share: f64| (whole.trace.len() as f64 * share) as usize;
        let acts = [
            (at(0.4), Act::Hold),
            (at(0.4) + 400, Act::Resume),
            (at(0.6), Act::Override(600)),
            (at(0.7), Act::Stall(150)),
        ];
        let disturbed =
            run(machine, &data, &text, &acts).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
        for run in [&whole, &disturbed] {
            keeps_limits(&data, run).unwrap_or_else(|e| panic!("seed {seed}, {smooth}: {e}\n{text}"));
            let first = begins(machine, run, &start);
            assert!(first < run.trace.len(), "seed {seed}");
            for tick in first..run.trace.len() {
                let p = pose(machine, &row(run, tick));
                let off = blocks
                    .iter()
                    .map(|block| block.off_at(&p, block.share(&p)).0)
                    .fold(f64::INFINITY, f64::min);
                worst[method] = worst[method].max(off);
                assert!(off < dev + NEAR, "seed {seed}, {smooth}: {off} mm off at tick {tick}\n{text}");
                if method == TRACKED {
                    let used = used(&blocks, &p, [dev, TRACK_DEV]);
                    assert!(
                        used < 1.0 + 1e-3,
                        "seed {seed}: {used} of both tolerances at tick {tick}\n{text}"
                    );
                }
            }
        }
        let last = |run: &Operated| row(run, run.trace.len() - 1);
        assert_eq!(last(&whole), last(&disturbed), "seed {seed}: the end");
    }
    println!("{count} smoothed programs: tip off by {worst:?} mm at most, ticks {ticks:?}");
}

/// D3-125: corners under a transformation have their distance.
#[test]
fn smoothed_programs_keep_to_their_tolerance_and_limits() {
    smoothed(0, 24);
}

#[test]
#[ignore = "1,000 smoothed programs"]
fn smoothed_programs_keep_to_their_tolerance_and_limits_1000_times() {
    smoothed(wanted("GLIDEPATH_FROM", 100), wanted("GLIDEPATH_SEEDS", 1_000));
}

/// Commands between two lines. With each of them the tip stays within `SWITCHED` of the lines.
const BETWEEN: [&str; 14] = [
    "#CONTOUR MODE ON [DEV PATH_DEV=0.05]\n",
    "#CONTOUR MODE ON [DEV PATH_DEV=0.02 TRACK_DEV=0.5]\n",
    "#CONTOUR MODE [DEV PATH_DEV=0.05 MAX_ANGLE=20]\n",
    "#CONTOUR MODE ON [DEV PATH_DEV=0.05 CONST_VEL=1]\n",
    "#CONTOUR MODE ON [DEV PATH_DEV=0.03 RELEVANT_PATH=0.01]\n",
    "#CONTOUR MODE ON [DIST PRE_DIST=0.05 POST_DIST=0.05]\n",
    "#CONTOUR MODE ON [PTP PATH_DEV=0.03]\n",
    "#CONTOUR MODE OFF\n",
    "G261\n",
    "G260 ",
    "G61 ",
    "G04 0.01\n",
    "#HSC ON [SURFACE PATH_DEV=0.04]\n",
    "#HSC OFF\n#TRAFO OFF\n#TRAFO ON\n#CONTOUR MODE ON [DEV PATH_DEV=0.05 CONST_VEL=0 RELEVANT_PATH=0]\n",
];
const SWITCHED: f64 = 0.05;

/// Programs in which commands of smoothing stand between the lines, while DEV is on at the start.
fn switched(from: u64, count: u64) {
    let (machines, mut worst) = (five_axes::machines(), 0.0f64);
    for seed in from..from + count {
        let machine = &machines[(seed % 6) as usize];
        let data = axes([3, 1, 2, 0][(seed / 6 % 4) as usize]);
        let start = start_of(&mut Numbers(seed ^ 0x4321));
        let (text, blocks) = lines(seed, start, "#CONTOUR MODE ON [DEV PATH_DEV=0.05]", &BETWEEN);
        let whole = run(machine, &data, &text, &[]).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
        let at = |share: f64| (whole.trace.len() as f64 * share) as usize;
        let acts = [(at(0.3), Act::Hold), (at(0.3) + 400, Act::Resume), (at(0.5), Act::Starve(100))];
        let held = run(machine, &data, &text, &acts).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
        for run in [&whole, &held] {
            keeps_limits(&data, run).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
            for tick in begins(machine, run, &start)..run.trace.len() {
                let p = pose(machine, &row(run, tick));
                let off = |block: &Block| block.off_at(&p, block.share(&p)).0;
                let off = blocks.iter().map(off).fold(f64::INFINITY, f64::min);
                worst = worst.max(off);
                assert!(off < SWITCHED + NEAR, "seed {seed}: {off} mm off at tick {tick}\n{text}");
            }
        }
        let last = |run: &Operated| pose(machine, &row(run, run.trace.len() - 1));
        let (end, to) = (last(&whole), blocks.last().expect("lines").to);
        assert!((0..AXES).all(|k| (end[k] - to[k]).abs() < NEAR), "seed {seed}: ends at {end:?}, not {to:?}");
        assert_eq!(end, last(&held), "seed {seed}: the end");
    }
    println!("{count} programs with commands between lines: tip off by {worst:?} mm at most");
}

/// DEV under a transformation: text that arrives late does not change the path of the tip.
#[test]
fn late_text_leaves_the_path_of_dev() {
    let machine = &five_axes::machines()[0];
    let data = axes(3);
    for seed in [0, 1] {
        let start = start_of(&mut Numbers(seed));
        let (text, _) = lines(seed, start, "#CONTOUR MODE ON [DEV PATH_DEV=0.05]", &[]);
        // Set points are close together, so the chords between them are the path.
        let text = text.replace("F6000", "F1500");
        let tips = |acts: &[(usize, Act)]| -> (Vec<Pose>, usize) {
            let run = run(machine, &data, &text, acts).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
            let begins = begins(machine, &run, &start);
            ((begins..run.trace.len()).map(|tick| pose(machine, &row(&run, tick))).collect(), begins)
        };
        let (whole, begins) = tips(&[]);
        // Some lines are there when the motion begins, the others come much later.
        let (late, _) = tips(&[(0, Act::Slow(1)), (400, Act::Starve(begins + 2000))]);
        assert!(late.len() > whole.len() + 500, "seed {seed}: the text is not late");
        let mut at = 0;
        for p in &late {
            let off = |k: &usize| {
                let chord = Block { from: whole[*k], to: whole[(*k + 1).min(whole.len() - 1)], arc: None };
                if chord.from == chord.to { f64::INFINITY } else { chord.off_at(p, chord.share(p)).0 }
            };
            let ahead = at..(at + 40).min(whole.len() - 1);
            let Some(near) = ahead.min_by(|a, b| off(a).total_cmp(&off(b))) else { break };
            assert!(off(&near) < 1e-3 || off(&near).is_infinite(), "seed {seed}: {} mm off", off(&near));
            at = near;
        }
    }
}

/// DEV under a transformation: commands of smoothing take effect between any two lines.
#[test]
fn commands_between_lines_keep_the_tolerance() {
    switched(0, 24);
}

#[test]
#[ignore = "1,000 programs with commands between their lines"]
fn commands_between_lines_keep_the_tolerance_1000_times() {
    switched(wanted("GLIDEPATH_FROM", 100), wanted("GLIDEPATH_SEEDS", 1_000));
}

/// What is said about a program on the CA head of [`five_axes::machines`], or how far it comes.
fn said(text: &str, data: &MachineData<AXES>) -> String {
    match run(&five_axes::machines()[0], data, text, &[]) {
        Ok(run) => format!("{:?}", row(&run, run.trace.len() - 1).map(|x| x.to_num::<f64>())),
        Err(error) => error,
    }
}

/// NC-009: #KIN ID and #TRAFO, and 20687.
#[test]
fn commands_of_the_transformation() {
    let data = axes(1);
    assert!(said("#KIN ID[5]\nM30\n", &data).contains("Unknown(5)"));
    assert!(
        said("#TRAFO ON\n#KIN ID[9]\n#TRAFO[9]\n#TRAFO ON\n#TRAFO OFF\n#TRAFO OFF\nM30\n", &data)
            .starts_with('[')
    );
    assert!(said("#TRAFO ON\n#TRAFO[5]\nM30\n", &data).contains("Active(9)"));
    for (command, words) in [
        ("#PUT AX [Z]", "#PUT AX of an axis of the transformation"),
        ("#PUT AX [A]", "#PUT AX of an axis of the transformation"),
    ] {
        assert!(said(&format!("#TRAFO ON\n{command}\nM30\n"), &data).contains(words), "{command}");
    }
    assert!(said("#PUT AX [Z]\n#TRAFO ON\nM30\n", &data).contains("released by #PUT AX"));
    // The tip stays while the head turns: the linear axes carry it. Behind #TRAFO OFF the program stands at the axes.
    let stands = said("#TRAFO ON\nG91 G01 A0 B30 C0 F1000\n#TRAFO OFF\nG91 X1\nM30\n", &data);
    assert!(stands.contains("30.0"), "{stands}");
}

/// Software limits are those of the axes, along the whole of a block, before it moves.
#[test]
fn software_limits_are_those_of_the_axes() {
    let mut data = axes(1);
    // The head turns about the tip at rest: an axis leaves its limit although the tip stays.
    let text = "N10 #TRAFO ON\nN20 G91 G01 B60 F1000\nM30\n";
    assert!(said(text, &data).starts_with('['));
    data.axes[0].swe_pos = 50 * 10_000;
    data.axes[0].swe_neg = -50 * 10_000;
    let refused = said(text, &data);
    assert!(refused.contains("SoftwareLimit") && refused.contains("line: 2"), "{refused}");
}
