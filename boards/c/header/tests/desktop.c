// The example of the target on a PC: the same work, with a loop in place of the timer interrupt, and a file, the first argument,
// in place of the serial line.
#include "print.h"
#include "work.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char program[1000];
static uint32_t n;

void print(const char *text) {
    fputs(text, stdout);
}

void print_number(uint32_t number) {
    n = number > n ? number : n;
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

static void send(const char *from, const char *to) {
    while (from < to) {
        receive((uint8_t)*from++);
    }
    receive(3);
}

int main(int count, char **arguments) {
    FILE *file = count == 2 ? fopen(arguments[1], "rb") : NULL;
    if (file == NULL || fread(program, 1, sizeof program - 1, file) == 0) {
        return 2;
    }
    fclose(file);
    const char *const second = strstr(program, "N90");
    const char *const end = program + strlen(program);
    begin();
    send(program, second);
    for (int is_sent = 0;;) {
        if (n >= 80 && !is_sent) {
            send(second, end);
            is_sent = 1;
        }
        functions();
        panel();
        plan();
        tick();
    }
}
