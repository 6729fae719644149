//! Machine data: edit them for your machine. Units and ranges are those of `glidepath::machine`.
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData, Synch, SynchTable};

/// Number of axes.
pub const AXES: usize = 3;

/// Number of blocks in the look-ahead.
pub const BLOCKS: usize = 120;

const fn linear(letter: &str) -> AxisData {
    let name = match AxisName::new(letter) {
        Some(name) => name,
        None => panic!("an axis name is one to four letters"),
    };
    AxisData {
        vb_eilgang: 1_000_000,         // P-AXIS-00209: rapid speed, µm/s
        vb_max: 1_000_000,             // P-AXIS-00212: largest speed
        a_max: 6_000,                  // P-AXIS-00008: largest acceleration, mm/s²
        a_beschl: 2_000,               // P-AXIS-00001: acceleration at feed
        a_brems: 2_000,                // P-AXIS-00002: deceleration at feed
        a_grenz: 2_000,                // P-AXIS-00004: both in rapid motion
        a_stufe: [2_000, 1_200],       // P-AXIS-00011, 00012: stages of the slope STEP
        d_stufe: [1_600, 0],           // P-AXIS-00282, 00283
        a_grenz_stufe: [1_200, 2_000], // P-AXIS-00005, 00006
        tr_beschl_ab: 150_000,         // P-AXIS-00195…00198: ramp times at feed, µs
        tr_beschl_zu: 150_000,
        tr_brems_ab: 150_000,
        tr_brems_zu: 150_000,
        tr_grenz: 150_000, // P-AXIS-00200: ramp time in rapid motion
        tr_geom: 10_000,   // P-AXIS-00199: ramp time of the contour
        ..AxisData::new(name, AxisKind::Linear)
    }
}

/// Three linear axes, slope TRAPEZ, a cycle of 1 ms. The motion waits for the acknowledgement of M26.
pub const MACHINE: MachineData<AXES> = MachineData {
    axes: [linear("X"), linear("Y"), linear("Z")],
    channel: ChannelData {
        cycle_us: 1000,
        slope_profile: 1,                                  // P-CHAN-00071: TRAPEZ
        corr_v_trans_jerk: true,                           // P-CHAN-00009: limited jerk at tangential joints
        m_synch: SynchTable::NONE.with(26, Synch::MvsSvs), // P-CHAN-00041
        ..ChannelData::new()
    },
};
