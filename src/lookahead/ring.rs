//! The ring of blocks of the look-ahead: how blocks enter and leave, and counts of certain blocks and
//! transitions.
use super::append::Last;
use super::block::{Block, Marks};
use super::blocks::Blocks;
use super::brief::Row;
use super::knees::Steps;
use super::pace::Slowest;
use super::planned::Planned;
use super::run_out::RunOut;
use crate::dynamics::Share;
use crate::math::float::{max, min, to_bits};
use crate::math::wide::mul_shift;
use crate::path::End;
use crate::quantity::{Speed, speed_bits};
use crate::slope::limits::ROUNDED;

/// The ring of blocks of the look-ahead, in the order of the path.
pub struct Ring<'a, const AXES: usize, const BLOCKS: usize> {
    pub(super) blocks: &'a mut Blocks<BLOCKS>,
    /// Number of places for blocks that are used.
    pub(super) depth: usize,
    /// The planned override: planned speeds are for the programmed feed times this factor.
    pub(super) level: f32,
    /// A factor for the planned speeds that has not been applied yet, LSB 2^-36.
    pub(super) lowering: Option<i64>,
    /// Speed at the start of the first block, if there is one. This speed may have any value; all other
    /// speeds are [`Planned`].
    pub(super) start: Speed,
    pub(super) tail: Tail<AXES>,
    pub(super) scope: Scope,
    pub(super) counts: Counts,
    /// Whether blocks are only examined and do not enter the ring.
    #[cfg(feature = "examine")]
    examines: bool,
}

/// Data of the last blocks for the next block.
pub(super) struct Tail<const AXES: usize> {
    /// Stored limits of the last block.
    pub known: Known,
    pub last: Last<AXES>,
    /// Whether the motion stops at the next transition.
    pub stop: bool,
    /// Whether the next block is a gate.
    pub gate: bool,
    /// Path length since the last anchor, LSB 2^-44 mm.
    pub span: i64,
    /// Two feeds since the last anchor, mm/min: the lowest feed of blocks whose limits trade speed for
    /// acceleration, and the highest feed of all blocks.
    pub feeds: [f32; 2],
    /// The last consecutive blocks, to limit the blocks per tick.
    pub row: Row,
    /// Steps of speed at the last knees that may fall into one tick with the next knee.
    pub steps: Steps<AXES>,
    /// The lowest reduced speed of the last blocks.
    pub slowest: Slowest,
    /// Data of the arc whose end is the last block.
    pub run_out: RunOut,
}

/// Whether the ring still has the block before the next one, or at least its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Known {
    Nothing,
    /// The end of the block; the block has left the ring.
    Exit,
    /// The whole block; it is the last one in the ring.
    Block,
}

/// The extent of the next plan, and the result of the last one.
pub(super) struct Scope {
    /// The plan goes at least from the end to this block. Nearer to the front, the old plan may stay.
    pub until: usize,
    /// The start speed of the first block may rise up to this speed.
    pub free: Option<Speed>,
    /// More blocks may come.
    pub open: bool,
    /// Whether the last plan had a span for each single block.
    pub blockwise: bool,
    /// Number of blocks in the last plan.
    pub end: usize,
    /// The start speed of the first block was lowered while the plan was in progress.
    pub stale: bool,
}

/// Numbers of certain blocks and transitions in the ring.
pub(super) struct Counts {
    /// Transitions in the ring that are not anchors.
    pub through: usize,
    /// Anchors that the planner may still try to remove.
    pub untried: usize,
    /// Blocks in the ring that are long.
    pub long: usize,
    /// Number of places that stay free for cuts.
    pub spare: usize,
}

impl<const AXES: usize> Tail<AXES> {
    const NONE: Self = Self {
        known: Known::Nothing,
        last: Last::BLANK,
        stop: false,
        gate: false,
        span: 0,
        feeds: [f32::MAX, 0.0],
        row: Row::NONE,
        steps: Steps::NONE,
        slowest: Slowest::NONE,
        run_out: RunOut::NONE,
    };
}

impl<const AXES: usize> Tail<AXES> {
    /// Notes that the last block has left the ring; its end is kept.
    fn leave(&mut self) {
        if self.known == Known::Block {
            self.known = Known::Exit;
        }
    }

    /// The limits that a transition after the last block leaves to the speed profile. Returns `None` if no
    /// block may follow.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn share(&self, may_come: bool) -> Option<&Share> {
        (may_come && self.known == Known::Block).then_some(&self.last.share)
    }
}

impl Scope {
    const NONE: Self =
        Self { until: usize::MAX, free: None, open: false, blockwise: true, end: 0, stale: false };
}

impl Counts {
    const NONE: Self = Self { through: 0, untried: 0, long: 0, spare: 0 };
}

/// A lower planned override lowers the planned speeds by more than rounding lowers the limits.
const LOWERS: f32 = 1.0 - 1.0 / 524_288.0;

/// Loss of a planned speed by rounding, as a part of the speed, LSB 2^-36.
const LOST: i64 = 1 << 10;

/// The speed `v` multiplied by `part`, LSB 2^-36.
fn scaled(v: Speed, part: i64) -> Speed {
    Speed::from_bits(mul_shift(v.to_bits(), part, 36))
}

/// Scales the planned speeds of anchors, from the last anchor to the first. The rounding of each speed
/// includes the rounding loss of the anchor after it. So the change of speed within a span grows by no more
/// than the span has room for.
#[derive(Clone, Copy, PartialEq)]
struct Lowered {
    part: i64,
    /// The planned speed of the next anchor, before and after scaling.
    was: Planned,
    is: Planned,
}

impl Lowered {
    fn new(part: i64) -> Self {
        Self { part, was: Planned::ZERO, is: Planned::ZERO }
    }

    /// Scales a planned speed. No speed stays no speed, and counts as a stop.
    fn take(&mut self, planned: &mut Planned) {
        if !planned.is_some() {
            (self.was, self.is) = (Planned::ZERO, Planned::ZERO);
            return;
        }
        if *planned != self.was {
            self.lower(*planned);
        }
        *planned = self.is;
    }

    #[inline(never)]
    fn lower(&mut self, v: Planned) {
        let [was, is, bits] = [self.was, self.is, v].map(|planned| planned.speed().to_bits());
        let lowered = if bits > was {
            Speed::from_bits(is + scaled(Speed::from_bits(bits - was), self.part).to_bits())
        } else {
            scaled(Speed::from_bits(bits), self.part).min(Speed::from_bits(is))
        };
        (self.was, self.is) = (v, Planned::below(lowered));
    }
}

/// Number of long blocks with which the ring counts as full. From any speed of the first long block, the
/// motion can stop within the second one.
const LONG_BLOCKS: usize = 2;

impl<'a, const AXES: usize, const BLOCKS: usize> Ring<'a, AXES, BLOCKS> {
    /// An empty ring that uses `depth` of its blocks.
    pub(super) fn new(blocks: &'a mut Blocks<BLOCKS>, depth: usize) -> Self {
        const { assert!(BLOCKS <= u16::MAX as usize, "a span counts its blocks in 16 bits") };
        blocks.clear();
        let depth = if depth < BLOCKS { depth } else { BLOCKS };
        let (tail, scope, counts) = (Tail::NONE, Scope::NONE, Counts::NONE);
        Self {
            blocks,
            depth,
            level: 1.0,
            lowering: None,
            start: Speed::ZERO,
            tail,
            scope,
            counts,
            #[cfg(feature = "examine")]
            examines: false,
        }
    }

    /// Direction and curvature at the end of the last block. Returns `None` if the ring does not know the
    /// last block.
    pub fn exit(&self) -> Option<&End<AXES>> {
        (self.tail.known != Known::Nothing).then_some(&self.tail.last.exit)
    }

    /// Forgets the end of the last block. Call this function before another program.
    pub fn forget_exit(&mut self) {
        self.tail.known = Known::Nothing;
    }

    /// Starts a check: from now on, blocks are only examined for refusals.
    #[cfg(feature = "examine")]
    pub fn begin_to_examine(&mut self) {
        self.examines = true;
    }

    /// Whether blocks are only examined for refusals, without a plan.
    #[cfg(feature = "examine")]
    pub fn examines(&self) -> bool {
        self.examines
    }

    /// Notes the end of a block that is only examined; the next block begins there.
    #[cfg(feature = "examine")]
    pub fn pass_by(&mut self, exit: &End<AXES>) {
        (self.tail.last.exit.tangent, self.tail.last.exit.curvature) = (exit.tangent, exit.curvature);
        self.tail.known = Known::Exit;
    }

    /// The override for which all speeds are planned (1 is 100 %): see [`super::Pace`].
    pub fn level(&self) -> f32 {
        self.level
    }

    /// Highest speed at which the motion may enter the first block if the planned override falls to `level`.
    pub fn entry_for(&self, level: f32) -> Speed {
        self.entry_at(self.lowers(level))
    }

    /// Highest start speed of the first block, if all speeds have the factor `part`.
    pub(super) fn entry_at(&self, part: i64) -> Speed {
        let anchors = self.blocks.len().saturating_sub(self.counts.through) as i64;
        scaled(self.first_speed(), part - LOST * anchors)
    }

    /// The factor of all speeds for a lower planned override, LSB 2^-36. The factor is lower by more than the
    /// rounding of limits, so that the planned motion stays inside the limits of all blocks. A separate
    /// function, because it is rarely called.
    #[inline(never)]
    pub(super) fn lowers(&self, level: f32) -> i64 {
        let (front, back) = self.blocks.as_slices();
        let inside = |part, block: &Block| min(part, block.limits_by_call().part_inside());
        let part = front.iter().chain(back).fold(level / self.level, inside);
        to_bits::<36>(part * LOWERS)
    }

    /// Plans the speeds for a higher override. Every planned speed stays possible.
    pub(super) fn raise(&mut self, level: f32) {
        let before = core::mem::replace(&mut self.level, level);
        let (mut last, mut lent) = (0.0, false);
        for (k, block) in self.blocks.iter_mut().enumerate() {
            let by = block.override_range.raised(level) / block.override_range.raised(before);
            block.numbers.v = max(block.v(), block.v() * (by * ROUNDED));
            block.marks.set(Marks::CHECKED, false);
            if !block.is(Marks::ANCHOR) && block.has_ease() {
                // The slow block sets this highest speed.
                block.keep_ease(block.ease().scaled(max(by * ROUNDED, 1.0)));
            }
            // A valley keeps its speed.
            if k > 0 && !lent && !block.joint.is_lent() {
                let fastest = min(block.highest, min(last, block.v()));
                block.cap = max(block.cap, fastest * ROUNDED);
            }
            (last, lent) = (block.v(), block.joint.is_lent());
        }
        if !self.blocks.is_empty() {
            self.scope.until = 0;
        }
    }

    /// Plans the speeds for the lower override `level`, with the factor `part`. The first block starts at
    /// `v_in`, at most [`Self::entry_at`]. With this factor, the planned motion stays possible, because all
    /// accelerations are lower ([`Limits::part_inside`]). Slow blocks get their lent pieces back.
    /// [`Self::lower_planned`] lowers the planned speeds in a later call.
    pub(super) fn lower(&mut self, (level, part): (f32, i64), v_in: Speed) {
        let before = core::mem::replace(&mut self.level, level);
        let (mut last, mut lent) = (f32::MAX, false);
        for block in self.blocks.iter_mut() {
            let by = block.override_range.raised(level) / block.override_range.raised(before);
            block.numbers.v *= by * ROUNDED;
            block.marks.set(Marks::CHECKED, false);
            block.marks.set(Marks::KEPT, true);
            block.cap = min(block.highest, min(last, block.v()));
            let is_anchor = block.is(Marks::ANCHOR);
            if (lent || block.joint.is_lent()) && !block.is_continued() {
                // This anchor is the start or the end of the slow block.
                self.counts.untried += usize::from(is_anchor && !block.joint.is_open());
                block.joint.open();
            }
            (last, lent) = (block.v(), block.joint.is_lent());
            block.joint.take_back();
            if !is_anchor && block.has_ease() {
                block.keep_ease(block.ease().scaled(by * ROUNDED));
            }
        }
        if !self.blocks.is_empty() {
            (self.start, self.lowering) = (v_in, Some(part));
            self.scope.until = 0;
        }
    }

    /// Lowers the planned speeds, if the planned override was lowered.
    #[inline(never)]
    pub(super) fn lower_planned(&mut self) {
        let Some(part) = self.lowering.take() else { return };
        let [mut planned, mut reached, mut old] = [(); 3].map(|()| Lowered::new(part));
        for block in self.blocks.iter_mut().rev().filter(|block| block.is(Marks::ANCHOR)) {
            planned.take(&mut block.v_in);
            // Usually, the speeds are equal from the end up to here.
            if reached == old && block.v_reached == block.v_old {
                reached.take(&mut block.v_reached);
                (old, block.v_old) = (reached, block.v_reached);
            } else {
                reached.take(&mut block.v_reached);
                old.take(&mut block.v_old);
            }
        }
    }

    /// Whether the ring takes no further block: there is no room, or the blocks are long enough to stop from
    /// any speed.
    #[inline]
    pub fn is_full(&self) -> bool {
        self.blocks.len() + self.counts.spare >= self.depth || self.counts.long >= LONG_BLOCKS
    }

    /// Whether the ring is empty.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Drops all blocks.
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.lowering = None;
        self.tail.leave();
        self.tail.gate = false;
        (self.scope.until, self.scope.free) = (usize::MAX, None);
        self.counts.through = 0;
        self.counts.untried = 0;
        self.counts.long = 0;
        self.tail.span = 0;
    }

    /// Number of blocks to release after a pass: a quarter of the ring.
    pub fn batch(&self) -> usize {
        (self.blocks.len() / 4).max(1)
    }

    /// Demands that the motion stops at the end of the last block.
    pub fn stop_here(&mut self) {
        self.tail.stop = true;
    }

    /// Sets whether the motion waits for acknowledgements before the next block.
    pub fn before(&mut self, gate: bool) {
        self.tail.gate = gate;
    }

    /// Begins a plan of the whole ring, see [`super::Lookahead::begin_pass`].
    pub(super) fn begin_pass(&mut self, open: bool) {
        self.scope.open = open;
        if core::mem::take(&mut self.scope.stale)
            && let Some(first) = self.blocks.front_mut()
        {
            first.marks.set(Marks::CHECKED, false);
        }
    }

    /// Permits the next plan to raise the start speed of the first block, up to `reach`.
    pub fn free_start(&mut self, reach: Speed) {
        self.scope.free = Some(reach);
        self.scope.until = 0;
    }

    /// Highest speed that the start of the first block permits, whatever speeds the neighbours have. 0 if the
    /// ring is empty, or if the motion has to stop before the block.
    pub fn entry(&self) -> Speed {
        self.blocks.front().map_or(Speed::ZERO, |block| Speed::from_bits(speed_bits(block.cap())))
    }

    /// Planned speed at the first block's start.
    pub fn first_speed(&self) -> Speed {
        if self.blocks.is_empty() { Speed::ZERO } else { self.start }
    }

    /// Sets the start speed of the first block to `v_in`, or to the planned one if that is lower. `stale`: a
    /// plan is in progress.
    pub(super) fn start_at(&mut self, v_in: Speed, stale: bool) {
        if let Some(first) = self.blocks.front_mut() {
            first.start_at(v_in);
            self.start = v_in;
        }
        self.scope.stale = stale;
    }

    /// Sets a start speed of the first block that differs from the planned one. The next plan covers the
    /// whole ring.
    pub fn restart(&mut self, v_in: Speed) {
        if let Some(first) = self.blocks.front_mut() {
            self.start = v_in;
            first.marks.set(Marks::CHECKED, false);
        }
        self.scope.until = 0;
    }

    /// Opens a gate: the motion no longer has to stop before it for acknowledgements. `number` counts the
    /// gates from the front. Returns the number of blocks before the gate, or `None` if there is no such
    /// gate. Do not call this function while a plan is in progress.
    pub fn open_gate(&mut self, number: usize) -> Option<usize> {
        let mut gates = self.blocks.iter_mut().enumerate().filter(|(_, block)| block.is_gate());
        let (index, block) = gates.nth(number)?;
        block.marks.set(Marks::GATE, false);
        self.scope.until = self.scope.until.min(index);
        Some(index)
    }

    /// The first block of the ring, which leaves the ring next.
    pub fn first(&self) -> Option<&Block> {
        self.blocks.front()
    }

    /// Inserts a block as number `at`; the nearer part of the ring moves. Returns `false` if there is no
    /// room.
    pub(super) fn insert(&mut self, at: usize, block: Block) -> bool {
        let early = at < self.blocks.len() / 2;
        let pushed = if early { self.blocks.push_front(block) } else { self.blocks.push_back(block) };
        if !pushed {
            return false;
        }
        let (front, back) = self.blocks.as_mut_slices();
        let here = front.len();
        // The block moves from one slice to the other.
        if early {
            turn(front.get_mut(..here.min(at + 1)), Turn::Left);
            if at >= here
                && let (Some(last), Some(next)) = (front.last_mut(), back.first_mut())
            {
                core::mem::swap(last, next);
                turn(back.get_mut(..at + 1 - here), Turn::Left);
            }
        } else {
            turn(back.get_mut(at.saturating_sub(here)..), Turn::Right);
            if at < here {
                if let (Some(last), Some(next)) = (front.last_mut(), back.first_mut()) {
                    core::mem::swap(last, next);
                }
                turn(front.get_mut(at..), Turn::Right);
            }
        }
        true
    }

    /// Removes the first block.
    pub fn drop_first(&mut self) {
        if let Some(block) = self.blocks.pop_front() {
            let anchor = block.is(Marks::ANCHOR);
            self.counts.through -= usize::from(!anchor);
            self.counts.untried -= usize::from(anchor && block.joint.is_open()).min(self.counts.untried);
            self.counts.long -= usize::from(block.is(Marks::LONG));
        }
        self.scope.end = self.scope.end.saturating_sub(1);
        if self.scope.until != usize::MAX {
            self.scope.until = self.scope.until.saturating_sub(1);
        }
        if self.blocks.is_empty() {
            // The next block starts at a stop.
            self.tail.leave();
        }
    }
}

/// Direction in which blocks move to make room.
enum Turn {
    /// The first block becomes the last.
    Left,
    /// The last block becomes the first.
    Right,
}

fn turn(blocks: Option<&mut [Block]>, turn: Turn) {
    if let Some(blocks) = blocks
        && !blocks.is_empty()
    {
        match turn {
            Turn::Left => blocks.rotate_left(1),
            Turn::Right => blocks.rotate_right(1),
        }
    }
}
