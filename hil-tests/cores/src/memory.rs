//! The channel that a binary has, without a compare-and-swap, which some of these cores do not know.
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use glidepath::channel::Channel;
use hil_cases::SHORT;

static mut CHANNEL: Channel<3, SHORT> = Channel::new();
static TAKEN: AtomicBool = AtomicBool::new(false);

/// The channel, the first time that it is asked for. One core asks, without an interrupt.
pub fn channel() -> Option<&'static mut Channel<3, SHORT>> {
    if TAKEN.load(Relaxed) {
        return None;
    }
    TAKEN.store(true, Relaxed);
    // SAFETY: nobody has a reference to it yet, and nobody gets another one.
    let channel = &raw mut CHANNEL;
    Some(unsafe { &mut *channel })
}
