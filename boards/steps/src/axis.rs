//! Makes the step pulses of one axis in a tick, with the times that the axis's driver needs. A tick is
//! divided into slots.
use crate::backlash::{Backlash, TakeUp};
use crate::counter::Counter;
use crate::data::{MOTORS, Motor};
use crate::spread::Spread;
use crate::timing::Timing;

/// Words of one motor.
#[derive(Clone, Copy, Debug, Default)]
struct Words {
    step: u32,
    positive: u32,
    negative: u32,
}

/// An axis and its position.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    counter: Counter,
    timing: Timing,
    take_up: TakeUp,
    /// The axis does not follow a set point that moves further in a tick.
    reach: i64,
    /// The set point of the tick before.
    last: i64,
    /// Sum of the steps, as a position.
    count: i64,
    /// Steps that did not fit into their tick, signed.
    owed: i32,
    /// The level of the direction pins, once it is known.
    is_positive: Option<bool>,
    /// No step may begin before this slot of the next tick.
    free: u32,
    /// The direction may not change before this slot.
    turn: u32,
    /// The slot of the next tick in which a pulse ends.
    end: Option<u32>,
    motors: [Words; MOTORS],
    /// Switches the step pins of the motors in use on.
    on: u32,
    /// Switches all step pins off.
    off: u32,
}

/// The work of an axis in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Number of steps, signed.
    steps: i32,
    /// The planned slots of the steps; `None` if they are late.
    spread: Option<Spread>,
}

impl Axis {
    /// A blank plan.
    pub fn blank() -> Self {
        let counter = Counter::new(1, core::num::NonZeroU32::MIN, 0);
        let take_up = TakeUp::new(&Backlash::NONE, &counter.0, [0; 3]);
        let timing = Timing { pulse: 1, period: 2, setup: 0, hold: 1 };
        Self::new(counter, timing, take_up, 1, 0, &[None; MOTORS])
    }

    /// An axis at rest on the set point `bits`; steps per tick: `most`.
    pub fn new(
        counter: (Counter, i64),
        timing: Timing,
        take_up: TakeUp,
        most: u32,
        bits: i64,
        motors: &[Option<Motor>; MOTORS],
    ) -> Self {
        let (mut counter, mut count) = counter;
        // The position of the motor contains the backlash that is taken up at the start.
        let added = counter.advance(take_up.added());
        count += i64::from(added.count);
        let words = motors.map(|motor| {
            motor.map_or(Words::default(), |Motor { step, direction }| Words {
                step: step.on(),
                positive: direction.on(),
                negative: direction.off(),
            })
        });
        let off = motors.iter().flatten().fold(0, |word, motor| word | motor.step.off());
        let reach = counter.reach(most);
        Self {
            counter,
            timing,
            take_up,
            reach,
            last: bits,
            count,
            owed: 0,
            is_positive: None,
            free: 0,
            turn: 0,
            end: None,
            motors: words,
            on: words.iter().fold(0, |word, motor| word | motor.step),
            off,
        }
    }

    /// Sets the position to the set point `bits`, without pending steps.
    pub fn stand_at(&mut self, bits: i64) {
        self.count =
            self.counter.stand_at(bits) + i64::from(self.counter.advance(self.take_up.added()).count);
        (self.last, self.owed) = (bits, 0);
    }

    /// Whether a motor gets steps.
    pub fn set_motor(&mut self, motor: usize, is_on: bool) {
        let Some(words) = self.motors.get(motor) else { return };
        self.on = if is_on { self.on | words.step } else { self.on & !words.step };
    }

    /// Sum of the steps, as a position in counts.
    pub fn count(&self) -> i64 {
        self.count
    }

    /// Steps that begin in `words`.
    pub fn steps_in(&self, words: &[u32]) -> u32 {
        words.iter().fold(0, |steps, word| steps + u32::from(word & self.on != 0))
    }

    /// The word for all pins at rest: no pulse, positive direction.
    pub fn rest(&self) -> u32 {
        self.motors.iter().fold(self.off, |word, motor| word | motor.positive)
    }

    /// The plan for the set point `bits`; `None` if the set point is too far away.
    pub fn plan(&mut self, bits: i64, slots: u32) -> Option<Plan> {
        let distance = bits.wrapping_sub(self.last);
        self.last = bits;
        if distance.unsigned_abs() > self.reach.unsigned_abs() {
            return None;
        }
        let grains = self.counter.grains(distance);
        let grains = grains + self.take_up.step(grains);
        let crossings = self.counter.advance(grains);
        let due = if grains < 0 { -(crossings.count as i32) } else { crossings.count as i32 };
        let is_late = self.owed != 0;
        let steps = self.owed + due;
        self.owed = steps;
        let spread = (steps != 0 && !is_late).then(|| Spread::new(&crossings, slots));
        (steps.unsigned_abs() <= slots).then_some(Plan { steps, spread })
    }

    /// Writes the words of the tick. Returns whether all steps fit.
    pub fn write(&mut self, plan: Plan, words: &mut [u32]) -> bool {
        self.end_pulse(words);
        let slots = words.len() as u32;
        if plan.steps != 0 {
            self.face(plan.steps > 0, words);
            match plan.spread {
                Some(mut spread) => self.step(plan.steps, words, || spread.next()),
                None => self.step(plan.steps, words, || 0),
            }
        }
        self.free = self.free.saturating_sub(slots);
        self.turn = self.turn.saturating_sub(slots);
        self.owed == 0
    }

    /// Handles a tick without steps, in which a pulse may end.
    pub fn pause(&mut self, words: &mut [u32]) {
        let slots = words.len() as u32;
        self.end_pulse(words);
        self.free = self.free.saturating_sub(slots);
        self.turn = self.turn.saturating_sub(slots);
    }

    fn end_pulse(&mut self, words: &mut [u32]) {
        if let Some(word) = self.end.take().and_then(|end| words.get_mut(end as usize)) {
            *word |= self.off;
        }
    }

    /// Sets the direction as early as the hold time permits.
    fn face(&mut self, is_positive: bool, words: &mut [u32]) {
        if self.is_positive == Some(is_positive) {
            return;
        }
        let Some(word) = words.get_mut(self.turn as usize) else { return };
        for motor in &self.motors {
            *word |= if is_positive { motor.positive } else { motor.negative };
        }
        self.is_positive = Some(is_positive);
        self.free = self.free.max(self.turn + self.timing.setup);
    }

    /// Writes steps, each in its wanted slot or as early as possible after it. Steps that do not fit stay
    /// pending.
    #[inline(always)]
    fn step(&mut self, steps: i32, words: &mut [u32], mut wanted: impl FnMut() -> u32) {
        let (on, off) = (self.on, self.off);
        let Timing { pulse, period, hold, .. } = self.timing;
        let (mut free, mut left) = (self.free, steps.unsigned_abs());
        while left > 0 {
            let slot = wanted().max(free);
            let Some(word) = words.get_mut(slot as usize) else { break };
            *word |= on;
            // The last pulse may end in the next tick.
            if let Some(word) = words.get_mut((slot + pulse) as usize) {
                *word |= off;
            }
            free = slot + period;
            left -= 1;
        }
        let left = left as i32;
        self.owed = if steps < 0 { -left } else { left };
        if self.owed == steps {
            return;
        }
        let last = free - period;
        self.free = free;
        self.turn = last + hold;
        self.end = (last + pulse).checked_sub(words.len() as u32);
        self.count += i64::from(steps - self.owed);
    }
}
