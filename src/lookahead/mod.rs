//! Limits over distance: a ring of blocks and, for each transition, the speed at which it may be taken.
//!
//! Two rules fix the speeds. Backward, from a standstill at the end of the ring: a block may be entered at the speed
//! from which its end speed can be reached within its length. Forward, when a block is handed on: its end speed is at
//! most what its start speed can grow to. Both use the slope with zero acceleration at the ends of the block. The
//! plan therefore always stops inside the ring. A higher end speed may lower what the first rule allows at the start;
//! then the speed planned before stays, and the end speed gives way when the block is handed on.
//!
//! The backward pass runs when the ring is full, a few blocks per call; then a quarter of the ring is handed on. It
//! ends early at the first transition whose speed did not change.
mod limits;

pub use limits::{Curving, Dynamics, Limits};
pub(crate) use limits::{max, min};

use crate::math::float::to_f32;
use crate::nc::Place;
use crate::path::{Element, End, Shape};
use crate::quantity::Speed;
use crate::slope::profile::{speed_bits, speed_f32};
use crate::slope::ramp::Ramp;
use heapless::Deque;

/// A block in the ring.
#[derive(Clone, Copy, Debug)]
pub struct Block<const AXES: usize> {
    /// Its curve.
    pub shape: Shape<AXES>,
    /// Its limits.
    pub limits: Limits,
    /// Speed at which its start may be passed at most, mm/tick.
    cap: f32,
    /// Planned speed at its start.
    v_in: Speed,
    /// That speed was planned for a lower end speed than the one that is planned now.
    kept: bool,
    /// Motion blocks from the one before it to its own: none where a motion block goes on.
    pub ahead: u16,
    /// Programmed N number.
    pub n: u32,
    /// Where it stands in the text.
    pub place: Place,
}

/// The block at the front of the ring and the speeds at its ends.
pub struct Release<'a, const AXES: usize> {
    /// The block.
    pub block: &'a Block<AXES>,
    /// Speed at its start.
    pub v_in: Speed,
    /// Speed at its end.
    pub v_out: Speed,
}

/// Path length, mm.
fn length_mm<const AXES: usize>(shape: &Shape<AXES>) -> f32 {
    to_f32(shape.length.to_bits()) * (1.0 / (1u64 << 44) as f32)
}

/// What the next transition needs to know of the last block.
#[derive(Clone, Copy, Debug)]
struct Last<const AXES: usize> {
    exit: End<AXES>,
    length: f32,
    rapid: bool,
}

/// The ring.
pub struct Lookahead<const AXES: usize, const BLOCKS: usize> {
    blocks: Deque<Block<AXES>, BLOCKS>,
    depth: usize,
    last: Option<Last<AXES>>,
    /// The next transition is a standstill.
    stop: bool,
    /// Blocks still to pass, and the speed at the end of the last of them.
    pass: Option<(usize, Speed)>,
    /// More blocks may come.
    open: bool,
}

/// Steps of the search for an end speed.
const LEAVE_STEPS: usize = 24;

/// Blocks per call of the backward pass.
const PASS_STEPS: usize = 4;

impl<const AXES: usize, const BLOCKS: usize> Lookahead<AXES, BLOCKS> {
    /// An empty ring that uses `depth` of its blocks.
    pub const fn new(depth: usize) -> Self {
        let depth = if depth < BLOCKS { depth } else { BLOCKS };
        Self { blocks: Deque::new(), depth, last: None, stop: false, pass: None, open: false }
    }

    /// Whether there is no room for another block.
    pub fn is_full(&self) -> bool {
        self.blocks.len() >= self.depth
    }

    /// Whether there is no block.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Throws away what it holds.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.last = None;
    }

    /// Blocks handed on after each pass.
    pub fn batch(&self) -> usize {
        (self.depth / 4).max(1)
    }

    /// Demands a standstill before the next block.
    pub fn stop_here(&mut self) {
        self.stop = true;
    }

    /// Appends a block. Only when not [`Self::is_full`].
    pub fn push(
        &mut self,
        element: &Element<AXES>,
        mut limits: Limits,
        rapid: bool,
        dynamics: &Dynamics<AXES>,
        (ahead, n): (u16, u32),
        place: Place,
    ) {
        let length = length_mm(&element.shape);
        let mut cap = 0.0;
        if let (Some(last), Some(before), false) = (&self.last, self.blocks.back_mut(), self.stop) {
            cap = min(before.limits.v, limits.v);
            let rapid = rapid && last.rapid;
            let shorter = min(last.length, length);
            if let Some(v) = dynamics.transition(&last.exit, &element.entry, rapid, shorter, cap) {
                cap = min(cap, v);
                limits.share();
                before.limits.share();
            }
        }
        self.stop = false;
        self.last = Some(Last { exit: element.exit, length, rapid });
        let block =
            Block { shape: element.shape, limits, cap, v_in: Speed::ZERO, kept: false, ahead, n, place };
        // There is room: the caller asked.
        let _ = self.blocks.push_back(block);
    }

    /// Begins a pass over the whole ring. `open`: blocks may follow the last one, and their transition may need its
    /// part of the limits, which must not lower what is planned now.
    pub fn begin_pass(&mut self, open: bool) {
        self.open = open;
        self.pass = Some((self.blocks.len(), Speed::ZERO));
    }

    /// Goes on with the pass; `true` when it is complete.
    pub fn step_pass(&mut self) -> bool {
        let Some((mut left, mut v_out)) = self.pass else { return true };
        for _ in 0..PASS_STEPS {
            // The first block's start is already decided.
            if left <= 1 {
                self.pass = None;
                return true;
            }
            left -= 1;
            let last = left + 1 == self.blocks.len();
            let Some(block) = self.blocks.get_mut(left) else { continue };
            let mut limits = block.limits;
            if last && self.open {
                limits.share();
            }
            let v = block.faster(&limits.brake(), v_out, block.cap);
            // With no acceleration at both ends, slowing down by less may take longer: where the largest acceleration
            // is not reached, the distance from v to w goes with (v + w)·√(v − w), which grows with w up to about v/2.
            // What was planned with a lower end speed stays possible, and is not taken back.
            block.kept = v < block.v_in;
            let v = v.max(block.v_in);
            if v == block.v_in && v != Speed::ZERO {
                self.pass = None;
                return true;
            }
            block.v_in = v;
            v_out = v;
        }
        self.pass = Some((left, v_out));
        false
    }

    /// Decides the end speed of the first block, which leaves with [`Self::drop_first`].
    pub fn release(&mut self) -> Option<Release<'_, AXES>> {
        let block = self.blocks.front()?;
        let v_in = block.v_in;
        let planned = self.blocks.get(1).map(|next| next.v_in);
        let v_out = planned.map_or(Speed::ZERO, |planned| block.leave(v_in, planned));
        if let Some(next) = self.blocks.get_mut(1) {
            next.v_in = v_out;
        }
        Some(Release { block: self.blocks.front()?, v_in, v_out })
    }

    /// The first block leaves the ring.
    pub fn drop_first(&mut self) {
        let _ = self.blocks.pop_front();
        if self.blocks.is_empty() {
            // What follows starts from rest.
            self.last = None;
        }
    }
}

impl<const AXES: usize> Block<AXES> {
    /// Highest speed at its end, at most `next`, that can be reached from `v_in`.
    fn leave(&self, v_in: Speed, next: Speed) -> Speed {
        if next >= v_in {
            return self.faster(&self.limits.speed_up(), v_in, self.limits.v).min(next);
        }
        let highest = next;
        let brake = self.limits.brake();
        if !self.kept || self.faster(&brake, highest, self.limits.v) >= v_in {
            return highest;
        }
        // The speed was planned with a lower one here, where slowing down is quicker.
        let (mut low, mut high) = (0, highest.to_bits());
        for _ in 0..LEAVE_STEPS {
            let middle = low + (high - low) / 2;
            if self.faster(&brake, Speed::from_bits(middle), self.limits.v) >= v_in {
                low = middle;
            } else {
                high = middle;
            }
        }
        Speed::from_bits(low)
    }

    /// The change itself is rounded, not the speed: at high speed over short blocks it is far below the speed's LSB
    /// in `f32`.
    fn faster(&self, ramp: &Ramp, low: Speed, cap: f32) -> Speed {
        let cap = speed_bits(cap);
        if low.to_bits() >= cap {
            return Speed::from_bits(cap);
        }
        let gain = ramp.reach(speed_f32(low.to_bits()), length_mm(&self.shape));
        Speed::from_bits(low.to_bits().saturating_add(speed_bits(gain)).min(cap))
    }
}
