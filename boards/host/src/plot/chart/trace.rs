//! A quantity over time: a line where there is room for every tick, else the area between lowest and highest
//! of every column.
use super::{Canvas, Colour, Point, Scale, Scene, Stroke};

/// Width of a column.
const COLUMN: f64 = 1.0;

/// Draws a series of the record, each value times `factor`.
pub fn envelope(
    canvas: &mut dyn Canvas,
    scene: &Scene<'_>,
    series: usize,
    (x, y): (&Scale, &Scale),
    factor: f64,
    colour: Colour,
    width: f64,
) {
    let envelope = &scene.picture.envelope;
    let cycle = scene.machine.cycle_s();
    let values = envelope.series(series).enumerate();
    let stretches = values.map(|(index, span)| {
        let at = x.at((index as u64 * envelope.stride()) as f64 * cycle);
        (at, span.map(|value| value * factor))
    });
    let columns = columns(stretches, envelope.stride() == 1);
    if columns.iter().all(|(_, [low, high])| low == high) {
        let line: Vec<Point> = columns.iter().map(|(at, [low, _])| Point(*at, y.at(*low))).collect();
        canvas.polyline(&line, &Stroke::new(colour, width));
        return;
    }
    // The edges lie inside by half of their width: the area ends where its values end.
    let edge = width.min(1.0);
    let inset = |low: f64, high: f64| {
        let (top, bottom) = (y.at(high), y.at(low));
        let by = (edge / 2.0).min((bottom - top) / 2.0);
        [top + by, bottom - by]
    };
    let edges: Vec<(f64, [f64; 2])> =
        columns.iter().map(|(at, [low, high])| (*at, inset(*low, *high))).collect();
    let upper: Vec<Point> = edges.iter().map(|(at, [top, _])| Point(*at, *top)).collect();
    let lower: Vec<Point> = edges.iter().map(|(at, [_, bottom])| Point(*at, *bottom)).collect();
    let area: Vec<Point> = upper.iter().copied().chain(lower.iter().rev().copied()).collect();
    canvas.polygon(&area, colour, 0.3);
    canvas.polylines(&[upper, lower], &Stroke { opacity: 0.9, ..Stroke::new(colour, edge) });
}

/// Lowest and highest per column. A column reaches to the first value of the next one, so that steep lines
/// have no gaps. `single`: each stretch is one tick.
fn columns(stretches: impl Iterator<Item = (f64, [f64; 2])>, single: bool) -> Vec<(f64, [f64; 2])> {
    let stretches: Vec<(f64, [f64; 2])> = stretches.collect();
    let wide = match stretches.as_slice() {
        [first, .., last] => (last.0 - first.0) / (stretches.len() - 1) as f64 >= COLUMN,
        _ => true,
    };
    if wide && single {
        return stretches;
    }
    let mut columns: Vec<(f64, [f64; 2])> = Vec::new();
    for (at, [low, high]) in stretches {
        match columns.last_mut() {
            Some((from, [lowest, highest])) if at - *from < COLUMN => {
                (*lowest, *highest) = (lowest.min(low), highest.max(high));
            }
            Some((_, [lowest, highest])) => {
                // What lies between two columns.
                let (up, down) = (low > *highest, high < *lowest);
                if up {
                    *highest = low;
                } else if down {
                    *lowest = high;
                }
                columns.push((at, [low, high]));
            }
            None => columns.push((at, [low, high])),
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
            let value = if i % 2 == 0 { 1.0 } else { -2.0 };
            (f64::from(i) * 0.01, [value, if i == 777 { 5.0 } else { value }])
        });
        let columns = columns(spikes, true);
        assert!((99..=101).contains(&columns.len()), "{}", columns.len());
        assert!(columns.iter().all(|(_, [low, high])| *low == -2.0 && (*high == 1.0 || *high == 5.0)));
        assert!(
            (columns.iter().find(|(_, [_, high])| *high == 5.0).map_or(0.0, |(at, _)| *at) - 7.0).abs() < 1.0
        );
    }

    #[test]
    fn few_values_stay_as_they_are_and_steep_ones_have_no_gaps() {
        let few: Vec<(f64, [f64; 2])> = (0..5).map(|i| (f64::from(i) * 2.0, [f64::from(i); 2])).collect();
        assert_eq!(columns(few.clone().into_iter(), true), few);
        let steep = (0..1000).map(|i| (f64::from(i) * 0.1, [f64::from(i * i); 2]));
        let columns = columns(steep, true);
        assert!(columns.windows(2).all(|pair| pair[0].1[1] >= pair[1].1[0]));
    }
}
