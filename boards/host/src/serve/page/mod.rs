//! `--page`: a page that shows state, position and path during the motion, and switches inputs. The page uses
//! HTTP and a websocket, only on this computer; requests of other sites are refused.
mod socket;

use super::AXES;
use super::inputs::Inputs;
use glidepath::quantity::Position;
use serde_json::{Value, json};
use socket::Client;
use std::collections::VecDeque;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::time::{Duration, Instant};

/// The complete page.
const PAGE: &str = include_str!("page.html");

/// Time between two messages.
const PERIOD: Duration = Duration::from_millis(50);

/// Highest number of path points that a page gets at its start.
const POINTS: usize = 20_000;

/// Highest number of connected browsers.
const CLIENTS: usize = 8;

/// Distance of an axis after which a point of the path is stored, 2^-32 mm: 0.05 mm.
const STEP: i64 = (1 << 32) / 20;

/// Content of a message.
pub struct Shown {
    /// Name of the state, as in reports.
    pub state: String,
    pub position: [Position; AXES],
    /// Work offset.
    pub offset: [Position; AXES],
    pub feed: f64,
    /// Inputs that are on.
    pub inputs: Vec<String>,
    /// Height of the probe's plate.
    pub plate: Option<f64>,
}

/// The port and the connected browsers.
pub struct Page {
    listener: TcpListener,
    address: SocketAddr,
    clients: Vec<Client>,
    /// Points of the path; the newest point is the last one.
    path: VecDeque<[f64; AXES]>,
    /// Points since the last message.
    new: usize,
    last: [Position; AXES],
    sent: Instant,
}

impl Page {
    /// Listens on a port of this machine; 0: any free one.
    ///
    /// # Errors
    /// The port is taken.
    pub fn new(port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let (path, last) = (VecDeque::from([[0.0; AXES]]), [Position::ZERO; AXES]);
        Ok(Self { listener, address, clients: Vec::new(), path, new: 0, last, sent: Instant::now() })
    }

    /// `page http://127.0.0.1:PORT/`.
    pub fn name(&self) -> String {
        format!("page http://{}/", self.address)
    }

    /// Stores a point of the path.
    pub fn mark(&mut self, position: &[Position; AXES]) {
        let ways = position.iter().zip(&self.last).map(|(at, last)| at.to_bits().abs_diff(last.to_bits()));
        if ways.max().unwrap_or(0) >= STEP as u64 {
            self.add(position);
        }
    }

    fn add(&mut self, position: &[Position; AXES]) {
        self.last = *position;
        if self.path.len() >= POINTS {
            self.path.pop_front();
        }
        self.path.push_back(rounded(position));
        self.new = (self.new + 1).min(self.path.len());
    }

    /// Homing has changed the coordinates, so the old path is dropped.
    pub fn restart(&mut self, position: &[Position; AXES]) {
        self.path.clear();
        self.new = 0;
        self.add(position);
        // An open page draws the path again.
        for client in self.clients.iter_mut().filter(|client| client.is_live) {
            client.knows_path = false;
        }
    }

    /// Accepts browsers, carries out their commands, and sends new data if due.
    pub fn serve(&mut self, inputs: &mut Inputs, shown: impl FnOnce(&Inputs) -> Shown) {
        if let Ok((stream, _)) = self.listener.accept()
            && self.clients.len() < CLIENTS
            && stream.set_nonblocking(true).is_ok()
        {
            self.clients.push(Client::new(stream));
        }
        for client in &mut self.clients {
            for text in client.receive(self.address, PAGE) {
                if let Err(message) = inputs.command(&text) {
                    client.send(&json!({ "error": message }).to_string());
                }
            }
        }
        if self.sent.elapsed() >= PERIOD && !self.clients.is_empty() {
            self.sent = Instant::now();
            let shown = shown(inputs);
            if shown.position != self.last {
                self.add(&shown.position);
            }
            self.show(&shown);
        }
        self.clients.retain_mut(Client::flush);
    }

    fn show(&mut self, shown: &Shown) {
        let message = |path: Value, is_all: bool| {
            let Shown { state, position, offset, feed, inputs, plate } = shown;
            json!({
                "state": state, "position": rounded(position), "offset": rounded(offset),
                "feed": feed.round(), "inputs": inputs, "plate": plate, "path": path, "all": is_all,
            })
            .to_string()
        };
        let news =
            message(json!(self.path.iter().skip(self.path.len() - self.new).collect::<Vec<_>>()), false);
        for client in self.clients.iter_mut().filter(|client| client.is_live) {
            if client.knows_path {
                client.send(&news);
            } else {
                client.send(&message(json!(self.path), true));
                client.knows_path = true;
            }
        }
        self.new = 0;
    }
}

/// Converts to micrometres.
fn rounded(position: &[Position; AXES]) -> [f64; AXES] {
    position.map(|at| (at.to_num::<f64>() * 1000.0).round() / 1000.0)
}

#[cfg(test)]
mod tests {
    use super::PAGE;

    #[test]
    fn the_page_asks_no_network() {
        assert!(!PAGE.contains("http") && !PAGE.contains("src="), "{PAGE}");
    }
}
