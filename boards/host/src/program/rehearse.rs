//! A rehearsal: simulates a program that depends on outside values, and returns the blocks of the run.
//!
//! The number of passes of a real-time loop, and the effect of a variable, are known only during the motion.
//! The rehearsal simulates the program with the same events and the same PLC, and collects each carried-out
//! command. A run is deterministic, so the next run has the same blocks.
use super::Program;
use super::decode::Reading;
use super::repeats::Repeats;
use super::told::{Warned, endless, message, place, refusal, remark};
use crate::acknowledge::{Automatic, Delay};
use crate::diagnose::Diagnostic;
use crate::events::{Schedule, Script};
use crate::files::{Delayed, Files};
use crate::machine::{Machine, with_axes};
use crate::plc::{self, Outside, Wants, Writer};
use crate::run::{BLOCKS, OVERLAYS, TAPS};
use glidepath::channel::{Channel, FilteredHandles, Planner, Progress};
use glidepath::fir::{Bank, Filters};
use glidepath::nc::{Command, Head, Place};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::tick::State;
use std::cell::Cell;

/// The surroundings of the program.
#[derive(Clone, Copy, Default)]
pub struct Around<'a> {
    /// Events from outside.
    pub script: Option<&'a Script>,
    /// Functions that no event acknowledges.
    pub acknowledge: Delay,
    /// The PLC.
    pub plc: Option<&'a plc::Script>,
    /// Highest number of commands of repeated lines.
    pub limit: u64,
}

/// Simulates the program to its end, or until the axes stand still for ever.
///
/// # Errors
/// A line is refused; a loop or the program does not end.
pub fn rehearse(files: &Files, machine: &Machine, around: Around<'_>) -> Result<Program, Vec<Diagnostic>> {
    with_axes!(machine, rehearse_axes(files, machine, around))
}

fn rehearse_axes<const AXES: usize>(
    files: &Files,
    machine: &Machine,
    around: Around<'_>,
) -> Result<Program, Vec<Diagnostic>> {
    let data = machine.data::<AXES>().ok_or_else(|| vec![Diagnostic::error("wrong number of axes")])?;
    let late = Cell::new(false);
    let mut channel = Box::new(Channel::<AXES, BLOCKS, OVERLAYS>::new());
    let mut filters = Box::new(Filters::<AXES, TAPS>::new());
    let mut outside = plc::Memory::<AXES>::new(machine, around.plc);
    let mut handles = channel
        .split_filtered(&mut filters, &data, [Position::ZERO; AXES], Delayed { files, late: &late })
        .map_err(|error| vec![Diagnostic::error(format!("{}: {error}", machine.name))])?;
    let (_, outside) = outside.give(&mut handles.planner, Wants::of(files, around.plc));
    let kinematics = machine.kinematics.fitted(&data);
    handles.planner.transform_with(&kinematics, machine.kinematics.default_id);
    if let Some(smooth) = machine.smooth {
        handles.planner.begin_with(smooth.command());
    }
    handles.planner.watch();
    let cycle_us = machine.channel.cycle_us;
    let stage = Stage {
        reading: Reading::new(machine, &data, &kinematics),
        files,
        outside,
        writer: Writer::new(outside, around.plc, cycle_us),
        schedule: Schedule::new(around.script.map_or(&[][..], |script| &script.events), cycle_us),
        automatic: Automatic::new(around.acknowledge, cycle_us),
        repeats: Repeats::default(),
        limit: around.limit,
        warned: Warned::default(),
        skipped: Vec::new(),
        loop_at: None,
        passes: 0,
        tick: 0,
    };
    stage.drive(handles, &late)
}

/// The current rehearsal.
struct Stage<'a, const AXES: usize> {
    reading: Reading<'a, AXES>,
    files: &'a Files,
    outside: Outside<'a>,
    writer: Writer<'a>,
    schedule: Schedule<'a>,
    automatic: Automatic,
    repeats: Repeats,
    limit: u64,
    warned: Warned,
    /// Loops that were left out.
    skipped: Vec<Place>,
    /// Start of the loop that was read last, and whether a pass of this loop will follow.
    loop_at: Option<(Head, bool)>,
    /// Number of passes decided on.
    passes: u32,
    tick: u64,
}

/// Ticks without work, and ticks at standstill in a hold, after which the rehearsal ends.
const IDLE: u64 = 1000;
const HELD: u64 = 1_000_000;

type Handles<'a, const AXES: usize> = FilteredHandles<'a, Delayed<'a>, AXES, BLOCKS, TAPS, OVERLAYS>;
type Planning<'a, const AXES: usize> = Planner<'a, Delayed<'a>, AXES, BLOCKS, Bank<'a, AXES, TAPS>, OVERLAYS>;

impl<const AXES: usize> Stage<'_, AXES> {
    fn drive(mut self, handles: Handles<'_, AXES>, late: &Cell<bool>) -> Result<Program, Vec<Diagnostic>> {
        let FilteredHandles { mut planner, mut interpolator, operator } = handles;
        let (mut done, mut idle, mut rest) = (false, 0, 0);
        loop {
            while self.schedule.due(self.tick, &operator).is_some() {}
            while self.automatic.due(self.tick, &operator).is_some() {}
            self.writer.before(self.tick);
            let (starved, stalled) =
                (self.schedule.is_starved(self.tick), self.schedule.is_stalled(self.tick));
            late.set(starved);
            done &= stalled;
            if !done && !stalled {
                done = self.plan(&mut planner)?;
            }
            let commands = operator.commands();
            let held = commands.hold || commands.feed == 0;
            let waiting = planner.is_waiting();
            let state = interpolator.tick();
            let is_idle = state == State::Idle;
            if is_idle && done {
                break;
            }
            if is_idle && !(starved || stalled || held || waiting) {
                idle += 1;
                if idle > IDLE {
                    break;
                }
                self.put_out(&operator);
                continue;
            }
            (idle, self.tick) = (0, self.tick + 1);
            self.put_out(&operator);
            rest = if is_idle { rest + 1 } else { 0 };
            // The run reports the reason.
            let unanswered = waiting
                && is_idle
                && operator
                    .awaited()
                    .is_some_and(|f| !self.automatic.answers(f) && !self.schedule.answers(f));
            let stands = held && is_idle && !(starved || stalled) && !self.schedule.goes_on(&commands);
            if unanswered || stands || rest > HELD {
                break;
            }
        }
        self.left_out();
        let mut program = self.reading.program;
        program.passes = Some(self.outside.switch.passes());
        Ok(program)
    }

    /// Calls the planner until it waits. Returns whether all motion is planned.
    fn plan(&mut self, planner: &mut Planning<'_, AXES>) -> Result<bool, Vec<Diagnostic>> {
        loop {
            let progress = planner.poll();
            self.writer.behind();
            if let Some(command) = planner.seen() {
                if let Command::Message(head) = &command {
                    let told = message(self.files, head, |name| planner.parameter(name));
                    self.reading.program.messages.extend(told);
                }
                self.take(&command)?;
            }
            match progress {
                Ok(Progress::Waiting) => return Ok(false),
                Ok(Progress::Done) => return Ok(true),
                Ok(Progress::Warning(warning)) if !warning.kind.is_of_curve() => {
                    if self.warned.is_new(&warning) {
                        self.reading.program.warnings.push(remark(self.files, &warning));
                    }
                }
                Ok(_) => {}
                Err(error) => return Err(vec![refusal(self.files, &error)]),
            }
        }
    }

    fn take(&mut self, command: &Command<AXES>) -> Result<(), Vec<Diagnostic>> {
        if self.repeats.add(command.place()) > self.limit {
            return Err(vec![endless(self.files, command.place(), self.limit)]);
        }
        let passes = self.outside.switch.passes();
        if let Some((head, is_first)) = &mut self.loop_at
            && passes != self.passes
        {
            (self.passes, *is_first) = (passes, false);
            let at = head.place;
            if self.outside.switch.is_enabled() && !self.writer.ends_loops() && !self.schedule.aborts() {
                return Err(vec![self.unending(at)]);
            }
        }
        self.left_out();
        if let Command::RtWhile(head, _) = command {
            self.loop_at = Some((*head, true));
        }
        let _ = self.reading.take(command);
        Ok(())
    }

    /// A loop that was left out because its flag was false.
    fn left_out(&mut self) {
        if let Some((head, true)) = self.loop_at.take_if(|(_, is_first)| *is_first) {
            let message = "the real-time loop is left out: V.RTG.LOOP.ENABLED is false";
            let warning = place(Diagnostic::warning(message), self.files, head.place);
            let expected = "TRUE before it, or `0 loop on` or `0 loop 3` (passes) in --plc";
            if !self.skipped.contains(&head.place) {
                self.skipped.push(head.place);
                self.reading.program.warnings.push(warning.expected(expected));
            }
        }
    }

    fn unending(&self, at: Place) -> Diagnostic {
        let message =
            "the real-time loop does not end: V.RTG.LOOP.ENABLED is true, and nothing makes it false";
        place(Diagnostic::error(message), self.files, at).expected(
            "expected a later line `<seconds> loop off` or a line `<seconds> loop <passes>` in --plc, or an abort in --events",
        )
    }

    fn put_out(&mut self, operator: &Operator<'_, AXES>) {
        while let Some(output) = operator.output() {
            if output.waits && !self.schedule.acknowledges(output.function) {
                self.automatic.answer(output.function, self.tick);
            }
        }
    }
}
