//! A motion from stop to stop takes the closed-form optimum, rounded up to the next tick.
use glidepath::machine::MachineData;
use host_tests::cases::{Program, machines, named};
use host_tests::properties::verify;
use host_tests::reference::profile::{Profile, Ramps, Slope, rest_to_rest};
use host_tests::tolerance::SPEED_MARGIN;

/// Time of the motion beside the optimum: never faster, at most one tick slower. 1e-9 s: f64. Feeds keep a
/// margin, seen in moves that take minutes.
fn optimal<const AXES: usize>(program: &Program, machine: &MachineData<AXES>, optimum: f64) {
    let verdict = verify::<AXES, 120>(program, machine).unwrap();
    let (time, cycle) = (verdict.run.trace.time(), verdict.run.trace.cycle);
    let name = &program.name;
    assert!(time > optimum - 1e-9, "{name}: {time} s is faster than the optimum {optimum} s");
    let margin = if optimum > 60.0 { optimum * SPEED_MARGIN } else { 0.0 };
    assert!(time < optimum + cycle + margin + 1e-9, "{name}: {time} s, optimum {optimum} s, cycle {cycle} s");
}

/// Rows: D3-204, CF-16.
#[test]
fn equal_ramps() {
    // With equal ramps SIN2 takes the time of TRAPEZ: what a ramp loses the other one gains.
    for (cycle_us, slope) in [(250, 1), (1000, 1), (4000, 1), (10_000, 1), (250, 2), (1000, 2), (10_000, 2)] {
        let machine = machines::with_slope(machines::even::<3>(cycle_us), slope);
        for length in named::REST_TO_REST {
            let program = named::one_line(length, 60_000.0, 3);
            optimal(&program, &machine, rest_to_rest(length, 200.0, 2000.0, 0.05));
        }
    }
}

/// Rows: D3-205.
#[test]
fn four_different_ramps_of_sin2() {
    let machine = machines::with_slope(machines::uneven::<3>(1000), 2);
    let accelerate = Slope::Sin2(Ramps { a: 2000.0, up: 0.06, down: 0.15 });
    let brake = Slope::Sin2(Ramps { a: 1500.0, up: 0.1, down: 0.2 });
    for length in named::REST_TO_REST {
        for (v, feed) in [(400.0, 60_000.0), (20.0, 1200.0)] {
            let program = named::one_line(length, feed, 3);
            let profile = Profile::fastest(length, 0.0, 0.0, v, accelerate, brake).unwrap();
            optimal(&program, &machine, profile.time());
        }
    }
}

/// Time of a motion from rest to rest with accelerations `a` and decelerations `d` below and above
/// `change_over`: speed over distance is v² = v0² + 2 a s in each stage.
fn stepped(length: f64, v: f64, a: [f64; 2], d: [f64; 2], change_over: f64) -> f64 {
    // Distance and time up to the speed `to` and down again.
    let both = |to: f64| {
        let low = to.min(change_over);
        let stages = [(0.0, low), (low, to)].into_iter().zip([0, 1]);
        stages.fold((0.0, 0.0), |(s, t), ((from, to), k)| {
            let inverse = 1.0 / a[k] + 1.0 / d[k];
            (s + (to * to - from * from) / 2.0 * inverse, t + (to - from) * inverse)
        })
    };
    let (s, t) = both(v);
    if length >= s {
        return t + (length - s) / v;
    }
    let (to_change, _) = both(change_over);
    let k = usize::from(length > to_change);
    let inverse = 1.0 / a[k] + 1.0 / d[k];
    let (from, rest) = if k == 0 { (0.0, length) } else { (change_over, length - to_change) };
    both((from * from + 2.0 * rest / inverse).sqrt()).1
}

/// Rows: D3-203, D3-242, D3-243, D3-245, D3-246, D3-256, D3-258, D3-260, CF-13.
#[test]
fn two_stages_of_step_at_feed_and_in_rapid_motion() {
    for cycle_us in [250, 1000, 10_000] {
        let machine = machines::with_slope(machines::uneven::<3>(cycle_us), 0);
        for length in named::REST_TO_REST {
            for (v, feed) in [(400.0, 60_000.0), (90.0, 5400.0), (20.0, 1200.0)] {
                let time = stepped(length, v, [2000.0, 1200.0], [1200.0, 1200.0], 100.0);
                optimal(&named::one_line(length, feed, 3), &machine, time);
            }
            let time = stepped(length, 350.0, [1500.0, 2500.0], [1500.0, 1250.0], 350.0 / 3.0);
            optimal(&named::one_line(length, 1.0, 3).rapid(), &machine, time);
        }
    }
}

/// CF-01: where P-AXIS-00282 or 00283 is 0, P-AXIS-00011 or 00012 brakes too.
#[test]
fn a_stage_without_a_deceleration_brakes_as_it_accelerates() {
    for (decelerations, brakes) in
        [([0, 0], [2000.0, 1200.0]), ([900, 0], [900.0, 1200.0]), ([0, 900], [2000.0, 900.0])]
    {
        let mut machine = machines::with_slope(machines::uneven::<3>(1000), 0);
        machine.axes.iter_mut().for_each(|axis| axis.d_stufe = decelerations);
        for length in named::REST_TO_REST {
            let time = stepped(length, 400.0, [2000.0, 1200.0], brakes, 100.0);
            optimal(&named::one_line(length, 60_000.0, 3), &machine, time);
        }
    }
}

#[test]
fn step_takes_the_acceleration_of_its_stage() {
    let machine = machines::with_slope(machines::uneven::<3>(1000), 0);
    let (program, cycle) = (named::one_line(1000.0, 60_000.0, 3), 0.001);
    let trace = verify::<3, 120>(&program, &machine).unwrap().run.trace;
    let x: Vec<f64> = trace.columns[0].iter().map(|&x| x as f64 / 2f64.powi(32)).collect();
    let mut seen = [0; 4];
    for w in x.windows(3) {
        let (before, after) = ((w[1] - w[0]) / cycle, (w[2] - w[1]) / cycle);
        let a = (after - before) / cycle;
        let limits = [(2000.0, 0), (1200.0, 1), (-1200.0, 2)];
        // A window that lies in one stage.
        let stage = if a > 1.0 { usize::from(before.min(after) > 100.0) } else { 2 };
        if a.abs() > 1.0
            && (before - 100.0) * (after - 100.0) > 0.0
            && (before.max(after) < 399.0)
            && before > 3.0
            && after > 3.0
        {
            let (limit, k) = limits[stage];
            assert!((a - limit).abs() < 0.01, "{a} mm/s² at {before} mm/s");
            seen[k] += 1;
        }
    }
    assert!(seen[..3].iter().all(|&n| n > 30), "{seen:?}");
}

/// Rows: D3-239, D3-240, D3-241, D3-249, D3-250, D3-251, D3-252, D3-254, D3-255, D3-257.
#[test]
fn four_different_ramps_at_feed_and_one_in_rapid_motion() {
    let machine = machines::uneven::<3>(1000);
    let accelerate = Ramps { a: 2000.0, up: 0.06, down: 0.15 };
    let brake = Ramps { a: 1500.0, up: 0.1, down: 0.2 };
    let rapid = Ramps { a: 2500.0, up: 0.04, down: 0.04 };
    for length in named::REST_TO_REST {
        for (v, feed) in [(400.0, 60_000.0), (20.0, 1200.0), (0.5, 30.0)] {
            let program = named::one_line(length, feed, 3);
            let profile = Profile::fastest(length, 0.0, 0.0, v, accelerate, brake).unwrap();
            optimal(&program, &machine, profile.time());
        }
        let program = named::one_line(length, 1.0, 3).rapid();
        let profile = Profile::fastest(length, 0.0, 0.0, 350.0, rapid, rapid).unwrap();
        optimal(&program, &machine, profile.time());
    }
}

#[test]
fn several_axes_keep_the_limit_of_each() {
    // 3-4-5 triangle in X and Z. Z is the slower axis of the mill for every one of its limits.
    let machine = machines::mill::<3>(1000);
    let z = machine.axes[2];
    let ramps = |a: u32, up: u32, down: u32| {
        let a = f64::from(a) / 0.8;
        Ramps { a, up: f64::from(up) * 1e-6, down: f64::from(down) * 1e-6 }
    };
    let accelerate = ramps(z.a_beschl, z.tr_beschl_zu, z.tr_beschl_ab);
    let brake = ramps(z.a_brems, z.tr_brems_zu, z.tr_brems_ab);
    for length in [0.05, 5.0, 500.0] {
        let program = Program::new("slanted", 3).line(&[0.6 * length, 0.0, 0.8 * length], 60_000.0);
        let profile = Profile::fastest(length, 0.0, 0.0, 300.0 / 0.8, accelerate, brake).unwrap();
        optimal(&program, &machine, profile.time());
    }
}

/// Rows: NC-011.
#[test]
fn a_rotary_axis_alone_counts_degrees() {
    let machine = machines::mill::<4>(1000);
    let a = machine.axes[3];
    let us = |t: u32| f64::from(t) * 1e-6;
    let accelerate = Ramps { a: f64::from(a.a_beschl), up: us(a.tr_beschl_zu), down: us(a.tr_beschl_ab) };
    let brake = Ramps { a: f64::from(a.a_brems), up: us(a.tr_brems_zu), down: us(a.tr_brems_ab) };
    for degrees in [0.01, 1.0, 720.0] {
        let program = Program::new("rotary", 4).line(&[0.0, 0.0, 0.0, degrees], 600_000.0);
        let profile = Profile::fastest(degrees, 0.0, 0.0, 120.0, accelerate, brake).unwrap();
        optimal(&program, &machine, profile.time());
    }
}
