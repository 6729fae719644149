//! C40-064, FCT_SHIFT_NCBL: functions that come out at a distance before their place (MEP_SVS, MEP_MOS, P-CHAN-00070), and
//! the synchronisation that a program reads and sets (V.G.M_FCT).
use super::{acknowledge, run_on};
use glidepath::channel::Channel;
use glidepath::machine::{InterpolatorData, InterpolatorFunctions, MachineData, Synch, SynchTable};
use glidepath::quantity::Position;
use host_tests::cases::machines;

/// M95 and M96 are MEP_SVS, 5 and 25 mm before their place; M97 and M98 MEP_MOS, 10 and 1000 mm before it; M24 is MVS_SLM.
fn machine() -> MachineData<3> {
    let mut machine = machines::with_slope(machines::even(1000), 1);
    machine.channel.interpolator = InterpolatorData::ALL;
    machine.channel.m_synch = SynchTable::NONE
        .with(95, Synch::MepSvs)
        .with_shift(95, 50_000)
        .with_shift(96, 250_000)
        .with(96, Synch::MepSvs)
        .with(97, Synch::MepMos)
        .with_shift(97, 100_000)
        .with(98, Synch::MepMos)
        .with_shift(98, 10_000_000)
        .with(24, Synch::MvsSlm);
    machine
}

/// Each M function with X at the tick at which it came, and the furthest X of that tick and the one before.
fn places(text: &str) -> Vec<(u16, f64, f64)> {
    let (mut seen, mut before) = (Vec::new(), 0.0);
    let (_, _, waits) = run_on(&machine(), &[text], &[], |now, operator| {
        for (_, code) in now.out.iter().skip(seen.len()) {
            seen.push((*code, before, now.at[0]));
            if matches!(code, 95 | 96) {
                acknowledge(operator, &[*code]);
            }
        }
        before = now.at[0];
    });
    assert!(!waits, "{text}");
    seen
}

/// C40-064: M96 of X40 comes in the tick in which the path passes X15, in a row of blocks without a stop, with a line of its
/// own, in a line with a motion, behind a sharp and a smooth corner, before a dwell and before the program end.
#[test]
fn a_function_comes_at_a_distance_before_its_place() {
    let row = "N10 G01 X10 G90 F5000\nN20 X20\nN30 X30\nN40 X40\n";
    for (tail, code, at) in [
        ("N50 M96\nN55 X80\nN60 X0\nM30\n", 96, 15.0),
        ("N50 M96 X80\nN60 X0\nM30\n", 96, 15.0),
        ("N50 M97\nN55 X80\nN60 X0\nM30\n", 97, 30.0),
        ("N50 M97\nN55 G04 X0.1\nN60 X0\nM30\n", 97, 30.0),
        ("N50 M97\nM30\n", 97, 30.0),
        ("N50 M96\nM30\n", 96, 15.0),
        ("N50 M97\n", 97, 30.0),
        ("N50 M95 Y5\nM30\n", 95, 35.0),
        ("#CONTOUR MODE [DEV PATH_DEV=0.1]\nN41 X50\nN50 M97 Y20\nM30\n", 97, 40.0),
    ] {
        let text = format!("{row}{tail}");
        let [(found, before, now)] = places(&text)[..] else { panic!("{text}: one function") };
        assert_eq!(found, code, "{text}");
        assert!(before < at && at <= now && now - before < 0.1, "{text}: {before} {now}");
    }
}

/// A function that is longer before its place than the program knows comes at once; and functions come out in the order
/// of the program, so M96 waits for M7 and M95.
#[test]
fn functions_come_out_in_the_order_of_the_program() {
    let text = "N10 G01 X10 F5000\nN20 X20\nN30 M98\nN40 X40\nM30\n";
    let [(98, _, now)] = places(text)[..] else { panic!("M98") };
    assert!(now < 0.1, "{now}");
    let text = "N10 G01 X30 F5000\nN15 M7\nN20 X40\nN25 M95\nN30 M96\nN40 X60\nM30\n";
    let all = places(text);
    assert_eq!(all.iter().map(|(code, ..)| *code).collect::<Vec<_>>(), [7, 95, 96]);
    for ((_, before, now), at) in all.iter().zip([30.0, 35.0, 35.0]) {
        assert!(*before < at && at <= *now, "{all:?}");
    }
}

/// MEP_SVS holds the motion at its place, not where it comes out; acknowledged in time it stops nothing.
#[test]
fn the_motion_waits_at_the_place() {
    let text = "N10 G01 X40 F5000\nN50 M96\nN55 X80\nM30\n";
    let (mut stood, mut slowest) = (0, f64::MAX);
    let (out, end, _) = run_on(&machine(), &[text], &[], |now, operator| {
        if now.waits {
            assert!((now.at[0] - 40.0).abs() < 1e-9, "{}", now.at[0]);
            stood += 1;
            if stood == 50 {
                acknowledge(operator, &[96]);
            }
        }
    });
    assert_eq!((out.len(), stood, end[0]), (1, 50, 80.0));
    let mut open = true;
    run_on(&machine(), &[text], &[], |now, operator| {
        if open && !now.out.is_empty() {
            acknowledge(operator, &[96]);
            open = false;
        }
        if (35.0..45.0).contains(&now.at[0]) {
            slowest = slowest.min(now.speed);
        }
        assert!(!now.waits);
    });
    assert!(slowest > 0.08, "{slowest}");
}

/// V.G.M_FCT[n].SYNCH reads and sets the kind, PRE_OUTP_PATH the shift, in mm or inches. The next program begins with the
/// machine data.
#[test]
fn a_program_reads_and_sets_the_synchronisation() {
    let row = "N10 G01 X10 F5000\nN20 X20\nN30 X30\nN40 X40\n";
    for (head, code, at) in [
        ("V.G.M_FCT[11].PRE_OUTP_PATH = 12.5\nV.G.M_FCT[11].SYNCH = 1048576\n", 11, 27.5),
        (
            "G70\nV.G.M_FCT[011].PRE_OUTP_PATH = 0.5\nG71\nv.g.m_fct[11].synch = V.G.M_FCT[97].SYNCH\n",
            11,
            27.3,
        ),
        ("P1 = V.G.M_FCT[96].PRE_OUTP_PATH\nV.G.M_FCT[97].PRE_OUTP_PATH = P1 - 1\n", 97, 16.0),
        ("V.G.M_FCT[97].PRE_OUTP_PATH = 0\nV.G.M_FCT[97].SYNCH = 1\n", 97, 40.0),
    ] {
        let text = format!("{head}{row}N50 M{code}\nN60 X60\nM30\n");
        let all = places(&text);
        let [(found, before, now)] = all[..] else { panic!("{text}: {all:?}") };
        assert!(found == code && before < at && at <= now, "{text}: {all:?}");
    }
    let sets = "V.G.M_FCT[11].SYNCH = 2\nN10 G01 X10 F5000\nN20 M11\nN30 X20\nM30\n";
    let plain = "N10 G01 X10 F5000\nN20 M11\nN30 X20\nM30\n";
    let (mut stood, mut runs) = (0, 0);
    run_on(&machine(), &[sets, plain], &[], |now, operator| {
        if now.waits {
            stood += 1;
            acknowledge(operator, &[11]);
        }
        runs = now.out.len();
    });
    assert_eq!((runs, stood), (2, 1), "the second program has MOS again");
    // Values: FAW_SYNCH beside a kind.
    let text = "V.G.M_FCT[12].SYNCH = 268435457\nP1 = V.G.M_FCT[12].SYNCH - V.G.M_FCT[13].SYNCH\nG01 X=P1/1000000 F9000\nM30\n";
    let (_, end, _) = run_on(&machine(), &[text], &[], |_, _| {});
    assert!((end[0] - 268.435_456).abs() < 1e-6, "{end:?}");
}

/// What is refused, and what is expected instead.
#[test]
fn a_shift_that_is_not_possible_is_refused() {
    for (text, expected) in [
        ("V.G.M_FCT[11].SYNCH = 3\n", "16777216 MEP_SVS"),
        ("V.G.M_FCT[11].SYNCH = 33554432\n", "16777216 MEP_SVS"),
        ("V.G.M_FCT[11].SYNCH = 1.5\n", "16777216 MEP_SVS"),
        ("V.G.M_FCT[11].SYNCH = -1\n", "16777216 MEP_SVS"),
        ("V.G.M_FCT[97].PRE_OUTP_PATH = -1\n", "0…200 000 mm"),
        ("V.G.M_FCT[97].PRE_OUTP_PATH = 200001\n", "0…200 000 mm"),
        ("V.G.M_FCT[1000].SYNCH = 1\n", "V.G.M_FCT[0…999]"),
        ("V.G.M_FCT[P1].SYNCH = 1\n", "V.G.M_FCT[0…999]"),
        ("V.G.M_FCT[].SYNCH = 1\n", "V.G.M_FCT[0…999]"),
        ("V.G.M_FCT[11].SPEED = 1\n", "V.G.M_FCT[0…999]"),
        ("P1 = V.G.M_FCT[11]\n", "V.G.M_FCT[0…999]"),
        ("P1 = V.G.M_FCT[11].PRE_OUTP_PATH\n", "21512"),
        ("V.G.T_FCT[11].SYNCH = 1\n", "known, not available"),
        ("V.G.M_FCT[11].PRE_OUTP_PATH = 1\nM11\n", "MEP_SVS or MEP_MOS"),
        ("V.G.H_FCT[11].PRE_OUTP_PATH = 1\nH11\n", "MEP_SVS or MEP_MOS"),
    ] {
        let machine = machine();
        let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
        let handles = channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
        let mut planner = handles.planner;
        let said =
            (0..100).find_map(|_| planner.poll().err()).map(|error| error.to_string()).unwrap_or_default();
        assert!(said.contains(expected), "{text}: {said}");
    }
    let refused = |change: fn(&mut MachineData<3>)| {
        let mut machine = machine();
        change(&mut machine);
        let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
        let said =
            channel.split(&machine, [Position::ZERO; 3], &b""[..]).err().map(|error| error.to_string());
        said.unwrap_or_default()
    };
    let said = refused(|machine| machine.channel.interpolator.functions = InterpolatorFunctions::IPO_DEFAULT);
    assert!(said.contains("m_synch[95] = MEP_SVS") && said.contains("FCT_SHIFT_NCBL"), "{said}");
    let said = refused(|machine| machine.channel.h_synch = SynchTable::NONE.with_shift(7, 1));
    assert!(said.contains("h_synch[7] = MOS") && said.contains("MEP_SVS or MEP_MOS"), "{said}");
    let said = refused(|machine| machine.channel.m_synch = machine.channel.m_synch.with_shift(95, u32::MAX));
    assert!(said.contains("2000000000"), "{said}");
}

/// P-CHAN-00033: the program ends when its functions of late synchronisation are acknowledged; without it they stay pending.
#[test]
fn late_functions_are_awaited_at_program_end() {
    for waits in [false, true] {
        let mut machine = machine();
        machine.channel.interpolator.late_sync_ready = waits;
        let (mut stood, mut end) = (0, 0);
        run_on(&machine, &["N10 M24 G00 X25\nM30\n", "G00 X30\n"], &[], |now, operator| {
            if now.waits {
                stood += 1;
                assert!((now.at[0] - 25.0).abs() < 1e-9);
                if stood == 20 {
                    acknowledge(operator, &[24]);
                }
            }
            end = now.tick;
        });
        assert_eq!(stood, if waits { 20 } else { 0 });
    }
}

/// An abort takes back a function that is shifted and not due, and the next program has its own.
#[test]
fn an_abort_takes_back_a_shifted_function() {
    let text = "N10 G01 X100 F5000\nN20 M97\nN30 X200\nM30\n";
    let next = "N10 G01 X0 F5000\nN20 M97\nN30 X50\nM30\n";
    let mut aborted = false;
    let mut at = Vec::new();
    let (out, _, _) = run_on(&machine(), &[text, next], &[], |now, operator| {
        if !aborted && now.at[0] > 50.0 {
            operator.abort();
            aborted = true;
        }
        if at.len() < now.out.len() {
            at.push(now.at[0]);
        }
    });
    assert_eq!(out.len(), 1, "{out:?}");
    assert!((at[0] - 10.0).abs() < 0.1, "{at:?}");
}

/// C40-064: before the program end the shift may be longer than what is planned: the place is known when the last block is read.
#[test]
fn a_long_shift_before_the_end() {
    let row: String = (1..=400).map(|i| format!("G01 X{i} F{}\n", 3000 + i % 2)).collect();
    let text = format!("V.G.M_FCT[97].PRE_OUTP_PATH = 100\n{row}M97\nM30\n");
    let [(97, before, now)] = places(&text)[..] else { panic!("M97 once") };
    assert!(before < 300.0 && 300.0 <= now, "{before} {now}");
}
