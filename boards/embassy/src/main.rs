//! Glidepath with Embassy, on an STM32F405 and in QEMU's `netduinoplus2`.
//!
//! | interrupt or task | priority | owns | work |
//! |---|---|---|---|
//! | `TIM2` | the timer interrupt, with higher priority than Embassy | the interpolator | one set point per axis and cycle |
//! | `USART1` | the interrupt of the serial line | its registers | passes on a byte |
//! | `receive` | an executor in an interrupt | the feeder of the text window | passes on each complete part of the program |
//! | `functions` | the same | the operator, shared | carries out M functions and acknowledges them |
//! | `panel` | the same | the operator, shared | feed hold and override |
//! | `plan` | an executor in an interrupt of the lowest priority | the planner | plans ahead |
//!
//! The main loop sleeps. Embassy's executor for the main loop could replace the second executor. But this
//! executor sleeps by WFE, at which QEMU does not sleep, and would execute a million instructions in each
//! cycle.
#![no_std]
#![no_main]

#[path = "../../tasks/machine.rs"]
mod machine;

use core::cell::RefCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};
use cortex_m::peripheral::NVIC;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};

use embassy_executor::InterruptExecutor;
use embassy_sync::blocking_mutex::{CriticalSectionMutex, raw::CriticalSectionRawMutex};
use embassy_sync::channel::Channel;
use embassy_sync::signal::Signal;
use glidepath::channel::{self, Handles, Planner, Progress};
use glidepath::digest::Digest;
use glidepath::nc::{Feeder, Stream, Window};
use glidepath::operator;
use glidepath::quantity::Position;
use glidepath::tick::{self, State};
use glidepath_copy as _;
use machine::{AXES, BLOCKS, MACHINE};
use panic_semihosting as _;
use static_cell::{ConstStaticCell, StaticCell};
use stm32f4::stm32f405::{Interrupt, Peripherals, TIM2, USART1, interrupt};

type Interpolator = tick::Interpolator<'static, AXES>;
type Operator = CriticalSectionMutex<operator::Operator<'static, AXES>>;
type Cycle = Signal<CriticalSectionRawMutex, ()>;

/// Bytes in the buffer for received program text. The sender puts END_OF_PART after each part, which has at
/// most half of these bytes, and sends the next part when the program reports its progress.
const WINDOW: usize = 512;
const PART: usize = WINDOW / 2;
const END_OF_PART: u8 = 3;

/// 16 MHz divided by 115,200 baud, and the byte that asks the sender to begin.
const BAUD: u32 = 139;
const READY: u16 = 0x11;

/// Clock of TIM2, MHz: QEMU's TIM2 has 1 GHz. A board has 16 MHz after reset.
const TIMER_MHZ: u32 = 1000;

/// Cycles until M26 is acknowledged, and length of the feed hold in cycles.
const CARRIED_OUT: u32 = 50;
const HELD: u32 = 100;

static CHANNEL: ConstStaticCell<channel::Channel<AXES, BLOCKS>> =
    ConstStaticCell::new(channel::Channel::new());
static TEXT: ConstStaticCell<Window<WINDOW>> = ConstStaticCell::new(Window::new());
static OPERATOR: StaticCell<Operator> = StaticCell::new();

/// Signals that wake a task in each cycle.
static PLAN: Cycle = Signal::new();
static FUNCTIONS: Cycle = Signal::new();
static PANEL: Cycle = Signal::new();

/// Bytes from the interrupt of the serial line, and the number of complete parts of the program: M26 waits
/// for a part.
static BYTES: Channel<CriticalSectionRawMutex, u8, 64> = Channel::new();
static PARTS: AtomicU32 = AtomicU32::new(0);

/// The program has ended, and all motion is in the queue.
static IS_PLANNED: AtomicBool = AtomicBool::new(false);

/// Data that the timer interrupt takes over.
static MAILBOX: CriticalSectionMutex<RefCell<Option<(Interpolator, TIM2)>>> =
    CriticalSectionMutex::new(RefCell::new(None));

/// Data that the interrupt of the serial line takes over.
static LINE_BOX: CriticalSectionMutex<RefCell<Option<USART1>>> =
    CriticalSectionMutex::new(RefCell::new(None));

/// Ticks and digest at the end.
static END: Signal<CriticalSectionRawMutex, (u32, u64)> = Signal::new();

/// The executor of the tasks with higher priority than the planner, and the executor of the planner.
static URGENT: InterruptExecutor = InterruptExecutor::new();
static PATIENT: InterruptExecutor = InterruptExecutor::new();

#[interrupt]
fn SPI1() {
    // SAFETY: only the interrupt of this executor calls it.
    unsafe { URGENT.on_interrupt() }
}

#[interrupt]
fn SPI2() {
    // SAFETY: only the interrupt of this executor calls it.
    unsafe { PATIENT.on_interrupt() }
}

/// The timer interrupt: outputs the set points of the previous cycle, then computes the next ones.
#[interrupt]
fn TIM2() {
    static mut MOTION: Option<(Interpolator, TIM2)> = None;
    static mut TICKS: u32 = 0;
    static mut DIGEST: Digest = Digest::new();
    if MOTION.is_none() {
        *MOTION = MAILBOX.lock(RefCell::take);
    }
    let Some((interpolator, timer)) = MOTION else { return };
    timer.sr().modify(|_, w| w.uif().clear_bit());
    to_the_drives(interpolator.set_points());
    let state = interpolator.tick();
    if state == State::Active {
        *TICKS += 1;
        DIGEST.add(interpolator.set_points());
    } else if IS_PLANNED.load(Relaxed) {
        END.signal((*TICKS, DIGEST.value()));
    }
    for cycle in [&FUNCTIONS, &PANEL, &PLAN] {
        cycle.signal(());
    }
}

/// A byte arrives.
#[interrupt]
fn USART1() {
    static mut LINE: Option<USART1> = None;
    if LINE.is_none() {
        *LINE = LINE_BOX.lock(RefCell::take);
    }
    let Some(line) = LINE else { return };
    if BYTES.is_full() {
        // If the buffer is full, the task must run first, and the byte stays in the register. With RTS the
        // UART then stops the sender.
        NVIC::mask(Interrupt::USART1);
    } else {
        let _ = BYTES.try_send(line.dr().read().dr().bits() as u8);
    }
}

#[entry]
fn main() -> ! {
    let (feeder, text) = TEXT.take().split();
    let handles = match CHANNEL.take().split(&MACHINE, [Position::ZERO; AXES], text) {
        Ok(handles) => handles,
        Err(error) => panic!("machine data: {error}"),
    };
    let Handles { planner, interpolator, operator } = handles;
    let operator = OPERATOR.init(Operator::new(operator));
    let Some(board) = Peripherals::take() else { panic!("taken before") };
    start(board, interpolator);
    let urgent = URGENT.start(Interrupt::SPI1);
    urgent.spawn(receive(feeder).unwrap());
    urgent.spawn(functions(operator).unwrap());
    urgent.spawn(panel(operator).unwrap());
    let patient = PATIENT.start(Interrupt::SPI2);
    patient.spawn(plan(planner).unwrap());
    patient.spawn(end().unwrap());
    loop {
        cortex_m::asm::wfi();
    }
}

/// Starts timer and serial line, and sets the priorities of the interrupts.
fn start(board: Peripherals, interpolator: Interpolator) {
    // Counter and prescaler are zero after reset, so no update event is forced.
    board.RCC.apb1enr().modify(|_, w| w.tim2en().set_bit());
    board.RCC.apb2enr().modify(|_, w| w.usart1en().set_bit());
    let (timer, line) = (board.TIM2, board.USART1);
    timer.arr().write(|w| w.arr().set(MACHINE.channel.cycle_us * TIMER_MHZ - 1));
    timer.dier().write(|w| w.uie().set_bit());
    timer.cr1().write(|w| w.cen().set_bit());
    MAILBOX.lock(|mailbox| mailbox.replace(Some((interpolator, timer))));
    // The serial line: on, receive, transmit, an interrupt for each byte. The pins depend on the board.
    line.brr().write(|w| w.div_mantissa().set((BAUD / 16) as u16).div_fraction().set((BAUD % 16) as u8));
    line.cr1().write(|w| w.ue().set_bit().re().set_bit().te().set_bit().rxneie().set_bit());
    line.dr().write(|w| w.dr().set(READY));
    LINE_BOX.lock(|mailbox| mailbox.replace(Some(line)));
    // SAFETY: no code depends on these priorities or on the mask yet. The tick has a higher priority than
    // Embassy's tasks.
    unsafe {
        let mut nvic = cortex_m::Peripherals::steal().NVIC;
        nvic.set_priority(Interrupt::TIM2, 0x40);
        nvic.set_priority(Interrupt::USART1, 0x60);
        nvic.set_priority(Interrupt::SPI1, 0x80);
        nvic.set_priority(Interrupt::SPI2, 0xc0);
        NVIC::unmask(Interrupt::TIM2);
        NVIC::unmask(Interrupt::USART1);
    }
}

/// Plans until the queue is full. The next cycle wakes the task again.
#[embassy_executor::task]
async fn plan(mut planner: Planner<'static, Stream<'static, WINDOW>, AXES, BLOCKS>) {
    loop {
        match planner.poll() {
            Ok(Progress::Waiting) => PLAN.wait().await,
            Ok(Progress::Done) => {
                IS_PLANNED.store(true, Relaxed);
                PLAN.wait().await;
            }
            Ok(_) => {}
            // The line is left out; motion that was planned before stays valid.
            Err(error) => hprintln!("line {}: {}", error.place().line, error),
        }
    }
}

/// Program text arrives. Each complete part of the program goes into the window.
#[embassy_executor::task]
async fn receive(mut feeder: Feeder<'static, WINDOW>) {
    let (mut part, mut length) = ([0; PART], 0);
    loop {
        let byte = BYTES.receive().await;
        // SAFETY: the interrupt has its data.
        unsafe { NVIC::unmask(Interrupt::USART1) };
        if byte == END_OF_PART {
            if feeder.push(part.get(..length).unwrap_or_default()) != length {
                hprintln!("the sender was too early");
            }
            length = 0;
            PARTS.fetch_add(1, Relaxed);
        } else if let Some(place) = part.get_mut(length) {
            *place = byte;
            length += 1;
        }
    }
}

/// Carries out functions. At M26 the axes stand still until a part of the program has arrived, and 50 cycles
/// more.
#[embassy_executor::task]
async fn functions(operator: &'static Operator) {
    let mut parts = 0;
    loop {
        FUNCTIONS.wait().await;
        let Some(output) = operator.lock(operator::Operator::output) else { continue };
        hprintln!("N{} {:?}", output.n, output.function);
        if output.waits {
            while PARTS.load(Relaxed) == parts {
                FUNCTIONS.wait().await;
            }
            parts += 1;
            for _ in 0..CARRIED_OUT {
                FUNCTIONS.wait().await;
            }
            if operator.lock(|operator| operator.acknowledge(output.function)).is_err() {
                hprintln!("{:?} was not waited for", output.function);
            }
        }
    }
}

/// Simulates an operator: half the speed at N40, a feed hold at N60, and a resume.
#[embassy_executor::task]
async fn panel(operator: &'static Operator) {
    let status = || operator.lock(operator::Operator::status);
    wait_until(|| status().n == 40).await;
    operator.lock(|operator| operator.set_override(500));
    wait_until(|| status().n == 60).await;
    operator.lock(operator::Operator::feed_hold);
    for _ in 0..HELD {
        wait_until(|| status().state == State::Idle).await;
    }
    operator.lock(|operator| {
        operator.set_override(1000);
        operator.resume();
    });
}

/// Checks the state once per cycle.
async fn wait_until(is_so: impl Fn() -> bool) {
    loop {
        PANEL.wait().await;
        if is_so() {
            return;
        }
    }
}

/// The program is executed, and the axes stand still.
#[embassy_executor::task]
async fn end() {
    let (ticks, digest) = END.wait().await;
    hprintln!("ticks {ticks} digest {digest:016x}");
    debug::exit(debug::EXIT_SUCCESS);
}

/// A board writes to its drives here.
fn to_the_drives(set_points: &[Position; AXES]) {
    core::hint::black_box(set_points);
}
