//! PNG: drawn by tiny-skia at twice the size, letters from the outlines of a font that is compiled in.
use super::canvas::{Anchor, Canvas, Colour, Point, RING_WIDTH, Rect, Stroke, TextStyle};
use super::font::Font;
use tiny_skia::{FillRule, LineCap, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};
use ttf_parser::OutlineBuilder;

/// Pixels per unit of length.
const SCALE: f32 = 2.0;

/// A PNG file in the making.
pub struct Png {
    pixels: Pixmap,
    mask: Option<Mask>,
}

impl Png {
    /// A white page.
    pub fn new(width: f64, height: f64) -> Self {
        let size = |length: f64| (length as f32 * SCALE) as u32;
        let mut pixels = Pixmap::new(size(width), size(height)).expect("the page has a size");
        pixels.fill(tiny_skia::Color::WHITE);
        Self { pixels, mask: None }
    }

    /// The whole file.
    pub fn finish(self) -> Vec<u8> {
        self.pixels.encode_png().expect("a page in memory can be encoded")
    }

    fn fill_path(&mut self, path: &Path, colour: Colour, opacity: f64) {
        let transform = Transform::from_scale(SCALE, SCALE);
        self.pixels.fill_path(
            path,
            &paint(colour, opacity),
            FillRule::Winding,
            transform,
            self.mask.as_ref(),
        );
    }
}

fn paint(Colour(red, green, blue): Colour, opacity: f64) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, (opacity.clamp(0.0, 1.0) * 255.0).round() as u8);
    paint
}

fn rect(area: &Rect) -> Option<Path> {
    let rect =
        tiny_skia::Rect::from_xywh(area.x as f32, area.y as f32, area.width as f32, area.height as f32)?;
    Some(PathBuilder::from_rect(rect))
}

fn trace(builder: &mut PathBuilder, points: &[Point]) {
    for (index, &Point(x, y)) in points.iter().enumerate() {
        match index {
            0 => builder.move_to(x as f32, y as f32),
            _ => builder.line_to(x as f32, y as f32),
        }
    }
}

impl Canvas for Png {
    fn polylines(&mut self, lines: &[Vec<Point>], stroke: &Stroke) {
        let mut builder = PathBuilder::new();
        for points in lines {
            trace(&mut builder, points);
        }
        let Some(path) = builder.finish() else { return };
        let dash = stroke.dash.and_then(|(dash, gap)| StrokeDash::new(vec![dash as f32, gap as f32], 0.0));
        let line = tiny_skia::Stroke {
            width: stroke.width as f32,
            line_cap: if dash.is_some() { LineCap::Butt } else { LineCap::Round },
            line_join: LineJoin::Round,
            dash,
            ..tiny_skia::Stroke::default()
        };
        let transform = Transform::from_scale(SCALE, SCALE);
        let paint = paint(stroke.colour, stroke.opacity);
        self.pixels.stroke_path(&path, &paint, &line, transform, self.mask.as_ref());
    }

    fn polygon(&mut self, points: &[Point], colour: Colour, opacity: f64) {
        let mut builder = PathBuilder::new();
        trace(&mut builder, points);
        builder.close();
        if let Some(path) = builder.finish() {
            self.fill_path(&path, colour, opacity);
        }
    }

    fn fill(&mut self, area: &Rect, colour: Colour, opacity: f64) {
        if let Some(path) = rect(area) {
            self.fill_path(&path, colour, opacity);
        }
    }

    fn dot(&mut self, Point(x, y): Point, radius: f64, colour: Colour) {
        for (radius, colour) in [(radius + 0.75, Colour(255, 255, 255)), (radius - 0.75, colour)] {
            if let Some(path) = PathBuilder::from_circle(x as f32, y as f32, radius as f32) {
                self.fill_path(&path, colour, 1.0);
            }
        }
    }

    fn ring(&mut self, Point(x, y): Point, radius: f64, colour: Colour) {
        let Some(path) = PathBuilder::from_circle(x as f32, y as f32, radius as f32) else { return };
        let line = tiny_skia::Stroke { width: RING_WIDTH as f32, ..tiny_skia::Stroke::default() };
        let (transform, paint) = (Transform::from_scale(SCALE, SCALE), paint(colour, 1.0));
        self.pixels.stroke_path(&path, &paint, &line, transform, self.mask.as_ref());
    }

    fn text(&mut self, Point(x, y): Point, text: &str, style: &TextStyle) {
        let font = Font::new(style.size, style.bold);
        let glyphs = font.glyphs(text);
        let width: f32 = glyphs.iter().map(|(_, width)| width).sum();
        let shift = match style.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => width / 2.0,
            Anchor::End => width,
        };
        let (x, scale) = (x as f32 - shift, font.scale());
        let mut outline = Outline { path: PathBuilder::new(), x, y: y as f32, scale };
        for (glyph, width) in glyphs {
            font.outline(glyph, &mut outline);
            outline.x += width;
        }
        if let Some(path) = outline.path.finish() {
            self.fill_path(&path, style.colour, 1.0);
        }
    }

    fn clip(&mut self, area: Option<&Rect>) {
        self.mask = area.and_then(|area| {
            let mut mask = Mask::new(self.pixels.width(), self.pixels.height())?;
            mask.fill_path(&rect(area)?, FillRule::Winding, true, Transform::from_scale(SCALE, SCALE));
            Some(mask)
        });
    }
}

/// Maps glyph outlines to their place: font units go up, the page goes down.
struct Outline {
    path: PathBuilder,
    x: f32,
    y: f32,
    scale: f32,
}

impl Outline {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + x * self.scale, self.y - y * self.scale)
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}
