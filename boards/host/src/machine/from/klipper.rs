//! A Klipper printer.cfg.
use super::ini::{Ini, Style};
use super::ramp;
use crate::diagnose::{Diagnostic, Source};
use crate::machine::sheet::{Axis, Sheet, Taken};

/// Reasons for which keys of the printer and its steppers are not converted.
const REASONS: &[(&str, &str)] = &[
    ("square_corner_velocity", "corners: #CONTOUR MODE [DEV PATH_DEV=…] in a program, or --smooth"),
    ("minimum_cruise_ratio", "short moves: the slope limits them here"),
    ("max_accel_to_decel", "short moves: the slope limits them here"),
    ("kinematics", "X, Y and Z are axes here, whatever drives them"),
    ("endstop", "homing"),
    ("homing", "homing"),
    ("position_endstop", "homing"),
    ("second_homing", "homing"),
    ("enable_pin", "pins of the board"),
    ("step_pin", "pins of the board: chosen below"),
];

/// Converts a configuration to a machine.
///
/// # Errors
/// A value is no number, a value is missing, or the printer has unsupported kinematics.
pub fn read(source: &Source) -> Result<Sheet, Vec<Diagnostic>> {
    let ini = Ini::read(source, Style::Klipper);
    let kinematics = ini.get("printer", "kinematics");
    let is_direct = kinematics.is_none_or(|entry| entry.value.eq_ignore_ascii_case("cartesian"));
    if let Some(entry) = kinematics {
        let known = ["cartesian", "corexy", "corexz", "hybrid_corexy", "hybrid_corexz", "none"];
        if !known.contains(&entry.value.to_lowercase().as_str()) {
            ini.refuse(entry, "its motors are no axes", "cartesian or corexy kinematics");
        }
    }
    let speed = ini.positive("printer", "max_velocity");
    let acceleration = ini.positive("printer", "max_accel");
    if speed.is_none() {
        ini.missing("printer", "max_velocity", "mm/s");
    }
    if acceleration.is_none() {
        ini.missing("printer", "max_accel", "mm/s²");
    }
    let z_speed = ini.positive("printer", "max_z_velocity").or_else(|| speed.clone());
    let z_acceleration = ini.positive("printer", "max_z_accel").or_else(|| acceleration.clone());
    let axes: Vec<Axis> = ["x", "y", "z"]
        .into_iter()
        .enumerate()
        .filter(|(_, letter)| ini.has(&format!("stepper_{letter}")))
        .filter_map(|(index, letter)| {
            let z = letter == "z";
            let of = |own: &Option<Taken>, of_z: &Option<Taken>| if z { of_z.clone() } else { own.clone() };
            let speed = of(&speed, &z_speed)?;
            let section = format!("stepper_{letter}");
            let least = ini.number(&section, "position_min");
            let least = least.unwrap_or_else(|| Taken::new(0.0, "Klipper's default of position_min"));
            let most = ini.number(&section, "position_max");
            // If motors drive two axes together, no axis has counts of its own.
            let has_counts = is_direct || z;
            Some(Axis {
                name: letter.to_uppercase(),
                rotary: false,
                rapid: speed.clone(),
                speed,
                acceleration: of(&acceleration, &z_acceleration)?,
                ramp: ramp("Klipper"),
                travel: most.map(|most| [least, most]),
                steps: if has_counts { steps(&ini, letter, index) } else { Vec::new() },
            })
        })
        .collect();
    let refused = ini.refusals();
    if !refused.is_empty() {
        return Err(refused);
    }
    let mut left = ini.left(&["printer", "stepper_"], REASONS);
    if !is_direct {
        left.push("steps per mm of X and Y: each of their motors drives both".into());
    }
    Ok(Sheet {
        title: vec![format!("From the Klipper configuration {}.", source.name)],
        cycle: Some(Taken::new(1000.0, "chosen: Klipper has no cycle")),
        dialect: None,
        axes,
        left,
    })
}

/// The product of ratios such as `80:20, 2:1`.
fn ratio(text: &str) -> Option<f64> {
    text.split(',').try_fold(1.0, |product, part| {
        let (one, other) = part.split_once(':')?;
        let [one, other] = [one, other].map(|part| part.trim().parse::<f64>().ok());
        let ratio = one? / other?;
        (ratio.is_finite() && ratio > 0.0).then_some(product * ratio)
    })
}

/// The step output of a stepper, and of a second stepper.
fn steps(ini: &Ini<'_>, letter: &str, index: usize) -> Vec<(&'static str, Taken)> {
    let section = format!("stepper_{letter}");
    let (Some(distance), Some(micro)) =
        (ini.positive(&section, "rotation_distance"), ini.positive(&section, "microsteps"))
    else {
        return Vec::new();
    };
    let full = ini.positive(&section, "full_steps_per_rotation").map_or(200.0, |full| full.value);
    let gear = match ini.get(&section, "gear_ratio") {
        None => 1.0,
        Some(entry) => ratio(&entry.value).unwrap_or_else(|| {
            ini.refuse(entry, "no ratio", "two numbers with a colon, for example 80:20");
            1.0
        }),
    };
    let counts = full * micro.value * gear;
    let inverted = |section: &str, key: &str| {
        let pin = ini.get(section, key);
        pin.map(|pin| {
            let value = f64::from(u8::from(pin.value.contains('!')));
            Taken::new(value, format!("{key} = {}", pin.value))
        })
    };
    // Counts in a length of whole mm, 1 m of it.
    let counts = (counts / distance.value * 1000.0).round();
    let from = format!("rotation_distance, microsteps {} and steps of a turn {full}", micro.value);
    let pin = 4.0 * index as f64;
    let mut keys = vec![
        ("steps.counts", Taken::new(counts, from)),
        ("steps.length", Taken::new(1000.0, "mm for these counts")),
        ("steps.step", Taken::new(pin, "chosen")),
        ("steps.direction", Taken::new(pin + 1.0, "chosen")),
    ];
    keys.extend(inverted(&section, "step_pin").map(|taken| ("steps.step_inverted", taken)));
    keys.extend(inverted(&section, "dir_pin").map(|taken| ("steps.direction_inverted", taken)));
    let second = format!("stepper_{letter}1");
    if ini.has(&second) {
        keys.push(("steps.step_2", Taken::new(pin + 2.0, "chosen, for the second motor")));
        keys.push(("steps.direction_2", Taken::new(pin + 3.0, "chosen")));
        keys.extend(inverted(&second, "step_pin").map(|taken| ("steps.step_2_inverted", taken)));
        keys.extend(inverted(&second, "dir_pin").map(|taken| ("steps.direction_2_inverted", taken)));
    }
    let pulse = ini.positive(&section, "step_pulse_duration");
    keys.extend(pulse.map(|pulse| ("steps.pulse_ns", Taken::new(pulse.value * 1e9, pulse.from))));
    keys
}
