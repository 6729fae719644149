//! The distance from program start inside curves, against the arc length of the set points in f64.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::contour_log::{BlockType, ContourMemory, ProgramDistance};
use glidepath::machine::InterpolatorData;
use glidepath::quantity::Position;
use glidepath::tick::State;
use host_tests::cases::machines;

const EVERYTHING: ProgramDistance = ProgramDistance::from_bits(i64::MAX);

/// What a tick tells: the set points and the distance.
struct Seen {
    at: [f64; 3],
    told: f64,
    /// Whether the curve is a polynomial.
    is_curved: bool,
}

fn drive(text: &str) -> Vec<Seen> {
    let mut machine = machines::with_slope(machines::even(1000), 1);
    machine.channel.ptp = true;
    machine.channel.interpolator = InterpolatorData { log_max: u32::MAX, ..InterpolatorData::ALL };
    let mut memory = Box::new(ContourMemory::<256, 1>::new());
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let (recorder, contour) = memory.split();
    let handles = channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    planner.log_contour(recorder);
    let mut seen = Vec::new();
    loop {
        let done = loop {
            match planner.poll().expect(text) {
                Progress::Waiting => break false,
                Progress::Done => break true,
                _ => {}
            }
        };
        let state = interpolator.tick();
        let status = operator.status();
        let told = contour.distance(status.distance).expect("kept");
        let here = contour.elements(told, EVERYTHING).next().and_then(Result::ok);
        seen.push(Seen {
            at: status.set_points.map(|point| point.to_num::<f64>()),
            told: told.to_mm(),
            is_curved: here.is_some_and(|entry| entry.block_type == BlockType::Polynomial),
        });
        if done && state == State::Idle {
            return seen;
        }
    }
}

/// The length of the path between neighbouring set points: each chord, with the arc over it. The turn from a chord to
/// the next one gives the curvature.
fn arcs(seen: &[Seen]) -> Vec<f64> {
    let chords: Vec<[f64; 3]> =
        seen.windows(2).map(|pair| std::array::from_fn(|k| pair[1].at[k] - pair[0].at[k])).collect();
    let length = |x: &[f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let turn = |a: &[f64; 3], b: &[f64; 3]| {
        let both = length(a) * length(b);
        if both == 0.0 {
            return 0.0;
        }
        let apart: [f64; 3] = std::array::from_fn(|k| a[k] / length(a) - b[k] / length(b));
        length(&apart)
    };
    let arc = |k: usize| {
        let before = if k > 0 { turn(&chords[k - 1], &chords[k]) } else { 0.0 };
        let after = chords.get(k + 1).map_or(0.0, |next| turn(&chords[k], next));
        length(&chords[k]) * (1.0 + before * after / 24.0)
    };
    (0..chords.len()).map(arc).collect()
}

/// C40-016, C40-022, C40-074: inside a polynomial the distance is the length that the axes have driven, to 20 nm, which
/// is the error of the reference. It never decreases.
#[test]
fn the_distance_inside_of_polynomials_is_the_arc_length() {
    let mut all = Vec::new();
    for smoothing in [
        "#CONTOUR MODE [DEV PATH_DEV=0.5]\nG261",
        "#CONTOUR MODE [DIST PRE_DIST=1 POST_DIST=1]\nG261",
        "#CONTOUR MODE [DIST_SOFT PATH_DIST=1]\nG261",
        "#CONTOUR MODE [PTP PATH_DEV=0.5]\nG261",
        "#HSC ON [BSPLINE PATH_DEV=0.3]",
        "#SPLINE ON",
    ] {
        let text = format!(
            "G01 F300\n{smoothing}\nN10 X3\nN20 Y3\nN30 X0 Y4\nN35 X4 Y4.2\nN40 X-3 Y4.3 Z1\nN50 Y7\nG260\n#HSC OFF\n\
            #SPLINE OFF\n"
        );
        let seen = drive(&text);
        let (mut driven, mut worst, mut curved, mut back) = (0.0, 0.0f64, 0, 0.0f64);
        for (pair, arc) in seen.windows(2).zip(arcs(&seen)) {
            driven += arc;
            back = back.max(pair[0].told - pair[1].told);
            worst = worst.max((pair[1].told - driven).abs());
            curved += u32::from(pair[1].is_curved);
        }
        all.push((smoothing, curved, worst, back));
    }
    for (smoothing, curved, worst, back) in &all {
        assert!(*curved > 100 && *back <= 0.0, "{smoothing}: {all:?}");
        assert!(*worst < 2e-5, "{smoothing}: {all:?}");
    }
    println!("{all:#?}");
}
