//! A corner between two lines as a course of time: the motion along the first line slows down to a
//! standstill, the one along the second speeds up, and the second begins before the first has ended. Both
//! change their speed as a slope does, by a trapezoid of acceleration with ramps of constant jerk.
//!
//! ```text
//! Q(t) = C − t1·p(T − t) + t2·p(t − S)      p: path from rest to the speed v in the time T,  S = T − overlap
//! ```
//!
//! **Why this shape.** With a small tolerance only the last ramp of the one motion and the first of the other
//! overlap, and the curve is the cubic with the corner as its double inner control point, Q = C − c·t1·(1 −
//! u)³ + c·t2·u³, which is the fastest of the shapes that keep the jerk of every axis. A curve over its arc
//! length cannot be passed like that: there jerk needs 3·κ·v·a, so that with limits of its own for speed,
//! acceleration and jerk either speed is low or acceleration is none. So time is taken as path: the elements
//! run over σ = v·t, each axis is a polynomial of the third degree between two changes of jerk, and at the
//! constant path speed v every axis moves exactly as planned, with the braking on the line before and the
//! speeding up on the line behind the corner. At a lower path speed r·v all accelerations are r², all jerks
//! r³ of that. With the whole of both motions overlapping the path speed is that of the feed, and each axis
//! changes its speed by one even acceleration: the curve of DIST_SOFT.
//!
//! DIST_MASTER is that with the master axis as path ([`mod@crate::path::measure`]): its tangent is 1 on both
//! lines, so it is 1 all along the curve, and the master goes on at its speed.
//!
//! The speed along the curve is below the path speed, at the corner far below. So this is no curve for
//! CONST_VEL.
//!
//! **Deviation.** At the time when both motions are equally far from the corner, p(overlap/2) = e, the curve
//! is e·|t2 − t1| from it. The distance of a point from the line it is about to reach, or has left, is at
//! most e·sin θ, which is less.
use super::LSB_40;
use crate::math::float::{magnitude, max, min, to_f32};
use crate::math::root::{cbrt_f32, sqrt_f32};
use crate::math::wide::mul_shift;
use crate::path::poly::{Draft, Knot};
use crate::path::{Element, End, Passage};
use crate::quantity::Position;

/// A change of speed between standstill and `v` along a line: mm and ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rise {
    j: f64,
    /// Times of a ramp, and of the acceleration between both.
    ramp: f64,
    hold: f64,
    /// The speed.
    pub v: f64,
}

impl Rise {
    /// To the speed `v` with at most the acceleration `a` and the jerk `j`.
    pub fn new(v: f32, a: f32, j: f32) -> Self {
        let full = a / j;
        let ramp = f64::from(min(full, sqrt_f32(v / j)));
        let j = f64::from(j);
        let hold = if v > a * full { f64::from(v) / (j * ramp) - ramp } else { 0.0 };
        Self { j, ramp, hold, v: j * ramp * (ramp + hold) }
    }

    /// The fastest one that goes no further than `distance`, up to the speed `v`.
    pub fn within(distance: f32, v: f32, a: f32, j: f32) -> Self {
        let full = a * a / j;
        let mut fastest = cbrt_f32(distance * distance * j);
        if fastest > full {
            fastest = 2.0 * a * distance / (0.5 * full + sqrt_f32(0.25 * full * full + 2.0 * a * distance));
        }
        // A little less: what rounding adds must not reach beyond the middle of a block.
        Self::new(min(v, fastest * (1.0 - 1.0 / 1_048_576.0)), a, j)
    }

    /// A rise to the speed of this one in so many times its time.
    pub fn stretched(self, by: f64) -> Self {
        Self { j: self.j / (by * by), ramp: self.ramp * by, hold: self.hold * by, v: self.v }
    }

    /// Its time.
    fn time(&self) -> f64 {
        2.0 * self.ramp + self.hold
    }

    /// Its length.
    pub fn distance(&self) -> f64 {
        0.5 * self.v * self.time()
    }

    /// Path, speed and acceleration at a time; before it at rest, behind it at its speed.
    fn at(&self, t: f64) -> [f64; 3] {
        let Self { j, ramp, v, .. } = *self;
        let left = self.time() - t;
        if t <= 0.0 {
            [0.0; 3]
        } else if t <= ramp {
            [j * t * t * t * (1.0 / 6.0), 0.5 * j * t * t, j * t]
        } else if left >= ramp {
            let u = t - ramp;
            let a = j * ramp;
            [a * (ramp * ramp * (1.0 / 6.0) + u * 0.5 * (ramp + u)), a * (0.5 * ramp + u), a]
        } else if left > 0.0 {
            [
                self.distance() - left * (v - j * left * left * (1.0 / 6.0)),
                v - 0.5 * j * left * left,
                j * left,
            ]
        } else {
            [self.distance() - left * v, v, 0.0]
        }
    }

    /// Jerk at a time.
    fn jerk(&self, t: f64) -> f64 {
        let left = self.time() - t;
        if t <= 0.0 || left <= 0.0 {
            0.0
        } else if t < self.ramp {
            self.j
        } else if left < self.ramp {
            -self.j
        } else {
            0.0
        }
    }

    /// The time at which it has gone as far as `path`, which is no further than at half its time.
    fn reaches(&self, path: f64) -> f64 {
        let ramp = self.ramp;
        let first = self.j * ramp * ramp * ramp * (1.0 / 6.0);
        let t = if path <= first {
            f64::from(cbrt_f32((6.0 * path / self.j) as f32))
        } else {
            // a·(r·u + u²)/2 beyond it
            let beyond = 2.0 * (path - first) / (self.j * ramp);
            let root = f64::from(sqrt_f32((0.25 * ramp * ramp + beyond) as f32));
            ramp + beyond / (0.5 * ramp + root)
        };
        if t < 0.5 * self.time() { t } else { 0.5 * self.time() }
    }

    /// The time at which it has gone as far as `path`, or a little less.
    fn arrives(&self, path: f64) -> f64 {
        let whole = self.time();
        if path >= self.distance() {
            return whole;
        }
        let mut time = self.reaches(path);
        if path > self.half_way() {
            // Newton's steps from the end: speed grows, so none goes too far.
            time = whole;
            for _ in 0..ARRIVAL_STEPS {
                let [p, v, _] = self.at(time);
                time -= (p - path) / v;
            }
        }
        time * (1.0 - 1.0 / 1_048_576.0)
    }

    /// How far it is at half its time.
    pub fn half_way(&self) -> f64 {
        self.at(0.5 * self.time())[0]
    }
}

/// Two motions that overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Both, the first one backward.
    pub rise: Rise,
    /// Time that they have in common.
    pub time: f64,
}

impl Overlap {
    /// All of both.
    pub fn whole(rise: Rise) -> Self {
        Self { rise, time: rise.time() }
    }

    /// As long as each is `off` from the corner when both are equally far from it.
    pub fn off(rise: Rise, off: f64) -> Self {
        Self { rise, time: 2.0 * rise.reaches(off) }
    }

    /// As long as the first is `distance` from the corner when the second begins.
    pub fn from_distance(rise: Rise, distance: f64) -> Self {
        Self { rise, time: rise.arrives(distance) }
    }

    /// An overlap that takes so many times the time of this one, and begins so many times as far from the
    /// corner.
    pub fn stretched(self, by: f64) -> Self {
        Self { rise: self.rise.stretched(by), time: self.time * by }
    }

    /// An overlap of the ramps alone.
    pub fn brief(self) -> Self {
        Self { time: f64::min(self.time, self.rise.ramp), ..self }
    }

    /// Only ramps overlap.
    pub fn is_brief(&self) -> bool {
        self.time <= self.rise.ramp
    }

    /// Whether it is a curve for set points at ticks, and one that the format of a polynomial holds.
    pub fn is_long(&self) -> bool {
        self.time >= SHORTEST && self.rise.distance() <= LONGEST
    }

    /// From the begin of the first motion to the end of the second.
    pub fn duration(&self) -> f64 {
        2.0 * self.rise.time() - self.time
    }
}

/// Shortest time in common, ticks, and longest way of a motion, mm.
const SHORTEST: f64 = 4.0;
const LONGEST: f64 = 2048.0;

/// Newton's steps: from half the time off to 10^-7 of it.
const ARRIVAL_STEPS: usize = 4;

/// Shortest piece, ticks. What rounding makes of its third derivative does not show: third differences over
/// ticks are means of it.
const LEAST: f64 = 1.0 / 4096.0;

/// Changes of jerk, and the middle.
const PIECES: usize = 8;

/// A course that is handed out element by element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed<const AXES: usize> {
    origin: [Position; AXES],
    tangents: [[i64; AXES]; 2],
    overlap: Overlap,
    /// 1 / v
    per: f64,
    /// Path lengths of the elements, and how many there are.
    lengths: [f32; PIECES],
    count: u8,
    /// How many belong to the block before.
    before: u8,
    done: u8,
    /// Time where the next one begins, and its knot.
    at: f64,
    from: Knot<AXES>,
    to: Knot<AXES>,
    /// Magnitudes of the third derivative in the element before that.
    third: [f32; AXES],
}

const ONE_44: f64 = (1u64 << 44) as f64;
const ONE_60: f64 = (1u64 << 60) as f64;

impl<const AXES: usize> Timed<AXES> {
    /// The curve about the corner `origin` from one knot to the other, which are as far from it as the
    /// motions go.
    pub fn new(origin: &[Position; AXES], overlap: Overlap, from: &Knot<AXES>, to: &Knot<AXES>) -> Self {
        let Rise { ramp, v, .. } = overlap.rise;
        let whole = overlap.rise.time();
        let start = whole - overlap.time;
        let end = start + whole;
        let middle = 0.5 * end;
        let mut times = [ramp, whole - ramp, whole, middle, start, start + ramp, end - ramp, end];
        times.sort_unstable_by(f64::total_cmp);
        let mut timed = Self {
            origin: *origin,
            tangents: [from.end.tangent, to.end.tangent],
            overlap,
            per: 1.0 / v,
            lengths: [0.0; PIECES],
            count: 0,
            before: 0,
            done: 0,
            at: 0.0,
            from: *from,
            to: *to,
            third: [0.0; AXES],
        };
        // Changes closer than that become one; lengths are rounded first, and times follow.
        let mut at = 0.0;
        let mut lengths = timed.lengths.iter_mut();
        for t in times {
            let close = t - at < LEAST || (end - t < LEAST && t != end) || (t != middle && near(t, middle));
            if close {
                continue;
            }
            let Some(length) = lengths.next() else { break };
            *length = (v * (t - at)) as f32;
            at += f64::from(*length) * timed.per;
            timed.count += 1;
            if t == middle {
                timed.before = timed.count;
            }
        }
        timed
    }

    /// The curve at a time. What holds for all axes is known in `f64`, each axis is in integers.
    fn knot(&self, t: f64) -> Knot<AXES> {
        let Overlap { rise, time } = self.overlap;
        let whole = rise.time();
        let [p1, v1, a1] = rise.at(whole - t);
        let [p2, v2, a2] = rise.at(t - (whole - time));
        // LSB 2^-44 mm, 2^-60 of the speed, and 1/mm.
        let [p1, p2] = [p1, p2].map(|p| (p * ONE_44) as i64);
        let [v1, v2] = [v1, v2].map(|v| nearest(v * self.per * ONE_60));
        let square = self.per * self.per;
        let [sum, difference] = [a2 + a1, a2 - a1].map(|a| (a * square * 0.5) as f32);
        let mut position = self.origin;
        let mut end = End { tangent: [0; AXES], curvature: [0.0; AXES] };
        let [before, behind] = &self.tangents;
        let ends = end.tangent.iter_mut().zip(&mut end.curvature);
        for (((x, (tangent, curvature)), t1), t2) in position.iter_mut().zip(ends).zip(before).zip(behind) {
            // LSB 2^-42 mm
            let offset = mul_shift(*t2, p2, 42) - mul_shift(*t1, p1, 42);
            *x = Position::from_bits(x.to_bits().saturating_add((offset + 512) >> 10));
            *tangent = mul_shift(*t1, v1, 60) + mul_shift(*t2, v2, 60);
            *curvature = both(*t1, *t2, sum, difference);
        }
        Knot { position, end }
    }

    /// Magnitudes of the third derivative at a time between changes of jerk.
    fn third_at(&self, t: f64) -> [f32; AXES] {
        let Overlap { rise, time } = self.overlap;
        let per = 0.5 * self.per * self.per * self.per;
        // The motion that runs backward has its jerk turned twice: with time and with its direction.
        let [j1, j2] = [rise.jerk(rise.time() - t), rise.jerk(t - (rise.time() - time))];
        let [sum, difference] = [j2 - j1, j2 + j1].map(|j| (j * per) as f32);
        let mut third = [0.0; AXES];
        let [before, behind] = &self.tangents;
        for ((x, t1), t2) in third.iter_mut().zip(before).zip(behind) {
            *x = magnitude(both(*t1, *t2, sum, difference));
        }
        third
    }

    /// Whether the next element belongs to the block before the corner.
    pub fn is_before(&self) -> bool {
        self.done < self.before
    }

    /// Where the last element ended.
    pub fn stands(&self) -> &[Position; AXES] {
        &self.from.position
    }

    /// No further element is handed out; where the curve ends.
    pub fn finish(&mut self) -> &[Position; AXES] {
        self.done = self.count;
        self.from = self.to;
        &self.to.position
    }
}

impl<const AXES: usize> Timed<AXES> {
    /// The next element, with its axes to be made; then: [`Self::settle`].
    pub fn next_element(&mut self, element: &mut Element<AXES>) -> Option<Draft<AXES>> {
        if self.done >= self.count {
            return None;
        }
        let length = *self.lengths.get(usize::from(self.done))?;
        self.done += 1;
        let ticks = f64::from(length) * self.per;
        self.third = self.third_at(self.at + 0.5 * ticks);
        self.at += ticks;
        let to = if self.done == self.count { self.to } else { self.knot(self.at) };
        let made = Draft::begin(element, [&self.from, &to], length, 1.0 + 1e-6)?;
        self.from = to;
        Some(made)
    }

    /// Acceleration changes evenly: of a short piece that is known better than from its points.
    pub fn settle(&self, element: &mut Element<AXES>) {
        if let Some(bounds) = &mut element.bounds {
            bounds.passage = Passage::Timed(self.overlap.rise.v as f32);
            bounds.second = larger(&element.entry.curvature, &element.exit.curvature);
            bounds.third = self.third;
        }
    }
}

fn near(a: f64, b: f64) -> bool {
    a - b < LEAST && b - a < LEAST
}

/// t2·(sum + difference) − t1·(sum − difference), t in 2^-40: of what nearly cancels out nothing is lost.
fn both(t1: i64, t2: i64, sum: f32, difference: f32) -> f32 {
    (to_f32(t2 - t1) * sum + to_f32(t2 + t1) * difference) * LSB_40
}

/// The nearest integer.
fn nearest(x: f64) -> i64 {
    (if x < 0.0 { x - 0.5 } else { x + 0.5 }) as i64
}

/// Largest magnitude of both.
pub fn larger<const AXES: usize>(a: &[f32; AXES], b: &[f32; AXES]) -> [f32; AXES] {
    let mut most = *a;
    for (most, b) in most.iter_mut().zip(b) {
        *most = max(max(*most, -*most), max(*b, -*b));
    }
    most
}
