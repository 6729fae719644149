//! The decoder: reads lines of program text and returns commands, with a bounded amount of work per call.
use super::block::{Item, ItemKind};
use super::compose::in_range;
use super::cursor::Cursor;
use super::error::{NcError, NcErrorKind, NcWarning, NcWarningKind};
use super::interpreter::{Bounds, Gathered, Interpreter, Next, Phase, Refusal};
use super::line::{Fill, Line, LineReader, Mark};
use super::modal::Before;
use super::*;
use crate::machine::{MachineData, functions};
#[cfg(feature = "grbl")]
use crate::technology::Function;

/// A command that changes the dynamics of the following blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Restriction<const AXES: usize> {
    Slope(Slope),
    Weight(Weight<AXES>),
    VectorLimit(VectorLimit),
}

/// The result of one call of [`Decoder::step`].
#[expect(clippy::large_enum_variant, reason = "no allocation here: a command travels by value")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step<const AXES: usize> {
    /// A bounded amount of work is done and there is more: call again.
    Working,
    /// A command, in program order.
    Command(Command<AXES>),
    /// A warning about a word of the program. The program continues.
    Warning(NcWarning),
    /// Program text has not arrived yet: call again later.
    Late,
    /// The program has ended by M02, M30 or the end of its text; or an earlier line was refused.
    End,
}

/// What a piece of work has completed.
enum Work {
    /// A part of a line, or a line.
    Line,
    /// A line whose motion is to be returned.
    Motion,
    /// The text has no bytes yet.
    Late,
}

/// Cost of a line without its words; below: bytes per unit of cost. The unit is that of
/// [`super::calculator`].
const LINE: u32 = 10;
const BYTES: u32 = 2;
/// Work below which two more things may happen in the same call: the next line is read, and the result of the
/// current line is carried out.
const LITTLE: u32 = 30;
const LITTLE_LINE: u32 = 120;

/// The buffers of a [`Decoder`]. All bits are zero when new, so a `static` with these buffers takes no flash.
pub struct DecoderMemory<const AXES: usize> {
    line: Line,
    interpreter: Interpreter<AXES>,
}

impl<const AXES: usize> DecoderMemory<AXES> {
    /// Empty buffers.
    pub const fn new() -> Self {
        Self { line: Line::new(), interpreter: Interpreter::blank() }
    }
}

impl<const AXES: usize> Default for DecoderMemory<AXES> {
    fn default() -> Self {
        Self::new()
    }
}

/// Converts program text to commands, with a bounded amount of work per call.
pub struct Decoder<'a, T: Text, const AXES: usize> {
    reader: LineReader<T>,
    line: &'a mut Line,
    interpreter: &'a mut Interpreter<AXES>,
    /// Whether the current line is refused.
    refused: bool,
    /// Variables outside of the decoder.
    #[cfg(feature = "plc")]
    pub(crate) externals: super::Externals<'a>,
}

impl<'a, T: Text, const AXES: usize> Decoder<'a, T, AXES> {
    /// Makes a decoder at the start of `text`. Earlier contents of `memory` do not matter.
    #[inline(never)]
    pub fn new(memory: &'a mut DecoderMemory<AXES>, setup: Setup<AXES>, text: T) -> Self {
        let DecoderMemory { line, interpreter } = memory;
        line.clear();
        interpreter.begin(&setup);
        #[cfg_attr(not(feature = "grbl"), expect(unused_mut, reason = "only dialects change it"))]
        let mut reader = LineReader::new(text);
        #[cfg(feature = "grbl")]
        {
            reader.foreign.is_on = !interpreter.is_isg();
        }
        Self {
            reader,
            line,
            interpreter,
            refused: false,
            #[cfg(feature = "plc")]
            externals: super::Externals::NONE,
        }
    }

    /// As [`Self::new`], for a machine whose axes are at `start`.
    #[inline(never)]
    pub(crate) fn of_machine(
        memory: &'a mut DecoderMemory<AXES>,
        machine: &MachineData<AXES>,
        start: [Position; AXES],
        text: T,
    ) -> Self {
        Self::new(memory, Setup::new(machine, start), text)
    }

    /// Returns `command` before the first line, as if the program began with it. Use it for a smoothing that
    /// the program does not select. Call this function before the first step.
    #[cfg(feature = "grbl")]
    pub fn begin_with(&mut self, command: Command<AXES>) {
        self.interpreter.gathered = Gathered::Single(core::cell::Cell::new(command));
    }

    /// Does a bounded part of the work, and returns the next command when it is complete. A call reads at
    /// most one logical line, or 256 bytes of text, or a part of a line with much arithmetic.
    ///
    /// # Errors
    /// The first word that the language does not have, or that is not possible. After an error, only
    /// [`Step::End`] follows, until [`Self::go_on`].
    // Not inlined, so that its stack frame is gone before the command is carried out.
    #[inline(never)]
    pub fn step(&mut self) -> Result<Step<AXES>, NcError> {
        if self.refused {
            return Ok(Step::End);
        }
        if !self.interpreter.warnings.is_empty()
            && let Some(warning) = self.interpreter.warnings.pop_front()
        {
            return Ok(Step::Warning(warning));
        }
        if let Some(command) = self.interpreter.gathered.take_single() {
            self.interpreter.quiet = 0;
            return Ok(Step::Command(command));
        }
        let is_motion = match self.interpreter.front() {
            Some(item) => matches!(item.kind, ItemKind::Motion),
            #[cfg(feature = "grbl")]
            None if self.interpreter.foreign.is_under_way() => {
                self.interpreter.foreign_part(self.line);
                return Ok(Step::Working);
            }
            None if self.interpreter.phase == Phase::Ended => return Ok(Step::End),
            None => match self.work() {
                Ok(Work::Line) => return Ok(Step::Working),
                Ok(Work::Late) => return Ok(Step::Late),
                Ok(Work::Motion) if self.interpreter.warnings.is_empty() => true,
                Ok(Work::Motion) => {
                    // A warning about the line comes first.
                    let item = Item { span: Span::default(), kind: ItemKind::Motion };
                    let _ = self.interpreter.queue.push_back(item);
                    return Ok(Step::Working);
                }
                Err(error) => {
                    self.refuse();
                    return Err(error);
                }
            },
        };
        self.interpreter.quiet = 0;
        // Separate from the other commands, so that the motion is not copied.
        if is_motion && let Gathered::Motion(motion) = &self.interpreter.gathered {
            let _ = self.interpreter.queue.pop_front();
            return Ok(Step::Command(Command::Motion(motion.get())));
        }
        self.hand_out()
    }

    /// Whether the next step returns a command that changes the dynamics of the following blocks: slope,
    /// weights, path limits.
    pub(crate) fn restricts(&self) -> bool {
        let Interpreter { gathered, warnings, .. } = &*self.interpreter;
        if !functions::ISG.is_built() || !warnings.is_empty() || self.refused {
            return false;
        }
        if let Gathered::Single(command) = gathered {
            return matches!(command.get(), Command::Slope(..) | Command::VectorLimit(..));
        }
        let weighs = |item: &Item| matches!(item.kind, ItemKind::WeightAll(..) | ItemKind::WeightAxes(_));
        self.interpreter.front().is_some_and(weighs)
    }

    /// The command that [`Self::restricts`] announces, without its place. Returns `None` if
    /// [`Self::restricts`] is false.
    #[cold]
    #[inline(never)]
    pub(crate) fn restriction(&self) -> Option<Restriction<AXES>> {
        let interpreter = &*self.interpreter;
        if let Gathered::Single(command) = &interpreter.gathered {
            return match command.get() {
                Command::Slope(_, slope) => Some(Restriction::Slope(slope)),
                Command::VectorLimit(_, limit) => Some(Restriction::VectorLimit(limit)),
                _ => None,
            };
        }
        let (kind, percent) = match interpreter.front()?.kind {
            ItemKind::WeightAll(kind, percent) => (kind, [Some(percent); AXES]),
            ItemKind::WeightAxes(kind) => (kind, interpreter.values),
            _ => return None,
        };
        Some(Restriction::Weight(Weight { kind, percent }))
    }

    /// Whether the last step did little work, so that another step may follow in the same call of the
    /// planner.
    pub(crate) fn has_done_little(&self) -> bool {
        let Interpreter { gathered, calculator, .. } = &*self.interpreter;
        let waits = self.interpreter.front().is_some() || gathered.is_single();
        calculator.has_done_no_more_than(if waits { LITTLE_LINE } else { LITTLE })
    }

    /// The data of the machine that the decoder uses: names and kinds of axes, zero offsets.
    pub fn setup(&self) -> &Setup<AXES> {
        &self.interpreter.setup
    }

    /// Position of the axes after the last command: machine coordinates.
    pub fn position(&self) -> [Position; AXES] {
        self.interpreter.position
    }

    /// Refuses the current line, for the decoder or for the receiver of the command. The rest of the line is
    /// dropped, and the modal state before the line (G words, F, R, zero offset, G92) is restored. P
    /// parameters keep values that the line has assigned.
    pub(crate) fn refuse(&mut self) {
        self.interpreter.refuse();
        self.refused = true;
    }

    /// Whether a line was refused, so that [`Self::go_on`] may continue after it.
    pub fn is_refused(&self) -> bool {
        self.refused
    }

    /// Continues after a refused line, from `position` (machine coordinates). A loop, branch or call in the
    /// refused line does not begin. If the refusal was about a missing closing word at the end of a program,
    /// this word is no longer required.
    pub fn go_on(&mut self, position: [Position; AXES]) {
        self.interpreter.stand_at(position);
        self.reader.go_on();
        self.refused = false;
    }

    /// Begins another text at its start, from `position` (machine coordinates), and returns the previous
    /// text. If `keeps` is true, modal functions, F, G92 and P parameters stay in force; otherwise they are
    /// as at program start. Zero offsets always stay.
    pub fn load(&mut self, text: T, position: [Position; AXES], keeps: bool) -> T {
        self.restart(position, keeps);
        self.reader.replace(text)
    }

    /// Begins the next program of the same text, from `position` (machine coordinates).
    pub fn load_next(&mut self, position: [Position; AXES]) {
        let here = self.reader.next_start();
        let mark = self.interpreter.flow.frames.first().map_or(here, |frame| frame.back);
        self.restart(position, false);
        self.reader.next_program(mark);
    }

    fn restart(&mut self, position: [Position; AXES], keeps: bool) {
        self.interpreter.restart(keeps);
        self.interpreter.stand_at(position);
        self.refused = false;
    }

    /// Sets the position of an axis that moved without the decoder, for example after an oscillation or a
    /// jog.
    pub fn set_position(&mut self, axis: usize, position: Position) {
        self.interpreter.stand_there(axis, position);
    }

    /// Sets all axes of the program to this position, after a change of the transformation.
    #[cfg(feature = "kinematics")]
    pub fn stand_at(&mut self, position: [Position; AXES]) {
        self.interpreter.stand_at(position);
    }

    /// Sets the offset of one axis in a zero offset (`set` 0…5 for G54…G59). The offset is valid from the
    /// next line on, even if that zero offset is active. Returns `false` if there is no such set or axis, or
    /// if the offset is outside ±[`COORDINATE_MAX`].
    #[must_use]
    pub fn set_zero_offset(&mut self, set: usize, axis: usize, offset: Position) -> bool {
        let slot = self.interpreter.setup.zero_offsets.get_mut(set).and_then(|offsets| offsets.get_mut(axis));
        match slot {
            Some(slot) if in_range(offset) => {
                *slot = offset;
                true
            }
            _ => false,
        }
    }

    /// The modal state after the lines read so far; `None` inside a line.
    #[cfg(feature = "grbl")]
    pub fn in_force(&self) -> Option<super::InForce<AXES>> {
        self.is_between_lines().then(|| self.interpreter.in_force())
    }

    /// Restores an earlier modal state, or that of program start. The state is valid from the next line on.
    /// Returns `false`, and changes nothing, inside a line.
    #[cfg(feature = "grbl")]
    #[must_use]
    pub fn put_in_force(&mut self, force: &super::InForce<AXES>) -> bool {
        let may = self.is_between_lines();
        if may {
            self.interpreter.put_in_force(force);
        }
        may
    }

    /// The value of a parameter after the lines read so far; `None` if it has no value. `text` names the
    /// parameter as a comment does, without `#`: `100`, `<name>`.
    #[cfg(feature = "dialects")]
    pub fn parameter(&self, text: &[u8]) -> Option<f64> {
        self.interpreter.parameter(text)
    }

    /// The zero offsets and stored positions in force, including those that programs have stored.
    #[cfg(feature = "grbl")]
    pub fn stored(&self) -> super::StoredOffsets<AXES> {
        self.interpreter.stored()
    }

    /// Restores zero offsets and stored positions, valid from the next line on. Returns `false`, and changes
    /// nothing, if a value is beyond ±100 000 mm.
    #[cfg(feature = "grbl")]
    #[must_use]
    pub fn put_stored(&mut self, stored: &super::StoredOffsets<AXES>) -> bool {
        let may = stored.is_in_range();
        if may {
            self.interpreter.put_stored(stored);
        }
        may
    }

    /// The motion of the current line, if it has one.
    pub(crate) fn motion(&self) -> Option<Motion<AXES>> {
        if self.interpreter.moves { self.interpreter.gathered.motion() } else { None }
    }

    /// Whether the lines read so far are completely decoded, and all their commands are returned.
    pub(crate) fn is_between_lines(&self) -> bool {
        let Interpreter { queue, gathered, calculator, .. } = &self.interpreter;
        #[cfg(feature = "grbl")]
        if !self.refused && self.interpreter.foreign.is_under_way() {
            return false;
        }
        self.refused || queue.is_empty() && !gathered.is_single() && !calculator.is_halted()
    }

    /// Reads a slice of text and interprets the line when it is complete.
    fn work(&mut self) -> Result<Work, NcError> {
        let goes_on = self.interpreter.calculator.begin();
        let fill = if goes_on { Fill::Line } else { self.fill()? };
        let next = match fill {
            Fill::Partial => return Ok(Work::Line),
            Fill::Late => return Ok(Work::Late),
            Fill::Line => {
                let bounds = Bounds { start: self.reader.line_start(), next: self.reader.next_start() };
                self.interpreter.line(self.line, bounds, goes_on)
            }
            #[cfg(feature = "grbl")]
            Fill::End if !self.interpreter.is_isg() => {
                self.interpreter.end_of_foreign_text(self.reader.here())
            }
            Fill::End => match self.interpreter.phase {
                Phase::Running => self.interpreter.end_of_program(),
                Phase::Heads => Err(Refusal::At(self.reader.here(), NcErrorKind::NoMainProgram)),
                Phase::Start => {
                    // A file without blocks.
                    self.interpreter.phase = Phase::Running;
                    Ok(self.interpreter.finish_program())
                }
                Phase::Ended => Ok(Next::Line),
            },
        };
        #[cfg(feature = "plc")]
        let next = match next {
            Ok(_) if !self.interpreter.calculator.is_halted() => {
                let written = self.interpreter.write_out(self.line.bytes(), &self.externals);
                written.map_err(Refusal::Here).and(next)
            }
            next => next,
        };
        match next {
            _ if self.interpreter.calculator.is_halted() => {}
            Ok(Next::Line) => {}
            Ok(Next::Motion) => return Ok(Work::Motion),
            Ok(Next::At(mark)) => self.jump(mark)?,
            Ok(Next::File(name)) => self.enter_file(name)?,
            Err(refusal) => {
                let error = self.error(refusal);
                if let Some(mark) = self.interpreter.recover(error.kind) {
                    self.reader.seek(mark);
                }
                return Err(error);
            }
        }
        Ok(Work::Line)
    }

    /// Continues at another line.
    fn jump(&mut self, mark: Mark) -> Result<(), NcError> {
        if !self.reader.holds(mark) {
            self.interpreter.stay(mark);
            let span = Cursor::new(self.line.bytes()).rest_of_word();
            return Err(self.error(Refusal::Here(Fault { span, kind: NcErrorKind::BehindWindow })));
        }
        self.interpreter.flow.left = false;
        self.reader.seek(mark);
        Ok(())
    }

    /// Reads a slice of text.
    fn fill(&mut self) -> Result<Fill, NcError> {
        // The previous line is done.
        self.interpreter.before = Before::Alike;
        let from = self.reader.next_start().offset;
        let fill = self.reader.fill(self.line)?;
        let bytes = self.reader.next_start().offset.wrapping_sub(from);
        self.interpreter.calculator.charge(LINE + bytes / BYTES);
        #[cfg(feature = "grbl")]
        if fill == Fill::Line {
            self.interpreter.foreign.note = self.reader.foreign.take();
        }
        #[cfg(feature = "plc")]
        if fill == Fill::Line {
            self.interpreter.look_up(self.line.bytes(), &self.externals);
        }
        if let (Fill::Line, Some(place)) = (fill, self.reader.unclosed()) {
            self.interpreter.warn_at(place, NcWarningKind::UnclosedComment);
        }
        Ok(fill)
    }

    /// Continues in the file that the current line names.
    fn enter_file(&mut self, name: Span) -> Result<(), NcError> {
        let from = usize::from(name.at);
        let bytes = self.line.bytes().get(from..from + usize::from(name.len)).unwrap_or(&[]);
        let kind = match core::str::from_utf8(bytes).map(|name| self.reader.open(name)) {
            Ok(Ok(Some(file))) => {
                let start = self.interpreter.enter_file(file);
                self.reader.seek(start);
                return Ok(());
            }
            Ok(Ok(None)) | Err(_) => NcErrorKind::NoFile,
            Ok(Err(_)) => NcErrorKind::Unreadable,
        };
        // The call has not begun.
        self.interpreter.flow.leave_call();
        #[cfg(feature = "grbl")]
        self.interpreter.leave_missing_file();
        Err(self.error(Refusal::Here(Fault { span: name, kind })))
    }

    /// Adds place and text to a refusal.
    fn error(&mut self, refusal: Refusal) -> NcError {
        let mut error = match refusal {
            Refusal::Here(fault) => self.line.error(fault.span, fault.kind),
            Refusal::At(place, kind) => self.reader.error_at(place, kind),
        };
        if matches!(error.kind, NcErrorKind::AxisNotHere | NcErrorKind::UnknownWord | NcErrorKind::NoMainAxis)
        {
            for (i, name) in self.interpreter.setup.names.iter().enumerate() {
                // A shortened list is still useful.
                let _ = error.axes.push_str(if i > 0 { ", " } else { "" });
                let _ = error.axes.push_str(name.as_str());
            }
        }
        error
    }

    /// Returns the command of an item in the queue: any command except a motion.
    #[inline(never)]
    fn hand_out(&mut self) -> Result<Step<AXES>, NcError> {
        let item = self.interpreter.queue.pop_front();
        Ok(item.and_then(|item| self.command_of(item)).map_or(Step::Working, Step::Command))
    }

    /// The command of an item in the queue.
    fn command_of(&mut self, item: Item) -> Option<Command<AXES>> {
        let i = &mut *self.interpreter;
        let head = Head { n: i.n, place: self.line.place(item.span), in_motion: i.moves };
        #[cfg(feature = "grbl")]
        let head = Head { in_motion: head.in_motion && i.is_isg(), ..head };
        let contour = |switch| Command::Contour(head, Contour { switch: Some(switch), ..Contour::default() });
        Some(match item.kind {
            ItemKind::Motion => Command::Motion(i.gathered.motion()?),
            ItemKind::Dwell(time) => Command::Dwell(head, time),
            ItemKind::M(code) => Command::M(head, code),
            ItemKind::H(code) => Command::H(head, code),
            ItemKind::Spindle(speed) => Command::Spindle(head, speed),
            ItemKind::Tool(number) => Command::Tool(head, number),
            ItemKind::ToolOffset(number) => Command::ToolOffset(head, number),
            ItemKind::EndFeed => Command::EndFeed(head),
            ItemKind::ProgramEnd(code) => Command::ProgramEnd(head, code),
            #[cfg(feature = "grbl")]
            ItemKind::Pause(code) => Command::Pause(head, code),
            #[cfg(feature = "grbl")]
            ItemKind::Output => match i.foreign.output {
                (Function::Input(wait), _) => Command::WaitInput(head, wait),
                (function, at_once) => Command::Output(head, function, at_once),
            },
            #[cfg(feature = "grbl")]
            ItemKind::Message => Command::Message(Head { place: i.foreign.message, ..head }),
            #[cfg(feature = "grbl")]
            ItemKind::Probe(tenth) => {
                let Motion { target, feed, .. } = i.gathered.motion()?;
                let (towards, must_switch) = (tenth < 4, tenth % 2 == 0);
                Command::Probe(head, Probe { towards, must_switch, target, feed })
            }
            #[cfg(feature = "grbl")]
            ItemKind::Blend(deviation) => {
                let (switch, method) = (Some(ContourSwitch::On), Some(ContourMethod::Dev));
                let path_dev = Some(deviation);
                Command::Contour(head, Contour { switch, method, path_dev, ..Contour::default() })
            }
            ItemKind::WeightAll(..) | ItemKind::WeightAxes(_) if !functions::ISG.is_built() => return None,
            ItemKind::WeightAll(kind, percent) => {
                Command::Weight(head, Weight { kind, percent: [Some(percent); AXES] })
            }
            ItemKind::WeightAxes(kind) => Command::Weight(head, Weight { kind, percent: i.values }),
            ItemKind::Switch(number) => match number {
                60 => Command::ExactStop(head, ExactStop::Block),
                360 => Command::ExactStop(head, ExactStop::On),
                359 => Command::ExactStop(head, ExactStop::Off),
                61 => contour(ContourSwitch::Block),
                261 => contour(ContourSwitch::On),
                260 => contour(ContourSwitch::Off),
                93 => Command::FeedMode(head, FeedMode::Time),
                95 => Command::FeedMode(head, FeedMode::PerRevolution),
                194 => Command::FeedMode(head, FeedMode::Percent),
                151 => Command::Spline(head, Spline::On),
                _ => Command::Spline(head, Spline::Off),
            },
        })
    }
}
