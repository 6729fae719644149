//! The path: programmed path thin and grey, driven path coloured by speed, with equal scales.
use super::canvas::{Anchor, Canvas, Colour, GRID, INK, PROGRAMMED, Point, Rect, SOFT, Stroke, TextStyle};
use super::font::Font;
use super::record::Place;
use super::scale::{label, round_up, ticks};
use super::{Plane, Scene};
use crate::program::Stretch;

/// Shades of the speed scale.
const SHADES: usize = 32;

/// Points nearer than this distance are one point; a line has at most this number of points.
const FINEST: f64 = 0.5;
const MOST: usize = 12_000;

/// Radius of the rings around start and end, and of the end's ring if both rings have the same centre.
const DOT: f64 = 4.0;
const RING: f64 = 7.0;
const START: Colour = Colour(0x3a, 0x9d, 0x5d);

/// Width of the path: depends on the space between neighbouring lines, between these bounds.
const WIDTHS: [f64; 2] = [0.5, 2.2];

/// Rapid motion.
const RAPID: Stroke = Stroke { opacity: 0.9, dash: Some((4.0, 3.0)), ..Stroke::new(SOFT, 0.9) };

/// The direction of the tool: strokes from the tip. Length and distance are parts of the picture's larger extent.
const TOOL: Stroke = Stroke { opacity: 0.75, ..Stroke::new(Colour(0x4f, 0x7a, 0x8c), 0.8) };
const TOOL_LENGTH: f64 = 0.07;
const TOOL_APART: f64 = 0.02;

/// How three coordinates become two.
#[derive(Clone, Copy, PartialEq)]
enum View {
    /// One coordinate to the right, one up.
    Plan(usize, usize),
    /// All three coordinates, seen from the front left and above.
    Isometric,
}

impl View {
    fn project(self, at: [f64; 3]) -> [f64; 2] {
        const COS_30: f64 = 0.866_025_403_784_438_6;
        match self {
            Self::Plan(right, up) => [at[right], at[up]],
            Self::Isometric => [(at[0] - at[1]) * COS_30, (at[0] + at[1]) * 0.5 + at[2]],
        }
    }

    /// The requested planes, else the planes with visible motion: the first two axes, or others if one of
    /// these hardly moves.
    fn all(extent: [f64; 3], asked: &[Plane]) -> Vec<Self> {
        if !asked.is_empty() {
            let view = |plane: &Plane| match plane {
                Plane::Xy => Self::Plan(0, 1),
                Plane::Xz => Self::Plan(0, 2),
                Plane::Yz => Self::Plan(1, 2),
                Plane::Space => Self::Isometric,
            };
            return asked.iter().map(view).collect();
        }
        // Part of the largest extent; a smaller extent is seen as a line.
        const HARDLY: f64 = 0.01;
        let most = extent.into_iter().fold(0.0, f64::max);
        let deep = extent.iter().all(|&extent| extent > 1e-6);
        let plan = match extent.map(|extent| extent > HARDLY * most) {
            [true, false, true] => Self::Plan(0, 2),
            [false, true, true] => Self::Plan(1, 2),
            [false, false, true] => Self::Plan(0, 2),
            _ => Self::Plan(0, 1),
        };
        if deep { vec![plan, Self::Isometric] } else { vec![plan] }
    }
}

/// Content of the picture.
struct Shown<'a> {
    scene: &'a Scene<'a>,
    programmed: Vec<Stretch>,
    moved: Vec<Place>,
    top_speed: f64,
}

impl Shown<'_> {
    /// All points, programmed and driven.
    fn all(&self) -> impl Iterator<Item = [f64; 3]> {
        let programmed = self.programmed.iter().flat_map(|stretch| stretch.line.iter().copied());
        programmed.chain(self.moved.iter().map(|place| place.at))
    }

    fn has_tool(&self) -> bool {
        self.moved.iter().any(|place| place.tool.is_some())
    }

    fn has_rapid(&self) -> bool {
        self.moved.iter().any(|place| place.rapid)
    }
}

/// Draws the path into `area`.
pub fn draw(canvas: &mut dyn Canvas, area: &Rect, scene: &Scene<'_>) {
    let moved: Vec<Place> = scene.picture.path().collect();
    let programmed = scene.program.polylines(&scene.picture.axes);
    // With rapid motion in the scale, all motion at feed would have one colour.
    let top =
        |rapid| moved.iter().filter(|place| place.rapid == rapid).map(|place| place.speed).reduce(f64::max);
    let top_speed = round_up(top(false).filter(|speed| *speed > 0.0).or(top(true)).unwrap_or(0.0));
    let shown = Shown { scene, programmed, moved, top_speed };
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for at in shown.all() {
        low = std::array::from_fn(|k| low[k].min(at[k]));
        high = std::array::from_fn(|k| high[k].max(at[k]));
    }
    let views = View::all(std::array::from_fn(|k| (high[k] - low[k]).max(0.0)), scene.planes);
    let legend = 44.0;
    let frames: Vec<Rect> = if !scene.planes.is_empty() {
        let count = views.len() as f64;
        let height = (area.height - legend - 30.0 * (count - 1.0)) / count;
        (0..views.len()).map(|k| Rect { y: area.y + (height + 30.0) * k as f64, height, ..*area }).collect()
    } else if views.len() > 1 {
        let plan = (area.height - legend) * 0.56;
        let below = Rect { y: area.y + plan + 30.0, height: area.height - legend - plan - 30.0, ..*area };
        vec![Rect { height: plan, ..*area }, below]
    } else {
        vec![Rect { height: area.height - legend, ..*area }]
    };
    for (view, frame) in views.into_iter().zip(&frames) {
        one(canvas, frame, view, &shown);
    }
    speed_scale(canvas, area, &shown);
}

fn one(canvas: &mut dyn Canvas, frame: &Rect, view: View, shown: &Shown<'_>) {
    let title = TextStyle { size: 13.0, bold: true, ..TextStyle::new(INK) };
    let scene = shown.scene;
    let names: Vec<&str> =
        scene.picture.axes.iter().map(|&index| scene.machine.axes[index].name.as_str()).collect();
    let mm = scene.picture.unit;
    let (heading, unit) = match view {
        View::Plan(right, up) => {
            let names = [right, up].into_iter().filter_map(|axis| names.get(axis).copied());
            ("Path".to_owned(), format!("{}  {mm}", names.collect::<Vec<&str>>().join(" ")))
        }
        View::Isometric => ("Path in space".to_owned(), mm.to_owned()),
    };
    canvas.text(Point(frame.x, frame.y), &heading, &title);
    let beside = Point(frame.x + Font::new(title.size, true).width(&heading) + 8.0, frame.y);
    canvas.text(beside, &unit, &TextStyle { size: 12.0, ..TextStyle::new(SOFT) });
    let inner = match view {
        View::Plan(..) => Rect {
            x: frame.x + 46.0,
            y: frame.y + 12.0,
            width: frame.width - 46.0,
            height: frame.height - 36.0,
        },
        View::Isometric => Rect { y: frame.y + 12.0, height: frame.height - 16.0, ..*frame },
    };

    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for at in shown.all() {
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
    // Equal scales: the tighter direction decides, the other direction is centred.
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
        View::Plan(..) => grid(canvas, &inner, scale, centre),
        View::Isometric => tripod(canvas, &inner, &names),
    }
    canvas.clip(Some(&inner));
    tools(canvas, shown, (inner.width.max(inner.height) / scale, scale), &place);
    lines(canvas, shown, span[0] * span[1] * scale * scale, &place);
    canvas.clip(None);
}

/// Strokes along the tool, in a picture of this size (of the axes shown) and scale (pixels). A stroke along the view is a
/// point.
fn tools(
    canvas: &mut dyn Canvas,
    shown: &Shown<'_>,
    (size, scale): (f64, f64),
    place: &dyn Fn([f64; 3]) -> Point,
) {
    let mut strokes: Vec<Vec<Point>> = Vec::new();
    for Place { at, tool, .. } in &shown.moved {
        let Some(tool) = tool else { continue };
        let from = place(*at);
        if strokes.last().is_some_and(|last| apart(last[0], from) < TOOL_APART * size * scale) {
            continue;
        }
        let to = place(std::array::from_fn(|k| at[k] + TOOL_LENGTH * size * tool[k]));
        strokes.push(vec![from, to]);
    }
    strokes.retain(|stroke| apart(stroke[0], stroke[1]) > FINEST);
    if !strokes.is_empty() {
        canvas.polylines(&strokes, &TOOL);
    }
}

/// The path on a picture that is so large, in square pixels.
fn lines(canvas: &mut dyn Canvas, shown: &Shown<'_>, area: f64, place: &dyn Fn([f64; 3]) -> Point) {
    // Rapid motion is drawn along the driven path.
    for stretch in shown.programmed.iter().filter(|stretch| !stretch.rapid) {
        let line: Vec<Point> = stretch.line.iter().map(|&at| place(at)).collect();
        canvas.polyline(&thinned(&line), &Stroke::new(PROGRAMMED, 0.8));
    }
    let (shades, rapid) = by_speed(shown, place);
    canvas.polylines(&rapid, &RAPID);
    let length = |line: &Vec<Point>| line.windows(2).map(|pair| apart(pair[0], pair[1])).sum::<f64>();
    let all: f64 = shades.iter().flatten().map(length).sum();
    // Half of the mean distance of lines that fill the picture evenly.
    let width = if all > 0.0 { (0.5 * area / all).clamp(WIDTHS[0], WIDTHS[1]) } else { WIDTHS[1] };
    // A straight line has no area, and room on both sides.
    let width = if area < 1.0 { WIDTHS[1] } else { width };
    // Slow parts are drawn last, because they are the important ones.
    for (shade, lines) in shades.iter().enumerate().rev() {
        canvas.polylines(lines, &Stroke::new(colour(shade), width));
    }
    if let (Some(first), Some(last)) = (shown.moved.first(), shown.moved.last()) {
        // If start and end are equal, the ring of the end surrounds that of the start.
        let (first, last) = (place(first.at), place(last.at));
        canvas.ring(last, if apart(first, last) < DOT { RING } else { DOT }, INK);
        canvas.ring(first, DOT, START);
    }
}

/// The driven path: lines for each shade, one line for each part with one shade, and lines for rapid motion.
fn by_speed(shown: &Shown<'_>, place: &dyn Fn([f64; 3]) -> Point) -> (Vec<Vec<Vec<Point>>>, Vec<Vec<Point>>) {
    // Rapid motion is drawn before the shades.
    let mut kinds = vec![Vec::new(); SHADES + 1];
    let mut points: Vec<Point> = Vec::new();
    let mut current = None;
    for &Place { at, speed, rapid, .. } in &shown.moved {
        let shade = ((speed / shown.top_speed * SHADES as f64) as usize).min(SHADES - 1);
        let kind = if rapid { SHADES } else { shade };
        let point = place(at);
        if points.last().is_some_and(|&last| apart(last, point) <= FINEST)
            && points.len() > 1
            && rapid == (current == Some(SHADES))
        {
            continue;
        }
        // The line that leads to a point has the kind of this point.
        if current != Some(kind) {
            if let Some(current) = current {
                let next = points.last().copied().into_iter().collect();
                kinds[current].push(std::mem::replace(&mut points, next));
            }
            current = Some(kind);
        }
        points.push(point);
    }
    points.extend(shown.moved.last().map(|last| place(last.at)));
    if let Some(kind) = current {
        kinds[kind].push(points);
    }
    let rapid = kinds.pop().unwrap_or_default();
    (kinds, rapid)
}

/// How far two points are from one another.
fn apart(a: Point, b: Point) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

/// Points that can be distinguished, and no more than a picture needs.
fn thinned(points: &[Point]) -> Vec<Point> {
    let mut finest = FINEST;
    loop {
        let mut kept: Vec<Point> = Vec::new();
        for (index, &point) in points.iter().enumerate() {
            if index + 1 == points.len() || kept.last().is_none_or(|&last| apart(last, point) > finest) {
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

fn speed_scale(canvas: &mut dyn Canvas, area: &Rect, shown: &Shown<'_>) {
    let bar = Rect { x: area.x + 46.0, y: area.bottom() - 22.0, width: 180.0, height: 8.0 };
    let step = bar.width / SHADES as f64;
    for shade in 0..SHADES {
        let part = Rect { x: bar.x + shade as f64 * step, width: step + 0.4, ..bar };
        canvas.fill(&part, colour(shade), 1.0);
    }
    let small = |anchor| TextStyle { size: 11.0, anchor, ..TextStyle::new(SOFT) };
    canvas.text(Point(bar.x, bar.bottom() + 14.0), "0", &small(Anchor::Middle));
    let end = format!("{} {}/s", label(shown.top_speed), shown.scene.picture.unit);
    canvas.text(Point(bar.right(), bar.bottom() + 14.0), &end, &small(Anchor::Middle));
    let middle = bar.y + 4.0;
    let mut left = bar.right() + 54.0;
    let rapid = shown.has_rapid().then_some(("rapid", RAPID));
    let tool = shown.has_tool().then_some(("tool", TOOL));
    let programmed = [("programmed", Stroke::new(PROGRAMMED, 1.2))];
    for (name, stroke) in programmed.into_iter().chain(rapid).chain(tool) {
        canvas.polyline(&[Point(left, middle), Point(left + 22.0, middle)], &stroke);
        canvas.text(Point(left + 28.0, bar.y + 8.0), name, &small(Anchor::Start));
        left += 28.0 + Font::new(11.0, false).width(name) + 16.0;
    }
    for (name, colour) in [("start", START), ("end", INK)] {
        canvas.ring(Point(left + DOT, middle), DOT, colour);
        canvas.text(Point(left + 2.0 * DOT + 5.0, bar.y + 8.0), name, &small(Anchor::Start));
        left += 2.0 * DOT + 5.0 + Font::new(11.0, false).width(name) + 16.0;
    }
}

/// Slow is dark blue, fast is orange; the hues between them can be distinguished in print and by colour-blind
/// readers.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plane_is_the_one_in_which_the_path_lies() {
        let seen = |extent| {
            let planes = View::all(extent, &[]).into_iter().map(|view| match view {
                View::Plan(right, up) => Some((right, up)),
                View::Isometric => None,
            });
            planes.collect::<Vec<_>>()
        };
        assert_eq!(seen([50.0, 30.0, 0.0]), [Some((0, 1))]);
        assert_eq!(seen([50.0, 0.0, 30.0]), [Some((0, 2))]);
        assert_eq!(seen([0.0, 20.0, 30.0]), [Some((1, 2))]);
        assert_eq!(seen([50.0, 0.0, 0.0]), [Some((0, 1))]);
        assert_eq!(seen([0.0, 0.0, 30.0]), [Some((0, 2))]);
        assert_eq!(seen([50.0, 30.0, 5.0]), [Some((0, 1)), None]);
        assert_eq!(seen([50.0, 0.1, 30.0]), [Some((0, 2)), None]);
        assert_eq!(seen([0.0; 3]), [Some((0, 1))]);
    }
}
