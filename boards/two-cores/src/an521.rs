//! QEMU's mps2-an521: two Cortex-M33, of which the second one waits until the first one lets it run.
use crate::motion::{self, SEEN};
use core::fmt::Write;
use core::sync::atomic::Ordering::Relaxed;
use cortex_m_semihosting::{debug, hio};

/// SysTick's clock in the emulator.
pub const CLOCK_HZ: u32 = 20_000_000;

/// System control of the SSE-200: where core 1 finds its vector table, and which core waits.
const INITSVTOR1: *mut u32 = 0x5002_1114 as *mut u32;
const CPUWAIT: *mut u32 = 0x5002_1118 as *mut u32;

/// Vector table of core 1, in RAM: stack, start, exceptions up to SysTick.
#[repr(C, align(128))]
struct Vectors([u32; 16]);

static mut VECTORS: Vectors = Vectors([0; 16]);

/// Lets core 1 run from `entry`.
pub fn start_other_core(entry: extern "C" fn() -> !) {
    let mut table = [fault as extern "C" fn() as usize as u32; 16];
    table[0] = motion::stack_top();
    table[1] = entry as usize as u32;
    table[15] = motion::tick as extern "C" fn() as usize as u32;
    // SAFETY: core 1 waits; registers of the system control as the SSE-200's manual has them.
    unsafe {
        VECTORS = Vectors(table);
        INITSVTOR1.write_volatile((&raw const VECTORS) as u32);
        cortex_m::asm::dsb();
        CPUWAIT.write_volatile(0);
    }
}

extern "C" fn fault() {
    end(false)
}

/// Ends the emulation with what core 1 has seen.
pub fn end(success: bool) -> ! {
    if success && let Ok(mut host) = hio::hstdout() {
        let [low, high] = [&SEEN.digest[0], &SEEN.digest[1]].map(|half| half.load(Relaxed));
        let [ticks, starved, beside] =
            [&SEEN.ticks, &SEEN.starved, &SEEN.beside].map(|count| count.load(Relaxed));
        let _ = writeln!(host, "ticks {ticks} starved {starved} beside {beside} digest {high:08x}{low:08x}");
    }
    loop {
        debug::exit(if success { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    }
}
