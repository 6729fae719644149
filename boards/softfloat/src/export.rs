//! The names under which the compiler calls the functions. The linker takes these functions, because those of
//! the compiler are weak.
#[allow(clippy::wildcard_imports)]
use crate::*;

/// Functions under their names on ARM (IHI 0043, 4.1.2) and on RISC-V.
macro_rules! export {
    ($($arm:ident $riscv:ident ($($argument:ident: $from:ty),*) -> $to:ty { $value:expr })*) => {$(
        #[cfg(target_arch = "arm")]
        #[unsafe(no_mangle)]
        extern "aapcs" fn $arm($($argument: $from),*) -> $to {
            $value
        }
        #[cfg(target_arch = "riscv32")]
        #[unsafe(no_mangle)]
        extern "C" fn $riscv($($argument: $from),*) -> $to {
            $value
        }
    )*};
}

export! {
    __aeabi_ul2f __floatundisf(x: u64) -> u32 { from_u64(x) }
    __aeabi_l2f __floatdisf(x: i64) -> u32 { from_i64(x) }
    __aeabi_f2uiz __fixunssfsi(x: u32) -> u32 { to_u32(x) }
    __aeabi_f2iz __fixsfsi(x: u32) -> i32 { to_i32(x) }
    __aeabi_f2ulz __fixunssfdi(x: u32) -> u64 { to_u64(x) }
    __aeabi_f2lz __fixsfdi(x: u32) -> i64 { to_i64(x) }
}

#[cfg(not(all(target_arch = "arm", narrow)))]
export! {
    __aeabi_fadd __addsf3(a: u32, b: u32) -> u32 { add(a, b) }
    __aeabi_fsub __subsf3(a: u32, b: u32) -> u32 { sub(a, b) }
    __aeabi_fmul __mulsf3(a: u32, b: u32) -> u32 { mul(a, b) }
    __aeabi_fdiv __divsf3(a: u32, b: u32) -> u32 { div(a, b) }
    __aeabi_ui2f __floatunsisf(x: u32) -> u32 { from_u32(x) }
    __aeabi_i2f __floatsisf(x: i32) -> u32 { from_i32(x) }
}

#[cfg(target_arch = "arm")]
#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_fcmpeq(a: u32, b: u32) -> u32 {
    equal(a, b).into()
}

#[cfg(target_arch = "arm")]
#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_fcmpun(a: u32, b: u32) -> u32 {
    unordered(a, b).into()
}

#[cfg(all(target_arch = "arm", not(narrow)))]
mod arm {
    use super::*;

    #[unsafe(no_mangle)]
    extern "aapcs" fn __aeabi_frsub(a: u32, b: u32) -> u32 {
        sub(b, a)
    }

    #[unsafe(no_mangle)]
    extern "aapcs" fn __aeabi_fcmplt(a: u32, b: u32) -> u32 {
        less(a, b).into()
    }

    #[unsafe(no_mangle)]
    extern "aapcs" fn __aeabi_fcmple(a: u32, b: u32) -> u32 {
        less_or_equal(a, b).into()
    }

    #[unsafe(no_mangle)]
    extern "aapcs" fn __aeabi_fcmpgt(a: u32, b: u32) -> u32 {
        less(b, a).into()
    }

    #[unsafe(no_mangle)]
    extern "aapcs" fn __aeabi_fcmpge(a: u32, b: u32) -> u32 {
        less_or_equal(b, a).into()
    }
}

#[cfg(target_arch = "riscv32")]
mod riscv {
    use super::*;

    /// Negative, 0 or positive for a less than, equal to or greater than b; `nan` with a NaN.
    #[inline(always)]
    fn compare(a: u32, b: u32, nan: i32) -> i32 {
        if unordered(a, b) { nan } else { i32::from(less(b, a)) - i32::from(less(a, b)) }
    }

    #[unsafe(no_mangle)]
    extern "C" fn __ltsf2(a: u32, b: u32) -> i32 {
        compare(a, b, 1)
    }

    #[unsafe(no_mangle)]
    extern "C" fn __lesf2(a: u32, b: u32) -> i32 {
        compare(a, b, 1)
    }

    #[unsafe(no_mangle)]
    extern "C" fn __gtsf2(a: u32, b: u32) -> i32 {
        compare(a, b, -1)
    }

    #[unsafe(no_mangle)]
    extern "C" fn __gesf2(a: u32, b: u32) -> i32 {
        compare(a, b, -1)
    }

    #[unsafe(no_mangle)]
    extern "C" fn __eqsf2(a: u32, b: u32) -> i32 {
        (!equal(a, b)).into()
    }

    #[unsafe(no_mangle)]
    extern "C" fn __nesf2(a: u32, b: u32) -> i32 {
        (!equal(a, b)).into()
    }

    #[unsafe(no_mangle)]
    extern "C" fn __unordsf2(a: u32, b: u32) -> i32 {
        unordered(a, b).into()
    }
}
