//! The functions for floating point of a core that has no instructions for it, tried on the core.
use crate::Report;

/// Pairs of numbers, without `HIL_FLOATS` at build time.
#[cfg(soft)]
const PAIRS: u32 = match option_env!("HIL_FLOATS") {
    Some(number) => read(number.as_bytes()),
    None => 20_000,
};

#[cfg(soft)]
const fn read(digits: &[u8]) -> u32 {
    let (mut number, mut at) = (0, 0);
    while at < digits.len() {
        number = 10 * number + (digits[at] - b'0') as u32;
        at += 1;
    }
    number
}

/// Reports a digest of operations with pairs of numbers.
#[cfg(soft)]
pub fn floats(report: &mut Report) {
    use core::fmt::Write;
    use glidepath_softfloat::trial;
    let copies = if trial::copies() { "right" } else { "wrong" };
    let _ = writeln!(report, "floats pairs {PAIRS} digest {:016x} copies {copies}", trial::digest(1, PAIRS));
}

/// The core has instructions for floating point.
#[cfg(not(soft))]
pub fn floats(_: &mut Report) {}
