//! Lines that press inputs, over TCP on this machine: `press door`, `release door`, `plate -12.5`.
use super::inputs::Inputs;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};

/// Bytes of the longest line.
const LINE_BYTES: usize = 200;

/// Highest number of connected clients.
const CLIENTS: usize = 8;

/// The port.
pub struct Control {
    listener: TcpListener,
    clients: Vec<(TcpStream, Vec<u8>)>,
}

impl Control {
    /// Listens on a port of this machine; 0: any free one.
    ///
    /// # Errors
    /// The port is taken.
    pub fn new(port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, clients: Vec::new() })
    }

    /// `control 127.0.0.1:PORT`.
    ///
    /// # Errors
    /// The system does not know it.
    pub fn name(&self) -> io::Result<String> {
        Ok(format!("control {}", self.listener.local_addr()?))
    }

    /// Carries out received lines; each line is answered with `ok` or `error: …`.
    pub fn serve(&mut self, inputs: &mut Inputs) {
        if let Ok((stream, _)) = self.listener.accept()
            && self.clients.len() < CLIENTS
            && stream.set_nonblocking(true).is_ok()
        {
            self.clients.push((stream, Vec::new()));
        }
        self.clients.retain_mut(|(stream, line)| Self::talk(stream, line, inputs));
    }

    /// Whether the client stays connected.
    fn talk(stream: &mut TcpStream, line: &mut Vec<u8>, inputs: &mut Inputs) -> bool {
        let mut bytes = [0; LINE_BYTES];
        let count = match stream.read(&mut bytes) {
            Ok(0) => return false,
            Ok(count) => count,
            Err(error) => return matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted),
        };
        for byte in bytes.iter().take(count) {
            if *byte != b'\n' {
                line.push(*byte);
                if line.len() > LINE_BYTES {
                    return false;
                }
                continue;
            }
            let text = String::from_utf8_lossy(line).trim().to_owned();
            line.clear();
            let answer = match inputs.command(&text) {
                Ok(()) => "ok\n".to_owned(),
                Err(message) => format!("error: {message}\n"),
            };
            if stream.write_all(answer.as_bytes()).is_err() {
                return false;
            }
        }
        true
    }
}
