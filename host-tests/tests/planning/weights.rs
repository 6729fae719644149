//! G130…G134, G231…G233, G338, G339: a weighted machine equals a machine with other data, block by block, and
//! every axis keeps the limits with its current weights.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::machine::{AxisData, MachineData};
use glidepath::quantity::Position;
use host_tests::cases::random::{Mix, Random, program};
use host_tests::cases::{Program, machines, set_point};
use host_tests::check::{allowance, peaks};
use host_tests::properties::permitted;
use host_tests::trace::{Run, run, run_text};

/// Runs a program with lines inserted before blocks, by their index.
fn run_with(program: &Program, machine: &MachineData<3>, lines: &[(usize, String)]) -> Run {
    let mut text = program.text(machine);
    for (index, line) in lines {
        let n = format!("\nN{} ", 10 * (index + 1));
        assert!(text.contains(&n), "{n:?}");
        text = text.replacen(&n, &format!("\n{line}{n}"), 1);
    }
    let start = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
    run_text::<3, 120>(&text, start, machine, 1).unwrap_or_else(|fault| panic!("{fault}\n{text}"))
}

/// A machine with other data, and the same program without a weight.
fn equivalent(
    program: &Program,
    machine: &MachineData<3>,
    lines: &[&str],
    change: impl Fn(usize, &mut AxisData),
) {
    let lines: Vec<(usize, String)> = lines.iter().map(|line| (0, (*line).to_owned())).collect();
    let weighted = run_with(program, machine, &lines);
    let mut other = *machine;
    for (k, axis) in other.axes.iter_mut().enumerate() {
        change(k, axis);
    }
    let plain = run::<3, 120>(program, &other).unwrap_or_else(|fault| panic!("{fault}"));
    assert_eq!(weighted.digest, plain.digest, "{lines:?}");
    let usual = run::<3, 120>(program, machine).unwrap_or_else(|fault| panic!("{fault}"));
    assert_eq!(weighted.digest == usual.digest, other == *machine, "{lines:?}");
}

/// Feed, knee, arc, rapid motion.
fn tour() -> Program {
    Program::new("tour", 3)
        .line(&[40.0, 0.0, 5.0], 12_000.0)
        .line(&[60.0, 30.0, 5.0], 12_000.0)
        .arc(&[80.0, 50.0, 5.0], [20.0, 0.0], true, 12_000.0)
        .line(&[0.0, 0.0, 0.0], 1.0)
        .rapid()
}

/// Ramps well above the smallest one, accelerations well below the largest.
fn machine() -> MachineData<3> {
    machines::machine(1000, |k, axis| {
        (axis.vb_max, axis.vb_eilgang) = (400_000, 350_000);
        axis.a_max = 6000;
        (axis.a_beschl, axis.a_brems, axis.a_grenz) = (2000 + 100 * k as u32, 1600, 2400);
        (axis.tr_beschl_zu, axis.tr_beschl_ab) = (60_000, 80_000);
        (axis.tr_brems_zu, axis.tr_brems_ab) = (70_000, 90_000);
        (axis.tr_grenz, axis.tr_geom, axis.tr_min) = (50_000, 30_000, 2000);
    })
}

fn ramps(axis: &mut AxisData, percent: [u32; 3]) {
    let of = |value: &mut u32, percent: u32| *value = *value / 100 * percent;
    for ramp in [&mut axis.tr_beschl_zu, &mut axis.tr_beschl_ab, &mut axis.tr_brems_zu, &mut axis.tr_brems_ab]
    {
        of(ramp, percent[0]);
    }
    of(&mut axis.tr_grenz, percent[1]);
    of(&mut axis.tr_geom, percent[2]);
}

fn accelerations(axis: &mut AxisData, feed: u32, rapid: u32) {
    axis.a_beschl = axis.a_beschl / 100 * feed;
    axis.a_brems = axis.a_brems / 100 * feed;
    axis.a_grenz = axis.a_grenz / 100 * rapid;
}

/// Rows: D3-208, D3-259, G-05.
#[test]
fn each_word_weights_its_data() {
    let (tour, m) = (tour(), machine());
    let axis = |percents: [u32; 3]| move |k: usize| percents[k];
    let each = axis([50, 75, 100]);
    equivalent(&tour, &m, &["G130 X50 Y75"], |k, a| accelerations(a, each(k), 100));
    equivalent(&tour, &m, &["G131 50"], |_, a| accelerations(a, 50, 100));
    equivalent(&tour, &m, &["G131 = 50"], |_, a| accelerations(a, 50, 100));
    equivalent(&tour, &m, &["G231 50"], |_, a| accelerations(a, 100, 50));
    equivalent(&tour, &m, &["G132 X50 Y75"], |k, a| ramps(a, [each(k), 100, 100]));
    equivalent(&tour, &m, &["G133 = 150"], |_, a| ramps(a, [150, 100, 100]));
    equivalent(&tour, &m, &["G338 150"], |_, a| ramps(a, [150, 100, 100]));
    equivalent(&tour, &m, &["G134 50"], |_, a| ramps(a, [100, 100, 50]));
    equivalent(&tour, &m, &["G232 X50 Y75"], |k, a| ramps(a, [100, each(k), 100]));
    equivalent(&tour, &m, &["G233 50"], |_, a| ramps(a, [100, 50, 100]));
    equivalent(&tour, &m, &["G339 50"], |_, a| ramps(a, [100, 50, 100]));
    // Together, as in D3-EX25 and D3-EX26.
    equivalent(&tour, &m, &["G130 X50 Y75 Z75", "G132 X75 Y75 Z75"], |k, a| {
        accelerations(a, [50, 75, 75][k], 100);
        ramps(a, [75, 100, 100]);
    });
    equivalent(&tour, &m, &["G131 50", "G133 50"], |_, a| {
        accelerations(a, 50, 100);
        ramps(a, [50, 100, 100]);
    });
}

#[test]
fn a_weight_is_of_the_machine_data_and_leaves_the_axes_not_named() {
    let (tour, m) = (tour(), machine());
    equivalent(&tour, &m, &["G131 50", "G131 50"], |_, a| accelerations(a, 50, 100));
    equivalent(&tour, &m, &["G130 X50", "G130 Y50"], |k, a| accelerations(a, [100, 50, 100][k], 100));
    equivalent(&tour, &m, &["G131 50", "G130 Y75"], |k, a| accelerations(a, [100, 75, 100][k], 100));
    equivalent(&tour, &m, &["G130 X10 Y20 Z30", "G133 10", "G131 100", "G133 100"], |_, _| {});
}

/// With STEP both stages are weighted, decelerations that are taken over from accelerations too; in rapid
/// motion by G231.
#[test]
fn weights_act_on_the_stages_of_step() {
    let mut m = machines::with_slope(machine(), 0);
    for axis in &mut m.axes {
        (axis.a_stufe, axis.d_stufe) = ([2000, 1200], [1600, 0]);
        (axis.a_grenz_stufe, axis.d_grenz_stufe) = ([1500, 2400], [0, 1000]);
        (axis.vb_stufe_1_2, axis.vb_grenz_stufe_1_2) = (50_000, 60_000);
    }
    equivalent(&tour(), &m, &["G131 50"], |_, a| (a.a_stufe, a.d_stufe) = ([1000, 600], [800, 600]));
    equivalent(&tour(), &m, &["G231 50"], |_, a| {
        (a.a_grenz_stufe, a.d_grenz_stufe) = ([750, 1200], [750, 500]);
    });
    equivalent(&tour(), &m, &["G130 Y150"], |k, a| {
        if k == 1 {
            (a.a_stufe, a.d_stufe) = ([3000, 1800], [2400, 1800]);
        }
    });
    // P-CHAN-00001: accelerations alone, decelerations alone.
    for (chosen, a_stufe, d_stufe) in [(1, [1000, 600], [1600, 1200]), (2, [2000, 1200], [800, 600])] {
        let mut m = m;
        m.channel.acceleration_weight = chosen;
        equivalent(&tour(), &m, &["G131 50"], |_, a| (a.a_stufe, a.d_stufe) = (a_stufe, d_stufe));
    }
}

/// Rows: D3-216, G-08.
#[test]
fn weights_have_bounds() {
    let (tour, m) = (tour(), machine());
    equivalent(&tour, &m, &["G131 10000", "G231 10000"], |_, a| {
        (a.a_beschl, a.a_brems, a.a_grenz) = (a.a_max, a.a_max, a.a_max);
    });
    let shortest = |a: &mut AxisData, feed: u32| {
        (a.tr_beschl_zu, a.tr_beschl_ab, a.tr_brems_zu, a.tr_brems_ab) = (feed, feed, feed, feed);
        (a.tr_grenz, a.tr_geom) = (a.tr_min, a.tr_min);
    };
    equivalent(&tour, &m, &["G133 0.001", "G233 0.001", "G134 0.001"], |_, a| shortest(a, a.tr_min));
    let mut bounded = m;
    bounded.axes[1].tr_w_min = 20_000;
    equivalent(&tour, &bounded, &["G133 0.001", "G233 0.001", "G134 0.001"], |k, a| {
        shortest(a, if k == 1 { 20_000 } else { a.tr_min });
    });
    // A geometric ramp below the smallest one stays what it is.
    let mut short = m;
    short.axes[0].tr_geom = 1000;
    equivalent(&tour, &short, &["G134 50"], |k, a| a.tr_geom = if k == 0 { 1000 } else { 15_000 });
    // The least acceleration is that of the machine data, and the longest ramp is planned with.
    let slow = Program::new("slow", 3).line(&[0.001], 60.0);
    equivalent(&slow, &m, &["G131 0.0001"], |_, a| (a.a_beschl, a.a_brems) = (1, 1));
    equivalent(&slow, &m, &["G133 10000"], |_, a| ramps(a, [10_000, 100, 100]));
}

/// Rows: D3-276.
#[test]
fn channel_data_choose_what_is_weighted() {
    // No joint: the ramps are all that counts.
    let line = Program::new("line", 3).line(&[80.0, 10.0, 5.0], 12_000.0);
    let m = machine();
    let chosen = |acceleration_weight, ramp_weight| {
        let mut chosen = m;
        chosen.channel.acceleration_weight = acceleration_weight;
        chosen.channel.ramp_weight = ramp_weight;
        chosen
    };
    equivalent(&line, &chosen(1, 0), &["G131 50"], |_, a| a.a_beschl /= 2);
    equivalent(&line, &chosen(2, 0), &["G131 50"], |_, a| a.a_brems /= 2);
    equivalent(&line, &chosen(0, 1), &["G133 50"], |_, a| a.tr_beschl_zu /= 2);
    equivalent(&line, &chosen(0, 2), &["G133 50"], |_, a| a.tr_beschl_ab /= 2);
    equivalent(&line, &chosen(0, 3), &["G133 50"], |_, a| a.tr_brems_zu /= 2);
    equivalent(&line, &chosen(0, 4), &["G133 50"], |_, a| a.tr_brems_ab /= 2);
}

/// D3-EX25 and D3-EX26, and the same with an exact stop: then no joint takes its part of the jerk, and the
/// axes show just what the weights say.
///
/// Rows: D3-217, D3-218.
#[test]
fn weighted_accelerations_and_ramps_are_used_in_full() {
    let machine = machines::even::<3>(1000);
    let show = |words: &str, stop: &str| {
        let slope = "%w\nN05 #SLOPE [TYPE=TRAPEZ]";
        let text = format!("{slope}\n{words}\nN30 {stop}G01 X100 Y0 F6000\nN40 Y100\nN50 M30\n");
        let run = run_text::<3, 120>(&text, [Position::ZERO; 3], &machine, 1);
        let run = run.unwrap_or_else(|fault| panic!("{fault}"));
        [0, 1].map(|axis| peaks(&run.trace.columns[axis], 0.001).values)
    };
    for (words, a, ramp) in [
        ("N10 G130 X50 Y75 Z75\nN20 G132 X75 Y75 Z75", [0.5, 0.75], 0.75),
        ("N10 G131 50\nN20 G133 50", [0.5, 0.5], 0.5),
        ("N10 G131 = 100", [1.0, 1.0], 1.0),
    ] {
        for (stop, least) in [("", 0.0), ("G60 ", 0.99)] {
            // Along X alone, then along Y alone.
            for ([_, seen, jerk], part) in show(words, stop).into_iter().zip(a) {
                let (limit, steepest) = (2000.0 * part, 2000.0 * part / (0.05 * ramp));
                assert!(seen <= limit && seen > least * limit, "{words}: {seen} of {limit}");
                let inside = jerk <= steepest + allowance(3, 0.001) && jerk > least * steepest;
                assert!(inside, "{words}: {jerk} of {steepest}");
            }
        }
    }
}

/// Weights in force for each block: percent of acceleration and of ramps at feed, the same in rapid motion,
/// geometric.
type Percents = [[u32; 5]; 3];

fn weighted(axis: &AxisData, [a, ramp, a_rapid, ramp_rapid, geometric]: [u32; 5]) -> AxisData {
    let mut out = *axis;
    let up = |value: u32, percent: u32, lowest: u32| {
        let exact = u64::from(value) * u64::from(percent);
        ((exact + 50) / 100).max(u64::from(lowest.min(value))) as u32
    };
    out.a_beschl = up(axis.a_beschl, a, 1).clamp(1, axis.a_max);
    out.a_brems = up(axis.a_brems, a, 1).clamp(1, axis.a_max);
    out.a_grenz = up(axis.a_grenz, a_rapid, 1).clamp(1, axis.a_max);
    for tr in [&mut out.tr_beschl_zu, &mut out.tr_beschl_ab, &mut out.tr_brems_zu, &mut out.tr_brems_ab] {
        *tr = up(*tr, ramp, axis.tr_min);
    }
    out.tr_grenz = up(axis.tr_grenz, ramp_rapid, axis.tr_min);
    out.tr_geom = up(axis.tr_geom, geometric, axis.tr_min);
    out
}

/// Random weights before random blocks, and the percents of every block.
fn random_weights(random: &mut Random, blocks: usize) -> (Vec<(usize, String)>, Vec<Percents>) {
    let mut now = [[100; 5]; 3];
    let mut lines = Vec::new();
    let percents = (0..blocks).map(|block| {
        for _ in 0..random.bits() % 3 {
            let percent = [5, 20, 50, 100, 150, 400][(random.bits() % 6) as usize];
            // Word, index in the percents, whether axis by axis.
            let words = [
                ("G130", 0, true),
                ("G131", 0, false),
                ("G132", 1, true),
                ("G133", 1, false),
                ("G231", 2, false),
                ("G232", 3, true),
                ("G233", 3, false),
                ("G134", 4, false),
            ];
            let (word, index, by_axis) = words[(random.bits() % words.len() as u64) as usize];
            let axis = (random.bits() % 3) as usize;
            for (k, of) in now.iter_mut().enumerate() {
                of[index] = if !by_axis || k == axis { percent } else { 100 };
            }
            let name = if by_axis { [" X", " Y", " Z"][axis] } else { " " };
            lines.push((block, format!("{word}{name}{percent}")));
        }
        now
    });
    let percents = percents.collect();
    (lines, percents)
}

/// The excess of the worst difference over what its blocks permit; those at a difference count together.
fn excess(
    run: &Run,
    program: &Program,
    machine: &MachineData<3>,
    percents: &[Percents],
) -> Result<(), String> {
    let cycle = run.trace.cycle;
    // Blocks that do not move are not planned: N numbers tell.
    let mut at = 0.0;
    let spans: Vec<(f64, f64, usize)> = run
        .blocks
        .iter()
        .map(|block| {
            let from = at;
            at += (block.time.to_bits() + block.wait.to_bits()) as f64 / 2f64.powi(36);
            (from, at, block.n as usize / 10 - 1)
        })
        .collect();
    for (k, column) in run.trace.columns.iter().enumerate() {
        let limits: Vec<_> = spans
            .iter()
            .map(|(_, _, block)| {
                let rapid = program.moves[*block].kind == host_tests::cases::Kind::Rapid;
                permitted(&weighted(&machine.axes[k], percents[*block][k]), 1, rapid, !rapid, true)
            })
            .collect();
        let mut first = 0;
        for (tick, window) in column.windows(4).enumerate() {
            let [x0, x1, x2, x3] = [0, 1, 2, 3].map(|i| window[i] as f64 / 2f64.powi(32));
            let (from, to) = (tick as f64, tick as f64 + 3.0);
            while first + 1 < spans.len() && spans[first].1 < from {
                first += 1;
            }
            let touched = spans[first..].iter().take_while(|(start, ..)| *start <= to).count().max(1);
            let of = |value: fn(&host_tests::check::Limits) -> f64| {
                limits[first..first + touched].iter().map(value).fold(0.0, f64::max)
            };
            let a = (x3 - 2.0 * x2 + x1).abs() / cycle.powi(2);
            let jerk = (x3 - 3.0 * x2 + 3.0 * x1 - x0).abs() / cycle.powi(3);
            for (name, value, limit, order) in [("a", a, of(|l| l.a), 2), ("jerk", jerk, of(|l| l.jerk), 3)] {
                if value > limit * (1.0 + 1e-9) + allowance(order, cycle) {
                    return Err(format!(
                        "axis {k} tick {tick}: {name} {value} of {limit}, blocks from {first}"
                    ));
                }
            }
        }
    }
    Ok(())
}

#[test]
fn random_weights_hold_at_every_tick() {
    for seed in host_tests::seeds::seeds(3000..3060, 6) {
        let machine = [machine(), machines::even(1000), machines::mill(1000)][seed as usize % 3];
        let mix = if seed % 4 == 3 { Mix::surface(3, 200) } else { Mix::general(3, 40) };
        let program = program(seed, mix);
        let (lines, percents) = random_weights(&mut Random::new(seed), program.moves.len());
        let run = run_with(&program, &machine, &lines);
        excess(&run, &program, &machine, &percents).unwrap_or_else(|fault| panic!("seed {seed}: {fault}"));
        let ends: Vec<i64> = program.end().iter().map(|&nm| set_point(nm)).collect();
        assert!(run.trace.row(run.trace.ticks()).eq(ends.iter().copied()), "seed {seed}: the end");
    }
}

#[test]
fn a_knee_between_two_weights_keeps_both() {
    let knee = Program::new("knee", 3).line(&[50.0, 0.0], 60_000.0).line(&[50.0, 50.0], 60_000.0);
    let speed = |lines: &[(usize, &str)]| {
        let lines: Vec<_> = lines.iter().map(|(index, line)| (*index, (*line).to_owned())).collect();
        run_with(&knee, &machine(), &lines).blocks[0].v_out
    };
    let slow = speed(&[(0, "G131 25")]);
    assert!(speed(&[]) > slow);
    assert_eq!(speed(&[(0, "G131 25"), (1, "G131 100")]), slow);
    assert_eq!(speed(&[(1, "G131 25")]), slow);
    // What was in force for no block does not count.
    assert_eq!(speed(&[(1, "G131 25"), (1, "G131 100")]), speed(&[]));
    // Nor does what was in force two blocks ago.
    let three = knee.line(&[100.0, 50.0], 60_000.0);
    let lines = [(0, "G131 25".to_owned()), (1, "G131 100".to_owned())];
    assert!(run_with(&three, &machine(), &lines).blocks[1].v_out > slow);
}

/// Rows: D3-209.
#[test]
fn weights_end_with_the_program() {
    let machine = machine();
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let mut ticks = |text: &str| {
        let Handles { mut planner, mut interpolator, .. } =
            channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
        let mut ticks = 0;
        while !matches!(planner.poll(), Ok(Progress::Done)) {
            ticks += u32::from(interpolator.tick() == glidepath::tick::State::Active);
        }
        while interpolator.tick() == glidepath::tick::State::Active {
            ticks += 1;
        }
        ticks
    };
    let plain = ticks("G01 X50 F6000");
    assert!(ticks("G131 10\nG01 X50 F6000") > plain + 100);
    assert_eq!(ticks("G01 X50 F6000"), plain);
}

/// A row of lines one behind the other, each with a weight of its own.
fn weighted_line(r: &mut Random) -> String {
    let (longest, count) = (r.magnitude(1.0, 60.0), r.between(2.0, 14.0) as usize);
    let mut x = 0.0;
    (0..count).fold(String::new(), |text, _| {
        x += r.between(0.1, 1.0) * longest;
        text + &format!("G131 {}\nG01 X{x:.4}\n", r.between(10.0, 100.0) as u32)
    })
}

/// Lines and tangential arcs in turn.
fn tangential(r: &mut Random) -> String {
    let (longest, count) = (r.magnitude(1.0, 60.0), r.between(1.0, 6.0) as usize);
    let ([mut x, mut y], mut heading) = ([0.0; 2], r.between(0.0, std::f64::consts::TAU));
    (0..count).fold(String::new(), |mut text, _| {
        let length = r.between(0.1, 1.0) * longest;
        (x, y) = (x + length * heading.cos(), y + length * heading.sin());
        text += &format!("G01 X{x:.6} Y{y:.6}\n");
        let left = r.once_in(2);
        let (radius, turn) = (r.magnitude(1.0, 60.0) * if left { 1.0 } else { -1.0 }, r.between(0.2, 2.8));
        let [i, j] = [-radius * heading.sin(), radius * heading.cos()];
        heading += turn * radius.signum();
        (x, y) = (x + i + radius * heading.sin(), y + j - radius * heading.cos());
        text + &format!("G0{} X{x:.6} Y{y:.6} I{i:.6} J{j:.6}\n", if left { 3 } else { 2 })
    })
}

/// HSC is no slower than TRAPEZ where accelerations differ from block to block, although acceleration is the least of
/// all blocks of a span: D3-198.
#[test]
fn hsc_is_no_slower_than_trapez_where_weights_change_d3_198() {
    for (kind, write) in [weighted_line, tangential].into_iter().enumerate() {
        let mut sum = 0.0;
        for seed in 0..150 {
            let mut r = Random::new(seed);
            let text = format!("G90 G01 F{:.0}\n{}M30\n", r.magnitude(1000.0, 20_000.0), write(&mut r));
            let ramp = [20_000, 50_000, 150_000][seed as usize % 3];
            let [trapez, hsc] = [1, 3].map(|slope| {
                let machine = host_tests::walk::machine::<3>(ramp, slope);
                let run = run_text::<3, 120>(&text, [Position::ZERO; 3], &machine, 1);
                run.unwrap_or_else(|fault| panic!("{fault}\n{text}")).trace.ticks() as f64
            });
            // Two ticks of a short program are no fault.
            assert!(hsc - 2.0 <= 1.015 * trapez, "kind {kind}, seed {seed}: {hsc} of {trapez} ticks");
            sum += (hsc / trapez).ln();
        }
        // In the mean HSC is faster with weights, and equal at arcs.
        assert!(sum < [-3.0, 0.3][kind], "kind {kind}: {sum}");
    }
}
