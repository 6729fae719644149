//! The reasons for which machine data of the step output are refused.
use glidepath::machine::AxisName;

/// The reason why [`crate::Steps::new`] refuses the data of a machine.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Unfit {
    /// The slots do not fill the cycle exactly.
    Cycle {
        /// P-CHAN `cycle_us` of the machine data.
        cycle_us: u32,
        /// Slot length of the step data.
        slot_ns: u32,
        /// Number of slots in the buffer.
        slots: u32,
    },
    /// The buffer has fewer than 4 or more than 512 slots.
    Slots(u32),
    /// `counts` is not 1…1,000,000,000, or `length` not 1…1,000,000.
    Ratio(AxisName),
    /// No motor.
    NoMotor(AxisName),
    /// The port has no such bit: 0…15.
    NoPin(AxisName, u8),
    /// Two signals on one pin.
    PinTaken(AxisName, u8),
    /// Hold time, set-up time and one pulse with its gap are longer than a tick.
    Times(AxisName),
    /// More steps per tick than its slots can hold.
    TooFast {
        /// Name of the axis.
        axis: AxisName,
        /// P-AXIS-00212 and the speed at which backlash is taken up, µm/s (rotary: 0.001°/s).
        speed: u64,
        /// Speed that the slots permit.
        permitted: u64,
    },
    /// More steps in the tick of a reversal than fit after the change of direction.
    TurnsTooFast {
        /// Name of the axis.
        axis: AxisName,
        /// P-AXIS-00008 and the acceleration with which backlash is taken up, mm/s² (rotary: °/s²).
        accel: u64,
        /// Acceleration that the times permit.
        permitted: u64,
    },
    /// The backlash is wider than 1,000,000 (100 mm), or it has no speed or no acceleration.
    Backlash(AxisName),
    /// The start is so far from 0 that its count has more than 62 bits.
    Start(AxisName),
}

impl core::fmt::Display for Unfit {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Cycle { cycle_us, slot_ns, slots } => write!(
                f,
                "{slots} slots of {slot_ns} ns do not fill the cycle of {cycle_us} µs; expected slot_ns = cycle_us · 1000 / {slots}"
            ),
            Self::Slots(slots) => write!(f, "a buffer of {slots} slots; expected 4 to 512"),
            Self::Ratio(axis) => write!(
                f,
                "axis {}: counts per length out of range; expected counts 1…1000000000, length 1…1000000",
                axis.as_str()
            ),
            Self::NoMotor(axis) => write!(f, "axis {}: no motor; expected one or two", axis.as_str()),
            Self::NoPin(axis, bit) => {
                write!(f, "axis {}: the port has no bit {bit}; expected 0…15", axis.as_str())
            }
            Self::PinTaken(axis, bit) => {
                write!(f, "axis {}: bit {bit} is used already; expected a bit of its own", axis.as_str())
            }
            Self::Times(axis) => write!(
                f,
                "axis {}: pulse, gap, set-up and hold time do not fit into a tick together; expected shorter ones",
                axis.as_str()
            ),
            Self::TooFast { axis, speed, permitted } => write!(
                f,
                "axis {}: {speed} µm/s need more steps per tick than fit; expected at most {permitted} µm/s, shorter slots or fewer counts",
                axis.as_str()
            ),
            Self::TurnsTooFast { axis, accel, permitted } => write!(
                f,
                "axis {}: at {accel} mm/s² more steps follow a reversal in its tick than fit; expected at most {permitted} mm/s², or shorter times",
                axis.as_str()
            ),
            Self::Backlash(axis) => write!(
                f,
                "axis {}: backlash out of range; expected a width of 0…1000000 (0.1 µm), and speed and accel above 0 with it",
                axis.as_str()
            ),
            Self::Start(axis) => write!(f, "axis {}: the start is too far from 0", axis.as_str()),
        }
    }
}

impl core::error::Error for Unfit {}
