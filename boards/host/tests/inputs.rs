//! Inputs of `glidepath serve`: switches, the probe, and inputs that are pressed over the control port.
mod talk;

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use talk::Talk;

/// Who presses inputs.
struct Hand {
    stream: TcpStream,
    lines: BufReader<TcpStream>,
}

impl Hand {
    fn of(talk: &Talk) -> Self {
        let address = talk.ports[0].strip_prefix("control ").expect("a port");
        let stream = TcpStream::connect(address).expect("it listens");
        let lines = BufReader::new(stream.try_clone().expect("a second handle"));
        Self { stream, lines }
    }

    fn say(&mut self, line: &str) -> String {
        writeln!(self.stream, "{line}").expect("it reads");
        let mut answer = String::new();
        self.lines.read_line(&mut answer).expect("it answers");
        answer.trim_end().to_owned()
    }
}

fn talk() -> (Talk, Hand) {
    let talk = Talk::with(&["--control", "0"], 1);
    let hand = Hand::of(&talk);
    (talk, hand)
}

/// The switches are 101 mm from the start, a millimetre outside a travel of 200 mm.
#[test]
fn homing_finds_the_switches() {
    let (mut talk, _) = talk();
    assert_eq!(talk.ask("$H"), ["error:5"]);
    for line in ["$25=3000", "$21=1", "$22=1", "$23=3"] {
        assert_eq!(talk.ask(line), ["ok"]);
    }
    assert_eq!(talk.ask("$H"), ["ok"]);
    let report = talk.until("<Idle|");
    assert!(report.starts_with("<Idle|MPos:-199.000,-199.000,-1.000|"), "{report}");
    // Where it began, in the coordinates of the switches, and at the other end of X.
    assert_eq!(talk.ask("G0 X-99 Y-99 Z-101"), ["ok"]);
    let probed = talk.ask("G38.2 Z-150 F600");
    assert_eq!(probed.last().map(String::as_str), Some("ok"));
    // The plate is 20 mm below the start.
    let place =
        probed[0].strip_prefix("[PRB:-99.000,-99.000,-121.0").and_then(|rest| rest.strip_suffix(":1]"));
    assert!(place.is_some_and(|rest| rest == "00" || rest == "01"), "{probed:?}");
    assert_eq!(talk.ask("G0 X-1"), ["ok"]);
    assert_eq!(talk.ask("G1 X10 F1000"), ["ok"]);
    assert_eq!([talk.line(), talk.line()], ["ALARM:1", "[MSG:Reset to continue]"]);
    let report = talk.report();
    assert!(report.starts_with("<Alarm|MPos:2.") && report.contains("|Pn:X"), "{report}");
    talk.send(b"\x18");
    assert_eq!([talk.line(), talk.line()], ["", "Grbl 1.1h ['$' for help]"]);
    assert_eq!(talk.line(), "[MSG:'$H'|'$X' to unlock]");
    assert_eq!(talk.ask("$X"), ["[MSG:Caution: Unlocked]", "ok"]);
    // A setting that makes the machine anew on a switch is no alarm.
    assert_eq!(talk.ask("$110=4000"), ["ok"]);
    assert_eq!(talk.ask("$J=G91X-5F1000"), ["ok"]);
    // The probe still touches its plate.
    assert!(talk.until("<Idle|").contains("|Pn:P"));
}

#[test]
fn inputs_are_pressed_by_hand() {
    let (mut talk, mut hand) = talk();
    assert_eq!(talk.ask("M3 S500"), ["ok"]);
    assert_eq!(talk.ask("G1 X90 F3000"), ["ok"]);
    assert_eq!(hand.say("press door"), "ok");
    assert!(talk.until("<Door:1|").contains("|Pn:D"));
    talk.send(b"~");
    talk.until("<Door:1|");
    assert_eq!(hand.say("release door"), "ok");
    talk.until("<Door:0|");
    talk.send(b"~");
    talk.until("<Door:3|");
    talk.until("<Run|");
    assert_eq!(hand.say("press hold"), "ok");
    talk.until("<Hold:0|");
    assert_eq!(hand.say("release hold"), "ok");
    assert_eq!(hand.say("press start"), "ok");
    talk.until("<Idle|MPos:90.000,");
    assert_eq!(hand.say("press Y"), "ok");
    assert!(talk.until("<Idle|").contains("|Pn:YS"));
    assert_eq!(hand.say("release Y"), "ok");
    assert_eq!(hand.say("plate -2"), "ok");
    let probed = talk.ask("G38.2 Z-5 F60");
    assert!(probed[0].starts_with("[PRB:90.000,0.000,-2.000:1]"), "{probed:?}");
    assert_eq!(hand.say("plate off"), "ok");
    assert_eq!(talk.ask("G38.3 Z-5 F600"), ["[PRB:90.000,0.000,-5.000:0]", "ok"]);
    assert_eq!(hand.say("press probe"), "ok");
    assert_eq!(talk.ask("G38.2 Z-6 F600"), ["ALARM:4", "ok"]);
    assert_eq!(hand.say("press A"), "error: `A`: expected x, y, z, probe, door, hold, reset or start");
    assert_eq!(hand.say("plate x"), "error: `x`: expected a height in mm, or `off`");
    assert_eq!(
        hand.say("open"),
        "error: `open`: expected `press INPUT`, `release INPUT`, `plate MM` or `plate off`"
    );
    assert_eq!(hand.say("press reset"), "ok");
    assert_eq!([talk.line(), talk.line()], ["", "Grbl 1.1h ['$' for help]"]);
}
