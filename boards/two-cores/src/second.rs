//! Starts the second core of QEMU's `mps2-an521`: the only part that differs from chip to chip.
use core::ptr;

/// Registers of the system control block: where the vectors of core 1 begin, and which cores wait.
const INITSVTOR1: *mut u32 = 0x5002_1114 as *mut u32;
const CPUWAIT: *mut u32 = 0x5002_1118 as *mut u32;

/// Bytes of the second core's stack.
const STACK: usize = 4096;

#[repr(C, align(8))]
struct Stack([u8; STACK]);

static mut STACK_OF_SECOND: Stack = Stack([0; STACK]);

/// Vectors of the second core: stack, start, and the exceptions up to SysTick.
#[repr(C, align(128))]
struct Vectors {
    stack: *const Stack,
    start: extern "C" fn() -> !,
    faults: [unsafe extern "C" fn() -> !; 12],
    reserved: usize,
    systick: extern "C" fn(),
}

// SAFETY: nothing writes the vectors; the hardware alone reads the stack's address.
unsafe impl Sync for Vectors {}

unsafe extern "C" {
    safe fn HardFault() -> !;
}

extern "C" fn start() -> ! {
    crate::tick_core()
}

extern "C" fn fault() -> ! {
    HardFault()
}

static VECTORS: Vectors = Vectors {
    stack: (&raw const STACK_OF_SECOND).wrapping_add(1),
    start,
    faults: [fault; 12],
    reserved: 0,
    systick: crate::tick,
};

/// Lets the second core run `tick_core`. What the first core wrote before is visible there.
pub fn start_second_core() {
    cortex_m::asm::dmb();
    // SAFETY: registers of the machine; the second core waits, so nothing else uses its vectors and its stack.
    unsafe {
        INITSVTOR1.write_volatile(ptr::from_ref(&VECTORS).addr() as u32);
        CPUWAIT.write_volatile(0);
    }
}
