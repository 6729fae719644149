//! Tests the controller's firmware in the emulator: this program acts as a sender on the serial line.
use crate::firmware::{Firmware, Place};
use crate::senders;
use crate::shell::step;
use crate::target;
use std::collections::VecDeque;

/// The firmware.
const BOARD: &str = "boards/stm32f405";
pub const BINARY: &str = "glidepath-stm32f405-controller";

/// Highest number of unread bytes at the controller.
const WINDOW: usize = 127;

/// Number of lines of the job, and of the short form.
pub const LINES: usize = 1000;
const SHORT: usize = 200;

/// Highest number of instructions in an interrupt: 40 % of a millisecond at 168 MHz.
pub const INTERRUPT: u64 = 67_200;

/// Bytes of stack that must stay unused.
const STACK_FREE: u64 = 2048;

/// Counts per mm, and end point of the job, mm.
const COUNTS: f64 = 1000.0;
const END: [f64; 3] = [1.5, 2.25, -0.5];

/// Highest number of consecutive status reports that the sender requests.
const REPORTS: usize = 200_000;

/// Runs this test only: `cargo xtask controller`, or with another number of lines.
pub fn all(lines: &str) -> Result<(), String> {
    let lines = lines.parse().map_err(|e| format!("{lines}: {e}"))?;
    step("firmware");
    let firmware = Firmware::prepare(Place::Emulator)?;
    build(&firmware)?;
    step("a controller and its sender");
    run(&firmware, lines).map(|_| ())
}

/// Runs the short form only: `cargo xtask controller --short`.
pub fn only_short() -> Result<(), String> {
    step("firmware");
    short(&Firmware::prepare(Place::Emulator)?).map(|_| ())
}

/// The short form, for every run of the tests. Returns the longest interrupt, instructions.
pub fn short(firmware: &Firmware) -> Result<u64, String> {
    let longest = interrupt(firmware)?;
    senders::with_firmware(firmware)?;
    Ok(longest)
}

/// The longest interrupt of a short job, instructions.
pub fn interrupt(firmware: &Firmware) -> Result<u64, String> {
    build(firmware)?;
    step("a controller and its sender");
    run(firmware, SHORT)
}

/// Builds the firmware.
pub fn build(firmware: &Firmware) -> Result<(), String> {
    firmware.build(BOARD, &["--features", "qemu,controller", "--bin", BINARY], &[])
}

/// Sends a job with this number of lines. Checks that each line is acknowledged once, and that the axes end
/// at the end point, in set points and in counted steps. Returns the longest interrupt, which must be below
/// the limit, in instructions.
fn run(firmware: &Firmware, lines: usize) -> Result<u64, String> {
    let mut sender = Sender::new(lines);
    let output = firmware.speak(BINARY, |said| sender.answer(said))?;
    let text = String::from_utf8_lossy(&output.out);
    if let Some(why) = sender.failed {
        return Err(format!("the controller in the emulator: {why}\n{}{}", tail(&text), output.err));
    }
    if !output.success || sender.step != Talk::Asleep {
        return Err(format!(
            "the conversation ended while {:?}:\n{}{}",
            sender.step,
            tail(&text),
            output.err
        ));
    }
    let figures = output.err.lines().rev().find(|line| line.starts_with("ticks ")).unwrap_or_default();
    let values = target::fields(figures);
    let value = |key| target::number(&values, key, &output.err);
    for (axis, end) in ["x", "y", "z"].iter().zip(END) {
        let counted = values.get(axis).and_then(|value| value.parse::<i64>().ok());
        if counted != Some((end * COUNTS).round() as i64) {
            return Err(format!("axis {axis} has put out {counted:?} steps, wanted {}", end * COUNTS));
        }
    }
    let [ticks, active, missed, longest] = ["ticks", "active", "missed", "longest"].map(value);
    let (ticks, active, missed, longest) = (ticks?, active?, missed?, longest?);
    let (stack, size) = (value("stack")?, value("of")?);
    if missed != 0 {
        return Err(format!("{missed} ticks came while the one before was computed"));
    }
    eprintln!(
        "   {} lines, {} answers, {ticks} ticks, {active} of them in motion; longest interrupt {longest} instructions; \
         {stack} of {size} bytes of stack",
        sender.count, sender.answers
    );
    if stack + STACK_FREE > size {
        return Err(format!("the stack was {stack} bytes deep, less than {STACK_FREE} of {size} are free"));
    }
    if longest > INTERRUPT {
        return Err(format!("an interrupt of {longest} instructions, limit {INTERRUPT}"));
    }
    Ok(longest)
}

/// The last lines.
fn tail(text: &str) -> String {
    let lines: Vec<&str> = text.lines().rev().take(12).collect();
    lines.into_iter().rev().flat_map(|line| [line, "\n"]).collect()
}

/// State of the conversation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Talk {
    /// No banner yet.
    Silent,
    /// Lines are sent, and answers arrive.
    Sending,
    /// The axes brake for a feed hold, in the middle of the job.
    Holding,
    /// The last line is acknowledged, and the axes still move.
    Ending,
    /// A jog moves and will be cancelled.
    Jogging,
    /// `$SLP`: the emulator ends.
    Asleep,
}

/// A sender that counts bytes.
struct Sender {
    lines: VecDeque<String>,
    /// Lengths of lines without an answer.
    open: VecDeque<usize>,
    count: usize,
    answers: usize,
    /// Bytes of the controller's text that were read.
    read: usize,
    step: Talk,
    reports: usize,
    held: bool,
    /// The jog was in progress and was cancelled.
    cancelled: bool,
    failed: Option<String>,
}

impl Sender {
    fn new(lines: usize) -> Self {
        let settings = ["$100", "$101", "$102"].map(|key| format!("{key}={COUNTS}")).into_iter();
        let settings = settings.chain(["$110", "$111", "$112"].map(|key| format!("{key}=6000")));
        let queries = ["$$", "$I", "$#", "$G", "G21 G90 G94 G17", "M3 S500"].map(String::from);
        let job = (0..lines).map(|i| match i % 50 {
            // All axes as fast as their step rate permits.
            25 => "G0 X30 Y-30 Z-30".into(),
            26 => "G0 X0 Y0 Z0".into(),
            _ => format!("G1 X{:.3} Y{:.3} F3000", (i % 17) as f64 / 4.0, (i % 23) as f64 / 5.0),
        });
        let [x, y, z] = END;
        let end = [format!("G1 X{x} Y{y} Z{z}"), "M5".into()];
        let lines: VecDeque<String> = settings.chain(queries).chain(job).chain(end).collect();
        Self {
            count: lines.len(),
            lines,
            open: VecDeque::new(),
            answers: 0,
            read: 0,
            step: Talk::Silent,
            reports: 0,
            held: false,
            cancelled: false,
            failed: None,
        }
    }

    /// Returns the next output of the sender; `said`: all output of the controller so far.
    fn answer(&mut self, said: &[u8]) -> Option<Vec<u8>> {
        let mut bytes = Vec::new();
        while let Some(rest) = said.get(self.read..)
            && let Some(length) = rest.iter().position(|byte| *byte == b'\n')
        {
            self.read += length + 1;
            let line = String::from_utf8_lossy(rest.get(..length).unwrap_or_default()).trim().to_owned();
            self.hear(&line, &mut bytes);
        }
        if self.step == Talk::Sending {
            self.send(&mut bytes);
        }
        (!bytes.is_empty()).then_some(bytes)
    }

    fn hear(&mut self, line: &str, bytes: &mut Vec<u8>) {
        match line {
            // The emulator ends; other output does not matter.
            _ if self.failed.is_some() && line.starts_with("Grbl ") => bytes.extend(b"$SLP\n"),
            _ if self.failed.is_some() => {}
            "ok" if self.open.pop_front().is_some() => {
                self.answers += 1;
                // An earlier report might be older than the jog.
                if self.step == Talk::Jogging {
                    bytes.push(b'?');
                }
            }
            _ if line.starts_with("Grbl ") && self.step == Talk::Silent => self.step = Talk::Sending,
            _ if line.starts_with('<') => self.report(line, bytes),
            _ if line == "ok" || line.starts_with("error") || line.starts_with("ALARM") => {
                self.fail(format!("{line}, when {:?} waited", self.open), bytes);
            }
            _ => {}
        }
    }

    fn fail(&mut self, why: String, bytes: &mut Vec<u8>) {
        self.failed = Some(why);
        bytes.push(0x18);
    }

    fn send(&mut self, bytes: &mut Vec<u8>) {
        if !self.held && self.answers > self.count / 2 {
            // A hold, and a higher feed override after it.
            (self.held, self.step) = (true, Talk::Holding);
            bytes.extend(b"\x91!?");
            return;
        }
        while let Some(line) = self.lines.front()
            && self.open.iter().sum::<usize>() + line.len() < WINDOW
        {
            bytes.extend(line.bytes().chain([b'\n']));
            self.open.push_back(line.len() + 1);
            self.lines.pop_front();
        }
        if self.lines.is_empty() && self.open.is_empty() {
            self.step = Talk::Ending;
            bytes.push(b'?');
        }
    }

    /// A report has arrived: the next step, or the next report.
    fn report(&mut self, line: &str, bytes: &mut Vec<u8>) {
        self.reports += 1;
        if self.reports > REPORTS {
            return self.fail(format!("still {line}"), bytes);
        }
        let state = line.trim_start_matches('<').split('|').next().unwrap_or_default();
        let [x, y, z] = END;
        let end = format!("|MPos:{x:.3},{y:.3},{z:.3}|");
        match (self.step, state) {
            (Talk::Holding, "Hold:0") => {
                self.step = Talk::Sending;
                bytes.push(b'~');
            }
            (Talk::Ending, "Idle") if !line.contains(&end) => {
                self.fail(format!("the end is {line}, wanted {end}"), bytes);
            }
            (Talk::Ending, "Idle") => {
                self.step = Talk::Jogging;
                self.open.push_back(0);
                // The jog is cancelled; the axis goes back.
                bytes.extend(b"$J=G91X50F1000\n");
            }
            (Talk::Jogging, "Jog") if !self.cancelled => {
                self.cancelled = true;
                bytes.extend(b"\x85?");
            }
            (Talk::Jogging, "Idle") if line.contains(&end) && self.cancelled => {
                self.step = Talk::Asleep;
                self.open.push_back(0);
                bytes.extend(b"$SLP\n");
            }
            (Talk::Jogging, "Idle") if self.cancelled => {
                self.open.push_back(0);
                bytes.extend(format!("$J=G90X{x}F6000\n").bytes());
            }
            _ => bytes.push(b'?'),
        }
    }
}
