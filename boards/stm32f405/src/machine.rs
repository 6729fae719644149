//! Machine data of this board: edit it for your machine. Units and ranges are those of `glidepath::machine`.
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};

/// Number of blocks in the look-ahead.
pub const BLOCKS: usize = 120;

const fn linear(letter: &str) -> AxisData {
    let name = match AxisName::new(letter) {
        Some(name) => name,
        None => panic!("an axis name is one to four letters"),
    };
    AxisData {
        vb_eilgang: 1_000_000,
        vb_max: 1_000_000,
        a_max: 6_000,
        tr_geom: 10_000,
        a_beschl: 2_000,
        a_brems: 2_000,
        a_grenz: 2_000,
        tr_beschl_ab: 150_000,
        tr_beschl_zu: 150_000,
        tr_brems_ab: 150_000,
        tr_brems_zu: 150_000,
        tr_grenz: 150_000,
        ..AxisData::new(name, AxisKind::Linear)
    }
}

/// Three linear axes with slope TRAPEZ at a cycle of 1 ms. Jerk is limited at tangential transitions of lines
/// and arcs too; by default (P-CHAN-00009 = 0) it is not limited there.
pub const MACHINE: MachineData<{ crate::AXES }> = MachineData {
    axes: [linear("X"), linear("Y"), linear("Z")],
    channel: ChannelData { cycle_us: 1000, slope_profile: 1, corr_v_trans_jerk: true, ..ChannelData::new() },
};
