//! Reach and distance over time as a picture (SVG), and the power of the laser below.
use super::Told;
use std::fmt::Write;

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 40.0;
/// Lower edges of the two charts, and the height of the second one.
const PATH: f64 = 270.0;
const LASER: [f64; 2] = [310.0, 380.0];

/// Draws the answers to the PLC.
pub fn draw(name: &str, told: &Told) -> String {
    let rows = &told.curve;
    let end = rows.last().map_or(1.0, |row| row.0).max(1e-3);
    let far = rows.iter().map(|row| row.1).fold(0.0, f64::max).max(1e-3);
    let name = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let x = |seconds: f64| LEFT + seconds / end * (WIDTH - LEFT - RIGHT);
    let y = |mm: f64| PATH - mm / far * (PATH - TOP);
    let power = |percent: u8| LASER[1] - f64::from(percent) / 100.0 * (LASER[1] - LASER[0]);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"12\"><rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\
         <text x=\"{LEFT}\" y=\"20\">{}: how far the path is known</text>",
        escaped(name)
    );
    let mut frame = |top: f64, bottom: f64, most: &str| {
        let _ = write!(
            svg,
            "<path d=\"M{LEFT} {top}V{bottom}H{}\" fill=\"none\" stroke=\"#888\"/>\
             <text x=\"{}\" y=\"{}\" text-anchor=\"end\">{most}</text>\
             <text x=\"{}\" y=\"{bottom}\" text-anchor=\"end\">0</text>",
            WIDTH - RIGHT,
            LEFT - 6.0,
            top + 10.0,
            LEFT - 6.0
        );
    };
    frame(TOP, PATH, &format!("{far:.1} mm"));
    let lit = rows.iter().any(|row| row.3.is_some());
    if lit {
        frame(LASER[0], LASER[1], "100 %");
    }
    let (mut reach, mut light) = (Steps::default(), Steps::default());
    let mut driven = String::new();
    let mut column = i64::MIN;
    for (i, &(seconds, known, at, percent)) in rows.iter().enumerate() {
        let is_last = i + 1 == rows.len();
        reach.add(x(seconds), y(known), is_last);
        if let Some(percent) = percent {
            light.add(x(seconds), power(percent), is_last);
        }
        // One point for two pixels.
        let here = (x(seconds) / 2.0).round() as i64;
        if at.is_finite() && (here != column || is_last) {
            let to = if driven.is_empty() { 'M' } else { 'L' };
            let _ = write!(driven, "{to}{:.1} {:.1}", x(seconds), y(at));
            column = here;
        }
    }
    let (reach, light) = (reach.path, light.path);
    for (path, colour, label, at) in
        [(reach, "#1f77b4", "reach", TOP + 14.0), (driven, "#d62728", "distance driven", TOP + 30.0)]
    {
        let _ = write!(
            svg,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"/>\
             <text x=\"{}\" y=\"{at}\" fill=\"{colour}\">{label}</text>",
            LEFT + 10.0
        );
    }
    if lit {
        let _ = write!(
            svg,
            "<path d=\"{light}\" fill=\"none\" stroke=\"#2ca02c\" stroke-width=\"1.5\"/>\
             <text x=\"{}\" y=\"{}\" fill=\"#2ca02c\">power of the laser</text>",
            LEFT + 10.0,
            LASER[0] - 4.0
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{end:.3} s</text></svg>",
        WIDTH - RIGHT,
        HEIGHT - 12.0
    );
    svg
}

/// A step line.
#[derive(Default)]
struct Steps {
    path: String,
    height: f64,
}

impl Steps {
    fn add(&mut self, x: f64, y: f64, is_last: bool) {
        if self.path.is_empty() {
            let _ = write!(self.path, "M{x:.1} {y:.1}");
        } else if (y - self.height).abs() > 1e-9 || is_last {
            let _ = write!(self.path, "H{x:.1}V{y:.1}");
        }
        self.height = y;
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
