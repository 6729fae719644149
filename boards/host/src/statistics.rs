//! Results of a run: peaks from finite differences of the set points, distances, the digest.
use crate::beside::Beside;
use crate::course::Course;
use crate::deviation::Deviation;
use crate::events::What;
use crate::filtered::Filtered;
use crate::machine::Machine;
use crate::monitor::Monitor;
use crate::report::Tape;
use crate::usage::Usage;
use glidepath::channel::PlannedBlock;
use glidepath::digest::Digest;
use glidepath::nc::NcWarning;
use glidepath::quantity::{Position, Speed};
use glidepath::queue::Function;
use glidepath::technology::Output;
use glidepath::tick::Telemetry;
use std::collections::HashSet;

/// Set points of one axis, in the order of the ticks.
#[derive(Clone, Debug, Default)]
pub struct AxisStatistics {
    last: i64,
    /// The latest first, second and third difference, in LSB of [`Position`].
    latest: [i128; 3],
    /// The highest magnitudes of these differences.
    peak: [u128; 3],
    /// Sum of the magnitudes of first differences, LSB. The sum includes twice the distances by which turning
    /// points exceed the neighbouring set points.
    travel: u128,
    lowest: i64,
    highest: i64,
}

impl AxisStatistics {
    fn at_rest(start: Position) -> Self {
        let last = start.to_bits();
        Self { last, lowest: last, highest: last, ..Self::default() }
    }

    fn add(&mut self, set_point: Position) {
        let bits = set_point.to_bits();
        let first = i128::from(bits) - i128::from(self.last);
        let second = first - self.latest[0];
        let third = second - self.latest[1];
        if first.signum() * self.latest[0].signum() < 0 {
            // The axis turned between two ticks; a parabola through the last three set points gives the
            // turning point.
            let sum = (first + self.latest[0]).unsigned_abs();
            self.travel += sum * sum / (4 * second.unsigned_abs());
        }
        self.latest = [first, second, third];
        for (peak, value) in self.peak.iter_mut().zip(self.latest) {
            *peak = (*peak).max(value.unsigned_abs());
        }
        self.travel += first.unsigned_abs();
        self.lowest = self.lowest.min(bits);
        self.highest = self.highest.max(bits);
        self.last = bits;
    }

    /// Speed, acceleration and jerk at the latest set point (mm/s, mm/s², mm/s³; degrees for rotary axes).
    pub fn latest(&self, cycle_s: f64) -> [f64; 3] {
        rates(self.latest.map(|difference| difference as f64), cycle_s)
    }

    /// The highest magnitudes so far.
    pub fn peak(&self, cycle_s: f64) -> [f64; 3] {
        rates(self.peak.map(|difference| difference as f64), cycle_s)
    }

    /// Travelled distance, back and forth, mm or degrees. If the axis turns between two ticks, a parabola
    /// gives the turning point.
    pub fn travel(&self) -> f64 {
        self.travel as f64 / LSB_PER_MM
    }

    /// Lowest and highest set point.
    pub fn range(&self) -> [f64; 2] {
        [self.lowest as f64 / LSB_PER_MM, self.highest as f64 / LSB_PER_MM]
    }
}

const LSB_PER_MM: f64 = (1_u64 << 32) as f64;

/// The n-th difference over the n-th power of the cycle time.
fn rates(differences: [f64; 3], cycle_s: f64) -> [f64; 3] {
    let [first, second, third] = differences.map(|difference| difference / LSB_PER_MM);
    [first / cycle_s, second / cycle_s / cycle_s, third / cycle_s / cycle_s / cycle_s]
}

/// All results of a run that are not stored tick by tick.
pub struct Statistics {
    /// Results of each axis.
    pub axes: Vec<AxisStatistics>,
    /// Rows of a trace: active ticks, and ticks without motion by an event. The first row is the standstill
    /// at the start.
    pub ticks: u64,
    /// Digest over the set points of all rows.
    pub digest: Digest,
    /// Path length, LSB of [`Distance`](glidepath::quantity::Distance), without its wrap.
    pub distance: i128,
    /// The speed profiles, in the order of their motion blocks.
    pub spans: Vec<PlannedBlock>,
    /// Path speed at each transition of two motion blocks: zero if a row stands there, else the lower speed
    /// of the two neighbouring ticks. No value inside a merged line, or if a tick passes several transitions.
    pub transitions: Vec<Option<Speed>>,
    /// The block at whose end the axes stand, until they move.
    stands: Option<u32>,
    /// Twice the change of speed in a tick at this place.
    reaches: Vec<i64>,
    /// Lowest speed between blocks, highest speed inside blocks.
    pub course: Course,
    /// A driven speed differs from the planned speed, because the path was time.
    pub over_time: bool,
    /// The highest path speed of all ticks.
    pub fastest: Speed,
    /// Answers to the PLC.
    pub plc: Option<crate::plc::Told>,
    /// Technology functions in the order of their output.
    pub functions: Vec<PutOut>,
    /// Result of each event.
    pub outcomes: Vec<Outcome>,
    /// Warnings of the planner about curves: once for each place of the program.
    pub remarks: Vec<NcWarning>,
    /// Comparison of all rows with the limits.
    pub monitor: Monitor,
    /// Comparison of the driven path with the programmed path, if requested.
    pub deviation: Option<Deviation>,
    /// The axes after their filters.
    pub filtered: Filtered,
    /// The axes that move independently of the path.
    pub beside: Beside,
    /// Time at each feed.
    pub usage: Usage,
    /// Number of rows at standstill so far.
    pub rest: u64,
    /// The last row in which an axis moved, also independently of the path.
    moved: u64,
    /// Rows at standstill because of an event, and because of a missing acknowledgement.
    pub held: u64,
    pub waited: u64,
    /// Rows at standstill for other reasons, up to an abort: executed dwells.
    pub dwelt: u64,
    /// The operator has aborted the program.
    pub aborted: bool,
    /// The motion was slower than programmed, so that a stop without the planner fits into the queue.
    pub slower: bool,
    /// Elements under a transformation, and the number of resulting polynomials.
    pub split: glidepath::plan::Split,
    /// Every tick, if a page must show the run.
    pub tape: Option<Tape>,
    /// Ranges of both kinds of standstill: tick of the first and of the last row.
    pub holds: Vec<[u64; 2]>,
    awaited: Vec<Awaited>,
    told: HashSet<(u16, u32, String)>,
    last: Telemetry,
}

/// Reason for a row at standstill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pause {
    /// The program.
    None,
    /// An event.
    Held,
    /// A function is not acknowledged.
    Waiting,
}

/// A technology function that was output.
#[derive(Clone, Copy, Debug)]
pub struct PutOut {
    /// The tick that reached its point.
    pub tick: u64,
    /// The function.
    pub output: Output,
    /// The tick before which the acknowledgement came.
    pub acknowledged: Option<u64>,
}

/// Result of an event.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outcome {
    /// The tick before which the event came; none if the program had ended before.
    pub tick: Option<u64>,
    /// The effect of the event.
    pub reaction: Option<Reaction>,
    /// An acknowledgement without a waiting function.
    pub ignored: bool,
}

/// An effect that has not occurred yet.
struct Awaited {
    /// Index of the event.
    index: usize,
    what: What,
    effect: Effect,
    /// Tick of the event.
    tick: u64,
    distance: i128,
}

/// The effect that an event causes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The set points stop.
    Standstill,
    /// The set points move.
    Motion,
}

/// The tick of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reaction {
    /// The effect.
    pub effect: Effect,
    /// Ticks from the event to the last row with motion, or to the first row with motion.
    pub ticks: u64,
    /// Path moved until then, LSB of [`Distance`](glidepath::quantity::Distance).
    pub distance: i128,
}

impl Statistics {
    /// Records a warning. Lines of loops and subroutines run again, so each warning is recorded once.
    pub fn remark(&mut self, remark: NcWarning) {
        if self.told.insert((remark.place.file, remark.place.offset, remark.to_string())) {
            self.remarks.push(remark);
        }
    }

    /// Statistics of a machine at standstill; `events` events will come.
    pub fn new(start: &[Position], events: usize) -> Self {
        Self {
            axes: start.iter().map(|&position| AxisStatistics::at_rest(position)).collect(),
            ticks: 0,
            digest: Digest::new(),
            distance: 0,
            spans: Vec::new(),
            remarks: Vec::new(),
            monitor: Monitor::default(),
            deviation: None,
            filtered: Filtered::default(),
            beside: Beside::default(),
            usage: Usage::default(),
            transitions: Vec::new(),
            stands: None,
            reaches: Vec::new(),
            over_time: false,
            course: Course::default(),
            fastest: Speed::ZERO,
            functions: Vec::new(),
            plc: None,
            outcomes: vec![Outcome::default(); events],
            rest: 0,
            moved: 0,
            held: 0,
            waited: 0,
            dwelt: 0,
            aborted: false,
            slower: false,
            split: glidepath::plan::Split::default(),
            tape: None,
            holds: Vec::new(),
            awaited: Vec::new(),
            told: HashSet::new(),
            last: Telemetry::default(),
        }
    }

    /// The event with this index comes before the next tick; `taken`: the event was not ignored.
    pub fn happens(&mut self, index: usize, what: What, taken: bool) {
        let ended = match what {
            What::FeedHold | What::Override(0) => Some(Effect::Motion),
            What::Resume | What::Override(_) => Some(Effect::Standstill),
            What::Abort | What::Reduced(_) | What::Starve(_) | What::Stall(_) | What::Acknowledge(_) => None,
        };
        self.awaited.retain(|other| Some(other.effect) != ended);
        let effect = match what {
            What::FeedHold | What::Abort | What::Override(0) | What::Starve(_) | What::Stall(_) => {
                Some(Effect::Standstill)
            }
            What::Resume => Some(Effect::Motion),
            What::Acknowledge(_) if taken && self.rest > 0 => Some(Effect::Motion),
            What::Acknowledge(_) | What::Override(_) | What::Reduced(_) => None,
        };
        self.aborted |= what == What::Abort;
        let (tick, distance) = (self.ticks, self.distance);
        (self.outcomes[index].tick, self.outcomes[index].ignored) = (Some(tick), !taken);
        if let (What::Acknowledge(function), true) = (what, taken) {
            self.acknowledged(function);
        }
        self.awaited.extend(effect.map(|effect| Awaited { index, what, effect, tick, distance }));
    }

    /// A function is acknowledged before the next tick.
    pub fn acknowledged(&mut self, function: Function) {
        let open = |done: &&mut PutOut| {
            done.output.waits && done.output.function == function && done.acknowledged.is_none()
        };
        if let Some(done) = self.functions.iter_mut().find(open) {
            done.acknowledged = Some(self.ticks);
        }
    }

    /// The program text is no longer late.
    pub fn has_text(&mut self) {
        self.awaited.retain(|awaited| !matches!(awaited.what, What::Starve(_)));
    }

    /// The planner is no longer late.
    pub fn catches_up(&mut self) {
        self.awaited.retain(|awaited| !matches!(awaited.what, What::Stall(_)));
    }

    /// Records a row, whether it is on a curve that is no arc, and the possible reason of a standstill.
    pub fn add(&mut self, telemetry: &Telemetry, set_points: &[Position], curve: bool, pause: Pause) {
        let moved = telemetry.distance != self.last.distance;
        let step = telemetry.distance.to_bits().wrapping_sub(self.last.distance.to_bits());
        self.distance += i128::from(step);
        let stood = self.stood(telemetry);
        if stood.is_some() || moved {
            self.stands = stood;
        }
        for block in self.last.block..telemetry.block {
            let passed = if stood == Some(block) { Some(Speed::ZERO) } else { self.passed(block, telemetry) };
            self.transitions.push(passed);
            let changes = [telemetry.accel, self.last.accel].map(|accel| accel.to_bits().abs());
            let change = (telemetry.speed.to_bits() - self.last.speed.to_bits()).abs();
            self.reaches.push(2 * changes[0].max(changes[1]).max(change));
        }
        if telemetry.block != self.last.block {
            self.monitor.passes(self.ticks);
        }
        self.monitor.drives(telemetry.block, curve);
        self.course.add(self.ticks, telemetry.block, telemetry.speed, stood);
        self.fastest = self.fastest.max(telemetry.speed);
        self.last = *telemetry;
        self.add_points(self.ticks, set_points);
        if self.axes.iter().any(|axis| axis.latest[0] != 0) {
            self.moved = self.ticks;
        }
        self.react(moved);
        self.rest = if moved { 0 } else { self.rest + 1 };
        // The first row is the rest at the start.
        self.dwelt += u64::from(pause == Pause::None && !moved && !self.aborted && self.ticks > 0);
        if pause != Pause::None && !moved {
            *if pause == Pause::Held { &mut self.held } else { &mut self.waited } += 1;
            match self.holds.last_mut() {
                Some([_, last]) if *last + 1 == self.ticks => *last = self.ticks,
                _ => self.holds.push([self.ticks; 2]),
            }
        }
        self.ticks += 1;
    }

    /// Number of rows so far in which no axis moved, not even independently of the path.
    pub fn rest_of_all(&self) -> u64 {
        self.rest.min(self.ticks.saturating_sub(1 + self.moved))
    }

    /// The block at whose end this row stands.
    ///
    /// If the axes stand still at a transition, a row lies there, because the next motion begins at a tick.
    /// This row counts as a row of the block after the transition, or of the last block of a merged line. If
    /// several transitions are possible, the speed profiles decide.
    fn stood(&self, row: &Telemetry) -> Option<u32> {
        let joints = self.last.block..row.block;
        if row.speed != Speed::ZERO || self.distance == 0 || joints.is_empty() {
            return None;
        }
        let ends = self.spans.iter().rev().filter(|span| span.v_out == Speed::ZERO);
        let mut ends = ends.map(|span| span.block + span.blocks.max(1) - 1);
        let last = row.block - 1;
        Some(if joints.len() == 1 { last } else { ends.find(|end| joints.contains(end)).unwrap_or(last) })
    }

    /// The speed at the transition at the end of a block, between the last row and this one. After a
    /// standstill a tick may pass a whole block; the axes do not stand at the end of such a block.
    fn passed(&self, block: u32, row: &Telemetry) -> Option<Speed> {
        let around = [self.last.speed, row.speed].into_iter().filter(|speed| *speed != Speed::ZERO).min();
        around.filter(|_| block == self.last.block && self.ticks > 0)
    }

    fn react(&mut self, moved: bool) {
        let reached = if moved { Effect::Motion } else { Effect::Standstill };
        let (now, at) = (self.ticks, self.distance);
        for awaited in self.awaited.extract_if(.., |awaited| awaited.effect == reached) {
            // At a standstill, the row before was the last one that moved.
            let ticks = (now - awaited.tick).saturating_sub(u64::from(!moved));
            let reaction = Reaction { effect: reached, ticks, distance: at - awaited.distance };
            self.outcomes[awaited.index].reaction = Some(reaction);
        }
    }

    /// Records a function that is due at the last tick.
    pub fn output(&mut self, output: Output) {
        let tick = self.ticks.saturating_sub(1);
        self.functions.push(PutOut { tick, output, acknowledged: None });
    }

    /// Adds the standstill after the last tick, so that the peaks include a stop with a step, and the end of
    /// an abort.
    pub fn finish(&mut self, set_points: &[Position]) {
        // The last block began and ended within a tick; its end is the end of the program and no transition.
        if let Some(joint) = self.stands.take() {
            if let Some(passed) = self.transitions.get_mut(joint as usize) {
                *passed = None;
            }
            self.course.forget(joint as usize);
        }
        self.react(false);
        for row in 0..3 {
            self.monitor.drives(self.last.block, false);
            self.add_points(self.ticks + row, set_points);
        }
    }

    fn add_points(&mut self, tick: u64, set_points: &[Position]) {
        for (k, (axis, &set_point)) in self.axes.iter_mut().zip(set_points).enumerate() {
            axis.add(set_point);
            self.monitor.look(k, tick, self.last.n, &axis.latest);
        }
    }

    /// Path length in mm.
    pub fn distance_mm(&self) -> f64 {
        self.distance as f64 / (1_u64 << 44) as f64
    }

    /// The last motion block of every speed profile that ends at a transition, and the planned speed there.
    /// The planned speed is used only if the speeds of the neighbouring ticks can follow from it; on a curve
    /// over time they cannot. A standstill must show in the rows.
    pub fn ends(&self) -> Vec<(usize, Speed)> {
        let end = |pair: &[PlannedBlock]| {
            let [span, next] = pair else { return None };
            let last = span.block as usize + span.blocks.max(1) as usize - 1;
            // Otherwise the next speed profile begins inside the block.
            (next.block as usize == last + 1).then_some((last, span.v_out))
        };
        let reached = |&(last, planned): &(usize, Speed)| {
            let (Some(seen), Some(reach)) = (self.transitions.get(last), self.reaches.get(last)) else {
                return false;
            };
            match seen {
                Some(seen) if *seen == Speed::ZERO || planned == Speed::ZERO => *seen == planned,
                Some(seen) => (planned.to_bits() - seen.to_bits()).abs() <= *reach,
                None => planned != Speed::ZERO,
            }
        };
        self.spans.windows(2).filter_map(end).filter(reached).collect()
    }

    /// Number of motion blocks that the set points have reached.
    pub fn blocks(&self) -> usize {
        if self.spans.is_empty() { 0 } else { self.transitions.len() + 1 }
    }

    /// Program time: from the first set point to the end of the speed profile. The end is at the last set
    /// point or, at the end of a motion, less than a tick before it.
    pub fn time_s(&self, machine: &Machine) -> f64 {
        let early = match self.spans.last() {
            Some(span) if self.rest == 0 => span.wait.0.to_num::<f64>(),
            _ => 0.0,
        };
        (self.ticks.saturating_sub(1) as f64 - early) * f64::from(machine.channel.cycle_us) / 1e6
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glidepath::quantity::Distance;

    fn row(mm: i64, block: u32, speed: i64) -> Telemetry {
        let (distance, speed) = (Distance::from_bits(mm << 44), Speed::from_bits(speed));
        Telemetry { distance, block, speed, ..Telemetry::default() }
    }

    #[test]
    fn peaks_are_differences_and_see_a_hard_stop() {
        let mut statistics = Statistics::new(&[Position::ZERO], 0);
        // 1 mm per tick from rest, and a jump to rest.
        for i in 1..=10 {
            statistics.add(&row(i, 0, 0), &[Position::from_num(-i)], false, Pause::None);
        }
        statistics.finish(&[Position::from_num(-10)]);
        let axis = &statistics.axes[0];
        assert_eq!(axis.peak(0.001), [1e3, 1e6, 1e9]);
        assert_eq!((axis.travel(), axis.range()), (10.0, [-10.0, 0.0]));
        assert_eq!((statistics.ticks, statistics.distance_mm()), (10, 10.0));
    }

    #[test]
    fn travel_reaches_turning_points_between_two_ticks() {
        let mut axis = AxisStatistics::at_rest(Position::ZERO);
        // From 0 to a peak of 1 mm between two ticks, and back: 1 - (t - 10.3)²/10.3² mm.
        let place = |t: f64| Position::from_num(1.0 - (t / 10.3 - 1.0).powi(2));
        for tick in 0..=20 {
            axis.add(place(f64::from(tick)));
        }
        let expected = 2.0 - place(20.0).to_num::<f64>();
        assert!((axis.travel() - expected).abs() < 1e-8, "{} for {expected}", axis.travel());
        // A jump to rest and back is no parabola: nothing is added.
        let mut axis = AxisStatistics::at_rest(Position::ZERO);
        for place in [1, 2, 2, 1, 0] {
            axis.add(Position::from_num(place));
        }
        assert_eq!(axis.travel(), 4.0);
    }

    #[test]
    fn only_dwells_before_an_abort_count() {
        let mut statistics = Statistics::new(&[Position::ZERO], 1);
        let rows = |statistics: &mut Statistics, places: &[i64], pause| {
            for &mm in places {
                statistics.add(&row(mm, 0, 0), &[Position::ZERO], false, pause);
            }
        };
        rows(&mut statistics, &[0, 1, 2, 2, 2, 2, 3], Pause::None);
        rows(&mut statistics, &[3, 3], Pause::Held);
        assert_eq!((statistics.dwelt, statistics.held), (3, 2));
        rows(&mut statistics, &[4, 4], Pause::None);
        statistics.happens(0, What::Abort, true);
        rows(&mut statistics, &[4, 4, 4], Pause::None);
        assert_eq!(statistics.dwelt, 4);
    }

    #[test]
    fn transitions_have_the_lower_speed_of_the_ticks_around_them() {
        let mut statistics = Statistics::new(&[Position::ZERO], 0);
        for (block, speed) in [(0, 0), (0, 5), (1, 3), (1, 4), (4, 7), (4, 0)] {
            statistics.add(&row(0, block, speed), &[Position::ZERO], false, Pause::None);
        }
        let passed = [3, 4].map(|bits| Some(Speed::from_bits(bits)));
        assert_eq!(statistics.transitions, [passed[0], passed[1], None, None]);
        assert_eq!(statistics.fastest, Speed::from_bits(7));
    }

    #[test]
    fn a_joint_is_stood_at_where_a_row_stands() {
        let mut statistics = Statistics::new(&[Position::ZERO], 0);
        // A tick passes two transitions and ends in a standstill at a third one; the next tick passes a whole
        // block.
        let rows = [(0, 0), (0, 5), (3, 0), (3, 0), (4, 2), (4, 6), (5, 4), (5, 0), (5, 3), (6, 3)];
        for (mm, (block, speed)) in (0..).zip(rows) {
            statistics.add(&row(mm, block, speed), &[Position::ZERO], false, Pause::None);
        }
        let passed = |bits| Some(Speed::from_bits(bits));
        assert_eq!(statistics.transitions, [passed(5), None, passed(0), passed(2), passed(4), passed(3)]);
        // Blocks 7 to 9 are merged to one line. The speed profiles show that the axes stand before this line.
        let law = PlannedBlock { block: 6, blocks: 1, ..PlannedBlock::default() };
        statistics.spans = vec![law, PlannedBlock { block: 7, blocks: 3, ..law }];
        statistics.add(&row(10, 9, 0), &[Position::ZERO], false, Pause::None);
        assert_eq!(statistics.transitions[6..], [passed(0), None, None]);
        let joints: Vec<_> =
            (0..7).map(|block| statistics.course.joint(block).map(|seen| seen.speed)).collect();
        // The course looks from fastest to fastest: there it stands inside block 5.
        assert_eq!(joints, [passed(5), None, passed(0), passed(2), passed(4), passed(0), passed(0)]);
    }

    #[test]
    fn the_end_of_the_program_is_no_joint() {
        let mut statistics = Statistics::new(&[Position::ZERO], 0);
        for (mm, (block, speed)) in (0..).zip([(0, 0), (0, 5), (1, 0), (1, 4), (2, 0)]) {
            statistics.add(&row(mm, block, speed), &[Position::ZERO], false, Pause::None);
        }
        statistics.finish(&[Position::ZERO]);
        assert_eq!(statistics.transitions, [Some(Speed::ZERO), None]);
        assert_eq!([0, 1].map(|block| statistics.course.joint(block).is_some()), [true, false]);
    }

    #[test]
    fn laws_end_at_joints_or_inside_of_blocks() {
        let mut statistics = Statistics::new(&[Position::ZERO], 0);
        let rows = [(0, 0), (0, 9), (1, 8), (1, 9), (2, 9), (2, 5), (3, 0), (3, 7)];
        for (mm, (block, speed)) in (0..).zip(rows) {
            statistics.add(&row(mm, block, speed), &[Position::ZERO], false, Pause::None);
        }
        let law = |block, blocks, v_out| PlannedBlock {
            block,
            blocks,
            v_out: Speed::from_bits(v_out),
            ..PlannedBlock::default()
        };
        // The second one ends inside of block 1; a standstill that no row shows is none.
        statistics.spans = vec![law(0, 1, 7), law(1, 1, 0), law(1, 1, 0), law(2, 1, 0), law(3, 1, 0)];
        assert_eq!(statistics.ends(), [(0, Speed::from_bits(7)), (2, Speed::ZERO)]);
    }

    #[test]
    fn reactions_count_from_the_event() {
        let mut statistics = Statistics::new(&[Position::ZERO], 4);
        let rows = |statistics: &mut Statistics, places: &[i64]| {
            for &mm in places {
                statistics.add(&row(mm, 0, 0), &[Position::ZERO], false, Pause::Held);
            }
        };
        rows(&mut statistics, &[0, 2]);
        statistics.happens(0, What::FeedHold, true);
        rows(&mut statistics, &[4, 5, 5, 5, 5]);
        statistics.happens(1, What::Resume, true);
        rows(&mut statistics, &[5, 6]);
        // The planner comes back before anything stands still; then a hold is lifted too early.
        statistics.happens(2, What::Stall(1), true);
        rows(&mut statistics, &[7]);
        statistics.catches_up();
        statistics.happens(3, What::FeedHold, true);
        statistics.happens(1, What::Resume, true);
        rows(&mut statistics, &[7, 7]);
        let reaction = |effect, ticks, mm: i128| Some(Reaction { effect, ticks, distance: mm << 44 });
        let seen: Vec<_> = statistics.outcomes.iter().map(|outcome| outcome.reaction).collect();
        let expected = [reaction(Effect::Standstill, 1, 3), reaction(Effect::Motion, 1, 1), None, None];
        assert_eq!(seen, expected);
        assert_eq!((statistics.held, &statistics.holds[1]), (7, &[4, 7]));
        assert_eq!((statistics.rest, statistics.ticks), (2, 12));
    }
}
