//! Programs and machines to run: named ones, edges, and seeded random ones.
//!
//! A [`Program`] is data. It can be written as NC text for the library, gives the exact contour for the
//! checker, and can be mirrored, turned or reversed. Coordinates are integers in nanometres (10^-6 degrees),
//! so the decimals in the text equal the numbers of the checker.

pub mod knees;
pub mod machines;

pub mod edges;

pub mod named;

pub mod random;

pub mod feeds;

use crate::reference::geometry::{Centre, Contour, Element, Shape, arc};
use glidepath::machine::MachineData;
use std::fmt::Write;

/// Nanometres per millimetre.
pub const NM: i64 = 1_000_000;

/// The plane of an arc, as programmed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// G17.
    Xy,
    /// G18.
    Zx,
    /// G19.
    Yz,
}

impl Plane {
    /// Main axes of the plane, in the sense of rotation.
    pub fn axes(self) -> [usize; 2] {
        match self {
            Self::Xy => [0, 1],
            Self::Zx => [2, 0],
            Self::Yz => [1, 2],
        }
    }
}

/// How an arc is programmed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum By {
    /// Offset from the start to the centre, in the plane's axes, nm.
    Offset([i64; 2]),
    /// Radius, nm.
    Radius(i64),
}

/// G word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// G00.
    Rapid,
    /// G01.
    Line,
    /// G02 or G03.
    Arc {
        /// Plane.
        plane: Plane,
        /// G02.
        clockwise: bool,
        /// Centre.
        by: By,
    },
}

/// One motion block, to an absolute target.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// G word.
    pub kind: Kind,
    /// End point of every axis, nm.
    pub target: Vec<i64>,
    /// Feed, mm/min.
    pub feed: f64,
    /// G60.
    pub stop: bool,
}

/// A program for the machine it was made for.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// Name for messages and tables.
    pub name: String,
    /// Start point of every axis, nm.
    pub start: Vec<i64>,
    /// Motion blocks.
    pub moves: Vec<Move>,
    /// NO_OPT=0, with HSC.
    pub optimised: bool,
}

impl Program {
    /// An empty program that starts at zero.
    pub fn new(name: impl Into<String>, axes: usize) -> Self {
        Self { name: name.into(), start: vec![0; axes], moves: Vec::new(), optimised: false }
    }

    /// Where the last block ends.
    pub fn end(&self) -> &[i64] {
        self.moves.last().map_or(&self.start, |m| &m.target)
    }

    /// Appends a line to `target` (mm) of the first axes; the others stay.
    pub fn line(mut self, target: &[f64], feed: f64) -> Self {
        let mut to = self.end().to_vec();
        for (to, mm) in to.iter_mut().zip(target) {
            *to = (mm * NM as f64).round() as i64;
        }
        self.moves.push(Move { kind: Kind::Line, target: to, feed, stop: false });
        self
    }

    /// Appends an arc in the XY plane to `target` (mm) about the centre at `offset` (mm) from its start.
    pub fn arc(mut self, target: &[f64], offset: [f64; 2], clockwise: bool, feed: f64) -> Self {
        self = self.line(target, feed);
        let by = By::Offset(offset.map(|mm| (mm * NM as f64).round() as i64));
        if let Some(last) = self.moves.last_mut() {
            last.kind = Kind::Arc { plane: Plane::Xy, clockwise, by };
        }
        self
    }

    /// Turns the last block into a rapid one.
    pub fn rapid(mut self) -> Self {
        if let Some(last) = self.moves.last_mut() {
            last.kind = Kind::Rapid;
        }
        self
    }

    /// Stops exactly after the last block.
    pub fn stop(mut self) -> Self {
        if let Some(last) = self.moves.last_mut() {
            last.stop = true;
        }
        self
    }

    /// NC text: absolute coordinates, relative centres, every word written out.
    pub fn text<const AXES: usize>(&self, machine: &MachineData<AXES>) -> String {
        let mut text = String::from("%case\nN1 G90\n");
        if self.optimised && machine.channel.slope_profile == 3 {
            text.push_str("N2 #SLOPE [TYPE=HSC NO_OPT=0]\n");
        }
        let mut plane = Plane::Xy;
        for (i, block) in self.moves.iter().enumerate() {
            let n = 10 * (i + 1);
            if let Kind::Arc { plane: wanted, .. } = block.kind
                && wanted != plane
            {
                plane = wanted;
                let word = match plane {
                    Plane::Xy => "G17",
                    Plane::Zx => "G18",
                    Plane::Yz => "G19",
                };
                let _ = writeln!(text, "N{} {word}", n - 5);
            }
            let _ = write!(text, "N{n}");
            if block.stop {
                text.push_str(" G60");
            }
            text.push_str(match block.kind {
                Kind::Rapid => " G00",
                Kind::Line => " G01",
                Kind::Arc { clockwise: true, .. } => " G02",
                Kind::Arc { clockwise: false, .. } => " G03",
            });
            for (axis, &nm) in machine.axes.iter().zip(&block.target) {
                let _ = write!(text, " {}{}", axis.name.as_str(), decimal(nm));
            }
            match block.kind {
                Kind::Arc { by: By::Radius(r), .. } => {
                    let _ = write!(text, " R{}", decimal(r));
                }
                Kind::Arc { by: By::Offset(offset), plane, .. } => {
                    for (axis, nm) in plane.axes().into_iter().zip(offset) {
                        let _ = write!(text, " {}{}", ["I", "J", "K"][axis], decimal(nm));
                    }
                }
                _ => {}
            }
            if block.kind != Kind::Rapid {
                let _ = write!(text, " F{}", block.feed);
            }
            text.push('\n');
        }
        text.push_str("M30\n");
        text
    }

    /// The contour in f64. Blocks without motion are left out.
    pub fn contour<const AXES: usize>(&self, machine: &MachineData<AXES>) -> Contour {
        self.contour_of(machine, |nm| nm as f64 / NM as f64)
    }

    /// The contour after the decoder: coordinates rounded to 2^-32 mm. For comparisons that ignore this
    /// rounding (which turns a line of 1 µm by 10^-7).
    pub fn contour_as_decoded<const AXES: usize>(&self, machine: &MachineData<AXES>) -> Contour {
        self.contour_of(machine, |nm| set_point(nm) as f64 / (1u64 << 32) as f64)
    }

    fn contour_of<const AXES: usize>(
        &self,
        machine: &MachineData<AXES>,
        number: impl Fn(i64) -> f64,
    ) -> Contour {
        let main: Vec<usize> = machine.main_axes().into_iter().flatten().collect();
        let named: Vec<usize> = (0..AXES).filter(|&k| machine.axes[k].default_feed_axis).collect();
        let feed_axes = if named.is_empty() { main.clone() } else { named };
        let mm = |p: &[i64]| -> Vec<f64> { p.iter().map(|&nm| number(nm)).collect() };
        let mut from = self.start.clone();
        let mut elements: Vec<Element> = Vec::new();
        for block in &self.moves {
            let (a, b) = (mm(&from), mm(&block.target));
            let shape = match block.kind {
                Kind::Rapid | Kind::Line => Shape::Line,
                Kind::Arc { plane, clockwise, by } => {
                    let axes = plane.axes().map(|k| main[k]);
                    let centre = match by {
                        By::Offset(nm) => Centre::Offset(nm.map(&number)),
                        By::Radius(nm) => Centre::Radius(number(nm)),
                    };
                    arc(axes, axes.map(|k| a[k]), axes.map(|k| b[k]), centre, clockwise)
                }
            };
            if shape != Shape::Line || a != b {
                elements.push(Element {
                    shape,
                    from: a,
                    to: b,
                    feed: (block.kind != Kind::Rapid).then_some(block.feed),
                    stop: block.stop,
                    main: main.clone(),
                    feed_axes: feed_axes.clone(),
                    blocks: 1,
                    long: false,
                });
            } else if block.stop
                && let Some(last) = elements.last_mut()
            {
                last.stop = true;
            }
            from.clone_from(&block.target);
        }
        Contour { start: mm(&self.start), elements }
    }

    /// Set points of all block ends that move, as the library must reach them.
    pub fn end_points(&self) -> Vec<(Vec<i64>, bool)> {
        let mut points: Vec<(Vec<i64>, bool)> = Vec::new();
        let mut from = &self.start;
        for block in &self.moves {
            let moves = block.target != *from || matches!(block.kind, Kind::Arc { .. });
            if moves {
                points.push((block.target.iter().map(|&nm| set_point(nm)).collect(), block.stop));
            } else if block.stop
                && let Some(last) = points.last_mut()
            {
                last.1 = true;
            }
            from = &block.target;
        }
        points
    }

    /// The mirrored program: `axis` has the opposite sign. Arcs in a plane with this axis turn the other way.
    pub fn mirrored(&self, axis: usize) -> Self {
        self.mapped(
            "mirrored",
            |p| p[axis] = -p[axis],
            |plane, offset| {
                let axes = plane.axes();
                for (o, a) in offset.iter_mut().zip(axes) {
                    if a == axis {
                        *o = -*o;
                    }
                }
                axes.contains(&axis)
            },
        )
    }

    /// Turned by 90° in the XY plane: X goes to Y, Y to -X. Only for arcs in that plane.
    pub fn turned(&self) -> Self {
        self.mapped(
            "turned",
            |p| (p[0], p[1]) = (-p[1], p[0]),
            |_, o| {
                *o = [-o[1], o[0]];
                false
            },
        )
    }

    /// The same contour from its end to its start. An exact stop stays at its point.
    pub fn reversed(&self) -> Self {
        let mut points = vec![self.start.clone()];
        points.extend(self.moves.iter().map(|m| m.target.clone()));
        let count = self.moves.len();
        let moves = (0..count).rev().map(|i| {
            let block = &self.moves[i];
            let mut kind = block.kind;
            if let Kind::Arc { plane, clockwise, by } = &mut kind {
                *clockwise = !*clockwise;
                if let By::Offset(offset) = by {
                    for (o, a) in offset.iter_mut().zip(plane.axes()) {
                        *o += points[i][a] - points[i + 1][a];
                    }
                }
            }
            let stop = i > 0 && self.moves[i - 1].stop;
            Move { kind, target: points[i].clone(), feed: block.feed, stop }
        });
        Self {
            name: format!("{} reversed", self.name),
            start: self.end().to_vec(),
            moves: moves.collect(),
            ..self.clone()
        }
    }

    fn mapped(
        &self,
        how: &str,
        point: impl Fn(&mut Vec<i64>),
        offset: impl Fn(Plane, &mut [i64; 2]) -> bool,
    ) -> Self {
        let mut out = self.clone();
        out.name = format!("{} {how}", self.name);
        point(&mut out.start);
        for block in &mut out.moves {
            point(&mut block.target);
            if let Kind::Arc { plane, clockwise, by } = &mut block.kind {
                let mut o = if let By::Offset(o) = by { *o } else { [0; 2] };
                *clockwise ^= offset(*plane, &mut o);
                if let By::Offset(out) = by {
                    *out = o;
                }
            }
        }
        out
    }
}

/// A decimal of six places without an exponent.
pub fn decimal(nm: i64) -> String {
    let (sign, nm) = (if nm < 0 { "-" } else { "" }, nm.unsigned_abs());
    let (mm, rest) = (nm / NM as u64, nm % NM as u64);
    if rest == 0 {
        return format!("{sign}{mm}");
    }
    format!("{sign}{mm}.{rest:06}").trim_end_matches('0').to_owned()
}

/// The set point nearest to a decimal, ties away from zero, in units of 2^-32 mm.
pub fn set_point(nm: i64) -> i64 {
    let scaled = (i128::from(nm.unsigned_abs()) << 32) + i128::from(NM / 2);
    (scaled / i128::from(NM)) as i64 * nm.signum()
}
