//! A picture of a run: where it went, how fast, how smoothly.
//!
//! Left the path, programmed thin and grey, moved coloured by speed; right speed, acceleration and jerk over time.

mod canvas;
mod chart;
mod path;
mod png;
mod record;
mod scale;
mod svg;

use crate::diagnose::Source;
use crate::machine::Machine;
use crate::program::Program;
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
const MARGIN: f64 = 28.0;
const TOP: f64 = 84.0;

/// What there is to show.
pub struct Scene<'a> {
    /// The machine, for names and limits.
    pub machine: &'a Machine,
    /// The programmed contour.
    pub program: &'a Program,
    /// The plan.
    pub statistics: &'a Statistics,
    /// What was recorded.
    pub picture: &'a Picture,
}

/// Draws a run, as the bytes of a file.
pub fn draw(format: Format, source: &Source, scene: &Scene<'_>) -> Vec<u8> {
    match format {
        Format::Svg => {
            let mut canvas = svg::Svg::new(WIDTH, HEIGHT);
            compose(&mut canvas, source, scene);
            canvas.finish()
        }
        Format::Png => {
            let mut canvas = png::Png::new(WIDTH, HEIGHT);
            compose(&mut canvas, source, scene);
            canvas.finish()
        }
    }
}

fn compose(canvas: &mut dyn Canvas, source: &Source, scene: &Scene<'_>) {
    let statistics = scene.statistics;
    let file = std::path::Path::new(&source.name).file_name().map(|name| name.to_string_lossy());
    let title = file.unwrap_or_else(|| source.name.as_str().into());
    canvas.text(Point(MARGIN, 40.0), &title, &TextStyle { size: 22.0, bold: true, ..TextStyle::new(INK) });
    let facts = format!(
        "{:.3} s  ·  {} blocks  ·  {:.1} mm of path  ·  {}  ·  cycle {} ms",
        statistics.time_s(scene.machine),
        statistics.blocks.len(),
        statistics.distance_mm(),
        scene.machine.name,
        f64::from(scene.machine.channel.cycle_us) / 1e3,
    );
    canvas.text(Point(MARGIN, 62.0), &facts, &TextStyle { size: 13.0, ..TextStyle::new(SOFT) });

    let path_area = Rect { x: MARGIN, y: TOP, width: 600.0, height: HEIGHT - TOP - MARGIN };
    path::draw(canvas, &path_area, scene);
    let left = MARGIN + path_area.width + 34.0;
    let charts = Rect { x: left, y: TOP, width: WIDTH - left - MARGIN, height: HEIGHT - TOP - MARGIN };
    chart::draw(canvas, &charts, scene);
    let version = concat!("glidepath ", env!("CARGO_PKG_VERSION"));
    let style = TextStyle { size: 11.0, anchor: Anchor::End, ..TextStyle::new(SOFT) };
    canvas.text(Point(WIDTH - MARGIN, 40.0), version, &style);
}
