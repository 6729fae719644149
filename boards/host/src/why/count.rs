//! The limit that bound the speed of each transition and of each block: found, counted, and put into words.
use super::loosen::Limit;
use super::trial::Trial;
use crate::course::{Course, Seen};
use crate::knee::{SHARP, knees};
use crate::machine::Machine;
use crate::program::Program;
use crate::statistics::Statistics;
use glidepath::machine::AxisData;
use glidepath::nc::SlopeType;
use glidepath::quantity::Speed;
use std::collections::BTreeMap;

/// If a place is slower than its feed by less than this part, the feed binds its speed.
const AT_FEED: f64 = 0.995;
/// If a changed limit makes a place faster by less than this part, the limit does not bind the speed. A
/// quarter more of a binding limit gives at least 6 %, because speed grows at least with its fourth root.
const GAIN: f64 = 0.015;
/// A place slower than this part of its speed without events is bound by an event.
const SLOWED: f64 = 0.98;
/// Changes of the program time above this part are reported.
const HELP: f64 = 0.005;

/// A transition slower than this part of the neighbouring blocks is nearly a standstill.
const NEARLY: f64 = 0.02;

/// The reason that bound the speed of a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Bound {
    /// A programmed standstill: exact stop, dwell, end of the program.
    Stop,
    /// The motion waited for the acknowledgement of a function.
    Function,
    /// Override, feed hold, or a planner without text or time.
    Operator,
    /// The programmed feed.
    Feed,
    /// A limit of the machine data, and the axis if only one axis binds.
    Limit(Limit, Option<usize>),
    /// A corner without a curve that the axes pass at nearly zero speed: its angle determines the permitted
    /// speed.
    Corner,
    /// No single limit: several limits at once.
    Several,
}

impl Bound {
    /// In words.
    pub fn name(self, machine: &Machine) -> String {
        match self {
            Self::Stop => "exact stop or dwell (programmed)".into(),
            Self::Function => "function that is waited for".into(),
            Self::Operator => "operator (override, hold, late planner)".into(),
            Self::Feed => "feed F".into(),
            Self::Limit(limit, None) => limit.name().into(),
            Self::Limit(limit, Some(axis)) => {
                let name = machine.axes.get(axis).map_or("", |axis| axis.name.as_str());
                format!("{} of {name}", limit.name())
            }
            Self::Corner => "corner without a curve (nearly a standstill)".into(),
            Self::Several => "several limits at once".into(),
        }
    }
}

/// A transition (the end of a block) or the inside of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Joint(usize),
    Block(usize),
}

impl Place {
    fn seen(self, course: &Course) -> Option<Seen> {
        match self {
            Self::Joint(block) => course.joint(block),
            Self::Block(block) => course.top(block),
        }
    }

    /// The axis in whose trial this place is fastest.
    pub fn fastest<'a>(self, trials: impl Iterator<Item = &'a Trial>) -> Option<usize> {
        let mut all: Vec<(Speed, usize)> =
            trials.filter_map(|trial| Some((self.seen(&trial.course)?.speed, trial.axis?))).collect();
        all.sort_unstable();
        match all.as_slice() {
            [.., (second, _), (first, axis)] if first > second => Some(*axis),
            [(_, axis)] => Some(*axis),
            // All are alike.
            _ => None,
        }
    }
}

/// Number of places with a reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    pub joints: usize,
    pub blocks: usize,
}

/// The program time with one limit changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Help {
    pub limit: Limit,
    pub time_s: f64,
}

/// The reasons that bound the speed of a run.
#[derive(Debug, Default)]
pub struct Why {
    /// Program time without events.
    pub time_s: f64,
    /// By block: reason at the transition at its end, and reason inside.
    pub joints: Vec<Option<Bound>>,
    pub blocks: Vec<Option<Bound>>,
    /// Changed limits that make the program faster, the largest effect first.
    pub helps: Vec<Help>,
    /// The time with smoothing, for a program without smoothing.
    pub smoothed_s: Option<f64>,
}

/// Data of a run.
pub struct Places<'a> {
    pub machine: &'a Machine,
    pub program: &'a Program,
    /// The run itself, and the run without events.
    pub run: &'a Statistics,
    pub base: &'a Statistics,
    /// Runs with one limit changed.
    pub trials: &'a [Trial],
}

impl Places<'_> {
    /// Finds the reason for each transition and each block.
    pub fn count(&self, time_s: f64) -> Why {
        let stops = self.program.stops();
        let feeds = self.feeds();
        let feed = |block: usize| feeds.get(block).copied().flatten();
        let waits = self.waits();
        let corners: Vec<(f64, bool)> = knees(self.program)
            .into_iter()
            .zip(self.program.motions().map(|motion| motion.smoothed))
            .collect();
        let blocks = self.run.course.blocks();
        let joint = |block: usize| {
            let seen = self.run.course.joint(block)?;
            if *stops.get(block)? && seen.speed == Speed::ZERO {
                return Some(if waits.contains(&block) { Bound::Function } else { Bound::Stop });
            }
            if waits.contains(&block) {
                return Some(Bound::Function);
            }
            // Next to rapid motion: the feed of the other block, if there is one.
            let slower = [feed(block), feed(block + 1)].into_iter().flatten().reduce(f64::min);
            let is_corner = corners.get(block).is_some_and(|(knee, smoothed)| {
                *knee > SHARP
                    && if *smoothed { self.is_kept(block, *knee) } else { self.nearly_stands(block) }
            });
            let found = self.find(Place::Joint(block), slower)?;
            Some(if is_corner && found != Bound::Operator { Bound::Corner } else { found })
        };
        let inside = |block: usize| self.find(Place::Block(block), feed(block));
        Why {
            time_s,
            joints: (0..blocks).map(joint).collect(),
            blocks: (0..blocks).map(inside).collect(),
            helps: Vec::new(),
            smoothed_s: None,
        }
    }

    /// Feeds of all blocks, per second along the path.
    fn feeds(&self) -> Vec<Option<f64>> {
        self.program.speeds(self.machine).iter().map(|speed| speed.programmed).collect()
    }

    /// Blocks at whose end the motion waited for a function.
    fn waits(&self) -> Vec<usize> {
        let waited = self.run.functions.iter().filter(|done| {
            let at_once = done.acknowledged.is_some_and(|tick| tick <= done.tick + 1);
            done.output.waits && !at_once
        });
        let mut block = 0;
        let mut found = Vec::new();
        for done in waited {
            // The first block whose fastest tick comes later begins after the function.
            let later = |block: usize| self.run.course.top(block).is_some_and(|top| top.tick > done.tick);
            while block < self.run.course.blocks() && !later(block) {
                block += 1;
            }
            found.extend(block.checked_sub(1));
        }
        found
    }

    /// Whether a corner that smoothing might round is no faster than the step of speed that every corner may
    /// have (P-AXIS-00013). A curve needs no step, and is faster. STEP permits larger steps, so for STEP the
    /// answer is no.
    fn is_kept(&self, block: usize, knee: f64) -> bool {
        let cycle = self.machine.cycle_s();
        let step = |axis: &AxisData| {
            let a = f64::from(axis.a_beschl.max(axis.a_brems).max(axis.a_grenz));
            let ramps =
                [axis.tr_beschl_zu, axis.tr_beschl_ab, axis.tr_brems_zu, axis.tr_brems_ab, axis.tr_grenz];
            let ramp = f64::from(ramps.into_iter().min().unwrap_or(0)) * 1e-6;
            let part =
                if axis.a_trans_weight > 0 { f64::from(axis.a_trans_weight) * 1e-3 } else { cycle / ramp };
            a * cycle * part
        };
        // Of three axes, the axis with the largest change has at least this part.
        let turn = 2.0 * (0.5 * knee.to_radians()).sin() / 3.0_f64.sqrt();
        let most = self.machine.axes.iter().map(step).fold(0.0, f64::max) / turn;
        let Some(joint) = self.base.course.joint(block) else { return false };
        self.machine.slope() != SlopeType::Step && self.per_second(joint.speed) <= most
    }

    /// Path speed per second.
    fn per_second(&self, speed: Speed) -> f64 {
        speed.to_bits() as f64 / (1_u64 << 58) as f64 / self.machine.cycle_s()
    }

    /// Whether a transition is far slower than the blocks on both sides.
    fn nearly_stands(&self, block: usize) -> bool {
        let course = &self.base.course;
        let tops =
            [course.top(block), course.top(block + 1)].into_iter().flatten().map(|top| top.speed).min();
        let [Some(joint), Some(top)] = [course.joint(block).map(|joint| joint.speed), tops] else {
            return false;
        };
        (joint.to_bits() as f64) < NEARLY * top.to_bits() as f64
    }

    fn find(&self, place: Place, feed: Option<f64>) -> Option<Bound> {
        let seen = place.seen(&self.run.course)?.speed;
        let alone = place.seen(&self.base.course).map_or(seen, |alone| alone.speed);
        let value = |speed: Speed| self.per_second(speed);
        if value(seen) < SLOWED * value(alone) {
            return Some(Bound::Operator);
        }
        if feed.is_some_and(|feed| value(alone) >= AT_FEED * feed) {
            return Some(Bound::Feed);
        }
        let gains = self.trials.iter().filter_map(|trial| {
            let then = place.seen(&trial.course)?.speed;
            Some((value(then), trial.limit))
        });
        // Of equal values the first one.
        let best = gains
            .fold((0.0, None), |best, (then, limit)| if then > best.0 { (then, Some(limit)) } else { best });
        Some(match best {
            (then, Some(limit)) if then > (1.0 + GAIN) * value(alone) => Bound::Limit(limit, None),
            _ if alone == Speed::ZERO => Bound::Corner,
            _ => Bound::Several,
        })
    }
}

impl Why {
    /// All reasons, the most frequent one first.
    pub fn counts(&self) -> Vec<(Bound, Count)> {
        let mut counts: BTreeMap<Bound, Count> = BTreeMap::new();
        for bound in self.joints.iter().flatten() {
            counts.entry(*bound).or_default().joints += 1;
        }
        for bound in self.blocks.iter().flatten() {
            counts.entry(*bound).or_default().blocks += 1;
        }
        let mut counts: Vec<(Bound, Count)> = counts.into_iter().collect();
        counts.sort_by_key(|(_, count)| std::cmp::Reverse((count.joints + count.blocks, count.joints)));
        counts
    }

    /// The two limits of the axes that bind most places.
    pub fn most(&self) -> Vec<Limit> {
        let limits = self.counts().into_iter().filter_map(|(bound, _)| match bound {
            Bound::Limit(limit, None) if limit != Limit::Path => Some(limit),
            _ => None,
        });
        limits.take(2).collect()
    }

    /// Finds the axis of each limit.
    pub fn name_axes(&mut self, axis: impl Fn(Place, Limit) -> Option<usize>) {
        let most = self.most();
        let name = |place: Place, bound: &mut Option<Bound>| {
            if let Some(Bound::Limit(limit, of)) = bound
                && most.contains(limit)
            {
                *of = axis(place, *limit);
            }
        };
        for (block, bound) in self.joints.iter_mut().enumerate() {
            name(Place::Joint(block), bound);
        }
        for (block, bound) in self.blocks.iter_mut().enumerate() {
            name(Place::Block(block), bound);
        }
    }

    /// The changes that affect the program time.
    pub fn helps(&mut self, switched: &[Trial], compared: &[Trial]) {
        let faster = |trial: &&Trial| trial.time_s < (1.0 - HELP) * self.time_s;
        let all = compared.iter().chain(switched).filter(faster);
        self.helps = all.map(|trial| Help { limit: trial.limit, time_s: trial.time_s }).collect();
        self.helps.sort_by(|one, other| one.time_s.total_cmp(&other.time_s));
    }
}
