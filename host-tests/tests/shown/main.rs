//! Speed and distance that the operator reads at each tick, compared with the differences of the set points.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::contour_log::{ContourMemory, ProgramDistance};
use glidepath::machine::{ChannelData, InterpolatorData, MachineData};
use glidepath::path::Measure;
use glidepath::quantity::Position;
use glidepath::tick::State;
use hil_cases::{AXES_3, AXES_4, AXES_6, CASES_3, CASES_4, CASES_6, Case};
use host_tests::cases::{machines, set_point};
use host_tests::seeds::seeds;
use host_tests::{soak, splines};

/// Ticks of a run, at most: what a slow program shows later is no other than what it shows at first.
const LONGEST: usize = 40_000;

/// A thousandth of the distance, and 2 µm for what the first ticks drive.
const PART: f64 = 1e-3;
const LEAST_MM: f64 = 2e-3;

/// Where a run stands.
#[derive(Clone, Copy, Debug, Default)]
struct Shown {
    /// Distance driven: the sum of the chords between set points, mm.
    driven: f64,
    /// Largest difference of the distance shown, mm, and the tick in which it was.
    off: f64,
    tick: usize,
    /// Largest difference between the shown speed and that of the set points, mm per tick.
    speed_off: f64,
    /// Difference between the distance of the contour log and the shown one at the end of the program, mm.
    log_off: f64,
    /// Path distance as planned at the end, mm.
    planned: f64,
    /// Largest difference beyond [`LEAST_MM`], as a part of the distance.
    part: f64,
}

/// Runs a program to its end with an override, and with a feed hold where one is asked for; compares at each tick.
fn shown<const AXES: usize>(
    text: &[u8],
    (machine, start): (&MachineData<AXES>, [Position; AXES]),
    hold: Option<(usize, usize)>,
    feed: u16,
) -> Result<Shown, String> {
    let mut channel: Box<Channel<AXES, 120>> = Box::new(Channel::new());
    let mut memory = Box::new(ContourMemory::<1024, 0>::new());
    let (recorder, contour) = memory.split();
    let interpolator = InterpolatorData { log_max: u32::MAX, ..InterpolatorData::ALL };
    let machine = &MachineData { channel: ChannelData { interpolator, ..machine.channel }, ..*machine };
    let measure = Measure::of(machine);
    let handles = channel.split(machine, start, text).map_err(|error| error.to_string())?;
    let Handles { mut planner, mut interpolator, operator } = handles;
    planner.log_contour(recorder);
    operator.set_override(feed);
    let (mut seen, mut last, mut before) = (Shown::default(), start, [0; AXES]);
    // A chord is shorter than its curve, by no more than two chords are longer than the one over both.
    let mut turned = 0.0;
    for tick in 0..LONGEST {
        match hold {
            Some((at, _)) if at == tick => operator.feed_hold(),
            Some((_, until)) if until == tick => operator.resume(),
            _ => {}
        }
        let done = loop {
            match planner.poll() {
                Ok(Progress::Waiting) => break false,
                Ok(Progress::Done) => break true,
                Ok(_) => {}
                Err(error) => return Err(error.to_string()),
            }
        };
        let state = interpolator.tick();
        while let Some(output) = operator.output() {
            let _ = operator.acknowledge(output.function);
        }
        let status = operator.status();
        let travel: [i64; AXES] =
            std::array::from_fn(|k| status.set_points[k].to_bits().wrapping_sub(last[k].to_bits()));
        last = status.set_points;
        let chord = measure.path(&travel).0.to_num::<f64>();
        seen.driven += chord;
        let both = std::array::from_fn::<i64, AXES, _>(|k| travel[k] + before[k]);
        let [earlier, over] = [before, both].map(|travel| measure.path(&travel).0.to_num::<f64>());
        turned += (chord + earlier - over).max(0.0);
        before = travel;
        let off = status.distance.0.to_num::<f64>() - seen.driven;
        let off = if off > 0.0 { (off - turned).max(0.0) } else { -off };
        if off > seen.off {
            (seen.off, seen.tick) = (off, tick);
        }
        seen.part = seen.part.max((off - LEAST_MM) / seen.driven.max(LEAST_MM));
        if off > PART * seen.driven + LEAST_MM {
            return Err(format!("tick {tick}: shown {}, driven {}", status.distance.0, seen.driven));
        }
        assert_eq!(status.distance, interpolator.driven_distance(), "tick {tick}");
        seen.speed_off = seen.speed_off.max((status.speed.0.to_num::<f64>() - chord).abs());
        seen.planned = status.planned.0.to_num::<f64>();
        if done && state == State::Idle {
            let told = contour.distance(status.distance).map_or(f64::NAN, ProgramDistance::to_mm);
            seen.log_off = (told - status.distance.0.to_num::<f64>()).abs();
            break;
        }
    }
    Ok(seen)
}

/// Limits of what a run may show.
fn judge(name: &str, seen: Result<Shown, String>) -> Shown {
    let seen = seen.unwrap_or_else(|fault| panic!("{name}: {fault}"));
    // A speed is rounded to 2^-44 mm per tick, and the length of a difference too.
    assert!(seen.speed_off < 1e-9, "{name}: {seen:?}");
    assert!(seen.log_off.is_nan() || seen.log_off <= PART * seen.driven + LEAST_MM, "{name}: {seen:?}");
    seen
}

fn named<const AXES: usize>(cases: &[Case], machine: &MachineData<AXES>) {
    for case in cases {
        judge(case.name, shown(case.text, (machine, [Position::ZERO; AXES]), None, 1000));
    }
}

/// Each program that the target runs, too.
#[test]
fn distance_and_speed_are_driven_in_the_programs_of_the_target() {
    named(CASES_3, &AXES_3);
    named(CASES_4, &AXES_4);
    named(CASES_6, &AXES_6);
}

const FIRST: &str = include_str!("../../../programs/first.nc");

/// An open U of three lines of 50 mm.
const U: &str = "G01 F6000\nX50\nY50\nX0\nM30\n";

/// A corner with sides of 100 mm and a curve of 5 mm, with each method that has a curve over time.
const CORNER: &str = "G01 X100 F10000\nY100\nM30\n";

/// Programs by name: the open U, the corner of the examples of DEV and of PTP, and the first program of the documents.
#[test]
fn distance_is_driven_in_corners_by_time() {
    let modes = [
        "#CONTOUR MODE [DEV PATH_DEV=0.1]\nG261\n",
        "#CONTOUR MODE [DEV PATH_DEV=5]\nG261\n",
        "#CONTOUR MODE [PTP PATH_DEV=5]\nG261\n",
        "#CONTOUR MODE [DIST_SOFT PATH_DIST=5]\nG261\n",
        "#CONTOUR MODE [DIST_SOFT PATH_DIST=20]\nG261\n",
        "#HSC ON [OPMODE=1 CONTERROR=0.1]\n",
    ];
    for machine in [machines::even(1000), machines::examples(1000)] {
        for slope in 0..4 {
            let mut machine = machine;
            (machine.channel.ptp, machine.channel.surface) = (true, true);
            machine.channel.slope_profile = slope;
            let start = [Position::ZERO; 3];
            let name = format!("first.nc with slope {slope}");
            judge(&name, shown(FIRST.as_bytes(), (&machine, start), None, 1000));
            for (mode, shape) in modes.iter().flat_map(|mode| [(mode, U), (mode, CORNER)]) {
                let text = format!("{mode}{shape}");
                let name = format!("slope {slope}: {text}");
                let seen = judge(&name, shown(text.as_bytes(), (&machine, start), None, 1000));
                judge(&name, shown(text.as_bytes(), (&machine, start), Some((150, 700)), 1000));
                assert!(seen.driven < 200.1, "{name}: {seen:?}");
            }
        }
    }
}

/// The plan counts a curve over time as time: the shown distance is the shorter one.
#[test]
fn the_planned_distance_is_another_one() {
    let text = format!("#CONTOUR MODE [DEV PATH_DEV=0.1]\nG261\n{U}");
    let machine = machines::even::<3>(1000);
    let seen = judge("U", shown(text.as_bytes(), (&machine, [Position::ZERO; 3]), None, 1000));
    assert!((seen.driven - 149.8).abs() < 0.1 && seen.planned > 155.0, "{seen:?}");
}

/// An override, 5 %: chords between ticks tell nothing of a path with several corners between two set points.
const SLOW: u16 = 50;

/// Random programs with every smoothing, slowly.
#[test]
fn distance_and_speed_are_driven_in_random_programs() {
    let (mut worst, mut above, mut count) = (0.0_f64, 0, 0);
    for seed in seeds(0..150, 10) {
        for splined in [false, true] {
            let setup =
                if splined { splines::splined::<3>(seed, false) } else { soak::setup::<3>(seed, false) };
            let mut machine = setup.machine;
            // A path along other axes is no sum of chords where a tick leads from one block to the next.
            if machine.axes.iter().any(|axis| axis.default_feed_axis) {
                continue;
            }
            machine.channel.look_ahead = machine.channel.look_ahead.min(120);
            let start = std::array::from_fn(|k| Position::from_bits(set_point(setup.program.start[k])));
            let hold = (seed % 3 == 0).then_some((200, 900));
            let seen = judge(
                &format!("seed {seed}, splined {splined}"),
                shown(setup.text().as_bytes(), (&machine, start), hold, SLOW),
            );
            worst = worst.max(seen.part);
            above += usize::from(seen.part > PART);
            count += 1;
        }
    }
    println!("{count} programs, {above} above 0.1 %, the worst {:.3} %", 100.0 * worst);
}
