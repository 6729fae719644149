//! Appends a block to the ring of the look-ahead. For the transition from the block before, this file
//! decides:
//!
//! - the highest speed at the transition,
//! - which part of the limits the corner uses; the speed profiles of both blocks get only the rest,
//! - whether acceleration may be other than zero there.
use super::block::{AnchorMarks, Block, Kind, Marks};
use super::knees::{Between, Knee};
use super::pace::Slowest;
use super::planned::Planned;
use super::ring::{Known, Ring, Tail};
use super::valley::SPARE;
use super::worth::{Way, quickest};
use crate::dynamics::{Dynamics, Passing, Permitted, Share};
use crate::math::float::{max, min, to_f32};
use crate::nc::SlopeType;
use crate::path::{End, Piece};
use crate::quantity::Speed;
use crate::slope::limits::Limits;

/// Data of the last block for the next transition.
#[derive(Clone, Copy, Debug)]
pub(super) struct Last<const AXES: usize> {
    pub exit: End<AXES>,
    pub length: f32,
    pub share: Share,
    pub rapid: bool,
    /// Whether the transition at the end of the block has already reserved its part of the block's limits.
    pub shared: bool,
    pub slope: SlopeType,
    /// Whether the block is a part of a curve that is planned over time.
    pub timed: bool,
    /// Whether the block is a part of a curve over arc length.
    pub bent: bool,
    /// Whether acceleration passes both ends of the block.
    pub through: bool,
    /// Whether the limits of the block trade speed for acceleration: at a lower speed, acceleration is left
    /// inside the block.
    pub trades: bool,
    /// Whether the block is a part of a curve of many elements.
    pub flows: bool,
    /// Acceleration and deceleration of the block, mm/tick².
    pub strength: [f32; 2],
    /// End of the last block that is not brief (shorter than a tick).
    pub behind: End<AXES>,
}

impl<const AXES: usize> Last<AXES> {
    /// No block.
    pub(super) const BLANK: Self = Self {
        exit: End::BLANK,
        length: 0.0,
        share: Share::WHOLE,
        rapid: false,
        shared: false,
        slope: SlopeType::Step,
        timed: false,
        bent: false,
        through: false,
        trades: false,
        flows: false,
        strength: [0.0; 2],
        behind: End::BLANK,
    };

    /// Whether the next block permits clearly more or less acceleration than the last one: in one span, both
    /// would have the lower acceleration. Curves at corners have their own rules ([`Tail::takes_in`]).
    #[cfg_attr(feature = "fast", inline(always))]
    fn differs(&self, piece: &Piece<'_, AXES>, limits: &Limits) -> bool {
        let corner = self.timed || self.bent || self.through || piece.timed || piece.bent || piece.through;
        let part = match piece.flows || self.flows {
            true => WEAKER_IN_CURVE,
            false if corner => return false,
            false => WEAKER,
        };
        let differ = |a: f32, b: f32| min(a, b) < part * max(a, b);
        let [up, down] = self.strength;
        differ(up, limits.a_up) || differ(down, limits.a_down)
    }

    /// Whether the block may take less than two ticks between a knee (a corner without a curve) and a
    /// standstill. This is possible although the motion is slow at the knee. The changes of acceleration at
    /// its neighbours then add to the step of the knee. Let the speed at the knee be at most a third of the
    /// length per tick. In two ticks, the motion then covers at most a third of the length plus a quarter of
    /// the jerk. STEP has its own rules.
    #[cfg_attr(feature = "fast", inline(always))]
    fn is_hasty(&self, limits: &Limits) -> bool {
        self.slope != SlopeType::Step && self.length < 0.4 * limits.steepest()
    }
}

/// Longest span: 2^18 mm, LSB 2^-44 mm.
const LONGEST_SPAN: i64 = 1 << 62;

/// Ratio of acceleration to speed, 1/tick, above which an acceleration is steep: `TURN_PART / SMOOTH` of
/// `dynamics`.
const STEEP: f32 = 1000.0;

/// From this part of its feed on, the limits of a part of a curve trade speed for acceleration.
const BOUGHT: f32 = 0.89;

/// Below this part of its neighbour's acceleration, the acceleration of a block is clearly lower. In a curve
/// of many elements, accelerations vary from element to element. Measured with 400 random programs with
/// Surface, each with three tolerances and two feeds: with a third, they take 0.6 % less time, and none takes
/// 1 % more. With a half, they take 1.1 % less, but some take 4 % more.
const WEAKER_IN_CURVE: f32 = 1.0 / 3.0;
/// The same outside of such curves. Measured with 600 random rows of collinear lines with weights: with this
/// value, all are within 1 % of TRAPEZ. With 0.7 the worst takes 3 % longer, with 0.5 27 %.
const WEAKER: f32 = 0.85;

/// A new block.
struct Next<'a, const AXES: usize> {
    piece: &'a Piece<'a, AXES>,
    /// Length, mm.
    length: f32,
    /// Speed at 100 % override, or at the planned override if that is higher.
    full: f32,
    rapid: bool,
    /// Feed, mm/min.
    feed: f32,
    /// Whether the limits of the block trade speed for acceleration, at nearly its feed.
    bought: bool,
    share: Share,
    /// Whether the block before is shorter than a tick's motion.
    after_brief: bool,
}

/// Mean acceleration of a motion over a length (mm) up to the speed `v`, mm/tick², with zero acceleration at
/// both ends.
fn alone(limits: &Limits, length: f32, v: f32) -> f32 {
    let (a, j) = (limits.a_up, limits.jerk(0));
    // In units of the speed: j·t/4 if the acceleration stays below a, otherwise a − a²/(j·t).
    let gain = j * length;
    if gain < 2.0 * a * v { 0.25 * gain / v } else { a - a * a * v / gain }
}

/// The transition to a new block.
struct Transition {
    /// Highest speed of the motion at the transition.
    cap: f32,
    /// Highest speed at the transition for any feed of both blocks: feeds may rise with the override.
    highest: f32,
    /// Whether the transition reserves a part of the limits on both sides.
    shared: bool,
    /// The part of a deceleration that may pass the transition.
    passing: Passing,
    /// Whether acceleration is zero at the transition.
    anchor: bool,
}

impl Transition {
    /// A transition at which the motion stops.
    const STANDSTILL: Self =
        Self { cap: 0.0, highest: 0.0, shared: false, passing: Passing::NONE, anchor: true };
}

impl<const AXES: usize> Next<'_, AXES> {
    /// Speed at which the motion may pass the transition from the last block. Returns `None` if the
    /// transition has no effect at the speed `fastest`. `a`: acceleration of STEP near the transition.
    #[cfg_attr(feature = "fast", inline(always))]
    fn passed(&self, last: &Last<AXES>, fastest: f32, a: f32, dynamics: &Dynamics<AXES>) -> Option<f32> {
        let (entry, rapid) = (self.piece.entry, self.rapid && last.rapid);
        let shorter = min(last.length, self.length);
        let v = dynamics.transition(&last.exit, entry, rapid, shorter, (fastest, a));
        if !self.after_brief {
            return v;
        }
        // The changes at both ends of a brief block fall into one tick.
        let both = dynamics.bending(&last.behind, entry, rapid);
        if both < fastest { Some(min(both, v.unwrap_or(both))) } else { v }
    }

    /// Whether both blocks are parts of one curve over time that is planned for one speed.
    #[cfg_attr(feature = "fast", inline(always))]
    fn is_one_curve(&self, last: &Last<AXES>, before: &Limits, limits: &Limits) -> bool {
        self.piece.timed && last.timed && limits.v == before.v
    }

    /// The part of the deceleration `a` that may pass the knee (corner without a curve) at the block's start.
    /// Both sides are planned with their full acceleration, because the acceleration is zero at the knee.
    fn passing_knee(&self, last: &Last<AXES>, highest: f32, a: f32, dynamics: &Dynamics<AXES>) -> Passing {
        let (rapid, shorter) = (self.rapid && last.rapid, min(last.length, self.length));
        dynamics.passing_knee(&last.exit, self.piece.entry, rapid, shorter, (highest, a))
    }

    /// Whether the slope permits acceleration to pass the transition to this block. `cap`: speed of the
    /// motion at the transition; `v`: as in [`Self::passed`].
    #[cfg_attr(feature = "fast", inline(always))]
    fn goes_on(
        &self,
        last: &Last<AXES>,
        before: &Limits,
        limits: &Limits,
        (cap, v): (f32, Option<f32>),
        dynamics: &Dynamics<AXES>,
    ) -> bool {
        let rapid = self.rapid && last.rapid;
        let slight = || dynamics.is_slight(&last.exit, self.piece.entry, rapid, cap);
        match dynamics.slope() {
            SlopeType::Hsc => true,
            SlopeType::Trapez | SlopeType::Sin2 if self.is_one_curve(last, before, limits) => true,
            // Both blocks are parts of one curve of many elements.
            SlopeType::Trapez | SlopeType::Sin2 if limits.varies() && before.varies() => true,
            // Both blocks act as one block.
            SlopeType::Trapez | SlopeType::Sin2 => {
                limits.are(before) && v.is_none_or(|v| v >= cap && slight())
            }
            // STEP needs no place with zero acceleration.
            SlopeType::Step => false,
        }
    }
}

/// The part of the deceleration `a` that may pass a transition next to arcs. With equal limits on both sides,
/// all of it passes, because one profile covers both sides. Otherwise the limit is [`Share::passing`],
/// because another profile begins at the end of an arc.
#[inline(always)]
fn passing_arcs([before, behind]: [&Share; 2], is_alike: impl FnOnce() -> bool, a: f32) -> Passing {
    // Checked first, because most transitions are not next to an arc.
    if min(before.v, behind.v) == f32::MAX || is_alike() {
        return Passing::ALL;
    }
    Passing::of_part(min(before.passing, behind.passing), a)
}

impl<const AXES: usize> Tail<AXES> {
    /// Whether the next block continues the span of the last block. `sides`: limits before and after; `cap`: speed
    /// at the transition.
    #[cfg_attr(feature = "fast", inline(always))]
    fn takes_in(&self, last: &Last<AXES>, next: &Next<'_, AXES>, sides: [&Limits; 2], cap: f32) -> bool {
        let ([before, limits], piece) = (sides, next.piece);
        // A curve may use most of the jerk. Next to such a curve, acceleration passes only if this permits
        // more acceleration. The comparison is with each side alone, with zero acceleration at its ends.
        let passes = || {
            let run = to_f32(self.span) * (1.0 / (1u64 << 44) as f32);
            alone(before, run, cap) <= limits.a_up && alone(limits, next.length, cap) <= before.a_up
        };
        // If the limits of a block trade speed for acceleration, no profile of its span may have a higher
        // feed.
        let [bought_at, fastest_feed] = self.feeds;
        last.trades == piece.trades
            && (!piece.timed || next.is_one_curve(last, before, limits))
            && last.bent == piece.bent
            && (!piece.bent || limits.are(before))
            && (!(last.through || piece.through) || passes())
            && self.span + piece.length.to_bits() < LONGEST_SPAN
            && next.feed <= bought_at
            && (!next.bought || fastest_feed <= next.feed)
    }

    /// Adds a block with this feed (mm/min). `anchor`: whether the block begins at an anchor.
    #[cfg_attr(feature = "fast", inline(always))]
    fn pass(&mut self, anchor: bool, feed: f32, bought: bool) {
        if anchor {
            (self.span, self.feeds) = (0, [if bought { feed } else { f32::MAX }, feed]);
            return;
        }
        let [lowest, highest] = self.feeds;
        self.feeds = [if bought { min(lowest, feed) } else { lowest }, max(highest, feed)];
    }
}

impl<const AXES: usize, const BLOCKS: usize> Ring<'_, AXES, BLOCKS> {
    /// Appends a block. Call this function only if the ring is not full ([`Self::is_full`]). `long`: the
    /// block replaces several blocks, and is at least twice as long as a stop from its speed needs.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn push(
        &mut self,
        piece: &Piece<'_, AXES>,
        permitted: &Permitted,
        feed: Option<f32>,
        dynamics: &Dynamics<AXES>,
        long: bool,
    ) {
        let (mut limits, share, mut override_range) = *permitted;
        let distance = piece.length.to_bits();
        let length = to_f32(distance) * (1.0 / (1u64 << 44) as f32);
        let after_brief = self.tail.row.is_brief();
        // At least the speed at 100 %, because the limits also hold for a higher planned override.
        self.tail.row.take(length, (&mut limits.v, &mut override_range), max(self.level, 1.0), piece.timed);
        let full = limits.v;
        if self.level < 1.0 {
            limits.v *= override_range.raised(self.level);
        }
        let slope = dynamics.slope();
        let rapid = feed.is_none();
        let feed = feed.unwrap_or(f32::MAX);
        let bought = piece.flows && !rapid && override_range.parts()[1] >= BOUGHT;
        let next = Next { piece, length, full, rapid, feed, bought, share, after_brief };
        let Transition { cap, highest, shared, passing, mut anchor } =
            self.join(&next, &mut limits, dynamics);
        let gate = core::mem::take(&mut self.tail.gate);
        anchor |= gate;
        let hsc = slope == SlopeType::Hsc || limits.varies();
        let open = !anchor && hsc;
        let tried = open && self.tail.last.differs(piece, &limits);
        anchor |= tried;
        self.count(anchor, tried);
        self.tail.pass(anchor, feed, bought);
        self.tail.span += distance;
        self.counts.spare = if limits.may_have_valleys() { self.depth / SPARE } else { 0 };
        self.tail.stop = false;
        self.tail.run_out.clear();
        if self.blocks.is_empty() {
            self.tail.slowest = Slowest::NONE;
        }
        self.tail.slowest.take(override_range, limits.v, self.level, self.depth);
        // The first block of the ring starts at a stop.
        let mut v_in = Planned::NONE;
        if self.blocks.is_empty() {
            (v_in, self.start) = (Planned::ZERO, Speed::ZERO);
        }
        let before = core::mem::replace(&mut self.tail.known, Known::Block);
        let keeps = before == Known::Block && self.tail.row.is_brief();
        let Piece { timed, bent, trades, flows, through, .. } = *piece;
        // A reference, because the struct would be copied as a whole.
        let last = &mut self.tail.last;
        let End { tangent, curvature } = *piece.exit;
        (last.exit.tangent, last.exit.curvature) = (tangent, curvature);
        if !keeps {
            (last.behind.tangent, last.behind.curvature) = (tangent, curvature);
        }
        (last.length, last.share, last.rapid, last.shared) = (length, share, rapid, shared);
        (last.slope, last.timed, last.bent) = (slope, timed, bent);
        (last.trades, last.flows, last.through) = (trades, flows, through);
        last.strength = [limits.a_up, limits.a_down];
        let marks = Marks::of([anchor, tried, passing != Passing::NONE, gate, long]);
        self.counts.long += usize::from(long);
        let (numbers, law) = limits.kept();
        // There is room: the caller has checked.
        let _ = self.blocks.push_back(Block {
            cap,
            highest,
            v_in,
            override_range,
            joint: AnchorMarks::new(open, flows && hsc, [rapid, shared, bought]).passed(passing),
            marks,
            length: distance,
            numbers,
            kind: Kind::new(law, trades),
            v_reached: Planned::NONE,
            v_old: Planned::NONE,
        });
    }

    /// Counts the transition to a new block, and whether it is an anchor. `tried`: a trial may remove the
    /// anchor, if one profile for both sides is faster.
    fn count(&mut self, anchor: bool, tried: bool) {
        self.counts.untried += usize::from(tried);
        self.counts.through += usize::from(!anchor);
    }

    /// Plans the transition from the last block of the ring. If the transition reserves its part of the
    /// limits, both blocks keep only the rest.
    #[cfg_attr(feature = "fast", inline(always))]
    fn join(&mut self, next: &Next<'_, AXES>, limits: &mut Limits, dynamics: &Dynamics<AXES>) -> Transition {
        let known = self.tail.known == Known::Block && !self.tail.stop;
        let Some(before) = self.blocks.back_mut().filter(|_| known) else {
            self.tail.steps.clear();
            return Transition::STANDSTILL;
        };
        let (last, mut kept) = (&self.tail.last, before.limits());
        let (slope, piece, rapid) = (dynamics.slope(), next.piece, next.rapid && last.rapid);
        let full_before = before.full(self.level);
        let fastest = min(full_before, next.full);
        // Values above twice the speed are not computed.
        let (mut cap, mut highest, mut shared) = (fastest, 2.0 * fastest, false);
        let a = if slope == SlopeType::Step { max(limits.most(), kept.most()) } else { 0.0 };
        let arc = min(last.share.v, next.share.v);
        let v = next.passed(last, fastest, a, dynamics).map(|v| min(v, arc));
        // STEP: all steps within a tick of a knee add to the knee.
        let brief = last.length < full_before || next.length < next.full;
        let sides = [(&kept, &last.share, last.length), (&*limits, &next.share, next.length)];
        let way = match v {
            // The block before reserved nothing for a knee, but its end adds to this knee.
            Some(_) if !last.shared && last.is_hasty(&kept) => Way::Standing,
            Some(v) if v < cap => quickest(sides, v, slope == SlopeType::Hsc),
            _ => Way::Through,
        };
        let mut shares = [last.share, next.share];
        if way == Way::Resting {
            shares = shares.map(Share::resting);
        }
        if way == Way::Standing {
            // If the knee is only rounding of coordinates, the motion need not stop there. With STEP,
            // acceleration is not zero near the transition, so the motion stops.
            let unseen = || min(dynamics.unseen(&last.exit, piece.entry, rapid), v.unwrap_or(f32::MAX));
            cap = if slope == SlopeType::Step { 0.0 } else { min(cap, unseen()) };
            highest = cap;
        } else if v.is_some() || (brief && slope == SlopeType::Step) {
            if let Some(v) = v {
                cap = min(cap, v);
                highest = min(highest, v);
            }
            limits.share(&shares[1]);
            shared = true;
            if !last.shared {
                kept.share(&shares[0]);
                before.lower(&kept);
            }
        }
        if !shared && last.shared && last.is_hasty(&kept) {
            limits.share(&next.share);
            shared = true;
        }
        let mut between = Between { last, block: before, full: full_before, level: self.level };
        let knee = Knee { entry: piece.entry, rapid, room: next.length, full: next.full };
        highest = self.tail.steps.beside(&mut between, &knee, highest, dynamics);
        kept.v = before.v();
        cap = min(cap, highest);
        let through = next.goes_on(last, &kept, limits, (cap, v), dynamics);
        // A transition without effect at `fastest` permits accelerations up to a thousand times that speed.
        let a = limits.fastest(&kept);
        let turns_little = || {
            (v.is_none() && a <= STEEP * fastest) || dynamics.turns_little(&last.exit, piece.entry, rapid, a)
        };
        let smooth =
            way == Way::Through && last.slope == slope && (slope == SlopeType::Step || turns_little());
        let arc_passes = passing_arcs([&last.share, &next.share], || !shared && limits.are(&kept), a);
        let knee_passes = match v {
            _ if !smooth => Passing::NONE,
            Some(_) if matches!(slope, SlopeType::Trapez | SlopeType::Sin2) => {
                next.passing_knee(last, highest, a, dynamics)
            }
            _ => Passing::ALL,
        };
        let passing = knee_passes.least(arc_passes);
        let anchor = !(through
            && passing != Passing::NONE
            && arc_passes == Passing::ALL
            && self.tail.takes_in(last, next, [&kept, limits], cap));
        cap = min(cap, min(kept.v, limits.v));
        Transition { cap, highest, shared, passing, anchor }
    }
}
