//! A block at the end of the ring: the speed of the transition before it, what that leaves to the limits on both sides, and whether
//! acceleration may pass it.
use super::block::{Block, Joint, Marks, UNPLANNED};
use super::dip::SPARE;
use super::pace::Slowest;
use super::ring::Ring;
use super::worth::{Way, is_corner, quickest};
use crate::dynamics::{Dynamics, Permitted, Share};
use crate::math::float::{max, min, to_f32};
use crate::nc::SlopeType;
use crate::path::{End, Piece};
use crate::quantity::Speed;

/// What the next transition needs to know of the last block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Last<const AXES: usize> {
    pub exit: End<AXES>,
    pub length: f32,
    pub share: Share,
    pub rapid: bool,
    /// Its limits have left a transition its part.
    pub shared: bool,
    pub slope: SlopeType,
    /// Its path is time.
    pub timed: bool,
    /// It is a part of a curve over arc length.
    pub bent: bool,
    /// Acceleration inside it is bought with speed.
    pub trades: bool,
    /// Where the last one ends that is not brief.
    pub behind: End<AXES>,
}

/// Longest span: 2^18 mm, LSB 2^-44 mm.
const LONGEST_SPAN: i64 = 1 << 62;

/// An acceleration so many times the speed, per tick: `TURN_PART / SMOOTH` of `dynamics`.
const STEEP: f32 = 1000.0;

impl<const AXES: usize, const BLOCKS: usize> Ring<'_, AXES, BLOCKS> {
    /// Appends a block. Only when not [`Self::is_full`]. `long`: it stands for several, and is longer than the way to a
    /// standstill from its speed.
    #[inline(always)]
    pub(crate) fn push(
        &mut self,
        element: &Piece<'_, AXES>,
        permitted: &Permitted,
        rapid: bool,
        dynamics: &Dynamics<AXES>,
        long: bool,
    ) {
        let (mut limits, share, mut headroom) = *permitted;
        let distance = element.shape.length.to_bits();
        let length = to_f32(distance) * (1.0 / (1u64 << 44) as f32);
        let (timed, bent) = (element.timed, element.bent);
        let after_brief = self.tail.row.is_brief();
        // Of the block at 100 % at least: its limits hold for a higher level too.
        self.tail.row.take(length, (&mut limits.v, &mut headroom), max(self.level, 1.0), timed);
        let full = limits.v;
        if self.level < 1.0 {
            limits.v *= headroom.raised(self.level);
        }
        let mut cap = 0.0;
        let mut highest = 0.0;
        let mut shared = false;
        let mut smooth = false;
        let mut anchor = true;
        let slope = dynamics.slope();
        if let (Some(last), Some(before), false) = (&self.tail.last, self.blocks.back_mut(), self.tail.stop) {
            let full_before = before.full(self.level);
            cap = min(full_before, full);
            // No more than the double is known.
            highest = 2.0 * cap;
            let rapid = rapid && last.rapid;
            let shorter = min(last.length, length);
            let a = if slope == SlopeType::Step { max(limits.most(), before.limits.most()) } else { 0.0 };
            let mut v = dynamics.transition(&last.exit, element.entry, rapid, shorter, (cap, a));
            if after_brief {
                // What changes at both its ends shows within a tick.
                let both = dynamics.bending(&last.behind, element.entry, rapid);
                v = if both < cap { Some(min(both, v.unwrap_or(both))) } else { v };
            }
            // STEP: what passes within a tick of a knee shows together with it.
            let brief = last.length < full_before || length < full;
            let sides = [(&before.limits, &last.share, last.length), (&limits, &share, length)];
            let way = match v {
                Some(v) if v < cap && is_corner(&last.exit, element.entry) => {
                    quickest(sides, v, slope == SlopeType::Hsc)
                }
                _ => Way::Through,
            };
            let mut shares = [last.share, share];
            if way == Way::Resting {
                shares = shares.map(Share::resting);
            }
            if way == Way::Standing {
                // But for rounding, so that it need not wait for a tick. The acceleration of STEP does not vanish beside it: it waits.
                let unseen = || dynamics.unseen(&last.exit, element.entry, rapid);
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
                    before.limits.share(&shares[0]);
                }
            }
            // Both are parts of a curve over time, for one speed.
            let one_curve = timed && last.timed && limits.v == before.limits.v;
            let through = match slope {
                // All of a span has its least acceleration: beside a curve with CONST_VEL zero at the joint costs less.
                SlopeType::Hsc => limits.is_as_strong(&before.limits),
                SlopeType::Trapez | SlopeType::Sin2 if one_curve => true,
                // As if it were one block.
                SlopeType::Trapez | SlopeType::Sin2 => {
                    limits.are(&before.limits)
                        && v.is_none_or(|v| {
                            v >= cap && dynamics.is_slight(&last.exit, element.entry, rapid, cap)
                        })
                }
                // Acceleration is zero nowhere.
                SlopeType::Step => false,
            };
            // A transition that shows nothing at the speed `fastest` turns little for accelerations up to a thousand times that.
            let (fastest, a) = (min(full_before, full), limits.fastest(&before.limits));
            let turns_little = || {
                (v.is_none() && a <= STEEP * fastest)
                    || dynamics.turns_little(&last.exit, element.entry, rapid, a)
            };
            smooth =
                way == Way::Through && last.slope == slope && (slope == SlopeType::Step || turns_little());
            anchor = !(through
                && smooth
                && last.trades == element.trades
                && (!timed || one_curve)
                && last.bent == bent
                && (!bent || limits.are(&before.limits))
                && self.tail.span + distance < LONGEST_SPAN);
            cap = min(cap, min(before.limits.v, limits.v));
        }
        let gate = core::mem::take(&mut self.tail.gate);
        anchor |= gate;
        if anchor {
            self.tail.span = 0;
        } else {
            self.counts.through += 1;
        }
        self.tail.span += distance;
        self.counts.spare = if limits.may_dip() { self.depth / SPARE } else { 0 };
        self.tail.stop = false;
        if self.blocks.is_empty() {
            self.tail.slowest = Slowest::NONE;
        }
        self.tail.slowest.take(headroom, limits.v, self.level, self.depth);
        // What follows on nothing starts from rest.
        let v_in = if self.blocks.is_empty() { Speed::ZERO } else { UNPLANNED };
        let behind = match &self.tail.last {
            Some(last) if self.tail.row.is_brief() => last.behind,
            _ => *element.exit,
        };
        let trades = element.trades;
        self.tail.last = Some(Last {
            exit: *element.exit,
            length,
            share,
            rapid,
            shared,
            slope,
            timed,
            bent,
            trades,
            behind,
        });
        let mut marks = Marks::default();
        marks.set(Marks::ANCHOR, anchor);
        marks.set(Marks::SMOOTH, smooth);
        marks.set(Marks::GATE, gate);
        marks.set(Marks::LONG, long);
        self.counts.long += usize::from(long);
        // There is room: the caller asked.
        let _ = self.blocks.push_back(Block {
            length: distance,
            limits,
            cap,
            highest,
            v_in,
            v_reached: UNPLANNED,
            v_old: UNPLANNED,
            headroom,
            joint: Joint::new(!anchor && slope == SlopeType::Hsc),
            marks,
            continued: false,
            trades,
        });
    }
}
