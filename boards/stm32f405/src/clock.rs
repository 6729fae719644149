//! 168 MHz from a crystal of 8 MHz: AHB 168, APB1 42 (timers 84), APB2 84 MHz.
use stm32f4::stm32f405::{FLASH, RCC};

/// Starts crystal and PLL, and switches the clock. Waits for ever without a crystal, because the axes must
/// not move without the right time base.
pub fn start(rcc: &RCC, flash: &FLASH) {
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    while rcc.cr().read().hserdy().bit_is_clear() {}
    // 8 MHz / 8 · 336 / 2 = 168 MHz; 336 MHz / 7 = 48 MHz.
    // SAFETY: the values are inside the ranges of the reference manual (M 2…63, N 50…432, Q 2…15).
    rcc.pllcfgr()
        .write(|w| unsafe { w.pllsrc().hse().pllm().bits(8).plln().bits(336).pllp().div2().pllq().bits(7) });
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    // Five wait states at 168 MHz and 2.7…3.6 V, set before the switch.
    flash.acr().write(|w| w.latency().ws5().prften().set_bit().icen().set_bit().dcen().set_bit());
    rcc.cfgr().modify(|_, w| w.hpre().div1().ppre1().div4().ppre2().div2());
    while rcc.cr().read().pllrdy().bit_is_clear() {}
    rcc.cfgr().modify(|_, w| w.sw().pll());
    while !rcc.cfgr().read().sws().is_pll() {}
}
