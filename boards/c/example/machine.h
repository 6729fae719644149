// Machine data of the examples: edit them for your machine.
#include "glidepath.h"

// Three linear axes, slope TRAPEZ, a cycle of 1 ms. The motion waits for the acknowledgement of M26.
static inline void machine_data(gp_machine *machine) {
    gp_machine_defaults(machine); // X, Y, Z with the ISG defaults
    for (int k = 0; k < GP_AXES; k++) {
        gp_axis *axis = &machine->axes[k];
        axis->vb_eilgang = 1000000; // P-AXIS-00209: rapid speed, µm/s
        axis->vb_max = 1000000;     // P-AXIS-00212: largest speed
        axis->a_max = 6000;         // P-AXIS-00008: largest acceleration, mm/s²
        axis->a_beschl = 2000;      // P-AXIS-00001: acceleration at feed
        axis->a_brems = 2000;       // P-AXIS-00002: deceleration at feed
        axis->a_grenz = 2000;       // P-AXIS-00004: both in rapid motion
        axis->a_stufe[0] = 2000;    // P-AXIS-00011, 00012: stages of the slope STEP
        axis->a_stufe[1] = 1200;
        axis->d_stufe[0] = 1600; // P-AXIS-00282
        axis->a_grenz_stufe[0] = 1200; // P-AXIS-00005, 00006
        axis->a_grenz_stufe[1] = 2000;
        axis->tr_beschl_ab = 150000; // P-AXIS-00195…00198: ramp times at feed, µs
        axis->tr_beschl_zu = 150000;
        axis->tr_brems_ab = 150000;
        axis->tr_brems_zu = 150000;
        axis->tr_grenz = 150000; // P-AXIS-00200: ramp time in rapid motion
        axis->tr_geom = 10000;   // P-AXIS-00199: ramp time of the contour
    }
    machine->channel.slope_profile = 1;     // P-CHAN-00071: TRAPEZ
    machine->channel.corr_v_trans_jerk = 1; // P-CHAN-00009: limited jerk at tangential transitions
    machine->channel.surface = 1;           // P-CHAN-00600: FCT_SURFACE
    machine->channel.m_synch.count = 1;     // P-CHAN-00041: M26 MVS_SVS
    machine->channel.m_synch.functions[0].code = 26;
    machine->channel.m_synch.functions[0].kind = 2;
}
