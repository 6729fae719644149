//! Programs with a name, for tables and the documents.
use super::Program;
use std::f64::consts::TAU;

/// Distances of the rest-to-rest moves, mm.
pub const REST_TO_REST: [f64; 6] = [0.01, 0.1, 1.0, 10.0, 100.0, 1000.0];

/// One line along X.
pub fn one_line(length: f64, feed: f64, axes: usize) -> Program {
    Program::new(format!("line {length} mm"), axes).line(&[length], feed)
}

/// A circle of radius 80 mm in 64 chords, 80 mm straight in and out along its tangent.
pub fn chords(feed: f64, axes: usize) -> Program {
    let mut program = Program::new("circle of 64 chords", axes).line(&[80.0], feed);
    for i in 1..=64 {
        let angle = TAU * f64::from(i) / 64.0;
        program = program.line(&[80.0 + 80.0 * angle.sin(), 80.0 - 80.0 * angle.cos()], feed);
    }
    program.line(&[160.0, 0.0], feed)
}

/// The same circle as one arc.
pub fn circle(feed: f64, axes: usize) -> Program {
    Program::new("circle", axes)
        .line(&[80.0, 0.0], feed)
        .arc(&[80.0, 0.0], [0.0, 80.0], false, feed)
        .line(&[160.0, 0.0], feed)
}

/// A square with edges of 80 mm.
pub fn square(feed: f64, axes: usize) -> Program {
    Program::new("square", axes)
        .line(&[80.0, 0.0], feed)
        .line(&[80.0, 80.0], feed)
        .line(&[0.0, 80.0], feed)
        .line(&[0.0, 0.0], feed)
}

/// A slot: two half circles and two straight lines, tangential.
pub fn slot(feed: f64, axes: usize) -> Program {
    Program::new("slot", axes)
        .line(&[60.0, 0.0], feed)
        .arc(&[60.0, 30.0], [0.0, 15.0], false, feed)
        .line(&[0.0, 30.0], feed)
        .arc(&[0.0, 0.0], [0.0, -15.0], false, feed)
}

/// Three turns of a helix, 5 mm down each, then a rapid back up.
pub fn helix(feed: f64) -> Program {
    let mut program = Program::new("helix", 3);
    for turn in 1..=3 {
        program = program.arc(&[0.0, 0.0, -5.0 * f64::from(turn)], [12.0, 0.0], true, feed);
    }
    program.line(&[0.0, 0.0, 0.0], feed).rapid()
}

/// A pocket: a rectangular spiral from the outside in, with a rapid to the start and a plunge.
pub fn pocket(feed: f64) -> Program {
    let mut program =
        Program::new("pocket", 3).line(&[5.0, 5.0, 10.0], feed).rapid().line(&[5.0, 5.0, -2.0], 600.0).stop();
    let (mut low, mut high) = ([5.0, 5.0], [75.0, 55.0]);
    while low[0] + 4.0 < high[0] && low[1] + 4.0 < high[1] {
        program = program.line(&[high[0], low[1]], feed).line(&high, feed).line(&[low[0], high[1]], feed);
        low = low.map(|x| x + 4.0);
        high = high.map(|x| x - 4.0);
        program = program.line(&[low[0] - 4.0, low[1]], feed).line(&low, feed);
    }
    program.line(&[low[0], low[1], 10.0], feed).rapid()
}

/// A straight line in `blocks` short pieces.
pub fn pieces(blocks: u32, pitch: f64, feed: f64) -> Program {
    let points = (1..=blocks).map(|i| pitch * f64::from(i));
    points.fold(Program::new(format!("line in {blocks} pieces"), 3), |p, x| p.line(&[x, x / 2.0], feed))
}

/// A wavy line of `blocks` chords, ten chords a wave.
pub fn wave(blocks: u32, pitch: f64, feed: f64) -> Program {
    let mut program = Program::new(format!("wave of {blocks} chords"), 3);
    for i in 1..=blocks {
        let phase = TAU * f64::from(i) / 40.0;
        program = program.line(&[pitch * f64::from(i), 2.0 * pitch * phase.sin()], feed);
    }
    program
}
