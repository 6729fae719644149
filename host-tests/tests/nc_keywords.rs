//! Which keyword goes with which method, and that commands without a function are refused where they stand.
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::nc::{Decoder, NcErrorKind, Setup, Step};
use glidepath::quantity::Position;
use host_tests::refusal;

fn machine() -> MachineData<5> {
    let axes = ["X", "Y", "Z", "A", "C"].map(|name| {
        let kind = if "XYZ".contains(name) { AxisKind::Linear } else { AxisKind::Rotary };
        AxisData::new(AxisName::new(name).expect("a letter"), kind)
    });
    MachineData {
        axes,
        channel: ChannelData { slope_profile: 1, corr_v_trans_jerk: true, ..ChannelData::new() },
    }
}

/// The decoder's refusal, if any.
fn refusal(text: &str) -> Option<NcErrorKind> {
    let mut decoder: Decoder<&[u8], 5> =
        Decoder::new(Setup::new(&machine(), [Position::ZERO; 5]), text.as_bytes());
    loop {
        match decoder.step() {
            Ok(Step::End) => return None,
            Ok(_) => {}
            Err(error) => return Some(error.kind),
        }
    }
}

/// Every keyword with every method: accepted with the methods listed, refused as a mismatch with all others.
fn only_with(pattern: &str, methods: &[&str], keywords: &[(&str, &[&str])]) {
    for (keyword, with) in keywords {
        for method in methods {
            let text = pattern.replace("{}", &format!("{method} {keyword}"));
            match refusal(&text) {
                None => assert!(with.contains(method), "{text} is accepted"),
                Some(NcErrorKind::KeywordMismatch { .. }) => {
                    assert!(!with.contains(method), "{text} is refused")
                }
                Some(other) => panic!("{text}: {other:?}"),
            }
        }
    }
}

#[test]
fn contour_methods_take_their_keywords_and_no_others() {
    let methods = ["DEV", "DIST", "POS", "DIST_SOFT", "DIST_MASTER", "PTP"];
    let corner: &[&str] = &["DEV", "DIST"];
    let distance: &[&str] = &["DIST", "POS"];
    let soft: &[&str] = &["DIST_SOFT", "DIST_MASTER"];
    only_with(
        "#CONTOUR MODE [{}]",
        &methods,
        &[
            ("PATH_DEV=1", &["DEV", "PTP"]),
            ("TRACK_DEV=1", corner),
            ("RELEVANT_PATH=1", corner),
            ("RELEVANT_TRACK=1", corner),
            ("REMAIN_PART=1", corner),
            ("MAX_ANGLE=1", corner),
            ("CHECK_JERK=1", &["DEV", "DIST", "POS"]),
            ("CONST_VEL=1", &["DEV", "DIST", "POS"]),
            ("PRE_DIST=1", distance),
            ("POST_DIST=1", distance),
            ("X=1", &["POS"]),
            ("Y=1", &["POS"]),
            ("Z=1", &["POS"]),
            ("PATH_DIST=1", &["DIST_SOFT", "PTP"]),
            ("TRACK_DIST=1", &["DIST_SOFT"]),
            ("SYM_DIST=1", &["DIST_MASTER"]),
            ("ACC_MAX=1", soft),
            ("ACC_MIN=1", soft),
            ("RAMP_TIME=1", soft),
            ("DIST_WEIGHT=1", soft),
            ("MERGE=1", &["PTP"]),
        ],
    );
    for method in methods {
        for action in ["PRE_ACTION", "INTER_ACTION", "POST_ACTION"] {
            assert_eq!(refusal(&format!("#CONTOUR MODE ON [{method} {action}]")), None);
        }
    }
}

#[test]
fn hsc_methods_take_their_keywords_and_no_others() {
    let both: &[&str] = &["SURFACE", "BSPLINE"];
    let (surface, bspline): (&[&str], &[&str]) = (&["SURFACE"], &["BSPLINE"]);
    let keywords = [
        ("PATH_DEV=1", both),
        ("TRACK_DEV=1", both),
        ("MAX_ANGLE=1", both),
        ("AUTO_OFF_G00=1", both),
        ("MERGE=1", both),
        ("PATH_DEV_G00=1", surface),
        ("TRACK_DEV_G00=1", surface),
        ("CHECK_JERK=1", surface),
        ("CIR_MODE=1", surface),
        ("CIR_MIN_ANGLE=1", surface),
        ("CIR_MIN_RADIUS=1", surface),
        ("LENGTH_LONG_CIR=1", surface),
        ("AUTO_OFF_PATH=1", bspline),
        ("AUTO_OFF_TRACK=1", bspline),
        ("AUTO_OFF_G60=1", bspline),
        ("MAX_PATH_LENGTH=1", bspline),
        ("CONTERROR=1", &[]),
    ];
    // Before ON and with it: parameters may come in several commands.
    only_with("#HSC [{}]", both, &keywords);
    only_with("#HSC ON [{}]", both, &keywords);
}

#[test]
fn what_is_not_available_is_refused_where_it_stands() {
    let commands = [
        "#HSC ON [SURFACE]",
        "#HSC [BSPLINE PATH_DEV=0.1]",
        "#FILTER ON [ORDER=20]",
        "#VECTOR LIMIT ON [RADIAL_ACC=1000]",
        "#VECTOR LIMIT ON [VEL=1000 RADIAL_JERK]",
        "#VECTOR LIMIT ON [JERK=1000]",
        "#VECTOR LIMIT ON [TRANS_ACC]",
        "G151",
        "#SPLINE ON",
        "#AKIMA TRANS [START=TANGENTIAL]",
        "G93",
        "G95",
        "G194",
        "E100",
        "G04 S5",
        "M00",
        "M01",
        "#KIN ID [9]",
        "#TRAFO ON",
        "#TRAFO [9]",
        "#CS ON[1,2,3,0,0,0]",
        "#MCS ON",
        "#CYL [Z,C,100]",
        "#ROTATION ON [ANGLE=30]",
        "#RT WHILE",
        "#CONTOUR LOOKAHEAD LOG ON",
        "#DISTANCE PROG START CLEAR",
        "X[OSC ON 1ST_POS=1 2ND_POS=2 FEED=100]",
        "X[INDP_SYN G01 G90 POS=1 FEED=100]",
    ];
    for command in commands {
        let error = refusal::refused(&format!("N10 G01 X1 F600\nN20 {command}\nN30 X3\n"), &machine());
        assert_eq!(error.place().line, 2, "{command}: {error}");
        assert!(error.to_string().ends_with("known, not available in this version"), "{command}: {error}");
    }
    // What switches off has nothing to do.
    for command in ["G260", "#CONTOUR MODE OFF", "G150", "#SPLINE OFF", "#SLOPE DEFAULT", "#TRAFO OFF"] {
        let error = refusal::refusal(&format!("N10 G01 X1 F600\nN20 {command}\nN30 X3\n"), &machine());
        assert!(error.is_none(), "{command}: {error:?}");
    }
}
