//! The interpolator in the interrupt of TIM2.
//!
//! The interrupt keeps its data in a local static variable, and takes the data once from a mailbox.
//! Afterwards the interrupt uses only a few shared atomics, and contains no panicking code.
use core::cell::Cell;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use critical_section::Mutex;
use glidepath::axis::Axes;
use glidepath::digest::Digest;
use glidepath::tick::{Interpolator, State};
use stm32f4::stm32f405::{Interrupt, RCC, TIM2, interrupt};

use crate::AXES;
use crate::output::Output;

/// Clock of TIM2, MHz: 2 · APB1 at 168 MHz, or the clock after reset. QEMU's TIM2 always runs at 1 GHz.
const TIMER_MHZ: u32 = match (cfg!(feature = "qemu"), cfg!(feature = "hardware")) {
    (true, _) => 1000,
    (false, true) => 84,
    (false, false) => 16,
};

/// Statistics of the motion.
#[derive(Clone, Copy)]
pub struct Report {
    /// Ticks with motion or dwell.
    pub ticks: u32,
    /// Ticks without planned motion, between the first and the last tick with motion.
    pub starved: u32,
    /// Ticks that came during the computation of the previous tick.
    pub missed: u32,
    /// The longest interrupt, without its statistics. Unit: instructions in the emulator, periods of TIM2's
    /// clock on a board.
    pub longest: u32,
    /// Digest over all set points.
    pub digest: Digest,
}

struct Motion {
    interpolator: Interpolator<'static, AXES>,
    axes: Output,
    timer: TIM2,
}

static MAILBOX: Mutex<Cell<Option<Motion>>> = Mutex::new(Cell::new(None));
static REPORT: Mutex<Cell<Report>> =
    Mutex::new(Cell::new(Report { ticks: 0, starved: 0, missed: 0, longest: 0, digest: Digest::new() }));
static MOVING: AtomicBool = AtomicBool::new(false);

/// Passes the interpolator to the interrupt and starts the timer.
pub fn start(interpolator: Interpolator<'static, AXES>, axes: Output, timer: TIM2, rcc: &RCC, cycle_us: u32) {
    rcc.apb1enr().modify(|_, w| w.tim2en().set_bit());
    // Counter and prescaler are zero after reset, and the reload value is not buffered, so no update event is
    // needed.
    timer.arr().write(|w| w.arr().set(cycle_us.wrapping_mul(TIMER_MHZ).wrapping_sub(1)));
    timer.dier().write(|w| w.uie().set_bit());
    timer.cr1().write(|w| w.cen().set_bit());
    critical_section::with(|cs| MAILBOX.borrow(cs).set(Some(Motion { interpolator, axes, timer })));
    // SAFETY: the mailbox is full, so the interrupt finds its data; no critical section depends on the mask.
    unsafe { cortex_m::peripheral::NVIC::unmask(Interrupt::TIM2) };
}

/// Sleeps until a tick finds no motion, and calls `each` after every interrupt. Call this function after all
/// motion is planned.
pub fn wait_for_standstill(each: impl Fn()) {
    MOVING.store(true, Relaxed);
    while MOVING.load(Relaxed) {
        cortex_m::asm::wfi();
        each();
    }
}

/// Returns the statistics so far.
pub fn report() -> Report {
    critical_section::with(|cs| REPORT.borrow(cs).get())
}

#[interrupt]
fn TIM2() {
    static mut MOTION: Option<Motion> = None;
    static mut IDLE: u32 = 0;
    if MOTION.is_none() {
        *MOTION = critical_section::with(|cs| MAILBOX.borrow(cs).take());
    }
    let Some(motion) = MOTION else { return };
    let begin = motion.timer.cnt().read().bits();
    motion.timer.sr().modify(|_, w| w.uif().clear_bit());
    // Outputs the set points of the previous cycle first, so the moment of output does not depend on the
    // computation.
    motion.axes.write(motion.interpolator.set_points());
    let state = motion.interpolator.tick();
    let took = motion.timer.cnt().read().bits().wrapping_sub(begin);
    let late = motion.timer.sr().read().uif().bit_is_set();
    critical_section::with(|cs| {
        let mut report = REPORT.borrow(cs).get();
        match state {
            State::Active | State::Settling => {
                report.ticks = report.ticks.wrapping_add(1);
                report.starved = report.starved.wrapping_add(core::mem::take(IDLE));
                if cfg!(feature = "qemu") {
                    report.digest.add(motion.interpolator.set_points());
                }
            }
            State::Idle if report.ticks > 0 => *IDLE = IDLE.wrapping_add(1),
            State::Idle => {}
        }
        report.longest = report.longest.max(took);
        report.missed = report.missed.wrapping_add(u32::from(late));
        REPORT.borrow(cs).set(report);
    });
    if state == State::Idle {
        MOVING.store(false, Relaxed);
    }
}
