//! Limits, probe and control inputs: port B.
//!
//! | pin | input |
//! |---|---|
//! | PB12, PB13, PB14 | limit X, Y, Z |
//! | PB15 | probe |
//! | PB5, PB6, PB8, PB9 | cycle start, reset, door, feed hold |
//!
//! Limits and probe cause an interrupt at each edge, which latches the position at this moment.
use crate::machine::{CONTROLS_INVERTED, LOOKS};
use crate::tick::Polarity;
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin};
use glidepath_controller::Signals;
use glidepath_controller::pins::Input;
#[cfg(feature = "hardware")]
use stm32f4::stm32f405::{GPIOB, interrupt};

/// First pin of the limits, and the probe.
const LIMITS: u32 = 12;
const PROBE: u32 = 15;

/// Pins of the control inputs, and what they mean.
const CONTROLS: [(u8, Signals); 4] =
    [(5, Signals::START), (6, Signals::RESET), (8, Signals::DOOR), (9, Signals::HOLD)];

/// Reads the levels of the port.
#[cfg(feature = "hardware")]
fn levels() -> u32 {
    // SAFETY: a read.
    unsafe { &*GPIOB::ptr() }.idr().read().bits()
}

/// QEMU's port reads as zero, so this function returns the levels of pull-ups without switches.
#[cfg(not(feature = "hardware"))]
fn levels() -> u32 {
    0xffff
}

/// Limits and probe that are on now.
pub fn read(polarity: Polarity) -> Signals {
    let on = |high: bool| if high { levels() } else { !levels() };
    let limits = on(polarity.limits_high) >> LIMITS & 0b111;
    let probe = on(polarity.probe_high) >> PROBE & 1;
    let signals = Signals(limits as u16);
    if probe == 1 { signals.and(Signals::PROBE) } else { signals }
}

/// A pin of port B.
pub struct Pin(u8);

impl ErrorType for Pin {
    type Error = Infallible;
}

impl InputPin for Pin {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(levels() >> self.0 & 1 == 1)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|is_high| !is_high)
    }
}

/// The control inputs, debounced.
pub struct Controls([(Input<Pin>, Signals); 4]);

impl Controls {
    /// All inputs off.
    pub fn new() -> Self {
        Self(CONTROLS.map(|(pin, signal)| (Input::new(Pin(pin), !CONTROLS_INVERTED, LOOKS), signal)))
    }

    /// Samples the inputs once per tick.
    pub fn look(&mut self) -> Signals {
        let mut signals = Signals::default();
        for (input, signal) in &mut self.0 {
            if let Ok(true) = input.look() {
                signals = signals.and(*signal);
            }
        }
        signals
    }
}

/// Switches on the pull-ups, and an interrupt at each edge of limits and probe.
#[cfg(feature = "hardware")]
pub fn start(board: &stm32f4::stm32f405::Peripherals) {
    use stm32f4::stm32f405::Interrupt;
    board.RCC.ahb1enr().modify(|_, w| w.gpioben().set_bit());
    board.RCC.apb2enr().modify(|_, w| w.syscfgen().set_bit());
    let pins = (LIMITS..=PROBE).chain(CONTROLS.map(|(pin, _)| u32::from(pin)));
    for pin in pins {
        // SAFETY: two bits for each pin select the pull-up; the pins are inputs since reset.
        board.GPIOB.pupdr().modify(|r, w| unsafe { w.bits(r.bits() & !(3 << (2 * pin)) | 1 << (2 * pin)) });
    }
    // SAFETY: port B for lines 12 to 15, and the bits of these lines.
    unsafe {
        board.SYSCFG.exticr4().write(|w| w.bits(0x1111));
        board.EXTI.rtsr().modify(|r, w| w.bits(r.bits() | 0xf000));
        board.EXTI.ftsr().modify(|r, w| w.bits(r.bits() | 0xf000));
        board.EXTI.imr().modify(|r, w| w.bits(r.bits() | 0xf000));
        cortex_m::peripheral::NVIC::unmask(Interrupt::EXTI15_10);
    }
}

/// QEMU has no inputs.
#[cfg(not(feature = "hardware"))]
pub fn start(_: &stm32f4::stm32f405::Peripherals) {}

/// An edge of a limit or of the probe. The priority is that of the tick, so neither interrupts the other.
#[cfg(feature = "hardware")]
#[interrupt]
fn EXTI15_10() {
    // SAFETY: only this interrupt clears these flags, by writing ones.
    unsafe { (*stm32f4::stm32f405::EXTI::ptr()).pr().write(|w| w.bits(0xf000)) };
    crate::tick::with(|tick| tick.edge(crate::words::slot(), read));
}
