//! The two programs of a CAM system that measure short blocks, as text with a selectable head.
//!
//! A head switches smoothing on, for example `#CONTOUR MODE [DEV PATH_DEV=0.02]` and `G261`, each on one
//! line. The head stands after the first lines and before the first motion. Without a head every corner stays
//! sharp.
use std::fmt::Write;

/// Radius of [`circle`], and length of the lines before and after it, mm.
pub const RADIUS: f64 = 80.0;
/// Chords of [`circle`].
pub const CHORDS: u32 = 64;
/// Feed of [`circle`], mm/min.
pub const CIRCLE_FEED: f64 = 20_000.0;
/// Segments of [`rows`].
pub const SEGMENTS: usize = 5000;
/// Feed of [`rows`], mm/min.
pub const ROWS_FEED: f64 = 6000.0;
/// Length of a row, mm.
pub const ROW: f64 = 60.0;
/// Distance between rows, mm.
pub const STEP: f64 = 0.3;
/// Shortest and longest segment of a row, mm.
pub const SEGMENT: [f64; 2] = [0.05, 0.5];

/// A circle of 64 chords with a tangential line of 80 mm before and after the circle. The program begins at
/// X0 Y0.
pub fn circle(head: &str) -> String {
    let mut program = Lines::begin("circle", head, CIRCLE_FEED);
    program.line(&format!("X{RADIUS} Y0"));
    for chord in 1..CHORDS {
        let angle = std::f64::consts::TAU * f64::from(chord) / f64::from(CHORDS);
        let (x, y) = (RADIUS * (1.0 + angle.sin()), RADIUS * (1.0 - angle.cos()));
        program.line(&format!("X{x:.6} Y{y:.6}"));
    }
    program.line(&format!("X{RADIUS} Y0"));
    program.line(&format!("X{}", 2.0 * RADIUS));
    program.end()
}

/// A surface in rows of 60 mm, to and fro: 5,000 segments, z = 5 sin(x/10) cos(y/10), rounded to 0.001 mm.
pub fn rows(head: &str) -> String {
    rows_of(SEGMENTS, head)
}

/// [`rows`] with another number of segments. Their lengths are drawn evenly from [`SEGMENT`] by a fixed seed.
pub fn rows_of(segments: usize, head: &str) -> String {
    let mut program = Lines::begin("rows", head, ROWS_FEED);
    let (mut x, mut y, mut forward, mut seed) = (0.0, 0.0, true, 1);
    for _ in 0..segments {
        let end = if forward { ROW } else { 0.0 };
        if x == end {
            y += STEP;
            forward = !forward;
        } else {
            let stretch = f64::hypot(1.0, 0.5 * f64::cos(x / 10.0) * f64::cos(y / 10.0));
            let [shortest, longest] = SEGMENT;
            let length = shortest + (longest - shortest) * draw(&mut seed);
            // The last segment of a row has a length within the same range.
            let left = (end - x).abs() * stretch;
            x = if left > length + shortest {
                x + length / stretch * f64::signum(end - x)
            } else if left > longest {
                x + (end - x) / 2.0
            } else {
                end
            };
        }
        let z = 5.0 * f64::sin(x / 10.0) * f64::cos(y / 10.0);
        program.line(&format!("X{x:.3} Y{y:.3} Z{z:.3}"));
    }
    program.end()
}

/// Evenly in 0…1: SplitMix64, Steele, Lea and Flood 2014.
fn draw(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut mixed = *seed;
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^= mixed >> 31;
    (mixed >> 11) as f64 / (1_u64 << 53) as f64
}

/// A text with numbered lines.
struct Lines {
    text: String,
    n: u32,
}

impl Lines {
    fn begin(name: &str, head: &str, feed: f64) -> Self {
        let mut lines = Self { text: format!("%{name}\n"), n: 0 };
        lines.line("G90 G17 G00 X0 Y0 Z0");
        for line in head.lines() {
            lines.line(line);
        }
        lines.line(&format!("G01 F{feed}"));
        lines
    }

    fn line(&mut self, words: &str) {
        self.n += 10;
        let _ = writeln!(self.text, "N{} {words}", self.n);
    }

    fn end(mut self) -> String {
        self.line("M30");
        self.text
    }
}
