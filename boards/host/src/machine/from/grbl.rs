//! Grbl's settings, as in the answer to `$$`.
use super::ramp;
use crate::diagnose::{Diagnostic, Source};
use crate::machine::sheet::{Axis, Sheet, Taken};

/// Letters of the axes in the order of Grbl's numbers.
const LETTERS: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

/// A setting: number, value, place.
struct Setting {
    number: u32,
    value: f64,
    line: usize,
    /// `$110=500.000`
    text: String,
}

/// Number and value of a line `$110=500.000 (x max rate, mm/min)`.
fn parts(line: &str) -> Option<(&str, &str)> {
    let (number, value) = line.trim().strip_prefix('$')?.split_once('=')?;
    let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| (number, value.split(['(', ';', ' ']).next().unwrap_or_default()))
}

/// Whether a line is a setting.
pub fn is_setting(line: &str) -> bool {
    parts(line).is_some()
}

/// Settings without a place in machine data, and the reason: first and last number.
const LEFT: &[(u32, u32, &str)] = &[
    (1, 1, "a motor that is switched off stands elsewhere"),
    (4, 6, "pins of the board"),
    (10, 10, "reports to a sender"),
    (11, 11, "the tolerance of corners: #CONTOUR MODE [DEV PATH_DEV=…] in a program, or --smooth"),
    (12, 12, "the tolerance of arcs: arcs stay arcs here"),
    (13, 13, "unit of reports to a sender"),
    (14, 19, "pins of the board"),
    (21, 29, "switches and homing, for `serve`"),
    (30, 39, "spindle and laser: S is a function of the program"),
];

/// Converts a list of settings to a machine.
///
/// # Errors
/// A value is no number, or an axis has only a part of its settings.
pub fn read(source: &Source) -> Result<Sheet, Vec<Diagnostic>> {
    let mut refused = Vec::new();
    let mut settings: Vec<Setting> = Vec::new();
    let text = String::from_utf8_lossy(&source.text).into_owned();
    for (index, line) in text.lines().enumerate() {
        let Some((number, value)) = parts(line) else { continue };
        let column = line.find('=').map_or(1, |at| at + 2);
        match (number.parse(), value.parse::<f64>().ok().filter(|value| value.is_finite())) {
            (Ok(number), Some(amount)) => {
                let text = format!("${number}={value}");
                settings.retain(|known| known.number != number);
                settings.push(Setting { number, value: amount, line: index + 1, text });
            }
            _ => refused.push(
                Diagnostic::error(format!("${number}={value}: no number"))
                    .at(source, index + 1, column, value.len())
                    .expected("a number, as in $110=500.000"),
            ),
        }
    }
    let find = |number: u32| settings.iter().find(|setting| setting.number == number);
    let take = |number: u32, scale: f64, unit: &str| {
        find(number).map(|setting| Taken::new(setting.value * scale, format!("{} {unit}", setting.text)))
    };
    let is_on = |number: u32, bit: usize| find(number).is_some_and(|set| (set.value as u32) >> bit & 1 == 1);
    let mut axes = Vec::new();
    for (index, letter) in LETTERS.iter().enumerate() {
        let k = index as u32;
        let all = [take(110 + k, 1.0 / 60.0, "mm/min"), take(120 + k, 1.0, "mm/s²")];
        let (Some(speed), Some(acceleration)) = (&all[0], &all[1]) else {
            if let (Some(_), number) | (None, number) = (&all[0], 120 + k)
                && all.iter().any(Option::is_some)
            {
                let number = if all[0].is_some() { number } else { 110 + k };
                let message = format!("{}: axis {letter} has no ${number}", source.name);
                refused.push(Diagnostic::error(message).expected(format!("${number}=…, as Grbl lists it")));
            }
            continue;
        };
        for (taken, number) in [(speed, 110 + k), (acceleration, 120 + k)] {
            if let (true, Some(setting)) = (taken.value <= 0.0, find(number)) {
                let error = Diagnostic::error(format!("{}: out of range", setting.text));
                let column = setting.text.find('=').map_or(1, |at| at + 2);
                refused.push(
                    error
                        .at(source, setting.line, column, setting.text.len() + 1 - column)
                        .expected("a number above 0"),
                );
            }
        }
        let limits = is_on(20, 0).then(|| find(130 + k)).flatten();
        let travel = limits.filter(|travel| travel.value > 0.0).map(|travel| {
            let from = format!("{} with $20=1: Grbl counts from 0 down", travel.text);
            [Taken::new(-travel.value, from), Taken::new(0.0, "")]
        });
        let steps = take(100 + k, 1000.0, "steps/mm").filter(|counts| counts.value >= 1.0);
        let steps = steps.map_or_else(Vec::new, |counts| {
            let inverted =
                |number| Taken::new(f64::from(u8::from(is_on(number, index))), format!("${number}"));
            let pulse = take(0, 1000.0, "µs");
            let mut keys = vec![
                ("steps.counts", counts),
                ("steps.length", Taken::new(1000.0, "mm for these counts")),
                ("steps.step", Taken::new(2.0 * k as f64, "chosen")),
                ("steps.direction", Taken::new(2.0 * k as f64 + 1.0, "chosen")),
                ("steps.step_inverted", inverted(2)),
                ("steps.direction_inverted", inverted(3)),
            ];
            keys.extend(pulse.map(|pulse| ("steps.pulse_ns", pulse)));
            keys
        });
        axes.push(Axis {
            name: (*letter).into(),
            rotary: k > 2,
            rapid: speed.clone(),
            speed: speed.clone(),
            acceleration: acceleration.clone(),
            ramp: ramp("Grbl"),
            travel,
            steps,
        });
    }
    if !refused.is_empty() {
        return Err(refused);
    }
    let mut left: Vec<String> = Vec::new();
    for setting in &settings {
        let reason = LEFT.iter().find(|(first, last, _)| (*first..=*last).contains(&setting.number));
        if let Some((.., reason)) = reason {
            left.push(format!("{}: {reason}", setting.text));
        } else if setting.number > 135 || (40..100).contains(&setting.number) {
            left.push(format!("{}: not a setting of Grbl 1.1", setting.text));
        } else if (130..136).contains(&setting.number) && !is_on(20, 0) {
            left.push(format!("{}: travel, which counts only with $20=1", setting.text));
        }
    }
    Ok(Sheet {
        title: vec![format!("From the Grbl settings {}.", source.name)],
        cycle: Some(Taken::new(1000.0, "chosen: Grbl has no cycle")),
        dialect: Some(("grbl", "the language of its programs".into())),
        axes,
        left,
    })
}
