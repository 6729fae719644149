//! One channel from power-up to power-off: the next program, single lines, refused lines, aborts, positions.
use glidepath::channel::{Channel, Error, GoOnError, Handles, Planner, PositionError, Progress};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::nc::{Stream, Text, TextError, Window};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::queue::Function;
use glidepath::tick::{Interpolator, State};

const BLOCKS: usize = 30;

fn machine() -> MachineData<3> {
    let axis = |name| {
        let mut axis = AxisData::new(AxisName::new(name).unwrap(), AxisKind::Linear);
        axis.versch[0] = 50_000;
        axis
    };
    let channel = ChannelData {
        slope_profile: 1,
        look_ahead: BLOCKS as u32,
        corr_v_trans_jerk: true,
        ..ChannelData::new()
    };
    MachineData { axes: [axis("X"), axis("Y"), axis("Z")], channel }
}

fn mm(value: f64) -> Position {
    Position::from_num(value)
}

/// A channel at work, and what came of it.
struct Bench<'a, T: Text> {
    planner: Planner<'a, T, 3, BLOCKS>,
    interpolator: Interpolator<'a, 3>,
    operator: Operator<'a, 3>,
    /// Largest step of an axis from one tick to the next, but for those after a position was set.
    jump: f64,
    ticks: usize,
    before_tick: Box<dyn FnMut() + 'a>,
}

impl<'a, T: Text> Bench<'a, T> {
    fn new(memory: &'a mut Channel<3, BLOCKS>, machine: &'a MachineData<3>, text: T) -> Self {
        Self::at(memory, machine, [Position::ZERO; 3], text)
    }

    fn at(
        memory: &'a mut Channel<3, BLOCKS>,
        machine: &'a MachineData<3>,
        start: [Position; 3],
        text: T,
    ) -> Self {
        let Handles { planner, interpolator, operator } = memory.split(machine, start, text).unwrap();
        Self { planner, interpolator, operator, jump: 0.0, ticks: 0, before_tick: Box::new(|| {}) }
    }

    /// Runs to a standstill with nothing left; the refusals on the way, and the ticks of motion.
    fn run(&mut self) -> Vec<Error> {
        self.run_until(usize::MAX)
    }

    /// The same, or for so many ticks of motion.
    fn run_until(&mut self, ticks: usize) -> Vec<Error> {
        let mut errors = Vec::new();
        let until = self.ticks.saturating_add(ticks);
        for _ in 0..1_000_000 {
            let mut done = false;
            loop {
                match self.planner.poll() {
                    Ok(Progress::Waiting) => break,
                    Ok(Progress::Done) => {
                        done = true;
                        break;
                    }
                    Ok(_) => {}
                    Err(error) => errors.push(error),
                }
            }
            (self.before_tick)();
            let before = self.at_mm();
            let state = self.interpolator.tick();
            self.ticks += usize::from(state == State::Active);
            for (a, b) in before.iter().zip(self.at_mm()) {
                self.jump = self.jump.max((a - b).abs());
            }
            if (state == State::Idle && done) || self.ticks >= until {
                while self.planner.poll().is_ok_and(|p| p == Progress::Working) {}
                return errors;
            }
        }
        panic!("no end");
    }

    fn at_mm(&self) -> [f64; 3] {
        self.interpolator.set_points().map(|p| p.to_num())
    }

    /// The planner knows where the axes stand.
    fn agrees(&self) {
        assert!(self.planner.is_at_rest());
        assert_eq!(self.planner.position(), self.interpolator.set_points());
    }
}

/// Rows: OP-07.
#[test]
fn the_next_program_begins_where_the_axes_stand_with_everything_as_at_program_start() {
    let mut memory = Channel::new();
    let first = b"G54 G91 G70 G00 X1 Y1\nG131 50\n#CONTOUR MODE [DIST PRE_DIST=2]\nM30\n".as_slice();
    let data = machine();
    let mut bench = Bench::new(&mut memory, &data, first);
    assert_eq!(bench.run(), []);
    assert_eq!(bench.at_mm(), [25.4_f64, 25.4, 0.0].map(|x| mm(x).to_num::<f64>()));
    bench.agrees();
    let old = bench.planner.load(b"G01 X10 F1000\nX20\nM30\n".as_slice()).unwrap();
    assert_eq!(old, first);
    bench.agrees();
    assert_eq!(bench.run(), []);
    assert_eq!(bench.at_mm()[0], 20.0, "absolute, in millimetres, without an offset");
    assert!(bench.jump < 0.3, "{}", bench.jump);
    // No feed is left.
    bench.planner.load(b"G01 X10\n".as_slice()).unwrap();
    let errors = bench.run();
    assert!(errors[0].to_string().contains("motion without feed"), "{errors:?}");
    bench.agrees();
}

#[test]
fn a_program_takes_the_time_that_it_takes_after_power_up() {
    let text = b"G00 X5\nG01 X30 Y10 F3000\nG02 X40 Y20 I10\nG01 G61 X50\nY50\nX0 Y0\nM30\n".as_slice();
    let mut memory = Channel::new();
    let data = machine();
    let mut bench = Bench::new(&mut memory, &data, text);
    bench.run();
    let alone = bench.ticks;
    for before in ["M30\n", "G131 30\n#SLOPE [TYPE=STEP]\nG261\n#VECTOR LIMIT ON [VEL=100]\nM30\n"] {
        let mut memory = Channel::new();
        let data = machine();
        let mut bench = Bench::new(&mut memory, &data, before.as_bytes());
        assert_eq!(bench.run(), []);
        let ticks = bench.ticks;
        bench.planner.load(text).unwrap();
        assert_eq!(bench.run(), []);
        assert_eq!(bench.ticks - ticks, alone, "{before}");
    }
}

#[test]
fn single_lines_keep_what_is_in_force() {
    let mut memory = Channel::new();
    let data = machine();
    let mut bench = Bench::new(&mut memory, &data, b"G54 G01 X1 F1000\n".as_slice());
    bench.run();
    for (line, end) in
        [("G91", 6.0), ("X1", 7.0), ("P1=3", 7.0), ("X=P1", 10.0), ("G90 X1", 6.0), ("G53 X1", 1.0)]
    {
        bench.planner.continue_with(line.as_bytes()).unwrap();
        assert_eq!(bench.run(), [], "{line}");
        assert_eq!(bench.at_mm()[0], end, "{line}");
        bench.agrees();
    }
    bench.planner.continue_with(b"X=P1".as_slice()).unwrap();
    assert_eq!(bench.run(), []);
    bench.planner.load(b"G00 X=P1".as_slice()).unwrap();
    assert!(bench.run()[0].to_string().contains("P1"), "a program has parameters of its own");
}

#[test]
fn a_text_is_taken_at_rest_only() {
    let mut memory = Channel::new();
    let data = machine();
    let mut bench = Bench::new(&mut memory, &data, b"G00 X10\nM30\n".as_slice());
    assert_eq!(bench.planner.go_on(), Err(GoOnError::NothingRefused));
    bench.run_until(20);
    let other = b"G00 X0\n".as_slice();
    let busy = bench.planner.load(other).unwrap_err();
    assert_eq!(busy.text, other);
    assert!(busy.to_string().contains("at rest"));
    assert!(bench.planner.continue_with(other).is_err() && bench.planner.load_next().is_err());
    assert_eq!(bench.planner.set_position(0, mm(0.0)), Err(PositionError::NotAtRest));
    bench.run();
    assert_eq!(bench.at_mm()[0], 10.0);
    assert_eq!(bench.planner.go_on(), Err(GoOnError::NothingRefused));
    bench.planner.load(other).unwrap();
    bench.run();
    assert_eq!(bench.at_mm()[0], 0.0);
}

/// A program with one refused line in its middle: the text of the message, and where the axes come to with
/// the line and behind it.
fn around(bad: &str, behind: &str) -> (Error, [f64; 3], [f64; 3]) {
    let text = format!("G01 X10 F1000\nY5\n{bad}\n{behind}\n");
    let mut memory = Channel::new();
    let data = machine();
    let mut bench = Bench::new(&mut memory, &data, text.as_bytes());
    let errors = bench.run();
    assert_eq!(errors.len(), 1, "{bad}: {errors:?}");
    let stands = bench.at_mm();
    bench.agrees();
    bench.planner.go_on().unwrap();
    assert_eq!(bench.run(), [], "{bad}");
    bench.agrees();
    assert!(bench.jump < 0.3, "{bad}: {}", bench.jump);
    (errors[0].clone(), stands, bench.at_mm())
}

/// Rows: OP-08.
#[test]
fn a_refused_line_costs_that_line() {
    let lines = [
        "X20 Q7",
        "G91 X20 Z",
        "G00 G54 Y9 X99999 Y8",
        "G04",
        "X1e9",
        "\u{1}X20",
        "X20 \u{e4}",
        "G02 X20",
        "$IF 1 $GOTO N7",
        "LL nowhere",
        "#NONSENSE",
        "G91 G02 X5 Y0 R1",
        "G70 F5 G133 50 X999999",
        "X20 M30 Q7",
        "G00 G18 \u{1}",
        "G92 X7 X8",
        "$FOR P1 = 1, 2, 1 x",
        "$WHILE 1 x",
        "D1 G91 X3",
        "$IF 1 x",
        "\\ X9",
        "L nofile",
    ];
    for line in lines {
        let (error, stands, end) = around(line, "X12 Y6");
        assert_eq!(error.place().line, 3, "{line}: {error}");
        assert_eq!(stands, [10.0, 5.0, 0.0], "{line}: what was before it runs");
        assert_eq!(end, [12.0, 6.0, 0.0], "{line}: and what is behind it, with what was in force before it");
    }
}

#[test]
fn a_line_refused_for_its_motion_changes_nothing_in_force() {
    // The weight comes before the motion: it would show as another duration.
    let time = |bad: &str| {
        let text = format!("G01 X10 F1000\nG04 0.1\n{bad}\nG01 X40 F6000\nM30");
        let mut memory = Channel::new();
        let data = machine();
        let mut bench = Bench::new(&mut memory, &data, text.as_bytes());
        let refused = bench.run().len();
        if refused > 0 {
            bench.planner.go_on().unwrap();
            assert_eq!(bench.run(), [], "{bad}");
        }
        (refused, bench.ticks, bench.at_mm())
    };
    let (_, without, end) = time("(nothing)");
    assert_eq!(end[0], 40.0);
    for bad in ["G131 20 G02 X11 Y1 R0.1", "G133 1000 G91 G02 X1 R0.1", "G261 G02 G90 X11 R0.1"] {
        let (refused, ticks, end) = time(bad);
        // The standstill behind the refusal has a tick of its own.
        assert_eq!((refused, ticks, end), (1, without + 1, [40.0, 0.0, 0.0]), "{bad}");
    }
}

#[test]
fn control_blocks_around_a_refused_line_go_on() {
    let text = b"$FOR P1 = 1, 3, 1\nG00 X=P1\nG01 Q7\nY=P1\n$ENDFOR\n".as_slice();
    let mut memory = Channel::new();
    let data = machine();
    let mut bench = Bench::new(&mut memory, &data, text);
    for round in 1..=3 {
        let errors = bench.run();
        assert_eq!((errors.len(), errors[0].place().line), (1, 3));
        assert_eq!(bench.at_mm()[..2], [f64::from(round), f64::from(round - 1)]);
        bench.planner.go_on().unwrap();
    }
    assert_eq!(bench.run(), []);
    assert_eq!(bench.at_mm(), [3.0, 3.0, 0.0]);
    // What is missing at the end is done without.
    let (_, _, end) = around("$IF 0\nX70", "");
    assert_eq!(end, [10.0, 5.0, 0.0]);
}

#[test]
fn an_abort_leaves_the_axes_where_they_stand_and_the_next_program_begins_there() {
    for ticks in [1, 7, 60, 150, 333, 700] {
        let mut memory = Channel::new();
        let text = b"G91 G54 G261\nG01 X30 F3000\nY20\nG02 X10 Y10 I10\nG00 X-70\nM30\n".as_slice();
        let data = machine();
        let mut bench = Bench::new(&mut memory, &data, text);
        bench.run_until(ticks);
        bench.operator.abort();
        bench.run();
        let stands = bench.at_mm();
        bench.agrees();
        assert_eq!(bench.planner.go_on(), Err(GoOnError::NothingRefused));
        assert!(bench.jump < 0.3);
        // What was in force is not: relative, and an offset.
        bench.planner.continue_with(b"G00 Z1\nG91 X1".as_slice()).unwrap();
        assert_eq!(bench.run(), []);
        bench.agrees();
        let expected = mm(stands[0]) + mm(1.0);
        assert_eq!(bench.interpolator.set_points()[0], expected, "{ticks}");
        assert_eq!(bench.at_mm()[1..], [stands[1], 1.0]);
        // Aborts at rest have nothing to end.
        for _ in 0..2 {
            bench.operator.abort();
            bench.run();
        }
        bench.planner.load(b"G00 X0 Y0 Z0".as_slice()).unwrap();
        assert_eq!(bench.run(), []);
        assert_eq!(bench.at_mm(), [0.0; 3]);
        assert!(bench.jump < 0.3, "{}", bench.jump);
    }
}

/// In the middle of a curve: a dwell and a function show the point itself.
#[test]
fn what_does_not_move_stays_where_an_abort_left_the_axes() {
    for text in ["G01 X50 Y20 F6000\nM30\n", "G02 X50 I25 F6000\nM30\n"] {
        let mut memory = Channel::new();
        let data = machine();
        let mut bench = Bench::new(&mut memory, &data, text.as_bytes());
        bench.run_until(400);
        bench.operator.abort();
        bench.run();
        let stands = *bench.interpolator.set_points();
        assert!(stands[0] > mm(0.1) && stands[0] < mm(49.0));
        bench.planner.load(b"G04 0.01\nM5\nM30\n".as_slice()).unwrap();
        assert_eq!(bench.run(), []);
        assert_eq!(*bench.interpolator.set_points(), stands);
        assert!(bench.operator.output().is_some_and(|output| output.function == Function::M(5)));
        bench.agrees();
        assert!(bench.jump < 0.3, "{}", bench.jump);
    }
}

fn is_send<T: Send>(_: &T) {}

/// Rows: OP-09.
#[test]
fn a_position_is_set_at_rest_and_nothing_moves() {
    let mut memory = Channel::new();
    let data = machine();
    let mut bench = Bench::new(&mut memory, &data, b"G01 X10 Y5 F1000\nM30\n".as_slice());
    assert_eq!(bench.planner.set_position(3, mm(0.0)), Err(PositionError::Range));
    assert_eq!(bench.planner.set_position(0, mm(100_000.5)), Err(PositionError::Range));
    assert_eq!(bench.planner.set_position(2, mm(-4.0)), Ok(()), "before the first program");
    bench.run();
    assert_eq!(bench.at_mm(), [10.0, 5.0, -4.0]);
    for (axis, position) in [(0, 100.0), (1, -20.0), (0, 110.0), (2, 0.5)] {
        assert_eq!(bench.planner.set_position(axis, mm(position)), Ok(()));
    }
    assert!(bench.planner.is_at_rest(), "before the tick that shows it, too");
    bench.planner.load(b"G91 G01 X-10 F1000\nG90 Y0\n".as_slice()).unwrap();
    let telemetry = |bench: &Bench<'_, _>| bench.interpolator.telemetry().speed.to_bits();
    assert_eq!(bench.interpolator.tick(), State::Active);
    assert_eq!(bench.at_mm(), [110.0, -20.0, 0.5]);
    assert_eq!(telemetry(&bench), 0);
    bench.jump = 0.0;
    assert_eq!(bench.run(), []);
    assert_eq!(bench.at_mm(), [100.0, 0.0, 0.5]);
    assert!(bench.jump < 0.3, "{}", bench.jump);
    bench.agrees();
    // More of them than a tick passes.
    for k in 0..200 {
        let set = bench.planner.set_position(0, mm(f64::from(k)));
        if set.is_err() {
            bench.interpolator.tick();
        }
    }
    bench.run();
    bench.agrees();
}

#[test]
fn an_abort_behind_a_position_that_was_set_keeps_it() {
    let mut memory = Channel::new();
    let data = machine();
    let mut bench = Bench::new(&mut memory, &data, b"G01 X10 F1000\nM30\n".as_slice());
    bench.run();
    bench.planner.set_position(0, mm(70.0)).unwrap();
    bench.planner.load(b"G01 X100 F1000\n".as_slice()).unwrap();
    bench.operator.abort();
    bench.run();
    bench.agrees();
    bench.planner.load(b"G01 X71 F1000\n".as_slice()).unwrap();
    bench.jump = 0.0;
    bench.run_until(5);
    bench.operator.abort();
    bench.run();
    bench.agrees();
    assert!((70.0..71.0).contains(&bench.at_mm()[0]) && bench.jump < 0.3, "{:?}", bench.at_mm());
}

#[test]
fn offsets_and_positions_of_the_machine_hold_across_programs() {
    let mut memory = Channel::new();
    let start = [mm(7.0), mm(0.0), mm(0.0)];
    let data = machine();
    let mut bench = Bench::at(&mut memory, &data, start, b"G91 G00 X1\nM30\n".as_slice());
    bench.run();
    assert_eq!(bench.at_mm()[0], 8.0, "from the start position");
    bench.planner.set_zero_offset(1, 0, mm(20.0)).unwrap();
    for (text, end) in [("G55 G00 X1", 21.0), ("G54 G00 X1", 6.0), ("G00 X1", 1.0), ("G55 G00 X0", 20.0)] {
        bench.planner.load(text.as_bytes()).unwrap();
        assert_eq!(bench.run(), []);
        assert_eq!(bench.at_mm()[0], end, "{text}");
    }
}

/// Programs one behind the other in one text.
#[test]
fn the_same_text_may_hold_the_next_program() {
    let text = b"%one\nG00 X1\n$IF 1\nM30\n$ENDIF\n%two\nG91 G00 X1\nM30\nG00 X5\n".as_slice();
    let mut memory = Channel::new();
    let data = machine();
    let mut bench = Bench::new(&mut memory, &data, text);
    let mut ends = Vec::new();
    for _ in 0..5 {
        assert_eq!(bench.run(), []);
        ends.push(bench.at_mm()[0]);
        bench.planner.load_next().unwrap();
    }
    assert_eq!(ends, [1.0, 2.0, 5.0, 5.0, 5.0]);
}

#[test]
fn a_plan_that_failed_is_followed_by_a_program() {
    let mut machine = machine();
    machine.axes[0].vb_max_red = 1;
    let mut memory = Channel::new();
    let mut bench = Bench::new(&mut memory, &machine, b"G01 X10 F1000\nX3000\nM30\n".as_slice());
    bench.run_until(200);
    bench.operator.set_reduced(true);
    let errors = bench.run_until(60_000);
    bench.operator.set_reduced(false);
    assert!(errors.contains(&Error::ReducedTooSlow), "{errors:?}");
    bench.run();
    bench.agrees();
    bench.planner.load(b"G00 X0\n".as_slice()).unwrap();
    assert_eq!(bench.run(), []);
    assert_eq!(bench.at_mm()[0], 0.0);
}

/// Text through a window, so many bytes before each tick.
fn streamed(memory: &mut Channel<3, BLOCKS>, text: &str, bytes: usize) -> (Vec<Error>, [f64; 3], usize) {
    let mut window = Window::<256>::new();
    let (mut feeder, stream): (_, Stream<'_, 256>) = window.split();
    let data = machine();
    let mut bench = Bench::new(memory, &data, stream);
    let text = text.as_bytes().to_vec();
    let mut sent = 0;
    bench.before_tick = Box::new(move || {
        let end = text.len().min(sent + bytes);
        sent += feeder.push(&text[sent..end]);
        if sent == text.len() {
            feeder.end();
        }
    });
    let mut errors = bench.run();
    while bench.planner.go_on().is_ok() {
        errors.extend(bench.run());
    }
    bench.agrees();
    (errors, bench.at_mm(), bench.ticks)
}

/// Rows: OP-11.
#[test]
fn a_stream_is_longer_than_its_window() {
    let text: String = (1..200).map(|k| format!("N{k} G01 X{} F6000 (a comment)\n", k % 7)).collect();
    assert!(text.len() > 4000);
    for bytes in [1, 11, 100_000] {
        let (errors, end, _) = streamed(&mut Channel::new(), &text, bytes);
        assert_eq!((errors, end[0]), (vec![], f64::from(199 % 7)));
    }
}

#[test]
fn a_loop_in_a_stream_needs_its_window() {
    let fits = "G00 X0\n$FOR P1 = 1, 5, 1\nG91 X1 Y2\n$ENDFOR\nZ1\n";
    let comment = "(".to_owned() + &"-".repeat(60) + ")\n";
    let long = format!("G00 X0\n$FOR P1 = 1, 5, 1\nG91 X1\n{0}{0}{0}N7 $ENDFOR\nZ1\n", comment);
    let calls = format!("%L up\nG91 Z1\nM17\n%main\nG00 X1\nLL up\n{0}{0}{0}LL up\nX2\n", comment);
    let label = format!("N1: G00 X0\n{0}{0}{0}$GOTO N1\nX2\n", comment);
    for bytes in [1, 11, 100_000] {
        let run = |text: &str| streamed(&mut Channel::new(), text, bytes);
        let (errors, end, _) = run(fits);
        assert_eq!((errors, end), (vec![], [5.0, 10.0, 1.0]));
        for (text, line, end, word) in [
            (&long, 7, [1.0, 0.0, 1.0], "N7"),
            (&calls, 10, [3.0, 0.0, 1.0], "LL"),
            (&label, 5, [2.0, 0.0, 0.0], "$GOTO"),
        ] {
            let (errors, at, _) = run(text);
            assert_eq!(errors.len(), 1, "{errors:?}");
            assert_eq!(errors[0].place().line, line, "{}", errors[0]);
            assert!(
                errors[0].to_string().contains("behind the window") && errors[0].to_string().contains(word),
                "{}",
                errors[0]
            );
            assert_eq!(at, end, "{bytes}: {text}");
        }
    }
}

#[test]
fn a_line_longer_than_the_window_is_refused_and_the_next_one_runs() {
    let text = format!("G00 X1\nY1 ({})\nZ1\n{}", "-".repeat(500), "X2\n".repeat(100));
    for bytes in [1, 11, 100_000] {
        let (errors, at, _) = streamed(&mut Channel::new(), &text, bytes);
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert_eq!((errors[0].place().line, at), (2, [2.0, 0.0, 1.0]));
    }
}

#[test]
fn what_is_left_of_an_aborted_program_is_passed_over() {
    let mut window = Window::<128>::new();
    let (mut feeder, stream) = window.split();
    let mut memory = Channel::new();
    feeder.push(b"G01 X50 F1000\nX60\nX70\nG04 5\nX80");
    let data = machine();
    let mut bench = Bench::new(&mut memory, &data, stream);
    bench.run_until(50);
    bench.operator.abort();
    bench.run();
    let stands = bench.at_mm()[0];
    assert!(stands < 10.0);
    feeder.restart();
    feeder.push(b"G91 G00 X1\nM30\n");
    bench.planner.load_next().unwrap();
    assert_eq!(bench.run(), []);
    assert_eq!(bench.interpolator.set_points()[0], mm(stands) + mm(1.0));
}

/// Single lines between programs of a line: a text that is one or the other.
enum Either<'w> {
    Line(&'static [u8]),
    Stream(Stream<'w, 128>),
}

impl Text for Either<'_> {
    fn read(&mut self, file: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        match self {
            Self::Line(text) => text.read(file, offset, buffer),
            Self::Stream(stream) => stream.read(file, offset, buffer),
        }
    }

    fn pass(&mut self, file: u16, offset: u32) {
        if let Self::Stream(stream) = self {
            stream.pass(file, offset);
        }
    }

    fn holds(&self, file: u16, offset: u32) -> bool {
        if let Self::Stream(stream) = self { stream.holds(file, offset) } else { true }
    }

    fn start(&mut self) -> u32 {
        if let Self::Stream(stream) = self { stream.start() } else { 0 }
    }

    fn next_program(&mut self) -> Option<u32> {
        if let Self::Stream(stream) = self { stream.next_program() } else { None }
    }
}

/// No program runs twice, whether the window still has it or not.
#[test]
fn a_stream_that_is_loaded_again_begins_where_it_was_said_to() {
    for lines in [0, 20] {
        let mut window = Window::<128>::new();
        let (mut feeder, stream) = window.split();
        let mut memory = Channel::new();
        let data = machine();
        let mut bench = Bench::new(&mut memory, &data, Either::Stream(stream));
        for _ in 0..lines {
            assert_eq!(feeder.push(b"G91 G00 Y1\n"), 11);
            bench.run_until(10);
        }
        assert_eq!(feeder.push(b"G91 G00 X3\nM30\nX99\n"), 19);
        assert_eq!(bench.run(), []);
        for k in 1..4 {
            let stream = bench.planner.continue_with(Either::Line(b"X1\n")).ok().unwrap();
            assert_eq!(bench.run(), []);
            feeder.restart();
            assert_eq!(feeder.push(b"G91 G00 X5\nM30\nX99\n"), 19);
            assert!(bench.planner.load(stream).is_ok());
            assert_eq!(bench.run(), []);
            assert_eq!(bench.at_mm(), [3.0 + f64::from(k) * 6.0, f64::from(lines), 0.0]);
        }
    }
}

/// The session that the target repeats bit for bit, and the judge of this test: what each of its parts leads
/// to.
struct Steps(Vec<[i64; 3]>);

impl hil_cases::Watch<3> for Steps {
    fn polled(&mut self, _: u32, _: &Result<Progress, Error>) {}

    fn ticked(&mut self, _: u32, set_points: &[Position; 3]) {
        self.0.push(set_points.map(Position::to_bits));
    }
}

/// Program, M30, next program, refused line, next line, abort, set position, next program, feed hold: one
/// channel, one power-up.
#[test]
fn one_channel_from_power_up_to_power_off() {
    let mut memory = Box::new(Channel::<3, { hil_cases::BLOCKS }>::new());
    let mut steps = Steps(Vec::new());
    let outcome = hil_cases::session(&mut memory, &hil_cases::AXES_3, None, &mut steps).unwrap();
    assert_eq!(steps.0.len(), outcome.ticks as usize);
    let at = |k: usize| steps.0[k].map(|bits| Position::from_bits(bits).to_num::<f64>());
    assert_eq!(*steps.0.last().unwrap(), [0, mm(30.0).to_bits(), mm(-1.0).to_bits()]);
    // Nothing jumps but the two axes whose position was set, each once, at rest.
    let jumps: Vec<_> = (1..steps.0.len())
        .flat_map(|k| (0..3).map(move |axis| (k, axis)))
        .filter(|&(k, axis)| (at(k)[axis] - at(k - 1)[axis]).abs() > 1.0)
        .collect();
    assert_eq!(jumps.iter().map(|(_, axis)| *axis).collect::<Vec<_>>(), [0, 2], "{jumps:?}");
    let (shift, rest) = (jumps[0].0, jumps[1].0);
    assert_eq!(shift, rest);
    assert_eq!((at(shift)[0], at(shift)[2], at(shift)[1]), (12.5, -3.0, at(shift - 1)[1]));
    // A line gives the same bits, with the same memory behind it and with a new one.
    for fresh in [false, true] {
        if fresh {
            *memory = Channel::new();
        }
        let mut window = Window::new();
        let mut over = Steps(Vec::new());
        let streamed =
            hil_cases::session(&mut memory, &hil_cases::AXES_3, Some(&mut window), &mut over).unwrap();
        let first = over.0.iter().zip(&steps.0).position(|(a, b)| a != b);
        assert_eq!(first, None);
        assert_eq!(streamed, outcome);
    }
}

#[test]
fn a_window_is_fed_from_another_thread() {
    let text: Vec<u8> =
        (0..200_000_u32).map(|k| b'0' + (k.wrapping_mul(2_654_435_761) >> 28) as u8).collect();
    let mut window = Window::<64>::new();
    let (mut feeder, mut stream) = window.split();
    is_send(&feeder);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let (mut rest, mut size) = (text.as_slice(), 1);
            while !rest.is_empty() {
                let sent = feeder.push(&rest[..rest.len().min(size)]);
                assert!(sent <= size);
                rest = &rest[sent..];
                size = size % 70 + 1;
                if sent == 0 {
                    std::thread::yield_now();
                }
            }
            feeder.end();
        });
        let (mut read, mut buffer) = (Vec::new(), [0; 24]);
        loop {
            stream.pass(0, read.len() as u32);
            match stream.read(0, read.len() as u32, &mut buffer) {
                Ok(0) => break,
                Ok(count) => read.extend_from_slice(&buffer[..count]),
                Err(TextError::NotYet) => std::thread::yield_now(),
                Err(error) => panic!("{error:?}"),
            }
        }
        assert!(read == text);
    });
    // What lies half a window behind is kept, and nothing before it.
    let last = text.len() as u32;
    assert!(stream.holds(0, last - 32) && !stream.holds(0, last - 33));
    assert_eq!(stream.read(0, last - 33, &mut [0]), Err(TextError::Forgotten));
    assert_eq!(stream.read(1, 0, &mut [0]), Err(TextError::Failed), "there are no other files");
}
