//! A picture of a run: path, speed, acceleration and jerk.
//!
//! Left: the programmed path thin and grey, the driven path coloured by speed, and the places with the
//! largest deviation. Right: speed, acceleration and jerk over time, and the deviation over the path.

mod canvas;
mod chart;
mod events;
mod font;
mod insets;
mod path;
mod png;
mod record;
mod scale;
mod svg;

use crate::clock::clock;
use crate::diagnose::Source;
use crate::events::Event;
use crate::machine::{Machine, slope_name};
use crate::program::{Program, plural};
use crate::statistics::Statistics;
use canvas::{Anchor, Canvas, INK, Point, Rect, SOFT, TextStyle};
pub use record::Picture;
use std::path::PathBuf;

/// Where to draw to.
#[derive(Clone, Debug)]
pub struct Target {
    /// The file.
    pub path: PathBuf,
    /// Named by its extension.
    pub format: Format,
}

/// File formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Lines and text.
    Svg,
    /// Pixels.
    Png,
}

/// What a picture shows of the path: two of the axes shown, or all in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Plane {
    /// The first two axes.
    Xy,
    /// The first and the third axis.
    Xz,
    /// The second and the third axis.
    Yz,
    /// All three.
    Space,
}

/// The format of a file name.
pub fn parse_target(name: &str) -> Result<Target, String> {
    let path = PathBuf::from(name);
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
    let format = match extension.as_deref() {
        Some("svg") => Format::Svg,
        Some("png") => Format::Png,
        _ => return Err("the name must end in .svg or .png".into()),
    };
    Ok(Target { path, format })
}

const WIDTH: f64 = 1400.0;
const HEIGHT: f64 = 860.0;
/// The height with the row of deviation and the views of the largest deviations.
const TALL: f64 = 1120.0;
const MARGIN: f64 = 28.0;
const TOP: f64 = 100.0;

/// The data of the picture.
pub struct Scene<'a> {
    /// The machine, for names and limits.
    pub machine: &'a Machine,
    /// The programmed contour.
    pub program: &'a Program,
    /// The plan.
    pub statistics: &'a Statistics,
    /// The recorded data.
    pub picture: &'a Picture,
    /// The events from outside.
    pub events: &'a [Event],
    /// Requested planes; none: the planes with motion.
    pub planes: &'a [Plane],
}

/// Draws a run, as the bytes of a file.
pub fn draw(format: Format, source: &Source, scene: &Scene<'_>) -> Vec<u8> {
    let height = if insets::any(scene) { TALL } else { HEIGHT };
    match format {
        Format::Svg => {
            let mut canvas = svg::Svg::new(WIDTH, height);
            compose(&mut canvas, height, source, scene);
            canvas.finish()
        }
        Format::Png => {
            let mut canvas = png::Png::new(WIDTH, height);
            compose(&mut canvas, height, source, scene);
            canvas.finish()
        }
    }
}

fn compose(canvas: &mut dyn Canvas, height: f64, source: &Source, scene: &Scene<'_>) {
    let statistics = scene.statistics;
    let file = std::path::Path::new(&source.name).file_name().map(|name| name.to_string_lossy());
    let title = file.unwrap_or_else(|| source.name.as_str().into());
    canvas.text(Point(MARGIN, 40.0), &title, &TextStyle { size: 22.0, bold: true, ..TextStyle::new(INK) });
    let facts = format!(
        "{:.3} s{}  ·  {} block{}  ·  {:.1} {} of path  ·  {}  ·  cycle {} ms  ·  slope {}",
        statistics.time_s(scene.machine),
        clock(statistics.time_s(scene.machine)),
        statistics.blocks(),
        plural(statistics.blocks()),
        statistics.distance_mm(),
        scene.picture.unit,
        scene.machine.name,
        f64::from(scene.machine.channel.cycle_us) / 1e3,
        slope_name(scene.machine.slope()),
    );
    canvas.text(Point(MARGIN, 62.0), &facts, &TextStyle { size: 13.0, ..TextStyle::new(SOFT) });

    let left = Rect { x: MARGIN, y: TOP, width: 600.0, height: height - TOP - MARGIN };
    let below = if insets::any(scene) { insets::HEIGHT + 20.0 } else { 0.0 };
    path::draw(canvas, &Rect { height: left.height - below, ..left }, scene);
    let places = Rect { y: left.bottom() - insets::HEIGHT, height: insets::HEIGHT, ..left };
    insets::draw(canvas, &places, scene);
    let right = left.right() + 34.0;
    let charts = Rect { x: right, y: TOP, width: WIDTH - right - MARGIN, height: height - TOP - MARGIN };
    chart::draw(canvas, &charts, scene);
    let version = concat!("glidepath ", env!("CARGO_PKG_VERSION"));
    let style = TextStyle { size: 11.0, anchor: Anchor::End, ..TextStyle::new(SOFT) };
    canvas.text(Point(WIDTH - MARGIN, 40.0), version, &style);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::{Kind, Segment};
    use crate::statistics::Pause;
    use glidepath::nc::Place;
    use glidepath::quantity::{Accel, Position, Speed};
    use glidepath::tick::Telemetry;

    /// A square with one round side, run at constant speed: what matters here is that it can be drawn.
    fn scene(format: Format, ticks: u64, rounds: usize) -> Vec<u8> {
        transformed(format, (ticks, rounds), None)
    }

    /// The same, with a direction of the tool.
    fn transformed(format: Format, (ticks, rounds): (u64, usize), tool: Option<[f64; 3]>) -> Vec<u8> {
        let machine = Machine::built_in();
        let line = |x: f64, y: f64| Segment {
            n: 1,
            place: Place::default(),
            kind: Kind::Line,
            end: vec![x, y, 0.0],
            feed: Some(6000.0),
            stop: false,
            smoothed: false,
            tolerance: Default::default(),
            dynamics: 0,
        };
        let arc = Kind::Arc { plane: [0, 1], centre: [50.0, 100.0], clockwise: false };
        let segments = vec![
            line(100.0, 0.0),
            line(100.0, 100.0),
            Segment { kind: arc, ..line(0.0, 100.0) },
            Segment { feed: None, ..line(0.0, 0.0) },
        ];
        // Many more blocks than can be told apart, all over the picture.
        let rest = (0..rounds).map(|i| line((i * 37 % 101) as f64, (i * 59 % 103) as f64));
        let segments: Vec<Segment> = segments.into_iter().chain(rest).collect();
        let program = Program { motions: segments.len(), segments, ..Program::empty(&machine) };
        let rapid = program.motions().map(|segment| segment.feed.is_none()).collect();
        let mut statistics = Statistics::new(&[Position::ZERO; 3], 0);
        let mut picture =
            Picture::new(&machine, vec![0, 1, 2], vec![0, 1, 2], (Vec::new(), rapid), tool.is_some());
        for tick in 0..=ticks {
            let s = 400.0 * tick as f64 / ticks as f64;
            let at = match s {
                ..100.0 => [s, 0.0],
                ..200.0 => [100.0, s - 100.0],
                ..300.0 => [300.0 - s, 100.0 + ((s - 200.0) * (300.0 - s)).sqrt()],
                _ => [0.0, 400.0 - s],
            };
            let set_points = [at[0], at[1], s / 20.0].map(Position::from_num);
            let speed = (s * 0.04).sin().abs() * 0.1;
            let telemetry = Telemetry {
                n: 1,
                block: (s / 100.0).min(3.0) as u32,
                speed: Speed(speed.to_string().parse().unwrap_or_default()),
                accel: Accel(((s * 0.04).cos() * 0.001).to_string().parse().unwrap_or_default()),
                ..Telemetry::default()
            };
            statistics.add(&telemetry, &set_points, false, Pause::None);
            let tool = tool.as_ref().map(|tool| &tool[..]);
            picture.add(&telemetry, &set_points, (&statistics.axes, &[]), (machine.cycle_s(), tool));
        }
        let source = Source { name: "a & b.nc".into(), text: Vec::new() };
        let scene = Scene {
            machine: &machine,
            program: &program,
            statistics: &statistics,
            picture: &picture,
            events: &[],
            planes: &[],
        };
        draw(format, &source, &scene)
    }

    #[test]
    fn pictures_stay_small_however_long_the_run() {
        // A second, and an hour.
        let short = scene(Format::Svg, 1000, 0).len();
        let long = scene(Format::Svg, 3_600_000, 300_000).len();
        assert!(short > 10_000 && long < 2_000_000, "{short} {long}");
    }

    /// The last side of the square is rapid motion.
    #[test]
    fn rapid_motion_is_dashed_and_named() {
        let svg = String::from_utf8(scene(Format::Svg, 4000, 0)).unwrap_or_default();
        assert!(svg.contains(">rapid</text>") && svg.contains("stroke-dasharray=\"4 3\""));
    }

    /// Under a transformation strokes show the tool, and a row the speed of the axes.
    #[test]
    fn a_transformation_shows_the_tool_and_axis_speeds() {
        let svg = |tool| String::from_utf8(transformed(Format::Svg, (4000, 0), tool)).unwrap_or_default();
        let (without, with) = (svg(None), svg(Some([0.6, 0.0, 0.8])));
        assert!(!without.contains(">tool</text>") && !without.contains(">Axis speed</text>"));
        assert!(with.contains(">tool</text>") && with.contains(">Axis speed</text>"));
        assert!(!with.contains("NaN") && !with.contains("inf"));
        // Seen along the tool there is nothing to draw.
        let strokes = |svg: &str| svg.matches("#4f7a8c").count();
        assert_eq!((strokes(&without), strokes(&with) > 1), (0, true));
    }

    #[test]
    fn svg_escapes_and_closes_what_it_opens() {
        let svg = String::from_utf8(scene(Format::Svg, 4000, 0)).unwrap_or_default();
        assert!(svg.contains(">a &amp; b.nc</text>") && svg.ends_with("</svg>\n"));
        assert_eq!(svg.matches("<g ").count(), svg.matches("</g>").count());
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn png_shows_all_colours_of_the_speed_scale() {
        let bytes = scene(Format::Png, 4000, 0);
        if let Some(path) = std::env::var_os("GLIDEPATH_SHOW") {
            std::fs::write(path, &bytes).unwrap_or_default();
        }
        let pixels = tiny_skia::Pixmap::decode_png(&bytes).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((pixels.width(), pixels.height()), (2800, 1720));
        let colours: std::collections::HashSet<u32> =
            pixels.pixels().iter().map(|p| u32::from_be_bytes([0, p.red(), p.green(), p.blue()])).collect();
        assert!(colours.len() > 200, "{}", colours.len());
    }
}
