//! Rows NC-009 and NC-010 and every # command, G word and axis command of the inventory: typed, with keywords and ranges.
mod nc_decode;
use glidepath::nc::*;
use glidepath::quantity::Position;
use nc_decode::{commands, decode, error};

fn mm(x: f64) -> Option<Position> {
    // To nearest, as the decoder rounds.
    Some(Position::from_bits((x * 4_294_967_296.0).round() as i64))
}

fn one(text: &str) -> Command<5> {
    let out = commands(text);
    assert_eq!(out.len(), 1, "{text}: {out:?}");
    out[0]
}

fn contour(text: &str) -> Contour {
    match one(&format!("#CONTOUR MODE {text}")) {
        Command::Contour(_, contour) => contour,
        other => panic!("{other:?}"),
    }
}

fn hsc(text: &str) -> Hsc {
    match one(&format!("#HSC {text}")) {
        Command::Hsc(_, hsc) => hsc,
        other => panic!("{other:?}"),
    }
}

fn slope(text: &str) -> Slope {
    match one(text) {
        Command::Slope(_, slope) => slope,
        other => panic!("{other:?}"),
    }
}

fn filter(text: &str) -> Filter {
    match one(&format!("#FILTER {text}")) {
        Command::Filter(_, filter) => filter,
        other => panic!("{other:?}"),
    }
}

fn limit(text: &str) -> VectorLimit {
    match one(&format!("#VECTOR LIMIT {text}")) {
        Command::VectorLimit(_, limit) => limit,
        other => panic!("{other:?}"),
    }
}

fn oscillation(text: &str) -> Oscillation {
    match one(text) {
        Command::Oscillation(_, oscillation) => oscillation,
        other => panic!("{other:?}"),
    }
}

/// Every keyword outside its range, and inside at both ends: (text around `{}`, outside, inside).
fn ranges(rows: &[(&str, &[&str], &[&str])]) {
    for (pattern, outside, inside) in rows {
        for value in *outside {
            let text = pattern.replace("{}", value);
            let kind = error(&text).kind;
            assert!(matches!(kind, NcErrorKind::Range { .. } | NcErrorKind::NotWhole(_)), "{text}: {kind:?}");
        }
        for value in *inside {
            let text = pattern.replace("{}", value);
            let refused = decode(&text).error;
            assert_eq!(refused, None, "{text}");
        }
    }
}

#[test]
fn contour_switches_d3_015_to_017_and_059_to_061() {
    let switch = |text: &str| {
        commands(text)
            .iter()
            .find_map(|c| if let Command::Contour(h, c) = c { Some((h.in_motion, c.switch)) } else { None })
    };
    assert_eq!(switch("F1 X1 G61"), Some((true, Some(ContourSwitch::Block))));
    assert_eq!(switch("G261"), Some((false, Some(ContourSwitch::On))));
    assert_eq!(switch("F1 G260 X1"), Some((true, Some(ContourSwitch::Off))));
    assert_eq!(contour("ON").switch, Some(ContourSwitch::On));
    assert_eq!(contour("OFF").switch, Some(ContourSwitch::Off));
    let on = contour("ON [DEV PATH_DEV=1.0]");
    assert_eq!(
        (on.switch, on.method, on.path_dev),
        (Some(ContourSwitch::On), Some(ContourMethod::Dev), mm(1.0))
    );
}

#[test]
fn contour_methods_d3_062_to_088() {
    let c = contour(
        "[DEV, PATH_DEV 5, RELEVANT_PATH 2 TRACK_DEV=1 RELEVANT_TRACK=0.2 REMAIN_PART=10 CHECK_JERK=2 MAX_ANGLE=73 CONST_VEL=1, POST_ACTION]",
    );
    let expected = Contour {
        method: Some(ContourMethod::Dev),
        action: Some(ContourAction::Post),
        path_dev: mm(5.0),
        relevant_path: mm(2.0),
        track_dev: mm(1.0),
        relevant_track: mm(0.2),
        remain_part: mm(10.0),
        check_jerk: Some(2),
        max_angle: mm(73.0),
        const_vel: Some(true),
        ..Contour::default()
    };
    assert_eq!(c, expected);
    assert_eq!(
        contour("[CHECK_JERK=1]"),
        Contour { check_jerk: Some(1), ..Contour::default() },
        "single keywords"
    );
    assert_eq!(contour("[PRE_ACTION]").action, Some(ContourAction::Pre));
    assert_eq!(contour("[INTER_ACTION]").action, Some(ContourAction::Inter));
}

#[test]
fn contour_dist_d3_090_to_103() {
    let c = contour("[DIST PRE_DIST=10 POST_DIST=5]");
    assert_eq!((c.method, c.pre_dist, c.post_dist), (Some(ContourMethod::Dist), mm(10.0), mm(5.0)));
}

#[test]
fn contour_pos_d3_105_to_114() {
    let c = contour("[POS PRE_DIST=2 POST_DIST=0 X110 Y-10 Z0]");
    assert_eq!((c.method, c.pre_dist, c.post_dist), (Some(ContourMethod::Pos), mm(2.0), mm(0.0)));
    assert_eq!(c.point, [mm(110.0), mm(-10.0), mm(0.0)]);
    match commands("P1=4 G92 X100\n#CONTOUR MODE [POS XP1 Y=P1*2]")[..] {
        [Command::Contour(_, c)] => assert_eq!(c.point, [mm(104.0), mm(8.0), None], "offsets count"),
        ref other => panic!("{other:?}"),
    }
    let e = error("#CONTOUR MODE [POS TRACK_DEV=1]");
    assert_eq!(e.kind, NcErrorKind::KeywordMismatch { with: "POS" });
}

#[test]
fn contour_dynamic_methods_d3_117_to_148() {
    let c = contour(
        "[DIST_SOFT PATH_DIST=-1 TRACK_DIST=12 ACC_MAX=90 ACC_MIN=40 RAMP_TIME=10000 DIST_WEIGHT=100]",
    );
    assert_eq!((c.method, c.path_dist, c.track_dist), (Some(ContourMethod::DistSoft), mm(-1.0), mm(12.0)));
    assert_eq!(
        (c.acc_max, c.acc_min, c.ramp_time, c.dist_weight),
        (mm(90.0), mm(40.0), mm(10_000.0), mm(100.0))
    );
    let c = contour("[DIST_MASTER SYM_DIST=3 ACC_MAX=50]");
    assert_eq!((c.method, c.sym_dist), (Some(ContourMethod::DistMaster), mm(3.0)));
    let c = contour("[PTP PATH_DEV=5 PATH_DIST=6 MERGE=0 INTER_ACTION]");
    assert_eq!(
        (c.method, c.path_dev, c.path_dist, c.merge),
        (Some(ContourMethod::Ptp), mm(5.0), mm(6.0), Some(false))
    );
}

#[test]
fn contour_ranges() {
    ranges(&[
        ("#CONTOUR MODE [PATH_DEV={}]", &["-0.001", "100001"], &["0", "100000"]),
        ("#CONTOUR MODE [TRACK_DEV={}]", &["-1", "361"], &["0", "360"]),
        ("#CONTOUR MODE [REMAIN_PART={}]", &["-1", "100.1"], &["0", "100"]),
        ("#CONTOUR MODE [CHECK_JERK={}]", &["-1", "3", "0.5"], &["0", "1", "2"]),
        ("#CONTOUR MODE [CONST_VEL={}]", &["2", "-1"], &["0", "1"]),
        ("#CONTOUR MODE [MAX_ANGLE={}]", &["-1", "181"], &["0", "178"]),
        ("#CONTOUR MODE [PATH_DIST={}]", &["-2", "-0.5"], &["-1", "0"]),
        ("#CONTOUR MODE [TRACK_DIST={}]", &["-2"], &["-1", "0"]),
        ("#CONTOUR MODE [SYM_DIST={}]", &["-2"], &["-1", "0"]),
        ("#CONTOUR MODE [ACC_MAX={}]", &["101"], &["100"]),
        ("#CONTOUR MODE [ACC_MIN={}]", &["101"], &["0"]),
        ("#CONTOUR MODE [RAMP_TIME={}]", &["10001"], &["0", "10000"]),
        ("#CONTOUR MODE [DIST_WEIGHT={}]", &["101", "-1"], &["0", "100"]),
        ("#CONTOUR MODE [MERGE={}]", &["2"], &["1"]),
    ]);
}

#[test]
fn hsc_surface_d3_161_to_173() {
    let h = hsc(
        "ON [SURFACE PATH_DEV=0.02 PATH_DEV_G00=1 TRACK_DEV=3 TRACK_DEV_G00=4 MAX_ANGLE=150 CHECK_JERK=0 AUTO_OFF_G00=1 CIR_MODE=2 CIR_MIN_ANGLE=40 CIR_MIN_RADIUS=0.5 MERGE=1 LENGTH_LONG_CIR=3]",
    );
    let expected = Hsc {
        switch: Some(true),
        method: Some(HscMethod::Surface),
        path_dev: mm(0.02),
        path_dev_g00: mm(1.0),
        track_dev: mm(3.0),
        track_dev_g00: mm(4.0),
        max_angle: mm(150.0),
        check_jerk: Some(0),
        auto_off_g00: Some(true),
        cir_mode: Some(2),
        cir_min_angle: mm(40.0),
        cir_min_radius: mm(0.5),
        merge: Some(true),
        length_long_cir: mm(3.0),
        ..Hsc::default()
    };
    assert_eq!(h, expected);
    assert_eq!(hsc("[SURFACE PATH_DEV 0.1]").switch, None, "parameters before ON");
    assert_eq!(hsc("ON"), Hsc { switch: Some(true), ..Hsc::default() });
    assert_eq!(hsc("OFF"), Hsc { switch: Some(false), ..Hsc::default() });
    assert_eq!(hsc("ON[SURFACE PATH_DEV 0.1]").method, Some(HscMethod::Surface), "no blank");
    let first = error("#HSC ON [PATH_DEV=1 SURFACE]").kind;
    assert_eq!(first, NcErrorKind::KeywordMismatch { with: "a keyword before it" });
    assert_eq!(
        error("#HSC [SURFACE AUTO_OFF_PATH=1]").kind,
        NcErrorKind::KeywordMismatch { with: "SURFACE" }
    );
}

#[test]
fn hsc_bspline_d3_183_to_192() {
    let h = hsc(
        "ON [BSPLINE PATH_DEV=0.2 TRACK_DEV=0 MERGE=1 AUTO_OFF_PATH=1 AUTO_OFF_TRACK=0 AUTO_OFF_G00=1 AUTO_OFF_G60=1 MAX_PATH_LENGTH=9 MAX_ANGLE=100]",
    );
    let expected = Hsc {
        switch: Some(true),
        method: Some(HscMethod::Bspline),
        path_dev: mm(0.2),
        track_dev: mm(0.0),
        merge: Some(true),
        auto_off_path: Some(true),
        auto_off_track: Some(false),
        auto_off_g00: Some(true),
        auto_off_g60: Some(true),
        max_path_length: mm(9.0),
        max_angle: mm(100.0),
        ..Hsc::default()
    };
    assert_eq!(h, expected);
    assert_eq!(error("#HSC [BSPLINE CIR_MODE=1]").kind, NcErrorKind::KeywordMismatch { with: "BSPLINE" });
}

#[test]
fn hsc_old_modes_gaps_2() {
    let h = hsc("ON [OPMODE=2 CONTERROR=0.05]");
    assert_eq!((h.method, h.conterror), (Some(HscMethod::Op(2)), mm(0.05)));
}

#[test]
fn hsc_ranges() {
    ranges(&[
        ("#HSC [SURFACE PATH_DEV={}]", &["0", "-1", "100001"], &["0.001"]),
        ("#HSC [BSPLINE PATH_DEV={}]", &["-1"], &["0"]),
        ("#HSC [SURFACE CIR_MODE={}]", &["3"], &["0", "2"]),
        ("#HSC [SURFACE CHECK_JERK={}]", &["3"], &["2"]),
        ("#HSC [SURFACE MAX_ANGLE={}]", &["-1", "181"], &["160"]),
        ("#HSC [SURFACE LENGTH_LONG_CIR={}]", &["0"], &["2"]),
        ("#HSC [BSPLINE AUTO_OFF_G60={}]", &["2"], &["1"]),
        ("#HSC [OPMODE={}]", &["0", "3"], &["1", "2"]),
    ]);
}

#[test]
fn slope_d3_201_to_207() {
    for (text, kind) in [
        ("STEP", SlopeType::Step),
        ("TRAPEZ", SlopeType::Trapez),
        ("SIN2", SlopeType::Sin2),
        ("HSC", SlopeType::Hsc),
    ] {
        assert_eq!(slope(&format!("#SLOPE [TYPE={text}]")), Slope { kind: Some(kind), ..Slope::default() });
    }
    assert_eq!(
        slope("#SLOPE[TYPE=HSC NO_OPT=0]"),
        Slope { kind: Some(SlopeType::Hsc), no_opt: Some(false), default: false }
    );
    assert_eq!(slope("#SLOPE DEFAULT"), Slope { default: true, ..Slope::default() });
    assert_eq!(slope("#SET SLOPE PROFIL [1]").kind, Some(SlopeType::Trapez));
    assert_eq!(slope("#SET SLOPE PROFIL [TYPE=SIN2]").kind, Some(SlopeType::Sin2));
    ranges(&[
        ("#SLOPE [TYPE=HSC NO_OPT={}]", &["2"], &["1"]),
        ("#SET SLOPE PROFIL [{}]", &["4"], &["0", "3"]),
    ]);
    assert_eq!(error("#SLOPE [TYPE=LINEAR]").kind, NcErrorKind::Expected("STEP, TRAPEZ, SIN2 or HSC"));
}

#[test]
fn filter_d3_223_to_230() {
    let f = filter("ON [ORDER=20 ORDER_TIME=5000 SHARE=80 AX_DEV=0.01 FCUT=25 ACC_FACT=2.5 QUALITY=0.5]");
    let expected = Filter {
        switch: Some(true),
        order: Some(20),
        order_time_us: mm(5000.0),
        share: mm(80.0),
        ax_dev: mm(0.01),
        fcut: mm(25.0),
        acc_fact: mm(2.5),
        quality: mm(0.5),
        hsc: false,
    };
    assert_eq!(f, expected);
    assert_eq!(filter("OFF").switch, Some(false));
    assert_eq!(filter("[SHARE 50]").switch, None);
    assert!(filter("ON [HSC]").hsc, "old form");
    ranges(&[
        ("#FILTER [ORDER={}]", &["201"], &["0", "200"]),
        ("#FILTER [SHARE={}]", &["101"], &["100"]),
        ("#FILTER [FCUT={}]", &["0.5"], &["1"]),
        ("#FILTER [ACC_FACT={}]", &["0.9", "10.1"], &["1", "10"]),
        ("#FILTER [QUALITY={}]", &["0", "1.1"], &["0.1", "1"]),
        ("#FILTER [AX_DEV={}]", &["-1"], &["0"]),
    ]);
}

#[test]
fn vector_limit_d3_215_gaps_4() {
    let l = limit("ON [ACC=500 DEC VEL=1500 FEED RAPID]");
    assert_eq!(l.acc, mm(500.0).map(Limit::Is));
    assert_eq!((l.dec, l.vel), (Some(Limit::Channel), mm(1500.0).map(Limit::Is)));
    assert!(l.on && l.feed && l.rapid && !l.all);
    assert!(limit("ON ALL").all);
    let off = limit("OFF [ACC] [VEL]");
    assert_eq!(
        (off.on, off.acc, off.dec, off.vel),
        (false, Some(Limit::Channel), None, Some(Limit::Channel))
    );
    assert!(limit("OFF ALL").all);
    let more = limit("ON [RADIAL_ACC=1 RADIAL_JERK=2 JERK=3 TRANS_ACC=4]");
    assert_eq!((more.radial_acc, more.trans_acc), (mm(1.0).map(Limit::Is), mm(4.0).map(Limit::Is)));
    ranges(&[("#VECTOR LIMIT ON [ACC={}]", &["0", "-5"], &["0.1", "2000000000"])]);
}

#[test]
fn splines_gaps_3() {
    let spline = |text: &str| match one(text) {
        Command::Spline(_, spline) => spline,
        other => panic!("{other:?}"),
    };
    assert_eq!(spline("G151"), Spline::On);
    assert_eq!(spline("G150"), Spline::Off);
    assert_eq!(spline("#SPLINE ON"), Spline::On);
    assert_eq!(spline("#SET SPLINE OFF"), Spline::Off);
    assert_eq!(spline("#SPLINE TYPE BSPLINE"), Spline::Type(SplineType::Bspline));
    assert_eq!(spline("#SET SPLINETYPE AKIMA"), Spline::Type(SplineType::Akima));
    let ends = Spline::Transition { start: Some(Tangent::Tangential), end: Some(Tangent::User) };
    assert_eq!(spline("#AKIMA TRANS [START=TANGENTIAL END=USER]"), ends);
    assert_eq!(spline("#SET ASPLINE MODE [2,3]"), ends);
    assert_eq!(
        spline("#AKIMA TRANS [END=AUTO]"),
        Spline::Transition { start: None, end: Some(Tangent::Auto) }
    );
    assert_eq!(
        spline("#AKIMA STARTVECTOR X1 Y-0.5 C2"),
        Spline::StartVector([mm(1.0), mm(-0.5), None, None, mm(2.0)])
    );
    assert_eq!(spline("#AKIMA ENDVECTOR Z=1"), Spline::EndVector([None, None, mm(1.0), None, None]));
}

#[test]
fn weights_d3_208_to_214_and_259() {
    let weight = |text: &str| match one(text) {
        Command::Weight(_, weight) => weight,
        other => panic!("{other:?}"),
    };
    let w = weight("G130 X50 Y75 Z75");
    assert_eq!(w.kind, WeightKind::Acceleration);
    assert_eq!(w.percent, [mm(50.0), mm(75.0), mm(75.0), None, None]);
    assert_eq!(weight("G132 X75").kind, WeightKind::RampTime);
    assert_eq!(weight("G232 Y10").percent[1], mm(10.0));
    for (text, kind) in [
        ("G131 50", WeightKind::AccelerationAll),
        ("G131 = 50", WeightKind::AccelerationAll),
        ("G133 50", WeightKind::RampTimeAll),
        ("G134=50", WeightKind::GeometricRampTime),
        ("G231 50", WeightKind::RapidAcceleration),
        ("G233 50", WeightKind::RapidRampTimeAll),
        ("G338 50", WeightKind::G338),
        ("G339 50", WeightKind::G339),
    ] {
        let w = weight(text);
        assert_eq!((w.kind, w.percent), (kind, [mm(50.0); 5]), "{text}");
        assert_eq!(w.kind.name(), &text[..4]);
    }
    assert_eq!(commands("G131 = 50 G0 X1").len(), 2, "positions may share the block");
    ranges(&[("G131 {}", &["0", "-1", "10001"], &["0.1", "200", "10000"]), ("G130 X{}", &["0"], &["150"])]);
}

#[test]
fn kinematics_gaps_11() {
    let kinematics = |text: &str| match one(text) {
        Command::Kinematics(_, kinematics) => kinematics,
        other => panic!("{other:?}"),
    };
    assert_eq!(kinematics("#KIN ID[9]"), Kinematics::Select(9));
    assert_eq!(kinematics("#TRAFO ON"), Kinematics::On);
    assert_eq!(kinematics("#TRAFO OFF"), Kinematics::Off);
    assert_eq!(kinematics("#TRAFO [9]"), Kinematics::OnWith(9));
    ranges(&[("#KIN ID [{}]", &["0", "70000", "-1"], &["1", "65535"])]);
}

#[test]
fn axis_exchange_d3_156() {
    assert!(matches!(one("#PUT AX [Z]"), Command::PutAxes(_, 0b00100)));
    assert!(matches!(one("#PUT AX [X, C]"), Command::PutAxes(_, 0b10001)));
    assert!(matches!(one("#PUT AX ALL"), Command::PutAxes(_, 0b11111)));
    assert!(matches!(one("#CALL AX [Z,3,2][Y,2,1]"), Command::CallAxes(_, 0b00110)));
    assert_eq!(error("#PUT AX [B]").kind, NcErrorKind::AxisNotHere);
}

#[test]
fn contour_log_c40_042_to_046() {
    let log = |text: &str| match one(text) {
        Command::ContourLog(_, log) => log,
        other => panic!("{other:?}"),
    };
    assert_eq!(log("#CONTOUR LOOKAHEAD LOG ON"), ContourLog::On(None));
    assert_eq!(log("#CONTOUR LOOKAHEAD LOG ON [PARAM=1]"), ContourLog::On(Some(1.0)));
    assert_eq!(log("#CONTOUR LOOKAHEAD LOG OFF [PARAM=8]"), ContourLog::Off(Some(8.0)));
    assert_eq!(log("#CONTOUR LOOKAHEAD LOG CLEAR"), ContourLog::Clear);
    assert_eq!(log("#CONTOUR LOOKAHEAD CLEAR"), ContourLog::Clear, "CF-27");
    assert_eq!(log("#CONTOUR LOOKAHEAD LOG [PARAM=-2.5]"), ContourLog::Parameter(-2.5));
}

#[test]
fn distance_and_loops_c40_015_and_048() {
    assert!(matches!(one("#DISTANCE PROG START CLEAR"), Command::DistanceClear(_)));
    assert!(matches!(one("#DISTANCE PROGRAM START CLEAR"), Command::DistanceClear(_)));
    assert!(matches!(one("#FLUSH&WAIT"), Command::FlushWait(_)));
    assert!(matches!(one("#RT WHILE"), Command::RtWhile(_, false)));
    assert!(matches!(one("#RT WHILE [MODULO]"), Command::RtWhile(_, true)));
    assert!(matches!(one("#RT WHILE MODULO"), Command::RtWhile(_, true)));
    assert!(matches!(one("#RT ENDWHILE"), Command::RtEndWhile(_)));
}

#[test]
fn oscillation_on_a8_019_to_040() {
    let on = |text: &str| match oscillation(text).action {
        OscillationAction::On { first, second, speed, first_wait, second_wait, count, short } => {
            (first, second, speed, first_wait, second_wait, count, short)
        }
        other => panic!("{other:?}"),
    };
    let p = |x: f64| mm(x).unwrap();
    let feed = OscillationSpeed::Feed(p(1000.0));
    let expected = (p(-100.0), p(100.0), feed, p(0.0), p(0.0), None, false);
    assert_eq!(on("X[OSC ON 1ST_POS=-100 2ND_POS=100 FEED=1000]"), expected);
    assert_eq!(on("X[OSC ON ZERO_POS=0 EXCUR=100 FEED 1000]"), expected, "zero position and excursion, no =");
    assert_eq!(on("X[OSC ON ZERO_POS=0 EXCUR=100 FREQ=1 NBR_OSC=10]").5, Some(10));
    assert_eq!(on("X[OSC ON ZERO_POS=0 EXCUR=100 TIME=4]").2, OscillationSpeed::Period(p(4.0)));
    assert_eq!(on("X[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=0.5]").2, OscillationSpeed::Frequency(p(0.5)));
    let waits = on("X[OSC ON 1ST_POS=-100 1ST_DELT=0.5 2ND_POS=200 \\\n  2ND_DELT=0.25 FEED=1000]");
    assert_eq!((waits.3, waits.4), (p(0.5), p(0.25)));
    let short = on("C[OSC ON 1ST_POS=10 2ND_POS=350 FEED=1000 SHORT]");
    assert_eq!((short.0, short.1, short.6), (p(10.0), p(350.0), true));
    assert_eq!(oscillation("C[OSC OFF]").axis, 4);
    match commands(
        "G92 X10\nX[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=1 INCL_OFFSETS]\nX[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=1]",
    )[..]
    {
        [Command::Oscillation(_, a), Command::Oscillation(_, b)] => {
            assert!(matches!(a.action, OscillationAction::On { first, .. } if first == 11));
            assert!(matches!(b.action, OscillationAction::On { first, .. } if first == 1));
        }
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn oscillation_off_a8_018_to_024() {
    assert_eq!(oscillation("X[OSC OFF]").action, OscillationAction::Off);
    assert_eq!(oscillation("X[OSC OFF FEED=5000]").action, OscillationAction::OffFeed(mm(5000.0).unwrap()));
    assert_eq!(oscillation("X[OSC OFF INSTANT]").action, OscillationAction::OffInstant);
    let out = nc_decode::motions("X[OSC ON 1ST_POS=-1 2ND_POS=7 FREQ=1]\nX[OSC OFF]\nG91 G0 X1");
    assert_eq!(out[0].target[0], 8, "the axis stands on position 2");
}

#[test]
fn oscillation_refused_a8_039_and_043() {
    assert_eq!(error("X[OSC ON 1ST_POS=1 2ND_POS=2]").kind.id(), 50593);
    assert_eq!(error("C[OSC ON 1ST_POS=-1 2ND_POS=2 FREQ=1 SHORT]").kind.id(), 22277);
    for text in [
        "X[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=1 TIME=2]",
        "X[OSC ON 1ST_POS=1 FREQ=1]",
        "X[OSC ON 1ST_POS=1 2ND_POS=2 ZERO_POS=1 EXCUR=2 FREQ=1]",
        "X[OSC ON 1ST_POS=1 2ND_POS=1 FREQ=1]",
        "X[OSC FREQ=1]",
        "X[OSC ON OFF]",
        "X[OSC OFF FREQ=1]",
        "X[OSC OFF INSTANT FEED=1]",
        "X[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=0]",
        "X[OSC ON 1ST_POS=100001 2ND_POS=2 FREQ=1]",
        "X[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=1] Y5",
        "G0 X[OSC OFF]",
    ] {
        error(text);
    }
}

#[test]
fn independent_axes_d3_271() {
    match one("X[INDP_ASYN G01 G90 POS=100 FEED=500 SLOPE_TYPE=TRAPEZ]") {
        Command::Independent(_, i) => {
            assert_eq!((i.axis, i.synchronous, i.rapid, i.relative), (0, false, false, false));
            assert_eq!((i.position, i.feed, i.slope), (mm(100.0), mm(500.0), Some(SlopeType::Trapez)));
        }
        other => panic!("{other:?}"),
    }
    assert!(
        matches!(one("Y[INDP_SYN G00 G91 POS=1]"), Command::Independent(_, i) if i.synchronous && i.rapid && i.relative)
    );
}

#[test]
fn feed_modes_and_exact_stop_gaps_6_and_11() {
    assert!(matches!(one("G93"), Command::FeedMode(_, FeedMode::Time)));
    assert!(matches!(one("G95"), Command::FeedMode(_, FeedMode::PerRevolution)));
    assert!(matches!(one("G194"), Command::FeedMode(_, FeedMode::Percent)));
    assert!(matches!(one("E500"), Command::EndFeed(_)));
    assert!(matches!(one("G360"), Command::ExactStop(_, ExactStop::On)));
    assert!(matches!(one("G359"), Command::ExactStop(_, ExactStop::Off)));
    assert!(matches!(commands("G60 G0 X1")[0], Command::ExactStop(_, ExactStop::Block)));
}

#[test]
fn every_command_knows_its_place_and_name() {
    for command in commands(include_str!("../programs/nc/everything.nc")) {
        assert!(
            command.place().line > 0 && command.place().column > 0 && command.place().length > 0,
            "{command:?}"
        );
        assert!(!command.name().is_empty());
    }
}

#[test]
fn sizes() {
    let setup = std::mem::size_of::<Setup<3>>();
    let decoder = std::mem::size_of::<Decoder<&[u8], 3>>() + std::mem::size_of::<DecoderMemory<3>>();
    let parameters = PARAMETERS * 16;
    println!(
        "decoder {decoder}, of it parameters {parameters}, setup {setup}; command {}",
        std::mem::size_of::<Command<3>>()
    );
    // Of it 1.6 kB for a line that goes on in the next call.
    assert!(decoder - parameters <= 8 * 1024);
}
