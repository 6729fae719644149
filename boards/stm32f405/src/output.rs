//! Where set points go: SPI frames. On a board they are sent; without hardware they are made and go nowhere.
use crate::spi::Frames;
use stm32f4::stm32f405::{DMA2, GPIOA, RCC, SPI1};

#[cfg(feature = "hardware")]
use crate::spi::Spi1 as End;
#[cfg(not(feature = "hardware"))]
use nowhere::Nowhere as End;

/// Frames.
pub type Output = Frames<End>;

/// Sets SPI1, its DMA and its pins up. `None` if that was done before.
pub fn axes(spi: SPI1, dma: DMA2, port: GPIOA, rcc: &RCC) -> Option<Output> {
    End::new(spi, dma, port, rcc).map(Frames::new)
}

#[cfg(not(feature = "hardware"))]
mod nowhere {
    use super::{DMA2, GPIOA, RCC, SPI1};
    use crate::spi::{LONGEST, Wire};

    /// Takes frames and drops them.
    pub struct Nowhere;

    impl Nowhere {
        pub fn new(_: SPI1, _: DMA2, _: GPIOA, _: &RCC) -> Option<Self> {
            Some(Self)
        }
    }

    impl Wire for Nowhere {
        fn send(&mut self, frame: &[u8; LONGEST], length: usize) {
            // As if it were sent: the compiler leaves the work in.
            core::hint::black_box((frame, length));
        }
    }
}
