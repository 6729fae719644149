//! The C functions for the context that gives commands and carries out M and H functions.
use crate::AXES;
use crate::interpolator::State;
use crate::part::{Part, answer};
use crate::result::Outcome;
use glidepath::operator;
use glidepath::quantity::Position;
use glidepath::technology::Function;

/// The handle of the context that gives commands and carries out functions.
pub type OperatorHandle = Part<operator::Operator<'static, AXES>, 0x6f70_6572>;

/// An M function.
pub const M_FUNCTION: u32 = 0;
/// An H function.
pub const H_FUNCTION: u32 = 1;
/// S: spindle speed.
pub const SPINDLE_SPEED: u32 = 2;
/// T: tool number.
pub const TOOL: u32 = 3;

/// A function of the program.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct FunctionData {
    /// GP_M_FUNCTION, GP_H_FUNCTION, GP_SPINDLE_SPEED or GP_TOOL.
    pub kind: u32,
    /// Number of an M or H function, or of a tool.
    pub number: u32,
    /// Spindle speed, 1/min, LSB 2^-32; else 0.
    pub speed: i64,
}

/// A function whose point the motion has reached.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Output {
    /// The function.
    pub function: FunctionData,
    /// Number of the tick that reached the function's point: ticks since `gp_open`, from 0, modulo 2^31.
    pub tick: u32,
    /// Programmed N number.
    pub n: u32,
    /// 1 if the motion waits at the synchronisation point for `gp_acknowledge`.
    pub waits: u32,
}

/// The state after the last tick. All fields belong to the same tick.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Status {
    /// The set point of every axis, LSB 2^-32 mm or degrees.
    pub set_points: [i64; AXES],
    /// Path speed, mm per tick, LSB 2^-58.
    pub speed: i64,
    /// Programmed N number.
    pub n: u32,
    /// Number of motion blocks since `gp_open`, from 0.
    pub block: u32,
    /// Number of ticks since `gp_open`, modulo 2^31.
    pub ticks: u32,
    /// Number of pieces in the queue between planner and interrupt, 0…256.
    pub queued: u32,
    /// The state after the tick.
    pub state: State,
}

/// Sets the feed override, LSB 0.1 %, 0…2000; a higher value counts as 2000. With 0 the axes stop on
/// the path.
///
/// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_set_override(op: *mut OperatorHandle, feed: u16) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(op, |operator| operator.set_override(feed)) }
}

/// Sets the reduced speed (P-AXIS-00214): 0 off, any other value on.
///
/// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_set_reduced(op: *mut OperatorHandle, reduced: u32) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(op, |operator| operator.set_reduced(reduced != 0)) }
}

/// Feed hold: the axes stop on the path as soon as the limits permit.
///
/// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_feed_hold(op: *mut OperatorHandle) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(op, |operator| operator.feed_hold()) }
}

/// Ends the feed hold.
///
/// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_resume(op: *mut OperatorHandle) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(op, |operator| operator.resume()) }
}

/// Stops the axes and drops the rest of the program.
///
/// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_abort(op: *mut OperatorHandle) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(op, |operator| operator.abort()) }
}

/// Returns the next function whose point of the path a tick has reached. Call it until it returns
/// GP_RESULT_NOTHING: without room for more functions the axes stop.
///
/// Context: any, one call at a time; never waits. Returns GP_RESULT_NOTHING, NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_output(op: *mut OperatorHandle, output: *mut Output) -> Outcome {
    if output.is_null() {
        return Outcome::Null;
    }
    let take = |operator: &mut operator::Operator<'static, AXES>| {
        let due = operator.output().ok_or(Outcome::Nothing)?;
        let (kind, number, speed) = match due.function {
            Function::M(code) => (M_FUNCTION, code.into(), 0),
            Function::H(code) => (H_FUNCTION, code.into(), 0),
            Function::Spindle(speed) => (SPINDLE_SPEED, 0, speed.to_bits()),
            Function::Tool(number) => (TOOL, number, 0),
        };
        let function = FunctionData { kind, number, speed };
        // SAFETY: not null, and points to an output.
        unsafe { answer(output, Output { function, tick: due.tick, n: due.n, waits: due.waits.into() }) }
    };
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::with(op, take).into() }
}

/// Acknowledges a function that `gp_output` returned with `waits`. If the function was output more than
/// once, the first output is acknowledged.
///
/// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE, RANGE (no
/// such kind, or number of an M or H function above 65535), UNEXPECTED (no such function waits; the
/// call has no effect).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_acknowledge(op: *mut OperatorHandle, function: *const FunctionData) -> Outcome {
    // SAFETY: the pointer is null or points to a function.
    let Some(data) = (unsafe { function.as_ref() }) else { return Outcome::Null };
    let code = u16::try_from(data.number);
    let function = match (data.kind, code) {
        (M_FUNCTION, Ok(code)) => Function::M(code),
        (H_FUNCTION, Ok(code)) => Function::H(code),
        (SPINDLE_SPEED, _) => Function::Spindle(Position::from_bits(data.speed)),
        (TOOL, _) => Function::Tool(data.number),
        _ => return Outcome::Range,
    };
    // SAFETY: the pointer is null or one of the handles.
    unsafe {
        Part::with(op, |operator| operator.acknowledge(function).map_err(|_| Outcome::Unexpected)).into()
    }
}

/// Returns the state after the last tick.
///
/// Context: any, one call at a time; if a tick comes in between, the function reads again. Returns
/// GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_status(op: *mut OperatorHandle, status: *mut Status) -> Outcome {
    let read = |operator: &mut operator::Operator<'static, AXES>| {
        let seen = operator.status();
        let now = Status {
            set_points: seen.set_points.map(Position::to_bits),
            speed: seen.speed.to_bits(),
            n: seen.n,
            block: seen.block,
            ticks: seen.ticks,
            queued: seen.queued.into(),
            state: seen.state.into(),
        };
        // SAFETY: null, or points to a status.
        unsafe { answer(status, now) }
    };
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::with(op, read).into() }
}
