//! A controller on an STM32F405: a sender on the serial line, step and direction, inputs, spindle.
//!
//! ```text
//!  USART1 ─bytes→ controller ─lines→ machine: planner ─queue→ interpolator ─→ drive ─words→ DMA2 → pins
//!                  (main loop)                                (the tick's interrupt)
//!  pins ──inputs→ latch (the tick, and an interrupt at each edge) ──→ machine, controller
//! ```
//!
//! The main loop runs the controller and the planner. The code of the main loop is in `boards/controller`;
//! the code of the interrupt is in `boards/steps` and the library. Both are tested on the PC. This file
//! contains register accesses, and connects these parts.
#![no_std]
#![no_main]

#[cfg(feature = "hardware")]
#[path = "../clock.rs"]
mod clock;
#[cfg(feature = "hardware")]
mod flash;
mod inputs;
mod machine;
mod outputs;
mod safety;
mod serial;
#[cfg(feature = "qemu")]
#[expect(dead_code, reason = "the tests on the target have more to measure")]
#[path = "../../../../hil-tests/src/stack.rs"]
mod stack;
mod tick;
mod words;

use cortex_m::asm::wfi;
use cortex_m_rt::entry;
use glidepath::channel::{Channel, Handles};
use glidepath::fir::Unfiltered;
use glidepath::machine::MachineData;
use glidepath::nc::DecoderMemory;
use glidepath::tick::Interpolator;
use glidepath_controller::machine::{Carried, Machine, MachineMemory, Spool};
use glidepath_controller::store::Parameters;
use glidepath_controller::{Config, Controller, Look, Message, Motion, Serial, Settings, Signals, State};
use glidepath_copy as _;
use glidepath_steps::Drive;
use machine::{AXES, BLOCKS};
#[cfg(any(feature = "rtt", feature = "qemu"))]
use panic_probe as _;
use serial::{BUFFER, Line};
use static_cell::ConstStaticCell;
use stm32f4::stm32f405::Peripherals;
use tick::{Place, Polarity, Tick};

#[cfg(all(feature = "rtt", not(feature = "qemu")))]
use defmt_rtt as _;
#[cfg(feature = "qemu")]
use defmt_semihosting as _;

/// The memory of the parameter store.
#[cfg(feature = "hardware")]
type Flash = flash::Sectors;
#[cfg(not(feature = "hardware"))]
type Flash = &'static mut glidepath_controller::store::MemoryFlash<8192>;

#[cfg(not(feature = "hardware"))]
static FLASH: ConstStaticCell<glidepath_controller::store::MemoryFlash<8192>> =
    ConstStaticCell::new(glidepath_controller::store::MemoryFlash([0; 8192]));

/// All zero, as `MEMORY`: they take no flash. Both are made anew, as are `DATA`, when settings change machine data.
static CHANNEL: ConstStaticCell<Channel<AXES, BLOCKS, AXES>> = ConstStaticCell::new(Channel::new());
static MEMORY: ConstStaticCell<MachineMemory<AXES>> = ConstStaticCell::new(MachineMemory::new());
static DATA: ConstStaticCell<MachineData<AXES>> = ConstStaticCell::new(machine::BLANK);
static SERIAL: ConstStaticCell<Serial<BUFFER>> = ConstStaticCell::new(Serial::new());

/// Data that stay when settings change.
struct Desk {
    controller: Controller<'static, AXES, BUFFER>,
    line: Line,
    store: Parameters<Flash, AXES>,
    controls: inputs::Controls,
    outputs: outputs::OutputPins,
    watchdog: safety::Watchdog,
    /// Inputs other than limits and probe that are on, as of the last tick.
    signals: Signals,
    counts: tick::Counts,
    faults: u32,
    /// The settings of the current step output.
    made: Settings<AXES>,
}

#[entry]
fn main() -> ! {
    if let (Some(board), Some(channel), Some(memory), Some(data), Some(serial)) =
        (Peripherals::take(), CHANNEL.try_take(), MEMORY.try_take(), DATA.try_take(), SERIAL.try_take())
        && let Some((desk, carried)) = &mut start(board, serial)
    {
        serve(desk, channel, memory, data, carried);
    }
    loop {
        wfi();
    }
}

/// Starts everything except the machine. The stack frames of this call and of the other calls that are not
/// inlined are free again when the machine works.
#[inline(never)]
fn start(board: Peripherals, serial: &'static mut Serial<BUFFER>) -> Option<(Desk, Carried<AXES>)> {
    #[cfg(feature = "hardware")]
    {
        clock::start(&board.RCC, &board.FLASH);
        count_cycles();
    }
    let mut config = Config::new(machine::NAMES);
    (config.settings, config.defaults) = (machine::DEFAULTS, machine::DEFAULTS);
    config.line_numbers = true;
    if safety::was_reset_by_watchdog(&board) {
        config.is_locked = true;
        config.notice =
            Message::try_from("restarted by the watchdog: the position may be lost").unwrap_or_default();
    }
    let outputs = outputs::OutputPins::start(&board);
    inputs::start(&board);
    let (receiver, inbox) = serial.split();
    let line = serial::start(&board, receiver);
    let watchdog = safety::Watchdog::start(&board);
    start_words(&board);
    #[cfg(feature = "hardware")]
    let flash = flash::Sectors::new(board.FLASH);
    #[cfg(not(feature = "hardware"))]
    let flash = FLASH.try_take()?;
    let mut store = Parameters::open(flash).ok()?;
    let stored = store.load(&mut config);
    if !machine::fits(&config.settings) {
        config.settings = config.defaults;
        config.notice = Message::try_from("the stored settings do not fit this build").unwrap_or_default();
    }
    let carried = Carried::new(Place::default(), config.settings, stored);
    let made = carried.settings;
    let (controller, controls) = (Controller::new(inbox, config), inputs::Controls::new());
    let (signals, counts) = (Signals::default(), tick::Counts::default());
    let desk =
        Desk { controller, line, store, controls, outputs, watchdog, signals, counts, faults: 0, made };
    Some((desk, carried))
}

/// Starts the step output with the pins at their idle level.
#[inline(never)]
fn start_words(board: &Peripherals) {
    let settings = machine::DEFAULTS;
    let data = machine::data(&settings);
    if let Ok(steps) = machine::steps(&settings, &data, &Place::default()) {
        words::start(board, steps.rest_word());
    }
}

/// Runs one machine after the other, for ever; in the emulator until `$SLP`.
fn serve(
    desk: &mut Desk,
    channel: &'static mut Channel<AXES, BLOCKS, AXES>,
    memory: &'static mut MachineMemory<AXES>,
    data: &'static mut MachineData<AXES>,
    carried: &mut Carried<AXES>,
) {
    let (channel, memory, data): (
        *mut Channel<AXES, BLOCKS, AXES>,
        *mut MachineMemory<AXES>,
        *mut MachineData<AXES>,
    ) = (channel, memory, data);
    loop {
        // SAFETY: `machine` of the round before is gone, and so is the interrupt's side. Nothing else refers to them.
        let (channel, memory, data) = unsafe { (&mut *channel, &mut *memory, &mut *data) };
        clear(channel, data, carried);
        let goes_on = desk.round(channel, memory, data, carried);
        tick::set(None);
        if !goes_on {
            return;
        }
    }
}

/// The state at power-up, with the machine data of the settings.
#[inline(never)]
fn clear(channel: &mut Channel<AXES, BLOCKS, AXES>, data: &mut MachineData<AXES>, carried: &Carried<AXES>) {
    *data = machine::data(&carried.settings);
    // A constant is copied to its place at once. What a call returns is on the stack first, and has no room there.
    *channel = const { Channel::new() };
}

/// A machine at the position of the previous machine, and the data of the interrupt.
#[inline(never)]
fn make(
    channel: &'static mut Channel<AXES, BLOCKS, AXES>,
    memory: &'static mut MachineMemory<AXES>,
    data: &'static MachineData<AXES>,
    carried: &Carried<AXES>,
) -> Option<(Machine<'static, AXES, BLOCKS, AXES>, Interpolator<'static, AXES, Unfiltered, AXES>)> {
    let parts = memory.split();
    match channel.split(data, carried.position, parts.0) {
        Ok(handles) => Some(joined(handles, parts, data, carried)),
        Err(_) => None,
    }
}

/// Makes a machine from the handles of its channel.
#[inline(never)]
fn joined(
    handles: Handles<'static, &'static Spool, AXES, BLOCKS, Unfiltered, Unfiltered, AXES>,
    parts: (&'static Spool, &'static mut DecoderMemory<AXES>),
    data: &'static MachineData<AXES>,
    carried: &Carried<AXES>,
) -> (Machine<'static, AXES, BLOCKS, AXES>, Interpolator<'static, AXES, Unfiltered, AXES>) {
    Machine::new(handles, parts, data, carried)
}

impl Desk {
    /// Runs until settings need another machine. `false`: the machine data are not possible, or the emulator
    /// ends.
    #[inline(never)]
    fn round(
        &mut self,
        channel: &'static mut Channel<AXES, BLOCKS, AXES>,
        memory: &'static mut MachineMemory<AXES>,
        data: &'static MachineData<AXES>,
        carried: &mut Carried<AXES>,
    ) -> bool {
        let mut made = make(channel, memory, data, carried);
        let Some((ref mut machine, interpolator)) = made else { return false };
        if self.start_tick(interpolator, data, carried).is_none() {
            return false;
        }
        machine.set_fits(machine::check);
        loop {
            self.turn(machine);
            self.change_steps(machine, data);
            if goes_on(machine, carried) {
                return true;
            }
            #[cfg(feature = "qemu")]
            if self.controller.state(&machine.status()) == State::Sleep {
                report();
                return false;
            }
        }
    }

    /// Passes the interrupt its data.
    #[inline(never)]
    fn start_tick(
        &mut self,
        interpolator: Interpolator<'static, AXES, Unfiltered, AXES>,
        data: &MachineData<AXES>,
        carried: &Carried<AXES>,
    ) -> Option<()> {
        let steps = machine::steps(&carried.settings, data, &carried.position).ok()?;
        let drive = Drive::new(steps, data, carried.position);
        (self.made, self.faults) = (carried.settings, 0);
        let polarity = polarity(&carried.settings, false);
        tick::set(Some(Tick::new(interpolator, drive, polarity, self.counts)));
        Some(())
    }

    /// Runs the main loop once.
    #[inline(never)]
    fn turn(&mut self, machine: &mut Machine<'static, AXES, BLOCKS, AXES>) {
        let Some((latch, faults, counts)) = tick::with(|tick| tick.seen()) else { return };
        let is_new = core::mem::replace(&mut self.counts, counts).ticks != counts.ticks;
        if is_new {
            self.signals = self.controls.look();
        }
        if core::mem::replace(&mut self.faults, faults) != faults {
            machine.fault();
        }
        machine.service(&latch);
        let signals = self.signals.and(latch.signals());
        // A tick is a millisecond.
        let look = Look { now_ms: counts.ticks, signals, motion: machine, store: &mut self.store };
        let Ok(()) = self.controller.poll(look, &mut self.line);
        machine.service(&latch);
        let settings = self.controller.settings();
        let is_homing = self.controller.state(&machine.status()) == State::Home;
        let polarity = polarity(settings, is_homing);
        let _ = tick::with(|tick| tick.polarity = polarity);
        self.outputs.put(self.controller.outputs(), settings.enable_inverted);
        self.watchdog.feed(counts.ticks);
        if !is_new {
            wfi();
        }
    }

    /// If settings change only the step output, they act at standstill, without another machine.
    #[inline(never)]
    fn change_steps(&mut self, machine: &Machine<'static, AXES, BLOCKS, AXES>, data: &MachineData<AXES>) {
        let (status, settings) = (machine.status(), self.controller.settings());
        if machine::same_steps(settings, &self.made) || status.is_busy || !status.is_at_rest {
            return;
        }
        self.made = *settings;
        // The settings were checked before they were stored.
        if let Ok(steps) = machine::steps(settings, data, &status.position) {
            let drive = Drive::new(steps, data, status.position);
            self.faults = 0;
            let _ = tick::with(|tick| tick.change(drive));
        }
    }
}

/// Whether settings need another machine; `carried` then has the state for this machine.
#[inline(never)]
fn goes_on(machine: &mut Machine<'static, AXES, BLOCKS, AXES>, carried: &mut Carried<AXES>) -> bool {
    machine.successor().map(|next| *carried = next).is_some()
}

/// Active levels and reactions for the interrupt, from the settings.
fn polarity(settings: &Settings<AXES>, is_homing: bool) -> Polarity {
    Polarity {
        limits_high: settings.limits_inverted,
        probe_high: settings.probe_inverted,
        limits_cut: settings.limits_cut_steps && !is_homing,
    }
}

/// The cycle counter, which measures the longest interrupt.
#[cfg(feature = "hardware")]
fn count_cycles() {
    if let Some(mut core) = cortex_m::Peripherals::take() {
        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();
    }
}

/// Ends the emulator after a line of figures.
#[cfg(feature = "qemu")]
fn report() {
    use cortex_m_semihosting::{debug, heprintln};
    let seen = tick::with(|tick| (tick.counts, tick.positions()));
    let (size, stack) = stack::depth();
    if let Some((tick::Counts { ticks, active, missed, longest }, [x, y, z])) = seen {
        heprintln!(
            "ticks {ticks} active {active} missed {missed} longest {longest} x {x} y {y} z {z} stack {stack} of {size}"
        );
    }
    debug::exit(debug::EXIT_SUCCESS);
}
