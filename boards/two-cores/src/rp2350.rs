//! RP2350, ARM cores: clock from the crystal, and core 1 started through the boot ROM's mailbox. Registers as in the
//! data sheet of the RP2350; not yet run on hardware.
use crate::motion;

/// The crystal of a Pico 2, on which both cores run here.
pub const CLOCK_HZ: u32 = 12_000_000;

/// Tells the boot ROM that this is a program for the ARM cores in their secure state.
#[used]
#[unsafe(link_section = ".start_block")]
static IMAGE_DEFINITION: [u32; 5] = [0xffff_ded3, 0x1021_0142, 0x0000_01ff, 0, 0xab12_3579];

const XOSC_CTRL: *mut u32 = 0x4004_8000 as *mut u32;
const XOSC_STATUS: *mut u32 = 0x4004_8004 as *mut u32;
const XOSC_STARTUP: *mut u32 = 0x4004_800c as *mut u32;
const CLK_REF_CTRL: *mut u32 = 0x4001_0030 as *mut u32;
const CLK_REF_SELECTED: *mut u32 = 0x4001_0038 as *mut u32;

const FIFO_ST: *mut u32 = 0xd000_0050 as *mut u32;
const FIFO_WR: *mut u32 = 0xd000_0054 as *mut u32;
const FIFO_RD: *mut u32 = 0xd000_0058 as *mut u32;
const FIFO_HAS_WORD: u32 = 1;
const FIFO_HAS_ROOM: u32 = 2;

/// Vector table of core 1: stack, start, exceptions up to SysTick.
#[repr(C, align(128))]
struct Vectors([u32; 16]);

static mut VECTORS: Vectors = Vectors([0; 16]);

/// The crystal becomes the reference clock, which the system clock follows after reset.
fn use_crystal() {
    // SAFETY: registers of the oscillator and the clock generators; nothing else touches them.
    unsafe {
        XOSC_STARTUP.write_volatile(47);
        XOSC_CTRL.write_volatile(0x00fa_baa0);
        while XOSC_STATUS.read_volatile() >> 31 == 0 {}
        CLK_REF_CTRL.write_volatile(2);
        while CLK_REF_SELECTED.read_volatile() & 4 == 0 {}
    }
}

/// Lets core 1 run from `entry`: the boot ROM's protocol, each word of which is answered with itself.
pub fn start_other_core(entry: extern "C" fn() -> !) {
    use_crystal();
    let mut table = [fault as extern "C" fn() as usize as u32; 16];
    table[0] = motion::stack_top();
    table[1] = entry as usize as u32;
    table[15] = motion::tick as extern "C" fn() as usize as u32;
    // SAFETY: core 1 is in the boot ROM and does not look at the table yet.
    unsafe { VECTORS = Vectors(table) };
    cortex_m::asm::dsb();
    let words = [0, 0, 1, (&raw const VECTORS) as u32, motion::stack_top(), entry as usize as u32];
    while !words.iter().all(|&word| is_answered(word)) {}
}

/// Sends a word to core 1; whether the answer is the same.
fn is_answered(word: u32) -> bool {
    // SAFETY: the mailbox between the cores, which nothing else uses.
    unsafe {
        if word == 0 {
            while FIFO_ST.read_volatile() & FIFO_HAS_WORD != 0 {
                FIFO_RD.read_volatile();
            }
            cortex_m::asm::sev();
        }
        while FIFO_ST.read_volatile() & FIFO_HAS_ROOM == 0 {}
        FIFO_WR.write_volatile(word);
        cortex_m::asm::sev();
        while FIFO_ST.read_volatile() & FIFO_HAS_WORD == 0 {
            cortex_m::asm::wfe();
        }
        FIFO_RD.read_volatile() == word
    }
}

extern "C" fn fault() {
    end(false)
}

/// Nothing is left to do; the last set points stay.
pub fn end(_success: bool) -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
