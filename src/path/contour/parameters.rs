//! What #CONTOUR MODE sets, each until it is set again.
use super::corner::{Tolerance, Turn};
use super::{REVERSAL, TANGENTIAL};
use crate::lookahead::min;
use crate::math::float::to_f32;
use crate::math::trig::sin_cos;
use crate::nc::{Contour, ContourAction, ContourMethod};
use crate::quantity::Position;

const LSB_32: f32 = 1.0 / (1u64 << 32) as f32;

/// The parameters, in mm and degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Which of the others count.
    pub method: ContourMethod,
    /// PATH_DEV.
    pub path_dev: f32,
    /// TRACK_DEV; 0: not monitored.
    pub track_dev: f32,
    /// RELEVANT_PATH.
    pub relevant_path: f32,
    /// RELEVANT_TRACK.
    pub relevant_track: f32,
    /// Largest part of a block that one corner takes: from REMAIN_PART.
    pub share: f32,
    /// CHECK_JERK.
    pub check_jerk: u8,
    /// Sine of half of MAX_ANGLE.
    pub max_angle: f32,
    /// CONST_VEL.
    pub const_vel: bool,
    /// PRE_DIST and POST_DIST.
    pub dist: [f32; 2],
    /// Interim point; where it is not given, the corner's coordinate.
    pub point: [Option<Position>; 3],
    /// Where functions between the blocks come out.
    pub action: ContourAction,
}

/// Sine of half an angle in degrees.
fn half_sine(angle: Position) -> f32 {
    // 2^-32 degrees to 2^-64 revolutions, halved
    let turns = (angle.to_bits().max(0).unsigned_abs() / 720) << 32;
    to_f32(sin_cos(turns).0) * (1.0 / (1u64 << 62) as f32)
}

/// RELEVANT_PATH at least, mm.
const LEAST_RELEVANT: f32 = 0.032;

impl Parameters {
    /// At program start; `check_jerk` is P-CHAN-00110.
    pub fn new(check_jerk: u8) -> Self {
        Self {
            method: ContourMethod::Dev,
            path_dev: 1.0,
            track_dev: 0.0,
            relevant_path: LEAST_RELEVANT,
            relevant_track: 0.0,
            share: 0.5,
            check_jerk,
            max_angle: half_sine(Position::const_from_int(178)),
            const_vel: false,
            dist: [1.0; 2],
            point: [None; 3],
            action: ContourAction::Inter,
        }
    }

    /// Takes over what is programmed.
    pub fn update(&mut self, contour: &Contour) {
        let set = |own: &mut f32, value: Option<Position>| {
            if let Some(value) = value {
                *own = to_f32(value.to_bits()) * LSB_32;
            }
        };
        if let Some(method) = contour.method {
            self.method = method;
        }
        set(&mut self.path_dev, contour.path_dev);
        set(&mut self.track_dev, contour.track_dev);
        set(&mut self.relevant_path, contour.relevant_path);
        self.relevant_path = crate::lookahead::max(self.relevant_path, LEAST_RELEVANT);
        set(&mut self.relevant_track, contour.relevant_track);
        if let Some(percent) = contour.remain_part {
            self.share = 0.5 - to_f32(percent.to_bits()) * LSB_32 * (1.0 / 200.0);
        }
        if let Some(level) = contour.check_jerk {
            self.check_jerk = level;
        }
        if let Some(angle) = contour.max_angle {
            self.max_angle = half_sine(angle);
        }
        if let Some(constant) = contour.const_vel {
            self.const_vel = constant;
        }
        if let Some(action) = contour.action {
            self.action = action;
        }
        let [pre, post] = &mut self.dist;
        set(pre, contour.pre_dist);
        set(post, contour.post_dist);
        for (own, value) in self.point.iter_mut().zip(contour.point) {
            if value.is_some() {
                *own = value;
            }
        }
    }

    /// Whether a transition is rounded at all: not if it goes straight on or straight back, nor, between lines, beyond
    /// the largest angle.
    pub(super) fn rounds(&self, turn: &Turn, with_arc: bool) -> bool {
        let tangential = turn.sine < TANGENTIAL && (turn.track < TANGENTIAL || self.track_dev == 0.0);
        let tolerated = self.method != ContourMethod::Dev || self.path_dev > 0.0;
        tolerated && !tangential && turn.cosine >= REVERSAL && (with_arc || turn.sine <= self.max_angle)
    }

    /// Corner distances that are asked for, or allowed where a tolerance decides.
    pub(super) fn distances(&self, most: [f32; 2]) -> [f32; 2] {
        let least = min(most[0], most[1]);
        let [pre, post] = self.dist;
        match self.method {
            ContourMethod::Dist if pre == post => [min(pre, least); 2],
            ContourMethod::Dist | ContourMethod::Pos => [min(pre, most[0]), min(post, most[1])],
            _ => [least; 2],
        }
    }

    /// What the curve has to keep.
    pub(super) fn tolerance(&self) -> Tolerance {
        let path = if self.method == ContourMethod::Dev { Some(self.path_dev) } else { None };
        Tolerance { path, track: self.track_dev }
    }
}
