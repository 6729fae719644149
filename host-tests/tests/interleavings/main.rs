//! Every order of events between planner and interrupt on two cores: the code of the target, on a memory with
//! which the test chooses before each access to a shared word which side continues.
//!
//! A side runs from the start of its operation with the earlier results of its accesses, makes one more
//! access, and is stopped there by unwinding. Equal states are merged; the paths that lead to a state are
//! counted.
mod memory;
mod planner;

use glidepath::quantity::Position;
use glidepath::queue::word::Word;
use glidepath::queue::{Clock, Display, Reserve, Ring, Timeline, Words};
use memory::{INTERRUPT, LAW, Model, ModelWord, NEXT, PLANNER, Rules, Turn, Value, WORLD, World, piece};
use planner::{FAR, Planner, STOP, Shared, Step};
use std::collections::{HashMap, VecDeque};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;

/// Both sides, and the memory.
#[derive(Clone)]
struct State {
    values: Vec<Value>,
    buffers: [VecDeque<(usize, Value)>; 2],
    answers: [Vec<Value>; 2],
    waits: [bool; 2],
    stale: [bool; 2],
    planner: Planner,
    timeline: Timeline<'static, Model>,
    ticks: usize,
    /// Law and instant of every tick that had a piece.
    shown: Vec<u32>,
}

impl State {
    fn key(&self) -> u128 {
        let mut hash = [DefaultHasher::new(), DefaultHasher::new()];
        1_u8.hash(&mut hash[1]);
        for hash in &mut hash {
            (&self.values, &self.buffers, &self.answers, self.waits, self.stale, self.ticks, &self.shown)
                .hash(hash);
            let Planner { next, laws, end, cut, way, left, .. } = &self.planner;
            (next, laws, end, cut, way, left, self.planner.keeper.key()).hash(hash);
            let (phase, done, stops, at) = self.timeline.key();
            (phase.distance.to_bits(), phase.ticks, done, stops, at).hash(hash);
        }
        u128::from(hash[0].finish()) << 64 | u128::from(hash[1].finish())
    }
}

/// What an exploration found.
#[derive(Debug, Default)]
struct Found {
    interleavings: u128,
    states: usize,
    /// Ends in which so many cuts came in time.
    in_time: [u128; 4],
    /// Ends in which the interrupt has left by the first way.
    left: u128,
    fault: Option<String>,
}

/// Runs `steps` beside so many ticks, with the queue filled up to an instant, in every order.
fn explore(steps: &[Step], ticks: usize, filled: u32, rules: Rules) -> Found {
    // Once to see who writes what.
    WORLD.with_borrow_mut(|world| *world = World::default());
    NEXT.set(1);
    let ring = Box::leak(Box::new(Ring::blank()));
    let reserve = Box::leak(Box::new(Reserve::blank()));
    let clock: &'static mut Clock<Model> = Box::leak(Box::new(Clock::blank()));
    clock.reset();
    let clock = &*clock;
    let (pieces, consumer) = ring.split();
    let (keeper, taker) = reserve.split();
    let words = &*Box::leak(Box::new(Words::blank()));
    let latest = &*Box::leak(Box::new(ModelWord::ZERO));
    latest.store(u16::MAX.into(), Ordering::Relaxed);
    let display = Display::new(words, clock, pieces.gauge(), latest);
    let mut shared = Shared { clock, pieces, words, display };
    let mut planner =
        Planner { next: 0, keeper, laws: vec![(0, 0)], end: filled, cut: None, way: None, left: false };
    for [from, to] in [[0, 2], [2, filled]] {
        assert!(from == to || shared.pieces.push(piece(0, from, to - from)).is_ok());
    }
    if filled < FAR {
        planner.step(Step::Keep, &mut shared);
    }
    if let Some(beyond @ Step::Beyond(_)) = steps.first() {
        planner.step(*beyond, &mut shared);
        planner.next = 1;
    }
    let start = State {
        values: Vec::new(),
        buffers: Default::default(),
        answers: Default::default(),
        waits: [false; 2],
        stale: [false; 2],
        planner,
        timeline: Timeline::new(consumer, taker),
        ticks: 0,
        shown: Vec::new(),
    };
    WORLD.with_borrow_mut(|world| world.rules = rules);
    let mut found = Found::default();
    for round in 0..2 {
        let start = State { values: WORLD.with_borrow(|world| world.values.clone()), ..start.clone() };
        // The first round learns who writes what, in one order of events.
        found = if round == 0 { Found::default() } else { found };
        let mut layer = HashMap::from([(start.key(), (start.clone(), 1_u128))]);
        while !layer.is_empty() {
            let mut next: HashMap<u128, (State, u128)> = HashMap::new();
            for (state, paths) in layer.into_values() {
                found.states += 1;
                let mut ends = true;
                for side in [PLANNER, INTERRUPT] {
                    for follower in [turn(&state, side, steps, ticks, &mut shared), drain(&state, side)] {
                        let follower = match follower {
                            Ok(Some(follower)) => follower,
                            Ok(None) => continue,
                            Err(fault) => {
                                found.fault = Some(fault);
                                return found;
                            }
                        };
                        ends = false;
                        if round == 0 && !next.is_empty() {
                            continue;
                        }
                        next.entry(follower.key()).or_insert((follower, 0)).1 += paths;
                    }
                }
                if ends && round > 0 {
                    if let Err(fault) = judge(&state, steps, ticks) {
                        found.fault = Some(fault);
                        return found;
                    }
                    found.interleavings += paths;
                    found.in_time[state.planner.laws.len().saturating_sub(1).min(3)] += paths;
                    found.left += if state.shown.iter().any(|at| at / LAW == STOP) { paths } else { 0 };
                }
            }
            layer = next;
        }
        WORLD.with_borrow_mut(|world| world.values.clone_from(&start.values));
    }
    found
}

/// The oldest store of a side reaches the memory.
fn drain(state: &State, side: usize) -> Result<Option<State>, String> {
    let mut state = state.clone();
    let Some((id, value)) = state.buffers[side].pop_front() else { return Ok(None) };
    if id >= state.values.len() {
        state.values.resize(id + 1, [0; 2]);
    }
    state.values[id] = value;
    (state.waits, state.stale) = ([false; 2], [true; 2]);
    Ok(Some(state))
}

/// A side makes its next access, if it can.
fn turn(
    state: &State,
    side: usize,
    steps: &[Step],
    ticks: usize,
    shared: &mut Shared,
) -> Result<Option<State>, String> {
    let is_done = [state.planner.next == steps.len(), state.ticks == ticks];
    if is_done[side] || state.waits[side] {
        return Ok(None);
    }
    let mut state = state.clone();
    WORLD.with_borrow_mut(|world| {
        world.values = std::mem::take(&mut state.values);
        world.values.resize(NEXT.get() as usize, [0; 2]);
        world.buffers = std::mem::take(&mut state.buffers);
        world.answers = std::mem::take(&mut state.answers[side]);
        (world.side, world.given, world.may, world.waits) = (Some(side), 0, true, false);
        world.stale = state.stale[side];
    });
    let (mut planner, mut timeline) = (state.planner.clone(), state.timeline.clone());
    let mut shown = None;
    let is_over = catch_unwind(AssertUnwindSafe(|| {
        if side == PLANNER {
            planner.step(steps[planner.next], shared);
            planner.next += 1;
        } else {
            let begun = timeline.begin(shared.clock);
            shown = begun.map(|distance| (distance >> 44) as u32);
            if let (Some(distance), true) = (begun, matches!(steps.first(), Some(Step::Look))) {
                shared.words.show_distance(distance);
                let distance = (distance >> 44) as u32;
                shared.words.show_curve(distance, (distance + 7) as u16);
                let tick = shared.clock.tick();
                shared.words.show_points(tick, &[Position::from_bits(i64::from(distance) << 44)]);
            }
            if shown.is_some() { shared.clock.pass() } else { shared.clock.rest() }
        }
    }));
    if let Err(payload) = &is_over
        && !payload.is::<Turn>()
    {
        return Err("a panic".into());
    }
    WORLD.with_borrow_mut(|world| {
        world.side = None;
        state.values.clone_from(&world.values);
        state.buffers = std::mem::take(&mut world.buffers);
        state.answers[side] = std::mem::take(&mut world.answers);
        (state.waits[side], state.stale[side]) = (world.waits, world.stale);
        if let Some(fault) = world.fault.take() {
            return Err(format!("{fault}: {:?}", state.shown));
        }
        Ok(())
    })?;
    if !state.waits[side] {
        // The other one may find what it waits for.
        (state.waits[1 - side], state.stale[1 - side]) = (false, true);
    }
    if is_over.is_ok() {
        (state.planner, state.timeline) = (planner, timeline);
        state.answers[side].clear();
        if side == INTERRUPT {
            state.ticks += 1;
            state.shown.extend(shown);
        }
    }
    Ok(Some(state))
}

/// The motion is that of the laws the planner has decided on, tick by tick.
fn judge(state: &State, steps: &[Step], ticks: usize) -> Result<(), String> {
    let State { planner, shown, .. } = state;
    // Behind the last tick nothing that has not happened will.
    let is_over = steps.get(planner.next).is_none_or(|step| matches!(step, Step::Retire | Step::Late));
    if !is_over || state.ticks < ticks {
        return Err(format!("a side waits for ever: {shown:?}, {:?}", planner.laws));
    }
    for (instant, at) in (0..).zip(shown) {
        if *at != planner.expected(instant) * LAW + instant {
            return Err(format!("{shown:?} is not {:?}, {:?}", planner.laws, planner.way));
        }
    }
    let rests = shown.len() < ticks;
    if rests
        && planner.way.is_none()
        && shown.len() < planner.end as usize
        && !steps.iter().any(|s| matches!(s, Step::Late))
    {
        return Err(format!("it rests with pieces in the queue: {shown:?}, {:?}", planner.laws));
    }
    if rests
        && let Some((_, to, _)) = planner.way
        && shown.len() < to as usize
    {
        return Err(format!("it stands before its way has ended: {shown:?}, {:?}", planner.way));
    }
    Ok(())
}

const CUTS: &[Step] = &[Step::Cut(1), Step::Retire, Step::Cut(0)];
const ONE: &[Step] = &[Step::Cut(1)];
const LOOKS: &[Step] = &[Step::Look, Step::Look];
const WAYS: &[Step] = &[Step::Extend(1), Step::Keep, Step::Late];
const WAY: &[Step] = &[Step::Beyond(1), Step::Keep];
const BOTH: &[Step] = &[Step::Cut(1), Step::Late];
/// The queue goes on behind the start of the way in reserve, which does not count before that is moved on. A
/// change then may be too late at any of its ticks.
const CHANGE: &[Step] = &[Step::Beyond(1), Step::Change(1, 1)];
const NOW: &[Step] = &[Step::Beyond(1), Step::Change(0, 2), Step::Late];
const APART: &[Step] = &[Step::Beyond(1), Step::Apart(0, 2), Step::Late];

fn passes(name: &str, steps: &[Step], ticks: usize, filled: u32, rules: Rules) -> Found {
    let started = std::time::Instant::now();
    let found = explore(steps, ticks, filled, rules);
    println!(
        "{:?} {name}: {} interleavings, {} states, cuts in time {:?}, left {}",
        started.elapsed(),
        found.interleavings,
        found.states,
        found.in_time,
        found.left
    );
    assert_eq!(found.fault, None, "{name}");
    assert!(found.interleavings > 1000, "{name}");
    found
}

/// A part of the code left out: some order of events has to show it.
fn fails(name: &str, steps: &[Step], ticks: usize, filled: u32, rules: Rules) {
    let found = explore(steps, ticks, filled, rules);
    println!("{name}: {:?} after {} states", found.fault, found.states);
    assert!(found.fault.is_some(), "{name}");
}

const BUFFERED: Rules = Rules { buffered: true, unfenced: false, hasty: false };
const HASTY: Rules = Rules { buffered: false, unfenced: false, hasty: true };
const UNFENCED: Rules = Rules { buffered: true, unfenced: true, hasty: false };

#[test]
fn cuts_in_a_row_are_taken_as_a_whole_or_not_at_all() {
    let found = passes("cuts", CUTS, 4, FAR, Rules::default());
    assert!(found.in_time.iter().take(3).all(|n| *n > 0), "{found:?}");
    passes("cuts, stores delayed", ONE, 2, FAR, BUFFERED);
}

#[test]
fn the_way_in_reserve_is_taken_back_or_gone_to_its_end() {
    let found = passes("ways", WAYS, 7, 3, Rules::default());
    assert!(found.left > 0 && found.left < found.interleavings, "{found:?}");
    let found = passes("ways and cuts", BOTH, 5, 3, Rules::default());
    assert!(found.left > 0 && found.left < found.interleavings, "{found:?}");
    passes("ways, stores delayed", WAY, 3, 2, BUFFERED);
}

#[test]
fn a_cut_and_the_way_behind_it_change_together() {
    for (name, steps) in [("change", CHANGE), ("change at once", NOW)] {
        let found = passes(name, steps, 5, 2, Rules::default());
        assert!(found.left > 0 && found.in_time.iter().filter(|n| **n > 0).count() > 1, "{found:?}");
    }
    // A tick at the start of the way, and a cut that is too late: it would come to the end at speed.
    fails("one after the other", APART, 5, 2, Rules::default());
}

#[test]
fn the_status_is_never_a_mixture_of_two_ticks() {
    passes("status", LOOKS, 3, FAR, Rules::default());
    passes("status, stores delayed", &LOOKS[..1], 1, FAR, BUFFERED);
    fails("status", LOOKS, 3, FAR, HASTY);
}

#[test]
fn a_planner_that_does_not_wait_for_the_tick_at_hand_is_found_out() {
    fails("cuts", CUTS, 4, FAR, HASTY);
    fails("ways", WAYS, 7, 3, HASTY);
    fails("change", NOW, 5, 2, HASTY);
}

#[test]
fn a_missing_fence_is_found_out() {
    fails("cuts", ONE, 2, FAR, UNFENCED);
    fails("ways", WAY, 3, 2, UNFENCED);
}
