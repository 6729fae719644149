//! Acceleration and jerk of all axes that move, with a transformation their speed too, beside the limit that they have
//! in all: of slope and contour together. Axes with one limit have its unit; axes that differ are shown in percent of their own.
use super::trace::{envelope, legend};
use super::{Canvas, LIMIT, Line, Name, Rect, Row, Scale, Scene, label};
use crate::plot::canvas::axis_colour;
use glidepath::machine::AxisKind;

/// Width of the lines.
const WIDTH: f64 = 1.0;

/// An axis that is shown.
struct Shown {
    /// Index in the machine.
    axis: usize,
    /// Index in the record.
    series: usize,
    /// Factor of a value.
    factor: f64,
    limit: f64,
}

/// A row.
struct Rates<'a> {
    scene: &'a Scene<'a>,
    title: &'static str,
    unit: String,
    axes: Vec<Shown>,
    /// Position of the limit on the scale.
    limit: f64,
    /// Limit of all axes, in their unit; none if the limits differ.
    same: Option<f64>,
}

/// Speed with a transformation, then acceleration and jerk.
pub fn rows<'a>(scene: &'a Scene<'a>) -> Vec<Box<dyn Row + 'a>> {
    let moving = &scene.picture.moving;
    let speeds: Vec<usize> = scene.picture.speed_series().map(|(_, series)| series).collect();
    let row = |title, order: usize, per: &str| -> Box<dyn Row + 'a> {
        let limits = moving.iter().map(|&axis| {
            let allowed = scene.program.allowed_anywhere(axis, scene.machine);
            [allowed.speed.max(allowed.speed_rapid), allowed.accel, allowed.jerk][order]
        });
        let limits: Vec<f64> = limits.collect();
        let kinds: Vec<AxisKind> = moving.iter().map(|&axis| scene.machine.axes[axis].kind).collect();
        let alike = limits.windows(2).all(|pair| pair[0] == pair[1])
            && kinds.windows(2).all(|pair| pair[0] == pair[1]);
        let infinite = limits.iter().any(|limit| !limit.is_finite());
        let linear = kinds.first().is_none_or(|kind| *kind == AxisKind::Linear);
        let unit = if linear { "mm" } else { "°" };
        let percent = !alike && !infinite;
        let axes = moving.iter().zip(&limits).enumerate().map(|(index, (&axis, &limit))| Shown {
            axis,
            series: if order == 0 { speeds[index] } else { 2 * index + order },
            factor: if percent && limit > 0.0 { 100.0 / limit } else { 1.0 },
            limit,
        });
        Box::new(Rates {
            scene,
            title,
            unit: if percent { "% of the limit of each axis".into() } else { format!("{unit}{per}") },
            axes: axes.collect(),
            limit: if percent { 100.0 } else { limits.first().copied().unwrap_or(0.0) },
            same: (!percent).then(|| limits.first().copied().unwrap_or(0.0)),
        })
    };
    let mut rows = Vec::new();
    if !speeds.is_empty() {
        rows.push(row("Axis speed", 0, "/s"));
    }
    rows.extend([row("Acceleration", 1, "/s²"), row("Jerk", 2, "/s³")]);
    rows
}

impl Row for Rates<'_> {
    fn title(&self) -> &str {
        self.title
    }

    fn unit(&self) -> String {
        self.unit.clone()
    }

    fn names(&self) -> Vec<Name> {
        let text = |value: f64| if value.is_finite() { label(value) } else { "none".into() };
        let name = |shown: &Shown| {
            let name = self.scene.machine.axes[shown.axis].name.as_str();
            let name =
                if self.same.is_some() { name.to_owned() } else { format!("{name} {}", text(shown.limit)) };
            (name, axis_colour(shown.axis), false)
        };
        let mut names: Vec<Name> = self.axes.iter().map(name).collect();
        let limit =
            self.same.map_or_else(|| "limit".to_owned(), |limit| format!("limit of an axis {}", text(limit)));
        names.push((limit, LIMIT, true));
        names
    }

    fn reach(&self) -> (f64, bool) {
        let envelope = &self.scene.picture.envelope;
        let peaks = self.axes.iter().map(|shown| envelope.peak(shown.series) * shown.factor);
        (peaks.fold(0.0, f64::max), true)
    }

    fn limits(&self) -> Vec<Line> {
        let line = |value| Line { value, colour: LIMIT };
        vec![line(self.limit), line(-self.limit)]
    }

    fn draw(&self, canvas: &mut dyn Canvas, frame: &Rect, x: &Scale, y: &Scale) {
        let mut faint = false;
        for shown in &self.axes {
            let colour = axis_colour(shown.axis);
            faint |= envelope(canvas, self.scene, shown.series, (x, y), shown.factor, colour, WIDTH);
        }
        if faint {
            legend(canvas, frame);
        }
    }

    fn stroke(&self) -> f64 {
        WIDTH / 2.0
    }
}
