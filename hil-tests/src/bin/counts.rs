//! The proof that the counter counts instructions, and that copies of memory are copies, and zeros are zeros.
#![no_std]
#![no_main]
use core::fmt::Write;
use core::hint::black_box;
use core::ptr;
use cortex_m_rt::entry;
use hil_tests::{Counter, Report, UNIT, exit};
use panic_semihosting as _;

macro_rules! nops {
    ($report:ident $counter:ident: $($count:literal),+) => {$(
        let (before, after): (u32, u32);
        // One piece of assembly, so that the compiler moves nothing in between the two readings.
        // SAFETY: reads the counter's register and does nothing.
        unsafe {
            core::arch::asm!(
                "ldr {before}, [{register}]",
                concat!(".rept ", $count, "\n nop\n .endr"),
                "ldr {after}, [{register}]",
                register = in(reg) Counter::REGISTER, before = out(reg) before, after = out(reg) after,
            );
        }
        let cost = $counter.net(after.wrapping_sub(before));
        let _ = writeln!($report, "nops {} counted {cost}", $count);
    )+};
}

/// Bytes to copy in, from places up to [`PLACES`] and so many at most.
const BYTES: usize = 96;
const PLACES: usize = 24;
const MOST: usize = 67;

/// Words of eight bytes, so that every alignment is there.
#[repr(align(8))]
struct Memory([u8; BYTES]);

impl Memory {
    fn new() -> Self {
        let mut bytes = [0; BYTES];
        for (i, byte) in bytes.iter_mut().enumerate() {
            *byte = i as u8 ^ 0x5a;
        }
        Self(bytes)
    }
}

/// Copies of words that may overlap, and of words that do not, against copies byte by byte.
fn copies<T>(from: usize, to: usize, words: usize) -> bool {
    let size = size_of::<T>();
    let bytes = words * size;
    let mut expected = Memory::new();
    let source = Memory::new();
    for i in 0..bytes {
        expected.0[to + i] = source.0[from + i];
    }
    let mut moved = black_box(Memory::new());
    let base = black_box(moved.0.as_mut_ptr());
    // SAFETY: both ranges are inside the memory, and aligned: places are multiples of the size.
    unsafe { ptr::copy(base.add(from).cast::<T>(), base.add(to).cast::<T>(), words) };
    let mut copied = black_box(Memory::new());
    let (from, to) =
        (black_box(source.0.as_ptr()).wrapping_add(from), copied.0.as_mut_ptr().wrapping_add(to));
    // SAFETY: the same, and they are two memories.
    unsafe { ptr::copy_nonoverlapping(from.cast::<T>(), to.cast::<T>(), words) };
    black_box(&moved).0 == expected.0 && black_box(&copied).0 == expected.0
}

/// Words that become zero, and no other bytes, byte by byte.
fn zeros<T>(at: usize, words: usize) -> bool {
    let bytes = words * size_of::<T>();
    let mut expected = Memory::new();
    for byte in expected.0.iter_mut().skip(at).take(bytes) {
        *byte = 0;
    }
    let mut cleared = black_box(Memory::new());
    let base = black_box(cleared.0.as_mut_ptr());
    // SAFETY: the range is inside the memory, and aligned: the place is a multiple of the size.
    unsafe { ptr::write_bytes(base.add(at).cast::<T>(), 0, words) };
    black_box(&cleared).0 == expected.0
}

/// The same at all places, with all lengths; how many there are, if they are right.
fn all_zeros<T>() -> Option<usize> {
    let size = size_of::<T>();
    let mut count = 0;
    for at in (0..PLACES).step_by(size) {
        for words in 0..=MOST / size {
            if !zeros::<T>(at, black_box(words)) {
                return None;
            }
            count += 1;
        }
    }
    Some(count)
}

/// Copies from and to all places, with all lengths; how many there are, if they are right.
fn all_copies<T>() -> Option<usize> {
    let size = size_of::<T>();
    let mut count = 0;
    for from in (0..PLACES).step_by(size) {
        for to in (0..PLACES).step_by(size) {
            for words in 0..=MOST / size {
                if !copies::<T>(from, to, black_box(words)) {
                    return None;
                }
                count += 1;
            }
        }
    }
    Some(count)
}

#[entry]
fn main() -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let _ = writeln!(report, "unit {UNIT}");
    nops!(report counter: 0, 1, 10, 100, 1000);
    let mut good = true;
    for (size, count) in [(1, all_copies::<u8>()), (4, all_copies::<u32>()), (8, all_copies::<u64>())] {
        let _ = writeln!(report, "copies of {size} bytes: {count:?} right");
        good &= count.is_some();
    }
    for (size, count) in [(1, all_zeros::<u8>()), (4, all_zeros::<u32>()), (8, all_zeros::<u64>())] {
        let _ = writeln!(report, "zeros of {size} bytes: {count:?} right");
        good &= count.is_some();
    }
    report.flush();
    exit(good)
}
