//! Axes in independent motions: measured frequency of oscillations, compared with the programmed one.
use crate::machine::Machine;
use glidepath::machine::AxisData;
use glidepath::nc::{Command, OscillationAction, OscillationSpeed, SlopeType};
use glidepath::quantity::Position;
use serde::Serialize;
use std::fmt::{self, Write};

/// An independent motion of an axis, as programmed.
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
    /// Reads the motion from a command.
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

    /// The machine data of its axis for this motion.
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

/// An executed motion: its turning points, and the periods without a hold.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    turns: u64,
    /// The tick at which the current period began, and whether the period contains a hold.
    from: u64,
    is_held: bool,
    /// Number of periods, and the ticks of all periods.
    periods: u64,
    ticks: u64,
}

impl Seen {
    /// The axis turns; every second turn begins another period.
    fn turn(&mut self, tick: u64) {
        if self.turns.is_multiple_of(2) {
            if self.turns > 0 && !self.is_held {
                self.periods += 1;
                self.ticks += tick - self.from;
            }
            (self.from, self.is_held) = (tick, false);
        }
        self.turns += 1;
    }
}

/// An axis.
#[derive(Clone, Debug, Default)]
struct Axis {
    before: i64,
    /// Results of its last motion.
    direction: i64,
    moves: bool,
    seen: Vec<Seen>,
}

/// Result of an oscillation.
#[derive(Clone, Debug, Serialize)]
pub struct Oscillation {
    axis: String,
    hz: f64,
    period_s: f64,
    /// Programmed frequency: FREQ, or derived from TIME.
    #[serde(skip_serializing_if = "Option::is_none")]
    wanted_hz: Option<f64>,
}

/// All axes.
#[derive(Clone, Debug, Default)]
pub struct Beside {
    axes: Vec<Axis>,
}

impl Beside {
    /// At standstill at the origin.
    pub fn new(machine: &Machine) -> Self {
        Self { axes: vec![Axis::default(); machine.axes.len()] }
    }

    /// Handles a tick: positions of the axes, axes in an independent motion (bit i for axis i), and whether
    /// they hold.
    pub fn add(&mut self, tick: u64, set_points: &[Position], moving: u32, held: bool) {
        for (k, (axis, point)) in self.axes.iter_mut().zip(set_points).enumerate() {
            let (x, moves) = (point.to_bits(), moving >> k & 1 == 1);
            if moves && !axis.moves {
                axis.seen.push(Seen::default());
                axis.direction = 0;
            }
            let direction = (x - axis.before).signum();
            if let (true, Some(seen)) = (moves, axis.seen.last_mut()) {
                if direction != 0 && axis.direction == -direction {
                    seen.turn(tick);
                }
                seen.is_held |= held;
                axis.direction = if direction == 0 { axis.direction } else { direction };
            }
            (axis.before, axis.moves) = (x, moves);
        }
    }

    /// Oscillations of at least one period, without periods that contain a hold.
    pub fn oscillations(&self, told: &[Told], machine: &Machine) -> Vec<Oscillation> {
        let mut all = Vec::new();
        for (k, axis) in self.axes.iter().enumerate() {
            let told: Vec<&Told> = told.iter().filter(|told| told.axis == k).collect();
            for (number, seen) in axis.seen.iter().enumerate() {
                if seen.periods == 0 {
                    continue;
                }
                let period_s = seen.ticks as f64 * machine.cycle_s() / seen.periods as f64;
                // Motions that follow each other without a standstill are seen as one.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Periods of 40 ticks, and a hold of 1000 in the middle of the third.
    #[test]
    fn a_period_with_a_hold_in_it_does_not_count() {
        let mut beside = Beside { axes: vec![Axis::default()] };
        let mut tick = 0;
        let mut add = |at: i64, held: bool| {
            beside.add(tick, &[Position::from_num(at)], 1, held);
            tick += 1;
        };
        for period in 0..6 {
            for k in 0..40_i64 {
                let at = if k < 20 { k } else { 40 - k };
                add(at, false);
                if (period, k) == (2, 30) {
                    (0..1000).for_each(|_| add(at, true));
                }
            }
        }
        let Seen { periods, ticks, .. } = beside.axes[0].seen[0];
        assert!(periods >= 3, "{periods}");
        assert_eq!(ticks, 40 * periods);
    }
}
