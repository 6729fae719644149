// Glidepath in a FreeRTOS application, on an STM32F405 and in QEMU's netduinoplus2.
//
// | who       | priority                | owns                      |
// |-----------|-------------------------|---------------------------|
// | TIM2      | interrupt, above tasks  | the interpolator          |
// | USART1    | interrupt               | the feeder                |
// | functions | 3                       | the operator, with mutex  |
// | panel     | 2                       | the operator, with mutex  |
// | plan      | 1                       | the planner               |
#include "work.h"

#include "FreeRTOS.h"
#include "semphr.h"
#include "task.h"

// Clock of TIM2: QEMU's TIM2 has 1 GHz. A board has 16 MHz after reset.
#define TIMER_PER_CYCLE 1000000

// The planner needs the largest stack: about 4 KB, and 1 KB for a message.
#define PLAN_WORDS 2048
#define WORDS 512

static StackType_t plan_stack[PLAN_WORDS], stacks[2][WORDS];
static StaticTask_t plan_task, tasks[2];
static TaskHandle_t woken[3];
static StaticSemaphore_t operator_mutex;
static SemaphoreHandle_t operator_lock;

static volatile uint32_t *const TIM2 = (volatile uint32_t *)0x40000000u;
enum { CR1 = 0x00 / 4, DIER = 0x0c / 4, SR = 0x10 / 4, ARR = 0x2c / 4 };

void TIM2_Handler(void) {
    BaseType_t is_higher = pdFALSE;
    TIM2[SR] = 0;
    tick();
    for (int k = 0; k < 3; k++) {
        vTaskNotifyGiveFromISR(woken[k], &is_higher);
    }
    portYIELD_FROM_ISR(is_higher);
}

// Waits for the next cycle; returns at once if a cycle has begun since the last call.
static void cycle(void) {
    ulTaskNotifyTake(pdTRUE, portMAX_DELAY);
}

static void functions_task(void *unused) {
    (void)unused;
    for (;;) {
        cycle();
        xSemaphoreTake(operator_lock, portMAX_DELAY);
        functions();
        xSemaphoreGive(operator_lock);
    }
}

static void panel_task(void *unused) {
    (void)unused;
    for (;;) {
        cycle();
        xSemaphoreTake(operator_lock, portMAX_DELAY);
        panel();
        xSemaphoreGive(operator_lock);
    }
}

static void plan_task_loop(void *unused) {
    (void)unused;
    for (;;) {
        plan();
        cycle();
    }
}

static void start_timer(void) {
    *(volatile uint32_t *)0x40023840u |= 1;             // RCC_APB1ENR: TIM2
    ((volatile uint8_t *)0xE000E400u)[28] = 6 << 4;     // its priority: below configMAX_SYSCALL_INTERRUPT_PRIORITY
    TIM2[ARR] = TIMER_PER_CYCLE - 1;
    TIM2[DIER] = 1;
    TIM2[CR1] = 1;
    *(volatile uint32_t *)0xE000E100u = 1u << 28;
}

void vApplicationIdleHook(void) {
    __asm volatile("wfi");
}

int main(void) {
    begin();
    operator_lock = xSemaphoreCreateMutexStatic(&operator_mutex);
    woken[0] = xTaskCreateStatic(functions_task, "functions", WORDS, NULL, 3, stacks[0], &tasks[0]);
    woken[1] = xTaskCreateStatic(panel_task, "panel", WORDS, NULL, 2, stacks[1], &tasks[1]);
    woken[2] = xTaskCreateStatic(plan_task_loop, "plan", PLAN_WORDS, NULL, 1, plan_stack, &plan_task);
    portDISABLE_INTERRUPTS(); // until the first task runs
    start_timer();
    start_line();
    vTaskStartScheduler();
    return 1;
}
