#include "work.h"

#include "machine.h"
#include "print.h"

#include <stdbool.h>

// The sender puts END_OF_PART behind each part of the program, and sends the next one when it has seen how far that is.
#define PART (GP_WINDOW / 2)
#define END_OF_PART 3

// Cycles that M26 takes, and that somebody holds the motion.
#define CARRIED_OUT 50
#define HELD 100

static gp_storage storage;
static gp_handles gp;

// Parts that arrived whole: M26 waits for one.
static volatile uint32_t parts;

// The program has ended, and all of it is with the interpolator.
static volatile bool is_planned;

// Ends with a message where something must not happen.
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

// Where a board writes to its drives.
static void to_the_drives(const int64_t set_points[GP_AXES]) {
    __asm volatile("" ::"r"(set_points) : "memory");
}

// The checksum over all set points of all ticks that the host has too: FNV-1a over their halves.
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
    // The set points of the cycle before: their moment does not depend on how long the next ones take.
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

// A byte arrives. The window gets a part of the program when that is whole.
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

// Carries functions out. The motion stands at M26 until a part of the program has arrived, and 50 cycles more.
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

// Somebody presses buttons: half the speed at N40, a feed hold at N60, and on again.
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
            // The line is left out, what was planned before it stays valid.
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
