//! Divides a curve of tool tip and angles into cells. In a cell, each axis moves along a polynomial of the
//! fifth degree over path distance. Each call makes one cell.
//!
//! The inverse transformation and the chain rule give position, direction and curvature at the ends of a
//! cell. All cells of a curve have equal length; [`super::bound`] computes their number. The coefficients are
//! integers, LSB 2^-42 mm or degrees. The linear coefficient makes the end exact to the last bit, so two
//! neighbours meet exactly.
use super::bound::stray;
use super::chain::{AXES, Chain, ROTARIES};
use super::vector::{Jet, RADIANS, Spin, Vector, nearest, number, position};
use crate::math::wide::mul_shift;
use crate::quantity::Position;
use core::fmt;

/// Largest deviation of the tool tip from its curve between the ends of a cell, mm. [`super::bound`]
/// guarantees this value.
pub const TIP_ERROR: f64 = 5e-6;
/// Part of [`TIP_ERROR`] for the rounding of ends, angles and coefficients, for machines up to 10 m, mm.
const ROUNDING: f64 = 0.5e-6;
/// Largest number of cells of a curve.
pub const MOST_CELLS: u32 = 1 << 16;

/// A curve in workpiece coordinates: tool tip, rotary axes, and other axes. Each polynomial is a function of
/// the fraction (0 to 1) of the path distance. The constant coefficient is the first one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// Polynomial of the tool tip, or of the centre of an arc, mm.
    pub tip: [Vector; 6],
    /// The radius vector of an arc, which is added to the centre in `tip`; `None` if the curve is no arc.
    pub round: Option<Round>,
    /// Polynomials of the rotary axes, in the order of their axis indices, degrees.
    pub angles: [[f64; 6]; ROTARIES],
    /// Polynomials of the axes that are not in the chain, by axis index, mm or degrees. Entries for axes of
    /// the chain have no effect.
    pub others: [[f64; 6]; AXES],
}

/// The radius vector of an arc, which turns evenly over the path distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round {
    /// Vector from the centre to the start, mm.
    pub radius: Vector,
    /// Change of the radius vector from the start to the end, without the turn, mm.
    pub growth: Vector,
    /// Direction of the axis of rotation: a unit vector.
    pub normal: Vector,
    /// Angle from the start to the end, degrees; at most 200 000.
    pub degrees: f64,
}

impl Round {
    /// The radius with its derivatives at `share`.
    fn at(&self, share: f64) -> Jet {
        let radius = self.radius.plus(self.growth.times(share));
        let angle = position(self.degrees * share).unwrap_or(Position::ZERO);
        let spin = Spin { first: self.degrees * RADIANS, ..Spin::at(angle) };
        let grown = Jet { point: radius, first: self.growth, second: Vector::ZERO };
        grown.turned(spin, self.normal, Vector::ZERO)
    }
}

impl Course {
    /// A straight line of the tool tip (mm), between two points with the angles of the rotary axes (degrees)
    /// there. The angles change in proportion to the path distance.
    pub fn line(from: (Vector, [Position; ROTARIES]), to: (Vector, [Position; ROTARIES])) -> Self {
        let mut tip = [Vector::ZERO; 6];
        (tip[0], tip[1]) = (from.0, to.0.minus(from.0));
        let mut angles = [[0.0; 6]; ROTARIES];
        for ((course, from), to) in angles.iter_mut().zip(&from.1).zip(&to.1) {
            (course[0], course[1]) = (number(*from), number(*to) - number(*from));
        }
        Self { tip, round: None, angles, others: [[0.0; 6]; AXES] }
    }

    /// Whether every axis of the channel moves in proportion to the path distance. This holds for a straight
    /// line on which no rotary axis moves.
    pub fn is_straight(&self) -> bool {
        let bent = self.tip.iter().skip(2).any(|c| *c != Vector::ZERO);
        let turns = self.angles.iter().any(|c| c.iter().skip(1).any(|c| *c != 0.0));
        let others = self.others.iter().any(|c| c.iter().skip(2).any(|c| *c != 0.0));
        !bent && !turns && !others && self.round.is_none()
    }

    /// The tool tip with its derivatives at `share`.
    fn tip_at(&self, share: f64) -> Jet {
        let zero = Jet::at(Vector::ZERO);
        let tip = self.tip.iter().rev().fold(zero, |jet, c| Jet {
            second: jet.second.times(share).plus(jet.first.times(2.0)),
            first: jet.first.times(share).plus(jet.point),
            point: jet.point.times(share).plus(*c),
        });
        self.round.map_or(tip, |round| tip.plus(round.at(share)))
    }
}

/// Value, first and second derivative of a polynomial.
fn horner(c: &[f64; 6], x: f64) -> [f64; 3] {
    c.iter().rev().fold([0.0; 3], |[p, d, dd], c| [p * x + c, d * x + p, dd * x + 2.0 * d])
}

/// The reason why a curve cannot be divided into cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SplitError {
    /// The curve needs more than [`MOST_CELLS`] cells, or the bound of its error is not finite.
    TooCurved,
    /// The axis with this index leaves the range of ±200 000 mm or degrees.
    Range(u8),
    /// The polynomial of the axis with this index does not fit into its integers.
    Format(u8),
}

impl SplitError {
    /// The index of the axis, or an index beyond all axes if the error names none.
    pub const fn axis(self) -> usize {
        match self {
            Self::TooCurved => usize::MAX,
            Self::Range(axis) | Self::Format(axis) => axis as usize,
        }
    }

    /// Writes the message for the axis with the name `axis`.
    pub fn tell(self, f: &mut fmt::Formatter<'_>, axis: &str) -> fmt::Result {
        match self {
            Self::TooCurved => write!(
                f,
                "transformation: the block needs more than {MOST_CELLS} polynomials; expected a shorter block or less turn"
            ),
            Self::Range(_) => {
                write!(f, "transformation: axis {axis} would leave the range of -200000 to 200000")
            }
            Self::Format(_) => {
                write!(
                    f,
                    "transformation: axis {axis} moves too far in one polynomial; expected a shorter block"
                )
            }
        }
    }
}

impl fmt::Display for SplitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.tell(f, "of the chain")
    }
}

impl core::error::Error for SplitError {}

/// An end of a cell: value (mm or degrees) of each axis, and derivatives with respect to the fraction of the
/// curve.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    position: [Position; AXES],
    value: [[f64; 3]; AXES],
}

impl Node {
    /// First and second derivative with respect to the fraction of a cell. The cell is the fraction `h` of
    /// the curve.
    fn slopes(&self, h: f64) -> [[f64; 2]; AXES] {
        self.value.map(|[_, first, second]| [first * h, second * h * h])
    }
}

/// One part of a curve: a quintic polynomial for each axis, over the fraction (0 to 1) of the cell's path
/// distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Start position, mm or degrees.
    pub start: [Position; AXES],
    /// Coefficients of the first to fifth power, LSB 2^-42 mm or degree.
    pub power: [[i64; 5]; AXES],
    /// First and second derivative of each axis at both ends, with respect to the fraction of the cell, mm or
    /// degrees. Where two cells meet, both have the same derivatives with respect to path distance.
    pub ends: [[[f64; 2]; AXES]; 2],
}

/// Coefficients stay below this magnitude: 32 768 mm.
const LARGEST: i64 = 1 << 57;
/// Additional fraction bits of a coefficient, compared with a position.
pub(super) const FINER: u32 = 10;
const SCALE: f64 = (1u64 << 42) as f64;
/// Largest difference of the linear coefficient from the first derivative, LSB 2^-42. The difference has
/// these causes: rounding of both ends (2^9 each), of four coefficients, of numbers up to 2^18 in 53 bits,
/// and of a given start.
const SLACK: i64 = 1 << 13;

/// Whether a cell is so short that a cubic fits both ends. `aside` is the error of the cubic's first
/// derivative at the end; `off` is the error of its end. In a quintic, the rounding of both ends would be
/// visible in its higher powers.
fn is_short(aside: f64, off: f64) -> bool {
    let within = |x: f64, most: f64| -most <= x && x <= most;
    within(aside, 8.0 / SCALE) && within(off, 64.0 / SCALE)
}

impl Cell {
    /// Positions of the axes at the fraction `share`·2^-62 of the cell's path distance, rounded to nearest.
    /// `share` is 0 to 2^62.
    pub fn at(&self, share: i64) -> [Position; AXES] {
        let mut axes = self.start;
        for (axis, power) in axes.iter_mut().zip(&self.power) {
            let way = power.iter().rev().fold(0, |p: i64, c| mul_shift(p.wrapping_add(*c), share, 62));
            let half = 1 << (FINER - 1);
            *axis = Position::from_bits(axis.to_bits().wrapping_add(way.wrapping_add(half) >> FINER));
        }
        axes
    }

    /// Exact end position of each axis, mm or degrees.
    pub fn end(&self) -> [Position; AXES] {
        self.at(1 << 62)
    }

    /// Least and greatest position of an axis in the cell. The result is the range of the Bernstein
    /// coefficients. The polynomial never leaves this range, but may not reach its ends. Returns `None` if
    /// there is no such axis.
    pub fn range(&self, axis: usize) -> Option<[Position; 2]> {
        let [c1, c2, c3, c4, c5] = *self.power.get(axis)?;
        let hull = [
            0,
            2 * c1,
            4 * c1 + c2,
            6 * c1 + 3 * c2 + c3,
            8 * c1 + 6 * c2 + 4 * c3 + 2 * c4,
            10 * (c1 + c2 + c3 + c4 + c5),
        ];
        let (least, most) = hull.iter().fold((0, 0), |(a, b): (i64, i64), x| (a.min(*x), b.max(*x)));
        // A tenth, LSB 2^-32, plus one unit outward for dropped bits.
        const TENTH: i64 = 10 << FINER;
        let start = self.start.get(axis)?.to_bits();
        Some([start + least / TENTH - 1, start + most / TENTH + 1].map(Position::from_bits))
    }

    /// Makes and checks the cell between two nodes. The cell is the share `h` of the curve.
    fn between(from: &Node, to: &Node, h: f64) -> Result<Self, SplitError> {
        let mut cell =
            Self { start: from.position, power: [[0; 5]; AXES], ends: [from.slopes(h), to.slopes(h)] };
        let ends = from.value.iter().zip(&to.value).zip(from.position.iter().zip(&to.position));
        for (k, (place, ((v0, v1), (x0, x1)))) in cell.power.iter_mut().zip(ends).enumerate() {
            let ([f0, d0, a0], [f1, d1, a1]) = (*v0, *v1);
            let (w, d0, d1, a0, a1) = (f1 - f0, d0 * h, d1 * h, a0 * h * h, a1 * h * h);
            let cubic = (a1 - a0) / 6.0;
            let bent = if is_short(d0 + 0.5 * (a0 + a1) - d1, d0 + 0.5 * a0 + cubic - w) {
                [0.5 * a0, cubic, 0.0, 0.0]
            } else {
                [
                    0.5 * a0,
                    10.0 * w - 6.0 * d0 - 4.0 * d1 - 1.5 * a0 + 0.5 * a1,
                    -15.0 * w + 8.0 * d0 + 7.0 * d1 + 1.5 * a0 - a1,
                    6.0 * w - 3.0 * d0 - 3.0 * d1 - 0.5 * a0 + 0.5 * a1,
                ]
            };
            let [c2, c3, c4, c5] = bent.map(|c| nearest(c * SCALE).clamp(-LARGEST, LARGEST));
            let travel = x1.to_bits().wrapping_sub(x0.to_bits()) << FINER;
            let c1 = travel - (c2 + c3 + c4 + c5);
            let wanted = nearest(d0 * SCALE).clamp(-LARGEST, LARGEST);
            let fits = [c1, c2, c3, c4, c5].iter().all(|c| c.abs() < LARGEST);
            if !fits || (c1 - wanted).abs() > SLACK {
                return Err(SplitError::Format(k as u8));
            }
            *place = [c1, c2, c3, c4, c5];
        }
        Ok(cell)
    }
}

/// Divides a curve of the tool tip into cells, and returns a polynomial of the axes for each cell.
#[derive(Clone, Copy, Debug)]
pub struct Splitter<'a> {
    chain: &'a Chain,
    course: Course,
    cells: u32,
    made: u32,
    node: Node,
}

impl<'a> Splitter<'a> {
    /// Begins a curve and computes its number of cells, with at most 16 comparisons.
    ///
    /// # Errors
    /// The curve needs too many cells, or begins out of range.
    pub fn new(chain: &'a Chain, course: Course) -> Result<Self, SplitError> {
        let stray = stray(chain, &course) / (64.0 * (TIP_ERROR - ROUNDING));
        let is_enough = |n: u32| {
            let n = f64::from(n);
            // The comparison is false if `stray` is not a number.
            stray <= n * n * n * (n * n * n)
        };
        if !is_enough(MOST_CELLS) {
            return Err(SplitError::TooCurved);
        }
        let (mut few, mut cells) = (0, MOST_CELLS);
        while cells - few > 1 {
            let middle = few + (cells - few) / 2;
            if middle > 0 && is_enough(middle) { cells = middle } else { few = middle }
        }
        let node = node(chain, &course, 0.0)?;
        Ok(Self { chain, course, cells, made: 0, node })
    }

    /// Makes the curve start at `axes`, the exact positions of the axes. The start that the transformation
    /// gives may differ from them by rounding.
    pub const fn starting_at(mut self, axes: [Position; AXES]) -> Self {
        self.node.position = axes;
        self
    }

    /// Whether the axes move in proportion to the path distance.
    pub fn is_straight(&self) -> bool {
        self.course.is_straight()
    }

    /// Begins the same curve again, from the exact positions `axes`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn again(&self, axes: [Position; AXES]) -> Result<Self, SplitError> {
        let node = node(self.chain, &self.course, 0.0)?;
        Ok(Self { made: 0, node, ..*self }.starting_at(axes))
    }

    /// The number of the next cell, from 0.
    pub const fn made(&self) -> u32 {
        self.made
    }

    /// Number of cells of the curve.
    pub const fn cells(&self) -> u32 {
        self.cells
    }

    /// Makes the next cell. Each call computes one inverse transformation with its derivatives. Returns
    /// `None` after the last cell.
    ///
    /// # Errors
    /// An axis leaves its range, or the cell fails its check; the curve ends there.
    pub fn step(&mut self) -> Option<Result<Cell, SplitError>> {
        if self.made >= self.cells {
            return None;
        }
        let count = f64::from(self.cells);
        let made = node(self.chain, &self.course, f64::from(self.made + 1) / count);
        let cell = made.and_then(|next| {
            let cell = Cell::between(&self.node, &next, 1.0 / count)?;
            self.node = next;
            Ok(cell)
        });
        self.made = if cell.is_ok() { self.made + 1 } else { self.cells };
        Some(cell)
    }
}

/// The positions of the axes at `share` of a curve.
fn node(chain: &Chain, course: &Course, share: f64) -> Result<Node, SplitError> {
    let mut node = Node { position: [Position::ZERO; AXES], value: [[0.0; 3]; AXES] };
    for (k, (other, places)) in
        course.others.iter().zip(node.position.iter_mut().zip(&mut node.value)).enumerate()
    {
        let value = horner(other, share);
        (*places.0, *places.1) = (position(value[0]).ok_or(SplitError::Range(k as u8))?, value);
    }
    let (mut angles, mut rates) = ([Position::ZERO; ROTARIES], [[0.0; 3]; ROTARIES]);
    for rotary in chain.rotaries() {
        let slot = usize::from(rotary.slot);
        let refused = SplitError::Range(rotary.axis);
        let value = horner(course.angles.get(slot).ok_or(refused)?, share);
        let angle = position(value[0]).ok_or(refused)?;
        *angles.get_mut(slot).ok_or(refused)? = angle;
        // The linear axes follow the angle before rounding. So the rounding of the angle does not show in
        // their derivatives.
        let rates_of = [value[0] - number(angle), value[1], value[2]];
        *rates.get_mut(slot).ok_or(refused)? = rates_of.map(|x| x * RADIANS);
        *node.position.get_mut(usize::from(rotary.axis)).ok_or(refused)? = angle;
        *node.value.get_mut(usize::from(rotary.axis)).ok_or(refused)? = value;
    }
    let spins = chain.spins(&angles, &rates);
    for (axis, value) in chain.linear(course.tip_at(share), &spins) {
        let refused = SplitError::Range(axis);
        *node.position.get_mut(usize::from(axis)).ok_or(refused)? = position(value[0]).ok_or(refused)?;
        *node.value.get_mut(usize::from(axis)).ok_or(refused)? = value;
    }
    Ok(node)
}
