//! Evaluates arithmetic expressions of ISG's language. The evaluation uses no recursion, but two stacks of
//! fixed size, for operands and operators.
//!
//! `**` binds tightest, then sign and NOT, then `*` `/` MOD, then `+` `-`, then comparisons, then AND, then
//! OR and XOR. Square brackets group. A condition is true if its value is at least 0.5. `P` belongs to the
//! index after it: `P5`, `PP5`, `P[P1+5]`.
use super::calculator::{Aside, Calculator};
use super::cursor::Cursor;
use super::number::Number;
use super::parameter::{Parameters, index};
use super::{Fault, NcErrorKind, real};
use crate::machine::functions;
use core::mem::take;
use heapless::Vec;

/// Largest number of pending operators, and of pending operands.
pub const EXPRESSION_DEPTH: usize = functions::EXPRESSIONS.room(24);

#[derive(Clone, Copy, PartialEq, Eq)]
enum Function {
    Abs,
    Sqr,
    Sqrt,
    Exp,
    Ln,
    Dexp,
    Dlog,
    Sin,
    Cos,
    Tan,
    Cot,
    Asin,
    Acos,
    Atan,
    Acot,
    Atan2,
    Int,
    Fract,
    Round,
    Fup,
    Sign,
    Min,
    Max,
}

const FUNCTIONS: [(&str, Function); 23] = [
    ("ABS", Function::Abs),
    ("SQR", Function::Sqr),
    ("SQRT", Function::Sqrt),
    ("EXP", Function::Exp),
    ("LN", Function::Ln),
    ("DEXP", Function::Dexp),
    ("DLOG", Function::Dlog),
    ("SIN", Function::Sin),
    ("COS", Function::Cos),
    ("TAN", Function::Tan),
    ("COT", Function::Cot),
    ("ASIN", Function::Asin),
    ("ACOS", Function::Acos),
    ("ATAN", Function::Atan),
    ("ACOT", Function::Acot),
    ("ATAN2", Function::Atan2),
    ("INT", Function::Int),
    ("FRACT", Function::Fract),
    ("ROUND", Function::Round),
    ("FUP", Function::Fup),
    ("SIGN", Function::Sign),
    ("MIN", Function::Min),
    ("MAX", Function::Max),
];

impl Function {
    const fn name(self) -> &'static str {
        let mut i = 0;
        while i < FUNCTIONS.len() {
            let (name, function) = FUNCTIONS[i];
            if function as u8 == self as u8 {
                return name;
            }
            i += 1;
        }
        ""
    }

    const fn arguments(self) -> u8 {
        match self {
            Self::Atan2 | Self::Min | Self::Max => 2,
            _ => 1,
        }
    }

    /// Cost of the function, in units of about a hundred instructions on the target.
    const fn work(self) -> u32 {
        match self {
            Self::Asin | Self::Acos => 140,
            Self::Atan | Self::Acot | Self::Atan2 => 110,
            Self::Sin | Self::Cos | Self::Tan | Self::Cot => 65,
            Self::Dexp | Self::Dlog => 80,
            Self::Exp | Self::Ln => 40,
            Self::Sqrt => 25,
            _ => 5,
        }
    }

    fn apply(self, x: f64, y: f64) -> Result<f64, NcErrorKind> {
        let domain = NcErrorKind::Domain(self.name());
        let value = match self {
            Self::Abs => Some(real::abs(x)),
            Self::Sqr => Some(x * x),
            Self::Sqrt => (x >= 0.0).then(|| real::sqrt(x)),
            Self::Exp => Some(real::exp(x)),
            Self::Ln => real::ln(x),
            Self::Dexp => real::power(10.0, x),
            Self::Dlog => real::ln(x).map(|l| l / core::f64::consts::LN_10),
            Self::Sin => real::sin_cos(x).map(|(s, _)| s),
            Self::Cos => real::sin_cos(x).map(|(_, c)| c),
            Self::Tan => real::tan(x),
            Self::Cot => real::cot(x),
            Self::Asin => real::asin(x),
            Self::Acos => real::acos(x),
            Self::Atan => Some(real::atan(x)),
            Self::Acot => Some(90.0 - real::atan(x)),
            Self::Atan2 => Some(real::atan2(x, y)),
            Self::Int => Some(real::trunc(x)),
            Self::Fract => Some(x - real::trunc(x)),
            Self::Round => Some(real::round(x)),
            Self::Fup => Some(real::ceil(x)),
            Self::Sign => Some(f64::from(i8::from(x > 0.0) - i8::from(x < 0.0))),
            Self::Min => Some(if x < y { x } else { y }),
            Self::Max => Some(if x > y { x } else { y }),
        };
        value.ok_or(domain)
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Op {
    Or,
    Xor,
    And,
    Equal,
    Unequal,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    Negate,
    Not,
    Power,
    /// P: replaces the index on the value stack by the value of this parameter.
    Parameter,
    Call(Function),
    /// `[`, with the number of commas after it.
    Open(u8),
}

impl Op {
    const fn priority(self) -> u8 {
        match self {
            Self::Open(_) | Self::Call(_) => 0,
            Self::Or | Self::Xor => 1,
            Self::And => 2,
            Self::Equal
            | Self::Unequal
            | Self::Less
            | Self::LessEqual
            | Self::Greater
            | Self::GreaterEqual => 3,
            Self::Add | Self::Subtract => 4,
            Self::Multiply | Self::Divide | Self::Modulo => 5,
            Self::Negate | Self::Not => 6,
            Self::Power => 7,
            Self::Parameter => 8,
        }
    }

    /// Cost of the operator, in units of about a hundred instructions on the target.
    const fn work(self) -> u32 {
        match self {
            Self::Power => 85,
            Self::Modulo => 50,
            _ => 3,
        }
    }
}

/// Pending operators and operands.
pub(super) struct Stacks {
    values: Vec<f64, EXPRESSION_DEPTH>,
    ops: Vec<Op, EXPRESSION_DEPTH>,
}

/// Cost of reading an operand and the text up to the next one, in units of about a hundred instructions.
const READING: u32 = 7;

struct Evaluation<'p> {
    parameters: &'p Parameters,
    #[cfg(feature = "plc")]
    looked: &'p super::variable::Looked,
    values: Vec<f64, EXPRESSION_DEPTH>,
    ops: Vec<Op, EXPRESSION_DEPTH>,
}

type Step<V> = Result<V, NcErrorKind>;

impl Evaluation<'_> {
    fn push(&mut self, value: f64) -> Step<()> {
        self.values.push(value).map_err(|_| NcErrorKind::ExpressionTooDeep)
    }

    fn wait(&mut self, op: Op) -> Step<()> {
        self.ops.push(op).map_err(|_| NcErrorKind::ExpressionTooDeep)
    }

    // The evaluating function must not copy the stored state, because the copy would be on its stack all the
    // time.

    /// Stores the state; the expression continues at `at` in another call.
    #[inline(never)]
    fn lay_aside(&mut self, calculator: &Calculator, start: usize, at: usize) {
        let stacks = Stacks { values: take(&mut self.values), ops: take(&mut self.ops) };
        calculator.lay_aside(start, Aside { at, stacks });
    }

    /// Restores the stored state. Returns the position where the expression continues.
    #[inline(never)]
    fn take_up(&mut self, calculator: &Calculator) -> Option<usize> {
        let Some(Aside { at, stacks: Stacks { values, ops } }) = &mut calculator.take_aside() else {
            return None;
        };
        (self.values, self.ops) = (take(values), take(ops));
        Some(*at)
    }

    /// Takes the top operand. The parser never pushes an operator without its operands.
    fn pop(&mut self) -> f64 {
        self.values.pop().unwrap_or(0.0)
    }

    fn apply(&mut self, op: Op) -> Step<()> {
        let y = self.pop();
        let truth = |b: bool| if b { 1.0 } else { 0.0 };
        let value = match op {
            Op::Negate => -y,
            Op::Not => truth(y < 0.5),
            Op::Parameter => self.parameters.get(index(y)?)?,
            _ => {
                let x = self.pop();
                match op {
                    Op::Add => x + y,
                    Op::Subtract => x - y,
                    Op::Multiply => x * y,
                    Op::Divide | Op::Modulo if y == 0.0 => return Err(NcErrorKind::DivisionByZero),
                    Op::Divide => x / y,
                    Op::Modulo => real::remainder(x, y),
                    Op::Power => real::power(x, y).ok_or(NcErrorKind::Domain("**"))?,
                    Op::And => truth(x >= 0.5 && y >= 0.5),
                    Op::Or => truth(x >= 0.5 || y >= 0.5),
                    Op::Xor => truth((x >= 0.5) != (y >= 0.5)),
                    Op::Equal => truth(x == y),
                    Op::Unequal => truth(x != y),
                    Op::Less => truth(x < y),
                    Op::LessEqual => truth(x <= y),
                    Op::Greater => truth(x > y),
                    _ => truth(x >= y),
                }
            }
        };
        if !value.is_finite() {
            return Err(NcErrorKind::Overflow);
        }
        self.push(value)
    }

    /// Applies pending operators of at least `priority`, down to the last open bracket.
    fn reduce(&mut self, priority: u8) -> Step<()> {
        while let Some(&op) = self.ops.last() {
            if op.priority() < priority.max(1) {
                break;
            }
            self.ops.pop();
            self.apply(op)?;
        }
        Ok(())
    }

    /// Cost of an operator, a closing bracket or the end, plus the cost of reading up to the next operand.
    fn due(&self, closes: bool) -> u32 {
        let mut work = READING;
        let mut ops = self.ops.iter().rev();
        for op in ops.by_ref().take_while(|op| !matches!(op, Op::Open(_))) {
            work += op.work();
        }
        match ops.next() {
            Some(Op::Call(function)) if closes => work + function.work(),
            _ => work,
        }
    }

    /// Handles `]`. Returns `false` if no bracket is open.
    fn close(&mut self) -> Step<bool> {
        self.reduce(1)?;
        let Some(Op::Open(commas)) = self.ops.pop() else { return Ok(false) };
        if let Some(&Op::Call(function)) = self.ops.last() {
            self.ops.pop();
            if commas + 1 != function.arguments() {
                return Err(NcErrorKind::Expected("one argument, two for ATAN2, MIN and MAX"));
            }
            let y = if commas == 1 { self.pop() } else { 0.0 };
            let x = self.pop();
            let value = function.apply(x, y)?;
            if !value.is_finite() {
                return Err(NcErrorKind::Overflow);
            }
            self.push(value)?;
        }
        self.reduce(8)?;
        Ok(true)
    }

    /// Handles `,` inside the brackets of a function. Returns `false` elsewhere.
    fn comma(&mut self) -> Step<bool> {
        let open = self.ops.iter().rposition(|op| matches!(op, Op::Open(_)));
        let Some(at) = open else { return Ok(false) };
        let call = at.checked_sub(1).and_then(|i| self.ops.get(i));
        if !matches!(call, Some(Op::Call(_))) {
            return Ok(false);
        }
        self.reduce(1)?;
        if let Some(Op::Open(commas)) = self.ops.last_mut() {
            *commas = commas.saturating_add(1);
        }
        Ok(true)
    }
}

/// Reads an expression up to its end. A single number stays exact. An expression with too much work for the
/// call is stored.
pub(super) fn expression(c: &mut Cursor<'_>, calculator: &Calculator) -> Result<Number, Fault> {
    let start = c.mark();
    if let Some(literal) = literal(c) {
        return Ok(literal);
    }
    c.back_to(start);
    if !functions::EXPRESSIONS.is_built() {
        return no_literal(c);
    }
    if calculator.is_halted() {
        return calculator.halt();
    }
    if let Some((end, value)) = calculator.recall(start) {
        c.back_to(end);
        return Ok(Number::Real(value));
    }
    let parameters = &calculator.parameters;
    let mut e = Evaluation {
        parameters,
        #[cfg(feature = "plc")]
        looked: &calculator.looked,
        values: Vec::new(),
        ops: Vec::new(),
    };
    let fault = |c: &Cursor<'_>, kind| Fault { span: c.since(start), kind };
    if calculator.has_aside(start)
        && let Some(at) = e.take_up(calculator)
    {
        c.back_to(at);
    } else {
        operand(c, &mut e, start)?;
    }
    loop {
        // After an operand: closing brackets, then an operator or the end.
        let operator = loop {
            let mark = c.mark();
            if !calculator.affords(e.due(c.peek() == b']')) && calculator.knows_all() {
                e.lay_aside(calculator, start, mark);
                return calculator.halt();
            }
            if c.peek() == b']' && e.ops.iter().any(|op| matches!(op, Op::Open(_))) {
                c.bump();
                e.close().map_err(|kind| fault(c, kind))?;
                continue;
            }
            if c.peek() == b',' {
                c.bump();
                if e.comma().map_err(|kind| fault(c, kind))? {
                    break Some(None);
                }
                c.back_to(mark);
            }
            break operator(c).map(Some);
        };
        match operator {
            None => break,
            Some(None) => {}
            Some(Some(op)) => {
                e.reduce(op.priority()).map_err(|kind| fault(c, kind))?;
                e.wait(op).map_err(|kind| fault(c, kind))?;
            }
        }
        operand(c, &mut e, start)?;
    }
    e.reduce(1).map_err(|kind| fault(c, kind))?;
    if !e.ops.is_empty() {
        return c.expected("] or an operator");
    }
    let value = e.pop();
    calculator.remember(start, c.mark(), value);
    Ok(Number::Real(value))
}

/// Reads a number that has only signs before it and no operator after it.
fn literal(c: &mut Cursor<'_>) -> Option<Number> {
    let mut minus = false;
    loop {
        match c.peek() {
            b'-' => minus = !minus,
            b'+' => {}
            b'0'..=b'9' | b'.' => break,
            _ => return None,
        }
        c.bump();
    }
    let Ok(Number::Decimal { mantissa, scale, .. }) = c.decimal() else { return None };
    let behind = c.mark();
    let alone = operator(c).is_none();
    c.back_to(behind);
    alone.then_some(Number::Decimal { negative: minus, mantissa, scale })
}

/// In a build without the feature `expressions`: refuses a word in place of a number.
#[cold]
#[inline(never)]
fn no_literal(c: &mut Cursor<'_>) -> Result<Number, Fault> {
    let span = c.rest_of_word();
    while matches!(c.peek(), b'+' | b'-') {
        c.bump();
    }
    let start = c.mark();
    match c.peek_upper() {
        // A number with an operator after it.
        b'0'..=b'9' | b'.' => _ = c.decimal()?,
        b'[' => {}
        _ => {
            let word = c.letters();
            let known = |name: &str| word.is(name);
            let is_function = FUNCTIONS.iter().any(|(name, _)| known(name));
            if !(is_function || ["P", "PP", "NOT"].into_iter().any(known)) {
                c.back_to(start);
                return c.expected("a number");
            }
        }
    }
    span.needs(functions::EXPRESSIONS)?;
    Ok(Number::Real(0.0))
}

/// Reads signs, P, brackets and functions up to the end of one operand.
fn operand(c: &mut Cursor<'_>, e: &mut Evaluation<'_>, start: usize) -> Result<(), Fault> {
    let fault = |c: &Cursor<'_>, kind| Fault { span: c.since(start), kind };
    loop {
        let after_p = matches!(e.ops.last(), Some(Op::Parameter));
        let mark = c.mark();
        let byte = c.peek_upper();
        match byte {
            b'+' if !after_p => c.bump(),
            b'-' if !after_p => {
                c.bump();
                e.wait(Op::Negate).map_err(|kind| fault(c, kind))?;
            }
            b'[' => {
                c.bump();
                e.wait(Op::Open(0)).map_err(|kind| fault(c, kind))?;
            }
            b'0'..=b'9' if after_p => {
                let index = f64::from(c.whole("parameter index")?);
                e.push(index).map_err(|kind| fault(c, kind))?;
                let span = c.since(mark.saturating_sub(1));
                e.reduce(8).map_err(|kind| Fault { span, kind })?;
                if c.raw() == b'[' {
                    return c.since(start).fault(NcErrorKind::NotAvailable("array of P parameters"));
                }
                return Ok(());
            }
            b'0'..=b'9' | b'.' => {
                let value = c.decimal()?.real();
                return e.push(value).map_err(|kind| fault(c, kind));
            }
            b'"' => return c.rest_of_word().fault(NcErrorKind::NotAvailable("macro")),
            b'A'..=b'Z' => {
                let word = c.letters();
                if word.is("ATAN") && c.raw() == b'2' {
                    c.bump();
                    e.wait(Op::Call(Function::Atan2)).map_err(|kind| fault(c, kind))?;
                    if c.peek() != b'[' {
                        return c.expected("[ after the function");
                    }
                    continue;
                }
                if byte == b'P' && word.bytes().iter().all(|b| *b == b'P') {
                    c.back_to(mark);
                    c.bump();
                    e.wait(Op::Parameter).map_err(|kind| fault(c, kind))?;
                    if !matches!(c.peek_upper(), b'0'..=b'9' | b'[' | b'P') {
                        return c.expected("a parameter index");
                    }
                    continue;
                }
                if word.is("V") && c.raw() == b'.' {
                    c.back_to(mark);
                    return variable(c, e);
                }
                if word.is("NOT") && !after_p {
                    e.wait(Op::Not).map_err(|kind| fault(c, kind))?;
                    continue;
                }
                if word.is("PI") && !after_p {
                    return e.push(core::f64::consts::PI).map_err(|kind| fault(c, kind));
                }
                let function = FUNCTIONS.iter().find(|(name, _)| word.is(name));
                let Some((_, function)) = function else {
                    if c.peek() == b'[' {
                        return c.since(mark).fault(NcErrorKind::UnknownFunction);
                    }
                    c.back_to(mark);
                    return c.expected("a number, P or a function");
                };
                if c.peek() != b'[' {
                    return c.expected("[ after the function");
                }
                e.wait(Op::Call(*function)).map_err(|kind| fault(c, kind))?;
            }
            _ => return c.expected("a number, P, a function or ["),
        }
    }
}

/// Refuses a V. variable, which needs the feature `plc`.
#[cfg(not(feature = "plc"))]
#[inline(always)]
fn variable(c: &mut Cursor<'_>, _: &mut Evaluation<'_>) -> Result<(), Fault> {
    c.rest_of_word().fault(NcErrorKind::NotAvailable("variable"))
}

/// Reads the value of a V. variable.
#[cfg(feature = "plc")]
#[inline(never)]
fn variable(c: &mut Cursor<'_>, e: &mut Evaluation<'_>) -> Result<(), Fault> {
    use super::variable::Place;
    let mark = c.mark();
    let name = super::variable::name(c)?;
    let span = c.since(mark);
    let value = match name.place(e.looked.level.get()) {
        Some(Place::Own(index)) => e.parameters.get(index).map_err(|_| NcErrorKind::VariableUnset),
        Some(Place::Outside(hash)) => e.looked.get(hash).ok_or_else(|| name.missing()),
        None => Err(name.missing()),
    };
    value.and_then(|value| e.push(value)).map_err(|kind| Fault { span, kind })
}

/// Reads an operator between two operands.
fn operator(c: &mut Cursor<'_>) -> Option<Op> {
    let mark = c.mark();
    let first = c.peek_upper();
    if first.is_ascii_alphabetic() {
        // A value follows an address; another letter follows the first letter of an operator.
        if !matches!(first, b'M' | b'A' | b'X' | b'O') || !c.next().is_ascii_alphabetic() {
            return None;
        }
        let word = c.letters();
        for (name, op) in [("MOD", Op::Modulo), ("AND", Op::And), ("XOR", Op::Xor), ("OR", Op::Or)] {
            // `MODP2` is an operator and its operand.
            if word.is(name) {
                return Some(op);
            }
            if word.bytes().starts_with(name.as_bytes()) && word.bytes().get(name.len()) == Some(&b'P') {
                c.back_to(mark);
                for _ in 0..name.len() {
                    c.bump();
                }
                return Some(op);
            }
        }
        c.back_to(mark);
        return None;
    }
    c.bump();
    let second = c.raw();
    let (op, double) = match (first, second) {
        (b'*', b'*') => (Op::Power, true),
        (b'*', _) => (Op::Multiply, false),
        (b'/', _) => (Op::Divide, false),
        (b'+', _) => (Op::Add, false),
        (b'-', _) => (Op::Subtract, false),
        (b'=', b'=') => (Op::Equal, true),
        (b'!', b'=') | (b'<', b'>') => (Op::Unequal, true),
        (b'<', b'=') => (Op::LessEqual, true),
        (b'<', _) => (Op::Less, false),
        (b'>', b'=') => (Op::GreaterEqual, true),
        (b'>', _) => (Op::Greater, false),
        _ => {
            c.back_to(mark);
            return None;
        }
    };
    if double {
        c.bump();
    }
    Some(op)
}

/// Reads the index of the parameter at the cursor (`P5`, `PP5`, `P[…]`), for an assignment.
pub(super) fn parameter_target(c: &mut Cursor<'_>, calculator: &Calculator) -> Result<u32, Fault> {
    let mark = c.mark();
    if c.peek_upper() != b'P' {
        return c.expected("a P parameter");
    }
    c.bump();
    let fault = |c: &Cursor<'_>, kind| Fault { span: c.since(mark), kind };
    match c.peek_upper() {
        b'P' => {
            // PP5: the value of the inner parameter is read, and the outer one is written.
            let mut depth = 0_u8;
            while c.peek_upper() == b'P' {
                c.bump();
                depth = depth.saturating_add(1);
            }
            let mut value = c.whole("parameter index")?;
            for _ in 0..depth {
                let read = calculator.parameters.get(value).map_err(|kind| fault(c, kind))?;
                value = index(read).map_err(|kind| fault(c, kind))?;
            }
            Ok(value)
        }
        b'[' => {
            let value = expression_in_brackets(c, calculator)?;
            index(value).map_err(|kind| fault(c, kind))
        }
        _ => {
            let value = f64::from(c.whole("parameter index")?);
            if c.raw() == b'[' {
                return c.since(mark).fault(NcErrorKind::NotAvailable("array of P parameters"));
            }
            index(value).map_err(|kind| fault(c, kind))
        }
    }
}

/// Reads `[expression]`, without text after it.
fn expression_in_brackets(c: &mut Cursor<'_>, calculator: &Calculator) -> Result<f64, Fault> {
    c.require(b'[', "[")?;
    let value = expression(c, calculator)?.real();
    c.require(b']', "]")?;
    Ok(value)
}
