//! Axis names that begin like another address of the language would change the meaning of its words.
use glidepath::channel::{Channel, MachineError};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::quantity::Position;

fn refusal(name: &str, kind: AxisKind) -> Option<MachineError> {
    let name = AxisName::new(name).expect("a name");
    let channel = ChannelData { slope_profile: 1, corr_v_trans_jerk: true, ..ChannelData::new() };
    let machine = MachineData { axes: [AxisData::new(name, kind)], channel };
    let program: &[u8] = b"M30\n";
    Channel::<1, 120>::new().split(&machine, [Position::ZERO], program).err()
}

#[test]
fn addresses_are_refused_as_axis_names() {
    for name in ["M", "F", "G", "N", "P", "S1", "T", "R", "I", "L"] {
        assert!(matches!(refusal(name, AxisKind::Linear), Some(MachineError::Reserved(_))), "{name}");
        assert!(matches!(refusal(name, AxisKind::Rotary), Some(MachineError::Reserved(_))), "{name}");
    }
    for name in ["X", "X1", "A", "C", "U", "Z2"] {
        assert_eq!(refusal(name, AxisKind::Linear), None, "{name}");
    }
    assert_eq!(refusal("S", AxisKind::Spindle), None);
}
