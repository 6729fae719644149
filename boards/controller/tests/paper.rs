//! Checks `docs/protocol.md`: every table row and every conversation of the page, with answers compared
//! character for character.
mod bench;

use bench::world::{Rig, World, settings, with_rig};
use bench::{Talk, names, serial};
use glidepath_controller::{Config, LineText, Settings, Signals, Spindle};

const PAGE: &str = include_str!("../../../docs/protocol.md");

const BANNER: &str = "\r\nGrbl 1.1h ['$' for help]\r\n";
const LOCKED: &str = "[MSG:'$H'|'$X' to unlock]\r\n";

const STATES: [&str; 13] = [
    "Idle", "Run", "Hold:0", "Hold:1", "Jog", "Alarm", "Door:0", "Door:1", "Door:2", "Door:3", "Check",
    "Home", "Sleep",
];

/// Cells of the rows of a table between its marks, without its head.
fn table(name: &str) -> Vec<Vec<String>> {
    let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
    let (_, rest) = PAGE.split_once(&begin).expect("a table");
    let (rows, _) = rest.split_once(&end).expect("its end");
    let cells = |row: &str| -> Vec<String> {
        let row = row.trim_matches('|').replace("\\|", "\u{1}");
        row.split('|').map(|cell| cell.trim().replace('\u{1}', "|")).collect()
    };
    let rows: Vec<_> = rows.lines().skip(2).map(cells).collect();
    assert!(rows.len() > 5, "{name}");
    rows
}

/// What stands in backticks.
fn quoted(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

/// The byte of `0x18`, or of a character.
fn byte(text: &str) -> u8 {
    match text.strip_prefix("0x") {
        Some(digits) => u8::from_str_radix(digits, 16).expect("a byte"),
        None => text.as_bytes()[0],
    }
}

/// A controller in a state of that name, with a motion side that stands still in the middle of motion.
fn in_state(name: &str) -> Talk<'static> {
    let mut config = Config::new(names());
    config.settings.homing = true;
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.said(&format!("{BANNER}{LOCKED}"));
    if name != "Alarm" {
        talk.ask("$X", "[MSG:Caution: Unlocked]\nok\n");
    }
    if matches!(name, "Run" | "Hold:1" | "Jog" | "Door:2") {
        talk.mock.frozen = true;
        talk.ask(if name == "Jog" { "$J=X1F100" } else { "G0X1" }, "ok\n");
    }
    if name == "Door:3" {
        talk.mock.modal.spindle = Spindle::Clockwise;
        talk.mock.step();
    }
    match name {
        "Hold:0" | "Hold:1" => talk.send("!"),
        "Door:0" | "Door:2" | "Door:3" => talk.send([0x84]),
        "Door:1" => talk.signals = Signals::DOOR,
        "Check" => talk.ask("$C", "[MSG:Enabled]\nok\n"),
        "Home" => talk.send("$H\n"),
        "Sleep" => talk.ask("$SLP", "ok\n[MSG:Sleeping]\n"),
        _ => {}
    }
    talk.poll();
    if name == "Door:3" {
        talk.send("~");
        talk.poll();
    }
    talk.said("");
    assert_eq!(talk.state(), name);
    talk
}

#[test]
fn every_byte_of_the_page() {
    for row in table("bytes") {
        let bytes = quoted(&row[0]);
        for state in STATES {
            for byte in bytes.iter().map(|text| byte(text)) {
                let mut talk = in_state(state);
                talk.send([byte]);
                talk.poll();
                let said = talk.read();
                let context = format!("{byte:#x} in {state}: {said}");
                if row[2] == "a report in every state" {
                    assert!(
                        said.starts_with(&format!("<{state}|MPos:")) && said.ends_with(">\r\n"),
                        "{context}"
                    );
                    assert_eq!(said.lines().count(), 1, "{context}");
                    continue;
                }
                let mut wanted = state;
                for change in row[2].split("; ") {
                    let (from, to) = change.split_once(" → ").expect("a change");
                    assert!(STATES.contains(&from) && STATES.contains(&to), "{change}");
                    wanted = if from == state { to } else { wanted };
                }
                assert_eq!(talk.state(), wanted, "{context}");
                let is_alarm = state == "Alarm" || state == "Home" || state == "Sleep";
                let hello = format!("{BANNER}{}", if is_alarm { LOCKED } else { "" });
                let wanted = match (byte, state) {
                    (0x18, "Run" | "Hold:1" | "Jog" | "Door:2") => String::new(),
                    (0x18, "Home") => format!("ALARM:6\r\n{hello}"),
                    (0x18, _) => hello,
                    (0x84, "Home") => "ALARM:7\r\nerror:9\r\n".to_owned(),
                    _ => String::new(),
                };
                assert_eq!(said, wanted, "{context}");
            }
        }
    }
}

#[test]
fn every_override_of_the_page() {
    for row in table("overrides") {
        for state in STATES {
            let mut talk = in_state(state);
            talk.send("?");
            talk.poll();
            talk.read();
            let bytes: Vec<u8> = quoted(&row[0]).iter().map(|text| byte(text)).collect();
            talk.send(bytes);
            talk.send("?");
            talk.poll();
            let report = talk.read();
            let shown = report.split_once("|Ov:").map(|(_, rest)| rest.trim_end_matches(">\r\n"));
            let shown = shown.and_then(|rest| rest.split('|').next()).unwrap_or("100,100,100");
            assert_eq!(shown, row[1], "{row:?} in {state}: {report}");
        }
    }
}

/// Coolant is switched by hand in Idle, Run, Hold and Jog alone.
#[test]
fn coolant_by_hand() {
    for state in STATES {
        for (byte, letter) in [(0xa0, "F"), (0xa1, "M")] {
            let mut talk = in_state(state);
            talk.send([byte]);
            talk.poll();
            let outputs = talk.controller.outputs();
            let is_on = if letter == "F" { outputs.flood } else { outputs.mist };
            let acts = matches!(state, "Idle" | "Run" | "Hold:0" | "Hold:1" | "Jog");
            assert_eq!(is_on, acts, "{byte:#x} in {state}");
            talk.send([byte]);
            talk.poll();
            let outputs = talk.controller.outputs();
            assert!(!outputs.flood && !outputs.mist, "{byte:#x} twice in {state}");
        }
    }
}

/// All settings of the page, in its order, as `$$` tells them.
fn all_settings(homing: bool) -> String {
    let mut of_axes = [const { String::new() }; 4];
    let mut text = String::new();
    for row in table("settings") {
        for number in quoted(&row[0]) {
            let value = if number == "$22" && homing { "1" } else { &row[1] };
            let line = format!("{number}={value}\r\n");
            match number.len() {
                4 if number.starts_with("$1") => {
                    of_axes[usize::from(number.as_bytes()[2] - b'0')] += &line;
                }
                _ => text += &line,
            }
        }
    }
    text + &of_axes.concat()
}

/// A cell of answers: its lines with CR LF.
fn answer(cell: &str, state: &str) -> String {
    let mut text = String::new();
    for part in cell.split("<br>").filter(|part| !part.is_empty()) {
        match part {
            "*settings*" => text += &all_settings(true),
            "*banner*" => {
                text += BANNER;
                text += if state == "Alarm" { LOCKED } else { "" };
            }
            _ => {
                let spindle = if state == "Door:3" { "M3" } else { "M5" };
                let line = part.strip_prefix('`').and_then(|part| part.strip_suffix('`')).expect("a line");
                text += &line.replace("*spindle*", spindle);
                text += "\r\n";
            }
        }
    }
    text
}

#[test]
fn every_line_of_the_page() {
    let rows = table("lines");
    for row in &rows {
        let line = row[0].trim_matches('`');
        for state in STATES {
            let group = state.split(':').next().unwrap_or(state);
            let permits = |row: &[String]| row[1] == "all" || row[1].split(", ").any(|name| name == group);
            // A line with two rows: elsewhere is where neither has an answer.
            if !permits(row) && rows.iter().any(|other| other[0] == row[0] && permits(other)) {
                continue;
            }
            let wanted = match state {
                "Home" | "Sleep" => String::new(),
                _ if permits(row) => answer(&row[2], state),
                _ => answer(&row[3], state),
            };
            let mut talk = in_state(state);
            talk.send(line);
            talk.send("\n");
            talk.poll();
            assert_eq!(talk.read(), wanted, "{line} in {state}");
        }
    }
}

#[test]
fn every_error_of_the_page() {
    let mut settings = settings();
    (settings.homing, settings.soft_limits) = (true, true);
    for axis in &mut settings.axes {
        axis.travel_milli = 200_000;
    }
    let (mut shown, mut faults) = (0, Vec::new());
    for row in table("errors") {
        let wanted = format!("error:{}", row[0]);
        if let Some(test) = row[2].strip_prefix("test ") {
            assert!(is_test(test.trim_matches('`')), "{test}");
            continue;
        }
        for lines in row[2].split("; ") {
            with_rig(&settings, World::new(1), |rig| {
                assert_eq!(rig.ask("$X"), "[MSG:Caution: Unlocked]\nok\n");
                let lines = quoted(lines);
                let (last, before) = lines.split_last().expect("a line");
                for line in before {
                    assert!(rig.ask(line).ends_with("ok\n"), "{line}");
                }
                let said = rig.ask(last);
                if said.lines().last() != Some(wanted.as_str()) {
                    faults.push(format!("{last}: {wanted}, {said}"));
                }
                shown += 1;
            });
        }
    }
    assert!(shown > 50 && faults.is_empty(), "{shown} lines: {faults:#?}");
}

/// Only a language in which blanks count has lines of that length.
#[test]
fn a_stored_line_that_is_too_long() {
    let mut config = Config::new(names());
    config.text = LineText::AsReceived;
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.read();
    talk.ask(format!("$N0=G1X{}", "0".repeat(80)), "error:14\n");
    talk.ask(format!("$I={}", "A".repeat(81)), "error:14\n");
    talk.ask(format!("$I={}", "A".repeat(80)), "ok\n");
}

/// Whether a test of this crate has that name.
fn is_test(name: &str) -> bool {
    let folder = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests"));
    let files = [folder.to_path_buf(), folder.join("protocol")]
        .map(|folder| std::fs::read_dir(folder).expect("a folder"));
    let mut texts =
        files.into_iter().flatten().flatten().filter_map(|file| std::fs::read_to_string(file.path()).ok());
    texts.any(|text| text.contains(&format!("#[test]\nfn {name}(")))
}

#[test]
fn tests_that_the_page_names_exist() {
    let words = PAGE.split('`').skip(1).step_by(2);
    let names: Vec<&str> = words
        .filter(|word| {
            word.contains('_') && word.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'_')
        })
        .collect();
    assert!(names.len() > 20);
    for name in names {
        assert!(is_test(name), "{name}");
    }
}

/// Bytes of a conversation, with `\n` and `\x18`.
fn bytes(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut rest = text;
    while let Some(letter) = rest.chars().next() {
        if let Some(hex) = rest.strip_prefix("\\x") {
            bytes.push(u8::from_str_radix(&hex[..2], 16).expect("a byte"));
            rest = &hex[2..];
        } else if let Some(tail) = rest.strip_prefix("\\n") {
            bytes.push(b'\n');
            rest = tail;
        } else {
            bytes.push(letter as u8);
            rest = &rest[1..];
        }
    }
    bytes
}

/// What the machine says until it is as much as `wanted`, and for a few ticks behind it.
fn hear(rig: &mut Rig<'_>, wanted: &[&str]) -> String {
    let mut said = String::new();
    for _ in 0..60_000 {
        said += &rig.read();
        if said.matches("\r\n").count() >= wanted.len() {
            break;
        }
        rig.tick();
    }
    rig.ticks(3);
    said + &rig.read()
}

fn converse(rig: &mut Rig<'_>, text: &str) {
    let settings = all_settings(false);
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        if let Some(state) = line.strip_prefix("= ") {
            rig.until(state);
            continue;
        }
        match line.strip_prefix(">> ") {
            Some(text) => rig.send(bytes(text)),
            None => rig.send(format!("{}\n", line.strip_prefix('>').expect("a line").trim())),
        }
        let mut wanted: Vec<&str> = Vec::new();
        while let Some(line) = lines.next_if(|line| line.starts_with('<')) {
            match line.strip_prefix('<').map(str::trim) {
                Some("*settings*") => wanted.extend(settings.lines()),
                line => wanted.extend(line),
            }
        }
        let said = hear(rig, &wanted);
        let said: Vec<&str> = said.split_terminator("\r\n").collect();
        assert_eq!(said.len(), wanted.len(), "{line}: {said:?}, {wanted:?}");
        for (said, wanted) in said.iter().zip(&wanted) {
            let parts: Vec<&str> = wanted.split('*').collect();
            let fits = said.starts_with(parts[0]) && said.ends_with(parts[parts.len() - 1]);
            assert!(if parts.len() == 1 { said == wanted } else { fits }, "{line}: {said} for {wanted}");
        }
    }
}

#[test]
fn every_conversation_of_the_page() {
    let conversations: Vec<&str> =
        PAGE.split("```sender\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(conversations.len() >= 8);
    for text in conversations {
        let settings = Settings::new();
        with_rig(&settings, World::new(1), |rig| converse(rig, text));
    }
}
