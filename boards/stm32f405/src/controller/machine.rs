//! The machine of this build: edit this file for your machine. Values that `$` settings can change are only
//! defaults.
use glidepath::channel::Channel;
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::quantity::Position;
use glidepath_controller::machine::controller_data;
use glidepath_controller::{AxisSettings, Message, Settings};
use glidepath_steps::{AxisSteps, Motor, StepData, Steps, Unfit};

/// Number of axes.
pub const AXES: usize = 3;

/// Number of blocks in the look-ahead.
pub const BLOCKS: usize = 60;

/// Number of slots in a tick of 1 ms: 5 µs each.
pub const SLOTS: usize = 200;
const SLOT_NS: u32 = 5000;

/// Interpolation cycle, µs. TIM1 and DMA make a cycle of the slots.
pub const CYCLE_US: u32 = 1000;

/// Number of equal samples, one per tick, after which the change of an input counts.
pub const LOOKS: u8 = 3;

/// Whether the control inputs (door, hold, start, reset) are active high, for normally closed contacts.
/// `false`: active low, to ground, with the pull-up of the chip.
pub const CONTROLS_INVERTED: bool = false;

/// Step and direction of X, Y, Z: pins of port C.
const MOTORS: [Motor; AXES] = [Motor::new(0, 1), Motor::new(2, 3), Motor::new(4, 5)];

const fn name(letter: &str) -> AxisName {
    match AxisName::new(letter) {
        Some(name) => name,
        None => panic!("an axis name is one to four letters"),
    }
}

/// Names of the axes.
pub const NAMES: [AxisName; AXES] = [name("X"), name("Y"), name("Z")];

/// The settings that `$RST=$` restores: a small mill with 80 steps per mm.
pub const DEFAULTS: Settings<AXES> = {
    let mut settings = Settings::new();
    settings.pulse_us = 5;
    settings.axes = [AxisSettings {
        counts_milli: 80_000,
        rate_milli: 3_000_000,
        accel_milli: 500_000,
        travel_milli: 300_000,
    }; AXES];
    settings
};

/// Machine data before the settings are known.
pub const BLANK: MachineData<AXES> = MachineData {
    axes: [
        AxisData::new(NAMES[0], AxisKind::Linear),
        AxisData::new(NAMES[1], AxisKind::Linear),
        AxisData::new(NAMES[2], AxisKind::Linear),
    ],
    channel: ChannelData {
        cycle_us: CYCLE_US,
        slope_profile: 1,
        corr_v_trans_jerk: true,
        look_ahead: BLOCKS as u32,
        ..ChannelData::new()
    },
};

/// Machine data of these settings.
pub fn data(settings: &Settings<AXES>) -> MachineData<AXES> {
    let mut data = BLANK;
    for axis in &mut data.axes {
        axis.tr_geom = 10_000;
    }
    settings.apply(&mut data);
    controller_data(&data)
}

/// The step output for these settings, at standstill at `start`.
///
/// # Errors
/// Speeds or pulses that do not fit into a tick.
pub fn steps(
    settings: &Settings<AXES>,
    data: &MachineData<AXES>,
    start: &[Position; AXES],
) -> Result<Steps<AXES, SLOTS>, Unfit> {
    let mut axes = MOTORS.map(|motor| AxisSteps::new(1, 1, motor));
    for ((axis, index), setting) in axes.iter_mut().zip(0..).zip(&settings.axes) {
        (axis.counts, axis.length) = (setting.counts_milli, 1000);
        axis.pulse_ns = u32::from(settings.pulse_us) * 1000;
        for motor in axis.motors.iter_mut().flatten() {
            if settings.step_mask >> index & 1 == 1 {
                motor.step = motor.step.inverted();
            }
            if settings.direction_mask >> index & 1 == 1 {
                *motor = motor.reversed();
            }
        }
    }
    Steps::new(&StepData { slot_ns: SLOT_NS, axes }, data, start)
}

/// Whether both settings have the same step output.
pub fn same_steps(one: &Settings<AXES>, other: &Settings<AXES>) -> bool {
    let counts = |settings: &Settings<AXES>| settings.axes.map(|axis| axis.counts_milli);
    let times = |settings: &Settings<AXES>| (settings.pulse_us, settings.step_mask, settings.direction_mask);
    counts(one) == counts(other) && times(one) == times(other)
}

/// Checks whether the step output supports these settings.
///
/// # Errors
/// The reason in words.
pub fn check(settings: &Settings<AXES>, data: &MachineData<AXES>) -> Result<(), Message> {
    steps(settings, data, &[Position::ZERO; AXES]).map(|_| ()).map_err(|unfit| {
        use core::fmt::Write;
        let mut message = Message::new();
        // The message is cut if the text is too long.
        let _ = write!(message, "{unfit}");
        message
    })
}

/// The defaults are possible, so the first start needs no stored settings.
pub fn fits(settings: &Settings<AXES>) -> bool {
    let data = data(settings);
    Channel::<AXES, BLOCKS, AXES>::check(&data).is_ok() && check(settings, &data).is_ok()
}
