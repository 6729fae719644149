//! The largest deviations, as a part of the summary.
use super::{Deviation, Largest, NOTHING};
use crate::machine::Machine;
use glidepath::machine::AxisKind;
use serde::Serialize;
use std::fmt::Write;

/// Values for programs.
#[derive(Serialize)]
pub struct Told {
    /// Number of curves of the path, in all and per motion block.
    elements: u64,
    elements_per_block: f64,
    /// Deviation of the main axes; none if nothing is smoothed.
    #[serde(skip_serializing_if = "Option::is_none")]
    deviation: Option<Off>,
    /// Deviation of every other axis that leaves its programmed path.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    tracking: Vec<Off>,
    /// Axes in independent motions, which are not compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    left_out: Vec<String>,
}

/// A deviation and its place.
#[derive(Serialize)]
struct Off {
    #[serde(skip_serializing_if = "Option::is_none")]
    axis: Option<String>,
    value: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    unit: &'static str,
    n: u32,
}

impl Told {
    /// The result of a run with this number of motion blocks.
    pub fn new(seen: &Deviation, machine: &Machine, blocks: usize) -> Self {
        let off = |axis: Option<usize>, Largest { value, tolerance, n }: Largest| {
            let data = axis.and_then(|axis| machine.axes.get(axis));
            let linear = data.is_none_or(|data| data.kind == AxisKind::Linear);
            Off {
                axis: data.map(|data| data.name.as_str().to_owned()),
                value,
                tolerance,
                unit: if linear { "mm" } else { "°" },
                n,
            }
        };
        let name = |axis: usize| machine.axes.get(axis).map(|data| data.name.as_str().to_owned());
        let tracking = seen.track.iter().enumerate();
        let tracking = tracking.filter_map(|(axis, largest)| Some((Some(axis), (*largest)?)));
        Self {
            elements: seen.curves,
            elements_per_block: if blocks > 0 { seen.curves as f64 / blocks as f64 } else { 0.0 },
            deviation: seen.path.map(|largest| off(None, largest)),
            left_out: seen.beside.iter().filter_map(|&axis| name(axis)).collect(),
            tracking: tracking
                .filter(|(_, largest)| largest.value > NOTHING)
                .map(|(axis, largest)| off(axis, largest))
                .collect(),
        }
    }

    /// Text for people.
    pub fn write(&self, out: &mut String) -> std::fmt::Result {
        writeln!(out, "  elements       {}, {:.2} per motion block", self.elements, self.elements_per_block)?;
        for (index, off) in self.deviation.iter().chain(&self.tracking).enumerate() {
            let Off { axis, value, tolerance, unit, n } = off;
            let head = if index == 0 && axis.is_none() { "deviation" } else { "" };
            let axis = axis.as_ref().map_or_else(|| "path".to_owned(), |axis| axis.clone());
            write!(out, "  {head:<15}{axis} {value:.4} {unit}")?;
            if let Some(tolerance) = tolerance {
                write!(out, " of {tolerance} {unit} permitted, {:.1} %,", value / tolerance * 100.0)?;
            }
            write!(out, " at N{n}")?;
            if index == 0 && !self.left_out.is_empty() {
                write!(out, ", without {}: beside the path", self.left_out.join(", "))?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}
