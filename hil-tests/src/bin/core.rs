//! Digests of some cases with a short look-ahead, for cores other than the reference target's: nothing here
//! is of one chip.
#![no_std]
#![no_main]
use core::fmt::Write;
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{AXES_3_SHORT, CASES_3_OTHER, SHORT, Unwatched, run};
use hil_tests::{Report, exit};
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<3, SHORT>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    let channel = CHANNEL.take();
    let mut report = Report::open();
    let mut good = true;
    for case in CASES_3_OTHER {
        let _ = match run(channel, &AXES_3_SHORT, case.text, &mut Unwatched) {
            Ok(outcome) => writeln!(
                report,
                "core {} ticks {} digest {:016x}",
                case.name,
                outcome.ticks,
                outcome.digest.value()
            ),
            Err(failure) => {
                good = false;
                writeln!(report, "failed {}: {failure:?}", case.name)
            }
        };
    }
    report.flush();
    exit(good)
}
