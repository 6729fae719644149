//! Keys of `[axis.X.steps]`: the step output of an axis.
use glidepath_steps::{AxisSteps, Motor};

/// A key with its range and what it sets.
pub struct Key {
    /// Name inside `[axis.X]`.
    pub name: &'static str,
    /// Lowest and highest value, an integer.
    pub range: (i64, i64),
    /// Description in words.
    pub unit: &'static str,
    /// Stores a valid value.
    pub set: fn(&mut AxisSteps, i64),
}

/// Default step output of the axis with this index: 80 counts per mm, and the pins 2·index and 2·index + 1.
pub fn preset(index: usize) -> AxisSteps {
    let bit = 2 * index as u8;
    AxisSteps::new(80, 1, Motor::new(bit, bit + 1))
}

/// A pin that the file does not name.
const UNNAMED: Motor = Motor::new(u8::MAX, u8::MAX);

fn motor(axis: &mut AxisSteps, number: usize) -> Option<&mut Motor> {
    axis.motors.get_mut(number).map(|motor| motor.get_or_insert(UNNAMED))
}

fn change(axis: &mut AxisSteps, number: usize, change: impl Fn(&mut Motor)) {
    if let Some(motor) = motor(axis, number) {
        change(motor);
    }
}

const NANOSECONDS: (i64, i64) = (0, 10_000_000);
const BITS: (i64, i64) = (0, 15);
const FLAG: (i64, i64) = (0, 1);

const fn key(name: &'static str, range: (i64, i64), unit: &'static str, set: fn(&mut AxisSteps, i64)) -> Key {
    Key { name, range, unit, set }
}

/// All keys.
pub const KEYS: &[Key] = &[
    key("steps.counts", (1, 1_000_000_000), "counts in steps.length", |axis, value| {
        axis.counts = value as u32;
    }),
    key("steps.length", (1, 1_000_000), "mm (rotary: degrees)", |axis, value| axis.length = value as u32),
    key("steps.pulse_ns", NANOSECONDS, "ns", |axis, value| axis.pulse_ns = value as u32),
    key("steps.gap_ns", NANOSECONDS, "ns", |axis, value| axis.gap_ns = value as u32),
    key("steps.setup_ns", NANOSECONDS, "ns", |axis, value| axis.setup_ns = value as u32),
    key("steps.hold_ns", NANOSECONDS, "ns", |axis, value| axis.hold_ns = value as u32),
    key("steps.step", BITS, "bit of the port", |axis, value| change(axis, 0, |m| m.step.bit = value as u8)),
    key("steps.direction", BITS, "bit of the port", |axis, value| {
        change(axis, 0, |motor| motor.direction.bit = value as u8);
    }),
    key("steps.step_inverted", FLAG, "(1: low is on)", |axis, value| {
        change(axis, 0, |motor| motor.step.is_inverted = value == 1);
    }),
    key("steps.direction_inverted", FLAG, "(1: low is positive)", |axis, value| {
        change(axis, 0, |motor| motor.direction.is_inverted = value == 1);
    }),
    key("steps.step_2", BITS, "bit of the port", |axis, value| change(axis, 1, |m| m.step.bit = value as u8)),
    key("steps.direction_2", BITS, "bit of the port", |axis, value| {
        change(axis, 1, |motor| motor.direction.bit = value as u8);
    }),
    key("steps.step_2_inverted", FLAG, "(1: low is on)", |axis, value| {
        change(axis, 1, |motor| motor.step.is_inverted = value == 1);
    }),
    key("steps.direction_2_inverted", FLAG, "(1: low is positive)", |axis, value| {
        change(axis, 1, |motor| motor.direction.is_inverted = value == 1);
    }),
    key("steps.backlash", (0, 1_000_000), "0.1 µm (rotary: 0.0001°)", |axis, value| {
        axis.backlash.width = value as u32;
    }),
    key("steps.backlash_speed", (1, 10_000_000), "µm/s (0.001°/s)", |axis, value| {
        axis.backlash.speed = value as u32;
    }),
    key("steps.backlash_accel", (1, 1_000_000), "mm/s² (°/s²)", |axis, value| {
        axis.backlash.accel = value as u32;
    }),
    key("steps.backlash_starts_positive", FLAG, "(1: the last motion was positive)", |axis, value| {
        axis.backlash.starts_positive = value == 1;
    }),
];
