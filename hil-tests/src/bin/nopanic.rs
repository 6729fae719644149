//! Decoder, planner and tick with a panic handler that cannot be linked: builds only if no panicking path is
//! left.
#![no_std]
#![no_main]
use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use cortex_m_rt::{entry, exception};
use critical_section::Mutex;
use glidepath::axis::Axes;
use glidepath::channel::{Channel, Error, Handles, MachineError, Planner, Progress};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::tick::Interpolator;
use glidepath_copy as _;
use hil_cases::{AXES_3, BLOCKS, CASES_3};
#[cfg(not(feature = "locate"))]
use panic_never as _;
#[cfg(feature = "locate")]
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<3, BLOCKS>> = ConstStaticCell::new(Channel::new());
static TO_INTERRUPT: Mutex<Cell<Option<Interpolator<'static, 3>>>> = Mutex::new(Cell::new(None));
static STATUS: AtomicU32 = AtomicU32::new(0);
static OUTPUT: Output = Output([const { AtomicU32::new(0) }; 3]);
static FAILED: AtomicU32 = AtomicU32::new(0);

/// What an application holds.
type Split = Result<Handles<'static, &'static [u8], 3, BLOCKS>, MachineError>;

struct Output([AtomicU32; 3]);

impl Axes<3> for &Output {
    fn write(&mut self, set_points: &[Position; 3]) {
        for (output, point) in self.0.iter().zip(set_points) {
            output.store((point.to_bits() >> 16) as u32, Relaxed);
        }
    }
}

#[exception]
fn SysTick() {
    static mut INTERPOLATOR: Option<Interpolator<'static, 3>> = None;
    if INTERPOLATOR.is_none() {
        *INTERPOLATOR = critical_section::with(|cs| TO_INTERRUPT.borrow(cs).take());
    }
    if let Some(interpolator) = INTERPOLATOR {
        (&OUTPUT).write(interpolator.set_points());
        interpolator.tick();
    }
}

/// A task that carries out functions, and now and then gives every command there is.
fn operate(operator: &Operator<'static, 3>) {
    while let Some(output) = operator.output() {
        if output.waits && operator.awaited().is_some() {
            let _ = operator.acknowledge(output.function);
        }
    }
    let status = operator.status();
    match core::hint::black_box(status.ticks) {
        0x1000_0000 => operator.set_override(status.queued),
        0x1000_0001 => operator.feed_hold(),
        0x1000_0002 => operator.resume(),
        0x1000_0003 => operator.set_reduced(!operator.commands().reduced),
        0x1000_0004 => operator.abort(),
        _ => STATUS.store(status.n, Relaxed),
    }
}

// Calls of their own: how deep the stack gets below each of them is read from the machine code.
#[inline(never)]
fn start(channel: &'static mut Channel<3, BLOCKS>, program: &'static [u8]) -> Split {
    // With more than one dialect, the compiler must not know that of this machine.
    #[cfg(feature = "grbl")]
    let machine = core::hint::black_box(&AXES_3);
    #[cfg(not(feature = "grbl"))]
    let machine = &AXES_3;
    channel.split(machine, [Position::ZERO; 3], program)
}

#[inline(never)]
fn poll(planner: &mut Planner<'static, &'static [u8], 3, BLOCKS>) -> Result<Progress, Error> {
    planner.poll()
}

#[entry]
fn main() -> ! {
    // One program. The compiler cannot know it, as with one loaded later.
    let program = CASES_3.first().map(|case| core::hint::black_box(case.text));
    if let (Some(channel), Some(program)) = (CHANNEL.try_take(), program)
        && let Ok(handles) = start(channel, program)
    {
        let Handles { mut planner, interpolator, operator } = handles;
        critical_section::with(|cs| TO_INTERRUPT.borrow(cs).set(Some(interpolator)));
        loop {
            operate(&operator);
            match poll(&mut planner) {
                Ok(Progress::Waiting) => cortex_m::asm::wfi(),
                Ok(Progress::Done) => break,
                Ok(_) => {}
                Err(_) => FAILED.store(1, Relaxed),
            }
        }
    }
    #[cfg(feature = "bad")]
    {
        let axis = core::hint::black_box(1);
        OUTPUT.0[axis].store(1, Relaxed);
    }
    loop {
        cortex_m::asm::wfi();
    }
}
