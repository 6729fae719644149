//! SPI1 with DMA: PA5 clock, PA6 in, PA7 out, mode 0, 10.5 MHz; PA4 as select. No code waits for a byte.
//!
//! ```text
//!   idle -send: select low, both streams on-> sending -last byte came in: select high-> idle
//! ```
//!
//! Stream 3 of DMA2 writes to the transmitter, and stream 2 reads from the receiver. The received bytes are
//! not used. When the last byte has arrived, the whole frame is sent, and the interrupt of stream 2 ends the
//! frame.
use super::{LONGEST, Wire};
use static_cell::ConstStaticCell;
use stm32f4::stm32f405::{DMA2, GPIOA, Interrupt, RCC, SPI1, interrupt};

/// Stream and channel of SPI1's receiver and of its transmitter (RM0090, table 43).
const RECEIVER: usize = 2;
const TRANSMITTER: usize = 3;
const CHANNEL: u8 = 3;

/// Memory for DMA: a static outside the core-coupled memory, which DMA cannot access.
struct Buffers {
    frame: [u8; LONGEST],
    received: u8,
}

static BUFFERS: ConstStaticCell<Buffers> = ConstStaticCell::new(Buffers { frame: [0; LONGEST], received: 0 });

/// SPI1, its streams and pins.
pub struct Spi1 {
    dma: DMA2,
    spi: SPI1,
    port: GPIOA,
    buffers: &'static mut Buffers,
}

impl Spi1 {
    /// Master with 8 bits, most significant bit first; clock APB2 (84 MHz) / 8. `None` if the master exists
    /// already.
    pub fn new(spi: SPI1, dma: DMA2, port: GPIOA, rcc: &RCC) -> Option<Self> {
        let buffers = BUFFERS.try_take()?;
        rcc.ahb1enr().modify(|_, w| w.gpioaen().set_bit().dma2en().set_bit());
        rcc.apb2enr().modify(|_, w| w.spi1en().set_bit());
        port.bsrr().write(|w| w.bs4().set_bit());
        port.afrl().modify(|_, w| w.afrl5().af5().afrl6().af5().afrl7().af5());
        port.ospeedr().modify(|_, w| w.ospeedr5().high_speed().ospeedr7().high_speed());
        port.moder().modify(|_, w| {
            w.moder4().output().moder5().alternate().moder6().alternate().moder7().alternate()
        });
        let register = spi.dr().as_ptr() as u32;
        for stream in [RECEIVER, TRANSMITTER] {
            // SAFETY: the address of the data register; the streams move single bytes.
            dma.st(stream).par().write(|w| unsafe { w.bits(register) });
        }
        let received = (&raw mut buffers.received) as u32;
        // SAFETY: only the receiver's stream uses this byte.
        dma.st(RECEIVER).m0ar().write(|w| unsafe { w.bits(received) });
        spi.cr2().write(|w| w.rxdmaen().set_bit().txdmaen().set_bit());
        spi.cr1().write(|w| w.mstr().set_bit().ssm().set_bit().ssi().set_bit().br().div8().spe().set_bit());
        // SAFETY: the interrupt below touches only its own registers; no critical section depends on the
        // mask.
        unsafe { cortex_m::peripheral::NVIC::unmask(Interrupt::DMA2_STREAM2) };
        Some(Self { dma, spi, port, buffers })
    }

    fn is_sending(&self) -> bool {
        self.dma.st(RECEIVER).cr().read().en().bit_is_set()
    }

    /// Drops a frame that is not sent after a cycle, because such a frame will never be sent.
    fn give_up(&mut self) {
        for stream in [TRANSMITTER, RECEIVER] {
            self.dma.st(stream).cr().modify(|_, w| w.en().clear_bit());
        }
        self.port.bsrr().write(|w| w.bs4().set_bit());
    }
}

impl Wire for Spi1 {
    fn send(&mut self, frame: &[u8; LONGEST], length: usize) {
        // The receiver sees a lost frame as a gap in the frame numbers, and must then stop its drives. The
        // sender cannot do more.
        if self.is_sending() {
            self.give_up();
            return;
        }
        self.buffers.frame = *frame;
        // Clears the flags of a dropped frame.
        let _ = (self.spi.dr().read(), self.spi.sr().read());
        self.dma.lifcr().write(|w| {
            w.ctcif2().clear().chtif2().clear().cteif2().clear().cdmeif2().clear().cfeif2().clear();
            w.ctcif3().clear().chtif3().clear().cteif3().clear().cdmeif3().clear().cfeif3().clear()
        });
        let from = (&raw const self.buffers.frame) as u32;
        // SAFETY: static bytes, which are written only while the stream is off.
        self.dma.st(TRANSMITTER).m0ar().write(|w| unsafe { w.bits(from) });
        for stream in [RECEIVER, TRANSMITTER] {
            self.dma.st(stream).ndtr().write(|w| w.ndt().set(length as u16));
        }
        self.port.bsrr().write(|w| w.br4().set_bit());
        // The frame is in memory before the streams begin.
        cortex_m::asm::dmb();
        self.dma
            .st(RECEIVER)
            .cr()
            .write(|w| w.chsel().set(CHANNEL).pl().high().tcie().set_bit().en().set_bit());
        self.dma
            .st(TRANSMITTER)
            .cr()
            .write(|w| w.chsel().set(CHANNEL).minc().set_bit().dir().memory_to_peripheral().en().set_bit());
    }
}

/// The last byte of a frame has arrived, so the frame is sent.
#[interrupt]
fn DMA2_STREAM2() {
    // SAFETY: each write sets or clears only its own bit in a register: the flag of this interrupt, or the
    // pin.
    let (dma, port) = unsafe { (&*DMA2::ptr(), &*GPIOA::ptr()) };
    dma.lifcr().write(|w| w.ctcif2().clear());
    port.bsrr().write(|w| w.bs4().set_bit());
}
