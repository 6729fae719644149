//! The course of the path speed, block by block: how slow the motion is between two blocks, how fast inside.
//!
//! The fastest tick of each block parts it. What is slow behind it belongs to the joint at the end of the
//! block, what is slow before it to the joint at the start: with a curve in the corner too, whose slowest
//! point lies beside the joint.
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
    /// The slowest between a block and the next one; none where a tick passes several, or in a line that
    /// stands for several.
    joints: Vec<Option<Seen>>,
    /// The fastest in each block; none without a tick in it.
    tops: Vec<Option<Seen>>,
    /// The slowest since the fastest.
    low: Option<Seen>,
    block: Option<u32>,
    /// The block before.
    before: Option<u32>,
}

impl Course {
    /// Takes in a row, and the block at whose end it stands.
    pub fn add(&mut self, tick: u64, block: u32, speed: Speed, stood: Option<u32>) {
        let seen = Seen { speed, tick };
        if self.block != Some(block) {
            self.before = self.block;
            self.block = Some(block);
            let room = block as usize + 1;
            self.tops.resize(room.max(self.tops.len()), None);
            self.joints.resize(room.max(self.joints.len()), None);
            // What is slow on both sides is one.
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
            // It stands where the block begins: at the joint in front of it, and at no other one.
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
        // A tick that has passed several: what was slow belongs to the first one.
        let other = before.filter(|before| *before != joint).and_then(|before| self.joints.get_mut(before));
        if let (Some(other), Some(low)) = (other, self.low) {
            *other = Some(other.map_or(low, |other| other.min(low)));
        }
        self.low = None;
        self.before = None;
    }

    /// Nothing is known of the joint at the end of a block.
    pub fn forget(&mut self, block: usize) {
        if let Some(joint) = self.joints.get_mut(block) {
            *joint = None;
        }
    }

    /// At the end of a law its speed is known exactly, also between two ticks: motion block, and that speed.
    pub fn refine(&mut self, ends: &[(usize, Speed)]) {
        for &(last, speed) in ends {
            if let Some(Some(joint)) = self.joints.get_mut(last) {
                joint.speed = joint.speed.min(speed);
            }
        }
    }

    /// The slowest at the end of a block, if another one follows.
    pub fn joint(&self, block: usize) -> Option<Seen> {
        self.joints.get(block).copied().flatten()
    }

    /// The fastest in a block.
    pub fn top(&self, block: usize) -> Option<Seen> {
        self.tops.get(block).copied().flatten()
    }

    /// Motion blocks.
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
