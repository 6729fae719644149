//! Parameters of `#HSC \[SURFACE\]`. A parameter keeps its value until the program sets it again.
use crate::math::float::{max, min, to_f32};
use crate::math::root::sqrt_f32;
use crate::nc::Hsc;
use crate::path::Element;
use crate::quantity::{DISTANCE_LSB, Position};
#[cfg(feature = "kinematics")]
use crate::smooth::contour::Parameters as Dev;
use crate::smooth::contour::half_sine;
#[cfg(feature = "splines")]
use crate::smooth::spline::Rules;

const LSB_32: f32 = 1.0 / (1u64 << 32) as f32;

/// The parameters of `#HSC [SURFACE]` in force. Lengths are in mm, angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// PATH_DEV.
    path_dev: f32,
    /// PATH_DEV_G00; PATH_DEV where it is not given.
    path_dev_g00: Option<f32>,
    /// TRACK_DEV.
    track_dev: f32,
    /// TRACK_DEV_G00; TRACK_DEV where it is not given.
    track_dev_g00: Option<f32>,
    /// MAX_ANGLE: the sine of half of the largest change of direction that becomes a curve.
    max_angle: f32,
    /// CHECK_JERK, and the value of P-CHAN-00110.
    check_jerk: u8,
    of_channel: u8,
    /// AUTO_OFF_G00.
    auto_off_g00: bool,
    /// CIR_MODE.
    cir_mode: u8,
    /// CIR_MIN_ANGLE, radians.
    cir_min_angle: f32,
    /// CIR_MIN_RADIUS.
    cir_min_radius: f32,
    /// MERGE.
    merge: bool,
    /// LENGTH_LONG_CIR, mm.
    length_long_cir: f32,
    /// MAX_PATH_LENGTH of the B-spline, mm: a longer line stays unchanged.
    longest: f32,
    /// Whether an exact stop is on the curve: AUTO_OFF_G60 of the B-spline is 0.
    stands: bool,
    /// Whether points control the curve, as in a B-spline, so that the curve need not pass them.
    controlled: bool,
}

/// The largest half width of a kernel (mm) is this factor times the square root of the tolerance (mm). A
/// tolerance of 0.02 mm gives 6.5 mm: the length of four or five segments of usual free-form programs. With
/// shorter segments, the number of vertices in the window limits the width.
const WIDTH: f32 = 46.0;
/// Largest half width of a kernel with any tolerance, mm.
const WIDEST: f32 = 16.0;

/// For a B-spline: the part of the distance cut off by the kernels by which points move out. The points
/// control the curve, so the curve need not pass them.
const CONTROLLED: f32 = 0.5;

/// Tolerance of tracking axes that are not monitored, degrees.
#[cfg(any(feature = "splines", feature = "kinematics"))]
const NOT_MONITORED: f32 = 1e6;

/// Largest distance between an arc and its chords, as a part of the tolerance.
const SAGITTA: f32 = 1.0 / 20.0;

/// Permitted deviation of merged lines, as a part of the tolerance; the curve has the rest. With 1/16, runs
/// of short segments take up to 0.8 % longer than without MERGE; with 1/2, up to 14 %.
const MERGED: f32 = 1.0 / 32.0;

/// [`Used`] stores a share in this number of steps.
const PARTS: f32 = 255.0;

/// Least tolerance of a tracking axis, degrees: TRACK_DEV=0 permits no deviation beyond what single precision
/// resolves.
const LEAST_TRACK: f32 = 0.001;

/// Margin for rounding: a turn of exactly the largest angle is permitted.
const ROUNDED: f32 = 1.0 + 1.0 / 65_536.0;

/// An arc with a radius of at most this number of tolerances counts as small.
const SMALL_RADIUS: f32 = 4.0;

/// A tolerance of the main axes together, in space, and of each other axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Tolerance of the main axes together, mm.
    pub path: f32,
    /// Tolerance of each other axis, degrees.
    pub track: f32,
}

/// How much of the tolerance merged lines have used: a share for PATH_DEV and a share for TRACK_DEV.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Used(u8, u8);

impl Used {
    /// Nothing is used, because the chord is a single line.
    pub const NOTHING: Self = Self(0, 0);

    /// The larger of both shares: for the vertex between two chords.
    pub fn larger(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }

    /// A deviation as a share of `most`, rounded up.
    fn parts(stray: f32, most: f32) -> u8 {
        if stray <= 0.0 {
            return 0;
        }
        let parts = min(PARTS * stray / max(most, f32::MIN_POSITIVE), PARTS - 1.0) as u8;
        parts + 1
    }
}

impl Parameters {
    /// Parameters at program start. `check_jerk`: value of P-CHAN-00110, the default of CHECK_JERK.
    pub const fn new(check_jerk: u8) -> Self {
        Self {
            path_dev: 0.2,
            path_dev_g00: None,
            track_dev: 2.0,
            track_dev_g00: None,
            // 160 degrees.
            max_angle: 0.984_807_7,
            check_jerk,
            of_channel: check_jerk,
            auto_off_g00: false,
            cir_mode: 1,
            cir_min_angle: core::f32::consts::FRAC_PI_6,
            cir_min_radius: 0.0,
            merge: false,
            length_long_cir: 2.0,
            longest: f32::MAX,
            stands: false,
            controlled: false,
        }
    }

    /// Parameters with which Surface makes the HSC B-spline: its tolerances, and its rules for blocks that
    /// stay unchanged.
    #[cfg(feature = "splines")]
    pub fn of_spline(rules: &Rules, check_jerk: u8) -> Self {
        let track = if rules.track_dev > 0.0 { rules.track_dev } else { NOT_MONITORED };
        Self {
            path_dev: rules.path_dev,
            track_dev: track,
            max_angle: sqrt_f32(max(0.5 * (1.0 - rules.cosine), 0.0)),
            auto_off_g00: rules.off_rapid,
            cir_mode: 0,
            merge: rules.merge,
            longest: rules.longest,
            stands: !rules.off_stop,
            controlled: true,
            ..Self::new(check_jerk)
        }
    }

    /// Parameters with which Surface works for DEV of contour mode: the tolerances of DEV. Arcs stay exact,
    /// unless their radius is at most 4 times the tolerance.
    #[cfg(feature = "kinematics")]
    pub fn of_contour(dev: &Dev) -> Self {
        let track = if dev.track_dev > 0.0 { dev.track_dev } else { NOT_MONITORED };
        let path_dev = dev.path_dev;
        let max_angle = dev.max_angle;
        Self { path_dev, track_dev: track, max_angle, cir_min_angle: 0.0, ..Self::new(dev.check_jerk) }
    }

    /// Whether a line of this length (mm) stays unchanged.
    pub fn is_longer(&self, length: f32) -> bool {
        length > self.longest
    }

    /// How far points move out, as a part of the distance that the kernels cut off: at most this value.
    pub const fn gain(&self) -> f32 {
        if self.controlled { CONTROLLED } else { 1.0 }
    }

    /// Whether the motion stops on the curve at an exact stop, instead of at the programmed point.
    pub const fn stands(&self) -> bool {
        self.stands
    }

    /// Restores the parameters of program start.
    pub const fn restart(&mut self) {
        *self = Self::new(self.of_channel);
    }

    /// Takes the values that a command `#HSC` gives.
    pub fn update(&mut self, hsc: &Hsc) {
        let value = |given: Option<Position>| given.map(|given| to_f32(given.to_bits()) * LSB_32);
        let set = |own: &mut f32, given: Option<Position>| *own = value(given).unwrap_or(*own);
        set(&mut self.path_dev, hsc.path_dev);
        set(&mut self.track_dev, hsc.track_dev);
        set(&mut self.cir_min_radius, hsc.cir_min_radius);
        set(&mut self.length_long_cir, hsc.length_long_cir);
        self.path_dev_g00 = value(hsc.path_dev_g00).or(self.path_dev_g00);
        self.track_dev_g00 = value(hsc.track_dev_g00).or(self.track_dev_g00);
        if let Some(angle) = value(hsc.cir_min_angle) {
            self.cir_min_angle = angle * (core::f32::consts::PI / 180.0);
        }
        if let Some(angle) = hsc.max_angle {
            self.max_angle = half_sine(angle);
        }
        self.check_jerk = hsc.check_jerk.unwrap_or(self.check_jerk);
        self.auto_off_g00 = hsc.auto_off_g00.unwrap_or(self.auto_off_g00);
        self.cir_mode = hsc.cir_mode.unwrap_or(self.cir_mode);
        self.merge = hsc.merge.unwrap_or(self.merge);
    }

    /// CHECK_JERK: limit of the jerk that the curvature may cause. 0: no limit; 1: by the geometric ramp
    /// time; 2: by the ramp times.
    pub const fn check_jerk(&self) -> u8 {
        self.check_jerk
    }

    /// AUTO_OFF_G00: whether blocks of rapid motion stay unchanged.
    pub const fn leaves_rapid(&self) -> bool {
        self.auto_off_g00
    }

    /// MERGE: largest deviation of lines that become one chord, for feed and rapid blocks alike; `None`
    /// without MERGE.
    pub fn merged(&self) -> Option<Tolerance> {
        self.merge.then(|| self.most_merged())
    }

    fn most_merged(&self) -> Tolerance {
        let (feed, rapid) = (self.tolerance(false), self.tolerance(true));
        Tolerance { path: MERGED * min(feed.path, rapid.path), track: MERGED * min(feed.track, rapid.track) }
    }

    /// The shares of the tolerance that merged lines with the deviation `stray` use.
    pub fn used(&self, stray: &Tolerance) -> Used {
        let most = self.most_merged();
        Used(Used::parts(stray.path, most.path), Used::parts(stray.track, most.track))
    }

    /// The rest of a tolerance that is left for the curve. The chord of an arc, and merged lines, use a part.
    pub fn left(&self, tolerance: Tolerance, arc: bool, used: Used) -> Tolerance {
        let arc = if arc { SAGITTA } else { 0.0 };
        let path = tolerance.path * (1.0 - arc);
        if used == Used::NOTHING {
            return Tolerance { path, track: tolerance.track };
        }
        let most = self.most_merged();
        let part = |used: u8| f32::from(used) * (1.0 / PARTS);
        let Used(of_path, of_track) = used;
        Tolerance {
            path: path - most.path * part(of_path),
            track: tolerance.track - most.track * part(of_track),
        }
    }

    /// Whether a turn between two lines exceeds MAX_ANGLE. `chord`: change of direction, twice the sine of
    /// half the angle.
    pub fn is_beyond(&self, chord: f32) -> bool {
        chord > 2.0 * ROUNDED * self.max_angle
    }

    /// The tolerance of a transition. `rapid`: whether the blocks on both sides are rapid motion (G00).
    pub fn tolerance(&self, rapid: bool) -> Tolerance {
        let normal = Tolerance { path: self.path_dev, track: max(self.track_dev, LEAST_TRACK) };
        if !rapid {
            return normal;
        }
        Tolerance {
            path: self.path_dev_g00.unwrap_or(normal.path),
            track: self.track_dev_g00.map_or(normal.track, |track| max(track, LEAST_TRACK)),
        }
    }

    /// Largest half width of a kernel, mm.
    pub fn widest(&self) -> f32 {
        min(WIDTH * sqrt_f32(self.path_dev), WIDEST)
    }

    /// CIR_MODE: whether the transitions of arcs that stay exact become curves.
    pub const fn rounds_arcs(&self) -> bool {
        self.cir_mode != 0
    }

    /// Path length (mm) of the chords that replace an arc; `None` if the arc stays exact.
    pub fn chord_of<const AXES: usize>(&self, arc: &Element<AXES>) -> Option<f32> {
        let circle = arc.circle.as_ref()?;
        if self.cir_mode == 0 {
            return None;
        }
        let length = to_f32(arc.shape.length.to_bits()) * DISTANCE_LSB;
        // 8·sagitta·radius is the square of the chord.
        let chord = sqrt_f32(8.0 * SAGITTA * self.path_dev * circle.radius);
        let angle = length * circle.share / circle.radius;
        let small = circle.radius < max(self.cir_min_radius, SMALL_RADIUS * self.path_dev);
        if angle < self.cir_min_angle || small {
            return Some(chord / circle.share);
        }
        // Long arcs: as long as chords of the least length stay inside.
        (self.cir_mode == 2 && chord >= self.length_long_cir).then_some(chord / circle.share)
    }
}
