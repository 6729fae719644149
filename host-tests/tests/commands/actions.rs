//! M and H functions with synchronisation: the point of their output, the point where the motion waits, and
//! commands in between.
use glidepath::channel::{Channel, Handles, PlannedBlock, Progress};
use glidepath::machine::{MachineData, Synch, SynchTable};
use glidepath::quantity::Position;
use glidepath::queue::Function;
use glidepath::technology::Output;
use glidepath::tick::State;
use host_tests::cases::random::{Mix, Random, program};
use host_tests::cases::{machines, set_point};
use host_tests::check;
use host_tests::operate::{Act, Operated, POLLS, judge, random_acts};
use host_tests::properties::permitted;
use host_tests::trace::Trace;

/// A run, row by row; row 0 is that of the first call of the interpolator.
struct Run {
    trace: Trace,
    distances: Vec<i64>,
    /// Rows with motion or dwell.
    active: Vec<bool>,
    /// Row and function.
    outputs: Vec<(usize, Output)>,
    /// Rows before which an acknowledgement was given.
    acknowledged: Vec<usize>,
    blocks: Vec<PlannedBlock>,
    /// Rows at which the planner said that it waits.
    waits: Vec<usize>,
}

/// Rows from the one with the output to the one with the acknowledgement; never without.
type Delay = Option<usize>;

struct Case<'a> {
    machine: &'a MachineData<3>,
    delay: Delay,
    acts: &'a [(usize, Act)],
    polls: usize,
}

/// Rows of rest, behind the last act of the operator, after which nothing more is expected.
const ENOUGH: usize = 3000;

fn run(text: &str, case: &Case<'_>) -> Run {
    run_from(text, [Position::ZERO; 3], case)
}

fn run_from(text: &str, start: [Position; 3], case: &Case<'_>) -> Run {
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(case.machine, start, text.as_bytes()).expect("machine data");
    let mut run = Run {
        trace: Trace::empty(f64::from(case.machine.channel.cycle_us) * 1e-6, 3),
        distances: Vec::new(),
        active: Vec::new(),
        outputs: Vec::new(),
        acknowledged: Vec::new(),
        blocks: Vec::new(),
        waits: Vec::new(),
    };
    let mut acts = case.acts.iter().peekable();
    let mut due: Vec<(usize, Function)> = Vec::new();
    let mut rest = 0;
    for row in 0.. {
        while let Some((_, act)) = acts.next_if(|(at, _)| *at <= row) {
            act.give(&operator);
            rest = 0;
        }
        for (_, function) in due.extract_if(.., |(at, _)| *at <= row) {
            if operator.acknowledge(function).is_ok() {
                run.acknowledged.push(row);
            }
        }
        let mut done = false;
        for _ in 0..case.polls {
            match planner.poll().unwrap_or_else(|e| panic!("line {}: {e}\n{text}", e.place().line)) {
                Progress::Planned => run.blocks.push(planner.planned()),
                Progress::Waiting => break,
                Progress::Done => {
                    done = true;
                    break;
                }
                _ => {}
            }
        }
        if planner.is_waiting() {
            run.waits.push(row);
        }
        let state = interpolator.tick();
        run.trace.push(interpolator.set_points().iter().map(|p| p.to_bits()));
        run.distances.push(interpolator.telemetry().distance.to_bits());
        run.active.push(state == State::Active);
        while let Some(output) = operator.output() {
            run.outputs.push((row, output));
            if let (true, Some(delay)) = (output.waits, case.delay) {
                due.push((row + 1 + delay, output.function));
            }
        }
        rest = if state == State::Idle { rest + 1 } else { 0 };
        if (done && state == State::Idle) || (rest > ENOUGH && acts.peek().is_none()) {
            break;
        }
    }
    run
}

fn machine(slope: u8) -> MachineData<3> {
    let mut machine = machines::even(1000);
    machine.channel.slope_profile = slope;
    machine.channel.m_synch = SynchTable::NONE
        .with(24, Synch::NoSynch)
        .with(25, Synch::MvsSns)
        .with(26, Synch::MvsSvs)
        .with(27, Synch::MnsSns);
    machine.channel.h_synch = SynchTable::NONE.with(7, Synch::MnsSns);
    machine
}

/// Everything put out without waiting.
fn without(machine: &MachineData<3>) -> MachineData<3> {
    let mut machine = *machine;
    (machine.channel.m_synch, machine.channel.h_synch) = (SynchTable::NONE, SynchTable::NONE);
    machine
}

fn acknowledged(text: &str, machine: &MachineData<3>, delay: Delay) -> Run {
    let run = run(text, &Case { machine, delay, acts: &[], polls: 1000 });
    keeps_limits(&run, machine, text);
    run
}

fn keeps_limits(run: &Run, machine: &MachineData<3>, what: &str) {
    let slope = machine.channel.slope_profile;
    let limits: Vec<_> = machine.axes.iter().map(|axis| permitted(axis, slope, true, true, true)).collect();
    check::limits(&run.trace, &limits).unwrap_or_else(|fault| panic!("slope {slope}: {fault}\n{what}"));
}

impl Run {
    fn row(&self, row: usize) -> Vec<i64> {
        self.trace.row(row).collect()
    }

    /// The row of the output and of the first set point behind it that is another.
    fn stands(&self, output: usize) -> (usize, usize) {
        let (row, _) = self.outputs[output];
        let end = (row..self.trace.len()).find(|&k| self.row(k) != self.row(row));
        (row, end.unwrap_or(self.trace.len()))
    }

    fn end(&self) -> Vec<i64> {
        self.row(self.trace.len() - 1)
    }

    /// Sum of the lengths of all spans of the block with this number, LSB 2^-44 mm.
    fn length(&self, n: u32) -> i64 {
        self.blocks.iter().filter(|b| b.n == n).map(|b| b.length.to_bits()).sum()
    }
}

fn mm(point: [i64; 3]) -> Vec<i64> {
    point.iter().map(|x| x << 32).collect()
}

/// Rows: G-07.
#[test]
fn a_block_begins_when_its_function_is_acknowledged() {
    for slope in 0..4 {
        let text = "N10 G01 X10 F6000\nN20 Y10 M26\nN30 X0\nM30\n";
        let run = acknowledged(text, &machine(slope), Some(200));
        let [(row, output)] = run.outputs[..] else { panic!("{:?}", run.outputs) };
        assert_eq!((output.function, output.n, output.waits), (Function::M(26), 20, true));
        assert_eq!(output.tick as usize, row, "no idle row before it");
        let (from, to) = run.stands(0);
        // To the last bit, from the tick that reaches the point to that behind the acknowledgement.
        assert_eq!(run.row(from), mm([10, 0, 0]));
        assert_eq!(run.acknowledged, [from + 201]);
        assert!((from + 201..from + 206).contains(&to), "{from} … {to}");
        assert_eq!(run.end(), mm([0, 10, 0]));
        assert!(run.waits.contains(&(from + 200)) && !run.waits.contains(&to));
        // Idle meanwhile, but for the tick that shows the point, and the next one where the law ends between
        // both.
        assert!(run.active[from] && !run.active[from + 2..from + 200].contains(&true), "slope {slope}");
    }
}

#[test]
fn a_block_ends_and_its_function_comes_out_and_waits() {
    let text = "N10 G01 X10 F6000 M27\nN20 Y10 H7 M3\nN30 X0\nM30\n";
    let run = acknowledged(text, &machine(1), Some(50));
    let functions: Vec<_> = run.outputs.iter().map(|(_, o)| (o.function, o.waits)).collect();
    assert_eq!(functions, [(Function::M(27), true), (Function::H(7), true), (Function::M(3), false)]);
    assert_eq!(run.row(run.outputs[0].0), mm([10, 0, 0]));
    assert_eq!(run.row(run.outputs[1].0), mm([10, 10, 0]));
    for k in 0..2 {
        let (from, to) = run.stands(k);
        assert!((from + 51..from + 56).contains(&to), "{from} … {to}");
    }
}

#[test]
fn acknowledged_in_time_nothing_slows_down() {
    let text = "N10 G01 X10 F6000\nN20 X60 M25\nN30 X90\nM30\n";
    let machine = machine(1);
    let free = acknowledged(text, &without(&machine), None);
    // N20 takes 500 ticks at 0.1 mm/tick; slowing down from that takes 100.
    for delay in [0, 1, 30, 200, 330, 370] {
        let run = acknowledged(text, &machine, Some(delay));
        assert_eq!(run.outputs.len(), 1);
        let (row, output) = run.outputs[0];
        assert!(output.waits);
        // It was put out where N20 begins.
        assert!(run.row(row)[0] >= 10 << 32 && run.row(row - 1)[0] < 10 << 32, "{delay}");
        assert!(run.waits.is_empty(), "{delay}: {:?}", run.waits);
        assert_eq!(run.trace, free.trace, "{delay}");
    }
    // Too late: it stands where N20 ends, as long as it takes.
    for delay in [480, 1500] {
        let run = acknowledged(text, &machine, Some(delay));
        let stands: Vec<usize> = (0..run.trace.len()).filter(|&k| run.row(k) == mm([60, 0, 0])).collect();
        let last = *stands.last().expect("it stands there");
        assert!(stands.len() + 400 > delay.saturating_sub(500), "{delay}: {}", stands.len());
        assert!(last >= run.acknowledged[0], "{delay}");
        assert_eq!(run.end(), mm([90, 0, 0]));
    }
}

/// At a lower override too, with blocks of one feed before it that are one span with HSC.
#[test]
fn acknowledged_in_time_nothing_stops_at_a_lower_override() {
    let text = "N10 G01 X10 F6000\nN20 X60\nN30 X110 M25\nN40 X190\nM30\n";
    for slope in [1, 3] {
        let machine = machine(slope);
        for delay in [1, 100, 300] {
            let acts = [(0, Act::Override(500))];
            let run = run(text, &Case { machine: &machine, delay: Some(delay), acts: &acts, polls: 1000 });
            keeps_limits(&run, &machine, text);
            assert!(run.waits.is_empty(), "slope {slope}, {delay}: {:?}", run.waits);
            let still = run.distances.windows(2).skip(100).take(2000).filter(|w| w[0] == w[1]).count();
            assert_eq!(still, 0, "slope {slope}, {delay}");
        }
    }
}

#[test]
fn the_law_that_goes_on_is_that_without_the_wait() {
    let mut same = 0;
    for slope in 0..4 {
        let machine = machine(slope);
        for k in 0..60 {
            let (x, y, feed) = (7 + k % 5, 3 + k % 7, 5000 + 37 * k);
            let (further, beside) = (60 + k, 20 + k % 11);
            let text = format!(
                "N10 G01 X{x} Y{y} F{feed}\nN20 X{further} Y{beside} M25\nN30 X{} Y{} Z3\nM30\n",
                further + 30,
                beside + 9
            );
            let free = acknowledged(&text, &without(&machine), None);
            let run = acknowledged(&text, &machine, Some(k % 40));
            assert_eq!(run.trace.len(), free.trace.len(), "{text}");
            // The change over is at a tick; path distance is rounded there, far below a set point's LSB.
            for row in 0..run.trace.len() {
                let off = run.trace.row(row).zip(free.trace.row(row)).map(|(a, b)| a.abs_diff(b)).max();
                assert!(off <= Some(1), "row {row}: {off:?}\n{text}");
            }
            same += usize::from(run.trace == free.trace);
        }
    }
    assert!(same >= 236, "{same} of 240");
}

/// N110 to N120 with a corner, N120 to N130 without.
fn rounded(action: &str, word: &str) -> String {
    format!(
        "%c\nN100 #CONTOUR MODE [DEV, PATH_DEV 2, {action}]\nN110 G01 X50 G61 F9000 {word}\nN120 Y50\nN130 X0\nM30\n"
    )
}

/// Rows: D3-049, D3-050, D3-051, D3-052.
#[test]
fn at_a_rounded_corner_the_action_decides_where_it_stands() {
    for slope in 0..4 {
        let machine = machine(slope);
        for function in ["M25", "M27", "H7"] {
            for action in ["PRE_ACTION", "INTER_ACTION", "POST_ACTION", "CONST_VEL=0"] {
                let text = rounded(action, function);
                let run = acknowledged(&text, &machine, Some(120));
                let [(row, output)] = run.outputs[..] else { panic!("{:?}", run.outputs) };
                assert!(output.waits);
                let (from, to) = run.stands(0);
                assert!(from == row && (from + 121..from + 126).contains(&to), "{from} … {to}\n{text}");
                // What is left of N110 and the first half of the curve; the second half and what is left of
                // N120.
                let main = run.blocks[0].length.to_bits();
                let half = run.length(110);
                let curve = run.blocks.iter().filter(|b| b.n == 120).map(|b| b.length.to_bits());
                let point: Vec<f64> = run.trace.mm(row);
                match action {
                    "PRE_ACTION" => {
                        assert_eq!(run.distances[row], main, "{text}");
                        assert!(run.row(row)[1] == 0 && point[0] > 35.0 && point[0] < 50.0, "{point:?}");
                    }
                    "POST_ACTION" => {
                        let halves: Vec<i64> = curve.collect();
                        let behind: i64 = halves[..halves.len() - 1].iter().sum();
                        assert_eq!(run.distances[row], half + behind, "{text}");
                        assert!(
                            run.row(row)[0] == 50 << 32 && point[1] > 0.0 && point[1] < 15.0,
                            "{point:?}"
                        );
                    }
                    _ => {
                        assert_eq!(run.distances[row], half, "{text}");
                        // The joint is on the bisector, PATH_DEV from the corner.
                        assert!((50.0 - point[0] - point[1]).abs() < 1e-6, "{point:?}");
                        let off = (50.0 - point[0]).hypot(point[1]);
                        assert!(off > 1.99 && off <= 2.0, "{off}");
                    }
                }
                assert_eq!(run.end(), mm([0, 50, 0]));
            }
        }
    }
}

#[test]
fn without_a_wait_the_action_decides_where_it_comes_out() {
    // MOS, and NO_SYNCH, which does not come out at all.
    for action in ["PRE_ACTION", "POST_ACTION"] {
        let machine = machine(1);
        let run = acknowledged(&rounded(action, "M3 M24"), &machine, None);
        let free = acknowledged(&rounded(action, ""), &machine, None);
        let [(row, output)] = run.outputs[..] else { panic!("{:?}", run.outputs) };
        assert_eq!((output.function, output.waits), (Function::M(3), false));
        let [before, at] = [row - 1, row].map(|row| run.distances[row]);
        // At 0.15 mm in a tick. The curve ends as far behind the corner as it begins before it.
        let main = run.blocks[0].length.to_bits();
        let (begin, point) = (main as f64 / (1_u64 << 44) as f64, run.trace.mm(row));
        let behind = if action == "PRE_ACTION" { point[0] - begin } else { point[1] - (50.0 - begin) };
        assert!(begin > 35.0 && begin < 45.0 && (-1e-9..0.151).contains(&behind), "{begin} {point:?}");
        assert!(if action == "PRE_ACTION" { point[1] < 0.001 } else { point[0] > 49.999 }, "{point:?}");
        // The first tick that reaches the point.
        let curve = run.length(110) + run.length(120)
            - run.blocks.iter().rfind(|b| b.n == 120).map_or(0, |b| b.length.to_bits());
        let place = if action == "PRE_ACTION" { main } else { curve };
        assert!(before < place && place <= at, "{before} {place} {at}");
        assert_eq!(run.trace, free.trace);
    }
}

#[test]
fn a_function_before_the_block_behind_a_corner_waits_in_the_corner() {
    let text = "%c\nN100 #CONTOUR MODE [DEV PATH_DEV=2 POST_ACTION]\nN110 G01 X50 G61 F9000\nN120 Y50 M26\nN130 X0\nM30\n";
    let run = acknowledged(text, &machine(1), Some(40));
    let (from, to) = run.stands(0);
    assert!((from + 41..from + 46).contains(&to));
    assert!(run.row(from)[0] == 50 << 32 && run.row(from)[1] > 0 && run.row(from)[1] < 10 << 32);
}

#[test]
fn functions_of_blocks_left_out_come_at_the_corner_that_stands_for_them() {
    let text = "%c\nN100 #CONTOUR MODE ON [DEV PATH_DEV=2 RELEVANT_PATH=1 INTER_ACTION]\nN110 G01 X50 F9000\n\
        N111 Y0.3 M27\nN112 Y0.6 M3\nN120 Y50\nN130 X0\nM30\n";
    let run = acknowledged(text, &machine(1), Some(40));
    let functions: Vec<_> = run.outputs.iter().map(|(row, o)| (*row, o.function)).collect();
    let row = functions[0].0;
    assert_eq!(functions, [(row, Function::M(27)), (row, Function::M(3))]);
    assert!(run.stands(0).1 >= row + 41);
}

/// MVS_SNS comes out before the motion of its block and waits behind it: without one, at the same place.
#[test]
fn a_function_of_a_block_without_path_waits_where_it_comes_out() {
    for (mode, motion) in
        [("", "N20 X10 M25"), ("", "N20 M25"), ("#CONTOUR MODE ON [DEV PATH_DEV=0.5]\n", "N20 X10 M25")]
    {
        for slope in 0..4 {
            let text = format!("N5 G01 X0 F6000\n{mode}N10 X10\n{motion}\nN30 X20\nN40 X30\nM30\n");
            let run = acknowledged(&text, &machine(slope), Some(80));
            let [(row, output)] = run.outputs[..] else { panic!("{:?}", run.outputs) };
            let (from, to) = run.stands(0);
            assert_eq!((output.function, output.waits), (Function::M(25), true), "{text}");
            assert!(from == row && (from + 81..from + 86).contains(&to), "{from} … {to}\n{text}");
            assert_eq!(run.row(row), mm([10, 0, 0]), "{text}");
        }
    }
}

#[test]
fn dwell_and_program_end_wait() {
    let text = "N10 G01 X10 F6000 M27\nN20 G04 X0.3\nN30 X20 M27\nM30\n";
    let run = acknowledged(text, &machine(1), Some(100));
    let [(first, _), (second, _)] = run.outputs[..] else { panic!("{:?}", run.outputs) };
    let (from, to) = run.stands(0);
    // The dwell begins behind the acknowledgement.
    assert!(from == first && (from + 400..from + 410).contains(&to), "{from} … {to}");
    assert_eq!(run.row(second), mm([20, 0, 0]));
    assert!(run.trace.len() > second + 100);
    // Never acknowledged: it never ends.
    let run = acknowledged(text, &machine(1), None);
    assert!(run.outputs.len() == 1 && run.trace.len() > ENOUGH && run.end() == mm([10, 0, 0]));
    // Functions alone, before any motion.
    let run = acknowledged("M25\nM26 H7\nG01 X5 F6000\nM30\n", &machine(1), Some(30));
    assert_eq!(run.outputs.len(), 3);
    assert!(run.row(30) == mm([0; 3]) && run.end() == mm([5, 0, 0]));
}

#[test]
fn more_functions_than_can_be_open() {
    let mut text = String::from("G01 F6000\n");
    for k in 1..=100 {
        text += &format!("X{} Y{} M25 M27 M26\n", 3 * k, k % 3);
    }
    text += "M30\n";
    let run = acknowledged(&text, &machine(1), Some(3));
    assert_eq!(run.outputs.len(), 300);
    assert_eq!(run.acknowledged.len(), 300);
    assert_eq!(run.end(), mm([300, 1, 0]));
}

/// Where functions have no room the look-ahead reaches less far: the motion goes on, and no function is lost.
#[test]
fn functions_without_room_do_not_stop_the_motion() {
    let mut text = String::from("G01 F6000\n");
    for k in 1..=1000 {
        text += &format!("X{}.{} F{} M{}\n", k / 10, k % 10, 6000 + k % 2, 100 + k % 800);
    }
    text += "M30\n";
    let machine = machine(1);
    for polls in [12, 1000] {
        let run = run(&text, &Case { machine: &machine, delay: None, acts: &[], polls });
        keeps_limits(&run, &machine, &text);
        let functions: Vec<_> = run.outputs.iter().map(|(_, output)| output.function).collect();
        assert_eq!(functions, (1..=1000).map(|k| Function::M(100 + k % 800)).collect::<Vec<_>>());
        assert_eq!(run.end(), mm([100, 0, 0]));
        assert!(run.distances.len() < 8_000, "{polls} polls: {} ticks", run.distances.len());
    }
}

const TRACK: &str = "%c\nN100 #CONTOUR MODE [DEV PATH_DEV=1 INTER_ACTION]\nN110 G01 X12 G61 F6000 M25\nN120 Y12 M25\nN130 X20 Y13 M26\n\
    N140 G04 X0.05\nN150 G261 X30 M27\nN160 Y0 M3\nN170 G02 X40 Y0 I5 J0 M27\nN180 G260 G01 X50 M25\nM30\n";

#[test]
fn a_hold_at_any_tick_and_an_acknowledgement_at_any_other() {
    for slope in 0..4 {
        let machine = machine(slope);
        let whole = acknowledged(TRACK, &machine, Some(60));
        let (rows, length) = (whole.trace.len(), whole.distances.iter().max());
        assert_eq!(whole.outputs.len(), 7);
        // In a curve over time a hold is gentle.
        let long = if slope == 3 { 2500 } else { 700 };
        for tick in (0..rows - 2).step_by(3) {
            for (delay, polls) in [(60, 1000), (tick % 90, 1000), (tick % 70, 6)] {
                let acts = [(tick, Act::Hold), (tick + long, Act::Resume)];
                let run = run(TRACK, &Case { machine: &machine, delay: Some(delay), acts: &acts, polls });
                let what = format!("hold at {tick}, acknowledged after {delay}, {polls} polls");
                keeps_limits(&run, &machine, &what);
                assert_eq!((run.end(), run.outputs.len()), (whole.end(), 7), "slope {slope}: {what}");
                assert_eq!(run.distances.iter().max(), length, "slope {slope}: {what}");
                // Nothing moves between the standstill and the end of the hold.
                if tick + long < run.trace.len() {
                    assert_eq!(run.row(tick + long - 1), run.row(tick + long - 100), "slope {slope}: {what}");
                }
                for (mine, other) in run.outputs.iter().zip(&whole.outputs) {
                    assert_eq!(mine.1.function, other.1.function, "slope {slope}: {what}");
                }
                // Where it waits, it stands at the same points.
                for k in [0, 2, 3, 5, 6] {
                    let [mine, other] = [&run, &whole].map(|run| run.row(run.outputs[k].0));
                    assert_eq!(mine, other, "slope {slope}: {what}, output {k}");
                }
            }
        }
    }
}

#[test]
fn an_abort_forgets_the_waits() {
    let machine = machine(1);
    let whole = acknowledged(TRACK, &machine, Some(60));
    for tick in (0..whole.trace.len()).step_by(3) {
        for delay in [None, Some(60)] {
            let acts = [(tick, Act::Abort)];
            let run = run(TRACK, &Case { machine: &machine, delay, acts: &acts, polls: 1000 });
            keeps_limits(&run, &machine, &format!("abort at {tick}"));
            if run.outputs.iter().all(|(row, o)| !o.waits || *row < tick) && delay.is_none() {
                assert!(run.trace.len() <= tick + 400, "abort at {tick}: {} rows", run.trace.len());
            }
            assert!(run.trace.len() < tick + ENOUGH, "abort at {tick}");
        }
    }
}

#[test]
fn acknowledgements_before_the_output_and_twice_are_ignored() {
    let machine = machine(1);
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let text: &[u8] = b"N10 G01 X10 F6000 M27\nN20 X20 M27\nN30 X30 M27\nM30\n";
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(&machine, [Position::ZERO; 3], text).expect("machine data");
    let m27 = Function::M(27);
    let mut go = |ticks: usize| {
        let mut outputs = 0;
        for _ in 0..ticks {
            while !matches!(planner.poll(), Ok(Progress::Waiting | Progress::Done)) {}
            interpolator.tick();
            while operator.output().is_some() {
                outputs += 1;
            }
        }
        (outputs, interpolator.set_points()[0].to_num::<f64>(), planner.is_waiting())
    };
    assert!(operator.acknowledge(m27).is_err());
    assert_eq!(go(50).0, 0);
    // It is in the plan, and not put out.
    assert!(operator.acknowledge(m27).is_err() && operator.awaited().is_none());
    assert_eq!(go(1000), (1, 10.0, true));
    assert_eq!(operator.awaited(), Some(m27));
    for other in [Function::M(26), Function::H(27), Function::Tool(27)] {
        assert!(operator.acknowledge(other).is_err());
    }
    assert!(operator.acknowledge(m27).is_ok());
    // Twice: not for the one that is still to come.
    assert!(operator.acknowledge(m27).is_err());
    assert_eq!(go(1000), (1, 20.0, true));
    assert!(operator.acknowledge(m27).is_ok() && operator.acknowledge(m27).is_err());
    assert_eq!(go(1000), (1, 30.0, true));
}

/// More than there are sequence numbers: no acknowledgement of before passes for one of now.
#[test]
fn a_thousand_acknowledgements_are_each_waited_for() {
    let machine = machine(1);
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let text: &[u8] = b"$FOR P1 = 1, 1000, 1\nG01 X[P1/10] F6000 M27\n$ENDFOR\nM30\n";
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(&machine, [Position::ZERO; 3], text).expect("machine data");
    let m27 = Function::M(27);
    for round in 0..1000 {
        let mut outputs = 0;
        for _ in 0..200 {
            while !matches!(planner.poll(), Ok(Progress::Waiting | Progress::Done)) {}
            interpolator.tick();
            outputs += std::iter::from_fn(|| operator.output()).count();
        }
        assert_eq!((outputs, planner.is_waiting()), (1, true), "round {round}");
        assert_eq!(operator.awaited(), Some(m27), "round {round}");
        assert!(operator.acknowledge(m27).is_ok() && operator.acknowledge(m27).is_err(), "round {round}");
    }
}

#[test]
fn types_that_are_known_and_not_there_are_refused() {
    for (synch, name, _) in Synch::ALL {
        let mut machine = machine(1);
        machine.channel.interpolator = glidepath::machine::InterpolatorData::ALL;
        machine.channel.h_synch = SynchTable::NONE.with(3, Synch::Mos).with(9, synch);
        let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
        let refused = channel.split(&machine, [Position::ZERO; 3], b"M30".as_slice()).err();
        match refused.map(|error| error.to_string()) {
            None => assert!(synch.is_available()),
            Some(text) => {
                assert_eq!(text, format!("h_synch[9] = {name} is known, not available in this version"))
            }
        }
    }
    let table = (0..40).fold(SynchTable::NONE, |table, code| table.with(code, Synch::MvsSvs));
    assert!(table.overflows() && table.of(39) == Synch::Mos && table.of(0) == Synch::MvsSvs);
    let mut machine = machine(1);
    machine.channel.m_synch = table;
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    assert!(channel.split(&machine, [Position::ZERO; 3], b"M30".as_slice()).is_err());
}

#[test]
fn a_function_of_a_motion_that_is_refused_does_not_come_out() {
    let machine = machine(1);
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let text: &[u8] = b"N10 G01 X10 F6000\nN20 G02 X20 Y5 I3 J9 M26\nM30\n";
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(&machine, [Position::ZERO; 3], text).expect("machine data");
    let mut errors = 0;
    loop {
        match planner.poll() {
            Ok(Progress::Done) => break,
            Ok(Progress::Waiting) => _ = interpolator.tick(),
            Err(_) => errors += 1,
            Ok(_) => {}
        }
    }
    while interpolator.tick() == State::Active {}
    assert_eq!((errors, operator.output()), (1, None));
    assert_eq!(interpolator.set_points()[0], Position::from_num(10));
}

/// Rows: D3-153.
#[test]
fn a_dwell_between_rounded_blocks() {
    // POST_ACTION: M25 behind the first curve; the dwell keeps the corner before it sharp; M26 behind the
    // last curve.
    let text = "%c\nN20 G91 G01 F6000\nN30 #CONTOUR MODE [DEV PATH_DEV=3 POST_ACTION]\nN40 X40 G61 M25\nN50 Y40 F3000\n\
        N60 X40 G61 F6000\nN70 G04 X0.2\nN80 Y40\nN100 X40 G61\nN110 Y40 M26\nN120 G04 X0.1\nM30\n";
    for slope in 0..4 {
        let machine = machine(slope);
        let run = acknowledged(text, &machine, Some(150));
        let functions: Vec<_> = run.outputs.iter().map(|(_, o)| (o.function, o.n)).collect();
        assert_eq!(functions, [(Function::M(25), 40), (Function::M(26), 110)]);
        for (k, x, y) in [(0, 40, 0.0), (1, 120, 80.0)] {
            let (from, to) = run.stands(k);
            assert!((from + 151..from + 156).contains(&to), "{from} … {to}");
            assert_eq!(run.row(from)[0], x << 32);
            let beyond = run.trace.mm(from)[1] - y;
            assert!(beyond > 1.0 && beyond < 15.0, "{beyond}");
        }
        // The dwell: N60 ends where it was programmed.
        let rest = (0..run.trace.len()).filter(|&row| run.row(row) == mm([80, 40, 0])).count();
        assert!((200..=202).contains(&rest), "{rest}");
        assert_eq!(run.end(), mm([120, 120, 0]));
    }
}

#[test]
fn random_programs_with_functions_keep_limits_and_path() {
    // 1367: a span before a closed gate that is too short to be cut.
    for seed in host_tests::seeds::seeds((0..160).chain([1367]), 8) {
        let mut machine = machines::arbitrary::<3>(seed);
        machine.channel.slope_profile = (seed % 4) as u8;
        (machine.channel.m_synch, machine.channel.h_synch) =
            (self::machine(1).channel.m_synch, self::machine(1).channel.h_synch);
        let program = program(seed, Mix::arbitrary(3, seed));
        let mut random = Random::new(seed);
        let words = ["M25", "M26", "M27", "H7", "M3", "M24"];
        let mut functions = 0;
        let text: String = program
            .text(&machine)
            .lines()
            .map(|line| {
                if !line.contains(['X', 'Y', 'Z']) || !random.once_in(3) {
                    return format!("{line}\n");
                }
                let word = words[(random.bits() % 6) as usize];
                functions += usize::from(word != "M24");
                format!("{line} {word}\n")
            })
            .collect();
        let start = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
        let ticks =
            run_from(&text, start, &Case { machine: &machine, delay: Some(0), acts: &[], polls: 1000 });
        for k in 0..4 {
            let delay = Some(random.magnitude(1.0, 1000.0) as usize - 1);
            let mut acts = random_acts(&mut random, ticks.trace.len());
            acts.truncate(if k == 0 { 0 } else { acts.len() });
            // Behind a gate the queue is empty: a dozen calls a tick would not keep up with blocks of three
            // ticks.
            let polls = POLLS[1 + (random.bits() % 2) as usize];
            let run = run_from(&text, start, &Case { machine: &machine, delay, acts: &acts, polls });
            let operated = Operated {
                over: 1.0,
                trace: run.trace,
                distances: run.distances,
                aborted: acts.iter().any(|(_, act)| *act == Act::Abort),
                ..Operated::default()
            };
            judge(&program, &machine, &operated)
                .unwrap_or_else(|fault| panic!("seed {seed}, {delay:?}, {acts:?}: {fault}\n{text}"));
            if !operated.aborted {
                assert_eq!(run.outputs.len(), functions, "seed {seed}, {delay:?}, {acts:?}\n{text}");
            }
        }
    }
}

/// X of every row from this one on, in mm.
fn x_from(run: &Run, row: usize) -> impl Iterator<Item = f64> {
    (row..run.trace.len()).map(|k| run.trace.mm(k)[0])
}

#[test]
fn a_hold_at_a_gate_holds_behind_a_change_of_override_too() {
    let text = "F3000\nN1 G01 X10\nN2 M25\nN3 X20\nM30\n";
    for slope in 0..4 {
        let machine = machine(slope);
        for act in [Act::Override(500), Act::Reduced(true)] {
            let acts = [(600, act), (700, Act::Hold), (1600, Act::Resume)];
            let case = Case { machine: &machine, delay: Some(800), acts: &acts, polls: 1000 };
            let run = run(text, &case);
            let acknowledged = run.acknowledged[0];
            assert!((1000..1400).contains(&acknowledged), "{acknowledged}");
            assert!(
                x_from(&run, 600).take(1000).all(|x| x == 10.0),
                "slope {slope}, {act:?}: it moved in the hold"
            );
            assert_eq!(x_from(&run, 1600).last(), Some(20.0), "slope {slope}, {act:?}");
        }
    }
}

#[test]
fn an_abort_at_a_gate_is_carried_out_behind_a_change_of_override_too() {
    let text = "F3000\nN1 G01 X10\nN2 M25\nN3 X20\nM30\n";
    for slope in 0..4 {
        let machine = machine(slope);
        for before in
            [&[(600, Act::Override(500))][..], &[(600, Act::Reduced(true)), (650, Act::Reduced(false))]]
        {
            let acts: Vec<(usize, Act)> = before.iter().copied().chain([(800, Act::Abort)]).collect();
            let case = Case { machine: &machine, delay: None, acts: &acts, polls: 1000 };
            let run = run(text, &case);
            assert!(run.trace.len() < 1000, "slope {slope}: it still waits");
            assert!(x_from(&run, 600).all(|x| x == 10.0), "slope {slope}");
        }
    }
}
