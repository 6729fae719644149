//! Feed holds at random ticks of random programs: inside all limits, and how long they take against the measure of
//! `host_tests::holds`. `cargo run --release -p host-tests --example holds` is the long search.
use glidepath::machine::ChannelData;
use glidepath::quantity::Position;
use host_tests::cases::machines;
use host_tests::cases::random::Random;
use host_tests::holds::{Track, holds, of_seed};
use host_tests::never_slower::{Case, METHODS, SLOPES};
use host_tests::operate::operate_within;
use host_tests::reference::profile::Ramps;
use host_tests::reference::stop::Stop;

/// On a straight line at feed the measure is the closed form.
#[test]
fn on_a_line_the_measure_is_the_closed_form() {
    for slope in 0..4 {
        let mut machine = machines::even::<3>(1000);
        machine.channel = ChannelData { slope_profile: slope, ..machine.channel };
        for axis in &mut machine.axes {
            (axis.a_stufe, axis.a_grenz_stufe) = ([2000; 2], [2000; 2]);
        }
        let run = operate_within::<3, 120>(
            "G01 X100 F6000\nM30\n",
            [Position::ZERO; 3],
            &machine,
            (&[], 1000),
            20_000,
        );
        let track = Track::new(run.expect("runs"), &machine);
        let stop = track.measure(500).expect("it moves");
        let ramps = Ramps { a: 2000.0, up: 0.05, down: 0.05 };
        let form = if slope == 0 {
            Stop { time: 0.05, way: 2.5 }
        } else {
            Stop::with_jerk(100.0, 0.0, ramps, ramps)
        };
        // Five ticks until it acts, at 100 mm/s.
        assert!((stop.time - form.time - 0.005).abs() < 1e-4, "slope {slope}: {stop:?} {form:?}");
        assert!((stop.way - form.way - 0.5).abs() < 0.02, "slope {slope}: {stop:?} {form:?}");
    }
}

/// Every slope and method.
#[test]
fn holds_of_random_programs_stay_inside_their_limits() {
    let mut checked = 0;
    for (slope, (slope_name, ..)) in SLOPES.iter().enumerate() {
        for (method, method_name) in METHODS.iter().enumerate() {
            for seed in 0..8 {
                let mut random = Random::new(seed);
                let parts: Vec<f64> = (0..3).map(|_| random.unit()).collect();
                let Ok(outcome) = holds(&Case::new(seed), (slope, method), 1.0, &parts) else { continue };
                let name = format!("{slope_name}, {method_name}, seed {seed}");
                assert!(outcome.faults.is_empty(), "{name}: {:?}", outcome.faults);
                checked += 1;
            }
        }
    }
    assert!(checked > 200, "{checked} programs ran");
}

/// Holds that took longer, each with its time before, s: because no shorter stop replaced one that led into the look-ahead,
/// because terms of jerk with different signs added up, and because a shorter stop was searched too rarely.
#[test]
fn holds_in_rounded_corners_are_short() {
    let seen = |(slope, method, seed, tick): (usize, usize, u64, usize)| {
        let outcome = of_seed(seed, (slope, method), 4).expect("runs");
        let held = outcome.holds.iter().find(|held| held.tick == tick);
        held.expect("a hold at this tick").seen.time
    };
    for (hold, most, before) in [
        ((2, 3, 8, 82), 0.10, 1.260),
        ((4, 3, 11, 543), 0.12, 0.392),
        ((2, 5, 9, 283), 0.10, 0.148),
        ((2, 1, 8, 251), 0.13, 0.160),
    ] {
        let time = seen(hold);
        assert!(time <= most, "{hold:?}: {time} s; before {before} s");
    }
}
