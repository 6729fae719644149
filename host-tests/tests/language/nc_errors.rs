//! Malformed programs, each with its message and place: program, line, column, length, message.
use crate::nc_decode::{decode, decode_with, error, setup};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::nc::{NcErrorKind, Setup, Text, TextError};
use glidepath::quantity::Position;

const TABLE: &[(&str, u32, u32, u16, &str)] = &[
    ("X1 Q5", 1, 4, 1, "axis Q is known, not available on this machine (axes X, Y, Z, A, C)"),
    ("B10", 1, 1, 1, "axis B is known, not available on this machine (axes X, Y, Z, A, C)"),
    ("G01\nX1\nY2 C5 V3", 2, 1, 2, "motion without feed: expected F before G01, G02 or G03"),
    ("G01 X10", 1, 1, 3, "motion without feed: expected F before G01, G02 or G03"),
    ("G02 X10 F100", 1, 1, 3, "arc without centre or radius: expected I, J, K or R"),
    (
        "N10 G01 X0 Y0 F100\nN20 G02 X10 I5 R5",
        2,
        13,
        2,
        "arc by centre and radius: expected either I, J, K or R",
    ),
    ("F100 G02 X0 Y0 R5", 1, 6, 3, "full circle by radius: expected I, J, K"),
    ("F100 G02 X1 K5", 1, 13, 2, "\"K5\" is outside of the plane: expected the plane's I, J, K"),
    ("G0 X1 I5", 1, 7, 2, "\"I5\" without arc: expected G02 or G03"),
    ("G04 X1 Y2 I3", 1, 11, 2, "\"I3\" without arc: expected G02 or G03"),
    ("G04", 1, 1, 3, "missing in \"G04\": expected a time in seconds"),
    ("G04 X-1", 1, 5, 3, "time of G04 out of range, \"X-1\": expected 0 to 100000 s"),
    ("G04 S-1", 1, 5, 3, "dwell out of range, \"S-1\": expected 0 to 100000 revolutions"),
    (
        "P1=1e10",
        1,
        4,
        4,
        "\"1e10\" has an exponent: expected digits and a point, or a blank before end feed E",
    ),
    (
        "G0 X1.5E-3",
        1,
        5,
        6,
        "\"1.5E-3\" has an exponent: expected digits and a point, or a blank before end feed E",
    ),
    ("G04 2 X3", 1, 7, 2, "\"X3\": time of G04 given twice in this block"),
    ("G1 X1 F600 F700", 1, 12, 4, "\"F700\": F given twice in this block"),
    ("G0 X1 X2", 1, 7, 2, "\"X2\": axis given twice in this block"),
    ("G0 G01 X1", 1, 4, 3, "\"G01\": G word of this group given twice in this block"),
    ("G90 G91", 1, 5, 3, "\"G91\": G word of this group given twice in this block"),
    ("G0 X100000.1", 1, 4, 9, "coordinate out of range, \"X100000.1\": expected -100000 to 100000 mm"),
    ("G0 X-100001", 1, 4, 8, "coordinate out of range, \"X-100001\": expected -100000 to 100000 mm"),
    ("G91 G0 X60000\nX60000", 2, 1, 6, "coordinate out of range, \"X60000\": expected -100000 to 100000 mm"),
    ("F0", 1, 1, 2, "F out of range, \"F0\": expected above 0 to 2147483647 mm/min"),
    ("F-5", 1, 1, 3, "F out of range, \"F-5\": expected above 0 to 2147483647 mm/min"),
    ("F", 1, 2, 0, "end of line: expected a number, P, a function or ["),
    ("F1 X", 1, 5, 0, "end of line: expected a number, P, a function or ["),
    ("G01 X10.5.2 F1", 1, 10, 2, "unexpected \".2\": expected an address such as G, X, F or M"),
    ("X1 F1 G60\nG60", 2, 1, 3, "G60 without motion: expected axis positions in its block"),
    ("G999", 1, 1, 4, "unknown G word \"G999\": expected a G word of the language"),
    ("G1.5", 1, 1, 4, "unknown G word \"G1.5\": expected a G word of the language"),
    ("G41", 1, 1, 3, "G word \"G41\" is known, not available in this version"),
    ("GX", 1, 2, 1, "unexpected \"X\": expected G number"),
    ("M1000", 1, 1, 5, "M out of range, \"M1000\": expected 0 to 999"),
    ("M-1", 1, 1, 3, "M out of range, \"M-1\": expected 0 to 999"),
    ("M1.5", 1, 1, 4, "\"M1.5\" has a fraction: expected a whole number for M"),
    ("H1000", 1, 1, 5, "H out of range, \"H1000\": expected 0 to 999"),
    ("O100", 1, 1, 4, "unknown word \"O100\": expected an address or an axis (X, Y, Z, A, C)"),
    ("X10 N5", 1, 5, 2, "unexpected \"N5\": expected N first in its block"),
    ("N-5", 1, 1, 3, "block number out of range, \"N-5\": expected 0 to 4294967295"),
    ("N4294967296", 1, 1, 11, "block number out of range, \"N4294967296\": expected 0 to 4294967295"),
    ("?", 1, 1, 1, "unexpected \"?\": expected an address such as G, X, F or M"),
    ("X1 Y2 ) ", 1, 7, 1, "unexpected \")\": expected an address such as G, X, F or M"),
    ("P0=5", 1, 1, 2, "parameter index in \"P0\": expected a whole number above 0"),
    ("P1 5", 1, 4, 1, "unexpected \"5\": expected = behind the parameter"),
    ("P1=", 1, 4, 0, "end of line: expected a number, P, a function or ["),
    ("X=P7", 1, 3, 2, "parameter P7 has no value yet"),
    ("P1=P2+1", 1, 4, 2, "parameter P2 has no value yet"),
    ("P1=1/0", 1, 4, 3, "division by zero in \"1/0\""),
    ("P1=SQRT[-1]", 1, 4, 8, "argument outside the domain of SQRT in \"SQRT[-1]\""),
    ("P1=FOO[1]", 1, 4, 3, "unknown function \"FOO\": expected SIN, COS, TAN, SQRT …"),
    ("P1=SIN 5", 1, 8, 1, "unexpected \"5\": expected [ after the function"),
    ("P1=[1+2", 1, 8, 0, "end of line: expected ] or an operator"),
    ("P1=1+2]", 1, 7, 1, "unexpected \"]\": expected an address such as G, X, F or M"),
    ("P1=SIN[1,2]", 1, 4, 8, "unexpected \"SIN[1,2]\": expected one argument, two for ATAN2, MIN and MAX"),
    (
        "P1=V.E.FOO",
        1,
        4,
        7,
        "no variable V.E.FOO: expected V.E. and a name of the application (up to 8 in a line), V.P., V.L., V.RTG.LOOP.ENABLED, V.G.BLOCK_NR, V.G.FEEDRATE or V.G.M_FCT[n].SYNCH",
    ),
    (
        "V.E.FOO=5",
        1,
        1,
        7,
        "no variable V.E.FOO: expected V.E. and a name of the application (up to 8 in a line), V.P., V.L., V.RTG.LOOP.ENABLED, V.G.BLOCK_NR, V.G.FEEDRATE or V.G.M_FCT[n].SYNCH",
    ),
    ("\"MACRO\"", 1, 1, 7, "macro \"\"MACRO\"\" is known, not available in this version"),
    ("P1=\"A\"", 1, 4, 3, "macro \"\"A\"\" is known, not available in this version"),
    ("P5[2]=1", 1, 1, 2, "array of P parameters \"P5\" is known, not available in this version"),
    ("/2 X1", 1, 1, 1, "block skip \"/\" is known, not available in this version"),
    ("L sub.nc", 1, 3, 6, "no file \"sub.nc\" to call: expected the name of a program file"),
    ("L \"my sub\"", 1, 4, 6, "no file \"my sub\" to call: expected the name of a program file"),
    ("L", 1, 2, 0, "end of line: expected a blank and a file name after L"),
    ("L \"\"", 1, 4, 1, "unexpected \"\"\": expected a file name after L"),
    ("L \"sub", 1, 7, 0, "end of line: expected \" behind the file name"),
    ("L sub X1", 1, 7, 2, "unexpected \"X1\": expected L alone in its block"),
    ("LL sub", 1, 4, 3, "subroutine \"sub\" does not stand before the main program: expected %L sub there"),
    ("LLsub", 1, 3, 3, "unexpected \"sub\": expected a blank and a name after LL"),
    ("LL", 1, 3, 0, "end of line: expected a blank and a name after LL"),
    ("%L s\nM29\n%main\nLL s X1", 4, 6, 2, "unexpected \"X1\": expected LL alone in its block"),
    ("%L a\nM29\n%L a\nM29\n%main", 3, 4, 1, "subroutine \"a\" is declared twice"),
    ("%L a\nX1\nM29", 3, 4, 0, "no main program: expected a head % without L"),
    ("%L\n%main", 1, 3, 0, "end of line: expected a name after %L"),
    ("$FOO", 1, 1, 4, "unknown statement \"$FOO\": expected a $ statement of the language"),
    ("$FOR X=1,2,1\n$ENDFOR", 1, 6, 1, "counter \"X\" of $FOR: expected a P parameter"),
    ("$FOR P1=1\n$ENDFOR", 1, 10, 0, "end of line: expected , and the end value"),
    ("$FOR P1=1,2,1", 1, 1, 4, "\"$FOR\" without $ENDFOR"),
    ("$FOR P1=1,2,1\n$ENDIF", 2, 1, 6, "\"$ENDIF\" without $IF"),
    ("$ENDFOR", 1, 1, 7, "\"$ENDFOR\" without $FOR"),
    ("$ENDIF", 1, 1, 6, "\"$ENDIF\" without $IF"),
    ("$ELSE", 1, 1, 5, "\"$ELSE\" without $IF"),
    ("$UNTIL 1", 1, 1, 6, "\"$UNTIL\" without $REPEAT"),
    ("$CASE 1", 1, 1, 5, "\"$CASE\" without $SWITCH"),
    ("$BREAK", 1, 1, 6, "\"$BREAK\" outside of a loop"),
    ("$CONTINUE", 1, 1, 9, "\"$CONTINUE\" outside of a loop"),
    ("$IF\n$ENDIF", 1, 4, 0, "end of line: expected a number, P, a function or ["),
    ("$IF 1 X5\n$ENDIF", 1, 7, 2, "unexpected \"X5\": expected a $ statement alone in its block"),
    ("$IF 0\nX1", 1, 1, 3, "\"$IF\" without $ENDIF"),
    ("$IF 1\nM30", 1, 1, 3, "\"$IF\" without $ENDIF"),
    ("$WHILE 1\n$IF 1\nM30\n$ENDIF\nX1", 1, 1, 6, "\"$WHILE\" without $ENDWHILE"),
    ("$WHILE 1\n$IF 1\nM30\n$ENDWHILE\nX1", 4, 1, 9, "\"$ENDWHILE\" without $WHILE"),
    ("%L s\n$REPEAT\nM17\n%m\nLL s\n$UNTIL 1", 2, 1, 7, "\"$REPEAT\" without $UNTIL"),
    ("$SWITCH 1\n$CASE 1\nM2", 1, 1, 7, "\"$SWITCH\" without $ENDSWITCH"),
    ("$FOR P1=1,2\n$DO\nX1 F1 M30", 2, 1, 3, "\"$DO\" without $ENDDO"),
    ("N10 $WHILE 1\n  N20 $IF 1\n", 2, 7, 3, "\"$IF\" without $ENDIF"),
    ("$GOTO N10", 1, 7, 3, "label \"N10\" is not in this program"),
    ("$GOTO", 1, 6, 0, "end of line: expected N and a block number, or [NAME]"),
    ("$GOTO X", 1, 7, 1, "unexpected \"X\": expected N and a block number, or [NAME]"),
    (
        "$GOTO N10\n$IF 1\nN10: X1\n$ENDIF",
        3,
        1,
        3,
        "jump into a control block, to \"N10\" is known, not available in this version",
    ),
    ("#FOO", 1, 1, 4, "unknown command \"#FOO\": expected a # command of the language"),
    ("#CONTOUR", 1, 1, 8, "unknown command \"#CONTOUR\": expected a # command of the language"),
    ("#CONTOUR MODE", 1, 14, 0, "end of line: expected [ and keywords"),
    (
        "#CONTOUR MODE [DEV PATH_DIV=5]",
        1,
        20,
        8,
        "unknown keyword \"PATH_DIV\" in #CONTOUR MODE: expected DEV, DIST, POS, DIST_SOFT, DIST_MASTER, PTP, PRE_ACTION, INTER_ACTION, POST_ACTION, PATH_DEV, TRACK_DEV, RELEVANT_PATH, RELEVANT_TRACK, REMAIN_PART, CHECK_JERK, MAX_ANGLE, CONST_VEL, PRE_DIST, POST_DIST, PATH_DIST, TRACK_DIST, SYM_DIST, ACC_MAX, ACC_MIN, RAMP_TIME, DIST_WEIGHT, MERGE, X, Y, Z",
    ),
    (
        "#CONTOUR MODE [DEV PATH_DEV=-5]",
        1,
        20,
        11,
        "value out of range, \"PATH_DEV=-5\": expected 0 to 100000 mm",
    ),
    ("#CONTOUR MODE [DEV PATH_DEV]", 1, 28, 1, "unexpected \"]\": expected a number, P, a function or ["),
    ("#CONTOUR MODE [DEV PATH_DEV=5", 1, 30, 0, "end of line: expected ]"),
    ("#CONTOUR MODE [DEV DIST]", 1, 20, 4, "keyword \"DIST\" does not go with DEV"),
    ("#CONTOUR MODE [DEV DEV]", 1, 20, 3, "\"DEV\": keyword given twice in this block"),
    (
        "#CONTOUR MODE [DIST_SOFT PATH_DIST=-2]",
        1,
        26,
        12,
        "value out of range, \"PATH_DIST=-2\": expected 0 to 100000 mm, or -1",
    ),
    ("F100 G02 X5 R0", 1, 13, 2, "unexpected \"R0\": expected a radius that is not 0"),
    ("#SPLINE", 1, 8, 0, "end of line: expected ON, OFF, TYPE AKIMA or TYPE BSPLINE"),
    ("#WAIT INDP[]", 1, 11, 2, "unexpected \"[]\": expected at least one axis in brackets"),
    (
        "#HSC ON SURFACE",
        1,
        9,
        7,
        "unexpected \"SURFACE\": expected [ and keywords, or nothing behind the switch",
    ),
    ("#CONTOUR MODE [PATH_DEV=1 PATH_DEV=2]", 1, 27, 8, "\"PATH_DEV\": keyword given twice in this block"),
    ("#CONTOUR MODE [DEV PRE_DIST=1]", 1, 20, 8, "keyword \"PRE_DIST\" does not go with DEV"),
    ("#CONTOUR MODE [CHECK_JERK=3]", 1, 16, 12, "value out of range, \"CHECK_JERK=3\": expected 0 to 2"),
    (
        "#CONTOUR MODE [CONST_VEL=0.5]",
        1,
        16,
        13,
        "\"CONST_VEL=0.5\" has a fraction: expected a whole number for it",
    ),
    ("#CONTOUR MODE [DEV] X5", 1, 21, 2, "unexpected \"X5\": expected a # command alone in its block"),
    (
        "#HSC ON SURFACE",
        1,
        9,
        7,
        "unexpected \"SURFACE\": expected [ and keywords, or nothing behind the switch",
    ),
    (
        "#CONTOUR MODE ON DEV",
        1,
        18,
        3,
        "unexpected \"DEV\": expected [ and keywords, or nothing behind the switch",
    ),
    ("#FILTER ON X", 1, 12, 1, "unexpected \"X\": expected [ and keywords, or nothing behind the switch"),
    ("#HSC ON [PATH_DEV=1 SURFACE]", 1, 21, 7, "keyword \"SURFACE\" does not go with a keyword before it"),
    (
        "#HSC [SURFACE PATH_DEV=0]",
        1,
        15,
        10,
        "value out of range, \"PATH_DEV=0\": expected above 0 to 100000 mm",
    ),
    ("#SLOPE", 1, 7, 0, "end of line: expected [ and keywords"),
    ("#SLOPE [TYPE=FAST]", 1, 14, 4, "unexpected \"FAST\": expected STEP, TRAPEZ, SIN2 or HSC"),
    ("#FILTER [ACC_FACT=11]", 1, 10, 11, "value out of range, \"ACC_FACT=11\": expected 1 to 10"),
    ("#HSC [OPMODE=3]", 1, 6, 10, "OPMODE out of range, \"[OPMODE=3]\": expected 1 to 2"),
    ("#VECTOR LIMIT ON", 1, 17, 0, "end of line: expected ALL or [ and limits"),
    (
        "#VECTOR LIMIT ON [SPEED=5]",
        1,
        19,
        5,
        "unknown keyword \"SPEED\" in #VECTOR LIMIT: expected ACC, DEC, VEL, RADIAL_ACC, RADIAL_JERK, JERK, TRANS_ACC, FEED, RAPID, ALL",
    ),
    ("#AKIMA TRANS [START=SOON]", 1, 21, 4, "unexpected \"SOON\": expected AUTO, TANGENTIAL or USER"),
    (
        "#AKIMA STARTVECTOR B1",
        1,
        20,
        2,
        "axis B1 is known, not available on this machine (axes X, Y, Z, A, C)",
    ),
    ("#KIN ID[0]", 1, 9, 1, "kinematic out of range, \"0\": expected 1 to 65535"),
    ("#TRAFO", 1, 7, 0, "end of line: expected [ and the number of a kinematic"),
    ("#PUT AX", 1, 8, 0, "end of line: expected [ and axes"),
    ("#PUT AX [B]", 1, 10, 1, "axis B is known, not available on this machine (axes X, Y, Z, A, C)"),
    ("#PUT AX []", 1, 9, 2, "unexpected \"[]\": expected at least one axis in brackets"),
    ("#CONTOUR LOOKAHEAD LOG", 1, 23, 0, "end of line: expected [ and keywords"),
    ("#RT WHILE [FOREVER]", 1, 12, 7, "unexpected \"FOREVER\": expected MODULO"),
    ("#CS ON [1,2,3]", 1, 1, 6, "command \"#CS ON\" is known, not available in this version"),
    ("X[OSC ON 1ST_POS=1 2ND_POS=2]", 1, 1, 29, "oscillation speed not defined: expected FEED, FREQ or TIME"),
    (
        "X[OSC ON 1ST_POS=1 2ND_POS=2 SPEED=5]",
        1,
        30,
        5,
        "unknown keyword \"SPEED\" in OSC: expected ON, OFF, INSTANT, FEED, FREQ, TIME, 1ST_POS, 2ND_POS, ZERO_POS, EXCUR, 1ST_DELT, 2ND_DELT, NBR_OSC, INCL_OFFSETS, SHORT",
    ),
    (
        "X[OSC 1ST_POS=1 2ND_POS=2 FREQ=1]",
        1,
        1,
        33,
        "missing in \"X[OSC 1ST_POS=1 2ND_POS=\": expected ON or OFF",
    ),
    ("G130", 1, 1, 4, "missing in \"G130\": expected axis weights in percent"),
    ("G131", 1, 1, 4, "missing in \"G131\": expected a weight in percent"),
    ("G131 0", 1, 1, 6, "weight out of range, \"G131 0\": expected above 0 to 10000 %"),
    ("G130 X0", 1, 6, 2, "weight out of range, \"X0\": expected above 0 to 10000 %"),
    ("G92", 1, 1, 3, "missing in \"G92\": expected axis offsets"),
    ("G04 G92 X1", 1, 5, 3, "\"G92\" cannot stand in one block with another use of its axis words"),
    ("X1 F1 \\ Y2", 1, 9, 1, "unexpected \"Y\": expected the end of the line after \\"),
    ("G0 X99999999999999999999", 1, 5, 20, "result too large in \"99999999999999999999\""),
    (
        "F9\nN1 G1 X10*45",
        2,
        10,
        3,
        "\"*45\" at the end of a numbered line is a checksum: expected a line without one, or brackets around arithmetic",
    ),
    (
        "N2 G0 X=-1.5*7 ",
        1,
        13,
        2,
        "\"*7\" at the end of a numbered line is a checksum: expected a line without one, or brackets around arithmetic",
    ),
];

/// G-13.
#[test]
fn every_refusal_has_its_message_and_place() {
    for (program, line, column, length, message) in TABLE {
        let error = error(program);
        assert_eq!(error.to_string(), *message, "{program}");
        assert_eq!(
            (error.place.line, error.place.column, error.place.length),
            (*line, *column, *length),
            "{program}"
        );
        let start = error.place.offset as usize;
        assert!(program.is_char_boundary(start) && start + (*length as usize) <= program.len(), "{program}");
    }
}

/// G-13.
#[test]
fn ids_of_isg() {
    for (program, id) in [
        ("X1 F1\nG60", 20003),
        ("G0 X1 X1", 20013),
        ("$FOR X=1,2,1", 20227),
        ("$ENDFOR", 20232),
        ("$ENDSWITCH", 20225),
        ("P0=1", 20400),
        ("F1 G02 X0 R1", 20034),
        ("F1 G02 X1 I1 R1", 21024),
        ("X[OSC ON 1ST_POS=1 2ND_POS=2]", 50593),
        ("C[OSC ON 1ST_POS=400 2ND_POS=2 FREQ=1 SHORT]", 22277),
    ] {
        assert_eq!(error(program).kind.id(), id, "{program}");
    }
}

#[test]
fn axes_of_a_small_machine() {
    let axes = ["X", "Y", "Z"].map(|name| AxisData::new(AxisName::new(name).unwrap(), AxisKind::Linear));
    let setup = Setup::new(&MachineData { axes, channel: ChannelData::new() }, [Position::ZERO; 3]);
    let (_, _, error, _) = decode_with(setup, b"N10 G01 X1 C5 F100", 100);
    let error = error.unwrap();
    assert_eq!(error.to_string(), "axis C is known, not available on this machine (axes X, Y, Z)");
    assert_eq!((error.place.line, error.place.column, error.place.length), (1, 12, 1));
}

#[test]
fn planes_need_their_axes() {
    let axes = ["X", "Y"].map(|name| AxisData::new(AxisName::new(name).unwrap(), AxisKind::Linear));
    let setup = Setup::new(&MachineData { axes, channel: ChannelData::new() }, [Position::ZERO; 2]);
    let (_, _, error, _) = decode_with(setup, b"F1 G18 G02 X1 I1", 100);
    assert_eq!(error.unwrap().to_string(), "\"G02\" needs a main axis this machine lacks (axes X, Y)");
}

#[test]
fn axis_names_of_two_letters() {
    let axes = ["X", "X1", "Z2"].map(|name| AxisData::new(AxisName::new(name).unwrap(), AxisKind::Linear));
    let setup = Setup::new(&MachineData { axes, channel: ChannelData::new() }, [Position::ZERO; 3]);
    let (out, _, error, _) = decode_with(setup, b"G0 X10 X1=20 Z2[30]", 100);
    assert_eq!(error, None);
    assert!(
        matches!(out[..], [glidepath::nc::Command::Motion(m)] if m.target == [10, 20, 30].map(Position::from_num))
    );
}

#[test]
fn bytes_that_are_no_text() {
    let at = |bytes: &[u8]| {
        let (_, _, error, _) = decode_with(setup(), bytes, 1000);
        let error = error.unwrap();
        (error.to_string(), error.place.line, error.place.column)
    };
    assert_eq!(at(b"G0 X1\nX\x002"), ("byte 0x00 in the program: expected text".into(), 2, 2));
    assert_eq!(at(b"G0 X1 (\0)"), ("byte 0x00 in the program: expected text".into(), 1, 8));
    assert_eq!(at(b"\x1bX1"), ("byte 0x1b in the program: expected text".into(), 1, 1));
    assert_eq!(at(b"G0 X\xff1"), ("byte 0xff outside of a comment: expected ASCII text".into(), 1, 5));
    assert_eq!(
        at("G0 X\u{fc}".as_bytes()),
        ("byte 0xc3 outside of a comment: expected ASCII text".into(), 1, 5)
    );
    let (out, _, error, _) = decode_with(setup(), b"G0 X1 (\xff\xfe)", 1000);
    assert!(error.is_none() && out.len() == 1, "comments may hold other bytes");
}

#[test]
fn long_lines() {
    let error_of = |text: &str| {
        let error = error(text);
        (error.to_string(), error.place.line, error.place.column)
    };
    let long = format!("G0 X1\nP1=1{}", "+1".repeat(5000));
    assert_eq!(error_of(&long), ("line too long: expected at most 512 bytes".into(), 2, 513));
    let fits = format!("P1=1{}", "+1".repeat(254));
    assert_eq!(fits.len(), 512);
    assert_eq!(decode(&fits).error, None);
    assert_eq!(error_of(&format!("{fits}+")), ("line too long: expected at most 512 bytes".into(), 1, 513));
    let parts = format!("P1=1{}", " \\\n+1".repeat(13));
    assert_eq!(error_of(&parts).0, "too many continuation lines: expected at most 12");
}

#[test]
fn truncated_programs() {
    let program = "%L s\n$IF 1\nG0 X1\n$ENDIF\nM29\n%main\nLL s\n$FOR P1=1,2,1\n#CONTOUR MODE [DEV PATH_DEV=5]\n$ENDFOR\nM30";
    assert_eq!(decode(program).error, None);
    assert_eq!(error("%L s\n$IF 1\nG0 X1\n%main\nLL s").to_string(), "\"$IF\" without $ENDIF");
    assert_eq!(error("%L s\n$IF 1\nG0 X1\n%main\nLL s").place.line, 2);
    assert_eq!(decode(program.strip_suffix("M30").unwrap()).error, None, "the end of the text is an end");
}

#[test]
fn limits_are_named() {
    let many: String = (0..65).map(|i| format!("%L s{i}\nM29\n")).collect();
    assert_eq!(error(&format!("{many}%main")).to_string(), "too many local subroutines: expected at most 64");
    assert_eq!(error("%L s\nLL s\nM29\n%main\nLL s").kind, NcErrorKind::CallTooDeep);
    let words: String = (0..17).map(|i| format!("M{} ", 100 + i)).collect();
    assert_eq!(error(&words).to_string(), "too many words in a block: expected at most 16");
    assert_eq!(
        error(&format!("%L {}\n%main", "n".repeat(84))).to_string(),
        "name too long: expected at most 83 characters"
    );
    assert_eq!(decode(&format!("%L {}\nM29\n%main\n", "n".repeat(83))).error, None);
}

/// NC-008.
#[test]
fn programs_end_inside_control_blocks_that_are_closed() {
    for text in [
        "$WHILE 1\n$IF 1\nG0 X1 M30\n$ENDIF\nX2\n$ENDWHILE\nX3 ? not read",
        "%L s\n$IF 1\nG0 X1\nM17\n$IF 0\n$ENDIF\nX7\n$ENDIF\nX9\nM17\n%m\n$IF 1\nLL s\n$ENDIF\nM30",
    ] {
        assert_eq!(crate::nc_decode::ends(text).len(), 1, "{text}");
        assert_eq!(crate::nc_decode::ends(text)[0].1[0], 1.0, "{text}");
    }
}

/// NC-008.
#[test]
fn endless_loops_without_a_command() {
    let lines = glidepath::nc::QUIET_LINES;
    let texts = ["G0 X1\n$WHILE 1\n(x)\n$ENDWHILE", "$DO\nP1=1\n$ENDDO 1", "N1: P1=1\n$GOTO N1"];
    for text in texts {
        let (_, _, error, steps) = decode_with(setup(), text.as_bytes(), 4 * lines as usize);
        let error = error.unwrap_or_else(|| panic!("{steps} steps: {text}"));
        assert_eq!(error.kind, NcErrorKind::Endless, "{text}");
        assert!(error.to_string().contains("1000000 lines"), "{error}");
    }
    // Passing over lines and counting to the bound are no loops without end.
    let text = format!("$FOR P1=1,{},1\n$ENDFOR\nM30", lines - 10);
    assert_eq!(decode_with(setup(), text.as_bytes(), 4 * lines as usize).2, None);
}

/// NC-003.
#[test]
fn comments_without_an_end_are_told() {
    let warnings = |text: &str| {
        let decoded = decode(text);
        assert_eq!(decoded.error, None);
        let places = decoded.warnings.iter().map(|w| (w.to_string(), w.place.line, w.place.column));
        places.collect::<Vec<_>>()
    };
    let message = || "comment without ): it ends with its line".to_owned();
    assert_eq!(
        warnings("G0 X1 (a (b) c\nX2 (d)\n((e)\r\nX3 (end"),
        [(message(), 1, 7), (message(), 3, 1), (message(), 4, 4)]
    );
    assert_eq!(warnings("G0 X1 ; (\n(a) X2 (b))X3".strip_suffix(")X3").unwrap_or("")), []);
}

/// Message, line and column of every warning of a program that is not refused.
fn told(text: &str) -> Vec<(String, u32, u16)> {
    let decoded = decode(text);
    assert_eq!(decoded.error, None, "{text}");
    decoded.warnings.iter().map(|w| (w.to_string(), w.place.line, w.place.column as u16)).collect()
}

/// NC-007.
#[test]
fn arithmetic_between_plain_numbers_names_its_result() {
    let message = |value: &str| {
        format!(
            "arithmetic between plain numbers: the value is {value}; expected brackets around it, or a word less"
        )
    };
    for (text, column, value) in [
        ("G1 F9 X10 -5", 7, "5.000"),
        ("N1 G1 F9 X10 -5", 10, "5.000"),
        ("G0 X10*45", 4, "450.000"),
        ("G0 X=-1.5+1", 4, "-0.500"),
        ("G0 X1 Y7/2", 7, "3.500"),
        ("G0 X1/3", 4, "0.333"),
        ("G1 X1 F600 -100", 7, "500.000"),
    ] {
        assert_eq!(told(text), [(message(value), 1, column)], "{text}");
    }
    // The line after it is plain.
    assert_eq!(told("G1 F9 X10 -5\nX20\nX30 -1"), [(message("5.000"), 1, 7), (message("29.000"), 3, 1)]);
    let motion = crate::nc_decode::motions("G0 X10 -5");
    assert_eq!(motion[0].target[0], Position::from_num(5));
    for text in [
        "G0 X[10 -5]",
        "G0 X-10 Y+5 Z=-2",
        "P1=2*3 G0 X=P1*4",
        "N5 P1=2*3",
        "N1 P2=5\nN2 G0 X=P2*3",
        "N1 G0 X[1+2]*3",
        "N1 G0 X[2*3]",
        "G0 X SIN[30]*2",
        "$IF 2*3\nG0 X1\n$ENDIF",
    ] {
        assert_eq!(told(text), [], "{text}");
    }
}

#[test]
fn a_radius_without_an_arc_is_told() {
    let message = || "R without an arc does nothing here: it stays in force for G02 and G03".to_owned();
    assert_eq!(told("G0 X1 R5"), [(message(), 1, 7)]);
    assert_eq!(told("F9 G1 X1\nX2 R5\nG2 X4"), [(message(), 2, 4)]);
    assert_eq!(told("G4 X1 R5"), [(message(), 1, 7)]);
    assert_eq!(told("F9 G2 X1 R5\nX2 R5\nG3 X1 R5"), []);
}

/// NC-001.
#[test]
fn programs_that_end_early_are_told() {
    let ends = || "M17 or M29 ends the main program; expected M02 or M30 at its end".to_owned();
    assert_eq!(told("%m\nG0 X1\nX2 M17\nX3\nM30"), [(ends(), 3, 4)]);
    assert_eq!(told("G0 X1\nM29"), [(ends(), 2, 1)]);
    assert_eq!(told("%L s\nG0 X1\nM17\n%m\nLL s\nM30"), []);
    assert_eq!(told("%L s\nG0 X1\nM29\n%m\nLL s\nM29"), [(ends(), 6, 1)]);
    let head = || {
        "a program head ends the program of the words before it; expected % before the first word".to_owned()
    };
    assert_eq!(told("G0 X1\n%m\nG0 X2\nM30"), [(head(), 2, 1)]);
    assert_eq!(told("(a remark)\n%m\nG0 X2\nM30\n%n\nG0 X3"), []);
    assert_eq!(told("%m\nG0 X2\n%n\nG0 X3"), []);
    assert_eq!(told("G0 X2\nM30\n%n\nG0 X3"), []);
}

/// A8-036.
#[test]
fn short_of_a_linear_axis_is_told() {
    let message = || "SHORT of a linear axis does nothing; expected a modulo axis".to_owned();
    let line = "X[OSC ON 1ST_POS=1 2ND_POS=2 FEED=1000 SHORT]";
    assert_eq!(told(&format!("G0 X1\n  {line}")), [(message(), 2, 3)]);
    assert_eq!(told(&line.replace('X', "C")), []);
    assert_eq!(told(&line.replace(" SHORT", "")), []);
}

#[test]
fn shipped_programs_are_without_a_warning() {
    let directory = concat!(env!("CARGO_MANIFEST_DIR"), "/../programs");
    let mut read = 0;
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "nc") {
            let decoded = decode(&std::fs::read_to_string(&path).unwrap());
            assert_eq!(decoded.warnings, [], "{}", path.display());
            read += 1;
        }
    }
    assert!(read > 20, "{read}");
}

struct Broken;

impl Text for Broken {
    fn read(&mut self, _: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        if offset > 0 {
            return Err(TextError::Failed);
        }
        buffer[..3].copy_from_slice(b"G0\n");
        Ok(3)
    }
}

#[test]
fn a_text_that_cannot_be_read() {
    let mut memory = glidepath::nc::DecoderMemory::<5>::new();
    let mut decoder = glidepath::nc::Decoder::new(&mut memory, setup(), Broken);
    let error = loop {
        match decoder.step() {
            Ok(glidepath::nc::Step::End) => panic!("no end expected"),
            Ok(_) => {}
            Err(error) => break error,
        }
    };
    assert_eq!(error.to_string(), "the program text could not be read");
}
