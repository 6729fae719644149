//! Every byte, line and state of the protocol, with answers compared character for character.
mod bench;

use bench::{BLOCKS, BUFFER, Talk, names, serial};
use glidepath::quantity::{Feed, Position};
use glidepath_controller::{Config, Homing, LineText, Overrides, Signals, Spindle, Stored};

fn mm(value: f64) -> Position {
    Position::from_num(value)
}

/// A controller in a state of that name.
fn in_state(name: &str) -> Talk<'static> {
    let mut config = Config::new(names());
    config.settings.homing = true;
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.said("\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n");
    if name != "Alarm" {
        talk.ask("$X", "[MSG:Caution: Unlocked]\nok\n");
    }
    match name {
        "Run" => {
            talk.mock.frozen = true;
            talk.ask("G0X1", "ok\n");
        }
        "Hold:0" => talk.send("!"),
        "Hold:1" => {
            talk.mock.frozen = true;
            talk.ask("G0X1", "ok\n");
            talk.send("!");
        }
        "Jog" => {
            talk.mock.frozen = true;
            talk.ask("$J=X1F100", "ok\n");
        }
        "Door:0" => talk.send([0x84]),
        "Door:1" => talk.signals = Signals::DOOR,
        "Door:2" => {
            talk.mock.frozen = true;
            talk.ask("G0X1", "ok\n");
            talk.send([0x84]);
        }
        "Door:3" => {
            talk.mock.modal.spindle = Spindle::Clockwise;
            talk.mock.step();
            talk.send([0x84]);
            talk.poll();
            talk.send("~");
        }
        "Check" => talk.ask("$C", "[MSG:Enabled]\nok\n"),
        "Home" => {
            talk.send("$H\n");
            talk.poll();
            talk.said("");
        }
        "Sleep" => talk.ask("$SLP", "ok\n[MSG:Sleeping]\n"),
        _ => {}
    }
    talk.poll();
    talk.said("");
    assert_eq!(talk.state(), name);
    talk
}

const STATES: [&str; 13] = [
    "Idle", "Run", "Hold:0", "Hold:1", "Jog", "Alarm", "Door:0", "Door:1", "Door:2", "Door:3", "Check",
    "Home", "Sleep",
];

/// All 256 bytes in the middle of a line: what the motion side gets, and what state follows.
#[test]
fn bytes_in_a_line() {
    for byte in 0..=255_u8 {
        let mut talk = Talk::new();
        talk.send("g0x1");
        talk.send([byte]);
        talk.send("2\n");
        talk.settle();
        talk.settle();
        let said = talk.read();
        let lines: Vec<&str> = talk.mock.lines.iter().map(String::as_str).collect();
        let (wanted, answer): (&[&str], &str) = match byte {
            b'\n' | b'\r' => (&["G0X1"], "ok\r\nerror:1\r\n"),
            0x18 => (&[], "\r\nGrbl 1.1h ['$' for help]\r\nerror:1\r\n"),
            b'(' | b';' => (&["G0X1"], "ok\r\n"),
            b'.' => (&["G0X1.2"], "ok\r\n"),
            b'0'..=b'9' => (&["digit"], "ok\r\n"),
            b'X' | b'Y' | b'Z' | b'F' | b'S' | b'N' | b'P' | b'T' => (&["word"], "ok\r\n"),
            b'x' | b'y' | b'z' | b'f' | b's' | b'n' | b'p' | b't' => (&["word"], "ok\r\n"),
            b'M' | b'm' => (&["G0X1M2"], "ok\r\n"),
            b'?' | 0x80 => (&["G0X12"], "report"),
            0..=b' ' | b'/' | 0x7f.. | b'!' | b'~' => (&["G0X12"], "ok\r\n"),
            b'A'..=b'Z' | b'a'..=b'z' => (&[], "[MSG:not a word of the mock]\r\nerror:20\r\n"),
            b'+' | b'-' => (&[], "error:2\r\n"),
            _ => (&[], "error:1\r\n"),
        };
        match wanted {
            ["digit"] => assert_eq!(lines, [format!("G0X1{}2", char::from(byte))], "{byte:#x}"),
            ["word"] => {
                assert_eq!(lines, [format!("G0X1{}2", char::from(byte.to_ascii_uppercase()))], "{byte:#x}");
            }
            _ => assert_eq!(lines, wanted, "{byte:#x}"),
        }
        match answer {
            "report" => assert!(said.starts_with("<Idle|MPos:") && said.ends_with(">\r\nok\r\n"), "{said}"),
            _ => assert_eq!(said, answer, "{byte:#x}"),
        }
        let state = match byte {
            b'!' | 0x82 => "Hold:0",
            0x84 => "Door:0",
            _ => "Idle",
        };
        assert_eq!(talk.state(), state, "{byte:#x}");
    }
}

/// Which real-time byte acts in which state, and what state follows at once and at rest.
#[test]
fn real_time_bytes_in_all_states() {
    for name in STATES {
        for byte in [b'!', b'~', 0x18, 0x84, 0x85] {
            let mut talk = in_state(name);
            talk.send([byte]);
            talk.poll();
            let answer = talk.read();
            let at_once = talk.state();
            talk.mock.frozen = false;
            talk.settle();
            let later = talk.read();
            let at_rest = talk.state();
            let banner = "\r\nGrbl 1.1h ['$' for help]\r\n";
            let locked = "\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n";
            // At once, what is said at once, at rest.
            let home = [name, "", "Idle"];
            let wanted: [&str; 3] = match (byte, name) {
                (b'!', "Idle") => ["Hold:0", "", "Hold:0"],
                (b'!', "Run") => ["Hold:1", "", "Hold:0"],
                (b'!' | 0x85, "Jog") => ["Jog", "", "Idle"],
                (b'~', "Hold:0") => ["Idle", "", "Idle"],
                (b'~', "Door:0") => ["Idle", "", "Idle"],
                (0x18, "Alarm" | "Sleep") => ["Alarm", locked, "Alarm"],
                (0x18, "Home") => ["Alarm", "both", "Alarm"],
                (0x18, "Run" | "Hold:1" | "Door:2" | "Jog") => ["Hold:1", "", "Idle"],
                (0x18, "Door:1") => ["Door:1", banner, "Door:1"],
                (0x18, _) => ["Idle", banner, "Idle"],
                (0x84, "Idle" | "Hold:0") => ["Door:0", "", "Door:0"],
                (0x84, "Run" | "Hold:1" | "Jog") => ["Door:2", "", "Door:0"],
                (0x84, "Door:3") => ["Door:0", "", "Door:0"],
                (0x84, "Home") => ["Alarm", "ALARM:7\r\nerror:9\r\n", "Alarm"],
                (_, "Run" | "Jog") => [name, "", "Idle"],
                (_, "Hold:1") => ["Hold:1", "", "Hold:0"],
                (_, "Door:2") => ["Door:2", "", "Door:0"],
                (_, "Home") => home,
                _ => [name, "", name],
            };
            let context = format!("{byte:#x} in {name}");
            assert_eq!(at_once, wanted[0], "{context}: at once");
            assert_eq!(at_rest, wanted[2], "{context}: at rest");
            match wanted[1] {
                "both" => assert_eq!(answer, format!("ALARM:6\r\n{locked}"), "{context}"),
                text => assert_eq!(answer, text, "{context}"),
            }
            if byte == 0x18 && wanted[0] == "Hold:1" {
                assert_eq!(later, banner, "{context}");
            }
        }
    }
}

/// Where a line is permitted. Each row: the line, and its answer in every state where it is another one.
#[test]
fn lines_in_all_states() {
    let error = |code: u8| format!("error:{code}\r\n");
    let banner = "\r\nGrbl 1.1h ['$' for help]\r\n";
    for name in STATES {
        let is_idle = matches!(name, "Idle" | "Alarm");
        let blocked = matches!(name, "Home" | "Sleep");
        let not_idle = |text: &str| if is_idle { text.to_owned() } else { error(8) };
        let rows: Vec<(&str, String)> = vec![
            ("", "ok\r\n".into()),
            ("(comment)", "ok\r\n".into()),
            ("$", "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]\r\nok\r\n".into()),
            ("$$", if name == "Run" || name.starts_with("Hold") { error(8) } else { all_settings(1) }),
            ("$0=12", not_idle("ok\r\n")),
            ("$#", not_idle(OFFSETS)),
            ("$I", not_idle("[VER:1.1h.20190825:]\r\n[OPT:V,15,128]\r\nok\r\n")),
            ("$I=abc", not_idle("ok\r\n")),
            ("$N", not_idle("$N0=\r\n$N1=\r\nok\r\n")),
            ("$N0=G54", if name == "Idle" { "ok\r\n".into() } else { error(8) }),
            (
                "$C",
                match name {
                    "Idle" => "[MSG:Enabled]\r\nok\r\n".into(),
                    "Check" => format!("[MSG:Disabled]\r\nok\r\n{banner}"),
                    _ => error(8),
                },
            ),
            (
                "$X",
                if name == "Alarm" { "[MSG:Caution: Unlocked]\r\nok\r\n".into() } else { "ok\r\n".into() },
            ),
            ("$J=X1F100", if matches!(name, "Idle" | "Jog") { "ok\r\n".into() } else { error(8) }),
            ("$J", error(3)),
            ("$SLP", not_idle("ok\r\n[MSG:Sleeping]\r\n")),
            ("$RST=$", {
                let locked = "[MSG:'$H'|'$X' to unlock]\r\n";
                let locked = if name == "Alarm" { locked } else { "" };
                not_idle(&format!("[MSG:Restoring defaults]\r\nok\r\n{banner}{locked}"))
            }),
            ("$H", not_idle("")),
            ("$Q", error(3)),
            ("$$$", error(3)),
            ("$G0", error(3)),
            ("$RST", error(3)),
            ("$RST=x", if is_idle { error(3) } else { error(8) }),
            ("G21", if matches!(name, "Alarm" | "Jog") { error(9) } else { "ok\r\n".into() }),
        ];
        for (line, wanted) in rows {
            let mut talk = in_state(name);
            talk.send(line);
            talk.send("\n");
            talk.poll();
            let wanted = if blocked { String::new() } else { wanted };
            assert_eq!(talk.read(), wanted, "{line} in {name}");
        }
    }
}

const OFFSETS: &str = "[G54:0.000,0.000,0.000]\r\n[G55:0.000,0.000,0.000]\r\n[G56:0.000,0.000,0.000]\r\n\
    [G57:0.000,0.000,0.000]\r\n[G58:0.000,0.000,0.000]\r\n[G59:0.000,0.000,0.000]\r\n[G28:0.000,0.000,0.000]\r\n\
    [G30:0.000,0.000,0.000]\r\n[G92:0.000,0.000,0.000]\r\n[TLO:0.000]\r\n[PRB:0.000,0.000,0.000:0]\r\nok\r\n";

fn all_settings(homing: u8) -> String {
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

#[test]
fn laser_mode_needs_a_variable_speed() {
    let mut config = Config::new(names());
    config.has_pwm = false;
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.read();
    talk.ask("$32=1", "error:17\n");
}

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
fn status_reports() {
    let mut talk = Talk::new();
    talk.mock.status.position = [mm(1.0005), mm(-2.0), mm(0.0)];
    let report = |talk: &mut Talk<'_>, text: &str| {
        talk.send("???");
        talk.poll();
        talk.said(&format!("{text}\r\n"));
    };
    // Offsets first, overrides in the next one, then both every tenth at rest.
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|WCO:0.000,0.000,0.000>");
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|Ov:100,100,100>");
    for _ in 0..8 {
        report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0>");
    }
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|WCO:0.000,0.000,0.000>");
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|Ov:100,100,100>");
    // Changes are told at once.
    talk.send([0x91, 0x91, 0x94, 0x97, 0x9b]);
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|Ov:119,25,90>");
    talk.ask("G92X0", "ok\n");
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|WCO:1.001,0.000,0.000>");
    talk.ask("M3S500M8", "ok\n");
    talk.send([0xa1]);
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,450|Ov:119,25,90|A:SFM>");
    talk.ask("$10=0", "ok\n");
    report(&mut talk, "<Idle|WPos:0.000,-2.000,0.000|FS:0,450>");
    talk.signals = Signals::limit(0).and(Signals::limit(2)).and(Signals::PROBE);
    report(&mut talk, "<Idle|WPos:0.000,-2.000,0.000|FS:0,450|Pn:XZP>");
    talk.signals = Signals::default();
    // While it moves: every thirtieth and every twentieth.
    talk.ask("$10=3", "ok\n");
    talk.mock.frozen = true;
    talk.ask("G1F1200X5", "ok\n");
    let texts: Vec<String> = (0..61)
        .map(|_| {
            talk.send("?");
            talk.poll();
            talk.read()
        })
        .collect();
    let with = |word: &str| {
        texts.iter().enumerate().filter(|(_, text)| text.contains(word)).map(|(i, _)| i).collect::<Vec<_>>()
    };
    assert!(texts[0].starts_with("<Run|MPos:1.001,-2.000,0.000|Bf:14,128|FS:1200,450"), "{}", texts[0]);
    let (offsets, overrides) = (with("|WCO:"), with("|Ov:"));
    assert!(offsets.windows(2).all(|pair| pair[1] - pair[0] == 30), "{offsets:?}");
    assert!(overrides.windows(2).all(|pair| (20..=21).contains(&(pair[1] - pair[0]))), "{overrides:?}");
    assert!(offsets.len() >= 2 && overrides.len() >= 2 && !offsets.iter().any(|i| overrides.contains(i)));
}

#[test]
fn reports_in_inch_with_line_numbers() {
    let mut config = Config::new(names());
    (config.line_numbers, config.settings.inch) = (true, true);
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.read();
    talk.mock.frozen = true;
    talk.ask("N7G1X25.4F254", "ok\n");
    talk.send("?");
    talk.poll();
    talk.said("<Run|MPos:0.0000,0.0000,0.0000|Bf:14,128|Ln:7|FS:10.0,0|WCO:0.0000,0.0000,0.0000>\r\n");
}

#[test]
fn overrides_stay_in_their_range() {
    let mut talk = Talk::new();
    talk.send([0x91; 30]);
    talk.send([0x9b; 30]);
    talk.poll();
    assert_eq!(talk.mock.overrides, Some(Overrides { feed: 200, rapid: 100, spindle: 10 }));
    talk.send([0x92; 30]);
    talk.send([0x9a; 30]);
    talk.send([0x96, 0x93]);
    talk.poll();
    assert_eq!(talk.mock.overrides, Some(Overrides { feed: 11, rapid: 50, spindle: 200 }));
    talk.send([0x90, 0x94, 0x95, 0x99, 0x9d, 0x9c, 0x9c]);
    talk.poll();
    assert_eq!(talk.mock.overrides, Some(Overrides { feed: 99, rapid: 100, spindle: 101 }));
    // The end of a program resets them.
    talk.ask("M30", "ok\n");
    talk.poll();
    assert_eq!(talk.mock.overrides, Some(Overrides::FULL));
}

/// Each line is answered once, when its motion has room.
#[test]
fn answers_are_the_flow_control() {
    let mut talk = Talk::new();
    talk.mock.frozen = true;
    for i in 0..BLOCKS {
        talk.ask(format!("G1X{i}"), "ok\n");
    }
    talk.ask("G1X99", "");
    talk.send("G1X100\n$G\n");
    for _ in 0..20 {
        talk.poll();
    }
    talk.said("");
    talk.mock.frozen = false;
    talk.mock.step();
    talk.mock.frozen = true;
    talk.poll();
    talk.said("ok\r\n");
    talk.mock.frozen = false;
    talk.settle();
    talk.said("ok\r\n[GC:G1 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]\r\nok\r\n");
    assert_eq!(talk.mock.status.position[0], mm(100.0));
    // `G4` waits until everything is done.
    talk.ask("G1X1", "ok\n");
    talk.ask("G4P0.01", "");
    talk.settle();
    talk.said("ok\r\n");
}

#[test]
fn lines_end_with_cr_lf_or_both() {
    let mut talk = Talk::new();
    talk.send("G21\r\nG90\n\nG54\r\rG1\r\n");
    talk.settle();
    talk.said("ok\r\nok\r\nok\r\nok\r\nok\r\nok\r\n");
    assert_eq!(talk.mock.lines, ["G21", "G90", "G54", "G1"]);
    // 79 characters are taken, and one more is not; blanks do not count.
    let line = |length: usize| format!("g1 x1 (comment) {}", "0".repeat(length - 4));
    talk.ask(line(79), "ok\n");
    assert_eq!(talk.mock.lines.last().map(String::len), Some(79));
    talk.ask(line(80), "error:11\n");
    talk.ask("G21", "ok\n");
    talk.ask("/G1 X2 ; rest", "ok\n");
    assert_eq!(talk.mock.lines.last().map(String::as_str), Some("G1X2"));
}

/// Commands that restart the controller end with CR LF like all lines.
#[test]
fn a_restart_does_not_split_a_line_end() {
    let mut talk = Talk::new();
    talk.send("$C\r\n$C\r\n$RST=$\r\nG21\r\n");
    talk.settle();
    let banner = "\r\nGrbl 1.1h ['$' for help]\r\n";
    talk.said(&format!(
        "[MSG:Enabled]\r\nok\r\n[MSG:Disabled]\r\nok\r\n{banner}[MSG:Restoring defaults]\r\nok\r\n{banner}ok\r\n"
    ));
}

#[test]
fn text_as_received_keeps_its_blanks() {
    let mut config = Config::new(names());
    config.text = LineText::AsReceived;
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.read();
    talk.ask("g1 x1", "error:1\n");
    talk.ask("G1 X1", "error:1\n");
    talk.ask("G1X1", "ok\n");
    talk.ask("$ g", "[GC:G1 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]\nok\n");
    talk.send("X".repeat(256) + "\n");
    talk.settle();
    talk.said("error:11\r\n");
    talk.ask("(nothing)", "ok\n");
}

#[test]
fn bytes_without_room_are_lost_and_counted() {
    let mut talk = Talk::new();
    talk.send(vec![b'X'; BUFFER + 7]);
    assert_eq!((talk.receiver.room(), talk.controller.lost()), (0, 7));
    talk.send("?");
    talk.poll();
    assert!(talk.read().contains("|Bf:15,0|"));
    // Real-time bytes need no room.
    talk.send([0x18]);
    talk.settle();
    talk.said("\r\nGrbl 1.1h ['$' for help]\r\n");
    talk.ask("G21", "ok\n");
}

#[test]
fn a_reset_drops_what_stands_before_it_and_nothing_behind() {
    let mut talk = Talk::new();
    talk.mock.frozen = true;
    talk.send("G1X1\nG1X2\nG1X");
    talk.poll();
    talk.send([0x18]);
    talk.send("G21\n");
    talk.poll();
    talk.said("ok\r\n");
    assert_eq!(talk.state(), "Hold:1");
    talk.settle();
    talk.said("\r\nGrbl 1.1h ['$' for help]\r\nok\r\n");
    assert_eq!(talk.mock.lines, ["G1X1", "G21"]);
    assert!(talk.mock.queue.is_empty());
}

#[test]
fn startup_lines_run_behind_the_banner() {
    let mut talk = Talk::new();
    talk.ask("$N0=G55", "ok\n");
    talk.ask("$N1=Q", "error:2\n");
    talk.ask("$N1=G5", "error:20\n");
    talk.ask("$N2=G5", "error:3\n");
    talk.ask("$N1=M3S100", "ok\n");
    talk.ask("$N", "$N0=G55\n$N1=M3S100\nok\n");
    talk.send([0x18]);
    talk.settle();
    talk.said("\r\nGrbl 1.1h ['$' for help]\r\n>G55:ok\r\n>M3S100:ok\r\n");
    assert_eq!(talk.mock.modal.system, 55);
    assert_eq!(talk.memory.kept, ["N0=G55 N1= I=", "N0=G55 N1=M3S100 I="]);
    // Behind a restore they are gone.
    talk.ask("$RST=*", "[MSG:Restoring defaults]\nok\n\nGrbl 1.1h ['$' for help]\n");
    talk.ask("$N", "$N0=\n$N1=\nok\n");
    // A stored line that is refused is told.
    let mut config = Config::new(names());
    config.startup[0] = Stored::from_slice(b"G5").expect("short");
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.said("\r\nGrbl 1.1h ['$' for help]\r\n>G5:error:20\r\n");
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
