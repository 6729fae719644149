//! A machine as a serial chain of axes from the workpiece to the tool. The chain computes the positions of
//! the axes from tool tip and angles, and the tool tip from the positions.
//!
//! Let B be the motion of the workpiece by the rotary axes between workpiece and linear axes. Let H be the
//! motion of the tool by the rotary axes between linear axes and tool. U is the matrix of the linear axes'
//! directions, and q are the positions of the linear axes. p is the tool tip with all axes at 0. The tool tip
//! is B(U·q + H(p)). So q = U⁻¹·(B⁻¹(tip) − H(p)). This inverse exists for all angles.
use super::data::{self, CaHead, DataError, Universal};
use super::vector::{Jet, Spin, Vector, number, position};
use crate::quantity::Position;

/// Largest number of axes in a chain.
pub const AXES: usize = 6;
/// Largest number of rotary axes in a chain.
pub const ROTARIES: usize = 3;

/// A linear axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Linear {
    /// Index of the axis.
    axis: u8,
    /// Direction of the tool when the axis moves in its positive direction.
    direction: Vector,
}

/// A rotary axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rotary {
    /// Index of the axis.
    pub(super) axis: u8,
    /// Number of the axis among the rotary axes, in the order of their indices.
    pub(super) slot: u8,
    /// Direction of the axis of rotation: a unit vector.
    pub(super) direction: Vector,
    /// A point on the axis of rotation, mm.
    pub(super) point: Vector,
    /// Angle of the turn when the axis is at 0.
    pub(super) offset: Position,
}

/// Rotary axes in the order of the chain.
pub(super) type Rotaries = [Option<Rotary>; ROTARIES];

/// The serial chain of axes from the workpiece to the tool, from checked machine data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    linear: [Linear; 3],
    /// Rows of U⁻¹.
    rows: [Vector; 3],
    /// Rotary axes between workpiece and linear axes.
    pub(super) base: Rotaries,
    /// Rotary axes between linear axes and tool.
    pub(super) head: Rotaries,
    /// The tool tip with all axes at 0, mm.
    pub(super) tip: Vector,
    /// The direction from tool tip to holder with all axes at 0.
    pub(super) tool: Vector,
}

/// Two directions count as different if the sine of their angle is at least this value.
const APART: f64 = 1e-4;

impl Chain {
    /// A chain of any axes: machine data of type 91.
    ///
    /// # Errors
    /// Returns the parameter that is out of its range or contradicts another one. Examples: an axis is named
    /// twice. The number of linear axes is not three. The linear axes are not next to each other, or lie in
    /// one plane. Several rotary axes reach no more directions than one of them.
    pub fn universal(machine: &Universal) -> Result<Self, DataError> {
        let order = order(machine)?;
        let tool = data::direction(machine.zero_orientation, data::ZERO_ORIENTATION, None)?;
        let tip = data::point(machine.zero_position, data::ZERO_POSITION, None)?;
        let (mut linear, mut base, mut head) = ([None; 3], [None; ROTARIES], [None; ROTARIES]);
        let mut found = 0;
        for index in order.into_iter().flatten() {
            let Some(axis) = machine.axis.get(usize::from(index)) else { continue };
            let direction = data::direction(axis.orientation, data::ORIENTATION, Some(index))?;
            if axis.kind == 1 {
                if head.iter().any(Option::is_some) {
                    return Err(data::at(data::CHAIN, index, "the linear axes side by side"));
                }
                put(&mut linear, found, Linear { axis: index, direction });
                found += 1;
                continue;
            }
            let point = data::point(axis.point, data::POINT, Some(index))?;
            let before = machine.axis.iter().take(usize::from(index));
            let slot = before.filter(|axis| axis.kind == 2).count() as u8;
            let rotary = Rotary { axis: index, slot, direction, point, offset: Position::ZERO };
            let side = if found == 0 { &mut base } else { &mut head };
            let place = side.iter().flatten().count();
            put(side, place, rotary);
        }
        let [Some(a), Some(b), Some(c)] = linear else {
            let expected = "three linear axes (type 1) in the chain";
            return Err(DataError { parameter: data::KIND, index: None, found: None, expected });
        };
        Self::new([a, b, c], base, head, tip, tool)
    }

    /// A head with the rotary axes C and A: machine data of type 9.
    ///
    /// # Errors
    /// Returns the parameter that is out of its range.
    pub fn ca_head(machine: &CaHead) -> Result<Self, DataError> {
        machine.check()?;
        let [hd1, hd2, hd3, hd4, hd5, hd6, hd7, hd8, hd9] = machine.param.map(data::millimetres);
        let [x, y, z] = [Vector::new(1.0, 0.0, 0.0), Vector::new(0.0, 1.0, 0.0), Vector::new(0.0, 0.0, 1.0)];
        let linear = [(0, x), (1, y), (2, z)].map(|(axis, direction)| Linear { axis, direction });
        let centre = Vector::new(hd7, hd8, 0.0);
        let point = centre.plus(Vector::new(hd6, hd5, -hd2));
        // The angles are at most 360 degrees.
        let [a, c] = [hd3, hd4].map(|angle| position(angle).unwrap_or(Position::ZERO));
        let c = Rotary { axis: 3, slot: 0, direction: z, point: centre, offset: c };
        let a = Rotary { axis: 4, slot: 1, direction: x, point, offset: a };
        let tip = point.plus(Vector::new(0.0, hd9, -hd1));
        Self::new(linear, [None; ROTARIES], [Some(c), Some(a), None], tip, z)
    }

    /// Makes a chain from its parts.
    fn new(
        linear: [Linear; 3],
        base: Rotaries,
        head: Rotaries,
        tip: Vector,
        tool: Vector,
    ) -> Result<Self, DataError> {
        let [a, b, c] = linear.map(|axis| axis.direction);
        let volume = a.dot(b.cross(c));
        if volume.abs() < 0.01 {
            let expected = "linear axes that span space (determinant of at least 0.01)";
            return Err(data::at(data::ORIENTATION, linear[2].axis, expected));
        }
        let rows = [b.cross(c), c.cross(a), a.cross(b)].map(|row| row.times(1.0 / volume));
        let chain = Self { linear, rows, base, head, tip, tool };
        chain.reaches()?;
        Ok(chain)
    }

    /// Checks that each of several rotary axes adds directions.
    fn reaches(&self) -> Result<(), DataError> {
        let mut before: Option<Rotary> = None;
        for rotary in self.rotaries() {
            if let Some(before) = before
                && before.direction.cross(rotary.direction).length() < APART
            {
                let expected = "a direction other than that of the rotary axis before it in the chain";
                return Err(data::at(data::ORIENTATION, rotary.axis, expected));
            }
            before = Some(rotary);
        }
        match before {
            Some(last)
                if self.rotaries().count() == 2 && last.direction.cross(self.tool).length() < APART =>
            {
                let expected = "a direction other than the tool's, which the axis does not tilt";
                Err(data::at(data::ORIENTATION, last.axis, expected))
            }
            _ => Ok(()),
        }
    }

    /// The rotary axes from the workpiece to the tool.
    pub(super) fn rotaries(&self) -> impl Iterator<Item = Rotary> + '_ {
        self.base.iter().chain(&self.head).flatten().copied()
    }

    /// Indices of the linear axes, in their order from the workpiece to the tool.
    pub fn linear_axes(&self) -> [usize; 3] {
        self.linear.map(|linear| usize::from(linear.axis))
    }

    /// Whether the linear axes are at right angles to each other.
    pub fn is_cartesian(&self) -> bool {
        let [a, b, c] = self.linear.map(|linear| linear.direction);
        [a.dot(b), b.dot(c), c.dot(a)].iter().all(|cosine| cosine.abs() < APART)
    }

    /// Whether each linear axis moves the tool tip along its own coordinate of the workpiece. Then no rotary
    /// axis is before the linear axes, and the linear axes are along x, y and z.
    pub fn is_upright(&self) -> bool {
        let aligned = |direction: Vector| {
            let Vector { x, y, z } = direction;
            [x, y, z].iter().filter(|x| x.abs() > APART).count() == 1
        };
        self.base.iter().all(Option::is_none) && self.linear.iter().all(|linear| aligned(linear.direction))
    }

    /// Whether `axis` is a linear axis parallel to z of the machine.
    pub fn is_along_z(&self, axis: usize) -> bool {
        let z = Vector::new(0.0, 0.0, 1.0);
        let own = self.linear.iter().find(|linear| usize::from(linear.axis) == axis);
        own.is_some_and(|linear| linear.direction.cross(z).length() < APART)
    }

    /// Tool tip (mm) and direction from tip to holder, from the positions of the axes (mm, degrees).
    pub fn forward(&self, axes: &[Position; AXES]) -> (Vector, Vector) {
        let (mut tip, mut tool) = (self.tip, self.tool);
        let mut turn = |rotary: &Rotary, tip: &mut Vector| {
            let spin = Spin::at(rotary.offset.wrapping_add(value(axes, rotary.axis)));
            *tip = rotary.point.plus(spin.turn(rotary.direction, tip.minus(rotary.point)));
            tool = spin.turn(rotary.direction, tool);
        };
        self.head.iter().flatten().rev().for_each(|rotary| turn(rotary, &mut tip));
        for axis in &self.linear {
            tip = tip.plus(axis.direction.times(number(value(axes, axis.axis))));
        }
        self.base.iter().flatten().rev().for_each(|rotary| turn(rotary, &mut tip));
        (tip, tool)
    }

    /// Positions of all axes (mm, degrees) with the tool tip at `tip` (mm). `angles`: positions of the rotary
    /// axes (degrees), in the order of their axis indices. Returns `None` if a linear axis is beyond ±200 000
    /// mm.
    pub fn inverse(&self, tip: Vector, angles: &[Position; ROTARIES]) -> Option<[Position; AXES]> {
        let spins = self.spins(angles, &[[0.0; 3]; ROTARIES]);
        let linear = self.linear(Jet::at(tip), &spins);
        let mut axes = [Position::ZERO; AXES];
        for (axis, [point, ..]) in linear {
            *axes.get_mut(usize::from(axis))? = position(point)?;
        }
        for rotary in self.rotaries() {
            let angle = angles.get(usize::from(rotary.slot))?;
            *axes.get_mut(usize::from(rotary.axis))? = *angle;
        }
        Some(axes)
    }

    /// Angles (degrees) with their derivatives (radians), including offsets, by slot.
    pub(super) fn spins(
        &self,
        angles: &[Position; ROTARIES],
        rates: &[[f64; 3]; ROTARIES],
    ) -> [Spin; ROTARIES] {
        let mut spins = [Spin { sin: 0.0, cos: 1.0, first: 0.0, second: 0.0 }; ROTARIES];
        for rotary in self.rotaries() {
            let slot = usize::from(rotary.slot);
            let (Some(spin), Some(angle), Some([beyond, first, second])) =
                (spins.get_mut(slot), angles.get(slot), rates.get(slot))
            else {
                continue;
            };
            let at = Spin::at(rotary.offset.wrapping_add(*angle));
            *spin = Spin { first: *first, second: *second, ..at.turned(*beyond) };
        }
        spins
    }

    /// For each linear axis: its index, its position (mm), and its first and second derivative. The arguments
    /// are the tool tip and the angles of the rotary axes by slot.
    pub(super) fn linear(&self, tip: Jet, spins: &[Spin; ROTARIES]) -> [(u8, [f64; 3]); 3] {
        let spin = |rotary: &Rotary| spins.get(usize::from(rotary.slot)).copied();
        let mut outer = tip;
        for rotary in self.base.iter().flatten() {
            let Some(spin) = spin(rotary) else { continue };
            outer = outer.turned(spin.reversed(), rotary.direction, rotary.point);
        }
        let mut inner = Jet::at(self.tip);
        for rotary in self.head.iter().flatten().rev() {
            let Some(spin) = spin(rotary) else { continue };
            inner = inner.turned(spin, rotary.direction, rotary.point);
        }
        let Jet { point, first, second } = outer.minus(inner);
        let [a, b, c] = self.rows.map(|row| [row.dot(point), row.dot(first), row.dot(second)]);
        let [x, y, z] = self.linear.map(|axis| axis.axis);
        [(x, a), (y, b), (z, c)]
    }
}

/// The position of an axis.
fn value(axes: &[Position; AXES], axis: u8) -> Position {
    axes.get(usize::from(axis)).copied().unwrap_or(Position::ZERO)
}

/// Puts `x` to the place `at`; does nothing if this place is beyond the end.
fn put<T>(places: &mut [Option<T>; 3], at: usize, x: T) {
    if let Some(place) = places.get_mut(at) {
        *place = Some(x);
    }
}

/// Indices of the axes in the order of the chain. Their number, types and names are checked.
fn order(machine: &Universal) -> Result<[Option<u8>; AXES], DataError> {
    let number = machine.number_of_axes;
    if !(3..=6).contains(&number) {
        let found = Some(i64::from(number));
        return Err(DataError { parameter: data::NUMBER, index: None, found, expected: "3 to 6" });
    }
    let (mut order, mut linear) = ([None; AXES], 0u8);
    for (at, (index, place)) in machine.chain.iter().zip(&mut order).take(usize::from(number)).enumerate() {
        let refused = |expected| DataError {
            parameter: data::CHAIN,
            index: Some(at as u8),
            found: Some(i64::from(*index)),
            expected,
        };
        if *index >= number {
            return Err(refused("the index of an axis below number_of_axes"));
        }
        if machine.chain.iter().take(at).any(|before| before == index) {
            return Err(refused("each axis once"));
        }
        let kind = machine.axis.get(usize::from(*index)).map_or(0, |axis| axis.kind);
        if !(1..=2).contains(&kind) {
            let (index, found) = (Some(*index), Some(i64::from(kind)));
            return Err(DataError {
                parameter: data::KIND,
                index,
                found,
                expected: "1 (linear) or 2 (rotary)",
            });
        }
        linear += u8::from(kind == 1);
        *place = Some(*index);
    }
    if linear != 3 {
        let found = Some(i64::from(linear));
        let expected = "three linear axes (type 1) in the chain";
        return Err(DataError { parameter: data::KIND, index: None, found, expected });
    }
    Ok(order)
}
