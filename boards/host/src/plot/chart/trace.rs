//! A quantity over time: a line if there is room for every tick, else the area between lowest and highest
//! value of every column. If the area would fill the chart, as jerk does in long runs, the area is faint, and
//! a line shows the mean magnitude.
use super::{Canvas, Colour, Point, Rect, SOFT, Scale, Scene, Stroke, TextStyle};

/// Width of a column.
const COLUMN: f64 = 1.0;

/// Explanation of the lines if the areas are faint.
pub fn legend(canvas: &mut dyn Canvas, frame: &Rect) {
    let style = TextStyle { size: 10.0, ..TextStyle::new(SOFT) };
    let text = "ground: lowest to highest, lines: mean magnitude";
    canvas.text(Point(frame.x + 6.0, frame.bottom() - 6.0), text, &style);
}

/// Draws a series of the record, each value times `factor`. Returns whether its area is faint.
pub fn envelope(
    canvas: &mut dyn Canvas,
    scene: &Scene<'_>,
    series: usize,
    (x, y): (&Scale, &Scale),
    factor: f64,
    colour: Colour,
    width: f64,
) -> bool {
    let envelope = &scene.picture.envelope;
    let cycle = scene.machine.cycle_s();
    let values = envelope.series(series).enumerate();
    let stretches = values.map(|(index, span)| {
        let at = x.at((index as u64 * envelope.stride()) as f64 * cycle);
        (at, span.map(|value| value * factor))
    });
    let columns = columns(stretches, envelope.stride() == 1);
    if columns.iter().all(|(_, [low, high, _])| low == high) {
        let line: Vec<Point> = columns.iter().map(|(at, [low, ..])| Point(*at, y.at(*low))).collect();
        canvas.polyline(&line, &Stroke::new(colour, width));
        return false;
    }
    if is_full(&columns) {
        full(canvas, &columns, y, colour);
        return true;
    }
    // The edges lie inside by half of their width, so the area ends at its values.
    let edge = width.min(1.0);
    let inset = |low: f64, high: f64| {
        let (top, bottom) = (y.at(high), y.at(low));
        let by = (edge / 2.0).min((bottom - top) / 2.0);
        [top + by, bottom - by]
    };
    let edges: Vec<(f64, [f64; 2])> =
        columns.iter().map(|(at, [low, high, _])| (*at, inset(*low, *high))).collect();
    let upper: Vec<Point> = edges.iter().map(|(at, [top, _])| Point(*at, *top)).collect();
    let lower: Vec<Point> = edges.iter().map(|(at, [_, bottom])| Point(*at, *bottom)).collect();
    canvas.polygon(&area(&upper, &lower), colour, 0.3);
    canvas.polylines(&[upper, lower], &Stroke { opacity: 0.9, ..Stroke::new(colour, edge) });
    false
}

/// The area between two lines.
fn area(upper: &[Point], lower: &[Point]) -> Vec<Point> {
    upper.iter().copied().chain(lower.iter().rev().copied()).collect()
}

/// Whether columns are so high on average, compared with the highest value, that their edges would fill the
/// chart.
fn is_full(columns: &[Column]) -> bool {
    const FULL: f64 = 0.3;
    let peak = columns.iter().map(|(_, [low, high, _])| high.abs().max(low.abs())).fold(0.0, f64::max);
    let sum: f64 = columns.iter().map(|(_, [low, high, _])| high - low).sum();
    sum > FULL * peak * columns.len() as f64
}

/// Draws the range of the values as a faint area without edges, and the mean magnitude as a line: on both
/// sides of zero if the values have two signs.
fn full(canvas: &mut dyn Canvas, columns: &[Column], y: &Scale, colour: Colour) {
    let line = |value: fn(&[f64; 3]) -> f64| -> Vec<Point> {
        columns.iter().map(|(at, column)| Point(*at, y.at(value(column)))).collect()
    };
    canvas.polygon(&area(&line(|column| column[1]), &line(|column| column[0])), colour, 0.14);
    let signed = columns.iter().any(|(_, [low, ..])| *low < 0.0);
    let mut means = vec![line(|column| column[2])];
    if signed {
        means.push(line(|column| -column[2]));
    }
    canvas.polylines(&means, &Stroke::new(colour, 1.1));
}

/// Left end, lowest and highest value, mean magnitude.
type Column = (f64, [f64; 3]);

/// Lowest and highest value per column, and the mean. A column extends to the first value of the next column,
/// so that steep lines have no gaps. `single`: each interval is one tick.
fn columns(stretches: impl Iterator<Item = Column>, single: bool) -> Vec<Column> {
    let stretches: Vec<Column> = stretches.collect();
    let wide = match stretches.as_slice() {
        [first, .., last] => (last.0 - first.0) / (stretches.len() - 1) as f64 >= COLUMN,
        _ => true,
    };
    if wide && single {
        return stretches;
    }
    let mut columns: Vec<Column> = Vec::new();
    // Intervals in the last column.
    let mut count = 1.0;
    for (at, [low, high, mean]) in stretches {
        match columns.last_mut() {
            Some((from, [lowest, highest, all])) if at - *from < COLUMN => {
                (*lowest, *highest) = (lowest.min(low), highest.max(high));
                count += 1.0;
                *all += (mean - *all) / count;
            }
            Some((_, [lowest, highest, _])) => {
                // Values between two columns.
                let (up, down) = (low > *highest, high < *lowest);
                if up {
                    *highest = low;
                } else if down {
                    *lowest = high;
                }
                columns.push((at, [low, high, mean]));
                count = 1.0;
            }
            None => columns.push((at, [low, high, mean])),
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dense_values_become_columns_and_keep_their_extremes() {
        let spikes = (0..10_000).map(|i| {
            let value: f64 = if i % 2 == 0 { 1.0 } else { -2.0 };
            (f64::from(i) * 0.01, [value, if i == 777 { 5.0 } else { value }, value.abs()])
        });
        let columns = columns(spikes, true);
        assert!((99..=101).contains(&columns.len()), "{}", columns.len());
        assert!(columns.iter().all(|(_, [low, high, _])| *low == -2.0 && (*high == 1.0 || *high == 5.0)));
        assert!(columns.iter().all(|(_, [.., mean])| (mean - 1.5).abs() < 0.01) && is_full(&columns));
        assert!(
            (columns.iter().find(|(_, [_, high, _])| *high == 5.0).map_or(0.0, |(at, _)| *at) - 7.0).abs()
                < 1.0
        );
    }

    #[test]
    fn few_values_stay_as_they_are_and_steep_ones_have_no_gaps() {
        let few: Vec<Column> = (0..5).map(|i| (f64::from(i) * 2.0, [f64::from(i); 3])).collect();
        assert_eq!(columns(few.clone().into_iter(), true), few);
        let steep = (0..1000).map(|i| (f64::from(i) * 0.1, [f64::from(i * i); 3]));
        let columns = columns(steep, true);
        assert!(columns.windows(2).all(|pair| pair[0].1[1] >= pair[1].1[0]) && !is_full(&columns));
    }
}
