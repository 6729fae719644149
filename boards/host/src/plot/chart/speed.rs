//! Path speed, programmed speed, and the speed that the axes permit in the direction of the path.
use super::trace::{envelope, legend};
use super::{Canvas, Line, Name, Rect, Row, Scale, Scene, dashed};
use crate::plot::canvas::{FEED, INK, LIMIT, Point, Stroke};

/// Width of the path's line, and of that of the feed.
const WIDTH: f64 = 1.5;
const FEED_WIDTH: f64 = 1.6;

/// A value over an interval of time; none if there is nothing to show.
#[derive(Clone, Copy, PartialEq)]
struct Step {
    from: f64,
    to: f64,
    value: Option<f64>,
}

/// The row.
pub struct PathSpeed<'a> {
    scene: &'a Scene<'a>,
    programmed: Vec<Step>,
    limit: Vec<Step>,
}

impl<'a> PathSpeed<'a> {
    /// Makes the row of a run.
    pub fn new(scene: &'a Scene<'a>) -> Self {
        let end = ((scene.picture.ticks().max(2) - 1) as f64) * scene.machine.cycle_s();
        let [programmed, limit] = steps(scene, end);
        Self { scene, programmed, limit }
    }
}

impl Row for PathSpeed<'_> {
    fn title(&self) -> &str {
        "Path speed"
    }

    fn unit(&self) -> String {
        format!("{}/s", self.scene.picture.unit)
    }

    fn names(&self) -> Vec<Name> {
        vec![
            ("path".into(), INK, false),
            ("programmed".into(), FEED, false),
            ("limit of the axes".into(), LIMIT, true),
        ]
    }

    fn reach(&self) -> (f64, bool) {
        let seen = self.scene.picture.envelope.peak(0);
        let programmed = self.programmed.iter().filter_map(|step| step.value).fold(seen, f64::max);
        let near = self.limit.iter().filter_map(|step| step.value).filter(|value| *value <= 1.7 * programmed);
        (near.fold(programmed, f64::max), false)
    }

    fn limits(&self) -> Vec<Line> {
        Vec::new()
    }

    fn draw(&self, canvas: &mut dyn Canvas, frame: &Rect, x: &Scale, y: &Scale) {
        let inside =
            |step: &Step| Step { value: step.value.filter(|value| y.at(*value) >= frame.y), ..*step };
        let limit: Vec<Step> = self.limit.iter().map(inside).collect();
        let out = WIDTH / 2.0;
        staircase(canvas, &limit, x, y, out + super::LIMIT_WIDTH / 2.0, &dashed(LIMIT));
        staircase(canvas, &self.programmed, x, y, out + FEED_WIDTH / 2.0, &Stroke::new(FEED, FEED_WIDTH));
        if envelope(canvas, self.scene, 0, (x, y), 1.0, INK, WIDTH) {
            legend(canvas, frame);
        }
    }

    fn stroke(&self) -> f64 {
        WIDTH / 2.0
    }
}

/// Values as one line, broken where there is no value. Of several values within half a pixel the highest
/// counts, because a speed below each value is also below this line.
fn staircase(canvas: &mut dyn Canvas, steps: &[Step], x: &Scale, y: &Scale, out: f64, stroke: &Stroke) {
    const FINEST: f64 = 0.5;
    let mut line: Vec<Point> = Vec::new();
    let mut column = f64::NEG_INFINITY;
    for step in steps {
        let [from, to] = [step.from, step.to].map(|at| x.at(at));
        let Some(value) = step.value else {
            canvas.polyline(&line, stroke);
            line.clear();
            column = f64::NEG_INFINITY;
            continue;
        };
        // Outside the stroke of the limited value.
        let level = y.at(value) - out;
        match line.as_mut_slice() {
            [.., before, last] if last.1 == level => *last = Point(to, before.1),
            [.., before, last] if to - column < FINEST => {
                let highest = last.1.min(level);
                (before.1, *last) = (highest, Point(to, highest));
            }
            _ => {
                line.extend([Point(from, level), Point(to, level)]);
                column = from;
            }
        }
    }
    canvas.polyline(&line, stroke);
}

/// Programmed speed (none in rapid motion) and the speed that the axes permit, over time. A smoothed path may
/// already have the direction of the next block, or still that of the previous block.
fn steps(scene: &Scene<'_>, end: f64) -> [Vec<Step>; 2] {
    let cycle = scene.machine.cycle_s();
    let entries = &scene.picture.entries;
    let ends = entries.iter().skip(1).map(|(tick, _)| *tick as f64 * cycle).chain([end]);
    let speeds = scene.program.speeds(scene.machine);
    let smoothed: Vec<bool> = scene.program.motions().map(|motion| motion.smoothed).collect();
    let mut steps = [Vec::with_capacity(entries.len()), Vec::with_capacity(entries.len())];
    for (&(tick, block), to) in entries.iter().zip(ends) {
        let (from, block) = (tick as f64 * cycle, block as usize);
        let near = if smoothed.get(block) == Some(&true) { 1 } else { 0 };
        let around =
            speeds.get(block.saturating_sub(near)..speeds.len().min(block + near + 1)).unwrap_or(&[]);
        let programmed = speeds.get(block).and_then(|speed| speed.programmed);
        let limit = around.iter().map(|speed| speed.limit).reduce(f64::max);
        for (steps, value) in steps.iter_mut().zip([programmed, limit]) {
            steps.push(Step { from, to, value });
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::canvas::{Colour, TextStyle};

    /// Keeps the points of lines.
    #[derive(Default)]
    struct Lines(Vec<Vec<Point>>);

    impl Canvas for Lines {
        fn polylines(&mut self, lines: &[Vec<Point>], _: &Stroke) {
            self.0.extend(lines.iter().filter(|points| !points.is_empty()).cloned());
        }
        fn polygon(&mut self, _: &[Point], _: Colour, _: f64) {}
        fn fill(&mut self, _: &Rect, _: Colour, _: f64) {}
        fn dot(&mut self, _: Point, _: f64, _: Colour) {}
        fn ring(&mut self, _: Point, _: f64, _: Colour) {}
        fn text(&mut self, _: Point, _: &str, _: &TextStyle) {}
        fn clip(&mut self, _: Option<&Rect>) {}
    }

    fn drawn(steps: &[(f64, Option<f64>)], end: f64) -> Vec<Vec<Point>> {
        let ends = steps.iter().skip(1).map(|(from, _)| *from).chain([end]);
        let steps: Vec<Step> =
            steps.iter().zip(ends).map(|(&(from, value), to)| Step { from, to, value }).collect();
        let mut lines = Lines::default();
        let scale = Scale::new(0.0, 100.0, 0.0, 100.0);
        staircase(&mut lines, &steps, &scale, &Scale::new(0.0, 9.0, 9.0, 0.0), 0.0, &Stroke::new(FEED, 1.0));
        lines.0
    }

    #[test]
    fn steps_are_broken_where_nothing_is_programmed() {
        let lines = drawn(&[(0.0, Some(4.0)), (10.0, Some(4.0)), (20.0, None), (30.0, Some(2.0))], 40.0);
        let expected = [[Point(0.0, 5.0), Point(20.0, 5.0)], [Point(30.0, 7.0), Point(40.0, 7.0)]];
        assert_eq!(lines, expected);
    }

    #[test]
    fn steps_finer_than_can_be_seen_keep_their_highest() {
        let steps: Vec<(f64, Option<f64>)> = (0..10_000)
            .map(|i| (f64::from(i) * 0.01, Some(if i == 5000 { 8.0 } else { 3.0 + f64::from(i % 2) })))
            .collect();
        let lines = drawn(&steps, 100.0);
        assert!(lines[0].len() < 500, "{}", lines[0].len());
        assert!(lines[0].iter().any(|point| point.1 == 1.0 && (point.0 - 50.0).abs() < 0.6));
        assert!(lines[0].iter().all(|point| (1.0..=6.0).contains(&point.1)));
    }
}
