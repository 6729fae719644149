//! Machine data at the ends of their ranges: none of them switches a limit off.
use glidepath::machine::{AxisData, MachineData};
use glidepath::quantity::Position;
use host_tests::cases::{Program, machines};
use host_tests::check;
use host_tests::operate::{Act, operate_text};
use host_tests::properties::{Verdict, verify};

fn good(program: &Program, machine: &MachineData<3>) -> Verdict {
    verify::<3, 120>(program, machine).unwrap_or_else(|fault| panic!("{fault}"))
}

/// Corners of 45° and 90°, and a line that goes back.
fn corners(feed: f64) -> Program {
    Program::new("corners", 3)
        .line(&[4.0, 0.0], feed)
        .line(&[6.0, 2.0], feed)
        .line(&[6.0, 6.0], feed)
        .line(&[2.0, 6.0], feed)
        .line(&[4.0, 6.0], feed)
}

/// mm/min.
const FEEDS: [f64; 4] = [500.0, 3000.0, 9000.0, 60_000.0];

/// A machine with all limits at hand: nothing but the geometric ramp time differs.
fn geometric(us: u32, set: impl Fn(&mut AxisData)) -> MachineData<3> {
    let mut machine = machines::even::<3>(1000);
    for axis in &mut machine.axes {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        axis.tr_geom = us;
        set(axis);
    }
    machine
}

/// P-AXIS-00199 = 0 is preset with P-AXIS-00201.
#[test]
fn a_geometric_ramp_of_zero_is_the_smallest_ramp() {
    for slope in 1..4 {
        for tr_min in [1000, 10_000, 40_000] {
            for feed in FEEDS {
                let run = |us| {
                    let mut machine = geometric(us, |axis| axis.tr_min = tr_min);
                    machine.channel.slope_profile = slope;
                    good(&corners(feed), &machine).run.digest
                };
                assert_eq!(run(0), run(tr_min), "slope {slope}, tr_min {tr_min}, F{feed}");
            }
        }
    }
}

/// A geometric ramp time far below a cycle permits any jerk, and no more speed at a knee than acceleration does.
#[test]
fn a_geometric_ramp_below_the_cycle_keeps_the_acceleration() {
    for slope in 1..4 {
        for cycle in [100, 1000, 10_000] {
            for us in [1, 10, 100, 1000] {
                let mut machine = geometric(us, |axis| axis.tr_min = 1);
                (machine.channel.slope_profile, machine.channel.cycle_us) = (slope, cycle);
                for feed in FEEDS {
                    good(&corners(feed), &machine);
                }
            }
        }
    }
}

/// A ramp time of all axes in cycles, corners that are curves over time, and holds and overrides at many ticks: the largest share of
/// `a_max` that an axis shows.
fn short_ramps(cycles: f64, slope: u8, contour: &str, cycle_us: u32) -> f64 {
    let ramp = (cycles * f64::from(cycle_us)) as u32;
    let mut machine = geometric(ramp, |axis| {
        axis.tr_min = 1;
        machines::ramps(axis, ramp);
    });
    (machine.channel.cycle_us, machine.channel.slope_profile, machine.channel.ptp) = (cycle_us, slope, true);
    let text = format!(
        "N10 {contour}\nN20 G01 X20 F12000\nN30 X20 Y20\nN40 X5 Y30\nN50 X5 Y5\nN60 X40 Y6\nN70 #CONTOUR MODE OFF\nM30\n"
    );
    let start = [Position::ZERO; 3];
    let plain = operate_text::<3, 120>(&text, start, &machine, &[], 1000).unwrap();
    let ticks = plain.trace.ticks();
    let mut most = 0.0_f64;
    for k in 0..120 {
        let at = k * ticks / 120;
        let acts = if k % 2 == 0 {
            vec![(at, Act::Hold), (at + 40, Act::Resume)]
        } else {
            vec![(at, Act::Override(300)), (at + 7, Act::Override(1000))]
        };
        let run = operate_text::<3, 120>(&text, start, &machine, &acts, 1000).unwrap();
        for (column, axis) in run.trace.columns.iter().zip(&machine.axes) {
            let seen = check::peaks(column, run.trace.cycle).values[1] - check::allowance(2, run.trace.cycle);
            most = most.max(seen / f64::from(axis.a_max));
        }
    }
    most
}

const OVER_TIME: [(u8, &str); 5] = [
    (1, "#CONTOUR MODE ON [PTP PATH_DEV=0.2]"),
    (2, "#CONTOUR MODE ON [PTP PATH_DEV=0.2]"),
    (3, "#CONTOUR MODE ON [PTP PATH_DEV=0.2]"),
    (1, "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=4]"),
    (3, "#CONTOUR MODE ON [DEV PATH_DEV=0.2]"),
];

/// Ramps that are short against the cycle.
#[test]
fn a_hold_inside_a_curve_keeps_the_acceleration() {
    for (slope, contour) in OVER_TIME {
        for cycle_us in [1000, 4000] {
            for cycles in [0.1, 0.3, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 10.0] {
                let most = short_ramps(cycles, slope, contour, cycle_us);
                println!("slope {slope}, {contour}, {cycle_us} us, ramps of {cycles} cycles: {most:.4}");
            }
        }
    }
}
