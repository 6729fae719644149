//! Short random sessions: any line, real-time byte and input in any tick. Each session ends with everything permitted.
//!
//! | what | bound |
//! |---|---|
//! | `?` | its report comes in the same look of the controller |
//! | 0x18 | the banner comes within [`BANNER`] ticks, and no answer before it |
//! | a line | answered once, within [`SETTLED`] ticks from when motion is permitted |
//! | the end | a line to a known place leads exactly there |
use super::corruption::Random;
use super::world::{Rig, Switch, World, mm, settings, with_successors};
use super::{AXES, names};
use glidepath_controller::machine::Carried;
use glidepath_controller::store::MemoryFlash;
use glidepath_controller::{Config, Motion, Signals, State, Stored};

/// Longest time from 0x18 to the banner, ticks.
pub const BANNER: u32 = 2_000;

/// Longest time until everything is answered and at rest, ticks.
pub const SETTLED: u32 = 120_000;

/// What sessions did, and the longest times seen.
#[derive(Default, Debug)]
pub struct Figures {
    pub ticks: u64,
    pub lines: u64,
    pub reports: u64,
    pub resets: u64,
    pub machines: u64,
    pub longest_banner: u32,
    pub longest_settled: u32,
}

/// What a session does in this tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Phase {
    /// Anything, for so many ticks.
    Act(u32),
    /// Everything is permitted, since so many ticks.
    Settle(u32),
    /// As `Settle`, behind the line to a known place.
    Arrive(u32),
}

struct Session<'f> {
    random: Random,
    seed: u64,
    figures: &'f mut Figures,
    phase: Phase,
    /// Mean ticks between two actions.
    gap: u64,
    has_hard_limits: bool,
    tick: u32,
    /// Lines sent since the last reset, and their answers.
    wanted: u64,
    answers: u64,
    /// Tick of the first 0x18 without a banner.
    reset_at: Option<u32>,
    /// A reset by pin: which lines it dropped is not known.
    is_loose: bool,
    /// The rest of a line that is sent in two parts.
    rest: String,
    state: State,
    trail: Vec<String>,
}

/// The place of the line at the end.
const PLACE: [f64; AXES] = [-1.5, -2.25, -3.0];

/// Runs the session of a seed.
///
/// # Panics
/// A bound is exceeded; the text has the seed and all that was sent.
pub fn session(seed: u64, figures: &mut Figures) {
    let mut random = Random(seed);
    let mut settings = settings();
    settings.homing = random.below(3) == 0;
    settings.soft_limits = random.below(2) == 0;
    settings.hard_limits = random.below(5) == 0;
    let mut world = World::new(seed);
    if random.below(4) != 0 {
        world.limits = [Some(Switch::new(0.5, 1.0)); AXES];
    }
    if random.below(2) == 0 {
        world.probe = Some((2, Switch::new(-8.0, -1.0)));
    }
    let mut config = Config::new(names());
    (config.settings, config.defaults) = (settings, settings);
    if random.below(6) == 0 {
        let line = ["G21", "G1X-1F3000", "G4P0.05", "M0", "G77"][random.below(5) as usize];
        config.startup[0] = Stored::from_slice(line.as_bytes()).expect("short");
    }
    let (length, gap) = (200 + random.below(1500) as u32, 1 + random.below([3, 12, 60][seed as usize % 3]));
    let mut session = Session {
        random,
        seed,
        figures,
        phase: Phase::Act(length),
        gap,
        has_hard_limits: settings.hard_limits,
        tick: 0,
        wanted: 0,
        answers: 0,
        reset_at: None,
        is_loose: false,
        rest: String::new(),
        state: State::Idle,
        trail: vec![format!("{settings:?} startup {:?}", config.startup[0])],
    };
    with_successors(config, MemoryFlash::new(), world, |rig| session.serve(rig));
}

impl Session<'_> {
    /// Until the session ends, or another machine takes over.
    fn serve(&mut self, rig: &mut Rig<'_>) -> Option<Carried<AXES>> {
        self.figures.machines += 1;
        loop {
            if self.step(rig) {
                return None;
            }
            if let Some(next) = rig.machine.successor() {
                self.keep("another machine".into());
                return Some(next);
            }
        }
    }

    /// A tick. Returns whether the session has ended.
    fn step(&mut self, rig: &mut Rig<'_>) -> bool {
        match self.phase {
            Phase::Act(0) => self.permit(rig),
            Phase::Act(left) => {
                self.phase = Phase::Act(left - 1);
                if self.random.below(self.gap) == 0 {
                    self.act(rig);
                }
            }
            Phase::Settle(since) | Phase::Arrive(since) => {
                if since > SETTLED {
                    self.wrong(rig, "never at rest with everything answered");
                }
                self.help(rig, since);
            }
        }
        self.look(rig);
        let status = rig.machine.status();
        let stands = status.is_at_rest && !status.is_busy && self.answers == self.wanted;
        match &mut self.phase {
            Phase::Act(_) => return false,
            Phase::Settle(since) | Phase::Arrive(since) => *since += 1,
        }
        if !stands || self.reset_at.is_some() || !matches!(self.state, State::Idle | State::Check) {
            return false;
        }
        self.settled(rig)
    }

    /// Everything is answered and stands.
    fn settled(&mut self, rig: &mut Rig<'_>) -> bool {
        match self.phase {
            Phase::Settle(since) => {
                self.figures.longest_settled = self.figures.longest_settled.max(since);
                if self.state == State::Check || self.has_hard_limits {
                    return true;
                }
                self.line(rig, "G90G21G94G53G1X-1.5Y-2.25Z-3F6000");
                self.phase = Phase::Arrive(0);
                false
            }
            _ => {
                if rig.points != PLACE.map(mm) {
                    self.wrong(rig, "not at the end of the last line");
                }
                true
            }
        }
    }

    fn keep(&mut self, text: String) {
        self.trail.push(format!("{} {:?} {text}", self.tick, self.state));
    }

    fn wrong(&self, rig: &mut Rig<'_>, what: &str) -> ! {
        let (report, status) = (rig.report(), rig.machine.status());
        let Self { seed, tick, answers, wanted, trail, .. } = self;
        let last = trail.get(trail.len().saturating_sub(80)..).unwrap_or_default().join("\n");
        panic!(
            "seed {seed}, tick {tick}: {what}; {answers} of {wanted} answers\n{}\n{last}\n{report}{status:?}",
            trail[0]
        );
    }

    fn bytes(&mut self, rig: &mut Rig<'_>, bytes: &[u8]) {
        rig.send(bytes);
        self.keep(format!("> {}", bytes.escape_ascii()));
    }

    fn line(&mut self, rig: &mut Rig<'_>, line: &str) {
        let rest = core::mem::take(&mut self.rest);
        if !rest.is_empty() {
            self.bytes(rig, rest.as_bytes());
            self.wanted += 1;
        }
        self.bytes(rig, format!("{line}\n").as_bytes());
        self.wanted += 1;
        self.figures.lines += 1;
    }

    fn reset(&mut self, rig: &mut Rig<'_>) {
        self.bytes(rig, b"\x18");
        self.figures.resets += 1;
        self.reset_at = self.reset_at.or(Some(self.tick));
        (self.wanted, self.answers, self.is_loose) = (0, 0, false);
        self.rest.clear();
    }

    /// A look of the controller, and what it says.
    fn look(&mut self, rig: &mut Rig<'_>) {
        let asks = self.random.below(8) == 0;
        if asks {
            rig.send("?");
            self.figures.reports += 1;
        }
        rig.tick();
        self.tick += 1;
        self.figures.ticks += 1;
        let said = rig.read();
        let mut reports = 0;
        for line in said.lines() {
            if line == "ok" || line.starts_with("error:") {
                self.answers += 1;
                if self.reset_at.is_some() {
                    self.wrong(rig, "an answer between a reset and its banner");
                }
            }
            if line.starts_with("Grbl ")
                && let Some(at) = self.reset_at.take()
            {
                self.figures.longest_banner = self.figures.longest_banner.max(self.tick - at);
            }
            reports += u32::from(line.starts_with('<'));
            if !line.starts_with('<') {
                self.keep(format!("< {line}"));
            }
        }
        if asks && reports != 1 {
            self.wrong(rig, "no report");
        }
        if self.answers > self.wanted && !self.is_loose {
            self.wrong(rig, "an answer too many");
        }
        if self.reset_at.is_some_and(|at| self.tick - at > BANNER) {
            self.wrong(rig, "no banner");
        }
        let state = rig.controller.state(&rig.machine.status());
        if core::mem::replace(&mut self.state, state) != state {
            self.keep(format!("→ {state:?}"));
        }
        if self.random.below(60) == 0 {
            // The task is late.
            for _ in 0..self.random.below(12) {
                rig.late_tick();
                self.tick += 1;
            }
        }
    }

    /// From now on nothing is in the way.
    fn permit(&mut self, rig: &mut Rig<'_>) {
        rig.world.signals = Signals::default();
        if self.is_loose {
            self.reset(rig);
        }
        self.line(rig, "G4P0.01");
        self.phase = Phase::Settle(0);
    }

    /// What a user does who wants the machine to go on.
    fn help(&mut self, rig: &mut Rig<'_>, since: u32) {
        let is_slow = since % 400 == 399;
        match self.state {
            _ if since % 25 != 24 => {}
            State::Hold(0) | State::Door(0) => self.bytes(rig, b"~"),
            State::Sleep if self.reset_at.is_none() => self.reset(rig),
            State::Alarm if is_slow => self.reset(rig),
            State::Alarm if self.answers == self.wanted && self.reset_at.is_none() => self.line(rig, "$X"),
            State::Run if is_slow => self.bytes(rig, b"\x90\x95"),
            _ => {}
        }
    }

    fn act(&mut self, rig: &mut Rig<'_>) {
        match self.random.below(40) {
            0..=19 if rig.room() > 300 => {
                let words = self.words();
                self.line(rig, &words);
            }
            20 if rig.room() > 300 && self.rest.is_empty() => {
                let words = self.words() + "\n";
                let (first, rest) = words.split_at(self.random.below(words.len() as u64) as usize);
                self.rest = rest.into();
                self.bytes(rig, first.as_bytes());
            }
            21..=24 => self.bytes(rig, b"!"),
            25..=28 => self.bytes(rig, b"~"),
            29 => self.reset(rig),
            30 => self.bytes(rig, b"\x84"),
            31 | 32 => self.bytes(rig, b"\x85"),
            33..=35 => {
                let bytes = b"\x90\x91\x92\x93\x94\x95\x96\x97\x99\x9a\x9b\x9c\x9d\x9e\xa0\xa1\xc2\xff\x87";
                let byte = bytes[self.random.below(bytes.len() as u64) as usize];
                self.bytes(rig, &[byte]);
            }
            36 => {
                let pins = [Signals::DOOR, Signals::HOLD, Signals::START, Signals::RESET, Signals::PROBE];
                let pin = pins[self.random.below(5) as usize];
                let is_new = !rig.world.signals.has(pin);
                rig.world.signals = rig.world.signals.and(pin);
                self.keep(format!("pins {:?}", rig.world.signals));
                if pin == Signals::RESET && is_new {
                    (self.is_loose, self.reset_at) = (true, self.reset_at.or(Some(self.tick)));
                }
            }
            _ => {
                rig.world.signals = Signals::default();
                self.keep("no pins".into());
            }
        }
    }

    /// A place inside the travel.
    fn place(&mut self) -> String {
        format!("-{}.{:03}", self.random.below(12), self.random.below(1000))
    }

    fn words(&mut self) -> String {
        let (a, b, c, f) = (self.place(), self.place(), self.place(), 1500 + self.random.below(5000));
        let random = &mut self.random;
        let mut of = |choice: &[&str]| choice[random.below(choice.len() as u64) as usize].to_owned();
        let kind =
            of(&["line", "line", "line", "rapid", "arc", "jog", "wait", "wait", "bad", "ask", "set", "$H"]);
        match kind.as_str() {
            "line" if f % 3 == 0 => format!("G1X{a}F{f}"),
            "line" => format!("G90 G1 X{a} Y{b} Z{c} F{f}"),
            "rapid" => format!("G0X{a}Y{b}"),
            "arc" => format!("G90G2X{a}Y{b}R30F{f}"),
            "jog" if f % 2 == 0 => format!("$J=G91X{}F{f}", of(&["0.5", "-0.5", "-0.01", "3"])),
            "jog" => format!("$J=G53X{a}Z{c}F{f}"),
            "wait" if f % 4 == 0 => format!("G38.{}Z{c}F{f}", 2 + f % 5),
            "wait" => {
                of(&["G4P0.01", "G4P0.2", "G4P0", "M0", "M1", "M6", "M60", "M30", "M2", "%", "M3S500", "M5"])
            }
            "bad" => {
                of(&["G77", "X", "G1X9", "G2X-1F9", "$Q", "$J=X1", "1", "G4", "", "(text)", "M98P1", "G38.2"])
            }
            "ask" => {
                of(&["$G", "$$", "$#", "$I", "$N", "$", "$X", "$C", "$SLP", "G92X0", "G92.1", "G10L20P1X-1"])
            }
            "set" if f % 3 != 0 => of(&["G90", "G91", "G21", "G54", "G55", "G94", "G17", "G18", "M8", "M9"]),
            "set" => of(&[
                "$110=4000",
                "$111=5000",
                "$120=500",
                "$22=1",
                "$22=0",
                "$20=1",
                "$20=0",
                "$1=30",
                "$10=1",
                "$RST=#",
                "$RST=$",
                "$RST=*",
                "$23=1",
                "$N0=G21",
                "$I=text",
            ]),
            other => other.to_owned(),
        }
    }
}
