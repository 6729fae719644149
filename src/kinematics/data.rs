//! Machine data of transformations, with ISG's names and units: 0.1 µm, 10^-4 degree.
use super::vector::Vector;
use core::fmt;

/// The reason why the machine data of a transformation are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DataError {
    /// Id and name of the refused parameter.
    pub parameter: &'static str,
    /// Index of the axis, or of the place in the chain, if the parameter has an index.
    pub index: Option<u8>,
    /// The value found, if it is a whole number.
    pub found: Option<i64>,
    /// What was expected, in words.
    pub expected: &'static str,
}

impl fmt::Display for DataError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.parameter)?;
        if let Some(index) = self.index {
            write!(f, ", index {index}")?;
        }
        if let Some(found) = self.found {
            write!(f, ", \"{found}\"")?;
        }
        write!(f, ": expected {}", self.expected)
    }
}

impl core::error::Error for DataError {}

/// Largest magnitude of a length in 0.1 µm: 10 m.
const FARTHEST: i32 = 100_000_000;

/// Machine data of a head (type 9) with two rotary axes: C turns A, and A turns the tool. The axes X, Y, Z,
/// C, A have the indices 0 to 4.
///
/// With C turned by Rz and A by Rx, the tool tip is `(X, Y, Z) + (HD7, HD8, 0) + Rz(C + HD4)·[(HD6, HD5,
/// −HD2) + Rx(A + HD3)·(0, HD9, −HD1)]`. HD1 contains the length of the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CaHead {
    /// trafo\[\].param\[0\] to \[8\], HD1 to HD9: lengths in 0.1 µm, but HD3 and HD4 in 10^-4 degree.
    pub param: [i32; 9],
}

impl CaHead {
    /// Checks that lengths are within ±10 m and angles within ±360 degrees.
    pub(super) fn check(&self) -> Result<(), DataError> {
        for (k, param) in self.param.iter().enumerate() {
            let angle = k == 2 || k == 3;
            let most = if angle { 3_600_000 } else { FARTHEST };
            if param.unsigned_abs() > most.unsigned_abs() {
                return Err(DataError {
                    parameter: "trafo[].param",
                    index: Some(k as u8),
                    found: Some(i64::from(*param)),
                    expected: if angle { "-3600000 to 3600000 (1e-4 degree)" } else { LENGTH },
                });
            }
        }
        Ok(())
    }
}

const LENGTH: &str = "-100000000 to 100000000 (0.1 um)";

/// An axis of a serial chain, described with all axes at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniversalAxis {
    /// P-CHAN-00291 type: 1 linear, 2 rotary.
    pub kind: u8,
    /// P-CHAN-00292 orientation. Linear axis: direction in which the tool moves relative to the workpiece
    /// when the axis moves in its positive direction. Rotary axis: direction of the axis of rotation. Any
    /// length but 0.
    pub orientation: [f64; 3],
    /// P-CHAN-00293 point: a point on the axis of rotation, 0.1 µm. No effect on a linear axis.
    pub point: [i32; 3],
}

/// Machine data of a serial chain of axes from the workpiece to the tool (type 91). Three linear axes follow
/// each other. Up to three rotary axes are before them, after them, or on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Universal {
    /// P-CHAN-00289 number_of_axes, 3 to 6.
    pub number_of_axes: u8,
    /// P-CHAN-00290 chain: indices of the axes from the workpiece to the tool, each once.
    pub chain: [u8; 6],
    /// The axes of the chain, by their index in the channel.
    pub axis: [UniversalAxis; 6],
    /// P-CHAN-00285 zero_orientation: direction from the tool tip to the holder with all axes at 0. Any
    /// length but 0.
    pub zero_orientation: [f64; 3],
    /// P-CHAN-00286 zero_position: the tool tip with all axes at 0, 0.1 µm.
    pub zero_position: [i32; 3],
}

pub(super) const NUMBER: &str = "P-CHAN-00289 trafo[].number_of_axes";
pub(super) const CHAIN: &str = "P-CHAN-00290 trafo[].chain";
pub(super) const KIND: &str = "P-CHAN-00291 trafo[].axis[].type";
pub(super) const ORIENTATION: &str = "P-CHAN-00292 trafo[].axis[].orientation";
pub(super) const POINT: &str = "P-CHAN-00293 trafo[].axis[].point";
pub(super) const ZERO_ORIENTATION: &str = "P-CHAN-00285 trafo[].zero_orientation";
pub(super) const ZERO_POSITION: &str = "P-CHAN-00286 trafo[].zero_position";

/// An error of the axis or the place `index`.
pub(super) const fn at(parameter: &'static str, index: u8, expected: &'static str) -> DataError {
    DataError { parameter, index: Some(index), found: None, expected }
}

/// A direction of any length.
pub(super) fn direction(
    [x, y, z]: [f64; 3],
    parameter: &'static str,
    index: Option<u8>,
) -> Result<Vector, DataError> {
    let expected = "a vector between 1e-9 and 1e12 long";
    Vector::new(x, y, z).unit().ok_or(DataError { parameter, index, found: None, expected })
}

/// A point in mm.
pub(super) fn point(
    point: [i32; 3],
    parameter: &'static str,
    index: Option<u8>,
) -> Result<Vector, DataError> {
    for x in point {
        if x.unsigned_abs() > FARTHEST.unsigned_abs() {
            return Err(DataError { parameter, index, found: Some(i64::from(x)), expected: LENGTH });
        }
    }
    let [x, y, z] = point.map(millimetres);
    Ok(Vector::new(x, y, z))
}

/// 0.1 µm as mm.
pub(super) fn millimetres(x: i32) -> f64 {
    f64::from(x) / 10_000.0
}
