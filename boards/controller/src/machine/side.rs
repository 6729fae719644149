//! Implements the trait [`Motion`] for the machine: the calls by which the controller moves the axes.
use super::offered::{End, Offered};
use super::refusal::refusal;
use super::{Kept, Machine, ProbeCycle, Scan};
use crate::motion::{
    Homing, Jog, Message, Modal, Motion, Offsets, Overrides, Refusal, Spindle, Status, Taken,
};
use crate::settings::Settings;
use core::fmt::Write;
use glidepath::channel::{Channel, Error};
use glidepath::nc::{Decoder, InForce, Step, StoredOffsets};
use glidepath::quantity::{Feed, Position, Speed};
use glidepath::tick::State;

/// Number of free blocks in reports while the planner has room for a line.
const FREE_BLOCKS: u8 = 15;

/// Error numbers of the refusals.
const TOO_LONG: u8 = 11;
const STEP_RATE: u8 = 12;
const UNKNOWN: u8 = 20;
const BEYOND_JOG: u8 = 15;
const NO_AXES: u8 = 26;
const LINE_NUMBER: u8 = 27;
const NO_END: u8 = 32;
const TARGET: u8 = 33;
const TOOL_LENGTH: u8 = 37;
const OUT_OF_RANGE: u8 = 52;

impl<const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> Machine<'_, AXES, BLOCKS, OVERLAYS> {
    fn scan(&self, line: &[u8]) -> Scan {
        Scan::of(line, &self.names(), (self.kept.mist, self.kept.flood))
    }

    /// Whether a line is a rapid motion.
    fn is_rapid(&self, scan: &Scan, force: &InForce<AXES>) -> bool {
        scan.is_home || scan.motion.unwrap_or(force.motion() == 0 && scan.probing.is_none())
    }

    /// Refuses lines that Grbl refuses and the decoder accepts, or to which the decoder gives another number.
    fn refuse(scan: &Scan, force: &InForce<AXES>) -> Result<(), Refusal> {
        if scan.goes_elsewhere {
            let mut message = Message::new();
            let _ = message.write_str("O words, M98 and M99 need a file: expected a line without them");
            return Err(Refusal { code: UNKNOWN, message });
        }
        let is_arc = matches!(force.motion(), 20 | 30);
        Err(Refusal::new(match scan.lacks_end((is_arc, force.plane())) {
            _ if scan.bad_number => LINE_NUMBER,
            true if scan.has_axes => NO_END,
            true => NO_AXES,
            false if scan.probing.is_some() && !scan.has_axes => NO_AXES,
            false if scan.has_foreign_tool_length() => TOOL_LENGTH,
            false => return Ok(()),
        }))
    }

    /// Records the state that an accepted line leaves.
    fn note(&mut self, scan: &Scan) {
        let program_has_ended = self.line.end == Some(End::Program);
        if let (false, Some(force)) = (program_has_ended, self.planner.in_force()) {
            self.kept.force = force;
        }
        self.kept.rpm = scan.rpm.unwrap_or(self.kept.rpm);
        (self.kept.mist, self.kept.flood) = scan.coolant.unwrap_or((self.kept.mist, self.kept.flood));
        if scan.motion.is_some() {
            self.kept.probing = None;
        }
        self.kept.probing = scan.probing.or(self.kept.probing);
        self.kept.program = scan.program;
        if matches!(scan.program, Some(2 | 30)) {
            self.switched.program_ends = self.switched.program_ends.wrapping_add(1);
            (self.kept.mist, self.kept.flood, self.kept.probing) = (false, false, None);
        }
        self.checked = None;
    }

    /// Target of an axis in a jog, in machine coordinates.
    fn goal(&self, jog: &Jog<AXES>, axis: usize, way: Position) -> Position {
        let of = |all: &[Position; AXES]| all.get(axis).copied().unwrap_or_default();
        let from = match (jog.incremental, jog.machine) {
            (true, _) => of(self.planner.position()),
            (false, true) => Position::ZERO,
            (false, false) => of(&self.offsets().work(self.modal().system)),
        };
        way.saturating_add(from)
    }

    /// A jog as a line for the decoder.
    fn jog_text(&self, jog: &Jog<AXES>) -> Option<heapless::String<{ super::scan::TEXT_BYTES }>> {
        let mut text = heapless::String::new();
        write!(text, "G53G90G21G94G1F{}", jog.feed).ok()?;
        for (axis, (name, word)) in self.names().iter().zip(jog.axes).enumerate() {
            if let Some(way) = word {
                write!(text, "{}{}", name.as_str(), self.goal(jog, axis, way)).ok()?;
            }
        }
        Some(text)
    }
}

impl<const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> Motion<AXES>
    for Machine<'_, AXES, BLOCKS, OVERLAYS>
{
    fn take(&mut self, line: &[u8]) -> Taken {
        if self.line.waits {
            return self.answer_at_rest();
        }
        if self.cycles.probe.is_some() {
            return self.answer_probe();
        }
        let scan = self.scan(line);
        if let Err(refusal) = Self::refuse(&scan, &self.kept.force) {
            return Taken::Refused(refusal);
        }
        let probing = self.probing_of(&scan);
        if let (Some(probing), false) = (probing, self.line.offered)
            && !self.may_probe(probing)
        {
            return Taken::NotYet;
        }
        let is_rapid = self.is_rapid(&scan, &self.kept.force);
        let Some(text) = scan.numbered(line, is_rapid) else {
            return Taken::Refused(Refusal::new(TOO_LONG));
        };
        self.cycles.is_jogging = false;
        if !self.line.offered && !self.is_under_way() {
            self.set_override(is_rapid && probing.is_none());
        }
        match self.offer(&text, TARGET) {
            Taken::Yes => {}
            other => return other,
        }
        self.note(&scan);
        if let Some(probing) = probing {
            self.cycles.probe = Some(ProbeCycle::Moving(probing));
            return Taken::NotYet;
        }
        // M1 has no effect if its switch is off.
        let is_off = scan.program == Some(1) && !self.data.channel.foreign.optional_stop;
        (self.line.waits, self.line.pauses) = (scan.synchronises, scan.pauses && !is_off);
        self.answer_at_rest()
    }

    fn check(&mut self, line: &[u8]) -> Result<(), Refusal> {
        let scan = self.scan(line);
        let force = self.checked.unwrap_or(self.kept.force);
        Self::refuse(&scan, &force)?;
        let text = scan.numbered(line, false).ok_or(Refusal::new(TOO_LONG))?;
        let mut setup = *self.planner.setup();
        setup.start = *self.planner.position();
        let mut decoder = Decoder::new(self.checker, setup, text.as_slice());
        // The decoder has not read a line yet.
        let _ = decoder.put_in_force(&force);
        loop {
            match decoder.step() {
                Ok(Step::End) => break,
                Ok(_) => {}
                Err(error) => return Err(refusal(&Error::Nc(error), TARGET)),
            }
        }
        self.checked = decoder.in_force();
        Ok(())
    }

    fn jog(&mut self, jog: &Jog<AXES>) -> Taken {
        if self.line.offered {
            // The controller gives the same jog again.
            let taken = self.offer(b"", BEYOND_JOG);
            self.restore_behind(&taken);
            return taken;
        }
        let Some(text) = self.jog_text(jog) else { return Taken::Refused(Refusal::new(TOO_LONG)) };
        self.cycles.is_jogging = true;
        self.set_override(false);
        let taken = self.offer(text.as_bytes(), BEYOND_JOG);
        self.restore_behind(&taken);
        taken
    }

    fn hold(&mut self) {
        self.operator.feed_hold();
    }

    fn resume(&mut self) {
        self.operator.resume();
        if let Some(code) = self.switched.paused.take() {
            // The next line waits for the current one.
            let _ = self.operator.acknowledge(glidepath::technology::Function::M(code));
        }
    }

    fn abort(&mut self) {
        self.cycles.homing = None;
        self.cycles.homed = Homing::Done;
        self.drop_all();
    }

    fn reset(&mut self) {
        self.operator.resume();
        let probe = self.kept.probe;
        self.kept = Kept { probe, ..Kept::START };
        self.checked = None;
        self.cycles.is_jogging = false;
        let program_ends = self.switched.program_ends;
        self.switched = super::Switched { program_ends, ..super::Switched::OFF };
        if self.line.end.is_none() {
            self.restore();
        }
        self.work();
    }

    fn set_overrides(&mut self, overrides: Overrides) {
        self.overrides = overrides;
        self.choose_override();
    }

    fn set_coolant(&mut self, mist: bool, flood: bool) {
        (self.switched.mist, self.switched.flood) = (mist, flood);
        (self.kept.mist, self.kept.flood) = (mist, flood);
    }

    fn home(&mut self) {
        // This comes before the end of the text, because single axes move after the end.
        self.cycles.homing = Some(super::Homing::new());
        self.cycles.homed = Homing::Running;
        self.drop_all();
    }

    fn clear_offsets(&mut self) {
        let _ = self.planner.put_stored(&StoredOffsets::ZERO);
    }

    fn configure(&mut self, settings: &Settings<AXES>) -> Result<(), Refusal> {
        if self.settings == *settings {
            self.next = None;
            return Ok(());
        }
        let data = settings.onto(self.data, &self.settings);
        if let Err(error) = Channel::<AXES, BLOCKS, OVERLAYS>::check(&data) {
            let mut message = Message::new();
            // The message is cut if the text is too long.
            let _ = write!(super::refusal::Ascii(&mut message), "{error}");
            return Err(Refusal { code: OUT_OF_RANGE, message });
        }
        if let Err(message) = (self.fits)(settings, &data) {
            return Err(Refusal { code: STEP_RATE, message });
        }
        if data == *self.data {
            self.settings = *settings;
        } else {
            self.next = Some(*settings);
        }
        Ok(())
    }

    fn status(&self) -> Status<AXES> {
        let seen = self.operator.status();
        // mm/tick to mm/min
        let feed = seen.speed.0.to_num::<f64>() * 60e6 / f64::from(self.data.channel.cycle_us.max(1));
        // In a dwell nothing moves, and nothing is planned behind: its line is answered at rest.
        let dwells = self.line.waits && seen.speed == Speed::ZERO;
        let is_at_rest = seen.state == State::Idle || dwells;
        Status {
            position: seen.set_points,
            is_busy: self.moves() || self.cycles.homing.is_some(),
            is_at_rest,
            is_paused: self.switched.paused.is_some() && is_at_rest,
            free_blocks: if self.line.offered { 0 } else { FREE_BLOCKS },
            line: if is_at_rest { 0 } else { seen.n / 2 },
            feed: Feed::saturating_from_num(if feed < 0.0 { -feed } else { feed }),
            spindle: self.switched.spindle,
            rpm: self.switched.rpm,
            mist: self.switched.mist,
            flood: self.switched.flood,
            program_ends: self.switched.program_ends,
            homing: self.cycles.homed,
        }
    }

    fn modal(&self) -> Modal {
        let Kept { force, rpm, mist, flood, program, probing, .. } = &self.kept;
        Modal {
            motion: probing.map_or(force.motion() / 10, |probing| probing.tenths()),
            system: 54 + force.zero_offset().min(8) as u8,
            plane: force.plane(),
            inch: force.is_inch(),
            incremental: force.is_relative(),
            inverse_time: force.is_by_time(),
            program: *program,
            spindle: match force.spindle() {
                3 => Spindle::Clockwise,
                4 => Spindle::CounterClockwise,
                _ => Spindle::Off,
            },
            mist: *mist,
            flood: *flood,
            tool: force.tool(),
            feed: force.feed(),
            rpm: *rpm,
        }
    }

    fn offsets(&self) -> Offsets<AXES> {
        let StoredOffsets { zero, places: [g28, g30] } = self.planner.stored();
        let (probe, probed) = self.kept.probe;
        let tool = self.kept.force.tool_length();
        Offsets { systems: zero, g28, g30, g92: self.kept.force.here(), tool, probe, probed }
    }

    fn alarm(&mut self) -> Option<u8> {
        self.cycles.alarm.take()
    }

    fn probe_ended(&mut self) -> bool {
        core::mem::take(&mut self.cycles.probe_ended)
    }
}

impl<const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> Machine<'_, AXES, BLOCKS, OVERLAYS> {
    /// Stops the axes, and drops all text that is not executed.
    fn drop_all(&mut self) {
        self.operator.resume();
        self.operator.abort();
        self.spool.clear();
        self.line = Offered { end: Some(End::Aborted), ..Offered::NONE };
        self.switched.paused = None;
        self.cycles.probe = None;
        // An alarm of a probing line ends with the line; other alarms stay.
        self.cycles.alarm = self.cycles.alarm.filter(|code| !matches!(code, 4 | 5));
        self.work();
    }

    /// A jog does not change modal words.
    fn restore_behind(&mut self, taken: &Taken) {
        if *taken == Taken::Yes {
            self.restore();
        }
    }
}
