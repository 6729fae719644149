//! The timer interrupt, and the output of port words to the pins.
//!
//! On a board TIM1 requests a word from DMA2 every 5 µs. The stream has two buffers and switches between
//! both. The interrupt of the stream is the tick, and fills the buffer that is already output. QEMU has
//! neither TIM1 requests nor DMA, so there the interrupt of TIM2 is the tick, and the words are dropped.
#[cfg(not(feature = "hardware"))]
pub use emulated::{start, stop};
#[cfg(feature = "hardware")]
pub use pins::{slot, start, stop};

#[cfg(feature = "hardware")]
mod pins {
    use crate::inputs;
    use crate::machine::{AXES, SLOTS};
    use crate::tick;
    use core::cell::UnsafeCell;
    use stm32f4::stm32f405::{DMA2, Interrupt, Peripherals, TIM1, interrupt};

    /// Stream and channel of TIM1's update (RM0090, table 43).
    const STREAM: usize = 5;
    const CHANNEL: u8 = 6;

    /// 168 MHz, 5 µs per word.
    const PERIOD: u16 = 840;

    /// The pins of the motors.
    const PINS: u8 = 2 * AXES as u8;

    /// The two halves: DMA reads one half while the interrupt writes the other. The memory must be accessible
    /// for DMA.
    struct Halves(UnsafeCell<[[u32; SLOTS]; 2]>);

    // SAFETY: only the interrupt of the stream writes to this memory.
    unsafe impl Sync for Halves {}

    static HALVES: Halves = Halves(UnsafeCell::new([[0; SLOTS]; 2]));

    /// Starts timer and stream; `rest` is the word for the idle level of the pins before they become outputs.
    pub fn start(board: &Peripherals, rest: u32) {
        let Peripherals { RCC: rcc, DMA2: dma, TIM1: timer, GPIOC: port, .. } = board;
        rcc.ahb1enr().modify(|_, w| w.gpiocen().set_bit().dma2en().set_bit());
        rcc.apb2enr().modify(|_, w| w.tim1en().set_bit());
        // SAFETY: any word may go to this register.
        port.bsrr().write(|w| unsafe { w.bits(rest) });
        for pin in 0..PINS {
            // SAFETY: two bits for each pin: output, fast.
            port.moder().modify(|r, w| unsafe { w.bits(r.bits() & !(3 << (2 * pin)) | 1 << (2 * pin)) });
            port.ospeedr().modify(|r, w| unsafe { w.bits(r.bits() | 2 << (2 * pin)) });
        }
        let [first, second] = [0, 1].map(|half| HALVES.0.get() as u32 + half * 4 * SLOTS as u32);
        let stream = dma.st(STREAM);
        // SAFETY: the addresses of the port's register and of static buffers.
        stream.par().write(|w| unsafe { w.bits(port.bsrr().as_ptr() as u32) });
        stream.m0ar().write(|w| unsafe { w.bits(first) });
        stream.m1ar().write(|w| unsafe { w.bits(second) });
        stream.ndtr().write(|w| w.ndt().set(SLOTS as u16));
        stream.cr().write(|w| {
            w.chsel().set(CHANNEL).pl().very_high().msize().bits32().psize().bits32();
            w.minc().set_bit().circ().set_bit().dbm().set_bit().dir().memory_to_peripheral();
            w.tcie().set_bit().en().set_bit()
        });
        timer.arr().write(|w| w.arr().set(PERIOD - 1));
        timer.dier().write(|w| w.ude().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        // SAFETY: no critical section depends on the mask.
        unsafe { cortex_m::peripheral::NVIC::unmask(Interrupt::DMA2_STREAM5) };
    }

    /// Stops the output of words. For faults: pins keep their level, and drivers see no edge.
    pub fn stop() {
        // SAFETY: writes that stop timer and stream.
        let (timer, dma) = unsafe { (&*TIM1::ptr(), &*DMA2::ptr()) };
        timer.cr1().write(|w| w.cen().clear_bit());
        dma.st(STREAM).cr().write(|w| w.en().clear_bit());
    }

    /// Number of words of this tick that are already output.
    pub fn slot() -> u16 {
        // SAFETY: a read.
        let left = unsafe { &*DMA2::ptr() }.st(STREAM).ndtr().read().ndt().bits();
        (SLOTS as u16).saturating_sub(left)
    }

    /// A buffer has been output.
    #[interrupt]
    fn DMA2_STREAM5() {
        // SAFETY: only this interrupt clears its flag; the other accesses are reads.
        let dma = unsafe { &*DMA2::ptr() };
        let begin = cortex_m::peripheral::DWT::cycle_count();
        dma.hifcr().write(|w| w.ctcif5().clear());
        let reads_second = dma.st(STREAM).cr().read().ct().bit_is_set();
        // SAFETY: DMA reads the other half, and no other code writes.
        let [first, second] = unsafe { &mut *HALVES.0.get() };
        let words = if reads_second { first } else { second };
        crate::serial::drain();
        tick::with(|tick| {
            tick.run(words, inputs::read);
            let took = cortex_m::peripheral::DWT::cycle_count().wrapping_sub(begin);
            tick.counts.longest = tick.counts.longest.max(took);
            let is_late = dma.hisr().read().tcif5().bit_is_set();
            tick.counts.missed = tick.counts.missed.wrapping_add(u32::from(is_late));
        })
        // Without a machine no axis moves.
        .unwrap_or_else(|| words.fill(0));
    }
}

#[cfg(not(feature = "hardware"))]
mod emulated {
    use crate::inputs;
    use crate::machine::{CYCLE_US, SLOTS};
    use crate::tick;
    use stm32f4::stm32f405::{Interrupt, Peripherals, TIM2, interrupt};

    /// The emulator's timer always runs at 1 GHz; a board without a crystal has 16 MHz.
    const TIMER_MHZ: u32 = if cfg!(feature = "qemu") { 1000 } else { 16 };

    /// Starts the timer.
    pub fn start(board: &Peripherals, _rest: u32) {
        board.RCC.apb1enr().modify(|_, w| w.tim2en().set_bit());
        let timer = &board.TIM2;
        // Counter and prescaler are zero after reset, so no update event is needed.
        timer.arr().write(|w| w.arr().set(CYCLE_US * TIMER_MHZ - 1));
        timer.dier().write(|w| w.uie().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        // SAFETY: no critical section depends on the mask.
        unsafe { cortex_m::peripheral::NVIC::unmask(Interrupt::TIM2) };
    }

    /// Stops the ticks.
    pub fn stop() {
        // SAFETY: a write that stops the timer.
        unsafe { &*TIM2::ptr() }.cr1().write(|w| w.cen().clear_bit());
    }

    #[interrupt]
    fn TIM2() {
        static mut WORDS: [u32; SLOTS] = [0; SLOTS];
        // SAFETY: registers of this interrupt.
        let timer = unsafe { &*TIM2::ptr() };
        let begin = timer.cnt().read().bits();
        timer.sr().modify(|_, w| w.uif().clear_bit());
        tick::with(|tick| {
            tick.run(WORDS, inputs::read);
            // The words are treated as sent, so that the compiler keeps the computation.
            core::hint::black_box(&*WORDS);
            let took = timer.cnt().read().bits().wrapping_sub(begin);
            tick.counts.longest = tick.counts.longest.max(took);
            let is_late = timer.sr().read().uif().bit_is_set();
            tick.counts.missed = tick.counts.missed.wrapping_add(u32::from(is_late));
        });
    }
}
