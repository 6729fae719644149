//! Shifts of the origin: zero offsets (G54…G59.3), G92, G52 and tool lengths. Also the stored positions of
//! G28 and G30.
use super::block::{Block, Said};
use super::words::Meaning;
use crate::machine::{Dialect, ZERO_OFFSETS, of_tenths};
use crate::nc::block::Given;
use crate::nc::compose::in_range;
use crate::nc::interpreter::Interpreter;
use crate::nc::line::Line;
use crate::nc::{Fault, NcErrorKind, NcWarningKind, Span};
use crate::quantity::Position;

/// Number of zero offsets: G54…G59.3.
const SETS: u32 = 9;

impl<const AXES: usize> Interpreter<AXES> {
    /// A zero offset by its number, from 0.
    pub(super) fn zero_offsets(&mut self, set: usize) -> Option<&mut [Position; AXES]> {
        match set.checked_sub(ZERO_OFFSETS) {
            None => self.setup.zero_offsets.get_mut(set),
            Some(more) => self.setup.foreign.offsets.get_mut(more),
        }
    }

    /// Offset of an axis by G59.1…G59.3; 0 if another zero offset is in force.
    pub fn more_offset(&self, axis: usize) -> Position {
        let more = self.modal.zero_set.and_then(|set| set.checked_sub(ZERO_OFFSETS));
        let set = more.and_then(|more| self.setup.foreign.offsets.get(more));
        set.and_then(|set| set.get(axis)).copied().unwrap_or(Position::ZERO)
    }

    /// Carries out words that store or clear an offset, in the order of the dialect.
    pub(super) fn store(&mut self, said: Said, block: &mut Block<AXES>) -> Result<(), Fault> {
        let clears = matches!(said.word.meaning, Meaning::HereClear | Meaning::HereOff | Meaning::HereBack);
        if let (true, Some(first)) = (clears, block.first) {
            return first.fault(NcErrorKind::Conflict("G92.1, G92.2 or G92.3"));
        }
        match said.word.meaning {
            Meaning::Store => self.store_offset(said.span, block)?,
            Meaning::StoreHome(place) => {
                if let Some(first) = block.first {
                    return first.fault(NcErrorKind::NotAlone("G28.1 or G30.1"));
                }
                block.is_used_up()?;
                let position = self.position;
                if let Some(slot) = self.setup.foreign.stored.get_mut(usize::from(place)) {
                    *slot = position;
                }
            }
            Meaning::Here => {
                needs_axes(said.span, block)?;
                self.set_here(block, true)?;
            }
            Meaning::Local => {
                needs_axes(said.span, block)?;
                self.set_here(block, false)?;
            }
            Meaning::HereClear => {
                (self.foreign.now.here, self.foreign.now.here_off) = ([Position::ZERO; AXES], false);
            }
            Meaning::HereOff => self.foreign.now.here_off = true,
            Meaning::HereBack => self.foreign.now.here_off = false,
            _ => {}
        }
        self.settle_shift();
        Ok(())
    }

    /// G92: the named axes get these coordinates. G52: they are shifted by these values. Other axes keep their
    /// offsets.
    fn set_here(&mut self, block: &Block<AXES>, stands: bool) -> Result<(), Fault> {
        if core::mem::take(&mut self.foreign.now.here_off) {
            self.foreign.now.here = [Position::ZERO; AXES];
        }
        for (axis, given) in block.axes.iter().enumerate() {
            let Some(given) = *given else { continue };
            let value = self.axis_value(axis, given)?;
            let place = self.without_here(axis);
            let wanted = if stands { place.saturating_sub(value) } else { value };
            if !in_range(wanted) {
                return given.span.fault(self.coordinate_of(axis));
            }
            if let Some(slot) = self.foreign.now.here.get_mut(axis) {
                *slot = wanted;
            }
        }
        Ok(())
    }

    /// The coordinate of an axis without the offset of G92.
    fn without_here(&self, axis: usize) -> Position {
        let of = |values: &[Position; AXES]| values.get(axis).copied().unwrap_or_default();
        let zero = self.offset(axis).saturating_sub(of(&self.modal.shift));
        let length = of(&self.foreign.now.length);
        of(&self.position).saturating_sub(zero).saturating_sub(length)
    }

    /// G10 L2 and L20.
    fn store_offset(&mut self, span: Span, block: &mut Block<AXES>) -> Result<(), Fault> {
        let kind = match block.take(b'L') {
            Some(given) => (self.whole(given, "L of G10", 20)?, given.span),
            None => return span.fault(NcErrorKind::Missing("L2 or L20")),
        };
        if !matches!(kind.0, 2 | 20) {
            let what = "tool table (G10 L1, L10, L11)";
            return kind.1.fault(NcErrorKind::Known { what, hint: "G10 L2 or L20" });
        }
        if let Some(given) = block.take(b'R')
            && given.number.real() != 0.0
        {
            return given.span.fault(NcErrorKind::Known { what: "rotation", hint: "G10 without R" });
        }
        let fanuc = self.setup.foreign.dialect().is_fanuc();
        if fanuc && kind.0 == 20 {
            return kind.1.fault(NcErrorKind::Known { what: "further zero offsets", hint: "G10 L2" });
        }
        let set = match block.take(b'P') {
            Some(given) if fanuc => match self.whole(given, "P of G10", 6)? {
                0 => {
                    let what = "zero offset of all systems";
                    return given.span.fault(NcErrorKind::Known { what, hint: "P1 to P6" });
                }
                set => set,
            },
            Some(given) => self.whole(given, "P of G10", SETS)?,
            None => return span.fault(NcErrorKind::Missing("P0 to P9")),
        };
        let set = match set.checked_sub(1) {
            Some(set) => set as usize,
            None => self.modal.zero_set.unwrap_or(0),
        };
        // No value is stored if any word of the block is wrong.
        block.is_used_up()?;
        let mut stored = [None; AXES];
        for ((axis, given), stored) in block.axes.iter().enumerate().zip(&mut stored) {
            let Some(given) = *given else { continue };
            let value = self.axis_value(axis, given)?;
            let position = self.position.get(axis).copied().unwrap_or_default();
            let shift = self.modal.shift.get(axis).copied().unwrap_or_default();
            let here = position.saturating_sub(shift).saturating_sub(value);
            let adds = fanuc && self.modal.relative;
            let known = self.zero_offsets(set).and_then(|offsets| offsets.get(axis)).copied();
            let base = known.filter(|_| adds).unwrap_or_default();
            let wanted = if kind.0 == 20 { here } else { value.saturating_add(base) };
            if !in_range(wanted) {
                return given.span.fault(self.coordinate_of(axis));
            }
            *stored = Some(wanted);
        }
        for (slot, wanted) in self.zero_offsets(set).into_iter().flatten().zip(stored) {
            *slot = wanted.unwrap_or(*slot);
        }
        Ok(())
    }

    /// G43, G43.1 and G49.
    pub(super) fn set_length(
        &mut self,
        said: Said,
        block: &mut Block<AXES>,
        line: &Line,
    ) -> Result<(), Fault> {
        match said.word.meaning {
            Meaning::NoLength => self.foreign.now.length = [Position::ZERO; AXES],
            Meaning::Length | Meaning::LengthMinus => {
                let loaded = self.foreign.now.tool.loaded;
                let number = match block.take(b'H') {
                    Some(given) => (self.whole(given, "H", u32::MAX)?, given.span),
                    None => (loaded, said.span),
                };
                let length = self.length_of(number, line)?;
                // LinuxCNC's machines differ: H0 is no length, or that of the loaded tool.
                let known = self.setup.foreign.tools.of(loaded).unwrap_or_default();
                if number.0 == 0 && known != 0 && self.setup.foreign.dialect() == Dialect::LinuxCnc {
                    let what = "H0 with a tool that has a length";
                    return number.1.fault(NcErrorKind::Known { what, hint: "G43 without H, or G49" });
                }
                self.foreign.now.length = [Position::ZERO; AXES];
                let applicate = self.setup.main.last().copied().flatten();
                if let Some(slot) = applicate.and_then(|axis| self.foreign.now.length.get_mut(axis)) {
                    let minus = said.word.meaning == Meaning::LengthMinus;
                    *slot = if minus { Position::ZERO.saturating_sub(length) } else { length };
                }
            }
            _ => {
                needs_axes(said.span, block)?;
                for (axis, given) in block.axes.iter().enumerate() {
                    let Some(given) = *given else { continue };
                    let value = self.axis_value(axis, given)?;
                    if let Some(slot) = self.foreign.now.length.get_mut(axis) {
                        *slot = value;
                    }
                }
            }
        }
        self.settle_shift();
        Ok(())
    }

    /// The length of a tool. Without a tool table, the length is 0, with a warning.
    fn length_of(&mut self, (number, span): (u32, Span), line: &Line) -> Result<Position, Fault> {
        let tools = &self.setup.foreign.tools;
        match tools.of(number) {
            Some(tenths) => Ok(of_tenths(tenths)),
            None if number == 0 => Ok(Position::ZERO),
            None if tools.is_empty() && self.setup.foreign.dialect() == Dialect::Grbl => {
                let hint = "G43.1 with the length, or tool lengths in the machine data";
                span.fault(NcErrorKind::Known { what: "tool length of H", hint })
            }
            None if tools.is_empty() => {
                self.warn(line, span, NcWarningKind::NoToolTable);
                Ok(Position::ZERO)
            }
            None => span.fault(NcErrorKind::NoTool),
        }
    }

    /// A whole number from 0 to `max`.
    pub(super) fn whole(&self, given: Given, what: &'static str, max: u32) -> Result<u32, Fault> {
        let Some(value) = given.number.whole() else {
            return given.span.fault(NcErrorKind::NotWhole(what));
        };
        match u32::try_from(value) {
            Ok(value) if value <= max => Ok(value),
            _ => given.span.fault(NcErrorKind::Range { what, min: 0, max, unit: "", above: false }),
        }
    }
}

/// Checks that the block names axes.
fn needs_axes<const AXES: usize>(span: Span, block: &Block<AXES>) -> Result<(), Fault> {
    if block.first.is_some() { Ok(()) } else { span.fault(NcErrorKind::Missing("axis words")) }
}
