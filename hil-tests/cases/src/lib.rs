//! What host and target must run alike: the programs, the machines, and the one loop that runs them.
#![no_std]
#![forbid(unsafe_code)]

mod beside;
mod commands;
#[cfg(feature = "five")]
mod five;
mod machines;
#[cfg(feature = "plc")]
mod plc;
mod run;
mod session;
mod tasks;

pub use beside::{BesideCase, CASES_BESIDE, FilterMemory, OVERLAYS, TAPS, beside};
pub use commands::{SEEDS, commanded};
#[cfg(feature = "five")]
pub use five::{FIVE, five};
pub use machines::{AXES_3, AXES_3_DEEP, AXES_3_SHORT, AXES_4, AXES_6, AXES_6_SHORT};
#[cfg(feature = "plc")]
pub use plc::{LASER_POWER, PASSES, PlcMemory, RING_DIGEST, laser, ring};
pub use run::{Failure, Outcome, Unwatched, Watch, run};
pub use session::{WINDOW, session};
pub use tasks::{END_OF_PART, Line, SECOND_PART, TASKS, TASKS_MACHINE, tasks};

/// Blocks of look-ahead, the default of the language.
pub const BLOCKS: usize = 120;

/// A short look-ahead, and a deep one.
pub const SHORT: usize = 30;
/// See [`SHORT`].
pub const DEEP: usize = 190;

/// A program and its name in reports.
pub struct Case {
    /// File name without extension.
    pub name: &'static str,
    /// The program text, as it is in flash.
    pub text: &'static [u8],
}

macro_rules! cases {
    ($($name:literal),+ $(,)?) => {
        &[$(Case { name: $name, text: include_bytes!(concat!("../../../programs/", $name, ".nc")) }),+]
    };
}

/// Programs for [`AXES_3`].
pub const CASES_3: &[Case] = cases!(
    "lines",
    "plain",
    "arcs",
    "helix",
    "circle",
    "chords",
    "subroutine",
    "short_blocks",
    "micro",
    "short_arcs",
    "cam",
    "cam_dev",
    "rapid_and_feed",
    "dwell",
    "step",
    "sin2",
    "hsc",
    "hsc_opt",
    "contour",
    "corners",
    "surface",
    "rows",
    "splines"
);

/// The program `plain` without its name, which other dialects do not have: the same lines for each dialect.
pub const PLAIN: &[u8] =
    match include_bytes!("../../../programs/plain.nc").split_at_checked(b"%plain\n".len()) {
        Some((_, lines)) => lines,
        None => &[],
    };

/// Programs for [`AXES_4`].
pub const CASES_4: &[Case] = cases!("rotary", "rotary_corners");

/// Programs for [`AXES_6`].
pub const CASES_6: &[Case] = cases!("six", "six_corners", "six_surface");

/// Programs for three axes with another look-ahead.
pub const CASES_3_OTHER: &[Case] = cases!("short_blocks", "hsc_opt", "contour", "corners", "cam_dev");

/// Programs for three axes that need lines, arcs and contour mode alone.
pub const CASES_SLIM: &[Case] =
    cases!("lines", "plain", "arcs", "circle", "cam", "cam_dev", "dwell", "contour");

/// Programs for the table of cores, with a short look-ahead.
pub const CASES_CORES: &[Case] =
    cases!("lines", "plain", "arcs", "hsc", "short_blocks", "contour", "corners", "cam_dev", "surface");

/// Those of them that need lines, arcs and contour mode alone.
pub const CASES_CORES_SLIM: &[Case] = cases!("lines", "plain", "arcs", "contour", "cam_dev");

/// Programs for six axes with another look-ahead.
pub const CASES_6_OTHER: &[Case] = cases!("six", "six_corners");
