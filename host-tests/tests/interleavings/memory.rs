//! A memory that reports every access of the code, makes one access per turn, and may delay stores.
use glidepath::quantity::{Distance, Speed};
use glidepath::queue::word::{Memory, Place, Replay, Word};
use glidepath::queue::{Phase, Slot};
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::marker::PhantomData;
use std::panic::resume_unwind;
use std::sync::atomic::Ordering;

/// A value of the memory: that of a word, or of a place: law and first instant, ticks.
pub type Value = [u32; 2];

/// An access to the memory.
#[derive(Clone, Copy, PartialEq)]
pub enum Access {
    Load(usize),
    Store(usize, Value),
    Fence,
}

pub const PLANNER: usize = 0;
pub const INTERRUPT: usize = 1;

/// How the memory behaves.
#[derive(Clone, Copy, Default)]
pub struct Rules {
    /// Stores of a side reach the other one later, in their order.
    pub buffered: bool,
    /// Broken: no fence, the planner does not wait for a tick at hand.
    pub unfenced: bool,
    pub hasty: bool,
}

/// What both sides see.
#[derive(Default)]
pub struct World {
    pub rules: Rules,
    pub values: Vec<Value>,
    pub buffers: [VecDeque<(usize, Value)>; 2],
    /// Who writes what.
    pub writers: Vec<Option<usize>>,
    /// Whose turn it is; before the sides run nobody's.
    pub side: Option<usize>,
    /// Answers of the accesses made, and how many of them are given again.
    pub answers: Vec<Value>,
    pub given: usize,
    /// One access may be made.
    pub may: bool,
    /// The side waits for the other one.
    pub waits: bool,
    /// The other one has done something since this one began to look whether it has to wait.
    pub stale: bool,
    pub fault: Option<&'static str>,
}

thread_local! {
    pub static WORLD: RefCell<World> = RefCell::default();
    /// Identities given to words and places.
    pub static NEXT: Cell<u32> = const { Cell::new(1) };
}

/// The end of a side's turn.
pub struct Turn;

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
pub fn access(access: Access) -> Value {
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
        if !world.is_own(side, access) && !std::mem::take(&mut world.may) {
            return None;
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
pub fn identity(cell: &Cell<u32>) -> usize {
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

pub struct Model;

pub struct ModelWord(Cell<u32>);

// SAFETY: the whole test is one thread.
unsafe impl Sync for ModelWord {}

pub struct ModelPlace<T>(Cell<u32>, PhantomData<T>);

impl Memory for Model {
    type Word = ModelWord;
    type Place<T: Slot> = ModelPlace<T>;

    fn fence(order: Ordering) {
        if order == Ordering::SeqCst && !WORLD.with_borrow(|world| world.rules.unfenced) {
            access(Access::Fence);
        }
    }

    fn wait(mut is_over: impl FnMut() -> bool) {
        let mark = WORLD.with_borrow(|world| world.given);
        WORLD.with_borrow_mut(|world| world.stale &= world.answers.len() != mark);
        if is_over() || WORLD.with_borrow(|world| world.rules.hasty) {
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
pub fn piece(law: u32, instant: u32, ticks: u32) -> Phase {
    Phase {
        distance: Distance::from_bits(i64::from(law * LAW + instant) << 44),
        speed: Speed::from_bits(1 << 58),
        ticks: ticks as u16,
        ..Phase::BLANK
    }
}

pub const LAW: u32 = 1000;

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
