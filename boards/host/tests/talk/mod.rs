//! `glidepath serve`, and a sender that is connected over TCP.
#![allow(dead_code)]
use std::io::{BufRead, BufReader, Write};
use std::net::{Shutdown, TcpStream};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;

/// The command and a sender; both end with the test.
pub struct Talk {
    child: Child,
    stream: TcpStream,
    lines: BufReader<TcpStream>,
    pub address: String,
    /// What the command printed behind the address: a line for each further port.
    pub ports: Vec<String>,
    out: BufReader<ChildStdout>,
}

impl Talk {
    pub fn new() -> Self {
        Self::with(&[], 0)
    }

    /// With more options, which open so many ports more.
    pub fn with(options: &[&str], ports: usize) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_glidepath"))
            .args(["serve", "--tcp", "0", "--once"])
            .args(if options.contains(&"--speed") { &[][..] } else { &["--speed", "20"] })
            .args(options)
            .stdout(Stdio::piped())
            .spawn()
            .expect("the command starts");
        let mut out = BufReader::new(child.stdout.take().expect("its output"));
        let mut names = Vec::new();
        for _ in 0..=ports {
            let mut name = String::new();
            out.read_line(&mut name).expect("a line");
            names.push(name.trim().to_owned());
        }
        let address = names.remove(0).strip_prefix("tcp ").expect("an address").to_owned();
        let stream = TcpStream::connect(&address).expect("it listens");
        // A controller that says nothing fails the test.
        stream.set_read_timeout(Some(Duration::from_secs(120))).expect("a time");
        let lines = BufReader::new(stream.try_clone().expect("a second handle"));
        let mut talk = Self { child, stream, lines, address, ports: names, out };
        // The first banner may have gone to nobody: a sender asks for another one.
        talk.send(b"\x18");
        let said = talk.ask("$X");
        // Startup lines of a store may stand between.
        let greeted = said.iter().any(|line| line == "Grbl 1.1h ['$' for help]");
        assert!(greeted && said.ends_with(&["ok".to_owned()]), "{said:?}");
        talk
    }

    pub fn send(&mut self, bytes: &[u8]) {
        self.stream.write_all(bytes).expect("it reads");
    }

    pub fn line(&mut self) -> String {
        self.try_line().expect("it answers")
    }

    /// The next line, or why there is none.
    pub fn try_line(&mut self) -> std::io::Result<String> {
        let mut line = String::new();
        if self.lines.read_line(&mut line)? == 0 {
            return Err(std::io::ErrorKind::UnexpectedEof.into());
        }
        Ok(line.trim_end().to_owned())
    }

    /// Lines up to the answer, and that.
    pub fn ask(&mut self, line: &str) -> Vec<String> {
        self.send(format!("{line}\n").as_bytes());
        let mut said = Vec::new();
        loop {
            let line = self.line();
            let is_answer = line == "ok" || line.starts_with("error:");
            said.push(line);
            if is_answer {
                return said;
            }
        }
    }

    pub fn report(&mut self) -> String {
        self.send(b"?");
        self.line()
    }

    /// Memory of the command, pages; 0 where the system does not tell.
    pub fn pages(&self) -> u64 {
        let text = std::fs::read_to_string(format!("/proc/{}/statm", self.child.id())).unwrap_or_default();
        text.split(' ').nth(1).and_then(|pages| pages.parse().ok()).unwrap_or(0)
    }

    /// The sender goes, and the command ends: its last line.
    pub fn end(mut self) -> String {
        let _ = self.stream.shutdown(Shutdown::Both);
        let mut line = String::new();
        self.out.read_line(&mut line).expect("a line");
        assert!(self.child.wait().expect("it ends").success());
        line.trim().to_owned()
    }

    /// Asks again until the report begins so.
    pub fn until(&mut self, begin: &str) -> String {
        loop {
            let report = self.report();
            if report.starts_with(begin) {
                return report;
            }
        }
    }
}

impl Drop for Talk {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
