//! A block in the ring: its limits, the speeds planned where it begins, and what that transition is.
use super::ease::Ease;
use super::limits::Limits;
use super::pace::Headroom;
use crate::quantity::Speed;

/// A speed that was lowered by this stays below its limit, whatever rounding.
pub(super) const ROUNDED: f32 = 1.0 - 1.0 / 4_194_304.0;

/// No speed yet.
pub(super) const UNPLANNED: Speed = Speed::from_bits(-1);

/// A block in the ring. Its curve is in the queue: [`crate::queue::Course`].
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Path length, LSB 2^-44 mm.
    pub(super) length: i64,
    /// Its limits.
    pub(super) limits: Limits,
    /// Speed at which its start may be passed at most, mm/tick.
    pub(super) cap: f32,
    /// Planned speed at its start.
    pub(super) v_in: Speed,
    /// Speed at its start as far as it can be reached from the first block. Not of an anchor: [`Ease`], if any.
    pub(super) v_reached: Speed,
    /// The speed that the last complete plan had there: it stays possible.
    pub(super) v_old: Speed,
    /// How its speed follows the override.
    pub(super) headroom: Headroom,
    pub(super) joint: Joint,
    pub(super) marks: Marks,
    /// It was cut off from the block before: their curve is one.
    pub(super) continued: bool,
    /// Acceleration inside it is bought with speed: v + a²/2j is at most the speed of its limits.
    pub(super) trades: bool,
}

/// What else is said of the transition at the start of a block: in the upper bit, whether it may be tried to do without an
/// anchor there; below, how far it lets [`Block::cap`] rise beyond once: LSB 2^-7.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint(u8);

impl Joint {
    const ONE: f32 = 128.0;
    const OPEN: u8 = 128;

    /// `rises`: 1…2.
    pub(super) fn new(rises: f32, open: bool) -> Self {
        let rises = ((rises - 1.0) * Self::ONE) as u32;
        Self(rises.min(Self::OPEN as u32 - 1) as u8 | if open { Self::OPEN } else { 0 })
    }

    pub(super) fn rises(self) -> f32 {
        1.0 + f32::from(self.0 & (Self::OPEN - 1)) * (1.0 / Self::ONE)
    }

    pub(super) const fn is_open(self) -> bool {
        self.0 & Self::OPEN != 0
    }

    /// The anchor was tried.
    pub(super) const fn close(&mut self) {
        self.0 &= Self::OPEN - 1;
    }
}

/// What is said of a block with yes or no.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Marks(u8);

impl Marks {
    /// The speed at its start was planned for a lower end speed than the one that is planned now.
    pub(super) const KEPT: u8 = 1;
    /// Acceleration is zero at its start.
    pub(super) const ANCHOR: u8 = 2;
    /// It became an anchor after the last complete plan.
    pub(super) const FRESH: u8 = 4;
    /// Its span does not rise above the speeds at its ends.
    pub(super) const FLAT: u8 = 8;
    /// The span that begins with it keeps the limits of all its blocks.
    pub(super) const CHECKED: u8 = 16;
    /// A deceleration of any size the limits permit may pass its start: the path turns little there.
    pub(super) const SMOOTH: u8 = 32;
    /// It waits for acknowledgements: the motion stands still before it.
    pub(super) const GATE: u8 = 64;
    /// It stands for several blocks, and is twice as long as the way to a standstill.
    pub(super) const LONG: u8 = 128;

    #[inline(always)]
    pub(super) const fn has(self, mark: u8) -> bool {
        self.0 & mark != 0
    }

    #[inline(always)]
    pub(super) fn set(&mut self, mark: u8, on: bool) {
        self.0 = if on { self.0 | mark } else { self.0 & !mark };
    }
}

impl Block {
    /// Path length, LSB 2^-44 mm.
    pub fn length(&self) -> i64 {
        self.length
    }

    /// Whether the curve of the block before goes on.
    pub fn is_continued(&self) -> bool {
        self.continued
    }

    pub(super) fn is(&self, mark: u8) -> bool {
        self.marks.has(mark)
    }

    /// Whether it waits for acknowledgements.
    pub fn is_gate(&self) -> bool {
        self.is(Marks::GATE)
    }

    /// Speed at which its start may be passed now.
    pub(super) fn cap(&self) -> f32 {
        if self.is(Marks::GATE) { 0.0 } else { self.cap }
    }
}

impl Block {
    /// What its span leaves unused, if it is the second one in it.
    pub(super) fn ease(&self) -> Ease {
        if self.v_reached > UNPLANNED { Ease::of(self.v_reached) } else { Ease::NONE }
    }

    /// It is no anchor any more.
    pub(super) fn give_way(&mut self) {
        self.marks.set(Marks::ANCHOR | Marks::FRESH, false);
        (self.v_reached, self.v_old) = (UNPLANNED, UNPLANNED);
    }

    /// It begins at the speed `v_in`, lower than planned or as planned.
    pub(super) fn start_at(&mut self, v_in: Speed) {
        self.v_in = v_in;
        if v_in != self.v_reached {
            self.marks.set(Marks::CHECKED, false);
        }
    }
}
