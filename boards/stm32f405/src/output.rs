//! Where set points go: an SPI frame on a board, nowhere in the emulator, which has nothing attached.
#[cfg(feature = "hardware")]
pub use spi_output::{Output, axes};

#[cfg(not(feature = "hardware"))]
pub use nowhere::{Output, axes};

#[cfg(feature = "hardware")]
mod spi_output {
    use crate::spi::{Frames, Pin4, Spi1};
    use stm32f4::stm32f405::{GPIOA, RCC, SPI1};

    /// Frames over SPI1, selected by PA4.
    pub type Output = Frames<Spi1, Pin4>;

    /// Sets SPI1 and its pins up.
    pub fn axes(spi: SPI1, port: GPIOA, rcc: &RCC) -> Output {
        let select = Pin4::new(port, rcc);
        Frames::new(Spi1::new(spi, rcc), select)
    }
}

#[cfg(not(feature = "hardware"))]
mod nowhere {
    use crate::AXES;
    use glidepath::axis::Axes;
    use glidepath::quantity::Position;
    use stm32f4::stm32f405::{GPIOA, RCC, SPI1};

    /// Takes set points and drops them.
    pub struct Output;

    /// Needs no set-up.
    pub fn axes(_: SPI1, _: GPIOA, _: &RCC) -> Output {
        Output
    }

    impl Axes<AXES> for Output {
        fn write(&mut self, _: &[Position; AXES]) {}
    }
}
