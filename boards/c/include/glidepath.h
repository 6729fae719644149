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

// Number of axes. To change this constant, or one of the next two, edit the constant here, then run
// `cargo xtask header`.
#define GP_AXES 3

// Number of blocks in the look-ahead, at least 10.
#define GP_BLOCKS 120

// Bytes of the text window: a power of two, at least 64. A line of the program has at most half of
// this length.
#define GP_WINDOW 1024

// Order of the largest filter plus 1: an even number (P-AXIS-00587).
#define GP_TAPS 48

// Number of axes that may move independently of the path at the same time, by `gp_move_axis` and by
// the program.
#define GP_OVERLAYS 2

// Highest number of functions in a table of synchronisations.
#define GP_SYNCHRONISED 32

// Zero offsets G54…G59.
#define GP_ZERO_OFFSETS 6

// A linear axis: millimetres.
#define GP_LINEAR 0

// A rotary axis: degrees.
#define GP_ROTARY 1

// A spindle, which does not move along the path.
#define GP_SPINDLE 2

// An M function.
#define GP_M_FUNCTION 0

// An H function.
#define GP_H_FUNCTION 1

// S: spindle speed.
#define GP_SPINDLE_SPEED 2

// T: tool number.
#define GP_TOOL 3

// Size of the storage, in words of eight bytes; the size is also enough with pointers of 64 bits.
#define GP_STORAGE_WORDS 10880

// Size of the storage in bytes.
#define GP_STORAGE_BYTES (GP_STORAGE_WORDS * 8)

// Alignment of the storage in bytes.
#define GP_STORAGE_ALIGNMENT 8

// The result of a call. After every result except `GP_RESULT_OK` and `GP_RESULT_NOTHING`, the call had
// no effect.
enum gp_result
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Done.
    GP_RESULT_OK = 0,
    // There is nothing to return.
    GP_RESULT_NOTHING = 1,
    // A pointer is NULL.
    GP_RESULT_NULL = 2,
    // The size of the storage is not `GP_STORAGE_BYTES`: header and library have different versions.
    GP_RESULT_SIZE = 3,
    // The storage is not aligned to `GP_STORAGE_ALIGNMENT`.
    GP_RESULT_ALIGNMENT = 4,
    // The storage is already open: call `gp_close` first.
    GP_RESULT_TWICE = 5,
    // The storage is not open, or closed again, or the pointer is that of another handle.
    GP_RESULT_CLOSED = 6,
    // Another context is inside a call with the same handle.
    GP_RESULT_IN_USE = 7,
    // A parameter of the machine data is out of its range: `gp_check` names the parameter.
    GP_RESULT_MACHINE_DATA = 8,
    // A line of the program is refused: `gp_message` returns the reason.
    GP_RESULT_REFUSED = 9,
    // The call is possible only at standstill, when all blocks read so far are executed.
    GP_RESULT_NOT_AT_REST = 10,
    // No line was refused, so the call has no line to continue after.
    GP_RESULT_NOTHING_REFUSED = 11,
    // An argument is out of its range: an axis, a position, a length, the kind of a function.
    GP_RESULT_RANGE = 12,
    // No function waits for this acknowledgement.
    GP_RESULT_UNEXPECTED = 13,
    // The planner already reads the window: `gp_load_next` takes the following program.
    GP_RESULT_WINDOW_IS_LOADED = 14,
    // The axis would exceed its software limit, or its motion takes too long.
    GP_RESULT_LIMIT = 15,
    // All overlays are in use, or the build has none: GP_OVERLAYS.
    GP_RESULT_FULL = 16,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum gp_result gp_result;
#else
typedef uint32_t gp_result;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The state after a tick.
enum gp_state
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // The axes stand still: nothing is planned, or the motion is in a feed hold or waits for an
    // acknowledgement.
    GP_STATE_IDLE = 0,
    // The motion along the path has ended, and filters or single axes may still move the axes.
    GP_STATE_SETTLING = 1,
    // The set point belongs to the planned motion; dwell time counts.
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
    // A bounded part of the work is done, and there is more work: call again.
    GP_PROGRESS_WORKING = 0,
    // The queue is full, program text is missing, or the motion is in a hold: call again after some ticks.
    GP_PROGRESS_WAITING = 1,
    // The planner has released a motion block: its speed profile is planned.
    GP_PROGRESS_PLANNED = 2,
    // A block has a new speed profile, because an acknowledgement permits a higher end speed.
    GP_PROGRESS_REPLANNED = 3,
    // The program has a questionable word, and planning continues. `gp_message` returns the warning.
    GP_PROGRESS_WARNING = 4,
    // Program text comes late: the axes stop at the end of the known path.
    GP_PROGRESS_STARVED = 5,
    // The planner got no processor time for so long that the axes stopped.
    GP_PROGRESS_LATE = 6,
    // The motion is slower than programmed, so that the stop fits into the queue.
    GP_PROGRESS_SLOWER = 7,
    // The program has ended, and all motion is in the queue. Continue to call `gp_poll` while the axes
    // move.
    GP_PROGRESS_DONE = 8,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum gp_progress gp_progress;
#else
typedef uint32_t gp_progress;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The filter of the set points of an axis. `#FILTER` in a program overrides all fields except the
// type.
typedef struct {
    // P-AXIS-00573: 1 if the filter is on at program start.
    uint32_t enable;
    // P-AXIS-00586: 0 none, 1 moving average, 2 Gauss, 3 windowed sinc, 4 time delay.
    uint32_t kind;
    // P-AXIS-00587: order of the filter, 0…200, below GP_TAPS; 0: the order follows from order_time_us.
    uint32_t order;
    // P-AXIS-00590: effectiveness, percent.
    uint32_t share;
    // P-AXIS-00593: width of a Gauss kernel, in thousandths, 1…1000.
    uint32_t quality_milli;
    // P-AXIS-00591: the order as a time, µs; below a cycle: no filter.
    uint32_t order_time_us;
    // P-AXIS-00585: cut-off frequency of a windowed sinc, in thousandths of Hz.
    uint32_t fcut_milli;
} gp_filter;

// One axis. Speeds in µm/s (rotary: 0.001°/s), accelerations in mm/s² (°/s²), ramp times in µs. Call
// `gp_machine_defaults` first, which sets the ISG defaults.
typedef struct {
    // Name in programs: one to four letters or digits, the first a letter, followed by zeros.
    char name[4];
    // GP_LINEAR, GP_ROTARY or GP_SPINDLE.
    uint32_t kind;
    // P-AXIS-00209: rapid speed.
    uint32_t vb_eilgang;
    // P-AXIS-00212: highest speed.
    uint32_t vb_max;
    // P-AXIS-00008: highest acceleration, tangential and normal together.
    uint32_t a_max;
    // P-AXIS-00199: geometric ramp time, which limits the jerk from the curvature of the path; 0: tr_min.
    uint32_t tr_geom;
    // P-AXIS-00201: lowest ramp time.
    uint32_t tr_min;
    // P-AXIS-00013: permitted acceleration at a corner without a curve, 0.1 %; 0: the limits of jerk apply
    // there too.
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
    // P-AXIS-00154: permitted part of the jerk at a tangential transition, 0.1 %; 0: the whole jerk.
    uint32_t r_trans_weight;
    // P-AXIS-00293: lowest ramp time at feed that a weight (G132, G133) may cause; 0: tr_min.
    uint32_t tr_w_min;
    // P-AXIS-00214: highest speed while reduced speed is on; 0: no limit.
    uint32_t vb_max_red;
    // P-AXIS-00011 and 00012: accelerations of the slope STEP at feed.
    uint32_t a_stufe[2];
    // P-AXIS-00282 and 00283: decelerations of the slope STEP at feed; 0: as a_stufe.
    uint32_t d_stufe[2];
    // P-AXIS-00221: speed at which the slope STEP changes from stage 1 to stage 2 at feed.
    uint32_t vb_stufe_1_2;
    // P-AXIS-00005 and 00006: accelerations of the slope STEP in rapid motion.
    uint32_t a_grenz_stufe[2];
    // P-AXIS-00280 and 00281: decelerations of the slope STEP in rapid motion; 0: as a_grenz_stufe.
    uint32_t d_grenz_stufe[2];
    // P-AXIS-00211: speed at which the slope STEP changes from stage 1 to stage 2 in rapid motion.
    uint32_t vb_grenz_stufe_1_2;
    // P-AXIS-00015: axis mode: 1, plus 0x10000000 for the master axis of DIST_MASTER.
    uint32_t achs_mode;
    // P-CHAN-00011: 1 if the feed refers to this axis. If no axis has 1, the feed refers to the main axes.
    uint32_t default_feed_axis;
    // P-ZERO-00003: zero offsets of G54…G59, 0.1 µm (rotary: 0.0001°).
    int32_t versch[GP_ZERO_OFFSETS];
    // P-AXIS-00177: negative software limit, 0.1 µm (rotary: 0.0001°); -1000000000: none.
    int32_t swe_neg;
    // P-AXIS-00178: positive software limit; 1000000000: none.
    int32_t swe_pos;
    // The filter of the axis's set points.
    gp_filter filter;
} gp_axis;

// The synchronisation of one M or H function.
typedef struct {
    // Number of the function.
    uint32_t code;
    // 0 NO_SYNCH, 1 MOS, 2 MVS_SVS, 4 MVS_SNS, 8 MNS_SNS. A function that is not in the table is MOS.
    uint32_t kind;
} gp_synchronisation;

// A table of synchronisations.
typedef struct {
    // Number of used entries.
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
    // P-CHAN-00009: 1 if the jerk of tangential transitions between lines and arcs is limited.
    uint32_t corr_v_trans_jerk;
    // P-CHAN-00066: 0 if the override acts on the limits of the axes, 1 if it acts on the programmed feed,
    // 2 as 1 while the speed is reduced.
    uint32_t override_weight_prog_feed;
    // P-CHAN-00351: unit of the next two fields: 0 mm/min², 1 mm/s².
    uint32_t vector_unit;
    // P-CHAN-00350: 1 if the limit of path acceleration acts on arcs too.
    uint32_t cir_radial_acc_limit;
    // P-CHAN-00002: highest path acceleration, in thousandths.
    uint64_t vector_acceleration_milli;
    // P-CHAN-00208: highest path deceleration, in thousandths.
    uint64_t vector_deceleration_milli;
    // P-CHAN-00090: highest path speed, in thousandths of mm/min.
    uint64_t vector_velocity_milli;
    // P-CHAN-00110: jerk in the curves of corners: 0 not limited, 1 limited by the geometric ramp time, 2
    // by the ramp times.
    uint32_t check_jerk_on_poly_path;
    // merge_chords: highest distance between chords and the line that replaces them, in percent of
    // PATH_DEV, 0…75.
    uint32_t merge_chords;
    // P-CHAN-00239: corners at which the HSC B-spline is off: 0 they stay sharp, 1 they are rounded, 2
    // they are rounded next to arcs.
    uint32_t auto_contour_mode;
    // P-CHAN-00600: 1 if FCT_PTP is active.
    uint32_t ptp;
    // P-CHAN-00600: 1 if FCT_SURFACE is active.
    uint32_t surface;
    // P-ZERO-00002: zero offset at program start: 0 none, 1…6 G54…G59.
    uint32_t default_index;
    // P-CHAN-00041: synchronisation of M functions.
    gp_synchronisations m_synch;
    // P-CHAN-00027: synchronisation of H functions.
    gp_synchronisations h_synch;
} gp_channel;

// The machine data. The first three linear axes are the main axes. The storage keeps a copy of the
// machine data.
typedef struct {
    // The axes.
    gp_axis axes[GP_AXES];
    // The channel.
    gp_channel channel;
} gp_machine;

// The word of the program that a message is about.
typedef struct {
    // Line, counted from 1; 0 if there is none.
    uint32_t line;
    // Column in bytes, counted from 1.
    uint32_t column;
    // Offset of the word in the text, bytes.
    uint32_t offset;
    // Length of the word, bytes.
    uint32_t length;
    // ISG's number of the message; 0 if ISG has none.
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
    // The function.
    gp_function function;
    // Number of the tick that reached the function's point: ticks since `gp_open`, from 0, modulo 2^31.
    uint32_t tick;
    // Programmed N number.
    uint32_t n;
    // 1 if the motion waits at the synchronisation point for `gp_acknowledge`.
    uint32_t waits;
} gp_due;

// The state after the last tick. All fields belong to the same tick.
typedef struct {
    // The set point of every axis, LSB 2^-32 mm or degrees.
    int64_t set_points[GP_AXES];
    // Path speed, mm per tick, LSB 2^-58.
    int64_t speed;
    // Programmed N number.
    uint32_t n;
    // Number of motion blocks since `gp_open`, from 0.
    uint32_t block;
    // Number of ticks since `gp_open`, modulo 2^31.
    uint32_t ticks;
    // Number of pieces in the queue between planner and interrupt, 0…256.
    uint32_t queued;
    // The state after the tick.
    gp_state state;
} gp_status_data;

// All memory: `static gp_storage storage;`, zero at the start as all static memory. The storage must
// not move while it is open.
typedef struct {
    // Private memory.
    uint64_t words[GP_STORAGE_WORDS];
} gp_storage;

// The handles. Each handle belongs to one context.
typedef struct {
    // For a task of low priority, or the main loop.
    gp_planner *planner;
    // For the timer interrupt, whose priority is above that of the planner's task.
    gp_interpolator *interpolator;
    // For the context that gives commands and carries out functions: one context at a time.
    gp_operator *op;
    // For the context that receives program text: one context at a time.
    gp_feeder *feeder;
} gp_handles;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The name of a result, for messages: a text in the library that ends with a NUL.
//
// Context: any.
const char *gp_result_name(uint32_t result);

// Sets all machine data to the ISG defaults: linear axes X, Y, Z, A, B, C, …, a cycle of 1 ms.
//
// Context: any. Returns GP_RESULT_NULL.
gp_result gp_machine_defaults(gp_machine *machine);

// Checks machine data. `axis` returns the index of the faulty axis, or -1 if the fault belongs to no
// axis. `message`, with room for `size` bytes, returns the parameter, its value and its range. Both
// may be NULL.
//
// Context: any task; about 1 KB of stack. Returns GP_RESULT_NULL, GP_RESULT_MACHINE_DATA.
gp_result gp_check(const gp_machine *machine,
                   int32_t *axis,
                   char *message,
                   size_t size);

// Copies the set points of the last tick, GP_AXES of them, LSB 2^-32 mm or degrees.
//
// Context: the timer interrupt. Write the set points to the drives first, then call `gp_tick`; then
// the moment of output does not depend on the duration of the computation. Returns GP_RESULT_NULL,
// CLOSED, IN_USE.
gp_result gp_set_points(gp_interpolator *interpolator,
                        int64_t *set_points);

// Computes the next set points. `state` returns the state after the tick; `state` may be NULL.
//
// Context: the timer interrupt, once per cycle. Its priority must be above that of the planner's task,
// or it runs on another core. Bounded time. Returns GP_RESULT_NULL, CLOSED, IN_USE; then the set
// points do not change.
gp_result gp_tick(gp_interpolator *interpolator,
                  gp_state *state);

// Loads a program of `length` bytes. The program begins at the position of the axes, with the modal
// state of program start. The text must stay in memory until another text is loaded.
//
// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, RANGE (more than 2^31 bytes),
// NOT_AT_REST.
gp_result gp_load(gp_planner *planner,
                  const char *program,
                  size_t length);

// Takes single lines (MDI): as `gp_load`, but the modal state of the last text stays active. After an
// abort the modal state is that of program start.
//
// Context: the planner's task. Returns the same as `gp_load`.
gp_result gp_continue_with(gp_planner *planner,
                           const char *lines,
                           size_t length);

// Loads the program that arrives by `gp_feed`. The program begins at the last call of
// `gp_feed_restart`.
//
// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, WINDOW_IS_LOADED.
gp_result gp_load_window(gp_planner *planner);

// Takes the next program of the same text, after a program end, a refused line or an abort.
//
// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST.
gp_result gp_load_next(gp_planner *planner);

// Continues after a refused line, from the position of the axes.
//
// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, NOTHING_REFUSED.
gp_result gp_go_on(gp_planner *planner);

// Does a bounded part of the work, and returns the result in `progress`. Call it in a loop until it
// returns GP_PROGRESS_WAITING or GP_PROGRESS_DONE, then again after a tick.
//
// Context: the planner's task; the tick must be able to interrupt this task, never the other way
// round. Returns GP_RESULT_NULL, CLOSED, IN_USE, REFUSED: a line is left out, and `gp_message` returns
// the reason. Continue to call: the earlier motion ends in a stop.
gp_result gp_poll(gp_planner *planner,
                  gp_progress *progress);

// Returns the last refusal or warning of `gp_poll`: its word, and a text of at most `size` bytes with
// its NUL. Both pointers may be NULL.
//
// Context: the planner's task; about 1 KB of stack. Returns GP_RESULT_NOTHING, NULL, CLOSED, IN_USE.
gp_result gp_message(gp_planner *planner,
                     gp_place *place,
                     char *message,
                     size_t size);

// Whether the axes stand still and all lines read so far are executed: 1, else 0. Only then the
// planner accepts programs, positions and offsets.
//
// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_is_at_rest(gp_planner *planner,
                        uint32_t *is_at_rest);

// Sets the machine coordinate of an axis to `position`, LSB 2^-32 mm or degrees, without motion. The
// set point changes to this value with the next tick.
//
// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, RANGE.
gp_result gp_set_position(gp_planner *planner,
                          uint32_t axis,
                          int64_t position);

// Sets the offset of an axis in zero offset `set`, 0…5 for G54…G59, LSB 2^-32 mm or degrees. The
// offset acts from the next line on.
//
// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST, RANGE.
gp_result gp_set_zero_offset(gp_planner *planner,
                             uint32_t set,
                             uint32_t axis,
                             int64_t offset);

// Moves a single axis for a jog or for homing, at standstill of the path. `target` is a machine
// coordinate, LSB 2^-32 mm or degrees. `feed` has LSB 2^-32 mm/min or degrees/min; 0: speed of rapid
// motion. The program must have ended: GP_PROGRESS_DONE. `gp_poll` carries out the motion, and returns
// GP_PROGRESS_WAITING until the axis stands still. Hold, override and abort act on the motion.
//
// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, NOT_AT_REST (also: this axis
// moves), RANGE, LIMIT, FULL.
gp_result gp_move_axis(gp_planner *planner,
                       uint32_t axis,
                       int64_t target,
                       int64_t feed);

// Stops the axis that `gp_move_axis` moves. The axis stays at the position of its standstill. The call
// has no effect if the axis does not move.
//
// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE, RANGE.
gp_result gp_stop_axis(gp_planner *planner,
                       uint32_t axis);

// Returns the number of ticks after which `gp_poll` should be called again, after GP_PROGRESS_WAITING.
// A task may sleep for this time. 0: the axes stand still, and only a command, an acknowledgement or
// text continues the motion. The sender of these must wake the task.
//
// Context: the planner's task. Returns GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_wakes_after(gp_planner *planner,
                         uint32_t *ticks);

// Sets the feed override, LSB 0.1 %, 0…2000; a higher value counts as 2000. With 0 the axes stop on
// the path.
//
// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_set_override(gp_operator *op, uint16_t feed);

// Sets the reduced speed (P-AXIS-00214): 0 off, any other value on.
//
// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_set_reduced(gp_operator *op, uint32_t reduced);

// Feed hold: the axes stop on the path as soon as the limits permit.
//
// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_feed_hold(gp_operator *op);

// Ends the feed hold.
//
// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_resume(gp_operator *op);

// Stops the axes and drops the rest of the program.
//
// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_abort(gp_operator *op);

// Returns the next function whose point of the path a tick has reached. Call it until it returns
// GP_RESULT_NOTHING: without room for more functions the axes stop.
//
// Context: any, one call at a time; never waits. Returns GP_RESULT_NOTHING, NULL, CLOSED, IN_USE.
gp_result gp_output(gp_operator *op,
                    gp_due *output);

// Acknowledges a function that `gp_output` returned with `waits`. If the function was output more than
// once, the first output is acknowledged.
//
// Context: any, one call at a time; never waits. Returns GP_RESULT_NULL, CLOSED, IN_USE, RANGE (no
// such kind, or number of an M or H function above 65535), UNEXPECTED (no such function waits; the
// call has no effect).
gp_result gp_acknowledge(gp_operator *op,
                         const gp_function *function);

// Returns the state after the last tick.
//
// Context: any, one call at a time; if a tick comes in between, the function reads again. Returns
// GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_status(gp_operator *op, gp_status_data *status);

// Puts up to `length` bytes of program text into the window. `taken` returns the number of accepted
// bytes. Give the other bytes again later.
//
// Context: any, one call at a time: a task, or the interrupt of a serial line. Time in proportion to
// `length`. Returns GP_RESULT_NULL, CLOSED, IN_USE, RANGE (more than 2^31 bytes).
gp_result gp_feed(gp_feeder *feeder,
                  const uint8_t *bytes,
                  size_t length,
                  size_t *taken);

// Marks the text as complete: the program ends after the last byte.
//
// Context: as `gp_feed`. Returns GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_feed_end(gp_feeder *feeder);

// Begins another program: text that is in the window and not read yet is dropped. The new text is read
// from the next call of `gp_load_next` or `gp_load_window` on.
//
// Context: as `gp_feed`. Returns GP_RESULT_NULL, CLOSED, IN_USE.
gp_result gp_feed_restart(gp_feeder *feeder);

// Opens the storage: checks and copies the machine data, sets the positions of the axes, and returns
// the handles. `size` is `sizeof storage`; `start` has GP_AXES positions, LSB 2^-32 mm or degrees. No
// program is loaded yet.
//
// Context: any task, before the timer interrupt is on. Returns GP_RESULT_NULL, SIZE, ALIGNMENT, TWICE,
// MACHINE_DATA (`gp_check` names the parameter), RANGE (a position beyond ±100 000 mm or degrees).
gp_result gp_open(gp_storage *storage,
                  size_t size,
                  const gp_machine *machine,
                  const int64_t *start,
                  gp_handles *handles);

// Closes the storage: later calls with its handles are refused. The storage may be opened again, for
// another machine.
//
// Context: any task, when no other context uses a handle any more: first switch the timer interrupt
// off. Returns GP_RESULT_NULL, SIZE, ALIGNMENT, CLOSED, IN_USE (this context interrupts a call).
gp_result gp_close(gp_storage *storage, size_t size);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* GLIDEPATH_H */

// A position in mm or degrees as what the library counts in, and back.
#define GP_POSITION(mm) ((int64_t)((mm) * 4294967296.0))
#define GP_MM(position) ((double)(position) / 4294967296.0)
