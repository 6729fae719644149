// The example of the target on a PC: the same work, with a loop in place of the timer interrupt.
#include "print.h"
#include "work.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

void print(const char *text) {
    fputs(text, stdout);
}

void print_number(uint32_t number) {
    printf("%" PRIu32, number);
}

void print_hex(uint64_t number) {
    printf("%016" PRIx64, number);
}

void succeeded(void) {
    exit(0);
}

void failed(void) {
    exit(1);
}

int main(void) {
    begin();
    for (;;) {
        receive();
        functions();
        panel();
        plan();
        tick();
    }
}
