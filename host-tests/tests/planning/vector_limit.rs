//! #VECTOR LIMIT: speed and acceleration along the path, never higher than the limits of the axes.
use glidepath::channel::Error;
use glidepath::machine::{AccelerationUnit, MachineData};
use glidepath::quantity::Position;
use host_tests::cases::random::{Mix, program};
use host_tests::cases::{Program, machines, set_point};
use host_tests::check::{self, allowance, peaks};
use host_tests::filtered;
use host_tests::operate::Act;
use host_tests::properties::axis_limits;
use host_tests::tolerance;
use host_tests::trace::{Run, run_text};

const CYCLE: f64 = 0.001;

/// a 2000 mm/s², ramps 50 ms, 200 mm/s; limits in mm/s².
fn machine() -> MachineData<3> {
    let mut machine = machines::even::<3>(1000);
    machine.channel.vector_unit = AccelerationUnit::MmS2;
    machine
}

fn run(machine: &MachineData<3>, text: &str) -> Run {
    run_text::<3, 120>(text, [Position::ZERO; 3], machine, 1)
        .unwrap_or_else(|fault| panic!("{fault}\n{text}"))
}

/// Largest speed, acceleration and deceleration of X, mm/s and mm/s², and the jerks of the ramps, mm/s³.
fn seen(run: &Run) -> [f64; 4] {
    let x: Vec<f64> = run.trace.columns[0].iter().map(|x| *x as f64 / 2f64.powi(32)).collect();
    let a: Vec<f64> = x.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]) / CYCLE.powi(2)).collect();
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let v: Vec<f64> = x.windows(2).map(|w| (w[1] - w[0]) / CYCLE).collect();
    let down: Vec<f64> = a.iter().map(|a| -a).collect();
    [most(&v), most(&a), most(&down), peaks(&run.trace.columns[0], CYCLE).values[2]]
}

/// What is seen of a line along X after these words, at G01 or G00.
fn line(words: &str, kind: &str, expected: [f64; 4]) {
    let run = run(&machine(), &format!("%m\n{words}\n{kind} X60\nM30"));
    for ((value, limit), order) in seen(&run).into_iter().zip(expected).zip([1, 2, 2, 3]) {
        let above = limit + allowance(order, CYCLE);
        assert!(value <= above && value > 0.98 * limit, "{words}: {value} of {limit}, order {order}");
    }
}

const FEED: &str = "G01 F9000";
const USUAL: [f64; 4] = [150.0, 2000.0, 2000.0, 40_000.0];

#[test]
fn each_limit_acts_and_leaves_the_ramp_times() {
    line("(none)", FEED, USUAL);
    line("#VECTOR LIMIT ON [VEL=6000]", FEED, [100.0, 2000.0, 2000.0, 40_000.0]);
    line("#VECTOR LIMIT ON [ACC=500]", FEED, [150.0, 500.0, 2000.0, 40_000.0]);
    line("#VECTOR LIMIT ON [DEC=500]", FEED, [150.0, 2000.0, 500.0, 40_000.0]);
    line("#VECTOR LIMIT ON [ACC=500 DEC=800]", FEED, [150.0, 500.0, 800.0, 16_000.0]);
    line(
        "#VECTOR LIMIT ON [ACC=500]\n#VECTOR LIMIT ON [DEC=800 VEL=6000]",
        FEED,
        [100.0, 500.0, 800.0, 16_000.0],
    );
    // Higher than the axes: nothing.
    line("#VECTOR LIMIT ON [ACC=2001 DEC=5000 VEL=60000]", FEED, USUAL);
}

#[test]
fn limits_are_switched_off_one_by_one_or_together() {
    let on = "#VECTOR LIMIT ON [ACC=500 DEC=800 VEL=6000]";
    line(&format!("{on}\n#VECTOR LIMIT OFF [ACC]"), FEED, [100.0, 2000.0, 800.0, 40_000.0]);
    line(&format!("{on}\n#VECTOR LIMIT OFF [ACC] [DEC]"), FEED, [100.0, 2000.0, 2000.0, 40_000.0]);
    line(&format!("{on}\n#VECTOR LIMIT OFF [VEL]"), FEED, [150.0, 500.0, 800.0, 16_000.0]);
    line(&format!("{on}\n#VECTOR LIMIT OFF ALL"), FEED, USUAL);
}

/// Rows: G-04.
#[test]
fn feed_and_rapid_motion_have_their_own() {
    let rapid = [200.0, 2000.0, 2000.0, 40_000.0];
    line("#VECTOR LIMIT ON [ACC=500 DEC=800 VEL=6000]", "G00", rapid);
    line("#VECTOR LIMIT ON [ACC=500 DEC=800 VEL=6000 RAPID]", "G00", [100.0, 500.0, 800.0, 16_000.0]);
    line("#VECTOR LIMIT ON [ACC=500 DEC=800 VEL=6000 RAPID]", FEED, USUAL);
    for kind in ["G00", FEED] {
        let both = [100.0, 500.0, 800.0, 16_000.0];
        line("#VECTOR LIMIT ON [ACC=500 DEC=800 VEL=6000 FEED RAPID]", kind, both);
    }
    let on = "#VECTOR LIMIT ON [VEL=6000 FEED RAPID]";
    line(&format!("{on}\n#VECTOR LIMIT OFF ALL"), "G00", rapid);
    line(&format!("{on}\n#VECTOR LIMIT OFF [VEL RAPID]"), "G00", rapid);
    line(&format!("{on}\n#VECTOR LIMIT OFF [VEL FEED]"), "G00", [100.0, 2000.0, 2000.0, 40_000.0]);
}

/// Rows: D3-261, D3-272, CF-15.
#[test]
fn values_of_the_channel_and_units() {
    let mut machine = machine();
    machine.channel.vector_acceleration_milli = 500_000;
    machine.channel.vector_deceleration_milli = 800_000;
    machine.channel.vector_velocity_milli = 6_000_000;
    let digest = |machine: &MachineData<3>, words: &str| {
        run(machine, &format!("%m\n{words}\nG01 F9000 X60 Y5\nX90\nM30")).digest
    };
    let explicit = digest(&machine, "#VECTOR LIMIT ON [ACC=500 DEC=800 VEL=6000]");
    assert_eq!(digest(&machine, "#VECTOR LIMIT ON ALL"), explicit);
    assert_eq!(digest(&machine, "#VECTOR LIMIT ON [ACC=100]\n#VECTOR LIMIT ON [ACC DEC VEL]"), explicit);
    assert_ne!(digest(&machine, ""), explicit);
    // Not by themselves: only where the program switches them on.
    assert_eq!(digest(&machine, ""), digest(&self::machine(), ""));
    // 1 mm/s² is 3600 mm/min²; the unit of ISG's default.
    machine.channel.vector_unit = AccelerationUnit::MmMin2;
    machine.channel.vector_acceleration_milli = 1_800_000_000;
    let metric = seen(&run(&machine, "%m\n#VECTOR LIMIT ON [ACC DEC=2880000]\nG01 F9000 X60\nM30"));
    assert!(metric[1] <= 500.0 + 0.01 && metric[1] > 499.0, "{metric:?}");
    assert!(metric[2] <= 800.0 + 0.01 && metric[2] > 799.0, "{metric:?}");
}

/// P-CHAN-00090, 00002 and 00208 do nothing until a program asks for them.
///
/// Rows: D3-283.
#[test]
fn values_of_the_channel_wait_for_their_command() {
    let text = |words: &str| format!("%m\n{words}\nG01 X60 F12000\nM30");
    let plain = run(&machine(), &text("(none)")).digest;
    let mut limited = machine();
    limited.channel.vector_velocity_milli = 1_500_000;
    (limited.channel.vector_acceleration_milli, limited.channel.vector_deceleration_milli) =
        (500_000, 500_000);
    assert_eq!(run(&limited, &text("(none)")).digest, plain);
    for words in ["#VECTOR LIMIT ON [VEL]", "#VECTOR LIMIT ON [ACC]", "#VECTOR LIMIT ON [DEC]"] {
        assert_ne!(run(&limited, &text(words)).digest, plain, "{words}");
    }
}

#[test]
fn arcs_take_a_limit_of_acceleration_where_the_channel_says_so() {
    let circle = Program::new("circle", 3).arc(&[0.0, 0.0, 0.0], [30.0, 0.0], true, 9000.0);
    let mut machine = machine();
    for axis in &mut machine.axes {
        (axis.a_max, axis.tr_geom) = (6000, 5000);
    }
    let with = |machine: &MachineData<3>, words: &str| {
        let text = circle.text(machine).replacen("\nN10 ", &format!("\n{words}\nN10 "), 1);
        let run = run(machine, &text);
        let contour = circle.contour(machine);
        let course = check::path(&run.trace, &contour, tolerance::PATH, 1000.0);
        let (a, rounding, _) = course.unwrap_or_else(|fault| panic!("{fault}")).acceleration(CYCLE);
        (run.digest, a, rounding)
    };
    let plain = with(&machine, "(none)");
    assert_eq!(with(&machine, "#VECTOR LIMIT ON [ACC=300]").0, plain.0);
    assert_ne!(with(&machine, "#VECTOR LIMIT ON [VEL=3000]").0, plain.0);
    machine.channel.cir_radial_acc_limit = true;
    let (digest, a, rounding) = with(&machine, "#VECTOR LIMIT ON [ACC=300 DEC=300]");
    assert!(digest != plain.0 && a <= 300.0 + rounding && a > 295.0 && plain.1 > 400.0, "{a} {plain:?}");
}

#[test]
fn random_programs_keep_path_limits_and_axis_limits() {
    for seed in host_tests::seeds::seeds(4000..4024, 4) {
        let mut machine = [machines::even::<3>(1000), machines::mill(1000)][seed as usize % 2];
        machine.channel.vector_unit = AccelerationUnit::MmS2;
        machine.channel.cir_radial_acc_limit = true;
        let mix = Mix { rapids: 0, ..Mix::general(3, 40) };
        let program = program(seed, mix);
        let words = "#VECTOR LIMIT ON [ACC=150 DEC=200 VEL=4000]";
        let text = program.text(&machine).replacen("\nN10 ", &format!("\n{words}\nN10 "), 1);
        let start = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
        let run = run_text::<3, 120>(&text, start, &machine, 1).unwrap_or_else(|fault| panic!("{fault}"));
        let contour = program.contour(&machine);
        let fault = |fault: String| panic!("seed {seed}: {fault}");
        check::limits(&run.trace, &axis_limits(&machine, &contour)).unwrap_or_else(fault);
        let course = check::path(&run.trace, &contour, tolerance::PATH, 3000.0);
        let (a, rounding, tick) =
            course.unwrap_or_else(|fault| panic!("seed {seed}: {fault}")).acceleration(CYCLE);
        assert!(a <= 200.0 + rounding, "seed {seed}: {a} at {tick}");
        let fastest = run.blocks.iter().map(|block| block.v_peak.to_bits()).max().unwrap_or(0);
        let fastest = fastest as f64 / 2f64.powi(58) / CYCLE;
        assert!(fastest <= 4000.0 / 60.0, "seed {seed}: {fastest}");
    }
}

#[test]
fn accelerations_that_no_axis_could_have_are_refused() {
    let refused = |machine: &MachineData<3>, words: &str| {
        let text = format!("%m\nN10 {words}\nG01 X1 F100\nM30");
        run_text::<3, 120>(&text, [Position::ZERO; 3], machine, 1).err()
    };
    let error = refused(&machine(), "#VECTOR LIMIT ON [DEC=0.99]").unwrap_or_default();
    assert!(error.contains("PathAcceleration") && error.contains("line: 2"), "{error}");
    assert_eq!(refused(&machine(), "#VECTOR LIMIT ON [DEC=1 ACC=1]"), None);
    let text = Error::PathAcceleration(glidepath::nc::Place::NONE).to_string();
    assert!(text.contains("1 mm/s² (3600 mm/min²)"), "{text}");
}

/// D3-261, D3-272: 0 in the machine data is refused where a program switches that limit on, and only there.
#[test]
fn zero_of_the_channel_is_refused_where_it_is_switched_on() {
    let mut zero = machine();
    zero.channel.vector_velocity_milli = 0;
    zero.channel.vector_acceleration_milli = 0;
    let of = |machine: &MachineData<3>, words: &str| {
        let text = format!("%m\nN10 {words}\nG01 X60 F9000\nM30");
        run_text::<3, 120>(&text, [Position::ZERO; 3], machine, 1)
    };
    let usual = run(&machine(), "%m\nN10 G90\nG01 X60 F9000\nM30").digest;
    assert_eq!(of(&zero, "G90").map(|run| run.digest), Ok(usual));
    for words in ["#VECTOR LIMIT ON [VEL]", "#VECTOR LIMIT ON [ACC]", "#VECTOR LIMIT ON ALL"] {
        let error = of(&zero, words).err().unwrap_or_default();
        assert!(error.contains("PathAcceleration") && error.contains("line: 2"), "{words}: {error}");
    }
    for words in ["#VECTOR LIMIT ON [DEC]", "#VECTOR LIMIT ON [VEL=6000 ACC=500]", "#VECTOR LIMIT OFF ALL"] {
        assert!(of(&zero, words).is_ok(), "{words}");
    }
    let text = Error::PathAcceleration(glidepath::nc::Place::NONE).to_string();
    assert!(text.contains("VEL above 0"), "{text}");
}

/// D3-215, D3-216: with both stages of STEP too, at every speed, on lines and arcs, and in a feed hold.
#[test]
fn limits_act_in_both_stages_of_step_and_in_holds() {
    let mut machine = machines::with_slope(machines::uneven::<3>(1000), 0);
    machine.channel.vector_unit = AccelerationUnit::MmS2;
    let texts = ["G01 F24000 X200\nM30", "G01 F12000 X100\nG02 X160 Y-60 J-60\nG01 Y-120\nM30"];
    for text in texts {
        for (words, up, down) in [
            ("#VECTOR LIMIT ON [DEC=400]", f64::MAX, 400.0),
            ("#VECTOR LIMIT ON [ACC=500 DEC=700]", 500.0, 700.0),
        ] {
            let text = format!("%m\n{words}\n{text}");
            for hold in [None, Some(350), Some(600), Some(900), Some(1200)] {
                let acts: Vec<(usize, Act)> =
                    hold.iter().flat_map(|at| [(*at, Act::Hold), (at + 700, Act::Resume)]).collect();
                let run = filtered::run::<3>(&text, &machine, &acts, 1000).expect("runs");
                let rows: Vec<_> = (0..run.path.len()).map(|row| run.path.mm(row)).collect();
                let apart = |w: &[Vec<f64>]| (0..3).map(|k| (w[1][k] - w[0][k]).powi(2)).sum::<f64>().sqrt();
                let steps: Vec<f64> = rows.windows(2).map(|w| apart(w) / CYCLE).collect();
                for (tick, pair) in steps.windows(2).enumerate() {
                    let a = (pair[1] - pair[0]) / CYCLE;
                    // Chords of curves are shorter than the curve.
                    let most = [up, down].map(|limit| 1.02 * limit + 1.0);
                    // Arcs do not take ACC (P-CHAN-00350).
                    let is_fast = a > most[0] && !text.contains("G02") || a < -most[1];
                    assert!(!is_fast, "{text}, hold {hold:?}: {a} mm/s² at {tick}");
                }
            }
        }
    }
}
