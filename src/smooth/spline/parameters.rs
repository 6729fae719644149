//! Parameters of splines, as the program sets them: kind of spline, directions at the ends, tolerances.
use super::LSB_32;
use super::polygon::Tolerance;
use super::window::along;
use crate::math::float::to_f32;
use crate::math::trig::sin_cos;
use crate::nc::{Hsc, HscMethod, Spline, SplineType, Tangent, Value};
use crate::path::Measure;
use crate::quantity::Position;
use crate::smooth::contour::curve::size;

/// Tolerances of the HSC B-spline without its keywords: 0.2 mm and 5°.
const PATH_DEV: f32 = 0.2;
const TRACK_DEV: f32 = 5.0;
/// MAX_ANGLE without its keyword.
const MAX_ANGLE: f32 = 160.0;
/// CONTERROR without its keyword: 0.1 mm.
const CONTERROR: Position = Position::from_bits((1 << 32) / 10);

/// Parameters of direct splines (G151): `#SPLINE TYPE`, `#AKIMA TRANS`, STARTVECTOR, ENDVECTOR.
#[derive(Clone, Copy, Debug)]
pub struct DirectParameters<const AXES: usize> {
    /// The kind of the spline: AKIMA until a command chooses another one.
    pub kind: SplineType,
    /// What decides the direction of the curve at its start and at its end.
    pub ends: [Tangent; 2],
    vectors: [[Option<Value>; AXES]; 2],
    /// Number of motion blocks before the type was chosen, if it was chosen.
    chosen: Option<u32>,
}

impl<const AXES: usize> DirectParameters<AXES> {
    /// Parameters at program start.
    pub const fn at_start() -> Self {
        Self { kind: SplineType::Akima, ends: [Tangent::Auto; 2], vectors: [[None; AXES]; 2], chosen: None }
    }

    /// Takes a command that sets a parameter. `taken`: number of motion blocks before the command.
    pub fn update(&mut self, command: &Spline<AXES>, taken: u32) {
        match command {
            Spline::Type(kind) => (self.kind, self.chosen) = (*kind, Some(taken)),
            Spline::Transition { start, end } => {
                let [first, last] = &mut self.ends;
                (*first, *last) = (start.unwrap_or(*first), end.unwrap_or(*last));
            }
            Spline::StartVector(vector) => self.vectors[0] = *vector,
            Spline::EndVector(vector) => self.vectors[1] = *vector,
            Spline::On | Spline::Off => {}
        }
    }

    /// Whether no motion block has come since the type was chosen. Then no block gives a direction.
    pub fn is_fresh(&self, taken: u32) -> bool {
        self.chosen == Some(taken)
    }

    /// The vector that the program gives for one end (0: start, 1: end); `None` if it gives none.
    pub fn vector(&self, end: usize) -> Option<[f32; AXES]> {
        let vector = self.vectors.get(end)?;
        vector
            .iter()
            .any(Option::is_some)
            .then(|| vector.map(|value| value.map_or(0.0, |value| to_f32(value.to_bits()) * LSB_32)))
    }

    /// Whether the given vector of an end has a component along this axis.
    pub fn leans(&self, axis: usize) -> bool {
        let leans = |value: &Option<Value>| value.is_some_and(|value| value.to_bits() != 0);
        let ends = self.ends.iter().zip(&self.vectors);
        ends.filter(|(end, _)| **end == Tangent::User).any(|(_, vector)| vector.get(axis).is_some_and(leans))
    }

    /// Smallest number of points for a curve of this kind.
    pub fn points(&self) -> u32 {
        match self.kind {
            SplineType::Bspline => 4,
            SplineType::Akima if self.ends.contains(&Tangent::Auto) => 3,
            SplineType::Akima => 2,
        }
    }
}

/// Parameters of `#HSC`, except those that only Surface has.
#[derive(Clone, Copy, Debug)]
pub struct HscParameters {
    /// The method of `#HSC` that the program named last.
    pub method: HscMethod,
    /// Tolerances and rules of the HSC B-spline.
    pub rules: Rules,
    /// CONTERROR of OPMODE: the tolerance of the curve, mm.
    pub conterror: Position,
}

/// Tolerances of the HSC B-spline, and the rules for points that the curve passes exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// PATH_DEV: largest deviation of the path, mm; 0: not monitored.
    pub path_dev: f32,
    /// TRACK_DEV: largest deviation of each tracking axis, degrees; 0: not monitored.
    pub track_dev: f32,
    /// AUTO_OFF_PATH: whether the curve passes a point exactly where it would exceed PATH_DEV. Otherwise
    /// additional control points split the block.
    pub off_path: bool,
    /// AUTO_OFF_TRACK: the same for TRACK_DEV.
    pub off_track: bool,
    /// AUTO_OFF_G00: whether the curve passes the points of rapid blocks exactly.
    pub off_rapid: bool,
    /// AUTO_OFF_G60: whether the curve passes the points of exact stops exactly.
    pub off_stop: bool,
    /// MERGE: whether points on a straight line are left out.
    pub merge: bool,
    /// MAX_PATH_LENGTH: a longer line stays unchanged, mm; infinite if it is off.
    pub longest: f32,
    /// MAX_ANGLE: the cosine of the largest change of direction that becomes a curve.
    pub cosine: f32,
    /// Whether contour mode rounds the points that the spline would pass exactly (P-CHAN-00239 = 1).
    pub rounds: bool,
    /// Whether contour mode rounds the ends of arcs (P-CHAN-00239 = 1 or 2).
    pub rounds_arcs: bool,
}

impl HscParameters {
    /// Parameters at program start. `auto_contour_mode`: P-CHAN-00239.
    pub fn new(auto_contour_mode: u8) -> Self {
        let rules = Rules {
            path_dev: PATH_DEV,
            track_dev: TRACK_DEV,
            off_path: false,
            off_track: false,
            off_rapid: false,
            off_stop: false,
            merge: false,
            longest: f32::MAX,
            cosine: cosine(MAX_ANGLE),
            rounds: auto_contour_mode == 1,
            rounds_arcs: auto_contour_mode != 0,
        };
        Self { method: HscMethod::Surface, rules, conterror: CONTERROR }
    }

    /// Parameters at program start.
    pub fn restarted(&self) -> Self {
        let Rules { rounds, rounds_arcs, .. } = self.rules;
        let new = Self::new(0);
        Self { rules: Rules { rounds, rounds_arcs, ..new.rules }, ..new }
    }

    /// CONTERROR, mm.
    pub fn conterror_mm(&self) -> f32 {
        to_f32(self.conterror.to_bits()) * LSB_32
    }

    /// Takes the values that a command `#HSC` gives.
    pub fn update(&mut self, hsc: &Hsc) {
        let number = |value: Option<Position>, into: &mut f32| {
            if let Some(value) = value {
                *into = to_f32(value.to_bits()) * LSB_32;
            }
        };
        let flag = |value: Option<bool>, into: &mut bool| *into = value.unwrap_or(*into);
        self.method = hsc.method.unwrap_or(self.method);
        if hsc.method == Some(HscMethod::Bspline) {
            let rules = &mut self.rules;
            number(hsc.path_dev, &mut rules.path_dev);
            number(hsc.track_dev, &mut rules.track_dev);
            flag(hsc.auto_off_path, &mut rules.off_path);
            flag(hsc.auto_off_track, &mut rules.off_track);
            flag(hsc.auto_off_g00, &mut rules.off_rapid);
            flag(hsc.auto_off_g60, &mut rules.off_stop);
            flag(hsc.merge, &mut rules.merge);
            if let Some(length) = hsc.max_path_length {
                rules.longest =
                    if length > Position::ZERO { to_f32(length.to_bits()) * LSB_32 } else { f32::MAX };
            }
            if let Some(angle) = hsc.max_angle {
                rules.cosine = cosine(to_f32(angle.to_bits()) * LSB_32);
            }
        }
        self.conterror = hsc.conterror.unwrap_or(self.conterror);
    }
}

impl Rules {
    /// Whether the curve has a path tolerance, and keeps this tolerance without passing points exactly.
    #[cfg(feature = "surface")]
    pub const fn is_bounded(&self) -> bool {
        self.path_dev > 0.0 && !self.off_path && !self.off_track
    }

    /// The tolerance that is monitored.
    pub fn tolerance(&self) -> Tolerance {
        let monitored = |deviation: f32| if deviation > 0.0 { deviation } else { f32::MAX };
        Tolerance { path: monitored(self.path_dev), track: monitored(self.track_dev) }
    }

    /// The tolerance of the tracking axes alone (`track`), or that of the path alone.
    pub fn part_of_tolerance(&self, track: bool) -> Tolerance {
        let Tolerance { path, track: turn } = self.tolerance();
        if track { Tolerance { path: f32::MAX, track: turn } } else { Tolerance { path, track: f32::MAX } }
    }
}

/// Cosine of an angle in degrees, 0…180.
pub fn cosine(degrees: f32) -> f32 {
    // Revolutions as a fraction of 2^64.
    let turns = (degrees * (1.0 / 360.0) * 18_446_744_073_709_551_616.0) as u64;
    let (_, cosine) = sin_cos(turns);
    to_f32(cosine) * (1.0 / (1u64 << 62) as f32)
}

/// Scales the direction `vector` to a slope: its part along the path axes has the length 1. Returns `None` if
/// the direction has no component along the path axes.
pub fn slope<const AXES: usize>(measure: &Measure, vector: &[f32; AXES]) -> Option<[f32; AXES]> {
    let axes = along(measure, AXES);
    let length = size(&axes, vector);
    if length <= 0.0 {
        return None;
    }
    let mut slope = *vector;
    for k in axes.of::<AXES>() {
        // The slope of a tracking axis is its travel per path distance.
        if let Some(x) = slope.get_mut(k) {
            *x /= length;
        }
    }
    Some(slope)
}
