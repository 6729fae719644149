//! The work of the timer interrupt, without registers: interpolator, step output, latch of the inputs.
use crate::machine::{AXES, LOOKS, SLOTS};
use core::cell::RefCell;
use critical_section::Mutex;
use glidepath::fir::Unfiltered;
use glidepath::quantity::Position;
use glidepath::tick::{Interpolator, State};
use glidepath_controller::Signals;
use glidepath_controller::machine::Latch;
use glidepath_steps::Drive;

/// Active levels of the inputs, according to the settings.
#[derive(Clone, Copy, Default)]
pub struct Polarity {
    /// `$5`: the limits are active high.
    pub limits_high: bool,
    /// `$6`: the probe is active high.
    pub probe_high: bool,
    /// `$21=2`, and the axes are not homing: a limit switch stops the steps at once.
    pub limits_cut: bool,
}

/// Counters of the interrupt.
#[derive(Clone, Copy, Default)]
pub struct Counts {
    /// Number of ticks.
    pub ticks: u32,
    /// Number of ticks in which an axis moved.
    pub active: u32,
    /// Number of ticks that came during the computation of the previous tick.
    pub missed: u32,
    /// The longest interrupt: instructions in the emulator, periods of the timer's clock on a board.
    pub longest: u32,
}

/// All data of the interrupt.
pub struct Tick {
    interpolator: Interpolator<'static, AXES, Unfiltered, AXES>,
    drive: Drive<AXES, SLOTS>,
    latch: Latch<AXES>,
    /// Limits that were on at the last tick.
    limits: Signals,
    /// Number of times that a limit switch has stopped the steps.
    cuts: u32,
    /// Data that the task writes.
    pub polarity: Polarity,
    /// Data that the task reads.
    pub counts: Counts,
}

impl Tick {
    /// Makes the data at standstill; `counts` continue.
    pub fn new(
        interpolator: Interpolator<'static, AXES, Unfiltered, AXES>,
        drive: Drive<AXES, SLOTS>,
        polarity: Polarity,
        counts: Counts,
    ) -> Self {
        let (latch, limits) = (Latch::new(LOOKS), Signals::default());
        Self { interpolator, drive, latch, limits, cuts: 0, polarity, counts }
    }

    /// Replaces the step data, at standstill.
    pub fn change(&mut self, drive: Drive<AXES, SLOTS>) {
        (self.drive, self.cuts) = (drive, 0);
    }

    /// Does the work of a tick: computes the words of the next tick, then the next set points, and samples
    /// the inputs.
    pub fn run(&mut self, words: &mut [u32; SLOTS], inputs: impl FnOnce(Polarity) -> Signals) {
        let done = self.drive.tick(&mut self.interpolator, words);
        self.latch.look(inputs(self.polarity), self.drive.here());
        let limits = self.latch.signals();
        if limits.since(self.limits).has_limit() && self.polarity.limits_cut {
            let before = self.drive.losses();
            self.drive.cut();
            self.cuts = self.cuts.wrapping_add(self.drive.losses().wrapping_sub(before));
        }
        self.limits = limits;
        self.counts.ticks = self.counts.ticks.wrapping_add(1);
        self.counts.active = self.counts.active.wrapping_add(u32::from(done.motion != State::Idle));
    }

    /// Latches a changed input. `slot` words of this tick are already output.
    #[cfg(feature = "hardware")]
    pub fn edge(&mut self, slot: u16, inputs: impl FnOnce(Polarity) -> Signals) {
        let at = glidepath_controller::machine::between(
            self.drive.here(),
            self.drive.under_way(),
            slot,
            SLOTS as u16,
        );
        self.latch.edge(inputs(self.polarity), &at);
    }

    /// Returns the latch, and the number of ticks whose steps did not fit; for the task. A stop by a limit
    /// switch does not count.
    pub fn seen(&self) -> (Latch<AXES>, u32, Counts) {
        (self.latch, self.drive.losses().wrapping_sub(self.cuts), self.counts)
    }

    /// Number of steps output for each axis, counts.
    #[cfg(feature = "qemu")]
    pub fn positions(&self) -> [i64; AXES] {
        core::array::from_fn(|axis| self.drive.steps().count(axis))
    }
}

/// The data of the interrupt, while a machine exists. Interrupts and task borrow the data in critical
/// sections.
static TICK: Mutex<RefCell<Option<Tick>>> = Mutex::new(RefCell::new(None));

/// Calls a function with the data of the interrupt. `None`: there is no machine now.
pub fn with<R>(what: impl FnOnce(&mut Tick) -> R) -> Option<R> {
    critical_section::with(|cs| TICK.borrow(cs).try_borrow_mut().ok()?.as_mut().map(what))
}

/// Sets or removes the data of the interrupt.
pub fn set(tick: Option<Tick>) {
    critical_section::with(|cs| {
        if let Ok(mut place) = TICK.borrow(cs).try_borrow_mut() {
            *place = tick;
        }
    });
}

/// Machine coordinates at standstill.
pub type Place = [Position; AXES];
