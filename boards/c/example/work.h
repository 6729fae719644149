// What the examples do between two ticks: text arrives, functions are carried out, somebody presses buttons, the planner plans.
#include "glidepath.h"

// Opens the library.
void begin(void);

// In the timer interrupt.
void tick(void);

// Once per cycle, between two ticks.
void receive(void);
void functions(void);
void panel(void);
void plan(void);
