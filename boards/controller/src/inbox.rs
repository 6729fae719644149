//! Bytes from the serial interrupt. Real-time bytes are taken out at once and never reach a line.
//!
//! ```text
//!  interrupt                                  task
//!  Receiver::push ─ text ──────→ [ring of N bytes] ─────→ Inbox::byte
//!               └── real time ─→ counters, small ring ──→ Inbox::take, Inbox::next_key
//! ```
//!
//! Every word of the memory has one writer, the interrupt or the task. No lock and no compare-and-swap is needed.
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// What a real-time byte asks for, where only the last one before a look counts.
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

/// Number of [`Request`]s.
const REQUESTS: usize = 6;

/// What a real-time byte asks for, where each one counts, in their order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Key {
    /// 0x90: 100 %.
    FeedFull,
    /// 0x91…0x94: percent more.
    Feed(i8),
    /// 0x95, 0x96, 0x97: percent.
    Rapid(u8),
    /// 0x99: 100 %.
    SpindleFull,
    /// 0x9A…0x9D: percent more.
    Spindle(i8),
    /// 0x9E: stop and go on, in a hold.
    SpindleStop,
    /// 0xA0.
    Flood,
    /// 0xA1.
    Mist,
}

/// Keys that wait at most; more are dropped.
const KEYS: usize = 64;

/// What becomes of a byte.
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
        0x18 => Kind::Request(Request::Reset),
        0x84 => Kind::Request(Request::Door),
        0x85 => Kind::Request(Request::JogCancel),
        0x90..=0x97 | 0x99..=0x9e | 0xa0 | 0xa1 => Kind::Key,
        0x80.. => Kind::Dropped,
        _ => Kind::Text,
    }
}

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
    /// Bytes put in. Written by the interrupt.
    put: AtomicU32,
    /// Bytes taken out. Written by the task.
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

    /// For the interrupt. Whether there was room.
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

    /// For the task.
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

/// Memory of a serial input with room for `N` bytes of text, a power of two. 1,024 or more are advised: some senders
/// send more than the 128 bytes that Grbl has. All bits are zero when new.
pub struct Serial<const N: usize> {
    text: Ring<N>,
    keys: Ring<KEYS>,
    /// Requests of each kind. Written by the interrupt.
    requests: [AtomicU8; REQUESTS],
    /// Where the text behind the last reset begins. Written by the interrupt.
    fresh: AtomicU32,
    /// Bytes of text that found no room. Written by the interrupt.
    lost: AtomicU32,
}

impl<const N: usize> Serial<N> {
    /// Empty.
    pub const fn new() -> Self {
        Self {
            text: Ring::new(),
            keys: Ring::new(),
            requests: [const { AtomicU8::new(0) }; REQUESTS],
            fresh: AtomicU32::new(0),
            lost: AtomicU32::new(0),
        }
    }

    /// Both ends: for the interrupt, and for the controller. Nothing that was in it counts.
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

/// The end of the serial interrupt.
pub struct Receiver<'a, const N: usize> {
    serial: &'a Serial<N>,
}

impl<const N: usize> Receiver<'_, N> {
    /// Takes a byte. A byte of text that finds no room is lost, and counted. Bounded.
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
            // A ring that is full has 64 presses of keys that nobody looked at.
            Kind::Key => _ = serial.keys.push(byte),
            Kind::Dropped => {}
        }
    }

    /// Bytes of text that it takes now.
    pub fn room(&self) -> usize {
        Ring::<N>::SIZE.saturating_sub(self.serial.text.used()) as usize
    }
}

/// The end of the controller.
pub struct Inbox<'a, const N: usize> {
    serial: &'a Serial<N>,
    /// Requests taken.
    seen: [u8; REQUESTS],
}

impl<const N: usize> Inbox<'_, N> {
    /// The next byte of text.
    pub(crate) fn byte(&mut self) -> Option<u8> {
        self.serial.text.pop()
    }

    /// Whether something was asked for since the last call.
    pub(crate) fn take(&mut self, request: Request) -> bool {
        let (Some(count), Some(seen)) =
            (self.serial.requests.get(request as usize), self.seen.get_mut(request as usize))
        else {
            return false;
        };
        let count = count.load(Ordering::Acquire);
        core::mem::replace(seen, count) != count
    }

    /// Forgets the text before the last reset. Keys pressed before it are forgotten too.
    pub(crate) fn restart(&mut self) {
        let text = &self.serial.text;
        let fresh = self.serial.fresh.load(Ordering::Acquire);
        // The task may have read further already.
        if fresh.wrapping_sub(text.taken.load(Ordering::Relaxed)) as i32 > 0 {
            text.taken.store(fresh, Ordering::Release);
        }
        while self.serial.keys.pop().is_some() {}
    }

    /// The next key.
    pub(crate) fn next_key(&mut self) -> Option<Key> {
        self.serial.keys.pop().and_then(key)
    }

    /// Bytes of text that find room now.
    pub(crate) fn room(&self) -> usize {
        Ring::<N>::SIZE.saturating_sub(self.serial.text.used()) as usize
    }

    /// Bytes of text that were lost since the start, because no room was left.
    pub fn lost(&self) -> u32 {
        self.serial.lost.load(Ordering::Relaxed)
    }
}
