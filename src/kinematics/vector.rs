//! Vectors, angles and turns about an axis, each with first and second derivative.
use crate::math::angle::sin_cos_fine;
use crate::quantity::Position;

/// A point (mm) or a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector {
    /// Component along the first axis of the workpiece.
    pub x: f64,
    /// Component along the second axis.
    pub y: f64,
    /// Component along the third axis.
    pub z: f64,
}

impl Vector {
    /// The vector of length 0.
    pub const ZERO: Self = Self::new(0.0, 0.0, 0.0);

    /// A vector from its components.
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self { x, y, z }
    }

    /// The sum of both vectors.
    pub fn plus(self, b: Self) -> Self {
        Self::new(self.x + b.x, self.y + b.y, self.z + b.z)
    }

    /// This vector minus `b`.
    pub fn minus(self, b: Self) -> Self {
        Self::new(self.x - b.x, self.y - b.y, self.z - b.z)
    }

    /// The vector times a number.
    pub fn times(self, n: f64) -> Self {
        Self::new(self.x * n, self.y * n, self.z * n)
    }

    /// The scalar product of both vectors.
    pub fn dot(self, b: Self) -> f64 {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    /// The vector product of both vectors.
    pub fn cross(self, b: Self) -> Self {
        Self::new(self.y * b.z - self.z * b.y, self.z * b.x - self.x * b.z, self.x * b.y - self.y * b.x)
    }

    /// Length of the vector.
    pub fn length(self) -> f64 {
        sqrt(self.dot(self))
    }

    /// The unit vector of this direction. Returns `None` for a vector shorter than 10^-9, or without a finite
    /// length.
    pub fn unit(self) -> Option<Self> {
        let length = self.length();
        (length > 1e-9 && length < 1e12).then(|| self.times(1.0 / length))
    }
}

/// √x with a relative error of at most 2^-51; 0 if x is not a normal number above 0.
///
/// The first value has half the exponent (error 6 %). Each of Heron's steps squares the error: 1.8e-3,
/// 1.6e-6, 1.3e-12; then only rounding is left.
pub fn sqrt(x: f64) -> f64 {
    if !(f64::MIN_POSITIVE..f64::INFINITY).contains(&x) {
        return 0.0;
    }
    let mut s = f64::from_bits((x.to_bits() + 0x3ff0_0000_0000_0000) >> 1);
    for _ in 0..4 {
        s = 0.5 * (s + x / s);
    }
    s + 0.5 * (x / s - s)
}

/// Radians per degree.
pub const RADIANS: f64 = core::f64::consts::PI / 180.0;

/// A position (LSB 2^-32 mm or degrees) as a number of mm or degrees.
pub fn number(x: Position) -> f64 {
    x.to_bits() as f64 * (1.0 / 4_294_967_296.0)
}

/// A number (mm or degrees) as a position (LSB 2^-32), rounded to nearest. Returns `None` beyond ±200 000.
pub fn position(x: f64) -> Option<Position> {
    (x > -200_000.0 && x < 200_000.0).then(|| Position::from_bits(nearest(x * 4_294_967_296.0)))
}

/// `x` as an integer, rounded to nearest; saturates.
pub fn nearest(x: f64) -> i64 {
    if x < 0.0 { (x - 0.5) as i64 } else { (x + 0.5) as i64 }
}

/// An angle in 2^-64 revolutions. The error is below 2^-63 revolutions.
pub fn turns(degrees: Position) -> u64 {
    const TURN: i64 = 360 << 32;
    let rest = degrees.to_bits().rem_euclid(TURN) as u64;
    // rest·2^32 / 360, computed as two quotients of 64 bits.
    let (upper, left) = ((rest << 22) / 360, (rest << 22) % 360);
    (upper << 10).wrapping_add((left << 10) / 360)
}

/// An angle with its first and second derivative with respect to the parameter of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin {
    /// Sine of the angle.
    pub sin: f64,
    /// Cosine of the angle.
    pub cos: f64,
    /// First derivative of the angle, radians.
    pub first: f64,
    /// Second derivative of the angle, radians.
    pub second: f64,
}

impl Spin {
    /// An angle that does not change: its derivatives are 0.
    pub fn at(degrees: Position) -> Self {
        const LSB: f64 = 1.0 / (1u64 << 62) as f64;
        let (sin, cos) = sin_cos_fine(turns(degrees));
        Self { sin: sin as f64 * LSB, cos: cos as f64 * LSB, first: 0.0, second: 0.0 }
    }

    /// The angle plus `beyond` (radians). The magnitude of `beyond` is below that of 2^-32 degrees, so its
    /// square is negligible.
    pub fn turned(self, beyond: f64) -> Self {
        Self { sin: self.sin + beyond * self.cos, cos: self.cos - beyond * self.sin, ..self }
    }

    /// The opposite angle.
    pub fn reversed(self) -> Self {
        Self { sin: -self.sin, cos: self.cos, first: -self.first, second: -self.second }
    }

    /// Turns `r` by the angle about the unit vector `u` (Rodrigues' formula).
    pub fn turn(self, u: Vector, r: Vector) -> Vector {
        let along = u.times(u.dot(r));
        along.plus(r.minus(along).times(self.cos)).plus(u.cross(r).times(self.sin))
    }
}

/// A point with its first and second derivative with respect to the parameter of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Position of the point, mm.
    pub point: Vector,
    /// First derivative of the position.
    pub first: Vector,
    /// Second derivative of the position.
    pub second: Vector,
}

impl Jet {
    /// A point that does not move: its derivatives are 0.
    pub const fn at(point: Vector) -> Self {
        Self { point, first: Vector::ZERO, second: Vector::ZERO }
    }

    /// The sum of both points and of their derivatives.
    pub fn plus(self, b: Self) -> Self {
        Self {
            point: self.point.plus(b.point),
            first: self.first.plus(b.first),
            second: self.second.plus(b.second),
        }
    }

    /// The difference of both points and of their derivatives.
    pub fn minus(self, b: Self) -> Self {
        Self {
            point: self.point.minus(b.point),
            first: self.first.minus(b.first),
            second: self.second.minus(b.second),
        }
    }

    /// Turns the point by `spin` about the unit vector `u` through `centre`: (R r)' = R r' + θ' u×R r and (R
    /// r)'' = R r'' + 2θ' u×R r' + θ'' u×R r + θ'² u×(u×R r).
    pub fn turned(self, spin: Spin, u: Vector, centre: Vector) -> Self {
        let r = spin.turn(u, self.point.minus(centre));
        let r1 = spin.turn(u, self.first);
        let r2 = spin.turn(u, self.second);
        let side = u.cross(r);
        let second = r2
            .plus(u.cross(r1).times(2.0 * spin.first))
            .plus(side.times(spin.second))
            .plus(u.cross(side).times(spin.first * spin.first));
        Self { point: centre.plus(r), first: r1.plus(side.times(spin.first)), second }
    }
}
