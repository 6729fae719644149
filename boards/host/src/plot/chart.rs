//! Speed, acceleration and jerk over time, one below the other.
use super::Scene;
use super::canvas::{
    AXES, Anchor, Canvas, Colour, FEED, GRID, INK, LIMIT, Point, Rect, SOFT, Stroke, TextStyle,
};
use super::events::Marks;
use super::font::Font;
use super::scale::{Scale, label, round_up, ticks};
use crate::machine::Limits;

/// Above this number of blocks their borders would be a grey area.
const BORDERS: usize = 120;

struct Panel<'a> {
    title: &'a str,
    unit: &'a str,
    /// Which series of the envelope is the path's, and which are the axes'.
    path: usize,
    axes: Vec<usize>,
    /// What the slope may use of an axis, up and down, and the same with what the contour needs.
    limits: Vec<Line>,
    /// Programmed speed and what the axes allow, block by block.
    steps: [Vec<Step>; 2],
    /// What the limits are called.
    legend: String,
    signed: bool,
}

/// A level, in the colour of an axis or, where it is the same for all, in that of limits.
struct Line {
    value: f64,
    colour: Colour,
}

/// A level over a stretch of time; none where there is nothing to show.
#[derive(Clone, Copy, PartialEq)]
struct Step {
    from: f64,
    to: f64,
    value: Option<f64>,
}

/// Draws the three charts into `area`.
pub fn draw(canvas: &mut dyn Canvas, area: &Rect, scene: &Scene<'_>) {
    let end = ((scene.picture.ticks().max(2) - 1) as f64) * scene.machine.cycle_s();
    let (left, width) = (area.x + 62.0, area.width - 62.0);
    let x = Scale::new(0.0, end, left, left + width);
    let marks = Marks::new(scene, &x, left + width);
    let gap = 52.0;
    let height = (area.height - 2.0 * gap - 34.0 - marks.height()) / 3.0;
    let panels = panels(scene, end);
    for (index, panel) in panels.iter().enumerate() {
        let y = area.y + marks.height() + index as f64 * (height + gap) + 10.0;
        let frame = Rect { x: left, y, width, height };
        let labels = if index == 0 { marks.height() } else { 0.0 };
        marks.ground(canvas, &frame);
        one(canvas, &frame, panel, scene, &x, end);
        marks.draw(canvas, &frame, index == 0);
        heading(canvas, &frame, y - 11.0 - labels, panel, scene);
    }
    let middle = Point(left + width / 2.0, area.bottom() + 10.0);
    canvas.text(middle, "time  s", &TextStyle { size: 12.0, anchor: Anchor::Middle, ..TextStyle::new(SOFT) });
}

fn panels<'a>(scene: &Scene<'_>, end: f64) -> [Panel<'a>; 3] {
    let main = &scene.picture.axes;
    let rapid = scene.program.motions().any(|segment| segment.feed.is_none());
    let allowed: Vec<Limits> = main.iter().map(|&axis| scene.program.allowed(axis, scene.machine)).collect();
    let lines = |value: &dyn Fn(&Limits) -> f64| lines(allowed.iter().map(value));
    let or_rapid = |feed: f64, of_rapid: f64| if rapid { feed.max(of_rapid) } else { feed };
    let both = |lines: Vec<Line>| {
        let below = lines.iter().map(|line| Line { value: -line.value, ..*line }).collect::<Vec<_>>();
        lines.into_iter().chain(below).collect::<Vec<_>>()
    };
    let up = lines(&|limits| or_rapid(limits.accel_feed, limits.accel_rapid));
    let down = lines(&|limits| -or_rapid(limits.brake_feed, limits.accel_rapid));
    let most = lines(&|limits| limits.accel);
    let ramp = lines(&|limits| or_rapid(limits.ramp_feed, limits.ramp_rapid));
    let jerk = lines(&|limits| limits.jerk);
    let legend = |slope: &[Line], contour: &[Line]| match (slope, contour) {
        ([slope], [contour]) => format!("axis limit: slope {}, with contour {}", text(slope), text(contour)),
        _ => "limit of the axis: slope, with contour".to_owned(),
    };
    let axes = |offset: usize| (0..main.len()).map(|axis| 3 + 2 * axis + offset).collect();
    let speed = Panel {
        title: "Path speed",
        unit: "/s",
        path: 0,
        axes: Vec::new(),
        limits: Vec::new(),
        steps: steps(scene, end),
        legend: "limit of the axes".into(),
        signed: false,
    };
    let legends = [legend(&up, &most), legend(&ramp, &jerk)];
    let acceleration = up.into_iter().chain(down).chain(both(most)).collect();
    let panel = |title, unit, path, limits, legend| Panel {
        title,
        unit,
        path,
        axes: axes(path - 1),
        limits,
        steps: [Vec::new(), Vec::new()],
        legend,
        signed: true,
    };
    let [of_acceleration, of_jerk] = legends;
    [
        speed,
        panel("Acceleration", "/s²", 1, acceleration, of_acceleration),
        panel("Jerk", "/s³", 2, both(ramp.into_iter().chain(jerk).collect()), of_jerk),
    ]
}

fn text(line: &Line) -> String {
    if line.value.is_finite() { label(line.value) } else { "none".into() }
}

/// One line where all axes are alike, else one per axis.
fn lines(values: impl Iterator<Item = f64>) -> Vec<Line> {
    let values: Vec<f64> = values.collect();
    match values.first() {
        Some(&value) if values.iter().all(|other| *other == value) => vec![Line { value, colour: LIMIT }],
        _ => values.into_iter().zip(AXES).map(|(value, colour)| Line { value, colour }).collect(),
    }
}

fn one(canvas: &mut dyn Canvas, frame: &Rect, panel: &Panel<'_>, scene: &Scene<'_>, x: &Scale, end: f64) {
    let cycle = scene.machine.cycle_s();
    let envelope = &scene.picture.envelope;
    let [programmed, limit] = &panel.steps;

    let mut reach: f64 = 0.0;
    for series in std::iter::once(panel.path).chain(panel.axes.iter().copied()) {
        reach = envelope.series(series).map(|[low, high]| high.abs().max(low.abs())).fold(reach, f64::max);
    }
    reach = programmed.iter().filter_map(|step| step.value).fold(reach, f64::max);
    // A limit far above must not flatten what was reached.
    let seen = reach * 1.7;
    let limits = panel.limits.iter().map(|line| line.value.abs());
    let limits = limits.chain(limit.iter().filter_map(|step| step.value));
    reach = limits.filter(|&value| value <= seen).fold(reach, f64::max);
    let top = round_up(reach * 1.06);
    let y = Scale::new(if panel.signed { -top } else { 0.0 }, top, frame.bottom(), frame.y);

    borders(canvas, frame, scene, x, cycle);
    let small = |anchor| TextStyle { size: 11.0, anchor, ..TextStyle::new(SOFT) };
    for value in ticks(if panel.signed { -top } else { 0.0 }, top, 5) {
        let at = y.at(value);
        let width = if value == 0.0 { 1.2 } else { 0.8 };
        canvas.polyline(&[Point(frame.x, at), Point(frame.right(), at)], &Stroke::new(GRID, width));
        canvas.text(Point(frame.x - 8.0, at + 4.0), &label(value), &small(Anchor::End));
    }
    for value in ticks(0.0, end, 8) {
        let at = x.at(value);
        let mark = [Point(at, frame.bottom()), Point(at, frame.bottom() + 4.0)];
        canvas.polyline(&mark, &Stroke::new(SOFT, 0.8));
        canvas.text(Point(at, frame.bottom() + 17.0), &label(value), &small(Anchor::Middle));
    }

    canvas.clip(Some(&Rect { y: frame.y - 2.0, height: frame.height + 4.0, ..*frame }));
    for line in panel.limits.iter().filter(|line| line.value.abs() <= top) {
        let at = y.at(line.value);
        canvas.polyline(&[Point(frame.x, at), Point(frame.right(), at)], &dashed(line.colour));
    }
    let near = |step: &Step| Step { value: step.value.filter(|&value| value <= top), ..*step };
    let limit: Vec<Step> = limit.iter().map(near).collect();
    staircase(canvas, &limit, x, &y, &dashed(LIMIT));
    staircase(canvas, programmed, x, &y, &Stroke::new(FEED, 1.6));
    for (axis, &series) in panel.axes.iter().enumerate() {
        let colour = AXES[axis % AXES.len()];
        let stroke = Stroke { opacity: 0.75, ..Stroke::new(colour, 1.0) };
        curve(canvas, scene, series, x, &y, cycle, &stroke);
    }
    curve(canvas, scene, panel.path, x, &y, cycle, &Stroke::new(INK, 1.5));
    canvas.clip(None);
    let base = [Point(frame.x, frame.bottom()), Point(frame.right(), frame.bottom())];
    canvas.polyline(&base, &Stroke::new(SOFT, 0.8));
}

fn dashed(colour: Colour) -> Stroke {
    Stroke { opacity: 0.85, dash: Some((6.0, 4.0)), ..Stroke::new(colour, 1.1) }
}

/// Levels as one line, broken where there is none. Of several within half a pixel the lowest one counts.
fn staircase(canvas: &mut dyn Canvas, steps: &[Step], x: &Scale, y: &Scale, stroke: &Stroke) {
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
        let level = y.at(value);
        match line.as_mut_slice() {
            [.., before, last] if last.1 == level => *last = Point(to, before.1),
            [.., before, last] if to - column < FINEST => {
                let lowest = last.1.max(level);
                (before.1, *last) = (lowest, Point(to, lowest));
            }
            _ => {
                line.extend([Point(from, level), Point(to, level)]);
                column = from;
            }
        }
    }
    canvas.polyline(&line, stroke);
}

/// Title on the left, what the lines are on the right, with their base line at `above`.
fn heading(canvas: &mut dyn Canvas, frame: &Rect, above: f64, panel: &Panel<'_>, scene: &Scene<'_>) {
    let title = TextStyle { size: 13.0, bold: true, ..TextStyle::new(INK) };
    canvas.text(Point(frame.x, above), panel.title, &title);
    let unit = Point(frame.x + Font::new(title.size, true).width(panel.title) + 8.0, above);
    canvas.text(
        unit,
        &format!("{}{}", scene.picture.unit, panel.unit),
        &TextStyle { size: 12.0, ..TextStyle::new(SOFT) },
    );

    let mut names: Vec<(String, Colour, bool)> = Vec::new();
    names.push(("path".into(), INK, false));
    for (&index, colour) in scene.picture.axes.iter().zip(AXES) {
        if !panel.axes.is_empty() {
            names.push((scene.machine.axes[index].name.as_str().to_owned(), colour, false));
        }
    }
    if !panel.signed {
        names.push(("programmed".into(), FEED, false));
    }
    names.push((panel.legend.clone(), LIMIT, true));
    let mut right = frame.right();
    for (name, colour, dashed) in names.iter().rev() {
        canvas.text(
            Point(right, above),
            name,
            &TextStyle { size: 11.0, anchor: Anchor::End, ..TextStyle::new(SOFT) },
        );
        right -= Font::new(11.0, false).width(name) + 6.0;
        let dash = dashed.then_some((4.0, 3.0));
        let stroke = Stroke { dash, ..Stroke::new(*colour, 1.8) };
        canvas.polyline(&[Point(right - 18.0, above - 4.0), Point(right, above - 4.0)], &stroke);
        right -= 34.0;
    }
}

/// A line through the lowest and highest values of each stretch, in the order that makes it shortest.
fn curve(
    canvas: &mut dyn Canvas,
    scene: &Scene<'_>,
    series: usize,
    x: &Scale,
    y: &Scale,
    cycle: f64,
    stroke: &Stroke,
) {
    let envelope = &scene.picture.envelope;
    let mut points: Vec<Point> = Vec::with_capacity(2 * envelope.len());
    let mut before = 0.0_f64;
    for (index, [low, high]) in envelope.series(series).enumerate() {
        let at = x.at((index as u64 * envelope.stride()) as f64 * cycle);
        if low == high {
            points.push(Point(at, y.at(low)));
            before = low;
        } else {
            let rising = (before - low).abs() <= (before - high).abs();
            let [first, second] = if rising { [low, high] } else { [high, low] };
            points.extend([Point(at, y.at(first)), Point(at, y.at(second))]);
            before = second;
        }
    }
    canvas.polyline(&points, stroke);
}

/// Where blocks begin.
fn borders(canvas: &mut dyn Canvas, frame: &Rect, scene: &Scene<'_>, x: &Scale, cycle: f64) {
    let entries = &scene.picture.entries;
    if entries.len() > BORDERS {
        return;
    }
    // Every second block has a faint ground.
    let end = scene.picture.ticks() - 1;
    let ends = entries.iter().skip(1).map(|(tick, _)| *tick).chain([end]);
    for (index, (&(from, _), to)) in entries.iter().zip(ends).enumerate() {
        if index % 2 == 1 {
            let (left, right) = (x.at(from as f64 * cycle), x.at(to as f64 * cycle));
            let band = Rect { x: left, width: (right - left).max(0.0), ..*frame };
            canvas.fill(&band, Colour(0x2b, 0x7a, 0xb8), 0.055);
        }
    }
}

/// Programmed speed, none in rapid motion, and what the axes allow, over time.
fn steps(scene: &Scene<'_>, end: f64) -> [Vec<Step>; 2] {
    let cycle = scene.machine.cycle_s();
    let entries = &scene.picture.entries;
    let ends = entries.iter().skip(1).map(|(tick, _)| *tick as f64 * cycle).chain([end]);
    let speeds = scene.program.speeds(scene.machine);
    let mut steps = [Vec::with_capacity(entries.len()), Vec::with_capacity(entries.len())];
    for (&(tick, block), to) in entries.iter().zip(ends) {
        let from = tick as f64 * cycle;
        let speed = speeds.get(block as usize);
        let values = [speed.and_then(|speed| speed.programmed), speed.map(|speed| speed.limit)];
        for (steps, value) in steps.iter_mut().zip(values) {
            steps.push(Step { from, to, value });
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keeps the points of lines.
    #[derive(Default)]
    struct Lines(Vec<Vec<Point>>);

    impl Canvas for Lines {
        fn polyline(&mut self, points: &[Point], _: &Stroke) {
            if !points.is_empty() {
                self.0.push(points.to_vec());
            }
        }
        fn fill(&mut self, _: &Rect, _: Colour, _: f64) {}
        fn dot(&mut self, _: Point, _: f64, _: Colour) {}
        fn text(&mut self, _: Point, _: &str, _: &TextStyle) {}
        fn clip(&mut self, _: Option<&Rect>) {}
    }

    fn drawn(steps: &[(f64, Option<f64>)], end: f64) -> Vec<Vec<Point>> {
        let ends = steps.iter().skip(1).map(|(from, _)| *from).chain([end]);
        let steps: Vec<Step> =
            steps.iter().zip(ends).map(|(&(from, value), to)| Step { from, to, value }).collect();
        let mut lines = Lines::default();
        let scale = Scale::new(0.0, 100.0, 0.0, 100.0);
        staircase(&mut lines, &steps, &scale, &Scale::new(0.0, 9.0, 9.0, 0.0), &Stroke::new(FEED, 1.0));
        lines.0
    }

    #[test]
    fn steps_are_broken_where_nothing_is_programmed() {
        let lines = drawn(&[(0.0, Some(4.0)), (10.0, Some(4.0)), (20.0, None), (30.0, Some(2.0))], 40.0);
        let expected = [[Point(0.0, 5.0), Point(20.0, 5.0)], [Point(30.0, 7.0), Point(40.0, 7.0)]];
        assert_eq!(lines, expected);
    }

    #[test]
    fn steps_finer_than_can_be_seen_keep_their_lowest() {
        let steps: Vec<(f64, Option<f64>)> = (0..10_000)
            .map(|i| (f64::from(i) * 0.01, Some(if i == 5000 { 1.0 } else { 3.0 + f64::from(i % 2) })))
            .collect();
        let lines = drawn(&steps, 100.0);
        assert!(lines[0].len() < 500, "{}", lines[0].len());
        assert!(lines[0].iter().any(|point| point.1 == 8.0 && (point.0 - 50.0).abs() < 0.6));
        assert!(lines[0].iter().all(|point| (5.0..=8.0).contains(&point.1)));
    }
}
