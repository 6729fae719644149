//! The interpolator in a real timer interrupt that preempts the planner: digests as in the plain loop, no
//! tick missed. Then with something that takes the core from the planner for many ticks at a time, wherever it
//! is in its calls: the interrupt goes on with the way to a standstill. No axis accelerates more than it may, and
//! all ends where it should.
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
use glidepath::machine::AxisData;
use glidepath::quantity::Position;
use glidepath::tick::{Interpolator, State};
use hil_cases::{AXES_3, BLOCKS, CASES_3, Case};
use hil_tests::{Report, exit, report_memory};
use panic_semihosting as _;
use static_cell::ConstStaticCell;

/// Core clock: what QEMU's machine has, or a board after reset.
const CLOCK_HZ: u32 = if cfg!(feature = "hardware") { 16_000_000 } else { 168_000_000 };

type Memory = ConstStaticCell<Channel<3, BLOCKS>>;

/// Case and cycles of the core between two interrupts. Ticks are the program's time, so that a shorter one changes
/// no set point: it preempts the planner more often. A thousand blocks of a few micrometres a second, with as many
/// instructions for a tick as 168 MHz has in 1 ms.
const RUNS: [(&str, u32); 4] =
    [("subroutine", 1000 * US), ("short_blocks", 200 * US), ("micro", MICRO_US * US), ("corners", 1000 * US)];

const US: u32 = CLOCK_HZ / 1_000_000;

/// Programs whose planner is late then: short lines, curves of corners and of splines, exact stops.
const LATE: [&str; 5] = ["short_blocks", "micro", "corners", "cam_dev", "splines"];

/// Cycles between two interrupts then: 950 to 2,070 instructions, of which a tick takes up to half. Steps so
/// that each run meets the planner elsewhere.
const SHORTEST: u32 = 160;
const STEP: u32 = 17;
const PERIODS: u32 = if cfg!(feature = "hardware") { 0 } else { 12 };

/// Interrupts from one time that the planner has no core to the next, and ticks of it: more than the queue has.
const OFTEN: u32 = 60;
const TAKEN: u32 = 400;

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
    judge: Judge,
    interrupts: u32,
    /// The planner loses the core at times.
    is_late: bool,
}

/// The largest second difference of the set points of every axis, one behind the other, LSB 2^-32 mm.
#[derive(Default)]
struct Judge {
    last: [[i64; 3]; 2],
    worst: [u64; 3],
    seen: u32,
}

impl Judge {
    fn see(&mut self, set_points: &[Position; 3]) {
        let [before, last] = self.last;
        let now = set_points.map(Position::to_bits);
        for k in 0..3 {
            let bend = now[k] - 2 * last[k] + before[k];
            if self.seen >= 2 {
                self.worst[k] = self.worst[k].max(bend.unsigned_abs());
            }
        }
        (self.last, self.seen) = ([last, now], self.seen + 1);
    }

    /// Whether no axis accelerated more than it may. A set point is rounded by half an LSB, a second difference
    /// by two.
    fn is_good(&self) -> bool {
        self.worst.iter().zip(&AXES_3.axes).all(|(worst, axis)| *worst <= permitted(axis) + 2)
    }
}

/// The most that an axis may accelerate in curves, at feed and in rapid motion, 2^-32 mm per tick squared.
fn permitted(axis: &AxisData) -> u64 {
    let stages = axis.stages(false);
    let most = [axis.a_max, axis.a_beschl, axis.a_brems, axis.a_grenz].into_iter();
    let most = most.chain(stages.a).chain(stages.d).max().unwrap_or(0);
    let cycle = u128::from(AXES_3.channel.cycle_us);
    ((u128::from(most) * cycle * cycle) << 32).div_ceil(1_000_000_000_000) as u64
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
    motion.interrupts += 1;
    let takes = motion.is_late && motion.interrupts.is_multiple_of(OFTEN);
    for _ in 0..if takes { TAKEN } else { 1 } {
        motion.judge.see(motion.interpolator.set_points());
        if motion.moved {
            motion.digest.add(motion.interpolator.set_points());
            motion.ticks += 1;
        }
        let planned = PLANNED.load(Relaxed);
        motion.moved = motion.interpolator.tick() == State::Active;
        if !motion.moved && planned {
            critical_section::with(|cs| TO_MAIN.borrow(cs).set(MOTION.take()));
            return;
        } else if !motion.moved && motion.ticks > 0 {
            motion.starved += 1;
        }
    }
    if SCB::is_pendst_pending() && !motion.is_late {
        MISSED.store(MISSED.load(Relaxed) + 1, Relaxed);
    }
}

/// Runs `case` with one interrupt every so many cycles; whether no tick was missed and no axis accelerated too much.
/// If so, nothing of the channel is in use any more.
fn motion(
    channel: &'static mut Channel<3, BLOCKS>,
    case: &Case,
    systick: &mut SYST,
    (kind, cycles): (&str, u32),
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
    let judge = Judge::default();
    let (ticks, starved, interrupts, is_late) = (0, 0, 0, kind == "late");
    let digest = Digest::new();
    let motion = Motion { interpolator, digest, moved: false, ticks, starved, judge, interrupts, is_late };
    critical_section::with(|cs| TO_INTERRUPT.borrow(cs).set(Some(motion)));
    for counter in [&MISSED, &PREEMPTED] {
        counter.store(0, Relaxed);
    }
    PLANNED.store(false, Relaxed);
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(cycles - 1);
    systick.clear_current();
    systick.enable_interrupt();
    systick.enable_counter();
    let mut late = 0;
    loop {
        PLANNING.store(true, Relaxed);
        let progress = planner.poll();
        PLANNING.store(false, Relaxed);
        match progress {
            Ok(Progress::Late) => late += 1,
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
    let end = motion.interpolator.set_points().map(Position::to_bits);
    let (missed, preempted) = (MISSED.load(Relaxed), PREEMPTED.load(Relaxed));
    let _ = writeln!(
        report,
        "{kind} {} cycles {cycles} ticks {} starved {} missed {missed} preempted {preempted} late {late} end_x {} end_y {} end_z {} digest {:016x}",
        case.name,
        motion.ticks,
        motion.starved,
        end[0] as u64,
        end[1] as u64,
        end[2] as u64,
        motion.digest.value()
    );
    if !motion.judge.is_good() {
        let _ = writeln!(report, "failed {:?} is more than an axis may accelerate", motion.judge.worst);
    }
    missed == 0 && motion.judge.is_good()
}

#[entry]
fn main() -> ! {
    let Some(mut core) = cortex_m::Peripherals::take() else { exit(false) };
    let mut report = Report::open();
    let memory: *mut Channel<3, BLOCKS> = CHANNEL.take();
    let mut run = |kind: &str, name: &str, cycles: u32| {
        // SAFETY: taken once. The run before was good, or this one would not begin: the interrupt gave its
        // half back, and both halves are dropped.
        let channel = unsafe { &mut *memory };
        let case = CASES_3.iter().find(|case| case.name == name);
        case.is_some_and(|case| motion(channel, case, &mut core.SYST, (kind, cycles), &mut report))
    };
    let good = RUNS.iter().all(|(name, cycles)| run("interrupt", name, *cycles))
        && (0..PERIODS).all(|k| LATE.iter().all(|name| run("late", name, SHORTEST + STEP * k)));
    report_memory::<3, BLOCKS>(&mut report);
    report.flush();
    exit(good)
}
