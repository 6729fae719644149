//! The rest of a span after a change: its new speed profile is below the planned one, at each place and each
//! start speed, compared with closed forms in `f64`.
use glidepath::lookahead::{Gain, ReleasedSpan};
use glidepath::quantity::{Speed, speed_bits};
use glidepath::slope::limits::{Joins, Limits, Loose, SlopeLaw};
use glidepath::slope::ramp_shape::RampShape;
use host_tests::cases::random::Random;
use host_tests::reference::profile::{Profile, Ramps, reach};
use host_tests::seeds::seeds;

/// Limits and their ramps, which may all differ, up to and down from the highest speed.
struct Span {
    released: ReleasedSpan,
    ramps: [Ramps; 2],
    v: f64,
}

impl Span {
    fn random(random: &mut Random) -> Self {
        let v = random.magnitude(1e-3, 1.0);
        let a: [f64; 2] = std::array::from_fn(|_| v * random.magnitude(1e-3, 1e-1));
        let ramps = a.map(|a| {
            let [up, down] = std::array::from_fn(|_| random.magnitude(2.0, 400.0));
            Ramps { a, up, down }
        });
        let [gain, loss] = ramps;
        let j =
            [gain.a / gain.up, gain.a / gain.down, loss.a / loss.up, loss.a / loss.down].map(|j| j as f32);
        let law = SlopeLaw::JerkLimited { shape: RampShape::Linear, joins: Joins::Valleys, j };
        let [a_up, a_down] = a.map(|a| a as f32);
        let limits = Limits { v: v as f32, a_up, a_down, law, loose: Loose::NONE };
        let released = ReleasedSpan { blocks: 2, limits, ..ReleasedSpan::BLANK };
        Self { released, ramps, v }
    }
}

/// Of f32: a few roundings of peaks and of lengths.
const CLOSE: f64 = 1e-5;

/// The time at which a law is at a place.
fn passes(law: &Profile, s: f64) -> f64 {
    let (mut low, mut high) = (0.0, law.time());
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if law.at(middle).s < s { low = middle } else { high = middle }
    }
    low
}

fn speed(v: f64) -> Speed {
    Speed::from_bits(speed_bits(v as f32))
}

const MM: f64 = (1u64 << 44) as f64;

#[test]
fn what_goes_on_is_below_what_was_planned() {
    let mut counts = [0; 3];
    for seed in seeds(0..8_000, 1_000) {
        let mut random = Random::new(seed);
        let mut span = Span::random(&mut random);
        let [v_in, v_out] = std::array::from_fn(|_| span.v * random.magnitude(1e-3, 1.0));
        let length = span.v * span.v / span.ramps[0].a * random.magnitude(0.1, 10.0);
        let [gain, loss] = span.ramps;
        let Some(planned) = Profile::fastest(length, v_in, v_out, span.v, gain, loss) else { continue };
        span.released.v_out = speed(v_out);
        let at = length * (0.001 + 0.998 * random.unit());
        let begins = passes(&planned, at);
        let there = planned.at(begins);
        let go_on =
            |v: f64| span.released.go_on((length * MM) as i64, speed(v_in), (at * MM) as i64, speed(v));
        // Faster than planned where that is not as fast as it gets.
        if there.v < 0.98 * planned.v_peak && there.v > 1.02 * v_in.max(v_out) {
            assert!(go_on(1.01 * there.v).is_none(), "seed {seed}");
        }
        let v = if random.once_in(3) { 0.0 } else { there.v * random.unit() };
        let most = go_on(v).unwrap_or_else(|| panic!("seed {seed}: none"));
        let gently = match most.gain {
            // Whatever it is.
            Gain::Free => Ramps { a: 4.0 * gain.a, ..gain },
            Gain::Alike => gain,
            Gain::Gentle => Ramps { up: 2.0 * gain.up, ..gain },
        };
        let left = length - at;
        let most_v = f64::from(most.v);
        let v_out = v_out.min(reach(left, v, most_v.max(v), gently));
        // Too short to come down from there: another rule's matter.
        let Some(law) = Profile::fastest(left, v, v_out, most_v, gently, loss) else { continue };
        let number = if begins < planned.rise.time() { usize::from(v >= v_in) } else { 2 };
        counts[number] += 1;
        for k in 0..=200 {
            let now = law.at(law.time() * f64::from(k) / 200.0);
            let then = planned.at(passes(&planned, at + now.s));
            assert!(
                now.v <= then.v * (1.0 + CLOSE) + CLOSE * planned.v_peak,
                "seed {seed}: {} above {} at {} of {length}",
                now.v,
                then.v,
                at + now.s
            );
        }
    }
    // Each of the cases was there.
    assert!(counts.iter().all(|count| *count > 500), "{counts:?}");
}
