//! O words of LinuxCNC: subroutines, loops and branches. Also M98 and M99: subprograms by number.
//!
//! A word finds its partner by the label after O, for example `o100` or `o<name>`. In lines that the program
//! skips, the decoder reads only O words.
use super::Interpreter;
use super::block::literal;
use super::parameter::{ARGUMENTS, name};
use super::words::NOT_BUILT;
use crate::machine::functions;
use crate::nc::cursor::Cursor;
use crate::nc::flow::{CALL_DEPTH, NESTING, SUBROUTINES};
use crate::nc::interpreter::{Bounds, Next, Phase};
use crate::nc::line::{Line, Mark};
use crate::nc::number::Number;
use crate::nc::{Fault, NcErrorKind, Place, Span};
use heapless::Vec;

/// The label after O: a number, or the hash of a name with bit 31 set.
pub(super) type Label = u32;

/// Whether lines are skipped, and up to which O word.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Skip {
    /// No lines are skipped.
    No,
    /// Up to `endsub`: a definition is skipped, not carried out.
    Sub(Label),
    /// Up to `elseif`, `else` or `endif`.
    Branch(Label),
    /// Up to `endif`.
    EndIf(Label),
    /// Up to the end of a loop that the program leaves.
    Out(Label),
    /// Up to the `while` at the end of a `do` loop; the decoder then carries out this `while`.
    Round(Label),
    /// Up to the subprogram with this number.
    Program(Label),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    If,
    /// A `while` loop; the mark is the line of the condition.
    While(Mark2),
    /// A `do` loop; the mark is its first line inside.
    Do(Mark2),
    /// A `repeat` loop; the mark is its first line inside, and the number counts the remaining rounds.
    Repeat(Mark2, u32),
}

/// A mark in the text that can be compared.
type Mark2 = (u32, u32, u16);

const fn packed(mark: Mark) -> Mark2 {
    (mark.offset, mark.line, mark.file)
}

const fn mark((offset, line, file): Mark2) -> Mark {
    Mark { offset, line, file }
}

#[derive(Clone, Copy)]
struct Open {
    label: Label,
    kind: Kind,
    place: Place,
}

/// An open call.
#[derive(Clone, Copy)]
struct Frame {
    label: Label,
    back: Mark2,
    /// Start of the caller's file.
    program: Mark,
    /// Number of open blocks at the call.
    blocks: u8,
    /// `#1` to `#30` of the caller.
    locals: [f64; ARGUMENTS],
    /// For M98: the first line of the subprogram, once known, and the number of remaining runs.
    again: Option<(Mark2, u32)>,
    /// Whether the definition of the subroutine is still searched: in a file of its own, or later in the text
    /// after M98.
    seeks: bool,
}

/// State of calls, loops and branches.
pub(super) struct Calls {
    /// `#1` to `#30` of the current call.
    pub locals: [f64; ARGUMENTS],
    /// Value that the last subroutine returned.
    pub value: f64,
    pub returned: bool,
    frames: Vec<Frame, CALL_DEPTH>,
    blocks: Vec<Open, NESTING>,
    subroutines: Vec<(Label, Mark2), SUBROUTINES>,
    skip: Skip,
    /// The place where skipping began, for messages.
    origin: Place,
}

impl Calls {
    pub const BLANK: Self = Self {
        locals: [0.0; ARGUMENTS],
        value: 0.0,
        returned: false,
        frames: Vec::new(),
        blocks: Vec::new(),
        subroutines: Vec::new(),
        skip: Skip::No,
        origin: Place::NONE,
    };

    /// Begins a program without open blocks.
    pub fn clear(&mut self) {
        self.frames.clear();
        self.blocks.clear();
        self.subroutines.clear();
        self.skip = Skip::No;
        (self.locals, self.value, self.returned) = ([0.0; ARGUMENTS], 0.0, false);
    }

    /// Number of open calls.
    pub fn level(&self) -> usize {
        self.frames.len()
    }

    /// Whether lines are skipped.
    pub fn skips(&self) -> bool {
        functions::DIALECTS.is_built() && self.skip != Skip::No
    }

    fn base(&self) -> usize {
        self.frames.last().map_or(0, |frame| frame.blocks.into())
    }

    /// The innermost open block of the current call.
    fn innermost(&mut self) -> Option<&mut Open> {
        if self.blocks.len() > self.base() { self.blocks.last_mut() } else { None }
    }

    /// The block or call that is still open at the end of the text.
    pub fn unfinished(&mut self) -> Option<(Place, NcErrorKind)> {
        if !functions::DIALECTS.is_built() {
            return None;
        }
        let closing = match self.skip {
            Skip::No => None,
            Skip::Sub(_) => Some("endsub"),
            Skip::Branch(_) | Skip::EndIf(_) => Some("endif"),
            Skip::Out(_) | Skip::Round(_) => Some("the end of the loop"),
            Skip::Program(_) => return Some((self.origin, NcErrorKind::NoProgram)),
        };
        if let Some(closing) = closing {
            return Some((self.origin, NcErrorKind::Unclosed { closing }));
        }
        let open = self.innermost()?;
        let closing = match open.kind {
            Kind::If => "endif",
            Kind::While(_) => "endwhile",
            Kind::Do(_) => "while",
            Kind::Repeat(..) => "endrepeat",
        };
        Some((open.place, NcErrorKind::Unclosed { closing }))
    }
}

/// Keywords of O words.
const KEYS: [&str; 15] = [
    "SUB",
    "ENDSUB",
    "CALL",
    "RETURN",
    "IF",
    "ELSEIF",
    "ELSE",
    "ENDIF",
    "WHILE",
    "ENDWHILE",
    "DO",
    "REPEAT",
    "ENDREPEAT",
    "BREAK",
    "CONTINUE",
];

/// An O word: label, place, key. A program number has the key "".
struct Head {
    label: Label,
    name: Option<Span>,
    span: Span,
    key: &'static str,
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Reads an O word at the start of a block. Returns `None`, and reads nothing, if there is no O word.
    pub(super) fn o_word(
        &mut self,
        c: &mut Cursor<'_>,
        line: &Line,
        bounds: Bounds,
    ) -> Result<Option<Next>, Fault> {
        let start = c.mark();
        if c.peek_upper() == b'N' {
            c.bump();
            while matches!(c.peek(), b'0'..=b'9' | b'.') {
                c.bump();
            }
        }
        let fanuc = self.setup.foreign.dialect().is_fanuc();
        if c.peek_upper() != b'O' && !(fanuc && c.peek() == b':') {
            c.back_to(start);
            return Ok(None);
        }
        if !functions::DIALECTS.is_built() {
            return c.here().fault(NcErrorKind::Known { what: "an O word", hint: NOT_BUILT });
        }
        let head = self.o_head(c)?;
        if self.foreign.calls.skips() {
            return self.passed(&head, c, line, bounds).map(Some);
        }
        self.do_o_word(&head, c, line, bounds).map(Some)
    }

    fn o_head(&self, c: &mut Cursor<'_>) -> Result<Head, Fault> {
        let mark = c.mark();
        c.bump();
        let (mut label, mut spelled) = (0, None);
        match c.peek() {
            b'<' => {
                let at = c.mark();
                label = 1 << 31 | name(c)?.hash() >> 1;
                let span = c.since(at);
                spelled = Some(Span { at: span.at + 1, len: span.len.saturating_sub(2) });
            }
            b'0'..=b'9' => {
                let at = c.mark();
                let number = literal(c, at, false)?.number.whole();
                label = number.and_then(|n| u32::try_from(n).ok()).filter(|n| *n < 1 << 31).unwrap_or(0);
                spelled = Some(c.since(at));
            }
            _ => {}
        }
        if spelled.is_none() {
            c.back_to(mark);
            return c.here().fault(NcErrorKind::Known {
                what: "O word",
                hint: "a number or a name in < > behind O, then sub, call, if, while, do or repeat",
            });
        }
        let span = c.since(mark);
        let fanuc = self.setup.foreign.dialect().is_fanuc();
        let word = c.letters();
        let key = KEYS.into_iter().find(|key| word.is(key));
        if (fanuc || key.is_none()) && !word.bytes().is_empty() {
            c.back_to(mark);
            let wanted = if fanuc {
                "the O number alone in its block"
            } else {
                "sub, call, if, while, do or repeat behind the O number"
            };
            return c.here().fault(NcErrorKind::Expected(wanted));
        }
        Ok(Head { label, name: spelled, span, key: key.unwrap_or("") })
    }

    /// Handles an O word in skipped lines.
    fn passed(
        &mut self,
        head: &Head,
        c: &mut Cursor<'_>,
        line: &Line,
        bounds: Bounds,
    ) -> Result<Next, Fault> {
        let same = |label: Label| label == head.label;
        if let (Skip::Branch(label), "ELSEIF") = (self.foreign.calls.skip, head.key) {
            if same(label) && self.evaluate_in_brackets(c)? != 0.0 {
                self.foreign.calls.skip = Skip::No;
                self.open(head, Kind::If, line)?;
            }
            return Ok(Next::Line);
        }
        let calls = &mut self.foreign.calls;
        match (calls.skip, head.key) {
            (Skip::Sub(label), "ENDSUB") | (Skip::EndIf(label), "ENDIF") if same(label) => {
                calls.skip = Skip::No;
            }
            (Skip::Branch(label), "ENDIF" | "ELSE") if same(label) => {
                calls.skip = Skip::No;
                if head.key == "ELSE" {
                    self.open(head, Kind::If, line)?;
                }
            }
            (Skip::Out(label), "ENDWHILE" | "ENDREPEAT" | "WHILE") if same(label) => calls.skip = Skip::No,
            (Skip::Round(label), "WHILE") if same(label) => {
                calls.skip = Skip::No;
                return self.do_o_word(head, c, line, bounds);
            }
            (Skip::Program(label), "" | "SUB") if same(label) => {
                calls.skip = Skip::No;
                if let Some(frame) = calls.frames.last_mut() {
                    frame.seeks = false;
                    frame.again = frame.again.map(|(_, count)| (packed(bounds.next), count));
                }
            }
            _ => {}
        }
        Ok(Next::Line)
    }

    /// Carries out an O word.
    fn do_o_word(
        &mut self,
        head: &Head,
        c: &mut Cursor<'_>,
        line: &Line,
        bounds: Bounds,
    ) -> Result<Next, Fault> {
        let next = match head.key {
            "" => Next::Line,
            "SUB" => self.define(head, line, bounds)?,
            "CALL" => self.call_sub(head, c, bounds)?,
            "RETURN" | "ENDSUB" => {
                let value = if c.at_end() { None } else { Some(self.evaluate_in_brackets(c)?) };
                self.leave_sub(head, value)?
            }
            "IF" => {
                let taken = self.evaluate_in_brackets(c)? != 0.0;
                if taken {
                    self.open(head, Kind::If, line)?
                } else {
                    self.skip(Skip::Branch(head.label), head, line)
                }
                Next::Line
            }
            "ELSEIF" | "ELSE" => {
                // After a branch that was carried out, the condition is not evaluated.
                self.close_branch(head)?;
                self.skip(Skip::EndIf(head.label), head, line);
                return Ok(Next::Line);
            }
            "ENDIF" => {
                self.close_branch(head)?;
                Next::Line
            }
            _ => self.do_loop(head, c, line, bounds)?,
        };
        c.require_end("an O word")?;
        Ok(next)
    }

    fn do_loop(
        &mut self,
        head: &Head,
        c: &mut Cursor<'_>,
        line: &Line,
        bounds: Bounds,
    ) -> Result<Next, Fault> {
        let inner = self.foreign.calls.innermost().copied().filter(|open| open.label == head.label);
        match head.key {
            "WHILE" => {
                let goes = self.evaluate_in_brackets(c)? != 0.0;
                if let Some(Open { kind: Kind::Do(body), .. }) = inner {
                    if goes {
                        return Ok(Next::At(mark(body)));
                    }
                    self.foreign.calls.blocks.pop();
                } else if goes {
                    self.open(head, Kind::While(packed(bounds.start)), line)?;
                } else {
                    self.skip(Skip::Out(head.label), head, line);
                }
                Ok(Next::Line)
            }
            "DO" => {
                self.open(head, Kind::Do(packed(bounds.next)), line)?;
                Ok(Next::Line)
            }
            "REPEAT" => {
                let count = self.evaluate_in_brackets(c)?;
                if count < 0.5 {
                    self.skip(Skip::Out(head.label), head, line);
                } else {
                    let count = Number::Real(crate::nc::real::round(count)).whole();
                    let count = count.and_then(|count| u32::try_from(count).ok()).unwrap_or(u32::MAX);
                    self.open(head, Kind::Repeat(packed(bounds.next), count - 1), line)?;
                }
                Ok(Next::Line)
            }
            "ENDWHILE" | "ENDREPEAT" => self.go_round(head),
            _ => self.leave_or_go_on(head, line),
        }
    }

    /// Carries out `endwhile` and `endrepeat`.
    fn go_round(&mut self, head: &Head) -> Result<Next, Fault> {
        let calls = &mut self.foreign.calls;
        let label = head.label;
        match calls.innermost() {
            Some(Open { label: of, kind: Kind::While(line), .. }) if *of == label => {
                let line = mark(*line);
                calls.blocks.pop();
                Ok(Next::At(line))
            }
            Some(Open { label: of, kind: Kind::Repeat(body, count), .. }) if *of == label => {
                let Some(left) = count.checked_sub(1) else {
                    calls.blocks.pop();
                    return Ok(Next::Line);
                };
                *count = left;
                Ok(Next::At(mark(*body)))
            }
            _ => head.span.fault(NcErrorKind::NoLoop),
        }
    }

    /// Carries out `break` and `continue`.
    fn leave_or_go_on(&mut self, head: &Head, line: &Line) -> Result<Next, Fault> {
        let base = self.foreign.calls.base();
        let at = self
            .foreign
            .calls
            .blocks
            .iter()
            .rposition(|open| open.label == head.label && open.kind != Kind::If);
        let Some(at) = at.filter(|at| *at >= base) else { return head.span.fault(NcErrorKind::NoLoop) };
        self.foreign.calls.blocks.truncate(at + 1);
        if head.key == "BREAK" {
            self.foreign.calls.blocks.truncate(at);
            self.skip(Skip::Out(head.label), head, line);
            return Ok(Next::Line);
        }
        if let Some(Open { kind: Kind::Do(_), .. }) = self.foreign.calls.innermost() {
            self.skip(Skip::Round(head.label), head, line);
            return Ok(Next::Line);
        }
        if let Some(Open { kind: Kind::Repeat(_, 0), .. }) = self.foreign.calls.innermost() {
            self.foreign.calls.blocks.truncate(at);
            self.skip(Skip::Out(head.label), head, line);
            return Ok(Next::Line);
        }
        self.go_round(head)
    }

    fn open(&mut self, head: &Head, kind: Kind, line: &Line) -> Result<(), Fault> {
        let open = Open { label: head.label, kind, place: line.place(head.span) };
        let full = Fault { span: head.span, kind: NcErrorKind::NestingTooDeep };
        self.foreign.calls.blocks.push(open).map_err(|_| full)
    }

    /// Carries out `endif`, or the end of a branch.
    fn close_branch(&mut self, head: &Head) -> Result<(), Fault> {
        match self.foreign.calls.innermost() {
            Some(open) if open.label == head.label && open.kind == Kind::If => {
                self.foreign.calls.blocks.pop();
                Ok(())
            }
            _ => head.span.fault(NcErrorKind::Unopened { opening: "if" }),
        }
    }

    fn skip(&mut self, skip: Skip, head: &Head, line: &Line) {
        self.foreign.calls.skip = skip;
        self.foreign.calls.origin = line.place(head.span);
    }

    /// Carries out `sub`: stores the definition and skips it.
    fn define(&mut self, head: &Head, line: &Line, bounds: Bounds) -> Result<Next, Fault> {
        let calls = &mut self.foreign.calls;
        if let Some(frame) = calls.frames.last_mut()
            && frame.seeks
            && frame.label == head.label
        {
            frame.seeks = false;
            return Ok(Next::Line);
        }
        let body = packed(bounds.next);
        match calls.subroutines.iter().find(|(label, _)| *label == head.label) {
            Some((_, known)) if *known != body => return head.span.fault(NcErrorKind::SubroutineTwice),
            Some(_) => {}
            None => {
                let full = Fault { span: head.span, kind: NcErrorKind::TooManySubroutines };
                calls.subroutines.push((head.label, body)).map_err(|_| full)?;
            }
        }
        self.skip(Skip::Sub(head.label), head, line);
        Ok(Next::Line)
    }

    /// Carries out `call [a] [b] …`.
    fn call_sub(&mut self, head: &Head, c: &mut Cursor<'_>, bounds: Bounds) -> Result<Next, Fault> {
        let mut arguments = [0.0; ARGUMENTS];
        let mut slots = arguments.iter_mut();
        while c.peek() == b'[' {
            let Some(slot) = slots.next() else { return c.expected("at most 30 arguments") };
            *slot = self.evaluate(c)?;
        }
        c.require_end("an O word")?;
        let known = self.foreign.calls.subroutines.iter().find(|(label, _)| *label == head.label);
        let body = known.map(|(_, body)| *body);
        let callee = match (body, head.name) {
            (Some(body), _) => Next::At(mark(body)),
            (None, Some(name)) if head.label >= 1 << 31 => Next::File(name),
            _ => return head.span.fault(NcErrorKind::NoProgram),
        };
        self.enter(head.label, bounds.next, head.span, None, body.is_none())?;
        if body.is_none() {
            // The decoder undoes the call if there is no such file.
            let frame = crate::nc::flow::Frame { back: bounds.next, program: self.flow.program, blocks: 0 };
            let deep = Fault { span: head.span, kind: NcErrorKind::CallTooDeep };
            if self.flow.frames.push(frame).is_err() {
                self.foreign.calls.frames.pop();
                return Err(deep);
            }
        }
        self.foreign.calls.locals = arguments;
        Ok(callee)
    }

    fn enter(
        &mut self,
        label: Label,
        back: Mark,
        span: Span,
        again: Option<(Mark2, u32)>,
        seeks: bool,
    ) -> Result<(), Fault> {
        let program = self.flow.program;
        let calls = &mut self.foreign.calls;
        let (back, blocks, locals) = (packed(back), calls.blocks.len() as u8, calls.locals);
        let frame = Frame { label, back, program, blocks, locals, again, seeks };
        calls.frames.push(frame).map_err(|_| Fault { span, kind: NcErrorKind::CallTooDeep })?;
        let level = calls.level();
        self.foreign.saved.clear(level);
        Ok(())
    }

    /// Undoes a call whose file does not exist.
    pub(in crate::nc) fn leave_missing_file(&mut self) {
        if let Some(frame) = self.foreign.calls.frames.pop() {
            self.foreign.calls.locals = frame.locals;
        }
    }

    /// Carries out `endsub`, `return` and M99.
    fn leave_sub(&mut self, head: &Head, value: Option<f64>) -> Result<Next, Fault> {
        let level = self.foreign.calls.level();
        let Some(frame) = self.foreign.calls.frames.last().copied() else {
            return head.span.fault(NcErrorKind::Unopened { opening: "sub" });
        };
        // `return` may have any label, as in LinuxCNC.
        let is_other = frame.label != head.label && head.key != "RETURN";
        if is_other || frame.again.is_some() {
            return head.span.fault(NcErrorKind::Unopened { opening: "sub" });
        }
        (self.foreign.calls.value, self.foreign.calls.returned) = (value.unwrap_or(0.0), value.is_some());
        Ok(self.go_back(&frame, level))
    }

    fn go_back(&mut self, frame: &Frame, level: usize) -> Next {
        // Names of the call have its level in bits 27 to 30.
        let from = 1 << 31 | (level as u32 + 1) << 27;
        self.calculator.parameters.forget(from, from | ((1 << 27) - 1));
        let calls = &mut self.foreign.calls;
        calls.frames.pop();
        calls.blocks.truncate(frame.blocks.into());
        calls.locals = frame.locals;
        if frame.program.file != self.flow.program.file {
            self.flow.leave_call();
        }
        self.flow.program = frame.program;
        self.end_of_level(level);
        Next::At(mark(frame.back))
    }

    /// M98 P L: calls the subprogram with number P, L times.
    pub(super) fn call_program(
        &mut self,
        label: Label,
        times: u32,
        span: Span,
        line: &Line,
        bounds: Bounds,
    ) -> Result<Next, Fault> {
        let start = Mark::start_of(bounds.start.file);
        self.enter(label, bounds.next, span, Some((packed(start), times.saturating_sub(1))), true)?;
        self.foreign.calls.skip = Skip::Program(label);
        self.foreign.calls.origin = line.place(span);
        Ok(Next::At(start))
    }

    /// Carries out M99.
    pub(super) fn end_of_subprogram(&mut self, span: Span) -> Result<Next, Fault> {
        let level = self.foreign.calls.level();
        let Some(frame) = self.foreign.calls.frames.last_mut() else {
            return span.fault(NcErrorKind::Known {
                what: "M99 in a main program, which runs it again,",
                hint: "M2 or M30",
            });
        };
        if let Some((body, left @ 1..)) = frame.again {
            frame.again = Some((body, left - 1));
            return Ok(Next::At(mark(body)));
        }
        let frame = *frame;
        Ok(self.go_back(&frame, level))
    }

    /// At the end of a called file without `endsub`, returns to the caller.
    pub(super) fn end_of_called_file(&mut self) -> Option<Next> {
        if !functions::DIALECTS.is_built() {
            return None;
        }
        if self.phase == Phase::Ended || self.foreign.calls.skips() {
            return None;
        }
        let level = self.foreign.calls.level();
        let frame = *self.foreign.calls.frames.last()?;
        (frame.program.file != self.flow.program.file).then(|| self.go_back(&frame, level))
    }
}
