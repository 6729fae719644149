//! Parameters of `#CONTOUR MODE`. A parameter keeps its value until the program sets it again.
use super::corner::{Tolerance, Turn};
use super::held_block::Stray;
use super::{REVERSAL, TANGENTIAL};
use crate::math::float::{max, min, to_f32};
use crate::math::trig::sin_cos;
use crate::nc::{Contour, ContourAction, ContourMethod, Value};
use crate::quantity::Position;

const LSB_32: f32 = 1.0 / (1u64 << 32) as f32;

/// The machine data of contour mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// P-CHAN-00110: default of CHECK_JERK, 0 to 2.
    pub check_jerk: u8,
    /// `merge_chords`: the part of the tolerance that merged chords may use, 0 to 1.
    pub chords: f32,
}

/// The parameters of contour mode in force. Lengths are in mm, angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// The method (DEV, DIST, POS, …). Each method uses some of the parameters.
    pub method: ContourMethod,
    /// PATH_DEV: largest permitted deviation of the main axes from the contour, mm.
    pub path_dev: f32,
    /// TRACK_DEV: largest permitted deviation of each tracking axis, degrees; 0: not monitored.
    pub track_dev: f32,
    /// RELEVANT_PATH: a block that is shorter than this, mm, may be left out at a corner.
    pub relevant_path: f32,
    /// Whether the corners are edges of `#HSC \[SURFACE\]`. Then no block is left out, and a curve over time
    /// is preferred to a curve over arc length.
    pub edges: bool,
    /// RELEVANT_TRACK: as RELEVANT_PATH, for the tracking axes, degrees.
    pub relevant_track: f32,
    /// Largest share of a block that one corner may take, 0 to 0.5, computed from REMAIN_PART.
    pub share: f32,
    /// CHECK_JERK: limit of the jerk that the curvature may cause. 0: no limit; 1: by the geometric ramp
    /// time; 2: by the ramp times.
    pub check_jerk: u8,
    /// The value of CHECK_JERK for methods without this keyword: P-CHAN-00110.
    check_jerk_preset: u8,
    /// Share of the tolerance for merged chords.
    chords: f32,
    /// MAX_ANGLE: the sine of half of the largest change of direction that becomes a curve.
    pub max_angle: f32,
    /// CONST_VEL: whether the path speed is constant in the curve.
    pub const_vel: bool,
    /// PRE_DIST and POST_DIST: distances from the corner to both ends of the curve, mm.
    pub dist: [f32; 2],
    /// PATH_DIST of DIST_SOFT and PTP: largest distance from the corner to both ends of the curve, mm;
    /// negative: not monitored.
    pub path_dist: f32,
    /// TRACK_DIST of DIST_SOFT: a limit of the same distance, for a corner at which tracking axes change
    /// their direction, mm; `None`: PATH_DIST applies.
    pub track_dist: Option<f32>,
    /// SYM_DIST of DIST_MASTER: distance from the corner to both ends of the curve, mm; negative: not
    /// monitored.
    pub sym_dist: f32,
    /// ACC_MIN and ACC_MAX of DIST_SOFT: least and largest share of the axes' acceleration for the curve; 1
    /// is all.
    pub acc: [f32; 2],
    /// RAMP_TIME: factor for the ramp times of the axes in the curve; 1 is 100 %.
    pub ramp_time: f32,
    /// DIST_WEIGHT of DIST_SOFT and DIST_MASTER: 0: a corner takes at most half of a block; 1: the lengths of
    /// the neighbours decide.
    pub dist_weight: f32,
    /// MERGE of PTP: whether consecutive lines of one direction become one line.
    pub merge: bool,
    /// PTP: whether the last command with PATH_DEV or PATH_DIST gave PATH_DEV, and whether it gave PATH_DIST
    /// (row CF-33 of `docs/conformance.md`).
    pub given: [bool; 2],
    /// Interim point of POS, mm. A coordinate that is not given is that of the corner.
    point: [Position; 3],
    /// Which coordinates of the interim point are given.
    pointed: [bool; 3],
    /// Where functions between the blocks are output: before, inside or after the curve (PRE_ACTION,
    /// INTER_ACTION, POST_ACTION).
    pub action: ContourAction,
}

/// Sine of half an angle in degrees.
pub fn half_sine(angle: Position) -> f32 {
    // 2^-32 degrees to 2^-64 revolutions, halved
    let turns = (angle.to_bits().max(0).unsigned_abs() / 720) << 32;
    to_f32(sin_cos(turns).0) * (1.0 / (1u64 << 62) as f32)
}

/// Smallest RELEVANT_PATH, mm.
const LEAST_RELEVANT: f32 = 0.032;

/// Largest share of a corner distance that is left out without RELEVANT_PATH. This share adds to the
/// deviation, which is otherwise 3/8 of the distance at 90°.
const LEFT_OUT: f32 = 0.25;

/// Share of the tolerance by which left-out blocks may deviate from their line. With this share, all blocks
/// inside a sphere nearly as large as the tolerance can be left out.
const STRAY: f32 = 0.75;

impl Parameters {
    /// Parameters at program start.
    pub fn new(preset: Preset) -> Self {
        Self {
            method: ContourMethod::Dev,
            path_dev: 1.0,
            track_dev: 0.0,
            relevant_path: 0.0,
            edges: false,
            relevant_track: 0.0,
            share: 0.5,
            check_jerk: preset.check_jerk,
            check_jerk_preset: preset.check_jerk,
            chords: preset.chords,
            max_angle: half_sine(Position::const_from_int(178)),
            const_vel: false,
            dist: [1.0; 2],
            path_dist: 1.0,
            track_dist: None,
            sym_dist: 1.0,
            acc: [0.5, 1.0],
            ramp_time: 1.0,
            dist_weight: 0.0,
            merge: true,
            given: [false; 2],
            point: [Position::ZERO; 3],
            pointed: [false; 3],
            action: ContourAction::Inter,
        }
    }

    /// Takes the programmed values.
    pub fn update(&mut self, contour: &Contour) {
        let set = |own: &mut f32, value: Option<Position>| {
            if let Some(value) = value {
                *own = to_f32(value.to_bits()) * LSB_32;
            }
        };
        if let Some(method) = contour.method {
            if method != self.method {
                self.given = [false; 2];
            }
            self.method = method;
        }
        let given = [contour.path_dev.is_some(), contour.path_dist.is_some()];
        if self.method == ContourMethod::Ptp && given != [false; 2] {
            self.given = given;
        }
        set(&mut self.path_dev, contour.path_dev);
        set(&mut self.track_dev, contour.track_dev);
        set(&mut self.relevant_path, contour.relevant_path);
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
        if let Some(merge) = contour.merge {
            self.merge = merge;
        }
        if let Some(action) = contour.action {
            self.action = action;
        }
        set(&mut self.path_dist, contour.path_dist);
        set(&mut self.sym_dist, contour.sym_dist);
        if let Some(dist) = contour.track_dist {
            self.track_dist = Some(to_f32(dist.to_bits()) * LSB_32);
        }
        let part = |own: &mut f32, percent: Option<Value>| {
            if let Some(percent) = percent {
                *own = to_f32(percent.to_bits()) * (LSB_32 * 0.01);
            }
        };
        let [least, most] = &mut self.acc;
        part(least, contour.acc_min);
        part(most, contour.acc_max);
        part(&mut self.ramp_time, contour.ramp_time);
        part(&mut self.dist_weight, contour.dist_weight);
        let [pre, post] = &mut self.dist;
        set(pre, contour.pre_dist);
        set(post, contour.post_dist);
        for ((own, given), value) in self.point.iter_mut().zip(&mut self.pointed).zip(contour.point) {
            if let Some(value) = value {
                (*own, *given) = (value, true);
            }
        }
    }

    /// The interim point; `None` where it is not given.
    pub(super) fn point(&self) -> [Option<Position>; 3] {
        let mut point = self.point.map(Some);
        for (point, given) in point.iter_mut().zip(self.pointed) {
            *point = point.filter(|_| given);
        }
        point
    }

    /// The presets of the machine data.
    pub(super) const fn preset(&self) -> Preset {
        Preset { check_jerk: self.check_jerk_preset, chords: self.chords }
    }

    /// The parameters in force for a method. A keyword that the method does not have counts as never given;
    /// its value stays for other methods.
    pub(super) fn by(&self, method: ContourMethod) -> Self {
        let unset = Self::new(self.preset());
        let mut own = Self { method, ..*self };
        (own.check_jerk, own.const_vel) = self.curving(method);
        if !matches!(method, ContourMethod::Dev | ContourMethod::Dist) {
            own.track_dev = unset.track_dev;
            own.relevant_path = unset.relevant_path;
            own.relevant_track = unset.relevant_track;
            own.share = unset.share;
            own.max_angle = unset.max_angle;
        }
        if matches!(method, ContourMethod::DistSoft | ContourMethod::DistMaster) {
            own.action = unset.action;
        }
        own
    }

    /// CHECK_JERK and CONST_VEL for a method.
    pub(super) fn curving(&self, method: ContourMethod) -> (u8, bool) {
        if matches!(method, ContourMethod::Dev | ContourMethod::Dist | ContourMethod::Pos) {
            (self.check_jerk, self.const_vel)
        } else {
            (self.check_jerk_preset, false)
        }
    }

    /// Whether a transition is rounded. A transition is not rounded if the path continues straight or goes
    /// straight back. Between lines, the turn must be at most the largest angle; POS has no such limit. With
    /// Surface, a straight continuation is rounded if the curvature `steps`.
    pub(super) fn rounds(&self, turn: &Turn, with_arc: bool, steps: bool) -> bool {
        let tangential = turn.sine < TANGENTIAL && (turn.track < TANGENTIAL || self.track_dev == 0.0);
        let tolerated = match self.method {
            ContourMethod::Dev => self.path_dev > 0.0,
            ContourMethod::Ptp => self.deviation().is_none_or(|dev| dev > 0.0),
            _ => true,
        };
        let far = !with_arc && self.method != ContourMethod::Pos && turn.sine > self.max_angle;
        tolerated && (!tangential || self.edges && steps) && turn.cosine >= REVERSAL && !far
    }

    /// Demanded corner distances, or the largest permitted ones if a tolerance decides.
    pub(super) fn distances(&self, most: [f32; 2]) -> [f32; 2] {
        let least = min(most[0], most[1]);
        let [pre, post] = self.dist;
        match self.method {
            ContourMethod::Dist if pre == post => [min(pre, least); 2],
            ContourMethod::Dist | ContourMethod::Pos => [min(pre, most[0]), min(post, most[1])],
            ContourMethod::DistSoft => [min(monitored(self.path_dist), least); 2],
            ContourMethod::DistMaster => [min(monitored(self.sym_dist), least); 2],
            ContourMethod::Ptp => [min(self.ptp_distance(), least); 2],
            ContourMethod::Dev => [least; 2],
        }
    }

    /// Whether all that is set is DEV with tolerances and a largest angle, and perhaps CHECK_JERK.
    #[cfg(all(feature = "kinematics", feature = "surface"))]
    pub(super) fn is_row(&self) -> bool {
        let Self { share, relevant_path, relevant_track, chords, .. } = *self;
        let whole = share >= 0.5 && max(relevant_path, relevant_track) <= 0.0 && chords <= 0.0;
        let even = self.const_vel || self.action != ContourAction::Inter;
        self.method == ContourMethod::Dev && self.path_dev > 0.0 && whole && !even
    }

    /// Whether the neighbours decide how a block is divided between its corners (DIST_WEIGHT).
    pub(super) fn weighs(&self) -> bool {
        self.dist_weight > 0.0 && matches!(self.method, ContourMethod::DistSoft | ContourMethod::DistMaster)
    }

    /// The share of a block that a corner may take: a half with DIST_WEIGHT 0. With 100 %, it is the ratio of
    /// the neighbour at this corner (`own`) to both neighbours. Between 0 and 100 %, it is a mix of both.
    /// Lengths are as programmed, LSB 2^-44 mm.
    pub(super) fn part(&self, own: i64, other: Option<i64>) -> f32 {
        let Some(other) = other.filter(|_| self.weighs()) else { return 0.5 };
        let (own, other) = (to_f32(own), to_f32(other));
        0.5 + self.dist_weight * (own / (own + other) - 0.5)
    }

    /// Whether the motion may stop in a corner if a curve takes longer. With ACC_MAX below 100 % a curve of DIST_SOFT
    /// uses less acceleration than a stop.
    pub(super) fn may_stand(&self) -> bool {
        match self.method {
            ContourMethod::Dev | ContourMethod::Ptp => true,
            ContourMethod::DistSoft => self.acc[1] >= 1.0,
            _ => false,
        }
    }

    /// PTP: PATH_DIST if it is given and monitored.
    pub(super) fn ptp_distance(&self) -> f32 {
        let counts = self.method == ContourMethod::Ptp && self.given[1];
        if counts { monitored(self.path_dist) } else { f32::MAX }
    }

    /// The permitted deviation. With PTP, it acts only if PATH_DEV is given, or neither PATH_DEV nor
    /// PATH_DIST is given.
    pub(super) fn deviation(&self) -> Option<f32> {
        let kept = match self.method {
            ContourMethod::Dev => true,
            ContourMethod::Ptp => self.given[0] || !self.given[1],
            _ => false,
        };
        kept.then_some(self.path_dev)
    }

    /// DIST_SOFT: the corner distance at which other axes may begin to deviate.
    pub(super) fn track_distance(&self) -> f32 {
        match self.method {
            ContourMethod::DistSoft => monitored(self.track_dist.unwrap_or(self.path_dist)),
            _ => f32::MAX,
        }
    }

    /// Paths of the main axes and of each other axis up to which blocks are left out. The path of the main
    /// axes is at least 32 µm, but a tolerance and a share of demanded corner distances limit this value.
    pub(super) fn relevant(&self) -> [f32; 2] {
        let Tolerance { path, track } = self.tolerance();
        let least = if self.edges { 0.0 } else { LEAST_RELEVANT };
        let most = match path {
            Some(path) => min(max(self.relevant_path, least), path),
            None => {
                let [pre, post] = self.distances([f32::MAX; 2]);
                max(self.relevant_path, min(least, LEFT_OUT * min(pre, post)))
            }
        };
        [most, if track > 0.0 { min(self.relevant_track, track) } else { self.relevant_track }]
    }

    /// Permitted deviation of blocks from a straight line that replaces them: a share of the tolerance.
    pub(super) fn stray(&self) -> Stray {
        let Tolerance { path, track } = self.tolerance();
        let path = path.map_or(f32::MAX, |dev| STRAY * dev);
        Stray { path, track: if track > 0.0 { STRAY * track } else { f32::MAX } }
    }

    /// The tolerance of the curve.
    pub(super) fn tolerance(&self) -> Tolerance {
        let track = match self.method {
            ContourMethod::Dev | ContourMethod::Dist => self.track_dev,
            _ => 0.0,
        };
        Tolerance { path: self.deviation(), track }
    }
}

/// A distance; a negative value means not monitored.
fn monitored(dist: f32) -> f32 {
    if dist < 0.0 { f32::MAX } else { dist }
}
