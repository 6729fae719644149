//! Compares every row with the limits of its blocks: speed, acceleration and jerk of every axis.
//!
//! The limits are the machine data with the weights (G130…G134, G231…G233) and the slope of a block, and in
//! rapid motion those of rapid motion. A difference of order n spans n ticks. It may have the highest value
//! that one of the blocks of these ticks permits:
//!
//! | these ticks are in | acceleration | jerk |
//! |---|---|---|
//! | a part of one straight block | of the slope (P-AXIS-00001, 00002, rapid 00004) | of the slope |
//! | an arc, a curve, a transition | in all (P-AXIS-00008) | of slope and contour |
//!
//! If the corner between blocks may be rounded, a curve may belong to its block and the neighbouring blocks.
//! The neighbouring blocks count too if they have the same weights and slope. A corner between blocks with
//! different weights or slopes has no curve.
//!
//! In addition to rounding of set points, a difference may exceed the limits only by the effect of the path's
//! resolution (`resolution.rs`).
//!
//! Jerk is not compared where the machine data permit a step: at transitions of blocks without P-CHAN-00009
//! or with P-AXIS-00013. Jerk is not compared at all if the program switches off the check of curves
//! (CHECK_JERK=0, P-CHAN-00110 = 0). The monitor counts transitions with a step.
use crate::diagnose::Diagnostic;
use crate::machine::{Limits, Machine};
use crate::program::{Kind, Program};
use crate::resolution::Resolution;
use glidepath::machine::AxisKind;

/// The comparison of one axis and order.
const NAMES: [&str; 3] = ["speed", "acceleration", "jerk"];

/// Rows that a third difference covers.
const COVERED: u64 = 3;

/// For each order: the limit per second, and the highest difference in LSB of a position.
type Bounds = [(f64, i128); 3];

/// The larger value of each.
fn larger(one: Bounds, other: Bounds) -> Bounds {
    std::array::from_fn(|k| if one[k].1 > other[k].1 { one[k] } else { other[k] })
}

/// Limits of an axis under equal weights and slope: by [`Motion::kind`].
type Kinds = [Bounds; 4];

/// A motion block.
#[derive(Clone, Copy, Debug)]
struct Motion {
    /// Index of its weights and slope.
    dynamics: u32,
    rapid: bool,
    arc: bool,
    /// Whether a curve may lead to the next block.
    smoothed: bool,
}

impl Motion {
    /// Index into [`Kinds`].
    fn kind(self, bent: bool) -> usize {
        usize::from(self.rapid) + 2 * usize::from(bent)
    }
}

/// Place of a row: its motion block, and whether it is on a curve that is no arc.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct At {
    block: u32,
    curve: bool,
}

/// An axis: its limits on the path, its limits in each independent motion, and its current state.
#[derive(Clone, Debug)]
struct Compared {
    /// Limits anywhere on the path.
    anywhere: Bounds,
    /// Limits by weights and slope.
    dynamics: Vec<Kinds>,
    /// Current state.
    path: Bounds,
    beside: Vec<Bounds>,
    /// Number of its independent motions that have begun, and whether the last one continues.
    begun: usize,
    is_beside: bool,
    /// Limits before the last change.
    before: Bounds,
    /// First row after the last change.
    since: u64,
}

impl Compared {
    /// Current limits.
    fn now(&self) -> Bounds {
        let motion = self.begun.checked_sub(1).filter(|_| self.is_beside);
        motion.and_then(|motion| self.beside.get(motion)).copied().unwrap_or(self.path)
    }

    /// Limits of the differences up to a row; around a change, the larger value.
    fn bounds(&self, tick: u64) -> Bounds {
        let now = self.now();
        if tick >= self.since + COVERED {
            return now;
        }
        larger(self.before, now)
    }

    /// From the row with this number on, the axis moves independently of the path, or no longer does.
    fn change(&mut self, tick: u64, is_beside: bool) {
        if is_beside != self.is_beside {
            self.before = self.bounds(tick);
            self.is_beside = is_beside;
            self.begun += usize::from(is_beside);
            self.since = tick;
        }
    }
}

/// The first value beyond a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Excess {
    /// Index of the axis.
    pub axis: usize,
    /// 0 speed, 1 acceleration, 2 jerk.
    pub order: usize,
    /// Row of the trace.
    pub tick: u64,
    /// N number of the block.
    pub n: u32,
    /// Per second, in mm or degrees.
    pub value: f64,
    /// The limit.
    pub limit: f64,
}

/// A permitted step of acceleration at a transition.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Step {
    /// Index of the axis.
    pub axis: usize,
    /// N number of the block after the transition.
    pub n: u32,
    /// mm/s² or °/s².
    pub size: f64,
}

/// The comparison.
#[derive(Debug, Default)]
pub struct Monitor {
    axes: Vec<Compared>,
    motions: Vec<Motion>,
    /// The rows of a third difference; the latest row is the last one.
    rows: [At; COVERED as usize + 1],
    cycle_s: f64,
    /// Whether steps are permitted at transitions.
    steps: bool,
    /// Whether jerk of curves is not limited.
    curves: bool,
    /// The last transition before a row, and whether a step has shown there.
    joint: Option<(u64, bool)>,
    /// Sum of the third differences since this row, per axis: a step shows in two or three of them.
    sums: Vec<i128>,
    /// The first excess of each axis and order.
    pub excess: Vec<Excess>,
    /// Number of transitions with a step.
    pub stepped: u64,
    /// The highest of these steps.
    pub largest: Step,
}

const LSB_PER_MM: f64 = (1_u64 << 32) as f64;

impl Monitor {
    /// A monitor for a program on a machine.
    pub fn new(machine: &Machine, program: &Program) -> Self {
        let cycle_s = machine.cycle_s();
        let bounds = |allowed: Limits, resolution: Resolution| {
            let mut scale = LSB_PER_MM;
            let [speed, accel, jerk] = resolution.differences();
            // Rounding adds half an LSB for each of the points, weighted 1 1, 1 2 1, 1 3 3 1.
            let more =
                [(allowed.speed, 1.0 + speed), (allowed.accel, 2.0 + accel), (allowed.jerk, 4.0 + jerk)];
            more.map(|(limit, more)| {
                scale *= cycle_s;
                let bound = limit * scale * (1.0 + 1e-12) + more;
                (limit, if bound < 1e30 { bound as i128 } else { i128::MAX })
            })
        };
        let resolution = program.resolution(machine);
        let axes = (0..machine.axes.len()).map(|k| {
            let resolution = resolution.get(k).copied().unwrap_or_default();
            let anywhere = bounds(program.allowed(k, machine), resolution);
            let dynamics = program.dynamics.iter().filter_map(|axes| axes.get(k));
            let dynamics = dynamics.map(|allowed| kinds(*allowed).map(|allowed| bounds(allowed, resolution)));
            let beside = program.limits_beside.get(k).into_iter().flatten();
            let beside = beside.map(|allowed| bounds(*allowed, Resolution::default())).collect();
            Compared {
                anywhere,
                dynamics: dynamics.collect(),
                path: anywhere,
                beside,
                begun: 0,
                is_beside: false,
                before: anywhere,
                since: 0,
            }
        });
        let motions = program.motions().map(|segment| Motion {
            dynamics: segment.dynamics,
            rapid: segment.feed.is_none(),
            arc: matches!(segment.kind, Kind::Arc { .. }),
            smoothed: segment.smoothed,
        });
        Self {
            axes: axes.collect(),
            motions: motions.collect(),
            cycle_s,
            steps: !machine.channel.corr_v_trans_jerk
                || machine.axes.iter().any(|axis| axis.a_trans_weight > 0),
            curves: program.free_curves,
            sums: vec![0; machine.axes.len()],
            ..Self::default()
        }
    }

    /// The row with this number is the first row after a transition.
    pub fn passes(&mut self, tick: u64) {
        self.joint = Some((tick, false));
        self.sums.fill(0);
    }

    /// The next row is in this motion block, on a `curve` or not.
    pub fn drives(&mut self, block: u32, curve: bool) {
        let before = self.rows;
        self.rows.rotate_left(1);
        self.rows[COVERED as usize] = At { block, curve };
        if self.rows == before {
            return;
        }
        let driven = [2, 1, 0].map(|from| self.driven(from));
        for axis in &mut self.axes {
            axis.path = std::array::from_fn(|order| {
                let of = |(dynamics, kind): &(u32, usize)| axis.dynamics.get(*dynamics as usize)?.get(*kind);
                let all: Option<Vec<&Bounds>> = driven[order].iter().map(of).collect();
                let most = all.and_then(|all| all.into_iter().copied().reduce(larger));
                most.unwrap_or(axis.anywhere)[order]
            });
        }
    }

    /// Weights and slope, and [`Motion::kind`], of the ticks from one of the rows on. Empty if unknown.
    fn driven(&self, from: usize) -> Vec<(u32, usize)> {
        let rows = self.rows.get(from..).unwrap_or(&[]);
        let blocks = rows.iter().map(|row| row.block as usize);
        let (Some(first), Some(last)) = (blocks.clone().min(), blocks.max()) else { return Vec::new() };
        let Some(inside) = self.motions.get(first..=last) else { return Vec::new() };
        let curve = rows.iter().any(|row| row.curve);
        let bent = curve || inside.len() > 1 || inside.iter().any(|motion| motion.arc);
        let [before, behind] = [first.checked_sub(1), Some(last)].map(|joint| {
            let motion = self.motions.get(joint?).filter(|motion| curve && motion.smoothed);
            motion.map(|_| joint)?
        });
        let beside = before.into_iter().chain(behind.map(|block| block + 1));
        let beside = beside.filter_map(|block| self.motions.get(block));
        let same = |motion: &&Motion| inside.iter().any(|other| other.dynamics == motion.dynamics);
        let all = inside.iter().chain(beside.filter(same));
        let mut driven: Vec<(u32, usize)> = all.map(|motion| (motion.dynamics, motion.kind(bent))).collect();
        driven.sort_unstable();
        driven.dedup();
        driven
    }

    /// From the row with this number on, these axes move independently of the path, bit i for axis i. Call
    /// this also between two motions of an axis, which may come in one row.
    pub fn beside(&mut self, tick: u64, moving: u32) {
        for (k, axis) in self.axes.iter_mut().enumerate() {
            axis.change(tick, moving >> k & 1 == 1);
        }
    }

    /// The latest first, second and third difference of an axis, LSB, in a block.
    pub fn look(&mut self, axis: usize, tick: u64, n: u32, differences: &[i128; 3]) {
        let (Some(compared), Some(sum)) = (self.axes.get(axis), self.sums.get_mut(axis)) else { return };
        *sum += differences[2];
        let mut scale = LSB_PER_MM;
        for (order, (difference, (limit, bound))) in differences.iter().zip(compared.bounds(tick)).enumerate()
        {
            scale *= self.cycle_s;
            if difference.unsigned_abs() <= bound.unsigned_abs() {
                continue;
            }
            let value = difference.unsigned_abs() as f64 / scale;
            if order == 2 {
                if self.curves {
                    continue;
                }
                if let (true, Some((at, seen))) = (self.steps, &mut self.joint)
                    && tick < *at + COVERED
                {
                    self.stepped += u64::from(!*seen);
                    *seen = true;
                    // A step of speed shows to both sides.
                    let size =
                        sum.unsigned_abs().max(difference.unsigned_abs()) as f64 / scale * self.cycle_s;
                    if size > self.largest.size {
                        self.largest = Step { axis, n, size };
                    }
                    continue;
                }
            }
            if !self.excess.iter().any(|other| other.axis == axis && other.order == order) {
                self.excess.push(Excess { axis, order, tick, n, value, limit });
            }
        }
    }

    /// The text about jerk that was not compared; empty if all jerk was compared.
    pub fn left_out(&self) -> Option<String> {
        if self.curves {
            return Some("jerk not compared: CHECK_JERK = 0".to_owned());
        }
        self.steps.then(|| "jerk not compared at joints: P-CHAN-00009 = 0 or P-AXIS-00013 given".to_owned())
    }

    /// Speed, acceleration and jerk that an axis may have in the row with this number, the latest one.
    pub fn permitted(&self, axis: usize, tick: u64) -> [f64; 3] {
        self.axes.get(axis).map_or([0.0; 3], |compared| compared.bounds(tick).map(|(limit, _)| limit))
    }

    /// One message for each excess.
    pub fn errors(&self, machine: &Machine) -> Vec<Diagnostic> {
        let messages = self.excess.iter().map(|excess| {
            let Excess { axis, order, tick, n, value, limit } = excess;
            let data = &machine.axes[*axis];
            let unit = if data.kind == AxisKind::Linear { "mm" } else { "°" };
            let per = ["/s", "/s²", "/s³"][*order];
            let (name, what, at) = (data.name.as_str(), NAMES[*order], *tick as f64 * self.cycle_s);
            let digits = digits(value - limit);
            Diagnostic::error(format!(
                "axis {name}: {what} {value:.digits$} {unit}{per} exceeds its limit {limit:.digits$} {unit}{per} at tick {tick} ({at:.4} s), in block N{n}"
            ))
        });
        messages.collect()
    }
}

/// Limits at feed and in rapid motion, in straight and in curved blocks: speed, acceleration and jerk.
fn kinds(allowed: Limits) -> [Limits; 4] {
    let of = |speed, accel, jerk| Limits { speed, accel, jerk, ..allowed };
    let Limits { speed, speed_rapid, accel, .. } = allowed;
    [
        of(speed, allowed.accel_feed.max(allowed.brake_feed), allowed.ramp_feed),
        of(speed_rapid, allowed.accel_rapid, allowed.ramp_rapid),
        of(speed, accel, allowed.jerk_feed),
        of(speed_rapid, accel, allowed.jerk_rapid),
    ]
}

/// Number of decimals that show an excess with two significant digits: at least three, at most those of an
/// f64.
fn digits(excess: f64) -> usize {
    (3..12).find(|&digits| excess * 10_f64.powi(digits) >= 10.0).unwrap_or(12) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn monitor(machine: &Machine) -> Monitor {
        Monitor::new(machine, &Program::empty(machine))
    }

    /// A difference of a value in mm, mm/s² or mm/s³, in LSB.
    fn lsb(mm: f64) -> i128 {
        (mm * LSB_PER_MM) as i128
    }

    #[test]
    fn each_limit_is_compared_with_its_difference() {
        let machine = Machine::built_in();
        // 1000 mm/s, 6000 mm/s², 200 000 mm/s³ at 1 ms.
        let most = [1.0, 6e-3, 2e-4];
        for order in 0..3 {
            let mut monitor = monitor(&machine);
            let mut differences = [0; 3];
            differences[order] = -lsb(most[order]) - [1, 2, 4][order];
            monitor.look(1, 7, 20, &differences);
            assert_eq!(monitor.excess, []);
            differences[order] -= 100_000;
            monitor.look(1, 8, 20, &differences);
            monitor.look(1, 9, 30, &differences);
            let [Excess { axis: 1, tick: 8, n: 20, order: seen, value, limit }] = monitor.excess[..] else {
                panic!("{:?}", monitor.excess)
            };
            assert_eq!(seen, order);
            assert!(value > limit && value < limit * 1.2, "{value} of {limit}");
            let text = &monitor.errors(&machine)[0].message;
            for part in ["axis Y", NAMES[order], "tick 8 (0.0080 s)", "block N20"] {
                assert!(text.contains(part), "{text}");
            }
        }
    }

    #[test]
    fn the_digits_told_differ() {
        let machine = Machine::built_in();
        let mut monitor = monitor(&machine);
        let excess = |value, limit| Excess { axis: 0, order: 1, tick: 383, n: 0, value, limit };
        for (value, limit, told) in [
            (477.000_198, 477.0, "477.00020 mm/s² exceeds its limit 477.00000 mm/s²"),
            (1_186.000_88, 1_186.0, "1186.00088 mm/s² exceeds its limit 1186.00000 mm/s²"),
            (480.25, 477.0, "480.250 mm/s² exceeds its limit 477.000 mm/s²"),
        ] {
            monitor.excess = vec![excess(value, limit)];
            let text = &monitor.errors(&machine)[0].message;
            assert!(text.contains(told), "{text}");
        }
    }

    /// Where corners are rounded a curve begins on the nearest step of a position.
    #[test]
    fn the_start_of_a_curve_adds_to_rounding() {
        let machine = Machine::built_in();
        let mut program = Program::empty(&machine);
        let beyond = |program: &Program, more: i128| {
            let mut monitor = Monitor::new(&machine, program);
            // 6000 mm/s² at 1 ms, not whole in LSB.
            monitor.look(0, 7, 20, &[0, lsb(6e-3) + more, 0]);
            monitor.excess.len()
        };
        assert_eq!((beyond(&program, 2), beyond(&program, 3)), (0, 1));
        program.through_points = true;
        assert_eq!((beyond(&program, 3), beyond(&program, 5)), (0, 1));
    }

    #[test]
    fn steps_are_counted_where_they_are_permitted_alone() {
        let mut machine = Machine::built_in();
        machine.channel.corr_v_trans_jerk = false;
        let mut monitor = monitor(&machine);
        let jerk = [0, 0, lsb(1e-3)];
        monitor.passes(10);
        monitor.look(0, 12, 20, &jerk);
        monitor.passes(50);
        monitor.look(2, 51, 40, &jerk);
        monitor.look(2, 52, 40, &jerk);
        assert_eq!((monitor.stepped, monitor.excess.len()), (2, 0));
        assert_eq!((monitor.largest.axis, monitor.largest.n), (2, 40));
        assert!((monitor.largest.size - 2000.0).abs() < 1e-3, "{:?}", monitor.largest);
        // Acceleration is limited there too, and jerk elsewhere.
        monitor.look(0, 52, 40, &[0, lsb(7e-3), 0]);
        monitor.look(0, 53, 40, &jerk);
        assert_eq!(monitor.excess.iter().map(|excess| excess.order).collect::<Vec<_>>(), [1, 2]);
    }

    /// Lines of 50 mm, whose weights change in front of each; the last one is bent.
    fn weighted() -> (Machine, Program) {
        let machine = Machine::built_in();
        let allowed = |weight: u32| {
            let weigh = |axis: &glidepath::machine::AxisData| {
                let (a, ramp) = (axis.a_beschl * weight / 100, axis.tr_beschl_zu);
                let axis = glidepath::machine::AxisData { a_beschl: a, a_brems: a, tr_grenz: ramp, ..*axis };
                crate::machine::limits(&axis, machine.slope())
            };
            machine.axes.iter().map(weigh).collect::<Vec<Limits>>()
        };
        let line = |dynamics: u32, feed, x: f64| crate::program::Segment {
            n: 10 * (dynamics + 1),
            place: Default::default(),
            kind: Kind::Line,
            end: vec![x, 0.0, 0.0],
            feed,
            stop: false,
            smoothed: dynamics == 3,
            tolerance: Default::default(),
            dynamics,
        };
        let feed = Some(6000.0);
        let arc = Kind::Arc { plane: [0, 1], centre: [150.0, 25.0], clockwise: false };
        let segments = vec![
            line(0, feed, 50.0),
            line(1, feed, 100.0),
            line(2, None, 150.0),
            crate::program::Segment { kind: arc, ..line(3, feed, 150.0) },
            line(3, feed, 200.0),
        ];
        let dynamics: Vec<Vec<Limits>> = [100, 50, 25, 25].map(allowed).to_vec();
        let limits = dynamics[0].clone();
        (Machine::built_in(), Program { motions: 5, segments, dynamics, limits, ..Program::empty(&machine) })
    }

    const NOTHING: [usize; 0] = [];

    /// The monitor's result for a second difference (mm/s²) and a third difference (mm/s³) at the end of rows
    /// in blocks.
    fn said(rows: [(u32, bool); 4], accel: f64, jerk: f64) -> Vec<usize> {
        let (machine, program) = weighted();
        let mut monitor = Monitor::new(&machine, &program);
        for (block, curve) in rows {
            monitor.drives(block, curve);
        }
        monitor.look(0, 50, 10, &[0, lsb(accel * 1e-6), lsb(jerk * 1e-9)]);
        monitor.excess.iter().map(|excess| excess.order).collect()
    }

    /// 2000 mm/s² of the slope, 6000 in all; 2000 / 0.15 s and 2000 / 0.01 s of jerk; times the weight of the block.
    #[test]
    fn each_block_has_its_own_weights() {
        let inside = |block| [(block, false); 4];
        // The machine permits it, and block 0 does: block 1 has half of it.
        assert_eq!(said(inside(0), 1990.0, 13_300.0), NOTHING);
        assert_eq!(said(inside(1), 1990.0, 6600.0), [1]);
        assert_eq!(said(inside(1), 990.0, 13_300.0), [2]);
        assert_eq!(said(inside(1), 990.0, 6600.0), NOTHING);
        // Rapid motion has weights of its own.
        assert_eq!(said(inside(2), 1990.0, 13_300.0), NOTHING);
        assert_eq!(said(inside(2), 2010.0, 13_400.0), [1, 2]);
        // An arc has the contour's part, weighted.
        assert_eq!(said(inside(3), 5990.0, 49_900.0), NOTHING);
        assert_eq!(said(inside(3), 6010.0, 50_100.0), [1, 2]);
    }

    #[test]
    fn at_joints_the_larger_one_of_both_holds_and_at_curves_that_of_their_blocks() {
        // A difference looks at as many ticks as its order says.
        let joint = [(0, false), (1, false), (1, false), (1, false)];
        assert_eq!(said(joint, 990.0, 199_000.0), NOTHING);
        assert_eq!(said(joint, 1010.0, 201_000.0), [1, 2]);
        let joint = [(0, false), (0, false), (1, false), (1, false)];
        assert_eq!(said(joint, 5990.0, 199_000.0), NOTHING);
        // The limits of blocks that are two blocks away do not count.
        let later = [(1, false), (1, false), (1, false), (2, false)];
        assert_eq!(said(later, 5990.0, 201_000.0), [2]);
        assert_eq!(said(later, 5990.0, 199_000.0), NOTHING);
        // A curve in block 4 belongs to the arc in front of it as well: both have the weights of 25 %.
        let curve = [(4, true), (4, true), (4, true), (4, true)];
        assert_eq!(said(curve, 5990.0, 49_900.0), NOTHING);
        assert_eq!(said(curve, 6010.0, 50_100.0), [1, 2]);
        assert_eq!(said([(4, false); 4], 510.0, 3400.0), [1, 2]);
    }

    #[test]
    fn beside_the_path_other_limits_hold() {
        let machine = Machine::built_in();
        let mut program = Program::empty(&machine);
        let path = program.allowed(0, &machine);
        program.limits_beside[0] =
            vec![Limits { jerk: 2.0 * path.jerk, ..path }, Limits { jerk: f64::INFINITY, ..path }, path];
        let mut monitor = Monitor::new(&machine, &program);
        let mut seen = |tick, moving, mm| {
            monitor.beside(tick, moving);
            monitor.look(0, tick, 10, &[0, 0, lsb(mm)]);
            std::mem::take(&mut monitor.excess).len()
        };
        // 200 000 mm/s³ at 1 ms, and twice as much in the independent motion.
        assert_eq!((seen(1, 0, 3e-4), seen(2, 1, 3e-4), seen(6, 1, 3e-4), seen(7, 1, 5e-4)), (1, 0, 0, 1));
        // A difference covers rows from before.
        assert_eq!((seen(8, 0, 3e-4), seen(10, 0, 3e-4), seen(11, 0, 3e-4)), (0, 0, 1));
        // The second motion is one of STEP; it permits nothing to the third one.
        assert_eq!((seen(20, 1, 1.0), seen(30, 1, 1.0), seen(40, 0, 3e-4)), (0, 0, 0));
        assert_eq!((seen(50, 1, 3e-4), seen(53, 1, 1e-4)), (1, 0));
        // Two motions in one row.
        program_row(&machine);
    }

    /// An axis whose one motion ends in the row in which the next one begins.
    fn program_row(machine: &Machine) {
        let mut program = Program::empty(machine);
        let path = program.allowed(0, machine);
        program.limits_beside[0] = vec![Limits { jerk: f64::INFINITY, ..path }, path];
        let mut monitor = Monitor::new(machine, &program);
        for (tick, moving) in [(1, 1), (9, 0), (9, 1)] {
            monitor.beside(tick, moving);
        }
        monitor.look(0, 12, 10, &[0, 0, lsb(1.0)]);
        assert_eq!(monitor.excess.len(), 1);
    }
}
