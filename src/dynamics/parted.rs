//! A change of the dynamics while smoothing holds blocks back: it belongs to a point of the path that is not in the
//! look-ahead yet.
//!
//! What is before that point keeps what was in force, what is behind it has what is in force then, and what belongs
//! to both sides has what both permit: of accelerations the lower ones, of ramp times the longer ones, of path limits
//! the lower ones. An axis with these data keeps the limits of both sides, whatever is made of it.
//!
//! Of two slopes both sides have the one that takes less: with a limit of jerk rather than without, ramps of TRAPEZ
//! rather than those of SIN2 or HSC. The acceleration of STEP is that of its lower stage, HSC has its longest ramp.
use super::vector::InForce;
use super::{Dynamics, Weights};
use crate::machine::{AxisData, MachineData};
use crate::nc::SlopeType;
use crate::slope::limits::Joins;

/// On which side of the point of a change something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// What was in force counts.
    Before,
    /// What both permit.
    Both,
    /// What is in force from there on.
    Behind,
}

/// What the program says beside the weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ruling {
    pub path: InForce,
    pub slope: SlopeType,
    pub joins: Joins,
}

impl Ruling {
    /// What keeps both.
    fn with(&self, other: &Self) -> Self {
        let slope = both_slopes([self.slope, other.slope]);
        let optimised = self.joins == Joins::Valleys && other.joins == Joins::Valleys;
        Self { path: self.path.with(&other.path), slope, joins: Joins::of(slope, optimised) }
    }
}

/// A change that waits for its point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parted<const AXES: usize> {
    /// Motion blocks before the point.
    since: u32,
    /// What is at work in [`Dynamics`].
    side: Side,
    /// The block in which the last element began that has gone since, by the motion blocks before it.
    passed: Option<u32>,
    before: Ruling,
    behind: Ruling,
    /// Behind the point; those before it are in [`Dynamics`].
    weights: Weights<AXES>,
}

/// The slope that keeps what two of them permit.
fn both_slopes([a, b]: [SlopeType; 2]) -> SlopeType {
    match (a, b) {
        _ if a == b => a,
        (SlopeType::Step, other) | (other, SlopeType::Step) => other,
        _ => SlopeType::Trapez,
    }
}

/// Lowest acceleration and deceleration at feed and in rapid motion, mm/s².
fn least(data: &AxisData, slope: SlopeType) -> [u32; 3] {
    if slope != SlopeType::Step {
        return [data.a_beschl, data.a_brems, data.a_grenz];
    }
    let (feed, rapid) = (data.stages(false), data.stages(true));
    let of = |[lower, upper]: [u32; 2]| lower.min(upper);
    [of(feed.a), of(feed.d), of(rapid.a).min(of(rapid.d))]
}

/// Data of an axis that keep those of both sides with their slopes.
fn both(before: &AxisData, behind: &AxisData, slopes: [SlopeType; 2]) -> AxisData {
    let mut out = *before;
    let [a, b] = [least(before, slopes[0]), least(behind, slopes[1])];
    let lower = [a[0].min(b[0]), a[1].min(b[1]), a[2].min(b[2])];
    [out.a_beschl, out.a_brems, out.a_grenz] = lower;
    let lower = |a: [u32; 2], b: [u32; 2]| [a[0].min(b[0]), a[1].min(b[1])];
    out.a_stufe = lower(before.a_stufe, behind.a_stufe);
    out.d_stufe = lower(before.d_stufe, behind.d_stufe);
    out.a_grenz_stufe = lower(before.a_grenz_stufe, behind.a_grenz_stufe);
    out.d_grenz_stufe = lower(before.d_grenz_stufe, behind.d_grenz_stufe);

    let ramps = |data: &AxisData| [data.tr_beschl_zu, data.tr_beschl_ab, data.tr_brems_zu, data.tr_brems_ab];
    let [mut longer, behind_it] = [ramps(before), ramps(behind)];
    for (tr, other) in longer.iter_mut().zip(behind_it) {
        *tr = (*tr).max(other);
    }
    if slopes[0] != slopes[1] && slopes.contains(&SlopeType::Hsc) {
        longer = [longer.into_iter().fold(0, u32::max); 4];
    }
    [out.tr_beschl_zu, out.tr_beschl_ab, out.tr_brems_zu, out.tr_brems_ab] = longer;
    out.tr_grenz = before.tr_grenz.max(behind.tr_grenz);
    out.tr_geom = before.geometric_ramp().max(behind.geometric_ramp());
    out
}

impl<const AXES: usize> Dynamics<AXES> {
    /// What is at work beside the weights.
    fn at_work(&self) -> Ruling {
        Ruling { path: self.path.in_force(), slope: self.slope, joins: self.joins }
    }

    /// What the program has said last beside the weights, whether it is at work or waits for its point.
    pub(super) fn said(&self) -> Ruling {
        self.parted.as_ref().map_or_else(|| self.at_work(), |parted| parted.behind)
    }

    /// The weights that the program has given last.
    pub(super) fn weighted(&self) -> &Weights<AXES> {
        self.parted.as_ref().map_or(&self.weights, |parted| &parted.weights)
    }

    /// Takes in what the program says: at once, or behind so many motion blocks where `point` says so, of which the
    /// last one has come, and none behind it. What changes nothing leaves no trace: `false`.
    #[inline(never)]
    pub(super) fn part(
        &mut self,
        machine: &MachineData<AXES>,
        point: Option<u32>,
        (ruling, weights): (&Ruling, &Weights<AXES>),
    ) -> bool {
        if *ruling == self.said() && weights == self.weighted() {
            return false;
        }
        let Some(since) = point else {
            self.parted = None;
            let remakes = ruling.slope != self.slope || *weights != self.weights;
            self.weights = *weights;
            self.rule(ruling);
            if remakes {
                self.change(machine);
            } else {
                self.count();
            }
            return true;
        };
        let before = self.at_work();
        // It may have been taken back before a block has come.
        let differs = *ruling != before || *weights != self.weights;
        let parted =
            || Parted { since, side: Side::Before, passed: None, before, behind: *ruling, weights: *weights };
        self.parted = differs.then(parted);
        true
    }

    /// That counts in the elements that follow, once the axes are made anew.
    fn rule(&mut self, ruling: &Ruling) {
        self.path.put(&ruling.path);
        (self.slope, self.joins) = (ruling.slope, ruling.joins);
    }

    /// Data of an axis that the elements that follow are made with.
    pub(super) fn data(&self, axis: usize, machine: &MachineData<AXES>) -> Option<AxisData> {
        let (data, channel) = (machine.axes.get(axis)?, &machine.channel);
        let before = self.weights.apply(axis, data, channel);
        match &self.parted {
            Some(Parted { side: Side::Both, weights, before: ruling, behind, .. }) => {
                let other = weights.apply(axis, data, channel);
                Some(both(&before, &other, [ruling.slope, behind.slope]))
            }
            _ => Some(before),
        }
    }

    /// Whether a change waits for its point.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn is_parted(&self) -> bool {
        self.parted.is_some()
    }

    /// The motion blocks before its point, and before that in which the last element began that has gone since.
    pub fn point(&self) -> Option<(u32, Option<u32>)> {
        self.parted.as_ref().map(|parted| (parted.since, parted.passed))
    }

    /// An element goes into the look-ahead that begins in the block behind so many.
    #[cold]
    #[inline(never)]
    pub fn pass(&mut self, number: u32) {
        if let Some(parted) = &mut self.parted {
            parted.passed = Some(number);
        }
    }

    /// What goes on next is on that side. `false` if that is at work already.
    #[cold]
    #[inline(never)]
    pub fn take_side(&mut self, machine: &MachineData<AXES>, side: Side) -> bool {
        let Some(parted) = &mut self.parted else { return false };
        if parted.side == side {
            return false;
        }
        parted.side = side;
        let ruling = match side {
            Side::Before => parted.before,
            Side::Both => parted.before.with(&parted.behind),
            Side::Behind => parted.behind,
        };
        if side == Side::Behind {
            self.weights = parted.weights;
            self.parted = None;
        }
        self.rule(&ruling);
        self.change(machine);
        true
    }

    /// Whether the elements that follow may be made with other dynamics before what stands behind the axes is asked
    /// again: none of them is filtered.
    pub fn may_part(&self) -> bool {
        !self.axes.iter().any(|axis| axis.is_filtered)
    }
}
