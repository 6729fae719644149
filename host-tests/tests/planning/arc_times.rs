//! Arcs use the limits of the axes: nearly the bound of steady motion, and never slower than with stops at
//! their ends.
//!
//! On a circle an axis moves in every direction. In steady motion its speed is at most V, the least of
//! ∛(J·R²), √(a·R) and the feed. V is the bound.
use glidepath::MachineData;
use glidepath::quantity::Position;
use host_tests::cases::machines;
use host_tests::cases::random::Random;
use host_tests::check;
use host_tests::properties::permitted;
use host_tests::rounded::{Run, run_from};

/// 2000 mm/s², 1000 mm/s, all ramps and the geometric one alike.
fn machine(ramp_us: u32, slope: u8) -> MachineData<3> {
    let mut machine = machines::with_slope(machines::even(1000), slope);
    for axis in &mut machine.axes {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        machines::ramps(axis, ramp_us);
        axis.tr_geom = ramp_us;
    }
    machine
}

/// A run whose every tick keeps the limits of every axis.
fn good(text: &str, start: f64, machine: &MachineData<3>) -> Run {
    let run = run_from(text, [Position::from_num(start), Position::ZERO, Position::ZERO], machine);
    let slope = machine.channel.slope_profile;
    let limits = machine.axes.each_ref().map(|axis| permitted(axis, slope, false, true, true));
    check::limits(&run.trace, &limits).unwrap_or_else(|fault| panic!("{fault}\n{text}"));
    run
}

/// Twenty circles take at most 1.05 times the bound, and two reach 0.95 of its speed.
#[test]
fn circles_are_near_the_bound() {
    for ramp_us in [50_000, 150_000] {
        let jerk = 2000.0 / (f64::from(ramp_us) * 1e-6);
        for slope in [1, 3] {
            let machine = machine(ramp_us, slope);
            for radius in [0.2, 0.5, 1.0, 3.0, 10.0, 30.0] {
                let v = f64::cbrt(jerk * radius * radius).min(f64::sqrt(2000.0 * radius)).min(1000.0 / 3.0);
                let turns = |count: usize| format!("G03 I-{radius} F20000\n").repeat(count) + "M30\n";
                let bound = 20.0 * std::f64::consts::TAU * radius / v;
                let time = good(&turns(20), radius, &machine).time();
                assert!(
                    time < 1.05 * bound,
                    "R {radius}, {ramp_us} µs, slope {slope}: {time}, bound {bound}"
                );
                let fastest = good(&turns(3), radius, &machine).speeds().into_iter().fold(0.0, f64::max);
                assert!(fastest > 0.95 * v, "R {radius}, {ramp_us} µs, slope {slope}: {fastest} of {v}");
            }
        }
    }
}

/// A line, a tangential arc and a line, also as a helix, take no longer than with standstills at both ends of the arc.
#[test]
fn a_tangential_arc_is_never_slower_than_standstills() {
    let mut r = Random::new(7100);
    for case in 0..90 {
        let machine = machine(if case % 2 == 0 { 50_000 } else { 150_000 }, 1 + (case / 2 % 3) as u8);
        let (radius, angle) = (r.magnitude(0.2, 80.0), r.between(0.2, 5.5));
        let [before, behind] = [r.magnitude(0.5, 80.0), r.magnitude(0.5, 80.0)];
        let rise = if case % 4 == 3 { r.magnitude(0.01, 1.0) * radius } else { 0.0 };
        let feed = r.magnitude(1000.0, 20_000.0);
        let (x, y) = (before + radius * angle.sin(), radius * (1.0 - angle.cos()));
        let (to_x, to_y) = (x + behind * angle.cos(), y + behind * angle.sin());
        let way = format!(
            "G01 X{before:.6} F{feed:.1}\nG03 X{x:.6} Y{y:.6} Z{rise:.6} I0 J{radius:.6}\nG01 X{to_x:.6} Y{to_y:.6}\nM30\n"
        );
        let [time, stops] =
            [way.clone(), format!("G360\n{way}")].map(|text| good(&text, 0.0, &machine).time());
        assert!(time <= 1.01 * stops + 0.002, "{case}: {time}, with standstills {stops}\n{way}");
    }
}

/// Circles of many turns in pieces of any angle, with other feeds between and lines behind, keep the limits of every axis.
#[test]
fn circles_in_pieces_keep_all_limits() {
    let mut r = Random::new(7200);
    for case in 0..240 {
        let machine = machine(if case % 2 == 0 { 50_000 } else { 150_000 }, 1 + (case / 2 % 3) as u8);
        let radius = r.magnitude(0.2, 60.0);
        let rise = if case % 4 == 3 { r.magnitude(0.01, 1.0) * radius } else { 0.0 };
        let (mut angle, mut z) = (0.0_f64, 0.0);
        let mut way = format!("F{:.1}\n", r.magnitude(2000.0, 40_000.0));
        let [mut x, mut y] = [radius, 0.0];
        for _ in 0..3 + r.bits() % 8 {
            let turn = [1.0, 1.0, 0.5, 0.75, r.between(0.05, 1.0)][(r.bits() % 5) as usize];
            let centre = [-x, -y];
            (angle, z) = (angle + turn * std::f64::consts::TAU, z + rise * turn);
            if turn < 1.0 {
                [x, y] = [radius * angle.cos(), radius * angle.sin()];
            }
            way += &format!("G03 X{x:.6} Y{y:.6} Z{z:.6} I{:.6} J{:.6}\n", centre[0], centre[1]);
            if r.once_in(6) {
                way += &format!("F{:.1}\n", r.magnitude(2000.0, 40_000.0));
            }
        }
        let length = r.magnitude(0.5, 20.0);
        way += &format!("G01 X{:.6} Y{:.6}\nM30\n", x - length * angle.sin(), y + length * angle.cos());
        let [time, stops] =
            [way.clone(), format!("G360\n{way}")].map(|text| good(&text, radius, &machine).time());
        assert!(time <= 1.01 * stops + 0.002, "{case}: {time}, with standstills {stops}\n{way}");
    }
}
