//! #HSC [SURFACE]: the path against its tolerance, the limits and the exact ends, by a judge that knows the
//! programmed contour alone; what the commands do, and when they are refused.
use glidepath::machine::{AxisKind, MachineData, Synch, SynchTable};
use glidepath::quantity::Position;
use host_tests::cases::machines;
use host_tests::cases::random::Random;
use host_tests::check::{self, Limits};
use host_tests::deviation::follows;
use host_tests::trace::{Run, run_text};

/// Three axes of 2000 mm/s² and 1000 mm/s with these ramps (µs), the fourth a rotary one of 4000 degrees/s².
fn machine<const AXES: usize>(ramp: u32, slope: u8) -> MachineData<AXES> {
    let mut machine = machines::even::<AXES>(1000);
    for (k, axis) in machine.axes.iter_mut().enumerate() {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        axis.a_max = 2000;
        machines::accelerations(axis, 2000, 2000);
        machines::ramps(axis, ramp);
        axis.tr_geom = ramp;
        if k == 3 {
            axis.kind = AxisKind::Rotary;
        }
    }
    machine.channel.slope_profile = slope;
    machine.channel.surface = true;
    machine.channel.corr_v_trans_jerk = true;
    machine.channel.m_synch = SynchTable::NONE.with(25, Synch::Mos);
    machine
}

/// SIN2 has the jerk of its steepest place.
fn limits<const AXES: usize>(ramp: u32, slope: u8) -> [Limits; AXES] {
    let steep = if slope == 2 { std::f64::consts::FRAC_PI_2 } else { 1.0 };
    [Limits { v: 1000.0, a: 2000.0, jerk: steep * 2000.0 / (f64::from(ramp) * 1e-6) }; AXES]
}

fn go<const AXES: usize>(text: &str, machine: &MachineData<AXES>) -> Run {
    run_text::<AXES, 120>(text, [Position::ZERO; AXES], machine, 1).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// A program of corners with its contour.
struct Walk {
    text: String,
    points: Vec<Vec<f64>>,
    /// Places to be met exactly.
    exact: Vec<Vec<f64>>,
}

/// Places are multiples of this.
const STEP: f64 = 1e-6;

/// Lines and arcs with turns of any size, lengths of 1 µm to 100 mm, reversals, other feeds and functions.
fn walk(seed: u64, axes: usize, blocks: usize, [dev, track]: [f64; 2]) -> Walk {
    let mut r = Random::new(seed);
    let words = ["", " MERGE=1", " CIR_MODE=0", " CIR_MODE=2 LENGTH_LONG_CIR=0.1", " CIR_MIN_RADIUS=5"];
    let words = words[seed as usize % 5];
    let mut text = format!("#HSC ON [SURFACE PATH_DEV={dev} TRACK_DEV={track}{words}]\nG01 F6000\n");
    let mut at = vec![0.0; axes];
    let (mut points, mut exact) = (vec![at.clone()], vec![]);
    let mut heading = r.between(-180.0, 180.0);
    let gentle = r.between(1.0, 60.0);
    let least = r.magnitude(0.001, 1.0);
    let most = least * r.magnitude(2.0, 100.0);
    for n in 1..=blocks {
        let knee = if r.once_in(8) { 180.0 } else { gentle };
        heading += if r.once_in(40) { 180.0 } else { r.between(-knee, knee) };
        let (sin, cos) = heading.to_radians().sin_cos();
        let length = r.magnitude(least, most).min(100.0);
        let from = at.clone();
        for (k, d) in [cos, sin, r.between(-0.3, 0.3)].into_iter().enumerate() {
            at[k] = ((at[k] + length * d) / STEP).round() * STEP;
        }
        if axes > 3 && !r.once_in(4) {
            at[3] = ((at[3] + r.between(-1.0, 1.0) * length.min(10.0)) / STEP).round() * STEP;
        }
        if r.once_in(9) {
            text += &format!("F{}\n", r.between(500.0, 20_000.0).round());
        }
        let names = ["X", "Y", "Z", "A"];
        let words: String = names.iter().zip(&at).map(|(name, x)| format!(" {name}{x:.6}")).collect();
        let stop = r.once_in(25);
        let line = if stop { "G60" } else { "" };
        if r.once_in(6) && length > 0.05 {
            // By a radius: between once and thrice half the chord.
            let half = 0.5 * (at[0] - from[0]).hypot(at[1] - from[1]);
            let radius = (half * r.between(1.01, 3.0) / STEP).ceil() * STEP;
            text += &format!("N{n} {line} G02{words} R{radius:.6}\nG01\n");
            points.extend(arc(&from, &at, radius));
        } else {
            text += &format!("N{n} {line}{words}\n");
        }
        points.push(at.clone());
        if stop {
            exact.push(at.clone());
        }
        if r.once_in(20) {
            text += "M25\n";
        }
    }
    text += "#HSC OFF\nM30\n";
    exact.push(at);
    Walk { text, points, exact }
}

/// Points of a clockwise arc of less than 180 degrees in X and Y.
fn arc(from: &[f64], to: &[f64], radius: f64) -> Vec<Vec<f64>> {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let chord = dx.hypot(dy);
    let height = (radius * radius - 0.25 * chord * chord).max(0.0).sqrt();
    let centre = [from[0] + 0.5 * dx + height * dy / chord, from[1] + 0.5 * dy - height * dx / chord];
    let begin = (from[1] - centre[1]).atan2(from[0] - centre[0]);
    let sweep = 2.0 * (0.5 * chord / radius).min(1.0).asin();
    // Points within a tenth of a micrometre of the arc.
    let count = (sweep * (radius / 8e-4).sqrt()).ceil().max(4.0);
    (1..count as u32)
        .map(|k| {
            let part = f64::from(k) / count;
            let angle = begin - part * sweep;
            let mut point: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + (b - a) * part).collect();
            point[0] = centre[0] + radius * angle.cos();
            point[1] = centre[1] + radius * angle.sin();
            point
        })
        .collect()
}

/// What a tick of chord and the points of an arc may miss, mm.
const SAMPLED: f64 = 5e-4;

fn judge<const AXES: usize>(seed: u64, blocks: usize, ramp: u32, slope: u8) -> Result<(), String> {
    let mut r = Random::new(seed ^ 0x5eed);
    let (dev, track) = (r.magnitude(0.001, 0.3), r.magnitude(0.01, 2.0));
    let walk = walk(seed, AXES, blocks, [dev, track]);
    let start = [Position::ZERO; AXES];
    let run = run_text::<AXES, 120>(&walk.text, start, &machine(ramp, slope), 1)?;
    if slope != 0 {
        check::limits(&run.trace, &limits::<AXES>(ramp, slope))?;
    }
    let bits = |point: &[f64]| -> Vec<i64> {
        point.iter().map(|x| ((x / STEP).round() * STEP * (1u64 << 32) as f64).round() as i64).collect()
    };
    // Decimals are rounded once: a bit beside is the same place.
    let near = |row: usize, point: &[i64]| run.trace.row(row).zip(point).all(|(a, b)| (a - b).abs() <= 1);
    let mut from = 0;
    for point in walk.exact.iter().map(|point| bits(point)) {
        let found = (from..run.trace.len()).find(|row| near(*row, &point));
        from = found.ok_or_else(|| format!("{point:?} is not met"))?;
    }
    if !near(run.trace.len() - 1, &bits(walk.exact.last().expect("an end"))) {
        return Err("does not end at its end".into());
    }
    let path: Vec<_> = (0..run.trace.len()).map(|row| run.trace.mm(row)).collect();
    if !follows(&path, &walk.points, [dev + SAMPLED, track + SAMPLED]) {
        return Err(format!("not within {dev} mm, {track} degrees"));
    }
    Ok(())
}

fn seeds(default: u64) -> std::ops::Range<u64> {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse().ok());
    let first = number("SURFACE_FIRST").unwrap_or(0);
    first..first + number("SURFACE_SEEDS").unwrap_or(default)
}

/// D3-162, D3-164, D3-166: tolerances, limits and exact ends of random paths.
#[test]
fn random_paths_keep_tolerance_limits_and_ends() {
    paths_are_inside(seeds(60));
}

/// D3-162: where the control polygon itself leaves the tolerance and nothing turns, a line is refused.
#[test]
fn lines_between_kernels_are_proven_too() {
    paths_are_inside([5908, 1830, 11_295, 15_789]);
}

fn paths_are_inside(seeds: impl IntoIterator<Item = u64>) {
    let mut faults = 0;
    for seed in seeds {
        let slope = [3, 3, 1, 2, 0][seed as usize % 5];
        let ramp = [50_000, 150_000][seed as usize / 5 % 2];
        let judge = if seed % 3 == 0 { judge::<4> } else { judge::<3> };
        if let Err(fault) = judge(seed, 40, ramp, slope) {
            println!("seed {seed}: slope {slope}, ramps {ramp} µs: {}", fault.lines().next().unwrap_or(""));
            faults += 1;
        }
    }
    assert_eq!(faults, 0);
}

fn chords(feed: u32, words: &str, on: &str) -> String {
    let mut text = format!("G01 X80 F{feed}\n{on}\nX160\n");
    for k in 1..=64 {
        let a = f64::from(k) * std::f64::consts::TAU / 64.0;
        text += &format!("X{:.6} Y{:.6}\n", 160.0 + 80.0 * a.sin(), 80.0 * (1.0 - a.cos()));
    }
    text + words + "X240\n#HSC OFF\nM30\n"
}

/// D3-159: chords of a circle are passed at the feed, and the feed is never exceeded.
#[test]
fn chords_of_a_circle_run_at_the_feed_d3_159() {
    let run = go::<3>(&chords(20_000, "", "#HSC ON [SURFACE PATH_DEV=0.1]"), &machine(50_000, 3));
    let rows: Vec<_> = (0..run.trace.len()).map(|row| run.trace.mm(row)).collect();
    let mut at_feed = 0;
    for pair in rows.windows(2) {
        let v = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]) * 1000.0;
        assert!(v <= 20_000.0 / 60.0 * (1.0 + 1e-6), "{v} mm/s");
        at_feed += u32::from(v > 0.99 * 20_000.0 / 60.0 && pair[0][1] > 20.0);
    }
    assert!(at_feed > 1000, "{at_feed} ticks");
    // The circle behind the chords comes back.
    for row in rows.iter().filter(|row| row[1] > 5.0) {
        let off = (row[0] - 160.0).hypot(row[1] - 80.0) - 80.0;
        assert!(off.abs() < 0.01, "{off} at {row:?}");
    }
}

/// D3-177, D3-181, D3-182: parameters before ON are those of ON itself.
#[test]
fn parameters_may_come_before_d3_177() {
    let machine = machine::<3>(50_000, 3);
    let at_once = go(&chords(6000, "", "#HSC ON [SURFACE PATH_DEV=0.05 CHECK_JERK=0]"), &machine);
    let steps = "#HSC [SURFACE PATH_DEV=0.05]\n#HSC [SURFACE CHECK_JERK=0]\n#HSC ON";
    assert_eq!(at_once.digest, go(&chords(6000, "", steps), &machine).digest);
    let other = go(&chords(6000, "", "#HSC ON [SURFACE PATH_DEV=0.06 CHECK_JERK=0]"), &machine);
    assert_ne!(at_once.digest, other.digest);
}

/// D3-179: parameters do not change while it is on.
#[test]
fn parameters_stay_while_it_is_on_d3_179() {
    let machine = machine::<3>(50_000, 3);
    let plain = go(&chords(6000, "", "#HSC ON [SURFACE PATH_DEV=0.05]"), &machine);
    let on = "#HSC ON [SURFACE PATH_DEV=0.05]\n#HSC [SURFACE PATH_DEV=0.2]";
    assert_eq!(plain.digest, go(&chords(6000, "", on), &machine).digest);
}

/// D3-007, D3-180: without FCT_SURFACE it is refused.
#[test]
fn it_is_enabled_by_machine_data_d3_180() {
    let mut machine = machine::<3>(50_000, 3);
    machine.channel.surface = false;
    let text = chords(6000, "", "#HSC ON [SURFACE]");
    let refused = run_text::<3, 120>(&text, [Position::ZERO; 3], &machine, 1).expect_err("not enabled");
    assert!(refused.contains("FCT_SURFACE"), "{refused}");
}

/// D3-172: lines that are nearly straight become one, inside the tolerance.
#[test]
fn merge_makes_fewer_of_them_d3_172() {
    let path = |on: &str| {
        let mut text = format!("G01 F6000\n{on}\n");
        for k in 1..=200 {
            let x = 0.1 * f64::from(k);
            text += &format!("X{x:.6} Y{:.6}\n", 0.001 * f64::from(k % 2) + 0.002 * x * x);
        }
        text + "#HSC OFF\nM30\n"
    };
    let with = |merge: u32| path(&format!("#HSC ON [SURFACE PATH_DEV=0.05 MERGE={merge}]"));
    assert_ne!(go::<3>(&with(1), &machine(50_000, 3)).digest, go::<3>(&with(0), &machine(50_000, 3)).digest);
}

/// D3-168, D3-163: G00 is passed as it is with AUTO_OFF_G00, and has its own tolerance.
#[test]
fn rapid_blocks_have_their_own_tolerance_d3_163() {
    let off = |words: &str| {
        let text =
            format!("#HSC ON [SURFACE PATH_DEV=0.01 {words}]\nG00 X50\nX100 Y30\nX150\n#HSC OFF\nM30\n");
        let run = go::<3>(&text, &machine(50_000, 3));
        let rows = (0..run.trace.len()).map(|row| run.trace.mm(row));
        rows.map(|q| (q[0] - 50.0).hypot(q[1])).fold(f64::INFINITY, f64::min)
    };
    let [plain, wide, exact] = ["", "PATH_DEV_G00=1", "AUTO_OFF_G00=1"].map(off);
    assert!(plain > 0.003 && plain <= 0.01 + 1e-9, "{plain}");
    assert!(wide > 0.3 && wide <= 1.0, "{wide}");
    assert!(exact < 1e-6, "{exact}");
}

/// D3-166: beyond MAX_ANGLE the corner stays.
#[test]
fn sharp_turns_stay_d3_166() {
    let off = |angle: u32| {
        let text =
            format!("#HSC ON [SURFACE PATH_DEV=0.1 MAX_ANGLE={angle}]\nG01 F6000 X50\nY50\n#HSC OFF\nM30\n");
        let run = go::<3>(&text, &machine(50_000, 3));
        let rows = (0..run.trace.len()).map(|row| run.trace.mm(row));
        rows.map(|q| (q[0] - 50.0).hypot(q[1])).fold(f64::INFINITY, f64::min)
    };
    assert!(off(80) < 1e-6 && off(100) > 0.05, "{} {}", off(80), off(100));
}

/// D3-160 and the memory: what Surface holds.
#[test]
fn its_memory_is_that_of_a_window() {
    let bytes = std::mem::size_of::<glidepath::smooth::surface::Surface<3>>();
    println!("{bytes} bytes for three axes");
    assert!(bytes <= 9216, "{bytes}");
}
