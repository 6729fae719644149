//! Interprets logical lines, one after the other. A line is a program head, a `$` statement, a `#` command, a
//! call, or a block of words. A short queue holds the commands that a line gives.
use super::block::{Item, Items, Waiting, checksum_of};
use super::calculator::Calculator;
use super::cursor::Cursor;
#[cfg(feature = "grbl")]
use super::dialect::Foreign;
use super::expression::expression;
use super::flow::{Ending, Flow, Frame, Passing, Subroutine, hash};
use super::line::{Line, Mark};
use super::modal::{Before, Modal};
use super::number::Number;
use super::plain::Letters;
use super::{Command, Fault, Motion, NcErrorKind, NcWarning, NcWarningKind, Place, Setup, Span, real};
use crate::machine::functions;
use crate::quantity::Position;
use core::cell::Cell;
use heapless::Deque;

/// Largest number of results that a block may put into the queue.
pub const BLOCK_WORDS: usize = 16;

/// Largest number of lines carried out without a command. More lines count as an endless loop. Skipped lines
/// do not count.
pub const QUIET_LINES: u32 = 1_000_000;

/// State of the program.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Phase {
    /// Before the first program head.
    Start,
    /// The text begins with local subroutines, and the main program has not come yet.
    Heads,
    Running,
    /// The last commands are being returned; no line follows.
    Ended,
}

/// Where the program continues after a line.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Next {
    Line,
    /// The next line. The current line gives only its motion.
    Motion,
    At(Mark),
    /// The start of the file whose name is in the current line; the call is already open.
    File(Span),
}

/// A refusal of a part of the current line, or of an earlier place in the text.
pub(super) enum Refusal {
    Here(Fault),
    At(Place, NcErrorKind),
}

impl From<Fault> for Refusal {
    fn from(fault: Fault) -> Self {
        Self::Here(fault)
    }
}

/// All state of the decoder except the text.
pub(super) struct Interpreter<const AXES: usize> {
    pub setup: Setup<AXES>,
    pub phase: Phase,
    pub flow: Flow,
    pub calculator: Calculator,
    pub modal: Modal<AXES>,
    /// The state that a refusal of the line restores.
    pub before: Before<AXES>,
    pub letters: Letters,
    /// Programmed end of the last motion, machine coordinates.
    pub position: [Position; AXES],
    /// Rounding remainders of G91 increments, LSB 2^-64. With them, rounding errors do not add up.
    pub rests: [i32; AXES],
    /// Block number of the current line.
    pub n: u32,
    /// Whether the current block moves.
    pub moves: bool,
    /// The results of the current block. They are complete unless the block continues in the next call.
    pub queue: Items,
    pub gathered: Gathered<AXES>,
    /// Values per axis of the block's G130, G132 or G232.
    pub values: [Option<Position>; AXES],
    pub warnings: Deque<NcWarning, 4>,
    /// Arithmetic without brackets in the current word, and its result in thousandths.
    pub computed: Option<(Span, i32)>,
    /// Whether the main program has no head.
    pub headless: bool,
    /// Number of lines carried out since the last command.
    pub quiet: u32,
    /// An assignment of the current line to an outside variable.
    #[cfg(feature = "plc")]
    pub written: Option<super::variable::Write>,
    /// Whether the current line is in a real-time loop.
    #[cfg(feature = "plc")]
    pub in_loop: bool,
    /// State that only programs of other dialects need.
    #[cfg(feature = "grbl")]
    pub foreign: Foreign<AXES>,
}

/// The result of the current line. Each variant is a cell, so that all bits of the empty value are zero.
pub(super) enum Gathered<const AXES: usize> {
    Nothing,
    /// A block that continues in the next call.
    Waiting(Cell<Waiting<AXES>>),
    /// The motion of a block.
    Motion(Cell<Motion<AXES>>),
    /// The command of a block with a single command.
    Single(Cell<Command<AXES>>),
}

impl<const AXES: usize> Gathered<AXES> {
    #[inline(always)]
    pub const fn waits(&self) -> bool {
        matches!(self, Self::Waiting(_))
    }

    #[inline(always)]
    pub const fn is_single(&self) -> bool {
        matches!(self, Self::Single(_))
    }

    /// Takes the stored block, to continue it.
    pub fn take_up(&mut self) -> Option<Waiting<AXES>> {
        if !self.waits() {
            return None;
        }
        let Self::Waiting(waiting) = core::mem::replace(self, Self::Nothing) else { return None };
        Some(waiting.into_inner())
    }

    /// Returns the command of a block with a single command.
    #[inline(always)]
    pub fn take_single(&mut self) -> Option<Command<AXES>> {
        if !self.is_single() {
            return None;
        }
        let Self::Single(command) = core::mem::replace(self, Self::Nothing) else { return None };
        Some(command.into_inner())
    }

    #[inline(always)]
    pub fn motion(&self) -> Option<Motion<AXES>> {
        if let Self::Motion(motion) = self { Some(motion.get()) } else { None }
    }
}

/// Starts of a logical line and of the next one.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub start: Mark,
    pub next: Mark,
}

impl<const AXES: usize> Interpreter<AXES> {
    /// A state whose bits are all zero. Call [`Self::begin`] before use.
    pub const fn blank() -> Self {
        Self {
            setup: Setup::BLANK,
            phase: Phase::Start,
            flow: Flow::new(),
            calculator: Calculator::new(),
            modal: Modal::BLANK,
            before: Before::Alike,
            letters: Letters::BLANK,
            position: [Position::ZERO; AXES],
            rests: [0; AXES],
            n: 0,
            moves: false,
            queue: Items::new(),
            gathered: Gathered::Nothing,
            values: [None; AXES],
            warnings: Deque::new(),
            computed: None,
            headless: false,
            quiet: 0,
            #[cfg(feature = "plc")]
            written: None,
            #[cfg(feature = "plc")]
            in_loop: false,
            #[cfg(feature = "grbl")]
            foreign: Foreign::BLANK,
        }
    }

    /// Resets the state for a machine with this set-up, before the first line. The state is large, so it is
    /// written in place.
    pub fn begin(&mut self, given: &Setup<AXES>) {
        let Self { setup, phase, flow, calculator, modal, before, letters, .. } = self;
        *setup = *given;
        *phase = Phase::Start;
        flow.begin();
        calculator.clear();
        (*modal, *before) = (Modal::new(given.default_index), Before::Alike);
        *letters = Letters::new(given.names.iter().map(|name| &name.0));
        self.stand_at(given.start);
        let Self { n, moves, queue, gathered, values, warnings, quiet, .. } = self;
        (*n, *moves, *quiet) = (0, false, 0);
        queue.clear();
        *gathered = Gathered::Nothing;
        *values = [None; AXES];
        warnings.clear();
        (self.computed, self.headless) = (None, false);
        #[cfg(feature = "grbl")]
        self.begin_foreign();
    }

    /// Sets all axes to this position; programs continue from there.
    pub fn stand_at(&mut self, position: [Position; AXES]) {
        (self.position, self.rests) = (position, [0; AXES]);
    }

    /// Sets an axis to this position.
    pub fn stand_there(&mut self, axis: usize, position: Position) {
        if let (Some(slot), Some(rest)) = (self.position.get_mut(axis), self.rests.get_mut(axis)) {
            (*slot, *rest) = (position, 0);
        }
    }

    /// The first item of the current block, once the block is completely read.
    pub fn front(&self) -> Option<&Item> {
        if self.gathered.waits() { None } else { self.queue.front() }
    }

    /// Stores a warning. A line has at most four warnings; further ones are dropped.
    pub fn warn(&mut self, line: &Line, span: Span, kind: NcWarningKind) {
        self.warn_at(line.place(span), kind);
    }

    pub fn warn_at(&mut self, place: Place, kind: NcWarningKind) {
        let _ = self.warnings.push_back(NcWarning { place, kind });
    }

    /// The block that is still open at the end of the running program.
    pub fn unfinished(&mut self) -> Option<Refusal> {
        if let Passing::Label(_) = self.flow.passing {
            return Some(Refusal::At(self.flow.origin, NcErrorKind::NoLabel));
        }
        let open = self.flow.innermost()?;
        Some(Refusal::At(open.place, NcErrorKind::Unclosed { closing: open.block.closing() }))
    }

    /// Interprets a line, or continues it. [`Calculator::is_halted`] tells whether a refusal only means that
    /// the line continues later.
    pub fn line(&mut self, line: &Line, bounds: Bounds, goes_on: bool) -> Result<Next, Refusal> {
        #[cfg(feature = "grbl")]
        let goes_on = goes_on || !self.takes_plain();
        if !goes_on
            && self.phase == Phase::Running
            && self.flow.passing == Passing::No
            && self.plain_block(line).is_some()
        {
            return Ok(Next::Motion);
        }
        #[cfg(feature = "grbl")]
        if !self.is_isg() {
            return self.foreign_line(line, bounds);
        }
        let mut c = Cursor::new(line.bytes());
        if self.gathered.waits() {
            return Ok(self.words(&mut c, line)?);
        }
        if c.at_end() {
            return Ok(Next::Line);
        }
        if c.peek() == b'%' {
            if self.phase == Phase::Running {
                let main = self.flow.frames.is_empty();
                if main && self.headless {
                    self.warn(line, c.rest_of_word(), NcWarningKind::HeadEnds);
                }
                return self.end_of_program();
            }
            return Ok(self.head(&mut c, bounds)?);
        }
        match self.phase {
            Phase::Heads | Phase::Ended => return Ok(Next::Line),
            Phase::Start => {
                self.phase = Phase::Running;
                self.flow.program = bounds.start;
                self.headless |= self.flow.frames.is_empty();
            }
            Phase::Running => {}
        }
        if self.flow.is_passing() && !self.pass(&mut c, bounds)? {
            let Passing::End(ending) = self.flow.passing else { return Ok(Next::Line) };
            return Ok(self.end_by_word(ending));
        }
        self.quiet = self.quiet.saturating_add(u32::from(!goes_on));
        if self.quiet > QUIET_LINES {
            return Err(Refusal::Here(Fault { span: c.rest_of_word(), kind: NcErrorKind::Endless }));
        }
        Ok(self.statement(&mut c, line, bounds)?)
    }

    /// Reads a program head: `%name` or `%L name`.
    fn head(&mut self, c: &mut Cursor<'_>, bounds: Bounds) -> Result<Next, Fault> {
        c.bump();
        let local = c.raw().eq_ignore_ascii_case(&b'L') && {
            let mut ahead = *c;
            ahead.bump();
            matches!(ahead.raw(), b' ' | 0)
        };
        if local {
            c.bump();
        }
        let name = c.rest_of_word();
        if name.len > 83 {
            return name.fault(NcErrorKind::NameTooLong);
        }
        if !local {
            self.phase = Phase::Running;
            self.headless &= !self.flow.frames.is_empty();
            self.flow.program = bounds.next;
            return Ok(Next::Line);
        }
        if name.len == 0 {
            return c.expected("a name after %L");
        }
        self.phase = Phase::Heads;
        let entry = Subroutine { name: hash(c.part(name)), body: bounds.next };
        let same = |s: &&Subroutine| s.name == entry.name && s.body.file == entry.body.file;
        match self.flow.subroutines.iter().find(same) {
            // The file was called earlier.
            Some(known) if known.body == entry.body => return Ok(Next::Line),
            Some(_) => return name.fault(NcErrorKind::SubroutineTwice),
            None => {}
        }
        if self.flow.subroutines.push(entry).is_err() {
            return name.fault(NcErrorKind::TooManySubroutines);
        }
        Ok(Next::Line)
    }

    /// Handles the next program head, or the end of the text: returns to the caller, or ends the program.
    pub fn end_of_program(&mut self) -> Result<Next, Refusal> {
        match self.unfinished() {
            Some(refusal) => Err(refusal),
            None => Ok(self.finish_program()),
        }
    }

    /// Returns to the caller, or ends the program (M17, M29, end of the text).
    pub fn finish_program(&mut self) -> Next {
        match self.flow.leave_call() {
            Some(back) => {
                self.flow.left = true;
                Next::At(back)
            }
            None => {
                self.phase = Phase::Ended;
                Next::Line
            }
        }
    }

    /// Carries out M02, M30, M17 or M29: at once, or after the closing words of the surrounding control
    /// blocks.
    pub fn end_by_word(&mut self, ending: Ending) -> Next {
        if self.flow.innermost().is_some() {
            self.flow.passing = Passing::End(ending);
            return Next::Line;
        }
        self.flow.passing = Passing::No;
        match ending {
            Ending::Subroutine => self.finish_program(),
            Ending::Program => {
                self.phase = Phase::Ended;
                Next::Line
            }
        }
    }

    /// Interprets a line that is not skipped.
    fn statement(&mut self, c: &mut Cursor<'_>, line: &Line, bounds: Bounds) -> Result<Next, Fault> {
        self.n = 0;
        self.moves = false;
        if self.block_skip(c) {
            return Ok(Next::Line);
        }
        let numbered = c.peek_upper() == b'N';
        self.block_number(c)?;
        if c.peek() == b'[' {
            // `[NAME]`: a label.
            while !c.at_end() && !c.eat(b']') {
                c.bump();
            }
        }
        #[cfg(feature = "plc")]
        if self.in_loop && matches!(c.peek_upper(), b'$' | b'L') {
            return c.rest_of_word().fault(NcErrorKind::InLoop);
        }
        match c.peek_upper() {
            0 => Ok(Next::Line),
            b'$' if !functions::EXPRESSIONS.is_built() => {
                c.rest_of_word().needs(functions::EXPRESSIONS)?;
                Ok(Next::Line)
            }
            b'$' => self.control(c, line, bounds),
            b'#' => {
                self.hash_command(c, line)?;
                Ok(Next::Line)
            }
            b'/' => c.here().fault(NcErrorKind::NotAvailable("block skip")),
            b'"' => c.rest_of_word().fault(NcErrorKind::NotAvailable("macro")),
            b'L' => self.call(c, bounds),
            _ => {
                if numbered && let Some(at) = checksum_of(line.bytes()) {
                    c.back_to(at);
                    return c.rest_of_word().fault(NcErrorKind::Checksum);
                }
                self.words(c, line)
            }
        }
    }

    /// Reads `/` at the start of a block. Returns whether the block is left out.
    #[cfg(feature = "grbl")]
    fn block_skip(&self, c: &mut Cursor<'_>) -> bool {
        // `/2` is a switch of its own, which is not there.
        let mark = c.mark();
        if !c.eat(b'/') {
            return false;
        }
        if c.peek().is_ascii_digit() {
            c.back_to(mark);
            return false;
        }
        self.setup.foreign.block_delete
    }

    /// A build without `grbl` has no switch for blocks with `/`, and refuses them.
    #[cfg(not(feature = "grbl"))]
    #[inline(always)]
    const fn block_skip(&self, _: &mut Cursor<'_>) -> bool {
        false
    }

    /// Reads a block number: `N10`, `N10:`, `NP123`. A fraction is cut off.
    fn block_number(&mut self, c: &mut Cursor<'_>) -> Result<(), Fault> {
        let mark = c.mark();
        if c.peek_upper() != b'N' {
            return Ok(());
        }
        c.bump();
        let number = expression(c, &self.calculator)?;
        if let Number::Decimal { negative: false, mantissa, scale: 0 } = number
            && let Ok(n) = u32::try_from(mantissa)
        {
            self.n = n;
            c.eat(b':');
            return Ok(());
        }
        let value = real::trunc(number.real());
        if !(0.0..4_294_967_296.0).contains(&value) {
            return c.since(mark).fault(NcErrorKind::Range {
                what: "block number",
                min: 0,
                max: u32::MAX,
                unit: "",
                above: false,
            });
        }
        self.n = value as u32;
        c.eat(b':');
        Ok(())
    }

    /// Reads a call: `LL name`, `L file`, `L "file"`.
    fn call(&mut self, c: &mut Cursor<'_>, bounds: Bounds) -> Result<Next, Fault> {
        c.bump();
        let local = c.raw().eq_ignore_ascii_case(&b'L');
        if !local {
            return self.call_file(c, bounds);
        }
        c.bump();
        if c.raw() != b' ' {
            return c.expected("a blank and a name after LL");
        }
        let name = c.rest_of_word();
        if name.len == 0 {
            return c.expected("a name after LL");
        }
        let Some(found) = self.flow.subroutine(hash(c.part(name))) else {
            return name.fault(NcErrorKind::NoSubroutine);
        };
        c.step_over(name);
        c.require_end("LL")?;
        self.open_call(name, bounds)?;
        self.flow.program = found.body;
        Ok(Next::At(found.body))
    }

    /// Reads the file name after `L`.
    fn call_file(&mut self, c: &mut Cursor<'_>, bounds: Bounds) -> Result<Next, Fault> {
        if !matches!(c.raw(), b' ' | b'"') {
            return c.expected("a blank and a file name after L");
        }
        let quoted = c.eat(b'"');
        let name = if quoted {
            let mark = c.mark();
            while !matches!(c.raw(), b'"' | 0) {
                c.bump();
            }
            c.since(mark)
        } else {
            let name = c.rest_of_word();
            c.step_over(name);
            name
        };
        if name.len == 0 {
            return c.expected("a file name after L");
        }
        if name.len > 83 {
            return name.fault(NcErrorKind::NameTooLong);
        }
        if quoted {
            c.require(b'"', "\" behind the file name")?;
        }
        c.require_end("L")?;
        self.open_call(name, bounds)?;
        Ok(Next::File(name))
    }

    fn open_call(&mut self, name: Span, bounds: Bounds) -> Result<(), Fault> {
        let blocks = self.flow.blocks.len() as u8;
        let frame = Frame { back: bounds.next, program: self.flow.program, blocks };
        self.flow.frames.push(frame).map_err(|_| Fault { span: name, kind: NcErrorKind::CallTooDeep })
    }

    /// Begins the called file: with its heads, or its first block.
    pub fn enter_file(&mut self, file: u16) -> Mark {
        let start = Mark::start_of(file);
        self.phase = Phase::Start;
        self.flow.program = start;
        start
    }

    /// Skips lines until a line ends the skipping. Returns `true` if this line has to be carried out.
    fn pass(&mut self, c: &mut Cursor<'_>, bounds: Bounds) -> Result<bool, Fault> {
        let start = c.mark();
        let label = super::control::label_of(c);
        if let (Passing::Label(wanted), Some(label)) = (self.flow.passing, label)
            && wanted == label
        {
            c.back_to(start);
            return self.arrive(c);
        }
        if c.peek() != b'$' {
            return Ok(false);
        }
        self.pass_control(c, start, bounds)
    }
}
