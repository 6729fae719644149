//! The path speed, block by block: lowest speed between two blocks, highest speed inside a block.
//!
//! The fastest tick of each block divides the block. Slow ticks after it belong to the transition at the end
//! of the block, slow ticks before it to the transition at the start. This also holds for a corner curve,
//! whose slowest point lies next to the transition.
use glidepath::quantity::Speed;

/// A speed, and the row of the trace that has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Seen {
    pub speed: Speed,
    pub tick: u64,
}

/// Speeds of a run, by motion block.
#[derive(Debug, Default)]
pub struct Course {
    /// The lowest speed at each transition; none if a tick passes several transitions, or inside a merged
    /// line.
    joints: Vec<Option<Seen>>,
    /// The highest speed in each block; none without a tick in the block.
    tops: Vec<Option<Seen>>,
    /// The lowest speed since the fastest tick.
    low: Option<Seen>,
    block: Option<u32>,
    /// The previous block.
    before: Option<u32>,
}

impl Course {
    /// Records a row, and the block at whose end the axes stand.
    pub fn add(&mut self, tick: u64, block: u32, speed: Speed, stood: Option<u32>) {
        let seen = Seen { speed, tick };
        if self.block != Some(block) {
            self.before = self.block;
            self.block = Some(block);
            let room = block as usize + 1;
            self.tops.resize(room.max(self.tops.len()), None);
            self.joints.resize(room.max(self.joints.len()), None);
            // Slow ticks on both sides belong to one transition.
            self.low = self.low.map(|low| if speed == Speed::ZERO { low } else { low.min(seen) });
        }
        if let Some(joint) = stood {
            self.stands(seen, joint as usize);
        }
        let Some(top) = self.tops.get_mut(block as usize) else { return };
        let low = self.low.map_or(seen, |low| low.min(seen));
        if top.is_none_or(|top| speed >= top.speed) {
            *top = Some(seen);
            if let Some(joint) = self.before.and_then(|before| self.joints.get_mut(before as usize)) {
                *joint = Some(joint.map_or(low, |other| other.min(low)));
            }
            // The axes stand at the start of the block: at the transition before it, and at no other one.
            self.low = (speed != Speed::ZERO).then_some(seen);
        } else {
            self.low = Some(low);
        }
    }

    fn stands(&mut self, seen: Seen, joint: usize) {
        let before = self.before.map(|before| before as usize);
        if let Some(joint) = self.joints.get_mut(joint) {
            *joint = Some(seen);
        }
        // The tick has passed several transitions: the lowest speed belongs to the first one.
        let other = before.filter(|before| *before != joint).and_then(|before| self.joints.get_mut(before));
        if let (Some(other), Some(low)) = (other, self.low) {
            *other = Some(other.map_or(low, |other| other.min(low)));
        }
        self.low = None;
        self.before = None;
    }

    /// Drops the value of the transition at the end of a block.
    pub fn forget(&mut self, block: usize) {
        if let Some(joint) = self.joints.get_mut(block) {
            *joint = None;
        }
    }

    /// At the end of a speed profile the speed is known exactly, also between two ticks: motion block, and
    /// speed.
    pub fn refine(&mut self, ends: &[(usize, Speed)]) {
        for &(last, speed) in ends {
            if let Some(Some(joint)) = self.joints.get_mut(last) {
                joint.speed = joint.speed.min(speed);
            }
        }
    }

    /// The lowest speed at the end of a block, if another block follows.
    pub fn joint(&self, block: usize) -> Option<Seen> {
        self.joints.get(block).copied().flatten()
    }

    /// The highest speed in a block.
    pub fn top(&self, block: usize) -> Option<Seen> {
        self.tops.get(block).copied().flatten()
    }

    /// Number of motion blocks.
    pub fn blocks(&self) -> usize {
        self.tops.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_places_beside_a_joint_belong_to_it() {
        let mut course = Course::default();
        let rows =
            [(0, 0), (0, 5), (0, 9), (0, 4), (0, 3), (1, 5), (1, 8), (1, 7), (3, 2), (3, 1), (3, 6), (3, 0)];
        for (tick, (block, speed)) in (0..).zip(rows) {
            course.add(tick, block, Speed::from_bits(speed), None);
        }
        let at = |seen: Option<Seen>| seen.map(|seen| (seen.speed.to_bits(), seen.tick));
        assert_eq!(
            [0, 1, 2, 3].map(|block| at(course.joint(block))),
            [Some((3, 4)), Some((1, 9)), None, None]
        );
        assert_eq!(
            [0, 1, 2, 3].map(|block| at(course.top(block))),
            [Some((9, 2)), Some((8, 6)), None, Some((6, 10))]
        );
        assert_eq!(course.blocks(), 4);
    }
}
