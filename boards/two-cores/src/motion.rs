//! Core 1: the interpolator in the interrupt of its own SysTick.
use crate::chip;
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use cortex_m::peripheral::syst::SystClkSource;
use glidepath::digest::Digest;
use glidepath::tick::{Interpolator, State};

/// A place that core 0 fills before core 1 runs, and that core 1 alone uses afterwards.
struct Mailbox(UnsafeCell<Option<Motion>>);

// SAFETY: `FULL` orders the two uses: core 1 looks inside only after it has seen it.
unsafe impl Sync for Mailbox {}

static MAILBOX: Mailbox = Mailbox(UnsafeCell::new(None));
static FULL: AtomicBool = AtomicBool::new(false);

/// Core 0: a call of the planner runs; all is planned. Core 1: the motion has ended.
static PLANNING: AtomicBool = AtomicBool::new(false);
static PLANNED: AtomicBool = AtomicBool::new(false);
static ENDED: AtomicBool = AtomicBool::new(false);

/// What the motion was, valid when it has ended.
pub struct Seen {
    /// Ticks with motion or dwell.
    pub ticks: AtomicU32,
    /// Ticks in between that found nothing planned.
    pub starved: AtomicU32,
    /// Ticks while core 0 was inside a call of the planner.
    pub beside: AtomicU32,
    /// Over all set points: the lower and the upper half.
    pub digest: [AtomicU32; 2],
    /// The last set points, in 2^-16 mm.
    pub output: [AtomicU32; 3],
}

/// See [`Seen`].
pub static SEEN: Seen = Seen {
    ticks: AtomicU32::new(0),
    starved: AtomicU32::new(0),
    beside: AtomicU32::new(0),
    digest: [const { AtomicU32::new(0) }; 2],
    output: [const { AtomicU32::new(0) }; 3],
};

/// What core 1 holds.
struct Motion {
    interpolator: Interpolator<'static, 3>,
    digest: Digest,
    starved: u32,
}

/// Core 0 gives the interpolator away, once, before the other core runs.
pub fn hand_over(interpolator: Interpolator<'static, 3>) {
    // SAFETY: core 1 does not run yet.
    unsafe { *MAILBOX.0.get() = Some(Motion { interpolator, digest: Digest::new(), starved: 0 }) };
    FULL.store(true, Ordering::Release);
}

/// Says that a call of the planner runs.
pub fn planning<T>(call: impl FnOnce() -> T) -> T {
    PLANNING.store(true, Ordering::Relaxed);
    let result = call();
    PLANNING.store(false, Ordering::Relaxed);
    result
}

/// Core 0 has planned all, and waits until the axes stand.
pub fn wait_for_end() {
    PLANNED.store(true, Ordering::Release);
    while !ENDED.load(Ordering::Acquire) {
        cortex_m::asm::nop();
    }
}

/// Where core 1 begins.
pub extern "C" fn core_1() -> ! {
    while !FULL.load(Ordering::Acquire) {
        cortex_m::asm::nop();
    }
    // SAFETY: the SysTick of this core; each core has its own, and core 0 does not use this handle.
    let mut timer = unsafe { cortex_m::Peripherals::steal() }.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(chip::CLOCK_HZ / 1000 - 1);
    timer.clear_current();
    timer.enable_interrupt();
    timer.enable_counter();
    loop {
        cortex_m::asm::wfi();
    }
}

/// Core 1's timer interrupt: first the output, then the next set points.
pub extern "C" fn tick() {
    // SAFETY: core 1 alone is here, in an interrupt that does not interrupt itself.
    let Some(Motion { interpolator, digest, starved }) = (unsafe { &mut *MAILBOX.0.get() }) else { return };
    for (output, point) in SEEN.output.iter().zip(interpolator.set_points()) {
        output.store((point.to_bits() >> 16) as u32, Ordering::Relaxed);
    }
    let planned = PLANNED.load(Ordering::Acquire);
    let beside = PLANNING.load(Ordering::Relaxed);
    match interpolator.tick() {
        State::Active | State::Settling => {
            digest.add(interpolator.set_points());
            let more = |count: &AtomicU32, by: u32| {
                count.store(count.load(Ordering::Relaxed).wrapping_add(by), Ordering::Relaxed);
            };
            more(&SEEN.ticks, 1);
            more(&SEEN.starved, core::mem::take(starved));
            more(&SEEN.beside, u32::from(beside));
        }
        State::Idle if planned => {
            let value = digest.value();
            for (half, bits) in SEEN.digest.iter().zip([value as u32, (value >> 32) as u32]) {
                half.store(bits, Ordering::Relaxed);
            }
            ENDED.store(true, Ordering::Release);
        }
        // Before the first motion nothing starves.
        State::Idle if SEEN.ticks.load(Ordering::Relaxed) > 0 => *starved = starved.wrapping_add(1),
        State::Idle => {}
    }
}

/// Size of core 1's stack, in 8 bytes: the interrupt needs less than 1 KiB.
const STACK: usize = 512;

#[repr(C, align(8))]
struct Stack(UnsafeCell<[u64; STACK]>);

// SAFETY: core 1 alone uses it.
unsafe impl Sync for Stack {}

static CORE_1_STACK: Stack = Stack(UnsafeCell::new([0; STACK]));

/// Where core 1's stack begins: its upper end.
pub fn stack_top() -> u32 {
    CORE_1_STACK.0.get().wrapping_add(1) as u32
}
