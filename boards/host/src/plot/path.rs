//! The path: programmed thin and grey, moved coloured by speed, with equal scales.
use super::Scene;
use super::canvas::{Anchor, Canvas, Colour, GRID, INK, PROGRAMMED, Point, Rect, SOFT, Stroke, TextStyle};
use super::font::Font;
use super::scale::{label, round_up, ticks};

/// Shades of the speed scale.
const SHADES: usize = 32;

/// Points nearer to one another than that are one, and so many of a line are drawn at most.
const FINEST: f64 = 0.5;
const MOST: usize = 12_000;

/// Radius of the dots at start and end, and of the end's dot where it lies under that of the start.
const DOT: f64 = 5.0;
const RING: f64 = 8.5;

/// How three coordinates become two.
#[derive(Clone, Copy, PartialEq)]
enum View {
    /// First to the right, second up.
    Plan,
    /// All three, seen from the front left and above.
    Isometric,
}

impl View {
    fn project(self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        const COS_30: f64 = 0.866_025_403_784_438_6;
        match self {
            Self::Plan => [x, y],
            Self::Isometric => [(x - y) * COS_30, (x + y) * 0.5 + z],
        }
    }
}

/// Draws the path into `area`.
pub fn draw(canvas: &mut dyn Canvas, area: &Rect, scene: &Scene<'_>) {
    let moved: Vec<([f64; 3], f64)> = scene.picture.path().map(|place| (place.at, place.speed)).collect();
    let programmed = scene.program.polyline(&scene.picture.axes);
    let top_speed = round_up(moved.iter().map(|(_, speed)| *speed).fold(0.0, f64::max));
    let deep = {
        let heights = moved.iter().map(|(at, _)| at[2]);
        let (low, high) = heights.fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(z), high.max(z)));
        high - low > 1e-6
    };
    let legend = 44.0;
    let frames = if deep {
        let plan = (area.height - legend) * 0.56;
        let below = Rect { y: area.y + plan + 30.0, height: area.height - legend - plan - 30.0, ..*area };
        vec![(View::Plan, Rect { height: plan, ..*area }), (View::Isometric, below)]
    } else {
        vec![(View::Plan, Rect { height: area.height - legend, ..*area })]
    };
    for (view, frame) in &frames {
        one(canvas, frame, *view, scene, &programmed, &moved, top_speed);
    }
    speed_scale(canvas, area, top_speed, scene.picture.unit);
}

fn one(
    canvas: &mut dyn Canvas,
    frame: &Rect,
    view: View,
    scene: &Scene<'_>,
    programmed: &[[f64; 3]],
    moved: &[([f64; 3], f64)],
    top_speed: f64,
) {
    let title = TextStyle { size: 13.0, bold: true, ..TextStyle::new(INK) };
    let names: Vec<&str> =
        scene.picture.axes.iter().map(|&index| scene.machine.axes[index].name.as_str()).collect();
    let mm = scene.picture.unit;
    let (heading, unit) = match view {
        View::Plan => ("Path".to_owned(), format!("{}  {mm}", names.get(..2).unwrap_or(&names).join(" "))),
        View::Isometric => ("Path in space".to_owned(), mm.to_owned()),
    };
    canvas.text(Point(frame.x, frame.y), &heading, &title);
    let beside = Point(frame.x + Font::new(title.size, true).width(&heading) + 8.0, frame.y);
    canvas.text(beside, &unit, &TextStyle { size: 12.0, ..TextStyle::new(SOFT) });
    let inner = match view {
        View::Plan => Rect {
            x: frame.x + 46.0,
            y: frame.y + 12.0,
            width: frame.width - 46.0,
            height: frame.height - 36.0,
        },
        View::Isometric => Rect { y: frame.y + 12.0, height: frame.height - 16.0, ..*frame },
    };

    let all = programmed.iter().copied().chain(moved.iter().map(|(at, _)| *at));
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for at in all {
        for (i, value) in view.project(at).into_iter().enumerate() {
            low[i] = low[i].min(value);
            high[i] = high[i].max(value);
        }
    }
    let span = [high[0] - low[0], high[1] - low[1]];
    if span[0].max(span[1]) <= 0.0 {
        let middle = Point(inner.x + inner.width / 2.0, inner.y + inner.height / 2.0);
        let style = TextStyle { anchor: Anchor::Middle, ..TextStyle::new(SOFT) };
        canvas.text(middle, "nothing moves here", &style);
        return;
    }
    let room = span[0].max(span[1]) * 0.06;
    // Equal scales: the tighter direction decides, the other one is centred.
    let scale = (inner.width / (span[0] + 2.0 * room)).min(inner.height / (span[1] + 2.0 * room));
    let centre = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0];
    let place = |at: [f64; 3]| {
        let [u, v] = view.project(at);
        Point(
            inner.x + inner.width / 2.0 + (u - centre[0]) * scale,
            inner.y + inner.height / 2.0 - (v - centre[1]) * scale,
        )
    };

    match view {
        View::Plan => grid(canvas, &inner, scale, centre),
        View::Isometric => tripod(canvas, &inner, &names),
    }
    canvas.clip(Some(&inner));
    let whole: Vec<Point> = programmed.iter().map(|&at| place(at)).collect();
    canvas.polyline(&thinned(&whole), &Stroke::new(PROGRAMMED, 1.0));
    let mut shades = vec![Vec::new(); SHADES];
    // One line for each stretch of one shade.
    let mut points: Vec<Point> = Vec::new();
    let mut current = None;
    for &(at, speed) in moved {
        let shade = ((speed / top_speed * SHADES as f64) as usize).min(SHADES - 1);
        let point = place(at);
        if points.last().is_some_and(|&last| !apart(last, point, FINEST)) && points.len() > 1 {
            continue;
        }
        points.push(point);
        if current != Some(shade) {
            if let Some(shade) = current {
                let next = points.split_off(points.len() - 1);
                points.extend(next.first());
                shades[shade].push(std::mem::replace(&mut points, next));
            }
            current = Some(shade);
        }
    }
    points.extend(moved.last().map(|&(at, _)| place(at)));
    if let Some(shade) = current {
        shades[shade].push(points);
    }
    // Slow stretches last: they are what is looked for.
    for (shade, lines) in shades.iter().enumerate().rev() {
        canvas.polylines(lines, &Stroke::new(colour(shade), 2.4));
    }
    if let (Some((first, _)), Some((last, _))) = (moved.first(), moved.last()) {
        // Where both are one place, the end is seen around the start.
        let (first, last) = (place(*first), place(*last));
        let near = (first.0 - last.0).hypot(first.1 - last.1) < DOT;
        canvas.dot(last, if near { RING } else { DOT }, INK);
        canvas.dot(first, DOT, Colour(0x3a, 0x9d, 0x5d));
    }
    canvas.clip(None);
}

/// Whether two points are further from one another than that.
fn apart(a: Point, b: Point, distance: f64) -> bool {
    (a.0 - b.0).hypot(a.1 - b.1) > distance
}

/// Points that can be told apart, and no more than a picture needs.
fn thinned(points: &[Point]) -> Vec<Point> {
    let mut finest = FINEST;
    loop {
        let mut kept: Vec<Point> = Vec::new();
        for (index, &point) in points.iter().enumerate() {
            if index + 1 == points.len() || kept.last().is_none_or(|&last| apart(last, point, finest)) {
                kept.push(point);
            }
        }
        if kept.len() <= MOST {
            return kept;
        }
        finest *= 1.5;
    }
}

fn grid(canvas: &mut dyn Canvas, inner: &Rect, scale: f64, centre: [f64; 2]) {
    let half = [inner.width / 2.0 / scale, inner.height / 2.0 / scale];
    let small = |anchor| TextStyle { size: 11.0, anchor, ..TextStyle::new(SOFT) };
    let count = |length: f64| (length / 80.0).max(2.0) as usize;
    for value in ticks(centre[0] - half[0], centre[0] + half[0], count(inner.width)) {
        let x = inner.x + inner.width / 2.0 + (value - centre[0]) * scale;
        canvas.polyline(&[Point(x, inner.y), Point(x, inner.bottom())], &Stroke::new(GRID, 0.8));
        canvas.text(Point(x, inner.bottom() + 15.0), &label(value), &small(Anchor::Middle));
    }
    for value in ticks(centre[1] - half[1], centre[1] + half[1], count(inner.width)) {
        let y = inner.y + inner.height / 2.0 - (value - centre[1]) * scale;
        canvas.polyline(&[Point(inner.x, y), Point(inner.right(), y)], &Stroke::new(GRID, 0.8));
        canvas.text(Point(inner.x - 7.0, y + 4.0), &label(value), &small(Anchor::End));
    }
}

/// Three small arrows that say where the axes point.
fn tripod(canvas: &mut dyn Canvas, inner: &Rect, names: &[&str]) {
    let origin = Point(inner.x + 40.0, inner.bottom() - 26.0);
    for (name, direction) in names.iter().zip([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) {
        let [u, v] = View::Isometric.project(direction);
        let tip = Point(origin.0 + 26.0 * u, origin.1 - 26.0 * v);
        canvas.polyline(&[origin, tip], &Stroke::new(SOFT, 1.2));
        let style = TextStyle { size: 11.0, anchor: Anchor::Middle, ..TextStyle::new(SOFT) };
        canvas.text(Point(origin.0 + 36.0 * u, origin.1 - 36.0 * v + 4.0), name, &style);
    }
}

fn speed_scale(canvas: &mut dyn Canvas, area: &Rect, top_speed: f64, unit: &str) {
    let bar = Rect { x: area.x + 46.0, y: area.bottom() - 22.0, width: 220.0, height: 8.0 };
    let step = bar.width / SHADES as f64;
    for shade in 0..SHADES {
        let part = Rect { x: bar.x + shade as f64 * step, width: step + 0.4, ..bar };
        canvas.fill(&part, colour(shade), 1.0);
    }
    let small = |anchor| TextStyle { size: 11.0, anchor, ..TextStyle::new(SOFT) };
    canvas.text(Point(bar.x, bar.bottom() + 14.0), "0", &small(Anchor::Middle));
    let end = format!("{} {unit}/s", label(top_speed));
    canvas.text(Point(bar.right(), bar.bottom() + 14.0), &end, &small(Anchor::Middle));
    let right = bar.right() + 70.0;
    let line = [Point(right, bar.y + 4.0), Point(right + 22.0, bar.y + 4.0)];
    canvas.polyline(&line, &Stroke::new(PROGRAMMED, 1.2));
    canvas.text(Point(right + 28.0, bar.y + 8.0), "programmed", &small(Anchor::Start));
    for (shift, name, colour) in [(120.0, "start", Colour(0x3a, 0x9d, 0x5d)), (180.0, "end", INK)] {
        canvas.dot(Point(right + shift, bar.y + 4.0), 5.0, colour);
        canvas.text(Point(right + shift + 10.0, bar.y + 8.0), name, &small(Anchor::Start));
    }
}

/// Slow is dark blue, fast is orange; between them the hues that print and colour-blind readers tell apart.
fn colour(shade: usize) -> Colour {
    const STOPS: [[f64; 3]; 6] = [
        [26.0, 24.0, 110.0],
        [92.0, 18.0, 146.0],
        [160.0, 32.0, 140.0],
        [212.0, 70.0, 106.0],
        [240.0, 118.0, 66.0],
        [250.0, 172.0, 44.0],
    ];
    let at = shade as f64 / (SHADES - 1) as f64 * (STOPS.len() - 1) as f64;
    let index = (at as usize).min(STOPS.len() - 2);
    let share = at - index as f64;
    let mix = |i: usize| (STOPS[index][i] * (1.0 - share) + STOPS[index + 1][i] * share).round() as u8;
    Colour(mix(0), mix(1), mix(2))
}
