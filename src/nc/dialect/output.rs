//! M62 to M68 of LinuxCNC: digital and analog outputs, and waiting for an input.
use super::block::Block;
use super::words::{Meaning, group};
use crate::machine::functions;
use crate::nc::block::ItemKind;
use crate::nc::interpreter::Interpreter;
use crate::nc::number::Factor;
use crate::nc::{Fault, NcErrorKind, Span};
use crate::quantity::Position;
use crate::technology::{Function, InputWait};

/// Highest number of a port.
const PORTS: u32 = 255;

/// Longest wait for an input, s.
const LONGEST: i64 = 4_000_000;

impl<const AXES: usize> Interpreter<AXES> {
    /// Carries out the word of the block for an output or an input.
    pub(super) fn outputs(&mut self, block: &mut Block<AXES>) -> Result<(), Fault> {
        let said = block.said(group::OUTPUT).filter(|_| functions::DIALECTS.is_built());
        let Some(said) = said else { return Ok(()) };
        self.foreign.output = match said.word.meaning {
            Meaning::Digital(on, at_once) => {
                (Function::Digital(self.port(block, b'P', "P, the output", said.span)?, on), at_once)
            }
            Meaning::Analog(at_once) => {
                let port = self.port(block, b'E', "E, the output", said.span)?;
                let Some(given) = block.take(b'Q') else {
                    return said.span.fault(NcErrorKind::Missing("Q, the value of the output"));
                };
                let range =
                    NcErrorKind::Range { what: "Q", min: 0, max: 2_147_483_647, unit: "", above: false };
                let value = given.number.fixed(Factor::ONE).ok_or(Fault { span: given.span, kind: range })?;
                (Function::Analog(port, value), at_once)
            }
            _ => (Function::Input(self.input(block, said.span)?), true),
        };
        self.push(ItemKind::Output, said.span)
    }

    fn port(
        &self,
        block: &mut Block<AXES>,
        letter: u8,
        missing: &'static str,
        span: Span,
    ) -> Result<u8, Fault> {
        let Some(given) = block.take(letter) else { return span.fault(NcErrorKind::Missing(missing)) };
        Ok(self.whole(given, "the port", PORTS)? as u8)
    }

    /// Reads the words of M66.
    fn input(&self, block: &mut Block<AXES>, span: Span) -> Result<InputWait, Fault> {
        let is_analog = block.value(b'E').is_some();
        let port = if is_analog {
            self.port(block, b'E', "E, the input", span)?
        } else {
            self.port(block, b'P', "P or E, the input", span)?
        };
        let mode = match block.take(b'L') {
            Some(given) if is_analog && given.number.real() != 0.0 => {
                return given.span.fault(NcErrorKind::Expected("L0 with an analogue input"));
            }
            Some(given) => self.whole(given, "L", 4)? as u8,
            None => 0,
        };
        let timeout_ms = match block.take(b'Q') {
            Some(given) if mode > 0 => {
                let seconds = given.number.fixed(Factor::ONE);
                let fits =
                    |time: &Position| *time > Position::ZERO && *time < Position::const_from_int(LONGEST);
                let kind =
                    NcErrorKind::Range { what: "Q", min: 0, max: LONGEST as u32, unit: "s", above: true };
                let time = seconds.filter(fits).ok_or(Fault { span: given.span, kind })?;
                // A value below 2^54 times 1000.
                ((i128::from(time.to_bits()) * 1000 + 0xffff_ffff) >> 32) as u32
            }
            // LinuxCNC accepts Q without effect here.
            Some(_) => 0,
            None if mode > 0 => return span.fault(NcErrorKind::Missing("Q, the longest wait in seconds")),
            None => 0,
        };
        Ok(InputWait { port, is_analog, mode, timeout_ms })
    }
}
