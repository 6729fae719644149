//! A flood of real-time bytes: the work of the task is bounded, and the motion is the same as without the
//! flood.
mod bench;

use bench::world::{Rig, World, settings, with_rig};

/// Bytes per millisecond of a line with 115,200 baud.
const BYTES_PER_MS: f64 = 11.52;

/// Longest report, and the longest answer of a line of a program: what a look of the controller writes at most while
/// a program runs.
const MOST_BYTES: usize = 160;

/// A program of short lines. Ticks until it has come to rest, and the most bytes that a look wrote.
///
/// The serial output holds the task up: while a byte waits for the line, nothing is planned. Each tick `noise` comes in.
fn run(noise: &[u8]) -> (u32, usize) {
    let mut result = (0, 0);
    with_rig(&settings(), World::new(1), |rig| {
        let mut text: Vec<String> = (0..200).map(|i| format!("G1X{}Y{}F3000\n", i % 3, i % 5)).collect();
        text.reverse();
        let (begun, mut answers, mut most, mut waits) = (rig.now_ms, 0, 0, 0.0);
        let count = text.len();
        while answers < count || rig.room() < bench::BUFFER || is_busy(rig) {
            while rig.room() > 64
                && let Some(line) = text.pop()
            {
                rig.send(line);
            }
            rig.send(noise);
            rig.tick();
            let said = rig.read();
            answers += said.matches("ok\r\n").count();
            most = most.max(said.len());
            waits += said.len() as f64 / BYTES_PER_MS;
            while waits > 1.0 {
                rig.send(noise);
                rig.late_tick();
                waits -= 1.0;
            }
        }
        assert_eq!((rig.at(0), rig.at(1)), (1.0, 4.0));
        result = (rig.now_ms - begun, most);
    });
    result
}

fn is_busy(rig: &Rig<'_>) -> bool {
    use glidepath_controller::Motion;
    let status = rig.machine.status();
    status.is_busy || !status.is_at_rest
}

/// The bound: a look of the controller writes one report and one answer at most, and a program takes no more than two
/// percent longer on a line of 115,200 baud whose output is full all the time.
#[test]
fn a_flood_delays_nothing() {
    let (quiet, _) = run(b"");
    // Each millisecond what the line carries, overrides that end where they began.
    let all: [&[u8]; 5] =
        [b"???????????", b"~~~~~~~~~~~", &[0x91, 0x92, 0x9b, 0x9a], &[0x85; 11], &[0xff; 11]];
    let mixed = [b'?', b'~', 0x91, 0x92, 0x85, 0x96, 0x95, 0xc2, 0x80, b'?', 0x9e];
    for noise in all.into_iter().chain([mixed.as_slice()]) {
        let (flooded, most) = run(noise);
        println!("{noise:x?}: {flooded} ticks of {quiet}, {most} bytes in a look");
        assert!(most <= MOST_BYTES, "{most} bytes");
        assert!(flooded <= quiet + quiet / 50, "{flooded} ticks, {quiet} without the flood");
    }
}
