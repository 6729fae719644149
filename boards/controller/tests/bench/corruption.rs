//! A conversation over a bad line.
use super::world::Rig;
use super::{BUFFER, Talk, serial};
use glidepath_controller::{Config, Motion, State};

/// What came of it.
#[derive(Debug)]
pub struct Damaged {
    pub bytes: u64,
    /// Line ends sent.
    pub lines: u64,
    pub resets: u64,
}

/// Lines that are damaged. None of them puts the machine to sleep.
const LINES: [&str; 14] = [
    "G0X1Y2Z3",
    "G1 X10.5 Y-3 F1200",
    "N20G1X0",
    "M3S1000",
    "(a comment)",
    "G4P0.01",
    "$G",
    "$$",
    "$#",
    "$J=G91X0.1F1000",
    "$X",
    "$I",
    "M30",
    "$10=3",
];

/// Lines for a machine whose axes have the travel -60…0 mm.
const MOTIONS: [&str; 20] = [
    "G0X-1Y-2Z-3",
    "G1 X-1.5 Y-3 F6000",
    "N20G1X-2F5000",
    "G91X-.2",
    "G90",
    "G2X-1Y-2R3F3000",
    "G3X-2Y-2I-0.5J0.25F3000",
    "$J=G91X0.1F1000",
    "$J=G91Z-0.4F3000",
    "$J=G53X-1F5000",
    "M3S1000",
    "(a comment)",
    "$G",
    "$#",
    "G92X0",
    "G10L20P1X-1Y0",
    "$X",
    "$I",
    "G20",
    "G21",
];

/// Whom the bad line leads to.
pub trait Far {
    /// Lines that are damaged.
    fn lines(&self) -> &'static [&'static str];
    /// Bytes, all at once.
    fn send(&mut self, bytes: &[u8]);
    /// Everything is carried out, whatever hold, door or alarm there is.
    fn finish(&mut self);
    /// What it said.
    fn read(&mut self) -> String;
    /// Off again what a damaged line may have switched on.
    fn restore(&mut self);
}

impl Far for Talk<'_> {
    fn lines(&self) -> &'static [&'static str] {
        &LINES
    }

    fn send(&mut self, bytes: &[u8]) {
        Talk::send(self, bytes);
    }

    fn finish(&mut self) {
        for _ in 0..3 {
            self.send("~");
            for _ in 0..60 {
                self.poll();
                self.mock.step();
                self.now_ms = self.now_ms.wrapping_add(100);
            }
        }
    }

    fn read(&mut self) -> String {
        Talk::read(self)
    }

    fn restore(&mut self) {
        if self.mock.queue.is_empty() {
            self.send("$X\n$RST=*\n");
            self.finish();
            self.read();
        }
    }
}

/// Planner, interpolator and protocol; each axis stays inside its travel.
impl Far for Rig<'_> {
    fn lines(&self) -> &'static [&'static str] {
        &MOTIONS
    }

    fn send(&mut self, bytes: &[u8]) {
        Rig::send(self, bytes);
    }

    fn finish(&mut self) {
        self.ticks(3);
        for _ in 0..1_000_000 {
            let state = self.controller.state(&self.machine.status());
            let is_done = matches!(state, State::Idle | State::Alarm | State::Check | State::Sleep);
            if is_done && (self.room() == BUFFER || state == State::Sleep) {
                break;
            }
            Rig::send(self, "~");
            self.ticks(10);
        }
        self.ticks(3);
    }

    fn read(&mut self) -> String {
        for (least, most) in self.world.seen {
            assert!(least >= -60.0 && most <= 0.0, "{least}…{most}");
        }
        Rig::read(self)
    }

    fn restore(&mut self) {
        Rig::send(self, [0x18]);
        self.ticks(400);
        Rig::send(self, "$X\n$22=0\n$RST=#\n");
        self.finish();
        self.read();
    }
}

/// Sends `bytes` bytes, damaged by the seed, and after each burst brings both sides in step.
///
/// # Panics
/// A line is answered not at all or twice, or the controller is not in step behind a line end.
pub fn damage(seed: u64, bytes: u64) -> Damaged {
    let mut talk = Talk::with(Config::new(super::names()), serial());
    talk.poll();
    talk.read();
    damage_of(&mut talk, seed, bytes)
}

/// The same with any far side.
///
/// # Panics
/// As [`damage`].
pub fn damage_of(far: &mut impl Far, seed: u64, bytes: u64) -> Damaged {
    let mut random = Random(seed);
    let mut damaged = Damaged { bytes: 0, lines: 0, resets: 0 };
    while damaged.bytes < bytes {
        burst(&mut random, far, &mut damaged);
        in_step(far, seed);
    }
    damaged
}

/// Some lines, damaged, and as many answers.
fn burst(random: &mut Random, far: &mut impl Far, damaged: &mut Damaged) {
    let lines = far.lines();
    let mut text = Vec::new();
    for _ in 0..1 + random.below(8) {
        let line = lines[random.below(lines.len() as u64) as usize];
        text.extend_from_slice(line.as_bytes());
        text.extend_from_slice([&b"\n"[..], b"\r", b"\r\n"][random.below(3) as usize]);
    }
    for _ in 0..random.below(12) {
        let at = random.below(text.len() as u64) as usize;
        let byte = random.below(256) as u8;
        match random.below(6) {
            0 => text[at] ^= 1 << random.below(8),
            1 => text.insert(at, byte),
            2 => _ = text.remove(at),
            3 => text[at] = byte,
            4 => text.insert(at, text[at]),
            // Noise of any length.
            _ => {
                let noise: Vec<u8> = (0..random.below(40)).map(|_| random.below(256) as u8).collect();
                text.splice(at..at, noise);
            }
        }
        if text.is_empty() {
            text.push(b'\n');
        }
    }
    damaged.bytes += text.len() as u64;
    // Behind a reset the next line is answered; what stood before it is not, or it was already.
    let mut behind_cr = false;
    let mut wanted = 0;
    let mut at_reset = None;
    for byte in &text {
        match byte {
            0x18 => {
                damaged.resets += 1;
                (wanted, behind_cr) = (0, false);
                at_reset = Some(());
            }
            b'\n' if behind_cr => behind_cr = false,
            b'\n' | b'\r' => {
                damaged.lines += 1;
                wanted += 1;
                behind_cr = *byte == b'\r';
            }
            // A real-time byte between CR and LF is not part of the text.
            0x80.. | b'?' | b'!' | b'~' => {}
            _ => behind_cr = false,
        }
    }
    // All at once, as an interrupt may have it: a reset then drops all lines before it.
    far.send(&text);
    far.finish();
    let said = far.read();
    let answers = said.lines().filter(|line| *line == "ok" || line.starts_with("error:")).count();
    assert_eq!(
        answers,
        wanted,
        "{} bytes, reset {at_reset:?}: {:?}\n{said}",
        text.len(),
        String::from_utf8_lossy(&text)
    );
}

/// One line end, and an answer is that of its line.
fn in_step(far: &mut impl Far, seed: u64) {
    far.send(b"\n");
    far.finish();
    let said = far.read();
    // None behind CR: that line end is the same one. What it ends may be `$C`, with a banner behind its answer.
    let answers = said.lines().filter(|line| *line == "ok" || line.starts_with("error:")).count();
    assert!(if said.is_empty() { answers == 0 } else { answers == 1 }, "seed {seed}: {said}");
    far.send(b"$X\n");
    far.finish();
    let said = far.read();
    assert!(said.ends_with("ok\r\n") && said.matches("ok\r\n").count() == 1, "seed {seed}: {said}");
    far.restore();
}

/// Seeded numbers (xorshift64*).
#[derive(Clone)]
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        let mut x = self.0 ^ 0x9e37_79b9_7f4a_7c15;
        for _ in 0..2 {
            x ^= x >> 12;
            x ^= x << 25;
            x ^= x >> 27;
        }
        self.0 = x;
        x.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 8
    }

    pub fn below(&mut self, end: u64) -> u64 {
        self.next() % end.max(1)
    }
}
