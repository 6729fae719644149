//! Deviation of the driven path from the programmed path, over path distance: in percent of the tolerance, or
//! in mm if nothing is monitored. The main axes have one line, and the other axes have another one.
use super::{Canvas, LIMIT, Line, Name, Over, Point, Rect, Row, Scale, Scene, Stroke, label};
use crate::deviation::{Column, Largest, NOTHING};
use crate::plot::canvas::{INK, axis_colour};

/// Width of the lines.
const WIDTH: f64 = 1.0;

struct Deviations<'a> {
    columns: &'a [Column],
    percent: bool,
    /// Colour and names of the other axes, if any leaves its path.
    others: Option<(usize, String)>,
    length: f64,
}

/// The row, if a part of the path is smoothed.
pub fn row<'a>(scene: &'a Scene<'a>) -> Option<Box<dyn Row + 'a>> {
    let seen = scene.statistics.deviation.as_ref().filter(|seen| seen.smooths)?;
    let length = seen.columns.last()?.distance;
    let leaves =
        |(axis, largest): (usize, &Option<Largest>)| largest.filter(|off| off.value > NOTHING).map(|_| axis);
    let off: Vec<usize> = seen.track.iter().enumerate().filter_map(leaves).collect();
    let names: Vec<&str> = off.iter().map(|&axis| scene.machine.axes[axis].name.as_str()).collect();
    let others = off.first().map(|&axis| (axis, names.join(" ")));
    let percent = seen.columns.iter().any(|column| column.path_used > 0.0 || column.track_used > 0.0);
    (length > 0.0)
        .then(|| Box::new(Deviations { columns: &seen.columns, percent, others, length }) as Box<dyn Row>)
}

impl Deviations<'_> {
    fn values(&self) -> [Vec<f64>; 2] {
        let of = |path: fn(&Column) -> f64| self.columns.iter().map(path).collect::<Vec<f64>>();
        if self.percent {
            [of(|column| 100.0 * column.path_used), of(|column| 100.0 * column.track_used)]
        } else {
            [of(|column| column.path), of(|column| column.track)]
        }
    }
}

impl Row for Deviations<'_> {
    fn title(&self) -> &str {
        "Deviation"
    }

    fn unit(&self) -> String {
        if self.percent { "% of the tolerance".into() } else { "mm, °".into() }
    }

    fn over(&self) -> Over {
        Over::Distance(self.length)
    }

    fn names(&self) -> Vec<Name> {
        let mut names = vec![("path".to_owned(), INK, false)];
        names.extend(self.others.iter().map(|(axis, name)| (name.clone(), axis_colour(*axis), false)));
        if self.percent {
            names.push((format!("tolerance {}", label(100.0)), LIMIT, true));
        }
        names
    }

    fn reach(&self) -> (f64, bool) {
        (self.values().iter().flatten().copied().fold(1e-6, f64::max), false)
    }

    fn limits(&self) -> Vec<Line> {
        if self.percent { vec![Line { value: 100.0, colour: LIMIT }] } else { Vec::new() }
    }

    fn draw(&self, canvas: &mut dyn Canvas, frame: &Rect, x: &Scale, y: &Scale) {
        let colours = [Some(INK), self.others.as_ref().map(|(axis, _)| axis_colour(*axis))];
        for (values, colour) in self.values().iter().zip(colours) {
            let Some(colour) = colour else { continue };
            // The highest value of each column.
            let mut line: Vec<Point> = vec![Point(frame.x, y.at(0.0))];
            let mut from = frame.x;
            for (column, &value) in self.columns.iter().zip(values) {
                let (to, at) = (x.at(column.distance), y.at(value));
                match line.as_mut_slice() {
                    [.., before, last] if to - from < 1.0 && line_is_level(before, last) => {
                        let high = last.1.min(at);
                        (before.1, *last) = (high, Point(to, high));
                    }
                    _ => {
                        from = line.last().map_or(frame.x, |last| last.0);
                        line.extend([Point(from, at), Point(to, at)]);
                    }
                }
            }
            let mut area = line.clone();
            area.push(Point(area.last().map_or(frame.x, |last| last.0), y.at(0.0)));
            canvas.polygon(&area, colour, 0.2);
            canvas.polyline(&line, &Stroke::new(colour, WIDTH));
        }
    }

    fn stroke(&self) -> f64 {
        WIDTH / 2.0
    }
}

fn line_is_level(one: &Point, other: &Point) -> bool {
    one.1 == other.1
}
