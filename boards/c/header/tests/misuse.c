// Every way to misuse the C interface that it can see: each has its own answer, and nothing is read or written that must not be.
#include "glidepath.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>

static int checks;

#define IS(wanted, call)                                                                                               \
    do {                                                                                                               \
        const gp_result got = (call);                                                                                  \
        checks++;                                                                                                      \
        if (got != (wanted)) {                                                                                         \
            printf("line %d: %s\n  answers \"%s\", expected \"%s\"\n", __LINE__, #call, gp_result_name(got),           \
                   gp_result_name(wanted));                                                                            \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

#define WANT(what)                                                                                                     \
    do {                                                                                                               \
        checks++;                                                                                                      \
        if (!(what)) {                                                                                                 \
            printf("line %d: %s\n", __LINE__, #what);                                                                  \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

static gp_storage storage;
static gp_handles gp;
static gp_machine machine;
static const int64_t start[GP_AXES];
static char message[300];

// Plans and ticks until the axes stand and nothing is left to do, or a line is refused.
static gp_result run(void) {
    for (;;) {
        gp_progress progress;
        const gp_result result = gp_poll(gp.planner, &progress);
        if (result != GP_RESULT_OK) {
            return result;
        }
        if (progress == GP_PROGRESS_WAITING || progress == GP_PROGRESS_DONE) {
            gp_state state;
            uint32_t is_at_rest;
            IS(GP_RESULT_OK, gp_tick(gp.interpolator, &state));
            IS(GP_RESULT_OK, gp_is_at_rest(gp.planner, &is_at_rest));
            if (progress == GP_PROGRESS_DONE && state == GP_STATE_IDLE && is_at_rest) {
                return GP_RESULT_OK;
            }
        }
    }
}

static void refused(const char *words, int32_t axis) {
    int32_t wrong = 99;
    IS(GP_RESULT_MACHINE_DATA, gp_check(&machine, &wrong, message, sizeof message));
    if (strstr(message, words) == NULL || wrong != axis) {
        printf("\"%s\", axis %d; expected \"%s\", axis %d\n", message, (int)wrong, words, (int)axis);
        exit(1);
    }
    IS(GP_RESULT_MACHINE_DATA, gp_open(&storage, sizeof storage, &machine, start, &gp));
    gp_machine_defaults(&machine);
}

static void machine_data(void) {
    IS(GP_RESULT_NULL, gp_machine_defaults(NULL));
    IS(GP_RESULT_OK, gp_machine_defaults(&machine));
    IS(GP_RESULT_NULL, gp_check(NULL, NULL, NULL, 0));
    IS(GP_RESULT_OK, gp_check(&machine, NULL, NULL, 0));
    machine.axes[1].a_beschl = 5000;
    refused("axes[1]: slope_profil.a_beschl (P-AXIS-00001) = 5000 is outside 1…1000, bound by dynamik.a_max", 1);
    machine.axes[2].vb_max = 0;
    refused("axes[2]: dynamik.vb_max (P-AXIS-00212) = 0", 2);
    machine.axes[0].swe_neg = machine.axes[0].swe_pos;
    refused("axes[0]: kenngr.swe_neg (P-AXIS-00177)", 0);
    memset(machine.axes[0].name, 0, sizeof machine.axes[0].name);
    refused("axes[0]: name; expected one to four letters", 0);
    machine.axes[0].name[0] = (char)0xff;
    refused("axes[0]: name", 0);
    machine.axes[0].name[0] = 'F';
    refused("axis F: F is an address of the language", -1);
    machine.axes[1].name[0] = 'X';
    refused("two axes are called X", -1);
    machine.axes[1].kind = 7;
    refused("axes[1]: kind = 7; expected 0 linear, 1 rotary or 2 spindle", 1);
    machine.axes[2].default_feed_axis = 2;
    refused("default_feed_axis (P-CHAN-00011) = 2; expected 0 or 1", 2);
    machine.channel.slope_profile = 4 + 256;
    refused("prog_start.slope.profile (P-CHAN-00071)", -1);
    machine.channel.surface = 9;
    refused("surface (P-CHAN-00600) = 9; expected 0 or 1", -1);
    machine.channel.look_ahead = GP_BLOCKS + 1;
    refused("look_ahead (P-STUP-00071)", -1);
    machine.channel.vector_velocity_milli = UINT64_MAX;
    refused("vector.velocity (P-CHAN-00090)", -1);
    machine.channel.m_synch.count = GP_SYNCHRONISED + 1;
    refused("m_synch (P-CHAN-00041) = 33; expected 32 functions at most", -1);
    machine.channel.h_synch.count = 1;
    machine.channel.h_synch.functions[0].kind = 3;
    refused("h_synch (P-CHAN-00027) = 3; expected a synchronisation", -1);
    machine.channel.m_synch.count = 1;
    machine.channel.m_synch.functions[0].code = 65536;
    refused("m_synch (P-CHAN-00041) = 65536; expected a function up to 65535", -1);
    machine.axes[1].filter.enable = 3;
    refused("axes[1]: filter_fir.enable (P-AXIS-00573) = 3; expected 0 or 1", 1);
    machine.axes[2].filter.kind = 5;
    refused("axes[2]: filter_fir.type (P-AXIS-00586) = 5; expected 0…4", 2);
    machine.axes[0].filter.order = 201;
    refused("filter_fir.order (P-AXIS-00587)", 0);
    machine.axes[0].filter.share = 300;
    refused("filter_fir.share (P-AXIS-00590)", 0);
    machine.axes[0].filter.quality_milli = 70000;
    refused("filter_fir.quality (P-AXIS-00593)", 0);
    machine.axes[1].filter.enable = 1;
    machine.axes[1].filter.kind = 1;
    machine.axes[1].filter.order = GP_TAPS;
    refused("axes[1]: ", 1);
    machine.channel.m_synch.count = 1;
    machine.channel.m_synch.functions[0].kind = 0x4000;
    refused("MVS_SLM is known, not available", -1);
}

// A message is cut at a letter, and ends inside its memory.
static void messages(void) {
    machine.axes[1].a_beschl = 5000;
    gp_check(&machine, NULL, message, sizeof message);
    const size_t length = strlen(message);
    for (size_t size = 0; size <= length + 2; size++) {
        char *part = malloc(size + 1); // valgrind sees what is written behind
        memset(part, 'x', size + 1);
        IS(GP_RESULT_MACHINE_DATA, gp_check(&machine, NULL, part, size));
        WANT(part[size] == 'x');
        WANT(size == 0 || (strlen(part) < size && strncmp(part, message, strlen(part)) == 0));
        free(part);
    }
    gp_machine_defaults(&machine);
}

static void opening(void) {
    IS(GP_RESULT_NULL, gp_open(NULL, sizeof storage, &machine, start, &gp));
    IS(GP_RESULT_NULL, gp_open(&storage, sizeof storage, NULL, start, &gp));
    IS(GP_RESULT_NULL, gp_open(&storage, sizeof storage, &machine, NULL, &gp));
    IS(GP_RESULT_NULL, gp_open(&storage, sizeof storage, &machine, start, NULL));
    IS(GP_RESULT_SIZE, gp_open(&storage, sizeof storage - 8, &machine, start, &gp));
    IS(GP_RESULT_SIZE, gp_open(&storage, 0, &machine, start, &gp));
    IS(GP_RESULT_ALIGNMENT, gp_open((gp_storage *)((char *)&storage + 4), sizeof storage, &machine, start, &gp));
    const int64_t far[GP_AXES] = {GP_POSITION(100001.0)};
    IS(GP_RESULT_RANGE, gp_open(&storage, sizeof storage, &machine, far, &gp));
    IS(GP_RESULT_CLOSED, gp_close(&storage, sizeof storage));
    IS(GP_RESULT_NULL, gp_close(NULL, sizeof storage));
    IS(GP_RESULT_SIZE, gp_close(&storage, 8));
    IS(GP_RESULT_OK, gp_open(&storage, sizeof storage, &machine, start, &gp));
    IS(GP_RESULT_TWICE, gp_open(&storage, sizeof storage, &machine, start, &gp));
}

static void nulls_and_handles(void) {
    gp_progress progress;
    gp_state state;
    gp_due due;
    gp_status_data status;
    gp_function function = {GP_M_FUNCTION, 3, 0};
    int64_t set_points[GP_AXES];
    size_t taken;
    uint32_t number;
    const uint8_t bytes[1] = {'G'};
    IS(GP_RESULT_NULL, gp_poll(NULL, &progress));
    IS(GP_RESULT_NULL, gp_poll(gp.planner, NULL));
    IS(GP_RESULT_NULL, gp_load(NULL, "M30", 3));
    IS(GP_RESULT_NULL, gp_load(gp.planner, NULL, 3));
    IS(GP_RESULT_RANGE, gp_load(gp.planner, "M30", (size_t)-1));
    IS(GP_RESULT_NULL, gp_continue_with(gp.planner, NULL, 3));
    IS(GP_RESULT_RANGE, gp_continue_with(gp.planner, "M30", (size_t)1 << 31));
    IS(GP_RESULT_NULL, gp_load_window(NULL));
    IS(GP_RESULT_NULL, gp_load_next(NULL));
    IS(GP_RESULT_NULL, gp_go_on(NULL));
    IS(GP_RESULT_NULL, gp_message(NULL, NULL, NULL, 0));
    IS(GP_RESULT_NULL, gp_is_at_rest(NULL, &number));
    IS(GP_RESULT_NULL, gp_is_at_rest(gp.planner, NULL));
    IS(GP_RESULT_NULL, gp_set_position(NULL, 0, 0));
    IS(GP_RESULT_NULL, gp_set_zero_offset(NULL, 0, 0, 0));
    IS(GP_RESULT_NULL, gp_move_axis(NULL, 0, 0, 0));
    IS(GP_RESULT_NULL, gp_stop_axis(NULL, 0));
    IS(GP_RESULT_NULL, gp_wakes_after(NULL, &number));
    IS(GP_RESULT_NULL, gp_wakes_after(gp.planner, NULL));
    IS(GP_RESULT_NULL, gp_tick(NULL, &state));
    IS(GP_RESULT_NULL, gp_set_points(NULL, set_points));
    IS(GP_RESULT_NULL, gp_set_points(gp.interpolator, NULL));
    IS(GP_RESULT_NULL, gp_output(NULL, &due));
    IS(GP_RESULT_NULL, gp_output(gp.op, NULL));
    IS(GP_RESULT_NULL, gp_acknowledge(NULL, &function));
    IS(GP_RESULT_NULL, gp_acknowledge(gp.op, NULL));
    IS(GP_RESULT_NULL, gp_status(NULL, &status));
    IS(GP_RESULT_NULL, gp_status(gp.op, NULL));
    IS(GP_RESULT_NULL, gp_feed_hold(NULL));
    IS(GP_RESULT_NULL, gp_resume(NULL));
    IS(GP_RESULT_NULL, gp_abort(NULL));
    IS(GP_RESULT_NULL, gp_set_override(NULL, 1000));
    IS(GP_RESULT_NULL, gp_set_reduced(NULL, 1));
    IS(GP_RESULT_NULL, gp_feed(NULL, bytes, 1, &taken));
    IS(GP_RESULT_NULL, gp_feed(gp.feeder, NULL, 1, &taken));
    IS(GP_RESULT_NULL, gp_feed(gp.feeder, bytes, 1, NULL));
    IS(GP_RESULT_RANGE, gp_feed(gp.feeder, bytes, (size_t)1 << 31, &taken));
    IS(GP_RESULT_NULL, gp_feed_end(NULL));
    IS(GP_RESULT_NULL, gp_feed_restart(NULL));
    // One handle in place of another.
    IS(GP_RESULT_CLOSED, gp_tick((gp_interpolator *)gp.planner, &state));
    IS(GP_RESULT_CLOSED, gp_poll((gp_planner *)gp.op, &progress));
    IS(GP_RESULT_CLOSED, gp_feed_hold((gp_operator *)gp.feeder));
    IS(GP_RESULT_CLOSED, gp_feed_end((gp_feeder *)gp.interpolator));
    // The state need not be asked for.
    IS(GP_RESULT_OK, gp_tick(gp.interpolator, NULL));
}

static void wrong_order(void) {
    gp_progress progress;
    gp_due due;
    gp_place place;
    gp_function function = {GP_M_FUNCTION, 3, 0};
    IS(GP_RESULT_NOTHING, gp_message(gp.planner, &place, message, sizeof message));
    IS(GP_RESULT_NOTHING, gp_output(gp.op, &due));
    IS(GP_RESULT_UNEXPECTED, gp_acknowledge(gp.op, &function));
    function.number = 65536;
    IS(GP_RESULT_RANGE, gp_acknowledge(gp.op, &function));
    function.kind = 4;
    IS(GP_RESULT_RANGE, gp_acknowledge(gp.op, &function));
    IS(GP_RESULT_NOTHING_REFUSED, gp_go_on(gp.planner));
    IS(GP_RESULT_RANGE, gp_set_position(gp.planner, GP_AXES, 0));
    IS(GP_RESULT_RANGE, gp_set_position(gp.planner, 0, INT64_MIN));
    IS(GP_RESULT_RANGE, gp_set_zero_offset(gp.planner, 6, 0, 0));
    IS(GP_RESULT_RANGE, gp_stop_axis(gp.planner, GP_AXES));
    static const char program[] = "N10 G01 X10 F1000\nN20 Y10 Q7\nN30 Y5\nM30\n";
    IS(GP_RESULT_OK, gp_load(gp.planner, program, sizeof program - 1));
    for (int k = 0; k < 20; k++) {
        gp_poll(gp.planner, &progress);
    }
    gp_tick(gp.interpolator, NULL);
    IS(GP_RESULT_NOT_AT_REST, gp_load(gp.planner, program, sizeof program - 1));
    IS(GP_RESULT_NOT_AT_REST, gp_continue_with(gp.planner, program, sizeof program - 1));
    IS(GP_RESULT_NOT_AT_REST, gp_load_window(gp.planner));
    IS(GP_RESULT_NOT_AT_REST, gp_load_next(gp.planner));
    IS(GP_RESULT_NOT_AT_REST, gp_set_position(gp.planner, 0, 0));
    IS(GP_RESULT_NOT_AT_REST, gp_set_zero_offset(gp.planner, 0, 0, 0));
    IS(GP_RESULT_NOT_AT_REST, gp_move_axis(gp.planner, 0, GP_POSITION(1.0), 0));
    // The second line has been refused above, or is refused here; the first one is finished.
    const gp_result result = run();
    if (result != GP_RESULT_OK) {
        IS(GP_RESULT_REFUSED, result);
        IS(GP_RESULT_OK, run());
    }
    IS(GP_RESULT_OK, gp_message(gp.planner, &place, message, sizeof message));
    WANT(place.line == 2 && place.column == 9 && place.length == 1);
    WANT(strcmp(message, "axis Q is known, not available on this machine (axes X, Y, Z)") == 0);
    IS(GP_RESULT_OK, gp_go_on(gp.planner));
    IS(GP_RESULT_OK, run());
    int64_t set_points[GP_AXES];
    IS(GP_RESULT_OK, gp_set_points(gp.interpolator, set_points));
    WANT(set_points[0] == GP_POSITION(10.0) && set_points[1] == GP_POSITION(5.0));
    IS(GP_RESULT_OK, gp_load_window(gp.planner));
    IS(GP_RESULT_WINDOW_IS_LOADED, gp_load_window(gp.planner));
    // Back to memory, and the window is there again.
    IS(GP_RESULT_OK, gp_load(gp.planner, "M30", 3));
    IS(GP_RESULT_OK, gp_load_window(gp.planner));
    IS(GP_RESULT_OK, gp_feed_end(gp.feeder));
    IS(GP_RESULT_OK, run());
}

// Ticks until an axis stands that moves alone.
static void drive(void) {
    gp_progress progress;
    uint32_t at_rest = 0;
    for (int k = 0; k < 100000 && !at_rest; k++) {
        do {
            IS(GP_RESULT_OK, gp_poll(gp.planner, &progress));
        } while (progress != GP_PROGRESS_WAITING && progress != GP_PROGRESS_DONE);
        IS(GP_RESULT_OK, gp_tick(gp.interpolator, NULL));
        IS(GP_RESULT_OK, gp_is_at_rest(gp.planner, &at_rest));
        at_rest &= progress == GP_PROGRESS_DONE;
    }
    WANT(at_rest);
}

// An axis beside the path, and the filters of the machine data.
static void axes(void) {
    int64_t set_points[GP_AXES];
    uint32_t ticks;
    IS(GP_RESULT_OK, gp_load(gp.planner, "M30", 3));
    IS(GP_RESULT_OK, run());
    IS(GP_RESULT_OK, gp_wakes_after(gp.planner, &ticks));
    WANT(ticks == 0);
    IS(GP_RESULT_RANGE, gp_move_axis(gp.planner, GP_AXES, 0, 0));
    IS(GP_RESULT_RANGE, gp_move_axis(gp.planner, 0, 0, -1));
    IS(GP_RESULT_RANGE, gp_move_axis(gp.planner, 1 << 31, 0, 0));
    IS(GP_RESULT_RANGE, gp_move_axis(gp.planner, 0, GP_POSITION(100001.0), 0));
    IS(GP_RESULT_RANGE, gp_move_axis(gp.planner, 0, INT64_MIN, 0));
    IS(GP_RESULT_LIMIT, gp_move_axis(gp.planner, 0, GP_POSITION(-90000.0), 1));
    IS(GP_RESULT_OK, gp_move_axis(gp.planner, 2, GP_POSITION(3.5), GP_POSITION(600.0)));
    IS(GP_RESULT_NOT_AT_REST, gp_move_axis(gp.planner, 2, GP_POSITION(4.0), 0));
    drive();
    IS(GP_RESULT_OK, gp_set_points(gp.interpolator, set_points));
    WANT(set_points[2] == GP_POSITION(3.5));
    IS(GP_RESULT_OK, gp_move_axis(gp.planner, 2, GP_POSITION(50.0), 0));
    gp_progress progress;
    for (int k = 0; k < 50; k++) {
        IS(GP_RESULT_OK, gp_poll(gp.planner, &progress));
        IS(GP_RESULT_OK, gp_tick(gp.interpolator, NULL));
    }
    IS(GP_RESULT_OK, gp_stop_axis(gp.planner, 2));
    drive();
    IS(GP_RESULT_OK, gp_set_points(gp.interpolator, set_points));
    WANT(set_points[2] > GP_POSITION(3.5) && set_points[2] < GP_POSITION(49.0));
}

// A moving average delays its axis: while the motion begins, it is behind the others.
static void filters(void) {
    int64_t set_points[GP_AXES];
    gp_machine_defaults(&machine);
    machine.axes[0].filter.enable = 1;
    machine.axes[0].filter.kind = 1;
    machine.axes[0].filter.order = 20;
    IS(GP_RESULT_OK, gp_close(&storage, sizeof storage));
    IS(GP_RESULT_OK, gp_open(&storage, sizeof storage, &machine, start, &gp));
    IS(GP_RESULT_OK, gp_load(gp.planner, "G01 X10 Y10 F6000\nM30", 21));
    int first[2] = {0, 0};
    for (int k = 1; k < 100; k++) {
        gp_progress progress;
        do {
            IS(GP_RESULT_OK, gp_poll(gp.planner, &progress));
        } while (progress != GP_PROGRESS_WAITING && progress != GP_PROGRESS_DONE);
        IS(GP_RESULT_OK, gp_tick(gp.interpolator, NULL));
        IS(GP_RESULT_OK, gp_set_points(gp.interpolator, set_points));
        for (int axis = 0; axis < 2; axis++) {
            first[axis] = first[axis] == 0 && set_points[axis] > 0 ? k : first[axis];
        }
    }
    // The others wait for half of the order.
    WANT(first[0] > 0 && first[1] >= first[0] + 5 && first[1] <= first[0] + 12);
    IS(GP_RESULT_OK, run());
    gp_machine_defaults(&machine);
}

static volatile sig_atomic_t was_in_use, was_free;

static void interrupt(int signal) {
    (void)signal;
    gp_progress progress;
    const gp_result result = gp_poll(gp.planner, &progress);
    was_in_use |= result == GP_RESULT_IN_USE;
    was_free |= result == GP_RESULT_OK;
}

// A context that interrupts another one in a call with the same handle is refused, until one of each was seen.
static void two_contexts(void) {
    const struct itimerval each = {{0, 100}, {0, 100}}, never = {{0, 0}, {0, 0}};
    signal(SIGALRM, interrupt);
    setitimer(ITIMER_REAL, &each, NULL);
    for (uint32_t tries = 0; !was_in_use || !was_free; tries++) {
        gp_progress progress;
        WANT(tries < 10000000);
        IS(GP_RESULT_OK, gp_poll(gp.planner, &progress));
        for (volatile int k = 0; k < 1000; k++) {
        }
    }
    setitimer(ITIMER_REAL, &never, NULL);
}

static void closing(void) {
    gp_progress progress;
    gp_status_data status;
    size_t taken;
    const uint8_t bytes[1] = {'G'};
    IS(GP_RESULT_OK, gp_close(&storage, sizeof storage));
    IS(GP_RESULT_CLOSED, gp_close(&storage, sizeof storage));
    IS(GP_RESULT_CLOSED, gp_poll(gp.planner, &progress));
    IS(GP_RESULT_CLOSED, gp_load(gp.planner, "M30", 3));
    IS(GP_RESULT_CLOSED, gp_tick(gp.interpolator, NULL));
    IS(GP_RESULT_CLOSED, gp_status(gp.op, &status));
    IS(GP_RESULT_CLOSED, gp_feed(gp.feeder, bytes, 1, &taken));
    // Opened again, everything is as new.
    IS(GP_RESULT_OK, gp_open(&storage, sizeof storage, &machine, start, &gp));
    IS(GP_RESULT_NOTHING, gp_message(gp.planner, NULL, NULL, 0));
    IS(GP_RESULT_OK, gp_load(gp.planner, "G01 X1 F1000\nM30", 16));
    IS(GP_RESULT_OK, run());
    IS(GP_RESULT_OK, gp_close(&storage, sizeof storage));
}

int main(void) {
    machine_data();
    messages();
    opening();
    nulls_and_handles();
    wrong_order();
    axes();
    filters();
    two_contexts();
    closing();
    WANT(strcmp(gp_result_name(GP_RESULT_TWICE), "the storage is open already") == 0);
    WANT(strcmp(gp_result_name(999), "no such result") == 0);
    printf("%d checks\n", checks);
    return 0;
}
