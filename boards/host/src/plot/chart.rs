//! Speed, acceleration and jerk over time, one below the other.
use super::Scene;
use super::canvas::{AXES, Anchor, Canvas, Colour, GRID, INK, LIMIT, Point, Rect, SOFT, Stroke, TextStyle};
use super::font::Font;
use super::scale::{Scale, label, round_up, ticks};

/// Above this number of blocks their borders would be a grey area.
const BORDERS: usize = 120;

struct Panel<'a> {
    title: &'a str,
    unit: &'a str,
    /// Which series of the envelope is the path's, and which are the axes'.
    path: usize,
    axes: Vec<usize>,
    /// What the slope may use of an axis, up and down, then the same with what the contour needs.
    limits: Vec<f64>,
    feed: bool,
    signed: bool,
}

/// Draws the three charts into `area`.
pub fn draw(canvas: &mut dyn Canvas, area: &Rect, scene: &Scene<'_>) {
    let main = &scene.picture.axes;
    let rapid = scene.program.motions().any(|segment| segment.feed.is_none());
    let [mut up, mut down, mut most, mut ramp, mut jerk] = [0.0_f64; 5];
    for &index in main {
        let limits = scene.program.allowed(index, scene.machine);
        let [rapid_accel, rapid_ramp] =
            if rapid { [limits.accel_rapid, limits.ramp_rapid] } else { [0.0; 2] };
        up = up.max(limits.accel_feed).max(rapid_accel);
        down = down.max(limits.brake_feed).max(rapid_accel);
        most = most.max(limits.accel);
        ramp = ramp.max(limits.ramp_feed).max(rapid_ramp);
        jerk = jerk.max(limits.jerk);
    }
    let axes = |offset: usize| (0..main.len()).map(|axis| 3 + 2 * axis + offset).collect();
    let panels = [
        Panel {
            title: "Path speed",
            unit: "/s",
            path: 0,
            axes: Vec::new(),
            limits: Vec::new(),
            feed: true,
            signed: false,
        },
        Panel {
            title: "Acceleration",
            unit: "/s²",
            path: 1,
            axes: axes(0),
            limits: vec![up, -down, most, -most],
            feed: false,
            signed: true,
        },
        Panel {
            title: "Jerk",
            unit: "/s³",
            path: 2,
            axes: axes(1),
            limits: vec![ramp, -ramp, jerk, -jerk],
            feed: false,
            signed: true,
        },
    ];
    let gap = 52.0;
    let height = (area.height - 2.0 * gap - 34.0) / 3.0;
    for (index, panel) in panels.iter().enumerate() {
        let frame = Rect {
            x: area.x + 62.0,
            y: area.y + index as f64 * (height + gap) + 10.0,
            width: area.width - 62.0,
            height,
        };
        one(canvas, &frame, panel, scene, index == panels.len() - 1);
    }
}

fn one(canvas: &mut dyn Canvas, frame: &Rect, panel: &Panel<'_>, scene: &Scene<'_>, last: bool) {
    let cycle = scene.machine.cycle_s();
    let envelope = &scene.picture.envelope;
    let end = ((scene.picture.ticks().max(2) - 1) as f64) * cycle;
    let steps = if panel.feed { feeds(scene, end) } else { Vec::new() };

    let mut reach: f64 = 0.0;
    for series in std::iter::once(panel.path).chain(panel.axes.iter().copied()) {
        reach = envelope.series(series).map(|[low, high]| high.abs().max(low.abs())).fold(reach, f64::max);
    }
    reach = steps.iter().filter(|step| !step.rapid).map(|step| step.value).fold(reach, f64::max);
    // A limit far above must not flatten what was reached.
    let seen = reach * 1.7;
    let limits = panel.limits.iter().map(|value| value.abs());
    let limits = limits.chain(steps.iter().map(|step| step.value));
    reach = limits.filter(|&value| value <= seen).fold(reach, f64::max);
    let top = round_up(reach * 1.06);
    let x = Scale::new(0.0, end, frame.x, frame.right());
    let y = Scale::new(if panel.signed { -top } else { 0.0 }, top, frame.bottom(), frame.y);

    borders(canvas, frame, scene, &x, cycle);
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
    if last {
        let middle = Point(frame.x + frame.width / 2.0, frame.bottom() + 34.0);
        canvas.text(middle, "time  s", &TextStyle { size: 12.0, ..small(Anchor::Middle) });
    }

    canvas.clip(Some(&Rect { y: frame.y - 2.0, height: frame.height + 4.0, ..*frame }));
    for (axis, &series) in panel.axes.iter().enumerate() {
        let colour = AXES[axis % AXES.len()];
        let stroke = Stroke { opacity: 0.75, ..Stroke::new(colour, 1.0) };
        curve(canvas, scene, series, &x, &y, cycle, &stroke);
    }
    curve(canvas, scene, panel.path, &x, &y, cycle, &Stroke::new(INK, 1.5));
    let dashed = Stroke { dash: Some((6.0, 4.0)), ..Stroke::new(LIMIT, 1.1) };
    for &value in panel.limits.iter().filter(|value| value.abs() <= top) {
        let at = y.at(value);
        canvas.polyline(&[Point(frame.x, at), Point(frame.right(), at)], &dashed);
    }
    let mut line: Vec<Point> = Vec::new();
    for step in &steps {
        line.extend([Point(x.at(step.from), y.at(step.value)), Point(x.at(step.to), y.at(step.value))]);
    }
    canvas.polyline(&line, &dashed);
    canvas.clip(None);
    let base = [Point(frame.x, frame.bottom()), Point(frame.right(), frame.bottom())];
    canvas.polyline(&base, &Stroke::new(SOFT, 0.8));

    heading(canvas, frame, panel, scene);
}

/// Title on the left, what the lines are on the right.
fn heading(canvas: &mut dyn Canvas, frame: &Rect, panel: &Panel<'_>, scene: &Scene<'_>) {
    let above = frame.y - 11.0;
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
    let limit = if panel.feed { "programmed" } else { "axis limit: slope, contour" };
    names.push((limit.to_owned(), LIMIT, true));
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
    let ends = entries.iter().skip(1).copied().chain([end]);
    for (index, (&from, to)) in entries.iter().zip(ends).enumerate() {
        if index % 2 == 1 {
            let (left, right) = (x.at(from as f64 * cycle), x.at(to as f64 * cycle));
            let band = Rect { x: left, width: (right - left).max(0.0), ..*frame };
            canvas.fill(&band, Colour(0x2b, 0x7a, 0xb8), 0.055);
        }
    }
}

/// The programmed speed of a block.
struct Feed {
    from: f64,
    to: f64,
    value: f64,
    rapid: bool,
}

/// Programmed speeds over time; rapid motion at what its axes allow.
fn feeds(scene: &Scene<'_>, end: f64) -> Vec<Feed> {
    let cycle = scene.machine.cycle_s();
    let entries = &scene.picture.entries;
    if entries.len() != scene.program.motions {
        return Vec::new();
    }
    let starts = entries.iter().map(|&tick| tick as f64 * cycle);
    let ends = starts.clone().skip(1).chain([end]);
    let speeds = scene.program.speeds(scene.machine).into_iter().zip(scene.program.motions());
    let times = starts.zip(ends);
    times
        .zip(speeds)
        .map(|((from, to), (value, segment))| Feed { from, to, value, rapid: segment.feed.is_none() })
        .collect()
}
