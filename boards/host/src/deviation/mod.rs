//! The deviation between driven path and programmed path, in both directions, for every smoothing method.
//!
//! Takes the blocks of the decoder and points of every curve of the planner. Returns the largest deviation of
//! the main axes, that of every other axis, and the places. The axes move along these curves, so the result
//! does not depend on speed, override and cycle.
//!
//! Points at each 16th of a curve show the place of the largest deviation. The curve itself gives its value
//! (`peak`), because between two points the deviation may have a cusp where the nearest block changes.
mod peak;
mod tell;

use crate::machine::Machine;
use crate::program::{Kind, Program, sweep};
use crate::tolerance::Tolerance;
use std::collections::VecDeque;
pub use tell::Told;

/// Chords of a curve.
pub const CHORDS: u32 = 16;
/// Number of stored places, with the curves around each place.
const PLACES: usize = 3;
const AROUND: usize = 12;
/// Number of stored curves: more than the delay until a place is recognised.
const RECENT: usize = 96;
/// Number of blocks around the block of a curve that are searched.
const NEAR: usize = 2;
const FAR: usize = 64;
/// Highest number of blocks between a curve and one that is taken back.
const BACK: usize = 1024;
/// Highest number of parts of a path that are shown.
const COLUMNS: usize = 4096;

/// Number of places of a helix in the first search for the nearest one.
const PLACES_OF_A_HELIX: u32 = 32;

/// Smaller deviations are rounding, mm or degrees.
pub const NOTHING: f64 = 1e-6;

/// A point of the main axes.
pub type Point = [f64; 3];

/// A programmed motion.
struct Block {
    /// Start and end of all axes.
    from: Vec<f64>,
    to: Vec<f64>,
    /// Shape in the main axes.
    ends: [Point; 2],
    arc: Option<Turn>,
    /// Length along the main axes, mm.
    length: f64,
    smoothed: bool,
    tolerance: Tolerance,
    n: u32,
}

/// An arc in two of the main axes.
struct Turn {
    plane: [usize; 2],
    centre: [f64; 2],
    first: f64,
    swept: f64,
    radii: [f64; 2],
}

/// A place on a block.
#[derive(Clone, Copy)]
struct Foot {
    block: usize,
    /// Position on the block, 0…1.
    part: f64,
    distance: f64,
}

/// Deviation of a point of the driven path from the programmed path.
struct Measured {
    /// The point.
    q: Point,
    /// The nearest place of the programmed path.
    seen: Foot,
    /// Whether the path is smoothed there, and the tolerances.
    smoothed: bool,
    tolerance: Tolerance,
    /// Deviation of every axis that is no main axis.
    track: Vec<Option<f64>>,
}

/// The largest deviation of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest {
    pub value: f64,
    pub tolerance: Option<f64>,
    /// N number of the block.
    pub n: u32,
}

impl Largest {
    /// Deviation as part of its tolerance; infinite without a tolerance.
    fn used(&self) -> f64 {
        self.tolerance.map_or(self.value * 1e-9, |tolerance| self.value / tolerance)
    }
}

/// A place where the deviation is large.
#[derive(Clone, Debug)]
pub struct Place {
    pub largest: Largest,
    /// Index of the motion block.
    pub block: usize,
    /// The point on the programmed path, and the point on the driven path.
    pub programmed: Point,
    pub moved: Point,
    /// The driven path around the place.
    pub around: Vec<Point>,
    /// Number of following curves that are still missing.
    missing: usize,
}

impl Place {
    /// With the driven path `around` it, as far as it is known.
    pub fn new(largest: Largest, block: usize, programmed: Point, moved: Point, around: Vec<Point>) -> Self {
        Self { largest, block, programmed, moved, around, missing: usize::MAX }
    }
}

/// Deviations in a part of the path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Column {
    /// Path distance at its end, mm.
    pub distance: f64,
    /// Deviations of the main axes, and of the others.
    pub path: f64,
    pub track: f64,
    /// Deviations as parts of their tolerances; 0 without a tolerance.
    pub path_used: f64,
    pub track_used: f64,
}

impl Column {
    /// The larger value of each, up to the end of both.
    fn or(self, other: Self) -> Self {
        Self {
            distance: self.distance.max(other.distance),
            path: self.path.max(other.path),
            track: self.track.max(other.track),
            path_used: self.path_used.max(other.path_used),
            track_used: self.track_used.max(other.track_used),
        }
    }
}

/// The comparison.
pub struct Deviation {
    main: Vec<usize>,
    /// Axes in an independent motion, which is not compared.
    beside: Vec<usize>,
    blocks: Vec<Block>,
    /// Blocks up to this length may be left out.
    relevant: f64,
    /// For the end of each block: its distance from the driven path, the nearest point, and the path distance
    /// there.
    ends: Vec<(f64, Point, f64)>,
    /// Ends before this one are done.
    done: usize,
    /// The block of the last curve, or the block of its end if the curve covers several blocks.
    before: usize,
    /// End of the last curve.
    last: Option<Point>,
    /// Number of curves so far.
    pub curves: u64,
    /// Largest deviations of the main axes and of each other axis.
    pub path: Option<Largest>,
    pub track: Vec<Option<Largest>>,
    pub places: Vec<Place>,
    /// Deviations along the path, in parts of about equal length.
    pub columns: Vec<Column>,
    step: f64,
    recent: VecDeque<Vec<Point>>,
    distance: f64,
    /// Whether a part of the path is smoothed.
    pub smooths: bool,
}

fn apart(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// The point of the main axes; an axis in an independent motion counts as zero.
fn point_of(all: &[f64], main: &[usize], beside: &[usize]) -> Point {
    let of = |axis: &usize| all.get(*axis).filter(|_| !beside.contains(axis)).copied();
    std::array::from_fn(|k| main.get(k).and_then(of).unwrap_or(0.0))
}

fn between(a: &Point, b: &Point, part: f64) -> Point {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * part)
}

/// The nearest point of a straight line, 0…1.
fn along(q: &Point, a: &Point, b: &Point) -> f64 {
    let square = apart(a, b).powi(2);
    let product = (0..3).map(|k| (q[k] - a[k]) * (b[k] - a[k])).sum::<f64>();
    if square > 0.0 { (product / square).clamp(0.0, 1.0) } else { 0.0 }
}

impl Block {
    /// The point of the main axes at a position on the block.
    fn at(&self, part: f64) -> Point {
        let mut point = between(&self.ends[0], &self.ends[1], part);
        if let Some(Turn { plane, centre, first, swept, radii }) = &self.arc {
            let radius = radii[0] + (radii[1] - radii[0]) * part;
            let (sin, cos) = (first + swept * part).sin_cos();
            point[plane[0]] = centre[0] + radius * cos;
            point[plane[1]] = centre[1] + radius * sin;
        }
        point
    }

    /// Whether the block moves an axis to another position.
    fn moves(&self, axis: usize) -> bool {
        self.from[axis] != self.to[axis]
    }

    /// Distance of another axis from its programmed values around a nearest point. The range extends to both
    /// sides by the path's deviation. A full circle continues after its end; in a block without length all
    /// values count.
    fn off(&self, axis: usize, value: f64, foot: &Foot) -> f64 {
        let play = (foot.distance + NOTHING) / self.length.max(NOTHING);
        let at = |part: f64| self.from[axis] + (self.to[axis] - self.from[axis]) * part.clamp(0.0, 1.0);
        let beyond = |low: f64, high: f64| {
            let ends = [at(low), at(high)];
            (ends[0].min(ends[1]) - value).max(value - ends[0].max(ends[1])).max(0.0)
        };
        let (low, high) = (foot.part - play, foot.part + play);
        let mut off = beyond(low, high);
        if apart(&self.ends[0], &self.ends[1]) <= NOTHING {
            if low < 0.0 {
                off = off.min(beyond(1.0 + low, 1.0));
            }
            if high > 1.0 {
                off = off.min(beyond(0.0, high - 1.0));
            }
        }
        off
    }

    /// The nearest point of an arc, around a position on the arc.
    fn nearest(&self, part: f64, q: &Point) -> f64 {
        let off = |part: f64| apart(q, &self.at(part));
        let (mut part, mut step) = (part, 1.0 / 16.0);
        while step > 1e-6 {
            let sides = [(part - step).max(0.0), (part + step).min(1.0)];
            match sides.into_iter().find(|&side| off(side) < off(part)) {
                Some(side) => part = side,
                None => step /= 2.0,
            }
        }
        part
    }

    /// The nearest point of the block, and its distance.
    fn foot(&self, block: usize, q: &Point) -> Foot {
        let part = match &self.arc {
            None => along(q, &self.ends[0], &self.ends[1]),
            // First all along a helix, then around the nearest place.
            Some(Turn { plane, .. })
                if (0..3).any(|k| !plane.contains(&k) && self.ends[0][k] != self.ends[1][k]) =>
            {
                let off = |i: &u32| apart(q, &self.at(f64::from(*i) / f64::from(PLACES_OF_A_HELIX)));
                let best = (0..=PLACES_OF_A_HELIX).min_by(|one, other| off(one).total_cmp(&off(other)));
                self.nearest(f64::from(best.unwrap_or(0)) / f64::from(PLACES_OF_A_HELIX), q)
            }
            // By the angle, exact in the plane.
            Some(Turn { plane, centre, first, swept, .. }) => {
                let angle = (q[plane[1]] - centre[1]).atan2(q[plane[0]] - centre[0]) - first;
                let turn = std::f64::consts::TAU;
                let ahead = (angle * swept.signum()).rem_euclid(turn);
                let size = swept.abs();
                let part = ahead / size;
                // The end or the start, whichever is nearer.
                if part <= 1.0 {
                    self.nearest(part, q)
                } else if ahead - size < turn - ahead {
                    1.0
                } else {
                    0.0
                }
            }
        };
        let ends = [0.0, part, 1.0].map(|part| (apart(q, &self.at(part)), part));
        let (distance, part) =
            ends.into_iter().fold(ends[1], |best, other| if other.0 < best.0 { other } else { best });
        Foot { block, part, distance }
    }
}

impl Deviation {
    /// A comparison for a program on a machine.
    pub fn new(machine: &Machine, program: &Program) -> Self {
        let (main, beside) = (machine.main_axes(), program.axes_beside());
        let point = |all: &[f64]| point_of(all, &main, &beside);
        let mut blocks = Vec::with_capacity(program.motions);
        for (from, segment) in program.steps() {
            let ends = [point(from), point(&segment.end)];
            let index = |axis: usize| main.iter().position(|&other| other == axis).unwrap_or(0);
            let arc = match segment.kind {
                Kind::Arc { plane, centre, clockwise } => {
                    let [start, end] = [from, segment.end.as_slice()].map(|all| plane.map(|axis| all[axis]));
                    let radius = |at: [f64; 2]| (at[0] - centre[0]).hypot(at[1] - centre[1]);
                    Some(Turn {
                        plane: plane.map(index),
                        centre,
                        first: (start[1] - centre[1]).atan2(start[0] - centre[0]),
                        swept: sweep(start, end, centre, clockwise),
                        radii: [radius(start), radius(end)],
                    })
                }
                _ => None,
            };
            let turn = arc.as_ref().map_or(0.0, |turn: &Turn| (turn.swept * turn.radii[1]).abs());
            blocks.push(Block {
                length: apart(&ends[0], &ends[1]).max(turn),
                from: from.to_vec(),
                to: segment.end.clone(),
                ends,
                arc,
                smoothed: segment.smoothed,
                tolerance: segment.tolerance,
                n: segment.n,
            });
        }
        Self {
            ends: vec![(f64::INFINITY, [0.0; 3], 0.0); blocks.len()],
            done: 0,
            before: 0,
            last: None,
            curves: 0,
            path: None,
            track: vec![None; machine.axes.len()],
            places: Vec::new(),
            columns: Vec::new(),
            step: 0.0,
            recent: VecDeque::new(),
            distance: 0.0,
            smooths: blocks.iter().any(|block| block.smoothed),
            blocks,
            relevant: program.relevant,
            main,
            beside,
        }
    }

    /// Ends of the blocks around one.
    pub fn ends(&self, block: usize) -> Vec<Point> {
        let (from, to) = (block.saturating_sub(AROUND), (block + AROUND).min(self.blocks.len()));
        self.blocks.get(from..to).unwrap_or(&[]).iter().map(|block| block.ends[1]).collect()
    }

    /// The programmed end points around a block, within the shown range, and the index of the first one.
    pub fn programmed(&self, block: usize) -> Vec<Point> {
        let from = block.saturating_sub(AROUND);
        let to = (block + AROUND).min(self.blocks.len());
        let chords = |block: &Block| if block.arc.is_some() { 64 } else { 1 };
        let mut points = Vec::new();
        for block in self.blocks.get(from..to).unwrap_or(&[]) {
            let count = chords(block);
            points.extend((0..count).map(|i| block.at(f64::from(i) / f64::from(count))));
        }
        points.extend(to.checked_sub(1).and_then(|last| self.blocks.get(last)).map(|block| block.ends[1]));
        points
    }

    /// Records a curve: its motion block, [`CHORDS`] + 1 points of all axes, and `exact`, which returns the
    /// point at each 2^16th of its length.
    pub fn curve(&mut self, block: u32, points: &[Vec<f64>], exact: &dyn Fn(u32) -> Option<Vec<f64>>) {
        self.curves += 1;
        if !self.smooths || self.blocks.is_empty() {
            return;
        }
        let block = (block as usize).min(self.blocks.len() - 1);
        let path: Vec<Point> = points.iter().map(|all| point_of(all, &self.main, &self.beside)).collect();
        if let (Some(last), Some(first)) = (&self.last, path.first())
            && apart(last, first) > NOTHING
        {
            self.before = self.back(block, first);
        }
        self.last = path.last().copied();
        let mut column = Column::default();
        let measured: Vec<Measured> = points.iter().map(|all| self.measure(block, all)).collect();
        for one in &measured {
            self.take(one, &mut column);
        }
        for one in self.peaks(block, &measured, exact) {
            self.take(&one, &mut column);
        }
        self.pass(block, &path, exact);
        self.distance += path.windows(2).map(|pair| apart(&pair[0], &pair[1])).sum::<f64>();
        column.distance = self.distance;
        self.show(column);
        self.keep(path);
        let at = measured.last().map_or(block, |last| last.seen.block);
        self.before = at.min(block);
    }

    /// Curves were taken back, for example by an abort. `block`: the current block of the path, one of the
    /// last blocks.
    fn back(&self, block: usize, q: &Point) -> usize {
        let to = block.max(self.before);
        let near = (to.saturating_sub(BACK)..=to).map(|block| self.blocks[block].foot(block, q));
        near.min_by(|one, other| one.distance.total_cmp(&other.distance)).map_or(block, |foot| foot.block)
    }

    /// Deviation of a point of the driven path, with all axes, from the programmed path.
    fn measure(&self, block: usize, all: &[f64]) -> Measured {
        let q = point_of(all, &self.main, &self.beside);
        let (from, to) =
            (self.before.min(block).saturating_sub(NEAR), (block + NEAR).min(self.blocks.len() - 1));
        let foot = |block: usize| self.blocks[block].foot(block, &q);
        let nearer = |best: Foot, other: Foot| if other.distance < best.distance { other } else { best };
        let mut seen = (from..=to).map(foot).fold(foot(block), nearer);
        for further in to + 1..self.blocks.len().min(to + FAR) {
            if seen.block + NEAR < further {
                break;
            }
            seen = nearer(seen, foot(further));
        }
        let (smoothed, tolerance) = self.around(block);
        let mut track = Vec::new();
        if smoothed {
            // Each of these blocks may be the nearest one.
            let last = to.max(seen.block + NEAR).min(self.blocks.len() - 1);
            let near = (from..=last).map(foot);
            let near: Vec<Foot> = near.filter(|foot| foot.distance <= seen.distance + NOTHING).collect();
            track = self.follow(&near, all, tolerance);
        }
        Measured { q, seen, smoothed, tolerance, track }
    }

    /// Deviation of each other axis from its programmed value, at one of the nearest points; none if not
    /// compared.
    fn follow(&self, near: &[Foot], all: &[f64], tolerance: Tolerance) -> Vec<Option<f64>> {
        let of = |(axis, value): (usize, &f64)| {
            let apart = self.main.contains(&axis) || self.beside.contains(&axis);
            let moves = |foot: &Foot| self.blocks[foot.block].moves(axis);
            if apart || tolerance.track.is_none() && !near.iter().any(moves) {
                return None;
            }
            near.iter().map(|foot| self.blocks[foot.block].off(axis, *value, foot)).reduce(f64::min)
        };
        all.iter().enumerate().map(of).collect()
    }

    /// Includes the deviations of a point in the results.
    fn take(&mut self, measured: &Measured, column: &mut Column) {
        let Measured { q, seen, smoothed, tolerance, track } = measured;
        if !smoothed {
            return;
        }
        column.path = column.path.max(seen.distance);
        column.path_used = column.path_used.max(tolerance.path.map_or(0.0, |most| seen.distance / most));
        let (n, foot) = (self.blocks[seen.block].n, self.blocks[seen.block].at(seen.part));
        self.see(Largest { value: seen.distance, tolerance: tolerance.path, n }, seen.block, foot, *q);
        for (known, value) in self.track.iter_mut().zip(track) {
            let Some(value) = *value else { continue };
            column.track = column.track.max(value);
            column.track_used = column.track_used.max(tolerance.track.map_or(0.0, |most| value / most));
            let largest = Largest { value, tolerance: tolerance.track, n };
            if known.is_none_or(|known| largest.used() > known.used()) {
                *known = Some(largest);
            }
        }
    }

    /// Whether the path is smoothed at a place, and the tolerance: the larger one of the corners at both
    /// ends, or none if one corner is not monitored. A corner with left-out blocks belongs to the block
    /// before them.
    fn around(&self, block: usize) -> (bool, Tolerance) {
        let last = (block + 1).min(self.blocks.len() - 1);
        let mut first = block.saturating_sub(1);
        while first > 0 && block - first < FAR && self.blocks[first].length <= self.relevant {
            first -= 1;
        }
        let near = self.blocks.get(first..=last).unwrap_or(&[]);
        let near: Vec<&Block> = near.iter().filter(|block| block.smoothed).collect();
        let most = |of: fn(&Block) -> Option<f64>| {
            near.iter().map(|block| of(block)).reduce(|one, other| Some(one?.max(other?))).flatten()
        };
        let tolerance = Tolerance {
            path: most(|block| block.tolerance.path),
            track: most(|block| block.tolerance.track),
        };
        (!near.is_empty(), tolerance)
    }

    /// The ends of blocks that the curve passes: the smallest distance to each.
    fn pass(&mut self, block: usize, path: &[Point], exact: &dyn Fn(u32) -> Option<Vec<f64>>) {
        let from = self.before.min(block).saturating_sub(NEAR).max(self.done);
        let to = (block + NEAR).min(self.blocks.len() - 1);
        for index in from..=to {
            let end = self.blocks[index].ends[1];
            let chord = |(k, pair): (usize, &[Point])| {
                let distance = apart(&end, &between(&pair[0], &pair[1], along(&end, &pair[0], &pair[1])));
                (distance, k, apart(&pair[0], &pair[1]))
            };
            let chords = path.windows(2).enumerate().map(chord);
            let Some((distance, k, length)) = chords.min_by(|one, other| one.0.total_cmp(&other.0)) else {
                continue;
            };
            // The distance between the curve and its chord is at most the length of the chord.
            if distance - length >= self.ends[index].0 {
                continue;
            }
            let point = |part: u32| exact(part).map(|all| point_of(&all, &self.main, &self.beside));
            let near = |part: u32| -> Option<f64> { Some(-apart(&end, &point(part)?)) };
            if let Some((part, distance)) = peak::around(k, k + 1, near)
                && -distance < self.ends[index].0
                && let Some(moved) = point(part)
            {
                self.ends[index] = (-distance, moved, self.distance);
            }
        }
        self.settle(from.saturating_sub(NEAR));
    }

    /// Finishes all ends before this one.
    fn settle(&mut self, to: usize) {
        for index in self.done..to {
            let ((value, moved, along), block) = (self.ends[index], &self.blocks[index]);
            if block.smoothed && value.is_finite() {
                let largest = Largest { value, tolerance: self.around(index).1.path, n: block.n };
                let programmed = block.ends[1];
                // The curve with this small distance ends after this block end.
                let at = self.columns.partition_point(|column| column.distance <= along);
                if let Some(column) = self.columns.get_mut(at) {
                    column.path = column.path.max(value);
                    column.path_used =
                        column.path_used.max(largest.tolerance.map_or(0.0, |most| value / most));
                }
                self.see(largest, index, programmed, moved);
            }
        }
        self.done = self.done.max(to);
    }

    /// Completes the comparison after the last curve.
    pub fn finish(&mut self) {
        // After an abort no further end is reached.
        self.settle(self.before.min(self.blocks.len().saturating_sub(1)));
        self.surround();
        self.places.sort_by(|one, other| other.largest.used().total_cmp(&one.largest.used()));
    }

    fn see(&mut self, largest: Largest, block: usize, programmed: Point, moved: Point) {
        if self.path.is_none_or(|known| largest.used() > known.used()) {
            self.path = Some(largest);
        }
        let place = || Place::new(largest, block, programmed, moved, Vec::new());
        // One place for each corner.
        let near = self.places.iter_mut().find(|place| place.block.abs_diff(block) <= 1);
        if let Some(near) = near {
            if largest.used() > near.largest.used() {
                *near = place();
            }
            return;
        }
        if self.places.len() < PLACES {
            self.places.push(place());
            return;
        }
        let least =
            self.places.iter_mut().min_by(|one, other| one.largest.used().total_cmp(&other.largest.used()));
        if let Some(least) = least.filter(|least| largest.used() > least.largest.used()) {
            *least = place();
        }
    }

    /// Stores the driven path around the found places.
    fn keep(&mut self, path: Vec<Point>) {
        if self.recent.len() >= RECENT {
            self.recent.pop_front();
        }
        self.recent.push_back(path);
        for place in self.places.iter_mut().filter(|place| (1..usize::MAX).contains(&place.missing)) {
            place.around.extend(self.recent.back().into_iter().flatten());
            place.missing -= 1;
        }
        self.surround();
    }

    /// New places get the curves that were driven before.
    fn surround(&mut self) {
        for place in self.places.iter_mut().filter(|place| place.missing == usize::MAX) {
            place.around = self.recent.iter().flatten().copied().collect();
            place.missing = AROUND;
        }
    }

    fn show(&mut self, column: Column) {
        match self.columns.last_mut() {
            Some(last) if column.distance - last.distance < self.step => {
                *last = last.or(column);
            }
            _ => self.columns.push(column),
        }
        if self.columns.len() > COLUMNS {
            self.step = (2.0 * self.step).max(self.distance / COLUMNS as f64);
            let joined =
                self.columns.chunks(2).map(|pair| pair.iter().fold(pair[0], |one, other| one.or(*other)));
            let joined: Vec<Column> = joined.collect();
            self.columns = joined;
        }
    }
}
