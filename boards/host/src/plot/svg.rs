//! Writes SVG as text.
use super::canvas::{Anchor, Canvas, Colour, Point, RING_WIDTH, Rect, Stroke, TextStyle};
use std::fmt::Write;

/// An SVG file in the making.
pub struct Svg {
    out: String,
    clips: usize,
    clipped: bool,
}

impl Svg {
    /// A white page.
    pub fn new(width: f64, height: f64) -> Self {
        let out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" font-family=\"DejaVu Sans, Verdana, Helvetica, Arial, sans-serif\" \
             stroke-linejoin=\"round\" stroke-linecap=\"round\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
        );
        Self { out, clips: 0, clipped: false }
    }

    /// The whole file.
    pub fn finish(mut self) -> Vec<u8> {
        self.clip(None);
        self.out.push_str("</svg>\n");
        self.out.into_bytes()
    }

    fn add(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = self.out.write_fmt(text);
    }
}

fn hex(Colour(red, green, blue): Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// A coordinate to a hundredth of a pixel, without unnecessary digits.
fn short(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Connected lines as path data: the first point, then steps. Each step starts at the rounded point before,
/// so that rounding errors do not add up.
fn run(data: &mut String, points: &[Point]) {
    // Hundredths of a pixel.
    let grid = |Point(x, y): Point| [x, y].map(|value| (value * 100.0).round() as i64);
    let mut last = [0; 2];
    for (index, &point) in points.iter().enumerate() {
        let at = grid(point);
        let step = [at[0] - last[0], at[1] - last[1]];
        if index > 1 && step == [0; 2] {
            continue;
        }
        match index {
            0 => data.push('M'),
            1 => data.push('l'),
            _ => {}
        }
        for (k, value) in step.into_iter().enumerate() {
            // A minus sign separates two numbers as well as a space does.
            if value >= 0 && (k > 0 || index > 1) {
                data.push(' ');
            }
            data.push_str(&short(value as f64 / 100.0));
        }
        last = at;
    }
}

impl Canvas for Svg {
    fn polylines(&mut self, lines: &[Vec<Point>], stroke: &Stroke) {
        let mut data = String::new();
        lines.iter().filter(|points| points.len() > 1).for_each(|points| run(&mut data, points));
        if data.is_empty() {
            return;
        }
        self.add(format_args!(
            "<path d=\"{data}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"",
            hex(stroke.colour),
            short(stroke.width)
        ));
        if stroke.opacity < 1.0 {
            self.add(format_args!(" stroke-opacity=\"{}\"", short(stroke.opacity)));
        }
        if let Some((dash, gap)) = stroke.dash {
            self.add(format_args!(" stroke-dasharray=\"{} {}\"", short(dash), short(gap)));
        }
        self.out.push_str("/>\n");
    }

    fn polygon(&mut self, points: &[Point], colour: Colour, opacity: f64) {
        if points.len() < 3 {
            return;
        }
        let mut data = String::new();
        run(&mut data, points);
        let (fill, opacity) = (hex(colour), short(opacity));
        self.add(format_args!("<path d=\"{data}z\" fill=\"{fill}\" fill-opacity=\"{opacity}\"/>\n"));
    }

    fn fill(&mut self, area: &Rect, colour: Colour, opacity: f64) {
        self.add(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" fill-opacity=\"{}\"/>\n",
            short(area.x),
            short(area.y),
            short(area.width),
            short(area.height),
            hex(colour),
            short(opacity)
        ));
    }

    fn dot(&mut self, Point(x, y): Point, radius: f64, colour: Colour) {
        self.add(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.5\"/>\n",
            short(x),
            short(y),
            short(radius),
            hex(colour)
        ));
    }

    fn ring(&mut self, Point(x, y): Point, radius: f64, colour: Colour) {
        self.add(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>\n",
            short(x),
            short(y),
            short(radius),
            hex(colour),
            short(RING_WIDTH)
        ));
    }

    fn text(&mut self, Point(x, y): Point, text: &str, style: &TextStyle) {
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if style.bold { " font-weight=\"bold\"" } else { "" };
        self.add(format_args!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{anchor}\" fill=\"{}\"{weight}>",
            short(x),
            short(y),
            short(style.size),
            hex(style.colour)
        ));
        for character in text.chars() {
            match character {
                '<' => self.out.push_str("&lt;"),
                '&' => self.out.push_str("&amp;"),
                '>' => self.out.push_str("&gt;"),
                // XML has no place for these, not even escaped.
                control if control.is_control() => self.out.push('\u{fffd}'),
                other => self.out.push(other),
            }
        }
        self.out.push_str("</text>\n");
    }

    fn clip(&mut self, area: Option<&Rect>) {
        if self.clipped {
            self.out.push_str("</g>\n");
            self.clipped = false;
        }
        if let Some(area) = area {
            self.clips += 1;
            let id = self.clips;
            self.add(format_args!(
                "<clipPath id=\"c{id}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n\
                 <g clip-path=\"url(#c{id})\">\n",
                short(area.x),
                short(area.y),
                short(area.width),
                short(area.height)
            ));
            self.clipped = true;
        }
    }
}
