//! The limits along the path in a block: speed, acceleration, deceleration, and the jerk of each ramp. This
//! file also computes the common limits of several blocks, and the ramps that the limits permit.
use super::ramp::{JerkLimited, Ramp, Stepped};
use super::ramp_shape::RampShape;
use crate::machine::functions::StepBuilt;
use crate::math::float::{magnitude, max, min};
use crate::math::root::sqrt_f32;
use crate::quantity::{Speed, speed_f32};

/// Factor for a lowered speed: the result stays below its limit despite rounding.
pub(crate) const ROUNDED: f32 = 1.0 - 1.0 / 4_194_304.0;
/// Limits with a smaller relative difference count as equal. A span has the highest speed of its blocks; the
/// value allows four roundings.
const ALIKE: f32 = 1.0 / 262_144.0;
const ALIKE_SPEED: f32 = 1.0 / 4_194_304.0;
/// Brakings whose limits have a ratio above this value count as equally hard. Their difference in speed is
/// below the margin that speeds have for rounding.
const AS_HARD: f32 = 1.0 - 1.0 / 131_072.0;
/// A value above this multiple of another one counts as clearly higher.
const STRONGER: f32 = 1.125;
/// Ratio of the deceleration in a stage of a braking to the deceleration in the stage before. `LAST`: the
/// last stage begins at most at this part of the speed.
const STAGE: f32 = 1.25;
const LAST: f32 = 0.7;
/// Each stage lowers the speed at least to this part. At its highest speed, a curve may leave nearly no
/// deceleration.
const LEAST: [f32; 2] = [0.9975, 0.995];
/// Decelerations of STEP with a ratio above this value count as one.
const NEAR: f32 = 0.85;
/// Number of parts for the length of a braking.
const PARTS: u8 = 6;
/// With CONST_VEL, the speed in a curve may change below this part of the constant speed.
const LOOSE: f32 = 0.25;
/// Margin for rounding.
const LEAVES: f32 = 1.0 - 1.0 / 1_048_576.0;
/// A mean jerk for each of the four ramps of a slope, mm/tick³. The order is: acceleration rises,
/// acceleration falls, deceleration rises, deceleration falls.
pub type Ramps = [f32; 4];

/// Which blocks may share a span with a neighbour. Inside a span, acceleration need not be zero at the
/// transition between two blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joins {
    /// Only blocks with the same limits. TRAPEZ and SIN2 have this rule.
    Alike = 0,
    /// Blocks with any limits. HSC has this rule. With TRAPEZ and SIN2, the elements of one curve have this
    /// rule.
    Any = 4,
    /// As [`Self::Any`]; in addition, acceleration may pass the ends of slow blocks. HSC with NO_OPT=0 has
    /// this rule.
    Valleys = 8,
}

/// The limits that depend on the slope, in addition to the speed and accelerations in [`Limits`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SlopeLaw {
    /// The slopes TRAPEZ, SIN2 and HSC: acceleration changes by ramps.
    JerkLimited {
        /// Shape of the ramps.
        shape: RampShape,
        /// Which blocks may share a span, with acceleration at their transition.
        joins: Joins,
        /// Mean jerk of each ramp.
        j: Ramps,
    },
    /// The slope STEP. The path has one change-over speed: the path speed at which the first axis reaches its
    /// own change-over speed.
    Stepped {
        /// Speed below which [`Limits::a_up`] and [`Limits::a_down`] apply.
        change_over: f32,
        /// Acceleration above the change-over speed.
        a_up: f32,
        /// Deceleration above the change-over speed.
        a_down: f32,
        /// Deceleration at standstill. A curve needs a part of it that grows with the square of the speed.
        still: f32,
        /// Whether the acceleration that the curve needs is at a right angle to the path.
        across: bool,
        /// Marks that the build has STEP.
        built: StepBuilt,
    },
}

/// The highest permitted values along the path in one block, or in one span. Units: mm/tick, mm/tick²,
/// mm/tick³.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Speed, mm/tick.
    pub v: f32,
    /// Acceleration, mm/tick². With STEP, it applies below the change-over speed.
    pub a_up: f32,
    /// Deceleration, mm/tick², positive. With STEP, it applies below the change-over speed.
    pub a_down: f32,
    /// The limits that depend on the slope.
    pub law: SlopeLaw,
    /// CONST_VEL: the accelerations that apply at low speed in a curve of constant speed. Without CONST_VEL:
    /// [`Loose::NONE`].
    pub loose: Loose,
}

/// Acceleration and deceleration at low speed in a curve of constant speed (CONST_VEL), mm/tick²; 0 for other
/// blocks.
///
/// With CONST_VEL, the limits in a curve permit nearly no acceleration. An exception is a profile that begins
/// or ends far below the constant speed, for example at a stop: it may use this acceleration. The axes permit
/// this acceleration at every speed up to the speed limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loose(f32);

impl Loose {
    /// The curve need not have a constant speed (no CONST_VEL).
    pub const NONE: Self = Self(0.0);

    /// CONST_VEL: a profile that begins or ends at low speed may use the acceleration `a`, mm/tick², in the
    /// curve.
    pub const fn of(a: f32) -> Self {
        Self(a)
    }

    /// The acceleration given to [`Self::of`], mm/tick²; 0 for [`Self::NONE`].
    pub const fn get(self) -> f32 {
        self.0
    }

    /// Whether CONST_VEL demands a constant speed.
    #[inline(always)]
    pub fn is_some(self) -> bool {
        self.0 > 0.0
    }

    /// Lowers the acceleration to at most `a`.
    pub fn lower(&mut self, a: f32) {
        self.0 = min(self.0, a);
    }

    /// Multiplies the acceleration by `part`.
    pub fn scale(&mut self, part: f32) {
        self.0 *= part;
    }
}

/// A braking with the slope STEP in two stages, each with a constant deceleration. Speeds are in mm/tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fall {
    /// Speed at the start of the braking.
    pub from: f32,
    /// Speed at which the first stage ends and the second one begins.
    pub change_over: f32,
    /// Speed at the end of the braking.
    pub to: f32,
}

impl Limits {
    /// Limits that restrict nothing; other limits lower them.
    pub const WIDEST: Self = Self {
        v: f32::MAX,
        a_up: f32::MAX,
        a_down: f32::MAX,
        law: SlopeLaw::JerkLimited { shape: RampShape::Linear, joins: Joins::Alike, j: [f32::MAX; 4] },
        loose: Loose::NONE,
    };

    /// Nothing is permitted; all bits zero.
    pub(crate) const NOTHING: Self = Self {
        v: 0.0,
        a_up: 0.0,
        a_down: 0.0,
        law: SlopeLaw::JerkLimited { shape: RampShape::Linear, joins: Joins::Alike, j: [0.0; 4] },
        loose: Loose::NONE,
    };

    /// Whether both limits are equal except for rounding.
    pub(crate) fn are(&self, other: &Self) -> bool {
        let near = |a: f32, b: f32, part: f32| magnitude(a - b) <= a * part;
        let laws = match (&self.law, &other.law) {
            (SlopeLaw::JerkLimited { j, .. }, SlopeLaw::JerkLimited { j: others, .. }) => {
                j.iter().zip(others).all(|(a, b)| near(*a, *b, ALIKE))
            }
            _ => false,
        };
        laws && near(self.v, other.v, ALIKE_SPEED)
            && near(self.a_up, other.a_up, ALIKE)
            && near(self.a_down, other.a_down, ALIKE)
            && near(self.loose.get(), other.loose.get(), ALIKE)
    }

    /// Restricts the limits to values that both permit, with the higher one of both speeds.
    #[inline]
    pub(crate) fn join(&mut self, other: &Self) {
        self.v = max(self.v, other.v);
        self.a_up = min(self.a_up, other.a_up);
        self.a_down = min(self.a_down, other.a_down);
        self.loose.lower(other.loose.get());
        match (&mut self.law, &other.law) {
            (SlopeLaw::JerkLimited { j, .. }, SlopeLaw::JerkLimited { j: other, .. }) => lower(j, *other),
            (SlopeLaw::Stepped { change_over, still, .. }, SlopeLaw::Stepped { change_over: other, .. }) => {
                *change_over = min(*change_over, *other);
                // At the higher speed, the deceleration that both curves leave at lower speeds is unknown.
                *still = self.a_down;
            }
            _ => {}
        }
    }

    /// Lowers the deceleration and its jerks to values that `other` permits too, so that one braking may
    /// continue into a motion with the limits `other`. Speed, acceleration and its jerks stay.
    pub fn go_on_braking(&mut self, other: &Self) {
        self.a_down = min(self.a_down, other.a_down);
        match (&mut self.law, &other.law) {
            (
                SlopeLaw::JerkLimited { j: [.., rise, fall], .. },
                SlopeLaw::JerkLimited { j: [.., other_rise, other_fall], .. },
            ) => {
                (*rise, *fall) = (min(*rise, *other_rise), min(*fall, *other_fall));
            }
            (
                SlopeLaw::Stepped { change_over, a_down, .. },
                SlopeLaw::Stepped { change_over: other_change_over, a_down: other_a_down, .. },
            ) => {
                *a_down = min(*a_down, *other_a_down);
                if change_over != other_change_over {
                    // Between both change-over speeds, one of the limits already has the deceleration of its
                    // lower stage.
                    *change_over = min(*change_over, *other_change_over);
                    *a_down = min(*a_down, self.a_down);
                }
            }
            _ => {}
        }
    }

    /// Whether a profile between two speeds over `length` mm, in either direction, may use all acceleration
    /// of the axes. With CONST_VEL, this is so if one of the speeds is low, or if the change of speed needs
    /// it. A speed that is low compared with the constant speed may not be low at a later, lower override.
    #[inline(always)]
    fn is_loose_between(&self, speeds: [Speed; 2], length: f32) -> bool {
        self.loose.is_some() && self.lets_change(speeds, length)
    }

    #[cold]
    #[inline(never)]
    fn lets_change(&self, [v, w]: [Speed; 2], length: f32) -> bool {
        let (low, high) = (v.min(w).to_bits(), v.max(w).to_bits());
        let [low, dv] = [low, high - low].map(speed_f32);
        let ramp = if v < w { self.speed_up() } else { self.brake() };
        low < self.lowest() || ramp.distance(low, dv)[0] > length
    }

    /// Whether a profile with this speed at one end may use all acceleration of the axes.
    #[inline(always)]
    fn is_loose_at(&self, low: Speed) -> bool {
        self.loose.is_some() && speed_f32(low.to_bits()) < self.lowest()
    }

    /// Limits of a profile that may use all acceleration of the axes. The profile is at most as fast as
    /// `high`, mm/tick, and the low speed.
    #[cold]
    #[inline(never)]
    fn loosened_to(&self, high: f32) -> Self {
        Self { v: min(self.v, max(high, self.lowest())), ..self.loosened() }
    }

    /// Limits for a profile that has the speed `low` at one end. In a curve of constant speed (CONST_VEL), a
    /// low speed permits more acceleration; the changed limits are then in `room`.
    #[inline(always)]
    pub(crate) fn near<'a>(&'a self, low: Speed, room: &'a mut Option<Self>) -> &'a Self {
        if self.is_loose_at(low) { room.insert(self.loosened_to(0.0)) } else { self }
    }

    /// Limits for a profile between two speeds, in either direction, over `length` mm. As [`Self::near`] for
    /// CONST_VEL.
    #[inline(always)]
    pub(crate) fn between<'a>(
        &'a self,
        [v, w]: [Speed; 2],
        length: f32,
        room: &'a mut Option<Self>,
    ) -> &'a Self {
        if !self.is_loose_between([v, w], length) {
            return self;
        }
        room.insert(self.loosened_to(speed_f32(v.max(w).to_bits())))
    }

    /// The limits with all acceleration of the axes.
    #[cold]
    #[inline(never)]
    fn loosened(&self) -> Self {
        let (mut limits, a) = (*self, self.loose.get());
        (limits.a_up, limits.a_down) = (max(a, limits.a_up), max(a, limits.a_down));
        if let SlopeLaw::Stepped { a_up, a_down, still, .. } = &mut limits.law {
            (*a_up, *a_down, *still) = (max(a, *a_up), max(a, *a_down), max(a, *still));
        }
        limits
    }

    /// The ramp that loses speed with all acceleration of the axes, seen backward from the lower speed.
    #[inline(always)]
    pub(crate) fn loose_brake(&self) -> Ramp {
        if self.loose.is_some() { self.loosened_brake() } else { self.brake() }
    }

    #[cold]
    #[inline(never)]
    fn loosened_brake(&self) -> Ramp {
        self.loosened().brake()
    }

    /// The lowest speed that counts as the constant speed, mm/tick.
    #[inline(always)]
    fn lowest(&self) -> f32 {
        LOOSE * self.v
    }

    /// Limits of a stop. `above`: the deceleration. With STEP, `above` acts above the speed `lower`, and
    /// `below` acts below that speed. `jerks`: mean jerks at the start and at the end of the braking; they
    /// have no effect with STEP. `ends`: mean jerk with which a positive acceleration falls to zero; a higher
    /// value in `self` stays. The ramps of the stop are linear.
    pub fn braked(&self, [above, below]: [f32; 2], lower: f32, jerks: [f32; 2], ends: f32) -> Self {
        let mut limits = *self;
        match &mut limits.law {
            SlopeLaw::JerkLimited { shape, j: [_, gain, rise, fall], .. } => {
                [*rise, *fall] = jerks;
                *gain = max(*gain, ends) * shape.peak_jerk();
                *shape = RampShape::Linear;
                limits.a_down = above;
            }
            SlopeLaw::Stepped { change_over, a_down, .. } => {
                (*change_over, *a_down) = (lower, above);
                limits.a_down = below;
            }
        }
        limits
    }

    /// Highest factor, at most 1, by which any motion inside these limits may be slowed down without leaving
    /// them. The factor is accurate to 2^-22. Accelerations scale with the square of the factor, so the
    /// factor is 1 except for STEP. With STEP, a scaled speed may fall below the change-over speed, where the
    /// permitted acceleration may be lower.
    pub fn part_inside(&self) -> f32 {
        match self.law {
            SlopeLaw::JerkLimited { .. } => 1.0,
            SlopeLaw::Stepped { a_up, a_down, .. } => {
                let part = min(self.a_up / a_up, self.a_down / a_down);
                if part < 1.0 { sqrt_f32(part) * ROUNDED } else { 1.0 }
            }
        }
    }

    /// Whether one braking is about as good for both limits as two brakings in sequence. Only STEP can return
    /// `false`: it may change its deceleration anywhere, so two brakings may be clearly faster.
    pub fn slows_alike(&self, other: &Self) -> bool {
        let near = |a: f32, b: f32| min(a, b) >= NEAR * max(a, b);
        match (&self.law, &other.law) {
            (SlopeLaw::Stepped { a_down, .. }, SlopeLaw::Stepped { a_down: other_a_down, .. }) => {
                near(self.a_down, other.a_down) && near(*a_down, *other_a_down)
            }
            _ => true,
        }
    }

    /// Whether a braking with these limits is at least as hard as with the limits `other`, except for
    /// rounding. The first value is for the braking until the deceleration falls, the second for the whole
    /// braking. Always `false` with STEP: see [`Self::brakes_above`].
    pub fn brakes_like(&self, other: &Self) -> [bool; 2] {
        match (&self.law, &other.law) {
            (
                SlopeLaw::JerkLimited { j: [.., rise, fall], .. },
                SlopeLaw::JerkLimited { j: [.., other_rise, other_fall], .. },
            ) => {
                let begins = *rise >= other_rise * AS_HARD && self.a_down >= other.a_down * AS_HARD;
                [begins, begins && *fall >= other_fall * AS_HARD]
            }
            _ => [false; 2],
        }
    }

    /// For STEP: whether the lowest deceleration of `self` is at least the highest deceleration of `other`.
    /// `false` with other slopes.
    pub fn brakes_above(&self, other: &Self) -> bool {
        match (&self.law, &other.law) {
            (SlopeLaw::Stepped { a_down, .. }, SlopeLaw::Stepped { a_down: above, .. }) => {
                min(self.a_down, *a_down) >= max(other.a_down, *above)
            }
            _ => false,
        }
    }

    /// Whether the look-ahead may permit acceleration at the ends of slow blocks: HSC with NO_OPT=0.
    pub(crate) fn may_have_valleys(&self) -> bool {
        matches!(self.law, SlopeLaw::JerkLimited { joins: Joins::Valleys, .. })
    }

    /// Whether blocks with other speeds may share a span with this block: [`Joins::Any`].
    pub fn varies(&self) -> bool {
        matches!(self.law, SlopeLaw::JerkLimited { joins: Joins::Any | Joins::Valleys, .. })
    }

    /// The limits of a profile that is slowed down to `part` of its speed, with a margin for rounding.
    /// Accelerations scale with the square of `part`, jerks with the cube.
    pub fn at_part(&self, part: f32) -> Self {
        let mut limits = *self;
        if part >= 1.0 {
            return limits;
        }
        let square = min(part * part * (2.0 - ROUNDED), 1.0);
        limits.v *= part;
        limits.loose.scale(square);
        limits.a_up *= square;
        limits.a_down *= square;
        if let SlopeLaw::JerkLimited { j, .. } = &mut limits.law {
            *j = j.map(|j| j * (square * part));
        }
        limits
    }

    /// Halves the jerk with which an acceleration rises, for a gentler gain of speed. Also removes [`Loose`],
    /// the acceleration that CONST_VEL permits near a stop.
    pub const fn gain_gently(&mut self) {
        self.loose = Loose::NONE;
        if let SlopeLaw::JerkLimited { j: [rise, ..], .. } = &mut self.law {
            *rise *= 0.5;
        }
    }

    /// Copies the acceleration, and the jerks with which it rises and falls, from `other`. Both limits have
    /// the same slope.
    pub const fn gain_like(&mut self, other: &Self) {
        self.a_up = other.a_up;
        if let (
            SlopeLaw::JerkLimited { j: [rise, fall, ..], .. },
            SlopeLaw::JerkLimited { j: [others_rise, others_fall, ..], .. },
        ) = (&mut self.law, &other.law)
        {
            (*rise, *fall) = (*others_rise, *others_fall);
        }
    }

    /// Mean jerk of one of the four [`Ramps`], mm/tick³; `f32::MAX` for STEP. `ramp`: 0 to 3.
    pub fn jerk(&self, ramp: usize) -> f32 {
        match self.law {
            SlopeLaw::JerkLimited { j, .. } => j.get(ramp).copied().unwrap_or(0.0),
            SlopeLaw::Stepped { .. } => f32::MAX,
        }
    }

    /// Highest mean jerk of the four ramps, mm/tick³; `f32::MAX` for STEP.
    pub fn steepest(&self) -> f32 {
        (0..4).fold(0.0, |most, ramp| max(most, self.jerk(ramp)))
    }

    /// Speed, acceleration and jerk that a motion may have while it gains speed and while it brakes. Returns
    /// `None` with STEP, which has no jerk limit.
    pub fn along(&self) -> Option<[f32; 3]> {
        let SlopeLaw::JerkLimited { j, .. } = self.law else { return None };
        Some([self.v, min(self.a_up, self.a_down), j.into_iter().fold(f32::MAX, min)])
    }

    /// Lowers the speed limit to the higher one of the two end speeds of a span.
    pub(crate) fn flatten(&mut self, v_in: Speed, v_out: Speed) {
        self.v = speed_f32(v_in.max(v_out).to_bits());
    }

    /// Largest acceleration or deceleration in `self` and `other`, mm/tick².
    pub(crate) fn fastest(&self, other: &Self) -> f32 {
        max(max(self.a_up, self.a_down), max(other.a_up, other.a_down))
    }

    /// Whether `self` permits clearly more acceleration or jerk than `other`.
    pub(crate) fn is_stronger(&self, other: &Self) -> bool {
        let jerks = (0..4).any(|ramp| self.jerk(ramp) > STRONGER * other.jerk(ramp));
        jerks || self.a_up > STRONGER * other.a_up || self.a_down > STRONGER * other.a_down
    }

    /// Makes the ramps linear. Returns the earlier value of [`Self::law`], to restore it.
    pub const fn straighten(&mut self) -> SlopeLaw {
        let before = self.law;
        if let SlopeLaw::JerkLimited { shape, .. } = &mut self.law {
            *shape = RampShape::Linear;
        }
        before
    }

    /// The largest acceleration or deceleration at any speed, mm/tick².
    pub(crate) fn most(&self) -> f32 {
        let a = max(self.a_up, self.a_down);
        match self.law {
            SlopeLaw::JerkLimited { .. } => a,
            SlopeLaw::Stepped { a_up, a_down, .. } => max(a, max(a_up, a_down)),
        }
    }

    /// The least acceleration or deceleration at any speed, mm/tick².
    pub(crate) fn least(&self) -> f32 {
        let a = min(self.a_up, self.a_down);
        match self.law {
            SlopeLaw::JerkLimited { .. } => a,
            SlopeLaw::Stepped { a_up, a_down, .. } => min(a, min(a_up, a_down)),
        }
    }

    /// The ramp with which the speed rises inside these limits.
    pub fn speed_up(&self) -> Ramp {
        match self.law {
            SlopeLaw::JerkLimited { shape, j: [rise, fall, ..], .. } => {
                Ramp::JerkLimited(JerkLimited::new(shape, self.a_up, rise, fall))
            }
            SlopeLaw::Stepped { change_over, a_up, built, .. } => {
                Ramp::Stepped(Stepped { a: [self.a_up, a_up], change_over, built })
            }
        }
    }

    /// The ramp with which the speed falls inside these limits. The ramp is seen backward, from its lower
    /// speed.
    pub fn brake(&self) -> Ramp {
        match self.law {
            SlopeLaw::JerkLimited { shape, j: [.., rise, fall], .. } => {
                Ramp::JerkLimited(JerkLimited::new(shape, self.a_down, fall, rise))
            }
            SlopeLaw::Stepped { change_over, a_down, built, .. } => {
                Ramp::Stepped(Stepped { a: [self.a_down, a_down], change_over, built })
            }
        }
    }

    /// Multiplies all accelerations by `part`.
    pub(crate) fn scale_accelerations(&mut self, part: f32) {
        self.a_up *= part;
        self.a_down *= part;
        self.loose.scale(part);
        if let SlopeLaw::Stepped { a_up, a_down, .. } = &mut self.law {
            *a_up *= part;
            *a_down *= part;
        }
    }

    /// Lowers all accelerations to at most `a`.
    pub(crate) fn lower_accelerations(&mut self, a: f32) {
        self.a_up = min(a, self.a_up);
        self.a_down = min(a, self.a_down);
        self.loose.lower(a);
        if let SlopeLaw::Stepped { a_up, a_down, still, .. } = &mut self.law {
            *a_up = min(*a_up, a);
            *a_down = min(*a_down, a);
            *still = min(*still, a);
        }
    }

    /// Lowers all accelerations to at most `a` at the speed of the limits, where a curve needs the rest of
    /// the acceleration. At standstill, up to `rest` is permitted. `right_angle`: the curve's part is at a
    /// right angle to the path.
    pub(crate) fn curve(&mut self, a: f32, rest: f32, right_angle: bool) {
        self.lower_accelerations(a);
        if let SlopeLaw::Stepped { still, across, .. } = &mut self.law {
            (*still, *across) = (rest, right_angle);
        }
    }

    /// Deceleration of STEP at the speed `v`, which is below the change-over speeds. V is the speed of these
    /// limits, and q = v/V. A curve leaves at least
    ///
    /// - a(0) − (a(0) − a(V))·q²: an axis has a_max − |x''|·v² left for |x'|·a;
    /// - √(a(0)² − (a(0)² − a(V)²)·q⁴) for an arc, which has √(a_max² − v⁴·κ²).
    fn left_at(&self, v: f32, still: f32, across: bool) -> f32 {
        let q = min(v / max(self.v, f32::MIN_POSITIVE), 1.0);
        let (part, low) = (q * q, self.a_down);
        let left = if across {
            sqrt_f32(max(still * still - (still * still - low * low) * (part * part), 0.0))
        } else {
            still - (still - low) * part
        };
        max(low, left * LEAVES)
    }

    /// The first two stages of a braking with STEP from the speed `v`, in a curve that permits more
    /// deceleration as the speed falls. Returns `None` with another slope, or if `v` is above the change-over
    /// speed.
    pub fn fall(&self, v: f32) -> Option<Fall> {
        let SlopeLaw::Stepped { change_over, still, across, .. } = self.law else { return None };
        if v > change_over {
            return None;
        }
        let a = self.left_at(v, still, across);
        if a * (STAGE * STAGE) >= still {
            return Some(Fall { from: v, change_over: LAST * v, to: 0.0 });
        }
        // The speed at which the curve leaves `times` as much deceleration, and at most `part` of the speed.
        let at = |times: f32, part: f32| {
            let (a, low) = (times * a, self.a_down);
            let q = if across {
                sqrt_f32(sqrt_f32(max(still * still - a * a, 0.0) / (still * still - low * low)))
            } else {
                sqrt_f32(max(still - a, 0.0) / (still - low))
            };
            min(self.v * q, part * v)
        };
        Some(Fall { from: v, change_over: at(STAGE, LEAST[0]), to: at(STAGE * STAGE, LEAST[1]) })
    }

    /// Approximate path length of a braking to a stop with STEP from the speed `v`, mm. Returns `None` with
    /// another slope, or if `v` is above the change-over speed.
    pub fn falls(&self, v: f32) -> Option<f32> {
        let SlopeLaw::Stepped { change_over, still, across, .. } = self.law else { return None };
        let part = |k: u8| 1.0 - f32::from(k) * (1.0 / f32::from(PARTS));
        let lost = |k: u8| {
            (part(k) * part(k) - part(k + 1) * part(k + 1)) / self.left_at(part(k) * v, still, across)
        };
        (v <= change_over).then(|| 0.5 * v * v * (0..PARTS).map(lost).sum::<f32>())
    }

    /// STEP: sets the decelerations of both stages of the braking `fall`, and the speed between the stages.
    /// No effect if the braking starts above the change-over speed.
    pub fn fall_from(&mut self, fall: &Fall) {
        let SlopeLaw::Stepped { change_over, still, across, .. } = self.law else { return };
        if fall.from > change_over {
            return;
        }
        let [above, below] = [fall.from, fall.change_over].map(|v| self.left_at(v, still, across));
        self.a_down = below;
        if let SlopeLaw::Stepped { change_over, a_down, .. } = &mut self.law {
            (*change_over, *a_down) = (fall.change_over, above);
        }
    }
}

#[inline]
pub(crate) fn lower<const N: usize>(values: &mut [f32; N], others: [f32; N]) {
    for (value, other) in values.iter_mut().zip(others) {
        *value = min(other, *value);
    }
}
