//! Planner, interpolator and operator in a thread each: the operator halves the speed, holds and resumes.
//!
//! `cargo run --release -p glidepath --example threads`
use glidepath::{
    AxisData, AxisKind, AxisName, Channel, ChannelData, Handles, MachineData, Position, Progress,
};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

const PROGRAM: &[u8] = b"N10 G01 X50 F3000\nN20 Y50\nN30 X0\nN40 Y0\nM30\n";

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let axes =
        ["X", "Y", "Z"].map(|name| AxisData::new(AxisName::new(name).expect("a name"), AxisKind::Linear));
    let machine = MachineData { axes, channel: ChannelData { slope_profile: 1, ..ChannelData::new() } };
    let mut memory = Box::new(Channel::<3, 120>::new());
    let Handles { mut planner, mut interpolator, operator } =
        memory.split(&machine, [Position::ZERO; 3], PROGRAM)?;
    let stands = AtomicBool::new(false);
    let end = thread::scope(|scope| {
        // A task of low priority: plans ahead, rests while the queue is full.
        scope.spawn(|| {
            while !stands.load(Ordering::Acquire) {
                match planner.poll() {
                    // The program has ended, and the axes have reached its end.
                    Ok(Progress::Done) if planner.is_at_rest() => stands.store(true, Ordering::Release),
                    Ok(Progress::Done | Progress::Waiting) => thread::sleep(Duration::from_micros(200)),
                    Ok(_) => {}
                    Err(error) => println!("line {}: {error}", error.place().line),
                }
            }
        });
        // The timer interrupt: here a tick each 20 µs, so that the example is short.
        let interrupt = scope.spawn(|| {
            while !stands.load(Ordering::Acquire) {
                interpolator.tick();
                thread::sleep(Duration::from_micros(20));
            }
            *interpolator.set_points()
        });
        // A user interface: commands, and what the machine does now.
        let show = |what: &str| {
            let status = operator.status();
            let mm_s = status.speed.0.to_num::<f64>() * 1000.0;
            println!("{what:>8}: N{} {:?} {mm_s:.1} mm/s", status.n, status.state);
        };
        thread::sleep(Duration::from_millis(20));
        operator.set_override(500);
        thread::sleep(Duration::from_millis(20));
        show("50 %");
        operator.feed_hold();
        thread::sleep(Duration::from_millis(40));
        show("hold");
        operator.resume();
        operator.set_override(1000);
        thread::sleep(Duration::from_millis(20));
        show("100 %");
        interrupt.join()
    });
    assert_eq!(end.map_err(|_| "the interrupt ended early")?, [Position::ZERO; 3]);
    Ok(())
}
