//! The step output after planner and protocol: positions of the motors, counted from the pulses.
mod bench;

use bench::AXES;
use bench::world::{COUNTS, Motors, Rig, Switch, World, data, settings, with_rig};
use glidepath_controller::Settings;

/// A conversation with a machine that has motors.
fn with_motors(settings: &Settings<AXES>, world: World, talk: impl FnOnce(&mut Rig<'_>)) {
    let motors = Motors::new(&data(settings));
    with_rig(settings, world, |rig| {
        rig.motors = Some(motors);
        talk(rig);
    });
}

/// At rest each motor stands where its axis truly is, to a count.
#[track_caller]
fn motors_stand_at_axes(rig: &mut Rig<'_>) {
    rig.ticks(4);
    for axis in 0..AXES {
        let axis_at = rig.world.place(&rig.points, axis) * f64::from(COUNTS);
        let motor_at = rig.motors.as_ref().expect("motors").counts[axis] as f64;
        assert!((axis_at - motor_at).abs() <= 1.0, "axis {axis} at {axis_at}, its motor at {motor_at}");
    }
}

#[test]
fn motors_follow_programs_jogs_and_homing() {
    let mut settings = settings();
    settings.homing = true;
    settings.pull_off_milli = 2000;
    let mut world = World::new(3);
    for (limit, at) in world.limits.iter_mut().zip([11.3, 7.9, 5.1]) {
        let mut switch = Switch::new(at, 1.0);
        switch.bounce = 9;
        *limit = Some(switch);
    }
    with_motors(&settings, world, |rig| {
        assert_eq!(rig.ask("$X"), "[MSG:Caution: Unlocked]\nok\n");
        for line in ["G1X1Y-2.5Z0.4F3000", "G2X3.46I1.23J0", "G0X0Z-7", "G4P0"] {
            assert_eq!(rig.ask(line), "ok\n", "{line}");
        }
        motors_stand_at_axes(rig);
        // Machine coordinates change at its end, and no motor turns for that.
        assert_eq!(rig.ask("$H"), "ok\n");
        motors_stand_at_axes(rig);
        assert_eq!(rig.at(0), -2.0);
        for line in ["G53G1X-9.5Y-3.25F2000", "G4P0", "$J=G91Z-1.5F600"] {
            assert_eq!(rig.ask(line), "ok\n", "{line}");
        }
        rig.until("Idle");
        motors_stand_at_axes(rig);
        assert_eq!(rig.ask("$H"), "ok\n");
        motors_stand_at_axes(rig);
        assert_eq!(rig.motors.as_ref().expect("motors").drive.losses(), 0);
    });
}

/// Steps that are cut end within a tick, and come again with the next motion behind the standstill.
#[test]
fn steps_that_are_cut() {
    with_motors(&settings(), World::new(4), |rig| {
        assert_eq!(rig.ask("G1X20F3000"), "ok\n");
        rig.ticks(150);
        let motors = rig.motors.as_mut().expect("motors");
        motors.drive.cut();
        motors.drive.cut();
        rig.ticks(2);
        let at = rig.motors.as_ref().expect("motors").counts;
        assert!(at[0] > 400 && at[0] < 7000, "{at:?}");
        rig.until("Idle");
        let motors = rig.motors.as_ref().expect("motors");
        assert_eq!((motors.counts, motors.drive.losses()), (at, 1));
        assert_eq!(rig.ask("G91G1X-1.5F3000"), "ok\n");
        rig.until("Idle");
        rig.ticks(4);
        assert_eq!(rig.motors.as_ref().expect("motors").counts, [at[0] - 600, 0, 0]);
    });
}
