//! The page and the log of `glidepath serve`. `tests/browser/live.mjs` opens the page in Chromium.
mod talk;

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;
use talk::Talk;

fn talk(options: &[&str]) -> (Talk, String) {
    let talk = Talk::with(&[&["--page", "0"], options].concat(), 1);
    let address = talk.ports[0].strip_prefix("page http://").and_then(|rest| rest.strip_suffix('/'));
    let address = address.expect("an address").to_owned();
    (talk, address)
}

/// A request, and the first bytes of its answer.
fn ask(address: &str, path: &str, heads: &str) -> (TcpStream, String) {
    let mut stream = TcpStream::connect(address).expect("it listens");
    stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a time limit");
    write!(stream, "GET {path} HTTP/1.1\r\n{heads}\r\n\r\n").expect("it reads");
    let mut answer = Vec::new();
    while !answer.windows(4).any(|four| four == b"\r\n\r\n") {
        let mut byte = [0];
        stream.read_exact(&mut byte).expect("it answers");
        answer.push(byte[0]);
    }
    (stream, String::from_utf8(answer).expect("text"))
}

const KEY: &str = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==";

/// The text of the next frame.
fn frame(stream: &mut TcpStream) -> String {
    let mut head = [0; 2];
    stream.read_exact(&mut head).expect("a frame");
    let length = match head[1] {
        127 => {
            let mut bytes = [0; 8];
            stream.read_exact(&mut bytes).expect("a length");
            u64::from_be_bytes(bytes)
        }
        126 => {
            let mut bytes = [0; 2];
            stream.read_exact(&mut bytes).expect("a length");
            u64::from(u16::from_be_bytes(bytes))
        }
        length => u64::from(length),
    };
    let mut text = vec![0; length as usize];
    stream.read_exact(&mut text).expect("its text");
    String::from_utf8(text).expect("text")
}

/// A text from the page, masked as a browser does it.
fn say(stream: &mut TcpStream, text: &str) {
    let mask = [1, 2, 3, 4];
    let masked = text.bytes().zip(mask.iter().cycle()).map(|(byte, mask)| byte ^ mask);
    let frame: Vec<u8> = [0x81, 0x80 | text.len() as u8].into_iter().chain(mask).chain(masked).collect();
    stream.write_all(&frame).expect("it reads");
}

fn until(stream: &mut TcpStream, holds: impl Fn(&serde_json::Value) -> bool) -> serde_json::Value {
    for _ in 0..2000 {
        let value = serde_json::from_str(&frame(stream)).expect("JSON");
        if holds(&value) {
            return value;
        }
    }
    panic!("never");
}

#[test]
fn the_page_is_live_and_presses_inputs() {
    let (mut talk, address) = talk(&[]);
    let (mut stream, answer) =
        ask(&address, "/live", &format!("Host: {address}\r\nOrigin: http://{address}\r\n{KEY}"));
    assert!(
        answer.starts_with("HTTP/1.1 101 ") && answer.contains("s3pPLMBiTxaQ9kYGzzhZRbK+xOo="),
        "{answer}"
    );
    let first = until(&mut stream, |value| value["state"] == "Idle");
    assert_eq!((&first["all"], &first["plate"]), (&true.into(), &(-20.0).into()));
    assert_eq!(talk.ask("G92 X5"), ["ok"]);
    assert_eq!(talk.ask("G1 X20 F600"), ["ok"]);
    until(&mut stream, |value| {
        value["state"] == "Run" && value["path"].as_array().is_some_and(|path| !path.is_empty())
    });
    say(&mut stream, "press door");
    until(&mut stream, |value| value["state"] == "Door:1" && value["inputs"] == serde_json::json!(["door"]));
    say(&mut stream, "release door");
    until(&mut stream, |value| value["state"] == "Door:0");
    talk.send(b"~");
    let end = until(&mut stream, |value| value["state"] == "Idle");
    assert_eq!(end["position"], serde_json::json!([15.0, 0.0, 0.0]));
    assert_eq!(end["offset"], serde_json::json!([-5.0, 0.0, 0.0]));
    say(&mut stream, "press nothing");
    let said = until(&mut stream, |value| value["error"].is_string());
    assert_eq!(said["error"], "`nothing`: expected x, y, z, probe, door, hold, reset or start");
    // A page that comes later has the whole path.
    let (mut second, _) = ask(&address, "/live", &format!("Host: {address}\r\n{KEY}"));
    let all = until(&mut second, |value| value["all"] == true);
    assert!(all["path"].as_array().is_some_and(|path| path.len() > 100));
    assert_eq!(
        all["path"].as_array().and_then(|path| path.last()),
        Some(&serde_json::json!([15.0, 0.0, 0.0]))
    );
}

#[test]
fn requests_of_another_site_are_refused() {
    let (_talk, address) = talk(&[]);
    let (mut stream, answer) = ask(&address, "/", &format!("Host: {address}"));
    assert!(answer.starts_with("HTTP/1.1 200 OK"), "{answer}");
    let mut page = String::new();
    stream.read_to_string(&mut page).expect("text");
    assert!(page.starts_with("<!doctype html>") && page.ends_with("</html>\n"));
    for (path, heads, status) in [
        ("/live", format!("Host: {address}\r\nOrigin: http://elsewhere.example\r\n{KEY}"), "403"),
        ("/live", format!("Host: {address}\r\nOrigin: null\r\n{KEY}"), "403"),
        ("/", "Host: elsewhere.example".to_owned(), "403"),
        ("/", "Accept: */*".to_owned(), "403"),
        ("/other", format!("Host: {address}"), "404"),
        ("/live", format!("Host: {address}"), "404"),
    ] {
        let (_, answer) = ask(&address, path, &heads);
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{path} {heads}: {answer}");
    }
}

#[test]
fn every_byte_is_logged() {
    let folder = std::env::temp_dir().join(format!("glidepath-log-{}", std::process::id()));
    let file = folder.to_str().expect("a name");
    let (mut talk, _) = talk(&["--log", file]);
    talk.send(b"\xc2\x91");
    assert_eq!(talk.ask("G4 P0 \\").last().map(String::as_str), Some("error:1"));
    // A row is written behind its bytes.
    let told = || std::fs::read_to_string(file).expect("a log");
    let until = std::time::Instant::now() + Duration::from_secs(20);
    while !told().contains("error:1") && std::time::Instant::now() < until {
        std::thread::sleep(Duration::from_millis(5));
    }
    drop(talk);
    let text = told();
    std::fs::remove_file(file).expect("it is there");
    let side = |direction: &str| -> String {
        let rows = text.lines().filter_map(|row| row.split_once(direction));
        rows.map(|(time, bytes)| (time.parse::<f64>().expect("seconds"), bytes).1).collect()
    };
    assert_eq!(side(" > "), "\\x18$X\\n\\xc2\\x91G4 P0 \\\\\\n");
    let said = side(" < ");
    assert!(
        said.contains("\\r\\nGrbl 1.1h ['$' for help]\\r\\n") && said.ends_with("error:1\\r\\n"),
        "{said}"
    );
}
