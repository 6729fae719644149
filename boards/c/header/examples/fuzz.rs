//! Random correct and wrong calls of the C interface:
//! `cargo run --release -p glidepath-c-header --example fuzz -- 10000000 1`.
//! Arguments: number of calls, seed. The program is `tests/fuzz.c`. The library is built with overflow checks
//! and debug assertions, and the storage lies between two protected pages.
use glidepath_c_header::{c, folder};
use std::process::Command;

fn main() -> Result<(), String> {
    let program = c::compile("fuzz", &[folder().join("header/tests/fuzz.c")])?;
    print!("{}", c::output(Command::new(program).args(std::env::args().skip(1)))?);
    Ok(())
}
