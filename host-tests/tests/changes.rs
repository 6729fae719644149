//! Dynamics that change between two blocks while smoothing holds the first one back: every tick keeps the limits of
//! its own side, the corner is rounded, and nothing waits.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use glidepath::tick::State;
use host_tests::cases::machines;
use host_tests::cases::random::Random;
use host_tests::check::allowance;

/// What an axis may show: acceleration and jerk along a line, and jerk where the path bends; speed. mm, s.
#[derive(Clone, Copy, Debug)]
struct Limits {
    v: f64,
    a: f64,
    jerk: f64,
    bent: f64,
}

/// The even machine, whose largest acceleration no slope uses, with Surface.
fn machine(slope: u8) -> MachineData<3> {
    let mut machine = machines::with_slope(machines::even::<3>(1000), slope);
    machine.channel.surface = true;
    for axis in &mut machine.axes {
        axis.a_max = 3000;
        (axis.a_stufe, axis.d_stufe) = ([2500, 2200], [2500, 2200]);
    }
    machine
}

/// On [`machine`], with a slope, percent of acceleration and of ramp times, and VEL.
fn limits(slope: u8, [a, ramp]: [f64; 2], v: f64) -> Limits {
    if slope == 0 {
        return Limits { v, a: f64::min(2500.0 * a, 3000.0), jerk: f64::INFINITY, bent: f64::INFINITY };
    }
    let a = f64::min(2000.0 * a, 3000.0);
    let peak = if slope == 2 { std::f64::consts::FRAC_PI_2 } else { 1.0 };
    let jerk = a / (0.05 * ramp);
    Limits { v, a, jerk: peak * jerk, bent: f64::max(peak * jerk, a / f64::min(0.05 * ramp, 0.05)) }
}

/// Set points, and the N number of each.
struct Run {
    ticks: Vec<([f64; 3], u32)>,
}

fn run(text: &str, machine: &MachineData<3>) -> Run {
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
    let mut ticks = Vec::new();
    let mut tick = || {
        let state = interpolator.tick();
        if state == State::Active {
            let at = interpolator.set_points().map(|p| p.to_bits() as f64 / 2f64.powi(32));
            ticks.push((at, operator.status().n));
        }
        state
    };
    loop {
        match planner.poll().unwrap_or_else(|e| panic!("line {}: {e}\n{text}", e.place().line)) {
            Progress::Waiting => _ = tick(),
            Progress::Done => break,
            _ => {}
        }
    }
    while tick() == State::Active {}
    Run { ticks }
}

impl Run {
    fn time(&self) -> f64 {
        self.ticks.len() as f64 / 1000.0
    }

    /// Smallest distance from a point of the first two axes.
    fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        self.ticks.iter().map(|(at, _)| (at[0] - x).hypot(at[1] - y)).fold(f64::MAX, f64::min)
    }

    /// Every tick keeps what the blocks that it touches permit, by N number; between blocks of different dynamics the
    /// larger ones. `corner`: N numbers of the blocks beside one; where both axes move what both permit.
    fn keeps(&self, of: impl Fn(u32) -> Limits, corner: Option<[u32; 2]>) -> Result<(), String> {
        for (tick, window) in self.ticks.windows(4).enumerate() {
            let before = self.ticks[tick.saturating_sub(1)].1;
            let limits = || window.iter().map(|row| row.1).chain([before]).map(&of);
            for k in 0..3 {
                let x: Vec<f64> = window.iter().map(|row| row.0[k]).collect();
                let steady = |axis: usize| window.iter().all(|row| row.0[axis] == window[0].0[axis]);
                // In random rows a curve may end like a line.
                let line = corner.is_some() && (0..3).filter(|other| *other != k).all(steady);
                // A tick before and behind, too.
                let wide = &self.ticks[tick.saturating_sub(1)..self.ticks.len().min(tick + 5)];
                let moves = |axis: usize| wide.windows(2).all(|rows| rows[0].0[axis] != rows[1].0[axis]);
                let bent = (0..3).filter(|axis| moves(*axis)).count() > 1;
                let most = |value: fn(&Limits) -> f64| limits().map(|l| value(&l)).fold(0.0, f64::max);
                let (mut v, a) = (most(|l| l.v), if line { most(|l| l.a) } else { 3000.0 });
                let mut jerk = if line { most(|l| l.jerk) } else { most(|l| l.bent) };
                if let (true, Some([one, other])) = (bent, corner) {
                    let [one, other] = [of(one), of(other)];
                    (jerk, v) = (f64::min(one.bent, other.bent), f64::min(one.v, other.v));
                }
                // A curve is as even as the tests of corners demand.
                v *= if line { 1.0 } else { 1.001 };
                let seen = [
                    ("v", (x[1] - x[0]).abs() * 1e3, v, 1),
                    ("a", (x[2] - 2.0 * x[1] + x[0]).abs() * 1e6, a, 2),
                    ("a", (x[3] - 2.0 * x[2] + x[1]).abs() * 1e6, a, 2),
                    ("jerk", (x[3] - 3.0 * x[2] + 3.0 * x[1] - x[0]).abs() * 1e9, jerk, 3),
                ];
                for (name, value, limit, order) in seen {
                    if value > limit * (1.0 + 1e-9) + allowance(order, 1e-3) {
                        let n = window[0].1;
                        return Err(format!("tick {tick}, N{n}, axis {k}: {name} {value} of {limit}"));
                    }
                }
            }
        }
        Ok(())
    }
}

/// What changes the dynamics, what takes that back, and the limits with it, on a machine with this slope.
fn changes(slope: u8) -> Vec<(&'static str, &'static str, Limits)> {
    let name = ["STEP", "TRAPEZ", "SIN2", "HSC"][usize::from(slope)];
    assert!(name != "STEP");
    vec![
        ("G131 50", "G131 100", limits(slope, [0.5, 1.0], 200.0)),
        ("G131 150", "G131 100", limits(slope, [1.5, 1.0], 200.0)),
        ("G130 X50 Y50 Z50", "G131 100", limits(slope, [0.5, 1.0], 200.0)),
        ("G133 200", "G133 100", limits(slope, [1.0, 2.0], 200.0)),
        ("#VECTOR LIMIT ON [VEL=3000]", "#VECTOR LIMIT OFF [VEL]", limits(slope, [1.0, 1.0], 50.0)),
        ("#SLOPE [TYPE=STEP]", "#SLOPE DEFAULT", limits(0, [1.0, 1.0], 200.0)),
        ("#SLOPE [TYPE=SIN2]", "#SLOPE DEFAULT", limits(2, [1.0, 1.0], 200.0)),
        ("#SLOPE [TYPE=TRAPEZ]", "#SLOPE DEFAULT", limits(1, [1.0, 1.0], 200.0)),
    ]
}

/// A corner between blocks of different dynamics is rounded, with what both permit, and takes no longer than with the
/// lower dynamics on both sides.
#[test]
fn a_corner_between_different_dynamics_is_rounded() {
    for slope in [1, 2, 3] {
        let machine = machine(slope);
        let usual = limits(slope, [1.0, 1.0], 200.0);
        for mode in [
            "#CONTOUR MODE ON [DEV PATH_DEV=0.5]",
            "#CONTOUR MODE ON [DEV PATH_DEV=0.5 CONST_VEL=1]",
            "#CONTOUR MODE ON [DIST PRE_DIST=4 POST_DIST=4]",
            "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=5]",
            "#CONTOUR MODE ON [POS PRE_DIST=4 POST_DIST=4 X59 Y1]",
        ] {
            for (there, back, other) in changes(slope) {
                let text = |first: &str, between: &str| {
                    format!("{mode}\n{first}\nN10 G01 X60 F9000\n{between}\nN20 Y60\nM30\n")
                };
                let either = [text("", ""), text(there, "")].map(|text| run(&text, &machine));
                let times = either.each_ref().map(Run::time);
                let (slowest, fastest) = (f64::max(times[0], times[1]), f64::min(times[0], times[1]));
                // Each block has its own, the corner the lower ones.
                let longest = 0.9 * slowest + 0.1 * fastest + 0.002 * slowest;
                let off = either.map(|run| run.distance([60.0, 0.0]));
                for (first, between, sides) in [("", there, [usual, other]), (there, back, [other, usual])] {
                    let text = text(first, between);
                    let run = run(&text, &machine);
                    run.keeps(|n| sides[usize::from(n == 20)], Some([10, 20]))
                        .unwrap_or_else(|fault| panic!("slope {slope}\n{text}{fault}"));
                    assert!(run.time() < longest, "slope {slope}\n{text}{} of {longest} {times:?}", run.time());
                    let at = run.distance([60.0, 0.0]);
                    let [least, most] = [f64::min(off[0], off[1]), f64::max(off[0], off[1])];
                    let inside = (0.9 * least..1.1 * most).contains(&at);
                    assert!(inside, "slope {slope}\n{text}{at}, alone {off:?}");
                }
            }
        }
    }
}

/// A row of Surface or of a spline goes on through a change, which acts behind it.
#[test]
fn a_row_goes_on_through_a_change() {
    for slope in [1, 2, 3] {
        let machine = machine(slope);
        let usual = limits(slope, [1.0, 1.0], 200.0);
        for mode in [
            "#HSC ON [SURFACE PATH_DEV=0.1]",
            "#HSC ON [BSPLINE PATH_DEV=0.1]",
            "#HSC ON [OPMODE=2 CONTERROR=0.1]",
            "G151",
        ] {
            for (there, back, other) in changes(slope) {
                let text = |first: &str, between: &str| {
                    let mut text = format!("{mode}\n{first}\n");
                    for n in 1..=120 {
                        let angle = f64::from(n) * 0.015;
                        let at = [80.0 * angle.sin(), 80.0 * (1.0 - angle.cos())];
                        let line = if n == 31 { between } else { "" };
                        text = format!("{text}{line}\nN{n} G01 X{:.3} Y{:.3} F6000\n", at[0], at[1]);
                    }
                    text + "M30\n"
                };
                // Slowest about the change.
                let slowest = |run: &Run| {
                    let steps = run.ticks.windows(2).filter(|rows| (26..=36).contains(&rows[0].1));
                    let step = |[a, b]: [[f64; 3]; 2]| (b[0] - a[0]).hypot(b[1] - a[1]);
                    steps.map(|rows| step([rows[0].0, rows[1].0])).fold(f64::MAX, f64::min)
                };
                let either = [text("", ""), text(there, "")].map(|text| run(&text, &machine));
                let [least, longest] = either.iter().fold([f64::MAX, 0.0], |[speed, time], run| {
                    [f64::min(speed, slowest(run)), f64::max(time, run.time())]
                });
                for (first, between, sides) in [("", there, [usual, other]), (there, back, [other, usual])] {
                    let text = text(first, between);
                    let run = run(&text, &machine);
                    run.keeps(|n| sides[usize::from(n > 30)], None)
                        .unwrap_or_else(|fault| panic!("slope {slope}\n{text}{fault}"));
                    assert!(run.time() < 1.02 * longest, "slope {slope}\n{text}{} of {longest}", run.time());
                    let speed = slowest(&run);
                    assert!(speed > 0.7 * least, "slope {slope}\n{text}{speed} of {least}");
                    // It acts.
                    let alone = &either[usize::from(!first.is_empty())];
                    assert!(run.ticks != alone.ticks || there.contains("TYPE"), "slope {slope}\n{text}");
                }
            }
        }
    }
}

/// What changes nothing is as if it were not there: a corner is rounded, a row of Surface or of a spline goes on.
#[test]
fn what_changes_nothing_ends_nothing() {
    for (slope, name) in [(1, "TRAPEZ"), (3, "HSC")] {
        let machine = machine(slope);
        for mode in [
            "#CONTOUR MODE ON [DEV PATH_DEV=0.5]",
            "#HSC ON [SURFACE PATH_DEV=0.1]",
            "#HSC ON [BSPLINE PATH_DEV=0.1]",
            "G151",
        ] {
            let text = |between: &str| {
                format!(
                    "G131 80\n{mode}\nN10 G01 X20 F6000\nN20 X25 Y2\n{between}N30 X30 Y6\nN40 X40 Y20\nM30\n"
                )
            };
            let alone = run(&text(""), &machine).ticks;
            for nothing in [
                format!("#SLOPE [TYPE={name}]\n"),
                "#SLOPE DEFAULT\n".to_owned(),
                "G131 80\n".to_owned(),
                "#VECTOR LIMIT OFF ALL\n".to_owned(),
                "G131 20\n#SLOPE [TYPE=STEP]\nG131 80\n#SLOPE DEFAULT\n".to_owned(),
            ] {
                let text = text(&nothing);
                assert!(run(&text, &machine).ticks == alone, "{text}");
            }
        }
    }
}

/// Random rows of lines with changes between them, and the limits of every block.
fn row(random: &mut Random, slope: u8, mode: &str) -> (String, Vec<Limits>) {
    let mut text = format!("{mode}\n");
    let mut of = Vec::new();
    let (mut weights, mut v, mut now) = ([1.0, 1.0], 200.0, slope);
    let mut at = [0.0, 0.0];
    let part = |random: &mut Random| (random.bits() % 1000) as f64 / 1000.0;
    let arcs = !mode.contains("PTP");
    let stairs = random.bits().is_multiple_of(2);
    let length = [0.3, 2.0, 15.0][(random.bits() % 3) as usize];
    for n in 1..=14 {
        while n > 1 && random.bits().is_multiple_of(3) {
            let percent = [20.0, 50.0, 100.0, 150.0][(random.bits() % 4) as usize];
            match random.bits() % 4 {
                0 => (weights[0], text) = (percent / 100.0, format!("{text}G131 {percent}\n")),
                1 => (weights[1], text) = (percent / 100.0, format!("{text}G133 {percent}\n")),
                2 => {
                    v = [30.0, 200.0][(random.bits() % 2) as usize];
                    let vel = if v > 30.0 { "OFF [VEL" } else { "ON [VEL=1800" };
                    text = format!("{text}#VECTOR LIMIT {vel}]\n");
                }
                _ => {
                    now = (random.bits() % 4) as u8;
                    let name = ["STEP", "TRAPEZ", "SIN2", "HSC"][usize::from(now)];
                    text = format!("{text}#SLOPE [TYPE={name}]\n");
                }
            }
        }
        of.push(limits(now, weights, v));
        let way = length * (0.2 + part(random));
        let angle = if stairs { (n % 2) as f64 * std::f64::consts::FRAC_PI_2 } else { part(random) * 1.5 };
        at = [at[0] + way * angle.cos(), at[1] + way * angle.sin()];
        // An arc now and then, of a third of a turn at most.
        let arc = !stairs && arcs && random.bits().is_multiple_of(4);
        let by = if arc { format!("G03 R{:.3}", 0.6 * way) } else { "G01".to_owned() };
        text = format!("{text}N{n} {by} X{:.3} Y{:.3} F9000\n", at[0], at[1]);
    }
    (text + "M30\n", of)
}

#[test]
fn random_changes_keep_the_limits_of_both_sides() {
    let modes = [
        "#CONTOUR MODE ON [DEV PATH_DEV=0.2]",
        "#CONTOUR MODE ON [DEV PATH_DEV=0.2 RELEVANT_PATH=0.2]",
        "#CONTOUR MODE ON [DIST PRE_DIST=2 POST_DIST=2]",
        "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=3]",
        "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=3 DIST_WEIGHT=50]",
        "#CONTOUR MODE ON [PTP]",
        "#HSC ON [SURFACE PATH_DEV=0.1]",
        "#HSC ON [BSPLINE PATH_DEV=0.1]",
        "#HSC ON [OPMODE=2 CONTERROR=0.1]",
        "G151",
    ];
    for seed in host_tests::seeds::seeds(0..400, 40) {
        let mut random = Random::new(seed);
        let slope = (seed % 4) as u8;
        let mode = modes[(seed / 4) as usize % modes.len()];
        let (text, of) = row(&mut random, slope, mode);
        let mut machine = machine(slope);
        machine.channel.ptp = true;
        machine.channel.corr_v_trans_jerk = true;
        machine.channel.merge_chords = if seed.is_multiple_of(3) { 50 } else { 0 };
        run(&text, &machine)
            .keeps(|n| of[(n as usize).clamp(1, of.len()) - 1], None)
            .unwrap_or_else(|fault| panic!("seed {seed}\n{text}{fault}"));
    }
}
