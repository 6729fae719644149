//! Filters and independent axes: deviation of filtered axes from their delayed path, in percent of AX_DEV,
//! and positions of axes in independent motions.
use super::trace::envelope;
use super::{Canvas, LIMIT, Line, Name, Rect, Row, Scale, Scene, label};
use crate::plot::canvas::axis_colour;
use glidepath::machine::AxisKind;

/// Width of the lines.
const WIDTH: f64 = 1.0;

/// A row: title, unit, axes and their series, and a limit.
struct Several<'a> {
    scene: &'a Scene<'a>,
    title: &'static str,
    unit: String,
    /// Axis and number of its series.
    axes: Vec<(usize, usize)>,
    limit: Option<f64>,
}

/// The rows, where there is something to see.
pub fn rows<'a>(scene: &'a Scene<'a>) -> Vec<Box<dyn Row + 'a>> {
    let picture = scene.picture;
    let mut rows: Vec<Box<dyn Row + 'a>> = Vec::new();
    let off: Vec<(usize, usize)> = picture.off_series().collect();
    if off.iter().any(|(_, series)| picture.envelope.peak(*series) > 0.0) {
        let (title, unit) = ("Filtered axes, deviation", "% of AX_DEV".to_owned());
        rows.push(Box::new(Several { scene, title, unit, axes: off, limit: Some(100.0) }));
    }
    let alone: Vec<(usize, usize)> = picture.alone_series().collect();
    if !alone.is_empty() {
        let linear = alone.iter().all(|(axis, _)| scene.machine.axes[*axis].kind == AxisKind::Linear);
        let unit = if linear { "mm" } else { "mm, °" }.to_owned();
        rows.push(Box::new(Several { scene, title: "Axes beside the path", unit, axes: alone, limit: None }));
    }
    rows
}

impl Row for Several<'_> {
    fn title(&self) -> &str {
        self.title
    }

    fn unit(&self) -> String {
        self.unit.clone()
    }

    fn names(&self) -> Vec<Name> {
        let name = |axis: usize| self.scene.machine.axes[axis].name.as_str().to_owned();
        let mut names: Vec<Name> =
            self.axes.iter().map(|(axis, _)| (name(*axis), axis_colour(*axis), false)).collect();
        names.extend(self.limit.map(|limit| (format!("tolerance {}", label(limit)), LIMIT, true)));
        names
    }

    fn reach(&self) -> (f64, bool) {
        let peaks = self.axes.iter().map(|(_, series)| self.scene.picture.envelope.peak(*series));
        (peaks.fold(1e-6, f64::max), true)
    }

    fn limits(&self) -> Vec<Line> {
        let line = |value| Line { value, colour: LIMIT };
        self.limit.map_or_else(Vec::new, |limit| vec![line(limit), line(-limit)])
    }

    fn draw(&self, canvas: &mut dyn Canvas, _: &Rect, x: &Scale, y: &Scale) {
        for (axis, series) in &self.axes {
            envelope(canvas, self.scene, *series, (x, y), 1.0, axis_colour(*axis), WIDTH);
        }
    }

    fn stroke(&self) -> f64 {
        WIDTH / 2.0
    }
}
