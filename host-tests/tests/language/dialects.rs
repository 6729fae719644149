//! Programs of LinuxCNC and Grbl: the commands of the decoder, compared with a separate interpreter.
#[path = "dialects/corpus.rs"]
mod corpus;
#[path = "dialects/interpreter.rs"]
mod interpreter;
#[path = "dialects/random.rs"]
mod random;
#[path = "dialects/values.rs"]
mod values;

use crate::nc_decode::decode_text;
use corpus::{CORPUS, REFUSED};
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, Dialect, MachineData, ToolLengths};
use glidepath::nc::{
    ArcBy, Command, ContourSwitch, Decoder, DecoderMemory, DwellTime, ExactStop, Motion, MotionKind,
    NcErrorKind, NcWarningKind, Setup, Step, WORDS, Window,
};
use glidepath::quantity::Position;
use glidepath::queue::Function;
use host_tests::cases::machines;
use host_tests::trace::run_text;
use interpreter::{Event, Final, Machine, Shape};

/// Tools of the machine, mm.
const TOOLS: [(u32, f64); 3] = [(1, 52.5), (2, 40.25), (3, -3.125)];

fn dialect_of(name: &str) -> Dialect {
    *Dialect::ALL.iter().find(|dialect| dialect.name() == name).expect("a dialect")
}

fn machine_of(names: [(&str, AxisKind); 3], dialect: Dialect) -> MachineData<3> {
    let axes = names.map(|(name, kind)| AxisData::new(AxisName::new(name).unwrap(), kind));
    let mut machine = MachineData { axes, channel: ChannelData::new() };
    // P-CHAN-00108 does not concern other dialects.
    machine.channel.feedrate_factor_milli = 12_345;
    machine.channel.foreign.dialect = dialect;
    machine.channel.foreign.tools = TOOLS
        .iter()
        .fold(ToolLengths::NONE, |tools, (number, mm)| tools.with(*number, (mm * 10_000.0).round() as i32));
    machine
}

fn setup(dialect: Dialect) -> Setup<3> {
    let linear = AxisKind::Linear;
    Setup::new(&machine_of([("X", linear), ("Y", linear), ("Z", linear)], dialect), [Position::ZERO; 3])
}

fn mm(position: Position) -> f64 {
    position.to_num()
}

fn of_motion(motion: &Motion<3>) -> Event {
    let plane_of = |plane: glidepath::nc::Plane| 17 + plane as u32;
    let shape = match motion.kind {
        MotionKind::Rapid => Shape::Rapid,
        MotionKind::Line => Shape::Line,
        MotionKind::Arc { plane, clockwise, by: ArcBy::Centre(centre) } => {
            Shape::Centre(clockwise, plane_of(plane), centre.map(mm))
        }
        MotionKind::Arc { plane, clockwise, by: ArcBy::Radius(r) } => {
            Shape::Radius(clockwise, plane_of(plane), mm(r))
        }
    };
    let feed = if shape == Shape::Rapid { 0.0 } else { mm(motion.feed) };
    Event::Move { shape, to: motion.target.map(mm), feed, stop: motion.exact_stop }
}

fn event(command: &Command<3>, text: &[u8]) -> Event {
    match command {
        Command::Motion(motion) => of_motion(motion),
        Command::Dwell(_, DwellTime::Seconds(time)) => Event::Dwell(mm(*time)),
        Command::M(_, code) => Event::M(u32::from(*code)),
        Command::Pause(_, code) => Event::Pause(u32::from(*code)),
        Command::Spindle(_, speed) => Event::Speed(mm(*speed)),
        Command::Tool(_, number) => Event::Tool(*number),
        Command::ProgramEnd(_, code) => Event::End(u32::from(*code)),
        Command::ExactStop(_, ExactStop::On) => Event::Stop(true),
        Command::ExactStop(_, ExactStop::Off) => Event::Stop(false),
        Command::Message(head) => {
            let from = head.place.offset as usize;
            let part = &text[from..from + usize::from(head.place.length)];
            Event::Message(String::from_utf8_lossy(part).trim().to_owned())
        }
        Command::Contour(_, contour) => match contour.switch {
            Some(ContourSwitch::On) => Event::Blend(mm(contour.path_dev.expect("a deviation"))),
            Some(ContourSwitch::Off) => Event::NoBlend,
            other => panic!("{other:?}"),
        },
        Command::Output(_, Function::Digital(port, on), at_once) => {
            Event::Digital(u32::from(*port), *on, *at_once)
        }
        Command::Output(_, Function::Analog(port, value), at_once) => {
            Event::Analog(u32::from(*port), mm(*value), *at_once)
        }
        Command::WaitInput(_, wait) => {
            Event::Input(u32::from(wait.port), wait.is_analog, u32::from(wait.mode), wait.timeout_ms)
        }
        other => panic!("unexpected {}", other.name()),
    }
}

/// Alike to a billionth of a millimetre; of what a feed in inches leaves, to 10^-8 mm/min.
fn is_alike(a: &Event, b: &Event) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 2e-9 + 1e-12 * b.abs();
    match (a, b) {
        (
            Event::Move { shape: sa, to: ta, feed: fa, stop: pa },
            Event::Move { shape: sb, to: tb, feed: fb, stop: pb },
        ) => {
            let shapes = match (sa, sb) {
                (Shape::Centre(wa, pa, ca), Shape::Centre(wb, pb, cb)) => {
                    wa == wb && pa == pb && ca.iter().zip(cb).all(|(a, b)| near(*a, *b))
                }
                (Shape::Radius(wa, pa, ra), Shape::Radius(wb, pb, rb)) => {
                    wa == wb && pa == pb && near(*ra, *rb)
                }
                _ => sa == sb,
            };
            // Lengths of arcs are sums of chords.
            let feeds = near(*fa, *fb) || (fa - fb).abs() <= 1e-7 * fb;
            shapes && ta.iter().zip(tb).all(|(a, b)| near(*a, *b)) && feeds && pa == pb
        }
        (Event::Dwell(a), Event::Dwell(b))
        | (Event::Speed(a), Event::Speed(b))
        | (Event::Blend(a), Event::Blend(b)) => near(*a, *b),
        (Event::Analog(p, a, once), Event::Analog(q, b, other)) => p == q && near(*a, *b) && once == other,
        _ => a == b,
    }
}

/// Whether an arc goes on in the next one with another radius: both are one spiral of the program.
fn is_part_of_spiral(arc: &Event, next: &Event) -> bool {
    let radius = |event: &Event| match event {
        Event::Move { shape: Shape::Centre(_, plane, centre), to, .. } => {
            let [a, b] = [[0, 1], [2, 0], [1, 2]][*plane as usize - 17];
            Some((to[a] - centre[0]).hypot(to[b] - centre[1]))
        }
        _ => None,
    };
    let (Event::Move { shape: one, .. }, Event::Move { shape: other, .. }) = (arc, next) else {
        return false;
    };
    matches!((radius(arc), radius(next)), (Some(a), Some(b)) if one == other && a > 45.0 && (0.01..0.5).contains(&(a - b).abs()))
}

/// What is in force at the end, beside what the own interpreter says.
fn compare_end(name: &str, dialect: Dialect, text: &[u8], wanted: &Final) {
    let mut memory = DecoderMemory::new();
    let mut decoder: Decoder<_, 3> = Decoder::new(&mut memory, setup(dialect), text);
    while decoder.step() != Ok(Step::End) {}
    let force = decoder.in_force().expect("between lines");
    let found = Final {
        motion: u32::from(force.motion()),
        plane: u32::from(force.plane()),
        inch: force.is_inch(),
        incremental: force.is_relative(),
        by_time: force.is_by_time(),
        per_turn: force.is_per_turn(),
        system: force.zero_offset(),
        tool: force.tool(),
        spindle: u32::from(force.spindle()),
        coolant: force.coolant(),
        here: force.here().map(mm),
        length: force.tool_length().map(mm),
        feed: mm(force.feed()),
        speed: mm(force.speed()),
    };
    let near = |a: f64, b: f64| (a - b).abs() <= 2e-9 + 1e-12 * b.abs();
    let lengths = found.here.iter().chain(&found.length).chain([&found.feed, &found.speed]);
    let others = wanted.here.iter().chain(&wanted.length).chain([&wanted.feed, &wanted.speed]);
    let alike = lengths.zip(others).all(|(a, b)| near(*a, *b));
    let Final { here, length, feed, speed, .. } = *wanted;
    let rest = Final { here, length, feed, speed, ..found.clone() };
    let text = String::from_utf8_lossy(text);
    assert!(alike && rest == *wanted, "{name}: {found:?}, expected {wanted:?}\n{text}");
}

/// What both make of a text, event by event.
fn compare(name: &str, dialect: Dialect, text: &[u8]) -> Vec<NcWarningKind> {
    let (commands, warnings, error, _) = decode_text(setup(dialect), text, 1_000_000);
    if let Some(error) = error {
        panic!("{name}: line {}: {error}\n{}", error.place.line, String::from_utf8_lossy(text));
    }
    let mut machine = Machine::new(dialect.name(), &TOOLS);
    machine.run(&String::from_utf8_lossy(text));
    let mut events: Vec<Event> = commands.iter().map(|command| event(command, text)).collect();
    for index in (1..events.len()).rev() {
        if is_part_of_spiral(&events[index - 1], &events[index]) {
            events.remove(index - 1);
        }
    }
    for (index, (found, wanted)) in events.iter().zip(&machine.events).enumerate() {
        let text = String::from_utf8_lossy(text);
        assert!(
            is_alike(found, wanted),
            "{name}, event {index}: {found:?}, expected {wanted:?}; before {:?}\n{text}",
            &events[index.saturating_sub(3)..index]
        );
    }
    assert_eq!(events.len(), machine.events.len(), "{name}: {events:?}\n{:?}", machine.events);
    compare_end(name, dialect, text, &machine.state());
    warnings.iter().map(|warning| warning.kind).collect()
}

/// The same with another look: the meaning stays.
fn variants(text: &str) -> Vec<Vec<u8>> {
    let outside = |change: &dyn Fn(char, &mut String)| {
        let (mut changed, mut comment) = (String::new(), ' ');
        for c in text.chars() {
            match (comment, c) {
                (' ', '(' | ';') => comment = c,
                ('(', ')') | ('(' | ';', '\n') => {
                    comment = ' ';
                    changed.push(c);
                    continue;
                }
                _ => {}
            }
            if comment == ' ' { change(c, &mut changed) } else { changed.push(c) }
        }
        changed
    };
    let lower = outside(&|c, out| out.push(c.to_ascii_lowercase()));
    let dense = outside(&|c, out| {
        if c != ' ' {
            out.push(c);
        }
    });
    let wide = outside(&|c, out| {
        out.push(c);
        if c != '\n' && c != '\r' {
            out.push_str(" \t");
        }
    });
    let unix = text.replace("\r\n", "\n");
    let mut all: Vec<Vec<u8>> = [text.to_owned(), lower, dense, wide].map(String::into_bytes).to_vec();
    all.push(unix.replace('\n', "\r\n").into_bytes());
    all.push(unix.replace('\n', "  \n").into_bytes());
    all.push(unix.trim_end().as_bytes().to_vec());
    all.push(format!("\u{feff}{text}").into_bytes());
    all
}

#[test]
fn programs_do_what_an_own_interpreter_says() {
    assert!(CORPUS.len() >= 102);
    for (name, dialect, text) in CORPUS {
        for (number, variant) in variants(text).iter().enumerate() {
            compare(&format!("{name}, variant {number}"), dialect_of(dialect), variant);
        }
    }
}

#[test]
fn values_loops_and_subroutines_come_to_plain_programs() {
    for dialect in [Dialect::LinuxCnc, Dialect::Grbl] {
        for (program, plain) in values::VALUES {
            let events = |text: &str| {
                let (commands, _, error, _) = decode_text(setup(dialect), text.as_bytes(), 100_000);
                assert!(error.is_none(), "{error:?} in\n{text}");
                commands.iter().map(|command| event(command, text.as_bytes())).collect::<Vec<_>>()
            };
            let (own, wanted) = (events(program), events(plain));
            let alike = own.len() == wanted.len() && own.iter().zip(&wanted).all(|(a, b)| is_alike(a, b));
            assert!(alike, "{program}\n{own:?}\n{plain}\n{wanted:?}");
        }
    }
}

#[test]
fn numbers_and_subprograms_of_fanuc_come_to_plain_programs() {
    let pairs = values::FANUC.iter().map(|pair| (Dialect::Fanuc, pair));
    for (dialect, (program, plain)) in pairs.chain(values::STATE.iter().map(|pair| (Dialect::LinuxCnc, pair)))
    {
        let events = |text: &str| {
            let (commands, _, error, _) = decode_text(setup(dialect), text.as_bytes(), 100_000);
            assert!(error.is_none(), "{error:?} in\n{text}");
            commands.iter().map(|command| event(command, text.as_bytes())).collect::<Vec<_>>()
        };
        let (own, wanted) = (events(program), events(plain));
        let alike = own.len() == wanted.len() && own.iter().zip(&wanted).all(|(a, b)| is_alike(a, b));
        assert!(alike, "{program}\n{own:?}\n{plain}\n{wanted:?}");
    }
    // Told once, not in each line.
    let (_, warnings, ..) = decode_text(setup(Dialect::Fanuc), &b"G0 X1\nX2\nX3.\nM30"[..], 1000);
    assert_eq!(warnings.iter().map(|w| w.kind).collect::<Vec<_>>(), [NcWarningKind::LeastIncrement]);
}

/// The long form: `cargo run --release -p host-tests --example mutate`.
#[test]
fn mutated_lines_come_to_an_end_and_no_value_does_nothing() {
    for dialect in Dialect::ALL {
        let found = host_tests::mutate::search(*dialect, 0, 250_000);
        assert_eq!(found.silent, Vec::<String>::new());
        assert!(*dialect == Dialect::Isg || found.values > 500, "{found:?}");
    }
}

#[test]
fn a_spiral_has_its_programmed_end_and_grows_evenly() {
    let text = "G90 G17\nG0 X0 Y0\nG2 X1000.9 Y0 Z9 I500 J0 F1000\nM2";
    let parts = motions(Dialect::LinuxCnc, text).split_off(0);
    let arcs: Vec<_> = parts.iter().filter(|m| matches!(m.kind, MotionKind::Arc { .. })).collect();
    // 0.4 mm of 500 are below 0.1 %, and nine times 0.045.
    let text = "G90 G17\nG0 X0 Y0\nG2 X1000.4 Y0 Z9 I500 J0 F1000\nM2";
    assert_eq!(arcs.len(), 1, "0.9 mm are refused where the arc is planned");
    let arcs: Vec<_> = motions(Dialect::LinuxCnc, text)
        .into_iter()
        .filter(|m| matches!(m.kind, MotionKind::Arc { .. }))
        .collect();
    assert_eq!(arcs.len(), 9);
    for (arc, k) in arcs.iter().zip(1..) {
        let [x, y, z] = arc.target.map(mm);
        let part = f64::from(k) / 9.0;
        let (radius, angle) = (500.0 + 0.4 * part, std::f64::consts::PI * (1.0 - part));
        let wanted = [500.0 + radius * angle.cos(), radius * angle.sin(), 9.0 * part];
        assert!(
            [x, y, z].iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-8),
            "{k}: {x} {y} {z}, {wanted:?}"
        );
    }
    assert_eq!(arcs[8].target.map(mm)[1], 0.0);
}

#[test]
fn probing_is_a_command_with_its_kind_and_target() {
    for (word, towards, must) in [(2, true, true), (3, true, false), (4, false, true), (5, false, false)] {
        let text = format!("G21 G91 G38.{word} Z-10 F50");
        let (commands, _, error, _) = decode_text(setup(Dialect::LinuxCnc), text.as_bytes(), 100);
        assert!(error.is_none(), "{error:?}");
        let [Command::Probe(_, probe)] = commands.as_slice() else { panic!("{commands:?}") };
        assert_eq!((probe.towards, probe.must_switch, mm(probe.target[2])), (towards, must, -10.0));
        assert_eq!(mm(probe.feed), 50.0);
        // The next motion needs its word.
        let text = format!("{text}\nZ1");
        let (_, _, error, _) = decode_text(setup(Dialect::LinuxCnc), text.as_bytes(), 100);
        assert_eq!(error.map(|error| error.found.as_str().to_owned()).as_deref(), Some("Z1"));
    }
}

#[test]
fn random_programs_do_what_an_own_interpreter_says() {
    for seed in host_tests::seeds::seeds(0..600, 60) {
        for dialect in [Dialect::LinuxCnc, Dialect::Grbl, Dialect::Fanuc] {
            let text = random::program(seed, dialect.name());
            compare(&format!("seed {seed}"), dialect, text.as_bytes());
        }
    }
}

/// M00, M01 and block skip of ISG's language: switches of the machine data decide about M01 and `/`.
#[test]
fn programs_of_isg_pause_and_leave_blocks_out() {
    const TEXT: &[u8] = b"N10 G00 X1\n/N20 X2\n/ N30 X3\nN40 G01 X4 F100 M00\nN50 M01\nN60 X5\nM30\n";
    let events = |switch: bool| {
        let mut setup = setup(Dialect::Isg);
        (setup.foreign.block_delete, setup.foreign.optional_stop) = (switch, switch);
        let (commands, _, error, _) = decode_text(setup, TEXT, 1000);
        assert_eq!(error, None);
        let of = |command: &Command<3>| match command {
            Command::Motion(motion) => Some(mm(motion.target[0]) as i32),
            Command::Pause(_, code) => Some(-1 - i32::from(*code)),
            _ => None,
        };
        commands.iter().filter_map(of).collect::<Vec<_>>()
    };
    assert_eq!(events(false), [1, 2, 3, 4, -1, 5]);
    assert_eq!(events(true), [1, 4, -1, -2, 5]);
}

#[test]
fn what_is_not_built_or_wrong_is_refused_by_name() {
    for (dialect, text, named) in REFUSED {
        let (commands, _, error, _) = decode_text(setup(dialect_of(dialect)), text.as_bytes(), 10_000);
        let Some(error) = error else { panic!("{text} is accepted: {commands:?}") };
        let told = error.to_string();
        assert!(
            told.contains(named) || error.found.contains(named),
            "{text}: {told}, found {:?}",
            error.found
        );
        use NcErrorKind as K;
        let says = matches!(
            error.kind,
            K::Twice(_)
                | K::Conflict(_)
                | K::AxisNotHere
                | K::Unclosed { .. }
                | K::Unopened { .. }
                | K::NoLoop
                | K::DivisionByZero
                | K::Domain(_)
        );
        assert!(told.contains("expected") || says, "{text}: {told}");
        assert_eq!(error.place.line as usize, text.lines().count(), "{text}");
    }
}

#[test]
fn every_word_of_the_table_is_known_and_no_other() {
    for dialect in [Dialect::LinuxCnc, Dialect::Grbl, Dialect::Fanuc] {
        for (letter, most) in [('G', 1200_u16), ('M', 10_100)] {
            for tenths in 0..most {
                let listed = WORDS.iter().filter(|word| word.letter == letter && word.tenths == tenths);
                let here: Vec<_> = listed.filter(|word| word.is_in(dialect)).collect();
                assert!(here.len() <= 1, "{letter}{tenths} is there twice");
                let text = format!("{letter}{}.{}", tenths / 10, tenths % 10);
                let (_, _, error, _) = decode_text(setup(dialect), text.as_bytes(), 1000);
                let kind = error.map(|error| error.kind);
                let own = match dialect {
                    Dialect::LinuxCnc => 1000..1991,
                    Dialect::Fanuc => 100..9991,
                    _ => 0..0,
                };
                let user = letter == 'M' && own.contains(&tenths) && tenths % 10 == 0;
                let unknown = matches!(kind, Some(NcErrorKind::UnknownCode(_)));
                assert_eq!(unknown, here.is_empty() && !user, "{text}: {kind:?}");
                if let Some(Err(_)) = here.first().map(|word| word.is_built()) {
                    assert!(matches!(kind, Some(NcErrorKind::Known { .. })), "{text}: {kind:?}");
                }
            }
        }
    }
}

fn motions(dialect: Dialect, text: &str) -> Vec<Motion<3>> {
    let (commands, _, error, _) = decode_text(setup(dialect), text.as_bytes(), 1_000_000);
    assert_eq!(error, None, "{text}");
    let motion =
        |command: &Command<3>| if let Command::Motion(motion) = command { Some(*motion) } else { None };
    commands.iter().filter_map(motion).collect()
}

/// A decimal times 25.4 in units of 2^-32, to nearest.
fn inches(mantissa: i128, scale: u32) -> i64 {
    let (dividend, divisor) = ((mantissa * 254) << 32, 10_i128.pow(scale + 1));
    ((2 * dividend + divisor).div_euclid(2 * divisor)) as i64
}

#[test]
fn inches_are_exact_for_positions_and_feeds() {
    let mut random = crate::nc_decode::Random(77);
    for _ in 0..400 {
        let (mantissa, scale) = (i128::from(random.below(9_999_999)) + 1, random.below(7) as u32);
        let digits = format!("{:0>8}", mantissa);
        let (whole, part) = digits.split_at(digits.len() - scale as usize);
        let text = format!("G20 G1\nF{whole}.{part}\nX{whole}.{part}\nX0 Y-{whole}.{part}");
        if mantissa * 26 > 90_000 * 10_i128.pow(scale) {
            continue;
        }
        let found = motions(Dialect::Grbl, &text);
        let wanted = inches(mantissa, scale);
        assert_eq!(found[0].target[0].to_bits(), wanted, "{text}");
        assert_eq!(found[0].feed.to_bits(), wanted, "{text}");
        let both = found[1].target[1].to_bits();
        assert!((both + wanted).abs() <= 1, "{text}");
    }
    // Tenths of an inch come to whole millimetres and their tenths: increments do not drift.
    let steps = "G20 G91 G1 F1\n".to_owned() + &"X0.1\n".repeat(1000);
    let last = motions(Dialect::LinuxCnc, &steps).pop().unwrap();
    assert_eq!(last.target[0], Position::from_num(2540));
}

#[test]
fn the_same_geometry_has_one_digest() {
    let isg = "G00 X10 Y5\nG01 X20 F600\nG02 X25 Y10 I0 J5\nG01 Y20\nG03 I-5 J0\nG04 0.25\nG00 X0 Y0 Z3\nG01 X1 Z-1 F1200\nM30\n";
    let words = "G21 G90\nG0 X10 Y5\nG1 X20 F600\nG2 X25 Y10 I0 J5\nG1 Y20\nG3 I-5 J0\nG4 P0.25\nG0 X0 Y0 Z3\nG1 X1 Z-1 F1200\nM30\n";
    let run = |dialect, text: &str| {
        let mut machine = machines::even::<3>(1000);
        machine.channel.foreign.dialect = dialect;
        run_text::<3, 120>(text, [Position::ZERO; 3], &machine, 1).expect("a program").digest
    };
    let wanted = run(Dialect::Isg, isg);
    assert_ne!(wanted, run(Dialect::Isg, "G00 X1\nM30\n"));
    for dialect in [Dialect::LinuxCnc, Dialect::Grbl] {
        assert_eq!(run(dialect, words), wanted, "{dialect:?}");
    }
    // Fanuc counts numbers without a decimal point in thousandths.
    let points = words.replace("P0.25", "X0.25");
    let points: String = points
        .split(' ')
        .map(|word| {
            if word.starts_with(['X', 'Y', 'Z', 'I', 'J']) && !word.contains('.') {
                word.replacen('\n', ".\n", 1) + if word.contains('\n') { "" } else { "." }
            } else {
                word.to_owned()
            }
        })
        .collect::<Vec<_>>()
        .join(" ");
    assert_eq!(run(Dialect::Fanuc, &points), wanted, "{points}");
    assert_ne!(run(Dialect::Fanuc, words), wanted);
}

#[test]
fn radii_may_differ_as_much_as_the_peers_permit() {
    let run = |dialect, text: &str| {
        let mut machine = machines::even::<3>(1000);
        machine.channel.foreign.dialect = dialect;
        run_text::<3, 120>(text, [Position::ZERO; 3], &machine, 1).map(|run| run.digest)
    };
    // The radius is 10 at the start, and more at the end by what is written.
    let arc = |more: &str| format!("G0 X10\nF600\nG3 X0 Y{more} I-10\n");
    for (more, isg, others) in
        [("10.009", true, true), ("10.012", false, false), ("10.0005", true, true), ("10.0101", false, false)]
    {
        assert_eq!(run(Dialect::Isg, &arc(more)).is_ok(), isg, "{more}");
        for dialect in [Dialect::LinuxCnc, Dialect::Grbl] {
            assert_eq!(run(dialect, &arc(more)).is_ok(), others, "{more}");
        }
    }
    // At radii of 0.5, 20 and 400 mm.
    for (text, isg) in [
        ("G0 X0.5\nF600\nG3 X0 Y0.504 I-0.5\n", false),
        ("G0 X20\nF600\nG3 X0 Y20.0198 I-20\n", false),
        ("G0 X400\nF600\nG3 X0 Y400.04 I-400\n", true),
    ] {
        assert_eq!(run(Dialect::Isg, text).is_ok(), isg, "{text}");
        assert!(run(Dialect::LinuxCnc, text).is_ok(), "{text}");
    }
    assert!(run(Dialect::Grbl, "G0 X400\nF600\nG3 X0 Y400.3 I-400\n").is_ok(), "0.1 % is 0.4 mm");
    assert!(run(Dialect::Grbl, "G0 X400\nF600\nG3 X0 Y400.45 I-400\n").is_err(), "more than 0.1 %");
    // Half a thousandth of an inch, at a radius of a tenth of one: LinuxCNC's programs in inches alone.
    let inch = |more: &str| format!("G20\nG0 X0.1\nF20\nG3 X0 Y{more} I-0.1\nG1 X1\nM2\n");
    assert!(run(Dialect::LinuxCnc, &inch("0.1004")).is_ok() && run(Dialect::Grbl, &inch("0.1004")).is_err());
    assert!(run(Dialect::LinuxCnc, &inch("0.1006")).is_err());
    assert!(run(Dialect::LinuxCnc, "G0 X2.54\nF600\nG3 X0 Y2.55 I-2.54\n").is_err());
    // 5 µm of a radius of 10 µm: there is no arc, the end counts.
    assert!(run(Dialect::LinuxCnc, "G0 X0.01\nF600\nG3 X0 Y0.006 I-0.01\n").is_ok());
}

#[test]
fn doubtful_words_are_told() {
    let told = |dialect, text: &str| {
        let (_, warnings, error, _) = decode_text(setup(dialect), text.as_bytes(), 10_000);
        assert_eq!(error, None, "{text}");
        warnings.iter().map(|warning| warning.kind).collect::<Vec<_>>()
    };
    use NcWarningKind as K;
    let linuxcnc = |text: &str| told(Dialect::LinuxCnc, text);
    assert_eq!(linuxcnc("G64\nM2"), [K::BlendTolerance(20)]);
    assert_eq!(linuxcnc("G64 P0.1 Q0.1\nM2"), [K::NoMerging]);
    assert_eq!(linuxcnc("G4 P500\nM2"), [K::LongDwell]);
    assert_eq!(linuxcnc("G20 F10\nM2"), [K::FeedBeforeUnit]);
    assert_eq!(linuxcnc("M50 P0\nM2"), [K::OverridesStay]);
    assert_eq!(linuxcnc("M101 P2 Q0.5\nM2"), [K::NoArguments]);
    assert_eq!(told(Dialect::Grbl, "$G\n $ x\n?"), [K::Report; 3]);
    assert_eq!(told(Dialect::Grbl, "G20 F10\nM2"), []);
    assert_eq!(linuxcnc("G0 X1"), [K::NoProgramEnd]);
    assert_eq!(told(Dialect::Grbl, "G0 X1"), []);
    assert_eq!(told(Dialect::Grbl, "/G0 X1"), [K::BlockSkip]);
    assert_eq!(linuxcnc("(DEBUG, #1)\n(print, #1)\n(logopen, x)\nM2"), [K::ActiveComment]);
    assert_eq!(linuxcnc("G0 X1 (open\nM2"), [K::UnclosedComment]);
    let mut bare = setup(Dialect::LinuxCnc);
    bare.foreign.tools = ToolLengths::NONE;
    let (_, warnings, error, _) = decode_text(bare, &b"G43 H1\nM2"[..], 1000);
    assert_eq!((error, warnings[0].kind), (None, K::NoToolTable));
    let mut bare = setup(Dialect::Grbl);
    bare.foreign.tools = ToolLengths::NONE;
    let (_, _, error, _) = decode_text(bare, &b"G43 H0\nG43 H1\nM2"[..], 1000);
    assert_eq!(error.map(|error| error.place.line), Some(2));
}

#[test]
fn switches_of_the_machine_data_count() {
    let mut switched = setup(Dialect::LinuxCnc);
    switched.foreign.block_delete = true;
    switched.foreign.optional_stop = true;
    let (commands, ..) = decode_text(switched, &b"/G0 X5\nG0 X1 M1\nM2"[..], 1000);
    let names: Vec<_> = commands.iter().map(Command::name).collect();
    assert_eq!(names, ["G00", "pause", "program end"]);
    switched.foreign.stored[0][2] = Position::from_num(7);
    switched.foreign.offsets[1][0] = Position::from_num(3);
    let (commands, ..) = decode_text(switched, &b"G59.2 G0 X1\nG91 G28 Z1\nM2"[..], 1000);
    let ends: Vec<_> = commands
        .iter()
        .filter_map(|c| if let Command::Motion(m) = c { Some(m.target.map(mm)) } else { None })
        .collect();
    assert_eq!(ends, [[4.0, 0.0, 0.0], [4.0, 0.0, 1.0], [4.0, 0.0, 7.0]]);
}

#[test]
fn a_refused_line_leaves_nothing_behind() {
    // What each line would put in force is not in force behind it.
    let lines = [
        "G91 G20 G18 F1 G92 X5 E1",
        "G55 G99 G54 X1",
        "G81 X1 Z-1 R1 F100 E1",
        "G80 X1",
        "G43 H3 E1",
        "G10 L2 P1 X5 E1",
        "G59.3 G10 L20 P0 X5 E1",
        "G92.2 X1",
        "G64 P0.1 E1",
        "G61.1 E1",
        "M3 E1",
        "T3 E1",
        "G28.1 X1",
        "M2 E1",
    ];
    for line in lines {
        let text =
            format!("G21 G90 G54\nG0 X1 Y1 Z1\nG92 Y2\nG1 X2 F500\n{line}\nX3 Y3\nG43\nG28\nG54 X0 Z0\nM2\n");
        let mut memory = DecoderMemory::new();
        let mut decoder: Decoder<_, 3> = Decoder::new(&mut memory, setup(Dialect::LinuxCnc), text.as_bytes());
        let (mut commands, mut refused) = (Vec::new(), 0);
        loop {
            match decoder.step() {
                Ok(Step::Command(command)) => commands.push(command),
                Ok(Step::End) if decoder.is_refused() => decoder.go_on(decoder.position()),
                Ok(Step::End) => break,
                Ok(_) => {}
                Err(_) => refused += 1,
            }
        }
        assert_eq!(refused, 1, "{line}");
        let without = text.replace(&format!("{line}\n"), "\n");
        let (wanted, _, error, _) = decode_text(setup(Dialect::LinuxCnc), without.as_bytes(), 10_000);
        assert_eq!(error, None);
        let events =
            |commands: &[Command<3>]| -> Vec<Event> { commands.iter().map(|c| event(c, &[])).collect() };
        assert_eq!(events(&commands), events(&wanted), "{line}");
    }
}

#[test]
fn the_next_program_begins_as_it_should() {
    let first = "G20 G91 G18 G99 G55\nG92 X1\nG1 X1 F10\nG43.1 Z2\nM3\nM2\n";
    let second = "X1 Y1 Z1\nG1 X2\nM2\n";
    let mut memory = DecoderMemory::new();
    let mut decoder: Decoder<_, 3> = Decoder::new(&mut memory, setup(Dialect::LinuxCnc), first.as_bytes());
    let mut machine = Machine::new("linuxcnc", &TOOLS);
    machine.run(first);
    let mut events = Vec::new();
    for _ in 0..1000 {
        if let Ok(Step::Command(command)) = decoder.step() {
            events.push(event(&command, &[]));
        }
    }
    decoder.load(second.as_bytes(), decoder.position(), false);
    machine.begin(0);
    machine.run(second);
    for _ in 0..1000 {
        if let Ok(Step::Command(command)) = decoder.step() {
            events.push(event(&command, &[]));
        }
    }
    assert_eq!(events.len(), machine.events.len());
    assert!(
        events.iter().zip(&machine.events).all(|(a, b)| is_alike(a, b)),
        "{events:?}\n{:?}",
        machine.events
    );
}

#[test]
fn a_stream_says_the_same() {
    for (name, dialect, text) in CORPUS {
        let dialect = dialect_of(dialect);
        let (wanted, ..) = decode_text(setup(dialect), text.as_bytes(), 1_000_000);
        let mut window = Window::<512>::new();
        let (mut feeder, stream) = window.split();
        let mut memory = DecoderMemory::new();
        let mut decoder: Decoder<_, 3> = Decoder::new(&mut memory, setup(dialect), stream);
        let (mut rest, mut commands) = (text.as_bytes(), Vec::new());
        loop {
            match decoder.step().unwrap_or_else(|error| panic!("{name}: {error}")) {
                Step::Command(command) => commands.push(command),
                Step::End => break,
                Step::Late if rest.is_empty() => feeder.end(),
                Step::Late => {
                    let count = feeder.push(&rest[..rest.len().min(7)]);
                    rest = &rest[count..];
                }
                _ => {}
            }
        }
        assert_eq!(commands, wanted, "{name}");
    }
}

#[test]
fn inches_do_not_concern_degrees() {
    let (linear, rotary) = (AxisKind::Linear, AxisKind::Rotary);
    let machine = machine_of([("X", linear), ("Y", linear), ("A", rotary)], Dialect::LinuxCnc);
    let setup = Setup::new(&machine, [Position::ZERO; 3]);
    let text = "G20 G1 F10\nA90\nX1\nX2 A180\nG21 F100\nA0\nG20\nA5\nX3\nM2\n";
    let (commands, _, error, _) = decode_text(setup, text.as_bytes(), 10_000);
    assert_eq!(error, None);
    let found: Vec<_> = commands
        .iter()
        .filter_map(|c| if let Command::Motion(m) = c { Some((mm(m.target[2]), mm(m.feed))) } else { None })
        .collect();
    // F beside G20 and G21: LinuxCNC takes it in the unit before. Degrees have no inches.
    assert_eq!(found, [(90.0, 10.0), (90.0, 10.0), (180.0, 10.0), (0.0, 100.0), (5.0, 100.0), (5.0, 2540.0)]);
}

/// The tick at which `wanted` of a program is acknowledged; what the axes did.
fn paused(text: &str, wanted: Function, wait: usize) -> (usize, usize, Vec<[f64; 3]>) {
    let mut machine = machines::even::<3>(1000);
    machine.channel.foreign.dialect = Dialect::Grbl;
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
    let (mut rows, mut out, mut acknowledged) = (Vec::new(), None, None);
    for tick in 0..20_000 {
        for _ in 0..200 {
            match planner.poll().expect("a program") {
                Progress::Waiting | Progress::Done => break,
                _ => {}
            }
        }
        interpolator.tick();
        rows.push(interpolator.set_points().map(mm));
        while let Some(output) = operator.output() {
            if output.function == wanted {
                assert!(output.waits, "{text}");
                out = Some(tick);
            }
        }
        if out.is_some_and(|out| tick == out + wait) {
            operator.acknowledge(wanted).expect("it waits");
            acknowledged = Some(tick);
        }
    }
    (out.expect("it comes out"), acknowledged.expect("it is acknowledged"), rows)
}

#[test]
fn a_pause_waits_for_whoever_acknowledges_it() {
    for (word, code) in [("M0", 0), ("M60", 60), ("M6", 6)] {
        // M6 stands before the motion of its block, the others behind it.
        let text = format!("G21 F1200\nG1 X5\nX10 {word}\nX20\nM2\n");
        let (out, acknowledged, rows) = paused(&text, Function::M(code), 700);
        assert_eq!(acknowledged, out + 700);
        let rest = if code == 6 { 5.0 } else { 10.0 };
        for row in &rows[out + 1..acknowledged] {
            assert!((row[0] - rest).abs() < 1e-9, "{text}: {row:?}");
        }
        assert_eq!(rows.last().map(|row| row[0]), Some(20.0));
    }
}

#[test]
fn arcs_of_unequal_radii_keep_the_limits_of_the_axes() {
    let mut machine = machines::with_slope(machines::even::<3>(1000), 1);
    machine.channel.foreign.dialect = Dialect::LinuxCnc;
    machine.channel.corr_v_trans_jerk = true;
    let mut random = crate::nc_decode::Random(4711);
    let mut driven = 0;
    for _ in 0..150 {
        let part = |random: &mut crate::nc_decode::Random, most: f64| {
            random.below(1 << 30) as f64 / (1 << 30) as f64 * most
        };
        let radius = 10.0_f64.powf(part(&mut random, 4.0) - 1.7);
        let differs = if radius > 5.0 { radius / 1001.0 } else { 0.004_99_f64.min(radius / 4.1) }.min(0.0499);
        let end = radius + (part(&mut random, 2.0) - 1.0) * differs;
        let [from, turn] = [part(&mut random, std::f64::consts::TAU), part(&mut random, 6.2) + 0.05];
        let clockwise = random.below(2) == 0;
        let to = if clockwise { from - turn } else { from + turn };
        let [x, y] = [radius * from.cos(), radius * from.sin()];
        let text = format!(
            "F12000\nG0 X{x:.7} Y{y:.7}\nG{} X{:.7} Y{:.7} I{:.7} J{:.7}\nM2\n",
            if clockwise { 2 } else { 3 },
            end * to.cos(),
            end * to.sin(),
            -x,
            -y
        );
        let run = run_text::<3, 120>(&text, [Position::ZERO; 3], &machine, 1).expect(&text);
        let limits: Vec<_> = machine
            .axes
            .iter()
            .map(|axis| host_tests::properties::permitted(axis, 1, true, true, true))
            .collect();
        host_tests::check::limits(&run.trace, &limits).unwrap_or_else(|e| panic!("{e}\n{text}"));
        driven += 1;
    }
    assert_eq!(driven, 150);
}
