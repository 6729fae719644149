//! Permitted path speed, acceleration and jerk, how those of several elements become one, and the ramps they
//! give.
use super::ramp::{JerkLimited, Ramp, Stepped};
use super::ramp_shape::RampShape;
use crate::math::float::{magnitude, max, min};
use crate::math::root::sqrt_f32;
use crate::quantity::{Speed, speed_f32};

/// A speed that was lowered by this stays below its limit, whatever rounding.
pub(crate) const ROUNDED: f32 = 1.0 - 1.0 / 4_194_304.0;
/// Two limits that differ by less are alike. Of the speeds a span has the higher one: four roundings.
const ALIKE: f32 = 1.0 / 262_144.0;
const ALIKE_SPEED: f32 = 1.0 / 4_194_304.0;
/// A slowing down is as hard as another one with that part of its limits: what it is faster by is less than speeds
/// leave for rounding.
const AS_HARD: f32 = 1.0 - 1.0 / 131_072.0;
/// An acceleration below this part of another one is far less.
const WEAK: f32 = 1.0 / 64.0;
/// The same between parts of one curve.
const WEAK_PART: f32 = 1.0 / 5.0;
/// Clearly more.
const STRONGER: f32 = 1.125;
/// A stage of a way down has so many times the deceleration of the one before; the last one begins at that
/// part of the speed at most.
const STAGE: f32 = 1.25;
const LAST: f32 = 0.7;
/// Each stage takes that part of the speed in any case: a curve may leave next to nothing at its highest.
const LEAST: [f32; 2] = [0.9975, 0.995];
/// Two decelerations of STEP above that part of each other are one.
const NEAR: f32 = 0.85;
/// Parts of a way down whose length is to be known about.
const PARTS: u8 = 6;
/// Below that part of its speed, that of a curve with CONST_VEL may change.
const LOOSE: f32 = 0.25;
/// For rounding.
const LEAVES: f32 = 1.0 - 1.0 / 1_048_576.0;
/// The four ramps of a slope: acceleration rises, falls, deceleration rises, falls.
pub type Ramps = [f32; 4];

/// Blocks that may follow each other without acceleration zero between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joins {
    /// With the same limits: TRAPEZ, SIN2.
    Alike = 0,
    /// All: HSC, and elements of one curve with TRAPEZ and SIN2.
    Any = 4,
    /// All, and slow ones may be entered and left with acceleration: HSC with NO_OPT=0.
    Valleys = 8,
}

/// Limits of a slope in addition to speed and acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SlopeLaw {
    /// TRAPEZ, SIN2, HSC.
    JerkLimited {
        /// Shape of the ramps.
        shape: RampShape,
        /// What may follow without acceleration zero between.
        joins: Joins,
        /// Mean jerk of each ramp.
        j: Ramps,
    },
    /// STEP: the path has one change-over speed, that of the axis which reaches its own first.
    Stepped {
        /// Speed up to which the accelerations of the limits hold.
        change_over: f32,
        /// Acceleration above it.
        a_up: f32,
        /// Deceleration above it.
        a_down: f32,
        /// Deceleration at standstill: what a curve takes of it falls with the square of the speed.
        still: f32,
        /// That is at a right angle to the path.
        across: bool,
    },
}

/// Permitted values along the path: mm/tick, mm/tick², mm/tick³.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Speed.
    pub v: f32,
    /// Acceleration.
    pub a_up: f32,
    /// Deceleration.
    pub a_down: f32,
    /// Limits of the slope in addition.
    pub law: SlopeLaw,
    /// Accelerations at low speed, where a speed is to stay constant (CONST_VEL).
    pub loose: Loose,
}

/// Acceleration and deceleration at low speed where a speed is to stay constant (CONST_VEL), mm/tick²; 0 elsewhere.
///
/// With CONST_VEL accelerations are next to nothing. A profile that begins or ends below a part of that speed, near a stop,
/// may have this acceleration, which the axes permit at any speed of the limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loose(f32);

impl Loose {
    /// No speed is to stay.
    pub const NONE: Self = Self(0.0);

    /// The same acceleration everywhere.
    pub const fn of(a: f32) -> Self {
        Self(a)
    }

    /// The acceleration, mm/tick².
    pub const fn get(self) -> f32 {
        self.0
    }

    /// Whether there is such a speed.
    #[inline(always)]
    pub fn is_some(self) -> bool {
        self.0 > 0.0
    }

    /// No more than that.
    pub fn lower(&mut self, a: f32) {
        self.0 = min(self.0, a);
    }

    /// Multiplies the limits by `part`.
    pub fn scale(&mut self, part: f32) {
        self.0 *= part;
    }
}

/// A braking with STEP in two stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fall {
    /// Speed at its start.
    pub from: f32,
    /// Speed at which the second stage begins.
    pub change_over: f32,
    /// Speed at its end.
    pub to: f32,
}

impl Limits {
    /// No limit.
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

    /// Whether they are the others but for rounding.
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

    /// Becomes what both permit; of the speeds the higher one.
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
                // What both leave below their speeds is not known of the higher one.
                *still = self.a_down;
            }
            _ => {}
        }
    }

    /// Becomes those of a slowing down that goes on from here into a motion with the others; what ends a gain
    /// of speed stays.
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
                    // Between both of them one has the deceleration of the lower stage.
                    *change_over = min(*change_over, *other_change_over);
                    *a_down = min(*a_down, self.a_down);
                }
            }
            _ => {}
        }
    }

    /// Whether a law from one speed to another, in any direction, over `length` mm may have all of the acceleration that
    /// the axes have: where the speed is to stay, if one of both speeds is low, or if the change takes it in that direction.
    /// What was low beside the speed that is to stay need not be so beside a lower one, of an override that came later.
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

    /// Whether a law that has that speed at one end may have all of the acceleration that the axes have.
    #[inline(always)]
    fn is_loose_at(&self, low: Speed) -> bool {
        self.loose.is_some() && speed_f32(low.to_bits()) < self.lowest()
    }

    /// Those of a law that may have that acceleration: it is no faster than `high`, mm/tick, and the low speed.
    #[cold]
    #[inline(never)]
    fn loosened_to(&self, high: f32) -> Self {
        Self { v: min(self.v, max(high, self.lowest())), ..self.loosened() }
    }

    /// Those of a law that has that speed at one end.
    #[inline(always)]
    pub(crate) fn near<'a>(&'a self, low: Speed, room: &'a mut Option<Self>) -> &'a Self {
        if self.is_loose_at(low) { room.insert(self.loosened_to(0.0)) } else { self }
    }

    /// Those of a law from one speed to another, in any direction, over `length` mm.
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

    /// With all of the acceleration that the axes have.
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

    /// The slope that loses speed with all of the acceleration that the axes have, seen backward from the lower speed.
    #[inline(always)]
    pub(crate) fn loose_brake(&self) -> Ramp {
        if self.loose.is_some() { self.loosened_brake() } else { self.brake() }
    }

    #[cold]
    #[inline(never)]
    fn loosened_brake(&self) -> Ramp {
        self.loosened().brake()
    }

    /// Where a speed is to stay, that is so from this one on, mm/tick.
    #[inline(always)]
    fn lowest(&self) -> f32 {
        LOOSE * self.v
    }

    /// Limits of a stop with these decelerations and jerks, at its start and at its end. With STEP the second
    /// deceleration acts from the speed `lower` on. An acceleration falls with the mean jerk `ends`, if that is more.
    /// The ramps are linear.
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

    /// Highest part of its speeds at which any motion inside the limits is inside them as well. Its accelerations are
    /// the square of that part, so any will do, but with STEP where less acceleration is permitted below the change-over
    /// speed than above: what was above may then be below. 0..=1, within 2^-22.
    pub fn part_inside(&self) -> f32 {
        match self.law {
            SlopeLaw::JerkLimited { .. } => 1.0,
            SlopeLaw::Stepped { a_up, a_down, .. } => {
                let part = min(self.a_up / a_up, self.a_down / a_down);
                if part < 1.0 { sqrt_f32(part) * ROUNDED } else { 1.0 }
            }
        }
    }

    /// Whether one braking suits both limits about as well as one after the other. It matters for STEP, whose
    /// deceleration may change anywhere; with other slopes the answer is yes.
    pub fn slows_alike(&self, other: &Self) -> bool {
        let near = |a: f32, b: f32| min(a, b) >= NEAR * max(a, b);
        match (&self.law, &other.law) {
            (SlopeLaw::Stepped { a_down, .. }, SlopeLaw::Stepped { a_down: other_a_down, .. }) => {
                near(self.a_down, other.a_down) && near(*a_down, *other_a_down)
            }
            _ => true,
        }
    }

    /// Whether a slowing down with these limits is at least as hard as with the others, but for rounding: until its
    /// deceleration falls, and later.
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

    /// For STEP: whether each of its decelerations is above those of the others.
    pub fn brakes_above(&self, other: &Self) -> bool {
        match (&self.law, &other.law) {
            (SlopeLaw::Stepped { a_down, .. }, SlopeLaw::Stepped { a_down: above, .. }) => {
                min(self.a_down, *a_down) >= max(other.a_down, *above)
            }
            _ => false,
        }
    }

    /// NO_OPT=0.
    pub(crate) fn may_have_valleys(&self) -> bool {
        matches!(self.law, SlopeLaw::JerkLimited { joins: Joins::Valleys, .. })
    }

    /// Whether blocks with other speeds may be in one span with it: [`Joins::Any`].
    pub fn varies(&self) -> bool {
        matches!(self.law, SlopeLaw::JerkLimited { joins: Joins::Any | Joins::Valleys, .. })
    }

    /// The limits of the same profile at `part` of its speed: accelerations with the square, jerks with the cube, and a
    /// little more for rounding.
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

    /// Speed is gained with half of the jerk at first, and with no more acceleration than near the speed of the limits.
    pub const fn gain_gently(&mut self) {
        self.loose = Loose::NONE;
        if let SlopeLaw::JerkLimited { j: [rise, ..], .. } = &mut self.law {
            *rise *= 0.5;
        }
    }

    /// Takes over how the others accelerate; both have the same slope.
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

    /// Jerk of a ramp; 0 for STEP.
    pub fn jerk(&self, ramp: usize) -> f32 {
        match self.law {
            SlopeLaw::JerkLimited { j, .. } => j.get(ramp).copied().unwrap_or(0.0),
            SlopeLaw::Stepped { .. } => f32::MAX,
        }
    }

    /// Highest jerk of a ramp.
    pub fn steepest(&self) -> f32 {
        (0..4).fold(0.0, |most, ramp| max(most, self.jerk(ramp)))
    }

    /// Speed, acceleration and jerk that a motion may have in both directions; `None` with a slope that has
    /// no jerk.
    pub fn along(&self) -> Option<[f32; 3]> {
        let SlopeLaw::JerkLimited { j, .. } = self.law else { return None };
        Some([self.v, min(self.a_up, self.a_down), j.into_iter().fold(f32::MAX, min)])
    }

    /// Permits no speed above those.
    pub(crate) fn flatten(&mut self, v_in: Speed, v_out: Speed) {
        self.v = speed_f32(v_in.max(v_out).to_bits());
    }

    /// Largest acceleration or deceleration of both.
    pub(crate) fn fastest(&self, other: &Self) -> f32 {
        max(max(self.a_up, self.a_down), max(other.a_up, other.a_down))
    }

    /// Whether neither has far less acceleration, or deceleration, than the other. `flows`: between parts of
    /// one curve, of which many are in one span.
    pub(crate) fn is_as_strong(&self, other: &Self, flows: bool) -> bool {
        let weak = if flows { WEAK_PART } else { WEAK };
        let near = |a: f32, b: f32| min(a, b) >= weak * max(a, b);
        near(self.a_up, other.a_up) && near(self.a_down, other.a_down)
    }

    /// Whether it has clearly more acceleration or jerk.
    pub(crate) fn is_stronger(&self, other: &Self) -> bool {
        let jerks = (0..4).any(|ramp| self.jerk(ramp) > STRONGER * other.jerk(ramp));
        jerks || self.a_up > STRONGER * other.a_up || self.a_down > STRONGER * other.a_down
    }

    /// Makes the ramps linear, and returns the slope before.
    pub const fn straighten(&mut self) -> SlopeLaw {
        let before = self.law;
        if let SlopeLaw::JerkLimited { shape, .. } = &mut self.law {
            *shape = RampShape::Linear;
        }
        before
    }

    /// The largest acceleration or deceleration at any speed.
    pub(crate) fn most(&self) -> f32 {
        let a = max(self.a_up, self.a_down);
        match self.law {
            SlopeLaw::JerkLimited { .. } => a,
            SlopeLaw::Stepped { a_up, a_down, .. } => max(a, max(a_up, a_down)),
        }
    }

    /// The least of them.
    pub(crate) fn least(&self) -> f32 {
        let a = min(self.a_up, self.a_down);
        match self.law {
            SlopeLaw::JerkLimited { .. } => a,
            SlopeLaw::Stepped { a_up, a_down, .. } => min(a, min(a_up, a_down)),
        }
    }

    /// The slope that gains speed.
    pub fn speed_up(&self) -> Ramp {
        match self.law {
            SlopeLaw::JerkLimited { shape, j: [rise, fall, ..], .. } => {
                Ramp::JerkLimited(JerkLimited::new(shape, self.a_up, rise, fall))
            }
            SlopeLaw::Stepped { change_over, a_up, .. } => {
                Ramp::Stepped(Stepped { a: [self.a_up, a_up], change_over })
            }
        }
    }

    /// The slope that loses speed, seen backward from the lower one.
    pub fn brake(&self) -> Ramp {
        match self.law {
            SlopeLaw::JerkLimited { shape, j: [.., rise, fall], .. } => {
                Ramp::JerkLimited(JerkLimited::new(shape, self.a_down, fall, rise))
            }
            SlopeLaw::Stepped { change_over, a_down, .. } => {
                Ramp::Stepped(Stepped { a: [self.a_down, a_down], change_over })
            }
        }
    }

    /// Accelerations times `part`.
    pub(crate) fn scale_accelerations(&mut self, part: f32) {
        self.a_up *= part;
        self.a_down *= part;
        self.loose.scale(part);
        if let SlopeLaw::Stepped { a_up, a_down, .. } = &mut self.law {
            *a_up *= part;
            *a_down *= part;
        }
    }

    /// No acceleration above `a`.
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

    /// No acceleration above `a` at their speed, where a curve takes the rest of it, at a right angle to the
    /// path or not; at standstill up to `rest`.
    pub(crate) fn curve(&mut self, a: f32, rest: f32, right_angle: bool) {
        self.lower_accelerations(a);
        if let SlopeLaw::Stepped { still, across, .. } = &mut self.law {
            (*still, *across) = (rest, right_angle);
        }
    }

    /// Deceleration of STEP at the speed `v`, at most the lower change-over speed. With V, the speed of these
    /// limits, and V·q = v a curve leaves at least
    ///
    /// - a(0) − (a(0) − a(V))·q², as an axis has a_max − |x''|·v² left for |x'|·a;
    /// - √(a(0)² − (a(0)² − a(V)²)·q⁴) of an arc, which has √(a_max² − v⁴·κ²).
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

    /// The braking of STEP from the speed `v`, where a curve permits more while speed falls. `None` with another slope,
    /// or above the change-over speed.
    pub fn fall(&self, v: f32) -> Option<Fall> {
        let SlopeLaw::Stepped { change_over, still, across, .. } = self.law else { return None };
        if v > change_over {
            return None;
        }
        let a = self.left_at(v, still, across);
        if a * (STAGE * STAGE) >= still {
            return Some(Fall { from: v, change_over: LAST * v, to: 0.0 });
        }
        // The speed at which it leaves so many times more; a little lower in any case.
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

    /// Path length of a braking of STEP from the speed `v`, mm, about. `None` with another slope, or above the
    /// change-over speed.
    pub fn falls(&self, v: f32) -> Option<f32> {
        let SlopeLaw::Stepped { change_over, still, across, .. } = self.law else { return None };
        let part = |k: u8| 1.0 - f32::from(k) * (1.0 / f32::from(PARTS));
        let lost = |k: u8| {
            (part(k) * part(k) - part(k + 1) * part(k + 1)) / self.left_at(part(k) * v, still, across)
        };
        (v <= change_over).then(|| 0.5 * v * v * (0..PARTS).map(lost).sum::<f32>())
    }

    /// For STEP: takes the limits of that braking.
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
