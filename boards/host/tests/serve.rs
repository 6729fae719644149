//! `glidepath serve`: a conversation over TCP.
mod talk;

use std::io::Read;
use std::net::TcpStream;
use std::process::Command;
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

/// In contour mode a block waits for the next one. Where no line comes, it is executed without; a probing line and a jog
/// do not wait for it.
#[test]
fn the_last_block_in_contour_mode_is_executed() {
    let mut talk = Talk::new();
    for line in ["G64P0.1", "G1X5F6000", "Y5"] {
        assert_eq!(talk.ask(line), ["ok"]);
    }
    let end = talk.until("<Idle|");
    assert!(end.starts_with("<Idle|MPos:5.000,5.000,0.000|"), "{end}");
    assert_eq!(talk.ask("X4"), ["ok"]);
    assert_eq!(talk.ask("G38.3Z-2F5000"), ["[PRB:4.000,5.000,-2.000:0]", "ok"]);
    assert_eq!(talk.ask("$J=G91X1F6000"), ["ok"]);
    let end = talk.until("<Idle|");
    assert!(end.starts_with("<Idle|MPos:5.000,5.000,-2.000|"), "{end}");
    // In a hold the block waits for the end of the hold.
    assert_eq!(talk.ask("G1X9"), ["ok"]);
    talk.send(b"!");
    talk.until("<Hold:0|");
    std::thread::sleep(std::time::Duration::from_millis(50));
    talk.send(b"~");
    let end = talk.until("<Idle|");
    assert!(end.starts_with("<Idle|MPos:9.000,5.000,-2.000|"), "{end}");
}

fn store(name: &str) -> String {
    let path = format!("{}/{name}.store", env!("CARGO_TARGET_TMPDIR"));
    let _ = std::fs::remove_file(&path);
    path
}

/// What the command says where it does not begin.
fn refused(path: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_glidepath"))
        .args(["serve", "--tcp", "0", "--once", "--store", path])
        .output()
        .expect("the command starts");
    assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Settings, offsets, places, and texts come back, also where the command was killed.
#[test]
fn a_store_outlives_the_command() {
    let path = store("outlives");
    let options = ["--store", path.as_str()];
    let mut talk = Talk::with(&options, 0);
    let factory = talk.ask("$$");
    for line in ["$110=3000", "$100=123.456", "$27=2.5", "G10L2P1X1Y2Z3", "G10L2P9X-7", "$I=mine"] {
        assert_eq!(talk.ask(line), ["ok"], "{line}");
    }
    for line in ["G53G0X5Y6Z7", "G28.1", "G53G0X-5Y-6Z-7", "G30.1", "G4P0", "$N1=G55", "$N0=G20"] {
        assert_eq!(talk.ask(line), ["ok"], "{line}");
    }
    talk.until("<Idle|");
    let asked = ["$$", "$#", "$I", "$N"];
    let kept = asked.map(|line| talk.ask(line));
    assert!(kept[1].contains(&"[G28:5.000,6.000,7.000]".to_owned()), "{:?}", kept[1]);
    // It is killed here.
    drop(talk);
    let mut talk = Talk::with(&options, 0);
    let mut found = asked.map(|line| talk.ask(line));
    // The probe has not been anywhere.
    assert_eq!(found[1].iter().position(|line| line.starts_with("[PRB:")), Some(10));
    assert_eq!(found, kept);
    assert_eq!(talk.ask("$G")[0], "[GC:G0 G55 G17 G20 G90 G94 M5 M9 T0 F0 S0]");
    // The speed is in force: 50 mm/s.
    assert_eq!(talk.ask("G21 G0 X40"), ["ok"]);
    let report = talk.until("<Run|");
    assert!(report.contains("|FS:"), "{report}");
    assert_eq!(talk.ask("G4 P0"), ["ok"]);
    // Two commands do not share a file.
    assert!(refused(&path).contains("another process has the file"), "{}", refused(&path));
    // The values of the machine file again.
    assert_eq!(talk.ask("$RST=*").last().map(String::as_str), Some("ok"));
    assert_eq!([talk.line(), talk.line()], ["", "Grbl 1.1h ['$' for help]"]);
    talk.until("<Idle|");
    assert_eq!(talk.ask("$$"), factory);
    drop(talk);
    found = {
        let mut talk = Talk::with(&options, 0);
        asked.map(|line| talk.ask(line))
    };
    assert_eq!(found[0], factory);
    assert_eq!(found[3], ["$N0=", "$N1=", "ok"]);
}

/// A machine that homes begins locked, and a store that is damaged or none is refused and left alone.
#[test]
fn a_damaged_store_is_refused() {
    let path = store("damaged");
    let mut talk = Talk::with(&["--store", &path], 0);
    assert_eq!(talk.ask("$110=3000"), ["ok"]);
    assert_eq!(talk.ask("G10L2P1X1"), ["ok"]);
    drop(talk);
    let whole = std::fs::read(&path).expect("it was made");
    let used = whole.iter().rposition(|byte| *byte != 0xff).expect("records");
    for at in [0, 5, 512, 520, 600, used] {
        let mut changed = whole.clone();
        changed[at] ^= 4;
        std::fs::write(&path, &changed).expect("a file");
        let said = refused(&path);
        assert!(said.contains("damaged") && said.contains(&path), "{at}: {said}");
        assert_eq!(std::fs::read(&path).expect("it is there"), changed);
    }
    for text in ["G1 X1\n".repeat(10), "x".repeat(8192)] {
        std::fs::write(&path, &text).expect("a file");
        let said = refused(&path);
        assert!(said.contains("store has 8192") || said.contains("damaged"), "{said}");
        assert_eq!(std::fs::read_to_string(&path).expect("it is there"), text);
    }
    assert!(refused(env!("CARGO_TARGET_TMPDIR")).contains("serve: "));
}

/// A sender that counts nothing fills the serial input during a hold: reports and the reset come nevertheless, and no line
/// is lost.
#[test]
fn real_time_bytes_act_behind_text_without_room() {
    let mut talk = Talk::new();
    assert_eq!(talk.ask("G21 G90"), ["ok"]);
    talk.send(b"!");
    talk.until("<Hold:0");
    let text: String = (0..400).map(|i| format!("G1 X{}.250 Y{}.125 F9000\n", i % 7, i % 5)).collect();
    talk.send(text.as_bytes());
    talk.until("<Hold:0");
    talk.send(b"~");
    for _ in 0..400 {
        let line = talk.line();
        assert_eq!(line, "ok");
    }
    assert!(talk.until("<Idle").contains("MPos:0.250,4.125,"));
    talk.send(b"!");
    talk.until("<Hold:0");
    talk.send(text.as_bytes());
    talk.send(b"\x18");
    let mut said = talk.line();
    while !said.starts_with("Grbl ") {
        said = talk.line();
    }
    // What stood before the reset is gone.
    assert_eq!(talk.ask("$X"), ["ok"]);
    assert!(talk.report().contains("MPos:0.250,4.125,"));
}
