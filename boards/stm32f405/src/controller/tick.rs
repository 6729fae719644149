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
#[derive(Clone, Copy)]
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
    /// What the task has set.
    pub polarity: Polarity,
    /// What the task reads.
    pub counts: Counts,
}

impl Tick {
    /// At rest.
    pub fn new(
        interpolator: Interpolator<'static, AXES, Unfiltered, AXES>,
        drive: Drive<AXES, SLOTS>,
        polarity: Polarity,
    ) -> Self {
        let counts = Counts { ticks: 0, active: 0, missed: 0, longest: 0 };
        Self { interpolator, drive, latch: Latch::new(LOOKS), polarity, counts }
    }

    /// A tick: the words for the next one, the set points behind them, and a look at the inputs.
    pub fn run(&mut self, words: &mut [u32; SLOTS], inputs: impl FnOnce(Polarity) -> Signals) {
        let done = self.drive.tick(&mut self.interpolator, words);
        self.latch.look(inputs(self.polarity), self.drive.here());
        if self.polarity.limits_cut && self.latch.signals().has_limit() {
            self.drive.cut();
        }
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

    /// For the task: what was latched, and how often steps were cut.
    pub fn seen(&self) -> (Latch<AXES>, u32, Counts) {
        (self.latch, self.drive.losses(), self.counts)
    }

    /// Steps put out by each axis, counts.
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
