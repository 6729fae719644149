//! What a build leaves out is refused like a function that is not enabled: by its name, with line and column and
//! what to do; what only switches it off is accepted, and the rest of the channel is as it was.
use glidepath::channel::MachineError;
use glidepath::{
    AxisData, AxisKind, AxisName, Channel, ChannelData, Handles, MachineData, Position, Progress, State,
};

const fn axis(name: &str) -> AxisData {
    match AxisName::new(name) {
        Some(name) => AxisData { a_max: 3000, ..AxisData::new(name, AxisKind::Linear) },
        None => panic!("not a name"),
    }
}

const MACHINE: MachineData<3> = MachineData {
    axes: [axis("X"), axis("Y"), axis("Z")],
    channel: ChannelData { slope_profile: 1, surface: true, ptp: true, ..ChannelData::new() },
};

/// Where the axes stand at the end, mm, and what was refused: line, column, message.
fn run(program: &[u8]) -> ([f64; 3], Vec<(u32, u32, String)>) {
    let mut memory = Box::new(Channel::<3, 30>::new());
    let machine = MachineData { channel: ChannelData { look_ahead: 30, ..MACHINE.channel }, ..MACHINE };
    let handles = memory.split(&machine, [Position::ZERO; 3], program).expect("machine data");
    let Handles { mut planner, mut interpolator, .. } = handles;
    let mut refused = Vec::new();
    loop {
        match planner.poll() {
            Ok(Progress::Done) if interpolator.tick() == State::Idle => {
                if planner.go_on().is_err() {
                    break;
                }
            }
            Ok(Progress::Done | Progress::Waiting) => _ = interpolator.tick(),
            Ok(_) => {}
            Err(error) => {
                let place = error.place();
                refused.push((place.line, place.column, error.to_string()));
            }
        }
    }
    (interpolator.set_points().map(Position::to_num), refused)
}

#[test]
fn every_function_is_refused_by_its_name() {
    let table = [
        ("#CONTOUR MODE ON [DEV PATH_DEV=0.1]", 1, "contouring", "contour"),
        ("#CONTOUR MODE [DEV PATH_DEV=0.1]", 1, "contouring", "contour"),
        ("G01 X2 F1000 G61", 14, "contouring", "contour"),
        ("G261", 1, "contouring", "contour"),
        ("#HSC ON [SURFACE PATH_DEV=0.1]", 1, "contouring", "contour"),
        ("#HSC ON [BSPLINE PATH_DEV=0.1]", 1, "contouring", "contour"),
        ("N5 G151", 4, "a spline", "splines"),
        ("#SPLINE ON", 1, "a spline", "splines"),
        ("#SPLINE TYPE AKIMA", 1, "a spline", "splines"),
        ("#AKIMA STARTVECTOR X1", 1, "a spline", "splines"),
        ("#SLOPE [TYPE=HSC]", 1, "slope HSC", "hsc"),
        ("P1 = 5", 1, "an expression", "expressions"),
        ("G01 X[1+2] F1000", 6, "an expression", "expressions"),
        ("G01 X1+2 F1000", 6, "an expression", "expressions"),
        ("G01 X-P1 F1000", 6, "an expression", "expressions"),
        ("G01 X SIN[30] F1000", 7, "an expression", "expressions"),
        ("$IF 1", 1, "an expression", "expressions"),
        ("#FILTER ON [ORDER=4]", 1, "#FILTER", "filters"),
        ("X[OSC ON 1ST_POS=0 2ND_POS=1 FREQ=1]", 1, "an axis beside the path", "beside"),
        ("X[INDP_ASYN G00 POS=3]", 1, "an axis beside the path", "beside"),
        ("#WAIT INDP [X]", 1, "an axis beside the path", "beside"),
    ];
    let of_contour = [
        ("#HSC ON [SURFACE PATH_DEV=0.1]", 1, "#HSC [SURFACE]", "surface"),
        ("#HSC ON [BSPLINE PATH_DEV=0.1]", 1, "a spline", "splines"),
        ("#HSC ON [OPMODE=2 CONTERROR=0.1]", 1, "a spline", "splines"),
    ];
    let with_contour = cfg!(feature = "contour");
    let table = table.into_iter().filter(|(.., feature)| !(with_contour && *feature == "contour"));
    for (line, column, name, feature) in table.chain(of_contour.into_iter().filter(|_| with_contour)) {
        let program = format!("G01 X1 F1000\n{line}\nG01 Y3 F1000\nM30\n");
        let (end, refused) = run(program.as_bytes());
        let [(at, from, message)] = refused.as_slice() else { panic!("{line}: {refused:?}") };
        assert_eq!((*at, *from), (2, column), "{line}: {message}");
        let needs = format!("expected the library's feature `{feature}`");
        assert!(message.starts_with(name) && message.ends_with(&needs), "{line}: {message}");
        assert_eq!(end, [1.0, 3.0, 0.0], "{line}: the channel goes on behind it");
    }
}

#[test]
fn what_switches_off_is_accepted_and_lines_arcs_and_calls_run() {
    let program = b"%L PART\nG91 G01 X2\nG90 M17\n%MAIN\nG260 G150\n#HSC OFF\n#FILTER OFF\n#CONTOUR MODE OFF\n#SPLINE OFF\n\
        #SLOPE [TYPE=SIN2]\nN10 G01 X10.5 F2000\nLL PART\nG02 X14.5 Y2 I0 J2\nG03 X12.5 Y4 R2\nG00 Z-.5\nG04 0.01\nM30\n";
    let (end, refused) = run(program);
    assert_eq!(refused, []);
    assert_eq!(end, [12.5, 4.0, -0.5]);
}

#[test]
fn a_number_that_is_none_is_refused_as_ever() {
    for (line, message) in [
        ("G01 X F1000", "unexpected"),
        ("G01 XQ", "unexpected"),
        ("G01 X", "end of line"),
        ("G01 X1e5 F9", "exponent"),
    ] {
        let (_, refused) = run(format!("{line}\nM30\n").as_bytes());
        assert!(
            matches!(refused.as_slice(), [(1, _, said)] if said.contains(message)),
            "{line}: {refused:?}"
        );
    }
}

#[test]
fn a_build_for_little_memory_names_its_limits() {
    let subroutines = |count: usize| -> String {
        (0..count).map(|k| format!("%L S{k}\nG91 X1\nM17\n")).collect::<String>()
            + "%MAIN\nG01 F2000\nLL S0\n"
    };
    // 12 bytes and the zeros.
    let line = |zeros: usize| format!("G01 F2000 X{}1\n", "0".repeat(zeros));
    let nested = |depth: usize| {
        let calls: String = (1..depth).map(|k| format!("%L S{k}\nLL S{}\nM17\n", k - 1)).collect();
        format!("%L S0\nG91 X1\nM17\n{calls}%MAIN\nG01 F2000\nLL S{}\n", depth - 1)
    };
    let words = ["N1", "G01", "G90", "G17", "F2000", "X1", "Y0", "Z0"];
    let continued = |lines: usize| words[..=lines].join(" \\\n") + "\n";
    for (fits, exceeds, message) in [
        (subroutines(16), subroutines(17), "too many local subroutines: expected at most 16"),
        (line(244), line(245), "line too long: expected at most 256 bytes"),
        (nested(6), nested(7), "subroutine calls too deep: expected at most 6"),
        (continued(6), continued(7), "too many continuation lines: expected at most 6"),
    ] {
        assert_eq!(run(format!("{fits}M30\n").as_bytes()), ([1.0, 0.0, 0.0], vec![]), "{message}");
        let (_, refused) = run(format!("{exceeds}M30\n").as_bytes());
        assert!(matches!(refused.as_slice(), [(.., said), ..] if said == message), "{message}: {refused:?}");
    }
}

#[test]
fn machine_data_with_the_slope_hsc_are_refused() {
    let mut memory = Box::new(Channel::<3, 120>::new());
    let machine = MachineData { channel: ChannelData { slope_profile: 3, ..MACHINE.channel }, ..MACHINE };
    let refused = memory.split(&machine, [Position::ZERO; 3], b"M30\n".as_slice()).map(|_| ());
    let Err(error @ MachineError::NotBuilt(_)) = refused else { panic!("{refused:?}") };
    assert!(error.to_string().contains("slope HSC") && error.to_string().contains("`hsc`"), "{error}");
}

#[test]
#[cfg(feature = "contour")]
fn corners_are_rounded_without_the_other_functions() {
    let (end, refused) = run(b"#CONTOUR MODE ON [DEV PATH_DEV=0.1]\nG01 X10 F2000\nY10\nM30\n");
    assert_eq!((end, refused), ([10.0, 10.0, 0.0], vec![]));
    let (_, refused) = run(b"#HSC ON [OPMODE=1 CONTERROR=0.1]\nG01 X10 F2000\nY10\n#HSC OFF\nM30\n");
    assert_eq!(refused, []);
}
