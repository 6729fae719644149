//! Compares every row with the limits of the machine data: speed, acceleration and jerk of every axis.
//!
//! Beside rounding of set points a difference may exceed them by what the resolution of the path adds
//! (`resolution.rs`), and by nothing else.
//!
//! Jerk is left out where the machine data permit a step: at joints of blocks without P-CHAN-00009 or with
//! P-AXIS-00013, and in all of a program that switches the check of curves off (CHECK_JERK=0, P-CHAN-00110 =
//! 0). Joints where a step shows are counted.
use crate::diagnose::Diagnostic;
use crate::machine::{Limits, Machine};
use crate::program::Program;
use crate::resolution::Resolution;
use glidepath::machine::AxisKind;

/// What is compared.
const NAMES: [&str; 3] = ["speed", "acceleration", "jerk"];

/// Rows that a third difference covers.
const COVERED: u64 = 3;

/// Per order: the limit per second, and the largest difference in LSB of a position.
type Bounds = [(f64, i128); 3];

/// An axis: what it may do on the path, what in each of its motions beside it, and since when it is where.
#[derive(Clone, Debug)]
struct Compared {
    path: Bounds,
    beside: Vec<Bounds>,
    /// Its motions beside the path that have begun, and whether the last one goes on.
    begun: usize,
    is_beside: bool,
    /// What it might do before that.
    before: Bounds,
    /// The first row there.
    since: u64,
}

impl Compared {
    /// What it may do now.
    fn now(&self) -> Bounds {
        let motion = self.begun.checked_sub(1).filter(|_| self.is_beside);
        motion.and_then(|motion| self.beside.get(motion)).copied().unwrap_or(self.path)
    }

    /// What the differences up to a row may be; around a change, the larger one.
    fn bounds(&self, tick: u64) -> Bounds {
        let now = self.now();
        if tick >= self.since + COVERED {
            return now;
        }
        std::array::from_fn(|k| if self.before[k].1 > now[k].1 { self.before[k] } else { now[k] })
    }

    /// From the row with this number on it moves beside the path, or does not.
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

/// A step of acceleration at a joint that the machine data permit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Step {
    /// Index of the axis.
    pub axis: usize,
    /// N number of the block behind the joint.
    pub n: u32,
    /// mm/s² or °/s².
    pub size: f64,
}

/// The comparison.
#[derive(Debug, Default)]
pub struct Monitor {
    axes: Vec<Compared>,
    cycle_s: f64,
    /// Steps are permitted at joints.
    steps: bool,
    /// Jerk of curves is not limited.
    curves: bool,
    /// The last joint that a row came behind, and whether a step has shown there.
    joint: Option<(u64, bool)>,
    /// Sum of the third differences since that row, per axis: a step lies in two or three of them.
    sums: Vec<i128>,
    /// The first excess of each axis and order.
    pub excess: Vec<Excess>,
    /// Joints where a step has shown.
    pub stepped: u64,
    /// The largest of these steps.
    pub largest: Step,
}

const LSB_PER_MM: f64 = (1_u64 << 32) as f64;

impl Monitor {
    /// For a program on a machine.
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
            let path = bounds(program.allowed(k, machine), resolution.get(k).copied().unwrap_or_default());
            let beside = program.limits_beside.get(k).into_iter().flatten();
            let beside = beside.map(|allowed| bounds(*allowed, Resolution::default())).collect();
            Compared { path, beside, begun: 0, is_beside: false, before: path, since: 0 }
        });
        Self {
            axes: axes.collect(),
            cycle_s,
            steps: !machine.channel.corr_v_trans_jerk
                || machine.axes.iter().any(|axis| axis.a_trans_weight > 0),
            curves: program.free_curves,
            sums: vec![0; machine.axes.len()],
            ..Self::default()
        }
    }

    /// The row with this number is the first one behind a joint.
    pub fn passes(&mut self, tick: u64) {
        self.joint = Some((tick, false));
        self.sums.fill(0);
    }

    /// From the row with this number on these axes move beside the path, bit i for axis i. Between two
    /// motions of an axis, which may come in one row, it is to be asked as well.
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

    /// What to say about jerk that was not compared; nothing where all was.
    pub fn left_out(&self) -> Option<String> {
        if self.curves {
            return Some("jerk not compared: CHECK_JERK = 0".to_owned());
        }
        self.steps.then(|| "jerk not compared at joints: P-CHAN-00009 = 0 or P-AXIS-00013 given".to_owned())
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

/// Decimals that show an excess with two digits of its own: three at least, and no more than an f64 has.
fn digits(excess: f64) -> usize {
    (3..12).find(|&digits| excess * 10_f64.powi(digits) >= 10.0).unwrap_or(12) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn monitor(machine: &Machine) -> Monitor {
        Monitor::new(machine, &Program::empty(machine))
    }

    /// A difference of so many mm or mm/s² …, in LSB.
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
        // 200 000 mm/s³ at 1 ms, and beside the path twice as much.
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
