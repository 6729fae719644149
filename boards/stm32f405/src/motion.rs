//! The interpolator in TIM2's interrupt.
//!
//! The interrupt owns what it needs in a variable of its own and takes it once from a mailbox; from then on
//! it touches nothing that is shared but a few atomics, and no path in it can panic.
use core::cell::Cell;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use critical_section::Mutex;
use glidepath::axis::Axes;
use glidepath::digest::Digest;
use glidepath::tick::{Interpolator, State};
use stm32f4::stm32f405::{Interrupt, RCC, TIM2, interrupt};

use crate::AXES;
use crate::output::Output;

/// Clock of TIM2, MHz: 2 · APB1 at 168 MHz, or the reset clock; QEMU's model runs at 1 GHz whatever the clock
/// tree says.
const TIMER_MHZ: u32 = match (cfg!(feature = "qemu"), cfg!(feature = "hardware")) {
    (true, _) => 1000,
    (false, true) => 84,
    (false, false) => 16,
};

/// What the motion was.
#[derive(Clone, Copy)]
pub struct Report {
    /// Ticks with motion or dwell.
    pub ticks: u32,
    /// Ticks between the first and the last of them that found nothing planned.
    pub starved: u32,
    /// Ticks that came while the one before was still computed.
    pub missed: u32,
    /// The longest interrupt, up to where its statistics begin: in the emulator instructions, otherwise
    /// periods of TIM2's clock.
    pub longest: u32,
    /// Over all set points.
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

/// Hands the interpolator to the interrupt and starts the timer.
pub fn start(interpolator: Interpolator<'static, AXES>, axes: Output, timer: TIM2, rcc: &RCC, cycle_us: u32) {
    rcc.apb1enr().modify(|_, w| w.tim2en().set_bit());
    // Counter and prescaler are zero after reset and the reload value is not buffered: no update event is
    // forced.
    timer.arr().write(|w| w.arr().set(cycle_us.wrapping_mul(TIMER_MHZ).wrapping_sub(1)));
    timer.dier().write(|w| w.uie().set_bit());
    timer.cr1().write(|w| w.cen().set_bit());
    critical_section::with(|cs| MAILBOX.borrow(cs).set(Some(Motion { interpolator, axes, timer })));
    // SAFETY: the mailbox is full, so the interrupt finds what it needs; no critical section depends on the
    // mask.
    unsafe { cortex_m::peripheral::NVIC::unmask(Interrupt::TIM2) };
}

/// Sleeps until a tick finds nothing to do, and does `each` behind every interrupt. Call it when everything
/// is planned.
pub fn wait_for_standstill(each: impl Fn()) {
    MOVING.store(true, Relaxed);
    while MOVING.load(Relaxed) {
        cortex_m::asm::wfi();
        each();
    }
}

/// What happened so far.
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
    // The set points of the cycle before: their moment does not depend on how long the next ones take.
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
