//! How long a feed hold takes, against the shortest stop on the path ahead. The measure needs the set points of a run
//! without commands and the machine data, so it can be checked on any program.
//!
//! Let `x(t)` be the set points of the run without commands, from the tick on at which a hold acts. A hold passes the same
//! points at the part `r` of their speed, from 1 down to 0. An axis then has the acceleration `x″·r² + x′·dr/dt`.
//!
//! 1. *By acceleration alone* the axes slow down as hard as they can at each place: `dr/dt` is the least number for which no
//!    axis exceeds its brake acceleration (with STEP that of its stage). That gives the time `T` and the distance `D` of the stop.
//! 2. *With jerk* (TRAPEZ, SIN2, HSC) the measure is the closed form of a stop on a line, [`Stop::with_jerk`], from the speed
//!    and acceleration at hand, with the deceleration `v / T` and the longest brake ramp of the axes that move. Its distance
//!    is scaled by `D / (v·T / 2)`. With STEP the measure is `T` and `D`.
//! 3. With jerk each axis has to come to rest from its own speed and acceleration, too: [`Stop::with_jerk`] with its own
//!    acceleration and its shortest ramp. Where that takes longer, as in the middle of a corner, it is the time of the
//!    measure, and the distance is longer by the same part.
//! 4. The ticks until the command acts come to both: [`REACTION`].
//!
//! On a line this is the closed form. Path distance is the one of the plan.
//!
//! In a curve the measure may ask for more than the axes permit: it does not count the jerk of the curve. So a hold that takes
//! more than 1.5 times the measure is also compared with the shortest stop that a search finds ([`crate::shortest`]).
use crate::cases::random::Random;
use crate::check;
use crate::every_tick::REACTION;
use crate::never_slower::{Case, TOLERANCES};
use crate::operate::{Act, Operated, operate_within};
use crate::properties::permitted;
use crate::reference::profile::Ramps;
use crate::reference::stop::Stop;
use glidepath::machine::MachineData;

/// Most ticks of a run without commands.
const LONGEST: usize = 60_000;

/// A ratio above that is counted.
pub const MOST: f64 = 1.5;

/// Ticks of rest that count as a standstill.
const STANDS: usize = 3;

/// A hold: how long it took, and the measure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Held {
    /// The tick of the command.
    pub tick: usize,
    /// As it was, s and mm.
    pub seen: Stop,
    /// The measure.
    pub wanted: Stop,
    /// Where it takes more than [`MOST`] times the measure: the shortest stop that a search finds ([`crate::shortest`]).
    pub found: Option<Stop>,
    /// Seconds per tick.
    pub cycle: f64,
}

impl Held {
    /// Time and distance over the measure. A tick and 10 µm are not counted.
    pub fn ratios(&self) -> [f64; 2] {
        self.against(&self.wanted)
    }

    /// Whether it takes more than [`MOST`] times the measure.
    pub fn is_long(&self) -> bool {
        self.ratios().into_iter().any(|ratio| ratio > MOST)
    }

    /// Whether it takes more than [`MOST`] times the measure and the shortest stop that the search finds. A stop that the
    /// search does not find does not count.
    pub fn is_longer_than_found(&self) -> bool {
        let [time, way] = self.ratios();
        let [found_time, found_way] = self.found.map_or([0.0; 2], |found| self.against(&found));
        time.min(found_time) > MOST || way.min(found_way) > MOST
    }

    fn against(&self, other: &Stop) -> [f64; 2] {
        let ratio = |seen: f64, wanted: f64, free: f64| (seen - free).max(0.0) / wanted.max(free);
        [ratio(self.seen.time, other.time, self.cycle), ratio(self.seen.way, other.way, 0.01)]
    }
}

/// A run without commands.
pub struct Track<'a> {
    run: Operated,
    machine: &'a MachineData<3>,
    cycle: f64,
}

impl<'a> Track<'a> {
    /// Of a run on a machine.
    pub fn new(run: Operated, machine: &'a MachineData<3>) -> Self {
        Self { run, machine, cycle: f64::from(machine.channel.cycle_us) * 1e-6 }
    }

    /// Ticks.
    pub fn ticks(&self) -> usize {
        self.run.distances.len()
    }

    /// Path distance of a row, mm.
    fn s(&self, row: usize) -> f64 {
        self.run.distances[row.min(self.ticks() - 1)] as f64 / 2.0_f64.powi(44)
    }

    fn x(&self, axis: usize, row: usize) -> f64 {
        let column = &self.run.trace.columns[axis];
        column[row.min(column.len() - 1)] as f64 / 2.0_f64.powi(32)
    }

    /// The least `dr/dt` at a row where the part of the speed is `√w`, per second; nothing where no axis moves.
    fn steepest(&self, row: usize, w: f64) -> Option<f64> {
        let mut least: Option<f64> = None;
        for (axis, data) in self.machine.axes.iter().enumerate() {
            let [before, at, behind] = [row.saturating_sub(1), row, row + 1].map(|row| self.x(axis, row));
            let slope = (behind - at) / self.cycle;
            if (behind - at).abs() < 1e-8 {
                continue;
            }
            let bend = (behind - 2.0 * at + before) / self.cycle.powi(2);
            let most = if self.machine.channel.slope_profile == 0 {
                let stages = data.stages(false);
                let is_fast = slope.abs() * w.sqrt() > f64::from(stages.change_over) * 1e-3;
                stages.d[usize::from(is_fast)]
            } else {
                data.a_brems
            };
            let most = f64::from(most);
            let bound = (-most * slope.signum() - bend * w) / slope;
            least = Some(least.map_or(bound, |least| least.max(bound)));
        }
        least.map(|least| least.min(0.0))
    }

    /// The stop by acceleration alone from a row on, and the longest brake ramp of the axes that move, s.
    fn by_acceleration(&self, first: usize) -> (Stop, f64) {
        let (mut stop, mut w, mut ramp) = (Stop::default(), 1.0_f64, 0.0_f64);
        for row in first..self.ticks() - 1 {
            let Some(slope) = self.steepest(row, w) else { break };
            for (axis, data) in self.machine.axes.iter().enumerate() {
                if (self.x(axis, row + 1) - self.x(axis, row)).abs() > 1e-8 {
                    ramp = ramp.max(f64::from(data.tr_brems_zu.max(data.tr_brems_ab)) * 1e-6);
                }
            }
            let (r, step) = (w.sqrt(), self.s(row + 1) - self.s(row));
            let next = w + 2.0 * slope * self.cycle;
            if next <= 0.0 {
                stop.time += r / -slope;
                stop.way += step * w / (w - next);
                break;
            }
            stop.time += 2.0 * self.cycle / (r + next.sqrt());
            stop.way += step;
            w = next;
        }
        (stop, ramp)
    }

    /// The time that the slowest axis alone takes to a standstill, s.
    fn of_axes(&self, row: usize) -> f64 {
        let mut longest = 0.0_f64;
        for (axis, data) in self.machine.axes.iter().enumerate() {
            let [before, at, behind] = [row - 1, row, row + 1].map(|row| self.x(axis, row));
            let v = (behind - at) / self.cycle;
            let a = (behind - 2.0 * at + before) / self.cycle.powi(2) * v.signum();
            let geometric = if data.tr_geom == 0 { data.tr_min } else { data.tr_geom };
            let ramps = [data.tr_beschl_ab, data.tr_brems_zu, data.tr_brems_ab];
            let shortest = f64::from(ramps.into_iter().fold(geometric, u32::min)) * 1e-6;
            let most = f64::from(data.a_max);
            let ramps = Ramps { a: most, up: shortest, down: shortest };
            longest = longest.max(Stop::with_jerk(v.abs(), a.clamp(-most, most), ramps, ramps).time);
        }
        longest
    }

    /// Time and distance of the shortest stop that a search along the path finds for a hold before tick `at`.
    pub fn shortest(&self, at: usize) -> Option<Stop> {
        let before = at.checked_sub(1)?;
        let acts = before + REACTION;
        let measure = self.measure(at)?;
        let limits: Vec<_> = self
            .machine
            .axes
            .iter()
            .map(|axis| permitted(axis, self.machine.channel.slope_profile, false, true, true))
            .collect();
        let c = self.cycle;
        let last = self.ticks() - 2;
        let places: Vec<_> = (acts..last.min(acts + 20_000))
            .map(|row| {
                (0..3)
                    .map(|axis| {
                        let [w, x, y, z] = [row - 1, row, row + 1, row + 2].map(|row| self.x(axis, row));
                        [
                            (y - w) / (2.0 * c),
                            (y - 2.0 * x + w) / c.powi(2),
                            (z - 3.0 * y + 3.0 * x - w) / c.powi(3),
                        ]
                    })
                    .collect()
            })
            .collect();
        let path = crate::shortest::Path { places: &places, limits: &limits, cycle: c };
        let acted = (acts - before) as f64 * c;
        let [time, ticks] = path.shortest(measure.time - acted)?;
        let whole = ticks.floor();
        let row = acts + whole as usize;
        let s = self.s(row) + (ticks - whole) * (self.s(row + 1) - self.s(row));
        Some(Stop { time: time + acted, way: s - self.s(before) })
    }

    /// The measure for a hold before tick `at`, if anything moves when it acts.
    pub fn measure(&self, at: usize) -> Option<Stop> {
        let before = at.checked_sub(1)?;
        let acts = before + REACTION;
        if acts + 2 >= self.ticks() {
            return None;
        }
        let [s0, s1, s2] = [acts - 1, acts, acts + 1].map(|row| self.s(row));
        let v = (s2 - s1) / self.cycle;
        let a = (s2 - 2.0 * s1 + s0) / self.cycle.powi(2);
        let (free, ramp) = self.by_acceleration(acts);
        if v <= 0.0 || free.time <= 0.0 || free.way <= 0.0 {
            return None;
        }
        let stop = if self.machine.channel.slope_profile == 0 {
            free
        } else {
            let ramps = Ramps { a: v / free.time, up: ramp, down: ramp };
            let stop = Stop::with_jerk(v, a, ramps, ramps);
            let time = self.of_axes(acts).max(stop.time);
            Stop { time, way: stop.way * free.way / (0.5 * v * free.time) * time / stop.time }
        };
        let acted = (acts - before) as f64 * self.cycle;
        Some(Stop { time: stop.time + acted, way: stop.way + s1 - self.s(before) })
    }
}

/// What came of a program with a slope and a method.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Its holds.
    pub holds: Vec<Held>,
    /// Axes above a limit, and holds without a standstill.
    pub faults: Vec<String>,
}

/// The program of a seed with a slope and a method, with one tolerance, and with `count` holds at random ticks.
///
/// # Errors
/// As [`holds`].
pub fn of_seed(seed: u64, (slope, method): (usize, usize), count: u64) -> Result<Outcome, String> {
    let mut random = Random::new(seed ^ 0x686f_6c64 ^ (slope as u64) << 40 ^ (method as u64) << 48);
    let parts: Vec<f64> = (0..count).map(|_| random.unit()).collect();
    let tolerance = TOLERANCES[(random.bits() % 3) as usize];
    holds(&Case::new(seed), (slope, method), tolerance, &parts)
}

/// Runs a program with a slope and a method, then again with a hold at each of some ticks (parts of its time).
///
/// # Errors
/// The library refuses it, or it takes too long.
pub fn holds(
    case: &Case,
    (slope, method): (usize, usize),
    tolerance: f64,
    parts: &[f64],
) -> Result<Outcome, String> {
    let (machine, text) = (case.machine(slope), case.program(slope, method, tolerance));
    let start = case.start();
    let run = |acts: &[(usize, Act)]| operate_within::<3, 120>(&text, start, &machine, (acts, 1000), LONGEST);
    let limits: Vec<_> = machine
        .axes
        .iter()
        .map(|axis| permitted(axis, machine.channel.slope_profile, false, true, true))
        .collect();
    let track = Track::new(run(&[])?, &machine);
    let mut outcome = Outcome::default();
    for part in parts {
        let at = 1 + (part * track.ticks() as f64) as usize;
        let Some(wanted) = track.measure(at) else { continue };
        // An abort behind the standstill ends the run.
        let patience = 300 + (20.0 * wanted.time / track.cycle) as usize;
        let held = run(&[(at, Act::Hold), (at + patience, Act::Abort)])?;
        if let Err(fault) = check::limits(&held.trace, &limits) {
            outcome.faults.push(format!("hold at {at}: {fault}"));
        }
        let stands = |row: usize| {
            (1..=STANDS).all(|k| held.distances.get(row + k).is_none_or(|s| *s == held.distances[row]))
        };
        let Some(stood) = (at..held.distances.len()).find(|row| stands(*row)) else { continue };
        if stood >= at + patience {
            outcome.faults.push(format!("hold at {at}: does not stand in {patience} ticks"));
        }
        let way = (held.distances[stood] - held.distances[at - 1]) as f64 / 2.0_f64.powi(44);
        let seen = Stop { time: (stood + 1 - at) as f64 * track.cycle, way };
        let mut held = Held { tick: at, seen, wanted, found: None, cycle: track.cycle };
        if held.is_long() {
            held.found = track.shortest(at);
        }
        outcome.holds.push(held);
    }
    Ok(outcome)
}
