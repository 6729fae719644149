//! `glidepath serve` at full speed, and a sender that does everything at random: jobs, jogs, probing, homing, holds, doors,
//! resets, settings, refused lines, bytes of no use. Bits of places are what `soak` of the controller looks at: here it
//! is the protocol over a real connection, and the memory of the command.
mod talk;

use std::time::{Duration, Instant};
use talk::Talk;

/// Ticks of an hour.
const HOUR: f64 = 3_600_000.0;

/// Longest time for an answer, or to come to rest.
const PATIENCE: Duration = Duration::from_secs(60);

/// Seeded numbers (splitmix64).
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (x ^ (x >> 31)) % end
    }

    fn of<T: Copy>(&mut self, choice: &[T]) -> T {
        choice[self.below(choice.len() as u64) as usize]
    }

    /// A place inside the travel.
    fn place(&mut self) -> String {
        format!("-{}.{:03}", 2 + self.below(36), self.below(1000))
    }
}

struct Sender {
    talk: Talk,
    random: Random,
    seed: u64,
    sent: u64,
    answers: u64,
    /// What was sent and said last.
    trail: Vec<String>,
    report: String,
}

/// Settings of a machine that homes, with soft limits.
const SETTINGS: [&str; 12] = [
    "$22=1",
    "$130=100",
    "$131=100",
    "$132=100",
    "$20=1",
    "$25=6000",
    "$24=600",
    "$26=5",
    "$27=1",
    "$110=20000",
    "$111=20000",
    "$112=20000",
];

impl Sender {
    fn new(seed: u64) -> Self {
        let talk = Talk::with(&["--speed", "1000"], 0);
        let (trail, report) = (Vec::new(), String::new());
        let mut sender = Self { talk, random: Random(seed), seed, sent: 0, answers: 0, trail, report };
        for line in SETTINGS {
            sender.line(line);
        }
        sender.settle();
        sender
    }

    #[track_caller]
    fn wrong(&self, what: &str) -> ! {
        let (seed, sent, answers) = (self.seed, self.sent, self.answers);
        panic!("seed {seed}: {what}, {answers} of {sent} answers\n{}", self.trail.join("\n"));
    }

    /// The next line. Without one the test fails and shows what was said before.
    fn heard(&mut self) -> String {
        match self.talk.try_line() {
            Ok(line) => line,
            Err(error) => self.wrong(&format!("no answer ({error}), last report {}", self.report)),
        }
    }

    fn keep(&mut self, text: String) {
        if self.trail.len() > 60 {
            self.trail.remove(0);
        }
        self.trail.push(text);
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.keep(format!("> {}", bytes.escape_ascii()));
        self.talk.send(bytes);
    }

    fn line(&mut self, line: &str) {
        let end = self.random.of(&["\n", "\r\n"]);
        self.bytes(format!("{line}{end}").as_bytes());
        self.sent += 1;
        self.answered(8);
    }

    /// Waits until no more than so many lines are open, as a sender that counts lines.
    fn answered(&mut self, open: u64) {
        let begun = Instant::now();
        while self.sent - self.answers > open {
            self.look();
            self.release();
            if begun.elapsed() > PATIENCE {
                self.wrong(&format!("no answer: {}", self.report));
            }
        }
    }

    /// A report, and all that was said before it.
    fn look(&mut self) {
        self.talk.send(b"?");
        loop {
            let line = self.heard();
            if line.starts_with('<') {
                if !is_report(&line) {
                    self.wrong(&line);
                }
                self.report = line;
                break;
            }
            self.answers += u64::from(line == "ok" || line.starts_with("error:"));
            self.keep(format!("< {line}"));
            if !is_said(&line) {
                self.wrong(&format!("it said {line:?}"));
            }
        }
        if self.answers > self.sent {
            self.wrong("an answer too many");
        }
    }

    fn state(&self) -> &str {
        self.report.trim_start_matches('<').split('|').next().unwrap_or_default()
    }

    /// Ends a hold.
    fn release(&mut self) {
        if matches!(self.state(), "Hold:0" | "Door:0") {
            self.bytes(b"~");
        }
    }

    /// Everything is answered, and the axes rest.
    fn settle(&mut self) {
        let begun = Instant::now();
        let mut held = 0;
        loop {
            self.look();
            match self.state() {
                "Idle" if self.answers == self.sent => return,
                "Alarm" if self.answers == self.sent => self.line("$X"),
                "Run" | "Jog" if self.report.contains("|FS:0") => held += 1,
                _ => held = 0,
            }
            self.release();
            if held % 50 == 49 {
                // An override may leave next to nothing of a speed.
                self.bytes(b"\x90\x95");
            }
            if begun.elapsed() > PATIENCE {
                self.wrong(&format!("never at rest: {}", self.report));
            }
        }
    }

    /// A sender that does not wait.
    fn chatter(&mut self) {
        match self.random.below(8) {
            0 => {
                let byte = self.random.of(b"!~\x84\x85\x90\x91\x92\x93\x94\x95\x96\x97\x9a\x9b\x9e\xa0\xa1");
                self.bytes(&[byte]);
            }
            1 => {
                let bytes = self.random.of(&[&b"\xc2\x91"[..], b"\x87", b"\xff", b"\x00", b"\x82\x81"]);
                self.bytes(bytes);
            }
            2 => self.look(),
            3 => std::thread::sleep(Duration::from_micros(self.random.below(800))),
            _ => {}
        }
    }

    fn words(&mut self) -> String {
        let (a, b, c, f) =
            (self.random.place(), self.random.place(), self.random.place(), 300 + self.random.below(20_000));
        match self.random.below(20) {
            0..=9 => format!("G90 G1 X{a} Y{b} Z{c} F{f}"),
            10 => format!("G0x{a}z{b}"),
            11 => format!("G2X{a}Y{b}R90F{f}"),
            12 => format!("$J=G90X{a}F{f}"),
            13 => {
                self.random.of(&["M3S500", "M4 S100", "M5", "M8", "M7", "M9", "T2", "M6", "M0", "M30"]).into()
            }
            14 => self
                .random
                .of(&["G4P0.01", "G4 P0.3", "", "(MSG, text)", "; rest", "%", "/G91", "G90"])
                .into(),
            15 => self
                .random
                .of(&["G77", "X", "G1X1", "G2X-1F9", "$Q", "$J=X1", "A1", "G38.2", "1", "G4"])
                .into(),
            16 => self.random.of(&["$G", "$$", "$#", "$I", "$N", "$", "$X", "$1=30", "$10=3", "$H"]).into(),
            17 => self
                .random
                .of(&["G20", "G21", "G54", "G55", "G92X0", "G92.1", "G93", "G94", "G17", "G18"])
                .into(),
            18 => format!("G10L20P{}X{a}", 1 + self.random.below(6)),
            _ => format!("G38.3Z{a}F900"),
        }
    }

    fn job(&mut self) {
        for _ in 0..1 + self.random.below(30) {
            let words = self.words();
            self.line(&words);
            self.chatter();
        }
        self.settle();
    }

    fn jogs(&mut self) {
        for _ in 0..1 + self.random.below(6) {
            let (place, feed) = (self.random.place(), 100 + self.random.below(90_000));
            self.line(&format!("$J=G53X{place}F{feed}"));
            self.chatter();
        }
        if self.random.below(2) == 0 {
            self.bytes(b"\x85");
        }
        self.settle();
    }

    /// A reset at any moment: the banner once, an answer to each line behind it, and no motion.
    fn reset(&mut self) {
        for _ in 0..self.random.below(6) {
            let words = self.words();
            self.line(&words);
            self.chatter();
        }
        self.bytes(b"\x18");
        loop {
            let line = self.heard();
            self.keep(format!("< {line}"));
            if line.starts_with("Grbl ") {
                break;
            }
        }
        (self.sent, self.answers) = (0, 0);
        self.look();
        let first = self.report.clone();
        self.look();
        let place = |report: &str| report.split('|').nth(1).map(str::to_owned);
        if place(&first) != place(&self.report) || !matches!(self.state(), "Idle" | "Alarm") {
            self.wrong(&format!("behind a reset {first} {}", self.report));
        }
    }

    /// Known words are in force, and the axes go exactly where they are sent.
    fn check(&mut self) {
        self.reset();
        for line in ["$X", "$RST=#", "$22=1", "$20=1", "G21G90G94G17G54"] {
            self.line(line);
            self.settle();
        }
        let [x, y, z] = [(); 3].map(|()| self.random.place());
        self.line(&format!("G1X{x}Y{y}Z{z}F9000"));
        self.line("G4P0.01");
        self.settle();
        if !self.report.contains(&format!("MPos:{x},{y},{z}|")) {
            self.wrong(&format!("the end is {}", self.report));
        }
    }

    fn check_mode(&mut self) {
        // A reset may have locked the machine.
        self.settle();
        let before = self.report.clone();
        self.line("$C");
        for _ in 0..self.random.below(9) {
            let words = self.words();
            self.line(&words);
        }
        self.answered(0);
        self.look();
        if self.state() != "Check" {
            self.wrong(&format!("{before}, check mode, {}", self.report));
        }
        self.line("$C");
        self.settle();
    }

    fn home(&mut self) {
        self.line("$H");
        self.settle();
        if !self.report.contains("MPos:-1.000,-1.000,-1.000|") {
            self.wrong(&format!("homed at {}", self.report));
        }
    }
}

fn is_said(line: &str) -> bool {
    let begins = ["[", "$", ">", "ALARM:", "error:", "Grbl 1.1h ['$' for help]"];
    line.is_empty() || line == "ok" || begins.iter().any(|begin| line.starts_with(begin))
}

/// The fields of a report in their order.
fn is_report(line: &str) -> bool {
    let order = ["MPos:", "WPos:", "Bf:", "Ln:", "FS:", "Pn:", "WCO:", "Ov:", "A:"];
    let Some(text) = line.strip_prefix('<').and_then(|text| text.strip_suffix('>')) else { return false };
    let mut fields = text.split('|');
    let state = fields.next().unwrap_or_default();
    let states =
        ["Idle", "Run", "Hold:0", "Hold:1", "Jog", "Alarm", "Door:0", "Door:1", "Door:2", "Door:3", "Check"];
    let mut last = None;
    let is_ordered = fields.all(|field| {
        let place = order.iter().position(|name| field.starts_with(name));
        let is_next = place.is_some() && place > last;
        last = place;
        is_next
    });
    is_ordered
        && (states.contains(&state) || state == "Home")
        && text.contains("Pos:")
        && text.contains("|FS:")
}

/// Simulated ticks and lines of so much real time.
fn soak(seed: u64, time: Duration) -> (f64, u64) {
    let begun = Instant::now();
    let mut sender = Sender::new(seed);
    sender.home();
    let (mut pages, mut lines) = (0, 0);
    while begun.elapsed() < time {
        match sender.random.below(12) {
            0 => sender.check(),
            1 | 2 => sender.jogs(),
            3 | 4 => sender.reset(),
            5 => {
                sender.check();
                sender.home();
            }
            6 => sender.check_mode(),
            _ => sender.job(),
        }
        lines += sender.sent;
        (sender.sent, sender.answers) = (0, 0);
        pages = if pages == 0 && begun.elapsed() > time / 2 { sender.talk.pages() } else { pages };
    }
    sender.check();
    assert!(sender.talk.pages() <= pages + 64, "{} pages, {pages} at half time", sender.talk.pages());
    let ticks = sender.talk.end();
    let ticks = ticks.strip_prefix("ticks ").and_then(|ticks| ticks.parse::<u64>().ok()).expect("ticks");
    (ticks as f64, lines)
}

/// A seed that no run had before, or the one that `GLIDEPATH_SEED` names.
fn fresh_seed() -> u64 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let given = std::env::var("GLIDEPATH_SEED").ok().and_then(|seed| seed.parse().ok());
    let seed = given.unwrap_or_else(|| now.map_or(0, |now| now.as_micros() as u64 % 1_000_000_000));
    println!("GLIDEPATH_SEED={seed}");
    seed
}

#[test]
fn seconds_at_full_speed() {
    let (ticks, lines) = soak(fresh_seed(), Duration::from_secs(5));
    println!("{:.2} simulated hours, {lines} lines", ticks / HOUR);
    assert!(lines > 20);
}

/// 24 simulated hours, or as many as `GLIDEPATH_HOURS` says.
#[test]
#[ignore = "long"]
fn hours_at_full_speed() {
    let hours = std::env::var("GLIDEPATH_HOURS").ok().and_then(|hours| hours.parse().ok()).unwrap_or(24.0);
    let (mut done, mut lines, first) = (0.0, 0, fresh_seed());
    for seed in first.. {
        let (ticks, more) = soak(seed, Duration::from_secs(60));
        (done, lines) = (done + ticks / HOUR, lines + more);
        println!("{done:.2} simulated hours, {lines} lines");
        if done >= hours {
            break;
        }
    }
}
