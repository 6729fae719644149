//! Reads a line before the decoder reads it: finds what the controller has to know, for example whether the
//! line probes or has axis words.
use crate::number::decimal;
use glidepath::machine::AxisName;
use heapless::Vec;

/// Bytes of a line, including the number that the controller adds.
pub const TEXT_BYTES: usize = 280;

/// A line for the decoder.
pub type LineForDecoder = Vec<u8, TEXT_BYTES>;

/// Bytes of the added number.
pub const NUMBER_BYTES: u32 = 10;

/// Highest line number of a sender.
const LAST_LINE: i64 = 9_999_999;

/// A probing word.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Probing {
    /// G38.2 and G38.3: the motion ends at contact. Otherwise the motion ends at loss of contact.
    pub toward: bool,
    /// G38.2 and G38.4: if the probe does not change, an alarm follows.
    pub alarms: bool,
}

impl Probing {
    /// The word in tenths: 382…385.
    pub const fn tenths(self) -> u16 {
        match (self.toward, self.alarms) {
            (true, true) => 382,
            (true, false) => 383,
            (false, true) => 384,
            (false, false) => 385,
        }
    }
}

/// Facts of a line.
#[derive(Clone, Copy, Default, PartialEq, Eq, Debug)]
pub struct Scan {
    /// Line number of the sender; 0: none.
    pub line: u32,
    /// The line number is not between 0 and 9,999,999.
    pub bad_number: bool,
    /// G38.2…G38.5.
    pub probing: Option<Probing>,
    /// A motion word other than G38: whether this word is G0.
    pub motion: Option<bool>,
    /// G28 or G30.
    pub is_home: bool,
    /// A word that uses axis words for another purpose than motion: G10, G28, G30, G92, G43.1.
    pub stores: bool,
    /// Whether the line has axis words.
    pub has_axes: bool,
    /// G2 or G3.
    pub is_arc: bool,
    /// G17, G18, G19.
    pub plane: Option<u8>,
    /// G43.1.
    sets_tool_length: bool,
    /// The axis words, bit i for axis i.
    axes: u32,
    /// The line is answered at standstill: G4, M0, M1, M2, M6, M30, M60.
    pub synchronises: bool,
    /// M0, M1, M6, M60: the program waits for a cycle start.
    pub pauses: bool,
    /// An O word, M98 or M99: the text may go on elsewhere, and a stream cannot.
    pub goes_elsewhere: bool,
    /// M2, M30 or M0, M1, M60.
    pub program: Option<u8>,
    /// S, rpm.
    pub rpm: Option<u32>,
    /// M7, M8, M9: state of mist and flood after the line.
    pub coolant: Option<(bool, bool)>,
    /// Words that the decoder does not get: line number and probing word.
    number_at: Option<(usize, usize)>,
    probing_at: Option<(usize, usize)>,
}

impl Scan {
    /// Reads a line without blanks and comments, in upper case. Reading ends at text that is no word; the
    /// decoder refuses such text.
    pub fn of<const AXES: usize>(text: &[u8], names: &[AxisName; AXES], (mist, flood): (bool, bool)) -> Self {
        let mut scan = Self::default();
        let mut rest = text;
        while let [letter, tail @ ..] = rest {
            scan.goes_elsewhere |= *letter == b'O';
            let Some((milli, behind)) = decimal(tail, 3) else { break };
            let at = text.len().saturating_sub(rest.len());
            let span = (at, text.len().saturating_sub(behind.len()));
            rest = behind;
            match letter {
                b'G' => scan.take_g(milli, span),
                b'M' => scan.take_m(milli, (mist, flood)),
                b'S' => scan.rpm = u32::try_from(milli / 1000).ok(),
                b'N' if scan.number_at.is_none() => {
                    let line = milli / 1000;
                    scan.bad_number |= milli < 0 || line > LAST_LINE;
                    scan.line = u32::try_from(line).unwrap_or(0);
                    scan.number_at = Some(span);
                }
                _ => {
                    let axis = names.iter().position(|name| name.0 == [*letter, 0, 0, 0]);
                    scan.axes |= axis.map_or(0, |axis| 1_u32.checked_shl(axis as u32).unwrap_or(0));
                    scan.has_axes = scan.axes != 0;
                }
            }
        }
        scan.goes_elsewhere |= calls(rest);
        scan
    }

    /// Whether an arc has no end point in its plane. The arguments are the active motion word and plane. Grbl
    /// accepts no full circle without an end point.
    pub fn lacks_end(&self, (is_arc, plane): (bool, u8)) -> bool {
        let in_plane = match self.plane.unwrap_or(plane) {
            18 => 0b101,
            19 => 0b110,
            _ => 0b011,
        };
        let is_arc = self.is_arc || is_arc && self.moves_by_modal_word() && self.probing.is_none();
        is_arc && self.axes & in_plane == 0
    }

    /// Whether the active motion word uses the axis words of the line.
    pub const fn moves_by_modal_word(&self) -> bool {
        self.has_axes && self.motion.is_none() && !self.stores
    }

    /// Whether the line has G43.1 with other axis words than that of the third axis. Grbl has only one tool
    /// length.
    pub const fn has_foreign_tool_length(&self) -> bool {
        self.sets_tool_length && self.axes != 0b100
    }

    fn take_g(&mut self, milli: i64, span: (usize, usize)) {
        match milli {
            0 => self.motion = Some(true),
            2000 | 3000 => (self.motion, self.is_arc) = (Some(false), true),
            17_000..=19_000 if milli % 1000 == 0 => self.plane = Some((milli / 1000) as u8),
            1000 | 73_000 | 80_000..=89_000 => self.motion = Some(false),
            4000 => self.synchronises = true,
            28_000 | 30_000 => (self.is_home, self.stores) = (true, true),
            43_100 => (self.sets_tool_length, self.stores) = (true, true),
            10_000 | 28_100 | 30_100 | 92_000 => self.stores = true,
            38_200 | 38_300 | 38_400 | 38_500 if self.probing.is_none() => {
                let toward = milli <= 38_300;
                self.probing = Some(Probing { toward, alarms: milli == 38_200 || milli == 38_400 });
                self.probing_at = Some(span);
            }
            _ => {}
        }
    }

    fn take_m(&mut self, milli: i64, before: (bool, bool)) {
        let (mist, flood) = self.coolant.unwrap_or(before);
        self.pauses |= matches!(milli, 0 | 1000 | 6000 | 60_000);
        self.goes_elsewhere |= matches!(milli, 98_000 | 99_000);
        match milli {
            0 | 1000 | 2000 | 30_000 | 60_000 => {
                (self.synchronises, self.program) = (true, Some((milli / 1000) as u8));
            }
            6000 => self.synchronises = true,
            7000 => self.coolant = Some((true, flood)),
            8000 => self.coolant = Some((mist, true)),
            9000 => self.coolant = Some((false, false)),
            _ => {}
        }
    }

    /// Writes the line for the decoder. The line begins with a number, which identifies the sender's line and
    /// says whether it is a rapid motion. The status of each tick contains this number. `NUMBER_BYTES`
    /// precede the line if it begins with a word.
    pub fn numbered(&self, text: &[u8], is_rapid: bool) -> Option<LineForDecoder> {
        let mut line = LineForDecoder::new();
        if !text.first().is_some_and(u8::is_ascii_uppercase) {
            // Text that is no word stays without a number, because its digits would extend the number.
            line.extend_from_slice(text).ok()?;
            return Some(line);
        }
        line.push(b'N').ok()?;
        let number = self.line * 2 + u32::from(is_rapid);
        let mut unit = 100_000_000;
        while unit > 0 {
            let digit = number.checked_div(unit).unwrap_or(0) % 10;
            line.push(b'0' + digit as u8).ok()?;
            unit /= 10;
        }
        // Blanks replace words that are left out, so columns of the other words stay the same.
        let is_in = |span: Option<(usize, usize)>, at| span.is_some_and(|(from, to)| from <= at && at < to);
        for (byte, at) in text.iter().zip(0..) {
            let place = self.probing_at.and_then(|(from, _)| usize::checked_sub(at, from));
            let byte = match (place, is_in(self.probing_at, at), is_in(self.number_at, at)) {
                (Some(0), true, _) => b'G',
                (Some(1), true, _) => b'1',
                (_, false, false) => *byte,
                _ => b' ',
            };
            line.push(byte).ok()?;
        }
        Some(line)
    }
}

/// Whether M98, M99, or M with a computed number stands in the rest of a line, behind a value that is no number.
fn calls(rest: &[u8]) -> bool {
    let mut rest = rest;
    while let [letter, tail @ ..] = rest {
        let is_call = match (tail, decimal(tail, 3)) {
            ([b'[' | b'#', ..], _) => true,
            (_, number) => matches!(number, Some((98_000 | 99_000, _))),
        };
        if *letter == b'M' && is_call {
            return true;
        }
        rest = tail;
    }
    false
}
