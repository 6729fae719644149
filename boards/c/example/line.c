// The serial line: USART1 of an STM32F405. Its pins are a matter of the board.
#include "work.h"

static volatile uint32_t *const USART1 = (volatile uint32_t *)0x40011000u;
enum { DR = 0x04 / 4, BRR = 0x08 / 4, CR1 = 0x0c / 4 };

// The byte that asks the sender to begin.
#define READY 0x11

void USART1_Handler(void) {
    receive((uint8_t)USART1[DR]);
}

void start_line(void) {
    *(volatile uint32_t *)0x40023844u |= 1u << 4;        // RCC_APB2ENR: USART1
    ((volatile uint8_t *)0xE000E400u)[37] = 7 << 4;      // its priority: below the tick
    USART1[BRR] = 139;                                   // 16 MHz divided by 115,200 baud
    USART1[CR1] = 1u << 13 | 1u << 5 | 1u << 3 | 1u << 2; // on, interrupt for each byte, transmit, receive
    *(volatile uint32_t *)0xE000E104u = 1u << (37 - 32);
    USART1[DR] = READY;
}
