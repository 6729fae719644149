//! The handle of whoever gives commands and carries functions out.
use crate::AXES;
use crate::interpolator::State;
use crate::part::{Part, answer};
use crate::result::Outcome;
use glidepath::operator;
use glidepath::quantity::Position;
use glidepath::technology::Function;

/// The handle of whoever gives commands and carries functions out.
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
    /// What to do.
    pub function: FunctionData,
    /// Number of the tick that reached the point: ticks since `gp_open`, from 0, modulo 2^31.
    pub tick: u32,
    /// Programmed N number.
    pub n: u32,
    /// 1: the motion goes on, at its synchronisation point, only after `gp_acknowledge`.
    pub waits: u32,
}

/// What the last tick did. All of it belongs to one tick.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Status {
    /// The set point of every axis, LSB 2^-32 mm or degrees.
    pub set_points: [i64; AXES],
    /// Path speed, mm per tick, LSB 2^-58.
    pub speed: i64,
    /// Programmed N number.
    pub n: u32,
    /// Motion blocks since `gp_open`, from 0.
    pub block: u32,
    /// Ticks since `gp_open`, modulo 2^31.
    pub ticks: u32,
    /// Pieces of time in the queue, 0…256: those the planner is ahead by.
    pub queued: u32,
    /// What the tick did.
    pub state: State,
}

/// Feed override, LSB 0.1 %, 0…2000; more counts as 2000. 0 makes the motion stand on the path.
///
/// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_set_override(op: *mut OperatorHandle, feed: u16) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(op, |operator| operator.set_override(feed)) }
}

/// Reduced speed (P-AXIS-00214): 0 off, everything else on.
///
/// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_set_reduced(op: *mut OperatorHandle, reduced: u32) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(op, |operator| operator.set_reduced(reduced != 0)) }
}

/// Feed hold: stand still on the path as soon as the limits allow.
///
/// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_feed_hold(op: *mut OperatorHandle) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(op, |operator| operator.feed_hold()) }
}

/// End of the feed hold.
///
/// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_resume(op: *mut OperatorHandle) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(op, |operator| operator.resume()) }
}

/// Stand still and forget the rest of the program.
///
/// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_abort(op: *mut OperatorHandle) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(op, |operator| operator.abort()) }
}

/// The next function whose point of the motion a tick has reached. Call it until it answers GP_RESULT_NOTHING: without room
/// for more functions the motion comes to a standstill.
///
/// Context: any, one at a time; never waits. Answers GP_RESULT_NOTHING, NULL, CLOSED, IN_USE.
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

/// Acknowledges a function that `gp_output` gave with `waits`. If it was put out more than once, that put out first.
///
/// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE, RANGE (no such kind, or number of an M or H
/// function above 65535), UNEXPECTED (nothing waits for it: it is ignored).
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

/// What the last tick did.
///
/// Context: any, one at a time; reads again if a tick comes in between. Answers GP_RESULT_NULL, CLOSED, IN_USE.
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
