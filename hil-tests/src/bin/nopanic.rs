//! Decoder, planner and tick with a panic handler that cannot be linked: builds only if no panicking path is left.
#![no_std]
#![no_main]
use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use cortex_m_rt::{entry, exception};
use critical_section::Mutex;
use glidepath::axis::Axes;
use glidepath::channel::{Channel, Error, MachineError, Planner, Progress};
use glidepath::quantity::Position;
use glidepath::tick::Interpolator;
use hil_cases::{AXES_3, BLOCKS, CASES_3};
#[cfg(not(feature = "locate"))]
use panic_never as _;
#[cfg(feature = "locate")]
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<3, BLOCKS>> = ConstStaticCell::new(Channel::new());
static TO_INTERRUPT: Mutex<Cell<Option<Interpolator<'static, 3>>>> = Mutex::new(Cell::new(None));
static OUTPUT: Output = Output([const { AtomicU32::new(0) }; 3]);
static FAILED: AtomicU32 = AtomicU32::new(0);

/// What an application holds.
type Halves = Result<(Planner<'static, &'static [u8], 3, BLOCKS>, Interpolator<'static, 3>), MachineError>;

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

// Calls of their own: how deep the stack gets below each of them is read from the machine code.
#[inline(never)]
fn start(channel: &'static mut Channel<3, BLOCKS>, program: &'static [u8]) -> Halves {
    channel.split(&AXES_3, [Position::ZERO; 3], program)
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
        && let Ok((mut planner, interpolator)) = start(channel, program)
    {
        critical_section::with(|cs| TO_INTERRUPT.borrow(cs).set(Some(interpolator)));
        loop {
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
