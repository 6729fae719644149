//! Glidepath in an RTIC application, on an STM32F405 and in QEMU's `netduinoplus2`.
//!
//! | task | priority | owns | work |
//! |---|---|---|---|
//! | `tick` | 4, the interrupt of TIM2 | the interpolator | one set point per axis and cycle |
//! | `receive` | 3, the interrupt of USART1 | the feeder of the text window | passes on each complete part of the program |
//! | `functions` | 3 | the operator, shared | carries out M functions and acknowledges them |
//! | `panel` | 2 | the operator, shared | feed hold and override |
//! | `plan` | 1 | the planner | plans ahead |
#![no_std]
#![no_main]

#[path = "../../tasks/machine.rs"]
mod machine;

use glidepath_copy as _;
use panic_semihosting as _;

/// The tasks.
#[rtic::app(device = stm32f4::stm32f405, dispatchers = [SPI1, SPI2, SPI3])]
mod app {
    use crate::machine::{AXES, BLOCKS, MACHINE};
    use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};
    use cortex_m_semihosting::{debug, hprintln};
    use glidepath::channel::{Channel, Handles, Planner, Progress};
    use glidepath::digest::Digest;
    use glidepath::nc::{Feeder, Stream, Window};
    use glidepath::operator::Operator;
    use glidepath::quantity::Position;
    use glidepath::technology::Function;
    use glidepath::tick::{Interpolator, State};
    use stm32f4::stm32f405::{TIM2, USART1};

    /// Bytes in the buffer for received program text. The sender puts END_OF_PART after each part, which has
    /// at most half of these bytes, and sends the next part when the program reports its progress.
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

    /// Number of complete parts of the program: M26 waits for a part.
    static PARTS: AtomicU32 = AtomicU32::new(0);

    /// The program has ended, and all motion is in the queue.
    static IS_PLANNED: AtomicBool = AtomicBool::new(false);

    #[shared]
    struct Shared {
        operator: Operator<'static, AXES>,
    }

    #[local]
    struct Local {
        planner: Planner<'static, Stream<'static, WINDOW>, AXES, BLOCKS>,
        interpolator: Interpolator<'static, AXES>,
        feeder: Feeder<'static, WINDOW>,
        timer: TIM2,
        line: USART1,
    }

    #[init(local = [channel: Channel<AXES, BLOCKS> = Channel::new(), window: Window<WINDOW> = Window::new()])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let (feeder, text) = cx.local.window.split();
        let handles = match cx.local.channel.split(&MACHINE, [Position::ZERO; AXES], text) {
            Ok(handles) => handles,
            Err(error) => panic!("machine data: {error}"),
        };
        let Handles { planner, interpolator, operator } = handles;
        // Counter and prescaler are zero after reset, so no update event is needed.
        cx.device.RCC.apb1enr().modify(|_, w| w.tim2en().set_bit());
        let timer = cx.device.TIM2;
        timer.arr().write(|w| w.arr().set(MACHINE.channel.cycle_us * TIMER_MHZ - 1));
        timer.dier().write(|w| w.uie().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        // The serial line: on, receive, transmit, an interrupt for each byte. The pins depend on the board.
        cx.device.RCC.apb2enr().modify(|_, w| w.usart1en().set_bit());
        let line = cx.device.USART1;
        line.brr().write(|w| w.div_mantissa().set((BAUD / 16) as u16).div_fraction().set((BAUD % 16) as u8));
        line.cr1().write(|w| w.ue().set_bit().re().set_bit().te().set_bit().rxneie().set_bit());
        line.dr().write(|w| w.dr().set(READY));
        (Shared { operator }, Local { planner, interpolator, feeder, timer, line })
    }

    /// Sleeps until the next interrupt.
    #[idle]
    fn idle(_: idle::Context) -> ! {
        loop {
            cortex_m::asm::wfi();
        }
    }

    /// The timer interrupt: outputs the set points of the previous cycle, then computes the next ones.
    #[task(binds = TIM2, priority = 4, local = [interpolator, timer, ticks: u32 = 0, digest: Digest = Digest::new()])]
    fn tick(cx: tick::Context) {
        let tick::LocalResources { interpolator, timer, ticks, digest, .. } = cx.local;
        timer.sr().modify(|_, w| w.uif().clear_bit());
        to_the_drives(interpolator.set_points());
        let state = interpolator.tick();
        if state == State::Active {
            *ticks += 1;
            digest.add(interpolator.set_points());
        } else if IS_PLANNED.load(Relaxed) {
            let _ = end::spawn(*ticks, digest.value());
        }
        // A task that still runs from the last cycle continues: RTIC does not start it a second time.
        let _ = functions::spawn();
        let _ = panel::spawn();
        let _ = plan::spawn();
    }

    /// Plans until the queue is full. The next cycle wakes the task again.
    #[task(priority = 1, local = [planner])]
    async fn plan(cx: plan::Context) {
        loop {
            match cx.local.planner.poll() {
                Ok(Progress::Waiting) => return,
                Ok(Progress::Done) => return IS_PLANNED.store(true, Relaxed),
                Ok(_) => {}
                // The line is left out; motion that was planned before stays valid.
                Err(error) => hprintln!("line {}: {}", error.place().line, error),
            }
        }
    }

    /// A byte arrives. Each complete part of the program goes into the window.
    #[task(binds = USART1, priority = 3, local = [feeder, line, part: [u8; PART] = [0; PART], length: usize = 0])]
    fn receive(cx: receive::Context) {
        let receive::LocalResources { feeder, line, part, length, .. } = cx.local;
        let byte = line.dr().read().dr().bits() as u8;
        if byte == END_OF_PART {
            let taken = feeder.push(part.get(..*length).unwrap_or_default());
            if taken != *length {
                hprintln!("the sender was too early");
            }
            *length = 0;
            PARTS.fetch_add(1, Relaxed);
        } else if let Some(place) = part.get_mut(*length) {
            *place = byte;
            *length += 1;
        }
    }

    /// Carries out functions. At M26 the axes stand still until a part of the program has arrived, and 50
    /// cycles more.
    #[task(priority = 3, shared = [operator], local = [at_hand: Option<(Function, u32)> = None, parts: u32 = 0])]
    async fn functions(mut cx: functions::Context) {
        let functions::LocalResources { at_hand, parts, .. } = cx.local;
        cx.shared.operator.lock(|operator| {
            while let Some(output) = operator.output() {
                hprintln!("N{} {:?}", output.n, output.function);
                if output.waits {
                    *at_hand = Some((output.function, CARRIED_OUT));
                }
            }
            if let Some((function, left)) = *at_hand {
                if left == CARRIED_OUT {
                    if PARTS.load(Relaxed) == *parts {
                        return;
                    }
                    *parts += 1;
                }
                *at_hand = (left > 0).then_some((function, left.saturating_sub(1)));
                if left == 0 && operator.acknowledge(function).is_err() {
                    hprintln!("{function:?} was not waited for");
                }
            }
        });
    }

    /// Simulates an operator: half the speed at N40, a feed hold at N60, and a resume.
    #[task(priority = 2, shared = [operator], local = [step: u8 = 0, rested: u32 = 0])]
    async fn panel(mut cx: panel::Context) {
        let panel::LocalResources { step, rested, .. } = cx.local;
        cx.shared.operator.lock(|operator| {
            let status = operator.status();
            match *step {
                0 if status.n == 40 => operator.set_override(500),
                1 if status.n == 60 => operator.feed_hold(),
                2 if status.state == State::Idle => {
                    *rested += 1;
                    if *rested < HELD {
                        return;
                    }
                    operator.set_override(1000);
                    operator.resume();
                }
                _ => return,
            }
            *step += 1;
        });
    }

    /// The program is executed, and the axes stand still.
    #[task(priority = 1)]
    async fn end(_: end::Context, ticks: u32, digest: u64) {
        hprintln!("ticks {ticks} digest {digest:016x}");
        debug::exit(debug::EXIT_SUCCESS);
    }

    /// A board writes to its drives here.
    fn to_the_drives(set_points: &[Position; AXES]) {
        core::hint::black_box(set_points);
    }
}
