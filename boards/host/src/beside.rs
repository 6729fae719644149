//! Axes that move beside the path: how often those that oscillate turn, beside how often they were to.
use crate::machine::Machine;
use glidepath::machine::AxisData;
use glidepath::nc::{Command, OscillationAction, OscillationSpeed, SlopeType};
use glidepath::quantity::Position;
use serde::Serialize;
use std::fmt::{self, Write};

/// A motion of an axis beside the path, as the program has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// The axis.
    pub axis: usize,
    /// Periods per second, if it oscillates with FREQ or TIME.
    wanted: Option<f64>,
    /// Its slope, if that is not the one of the machine.
    pub slope: Option<SlopeType>,
    /// Its accelerations, % of the machine's.
    percent: u32,
}

impl Told {
    /// Of a command.
    pub fn of<const AXES: usize>(command: &Command<AXES>) -> Option<Self> {
        match command {
            Command::Oscillation(_, oscillation) => {
                let OscillationAction::On { speed, .. } = oscillation.action else { return None };
                let wanted = match speed {
                    OscillationSpeed::Feed(_) => None,
                    OscillationSpeed::Frequency(frequency) => Some(frequency.to_num::<f64>()),
                    OscillationSpeed::Period(period) => Some(1.0 / period.to_num::<f64>()),
                };
                Some(Self { axis: oscillation.axis, wanted, slope: None, percent: 100 })
            }
            Command::Independent(_, independent) => {
                let percent = independent.acceleration.map_or(100, |percent| percent.to_num::<u32>().max(1));
                Some(Self { axis: independent.axis, wanted: None, slope: independent.slope, percent })
            }
            _ => None,
        }
    }

    /// The machine data of its axis for it.
    pub fn weigh(&self, axis: &AxisData) -> AxisData {
        let mut data = *axis;
        let weigh = |value: u32| {
            let part = u64::from(value) * u64::from(self.percent) / 100;
            u32::try_from(part).unwrap_or(u32::MAX).max(u32::from(value > 0)).min(axis.a_max)
        };
        for value in [&mut data.a_beschl, &mut data.a_brems, &mut data.a_grenz] {
            *value = weigh(*value);
        }
        let stages = [&mut data.a_stufe, &mut data.d_stufe, &mut data.a_grenz_stufe, &mut data.d_grenz_stufe];
        for values in stages {
            *values = values.map(weigh);
        }
        data
    }
}

/// One motion as it ran: the ticks in which the axis turned.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    first: u64,
    last: u64,
    turns: u64,
}

/// An axis.
#[derive(Clone, Debug, Default)]
struct Axis {
    before: i64,
    /// Of its last motion.
    direction: i64,
    moves: bool,
    seen: Vec<Seen>,
}

/// What an oscillation came to.
#[derive(Clone, Debug, Serialize)]
pub struct Oscillation {
    axis: String,
    hz: f64,
    period_s: f64,
    /// FREQ, or one by TIME.
    #[serde(skip_serializing_if = "Option::is_none")]
    wanted_hz: Option<f64>,
}

/// All axes.
#[derive(Clone, Debug, Default)]
pub struct Beside {
    axes: Vec<Axis>,
}

impl Beside {
    /// At rest at the origin.
    pub fn new(machine: &Machine) -> Self {
        Self { axes: vec![Axis::default(); machine.axes.len()] }
    }

    /// A tick: where the axes are, and which move beside the path, bit i for axis i.
    pub fn add(&mut self, tick: u64, set_points: &[Position], moving: u32) {
        for (k, (axis, point)) in self.axes.iter_mut().zip(set_points).enumerate() {
            let (x, moves) = (point.to_bits(), moving >> k & 1 == 1);
            if moves && !axis.moves {
                axis.seen.push(Seen::default());
                axis.direction = 0;
            }
            let direction = (x - axis.before).signum();
            if let (true, Some(seen)) = (moves && direction != 0, axis.seen.last_mut()) {
                if axis.direction == -direction {
                    seen.first = if seen.turns == 0 { tick } else { seen.first };
                    // Whole periods only.
                    seen.last = if seen.turns % 2 == 0 { tick } else { seen.last };
                    seen.turns += 1;
                }
                axis.direction = direction;
            }
            (axis.before, axis.moves) = (x, moves);
        }
    }

    /// Those that turned for a period at least.
    pub fn oscillations(&self, told: &[Told], machine: &Machine) -> Vec<Oscillation> {
        let mut all = Vec::new();
        for (k, axis) in self.axes.iter().enumerate() {
            let told: Vec<&Told> = told.iter().filter(|told| told.axis == k).collect();
            for (number, seen) in axis.seen.iter().enumerate() {
                let periods = seen.turns.saturating_sub(1) / 2;
                if periods == 0 {
                    continue;
                }
                let period_s = (seen.last - seen.first) as f64 * machine.cycle_s() / periods as f64;
                // Motions that follow each other without rest are seen as one.
                let known = told.len() == axis.seen.len();
                let wanted_hz = if known { told.get(number).and_then(|told| told.wanted) } else { None };
                let axis = machine.axes[k].name.as_str().to_owned();
                all.push(Oscillation { axis, hz: 1.0 / period_s, period_s, wanted_hz });
            }
        }
        all
    }

    /// A line for each.
    pub fn write(oscillations: &[Oscillation], out: &mut String) -> fmt::Result {
        if oscillations.is_empty() {
            return Ok(());
        }
        writeln!(out)?;
        for Oscillation { axis, hz, period_s, wanted_hz } in oscillations {
            write!(out, "  {axis:<4} oscillates with {hz:.4} Hz, {period_s:.4} s a period")?;
            match wanted_hz {
                Some(wanted) => writeln!(out, "; programmed {wanted:.4} Hz")?,
                None => writeln!(out)?,
            }
        }
        Ok(())
    }
}
