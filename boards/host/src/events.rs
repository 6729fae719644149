//! Events from outside during a program: commands of the operator, acknowledgements, late text, and a planner
//! without time.
//!
//! One event per line: seconds since the first set point, a word, its value.
//!
//! ```text
//! 0.5   override 150      ; percent, 0…200
//! 1     feedhold          # until resume
//! 1.75  resume
//! 2     reduced on        ; or off
//! 2.2   starve 0.08       ; seconds in which no program text comes
//! 2.3   stall 0.05        ; seconds in which the planner gets no time
//! 2.5   ack M25           ; or an H function
//! 3     abort
//! ```
//!
//! Times ascend. An event acts at the first tick at or after its time.
use crate::decimal::{parse as decimal, push_scaled};
use crate::diagnose::{Diagnostic, Source, nearest};
use crate::statistics::Outcome;
use glidepath::control::{Commands, MAX_OVERRIDE};
use glidepath::operator::Operator;
use glidepath::queue::Function;
use std::path::Path;

/// An event with its place in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Time since the first set point, ns.
    pub time_ns: u64,
    /// The event.
    pub what: What,
    /// Line, from 1.
    pub line: usize,
    /// Column of the word, from 1, in bytes.
    pub column: usize,
}

/// An event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// Feed override, LSB 0.1 %.
    Override(u16),
    /// Feed hold.
    FeedHold,
    /// Resume.
    Resume,
    /// Abort.
    Abort,
    /// Reduced speed on or off.
    Reduced(bool),
    /// The program text is missing for this time, ns.
    Starve(u64),
    /// The planner gets no processor time for this time, ns.
    Stall(u64),
    /// A function is acknowledged.
    Acknowledge(Function),
}

impl What {
    /// Passes the command to a channel. Late text and a late planner are no commands. `false`: an
    /// acknowledgement without a waiting function.
    pub fn give<const AXES: usize>(self, operator: &Operator<'_, AXES>) -> bool {
        match self {
            Self::Acknowledge(function) => return operator.acknowledge(function).is_ok(),
            Self::Override(feed) => operator.set_override(feed),
            Self::FeedHold => operator.feed_hold(),
            Self::Resume => operator.resume(),
            Self::Abort => operator.abort(),
            Self::Reduced(on) => operator.set_reduced(on),
            Self::Starve(_) | Self::Stall(_) => {}
        }
        true
    }

    /// The word of the file.
    pub fn word(self) -> &'static str {
        WORDS[match self {
            Self::Override(_) => 0,
            Self::FeedHold => 1,
            Self::Resume => 2,
            Self::Abort => 3,
            Self::Reduced(_) => 4,
            Self::Starve(_) => 5,
            Self::Acknowledge(_) => 6,
            Self::Stall(_) => 7,
        }]
    }
}

/// Text for people.
impl std::fmt::Display for What {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Override(feed) if feed % 10 == 0 => write!(f, "override {} %", feed / 10),
            Self::Override(feed) => write!(f, "override {}.{} %", feed / 10, feed % 10),
            Self::FeedHold => f.write_str("feed hold"),
            Self::Resume | Self::Abort => f.write_str(self.word()),
            Self::Reduced(on) => write!(f, "reduced {}", if *on { "on" } else { "off" }),
            Self::Starve(ns) => write!(f, "program text late {} s", seconds(*ns)),
            Self::Stall(ns) => write!(f, "planner late {} s", seconds(*ns)),
            Self::Acknowledge(function) => write!(f, "ack {}", function_name(*function)),
        }
    }
}

impl Event {
    /// The tick at or after its time.
    pub fn tick(&self, cycle_us: u32) -> u64 {
        ticks(self.time_ns, cycle_us)
    }
}

/// A file of events.
pub struct Script {
    source: Source,
    /// The events, in the order of the file.
    pub events: Vec<Event>,
}

impl Script {
    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, or some of its lines.
    pub fn read(path: &Path) -> Result<Self, Vec<Diagnostic>> {
        let source = Source::read(path)?;
        let events = parse(&source)?;
        Ok(Self { source, events })
    }

    /// A warning at the word of an event.
    pub fn at(&self, event: &Event, diagnostic: Diagnostic) -> Diagnostic {
        diagnostic.at(&self.source, event.line, event.column, event.what.word().len())
    }

    /// Warnings: for each event after the end of the program, for ignored acknowledgements, and for a reduced
    /// speed that no axis has.
    pub fn unused(
        &self,
        outcomes: &[Outcome],
        end_s: f64,
        reduces: bool,
    ) -> impl Iterator<Item = Diagnostic> {
        self.events.iter().zip(outcomes).filter_map(move |(event, outcome)| {
            let message = match event.what {
                _ if outcome.tick.is_none() => format!("the program ends at {end_s:.3} s, before this event"),
                What::Acknowledge(function) if outcome.ignored => {
                    let name = function_name(function);
                    format!("nothing waits for {name} at this time: it is not put out yet, or acknowledged already")
                }
                What::Reduced(true) if !reduces => {
                    "no axis has a reduced speed (vb_max_red, P-AXIS-00214): nothing changes".into()
                }
                _ => return None,
            };
            Some(self.at(event, Diagnostic::warning(message)))
        })
    }
}

/// The events of a run during the simulation.
pub struct Schedule<'a> {
    events: &'a [Event],
    cycle_us: u32,
    next: usize,
    /// Ticks before which program text is missing, or the planner has no time.
    starved_until: u64,
    stalled_until: u64,
}

impl<'a> Schedule<'a> {
    /// Nothing has happened yet.
    pub fn new(events: &'a [Event], cycle_us: u32) -> Self {
        Self { events, cycle_us, next: 0, starved_until: 0, stalled_until: 0 }
    }

    /// Returns the next event at `tick`; commands go to `operator`. `false`: no function waits for the
    /// acknowledgement.
    pub fn due<const AXES: usize>(
        &mut self,
        tick: u64,
        operator: &Operator<'_, AXES>,
    ) -> Option<(usize, What, bool)> {
        let event = self.events.get(self.next).filter(|event| event.tick(self.cycle_us) <= tick)?;
        let taken = event.what.give(operator);
        match event.what {
            What::Starve(ns) => {
                self.starved_until = self.starved_until.max(tick + ticks(ns, self.cycle_us));
            }
            What::Stall(ns) => {
                self.stalled_until = self.stalled_until.max(tick + ticks(ns, self.cycle_us));
            }
            _ => {}
        }
        self.next += 1;
        Some((self.next - 1, event.what, taken))
    }

    /// Whether the program text is late at `tick`.
    pub fn is_starved(&self, tick: u64) -> bool {
        tick < self.starved_until
    }

    /// Whether the planner is late at `tick`.
    pub fn is_stalled(&self, tick: u64) -> bool {
        tick < self.stalled_until
    }

    /// Whether a later event resumes or ends a motion that these commands stop.
    pub fn goes_on(&self, commands: &Commands) -> bool {
        let later = |what: fn(What) -> bool| self.events[self.next..].iter().any(|event| what(event.what));
        let resumed = !commands.hold || later(|what| what == What::Resume);
        let fed = commands.feed > 0 || later(|what| matches!(what, What::Override(1..)));
        commands.abort || later(|what| what == What::Abort) || (resumed && fed)
    }

    /// Whether a later event ends the program.
    pub fn aborts(&self) -> bool {
        self.events[self.next..].iter().any(|event| event.what == What::Abort)
    }

    /// Whether an event acknowledges this function, now or before.
    pub fn acknowledges(&self, function: Function) -> bool {
        self.events.iter().any(|event| event.what == What::Acknowledge(function))
    }

    /// Whether a later event continues or ends a motion that waits for this function.
    pub fn answers(&self, function: Function) -> bool {
        let ends = |what| what == What::Abort || what == What::Acknowledge(function);
        self.events[self.next..].iter().any(|event| ends(event.what))
    }

    /// The last event that acknowledged this function although no function waited.
    pub fn in_vain(&self, function: Function, outcomes: &[Outcome]) -> Option<&'a Event> {
        let vain = |(event, outcome): &(&Event, &Outcome)| {
            outcome.ignored && event.what == What::Acknowledge(function)
        };
        self.events.iter().zip(outcomes).rfind(vain).map(|(event, _)| event)
    }

    /// The event that caused such a standstill.
    pub fn cause(&self, commands: &Commands) -> Option<&'a Event> {
        let holds = |event: &&Event| match event.what {
            What::FeedHold => commands.hold,
            What::Override(0) => commands.feed == 0,
            _ => false,
        };
        self.events[..self.next].iter().rev().find(holds)
    }
}

/// Number of ticks in this time; the last tick may be used in part.
pub fn ticks(ns: u64, cycle_us: u32) -> u64 {
    ns.div_ceil(u64::from(cycle_us.max(1)) * 1000)
}

/// Seconds without unnecessary digits.
pub fn seconds(ns: u64) -> String {
    let mut out = String::new();
    push_scaled(&mut out, i128::from(ns), 9);
    if out.ends_with(".0") {
        out.truncate(out.len() - 2);
    }
    out
}

const WORDS: [&str; 8] = ["override", "feedhold", "resume", "abort", "reduced", "starve", "ack", "stall"];

/// Largest time, s.
const LATEST: u64 = 1_000_000;

/// All events, or all lines with errors, one message each.
fn parse(source: &Source) -> Result<Vec<Event>, Vec<Diagnostic>> {
    let mut events: Vec<Event> = Vec::new();
    let mut refused = Vec::new();
    for (index, text) in source.lines().enumerate() {
        let line = index + 1;
        let fail = |Unfit { column, length, message, expected }: Unfit| {
            Diagnostic::error(message).at(source, line, column, length).expected(expected)
        };
        match event(text, line) {
            Ok(None) => {}
            Ok(Some((at, event))) => match events.last() {
                Some(before) if before.time_ns > event.time_ns => {
                    let expected =
                        format!("{} of line {} or later: times ascend", seconds(before.time_ns), before.line);
                    refused.push(fail(at.unfit("a time before the one above", expected)));
                }
                _ => events.push(event),
            },
            Err(unfit) => refused.push(fail(unfit)),
        }
    }
    if refused.is_empty() { Ok(events) } else { Err(refused) }
}

/// Reason for which a word is refused.
struct Unfit {
    column: usize,
    length: usize,
    message: String,
    expected: String,
}

/// A word of a line; after the last word, the empty word at the end.
#[derive(Clone, Copy)]
struct Word<'a> {
    text: &'a [u8],
    column: usize,
}

impl Word<'_> {
    fn unfit(&self, message: impl Into<String>, expected: impl Into<String>) -> Unfit {
        let (message, expected) = (message.into(), expected.into());
        Unfit {
            column: self.column,
            length: self.text.len(),
            message,
            expected: format!("expected {expected}"),
        }
    }

    /// Printable text of the word.
    fn shown(&self) -> String {
        String::from_utf8_lossy(self.text).chars().filter(|character| !character.is_control()).collect()
    }

    fn refused(&self, missing: &str, expected: impl Into<String>) -> Unfit {
        if self.text.is_empty() {
            return self.unfit(missing, expected);
        }
        self.unfit(format!("`{}` is refused", self.shown()), expected)
    }
}

fn event(line: &[u8], number: usize) -> Result<Option<(Word<'_>, Event)>, Unfit> {
    let end = line.iter().position(|byte| matches!(byte, b';' | b'#')).unwrap_or(line.len());
    let mut words = words(&line[..end]);
    let mut next =
        || words.next().unwrap_or(Word { text: b"", column: line[..end].trim_ascii_end().len() + 1 });
    let time = next();
    if time.text.is_empty() {
        return Ok(None);
    }
    let limit = format!("a time in seconds, 0…{LATEST}");
    let time_ns = decimal(time.text, 9).filter(|&ns| ns <= LATEST * 1_000_000_000);
    let time_ns = time_ns.ok_or_else(|| time.refused("", limit))?;
    let word = next();
    let what = match word.text {
        b"override" => {
            let value = next();
            let percent = decimal(value.text, 1).and_then(|feed| u16::try_from(feed).ok());
            let feed = percent.filter(|&feed| feed <= MAX_OVERRIDE);
            let expected = "percent, 0…200, one decimal at most";
            What::Override(feed.ok_or_else(|| value.refused("the override is missing", expected))?)
        }
        b"feedhold" => What::FeedHold,
        b"resume" => What::Resume,
        b"abort" => What::Abort,
        b"reduced" => {
            let value = next();
            match value.text {
                b"on" => What::Reduced(true),
                b"off" => What::Reduced(false),
                _ => return Err(value.refused("on or off is missing", "on or off")),
            }
        }
        b"starve" | b"stall" => {
            let (what, of): (fn(u64) -> What, _) = if word.text == b"starve" {
                (What::Starve, "program text")
            } else {
                (What::Stall, "the planner")
            };
            let value = next();
            let ns = decimal(value.text, 9).filter(|&ns| ns > 0 && ns <= LATEST * 1_000_000_000);
            let expected = format!("seconds without {of}, above 0, at most {LATEST}");
            what(ns.ok_or_else(|| value.refused("the duration is missing", expected))?)
        }
        b"ack" => {
            let value = next();
            let expected = "an M or H function, M25 or H7, 0…999";
            let function = function(value.text);
            What::Acknowledge(function.ok_or_else(|| value.refused("the function is missing", expected))?)
        }
        _ => {
            let expected = "override, feedhold, resume, abort, reduced, starve, stall or ack";
            let meant = nearest(&word.shown(), WORDS).filter(|_| !word.text.is_empty());
            let expected =
                meant.map_or_else(|| expected.into(), |one| format!("{expected}; is {one} meant?"));
            return Err(word.refused("the event is missing", expected));
        }
    };
    let rest = next();
    if !rest.text.is_empty() {
        return Err(rest.refused("", "the end of the line, or a comment behind ; or #"));
    }
    Ok(Some((time, Event { time_ns, what, line: number, column: word.column })))
}

fn words(line: &[u8]) -> impl Iterator<Item = Word<'_>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        at += line.get(at..)?.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let rest = &line[at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let word = Word { text: &rest[..length], column: at + 1 };
        at += length;
        Some(word)
    })
}

/// `M25`, `H7`.
fn function(text: &[u8]) -> Option<Function> {
    let (letter, digits) = text.split_first()?;
    let plain = digits.len() <= 3 && digits.iter().all(u8::is_ascii_digit);
    let code = std::str::from_utf8(digits).ok().filter(|_| plain)?.parse().ok()?;
    match letter {
        b'M' => Some(Function::M(code)),
        b'H' => Some(Function::H(code)),
        _ => None,
    }
}

/// As it is programmed.
pub fn function_name(function: Function) -> String {
    match function {
        Function::M(code) => format!("M{code}"),
        Function::H(code) => format!("H{code}"),
        Function::Spindle(speed) => format!("S{speed}"),
        Function::Tool(tool) => format!("T{tool}"),
        Function::Digital(port, on) => format!("P{port}={}", u8::from(on)),
        Function::Analog(port, value) => format!("E{port}={value}"),
        Function::Input(wait) => {
            format!("M66 {}{} L{}", if wait.is_analog { 'E' } else { 'P' }, wait.port, wait.mode)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glidepath::channel::Channel;
    use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
    use glidepath::quantity::Position;

    fn read(text: &str) -> Result<Vec<Event>, Vec<(usize, usize)>> {
        let source = Source { name: "events".into(), text: text.as_bytes().to_vec() };
        parse(&source).map_err(|refused| refused.iter().map(Diagnostic::place).collect())
    }

    #[test]
    fn every_event_is_read() {
        let text = "; all of them\r\n0 override 62.5\r\n\r\n 0.25\tfeedhold # now\r\n1 resume\r\n1. reduced on\r\n\
            1.000000001 reduced off;\r\n2 starve 0.08\r\n2 ack M25\n2 ack H007 ; now\n30 abort";
        let events = read(text).unwrap_or_default();
        let seen: Vec<_> = events.iter().map(|event| (event.time_ns, event.what, event.line)).collect();
        let expected = [
            (0, What::Override(625), 2),
            (250_000_000, What::FeedHold, 4),
            (1_000_000_000, What::Resume, 5),
            (1_000_000_000, What::Reduced(true), 6),
            (1_000_000_001, What::Reduced(false), 7),
            (2_000_000_000, What::Starve(80_000_000), 8),
            (2_000_000_000, What::Acknowledge(Function::M(25)), 9),
            (2_000_000_000, What::Acknowledge(Function::H(7)), 10),
            (30_000_000_000, What::Abort, 11),
        ];
        assert_eq!(seen, expected);
        assert_eq!(events[1].column, 7);
    }

    fn machine() -> MachineData<1> {
        let name = AxisName::new("X").expect("a letter");
        let channel_data = ChannelData { look_ahead: 10, ..ChannelData::new() };
        MachineData { axes: [AxisData::new(name, AxisKind::Linear)], channel: channel_data }
    }

    fn operator<'a>(channel: &'a mut Channel<1, 10>, machine: &'a MachineData<1>) -> Operator<'a, 1> {
        match channel.split(machine, [Position::ZERO], &b"M30"[..]) {
            Ok(handles) => handles.operator,
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn a_standstill_is_known_to_last() {
        let lasts = |text: &str, tick: u64| {
            let events = read(text).unwrap_or_default();
            let mut schedule = Schedule::new(&events, 1000);
            let mut channel = Box::new(Channel::<1, 10>::new());
            let machine = machine();
            let operator = operator(&mut channel, &machine);
            while schedule.due(tick, &operator).is_some() {}
            let commands = operator.commands();
            (!schedule.goes_on(&commands), schedule.cause(&commands).map(|event| event.line))
        };
        assert_eq!(lasts("1 feedhold\n2 override 50", 1000), (true, Some(1)));
        assert_eq!(lasts("1 feedhold\n2 resume", 1000), (false, Some(1)));
        assert_eq!(lasts("1 feedhold\n2 resume", 2000), (false, None));
        assert_eq!(lasts("1 feedhold\n2 abort", 1000), (false, Some(1)));
        assert_eq!(lasts("1 override 0\n2 override 0.1", 1000), (false, Some(1)));
        assert_eq!(lasts("0 feedhold\n1 override 0\n2 resume", 1000), (true, Some(2)));
        assert_eq!(lasts("0 feedhold\n1 override 0\n2 resume\n2 override 9", 1000), (false, Some(2)));
    }

    #[test]
    fn what_is_late_comes_back() {
        let events = read("0.01 stall 0.0021\n0.012 stall 0.004\n0.02 starve 0.001").unwrap_or_default();
        let mut schedule = Schedule::new(&events, 1000);
        let mut channel = Box::new(Channel::<1, 10>::new());
        let machine = machine();
        let operator = operator(&mut channel, &machine);
        let (mut stalled, mut starved) = (Vec::new(), Vec::new());
        for tick in 0..30 {
            while schedule.due(tick, &operator).is_some() {}
            stalled.extend(schedule.is_stalled(tick).then_some(tick));
            starved.extend(schedule.is_starved(tick).then_some(tick));
        }
        assert_eq!((stalled, starved), ((10..16).collect::<Vec<u64>>(), vec![20]));
    }

    #[test]
    fn an_event_acts_at_the_tick_at_or_after_it() {
        let tick = |text: &str, cycle_us| read(text).unwrap_or_default()[0].tick(cycle_us);
        assert_eq!(
            (tick("0 abort", 1000), tick("0.005 abort", 1000), tick("0.0050001 abort", 1000)),
            (0, 5, 6)
        );
        assert_eq!((tick("0.0005 abort", 100), tick("0.0005 abort", 2000)), (5, 1));
    }

    #[test]
    fn what_is_wrong_has_its_place() {
        for (text, place) in [
            ("one abort", (1, 1)),
            ("-1 abort", (1, 1)),
            ("1e3 abort", (1, 1)),
            ("1000001 abort", (1, 1)),
            ("0.0000000001 abort", (1, 1)),
            ("\n1", (2, 2)),
            ("1 Abort", (1, 3)),
            ("1 stop", (1, 3)),
            ("1 override", (1, 11)),
            ("1 override ; 50", (1, 11)),
            ("1 override 200.1", (1, 12)),
            ("1 override 99.95", (1, 12)),
            ("1 override -5", (1, 12)),
            ("1 reduced yes", (1, 11)),
            ("1 starve 0", (1, 10)),
            ("1 stall", (1, 8)),
            ("1 resume now", (1, 10)),
            ("1 ack", (1, 6)),
            ("1 ack 25", (1, 7)),
            ("1 ack M", (1, 7)),
            ("1 ack T5", (1, 7)),
            ("1 ack M+5", (1, 7)),
            ("1 ack M1000", (1, 7)),
            ("2 feedhold\n1.9 resume", (2, 1)),
            ("1 \u{e4}bort", (1, 3)),
        ] {
            assert_eq!(read(text), Err(vec![place]), "{text}");
        }
        assert_eq!(read("1 halt\n2 resume\nx\n"), Err(vec![(1, 3), (3, 1)]));
    }
}
