//! The drawing operations that both file formats have.

/// A place on the canvas, from its upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point(pub f64, pub f64);

/// A part of the canvas.
#[derive(Clone, Copy, Debug)]
pub struct Rect {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// To the right.
    pub width: f64,
    /// Downwards.
    pub height: f64,
}

impl Rect {
    /// The right edge.
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    /// The lower edge.
    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }
}

/// Red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour(pub u8, pub u8, pub u8);

/// Text, and the most important lines.
pub const INK: Colour = Colour(0x1f, 0x29, 0x33);
/// Explanatory text.
pub const SOFT: Colour = Colour(0x6b, 0x77, 0x85);
/// Grid and frames.
pub const GRID: Colour = Colour(0xe4, 0xe8, 0xec);
/// The programmed contour.
pub const PROGRAMMED: Colour = Colour(0x9a, 0xa5, 0xb1);
/// The programmed feed.
pub const FEED: Colour = Colour(0x8f, 0xb8, 0xd8);
/// Limits.
pub const LIMIT: Colour = Colour(0xd6, 0x45, 0x45);
/// Events from outside.
pub const EVENT: Colour = Colour(0x7a, 0x4f, 0xa8);
/// Background of a standstill by events.
pub const HELD: Colour = Colour(0xf2, 0xb1, 0x34);
/// The axes of a machine.
const AXES: [Colour; 6] = [
    Colour(0x2b, 0x7a, 0xb8),
    Colour(0xe0, 0x8a, 0x1e),
    Colour(0x3a, 0x9d, 0x5d),
    Colour(0xb0, 0x4a, 0x8f),
    Colour(0x8a, 0x6d, 0x3b),
    Colour(0x4f, 0x5d, 0x9e),
];

/// The colour of the axis with this index.
pub fn axis_colour(axis: usize) -> Colour {
    AXES[axis % AXES.len()]
}

/// Style of a line.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// Its colour.
    pub colour: Colour,
    /// Its width.
    pub width: f64,
    /// 0…1.
    pub opacity: f64,
    /// Lengths of dash and gap.
    pub dash: Option<(f64, f64)>,
}

impl Stroke {
    /// A full line.
    pub const fn new(colour: Colour, width: f64) -> Self {
        Self { colour, width, opacity: 1.0, dash: None }
    }
}

/// Alignment of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// Style of a text.
#[derive(Clone, Copy, Debug)]
pub struct TextStyle {
    /// Font size.
    pub size: f64,
    /// Its colour.
    pub colour: Colour,
    /// Alignment.
    pub anchor: Anchor,
    /// Bold.
    pub bold: bool,
}

impl TextStyle {
    /// Small, from its start.
    pub const fn new(colour: Colour) -> Self {
        Self { size: 12.0, colour, anchor: Anchor::Start, bold: false }
    }
}

/// Width of the line of a ring.
pub const RING_WIDTH: f64 = 1.6;

/// A file format that can be drawn on.
pub trait Canvas {
    /// Connected lines.
    fn polyline(&mut self, points: &[Point], stroke: &Stroke) {
        self.polylines(std::slice::from_ref(&points.to_vec()), stroke);
    }
    /// Several connected lines with one style.
    fn polylines(&mut self, lines: &[Vec<Point>], stroke: &Stroke);
    /// A filled area without an edge.
    fn polygon(&mut self, points: &[Point], colour: Colour, opacity: f64);
    /// A filled rectangle.
    fn fill(&mut self, area: &Rect, colour: Colour, opacity: f64);
    /// A filled circle with a white rim.
    fn dot(&mut self, centre: Point, radius: f64, colour: Colour);
    /// A ring, which hides nothing.
    fn ring(&mut self, centre: Point, radius: f64, colour: Colour);
    /// Text with its base line at `at`.
    fn text(&mut self, at: Point, text: &str, style: &TextStyle);
    /// Clips the following operations to `area`, or ends the clipping.
    fn clip(&mut self, area: Option<&Rect>);
}
