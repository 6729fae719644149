//! A free-running counter: instructions in the emulator, core cycles on hardware. The two are never mixed up.

use core::hint::black_box;

/// What [`Counter::now`] counts.
#[cfg(not(feature = "hardware"))]
pub const UNIT: &str = "instructions";
/// What [`Counter::now`] counts.
#[cfg(feature = "hardware")]
pub const UNIT: &str = "cycles";

/// The counter, running.
pub struct Counter {
    overhead: u32,
}

impl Counter {
    /// Address of the counting register: TIM2_CNT in the emulator, DWT_CYCCNT on hardware.
    pub const REGISTER: usize = if cfg!(feature = "hardware") { 0xe000_1004 } else { 0x4000_0024 };

    /// Starts it and measures what two readings in a row cost.
    pub fn start() -> Self {
        start();
        let mut overhead = 0;
        // The first readings come while the emulator still translates the code; the last is the steady state.
        for _ in 0..4 {
            let before = now();
            overhead = black_box(now()).wrapping_sub(before);
        }
        Self { overhead }
    }

    /// The count.
    #[inline(always)]
    pub fn now(&self) -> u32 {
        now()
    }

    /// A difference of two readings without the cost of reading.
    #[inline(always)]
    pub fn net(&self, difference: u32) -> u32 {
        difference.saturating_sub(self.overhead)
    }
}

// QEMU clocks TIM2 at 1 GHz whatever RCC says, and with `-icount shift=0` one instruction takes 1 ns of
// virtual time: one count is one instruction. No write to CNT, PSC or EGR.UG, which QEMU's model gets wrong.
#[cfg(not(feature = "hardware"))]
mod tim2 {
    const TIM2: usize = 0x4000_0000;

    pub fn start() {
        // SAFETY: TIM2's registers on the STM32F405; nothing else in these tests uses the timer.
        unsafe {
            ((TIM2 + 0x2c) as *mut u32).write_volatile(u32::MAX);
            (TIM2 as *mut u32).write_volatile(1);
        }
    }

    #[inline(always)]
    pub fn now() -> u32 {
        // SAFETY: reading CNT has no side effect.
        unsafe { ((TIM2 + 0x24) as *const u32).read_volatile() }
    }
}
#[cfg(not(feature = "hardware"))]
use tim2::{now, start};

#[cfg(feature = "hardware")]
fn start() {
    if let Some(mut core) = cortex_m::Peripherals::take() {
        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();
    }
}

#[cfg(feature = "hardware")]
#[inline(always)]
fn now() -> u32 {
    cortex_m::peripheral::DWT::cycle_count()
}
