//! Axes that differ widely, at short cycles: a permitted jerk of a few LSB per tick³.
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use host_tests::cases::machines;
use host_tests::seeds::seeds;
use host_tests::unlike::Unlike;

/// Accelerations (mm/s²; slope and largest), ramps and geometric ramps (µs) of three axes.
fn machine(cycle_us: u32, slope: u8, axes: [[u32; 4]; 3]) -> MachineData<3> {
    let mut machine = machines::machine::<3>(cycle_us, |k, axis| {
        let [a, a_max, ramp, geometric] = axes[k];
        machines::accelerations(axis, a, a_max);
        machines::ramps(axis, ramp);
        (axis.a_stufe, axis.a_grenz_stufe) = ([a; 2], [a; 2]);
        (axis.tr_geom, axis.tr_min) = (geometric, cycle_us);
        (axis.vb_max, axis.vb_eilgang) = (300_000, 300_000);
    });
    machine.channel.slope_profile = slope;
    machine.channel.look_ahead = 30;
    (machine.channel.surface, machine.channel.ptp) = (true, true);
    machine
}

/// A short last piece of a curve over time once took what rounding of the others left: a jump of up to 160 LSB.
#[test]
fn a_curve_over_time_has_no_jump_in_a_short_piece() {
    let mut slow = machine(100, 1, [[200, 600, 200, 0], [5, 15, 300, 0], [5, 15, 100, 10_000]]);
    (slow.axes[1].vb_max, slow.axes[1].vb_eilgang) = (20_000, 20_000);
    slow.axes[1].tr_beschl_ab = 600;
    slow.axes[1].tr_grenz = 600;
    slow.axes[0].tr_beschl_ab = 100;
    let cases = [
        Unlike {
            machine: slow,
            start: [Position::ZERO; 3],
            text: "G90 G17\n#HSC ON [OPMODE=1 CONTERROR=0.1]\nG01 X2.501799712 F1182.011\nX4.438775137 Y1.683102476\n\
                X6.193464893 Y6.967878382\nG02 X13.223550107 Y7.534387891 I3.722270259 J-2.288331476\n\
                G01 X14.344697509 Y5.936018898 Z-0.201377109\nX16.085138823 Y3.454750668 Z-1.244195609\n\
                X20.609177542 Y-2.99496611\nX21.141679394 Y-3.759272708 F18872.769\n\
                X21.52134671 Y-4.368156769 Z-1.173045976\nM30\n"
                .to_owned(),
        },
        Unlike {
            machine: machine(250, 3, [[20, 20, 25_000, 25_000], [20, 20, 1250, 0], [300, 300, 1250, 10_000]]),
            start: [Position::ZERO; 3],
            text: "#CONTOUR MODE ON [DEV PATH_DEV=0.1]\nG01 X-1.701377 F5009.925\n\
                X-5.067908 Y2.225992 Z-2.390141\nX-5.255849 Y1.820372 Z-2.608317\n\
                X-4.943119 Y2.137893 Z-2.832569 F4607.988\nM30\n"
                .to_owned(),
        },
    ];
    for case in cases {
        case.judge().unwrap_or_else(|fault| panic!("{fault}\n{}", case.text));
    }
}

/// Two curves over time share a line, and the second one takes all of its rest. Its distance, rounded to `f32`, was 60 pm
/// longer than that rest: a jerk of twice the limit.
#[test]
fn a_curve_takes_no_more_than_the_rest_of_a_line() {
    Unlike::new(40_641).judge().unwrap_or_else(|fault| panic!("{fault}"));
}

#[test]
fn limits_hold_on_machines_with_unlike_axes() {
    for seed in seeds(0..40, 20) {
        Unlike::new(seed).judge().unwrap_or_else(|fault| panic!("seed {seed}: {fault}"));
    }
}
