//! Room for few functions: the look-ahead reaches less far, none is lost, and the motion stands only where it has to.
use glidepath::machine::Synch;
use glidepath::queue::ACTIONS;
use glidepath::{
    AxisData, AxisKind, AxisName, Channel, ChannelData, Function, Handles, MachineData, Position, Progress,
    State,
};
use std::fmt::Write;

const fn axis(name: &str) -> AxisData {
    match AxisName::new(name) {
        Some(name) => AxisData { a_max: 3000, ..AxisData::new(name, AxisKind::Linear) },
        None => panic!("not a name"),
    }
}

const BLOCKS: u16 = 200;

/// What came of a program.
struct Run {
    functions: Vec<Function>,
    ticks: usize,
    /// Those in which the path stood before its end.
    stands: usize,
    /// X, mm.
    end: f64,
}

fn run(program: &str, waits: Synch) -> Run {
    let channel = ChannelData { slope_profile: 1, ..ChannelData::new() };
    let mut machine = MachineData { axes: [axis("X"), axis("Y"), axis("Z")], channel };
    for m in 100..100 + 3 {
        machine.channel.m_synch = machine.channel.m_synch.with(m, waits);
    }
    let mut memory = Box::new(Channel::<3, 120>::new());
    let handles = memory.split(&machine, [Position::ZERO; 3], program.as_bytes()).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    let (mut functions, mut points, mut answers) = (Vec::new(), Vec::new(), Vec::new());
    loop {
        let progress = planner.poll().expect("it is carried out");
        if !matches!(progress, Progress::Done | Progress::Waiting) {
            continue;
        }
        let state = interpolator.tick();
        answers.drain(..).for_each(|function| operator.acknowledge(function).expect("it waits"));
        while let Some(output) = operator.output() {
            functions.push(output.function);
            answers.extend(output.waits.then_some(output.function));
        }
        if state == State::Idle && progress == Progress::Done {
            break;
        }
        points.push(interpolator.set_points()[0]);
        assert!(points.len() < 100_000, "it does not end");
    }
    let end = points[points.len() - 1];
    let stands =
        points.windows(2).filter(|pair| pair[0] == pair[1] && pair[0] != end && pair[0] != Position::ZERO);
    Run { functions, ticks: points.len(), stands: stands.count(), end: end.to_num() }
}

fn program(words: impl Fn(u16) -> String) -> String {
    let mut program = String::from("G01 F3000\n");
    for k in 1..=BLOCKS {
        let _ = writeln!(program, "X{k} F{} {}", 3000 + k % 2, words(k));
    }
    program + "M30\n"
}

#[test]
fn more_functions_than_there_is_room_for() {
    assert_eq!(ACTIONS, 16);
    let codes = [100, 101, 102];
    for (waits, per_block) in
        [(Synch::Mos, 1), (Synch::Mos, 3), (Synch::MvsSns, 1), (Synch::MnsSns, 2), (Synch::MvsSvs, 3)]
    {
        let told = |_| codes[..per_block].iter().map(|code| format!("M{code} ")).collect();
        let Run { functions, stands, end, .. } = run(&program(told), waits);
        let wanted: Vec<Function> =
            (0..BLOCKS).flat_map(|_| codes[..per_block].iter().map(|code| Function::M(*code))).collect();
        assert_eq!(functions, wanted, "{waits:?}");
        assert_eq!(end, f64::from(BLOCKS), "{waits:?}");
        assert!(
            (waits != Synch::Mos) || stands == 0,
            "{waits:?}, {per_block} in a block: {stands} ticks of rest"
        );
    }
}

/// Short blocks with a function each: the speed is that from which the motion stands within as many blocks as there is
/// room for.
#[test]
fn short_blocks_with_functions_do_not_stop() {
    let mut program = String::from("G01 F6000\n");
    for k in 1..=1000 {
        let _ = writeln!(program, "X{}.{} F{} M100", k / 10, k % 10, 6000 + k % 2);
    }
    program += "M30\n";
    let Run { functions, ticks, end, .. } = run(&program, Synch::Mos);
    assert_eq!((functions.len(), end), (1000, 100.0));
    // With a standstill wherever there is no room 44,879.
    assert!(ticks < 12_000, "{ticks} ticks");
}

/// All of a block at once, and as many alone between two blocks of a rounded corner.
#[test]
fn functions_that_fill_all_there_is_room_for() {
    let many = |count: usize, between: &str| (0..count).map(|_| format!("M100{between}")).collect::<String>();
    let contour = if cfg!(feature = "contour") { "#CONTOUR MODE ON [DEV PATH_DEV=0.1]\n" } else { "" };
    for waits in [Synch::Mos, Synch::MvsSns, Synch::MvsSvs, Synch::MnsSns] {
        let lines = many(2 * ACTIONS, "\n");
        let program =
            format!("{contour}G01 X10 F2000\n{lines}Y10\nX20\n{lines}Y20 M100 M100 M100 M100\nX30\nM30\n");
        let Run { functions, end, .. } = run(&program, waits);
        assert_eq!((functions.len(), end), (4 * ACTIONS + 4, 30.0), "{waits:?}");
    }
}
