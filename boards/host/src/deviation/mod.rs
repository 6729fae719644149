//! How far the path of the motion is from the programmed one, either way, whatever made it.
//!
//! Takes the blocks of the decoder and points of every curve that the planner hands on; gives the largest
//! deviation of the main axes, that of every other axis, and the places where they are. The motion runs along
//! these curves, so nothing depends on speed, override and cycle.
//!
//! Points a 16th of a curve apart tell where a deviation is largest; how large it is there the curve itself tells
//! (`peak`), as between two points a deviation may have a cusp: where the nearest block is another one.
mod peak;
mod tell;

use crate::machine::Machine;
use crate::program::{Kind, Program, sweep};
use crate::tolerance::Tolerance;
use std::collections::VecDeque;
pub use tell::Told;

/// Chords of a curve.
pub const CHORDS: u32 = 16;
/// Places that are kept, with curves around each of them.
const PLACES: usize = 3;
const AROUND: usize = 12;
/// Curves that are remembered: more than come between a place and the word that it is one.
const RECENT: usize = 96;
/// Blocks around that of a curve that it may belong to, and as far as they are looked for.
const NEAR: usize = 2;
const FAR: usize = 64;
/// Blocks that may lie between a curve and one that is taken back.
const BACK: usize = 1024;
/// Parts of a path that are shown at most.
const COLUMNS: usize = 4096;

/// Places of a helix among which the nearest one is looked for first.
const PLACES_OF_A_HELIX: u32 = 32;

/// A smaller deviation is rounding, mm or degrees.
pub const NOTHING: f64 = 1e-6;

/// A point of the main axes.
pub type Point = [f64; 3];

/// A programmed motion.
struct Block {
    /// All axes, where it begins and where it ends.
    from: Vec<f64>,
    to: Vec<f64>,
    /// Of the main axes.
    ends: [Point; 2],
    arc: Option<Turn>,
    /// Along the main axes, mm.
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

/// A place of a block.
#[derive(Clone, Copy)]
struct Foot {
    block: usize,
    /// 0…1 along it.
    part: f64,
    distance: f64,
}

/// How far a point of the driven path is from the programmed one.
struct Measured {
    /// The point.
    q: Point,
    /// Where the programmed path is nearest to it.
    seen: Foot,
    /// Whether that is smoothed, and what is permitted.
    smoothed: bool,
    tolerance: Tolerance,
    /// Of every axis that is no main axis.
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
    /// As a part of its tolerance; where there is none, of no tolerance at all.
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
    /// On the programmed path, and on the driven one.
    pub programmed: Point,
    pub moved: Point,
    /// The driven path around it.
    pub around: Vec<Point>,
    /// Curves that are still to come.
    missing: usize,
}

impl Place {
    /// With the driven path `around` it, as far as it is known.
    pub fn new(largest: Largest, block: usize, programmed: Point, moved: Point, around: Vec<Point>) -> Self {
        Self { largest, block, programmed, moved, around, missing: usize::MAX }
    }
}

/// Deviations over a part of the path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Column {
    /// Path distance at its end, mm.
    pub distance: f64,
    /// Of the main axes, and of the others.
    pub path: f64,
    pub track: f64,
    /// As parts of their tolerances; 0 where there is none.
    pub path_used: f64,
    pub track_used: f64,
}

impl Column {
    /// The larger one of each, up to the end of both.
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
    /// Axes that move beside the path: what they do there is not compared.
    beside: Vec<usize>,
    blocks: Vec<Block>,
    /// Blocks up to so much path may be left out.
    relevant: f64,
    /// Of the end of each block: its distance from the driven path, where that is, and how far along.
    ends: Vec<(f64, Point, f64)>,
    /// Ends before that one are done.
    done: usize,
    /// The block of the last curve, or the one that its end is at, where its block stands for several.
    before: usize,
    /// Where the last curve ends.
    last: Option<Point>,
    /// Curves so far.
    pub curves: u64,
    /// Of the main axes and of each other axis.
    pub path: Option<Largest>,
    pub track: Vec<Option<Largest>>,
    pub places: Vec<Place>,
    /// Along the path, in parts of about one length.
    pub columns: Vec<Column>,
    step: f64,
    recent: VecDeque<Vec<Point>>,
    distance: f64,
    /// Something is smoothed.
    pub smooths: bool,
}

fn apart(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// The point of the main axes; where one moves beside the path, zero.
fn point_of(all: &[f64], main: &[usize], beside: &[usize]) -> Point {
    let of = |axis: &usize| all.get(*axis).filter(|_| !beside.contains(axis)).copied();
    std::array::from_fn(|k| main.get(k).and_then(of).unwrap_or(0.0))
}

fn between(a: &Point, b: &Point, part: f64) -> Point {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * part)
}

/// Where a point is nearest to a straight line, 0…1.
fn along(q: &Point, a: &Point, b: &Point) -> f64 {
    let square = apart(a, b).powi(2);
    let product = (0..3).map(|k| (q[k] - a[k]) * (b[k] - a[k])).sum::<f64>();
    if square > 0.0 { (product / square).clamp(0.0, 1.0) } else { 0.0 }
}

impl Block {
    /// The point of the main axes at a part of it.
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

    /// Whether it moves an axis to another place.
    fn moves(&self, axis: usize) -> bool {
        self.from[axis] != self.to[axis]
    }

    /// How far an axis, which is no main axis, is from where it was programmed around a foot: as far to both sides
    /// as the path is off it. A full circle goes on behind its end, and in a block without length all may be meant.
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

    /// Where a point is nearest to an arc, around a part of it.
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

    /// Where a point is nearest to it, and how far.
    fn foot(&self, block: usize, q: &Point) -> Foot {
        let part = match &self.arc {
            None => along(q, &self.ends[0], &self.ends[1]),
            // All along a helix, then around the nearest place.
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
                // Behind the end or before the start, whichever is nearer.
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
    /// Of a program on a machine.
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

    /// The programmed end points around a block, as far as they are shown, and their first one's index.
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

    /// Takes in a curve: its motion block, points of all axes along it, [`CHORDS`] and one, and `exact`, which gives
    /// the point at each 2^16th of its length.
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

    /// Curves were taken back, as an abort does: the block that the path is at, one of the last ones.
    fn back(&self, block: usize, q: &Point) -> usize {
        let to = block.max(self.before);
        let near = (to.saturating_sub(BACK)..=to).map(|block| self.blocks[block].foot(block, q));
        near.min_by(|one, other| one.distance.total_cmp(&other.distance)).map_or(block, |foot| foot.block)
    }

    /// How far a point of the driven path, with all axes, is from the programmed one.
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
            // Each of them may be the one.
            let last = to.max(seen.block + NEAR).min(self.blocks.len() - 1);
            let near = (from..=last).map(foot);
            let near: Vec<Foot> = near.filter(|foot| foot.distance <= seen.distance + NOTHING).collect();
            track = self.follow(&near, all, tolerance);
        }
        Measured { q, seen, smoothed, tolerance, track }
    }

    /// The other axes: how far each is from what was programmed, at one of the feet it is nearest to; none where that
    /// is not compared.
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

    /// The deviations of a point count.
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

    /// Whether the path is smoothed there, and what is permitted: of the corners at both ends, the larger;
    /// nothing where one of them is not monitored. A corner with blocks left out is that of the block before
    /// them.
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

    /// The ends of blocks that the curve passes: how near it comes.
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
            // The curve is no further from its chord than that is long.
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

    /// Ends before that one are passed.
    fn settle(&mut self, to: usize) {
        for index in self.done..to {
            let ((value, moved, along), block) = (self.ends[index], &self.blocks[index]);
            if block.smoothed && value.is_finite() {
                let largest = Largest { value, tolerance: self.around(index).1.path, n: block.n };
                let programmed = block.ends[1];
                // The curve that comes so near ends behind there.
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

    /// All curves are there.
    pub fn finish(&mut self) {
        // Behind an abort no end is met.
        self.settle(self.before.min(self.blocks.len().saturating_sub(1)));
        self.surround();
        self.places.sort_by(|one, other| other.largest.used().total_cmp(&one.largest.used()));
    }

    fn see(&mut self, largest: Largest, block: usize, programmed: Point, moved: Point) {
        if self.path.is_none_or(|known| largest.used() > known.used()) {
            self.path = Some(largest);
        }
        let place = || Place::new(largest, block, programmed, moved, Vec::new());
        // One for each corner.
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

    /// The driven path around the places found.
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

    /// Places that were just found get what was driven before.
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
