//! The order in which program text is carried out: control blocks (`$IF`, loops), calls and jumps. Stacks of
//! fixed size hold the places in the text to which the program returns.
use super::line::Mark;
use super::{NcErrorKind, Place};
use crate::machine::functions;
use heapless::Vec;

/// Number of control blocks that may be open at the same time, counted over all calls.
pub const NESTING: usize = functions::EXPRESSIONS.room(20);
/// Number of subroutine calls that may be open at the same time: 10; 6 in a small build.
pub const CALL_DEPTH: usize = if functions::IS_SMALL { 6 } else { 10 };
/// Number of local subroutines in all files of a program: 64; 16 in a small build.
pub const SUBROUTINES: usize = if functions::IS_SMALL { 16 } else { 64 };

/// Kinds of control blocks, with the data to continue them.
#[derive(Clone, Copy)]
pub(super) enum Block {
    /// Number of the counter, end value, step.
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
    /// The line that opened the block.
    pub start: Mark,
    /// The line after the opening line.
    pub body: Mark,
    pub place: Place,
}

/// An open call.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    /// The line at which the caller continues.
    pub back: Mark,
    /// Start of the caller's program.
    pub program: Mark,
    /// Number of control blocks that were open at the call.
    pub blocks: u8,
}

/// A local subroutine: hash of its name, and first line of its text. Packed to save memory, because there are
/// many.
#[derive(Clone, Copy)]
#[repr(C, packed(4))]
pub(super) struct Subroutine {
    pub name: u64,
    pub body: Mark,
}

/// The reason why lines are skipped, and up to which word.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Passing {
    /// No lines are skipped.
    No,
    /// To the next $ELSEIF, $ELSE or $ENDIF.
    Branch,
    /// To the next $CASE, $DEFAULT or $ENDSWITCH.
    Case,
    /// To the closing word, after which the block is left.
    Out,
    /// To the closing word of a loop, which is then carried out ($CONTINUE).
    Round,
    /// To a label, given by its hash. `Flow::passed` holds the blocks that are opened before the label.
    Label(u64),
    /// The program has ended inside control blocks. Lines are skipped up to their closing words, which must
    /// exist.
    End(Ending),
}

/// The level that a program end word ends.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Ending {
    /// M17, M29.
    Subroutine,
    /// M02, M30.
    Program,
}

/// The state of program flow.
pub(super) struct Flow {
    pub blocks: Vec<Open, NESTING>,
    pub frames: Vec<Frame, CALL_DEPTH>,
    pub subroutines: Vec<Subroutine, SUBROUTINES>,
    /// Start of the text of the running program.
    pub program: Mark,
    pub passing: Passing,
    /// Number of blocks that were opened in skipped lines.
    pub depth: u16,
    /// Offsets of the open blocks at the current line, in a search for a label.
    pub passed: Vec<u32, NESTING>,
    /// The place where skipping began, for messages.
    pub origin: Place,
    /// The line after this place.
    pub behind: Mark,
    /// Whether the current jump has already left its control blocks.
    pub left: bool,
}

impl Flow {
    /// A state whose bits are all zero. Call [`Self::begin`] before use.
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

    /// Sets the state before the first line.
    pub fn begin(&mut self) {
        self.clear();
        self.passed.clear();
        (self.program, self.behind) = (Mark::start_of(0), Mark::start_of(0));
        (self.depth, self.origin, self.left) = (0, Place::NONE, false);
    }

    /// Closes all blocks and forgets all subroutines.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.frames.clear();
        self.subroutines.clear();
        self.passing = Passing::No;
    }

    /// Leaves the open blocks of the running program.
    pub fn leave_blocks(&mut self) {
        let base = self.base();
        self.blocks.truncate(base);
        self.passing = Passing::No;
    }

    /// The local subroutine with this name. The search begins in the running file and continues in its
    /// callers, the nearest first.
    pub fn subroutine(&self, name: u64) -> Option<Subroutine> {
        let callers = self.frames.iter().rev().map(|frame| frame.program.file);
        core::iter::once(self.program.file)
            .chain(callers)
            .find_map(|file| self.subroutines.iter().find(|s| s.name == name && s.body.file == file))
            .copied()
    }

    /// Number of control blocks that were open before the running program was called.
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

    /// Whether lines are skipped.
    pub fn is_passing(&self) -> bool {
        functions::EXPRESSIONS.is_built() && self.passing != Passing::No
    }

    /// Begins to skip lines. `depth`: number of open control blocks inside the block whose words end the
    /// skipping.
    pub fn pass(&mut self, passing: Passing, depth: u16, origin: Place) {
        self.passing = passing;
        self.depth = depth;
        self.passed.clear();
        self.origin = origin;
    }

    /// Leaves control blocks until the innermost one is a loop, or also a switch if `or_switch` is true.
    /// Returns the number of blocks left, or `None` if there is no loop.
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

    /// Returns to the caller. Returns `None` in the main program.
    pub fn leave_call(&mut self) -> Option<Mark> {
        let frame = self.frames.pop()?;
        self.blocks.truncate(usize::from(frame.blocks));
        self.program = frame.program;
        Some(frame.back)
    }
}

/// A hash: FNV-1a, 64 bits. Two names in one file with equal hashes are not expected.
pub(super) fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3))
}
