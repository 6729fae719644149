// Start-up code of an STM32F405: vectors, static memory, floating-point unit. A vendor's start-up file has
// the same task.
#include <stdint.h>

extern uint32_t _sidata[], _sdata[], _edata[], _sbss[], _ebss[], _stack_start[];

int main(void);
void SysTick_Handler(void);
void SVC_Handler(void);
void PendSV_Handler(void);
void TIM2_Handler(void);
void USART1_Handler(void);
void Reset_Handler(void);
void failed(void);

static void Default_Handler(void) {
    failed();
}

#pragma weak SVC_Handler = Default_Handler
#pragma weak PendSV_Handler = Default_Handler
#pragma weak SysTick_Handler = Default_Handler
#pragma weak TIM2_Handler = Default_Handler

__attribute__((section(".vectors"), used)) static void (*const vectors[16 + 38])(void) = {
    (void (*)(void))_stack_start,
    Reset_Handler,
    Default_Handler, // NMI
    Default_Handler, // HardFault
    Default_Handler, Default_Handler, Default_Handler, 0, 0, 0, 0,
    SVC_Handler,
    Default_Handler, 0,
    PendSV_Handler,
    SysTick_Handler,
    [16 + 28] = TIM2_Handler,
    [16 + 37] = USART1_Handler,
};

void Reset_Handler(void) {
    // CPACR: full access to the floating-point unit, which the library needs.
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20;
    __asm volatile("dsb\n isb");
    for (uint32_t *to = _sdata, *from = _sidata; to < _edata;) {
        *to++ = *from++;
    }
    for (uint32_t *to = _sbss; to < _ebss;) {
        *to++ = 0;
    }
    main();
    failed();
}
