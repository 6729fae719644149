//! The results of the C functions.

/// The result of a call. After every result except `GP_RESULT_OK` and `GP_RESULT_NOTHING`, the call had
/// no effect.
#[repr(u32)]
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Done.
    Ok = 0,
    /// There is nothing to return.
    Nothing = 1,
    /// A pointer is NULL.
    Null = 2,
    /// The size of the storage is not `GP_STORAGE_BYTES`: header and library have different versions.
    Size = 3,
    /// The storage is not aligned to `GP_STORAGE_ALIGNMENT`.
    Alignment = 4,
    /// The storage is already open: call `gp_close` first.
    Twice = 5,
    /// The storage is not open, or closed again, or the pointer is that of another handle.
    Closed = 6,
    /// Another context is inside a call with the same handle.
    InUse = 7,
    /// A parameter of the machine data is out of its range: `gp_check` names the parameter.
    MachineData = 8,
    /// A line of the program is refused: `gp_message` returns the reason.
    Refused = 9,
    /// The call is possible only at standstill, when all blocks read so far are executed.
    NotAtRest = 10,
    /// No line was refused, so the call has no line to continue after.
    NothingRefused = 11,
    /// An argument is out of its range: an axis, a position, a length, the kind of a function.
    Range = 12,
    /// No function waits for this acknowledgement.
    Unexpected = 13,
    /// The planner already reads the window: `gp_load_next` takes the following program.
    WindowIsLoaded = 14,
    /// The axis would exceed its software limit, or its motion takes too long.
    Limit = 15,
    /// All overlays are in use, or the build has none: GP_OVERLAYS.
    Full = 16,
}

impl From<Result<(), Outcome>> for Outcome {
    fn from(result: Result<(), Outcome>) -> Self {
        result.err().unwrap_or(Self::Ok)
    }
}

/// The name of a result, for messages: a text in the library that ends with a NUL.
///
/// Context: any.
#[unsafe(no_mangle)]
pub extern "C" fn gp_result_name(result: u32) -> *const core::ffi::c_char {
    const NAMES: [&core::ffi::CStr; 17] = [
        c"ok",
        c"nothing",
        c"a pointer is NULL",
        c"the size of the storage does not belong to this library",
        c"the storage is not aligned",
        c"the storage is open already",
        c"the handle is not open",
        c"another context uses the handle",
        c"machine data out of range",
        c"a line of the program is refused",
        c"taken at rest alone",
        c"no line was refused",
        c"an argument is out of range",
        c"nothing waits for this acknowledgement",
        c"the window is loaded already",
        c"beyond a software limit, or takes too long",
        c"no overlay is free",
    ];
    NAMES.get(result as usize).copied().unwrap_or(c"no such result").as_ptr()
}
