//! A conversation over a bad line.
use super::{Talk, serial};
use glidepath_controller::Config;

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

/// Sends `bytes` bytes, damaged by the seed, and after each burst brings both sides in step.
///
/// # Panics
/// A line is answered not at all or twice, or the controller is not in step behind a line end.
pub fn damage(seed: u64, bytes: u64) -> Damaged {
    let mut random = Random(seed);
    let mut talk = Talk::with(Config::new(super::names()), serial());
    talk.poll();
    talk.read();
    let mut damaged = Damaged { bytes: 0, lines: 0, resets: 0 };
    while damaged.bytes < bytes {
        burst(&mut random, &mut talk, &mut damaged);
        in_step(&mut talk, seed);
    }
    damaged
}

/// Some lines, damaged, and as many answers.
fn burst(random: &mut Random, talk: &mut Talk<'_>, damaged: &mut Damaged) {
    let mut text = Vec::new();
    for _ in 0..1 + random.below(8) {
        let line = LINES[random.below(LINES.len() as u64) as usize];
        text.extend_from_slice(line.as_bytes());
        text.extend_from_slice([&b"\n"[..], b"\r", b"\r\n"][random.below(3) as usize]);
    }
    for _ in 0..random.below(12) {
        let at = random.below(text.len() as u64) as usize;
        let byte = random.below(256) as u8;
        match random.below(5) {
            0 => text[at] ^= 1 << random.below(8),
            1 => text.insert(at, byte),
            2 => _ = text.remove(at),
            3 => text[at] = byte,
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
    talk.send(&text);
    finish(talk);
    let said = talk.read();
    let answers = said.lines().filter(|line| *line == "ok" || line.starts_with("error:")).count();
    assert_eq!(
        answers,
        wanted,
        "{} bytes, reset {at_reset:?}: {:?}\n{said}",
        text.len(),
        String::from_utf8_lossy(&text)
    );
}

/// Everything is carried out, whatever hold, door or alarm there is.
fn finish(talk: &mut Talk<'_>) {
    for _ in 0..3 {
        talk.send("~");
        for _ in 0..60 {
            talk.poll();
            talk.mock.step();
            talk.now_ms = talk.now_ms.wrapping_add(100);
        }
    }
}

/// One line end, and an answer is that of its line.
fn in_step(talk: &mut Talk<'_>, seed: u64) {
    talk.send("\n");
    finish(talk);
    let said = talk.read();
    let last = said.trim_end().rsplit("\r\n").next().unwrap_or_default();
    assert!(said.is_empty() || last == "ok" || last.starts_with("error:"), "seed {seed}: {said}");
    talk.send("$X\n");
    finish(talk);
    let said = talk.read();
    assert!(said.ends_with("ok\r\n") && said.matches("ok\r\n").count() == 1, "seed {seed}: {said}");
    // Off again what a damaged line may have switched on.
    if talk.mock.queue.is_empty() {
        talk.send("$X\n$RST=*\n");
        finish(talk);
        talk.read();
    }
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
