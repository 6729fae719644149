//! A block of the ring: its limits, its length, the planned speed at its start, and the properties of the
//! transition there.
use super::ease::Ease;
use super::planned::Planned;
use crate::dynamics::{OverrideRange, Passing};
use crate::quantity::Speed;
use crate::slope::kept::{LawKind, Numbers};
use crate::slope::limits::Limits;

/// No speed yet.
pub(super) const UNPLANNED: Speed = Speed::from_bits(-1);

/// A block in the ring of the look-ahead: its limits, and the speeds planned at its start. The curve of the
/// block is in the queue: [`crate::queue::CurveRing`].
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Path length, LSB 2^-44 mm.
    pub(super) length: i64,
    /// Limits without the kind of their slope, which is in [`Kind`].
    pub(super) numbers: Numbers,
    /// Highest speed at which the motion may pass the block's start, mm/tick.
    pub(super) cap: f32,
    /// Highest speed at the block's start for any feed of both blocks, mm/tick. Feeds may rise with the
    /// override.
    pub(super) highest: f32,
    /// Planned speed at the block's start. For the first block, [`super::ring::Ring::start`] holds this
    /// speed.
    pub(super) v_in: Planned,
    /// Speed at the block's start that the motion can reach from the first block of the ring. If the start is
    /// no anchor, other data take this place: see [`Self::ease`].
    pub(super) v_reached: Planned,
    /// The speed of the last complete plan at the block's start. The motion can still keep this speed.
    pub(super) v_old: Planned,
    /// How the block's speed follows the override.
    pub(super) override_range: OverrideRange,
    pub(super) joint: AnchorMarks,
    pub(super) marks: Marks,
    /// See [`Kind`].
    pub(super) kind: Kind,
}

/// Blocks use most of the look-ahead's memory.
const _: () = assert!(size_of::<Block>() == 64);

/// The slope of the limits, and two more bits. First bit (continued): the block and the block before are
/// parts of one curve. Second bit (trades): the limits trade speed for acceleration, so v + a²/2j is at most
/// the speed of the limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kind(u8);

impl Kind {
    const CONTINUED: u8 = 32;
    const TRADES: u8 = 64;

    pub(super) const fn new(law: LawKind, trades: bool) -> Self {
        Self(law.bits() | if trades { Self::TRADES } else { 0 })
    }

    const fn law(self) -> LawKind {
        LawKind::of(self.0)
    }

    const fn has(self, mark: u8) -> bool {
        self.0 & mark != 0
    }
}

const _: () = assert!(LawKind::FREE & (Kind::CONTINUED | Kind::TRADES) == Kind::CONTINUED | Kind::TRADES);

/// Properties of a block's start. *Open*: the planner may still try to remove the anchor there. *Lent*: the
/// block is a piece of a slow block, but belongs to a faster span. The anchor next to a lent block keeps the
/// speed inside the piece's limit ([`super::valley`]). Other bits: the block is rapid motion; the path turns
/// at its start, so that the transition reserves a part of the limits. The last bits hold the part of a
/// deceleration that may pass the start.
#[derive(Clone, Copy, Debug)]
pub(super) struct AnchorMarks(u8);

impl AnchorMarks {
    const OPEN: u8 = 1;
    const LENT: u8 = 2;
    const FLOWS: u8 = 4;
    const RAPID: u8 = 8;
    const KNEE: u8 = 16;
    const BOUGHT: u8 = 32;
    const PASSING: u8 = 64;

    /// Marks of a block that is not lent. `flows`: the block starts between two parts of one curve of many
    /// elements. `bought`: the limits trade speed for acceleration, below the feed.
    pub(super) fn new(open: bool, flows: bool, [rapid, knee, bought]: [bool; 3]) -> Self {
        let [open, flows] = [(open, Self::OPEN), (flows, Self::FLOWS)];
        let marks = [open, flows, (rapid, Self::RAPID), (knee, Self::KNEE), (bought, Self::BOUGHT)];
        Self(marks.into_iter().fold(0, |all, (on, mark)| if on { all | mark } else { all }))
    }

    /// Sets the part of a deceleration that may pass the block's start.
    pub(super) const fn passed(self, passing: Passing) -> Self {
        Self(self.0 | (passing.number() * Self::PASSING))
    }

    /// The part of a deceleration that may pass the block's start, if the path is smooth there.
    pub(super) const fn passing(self) -> Passing {
        Passing::numbered(self.0 / Self::PASSING)
    }

    /// Properties that at least one of both blocks has.
    pub(super) const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Properties that both blocks have.
    pub(super) const fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    pub(super) const fn has_knee(self) -> bool {
        self.0 & Self::KNEE != 0
    }

    pub(super) const fn is_bought(self) -> bool {
        self.0 & Self::BOUGHT != 0
    }

    pub(super) const fn flows(self) -> bool {
        self.0 & Self::FLOWS != 0
    }

    pub(super) const fn is_rapid(self) -> bool {
        self.0 & Self::RAPID != 0
    }

    pub(super) const fn is_open(self) -> bool {
        self.0 & Self::OPEN != 0
    }

    /// Permits the planner to try to remove the anchor.
    pub(super) const fn open(&mut self) {
        self.0 |= Self::OPEN;
    }

    /// Marks the anchor as tried.
    pub(super) const fn close(&mut self) {
        self.0 &= !Self::OPEN;
    }

    pub(super) const fn is_lent(self) -> bool {
        self.0 & Self::LENT != 0
    }

    pub(super) const fn lend(&mut self) {
        self.0 |= Self::LENT;
    }

    pub(super) const fn take_back(&mut self) {
        self.0 &= !Self::LENT;
    }
}

/// Flags of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Marks(u8);

impl Marks {
    /// The speed at the block's start was planned for a lower end speed than the current one, and is kept.
    pub(super) const KEPT: u8 = 1;
    /// Acceleration is zero at the block's start.
    pub(super) const ANCHOR: u8 = 2;
    /// The block's start became an anchor after the last complete plan.
    pub(super) const FRESH: u8 = 4;
    /// The profile of the block's span was planned so that it nowhere rises above the speeds at its ends.
    /// After release, the span may be as fast as all of its blocks permit.
    pub(super) const FLAT: u8 = 8;
    /// The span that begins with this block keeps the limits of all its blocks.
    pub(super) const CHECKED: u8 = 16;
    /// A deceleration may pass the block's start: the path turns little there ([`AnchorMarks::passing`]).
    pub(super) const SMOOTH: u8 = 32;
    /// The block waits for acknowledgements: the motion stops before it.
    pub(super) const GATE: u8 = 64;
    /// The block replaces several blocks, and is twice as long as a stop needs.
    pub(super) const LONG: u8 = 128;

    /// The marks of a new block: anchor, fresh, smooth, gate, long.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn of(on: [bool; 5]) -> Self {
        let marks = [Self::ANCHOR, Self::FRESH, Self::SMOOTH, Self::GATE, Self::LONG].into_iter().zip(on);
        Self(marks.fold(0, |all, (mark, on)| if on { all | mark } else { all }))
    }

    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) const fn has(self, mark: u8) -> bool {
        self.0 & mark != 0
    }

    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn set(&mut self, mark: u8, on: bool) {
        self.0 = if on { self.0 | mark } else { self.0 & !mark };
    }
}

impl Block {
    /// No block; all bits zero.
    pub(super) const BLANK: Self = Self {
        length: 0,
        numbers: Numbers::NOTHING,
        cap: 0.0,
        highest: 0.0,
        v_in: Planned::NONE,
        v_reached: Planned::NONE,
        v_old: Planned::NONE,
        override_range: OverrideRange::BLANK,
        joint: AnchorMarks(0),
        marks: Marks(0),
        kind: Kind(0),
    };

    /// Path length, LSB 2^-44 mm.
    pub fn length(&self) -> i64 {
        self.length
    }

    /// The limits, for passes over all blocks.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn limits(&self) -> Limits {
        self.numbers.limits(self.kind.law())
    }

    /// The limits, for other callers: a function call takes less flash than inlined code.
    #[inline(never)]
    pub(super) fn limits_by_call(&self) -> Limits {
        self.limits()
    }

    /// Restricts `limits` to what this block also permits.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn join_to(&self, limits: &mut Limits) {
        limits.join_kept(&self.numbers, self.kind.law());
    }

    /// Sets lower limits with the same slope.
    pub(super) fn lower(&mut self, limits: &Limits) {
        self.numbers = limits.kept().0;
    }

    /// Speed in the limits, mm/tick.
    pub(super) fn v(&self) -> f32 {
        self.numbers.v
    }

    /// Whether the slope is HSC with NO_OPT=0.
    pub(super) fn may_have_valleys(&self) -> bool {
        self.kind.law().may_have_valleys()
    }

    /// Whether the limits of the block trade speed for acceleration.
    pub(super) fn trades(&self) -> bool {
        self.kind.has(Kind::TRADES)
    }

    /// Whether the block and the block before are parts of one curve.
    pub fn is_continued(&self) -> bool {
        self.kind.has(Kind::CONTINUED)
    }

    /// Marks that the block and the block before are parts of one curve.
    pub(super) fn go_on(&mut self) {
        self.kind.0 |= Kind::CONTINUED;
    }

    pub(super) fn is(&self, mark: u8) -> bool {
        self.marks.has(mark)
    }

    /// Whether blocks with other speeds may share a span with this block: `Joins::Any`.
    pub fn varies(&self) -> bool {
        self.kind.law().varies()
    }

    /// Whether the motion waits for acknowledgements at the start of the block.
    pub fn is_gate(&self) -> bool {
        self.is(Marks::GATE)
    }

    /// The speed that a profile must not exceed in the block.
    pub(super) fn speed(&self) -> f32 {
        if self.joint.is_lent() { f32::MAX } else { self.v() }
    }

    /// Speed at 100 % override, or at the planned override `level` if that is higher.
    pub(super) fn full(&self, level: f32) -> f32 {
        if level < 1.0 { self.v() / self.override_range.raised(level) } else { self.v() }
    }

    /// Current highest speed at the block's start.
    pub(super) fn cap(&self) -> f32 {
        if self.is(Marks::GATE) { 0.0 } else { self.cap }
    }
}

impl Block {
    /// The ease of the block's span, if the block is the second one of the span. The ease lies in the memory
    /// that an anchor uses for its speeds. Do not call this function for an anchor.
    pub(super) fn ease(&self) -> Ease {
        if self.has_ease() { Ease::of([self.v_reached.bits(), self.v_old.bits()]) } else { Ease::NONE }
    }

    /// Whether the block's span has an ease. Do not call this function for an anchor.
    pub(super) fn has_ease(&self) -> bool {
        self.v_old.is_some()
    }

    /// Stores the ease of the block's span. Do not call this function for an anchor.
    pub(super) fn keep_ease(&mut self, ease: Ease) {
        let [v, less] = if ease == Ease::NONE { [0; 2] } else { ease.kept() };
        (self.v_reached, self.v_old) = (Planned::of_bits(v), Planned::of_bits(less));
    }

    /// Removes the anchor at the block's start.
    pub(super) fn give_way(&mut self) {
        self.marks.set(Marks::ANCHOR | Marks::FRESH, false);
        self.forget();
    }

    /// Drops the speed at the block's start, and the ease.
    pub(super) fn forget(&mut self) {
        (self.v_reached, self.v_old) = (Planned::NONE, Planned::NONE);
    }

    /// Sets the start speed to `v_in`, or to the planned one if that is lower.
    #[inline(never)]
    pub(super) fn start_at(&mut self, v_in: Speed) {
        self.v_in = Planned::below(v_in);
        if self.v_in.speed() == v_in {
            self.start_as_planned();
        } else {
            self.marks.set(Marks::CHECKED, false);
        }
    }

    /// Sets the start speed to the planned one.
    pub(super) fn start_as_planned(&mut self) {
        if self.v_in != self.v_reached {
            self.marks.set(Marks::CHECKED, false);
        }
    }
}
