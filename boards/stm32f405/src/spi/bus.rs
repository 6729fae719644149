//! SPI1 as an embedded-hal bus: PA5 clock, PA6 in, PA7 out, mode 0, 10.5 MHz; PA4 as select.
use core::convert::Infallible;
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::spi::{self, ErrorKind, SpiBus};
use stm32f4::stm32f405::{GPIOA, RCC, SPI1};

/// Polls of a status bit before a transfer is given up; a byte takes about 130 core cycles.
const PATIENCE: u32 = 1000;

/// A byte did not get through in time.
#[derive(Clone, Copy, Debug)]
pub struct Timeout;

impl spi::Error for Timeout {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// SPI1.
pub struct Spi1(SPI1);

impl Spi1 {
    /// A master of 8 bits, most significant bit first; APB2 (84 MHz) / 8.
    pub fn new(spi: SPI1, rcc: &RCC) -> Self {
        rcc.apb2enr().modify(|_, w| w.spi1en().set_bit());
        spi.cr1().write(|w| w.mstr().set_bit().ssm().set_bit().ssi().set_bit().br().div8().spe().set_bit());
        Self(spi)
    }

    fn exchange(&mut self, byte: u8) -> Result<u8, Timeout> {
        wait(|| self.0.sr().read().txe().bit_is_set())?;
        self.0.dr().write(|w| w.dr().set(u16::from(byte)));
        wait(|| self.0.sr().read().rxne().bit_is_set())?;
        Ok(self.0.dr().read().dr().bits() as u8)
    }
}

fn wait(ready: impl Fn() -> bool) -> Result<(), Timeout> {
    if (0..PATIENCE).any(|_| ready()) { Ok(()) } else { Err(Timeout) }
}

impl spi::ErrorType for Spi1 {
    type Error = Timeout;
}

impl SpiBus for Spi1 {
    fn read(&mut self, words: &mut [u8]) -> Result<(), Timeout> {
        words.iter_mut().try_for_each(|word| self.exchange(0).map(|byte| *word = byte))
    }

    fn write(&mut self, words: &[u8]) -> Result<(), Timeout> {
        words.iter().try_for_each(|&word| self.exchange(word).map(|_| ()))
    }

    fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), Timeout> {
        for i in 0..read.len().max(write.len()) {
            let byte = self.exchange(write.get(i).copied().unwrap_or(0))?;
            if let Some(word) = read.get_mut(i) {
                *word = byte;
            }
        }
        Ok(())
    }

    fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), Timeout> {
        words.iter_mut().try_for_each(|word| self.exchange(*word).map(|byte| *word = byte))
    }

    fn flush(&mut self) -> Result<(), Timeout> {
        wait(|| self.0.sr().read().bsy().bit_is_clear())
    }
}

/// PA4, high at first.
pub struct Pin4(GPIOA);

impl Pin4 {
    /// Makes PA4 an output and gives PA5…PA7 to SPI1 (alternate function 5).
    pub fn new(port: GPIOA, rcc: &RCC) -> Self {
        rcc.ahb1enr().modify(|_, w| w.gpioaen().set_bit());
        port.bsrr().write(|w| w.bs4().set_bit());
        port.afrl().modify(|_, w| w.afrl5().af5().afrl6().af5().afrl7().af5());
        port.ospeedr().modify(|_, w| w.ospeedr5().high_speed().ospeedr7().high_speed());
        port.moder().modify(|_, w| {
            w.moder4().output().moder5().alternate().moder6().alternate().moder7().alternate()
        });
        Self(port)
    }
}

impl digital::ErrorType for Pin4 {
    type Error = Infallible;
}

impl OutputPin for Pin4 {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.bsrr().write(|w| w.br4().set_bit());
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.bsrr().write(|w| w.bs4().set_bit());
        Ok(())
    }
}
