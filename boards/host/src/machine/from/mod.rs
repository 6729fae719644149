//! Machine files from the settings of other controllers: reads their file and returns a [`Sheet`] as text.
//!
//! Each value names its origin. Settings that machine data do not have are listed at the end with the reason.
mod grbl;
mod ini;
mod klipper;
mod linuxcnc;

use super::load::read;
use super::sheet::{Sheet, Taken};
use super::{MAX_AXES, Overrides};
use crate::diagnose::{Diagnostic, Source};

/// Ramp time in milliseconds for controllers without ramps, whose acceleration changes in steps.
const RAMP_MS: f64 = 20.0;

/// The ramp for a controller without ramps.
fn ramp(controller: &str) -> Taken {
    Taken::new(RAMP_MS, format!("chosen: {controller} has no ramps. Slope STEP (profile = 0) moves like it"))
}

/// Reads the settings of a controller. Returns the text of a machine file.
///
/// # Errors
/// The text is no list of settings, or a value is missing or out of range.
pub fn from(source: &Source) -> Result<String, Vec<Diagnostic>> {
    let text = String::from_utf8_lossy(&source.text);
    let has = |part: &dyn Fn(&str) -> bool| text.lines().map(str::trim).any(part);
    let section = |line: &str, names: &[&str]| {
        let name = line.strip_prefix('[').and_then(|rest| rest.split_once(']')).map(|(name, _)| name.trim());
        name.is_some_and(|name| names.iter().any(|known| name.starts_with(known)))
    };
    let sheet = if has(&grbl::is_setting) {
        grbl::read(source)?
    } else if has(&|line| section(line, &["printer", "stepper_"])) {
        klipper::read(source)?
    } else if has(&|line| section(line, &["TRAJ", "KINS", "JOINT_", "AXIS_", "EMCMOT"])) {
        linuxcnc::read(source)?
    } else {
        let message = format!("{}: the settings of no controller that is known", source.name);
        let expected = "Grbl's answer to $$ ($110=500.000), a LinuxCNC INI ([TRAJ], [JOINT_0]) or a Klipper \
                        printer.cfg ([printer], [stepper_x])";
        return Err(vec![Diagnostic::error(message).expected(expected)]);
    };
    finish(source, &sheet)
}

/// Returns the text, if a machine with these data can run.
fn finish(source: &Source, sheet: &Sheet) -> Result<String, Vec<Diagnostic>> {
    if sheet.axes.is_empty() || sheet.axes.len() > MAX_AXES {
        let message = format!("{}: {} axes with speed and acceleration", source.name, sheet.axes.len());
        return Err(vec![Diagnostic::error(message).expected(format!("1 to {MAX_AXES} axes"))]);
    }
    let text = sheet.text();
    let made = Source { name: format!("machine of {}", source.name), text: text.clone().into_bytes() };
    read(&made, &Overrides::default()).map(|_| text)
}
