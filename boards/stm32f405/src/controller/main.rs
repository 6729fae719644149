//! A controller on an STM32F405: a sender on the serial line, step and direction, inputs, spindle.
//!
//! ```text
//!  USART1 ─bytes→ controller ─lines→ machine: planner ─queue→ interpolator ─→ drive ─words→ DMA2 → pins
//!                  (main loop)                                (the tick's interrupt)
//!  pins ──inputs→ latch (the tick, and an interrupt at each edge) ──→ machine, controller
//! ```
//!
//! The main loop talks and plans. What it calls is in `boards/controller`, and what the interrupt calls is in
//! `boards/steps` and the library; both are tested on the desktop. Here are registers, and the wiring of these parts.
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
mod tick;
mod words;

use cortex_m::asm::wfi;
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use glidepath::machine::MachineData;
use glidepath_controller::machine::{Carried, Machine, MachineMemory};
use glidepath_controller::store::Parameters;
use glidepath_controller::{
    Config, Controller, Look, Message, Motion, Serial, Settings, Signals, State, Status,
};
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

/// Where the store keeps its records.
#[cfg(feature = "hardware")]
type Flash = flash::Sectors;
#[cfg(not(feature = "hardware"))]
type Flash = &'static mut glidepath_controller::store::MemoryFlash<8192>;

#[cfg(not(feature = "hardware"))]
static FLASH: ConstStaticCell<glidepath_controller::store::MemoryFlash<8192>> =
    ConstStaticCell::new(glidepath_controller::store::MemoryFlash([0; 8192]));

/// What a machine works in. It is made anew when settings change machine data.
struct Memory {
    channel: Channel<AXES, BLOCKS, AXES>,
    machine: MachineMemory<AXES>,
    data: MachineData<AXES>,
}

static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory {
    channel: Channel::new(),
    machine: MachineMemory::new(),
    data: machine::BLANK,
});
static SERIAL: ConstStaticCell<Serial<BUFFER>> = ConstStaticCell::new(Serial::new());

/// What outlives a change of the settings.
struct Desk {
    controller: Controller<'static, AXES, BUFFER>,
    line: Line,
    store: Parameters<Flash, AXES>,
    controls: inputs::Controls,
    outputs: outputs::OutputPins,
    watchdog: safety::Watchdog,
    /// Inputs that are on beside limits and probe, as of the last tick.
    signals: Signals,
    counts: tick::Counts,
    faults: u32,
    /// The step output was made for these.
    made: Settings<AXES>,
}

#[entry]
fn main() -> ! {
    if let (Some(board), Some(memory), Some(serial)) =
        (Peripherals::take(), MEMORY.try_take(), SERIAL.try_take())
    {
        run(board, memory, serial);
    }
    loop {
        wfi();
    }
}

fn run(board: Peripherals, memory: &'static mut Memory, serial: &'static mut Serial<BUFFER>) {
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
    let settings = machine::DEFAULTS;
    let data = machine::data(&settings);
    if let Ok(steps) = machine::steps(&settings, &data, &Place::default()) {
        words::start(&board, steps.rest_word());
    }
    #[cfg(feature = "hardware")]
    let flash = flash::Sectors::new(board.FLASH);
    #[cfg(not(feature = "hardware"))]
    let Some(flash) = FLASH.try_take() else { return };
    let Ok(mut store) = Parameters::open(flash) else { return };
    let stored = store.load(&mut config);
    if !machine::fits(&config.settings) {
        config.settings = config.defaults;
        config.notice = Message::try_from("the stored settings do not fit this build").unwrap_or_default();
    }
    let carried = Carried::new(Place::default(), config.settings, stored);
    let controller = Controller::new(inbox, config);
    let controls = inputs::Controls::new();
    let desk = Desk {
        controller,
        line,
        store,
        controls,
        outputs,
        watchdog,
        signals: Signals::default(),
        counts: tick::Counts::default(),
        faults: 0,
        made: carried.settings,
    };
    serve(desk, memory, carried);
}

/// One machine after the other, for ever; in the emulator until `$SLP`.
fn serve(mut desk: Desk, memory: &'static mut Memory, mut carried: Carried<AXES>) {
    let memory: *mut Memory = memory;
    loop {
        // SAFETY: `machine` of the round before is gone, and so is the interrupt's side. Nothing else refers to it.
        let memory: &'static mut Memory = unsafe { &mut *memory };
        memory.data = machine::data(&carried.settings);
        memory.channel = Channel::new();
        let next = desk.round(memory, &carried);
        tick::set(None);
        match next {
            Some(next) => carried = next,
            None => return,
        }
    }
}

impl Desk {
    /// Runs until settings ask for another machine. `None`: the machine data cannot be, or the emulator is to end.
    fn round(&mut self, memory: &'static mut Memory, carried: &Carried<AXES>) -> Option<Carried<AXES>> {
        let parts = memory.machine.split();
        let handles = memory.channel.split(&memory.data, carried.position, parts.0).ok()?;
        let (mut machine, interpolator) = Machine::new(handles, parts, &memory.data, carried);
        machine.set_fits(machine::check);
        let steps = machine::steps(&carried.settings, &memory.data, &carried.position).ok()?;
        let drive = Drive::new(steps, &memory.data, carried.position);
        (self.made, self.faults) = (carried.settings, 0);
        let polarity = polarity(&carried.settings, false);
        tick::set(Some(Tick::new(interpolator, drive, polarity, self.counts)));
        loop {
            self.turn(&mut machine);
            self.change_steps(&machine.status(), &memory.data);
            if let Some(next) = machine.successor() {
                return Some(next);
            }
            #[cfg(feature = "qemu")]
            if self.controller.state(&machine.status()) == State::Sleep {
                report();
                return None;
            }
        }
    }

    /// One look at everything.
    fn turn<const O: usize>(&mut self, machine: &mut Machine<'static, AXES, BLOCKS, O>) {
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

    /// Settings of the step output alone act at rest, without another machine.
    fn change_steps(&mut self, status: &Status<AXES>, data: &MachineData<AXES>) {
        let settings = self.controller.settings();
        if machine::same_steps(settings, &self.made) || status.is_busy || !status.is_at_rest {
            return;
        }
        self.made = *settings;
        // They were checked before they were stored.
        if let Ok(steps) = machine::steps(settings, data, &status.position) {
            let drive = Drive::new(steps, data, status.position);
            self.faults = 0;
            let _ = tick::with(|tick| tick.change(drive));
        }
    }
}

/// What the interrupt has to know of the settings.
fn polarity(settings: &Settings<AXES>, is_homing: bool) -> Polarity {
    Polarity {
        limits_high: settings.limits_inverted,
        probe_high: settings.probe_inverted,
        limits_cut: settings.limits_cut_steps && !is_homing,
    }
}

/// The counter of cycles that the longest interrupt is measured with.
#[cfg(feature = "hardware")]
fn count_cycles() {
    if let Some(mut core) = cortex_m::Peripherals::take() {
        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();
    }
}

/// Ends the emulator with a line of figures.
#[cfg(feature = "qemu")]
fn report() {
    use cortex_m_semihosting::{debug, heprintln};
    let seen = tick::with(|tick| (tick.counts, tick.positions()));
    if let Some((tick::Counts { ticks, active, missed, longest }, [x, y, z])) = seen {
        heprintln!("ticks {ticks} active {active} missed {missed} longest {longest} x {x} y {y} z {z}");
    }
    debug::exit(debug::EXIT_SUCCESS);
}
