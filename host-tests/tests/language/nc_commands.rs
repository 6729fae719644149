//! Rows NC-009 and NC-010 and every # command, G word and axis command of the inventory: typed, with keywords
//! and ranges.
use crate::nc_decode::{commands, decode, error};
use glidepath::nc::*;
use glidepath::quantity::Position;

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

/// Every keyword outside its range, and inside at both ends: (row, text around `{}`, outside, inside).
fn ranges(rows: &[(&str, &str, &[&str], &[&str])]) {
    for (row, pattern, outside, inside) in rows {
        for value in *outside {
            let text = pattern.replace("{}", value);
            let Some(refused) = decode(&text).error else { panic!("{row}: {text} is accepted") };
            let kind = refused.kind;
            let of_range = matches!(kind, NcErrorKind::Range { .. } | NcErrorKind::NotWhole(_));
            assert!(of_range, "{row}: {text}: {kind:?}");
        }
        for value in *inside {
            let text = pattern.replace("{}", value);
            let refused = decode(&text).error;
            assert_eq!(refused, None, "{row}: {text}");
        }
    }
}

/// One line for each row of the inventory: its id, a text, and what holds for the command that it becomes.
type Row<C> = (&'static str, &'static str, fn(&C) -> bool);

fn by_row<C: std::fmt::Debug>(read: impl Fn(&str) -> C, rows: &[Row<C>]) {
    for (row, text, holds) in rows {
        let command = read(text);
        assert!(holds(&command), "{row}: {text}: {command:?}");
    }
}

#[test]
fn contour_switches_by_row() {
    let switch = |text: &str| {
        commands(text)
            .iter()
            .find_map(|c| if let Command::Contour(h, c) = c { Some((h.in_motion, c.switch)) } else { None })
    };
    for (row, text, in_motion, expected) in [
        ("D3-015", "F1 X1 G61", true, Some(ContourSwitch::Block)),
        ("D3-016", "G261", false, Some(ContourSwitch::On)),
        ("D3-017", "F1 G260 X1", true, Some(ContourSwitch::Off)),
        ("D3-059", "#CONTOUR MODE [PATH_DEV=1]", false, None),
        ("D3-060", "#CONTOUR MODE ON", false, Some(ContourSwitch::On)),
        ("D3-061", "#CONTOUR MODE OFF", false, Some(ContourSwitch::Off)),
    ] {
        assert_eq!(switch(text), Some((in_motion, expected)), "{row}: {text}");
    }
    let on = contour("ON [DEV PATH_DEV=1.0]");
    assert_eq!(
        (on.switch, on.method, on.path_dev),
        (Some(ContourSwitch::On), Some(ContourMethod::Dev), mm(1.0))
    );
}

/// Every keyword becomes its own field, and nothing else changes.
#[test]
fn contour_keywords_by_row() {
    let none = Contour::default();
    let of = |method| Contour { method: Some(method), ..none };
    let (dev, dist, pos) = (of(ContourMethod::Dev), of(ContourMethod::Dist), of(ContourMethod::Pos));
    let (soft, master) = (of(ContourMethod::DistSoft), of(ContourMethod::DistMaster));
    let ptp = of(ContourMethod::Ptp);
    let action = |with: Contour, action| Contour { action: Some(action), ..with };
    use ContourAction::{Inter, Post, Pre};
    let both = Contour { path_dev: mm(5.0), relevant_path: mm(2.0), ..dev };
    for (row, text, expected) in [
        ("D3-005", "[PATH_DEV=0.25]", Contour { path_dev: mm(0.25), ..none }),
        ("D3-006", "[TRACK_DEV=0.25]", Contour { track_dev: mm(0.25), ..none }),
        ("D3-054", "[CHECK_JERK=2]", Contour { check_jerk: Some(2), ..none }),
        ("D3-057", "[CONST_VEL=1]", Contour { const_vel: Some(true), ..none }),
        ("D3-062", "[DEV]", dev),
        ("D3-063", "[DIST]", dist),
        ("D3-064", "[POS]", pos),
        ("D3-065", "[DIST_SOFT]", soft),
        ("D3-066", "[DIST_MASTER]", master),
        ("D3-067", "[PTP]", ptp),
        ("D3-068", "[PRE_ACTION]", action(none, Pre)),
        ("D3-069", "[INTER_ACTION]", action(none, Inter)),
        ("D3-070", "[POST_ACTION]", action(none, Post)),
        ("D3-072", "[DEV, PATH_DEV 5, RELEVANT_PATH=2]", both),
        ("D3-072", "[DEV PATH_DEV=5 RELEVANT_PATH 2]", both),
        ("D3-072", "[DEV,PATH_DEV = 5,,RELEVANT_PATH2]", both),
        ("D3-073", "[CHECK_JERK=1]", Contour { check_jerk: Some(1), ..none }),
        ("D3-080", "[DEV PATH_DEV=5]", Contour { path_dev: mm(5.0), ..dev }),
        ("D3-081", "[DEV RELEVANT_PATH=2]", Contour { relevant_path: mm(2.0), ..dev }),
        ("D3-082", "[DEV TRACK_DEV=1]", Contour { track_dev: mm(1.0), ..dev }),
        ("D3-083", "[DEV RELEVANT_TRACK=0.2]", Contour { relevant_track: mm(0.2), ..dev }),
        ("D3-084", "[DEV REMAIN_PART=10]", Contour { remain_part: mm(10.0), ..dev }),
        ("D3-085", "[DEV POST_ACTION]", action(dev, Post)),
        ("D3-086", "[DEV CHECK_JERK=2]", Contour { check_jerk: Some(2), ..dev }),
        ("D3-087", "[DEV MAX_ANGLE=73]", Contour { max_angle: mm(73.0), ..dev }),
        ("D3-088", "[DEV CONST_VEL=1]", Contour { const_vel: Some(true), ..dev }),
        ("D3-094", "[DIST PRE_DIST=10]", Contour { pre_dist: mm(10.0), ..dist }),
        ("D3-095", "[DIST POST_DIST=5]", Contour { post_dist: mm(5.0), ..dist }),
        ("D3-096", "[DIST RELEVANT_PATH=2]", Contour { relevant_path: mm(2.0), ..dist }),
        ("D3-097", "[DIST RELEVANT_TRACK=3]", Contour { relevant_track: mm(3.0), ..dist }),
        ("D3-098", "[DIST TRACK_DEV=4]", Contour { track_dev: mm(4.0), ..dist }),
        ("D3-099", "[DIST REMAIN_PART=5]", Contour { remain_part: mm(5.0), ..dist }),
        ("D3-100", "[DIST PRE_ACTION]", action(dist, Pre)),
        ("D3-101", "[DIST CHECK_JERK=0]", Contour { check_jerk: Some(0), ..dist }),
        ("D3-102", "[DIST MAX_ANGLE=90]", Contour { max_angle: mm(90.0), ..dist }),
        ("D3-103", "[DIST CONST_VEL=0]", Contour { const_vel: Some(false), ..dist }),
        ("D3-108", "[POS PRE_DIST=0]", Contour { pre_dist: mm(0.0), ..pos }),
        ("D3-109", "[POS POST_DIST=0]", Contour { post_dist: mm(0.0), ..pos }),
        ("D3-110", "[POS X110 Y-10 Z0]", Contour { point: [mm(110.0), mm(-10.0), mm(0.0)], ..pos }),
        ("D3-111", "[POS INTER_ACTION]", action(pos, Inter)),
        ("D3-112", "[POS CHECK_JERK=1]", Contour { check_jerk: Some(1), ..pos }),
        ("D3-113", "[POS CONST_VEL=1]", Contour { const_vel: Some(true), ..pos }),
        ("D3-117", "[DIST_SOFT PATH_DIST=-1]", Contour { path_dist: mm(-1.0), ..soft }),
        ("D3-118", "[DIST_SOFT TRACK_DIST=12]", Contour { track_dist: mm(12.0), ..soft }),
        ("D3-119", "[DIST_SOFT ACC_MAX=90]", Contour { acc_max: mm(90.0), ..soft }),
        ("D3-120", "[DIST_SOFT ACC_MIN=40]", Contour { acc_min: mm(40.0), ..soft }),
        ("D3-121", "[DIST_SOFT RAMP_TIME=10000]", Contour { ramp_time: mm(10_000.0), ..soft }),
        ("D3-122", "[DIST_SOFT DIST_WEIGHT=100]", Contour { dist_weight: mm(100.0), ..soft }),
        ("D3-133", "[DIST_MASTER SYM_DIST=3]", Contour { sym_dist: mm(3.0), ..master }),
        ("D3-134", "[DIST_MASTER ACC_MAX=50]", Contour { acc_max: mm(50.0), ..master }),
        ("D3-135", "[DIST_MASTER ACC_MIN=30]", Contour { acc_min: mm(30.0), ..master }),
        ("D3-136", "[DIST_MASTER RAMP_TIME=200]", Contour { ramp_time: mm(200.0), ..master }),
        ("D3-137", "[DIST_MASTER DIST_WEIGHT=20]", Contour { dist_weight: mm(20.0), ..master }),
        ("D3-144", "[PTP]", ptp),
        ("D3-145", "[PTP PATH_DEV=5]", Contour { path_dev: mm(5.0), ..ptp }),
        ("D3-146", "[PTP PATH_DIST=6]", Contour { path_dist: mm(6.0), ..ptp }),
        ("D3-147", "[PTP MERGE=0]", Contour { merge: Some(false), ..ptp }),
        ("D3-148", "[PTP INTER_ACTION]", action(ptp, Inter)),
        ("CF-24", "[PATH_DEV=1]", Contour { path_dev: mm(1.0), ..none }),
    ] {
        assert_eq!(contour(text), expected, "{row}: {text}");
    }
    match commands("P1=4 G92 X100\n#CONTOUR MODE [POS XP1 Y=P1*2]")[..] {
        [Command::Contour(_, c)] => assert_eq!(c.point, [mm(104.0), mm(8.0), None], "offsets count"),
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn contour_ranges() {
    ranges(&[
        ("D3-071", "#CONTOUR MODE [PATH_DEV={}]", &["-0.001", "100001"], &["0", "100000"]),
        ("D3-080", "#CONTOUR MODE [PATH_DEV={}]", &["-0.001", "100001"], &["0", "100000"]),
        ("D3-071", "#CONTOUR MODE [TRACK_DEV={}]", &["-1", "361"], &["0", "360"]),
        ("D3-082", "#CONTOUR MODE [TRACK_DEV={}]", &["-1", "361"], &["0", "360"]),
        ("D3-084", "#CONTOUR MODE [REMAIN_PART={}]", &["-1", "100.1"], &["0", "100"]),
        ("D3-086", "#CONTOUR MODE [CHECK_JERK={}]", &["-1", "3", "0.5"], &["0", "1", "2"]),
        ("D3-088", "#CONTOUR MODE [CONST_VEL={}]", &["2", "-1"], &["0", "1"]),
        ("D3-087", "#CONTOUR MODE [MAX_ANGLE={}]", &["-1", "181"], &["0", "178"]),
        ("D3-117", "#CONTOUR MODE [PATH_DIST={}]", &["-2", "-0.5"], &["-1", "0"]),
        ("D3-118", "#CONTOUR MODE [TRACK_DIST={}]", &["-2"], &["-1", "0"]),
        ("D3-133", "#CONTOUR MODE [SYM_DIST={}]", &["-2"], &["-1", "0"]),
        ("D3-119", "#CONTOUR MODE [ACC_MAX={}]", &["101"], &["100"]),
        ("D3-120", "#CONTOUR MODE [ACC_MIN={}]", &["101"], &["0"]),
        ("D3-121", "#CONTOUR MODE [RAMP_TIME={}]", &["10001"], &["0", "10000"]),
        ("D3-122", "#CONTOUR MODE [DIST_WEIGHT={}]", &["101", "-1"], &["0", "100"]),
        ("D3-147", "#CONTOUR MODE [MERGE={}]", &["2"], &["1"]),
    ]);
}

/// Every keyword becomes its own field, and nothing else changes.
#[test]
fn hsc_keywords_by_row() {
    let none = Hsc::default();
    let (surface, bspline) =
        (Hsc { method: Some(HscMethod::Surface), ..none }, Hsc { method: Some(HscMethod::Bspline), ..none });
    let yes = Some(true);
    for (row, text, expected) in [
        ("D3-005", "[SURFACE PATH_DEV=0.25]", Hsc { path_dev: mm(0.25), ..surface }),
        ("D3-006", "[BSPLINE TRACK_DEV=0.25]", Hsc { track_dev: mm(0.25), ..bspline }),
        ("D3-161", "ON[SURFACE]", Hsc { switch: yes, ..surface }),
        ("D3-162", "[SURFACE PATH_DEV=0.02]", Hsc { path_dev: mm(0.02), ..surface }),
        ("D3-163", "[SURFACE PATH_DEV_G00=1]", Hsc { path_dev_g00: mm(1.0), ..surface }),
        ("D3-164", "[SURFACE TRACK_DEV=3]", Hsc { track_dev: mm(3.0), ..surface }),
        ("D3-165", "[SURFACE TRACK_DEV_G00=4]", Hsc { track_dev_g00: mm(4.0), ..surface }),
        ("D3-166", "[SURFACE MAX_ANGLE=150]", Hsc { max_angle: mm(150.0), ..surface }),
        ("D3-167", "[SURFACE CHECK_JERK=0]", Hsc { check_jerk: Some(0), ..surface }),
        ("D3-168", "[SURFACE AUTO_OFF_G00=1]", Hsc { auto_off_g00: yes, ..surface }),
        ("D3-169", "[SURFACE CIR_MODE=2]", Hsc { cir_mode: Some(2), ..surface }),
        ("D3-170", "[SURFACE CIR_MIN_ANGLE=40]", Hsc { cir_min_angle: mm(40.0), ..surface }),
        ("D3-171", "[SURFACE CIR_MIN_RADIUS=0.5]", Hsc { cir_min_radius: mm(0.5), ..surface }),
        ("D3-172", "[SURFACE MERGE=1]", Hsc { merge: yes, ..surface }),
        ("D3-173", "[SURFACE LENGTH_LONG_CIR=3]", Hsc { length_long_cir: mm(3.0), ..surface }),
        ("D3-177", "[SURFACE PATH_DEV 0.1]", Hsc { path_dev: mm(0.1), ..surface }),
        ("D3-177", "ON", Hsc { switch: yes, ..none }),
        ("D3-177", "OFF", Hsc { switch: Some(false), ..none }),
        ("D3-183", "ON [BSPLINE]", Hsc { switch: yes, ..bspline }),
        ("D3-184", "[BSPLINE PATH_DEV=0]", Hsc { path_dev: mm(0.0), ..bspline }),
        ("D3-185", "[BSPLINE TRACK_DEV=0]", Hsc { track_dev: mm(0.0), ..bspline }),
        ("D3-186", "[BSPLINE MERGE=1]", Hsc { merge: yes, ..bspline }),
        ("D3-187", "[BSPLINE AUTO_OFF_PATH=1]", Hsc { auto_off_path: yes, ..bspline }),
        ("D3-188", "[BSPLINE AUTO_OFF_TRACK=0]", Hsc { auto_off_track: Some(false), ..bspline }),
        ("D3-189", "[BSPLINE AUTO_OFF_G00=1]", Hsc { auto_off_g00: yes, ..bspline }),
        ("D3-190", "[BSPLINE AUTO_OFF_G60=1]", Hsc { auto_off_g60: yes, ..bspline }),
        ("D3-191", "[BSPLINE MAX_PATH_LENGTH=9]", Hsc { max_path_length: mm(9.0), ..bspline }),
        ("D3-192", "[BSPLINE MAX_ANGLE=100]", Hsc { max_angle: mm(100.0), ..bspline }),
        ("D3-194", "[BSPLINE PATH_DEV 0.1]", Hsc { path_dev: mm(0.1), ..bspline }),
    ] {
        assert_eq!(hsc(text), expected, "{row}: {text}");
    }
    for (row, text) in
        [("D3-161", "#HSC ON [PATH_DEV=1 SURFACE]"), ("D3-183", "#HSC ON [PATH_DEV=1 BSPLINE]")]
    {
        let first = error(text).kind;
        assert_eq!(first, NcErrorKind::KeywordMismatch { with: "a keyword before it" }, "{row}");
    }
}

/// D3-235, G-02.
#[test]
fn hsc_old_modes() {
    let h = hsc("ON [OPMODE=2 CONTERROR=0.05]");
    assert_eq!((h.method, h.conterror), (Some(HscMethod::Op(2)), mm(0.05)));
}

#[test]
fn hsc_ranges() {
    ranges(&[
        ("D3-162", "#HSC [SURFACE PATH_DEV={}]", &["0", "-1", "100001"], &["0.001"]),
        ("D3-184", "#HSC [BSPLINE PATH_DEV={}]", &["-1"], &["0"]),
        ("D3-169", "#HSC [SURFACE CIR_MODE={}]", &["3"], &["0", "2"]),
        ("D3-167", "#HSC [SURFACE CHECK_JERK={}]", &["3"], &["2"]),
        ("D3-166", "#HSC [SURFACE MAX_ANGLE={}]", &["-1", "181"], &["160"]),
        ("D3-173", "#HSC [SURFACE LENGTH_LONG_CIR={}]", &["0"], &["2"]),
        ("D3-190", "#HSC [BSPLINE AUTO_OFF_G60={}]", &["2"], &["1"]),
        ("G-02", "#HSC [OPMODE={}]", &["0", "3"], &["1", "2"]),
    ]);
}

#[test]
fn slope_by_row() {
    // D3-201: both commands; D3-207: NO_OPT.
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
        ("D3-207", "#SLOPE [TYPE=HSC NO_OPT={}]", &["2"], &["1"]),
        ("D3-201", "#SET SLOPE PROFIL [{}]", &["4"], &["0", "3"]),
    ]);
    assert_eq!(error("#SLOPE [TYPE=LINEAR]").kind, NcErrorKind::Expected("STEP, TRAPEZ, SIN2 or HSC"));
}

#[test]
fn filter_by_row() {
    by_row(
        filter,
        &[
            ("D3-223", "ON", |f| f.switch == Some(true)),
            ("D3-223", "OFF", |f| f.switch == Some(false)),
            ("D3-224", "[ORDER=20]", |f| *f == Filter { order: Some(20), ..Filter::default() }),
            ("D3-225", "[ORDER_TIME=5000]", |f| {
                *f == Filter { order_time_us: mm(5000.0), ..Filter::default() }
            }),
            ("D3-226", "[SHARE=80]", |f| *f == Filter { share: mm(80.0), ..Filter::default() }),
            ("D3-227", "[AX_DEV=0.01]", |f| *f == Filter { ax_dev: mm(0.01), ..Filter::default() }),
            ("D3-228", "[FCUT=25]", |f| *f == Filter { fcut: mm(25.0), ..Filter::default() }),
            ("D3-229", "[ACC_FACT=2.5]", |f| *f == Filter { acc_fact: mm(2.5), ..Filter::default() }),
            ("D3-230", "[QUALITY=0.5]", |f| *f == Filter { quality: mm(0.5), ..Filter::default() }),
            ("CF-24", "[AX_DEV=1]", |f| f.ax_dev == mm(1.0)),
            ("G-01", "ON [HSC]", |f| f.hsc),
        ],
    );
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
        ("D3-224", "#FILTER [ORDER={}]", &["201"], &["0", "200"]),
        ("D3-226", "#FILTER [SHARE={}]", &["101"], &["100"]),
        ("D3-228", "#FILTER [FCUT={}]", &["0.5"], &["1"]),
        ("D3-229", "#FILTER [ACC_FACT={}]", &["0.9", "10.1"], &["1", "10"]),
        ("D3-230", "#FILTER [QUALITY={}]", &["0", "1.1"], &["0.1", "1"]),
        ("D3-227", "#FILTER [AX_DEV={}]", &["-1"], &["0"]),
    ]);
}

#[test]
fn vector_limit_d3_215() {
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
    ranges(&[("D3-215", "#VECTOR LIMIT ON [ACC={}]", &["0", "-5"], &["0.1", "2000000000"])]);
}

/// D3-235, G-03.
#[test]
fn splines() {
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
fn weights_by_row() {
    let weight = |text: &str| match one(text) {
        Command::Weight(_, weight) => weight,
        other => panic!("{other:?}"),
    };
    let w = weight("G130 X50 Y75 Z75");
    assert_eq!(w.kind, WeightKind::Acceleration, "D3-211");
    assert_eq!(w.percent, [mm(50.0), mm(75.0), mm(75.0), None, None], "D3-211");
    let w = weight("G132 X75");
    assert_eq!((w.kind, w.percent), (WeightKind::RampTime, [mm(75.0), None, None, None, None]), "D3-213");
    assert_eq!(weight("G232 Y10").percent[1], mm(10.0));
    for (row, text, kind) in [
        ("D3-212", "G131 50", WeightKind::AccelerationAll),
        ("D3-212", "G131 = 50", WeightKind::AccelerationAll),
        ("D3-214", "G133 50", WeightKind::RampTimeAll),
        ("D3-259", "G134=50", WeightKind::GeometricRampTime),
        ("G-05", "G231 50", WeightKind::RapidAcceleration),
        ("G-05", "G233 50", WeightKind::RapidRampTimeAll),
        ("G-05", "G338 50", WeightKind::G338),
        ("G-05", "G339 50", WeightKind::G339),
    ] {
        let w = weight(text);
        assert_eq!((w.kind, w.percent), (kind, [mm(50.0); 5]), "{row}: {text}");
        assert_eq!(w.kind.name(), &text[..4]);
    }
    assert_eq!(commands("G131 = 50 G0 X1").len(), 2, "positions may share the block");
    ranges(&[
        ("D3-212", "G131 {}", &["0", "-1", "10001"], &["0.1", "200", "10000"]),
        ("D3-211", "G130 X{}", &["0"], &["150"]),
    ]);
}

#[test]
fn kinematics() {
    let kinematics = |text: &str| match one(text) {
        Command::Kinematics(_, kinematics) => kinematics,
        other => panic!("{other:?}"),
    };
    assert_eq!(kinematics("#KIN ID[9]"), Kinematics::Select(9));
    assert_eq!(kinematics("#TRAFO ON"), Kinematics::On);
    assert_eq!(kinematics("#TRAFO OFF"), Kinematics::Off);
    assert_eq!(kinematics("#TRAFO [9]"), Kinematics::OnWith(9));
    ranges(&[("D3-125", "#KIN ID [{}]", &["0", "70000", "-1"], &["1", "65535"])]);
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
fn contour_log_by_row() {
    let log = |text: &str| match one(text) {
        Command::ContourLog(_, log) => log,
        other => panic!("{other:?}"),
    };
    for (row, text, expected) in [
        ("C40-042", "#CONTOUR LOOKAHEAD LOG [PARAM=-2.5]", ContourLog::Parameter(-2.5)),
        ("C40-043", "#CONTOUR LOOKAHEAD LOG ON", ContourLog::On(None)),
        ("C40-043", "#CONTOUR LOOKAHEAD LOG ON [PARAM=1]", ContourLog::On(Some(1.0))),
        ("C40-044", "#CONTOUR LOOKAHEAD LOG OFF", ContourLog::Off(None)),
        ("C40-044", "#CONTOUR LOOKAHEAD LOG OFF [PARAM=8]", ContourLog::Off(Some(8.0))),
        ("C40-045", "#CONTOUR LOOKAHEAD LOG CLEAR", ContourLog::Clear),
        ("C40-046", "#CONTOUR LOOKAHEAD LOG [PARAM 2]", ContourLog::Parameter(2.0)),
        ("CF-27", "#CONTOUR LOOKAHEAD CLEAR", ContourLog::Clear),
    ] {
        assert_eq!(log(text), expected, "{row}: {text}");
    }
}

#[test]
fn distance_and_loops_by_row() {
    by_row(
        one,
        &[
            ("C40-015", "#DISTANCE PROG START CLEAR", |c| matches!(c, Command::DistanceClear(_))),
            ("G-10", "#DISTANCE PROG START CLEAR", |c| matches!(c, Command::DistanceClear(_))),
            ("CF-27", "#DISTANCE PROGRAM START CLEAR", |c| matches!(c, Command::DistanceClear(_))),
            ("C40-048", "#FLUSH&WAIT", |c| matches!(c, Command::FlushWait(_))),
            ("G-09", "#RT WHILE", |c| matches!(c, Command::RtWhile(_, false))),
            ("G-09", "#RT WHILE [MODULO]", |c| matches!(c, Command::RtWhile(_, true))),
            ("G-09", "#RT WHILE MODULO", |c| matches!(c, Command::RtWhile(_, true))),
            ("G-09", "#RT ENDWHILE", |c| matches!(c, Command::RtEndWhile(_))),
        ],
    );
}

#[test]
fn oscillation_by_row() {
    let p = |x: f64| mm(x).unwrap();
    let on = |first, second, speed| OscillationAction::On {
        first: p(first),
        second: p(second),
        speed,
        first_wait: p(0.0),
        second_wait: p(0.0),
        count: None,
        short: false,
    };
    let feed = OscillationSpeed::Feed(p(1000.0));
    let period = OscillationSpeed::Period(p(4.0));
    let frequency = OscillationSpeed::Frequency(p(0.5));
    let plain = on(-100.0, 100.0, feed);
    let with = |change: fn(&mut OscillationAction)| {
        let mut action = plain;
        change(&mut action);
        action
    };
    let waits = |of: usize| {
        with(match of {
            1 => |a| {
                if let OscillationAction::On { first_wait, .. } = a {
                    *first_wait = mm(0.5).unwrap()
                }
            },
            _ => |a| {
                if let OscillationAction::On { second_wait, .. } = a {
                    *second_wait = mm(0.25).unwrap()
                }
            },
        })
    };
    let counted = with(|a| {
        if let OscillationAction::On { count, .. } = a {
            *count = Some(10)
        }
    });
    for (row, text, expected) in [
        ("A8-019", "X[OSC ON 1ST_POS=-100 2ND_POS=100 FEED=1000]", plain),
        ("A8-020", "X [ OSC ON 1ST_POS=-100 2ND_POS=100 FEED=1000 ]", plain),
        ("A8-021", "X[OSC ON 2ND_POS=100 1ST_POS=-100 FEED=1000]", plain),
        ("A8-022", "X[OSC OFF]", OscillationAction::Off),
        ("A8-023", "X[OSC OFF FEED=5000]", OscillationAction::OffFeed(p(5000.0))),
        ("A8-024", "X[OSC OFF INSTANT]", OscillationAction::OffInstant),
        ("A8-025", "X[OSC ON 1ST_POS=1 2ND_POS=2 FEED=1000]", on(1.0, 2.0, feed)),
        ("A8-026", "X[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=0.5]", on(1.0, 2.0, frequency)),
        ("A8-027", "X[OSC ON 1ST_POS=1 2ND_POS=2 TIME=4]", on(1.0, 2.0, period)),
        ("A8-028", "X[OSC ON 1ST_POS=3 2ND_POS=2 TIME=4]", on(3.0, 2.0, period)),
        ("A8-029", "X[OSC ON 1ST_POS=1 2ND_POS=4 TIME=4]", on(1.0, 4.0, period)),
        ("A8-030", "X[OSC ON ZERO_POS=5 EXCUR=100 FEED=1000]", on(-95.0, 105.0, feed)),
        ("A8-031", "X[OSC ON ZERO_POS=0 EXCUR=7 FEED=1000]", on(-7.0, 7.0, feed)),
        ("A8-032", "X[OSC ON 1ST_POS=-100 1ST_DELT=0.5 2ND_POS=100 FEED=1000]", waits(1)),
        ("A8-033", "X[OSC ON 1ST_POS=-100 2ND_DELT=0.25 2ND_POS=100 FEED=1000]", waits(2)),
        ("A8-034", "X[OSC ON 1ST_POS=-100 2ND_POS=100 FEED=1000 NBR_OSC=10]", counted),
        ("A8-035", "X[OSC ON 1ST_POS=-100 2ND_POS=100 FEED=1000 INCL_OFFSETS]", plain),
        ("A8-037", "X[OSC ON 1ST_POS=-100 2ND_POS=100 \\\n  FEED=1000]", plain),
        ("A8-038", "X[OSC ON ZERO_POS=0 EXCUR=100 FEED=1000]", plain),
        ("A8-039", "X[OSC ON FEED=1000 1ST_POS=-100 2ND_POS=100]", plain),
        ("A8-040", "X[OSC ON ZERO_POS 0 EXCUR 100 FEED 1000]", plain),
        ("A8-062", "X[OSC ON, 1ST_POS=-100, 2ND_POS=100, FEED=1000]", plain),
        ("A8-062", "X[OSC,ON,1ST_POS -100,2ND_POS 100,FEED 1000]", plain),
        ("A8-062", "X[OSC OFF, INSTANT]", OscillationAction::OffInstant),
        ("NC-010", "X[OSC ON 1ST_POS=-100 2ND_POS=100 FEED=1000]", plain),
    ] {
        let seen = oscillation(text);
        assert_eq!((seen.axis, seen.action), (0, expected), "{row}: {text}");
    }
    assert_eq!(oscillation("C[OSC OFF]").axis, 4);
    match oscillation("C[OSC ON 1ST_POS=10 2ND_POS=350 FEED=1000 SHORT]").action {
        OscillationAction::On { first, second, short: true, .. } => {
            assert_eq!((first, second), (p(10.0), p(350.0)), "A8-036");
        }
        other => panic!("A8-036: {other:?}"),
    }
    match commands(
        "G92 X10\nX[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=1 INCL_OFFSETS]\nX[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=1]",
    )[..]
    {
        [Command::Oscillation(_, a), Command::Oscillation(_, b)] => {
            assert!(matches!(a.action, OscillationAction::On { first, .. } if first == 11), "A8-035");
            assert!(matches!(b.action, OscillationAction::On { first, .. } if first == 1), "A8-035");
        }
        ref other => panic!("{other:?}"),
    }
    let out = crate::nc_decode::motions("X[OSC ON 1ST_POS=-1 2ND_POS=7 FREQ=1]\nX[OSC OFF]\nG91 G0 X1");
    assert_eq!(out[0].target[0], 8, "the axis stands on position 2");
}

/// A8-025: FEED is in inch/min with G70, of a linear axis; that of an independent axis is not.
#[test]
fn oscillation_feed_in_inch() {
    let feed = |text: &str| match one_of(text) {
        OscillationAction::On { speed: OscillationSpeed::Feed(feed), .. } => feed,
        OscillationAction::OffFeed(feed) => feed,
        other => panic!("{other:?}"),
    };
    let p = |x: f64| mm(x).unwrap();
    assert_eq!(feed("G70\nX[OSC ON 1ST_POS=1 2ND_POS=2 FEED=100]"), p(2540.0));
    assert_eq!(feed("G70\nX[OSC OFF FEED=10]"), p(254.0));
    assert_eq!(feed("G70\nG71\nX[OSC ON 1ST_POS=1 2ND_POS=2 FEED=100]"), p(100.0));
    assert_eq!(feed("G70\nC[OSC ON 1ST_POS=1 2ND_POS=2 FEED=100]"), p(100.0));
    let Some(Command::Independent(_, words)) = commands("G70\nX[INDP_ASYN POS=1 FEED=100 G01]").pop() else {
        panic!("an independent axis")
    };
    assert_eq!(words.feed, mm(100.0));
}

/// The oscillation that a program ends with.
fn one_of(text: &str) -> OscillationAction {
    let Some(Command::Oscillation(_, oscillation)) = commands(text).pop() else { panic!("{text}") };
    oscillation.action
}

#[test]
fn oscillation_refused_by_row() {
    assert_eq!(error("X[OSC ON 1ST_POS=1 2ND_POS=2]").kind.id(), 50593, "A8-043");
    assert_eq!(error("C[OSC ON 1ST_POS=-1 2ND_POS=2 FREQ=1 SHORT]").kind.id(), 22277);
    for (row, text) in [
        ("A8-019", "X[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=1] Y5"),
        ("A8-019", "G0 X[OSC OFF]"),
        ("A8-020", "X[ON OSC 1ST_POS=1 2ND_POS=2 FREQ=1]"),
        ("A8-021", "X[OSC FREQ=1]"),
        ("A8-021", "X[OSC ON OFF]"),
        ("A8-023", "X[OSC OFF FREQ=1]"),
        ("A8-024", "X[OSC OFF INSTANT FEED=1]"),
        ("A8-026", "X[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=0]"),
        ("A8-028", "X[OSC ON 1ST_POS=100001 2ND_POS=2 FREQ=1]"),
        ("A8-038", "X[OSC ON 1ST_POS=1 FREQ=1]"),
        ("A8-038", "X[OSC ON 1ST_POS=1 2ND_POS=2 ZERO_POS=1 EXCUR=2 FREQ=1]"),
        ("A8-038", "X[OSC ON 1ST_POS=1 2ND_POS=1 FREQ=1]"),
        ("A8-039", "X[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=1 TIME=2]"),
        ("A8-043", "X[OSC ON ZERO_POS=1 EXCUR=2]"),
    ] {
        assert!(decode(text).error.is_some(), "{row}: {text} is accepted");
    }
}

/// NC-010 too.
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

/// NC-009.
#[test]
fn every_command_knows_its_place_and_name() {
    for command in commands(include_str!("../../programs/nc/everything.nc")) {
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
    // Of it 1.6 kB for a line that goes on in the next call, 5.5 kB for values, names, calls and saved words of the dialects,
    // and 0.5 kB for the synchronisation of functions that a program may change.
    assert!(decoder - parameters <= 14 * 1024);
}
