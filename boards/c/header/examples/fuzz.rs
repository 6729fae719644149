//! Calls of the C interface at random, right ones and wrong ones: `cargo run --release -p glidepath-c-header --example fuzz -- 10000000 1`.
//! Arguments: number of calls, seed. The program is `tests/fuzz.c`; the library is built with checks of overflows and debug
//! assertions, and a storage between two pages that nobody may touch.
use glidepath_c_header::{c, folder};
use std::process::Command;

fn main() -> Result<(), String> {
    let program = c::compile("fuzz", &[folder().join("header/tests/fuzz.c")])?;
    print!("{}", c::output(Command::new(program).args(std::env::args().skip(1)))?);
    Ok(())
}
