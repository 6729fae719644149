//! Real-time loops (feature `plc`): the blocks between `#RT WHILE` and `#RT ENDWHILE` repeat until a PLC ends
//! the loop.
//!
//! The planner reads the loop once and stores its commands. The planner then plans one pass after the other,
//! as long as the variable V.RTG.LOOP.ENABLED is true. For the look-ahead, all passes are one long path. So
//! the axes need not stop between two passes.
//!
//! ```
//! use glidepath::rt_loop::LoopMemory;
//!
//! let mut memory = LoopMemory::<3, 64>::new(); // in firmware: a static
//! let (store, switch) = memory.split();
//! // planner.real_time_loops(store); once, before the first poll
//! switch.enable(); // the PLC: loops repeat
//! assert!(switch.is_enabled());
//! switch.disable(); // the PLC: the pass at hand is the last one
//! # let _ = store;
//! ```
use crate::nc::{Command, ContourLog, Head, Motion, MotionKind, Place, Spline};
use crate::quantity::Position;
use crate::variable::LoopFlag;
use core::sync::atomic::{AtomicU32, Ordering};
use heapless::{Vec, VecView};

/// A command of a loop.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stored<const AXES: usize> {
    Motion(Motion<AXES>),
    Log(Head, ContourLog),
    /// #SPLINE ON and OFF.
    Spline(Head, bool),
}

impl<const AXES: usize> Stored<AXES> {
    /// The stored command.
    pub const fn command(&self) -> Command<AXES> {
        match *self {
            Self::Motion(motion) => Command::Motion(motion),
            Self::Log(head, log) => Command::ContourLog(head, log),
            Self::Spline(head, true) => Command::Spline(head, Spline::On),
            Self::Spline(head, false) => Command::Spline(head, Spline::Off),
        }
    }
}

/// State that the planner and the PLC share.
struct Shared {
    flag: LoopFlag,
    /// Number of passes that the planner has begun to plan. Only the planner writes it.
    passes: AtomicU32,
}

/// Memory of real-time loops with room for `COMMANDS` commands: motion blocks, `#SPLINE`, and commands of the
/// log of the path.
///
/// P-STUP-00033 (fb_storage_size) limits the bytes of the commands; the smaller one of both limits acts. A
/// new memory has only zero bytes and bytes without a value, so a static memory lies in `.bss` and takes no
/// flash.
pub struct LoopMemory<const AXES: usize, const COMMANDS: usize> {
    commands: Vec<Stored<AXES>, COMMANDS>,
    shared: Shared,
}

impl<const AXES: usize, const COMMANDS: usize> LoopMemory<AXES, COMMANDS> {
    /// Size of the memory for the commands of a loop, bytes.
    pub const BYTES: usize = COMMANDS * Self::COMMAND_BYTES;
    /// Size of one command, bytes.
    pub const COMMAND_BYTES: usize = size_of::<Stored<AXES>>();

    /// An empty memory; V.RTG.LOOP.ENABLED is false.
    pub const fn new() -> Self {
        let shared = Shared { flag: LoopFlag::new(), passes: AtomicU32::new(0) };
        Self { commands: Vec::new(), shared }
    }

    /// Clears the memory. Returns the planner's handle, for [`crate::Planner::real_time_loops`], and the
    /// PLC's handle. V.RTG.LOOP.ENABLED is false.
    pub fn split(&mut self) -> (LoopStore<'_, AXES>, LoopSwitch<'_>) {
        *self = Self::new();
        let Self { commands, shared } = self;
        let commands = commands.as_mut_view();
        let room = commands.capacity();
        (LoopStore { commands, room, shared }, LoopSwitch { shared })
    }
}

impl<const AXES: usize, const COMMANDS: usize> Default for LoopMemory<AXES, COMMANDS> {
    fn default() -> Self {
        Self::new()
    }
}

/// The PLC's handle of a real-time loop: decides whether the loop repeats. The handle is `Copy`, `Send` and
/// `Sync`. Only one task or interrupt may call [`Self::enable`] and [`Self::disable`].
#[derive(Clone, Copy)]
pub struct LoopSwitch<'a> {
    shared: &'a Shared,
}

impl LoopSwitch<'_> {
    /// Sets V.RTG.LOOP.ENABLED to true: programs enter loops and repeat them.
    pub fn enable(self) {
        self.shared.flag.set(true);
    }

    /// Sets V.RTG.LOOP.ENABLED to false: the motion leaves the loop at the end of the last planned pass.
    pub fn disable(self) {
        self.shared.flag.set(false);
    }

    /// V.RTG.LOOP.ENABLED, as last set by the PLC or by the program.
    pub fn is_enabled(self) -> bool {
        self.shared.flag.get()
    }

    /// Number of passes, of all loops, that the planner has begun to plan since [`LoopMemory::split`]. The
    /// number wraps around.
    pub fn passes(self) -> u32 {
        self.shared.passes.load(Ordering::Acquire)
    }
}

/// The planner's handle of the loop memory: stores the commands of a loop and returns them again.
pub struct LoopStore<'a, const AXES: usize> {
    commands: &'a mut VecView<Stored<AXES>>,
    /// Number of commands that P-STUP-00033 permits.
    room: usize,
    shared: &'a Shared,
}

impl<'a, const AXES: usize> LoopStore<'a, AXES> {
    /// V.RTG.LOOP.ENABLED, for the decoder.
    pub(crate) const fn flag(&self) -> &'a LoopFlag {
        &self.shared.flag
    }

    /// Limits the commands of a loop to `bytes`: P-STUP-00033.
    pub(crate) fn limit(&mut self, bytes: u32) {
        self.room = bytes as usize / size_of::<Stored<AXES>>().max(1);
    }

    /// Removes all commands.
    pub(crate) fn clear(&mut self) {
        self.commands.clear();
    }

    /// Whether `V.RTG.LOOP.ENABLED` is true.
    pub(crate) fn is_enabled(&self) -> bool {
        self.shared.flag.get()
    }

    /// Counts a pass that the planner begins to plan.
    pub(crate) fn pass(&self) {
        let passes = self.shared.passes.load(Ordering::Relaxed);
        self.shared.passes.store(passes.wrapping_add(1), Ordering::Release);
    }

    /// The command with this number, from 0.
    pub(crate) fn get(&self, number: usize) -> Option<&Stored<AXES>> {
        self.commands.get(number)
    }

    /// Place of the first command in the program text.
    pub(crate) fn place(&self) -> Option<Place> {
        self.get(0).map(|stored| stored.command().place())
    }

    /// Stores a command.
    ///
    /// # Errors
    /// The command is not permitted in a loop, or there is no room.
    pub(crate) fn push(&mut self, command: &Command<AXES>) -> Result<(), LoopError> {
        let stored = match command {
            Command::Motion(motion) if !motion.exact_stop => Stored::Motion(*motion),
            Command::Motion(_) => return Err(LoopError::NotInside("an exact stop (G60, G360)")),
            Command::ContourLog(_, ContourLog::Clear) => return Err(LoopError::NotInside("LOG CLEAR")),
            Command::ContourLog(head, log) => Stored::Log(*head, *log),
            Command::Spline(head, Spline::On) => Stored::Spline(*head, true),
            Command::Spline(head, Spline::Off) => Stored::Spline(*head, false),
            Command::RtWhile(..) => return Err(LoopError::Nested),
            other => return Err(LoopError::NotInside(other.name())),
        };
        if self.commands.len() >= self.room {
            return Err(LoopError::TooLong(self.room));
        }
        let built = self.commands.capacity();
        self.commands.push(stored).map_err(|_| LoopError::Full(built))
    }

    /// Whether a spline is on after the last command. `before`: whether a spline was on before the first
    /// command.
    pub(crate) fn spline(&self, before: bool) -> bool {
        let last = self.commands.iter().rev().find_map(|stored| match stored {
            Stored::Spline(_, on) => Some(*on),
            _ => None,
        });
        last.unwrap_or(before)
    }

    /// End position of the last motion.
    pub(crate) fn end(&self) -> Option<[Position; AXES]> {
        self.commands.iter().rev().find_map(|stored| match stored {
            Stored::Motion(motion) => Some(motion.target),
            _ => None,
        })
    }

    /// Whether any axis moves between `start` and the end of the loop.
    pub(crate) fn moves(&self, start: &[Position; AXES]) -> bool {
        self.commands.iter().any(|stored| match stored {
            Stored::Motion(motion) => {
                matches!(motion.kind, MotionKind::Arc { .. }) || motion.target != *start
            }
            _ => false,
        })
    }
}

/// The reason why a real-time loop is refused. Each number is that of ISG's error message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LoopError {
    /// 22073: a real-time loop cannot contain this command. The text is its name.
    NotInside(&'static str),
    /// 22181: the loop is inside another loop.
    Nested,
    /// 22128: a spline is on at the beginning of the loop.
    SplineBefore,
    /// 22129: a spline is on at the end of the loop.
    SplineBehind,
    /// 50991: the end point of the loop differs from its start point.
    NotClosed,
    /// No axis moves in the loop.
    NoMotion,
    /// The loop has more commands than P-STUP-00033 has room for.
    TooLong(usize),
    /// The loop has more commands than the memory of this build has room for.
    Full(usize),
    /// P-STUP-00033 is 0: there is no storage for loops.
    NoStorage,
    /// The planner has no memory for loops.
    NoMemory,
    /// `#RT ENDWHILE` without `#RT WHILE`.
    Unopened,
    /// `#RT WHILE` without `#RT ENDWHILE`; the place is that of `#RT WHILE`.
    Unclosed,
}

impl LoopError {
    /// ISG's number of this message; 0 if none is known.
    pub const fn id(self) -> u32 {
        match self {
            Self::NotInside(_) => 22073,
            Self::Nested => 22181,
            Self::SplineBefore => 22128,
            Self::SplineBehind => 22129,
            Self::NotClosed => 50991,
            _ => 0,
        }
    }
}

impl core::fmt::Display for LoopError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NotInside(name) => write!(
                f,
                "{name} in a real-time loop; expected G00 to G03, #SPLINE ON or OFF, #CONTOUR LOOKAHEAD LOG ON, OFF or [PARAM=…]"
            ),
            Self::Nested => f.write_str("a real-time loop in a real-time loop; expected #RT ENDWHILE before it"),
            Self::SplineBefore => {
                f.write_str("a spline is on where the real-time loop begins; expected #SPLINE OFF before #RT WHILE")
            }
            Self::SplineBehind => {
                f.write_str("a spline is on where the real-time loop ends; expected #SPLINE OFF before #RT ENDWHILE")
            }
            Self::NotClosed => f.write_str(
                "the real-time loop ends elsewhere than it begins; expected all axes at the position of #RT WHILE",
            ),
            Self::NoMotion => f.write_str("no axis moves in the real-time loop; expected a motion block"),
            Self::TooLong(room) => write!(
                f,
                "the real-time loop has more than {room} commands; expected fewer, or more storage (P-STUP-00033, fb_storage_size)"
            ),
            Self::Full(room) => write!(
                f,
                "the real-time loop has more than {room} commands; expected fewer: this build has memory for so many"
            ),
            Self::NoStorage => f.write_str(
                "there is no storage for real-time loops; expected fb_storage_size[0] above 0 (P-STUP-00033)",
            ),
            Self::NoMemory => f.write_str(
                "#RT WHILE is not available; expected a build with memory for real-time loops",
            ),
            Self::Unopened => f.write_str("#RT ENDWHILE without #RT WHILE; expected #RT WHILE before it"),
            Self::Unclosed => f.write_str("#RT WHILE without #RT ENDWHILE; expected #RT ENDWHILE behind it"),
        }
    }
}

impl core::error::Error for LoopError {}
