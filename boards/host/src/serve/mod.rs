//! `glidepath serve`: a controller on the desktop that a sender can talk to, over TCP on this machine or a pseudo
//! terminal.
//!
//! The protocol is [`glidepath_controller`]'s. Behind it run the planner and the interrupt of the library, in real time or
//! faster. A sender is connected to one of them at a time.
mod adapter;
mod spool;
mod wire;
mod words;

use adapter::{Adapter, BLOCKS};
use glidepath::channel::{Channel, Handles};
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use glidepath_controller::{AxisSettings, Config, Controller, Look, Serial, Settings, Signals};
use spool::Spool;
use std::io;
use std::time::{Duration, Instant};
pub use wire::Wire;

/// Axes that it is built for.
pub const AXES: usize = 3;

/// How it runs.
pub struct Options {
    /// Times as fast as real time.
    pub speed: u32,
    /// It ends when its sender has gone.
    pub once: bool,
}

/// Ticks that go by before senders are looked after again.
const TICKS_PER_TURN: u64 = 200;

/// Runs until it is ended, or the sender has gone.
///
/// # Errors
/// Machine data refused; the connection fails.
pub fn run(machine: &MachineData<AXES>, wire: &mut Wire, options: &Options) -> io::Result<()> {
    let spool = Spool::new();
    // Large for a stack.
    let mut channel = Box::new(Channel::<AXES, BLOCKS>::new());
    let start = [Position::ZERO; AXES];
    let handles = channel.split(machine, start, &spool);
    let Handles { planner, mut interpolator, operator } =
        handles.map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error.to_string()))?;
    let mut adapter = Adapter::new(planner, operator, &spool, machine);
    let mut serial = Box::new(Serial::<1024>::new());
    let (mut receiver, inbox) = serial.split();
    let mut config = Config::new(machine.axes.map(|axis| axis.name));
    config.settings = settings(machine);
    let mut controller = Controller::new(inbox, config);
    let mut out = Vec::new();
    let (begun, cycle_us) = (Instant::now(), u64::from(machine.channel.cycle_us));
    let mut ticks = 0;
    loop {
        let mut is_quiet = true;
        // What finds no room stays with the sender's side of the line.
        let mut bytes = [0; 256];
        let room = receiver.room().min(bytes.len());
        let count = wire.read(bytes.get_mut(..room).unwrap_or_default())?;
        for byte in bytes.iter().take(count) {
            receiver.push(*byte);
            is_quiet = false;
        }
        let now_us = begun.elapsed().as_micros() as u64 * u64::from(options.speed);
        let now_ms = (now_us / 1000) as u32;
        let look = Look { now_ms, signals: Signals::default(), motion: &mut adapter, store: &mut () };
        let before = out.len();
        let Ok(()) = controller.poll(look, &mut Text(&mut out));
        is_quiet &= out.len() == before;
        adapter.service();
        let due = (now_us / cycle_us).saturating_sub(ticks).min(TICKS_PER_TURN);
        for _ in 0..due {
            let state = interpolator.tick();
            adapter.ticked(state);
            adapter.service();
            ticks += 1;
        }
        if now_us / cycle_us > ticks + 10 * TICKS_PER_TURN {
            // Too slow for that speed, or asleep: what is late is not made up for.
            ticks = now_us / cycle_us;
        }
        wire.write(&mut out)?;
        if options.once && wire.has_gone() {
            return Ok(());
        }
        if is_quiet {
            std::thread::sleep(Duration::from_micros(200));
        }
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

/// What `$$` shows: the machine data.
fn settings(machine: &MachineData<AXES>) -> Settings<AXES> {
    let mut settings = Settings::new();
    settings.axes = machine.axes.map(|axis| AxisSettings {
        counts_milli: 80_000,
        rate_milli: axis.vb_max.saturating_mul(60),
        accel_milli: axis.a_beschl.saturating_mul(1000),
        travel_milli: 200_000,
    });
    settings
}
