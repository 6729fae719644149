//! G00 and G01: a straight line of all axes together.
use super::{Curve, Element, End, FINER, GUARD, LONGEST, Measure, PathError, Shape, path_length, reach};
use crate::math::divide::reciprocal_near;
use crate::math::wide::mul_near;
use crate::quantity::{Distance, Position};

/// A line without the memory that an [`Element`] has for curves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Straight<const AXES: usize> {
    pub(super) length: Distance,
    gain: [i64; AXES],
    /// Direction, LSB 2^-40.
    pub(super) tangent: [i64; AXES],
    shift: u8,
}

/// The line from `start` to `target`; `None` if no axis moves.
///
/// # Errors
/// [`PathError::TooLong`].
pub fn line<const AXES: usize>(
    start: &[Position; AXES],
    target: &[Position; AXES],
    measure: &Measure,
) -> Result<Option<Element<AXES>>, PathError> {
    Ok(straight_line(start, target, measure)?.map(|line| line.element()))
}

/// As [`line`], written into an existing element. Returns whether an axis moves.
///
/// # Errors
/// [`PathError::TooLong`].
#[inline(never)]
pub(crate) fn line_to<const AXES: usize>(
    [start, target]: [&[Position; AXES]; 2],
    measure: &Measure,
    element: &mut Element<AXES>,
) -> Result<bool, PathError> {
    let Some(line) = &straight_line(start, target, measure)? else { return Ok(false) };
    line.become_in(element);
    Ok(true)
}

/// As [`straight`], but never inlined.
///
/// # Errors
/// [`PathError::TooLong`].
#[inline(never)]
pub(crate) fn straight_line<const AXES: usize>(
    start: &[Position; AXES],
    target: &[Position; AXES],
    measure: &Measure,
) -> Result<Option<Straight<AXES>>, PathError> {
    straight(start, target, measure)
}

/// The line from `start` to `target`, not yet as an element; `None` if no axis moves.
///
/// # Errors
/// [`PathError::TooLong`].
#[cfg_attr(feature = "fast", inline(always))]
pub(crate) fn straight<const AXES: usize>(
    start: &[Position; AXES],
    target: &[Position; AXES],
    measure: &Measure,
) -> Result<Option<Straight<AXES>>, PathError> {
    let mut travel = [0; AXES];
    let mut too_long = false;
    for ((travel, from), to) in travel.iter_mut().zip(start).zip(target) {
        let over;
        (*travel, over) = to.to_bits().overflowing_sub(from.to_bits());
        too_long |= over;
    }
    match reach(&travel) {
        // The limit is a power of two, so `reach` decides exactly.
        reach if reach >= (LONGEST >> FINER) as u64 || too_long => return Err(PathError::TooLong),
        0 => return Ok(None),
        _ => {}
    }
    let mut shape = Shape::resting(path_length(measure.travelled(&travel), &travel)?);
    shape.set_gains(&travel);
    let Shape { length, gain, shift, .. } = shape;
    Ok(Some(Straight { length, gain, tangent: shape.linear_tangent(), shift }))
}

impl<const AXES: usize> Straight<AXES> {
    /// An empty line: all bits are zero.
    pub(crate) const BLANK: Self =
        Self { length: Distance::ZERO, gain: [0; AXES], tangent: [0; AXES], shift: 0 };

    /// Direction of the line, LSB 2^-40.
    pub(crate) fn tangent(&self) -> &[i64; AXES] {
        &self.tangent
    }

    /// Path length.
    pub(crate) fn length(&self) -> Distance {
        self.length
    }

    /// The shape of the line, and its direction, for an element. Data that only curves have are not copied.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn parts(&self) -> (Shape<AXES>, End<AXES>) {
        let Self { length, gain, tangent, shift } = *self;
        let shape = Shape { length, gain, curve: Curve::Line, shift };
        (shape, End { tangent, curvature: [0.0; AXES] })
    }

    /// Writes this line into `line`, which must already be a line.
    pub(crate) fn assign_to(&self, line: &mut Element<AXES>) {
        let Self { length, gain, tangent, shift } = *self;
        (line.shape.length, line.shape.gain, line.shape.shift) = (length, gain, shift);
        (line.entry.tangent, line.exit.tangent) = (tangent, tangent);
    }

    /// Writes this line into any kind of element.
    pub(crate) fn become_in(&self, element: &mut Element<AXES>) {
        self.assign_to(element);
        (element.shape.curve, element.circle, element.bounds) = (Curve::Line, None, None);
        (element.entry.curvature, element.exit.curvature) = ([0.0; AXES], [0.0; AXES]);
    }

    /// The element.
    pub(crate) fn element(&self) -> Element<AXES> {
        let (shape, ends) = self.parts();
        Element { shape, entry: ends, exit: ends, circle: None, bounds: None }
    }
}

impl<const AXES: usize> Element<AXES> {
    /// Shortens a line to the part after `from`. `cut`: path distance from the start to `from`, LSB 2^-44 mm.
    /// The direction stays. `from` is rounded to the LSB of a position on each axis; a new line from there
    /// would have this error in its length and direction.
    pub(crate) fn shorten(&mut self, cut: i64, from: &[Position; AXES], to: &[Position; AXES]) {
        let rest = self.shape.length.to_bits() - cut;
        if rest <= 0 || from == to {
            return;
        }
        let mut travel = [0; AXES];
        for (travel, (from, to)) in travel.iter_mut().zip(from.iter().zip(to)) {
            *travel = to.to_bits().wrapping_sub(from.to_bits());
        }
        let shape = &mut self.shape;
        shape.length = Distance::from_bits(rest);
        shape.shift = Shape::<AXES>::shift_of(shape.length);
        shape.set_gains(&travel);
    }
}

impl<const AXES: usize> Shape<AXES> {
    /// Value of `w` at the end.
    pub(super) fn end_w(&self) -> i64 {
        self.length.to_bits() << (self.shift & 63)
    }

    /// Sets the linear part of each axis from its travel (LSB of a position, below 2^50): 2^64 times the
    /// travel divided by `w` at the end. One reciprocal serves all axes. The error at the end is below twenty
    /// LSB of the product, which is less than the guard bits.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn set_gains(&mut self, travel: &[i64; AXES]) {
        self.set_gains_by(travel, self.reciprocal());
    }

    /// Sets the linear part from the travel of every axis, and from the [`Self::reciprocal`] of the length.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn set_gains_by(&mut self, travel: &[i64; AXES], reciprocal: i64) {
        for (gain, travel) in self.gain.iter_mut().zip(travel) {
            // Without a branch; a branch would keep both halves of the reciprocal in separate registers.
            *gain = mul_near(travel << (GUARD + 3), reciprocal) << 1;
        }
    }

    /// 2^124 divided by `w` at the end; the result is in 2^62..2^63.
    pub(super) fn reciprocal(&self) -> i64 {
        reciprocal_near((self.end_w() as u64) << 2) as i64
    }

    /// dx/ds of the linear part, LSB 2^-40: the gain per `w`, scaled by a power of two.
    pub(super) fn linear_tangent(&self) -> [i64; AXES] {
        // gain·2^-42/2^64 per w, w = 2^shift per 2^-44 mm
        self.gain.map(|gain| match 22u32.checked_sub(u32::from(self.shift)) {
            Some(down) => gain >> down,
            None => gain << (u32::from(self.shift) - 22),
        })
    }
}
