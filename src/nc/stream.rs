//! Program text that arrives byte by byte: a window of `N` bytes between a serial task and the decoder.
//!
//! ```text
//!  serial task or interrupt                                             planner
//!  Feeder::push → [ kept: up to N/2 bytes | current line, text ahead ] → Stream (a Text)
//! ```
//!
//! Different tasks, interrupts or cores may own the two handles. Each word of the window has one writer, so
//! the window needs no lock and no compare-and-swap.
//!
//! The window drops text that is more than `N`/2 bytes before the furthest line that the decoder has reached.
//! So only the text decides whether a loop, a jump back or a subroutine call finds its target; the arrival
//! times of bytes have no effect. The decoder refuses a line whose target was dropped
//! ([`super::NcErrorKind::BehindWindow`]), and a line of more than `N`/2 bytes, comments included.
use super::{Text, TextError};
use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering};

/// Memory of a stream of program text: `N` bytes, a power of two and at least 64. All bits are zero when new.
///
/// ```
/// use glidepath::nc::{Text, TextError, Window};
///
/// let mut window = Window::<256>::new();
/// let (mut feeder, mut text) = window.split();
/// assert_eq!(feeder.push(b"G00 X1\n"), 7);
/// let mut line = [0; 16];
/// assert_eq!(text.read(0, 0, &mut line), Ok(7));
/// assert_eq!(text.read(0, 7, &mut line), Err(TextError::NotYet));
/// feeder.end();
/// assert_eq!(text.read(0, 7, &mut line), Ok(0));
/// ```
pub struct Window<const N: usize> {
    bytes: [AtomicU8; N],
    /// Number of bytes written since the split. The feeder writes this word, `start` and `ended`.
    put: AtomicU32,
    /// Bytes before this offset are skipped.
    start: AtomicU32,
    /// Whether the text is complete.
    ended: AtomicBool,
    /// Offset of the first byte that is kept. The decoder writes this word.
    kept: AtomicU32,
}

/// The writer's handle of a [`Window`]. The handle may move to another task, an interrupt, or another core.
pub struct Feeder<'a, const N: usize> {
    window: &'a Window<N>,
}

/// The decoder's handle of a [`Window`]. A stream that is loaded again begins at the last
/// [`Feeder::restart`]. Without a restart, it begins at its first byte, which the window may have dropped.
pub struct Stream<'a, const N: usize> {
    window: &'a Window<N>,
    /// Start of the current program.
    start: u32,
}

/// Whether the offset `a` is before `b`. The offsets must be less than 2^31 apart.
const fn is_before(a: u32, b: u32) -> bool {
    (a.wrapping_sub(b) as i32) < 0
}

impl<const N: usize> Window<N> {
    const BYTES: u32 = {
        assert!(
            N.is_power_of_two() && N >= 64 && N <= 1 << 30,
            "a window is a power of two of bytes, 64 at least"
        );
        N as u32
    };

    /// A window without text.
    pub const fn new() -> Self {
        let [put, start, kept] = [const { AtomicU32::new(0) }; 3];
        Self { bytes: [const { AtomicU8::new(0) }; N], put, start, ended: AtomicBool::new(false), kept }
    }

    /// Empties the window and returns its two handles.
    pub fn split(&mut self) -> (Feeder<'_, N>, Stream<'_, N>) {
        for word in [&mut self.put, &mut self.start, &mut self.kept] {
            *word.get_mut() = 0;
        }
        *self.ended.get_mut() = false;
        (Feeder { window: self }, Stream { window: self, start: 0 })
    }

    /// The place of the byte at `offset`.
    fn byte(&self, offset: u32) -> Option<&AtomicU8> {
        self.bytes.get((offset & (Self::BYTES - 1)) as usize)
    }
}

impl<const N: usize> Default for Window<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Feeder<'_, N> {
    /// Number of bytes that [`Self::push`] can take now.
    pub fn room(&self) -> usize {
        let kept = self.window.kept.load(Ordering::Acquire);
        let used = self.window.put.load(Ordering::Relaxed).wrapping_sub(kept);
        Window::<N>::BYTES.saturating_sub(used) as usize
    }

    /// Writes as many bytes as fit, and returns their number. Pass the other bytes again later. Cost: bounded by the
    /// length of `bytes`.
    pub fn push(&mut self, bytes: &[u8]) -> usize {
        let put = self.window.put.load(Ordering::Relaxed);
        let count = bytes.len().min(self.room());
        for (byte, k) in bytes.iter().take(count).zip(0..) {
            if let Some(place) = self.window.byte(put.wrapping_add(k)) {
                place.store(*byte, Ordering::Relaxed);
            }
        }
        self.window.put.store(put.wrapping_add(count as u32), Ordering::Release);
        count
    }

    /// Marks the text as complete: the program ends after the last byte.
    pub fn end(&mut self) {
        self.window.ended.store(true, Ordering::Release);
    }

    /// Announces another program: bytes that were written and not read are dropped. Call `restart` after an
    /// abort, before the stream is loaded again. The announcement acts when
    /// [`crate::channel::Planner::load_next`] or [`crate::channel::Planner::load`] loads the stream.
    pub fn restart(&mut self) {
        self.window.ended.store(false, Ordering::Relaxed);
        self.window.start.store(self.window.put.load(Ordering::Relaxed), Ordering::Release);
    }
}

impl<const N: usize> Text for Stream<'_, N> {
    fn read(&mut self, file: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        if file != 0 {
            return Err(TextError::Failed);
        }
        if !self.holds(file, offset) {
            return Err(TextError::Forgotten);
        }
        // Read before `put`, because no byte follows after the end.
        let ended = self.window.ended.load(Ordering::Acquire);
        let there = self.window.put.load(Ordering::Acquire).wrapping_sub(offset);
        if there as i32 <= 0 {
            let kept = self.window.kept.load(Ordering::Relaxed);
            return match offset.wrapping_sub(kept) {
                _ if ended => Ok(0),
                ahead if ahead >= Window::<N>::BYTES => Err(TextError::Forgotten),
                _ => Err(TextError::NotYet),
            };
        }
        let count = buffer.len().min(there as usize);
        for (to, k) in buffer.iter_mut().take(count).zip(0..) {
            *to = self.window.byte(offset.wrapping_add(k)).map_or(0, |byte| byte.load(Ordering::Relaxed));
        }
        Ok(count)
    }

    fn pass(&mut self, _: u16, offset: u32) {
        let (kept, half) = (self.window.kept.load(Ordering::Relaxed), Window::<N>::BYTES / 2);
        // The new offset is far enough before the line, and further than the last one.
        if offset.wrapping_sub(kept) as i32 > half as i32 {
            self.window.kept.store(offset.wrapping_sub(half), Ordering::Release);
        }
    }

    fn holds(&self, _: u16, offset: u32) -> bool {
        !is_before(offset, self.window.kept.load(Ordering::Relaxed))
    }

    fn start(&mut self) -> u32 {
        self.start = self.window.start.load(Ordering::Acquire);
        self.pass(0, self.start);
        self.start
    }

    fn next_program(&mut self) -> Option<u32> {
        let before = self.start;
        let start = self.start();
        (start != before).then_some(start)
    }
}
