//! Messages by defmt, if a feature selects a transport. Without such a feature, messages do not exist and
//! their arguments are not evaluated.
use crate::motion::Report;

#[cfg(all(feature = "rtt", not(feature = "qemu")))]
use defmt_rtt as _;
#[cfg(feature = "qemu")]
use defmt_semihosting as _;
#[cfg(any(feature = "rtt", feature = "qemu"))]
use panic_probe as _;

macro_rules! levels {
    ($($level:ident),+) => {$(
        #[cfg(any(feature = "rtt", feature = "qemu"))]
        pub(crate) use defmt::$level;
    )+};
}
levels!(debug, error, info);

#[cfg(not(any(feature = "rtt", feature = "qemu")))]
macro_rules! nothing {
    ($($argument:tt)*) => {
        ()
    };
}
#[cfg(not(any(feature = "rtt", feature = "qemu")))]
pub(crate) use {nothing as debug, nothing as error, nothing as info};

/// Ends the program. In QEMU this also ends the emulator, after one line on its error output.
pub fn end(report: Report) {
    #[cfg(feature = "qemu")]
    {
        use cortex_m_semihosting::{debug, heprintln};
        let Report { ticks, starved, missed, longest, digest } = report;
        let digest = digest.value();
        heprintln!("ticks {ticks} starved {starved} missed {missed} longest {longest} digest {digest:016x}");
        debug::exit(debug::EXIT_SUCCESS);
    }
    #[cfg(not(feature = "qemu"))]
    let _ = report;
}
