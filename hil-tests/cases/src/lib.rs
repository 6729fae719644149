//! What host and target must run alike: the programs, the machines, and the one loop that runs them.
#![no_std]
#![forbid(unsafe_code)]

mod machines;
mod run;

pub use machines::{AXES_3, AXES_4, AXES_6};
pub use run::{Failure, Outcome, Unwatched, Watch, run};

/// Blocks of look-ahead with three and four axes, the default of the language.
pub const BLOCKS: usize = 120;

/// The same with six axes: a planner is there twice while it is made, and the target has 128 KiB.
pub const BLOCKS_6: usize = 30;

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
    "corners"
);

/// Programs for [`AXES_4`].
pub const CASES_4: &[Case] = cases!("rotary");

/// Programs for [`AXES_6`].
pub const CASES_6: &[Case] = cases!("six", "six_corners");
