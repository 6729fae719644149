//! A block at the end of the ring: the speed of the transition before it, what that leaves to the limits on
//! both sides, and whether acceleration may pass it.
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

/// What the next transition needs to know of the last block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Last<const AXES: usize> {
    pub exit: End<AXES>,
    pub length: f32,
    pub share: Share,
    pub rapid: bool,
    /// Whether its limits have left a transition its part.
    pub shared: bool,
    pub slope: SlopeType,
    /// Whether its path is time, not length.
    pub timed: bool,
    /// Whether it is a part of a curve over arc length.
    pub bent: bool,
    /// Acceleration passes both its ends.
    pub through: bool,
    /// Acceleration inside it is bought with speed.
    pub trades: bool,
    /// Whether it is a part of a curve of many elements.
    pub flows: bool,
    /// End of the last block that is not brief.
    pub behind: End<AXES>,
}

impl<const AXES: usize> Last<AXES> {
    /// None yet.
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
        behind: End::BLANK,
    };

    /// Whether it may take less than two ticks between a knee and a standstill though its speed at the knee is
    /// low: what its neighbours do then shows together with the knee. From a speed that is a third of its length
    /// per tick at most it goes a third of it in two ticks, and a quarter of its jerk. STEP has its own rules.
    #[cfg_attr(feature = "fast", inline(always))]
    fn is_hasty(&self, limits: &Limits) -> bool {
        self.slope != SlopeType::Step && self.length < 0.4 * limits.steepest()
    }
}

/// Longest span: 2^18 mm, LSB 2^-44 mm.
const LONGEST_SPAN: i64 = 1 << 62;

/// An acceleration so many times the speed, per tick: `TURN_PART / SMOOTH` of `dynamics`.
const STEEP: f32 = 1000.0;

/// From that part of its feed on, a part of a curve has its acceleration for less speed.
const BOUGHT: f32 = 0.89;

/// A block that comes in.
struct Next<'a, const AXES: usize> {
    piece: &'a Piece<'a, AXES>,
    /// mm.
    length: f32,
    /// Its speed at 100 %, or at the level if that is higher.
    full: f32,
    rapid: bool,
    /// Its feed, mm/min.
    feed: f32,
    /// Nearly at its feed, acceleration inside it is bought with speed.
    bought: bool,
    share: Share,
    /// The block before is shorter than a tick takes.
    after_brief: bool,
}

/// Mean acceleration over a length at the speed `v`, mm/tick², where it is zero at both ends.
fn alone(limits: &Limits, length: f32, v: f32) -> f32 {
    let (a, j) = (limits.a_up, limits.jerk(0));
    // In units of the speed: j·t/4, or a − a²/(j·t) where a is reached.
    let gain = j * length;
    if gain < 2.0 * a * v { 0.25 * gain / v } else { a - a * a * v / gain }
}

/// The transition to a block that comes in.
struct Transition {
    /// Speed of the motion there, at most.
    cap: f32,
    /// Speed there, at most, whatever the speeds of both blocks: their feeds may rise with the override.
    highest: f32,
    /// It takes a part of the limits on both sides.
    shared: bool,
    /// So much of a deceleration may pass it.
    passing: Passing,
    /// Acceleration is zero there.
    anchor: bool,
}

impl Transition {
    /// The motion stands still.
    const STANDSTILL: Self =
        Self { cap: 0.0, highest: 0.0, shared: false, passing: Passing::NONE, anchor: true };
}

impl<const AXES: usize> Next<'_, AXES> {
    /// Speed at which the transition from the last block may be passed; `None` where it shows nothing at the
    /// speed `fastest`. `a`: acceleration of STEP that acts beside it.
    #[cfg_attr(feature = "fast", inline(always))]
    fn passed(&self, last: &Last<AXES>, fastest: f32, a: f32, dynamics: &Dynamics<AXES>) -> Option<f32> {
        let (entry, rapid) = (self.piece.entry, self.rapid && last.rapid);
        let shorter = min(last.length, self.length);
        let v = dynamics.transition(&last.exit, entry, rapid, shorter, (fastest, a));
        if !self.after_brief {
            return v;
        }
        // What changes at both its ends shows within a tick.
        let both = dynamics.bending(&last.behind, entry, rapid);
        if both < fastest { Some(min(both, v.unwrap_or(both))) } else { v }
    }

    /// Whether both are parts of a curve over time, for one speed.
    #[cfg_attr(feature = "fast", inline(always))]
    fn is_one_curve(&self, last: &Last<AXES>, before: &Limits, limits: &Limits) -> bool {
        self.piece.timed && last.timed && limits.v == before.v
    }

    /// What of the deceleration `a` passes the knee at its start. Both sides are planned with all of their acceleration:
    /// there it is zero at the knee.
    fn passing_knee(&self, last: &Last<AXES>, highest: f32, a: f32, dynamics: &Dynamics<AXES>) -> Passing {
        let (rapid, shorter) = (self.rapid && last.rapid, min(last.length, self.length));
        dynamics.passing_knee(&last.exit, self.piece.entry, rapid, shorter, (highest, a))
    }

    /// Whether the slope lets acceleration pass a transition to it, whatever that shows. `cap`: speed of the
    /// motion there; `v`: as in [`Self::passed`].
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
            // All of a span has its least acceleration: beside a curve with CONST_VEL zero at the joint costs
            // less.
            SlopeType::Hsc => limits.is_as_strong(before, self.piece.flows || last.flows),
            SlopeType::Trapez | SlopeType::Sin2 if self.is_one_curve(last, before, limits) => true,
            // Parts of one curve of many elements.
            SlopeType::Trapez | SlopeType::Sin2 if limits.varies() && before.varies() => {
                limits.is_as_strong(before, true)
            }
            // As if it were one block.
            SlopeType::Trapez | SlopeType::Sin2 => {
                limits.are(before) && v.is_none_or(|v| v >= cap && slight())
            }
            // Acceleration is zero nowhere.
            SlopeType::Step => false,
        }
    }
}

/// What of the deceleration `a` passes a transition beside arcs. With limits alike nothing binds it: both sides are one
/// law. A law that begins or ends with acceleration in an arc is bound by less than others are.
#[inline(always)]
fn passing_arcs([before, behind]: [&Share; 2], is_alike: impl FnOnce() -> bool, a: f32) -> Passing {
    // Asked first: most transitions have no arc beside them.
    if min(before.v, behind.v) == f32::MAX || is_alike() {
        return Passing::ALL;
    }
    Passing::of_part(min(before.passing, behind.passing), a)
}

impl<const AXES: usize> Tail<AXES> {
    /// Whether the next block goes on with the span of the last one. `sides`: limits before and behind; `cap`: speed
    /// at the transition.
    #[cfg_attr(feature = "fast", inline(always))]
    fn takes_in(&self, last: &Last<AXES>, next: &Next<'_, AXES>, sides: [&Limits; 2], cap: f32) -> bool {
        let ([before, limits], piece) = (sides, next.piece);
        // Beside a curve that takes most of the jerk, acceleration passes the transition only if that is more
        // than either side has with none at its ends.
        let passes = || {
            let run = to_f32(self.span) * (1.0 / (1u64 << 44) as f32);
            alone(before, run, cap) <= limits.a_up && alone(limits, next.length, cap) <= before.a_up
        };
        // Where acceleration is bought with speed, no law of its span may have a higher feed.
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

    /// A block with that feed (mm/min) comes in, behind an anchor or not.
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
    /// Appends a block. Only when not [`Self::is_full`]. `long`: it stands for several, and is longer than
    /// the way to a standstill from its speed.
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
        // Of the block at 100 % at least: its limits hold for a higher level too.
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
        self.counts.through += usize::from(!anchor);
        self.tail.pass(anchor, feed, bought);
        self.tail.span += distance;
        self.counts.spare = if limits.may_have_valleys() { self.depth / SPARE } else { 0 };
        self.tail.stop = false;
        self.tail.run_out.clear();
        if self.blocks.is_empty() {
            self.tail.slowest = Slowest::NONE;
        }
        self.tail.slowest.take(override_range, limits.v, self.level, self.depth);
        // What follows on nothing starts from rest.
        let mut v_in = Planned::NONE;
        if self.blocks.is_empty() {
            (v_in, self.start) = (Planned::ZERO, Speed::ZERO);
        }
        let before = core::mem::replace(&mut self.tail.known, Known::Block);
        let keeps = before == Known::Block && self.tail.row.is_brief();
        let Piece { timed, bent, trades, flows, through, .. } = *piece;
        // In place: as a whole it would be copied.
        let last = &mut self.tail.last;
        let End { tangent, curvature } = *piece.exit;
        (last.exit.tangent, last.exit.curvature) = (tangent, curvature);
        if !keeps {
            (last.behind.tangent, last.behind.curvature) = (tangent, curvature);
        }
        (last.length, last.share, last.rapid, last.shared) = (length, share, rapid, shared);
        (last.slope, last.timed, last.bent) = (slope, timed, bent);
        (last.trades, last.flows, last.through) = (trades, flows, through);
        let mut marks = Marks::default();
        marks.set(Marks::ANCHOR, anchor);
        marks.set(Marks::SMOOTH, passing != Passing::NONE);
        marks.set(Marks::GATE, gate);
        marks.set(Marks::LONG, long);
        self.counts.long += usize::from(long);
        let hsc = slope == SlopeType::Hsc || limits.varies();
        let (numbers, law) = limits.kept();
        // There is room: the caller asked.
        let _ = self.blocks.push_back(Block {
            cap,
            highest,
            v_in,
            override_range,
            joint: AnchorMarks::new(!anchor && hsc, flows && hsc, [rapid, shared, bought]).passed(passing),
            marks,
            length: distance,
            numbers,
            kind: Kind::new(law, trades),
            v_reached: Planned::NONE,
            v_old: Planned::NONE,
        });
    }

    /// The transition from the last block of the ring. Where it takes its part of the limits, both sides have
    /// less.
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
        // No more than the double is known.
        let (mut cap, mut highest, mut shared) = (fastest, 2.0 * fastest, false);
        let a = if slope == SlopeType::Step { max(limits.most(), kept.most()) } else { 0.0 };
        let arc = min(last.share.v, next.share.v);
        let v = next.passed(last, fastest, a, dynamics).map(|v| min(v, arc));
        // STEP: what passes within a tick of a knee shows together with it.
        let brief = last.length < full_before || next.length < next.full;
        let sides = [(&kept, &last.share, last.length), (&*limits, &next.share, next.length)];
        let way = match v {
            // The block before it has left nothing to a knee that shows together with its end.
            Some(_) if !last.shared && last.is_hasty(&kept) => Way::Standing,
            Some(v) if v < cap => quickest(sides, v, slope == SlopeType::Hsc),
            _ => Way::Through,
        };
        let mut shares = [last.share, next.share];
        if way == Way::Resting {
            shares = shares.map(Share::resting);
        }
        if way == Way::Standing {
            // But for rounding: no wait for a tick. The acceleration of STEP does not vanish beside it: that waits.
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
        // A transition that shows nothing at `fastest` turns little for accelerations up to a thousand times that.
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
