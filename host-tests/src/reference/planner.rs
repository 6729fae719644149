//! The plan, block by block: limits, speeds at transitions, speed profiles. Acceleration is zero at every
//! transition, unless both blocks have equal limits: then they have one speed profile.
//!
//! A block between a corner and a stop may be *hasty*: so short relative to its jerk that it takes less than
//! two ticks.
//! Then the block on its other side leaves the knee a part too. A hasty block that has left no knee a part at its
//! start has none at its end: the motion stands still there.
//!
//! The ring of `depth` blocks is filled, planned with a stop at its end, and a quarter of it is released;
//! then the ring is filled again. Long lines fill the ring sooner. At the end of the program all remaining
//! blocks are released.
use super::brief::Row;
use super::geometry::{Contour, Element, Shape};
use super::knees::{Between, Knees};
use super::limits::{BlockLimits, Machine, path_length};
use super::profile::{Change, Profile, largest, reach};
use super::worth::{Worth, worth};
use glidepath::channel::PlannedBlock;
use glidepath::quantity::Speed;

/// The data of one block for the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Length.
    pub length: f64,
    /// Limits inside, when both neighbours are known.
    pub limits: BlockLimits,
    /// Highest speed at its start; zero after a stop.
    pub v_start: f64,
    /// Whether the block replaces several blocks and is long enough.
    pub long: bool,
    /// Whether the block is a line: a line goes into the ring when the next block is known.
    pub waits: bool,
    /// Acceleration may pass its start.
    pub through: bool,
}

/// A block of this number of times the jerk of its steepest ramp may take less than two ticks between a
/// corner and a stop.
const HASTY: f64 = 0.4;

impl Block {
    /// Whether a block is so short that the changes of its neighbours fall together with a corner at its end.
    fn is_hasty(&self) -> bool {
        let steepest = self.limits.j.into_iter().fold(0.0, f64::max);
        self.limits.slope != 0 && self.length < HASTY * steepest
    }
}

/// Blocks of a contour with their limits, transitions included.
pub fn blocks(contour: &Contour, machine: &Machine) -> Vec<Block> {
    decided(contour, machine, |_, _, standing| standing)
}

/// The same, with decisions from outside. At a corner where passing and stopping take equal time, `stands`
/// decides whether the motion stops. Its arguments are the number of the block after the corner, the speed of
/// stopping, and the decision of this plan.
pub fn decided(
    contour: &Contour,
    machine: &Machine,
    stands: impl Fn(usize, f64, bool) -> bool,
) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut before: Option<&Element> = None;
    let mut row = Row::default();
    let mut knees = Knees::default();
    // The last one that takes more than next to nothing.
    let mut behind: Option<&Element> = None;
    // The last block has left a part to the transition at its start.
    let mut left = false;
    // Radians from where the circle begins.
    let mut turn = 0.0;
    for (number, element) in contour.elements.iter().enumerate() {
        let length = path_length(element);
        turn = turned(before, element, turn);
        let mut limits = machine.block(element, turn);
        let after_brief = row.is_brief();
        limits.v = limits.v.min(row.take(length, machine.overridden(element, turn)));
        let mut v_start = 0.0;
        let mut through = false;
        let mut shared = false;
        if let (Some(before), Some(last)) = (before, blocks.last_mut())
            && !before.stop
        {
            let cap = last.limits.v.min(limits.v);
            v_start = cap;
            let most = last.limits.most().max(limits.most());
            let mut joint = machine.joint(before, element, v_start, most);
            if let (true, Some(behind)) = (after_brief, behind) {
                let both = machine.bending(behind, element);
                if both < cap {
                    joint = Some(both.min(joint.unwrap_or(both)));
                }
            }
            let arc = limits.v_beside.min(last.limits.v_beside);
            joint = joint.map(|v| v.min(arc));
            let unseen = if limits.slope == 0 { 0.0 } else { cap.min(machine.unseen(before, element)) };
            let unseen = unseen.min(joint.unwrap_or(unseen));
            let standing = match joint {
                Some(_) if !left && last.is_hasty() => true,
                Some(v) if v < cap => match worth([(last.limits, last.length), (limits, length)], v) {
                    Worth::Passing => false,
                    Worth::Standing => true,
                    Worth::Tie(standing) => stands(number, unseen, standing),
                },
                _ => false,
            };
            // With STEP, blocks that may be passed within a tick count as transitions.
            let within = last.length < last.limits.v || length < limits.v;
            if standing {
                v_start = unseen;
            } else if joint.is_some() || (limits.slope == 0 && within) {
                v_start = v_start.min(joint.unwrap_or(v_start));
                last.limits.share();
                limits.share();
                shared = true;
            }
            if !shared && left && last.is_hasty() {
                limits.share();
                shared = true;
            }
            if limits.slope != 0 {
                let highest = if standing { unseen } else { joint.unwrap_or(f64::INFINITY).min(2.0 * cap) };
                let Block { length, v_start: start, through, .. } = *last;
                let between = Between { limits: &mut last.limits, length, v_start: start, through };
                v_start = v_start.min(knees.take(between, [before, element], highest, machine));
            }
            let fastest = [limits, last.limits].iter().fold(0.0, |a: f64, l| a.max(l.a_up).max(l.a_down));
            // A speed profile that begins or ends with acceleration in an arc.
            let passes =
                arc == f64::INFINITY || !shared || limits.passing.min(last.limits.passing) >= fastest;
            through = limits.slope != 0
                && !standing
                && passes
                && joint.is_none_or(|v| v >= cap && machine.slight(before, element, cap))
                && limits.are(&last.limits)
                && machine.turns_little(before, element, fastest);
        } else {
            knees.clear();
        }
        if !row.is_brief() || behind.is_none() {
            behind = Some(element);
        }
        blocks.push(Block {
            length,
            limits,
            v_start,
            long: element.long,
            waits: element.shape == Shape::Line,
            through,
        });
        before = Some(element);
        left = shared;
    }
    blocks
}

/// Centres closer than that in both axes are one, mm.
const ONE_CENTRE: f64 = 1.0 / 512.0;

/// Radians from the start of an arc's circle to its end: consecutive arcs about one centre count as one.
fn turned(before: Option<&Element>, element: &Element, turn: f64) -> f64 {
    let Shape::Arc { axes, centre, sweep, .. } = &element.shape else { return 0.0 };
    let goes_on = match before.map(|before| &before.shape) {
        Some(Shape::Arc { axes: others, centre: from, sweep: swept, .. }) => {
            let near = centre.iter().zip(from).all(|(a, b)| (a - b).abs() < ONE_CENTRE);
            axes == others && near && sweep.signum() == swept.signum()
        }
        _ => false,
    };
    if goes_on { turn + sweep.abs() } else { sweep.abs() }
}

/// The blocks with the library's decisions at corners where passing and stopping take equal time. The library
/// has stopped if its plan enters the block after the corner no faster than after a stop.
pub fn blocks_of(contour: &Contour, machine: &Machine, planned: &[PlannedBlock]) -> Vec<Block> {
    let mut entries = vec![None; contour.elements.len()];
    let mut first = 0;
    for planned in planned {
        if let Some(entry) = entries.get_mut(first) {
            *entry = Some(planned.v_in.to_bits() as f64 * SPEED);
        }
        let mut left = planned.blocks as usize;
        while left > 0 && first < contour.elements.len() {
            left -= contour.elements[first].blocks;
            first += 1;
        }
    }
    let stands = |number: usize, v: f64, standing| {
        entries[number].map_or(standing, |entry: f64| entry <= v * (1.0 + 1e-5) + SPEED)
    };
    decided(contour, machine, stands)
}

/// LSB of a planned speed, mm/tick.
pub const SPEED: f64 = 1.0 / (1u64 << 58) as f64;

/// Path length from rest to the highest speed of a block, or from there to rest: the longer one.
pub fn ways(limits: &BlockLimits) -> f64 {
    let way = |slope| Change::new(0.0, limits.v, slope).distance;
    way(limits.accelerate()).max(way(limits.brake().reversed()))
}

/// So many long lines are a full ring.
const LONG_BLOCKS: usize = 2;

/// Several blocks with one speed profile.
#[derive(Clone, Copy, Debug)]
struct Span {
    /// Numbers of its first block and of the block after its last one.
    first: usize,
    behind: usize,
    whole: Block,
}

/// The ring as spans: a new one at every anchor.
fn spans(blocks: &[Block], start: usize, anchors: &[bool]) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    for (number, block) in (start..).zip(blocks) {
        match spans.last_mut() {
            Some(span) if !anchors[number] => {
                span.behind += 1;
                span.whole.length += block.length;
                span.whole.limits = span.whole.limits.with(&block.limits);
            }
            _ => spans.push(Span { first: number, behind: number + 1, whole: *block }),
        }
    }
    spans
}

/// Speed profiles of all spans, from stop to stop.
///
/// # Panics
/// If a block cannot be travelled between the speeds that the passes found: then the passes are wrong.
pub fn plan(blocks: &[Block], depth: usize) -> Vec<Profile> {
    let mut profiles = Vec::with_capacity(blocks.len());
    let mut entries = vec![0.0; blocks.len() + 1];
    let mut anchors: Vec<bool> = blocks.iter().map(|block| !block.through).collect();
    let mut start = 0;
    while start < blocks.len() {
        let mut known = start;
        let mut long = 0;
        while known < blocks.len() && known < start + depth && long < LONG_BLOCKS {
            long += usize::from(blocks[known].long);
            known += 1;
        }
        let mut ring = blocks[start..known].to_vec();
        anchors[start] = true;
        // A full ring is planned before the end of the program is known.
        let ends = known == blocks.len() && blocks[known - 1].waits;
        let full = (known == start + depth || long == LONG_BLOCKS) && !ends;
        if let (true, Some(last)) = (full, ring.last_mut()) {
            // The next block may need its part of the jerk.
            last.limits.share();
        }
        let batch = if full { start + (ring.len() / 4).max(1) } else { known };
        let parts = loop {
            let parts = spans(&ring, start, &anchors);
            let mut raised = entries.clone();
            raise(&mut raised, &parts);
            let Some(cut) = full.then(|| cut(&parts, &ring, &raised, batch)).flatten() else {
                entries = raised;
                break parts;
            };
            anchors[cut] = true;
        };
        let leaves = |span: &&Span| span.first < batch;
        for span in parts.iter().take_while(leaves) {
            let v_in = entries[span.first];
            let v_out = leave(&span.whole, v_in, entries[span.behind]);
            entries[span.behind] = v_out;
            let Block { length, limits, .. } = &span.whole;
            let profile =
                Profile::fastest(*length, v_in, v_out, limits.v, limits.accelerate(), limits.brake());
            profiles.push(profile.unwrap_or_else(|| panic!("{v_in} to {v_out} in {span:?}")));
            start = span.behind;
        }
    }
    profiles
}

/// Place at which a released span must be cut, if its end may still get a higher speed: where its braking
/// begins, or after the blocks that are released in any case.
fn cut(parts: &[Span], ring: &[Block], entries: &[f64], batch: usize) -> Option<usize> {
    let start = parts[0].first;
    let mut v_in = entries[start];
    let mut firm = true;
    for span in parts {
        let next = ring.get(span.behind - start);
        firm &= next.is_some_and(|next| entries[span.behind] >= next.v_start * (1.0 - 1e-7));
        let v_out = leave(&span.whole, v_in, entries[span.behind]);
        if !firm && span.first < batch && span.behind - span.first > 1 {
            let Block { length, limits, .. } = &span.whole;
            let law = Profile::fastest(*length, v_in, v_out, limits.v, limits.accelerate(), limits.brake())?;
            let brakes_at = length - law.fall.distance;
            let mut place = None;
            let mut at = 0.0;
            for number in span.first..span.behind {
                let may = number > span.first && number >= batch;
                if may && (place.is_none() || at <= brakes_at) {
                    place = Some(number);
                }
                at += ring[number - start].length;
            }
            if place.is_some() {
                return place;
            }
        }
        v_in = v_out;
    }
    None
}

/// Raises the speeds at the starts of spans as far as a stop at the end of the last span stays possible. The
/// speed of the first span is decided.
///
/// With zero acceleration at both ends, braking by less may take longer. From v to w the distance is
/// proportional to (v + w)·√(v - w) if the highest acceleration is not reached, which grows with w up to v/3.
/// So a start speed that was possible with a lower end speed may not be found from the higher end speed,
/// although it stays possible.
fn raise(entries: &mut [f64], parts: &[Span]) {
    for Span { first, behind, whole } in parts.iter().skip(1).rev() {
        let highest = reach(whole.length, entries[*behind], whole.v_start, whole.limits.brake().reversed());
        entries[*first] = highest.max(entries[*first]);
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

/// The speed profiles for the speeds and durations of a plan: ramps from the limits, and the rest of the
/// duration at the highest speed.
pub fn laws(blocks: &[Block], contour: &Contour, planned: &[PlannedBlock]) -> Vec<Profile> {
    let mut next = 0;
    let law = |planned: &PlannedBlock| {
        let speed = |v: Speed| v.to_bits() as f64 * SPEED;
        let mut limits = blocks[next].limits;
        let mut left = planned.blocks as usize;
        while left > 0 {
            limits = limits.with(&blocks[next].limits);
            left -= contour.elements[next].blocks;
            next += 1;
        }
        let (v_in, v_peak, v_out) = (speed(planned.v_in), speed(planned.v_peak), speed(planned.v_out));
        let rise = Change::new(v_in, v_peak, limits.accelerate());
        let fall = Change::new(v_out, v_peak, limits.brake().reversed());
        let time = planned.time.to_bits() as f64 / 2f64.powi(36);
        let length = planned.length.to_bits() as f64 / 2f64.powi(44);
        Profile { v_in, v_peak, v_out, length, cruise: time - rise.time() - fall.time(), rise, fall }
    };
    planned.iter().map(law).collect()
}
