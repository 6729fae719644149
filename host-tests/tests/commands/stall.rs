//! A planner that gets no processor time: the motion slows down inside all limits before the queue runs out,
//! stops on its path, resumes when the planner is called again, and loses nothing. A stall shorter than the
//! queue has no effect.
use glidepath::channel::{Channel, Handles};
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use glidepath::tick::State;
use host_tests::calls::call;
use host_tests::cases::random::Random;
use host_tests::cases::{Program, machines, named};
use host_tests::check;
use host_tests::operate::{
    Act, Operated, POLLS, judge, may_end, operate, operate_text, random_acts, random_setup, with_overrides,
    with_stalls,
};
use host_tests::properties::permitted;
use host_tests::trace::Trace;
use std::collections::BTreeMap;
use std::ops::Range;

/// The slopes, as `#SLOPE` names them, with their numbers in P-CHAN-00071.
const SLOPES: [(u8, &str); 5] = [(0, "STEP"), (1, "TRAPEZ"), (2, "SIN2"), (3, "HSC"), (3, "HSC NO_OPT=0")];

/// Ticks in which every queue of these programs runs out, and the motion comes to rest.
const LONG: usize = 20_000;

/// Part of it at the end of which the motion stands.
const AT_REST: usize = 600;

/// Ticks in which some queues run out, and some do not.
const SHORT: [usize; 5] = [1, 5, 20, 60, 200];

/// A planner that keeps up: called until it has nothing to do.
const KEEPS_UP: usize = 1_000_000;

/// A planner that is called so many ticks before a plan begins to differ is not late. The way to a standstill
/// begins as planned: with the rest of a ramp, with blocks too short to stop in.
const AHEAD: usize = 160;

/// A law ends between two ticks, and the tick that shows its end comes from the planner: 4 µm, LSB 2^-44 mm.
const NEAR_REST: i64 = 1 << 36;

/// Ticks within which the motion goes on once the planner is called again.
const REACTION: usize = 8;

/// A program, what an undisturbed planner makes of it, and its path.
struct Track {
    name: String,
    text: String,
    machine: MachineData<3>,
    limits: Vec<check::Limits>,
    /// If the judge knows the contour.
    program: Option<Program>,
    plain: Operated,
    /// So slow that its set points show the path.
    scan: Operated,
}

/// Programs whose contour the judge knows, longer than queue and look-ahead.
fn programs() -> Vec<Program> {
    let mut long = Program::new("long lines", 3);
    let mut polygon = Program::new("polygon", 3);
    let mut arcs = Program::new("arcs", 3);
    for k in 1..=100 {
        let far = f64::from(k);
        // One corner in eight is sharp.
        let y = if k % 8 == 0 { 9.0 } else { f64::from(k % 3) * 0.2 };
        long = long.line(&[20.0 * far, y, f64::from(k % 2) * 0.1], 12_000.0);
        let (ends, up) = ([0.0, 15.0][k as usize % 2], f64::from(k) * 6.0);
        arcs = arcs.line(&[ends, up - 6.0, 0.0], 8000.0 + 100.0 * far);
        arcs = arcs.arc(&[ends, up, 0.0], [0.0, 3.0], k % 2 == 0, 8000.0 + 100.0 * far);
    }
    for k in 1..=300 {
        let turn = f64::from(k) * 0.15;
        let feed = [9000.0, 4000.0, 6000.0][k as usize / 7 % 3];
        polygon = polygon.line(&[12.0 * turn.sin() + 0.3 * f64::from(k), 12.0 - 12.0 * turn.cos()], feed);
    }
    vec![long, polygon, arcs, named::wave(500, 0.05, 3000.0)]
}

/// The same with contour mode, functions, dwell and exact stops.
fn texts() -> Vec<(&'static str, String)> {
    let polygon = |mode: &str| {
        let mut text = format!("#CONTOUR MODE [{mode}]\nG01 X1 G261 F9000\n");
        for k in 1..200 {
            let y = [0.0, 1.5, 0.3, 2.4, 0.9][k % 5];
            text += &format!("N{} X{} Y{y}\n", 10 * k, 1 + 3 * k);
        }
        text + "G260 X640\nM30\n"
    };
    let mut stops = String::from("H1\n");
    for k in 1..120 {
        stops += &format!("N{} G01 X{} Y{} F9000", 10 * k, 5 * k, k % 3);
        stops += match k % 6 {
            1 => "\nM7\n",
            2 => "\nG04 X0.12\nM8\n",
            3 => " M9 H4\n",
            4 => " G60\n",
            _ => "\n",
        };
    }
    vec![
        ("polygon, DEV", polygon("DEV PATH_DEV=0.05")),
        ("polygon, DIST_SOFT", polygon("DIST_SOFT PATH_DIST=0.6")),
        ("polygon, PTP", polygon("PTP PATH_DEV=0.05")),
        ("stops", stops + "M30\n"),
    ]
}

/// All of them with a slope.
fn tracks(slope: (u8, &str)) -> Vec<Track> {
    let mut tracks = Vec::new();
    for mut program in programs() {
        program.optimised = slope.1.ends_with('0');
        tracks.push(Track::new(&program.name.clone(), slope, None, Some(program)));
    }
    for (name, text) in texts() {
        let text = format!("%t\n#SLOPE [TYPE={}]\n{text}", slope.1);
        tracks.push(Track::new(name, slope, Some(text), None));
    }
    tracks
}

impl Track {
    fn new(name: &str, (slope, word): (u8, &str), text: Option<String>, program: Option<Program>) -> Self {
        let mut machine = machines::with_slope(machines::mill::<3>(1000), slope);
        machine.channel.look_ahead = 30;
        machine.channel.ptp = true;
        let text =
            text.or_else(|| program.as_ref().map(|program| program.text(&machine))).expect("one of both");
        let limits = machine.axes.iter().map(|axis| permitted(axis, slope, false, true, true)).collect();
        let go = |acts: &[(usize, Act)]| {
            operate_text::<3, 120>(&text, [Position::ZERO; 3], &machine, acts, KEEPS_UP)
                .unwrap_or_else(|fault| panic!("{name}, {word}: {fault}\n{text}"))
        };
        let (plain, scan) = (go(&[]), go(&[(0, Act::Override(50))]));
        let track = Self { name: format!("{name}, {word}"), text, machine, limits, program, plain, scan };
        track.verify(&track.plain).unwrap_or_else(|fault| panic!("{}: {fault}", track.name));
        assert!(track.plain.late.is_empty());
        track
    }

    fn ticks(&self) -> usize {
        self.plain.distances.len()
    }

    fn run(&self, acts: &[(usize, Act)]) -> Operated {
        operate_text::<3, 120>(&self.text, [Position::ZERO; 3], &self.machine, acts, KEEPS_UP)
            .unwrap_or_else(|fault| panic!("{}, {acts:?}: {fault}", self.name))
    }

    /// Limits, path, order, end and functions.
    fn verify(&self, run: &Operated) -> Result<(), String> {
        check::limits(&run.trace, &self.limits)?;
        if let Some(program) = &self.program {
            judge(program, &self.machine, run)?;
        }
        if let Some(tick) = run.distances.windows(2).position(|w| w[1] < w[0]) {
            return Err(format!("goes back at tick {tick}"));
        }
        for tick in 0..run.distances.len() {
            self.on_path(run, tick)?;
        }
        let last = |of: &Operated| {
            (of.distances.last().copied(), of.trace.row(of.trace.len() - 1).collect::<Vec<_>>())
        };
        if last(run) != last(&self.plain) {
            return Err(format!("ends at {:?}, not at {:?}", last(run), last(&self.plain)));
        }
        self.functions(run)
    }

    /// The set point of a path distance is between those of the scan on both sides, no further off than these
    /// are apart.
    fn on_path(&self, run: &Operated, tick: usize) -> Result<(), String> {
        let (at, seen) = (run.distances[tick], run.trace.mm(tick));
        let scan = &self.scan;
        let next = scan.distances.partition_point(|s| *s < at).min(scan.distances.len() - 1);
        let [from, to] = [scan.distances[next.saturating_sub(1)], scan.distances[next]];
        let part = if to > from { (at - from) as f64 / (to - from) as f64 } else { 1.0 };
        let [a, b] = [scan.trace.mm(next.saturating_sub(1)), scan.trace.mm(next)];
        let distance =
            |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(p, q)| (p - q).powi(2)).sum::<f64>().sqrt();
        let expected: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a + (b - a) * part).collect();
        let (off, apart) = (distance(&seen, &expected), (to - from) as f64 / 2.0_f64.powi(44));
        if off > apart + 1e-6 {
            return Err(format!("tick {tick}: {seen:?} is {off} mm off, {apart} at most"));
        }
        Ok(())
    }

    /// The same ones in the same order, each at its place.
    fn functions(&self, run: &Operated) -> Result<(), String> {
        let all = |of: &Operated| of.outputs.iter().map(|(_, o)| (o.n, o.function)).collect::<Vec<_>>();
        if all(run) != all(&self.plain) {
            return Err(format!("{:?} instead of {:?}", all(run), all(&self.plain)));
        }
        for ((tick, output), (plain, _)) in run.outputs.iter().zip(&self.plain.outputs) {
            let [seen, expected] = [places(run, *tick), places(&self.plain, *plain)];
            if seen.start.max(expected.start) >= seen.end.min(expected.end) {
                return Err(format!("tick {tick}: {output:?} in {seen:?}, not in {expected:?}"));
            }
        }
        Ok(())
    }

    /// Path distances at which the undisturbed motion rests or passes a standstill, the end too.
    fn rests(&self) -> Vec<i64> {
        let s = &self.plain.distances;
        // As far as a tick gets from rest: with STEP half of 6 m/s² times 1 ms squared, otherwise far less.
        // LSB 2^-44 mm.
        let step = if self.machine.channel.slope_profile == 0 { 1 << 36 } else { 1 << 31 };
        let rests = s.windows(2).filter(|w| w[1] - w[0] < step).map(|w| w[0]);
        rests.chain([0]).chain(s.last().copied()).collect()
    }

    /// The first tick at which a run is another than the undisturbed one.
    fn differs(&self, run: &Operated) -> Option<usize> {
        let rows = self.ticks().max(run.trace.len());
        let row = |of: &Operated, tick: usize| of.trace.row(tick.min(of.trace.len() - 1)).collect::<Vec<_>>();
        (0..rows).find(|&tick| row(run, tick) != row(&self.plain, tick))
    }

    /// Standstills that nobody has planned: their ticks.
    fn stands(&self, run: &Operated) -> Vec<Range<usize>> {
        let (s, rests) = (&run.distances, self.rests());
        let mut stands: Vec<Range<usize>> = Vec::new();
        for tick in 1..s.len() {
            let planned = rests.iter().any(|rest| (s[tick] - rest).abs() < NEAR_REST);
            if s[tick] != s[tick - 1] || planned {
                continue;
            }
            match stands.last_mut() {
                Some(last) if last.end == tick => last.end += 1,
                _ => stands.push(tick..tick + 1),
            }
        }
        stands
    }

    /// What has to be true of a run with a stall of so many ticks from tick `at` on.
    fn stalled(&self, run: &Operated, at: usize, ticks: usize) -> Result<(), String> {
        self.verify(run)?;
        let again = at + ticks;
        let stands = self.stands(run);
        let said = &run.late;
        if stands.len() > 1 || said.len() > 1 || (self.differs(run).is_none() && !said.is_empty()) {
            return Err(format!("says that it stands: stands at {stands:?}, says so at {said:?}"));
        }
        if let Some(stand) = stands.first() {
            if said.len() != 1 || !(again..=stand.end.max(again)).contains(&said[0]) {
                return Err(format!("says that it stands: stands at {stand:?}, says so at {said:?}"));
            }
            if stand.end > again.max(stand.start) + REACTION {
                return Err(format!("goes on: stands at {stand:?}, with a planner from {again} on"));
            }
        }
        Ok(())
    }

    /// A stall in which the queue runs out, and shorter ones from the same tick on. Whether it was felt.
    fn at(&self, at: usize, short: &[usize], faults: &mut Faults) -> bool {
        let long = self.run(&[(at, Act::Stall(LONG))]);
        let felt = self.differs(&long);
        let end = &long.distances[at + LONG - AT_REST..at + LONG];
        if end.iter().any(|s| *s != end[0]) {
            faults.add(self, at, LONG, "stands: moves all of the time");
        }
        if let Err(fault) = self.stalled(&long, at, LONG) {
            faults.add(self, at, LONG, &fault);
        }
        for &ticks in short {
            let run = self.run(&[(at, Act::Stall(ticks))]);
            if let Err(fault) = self.stalled(&run, at, ticks) {
                faults.add(self, at, ticks, &fault);
            }
            if felt.is_none_or(|felt| at + ticks + AHEAD <= felt)
                && let Some(seen) = self.differs(&run)
            {
                faults.add(self, at, ticks, &format!("not felt: at {seen}, a long one at {felt:?}"));
            }
        }
        felt.is_some()
    }
}

/// What went wrong, by kind: how often, and the first of them.
#[derive(Default)]
struct Faults(BTreeMap<String, (usize, String)>);

impl Faults {
    fn add(&mut self, track: &Track, at: usize, ticks: usize, fault: &str) {
        let long = if ticks >= LONG { "long" } else { "short" };
        let kind = fault.split(':').take(2).collect::<Vec<_>>().join(":");
        let kind = kind.split(|c: char| c.is_ascii_digit()).next().unwrap_or("").to_owned();
        let kind = format!("{}, {long}: {kind}", track.name);
        let first = format!("tick {at}, stall of {ticks}: {fault}");
        self.0.entry(kind).or_insert((0, first)).0 += 1;
    }

    fn none(&self, tried: usize) {
        let list = self.0.iter().map(|(kind, (count, first))| format!("{count} {kind} ({first})\n"));
        let list: String = list.collect();
        assert!(list.is_empty(), "of {tried} stalls\n{list}");
    }
}

/// Path distances of which a tick passes or reaches the last one.
fn places(run: &Operated, tick: usize) -> Range<i64> {
    let at = run.distances[tick];
    let before = tick.checked_sub(1).map_or(-1, |before| run.distances[before]);
    before.min(at - 1) + 1..at + 1
}

/// Ticks at which a program is stalled.
const TICKS: usize = 8;

fn all(slope: usize) {
    let mut faults = Faults::default();
    let (mut tried, mut random) = (0, Random::new(slope as u64));
    for track in tracks(SLOPES[slope]) {
        let mut felt = 0;
        for k in 0..TICKS {
            let at = (track.ticks() as f64 * (k as f64 + random.unit()) / TICKS as f64) as usize;
            felt += usize::from(track.at(at, &SHORT, &mut faults));
            tried += 1 + SHORT.len();
        }
        assert!(felt >= TICKS / 3, "{}: {felt} of {TICKS}", track.name);
        println!("{}: {} ticks, {felt} of {TICKS} felt", track.name, track.ticks());
    }
    faults.none(tried);
}

/// What an operator does about a stall of so many ticks from tick `at` on, and whether nothing of it makes
/// the motion stand.
fn operations(at: usize, ticks: usize) -> Vec<(Vec<(usize, Act)>, bool)> {
    use Act::{Hold, Override, Resume};
    let (before, stall, behind) = (at - 100, (at, Act::Stall(ticks)), at + ticks + 100);
    let last = behind + 300;
    vec![
        (vec![(before, Override(600)), stall, (behind, Override(1000))], true),
        (vec![(before, Override(1500)), stall, (behind, Override(700)), (last, Override(1000))], true),
        (vec![(before, Override(600)), (before + 50, Override(1000)), stall, (behind, Override(900))], true),
        (vec![stall, (at + ticks / 2, Override(500)), (behind, Override(1000))], true),
        (vec![(before, Hold), stall, (behind, Resume)], false),
        (vec![(before, Hold), (before + 60, Resume), stall, (behind, Hold), (last, Resume)], false),
        (vec![stall, (at + ticks / 2, Hold), (behind, Resume)], false),
        (vec![stall, (behind, Hold), (last, Resume)], false),
    ]
}

/// With hold, resume and override some 100 ticks before and behind it, and meanwhile.
#[test]
fn stalls_while_an_operator_acts() {
    let mut faults = Faults::default();
    let (mut tried, mut random) = (0, Random::new(7));
    for track in SLOPES.into_iter().flat_map(tracks) {
        for (ticks, which) in [2 * LONG, 400].into_iter().flat_map(|ticks| (0..8).map(move |k| (ticks, k))) {
            let at = 101 + (random.unit() * (track.ticks() - 101) as f64) as usize;
            let (acts, runs) = &operations(at, ticks)[which];
            let run = track.run(acts);
            let mut verdict = track.verify(&run);
            let end = &run.distances[(at + ticks - 1).saturating_sub(AT_REST)..at + ticks];
            if ticks > LONG && end.iter().any(|s| *s != end[0]) {
                verdict = Err("stands: moves all of the time".to_owned());
            }
            let stands = track.stands(&run);
            // Where it would stand anyway it may be said too.
            if verdict.is_ok() && (run.late.len() > 1 || (*runs && run.late.len() < stands.len())) {
                verdict =
                    Err(format!("says that it stands: stands at {stands:?}, says so at {:?}", run.late));
            }
            if let Err(fault) = verdict {
                faults.add(&track, at, ticks, &format!("{fault} {acts:?}"));
            }
            tried += 1;
        }
    }
    faults.none(tried);
}

/// A knee, an arc, short blocks, an exact stop: stalled long and short before every 41st tick; before every
/// one with the variable EVERY_TICK, in minutes. All ticks of other programs: `every_tick.rs`.
#[test]
fn a_stall_before_every_41st_tick() {
    let stride = if std::env::var_os("EVERY_TICK").is_some() { 1 } else { 41 };
    let mut faults = Faults::default();
    let mut tried = 0;
    for slope in SLOPES {
        let mut program = Program::new("track", 3)
            .line(&[6.0, 0.0, 0.0], 9000.0)
            .line(&[12.0, 0.4, 0.0], 9000.0)
            .arc(&[12.4, 6.4, 0.0], [0.2, 3.0], false, 6000.0);
        for k in 1..=160 {
            let x = 12.4 - 0.25 * f64::from(k);
            program = program.line(&[x, 6.4 + 0.0004 * f64::from(k * k), 0.0], 9000.0);
        }
        program = program.stop().line(&[0.0, 0.0, 0.0], 12_000.0);
        program.optimised = slope.1.ends_with('0');
        let mut track = Track::new("track", slope, None, Some(program));
        track.machine.channel.look_ahead = 10;
        track.plain = track.run(&[]);
        let ticks = (0..track.ticks()).step_by(stride);
        let felt = ticks.clone().filter(|at| track.at(*at, &[30], &mut faults)).count();
        println!("{}: {felt} of {} felt", track.name, ticks.len());
        assert!(felt > ticks.len() / 4, "{}", track.name);
        tried += 2 * ticks.len();
    }
    faults.none(tried);
}

/// The queue ends at an exact stop, between two ticks, and the next block has not arrived: no tick in it
/// shows that end. It is shown all the same where the planner gets no time, and nobody is late.
#[test]
fn a_stall_while_the_queue_ends_in_an_exact_stop() {
    let mut faults = Vec::new();
    for (slope, word) in SLOPES {
        let machine = machines::with_slope(machines::mill::<3>(1000), slope);
        let limits: Vec<_> =
            machine.axes.iter().map(|axis| permitted(axis, slope, false, true, false)).collect();
        for k in 0..10 {
            let far = 20.0 + 0.0137 * f64::from(k);
            // A byte arrives in each tick.
            let wait = " ".repeat(800);
            let text =
                format!("%t\n#SLOPE [TYPE={word}]\nN10 G60 G01 X{far:.4} F6000\n{wait}\nN20 X50\nM30\n");
            for at in [100, 150] {
                let acts = [(0, Act::Slow(1)), (at, Act::Stall(3000))];
                let run = operate_text::<3, 120>(&text, [Position::ZERO; 3], &machine, &acts, KEEPS_UP)
                    .expect("runs");
                if let Err(fault) = check::limits(&run.trace, &limits) {
                    faults.push(format!("{word}, to {far:.4}, tick {at}: {fault}"));
                }
                let end = (far * 2f64.powi(32)).round() as i64;
                if run.trace.columns[0][at + 2999] != end || !run.late.is_empty() {
                    faults.push(format!("{word}, to {far:.4}, tick {at}: {:?}", run.late));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{} of 100: {faults:#?}", faults.len());
}

/// Random programs on random machines, with stalls alone and beside an operator.
#[test]
fn random_programs_stalled() {
    // `cargo run --release -p host-tests --example operate -- 0 100000` goes on with it, with text that comes
    // late too.
    let (mut faults, mut first) = (0, String::new());
    for seed in host_tests::seeds::seeds(0..200, 20) {
        let (program, machine, mut random) = random_setup(seed);
        let acts = if seed % 8 < 4 { random_acts(&mut random, 3000) } else { Vec::new() };
        let acts = if seed % 16 < 8 { with_overrides(&mut random, 3000, acts) } else { acts };
        let acts = with_stalls(&mut random, 3000, acts);
        let polls = POLLS[(random.bits() % 3) as usize];
        let run = operate::<3, 120>(&program, &machine, &acts, polls);
        if let Err(fault) = run.and_then(|run| judge(&program, &machine, &run))
            && !may_end(&fault, &program, &machine, &acts)
        {
            if faults == 0 {
                first = format!("seed {seed}, {acts:?}, {polls} polls: {fault}");
            }
            faults += 1;
        }
    }
    assert!(faults == 0, "{faults} of 200: {first}");
}

/// Random programs of a slow planner that gets no time within a few ticks behind each command.
#[test]
fn random_programs_stalled_behind_commands() {
    let mut faults = Vec::new();
    for seed in host_tests::seeds::seeds(0..200, 20) {
        let (program, machine, mut random) = random_setup(seed);
        let acts = random_acts(&mut random, 3000);
        let mut acts = with_overrides(&mut random, 3000, acts);
        let commands: Vec<_> = acts.iter().map(|(tick, _)| *tick).collect();
        for tick in commands {
            let behind = tick + (random.bits() % 10) as usize;
            acts.push((behind, Act::Stall(400 + (random.bits() % 400) as usize)));
        }
        acts.sort_by_key(|(tick, _)| *tick);
        let polls = 1 + (random.bits() % 3) as usize;
        let run = operate::<3, 120>(&program, &machine, &acts, polls);
        if let Err(fault) = run.and_then(|run| judge(&program, &machine, &run))
            && !may_end(&fault, &program, &machine, &acts)
        {
            faults.push(format!("seed {seed}, {acts:?}, {polls} polls: {fault}"));
        }
    }
    assert!(faults.is_empty(), "{} faults, {}", faults.len(), faults[0]);
}

#[test]
fn stalls_with_step() {
    all(0);
}

#[test]
fn stalls_with_trapez() {
    all(1);
}

#[test]
fn stalls_with_sin2() {
    all(2);
}

#[test]
fn stalls_with_hsc() {
    all(3);
}

#[test]
fn stalls_with_hsc_and_no_opt_0() {
    all(4);
}

/// A planner that is called every 60 ticks only, while its queue lasts for many times as long, is not late.
#[test]
fn called_rarely_it_is_not_late() {
    for slope in SLOPES {
        let track = tracks(slope).into_iter().find(|track| track.name.starts_with("long lines")).expect("it");
        let calls: Vec<_> = (200..track.ticks()).step_by(60).map(|tick| (tick, Act::Stall(59))).collect();
        let run = track.run(&calls);
        assert_eq!((track.differs(&run), run.late.len()), (None, 0), "{}", track.name);
    }
}

/// Lines and arcs so long that the interrupt does not know all of the queue and the look-ahead at once: the
/// way to a standstill is in what it knows. Stalled before every tick in which that way is moved on, at the
/// end of each block.
#[test]
fn a_way_through_blocks_of_60_metres_is_known() {
    let (line, radius) = (60_000.0, 45_000.0);
    let mut text = String::from("%far\n#SLOPE [TYPE=TRAPEZ]\nG01 F900000\n");
    let mut at = [-40_000.0, -80_000.0];
    let start = [Position::from_bits(-40_000 << 32), Position::from_bits(-80_000 << 32), Position::ZERO];
    let directions = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    for [[x, y], [to_x, to_y]] in [0, 1, 2].map(|k| [directions[k], directions[k + 1]]) {
        at = [at[0] + line * x, at[1] + line * y];
        text += &format!("G01 X{} Y{}\n", at[0], at[1]);
        at = [at[0] + radius * (x + to_x), at[1] + radius * (y + to_y)];
        text += &format!("G03 X{} Y{} I{} J{}\n", at[0], at[1], radius * to_x, radius * to_y);
    }
    text += "M30\n";
    let mut machine = machines::with_slope(machines::mill::<3>(1000), 1);
    for axis in &mut machine.axes {
        (axis.vb_max, axis.vb_eilgang, axis.tr_geom) = (16_000_000, 16_000_000, 1000);
        (axis.a_beschl, axis.a_brems, axis.a_max) = (2000, 2000, 6000);
    }
    let go = |acts: &[(usize, Act)]| {
        operate_text::<3, 120>(&text, start, &machine, acts, KEEPS_UP).expect("it goes on")
    };
    let (plain, scan) = (go(&[]), go(&[(0, Act::Override(500))]));
    let limits = machine.axes.iter().map(|axis| permitted(axis, 1, false, true, true)).collect();
    let (name, text) = ("long blocks".to_owned(), text.clone());
    let track = Track { name, text, machine, limits, program: None, plain, scan };
    track.verify(&track.plain).expect("undisturbed");
    let mut faults = Faults::default();
    let mut tried = 0;
    let quarter = radius * std::f64::consts::FRAC_PI_2;
    for (end, stall) in [(line, 30_000), (line + quarter, 26_000), (2.0 * line + quarter, 20_000)] {
        let reached = |s: &i64| *s as f64 / 2.0_f64.powi(44) >= end;
        let tick = track.plain.distances.iter().position(reached).expect("on the way");
        for at in tick - 28..=tick {
            if let Err(fault) = track.verify(&go(&[(at, Act::Stall(stall))])) {
                faults.add(&track, at, stall, &fault);
            }
            tried += 1;
        }
    }
    faults.none(tried);
}

/// A command changes what is in the queue and takes the reserve with it. A planner that gets no time from the
/// same tick on leaves the next one: whatever the room in the queue, however few the calls before.
fn a_stall_behind_a_command(slope: u8, polls: &[usize]) {
    let acts = [Act::Override(50), Act::Override(1), Act::Override(2000), Act::Reduced(true), Act::Hold];
    let text = "G01 X400 F20000\nY30\nX300 Y60 F3000\nX0\nY0 F9000\nM30\n";
    let mut machine = machines::mill(1000);
    machine.channel.slope_profile = slope;
    for axis in &mut machine.axes {
        axis.vb_max_red = 20_000;
    }
    let limits: Vec<_> = machine.axes.iter().map(|axis| permitted(axis, slope, false, true, true)).collect();
    // From rest: with any number of calls.
    for polls in 1..80 {
        stall_behind(text, &machine, &limits, (0, Act::Resume), polls)
            .unwrap_or_else(|fault| panic!("slope {slope}, {polls} calls: {fault}"));
    }
    for tick in (0..2000).step_by(83) {
        for act in acts {
            for &polls in polls {
                stall_behind(text, &machine, &limits, (tick, act), polls).unwrap_or_else(|fault| {
                    panic!("slope {slope}, {act:?} at {tick}, {polls} calls: {fault}")
                });
            }
        }
    }
}

/// Short spans whose limits differ: the way to a standstill has a law for each, and takes many calls.
fn short_spans() -> (String, MachineData<3>) {
    let mut text = String::from("G01 F20000\n");
    for k in 1..=150 {
        let [x, y] = [f64::from(k) * 1.9, [0.0, 0.55, 0.7, 0.2, -0.1][k as usize % 5]];
        text += &match k % 10 {
            9 => format!("G03 X{x:.3} Y{y:.3} R4\n"),
            _ => format!("G01 X{x:.3} Y{y:.3} Z{:.3}\n", f64::from(k * k % 7) * 0.1),
        };
    }
    let mut machine = machines::mill(1000);
    for (axis, a) in machine.axes.iter_mut().zip([1500, 2600, 900]) {
        (axis.a_max, axis.a_grenz, axis.vb_max_red) = (a, a, 20_000);
        (axis.a_beschl, axis.a_brems) = (a, a);
        (axis.a_stufe, axis.a_grenz_stufe) = ([a; 2], [a; 2]);
    }
    (text + "M30\n", machine)
}

/// A slow planner is kept from its work between the calls that it takes to change what is in the queue, or to
/// start from rest. At each tick there is a way to a standstill all the same.
#[test]
fn a_stall_within_a_change() {
    let mut faults = Vec::new();
    let (text, mut machine) = short_spans();
    for slope in 0..4 {
        machine.channel.slope_profile = slope;
        let limits: Vec<_> =
            machine.axes.iter().map(|axis| permitted(axis, slope, false, true, true)).collect();
        for (polls, at) in
            [1, 2, 3].into_iter().flat_map(|polls| (20..900).step_by(9).map(move |at| (polls, at)))
        {
            // It stands, starts, and is stalled. Behind that it starts again, and is stalled again.
            let act = [Act::Override(1500), Act::Override(50), Act::Resume][at % 3];
            let behind = at + 400;
            let first = behind + 1 + at % 7;
            let acts = [
                (at, Act::Hold),
                (behind, Act::Resume),
                (first, Act::Stall(1000)),
                (first + 500, act),
                (first + 1001 + at % 11, Act::Stall(5000)),
                (first + 6000, Act::Override(1000)),
            ];
            let run = operate_text::<3, 120>(&text, [Position::ZERO; 3], &machine, &acts, polls);
            if let Err(fault) = run.and_then(|run| check::limits(&run.trace, &limits)) {
                faults.push(format!("slope {slope}, {act:?} at {at}, {polls} calls: {fault}"));
            }
        }
    }
    assert!(faults.is_empty(), "{} faults: {:#?}", faults.len(), &faults[..faults.len().min(5)]);
}

fn stall_behind(
    text: &str,
    machine: &MachineData<3>,
    limits: &[check::Limits],
    (at, act): (usize, Act),
    polls: usize,
) -> Result<(), String> {
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let handles = channel.split(machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    let mut trace = Trace::empty(1e-3, 3);
    for tick in 0..60_000 {
        if tick == at {
            act.give(&operator);
        }
        if tick == at + 4000 {
            operator.resume();
            operator.set_reduced(false);
            operator.set_override(1000);
        }
        let left = match tick {
            tick if tick < at || tick >= at + 3000 => KEEPS_UP,
            tick if tick == at => polls,
            _ => 0,
        };
        let done = call(&mut planner, left, |_| {}).map_err(|error| error.to_string())?;
        let state = interpolator.tick();
        trace.push(interpolator.set_points().iter().map(|p| p.to_bits()));
        if done && state == State::Idle {
            return check::limits(&trace, limits).map(|_| ());
        }
    }
    Err("does not end".to_owned())
}

#[test]
fn a_stall_behind_a_command_with_every_slope() {
    for slope in 0..4 {
        a_stall_behind_a_command(slope, &[1, 2, 3, 5, 8, KEEPS_UP]);
    }
}
