//! Homing and probing with simulated switches: hysteresis of 20 µm, bounce, and a hard stop after each
//! switch.
mod bench;

use bench::homing::{HARD_STOP, home};
use bench::world::{Rig, SLOTS, Switch, World, mm, settings, with_rig};
use glidepath_controller::{Settings, Signals};

const AXES: usize = bench::AXES;

/// 10,000 machines: `cargo run -p glidepath-controller --release --example homing`.
#[test]
fn sixty_machines_are_homed() {
    let fresh = bench::fresh_seed();
    for seed in (0..40).chain(fresh..fresh + 20) {
        home(seed);
    }
}

fn homing_settings() -> Settings<AXES> {
    let mut settings = settings();
    settings.homing = true;
    settings
}

fn switches() -> World {
    let mut world = World::new(1);
    for axis in 0..AXES {
        world.limits[axis] = Some(Switch::new(10.0, 1.0));
    }
    world
}

/// Each alarm of homing.
#[test]
fn homing_that_fails() {
    // No switch within one and a half times the travel.
    let mut world = switches();
    world.limits[0].as_mut().expect("a switch").broken = true;
    with_rig(&homing_settings(), world, |rig| {
        assert_eq!(rig.ask("$H"), "ALARM:9\nerror:9\n");
        assert_eq!(rig.state(), "Alarm");
        assert_eq!(rig.ask("G0X1"), "error:9\n");
        assert_eq!(rig.ask("$X"), "[MSG:Caution: Unlocked]\nok\n");
        assert_eq!(rig.ask("G0X1"), "ok\n");
    });
    // The way off the switch is shorter than its hysteresis.
    let mut world = switches();
    world.limits[2].as_mut().expect("a switch").hysteresis = 3.0;
    with_rig(&homing_settings(), world, |rig| {
        assert_eq!(rig.ask("$H"), "ALARM:8\nerror:9\n");
    });
    // A reset and the door in between.
    with_rig(&homing_settings(), switches(), |rig| {
        rig.send("$H\n");
        rig.ticks(300);
        assert_eq!(rig.state(), "Home");
        rig.send([0x18]);
        rig.ticks(300);
        let said = rig.read();
        assert!(said.starts_with("ALARM:6\r\n") && said.contains("Grbl 1.1h"), "{said}");
        assert_eq!(rig.state(), "Alarm");
        assert_eq!(rig.ask("$H"), "ok\n");
        rig.send("$H\n");
        rig.ticks(300);
        rig.world.signals = Signals::DOOR;
        rig.ticks(10);
        assert_eq!(rig.read(), "ALARM:7\r\nerror:9\r\n");
        rig.world.signals = Signals::default();
        // The axes still brake.
        rig.ticks(300);
        assert_eq!(rig.ask("$H"), "ok\n");
    });
    rig_without_homing();
}

fn rig_without_homing() {
    with_rig(&settings(), switches(), |rig| assert_eq!(rig.ask("$H"), "error:5\n"));
}

/// A limit switch stops the machine and locks it; the position stays exact.
#[test]
fn hard_limits() {
    let mut settings = settings();
    settings.hard_limits = true;
    with_rig(&settings, switches(), |rig| {
        rig.ask("G1X30F3000");
        for _ in 0..2000 {
            rig.tick();
        }
        let said = rig.read();
        assert_eq!(said, "ALARM:1\r\n[MSG:Reset to continue]\r\n");
        assert!(rig.at(0) > 10.0 && rig.at(0) < 10.0 + HARD_STOP, "{}", rig.at(0));
        let report = rig.report();
        assert!(report.starts_with("<Alarm|") && report.contains("|Pn:X"), "{report}");
        rig.send([0x18]);
        rig.ticks(50);
        assert_eq!(
            rig.ask("$X"),
            "\nGrbl 1.1h ['$' for help]\n[MSG:'$H'|'$X' to unlock]\n[MSG:Caution: Unlocked]\nok\n"
        );
        // Back off the switch.
        let stands = rig.points[0];
        assert_eq!(rig.ask("$J=G91X-5F1000"), "ok\n");
        rig.until("Idle");
        assert_eq!(rig.points[0], stands - mm(5.0));
    });
}

/// The plane that the probe touches: below, across Z.
fn probing_world(at: f64) -> World {
    let mut world = World::new(3);
    let mut switch = Switch::new(at, -1.0);
    switch.bounce = 30;
    world.probe = Some((2, switch));
    world
}

/// The coordinates of `[PRB:…]`, and whether it was contact.
fn told(said: &str) -> (Vec<f64>, bool) {
    let line = said.lines().find(|line| line.starts_with("[PRB:")).expect("a place");
    let (place, contact) =
        line.trim_start_matches("[PRB:").trim_end_matches(']').rsplit_once(':').expect("a flag");
    (place.split(',').map(|axis| axis.parse().expect("a number")).collect(), contact == "1")
}

#[test]
fn probing() {
    for feed in [50.0, 400.0, 1500.0] {
        with_rig(&settings(), probing_world(-7.123_456), |rig| {
            assert_eq!(rig.ask("G0X2"), "ok\n");
            let said = rig.ask(&format!("G38.2 Z-20 F{feed}"));
            assert!(said.ends_with("]\nok\n") && said.lines().count() == 2, "{said}");
            let (place, contact) = told(&said);
            assert!(
                contact && (place[2] + 7.123_456).abs() <= 0.000_51 + feed / 60e3 / f64::from(SLOTS),
                "{said}"
            );
            // It braked behind it, and stands where it says.
            let stands = rig.at(2);
            assert!(
                stands <= -7.123_456
                    && stands > -7.123_456 - feed / 60.0 * feed / 60.0 / 1600.0 - feed / 60.0 * 0.1
            );
            assert_eq!(rig.state(), "Idle");
            assert_eq!(
                rig.ask("$G").lines().next(),
                Some(format!("[GC:G38.2 G54 G17 G21 G90 G94 M5 M9 T0 F{feed} S0]").as_str())
            );
            // The usual next words.
            rig.ask("G10L20P0Z0");
            assert_eq!(rig.ask("G91G0Z2"), "ok\n");
            rig.ask("G90");
            rig.ask("G4P0");
            assert_eq!(rig.points[2].to_num::<f64>(), stands + 2.0);
            // And away: from contact to open, by the motion word in force.
            rig.ask("G53G0Z-7.2");
            let said = rig.ask("G38.4Z9");
            let (place, contact) = told(&said);
            assert!(contact && (place[2] + 7.103).abs() < 0.002 + feed / 60e3, "{said}");
        });
    }
}

#[test]
fn probing_that_fails() {
    with_rig(&settings(), probing_world(-7.0), |rig| {
        // No contact.
        assert_eq!(rig.ask("G38.2Z-5F600"), "ALARM:5\n[PRB:0.000,0.000,-5.000:0]\nok\n");
        assert_eq!(rig.state(), "Alarm");
        rig.ask("$X");
        assert_eq!(rig.ask("G38.3Z-6F600"), "[PRB:0.000,0.000,-6.000:0]\nok\n");
        assert_eq!(rig.state(), "Idle");
        assert_eq!(rig.ask("$#").lines().rev().nth(1), Some("[PRB:0.000,0.000,-6.000:0]"));
        // The input is in its end state before.
        assert_eq!(rig.ask("G38.4Z0F600"), "ALARM:4\nok\n");
        rig.ask("$X");
        assert_eq!(rig.ask("G0Z-8"), "ok\n");
        assert_eq!(rig.ask("G38.2Z-9F600"), "ALARM:4\nok\n");
        assert_eq!(rig.at(2), -8.0);
        rig.ask("$X");
        rig.ask("G0Z0");
        rig.ask("G4P0");
        assert!(rig.ask("G38.2Z-9F0").ends_with("error:22\n"));
        assert!(rig.ask("G38.2F100").ends_with("error:26\n"));
        // A reset while it moves.
        rig.ask("G0Z5");
        rig.send("G38.2Z-9F60\n");
        rig.ticks(1000);
        rig.send([0x18]);
        rig.ticks(200);
        assert_eq!(rig.read(), "\r\nGrbl 1.1h ['$' for help]\r\n");
        let stands = rig.points;
        assert_eq!(rig.ask("G0X1"), "ok\n");
        assert_eq!((rig.points[1], rig.points[2]), (stands[1], stands[2]));
    });
}

/// Nothing moves beyond the travel: refused before it begins.
#[test]
fn soft_limits() {
    let mut settings = homing_settings();
    settings.soft_limits = true;
    with_rig(&settings, switches(), |rig| {
        let begins = |rig: &mut Rig<'_>| rig.ask("$H");
        assert_eq!(begins(rig), "ok\n");
        let stands = rig.points;
        assert!(rig.ask("G0X-61").ends_with("error:33\n"));
        let said = rig.ask("$J=G91X5F1000");
        assert!(said.ends_with("error:15\n"), "{said}");
        assert!(rig.ask("G38.2X-70F100").ends_with("error:33\n"));
        assert!(rig.ask("G2X-1Y-5J-2F1000").ends_with("error:33\n"), "an arc bulges beyond its ends");
        assert_eq!(rig.points, stands);
        assert_eq!(rig.state(), "Idle");
        assert_eq!(rig.ask("G0X-59"), "ok\n");
    });
}
