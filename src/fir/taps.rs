//! The output of a filter with symmetric taps, computed from second differences.
//!
//! A filtered set point is Σ h·x, with the taps h and the set points x of the path. So the second difference
//! of the filtered set point is the same sum over the second differences of the path. Those fit into a word
//! ([`REACH`]). Two samples with the same tap are added and then multiplied once. Two running sums turn the
//! second difference into the set point. All values are integers, so nothing is lost and nothing drifts.
use super::{Layout, ONE};
use core::sync::atomic::{Ordering, compiler_fence};

/// Bits of a second difference, including its sign. The sum of two of them fits into 32 bits.
const BITS: u32 = 31;

/// Largest second difference of an axis with taps, mm or degrees per cycle².
pub(crate) const REACH: f32 = 0.25;

/// Pairs per block while enough pairs are left; then the block sizes for the rest, each used at most once.
const BLOCK: usize = 16;
const SMALL_BLOCK: usize = 8;

/// State of the taps of one axis. All bits are zero for an axis that stands still at 0.
pub(super) struct Taps {
    /// Position and change of position of the path in the last tick.
    x: i64,
    dx: i64,
    /// Σ h·x′: the change of the set point times [`ONE`], without rounding remainders.
    moved: i64,
    /// Rounding remainders of the last set point and of the one before.
    rest: [i32; 2],
    /// As `x` and `dx`, half a window ago. Valid only if it is requested in every tick.
    late: [i64; 2],
    /// Whether a second difference did not fit into its word.
    pub is_passed: bool,
}

impl Taps {
    /// An axis that stands at 0.
    pub const ZERO: Self = Self { x: 0, dx: 0, moved: 0, rest: [0; 2], late: [0; 2], is_passed: false };

    /// An axis that stands at `x`.
    pub const fn at(x: i64) -> Self {
        Self { x, late: [x, 0], ..Self::ZERO }
    }

    /// Returns the second difference of the path, whose set point is now `x`.
    #[inline(always)]
    pub fn take(&mut self, x: i64) -> i32 {
        let dx = x.wrapping_sub(self.x);
        let second = dx.wrapping_sub(self.dx);
        (self.x, self.dx) = (x, dx);
        if second.wrapping_add(1 << (BITS - 1)) as u64 >> BITS != 0 {
            return self.pass(second);
        }
        second as i32
    }

    /// Passes a second difference that does not fit around the filter at once. So the axis always ends where
    /// the path ends.
    #[cold]
    #[inline(never)]
    const fn pass(&mut self, second: i64) -> i32 {
        self.moved = self.moved.wrapping_add(second.wrapping_mul(ONE as i64));
        self.is_passed = true;
        0
    }

    /// The input of [`Self::give`] before Σ h·x″ is added.
    #[inline(always)]
    pub const fn moved(&self) -> i64 {
        self.moved
    }

    /// The change of the set point.
    ///
    /// ONE·y + r = Σ h·x + r′, with the remainders r of this set point and r′ of the last one. So ONE·Δy = Σ
    /// h·x′ + 2r′ − r″ − r.
    #[inline(always)]
    pub fn give(&mut self, moved: i64) -> i64 {
        self.moved = moved;
        let [last, before] = self.rest;
        let whole = moved.wrapping_add(i64::from(2 * last - before));
        self.rest = [whole as i32 & (ONE - 1), last];
        whole >> ONE.trailing_zeros()
    }

    /// Positions of the path in the delayed tick and in the tick before, from the second difference in the
    /// delayed tick.
    pub fn late(&mut self, second: i32) -> [i64; 2] {
        let [before, dx] = self.late;
        let dx = dx.wrapping_add(second.into());
        let now = before.wrapping_add(dx);
        self.late = [now, dx];
        [now, before]
    }
}

/// The window of an axis in its sample memory, as places relative to the newest sample.
#[derive(Clone, Copy)]
pub(super) struct Window {
    /// Place of the oldest sample, and the place after the newest sample of the window.
    oldest: usize,
    behind: usize,
    /// Number of taps on one side. With an odd number of samples, the centre sample is a pair with itself.
    pairs: usize,
}

impl Window {
    /// An empty layout.
    pub const ZERO: Self = Self { oldest: 0, behind: 0, pairs: 0 };

    /// The layout in a memory that holds `TAPS` samples twice.
    pub fn of<const TAPS: usize>(layout: &Layout) -> Self {
        let (behind, length) = ((TAPS + 1).wrapping_sub(layout.newest as usize), layout.length as usize);
        Self { oldest: behind.wrapping_sub(length), behind, pairs: length.div_ceil(2) }
    }

    /// Returns `sum` + Σ h·x″. The newest sample is at `at`, and again in the other half of the memory. The
    /// loop runs from the outside to the centre.
    #[inline(always)]
    pub fn weigh(&self, samples: &[i32], taps: &[u8], at: usize, mut sum: i64) -> i64 {
        let mut left = self.pairs;
        let [mut oldest, mut behind] = [self.oldest, self.behind].map(|place| at.wrapping_add(place));
        for taps in taps.as_chunks::<2>().0.as_chunks::<BLOCK>().0 {
            if left < BLOCK {
                break;
            }
            sum = weigh_block(samples, taps, [oldest, behind], sum);
            left -= BLOCK;
            (oldest, behind) = (oldest.wrapping_add(BLOCK), behind.wrapping_sub(BLOCK));
        }
        if left == 0 { sum } else { self.weigh_rest(samples, taps, [at, left], sum) }
    }

    /// Adds the last `left` pairs, fewer than a block.
    #[cold]
    #[inline(never)]
    fn weigh_rest(&self, samples: &[i32], taps: &[u8], [at, left]: [usize; 2], mut sum: i64) -> i64 {
        let done = self.pairs.wrapping_sub(left);
        let mut taps = taps.as_chunks::<2>().0.get(done..self.pairs).unwrap_or(&[]);
        let mut oldest = at.wrapping_add(self.oldest).wrapping_add(done);
        let mut behind = at.wrapping_add(self.behind).wrapping_sub(done);
        if let Some((block, ones)) = taps.split_first_chunk::<SMALL_BLOCK>() {
            sum = weigh_block(samples, block, [oldest, behind], sum);
            (oldest, behind) = (oldest.wrapping_add(SMALL_BLOCK), behind.wrapping_sub(SMALL_BLOCK));
            taps = ones;
        }
        let (Some(older), Some(newer)) = (samples.get(oldest..), samples.get(..behind)) else { return sum };
        let pairs = older.iter().zip(newer.iter().rev()).zip(taps);
        pairs.fold(sum, |sum, ((older, newer), tap)| weigh_pair(sum, [*older, *newer], *tap))
    }
}

/// Adds a block of pairs. The oldest sample is at the first place, and the newest one is just before the
/// second place.
#[inline(always)]
fn weigh_block<const N: usize>(
    samples: &[i32],
    taps: &[[u8; 2]; N],
    [oldest, behind]: [usize; 2],
    mut sum: i64,
) -> i64 {
    let older = samples.get(oldest..).and_then(<[i32]>::first_chunk::<N>);
    let newer = samples.get(..behind).and_then(<[i32]>::last_chunk::<N>);
    let (Some(older), Some(newer)) = (older, newer) else { return sum };
    for ((older, newer), tap) in older.iter().zip(newer.iter().rev()).zip(taps) {
        sum = weigh_pair(sum, [*older, *newer], *tap);
    }
    sum
}

#[inline(always)]
fn weigh_pair(sum: i64, [older, newer]: [i32; 2], tap: [u8; 2]) -> i64 {
    let both = older.wrapping_add(newer);
    let sum = sum.wrapping_add(i64::from(both) * i64::from(i16::from_ne_bytes(tap)));
    // Without this fence the compiler loads all samples of a block first, and runs out of registers.
    compiler_fence(Ordering::SeqCst);
    sum
}
