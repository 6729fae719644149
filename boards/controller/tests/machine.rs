//! The protocol together with planner, interpolator and a simulated machine.
mod bench;

use bench::world::{World, mm, settings, with_rig};
use glidepath_controller::{Signals, Spindle};

fn rig(talk: impl FnOnce(&mut bench::world::Rig<'_>)) {
    with_rig(&settings(), World::new(1), talk);
}

#[test]
fn numbers_of_refusals_are_grbls() {
    rig(|rig| {
        for (line, code) in [
            ("X", 2),
            ("G", 2),
            ("1", 1),
            ("=", 1),
            ("G1X1", 22),
            ("G1F0X1", 22),
            ("G77", 20),
            ("M101", 20),
            ("G0G1X1F10", 21),
            ("X1X2", 25),
            ("F1F2", 25),
            ("G92G0X1", 24),
            ("G10L2P1.5X0", 23),
            ("G92", 26),
            ("N10000000G0X1", 27),
            ("N-1", 27),
            ("G4", 28),
            ("G10L2X0", 28),
            ("G10L2P10X0", 29),
            ("G53G2X1Y1I1F10", 30),
            ("G80X1", 31),
            ("G2X1Y1F10", 35),
            ("G2X2Y0R0.5F10", 34),
            ("G2X1Y1I1J1R3F10", 33),
            ("G0X1P3", 36),
            ("G1X1F-5", 4),
            ("A1", 20),
            ("O100 sub", 20),
            ("N5 o<a> call [1]", 20),
            ("o1 if [0]", 20),
            ("O100", 20),
            ("M98 P1", 20),
            ("G0 X[1+1] M098 P1", 20),
            ("X#5 M[98] P1", 20),
            ("M99", 20),
            ("$J=X1", 22),
            ("$J=G2X1F100", 16),
        ] {
            let said = rig.ask(line);
            assert_eq!(said.lines().last(), Some(format!("error:{code}").as_str()), "{line}: {said}");
        }
        assert_eq!(rig.ask("G0X1"), "ok\n");
        assert_eq!(rig.ask("G4P0"), "ok\n");
        assert_eq!(rig.points[0], mm(1.0));
    });
}

#[test]
fn modal_words_outlive_refusals_program_ends_and_jogs() {
    rig(|rig| {
        let modal =
            |rig: &mut bench::world::Rig<'_>| rig.ask("$G").lines().next().unwrap_or_default().to_owned();
        assert_eq!(modal(rig), "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]");
        assert_eq!(rig.ask("G20 G91 G55 G18 G1 F10 S500 M3 M8 T3"), "ok\n");
        assert_eq!(modal(rig), "[GC:G1 G55 G18 G20 G91 G94 M3 M8 T3 F254 S500]");
        rig.ask("G21 G77");
        assert_eq!(modal(rig), "[GC:G1 G55 G18 G20 G91 G94 M3 M8 T3 F254 S500]");
        assert_eq!(rig.ask("$J=G90 G21 X2 F1000"), "ok\n");
        rig.until("Idle");
        assert_eq!(rig.points[0], mm(2.0));
        assert_eq!(modal(rig), "[GC:G1 G55 G18 G20 G91 G94 M3 M8 T3 F254 S500]");
        rig.ask("$J=G91 X50 F100");
        rig.ticks(50);
        rig.send([0x85]);
        rig.until("Idle");
        assert_eq!(modal(rig), "[GC:G1 G55 G18 G20 G91 G94 M3 M8 T3 F254 S500]");
        assert_eq!(rig.ask("M30"), "ok\n");
        assert_eq!(modal(rig), "[GC:G1 G54 G17 G20 G90 G94 M5 M9 T3 F254 S500]");
        rig.send([0x18]);
        rig.ticks(50);
        rig.read();
        assert_eq!(modal(rig), "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]");
    });
}

#[test]
fn offsets_and_places() {
    rig(|rig| {
        rig.ask("G0X3Y4Z-2");
        rig.ask("G4P0");
        assert_eq!(rig.ask("G10L20P1X0Y0Z0"), "ok\n");
        rig.ask("G28.1");
        rig.ask("G92X1");
        rig.ask("G43.1Z0.5");
        let said = rig.ask("$#");
        assert!(said.starts_with("[G54:3.000,4.000,-2.000]\n[G55:0.000,0.000,0.000]\n"), "{said}");
        assert!(said.contains(
            "[G28:3.000,4.000,-2.000]\n[G30:0.000,0.000,0.000]\n[G92:-1.000,0.000,0.000]\n[TLO:0.500]\n"
        ));
        let report = rig.report();
        assert!(report.contains("|WCO:2.000,4.000,-1.500"), "{report}");
        // Jogs count in work coordinates.
        rig.ask("$J=X5F3000");
        rig.until("Idle");
        assert_eq!(rig.points[0], mm(7.0));
        rig.send([0x18]);
        rig.ticks(20);
        rig.read();
        let said = rig.ask("$#");
        assert!(
            said.contains("[G54:3.000,4.000,-2.000]")
                && said.contains("[G92:0.000,0.000,0.000]\n[TLO:0.000]")
        );
        assert!(rig.ask("$RST=#").contains("[MSG:Restoring defaults]"));
        assert!(rig.ask("$#").starts_with("[G54:0.000,0.000,0.000]"));
    });
}

#[test]
fn check_mode_reads_line_by_line_and_moves_nothing() {
    rig(|rig| {
        assert_eq!(rig.ask("$C"), "[MSG:Enabled]\nok\n");
        assert_eq!(rig.ask("G1 X10 F100"), "ok\n");
        assert_eq!(rig.ask("X20"), "ok\n");
        assert_eq!(rig.ask("G38.2 Z-5"), "ok\n");
        assert!(rig.ask("G2 X0").ends_with("error:35\n"));
        assert_eq!(rig.state(), "Check");
        assert!(rig.ask("$C").starts_with("[MSG:Disabled]\nok\n"));
        assert_eq!(rig.points, [mm(0.0); 3]);
        rig.read();
        assert!(rig.ask("X1").ends_with("ok\n"));
    });
}

#[test]
fn hold_pause_and_reset_keep_the_position() {
    rig(|rig| {
        rig.ask("G1X50F3000");
        rig.ticks(200);
        rig.send("!");
        rig.until("Hold:0");
        let held = rig.points;
        rig.ticks(100);
        assert_eq!(rig.points, held);
        rig.send("~");
        rig.ticks(100);
        assert!(rig.points[0] > held[0]);
        rig.send([0x18]);
        rig.until("Idle");
        let stands = rig.points;
        assert_eq!(rig.ask("G91G0X1"), "error:9\n".replace("error:9\n", "ok\n"));
        rig.ask("G4P0");
        assert_eq!(rig.points[0], stands[0] + mm(1.0));
        // A pause and a tool change wait for `~`, and the line behind them too.
        for word in ["M0", "M6T2"] {
            rig.send(format!("{word}\n"));
            rig.until("Hold:0");
            assert_eq!(rig.read(), "");
            rig.send("~");
            rig.until("Idle");
            assert_eq!(rig.ask("G21"), "ok\n", "{word}");
        }
    });
}

/// A jog that is cancelled stands within the way that braking needs, and the position is kept to the last bit.
#[test]
fn a_cancelled_jog_ends_inside_its_braking_distance() {
    rig(|rig| {
        for (feed, wait) in [(6000.0, 400), (3000.0, 150), (6000.0, 37), (100.0, 300)] {
            rig.ask(&format!("$J=G91X40F{feed}"));
            rig.ask("$J=G91X40F6000");
            rig.ticks(wait);
            let from = rig.at(0);
            rig.send([0x85]);
            rig.until("Idle");
            // v²/2a, a ramp of jerk, and the ticks until the byte is read.
            let v: f64 = feed / 60.0;
            let most = v * v / (2.0 * 800.0) + v * 0.12 + 0.01;
            assert!(rig.at(0) - from <= most, "F{feed}: {} of {most} mm", rig.at(0) - from);
            let stands = rig.points;
            rig.ask("$J=G91X-1F6000");
            rig.until("Idle");
            assert_eq!(rig.points[0], stands[0] - mm(1.0));
        }
    });
}

/// G0 has an override of its own; feed and jog do not follow it.
#[test]
fn rapid_override() {
    rig(|rig| {
        let time = |rig: &mut bench::world::Rig<'_>, line: &str| {
            rig.ask("G0X0");
            rig.ask("G4P0");
            let from = rig.now_ms;
            rig.ask(line);
            rig.ask("G4P0");
            rig.now_ms - from
        };
        let full = time(rig, "G0X50");
        let feed = time(rig, "G1X50F1200");
        rig.send([0x97]);
        rig.tick();
        assert!(time(rig, "G0X50") > 3 * full, "25 % of rapid motion");
        assert!(time(rig, "G1X50F1200").abs_diff(feed) < 20);
        rig.send([0x95, 0x90, 0x92, 0x92, 0x92, 0x92, 0x92]);
        rig.tick();
        assert!(time(rig, "G1X50F1200") > feed * 3 / 2);
        assert!(time(rig, "G0X50").abs_diff(full) < 20);
    });
}

/// Each of two pauses in a row waits for a start of its own.
#[test]
fn two_pauses_in_a_row() {
    for lines in ["G1X1F3000\nM0\nM0\nG1X2\n", "M0\nM0\nG1X2F3000\n", "M0\nM6T1\nM60\nG1X2F3000\n"] {
        rig(|rig| {
            rig.send(lines);
            let (mut said, mut starts) = (String::new(), 0);
            for ticks in 0..20_000 {
                rig.tick();
                said += &rig.read();
                if ticks % 1000 == 999 {
                    // A pause is answered behind its start, not before.
                    let answers = said.matches("ok\r\n").count();
                    let before = lines.lines().take_while(|line| !line.starts_with('M')).count();
                    if starts < lines.matches('M').count() {
                        assert_eq!(answers, before + starts, "{lines}");
                        rig.send("~");
                        starts += 1;
                    }
                }
            }
            assert_eq!(said.matches("ok\r\n").count(), lines.lines().count(), "{lines}");
            // The switch of M1 is off.
            assert_eq!(rig.ask("M1"), "ok\n");
            assert_eq!(rig.state(), "Idle");
            assert_eq!(rig.points[0], mm(2.0), "{lines}");
        });
    }
}

/// A hold and a door act at once in a dwell, as at rest: the dwell goes on to its end, and the spindle is off behind an
/// open door.
#[test]
fn a_dwell_is_a_rest_for_hold_and_door() {
    rig(|rig| {
        assert_eq!(rig.ask("G1X2F3000M3S500"), "ok\n");
        rig.send("G4P30\n");
        rig.ticks(2000);
        rig.send("!");
        rig.ticks(2);
        assert_eq!((rig.state().as_str(), rig.at(0)), ("Hold:0", 2.0));
        rig.send("~");
        rig.ticks(2);
        assert_eq!(rig.state(), "Run");
        rig.world.signals = Signals::DOOR;
        rig.ticks(3);
        assert_eq!(rig.state(), "Door:1");
        assert_eq!(rig.controller.outputs().spindle, Spindle::Off);
        rig.world.signals = Signals::default();
        rig.ticks(2);
        rig.send("~");
        rig.ticks(2);
        assert_eq!(rig.state(), "Door:3");
        rig.ticks(4100);
        assert_eq!(rig.state(), "Run");
        rig.ticks(30_000);
        assert_eq!(rig.read(), "ok\r\n");
        assert_eq!(rig.state(), "Idle");
        // A line behind a dwell that ends in a hold waits for its end.
        rig.send("G4P0.2\nG1X1\n");
        rig.ticks(20);
        rig.send("!");
        rig.ticks(2000);
        assert_eq!((rig.state().as_str(), rig.at(0)), ("Hold:0", 2.0));
        rig.send("~");
        rig.until("Idle");
        assert_eq!(rig.at(0), 1.0);
    });
}

/// A reset in any tick: a pause, a dwell or a probing line at the end of a motion never keeps the banner back.
#[test]
fn a_reset_in_any_tick_ends_with_the_banner() {
    for last in ["M0", "M6", "G4P0.05", "G38.4Z-1F600", "G38.2Z-1F600", "M30"] {
        for ticks in 0..260 {
            rig(|rig| {
                rig.send(format!("G1X-4F3000\n{last}\nG1X-5\n"));
                rig.ticks(ticks);
                rig.send([0x18]);
                rig.ticks(400);
                let said = rig.read();
                assert!(said.contains("Grbl 1.1h"), "{last}, reset in tick {ticks}: {said}{}", rig.report());
                // An alarm before the reset locks the machine.
                let wanted = if said.contains("ALARM:") { "Alarm" } else { "Idle" };
                assert_eq!(rig.state(), wanted, "{last}, reset in tick {ticks}");
            });
        }
    }
}

/// A fault of the drives brakes and locks; also while a reset brakes, whose banner still follows.
#[test]
fn a_fault_of_the_drives_locks() {
    rig(|rig| {
        assert_eq!(rig.ask("G1X-30F3000"), "ok\n");
        rig.ticks(200);
        rig.machine.fault();
        rig.ticks(400);
        assert_eq!(rig.read(), "ALARM:17\r\n");
        assert_eq!(rig.state(), "Alarm");
        assert_eq!(rig.ask("G1X-1"), "error:9\n");
        assert_eq!(rig.ask("$X"), "[MSG:Caution: Unlocked]\nok\n");
        assert_eq!(rig.ask("G1X-20F3000"), "ok\n");
        rig.ticks(100);
        rig.send([0x18]);
        rig.ticks(2);
        rig.machine.fault();
        rig.ticks(400);
        let said = rig.read();
        assert_eq!(said, "ALARM:17\r\n\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n");
    });
}
