//! SIN2 and STEP, and slopes that change within a program: limits at every tick, exact ends, the same motion
//! mirrored and repeated.
use glidepath::machine::{ChannelData, MachineData};
use glidepath::quantity::{Distance, Position, Speed};
use glidepath::slope::limits::{Joins, Limits, Loose, SlopeLaw};
use glidepath::slope::profile::Profile;
use glidepath::slope::ramp_shape::RampShape;
use host_tests::cases::random::{Mix, program};
use host_tests::cases::{Program, edges, machines, set_point};
use host_tests::check;
use host_tests::properties::{permitted_at, verify};
use host_tests::reference::geometry::Element;
use host_tests::reference::merge::path_tolerance;
use host_tests::tolerance;
use host_tests::trace::{run, run_in_bursts, run_text};
use std::ops::RangeInclusive;

/// SIN2, STEP.
const SLOPES: [u8; 2] = [2, 0];

fn good<const AXES: usize>(program: &Program, machine: MachineData<AXES>) {
    for slope in SLOPES {
        let machine = machines::with_slope(machine, slope);
        verify::<AXES, 120>(program, &machine).unwrap_or_else(|fault| panic!("slope {slope}: {fault}"));
    }
}

#[test]
fn random_programs_keep_every_limit() {
    for seed in 900..912 {
        let mix = |axes| if seed % 4 == 3 { Mix::surface(axes, 300) } else { Mix::general(axes, 40) };
        good::<1>(&program(seed, mix(1)), machines::uneven(1000));
        good::<3>(&program(seed, mix(3)), machines::mill(1000));
        good::<6>(&program(seed, mix(6)), machines::even(4000));
    }
}

#[test]
fn arbitrary_machines_keep_every_limit() {
    // `cargo run --release -p host-tests --example soak -- 0 5000 2` goes on with SIN2, `... 0` with STEP.
    for seed in host_tests::seeds::seeds(0..60, 6) {
        for slope in SLOPES {
            let mut one = machines::arbitrary::<1>(seed);
            let mut three = machines::arbitrary::<3>(seed);
            (one.channel.slope_profile, three.channel.slope_profile) = (slope, slope);
            verify::<1, 120>(&program(seed, Mix::arbitrary(1, seed)), &one).unwrap_or_else(|e| panic!("{e}"));
            verify::<3, 120>(&program(seed, Mix::arbitrary(3, seed)), &three)
                .unwrap_or_else(|e| panic!("{e}"));
        }
    }
}

#[test]
fn edges_keep_every_limit() {
    for program in edges::three_axes() {
        good::<3>(&program, machines::even(1000));
        good::<3>(&program, machines::uneven(1000));
    }
    for program in edges::rotary() {
        good::<4>(&program, machines::mill(1000));
    }
}

#[test]
fn mirrored_programs_give_mirrored_set_points_and_every_run_the_same() {
    for slope in SLOPES {
        for seed in 920..926 {
            let machine = machines::with_slope(machines::mill::<3>(1000), slope);
            let program = program(seed, Mix::general(3, 40));
            let plain = run::<3, 120>(&program, &machine).unwrap();
            let other = run::<3, 120>(&program.mirrored(1), &machine).unwrap();
            assert_eq!(plain.trace.len(), other.trace.len());
            for (a, b) in plain.trace.columns[1].iter().zip(&other.trace.columns[1]) {
                assert!((a + b).abs() <= tolerance::MIRROR, "slope {slope}, seed {seed}: {a} {b}");
            }
            let again = run_in_bursts::<3, 120>(&program, &machine, 17).unwrap();
            assert_eq!((plain.digest, plain.trace), (again.digest, again.trace));
        }
    }
}

/// The program with a slope before every third block.
fn changing<const AXES: usize>(program: &Program, machine: &MachineData<AXES>, slopes: &[&str]) -> String {
    let mut text = String::new();
    for (i, line) in program.text(machine).lines().enumerate() {
        if i > 1 && i % 3 == 0 {
            text += slopes[(i / 3) % slopes.len()];
            text.push('\n');
        }
        text += line;
        text.push('\n');
    }
    text
}

/// The slope of each block of such a program, as in P-CHAN-00071.
fn slopes_of<const AXES: usize>(program: &Program, machine: &MachineData<AXES>, slopes: &[&str]) -> Vec<u8> {
    let mut slope = machine.channel.slope_profile;
    let mut of = Vec::new();
    for line in changing(program, machine, slopes).lines() {
        slope = match line {
            "#SLOPE [TYPE=STEP]" => 0,
            "#SLOPE [TYPE=TRAPEZ]" => 1,
            "#SLOPE [TYPE=SIN2]" | "#SET SLOPE PROFIL [2]" => 2,
            "#SLOPE [TYPE=HSC]" => 3,
            "#SLOPE DEFAULT" => machine.channel.slope_profile,
            _ => slope,
        };
        if line.contains(" X") {
            of.push(slope);
        }
    }
    of
}

/// Another slope first: what says DEFAULT has that of P-CHAN-00071 again, and both commands mean the same
/// slopes.
///
/// Rows: D3-202.
#[test]
fn the_default_is_the_slope_of_the_machine() {
    const NAMES: [&str; 4] = ["STEP", "TRAPEZ", "SIN2", "HSC"];
    let blocks = "G01 X20 Y1 F9000\nX24 Y1.1\nX25 Y1.1 F3000\nX60 Y4 F9000\nM30\n";
    let go = |profile: u8, words: &str| {
        let machine = machines::with_slope(machines::uneven::<3>(1000), profile);
        let text = format!("%s\n{words}\n{blocks}");
        run_text::<3, 120>(&text, [Position::ZERO; 3], &machine, 1)
            .unwrap_or_else(|e| panic!("{e}\n{text}"))
            .digest
    };
    for profile in 0..4 {
        let plain = go(profile, "");
        for (other, name) in (0..4).zip(NAMES) {
            let typed = go(profile, &format!("#SLOPE [TYPE={name}]"));
            assert_eq!(typed == plain, other == profile, "{name} on profile {profile}");
            assert_eq!(
                go(profile, &format!("#SET SLOPE PROFIL [{other}]")),
                typed,
                "{name} on profile {profile}"
            );
            let back = go(profile, &format!("#SLOPE [TYPE={name}]\n#SLOPE DEFAULT"));
            assert_eq!(back, plain, "{name} on profile {profile}");
        }
    }
}

/// Rows: CF-19.
#[test]
fn slopes_change_within_a_program() {
    let jerk_limited = ["#SLOPE [TYPE=SIN2]", "#SLOPE [TYPE=HSC]", "#SLOPE DEFAULT"];
    let all = ["#SLOPE [TYPE=STEP]", "#SET SLOPE PROFIL [2]", "#SLOPE [TYPE=HSC]", "#SLOPE [TYPE=TRAPEZ]"];
    for seed in 930..950 {
        let mix = if seed % 2 == 0 { Mix::surface(3, 200) } else { Mix::general(3, 40) };
        let program = program(seed, mix);
        for (slopes, profile) in [(&jerk_limited[..], 2), (&all[..], 0)] {
            let mut machine = machines::with_slope(machines::even::<3>(1000), profile);
            let contour = program.contour(&machine);
            machine.channel.slope_profile = 1;
            assert_eq!(contour.elements.len(), program.moves.len());
            let of_element = slopes_of(&program, &machine, slopes);
            // Per slope the limits of an axis at a place.
            let of_slope = |slope: u8, axis: usize, elements: &[Element]| {
                let channel = ChannelData { slope_profile: slope, ..machine.channel };
                permitted_at(&MachineData { channel, ..machine }, axis, elements)
            };
            let text = changing(&program, &machine, slopes);
            let start: Vec<i64> = program.start.iter().map(|&nm| set_point(nm)).collect();
            let from = std::array::from_fn(|k| Position::from_bits(start[k]));
            let fault = |what: String| -> ! { panic!("seed {seed}: {what}\n{text}") };
            let run = run_text::<3, 120>(&text, from, &machine, 1).unwrap_or_else(|e| fault(e));
            check::ends(&run.trace, &start, &program.end_points()).unwrap_or_else(|e| fault(e));
            let course = check::path(&run.trace, &contour, path_tolerance(&contour), 350.0)
                .unwrap_or_else(|e| fault(e));
            // Between two slopes either may act.
            let limits = |axis, range: RangeInclusive<usize>| {
                let elements = &contour.elements[range.clone()];
                let each = of_element[range].iter().map(|slope| of_slope(*slope, axis, elements));
                each.reduce(|one, other| check::Limits {
                    v: one.v.max(other.v),
                    a: one.a.max(other.a),
                    jerk: one.jerk.max(other.jerk),
                })
                .expect("an element")
            };
            check::by_place(&run.trace, &course, &contour, limits).unwrap_or_else(|e| fault(e));
        }
    }
}

/// STEP: the speed of an axis steps by what its smallest acceleration gives in a tick, or by a quarter of
/// P-AXIS-00008 where that is less; P-AXIS-00013 is for the other slopes.
#[test]
fn a_knee_of_step_takes_a_tick_of_the_acceleration() {
    for (a_max, step) in [(100_000, 1.2), (2000, 0.5)] {
        let machine = machines::machine(1000, |_, axis| {
            (axis.vb_max, axis.vb_eilgang, axis.a_trans_weight) = (1_000_000, 1_000_000, 7);
            // What the knee leaves of a_max: otherwise a standstill would be quicker.
            machines::accelerations(axis, 1500, a_max);
            axis.a_stufe = [1500, 1200];
        });
        let machine = MachineData::<3> { channel: machines::with_slope(machine, 0).channel, ..machine };
        let program = Program::new("knee", 3).line(&[50.0, 0.0], 60_000.0).line(&[50.0, 50.0], 60_000.0);
        let run = verify::<3, 120>(&program, &machine).unwrap_or_else(|fault| panic!("{fault}")).run;
        let v = run.blocks[0].v_out.to_bits() as f64 / 2f64.powi(58) / 0.001;
        assert!((v / step - 1.0).abs() < 1e-5, "{v} mm/s, step {step}");
    }
}

/// STEP needs no anchor: a line in pieces takes the time of the whole.
#[test]
fn a_line_in_pieces_takes_the_time_of_the_whole_with_step() {
    let machine = machines::with_slope(machines::even::<3>(1000), 0);
    let whole = Program::new("whole", 3).line(&[100.0], 12_000.0);
    let pieces = |count: u32| {
        let ends = (1..=count).map(|i| 100.0 * (f64::from(i) / f64::from(count)).powf(1.2));
        ends.fold(Program::new("pieces", 3), |program, x| program.line(&[x], 12_000.0))
    };
    let time = |program: &Program| verify::<3, 120>(program, &machine).unwrap().run.trace.time();
    for count in [2, 10, 60] {
        let (one, cut) = (time(&whole), time(&pieces(count)));
        assert!((cut - one).abs() <= 0.001 + 1e-9, "{count} pieces: {cut} s, whole {one} s");
    }
}

/// One line after the other, on one machine: acceleration in steps, with straight edges, and as a sine
/// squared.
///
/// Rows: D3-210.
#[test]
fn each_slope_has_its_shape() {
    let machine = machines::with_slope(machines::even::<3>(1000), 0);
    let text = "N10 G01 X60 F18000\n#SLOPE [TYPE=TRAPEZ]\nN20 X120\n#SLOPE [TYPE=SIN2]\nN30 X180\n\
                #SLOPE [TYPE=HSC]\nN40 X240\nM30\n";
    // A standstill at each end keeps the lines apart.
    let text = text.replace("#SLOPE", "G04 0.01\n#SLOPE");
    let run = run_text::<3, 120>(&text, [Position::ZERO; 3], &machine, 1).unwrap();
    let moved = run.trace.columns[0].iter().map(|&bits| bits as f64 / 2f64.powi(32));
    let x: Vec<f64> = [0.0; 4].into_iter().chain(moved).collect();
    let difference = |values: &[f64]| values.windows(2).map(|p| p[1] - p[0]).collect::<Vec<_>>();
    let a = difference(&difference(&x));
    // What each line needs to get from rest to its highest acceleration, and the largest step on the way.
    let ramp = |line: usize| {
        let [from, to] = [line, line + 1].map(|k| 60.0 * k as f64);
        let (first, last) = (
            x.iter().position(|&x| x > from + 1e-9).unwrap(),
            x.iter().position(|&x| x > to - 1e-9).unwrap_or(x.len() - 1),
        );
        let a = &a[first.saturating_sub(3)..(first + last) / 2];
        let peak = a.iter().copied().fold(0.0, f64::max);
        let begins = a.iter().position(|&a| a > 1e-4 * peak).unwrap();
        let tops = a.iter().position(|&a| a > peak * (1.0 - 1e-3)).unwrap();
        let steps = difference(&a[begins.saturating_sub(1)..=tops]);
        (tops - begins, steps.into_iter().map(|step| step / peak).collect::<Vec<_>>())
    };
    let largest = |steps: &[f64]| steps.iter().copied().fold(0.0, f64::max);
    // At once.
    let (ticks, steps) = ramp(0);
    assert!(ticks <= 1 && largest(&steps) > 0.5, "STEP: {ticks}, {steps:?}");
    for line in [1, 3] {
        let (ticks, steps) = ramp(line);
        let inner = &steps[2..steps.len() - 2];
        let least = inner.iter().copied().fold(f64::MAX, f64::min);
        assert!(ticks > 20 && largest(inner) - least < 0.02 * least, "line {line}: {ticks}, {steps:?}");
    }
    // sin²(πt/2T): the steepest in the middle, π/2 of the mean, and next to nothing at both ends.
    let (ticks, steps) = ramp(2);
    let mean = 1.0 / steps.len() as f64;
    assert!((largest(&steps) / mean - core::f64::consts::FRAC_PI_2).abs() < 0.1, "SIN2: {ticks}, {steps:?}");
    let ends = [steps[1], steps[steps.len() - 2]];
    assert!(ends.iter().all(|&step| step < 0.4 * mean), "SIN2: {ticks}, {steps:?}");
}

/// Long blocks are as fast with TRAPEZ as with HSC; of many short ones with other feeds HSC takes about half
/// the time.
///
/// Rows: D3-198.
#[test]
fn long_blocks_need_no_hsc_and_short_ones_do() {
    let ticks = |program: &Program, slope| {
        let machine = machines::with_slope(machines::even::<3>(1000), slope);
        run::<3, 120>(program, &machine).unwrap().trace.len() as f64
    };
    let long = Program::new("long", 3)
        .line(&[200.0, 0.0], 12_000.0)
        .line(&[200.0, 200.0], 12_000.0)
        .line(&[0.0, 200.0], 12_000.0);
    assert!((ticks(&long, 1) / ticks(&long, 3) - 1.0).abs() < 0.01);
    let mut short = Program::new("short", 3);
    for k in 1..=400 {
        short = short.line(&[0.5 * f64::from(k), 0.0], 9000.0 + 30.0 * f64::from(k % 7));
    }
    let [trapez, sin2, hsc] = [1, 2, 3].map(|slope| ticks(&short, slope));
    println!("{trapez} {sin2} {hsc}");
    assert!(hsc < 0.6 * trapez && hsc < 0.6 * sin2, "{trapez} {sin2} {hsc}");
}

/// Slopes longer than the block by a hair shrink; where they shrank by too much, the next lower peak serves.
#[test]
fn a_block_between_two_slow_ends_has_a_plan() {
    let limits = Limits {
        v: 0.012_945_141,
        a_up: 1.413_443_3e-5,
        a_down: 9.679_013e-6,
        loose: Loose::NONE,
        law: SlopeLaw::JerkLimited {
            shape: RampShape::SineSquare,
            joins: Joins::Alike,
            j: [5.369_325_3e-8, 7.038_481_4e-8, 2.296_067_3e-8, 1.000_325_8e-8],
        },
    };
    let length = Distance::from_bits(109_397_444_209_756);
    let mut profile = Profile::default();
    let planned = profile.plan(length, Speed::from_bits(25_793_776), Speed::from_bits(10_310_111), &limits);
    assert_eq!(planned, Ok(()));
}

/// Where a speed is to stay (CONST_VEL), a law from a standstill has the acceleration that the axes leave, up to a quarter of
/// the speed or to the one that it ends with; from a quarter on the speed stays.
#[test]
fn a_speed_that_stays_is_left_below_its_quarter_alone() {
    let of = |loose: Loose, speeds: [f32; 2]| {
        let law = SlopeLaw::JerkLimited { shape: RampShape::Linear, joins: Joins::Alike, j: [1e-4; 4] };
        let limits = Limits { v: 0.1, a_up: 1e-8, a_down: 1e-8, law, loose };
        let [v_in, v_out] = speeds.map(|v| Speed::from_bits(glidepath::quantity::speed_bits(v)));
        let mut profile = Profile::default();
        profile.plan(Distance::from_bits(10 << 44), v_in, v_out, &limits).expect("it is long enough");
        (profile.peak().to_bits() as f64 / (1_u64 << 58) as f64, profile.time())
    };
    let [kept, loose] = [Loose::NONE, Loose::of(1e-3)];
    let (peak, time) = of(loose, [0.0, 0.0]);
    assert!((0.0249..0.02501).contains(&peak), "from a standstill to one {peak}");
    assert!(time < of(kept, [0.0, 0.0]).1, "not later than with what the speed may change by");
    let (peak, _) = of(loose, [0.0, 0.06]);
    assert!((0.0599..0.06001).contains(&peak), "from a standstill {peak}");
    let (peak, _) = of(loose, [0.03, 0.03]);
    assert!((0.03..0.0303).contains(&peak), "above the quarter {peak}");
    let (peak, _) = of(loose, [0.02, 0.02]);
    assert!((0.0249..0.02501).contains(&peak), "below it {peak}");
}

/// Where a speed is to stay, low ones are joined with more acceleration. With a lower override they are not low beside
/// the speed of now, and still have to be joined.
#[test]
fn low_speeds_are_joined_beside_a_speed_that_was_lowered() {
    let j = [3.204_190_5e-6, 3.204_190_5e-6, 1.756_503_8e-5, 1.756_503_8e-5];
    let law = SlopeLaw::JerkLimited { shape: RampShape::SineSquare, joins: Joins::Alike, j };
    let a = 4.286_741_8e-7;
    let whole = Limits { v: 2.267_933_2e-4, a_up: a, a_down: a, law, loose: Loose::of(1.577_446e-3) };
    let (length, speeds) = (Distance::from_bits(316_412_192), [11_205_772_050_432, 11_254_970_974_208]);
    for [v_in, v_out] in [speeds, [speeds[1], speeds[0]]].map(|ends| ends.map(Speed::from_bits)) {
        for v in [whole.v, 1.428_469_8e-4, 5e-5] {
            let mut profile = Profile::default();
            assert_eq!(profile.plan(length, v_in, v_out, &Limits { v, ..whole }), Ok(()), "{v_in:?}, {v}");
        }
        // Too much for what the axes have.
        let stays = Limits { loose: Loose::of(2.0 * a), ..whole };
        assert!(Profile::default().plan(Distance::from_bits(3_000_000), v_in, v_out, &stays).is_err());
    }
}
