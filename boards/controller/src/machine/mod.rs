//! Glidepath's planner, interpolator and operator as the motion side of the protocol.
//!
//! ```text
//!  lines → scan → spool → planner → queue → interpolator (timer interrupt)
//!            │                                   │ set points, inputs
//!            └ probing, homing ←───── latch ←────┘
//! ```
//!
//! The decoder of the library reads the lines, in the dialect of Grbl. This module knows of a line only what the
//! protocol needs: whether it is answered at rest, and whether it probes.
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

/// Calls of the planner in a row.
const CALLS: usize = 64;

/// What the words of lines have left, beside what the decoder knows.
#[derive(Clone, Copy)]
pub struct Kept<const AXES: usize> {
    /// Modal words, F, T, G92, tool length.
    force: InForce<AXES>,
    /// S.
    rpm: u32,
    /// M7.
    mist: bool,
    /// M8.
    flood: bool,
    /// M0, M2, M30 while they are active.
    program: Option<u8>,
    /// G38 is the motion word in force.
    probing: Option<Probing>,
    /// Where the last probing motion ended, and whether it was contact.
    probe: ([Position; AXES], bool),
}

impl<const AXES: usize> Kept<AXES> {
    /// At power-up.
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

/// What a machine hands on to the one that follows it, with other machine data.
#[derive(Clone, Copy)]
pub struct Carried<const AXES: usize> {
    /// What words have left.
    pub kept: Kept<AXES>,
    /// What G10, G28.1 and G30.1 have stored.
    pub stored: StoredOffsets<AXES>,
    /// Machine coordinates of the axes.
    pub position: [Position; AXES],
    /// Settings in force.
    pub settings: Settings<AXES>,
    /// Spindle and coolant as they are.
    switched: Switched,
}

impl<const AXES: usize> Carried<AXES> {
    /// A machine that stands at `position` at power-up. `stored` comes from the parameter store.
    pub const fn new(
        position: [Position; AXES],
        settings: Settings<AXES>,
        stored: StoredOffsets<AXES>,
    ) -> Self {
        Self { kept: Kept::START, stored, position, settings, switched: Switched::OFF }
    }
}

/// What the functions of the program have switched, at their points of the path.
#[derive(Clone, Copy)]
struct Switched {
    spindle: Spindle,
    rpm: u32,
    mist: bool,
    flood: bool,
    /// M0, M1, M6 or M60 that waits for a start.
    paused: Option<u16>,
    program_ends: u8,
}

impl Switched {
    const OFF: Self =
        Self { spindle: Spindle::Off, rpm: 0, mist: false, flood: false, paused: None, program_ends: 0 };
}

/// Cycles that need inputs, and what they have to tell.
#[derive(Clone, Copy)]
struct Cycles<const AXES: usize> {
    homing: Option<Homing<AXES>>,
    /// How the last homing cycle ended.
    homed: crate::motion::Homing,
    probe: Option<ProbeCycle<AXES>>,
    alarm: Option<u8>,
    /// A probing motion has ended, and the sender is not told yet.
    probe_ended: bool,
    is_jogging: bool,
}

/// Memory of a [`Machine`] beside the channel.
pub struct MachineMemory<const AXES: usize> {
    spool: Spool,
    checker: DecoderMemory<AXES>,
}

impl<const AXES: usize> MachineMemory<AXES> {
    /// Nothing is in it.
    pub const fn new() -> Self {
        Self { spool: Spool::new(), checker: DecoderMemory::new() }
    }

    /// The text that the channel is split with, and the rest for [`Machine::new`].
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

/// The machine data of a build as a controller needs them: programs are Grbl's.
#[must_use]
pub fn controller_data<const AXES: usize>(base: &MachineData<AXES>) -> MachineData<AXES> {
    let mut data = *base;
    data.channel.foreign.dialect = Dialect::Grbl;
    data
}

/// Planner and operator as one thing that executes lines.
pub struct Machine<'a, const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> {
    planner: Planner<'a, &'a Spool, AXES, BLOCKS, Unfiltered, OVERLAYS>,
    operator: Operator<'a, AXES>,
    spool: &'a Spool,
    checker: &'a mut DecoderMemory<AXES>,
    data: &'a MachineData<AXES>,
    settings: Settings<AXES>,
    /// Other settings are to be in force: the machine is made anew.
    next: Option<Settings<AXES>>,
    kept: Kept<AXES>,
    /// In force in check mode.
    checked: Option<InForce<AXES>>,
    line: Offered,
    switched: Switched,
    cycles: Cycles<AXES>,
    inputs: Latch<AXES>,
    overrides: Overrides,
    fits: Fits<AXES>,
}

/// Whether a board can do what settings ask for, and in words why not. The machine data are those of the settings.
pub type Fits<const AXES: usize> = fn(&Settings<AXES>, &MachineData<AXES>) -> Result<(), Message>;

impl<'a, const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> Machine<'a, AXES, BLOCKS, OVERLAYS> {
    /// Of the handles of a channel that was split for `data` with the spool of the same memory, at
    /// `carried.position`. The interpolator comes back, for the timer interrupt.
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
        // Offsets out of range are left out: the store had others.
        let _ = machine.planner.put_stored(stored);
        machine.restore();
        (machine, interpolator)
    }

    /// What the machine that follows has to know, if settings ask for one. Call it at rest, make the channel anew with
    /// [`Settings::onto`], and make another machine.
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

    /// What a board can do beside the planner: settings that it cannot have are refused with `error:12` and these words.
    pub fn set_fits(&mut self, fits: Fits<AXES>) {
        self.fits = fits;
    }

    /// A fault of the drives: `ALARM:17`, and everything brakes.
    pub fn fault(&mut self) {
        self.cycles.alarm = Some(17);
    }

    /// What G10, G28.1 and G30.1 have stored, for the parameter store.
    pub fn stored(&self) -> StoredOffsets<AXES> {
        self.planner.stored()
    }

    fn names(&self) -> [AxisName; AXES] {
        self.data.axes.each_ref().map(|axis| axis.name)
    }

    /// Lets the planner work, and looks at functions that are due and at inputs. Call it as often as the planner is to
    /// be called. `inputs` is what the timer interrupt has latched.
    pub fn service(&mut self, inputs: &Latch<AXES>) {
        self.inputs = *inputs;
        self.switch();
        self.choose_override();
        self.work();
        self.follow_homing();
        self.follow_probe();
    }

    /// Functions whose point of the path is reached.
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
                Function::M(code @ (0 | 1 | 6 | 60)) if output.waits => {
                    switched.paused = Some(code);
                    continue;
                }
                _ => {}
            }
            if output.waits {
                // Nothing is behind it that could fail.
                let _ = self.operator.acknowledge(output.function);
            }
        }
    }

    /// Rapid motion has an override of its own; jogs, probing and homing have none.
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
        // In 0.1 %.
        self.operator.set_override(u16::from(percent) * 10);
    }

    /// Whether something moves, or will by lines that are taken; or the next line is not read yet.
    fn is_under_way(&self) -> bool {
        self.moves() || self.line.end.is_some()
    }

    /// Whether something moves, or will by lines that are taken. A pause at the end of all motion is one of them.
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

    /// Behind the end of a text, at rest.
    fn go_on(&mut self) {
        if self.cycles.homing.is_some() {
            // Axes move alone.
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
        let goes_on = match self.line.end {
            Some(End::Refused) => self.planner.go_on().is_ok() || self.planner.load_next().is_ok(),
            _ => self.planner.load_next().is_ok(),
        };
        if goes_on {
            self.line.end = None;
            self.restore();
        }
    }

    /// What is kept is in force again.
    fn restore(&mut self) {
        // Behind a text that ended no line is at hand.
        let _ = self.planner.put_in_force(&self.kept.force);
    }
}
