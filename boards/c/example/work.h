// What the examples do between two ticks: text arrives, functions are carried out, somebody presses buttons, the planner plans.
#include "glidepath.h"

// Opens the library.
void begin(void);

// In the timer interrupt.
void tick(void);

// In the interrupt of the serial line, and what starts that.
void receive(uint8_t byte);
void start_line(void);

// Once per cycle, between two ticks.
void functions(void);
void panel(void);
void plan(void);
