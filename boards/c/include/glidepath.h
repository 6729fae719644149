// Glidepath for C: an NC program becomes axis set points, one per axis and timer tick.
//
//     task of low priority          timer interrupt              any task, one at a time
//     gp_planner  --- queue --->  gp_interpolator  --- due --->  gp_operator  (commands, functions, status)
//         ^
//     gp_feeder  (text that arrives; without it gp_load takes text from memory)
//
// Order: gp_machine_defaults, gp_check, gp_open, gp_load, then the timer interrupt on. gp_poll in the task, gp_tick in the interrupt.
//
// Pointers: NULL is refused where the text does not permit it. Every other pointer has to point to what its type says; behind it
// lies memory that nobody else writes during the call. Text given to gp_load stays in use until another one is loaded.
//
// Contexts: each handle belongs to one context at a time. A context that interrupts another inside a call with the same handle
// is refused (GP_RESULT_IN_USE). Different handles never wait for each other. The tick interrupts the planner, never the
// other way round.
//
// Results: every call that answers something else than GP_RESULT_OK or GP_RESULT_NOTHING has done nothing, but for GP_RESULT_REFUSED.
//
// Made by `cargo xtask header` from the sources of boards/c. Do not edit.

#ifndef GLIDEPATH_H
#define GLIDEPATH_H

#include <stddef.h>
#include <stdint.h>

// The handles: what is in them is not to be looked at.
typedef struct gp_planner gp_planner;
typedef struct gp_interpolator gp_interpolator;
typedef struct gp_operator gp_operator;
typedef struct gp_feeder gp_feeder;

// Number of axes. To change it, or one of the next two: edit it here, then run `cargo xtask header`.
#define GP_AXES 3

// Blocks of look-ahead that memory is spent on: 10 at least.
#define GP_BLOCKS 120

// Bytes of the text window: a power of two, 64 at least. A line of the program has at most half of them.
#define GP_WINDOW 1024

// Order of the largest filter, and 1: an even number (P-AXIS-00587).
#define GP_TAPS 48

// Axes that may move beside the path at the same time: `gp_move_axis`, and those of the program.
#define GP_OVERLAYS 2

// Functions that a table of synchronisations holds.
#define GP_SYNCHRONISED 32

// Zero offsets G54…G59.
#define GP_ZERO_OFFSETS 6

// A linear axis: millimetres.
#define GP_LINEAR 0

// A rotary axis: degrees.
#define GP_ROTARY 1

// A spindle: takes no part in the path.
#define GP_SPINDLE 2

// An M function.
#define GP_M_FUNCTION 0

// An H function.
#define GP_H_FUNCTION 1

// S: spindle speed.
#define GP_SPINDLE_SPEED 2

// T: tool number.
#define GP_TOOL 3

// Size of the storage, in words of eight bytes: enough with pointers of 64 bits too.
#define GP_STORAGE_WORDS 10880

// Size of the storage in bytes.
#define GP_STORAGE_BYTES (GP_STORAGE_WORDS * 8)

// Alignment of the storage in bytes.
#define GP_STORAGE_ALIGNMENT 8

// What a call answers. Everything but `GP_RESULT_OK` and `GP_RESULT_NOTHING` means that nothing was done.
enum gp_result
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Done.
    GP_RESULT_OK = 0,
    // There is nothing to hand over.
    GP_RESULT_NOTHING = 1,
    // A pointer is NULL.
    GP_RESULT_NULL = 2,
    // The size of the storage is not `GP_STORAGE_BYTES`: header and library do not belong together.
    GP_RESULT_SIZE = 3,
    // The storage is not aligned to `GP_STORAGE_ALIGNMENT`.
    GP_RESULT_ALIGNMENT = 4,
    // The storage is open already: `gp_close` comes first.
    GP_RESULT_TWICE = 5,
    // The storage is not open, or not open any more, or the pointer is that of another handle.
    GP_RESULT_CLOSED = 6,
    // Another context is inside a call with the same handle.
    GP_RESULT_IN_USE = 7,
    // A parameter of the machine data is out of its range: `gp_check` says which.
    GP_RESULT_MACHINE_DATA = 8,
    // A line of the program is refused: `gp_message` says why.
    GP_RESULT_REFUSED = 9,
    // That is taken at rest alone, when all blocks read are executed.
    GP_RESULT_NOT_AT_REST = 10,
    // No line was refused, so there is none to go on behind.
    GP_RESULT_NOTHING_REFUSED = 11,
    // An argument is out of its range: an axis, a position, a length, the kind of a function.
    GP_RESULT_RANGE = 12,
    // No function waits for this acknowledgement.
    GP_RESULT_UNEXPECTED = 13,
    // The planner reads the window already: `gp_load_next` takes the program behind.
    GP_RESULT_WINDOW_IS_LOADED = 14,
    // The axis would come beyond its software limit, or its motion takes too long.
    GP_RESULT_LIMIT = 15,
    // All overlays are at work, or the build has none: GP_OVERLAYS.
    GP_RESULT_FULL = 16,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum gp_result gp_result;
#else
typedef uint32_t gp_result;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What a tick did.
enum gp_state
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // The axes rest: nothing is planned, or the motion stands in a feed hold or waits for an acknowledgement.
    GP_STATE_IDLE = 0,
    // The path rests and axes may still move.
    GP_STATE_SETTLING = 1,
    // A set point of the planned motion; dwell time counts.
    GP_STATE_ACTIVE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum gp_state gp_state;
#else
typedef uint32_t gp_state;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What one call of `gp_poll` achieved.
enum gp_progress
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // A bounded piece of work is done and there is more: call again.
    GP_PROGRESS_WORKING = 0,
    // The queue is full, the text has nothing yet, or the motion stands in a hold: call again after some ticks.
    GP_PROGRESS_WAITING = 1,
    // A motion block was planned for good.
    GP_PROGRESS_PLANNED = 2,
    // The same block has another law: an acknowledgement lets it end faster.
    GP_PROGRESS_REPLANNED = 3,
    // The program holds something doubtful; it goes on. `gp_message` says what.
    GP_PROGRESS_WARNING = 4,
    // Program text comes late: the motion comes to a standstill at the end of what there is.
    GP_PROGRESS_STARVED = 5,
    // The planner got no time for so long that the motion came to a standstill.
    GP_PROGRESS_LATE = 6,
    // The motion is slower than programmed, so that a standstill has room.
    GP_PROGRESS_SLOWER = 7,
    // The program has ended and everything is handed to the interpolator. Go on calling as long as it moves.
    GP_PROGRESS_DONE = 8,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum gp_progress gp_progress;
#else
typedef uint32_t gp_progress;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The filter of the set points of an axis; `#FILTER` of a program overrides all of it but the type.
typedef struct {
    // P-AXIS-00573: 1, the filter is on at program start.
    uint32_t enable;
    // P-AXIS-00586: 0 none, 1 moving average, 2 Gauss, 3 windowed sinc, 4 time delay.
    uint32_t kind;
    // P-AXIS-00587: 0…200, below GP_TAPS; 0: by order_time_us.
    uint32_t order;
    // P-AXIS-00590: effectiveness, percent.
    uint32_t share;
    // P-AXIS-00593: width of a Gauss kernel, in thousandths, 1…1000.
    uint32_t quality_milli;
    // P-AXIS-00591: the order as a time, µs; below a cycle: not filtered.
    uint32_t order_time_us;
    // P-AXIS-00585: cut-off frequency of a windowed sinc, in thousandths of Hz.
    uint32_t fcut_milli;
} gp_filter;

// One axis. Speeds in µm/s (rotary: 0.001°/s), accelerations in mm/s² (°/s²), ramp times in µs. Start with
// `gp_machine_defaults`, which sets the ISG defaults.
typedef struct {
    // Name in programs: one to four letters or digits, the first a letter; behind them zeros.
    char name[4];
    // GP_LINEAR, GP_ROTARY or GP_SPINDLE.
    uint32_t kind;
    // P-AXIS-00209: rapid speed.
    uint32_t vb_eilgang;
    // P-AXIS-00212: largest speed.
    uint32_t vb_max;
    // P-AXIS-00008: largest acceleration, tangential and normal together.
    uint32_t a_max;
    // P-AXIS-00199: geometric ramp time, limits the jerk caused by the contour; 0: tr_min.
    uint32_t tr_geom;
    // P-AXIS-00201: smallest ramp time.
    uint32_t tr_min;
    // P-AXIS-00013: acceleration permitted at a knee, 0.1 %; 0: limits of jerk hold there too.
    uint32_t a_trans_weight;
    // P-AXIS-00001: acceleration at feed.
    uint32_t a_beschl;
    // P-AXIS-00002: deceleration at feed.
    uint32_t a_brems;
    // P-AXIS-00004: acceleration and deceleration in rapid motion.
    uint32_t a_grenz;
    // P-AXIS-00195: ramp time, acceleration decreases.
    uint32_t tr_beschl_ab;
    // P-AXIS-00196: ramp time, acceleration increases.
    uint32_t tr_beschl_zu;
    // P-AXIS-00197: ramp time, deceleration decreases.
    uint32_t tr_brems_ab;
    // P-AXIS-00198: ramp time, deceleration increases.
    uint32_t tr_brems_zu;
    // P-AXIS-00200: ramp time of rapid motion.
    uint32_t tr_grenz;
    // P-AXIS-00154: part of the permitted jerk that a tangential transition may cause, 0.1 %; 0: all of it.
    uint32_t r_trans_weight;
    // P-AXIS-00293: smallest ramp time at feed that a weight (G132, G133) may lead to; 0: tr_min.
    uint32_t tr_w_min;
    // P-AXIS-00214: largest speed while the reduced speed is asked for; 0: none.
    uint32_t vb_max_red;
    // P-AXIS-00011 and 00012: accelerations of the slope STEP at feed.
    uint32_t a_stufe[2];
    // P-AXIS-00282 and 00283: its decelerations; 0: as a_stufe.
    uint32_t d_stufe[2];
    // P-AXIS-00221: speed at which it changes from stage 1 to stage 2.
    uint32_t vb_stufe_1_2;
    // P-AXIS-00005 and 00006: accelerations of the slope STEP in rapid motion.
    uint32_t a_grenz_stufe[2];
    // P-AXIS-00280 and 00281: its decelerations; 0: as a_grenz_stufe.
    uint32_t d_grenz_stufe[2];
    // P-AXIS-00211: speed at which it changes from stage 1 to stage 2.
    uint32_t vb_grenz_stufe_1_2;
    // P-AXIS-00015: 1, and 0x10000000 for the master axis of DIST_MASTER.
    uint32_t achs_mode;
    // P-CHAN-00011: 1, the feed counts along this axis. Where no axis has it, along the main axes.
    uint32_t default_feed_axis;
    // P-ZERO-00003: zero offsets of G54…G59, 0.1 µm (rotary: 0.0001°).
    int32_t versch[GP_ZERO_OFFSETS];
    // P-AXIS-00177: negative software limit, 0.1 µm (rotary: 0.0001°); -1000000000: none.
    int32_t swe_neg;
    // P-AXIS-00178: positive software limit; 1000000000: none.
    int32_t swe_pos;
    // The filter of its set points.
    gp_filter filter;
} gp_axis;

// The synchronisation of one M or H function.
typedef struct {
    // Number of the function.
    uint32_t code;
    // 0 NO_SYNCH, 1 MOS, 2 MVS_SVS, 4 MVS_SNS, 8 MNS_SNS. A function that is not in the table is MOS.
    uint32_t kind;
} gp_synchronisation;

// A table of them.
typedef struct {
    // How many are in it.
    uint32_t count;
    // The functions.
    gp_synchronisation functions[GP_SYNCHRONISED];
} gp_synchronisations;

// The channel.
typedef struct {
    // Interpolation cycle, µs, 100…10000.
    uint32_t cycle_us;
    // P-STUP-00071: blocks of look-ahead, 10…GP_BLOCKS.
    uint32_t look_ahead;
    // P-CHAN-00108: 100 = F in mm/min, 0.1 = F in m/min; here in thousandths.
    uint32_t feedrate_factor_milli;
    // P-CHAN-00071: 0 STEP, 1 TRAPEZ, 2 SIN2, 3 HSC.
    uint32_t slope_profile;
    // P-CHAN-00001: G130 and G131 weight 0 both, 1 acceleration, 2 deceleration.
    uint32_t acceleration_weight;
    // P-CHAN-00073: G132 and G133 weight 0 all ramps, 1 P-AXIS-00196, 2 00195, 3 00198, 4 00197.
    uint32_t ramp_weight;
    // P-CHAN-00009: 1, the jerk of tangential transitions between lines and arcs is limited.
    uint32_t corr_v_trans_jerk;
    // P-CHAN-00066: 0 the override acts on what the axes permit, 1 on the programmed feed, 2 as 1 while the speed is reduced.
    uint32_t override_weight_prog_feed;
    // P-CHAN-00351: unit of the next two: 0 mm/min², 1 mm/s².
    uint32_t vector_unit;
    // P-CHAN-00350: 1, the limit of path acceleration acts on arcs too.
    uint32_t cir_radial_acc_limit;
    // P-CHAN-00002: largest path acceleration, in thousandths.
    uint64_t vector_acceleration_milli;
    // P-CHAN-00208: largest path deceleration, in thousandths.
    uint64_t vector_deceleration_milli;
    // P-CHAN-00090: largest path speed, in thousandths of mm/min.
    uint64_t vector_velocity_milli;
    // P-CHAN-00110: jerk that curves in corners may cause: 0 any, 1 by the geometric ramp time, 2 by the ramp times.
    uint32_t check_jerk_on_poly_path;
    // merge_chords: percent of PATH_DEV that a line may be from the chords it stands for, 0…75.
    uint32_t merge_chords;
    // P-CHAN-00239: where the HSC B-spline deselects itself: 0 corner, 1 rounded, 2 rounded beside arcs.
    uint32_t auto_contour_mode;
    // P-CHAN-00600: 1, FCT_PTP is in force.
    uint32_t ptp;
    // P-CHAN-00600: 1, FCT_SURFACE is in force.
    uint32_t surface;
    // P-ZERO-00002: zero offset at program start: 0 none, 1…6 G54…G59.
    uint32_t default_index;
    // P-CHAN-00041: synchronisation of M functions.
    gp_synchronisations m_synch;
    // P-CHAN-00027: synchronisation of H functions.
    gp_synchronisations h_synch;
} gp_channel;

// A machine. The first three linear axes are the main axes. The storage keeps a copy of it.
typedef struct {
    // The axes.
    gp_axis axes[GP_AXES];
    // The channel.
    gp_channel channel;
} gp_machine;

// The word of the program that a message is about.
typedef struct {
    // Line, counted from 1; 0 where there is none.
    uint32_t line;
    // Column in bytes, counted from 1.
    uint32_t column;
    // Offset of the word in the text, bytes.
    uint32_t offset;
    // Bytes of the word.
    uint32_t length;
    // ISG's number of the message; 0 where none is known.
    uint32_t id;
} gp_place;

// A function of the program.
typedef struct {
    // GP_M_FUNCTION, GP_H_FUNCTION, GP_SPINDLE_SPEED or GP_TOOL.
    uint32_t kind;
    // Number of an M or H function, or of a tool.
    uint32_t number;
    // Spindle speed, 1/min, LSB 2^-32; else 0.
    int64_t speed;
} gp_function;

// A function whose point the motion has reached.
typedef struct {
    // What to do.
    gp_function function;
    // Number of the tick that reached the point: ticks since `gp_open`, from 0, modulo 2^31.
    uint32_t tick;
    // Programmed N number.
    uint32_t n;
    // 1: the motion goes on, at its synchronisation point, only after `gp_acknowledge`.
    uint32_t waits;
} gp_due;

// What the last tick did. All of it belongs to one tick.
typedef struct {
    // The set point of every axis, LSB 2^-32 mm or degrees.
    int64_t set_points[GP_AXES];
    // Path speed, mm per tick, LSB 2^-58.
    int64_t speed;
    // Programmed N number.
    uint32_t n;
    // Motion blocks since `gp_open`, from 0.
    uint32_t block;
    // Ticks since `gp_open`, modulo 2^31.
    uint32_t ticks;
    // Pieces of time in the queue, 0…256: those the planner is ahead by.
    uint32_t queued;
    // What the tick did.
    gp_state state;
} gp_status_data;

// All memory: `static gp_storage storage;`, zero at the start as static memory is. It must not move while it is open.
typedef struct {
    // Nothing to look at.
    uint64_t words[GP_STORAGE_WORDS];
} gp_storage;

// The handles. Each belongs to one context.
typedef struct {
    // For a task of low priority, or the main loop.
    gp_planner *planner;
    // For the timer interrupt, whose priority is above that of the planner's task.
    gp_interpolator *interpolator;
    // For whoever gives commands and carries functions out: one context at a time.
    gp_operator *op;
    // For whoever receives program text: one context at a time.
    gp_feeder *feeder;
} gp_handles;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The name of an outcome, for messages: a text of the library that ends with a NUL.
//
// Context: any.
const char *gp_result_name(uint32_t result);

// Sets all machine data to the ISG defaults: linear axes X, Y, Z, A, B, C, …, a cycle of 1 ms.
//
// Context: any. Answers GP_RESULT_NULL.
gp_result gp_machine_defaults(gp_machine *machine);

// Checks machine data. `axis` becomes the index of the axis that is wrong, -1 where it is not an axis; `message` of `size`
// bytes says which parameter, its value and its range. Both may be NULL.
//
// Context: any task; about 1 KB of stack. Answers GP_RESULT_NULL, GP_RESULT_MACHINE_DATA.
gp_result gp_check(const gp_machine *machine,
                   int32_t *axis,
                   char *message,
                   size_t size);

// Copies the set points of the last tick, GP_AXES of them, LSB 2^-32 mm or degrees.
//
// Context: the timer interrupt. Write them to the drives first, then call `gp_tick`: the moment of output does not depend on how
// long the computation takes. Answers GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_set_points(gp_interpolator *interpolator,
                        int64_t *set_points);

// Computes the next set points. `state` says what the tick did; it may be NULL.
//
// Context: the timer interrupt, once per cycle. Its priority is above that of the planner's task, or it is on another core.
// Bounded time. Answers GP_RESULT_NULL, CLOSED, IN_USE: then the set points stay as they are.
gp_result gp_tick(gp_interpolator *interpolator,
                  gp_state *state);

// Loads a program of `length` bytes. It begins where the axes stand, with everything as at program start. The text has to stay
// where it is until another one is loaded.
//
// Context: the planner's task. Answers GP_RESULT_NULL, CLOSED, IN_USE, RANGE (more than 2^31 bytes), NOT_AT_REST.
gp_result gp_load(gp_planner *planner,
                  const char *program,
                  size_t length);

// Takes single lines (MDI): as `gp_load`, but everything in force stays as the last text left it. After an abort it begins as
// `gp_load` does.
//
// Context: the planner's task. Answers as `gp_load`.
gp_result gp_continue_with(gp_planner *planner,
                           const char *lines,
                           size_t length);

// Loads the program that arrives by `gp_feed`. It begins where `gp_feed_restart` was called last.
//
// Context: the planner's task. Answers GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, WINDOW_IS_LOADED.
gp_result gp_load_window(gp_planner *planner);

// Takes the next program of the same text, behind the one that has ended, or that a refused line or an abort has ended.
//
// Context: the planner's task. Answers GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST.
gp_result gp_load_next(gp_planner *planner);

// Goes on behind a refused line, from where the axes stand.
//
// Context: the planner's task. Answers GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, NOTHING_REFUSED.
gp_result gp_go_on(gp_planner *planner);

// Does a bounded piece of work and says in `progress` what. Call it in a loop until it says GP_PROGRESS_WAITING or
// GP_PROGRESS_DONE, then again after a tick.
//
// Context: the planner's task, which the tick interrupts, never the other way round. Answers GP_RESULT_NULL, CLOSED, IN_USE,
// REFUSED: a line is left out, `gp_message` says why. Go on calling: what was planned before comes to a standstill.
gp_result gp_poll(gp_planner *planner,
                  gp_progress *progress);

// Tells the last refusal or warning of `gp_poll`: the word it is about, and a text of at most `size` bytes with its NUL. Both
// pointers may be NULL.
//
// Context: the planner's task; about 1 KB of stack. Answers GP_RESULT_NOTHING, NULL, CLOSED, IN_USE.
gp_result gp_message(gp_planner *planner,
                     gp_place *place,
                     char *message,
                     size_t size);

// Whether the axes stand with everything executed that was read: 1, else 0. Then programs, positions and offsets are taken.
//
// Context: the planner's task. Answers GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_is_at_rest(gp_planner *planner,
                        uint32_t *is_at_rest);

// Says that an axis stands at `position`, LSB 2^-32 mm or degrees, machine coordinates: nothing moves. The set point jumps to it
// with the next tick.
//
// Context: the planner's task. Answers GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, RANGE.
gp_result gp_set_position(gp_planner *planner,
                          uint32_t axis,
                          int64_t position);

// Sets the offset of an axis in zero offset `set`, 0…5 for G54…G59, LSB 2^-32 mm or degrees. It counts from the next line on.
//
// Context: the planner's task. Answers GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, RANGE.
gp_result gp_set_zero_offset(gp_planner *planner,
                             uint32_t set,
                             uint32_t axis,
                             int64_t offset);

// Moves an axis alone, at rest of the path: jog, homing. `target` is a machine coordinate, LSB 2^-32 mm or degrees; `feed` has
// LSB 2^-32 mm/min or degrees/min, 0: as rapid motion. The program has to have ended: GP_PROGRESS_DONE. `gp_poll` carries
// the motion out, and says GP_PROGRESS_WAITING until the axis stands; hold, override and abort act on it.
//
// Context: the planner's task. Answers GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST (also: this axis moves), RANGE, LIMIT, FULL.
gp_result gp_move_axis(gp_planner *planner,
                       uint32_t axis,
                       int64_t target,
                       int64_t feed);

// The axis that `gp_move_axis` moves brakes, and stays where it comes to a standstill. Nothing happens if it does not move.
//
// Context: the planner's task. Answers GP_RESULT_NULL, CLOSED, IN_USE, RANGE.
gp_result gp_stop_axis(gp_planner *planner,
                       uint32_t axis);

// After how many ticks `gp_poll` should be called again once it has said GP_PROGRESS_WAITING, for a task that sleeps in
// between; 0: the motion stands, and goes on only with a command, an acknowledgement or text. Whoever gives one of these
// wakes the task.
//
// Context: the planner's task. Answers GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_wakes_after(gp_planner *planner,
                         uint32_t *ticks);

// Feed override, LSB 0.1 %, 0…2000; more counts as 2000. 0 makes the motion stand on the path.
//
// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_set_override(gp_operator *op, uint16_t feed);

// Reduced speed (P-AXIS-00214): 0 off, everything else on.
//
// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_set_reduced(gp_operator *op, uint32_t reduced);

// Feed hold: stand still on the path as soon as the limits allow.
//
// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_feed_hold(gp_operator *op);

// End of the feed hold.
//
// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_resume(gp_operator *op);

// Stand still and forget the rest of the program.
//
// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_abort(gp_operator *op);

// The next function whose point of the motion a tick has reached. Call it until it answers GP_RESULT_NOTHING: without room
// for more functions the motion comes to a standstill.
//
// Context: any, one at a time; never waits. Answers GP_RESULT_NOTHING, NULL, CLOSED, IN_USE.
gp_result gp_output(gp_operator *op,
                    gp_due *output);

// Acknowledges a function that `gp_output` gave with `waits`. If it was put out more than once, that put out first.
//
// Context: any, one at a time; never waits. Answers GP_RESULT_NULL, CLOSED, IN_USE, RANGE (no such kind, or number of an M or H
// function above 65535), UNEXPECTED (nothing waits for it: it is ignored).
gp_result gp_acknowledge(gp_operator *op,
                         const gp_function *function);

// What the last tick did.
//
// Context: any, one at a time; reads again if a tick comes in between. Answers GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_status(gp_operator *op, gp_status_data *status);

// Puts `length` bytes of program text into the window, as many as there is room for. `taken` says how many: the others are to
// be given again.
//
// Context: any, one at a time: a task, or the interrupt of a serial line. Time in proportion to `length`. Answers
// GP_RESULT_NULL, CLOSED, IN_USE, RANGE (more than 2^31 bytes).
gp_result gp_feed(gp_feeder *feeder,
                  const uint8_t *bytes,
                  size_t length,
                  size_t *taken);

// The text is complete: behind the last byte the program ends.
//
// Context: as `gp_feed`. Answers GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_feed_end(gp_feeder *feeder);

// Another program follows: text that was put in and is not read yet is dropped. It counts from `gp_load_next` or
// `gp_load_window` on.
//
// Context: as `gp_feed`. Answers GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_feed_restart(gp_feeder *feeder);

// Opens the storage: checks and copies the machine data, says where the axes stand and gives the handles. `size` is
// `sizeof storage`; `start` has GP_AXES positions, LSB 2^-32 mm or degrees. No program is loaded yet.
//
// Context: any task, before the timer interrupt is on. Answers GP_RESULT_NULL, SIZE, ALIGNMENT, TWICE, MACHINE_DATA (`gp_check`
// says which), RANGE (a position beyond ±100 000 mm or degrees).
gp_result gp_open(gp_storage *storage,
                  size_t size,
                  const gp_machine *machine,
                  const int64_t *start,
                  gp_handles *handles);

// Closes the storage: its handles are refused from now on. It may be opened again, for another machine.
//
// Context: any task, when no other context uses a handle any more: first switch the timer interrupt off. Answers
// GP_RESULT_NULL, SIZE, ALIGNMENT, CLOSED, IN_USE (this context interrupts a call).
gp_result gp_close(gp_storage *storage, size_t size);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* GLIDEPATH_H */

// A position in mm or degrees as what the library counts in, and back.
#define GP_POSITION(mm) ((int64_t)((mm) * 4294967296.0))
#define GP_MM(position) ((double)(position) / 4294967296.0)
