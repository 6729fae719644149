//! Reactions to failures: faults stop the steps, and the watchdog restarts the chip.
//!
//! A fault stops timer, stream and spindle at once, and waits. The watchdog then resets the chip. Afterwards
//! the controller begins in Alarm, because the position may be lost.
#[cfg(feature = "hardware")]
use stm32f4::stm32f405::IWDG;
use stm32f4::stm32f405::Peripherals;

/// About two seconds: 32 kHz divided by 64, 1,000 counts. An erase of a sector takes at most half a second.
#[cfg(feature = "hardware")]
const RELOAD: u16 = 1000;

/// Stops the steps, the spindle and coolant.
fn stop() {
    crate::words::stop();
    crate::outputs::all_off();
}

/// A failed check in the firmware.
#[cfg(not(any(feature = "rtt", feature = "qemu")))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    stop();
    loop {
        cortex_m::asm::nop();
    }
}

#[cortex_m_rt::exception]
unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
    stop();
    #[cfg(feature = "qemu")]
    cortex_m_semihosting::debug::exit(cortex_m_semihosting::debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::nop();
    }
}

/// An interrupt or exception without a handler.
#[cortex_m_rt::exception]
unsafe fn DefaultHandler(_: i16) -> ! {
    stop();
    loop {
        cortex_m::asm::nop();
    }
}

/// Whether the watchdog has reset the chip; the call clears the mark.
pub fn was_reset_by_watchdog(board: &Peripherals) -> bool {
    let was = board.RCC.csr().read().wdgrstf().bit_is_set();
    board.RCC.csr().modify(|_, w| w.rmvf().set_bit());
    was
}

/// The watchdog. The main loop must reload it, and only does so while ticks come.
pub struct Watchdog {
    ticks: u32,
}

impl Watchdog {
    /// Starts the watchdog, which cannot be stopped.
    #[cfg_attr(not(feature = "hardware"), expect(unused_variables, reason = "the emulator has none"))]
    pub fn start(board: &Peripherals) -> Self {
        #[cfg(feature = "hardware")]
        {
            board.IWDG.kr().write(|w| w.key().start());
            board.IWDG.kr().write(|w| w.key().unlock());
            board.IWDG.pr().write(|w| w.pr().divide_by64());
            board.IWDG.rlr().write(|w| w.rl().set(RELOAD));
            board.IWDG.kr().write(|w| w.key().feed());
        }
        Self { ticks: 0 }
    }

    /// Called from the main loop: reloads the watchdog if another tick has come.
    pub fn feed(&mut self, ticks: u32) {
        if core::mem::replace(&mut self.ticks, ticks) != ticks {
            #[cfg(feature = "hardware")]
            // SAFETY: a write of the key that reloads the counter.
            unsafe { &*IWDG::ptr() }.kr().write(|w| w.key().feed());
        }
    }
}
