//! Blocks shorter than a tick, without a straight line among them.
//!
//! With HSC and STEP: TRAPEZ and SIN2 can only brake within a block, so they must be slow enough to stop in
//! the look-ahead.
use glidepath::lookahead::ReleasedSpan;
use glidepath::machine::MachineData;
use glidepath::quantity::{Distance, Speed};
use glidepath::slope::limits::{Joins, Limits, Loose, SlopeLaw};
use glidepath::slope::profile::Profile;
use glidepath::slope::ramp_shape::RampShape;
use host_tests::cases::random::Random;
use host_tests::cases::{Program, machines};
use host_tests::properties::verify;

/// Chords of so many mm on two radians of a circle, too bent to be merged, between tangential lines of `lead`
/// mm.
fn chords(chord: f64, radius: f64, lead: f64, feed: f64) -> Program {
    let count = (2.0 * radius / chord) as u32;
    let mut program = Program::new(format!("chords of {chord} mm"), 3).line(&[lead, 0.0], feed);
    let at = |angle: f64| [lead + radius * angle.sin(), radius - radius * angle.cos()];
    for i in 1..=count {
        program = program.line(&at(f64::from(i) * chord / radius), feed);
    }
    let angle: f64 = f64::from(count) * chord / radius;
    let [x, y] = at(angle);
    program.line(&[x + lead * angle.cos(), y + lead * angle.sin()], feed)
}

/// A machine whose knees permit the feed.
fn stiff(slope: u8, cycle_us: u32) -> MachineData<3> {
    let machine = machines::machine::<3>(cycle_us, |_, axis| {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        machines::accelerations(axis, 20_000, 30_000);
        machines::ramps(axis, 50_000);
        axis.tr_geom = 5000;
    });
    machines::with_slope(machine, slope)
}

/// Path of every tick within the chords, mm.
fn steps(program: &Program, machine: &MachineData<3>) -> Vec<f64> {
    let verdict = verify::<3, 120>(program, machine).unwrap_or_else(|fault| panic!("{fault}"));
    let last = verdict.contour.elements.len() - 1;
    let course = verdict.course;
    let inside = |element: &usize| *element > 0 && *element < last;
    let pairs = course.s.windows(2).zip(course.element.windows(2));
    pairs.filter(|(_, element)| element.iter().all(inside)).map(|(s, _)| s[1] - s[0]).collect()
}

/// Rows: D3-221.
#[test]
fn ten_metres_a_minute_at_five_milliseconds() {
    // 0.8333 mm a cycle, 16.7 chords. 100 mm are 120 cycles.
    for slope in [0, 3] {
        let steps = steps(&chords(0.05, 50.0, 60.0, 10_000.0), &stiff(slope, 5000));
        let full = steps.iter().filter(|step| **step > 0.833_3).count();
        println!("slope {slope}: full feed in {full} of {} cycles", steps.len());
        assert!(full >= 110 && full + 2 >= steps.len(), "slope {slope}: {full} of {} cycles", steps.len());
    }
}

#[test]
fn no_faster_than_a_tick_can_pass() {
    // 31 chords a tick, the shortest of which is a nanometre short.
    let fastest = steps(&chords(0.01, 5.0, 60.0, 10_000.0), &stiff(3, 5000)).into_iter().fold(0.0, f64::max);
    println!("{fastest} mm a tick");
    assert!(fastest > 0.3 && fastest <= 0.3101, "{fastest}");
}

/// A slowing down that fills a block: where the block has few LSB of length (2^-44 mm), rounding it is a
/// larger part of it than limits have to spare.
#[test]
fn a_slope_that_fills_a_block_of_few_lsb() {
    let mut r = Random::new(7);
    let mut least = i64::MAX;
    for bend in [RampShape::Linear, RampShape::SineSquare] {
        for case in 0..20_000 {
            let length = r.magnitude(4096.0, 1e9) as i64;
            let v_out = Speed::from_bits(r.magnitude(1e6, 1e13) as i64);
            let [a, j] = [r.magnitude(1e-9, 1e-6), r.magnitude(1e-11, 1e-8)].map(|x| x as f32);
            let law = SlopeLaw::JerkLimited { shape: bend, joins: Joins::Alike, j: [j; 4] };
            let limits = Limits { v: 1.0, a_up: a, a_down: a, law, loose: Loose::NONE };
            let length = Distance::from_bits(length);
            let v_in = Speed::from_bits(1 << 58);
            let span = ReleasedSpan { limits, length, v_in, v_out, ..ReleasedSpan::BLANK };
            let mut profile = Profile::default();
            let [high, low] = [span.enter(), v_out];
            for [v_in, v_out] in [[high, low], [low, high]] {
                let planned = profile.plan(length, v_in, v_out, &limits);
                assert_eq!(
                    planned,
                    Ok(()),
                    "case {case}, {bend:?}: {length:?} from {v_in:?} to {v_out:?}, {limits:?}"
                );
                let rest = length.to_bits() - profile.up.length() - profile.down.length();
                assert!(rest >= 0, "case {case}, {bend:?}: {length:?}, {rest} left");
                least = least.min(rest);
            }
        }
    }
    assert_eq!(least, 0, "none fills its block");
}
