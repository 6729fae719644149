//! Single corners for contour mode: random corners of every kind, and the check of the library's curve.
//!
//! The programmed contour is the f64 reference; the check knows the curve only by its points. Six points
//! determine a polynomial of the fifth degree: differences of six points give its derivatives at the ends
//! without an error of their own. Only the rounding of the points to 2^-32 mm remains.
use crate::cases::random::Random;
use crate::cases::{By, Kind, Move, NM, Plane, Program, set_point};
use crate::reference::geometry::Element as Programmed;
use glidepath::dynamics::{Curving, Dynamics};
use glidepath::machine::{ChannelData, MachineData};
use glidepath::nc::{self, Contour, ContourMethod, ContourSwitch, Place};
use glidepath::path::{self, Element, Measure};
use glidepath::quantity::Position;
use glidepath::smooth::contour::Preset;
use glidepath::smooth::{Data, Form, ProgrammedBlock, Smoother, Smoothing};

/// Half an LSB of a position, mm.
const ROUNDING: f64 = 0.5 / (1u64 << 32) as f64;

/// A corner between two blocks, and the tolerance it is rounded with.
#[derive(Clone, Debug)]
pub struct Case {
    /// Two blocks.
    pub program: Program,
    /// PATH_DEV, nm.
    pub path_dev: i64,
}

type Vector = [f64; 3];

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Difference of two directions; the length of a path is not that of a spiral to the last part in a million.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let unit = |v: &[f64]| v.iter().map(|x| x / dot(v, v).sqrt()).collect::<Vec<f64>>();
    distance(&unit(a), &unit(b))
}

fn direction(r: &mut Random) -> Vector {
    loop {
        let v = [0; 3].map(|_| r.between(-1.0, 1.0));
        let size = dot(&v, &v).sqrt();
        if (0.1..1.0).contains(&size) {
            return v.map(|x| x / size);
        }
    }
}

/// From the corner along `t` (or to it, with `sense` -1) over about `length`: the other end and the block. An
/// arc in the plane in which `t` lies best.
fn side(
    r: &mut Random,
    corner: &[i64],
    t: &Vector,
    length: f64,
    sense: f64,
    arc: bool,
) -> (Vec<i64>, Kind, [i64; 2]) {
    let nm = |mm: f64| (mm * NM as f64).round() as i64;
    if !arc {
        let end = corner.iter().zip(t).map(|(c, t)| c + nm(sense * length * t)).collect();
        return (end, Kind::Line, [0; 2]);
    }
    let planes = [Plane::Xy, Plane::Zx, Plane::Yz];
    let share = |plane: &Plane| plane.axes().iter().map(|&k| t[k] * t[k]).sum::<f64>();
    let plane = *planes.iter().max_by(|a, b| share(a).total_cmp(&share(b))).expect("three planes");
    let [p, q] = plane.axes();
    let inside = share(&plane).sqrt();
    let radius = r.magnitude(0.05, 500.0);
    let clockwise = r.once_in(2);
    let turn = if clockwise { -1.0 } else { 1.0 };
    // Left normal for a counter-clockwise arc.
    let centre =
        [corner[p] + nm(-turn * radius * t[q] / inside), corner[q] + nm(turn * radius * t[p] / inside)];
    let sweep = (length * inside / radius).min(5.0);
    let from = [corner[p] - centre[0], corner[q] - centre[1]].map(|x| x as f64 / NM as f64);
    let (sin, cos) = (sense * turn * sweep).sin_cos();
    let mut end = corner.to_vec();
    end[p] = centre[0] + nm(from[0] * cos - from[1] * sin);
    end[q] = centre[1] + nm(from[0] * sin + from[1] * cos);
    let other = 3 - p - q;
    end[other] += nm(sense * sweep * radius / inside * t[other]);
    (end, Kind::Arc { plane, clockwise, by: By::Offset([0; 2]) }, centre)
}

/// A corner of 0.5° to 179.5° between lines, arcs and helices of 35 µm to 1 m, tolerance 1 µm to 10 mm.
pub fn random(seed: u64) -> Case {
    let mut r = Random::new(seed);
    let corner: Vec<i64> = (0..3).map(|_| (r.between(-100.0, 100.0) * NM as f64) as i64).collect();
    let t1 = direction(&mut r);
    let angle = r.between(0.5, 179.5).to_radians();
    let across = loop {
        let v = direction(&mut r);
        let along = dot(&v, &t1);
        let w: Vector = std::array::from_fn(|k| v[k] - along * t1[k]);
        let size = dot(&w, &w).sqrt();
        if size > 0.1 {
            break w.map(|x| x / size);
        }
    };
    let t2: Vector = std::array::from_fn(|k| angle.cos() * t1[k] + angle.sin() * across[k]);
    let [arc1, arc2] = [r.once_in(2), r.once_in(2)];
    let lengths = [0; 2].map(|_| r.magnitude(0.035, 1000.0));
    let (start, kind1, centre1) = side(&mut r, &corner, &t1, lengths[0], -1.0, arc1);
    let (end, kind2, centre2) = side(&mut r, &corner, &t2, lengths[1], 1.0, arc2);
    let about = |kind: Kind, centre: [i64; 2], from: &[i64]| match kind {
        Kind::Arc { plane, clockwise, .. } => {
            let axes = plane.axes();
            let offset = [centre[0] - from[axes[0]], centre[1] - from[axes[1]]];
            Kind::Arc { plane, clockwise, by: By::Offset(offset) }
        }
        kind => kind,
    };
    let moves = vec![
        Move { kind: about(kind1, centre1, &start), target: corner.clone(), feed: 6000.0, stop: false },
        Move { kind: about(kind2, centre2, &corner), target: end, feed: 6000.0, stop: false },
    ];
    let path_dev = (r.magnitude(0.001, 10.0) * NM as f64) as i64;
    Case { program: Program { optimised: false, name: format!("corner {seed}"), start, moves }, path_dev }
}

/// Decimals as the decoder has them.
pub fn position(nm: i64) -> Position {
    Position::from_bits(set_point(nm))
}

/// An element that contour mode has emitted.
#[derive(Clone, Copy, Debug)]
pub struct Out<const AXES: usize> {
    pub element: Element<AXES>,
    pub data: Data,
    pub curving: Option<Curving>,
}

/// An element of the result, with its points.
#[derive(Clone, Debug)]
pub struct Piece<const AXES: usize> {
    /// The element in the form that the next stage gets.
    pub out: Out<AXES>,
    /// Where it begins.
    pub base: [Position; AXES],
}

impl<const AXES: usize> Piece<AXES> {
    /// Path length, mm.
    pub fn length(&self) -> f64 {
        self.out.element.shape.length.to_bits() as f64 / (1u64 << 44) as f64
    }

    /// Point at a share of its length.
    pub fn at(&self, u: f64) -> Vec<f64> {
        let mut at = [Position::ZERO; AXES];
        let length = self.out.element.shape.length.to_bits();
        let along = if u >= 1.0 { length } else { (u * length as f64) as i64 };
        self.out.element.shape.at(along, &self.base, &mut at);
        at.iter().map(|x| x.to_bits() as f64 / (1u64 << 32) as f64).collect()
    }

    /// First and second derivative over the path at an end, and what rounding may add to each.
    pub fn ends(&self, at_end: bool) -> ([Vec<f64>; 2], [f64; 2]) {
        const FIRST: [f64; 6] = [-137.0 / 60.0, 5.0, -5.0, 10.0 / 3.0, -1.25, 0.2];
        const SECOND: [f64; 6] = [3.75, -77.0 / 6.0, 107.0 / 6.0, -13.0, 61.0 / 12.0, -5.0 / 6.0];
        // Five steps of a fifth.
        let step = self.length() / 5.0;
        let points: Vec<Vec<f64>> = (0..6)
            .map(|i| self.at(if at_end { 1.0 - f64::from(i) * 0.2 } else { f64::from(i) * 0.2 }))
            .collect();
        let sum = |weights: &[f64; 6], k: usize| {
            weights.iter().zip(&points).map(|(w, p)| w * (p[k] - points[0][k])).sum::<f64>()
        };
        let sign = if at_end { -1.0 } else { 1.0 };
        let first = (0..AXES).map(|k| sign * sum(&FIRST, k) / step).collect();
        let second = (0..AXES).map(|k| sum(&SECOND, k) / (step * step)).collect();
        let size = |weights: &[f64; 6]| weights.iter().map(|w| w.abs()).sum::<f64>() * ROUNDING;
        ([first, second], [size(&FIRST) / step, size(&SECOND) / (step * step)])
    }
}

/// The blocks of a program as input of the contour stage.
pub fn blocks<const AXES: usize>(
    program: &Program,
    machine: &MachineData<AXES>,
) -> Vec<ProgrammedBlock<AXES>> {
    let measure = Measure::of(machine);
    let mut from: [Position; AXES] = std::array::from_fn(|k| position(program.start[k]));
    let mut at = program.start.clone();
    let mut out = Vec::new();
    for (number, block) in program.moves.iter().enumerate() {
        let to: [Position; AXES] = std::array::from_fn(|k| position(block.target[k]));
        let data = Data {
            feed: Some(block.feed as f32),
            n: 0,
            place: Place::NONE,
            number: number as u32,
            stop: block.stop,
        };
        let (element, form): (Element<AXES>, Form) = match block.kind {
            Kind::Arc { plane, clockwise, by: By::Offset(offset) } => {
                let axes = plane.axes();
                let centre = [0, 1].map(|i| position(at[axes[i]] + offset[i]));
                let plane = match plane {
                    Plane::Xy => nc::Plane::G17,
                    Plane::Zx => nc::Plane::G18,
                    Plane::Yz => nc::Plane::G19,
                };
                let element = path::arc(&from, &to, centre, plane, clockwise, &measure).expect("an arc");
                (element, Form::Arc { centre, plane, clockwise })
            }
            _ => (path::line(&from, &to, &measure).expect("a line").expect("motion"), Form::Line),
        };
        out.push(ProgrammedBlock { element, from, to, form, data });
        from = to;
        at.clone_from(&block.target);
    }
    out
}

/// Runs blocks through contour mode with every corner on.
pub fn round<const AXES: usize>(
    blocks: &[ProgrammedBlock<AXES>],
    machine: &MachineData<AXES>,
    contour: &Contour,
) -> Vec<Piece<AXES>> {
    let on = Contour { switch: Some(ContourSwitch::On), ..*contour };
    smooth(blocks, machine, |stage| stage.contour(&on, false).expect("no spline is on"))
}

/// Runs blocks through the stage, with what is switched on before them.
pub fn smooth<const AXES: usize>(
    blocks: &[ProgrammedBlock<AXES>],
    machine: &MachineData<AXES>,
    switch: impl FnOnce(&mut Smoothing<AXES>),
) -> Vec<Piece<AXES>> {
    let dynamics = Dynamics::new(machine);
    let ChannelData { check_jerk_on_poly_path: check_jerk, merge_chords, .. } = machine.channel;
    let preset = Preset { check_jerk, chords: f32::from(merge_chords) * 0.01 };
    let mut stage = Smoothing::new(Measure::of(machine), preset, 0);
    switch(&mut stage);
    let mut out = Vec::new();
    let mut at = blocks[0].from;
    let mut drain = |stage: &mut Smoothing<AXES>| {
        loop {
            while stage.work(&dynamics) {}
            let mut next = None;
            let emitted = stage.emit(|smoothed| {
                let (element, data) = (*smoothed.element, *smoothed.data);
                next = Some(Out { element, data, curving: smoothed.curving });
            });
            assert_eq!(emitted, next.is_some());
            let Some(next) = next else { break };
            let base = next.element.shape.base(&at);
            next.element.shape.at(next.element.shape.length.to_bits(), &base, &mut at);
            out.push(Piece { out: next, base });
        }
    };
    for block in blocks {
        stage.take(block, &dynamics, glidepath::smooth::Parting::None);
        drain(&mut stage);
    }
    stage.flush(false);
    drain(&mut stage);
    out
}

/// DEV with a tolerance in nm, without other restrictions.
pub fn dev(path_dev: i64) -> Contour {
    Contour {
        method: Some(ContourMethod::Dev),
        path_dev: Some(position(path_dev)),
        max_angle: Some(Position::const_from_int(180)),
        ..Contour::default()
    }
}

/// Measured values of a corner.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Deviation over tolerance.
    pub used: f64,
    /// Another limit than the tolerance determines the corner distance: half a block, a quarter of a turn, or
    /// blocks that come so near after the corner that only a smaller curve is smooth.
    pub limited: bool,
    /// Largest relative difference between path speed and speed along the curve; for a curve over time, by
    /// how much the curve is faster.
    pub uneven: f64,
    /// Elements of the curve.
    pub elements: usize,
    /// No curve was made.
    pub sharp: bool,
    /// The curve is planned over time.
    pub timed: bool,
}

/// Distance of a point from a programmed block.
fn from_block(block: &Programmed, point: &[f64], near: f64) -> f64 {
    let u = block.project(point, near).clamp(0.0, 1.0);
    distance(&block.at(u), point).min(distance(&block.at(near), point))
}

/// Checks one corner.
///
/// # Errors
/// The fault.
pub fn judge(case: &Case, machine: &MachineData<3>) -> Result<Seen, String> {
    judge_with(case, machine, |dev| dev)
}

/// Checks one corner that is rounded with DEV, changed by `rule`.
///
/// # Errors
/// The fault.
pub fn judge_with(
    case: &Case,
    machine: &MachineData<3>,
    rule: impl Fn(Contour) -> Contour,
) -> Result<Seen, String> {
    let contour = case.program.contour_as_decoded(machine);
    let [before, behind] = &contour.elements[..] else { return Err("two blocks".to_owned()) };
    let blocks = blocks(&case.program, machine);
    let pieces = round(&blocks, machine, &rule(dev(case.path_dev)));
    let tolerance = case.path_dev as f64 / NM as f64;
    let curve: Vec<&Piece<3>> = pieces.iter().filter(|p| p.out.curving.is_some()).collect();
    let mut seen = Seen { elements: curve.len(), ..Seen::default() };
    if curve.is_empty() {
        seen.sharp = true;
        return Ok(seen);
    }

    seen.timed = curve.iter().any(|p| p.out.element.bounds.is_some_and(|b| b.is_timed()));

    // Transitions: position equal in every bit, direction and curvature within the resolution.
    let mut at = blocks[0].from;
    for piece in &pieces {
        if piece.out.element.shape.base(&at) != piece.base {
            return Err("elements do not join".to_owned());
        }
        piece.out.element.shape.at(piece.out.element.shape.length.to_bits(), &piece.base, &mut at);
    }
    if at != blocks[1].to {
        return Err(format!("ends at {at:?}"));
    }
    let neighbour = |block: &Programmed, s: f64| {
        // Direction and curvature of a programmed block over its length, at a part of it.
        let length = block.main_length();
        let unit = |s: f64| {
            let d = block.derivative(s);
            let size = dot(&d, &d).sqrt();
            d.into_iter().map(|x| x / size).collect::<Vec<f64>>()
        };
        let h = 1e-4;
        let (d0, d1) = (unit(s - h), unit(s + h));
        [unit(s), (0..3).map(|k| (d1[k] - d0[k]) / (2.0 * h) / length).collect()]
    };
    let first = curve[0].at(0.0);
    let last = curve[curve.len() - 1].at(1.0);
    let shares = [before.project(&first, 1.0 - 1e-9), behind.project(&last, 1e-9)];
    let mut previous = (neighbour(before, shares[0]), [0.0; 2]);
    let kappa = curve
        .iter()
        .map(|p| p.out.element.bounds.map_or(0.0, |b| b.second.iter().fold(0.0_f32, |a, b| a.max(*b))))
        .fold(0.0, f32::max);
    for (i, piece) in curve.iter().enumerate() {
        let (ends, noise) = piece.ends(false);
        for order in 0..2 {
            // Over time a curve may be nearly at rest, where its direction is not known as well.
            let off = if order == 0 && !seen.timed {
                apart(&ends[0], &previous.0[0])
            } else {
                distance(&ends[order], &previous.0[order])
            };
            // A millionth, or 10^-5 of the largest curvature, and what rounding makes of either side.
            let allowed = 2.0 * (noise[order] + previous.1[order]) + [1e-6, 1e-5 * f64::from(kappa)][order];
            if off > allowed {
                return Err(format!(
                    "joint {i}, order {order}: {off} above {allowed}; {:?} {:?}",
                    ends[order], previous.0[order]
                ));
            }
        }
        previous = piece.ends(true);
    }
    let rest = neighbour(behind, shares[1]);
    for order in 0..2 {
        let off =
            if order == 0 { apart(&previous.0[0], &rest[0]) } else { distance(&previous.0[1], &rest[1]) };
        let allowed = 2.0 * previous.1[order] + [1e-6, 1e-5 * f64::from(kappa)][order];
        if off > allowed {
            return Err(format!("last joint, order {order}: {off} above {allowed}"));
        }
    }

    // Deviation: both ways between curve and contour.
    const POINTS: u32 = 64;
    let samples: Vec<Vec<f64>> =
        curve.iter().flat_map(|p| (0..=POINTS).map(|i| p.at(f64::from(i) / f64::from(POINTS)))).collect();
    let mut most = 0.0_f64;
    for q in &samples {
        most = most.max(from_block(before, q, shares[0].max(0.0)).min(from_block(
            behind,
            q,
            shares[1].min(1.0),
        )));
        most = most.max(0.0);
    }
    let to_curve = |point: &[f64]| {
        let (i, _) = samples
            .iter()
            .enumerate()
            .map(|(i, q)| (i, distance(q, point)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .expect("samples");
        // Between the neighbouring samples the distance has one minimum; the samples may belong to two
        // elements.
        let per = POINTS as usize + 1;
        let in_piece = |i: usize| {
            let (piece, step) = (curve[i / per], 1.0 / f64::from(POINTS));
            let u = (i % per) as f64 * step;
            let [mut low, mut high] = [(u - step).max(0.0), (u + step).min(1.0)];
            for _ in 0..30 {
                let third = (high - low) / 3.0;
                if distance(&piece.at(low + third), point) < distance(&piece.at(high - third), point) {
                    high -= third;
                } else {
                    low += third;
                }
            }
            distance(&piece.at(0.5 * (low + high)), point)
        };
        let beside = [i.saturating_sub(1), i, (i + 1).min(samples.len() - 1)];
        beside.into_iter().map(in_piece).fold(f64::INFINITY, f64::min)
    };
    for i in 0..=POINTS {
        let u = f64::from(i) / f64::from(POINTS);
        most = most.max(to_curve(&before.at(shares[0] + (1.0 - shares[0]) * u)));
        most = most.max(to_curve(&behind.at(shares[1] * u)));
    }
    seen.used = most / tolerance;
    let shares = [1.0 - shares[0], shares[1]];
    seen.limited = shares.iter().any(|s| *s > 0.4999);
    seen.limited |= curve.len() >= 16;
    for (block, share) in [before, behind].into_iter().zip(shares) {
        if let crate::reference::geometry::Shape::Arc { sweep, .. } = block.shape {
            seen.limited |= sweep.abs() * share > std::f64::consts::FRAC_PI_2 * 0.9999;
        }
    }

    // Speed along the curve.
    for piece in &curve {
        let mut q = piece.at(0.0);
        for i in 1..=50 {
            let next = piece.at(f64::from(i) / 50.0);
            let step = piece.length() / 50.0;
            let speed = distance(&q, &next) / step;
            let noise = 4.0 * ROUNDING / step;
            // A chord is shorter than its arc: (κh)²/24.
            let chord = (f64::from(kappa) * step).powi(2) / 24.0;
            seen.uneven = seen.uneven.max(speed - 1.0 - noise);
            if !seen.timed {
                seen.uneven = seen.uneven.max(1.0 - speed - noise - chord);
            }
            q = next;
        }
    }
    Ok(seen)
}
