//! Symmetric taps: what the filter makes of a motion, from second differences.
//!
//! A set point is Σ h·x. So is its second difference that of the second differences of the path, which fit a
//! word ([`REACH`]): a pair of samples is added, and multiplied once. Two running sums make the set point of
//! it. All of them are integers: nothing is lost, and nothing drifts.
use super::{Layout, ONE};
use core::sync::atomic::{Ordering, compiler_fence};

/// Bits of a second difference, with its sign: the sum of two fits 32.
const BITS: u32 = 31;

/// Largest second difference of an axis with taps, mm or degrees per cycle².
pub(crate) const REACH: f32 = 0.25;

/// Pairs at a time.
const BLOCK: usize = 8;

/// What the taps of one axis remember. All bits zero at rest at 0.
pub(super) struct Taps {
    /// The path of the last tick: where it was, and how much it had moved.
    x: i64,
    dx: i64,
    /// How much the set point moved.
    dy: i64,
    /// What the remainders r of the set points before add to the next three: to the next one
    /// 3r′ − 3r″ + r‴.
    rest: [i32; 3],
    /// The same as x and dx, half a window ago. Only where that is asked for in every tick.
    late: [i64; 2],
    /// A second difference did not fit.
    pub is_passed: bool,
}

impl Taps {
    /// At rest at 0.
    pub const ZERO: Self = Self { x: 0, dx: 0, dy: 0, rest: [0; 3], late: [0; 2], is_passed: false };

    /// At rest at `x`.
    pub const fn at(x: i64) -> Self {
        Self { x, late: [x, 0], ..Self::ZERO }
    }

    /// Second difference of the path, whose set point is `x` now.
    ///
    /// One that does not fit goes past the filter at once: the axis ends where the path ends, whatever comes.
    #[inline(always)]
    pub fn take(&mut self, x: i64) -> i32 {
        let dx = x.wrapping_sub(self.x);
        let second = dx.wrapping_sub(self.dx);
        (self.x, self.dx) = (x, dx);
        if second.wrapping_add(1 << (BITS - 1)) as u64 >> BITS == 0 {
            return second as i32;
        }
        self.dy = self.dy.wrapping_add(second);
        self.is_passed = true;
        0
    }

    /// What the remainders so far add to the next sum.
    #[inline(always)]
    pub fn carried(&self) -> i64 {
        self.rest[0].into()
    }

    /// How much the set point moves, from Σ h·x″ and what is carried.
    ///
    /// ONE·y + r = Σ h·x + r′, with the remainders r of this set point and r′ of the last one; this is the
    /// second difference of that.
    #[inline(always)]
    pub fn give(&mut self, sum: i64) -> i64 {
        let [_, next, last] = self.rest;
        let rest = sum as i32 & (ONE - 1);
        self.rest = [next + 3 * rest, last - 3 * rest, rest];
        self.dy = self.dy.wrapping_add(sum >> ONE.trailing_zeros());
        self.dy
    }

    /// Where the path was, from its second difference then; and a tick before.
    pub fn late(&mut self, second: i32) -> [i64; 2] {
        let [before, dx] = self.late;
        let dx = dx.wrapping_add(second.into());
        let now = before.wrapping_add(dx);
        self.late = [now, dx];
        [now, before]
    }
}

/// The window of an axis in the memory of its samples, as places behind that of the newest one.
///
/// Pairs go from the outside in: whole blocks first. With an odd number of samples the one in the centre is a
/// pair with itself.
#[derive(Clone, Copy)]
pub(super) struct Window {
    /// Where the oldest sample is, and the one behind the newest of the window.
    oldest: usize,
    behind: usize,
    /// Blocks, and pairs that are left.
    blocks: usize,
    left: usize,
}

impl Window {
    /// Of no axis.
    pub const ZERO: Self = Self { oldest: 0, behind: 0, blocks: 0, left: 0 };

    /// In a memory that holds `TAPS` samples twice.
    pub fn of<const TAPS: usize>(layout: &Layout) -> Self {
        let (behind, length) = ((TAPS + 1).wrapping_sub(layout.newest as usize), layout.length as usize);
        let pairs = length.div_ceil(2);
        let (blocks, left) = (pairs / BLOCK, pairs % BLOCK);
        Self { oldest: behind.wrapping_sub(length), behind, blocks, left }
    }

    /// `sum` + Σ h·x″. The newest sample is at `at`, and once more in the other half of the memory.
    #[inline(always)]
    pub fn weigh(&self, samples: &[i32], taps: &[u8], at: usize, mut sum: i64) -> i64 {
        let blocks = self.blocks;
        let older = samples.get(at.wrapping_add(self.oldest)..).map(<[i32]>::as_chunks::<BLOCK>);
        let newer = samples.get(..at.wrapping_add(self.behind)).map(<[i32]>::as_rchunks::<BLOCK>);
        let Some((older, _)) = older else { return 0 };
        let Some(older) = older.get(..blocks) else { return 0 };
        let Some((_, newer)) = newer else { return 0 };
        let Some(newer) = newer.get(newer.len().wrapping_sub(blocks)..) else { return 0 };
        let Some(taps_of_blocks) = taps.as_chunks::<2>().0.as_chunks::<BLOCK>().0.get(..blocks) else {
            return 0;
        };
        for ((older, newer), taps) in older.iter().zip(newer.iter().rev()).zip(taps_of_blocks) {
            for (k, tap) in taps.iter().enumerate() {
                if let (Some(older), Some(newer)) = (older.get(k), newer.get(BLOCK - 1 - k)) {
                    sum = pair(sum, [*older, *newer], *tap);
                }
            }
        }
        if self.left == 0 { sum } else { self.weigh_left(samples, taps, at, sum) }
    }

    /// The same of the pairs that are no block.
    #[inline(never)]
    fn weigh_left(&self, samples: &[i32], taps: &[u8], at: usize, sum: i64) -> i64 {
        let done = self.blocks * BLOCK;
        let first = at.wrapping_add(self.oldest).wrapping_add(done);
        let last = at.wrapping_add(self.behind).wrapping_sub(done);
        let part = |from: usize| samples.get(from..).and_then(|samples| samples.get(..self.left));
        let taps = taps.as_chunks::<2>().0.get(done..).and_then(|taps| taps.get(..self.left));
        let (Some(older), Some(newer), Some(taps)) = (part(first), part(last.wrapping_sub(self.left)), taps)
        else {
            return 0;
        };
        let pairs = older.iter().zip(newer.iter().rev()).zip(taps);
        pairs.fold(sum, |sum, ((older, newer), tap)| pair(sum, [*older, *newer], *tap))
    }
}

#[inline(always)]
fn pair(sum: i64, [older, newer]: [i32; 2], tap: [u8; 2]) -> i64 {
    let both = older.wrapping_add(newer);
    let sum = sum.wrapping_add(i64::from(both) * i64::from(i16::from_ne_bytes(tap)));
    // Without it the compiler loads all samples of a block first, and has no registers for them.
    compiler_fence(Ordering::SeqCst);
    sum
}
