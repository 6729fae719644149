//! `glidepath serve`: a controller on the PC for a sender, over TCP on this computer or a pseudo terminal.
//!
//! The protocol is that of [`glidepath_controller`]. Planner and interrupt of the library run in real time or
//! faster. One sender is connected at a time.
mod control;
mod inputs;
mod log;
mod page;
mod settings;
mod store;
mod wire;

pub use control::Control;
use glidepath::channel::Channel;
use glidepath::fir::Unfiltered;
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use glidepath::tick::Interpolator;
use glidepath_controller::machine::{Carried, Latch, Machine, MachineMemory, controller_data};
use glidepath_controller::{Config, Controller, Look, Motion, RESET, Receiver, Serial, Signals, is_text};
use inputs::Inputs;
pub use log::Log;
pub use page::Page;
use page::Shown;
use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant};
pub use store::Kept;
pub use wire::Wire;

/// Number of axes of this build.
pub const AXES: usize = 3;

/// Blocks of look-ahead.
const BLOCKS: usize = 120;

/// Bytes of the serial input.
const BUFFER: usize = 1024;

/// Bytes of text that may wait in addition to those in the serial input. Further bytes stay with the connection.
const WAITING: usize = 1 << 20;

/// Options of the run.
pub struct Options {
    /// Factor of the speed, relative to real time.
    pub speed: u32,
    /// The command ends when its sender has left.
    pub once: bool,
    /// Height of the probe's plate, mm.
    pub plate: Option<f64>,
}

/// The connections.
pub struct Lines {
    /// The sender.
    pub wire: Wire,
    /// Clients that press inputs.
    pub control: Option<Control>,
    /// Browsers that show the page and press inputs.
    pub page: Option<Page>,
    /// The log of every byte.
    pub log: Option<Log>,
    /// What outlives the command.
    pub store: Option<Kept>,
}

/// Ticks between two checks of the connections.
const TICKS_PER_TURN: u64 = 200;

/// Planner and operator of this build.
type Mill<'a> = Machine<'a, AXES, BLOCKS, AXES>;

/// The timer interrupt of this build.
type Ticks<'a> = Interpolator<'a, AXES, Unfiltered, AXES>;

/// Data that stay when settings change.
struct Desk<'a> {
    options: &'a Options,
    lines: &'a mut Lines,
    inputs: Inputs,
    latch: Latch<AXES>,
    receiver: Receiver<'a, BUFFER>,
    /// Text of the sender for which the serial input has no room yet.
    waiting: VecDeque<u8>,
    controller: Controller<'a, AXES, BUFFER>,
    out: Vec<u8>,
    begun: Instant,
    ticks: u64,
    /// Of them, those that were left out: the machine was too slow for that speed.
    late: u64,
}

/// Runs until it is ended, or the sender has gone. The ticks that went by.
///
/// # Errors
/// Machine data refused; the stored values do not fit; the connection fails.
pub fn run(machine: &MachineData<AXES>, lines: &mut Lines, options: &Options) -> io::Result<u64> {
    let mut data = controller_data(machine);
    let mut serial = Box::new(Serial::<BUFFER>::new());
    let (receiver, inbox) = serial.split();
    let mut config = Config::new(data.axes.map(|axis| axis.name));
    config.defaults = settings::of_machine(&data);
    (config.settings, config.line_numbers) = (config.defaults, true);
    let mut stored = settings::stored(&data);
    if let Some(store) = &mut lines.store {
        (data, stored) = store.load(&data, &mut config)?;
    }
    let mut carried = Carried::new([Position::ZERO; AXES], config.settings, stored);
    let controller = Controller::new(inbox, config);
    let (begun, out, waiting) = (Instant::now(), Vec::new(), VecDeque::new());
    let (inputs, latch) = (Inputs::new(&data, options.plate), Latch::new(1));
    let mut desk =
        Desk { options, lines, inputs, latch, receiver, waiting, controller, out, begun, ticks: 0, late: 0 };
    // Large for a stack.
    let mut memory = Box::new(MachineMemory::new());
    let mut channel = Box::new(Channel::<AXES, BLOCKS, AXES>::new());
    loop {
        match desk.serve(&data, &mut channel, &mut memory, &carried)? {
            Some(next) => {
                data = next.settings.onto(&data, &carried.settings);
                carried = next;
            }
            None => return Ok(desk.ticks - desk.late),
        }
    }
}

impl Desk<'_> {
    /// Runs with these machine data. Returns the state for the next machine, if settings need one; `None`:
    /// the sender has left.
    fn serve(
        &mut self,
        data: &MachineData<AXES>,
        channel: &mut Channel<AXES, BLOCKS, AXES>,
        memory: &mut MachineMemory<AXES>,
        carried: &Carried<AXES>,
    ) -> io::Result<Option<Carried<AXES>>> {
        *channel = Channel::new();
        let parts = memory.split();
        let handles = channel.split(data, carried.position, parts.0);
        let handles =
            handles.map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error.to_string()))?;
        let (mut machine, mut interpolator) = Machine::new(handles, parts, data, carried);
        let cycle_us = u64::from(data.channel.cycle_us);
        loop {
            let mut is_quiet = !self.receive()?;
            let now_us = self.begun.elapsed().as_micros() as u64 * u64::from(self.options.speed);
            let now_ms = (now_us / 1000) as u32;
            if let Some(control) = &mut self.lines.control {
                control.serve(&mut self.inputs);
            }
            let before = self.out.len();
            let mut shown = self.poll(&mut machine, now_ms);
            is_quiet &= self.out.len() == before;
            machine.service(&self.latch);
            let due = (now_us / cycle_us).saturating_sub(self.ticks).min(TICKS_PER_TURN);
            for _ in 0..due {
                self.tick(&mut interpolator, machine.is_relocating());
                machine.service(&self.latch);
                if self.latch.signals() != shown {
                    // A limit switch acts in its tick, also in a fast simulation.
                    shown = self.poll(&mut machine, now_ms);
                }
            }
            if now_us / cycle_us > self.ticks + 10 * TICKS_PER_TURN {
                // Too slow for that speed, or asleep: what is late is not made up for.
                let on_time = now_us / cycle_us;
                self.late += on_time - core::mem::replace(&mut self.ticks, on_time);
            }
            self.show(&machine);
            self.write()?;
            if self.options.once && self.lines.wire.has_gone() {
                return Ok(None);
            }
            if let Some(next) = machine.successor() {
                return Ok(Some(next));
            }
            if is_quiet {
                std::thread::sleep(Duration::from_micros(200));
            }
        }
    }

    /// One call of the controller. Returns the latched inputs of the call.
    fn poll(&mut self, machine: &mut Mill<'_>, now_ms: u32) -> Signals {
        let signals = self.latch.signals().and(self.inputs.others());
        let mut store = self.lines.store.as_mut().map(|kept| &mut kept.parameters);
        let look = Look { now_ms, signals, motion: machine, store: &mut store };
        let Ok(()) = self.controller.poll(look, &mut Text(&mut self.out));
        self.latch.signals()
    }

    /// The timer interrupt.
    fn tick(&mut self, interpolator: &mut Ticks<'_>, is_relocating: bool) {
        let before = *interpolator.set_points();
        interpolator.tick();
        let after = interpolator.set_points();
        if is_relocating && before != *after {
            self.inputs.relocate(&before, after);
            if let Some(page) = &mut self.lines.page {
                page.restart(after);
            }
            self.inputs.tick(after, after, &mut self.latch);
        } else {
            self.inputs.tick(&before, after, &mut self.latch);
        }
        if let Some(page) = &mut self.lines.page {
            page.mark(after);
        }
        self.ticks += 1;
    }

    /// The data for the page.
    fn show(&mut self, machine: &Mill<'_>) {
        let Some(page) = &mut self.lines.page else { return };
        let signals = self.latch.signals().and(self.inputs.others());
        let controller = &self.controller;
        page.serve(&mut self.inputs, |inputs| {
            let status = machine.status();
            Shown {
                state: controller.state(&status).to_string(),
                position: status.position,
                offset: machine.offsets().work(machine.modal().system),
                feed: status.feed.to_num(),
                inputs: inputs.names_of(signals),
                plate: inputs.plate(),
            }
        });
    }

    /// Sends as many bytes of the answers as possible.
    fn write(&mut self) -> io::Result<()> {
        let before = self.lines.log.is_some().then(|| self.out.clone());
        self.lines.wire.write(&mut self.out)?;
        if let (Some(log), Some(before)) = (&mut self.lines.log, before) {
            log.row('<', before.get(..before.len() - self.out.len()).unwrap_or_default())?;
        }
        Ok(())
    }

    /// Reads from the sender. Real-time bytes act at once, also while text before them waits for room. Returns
    /// whether bytes were read, or text found room.
    fn receive(&mut self) -> io::Result<bool> {
        let mut bytes = [0; 256];
        let room = WAITING.saturating_sub(self.waiting.len()).min(bytes.len());
        let count = self.lines.wire.read(bytes.get_mut(..room).unwrap_or_default())?;
        let bytes = bytes.get(..count).unwrap_or_default();
        if let Some(log) = &mut self.lines.log {
            log.row('>', bytes)?;
        }
        for byte in bytes {
            if is_text(*byte) {
                self.waiting.push_back(*byte);
                continue;
            }
            if *byte == RESET {
                self.waiting.clear();
            } else {
                self.pass();
            }
            self.receiver.push(*byte);
        }
        Ok(self.pass() || count > 0)
    }

    /// Passes as much text to the controller as there is room for. Returns whether that was any.
    fn pass(&mut self) -> bool {
        let count = self.receiver.room().min(self.waiting.len());
        for byte in self.waiting.drain(..count) {
            self.receiver.push(byte);
        }
        count > 0
    }
}

/// Answers that wait for the connection.
struct Text<'a>(&'a mut Vec<u8>);

impl glidepath_controller::io::ErrorType for Text<'_> {
    type Error = std::convert::Infallible;
}

impl glidepath_controller::io::Write for Text<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}
