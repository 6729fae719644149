//! What the planner's side does in a scenario, by the functions that the planner itself uses.
use crate::memory::{Model, WORLD, piece};
use glidepath::queue::word::Memory;
use glidepath::queue::{Change, Clock, Display, Keeper, Phase, Pieces, Slot, Snapshot, Words, clock};

/// One thing that the planner does.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// Takes back the reserve; another law so many ticks ahead, if the interrupt has not left.
    Cut(u32),
    /// Waits until the last cut has passed, and takes it back.
    Retire,
    /// More of the law in the queue, and no reserve.
    Extend(u32),
    /// A way to a standstill at the end of the queue.
    Keep,
    /// Looks at the status, as an operator on a core of its own.
    Look,
    /// If the interrupt has left: goes on from the standstill.
    Late,
}

/// The planner between two steps.
#[derive(Clone)]
pub struct Planner {
    pub next: usize,
    pub keeper: Keeper<'static, Model>,
    /// Instants at which laws begin, in the order of the decisions.
    pub laws: Vec<(u32, u32)>,
    pub end: u32,
    pub cut: Option<u32>,
    /// The way in reserve: from one instant to the other.
    pub way: Option<(u32, u32)>,
    /// The interrupt was found to have left.
    pub left: bool,
}

/// The law of a way in reserve.
pub const STOP: u32 = 50;

/// Behind the last tick.
pub const FAR: u32 = 30;

pub struct Shared {
    pub clock: &'static Clock<Model>,
    pub pieces: Pieces<'static, Model>,
    pub words: &'static Words<1, Model>,
    pub display: Display<'static, 1, Model>,
}

impl Planner {
    fn law(&self) -> u32 {
        self.laws.len() as u32
    }

    pub fn step(&mut self, step: Step, shared: &mut Shared) {
        let Shared { clock, pieces, display, .. } = shared;
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
                if change.commit(at * clock::TICK, pieces, clock).is_ok() {
                    self.laws.push((at, self.law()));
                    (self.cut, self.end) = (Some(at), at + 1 + FAR);
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
            Step::Look => {
                let Snapshot { ticks, moved, set_points: [point], distance, step, n, block, .. } =
                    display.read();
                let at = |tick: u32| i64::from(tick) << 44;
                let expected = ticks.saturating_sub(1);
                let shown = (point.to_bits(), distance.to_bits(), n, block);
                let is_one = shown
                    == (at(expected), at(expected), expected, expected + 7 * u32::from(ticks > 0))
                    && (moved, step.to_bits()) == (ticks > 0, at(expected.min(1)));
                if !is_one {
                    WORLD.with_borrow_mut(|world| world.fault = Some("a mixture of two ticks"));
                }
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
    pub fn expected(&self, instant: u32) -> u32 {
        let kept = self.way.filter(|(at, _)| *at <= instant).map(|_| STOP);
        let decided = self.laws.iter().rev().find(|(at, _)| *at <= instant).map(|(_, law)| *law);
        kept.or(decided).unwrap_or(0)
    }
}
