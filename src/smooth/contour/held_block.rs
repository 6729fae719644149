//! A block that is held back until the next block is known, because the corner between both may shorten it.
//! Also the short blocks behind it that are left out of the path.
use super::curve::{Main, aside, direction, foot, plus, size, space_per_path};
use super::{Data, Form, LSB_32, Parameters, ProgrammedBlock, Smoothed};
use crate::dynamics::{Dynamics, Known};
use crate::math::float::{max, min, to_f32};
use crate::nc::ContourMethod;
use crate::path::{Element, End, Measure, PathError, Straight, arc_to, line_to, straight_line};
use crate::quantity::{DISTANCE_LSB, Distance, Position};
use core::num::NonZeroI64;

/// A block that waits for the next block, because the corner between both may shorten it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeldBlock<const AXES: usize> {
    pub block: ProgrammedBlock<AXES>,
    /// Path length as programmed, LSB 2^-44 mm.
    pub length: i64,
    /// How the end of the block is rounded; `None`: it stays sharp.
    pub rule: Option<Parameters>,
    /// Largest deviation of the contour from the line that replaces it.
    pub stray: Stray,
    /// Length of the block before this block, if the corner between both is rounded, LSB 2^-44 mm.
    pub previous: Option<NonZeroI64>,
    /// Limits of the block, kept from the first corner of the block until the block becomes another line or
    /// arc.
    pub known: Option<Known>,
}

/// Consecutive short blocks that are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Skipped<const AXES: usize> {
    /// End of the blocks.
    pub to: [Position; AXES],
    /// Data of the last block.
    pub data: Data,
    /// Largest deviation of the blocks from the straight line over them.
    pub stray: Stray,
    /// Largest distance of the blocks from the start of that line, mm.
    pub radius: f32,
    /// Whether the sequence of left-out blocks is complete. The line over them is then the block after the
    /// corner.
    pub over: bool,
}

/// Deviation of blocks from a line that replaces them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stray {
    /// Deviation in space, mm.
    pub path: f32,
    /// Deviation of each other axis at the place of the line that is nearest in space, mm or degrees.
    pub track: f32,
}

impl Stray {
    /// No deviation.
    pub const NONE: Self = Self { path: 0.0, track: 0.0 };

    /// Deviation of a point from the line to `end`. Both vectors count from the start of the line.
    fn of<const AXES: usize>(main: &Main, end: &[f32; AXES], point: &[f32; AXES]) -> Self {
        let off = plus(point, -foot(main, end, point), end);
        Self { path: size(main, &off), track: aside(main, &off) }
    }

    /// The sum of both deviations.
    pub fn and(self, other: Self) -> Self {
        Self { path: self.path + other.path, track: self.track + other.track }
    }

    /// The larger value of each deviation.
    pub fn or(self, other: Self) -> Self {
        Self { path: max(self.path, other.path), track: max(self.track, other.track) }
    }

    pub fn is_within(&self, most: Self) -> bool {
        self.path <= most.path && self.track <= most.track
    }
}

/// A line that replaces several blocks.
pub(super) struct Standing {
    /// Whether the line begins at the start of the block held back, not at its end.
    pub whole: bool,
    /// Largest deviation of the blocks from the line.
    pub stray: Stray,
}

/// A line replaces left-out blocks and the next block, if the next block is shorter than 16 µm. A block
/// shorter than 16 µm before a corner is joined to the block after it.
const SYSTEM_LEAST: f32 = 0.016;

/// Limits for merging two blocks. First and second: distance of their corner from the line over both, LSB
/// 2^-32 mm, and the same in mm. Third: change of direction, LSB 2^-40. Fourth: distance of many merged
/// blocks from their line, mm.
const STRAIGHT: f64 = 4096.0;
const STRAIGHT_MM: f32 = 4096.0 * LSB_32;
const TURN: i64 = 1 << 20;
const MERGED_STRAY: f32 = 64.0 * STRAIGHT_MM;

/// Largest duration of a line over several blocks, ticks.
pub(super) const LONGEST_TICKS: f32 = (1 << 25) as f32;

/// The vector from one point to another, mm.
pub(super) fn travel<const AXES: usize>(from: &[Position; AXES], to: &[Position; AXES]) -> [f32; AXES] {
    let mut travel = [0.0; AXES];
    for (travel, (from, to)) in travel.iter_mut().zip(from.iter().zip(to)) {
        *travel = to_f32(to.to_bits().saturating_sub(from.to_bits())) * LSB_32;
    }
    travel
}

impl<const AXES: usize> HeldBlock<AXES> {
    /// A line that is not made yet.
    pub const BLANK: Self = Self {
        block: ProgrammedBlock {
            element: Element::BLANK,
            from: [Position::ZERO; AXES],
            to: [Position::ZERO; AXES],
            form: Form::Line,
            data: Data::BLANK,
        },
        length: 0,
        rule: None,
        stray: Stray::NONE,
        previous: None,
        known: None,
    };

    /// The block as programmed, with no corner.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn new(block: &ProgrammedBlock<AXES>) -> Self {
        Self {
            block: *block,
            length: block.element.shape.length.to_bits(),
            rule: None,
            stray: Stray::NONE,
            previous: None,
            known: None,
        }
    }

    /// Computes the limits of the block.
    pub fn look_up(&mut self, dynamics: &Dynamics<AXES>) {
        if self.known.as_ref().and_then(|known| dynamics.recall(known)).is_none() {
            self.known = Some(dynamics.known(&self.block.element, self.block.data.feed));
        }
    }

    /// Makes the block a line that begins at `from`.
    pub fn become_line(&mut self, from: &[Position; AXES], line: &Straight<AXES>) {
        let ProgrammedBlock { element, from: begin, form, .. } = &mut self.block;
        if element.circle.is_some() {
            *element = line.element();
        } else {
            line.assign_to(element);
        }
        (*begin, *form) = (*from, Form::Line);
        self.known = None;
    }

    /// Whether the distance between two points is below RELEVANT_PATH for the main axes and below
    /// RELEVANT_TRACK for all other axes.
    fn is_irrelevant(from: &[Position; AXES], to: &[Position; AXES], rule: &Parameters, main: &Main) -> bool {
        let travel = travel(from, to);
        let [path, track] = rule.relevant();
        size(main, &travel) <= path && aside(main, &travel) <= track
    }

    /// The distance in space of a path length of a block, mm.
    fn in_space(element: &Element<AXES>, length: i64, measure: &Measure) -> f32 {
        to_f32(length) * DISTANCE_LSB * space_per_path(measure, &direction(&element.entry))
    }

    /// Returns the blocks left out, including those in `before`, if the next block is left out too. The next block is
    /// left out if it is short and ends near the end of this block. The straight line over these blocks may use only
    /// a part of the tolerance; the corner curve has the rest.
    pub fn leave_out(
        &self,
        before: Option<&Skipped<AXES>>,
        Self { block: next, stray: own, .. }: &Self,
        rule: &Parameters,
        measure: &Measure,
    ) -> Option<Skipped<AXES>> {
        let main = &measure.main;
        let length = Self::in_space(&next.element, next.element.shape.length.to_bits(), measure);
        let arc = next.form != Form::Line;
        let short = !arc || length <= rule.relevant()[0];
        if rule.method == ContourMethod::Pos
            || !short
            || !Self::is_irrelevant(&next.from, &next.to, rule, main)
            || !Self::is_irrelevant(&self.block.to, &next.to, rule, main)
        {
            return None;
        }
        // The distance of an arc from its chord is at most half the arc's length.
        let bent = if arc { 0.5 * length } else { 0.0 };
        let turned = if arc { aside(main, &travel(&next.from, &next.to)) } else { 0.0 };
        let over = travel(&self.block.to, &next.to);
        let radius = max(size(main, &over), before.map_or(0.0, |skipped| skipped.radius)) + bent;
        let before = before.map_or(Stray::NONE, |skipped| {
            skipped.stray.and(Stray::of(main, &over, &travel(&self.block.to, &skipped.to)))
        });
        let stray = before.or(Stray { path: bent, track: turned }).or(*own);
        let stray = Stray { path: min(stray.path, radius), ..stray };
        let skipped = Skipped { to: next.to, data: next.data, stray, radius, over: false };
        stray.is_within(rule.stray()).then_some(skipped)
    }

    /// Whether one line replaces the held block or the left-out blocks, together with the next block. This is
    /// so if this block is too short to begin a curve, or the next block is too short to end a curve. A short
    /// block is short in space and along every other axis.
    pub fn stands(
        &self,
        skipped: Option<&Skipped<AXES>>,
        next: &Self,
        rule: &Parameters,
        measure: &Measure,
    ) -> Option<Standing> {
        let (main, to) = (&measure.main, &next.block.to);
        let [path, track] = rule.relevant();
        let is_short = |held: &Self, path: f32| {
            let ProgrammedBlock { element, from, to, .. } = &held.block;
            Self::in_space(element, held.length, measure) <= path && aside(main, &travel(from, to)) <= track
        };
        // If a curve ends inside this block, the block keeps its direction.
        let entered = self.block.element.shape.length.to_bits() < self.length;
        let lines = next.is_line() && self.is_line() && !entered;
        // Only with DEV does RELEVANT_PATH apply to both neighbours of a corner.
        let least = if rule.method == ContourMethod::Dev { path } else { min(path, SYSTEM_LEAST) };
        let whole = lines && rule.method != ContourMethod::Pos && is_short(self, least);
        let standing = match skipped {
            _ if whole => {
                let over = travel(&self.block.from, to);
                let off = |point: &[Position; AXES]| Stray::of(main, &over, &travel(&self.block.from, point));
                let behind = skipped.map_or(next.stray, |skipped| skipped.stray.and(off(&skipped.to)));
                Standing { whole, stray: self.stray.or(behind).and(off(&self.block.to)) }
            }
            Some(skipped) if is_short(next, SYSTEM_LEAST) => {
                let over = travel(&self.block.to, to);
                let off = Stray::of(main, &over, &travel(&self.block.to, &skipped.to));
                Standing { whole, stray: skipped.stray.and(off) }
            }
            _ => return None,
        };
        standing.stray.is_within(rule.stray()).then_some(standing)
    }

    /// PTP: extends the block to a line over itself and the next block, if the next block continues straight
    /// with the same feed. Returns whether the line is extended.
    ///
    /// MERGE applies to tangential transitions. With PTP there are only transitions between lines, because an
    /// arc switches PTP off.
    pub fn merge(&mut self, next: &Self, dynamics: &Dynamics<AXES>, measure: &Measure) -> bool {
        let (block, data) = (&next.block, &next.block.data);
        if self.rule.as_ref().is_none_or(|rule| rule.method != ContourMethod::Ptp || !rule.merge)
            || !(self.is_line() && next.is_line())
            || self.block.data.feed != data.feed
        {
            return false;
        }
        let Ok(Some(line)) = straight_line(&self.block.from, &block.to, measure) else { return false };
        let [first, both] = [self.block.element.shape.length, line.length()].map(Distance::to_bits);
        let part = first as f64 / both as f64;
        let ways = self.block.from.iter().zip(&self.block.to).zip(&block.to);
        let on_it = ways.fold(true, |on_it, ((from, corner), to)| {
            let [way, all] = [corner, to].map(|x| x.to_bits().saturating_sub(from.to_bits()) as f64);
            let off = way - part * all;
            on_it && -STRAIGHT < off && off < STRAIGHT
        });
        let tangents = self.block.element.entry.tangent.iter().zip(line.tangent());
        let turns = tangents.fold(0, |most: i64, (a, b)| most.max((a - b).abs()));
        // The merged line takes at most the longest duration of one block.
        let in_time =
            to_f32(both) * DISTANCE_LSB < dynamics.line(line.tangent(), data.feed).0.v * LONGEST_TICKS;
        let stray = self.stray.or(next.stray).and(Stray { path: STRAIGHT_MM, track: STRAIGHT_MM });
        if !on_it
            || turns > TURN
            || both <= first.max(next.length)
            || !in_time
            || max(stray.path, stray.track) > MERGED_STRAY
        {
            return false;
        }
        line.assign_to(&mut self.block.element);
        (self.block.to, self.block.data) = (block.to, *data);
        (self.length, self.stray) = (self.length.saturating_add(next.length), stray);
        (self.rule, self.previous) = (next.rule, next.previous);
        self.known = None;
        true
    }

    /// Whether the next block must be known first: it decides how much of this block the corner before may
    /// take, or it may extend this block.
    pub fn waits(&self) -> bool {
        self.rule.as_ref().is_some_and(|rule| rule.weighs() || self.is_line() && rule.chords().is_some())
    }

    /// Whether no corner has cut the block yet.
    pub fn is_untouched(&self) -> bool {
        let whole = self.block.element.shape.length.to_bits() == self.length;
        whole && self.previous.is_none()
    }

    /// Whether the block is straight.
    pub fn is_line(&self) -> bool {
        self.block.form == Form::Line
    }

    /// Whether the block is rapid motion.
    pub fn is_rapid(&self) -> bool {
        self.block.data.feed.is_none()
    }

    /// The rest of the block, to be emitted.
    pub fn smoothed(&self) -> Smoothed<'_, AXES> {
        let ProgrammedBlock { element, data, .. } = &self.block;
        Smoothed { element, end: None, data, curving: None, due: data.number, known: self.known.as_ref() }
    }

    /// Makes the line over the left-out blocks the next block, when their sequence is complete. The end is as
    /// programmed. The call writes the result to the blank block `next`. Returns whether there is a line.
    pub fn behind(&mut self, skipped: &Skipped<AXES>, measure: &Measure, next: &mut Self) -> bool {
        let &Skipped { to, data, stray, .. } = skipped;
        let from = self.block.to;
        if line_to([&from, &to], measure, &mut next.block.element) != Ok(true) {
            // The left-out blocks end at their start.
            self.rule = None;
            self.block.data.stop |= data.stop;
            return false;
        }
        (next.block.from, next.block.to, next.block.data) = (from, to, data);
        (next.length, next.stray) = (next.block.element.shape.length.to_bits(), stray);
        true
    }

    /// Direction and curvature at the point `from` of the block, where the rest of the block begins.
    pub fn entry_at(&self, from: &[Position; AXES], measure: &Measure) -> Result<End<AXES>, PathError> {
        if *from == self.block.from {
            return Ok(self.block.element.entry);
        }
        match self.block.form {
            Form::Line => Ok(self.block.element.entry),
            Form::Arc { .. } => self.entry_of_arc(from, measure),
        }
    }

    /// Reduces the block to its rest from a point on it, `cut` (LSB 2^-44 mm) after its start.
    pub fn renew(&mut self, from: &[Position; AXES], cut: i64, measure: &Measure) -> Result<(), PathError> {
        if *from == self.block.from {
            return Ok(());
        }
        match self.block.form {
            Form::Line => self.block.element.shorten(cut, from, &self.block.to),
            Form::Arc { .. } => {
                let ProgrammedBlock { element, to, form, .. } = &mut self.block;
                rest_of_arc([from, to], form, measure, element)?;
                self.known = None;
            }
        }
        self.block.from = *from;
        Ok(())
    }

    #[inline(never)]
    fn entry_of_arc(&self, from: &[Position; AXES], measure: &Measure) -> Result<End<AXES>, PathError> {
        let mut element = Element::BLANK;
        rest_of_arc([from, &self.block.to], &self.block.form, measure, &mut element)?;
        Ok(element.entry)
    }
}

/// An arc of this form between two points, in place of an element. The arc keeps the limits of the original
/// arc, so that earlier comparisons stay valid.
#[inline(never)]
fn rest_of_arc<const AXES: usize>(
    ends: [&[Position; AXES]; 2],
    form: &Form,
    measure: &Measure,
    element: &mut Element<AXES>,
) -> Result<(), PathError> {
    let Form::Arc { centre, plane, clockwise } = *form else { return Ok(()) };
    let whole = element.circle;
    arc_to(ends, (centre, plane, clockwise), measure, element)?;
    if let (Some(circle), Some(whole)) = (&mut element.circle, whole) {
        circle.turn = whole.turn;
    }
    Ok(())
}
