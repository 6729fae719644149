//! A LinuxCNC INI file.
use super::ini::{Ini, Style};
use super::ramp;
use crate::diagnose::{Diagnostic, Source};
use crate::machine::sheet::{Axis, Sheet, Taken};

/// Reasons for which keys of the axis sections are not converted.
const REASONS: &[(&str, &str)] = &[
    ("HOME", "homing"),
    ("FERROR", "position control"),
    ("MIN_FERROR", "position control"),
    ("STEPGEN_MAX", "room for the step generator of LinuxCNC"),
    ("DEFAULT_", "speed of jogging"),
    ("MIN_", "speed of jogging"),
    ("KINEMATICS", "axes move as they are: joints are taken in the order of COORDINATES"),
    ("ARC_BLEND", "corners: #CONTOUR MODE [DEV PATH_DEV=…] in a program, or G64 P"),
    ("BASE_PERIOD", "steps are words of a timer here"),
    ("COMP_FILE", "compensation of the screw"),
];

/// Letters of a text such as `X Y Z` or `XYZ`, each once.
fn letters(text: &str) -> Vec<char> {
    let mut all: Vec<char> = Vec::new();
    for letter in text.to_uppercase().chars().filter(char::is_ascii_alphabetic) {
        if !all.contains(&letter) {
            all.push(letter);
        }
    }
    all
}

/// Converts an INI file to a machine.
///
/// # Errors
/// A value is no number or missing.
pub fn read(source: &Source) -> Result<Sheet, Vec<Diagnostic>> {
    let ini = Ini::read(source, Style::LinuxCnc);
    let unit = match ini.get("TRAJ", "LINEAR_UNITS") {
        Some(entry) if ["inch", "in", "imperial"].contains(&entry.value.to_lowercase().as_str()) => 25.4,
        Some(entry) if ["mm", "metric"].contains(&entry.value.to_lowercase().as_str()) => 1.0,
        Some(entry) => {
            ini.refuse(entry, "an unknown unit", "mm or inch");
            1.0
        }
        None => {
            ini.missing("TRAJ", "LINEAR_UNITS", "mm or inch");
            1.0
        }
    };
    let _ = ini.get("TRAJ", "ANGULAR_UNITS");
    let joints = ini.get("KINS", "JOINTS").map(|entry| entry.value.clone());
    let coordinates = ini.get("TRAJ", "COORDINATES").map(|entry| entry.value.clone());
    // A letter for each joint: of a gantry one letter has two.
    let kinematics = ini.get("KINS", "KINEMATICS").map(|entry| entry.value.to_uppercase());
    let of_joints = kinematics.and_then(|text| {
        let (_, rest) = text.split_once("COORDINATES=")?;
        rest.split_whitespace().next().map(str::to_owned)
    });
    let of_joints: Vec<char> = of_joints
        .or_else(|| coordinates.clone())
        .unwrap_or_else(|| "XYZ".into())
        .to_uppercase()
        .chars()
        .filter(char::is_ascii_alphabetic)
        .collect();
    let axes: Vec<Axis> = letters(coordinates.as_deref().unwrap_or("XYZ"))
        .into_iter()
        .filter_map(|letter| {
            let joint = of_joints.iter().position(|other| *other == letter)?;
            axis(&ini, letter, joint, unit)
        })
        .collect();
    let cycle = ini.positive("EMCMOT", "SERVO_PERIOD");
    let cycle = cycle.map(|period| Taken::new(period.value / 1000.0, period.from));
    let cycle = cycle.or_else(|| Some(Taken::new(1000.0, "chosen: the file has no SERVO_PERIOD")));
    let refused = ini.refusals();
    if !refused.is_empty() {
        return Err(refused);
    }
    let mut left = ini.left(&["TRAJ", "AXIS_", "JOINT_", "EMCMOT", "KINS"], REASONS);
    if let Some(joints) =
        joints.filter(|joints| joints.parse::<usize>().is_ok_and(|count| count > axes.len()))
    {
        left.push(format!("joints beyond the first of each axis: {joints} joints, {} axes", axes.len()));
    }
    Ok(Sheet {
        title: vec![format!("From the LinuxCNC file {}.", source.name)],
        cycle,
        dialect: Some(("linuxcnc", "the language of its programs".into())),
        axes,
        left,
    })
}

/// An axis with its first joint.
fn axis(ini: &Ini<'_>, letter: char, joint: usize, unit: f64) -> Option<Axis> {
    let (own, of_joint) = (format!("AXIS_{letter}"), format!("JOINT_{joint}"));
    // Before version 2.8 the sections of joints had this name.
    let old = format!("AXIS_{joint}");
    let sections = [&own, &of_joint, &old];
    let kind = sections.iter().find_map(|section| ini.get(section, "TYPE"));
    let rotary = kind.map_or("ABC".contains(letter), |kind| kind.value.eq_ignore_ascii_case("ANGULAR"));
    let unit = if rotary { 1.0 } else { unit };
    // The lowest value of these sections.
    let least = |key: &str, of_path: &[&str]| {
        let of_axis = sections.iter().filter_map(|section| ini.positive(section, key));
        let of_path = of_path.iter().filter(|_| !rotary).filter_map(|key| ini.positive("TRAJ", key));
        let all = of_axis.chain(of_path);
        let least = all.min_by(|one, other| one.value.total_cmp(&other.value));
        least.map(|taken| Taken::new(taken.value * unit, taken.from))
    };
    let speed = least("MAX_VELOCITY", &["MAX_LINEAR_VELOCITY", "MAX_VELOCITY"]);
    let acceleration = least("MAX_ACCELERATION", &["MAX_LINEAR_ACCELERATION", "MAX_ACCELERATION"]);
    if speed.is_none() {
        ini.missing(&own, "MAX_VELOCITY", "units per second, there or in the section of its joint");
    }
    if acceleration.is_none() {
        ini.missing(&own, "MAX_ACCELERATION", "units per second², there or in the section of its joint");
    }
    let (speed, acceleration) = (speed?, acceleration?);
    let limit = |key: &str| {
        let found = sections.iter().find_map(|section| ini.number(section, key));
        found.map(|taken| Taken::new(taken.value * unit, taken.from))
    };
    // LinuxCNC's value for no limit.
    let travel = limit("MIN_LIMIT").zip(limit("MAX_LIMIT"));
    let travel = travel.filter(|(least, most)| least.value > -9e4 && most.value < 9e4);
    let jerk = least("MAX_JERK", &["MAX_LINEAR_JERK"]);
    let ramp = jerk.map_or_else(
        || ramp("this LinuxCNC"),
        |jerk| Taken::new(acceleration.value / jerk.value * 1000.0, format!("acceleration / {}", jerk.from)),
    );
    Some(Axis {
        name: letter.to_string(),
        rotary,
        rapid: speed.clone(),
        speed,
        acceleration,
        ramp,
        travel: travel.map(|(least, most)| [least, most]),
        steps: steps(ini, &sections, joint, unit),
    })
}

/// The step output of a joint.
fn steps(ini: &Ini<'_>, sections: &[&String], joint: usize, unit: f64) -> Vec<(&'static str, Taken)> {
    let number = |key: &str| sections.iter().find_map(|section| ini.number(section, key));
    let Some(scale) = ["STEP_SCALE", "SCALE"].iter().find_map(|key| number(key)) else { return Vec::new() };
    let pin = 2.0 * joint as f64;
    let counts = (scale.value.abs() / unit * 1000.0).round();
    if counts < 1.0 {
        return Vec::new();
    }
    let is_negative = f64::from(u8::from(scale.value < 0.0));
    let mut keys = vec![
        ("steps.counts", Taken::new(counts, scale.from.clone())),
        ("steps.length", Taken::new(1000.0, "mm or degrees for these counts")),
        ("steps.step", Taken::new(pin, "chosen")),
        ("steps.direction", Taken::new(pin + 1.0, "chosen")),
        ("steps.direction_inverted", Taken::new(is_negative, "the sign of the scale")),
    ];
    for (key, name) in [
        ("STEPLEN", "steps.pulse_ns"),
        ("STEPSPACE", "steps.gap_ns"),
        ("DIRSETUP", "steps.setup_ns"),
        ("DIRHOLD", "steps.hold_ns"),
    ] {
        keys.extend(number(key).map(|taken| (name, taken)));
    }
    let backlash = number("BACKLASH").filter(|backlash| backlash.value > 0.0);
    keys.extend(
        backlash.map(|backlash| ("steps.backlash", Taken::new(backlash.value * unit * 1e4, backlash.from))),
    );
    keys
}
