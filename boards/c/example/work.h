// The work of the examples between two ticks: receiving text, carrying out functions, operator commands,
// planning.
#include "glidepath.h"

// Opens the library.
void begin(void);

// Call it in the timer interrupt.
void tick(void);

// Call these in the interrupt of the serial line, and to start the line.
void receive(uint8_t byte);
void start_line(void);

// Call it once per cycle, between two ticks.
void functions(void);
void panel(void);
void plan(void);
