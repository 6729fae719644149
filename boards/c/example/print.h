// Messages by semihosting, which QEMU and a debug probe understand.
#include <stdint.h>

void print(const char *text);
void print_number(uint32_t number);
void print_hex(uint64_t number);

// Ends the emulator.
void succeeded(void);
void failed(void);
