//! Decoder, planner and tick with one short program: what a core needs of flash. Links only if no panicking path is left.
#![no_std]
#![no_main]
use core::hint::black_box;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use glidepath::axis::Axes;
use glidepath::channel::{Handles, Progress};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use hil_cases::{AXES_3_SHORT, CASES_CORES_SLIM};
use hil_cores::channel;
use panic_never as _;

static OUTPUT: Output = Output([const { AtomicU32::new(0) }; 3]);
static STATUS: AtomicU32 = AtomicU32::new(0);

struct Output([AtomicU32; 3]);

impl Axes<3> for &Output {
    fn write(&mut self, set_points: &[Position; 3]) {
        for (output, point) in self.0.iter().zip(set_points) {
            output.store((point.to_bits() >> 16) as u32, Relaxed);
        }
    }
}

#[cfg(target_arch = "arm")]
#[cortex_m_rt::entry]
fn main() -> ! {
    all()
}

#[cfg(target_arch = "riscv32")]
#[unsafe(no_mangle)]
extern "C" fn main() -> ! {
    all()
}

/// A task that carries out functions, and now and then gives every command there is.
fn operate(operator: &Operator<'static, 3>) {
    while let Some(output) = operator.output() {
        if output.waits && operator.awaited().is_some() {
            let _ = operator.acknowledge(output.function);
        }
    }
    let status = operator.status();
    match black_box(status.ticks) {
        0x1000_0000 => operator.set_override(status.queued),
        0x1000_0001 => operator.feed_hold(),
        0x1000_0002 => operator.resume(),
        0x1000_0003 => operator.set_reduced(!operator.commands().reduced),
        0x1000_0004 => operator.abort(),
        _ => STATUS.store(status.n, Relaxed),
    }
}

fn all() -> ! {
    // One program. The compiler cannot know it, as with one loaded later.
    let program = CASES_CORES_SLIM.first().map(|case| black_box(case.text));
    if let (Some(channel), Some(program)) = (channel(), program)
        && let Ok(handles) = channel.split(black_box(&AXES_3_SHORT), [Position::ZERO; 3], program)
    {
        let Handles { mut planner, mut interpolator, operator } = handles;
        loop {
            operate(&operator);
            if matches!(planner.poll(), Ok(Progress::Waiting | Progress::Done) | Err(_)) {
                (&OUTPUT).write(interpolator.set_points());
                interpolator.tick();
            }
        }
    }
    loop {
        core::hint::spin_loop();
    }
}
