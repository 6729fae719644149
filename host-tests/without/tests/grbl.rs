//! The words of Grbl 1.1 alone, feature `grbl`: they give the set points of a build with all dialects, and what such a build
//! lacks is refused by its name. Run with `--features grbl`, and with `--features dialects`, which refuses none of it.
//! With `--features grbl,hsc`, and with `isg` besides, the slope HSC has one digest.
use glidepath::channel::MachineError;
use glidepath::machine::Dialect;
use glidepath::{
    AxisData, AxisKind, AxisName, Channel, ChannelData, Handles, MachineData, Position, Progress, State,
};

const fn axis(name: &str) -> AxisData {
    match AxisName::new(name) {
        Some(name) => AxisData { a_max: 3000, ..AxisData::new(name, AxisKind::Linear) },
        None => panic!("not a name"),
    }
}

fn machine(dialect: Dialect) -> MachineData<3> {
    let mut channel = ChannelData { slope_profile: 1, look_ahead: 30, ..ChannelData::new() };
    channel.foreign.dialect = dialect;
    MachineData { axes: [axis("X"), axis("Y"), axis("Z")], channel }
}

/// Where the axes stand at the end, mm, a hash of all set points (FNV-1a over their bits), and what was refused.
fn run(program: &str) -> ([f64; 3], u64, Vec<(u32, u32, String)>) {
    run_with(program, 1)
}

/// The same with this slope (P-CHAN-00071).
fn run_with(program: &str, slope: u8) -> ([f64; 3], u64, Vec<(u32, u32, String)>) {
    let mut memory = Box::new(Channel::<3, 30>::new());
    let mut machine = machine(Dialect::Grbl);
    machine.channel.slope_profile = slope;
    let handles = memory.split(&machine, [Position::ZERO; 3], program.as_bytes()).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    let (mut refused, mut hash) = (Vec::new(), 0xcbf2_9ce4_8422_2325_u64);
    loop {
        let mut tick = || {
            let state = interpolator.tick();
            for point in interpolator.set_points() {
                hash = (hash ^ point.to_bits() as u64).wrapping_mul(0x0100_0000_01b3);
            }
            while let Some(output) = operator.output() {
                if output.waits {
                    operator.acknowledge(output.function).expect("it waits");
                }
            }
            state
        };
        match planner.poll() {
            Ok(Progress::Done) if tick() == State::Idle => {
                if planner.go_on().is_err() {
                    break;
                }
            }
            Ok(Progress::Done | Progress::Waiting) => _ = tick(),
            Ok(_) => {}
            Err(error) => {
                assert!(refused.len() < 10, "{refused:?}");
                let place = error.place();
                refused.push((place.line, place.column, error.to_string()));
            }
        }
    }
    (interpolator.set_points().map(Position::to_num), hash, refused)
}

/// Lines, arcs, offsets, inches, inverse time, a spiral whose radius shrinks a little.
const PROGRAM: &str = "G21 G90 G17 G94 G54
M3 S1000
G0 X10 Y5 Z2
G1 Z-1 F300
X30 Y5
G2 X40 Y15 I0 J10 F1200
G3 X30 Y25 R10
G91 G1 X-5 Y2.5
G90
G20 X1 Y1 F40
G21
G93 G1 X20 Y20 F30
G3 X30 Y20.04 I5 F20
G94
G92 X0 Y0
G1 X5 F600
G92.1
G4 P0.02
G0 Z5
M5
M2
";

/// Of a build with all dialects.
const HASH: u64 = 0xc1a4_e12b_a880_269f;

#[test]
fn set_points_are_those_of_all_dialects() {
    let (end, hash, refused) = run(PROGRAM);
    assert_eq!(refused, []);
    assert_eq!(end[2], 5.0);
    assert_eq!(hash, HASH, "{hash:#x}, the axes end at {end:?}");
}

/// Of a build with all functions.
#[cfg(feature = "hsc")]
const HASH_HSC: u64 = 0x517f_680a_8978_e0f1;

#[cfg(feature = "hsc")]
#[test]
fn set_points_of_hsc_are_those_of_all_functions() {
    let (end, hash, refused) = run_with(PROGRAM, 3);
    assert_eq!(refused, []);
    assert_eq!(end[2], 5.0);
    assert_eq!(hash, HASH_HSC, "{hash:#x}, the axes end at {end:?}");
}

/// The feature that the refusal of machine data names, if it is refused.
fn needed(dialect: Dialect, slope: u8) -> Option<String> {
    let mut memory = Box::new(Channel::<3, 30>::new());
    let mut machine = machine(dialect);
    machine.channel.slope_profile = slope;
    match memory.split(&machine, [Position::ZERO; 3], b"M2\n".as_slice()).map(|_| ()) {
        Ok(()) => None,
        Err(MachineError::NotBuilt(what)) => {
            let from = what.find("feature `").unwrap_or(0);
            Some(what[from..].split('`').nth(1).unwrap_or(what).to_owned())
        }
        Err(error) => panic!("{error:?}"),
    }
}

/// A build for Grbl's words alone says which feature has the language of ISG, and which the slopes STEP and SIN2.
#[test]
fn machine_data_of_what_is_left_out_is_refused_with_the_feature() {
    let isg = cfg!(feature = "isg");
    assert_eq!(needed(Dialect::Isg, 1), (!isg).then(|| "isg".to_owned()));
    for slope in [0, 2] {
        assert_eq!(needed(Dialect::Grbl, slope), (!isg).then(|| "slopes".to_owned()), "slope {slope}");
    }
    assert_eq!(needed(Dialect::Grbl, 1), None);
    assert_eq!(needed(Dialect::Grbl, 3), (!cfg!(feature = "hsc")).then(|| "hsc".to_owned()));
}

#[cfg(not(feature = "dialects"))]
#[test]
fn what_computes_is_refused_by_its_name() {
    let table = [
        ("#1=5", 1, "a parameter or an expression"),
        ("G1 X[1+2] F100", 5, "a parameter or an expression"),
        ("G1 X#1 F100", 5, "a parameter or an expression"),
        ("O100 sub", 1, "an O word"),
        ("G81 X1 Z-1 R1 F100", 1, "drill"),
        ("G95 F1", 1, "feed per revolution"),
        ("M98 P100", 1, "call the subprogram"),
        ("M99", 1, "return"),
        ("M64 P1", 1, "digital output"),
        ("M70", 1, "save modal state"),
        ("G2 X0 Y0 I5 P3 F100", 13, "an arc of several turns"),
    ];
    for (line, column, what) in table {
        let (end, _, refused) = run(&format!("G1 X1 F1000\n{line}\nG1 X2\nM2\n"));
        let [(2, at, message)] = refused.as_slice() else { panic!("{line}: {refused:?}") };
        assert_eq!(*at, column, "{line}: {message}");
        assert!(message.contains(what) && message.contains("`dialects`"), "{line}: {message}");
        assert_eq!(end[0], 2.0, "{line}");
    }
}

#[test]
fn the_language_of_linuxcnc_is_refused_at_the_start() {
    let mut memory = Box::new(Channel::<3, 30>::new());
    let machine = machine(Dialect::LinuxCnc);
    let result = memory.split(&machine, [Position::ZERO; 3], b"M2\n".as_slice()).map(|_| ());
    if cfg!(feature = "dialects") {
        assert!(result.is_ok());
    } else {
        assert!(
            matches!(result, Err(MachineError::NotBuilt(what)) if what.contains("`dialects`")),
            "{result:?}"
        );
    }
}
