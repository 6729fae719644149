//! Seeds for tests with random cases: fixed seeds, the same in each run, followed by new seeds for every run.
//!
//! The first new seed is printed, and printed again with a failure. `GLIDEPATH_SEED=number` repeats the new
//! seeds.
use std::sync::OnceLock;
use std::time::{SystemTime, UNIX_EPOCH};

/// The environment variable that repeats the new seeds.
pub const VARIABLE: &str = "GLIDEPATH_SEED";

/// New seeds begin after all fixed seeds.
const FIRST: u64 = 1_000_000;
const BASES: u64 = 1_000_000_000;

/// The first new seed of this run.
pub fn own() -> u64 {
    static OWN: OnceLock<u64> = OnceLock::new();
    *OWN.get_or_init(|| match std::env::var(VARIABLE) {
        Ok(number) => number.parse().unwrap_or_else(|_| panic!("{VARIABLE}={number} is no number")),
        Err(_) => {
            let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
            FIRST + (u64::from(now.subsec_nanos()) ^ now.as_secs()) % BASES
        }
    })
}

/// `fixed`, followed by this number of new seeds.
pub fn seeds(fixed: impl IntoIterator<Item = u64> + 'static, count: u64) -> Seeds {
    let first = own();
    println!("own seeds {first} to {}; {VARIABLE}={first} repeats them", first + count - 1);
    Seeds { all: Box::new(fixed.into_iter().chain(first..first + count)), first, at: None }
}

/// Fixed seeds and new seeds.
pub struct Seeds {
    all: Box<dyn Iterator<Item = u64>>,
    first: u64,
    at: Option<u64>,
}

impl Iterator for Seeds {
    type Item = u64;

    fn next(&mut self) -> Option<u64> {
        self.at = self.all.next();
        self.at
    }
}

impl Drop for Seeds {
    fn drop(&mut self) {
        if let (true, Some(at)) = (std::thread::panicking(), self.at) {
            if at >= self.first {
                println!("fails with seed {at}, one of this run's own: {VARIABLE}={} repeats it", self.first);
            } else {
                println!("fails with seed {at}, as in every run");
            }
        }
    }
}
