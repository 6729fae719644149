//! A connection of a browser: an HTTP request that gets the page, or becomes a websocket (RFC 6455).
use crate::report::base64;
use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};

/// Highest number of bytes of a request, and of waiting input from a browser.
const REQUEST_BYTES: usize = 8192;

/// Highest number of bytes that wait for a browser; a browser that does not read is disconnected.
const WAITING_BYTES: usize = 8 << 20;

/// Highest number of bytes in the text of a frame.
const FRAME_BYTES: usize = 125;

/// The constant that is appended to the key of a websocket.
const GUID: &[u8] = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11";

/// One connection.
pub struct Client {
    stream: TcpStream,
    input: Vec<u8>,
    output: Vec<u8>,
    /// Whether the connection is a websocket.
    pub is_live: bool,
    /// Whether the browser has all points of the path except the newest.
    pub knows_path: bool,
    /// Whether the connection closes after all output is written.
    is_done: bool,
    has_gone: bool,
}

impl Client {
    pub fn new(stream: TcpStream) -> Self {
        let (input, output) = (Vec::new(), Vec::new());
        Self { stream, input, output, is_live: false, knows_path: false, is_done: false, has_gone: false }
    }

    /// Returns the received texts, and answers a request.
    pub fn receive(&mut self, address: SocketAddr, page: &str) -> Vec<String> {
        let mut bytes = [0; 1024];
        match self.stream.read(&mut bytes) {
            Ok(0) => self.has_gone = true,
            Ok(count) => self.input.extend(bytes.iter().take(count)),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
            Err(_) => self.has_gone = true,
        }
        self.has_gone |= self.input.len() > REQUEST_BYTES;
        if !self.is_live && !self.is_done {
            self.request(address, page);
        }
        let mut texts = Vec::new();
        while self.is_live
            && let Some(frame) = self.frame()
        {
            texts.extend(frame);
        }
        texts
    }

    fn request(&mut self, address: SocketAddr, page: &str) {
        let Some(end) = self.input.windows(4).position(|four| four == b"\r\n\r\n") else { return };
        let request = String::from_utf8_lossy(self.input.get(..end).unwrap_or_default()).into_owned();
        self.input.drain(..end + 4);
        let head = |name: &str| {
            let lines = request.lines().skip(1).filter_map(|line| line.split_once(':'));
            let mut values =
                lines.filter(|(key, _)| key.eq_ignore_ascii_case(name)).map(|(_, value)| value.trim());
            values.next()
        };
        let hosts = [address.to_string(), format!("localhost:{}", address.port())];
        let is_ours = head("Host").is_some_and(|host| hosts.iter().any(|known| known == host));
        // A page of another site may open a websocket to this computer, so the origin is checked.
        let origin = head("Origin").and_then(|origin| origin.strip_prefix("http://"));
        let same_origin = head("Origin").is_none() || origin.is_some() && origin == head("Host");
        let path = request.split(' ').nth(1).unwrap_or_default();
        match (path, head("Sec-WebSocket-Key")) {
            _ if !is_ours || !same_origin || !request.starts_with("GET ") => self.close("403 Forbidden", ""),
            ("/live", Some(key)) => {
                let accept = base64(&sha1(&[key.as_bytes(), GUID].concat()));
                let head = "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade";
                self.output.extend(format!("{head}\r\nSec-WebSocket-Accept: {accept}\r\n\r\n").bytes());
                self.is_live = true;
            }
            ("/", _) => self.close("200 OK", page),
            _ => self.close("404 Not Found", ""),
        }
    }

    fn close(&mut self, status: &str, text: &str) {
        let length = text.len();
        let head = format!(
            "HTTP/1.1 {status}\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {length}\r\n\
             Cache-Control: no-store\r\nConnection: close\r\n\r\n"
        );
        self.output.extend(head.bytes().chain(text.bytes()));
        self.is_done = true;
    }

    /// Returns the next complete frame, with its text if the frame has a text.
    fn frame(&mut self) -> Option<Option<String>> {
        let [first, second, ..] = *self.input.as_slice() else { return None };
        let length = usize::from(second & 0x7f);
        // A browser masks its frames. Commands are short and come in one frame.
        if second & 0x80 == 0 || length > FRAME_BYTES || first & 0x80 == 0 {
            self.has_gone = true;
            return None;
        }
        let frame = self.input.get(2..6 + length)?;
        let (mask, data) = frame.split_at(4);
        let data: Vec<u8> = data.iter().zip(mask.iter().cycle()).map(|(byte, mask)| byte ^ mask).collect();
        self.input.drain(..6 + length);
        match first & 0x0f {
            1 => return Some(Some(String::from_utf8_lossy(&data).into_owned())),
            8 => {
                self.put(8, &data);
                self.is_done = true;
            }
            9 => self.put(10, &data),
            _ => {}
        }
        Some(None)
    }

    /// Sends a text to the page.
    pub fn send(&mut self, text: &str) {
        self.put(1, text.as_bytes());
    }

    fn put(&mut self, kind: u8, data: &[u8]) {
        self.output.push(0x80 | kind);
        match data.len() {
            length @ ..126 => self.output.push(length as u8),
            length @ ..65_536 => {
                self.output.push(126);
                self.output.extend((length as u16).to_be_bytes());
            }
            length => {
                self.output.push(127);
                self.output.extend((length as u64).to_be_bytes());
            }
        }
        self.output.extend(data);
    }

    /// Writes as much output as possible. Returns whether the connection stays open.
    pub fn flush(&mut self) -> bool {
        while !self.output.is_empty() && !self.has_gone {
            match self.stream.write(&self.output) {
                Ok(0) => self.has_gone = true,
                Ok(count) => _ = self.output.drain(..count),
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => break,
                Err(_) => self.has_gone = true,
            }
        }
        let is_over = self.is_done && self.output.is_empty();
        !self.has_gone && !is_over && self.output.len() <= WAITING_BYTES
    }
}

/// RFC 3174: the handshake of a websocket needs SHA-1; it has no security purpose here.
fn sha1(text: &[u8]) -> [u8; 20] {
    let mut message = text.to_vec();
    message.push(0x80);
    while message.len() % 64 != 56 {
        message.push(0);
    }
    message.extend((text.len() as u64 * 8).to_be_bytes());
    let mut hash = [0x6745_2301_u32, 0xefcd_ab89, 0x98ba_dcfe, 0x1032_5476, 0xc3d2_e1f0];
    for block in message.chunks_exact(64) {
        let mut words: Vec<u32> = block
            .chunks_exact(4)
            .map(|four| four.iter().fold(0, |word, byte| word << 8 | u32::from(*byte)))
            .collect();
        for at in 16..80 {
            let word = words[at - 3] ^ words[at - 8] ^ words[at - 14] ^ words[at - 16];
            words.push(word.rotate_left(1));
        }
        let [mut a, mut b, mut c, mut d, mut e] = hash;
        for (word, at) in words.iter().zip(0..) {
            let (mixed, constant) = match at {
                0..20 => (b & c | !b & d, 0x5a82_7999_u32),
                20..40 => (b ^ c ^ d, 0x6ed9_eba1),
                40..60 => (b & c | b & d | c & d, 0x8f1b_bcdc),
                _ => (b ^ c ^ d, 0xca62_c1d6),
            };
            let next = a
                .rotate_left(5)
                .wrapping_add(mixed)
                .wrapping_add(e)
                .wrapping_add(constant)
                .wrapping_add(*word);
            (a, b, c, d, e) = (next, a, b.rotate_left(30), c, d);
        }
        for (sum, part) in hash.iter_mut().zip([a, b, c, d, e]) {
            *sum = sum.wrapping_add(part);
        }
    }
    let mut bytes = [0; 20];
    for (to, from) in bytes.chunks_exact_mut(4).zip(hash) {
        to.copy_from_slice(&from.to_be_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_of_the_rfc_has_its_answer() {
        let key = [b"dGhlIHNhbXBsZSBub25jZQ==".as_slice(), GUID].concat();
        assert_eq!(base64(&sha1(&key)), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
    }
}
