#include "work.h"

#include "machine.h"
#include "print.h"

#include <stdbool.h>

// The sender puts END_OF_PART after each part of the program, and sends the next part when the example
// reports its progress.
#define PART (GP_WINDOW / 2)
#define END_OF_PART 3

// Cycles until M26 is acknowledged, and length of the feed hold in cycles.
#define CARRIED_OUT 50
#define HELD 100

static gp_storage storage;
static gp_handles gp;

// Number of complete parts: M26 waits for a part.
static volatile uint32_t parts;

// The program has ended, and all motion is in the queue.
static volatile bool is_planned;

// Ends with a message if an unexpected result occurs.
static void want(gp_result result, const char *what) {
    if (result != GP_RESULT_OK) {
        print(what);
        print(": ");
        print(gp_result_name(result));
        print("\n");
        failed();
    }
}

void begin(void) {
    static gp_machine machine;
    static const int64_t start[GP_AXES];
    machine_data(&machine);
    int32_t axis;
    char message[200];
    if (gp_check(&machine, &axis, message, sizeof message) != GP_RESULT_OK) {
        print(message);
        failed();
    }
    want(gp_open(&storage, sizeof storage, &machine, start, &gp), "gp_open");
    want(gp_load_window(gp.planner), "gp_load_window");
}

// A board writes to its drives here.
static void to_the_drives(const int64_t set_points[GP_AXES]) {
    __asm volatile("" ::"r"(set_points) : "memory");
}

// The checksum over all set points of all ticks, FNV-1a over their halves. The PC computes the same checksum.
static uint64_t digest_of(uint64_t digest, const int64_t set_points[GP_AXES]) {
    for (int k = 0; k < GP_AXES; k++) {
        const uint64_t bits = (uint64_t)set_points[k];
        digest = (digest ^ (bits & 0xffffffffu)) * 0x100000001b3u;
        digest = (digest ^ (bits >> 32)) * 0x100000001b3u;
    }
    return digest;
}

void tick(void) {
    static uint32_t ticks;
    static uint64_t digest = 0xcbf29ce484222325u;
    int64_t set_points[GP_AXES];
    gp_state state;
    // Outputs the set points of the previous cycle first, so the moment of output does not depend on the
    // computation.
    want(gp_set_points(gp.interpolator, set_points), "gp_set_points");
    to_the_drives(set_points);
    want(gp_tick(gp.interpolator, &state), "gp_tick");
    if (state == GP_STATE_ACTIVE) {
        gp_set_points(gp.interpolator, set_points);
        ticks++;
        digest = digest_of(digest, set_points);
    } else if (is_planned) {
        print("ticks ");
        print_number(ticks);
        print(" digest ");
        print_hex(digest);
        print("\n");
        succeeded();
    }
}

// A byte arrives. Each complete part of the program goes into the window.
void receive(uint8_t byte) {
    static uint8_t part[PART];
    static size_t length;
    size_t taken;
    if (byte == END_OF_PART) {
        want(gp_feed(gp.feeder, part, length, &taken), "gp_feed");
        if (taken != length) {
            print("the sender was too early\n");
            failed();
        }
        length = 0;
        parts++;
    } else if (length < PART) {
        part[length++] = byte;
    }
}

// Carries out functions. At M26 the axes stand still until a part of the program has arrived, and 50 cycles
// more.
void functions(void) {
    static gp_due at_hand;
    static uint32_t left, seen;
    gp_due due;
    if (left == CARRIED_OUT + 1 && parts != seen) {
        seen++;
        left--;
    } else if (left > 0 && left <= CARRIED_OUT && --left == 0) {
        want(gp_acknowledge(gp.op, &at_hand.function), "gp_acknowledge");
    }
    while (gp_output(gp.op, &due) == GP_RESULT_OK) {
        print("N");
        print_number(due.n);
        print(" M");
        print_number(due.function.number);
        print("\n");
        if (due.waits) {
            at_hand = due;
            left = CARRIED_OUT + 1;
        }
    }
}

// Simulates an operator: half the speed at N40, a feed hold at N60, and a resume.
void panel(void) {
    static int step;
    static uint32_t rested;
    gp_status_data status;
    want(gp_status(gp.op, &status), "gp_status");
    if (step == 0 && status.n == 40) {
        want(gp_set_override(gp.op, 500), "gp_set_override");
        step = 1;
    } else if (step == 1 && status.n == 60) {
        want(gp_feed_hold(gp.op), "gp_feed_hold");
        step = 2;
    } else if (step == 2 && status.state == GP_STATE_IDLE && ++rested == HELD) {
        want(gp_set_override(gp.op, 1000), "gp_set_override");
        want(gp_resume(gp.op), "gp_resume");
        step = 3;
    }
}

// Plans until the queue is full.
void plan(void) {
    gp_progress progress = GP_PROGRESS_WORKING;
    gp_place place;
    char message[200];
    do {
        if (gp_poll(gp.planner, &progress) == GP_RESULT_REFUSED) {
            // The line is left out; motion that was planned before stays valid.
            gp_message(gp.planner, &place, message, sizeof message);
            print("line ");
            print_number(place.line);
            print(": ");
            print(message);
            print("\n");
        }
    } while (progress != GP_PROGRESS_WAITING && progress != GP_PROGRESS_DONE);
    is_planned = progress == GP_PROGRESS_DONE;
}
