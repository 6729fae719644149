//! Evaluates the values of words in LinuxCNC's language: `X[#1+2]`, `X-#<depth>`, `XSIN[30]`. The evaluation
//! uses no recursion, but two stacks of fixed size, for operands and operators.
//!
//! Signs and `#` bind tightest, then `**`, then `*` `/` MOD, then `+` `-`, then comparisons, then AND OR XOR.
//! Operators of the same priority are evaluated from left to right. Angles are in degrees.
use super::block::literal;
use super::parameter::{Name, name};
use crate::nc::cursor::Cursor;
use crate::nc::interpreter::Interpreter;
use crate::nc::{Fault, NcErrorKind, real};
use heapless::Vec;

/// Largest number of operands, and of operators, on the stacks.
const DEPTH: usize = 24;

/// Largest cost of an expression, in hundreds of instructions on the target.
const MOST_WORK: u32 = 600;

/// Cost of reading an operand, in hundreds of instructions.
const READING: u32 = 8;

/// Values with a smaller difference are equal.
const EQUAL: f64 = 1e-6;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Function {
    Abs,
    Acos,
    Asin,
    Atan,
    Cos,
    Exp,
    Fix,
    Fup,
    Ln,
    Round,
    Sin,
    Sqrt,
    Tan,
}

const FUNCTIONS: [(&str, Function); 13] = [
    ("ABS", Function::Abs),
    ("ACOS", Function::Acos),
    ("ASIN", Function::Asin),
    ("ATAN", Function::Atan),
    ("COS", Function::Cos),
    ("EXP", Function::Exp),
    ("FIX", Function::Fix),
    ("FUP", Function::Fup),
    ("LN", Function::Ln),
    ("ROUND", Function::Round),
    ("SIN", Function::Sin),
    ("SQRT", Function::Sqrt),
    ("TAN", Function::Tan),
];

impl Function {
    fn apply(self, x: f64) -> Option<f64> {
        match self {
            Self::Abs => Some(real::abs(x)),
            Self::Acos => real::acos(x),
            Self::Asin => real::asin(x),
            Self::Atan => Some(real::atan(x)),
            Self::Cos => real::sin_cos(x).map(|(_, cos)| cos),
            Self::Exp => Some(real::exp(x)),
            Self::Fix => Some(real::floor(x)),
            Self::Fup => Some(real::ceil(x)),
            Self::Ln => real::ln(x),
            Self::Round => Some(real::round(x)),
            Self::Sin => real::sin_cos(x).map(|(sin, _)| sin),
            Self::Sqrt => (x >= 0.0).then(|| real::sqrt(x)),
            Self::Tan => real::tan(x),
        }
    }

    /// Cost of the operator, in hundreds of instructions on the target.
    const fn work(self) -> u32 {
        match self {
            Self::Acos | Self::Asin => 140,
            Self::Atan => 110,
            Self::Sin | Self::Cos | Self::Tan => 65,
            Self::Exp | Self::Ln => 40,
            Self::Sqrt => 25,
            _ => 5,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Op {
    And,
    Or,
    Xor,
    Equal,
    Unequal,
    Greater,
    GreaterEqual,
    Less,
    LessEqual,
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    Power,
    Negate,
    /// `#`: replaces a number by the value of this parameter.
    Parameter,
    Call(Function),
    /// The `/` between the two arguments of ATAN.
    Atan,
    Open,
}

impl Op {
    const fn priority(self) -> u8 {
        match self {
            Self::Open | Self::Call(_) | Self::Atan => 0,
            Self::And | Self::Or | Self::Xor => 1,
            Self::Equal
            | Self::Unequal
            | Self::Greater
            | Self::GreaterEqual
            | Self::Less
            | Self::LessEqual => 2,
            Self::Add | Self::Subtract => 3,
            Self::Multiply | Self::Divide | Self::Modulo => 4,
            Self::Power => 5,
            Self::Negate | Self::Parameter => 6,
        }
    }
}

/// Operands and operators that are not evaluated yet.
struct Stacks {
    values: Vec<f64, DEPTH>,
    ops: Vec<Op, DEPTH>,
    work: u32,
}

type Step<V> = Result<V, NcErrorKind>;

impl Stacks {
    fn push(&mut self, value: f64) -> Step<()> {
        if !value.is_finite() {
            return Err(NcErrorKind::Overflow);
        }
        self.spend(READING)?;
        self.values.push(value).map_err(|_| NcErrorKind::ExpressionTooDeep)
    }

    fn wait(&mut self, op: Op) -> Step<()> {
        self.ops.push(op).map_err(|_| NcErrorKind::ExpressionTooDeep)
    }

    /// The top operand. The parser never pushes an operator without its operands.
    fn pop(&mut self) -> f64 {
        self.values.pop().unwrap_or(0.0)
    }

    fn spend(&mut self, work: u32) -> Step<()> {
        self.work += work;
        if self.work > MOST_WORK { Err(NcErrorKind::ExpressionTooDeep) } else { Ok(()) }
    }

    fn is_open(&self) -> bool {
        self.ops.contains(&Op::Open)
    }

    fn call(&mut self, function: Function) -> Step<()> {
        self.spend(function.work())?;
        let name = FUNCTIONS.iter().find(|(_, other)| *other == function).map_or("", |(name, _)| *name);
        let value = function.apply(self.pop()).ok_or(NcErrorKind::Domain(name))?;
        self.push(value)
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Evaluates a value: a signed number, a parameter, a function, or an expression in brackets.
    pub(super) fn evaluate(&self, c: &mut Cursor<'_>) -> Result<f64, Fault> {
        let start = c.mark();
        if self.calculator.is_halted() {
            return self.calculator.halt();
        }
        if let Some((end, value)) = self.calculator.recall(start) {
            c.back_to(end);
            return Ok(value);
        }
        if !self.calculator.affords(READING) && self.calculator.knows_all() {
            return self.calculator.halt();
        }
        let mut stacks = Stacks { values: Vec::new(), ops: Vec::new(), work: 0 };
        let value = self.work_out(c, &mut stacks)?;
        self.calculator.charge(stacks.work);
        self.calculator.remember(start, c.mark(), value);
        Ok(value)
    }

    /// Evaluates `[`, a value, and `]`.
    pub(super) fn evaluate_in_brackets(&self, c: &mut Cursor<'_>) -> Result<f64, Fault> {
        if c.peek() != b'[' {
            return c.expected("[");
        }
        self.evaluate(c)
    }

    fn work_out(&self, c: &mut Cursor<'_>, e: &mut Stacks) -> Result<f64, Fault> {
        let start = c.mark();
        let fault = |c: &Cursor<'_>, kind| Fault { span: c.since(start), kind };
        loop {
            self.operand(c, e, start)?;
            loop {
                self.reduce(e, 6).map_err(|kind| fault(c, kind))?;
                if !e.is_open() {
                    return Ok(e.pop());
                }
                if c.peek() != b']' {
                    let Some(op) = operator(c) else { return c.expected("] or an operator") };
                    self.reduce(e, op.priority()).map_err(|kind| fault(c, kind))?;
                    e.wait(op).map_err(|kind| fault(c, kind))?;
                    break;
                }
                c.bump();
                self.reduce(e, 1).map_err(|kind| fault(c, kind))?;
                e.ops.pop();
                match e.ops.last().copied() {
                    Some(Op::Call(Function::Atan)) => {
                        e.ops.pop();
                        c.require(b'/', "/ and the second argument of ATAN")?;
                        if c.peek() != b'[' {
                            return c.expected("[ and the second argument of ATAN");
                        }
                        c.bump();
                        e.wait(Op::Atan).and(e.wait(Op::Open)).map_err(|kind| fault(c, kind))?;
                        break;
                    }
                    Some(Op::Call(function)) => {
                        e.ops.pop();
                        e.call(function).map_err(|kind| fault(c, kind))?;
                    }
                    Some(Op::Atan) => {
                        e.ops.pop();
                        let (x, y) = (e.pop(), e.pop());
                        let value = e.spend(Function::Atan.work()).map(|()| real::atan2(y, x));
                        value.and_then(|value| e.push(value)).map_err(|kind| fault(c, kind))?;
                    }
                    _ => {}
                }
            }
        }
    }

    /// Reads one operand, with its signs, `#`, brackets and functions.
    fn operand(&self, c: &mut Cursor<'_>, e: &mut Stacks, start: usize) -> Result<(), Fault> {
        let fault = |c: &Cursor<'_>, kind| Fault { span: c.since(start), kind };
        loop {
            let mark = c.mark();
            match c.peek_upper() {
                b'+' => c.bump(),
                b'-' => {
                    c.bump();
                    e.wait(Op::Negate).map_err(|kind| fault(c, kind))?;
                }
                b'[' => {
                    c.bump();
                    e.wait(Op::Open).map_err(|kind| fault(c, kind))?;
                }
                b'#' => {
                    c.bump();
                    if c.peek() == b'<' {
                        let name = name(c)?;
                        let unset = name.unset();
                        let value = self.named(name).ok_or(fault_of(c, mark, unset))?;
                        return e.push(value).map_err(|kind| fault(c, kind));
                    }
                    e.wait(Op::Parameter).map_err(|kind| fault(c, kind))?;
                }
                b'0'..=b'9' | b'.' => {
                    let value = literal(c, mark, false)?.number.real();
                    return e.push(value).map_err(|kind| fault(c, kind));
                }
                b'A'..=b'Z' => {
                    let word = c.letters();
                    if word.is("EXISTS") {
                        let exists = self.exists(c)?;
                        return e.push(if exists { 1.0 } else { 0.0 }).map_err(|kind| fault(c, kind));
                    }
                    let function = FUNCTIONS.iter().find(|(name, _)| word.is(name));
                    let Some((_, function)) = function else {
                        if c.peek() != b'[' {
                            c.back_to(mark);
                            return c.expected("a number");
                        }
                        return c.since(mark).fault(NcErrorKind::UnknownFunction);
                    };
                    if c.peek() != b'[' {
                        return c.expected("[ after the function");
                    }
                    e.wait(Op::Call(*function)).map_err(|kind| fault(c, kind))?;
                }
                _ => return c.expected("a number, #, a function or ["),
            }
        }
    }

    /// Evaluates `[#<name>]` or `[#5]` after EXISTS.
    fn exists(&self, c: &mut Cursor<'_>) -> Result<bool, Fault> {
        c.require(b'[', "[ after EXISTS")?;
        c.require(b'#', "# after EXISTS[")?;
        let exists = if c.peek() == b'<' {
            let name: Name = name(c)?;
            self.named(name).is_some()
        } else {
            let mark = c.mark();
            let number = literal(c, mark, false)?.number.real();
            self.numbered(number).is_ok()
        };
        c.require(b']', "]")?;
        Ok(exists)
    }

    /// Applies all operators of at least `priority`, down to the last open bracket.
    fn reduce(&self, e: &mut Stacks, priority: u8) -> Step<()> {
        while let Some(op) = e.ops.last().copied().filter(|op| op.priority() >= priority) {
            e.ops.pop();
            let y = e.pop();
            let value = match op {
                Op::Negate => -y,
                Op::Parameter => self.numbered(y)?,
                _ => {
                    let x = e.pop();
                    two(op, x, y)?
                }
            };
            e.spend(if op == Op::Power { 85 } else { 3 })?;
            e.push(value)?;
        }
        Ok(())
    }
}

fn fault_of(c: &Cursor<'_>, mark: usize, kind: NcErrorKind) -> Fault {
    Fault { span: c.since(mark), kind }
}

/// Applies an operator to two operands.
fn two(op: Op, x: f64, y: f64) -> Step<f64> {
    let truth = |b: bool| if b { 1.0 } else { 0.0 };
    let equal = real::abs(x - y) < EQUAL;
    Ok(match op {
        Op::Add => x + y,
        Op::Subtract => x - y,
        Op::Multiply => x * y,
        Op::Divide | Op::Modulo if y == 0.0 => return Err(NcErrorKind::DivisionByZero),
        Op::Divide => x / y,
        Op::Modulo => {
            // The result is 0 or above.
            let rest = real::remainder(x, y);
            if rest < 0.0 { rest + real::abs(y) } else { rest }
        }
        Op::Power => real::power(x, y).ok_or(NcErrorKind::Domain("**"))?,
        Op::And => truth(x != 0.0 && y != 0.0),
        Op::Or => truth(x != 0.0 || y != 0.0),
        Op::Xor => truth((x != 0.0) != (y != 0.0)),
        Op::Equal => truth(equal),
        Op::Unequal => truth(!equal),
        Op::Greater => truth(x > y),
        Op::GreaterEqual => truth(x >= y),
        Op::Less => truth(x < y),
        _ => truth(x <= y),
    })
}

/// Reads an operator between two operands.
fn operator(c: &mut Cursor<'_>) -> Option<Op> {
    const WORDS: [(&str, Op); 10] = [
        ("AND", Op::And),
        ("OR", Op::Or),
        ("XOR", Op::Xor),
        ("MOD", Op::Modulo),
        ("EQ", Op::Equal),
        ("NE", Op::Unequal),
        ("GT", Op::Greater),
        ("GE", Op::GreaterEqual),
        ("LT", Op::Less),
        ("LE", Op::LessEqual),
    ];
    let mark = c.mark();
    let first = c.peek_upper();
    if first.is_ascii_alphabetic() {
        let word = c.letters();
        // A function may follow without a blank: `1ANDSIN[30]`.
        let found = WORDS.iter().find(|(name, _)| word.bytes().starts_with(name.as_bytes()));
        c.back_to(mark + found.map_or(0, |(name, _)| name.len()));
        return found.map(|(_, op)| *op);
    }
    c.bump();
    let op = match first {
        b'*' if c.raw() == b'*' => {
            c.bump();
            Op::Power
        }
        b'*' => Op::Multiply,
        b'/' => Op::Divide,
        b'+' => Op::Add,
        b'-' => Op::Subtract,
        _ => {
            c.back_to(mark);
            return None;
        }
    };
    Some(op)
}
