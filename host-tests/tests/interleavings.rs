//! Every order of events between planner and interrupt on two cores: the code that runs on the target, on a memory that lets the
//! test choose before each access to a shared word which side comes next.
//!
//! A side runs from the beginning of its operation with the answers its accesses got before, does one access more, and is left by
//! unwinding at the next. States that are equal are one; the paths that lead to it are counted.
use glidepath::quantity::{Distance, Speed};
use glidepath::queue::word::{Memory, Place, Replay, Word};
use glidepath::queue::{Change, Clock, Keeper, Phase, Pieces, Reserve, Ring, Slot, Timeline, TooLate, clock};
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::collections::VecDeque;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::Ordering;

/// A value of the memory: that of a word, or of a place: law and first instant, ticks.
type Value = [u32; 2];

/// An access to the memory.
#[derive(Clone, Copy, PartialEq)]
enum Access {
    Load(usize),
    Store(usize, Value),
    Fence,
}

const PLANNER: usize = 0;
const INTERRUPT: usize = 1;

/// How the memory behaves.
#[derive(Clone, Copy, Default)]
struct Rules {
    /// Stores of a side reach the other one later, in their order.
    buffered: bool,
    /// Broken: no fence, the planner does not wait for a tick at hand.
    unfenced: bool,
    hasty: bool,
}

/// What both sides see.
#[derive(Default)]
struct World {
    rules: Rules,
    values: Vec<Value>,
    buffers: [VecDeque<(usize, Value)>; 2],
    /// Who writes what.
    writers: Vec<Option<usize>>,
    /// Whose turn it is; before the sides run nobody's.
    side: Option<usize>,
    /// Answers of the accesses made, and how many of them are given again.
    answers: Vec<Value>,
    given: usize,
    /// One access may be made.
    may: bool,
    /// The side waits for the other one.
    waits: bool,
    /// The other one has done something since this one began to look whether it has to wait.
    stale: bool,
    fault: Option<&'static str>,
}

thread_local! {
    static WORLD: RefCell<World> = RefCell::default();
    /// Identities given to words and places.
    static NEXT: Cell<u32> = const { Cell::new(1) };
}

/// The end of a side's turn.
struct Turn;

impl World {
    fn load(&self, side: usize, id: usize) -> Value {
        let own = self.buffers[side].iter().rev().find(|(other, _)| *other == id);
        own.map_or(self.values[id], |(_, value)| *value)
    }

    fn make(&mut self, side: usize, access: Access) -> Option<Value> {
        match access {
            Access::Load(id) => Some(self.load(side, id)),
            Access::Store(id, value) => {
                if *self.writers[id].get_or_insert(side) != side {
                    self.fault = Some("a word has two writers");
                }
                if self.rules.buffered {
                    self.buffers[side].push_back((id, value));
                } else {
                    self.values[id] = value;
                }
                Some(value)
            }
            Access::Fence if self.buffers[side].is_empty() => Some([0; 2]),
            Access::Fence => None,
        }
    }

    /// Whether nobody else has to do with it.
    fn is_own(&self, side: usize, access: Access) -> bool {
        match access {
            Access::Load(id) => self.writers[id] == Some(side),
            Access::Store(..) => false,
            Access::Fence => !self.rules.buffered,
        }
    }
}

/// The answer to an access, now or before.
fn access(access: Access) -> Value {
    let answer = WORLD.with_borrow_mut(|world| {
        let Some(side) = world.side else {
            if let Access::Store(id, value) = access {
                world.values[id] = value;
            }
            return Some(if let Access::Load(id) = access { world.values[id] } else { [0; 2] });
        };
        if let Some(answer) = world.answers.get(world.given) {
            world.given += 1;
            return Some(*answer);
        }
        if !world.is_own(side, access) {
            if !std::mem::take(&mut world.may) {
                return None;
            }
        }
        let answer = world.make(side, access);
        match answer {
            Some(answer) => {
                world.answers.push(answer);
                world.given += 1;
            }
            None => world.waits = true,
        }
        answer
    });
    answer.unwrap_or_else(|| resume_unwind(Box::new(Turn)))
}

/// The identity of a word or place, given at its first use.
fn identity(cell: &Cell<u32>) -> usize {
    if cell.get() == 0 {
        let id = NEXT.get();
        NEXT.set(id + 1);
        cell.set(id);
        WORLD.with_borrow_mut(|world| {
            world.values.resize(id as usize + 1, [0; 2]);
            world.writers.resize(id as usize + 1, None);
        });
    }
    cell.get() as usize
}

struct Model;

struct ModelWord(Cell<u32>);

// SAFETY: the whole test is one thread.
unsafe impl Sync for ModelWord {}

struct ModelPlace<T>(Cell<u32>, PhantomData<T>);

impl Memory for Model {
    type Word = ModelWord;
    type Place<T: Slot> = ModelPlace<T>;

    fn fence(order: Ordering) {
        if order == Ordering::SeqCst && !WORLD.with_borrow(|world| world.rules.unfenced) {
            access(Access::Fence);
        }
    }

    fn wait(is_over: impl Fn() -> bool) {
        let mark = WORLD.with_borrow(|world| world.given);
        WORLD.with_borrow_mut(|world| world.stale &= world.answers.len() != mark);
        if WORLD.with_borrow(|world| world.rules.hasty) || is_over() {
            return;
        }
        WORLD.with_borrow_mut(|world| {
            world.answers.truncate(mark);
            world.waits = !world.stale;
        });
        resume_unwind(Box::new(Turn));
    }
}

impl Replay for Model {}

impl Word for ModelWord {
    #[allow(clippy::declare_interior_mutable_const)]
    const ZERO: Self = Self(Cell::new(0));

    fn load(&self, _: Ordering) -> u32 {
        access(Access::Load(identity(&self.0)))[0]
    }

    fn store(&self, value: u32, _: Ordering) {
        access(Access::Store(identity(&self.0), [value, 0]));
    }
}

/// A piece that begins at this instant of a law: its path distance says both.
fn piece(law: u32, instant: u32, ticks: u32) -> Phase {
    Phase {
        distance: Distance::from_bits(i64::from(law * LAW + instant) << 44),
        speed: Speed::from_bits(1 << 58),
        ticks: ticks as u16,
        ..Phase::BLANK
    }
}

const LAW: u32 = 1000;

impl<T: Slot> Place<T> for ModelPlace<T> {
    #[allow(clippy::declare_interior_mutable_const)]
    const BLANK: Self = Self(Cell::new(0), PhantomData);

    unsafe fn read<R>(&self, take: impl FnOnce(&T) -> R) -> R {
        let id = identity(&self.0);
        // It takes its time.
        let [first, second] = [(); 2].map(|()| access(Access::Load(id)));
        if first != second {
            WORLD.with_borrow_mut(|world| world.fault = Some("a piece is written while it is read"));
        }
        let phase = piece(0, first[0], first[1]);
        assert_eq!(size_of::<T>(), size_of::<Phase>());
        // SAFETY: of the places only those of pieces are used.
        take(unsafe { &*std::ptr::from_ref(&phase).cast::<T>() })
    }

    unsafe fn write(&self, fill: impl FnOnce(&mut T)) {
        let mut phase = Phase::BLANK;
        // SAFETY: the same.
        fill(unsafe { &mut *std::ptr::from_mut(&mut phase).cast::<T>() });
        let value = [(phase.distance.to_bits() >> 44) as u32, phase.ticks.into()];
        access(Access::Store(identity(&self.0), value));
    }

    fn get(&self) -> *mut T {
        unreachable!("not in what is tried here")
    }
}

/// One thing that the planner does.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// Takes back the reserve; another law so many ticks ahead, if the interrupt has not left.
    Cut(u32),
    /// Waits until the last cut has passed, and takes it back.
    Retire,
    /// More of the law in the queue, and no reserve.
    Extend(u32),
    /// A way to a standstill at the end of the queue.
    Keep,
    /// If the interrupt has left: goes on from the standstill.
    Late,
}

/// The planner between two steps.
#[derive(Clone)]
struct Planner {
    next: usize,
    keeper: Keeper<'static, Model>,
    /// Instants at which laws begin, in the order of the decisions.
    laws: Vec<(u32, u32)>,
    end: u32,
    cut: Option<u32>,
    /// The way in reserve: from one instant to the other.
    way: Option<(u32, u32)>,
    /// The interrupt was found to have left.
    left: bool,
}

/// The law of a way in reserve.
const STOP: u32 = 50;

/// Behind the last tick.
const FAR: u32 = 30;

struct Shared {
    clock: &'static Clock<Model>,
    pieces: Pieces<'static, Model>,
}

impl Planner {
    fn law(&self) -> u32 {
        self.laws.len() as u32
    }

    fn step(&mut self, step: Step, shared: &mut Shared) {
        let Shared { clock, pieces } = shared;
        let now = || clock.now() / clock::TICK;
        let mut put = |piece| assert!(pieces.push(piece).is_ok());
        match step {
            Step::Cut(ahead) => {
                self.release(clock);
                if self.left {
                    return;
                }
                let at = now() + ahead;
                let change = Change::begin(pieces);
                for piece in [piece(self.law(), at, 1), piece(self.law(), at + 1, FAR)] {
                    assert!(pieces.push(piece).is_ok());
                }
                match change.commit(at * clock::TICK, pieces, clock) {
                    Ok(_) => {
                        self.laws.push((at, self.law()));
                        (self.cut, self.end) = (Some(at), at + 1 + FAR);
                    }
                    Err(TooLate) => {}
                }
            }
            Step::Retire => {
                if let Some(at) = self.cut.take() {
                    Model::wait(|| now() > at);
                    clock.withdraw();
                }
            }
            Step::Extend(ticks) => {
                if self.left {
                    return;
                }
                put(piece(self.law() - 1, self.end, ticks));
                self.end += ticks;
                self.release(clock);
            }
            Step::Keep => {
                if self.left {
                    return;
                }
                self.keeper.begin();
                for piece in [piece(STOP, self.end, 1), piece(STOP, self.end + 1, 1), Phase::BLANK] {
                    assert!(self.keeper.push(piece));
                }
                clock.keep(self.end * clock::TICK, self.keeper.commit());
                self.way = Some((self.end, self.end + 2));
            }
            Step::Late => {
                if let (true, Some((at, end))) = (clock.has_left(), self.way) {
                    Model::wait(|| now() == end);
                    clock.withdraw();
                    let taken = pieces.taken();
                    pieces.withdraw(taken);
                    self.keeper.clear();
                    self.laws.push((at, STOP));
                    self.laws.push((end, self.law()));
                    assert!(pieces.push(piece(self.law() - 1, end, FAR)).is_ok());
                    clock.let_go();
                    (self.way, self.left, self.end) = (None, false, end + FAR);
                }
            }
        }
    }

    fn release(&mut self, clock: &Clock<Model>) {
        if self.way.is_some() {
            self.left = !clock.release();
            if !self.left {
                self.keeper.clear();
                self.way = None;
            }
        }
    }

    /// The law that has to hold at an instant.
    fn expected(&self, instant: u32) -> u32 {
        let kept = self.way.filter(|(at, _)| *at <= instant).map(|_| STOP);
        let decided = self.laws.iter().rev().find(|(at, _)| *at <= instant).map(|(_, law)| *law);
        kept.or(decided).unwrap_or(0)
    }
}

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
            (next, laws, end, cut, way, left).hash(hash);
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
    /// Ends in which the interrupt has left.
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
    let mut shared = Shared { clock, pieces };
    let mut planner =
        Planner { next: 0, keeper, laws: vec![(0, 0)], end: filled, cut: None, way: None, left: false };
    for [from, to] in [[0, 2], [2, filled]] {
        assert!(shared.pieces.push(piece(0, from, to - from)).is_ok());
    }
    if filled < FAR {
        planner.step(Step::Keep, &mut shared);
    }
    let start = State {
        values: Vec::new(),
        buffers: Default::default(),
        answers: Default::default(),
        waits: [false; 2],
        stale: [false; 2],
        planner,
        timeline: Timeline::new(consumer, taker, clock),
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
            shown = timeline.begin().map(|distance| (distance >> 44) as u32);
            if shown.is_some() { timeline.pass() } else { timeline.rest() }
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
    Ok(())
}

const CUTS: &[Step] = &[Step::Cut(1), Step::Retire, Step::Cut(0)];
const ONE: &[Step] = &[Step::Cut(1)];
const WAYS: &[Step] = &[Step::Extend(1), Step::Keep, Step::Late];
const WAY: &[Step] = &[Step::Extend(1), Step::Late];
const BOTH: &[Step] = &[Step::Cut(1), Step::Late];

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
    passes("ways, stores delayed", WAY, 4, 3, BUFFERED);
}

#[test]
fn a_planner_that_does_not_wait_for_the_tick_at_hand_is_found_out() {
    fails("cuts", CUTS, 4, FAR, HASTY);
    fails("ways", WAYS, 7, 3, HASTY);
}

#[test]
fn a_missing_fence_is_found_out() {
    fails("cuts", ONE, 2, FAR, UNFENCED);
    fails("ways", WAY, 4, 3, UNFENCED);
}
