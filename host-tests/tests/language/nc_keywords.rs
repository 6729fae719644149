//! Keywords and their methods; commands without a function are refused at their place.
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::nc::{Decoder, DecoderMemory, NcErrorKind, Setup, Step};
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
    let mut memory = DecoderMemory::<5>::new();
    let mut decoder = Decoder::new(&mut memory, Setup::new(&machine(), [Position::ZERO; 5]), text.as_bytes());
    loop {
        match decoder.step() {
            Ok(Step::End) => return None,
            Ok(_) => {}
            Err(error) => return Some(error.kind),
        }
    }
}

/// A line for every keyword that goes with a method: row, method, keyword. All pairs that are not there are
/// refused as a mismatch.
fn only_with(patterns: &[&str], methods: &[&str], rows: &[(&str, &str, &str)]) {
    for pattern in patterns {
        for (of, _, keyword) in rows {
            for method in methods {
                let with = rows.iter().find(|(_, m, k)| m == method && k == keyword);
                let row = with.map_or(of, |(row, ..)| row);
                let text = pattern.replace("{}", &format!("{method} {keyword}"));
                match refusal(&text) {
                    None => assert!(with.is_some(), "{row}: {text} is accepted"),
                    Some(NcErrorKind::KeywordMismatch { .. }) => {
                        assert!(with.is_none(), "{row}: {text} is refused");
                    }
                    Some(other) => panic!("{row}: {text}: {other:?}"),
                }
            }
        }
    }
}

#[test]
fn contour_methods_take_their_keywords_and_no_others() {
    let methods = ["DEV", "DIST", "POS", "DIST_SOFT", "DIST_MASTER", "PTP"];
    only_with(
        &["#CONTOUR MODE [{}]", "#CONTOUR MODE ON [{}]"],
        &methods,
        &[
            ("D3-080", "DEV", "PATH_DEV=1"),
            ("D3-081", "DEV", "RELEVANT_PATH=1"),
            ("D3-082", "DEV", "TRACK_DEV=1"),
            ("D3-083", "DEV", "RELEVANT_TRACK=1"),
            ("D3-084", "DEV", "REMAIN_PART=1"),
            ("D3-086", "DEV", "CHECK_JERK=1"),
            ("D3-087", "DEV", "MAX_ANGLE=1"),
            ("D3-088", "DEV", "CONST_VEL=1"),
            ("D3-094", "DIST", "PRE_DIST=1"),
            ("D3-095", "DIST", "POST_DIST=1"),
            ("D3-096", "DIST", "RELEVANT_PATH=1"),
            ("D3-097", "DIST", "RELEVANT_TRACK=1"),
            ("D3-098", "DIST", "TRACK_DEV=1"),
            ("D3-099", "DIST", "REMAIN_PART=1"),
            ("D3-101", "DIST", "CHECK_JERK=1"),
            ("D3-102", "DIST", "MAX_ANGLE=1"),
            ("D3-103", "DIST", "CONST_VEL=1"),
            // All others are refused with POS: D3-114.
            ("D3-108", "POS", "PRE_DIST=1"),
            ("D3-109", "POS", "POST_DIST=1"),
            ("D3-110", "POS", "X=1"),
            ("D3-110", "POS", "Y=1"),
            ("D3-110", "POS", "Z=1"),
            ("D3-112", "POS", "CHECK_JERK=1"),
            ("D3-113", "POS", "CONST_VEL=1"),
            ("D3-117", "DIST_SOFT", "PATH_DIST=1"),
            ("D3-118", "DIST_SOFT", "TRACK_DIST=1"),
            ("D3-119", "DIST_SOFT", "ACC_MAX=1"),
            ("D3-120", "DIST_SOFT", "ACC_MIN=1"),
            ("D3-121", "DIST_SOFT", "RAMP_TIME=1"),
            ("D3-122", "DIST_SOFT", "DIST_WEIGHT=1"),
            ("D3-133", "DIST_MASTER", "SYM_DIST=1"),
            ("D3-134", "DIST_MASTER", "ACC_MAX=1"),
            ("D3-135", "DIST_MASTER", "ACC_MIN=1"),
            ("D3-136", "DIST_MASTER", "RAMP_TIME=1"),
            ("D3-137", "DIST_MASTER", "DIST_WEIGHT=1"),
            ("D3-145", "PTP", "PATH_DEV=1"),
            ("D3-146", "PTP", "PATH_DIST=1"),
            ("D3-147", "PTP", "MERGE=1"),
        ],
    );
    // D3-278: soft corners know no actions, nor any keyword that is not above.
    for (row, method, is_soft) in [
        ("D3-085", "DEV", false),
        ("D3-100", "DIST", false),
        ("D3-111", "POS", false),
        ("D3-065", "DIST_SOFT", true),
        ("D3-066", "DIST_MASTER", true),
        ("D3-148", "PTP", false),
    ] {
        for action in ["PRE_ACTION", "INTER_ACTION", "POST_ACTION"] {
            let refused = refusal(&format!("#CONTOUR MODE ON [{method} {action}]"));
            assert_eq!(refused.is_some(), is_soft, "{row}: {method} {action}: {refused:?}");
        }
    }
}

#[test]
fn hsc_methods_take_their_keywords_and_no_others() {
    // Before ON and with it: parameters may come in several commands (D3-177, D3-194).
    only_with(
        &["#HSC [{}]", "#HSC ON [{}]"],
        &["SURFACE", "BSPLINE"],
        &[
            ("D3-162", "SURFACE", "PATH_DEV=1"),
            ("D3-163", "SURFACE", "PATH_DEV_G00=1"),
            ("D3-164", "SURFACE", "TRACK_DEV=1"),
            ("D3-165", "SURFACE", "TRACK_DEV_G00=1"),
            ("D3-166", "SURFACE", "MAX_ANGLE=1"),
            ("D3-167", "SURFACE", "CHECK_JERK=1"),
            ("D3-168", "SURFACE", "AUTO_OFF_G00=1"),
            ("D3-169", "SURFACE", "CIR_MODE=1"),
            ("D3-170", "SURFACE", "CIR_MIN_ANGLE=1"),
            ("D3-171", "SURFACE", "CIR_MIN_RADIUS=1"),
            ("D3-172", "SURFACE", "MERGE=1"),
            ("D3-173", "SURFACE", "LENGTH_LONG_CIR=1"),
            ("D3-184", "BSPLINE", "PATH_DEV=1"),
            ("D3-185", "BSPLINE", "TRACK_DEV=1"),
            ("D3-186", "BSPLINE", "MERGE=1"),
            ("D3-187", "BSPLINE", "AUTO_OFF_PATH=1"),
            ("D3-188", "BSPLINE", "AUTO_OFF_TRACK=1"),
            ("D3-189", "BSPLINE", "AUTO_OFF_G00=1"),
            ("D3-190", "BSPLINE", "AUTO_OFF_G60=1"),
            ("D3-191", "BSPLINE", "MAX_PATH_LENGTH=1"),
            ("D3-192", "BSPLINE", "MAX_ANGLE=1"),
            ("G-02", "OPMODE=1", "CONTERROR=1"),
        ],
    );
}

/// NC-009; transformations: D3-125.
#[test]
fn what_is_not_available_is_refused_where_it_stands() {
    let commands = [
        "#VECTOR LIMIT ON [RADIAL_ACC=1000]",
        "#VECTOR LIMIT ON [VEL=1000 RADIAL_JERK]",
        "#VECTOR LIMIT ON [JERK=1000]",
        "#VECTOR LIMIT ON [TRANS_ACC]",
        "G93",
        "G95",
        "G194",
        "E100",
        "G04 S5",
        "#CS ON[1,2,3,0,0,0]",
        "#MCS ON",
        "#CYL [Z,C,100]",
        "#ROTATION ON [ANGLE=30]",
    ];
    for command in commands {
        let error = refusal::refused(&format!("N10 G01 X1 F600\nN20 {command}\nN30 X3\n"), &machine());
        assert_eq!(error.place().line, 2, "{command}: {error}");
        assert!(error.to_string().ends_with("known, not available in this version"), "{command}: {error}");
    }
    // What needs memory of its own is refused by a channel without it.
    for command in ["#CONTOUR LOOKAHEAD LOG ON", "#DISTANCE PROG START CLEAR"] {
        let error = refusal::refused(&format!("N10 G01 X1 F600\nN20 {command}\nN30 X3\n"), &machine());
        assert_eq!(error.place().line, 2, "{command}: {error}");
        let said = error.to_string();
        assert!(said.contains("expected FCT_CONTOUR_LAH"), "{command}: {said}");
    }
    // So is what needs data of the machine.
    for command in ["#KIN ID [9]", "#TRAFO ON", "#TRAFO [9]"] {
        let error = refusal::refused(&format!("N10 G01 X1 F600\nN20 {command}\nN30 X3\n"), &machine());
        assert_eq!(error.place().line, 2, "{command}: {error}");
        assert!(error.to_string().contains("expected trafo[]"), "{command}: {error}");
    }
    let error = refusal::refused("N10 G01 X1 F600\nN20 #RT WHILE\nN30 X3\n", &machine());
    assert_eq!(error.place().line, 2, "{error}");
    assert!(error.to_string().contains("expected a build with memory for real-time loops"), "{error}");
    for command in [
        "#FILTER ON [ORDER=20]",
        "X[OSC ON 1ST_POS=1 2ND_POS=2 FEED=100]",
        "X[INDP_SYN G01 G90 POS=1 FEED=100]",
    ] {
        let error = refusal::refused(&format!("N10 G01 X1 F600\nN20 {command}\nN30 X3\n"), &machine());
        assert_eq!(error.place().line, 2, "{command}: {error}");
        let said = error.to_string();
        assert!(said.contains("this channel") || said.contains("not available"), "{command}: {said}");
    }
    // What switches off has nothing to do.
    for command in ["G260", "#CONTOUR MODE OFF", "G150", "#SPLINE OFF", "#SLOPE DEFAULT", "#TRAFO OFF"] {
        let error = refusal::refusal(&format!("N10 G01 X1 F600\nN20 {command}\nN30 X3\n"), &machine());
        assert!(error.is_none(), "{command}: {error:?}");
    }
}
