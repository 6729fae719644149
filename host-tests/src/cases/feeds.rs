//! Straight paths with changing feeds, seeded, and the accepted times of their optima.
//!
//! | quantity | distribution |
//! |---|---|
//! | blocks | 5…300, evenly in orders of magnitude |
//! | length of a block | evenly in orders of magnitude between two lengths of the path: 0.05…2 mm and 2…20 mm |
//! | feed | begins evenly in orders of magnitude, 3 times of 4 changes by a factor, stays in its range |
//! | range of feeds | from 1200…9000 mm/min, evenly in orders of magnitude, to 18 000 mm/min |
//! | factor between feeds | evenly in orders of magnitude up to a largest factor of the path, 1.5…10, up or down |
//! | acceleration | 2000 mm/s², reached within 50 ms, for one path in four within 150 ms |
//!
//! Lengths are whole 0.1 µm and feeds whole mm/min, so that an NC program has exactly the same values.
use super::Program;
use super::random::Random;
use crate::reference::optimum::{Block, Limits};
use std::path::PathBuf;

/// Paths in the accepted table.
pub const PATHS: u64 = 200;
/// Acceleration, mm/s².
pub const ACCELERATION: f64 = 2000.0;

/// Ramp times, s; the second for one path in `LONG_RAMP`.
const RAMPS: [f64; 2] = [0.05, 0.15];
const LONG_RAMP: u64 = 4;
/// Range of numbers of blocks, end excluded.
const BLOCKS: [f64; 2] = [5.0, 301.0];
/// Ranges of the shortest and of the longest block, mm.
const SHORTEST: [f64; 2] = [0.05, 2.0];
const LONGEST: [f64; 2] = [2.0, 20.0];
/// Range of the lowest feed, and the highest one, mm/min.
const SLOWEST: [f64; 2] = [1200.0, 9000.0];
const FASTEST: f64 = 18_000.0;
/// Range of the largest factor between feeds; a feed stays once in `SAME` blocks.
const CHANGE: [f64; 2] = [1.5, 10.0];
const SAME: u64 = 4;
/// Lengths per millimetre.
const STEPS: f64 = 1e4;
/// Seed of path 0.
const SEED: u64 = 0x6665_6564_7300;

/// A straight path and its limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Feeds {
    /// Its blocks.
    pub blocks: Vec<Block>,
    /// Feed of every block, mm/min.
    pub feeds: Vec<f64>,
    /// Acceleration and jerk.
    pub limits: Limits,
    /// Ramp time, s.
    pub ramp: f64,
}

impl Feeds {
    /// The path with a number.
    pub fn new(number: u64) -> Self {
        let mut random = Random::new(SEED + number);
        let ramp = RAMPS[usize::from(random.once_in(LONG_RAMP))];
        let count = random.magnitude(BLOCKS[0], BLOCKS[1]) as usize;
        let shortest = random.magnitude(SHORTEST[0], SHORTEST[1]);
        let longest = random.magnitude(LONGEST[0], LONGEST[1]);
        let change = random.between(CHANGE[0], CHANGE[1]);
        let slowest = random.magnitude(SLOWEST[0], SLOWEST[1]);
        let mut feed = random.magnitude(slowest, FASTEST).round();
        let (mut blocks, mut feeds) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for _ in 0..count {
            if !random.once_in(SAME) {
                feed = (feed * random.magnitude(1.0 / change, change)).clamp(slowest, FASTEST).round();
            }
            let length = (random.magnitude(shortest, longest) * STEPS).round() / STEPS;
            blocks.push(Block { length, speed: feed / 60.0 });
            feeds.push(feed);
        }
        Self { blocks, feeds, limits: Limits::even(ACCELERATION, ramp), ramp }
    }

    /// The path along the first axis.
    pub fn program(&self, name: impl Into<String>, axes: usize) -> Program {
        let mut program = Program::new(name, axes);
        let mut at = 0_i64;
        for (block, &feed) in self.blocks.iter().zip(&self.feeds) {
            at += (block.length * STEPS).round() as i64;
            program = program.line(&[at as f64 / STEPS], feed);
        }
        program
    }
}

/// A row of the accepted table.
#[derive(Clone, Debug, PartialEq)]
pub struct Accepted {
    /// Number of the path.
    pub number: u64,
    /// Blocks.
    pub blocks: usize,
    /// Ramp time, s.
    pub ramp: f64,
    /// Length, mm.
    pub length: f64,
    /// Optimum, s: [`crate::reference::optimum::Optimum::time`].
    pub time: f64,
    /// Time with zero acceleration at every block end, s.
    pub at_borders: f64,
    /// Time with zero acceleration in valleys, s.
    pub in_valleys: f64,
}

/// First line of the table.
const TITLE: &str =
    "path,blocks,ramp_s,length_mm,optimum_s,zero_acceleration_at_borders_s,zero_acceleration_in_valleys_s";

/// Where the table is.
pub fn table() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tables/optimum.csv")
}

/// The accepted table.
///
/// # Errors
/// Says what cannot be read.
pub fn accepted() -> Result<Vec<Accepted>, String> {
    let text = std::fs::read_to_string(table()).map_err(|e| e.to_string())?;
    let mut lines = text.lines();
    if lines.next() != Some(TITLE) {
        return Err("another table".to_owned());
    }
    lines.map(|line| Accepted::parse(line).ok_or_else(|| line.to_owned())).collect()
}

/// The table as text.
pub fn write(rows: &[Accepted]) -> String {
    rows.iter().fold(format!("{TITLE}\n"), |text, row| text + &row.line() + "\n")
}

impl Accepted {
    fn line(&self) -> String {
        let Self { number, blocks, ramp, length, time, at_borders, in_valleys } = self;
        format!("{number},{blocks},{ramp},{length:.4},{time:.6},{at_borders:.6},{in_valleys:.6}")
    }

    fn parse(line: &str) -> Option<Self> {
        let fields: Vec<&str> = line.split(',').collect();
        let &[number, blocks, ramp, length, time, at_borders, in_valleys] = fields.as_slice() else {
            return None;
        };
        Some(Self {
            number: number.parse().ok()?,
            blocks: blocks.parse().ok()?,
            ramp: ramp.parse().ok()?,
            length: length.parse().ok()?,
            time: time.parse().ok()?,
            at_borders: at_borders.parse().ok()?,
            in_valleys: in_valleys.parse().ok()?,
        })
    }
}
