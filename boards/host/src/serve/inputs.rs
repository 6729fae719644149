//! Inputs of the simulated machine: limit switches, a probe, and inputs that the user presses.
//!
//! Each axis has a switch at each end, both wired to one input, as on most machines. Switches and the plate
//! of the probe have true positions. Homing changes the coordinates of the axes, but not the true positions.
use super::AXES;
use glidepath::machine::{AxisName, MachineData, NO_LIMIT};
use glidepath::quantity::Position;
use glidepath_controller::Signals;
use glidepath_controller::machine::{Latch, between};

/// Hysteresis: a switch opens 20 µm before the position at which it closed.
const HYSTERESIS: f64 = 0.020;

/// Distance between a software limit and its switch, mm.
const BEYOND: f64 = 1.0;

/// Half the distance between the switches of an axis without software limits, mm.
const HALF_TRAVEL: f64 = 100.0;

/// Number of parts of a tick in which an edge is searched.
const SLOTS: u16 = 50;

/// A switch that closes beyond a true position.
#[derive(Clone, Copy)]
struct Switch {
    at: Position,
    is_above: bool,
    is_closed: bool,
}

impl Switch {
    fn new(at: f64, is_above: bool) -> Self {
        Self { at: Position::saturating_from_num(at), is_above, is_closed: false }
    }

    /// Whether the switch is closed at a true position.
    fn shows(&self, place: Position) -> bool {
        let beyond =
            if self.is_above { place.saturating_sub(self.at) } else { self.at.saturating_sub(place) };
        beyond >= 0 || self.is_closed && beyond > Position::saturating_from_num(-HYSTERESIS)
    }
}

/// All inputs of the machine.
pub struct Inputs {
    names: [AxisName; AXES],
    ends: [[Switch; 2]; AXES],
    /// The probe closes where the third axis reaches this height from above.
    plate: Option<Switch>,
    /// True position minus machine coordinate.
    shift: [Position; AXES],
    /// Inputs that the user holds pressed.
    pressed: Signals,
    /// Inputs at the last tick.
    shown: Signals,
}

impl Inputs {
    /// Inputs of a machine at machine coordinate 0. `plate`: height of the probe's plate, mm.
    pub fn new(machine: &MachineData<AXES>, plate: Option<f64>) -> Self {
        let ends = machine.axes.each_ref().map(|axis| {
            // 0.1 µm
            let limit = |value: i32| f64::from(value) / 10_000.0;
            let has_limits = axis.swe_neg > -NO_LIMIT && axis.swe_pos < NO_LIMIT;
            let (low, high) = match has_limits {
                true => (limit(axis.swe_neg), limit(axis.swe_pos)),
                false => (-HALF_TRAVEL, HALF_TRAVEL),
            };
            [Switch::new(low - BEYOND, false), Switch::new(high + BEYOND, true)]
        });
        Self {
            names: machine.axes.each_ref().map(|axis| axis.name),
            ends,
            plate: plate.map(|at| Switch::new(at, false)),
            shift: [Position::ZERO; AXES],
            pressed: Signals::default(),
            shown: Signals::default(),
        }
    }

    /// The inputs when the axes have these machine coordinates.
    fn at(&self, position: &[Position; AXES]) -> Signals {
        let mut signals = self.pressed;
        let places = position.iter().zip(&self.shift).map(|(at, shift)| at.saturating_add(*shift));
        for ((place, ends), axis) in places.zip(&self.ends).zip(0..) {
            if ends.iter().any(|switch| switch.shows(place)) {
                signals = signals.and(Signals::limit(axis));
            }
            if axis == 2 && self.plate.is_some_and(|plate| plate.shows(place)) {
                signals = signals.and(Signals::PROBE);
            }
        }
        signals
    }

    /// Switches that have closed stay closed within their hysteresis.
    fn keep(&mut self, position: &[Position; AXES]) {
        for ((at, shift), (ends, axis)) in position.iter().zip(&self.shift).zip(self.ends.iter_mut().zip(0..))
        {
            let place = at.saturating_add(*shift);
            let plate = self.plate.iter_mut().filter(|_| axis == 2);
            for switch in ends.iter_mut().chain(plate) {
                switch.is_closed = switch.shows(place);
            }
        }
    }

    /// Handles a tick from one set point to the next. An edge inside the tick is latched at its part of the
    /// tick.
    pub fn tick(&mut self, from: &[Position; AXES], to: &[Position; AXES], latch: &mut Latch<AXES>) {
        let signals = self.at(to);
        if signals != self.shown {
            for slot in 1..SLOTS {
                let position = between(from, to, slot, SLOTS);
                latch.edge(self.at(&position), &position);
            }
        }
        latch.look(signals, to);
        self.shown = signals;
        self.keep(to);
    }

    /// The axes keep their true positions, and have other coordinates.
    pub fn relocate(&mut self, from: &[Position; AXES], to: &[Position; AXES]) {
        for ((shift, from), to) in self.shift.iter_mut().zip(from).zip(to) {
            *shift = shift.saturating_add(from.saturating_sub(*to));
        }
    }

    /// Inputs without a latch: door, hold, reset, start.
    pub const fn others(&self) -> Signals {
        let latched = Signals::PROBE.0 | 0xff;
        Signals(self.pressed.0 & !latched)
    }

    /// Inputs that are on, by name.
    pub fn names_of(&self, signals: Signals) -> Vec<String> {
        let limits = self.names.iter().zip(0..).filter(|(_, axis)| signals.has(Signals::limit(*axis)));
        let limits = limits.map(|(name, _)| name.as_str().to_ascii_lowercase());
        let others =
            BY_HAND.iter().filter(|(_, signal)| signals.has(*signal)).map(|(name, _)| (*name).to_owned());
        limits.chain(others).collect()
    }

    /// Height of the plate, machine coordinates, mm.
    pub fn plate(&self) -> Option<f64> {
        let [.., shift] = self.shift;
        self.plate.map(|plate| plate.at.saturating_sub(shift).to_num())
    }

    /// Carries out `press INPUT`, `release INPUT`, `plate MM` or `plate off`.
    ///
    /// # Errors
    /// The error, and the expected text.
    pub fn command(&mut self, text: &str) -> Result<(), String> {
        let words: Vec<&str> = text.split_whitespace().collect();
        match words.as_slice() {
            ["press", name] => self.pressed = self.pressed.and(self.named(name)?),
            ["release", name] => self.pressed = Signals(self.pressed.0 & !self.named(name)?.0),
            ["plate", "off"] => self.plate = None,
            ["plate", height] => self.plate = Some(self.plate_at(height)?),
            _ => {
                return Err(format!(
                    "`{text}`: expected `press INPUT`, `release INPUT`, `plate MM` or `plate off`"
                ));
            }
        }
        Ok(())
    }

    fn plate_at(&self, height: &str) -> Result<Switch, String> {
        let at: f64 = height.parse().map_err(|_| format!("`{height}`: expected a height in mm, or `off`"))?;
        if !(-1e5..=1e5).contains(&at) {
            return Err(format!("`{height}`: expected a height between -100000 and 100000 mm"));
        }
        let [.., shift] = self.shift;
        Ok(Switch::new(at + shift.to_num::<f64>(), false))
    }

    fn named(&self, name: &str) -> Result<Signals, String> {
        let axis = self.names.iter().position(|axis| axis.as_str().eq_ignore_ascii_case(name));
        let by_hand = BY_HAND.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        let signal = axis.map(|axis| Signals::limit(axis as u8)).or(by_hand.map(|(_, signal)| *signal));
        signal.ok_or_else(|| {
            let axes: Vec<String> =
                self.names.iter().map(|name| name.as_str().to_ascii_lowercase()).collect();
            format!("`{name}`: expected {}, probe, door, hold, reset or start", axes.join(", "))
        })
    }
}

/// Inputs other than the limit switches.
const BY_HAND: [(&str, Signals); 5] = [
    ("probe", Signals::PROBE),
    ("door", Signals::DOOR),
    ("hold", Signals::HOLD),
    ("reset", Signals::RESET),
    ("start", Signals::START),
];
