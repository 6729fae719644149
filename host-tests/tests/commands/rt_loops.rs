//! Real-time loops: passes without a stop, the end, refused lines, and the log.
use glidepath::contour_log::{BlockType, Entry, ProgramDistance};
use glidepath::machine::MachineData;
use host_tests::cases::machines;
use host_tests::loops::{CIRCLE, drive, run};
use std::f64::consts::PI;

/// A machine that passes from line to arc at speed.
fn machine(slope: u8) -> MachineData<3> {
    let mut machine = machines::with_slope(machines::even(1000), slope);
    machine.channel.corr_v_trans_jerk = false;
    machine
}

/// A circle of one block.
const WHOLE: &str = "N10 G01 X30 F6000\n#RT WHILE\nN30 G03 X30 Y0 I0 J10\nN60 G03 X30 Y0 I0 J10\n#RT ENDWHILE\nN80 G01 X60\nM30\n";

/// Two lines and two half circles; the seam is inside of a line.
const STADIUM: &str = "N10 G01 X30 F6000\n#RT WHILE\nN30 G01 X50\nN40 G03 X50 Y20 I0 J10\nN50 G01 X10\n\
    N55 G03 X10 Y0 I0 J-10\nN60 G01 X30\n#RT ENDWHILE\nN80 G01 X60\nM30\n";

/// G-09: with every slope the motion passes a tangential seam at speed, leaves the loop so in the pass in which the flag
/// fell, and ends on the last bit.
#[test]
fn no_stop_at_a_tangential_seam() {
    for slope in 0..4 {
        for text in [CIRCLE, WHOLE, STADIUM] {
            let (passes, slowest, end) = drive(text, &machine(slope), 20, 30);
            assert_eq!((passes, end), (20, [60.0, 0.0, 0.0]), "slope {slope}: {text}");
            assert!(slowest > 99.9, "slope {slope}: {slowest} mm/s: {text}");
        }
    }
}

/// The decision comes 128 ticks and twice the path to a standstill before the end of a pass: 13 mm and 11 mm here.
/// A flag that falls later ends the loop one pass later.
#[test]
fn the_flag_is_read_late() {
    for (n, passes) in [(30, 5), (40, 5), (50, 5), (60, 6)] {
        assert_eq!(drive(CIRCLE, &machine(1), 5, n).0, passes, "flag falls in N{n}");
    }
}

/// A loop takes as long as the same blocks one behind the other, with corners, curves and rows of chords too.
#[test]
fn passes_are_as_fast_as_blocks_one_behind_the_other() {
    let chords = |k: u32| {
        let a = f64::from(k) / 100.0 * 2.0 * PI;
        let [x, y] = if k == 100 { [30.0, 0.0] } else { [30.0 + 20.0 * a.sin(), 20.0 - 20.0 * a.cos()] };
        format!("N{} G01 X{x:.6} Y{y:.6}\n", 100 + k)
    };
    let circle: String = (1..=100).map(chords).collect();
    let square = "N30 G01 X50\nN40 Y20\nN50 X10\nN55 Y0\nN60 X30\n".to_owned();
    let tiny = "G03 X30.5 Y0.5 I0 J0.5\nX30 Y1 I-0.5 J0\nX29.5 Y0.5 I0 J-0.5\nX30 Y0 I0.5 J0\n".to_owned();
    let on = "#CONTOUR MODE [DEV PATH_DEV=0.05]\nG261\n";
    for (head, body) in [("", &square), (on, &square), (on, &circle), ("", &tiny)] {
        let machine = machine(1);
        let text = format!("G01 X30 F6000\n{head}#RT WHILE\n{body}#RT ENDWHILE\nG01 X60\nG260\nM30\n");
        let mut ticks = [0; 2];
        let (_, refused) = run::<128>(&text, &machine, |now| {
            if now.switch.passes() == 6 {
                now.switch.disable();
            }
            ticks[0] = now.tick;
        });
        assert_eq!(refused, None);
        let text = format!("G01 X30 F6000\n{head}{}G01 X60\nG260\nM30\n", body.repeat(6));
        run::<1>(&text, &machine, |now| ticks[1] = now.tick);
        assert!(ticks[0].abs_diff(ticks[1]) <= 2, "{ticks:?} ticks: {head}{body}");
    }
}

/// Holds and override inside of a loop; each pass ends on the last bit, whatever they do.
#[test]
fn hold_and_override_inside() {
    let mut text = String::from(CIRCLE);
    text.insert_str(0, "N5 G90\n");
    let (mut passes, mut last, mut stood) = (0, 0, 0);
    let (_, refused) = run::<16>(&text, &machine(3), |now| {
        match now.tick % 1000 {
            300 => now.operator.feed_hold(),
            450 => now.operator.resume(),
            600 => now.operator.set_override(300),
            800 => now.operator.set_override(1000),
            _ => {}
        }
        stood += u64::from(now.tick % 1000 == 440 && now.status.speed.0.to_bits() == 0);
        let n = now.status.n;
        passes += u64::from(n == 30 && last != 30);
        last = n;
        if passes == 20 {
            now.switch.disable();
        }
        let [x, y, _] = now.status.set_points.map(|p| p.to_num::<f64>());
        if (30..=60).contains(&n) {
            assert!(((x - 30.0).hypot(y - 10.0) - 10.0).abs() < 1e-6, "tick {}: {x} {y}", now.tick);
        }
    });
    assert_eq!((refused, passes, last), (None, 20, 80));
    assert!(stood > 10, "{stood} holds");
}

/// A flag that is false where the loop begins: it is left out. One that falls in the first pass: it is driven once.
#[test]
fn left_out_or_driven_once() {
    assert_eq!(drive(CIRCLE, &machine(1), 1, 30).0, 1);
    let text = format!("V.RTG.LOOP.ENABLED = FALSE\n{CIRCLE}");
    let (mut seen, mut end) = (Vec::new(), [0.0; 3]);
    let (_, refused) = run::<16>(&text, &machine(1), |now| {
        seen.push(now.status.n);
        end = now.status.set_points.map(|p| p.to_num());
    });
    assert_eq!((refused, end), (None, [60.0, 0.0, 0.0]));
    assert!(!seen.contains(&30) && seen.contains(&80));
}

/// A pass of many: exact to the last bit at each seam that falls on a tick, and at the end. The long form is the example
/// `rt_loops`.
#[test]
fn many_passes_do_not_drift() {
    let text = CIRCLE.replace("I0 J10\n", "I0 J10 F60000\n");
    let mut machine = machine(0);
    for axis in &mut machine.axes {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
    }
    let (passes, _, end) = drive(&text, &machine, 2000, 30);
    assert!((2000..=2001).contains(&passes), "{passes}");
    assert_eq!(end, [60.0, 0.0, 0.0]);
}

/// C40-050 (22073: CLEAR in a loop), G-09: what a loop cannot have, with ISG's number. Nothing of it moves.
#[test]
fn what_is_refused() {
    let spline = "G01 F600\n#SPLINE TYPE AKIMA\n";
    for (before, body, message) in [
        ("", "G01 X1\n#CONTOUR LOOKAHEAD LOG CLEAR\nX0\n", "22073 LOG CLEAR in"),
        ("", "G01 X1\nM25\nX0\n", "22073 M function in"),
        ("", "G01 X1\nG04 X1\nX0\n", "22073 G04 in"),
        ("", "G01 X1 G60\nX0\n", "22073 G60 in"),
        ("G360\n", "G01 X1\nX0\n", "22073 an exact stop"),
        ("", "G01 X1\nG261\nX0\n", "22073 contouring"),
        ("", "G01 X1\nP1=2\nX0\n", "22073 \"P1=2\" in"),
        ("", "G01 X1\nV.P.A=2\nX0\n", "22073 \"V.P.A=2\" in"),
        ("", "G01 X1\n$IF 1\nX0\n$ENDIF\n", "22073 \"$IF\" in"),
        ("", "G01 X1\nLL A\nX0\n", "22073 \"LL\" in"),
        ("", "G01 X1\nX0\nM30\n", "22073 program end in"),
        ("", "G01 X1\nX0\nM17\n", "22073 \"M17\" in"),
        ("", "G01 X1\n#RT WHILE\nX0\n", "22181 "),
        ("", "G01 X1\n", "50991 "),
        ("", "G01 X1 Z1\nX0\n", "50991 "),
        ("", "G01 X0\n", "0 no axis moves"),
        ("", "", "0 no axis moves"),
        ("#SPLINE TYPE AKIMA\n#SPLINE ON\nG01 X1\nX2\n", "G01 X3\nX2\n", "22128 "),
        (spline, "#SPLINE ON\nG01 X3\nX2 Y2\nX0 Y0\n", "22129 "),
        ("", "G01 X1\nX2\nX3\nX4\nX0\n", "0 the real-time loop has more than 4 commands"),
        ("#RT ENDWHILE\n", "G01 X1\nX0\n", "0 #RT ENDWHILE without #RT WHILE"),
    ] {
        let text = format!("F600\n{before}#RT WHILE\n{body}#RT ENDWHILE\nM30\n");
        let (mut moved, mut passes) = (0.0, 0);
        let (_, refused) = run::<4>(&text, &machine(1), |now| {
            moved = now.status.set_points[0].to_num::<f64>();
            passes = now.switch.passes();
            now.switch.disable();
        });
        let refused = refused.unwrap_or_default();
        assert!(refused.starts_with(message), "{refused}: {text}");
        assert!(passes == 0 && (moved == 0.0 || moved == 2.0), "{moved}: {text}");
    }
    let (_, refused) = run::<4>("G01 F600\n#RT WHILE\nX1\nX0\n", &machine(1), |_| {});
    assert_eq!(refused.as_deref().map(|error| error.starts_with("0 #RT WHILE without")), Some(true));
    let (_, refused) = run::<0>("G01 F600\n#RT WHILE\nX1\nX0\n#RT ENDWHILE\n", &machine(1), |_| {});
    assert_eq!(
        refused.as_deref().map(|error| error.contains("memory for real-time")),
        Some(true),
        "{refused:?}"
    );
}

/// Runs a program whose flag falls when so many passes are decided on. The log at the end.
fn logged(text: &str, passes: u32) -> Vec<Entry> {
    let mut log = Vec::new();
    let (_, refused) = run::<16>(text, &machine(1), |now| {
        if now.switch.passes() >= passes {
            now.switch.disable();
        }
        log = (0..).map_while(|i| now.contour.logged(i)).collect();
    });
    assert_eq!(refused, None);
    log
}

/// The loop of C40-EX02 and EX03: N and length, and the knee where an element follows the one before it in the loop.
fn kite() -> [(u32, f64, f64); 5] {
    let (long, right) = (32f64.sqrt(), PI / 2.0);
    [(80, long, right), (90, 4.0, PI / 4.0), (100, 4.0, right), (110, long, PI / 4.0), (120, long, right)]
}

/// Whether these entries are a pass of the kite that begins at `start`, with that knee.
fn is_pass(entries: &[Entry], mut start: f64, knee: f64) {
    assert_eq!(entries.len(), 5);
    for (i, (entry, (n, length, turn))) in entries.iter().zip(kite()).enumerate() {
        assert_eq!((entry.block_type, entry.n), (BlockType::Line, n));
        let turn = if i == 0 { knee } else { turn };
        for (got, want) in [(entry.start.to_mm(), start), (entry.length.to_mm(), length), (entry.knee, turn)]
        {
            assert!((got - want).abs() < 1e-6, "{got} in place of {want}: N{n} {entry:?}");
        }
        start += length;
    }
}

/// Whether the entry is that mark.
fn is_mark(entry: &Entry, kind: BlockType, n: u32, (start, parameter): (f64, f64)) {
    assert_eq!((entry.block_type, entry.n, entry.parameter), (kind, n, parameter));
    assert!((entry.start.to_mm() - start).abs() < 1e-6, "{entry:?}");
}

const KITE: &str = "N080 G1 X4 Y4\nN090 X8 Y4\nN100 X8 Y0\nN110 X4 Y-4\nN120 G1 X0 Y0\n";

/// C40-048, C40-052: inside of the loop the elements are logged once, with the knee to the block before the loop.
#[test]
fn a_log_inside_has_the_loop_once() {
    let inside = format!(
        "N060 #RT WHILE\nN070 #CONTOUR LOOKAHEAD LOG ON [PARAM=1]\n{KITE}N130 #CONTOUR LOOKAHEAD LOG OFF [PARAM=8]\n\
        N140 #RT ENDWHILE\nN150 M30\n"
    );
    let pass: f64 = kite().iter().map(|(_, length, _)| length).sum();
    // C40-EX02 begins where the axes stand. With a block before it, from below, the knee is 45°.
    for (head, start, knee) in
        [("N050 G1 X0 Y0 F1000\n", 0.0, 0.0), ("G0 Y-5\nN050 G1 X0 Y0 F1000\n", 10.0, PI / 4.0)]
    {
        for passes in [1, 2, 7] {
            let log = logged(&format!("{head}{inside}"), passes);
            assert_eq!(log.len(), 7, "{passes} passes: {log:?}");
            is_mark(&log[0], BlockType::LogOn, 70, (start, 1.0));
            is_pass(&log[1..6], start, knee);
            is_mark(&log[6], BlockType::LogOff, 130, (start + pass, 8.0));
        }
    }
}

/// C40-049, C40-053: around the loop the elements are logged three times: first pass, second pass, last pass. A loop of
/// fewer passes has those that are driven.
#[test]
fn a_log_around_has_the_loop_three_times() {
    let text = format!(
        "N050 G1 X0 Y0 F1000\nN060 #CONTOUR LOOKAHEAD LOG ON [PARAM=1]\nN070 #RT WHILE\n{KITE}N130 #RT ENDWHILE\n\
        N140 #CONTOUR LOOKAHEAD LOG OFF [PARAM=8]\nN150 M30\n"
    );
    let pass: f64 = kite().iter().map(|(_, length, _)| length).sum();
    let right = PI / 2.0;
    for passes in [3, 4, 9, 1, 2] {
        let log = logged(&text, passes);
        let shown = passes.min(3) as usize;
        assert_eq!(log.len(), 2 + 5 * shown, "{passes} passes: {log:?}");
        is_mark(&log[0], BlockType::LogOn, 60, (0.0, 1.0));
        is_pass(&log[1..6], 0.0, 0.0);
        if shown > 1 {
            is_pass(&log[6..11], pass, right);
        }
        if shown > 2 {
            is_pass(&log[11..16], f64::from(passes - 1) * pass, right);
        }
        is_mark(&log[1 + 5 * shown], BlockType::LogOff, 140, (f64::from(passes) * pass, 8.0));
    }
}

/// The programs of `programs/loops`: a ring that is logged once, and a rounded square that is logged three times.
#[test]
fn shipped_programs() {
    let ring = logged(include_str!("../../../programs/loops/polish.nc"), 12);
    let kinds: Vec<_> = ring.iter().map(|entry| (entry.block_type as u8, entry.n)).collect();
    assert_eq!(kinds, [(3, 40), (1, 50), (2, 60), (1, 70), (2, 80), (5, 90)]);
    // From the lower left to straight up.
    assert!((ring[1].knee - PI / 4.0).abs() < 1e-6, "{:?}", ring[1]);
    for arc in [&ring[2], &ring[4]] {
        assert!((arc.angle - PI).abs() < 1e-6 && (arc.radius_mm - 20.0).abs() < 1e-6, "{arc:?}");
        assert!((arc.length.to_mm() - 20.0 * PI).abs() < 1e-6 && arc.knee < 1e-6, "{arc:?}");
    }
    let square = logged(include_str!("../../../programs/loops/warm_up.nc"), 12);
    let marks: Vec<_> = square.iter().map(|entry| entry.n).filter(|n| [40, 120].contains(n)).collect();
    assert_eq!(marks, [40, 120]);
    let sides = |n: u32| square.iter().filter(|e| e.n == n && e.block_type == BlockType::Line).count();
    assert_eq!([60, 70, 80, 90, 100].map(sides), [3; 5], "{square:?}");
    let gaps = square.windows(2).filter(|pair| pair[0].end() != pair[1].start).count();
    assert_eq!(gaps, 1, "between the second pass and the last one");
}

/// G-09, G-10: with MODULO the distance from program start is set back at the end of each pass; without, it counts on.
#[test]
fn modulo_sets_the_distance_back() {
    let pass: f64 = kite().iter().map(|(_, length, _)| length).sum();
    for (modulo, reach) in [("", 10.0 + 6.0 * pass + 10.0), (" [MODULO]", 20.0), (" MODULO", 20.0)] {
        let text = format!("G1 X10 F6000\nG92 X10\n#RT WHILE{modulo}\n{KITE}#RT ENDWHILE\nN200 X10\nM30\n");
        let (mut known, mut at) = (0.0, Vec::new());
        let (_, refused) = run::<16>(&text, &machine(1), |now| {
            if now.switch.passes() >= 6 {
                now.switch.disable();
            }
            known = now.contour.reach().to_mm();
            let distance = now.contour.distance(now.status.distance).map_or(f64::NAN, ProgramDistance::to_mm);
            at.push(distance);
        });
        assert_eq!(refused, None);
        assert!((known - reach).abs() < 1e-6, "{modulo}: {known}, expected {reach}");
        let back = at.windows(2).filter(|pair| pair[1] < pair[0] - 1.0).count();
        assert_eq!(back, if modulo.is_empty() { 0 } else { 6 }, "{modulo}");
        assert!(at.iter().all(|at| *at <= 10.0 + pass + 1e-6) || modulo.is_empty(), "{modulo}");
    }
}
