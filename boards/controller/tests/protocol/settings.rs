//! Queries and settings.
use crate::bench::{Talk, names, serial};
use crate::mm;
use glidepath_controller::{Config, Message};

pub const OFFSETS: &str = "[G54:0.000,0.000,0.000]\r\n[G55:0.000,0.000,0.000]\r\n[G56:0.000,0.000,0.000]\r\n\
    [G57:0.000,0.000,0.000]\r\n[G58:0.000,0.000,0.000]\r\n[G59:0.000,0.000,0.000]\r\n[G28:0.000,0.000,0.000]\r\n\
    [G30:0.000,0.000,0.000]\r\n[G92:0.000,0.000,0.000]\r\n[TLO:0.000]\r\n[PRB:0.000,0.000,0.000:0]\r\nok\r\n";

pub fn all_settings(homing: u8) -> String {
    format!(
        "$0=10\n$1=25\n$2=0\n$3=0\n$4=0\n$5=0\n$6=0\n$10=3\n$11=0.010\n$12=0.002\n$13=0\n$20=0\n$21=0\n$22={homing}\n$23=0\n\
        $24=25.000\n$25=500.000\n$26=250\n$27=1.000\n$30=1000.000\n$31=0.000\n$32=0\n\
        $100=250.000\n$101=250.000\n$102=250.000\n$110=500.000\n$111=500.000\n$112=500.000\n\
        $120=10.000\n$121=10.000\n$122=10.000\n$130=200.000\n$131=200.000\n$132=200.000\nok\n"
    )
    .replace('\n', "\r\n")
}

#[test]
fn answers_to_queries() {
    let mut talk = Talk::new();
    talk.ask("$$", &all_settings(0).replace("\r\n", "\n"));
    talk.ask("$G", "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]\nok\n");
    talk.ask("G1 F1500.4 M3 S9000 T2 G55 G91 M7 M8", "ok\n");
    talk.ask("$G", "[GC:G1 G55 G17 G21 G91 G94 M3 M7 M8 T2 F1500 S9000]\nok\n");
    talk.mock.modal.motion = 382;
    talk.mock.modal.program = Some(30);
    talk.ask("$G", "[GC:G38.2 G55 G17 G21 G91 G94 M30 M3 M7 M8 T2 F1500 S9000]\nok\n");
    talk.mock.offsets.systems[1] = [mm(1.0), mm(-2.5), mm(0.0004)];
    talk.mock.offsets.g28 = [mm(-0.0005), mm(0.0), mm(-100.0)];
    talk.mock.offsets.tool[2] = mm(12.3456);
    (talk.mock.offsets.probe, talk.mock.offsets.probed) = ([mm(1.5); 3], true);
    talk.send("$#\n");
    talk.poll();
    let answer = talk.read();
    for row in ["[G55:1.000,-2.500,0.000]", "[G28:-0.001,0.000,-100.000]", "[TLO:12.346]"] {
        assert!(answer.contains(row), "{answer}");
    }
    assert!(answer.ends_with("[PRB:1.500,1.500,1.500:1]\r\nok\r\n"), "{answer}");
    talk.ask("$I=My mill", "ok\n");
    talk.ask("$I", "[VER:1.1h.20190825:MYMILL]\n[OPT:V,15,128]\nok\n");
    // In inch.
    talk.ask("$13=1", "ok\n");
    talk.mock.offsets.systems[1] = [mm(25.4), mm(-2.54), mm(0.0)];
    talk.send("$#\n");
    talk.poll();
    assert!(talk.read().contains("[G55:1.0000,-0.1000,0.0000]"));
    talk.ask("$G", "[GC:G38.2 G55 G17 G21 G91 G94 M30 M3 M7 M8 T2 F59.1 S9000]\nok\n");
}

#[test]
fn settings_have_their_codes() {
    let mut talk = Talk::new();
    for (line, answer) in [
        ("$0=2", "error:6"),
        ("$0=3", "ok"),
        ("$0=256", "error:52"),
        ("$1=-1", "error:4"),
        ("$1=a", "error:2"),
        ("$1=", "error:2"),
        ("$1=12b", "error:3"),
        ("$1", "error:3"),
        ("$14=1", "error:3"),
        ("$133=1", "error:3"),
        ("$256=1", "error:3"),
        ("$1.5=1", "error:3"),
        ("$20=1", "error:10"),
        ("$22=1", "ok"),
        ("$20=1", "ok"),
        ("$110=1234.5678", "ok"),
        ("$110=0", "error:52"),
        ("$110=99999999", "error:52"),
        ("$100=0", "error:52"),
        ("$100=1000000", "error:12"),
        ("$120=0.5", "error:52"),
        ("$32=1", "ok"),
        ("$30=24000", "ok"),
    ] {
        talk.ask(line, &format!("{answer}\n"));
    }
    let settings = talk.controller.settings();
    assert_eq!((settings.pulse_us, settings.soft_limits, settings.axes[0].rate_milli), (3, true, 1_234_567));
    talk.ask("$22=0", "ok\n");
    assert!(!talk.controller.settings().soft_limits, "soft limits need homing");
    // Neither a store that fails nor a machine that refuses changes anything.
    talk.memory.fails = true;
    talk.ask("$0=20", "error:7\n");
    talk.ask("$N0=G54", "error:7\n");
    talk.ask("$I=text", "error:7\n");
    (talk.memory.fails, talk.mock.refuses_settings) = (false, true);
    talk.ask("$0=20", "error:12\n");
    assert_eq!(talk.controller.settings().pulse_us, 3);
    assert!(talk.memory.kept.contains(&"settings 3".to_owned()));
}

/// `$21=2` cuts the steps: it is shown as it was set.
#[test]
fn hard_limits_have_three_values() {
    let mut talk = Talk::new();
    for (value, both) in [("2", (true, true)), ("1", (true, false)), ("0", (false, false))] {
        talk.ask(format!("$21={value}"), "ok\n");
        talk.send("$$\n");
        talk.poll();
        assert!(talk.read().contains(&format!("$21={value}\r\n")));
        let settings = talk.controller.settings();
        assert_eq!((settings.hard_limits, settings.limits_cut_steps), both);
    }
    talk.ask("$21=3", "error:52\n");
    talk.ask("$20=2", "error:10\n");
}

/// What a board has for defaults comes back; a store that fails is `error:7` and changes nothing.
#[test]
fn restoring_and_a_store_that_fails() {
    let mut config = Config::new(names());
    config.defaults.pulse_us = 7;
    config.notice = Message::try_from("watchdog").expect("short");
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.said("\r\nGrbl 1.1h ['$' for help]\r\n[MSG:watchdog]\r\n");
    talk.ask("$RST=$", "[MSG:Restoring defaults]\nok\n\nGrbl 1.1h ['$' for help]\n");
    assert_eq!(talk.controller.settings().pulse_us, 7);
    talk.memory.fails = true;
    for line in ["$RST=$", "$RST=*", "$N0=G55", "$I=A"] {
        talk.ask(line, "error:7\n");
    }
    talk.ask("$N", "$N0=\n$N1=\nok\n");
    talk.mock.offsets.g28 = [crate::mm(1.0); 3];
    talk.settle();
    talk.said("[MSG:work offsets are not stored]\r\n");
    talk.ask("$RST=#", "error:7\n");
    talk.memory.fails = false;
    talk.mock.offsets.g28 = [crate::mm(2.0); 3];
    // In motion nothing is stored.
    talk.mock.frozen = true;
    talk.memory.kept.clear();
    talk.ask("G0X1", "ok\n");
    talk.settle();
    assert!(talk.memory.kept.is_empty());
    talk.mock.frozen = false;
    talk.settle();
    assert_eq!(talk.memory.kept, ["offsets 0"]);
}

/// A controller that may have lost its position begins locked.
#[test]
fn a_build_may_begin_locked() {
    let mut config = Config::new(names());
    config.is_locked = true;
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.said("\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n");
    talk.ask("G0X1", "error:9\n");
}

#[test]
fn laser_mode_needs_a_variable_speed() {
    let mut config = Config::new(names());
    config.has_pwm = false;
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.read();
    talk.ask("$32=1", "error:17\n");
}
