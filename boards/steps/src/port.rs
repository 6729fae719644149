//! The step output of all axes on one port: converts set points to the port words of a tick. Refuses machine
//! data whose steps do not fit into the slots.
use crate::axis::Axis;
use crate::backlash::{Backlash, TakeUp};
use crate::counter::Counter;
use crate::data::{AxisSteps, StepData};
use crate::spread::MAX_SLOTS;
use crate::timing::Timing;
use crate::unfit::Unfit;
use core::num::NonZeroU32;
use glidepath::machine::{AxisData, AxisName, MachineData};
use glidepath::quantity::Position;

/// Whether the words lead to the set points.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum State {
    /// The sum of each axis's steps is its rounded set point.
    InTime,
    /// Some steps did not fit into the tick and follow in the next ones, as early as possible. Set points inside
    /// the limits of the machine data never cause this.
    Late,
    /// A set point jumped by more steps than a tick can hold, or more steps were late than a tick has slots.
    /// No axis gets steps until [`Steps::stand_at`].
    Stopped,
}

/// The step output of `AXES` axes with `SLOTS` slots per tick.
#[derive(Clone, Debug)]
pub struct Steps<const AXES: usize, const SLOTS: usize> {
    axes: [Axis; AXES],
    is_stopped: bool,
}

impl<const AXES: usize, const SLOTS: usize> Steps<AXES, SLOTS> {
    /// Step output at rest at the set points `start`.
    ///
    /// # Errors
    /// The data could lose steps, or put them too close together: [`Unfit`].
    pub fn new(
        data: &StepData<AXES>,
        machine: &MachineData<AXES>,
        start: &[Position; AXES],
    ) -> Result<Self, Unfit> {
        let cycle_us = machine.channel.cycle_us;
        let slots = SLOTS as u32;
        if !(4..=MAX_SLOTS).contains(&slots) {
            return Err(Unfit::Slots(slots));
        }
        if u64::from(data.slot_ns) * u64::from(slots) != u64::from(cycle_us) * 1000 || cycle_us == 0 {
            return Err(Unfit::Cycle { cycle_us, slot_ns: data.slot_ns, slots });
        }
        let mut taken = 0;
        for (steps, axis) in data.axes.iter().zip(&machine.axes) {
            check_pins(steps, axis.name, &mut taken)?;
        }
        // Only to be overwritten: an array of results cannot be turned round without a panicking path.
        let mut refused = None;
        let mut all = data.axes.iter().zip(&machine.axes).zip(start);
        let blank = Axis::blank();
        let axes = core::array::from_fn(|_| {
            let Some(((steps, axis), start)) = all.next() else { return blank };
            match make(steps, axis, start.to_bits(), Tick { slot_ns: data.slot_ns, slots, cycle_us }) {
                Ok(axis) => axis,
                Err(unfit) => {
                    refused = refused.or(Some(unfit));
                    blank
                }
            }
        });
        match refused {
            Some(unfit) => Err(unfit),
            None => Ok(Self { axes, is_stopped: false }),
        }
    }

    /// Writes the words from the set points of the last call to `set_points`, one per slot. Bits 0…15 of a word
    /// set pins, bits 16…31 reset them, as the register BSRR of an STM32. Words without a bit are 0.
    ///
    /// Bounded: a store for each slot, three divisions of 32 bits per axis, and a few additions for each step.
    pub fn fill(&mut self, set_points: &[Position; AXES], words: &mut [u32; SLOTS]) -> State {
        words.fill(0);
        let mut plans = [None; AXES];
        if !self.is_stopped {
            for ((plan, axis), set_point) in plans.iter_mut().zip(&mut self.axes).zip(set_points) {
                *plan = axis.plan(set_point.to_bits(), SLOTS as u32);
            }
            self.is_stopped = plans.iter().any(Option::is_none);
        }
        let mut is_in_time = true;
        for (plan, axis) in plans.into_iter().zip(&mut self.axes) {
            match plan {
                Some(plan) if !self.is_stopped => is_in_time &= axis.write(plan, words),
                _ => axis.pause(words),
            }
        }
        match (self.is_stopped, is_in_time) {
            (true, _) => State::Stopped,
            (false, true) => State::InTime,
            (false, false) => State::Late,
        }
    }

    /// Sets the positions of the axes: at power-up, after homing, or after [`State::Stopped`]. No step is output.
    /// Backlash that is taken up stays so.
    pub fn stand_at(&mut self, set_points: &[Position; AXES]) {
        for (axis, set_point) in self.axes.iter_mut().zip(set_points) {
            axis.stand_at(set_point.to_bits());
        }
        self.is_stopped = false;
    }

    /// Gives an axis at rest another coordinate for the same place, without a step.
    pub fn shift(&mut self, axis: usize, set_point: Position) {
        if let Some(axis) = self.axes.get_mut(axis) {
            axis.stand_at(set_point.to_bits());
        }
    }

    /// Stops the steps of all axes until [`Self::stand_at`]; a pulse that has begun ends.
    pub fn stop(&mut self) {
        self.is_stopped = true;
    }

    /// Whether no axis gets steps.
    pub const fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    /// Sum of an axis's steps until the end of the last words, as a position in counts; 0 for an axis that does
    /// not exist.
    pub fn count(&self, axis: usize) -> i64 {
        self.axes.get(axis).map_or(0, Axis::count)
    }

    /// Steps of an axis that begin in `words`. If a switch or probe changes in slot k of a tick, the first k + 1
    /// words give the position of the axis.
    pub fn steps_in(&self, axis: usize, words: &[u32]) -> u32 {
        self.axes.get(axis).map_or(0, |axis| axis.steps_in(words))
    }

    /// Sets whether motor 0 or 1 of an axis gets steps; at first both do. With one of two motors at rest, a
    /// gantry can be squared. Change it only at rest.
    pub fn set_motor(&mut self, axis: usize, motor: usize, is_on: bool) {
        if let Some(axis) = self.axes.get_mut(axis) {
            axis.set_motor(motor, is_on);
        }
    }

    /// The word for all pins at rest: no pulse, positive direction. Write it before the pins become outputs.
    pub fn rest_word(&self) -> u32 {
        self.axes.iter().fold(0, |word, axis| word | axis.rest())
    }
}

/// Lengths in a tick.
#[derive(Clone, Copy)]
struct Tick {
    slot_ns: u32,
    slots: u32,
    cycle_us: u32,
}

fn check_pins(steps: &AxisSteps, name: AxisName, taken: &mut u32) -> Result<(), Unfit> {
    if steps.motors.iter().all(Option::is_none) {
        return Err(Unfit::NoMotor(name));
    }
    for pin in steps.motors.iter().flatten().flat_map(|motor| [motor.step, motor.direction]) {
        if pin.bit > 15 {
            return Err(Unfit::NoPin(name, pin.bit));
        }
        if *taken & 1 << pin.bit != 0 {
            return Err(Unfit::PinTaken(name, pin.bit));
        }
        *taken |= 1 << pin.bit;
    }
    Ok(())
}

/// Makes one axis, if its data are valid.
fn make(steps: &AxisSteps, axis: &AxisData, bits: i64, tick: Tick) -> Result<Axis, Unfit> {
    let name = axis.name;
    let length = NonZeroU32::new(steps.length).filter(|length| length.get() <= 1_000_000);
    let (Some(length), 1..=1_000_000_000) = (length, steps.counts) else { return Err(Unfit::Ratio(name)) };
    let timing = Timing::new(steps, tick.slot_ns);
    let [most, behind_turn] = [timing.most(tick.slots), timing.most_behind_turn(tick.slots)];
    if most == 0 || behind_turn == 0 {
        return Err(Unfit::Times(name));
    }
    let Backlash { width, speed, accel, .. } = steps.backlash;
    if width > 1_000_000 || width > 0 && (speed == 0 || accel == 0) {
        return Err(Unfit::Backlash(name));
    }
    let (speed, accel) = if width == 0 { (0, 0) } else { (speed, accel) };
    let [counts, cycle] = [steps.counts, tick.cycle_us].map(u128::from);
    // µm/s · counts / mm · µs = 10^-9 counts per tick
    let room = u128::from(most) * u128::from(length.get()) * 1_000_000_000;
    let fastest = u64::from(axis.vb_max) + u64::from(speed);
    if u128::from(fastest) * counts * cycle > room {
        let permitted = room.checked_div(counts * cycle).unwrap_or(0) as u64;
        return Err(Unfit::TooFast { axis: name, speed: fastest, permitted });
    }
    // A tick moves at most a · T² further than the one before, which moved the other way, or less than a count
    // without a step: a · T² and two counts. mm/s² · counts / mm · µs² = 10^-12 counts
    let room = u128::from(behind_turn.saturating_sub(2)) * u128::from(length.get()) * 1_000_000_000_000;
    let steepest = u64::from(axis.a_max) + u64::from(accel);
    if u128::from(steepest) * counts * cycle * cycle > room {
        let permitted = room.checked_div(counts * cycle * cycle).unwrap_or(0) as u64;
        return Err(Unfit::TurnsTooFast { axis: name, accel: steepest, permitted });
    }
    let grains = |value: u32, per: u128, factor: u128| {
        let grains = (u128::from(value) * factor * counts) << 32;
        grains.checked_div(per).and_then(|grains| i64::try_from(grains).ok()).unwrap_or(i64::MAX >> 2)
    };
    let width = grains(width, 10_000, 1);
    let speed = grains(speed, 1_000_000_000, cycle);
    let rate = grains(accel, 1_000_000_000_000, cycle * cycle);
    if width >= i64::MAX >> 2 {
        return Err(Unfit::Backlash(name));
    }
    if bits.unsigned_abs() >= 1 << 50 {
        return Err(Unfit::Start(name));
    }
    let counter = Counter::new(steps.counts, length, bits);
    let take_up = TakeUp::new(&steps.backlash, &counter.0, [width, speed, rate]);
    Ok(Axis::new(counter, timing, take_up, tick.slots, bits, &steps.motors))
}
