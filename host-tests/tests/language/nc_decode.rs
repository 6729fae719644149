//! The decoder's full output for a program.
#![allow(dead_code, reason = "every test binary uses its part")]
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::nc::{Command, Decoder, DecoderMemory, Motion, NcError, NcWarning, Setup, Step, Text};
use glidepath::quantity::Position;

/// X, Y, Z linear, A, C rotary.
pub type Commands = Vec<Command<5>>;

pub struct Decoded {
    pub commands: Commands,
    pub warnings: Vec<NcWarning>,
    pub error: Option<NcError>,
    pub steps: usize,
}

pub fn setup() -> Setup<5> {
    let axes = [('X', false), ('Y', false), ('Z', false), ('A', true), ('C', true)].map(|(name, rotary)| {
        let kind = if rotary { AxisKind::Rotary } else { AxisKind::Linear };
        AxisData::new(AxisName::new(&name.to_string()).unwrap(), kind)
    });
    Setup::new(&MachineData { axes, channel: ChannelData::new() }, [Position::ZERO; 5])
}

pub fn decode_text<const AXES: usize>(
    setup: Setup<AXES>,
    text: impl Text,
    limit: usize,
) -> (Vec<Command<AXES>>, Vec<NcWarning>, Option<NcError>, usize) {
    let mut memory = DecoderMemory::new();
    let mut decoder: Decoder<_, AXES> = Decoder::new(&mut memory, setup, text);
    let (mut commands, mut warnings) = (Vec::new(), Vec::new());
    for steps in 1..=limit {
        match decoder.step() {
            Ok(Step::Working | Step::Late) => {}
            Ok(Step::Command(command)) => commands.push(command),
            Ok(Step::Warning(warning)) => warnings.push(warning),
            Ok(Step::End) => return (commands, warnings, None, steps),
            Err(error) => {
                assert_eq!(decoder.step(), Ok(Step::End), "only the end follows an error");
                return (commands, warnings, Some(error), steps);
            }
        }
    }
    (commands, warnings, None, limit)
}

/// The same for bytes that are all there.
pub fn decode_with<const AXES: usize>(
    setup: Setup<AXES>,
    text: &[u8],
    limit: usize,
) -> (Vec<Command<AXES>>, Vec<NcWarning>, Option<NcError>, usize) {
    decode_text(setup, text, limit)
}

/// Decodes to the end; programs here take far fewer than a million steps.
pub fn decode(text: &str) -> Decoded {
    let (commands, warnings, error, steps) = decode_with(setup(), text.as_bytes(), 1_000_000);
    assert!(steps < 1_000_000, "no end in sight");
    Decoded { commands, warnings, error, steps }
}

/// Decodes a program that must be accepted.
pub fn commands(text: &str) -> Commands {
    let decoded = decode(text);
    if let Some(error) = decoded.error {
        panic!("{}:{}: {error}\n{text}", error.place.line, error.place.column);
    }
    decoded.commands
}

/// The motions of a program that must be accepted.
pub fn motions(text: &str) -> Vec<Motion<5>> {
    let motion = |c: Command<5>| if let Command::Motion(m) = c { Some(m) } else { None };
    commands(text).into_iter().filter_map(motion).collect()
}

/// N number and end point (first three axes) of every motion.
pub fn ends(text: &str) -> Vec<(u32, [f64; 3])> {
    motions(text).iter().map(|m| (m.n, [0, 1, 2].map(|i| m.target[i].to_num()))).collect()
}

/// The refusal of a program.
pub fn error(text: &str) -> NcError {
    decode(text).error.unwrap_or_else(|| panic!("accepted: {text}"))
}

/// The value of an expression, all 64 bits: PARAM of the contour log carries it.
pub fn value(expression: &str) -> f64 {
    let text = format!("#CONTOUR LOOKAHEAD LOG [PARAM={expression}]");
    match commands(&text)[..] {
        [Command::ContourLog(_, glidepath::nc::ContourLog::Parameter(value))] => value,
        ref other => panic!("{other:?}"),
    }
}

/// xorshift64*: seeded, the same everywhere.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    pub fn below(&mut self, n: u64) -> u64 {
        ((u128::from(self.next()) * u128::from(n)) >> 64) as u64
    }
}
