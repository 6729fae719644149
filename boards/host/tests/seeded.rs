//! Random programs with smoothing methods, slopes, weights, dwells and stops: the standstills in the summary
//! are those of the trace, and the monitor finds no excess.
mod common;
use common::*;
use serde_json::{Value, json};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// SplitMix64.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0…1.
    fn part(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[(self.bits() % of.len() as u64) as usize]
    }

    fn is(&mut self, part: f64) -> bool {
        self.part() < part
    }
}

const MODES: [&str; 8] = [
    "",
    "#CONTOUR MODE [DEV PATH_DEV=0.1]",
    "#CONTOUR MODE [DIST PRE_DIST=0.5 POST_DIST=0.5]",
    "#CONTOUR MODE [PTP]",
    "#CONTOUR MODE [DIST_SOFT PATH_DIST=1]",
    "#HSC ON [SURFACE PATH_DEV=0.1]",
    "#HSC ON [BSPLINE PATH_DEV=1]",
    "#HSC ON [BSPLINE PATH_DEV=0.1]",
];
const SLOPES: [&str; 4] = ["STEP", "TRAPEZ", "SIN2", "HSC"];
const WEIGHTS: [&str; 7] = ["G131 ", "G133 ", "G134 ", "G231 ", "G233 ", "G130 X", "G132 Y"];

/// Lines, some rapid ones and arcs, in a plane.
fn program(random: &mut Random) -> String {
    let mode = random.one(&MODES);
    let mut text = format!("%seeded\n#SLOPE [TYPE={}]\n{mode}\n", random.one(&SLOPES));
    let _ = writeln!(text, "G01 F{}", random.one(&[600, 3000, 6000, 12_000, 30_000]));
    let contour = mode.starts_with("#CONTOUR");
    text.push_str(if contour { "G261\n" } else { "" });
    let (mut x, mut y) = (0.0_f64, 0.0_f64);
    let scale = random.one(&[0.02, 0.3, 2.0, 20.0]);
    let weighted = random.is(0.6);
    for i in 1..=3 + random.bits() % 38 {
        if weighted && random.is(0.25) {
            let _ = writeln!(text, "{}{}", random.one(&WEIGHTS), random.one(&[20, 50, 100, 150]));
        }
        if random.is(0.03) {
            let _ = writeln!(text, "#SLOPE [TYPE={}]", random.one(&SLOPES));
        }
        text.push_str(if random.is(0.03) { "G04 X0.05\n" } else { "" });
        let (kind, size) = (random.part(), scale * random.one(&[0.1, 1.0, 1.0, 1.0, 3.0]));
        let n = 10 * i;
        if mode.is_empty() && kind > 0.9 || contour && kind > 0.95 {
            let (turn, radius) = (random.one(&[2, 3]), size * random.one(&[1.0, 2.0]));
            let _ = writeln!(text, "N{n} G0{turn} X{:.5} I{radius:.5} J0", x + 2.0 * radius);
            x += 2.0 * radius;
        } else {
            let straight = random.is(0.3);
            let mut by = |ahead: f64| if straight { ahead } else { size * (2.0 * random.part() - 1.0) };
            (x, y) = (x + by(size), y + by(0.0));
            let stop = if random.is(0.04) { "G60 " } else { "" };
            let _ = writeln!(text, "N{n} {stop}G0{} X{x:.5} Y{y:.5}", u8::from(kind > 0.1));
        }
        (x, y) = ((x * 1e5).round() / 1e5, (y * 1e5).round() / 1e5);
    }
    let end = if contour { "G260\n" } else { "" };
    let end = if mode.starts_with("#HSC") { "#HSC OFF\n" } else { end };
    text + end + "M30\n"
}

/// Commands of an operator, some of them late text and a late planner.
fn events(random: &mut Random) -> String {
    let mut text = String::new();
    let mut at = 0.0;
    for _ in 0..1 + random.bits() % 6 {
        at += random.one(&[0.01, 0.1, 0.37]);
        let what = random.one(&[
            "override 10",
            "override 50",
            "override 200",
            "feedhold",
            "stall 0.05",
            "starve 0.1",
        ]);
        let _ = writeln!(text, "{at:.3} {what}");
        if what == "feedhold" {
            at += random.one(&[0.05, 0.3]);
            let _ = writeln!(text, "{at:.3} resume");
        }
    }
    text
}

/// The built-in machine with PTP, in three kinds: as it is, with short ramps, and with free jerk at joints.
fn machine(directory: &Path, kind: u64) -> PathBuf {
    let text = fs::read_to_string(shipped("machines/default.toml")).expect("it is shipped");
    let text = text.replace("FCT_SURFACE", "FCT_SURFACE|FCT_PTP");
    let short = text.replace("= 150_000", "= 50_000").replace("tr_geom = 10_000", "tr_geom = 50_000");
    let free = short.replace("corr_v_trans_jerk = 1", "corr_v_trans_jerk = 0");
    let path = directory.join("m.toml");
    fs::write(&path, [text, short, free][(kind % 3) as usize].as_bytes()).expect("a machine for the test");
    path
}

struct Seen {
    summary: Value,
    rows: Vec<Row>,
}

/// Runs a program; fails where it exceeds a limit.
fn seen(name: &str, program: &str, machine: u64, events: Option<&str>) -> Seen {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("seeded-{name}"));
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).expect("a directory for the test");
    let [nc, csv, json, script] = ["p.nc", "t.csv", "s.json", "e.events"].map(|file| directory.join(file));
    fs::write(&nc, program).expect("a program for the test");
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    command.arg("run").arg(&nc).args(["--why", "never"]);
    command.arg("--machine").arg(self::machine(&directory, machine));
    command.arg("--trace").arg(&csv).arg("--summary").arg(&json);
    if let Some(events) = events {
        fs::write(&script, events).expect("events for the test");
        command.arg("--events").arg(&script);
    }
    let output = command.output().expect("the simulator starts");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{name}: {told}\n{program}");
    let text = |path| fs::read_to_string(path).expect("it was asked for");
    let summary: Value = serde_json::from_str(&text(&json)).expect("JSON");
    assert_eq!(summary["exceeded"], json!(0), "{name}");
    Seen { summary, rows: trace(&text(&csv)).rows }
}

/// Standstills between the first motion and the last one, several rows one behind the other as one: as shown, and by
/// the set points, which then hardly move on both sides.
fn standstills(rows: &[Row]) -> usize {
    let step = |k: usize| {
        let pairs = rows[k].axes.iter().zip(&rows[k - 1].axes);
        pairs.map(|(to, from)| ((to - from) as f64 * LSB).abs()).fold(0.0, f64::max)
    };
    let moves = |k: &usize| step(*k) > 0.0;
    let (Some(first), Some(last)) = ((1..rows.len()).find(moves), (1..rows.len()).rev().find(moves)) else {
        return 0;
    };
    let mut count = 0;
    for k in first..last {
        if rows[k].v_mm_s != 0.0 {
            continue;
        }
        count += usize::from(rows[k - 1].v_mm_s != 0.0);
        // What 6000 mm/s² change in a tick, from rest or to it.
        assert!(step(k) <= 0.0031 && step(k + 1) <= 0.0031, "tick {k}: {} {} mm", step(k), step(k + 1));
    }
    count
}

#[test]
fn standstills_are_those_of_the_trace() {
    let mut all = 0;
    for seed in 0..40 {
        let text = program(&mut Random(seed));
        let Seen { summary, rows } = seen(&format!("stands-{seed}"), &text, seed, None);
        let stands = standstills(&rows);
        assert_eq!(summary["stops"], json!(stands), "seed {seed}:\n{text}");
        // The slowest corners begin with them, and are no slower than the trace.
        let corners = summary["slowest_corners"].as_array().expect("a list");
        let at_rest = corners.iter().filter(|corner| number(&corner["v"]) == 0.0).count();
        assert_eq!(at_rest, stands.min(5), "seed {seed}: {corners:?}\n{text}");
        all += stands;
    }
    assert!(all > 20, "only {all} standstills");
}

/// A law that ends inside of a block, or the last one, is no standstill at a joint.
#[test]
fn a_spline_that_never_stands_has_no_standstill() {
    for (seed, feed) in [600, 6000, 20_000, 60_000].into_iter().enumerate() {
        for slope in SLOPES {
            let text = format!(
                "%spline\n#SLOPE [TYPE={slope}]\n#HSC ON [BSPLINE PATH_DEV=1]\nG01 F{feed}\nX1\nX2\nX3\nX14 Y20\n#HSC OFF\nM30\n"
            );
            let Seen { summary, rows } = seen(&format!("spline-{slope}-{feed}"), &text, seed as u64, None);
            assert_eq!((standstills(&rows), &summary["stops"]), (0, &json!(0)), "{slope}, F{feed}");
        }
    }
}

/// Tens of thousands of ticks under changing weights, without and with an operator.
#[test]
fn no_limit_of_a_block_is_exceeded() {
    let mut ticks = 0;
    for seed in 1000..1040 {
        let mut random = Random(seed);
        let (text, events) = (program(&mut random), events(&mut random));
        let events = random.is(0.5).then_some(events.as_str());
        ticks += seen(&format!("limits-{seed}"), &text, seed, events).rows.len();
    }
    assert!(ticks > 50_000, "only {ticks} ticks");
}
