//! The front page of the crate: its example runs to the end of its motion.
use std::path::Path;

#[test]
fn the_example_moves_to_the_end_of_its_program() {
    // <example>
    use glidepath::{AxisData, AxisKind, AxisName, Channel, ChannelData, Handles};
    use glidepath::{MachineData, Position, Progress, State};

    let axis = |name| AxisData::new(AxisName::new(name).unwrap(), AxisKind::Linear);
    let channel = ChannelData { slope_profile: 1, corr_v_trans_jerk: true, ..ChannelData::new() };
    let machine = MachineData { axes: [axis("X"), axis("Y"), axis("Z")], channel };
    let program: &[u8] = b"N10 G01 X10 Y5 F1000\nM30\n";

    // On a controller, make this a static variable. It holds all of the memory.
    let mut memory = Channel::<3, 120>::new();
    let handles = memory.split(&machine, [Position::ZERO; 3], program).unwrap();
    let Handles { mut planner, mut interpolator, operator } = handles;
    let mut planned = false;
    loop {
        // In the main loop or a task: plan until the queue is full, or until the whole program is planned.
        while !planned {
            match planner.poll().unwrap() {
                Progress::Done => planned = true,
                Progress::Waiting => break,
                _ => {}
            }
        }
        // In the timer interrupt, once per cycle:
        let state = interpolator.tick();
        let _to_the_drives: &[Position; 3] = interpolator.set_points();
        if planned && state == State::Idle {
            break;
        }
    }
    // In a PLC or serial task: take due functions, acknowledge them, give commands, read the status.
    assert_eq!((operator.output(), operator.status().n), (None, 10));
    assert_eq!(interpolator.set_points().map(|axis| axis.to_num::<f64>()), [10.0, 5.0, 0.0]);
    // </example>
}

#[test]
fn it_is_the_one_shown() {
    let read = |file: &str| {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
        std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
    };
    let between = |text: &str, begin: &str, end: &str| {
        let rest = text.split_once(begin).unwrap_or_else(|| panic!("{begin} is missing")).1;
        rest.split_once(end).unwrap_or_else(|| panic!("{end} is missing")).0.to_owned()
    };
    let page = read("src/lib.rs");
    let page: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("//!")).collect();
    // Behind the drawing, which is the first block of code.
    let page = page.join("\n");
    let shown = page.split(" ```").nth(3).expect("a block of code");
    let tested = between(&read("host-tests/tests/papers/front_page.rs"), "// <example>\n", "// </example>");
    let words = |text: &str| text.lines().map(str::trim).collect::<Vec<_>>().join("\n");
    assert_eq!(words(shown).trim(), words(&tested).trim());
}

/// The examples themselves run with `cargo test -p glidepath --doc`.
#[test]
fn every_public_module_begins_with_an_example() {
    let source = |file: String| {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src").join(file);
        std::fs::read_to_string(file)
    };
    let root = source("lib.rs".to_owned()).expect("the crate");
    let lines: Vec<&str> = root.lines().collect();
    // A module of a feature that is off by default has its examples in its paper and its tests.
    let is_public = |line: &str| line != "#[doc(hidden)]" && !line.starts_with("#[cfg(feature");
    let public = lines.windows(2).filter(|pair| is_public(pair[0]));
    let names = public.filter_map(|pair| pair[1].strip_prefix("pub mod ")?.strip_suffix(';'));
    let mut count = 0;
    for name in names {
        count += 1;
        let file =
            source(format!("{name}.rs")).or_else(|_| source(format!("{name}/mod.rs"))).expect("a module");
        assert!(file.lines().any(|line| line == "//! ```"), "{name} has no example");
    }
    assert!(count >= 10, "{count} modules");
}
