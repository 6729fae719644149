//! The actions of the planner's side in a scenario, by the planner's own functions.
use crate::memory::{Model, WORLD, piece};
use glidepath::queue::word::Memory;
use glidepath::queue::{
    Change, Clock, Display, Keeper, NotNow, Phase, Pieces, Slot, Snapshot, Words, clock, renew,
};

/// One thing that the planner does.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// Another law so many ticks ahead, and no reserve, if the interrupt has not left.
    Cut(u32),
    /// Another law so many ticks ahead, so many ticks of it, and a way to a standstill behind them.
    Change(u32, u32),
    /// The same, one after the other: the reserve is taken back before it is known that the cut is in time.
    Apart(u32, u32),
    /// Waits until the last cut has passed, and takes it back.
    Retire,
    /// More of the law in the queue. It does not count before the way to a standstill is moved on.
    Extend(u32),
    /// The same before both sides run.
    Beyond(u32),
    /// A way to a standstill at the end of the queue, in place of the one there is.
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
    /// The way in reserve: from one instant to the other, and its law.
    pub way: Option<(u32, u32, u32)>,
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
                let at = now() + ahead;
                let ends = [at + 1, at + 1 + FAR];
                self.cut(at, ends, false, shared);
            }
            Step::Change(ahead, ticks) => {
                let at = now() + ahead;
                self.cut(at, [at + 1, at + ticks], true, shared);
            }
            Step::Apart(ahead, ticks) => {
                let at = now() + ahead;
                let old = self.way;
                self.left |= !self.keeper.drop_kept(clock);
                if self.left {
                    return;
                }
                self.way = None;
                if self.cut(at, [at + 1, at + ticks], false, shared) {
                    self.keep(self.end, shared);
                } else if let Some((at, ..)) = old {
                    self.keep(at, shared);
                }
            }
            Step::Retire => {
                if let Some(at) = self.cut.take() {
                    Model::wait(|| now() > at);
                    clock.withdraw();
                }
            }
            Step::Extend(ticks) | Step::Beyond(ticks) => {
                if self.left {
                    return;
                }
                put(piece(self.law() - 1, self.end, ticks));
                self.end += ticks;
            }
            Step::Keep => {
                if !self.left {
                    self.keep(self.end, shared);
                }
            }
            Step::Look => {
                let Snapshot {
                    ticks, moved, set_points: [point], before: [before], distance, n, block, ..
                } = display.read();
                let at = |tick: u32| i64::from(tick) << 44;
                let expected = ticks.saturating_sub(1);
                let shown = (point.to_bits(), distance.to_bits(), n, block);
                let is_one = shown
                    == (at(expected), at(expected), expected, expected + 7 * u32::from(ticks > 0))
                    && (moved, before.to_bits()) == (ticks > 0, at(expected.saturating_sub(1)));
                if !is_one {
                    WORLD.with_borrow_mut(|world| world.fault = Some("a mixture of two ticks"));
                }
            }
            Step::Late => {
                if let (true, Some((at, end, stop))) = (clock.has_left(), self.way) {
                    Model::wait(|| now() == end);
                    clock.withdraw();
                    let taken = pieces.taken();
                    pieces.withdraw(taken);
                    self.keeper.clear();
                    self.laws.push((at, stop));
                    self.laws.push((end, self.law()));
                    assert!(pieces.push(piece(self.law() - 1, end, FAR)).is_ok());
                    clock.let_go();
                    (self.way, self.left, self.end) = (None, false, end + FAR);
                }
            }
        }
    }

    /// Another law from `at` on, to the ends of two pieces, with a way behind them or without. Whether it counts.
    fn cut(&mut self, at: u32, ends: [u32; 2], keeps: bool, shared: &mut Shared) -> bool {
        if self.left {
            return false;
        }
        let change = Change::begin(&mut shared.pieces);
        for [from, to] in [[at, ends[0]], ends] {
            if to > from {
                assert!(shared.pieces.push(piece(self.law(), from, to - from)).is_ok());
            }
        }
        if keeps {
            self.write(ends[1]);
        }
        let [instant, way] = [at, ends[1]].map(|instant| instant * clock::TICK);
        let way = keeps.then_some(way);
        match change.hand_over(instant, way, &mut shared.pieces, &mut self.keeper, shared.clock) {
            Ok(_) => {
                self.way = keeps.then(|| (ends[1], ends[1] + 2, self.stop()));
                self.laws.push((at, self.law()));
                (self.cut, self.end) = (Some(at), ends[1]);
                true
            }
            Err(not_now) => {
                self.left = not_now == NotNow::Left;
                false
            }
        }
    }

    /// The law of the next way.
    fn stop(&self) -> u32 {
        self.way.map_or(STOP, |(.., stop)| stop + 1)
    }

    /// The pieces of a way from an instant on.
    fn write(&mut self, at: u32) {
        let stop = self.stop();
        self.keeper.begin();
        for piece in [piece(stop, at, 1), piece(stop, at + 1, 1), Phase::BLANK] {
            assert!(self.keeper.push(piece));
        }
    }

    /// A way in place of the one there is.
    fn keep(&mut self, at: u32, shared: &Shared) {
        self.write(at);
        if renew(at * clock::TICK, &mut self.keeper, shared.clock) {
            self.way = Some((at, at + 2, self.stop()));
        } else {
            self.left = true;
        }
    }

    /// The law that has to hold at an instant.
    pub fn expected(&self, instant: u32) -> u32 {
        let kept = self.way.filter(|(at, ..)| *at <= instant).map(|(.., stop)| stop);
        let decided = self.laws.iter().rev().find(|(at, _)| *at <= instant).map(|(_, law)| *law);
        kept.or(decided).unwrap_or(0)
    }
}
