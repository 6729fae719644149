//! The machines of the cases: dynamics of the ISG examples (inventory D3-236) with slope TRAPEZ and a cycle
//! of 1 ms; two stages for STEP.
use super::{DEEP, SHORT};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};

const fn name(letter: &str) -> AxisName {
    match AxisName::new(letter) {
        Some(name) => name,
        None => panic!("an axis name is one to four letters"),
    }
}

const fn axis(data: AxisData, a: u32, ramp_us: u32) -> AxisData {
    AxisData {
        a_beschl: a,
        a_brems: a,
        a_grenz: a,
        a_stufe: [a, a / 5 * 3],
        d_stufe: [a / 5 * 4, 0],
        a_grenz_stufe: [a / 5 * 3, a],
        tr_beschl_ab: ramp_us,
        tr_beschl_zu: ramp_us,
        tr_brems_ab: ramp_us,
        tr_brems_zu: ramp_us,
        tr_grenz: ramp_us,
        tr_geom: 10_000,
        ..data
    }
}

const fn linear(letter: &str) -> AxisData {
    let data = AxisData::new(name(letter), AxisKind::Linear);
    axis(AxisData { vb_eilgang: 1_000_000, vb_max: 1_000_000, a_max: 6_000, ..data }, 2_000, 150_000)
}

const fn rotary(letter: &str) -> AxisData {
    let data = AxisData::new(name(letter), AxisKind::Rotary);
    axis(AxisData { vb_eilgang: 120_000, vb_max: 120_000, a_max: 2_000, ..data }, 2_000, 60_000)
}

/// Jerk is limited at tangential joints of lines and arcs too: by default (P-CHAN-00009 = 0) it is not.
const CHANNEL: ChannelData =
    ChannelData { slope_profile: 1, corr_v_trans_jerk: true, surface: true, ..ChannelData::new() };

/// X, Y and Z.
pub const AXES_3: MachineData<3> =
    MachineData { axes: [linear("X"), linear("Y"), linear("Z")], channel: CHANNEL };

/// X, Y, Z and the rotary axis C.
pub const AXES_4: MachineData<4> =
    MachineData { axes: [linear("X"), linear("Y"), linear("Z"), rotary("C")], channel: CHANNEL };

/// X, Y, Z and the rotary axes A, B and C, with PTP.
pub const AXES_6: MachineData<6> = MachineData {
    axes: [linear("X"), linear("Y"), linear("Z"), rotary("A"), rotary("B"), rotary("C")],
    channel: ChannelData { ptp: true, ..CHANNEL },
};

/// X, Y, Z and the rotary axes C and A of a head, with HSC.
#[cfg(feature = "five")]
pub const AXES_5: MachineData<5> = MachineData {
    axes: [linear("X"), linear("Y"), linear("Z"), rotary("C"), rotary("A")],
    channel: ChannelData { slope_profile: 3, ..CHANNEL },
};

/// The same with a short look-ahead, which one line of several chords makes the most of.
pub const AXES_3_SHORT: MachineData<3> =
    MachineData { channel: ChannelData { look_ahead: SHORT as _, merge_chords: 50, ..CHANNEL }, ..AXES_3 };

/// The same with a deep one.
pub const AXES_3_DEEP: MachineData<3> =
    MachineData { channel: ChannelData { look_ahead: DEEP as _, ..CHANNEL }, ..AXES_3 };

/// Six axes with a short look-ahead.
pub const AXES_6_SHORT: MachineData<6> =
    MachineData { channel: ChannelData { look_ahead: SHORT as _, ..AXES_6.channel }, ..AXES_6 };
