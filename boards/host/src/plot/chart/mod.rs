//! Charts, one below the other: each chart is a row, and its content has a separate file.

mod axes;
mod beside;
mod deviation;
mod speed;
mod trace;

use super::Scene;
use super::canvas::{Anchor, Canvas, Colour, GRID, INK, LIMIT, Point, Rect, SOFT, Stroke, TextStyle};
use super::events::Marks;
use super::font::Font;
use super::scale::{Scale, label, round_up, ticks};

/// Above this number of blocks their borders would be a grey area.
const BORDERS: usize = 120;
/// Height between two charts.
const GAP: f64 = 52.0;
/// Width of the line of a limit.
const LIMIT_WIDTH: f64 = 1.1;

/// The horizontal axis of a row.
#[derive(Clone, Copy, PartialEq)]
enum Over {
    Time,
    /// Path distance, mm, up to this value.
    Distance(f64),
}

/// An entry of a heading: text, colour, dashed.
type Name = (String, Colour, bool);

/// A level in the colour of an axis, or in that of limits.
#[derive(Clone, Copy)]
struct Line {
    value: f64,
    colour: Colour,
}

/// One chart.
trait Row {
    fn title(&self) -> &str;
    fn unit(&self) -> String;
    fn over(&self) -> Over {
        Over::Time
    }
    /// The entries of the heading, from left to right.
    fn names(&self) -> Vec<Name>;
    /// The highest magnitude in the chart, and whether there are negative values.
    fn reach(&self) -> (f64, bool);
    /// Limits: shown if the values come near the limit.
    fn limits(&self) -> Vec<Line> {
        Vec::new()
    }
    /// Draws the content of the frame.
    fn draw(&self, canvas: &mut dyn Canvas, frame: &Rect, x: &Scale, y: &Scale);
    /// Half the width of its strokes: limits are drawn outside of the strokes.
    fn stroke(&self) -> f64;
}

/// All rows of a run.
fn rows<'a>(scene: &'a Scene<'a>) -> Vec<Box<dyn Row + 'a>> {
    let mut rows: Vec<Box<dyn Row + 'a>> = vec![Box::new(speed::PathSpeed::new(scene))];
    rows.extend(axes::rows(scene));
    rows.extend(deviation::row(scene));
    rows.extend(beside::rows(scene));
    rows
}

/// Draws the charts into `area`.
pub fn draw(canvas: &mut dyn Canvas, area: &Rect, scene: &Scene<'_>) {
    let end = ((scene.picture.ticks().max(2) - 1) as f64) * scene.machine.cycle_s();
    let (left, width) = (area.x + 62.0, area.width - 62.0);
    let time = Scale::new(0.0, end, left, left + width);
    let marks = Marks::new(scene, &time, left + width);
    let rows = rows(scene);
    let count = rows.len() as f64;
    let height = (area.height - (count - 1.0) * GAP - 34.0 - marks.height()) / count;
    for (index, row) in rows.iter().enumerate() {
        let y = area.y + marks.height() + index as f64 * (height + GAP) + 10.0;
        let frame = Rect { x: left, y, width, height };
        let labels = if index == 0 { marks.height() } else { 0.0 };
        let over = row.over();
        let (x, end, axis) = match over {
            Over::Time => (time, end, "time s"),
            Over::Distance(all) => (Scale::new(0.0, all, left, left + width), all, "path mm"),
        };
        if over == Over::Time {
            marks.ground(canvas, &frame);
            borders(canvas, &frame, scene, &x);
        }
        one(canvas, &frame, row.as_ref(), &x, end);
        if over == Over::Time {
            marks.draw(canvas, &frame, index == 0);
        }
        heading(canvas, &frame, y - 11.0 - labels, row.as_ref());
        let style = TextStyle { size: 11.0, anchor: Anchor::End, ..TextStyle::new(SOFT) };
        canvas.text(Point(left - 14.0, frame.bottom() + 17.0), axis, &style);
    }
}

fn one(canvas: &mut dyn Canvas, frame: &Rect, row: &dyn Row, x: &Scale, end: f64) {
    let (seen, signed) = row.reach();
    let limits = row.limits();
    // A limit far above must not flatten the values.
    let near = limits.iter().map(|line| line.value.abs()).filter(|value| *value <= seen * 1.7);
    let top = round_up(near.fold(seen, f64::max) * 1.06);
    let low = if signed { -top } else { 0.0 };
    let y = Scale::new(low, top, frame.bottom(), frame.y);
    let small = |anchor| TextStyle { size: 11.0, anchor, ..TextStyle::new(SOFT) };
    for value in ticks(low, top, 5) {
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
    row.draw(canvas, frame, x, &y);
    for line in limits.iter().filter(|line| line.value.abs() <= top) {
        // A value that reaches the limit ends at the inner edge of the limit's line.
        let out = (row.stroke() + LIMIT_WIDTH / 2.0) * if line.value < 0.0 { 1.0 } else { -1.0 };
        let at = y.at(line.value) + out;
        canvas.polyline(&[Point(frame.x, at), Point(frame.right(), at)], &dashed(line.colour));
    }
    canvas.clip(None);
    let base = [Point(frame.x, frame.bottom()), Point(frame.right(), frame.bottom())];
    canvas.polyline(&base, &Stroke::new(SOFT, 0.8));
}

fn dashed(colour: Colour) -> Stroke {
    Stroke { opacity: 0.85, dash: Some((6.0, 4.0)), ..Stroke::new(colour, LIMIT_WIDTH) }
}

/// The title on the left, and the entries of the heading on the right, with their base line at `above`.
fn heading(canvas: &mut dyn Canvas, frame: &Rect, above: f64, row: &dyn Row) {
    let title = TextStyle { size: 13.0, bold: true, ..TextStyle::new(INK) };
    canvas.text(Point(frame.x, above), row.title(), &title);
    let unit_at = frame.x + Font::new(title.size, true).width(row.title()) + 8.0;
    let mut right = frame.right();
    for (name, colour, dashed) in row.names().iter().rev() {
        let style = TextStyle { size: 11.0, anchor: Anchor::End, ..TextStyle::new(SOFT) };
        canvas.text(Point(right, above), name, &style);
        right -= Font::new(11.0, false).width(name) + 6.0;
        let dash = dashed.then_some((4.0, 3.0));
        let stroke = Stroke { dash, ..Stroke::new(*colour, 1.8) };
        canvas.polyline(&[Point(right - 18.0, above - 4.0), Point(right, above - 4.0)], &stroke);
        right -= 30.0;
    }
    let unit = row.unit();
    let style = TextStyle { size: UNIT_SIZE, ..TextStyle::new(SOFT) };
    canvas.text(Point(unit_at, above), fitting(&unit, right - unit_at), &style);
}

/// Size of a unit's text.
const UNIT_SIZE: f64 = 12.0;

/// The unit, shortened to the room between the title and the names: without "of each axis", then to its first word.
fn fitting(unit: &str, room: f64) -> &str {
    let first = |end: &str| unit.split(end).next().unwrap_or(unit);
    let forms = [unit, first(" of each axis"), first(" ")];
    let font = Font::new(UNIT_SIZE, false);
    forms.into_iter().find(|form| font.width(form) <= room).unwrap_or_else(|| first(" "))
}

/// Draws the borders of blocks.
fn borders(canvas: &mut dyn Canvas, frame: &Rect, scene: &Scene<'_>, x: &Scale) {
    let cycle = scene.machine.cycle_s();
    let entries = &scene.picture.entries;
    if entries.len() > BORDERS {
        return;
    }
    // Every second block has a faint background.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit of a row gives way to the names of its axes.
    #[test]
    fn a_unit_fits_between_title_and_names() {
        let unit = "% of the limit of each axis";
        assert_eq!(
            [400.0, 100.0, 20.0, -5.0].map(|room| fitting(unit, room)),
            [unit, "% of the limit", "%", "%"]
        );
        assert_eq!(fitting("mm/s²", 1.0), "mm/s²");
    }
}
