//! A long conversation over a bad line: 10^8 bytes by `cargo run -p glidepath-controller --release --example damage`,
//! another number as argument.
#[path = "../tests/bench/mod.rs"]
mod bench;

fn main() {
    let bytes: u64 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(100_000_000);
    let first = bench::fresh_seed();
    let (mut done, mut lines, mut resets, mut seed) = (0, 0, 0, first);
    while done < bytes {
        let damaged = bench::corruption::damage(seed, 1_000_000);
        (done, lines, resets) = (done + damaged.bytes, lines + damaged.lines, resets + damaged.resets);
        seed += 1;
        if (seed - first).is_multiple_of(10) {
            println!("{done} bytes, {lines} lines, {resets} resets");
        }
    }
    println!("{done} bytes, {lines} lines, {resets} resets: each line answered once");
}
