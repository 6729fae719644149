//! Spindle, coolant and the enable pin of the motors.
//!
//! | pin | output |
//! |---|---|
//! | PB7 | spindle speed: PWM of 5 kHz, TIM4 channel 2 |
//! | PA0, PA1 | spindle on, spindle counterclockwise |
//! | PA2, PA3 | flood, mist |
//! | PC6 | motors on: low, with `$4=1` high |
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use glidepath_controller::Outputs;
use glidepath_controller::pins::Tool;
use stm32f4::stm32f405::{GPIOA, GPIOC, Peripherals, TIM4};

/// 84 MHz divided by 5 kHz.
const PERIOD: u16 = 16_800;

/// Pins of port A.
const SPINDLE: u32 = 0;
const REVERSE: u32 = 1;
const FLOOD: u32 = 2;
const MIST: u32 = 3;

/// Pin of port C.
const MOTORS: u32 = 6;

/// A pin of port A.
pub struct Pin(u32);

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        // SAFETY: a write that changes this pin alone.
        unsafe { (*GPIOA::ptr()).bsrr().write(|w| w.bits(1 << (self.0 + 16))) };
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        // SAFETY: a write that changes this pin alone.
        unsafe { (*GPIOA::ptr()).bsrr().write(|w| w.bits(1 << self.0)) };
        Ok(())
    }
}

/// The spindle's speed.
pub struct Pwm;

impl pwm::ErrorType for Pwm {
    type Error = Infallible;
}

impl SetDutyCycle for Pwm {
    fn max_duty_cycle(&self) -> u16 {
        PERIOD
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        // SAFETY: the compare register of a channel that nothing else uses.
        unsafe { &*TIM4::ptr() }.ccr(1).write(|w| w.ccr().set(duty));
        Ok(())
    }
}

/// All outputs.
pub struct OutputPins {
    tool: Tool<Pwm, Pin>,
    last: Option<(Outputs, bool)>,
}

impl OutputPins {
    /// Switches all outputs off.
    pub fn start(board: &Peripherals) -> Self {
        let Peripherals { RCC: rcc, GPIOA: a, GPIOB: b, GPIOC: c, TIM4: timer, .. } = board;
        rcc.ahb1enr().modify(|_, w| w.gpioaen().set_bit().gpioben().set_bit().gpiocen().set_bit());
        rcc.apb1enr().modify(|_, w| w.tim4en().set_bit());
        // SAFETY: the words switch these pins off, and the motors too.
        unsafe {
            a.bsrr().write(|w| w.bits(0xf << 16));
            c.bsrr().write(|w| w.bits(1 << MOTORS));
        }
        a.moder().modify(|_, w| w.moder0().output().moder1().output().moder2().output().moder3().output());
        c.moder().modify(|_, w| w.moder6().output());
        timer.arr().write(|w| w.arr().set(PERIOD - 1));
        // PWM mode 1, buffered.
        timer.ccmr1_output().modify(|_, w| w.oc2m().pwm_mode1().oc2pe().set_bit());
        timer.ccer().write(|w| w.cc2e().set_bit());
        // The emulator would count each period, although no pulse is visible.
        timer.cr1().write(|w| w.cen().bit(cfg!(feature = "hardware")));
        b.afrl().modify(|_, w| w.afrl7().af2());
        b.moder().modify(|_, w| w.moder7().alternate());
        let tool = Tool {
            pwm: Pwm,
            enable: Pin(SPINDLE),
            direction: Pin(REVERSE),
            mist: Pin(MIST),
            flood: Pin(FLOOD),
        };
        Self { tool, last: None }
    }

    /// Outputs the wanted state of spindle, coolant and motors. `motors_high`: `$4`.
    pub fn put(&mut self, outputs: Outputs, motors_high: bool) {
        if self.last.replace((outputs, motors_high)) == Some((outputs, motors_high)) {
            return;
        }
        // These pins do not fail.
        let _ = self.tool.put_out(&outputs);
        let shift = if outputs.motors == motors_high { MOTORS } else { MOTORS + 16 };
        // SAFETY: a write that changes this pin alone.
        unsafe { (*GPIOC::ptr()).bsrr().write(|w| w.bits(1 << shift)) };
    }
}

/// Switches spindle and coolant off, for faults. The motors keep their current, so that a vertical axis does
/// not fall.
pub fn all_off() {
    // SAFETY: writes that switch these pins off.
    unsafe {
        (*GPIOA::ptr()).bsrr().write(|w| w.bits(0xf << 16));
        (*TIM4::ptr()).ccr(1).write(|w| w.ccr().set(0));
    }
}
