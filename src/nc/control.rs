//! `$` statements of ISG's language: branches, loops, jumps.
use super::cursor::{Cursor, Word};
use super::expression::{expression, parameter_target};
use super::flow::{Block, Open, Passing, hash};
use super::interpreter::{Bounds, Interpreter, Next};
use super::line::Line;
use super::{Fault, NcErrorKind, NcWarningKind, Place, Span, real};

/// Expected text for a statement that must be alone in its line.
const STATEMENT: &str = "a $ statement";

/// Bit that distinguishes names from block numbers in labels.
const NAME: u64 = 1 << 63;

/// Reads the label at the start of a line (`N20:` or `[NAME]`); a `$` word may follow. Also skips N.
pub(super) fn label_of(c: &mut Cursor<'_>) -> Option<u64> {
    let mut label = None;
    if c.peek_upper() == b'N' {
        let mark = c.mark();
        c.bump();
        if c.peek().is_ascii_digit()
            && let Ok(number) = c.whole("block number")
        {
            if c.eat(b':') {
                label = Some(u64::from(number));
            }
        } else {
            c.back_to(mark);
            let word = c.rest_of_word();
            c.step_over(word);
        }
    }
    if c.peek() == b'[' {
        label = Some(bracket_label(c)?);
    }
    label
}

/// Reads a label `[NAME]`.
fn bracket_label(c: &mut Cursor<'_>) -> Option<u64> {
    c.bump();
    let mark = c.mark();
    while c.raw() != b']' && c.raw() != 0 {
        c.bump();
    }
    let name = c.part(c.since(mark));
    c.eat(b']').then(|| hash(name) | NAME)
}

/// The role of a `$` word: whether it opens, closes or divides a control block.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Opens,
    Closes,
    Divides,
    Other,
}

fn role(word: &Word) -> Role {
    match word.bytes() {
        b"FOR" | b"WHILE" | b"DO" | b"REPEAT" | b"IF" | b"SWITCH" => Role::Opens,
        b"ENDFOR" | b"ENDWHILE" | b"ENDDO" | b"UNTIL" | b"ENDIF" | b"ENDSWITCH" => Role::Closes,
        b"ELSE" | b"ELSEIF" | b"CASE" | b"DEFAULT" => Role::Divides,
        _ => Role::Other,
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Reads a condition, which is true for values from 0.5 on.
    fn condition(&self, c: &mut Cursor<'_>) -> Result<bool, Fault> {
        Ok(expression(c, &self.calculator)?.real() >= 0.5)
    }

    /// Carries out a `$` statement; the cursor is at `$`. A separate function, so that its stack frame does
    /// not exist while words are read.
    #[inline(never)]
    pub fn control(&mut self, c: &mut Cursor<'_>, line: &Line, bounds: Bounds) -> Result<Next, Fault> {
        let mark = c.mark();
        c.bump();
        let word = c.letters();
        let span = c.since(mark);
        let place = line.place(span);
        let fault = |kind| Fault { span, kind };
        let open = |block| Open { block, start: bounds.start, body: bounds.next, place };
        let mut next = Next::Line;
        match word.bytes() {
            b"FOR" => self.open_for(c, line, open, place)?,
            b"WHILE" => {
                let go = self.condition(c)?;
                c.require_end(STATEMENT)?;
                self.flow.open(open(Block::While)).map_err(fault)?;
                if !go {
                    self.flow.pass(Passing::Out, 0, place);
                }
            }
            b"DO" | b"REPEAT" => {
                c.require_end(STATEMENT)?;
                let block = if word.is("DO") { Block::Do } else { Block::Repeat };
                self.flow.open(open(block)).map_err(fault)?;
            }
            b"IF" => {
                let go = self.condition(c)?;
                if c.peek() == b'$' {
                    return self.if_goto(c, go, line, bounds);
                }
                c.require_end(STATEMENT)?;
                self.flow.open(open(Block::If)).map_err(fault)?;
                if !go {
                    self.flow.pass(Passing::Branch, 0, place);
                }
            }
            b"SWITCH" => {
                let value = self.switch_value(c)?;
                c.require_end(STATEMENT)?;
                self.flow.open(open(Block::Switch { value })).map_err(fault)?;
                self.flow.pass(Passing::Case, 0, place);
            }
            b"ELSEIF" | b"ELSE" => {
                // The branch before this one was carried out, and ends here.
                self.innermost_is("$IF").map_err(fault)?;
                let open_place = self.flow.innermost().map_or(place, |o| o.place);
                self.flow.pass(Passing::Out, 0, open_place);
                return Ok(Next::Line);
            }
            b"CASE" | b"DEFAULT" => {
                // Without $BREAK, the program continues with the blocks of the next case.
                self.innermost_is("$SWITCH").map_err(fault)?;
                if word.is("CASE") {
                    let _ = expression(c, &self.calculator)?;
                }
            }
            b"ENDFOR" | b"ENDWHILE" | b"ENDDO" | b"UNTIL" | b"ENDIF" | b"ENDSWITCH" => {
                next = self.close(c, &word, span)?;
            }
            b"BREAK" => {
                c.require_end(STATEMENT)?;
                let left = self.flow.leave_to_loop(true).ok_or(fault(NcErrorKind::NoLoop))?;
                let open_place = self.flow.innermost().map_or(place, |o| o.place);
                self.flow.pass(Passing::Out, left, open_place);
            }
            b"CONTINUE" => {
                c.require_end(STATEMENT)?;
                let left = self.flow.leave_to_loop(false).ok_or(fault(NcErrorKind::NoLoop))?;
                next = self.next_round(Some(left)).map_err(fault)?;
            }
            b"GOTO" => return self.goto(c, line, bounds),
            _ => return span.fault(NcErrorKind::UnknownDollar),
        }
        c.require_end(STATEMENT)?;
        Ok(next)
    }

    /// Carries out `$FOR Pn = start, end, step`.
    fn open_for(
        &mut self,
        c: &mut Cursor<'_>,
        line: &Line,
        open: impl Fn(Block) -> Open,
        place: Place,
    ) -> Result<(), Fault> {
        if c.peek_upper() != b'P' {
            return c.here().fault(NcErrorKind::ForCounter);
        }
        let mark = c.mark();
        let counter = parameter_target(c, &self.calculator)?;
        let counter_span = c.since(mark);
        c.require(b'=', "=")?;
        let start = expression(c, &self.calculator)?.real();
        c.require(b',', ", and the end value")?;
        let end = expression(c, &self.calculator)?.real();
        let step_mark = c.mark();
        let step = if c.eat(b',') { expression(c, &self.calculator)?.real() } else { 1.0 };
        let step_span = c.since(step_mark);
        c.require_end(STATEMENT)?;
        self.calculator.parameters.set(counter, start).map_err(|kind| Fault { span: counter_span, kind })?;
        self.flow
            .open(open(Block::For { counter, end, step }))
            .map_err(|kind| Fault { span: counter_span, kind })?;
        if step == 0.0 {
            self.warn(line, step_span, NcWarningKind::EndlessFor);
        } else if passed_end(start, end, step) {
            self.flow.pass(Passing::Out, 0, place);
        }
        Ok(())
    }

    /// Reads `$SWITCH expression` or `$SWITCH Pn = expression`.
    fn switch_value(&mut self, c: &mut Cursor<'_>) -> Result<f64, Fault> {
        let mark = c.mark();
        if c.peek_upper() == b'P'
            && let Ok(target) = parameter_target(c, &self.calculator)
            && c.eat(b'=')
            && c.raw() != b'='
        {
            let value = expression(c, &self.calculator)?.real();
            self.calculator
                .parameters
                .set(target, value)
                .map_err(|kind| Fault { span: c.since(mark), kind })?;
            return Ok(value);
        }
        c.back_to(mark);
        Ok(expression(c, &self.calculator)?.real())
    }

    fn innermost_is(&mut self, opening: &'static str) -> Result<(), NcErrorKind> {
        match self.flow.innermost() {
            Some(open) if open.block.opening() == opening => Ok(()),
            _ => Err(NcErrorKind::Unopened { opening }),
        }
    }

    /// Carries out a closing word.
    fn close(&mut self, c: &mut Cursor<'_>, word: &Word, span: Span) -> Result<Next, Fault> {
        let open = self.closed_by(word).map_err(|kind| Fault { span, kind })?;
        let again = match open.block {
            Block::For { .. } => {
                c.require_end(STATEMENT)?;
                return self.next_round(None).map_err(|kind| Fault { span, kind });
            }
            Block::While => {
                c.require_end(STATEMENT)?;
                self.flow.blocks.pop();
                self.flow.left = true;
                return Ok(Next::At(open.start));
            }
            Block::Do => self.condition(c)?,
            Block::Repeat => !self.condition(c)?,
            Block::If | Block::Switch { .. } => false,
        };
        c.require_end(STATEMENT)?;
        if again {
            return Ok(Next::At(open.body));
        }
        self.flow.blocks.pop();
        Ok(Next::Line)
    }

    /// The innermost control block, if `word` closes it.
    fn closed_by(&mut self, word: &Word) -> Result<Open, NcErrorKind> {
        match self.flow.innermost() {
            Some(open) if open.block.closing().as_bytes().get(1..) == Some(word.bytes()) => Ok(*open),
            _ => Err(NcErrorKind::Unopened { opening: opening_of(word) }),
        }
    }

    /// Continues the innermost loop: after its closing word, or after `$CONTINUE` with `left` blocks open
    /// inside.
    fn next_round(&mut self, left: Option<u16>) -> Result<Next, NcErrorKind> {
        let Some(open) = self.flow.innermost().copied() else { return Err(NcErrorKind::NoLoop) };
        match open.block {
            Block::For { counter, end, step } => {
                let value = self.calculator.parameters.get(counter)? + step;
                self.calculator.parameters.set(counter, value)?;
                if step == 0.0 || !passed_end(value, end, step) {
                    return Ok(Next::At(open.body));
                }
                match left {
                    Some(left) => self.flow.pass(Passing::Out, left, open.place),
                    None => {
                        self.flow.blocks.pop();
                    }
                }
                Ok(Next::Line)
            }
            Block::While => {
                self.flow.blocks.pop();
                self.flow.left = true;
                Ok(Next::At(open.start))
            }
            _ => {
                self.flow.pass(Passing::Round, left.unwrap_or(0), open.place);
                Ok(Next::Line)
            }
        }
    }

    /// Carries out `$IF condition $GOTO label`.
    fn if_goto(&mut self, c: &mut Cursor<'_>, go: bool, line: &Line, bounds: Bounds) -> Result<Next, Fault> {
        let mark = c.mark();
        c.bump();
        if !c.letters().is("GOTO") {
            return c.since(mark).fault(NcErrorKind::NotAlone("$IF, or $IF with $GOTO,"));
        }
        let next = self.goto(c, line, bounds)?;
        if go {
            return Ok(next);
        }
        self.flow.passing = Passing::No;
        Ok(Next::Line)
    }

    /// Carries out `$GOTO N20` or `$GOTO [NAME]`. The search begins at the start of the running program.
    fn goto(&mut self, c: &mut Cursor<'_>, line: &Line, bounds: Bounds) -> Result<Next, Fault> {
        let mark = c.mark();
        let label = match c.peek_upper() {
            b'N' => {
                c.bump();
                let value = expression(c, &self.calculator)?.whole().and_then(|n| u32::try_from(n).ok());
                value.map(u64::from)
            }
            b'[' => bracket_label(c),
            _ => None,
        };
        let Some(label) = label else { return c.expected("N and a block number, or [NAME]") };
        let place = line.place(c.since(mark));
        c.require_end(STATEMENT)?;
        self.flow.pass(Passing::Label(label), 0, place);
        self.flow.behind = bounds.next;
        Ok(Next::At(self.flow.program))
    }

    /// Handles a `$` word in skipped text. Returns `true` if its line has to be carried out.
    pub fn pass_control(&mut self, c: &mut Cursor<'_>, start: usize, bounds: Bounds) -> Result<bool, Fault> {
        let mark = c.mark();
        c.bump();
        let word = c.letters();
        let span = c.since(mark);
        let fault = |kind| Fault { span, kind };
        // `$IF … $GOTO …` opens nothing.
        let role = if word.is("IF") && c.has_ahead(b'$') { Role::Other } else { role(&word) };
        let passing = self.flow.passing;
        if passing == Passing::No {
            return Ok(true);
        }
        if let Passing::Label(_) = passing {
            match role {
                Role::Opens => {
                    self.flow
                        .passed
                        .push(bounds.start.offset)
                        .map_err(|_| fault(NcErrorKind::NestingTooDeep))?;
                }
                Role::Closes => {
                    self.flow.passed.pop();
                }
                _ => {}
            }
            return Ok(false);
        }
        match role {
            Role::Opens => self.flow.depth = self.flow.depth.saturating_add(1),
            Role::Closes if self.flow.depth > 0 => self.flow.depth -= 1,
            Role::Closes => {
                self.closed_by(&word).map_err(fault)?;
                if let Passing::End(_) = passing {
                    self.flow.blocks.pop();
                    return Ok(false);
                }
                self.flow.passing = Passing::No;
                if passing == Passing::Round {
                    c.back_to(start);
                    return Ok(true);
                }
                self.flow.blocks.pop();
            }
            Role::Divides if self.flow.depth == 0 && self.enters(c, passing, &word)? => {
                self.flow.passing = Passing::No;
                c.require_end(STATEMENT)?;
            }
            _ => {}
        }
        Ok(false)
    }

    /// Whether this branch or case has to be carried out.
    fn enters(&mut self, c: &mut Cursor<'_>, passing: Passing, word: &Word) -> Result<bool, Fault> {
        match (passing, word.bytes()) {
            (Passing::Branch, b"ELSE") | (Passing::Case, b"DEFAULT") => Ok(true),
            (Passing::Branch, b"ELSEIF") => self.condition(c),
            (Passing::Case, b"CASE") => {
                let case = expression(c, &self.calculator)?.real();
                let block = self.flow.innermost().map(|open| open.block);
                let Some(Block::Switch { value }) = block else { return Ok(false) };
                // Equal up to 0.001, as ISG compares.
                Ok(real::abs(value - case) < 0.001)
            }
            _ => Ok(false),
        }
    }

    /// Whether the wanted label is in this line. If so, leaves the control blocks that do not contain the
    /// label.
    pub fn arrive(&mut self, c: &mut Cursor<'_>) -> Result<bool, Fault> {
        let base = self.flow.base();
        let open = self.flow.blocks.iter().skip(base);
        let inside = self.flow.passed.len() > self.flow.blocks.len().saturating_sub(base)
            || open.zip(&self.flow.passed).any(|(block, offset)| block.start.offset != *offset);
        if inside {
            return c.here().fault(NcErrorKind::NotAvailable("jump into a control block, to"));
        }
        self.flow.blocks.truncate(base + self.flow.passed.len());
        self.flow.passing = Passing::No;
        Ok(true)
    }
}

/// Whether a loop counter is beyond its end.
fn passed_end(value: f64, end: f64, step: f64) -> bool {
    if step > 0.0 { value > end } else { value < end }
}

/// The word that opens the block which `closing` closes.
fn opening_of(closing: &Word) -> &'static str {
    match closing.bytes() {
        b"ENDFOR" => "$FOR",
        b"ENDWHILE" => "$WHILE",
        b"ENDDO" => "$DO",
        b"UNTIL" => "$REPEAT",
        b"ENDIF" => "$IF",
        _ => "$SWITCH",
    }
}
