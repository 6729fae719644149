//! The status of every tick: position, block and path distance. Any task, interrupt or core reads a snapshot
//! of one tick, without a lock.
//!
//! The interrupt writes whole words, so no word is ever half written. All words of a snapshot belong to the
//! same tick if no tick has begun during the read. The clock tells whether a tick has begun
//! ([`Clock::ended`], [`Clock::is_at`]). If so, the reader reads again. A reader never delays the interrupt.
//!
//! The interrupt writes only values that it has in any case, and the reader derives the others. The speed,
//! for example, is the difference of the set points of two ticks. For this, even and odd ticks write their
//! set points to different words.
use super::cells::whole;
use super::clock::TICK;
use super::word::{Memory, Ram, Word};
use super::{Clock, Gauge, PHASES, Phase};
use crate::quantity::{Distance, Position};
use core::sync::atomic::Ordering;

/// What the interrupt did in its last tick: all values belong to the same tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Snapshot<const AXES: usize> {
    /// Number of ticks that have ended since `Rings::split`, modulo 2^31.
    pub ticks: u32,
    /// Whether the last tick used a piece: motion along the path, or dwell.
    pub moved: bool,
    /// Whether set points moved in the last tick although the path stood still: filters settle, or single
    /// axes move.
    pub settles: bool,
    /// Set points after the last tick, mm or degrees.
    pub set_points: [Position; AXES],
    /// Set points one tick earlier, mm or degrees. The difference to `set_points` is the travel in the last
    /// tick, and so the speed per tick.
    pub before: [Position; AXES],
    /// Path distance of the last tick that used a piece.
    pub distance: Distance,
    /// N number of the programmed block on which the axes are.
    pub n: u32,
    /// Number of the motion block on which the axes are, counted from 0 since `Rings::split`.
    pub block: u32,
    /// Number of pieces of the speed profile in the queue.
    pub queued: u16,
}

impl<const AXES: usize> Snapshot<AXES> {
    const BLANK: Self = Self {
        ticks: 0,
        moved: false,
        settles: false,
        set_points: [Position::ZERO; AXES],
        before: [Position::ZERO; AXES],
        distance: Distance::ZERO,
        n: 0,
        block: 0,
        queued: 0,
    };
}

/// A number of 64 bits in two words.
struct Long<W>([W; 2]);

impl<W: Word> Long<W> {
    const fn zero() -> Self {
        Self([const { W::ZERO }; 2])
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

/// The memory of the status. The interrupt writes it; a [`Display`] reads it.
pub struct Words<const AXES: usize, M: Memory = Ram> {
    distance: Long<M::Word>,
    n: M::Word,
    /// The lower half of the block's number.
    block: M::Word,
    /// Set points of the last two ticks: even ticks write the first place, odd ticks the second.
    set_points: [[Long<M::Word>; AXES]; 2],
}

/// The reader's handle of the status. Any task, interrupt or core may use this handle.
pub struct Display<'a, const AXES: usize, M: Memory = Ram> {
    words: &'a Words<AXES, M>,
    clock: &'a Clock<M>,
    pieces: Gauge<'a, Phase, PHASES, M>,
    /// The latest motion block in the ring of curves.
    latest: &'a M::Word,
}

impl<const AXES: usize, M: Memory> Words<AXES, M> {
    /// Memory of a status; all bits are zero.
    pub const fn blank() -> Self {
        Self {
            distance: Long::zero(),
            n: M::Word::ZERO,
            block: M::Word::ZERO,
            set_points: [const { [const { Long::zero() }; AXES] }; 2],
        }
    }

    /// Writes the path distance of a tick that uses a piece. Only the interrupt calls this function.
    #[inline(always)]
    pub fn show_distance(&self, distance: i64) {
        self.distance.set(distance);
    }

    /// The path distance that was written last, LSB 2^-44 mm. Only the interrupt calls this function.
    #[inline(always)]
    pub fn distance(&self) -> i64 {
        self.distance.get()
    }

    /// Writes the N number and the lower half of the motion block's number of the current curve. Only the
    /// interrupt calls this function.
    #[inline(always)]
    pub fn show_curve(&self, n: u32, block: u16) {
        self.n.store(n, Ordering::Relaxed);
        self.block.store(block.into(), Ordering::Relaxed);
    }

    /// Writes the set points of a tick. Only the interrupt calls this function, in every tick, also at
    /// standstill.
    #[inline(always)]
    pub fn show_points(&self, tick: u32, set_points: &[Position; AXES]) {
        // One bit selects one of two places, so the optimiser removes the bounds check.
        for (words, point) in self.set_points[(tick & 1) as usize].iter().zip(set_points) {
            words.set(point.to_bits());
        }
    }
}

impl<'a, const AXES: usize, M: Memory> Display<'a, AXES, M> {
    /// A handle that reads the status from these words.
    pub const fn new(
        words: &'a Words<AXES, M>,
        clock: &'a Clock<M>,
        pieces: Gauge<'a, Phase, PHASES, M>,
        latest: &'a M::Word,
    ) -> Self {
        Self { words, clock, pieces, latest }
    }

    /// The result of the last tick. If a tick begins during the read, the call reads again.
    pub fn read(&self) -> Snapshot<AXES> {
        let mut snapshot = Snapshot::BLANK;
        M::wait(|| {
            let ended = self.look(&mut snapshot);
            self.clock.is_at(ended)
        });
        snapshot
    }

    /// As [`Self::read`], and lets `beside` read other values of the same tick. `beside` gets the path
    /// distance, and may be called several times.
    #[cfg(feature = "driven")]
    pub fn read_with(&self, mut beside: impl FnMut(Distance)) -> Snapshot<AXES> {
        let mut snapshot = Snapshot::BLANK;
        M::wait(|| {
            let ended = self.look(&mut snapshot);
            beside(snapshot.distance);
            self.clock.is_at(ended)
        });
        snapshot
    }

    /// Reads all words once. Returns the number of ticks that had ended before.
    fn look(&self, snapshot: &mut Snapshot<AXES>) -> u32 {
        let (ended, moved) = self.clock.ended();
        let Words { distance, n, block, set_points } = self.words;
        snapshot.ticks = ended / TICK;
        [snapshot.moved, snapshot.settles] = moved;
        // The number of the last tick is one below the number of ticks ended.
        let [even_points, odd_points] = set_points;
        let is_odd = snapshot.ticks & 1 == 0;
        let (points, points_before) =
            if is_odd { (odd_points, even_points) } else { (even_points, odd_points) };
        for (point, words) in snapshot.set_points.iter_mut().zip(points) {
            *point = Position::from_bits(words.get());
        }
        for (point, words) in snapshot.before.iter_mut().zip(points_before) {
            *point = Position::from_bits(words.get());
        }
        snapshot.distance = Distance::from_bits(distance.get());
        let lower = block.load(Ordering::Relaxed) as u16;
        let latest = self.latest.load(Ordering::Relaxed);
        (snapshot.n, snapshot.block) = (n.load(Ordering::Relaxed), whole(latest, lower));
        snapshot.queued = self.pieces.len() as u16;
        ended
    }
}
