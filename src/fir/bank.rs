//! The planner's handle of the filters: the coefficients in force, and the change that a `#FILTER` command
//! demands.
//!
//! The coefficients change only while the path stands still and the filters have settled. Any coefficients
//! then give the same set points, so no set point jumps. The change has three steps:
//!
//! 1. The planner writes the words of the new coefficients, one axis per call. The interrupt reads none of
//!    them at this time, and only the planner can start the path.
//! 2. The planner increments [`Words::asked`].
//! 3. The interrupt copies the coefficients and fills its samples with the positions of the axes, some per
//!    tick. Then the interrupt answers by [`Words::done`].
use super::design::{self, Design, FilterError};
use super::kernel;
use super::shape::{Shape, Watch};
use super::{FilterPlan, Kind, Layout, Words, taps};
use crate::machine::{FilterData, FilterType, MachineData};
use crate::math::float::max;
use crate::nc;
use crate::quantity::Position;
use core::sync::atomic::Ordering;

/// Shift from LSB 2^-32 mm to the LSB of the deviation words, 2^-22 mm.
pub(super) const COARSE: u32 = 10;

/// What a `#FILTER` command changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// The command changes nothing; the motion continues.
    Same,
    /// The coefficients change, and the axes have to stop for the change.
    Changes,
    /// As `Changes`, but the command gives no order, so no axis is filtered.
    NoOrder,
}

/// The machine data of the filters.
pub(super) struct Settings<const AXES: usize> {
    axes: [FilterData; AXES],
    /// Largest travel per cycle, mm.
    reach: [f32; AXES],
    /// Largest second difference, mm.
    step: [f32; AXES],
    /// Whether P-AXIS-00013 is given.
    weighted: [bool; AXES],
    cycle_us: u32,
}

impl<const AXES: usize> Settings<AXES> {
    pub fn new(machine: &MachineData<AXES>) -> Self {
        let cycle_us = machine.channel.cycle_us;
        Self {
            axes: machine.axes.map(|axis| axis.filter),
            reach: machine.axes.map(|axis| axis.vb_max as f32 * 1e-9 * cycle_us as f32),
            step: machine.axes.map(|axis| axis.a_max as f32 * 1e-12 * (cycle_us as f32 * cycle_us as f32)),
            weighted: machine.axes.map(|axis| axis.a_trans_weight > 0),
            cycle_us,
        }
    }

    fn design(&self, axis: usize, given: &nc::Filter) -> Design {
        let Some(data) = self.axes.get(axis) else { return Design::NONE };
        if given.switch.unwrap_or(data.enable) {
            Design::of(data, given, self.cycle_us)
        } else {
            Design::NONE
        }
    }

    /// Delay of the channel in half cycles.
    fn delay(&self, given: &nc::Filter) -> u32 {
        (0..AXES).map(|axis| self.design(axis, given).delay()).fold(0, u32::max)
    }

    /// Checks that `TAPS` samples suffice for these filters, and that every axis permits its filter.
    pub fn check<const TAPS: usize>(&self, given: &nc::Filter) -> Result<(), FilterError> {
        // Number of samples that can have taps.
        let room = TAPS / 2 * 2;
        let delay = self.delay(given);
        for axis in 0..AXES {
            let design = self.design(axis, given);
            if design.order > design.highest() {
                return Err(FilterError::Order(axis, design.order, design.highest(), false));
            }
            // The age of the oldest sample is the channel's delay plus half of the axis' own window.
            if design.order > 0 && (delay + design.delay()).div_ceil(2) as usize >= room {
                let most = if design.kind == FilterType::Delay { room / 2 } else { room };
                return Err(FilterError::Order(axis, design.order, most.saturating_sub(1) as u32, true));
            }
            let [reach, step] = [&self.reach, &self.step].map(|of| of.get(axis).copied());
            let kind = kernel::layout(&design, delay, reach.unwrap_or(0.0)).kind;
            if kind == Kind::Taps && step.unwrap_or(0.0) > taps::REACH {
                return Err(FilterError::Acceleration(axis));
            }
            let weighted = self.weighted.get(axis).copied().unwrap_or(true);
            if design.order > 0 && design::acc_fact(given) > 1.0 && !weighted {
                return Err(FilterError::NoTransitionWeight(axis));
            }
        }
        design::tolerance(given).map(|_| ())
    }
}

/// Progress of a change of coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    /// The coefficients are in force.
    None,
    /// This number of axes has the new coefficients.
    Writing(usize),
    /// The interrupt has to take the coefficients.
    Asked,
}

/// The planner's handle of [`super::Filters`].
pub struct Bank<'a, const AXES: usize, const TAPS: usize> {
    words: &'a Words<AXES, TAPS>,
    settings: Settings<AXES>,
    /// Values of `#FILTER`: first those in force, then those demanded.
    given: [nc::Filter; 2],
    shapes: [Shape; AXES],
    change: Change,
    /// Whether [`FilterPlan::beyond`] has reported.
    told: bool,
}

impl<'a, const AXES: usize, const TAPS: usize> Bank<'a, AXES, TAPS> {
    /// A bank with the filters of the machine data in force. Call this function before both sides run.
    pub(super) fn new(words: &'a Words<AXES, TAPS>, settings: Settings<AXES>) -> Result<Self, FilterError> {
        let given = [nc::Filter::default(); 2];
        let mut bank =
            Self { words, settings, given, shapes: [Shape::NONE; AXES], change: Change::None, told: false };
        bank.check(&nc::Filter::default())?;
        for axis in 0..AXES {
            bank.write(axis);
        }
        bank.write_channel();
        Ok(bank)
    }

    /// The demanded filters, or those in force if no change is demanded.
    const fn wanted(&self) -> &nc::Filter {
        let [_, wanted] = &self.given;
        wanted
    }

    /// Checks that the memory suffices, and that every axis permits its filter.
    fn check(&self, given: &nc::Filter) -> Result<(), FilterError> {
        self.settings.check::<TAPS>(given)
    }

    /// Delay of the channel in half cycles.
    fn delay(&self, given: &nc::Filter) -> u32 {
        self.settings.delay(given)
    }

    /// Writes the coefficients of an axis.
    fn write(&mut self, axis: usize) {
        let given = self.wanted();
        let (design, delay) = (self.settings.design(axis, given), self.delay(given));
        let (Some(words), Some(reach)) = (self.words.axes.get(axis), self.settings.reach.get(axis)) else {
            return;
        };
        let layout = kernel::build(&design, delay, *reach, words);
        words.set_layout(&layout);
        if let Some(shape) = self.shapes.get_mut(axis) {
            *shape = if design.order > 0 { Shape::of(&layout, words) } else { Shape::NONE };
        }
    }

    /// Writes the words that all axes share.
    fn write_channel(&mut self) {
        let given = *self.wanted();
        let (delay, words) = (self.delay(&given), self.words);
        let layouts = words.axes.iter().map(super::AxisWords::layout);
        let window = layouts.map(|layout| (layout.newest + layout.length).saturating_sub(1));
        words.window.store(window.fold(0, u32::max), Ordering::Relaxed);
        words.delay.store(delay, Ordering::Relaxed);
        let tolerance = design::tolerance(&given).unwrap_or(0) >> COARSE;
        words.tolerance.store(u32::try_from(tolerance).unwrap_or(u32::MAX), Ordering::Relaxed);
        words.runs.store(u32::from(delay > 0), Ordering::Relaxed);
        words.asked.store(words.asked.load(Ordering::Relaxed).wrapping_add(1), Ordering::Release);
        self.told = false;
    }

    /// AX_DEV in force, mm, less the margin for rounding; `None` if not monitored.
    fn tolerance(&self) -> Option<f32> {
        let [in_force, _] = &self.given;
        match design::tolerance(in_force) {
            Ok(bits) if bits > 0 => Some((bits - 8) as f32 * (1.0 / 4_294_967_296.0)),
            _ => None,
        }
    }

    fn ask(&mut self) {
        self.change = Change::Writing(0);
    }
}

impl<const AXES: usize, const TAPS: usize> FilterPlan<AXES> for Bank<'_, AXES, TAPS> {
    const EXIST: bool = true;

    fn command(&mut self, command: &nc::Filter) -> Result<Fate, FilterError> {
        let mut given = *self.wanted();
        design::merge(&mut given, command);
        let on = command.switch == Some(true);
        if on && self.settings.axes.iter().all(|data| data.kind == FilterType::None) {
            return Err(FilterError::NoType);
        }
        self.check(&given)?;
        if given == *self.wanted() {
            return Ok(Fate::Same);
        }
        self.given[1] = given;
        self.ask();
        Ok(if on && self.delay(&given) == 0 { Fate::NoOrder } else { Fate::Changes })
    }

    fn restart(&mut self) {
        if *self.wanted() != nc::Filter::default() {
            self.given[1] = nc::Filter::default();
            self.ask();
        }
    }

    fn cancel(&mut self) {
        if self.change != Change::None {
            self.given[1] = self.given[0];
            self.ask();
        }
    }

    fn suspend(&mut self) {
        if self.words.runs.load(Ordering::Relaxed) != 0 {
            self.words.runs.store(0, Ordering::Release);
            self.ask();
        }
    }

    fn is_pending(&self) -> bool {
        self.change != Change::None
    }

    fn is_settled(&self) -> bool {
        self.words.unsettled.load(Ordering::Acquire) == 0
    }

    fn work(&mut self) -> bool {
        let [asked, done] = [&self.words.asked, &self.words.done].map(|word| word.load(Ordering::Acquire));
        match self.change {
            // The interrupt is still taking earlier coefficients, with earlier positions.
            Change::Writing(0) if asked != done => false,
            Change::Writing(axis) if axis < AXES => {
                self.write(axis);
                self.change = Change::Writing(axis + 1);
                true
            }
            Change::Writing(_) => {
                self.write_channel();
                self.given[0] = self.given[1];
                self.change = Change::Asked;
                true
            }
            Change::Asked => {
                if asked == done {
                    self.change = Change::None;
                }
                asked == done
            }
            Change::None => true,
        }
    }

    fn window(&self) -> u32 {
        self.words.window.load(Ordering::Relaxed)
    }

    fn watch(&self, axis: usize) -> Option<Watch> {
        // Two taps cause no deviation from a delayed set point, but their output is rounded too.
        let shape = self.shapes.get(axis).filter(|shape| shape.window > 0.0)?;
        let [in_force, _] = &self.given;
        let tolerance = self.tolerance().filter(|_| shape.peak > 0.0);
        let limits = tolerance.map(|tolerance| shape.limits(tolerance));
        Some(Watch {
            gain: shape.gain,
            accel: limits.map(|(accel, _)| accel),
            knee: limits.map_or(f32::MAX, |(_, knee)| knee),
            window: shape.window,
            ratio: shape.area / max(shape.peak, f32::MIN_POSITIVE),
            acc_fact: design::acc_fact(in_force),
            tap: shape.tap,
            bound: tolerance.map(|tolerance| shape.bound(tolerance)),
        })
    }

    fn corner(&self, axis: usize, jerk: f32) -> f32 {
        let (Some(shape), Some(words), Some(tolerance)) =
            (self.shapes.get(axis), self.words.axes.get(axis), self.tolerance())
        else {
            return 1.0;
        };
        shape.corner((&words.layout(), words), (shape.limits(tolerance).0, jerk), tolerance)
    }

    fn in_force(&self) -> (u32, Position) {
        let [delay, tolerance, runs] = [&self.words.delay, &self.words.tolerance, &self.words.runs]
            .map(|word| word.load(Ordering::Relaxed));
        let tolerance = Position::from_bits(i64::from(tolerance) << COARSE);
        if runs == 0 { (0, Position::ZERO) } else { (delay, tolerance) }
    }

    fn beyond(&mut self) -> Option<usize> {
        if self.told {
            return None;
        }
        let tolerance = self.words.tolerance.load(Ordering::Relaxed);
        // Both values are rounded. A second difference that bypasses a filter counts as a deviation, also
        // without AX_DEV.
        let most = if tolerance == 0 { u32::MAX - 1 } else { tolerance.saturating_add(1) };
        let beyond = |words: &super::AxisWords<TAPS>| words.deviation.load(Ordering::Relaxed) > most;
        let axis = self.words.axes.iter().position(beyond);
        self.told = axis.is_some();
        axis
    }

    fn deviation(&self, axis: usize) -> Position {
        let words = self.words.axes.get(axis);
        let coarse = words.map_or(0, |words| words.deviation.load(Ordering::Relaxed));
        Position::from_bits(i64::from(coarse) << COARSE)
    }
}

/// The layout of an unfiltered axis in an unfiltered channel.
pub(super) const PLAIN: Layout = Layout { kind: Kind::Delay, newest: 0, length: 1 };
