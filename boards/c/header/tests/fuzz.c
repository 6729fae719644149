// Calls of the C interface at random: right ones, wrong ones, in any order. Arguments: number of calls, seed.
//
// Each answer has to be one that the comment of the function names. The storage lies between two pages that nobody may touch, and
// whatever a call writes lies between bytes that have to stay. Set points of a motion never jump.
#define _GNU_SOURCE
#include "glidepath.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

static uint64_t state = 1;

static uint32_t random_below(uint32_t count) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((state >> 33) % count);
}

static int one_in(uint32_t count) {
    return random_below(count) == 0;
}

static gp_storage *storage;
static gp_handles gp;
static gp_machine machine, opened;
static const int64_t start[GP_AXES];
static unsigned long long calls, answers[32];
static const char *last;
static int64_t before[GP_AXES];
static int is_known, is_open = 1;

static void fail(const char *what) {
    printf("call %llu, %s: %s\n", calls, last, what);
    exit(1);
}

#define OK_OR(bits) (1u << GP_RESULT_OK | (bits))
#define BIT(name) (1u << GP_RESULT_##name)
#define ALWAYS (BIT(NULL) | BIT(CLOSED))

// The answer is one of those in `allowed`.
static gp_result answered(const char *name, gp_result result, uint32_t allowed) {
    last = name;
    calls++;
    if ((uint32_t)result >= 32 || ((allowed | ALWAYS) >> result & 1) == 0) {
        fail(gp_result_name(result));
    }
    answers[result]++;
    return result;
}

#define CALL(name, arguments, allowed) answered(#name, name arguments, OK_OR(allowed))

// What a call writes, between bytes that stay.
#define GUARD 0xa5
static unsigned char room[1024];

static void *guarded(void) {
    memset(room, GUARD, sizeof room);
    return room + 256;
}

static void still(size_t size) {
    for (size_t k = 0; k < sizeof room; k++) {
        if ((k < 256 || k >= 256 + size) && room[k] != GUARD) {
            fail("writes beyond its answer");
        }
    }
}

// A handle, rarely NULL or one of another kind.
static void *handle(void *right) {
    if (!one_in(50)) {
        return right;
    }
    void *const others[] = {NULL, gp.planner, gp.interpolator, gp.op, gp.feeder};
    void *const other = others[random_below(5)];
    return other == right ? NULL : other;
}

static int64_t position(void) {
    switch (random_below(6)) {
    case 0:
        return (int64_t)(state ^ (state << 21));
    case 1:
        return one_in(2) ? INT64_MIN : INT64_MAX;
    default:
        return ((int64_t)random_below(20001) - 10000) * (int64_t)(1 << 25);
    }
}

static const char *const WORDS[] = {
    "G00 ", "G01 ", "G02 ",  "G03 ",  "X",    "Y",     "Z",       "10",  "-3.5", "0.001", "F",     "600",          "\n",
    "\n",   "N10 ", "M26 ",  "M3 ",   "S100 ", "T1 ",   "G261 ",   "G260 ", "I5 ", "J-5 ", "R7 ",   "G04 0.01\n", "M30\n",
    "%t\n", "(",    ")",     "#HSC ON[OPTMODE 1 CONTERROR 0.01]\n",    "G91 ", "G90 ", "P1=2 ", "$IF P1\n", "$ENDIF\n", "L UP\n",
    "\xff", "G54 ", "99999", ".",     "#FILTER ON\n",    "#FILTER OFF\n", "G130 50 ", "X[INDP_SYN G01 F100 POS=3]\n", "=",  "[", "]"};

static char text[4][400];
static size_t lengths[4];
static int loaded = -1;

// Another text. One that is loaded stays as it is.
static int write_text(void) {
    static unsigned turn;
    do {
        turn = (turn + 1) % 4;
    } while ((int)turn == loaded);
    size_t length = 0;
    for (uint32_t words = random_below(40); words > 0; words--) {
        const char *word = WORDS[random_below(sizeof WORDS / sizeof WORDS[0])];
        const size_t size = strlen(word);
        if (length + size < sizeof text[0]) {
            memcpy(text[turn] + length, word, size);
            length += size;
        }
    }
    lengths[turn] = length;
    return (int)turn;
}

static void change_machine(void) {
    gp_machine_defaults(&machine);
    for (uint32_t changes = random_below(3); changes > 0; changes--) {
        uint32_t *const words = (uint32_t *)(void *)&machine;
        const uint32_t values[] = {0, 1, 2, 1000, 100000, 0xffffffffu, random_below(1u << 31)};
        words[random_below(sizeof machine / 4)] = values[random_below(7)];
    }
    if (one_in(2)) {
        machine.axes[0].filter.enable = 1;
        machine.axes[0].filter.kind = 1 + random_below(4);
        machine.axes[0].filter.order = random_below(60);
    }
    machine.channel.m_synch.count = 1;
    machine.channel.m_synch.functions[0].code = 26;
    machine.channel.m_synch.functions[0].kind = 2;
}

static void open_or_close(void) {
    const size_t size = one_in(10) ? random_below(100000) : sizeof *storage;
    gp_storage *const place = one_in(20) ? NULL : one_in(20) ? (gp_storage *)((char *)storage + 4) : storage;
    is_known = 0;
    if (one_in(3)) {
        if (CALL(gp_close, (place, size), BIT(SIZE) | BIT(ALIGNMENT)) == GP_RESULT_OK) {
            is_open = 0;
        }
        return;
    }
    change_machine();
    int32_t axis = 7;
    char *const message = guarded();
    const uint32_t most = random_below(300);
    const gp_result checked = CALL(gp_check, (one_in(50) ? NULL : &machine, &axis, message, most), BIT(MACHINE_DATA));
    still(most);
    if (checked == GP_RESULT_MACHINE_DATA && most > 0 && memchr(message, 0, most) == NULL) {
        fail("a message without an end");
    }
    const gp_result result = CALL(gp_open, (place, size, one_in(20) ? NULL : &machine, one_in(20) ? NULL : start, &gp),
                                  BIT(SIZE) | BIT(ALIGNMENT) | BIT(TWICE) | BIT(MACHINE_DATA));
    if (result == GP_RESULT_OK) {
        opened = machine;
        loaded = -1;
        is_open = 1;
    }
    if (checked != result && result == GP_RESULT_OK && checked != GP_RESULT_NULL) {
        fail("opened what gp_check refuses");
    }
}

static void plan(void) {
    gp_progress *const progress = guarded();
    gp_result result = GP_RESULT_OK;
    for (uint32_t k = random_below(40); k > 0; k--) {
        result = CALL(gp_poll, (handle(gp.planner), one_in(50) ? NULL : progress), BIT(REFUSED));
        still(sizeof *progress);
        if (result == GP_RESULT_OK && *progress > GP_PROGRESS_DONE) {
            fail("no such progress");
        }
    }
}

// Ticks. What moves, moves inside its largest speed.
static void tick(void) {
    for (uint32_t k = random_below(40); k > 0; k--) {
        gp_state *const did = guarded();
        gp_interpolator *const one = handle(gp.interpolator);
        CALL(gp_tick, (one, one_in(50) ? NULL : did), 0);
        still(sizeof *did);
        int64_t *const points = guarded();
        const gp_result result = CALL(gp_set_points, (one, points), 0);
        still(GP_AXES * sizeof *points);
        if (result == GP_RESULT_OK) {
            for (int axis = 0; axis < GP_AXES && is_known; axis++) {
                const double mm = 1e-9 * opened.axes[axis].vb_max * opened.channel.cycle_us;
                if (GP_MM(llabs(points[axis] - before[axis])) > 1.001 * mm + 1e-6) {
                    printf("axis %d: %.6f mm in a tick, %.6f permitted\n", axis, GP_MM(points[axis] - before[axis]), mm);
                    fail("a set point jumps");
                }
            }
            memcpy(before, points, sizeof before);
            is_known = 1;
        }
    }
}

static void load(void) {
    const int turn = write_text();
    const size_t length = one_in(100) ? (size_t)1 << 40 : lengths[turn];
    const uint32_t taken = BIT(RANGE) | BIT(NOT_AT_REST) | BIT(WINDOW_IS_LOADED);
    switch (random_below(5)) {
    case 0:
        if (CALL(gp_continue_with, (handle(gp.planner), text[turn], length), taken) == GP_RESULT_OK) {
            loaded = turn;
        }
        break;
    case 1:
        if (CALL(gp_load_window, (handle(gp.planner)), taken) == GP_RESULT_OK) {
            loaded = -1;
        }
        break;
    case 2:
        CALL(gp_load_next, (handle(gp.planner)), taken);
        break;
    default:
        if (CALL(gp_load, (handle(gp.planner), one_in(50) ? NULL : text[turn], length), taken) == GP_RESULT_OK) {
            loaded = turn;
        }
    }
}

static void feed(void) {
    const int turn = write_text();
    size_t *const taken = guarded();
    const size_t length = one_in(100) ? (size_t)1 << 40 : lengths[turn];
    const gp_result result = CALL(gp_feed, (handle(gp.feeder), (const uint8_t *)text[turn], length, taken), BIT(RANGE));
    still(sizeof *taken);
    if (result == GP_RESULT_OK && *taken > length) {
        fail("takes more than it was given");
    }
    if (one_in(10)) {
        CALL(gp_feed_end, (handle(gp.feeder)), 0);
    }
    if (one_in(10)) {
        CALL(gp_feed_restart, (handle(gp.feeder)), 0);
    }
}

static void command(void) {
    gp_operator *const op = handle(gp.op);
    switch (random_below(8)) {
    case 0:
        CALL(gp_feed_hold, (op), 0);
        break;
    case 1:
    case 2:
        CALL(gp_resume, (op), 0);
        break;
    case 3:
        CALL(gp_set_override, (op, (uint16_t)random_below(one_in(2) ? 2001 : 65536)), 0);
        break;
    case 4:
        CALL(gp_set_reduced, (op, random_below(3)), 0);
        break;
    case 5:
        if (one_in(4)) {
            CALL(gp_abort, (op), 0);
        }
        break;
    case 6: {
        gp_status_data *const status = guarded();
        CALL(gp_status, (op, status), 0);
        still(sizeof *status);
        break;
    }
    default: {
        gp_due *const due = guarded();
        gp_function function = {random_below(5), random_below(70000), position()};
        if (CALL(gp_output, (op, due), BIT(NOTHING)) == GP_RESULT_OK && !one_in(4)) {
            function = due->function;
        }
        still(sizeof *due);
        CALL(gp_acknowledge, (op, one_in(50) ? NULL : &function), BIT(RANGE) | BIT(UNEXPECTED));
    }
    }
}

static void machine_calls(void) {
    gp_planner *const planner = handle(gp.planner);
    const uint32_t axis = random_below(one_in(5) ? 1u << 31 : GP_AXES + 1);
    uint32_t *const number = guarded();
    switch (random_below(7)) {
    case 0:
        is_known = 0;
        CALL(gp_set_position, (planner, axis, position()), BIT(NOT_AT_REST) | BIT(RANGE));
        break;
    case 1:
        CALL(gp_set_zero_offset, (planner, random_below(8), axis, position()), BIT(NOT_AT_REST) | BIT(RANGE));
        break;
    case 2:
        CALL(gp_move_axis, (planner, axis, position(), position() >> 20),
             BIT(NOT_AT_REST) | BIT(RANGE) | BIT(LIMIT) | BIT(FULL));
        break;
    case 3:
        CALL(gp_stop_axis, (planner, axis), BIT(RANGE));
        break;
    case 4:
        CALL(gp_go_on, (planner), BIT(NOT_AT_REST) | BIT(NOTHING_REFUSED));
        break;
    case 5: {
        const uint32_t most = random_below(300);
        CALL(gp_message, (planner, NULL, (char *)number, most), BIT(NOTHING));
        still(most);
        break;
    }
    default:
        CALL(gp_is_at_rest, (planner, number), 0);
        CALL(gp_wakes_after, (planner, number), 0);
        still(sizeof *number);
    }
}

int main(int count, char **arguments) {
    const unsigned long long wanted = count > 1 ? strtoull(arguments[1], NULL, 10) : 100000;
    state = count > 2 ? strtoull(arguments[2], NULL, 10) : 1;
    // The storage ends where the page behind it begins.
    const size_t page = 4096, pages = (sizeof *storage + page - 1) / page * page;
    char *const memory = mmap(NULL, pages + 2 * page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED || mprotect(memory + page, pages, PROT_READ | PROT_WRITE) != 0) {
        return 2;
    }
    storage = (gp_storage *)(void *)(memory + page + pages - sizeof *storage);
    gp_machine_defaults(&machine);
    opened = machine;
    answered("gp_open", gp_open(storage, sizeof *storage, &machine, start, &gp), OK_OR(0));
    while (calls < wanted) {
        switch (random_below(12)) {
        case 0:
            if (one_in(is_open ? 20 : 2)) {
                open_or_close();
            }
            break;
        case 1:
            load();
            break;
        case 2:
            feed();
            break;
        case 3:
            command();
            break;
        case 4:
            machine_calls();
            break;
        case 5:
        case 6:
        case 7:
            tick();
            break;
        default:
            plan();
        }
    }
    for (uint32_t k = 0; k < 32; k++) {
        if (answers[k] > 0) {
            printf("%12llu %s\n", answers[k], gp_result_name(k));
        }
    }
    printf("%llu calls\n", calls);
    return 0;
}
