//! `#` commands.
use super::cursor::Cursor;
use super::interpreter::Interpreter;
use super::line::Line;
use super::{Command, Fault, NcErrorKind};

impl<const AXES: usize> Interpreter<AXES> {
    pub fn hash_command(&mut self, c: &mut Cursor<'_>, _line: &Line) -> Result<Command<AXES>, Fault> {
        c.rest_of_word().fault(NcErrorKind::NotAvailable("command"))
    }

    pub fn axis_command(&mut self, _c: &mut Cursor<'_>, _axis: usize, _mark: usize) -> Result<Option<Command<AXES>>, Fault> {
        Ok(None)
    }
}
