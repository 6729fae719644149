//! Zero offsets G53…G59: machine data, calls at standstill, and programs.
use crate::nc_decode::decode_with;
use glidepath::channel::{Channel, Handles, MachineError, Planner, ZeroOffsetError};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::nc::{Command, Setup};
use glidepath::quantity::Position;
use glidepath::tick::{Interpolator, State};
use host_tests::calls::call;

/// X linear and C rotary; G54 is 10 mm and 1°, G56 -0.0001 mm.
fn machine() -> MachineData<2> {
    let axis = |name, kind| AxisData::new(AxisName::new(name).unwrap(), kind);
    let mut axes = [axis("X", AxisKind::Linear), axis("C", AxisKind::Rotary)];
    axes[0].versch = [100_000, 0, -1, 0, 0, 1_000_000_000];
    axes[1].versch = [10_000, 0, 0, 0, 0, 0];
    MachineData { axes, channel: ChannelData { slope_profile: 1, ..ChannelData::new() } }
}

/// Ends of all motions.
fn ends(machine: &MachineData<2>, text: &str) -> Vec<[f64; 2]> {
    let (out, _, error, _) = decode_with(Setup::new(machine, [Position::ZERO; 2]), text.as_bytes(), 1000);
    assert_eq!(error, None, "{text}");
    let motion = |c| if let Command::Motion(m) = c { Some(m.target.map(|p| p.to_num())) } else { None };
    out.into_iter().filter_map(motion).collect()
}

/// NC-004.
#[test]
fn machine_data_fill_g54_to_g59() {
    let ends = |text| ends(&machine(), text);
    assert_eq!(ends("G00 X1 C1"), [[1.0, 1.0]], "G53 at program start");
    assert_eq!(ends("G00 G54 X1\nC1"), [[11.0, 0.0], [11.0, 2.0]], "in the block that names it");
    assert_eq!(ends("G54\nG55 G00 X1"), [[1.0, 0.0]], "the second set is 0");
    assert_eq!(ends("G59 G00 X-1"), [[99_999.0, 0.0]]);
    let tenth = (-0.0001 * 4_294_967_296.0_f64).round() / 4_294_967_296.0;
    assert_eq!(ends("G56 G00 X0"), [[tenth, 0.0]], "0.1 µm, to nearest");
    assert_eq!(
        ends("G54 G70 G00 X1 C1"),
        [[10.0 + (25.4 * 4_294_967_296.0_f64).round() / 4_294_967_296.0, 2.0]]
    );
}

/// NC-004.
#[test]
fn an_offset_moves_nothing_by_itself_and_counts_for_absolute_positions() {
    let ends = |text| ends(&machine(), text);
    assert_eq!(ends("G54\nG00"), [[0.0; 2]; 0]);
    assert_eq!(ends("G54\nG91 G00 X0\nG90 X0"), [[0.0, 0.0], [10.0, 0.0]], "ISG: G91 X0 is no motion");
    assert_eq!(ends("G54 G92 X5\nG00 X1\nG53 X1"), [[16.0, 0.0], [6.0, 0.0]], "G53 leaves G92 alone");
}

/// NC-004.
#[test]
fn g53_is_modal() {
    assert_eq!(
        ends(&machine(), "G54 G00 X1\nG53 X1\nX2\nG54 X2"),
        [[11.0, 0.0], [1.0, 0.0], [2.0, 0.0], [12.0, 0.0]]
    );
}

/// NC-004.
#[test]
fn p_zero_00002_is_in_force_at_program_start() {
    let mut machine = machine();
    machine.channel.default_index = 1;
    assert_eq!(ends(&machine, "G00 X1\nG53 X1"), [[11.0, 0.0], [1.0, 0.0]]);
    machine.channel.default_index = 7;
    let mut channel = Channel::<2, 30>::new();
    machine.channel.look_ahead = 30;
    let refused = channel.split(&machine, [Position::ZERO; 2], b"M30".as_slice()).err();
    assert!(matches!(refused, Some(MachineError::Channel(e)) if e.id == "P-ZERO-00002"));
}

#[test]
fn offsets_beyond_the_coordinates_are_refused() {
    for versch in [1_000_000_001, i32::MIN] {
        let mut machine = machine();
        machine.channel.look_ahead = 30;
        machine.axes[1].versch[3] = versch;
        let mut channel = Channel::<2, 30>::new();
        let refused = channel.split(&machine, [Position::ZERO; 2], b"M30".as_slice()).err();
        assert!(matches!(refused, Some(MachineError::Axis(1, e)) if e.id == "P-ZERO-00003"), "{versch}");
    }
}

/// Runs until the planner says that it is done and nothing moves.
fn finish<'a>(
    planner: &mut Planner<'a, &'a [u8], 2, 30>,
    interpolator: &mut Interpolator<'a, 2>,
    mut at_each_tick: impl FnMut(&mut Planner<'a, &'a [u8], 2, 30>),
) -> [Position; 2] {
    for _ in 0..100_000 {
        let done = call(planner, usize::MAX, |_| {}).unwrap();
        at_each_tick(planner);
        if interpolator.tick() == State::Idle && done {
            let _ = planner.poll();
            return *interpolator.set_points();
        }
    }
    panic!("no end");
}

/// NC-004.
#[test]
fn an_offset_is_set_at_rest_and_not_on_the_way() {
    let mut machine = machine();
    machine.channel.look_ahead = 30;
    let mut channel = Channel::<2, 30>::new();
    let text = b"G54 G00 X1\nG01 X2 F100\n".as_slice();
    let Handles { mut planner, mut interpolator, .. } =
        channel.split(&machine, [Position::ZERO; 2], text).unwrap();
    let mm = Position::from_num::<i32>;
    assert_eq!(planner.set_zero_offset(6, 0, mm(1)), Err(ZeroOffsetError::Range));
    assert_eq!(planner.set_zero_offset(0, 2, mm(1)), Err(ZeroOffsetError::Range));
    assert_eq!(planner.set_zero_offset(0, 0, mm(100_001)), Err(ZeroOffsetError::Range));
    assert_eq!(planner.set_zero_offset(0, 0, mm(3)), Ok(()));
    let (mut calls, mut refused) = (0, 0);
    let end = finish(&mut planner, &mut interpolator, |planner| {
        calls += 1;
        refused += usize::from(planner.set_zero_offset(0, 0, mm(50)) == Err(ZeroOffsetError::NotAtRest));
    });
    assert_eq!(end, [mm(5), mm(0)], "with the offset set before the start");
    assert!(refused > 100 && refused >= calls - 1, "{refused} of {calls}");
    assert_eq!(planner.set_zero_offset(0, 0, mm(50)), Ok(()), "at the end of the program");
}
