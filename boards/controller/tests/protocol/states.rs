//! Changes of state: jogs, homing, alarms, hold, door, sleep.
use crate::bench::{BLOCKS, Talk};
use crate::{in_state, mm};
use glidepath::quantity::Feed;
use glidepath_controller::{Homing, Signals, Spindle};

#[test]
fn jogs() {
    let mut talk = Talk::new();
    talk.mock.frozen = true;
    for (line, answer) in [
        ("$J=X1", "error:22"),
        ("$J=F100", "error:26"),
        ("$J=", "error:22"),
        ("$J=X1X2F100", "error:25"),
        ("$J=X1F100F200", "error:25"),
        ("$J=G20G21X1F100", "error:21"),
        ("$J=G90G91X1F100", "error:21"),
        ("$J=G1X1F100", "error:16"),
        ("$J=M3X1F100", "error:16"),
        ("$J=A1F100", "error:16"),
        ("$J=XF100", "error:2"),
        ("$J=1X", "error:1"),
        ("$J=X1F0", "error:22"),
        ("$J=X1F-5", "error:4"),
        ("$J=N10000000X1F5", "error:27"),
        ("$J=X1001F5", "error:15"),
        ("$J=G91X0.1F1000", "ok"),
        ("$j = g20 g91 y-1 f10", "ok"),
        ("$J=N5G53X5G91F100000", "ok"),
        ("$J=Z.5F1", "ok"),
    ] {
        talk.ask(line, &format!("{answer}\n"));
    }
    let jogs = &talk.mock.jogs;
    assert_eq!((jogs[0].axes, jogs[0].incremental), ([Some(mm(0.1)), None, None], true));
    assert_eq!((jogs[1].axes[1], jogs[1].feed), (Some(mm(-25.4)), Feed::from_num(254)));
    assert_eq!((jogs[2].machine, jogs[2].incremental), (true, false));
    assert_eq!((jogs[3].axes[2], jogs[3].incremental), (Some(mm(0.5)), false));
    assert_eq!(talk.state(), "Jog");
    // Cancelled: what is queued is dropped, and lines sent behind it count again.
    talk.send([0x85]);
    talk.send("G0X7\n");
    talk.poll();
    assert_eq!(talk.state(), "Jog");
    talk.mock.frozen = false;
    talk.settle();
    talk.said("ok\r\n");
    assert_eq!(
        (talk.mock.status.position[0], talk.mock.lines.last().map(String::as_str)),
        (mm(7.0), Some("G0X7"))
    );
    // Modal words of the program are not touched, and count where the jog has none.
    talk.ask("G91 G20", "ok\n");
    talk.mock.frozen = true;
    talk.ask("$J=X1F1", "ok\n");
    let last = talk.mock.jogs.last().expect("a jog");
    assert_eq!((last.incremental, last.axes[0]), (true, Some(mm(25.4))));
    // No more than fits: the answer waits.
    for _ in talk.mock.queue.len()..BLOCKS {
        talk.ask("$J=X.1F1", "ok\n");
    }
    talk.ask("$J=X.1F1", "");
    talk.mock.frozen = false;
    talk.settle();
    talk.said("ok\r\n");
    assert_eq!(talk.state(), "Idle");
}

#[test]
fn homing() {
    let mut talk = in_state("Home");
    talk.send("G21\n");
    talk.poll();
    talk.said("");
    talk.settle();
    talk.said("ok\r\nok\r\n");
    assert_eq!(talk.state(), "Idle");
    // Startup lines run before the answer.
    talk.ask("$N0=G55", "ok\n");
    talk.send("$H\n");
    talk.settle();
    talk.said(">G55:ok\r\nok\r\n");
    talk.mock.home_ends = Homing::Failed(9);
    talk.send("$H\n");
    talk.settle();
    talk.said("ALARM:9\r\nerror:9\r\n");
    assert_eq!(talk.state(), "Alarm");
    talk.signals = Signals::DOOR;
    talk.ask("$H", "error:13\n");
    talk.ask("$X", "error:13\n");
    let mut talk = Talk::new();
    talk.ask("$H", "error:5\n");
}

#[test]
fn alarms() {
    let mut talk = Talk::new();
    talk.ask("$21=1", "ok\n");
    talk.mock.frozen = true;
    talk.ask("G1X1", "ok\n");
    talk.signals = Signals::limit(1);
    talk.poll();
    talk.said("ALARM:1\r\n[MSG:Reset to continue]\r\n");
    assert_eq!(talk.state(), "Alarm");
    // Nothing but a reset helps, and reports are answered.
    talk.ask("$X", "");
    talk.send("?");
    talk.poll();
    assert!(talk.read().contains("|Pn:Y"));
    talk.send([0x18]);
    talk.mock.frozen = false;
    talk.settle();
    talk.said("\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n");
    talk.ask("G1X1", "error:9\n");
    talk.ask("$X", "[MSG:Caution: Unlocked]\nok\n");
    talk.ask("G1X1", "ok\n");
    // A probe without contact: not critical.
    talk.mock.alarm = Some(5);
    talk.poll();
    talk.said("ALARM:5\r\n");
    talk.ask("G1X1", "error:9\n");
    talk.ask("$X", "[MSG:Caution: Unlocked]\nok\n");
    // A line that waits for room is answered.
    talk.settle();
    talk.mock.frozen = true;
    for _ in 0..BLOCKS {
        talk.ask("G1X1", "ok\n");
    }
    talk.ask("G1X1", "");
    talk.mock.alarm = Some(2);
    talk.poll();
    talk.said("ALARM:2\r\n[MSG:Reset to continue]\r\nerror:9\r\n");
}

#[test]
fn hold_and_pause() {
    let mut talk = Talk::new();
    talk.mock.frozen = true;
    talk.ask("M3S1000G1X1", "ok\n");
    // A hold and a start in one look: the hold wins.
    talk.send("!~");
    talk.poll();
    assert_eq!(talk.state(), "Hold:1");
    talk.send("~");
    talk.settle();
    assert_eq!(talk.state(), "Hold:0");
    // Lines are queued meanwhile.
    talk.ask("G1X2", "ok\n");
    // The spindle stops and comes back by hand, in a hold alone.
    talk.send([0x9e]);
    talk.poll();
    assert_eq!(talk.controller.outputs().spindle, Spindle::Off);
    talk.send([0x9e]);
    talk.poll();
    assert_eq!(talk.controller.outputs().spindle, Spindle::Clockwise);
    talk.send([0x9e]);
    talk.poll();
    talk.send("~");
    talk.poll();
    assert_eq!(talk.controller.outputs().spindle, Spindle::Clockwise);
    assert_eq!(talk.state(), "Run");
    talk.send([0x9e]);
    talk.poll();
    assert_eq!(talk.controller.outputs().spindle, Spindle::Clockwise);
    talk.mock.frozen = false;
    talk.settle();
    assert_eq!((talk.state().as_str(), talk.mock.status.position[0]), ("Idle", mm(2.0)));
    talk.ask("M0", "ok\n");
    talk.poll();
    assert_eq!(talk.state(), "Hold:0");
    talk.ask("G1X3", "ok\n");
    talk.settle();
    assert_eq!(talk.mock.status.position[0], mm(2.0));
    talk.send("~");
    talk.settle();
    assert_eq!((talk.state().as_str(), talk.mock.status.position[0]), ("Idle", mm(3.0)));
    // By pin: on its edge.
    talk.signals = Signals::HOLD;
    talk.poll();
    assert_eq!(talk.state(), "Hold:0");
    talk.signals = Signals::HOLD.and(Signals::START);
    talk.poll();
    assert_eq!(talk.state(), "Idle");
}

#[test]
fn door() {
    let mut talk = Talk::new();
    talk.mock.frozen = true;
    talk.ask("M4S500M8G1X1", "ok\n");
    talk.signals = Signals::DOOR;
    talk.poll();
    assert_eq!(talk.state(), "Door:2");
    assert_eq!(talk.controller.outputs().spindle, Spindle::CounterClockwise);
    talk.settle();
    assert_eq!(talk.state(), "Door:1");
    assert_eq!((talk.controller.outputs().spindle, talk.controller.outputs().flood), (Spindle::Off, false));
    talk.send("~");
    talk.poll();
    assert_eq!(talk.state(), "Door:1");
    talk.signals = Signals::default();
    talk.poll();
    assert_eq!(talk.state(), "Door:0");
    talk.send("~");
    talk.poll();
    let begun = talk.now_ms;
    assert_eq!(talk.state(), "Door:3");
    for (ms, spindle, flood, state) in [
        (0, true, false, "Door:3"),
        (3999, true, false, "Door:3"),
        (4000, true, true, "Door:3"),
        (5000, true, true, "Run"),
    ] {
        talk.now_ms = begun + ms;
        talk.poll();
        let outputs = talk.controller.outputs();
        assert_eq!((outputs.spindle != Spindle::Off, outputs.flood), (spindle, flood), "{ms} ms");
        assert_eq!(talk.state(), state, "{ms} ms");
    }
    // Open again while it comes back.
    talk.signals = Signals::DOOR;
    talk.settle();
    talk.signals = Signals::default();
    talk.send("~");
    talk.poll();
    talk.signals = Signals::DOOR;
    talk.poll();
    assert_eq!(talk.state(), "Door:1");
    assert_eq!(talk.controller.outputs().spindle, Spindle::Off);
}

#[test]
fn sleep_ends_by_a_reset_and_locks() {
    let mut talk = in_state("Sleep");
    talk.send("G21\n$X\n");
    talk.settle();
    talk.said("");
    assert!(!talk.controller.outputs().motors);
    talk.send([0x18]);
    talk.settle();
    talk.said("\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n");
}

#[test]
fn outputs_have_the_speed_of_the_settings() {
    let mut talk = Talk::new();
    for line in ["$30=10000", "$31=1000", "$1=100"] {
        talk.ask(line, "ok\n");
    }
    for (line, rpm, duty) in [
        ("M3S5500", 5500, 32_767),
        ("S100", 1000, 0),
        ("S20000", 10_000, 65_535),
        ("S0", 0, 0),
        ("M5S5000", 0, 0),
    ] {
        talk.ask(line, "ok\n");
        let outputs = talk.controller.outputs();
        assert_eq!((outputs.rpm, outputs.duty), (rpm, duty), "{line}");
    }
    // Motors keep their current for a while, or for ever.
    talk.ask("G1X1", "ok\n");
    talk.settle();
    assert!(talk.controller.outputs().motors);
    talk.now_ms += 200;
    talk.poll();
    assert!(!talk.controller.outputs().motors);
    talk.ask("$1=255", "ok\n");
    assert!(talk.controller.outputs().motors);
}
