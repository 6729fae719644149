//! Rows NC-001…NC-008 and gaps §11: program structure, words, modal state, parameters, control blocks.
use crate::nc_decode::{commands, decode, decode_with, ends, error, motions, setup, value};
use glidepath::machine::{Synch, SynchTable};
use glidepath::nc::{ArcBy, Command, DwellTime, MotionKind, NcWarningKind, Plane};
use glidepath::quantity::Position;

fn mm(x: f64) -> Position {
    Position::from_num(x)
}

/// X of every motion.
fn xs(text: &str) -> Vec<f64> {
    ends(text).iter().map(|(_, [x, ..])| *x).collect()
}

/// N of every motion.
fn ns(text: &str) -> Vec<u32> {
    ends(text).iter().map(|(n, _)| *n).collect()
}

#[test]
fn nc_001_heads_local_subroutines_and_ends() {
    let text =
        "%L one\nN1 G0 X1\nM29\n%L two\nN2 X2\nLL one\nM17\n%main\nLL one\nN3 X3\nLL two\nN4 X4 M30\nN5 X5\n";
    assert_eq!(ns(text), [1, 3, 2, 1, 4], "nothing after M30");
    assert_eq!(ns("N1 G0 X1\nN2 X2"), [1, 2], "file without a head");
    assert_eq!(
        ns("%L s\nN1 G0 X1\n%main\nLL s\nN2 X2\n%other\nN9 X9"),
        [1, 2],
        "the next head ends a program"
    );
    assert_eq!(ns("%main (comment) ; another\nN1 G0 X1"), [1]);
    assert_eq!(ns("% name\nN1 G0 X1"), [1], "blank after %");
    let ends = commands("G0 X1 M02");
    assert!(matches!(ends[..], [Command::Motion(_), Command::ProgramEnd(_, 2)]));
    assert!(commands("").is_empty());
    assert!(commands("%main\n").is_empty());
}

#[test]
fn nc_001_a_program_end_inside_a_subroutine_ends_everything() {
    let decoded = decode("%L s\nN1 G0 X1\nN2 M30\n%main\nLL s\nN3 X3\nM30");
    assert_eq!(decoded.commands.len(), 2);
    assert_eq!(decoded.warnings.len(), 1);
    assert_eq!(decoded.warnings[0].kind, NcWarningKind::EndInSubroutine);
    assert_eq!((decoded.warnings[0].place.line, decoded.warnings[0].place.column), (3, 4));
}

#[test]
fn nc_001_calls_nest_and_return_out_of_control_blocks() {
    let text = "%L leaf\n$FOR P1=1,5,1\n$IF P1==2\nM29\n$ENDIF\nNP1 G0 XP1\n$ENDFOR\n%main\n$FOR P2=1,2,1\nLL leaf\nN9 X9\n$ENDFOR\n";
    assert_eq!(ns(text), [1, 9, 1, 9]);
    let deep: String = (1..=10).map(|i| format!("%L s{i}\nN{i} G0 X{i}\nLL s{}\n", i + 1)).collect();
    let text = format!("{deep}%L s11\nN11 X11\n%main\nLL s2\n");
    assert_eq!(ns(&text), [2, 3, 4, 5, 6, 7, 8, 9, 10, 11], "ten calls deep");
}

#[test]
fn nc_002_block_numbers() {
    assert_eq!(
        ns("N10 G0 X1\nN10 X2\nX3\nN907090 X4\nP123=7.9\nNP123 X5\nN 20 X6\nN0030 X7"),
        [10, 10, 0, 907_090, 7, 20, 30]
    );
}

#[test]
fn nc_003_comments_continuation_and_blanks() {
    assert_eq!(xs("G0 (a (b) c) X1 ; X9\n( whole line\nX2 (open to the end\nX3"), [1.0, 2.0, 3.0]);
    assert_eq!(xs("G0 \\\n  X4 \\ (why)\n F100\nX5"), [4.0, 5.0]);
    assert_eq!(xs("  G   0X   6Y1\nX - 7\nX=   [ 8 ]"), [6.0, -7.0, 8.0]);
    assert_eq!(xs("g0 x9\n$for p1=1,2,1\nxp1\n$endfor"), [9.0, 1.0, 2.0], "letters of either case");
    for end in ["\n", "\r\n", "\r"] {
        let text = ["%m", "G0 X1", "X2 \\", "  (y) Y3", ""].join(end);
        let out = motions(&text);
        assert_eq!(xs(&text), [1.0, 2.0], "line ends of every kind: {text:?}");
        assert_eq!((out[1].place.line, out[1].place.column), (3, 1), "{text:?}");
        let error = crate::nc_decode::error(&text.replace("Y3", "Q3"));
        assert_eq!((error.place.line, error.place.column), (4, 7), "{text:?}");
        assert_eq!(&text.as_bytes()[error.place.offset as usize..][..2], b"Y3", "{text:?}");
    }
    // CR at the end of a chunk of 64 bytes, LF at the start of the next; empty lines count.
    for blanks in 50..70 {
        let text = format!("G0 X1{}\r\n\r\r\n\nX2 Q1", " ".repeat(blanks));
        let place = crate::nc_decode::error(&text).place;
        assert_eq!((place.line, place.column, place.offset as usize), (5, 4, text.len() - 2), "{blanks}");
    }
    assert_eq!(xs("G0 X1 (\u{e4}\u{f6}\u{fc} \u{4e2d})\nX2"), [1.0, 2.0], "comments in any language");
    let far = format!("G0\n({}) X3\n", "x".repeat(20_000));
    assert_eq!(xs(&far), [3.0], "comments do not count for the line");
    assert_eq!(motions(&far)[0].place.column, 20_004);
}

#[test]
fn nc_003_places_in_continued_lines() {
    let text = "N1 G01 F100 \\\n   X1 Y2 \\\n Z3 G60";
    let out = commands(text);
    assert_eq!((out[1].place().line, out[1].place().column), (1, 4), "G01");
    assert_eq!((out[0].place().line, out[0].place().column, out[0].place().length), (3, 5, 3), "G60");
    assert_eq!(out[0].place().offset as usize, text.find("G60").unwrap());
}

/// G-11.
#[test]
fn nc_004_motion_words_and_the_start_state() {
    let m = motions("N1 X0 Y0\nN2 G0 X1\nN3 G01 X2 F100\nN4 Y1\nN5 G1 X3");
    assert_eq!(m[0].kind, MotionKind::Line, "no G0…G3 yet: G01, at rest without F");
    assert_eq!(m[1].kind, MotionKind::Rapid);
    assert!(m[2..].iter().all(|m| m.kind == MotionKind::Line && m.feed == 100));
    assert_eq!(xs("G90 G0 X1\nG91 X1\nX1\nG90 X1"), [1.0, 2.0, 3.0, 1.0]);
    let all = motions("G0 X1 Y2 Z3 A4 C5")[0].target.map(|p| p.to_num::<f64>());
    assert_eq!(all, [1.0, 2.0, 3.0, 4.0, 5.0]);
}

#[test]
fn nc_004_arcs_by_centre() {
    let arc = |text: &str| motions(text).last().unwrap().kind;
    let at = |plane, clockwise, a, b| MotionKind::Arc { plane, clockwise, by: ArcBy::Centre([mm(a), mm(b)]) };
    assert_eq!(arc("F1 X10 Y5\nG02 X20 I5"), at(Plane::G17, true, 15.0, 5.0));
    assert_eq!(arc("F1 X10 Y5\nG161 G03 X20 I15 J5"), at(Plane::G17, false, 15.0, 5.0));
    assert_eq!(arc("F1 X10 Y5\nG162 G03 X20 J-5"), at(Plane::G17, false, 10.0, 0.0));
    assert_eq!(arc("F1 X10 Z5\nG18 G03 X20 K1 I2"), at(Plane::G18, false, 6.0, 12.0));
    assert_eq!(arc("F1 Y10 Z5\nG19 G02 Y20 J1 K2"), at(Plane::G19, true, 11.0, 7.0));
    assert_eq!(
        arc("F1 X10 Y5\nG92 X100 G161\nG02 X20 Y5 I15 J5"),
        at(Plane::G17, true, 115.0, 5.0),
        "offsets"
    );
    assert_eq!(arc("F1 P5=4\nG03 JP5"), at(Plane::G17, false, 0.0, 4.0), "JP5: full circle");
    assert_eq!(motions("F1 X3 P5=4\nG03 JP5")[1].target[0], 3);
    assert_eq!(arc("F1 G91 G02 X2 I1"), at(Plane::G17, true, 1.0, 0.0));
    let helix = motions("F1 G02 X2 I1 Z5")[0];
    assert_eq!((helix.target[0], helix.target[2]), (mm(2.0), mm(5.0)));
}

#[test]
fn nc_004_arcs_by_radius() {
    let by = |text: &str| match motions(text).last().unwrap().kind {
        MotionKind::Arc { by, .. } => by,
        other => panic!("{other:?}"),
    };
    assert_eq!(by("F1 G02 X10 R5"), ArcBy::Radius(mm(5.0)));
    assert_eq!(by("F1 G02 X10 R=-7.5"), ArcBy::Radius(mm(-7.5)));
    assert_eq!(by("F1 G02 R=50\nX10"), ArcBy::Radius(mm(50.0)), "R alone waits for the motion");
    assert_eq!(by("F1 G02 X10 R5\nX20"), ArcBy::Radius(mm(5.0)), "modal");
    assert_eq!(
        by("F1 G70 G02 X1 R1"),
        ArcBy::Radius(Position::from_bits((25.4 * 4_294_967_296.0_f64).round() as i64))
    );
}

#[test]
fn nc_004_dwell() {
    let time = |text: &str| match commands(text)[0] {
        Command::Dwell(_, time) => time,
        ref other => panic!("{other:?}"),
    };
    let seconds = |s| DwellTime::Seconds(mm(s));
    assert_eq!(time("G04 X0.5"), seconds(0.5));
    assert_eq!(time("G04 2"), seconds(2.0));
    assert_eq!(time("G4 X2"), seconds(2.0));
    assert_eq!(time("P1=3 G04 P1"), seconds(3.0));
    assert_eq!(time("G04 S10"), DwellTime::Revolutions(mm(10.0)));
    assert_eq!(time("#TIME 1.5"), seconds(1.5));
    let extra = decode("G04 X0.5 Y1");
    assert_eq!(extra.warnings[0].kind, NcWarningKind::DwellExtraAxis);
    assert_eq!(extra.warnings[0].id(), 20685);
    assert!(matches!(extra.commands[..], [Command::Dwell(_, t)] if t == seconds(0.5)));
    assert_eq!(xs("G0 X1\nG04 X5\nX2"), [1.0, 2.0], "the time is no coordinate");
}

/// G-06.
#[test]
fn nc_004_exact_stop() {
    let stops = |text: &str| motions(text).iter().map(|m| m.exact_stop).collect::<Vec<_>>();
    assert_eq!(stops("G0 X1 G60\nX2"), [true, false]);
    assert_eq!(stops("G0 X1\nG360\nX2\nX3\nG359 X4"), [false, true, true, false]);
}

#[test]
fn nc_004_offsets() {
    assert_eq!(xs("G0 X1\nG92 X10\nX1\nG92 X0\nX1"), [1.0, 11.0, 1.0], "G92: additive offset");
    assert_eq!(
        xs("G0 X1\nG92 X10\nG91 X0\nG90 X0"),
        [1.0, 1.0, 10.0],
        "effective with the next absolute position"
    );
    assert_eq!(xs("G0 G92 X10\nG91 G92 X5\nG90 X0"), [15.0], "G91 adds");
    let mut with_table = setup();
    with_table.zero_offsets[1][0] = mm(100.0);
    let x = |text: &str| {
        let (out, ..) = decode_with(with_table, text.as_bytes(), 1000);
        out.iter()
            .filter_map(|c| if let Command::Motion(m) = c { Some(m.target[0].to_num()) } else { None })
            .collect::<Vec<f64>>()
    };
    assert_eq!(x("G0 X1\nG55 X1\nX2\nG54 X1\nG53 X1"), [1.0, 101.0, 102.0, 1.0, 1.0]);
    assert_eq!(x("G55 G92 X10\nG0 X1"), [111.0]);
}

#[test]
fn nc_005_m_and_h_come_after_the_motion() {
    let names = |text: &str| {
        commands(text)
            .iter()
            .map(|c| match c {
                Command::M(h, m) => format!("M{m}{}", if h.in_motion { "+" } else { "" }),
                Command::H(_, h) => format!("H{h}"),
                other => other.name().to_string(),
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(
        names("X1 F1 G61 M25 H7"),
        ["contouring (#CONTOUR MODE, G61, G261, G260)", "G01", "M25+", "H7"]
    );
    assert_eq!(names("M25\nM999 M0"), ["M25", "M999", "pause"]);
    assert_eq!(names("G0 X1 M30"), ["G00", "program end"]);
    assert_eq!(
        names("T5 S1000 D2 G61")[..3],
        ["tool T", "spindle speed S", "tool offset D"],
        "order of the text"
    );
    assert_eq!(names("S1000 M3 T5 D2"), ["spindle speed S", "tool T", "tool offset D", "M3"]);
    let mut before = setup();
    before.m_synch = SynchTable::NONE.with(26, Synch::MvsSvs).with(25, Synch::MnsSns);
    before.h_synch = SynchTable::NONE.with(25, Synch::MvsSns);
    let (out, ..) = decode_with(before, b"G0 X1 M25 M26 H25", 100);
    assert!(matches!(out[..], [Command::M(_, 26), Command::H(_, 25), Command::Motion(_), Command::M(_, 25)]));
}

#[test]
fn nc_006_feed_words() {
    let feeds = |text: &str| motions(text).iter().map(|m| m.feed.to_num::<f64>()).collect::<Vec<_>>();
    assert_eq!(
        feeds("G01 X1 F200\nX2\nF500\nX3\nF=1000 X4\nP1=60 X5 FP1"),
        [200.0, 200.0, 500.0, 1000.0, 60.0]
    );
    assert_eq!(feeds("F10000\nX1\nG94 X2"), [10_000.0, 10_000.0]);
}

/// NC-015: path motion before any F, G00 and G01 is rapid motion, with one warning; any other motion without a feed is
/// an error, and with a feed it is a line.
#[test]
fn nc_015_motion_before_any_feed_is_rapid() {
    let kinds = |text: &str| {
        let decoded = decode(text);
        let kind = |command: &Command<5>| match command {
            Command::Motion(motion) => Some(motion.kind),
            _ => None,
        };
        let told: Vec<_> = decoded.warnings.iter().map(|w| (w.kind, w.place.line, w.place.column)).collect();
        (decoded.commands.iter().filter_map(kind).collect::<Vec<_>>(), told)
    };
    let (rapid, line) = (MotionKind::Rapid, MotionKind::Line);
    let told = |line, column| vec![(NcWarningKind::RapidWithoutFeed, line, column)];
    assert_eq!(kinds("G90 A90 C-90\nM30"), (vec![rapid], told(1, 5)));
    assert_eq!(kinds("M5\nX1\nY2\nF100 X3\nX4"), (vec![rapid, rapid, line, line], told(2, 1)));
    assert_eq!(kinds("X1 F100\nX2"), (vec![line, line], vec![]));
    assert_eq!(kinds("F100\nX2"), (vec![line], vec![]));
    // What stands still has no need of a feed.
    assert_eq!(kinds("X0\nX1"), (vec![line, rapid], told(2, 1)));
    for text in ["G01 X1", "G01\nX1", "X1\nG01 X2", "G00 X1\nG01 X2"] {
        assert!(error(text).to_string().contains("motion without feed"), "{text}");
    }
}

/// CF-40: weights are no part of #SLOPE, and the keyword is refused by name.
#[test]
fn weights_are_no_part_of_slope_cf_40() {
    for word in ["ACC_WEIGHT=50", "RAMP_WEIGHT=50", "G130=50"] {
        let text = format!("G0 X1\n#SLOPE [TYPE=HSC {word}]\n");
        let (error, name) = (error(&text), word.split('=').next().unwrap());
        assert_eq!((error.place.line, error.place.column), (2, 18), "{error}");
        assert!(error.to_string().contains(&format!("{name:?}")), "{error}");
    }
}

/// G-11.
#[test]
fn nc_007_parameters_and_expressions() {
    assert_eq!(xs("P100 = 50 P2=P100*2\nG0 X-P100\nX P2\nX=P2/4\nX[-90+P2]"), [-50.0, 100.0, 25.0, 10.0]);
    assert_eq!(xs("P1=5 P5=7\nG0 XPP1\nXP[P1]\nP[P1-2]=9\nXP3\nPP1=8 XP5"), [7.0, 7.0, 9.0, 8.0]);
    assert_eq!(xs("P1=2 P2=30\nG0 XP1*SIN[P2]"), [1.0], "the whole expression follows the address");
    assert_eq!(xs("P5=80 P2=90\nG0 X=P5*SIN[P2] Y=P5*[1.0-COS[P2]]"), [80.0]);
    for (text, expected) in [
        ("1+2*3", 7.0),
        ("[1+2]*3", 9.0),
        ("-2-3", -5.0),
        ("2*-3", -6.0),
        ("10/4/5", 0.5),
        ("1-2-3", -4.0),
        ("2**3**2", 64.0),
        ("--4", 4.0),
        ("[[[[1]]]]", 1.0),
        ("3>2", 1.0),
        ("3<2", 0.0),
        ("2==2", 1.0),
        ("2!=2", 0.0),
        ("2<>3", 1.0),
        ("2<=2", 1.0),
        ("3>=4", 0.0),
        ("1 AND 0", 0.0),
        ("1 OR 0", 1.0),
        ("1 XOR 1", 0.0),
        ("NOT 0", 1.0),
        ("1+1==2 AND 2<3", 1.0),
        ("SQRT[ABS[-16]]", 4.0),
        ("INT[-2.7]", -2.0),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn nc_007_deep_expressions_have_a_limit() {
    let nested = |depth: usize| format!("P1={}1{}", "[".repeat(depth), "]".repeat(depth));
    assert!(decode(&nested(24)).error.is_none());
    assert_eq!(crate::nc_decode::error(&nested(25)).kind, glidepath::nc::NcErrorKind::ExpressionTooDeep);
}

#[test]
fn nc_008_for_loops() {
    let passes = |head: &str| xs(&format!("G0\n$FOR P1 = {head}\nXP1\n$ENDFOR")).len();
    assert_eq!(passes("0, 90, 7.5"), 13);
    assert_eq!(passes("270, 370, 7.5"), 14);
    assert_eq!(passes("1, 64, 1"), 64);
    assert_eq!(passes("3, 1, -1"), 3);
    assert_eq!(passes("3, 1, 1"), 0);
    assert_eq!(passes("1, 1, 1"), 1);
    assert_eq!(passes("1, 3"), 3);
    assert_eq!(xs("G0 P3=3\n$FOR P1=1, P3, 1\nX[P1*P3]\n$ENDFOR"), [3.0, 6.0, 9.0]);
    assert_eq!(
        xs("G0\n$FOR P1=1,2,1\n$FOR P2=1,2,1\nX[P1*10+P2]\n$ENDFOR\n$ENDFOR"),
        [11.0, 12.0, 21.0, 22.0]
    );
}

#[test]
fn nc_008_for_with_step_zero_is_endless_with_a_warning() {
    let text = "G0 P9=0\n$FOR P1=1,0,0\nP9=P9+1\nXP9\n$IF P9==50\n$BREAK\n$ENDIF\n$ENDFOR";
    let decoded = decode(text);
    assert_eq!(decoded.commands.len(), 50);
    assert_eq!(decoded.warnings[0].kind, NcWarningKind::EndlessFor);
    let (out, _, error, steps) = decode_with(setup(), b"$FOR P1=1,2,0\n$ENDFOR", 5000);
    assert!(out.is_empty() && error.is_none() && steps == 5000, "still Working");
}

/// G-11: a condition is true from 0.5 on, in every word that asks one.
#[test]
fn conditions_are_true_from_one_half_on() {
    for (value, holds) in [("0.5", true), ("0.4999999", false), ("0", false), ("-1", false), ("0.75", true)] {
        let x = if holds { vec![1.0, 3.0] } else { vec![2.0, 3.0] };
        assert_eq!(xs(&format!("G0\n$IF {value}\nX1\n$ELSE\nX2\n$ENDIF\nX3")), x, "$IF {value}");
        assert_eq!(
            xs(&format!("G0\n$IF 0\n$ELSEIF {value}\nX1\n$ELSE\nX2\n$ENDIF\nX3")),
            x,
            "$ELSEIF {value}"
        );
        let once = if holds { vec![1.0, 3.0] } else { vec![3.0] };
        assert_eq!(
            xs(&format!("G0\nP1={value}\n$WHILE P1\nX1\nP1=0\n$ENDWHILE\nX3")),
            once,
            "$WHILE {value}"
        );
    }
    assert_eq!(xs("G0 P1=0\n$REPEAT\nP1=P1+0.25 XP1\n$UNTIL P1"), [0.25, 0.5], "$UNTIL");
    assert_eq!(value("[0.5 AND 0.5]"), 1.0);
}

/// G-11.
#[test]
fn control_blocks() {
    let x = |text: &str| xs(&format!("G0\n{text}"));
    let branch = "$IF P1==1\nX1\n$ELSEIF P1==2\nX2\n$IF 1\nX22\n$ENDIF\n$ELSEIF P1==2\nX9\n$ELSE\nX3\n$ENDIF";
    assert_eq!(x(&format!("P1=1\n{branch}")), [1.0]);
    assert_eq!(x(&format!("P1=2\n{branch}")), [2.0, 22.0]);
    assert_eq!(x(&format!("P1=7\n{branch}")), [3.0]);
    assert_eq!(x("P1=0\n$WHILE P1<3\nP1=P1+1\nXP1\n$ENDWHILE"), [1.0, 2.0, 3.0]);
    assert_eq!(x("$WHILE 0\nX1\n$WHILE 1\n$ENDWHILE\n$ENDWHILE\nX2"), [2.0]);
    assert_eq!(x("P1=0\n$DO\nP1=P1+1\nXP1\n$ENDDO P1 <= 2"), [1.0, 2.0, 3.0]);
    assert_eq!(x("P1=0\n$REPEAT\nP1=P1+1\nXP1\n$UNTIL P1 > 2"), [1.0, 2.0, 3.0]);
    let switch = "$CASE 1\nX1\n$BREAK\n$CASE 1+1\nX2\n$CASE 3\nX3\n$BREAK\n$DEFAULT\nX4\n$ENDSWITCH\nX5";
    assert_eq!(x(&format!("$SWITCH 1\n{switch}")), [1.0, 5.0]);
    assert_eq!(x(&format!("$SWITCH 2.0005\n{switch}")), [2.0, 3.0, 5.0], "equal up to 0.001, no $BREAK");
    assert_eq!(x(&format!("P2=3\n$SWITCH P1=INT[P2*1.2]\n{switch}")), [3.0, 5.0]);
    assert_eq!(x(&format!("$SWITCH -1\n{switch}")), [4.0, 5.0]);
    assert_eq!(
        x("$FOR P1=1,5,1\n$IF P1==2\n$CONTINUE\n$ENDIF\n$IF P1==4\n$BREAK\n$ENDIF\nXP1\n$ENDFOR\nX9"),
        [1.0, 3.0, 9.0]
    );
    assert_eq!(
        x("$FOR P1=1,2,1\n$IF P1==2\n$CONTINUE\n$ENDIF\nXP1\n$ENDFOR\nX9"),
        [1.0, 9.0],
        "$CONTINUE in the last pass"
    );
    assert_eq!(x("P1=0\n$DO\nP1=P1+1\n$IF P1==1\n$CONTINUE\n$ENDIF\nXP1\n$ENDDO P1<3"), [2.0, 3.0]);
    assert_eq!(x("$FOR P1=1,2,1\n$WHILE 1\n$BREAK\n$ENDWHILE\nXP1\n$ENDFOR"), [1.0, 2.0]);
}

/// G-11.
#[test]
fn jumps() {
    let x = |text: &str| xs(&format!("G0\n{text}"));
    assert_eq!(x("X1\n$GOTO N20\nX2\nN20: X3"), [1.0, 3.0]);
    assert_eq!(x("P1=0\n[AGAIN]\nP1=P1+1\nXP1\n$IF P1<3 $GOTO [AGAIN]\nX9"), [1.0, 2.0, 3.0, 9.0]);
    assert_eq!(
        x("$FOR P1=1,9,1\nXP1\n$IF P1==2 $GOTO N5\n$ENDFOR\nN5: X9"),
        [1.0, 2.0, 9.0],
        "out of a block"
    );
    assert_eq!(
        x("$FOR P1=1,2,1\n$IF 1\n$GOTO [SKIP]\n$ENDIF\nX5\n[SKIP]\nXP1\n$ENDFOR"),
        [1.0, 2.0],
        "inside a block"
    );
    let local = "%L s\nN5: G0 X1\nM29\n%main\nLL s\n$GOTO N5\nX2\nN5: X3\nM30";
    assert_eq!(xs(local), [1.0, 3.0], "labels belong to their program");
}

/// G-11.
#[test]
fn nesting_has_limits() {
    let nest = |n: usize| format!("{}{}", "$IF 1\n".repeat(n), "$ENDIF\n".repeat(n));
    assert!(decode(&nest(20)).error.is_none());
    assert_eq!(crate::nc_decode::error(&nest(21)).kind, glidepath::nc::NcErrorKind::NestingTooDeep);
    let skipped = format!("$IF 0\n{}$ENDIF\nG0 X1", nest(300));
    assert_eq!(xs(&skipped), [1.0], "what is passed over may be deeper");
}

#[test]
fn parameters_have_a_limit() {
    let fill = |n: usize| (1..=n).map(|i| format!("P{}={i}\n", 7 * i % 1009 + 1)).collect::<String>();
    assert!(decode(&fill(128)).error.is_none());
    assert_eq!(crate::nc_decode::error(&fill(129)).kind, glidepath::nc::NcErrorKind::TooManyParameters);
    let text = format!("{}G0 XP8 YP1", (1..=100).rev().map(|i| format!("P{i}={i}\n")).collect::<String>());
    assert_eq!(ends(&text)[0].1, [8.0, 1.0, 0.0]);
}
