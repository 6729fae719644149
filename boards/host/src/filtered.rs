//! The axes behind their filters: what the drives get, and how far it is from the path.
use crate::machine::Machine;
use glidepath::machine::{AxisKind, FilterType};
use glidepath::quantity::Position;
use serde::Serialize;
use std::fmt::{self, Write};

/// Largest rates of one filtered axis, and its largest deviation.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FilteredAxis {
    name: String,
    unit: &'static str,
    v_max: f64,
    a_max: f64,
    j_max: f64,
    /// From the delayed path, while AX_DEV is given; of the path by which it is delayed.
    #[serde(skip_serializing_if = "Option::is_none")]
    deviation: Option<f64>,
    #[serde(skip)]
    before: [i64; 3],
    /// It was said to be beyond AX_DEV.
    beyond: bool,
}

/// All of them; none on a machine without filters.
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

    /// At rest at the origin.
    pub fn new(machine: &Machine) -> Self {
        let axis = |axis: &glidepath::machine::AxisData| FilteredAxis {
            name: axis.name.as_str().to_owned(),
            unit: if axis.kind == AxisKind::Linear { "mm" } else { "°" },
            ..FilteredAxis::default()
        };
        let axes = if Self::has(machine) { machine.axes.iter().map(axis).collect() } else { Vec::new() };
        Self { axes, cycle_s: machine.cycle_s() }
    }

    /// A tick: what goes to the drives, and the largest deviations up to now.
    pub fn add(&mut self, set_points: &[Position], deviations: &[Position]) {
        for ((axis, point), deviation) in self.axes.iter_mut().zip(set_points).zip(deviations) {
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

    /// An axis was beyond AX_DEV.
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
            let FilteredAxis { name, unit, v_max, a_max, j_max, deviation, beyond, .. } = axis;
            write!(
                out,
                "  {name:<4} filtered: {v_max:.1} {unit}/s, {a_max:.1} {unit}/s², {j_max:.0} {unit}/s³ at most"
            )?;
            if let Some(deviation) = deviation {
                write!(out, ", {deviation:.6} {unit} from the delayed path")?;
            }
            writeln!(out, "{}", if *beyond { ", beyond AX_DEV" } else { "" })?;
        }
        Ok(())
    }
}
