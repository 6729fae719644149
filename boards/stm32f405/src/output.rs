//! Output of set points as SPI frames. A board sends the frames; without hardware the frames are computed and
//! dropped.
use crate::spi::Frames;
use stm32f4::stm32f405::{DMA2, GPIOA, RCC, SPI1};

#[cfg(feature = "hardware")]
use crate::spi::Spi1 as End;
#[cfg(not(feature = "hardware"))]
use nowhere::Nowhere as End;

/// The output of frames.
pub type Output = Frames<End>;

/// Sets up SPI1, its DMA and its pins. `None` if this was done before.
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
            // The buffer is treated as sent, so that the compiler keeps the computation.
            core::hint::black_box((frame, length));
        }
    }
}
