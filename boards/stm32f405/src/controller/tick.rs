//! What the timer interrupt has: interpolator, step output, latch of the inputs. No register is touched here.
use crate::machine::{AXES, LOOKS, SLOTS};
use core::cell::RefCell;
use critical_section::Mutex;
use glidepath::fir::Unfiltered;
use glidepath::quantity::Position;
use glidepath::tick::{Interpolator, State};
use glidepath_controller::Signals;
use glidepath_controller::machine::Latch;
use glidepath_steps::Drive;

/// Levels that mean "on", as the settings have them.
#[derive(Clone, Copy, Default)]
pub struct Polarity {
    /// `$5`: limits are on where their pin is high.
    pub limits_high: bool,
    /// `$6`: the probe.
    pub probe_high: bool,
    /// `$21=2`, and the axes are not homing: a limit switch cuts the steps.
    pub limits_cut: bool,
}

/// Counts of the interrupt.
#[derive(Clone, Copy, Default)]
pub struct Counts {
    /// Ticks.
    pub ticks: u32,
    /// Ticks that moved axes.
    pub active: u32,
    /// Ticks that came while the one before was computed.
    pub missed: u32,
    /// The longest interrupt: in the emulator instructions, on a board periods of the timer's clock.
    pub longest: u32,
}

/// Everything of the interrupt.
pub struct Tick {
    interpolator: Interpolator<'static, AXES, Unfiltered, AXES>,
    drive: Drive<AXES, SLOTS>,
    latch: Latch<AXES>,
    /// Limits that were on.
    limits: Signals,
    /// Times that a limit switch has cut the steps.
    cuts: u32,
    /// What the task has set.
    pub polarity: Polarity,
    /// What the task reads.
    pub counts: Counts,
}

impl Tick {
    /// At rest; `counts` go on.
    pub fn new(
        interpolator: Interpolator<'static, AXES, Unfiltered, AXES>,
        drive: Drive<AXES, SLOTS>,
        polarity: Polarity,
        counts: Counts,
    ) -> Self {
        let (latch, limits) = (Latch::new(LOOKS), Signals::default());
        Self { interpolator, drive, latch, limits, cuts: 0, polarity, counts }
    }

    /// Other step data, at rest.
    pub fn change(&mut self, drive: Drive<AXES, SLOTS>) {
        (self.drive, self.cuts) = (drive, 0);
    }

    /// A tick: the words for the next one, the set points behind them, and a look at the inputs.
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

    /// An input has changed while so many slots of the words had gone out.
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

    /// For the task: what was latched, and how often steps had no room. A cut by a limit switch is no such fault.
    pub fn seen(&self) -> (Latch<AXES>, u32, Counts) {
        (self.latch, self.drive.losses().wrapping_sub(self.cuts), self.counts)
    }

    /// Steps put out by each axis, counts.
    #[cfg(feature = "qemu")]
    pub fn positions(&self) -> [i64; AXES] {
        core::array::from_fn(|axis| self.drive.steps().count(axis))
    }
}

/// The interrupt's, while there is a machine. Interrupts and task borrow it inside critical sections.
static TICK: Mutex<RefCell<Option<Tick>>> = Mutex::new(RefCell::new(None));

/// Does something with the interrupt's side. `None`: there is no machine now.
pub fn with<R>(what: impl FnOnce(&mut Tick) -> R) -> Option<R> {
    critical_section::with(|cs| TICK.borrow(cs).try_borrow_mut().ok()?.as_mut().map(what))
}

/// Hands the interrupt's side over, or takes it away.
pub fn set(tick: Option<Tick>) {
    critical_section::with(|cs| {
        if let Ok(mut place) = TICK.borrow(cs).try_borrow_mut() {
            *place = tick;
        }
    });
}

/// Machine coordinates at rest.
pub type Place = [Position; AXES];
