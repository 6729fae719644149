//! The motion side of the Grbl protocol: the machine that moves, made of Glidepath's planner, interpolator
//! and operator.
//!
//! ```text
//!  lines → scan → spool → planner → queue → interpolator (timer interrupt)
//!            │                                   │ set points, inputs
//!            └ probing, homing ←───── latch ←────┘
//! ```
//!
//! Glidepath's decoder reads the lines, in the dialect of Grbl. This module only finds out whether a line is
//! answered at standstill, and whether the line probes.
mod homing;
mod latch;
mod offered;
mod probe;
mod refusal;
mod scan;
mod side;
mod spool;

pub use latch::{Edge, Latch, between};
pub use scan::{Probing, Scan};
pub use spool::Spool;

use crate::motion::{Message, Overrides, Spindle};
use crate::settings::Settings;
use glidepath::channel::{Handles, Planner, Progress};
use glidepath::fir::Unfiltered;
use glidepath::machine::{AxisName, Dialect, MachineData};
use glidepath::nc::{DecoderMemory, InForce, StoredOffsets};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::technology::Function;
use glidepath::tick::{Interpolator, State};
use homing::Homing;
use offered::{End, Offered};
use probe::ProbeCycle;

/// A sender that streams has sent the next line within this time, in microseconds.
const LATE_US: u32 = 100_000;

/// Calls of the planner in a row.
const CALLS: usize = 64;

/// State that the words of lines leave, in addition to the state of the decoder.
#[derive(Clone, Copy)]
pub struct Kept<const AXES: usize> {
    /// Modal words, F, T, G92, tool length.
    force: InForce<AXES>,
    /// Spindle speed S.
    rpm: u32,
    /// Whether M7 is on.
    mist: bool,
    /// Whether M8 is on.
    flood: bool,
    /// M0, M2 or M30 while the word is active.
    program: Option<u8>,
    /// G38 is the active motion word.
    probing: Option<Probing>,
    /// End position of the last probing motion, and whether the probe had contact.
    probe: ([Position; AXES], bool),
}

impl<const AXES: usize> Kept<AXES> {
    /// The state at power-up.
    pub const START: Self = Self {
        force: InForce::START,
        rpm: 0,
        mist: false,
        flood: false,
        program: None,
        probing: None,
        probe: ([Position::ZERO; AXES], false),
    };
}

/// State that a machine passes to its successor with other machine data.
#[derive(Clone, Copy)]
pub struct Carried<const AXES: usize> {
    /// State that words have left.
    pub kept: Kept<AXES>,
    /// Values that G10, G28.1 and G30.1 have stored.
    pub stored: StoredOffsets<AXES>,
    /// Machine coordinates of the axes.
    pub position: [Position; AXES],
    /// Active settings.
    pub settings: Settings<AXES>,
    /// Current state of spindle and coolant.
    switched: Switched,
}

impl<const AXES: usize> Carried<AXES> {
    /// A machine at `position` at power-up. `stored` comes from the parameter store.
    pub const fn new(
        position: [Position; AXES],
        settings: Settings<AXES>,
        stored: StoredOffsets<AXES>,
    ) -> Self {
        Self { kept: Kept::START, stored, position, settings, switched: Switched::OFF }
    }
}

/// Outputs that functions of the program have switched, at their points of the path.
#[derive(Clone, Copy)]
struct Switched {
    spindle: Spindle,
    rpm: u32,
    mist: bool,
    flood: bool,
    /// M0, M1, M6 or M60 that waits for a cycle start.
    paused: Option<u16>,
    program_ends: u8,
}

impl Switched {
    const OFF: Self =
        Self { spindle: Spindle::Off, rpm: 0, mist: false, flood: false, paused: None, program_ends: 0 };
}

/// Cycles that need inputs, and their results.
#[derive(Clone, Copy)]
struct Cycles<const AXES: usize> {
    homing: Option<Homing<AXES>>,
    /// Result of the last homing cycle.
    homed: crate::motion::Homing,
    probe: Option<ProbeCycle<AXES>>,
    alarm: Option<u8>,
    /// A probing motion has ended, and the result is not reported yet.
    probe_ended: bool,
    is_jogging: bool,
}

/// Memory of a [`Machine`] in addition to the channel.
pub struct MachineMemory<const AXES: usize> {
    spool: Spool,
    checker: DecoderMemory<AXES>,
}

impl<const AXES: usize> MachineMemory<AXES> {
    /// Empty memory.
    pub const fn new() -> Self {
        Self { spool: Spool::new(), checker: DecoderMemory::new() }
    }

    /// The text for `Channel::split`, and the other parts for [`Machine::new`].
    pub fn split(&mut self) -> (&Spool, &mut DecoderMemory<AXES>) {
        self.spool = Spool::new();
        (&self.spool, &mut self.checker)
    }
}

impl<const AXES: usize> Default for MachineMemory<AXES> {
    fn default() -> Self {
        Self::new()
    }
}

/// Machine data for a controller, whose programs have the dialect of Grbl.
#[must_use]
pub fn controller_data<const AXES: usize>(base: &MachineData<AXES>) -> MachineData<AXES> {
    let mut data = *base;
    data.channel.foreign.dialect = Dialect::Grbl;
    data
}

/// Planner and operator as one object that executes lines.
pub struct Machine<'a, const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> {
    planner: Planner<'a, &'a Spool, AXES, BLOCKS, Unfiltered, OVERLAYS>,
    operator: Operator<'a, AXES>,
    spool: &'a Spool,
    checker: &'a mut DecoderMemory<AXES>,
    data: &'a MachineData<AXES>,
    settings: Settings<AXES>,
    /// Other settings must become active: the board makes a new machine.
    next: Option<Settings<AXES>>,
    kept: Kept<AXES>,
    /// The active modal state in check mode.
    checked: Option<InForce<AXES>>,
    line: Offered,
    switched: Switched,
    cycles: Cycles<AXES>,
    inputs: Latch<AXES>,
    overrides: Overrides,
    fits: Fits<AXES>,
}

/// Checks whether a board supports settings, and returns the reason if not. The machine data belong to the
/// settings.
pub type Fits<const AXES: usize> = fn(&Settings<AXES>, &MachineData<AXES>) -> Result<(), Message>;

impl<'a, const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> Machine<'a, AXES, BLOCKS, OVERLAYS> {
    /// Makes a machine from the handles of a channel, which was split for `data` with the spool of the same
    /// memory, at `carried.position`. Returns the machine, and the interpolator for the timer interrupt.
    pub fn new(
        handles: Handles<'a, &'a Spool, AXES, BLOCKS, Unfiltered, Unfiltered, OVERLAYS>,
        (spool, checker): (&'a Spool, &'a mut DecoderMemory<AXES>),
        data: &'a MachineData<AXES>,
        carried: &Carried<AXES>,
    ) -> (Self, Interpolator<'a, AXES, Unfiltered, OVERLAYS>) {
        let Handles { planner, interpolator, operator } = handles;
        let Carried { kept, stored, settings, switched, .. } = carried;
        let mut machine = Self {
            planner,
            operator,
            spool,
            checker,
            data,
            settings: *settings,
            next: None,
            kept: *kept,
            checked: None,
            line: Offered::NONE,
            switched: *switched,
            cycles: Cycles {
                homing: None,
                homed: crate::motion::Homing::Done,
                probe: None,
                alarm: None,
                probe_ended: false,
                is_jogging: false,
            },
            inputs: Latch::new(1),
            overrides: Overrides::FULL,
            fits: |_, _| Ok(()),
        };
        // Offsets out of range are left out, because the store had other data.
        let _ = machine.planner.put_stored(stored);
        machine.restore();
        (machine, interpolator)
    }

    /// Returns the state for the next machine, if settings need a new machine. Call `successor` at
    /// standstill. Then make a new channel with [`Settings::onto`], and a new machine.
    pub fn successor(&mut self) -> Option<Carried<AXES>> {
        if self.is_under_way() {
            return None;
        }
        let settings = self.next.take()?;
        Some(Carried {
            kept: self.kept,
            stored: self.planner.stored(),
            position: *self.planner.position(),
            settings,
            switched: self.switched,
        })
    }

    /// Sets a check of settings by the board. Settings that the board refuses give `error:12` and the words
    /// of the check.
    pub fn set_fits(&mut self, fits: Fits<AXES>) {
        self.fits = fits;
    }

    /// Reports a fault of the drives: `ALARM:17`, and the axes brake.
    pub fn fault(&mut self) {
        self.cycles.alarm = Some(17);
    }

    /// Returns the values that G10, G28.1 and G30.1 have stored, for the parameter store.
    pub fn stored(&self) -> StoredOffsets<AXES> {
        self.planner.stored()
    }

    fn names(&self) -> [AxisName; AXES] {
        self.data.axes.each_ref().map(|axis| axis.name)
    }

    /// Calls the planner, and handles due functions and inputs. Call `service` as often as the planner must
    /// be called. `inputs` has the latched positions of the timer interrupt.
    pub fn service(&mut self, inputs: &Latch<AXES>) {
        self.inputs = *inputs;
        self.switch();
        self.choose_override();
        self.go_without(if self.cycles.is_jogging { 0 } else { LATE_US });
        self.work();
        self.follow_homing();
        self.follow_probe();
    }

    /// Handles functions whose point of the path is reached.
    fn switch(&mut self) {
        while let Some(output) = self.operator.output() {
            self.line.pauses &= !matches!(output.function, Function::M(0 | 1 | 6 | 60));
            let switched = &mut self.switched;
            match output.function {
                Function::M(3) => switched.spindle = Spindle::Clockwise,
                Function::M(4) => switched.spindle = Spindle::CounterClockwise,
                Function::M(5) => switched.spindle = Spindle::Off,
                Function::M(7) => switched.mist = true,
                Function::M(8) => switched.flood = true,
                Function::M(9) => (switched.mist, switched.flood) = (false, false),
                Function::Spindle(speed) => switched.rpm = speed.saturating_to_num::<u32>(),
                // An abort has dropped the lines behind the pause: a stop that was already planned may still
                // reach the point of the pause, and no cycle start would come.
                Function::M(0 | 1 | 6 | 60) if self.line.end == Some(End::Aborted) => continue,
                Function::M(code @ (0 | 1 | 6 | 60)) if output.waits => {
                    switched.paused = Some(code);
                    continue;
                }
                _ => {}
            }
            if output.waits {
                // No later text can fail.
                let _ = self.operator.acknowledge(output.function);
            }
        }
    }

    /// Chooses the override: rapid motion has a separate one; jogs, probing and homing have none.
    fn choose_override(&mut self) {
        let is_rapid = self.operator.status().n & 1 == 1;
        self.set_override(is_rapid);
    }

    fn set_override(&mut self, is_rapid: bool) {
        let cycles = &self.cycles;
        let percent = match is_rapid {
            _ if cycles.homing.is_some() || cycles.probe.is_some() || cycles.is_jogging => 100,
            true => self.overrides.rapid,
            false => self.overrides.feed,
        };
        // Overrides in 0.1 %.
        self.operator.set_override(u16::from(percent) * 10);
    }

    /// Whether an axis moves, or will move by accepted lines, or the next line is not read yet.
    fn is_under_way(&self) -> bool {
        self.moves() || self.line.end.is_some()
    }

    /// Whether an axis moves, or will move by accepted lines. A pause at the end of all motion counts as such
    /// a line.
    fn moves(&self) -> bool {
        let is_moving = self.operator.status().state != State::Idle || !self.planner.is_at_rest();
        is_moving || self.line.offered || self.line.pauses || self.switched.paused.is_some()
    }

    fn work(&mut self) {
        for _ in 0..CALLS {
            match self.planner.poll() {
                Ok(Progress::Waiting) => break,
                Ok(Progress::Done) => {
                    self.go_on();
                    break;
                }
                Ok(_) => {}
                Err(error) => {
                    self.line.error = Some(error);
                    self.line.end = Some(End::Refused);
                }
            }
        }
    }

    /// Continues after the end of a text, at standstill.
    fn go_on(&mut self) {
        if self.cycles.homing.is_some() {
            // A single axis moves independently of the path.
            return;
        }
        if self.line.end.is_none() {
            self.line.end = Some(End::Program);
            if let Some(force) = self.planner.in_force() {
                self.kept.force = force;
            }
        }
        if !self.planner.is_at_rest() || self.operator.status().state != State::Idle {
            return;
        }
        // Functions of the text that has ended, while its end is still known.
        self.switch();
        let goes_on = match self.line.end {
            Some(End::Refused) => self.planner.go_on().is_ok() || self.planner.load_next().is_ok(),
            _ => self.planner.load_next().is_ok(),
        };
        if goes_on {
            self.line.end = None;
            self.restore();
        }
    }

    /// Makes the kept state active again.
    fn restore(&mut self) {
        // After a text that ended there is no current line.
        let _ = self.planner.put_in_force(&self.kept.force);
    }
}
