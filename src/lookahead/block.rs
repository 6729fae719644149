//! A block in the ring: its limits, the speeds planned where it begins, and what that transition is.
use super::ease::Ease;
use super::planned::Planned;
use crate::dynamics::{OverrideRange, Passing};
use crate::quantity::Speed;
use crate::slope::kept::{LawKind, Numbers};
use crate::slope::limits::Limits;

/// No speed yet.
pub(super) const UNPLANNED: Speed = Speed::from_bits(-1);

/// A block in the ring. Its curve is in the queue: [`crate::queue::CurveRing`].
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Path length, LSB 2^-44 mm.
    pub(super) length: i64,
    /// Its limits but for the kind of their law, see [`Kind`].
    pub(super) numbers: Numbers,
    /// Speed at which its start may be passed at most, mm/tick.
    pub(super) cap: f32,
    /// Speed at its start, at most, whatever the speeds of both blocks there: their feeds may rise with the
    /// override. mm/tick.
    pub(super) highest: f32,
    /// Planned speed at its start. Of the first block [`super::ring::Ring::start`] counts.
    pub(super) v_in: Planned,
    /// Speed at its start as far as it can be reached from the first block. Not of an anchor: see
    /// [`Self::ease`].
    pub(super) v_reached: Planned,
    /// The speed that the last complete plan had there: it stays possible.
    pub(super) v_old: Planned,
    /// How its speed follows the override.
    pub(super) override_range: OverrideRange,
    pub(super) joint: AnchorMarks,
    pub(super) marks: Marks,
    /// See there.
    pub(super) kind: Kind,
}

/// Most memory of the look-ahead is blocks.
const _: () = assert!(size_of::<Block>() == 64);

/// The law of its limits, and in the other bits whether it was cut off from the block before, so that their curve
/// is one, and whether acceleration inside it is bought with speed: v + a²/2j is at most the speed of its limits.
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

/// Whether it may be tried to do without an anchor at the start of a block, and whether the block is *lent*:
/// it is the piece of a slow block in a faster span, where the speed at the anchor beside it keeps its limit
/// ([`super::valley`]). Beside that, whether the block is rapid motion, and whether the path turns at its start,
/// so that a transition has its part of the limits there, and the part of a deceleration that passes its start.
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

    /// Not lent. `flows`: it is between two parts of one curve of many elements.
    /// `bought`: acceleration inside it is bought with speed, below that of its feed.
    pub(super) fn new(open: bool, flows: bool, [rapid, knee, bought]: [bool; 3]) -> Self {
        let [open, flows] = [(open, Self::OPEN), (flows, Self::FLOWS)];
        let marks = [open, flows, (rapid, Self::RAPID), (knee, Self::KNEE), (bought, Self::BOUGHT)];
        Self(marks.into_iter().fold(0, |all, (on, mark)| if on { all | mark } else { all }))
    }

    /// That part of a deceleration passes its start.
    pub(super) const fn passed(self, passing: Passing) -> Self {
        Self(self.0 | (passing.number() * Self::PASSING))
    }

    /// The part of a deceleration that passes its start, where it is smooth.
    pub(super) const fn passing(self) -> Passing {
        Passing::numbered(self.0 / Self::PASSING)
    }

    /// What is so of this or the other one.
    pub(super) const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// What is so of both.
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

    /// The anchor may be tried.
    pub(super) const fn open(&mut self) {
        self.0 |= Self::OPEN;
    }

    /// The anchor was tried.
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
    /// Its span is planned not to rise above the speeds at its ends. Released it may be as fast as all of its blocks.
    pub(super) const FLAT: u8 = 8;
    /// The span that begins with it keeps the limits of all its blocks.
    pub(super) const CHECKED: u8 = 16;
    /// A deceleration may pass its start: the path turns little there ([`AnchorMarks::passing`]).
    pub(super) const SMOOTH: u8 = 32;
    /// It waits for acknowledgements: the motion stands still before it.
    pub(super) const GATE: u8 = 64;
    /// It stands for several blocks, and is twice as long as the way to a standstill.
    pub(super) const LONG: u8 = 128;

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
    /// None; all bits zero.
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

    /// Its limits: where a pass asks each block.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn limits(&self) -> Limits {
        self.numbers.limits(self.kind.law())
    }

    /// The same elsewhere: a call, which takes less room in flash.
    #[inline(never)]
    pub(super) fn limits_by_call(&self) -> Limits {
        self.limits()
    }

    /// What it permits is joined with these limits.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn join_to(&self, limits: &mut Limits) {
        limits.join_kept(&self.numbers, self.kind.law());
    }

    /// It gets limits of the same law.
    pub(super) fn lower(&mut self, limits: &Limits) {
        self.numbers = limits.kept().0;
    }

    /// Its speed.
    pub(super) fn v(&self) -> f32 {
        self.numbers.v
    }

    /// NO_OPT=0.
    pub(super) fn may_have_valleys(&self) -> bool {
        self.kind.law().may_have_valleys()
    }

    /// Whether acceleration inside it is bought with speed.
    pub(super) fn trades(&self) -> bool {
        self.kind.has(Kind::TRADES)
    }

    /// Whether the curve of the block before goes on.
    pub fn is_continued(&self) -> bool {
        self.kind.has(Kind::CONTINUED)
    }

    /// The curve of the block before goes on.
    pub(super) fn go_on(&mut self) {
        self.kind.0 |= Kind::CONTINUED;
    }

    pub(super) fn is(&self, mark: u8) -> bool {
        self.marks.has(mark)
    }

    /// Whether blocks with other speeds may be in one span with it: `Joins::Any`.
    pub fn varies(&self) -> bool {
        self.kind.law().varies()
    }

    /// Whether the motion waits for acknowledgements at the end of the block.
    pub fn is_gate(&self) -> bool {
        self.is(Marks::GATE)
    }

    /// The speed that a law has to keep in it.
    pub(super) fn speed(&self) -> f32 {
        if self.joint.is_lent() { f32::MAX } else { self.v() }
    }

    /// Its speed at 100 %, or at the level if that is higher.
    pub(super) fn full(&self, level: f32) -> f32 {
        if level < 1.0 { self.v() / self.override_range.raised(level) } else { self.v() }
    }

    /// Speed at which its start may be passed now.
    pub(super) fn cap(&self) -> f32 {
        if self.is(Marks::GATE) { 0.0 } else { self.cap }
    }
}

impl Block {
    /// What its span leaves unused, if it is the second one in it: kept where an anchor has its speeds. Not of an
    /// anchor.
    pub(super) fn ease(&self) -> Ease {
        if self.has_ease() { Ease::of([self.v_reached.bits(), self.v_old.bits()]) } else { Ease::NONE }
    }

    /// Whether its span leaves anything unused. Not of an anchor.
    pub(super) fn has_ease(&self) -> bool {
        self.v_old.is_some()
    }

    /// Its span leaves that unused. Not of an anchor.
    pub(super) fn keep_ease(&mut self, ease: Ease) {
        let [v, less] = if ease == Ease::NONE { [0; 2] } else { ease.kept() };
        (self.v_reached, self.v_old) = (Planned::of_bits(v), Planned::of_bits(less));
    }

    /// It is no anchor any more.
    pub(super) fn give_way(&mut self) {
        self.marks.set(Marks::ANCHOR | Marks::FRESH, false);
        self.forget();
    }

    /// No speed is known there, and nothing is left unused.
    pub(super) fn forget(&mut self) {
        (self.v_reached, self.v_old) = (Planned::NONE, Planned::NONE);
    }

    /// It begins at the speed `v_in`, lower than planned or as planned.
    #[inline(never)]
    pub(super) fn start_at(&mut self, v_in: Speed) {
        self.v_in = Planned::below(v_in);
        if self.v_in.speed() == v_in {
            self.start_as_planned();
        } else {
            self.marks.set(Marks::CHECKED, false);
        }
    }

    /// It begins at the planned speed.
    pub(super) fn start_as_planned(&mut self) {
        if self.v_in != self.v_reached {
            self.marks.set(Marks::CHECKED, false);
        }
    }
}
