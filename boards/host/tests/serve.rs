//! `glidepath serve`: a conversation over TCP.
mod talk;

use std::io::Read;
use std::net::TcpStream;
use talk::Talk;

#[test]
fn a_program_runs_and_its_end_is_exact() {
    let mut talk = Talk::new();
    assert_eq!(talk.ask("G21 G90 G94 G17"), ["ok"]);
    for i in 1..=100 {
        assert_eq!(talk.ask(&format!("G1 X{} Y{}.5 F6000", i % 7, i % 5)), ["ok"]);
    }
    assert_eq!(talk.ask("G4 P0.01"), ["ok"]);
    // `G4` is answered at rest.
    assert!(talk.report().starts_with("<Idle|MPos:2.000,0.500,0.000|"));
    assert_eq!(talk.ask("M3 S1200"), ["ok"]);
    assert_eq!(talk.ask("$G"), ["[GC:G1 G54 G17 G21 G90 G94 M3 M9 T0 F6000 S1200]", "ok"]);
    // Inch.
    assert_eq!(talk.ask("G20"), ["ok"]);
    assert_eq!(talk.ask("G0 X1"), ["ok"]);
    assert_eq!(talk.ask("G4 P0.01"), ["ok"]);
    assert!(talk.report().starts_with("<Idle|MPos:25.400,"));
    let error = talk.ask("G77");
    assert_eq!(error.last().map(String::as_str), Some("error:20"));
    assert!(error[0].starts_with("[MSG:column 1: ") && error[0].contains("G77"), "{error:?}");
    // What was in force is in force behind the refused line.
    assert_eq!(talk.ask("X2"), ["ok"]);
    assert_eq!(talk.ask("G4 P0.01"), ["ok"]);
    assert!(talk.report().starts_with("<Idle|MPos:50.800,"));
    assert_eq!(talk.ask("M30"), ["ok"]);
    assert_eq!(talk.ask("$G"), ["[GC:G1 G54 G17 G20 G90 G94 M5 M9 T0 F6000 S1200]", "ok"]);
}

#[test]
fn hold_resume_reset_and_jog() {
    let mut talk = Talk::new();
    assert_eq!(talk.ask("G1 X300 F600"), ["ok"]);
    talk.until("<Run|");
    talk.send(b"!");
    let held = talk.until("<Hold:0|");
    let place = |report: &str| report.split(['|', ',']).nth(1).map(str::to_owned);
    assert_eq!(place(&talk.report()), place(&held));
    assert_eq!(talk.ask("$$"), ["error:8"]);
    talk.send(b"~");
    talk.until("<Run|");
    // The rest is dropped where the axes come to rest.
    talk.send(b"\x18");
    assert_eq!([talk.line(), talk.line()], ["", "Grbl 1.1h ['$' for help]"]);
    let stands = talk.report();
    assert!(stands.starts_with("<Idle|") && place(&stands) != place(&held), "{stands}");
    assert_eq!(talk.ask("G1 X0 Y0 F60000"), ["ok"]);
    assert_eq!(talk.ask("G4 P0"), ["ok"]);
    // A jog is cancelled, and leaves the modal words alone.
    assert_eq!(talk.ask("G91"), ["ok"]);
    assert_eq!(talk.ask("$J=G90X-500F600"), ["ok"]);
    talk.until("<Jog|");
    assert_eq!(talk.ask("X1"), ["error:9"]);
    talk.send(b"\x85");
    talk.until("<Idle|");
    assert_eq!(talk.ask("$G").first().map(|words| words.contains("G91")), Some(true));
    assert_eq!(talk.ask("$J=G90 G21 X1 Y1 Z1 F60000"), ["ok"]);
    let end = talk.until("<Idle|");
    assert!(end.starts_with("<Idle|MPos:1.000,1.000,1.000|"), "{end}");
    assert_eq!(talk.ask("G0 X1"), ["ok"]);
    assert_eq!(talk.ask("G4 P0"), ["ok"]);
    assert!(talk.report().starts_with("<Idle|MPos:2.000,1.000,1.000|"));
}

/// A setting changes the machine data: what is in force and where the axes stand outlive that.
#[test]
fn settings_are_machine_data() {
    let mut talk = Talk::new();
    assert_eq!(talk.ask("G20 G91 G1 X1 F100 M3 S100"), ["ok"]);
    assert_eq!(talk.ask("G4 P0"), ["ok"]);
    assert_eq!(talk.ask("$110=3000"), ["ok"]);
    let report = talk.until("<Idle|");
    assert!(report.starts_with("<Idle|MPos:25.400,0.000,0.000|Bf:15,128|FS:0,100|"), "{report}");
    assert_eq!(talk.ask("$G")[0], "[GC:G1 G54 G17 G20 G91 G94 M3 M9 T0 F2540 S100]");
    assert!(talk.ask("$$").contains(&"$110=3000.000".to_owned()));
    // The new speed counts: 50 mm/s.
    assert_eq!(talk.ask("G0 X40"), ["ok"]);
    let mut fastest = 0;
    loop {
        let report = talk.report();
        let feed = report.split("FS:").nth(1).and_then(|rest| rest.split(',').next()).map(str::to_owned);
        fastest = fastest.max(feed.and_then(|feed| feed.parse::<u32>().ok()).unwrap_or(0));
        if report.starts_with("<Idle|") {
            break;
        }
    }
    assert_eq!(fastest, 3000);
    for line in ["$120=0", "$110=99999999"] {
        assert_eq!(talk.ask(line).last().map(String::as_str), Some("error:52"), "{line}");
    }
    // Soft limits: the space of the machine lies below 0.
    assert_eq!(talk.ask("$20=1"), ["error:10"]);
    assert_eq!(talk.ask("$22=1"), ["ok"]);
    assert_eq!(talk.ask("$20=1"), ["ok"]);
    talk.until("<Idle|");
    assert_eq!(talk.ask("G0 X1").last().map(String::as_str), Some("error:33"));
}

#[test]
fn a_second_sender_is_sent_away() {
    let talk = Talk::new();
    let mut second = TcpStream::connect(&talk.address).expect("it listens");
    let mut told = String::new();
    second.read_to_string(&mut told).expect("it is told");
    assert_eq!(told, "[MSG:another sender is connected]\r\n");
}
