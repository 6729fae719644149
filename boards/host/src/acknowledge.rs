//! Acknowledgement of functions without an event: `--ack`.
use crate::decimal::parse;
use crate::events::ticks;
use glidepath::operator::Operator;
use glidepath::queue::Function;
use std::collections::VecDeque;

/// Delay between the output of a function and its acknowledgement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delay {
    /// No acknowledgement.
    Never,
    /// Delay in ns.
    After(u64),
}

impl Default for Delay {
    fn default() -> Self {
        Self::After(0)
    }
}

/// Longest delay, s.
const LONGEST: u64 = 1_000_000;

/// `never`, or seconds.
///
/// # Errors
/// The expected value.
pub fn parse_delay(text: &str) -> Result<Delay, String> {
    if text == "never" {
        return Ok(Delay::Never);
    }
    let ns = parse(text.as_bytes(), 9).filter(|&ns| ns <= LONGEST * 1_000_000_000);
    ns.map(Delay::After).ok_or_else(|| format!("expected seconds, 0…{LONGEST}, or never"))
}

/// Acknowledges functions after their output.
pub struct Automatic {
    /// Ticks.
    delay: Option<u64>,
    pending: VecDeque<(u64, Function)>,
}

impl Automatic {
    /// No function was output yet.
    pub fn new(delay: Delay, cycle_us: u32) -> Self {
        let delay = match delay {
            Delay::Never => None,
            Delay::After(ns) => Some(ticks(ns, cycle_us)),
        };
        Self { delay, pending: VecDeque::new() }
    }

    /// Records the output of a function; `next` is the next tick.
    pub fn answer(&mut self, function: Function, next: u64) {
        if let Some(delay) = self.delay {
            // From the tick of the output on.
            self.pending.push_back(((next + delay).saturating_sub(1).max(next), function));
        }
    }

    /// Returns the next function to acknowledge before `tick`.
    pub fn due<const AXES: usize>(&mut self, tick: u64, operator: &Operator<'_, AXES>) -> Option<Function> {
        while let Some((_, function)) = self.pending.pop_front_if(|(at, _)| *at <= tick) {
            // An abort may have dropped the function.
            if operator.acknowledge(function).is_ok() {
                return Some(function);
            }
        }
        None
    }

    /// Whether this function will be acknowledged.
    pub fn answers(&self, function: Function) -> bool {
        self.pending.iter().any(|(_, other)| *other == function)
    }
}
