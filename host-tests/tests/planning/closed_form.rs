//! Checks of the reference: closed forms, quadrature of their own jerk, and comparison with each other.
use host_tests::cases::random::Random;
use host_tests::reference::profile::{Change, Profile, Ramps, Slope, reach, rest_to_rest};

fn close(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * a.abs().max(b.abs())
}

/// Integrates a constant jerk over each ramp in small steps, exactly per step; gives speed and distance.
fn integrate(v0: f64, change: &Change) -> (f64, f64) {
    let [up, hold, down] = change.times;
    let jerks = [change.a_peak / up, 0.0, -change.a_peak / down];
    let (mut s, mut v, mut a) = (0.0, v0, 0.0);
    for (time, jerk) in [up, hold, down].into_iter().zip(jerks) {
        let steps = 1000;
        let h = time / f64::from(steps);
        for _ in 0..steps {
            s += h * (v + h * (a / 2.0 + h * jerk / 6.0));
            v += h * (a + h * jerk / 2.0);
            a += h * jerk;
        }
    }
    (v, s)
}

#[test]
fn a_speed_change_is_the_integral_of_its_jerk() {
    let mut r = Random::new(1);
    for _ in 0..200 {
        let ramps =
            Ramps { a: r.magnitude(10.0, 1e4), up: r.magnitude(0.01, 1.0), down: r.magnitude(0.01, 1.0) };
        let v0 = if r.once_in(3) { 0.0 } else { r.magnitude(0.1, 500.0) };
        let v1 = v0 + r.magnitude(1e-3, 2e3);
        let change = Change::new(v0, v1, ramps);
        let (v, s) = integrate(v0, &change);
        assert!(close(v, v1, 1e-10) && close(s, change.distance, 1e-10), "{ramps:?} {v0} {v1}: {v} {s}");
        assert!(change.a_peak <= ramps.a);
        // No ramp is steeper than allowed.
        assert!(change.a_peak / change.times[0] <= ramps.a / ramps.up * (1.0 + 1e-12));
        assert!(change.a_peak / change.times[2] <= ramps.a / ramps.down * (1.0 + 1e-12));
    }
}

#[test]
fn a_profile_covers_its_length_smoothly_and_is_the_fastest() {
    let mut r = Random::new(2);
    let mut kinds = [0; 3];
    for _ in 0..500 {
        let ramps = |r: &mut Random| Ramps {
            a: r.magnitude(500.0, 5000.0),
            up: r.magnitude(0.02, 0.2),
            down: r.magnitude(0.02, 0.2),
        };
        let (accelerate, brake) = (ramps(&mut r), ramps(&mut r));
        let v_max = r.magnitude(1.0, 1000.0);
        let length = r.magnitude(0.001, 1000.0);
        let v_in = v_max * r.unit();
        let v_out = reach(length, v_in, v_max * r.unit(), accelerate);
        let Some(p) = Profile::fastest(length, v_in, v_out, v_max, accelerate, brake) else {
            // Refused only if braking from v_in needs more than the length.
            assert!(reach(length, v_out, v_in, brake.reversed()) < v_in);
            kinds[0] += 1;
            continue;
        };
        kinds[if p.cruise > 0.0 { 1 } else { 2 }] += 1;
        let time = p.time();
        let covered = p.rise.distance + p.v_peak * p.cruise + p.fall.distance;
        assert!(close(covered, length, 1e-9), "{covered} {length} {p:?}");
        assert!(p.at(0.0).s.abs() < 1e-12 && close(p.at(time).s, length, 1e-12));
        // Speed is the slope of the distance, acceleration that of the speed.
        let h = time * 1e-5;
        for i in 1..50 {
            let t = time * f64::from(i) / 50.0;
            let (b, c, a) = (p.at(t - h), p.at(t), p.at(t + h));
            let j = accelerate.a / accelerate.up.min(accelerate.down) + brake.a / brake.up.min(brake.down);
            assert!(((a.s - b.s) / (2.0 * h) - c.v).abs() <= j * h * h + 1e-9 * (length / h), "{t} {p:?}");
            assert!(((a.v - b.v) / (2.0 * h) - c.a).abs() <= j * h + 1e-9 * (v_max / h), "{t} {p:?}");
            assert!(
                c.v <= v_max * (1.0 + 1e-12)
                    && c.a <= accelerate.a * 1.000_001
                    && -c.a <= brake.a * 1.000_001
            );
        }
        // A lower peak takes longer.
        let lower = p.v_peak - 1e-3 * (p.v_peak - v_in.max(v_out));
        if lower > 0.0 && lower < p.v_peak {
            assert!(
                Profile::with_peak(length, v_in, v_out, lower, accelerate, brake).time()
                    >= time * (1.0 - 1e-12)
            );
        }
    }
    assert!(kinds.iter().all(|&k| k > 20), "every kind occurs: {kinds:?}");
}

#[test]
fn equal_ramps_are_the_double_s() {
    let ramps = Ramps { a: 2000.0, up: 0.05, down: 0.05 };
    for length in [0.01, 0.1, 1.0, 9.9, 10.1, 29.9, 30.1, 100.0, 1000.0] {
        let p = Profile::fastest(length, 0.0, 0.0, 200.0, ramps, ramps).unwrap();
        assert!(close(p.time(), rest_to_rest(length, 200.0, 2000.0, 0.05), 1e-12), "{length}");
    }
    // By hand: 100 mm = 0.5 s at 200 mm/s, and 0.1 + 0.05 s for the ramps.
    assert!(close(rest_to_rest(100.0, 200.0, 2000.0, 0.05), 0.65, 1e-15));
    // Four equal phases of jerk 40 000 mm/s³: s = 2 j t³.
    assert!(close(rest_to_rest(2.0 * 40_000.0 * 1e-6, 200.0, 2000.0, 0.05), 0.04, 1e-12));
}

#[test]
fn reach_is_the_inverse_of_the_distance() {
    let mut r = Random::new(3);
    for _ in 0..500 {
        let ramps =
            Ramps { a: r.magnitude(10.0, 1e4), up: r.magnitude(0.01, 1.0), down: r.magnitude(0.01, 1.0) };
        let (v0, v1) = (r.between(0.0, 100.0), r.between(100.0, 300.0));
        let distance = Change::new(v0, v1, ramps).distance;
        assert!(close(reach(distance, v0, 1e4, ramps), v1, 1e-11));
        assert_eq!(reach(distance * 1.001, v0, v1, ramps), v1);
    }
}

/// Speed, distance and largest difference of acceleration against a·sin²(πt/2T), by quadrature.
#[test]
fn a_ramp_of_sin2_is_a_sine_squared_within_a_hundredth() {
    let mut r = Random::new(4);
    for _ in 0..50 {
        let ramps =
            Ramps { a: r.magnitude(10.0, 1e4), up: r.magnitude(0.05, 1.0), down: r.magnitude(0.05, 1.0) };
        let v0 = if r.once_in(3) { 0.0 } else { r.magnitude(0.1, 500.0) };
        let v1 = v0 + ramps.a * (ramps.up + ramps.down) * r.magnitude(0.01, 3.0);
        let change = Change::new(v0, v1, Slope::Sin2(ramps));
        let [up, hold, down] = change.times;
        let exact = |t: f64| {
            let left = up + hold + down - t;
            let u = if t < up { t / up } else { (left / down).min(1.0) };
            change.a_peak * (std::f64::consts::FRAC_PI_2 * u).sin().powi(2)
        };
        let steps = 20_000;
        let h = change.time() / f64::from(steps);
        let (mut v, mut s) = (v0, 0.0);
        for i in 0..steps {
            let t = h * (f64::from(i) + 0.5);
            let state = change.along(v0, t);
            assert!((state.a - exact(t)).abs() < 0.0095 * change.a_peak, "{t} of {ramps:?}");
            assert!((state.v - (v + exact(t) * h / 2.0)).abs() < 0.0022 * change.a_peak * up.max(down));
            s += h * (v + exact(t) * h / 2.0);
            v += exact(t) * h;
        }
        assert!(close(v, v1, 1e-7), "{v} {v1}");
        // q is larger than that of the sine, 1/4 − 1/π², at the lower speed for it, at the higher one against
        // it.
        let excess = 0.149_970_798_037_416 - (0.25 - std::f64::consts::FRAC_1_PI.powi(2));
        let shift = change.a_peak * (up * up - down * down) * excess;
        assert!(close(s + shift, change.distance, 1e-6), "{s} {shift} {}", change.distance);
        // The jerk stays below that of the sine.
        for section in change.sections.iter().filter(|section| section.time > 0.0) {
            let jerk = (section.a[1] - section.a[0]).abs() / section.time;
            let ramp = up.min(down).max(1e-300);
            assert!(jerk <= std::f64::consts::FRAC_PI_2 * change.a_peak / ramp);
        }
    }
}

#[test]
fn step_covers_the_difference_of_squares() {
    let mut r = Random::new(5);
    for _ in 0..200 {
        let (a, over) = ([r.magnitude(10.0, 1e4), r.magnitude(10.0, 1e4)], r.magnitude(1.0, 500.0));
        let (v0, dv) = (r.magnitude(0.1, 500.0), r.magnitude(0.1, 500.0));
        let v1 = v0 + dv;
        let middle = over.clamp(v0, v1);
        let s = (middle * middle - v0 * v0) / (2.0 * a[0]) + (v1 * v1 - middle * middle) / (2.0 * a[1]);
        let change = Change::new(v0, v1, Slope::Step(a, over));
        assert!(close(change.distance, s, 1e-10), "{s} {}", change.distance);
        assert!(close(change.along(v0, change.time()).v, v1, 1e-12));
    }
}
