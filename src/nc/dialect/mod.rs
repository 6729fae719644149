//! Decodes lines of LinuxCNC, Grbl and Fanuc programs.
//!
//! ```text
//!  Line → block ──words by group──→ order ─fixed order─→ commands, one motion
//!                   words: the table of all dialects     └ course: blocks that make several motions
//! ```
//!
//! Plain lines (only N, G0, G1, F and axis words) take a shorter way, [`super::plain`], as in ISG's language.
//! Modal state that all languages have is in [`super::modal::Modal`]; the rest is in [`Foreign`].
mod block;
mod course;
mod cycle;
mod expression;
mod fanuc;
mod force;
mod lathe;
mod offset;
mod order;
mod output;
mod oword;
mod parameter;
mod saved;
mod spindle;
mod time;
mod words;

pub use force::{InForce, StoredOffsets};
pub use words::{ADDRESSES, AddressEntry, WORDS, WordEntry};

use super::block::{Item, ItemKind};
use super::interpreter::{Gathered, Interpreter, Next, Phase, Refusal};
use super::line::Line;
use super::modal::{Before, Modal, Mode};
use super::{DwellTime, Motion, MotionKind, NcWarningKind, Place, Span};
use crate::machine::{AxisKind, Dialect, MORE_OFFSETS, MachineData, ToolLengths, functions, of_tenths};
use crate::quantity::{Feed, Position};
use crate::technology::Function;
use core::cell::Cell;
use course::{Course, CycleKind, Part};
use oword::Calls;
use saved::SavedStates;
use spindle::Surface;

/// Machine data that only programs in other dialects than ISG's need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForeignSetup<const AXES: usize> {
    /// The dialect of the programs.
    pub dialect: Dialect,
    /// Zero offsets of G59.1…G59.3.
    pub offsets: [[Position; AXES]; MORE_OFFSETS],
    /// Positions of G28 and G30, machine coordinates.
    pub stored: [[Position; AXES]; 2],
    /// Largest deviation of G64 without P, mm.
    pub blend: Position,
    /// Whether lines that begin with `/` are skipped.
    pub block_delete: bool,
    /// Whether M1 pauses the program.
    pub optional_stop: bool,
    /// Tool lengths for G43, along the third main axis.
    pub tools: ToolLengths,
}

impl<const AXES: usize> ForeignSetup<AXES> {
    /// The dialect, among those of this build.
    #[inline(always)]
    pub(super) const fn dialect(&self) -> Dialect {
        match self.dialect {
            Dialect::Isg if functions::ISG.is_built() => Dialect::Isg,
            _ if !functions::DIALECTS.is_built() => Dialect::Grbl,
            dialect => dialect,
        }
    }

    /// The setup for ISG's language.
    pub(super) const ISG: Self = Self {
        dialect: Dialect::Isg,
        offsets: [[Position::ZERO; AXES]; MORE_OFFSETS],
        stored: [[Position::ZERO; AXES]; 2],
        blend: Position::ZERO,
        block_delete: false,
        optional_stop: false,
        tools: ToolLengths::NONE,
    };

    /// The setup from the data of a machine.
    pub(super) fn new(machine: &MachineData<AXES>) -> Self {
        let channel = &machine.channel.foreign;
        let mut setup = Self { dialect: channel.dialect, ..Self::ISG };
        for (axis, data) in machine.axes.iter().enumerate() {
            let sets = setup.offsets.iter_mut().zip(data.foreign.versch);
            let places = setup.stored.iter_mut().zip(data.foreign.stored);
            for (places, tenths) in sets.chain(places) {
                if let Some(slot) = places.get_mut(axis) {
                    *slot = of_tenths(tenths);
                }
            }
        }
        Self {
            blend: of_tenths(channel.blend_tolerance_um.saturating_mul(10).min(100_000_000) as i32),
            block_delete: channel.block_delete,
            optional_stop: channel.optional_stop,
            tools: channel.tools,
            ..setup
        }
    }
}

/// Modal state of other dialects, in addition to [`Modal`].
#[derive(Clone, Copy)]
pub(super) struct State<const AXES: usize> {
    /// Offsets of G92 and G52.
    pub here: [Position; AXES],
    /// Whether the offsets of G92 and G52 are suspended: G92.2.
    pub here_off: bool,
    /// Tool length in force, for each axis.
    pub length: [Position; AXES],
    pub cycle: Option<Cycle>,
    /// Whether G80 is in force: axis words then need a motion word.
    pub no_motion: bool,
    /// Whether G99 is in force: cycles end at R.
    pub to_level: bool,
    /// Whether G93 is in force: F is inverse time.
    pub by_time: bool,
    /// Whether G95 is in force: F counts per revolution.
    pub per_turn: bool,
    /// The surface speed of G96, if G96 is in force.
    pub surface: Option<Surface>,
    /// Spindle speed S, 1/min.
    pub speed: Position,
    /// Spindle word: 3 or 4; 0 if the spindle is off.
    pub spindle: u16,
    /// Coolant: bit 0 for M7, bit 1 for M8.
    pub coolant: u8,
    /// G64: largest deviation of rounded corners; `None` without rounding.
    pub blend: Option<Position>,
    /// F in degrees per minute. With inches, the length unit scales F for lengths, but not for degrees.
    pub degrees: Option<Feed>,
    pub tool: Tools,
}

/// Tool numbers.
#[derive(Clone, Copy)]
pub(super) struct Tools {
    /// Tool of the last T.
    pub selected: u32,
    /// Tool of the last M6 or M61.
    pub loaded: u32,
}

/// An active cycle. Levels are program coordinates, or increments.
#[derive(Clone, Copy)]
pub(super) struct Cycle {
    pub kind: CycleKind,
    pub r: Position,
    pub bottom: Position,
    /// Depth of a peck (Q), and its rounding remainder.
    pub peck: (Position, i64),
    pub back: Position,
    pub dwell: Position,
    /// Machine coordinate of the tool before the first of consecutive cycles.
    pub from: Position,
}

impl<const AXES: usize> State<AXES> {
    const START: Self = Self {
        here: [Position::ZERO; AXES],
        here_off: false,
        length: [Position::ZERO; AXES],
        cycle: None,
        no_motion: false,
        to_level: false,
        by_time: false,
        per_turn: false,
        surface: None,
        speed: Position::ZERO,
        spindle: 0,
        coolant: 0,
        blend: None,
        degrees: None,
        tool: Tools { selected: 0, loaded: 0 },
    };
}

/// A comment with an effect.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Note {
    /// `(MSG, text)`, `(DEBUG, …)` and `(PRINT, …)`: a message. The numbers start at 1, so that all bytes are
    /// zero if there is no comment.
    Message = 1,
    /// `(LOG…, …)`, `(PROBE…)`.
    Other,
    /// `(ABORT, …)`.
    Abort,
}

/// State that only programs of other dialects need.
pub(super) struct Foreign<const AXES: usize> {
    pub now: State<AXES>,
    /// State before the line, restored if the line is refused.
    before: State<AXES>,
    /// Whether [`super::plain`] may read plain lines in the current state.
    plain: bool,
    /// Whether a line `%` has been read.
    percent: bool,
    /// An active comment of the current line.
    pub note: Option<(Note, Place)>,
    /// Place of the text of the message that is due.
    pub message: Place,
    course: Course<AXES>,
    /// M word that ends the block after its motions.
    tail: Option<(u16, Span)>,
    /// M5 and M9 of a Fanuc block: they act after its motion.
    behind: [Option<(u16, Span)>; 2],
    /// Output or input of the current line. `true` for an output that acts at once.
    pub output: (Function, bool),
    saved: SavedStates<AXES>,
    /// Whether the warning about least increments has been given.
    told_increments: bool,
    /// The words from which the course was made.
    span: Span,
    calls: Calls,
    /// Subprogram of M98, and number of calls.
    called: (u32, u32),
}

impl<const AXES: usize> Foreign<AXES> {
    /// An empty state. All bytes are zero, so that a static channel takes no flash.
    pub const BLANK: Self = Self {
        now: State::START,
        before: State::START,
        plain: false,
        percent: false,
        note: None,
        message: Place::NONE,
        course: Course::None,
        tail: None,
        behind: [None; 2],
        output: (Function::M(0), false),
        saved: SavedStates::BLANK,
        told_increments: false,
        span: Span { at: 0, len: 0 },
        calls: Calls::BLANK,
        called: (0, 0),
    };

    /// Whether parts of the current block are still to come.
    pub const fn is_under_way(&self) -> bool {
        self.course.is_some() || self.tail.is_some() || matches!(self.behind, [Some(_), _] | [_, Some(_)])
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Whether programs are in ISG's language.
    #[inline(always)]
    pub fn is_isg(&self) -> bool {
        functions::ISG.is_built() && self.setup.foreign.dialect() == Dialect::Isg
    }

    /// Whether a plain line means the same in the current dialect.
    pub fn takes_plain(&self) -> bool {
        self.is_isg() || self.foreign.plain && self.foreign.note.is_none() && !self.foreign.calls.skips()
    }

    /// Sets the state at the start of a channel.
    pub fn begin_foreign(&mut self) {
        self.foreign = Foreign::BLANK;
        if !self.is_isg() {
            self.begin_program(Mode::Rapid);
        }
    }

    /// Sets the state at program start. The unit, F, G92 and the tool length stay.
    pub fn begin_program(&mut self, mode: Mode) {
        let Modal { inch, diameter, shift, .. } = self.modal;
        // With inverse time, F is valid only for its own block.
        let feed = self.modal.feed.filter(|_| !self.foreign.now.by_time && !self.foreign.now.per_turn);
        self.modal = Modal { mode, inch, diameter, feed, shift, zero_set: Some(0), ..Modal::BLANK };
        let State { here, here_off, length, degrees, tool, speed, .. } = self.foreign.now;
        self.foreign.now = State { here, here_off, length, degrees, tool, speed, ..State::START };
        let Foreign { percent, course, tail, note, .. } = &mut self.foreign;
        (*percent, *course, *tail, *note) = (false, Course::None, None, None);
        self.foreign.behind = [None; 2];
        self.foreign.told_increments = false;
        self.foreign.calls.clear();
        self.foreign.saved.clear_all();
        self.settle_plain();
    }

    /// Closes all calls, loops and branches.
    pub fn clear_calls(&mut self) {
        self.foreign.calls.clear();
    }

    /// Updates whether [`super::plain`] may read plain lines. There must be no cycle, no G80, and no axis
    /// whose F counts in another unit.
    fn settle_plain(&mut self) {
        let State { cycle, no_motion, by_time, per_turn, surface, degrees, .. } = &self.foreign.now;
        let turns = self.setup.kinds.contains(&AxisKind::Rotary) && (self.modal.inch || degrees.is_some());
        let by_spindle = *per_turn || surface.is_some();
        let others = turns || self.modal.diameter;
        self.foreign.plain = cycle.is_none() && !no_motion && !by_time && !by_spindle && !others;
    }

    /// Computes the common shift of G92 and the tool length.
    fn settle_shift(&mut self) {
        let State { here, here_off, length, .. } = &self.foreign.now;
        for ((shift, here), length) in self.modal.shift.iter_mut().zip(here).zip(length) {
            let here = if *here_off { Position::ZERO } else { *here };
            *shift = here.saturating_add(*length);
        }
    }

    /// Restores the state before a refused line.
    pub fn refuse_foreign(&mut self) {
        self.foreign.note = None;
        if self.foreign.is_under_way() || matches!(self.before, Before::All(_)) {
            self.foreign.now = self.foreign.before;
        }
        (self.foreign.course, self.foreign.tail, self.foreign.behind) = (Course::None, None, [None; 2]);
    }

    /// Emits the next part of a block with several parts, or the words after its motions.
    pub fn foreign_part(&mut self, line: &Line) {
        let mut position = self.position;
        let Foreign { course, span, .. } = &mut self.foreign;
        let span = *span;
        let item = match course.next(&position, &mut self.rests) {
            Some(Part::Motion(kind, target)) => {
                position = target;
                self.gathered = Gathered::Motion(Cell::new(self.part(kind, target, line.place(span))));
                ItemKind::Motion
            }
            Some(Part::Dwell(time)) => ItemKind::Dwell(DwellTime::Seconds(time)),
            Some(Part::M(code)) => ItemKind::M(code),
            None => {
                self.foreign.course = Course::None;
                self.end_block();
                return;
            }
        };
        self.position = position;
        let _ = self.queue.push_back(Item { span, kind: item });
    }

    /// A motion of a block with several motions.
    fn part(&self, kind: MotionKind, target: [Position; AXES], place: Place) -> Motion<AXES> {
        let moved = target.iter().zip(&self.position).enumerate().filter(|(_, (to, from))| to != from);
        let named = moved.fold(0_u32, |bits, (axis, _)| bits | 1_u32.wrapping_shl(axis as u32));
        // Corners of a cycle are not rounded.
        let stops = matches!(self.foreign.course, Course::Holes(_)) && self.foreign.now.blend.is_some();
        Motion {
            n: self.n,
            place,
            centre: place,
            kind,
            target,
            feed: self.path_feed(),
            exact_stop: self.modal.exact_stop || stops,
            named,
        }
    }

    /// Carries out M0, M1, M2, M30 or M60 after the motions of their block.
    fn end_block(&mut self) {
        for slot in &mut self.foreign.behind {
            if let Some((code, span)) = slot.take() {
                let _ = self.queue.push_back(Item { span, kind: ItemKind::M(code) });
            }
        }
        let Some((code, span)) = self.foreign.tail.take() else { return };
        let kind = match code {
            2 | 30 => {
                self.end_program(span);
                ItemKind::ProgramEnd(code)
            }
            _ => ItemKind::Pause(code),
        };
        let _ = self.queue.push_back(Item { span, kind });
    }

    /// M2 and M30: switches spindle and coolant off, and restores the state at program start. The motion word
    /// is then G1.
    fn end_program(&mut self, span: Span) {
        let State { spindle, coolant, blend, .. } = self.foreign.now;
        let blends = blend.is_some();
        let off =
            [(spindle != 0, ItemKind::M(5)), (coolant != 0, ItemKind::M(9)), (blends, ItemKind::Switch(260))];
        for (_, kind) in off.into_iter().filter(|(on, _)| *on) {
            let _ = self.queue.push_back(Item { span, kind });
        }
        self.begin_program(Mode::Line);
        self.phase = Phase::Ended;
    }

    /// Handles the end of the text without M2 or M30.
    ///
    /// # Errors
    /// A subroutine, a loop or a branch is not closed.
    pub fn end_of_foreign_text(&mut self, here: Place) -> Result<Next, Refusal> {
        if self.phase != Phase::Ended
            && let Some((place, kind)) = self.foreign.calls.unfinished()
        {
            return Err(Refusal::At(place, kind));
        }
        if let Some(next) = self.end_of_called_file() {
            return Ok(next);
        }
        if self.phase == Phase::Running && self.setup.foreign.dialect() != Dialect::Grbl {
            self.warn_at(here, NcWarningKind::NoProgramEnd);
        }
        self.phase = Phase::Ended;
        Ok(Next::Line)
    }
}
