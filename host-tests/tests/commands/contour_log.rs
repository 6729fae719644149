//! The contour log as a PLC reads it: by index, by distance, from another thread.
use glidepath::channel::{Channel, Handles, Planner, Progress};
use glidepath::contour_log::{
    BlockType, ContourMemory, ContourReader, ControlUnit, Entry, Forgotten, HliContourLookaheadBlock,
    HliContourLookaheadRequest, ProgramDistance,
};
use glidepath::fir::Unfiltered;
use glidepath::machine::{InterpolatorData, MachineData};
use glidepath::operator::Operator;
use glidepath::path::Measure;
use glidepath::quantity::Position;
use glidepath::tick::{Interpolator, State};
use host_tests::calls::call;
use host_tests::cases::machines;
use host_tests::seeds::seeds;
use host_tests::{requests, soak, splines};
use std::f64::consts::{PI, TAU};

/// Ticks of a run, at most: what a slow program shows later is no other than what it shows at first.
const LONGEST: usize = 20_000;

const EVERYTHING: ProgramDistance = ProgramDistance::from_bits(i64::MAX);

fn mm(mm: f64) -> ProgramDistance {
    ProgramDistance::from_mm(mm)
}

/// The machine with FCT_CONTOUR_LAH and storage.
fn logging(machine: &MachineData<3>) -> MachineData<3> {
    let mut machine = *machine;
    machine.channel.interpolator = InterpolatorData { log_max: u32::MAX, ..InterpolatorData::ALL };
    machine
}

/// What a run is at a tick.
struct Now<'a, 'b> {
    contour: ContourReader<'b>,
    operator: &'a Operator<'b, 3>,
    interpolator: &'a Interpolator<'b, 3>,
    tick: usize,
}

/// Runs a program in `memory`; `each` behind every tick. The error, if it is refused.
fn run<const WINDOW: usize, const LOG: usize>(
    text: &str,
    (machine, start): (&MachineData<3>, [Position; 3]),
    mut each: impl FnMut(&Now<'_, '_>),
) -> Option<String> {
    let mut memory = Box::new(ContourMemory::<WINDOW, LOG>::new());
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let (recorder, contour) = memory.split();
    let machine = &logging(machine);
    let handles = channel.split(machine, start, text.as_bytes()).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    planner.log_contour(recorder);
    let mut refused = None;
    for tick in 0..LONGEST {
        let done = loop {
            match planner.poll() {
                Ok(Progress::Waiting) => break false,
                Ok(Progress::Done) => break true,
                Ok(_) => {}
                Err(error) => refused = Some(error.to_string()),
            }
        };
        let state = interpolator.tick();
        while let Some(output) = operator.output() {
            if output.waits && tick % 7 == 0 {
                let _ = operator.acknowledge(output.function);
            }
        }
        if let Some(function) = operator.awaited().filter(|_| tick % 50 == 0) {
            let _ = operator.acknowledge(function);
        }
        each(&Now { contour, operator: &operator, interpolator: &interpolator, tick });
        if done && state == State::Idle {
            return refused;
        }
    }
    refused
}

/// The same on a plain machine, from zero. All entries of the log at its end, and all elements of the window.
fn logged(text: &str) -> (Vec<Entry>, Vec<Entry>) {
    let (mut log, mut elements) = (Vec::new(), Vec::new());
    let refused = run::<128, 128>(text, (&machines::even(1000), [Position::ZERO; 3]), |now| {
        log = (0..).map_while(|i| now.contour.logged(i)).collect();
        elements =
            now.contour.elements(ProgramDistance::ZERO, EVERYTHING).map(|e| e.expect("kept")).collect();
    });
    assert_eq!(refused, None);
    (log, elements)
}

/// Kind, N, start, length, angle and knee.
fn is(entry: &Entry, (kind, n): (BlockType, u32), [start, length, angle, knee]: [f64; 4]) {
    let said = format!("{entry:?}, N{n}");
    assert_eq!((entry.block_type, entry.n), (kind, n), "{said}");
    for (got, want, near) in [
        (entry.start.to_mm(), start, 1e-6),
        (entry.length.to_mm(), length, 1e-6),
        (entry.angle, angle, 1e-8),
        (entry.knee, knee, 1e-8),
    ] {
        assert!((got - want).abs() <= near, "{got} in place of {want}: {said}");
    }
}

/// C40-051, C40-009, C40-011, C40-015, C40-017, C40-031 to C40-035, C40-040, C40-043, C40-044: C40-EX01.
///
/// Rows: C40-002, C40-007, C40-032, C40-034, C40-042.
#[test]
fn mode_1_has_the_marked_elements_of_c40_ex01() {
    let text = "N090 G01 X0 Y0 F1000\nN100 #DISTANCE PROG START CLEAR\nN110 X200\nN200 #CONTOUR LOOKAHEAD LOG ON\n\
        N210   Y100\nN300   X0\nN400   Y0\nN500 #CONTOUR LOOKAHEAD LOG OFF\nN510 M30\n";
    let (log, elements) = logged(text);
    let corner = PI / 2.0;
    is(&log[0], (BlockType::LogOn, 200), [200.0, 0.0, 0.0, 0.0]);
    is(&log[1], (BlockType::Line, 210), [200.0, 100.0, 0.0, corner]);
    is(&log[2], (BlockType::Line, 300), [300.0, 200.0, 0.0, corner]);
    is(&log[3], (BlockType::Line, 400), [500.0, 100.0, 0.0, corner]);
    is(&log[4], (BlockType::LogOff, 500), [600.0, 0.0, 0.0, 0.0]);
    assert_eq!(log.len(), 5);
    is(&elements[0], (BlockType::Line, 110), [0.0, 200.0, 0.0, 0.0]);
    assert_eq!(elements.len(), 4);
}

/// C40-036, C40-038, C40-046: arcs by hand, both directions, a full circle and a helix; PARAM.
///
/// Rows: C40-011.
#[test]
fn arcs_have_radius_and_signed_angle() {
    let text = "N10 G01 X10 F3000\n#CONTOUR LOOKAHEAD LOG ON [PARAM=1]\nN20 G03 X20 Y10 I0 J10\nN30 G02 X30 Y20 I10 J0\n\
        #CONTOUR LOOKAHEAD LOG [PARAM=-2.5]\nN40 G02 X30 Y20 I5 J0\nN50 G03 X30 Y20 Z7 I0 J-4\n\
        #CONTOUR LOOKAHEAD LOG OFF [PARAM=8]\nN60 G01 X0 Y0 Z0\n";
    let (log, _) = logged(text);
    let quarter = 5.0 * PI;
    let helix = ((4.0 * TAU).powi(2) + 49.0).sqrt();
    is(&log[0], (BlockType::LogOn, 0), [10.0, 0.0, 0.0, 0.0]);
    is(&log[1], (BlockType::Arc, 20), [10.0, quarter, PI / 2.0, 0.0]);
    is(&log[2], (BlockType::Arc, 30), [10.0 + quarter, quarter, -PI / 2.0, 0.0]);
    is(&log[3], (BlockType::LogParam, 0), [10.0 + 2.0 * quarter, 0.0, 0.0, 0.0]);
    is(&log[4], (BlockType::Arc, 40), [10.0 + 2.0 * quarter, 10.0 * PI, -TAU, PI / 2.0]);
    // From upward to the right, and up along the helix.
    assert!((log[5].knee - (0.0f64).acos()).abs() < 1e-8, "{:?}", log[5]);
    assert_eq!((log[0].parameter, log[3].parameter, log[6].parameter), (1.0, -2.5, 8.0));
    assert!((log[5].length.to_mm() - helix).abs() < 1e-6, "{:?}", log[5]);
    assert!((log[5].angle - TAU).abs() < 1e-8, "{:?}", log[5]);
    for (i, radius) in [(1, 10.0), (2, 10.0), (4, 5.0), (5, 4.0)] {
        assert!((log[i].radius_mm - radius).abs() < 1e-6, "{:?}", log[i]);
    }
    assert_eq!((log[6].block_type, log.len()), (BlockType::LogOff, 7));
}

/// C40-045, C40-047: one area until CLEAR, which waits for the standstill; the log stays behind the motion (C40-012).
///
/// Rows: C40-010.
#[test]
fn one_area_until_clear() {
    const ON: &str = "#CONTOUR LOOKAHEAD LOG ON\n";
    const OFF: &str = "#CONTOUR LOOKAHEAD LOG OFF\n";
    let text = format!("G01 F6000\n{ON}N10 X10\n{OFF}N20 Y10\n{ON}N30 X20\n{OFF}N40 Y20\n");
    let (log, _) = logged(&text);
    assert_eq!(log.iter().map(|entry| entry.n).collect::<Vec<_>>(), [0, 10, 0]);
    let text = format!(
        "G01 F6000\n{ON}N10 X10\n{OFF}N20 Y10\n#CONTOUR LOOKAHEAD LOG CLEAR\n{ON}N30 X20\n{OFF}N40 Y20\n"
    );
    let (log, _) = logged(&text);
    assert_eq!(log.iter().map(|entry| entry.n).collect::<Vec<_>>(), [0, 30, 0]);
    let mut seen = Vec::new();
    run::<64, 64>(&text, (&machines::even(1000), [Position::ZERO; 3]), |now| {
        let n = now.contour.logged(1).map(|entry| entry.n);
        let y = now.interpolator.set_points()[1].to_num::<f64>();
        if seen.last().is_none_or(|(last, _)| *last != n) {
            seen.push((n, y));
        }
    });
    assert_eq!(seen.len(), 2, "{seen:?}");
    assert_eq!((seen[0].0, seen[1].0), (Some(10), Some(30)), "{seen:?}");
    assert!((seen[1].1 - 10.0).abs() < 1e-9, "CLEAR comes at the standstill: {seen:?}");
}

/// C40-014, C40-015, C40-074: the distance driven, with CLEAR where the motion comes there.
///
/// Rows: C40-022, G-10.
#[test]
fn the_distance_counts_from_the_clear_that_the_motion_has_passed() {
    let text = "N10 G01 X10 F6000\nN20 Y10\nN30 #DISTANCE PROG START CLEAR\nN40 X20\nN50 Y0\n";
    let mut last = [0.0; 3];
    run::<64, 64>(text, (&machines::even(1000), [Position::ZERO; 3]), |now| {
        let status = now.operator.status();
        let got = now.contour.distance(status.distance).expect("kept").to_mm();
        let [x, y, _] = status.set_points.map(|point| point.to_num::<f64>());
        let path = if x < 10.0 || (last[0] < 10.0 && y == 0.0) {
            x
        } else if x < 10.0 + 1e-9 {
            10.0 + y
        } else if x < 20.0 {
            x - 10.0
        } else {
            10.0 + (10.0 - y)
        };
        let at_clear = (x - 10.0).abs() < 1e-9 && (y - 10.0).abs() < 1e-9;
        assert!(
            (got - path).abs() < 1e-6 || at_clear,
            "tick {}: {got} at {x} {y}, expected {path}",
            now.tick
        );
        last = [x, y, 0.0];
    });
    assert_eq!(last[..2], [20.0, 0.0]);
}

/// C40-021: hold, override, dwell and functions that wait do not change the reach; it does not fall.
#[test]
fn reach_is_independent_of_the_motion() {
    let text = "N10 G01 X10 F6000\nN20 Y10\nG04 0.1\nM25\nN30 X20\nN40 Y0\n";
    let mut machine = machines::even(1000);
    machine.channel.m_synch =
        glidepath::machine::SynchTable::NONE.with(25, glidepath::machine::Synch::MvsSns);
    let mut last = ProgramDistance::ZERO;
    run::<64, 64>(text, (&machine, [Position::ZERO; 3]), |now| {
        match now.tick {
            20 => now.operator.feed_hold(),
            200 => now.operator.resume(),
            210 => now.operator.set_override(300),
            _ => {}
        }
        let reach = now.contour.reach();
        assert!(reach >= last);
        last = reach;
        // All of a short program is read before the first tick, up to the function.
        assert!(now.tick < 5 || reach == mm(40.0), "{} {}", now.tick, reach.to_mm());
    });
}

/// C40-005: a polynomial has the length of what the axes drive.
#[test]
fn a_polynomial_has_its_driven_length() {
    let text = "G01 F600\n#CONTOUR MODE [DEV PATH_DEV=1]\nG261\nN10 X50\nN20 Y50\nN30 X0\nG260\n";
    let mut machine = machines::even(1000);
    machine.channel.slope_profile = 1;
    let (mut elements, mut driven) = (Vec::new(), 0.0);
    let mut last = [0.0; 3];
    run::<64, 64>(text, (&machine, [Position::ZERO; 3]), |now| {
        if now.tick == 100 {
            elements =
                now.contour.elements(ProgramDistance::ZERO, EVERYTHING).map(|e| e.expect("kept")).collect();
        }
        let at = now.interpolator.set_points().map(|point| point.to_num::<f64>());
        driven += at.iter().zip(&last).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        last = at;
    });
    let total: f64 = elements.iter().map(|entry| entry.length.to_mm()).sum();
    assert!(elements.iter().any(|entry| entry.block_type == BlockType::Polynomial), "{elements:?}");
    // A chord of 10 µm on a radius of 5 mm is 1.7 pm shorter than its arc.
    assert!((total - driven).abs() < 1e-5, "{total} {driven}");
    assert!(total < 149.0, "{total}");
}

/// Mode 2 (C40-016 to C40-020, C40-022): random programs with every smoothing. Each tick a request must be covered
/// without gap or overlap, and the distance must agree with the set points to 1 nm on lines.
fn covered(text: &str, machine: &MachineData<3>, start: [Position; 3]) {
    let mut last: Option<(f64, [Position; 3])> = None;
    let measure = Measure::of(machine);
    let mut reach = ProgramDistance::ZERO;
    run::<512, 8>(text, (machine, start), |now| {
        // Two ticks of eight, one behind the other: a request each tick takes minutes in all.
        if now.tick % 8 > 1 {
            last = None;
            return;
        }
        let status = now.operator.status();
        let at = now.contour.distance(status.distance).expect("kept");
        assert!(now.contour.reach() >= reach, "tick {}", now.tick);
        reach = now.contour.reach();
        assert!(at <= reach);
        let ahead: Vec<Entry> = now.contour.elements(at, EVERYTHING).map(|e| e.expect("kept")).collect();
        if at < reach {
            assert!(ahead[0].start <= at && at < ahead[0].end(), "{at:?} {:?}", ahead[0]);
            assert_eq!(ahead.last().expect("some").end(), reach);
        }
        for pair in ahead.windows(2) {
            assert_eq!(pair[0].end(), pair[1].start, "{pair:?}");
        }
        let points = status.set_points;
        if let (Some((before, from)), Some(first)) = (last, ahead.first())
            && first.block_type == BlockType::Line
            && first.start.to_mm() <= before
        {
            let travel = std::array::from_fn::<i64, 3, _>(|k| (points[k] - from[k]).to_bits());
            let chord = measure.path(&travel).0.to_num::<f64>();
            let step = at.to_mm() - before;
            assert!((step - chord).abs() < 1e-6, "tick {}: {step} {chord} {first:?}", now.tick);
        }
        last = Some((at.to_mm(), points));
    });
}

/// Rows: C40-001, C40-016, C40-017, C40-019, C40-020.
#[test]
fn answers_of_mode_2_cover_random_programs_with_every_smoothing() {
    for seed in seeds(0..100, 5) {
        for splined in [false, true] {
            let setup =
                if splined { splines::splined::<3>(seed, false) } else { soak::setup::<3>(seed, false) };
            let mut machine = setup.machine;
            machine.channel.look_ahead = machine.channel.look_ahead.min(120);
            let start = std::array::from_fn(|k| {
                Position::from_bits(host_tests::cases::set_point(setup.program.start[k]))
            });
            covered(&setup.text(), &machine, start);
        }
    }
}

/// Too little memory: what is forgotten is told, and the log counts what had no room.
///
/// Rows: C40-029.
#[test]
fn too_little_memory_is_told() {
    let lines: String = (1..=40).map(|i| format!("N{i} X{} Y{}\n", i / 2, (i + 1) / 2)).collect();
    let text = format!("G01 F600\n#CONTOUR LOOKAHEAD LOG ON\n{lines}#CONTOUR LOOKAHEAD LOG OFF\n");
    run::<8, 16>(&text, (&machines::even(1000), [Position::ZERO; 3]), |now| {
        if now.tick < 50 {
            return;
        }
        let answer: Vec<_> = now.contour.elements(ProgramDistance::ZERO, EVERYTHING).collect();
        assert_eq!(answer[0], Err(Forgotten { first: mm(32.0) }));
        let kept: Vec<u32> = answer[1..].iter().map(|entry| entry.expect("kept").n).collect();
        assert_eq!(kept, (33..=40).collect::<Vec<_>>());
        let state = now.contour.log_state();
        assert_eq!((state.entries, state.without_room, state.active, state.closed), (16, 26, false, true));
        assert_eq!(now.contour.logged(15).map(|entry| entry.n), Some(15));
        assert_eq!(now.contour.logged(16), None);
    });
}

/// C40-023 to C40-031, C40-041: the handshake of the control unit, both modes.
///
/// Rows: C40-006, C40-024, C40-025, C40-026, C40-027, C40-028, C40-030, NC-012, CF-31, G-12.
#[test]
fn the_control_unit_answers_requests() {
    let text = "G01 F6000\n#CONTOUR LOOKAHEAD LOG ON\nN10 X10\nN20 Y10\nN30 X20\n#CONTOUR LOOKAHEAD LOG OFF\nN40 Y0\n";
    let unit = ControlUnit::<4>::new();
    run::<64, 64>(text, (&machines::even(1000), [Position::ZERO; 3]), |now| {
        if now.tick < 5 {
            return;
        }
        let ask = |start: f64, length: f64| {
            assert!(!unit.is_pending() && !unit.serve(&now.contour));
            unit.request(start, length).expect("free");
            assert!(unit.is_pending() && unit.request(0.0, 0.0).is_err() && unit.response(0).is_none());
            assert!(unit.serve(&now.contour));
            unit.blocks().map(|entry| entry.n).collect::<Vec<_>>()
        };
        assert_eq!(ask(1.0, 0.0), [10, 20, 30, 0]);
        assert_eq!(ask(3.0, 0.0), [30, 0]);
        assert_eq!(ask(5.0, 0.0), Vec::<u32>::new());
        assert_eq!(ask(50_000.0, 100_000.0), [10, 20]);
        assert_eq!(ask(100_000.0, 0.1), [20]);
        assert_eq!(ask(0.0, 1e9), [10, 20, 30, 40]);
        assert_eq!(ask(f64::NAN, f64::NAN), [0, 10, 20, 30]);
        let state = ControlUnit::<4>::state(&now.contour);
        assert_eq!(
            (state.max_dist_prog_start, state.count_logged_blocks, state.f_log_is_active),
            (400_000.0, 5, false)
        );
    });
}

/// C40-005, C40-012, NC-012, G-12: the structures of the HLI, with every member of an element; asked twice, and again when
/// the motion has passed.
///
/// Rows: C40-022, C40-074.
#[test]
fn the_structures_of_the_hli() {
    let text = "G01 F6000\n#CONTOUR LOOKAHEAD LOG ON [PARAM=2.5]\nN10 X10\nN20 G03 X12 Y2 J2\n\
        #CONTOUR LOOKAHEAD LOG OFF\nN30 G01 Y9\n";
    let unit = ControlUnit::<5>::new();
    let (mut seen, mut last) = (0, 0.0);
    run::<64, 64>(text, (&machines::even(1000), [Position::ZERO; 3]), |now| {
        let driven = now.operator.status().distance;
        let at = ControlUnit::<5>::dist_prog_start(&now.contour, driven).expect("kept");
        assert!(
            at >= last && (at / 10_000.0 - now.contour.distance(driven).expect("kept").to_mm()).abs() < 1e-9
        );
        last = at;
        if now.tick < 5 {
            return;
        }
        let mut ask = |start_position: f64, length: f64| {
            unit.ask(HliContourLookaheadRequest { start_position, length }).expect("free");
            assert!(unit.answer().is_none());
            unit.serve(&now.contour);
            seen += 1;
            unit.answer().expect("answered").block
        };
        let block = ask(0.0, 0.0);
        assert_eq!(block.map(|block| block.block_type), [3, 1, 2, 5, 0]);
        assert_eq!(block.map(|block| block.block_number), [0, 10, 20, 0, 0]);
        assert_eq!((block[0].length, block[4]), (2.5, HliContourLookaheadBlock::default()));
        let arc = block[2];
        assert_eq!(arc.block_count_r, block[1].block_count_r + 1);
        let (start, length) = (100_000.0, PI * 10_000.0);
        for (got, want) in [
            (arc.start_position, start),
            (arc.length, length),
            (arc.programmed_radius, 20_000.0),
            (arc.compensated_radius, 20_000.0),
            (arc.circle_angle, PI / 2.0),
            (arc.length_min, 0.0),
            (arc.tangent_variation, 0.0),
        ] {
            assert!((got - want).abs() < 1e-2, "{got} in place of {want}: {arc:?}");
        }
        assert_eq!(ask(50_000.0, 1.0).map(|block| block.block_number), [10, 0, 0, 0, 0]);
    });
    assert!(seen > 100);
    assert!((last / 10_000.0 - (17.0 + PI)).abs() < 1e-6, "{last}");
}

/// C40-032: straight blocks in a row keep their N numbers, as elements of their own.
#[test]
fn straight_blocks_in_a_row_keep_their_numbers() {
    let (_, elements) = logged("N10 G01 X1 F6000\nN20 X2\nN30 X3\nN40 X4 Y1\nN50 X5 Y2\nN60 Z1\n");
    assert_eq!(elements.iter().map(|entry| entry.n).collect::<Vec<_>>(), [10, 20, 30, 40, 50, 60]);
    assert!(elements.iter().take(3).all(|entry| entry.length == mm(1.0)), "{elements:?}");
}

/// C40-045: CLEAR with logging on and off; lines behind it wait for the standstill, as behind #FLUSH&WAIT.
#[test]
fn clear_with_logging_on_waits_for_the_standstill() {
    let text = "G01 F6000\n#CONTOUR LOOKAHEAD LOG ON\nN10 X10\n#CONTOUR LOOKAHEAD LOG CLEAR\nN20 Y10\n\
        #CONTOUR LOOKAHEAD LOG CLEAR\n#CONTOUR LOOKAHEAD LOG ON\nN30 X20\n#CONTOUR LOOKAHEAD LOG OFF\n";
    let (log, _) = logged(text);
    assert_eq!(log.iter().map(|entry| entry.n).collect::<Vec<_>>(), [0, 30, 0]);
    let mut known: Vec<(f64, f64, f64)> = Vec::new();
    run::<64, 64>(text, (&machines::even(1000), [Position::ZERO; 3]), |now| {
        let [x, y, _] = now.operator.status().set_points.map(|point| point.to_num::<f64>());
        let reach = now.contour.reach().to_mm();
        if known.last().is_none_or(|(last, ..)| *last != reach) {
            known.push((reach, x, y));
        }
    });
    // The block behind CLEAR is read when the axes stand in front of it.
    let wanted = [(10.0, 0.0, 0.0), (20.0, 10.0, 0.0), (30.0, 10.0, 10.0)];
    for (got, want) in known.iter().rev().zip(wanted.iter().rev()) {
        let near =
            (got.0 - want.0).abs() < 1e-6 && (got.1 - want.1).abs() < 0.01 && (got.2 - want.2).abs() < 0.01;
        assert!(near, "{known:?}");
    }
}

/// C40-020: the reach grows with the buffer of the interpolator, and with the blocks that are supplied.
#[test]
fn reach_depends_on_buffer_and_supply() {
    let text: String = (1..=400).map(|i| format!("N{i} G01 X{} Y{} F600\n", i / 2, i % 2)).collect();
    let reach = |look_ahead: u32, polls: usize| {
        let mut machine = logging(&machines::even(1000));
        machine.channel.look_ahead = look_ahead;
        let mut memory = Box::new(ContourMemory::<512, 8>::new());
        let mut channel: Box<Channel<3, 190>> = Box::new(Channel::new());
        let (recorder, contour) = memory.split();
        let handles = channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
        let mut planner = handles.planner;
        planner.log_contour(recorder);
        for _ in 0..polls {
            if planner.poll().expect("right") == Progress::Waiting {
                break;
            }
        }
        contour.reach().to_mm()
    };
    let [few, some, many] = [30, 120, 190].map(|blocks| reach(blocks, usize::MAX));
    assert!(few < some && some <= many, "{few} {some} {many}");
    let [early, late] = [40, 80].map(|polls| reach(190, polls));
    assert!(early < late && late < many, "{early} {late} {many}");
}

/// C40-014, C40-045: the next program begins at 0 with an empty log; an abort takes back what will not be driven.
#[test]
fn program_start_and_abort() {
    let machine = logging(&machines::even(1000));
    let mut memory = Box::new(ContourMemory::<64, 64>::new());
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let (recorder, contour) = memory.split();
    let first: &[u8] = b"G01 F600\n#CONTOUR LOOKAHEAD LOG ON\nN10 X10\nN20 Y10\n";
    let handles = channel.split(&machine, [Position::ZERO; 3], first).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    planner.log_contour(recorder);
    let mut drive = |planner: &mut Planner<'_, &[u8], 3, 120, Unfiltered>, abort: usize| {
        for tick in 0.. {
            if tick == abort {
                operator.abort();
            }
            let done = call(planner, usize::MAX, |_| {}).expect("a program");
            if interpolator.tick() == State::Idle && done {
                return operator.status();
            }
        }
        unreachable!()
    };
    let status = drive(&mut planner, 300);
    let stands = status.set_points[0].to_num::<f64>();
    assert!(stands > 1.0 && stands < 9.0, "{stands}");
    assert!((contour.reach().to_mm() - stands).abs() < 1e-6, "{} {stands}", contour.reach().to_mm());
    assert_eq!(contour.distance(status.distance), Ok(contour.reach()));
    planner.load(b"N30 G01 X30 F6000\nN40 Y3\n".as_slice()).expect("at rest");
    assert_eq!((contour.reach(), contour.log_state().entries), (ProgramDistance::ZERO, 0));
    drive(&mut planner, usize::MAX);
    let elements: Vec<Entry> =
        contour.elements(ProgramDistance::ZERO, EVERYTHING).map(|e| e.expect("kept")).collect();
    assert_eq!(elements.len(), 2);
    is(&elements[0], (BlockType::Line, 30), [0.0, 30.0 - stands, 0.0, 0.0]);
    is(&elements[1], (BlockType::Line, 40), [30.0 - stands, 3.0, 0.0, PI / 2.0]);
}

/// While a function waits before the marked area, the PLC can read all of it.
///
/// Rows: C40-010.
#[test]
fn the_log_is_there_while_a_function_waits() {
    let text = "N10 G01 X1 F6000\nN20 M25\n#CONTOUR LOOKAHEAD LOG ON\nN30 X20\nN40 Y5\n#CONTOUR LOOKAHEAD LOG OFF\nN50 X0\n";
    let mut machine = machines::even(1000);
    machine.channel.m_synch =
        glidepath::machine::SynchTable::NONE.with(25, glidepath::machine::Synch::MvsSvs);
    let mut waited = 0;
    run::<64, 64>(text, (&machine, [Position::ZERO; 3]), |now| {
        let status = now.operator.status();
        if now.operator.awaited().is_some() && status.state == State::Idle {
            let log: Vec<u32> = (0..).map_while(|i| now.contour.logged(i)).map(|entry| entry.n).collect();
            assert_eq!((log.as_slice(), now.contour.log_state().closed), ([0, 30, 40, 0].as_slice(), true));
            assert_eq!(status.set_points[0], Position::from_num(1));
            waited += 1;
        }
    });
    assert!(waited > 0);
}

/// A marked area longer than the look-ahead: the log is active until its end is read.
///
/// Rows: C40-029.
#[test]
fn a_log_is_active_until_its_end_is_read() {
    let lines: String = (1..=220).map(|i| format!("N{i} X0.0{} Y0.0{}\n", i % 2, i / 2 % 2)).collect();
    let text = format!("G01 F6000\n#CONTOUR LOOKAHEAD LOG ON\n{lines}#CONTOUR LOOKAHEAD LOG OFF\n");
    let mut seen = Vec::new();
    run::<8, 512>(&text, (&machines::even(1000), [Position::ZERO; 3]), |now| {
        let state = now.contour.log_state();
        assert_eq!(state.active, state.entries < 222, "{state:?}");
        assert_eq!(ControlUnit::<4>::state(&now.contour).f_log_is_active, state.active);
        seen.push(state.active);
    });
    seen.dedup();
    assert_eq!(seen, [true, false]);
}

/// An element takes 44 bytes of memory, in both tables.
#[test]
fn an_entry_takes_44_bytes() {
    let empty = size_of::<ContourMemory<0, 0>>();
    assert_eq!(size_of::<ContourMemory<128, 0>>() - empty, 128 * 44);
    assert_eq!(size_of::<ContourMemory<64, 32>>() - empty, 96 * 44);
}

/// The id of an element is the motion block that the status shows while the motion is on it.
///
/// Rows: C40-033.
#[test]
fn elements_have_the_block_of_the_status() {
    let text = "G01 F6000\nN10 X10\nN20 #CONTOUR LOOKAHEAD LOG ON\nN30 Y10\nG04 0.02\nN40 G02 X20 Y20 I10\nN50 G01 X30\n";
    let mut seen = Vec::new();
    run::<64, 64>(text, (&machines::even(1000), [Position::ZERO; 3]), |now| {
        let status = now.operator.status();
        let at = now.contour.distance(status.distance).expect("kept");
        let mut ahead = now.contour.elements(at, EVERYTHING).map(|entry| entry.expect("kept"));
        if let Some(element) = ahead.next().filter(|element| element.start < at) {
            assert_eq!((element.id, element.n), (status.block, status.n), "tick {}", now.tick);
            seen.push(element.id);
        }
    });
    seen.dedup();
    assert_eq!(seen, [0, 1, 2, 3]);
}

/// Requests from another thread at any moment: no torn and no stale element, the handshake kept, and set points as
/// without them. `cargo run --release -p host-tests --example plc -- requests 10000000` is the long form.
///
/// Rows: C40-001, C40-024.
#[test]
fn another_thread_reads_whole_elements() {
    let (asked, driven) = requests::run(Some(400_000));
    assert!(asked.elements > 100_000 && asked.requests[1] > 0 && asked.questions > 0, "{asked:?}");
    let (_, alone) = requests::run(None);
    assert!(driven.iter().all(|driven| *driven == alone[0]), "{driven:?} {alone:?}");
}
