//! The end of an arc on a circle that has already turned twice, while it is unknown whether the next block
//! continues the circle.
//!
//! Such an arc enters the ring as two blocks. The first block has the limits of an endless circle. The second
//! block is the end of the arc, with lower limits ([`crate::dynamics::Turns`]), because the motion may have
//! to brake there. If the next arc continues the circle, the planner joins both blocks into one, with the
//! limits of the first block. The next arc again enters as two blocks. The old plan stays possible: the
//! motion can keep the speed planned for the old end up to the new end. For this, the new end must be at
//! least as long as the old one, and permit at least the same speed.
use super::block::Marks;
use super::ring::{Known, Ring};
use crate::dynamics::{Dynamics, Share, Turns};
use crate::math::float::{max, to_f32};
use crate::path::Piece;

/// Data of the last block before its end was cut off.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RunOut {
    /// Lengths of both blocks of an arc, LSB 2^-44 mm. 0 if the last block is not the end of such an arc.
    lengths: [i64; 2],
    share: Share,
    shared: bool,
    /// See [`super::ring::Tail`].
    span: i64,
    feeds: [f32; 2],
}

impl RunOut {
    /// The last block is not the end of such an arc.
    pub(super) const NONE: Self =
        Self { lengths: [0; 2], share: Share::WHOLE, shared: false, span: 0, feeds: [f32::MAX, 0.0] };

    /// Marks that the last block is not the end of an arc with two blocks. Every block calls this function,
    /// so the mark is one word; no block has length 0.
    #[inline(always)]
    pub(super) const fn clear(&mut self) {
        self.lengths[1] = 0;
    }
}

impl<const AXES: usize, const BLOCKS: usize> Ring<'_, AXES, BLOCKS> {
    /// Whether the ring has room for two blocks.
    pub(crate) fn has_room_for_two(&self) -> bool {
        self.blocks.len() + self.counts.spare + 2 <= self.depth
    }

    /// Prepares for the end of an arc as the next block; `length` is the length of that end, LSB 2^-44 mm.
    pub(crate) fn before_run_out(&self, length: i64) -> RunOut {
        let last = &self.tail.last;
        let before = self.blocks.len().checked_sub(1).and_then(|at| self.blocks.get(at));
        RunOut {
            lengths: [before.map_or(0, |block| block.length), length],
            share: last.share,
            shared: last.shared,
            span: self.tail.span + length,
            feeds: self.tail.feeds,
        }
    }

    /// Records that the end has entered the ring.
    pub(crate) fn run_out(&mut self, before: RunOut) {
        if let Some(block) = self.blocks.back_mut() {
            block.go_on();
        }
        self.tail.run_out = before;
    }

    /// Joins the end of the last arc with the rest of that arc, because the circle continues with `piece`.
    /// Does nothing if the motion could then not follow the plan.
    #[inline(never)]
    pub(crate) fn rejoin(
        &mut self,
        piece: &Piece<'_, AXES>,
        rapid: bool,
        turns: &Turns,
        dynamics: &Dynamics<AXES>,
    ) {
        let before = self.tail.run_out;
        let count = self.blocks.len();
        if count < 2 || self.tail.known != Known::Block || self.tail.stop || self.tail.gate {
            return;
        }
        let (Some(rest), Some(end)) = (self.blocks.get(count - 2), self.blocks.get(count - 1)) else {
            return;
        };
        if [rest.length, end.length] != before.lengths
            || turns.run_out < end.length
            || !end.is_continued()
            || self.tail.last.slope != dynamics.slope()
            || self.tail.last.rapid != rapid
        {
            return;
        }
        let (mut limits, _, override_range) = turns.end;
        if self.level < 1.0 {
            limits.v *= override_range.raised(self.level);
        }
        let known = end.limits_by_call();
        if limits.v < known.v || !limits.are(&known) {
            return;
        }
        let length = to_f32(rest.length + end.length) * (1.0 / (1u64 << 44) as f32);
        let fastest = max(rest.full(self.level), turns.steady.0.v);
        let last = &self.tail.last;
        if dynamics.transition(&last.exit, piece.entry, rapid, length, (fastest, 0.0)).is_some() {
            return;
        }
        self.drop_last();
        if let Some(rest) = self.blocks.get_mut(count - 2) {
            rest.length += before.lengths[1];
            rest.marks.set(Marks::CHECKED, false);
        }
        let last = &mut self.tail.last;
        (last.length, last.share, last.shared) = (length, before.share, before.shared);
        (self.tail.span, self.tail.feeds) = (before.span, before.feeds);
        self.tail.run_out.clear();
        self.scope.end = self.scope.end.min(count - 1);
        self.scope.until = self.scope.until.min(count - 2);
    }

    /// Removes the last block, which becomes a part of the block before it.
    fn drop_last(&mut self) {
        if let Some(block) = self.blocks.pop_back() {
            let anchor = block.is(Marks::ANCHOR);
            self.counts.through -= usize::from(!anchor);
            self.counts.untried -= usize::from(anchor && block.joint.is_open()).min(self.counts.untried);
            self.counts.long -= usize::from(block.is(Marks::LONG));
        }
    }
}
