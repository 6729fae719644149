//! Corners do not slow the motion down without need: not by the rest between two curves, not by a curve that
//! is slower than a stop, not by permitted jerk that stays unused.
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use host_tests::cam;
use host_tests::cases::machines;
use host_tests::cases::random::Random;
use host_tests::check;
use host_tests::properties::permitted;
use host_tests::rounded::{Run, quick, run_from};

const STEP: u8 = 0;
const TRAPEZ: u8 = 1;
const SIN2: u8 = 2;
const HSC: u8 = 3;

/// [`quick`] with a slope, and ramps and a geometric ramp of so many µs.
fn machine(slope: u8, [ramp, geometric]: [u32; 2], cycle_us: u32) -> MachineData<3> {
    let mut machine = machines::with_slope(quick::<3>(cycle_us), slope);
    for axis in &mut machine.axes {
        machines::ramps(axis, ramp);
        axis.tr_geom = geometric;
    }
    machine
}

const EVEN: [u32; 2] = [50_000; 2];
const SOFT: [u32; 2] = [150_000, 10_000];

/// Runs a text; every axis keeps its limits at every tick.
fn run(text: &str, machine: &MachineData<3>) -> Run {
    let run = run_from(text, [Position::ZERO; 3], machine);
    let slope = machine.channel.slope_profile;
    let limits: Vec<_> = machine.axes.iter().map(|axis| permitted(axis, slope, false, true, true)).collect();
    check::limits(&run.trace, &limits).unwrap_or_else(|fault| panic!("{fault}\n{text}"));
    run
}

fn dev(path_dev: f64) -> String {
    format!("#CONTOUR MODE ON [DEV PATH_DEV={path_dev}]")
}

/// Chords of a circle of 80 mm between tangential lines of 80 mm.
fn circle(mode: &str, chords: u32, decimals: usize) -> String {
    let mut text = format!("{mode}\nN1 G01 X80 F20000\n");
    for i in 1..=chords {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(chords);
        let [x, y] = [80.0 + 80.0 * angle.sin(), 80.0 - 80.0 * angle.cos()];
        text += &format!("N{} X{x:.decimals$} Y{y:.decimals$}\n", i + 1);
    }
    text + "N999 G260 X160\nM30\n"
}

#[test]
fn chords_that_their_curves_use_up_are_as_fast_as_both_curves() {
    let machine = machine(HSC, EVEN, 1000);
    for decimals in [3, 4, 6] {
        let time = run(&circle(&dev(0.1), 64, decimals), &machine).time();
        println!("64 chords with {decimals} decimals: {time:.3} s");
        assert!(time <= 4.2, "{decimals} decimals: {time}");
    }
    // With a tenth of each block left between its curves nothing can be a sliver.
    for chords in [32, 48, 64, 80, 100] {
        for decimals in [3, 5] {
            let time = |rest: &str| {
                run(
                    &circle(&format!("#CONTOUR MODE ON [DEV PATH_DEV=0.1 {rest}]"), chords, decimals),
                    &machine,
                )
                .time()
            };
            let [all, parted] = [time(""), time("REMAIN_PART=10")];
            println!("{chords} chords, {decimals} decimals: {all:.3} s, {parted:.3} s with lines between");
            assert!(all <= 1.05 * parted, "{chords} chords, {decimals} decimals: {all} {parted}");
        }
    }
}

#[test]
fn three_lines_that_their_curves_use_up() {
    for mode in ["PTP", "DEV PATH_DEV=0.1", "DEV PATH_DEV=1"] {
        for x in [15.511, 15.511_000_1, 15.511_01, 15.512] {
            let text = format!(
                "#CONTOUR MODE ON [{mode}]\nN5 G01 X-7.85 F20000\nN10 X0\nN15 X7.812 Y0.769\nN20 X{x} Y2.3\nN30 X23.023 Y4.579\nN40 G260 X30\nM30\n"
            );
            let run = run(&text, &machine(HSC, EVEN, 1000));
            let speeds = run.speeds();
            let inside = (0..speeds.len()).filter(|i| {
                let x = run.trace.mm(i + 1)[0];
                *i > 300 && (4.0..19.0).contains(&x)
            });
            let slowest = inside.map(|i| speeds[i]).fold(f64::INFINITY, f64::min);
            assert!(slowest > 60.0 && slowest < 1e3, "{mode} X{x}: {slowest} mm/s");
        }
    }
}

/// Between two arcs of 20 mm, the second of which turns on or back, a line.
fn between_arcs(line: f64, back: bool) -> String {
    let y = -20.0 - line;
    let last =
        if back { format!("G03 X90 Y{} I20", y - 20.0) } else { format!("G02 X50 Y{} I-20", y - 20.0) };
    let end = if back { 140 } else { 0 };
    format!("N10 G01 X50 F6000\nN20 G02 X70 Y-20 J-20\nN30 G01 Y{y}\nN40 {last}\nN50 G01 X{end}\nM30\n")
}

#[test]
fn a_tenth_of_a_micrometre_between_arcs_is_passed_like_a_millimetre() {
    for slope in [STEP, TRAPEZ, SIN2, HSC] {
        for cycle_us in [1000, 10_000] {
            for back in [false, true] {
                let machine = machine(slope, EVEN, cycle_us);
                let slowest = |line: f64| {
                    let run = run(&between_arcs(line, back), &machine);
                    let speeds = run.speeds();
                    let near = (1..speeds.len()).filter(|&i| {
                        let q = run.trace.mm(i);
                        (q[0] - 70.0).abs() < 1.0 && (q[1] + 20.0).abs() < 6.0
                    });
                    near.map(|i| speeds[i]).fold(f64::INFINITY, f64::min)
                };
                let [short, long] = [slowest(0.0001), slowest(1.0)];
                println!("slope {slope}, {cycle_us} us, back {back}: {short:.2} mm/s, {long:.2} with 1 mm");
                // Back: both steps of acceleration are one.
                let part = if back { 0.68 } else { 0.97 };
                assert!(short >= part * long, "slope {slope}, {cycle_us} us, back {back}: {short} {long}");
            }
        }
    }
}

/// Of programs with short blocks of any kind no tick passes more than it may, and nothing breaks a limit.
#[test]
fn slivers_of_any_length_break_no_limit() {
    for seed in 0..60 {
        let mut r = Random::new(seed);
        let mut text = String::from("N1 G01 X10 F12000\n");
        let [mut x, mut y, mut angle] = [10.0, 0.0, 0.0_f64];
        for n in 0..80 {
            let length = if r.once_in(3) { r.magnitude(1e-6, 1e-2) } else { r.magnitude(0.02, 5.0) };
            angle += r.between(-0.002, 0.002);
            (x, y) = (x + length * angle.cos(), y + length * angle.sin());
            text += &format!("N{} X{x:.7} Y{y:.7}\n", n + 2);
        }
        text += "M30\n";
        for slope in [STEP, TRAPEZ, SIN2, HSC] {
            run(&text, &machine(slope, EVEN, 1000));
        }
    }
}

fn square(mode: &str) -> String {
    format!("{mode}\nN10 G01 X80 F20000\nN20 Y80\nN30 X0\nN40 G260 Y0\nM30\n")
}

fn stairs(mode: &str) -> String {
    format!("{mode}\nN10 G01 X80 F20000\nN20 Y80\nN30 X160\nN40 Y160\nN50 G260 X240\nM30\n")
}

fn corner(mode: &str) -> String {
    format!("{mode}\nN10 G01 X80 F20000\nN20 G260 Y80\nM30\n")
}

/// No axis runs along a line.
fn turned(mode: &str) -> String {
    format!("{mode}\nN10 G01 X60 Y50 F20000\nN20 X10 Y110\nN30 G260 X-50 Y60\nM30\n")
}

fn sharp(mode: &str) -> String {
    format!("{mode}\nN10 G01 X80 F20000\nN20 X10 Y30\nN30 G260 X80 Y40\nM30\n")
}

const TOLERANCES: [f64; 10] = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0];

#[test]
fn a_corner_is_never_slower_than_a_stop_and_never_slower_with_more_tolerance() {
    for ramps in [EVEN, SOFT] {
        for slope in [STEP, TRAPEZ, SIN2, HSC] {
            let machine = machine(slope, ramps, 1000);
            for (name, text) in [
                ("square", square as fn(&str) -> String),
                ("stairs", stairs),
                ("corner", corner),
                ("turned", turned),
                ("sharp", sharp),
            ] {
                let time = |mode: &str| run(&text(mode), &machine).time();
                let [stop, plain] = [time("G360"), time("G260")];
                let what = format!("{name}, slope {slope}, ramps {ramps:?}");
                assert!(plain <= stop + 1e-9, "{what}: {plain} without contour mode, {stop} with stops");
                let mut before = plain;
                let mut times = Vec::new();
                for path_dev in TOLERANCES.into_iter().chain([2.0]) {
                    let now = time(&dev(path_dev));
                    times.push(format!("{now:.3}"));
                    assert!(
                        now <= before + 1e-9,
                        "{what}: {now} with PATH_DEV {path_dev}, {before} with less"
                    );
                    before = now;
                }
                println!("{what}: stops {stop:.3}, without contour mode {plain:.3}, DEV {}", times.join(" "));
            }
        }
    }
}

#[test]
fn hsc_is_never_slower_than_trapez() {
    let mut worst = (0.0, 0);
    for seed in 0..500 {
        let mut r = Random::new(seed);
        let lines = 2 + (r.between(0.0, 6.0) as u32);
        let mut text =
            format!("{}\nN1 G01 X10 F{:.0}\n", dev(r.magnitude(0.005, 2.0)), r.between(3000.0, 30_000.0));
        let [mut x, mut y, mut z, mut angle] = [10.0, 0.0, 0.0, 0.0_f64];
        for n in 0..lines {
            angle += r.between(-2.6, 2.6);
            let length = r.magnitude(2.0, 120.0);
            (x, y) = (x + length * angle.cos(), y + length * angle.sin());
            if r.once_in(4) {
                z += r.between(-10.0, 10.0);
            }
            text += &format!("N{} X{x:.4} Y{y:.4} Z{z:.4}\n", n + 2);
        }
        text += "N99 G260\nM30\n";
        let ramps = if r.once_in(2) { EVEN } else { SOFT };
        let [hsc, trapez] = [HSC, TRAPEZ].map(|slope| run(&text, &machine(slope, ramps, 1000)).time());
        // To a tick.
        let ratio = (hsc - 1e-3) / trapez;
        if ratio > worst.0 {
            worst = (ratio, seed);
        }
        // At a corner without a curve HSC leaves a knee more acceleration: two ticks of 1500 are known.
        assert!(ratio <= 1.0015, "seed {seed}: {hsc} with HSC, {trapez} with TRAPEZ\n{text}");
    }
    println!("worst ratio {:.5} at seed {}", worst.0, worst.1);
}

/// Of 90° each: what is used somewhere in the curve of the permitted jerk, acceleration or feed.
#[test]
fn a_corner_uses_what_limits_it() {
    for constant in [0, 1] {
        for path_dev in [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0] {
            // A curve at constant speed is short, and at its jerk at its ends only.
            let cycle_us = if constant == 0 { 1000 } else { 100 };
            // An eighth is left to a feed hold; CONST_VEL leaves less.
            let least = if constant == 0 { 0.87 } else { 0.9 };
            let machine = machine(TRAPEZ, EVEN, cycle_us);
            let mode = format!("#CONTOUR MODE ON [DEV PATH_DEV={path_dev} CONST_VEL={constant}]");
            let run = run(&format!("{mode}\nN10 G01 X160 F20000\nN20 G260 Y160\nM30\n"), &machine);
            let row = |i: usize| run.trace.mm(i);
            let inside = |i: usize| row(i)[1] > 1e-9 && row(i)[0] < 160.0 - 1e-9;
            let mut used = [0.0_f64; 3];
            let per_s = 1e6 / f64::from(cycle_us);
            for i in (3..run.trace.len()).filter(|&i| inside(i) && inside(i - 3)) {
                let [q, p, o, n] = [row(i), row(i - 1), row(i - 2), row(i - 3)];
                for k in 0..2 {
                    used[1] = used[1].max((q[k] - 2.0 * p[k] + o[k]).abs() * per_s.powi(2) / 2000.0);
                    used[2] =
                        used[2].max((q[k] - 3.0 * p[k] + 3.0 * o[k] - n[k]).abs() * per_s.powi(3) / 40_000.0);
                }
                let way = (q[0] - p[0]).hypot(q[1] - p[1]) * per_s;
                used[0] = used[0].max(way / (20_000.0 / 60.0));
            }
            println!("PATH_DEV {path_dev}, CONST_VEL {constant}: feed, acceleration, jerk {used:.3?}");
            assert!(
                used.iter().any(|part| *part >= least),
                "PATH_DEV {path_dev}, CONST_VEL {constant}: {used:?}"
            );
        }
    }
}

/// Ramps and geometric ramp of 50 ms and of 150 ms.
const STRICT: [[u32; 2]; 2] = [EVEN, [150_000; 2]];

/// Largest distance of a set point from the lines between points.
fn deviation(run: &Run, points: &[[f64; 3]]) -> f64 {
    let distance = |q: &[f64], a: &[f64; 3], b: &[f64; 3]| {
        let way: Vec<f64> = (0..3).map(|k| b[k] - a[k]).collect();
        let square: f64 = way.iter().map(|x| x * x).sum();
        let along: f64 = (0..3).map(|k| (q[k] - a[k]) * way[k]).sum();
        let t = (along / square).clamp(0.0, 1.0);
        (0..3).map(|k| (q[k] - a[k] - t * way[k]).powi(2)).sum::<f64>().sqrt()
    };
    let mut near = 0_usize;
    let mut most = 0.0_f64;
    for i in 0..run.trace.len() {
        let q = run.trace.mm(i);
        // Corners are passed in order.
        let lines = near.saturating_sub(2)..(near + 8).min(points.len() - 1);
        let (line, off) = lines
            .map(|k| (k, distance(&q, &points[k], &points[k + 1])))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .expect("a line");
        near = near.max(line);
        most = most.max(off);
    }
    most
}

/// D3-076: chords of any length that turn little, or by the rounding of coordinates: inside the tolerance,
/// inside the limits (see [`run`]), and faster than with corners as they are. Of STEP, which passes a knee with
/// a step of speed, the tolerance and the limits.
#[test]
fn chords_of_any_size_are_faster_rounded_and_keep_their_tolerance() {
    for seed in 0..40 {
        let mut r = Random::new(seed);
        let path_dev = r.magnitude(0.001, 0.2);
        let (feed, size) = (r.between(2000.0, 20_000.0), r.magnitude(0.1, 8.0));
        let [mut x, mut y, mut z, mut angle, mut turn] = [10.0, 0.0, 0.0, 0.0_f64, 0.0];
        let mut points = vec![[0.0; 3], [10.0, 0.0, 0.0]];
        let mut lines = format!("N1 G01 X10 F{feed:.0}\n");
        for n in 0..60 {
            let length = size * r.between(0.2, 1.8);
            if r.once_in(12) {
                turn = r.between(-0.15, 0.15);
            }
            angle += turn;
            (x, y) = (x + length * angle.cos(), y + length * angle.sin());
            z += 0.2 * length * (0.2 * x).sin();
            let rounded = |x: f64| (x * 1e3).round() * 1e-3;
            points.push([rounded(x), rounded(y), rounded(z)]);
            lines += &format!("N{} X{x:.3} Y{y:.3} Z{z:.3}\n", n + 2);
        }
        for slope in [STEP, TRAPEZ, SIN2, HSC] {
            let machine = machine(slope, STRICT[(seed % 2) as usize], 1000);
            let time = |mode: &str| {
                let run = run(&format!("{mode}\n{lines}N99 G260\nM30\n"), &machine);
                (run.time(), deviation(&run, &points))
            };
            let ((rounded, off), (plain, _)) = (time(&dev(path_dev)), time("G260"));
            assert!(off <= path_dev + 1e-6, "seed {seed}, slope {slope}: {off} of {path_dev}");
            assert!(
                slope == STEP || rounded <= plain,
                "seed {seed}, slope {slope}: {rounded} rounded, {plain} with corners"
            );
        }
    }
}

/// D3-056: acceleration passes the curves of short blocks, so that the speed rises and falls over many.
#[test]
fn acceleration_passes_the_curves_of_short_blocks() {
    let mut times = [[0.0; 2]; 2];
    for (ramps, times) in STRICT.into_iter().zip(&mut times) {
        let machine = machine(HSC, ramps, 1000);
        times[0] = run(&circle(&dev(0.1), 64, 3), &machine).time();
        times[1] = run(&cam::rows(&dev(0.02)), &machine).time();
    }
    println!("circle and rows: {times:.3?} s");
    let most = [[3.6, 75.0], [5.1, 100.0]];
    for (time, most) in times.iter().flatten().zip(most.iter().flatten()) {
        assert!(time <= most, "{time} s of {most}");
    }
}
