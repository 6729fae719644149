//! Questions about the coming motion, and the machine data that enable them.
use glidepath::channel::{Channel, Handles, Inquiry};
use glidepath::contour_log::{ContourMemory, Moment, ProgramDistance, Question, QuestionUnit, Unknown};
use glidepath::machine::{InterpolatorData, InterpolatorFunctions as Functions, MachineData};
use glidepath::quantity::{Position, Speed};
use glidepath::tick::State;
use host_tests::calls::call;
use host_tests::cases::machines;
use host_tests::foresee::{Asks, Told, asked, run};
use host_tests::seeds::seeds;

/// State at a later tick and time to the next block at feed, against what then happens: at more than 1,000 moments of
/// each slope. Rows: C40-065, C40-066.
#[test]
fn what_is_told_about_later_ticks_happens() {
    for slope in 0..4 {
        let mut told = Told::default();
        for seed in seeds(0..40, 3) {
            run(seed, slope, Asks::States, &mut told);
        }
        let Told { state, feed, .. } = told;
        assert!(state.compared >= 1000 && feed.compared >= 1000, "slope {slope}: {told:?}");
        assert!(state.speed <= 1e-3 && state.nm <= 1e-9 && state.ticks == 0 && state.other == 0, "{state:?}");
        assert!(feed.speed <= 1e-3 && feed.nm <= 1e-9 && feed.ticks <= 1 && feed.other == 0, "{feed:?}");
        assert!(state.compared > 10 * state.unknown.iter().sum::<u32>(), "{state:?}");
    }
}

/// Where and when a hold stands, told at the moment of the hold: 1 nm and one tick, at more than 1,000 moments of each
/// slope. Rows: C40-070.
#[test]
fn a_hold_stands_where_it_was_told() {
    for slope in 0..4 {
        let mut told = Told::default();
        for seed in seeds(0..40, 3) {
            run(seed, slope, Asks::Stops, &mut told);
        }
        let stand = told.stand;
        assert!(stand.compared >= 1000, "slope {slope}: {stand:?}");
        assert!(stand.nm <= 1.0 && stand.ticks <= 1 && stand.off == 0, "slope {slope}: {stand:?}");
        assert!(stand.compared > 50 * stand.unknown.iter().sum::<u32>(), "{stand:?}");
    }
}

/// Questions without an answer say why. A unit carries questions and answers between contexts. Rapid motion is no feed
/// block. Rows: C40-065, C40-066, C40-070.
#[test]
fn a_question_without_an_answer_says_why() {
    let text: &[u8] = b"N10 G00 X50\nN20 X60 Y10\nN30 G01 X80 F3000\nN40 G04 1\nN50 X90\n";
    let all = asked(&machines::even(1000));
    for (machine, enabled) in [(machines::even(1000), false), (all, true)] {
        let mut inquiry = Box::new(Inquiry::new());
        let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
        let handles = channel.split(&machine, [Position::ZERO; 3], text).expect("machine data");
        let Handles { mut planner, mut interpolator, operator } = handles;
        planner.foresee(&mut inquiry);
        call(&mut planner, usize::MAX, |_| {}).expect("a program");
        for _ in 0..20 {
            call(&mut planner, usize::MAX, |_| {}).expect("a program");
            interpolator.tick();
        }
        call(&mut planner, usize::MAX, |_| {}).expect("a program");
        let unit = QuestionUnit::<3>::new();
        let mut ask = |question| {
            unit.ask(question).expect("free");
            assert!(unit.ask(question).is_err() && unit.answer().is_none());
            while !planner.answer(&unit) {}
            assert!(!planner.answer(&unit));
            unit.answer().expect("answered")
        };
        for (question, name) in [
            (Question::StateAt(1), "FCT_CALC_STATE_AT_T"),
            (Question::NextFeed, "FCT_CALC_TIME"),
            (Question::Standstill, "FCT_CALC_POS_V_0"),
        ] {
            let answer = ask(question);
            assert_eq!(answer.is_ok(), enabled, "{question:?}: {answer:?}");
            if let Err(unknown) = answer {
                assert_eq!(unknown, Unknown::NotEnabled(name));
                assert!(unknown.to_string().contains(name) && unknown.to_string().contains("P-CHAN-00650"));
            }
        }
        if !enabled {
            continue;
        }
        let feed = ask(Question::NextFeed).expect("known");
        assert_eq!((feed.n, feed.block), (30, 2));
        let status = operator.status();
        let next: Moment<3> = ask(Question::StateAt(1)).expect("known");
        assert_eq!((next.ticks, next.tick), (1, status.ticks));
        assert_eq!(ask(Question::StateAt(0)).map_err(|e| matches!(e, Unknown::Beyond { .. })), Err(true));
        let Err(Unknown::Beyond { ticks }) = ask(Question::StateAt(u32::MAX)) else { panic!("not so far") };
        assert!(ask(Question::StateAt(ticks)).is_ok() && ask(Question::StateAt(ticks + 1)).is_err());
        let stand = ask(Question::Standstill).expect("known");
        assert_eq!((stand.speed, stand.n), (Speed::ZERO, 10));
        assert!(stand.set_points[0] > status.set_points[0] && stand.set_points[0] < Position::from_num(50));
    }
}

/// The memory of the question for the standstill is what the document says.
#[test]
fn an_inquiry_takes_8_kilobytes() {
    let bytes = size_of::<Inquiry>();
    assert!((4096..=8192).contains(&bytes), "{bytes}");
}

/// Drives a program; its ticks, and the sum of its set points.
fn driven(machine: &MachineData<3>, text: &str) -> (u64, i64) {
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let handles = channel.split(machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
    let Handles { mut planner, mut interpolator, .. } = handles;
    let (mut ticks, mut sum) = (0, 0i64);
    loop {
        let done = call(&mut planner, usize::MAX, |_| {}).expect("a program");
        let state = interpolator.tick();
        ticks += 1;
        for point in interpolator.set_points() {
            sum = sum.wrapping_mul(31).wrapping_add(point.to_bits());
        }
        if done && state == State::Idle {
            return (ticks, sum);
        }
    }
}

/// FCT_LOOK_AHEAD_OPT is NO_OPT=0 where the program does not say. Rows: C40-062, D3-200.
#[test]
fn look_ahead_opt_is_no_opt_0() {
    let moves: String =
        (0..60).map(|i| format!("X{} F{}\n", i + 1, if i % 3 == 0 { 900 } else { 6000 - 50 * i })).collect();
    let mut plain = machines::even(1000);
    plain.channel.slope_profile = 3;
    let mut opt = plain;
    opt.channel.interpolator.functions = Functions::IPO_DEFAULT.with(Functions::LOOK_AHEAD_OPT);
    let by_program = driven(&plain, &format!("#SLOPE [TYPE=HSC NO_OPT=0]\nG01 {moves}"));
    let off = driven(&plain, &format!("G01 {moves}"));
    assert_ne!(by_program, off);
    assert_eq!(driven(&opt, &format!("G01 {moves}")), by_program);
    assert_eq!(driven(&opt, &format!("#SLOPE [TYPE=HSC]\nG01 {moves}")), by_program);
    assert_eq!(driven(&opt, &format!("#SLOPE DEFAULT\nG01 {moves}")), by_program);
    assert_eq!(driven(&opt, &format!("#SLOPE [TYPE=HSC NO_OPT=1]\nG01 {moves}")), off);
    for slope in 0..3 {
        (plain.channel.slope_profile, opt.channel.slope_profile) = (slope, slope);
        assert_eq!(driven(&opt, &format!("G01 {moves}")), driven(&plain, &format!("G01 {moves}")));
    }
}

/// What of a program a log has with these data, or why it is refused.
fn logged(interpolator: InterpolatorData) -> Result<(usize, u32), String> {
    let machine = {
        let mut machine = machines::even(1000);
        machine.channel.interpolator = interpolator;
        machine
    };
    let text: &[u8] = b"G01 F6000\nN10 X1\nN20 #CONTOUR LOOKAHEAD LOG ON\nN30 X2\nN40 Y1\nN50 X3\nN60 Y2\n";
    let mut memory = Box::new(ContourMemory::<16, 16>::new());
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let (recorder, contour) = memory.split();
    let handles = channel.split(&machine, [Position::ZERO; 3], text).map_err(|error| error.to_string())?;
    let Handles { mut planner, .. } = handles;
    planner.log_contour(recorder);
    call(&mut planner, usize::MAX, |_| {}).map_err(|error| error.to_string())?;
    let all = ProgramDistance::from_bits(i64::MAX);
    let kept = contour.elements(ProgramDistance::ZERO, all).filter(Result::is_ok).count();
    Ok((kept, contour.log_state().entries))
}

/// FCT_CONTOUR_LAH enables the log, P-STUP-00033 that by index, P-CHAN-00658 says how much is kept; 0 is nothing.
/// Rows: C40-004, C40-008, C40-013, C40-054, C40-067, C40-073, CF-30.
#[test]
fn machine_data_enable_and_limit_the_log() {
    let all = InterpolatorData::ALL;
    assert_eq!(logged(all), Ok((5, 5)));
    assert_eq!(logged(InterpolatorData { log_max: 3, ..all }), Ok((3, 3)));
    assert_eq!(logged(InterpolatorData { log_max: 0, ..all }), Ok((0, 0)));
    let said = logged(InterpolatorData { fb_storage_size: 0, ..all }).expect_err("no storage");
    assert!(said.contains("P-STUP-00033"), "{said}");
    let said =
        logged(InterpolatorData { functions: Functions::IPO_DEFAULT, ..all }).expect_err("no function");
    assert!(said.contains("FCT_CONTOUR_LAH"), "{said}");
}

/// A channel refuses names that contradict each other, and functions that are not there. Rows: C40-072, C40-063.
#[test]
fn names_that_contradict_are_refused() {
    let refused = |bits| {
        let functions = Functions::of_bits(bits);
        logged(InterpolatorData { functions, ..InterpolatorData::ALL }).expect_err("refused")
    };
    for (bits, word) in [(0, "no size"), (0b11, "two sizes"), (1 << 11 | 1, "FCT_LIFT_UP_TIME")] {
        assert!(refused(bits).contains(word), "{}", refused(bits));
        assert!(refused(bits).contains("P-CHAN-00650"), "{}", refused(bits));
    }
}
