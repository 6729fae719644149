//! A snapshot of the motion that the interrupt writes in every tick and any other context reads, consistent, without a lock.
//!
//! The interrupt writes words one by one: those of a snapshot belong together if no tick has begun while they were read. So the
//! clock says it ([`Clock::ended`], [`Clock::is_at`]): the reader reads again until that is so. It never holds up the interrupt.
//! A word is never torn, and there is nothing but words.
//!
//! The interrupt writes what it has at hand; what can be derived the reader derives. Two path distances, of this tick and the one
//! before, are the speed.
use super::clock::TICK;
use super::{Clock, Gauge, PHASES, Phase};
use crate::quantity::{Distance, Position};
use core::sync::atomic::{AtomicU32, Ordering};

/// What the last tick did, for the reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Snapshot<const AXES: usize> {
    /// Ticks ended, modulo 2^31.
    pub ticks: u32,
    /// The last one took time of a piece.
    pub moved: bool,
    /// Set points after it.
    pub set_points: [Position; AXES],
    /// Path distance.
    pub distance: Distance,
    /// How far the path came in the last tick that took time of a piece.
    pub step: Distance,
    /// Programmed N number.
    pub n: u32,
    /// Motion blocks since program start, from 0.
    pub block: u32,
    /// Pieces of time in the queue.
    pub queued: u16,
}

/// A number of 64 bits in two words.
struct Long([AtomicU32; 2]);

impl Long {
    const fn zero() -> Self {
        Self([const { AtomicU32::new(0) }; 2])
    }

    #[inline(always)]
    fn set(&self, value: i64) {
        let Self([lower, upper]) = self;
        lower.store(value as u32, Ordering::Relaxed);
        upper.store((value >> 32) as u32, Ordering::Relaxed);
    }

    #[inline(always)]
    fn get(&self) -> i64 {
        let Self([lower, upper]) = self;
        let [lower, upper] = [lower, upper].map(|word| word.load(Ordering::Relaxed));
        (u64::from(upper) << 32 | u64::from(lower)) as i64
    }
}

/// The words of the snapshot. Written by the interrupt.
pub struct Words<const AXES: usize> {
    /// Of the last two ticks that took time of a piece, in turn.
    distances: [Long; 2],
    n: AtomicU32,
    block: AtomicU32,
    set_points: [Long; AXES],
}

/// The reader's end.
pub struct Display<'a, const AXES: usize> {
    words: &'a Words<AXES>,
    clock: &'a Clock,
    pieces: Gauge<'a, Phase, PHASES>,
}

impl<const AXES: usize> Words<AXES> {
    /// All bits zero.
    pub const fn blank() -> Self {
        let [n, block] = [const { AtomicU32::new(0) }; 2];
        let distances = [const { Long::zero() }; 2];
        Self { distances, n, block, set_points: [const { Long::zero() }; AXES] }
    }

    /// For the interrupt: path distance at `instant`.
    #[inline(always)]
    pub fn show_distance(&self, instant: u32, distance: i64) {
        let [even, odd] = &self.distances;
        let words = if instant & TICK == 0 { even } else { odd };
        words.set(distance);
    }

    /// For the interrupt: what it has shown last.
    pub fn distance(&self, instant: u32) -> i64 {
        let [even, odd] = &self.distances;
        if instant & TICK == 0 { even.get() } else { odd.get() }
    }

    /// For the interrupt: the curve.
    #[inline(always)]
    pub fn show_curve(&self, n: u32, block: u32) {
        self.n.store(n, Ordering::Relaxed);
        self.block.store(block, Ordering::Relaxed);
    }

    /// For the interrupt: set points.
    #[inline(always)]
    pub fn show_points(&self, set_points: &[Position; AXES]) {
        for (words, point) in self.set_points.iter().zip(set_points) {
            words.set(point.to_bits());
        }
    }
}

impl<'a, const AXES: usize> Display<'a, AXES> {
    pub(super) const fn new(
        words: &'a Words<AXES>,
        clock: &'a Clock,
        pieces: Gauge<'a, Phase, PHASES>,
    ) -> Self {
        Self { words, clock, pieces }
    }

    /// What the last tick did. Repeats itself while a tick comes in between.
    pub fn read(&self) -> Snapshot<AXES> {
        loop {
            let (ended, last, moved) = self.clock.ended();
            let Words { distances: [even, odd], n, block, set_points } = self.words;
            let [even, odd] = [even, odd].map(Long::get);
            let (distance, before) = if last & TICK == 0 { (even, odd) } else { (odd, even) };
            let snapshot = Snapshot {
                ticks: ended / TICK,
                moved,
                set_points: core::array::from_fn(|k| {
                    set_points.get(k).map_or(Position::ZERO, |words| Position::from_bits(words.get()))
                }),
                distance: Distance::from_bits(distance),
                step: Distance::from_bits(distance.wrapping_sub(before)),
                n: n.load(Ordering::Relaxed),
                block: block.load(Ordering::Relaxed),
                queued: self.pieces.len() as u16,
            };
            if self.clock.is_at(ended) {
                return snapshot;
            }
            core::hint::spin_loop();
        }
    }
}
