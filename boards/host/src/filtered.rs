//! The axes after their filters: set points of the drives, and their deviation from the path.
use crate::machine::Machine;
use glidepath::machine::{AxisKind, FilterType};
use glidepath::quantity::Position;
use serde::Serialize;
use std::collections::VecDeque;
use std::fmt::{self, Write};

/// Ticks of the longest delay, plus one.
const LONGEST: usize = 202;

/// Highest speed, acceleration and jerk of a filtered axis, and its largest deviation.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FilteredAxis {
    name: String,
    unit: &'static str,
    v_max: f64,
    a_max: f64,
    j_max: f64,
    /// Largest deviation from the delayed path while AX_DEV is active, and the delay of the path.
    #[serde(skip_serializing_if = "Option::is_none")]
    deviation: Option<f64>,
    #[serde(skip)]
    before: [i64; 3],
    /// The path of the last ticks; the newest tick is the last one.
    #[serde(skip)]
    path: VecDeque<i64>,
    /// Deviation from the delayed path in this tick, % of AX_DEV.
    #[serde(skip)]
    off: f64,
    /// AX_DEV, if it was given, and the largest used part, %.
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    used: f64,
    /// The excess above AX_DEV was already reported.
    beyond: bool,
}

/// All filtered axes; none on a machine without filters.
#[derive(Clone, Debug, Default)]
pub struct Filtered {
    axes: Vec<FilteredAxis>,
    cycle_s: f64,
}

const LSB_PER_MM: f64 = (1_u64 << 32) as f64;

impl Filtered {
    /// Whether a machine has filters.
    pub fn has(machine: &Machine) -> bool {
        machine.axes.iter().any(|axis| axis.filter.kind != FilterType::None)
    }

    /// At standstill at the origin.
    pub fn new(machine: &Machine) -> Self {
        let axis = |axis: &glidepath::machine::AxisData| FilteredAxis {
            name: axis.name.as_str().to_owned(),
            unit: if axis.kind == AxisKind::Linear { "mm" } else { "°" },
            ..FilteredAxis::default()
        };
        let axes = if Self::has(machine) { machine.axes.iter().map(axis).collect() } else { Vec::new() };
        Self { axes, cycle_s: machine.cycle_s() }
    }

    /// Records a tick: set points of the path and of the drives, the largest deviations so far, and the
    /// active delay (in half cycles) and AX_DEV.
    pub fn add(
        &mut self,
        (path, drives): (&[Position], &[Position]),
        deviations: &[Position],
        (delay, tolerance): (u32, Position),
    ) {
        let (delay, tolerance) = (delay as usize, tolerance.to_num::<f64>());
        for (((axis, path), point), deviation) in self.axes.iter_mut().zip(path).zip(drives).zip(deviations) {
            axis.path.push_back(path.to_bits());
            if axis.path.len() > LONGEST {
                axis.path.pop_front();
            }
            let newest = axis.path.len() - 1;
            let ago = |ticks: usize| axis.path[newest.saturating_sub(ticks)];
            let twice = 2 * point.to_bits() - ago(delay / 2) - ago(delay.div_ceil(2));
            axis.off = 0.0;
            if tolerance > 0.0 {
                axis.off = 50.0 * twice as f64 / LSB_PER_MM / tolerance;
                axis.tolerance = Some(tolerance);
                axis.used = axis.used.max(axis.off.abs());
            }
            let x = point.to_bits();
            let [x1, x2, x3] = axis.before;
            let differences = [x - x1, x - 2 * x1 + x2, x - 3 * x1 + 3 * x2 - x3];
            let mut scale = LSB_PER_MM;
            for (most, difference) in
                [&mut axis.v_max, &mut axis.a_max, &mut axis.j_max].into_iter().zip(differences)
            {
                scale *= self.cycle_s;
                *most = most.max(difference.unsigned_abs() as f64 / scale);
            }
            axis.before = [x, x1, x2];
            let deviation = deviation.to_num::<f64>();
            if deviation > axis.deviation.unwrap_or(0.0) {
                axis.deviation = Some(deviation);
            }
        }
    }

    /// Deviation of all axes from their delayed path in this tick, % of AX_DEV.
    pub fn off(&self) -> Vec<f64> {
        self.axes.iter().map(|axis| axis.off).collect()
    }

    /// An axis exceeded AX_DEV.
    pub fn beyond(&mut self, axis: usize) {
        if let Some(axis) = self.axes.get_mut(axis) {
            axis.beyond = true;
        }
    }

    /// For the summary.
    pub fn axes(&self) -> Vec<FilteredAxis> {
        self.axes.clone()
    }

    /// A line for each axis.
    pub fn write(axes: &[FilteredAxis], out: &mut String) -> fmt::Result {
        if axes.is_empty() {
            return Ok(());
        }
        writeln!(out)?;
        for axis in axes {
            let FilteredAxis { name, unit, v_max, a_max, j_max, deviation, tolerance, used, beyond, .. } =
                axis;
            write!(
                out,
                "  {name:<4} filtered: {v_max:.1} {unit}/s, {a_max:.1} {unit}/s², {j_max:.0} {unit}/s³ at most"
            )?;
            if let Some(deviation) = deviation {
                write!(out, ", {deviation:.6} {unit} from the delayed path")?;
            }
            if let Some(tolerance) = tolerance {
                write!(out, ", {used:.0} % of AX_DEV {tolerance:.6} {unit}")?;
            }
            writeln!(out, "{}", if *beyond { ", beyond AX_DEV" } else { "" })?;
        }
        Ok(())
    }
}
