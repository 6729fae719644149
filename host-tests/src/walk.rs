//! Random paths of lines and arcs through every smoothing method. A checker that knows only the programmed
//! contour checks tolerance, limits and exact ends.
use crate::cases::machines;
use crate::cases::random::Random;
use crate::check::{self, Limits};
use crate::deviation::follows;
use crate::trace::run_text;
use glidepath::machine::{AxisKind, MachineData, Synch, SynchTable};
use glidepath::quantity::Position;

/// Three axes of 2000 mm/s² and 1000 mm/s with these ramps (µs), the fourth a rotary one of 4000 degrees/s².
pub fn machine<const AXES: usize>(ramp: u32, slope: u8) -> MachineData<AXES> {
    let mut machine = machines::even::<AXES>(1000);
    for (k, axis) in machine.axes.iter_mut().enumerate() {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        axis.a_max = 2000;
        machines::accelerations(axis, 2000, 2000);
        machines::ramps(axis, ramp);
        axis.tr_geom = ramp;
        if k == 3 {
            axis.kind = AxisKind::Rotary;
        }
    }
    machine.channel.slope_profile = slope;
    machine.channel.surface = true;
    machine.channel.corr_v_trans_jerk = true;
    machine.channel.m_synch = SynchTable::NONE.with(25, Synch::Mos);
    machine
}

/// SIN2 has the jerk of its steepest place.
pub fn limits<const AXES: usize>(ramp: u32, slope: u8) -> [Limits; AXES] {
    let steep = if slope == 2 { std::f64::consts::FRAC_PI_2 } else { 1.0 };
    [Limits { v: 1000.0, a: 2000.0, jerk: steep * 2000.0 / (f64::from(ramp) * 1e-6) }; AXES]
}

/// A program of corners with its contour.
pub struct Walk {
    pub text: String,
    points: Vec<Vec<f64>>,
    /// Places that must be met exactly.
    exact: Vec<Vec<f64>>,
}

/// Places are multiples of this.
const STEP: f64 = 1e-6;

/// The smoothing method: the commands before and after the path, for a seed, PATH_DEV and TRACK_DEV.
pub type Smoothed = fn(u64, [f64; 2]) -> [String; 2];

/// Lines and arcs with corners of any angle, lengths of 1 µm to 100 mm, reversals, other feeds and functions.
pub fn walk(seed: u64, axes: usize, blocks: usize, [on, off]: &[String; 2]) -> Walk {
    let mut r = Random::new(seed);
    let mut text = format!("{on}\nG01 F6000\n");
    let mut at = vec![0.0; axes];
    let (mut points, mut exact) = (vec![at.clone()], vec![]);
    let mut heading = r.between(-180.0, 180.0);
    let gentle = r.between(1.0, 60.0);
    let least = r.magnitude(0.001, 1.0);
    let most = least * r.magnitude(2.0, 100.0);
    for n in 1..=blocks {
        let knee = if r.once_in(8) { 180.0 } else { gentle };
        heading += if r.once_in(40) { 180.0 } else { r.between(-knee, knee) };
        let (sin, cos) = heading.to_radians().sin_cos();
        let length = r.magnitude(least, most).min(100.0);
        let from = at.clone();
        for (k, d) in [cos, sin, r.between(-0.3, 0.3)].into_iter().enumerate() {
            at[k] = ((at[k] + length * d) / STEP).round() * STEP;
        }
        if axes > 3 && !r.once_in(4) {
            at[3] = ((at[3] + r.between(-1.0, 1.0) * length.min(10.0)) / STEP).round() * STEP;
        }
        if r.once_in(9) {
            text += &format!("F{}\n", r.between(500.0, 20_000.0).round());
        }
        let names = ["X", "Y", "Z", "A"];
        let words: String = names.iter().zip(&at).map(|(name, x)| format!(" {name}{x:.6}")).collect();
        let stop = r.once_in(25);
        let line = if stop { "G60" } else { "" };
        if r.once_in(6) && length > 0.05 {
            // By a radius: between once and thrice half the chord.
            let half = 0.5 * (at[0] - from[0]).hypot(at[1] - from[1]);
            let radius = (half * r.between(1.01, 3.0) / STEP).ceil() * STEP;
            text += &format!("N{n} {line} G02{words} R{radius:.6}\nG01\n");
            points.extend(arc(&from, &at, radius));
        } else {
            text += &format!("N{n} {line}{words}\n");
        }
        points.push(at.clone());
        if stop {
            exact.push(at.clone());
        }
        if r.once_in(20) {
            text += "M25\n";
        }
    }
    text += &format!("{off}\nM30\n");
    exact.push(at);
    Walk { text, points, exact }
}

/// Points of a clockwise arc of less than 180 degrees in X and Y.
fn arc(from: &[f64], to: &[f64], radius: f64) -> Vec<Vec<f64>> {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let chord = dx.hypot(dy);
    let height = (radius * radius - 0.25 * chord * chord).max(0.0).sqrt();
    let centre = [from[0] + 0.5 * dx + height * dy / chord, from[1] + 0.5 * dy - height * dx / chord];
    let begin = (from[1] - centre[1]).atan2(from[0] - centre[0]);
    let sweep = 2.0 * (0.5 * chord / radius).min(1.0).asin();
    // Points within a tenth of a micrometre of the arc.
    let count = (sweep * (radius / 8e-4).sqrt()).ceil().max(4.0);
    (1..count as u32)
        .map(|k| {
            let part = f64::from(k) / count;
            let angle = begin - part * sweep;
            let mut point: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + (b - a) * part).collect();
            point[0] = centre[0] + radius * angle.cos();
            point[1] = centre[1] + radius * angle.sin();
            point
        })
        .collect()
}

/// Permitted deviation for the chord of a tick and the points of an arc, mm.
const SAMPLED: f64 = 5e-4;

/// Runs a path with this number of blocks, ramps in µs, and a slope, on [`machine`] with changed parameters.
///
/// # Errors
/// The exceeded limit, the wrong end, or the place outside the tolerance.
pub fn judge<const AXES: usize>(
    seed: u64,
    blocks: usize,
    (ramp, slope): (u32, u8),
    smoothed: Smoothed,
    set: impl Fn(&mut MachineData<AXES>),
) -> Result<(), String> {
    let mut r = Random::new(seed ^ 0x5eed);
    let (dev, track) = (r.magnitude(0.001, 0.3), r.magnitude(0.01, 2.0));
    let walk = walk(seed, AXES, blocks, &smoothed(seed, [dev, track]));
    let mut machine = machine(ramp, slope);
    set(&mut machine);
    let start = [Position::ZERO; AXES];
    let run = run_text::<AXES, 120>(&walk.text, start, &machine, 1)?;
    if slope != 0 {
        check::limits(&run.trace, &limits::<AXES>(ramp, slope))?;
    }
    let bits = |point: &[f64]| -> Vec<i64> {
        point.iter().map(|x| ((x / STEP).round() * STEP * (1u64 << 32) as f64).round() as i64).collect()
    };
    // Decimals are rounded once, so positions that differ by one bit are equal.
    let near = |row: usize, point: &[i64]| run.trace.row(row).zip(point).all(|(a, b)| (a - b).abs() <= 1);
    let mut from = 0;
    for point in walk.exact.iter().map(|point| bits(point)) {
        let found = (from..run.trace.len()).find(|row| near(*row, &point));
        from = found.ok_or_else(|| format!("{point:?} is not met"))?;
    }
    if !near(run.trace.len() - 1, &bits(walk.exact.last().expect("an end"))) {
        return Err("does not end at its end".into());
    }
    let path: Vec<_> = (0..run.trace.len()).map(|row| run.trace.mm(row)).collect();
    if !follows(&path, &walk.points, [dev + SAMPLED, track + SAMPLED]) {
        return Err(format!("not within {dev} mm, {track} degrees"));
    }
    Ok(())
}
