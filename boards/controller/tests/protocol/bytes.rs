//! Bytes in a line, and real-time bytes in every state.
use crate::bench::{BUFFER, Talk};
use crate::{STATES, in_state};

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
