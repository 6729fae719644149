//! The serial line: USART1, PA9 out and PA10 in, 115,200 baud, 8 bits, no parity.
//!
//! On a board DMA2 writes received bytes into a ring. The tick and the interrupt of the idle line read this
//! ring, so a byte acts within a millisecond. The line continues to receive while flash memory blocks the
//! processor. QEMU has no DMA, so there an interrupt reads each byte.
use core::cell::RefCell;
use critical_section::Mutex;
use glidepath_controller::Receiver;

/// Bytes of the controller's input buffer.
pub const BUFFER: usize = 1024;

/// The interrupt's handle of the input.
static RECEIVER: Mutex<RefCell<Option<Receiver<'static, BUFFER>>>> = Mutex::new(RefCell::new(None));

fn receive(what: impl FnOnce(&mut Receiver<'static, BUFFER>)) {
    critical_section::with(|cs| {
        if let Ok(mut receiver) = RECEIVER.borrow(cs).try_borrow_mut()
            && let Some(receiver) = receiver.as_mut()
        {
            what(receiver);
        }
    });
}

/// Starts the serial line.
pub fn start(board: &stm32f4::stm32f405::Peripherals, receiver: Receiver<'static, BUFFER>) -> Line {
    critical_section::with(|cs| {
        if let Ok(mut place) = RECEIVER.borrow(cs).try_borrow_mut() {
            *place = Some(receiver);
        }
    });
    board.RCC.apb2enr().modify(|_, w| w.usart1en().set_bit());
    end::start(board);
    Line
}

pub use end::Line;
#[cfg(feature = "hardware")]
pub use end::drain;

impl embedded_io::ErrorType for Line {
    type Error = core::convert::Infallible;
}

#[cfg(feature = "hardware")]
mod end {
    use super::receive;
    use core::cell::{RefCell, UnsafeCell};
    use critical_section::Mutex;
    use heapless::Deque;
    use stm32f4::stm32f405::{DMA2, Interrupt, Peripherals, USART1, interrupt};

    /// Stream and channel of USART1's receiver (RM0090, table 43).
    const STREAM: usize = 2;
    const CHANNEL: u8 = 4;

    /// Bytes of the ring. The ring holds the bytes that arrive during the erase of a sector (half a second),
    /// from a sender that waits for answers.
    const RING: usize = 1024;

    /// 84 MHz divided by 115,200 baud.
    const BAUD: u16 = 729;

    struct Ring(UnsafeCell<[u8; RING]>);

    // SAFETY: only DMA writes to this memory.
    unsafe impl Sync for Ring {}

    static BYTES: Ring = Ring(UnsafeCell::new([0; RING]));

    /// Number of bytes read from the ring, modulo its size.
    static TAKEN: Mutex<RefCell<usize>> = Mutex::new(RefCell::new(0));

    /// Answers that wait for output.
    static ANSWERS: Mutex<RefCell<Deque<u8, 1024>>> = Mutex::new(RefCell::new(Deque::new()));

    pub fn start(board: &Peripherals) {
        let Peripherals { RCC: rcc, GPIOA: port, DMA2: dma, USART1: line, .. } = board;
        rcc.ahb1enr().modify(|_, w| w.gpioaen().set_bit().dma2en().set_bit());
        port.afrh().modify(|_, w| w.afrh9().af7().afrh10().af7());
        port.pupdr().modify(|_, w| w.pupdr10().pull_up());
        port.moder().modify(|_, w| w.moder9().alternate().moder10().alternate());
        let stream = dma.st(STREAM);
        // SAFETY: the address of the data register, and of a static ring.
        stream.par().write(|w| unsafe { w.bits(line.dr().as_ptr() as u32) });
        stream.m0ar().write(|w| unsafe { w.bits(BYTES.0.get() as u32) });
        stream.ndtr().write(|w| w.ndt().set(RING as u16));
        stream.cr().write(|w| w.chsel().set(CHANNEL).minc().set_bit().circ().set_bit().en().set_bit());
        line.brr().write(|w| w.div_mantissa().set(BAUD >> 4).div_fraction().set((BAUD & 15) as u8));
        line.cr3().write(|w| w.dmar().set_bit());
        line.cr1().write(|w| w.ue().set_bit().re().set_bit().te().set_bit().idleie().set_bit());
        // SAFETY: no critical section depends on the mask.
        unsafe { cortex_m::peripheral::NVIC::unmask(Interrupt::USART1) };
    }

    /// Passes the received bytes to the controller's input.
    pub fn drain() {
        // SAFETY: a read.
        let left = usize::from(unsafe { &*DMA2::ptr() }.st(STREAM).ndtr().read().ndt().bits());
        let put = RING.saturating_sub(left) % RING;
        receive(|receiver| {
            critical_section::with(|cs| {
                let Ok(mut taken) = TAKEN.borrow(cs).try_borrow_mut() else { return };
                while *taken != put {
                    // SAFETY: the index is inside the ring. DMA is ahead by less than the ring, or bytes are
                    // lost anyway.
                    let byte = unsafe { BYTES.0.get().cast::<u8>().add(*taken % RING).read_volatile() };
                    receiver.push(byte);
                    *taken = (*taken + 1) % RING;
                }
            });
        });
    }

    /// The line is idle after bytes, or can take the next byte of an answer.
    #[interrupt]
    fn USART1() {
        // SAFETY: registers of this interrupt; only critical sections change the bit for answers.
        let line = unsafe { &*USART1::ptr() };
        let status = line.sr().read();
        if status.idle().bit_is_set() {
            // Reading both registers clears the flag. DMA has already read the byte.
            let _ = line.dr().read();
            drain();
        }
        if status.txe().bit_is_set() {
            critical_section::with(|cs| {
                let next =
                    ANSWERS.borrow(cs).try_borrow_mut().ok().and_then(|mut answers| answers.pop_front());
                match next {
                    Some(byte) => _ = line.dr().write(|w| w.dr().set(byte.into())),
                    None => _ = line.cr1().modify(|_, w| w.txeie().clear_bit()),
                }
            });
        }
    }

    /// Answers.
    pub struct Line;

    impl embedded_io::Write for Line {
        /// Takes as many bytes as fit, and waits while there is no room.
        fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
            loop {
                let count = critical_section::with(|cs| {
                    let Ok(mut answers) = ANSWERS.borrow(cs).try_borrow_mut() else { return 0 };
                    let mut count = 0;
                    while let Some(byte) = bytes.get(count)
                        && answers.push_back(*byte).is_ok()
                    {
                        count += 1;
                    }
                    // SAFETY: inside a critical section.
                    unsafe { &*USART1::ptr() }.cr1().modify(|_, w| w.txeie().set_bit());
                    count
                });
                if count > 0 || bytes.is_empty() {
                    return Ok(count);
                }
            }
        }

        fn flush(&mut self) -> Result<(), Self::Error> {
            Ok(())
        }
    }
}

#[cfg(not(feature = "hardware"))]
mod end {
    use super::receive;
    use stm32f4::stm32f405::{Interrupt, Peripherals, USART1, interrupt};

    /// 16 MHz divided by 115,200 baud.
    const BAUD: u16 = 139;

    pub fn start(board: &Peripherals) {
        let line = &board.USART1;
        line.brr().write(|w| w.div_mantissa().set(BAUD >> 4).div_fraction().set((BAUD & 15) as u8));
        line.cr1().write(|w| w.ue().set_bit().re().set_bit().te().set_bit().rxneie().set_bit());
        // SAFETY: no critical section depends on the mask.
        unsafe { cortex_m::peripheral::NVIC::unmask(Interrupt::USART1) };
    }

    #[interrupt]
    fn USART1() {
        // SAFETY: only this interrupt reads the data register.
        let byte = unsafe { &*USART1::ptr() }.dr().read().dr().bits() as u8;
        receive(|receiver| receiver.push(byte));
    }

    /// Answers. The emulator's serial line takes each byte at once.
    pub struct Line;

    impl embedded_io::Write for Line {
        fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
            for byte in bytes {
                // SAFETY: only the task writes to the data register.
                unsafe { &*USART1::ptr() }.dr().write(|w| w.dr().set(u16::from(*byte)));
            }
            Ok(bytes.len())
        }

        fn flush(&mut self) -> Result<(), Self::Error> {
            Ok(())
        }
    }
}
