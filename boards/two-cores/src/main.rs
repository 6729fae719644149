//! Glidepath on two cores of a Cortex-M33, in QEMU's `mps2-an521`.
//!
//! | core | holds | work |
//! |---|---|---|
//! | 0 | planner, feeder of the text window | receives program text and plans ahead |
//! | 1, interrupt | interpolator | one set point per axis and cycle |
//! | 1, main loop | operator | functions, feed hold and override |
#![no_std]
#![no_main]

mod line;
#[path = "../../tasks/machine.rs"]
mod machine;
mod second;

use core::fmt::Write;
use core::sync::atomic::{AtomicBool, AtomicPtr, AtomicU32, Ordering::*};
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_rt::{entry, exception};
use cortex_m_semihosting::{debug, hio};
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::digest::Digest;
use glidepath::nc::{Feeder, Window};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::technology::Function;
use glidepath::tick::{Interpolator, State};
use glidepath_copy as _;
use glidepath_softfloat as _;
use line::Line;
use machine::{AXES, BLOCKS, MACHINE};
use panic_semihosting as _;
use static_cell::{ConstStaticCell, StaticCell};

/// Bytes in the buffer for received program text. The sender puts END_OF_PART after each part, which has at
/// most half of these bytes, and sends the next part when the program reports its progress.
const WINDOW: usize = 512;
const PART: usize = WINDOW / 2;
const END_OF_PART: u8 = 3;

/// Clock of the cores, MHz.
const MHZ: u32 = 20;

/// Cycles until M26 is acknowledged, and length of the feed hold in cycles.
const CARRIED_OUT: u32 = 50;
const HELD: u32 = 100;

static CHANNEL: ConstStaticCell<Channel<AXES, BLOCKS>> = ConstStaticCell::new(Channel::new());
static TEXT: ConstStaticCell<Window<WINDOW>> = ConstStaticCell::new(Window::new());

/// What core 0 hands to core 1.
struct Motion {
    interpolator: Interpolator<'static, AXES>,
    operator: Option<Operator<'static, AXES>>,
    ticks: u32,
    digest: Digest,
}

static MOTION: StaticCell<Motion> = StaticCell::new();
static HANDED_ON: AtomicPtr<Motion> = AtomicPtr::new(core::ptr::null_mut());

/// Number of complete parts of the program: M26 waits for a part.
static PARTS: AtomicU32 = AtomicU32::new(0);
/// The program has ended, and all motion is in the queue.
static IS_PLANNED: AtomicBool = AtomicBool::new(false);
/// All motion is executed.
static IS_AT_END: AtomicBool = AtomicBool::new(false);

/// Core 0: splits the channel, starts core 1, receives and plans.
#[entry]
fn planner_core() -> ! {
    let (feeder, text) = TEXT.take().split();
    let handles = match CHANNEL.take().split(&MACHINE, [Position::ZERO; AXES], text) {
        Ok(handles) => handles,
        Err(error) => panic!("machine data: {error}"),
    };
    let Handles { mut planner, interpolator, operator } = handles;
    let motion = Motion { interpolator, operator: Some(operator), ticks: 0, digest: Digest::new() };
    HANDED_ON.store(MOTION.init(motion), Release);
    second::start_second_core();
    // The planner wakes up in the middle of each cycle: after the commands that follow a tick.
    start_timer(MACHINE.channel.cycle_us / 2);
    cortex_m::asm::wfi();
    start_timer(MACHINE.channel.cycle_us);

    let mut receiver = Receiver { line: Line::open(), feeder, part: [0; PART], length: 0 };
    loop {
        receiver.receive();
        match planner.poll() {
            Ok(Progress::Waiting) => cortex_m::asm::wfi(),
            Ok(Progress::Done) => {
                IS_PLANNED.store(true, Release);
                cortex_m::asm::wfi();
            }
            Ok(_) => {}
            Err(error) => panic!("line {}: {error}", error.place().line),
        }
    }
}

/// Core 1: starts its timer and serves the operator after each cycle.
fn tick_core() -> ! {
    // SAFETY: core 0 has handed on the motion and does not use it again; the interrupt is still off.
    let Some(operator) =
        unsafe { HANDED_ON.load(Acquire).as_mut() }.and_then(|motion| motion.operator.take())
    else {
        panic!("core 1 runs before there is something to do")
    };
    let mut timer = start_timer(MACHINE.channel.cycle_us);
    let (mut functions, mut panel) = (Functions::default(), Panel::default());
    loop {
        cortex_m::asm::wfi();
        functions.carry_out(&operator);
        panel.operate(&operator);
        if IS_AT_END.load(Acquire) {
            timer.disable_counter();
            end();
        }
    }
}

/// Starts SysTick, of which each core has one.
fn start_timer(period_us: u32) -> SYST {
    // SAFETY: each core calls this function for its own timer, and has no other reference to it in use.
    let mut timer = unsafe { cortex_m::Peripherals::steal() }.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(period_us * MHZ - 1);
    timer.clear_current();
    timer.enable_interrupt();
    timer.enable_counter();
    timer
}

/// The interrupt of core 0: ends the sleep of the planner.
#[exception]
fn SysTick() {}

/// The interrupt of core 1: outputs the set points of the previous cycle, then computes the next ones.
extern "C" fn tick() {
    // SAFETY: only this interrupt uses the motion after the start of core 1.
    let Some(motion) = (unsafe { HANDED_ON.load(Relaxed).as_mut() }) else { return };
    to_the_drives(motion.interpolator.set_points());
    if motion.interpolator.tick() == State::Active {
        motion.ticks += 1;
        motion.digest.add(motion.interpolator.set_points());
    } else if IS_PLANNED.load(Acquire) {
        IS_AT_END.store(true, Release);
    }
}

/// The program is executed, and the axes stand still.
fn end() -> ! {
    // SAFETY: the interrupt is off.
    if let Some(motion) = unsafe { HANDED_ON.load(Relaxed).as_ref() } {
        print(format_args!("ticks {} digest {:016x}", motion.ticks, motion.digest.value()));
    }
    debug::exit(debug::EXIT_SUCCESS);
    loop {
        cortex_m::asm::wfi();
    }
}

/// Collects each part of the program, and puts it into the window.
struct Receiver {
    line: Line,
    feeder: Feeder<'static, WINDOW>,
    part: [u8; PART],
    length: usize,
}

impl Receiver {
    fn receive(&mut self) {
        while let Some(byte) = self.line.byte() {
            if byte == END_OF_PART {
                let taken = self.feeder.push(self.part.get(..self.length).unwrap_or_default());
                assert!(taken == self.length, "the sender was too early");
                self.length = 0;
                PARTS.fetch_add(1, Release);
            } else if let Some(place) = self.part.get_mut(self.length) {
                *place = byte;
                self.length += 1;
            }
        }
    }
}

/// Carries out functions. At M26 the axes stand still until a part of the program has arrived, and 50 cycles
/// more.
#[derive(Default)]
struct Functions {
    at_hand: Option<(Function, u32)>,
    parts: u32,
}

impl Functions {
    fn carry_out(&mut self, operator: &Operator<'static, AXES>) {
        while let Some(output) = operator.output() {
            print(format_args!("N{} {:?}", output.n, output.function));
            if output.waits {
                self.at_hand = Some((output.function, CARRIED_OUT));
            }
        }
        let Some((function, left)) = self.at_hand else { return };
        if left == CARRIED_OUT {
            if PARTS.load(Acquire) == self.parts {
                return;
            }
            self.parts += 1;
        }
        self.at_hand = (left > 0).then_some((function, left.saturating_sub(1)));
        if left == 0 && operator.acknowledge(function).is_err() {
            print(format_args!("{function:?} was not waited for"));
        }
    }
}

/// Simulates an operator: half the speed at N40, a feed hold at N60, and a resume.
#[derive(Default)]
struct Panel {
    step: u8,
    rested: u32,
}

impl Panel {
    fn operate(&mut self, operator: &Operator<'static, AXES>) {
        let status = operator.status();
        match self.step {
            0 if status.n == 40 => operator.set_override(500),
            1 if status.n == 60 => operator.feed_hold(),
            2 if status.state == State::Idle => {
                self.rested += 1;
                if self.rested < HELD {
                    return;
                }
                operator.set_override(1000);
                operator.resume();
            }
            _ => return,
        }
        self.step += 1;
    }
}

/// Writes a line to the PC. Only core 1 does.
fn print(line: core::fmt::Arguments<'_>) {
    if let Ok(mut out) = hio::hstdout() {
        let _ = writeln!(out, "{line}");
    }
}

/// A board writes to its drives here.
fn to_the_drives(set_points: &[Position; AXES]) {
    core::hint::black_box(set_points);
}
