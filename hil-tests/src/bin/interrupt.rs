//! The interpolator in a real timer interrupt that preempts the planner: digests as in the plain loop, no
//! tick missed.
#![no_std]
#![no_main]
use core::cell::Cell;
use core::fmt::Write;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use cortex_m_rt::{entry, exception};
use critical_section::Mutex;
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::digest::Digest;
use glidepath::quantity::Position;
use glidepath::tick::{Interpolator, State};
use hil_cases::{AXES_3, BLOCKS, CASES_3, Case};
use hil_tests::{Report, exit, report_memory};
use panic_semihosting as _;
use static_cell::ConstStaticCell;

/// Core clock: what QEMU's machine has, or a board after reset.
const CLOCK_HZ: u32 = if cfg!(feature = "hardware") { 16_000_000 } else { 168_000_000 };

type Memory = ConstStaticCell<Channel<3, BLOCKS>>;

/// Case and time between two interrupts. Ticks are the program's time, so that a shorter one changes no set
/// point: it preempts the planner more often. A thousand blocks of a few micrometres a second, with as many
/// instructions for a tick as 168 MHz has in 1 ms.
const RUNS: [(&str, u32); 4] =
    [("subroutine", 1000), ("short_blocks", 200), ("micro", MICRO_US), ("corners", 1000)];

/// The emulator executes an instruction in 1 ns.
const MICRO_US: u32 = if cfg!(feature = "hardware") { 1000 } else { 168 };

static CHANNEL: Memory = ConstStaticCell::new(Channel::new());

/// What the interrupt owns while a program runs.
struct Motion {
    interpolator: Interpolator<'static, 3>,
    digest: Digest,
    moved: bool,
    ticks: u32,
    starved: u32,
}

static TO_INTERRUPT: Mutex<Cell<Option<Motion>>> = Mutex::new(Cell::new(None));
static TO_MAIN: Mutex<Cell<Option<Motion>>> = Mutex::new(Cell::new(None));
static PLANNED: AtomicBool = AtomicBool::new(false);
static MISSED: AtomicU32 = AtomicU32::new(0);
static PREEMPTED: AtomicU32 = AtomicU32::new(0);
static PLANNING: AtomicBool = AtomicBool::new(false);

#[exception]
fn SysTick() {
    static mut MOTION: Option<Motion> = None;
    if MOTION.is_none() {
        *MOTION = critical_section::with(|cs| TO_INTERRUPT.borrow(cs).take());
    }
    if PLANNING.load(Relaxed) {
        PREEMPTED.store(PREEMPTED.load(Relaxed) + 1, Relaxed);
    }
    let Some(motion) = MOTION else { return };
    if motion.moved {
        motion.digest.add(motion.interpolator.set_points());
        motion.ticks += 1;
    }
    let planned = PLANNED.load(Relaxed);
    motion.moved = motion.interpolator.tick() == State::Active;
    if !motion.moved && planned {
        critical_section::with(|cs| TO_MAIN.borrow(cs).set(MOTION.take()));
    } else if !motion.moved && motion.ticks > 0 {
        motion.starved += 1;
    }
    if SCB::is_pendst_pending() {
        MISSED.store(MISSED.load(Relaxed) + 1, Relaxed);
    }
}

/// Runs `case` with one interrupt every `period_us`; whether no tick was missed. If so, nothing of the
/// channel is in use any more.
fn motion(
    channel: &'static mut Channel<3, BLOCKS>,
    case: &Case,
    systick: &mut SYST,
    period_us: u32,
    report: &mut Report,
) -> bool {
    let Handles { mut planner, interpolator, .. } =
        match channel.split(&AXES_3, [Position::ZERO; 3], case.text) {
            Ok(handles) => handles,
            Err(error) => {
                let _ = writeln!(report, "failed {error:?}");
                return false;
            }
        };
    let motion = Motion { interpolator, digest: Digest::new(), moved: false, ticks: 0, starved: 0 };
    critical_section::with(|cs| TO_INTERRUPT.borrow(cs).set(Some(motion)));
    for counter in [&MISSED, &PREEMPTED] {
        counter.store(0, Relaxed);
    }
    PLANNED.store(false, Relaxed);
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(CLOCK_HZ / 1_000_000 * period_us - 1);
    systick.clear_current();
    systick.enable_interrupt();
    systick.enable_counter();
    loop {
        PLANNING.store(true, Relaxed);
        let progress = planner.poll();
        PLANNING.store(false, Relaxed);
        match progress {
            Ok(Progress::Waiting) => cortex_m::asm::wfi(),
            Ok(Progress::Done) => break,
            Ok(_) => {}
            Err(error) => {
                let _ = writeln!(report, "failed {error:?}");
                return false;
            }
        }
    }
    PLANNED.store(true, Relaxed);
    let motion = loop {
        if let Some(motion) = critical_section::with(|cs| TO_MAIN.borrow(cs).take()) {
            break motion;
        }
        cortex_m::asm::wfi();
    };
    systick.disable_counter();
    systick.disable_interrupt();
    let (missed, preempted) = (MISSED.load(Relaxed), PREEMPTED.load(Relaxed));
    let _ = writeln!(
        report,
        "interrupt {} period_us {period_us} ticks {} starved {} missed {missed} preempted {preempted} digest {:016x}",
        case.name,
        motion.ticks,
        motion.starved,
        motion.digest.value()
    );
    missed == 0
}

#[entry]
fn main() -> ! {
    let Some(mut core) = cortex_m::Peripherals::take() else { exit(false) };
    let mut report = Report::open();
    let memory: *mut Channel<3, BLOCKS> = CHANNEL.take();
    let good = RUNS.iter().all(|(name, period_us)| {
        // SAFETY: taken once. The run before was good, or this one would not begin: the interrupt gave its
        // half back, and both halves are dropped.
        let channel = unsafe { &mut *memory };
        let case = CASES_3.iter().find(|case| case.name == *name);
        case.is_some_and(|case| motion(channel, case, &mut core.SYST, *period_us, &mut report))
    });
    report_memory::<3, BLOCKS>(&mut report);
    report.flush();
    exit(good)
}
