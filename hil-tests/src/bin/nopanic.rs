//! Decoder, planner and tick with a panic handler that cannot be linked: builds only if no panicking path is left.
#![no_std]
#![no_main]
use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use cortex_m_rt::{entry, exception};
use critical_section::Mutex;
use glidepath::axis::Axes;
use glidepath::channel::{Channel, Progress};
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

#[entry]
fn main() -> ! {
    // What the compiler cannot know, as with a program loaded later.
    let case = core::hint::black_box(0);
    if let (Some(channel), Some(case)) = (CHANNEL.try_take(), CASES_3.get(case))
        && let Ok((mut planner, interpolator)) = channel.split(&AXES_3, [Position::ZERO; 3], case.text)
    {
        critical_section::with(|cs| TO_INTERRUPT.borrow(cs).set(Some(interpolator)));
        loop {
            match planner.poll() {
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
