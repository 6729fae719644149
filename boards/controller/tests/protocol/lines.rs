//! Lines in every state, their ends, and when they are answered.
use crate::bench::{BLOCKS, Talk, names, serial};
use crate::settings::{OFFSETS, all_settings};
use crate::{STATES, in_state, mm};
use glidepath_controller::{Config, LineText, Stored};

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
