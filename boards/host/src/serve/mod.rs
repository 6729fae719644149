//! `glidepath serve`: a controller on the desktop that a sender can talk to, over TCP on this machine or a pseudo
//! terminal.
//!
//! The protocol is [`glidepath_controller`]'s. Behind it run the planner and the interrupt of the library, in real time or
//! faster. A sender is connected to one of them at a time.
mod settings;
mod wire;

use glidepath::channel::Channel;
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use glidepath_controller::machine::{Carried, Latch, Machine, MachineMemory, controller_data};
use glidepath_controller::{Config, Controller, Look, Receiver, Serial, Signals};
use std::io;
use std::time::{Duration, Instant};
pub use wire::Wire;

/// Axes that it is built for.
pub const AXES: usize = 3;

/// Blocks of look-ahead.
const BLOCKS: usize = 120;

/// Bytes of the serial input.
const BUFFER: usize = 1024;

/// How it runs.
pub struct Options {
    /// Times as fast as real time.
    pub speed: u32,
    /// It ends when its sender has gone.
    pub once: bool,
}

/// Ticks that go by before senders are looked after again.
const TICKS_PER_TURN: u64 = 200;

/// What outlives a change of the settings.
struct Desk<'a> {
    options: &'a Options,
    wire: &'a mut Wire,
    receiver: Receiver<'a, BUFFER>,
    controller: Controller<'a, AXES, BUFFER>,
    out: Vec<u8>,
    begun: Instant,
    ticks: u64,
}

/// Runs until it is ended, or the sender has gone.
///
/// # Errors
/// Machine data refused; the connection fails.
pub fn run(machine: &MachineData<AXES>, wire: &mut Wire, options: &Options) -> io::Result<()> {
    let mut data = controller_data(machine);
    let mut serial = Box::new(Serial::<BUFFER>::new());
    let (receiver, inbox) = serial.split();
    let mut config = Config::new(data.axes.map(|axis| axis.name));
    config.settings = settings::of_machine(&data);
    config.line_numbers = true;
    let stored = settings::stored(&data);
    let mut carried = Carried::new([Position::ZERO; AXES], config.settings, stored);
    let controller = Controller::new(inbox, config);
    let (begun, out) = (Instant::now(), Vec::new());
    let mut desk = Desk { options, wire, receiver, controller, out, begun, ticks: 0 };
    // Large for a stack.
    let mut memory = Box::new(MachineMemory::new());
    let mut channel = Box::new(Channel::<AXES, BLOCKS, AXES>::new());
    loop {
        match desk.serve(&data, &mut channel, &mut memory, &carried)? {
            Some(next) => {
                data = next.settings.onto(&data, &carried.settings);
                carried = next;
            }
            None => return Ok(()),
        }
    }
}

impl Desk<'_> {
    /// Runs with these machine data. What the next machine needs, if settings ask for one; `None`: the sender has gone.
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
        let mut latch = Latch::new(1);
        let cycle_us = u64::from(data.channel.cycle_us);
        loop {
            let mut is_quiet = !self.receive()?;
            let now_us = self.begun.elapsed().as_micros() as u64 * u64::from(self.options.speed);
            let now_ms = (now_us / 1000) as u32;
            let signals = Signals::default();
            let look = Look { now_ms, signals, motion: &mut machine, store: &mut () };
            let before = self.out.len();
            let Ok(()) = self.controller.poll(look, &mut Text(&mut self.out));
            is_quiet &= self.out.len() == before;
            machine.service(&latch);
            let due = (now_us / cycle_us).saturating_sub(self.ticks).min(TICKS_PER_TURN);
            for _ in 0..due {
                interpolator.tick();
                latch.look(signals, interpolator.set_points());
                machine.service(&latch);
                self.ticks += 1;
            }
            if now_us / cycle_us > self.ticks + 10 * TICKS_PER_TURN {
                // Too slow for that speed, or asleep: what is late is not made up for.
                self.ticks = now_us / cycle_us;
            }
            self.wire.write(&mut self.out)?;
            if self.options.once && self.wire.has_gone() {
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

    /// What the sender has sent, as much as finds room: the rest stays with its side of the line. Whether there was
    /// something.
    fn receive(&mut self) -> io::Result<bool> {
        let mut bytes = [0; 256];
        let room = self.receiver.room().min(bytes.len());
        let count = self.wire.read(bytes.get_mut(..room).unwrap_or_default())?;
        for byte in bytes.iter().take(count) {
            self.receiver.push(*byte);
        }
        Ok(count > 0)
    }
}

/// Answers that wait for the wire.
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
