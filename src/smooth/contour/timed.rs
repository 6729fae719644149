//! A curve over time for a corner between two lines. The motion along the first line brakes to a stop. The
//! motion along the second line starts before the first motion has ended, and accelerates. The curve is the
//! sum of both motions. Both change their speed by a trapezoid of acceleration, with ramps of constant jerk.
//!
//! ```text
//! Q(t) = C − t1·p(T − t) + t2·p(t − S)      p: path from rest to the speed v in the time T,  S = T − overlap
//! ```
//!
//! C is the corner point; t1 and t2 are the directions of the lines.
//!
//! **Why this shape.** With a small tolerance, only the last ramp of the first motion and the first ramp of
//! the second overlap. The curve is then the cubic Q = C − c·t1·(1 − u)³ + c·t2·u³, with u = 0…1 over the
//! overlap. This shape is the fastest one that keeps the jerk of every axis. A curve over arc length is
//! slower, because its jerk has the term 3·κ·v·a, with the curvature κ and the acceleration a along the path.
//! If speed, acceleration and jerk are limited separately, either v is low there or a is zero.
//!
//! So the path distance of this curve is the time multiplied by the feed: σ = v·t. Between two changes of
//! jerk, each axis is a polynomial of the third degree in σ. At the constant path speed v, every axis moves
//! as planned. At a lower path speed r·v, all accelerations have the factor r² and all jerks the factor r³.
//! If both motions overlap completely, each axis changes its speed by one trapezoid of acceleration: the
//! curve of DIST_SOFT.
//!
//! DIST_MASTER uses this curve with the travel of the master axis as path ([`mod@crate::path::measure`]). The
//! tangent of the master axis is 1 on both lines and along the whole curve, so the master keeps its speed.
//!
//! In space, the speed along the curve is lower than v, and much lower at the corner. So CONST_VEL excludes
//! this curve.
//!
//! **Deviation.** At the middle of the overlap, both motions are equally far from the corner: p(overlap/2) =
//! e. The curve is there e·|t2 − t1| from the corner. Every other point is at most e·sin θ from the nearer
//! line, which is less.
//!
//! **Numbers.** The overlap is computed in `f32`. The curve itself uses integers with 62 fraction bits: p as
//! a fraction of the length of one motion, and the place as a fraction of its path.
use super::LSB_40;
use crate::math::divide::reciprocal_near;
use crate::math::float::{magnitude, max, min, to_bits, to_f32};
use crate::math::root::{cbrt_f32, sqrt_f32};
use crate::math::wide::{mul_hi_u, mul_near, mul_shift};
use crate::path::poly::{Draft, Knot};
use crate::path::{Element, End, Passage};
use crate::quantity::{DISTANCE_LSB, Position};

/// A motion along a line from a stop to the speed `v`, in mm and ticks; run backward, from `v` to a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rise {
    /// Duration of each ramp of acceleration, and duration of the constant acceleration between the ramps,
    /// ticks.
    ramp: f32,
    hold: f32,
    /// The speed that the motion reaches, mm/tick.
    pub v: f32,
}

impl Rise {
    /// The fastest rise to the speed `v` with at most the acceleration `a` and the jerk `j`.
    pub fn new(v: f32, a: f32, j: f32) -> Self {
        let full = a / j;
        let ramp = min(full, sqrt_f32(v / j));
        let hold = if v > a * full { max(v / a - ramp, 0.0) } else { 0.0 };
        Self { ramp, hold, v }
    }

    /// The fastest rise that covers at most `distance`. The speed is at most `v`.
    pub fn within(distance: f32, v: f32, a: f32, j: f32) -> Self {
        let full = a * a / j;
        let mut fastest = cbrt_f32(distance * distance * j);
        if fastest > full {
            fastest = 2.0 * a * distance / (0.5 * full + sqrt_f32(0.25 * full * full + 2.0 * a * distance));
        }
        // The speed is slightly lower, so that rounding does not lead beyond the middle of a block.
        Self::new(min(v, fastest * SHORTER), a, j)
    }

    /// The speed of the rise that has covered `off` after half its time, with acceleration `a` and jerk `j`.
    pub fn speed_of(off: f32, a: f32, j: f32) -> f32 {
        let full = a * a / j;
        let v = cbrt_f32(36.0 * off * off * j);
        // Beyond the ramps: with the ramp time r the distance is a·(r²/6 + u·(r + u)/2) at half the time r +
        // u.
        if v <= full { v } else { 2.0 * sqrt_f32(2.0 * a * off - full * full * (1.0 / 12.0)) }
    }

    /// The rise to the same speed that takes `by` times as long.
    pub fn stretched(self, by: f32) -> Self {
        Self { ramp: self.ramp * by, hold: self.hold * by, v: self.v }
    }

    /// Duration of the rise.
    fn time(&self) -> f32 {
        2.0 * self.ramp + self.hold
    }

    /// Length of the rise.
    pub fn distance(&self) -> f32 {
        0.5 * self.v * self.time()
    }

    /// Largest acceleration of the rise.
    fn acceleration(&self) -> f32 {
        self.v / (self.ramp + self.hold)
    }

    /// The time at which the rise has covered `path`. `path` is at most the distance after half the time.
    fn reaches(&self, path: f32) -> f32 {
        let (ramp, a) = (self.ramp, self.acceleration());
        let first = a * ramp * ramp * (1.0 / 6.0);
        let t = if path <= first {
            cbrt_f32(6.0 * path * ramp / a)
        } else {
            // a·(r·u + u²)/2 beyond that time.
            let beyond = 2.0 * (path - first) / a;
            ramp + beyond / (0.5 * ramp + sqrt_f32(0.25 * ramp * ramp + beyond))
        };
        min(t, 0.5 * self.time())
    }

    /// The time at which the rise has covered `path`, or slightly earlier.
    fn arrives(&self, path: f32) -> f32 {
        let (whole, distance) = (self.time(), self.distance());
        if path >= distance {
            return whole;
        }
        let mut time = self.reaches(path);
        if path > self.half_way() {
            // Newton's steps begin at the end. The speed grows, so no step goes too far. Seen from the end,
            // the motion covers less than at full speed, by the same amount as at its start.
            let missing = distance - path;
            let mut left = 0.0;
            for _ in 0..ARRIVAL_STEPS {
                let [p, v] = self.begun(left);
                left += (missing - (self.v * left - p)) / (self.v - v);
            }
            time = whole - left;
        }
        time * SHORTER
    }

    /// Path and speed at a time in its first half.
    fn begun(&self, t: f32) -> [f32; 2] {
        let (ramp, a) = (self.ramp, self.acceleration());
        if t <= ramp {
            let gained = 0.5 * a * t * t / ramp;
            [gained * t * (1.0 / 3.0), gained]
        } else {
            let u = t - ramp;
            [a * (ramp * ramp * (1.0 / 6.0) + u * 0.5 * (ramp + u)), a * (0.5 * ramp + u)]
        }
    }

    /// Distance after half of its time.
    pub fn half_way(&self) -> f32 {
        self.begun(0.5 * self.time())[0]
    }
}

/// Margin for rounding.
const SHORTER: f32 = 1.0 - 1.0 / 1_048_576.0;

/// A curve over time as two motions: one brakes on the first line, the other starts on the second line before
/// the first has ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// The second motion. The first motion is the same rise backward in time.
    pub rise: Rise,
    /// Time in which both motions overlap, ticks.
    pub time: f32,
}

impl Overlap {
    /// An overlap of the whole motions: both begin and end at the same time.
    pub fn whole(rise: Rise) -> Self {
        Self { rise, time: rise.time() }
    }

    /// Overlap in which each motion is `off` from the corner when both are equally far from the corner.
    pub fn off(rise: Rise, off: f32) -> Self {
        Self { rise, time: 2.0 * rise.reaches(off) }
    }

    /// Overlap in which the first motion is `distance` from the corner when the second one begins.
    pub fn from_distance(rise: Rise, distance: f32) -> Self {
        Self { rise, time: rise.arrives(distance) }
    }

    /// This overlap, shortened so that only the last ramp of one motion and the first ramp of the other
    /// overlap.
    pub fn brief(self) -> Self {
        Self { time: min(self.time, self.rise.ramp), ..self }
    }

    /// Whether only one ramp of each motion is inside the overlap.
    pub fn is_brief(&self) -> bool {
        self.time <= self.rise.ramp
    }

    /// Whether the curve is long enough for set points at ticks, and fits into the format of a polynomial.
    pub fn is_long(&self) -> bool {
        self.time >= SHORTEST && self.rise.distance() <= LONGEST
    }

    /// Time from the start of the first motion to the end of the second.
    pub fn duration(&self) -> f32 {
        2.0 * self.rise.time() - self.time
    }
}

/// Shortest common time, ticks, and longest distance of a motion, mm.
const SHORTEST: f32 = 4.0;
const LONGEST: f32 = 2048.0;

/// Number of Newton's steps, which reduce the error from half the time to 10^-7 of the time.
const ARRIVAL_STEPS: usize = 4;

/// Shortest piece, ticks. In such a short piece, the rounding of the third derivative has no effect on the
/// set points of ticks.
const LEAST: f32 = 1.0 / 4096.0;

/// Number of changes of jerk up to the middle, plus one for the middle.
const PIECES: usize = 4;

/// 1.0 with 62 fraction bits, and thirds of it.
const ONE: i64 = 1 << 62;
const THIRD: i64 = ONE / 3;
const LSB_62: f32 = 1.0 / (1u64 << 62) as f32;

/// a·b of numbers with 62 fraction bits.
fn times(a: i64, b: i64) -> i64 {
    mul_near(a, b) << 2
}

/// A number of which fractions are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Whole {
    /// Number of leading zeros, and the reciprocal of the shifted number.
    up: u32,
    reciprocal: u64,
}

impl Whole {
    /// For a number `all` above 0.
    fn new(all: i64) -> Self {
        let up = all.leading_zeros() & 63;
        Self { up, reciprocal: reciprocal_near(all.unsigned_abs() << up) }
    }

    /// The fraction `a` / number with 62 fraction bits; 0 ≤ `a` ≤ number.
    fn part(&self, a: i64) -> i64 {
        (mul_hi_u(a.unsigned_abs() << (self.up & 63), self.reciprocal) as i64).min(ONE)
    }
}

/// a·b / 2^`SHIFT`, quick if a factor is zero: often one of the motions stands still, or does not move an
/// axis.
#[cfg_attr(feature = "fast", inline(always))]
fn scaled<const SHIFT: u32>(a: i64, b: i64) -> i64 {
    if a == 0 || b == 0 { 0 } else { product::<SHIFT>(a, b) }
}

/// As [`scaled`], as a separate function, because there are many callers.
#[inline(never)]
fn product<const SHIFT: u32>(a: i64, b: i64) -> i64 {
    mul_shift(a, b, SHIFT)
}

/// A rise over the path s = v·t, LSB 2^-44 mm, scaled to a distance and a speed of 1. Fractions have 62
/// fraction bits.
///
/// α is the fraction of the path that a ramp takes, and k = 1/(1 − α). At the fraction q of the first ramp,
/// the distance is α²k/3·q³, the speed αk/2·q² and the acceleration k·q. After the ramp, at the fraction τ of
/// the whole path, they are k·(α²/3 + τ·(τ − α)), k·(τ − α/2) and k. The last ramp is the mirror image of the
/// first.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Form {
    /// Length of the path of the whole rise, which is twice the distance. `ramp`: path length of a ramp.
    path: i64,
    ramp: i64,
    /// Data for fractions of `path` and `ramp`.
    whole: Whole,
    rising: Whole,
    /// α and k/4.
    alpha: i64,
    k: i64,
}

impl Form {
    /// `ramp`: fraction of the time that a ramp takes.
    fn new(path: i64, ramp: f32) -> Self {
        let ramp = share(path, ramp).min(path / 2).max(1);
        let (whole, rising) = (Whole::new(path), Whole::new(ramp));
        let alpha = whole.part(ramp);
        // 2^126 / (2^64·(1 − α)) is k with 62 fraction bits.
        let k = reciprocal_near(((ONE - alpha) as u64) << 2) as i64 >> 2;
        Self { path, ramp, whole, rising, alpha, k }
    }

    /// Distance (LSB 2^-44 mm), speed and a fourth of the acceleration at `s`. Before its start, the motion
    /// stands still; after its end, it has its full speed.
    fn at(&self, s: i64) -> [i64; 3] {
        let &Self { path, ramp, ref whole, ref rising, alpha, k } = self;
        let left = path - s;
        if s <= 0 {
            return [0; 3];
        }
        if left <= 0 {
            return [path / 2 - left, ONE, 0];
        }
        let (first, last) = (s <= ramp, left <= ramp);
        let [gone, gained, a] = if first || last {
            // Computed from the nearer end.
            let q = rising.part(if first { s } else { left });
            let half = times(times(alpha, k), times(q, q));
            [times(times(alpha, q), times(half, THIRD)) << 2, half << 1, times(k, q)]
        } else {
            let tau = whole.part(s);
            let square = times(times(alpha, alpha), THIRD);
            [times(k, square + times(tau, tau - alpha)) << 2, times(k, tau - alpha / 2) << 2, k]
        };
        let way = scaled::<62>(path / 2, gone);
        if first || !last { [way, gained, a] } else { [path / 2 - left + way, ONE - gained, a] }
    }

    /// Lengths of the pieces up to the middle of the curve, their number, and the place of the middle. The
    /// jerk changes between pieces. `end`: approximate end of the second motion. Changes closer than `least`
    /// are merged into one.
    #[inline(never)]
    fn pieces(&self, end: i64, least: i64) -> ([f32; PIECES], u8, i64) {
        let Self { path, ramp, .. } = *self;
        // The second half is the mirror image of the first.
        let middle = end / 2;
        let [a, b] = [path - ramp, path].map(|s| s.min(end - s));
        let [first, b] = [ramp.min(b), ramp.max(b)];
        let [a, b] = [a.min(b), a.max(b)];
        let [first, second] = [first.min(a), first.max(a)];
        let (mut lengths, mut count, mut at) = ([0.0; PIECES], 0, 0);
        let mut next = lengths.iter_mut();
        for s in [first, second, b, middle] {
            if s - at < least || (s != middle && middle - s < least) {
                continue;
            }
            let Some(length) = next.next() else { break };
            // Lengths are rounded first; the places are sums of rounded lengths.
            *length = to_f32(s - at) * DISTANCE_LSB;
            at += to_bits::<44>(*length);
            count += 1;
        }
        (lengths, count, at)
    }

    /// The sign of the jerk at a place.
    fn jerk(&self, s: i64) -> f32 {
        let left = self.path - s;
        if s <= 0 || left <= 0 {
            0.0
        } else if s < self.ramp {
            1.0
        } else if left < self.ramp {
            -1.0
        } else {
            0.0
        }
    }
}

/// A part of a path, LSB 2^-44 mm.
fn share(path: i64, part: f32) -> i64 {
    to_bits::<44>(to_f32(path) * DISTANCE_LSB * part)
}

/// A curve that is emitted element by element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed<const AXES: usize> {
    origin: [Position; AXES],
    tangents: [[i64; AXES]; 2],
    /// Difference and sum of both directions, LSB 2^-40.
    turns: [[f32; AXES]; 2],
    form: Form,
    /// Path speed, mm/tick.
    v: f32,
    /// Start of the second motion, LSB 2^-44 mm.
    start: i64,
    /// Path lengths of the elements up to the middle, and their number. The second half has the same lengths
    /// in reverse order.
    lengths: [f32; PIECES],
    count: u8,
    done: u8,
    /// Start of the next element, LSB 2^-44 mm, and its knot.
    at: i64,
    from: Knot<AXES>,
    to: Knot<AXES>,
    /// Magnitudes of the third derivative in the last element.
    third: [f32; AXES],
}

impl<const AXES: usize> Timed<AXES> {
    /// The curve at the corner `origin` between two knots at the distance `reach` (LSB 2^-44 mm), which is
    /// the length of both motions. Inline, so that the curve is made in its final place.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn new(
        origin: &[Position; AXES],
        Overlap { rise, time }: Overlap,
        reach: i64,
        [from, to]: [&Knot<AXES>; 2],
    ) -> Self {
        let (path, whole) = (2 * reach, rise.time());
        let form = Form::new(path, rise.ramp / whole);
        let common = if time < whole { share(path, time / whole).min(path) } else { path };
        let (lengths, count, middle) = form.pieces(2 * path - common, to_bits::<44>(rise.v * LEAST));
        // The curve is as long as the sum of its pieces. The last piece may be short, so rounding of the
        // other pieces must not become a jump in the last one.
        let start = 2 * middle - path;
        let tangents = [from.end.tangent, to.end.tangent];
        Self {
            origin: *origin,
            tangents,
            turns: turns(&tangents),
            form,
            v: rise.v,
            start,
            lengths,
            count,
            done: 0,
            at: 0,
            from: *from,
            to: *to,
            third: [0.0; AXES],
        }
    }

    /// The curve at a place.
    fn knot(&self, s: i64) -> Knot<AXES> {
        let [p1, v1, a1] = self.form.at(self.form.path - s);
        let [p2, v2, a2] = self.form.at(s - self.start);
        let per = 2.0 * LSB_62 / (to_f32(self.form.path) * DISTANCE_LSB);
        let [sum, difference] = [a2 + a1, a2 - a1].map(|a| to_f32(a) * per);
        let mut position = self.origin;
        let mut end = End { tangent: [0; AXES], curvature: [0.0; AXES] };
        end.curvature = self.bent(sum, difference);
        let [before, behind] = &self.tangents;
        let axes = position.iter_mut().zip(&mut end.tangent);
        for (((x, tangent), t1), t2) in axes.zip(before).zip(behind) {
            if *t1 | *t2 == 0 {
                // The motion stands still.
                continue;
            }
            // LSB 2^-42 mm.
            let offset = scaled::<42>(*t2, p2) - scaled::<42>(*t1, p1);
            *x = Position::from_bits(x.to_bits().saturating_add((offset + 512) >> 10));
            *tangent = scaled::<62>(*t1, v1) + scaled::<62>(*t2, v2);
        }
        Knot { position, end }
    }

    /// Magnitudes of the third derivative at a place between changes of jerk.
    fn third_at(&self, s: i64) -> [f32; AXES] {
        let Form { path, ramp, .. } = self.form;
        let per = 0.5 / (to_f32(ramp) * DISTANCE_LSB * (to_f32(path - ramp) * DISTANCE_LSB));
        // The first motion runs backward: its jerk changes sign twice, by time and by direction.
        let [j1, j2] = [self.form.jerk(path - s), self.form.jerk(s - self.start)];
        let [sum, difference] = [j2 - j1, j2 + j1].map(|j| j * per);
        self.bent(sum, difference).map(magnitude)
    }

    /// t2·(sum + difference) − t1·(sum − difference) for both tangents, accurate even where terms nearly
    /// cancel out.
    #[cfg_attr(feature = "fast", inline(always))]
    fn bent(&self, sum: f32, difference: f32) -> [f32; AXES] {
        let [changes, both] = &self.turns;
        let mut bent = *changes;
        for (x, both) in bent.iter_mut().zip(both) {
            *x = (*x * sum + both * difference) * LSB_40;
        }
        bent
    }

    /// Whether the next element belongs to the block before the corner.
    pub fn is_before(&self) -> bool {
        self.done < self.count
    }

    /// Whether all elements are emitted.
    pub fn is_done(&self) -> bool {
        self.done >= 2 * self.count
    }

    /// End of the last emitted element, mm or degrees.
    pub fn stands(&self) -> &[Position; AXES] {
        &self.from.position
    }

    /// Ends the curve early: no further element is emitted. Returns the end of the curve.
    pub fn finish(&mut self) -> &[Position; AXES] {
        self.done = 2 * self.count;
        self.from = self.to;
        &self.to.position
    }
}

impl<const AXES: usize> Timed<AXES> {
    /// Begins the next element; the returned draft computes the polynomials of its axes. Then call
    /// [`Self::settle`].
    pub fn next_element(&mut self, element: &mut Element<AXES>) -> Option<Draft<AXES>> {
        let all = 2 * self.count;
        let left = all.checked_sub(self.done + 1)?;
        let length = *self.lengths.get(usize::from(self.done.min(left)))?;
        let path = to_bits::<44>(length);
        self.done += 1;
        self.third = self.third_at(self.at + path / 2);
        self.at += path;
        let to = if left == 0 { self.to } else { self.knot(self.at) };
        let made = Draft::begin(element, [&self.from, &to], length, 1.0 + 1e-6)?.cubic();
        self.from = to;
        Some(made)
    }

    /// Sets the derivatives of an element. The acceleration changes linearly, so these values are more
    /// accurate than values from the points of a short piece.
    pub fn settle(&self, element: &mut Element<AXES>) {
        if let Some(bounds) = &mut element.bounds {
            bounds.passage = Passage::Timed(self.v);
            bounds.second = larger(&element.entry.curvature, &element.exit.curvature);
            bounds.third = self.third;
        }
    }
}

/// Difference and sum of two directions.
fn turns<const AXES: usize>([before, behind]: &[[i64; AXES]; 2]) -> [[f32; AXES]; 2] {
    let mut turns = [[0.0; AXES]; 2];
    let [changes, both] = &mut turns;
    for (((change, both), t1), t2) in changes.iter_mut().zip(both).zip(before).zip(behind) {
        (*change, *both) = (to_f32(t2 - t1), to_f32(t2 + t1));
    }
    turns
}

/// The larger magnitude for each axis.
pub fn larger<const AXES: usize>(a: &[f32; AXES], b: &[f32; AXES]) -> [f32; AXES] {
    let mut most = *a;
    for (most, b) in most.iter_mut().zip(b) {
        *most = max(magnitude(*most), magnitude(*b));
    }
    most
}
