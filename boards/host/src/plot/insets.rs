//! Enlarged views of the places with the largest deviation: the programmed path with block ends, the driven
//! path, and the tolerance band.
//!
//! Each place is drawn in the plane of the path and its deviation. If the curve is much longer than the band
//! is wide, both directions have separate scales.
use super::Scene;
use super::canvas::{
    Anchor, Canvas, Colour, GRID, INK, LIMIT, PROGRAMMED, Point as At, Rect, SOFT, Stroke, TextStyle,
};
use super::scale::{label, step};
use crate::deviation::{NOTHING, Place, Point};

/// Height that they need.
pub const HEIGHT: f64 = 214.0;
const GAP: f64 = 18.0;
const WIDTH: f64 = 1.5;
const BAND: Colour = Colour(0xcf, 0xe8, 0xd6);
/// A curve longer than this number of tolerances is drawn with two scales.
const LONG: f64 = 6.0;

/// Whether there are any.
pub fn any(scene: &Scene<'_>) -> bool {
    places(scene).is_some()
}

fn places<'a>(scene: &'a Scene<'_>) -> Option<&'a [Place]> {
    let seen = scene.statistics.deviation.as_ref().filter(|seen| seen.smooths)?;
    let count = seen.places.iter().filter(|place| place.largest.value > NOTHING).count();
    seen.places.get(..count).filter(|places| !places.is_empty())
}

/// Draws them side by side into `area`.
pub fn draw(canvas: &mut dyn Canvas, area: &Rect, scene: &Scene<'_>) {
    let Some(places) = places(scene) else { return };
    let width = (area.width - 2.0 * GAP) / 3.0;
    let title = TextStyle { size: 13.0, bold: true, ..TextStyle::new(INK) };
    canvas.text(At(area.x, area.y), "Largest deviations", &title);
    for (index, place) in places.iter().enumerate() {
        let x = area.x + index as f64 * (width + GAP);
        let frame = Rect { x, y: area.y + 24.0, width, height: area.height - 46.0 };
        one(canvas, &frame, scene, place);
    }
}

fn minus(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn unit(v: &Point) -> Option<Point> {
    let length = dot(v, v).sqrt();
    (length > 1e-12).then(|| v.map(|value| value / length))
}

/// A place in its view: along the path, and in the direction of the deviation.
struct View {
    origin: Point,
    along: Point,
    across: Point,
}

impl View {
    fn of(place: &Place) -> Option<Self> {
        let nearest = |a: &&[Point], b: &&[Point]| {
            let off = |pair: &[Point]| dot(&minus(&pair[0], &place.moved), &minus(&pair[0], &place.moved));
            off(a).total_cmp(&off(b))
        };
        let pair = place.around.windows(2).filter(|pair| pair[0] != pair[1]).min_by(nearest)?;
        let way = unit(&minus(&pair[1], &pair[0]))?;
        let across = unit(&minus(&place.moved, &place.programmed))?;
        let lean = dot(&way, &across);
        let along = unit(&std::array::from_fn(|k| way[k] - lean * across[k]))?;
        Some(Self { origin: place.programmed, along, across })
    }

    fn project(&self, point: &Point) -> [f64; 2] {
        let from = minus(point, &self.origin);
        [dot(&from, &self.along), dot(&from, &self.across)]
    }
}

/// Distance of a place from a line of points.
fn off(q: [f64; 2], line: &[[f64; 2]]) -> f64 {
    let distance = |pair: &[[f64; 2]]| {
        let d = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let square = d[0] * d[0] + d[1] * d[1];
        let product = (q[0] - pair[0][0]) * d[0] + (q[1] - pair[0][1]) * d[1];
        let part = if square > 0.0 { (product / square).clamp(0.0, 1.0) } else { 0.0 };
        (q[0] - pair[0][0] - part * d[0]).hypot(q[1] - pair[0][1] - part * d[1])
    };
    line.windows(2).map(distance).fold(f64::INFINITY, f64::min)
}

/// The length of the path on which the deviation is more than a tenth of its largest value.
fn reach(moved: &[[f64; 2]], programmed: &[[f64; 2]], value: f64) -> f64 {
    let from_here = |point: &[f64; 2]| point[0].hypot(point[1]);
    let Some(here) = (0..moved.len()).min_by(|&a, &b| from_here(&moved[a]).total_cmp(&from_here(&moved[b])))
    else {
        return value;
    };
    let is_off = |point: &&[f64; 2]| off(**point, programmed) > 0.1 * value;
    let far = |points: &mut dyn Iterator<Item = &[f64; 2]>| {
        points.take_while(is_off).map(from_here).fold(value, f64::max)
    };
    far(&mut moved[here..].iter()).max(far(&mut moved[..here].iter().rev()))
}

fn one(canvas: &mut dyn Canvas, frame: &Rect, scene: &Scene<'_>, place: &Place) {
    let (Some(view), Some(seen)) = (View::of(place), &scene.statistics.deviation) else { return };
    let (value, tolerance) = (place.largest.value, place.largest.tolerance);
    let project = |points: &[Point]| points.iter().map(|point| view.project(point)).collect::<Vec<_>>();
    let (moved, programmed) = (project(&place.around), project(&seen.programmed(place.block)));
    let band = tolerance.unwrap_or(value).max(value);
    let half = (1.25 * reach(&moved, &programmed, value)).max(1.8 * band);
    let long = half > LONG * band;
    let per_mm = frame.width / (2.0 * half);
    let (across, middle) = if long { (frame.height / (4.0 * band), 0.5) } else { (per_mm, 0.5) };
    let at = |point: &[f64; 2]| {
        // The deviation points up.
        At(
            frame.x + frame.width / 2.0 + point[0] * per_mm,
            frame.y + frame.height * middle - (point[1] - value / 2.0) * across,
        )
    };
    canvas.clip(Some(frame));
    canvas.fill(frame, Colour(0xf7, 0xf9, 0xfb), 1.0);
    let line: Vec<At> = programmed.iter().map(at).collect();
    if let Some(tolerance) = tolerance {
        // Wider by the stroke of the path, so that a path inside the tolerance is drawn inside the band.
        let height = tolerance * across + WIDTH / 2.0;
        if long {
            let shifted = |by: f64| line.iter().map(move |At(x, y)| At(*x, y + by));
            let area: Vec<At> = shifted(-height).chain(shifted(height).rev()).collect();
            canvas.polygon(&area, BAND, 1.0);
        } else {
            canvas.polyline(&line, &Stroke::new(BAND, 2.0 * height));
        }
    }
    canvas.polyline(&line, &Stroke::new(PROGRAMMED, 1.2));
    let moved: Vec<At> = moved.iter().map(at).collect();
    canvas.polyline(&moved, &Stroke::new(INK, WIDTH));
    let ends = [at(&view.project(&place.programmed)), at(&view.project(&place.moved))];
    canvas.polyline(&ends, &Stroke::new(LIMIT, 1.1));
    for end in seen.ends(place.block).iter().map(|end| at(&view.project(end))) {
        if end.0 > frame.x && end.0 < frame.right() && end.1 > frame.y && end.1 < frame.bottom() {
            canvas.dot(end, 3.0, PROGRAMMED);
        }
    }
    canvas.clip(None);
    let Rect { x, y, .. } = *frame;
    let corners =
        [At(x, y), At(frame.right(), y), At(frame.right(), frame.bottom()), At(x, frame.bottom()), At(x, y)];
    canvas.polyline(&corners, &Stroke::new(GRID, 1.0));
    caption(canvas, frame, place, [per_mm, across]);
}

/// The title above, and the scales below.
fn caption(canvas: &mut dyn Canvas, frame: &Rect, place: &Place, [along, across]: [f64; 2]) {
    let small = |anchor| TextStyle { size: 11.0, anchor, ..TextStyle::new(SOFT) };
    let (value, n) = (place.largest.value, place.largest.n);
    let of =
        place.largest.tolerance.map_or_else(String::new, |tolerance| format!(" of {} mm", fine(tolerance)));
    let unit = if of.is_empty() { " mm" } else { "" };
    canvas.text(
        At(frame.x, frame.y - 5.0),
        &format!("N{n}:  {}{unit}{of}", fine(value)),
        &small(Anchor::Start),
    );
    let length = step(28.0 / along, 1);
    let base = frame.bottom() + 9.0;
    let end = frame.x + length * along;
    canvas.polyline(&[At(frame.x, base), At(end, base)], &Stroke::new(SOFT, 1.4));
    canvas.text(At(end + 6.0, base + 4.0), &format!("{} mm", fine(length)), &small(Anchor::Start));
    if (along - across).abs() > 1e-9 * along {
        let times = format!("across × {}", label((across / along).round()));
        canvas.text(At(frame.right(), base + 4.0), &times, &small(Anchor::End));
    }
}

/// Three digits, however small.
fn fine(value: f64) -> String {
    if value >= 0.1 || value <= 0.0 {
        return label((value * 1e4).round() / 1e4);
    }
    let digits = (2.0 - value.log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_seen_along_the_path_and_across() {
        // A corner at (10, 0, 0), cut by a curve: the deviation goes to the left of the path.
        let moved = [9.8, 0.2, 0.0];
        let around: Vec<Point> = (0..=20)
            .map(|i| {
                let u = f64::from(i) / 10.0 - 1.0;
                [9.8 + u * 0.5_f64.sqrt(), 0.2 + u * 0.5_f64.sqrt(), 0.0]
            })
            .collect();
        let largest = crate::deviation::Largest { value: 0.2 * 2_f64.sqrt(), tolerance: Some(0.3), n: 1 };
        let place = Place::new(largest, 0, [10.0, 0.0, 0.0], moved, around);
        let view = View::of(&place).expect("it has a direction");
        let near = |point: [f64; 3], expected: [f64; 2]| {
            let seen = view.project(&point);
            assert!((0..2).all(|k| (seen[k] - expected[k]).abs() < 1e-9), "{seen:?} {expected:?}");
        };
        near(moved, [0.0, 0.2 * 2_f64.sqrt()]);
        near([10.0, 0.0, 0.0], [0.0, 0.0]);
        near([10.0, 1.0, 5.0], [0.5_f64.sqrt(), 0.5_f64.sqrt()]);
        near([9.0, 0.0, 0.0], [-0.5_f64.sqrt(), 0.5_f64.sqrt()]);
    }

    #[test]
    fn the_reach_ends_where_both_paths_are_one() {
        let programmed = [[-10.0, 10.0], [0.0, 0.0], [10.0, 10.0]];
        let moved: Vec<[f64; 2]> =
            (-100..=100).map(|i| f64::from(i) / 10.0).map(|x| [x, x.abs().max(0.5)]).collect();
        let far = reach(&moved, &programmed, 0.5);
        assert!((0.4..0.8).contains(&far), "{far}");
        assert_eq!(fine(0.02), "0.02");
        assert_eq!(fine(0.012_345), "0.0123");
    }
}
