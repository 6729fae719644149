//! What the program text does to its own order: control blocks, calls, jumps; bounded stacks of places in the
//! text.
use super::line::Mark;
use super::{NcErrorKind, Place};
use crate::machine::functions;
use heapless::Vec;

/// Control blocks that may be open at the same time, over all calls.
pub const NESTING: usize = functions::EXPRESSIONS.room(20);
/// Subroutine calls that may be open at the same time: 10; 6 in a build for little memory.
pub const CALL_DEPTH: usize = if functions::IS_SMALL { 6 } else { 10 };
/// Local subroutines in all files of a program: 64; 16 in a build for little memory.
pub const SUBROUTINES: usize = if functions::IS_SMALL { 16 } else { 64 };

/// Kinds of control blocks, with what is needed to go on.
#[derive(Clone, Copy)]
pub(super) enum Block {
    /// Counter, last value, step.
    For {
        counter: u32,
        end: f64,
        step: f64,
    },
    While,
    Do,
    Repeat,
    If,
    Switch {
        value: f64,
    },
}

impl Block {
    pub const fn opening(self) -> &'static str {
        match self {
            Self::For { .. } => "$FOR",
            Self::While => "$WHILE",
            Self::Do => "$DO",
            Self::Repeat => "$REPEAT",
            Self::If => "$IF",
            Self::Switch { .. } => "$SWITCH",
        }
    }

    pub const fn closing(self) -> &'static str {
        match self {
            Self::For { .. } => "$ENDFOR",
            Self::While => "$ENDWHILE",
            Self::Do => "$ENDDO",
            Self::Repeat => "$UNTIL",
            Self::If => "$ENDIF",
            Self::Switch { .. } => "$ENDSWITCH",
        }
    }

    pub const fn is_loop(self) -> bool {
        matches!(self, Self::For { .. } | Self::While | Self::Do | Self::Repeat)
    }
}

/// An open control block.
#[derive(Clone, Copy)]
pub(super) struct Open {
    pub block: Block,
    /// The line that opened it.
    pub start: Mark,
    /// The line behind it.
    pub body: Mark,
    pub place: Place,
}

/// An open call.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    /// Where the caller goes on.
    pub back: Mark,
    /// Start of the caller's own text.
    pub program: Mark,
    /// Control blocks that were open at the call.
    pub blocks: u8,
}

/// A local subroutine: hash of its name, first line of its text. Packed: there are many of them.
#[derive(Clone, Copy)]
#[repr(C, packed(4))]
pub(super) struct Subroutine {
    pub name: u64,
    pub body: Mark,
}

/// What lines are passed over for.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Passing {
    /// They are not.
    No,
    /// To the next $ELSEIF, $ELSE or $ENDIF.
    Branch,
    /// To the next $CASE, $DEFAULT or $ENDSWITCH.
    Case,
    /// To the closing word, and out of the block.
    Out,
    /// To the closing word of a loop, which is then carried out ($CONTINUE).
    Round,
    /// To a label, by its hash; blocks opened on the way are in `Flow::passed`.
    Label(u64),
    /// The program has ended inside control blocks: to their closing words, which must be there.
    End(Ending),
}

/// What a program end word ends.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Ending {
    /// M17, M29.
    Subroutine,
    /// M02, M30.
    Program,
}

/// The state of the order of blocks.
pub(super) struct Flow {
    pub blocks: Vec<Open, NESTING>,
    pub frames: Vec<Frame, CALL_DEPTH>,
    pub subroutines: Vec<Subroutine, SUBROUTINES>,
    /// Start of the text of the program that runs.
    pub program: Mark,
    pub passing: Passing,
    /// Depth of blocks opened while passing.
    pub depth: u16,
    /// Offsets of the blocks open at the line reached in a search for a label.
    pub passed: Vec<u32, NESTING>,
    /// What the passing began with, for messages.
    pub origin: Place,
    /// The line behind that.
    pub behind: Mark,
    /// What the jump at hand leaves is left already.
    pub left: bool,
}

impl Flow {
    /// All bits zero; it begins with [`Self::begin`].
    pub const fn new() -> Self {
        Self {
            blocks: Vec::new(),
            frames: Vec::new(),
            subroutines: Vec::new(),
            program: Mark::BLANK,
            passing: Passing::No,
            depth: 0,
            passed: Vec::new(),
            origin: Place::NONE,
            behind: Mark::BLANK,
            left: false,
        }
    }

    /// Before the first line.
    pub fn begin(&mut self) {
        self.clear();
        self.passed.clear();
        (self.program, self.behind) = (Mark::start_of(0), Mark::start_of(0));
        (self.depth, self.origin, self.left) = (0, Place::NONE, false);
    }

    /// Nothing is open, and no subroutine is known.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.frames.clear();
        self.subroutines.clear();
        self.passing = Passing::No;
    }

    /// What is open in the running program is left.
    pub fn leave_blocks(&mut self) {
        let base = self.base();
        self.blocks.truncate(base);
        self.passing = Passing::No;
    }

    /// The local subroutine of that name: of the file that runs, else of the nearest caller that has it.
    pub fn subroutine(&self, name: u64) -> Option<Subroutine> {
        let callers = self.frames.iter().rev().map(|frame| frame.program.file);
        core::iter::once(self.program.file)
            .chain(callers)
            .find_map(|file| self.subroutines.iter().find(|s| s.name == name && s.body.file == file))
            .copied()
    }

    /// Control blocks open before the running program was called.
    pub fn base(&self) -> usize {
        self.frames.last().map_or(0, |f| usize::from(f.blocks))
    }

    /// The innermost control block of the running program.
    pub fn innermost(&mut self) -> Option<&mut Open> {
        let base = self.base();
        if self.blocks.len() > base { self.blocks.last_mut() } else { None }
    }

    pub fn open(&mut self, open: Open) -> Result<(), NcErrorKind> {
        self.blocks.push(open).map_err(|_| NcErrorKind::NestingTooDeep)
    }

    /// Whether lines are passed over.
    pub fn is_passing(&self) -> bool {
        functions::EXPRESSIONS.is_built() && self.passing != Passing::No
    }

    /// Begins to pass over lines, `depth` blocks inside the one that matters.
    pub fn pass(&mut self, passing: Passing, depth: u16, origin: Place) {
        self.passing = passing;
        self.depth = depth;
        self.passed.clear();
        self.origin = origin;
    }

    /// Leaves control blocks until a loop (or a switch) is innermost and says how many; `None` if there is
    /// none.
    pub fn leave_to_loop(&mut self, or_switch: bool) -> Option<u16> {
        let base = self.base();
        let mut left = 0;
        while self.blocks.len() > base {
            let block = self.blocks.last()?.block;
            if block.is_loop() || or_switch && matches!(block, Block::Switch { .. }) {
                return Some(left);
            }
            self.blocks.pop();
            left += 1;
        }
        None
    }

    /// Goes back to the caller; `None` in the main program.
    pub fn leave_call(&mut self) -> Option<Mark> {
        let frame = self.frames.pop()?;
        self.blocks.truncate(usize::from(frame.blocks));
        self.program = frame.program;
        Some(frame.back)
    }
}

/// FNV-1a, 64 bits: two names of one file with one hash are not expected in this universe.
pub(super) fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3))
}
