// Glidepath in a C program without an operating system, on an STM32F405 and in QEMU's netduinoplus2.
//
// SysTick is the timer interrupt, and USART1 receives the program. The main loop does the other work once per
// cycle, and sleeps.
#include "work.h"

// The clock of the core in QEMU, cycles per ms.
#define CYCLES_PER_MS 168000

static volatile uint32_t cycles;

void SysTick_Handler(void) {
    tick();
    cycles++;
}

int main(void) {
    volatile uint32_t *const systick = (volatile uint32_t *)0xE000E010u;
    begin();
    systick[1] = CYCLES_PER_MS - 1; // reload
    systick[2] = 0;                 // count
    systick[0] = 7;                 // on, with interrupt, from the core's clock
    start_line();
    for (uint32_t done = 0;;) {
        plan();
        while (done == cycles) {
            __asm volatile("wfi");
        }
        done = cycles;
        functions();
        panel();
    }
}
