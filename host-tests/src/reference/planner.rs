//! The plan block by block: limits, speeds at joints, time laws. Acceleration is zero at every joint.
//!
//! The ring of `depth` blocks is filled, planned down to a standstill at its end, and a quarter of it is handed on;
//! then it is filled again; long lines fill it sooner. At the end of the program all that is left is handed on.
use super::geometry::{Contour, Element, Shape};
use super::limits::{BlockLimits, Machine, path_length};
use super::profile::{Change, Profile, largest, reach};
use glidepath::channel::PlannedBlock;
use glidepath::quantity::Speed;

/// What the plan needs of one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Length.
    pub length: f64,
    /// Limits inside, when both neighbours are known.
    pub limits: BlockLimits,
    /// Highest speed at its start; zero after a stop.
    pub v_start: f64,
    /// It stands for several, and is long enough.
    pub long: bool,
    /// It is a line: it goes into the ring when the next block is known.
    pub waits: bool,
}

/// Blocks of a contour with their limits, joints included.
pub fn blocks(contour: &Contour, machine: &Machine) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut before: Option<&Element> = None;
    for element in &contour.elements {
        let mut limits = machine.block(element);
        let mut v_start = 0.0;
        if let (Some(before), Some(last)) = (before, blocks.last_mut())
            && !before.stop
        {
            v_start = last.limits.v.min(limits.v);
            let joint = machine.joint(before, element, v_start);
            // With STEP, blocks that may pass within a tick count as joints.
            let within = last.length < last.limits.v || path_length(element) < limits.v;
            if joint.is_some() || (limits.slope == 0 && within) {
                v_start = v_start.min(joint.unwrap_or(v_start));
                last.limits.share();
                limits.share();
            }
        }
        blocks.push(Block { length: path_length(element), limits, v_start, long: element.long, waits: element.shape == Shape::Line });
        before = Some(element);
    }
    blocks
}

/// Path length from the highest speed of a block to a standstill.
pub fn to_standstill(limits: &BlockLimits) -> f64 {
    Change::new(0.0, limits.v, limits.brake().reversed()).distance
}

/// So many long lines are a full ring.
const LONG_BLOCKS: usize = 4;

/// Time laws of all blocks from standstill to standstill.
///
/// # Panics
/// If a block cannot be travelled between the speeds that the passes found: then the passes are wrong.
pub fn plan(blocks: &[Block], depth: usize) -> Vec<Profile> {
    let mut profiles = Vec::with_capacity(blocks.len());
    let mut entries = vec![0.0; blocks.len() + 1];
    let mut start = 0;
    while start < blocks.len() {
        let mut known = start;
        let mut long = 0;
        while known < blocks.len() && known < start + depth && long < LONG_BLOCKS {
            long += usize::from(blocks[known].long);
            known += 1;
        }
        let mut ring = blocks[start..known].to_vec();
        // A full ring is planned before the end of the program is known.
        let ends = known == blocks.len() && blocks[known - 1].waits;
        let full = (known == start + depth || long == LONG_BLOCKS) && !ends;
        if let (true, Some(last)) = (full, ring.last_mut()) {
            // Whatever comes next may need its part of the jerk.
            last.limits.share();
        }
        raise(&mut entries[start..=known], &ring);
        let batch = if full { (ring.len() / 4).max(1) } else { ring.len() };
        for (i, block) in (start..).zip(&ring).take(batch) {
            let v_in = entries[i];
            let v_out = leave(block, v_in, entries[i + 1]);
            entries[i + 1] = v_out;
            let Block { length, limits, .. } = block;
            let profile =
                Profile::fastest(*length, v_in, v_out, limits.v, limits.accelerate(), limits.brake());
            profiles.push(profile.unwrap_or_else(|| panic!("block {i}: {v_in} to {v_out} in {block:?}")));
        }
        start += batch;
    }
    profiles
}

/// Raises the speeds at the starts of blocks as far as the motion can still come to a standstill at the end of the last.
/// The first one is decided.
///
/// With the acceleration zero at both ends, slowing down by less may take longer: from v to w the distance is
/// proportional to (v + w)·√(v - w) where the largest acceleration is not reached, which grows with w up to v/3. So a
/// speed that was possible with a lower one behind it may not follow from the higher one. It stays possible.
fn raise(entries: &mut [f64], blocks: &[Block]) {
    for (i, block) in blocks.iter().enumerate().skip(1).rev() {
        let highest = reach(block.length, entries[i + 1], block.v_start, block.limits.brake().reversed());
        entries[i] = highest.max(entries[i]);
    }
}

/// The highest speed at the end of a block, at most `next`, that can be reached from `v_in`.
fn leave(block: &Block, v_in: f64, next: f64) -> f64 {
    let highest = reach(block.length, v_in, next, block.limits.accelerate());
    let brake = |v_out: f64| Change::new(v_out, v_in, block.limits.brake().reversed()).distance;
    if brake(highest) <= block.length * (1.0 + 1e-12) {
        return highest;
    }
    // Slower, so that slowing down is quicker.
    largest(0.0, highest, |v_out| brake(v_out) <= block.length)
}

/// The time laws that go with the speeds and durations of a plan: ramps from the limits, and the rest of the duration at
/// the highest speed.
pub fn laws(blocks: &[Block], planned: &[PlannedBlock]) -> Vec<Profile> {
    let law = |(block, planned): (&Block, &PlannedBlock)| {
        let speed = |v: Speed| v.to_bits() as f64 / 2f64.powi(58);
        let (v_in, v_peak, v_out) = (speed(planned.v_in), speed(planned.v_peak), speed(planned.v_out));
        let rise = Change::new(v_in, v_peak, block.limits.accelerate());
        let fall = Change::new(v_out, v_peak, block.limits.brake().reversed());
        let time = planned.time.to_bits() as f64 / 2f64.powi(36);
        let length = planned.length.to_bits() as f64 / 2f64.powi(44);
        Profile { v_in, v_peak, v_out, length, cruise: time - rise.time() - fall.time(), rise, fall }
    };
    blocks.iter().zip(planned).map(law).collect()
}
