//! Events, and functions that need an acknowledgement, over time: a mark through all charts, its label above
//! the first chart, and a background where the motion stands still.
use super::Scene;
use super::canvas::{Anchor, Canvas, EVENT, HELD, Point, Rect, Stroke, TextStyle};
use super::font::Font;
use super::scale::Scale;
use crate::events::function_name;

/// Lines of labels; if these are full, a mark has no label.
const LINES: usize = 4;
const LINE: f64 = 14.0;
const SIZE: f64 = 10.5;

/// An event on the time axis.
struct Mark {
    x: f64,
    /// Line, from below, and left end of the label.
    label: Option<(usize, f64)>,
    text: String,
}

/// The events of a run, laid out over a chart.
pub struct Marks {
    marks: Vec<Mark>,
    lines: usize,
    /// Ranges in which an event or a missing acknowledgement stops the motion.
    holds: Vec<[f64; 2]>,
}

impl Marks {
    /// For charts with this time axis (s), which ends at `right`.
    pub fn new(scene: &Scene<'_>, x: &Scale, right: f64) -> Self {
        let cycle = scene.machine.cycle_s();
        let at = |tick: u64| x.at(tick as f64 * cycle);
        let font = Font::new(SIZE, false);
        // Left ends of the following labels and stems, per line.
        let mut starts = [f64::INFINITY; LINES];
        let mut marks: Vec<Mark> = Vec::new();
        let events = scene.events.iter().zip(&scene.statistics.outcomes);
        let events = events.filter_map(|(event, outcome)| Some((outcome.tick?, event.what.to_string())));
        let functions = scene.statistics.functions.iter().filter(|done| done.output.waits);
        let functions = functions.map(|done| (done.tick, function_name(done.output.function)));
        let mut all: Vec<(u64, String)> = events.chain(functions).collect();
        all.sort_by_key(|(tick, _)| *tick);
        // From the last to the first: a label stands above the following labels, and its stem next to them.
        for (tick, text) in all.into_iter().rev() {
            let x = at(tick);
            let width = font.width(&text);
            let left = if x + 3.0 + width <= right { x + 3.0 } else { x - 3.0 - width };
            let fits = |line: &usize| {
                left + width + 8.0 <= starts[*line] && starts[..*line].iter().all(|&start| x < start)
            };
            let line = (0..LINES).find(fits);
            if let Some(line) = line {
                starts[..line].iter_mut().for_each(|start| *start = start.min(x));
                starts[line] = left;
            }
            marks.push(Mark { x, label: line.map(|line| (line, left)), text });
        }
        let lines = marks.iter().filter_map(|mark| mark.label).map(|(line, _)| line + 1).max().unwrap_or(0);
        let holds = scene.statistics.holds.iter().map(|&[from, to]| [from.saturating_sub(1), to].map(at));
        Self { marks, lines, holds: holds.collect() }
    }

    /// Height of the labels above the first chart.
    pub fn height(&self) -> f64 {
        self.lines as f64 * LINE
    }

    /// Draws the background of a chart.
    pub fn ground(&self, canvas: &mut dyn Canvas, frame: &Rect) {
        for [from, to] in &self.holds {
            canvas.fill(&Rect { x: *from, width: to - from, ..*frame }, HELD, 0.16);
        }
    }

    /// The marks through a chart, and in the `first` one up to their labels.
    pub fn draw(&self, canvas: &mut dyn Canvas, frame: &Rect, first: bool) {
        let stroke = Stroke { opacity: 0.8, dash: Some((2.0, 3.0)), ..Stroke::new(EVENT, 1.0) };
        for mark in &self.marks {
            canvas.polyline(&[Point(mark.x, frame.y), Point(mark.x, frame.bottom())], &stroke);
            let Some((line, left)) = mark.label.filter(|_| first) else { continue };
            let base = frame.y - 5.0 - line as f64 * LINE;
            let stem = [Point(mark.x, base - 8.0), Point(mark.x, frame.y)];
            canvas.polyline(&stem, &Stroke { opacity: 0.8, ..Stroke::new(EVENT, 1.0) });
            let style = TextStyle { size: SIZE, anchor: Anchor::Start, ..TextStyle::new(EVENT) };
            canvas.text(Point(left, base), &mark.text, &style);
        }
    }
}
