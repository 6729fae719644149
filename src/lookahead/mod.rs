//! Limits over distance: a ring of blocks and, for each transition, the speed at which it may be taken.
//!
//! Two rules fix the speeds. Backward, from a standstill at the end of the ring: a block may be entered at the speed
//! from which its end speed can be reached within its length. Forward, when a block is handed on: its end speed is at
//! most what its start speed can grow to. Both use the slope with zero acceleration at the ends of the block. The
//! plan therefore always stops inside the ring. A higher end speed may lower what the first rule allows at the start;
//! then the speed planned before stays, and the end speed gives way when the block is handed on.
//!
//! Where acceleration may pass a transition (with HSC; with TRAPEZ and SIN2 if it is tangential and both sides have the same
//! limits, as it is in a circle of several arcs), the blocks on both sides belong to one *span*: one change of speed after the
//! other runs across them. Transitions between spans are *anchors*: acceleration is zero there. `span` decides
//! which transitions are anchors, `ease` does without some of them.
//!
//! The backward pass runs when the ring is full, a few blocks per call; then a quarter of the ring is handed on. It
//! ends early at the first transition whose speed did not change.
mod append;
mod dip;
mod dynamics;
mod ease;
mod limits;
mod pace;
mod span;
mod vector;
mod weights;

pub use dynamics::{Curving, Dynamics, Permitted};
pub use limits::{Law, Limits, Share};
pub(crate) use limits::{max, min};
pub(crate) use pace::SLOWEST;
use pace::Slowest;
pub use pace::{Headroom, Pace};
pub use vector::TooLow;
pub use weights::Weights;

use crate::quantity::{Distance, Speed};
use crate::slope::profile::speed_bits;
use append::Last;
use dip::Dip;
use ease::Ease;
use heapless::Deque;
use span::Pass;

/// A block in the ring. Its curve is in the queue: [`crate::queue::Course`].
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Path length, LSB 2^-44 mm.
    length: i64,
    /// Its limits.
    limits: Limits,
    /// Speed at which its start may be passed at most, mm/tick.
    cap: f32,
    /// Planned speed at its start.
    v_in: Speed,
    /// Speed at its start as far as it can be reached from the first block. Not of an anchor: [`Ease`], if any.
    v_reached: Speed,
    /// The speed that the last complete plan had there: it stays possible.
    v_old: Speed,
    /// How its speed follows the override.
    headroom: Headroom,
    joint: Joint,
    marks: Marks,
    /// It was cut off from the block before: their curve is one.
    continued: bool,
}

/// What else is said of the transition at the start of a block: in the upper bit, whether it may be tried to do without an
/// anchor there; below, how far it lets [`Block::cap`] rise beyond once: LSB 2^-7.
#[derive(Clone, Copy, Debug)]
struct Joint(u8);

impl Joint {
    const ONE: f32 = 128.0;
    const OPEN: u8 = 128;

    /// `rises`: 1…2.
    fn new(rises: f32, open: bool) -> Self {
        let rises = ((rises - 1.0) * Self::ONE) as u32;
        Self(rises.min(Self::OPEN as u32 - 1) as u8 | if open { Self::OPEN } else { 0 })
    }

    fn rises(self) -> f32 {
        1.0 + f32::from(self.0 & (Self::OPEN - 1)) * (1.0 / Self::ONE)
    }

    const fn is_open(self) -> bool {
        self.0 & Self::OPEN != 0
    }

    /// The anchor was tried.
    const fn close(&mut self) {
        self.0 &= Self::OPEN - 1;
    }
}

/// A speed that was lowered by this stays below its limit, whatever rounding.
const ROUNDED: f32 = 1.0 - 1.0 / 4_194_304.0;

/// What is said of a block with yes or no.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Marks(u8);

impl Marks {
    /// The speed at its start was planned for a lower end speed than the one that is planned now.
    const KEPT: u8 = 1;
    /// Acceleration is zero at its start.
    const ANCHOR: u8 = 2;
    /// It became an anchor after the last complete plan.
    const FRESH: u8 = 4;
    /// Its span does not rise above the speeds at its ends.
    const FLAT: u8 = 8;
    /// The span that begins with it keeps the limits of all its blocks.
    const CHECKED: u8 = 16;
    /// It waits for acknowledgements: the motion stands still before it.
    const GATE: u8 = 64;
    /// It stands for several blocks, and is twice as long as the way to a standstill.
    const LONG: u8 = 128;

    #[inline(always)]
    const fn has(self, mark: u8) -> bool {
        self.0 & mark != 0
    }

    #[inline(always)]
    fn set(&mut self, mark: u8, on: bool) {
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

    fn is(&self, mark: u8) -> bool {
        self.marks.has(mark)
    }

    /// Whether it waits for acknowledgements.
    pub fn is_gate(&self) -> bool {
        self.is(Marks::GATE)
    }

    /// Speed at which its start may be passed now.
    fn cap(&self) -> f32 {
        if self.is(Marks::GATE) { 0.0 } else { self.cap }
    }
}

impl Block {
    /// What its span leaves unused, if it is the second one in it.
    fn ease(&self) -> Ease {
        if self.v_reached > UNPLANNED { Ease::of(self.v_reached) } else { Ease::NONE }
    }

    /// It is no anchor any more.
    fn give_way(&mut self) {
        self.marks.set(Marks::ANCHOR | Marks::FRESH, false);
        (self.v_reached, self.v_old) = (UNPLANNED, UNPLANNED);
    }

    /// It begins at the speed `v_in`, lower than planned or as planned.
    fn start_at(&mut self, v_in: Speed) {
        self.v_in = v_in;
        if v_in != self.v_reached {
            self.marks.set(Marks::CHECKED, false);
        }
    }
}

/// The span at the front of the ring.
#[derive(Clone, Copy, Debug)]
pub struct Release {
    /// Its blocks.
    pub blocks: usize,
    /// Path length.
    pub length: Distance,
    /// What all of its blocks permit; of the speeds the highest.
    pub limits: Limits,
    /// Deceleration that all of its blocks permit: a law may be gentler, see `limits`.
    pub a_down: f32,
    /// The lowest of their speeds.
    pub v_least: f32,
    /// Speed at its start.
    pub v_in: Speed,
    /// Speed at its end.
    pub v_out: Speed,
    /// All blocks keep their limits with these speeds; otherwise only as long as it is no faster than the faster
    /// one of `v_least` and `v_in`.
    pub checked: bool,
    /// Highest speed that is known to keep the limits of all its blocks once it begins or goes on at another speed.
    pub ceiling: f32,
    /// How its speed follows the override: of its blocks the fastest.
    pub headroom: Headroom,
    /// The speed of the block behind it.
    pub v_next: f32,
    /// How that follows the override.
    pub next: Headroom,
    /// Highest speed while the speed is reduced.
    pub v_reduced: f32,
    /// The level that all speeds were planned for.
    pub level: f32,
}

impl Release {
    /// Nothing.
    pub const BLANK: Self = Self {
        blocks: 0,
        length: Distance::ZERO,
        limits: Limits::WIDEST,
        a_down: f32::MAX,
        v_least: 0.0,
        v_in: Speed::ZERO,
        v_out: Speed::ZERO,
        checked: false,
        ceiling: f32::MAX,
        headroom: Headroom::NONE,
        v_next: 0.0,
        next: Headroom::NONE,
        v_reduced: f32::MAX,
        level: 1.0,
    };

    /// Takes in a higher level.
    pub fn raise(&mut self, level: f32) {
        let risen = |v: f32, h: Headroom| max(v, v * (h.raised(level) / h.raised(self.level)) * ROUNDED);
        self.limits.v = risen(self.limits.v, self.headroom);
        self.v_next = risen(self.v_next, self.next);
        self.level = level;
    }

    /// Its limits, and the deceleration of a slowing down that takes the place of its law.
    pub const fn braking(&self) -> (&Limits, f32) {
        (&self.limits, self.a_down)
    }

    /// Whether it is long enough to slow down from `v_in` to `v_out`.
    pub fn can_leave(&self, v_in: Speed, v_out: Speed) -> bool {
        span::can_leave(&self.limits, self.length.to_bits(), v_in, v_out)
    }

    /// Highest speed at its start, at most `v_in`, from which its end speed can be reached.
    pub fn enter(&self) -> Speed {
        span::enter(&self.limits, self.length.to_bits(), self.v_out, self.v_in)
    }

    /// Highest speed at its end, at most `next`, that can be reached from the speed at its start.
    pub fn reach(&self, next: Speed) -> Speed {
        span::leave(&self.limits, self.length.to_bits(), true, self.v_in, next).unwrap_or(Speed::ZERO)
    }

    /// Highest speed at its end, at most `v_out`, that can be reached from a speed at its start of at most that planned.
    pub fn leave(&self, v_in: Speed) -> Speed {
        span::leave(&self.limits, self.length.to_bits(), false, v_in, self.v_out).unwrap_or(Speed::ZERO)
    }
}

/// The ring.
pub struct Lookahead<const AXES: usize, const BLOCKS: usize> {
    blocks: Deque<Block, BLOCKS>,
    depth: usize,
    last: Option<Last<AXES>>,
    /// The next transition is a standstill.
    stop: bool,
    /// The next block is a gate.
    gate: bool,
    /// The plan goes on at least to this block: from there on it may be as it was.
    until: usize,
    /// The first block's start may rise up to this speed.
    free: Option<Speed>,
    pass: Pass,
    /// More blocks may come.
    open: bool,
    /// Transitions in the ring that are no anchors.
    through: usize,
    /// Anchors that may be tried to do without.
    untried: usize,
    /// Blocks in the ring that are long.
    long: usize,
    /// Path length since the last anchor, LSB 2^-44 mm.
    span: i64,
    /// The last plan was one of single blocks.
    blockwise: bool,
    /// Where the plan before the present one ended: so many blocks from the front.
    end: usize,
    /// The first block's start was lowered while the plan was at work.
    stale: bool,
    /// Speeds are those of the programmed feed, so many times.
    level: f32,
    slowest: Slowest,
    /// Blocks that are left free for cuts.
    spare: usize,
    /// What is tried to be cut.
    dip: Dip,
}

/// So many long blocks are a full ring: at any speed of the first one there is time to stop in the second.
const LONG_BLOCKS: usize = 2;

/// No speed yet.
const UNPLANNED: Speed = Speed::from_bits(-1);

impl<const AXES: usize, const BLOCKS: usize> Lookahead<AXES, BLOCKS> {
    /// An empty ring that uses `depth` of its blocks.
    pub const fn new(depth: usize) -> Self {
        let depth = if depth < BLOCKS { depth } else { BLOCKS };
        Self {
            blocks: Deque::new(),
            depth,
            last: None,
            stop: false,
            gate: false,
            until: usize::MAX,
            free: None,
            pass: Pass::Done,
            open: false,
            through: 0,
            untried: 0,
            long: 0,
            span: 0,
            blockwise: true,
            end: 0,
            stale: false,
            level: 1.0,
            slowest: Slowest::NONE,
            spare: 0,
            dip: Dip::NONE,
        }
    }

    /// The level of all speeds, see [`Pace`].
    pub fn level(&self) -> f32 {
        self.level
    }

    /// Speeds are planned for another level, a higher one unless the ring is empty. What was planned stays possible.
    pub fn set_level(&mut self, level: f32) {
        let before = self.level;
        self.level = level;
        let mut last = 0.0;
        for (k, block) in self.blocks.iter_mut().enumerate() {
            let by = block.headroom.raised(level) / block.headroom.raised(before);
            block.limits.v = max(block.limits.v, block.limits.v * (by * ROUNDED));
            block.marks.set(Marks::CHECKED, false);
            if k > 0 {
                // From the highest speed that the transition permits, of which no more than the double is known.
                let highest = block.cap * block.joint.rises();
                block.cap = max(block.cap, min(highest, min(last, block.limits.v)) * ROUNDED);
                block.joint = Joint::new(min(highest / block.cap, 2.0), block.joint.is_open());
            }
            last = block.limits.v;
        }
        if !self.blocks.is_empty() {
            self.until = 0;
            if !matches!(self.pass, Pass::Done) {
                self.begin();
            }
        }
    }

    /// Whether there is no room for another block, or what is there is long enough for any speed.
    pub fn is_full(&self) -> bool {
        self.blocks.len() + self.spare >= self.depth || self.long >= LONG_BLOCKS
    }

    /// Whether there is no block.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Throws away what it holds.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.last = None;
        self.gate = false;
        (self.until, self.free) = (usize::MAX, None);
        self.pass = Pass::Done;
        self.through = 0;
        self.untried = 0;
        self.long = 0;
        self.span = 0;
    }

    /// Blocks handed on after a pass: a quarter of what is there.
    pub fn batch(&self) -> usize {
        (self.blocks.len() / 4).max(1)
    }

    /// Demands a standstill before the next block.
    pub fn stop_here(&mut self) {
        self.stop = true;
    }

    /// Whether the motion waits for acknowledgements before the next block.
    pub fn before(&mut self, gate: bool) {
        self.gate = gate;
    }

    /// Begins to plan the whole ring. `open`: blocks may follow the last one, and their transition may need its
    /// part of the limits, which must not lower what is planned now.
    pub fn begin_pass(&mut self, open: bool) {
        self.open = open;
        if core::mem::take(&mut self.stale)
            && let Some(first) = self.blocks.front_mut()
        {
            first.marks.set(Marks::CHECKED, false);
        }
        self.begin();
    }

    /// The plan about to begin decides the speed at the first block's start too, up to `reach`.
    pub fn free_start(&mut self, reach: Speed) {
        self.free = Some(reach);
        self.until = 0;
    }

    /// Speed at which the first block may be entered, whatever comes before and behind.
    pub fn entry(&self) -> Speed {
        self.blocks.front().map_or(Speed::ZERO, |block| Speed::from_bits(speed_bits(block.cap())))
    }

    /// Planned speed at the first block's start.
    pub fn first_speed(&self) -> Speed {
        self.blocks.front().map_or(Speed::ZERO, |block| block.v_in)
    }

    /// Goes on with the plan; when it is complete, how many blocks may leave now.
    pub fn step_pass(&mut self) -> Option<usize> {
        self.step().then(|| self.ready())
    }

    /// Decides the end speed of the first span, whose blocks leave with [`Self::drop_first`]; its first block, `None` if there
    /// is none.
    pub fn release(&mut self, release: &mut Release) -> Option<&Block> {
        let (front, back) = self.blocks.as_slices();
        Self::span_of(front.iter().chain(back), release)?;
        release.level = self.level;
        release.v_reduced = self.slowest.least;
        release.checked &= !self.stale || release.blocks == 1;
        if let Some(next) = self.blocks.get_mut(release.blocks) {
            next.start_at(release.v_out);
        }
        self.stale = false;
        self.blocks.front()
    }

    /// The span that begins `at` blocks behind the front, as the last complete plan has it; `false` if there is none. Not while the plan
    /// is at work.
    pub fn planned(&self, at: usize, release: &mut Release) -> bool {
        release.level = self.level;
        release.v_reduced = self.slowest.least;
        Self::span_of(self.blocks.iter().take(self.end).skip(at), release).is_some()
    }

    /// The span at the front of these blocks; what the ring has for all of them is left open.
    #[inline(always)]
    fn span_of<'a>(mut ring: impl Iterator<Item = &'a Block>, release: &mut Release) -> Option<()> {
        let mut ease = Ease::NONE;
        let first = ring.next()?;
        let (mut blocks, mut length, mut kept) = (1, first.length, first.is(Marks::KEPT));
        let mut v_least = first.limits.v;
        let mut headroom = first.headroom;
        let mut limits = first.limits;
        let next = loop {
            match ring.next() {
                Some(block) if !block.is(Marks::ANCHOR) => {
                    if blocks == 1 {
                        ease = block.ease();
                    }
                    v_least = min(v_least, min(block.cap, block.limits.v));
                    limits.join(&block.limits);
                    headroom.join(block.headroom);
                    length += block.length;
                    (blocks, kept) = (blocks + 1, true);
                }
                next => break next,
            }
        };
        release.a_down = limits.a_down;
        if blocks > 1 {
            limits.ease(ease);
        }
        let v_in = first.v_in;
        let mut v_out = Speed::ZERO;
        release.v_next = 0.0;
        if let Some(next) = next {
            (release.v_next, release.next) = (next.limits.v, next.headroom);
            let planned = next.v_in.max(Speed::ZERO);
            v_out = span::leave(&limits, length, kept, v_in, planned).unwrap_or(Speed::ZERO);
        }
        if first.is(Marks::FLAT) {
            limits.flatten(v_in, v_out);
        }
        release.blocks = blocks;
        release.length = Distance::from_bits(length);
        release.limits = limits;
        (release.headroom, release.ceiling) = (headroom, f32::MAX);
        release.checked = first.is(Marks::CHECKED) || blocks == 1;
        (release.v_least, release.v_in, release.v_out) = (v_least, v_in, v_out);
        Some(())
    }

    /// The first block begins at the speed `v_in`, lower than planned or as planned.
    pub fn start_at(&mut self, v_in: Speed) {
        if let Some(first) = self.blocks.front_mut() {
            first.start_at(v_in);
        }
        self.stale = !matches!(self.pass, Pass::Done);
    }

    /// The first block begins at another speed than planned.
    pub fn restart(&mut self, v_in: Speed) {
        if let Some(first) = self.blocks.front_mut() {
            first.v_in = v_in;
            first.marks.set(Marks::CHECKED, false);
        }
        self.until = 0;
    }

    /// Opens the gate with this number, counted from the front; how many blocks are before it. Not while the plan is at work.
    pub fn open_gate(&mut self, number: usize) -> Option<usize> {
        let mut gates = self.blocks.iter_mut().enumerate().filter(|(_, block)| block.is_gate());
        let (index, block) = gates.nth(number)?;
        block.marks.set(Marks::GATE, false);
        self.until = self.until.min(index);
        Some(index)
    }

    /// The first block.
    pub fn first(&self) -> Option<&Block> {
        self.blocks.front()
    }

    /// The first block leaves the ring.
    pub fn drop_first(&mut self) {
        if let Some(block) = self.blocks.pop_front() {
            let anchor = block.is(Marks::ANCHOR);
            self.through -= usize::from(!anchor);
            self.untried -= usize::from(anchor && block.joint.is_open()).min(self.untried);
            self.long -= usize::from(block.is(Marks::LONG));
        }
        self.end = self.end.saturating_sub(1);
        if self.until != usize::MAX {
            self.until = self.until.saturating_sub(1);
        }
        if self.blocks.is_empty() {
            // What follows starts from rest.
            self.last = None;
        }
    }
}
