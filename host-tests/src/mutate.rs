//! Lines of all dialects with changed, missing and doubled letters. The decoder must finish each line, and
//! must use or refuse each value. A value is used if its change changes the result of the line.
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, Dialect, MachineData, ToolLengths};
use glidepath::nc::{Command, Decoder, DecoderMemory, NcErrorKind, Setup, Step};
use glidepath::quantity::Position;

/// Parts of lines.
const WORDS: &[&str] = &[
    "G0",
    "G1",
    "G2",
    "G3",
    "G4",
    "G7",
    "G8",
    "G9",
    "G10 L2",
    "G10 L20",
    "G17",
    "G18",
    "G20",
    "G21",
    "G28",
    "G28.1",
    "G30",
    "G38.2",
    "G40",
    "G43",
    "G43.1",
    "G44",
    "G49",
    "G52",
    "G53",
    "G54",
    "G55",
    "G59.1",
    "G61",
    "G61.1",
    "G64",
    "G70",
    "G71",
    "G73",
    "G74",
    "G80",
    "G81",
    "G82",
    "G83",
    "G84",
    "G85",
    "G86",
    "G89",
    "G90",
    "G91",
    "G92",
    "G92.1",
    "G93",
    "G94",
    "G95",
    "G96",
    "G97",
    "G98",
    "G99",
    "G5.1",
    "G261",
    "G131",
    "M0",
    "M1",
    "M2",
    "M3",
    "M4",
    "M5",
    "M6",
    "M7",
    "M8",
    "M9",
    "M19",
    "M29",
    "M30",
    "M48",
    "M49",
    "M50",
    "M61",
    "M62",
    "M64",
    "M66",
    "M67",
    "M68",
    "M70",
    "M71",
    "M72",
    "M73",
    "M98",
    "M99",
    "M100",
    "X1.5",
    "X-2",
    "Y3.25",
    "Y.5",
    "Z-1",
    "Z2.5",
    "A5",
    "I1",
    "I-2.5",
    "J0.5",
    "J3",
    "K2",
    "R2",
    "R5.5",
    "P1",
    "P0.5",
    "P2000",
    "Q0.5",
    "Q1",
    "L1",
    "L2",
    "L3",
    "H1",
    "H2",
    "D1",
    "D2.5",
    "E1",
    "E0",
    "F100",
    "F12.5",
    "S500",
    "S10",
    "T1",
    "T2",
    "N10",
    "U1",
    "V2",
    "C3",
    "O100",
    "o1 sub",
    "o1 endsub",
    "o1 call [2]",
    "o2 if [#1 GT 0]",
    "o2 else",
    "o2 endif",
    "o3 repeat [2]",
    "o3 endrepeat",
    "o4 while [#5 LT 2]",
    "#5=[#5+1]",
    "o4 endwhile",
    "#<a>=3",
    "X#<a>",
    "X[1+2*3]",
    "Y[SIN[30]]",
    "ZATAN[1]/[2]",
    "#1=2",
    "X#1",
    "P1=5",
    "V.P.A=1",
    "$IF P1==2",
    "$ENDIF",
    "#HSC ON",
    "#SLOPE [TYPE=STEP]",
    "X[OSC ON]",
    "(MSG, text)",
    "(note)",
    "; rest",
    "%",
    "%name",
    "/",
    "/2",
    ":7",
    "*57",
    "$H",
    "$0",
    "$G",
    "LL name",
];

/// A generator of numbers: xorshift.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((u128::from(self.0) * n as u128) >> 64) as usize
    }
}

/// Results.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Lines that the decoder accepts.
    pub accepted: u64,
    /// Values whose use was checked.
    pub values: u64,
    /// Lines with a value without effect, and the value.
    pub silent: Vec<String>,
}

fn setup(dialect: Dialect) -> Setup<3> {
    let axis = |name| AxisData::new(AxisName::new(name).expect("a name"), AxisKind::Linear);
    let mut machine = MachineData { axes: ["X", "Y", "Z"].map(axis), channel: ChannelData::new() };
    machine.channel.foreign.dialect = dialect;
    machine.channel.foreign.tools = ToolLengths::NONE.with(1, 100_000).with(2, 200_000).with(3, 300_000);
    Setup::new(&machine, [Position::ZERO; 3])
}

fn line(random: &mut Random) -> String {
    let mut text = String::new();
    for _ in 0..random.below(6) + 1 {
        text.push_str(WORDS[random.below(WORDS.len())]);
        text.push_str(["", " "][random.below(2)]);
    }
    let mut bytes = text.into_bytes();
    for _ in 0..[0, 0, 1, 2, 4][random.below(5)] {
        let at = random.below(bytes.len().max(1));
        match random.below(4) {
            _ if bytes.is_empty() => {}
            0 => _ = bytes.remove(at),
            1 => bytes.insert(at, bytes[at]),
            2 => bytes[at] = b' ' + random.below(95) as u8,
            _ => bytes[at] = b"0.-+#[]GMXO=*/"[random.below(14)],
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Commands without their places, and the modal state after them; `None` if a line is refused.
fn meaning(memory: &mut DecoderMemory<3>, setup: Setup<3>, text: &str) -> (Option<Vec<String>>, bool) {
    let mut decoder: Decoder<_, 3> = Decoder::new(memory, setup, text.as_bytes());
    let (mut told, mut made) = (false, Vec::new());
    for _ in 0..5_000 {
        match decoder.step() {
            Ok(Step::Command(Command::Motion(motion))) => {
                let bits = motion.target.map(|place| place.to_bits());
                let feed = motion.feed.to_bits();
                made.push(format!("{:?} {bits:?} {feed} {}", motion.kind, motion.exact_stop));
            }
            Ok(Step::Command(command)) => {
                let text = format!("{command:?}");
                // Without the head, which holds the place.
                made.push(
                    text.split_once("in_motion")
                        .map_or(text.clone(), |(_, rest)| format!("{} {rest}", command.name())),
                );
            }
            Ok(Step::Warning(warning)) => told |= warning.place.line == HEAD_LINES + 1,
            Ok(Step::End) => break,
            Ok(_) => {}
            Err(_) => return (None, told),
        }
    }
    // G54 to G59 too where G91 holds behind the line, or the program has ended.
    let zero = decoder.stored().zero;
    made.push(format!("{:?}", zero.map(|places| places.map(|place| place.to_bits()))));
    if let Some(force) = decoder.in_force() {
        let of = |places: [Position; 3]| places.map(|place| place.to_bits());
        let (feed, speed) = (force.feed().to_bits(), force.speed().to_bits());
        made.push(format!("{} {feed} {speed} {}", force.motion(), force.tool()));
        made.push(format!("{:?} {:?}", of(force.here()), of(force.tool_length())));
    }
    (Some(made), told)
}

/// Lines before the one that is looked at.
const HEAD_LINES: u32 = 3;

/// A whole text of such lines: refused lines are skipped. The decoder must finish the text.
fn run(memory: &mut DecoderMemory<3>, setup: Setup<3>, text: &str) -> u64 {
    let mut decoder: Decoder<_, 3> = Decoder::new(memory, setup, text.as_bytes());
    let mut refused = 0;
    for _ in 0..5_000 {
        match decoder.step() {
            Ok(Step::End) if decoder.is_refused() => decoder.go_on(decoder.position()),
            Ok(Step::End) => break,
            Ok(_) => {}
            Err(error) => {
                // A message is a sentence.
                assert!(error.kind == NcErrorKind::Endless || !error.to_string().is_empty());
                refused += 1;
            }
        }
    }
    refused
}

/// Letters and numbers of a line that contains nothing else: places of the numbers.
fn values(line: &str) -> Vec<(char, std::ops::Range<usize>)> {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+' | ' ');
    if !line.chars().all(plain) {
        return Vec::new();
    }
    let mut found = Vec::new();
    let bytes = line.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        let end = (at + 1..bytes.len()).find(|&k| bytes[k].is_ascii_alphabetic()).unwrap_or(bytes.len());
        if bytes[at].is_ascii_alphabetic() {
            found.push((char::from(bytes[at].to_ascii_uppercase()), at + 1..end));
        }
        at = end;
    }
    found
}

/// Values without effect in the dialect's original controller too, according to docs/dialects.md.
fn may_rest(dialect: Dialect, letter: char, words: &[(char, String)]) -> bool {
    let has = |letter: char, number: &str| {
        let same = |n: &str| n.parse::<f64>().ok() == number.parse().ok();
        words.iter().any(|(l, n)| *l == letter && same(n))
    };
    match letter {
        // Fractions of line numbers; words whose meaning is their number.
        'N' | 'O' | 'G' | 'M' => true,
        // Without axes nothing is stored.
        'P' | 'L' if has('G', "10") && !words.iter().any(|(l, _)| matches!(l, 'X' | 'Y' | 'Z')) => true,
        // P0 is the zero offset in force, here that of P1.
        'P' => has('G', "10") && has('P', "0"),
        'Q' => has('M', "66") || has('G', "73") || has('G', "83"),
        'D' => dialect.is_fanuc() || has('G', "73"),
        'F' => has('G', "93"),
        'H' => dialect.is_fanuc(),
        'I' | 'J' | 'K' => dialect != Dialect::LinuxCnc,
        'S' => has('G', "96"),
        _ => false,
    }
}

/// Looks through lines number `first` to `first + count` of a dialect.
pub fn search(dialect: Dialect, first: u64, count: u64) -> Found {
    const BEHIND: &str = "G0 X7.75 Y7.5 Z7.25\nG54 X1.5 Y1.5 Z1.5\nG55 X1.5 Y1.5 Z1.5\nG56 X1.5 Y1.5\nG57 X1.5 Y1.5 Z1.5\nG58 X1.5 Y1.5 Z1.5\nG59 X1.5 Y1.5 Z1.5\nG28 X2.5 Y2.5 Z2.5\nG30 X0.5 Y0.5 Z0.5";
    let setup = setup(dialect);
    let mut memory = DecoderMemory::new();
    let mut found = Found::default();
    let mut text = String::new();
    for number in first..first + count {
        let mut random = Random((number + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        for _ in 0..3 {
            random.below(2);
        }
        let line = line(&mut random);
        text.push_str(&line);
        text.push('\n');
        if number % 16 == 15 || number + 1 == first + count {
            run(&mut memory, setup, &text);
            text.clear();
        }
        if dialect == Dialect::Isg || number % 4 != 0 {
            continue;
        }
        let program =
            |line: &str| format!("G21 G90 G54\nM3 S500 F100.\nG0 X0.5 Y0.5 Z0.5\n{line}\n{BEHIND}\n");
        let values = values(&line);
        if values.is_empty() {
            continue;
        }
        let (Some(meant), told) = meaning(&mut memory, setup, &program(&line)) else { continue };
        found.accepted += 1;
        let words: Vec<_> =
            values.iter().map(|(letter, at)| (*letter, line[at.clone()].replace(' ', ""))).collect();
        for ((letter, at), (_, old)) in values.iter().zip(&words) {
            let Ok(value) = old.parse::<f64>() else { continue };
            if told || may_rest(dialect, *letter, &words) {
                continue;
            }
            let point = old.contains('.') || matches!(letter, 'X' | 'Y' | 'Z' | 'F' | 'R');
            // The first change would give 0.75 again.
            let value = if value == 0.75 { value + 1.0 } else { value };
            let new = if point { format!("{:.3}", value * 0.5 + 0.375) } else { format!("{}", value + 1.0) };
            let changed = format!("{}{new}{}{}", &line[..at.start], " ", &line[at.end..]);
            found.values += 1;
            if meaning(&mut memory, setup, &program(&changed)).0.as_ref() == Some(&meant) {
                found.silent.push(format!("{}: {line:?}: {letter}{old}", dialect.name()));
            }
        }
    }
    found
}
