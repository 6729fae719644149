//! M70 to M73 of LinuxCNC: save and restore the modal state of the current call.
use super::spindle::Surface;
use super::words::Meaning;
use super::{Interpreter, State};
use crate::nc::block::ItemKind;
use crate::nc::flow::CALL_DEPTH;
use crate::nc::modal::Modal;
use crate::nc::{Fault, NcErrorKind, Plane, Span};
use crate::quantity::{Feed, Position};

/// Modes that are on or off.
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

/// The state that M70 saves: all modal state except the motion word and the offsets of G92.
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

impl<const AXES: usize> Saved<AXES> {
    const BLANK: Self = Self {
        modes: Modes {
            relative: false,
            centre_absolute: false,
            inch: false,
            exact_stop: false,
            to_level: false,
            by_time: false,
            per_turn: false,
            diameter: false,
        },
        plane: Plane::G17,
        coolant: 0,
        spindle: 0,
        zero_set: None,
        feed: None,
        degrees: None,
        speed: Position::ZERO,
        blend: None,
        surface: None,
        length: [Position::ZERO; AXES],
    };
}

/// Saved states by call level; level 0 is the main program.
pub(super) struct SavedStates<const AXES: usize> {
    states: [Saved<AXES>; CALL_DEPTH + 1],
    /// One bit for each level with a saved state.
    kept: u16,
    /// One bit for each level whose state is restored at its end (M73).
    comes_back: u16,
}

impl<const AXES: usize> SavedStates<AXES> {
    /// No saved state; all bytes are zero.
    pub const BLANK: Self = Self { states: [Saved::BLANK; CALL_DEPTH + 1], kept: 0, comes_back: 0 };

    /// Drops the saved state of a level.
    pub fn clear(&mut self, level: usize) {
        let others = !1_u16.wrapping_shl(level as u32);
        (self.kept, self.comes_back) = (self.kept & others, self.comes_back & others);
    }

    /// The saved state of a level.
    fn get(&self, level: usize) -> Option<Saved<AXES>> {
        let is_kept = self.kept & 1_u16.wrapping_shl(level as u32) != 0;
        self.states.get(level).filter(|_| is_kept).copied()
    }

    /// Drops all saved states.
    pub fn clear_all(&mut self) {
        (self.kept, self.comes_back) = (0, 0);
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Carries out M70 to M73.
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
                    *slot = saved;
                    self.foreign.saved.kept |= 1_u16.wrapping_shl(level as u32);
                }
                if comes_back {
                    self.foreign.saved.comes_back |= 1_u16.wrapping_shl(level as u32);
                }
            }
            Meaning::Forget => self.foreign.saved.clear(level),
            _ => {
                let Some(saved) = self.foreign.saved.get(level) else {
                    return span.fault(NcErrorKind::Missing("M70 or M73 before it, in the same subroutine"));
                };
                self.bring_back(&saved, span)?;
            }
        }
        Ok(())
    }

    /// Ends a call: restores the state that M73 saved.
    pub(super) fn end_of_level(&mut self, level: usize) {
        let saved = &mut self.foreign.saved;
        let comes_back = saved.comes_back & 1_u16.wrapping_shl(level as u32) != 0;
        let state = saved.get(level);
        saved.clear(level);
        if let Some(state) = state.filter(|_| comes_back) {
            // The block that ends a call holds nothing else, so there is room for all changes.
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
