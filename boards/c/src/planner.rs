//! The C functions for the task that plans: load a program, poll, continue after a refusal.
use crate::built::Planner;
use crate::message;
use crate::part::{Part, answer};
use crate::result::Outcome;
use crate::text::Program;
use crate::{AXES, WINDOW};
use core::ffi::c_char;
use core::slice;
use glidepath::channel::{self, Error, GoOnError, MoveError, PositionError, ZeroOffsetError};
use glidepath::nc::{NcWarning, Stream};
use glidepath::quantity::{Feed, Position};

/// The handle of the task that plans.
pub type PlannerHandle = Part<Work, 0x706c_616e>;

/// The memory of the planner's task.
pub struct Work {
    planner: Planner,
    /// The window, while the planner does not read it.
    stream: Option<Stream<'static, WINDOW>>,
    remark: Remark,
}

/// The message that `gp_message` returns.
enum Remark {
    None,
    Error(Error),
    Warning(NcWarning),
}

impl Work {
    /// Nothing is loaded.
    pub fn new(planner: Planner, stream: Stream<'static, WINDOW>) -> Self {
        Self { planner, stream: Some(stream), remark: Remark::None }
    }

    /// Another text; the window comes back.
    fn replace(
        &mut self,
        text: Program,
        load: impl FnOnce(&mut Planner, Program) -> Result<Program, channel::Busy<Program>>,
    ) -> Result<(), Outcome> {
        let (before, result) = match load(&mut self.planner, text) {
            Ok(before) => (before, Ok(())),
            Err(busy) => (busy.text, Err(Outcome::NotAtRest)),
        };
        if let Program::Window(stream) = before {
            self.stream = Some(stream);
        }
        result
    }
}

/// What one call of `gp_poll` achieved.
#[repr(u32)]
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// A bounded part of the work is done, and there is more work: call again.
    Working = 0,
    /// The queue is full, program text is missing, or the motion is in a hold: call again after some ticks.
    Waiting = 1,
    /// The planner has released a motion block: its speed profile is planned.
    Planned = 2,
    /// A block has a new speed profile, because an acknowledgement permits a higher end speed.
    Replanned = 3,
    /// The program has a questionable word, and planning continues. `gp_message` returns the warning.
    Warning = 4,
    /// Program text comes late: the axes stop at the end of the known path.
    Starved = 5,
    /// The planner got no processor time for so long that the axes stopped.
    Late = 6,
    /// The motion is slower than programmed, so that the stop fits into the queue.
    Slower = 7,
    /// The program has ended, and all motion is in the queue. Continue to call `gp_poll` while the axes
    /// move.
    Done = 8,
}

/// The word of the program that a message is about.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Place {
    /// Line, counted from 1; 0 if there is none.
    pub line: u32,
    /// Column in bytes, counted from 1.
    pub column: u32,
    /// Offset of the word in the text, bytes.
    pub offset: u32,
    /// Length of the word, bytes.
    pub length: u32,
    /// ISG's number of the message; 0 if ISG has none.
    pub id: u32,
}

/// Program text of a C program.
unsafe fn text(text: *const c_char, length: usize) -> Result<Program, Outcome> {
    if text.is_null() {
        return Err(Outcome::Null);
    }
    if length > i32::MAX as usize {
        return Err(Outcome::Range);
    }
    // SAFETY: it points to so many bytes, which stay as they are as long as the text is loaded.
    Ok(Program::Memory(unsafe { slice::from_raw_parts(text.cast(), length) }))
}

/// Loads a program of `length` bytes. The program begins at the position of the axes, with the modal
/// state of program start. The text must stay in memory until another text is loaded.
///
/// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, RANGE (more than 2^31 bytes),
/// NOT_AT_REST.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_load(
    planner: *mut PlannerHandle,
    program: *const c_char,
    length: usize,
) -> Outcome {
    // SAFETY: the pointers are null or point to what they say.
    unsafe {
        let program = match text(program, length) {
            Ok(program) => program,
            Err(outcome) => return outcome,
        };
        Part::with(planner, |work| work.replace(program, Planner::load)).into()
    }
}

/// Takes single lines (MDI): as `gp_load`, but the modal state of the last text stays active. After an
/// abort the modal state is that of program start.
///
/// Context: the planner's task. Returns the same as `gp_load`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_continue_with(
    planner: *mut PlannerHandle,
    lines: *const c_char,
    length: usize,
) -> Outcome {
    // SAFETY: the pointers are null or point to what they say.
    unsafe {
        let lines = match text(lines, length) {
            Ok(lines) => lines,
            Err(outcome) => return outcome,
        };
        Part::with(planner, |work| work.replace(lines, Planner::continue_with)).into()
    }
}

/// Loads the program that arrives by `gp_feed`. The program begins at the last call of
/// `gp_feed_restart`.
///
/// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, WINDOW_IS_LOADED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_load_window(planner: *mut PlannerHandle) -> Outcome {
    let load = |work: &mut Work| {
        let stream = work.stream.take().ok_or(Outcome::WindowIsLoaded)?;
        work.replace(Program::Window(stream), Planner::load)
    };
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::with(planner, load).into() }
}

/// Takes the next program of the same text, after a program end, a refused line or an abort.
///
/// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_load_next(planner: *mut PlannerHandle) -> Outcome {
    let next = |work: &mut Work| work.planner.load_next().map_err(|_| Outcome::NotAtRest);
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::with(planner, next).into() }
}

/// Continues after a refused line, from the position of the axes.
///
/// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, NOTHING_REFUSED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_go_on(planner: *mut PlannerHandle) -> Outcome {
    let go_on = |work: &mut Work| {
        work.planner.go_on().map_err(|error| match error {
            GoOnError::NotAtRest => Outcome::NotAtRest,
            GoOnError::NothingRefused => Outcome::NothingRefused,
        })
    };
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::with(planner, go_on).into() }
}

/// Does a bounded part of the work, and returns the result in `progress`. Call it in a loop until it
/// returns GP_PROGRESS_WAITING or GP_PROGRESS_DONE, then again after a tick.
///
/// Context: the planner's task; the tick must be able to interrupt this task, never the other way
/// round. Returns GP_RESULT_NULL, CLOSED, IN_USE, REFUSED: a line is left out, and `gp_message` returns
/// the reason. Continue to call: the earlier motion ends in a stop.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_poll(planner: *mut PlannerHandle, progress: *mut Progress) -> Outcome {
    if progress.is_null() {
        return Outcome::Null;
    }
    let poll = |work: &mut Work| {
        use channel::Progress as P;
        let achieved = match work.planner.poll() {
            Ok(P::Working | P::Deviated(_)) => Progress::Working,
            Ok(P::Waiting) => Progress::Waiting,
            Ok(P::Planned) => Progress::Planned,
            Ok(P::Replanned) => Progress::Replanned,
            Ok(P::Starved) => Progress::Starved,
            Ok(P::Late) => Progress::Late,
            Ok(P::Slower) => Progress::Slower,
            Ok(P::Done) => Progress::Done,
            Ok(P::Warning(warning)) => {
                work.remark = Remark::Warning(warning);
                Progress::Warning
            }
            Err(error) => {
                work.remark = Remark::Error(error);
                return Err(Outcome::Refused);
            }
        };
        // SAFETY: not null, and points to memory for one.
        unsafe { answer(progress, achieved) }
    };
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::with(planner, poll).into() }
}

/// Returns the last refusal or warning of `gp_poll`: its word, and a text of at most `size` bytes with
/// its NUL. Both pointers may be NULL.
///
/// Context: the planner's task; about 1 KB of stack. Returns GP_RESULT_NOTHING, NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_message(
    planner: *mut PlannerHandle,
    place: *mut Place,
    message: *mut c_char,
    size: usize,
) -> Outcome {
    let tell = |work: &mut Work| {
        let (word, id) = match &work.remark {
            Remark::None => return Err(Outcome::Nothing),
            Remark::Error(error) => {
                // SAFETY: the caller says how much there is.
                unsafe { message::write(message, size, error) };
                (error.place(), error.id())
            }
            Remark::Warning(warning) => {
                // SAFETY: the caller says how much there is.
                unsafe { message::write(message, size, warning) };
                (warning.place, 0)
            }
        };
        if !place.is_null() {
            let (line, column, offset, length) = (word.line, word.column, word.offset, word.length.into());
            // SAFETY: not null, and points to memory for one.
            unsafe { place.write(Place { line, column, offset, length, id }) };
        }
        Ok(())
    };
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::with(planner, tell).into() }
}

/// Whether the axes stand still and all lines read so far are executed: 1, else 0. Only then the
/// planner accepts programs, positions and offsets.
///
/// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_is_at_rest(planner: *mut PlannerHandle, is_at_rest: *mut u32) -> Outcome {
    // SAFETY: the pointers are null or point to what they say.
    unsafe { Part::with(planner, |work| answer(is_at_rest, work.planner.is_at_rest().into())).into() }
}

/// Sets the machine coordinate of an axis to `position`, LSB 2^-32 mm or degrees, without motion. The
/// set point changes to this value with the next tick.
///
/// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, RANGE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_set_position(planner: *mut PlannerHandle, axis: u32, position: i64) -> Outcome {
    let set = |work: &mut Work| {
        let set = work.planner.set_position(axis as usize, Position::from_bits(position));
        set.map_err(|error| match error {
            PositionError::NotAtRest => Outcome::NotAtRest,
            PositionError::Range => Outcome::Range,
        })
    };
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::with(planner, set).into() }
}

/// Sets the offset of an axis in zero offset `set`, 0…5 for G54…G59, LSB 2^-32 mm or degrees. The
/// offset acts from the next line on.
///
/// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, RANGE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_set_zero_offset(
    planner: *mut PlannerHandle,
    set: u32,
    axis: u32,
    offset: i64,
) -> Outcome {
    let put = |work: &mut Work| {
        let offset = Position::from_bits(offset);
        work.planner.set_zero_offset(set as usize, axis as usize, offset).map_err(|error| match error {
            ZeroOffsetError::NotAtRest => Outcome::NotAtRest,
            ZeroOffsetError::Range => Outcome::Range,
        })
    };
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::with(planner, put).into() }
}

/// Moves a single axis for a jog or for homing, at standstill of the path. `target` is a machine
/// coordinate, LSB 2^-32 mm or degrees. `feed` has LSB 2^-32 mm/min or degrees/min; 0: speed of rapid
/// motion. The program must have ended: GP_PROGRESS_DONE. `gp_poll` carries out the motion, and returns
/// GP_PROGRESS_WAITING until the axis stands still. Hold, override and abort act on the motion.
///
/// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST (also: this axis
/// moves), RANGE, LIMIT, FULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_move_axis(
    planner: *mut PlannerHandle,
    axis: u32,
    target: i64,
    feed: i64,
) -> Outcome {
    let go = |work: &mut Work| {
        let feed = (feed != 0).then_some(Feed::from_bits(feed));
        let go = work.planner.move_axis(axis as usize, Position::from_bits(target), feed);
        go.map_err(|error| match error {
            MoveError::NotAtRest => Outcome::NotAtRest,
            MoveError::Range => Outcome::Range,
            MoveError::Motion(_) => Outcome::Limit,
            MoveError::Full => Outcome::Full,
        })
    };
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::with(planner, go).into() }
}

/// Stops the axis that `gp_move_axis` moves. The axis stays at the position of its standstill. The call
/// has no effect if the axis does not move.
///
/// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, RANGE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_stop_axis(planner: *mut PlannerHandle, axis: u32) -> Outcome {
    if axis as usize >= AXES {
        return Outcome::Range;
    }
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(planner, |work| work.planner.stop_axis(axis as usize)) }
}

/// Returns the number of ticks after which `gp_poll` should be called again, after GP_PROGRESS_WAITING.
/// A task may sleep for this time. 0: the axes stand still, and only a command, an acknowledgement or
/// text continues the motion. The sender of these must wake the task.
///
/// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_wakes_after(planner: *mut PlannerHandle, ticks: *mut u32) -> Outcome {
    // SAFETY: the pointers are null or point to what they say.
    unsafe { Part::with(planner, |work| answer(ticks, work.planner.wakes_after().unwrap_or(0))).into() }
}
