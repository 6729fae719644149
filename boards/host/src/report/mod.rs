//! `--report`: a page that shows a run, in one file. A browser opens the page without a network.
//!
//! The page contains the summary, the program text, the programmed contour and every tick. Numbers are
//! columns of differences, compressed and in base64; the page adds the differences up.

mod tape;

use crate::files::Files;
use crate::machine::Machine;
use crate::program::Program;
use crate::statistics::Statistics;
use flate2::Compression;
use flate2::write::GzEncoder;
use glidepath::queue::Function;
use serde_json::{Value, json};
use std::io::Write;
pub use tape::{STEP, Tape};

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// The files share one scope and run in this order.
const SCRIPT: &str = concat!(
    "\"use strict\";\n(async () => {\n",
    include_str!("data.js"),
    include_str!("space.js"),
    include_str!("draw.js"),
    include_str!("turn.js"),
    include_str!("charts.js"),
    include_str!("lines.js"),
    include_str!("tables.js"),
    "})();\n"
);
const PLOT_STYLE: &str = include_str!("vendor/uPlot.min.css");
const PLOT_SCRIPT: &str = include_str!("vendor/uPlot.iife.min.js");
const PLOT_LICENCE: &str = include_str!("vendor/LICENSE-uPlot");

/// The data of the page.
pub struct Scene<'a> {
    pub files: &'a Files,
    pub machine: &'a Machine,
    pub program: &'a Program,
    pub statistics: &'a Statistics,
    pub tape: &'a Tape,
    /// The summary as JSON.
    pub summary: String,
}

/// The page, complete.
pub fn page(scene: &Scene<'_>) -> String {
    let mut columns = Columns::default();
    let facts = describe(scene, &mut columns);
    let text = scene.files.main.text.as_slice();
    let text = String::from_utf8_lossy(text);
    let facts = facts.to_string().replace('<', "\\u003c");
    // Each place holder is filled in one pass, so that inserted text is not searched again.
    let parts: [(&str, &str); 8] = [
        ("{{title}}", &escape(&scene.files.main.name)),
        ("{{plot-licence}}", &PLOT_LICENCE.replace("-->", "")),
        ("{{plot-style}}", PLOT_STYLE),
        ("{{style}}", STYLE),
        ("{{facts}}", &facts),
        ("{{data}}", &packed(&columns.bytes)),
        ("{{text}}", &packed(text.as_bytes())),
        ("{{plot-script}}", PLOT_SCRIPT),
    ];
    let mut page = String::new();
    let mut rest = TEMPLATE;
    for (mark, content) in parts {
        let Some((before, behind)) = rest.split_once(mark) else { continue };
        page.push_str(before);
        page.push_str(content);
        rest = behind;
    }
    page + &rest.replace("{{script}}", SCRIPT)
}

/// All data except columns; the columns go to `columns` in the order of `"columns"`.
fn describe(scene: &Scene<'_>, columns: &mut Columns) -> Value {
    let Scene { machine, program, statistics, tape, .. } = scene;
    let shown = program.shown_axes(machine);
    let name = |axis: &usize| machine.axes[*axis].name.as_str().to_owned();
    columns.differences("v", &tape.speed);
    for (k, axis) in machine.axes.iter().enumerate() {
        let name = axis.name.as_str();
        columns.differences(&format!("p{name}"), &tape.path[k]);
        if let Some(filtered) = tape.filtered.get(k) {
            columns.differences(&format!("f{name}"), filtered);
        }
        for (order, share) in tape.share[3 * k..3 * k + 3].iter().enumerate() {
            columns.shares(&format!("{}{name}", ["s", "a", "j"][order]), share);
        }
    }
    columns.numbers("entry", tape.entries.iter().map(|entry| entry[0]));
    columns.numbers("entered", tape.entries.iter().map(|entry| entry[1]));
    let steps = |value: f64| (value / STEP).round() as i32;
    let stretches = program.polylines(&shown);
    for dimension in 0..3 {
        let points = stretches.iter().flat_map(|stretch| &stretch.line).map(|point| steps(point[dimension]));
        columns.differences(["lx", "ly", "lz"][dimension], &points.collect::<Vec<_>>());
    }
    columns.numbers("stretch", stretches.iter().map(|stretch| stretch.line.len() as u32));
    columns.numbers("rapids", stretches.iter().map(|stretch| u32::from(stretch.rapid)));
    let motions: Vec<_> = program.motions().collect();
    for (dimension, &axis) in shown.iter().enumerate() {
        let ends: Vec<i32> = motions.iter().map(|motion| steps(motion.end[axis])).collect();
        columns.differences(["bx", "by", "bz"][dimension], &ends);
    }
    // Lines of called files are not in the shown text.
    let line = |place: glidepath::nc::Place| if place.file == 0 { place.line } else { 0 };
    columns.numbers("line", motions.iter().map(|motion| line(motion.place)));
    columns.numbers("n", motions.iter().map(|motion| motion.n));
    // Feed in µm/s, tolerance in 0.1 µm; 0: rapid motion, no tolerance.
    columns.numbers("feed", motions.iter().map(|m| m.feed.map_or(0, |feed| (feed / 0.06).round() as u32)));
    let tolerance =
        |m: &&crate::program::Segment| m.tolerance.path.filter(|_| m.smoothed).map_or(0, |t| steps(t) as u32);
    columns.numbers("tolerance", motions.iter().map(tolerance));
    let tools = statistics.functions.iter().filter_map(|done| match done.output.function {
        Function::Tool(tool) => Some(json!([done.tick / tape.stride, tool])),
        _ => None,
    });
    let mut summary: Value = serde_json::from_str(&scene.summary).unwrap_or_default();
    if let Some(summary) = summary.as_object_mut() {
        // One entry per block: the page has its own tables.
        summary.remove("plan");
        summary.remove("functions");
    }
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "columns": columns.names,
        "axes": machine.axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>(),
        "shown": shown.iter().map(name).collect::<Vec<_>>(),
        "moving": program.moving_axes(machine).iter().map(name).collect::<Vec<_>>(),
        "unit": if shown.iter().all(|&k| machine.axes[k].kind == glidepath::machine::AxisKind::Linear) { "mm" } else { "°" },
        "sample_s": machine.cycle_s() * tape.stride as f64,
        "stride": tape.stride,
        "tools": tools.collect::<Vec<_>>(),
        "summary": summary,
    })
}

/// Columns of numbers, one after the other, little-endian.
#[derive(Default)]
struct Columns {
    bytes: Vec<u8>,
    /// Name, kind (`i4` and `i2`: differences; `u4`: values), count.
    names: Vec<(String, &'static str, usize)>,
}

impl Columns {
    fn differences(&mut self, name: &str, values: &[i32]) {
        self.names.push((name.to_owned(), "i4", values.len()));
        let mut last = 0;
        for &value in values {
            self.bytes.extend(value.wrapping_sub(last).to_le_bytes());
            last = value;
        }
    }

    fn shares(&mut self, name: &str, values: &[i16]) {
        self.names.push((name.to_owned(), "i2", values.len()));
        let mut last = 0;
        for &value in values {
            self.bytes.extend(value.wrapping_sub(last).to_le_bytes());
            last = value;
        }
    }

    fn numbers(&mut self, name: &str, values: impl Iterator<Item = u32>) {
        let before = self.bytes.len();
        self.bytes.extend(values.flat_map(u32::to_le_bytes));
        self.names.push((name.to_owned(), "u4", (self.bytes.len() - before) / 4));
    }
}

/// Compressed (gzip), as text.
fn packed(bytes: &[u8]) -> String {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    // Writing to a vector cannot fail.
    let _ = encoder.write_all(bytes);
    base64(&encoder.finish().unwrap_or_default())
}

/// RFC 4648, with padding.
pub fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let [a, b, c] = [0, 1, 2].map(|i| u32::from(chunk.get(i).copied().unwrap_or(0)));
        let word = a << 16 | b << 8 | c;
        for (i, shift) in [18, 12, 6, 0].into_iter().enumerate() {
            let letter = LETTERS[(word >> shift & 63) as usize];
            text.push(if i <= chunk.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_rfc() {
        let all = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(|text| base64(text.as_bytes()));
        assert_eq!(all, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]);
    }

    #[test]
    fn the_template_has_every_mark_once_and_in_order() {
        let marks = [
            "title",
            "plot-licence",
            "plot-style",
            "style",
            "facts",
            "data",
            "text",
            "plot-script",
            "script",
        ];
        let found: Vec<&str> =
            TEMPLATE.split("{{").skip(1).filter_map(|part| part.split("}}").next()).collect();
        assert_eq!(found, marks);
        // No text ends a script early, and the page requests nothing from a network.
        for script in [SCRIPT, PLOT_SCRIPT] {
            assert!(!script.contains("</script"));
        }
        for text in [TEMPLATE, STYLE, SCRIPT, PLOT_STYLE] {
            assert!(!text.contains("http"), "{text}");
        }
    }
}
