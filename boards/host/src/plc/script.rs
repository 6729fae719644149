//! The file of `--plc`: one request per line, seconds since the first set point, a word, its values.
//!
//! ```text
//! 0     laser 2 30 5 40      ; less power, 40 %, within 2 mm of a knee of 30 degrees or more, and on radii below 5 mm
//! 0.1   reach                # how far the path is known, and the distance driven
//! 0.2   elements 0 100       ; mode 2: elements from 0 to 100 mm
//! 0.3   log 0                ; mode 1: entries from index 0 on
//! 0.4   state 0.05           ; the state in 0.05 s
//! 0.5   feed                 ; when the next block at feed begins
//! 0.6   standstill           ; where and when a feed hold of now would stand
//! 0.7   set PARTS 3          ; V.E.PARTS is 3 from now on
//! 0.8   variable PARTS       ; its value
//! 0.9   loop on              ; V.RTG.LOOP.ENABLED is true from now on; `off`: false
//! 1.0   loop 3               ; the same for three passes
//! end   log 0                ; at the end of the program
//! ```
use super::laser::Laser;
use super::variable::{name, value};
use crate::decimal::parse as decimal;
use crate::diagnose::{Diagnostic, Source, nearest};
use crate::events::seconds;
use glidepath::machine::{InterpolatorData, InterpolatorFunctions};
use std::path::Path;

/// A request of the PLC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ask {
    /// The reach: the known length of the path.
    Reach,
    /// Elements between two distances, mm.
    Elements {
        /// The first distance.
        from: f64,
        /// The last one.
        to: f64,
    },
    /// Entries from this index on.
    Log(u32),
    /// The state in this number of ns.
    State(u64),
    /// When the next block at feed begins.
    Feed,
    /// The point where a feed hold would stop the axes now.
    Standstill,
    /// From now on a laser follows the contour.
    Laser(Laser),
    /// Writes a variable V.E.
    Set(&'static str, f64),
    /// The value of a variable V.E.
    Variable(&'static str),
    /// V.RTG.LOOP.ENABLED is true from now on; with a number until the planner has decided on this number of
    /// passes.
    LoopOn(Option<u32>),
    /// V.RTG.LOOP.ENABLED is false from now on.
    LoopOff,
}

const WORDS: [&str; 10] =
    ["reach", "elements", "log", "state", "feed", "standstill", "laser", "set", "variable", "loop"];

impl Ask {
    /// The word of the file.
    pub fn word(self) -> &'static str {
        WORDS[match self {
            Self::Reach => 0,
            Self::Elements { .. } => 1,
            Self::Log(_) => 2,
            Self::State(_) => 3,
            Self::Feed => 4,
            Self::Standstill => 5,
            Self::Laser(_) => 6,
            Self::Set(..) => 7,
            Self::Variable(_) => 8,
            Self::LoopOn(_) | Self::LoopOff => 9,
        }]
    }
}

/// The time `end`.
pub const END: u64 = u64::MAX;

/// A request with its time and its line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Time since the first set point, ns; [`END`] is the end of the program.
    pub time_ns: u64,
    /// The request.
    pub ask: Ask,
    /// Line of the file, from 1.
    pub line: usize,
}

/// A file of requests.
pub struct Script {
    /// In the order of time.
    pub requests: Vec<Request>,
    source: Source,
}

/// Largest time, s; largest distance, mm.
const LATEST: u64 = 1_000_000;
const FURTHEST: u64 = 500_000_000;
/// Most passes of `loop`.
const PASSES: u64 = 1_000_000_000;

impl Script {
    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, or some of its lines.
    pub fn read(path: &Path) -> Result<Self, Vec<Diagnostic>> {
        Self::parse(Source::read(path)?)
    }

    /// Variables that the file writes or reads.
    pub fn variables(&self) -> impl Iterator<Item = &'static str> {
        self.requests.iter().filter_map(|request| match request.ask {
            Ask::Set(name, _) | Ask::Variable(name) => Some(name),
            _ => None,
        })
    }

    /// Warnings for requests that were not reached.
    pub fn unreached(&self, those: std::ops::Range<usize>) -> Vec<Diagnostic> {
        let late = self.requests.get(those).unwrap_or_default();
        late.iter()
            .map(|request| {
                let message = "the program ends before this request";
                let width = self.source.line(request.line).len();
                let expected = "an earlier time, or `end` in its place";
                Diagnostic::warning(message).at(&self.source, request.line, 1, width).expected(expected)
            })
            .collect()
    }

    /// Remarks on requests whose function the machine data do not enable.
    pub fn missing(&self, data: &InterpolatorData) -> Vec<Diagnostic> {
        let need = |request: &Request| {
            let (function, name) = match request.ask {
                Ask::Reach | Ask::Elements { .. } | Ask::Log(_) | Ask::Laser(_) => {
                    (InterpolatorFunctions::CONTOUR_LAH, "FCT_CONTOUR_LAH")
                }
                Ask::State(_) => (InterpolatorFunctions::CALC_STATE_AT_T, "FCT_CALC_STATE_AT_T"),
                Ask::Feed => (InterpolatorFunctions::CALC_TIME, "FCT_CALC_TIME"),
                Ask::Standstill => (InterpolatorFunctions::CALC_POS_V_0, "FCT_CALC_POS_V_0"),
                Ask::Set(..) | Ask::Variable(_) | Ask::LoopOn(_) | Ask::LoopOff => return None,
            };
            match request.ask {
                _ if !data.has(function) => {
                    Some(format!("{name} in configuration.interpolator.function (P-CHAN-00650)"))
                }
                Ask::Log(_) if data.fb_storage_size == 0 => {
                    Some("startup.fb_storage_size above 0 (P-STUP-00033)".to_owned())
                }
                _ => None,
            }
        };
        let told = self.requests.iter().filter_map(|request| Some((request, need(request)?)));
        told.map(|(request, expected)| {
            let message = format!("the machine data do not enable what {} needs", request.ask.word());
            let width = self.source.line(request.line).len();
            Diagnostic::warning(message)
                .at(&self.source, request.line, 1, width)
                .expected(format!("expected {expected}"))
        })
        .collect()
    }

    fn parse(source: Source) -> Result<Self, Vec<Diagnostic>> {
        let mut requests: Vec<Request> = Vec::new();
        let mut refused = Vec::new();
        for (index, text) in source.lines().enumerate() {
            let line = index + 1;
            let mut words = Words::of(text);
            let request = words.request(line).and_then(|request| match (request, requests.last()) {
                (Some(request), Some(before)) if before.time_ns > request.time_ns => {
                    let expected = format!("{} or later: times ascend", seconds(before.time_ns));
                    Err((1, 1, "a time before the one above".into(), expected))
                }
                _ => Ok(request),
            });
            match request {
                Ok(request) => requests.extend(request),
                Err((column, length, message, expected)) => {
                    let diagnostic = Diagnostic::error(message).at(&source, line, column, length);
                    refused.push(diagnostic.expected(format!("expected {expected}")));
                }
            }
        }
        if refused.is_empty() { Ok(Self { requests, source }) } else { Err(refused) }
    }
}

/// Column, length, message, what was expected.
type Unfit = (usize, usize, String, String);

/// The words of a line.
struct Words<'a> {
    line: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    fn of(line: &'a [u8]) -> Self {
        let end = line.iter().position(|byte| matches!(byte, b';' | b'#')).unwrap_or(line.len());
        Self { line: line[..end].trim_ascii_end(), at: 0 }
    }

    /// The next word with its column; empty after the last word.
    fn next(&mut self) -> (&'a [u8], usize) {
        let rest = &self.line[self.at..];
        let begin = self.at + rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
        let rest = &self.line[begin..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at = begin + length;
        (&rest[..length], begin + 1)
    }

    /// A number with at most `places` decimals, up to `most`, in units of the last decimal.
    fn number(&mut self, places: usize, most: u64, expected: &str) -> Result<u64, Unfit> {
        let (text, column) = self.next();
        let most = most * 10u64.pow(places as u32);
        decimal(text, places).filter(|value| *value <= most).ok_or_else(|| unfit(text, column, expected))
    }

    /// The name of a variable V.E.
    fn variable(&mut self) -> Result<&'static str, Unfit> {
        let (text, column) = self.next();
        let shown = String::from_utf8_lossy(text);
        name(&shown).map_err(|expected| unfit(text, column, &expected))
    }

    fn mm(&mut self) -> Result<f64, Unfit> {
        let expected = format!("millimetres, 0…{FURTHEST}, six decimals at most");
        Ok(self.number(6, FURTHEST, &expected)? as f64 / 1e6)
    }

    fn request(&mut self, line: usize) -> Result<Option<Request>, Unfit> {
        if self.line.trim_ascii().is_empty() {
            return Ok(None);
        }
        let before = self.at;
        let time_ns = match self.next() {
            (b"end", _) => END,
            _ => {
                self.at = before;
                self.number(9, LATEST, &format!("a time in seconds, 0…{LATEST}, or `end`"))?
            }
        };
        let (word, column) = self.next();
        let ask = match word {
            b"reach" => Ask::Reach,
            b"elements" => Ask::Elements { from: self.mm()?, to: self.mm()? },
            b"log" => Ask::Log(self.number(0, u32::MAX.into(), "an index, 0…4294967295")? as u32),
            b"state" => Ask::State(self.number(9, LATEST, &format!("seconds from then, 0…{LATEST}"))?),
            b"feed" => Ask::Feed,
            b"standstill" => Ask::Standstill,
            b"laser" => Ask::Laser(Laser {
                near_mm: self.mm()?,
                knee: (self.number(3, 180, "the angle of a sharp knee, 0…180 degrees")? as f64 / 1e3)
                    .to_radians(),
                radius_mm: self.mm()?,
                low: self.number(0, 100, "less power, 0…100 percent, a whole number")? as u8,
            }),
            b"set" | b"loop" if time_ns == END => {
                return Err(unfit(word, column, "a question: at the end of the program nothing follows"));
            }
            b"set" => {
                let name = self.variable()?;
                let (text, column) = self.next();
                let value = std::str::from_utf8(text).ok().and_then(value);
                Ask::Set(name, value.ok_or_else(|| unfit(text, column, "a number, TRUE or FALSE"))?)
            }
            b"variable" => Ask::Variable(self.variable()?),
            b"loop" => match self.next() {
                (b"on", _) => Ask::LoopOn(None),
                (b"off", _) => Ask::LoopOff,
                (text, column) => {
                    let passes = decimal(text, 0).filter(|passes| (1..=PASSES).contains(passes));
                    let expected = format!("on, off, or the number of passes, 1…{PASSES}");
                    Ask::LoopOn(Some(passes.ok_or_else(|| unfit(text, column, &expected))? as u32))
                }
            },
            _ => {
                let shown = String::from_utf8_lossy(word);
                let meant = nearest(&shown, WORDS).filter(|_| !word.is_empty());
                let meant = meant.map_or_else(String::new, |word| format!("; is {word} meant?"));
                return Err(unfit(word, column, &format!("{}{meant}", WORDS.join(", "))));
            }
        };
        let (rest, column) = self.next();
        if !rest.is_empty() {
            return Err(unfit(rest, column, "the end of the line, or a comment behind ; or #"));
        }
        Ok(Some(Request { time_ns, ask, line }))
    }
}

fn unfit(text: &[u8], column: usize, expected: &str) -> Unfit {
    let shown: String = String::from_utf8_lossy(text).chars().filter(|c| !c.is_control()).collect();
    let message = if text.is_empty() { "a value is missing".into() } else { format!("`{shown}` is refused") };
    (column, text.len().max(1), message, expected.into())
}
