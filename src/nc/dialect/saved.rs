//! M70 to M73: modal state that is kept for the call at hand, and brought back.
use super::spindle::Surface;
use super::words::Meaning;
use super::{Interpreter, State};
use crate::nc::block::ItemKind;
use crate::nc::flow::CALL_DEPTH;
use crate::nc::modal::Modal;
use crate::nc::{Fault, NcErrorKind, Plane, Span};
use crate::quantity::{Feed, Position};

/// What is on or off.
#[derive(Clone, Copy)]
struct Modes {
    relative: bool,
    centre_absolute: bool,
    inch: bool,
    exact_stop: bool,
    to_level: bool,
    by_time: bool,
    per_turn: bool,
    diameter: bool,
}

/// What M70 keeps: all but the motion word and the offsets of G92.
#[derive(Clone, Copy)]
pub(super) struct Saved<const AXES: usize> {
    modes: Modes,
    plane: Plane,
    coolant: u8,
    spindle: u16,
    zero_set: Option<usize>,
    feed: Option<Feed>,
    degrees: Option<Feed>,
    speed: Position,
    blend: Option<Position>,
    surface: Option<Surface>,
    length: [Position; AXES],
}

/// States by call level, 0 for the main program.
pub(super) struct SavedStates<const AXES: usize> {
    states: [Option<Saved<AXES>>; CALL_DEPTH + 1],
    /// A bit for each level whose state comes back where it ends: M73.
    comes_back: u16,
}

impl<const AXES: usize> SavedStates<AXES> {
    pub const BLANK: Self = Self { states: [None; CALL_DEPTH + 1], comes_back: 0 };

    /// Nothing is kept of a level.
    pub fn clear(&mut self, level: usize) {
        if let Some(slot) = self.states.get_mut(level) {
            *slot = None;
        }
        self.comes_back &= !1_u16.wrapping_shl(level as u32);
    }

    /// Nothing is kept of any level.
    pub fn clear_all(&mut self) {
        (self.states, self.comes_back) = ([None; CALL_DEPTH + 1], 0);
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// M70 to M73.
    pub(super) fn keep_state(&mut self, meaning: Meaning, span: Span) -> Result<(), Fault> {
        let level = self.foreign.calls.level();
        match meaning {
            Meaning::Save(comes_back) => {
                let Modal { plane, relative, centre_absolute, inch, exact_stop, zero_set, feed, .. } =
                    self.modal;
                let State { to_level, by_time, per_turn, blend, coolant, spindle, .. } = self.foreign.now;
                let State { degrees, speed, surface, length, .. } = self.foreign.now;
                let diameter = self.modal.diameter;
                let modes = Modes {
                    relative,
                    centre_absolute,
                    inch,
                    exact_stop,
                    to_level,
                    by_time,
                    per_turn,
                    diameter,
                };
                let saved = Saved {
                    modes,
                    plane,
                    coolant,
                    spindle,
                    zero_set,
                    feed,
                    degrees,
                    speed,
                    blend,
                    surface,
                    length,
                };
                self.foreign.saved.clear(level);
                if let Some(slot) = self.foreign.saved.states.get_mut(level) {
                    *slot = Some(saved);
                }
                if comes_back {
                    self.foreign.saved.comes_back |= 1_u16.wrapping_shl(level as u32);
                }
            }
            Meaning::Forget => self.foreign.saved.clear(level),
            _ => {
                let Some(saved) = self.foreign.saved.states.get(level).copied().flatten() else {
                    return span.fault(NcErrorKind::Missing("M70 or M73 before it, in the same subroutine"));
                };
                self.bring_back(&saved, span)?;
            }
        }
        Ok(())
    }

    /// A call ends: what M73 has kept comes back.
    pub(super) fn end_of_level(&mut self, level: usize) {
        let saved = &mut self.foreign.saved;
        let comes_back = saved.comes_back & 1_u16.wrapping_shl(level as u32) != 0;
        let state = saved.states.get(level).copied().flatten();
        saved.clear(level);
        if let Some(state) = state.filter(|_| comes_back) {
            // The block of an end holds nothing else: there is room for what changes.
            let _ = self.bring_back(&state, Span::default());
        }
        self.settle_plain();
    }

    fn bring_back(&mut self, saved: &Saved<AXES>, span: Span) -> Result<(), Fault> {
        let State { speed, spindle, coolant, .. } = self.foreign.now;
        let Modes { relative, centre_absolute, inch, exact_stop, to_level, by_time, per_turn, diameter } =
            saved.modes;
        if speed != saved.speed {
            self.push(ItemKind::Spindle(saved.speed), span)?;
        }
        if spindle != saved.spindle {
            self.push(ItemKind::M(if saved.spindle == 0 { 5 } else { saved.spindle }), span)?;
        }
        if coolant & !saved.coolant != 0 {
            self.push(ItemKind::M(9), span)?;
        }
        let kept = if coolant & !saved.coolant != 0 { 0 } else { coolant };
        for (bit, code) in [(1, 7), (2, 8)] {
            if saved.coolant & !kept & bit != 0 {
                self.push(ItemKind::M(code), span)?;
            }
        }
        match saved.blend {
            None => self.path_mode(exact_stop, span)?,
            Some(blend) if self.foreign.now.blend != Some(blend) => self.blend_by(blend, span)?,
            Some(_) => {}
        }
        let Saved { plane, feed, zero_set, degrees, surface, length, .. } = *saved;
        self.modal = Modal { plane, relative, centre_absolute, inch, diameter, feed, zero_set, ..self.modal };
        let (speed, spindle, coolant) = (saved.speed, saved.spindle, saved.coolant);
        let now = State { to_level, by_time, per_turn, degrees, surface, length, ..self.foreign.now };
        self.foreign.now = State { speed, spindle, coolant, ..now };
        self.settle_shift();
        Ok(())
    }
}
