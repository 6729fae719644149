//! What happens when something fails: faults stop the steps, and the watchdog starts the chip again.
//!
//! A fault stops timer, stream and spindle at once and waits. The watchdog then resets the chip. After that the controller
//! begins locked, because the position may be lost.
#[cfg(feature = "hardware")]
use stm32f4::stm32f405::IWDG;
use stm32f4::stm32f405::Peripherals;

/// About two seconds: 32 kHz by 64, 1,000 counts. An erase of a sector takes half a second at most.
#[cfg(feature = "hardware")]
const RELOAD: u16 = 1000;

/// Ends everything that moves.
fn stop() {
    crate::words::stop();
    crate::outputs::all_off();
}

/// A check of the program failed.
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

/// Whether the watchdog has reset the chip; the mark is cleared.
pub fn was_reset_by_watchdog(board: &Peripherals) -> bool {
    let was = board.RCC.csr().read().wdgrstf().bit_is_set();
    board.RCC.csr().modify(|_, w| w.rmvf().set_bit());
    was
}

/// The watchdog. It has to be fed while ticks come and the main loop goes round.
pub struct Watchdog {
    ticks: u32,
}

impl Watchdog {
    /// Starts it, for ever.
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

    /// From the main loop: it is fed if another tick has come.
    pub fn feed(&mut self, ticks: u32) {
        if core::mem::replace(&mut self.ticks, ticks) != ticks {
            #[cfg(feature = "hardware")]
            // SAFETY: a write of the key that reloads the counter.
            unsafe { &*IWDG::ptr() }.kr().write(|w| w.key().feed());
        }
    }
}
