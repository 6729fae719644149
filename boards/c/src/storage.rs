//! The memory of the library in a C program: opens and closes this memory.
use crate::built::{self, Channel, FilterMemory};
use crate::feeder::FeederHandle;
use crate::interpolator::InterpolatorHandle;
use crate::machine::Machine;
use crate::operator::OperatorHandle;
use crate::part::{Part, answer};
use crate::planner::{PlannerHandle, Work};
use crate::result::Outcome;
use crate::{AXES, WINDOW};
use core::mem::{align_of, size_of};
use core::sync::atomic::{AtomicU32, Ordering};
use glidepath::channel::Handles;
use glidepath::machine::MachineData;
use glidepath::nc::Window;
use glidepath::quantity::Position;

/// Size of the storage, in words of eight bytes; the size is also enough with pointers of 64 bits.
pub const STORAGE_WORDS: usize = 10_880;

/// Size of the storage in bytes.
pub const STORAGE_BYTES: usize = STORAGE_WORDS * 8;

/// Alignment of the storage in bytes.
pub const STORAGE_ALIGNMENT: usize = 8;

/// All memory: `static gp_storage storage;`, zero at the start as all static memory. The storage must
/// not move while it is open.
#[repr(C)]
pub struct Storage {
    /// Private memory.
    pub words: [u64; STORAGE_WORDS],
}

/// The handles. Each handle belongs to one context.
#[repr(C)]
pub struct HandleSet {
    /// For a task of low priority, or the main loop.
    pub planner: *mut PlannerHandle,
    /// For the timer interrupt, whose priority is above that of the planner's task.
    pub interpolator: *mut InterpolatorHandle,
    /// For the context that gives commands and carries out functions: one context at a time.
    pub op: *mut OperatorHandle,
    /// For the context that receives program text: one context at a time.
    pub feeder: *mut FeederHandle,
}

/// The content of the storage.
struct Memory {
    state: AtomicU32,
    machine: MachineData<AXES>,
    channel: Channel,
    filters: FilterMemory,
    window: Window<WINDOW>,
    planner: PlannerHandle,
    interpolator: InterpolatorHandle,
    operator: OperatorHandle,
    feeder: FeederHandle,
}

const OPEN: u32 = 0x6769_6c64;

// If one of them fails: the storage has another size now. Change STORAGE_WORDS and run `cargo xtask header`.
const _: () = assert!(size_of::<Memory>() <= STORAGE_BYTES, "the storage is too small: raise STORAGE_WORDS");
// A build with fewer functions may need less.
const _: () = assert!(
    STORAGE_BYTES <= size_of::<Memory>() + 4096 || !cfg!(feature = "full"),
    "the storage is larger than needed"
);
const _: () =
    assert!(align_of::<Memory>() <= STORAGE_ALIGNMENT && align_of::<Storage>() <= STORAGE_ALIGNMENT);

/// Checks the storage that a C program passes.
unsafe fn memory(storage: *mut Storage, size: usize) -> Result<*mut Memory, Outcome> {
    if storage.is_null() {
        return Err(Outcome::Null);
    }
    if size != STORAGE_BYTES {
        return Err(Outcome::Size);
    }
    if !storage.addr().is_multiple_of(STORAGE_ALIGNMENT) {
        return Err(Outcome::Alignment);
    }
    Ok(storage.cast())
}

/// Opens the storage: checks and copies the machine data, sets the positions of the axes, and returns
/// the handles. `size` is `sizeof storage`; `start` has GP_AXES positions, LSB 2^-32 mm or degrees. No
/// program is loaded yet.
///
/// Context: any task, before the timer interrupt is on. Returns GP_RESULT_NULL, SIZE, ALIGNMENT, TWICE,
/// MACHINE_DATA (`gp_check` names the parameter), RANGE (a position beyond ±100 000 mm or degrees).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_open(
    storage: *mut Storage,
    size: usize,
    machine: *const Machine,
    start: *const i64,
    handles: *mut HandleSet,
) -> Outcome {
    // SAFETY: pointers are null or point to what they say.
    unsafe { open(storage, size, machine, start, handles) }.into()
}

unsafe fn open(
    storage: *mut Storage,
    size: usize,
    machine: *const Machine,
    start: *const i64,
    handles: *mut HandleSet,
) -> Result<(), Outcome> {
    // SAFETY: the pointers are null or point to what they say.
    let (memory, machine) = unsafe { (memory(storage, size)?, machine.as_ref().ok_or(Outcome::Null)?) };
    if start.is_null() || handles.is_null() {
        return Err(Outcome::Null);
    }
    // SAFETY: the memory is there, and its bits are zero or what an earlier call has left.
    if unsafe { (*memory).state.load(Ordering::Acquire) } == OPEN {
        return Err(Outcome::Twice);
    }
    // SAFETY: there are as many positions as axes.
    let start = unsafe { start.cast::<[i64; AXES]>().read() }.map(Position::from_bits);
    if start.iter().any(|position| *position > FARTHEST || *position < -FARTHEST) {
        return Err(Outcome::Range);
    }
    let data = machine.read().map_err(|_| Outcome::MachineData)?;
    built::check(&data).map_err(|_| Outcome::MachineData)?;
    // SAFETY: the storage is not open, so no other code uses its memory. A new channel and a new window are
    // zero. The memory must not move, so references into it are valid until the storage is closed, and no
    // handle works afterwards.
    unsafe {
        memory.write_bytes(0, 1);
        (&raw mut (*memory).machine).write(data);
        let (window, channel) = (&mut (*memory).window, &mut (*memory).channel);
        let (feeder, stream) = window.split();
        let split = built::split(channel, &mut (*memory).filters, &(*memory).machine, start);
        let Handles { planner, interpolator, operator } = split.map_err(|_| Outcome::MachineData)?;
        let set = HandleSet {
            planner: &raw mut (*memory).planner,
            interpolator: &raw mut (*memory).interpolator,
            op: &raw mut (*memory).operator,
            feeder: &raw mut (*memory).feeder,
        };
        Part::open(set.planner, Work::new(planner, stream));
        Part::open(set.interpolator, interpolator);
        Part::open(set.op, operator);
        Part::open(set.feeder, feeder);
        (*memory).state.store(OPEN, Ordering::Release);
        answer(handles, set)
    }
}

/// The limit of all coordinates.
const FARTHEST: Position = Position::const_from_int(100_000);

/// Closes the storage: later calls with its handles are refused. The storage may be opened again, for
/// another machine.
///
/// Context: any task, when no other context uses a handle any more: first switch the timer interrupt
/// off. Returns GP_RESULT_NULL, SIZE, ALIGNMENT, CLOSED, IN_USE (this context interrupts a call).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_close(storage: *mut Storage, size: usize) -> Outcome {
    // SAFETY: the pointer is null or points to a storage.
    let memory = match unsafe { memory(storage, size) } {
        Ok(memory) => memory,
        Err(outcome) => return outcome,
    };
    // SAFETY: the memory is there; if it is open, the handles are.
    unsafe {
        if (*memory).state.load(Ordering::Acquire) != OPEN {
            return Outcome::Closed;
        }
        let is_in_use = (*memory).planner.is_in_use()
            || (*memory).interpolator.is_in_use()
            || (*memory).operator.is_in_use()
            || (*memory).feeder.is_in_use();
        if is_in_use {
            return Outcome::InUse;
        }
        (*memory).state.store(0, Ordering::Release);
        Part::close(&raw mut (*memory).planner);
        Part::close(&raw mut (*memory).interpolator);
        Part::close(&raw mut (*memory).operator);
        Part::close(&raw mut (*memory).feeder);
    }
    Outcome::Ok
}
