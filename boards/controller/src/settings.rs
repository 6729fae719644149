//! The `$` settings of Grbl: numbers, ranges, defaults, and the machine data that follow from them.
use crate::number::{Fixed, decimal};
use glidepath::machine::{AxisData, MachineData, NO_LIMIT, parameter};

/// Settings of one axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct AxisSettings {
    /// `$10n`: counts per mm, in thousandths.
    pub counts_milli: u32,
    /// `$11n`: highest speed, mm/min, in thousandths.
    pub rate_milli: u32,
    /// `$12n`: acceleration, mm/s², in thousandths.
    pub accel_milli: u32,
    /// `$13n`: travel, mm, in thousandths.
    pub travel_milli: u32,
}

/// All settings, with Grbl's defaults. `$10` is 3, so that reports contain the free room.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Settings<const AXES: usize> {
    /// `$0`: step pulse, µs, 3…255.
    pub pulse_us: u8,
    /// `$1`: time for which motors stay on at standstill, ms; 255: always.
    pub idle_ms: u8,
    /// `$2`: step pins that are active low, bit n for axis n.
    pub step_mask: u8,
    /// `$3`: axes with inverted direction.
    pub direction_mask: u8,
    /// `$4`: the enable pin is active high.
    pub enable_inverted: bool,
    /// `$5`: the limit pins are active high.
    pub limits_inverted: bool,
    /// `$6`: the probe pin is active high.
    pub probe_inverted: bool,
    /// `$10`: bit 0 machine position instead of work position, bit 1 free room.
    pub report_mask: u8,
    /// `$11`: junction deviation, mm, in thousandths.
    pub junction_milli: u32,
    /// `$12`: arc tolerance, mm, in thousandths.
    pub arc_milli: u32,
    /// `$13`: reports in inch.
    pub inch: bool,
    /// `$20`: soft limits.
    pub soft_limits: bool,
    /// `$21`: hard limits.
    pub hard_limits: bool,
    /// `$21=2`: a limit switch stops the steps at once. With 1 the axes brake inside their limits, and the
    /// position stays known.
    pub limits_cut_steps: bool,
    /// `$22`: homing.
    pub homing: bool,
    /// `$23`: axes that home in the negative direction.
    pub homing_mask: u8,
    /// `$24`: speed of the second approach, mm/min, in thousandths.
    pub locate_milli: u32,
    /// `$25`: speed of the first approach, mm/min, in thousandths.
    pub seek_milli: u32,
    /// `$26`: debounce, ms.
    pub debounce_ms: u8,
    /// `$27`: pull-off distance from the switch, mm, in thousandths.
    pub pull_off_milli: u32,
    /// `$30`: highest spindle speed, rpm, in thousandths.
    pub rpm_max_milli: u32,
    /// `$31`: lowest spindle speed, rpm, in thousandths.
    pub rpm_min_milli: u32,
    /// `$32`: laser mode.
    pub laser: bool,
    /// `$10n`…`$13n`.
    pub axes: [AxisSettings; AXES],
}

/// Reason for which a setting is refused: Grbl's error number.
pub type Code = u8;

const BAD_NUMBER: Code = 2;
const UNKNOWN: Code = 3;
const NEGATIVE: Code = 4;
const SHORT_PULSE: Code = 6;
const NEEDS_HOMING: Code = 10;
const TOO_FAST: Code = 12;
const NO_PWM: Code = 17;
/// An error number of grblHAL; Grbl clips such a value instead.
const OUT_OF_RANGE: Code = 52;

/// Numbers of the settings in ascending order, those of axes without the axis digit.
const NUMBERS: [u8; 22] = [0, 1, 2, 3, 4, 5, 6, 10, 11, 12, 13, 20, 21, 22, 23, 24, 25, 26, 27, 30, 31, 32];

/// Kind of a setting's value.
enum Value<'a> {
    Byte(&'a mut u8),
    Flag(&'a mut bool),
    /// Off, on, and a further mode.
    Two(&'a mut bool, &'a mut bool),
    Milli(&'a mut u32),
}

impl Value<'_> {
    const fn raw(&self) -> u32 {
        match self {
            Self::Byte(value) => **value as u32,
            Self::Flag(flag) => **flag as u32,
            Self::Two(first, second) => **first as u32 + (**first && **second) as u32,
            Self::Milli(value) => **value,
        }
    }

    /// `None`: the setting cannot have this value.
    fn put(self, raw: u32) -> Option<()> {
        match self {
            Self::Byte(value) => *value = u8::try_from(raw).ok()?,
            Self::Flag(flag) if raw < 2 => *flag = raw == 1,
            Self::Two(first, second) if raw < 3 => (*first, *second) = (raw > 0, raw == 2),
            Self::Milli(value) => *value = raw,
            Self::Flag(_) | Self::Two(..) => return None,
        }
        Some(())
    }
}

impl<const AXES: usize> Settings<AXES> {
    /// Grbl's defaults.
    pub const fn new() -> Self {
        let axis = AxisSettings {
            counts_milli: 250_000,
            rate_milli: 500_000,
            accel_milli: 10_000,
            travel_milli: 200_000,
        };
        Self {
            pulse_us: 10,
            idle_ms: 25,
            step_mask: 0,
            direction_mask: 0,
            enable_inverted: false,
            limits_inverted: false,
            probe_inverted: false,
            report_mask: 3,
            junction_milli: 10,
            arc_milli: 2,
            inch: false,
            soft_limits: false,
            hard_limits: false,
            limits_cut_steps: false,
            homing: false,
            homing_mask: 0,
            locate_milli: 25_000,
            seek_milli: 500_000,
            debounce_ms: 250,
            pull_off_milli: 1000,
            rpm_max_milli: 1_000_000,
            rpm_min_milli: 0,
            laser: false,
            axes: [axis; AXES],
        }
    }

    /// Returns the field of the setting with this number.
    fn value(&mut self, number: u8) -> Option<Value<'_>> {
        Some(match number {
            0 => Value::Byte(&mut self.pulse_us),
            1 => Value::Byte(&mut self.idle_ms),
            2 => Value::Byte(&mut self.step_mask),
            3 => Value::Byte(&mut self.direction_mask),
            4 => Value::Flag(&mut self.enable_inverted),
            5 => Value::Flag(&mut self.limits_inverted),
            6 => Value::Flag(&mut self.probe_inverted),
            10 => Value::Byte(&mut self.report_mask),
            11 => Value::Milli(&mut self.junction_milli),
            12 => Value::Milli(&mut self.arc_milli),
            13 => Value::Flag(&mut self.inch),
            20 => Value::Flag(&mut self.soft_limits),
            21 => Value::Two(&mut self.hard_limits, &mut self.limits_cut_steps),
            22 => Value::Flag(&mut self.homing),
            23 => Value::Byte(&mut self.homing_mask),
            24 => Value::Milli(&mut self.locate_milli),
            25 => Value::Milli(&mut self.seek_milli),
            26 => Value::Byte(&mut self.debounce_ms),
            27 => Value::Milli(&mut self.pull_off_milli),
            30 => Value::Milli(&mut self.rpm_max_milli),
            31 => Value::Milli(&mut self.rpm_min_milli),
            32 => Value::Flag(&mut self.laser),
            100..=139 => {
                let axis = self.axes.get_mut(usize::from(number % 10))?;
                Value::Milli(match number / 10 {
                    10 => &mut axis.counts_milli,
                    11 => &mut axis.rate_milli,
                    12 => &mut axis.accel_milli,
                    _ => &mut axis.travel_milli,
                })
            }
            _ => return None,
        })
    }

    /// Calls `show` with each setting in ascending order.
    ///
    /// # Errors
    /// The error of `show`.
    pub fn each<E>(&self, mut show: impl FnMut(u8, Fixed) -> Result<(), E>) -> Result<(), E> {
        let mut copy = *self;
        for number in Self::numbers() {
            if let Some(value) = copy.value(number) {
                let places = if matches!(value, Value::Milli(_)) { 3 } else { 0 };
                show(number, Fixed { value: i64::from(value.raw()), places })?;
            }
        }
        Ok(())
    }

    /// Settings that do not belong to an axis.
    pub(crate) const COUNT: usize = NUMBERS.len();

    fn numbers() -> impl Iterator<Item = u8> {
        NUMBERS.into_iter().chain((100..=130_u8).step_by(10).flat_map(|first| (first..).take(AXES)))
    }

    /// Calls `take` with number and stored value of each setting.
    pub(crate) fn each_raw(&self, mut take: impl FnMut(u8, u32) -> Option<()>) -> Option<()> {
        let mut copy = *self;
        Self::numbers().try_for_each(|number| take(number, copy.value(number)?.raw()))
    }

    /// Restores a value of [`Self::each_raw`]. Returns whether the setting exists and can have this value.
    pub(crate) fn put_raw(&mut self, number: u8, value: u32) -> Option<()> {
        self.value(number)?.put(value)
    }

    /// Whether [`Self::set`] can lead to this combination of settings.
    pub(crate) fn is_permitted(&self) -> bool {
        self.pulse_us >= 3
            && (self.homing || !self.soft_limits)
            && (0..AXES).all(|axis| self.check_axis(axis).is_ok())
    }

    /// Changes a setting. `text` is the text after `$`: `110=500.0`. `has_pwm`: the spindle has a variable
    /// speed.
    ///
    /// # Errors
    /// Grbl's error number; no setting is changed.
    pub fn set(&mut self, text: &[u8], has_pwm: bool) -> Result<(), Code> {
        let digits = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let (number, rest) = text.split_at_checked(digits).ok_or(UNKNOWN)?;
        let (number, _) = decimal(number, 0).ok_or(UNKNOWN)?;
        let Some((b'=', rest)) = rest.split_first() else { return Err(UNKNOWN) };
        let (milli, rest) = decimal(rest, 3).ok_or(BAD_NUMBER)?;
        if !rest.is_empty() {
            return Err(UNKNOWN);
        }
        let number = u8::try_from(number).map_err(|_| UNKNOWN)?;
        let mut changed = *self;
        let value = changed.value(number).ok_or(UNKNOWN)?;
        if milli < 0 {
            return Err(NEGATIVE);
        }
        let raw = match &value {
            Value::Byte(_) | Value::Two(..) => milli / 1000,
            Value::Flag(_) => i64::from(milli >= 1000),
            Value::Milli(_) => milli,
        };
        u32::try_from(raw).ok().and_then(|raw| value.put(raw)).ok_or(OUT_OF_RANGE)?;
        match number {
            0 if changed.pulse_us < 3 => return Err(SHORT_PULSE),
            20 if changed.soft_limits && !changed.homing => return Err(NEEDS_HOMING),
            // Soft limits need homing, so both go off together.
            22 if !changed.homing => changed.soft_limits = false,
            32 if changed.laser && !has_pwm => return Err(NO_PWM),
            100..=139 => changed.check_axis(usize::from(number % 10))?,
            _ => {}
        }
        *self = changed;
        Ok(())
    }

    fn check_axis(&self, axis: usize) -> Result<(), Code> {
        let Some(settings) = self.axes.get(axis) else { return Err(UNKNOWN) };
        let mut data = AxisData::new(glidepath::AxisName([0; 4]), glidepath::AxisKind::Linear);
        settings.apply(&mut data, self.soft_limits);
        for known in parameter::AXIS {
            // Only the machine data of the changed setting are checked.
            let is_meant =
                matches!(known.id, "P-AXIS-00212" | "P-AXIS-00209" | "P-AXIS-00008" | "P-AXIS-00177");
            if is_meant && !(known.min_milli..=known.max_milli).contains(&(known.get)(&data)) {
                return Err(OUT_OF_RANGE);
            }
        }
        if settings.counts_milli == 0 {
            return Err(OUT_OF_RANGE);
        }
        // Grbl's error number for a step rate above the highest count of steps per second.
        if u64::from(settings.counts_milli) * u64::from(settings.rate_milli) > 60_000_000 * MOST_STEPS {
            return Err(TOO_FAST);
        }
        Ok(())
    }

    /// Returns machine data with these settings instead of the active ones. Software limits that no setting
    /// has changed keep the values of the machine data.
    #[must_use]
    pub fn onto(&self, data: &MachineData<AXES>, in_force: &Self) -> MachineData<AXES> {
        let mut changed = *data;
        let axes = self.axes.iter().zip(&in_force.axes).zip(changed.axes.iter_mut().zip(&data.axes));
        for ((new, old), (axis, given)) in axes {
            if new.rate_milli != old.rate_milli || new.accel_milli != old.accel_milli {
                new.apply(axis, self.soft_limits);
                (axis.swe_neg, axis.swe_pos) = (given.swe_neg, given.swe_pos);
            }
            if self.soft_limits != in_force.soft_limits
                || self.soft_limits && new.travel_milli != old.travel_milli
            {
                let mut limits = *axis;
                new.apply(&mut limits, self.soft_limits);
                (axis.swe_neg, axis.swe_pos) = (limits.swe_neg, limits.swe_pos);
            }
        }
        changed
    }

    /// Copies speeds, accelerations and travel into machine data. Ramp times do not change.
    pub fn apply(&self, machine: &mut MachineData<AXES>) {
        for (settings, axis) in self.axes.iter().zip(&mut machine.axes) {
            settings.apply(axis, self.soft_limits);
        }
    }
}

impl<const AXES: usize> Default for Settings<AXES> {
    fn default() -> Self {
        Self::new()
    }
}

/// Steps per second above which a setting is refused: one slot of pulse and one slot of gap, 2.5 µs each.
const MOST_STEPS: u64 = 200_000;

impl AxisSettings {
    /// `$11n` sets P-AXIS-00209 and P-AXIS-00212, rounded down to µm/s. `$12n` sets P-AXIS-00001, 00002,
    /// 00004 and 00008, rounded down to mm/s². `$13n` sets P-AXIS-00177 to minus the travel, and P-AXIS-00178
    /// to 0, because Grbl's machine space lies below 0. Without soft limits an axis has neither.
    pub fn apply(&self, axis: &mut AxisData, soft_limits: bool) {
        let speed = self.rate_milli / 60;
        (axis.vb_eilgang, axis.vb_max) = (speed, speed);
        let accel = self.accel_milli / 1000;
        (axis.a_beschl, axis.a_brems, axis.a_grenz, axis.a_max) = (accel, accel, accel, accel);
        (axis.swe_neg, axis.swe_pos) = if soft_limits {
            let tenths = i64::from(self.travel_milli) * 10;
            (-(tenths.min(i64::from(NO_LIMIT)) as i32), 0)
        } else {
            (-NO_LIMIT, NO_LIMIT)
        };
    }
}
