//! The expected words of a tick, from rational numbers and the driver's times. This reference shares only
//! machine data with the crate.
#![allow(dead_code)]
use glidepath_steps::{AxisSteps, Motor, Pin};

/// Seeded numbers (xorshift64*).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        // A seed of 0 would stay 0.
        let mut x = self.0 ^ 0x9e37_79b9_7f4a_7c15;
        for _ in 0..2 {
            x ^= x >> 12;
            x ^= x << 25;
            x ^= x >> 27;
        }
        self.0 = x;
        x.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 8
    }

    pub fn below(&mut self, end: u64) -> u64 {
        self.next() % end.max(1)
    }

    pub fn signed(&mut self, most: i64) -> i64 {
        let most = most.max(0);
        self.below(2 * most as u64 + 1) as i64 - most
    }
}

/// A seed that no run had before, or the one that `GLIDEPATH_SEED` names.
pub fn fresh_seed() -> u64 {
    let given = std::env::var("GLIDEPATH_SEED").ok().and_then(|seed| seed.parse().ok());
    let seed = given.unwrap_or_else(|| {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        now.map_or(0, |now| now.as_micros() as u64 % 1_000_000_000)
    });
    println!("GLIDEPATH_SEED={seed}");
    seed
}

/// The set point in counts, rounded to the nearest, half a count up.
pub fn rounded(bits: i64, counts: u32, length: u32) -> i128 {
    let (numerator, denominator) = (i128::from(bits) * i128::from(counts), i128::from(length) << 32);
    (2 * numerator + denominator).div_euclid(2 * denominator)
}

/// When a set point that moves evenly from `from` to `to` passes the middle between two counts: for each, in slots of
/// the tick, as an interval that holds the exact time.
pub fn crossing_slots(from: i64, to: i64, counts: u32, length: u32, slots: u32) -> Vec<[f64; 2]> {
    let (first, last) = (rounded(from, counts, length), rounded(to, counts, length));
    let unit = i128::from(length) << 32;
    let size = (i128::from(to) - i128::from(from)) * i128::from(counts);
    let middles: Vec<i128> =
        if first <= last { (first..last).collect() } else { (last..first).rev().collect() };
    let time = |count: i128| {
        // Position of the middle above `count`, doubled, less twice the start, over twice the size.
        let way = (2 * count + 1) * unit - 2 * i128::from(from) * i128::from(counts);
        // In 1/1024 slots, cut.
        let parts = (way * i128::from(slots) * 1024).div_euclid(2 * size);
        [parts as f64 / 1024.0, (parts + 1) as f64 / 1024.0]
    };
    middles.into_iter().map(time).collect()
}

/// The driver of one motor: sees levels, counts steps, and knows its times.
pub struct Watch {
    step: Pin,
    direction: Pin,
    times: [u64; 4],
    slot_ns: u64,
    now: u64,
    levels: u32,
    knows_direction: bool,
    rise: Option<u64>,
    fall: Option<u64>,
    turned: Option<u64>,
    /// Steps since the start, with their direction.
    pub count: i128,
}

impl Watch {
    pub fn new(axis: &AxisSteps, motor: &Motor, slot_ns: u32) -> Self {
        let times = [axis.pulse_ns, axis.gap_ns, axis.setup_ns, axis.hold_ns].map(u64::from);
        let Motor { step, direction } = *motor;
        // Pins at rest: no pulse.
        let levels = u32::from(step.is_inverted) << step.bit;
        Self {
            step,
            direction,
            times,
            slot_ns: u64::from(slot_ns),
            now: 0,
            levels,
            knows_direction: false,
            rise: None,
            fall: None,
            turned: None,
            count: 0,
        }
    }

    fn is_on(&self, pin: Pin) -> bool {
        (self.levels >> pin.bit & 1 == 1) != pin.is_inverted
    }

    /// The words of a tick; in which slots steps begin.
    pub fn tick(&mut self, words: &[u32]) -> Result<Vec<u32>, String> {
        let mut begun = Vec::new();
        let [pulse, gap, setup, hold] = self.times;
        for (slot, word) in words.iter().enumerate() {
            let time = self.now * self.slot_ns;
            let (was_on, was_positive) = (self.is_on(self.step), self.is_on(self.direction));
            let (set, reset) = (word & 0xffff, word >> 16);
            if set & reset != 0 {
                return Err(format!("slot {slot}: a pin is set and reset"));
            }
            for pin in [self.step, self.direction] {
                if pin == self.direction && (set | reset) >> pin.bit & 1 == 1 {
                    self.knows_direction = true;
                }
            }
            self.levels = self.levels & !reset | set;
            let (is_on, is_positive) = (self.is_on(self.step), self.is_on(self.direction));
            if is_positive != was_positive {
                self.turned = Some(time);
                if is_on && was_on {
                    return Err(format!("slot {slot}: the direction changes in a pulse"));
                }
                if self.fall.is_some_and(|fall| time - fall < hold) {
                    return Err(format!("slot {slot}: hold time"));
                }
            }
            if is_on && !was_on {
                if !self.knows_direction {
                    return Err(format!("slot {slot}: a step before a direction"));
                }
                if self.fall.is_some_and(|fall| time - fall < gap.max(1)) {
                    return Err(format!("slot {slot}: gap"));
                }
                if self.turned.is_some_and(|turned| time - turned < setup) {
                    return Err(format!("slot {slot}: set-up time"));
                }
                self.rise = Some(time);
                self.count += if is_positive { 1 } else { -1 };
                begun.push(slot as u32);
            }
            if was_on && !is_on {
                if self.rise.is_some_and(|rise| time - rise < pulse) {
                    return Err(format!("slot {slot}: short pulse"));
                }
                self.fall = Some(time);
            }
            self.now += 1;
        }
        Ok(begun)
    }
}
