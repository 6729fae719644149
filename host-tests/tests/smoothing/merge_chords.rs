//! `merge_chords`: with DEV one line replaces nearly straight chords, inside a part of the tolerance.
use glidepath::machine::{MachineData, Synch, SynchTable};
use glidepath::nc::{Contour, ContourMethod};
use glidepath::quantity::Position;
use host_tests::cam;
use host_tests::cases::Program;
use host_tests::check;
use host_tests::corner::{blocks, round};
use host_tests::rounded::{self, run_from};
use host_tests::walk::{judge, limits, machine};

/// A machine with it.
fn with(percent: u8, ramp: u32, slope: u8) -> MachineData<3> {
    let mut machine = machine::<3>(ramp, slope);
    machine.channel.merge_chords = percent;
    machine
}

fn go(text: &str, machine: &MachineData<3>) -> rounded::Run {
    run_from::<3>(text, [Position::ZERO; 3], machine)
}

fn on(dev: f64) -> String {
    format!("#CONTOUR MODE [DEV PATH_DEV={dev}]\nG261")
}

/// Elements that were planned.
fn elements(run: &rounded::Run) -> usize {
    run.blocks.len()
}

fn smoothed(seed: u64, [dev, track]: [f64; 2]) -> [String; 2] {
    let words = ["", " REMAIN_PART=10", " RELEVANT_PATH=0.2", " MAX_ANGLE=60"];
    let words = words[seed as usize % 4];
    let on = format!("#CONTOUR MODE [DEV PATH_DEV={dev} TRACK_DEV={track}{words}]\nG261");
    [on, "G260".to_owned()]
}

#[test]
fn random_paths_keep_tolerance_limits_and_ends() {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse::<u64>().ok());
    let first = number("GLIDEPATH_FROM").unwrap_or(0);
    let mut faults = 0;
    for seed in first..first + number("GLIDEPATH_SEEDS").unwrap_or(60) {
        let slope = [3, 3, 1, 2, 0][seed as usize % 5];
        let ramp = [50_000, 150_000][seed as usize / 5 % 2];
        let percent = [50, 75, 10, 60, 30, 1, 0][seed as usize % 7];
        let judged = if seed % 3 == 0 {
            judge::<4>(seed, 40, (ramp, slope), smoothed, |machine| machine.channel.merge_chords = percent)
        } else {
            judge::<3>(seed, 40, (ramp, slope), smoothed, |machine| machine.channel.merge_chords = percent)
        };
        if let Err(fault) = judged {
            println!(
                "seed {seed}: slope {slope}, ramps {ramp} µs, {percent} %: {}",
                fault.lines().next().unwrap_or("")
            );
            faults += 1;
        }
    }
    assert_eq!(faults, 0);
}

/// The 5,000 segments, s. The aims are 42 and 58.
#[test]
fn short_blocks_take_half_the_time() {
    let rows = cam::rows(&on(0.02));
    for (ramp, most) in [(50_000, 28.0), (150_000, 40.6)] {
        let machine = with(50, ramp, 3);
        let run = go(&rows, &machine);
        println!("ramps of {ramp} µs: {} s, {} elements", run.time(), elements(&run));
        check::limits(&run.trace, &limits::<3>(ramp, 3)).expect("inside the limits");
        assert!(run.time() < most && elements(&run) < cam::SEGMENTS / 2, "{} s", run.time());
    }
}

/// A circle of short chords, with a word behind each of so many blocks, in which @ is its number.
fn circle(count: u32, radius: f64, head: &str, every: u32, word: &str) -> String {
    let mut text = format!("{head}\nG01 F3000\n");
    for k in 1..=count {
        let a = f64::from(k) * std::f64::consts::TAU / f64::from(count);
        let (x, y) = (radius * a.sin(), radius * (1.0 - a.cos()));
        text += &format!("N{k} X{x:.6} Y{y:.6}\n");
        if k % every == 0 {
            text += &word.replace('@', &k.to_string());
            text += "\n";
        }
    }
    text + "M30\n"
}

/// Chords that become one line each: how many of them, where the points are so far from the start.
fn gathered(points: &[Vec<f64>], percent: u8, dev: f64) -> Vec<u32> {
    let program = points.iter().fold(Program::new("chords", 4), |program, point| program.line(point, 3000.0));
    let mut machine = machine::<4>(50_000, 1);
    machine.channel.merge_chords = percent;
    let nm = |mm: f64| Some(Position::from_num(mm));
    let contour = Contour { method: Some(ContourMethod::Dev), path_dev: nm(dev), ..Contour::default() };
    let pieces = round(&blocks(&program, &machine), &machine, &contour);
    let mut last: Vec<u32> = pieces.iter().map(|piece| piece.out.data.number + 1).collect();
    last.dedup();
    [0].iter().chain(&last).zip(&last).map(|(from, to)| to - from).collect()
}

/// Points of a circle.
fn round_points(count: u32, radius: f64) -> Vec<Vec<f64>> {
    let angle = |k: u32| f64::from(k) * std::f64::consts::TAU / f64::from(count);
    (1..=count).map(|k| vec![radius * angle(k).sin(), radius * (1.0 - angle(k).cos())]).collect()
}

#[test]
fn a_line_is_as_long_as_its_part_of_the_tolerance() {
    // Chords of a circle: the sagitta of n of them is r (1 - cos(n pi / count)).
    let (count, radius, dev) = (1000, 10.0, 0.02);
    for percent in [10, 25, 50, 75] {
        let part = dev * f64::from(percent) * 0.01;
        let most = ((1.0 - part / radius).acos() * f64::from(count) / std::f64::consts::PI).floor() as u32;
        let lines = gathered(&round_points(count, radius), percent, dev);
        println!("{percent} %: {lines:?} chords, {most} by the sagitta");
        // An odd number of them has no point in the middle.
        let longest = if most.is_multiple_of(2) { most..=most + 1 } else { most..=most };
        assert!(lines.iter().rev().skip(1).all(|n| longest.contains(n)), "{percent} %: {lines:?}");
    }
    assert!(gathered(&round_points(200, radius), 0, dev).iter().all(|n| *n == 1));
}

/// More points than are known one by one: what the line is beside them adds up, and is kept.
#[test]
fn many_points_may_become_one_line() {
    let (count, radius, dev) = (20_000, 10.0, 0.02);
    let lines = gathered(&round_points(count, radius), 50, dev);
    let longest = lines.iter().max().expect("several");
    let most = (1.0 - 0.5 * dev / radius).acos() * f64::from(count) / std::f64::consts::PI;
    println!("{longest} chords, {most:.0} by the sagitta");
    assert!(*longest > 100 && f64::from(*longest) <= most, "{longest}");
}

/// What belongs to a point between, stays there: functions, another feed, other parameters, a standstill.
#[test]
fn whatever_belongs_to_a_point_ends_the_line_there() {
    let mut machine = with(50, 50_000, 1);
    machine.channel.m_synch = SynchTable::NONE.with(25, Synch::Mos);
    let mut apart = machine;
    apart.channel.merge_chords = 0;
    let same = |word: &str| {
        // As many functions as there is room for: where it is used up, how far the look-ahead reaches is another matter.
        let text = circle(30, 5.0, &on(0.5), 1, word);
        go(&text, &machine).digest == go(&text, &apart).digest
    };
    for word in ["M25", "F300@", "#CONTOUR MODE [DEV PATH_DEV=0.@1]", "G04 0.01"] {
        assert!(same(word), "{word}");
    }
    for word in ["", "F2000\nF3000", "#CONTOUR MODE [DEV PATH_DEV=0.5]"] {
        assert!(!same(word), "{word}");
    }
    // Functions come out where they were programmed.
    let run = go(&circle(98, 50.0, &on(0.5), 7, "M25"), &machine);
    let places: Vec<[f64; 2]> =
        run.events.iter().map(|(row, _)| run.trace.mm(*row)).map(|q| [q[0], q[1]]).collect();
    assert_eq!(places.len(), 14);
    for (k, [x, y]) in places.into_iter().enumerate() {
        let a = (k + 1) as f64 * std::f64::consts::TAU / 14.0;
        let off = (x - 50.0 * a.sin()).hypot(y - 50.0 * (1.0 - a.cos()));
        // A tick's way, and the corner.
        assert!(off < 0.6, "{k}: {off}");
    }
}

/// A curve at the corner of long lines is not held up by them: they stay as they are.
#[test]
fn long_lines_and_turns_stay() {
    let two = |length: f64| gathered(&[vec![length, 0.0], vec![2.0 * length, 0.001]], 50, 0.02);
    assert_eq!([two(2.0), two(3.0)], [vec![2], vec![1, 1]]);
    // Inside the tolerance, but no straight line.
    assert_eq!(gathered(&[vec![0.1, 0.0], vec![0.1, 0.1], vec![0.2, 0.1]], 50, 1.0), [1, 1, 1]);
    assert_eq!(gathered(&[vec![0.1, 0.0], vec![0.2, 0.0], vec![0.1, 0.0]], 50, 1.0), [2, 1]);
    // Without TRACK_DEV other axes go as they were programmed.
    let turning = |a: f64| vec![vec![1.0, 0.0, 0.0, a], vec![2.0, 0.001, 0.0, 3.0]];
    assert_eq!([gathered(&turning(1.0), 50, 0.02), gathered(&turning(1.5), 50, 0.02)], [vec![1, 1], vec![2]]);
}
