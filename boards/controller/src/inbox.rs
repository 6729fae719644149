//! Takes bytes from the serial interrupt. The interrupt separates real-time bytes (feed hold, reset,
//! overrides) from lines.
//!
//! ```text
//!  interrupt                                  task
//!  Receiver::push ─ text ──────→ [ring of N bytes] ─────→ Inbox::byte
//!               └── real time ─→ counters, small ring ──→ Inbox::take, Inbox::next_key
//! ```
//!
//! Every word of the memory has one writer, the interrupt or the task. No lock and no compare-and-swap is
//! needed.
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// Requests of real-time bytes for which only the last byte before a call counts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Request {
    /// `?` (0x80): a status report.
    Report,
    /// `!` (0x82): feed hold.
    Hold,
    /// `~` (0x81): cycle start, resume.
    Start,
    /// 0x18: soft reset.
    Reset,
    /// 0x84: safety door.
    Door,
    /// 0x85: jog cancel.
    JogCancel,
}

/// Number of kinds of [`Request`].
const REQUESTS: usize = 6;

/// Requests of real-time bytes of which each one counts, in their order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Key {
    /// 0x90: feed override to 100 %.
    FeedFull,
    /// 0x91…0x94: change of the feed override, percent.
    Feed(i8),
    /// 0x95, 0x96, 0x97: rapid override, percent.
    Rapid(u8),
    /// 0x99: spindle override to 100 %.
    SpindleFull,
    /// 0x9A…0x9D: change of the spindle override, percent.
    Spindle(i8),
    /// 0x9E: stops or restarts the spindle, in a hold.
    SpindleStop,
    /// 0xA0: flood coolant.
    Flood,
    /// 0xA1: mist coolant.
    Mist,
}

/// Highest number of waiting keys; further keys are dropped.
const KEYS: usize = 64;

/// Kind of a byte.
enum Kind {
    Text,
    Request(Request),
    Key,
    Dropped,
}

const fn kind(byte: u8) -> Kind {
    match byte {
        b'?' | 0x80 => Kind::Request(Request::Report),
        b'!' | 0x82 => Kind::Request(Request::Hold),
        b'~' | 0x81 => Kind::Request(Request::Start),
        RESET => Kind::Request(Request::Reset),
        0x84 => Kind::Request(Request::Door),
        0x85 => Kind::Request(Request::JogCancel),
        0x90..=0x97 | 0x99..=0x9e | 0xa0 | 0xa1 => Kind::Key,
        0x80.. => Kind::Dropped,
        _ => Kind::Text,
    }
}

/// Whether a byte is text. All other bytes act at once, or are dropped.
#[must_use]
pub const fn is_text(byte: u8) -> bool {
    matches!(kind(byte), Kind::Text)
}

/// 0x18: the soft reset, which drops the text before it.
pub const RESET: u8 = 0x18;

const fn key(byte: u8) -> Option<Key> {
    Some(match byte {
        0x90 => Key::FeedFull,
        0x91 => Key::Feed(10),
        0x92 => Key::Feed(-10),
        0x93 => Key::Feed(1),
        0x94 => Key::Feed(-1),
        0x95 => Key::Rapid(100),
        0x96 => Key::Rapid(50),
        0x97 => Key::Rapid(25),
        0x99 => Key::SpindleFull,
        0x9a => Key::Spindle(10),
        0x9b => Key::Spindle(-10),
        0x9c => Key::Spindle(1),
        0x9d => Key::Spindle(-1),
        0x9e => Key::SpindleStop,
        0xa0 => Key::Flood,
        0xa1 => Key::Mist,
        _ => return None,
    })
}

/// A ring of bytes with one writer for each word.
struct Ring<const N: usize> {
    bytes: [AtomicU8; N],
    /// Number of bytes put in. Written by the interrupt.
    put: AtomicU32,
    /// Number of bytes taken out. Written by the task.
    taken: AtomicU32,
}

impl<const N: usize> Ring<N> {
    const SIZE: u32 = {
        assert!(N.is_power_of_two() && N <= 1 << 30, "a ring is a power of two of bytes");
        N as u32
    };

    const fn new() -> Self {
        let [put, taken] = [const { AtomicU32::new(0) }; 2];
        Self { bytes: [const { AtomicU8::new(0) }; N], put, taken }
    }

    fn place(&self, count: u32) -> Option<&AtomicU8> {
        self.bytes.get((count & (Self::SIZE - 1)) as usize)
    }

    fn used(&self) -> u32 {
        self.put.load(Ordering::Acquire).wrapping_sub(self.taken.load(Ordering::Acquire))
    }

    /// Puts a byte in; called by the interrupt. Returns whether there was room.
    fn push(&self, byte: u8) -> bool {
        let put = self.put.load(Ordering::Relaxed);
        if self.used() >= Self::SIZE {
            return false;
        }
        if let Some(place) = self.place(put) {
            place.store(byte, Ordering::Relaxed);
        }
        self.put.store(put.wrapping_add(1), Ordering::Release);
        true
    }

    /// Takes a byte out; called by the task.
    fn pop(&self) -> Option<u8> {
        let taken = self.taken.load(Ordering::Relaxed);
        if self.used() == 0 {
            return None;
        }
        let byte = self.place(taken).map(|place| place.load(Ordering::Relaxed));
        self.taken.store(taken.wrapping_add(1), Ordering::Release);
        byte
    }
}

/// Memory of a serial input with room for `N` bytes of text, a power of two. Use 1,024 or more, because some
/// senders send more than Grbl's 128 bytes. A new memory is all zero.
pub struct Serial<const N: usize> {
    text: Ring<N>,
    keys: Ring<KEYS>,
    /// Number of requests of each kind. Written by the interrupt.
    requests: [AtomicU8; REQUESTS],
    /// Start of the text after the last reset. Written by the interrupt.
    fresh: AtomicU32,
    /// Number of text bytes without room. Written by the interrupt.
    lost: AtomicU32,
}

impl<const N: usize> Serial<N> {
    /// Empty memory.
    pub const fn new() -> Self {
        Self {
            text: Ring::new(),
            keys: Ring::new(),
            requests: [const { AtomicU8::new(0) }; REQUESTS],
            fresh: AtomicU32::new(0),
            lost: AtomicU32::new(0),
        }
    }

    /// Returns the handle for the interrupt, and the handle for the controller. Earlier content is dropped.
    pub fn split(&mut self) -> (Receiver<'_, N>, Inbox<'_, N>) {
        *self = Self::new();
        (Receiver { serial: self }, Inbox { serial: self, seen: [0; REQUESTS] })
    }
}

impl<const N: usize> Default for Serial<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// The interrupt's handle of the serial input.
pub struct Receiver<'a, const N: usize> {
    serial: &'a Serial<N>,
}

impl<const N: usize> Receiver<'_, N> {
    /// Takes a byte. A byte of text without room is lost, and counted. Bounded time.
    pub fn push(&mut self, byte: u8) {
        let serial = self.serial;
        match kind(byte) {
            Kind::Text if serial.text.push(byte) => {}
            Kind::Text => {
                serial.lost.store(serial.lost.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
            }
            Kind::Request(request) => {
                if request == Request::Reset {
                    serial.fresh.store(serial.text.put.load(Ordering::Relaxed), Ordering::Release);
                }
                if let Some(count) = serial.requests.get(request as usize) {
                    count.store(count.load(Ordering::Relaxed).wrapping_add(1), Ordering::Release);
                }
            }
            // A full ring holds 64 keys that the task has not read.
            Kind::Key => _ = serial.keys.push(byte),
            Kind::Dropped => {}
        }
    }

    /// Number of text bytes for which there is room now.
    pub fn room(&self) -> usize {
        Ring::<N>::SIZE.saturating_sub(self.serial.text.used()) as usize
    }
}

/// The controller's handle of the serial input.
pub struct Inbox<'a, const N: usize> {
    serial: &'a Serial<N>,
    /// Number of requests taken, for each kind.
    seen: [u8; REQUESTS],
}

impl<const N: usize> Inbox<'_, N> {
    /// Returns the next byte of text.
    pub(crate) fn byte(&mut self) -> Option<u8> {
        self.serial.text.pop()
    }

    /// Whether a request of this kind came since the last call.
    pub(crate) fn take(&mut self, request: Request) -> bool {
        let (Some(count), Some(seen)) =
            (self.serial.requests.get(request as usize), self.seen.get_mut(request as usize))
        else {
            return false;
        };
        let count = count.load(Ordering::Acquire);
        core::mem::replace(seen, count) != count
    }

    /// Drops the text and the keys before the last reset.
    pub(crate) fn restart(&mut self) {
        let text = &self.serial.text;
        let fresh = self.serial.fresh.load(Ordering::Acquire);
        // The task may have read beyond the reset already.
        if fresh.wrapping_sub(text.taken.load(Ordering::Relaxed)) as i32 > 0 {
            text.taken.store(fresh, Ordering::Release);
        }
        while self.serial.keys.pop().is_some() {}
    }

    /// Returns the next key.
    pub(crate) fn next_key(&mut self) -> Option<Key> {
        self.serial.keys.pop().and_then(key)
    }

    /// Number of text bytes for which there is room now.
    pub(crate) fn room(&self) -> usize {
        Ring::<N>::SIZE.saturating_sub(self.serial.text.used()) as usize
    }

    /// Number of text bytes lost since the start.
    pub fn lost(&self) -> u32 {
        self.serial.lost.load(Ordering::Relaxed)
    }
}
