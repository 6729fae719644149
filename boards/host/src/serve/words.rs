//! Words of Grbl that the decoder has under other names, and the modal words that a line leaves.
use glidepath::quantity::{Feed, Position};
use glidepath_controller::{Modal, Spindle};

/// A word: letter and number as text.
pub fn words(line: &[u8]) -> Vec<(u8, String)> {
    let mut words: Vec<(u8, String)> = Vec::new();
    for byte in line {
        match words.last_mut() {
            Some((_, number)) if byte.is_ascii_digit() || b"+-.".contains(byte) => {
                number.push(char::from(*byte))
            }
            _ => words.push((*byte, String::new())),
        }
    }
    words
}

/// The number of a word, in tenths.
fn tenths(number: &str) -> Option<i64> {
    number.parse::<f64>().ok().map(|value| (value * 10.0).round() as i64)
}

/// Whether a line is answered at rest: senders wait for the end of a motion by `G4`.
pub fn synchronises(line: &[u8]) -> bool {
    words(line).iter().any(|(letter, number)| match letter {
        b'G' => tenths(number) == Some(40),
        b'M' => matches!(tenths(number), Some(0 | 10 | 20 | 300)),
        _ => false,
    })
}

/// The line in the decoder's words. Lines that are no words (`#`, `$`, expressions) stay as they are.
pub fn translated(line: &[u8]) -> Vec<u8> {
    if line.iter().any(|byte| !byte.is_ascii_alphanumeric() && !b"+-.".contains(byte)) {
        return line.to_vec();
    }
    let words = words(line);
    let is_dwell = words.iter().any(|(letter, number)| *letter == b'G' && tenths(number) == Some(40));
    let mut out = String::new();
    for (letter, number) in &words {
        match (letter, tenths(number)) {
            (b'G', Some(200)) => out += "G70 ",
            (b'G', Some(210)) => out += "G71 ",
            // No cutter radius, no tool length, no cycle: so it is here.
            (b'G', Some(400 | 490 | 800)) => {}
            (b'G', Some(40)) => out += "G04 ",
            (b'P', _) if is_dwell => out += &format!("{number} "),
            _ => out += &format!("{}{number} ", char::from(*letter)),
        }
    }
    out.into_bytes()
}

/// What a line that was taken leaves in force.
pub fn note(line: &[u8], modal: &mut Modal) {
    for (letter, number) in words(line) {
        let Some(value) = tenths(&number) else { continue };
        match (letter, value) {
            (b'G', 0 | 10 | 20 | 30) => modal.motion = (value / 10) as u16,
            (b'G', 170 | 180 | 190) => modal.plane = (value / 10) as u8,
            (b'G', 200 | 700) => modal.inch = true,
            (b'G', 210 | 710) => modal.inch = false,
            (b'G', 540 | 550 | 560 | 570 | 580 | 590) => modal.system = (value / 10) as u8,
            (b'G', 900) => modal.incremental = false,
            (b'G', 910) => modal.incremental = true,
            (b'M', 30) => modal.spindle = Spindle::Clockwise,
            (b'M', 40) => modal.spindle = Spindle::CounterClockwise,
            (b'M', 50) => modal.spindle = Spindle::Off,
            (b'M', 70) => modal.mist = true,
            (b'M', 80) => modal.flood = true,
            (b'M', 90) => (modal.mist, modal.flood) = (false, false),
            (b'S', rpm) => modal.rpm = (rpm / 10).max(0) as u32,
            (b'T', tool) => modal.tool = (tool / 10).max(0) as u32,
            (b'F', _) => {
                let unit = if modal.inch { 25.4 } else { 1.0 };
                modal.feed = Feed::saturating_from_num(number.parse::<f64>().unwrap_or(0.0) * unit);
            }
            _ => {}
        }
    }
}

/// A line that puts these words in force.
pub fn in_force(modal: &Modal) -> String {
    let units = if modal.inch { 70 } else { 71 };
    let distance = if modal.incremental { 91 } else { 90 };
    let motion = if modal.motion == 0 { 0 } else { 1 };
    let feed = if modal.feed > Feed::ZERO {
        // In the unit of the line.
        let unit = if modal.inch { 25.4 } else { 1.0 };
        format!(" F{:.6}", modal.feed.to_num::<f64>() / unit)
    } else {
        String::new()
    };
    format!("G0{motion} G{} G{} G{units} G{distance}{feed}", modal.plane, modal.system)
}

/// A position as text, with all its digits.
pub fn decimal(position: Position) -> String {
    format!("{position}")
}
