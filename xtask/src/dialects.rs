//! Dialects on the target: instructions of a plain line in each dialect, and flash and RAM of builds with them.
use crate::elf;
use crate::firmware::{Firmware, Place, small};
use crate::shell::step;
use crate::target;
use std::collections::BTreeMap;

const TESTS: &str = "hil-tests";

/// The binary that decodes a plain program in each dialect of its build.
const DECODE: &str = "decode";

/// Dialects of the build with all of them.
pub(crate) const DIALECTS: [&str; 4] = ["isg", "linuxcnc", "grbl", "fanuc"];

/// The build without other dialects. `decode` needs machine data for them.
const ISG: &str = "isg";

/// Builds for size: name in figures, features of `hil-tests` and the library.
pub(crate) const BUILDS: [(&str, &str); 4] = [
    (ISG, "glidepath/hsc"),
    ("grbl", "glidepath/hsc,grbl"),
    ("dialects", "glidepath/hsc,dialects"),
    ("fanuc", "glidepath/hsc,fanuc"),
];

/// Counts the decoder of each dialect, and measures the builds. The keys of the figures are
/// `dialect.NAME.decode_mean`, `dialect.NAME.decode_max`, `build.NAME.flash`, `build.NAME.ram_channel_3x30` and
/// `build.NAME.decode_mean_DIALECT`.
///
/// # Errors
/// A program is not built or fails on the target, or a dialect is missing.
pub fn measure(firmware: &Firmware) -> Result<BTreeMap<String, u64>, String> {
    let mut figures = BTreeMap::new();
    firmware.build(TESTS, &["--features", "fanuc", "--bin", DECODE], &[])?;
    let report = firmware.report(DECODE)?;
    let costs = target::read_dialects(&report)?;
    let text = std::str::from_utf8(hil_cases::PLAIN).map_err(|e| format!("plain: {e}"))?;
    let blocks = text.lines().filter(|line| line.contains('X')).count().max(1) as u64;
    for name in DIALECTS {
        let cost = costs.get(name).ok_or_else(|| format!("{DECODE}: the dialect {name} was not counted"))?;
        figures.insert(format!("dialect.{name}.decode_mean"), cost.sum.div_ceil(blocks));
        figures.insert(format!("dialect.{name}.decode_max"), cost.max);
    }
    for (name, features) in BUILDS {
        let is_isg = name == ISG;
        let names: &[&str] = if is_isg { &["nopanic"] } else { &["nopanic", DECODE] };
        firmware.build_small(TESTS, features, names)?;
        let file = small("nopanic");
        let image = std::fs::read(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        figures.insert(format!("build.{name}.flash"), elf::flash(&image).ok_or("nopanic: no load segments")?);
        if is_isg {
            continue;
        }
        let report = firmware.report_small(DECODE)?;
        figures.insert(format!("build.{name}.ram_channel_3x30"), target::read_channel(&report)?);
        for (dialect, cost) in target::read_dialects(&report)? {
            figures.insert(format!("build.{name}.decode_mean_{dialect}"), cost.sum.div_ceil(blocks));
        }
    }
    Ok(figures)
}

/// Only the dialects: `cargo xtask hil --dialects`.
///
/// # Errors
/// As [`measure`], or a figure is beyond its limit.
pub fn only() -> Result<(), String> {
    step("firmware");
    let firmware = Firmware::prepare(Place::Emulator)?;
    step("dialects: instructions of a plain line, flash and RAM");
    let figures = measure(&firmware)?;
    for (key, value) in &figures {
        eprintln!("   {key:<36} {value:>9}");
    }
    crate::figures::within_limits(&figures)
}
