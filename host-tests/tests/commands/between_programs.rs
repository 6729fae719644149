//! Unusual orders of events at standstill and between programs; random sessions (`sequences.rs`) found each
//! of them.
use glidepath::channel::{Channel, GoOnError, Handles, Progress};
use glidepath::fir::{Bank, FilterPlan, FilterTick, Filtered, Filters};
use glidepath::machine::{FilterType, MachineData};
use glidepath::nc::{Stream, Text, Window};
use glidepath::quantity::Position;
use glidepath::technology::Function;
use glidepath::tick::State;
use host_tests::calls::call;
use host_tests::cases::machines;
use host_tests::filtered::with_filter;

const BLOCKS: usize = 120;
const OVERLAYS: usize = 2;
const TAPS: usize = 202;

type Any<'a, T, P, I> = Handles<'a, T, 3, BLOCKS, P, I, OVERLAYS>;

fn mm(value: f64) -> Position {
    Position::from_num(value)
}

/// Calls and a tick, in which the operator sees what the drives get.
fn tick<T: Text, P: FilterPlan<3>, I: FilterTick<3>>(h: &mut Any<'_, T, P, I>) -> (bool, State) {
    let done = call(&mut h.planner, 1000, |_| ()).expect("nothing is refused");
    let state = h.interpolator.tick();
    assert_eq!(h.operator.status().set_points, *h.interpolator.set_points());
    (done, state)
}

fn ticks<T: Text, P: FilterPlan<3>, I: FilterTick<3>>(h: &mut Any<'_, T, P, I>, count: usize) {
    for _ in 0..count {
        tick(h);
    }
}

/// Ticks to a rest with nothing left, a few hundred at most.
fn run<T: Text, P: FilterPlan<3>, I: FilterTick<3>>(h: &mut Any<'_, T, P, I>) -> [f64; 3] {
    let ended = (0..3000).any(|_| tick(h) == (true, State::Idle));
    assert!(ended && h.planner.is_at_rest(), "no end");
    assert_eq!(h.planner.position(), h.interpolator.set_points());
    h.interpolator.set_points().map(|point| point.to_num())
}

/// Those with filters.
type Behind<'a> = Any<'a, &'a [u8], Bank<'a, 3, TAPS>, Filtered<'a, 3, TAPS>>;

fn filtered(work: impl Fn(&mut Behind<'_>)) {
    for kind in [FilterType::Average, FilterType::Gauss, FilterType::Delay] {
        let machine: MachineData<3> = with_filter(machines::even(1000), kind, 40);
        let mut memory: Box<Channel<3, BLOCKS, OVERLAYS>> = Box::new(Channel::new());
        let mut filters: Box<Filters<3, TAPS>> = Box::new(Filters::new());
        let start = [Position::ZERO; 3];
        let text = b"G00 X5\nM30\n".as_slice();
        work(&mut memory.split_filtered(&mut filters, &machine, start, text).expect("machine data"));
    }
}

/// A position that is set is no motion, for filters neither: the drives have it in its tick, and nothing of
/// the one before comes later, whatever is called before that tick.
#[test]
fn filters_take_a_position_over_at_once() {
    filtered(|h| {
        run(h);
        h.planner.set_position(1, mm(30.0)).expect("at rest");
        h.planner.continue_with(b"G04 0.1\n".as_slice()).expect("at rest");
        tick(h);
        assert_eq!(*h.interpolator.set_points(), [5.0, 30.0, 0.0].map(mm));
        assert_eq!(run(h), [5.0, 30.0, 0.0]);
        // Another one while the filters take over the one before.
        for gap in 0..40 {
            h.planner.set_position(1, mm(20.0)).expect("at rest");
            ticks(h, gap);
            h.planner.set_position(1, mm(-20.0)).expect("at rest");
            for _ in 0..100 {
                tick(h);
                assert_eq!(*h.interpolator.set_points(), [5.0, -20.0, 0.0].map(mm), "{gap}");
            }
        }
    });
}

/// A jog behind a position that was set stood for ever: each waited for the other.
#[test]
fn a_jog_follows_a_position_at_once() {
    filtered(|h| {
        run(h);
        for (axis, to) in [(0, 9.0), (1, -4.0)] {
            h.planner.set_position(0, mm(7.0)).expect("at rest");
            h.planner.move_axis(axis, mm(to), None).expect("at rest");
            assert_eq!(run(h)[axis], to);
        }
        // Behind an abort too.
        h.planner.load(b"G00 X0\nM30\n".as_slice()).expect("at rest");
        ticks(h, 60);
        h.operator.abort();
        run(h);
        h.planner.set_position(0, mm(7.0)).expect("at rest");
        h.planner.move_axis(0, mm(8.0), None).expect("at rest");
        assert_eq!(run(h)[0], 8.0);
    });
}

/// Where the axes stand at its point a function waits for no filter.
#[test]
fn a_function_at_a_standstill_comes_out_before_the_end() {
    filtered(|h| {
        run(h);
        h.planner.continue_with(b"M9\n".as_slice()).expect("at rest");
        run(h);
        assert!(h.operator.output().is_some_and(|output| output.function == Function::M(9)));
    });
}

/// An abort ends what was read before it, whether the planner has seen it or not, and nothing that is handed
/// over behind it.
#[test]
fn an_abort_at_rest_ends_what_was_before_it() {
    for shows in 0..4 {
        for seen in 0..4 {
            let machine: MachineData<3> = machines::even(1000);
            let mut memory: Box<Channel<3, BLOCKS, OVERLAYS>> = Box::new(Channel::new());
            let text = b"G91 G00 X5\nM30\n".as_slice();
            let h = &mut memory.split(&machine, [Position::ZERO; 3], text).expect("machine data");
            let abort = |h: &mut Any<'_, &[u8], _, _>| {
                h.planner.set_position(1, mm(2.0)).expect("at rest");
                ticks(h, shows);
                h.operator.abort();
                ticks(h, seen);
            };
            run(h);
            abort(h);
            h.planner.move_axis(0, mm(6.0), None).expect("at rest");
            assert_eq!(run(h), [6.0, 2.0, 0.0], "jog, {shows} {seen}");
            abort(h);
            // With everything as at program start.
            h.planner.continue_with(b"G00 X5\nQ7\nG00 X9\n".as_slice()).expect("at rest");
            let mut refused = 0;
            for _ in 0..1000 {
                match h.planner.poll() {
                    Ok(Progress::Working | Progress::Planned) => {}
                    Ok(_) => {
                        h.interpolator.tick();
                    }
                    Err(_) => refused += 1,
                }
            }
            assert_eq!((refused, run(h)), (1, [5.0, 2.0, 0.0]), "single line, {shows} {seen}");
            abort(h);
            assert_eq!(h.planner.go_on(), Err(GoOnError::NothingRefused), "{shows} {seen}");
            h.planner.load(b"G00 X1\nM30\n".as_slice()).expect("at rest");
            assert_eq!(run(h), [1.0, 2.0, 0.0], "{shows} {seen}");
        }
    }
}

/// The first line of the next program is read, also where nothing of the one before has come.
#[test]
fn a_stream_that_had_nothing_loses_no_line() {
    for restarts in [false, true] {
        let machine: MachineData<3> = machines::even(1000);
        let mut memory: Box<Channel<3, BLOCKS, OVERLAYS>> = Box::new(Channel::new());
        let mut window = Window::<256>::new();
        let (mut feeder, stream): (_, Stream<'_, 256>) = window.split();
        feeder.push(b"G00 X5\nM30\n");
        let h = &mut memory.split(&machine, [Position::ZERO; 3], stream).expect("machine data");
        run(h);
        for to in [7, 8] {
            h.planner.load_next().expect("at rest");
            // It waits for text, and is aborted.
            ticks(h, 3);
            h.operator.abort();
            ticks(h, 8);
            if restarts {
                feeder.restart();
            }
            h.planner.load_next().expect("at rest");
            feeder.push(format!("G91 G01 X1 F6000\nG90 X{to}\nM30\n").as_bytes());
            assert_eq!(run(h)[0], f64::from(to));
        }
    }
}
