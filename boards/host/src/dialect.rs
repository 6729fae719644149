//! The dialect of a program: selected by the command line or the machine data, or found from the text.
use crate::diagnose::{Diagnostic, Source};
use glidepath::machine::Dialect;
use glidepath::nc::{ADDRESSES, WORDS, WordEntry};
use std::fmt::Write as _;

/// The selection by command line or machine data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Choice {
    /// Found from the text: once, before the program is read.
    #[default]
    Auto,
    /// ISG's language.
    Isg,
    /// LinuxCNC's RS274/NGC.
    Linuxcnc,
    /// Grbl 1.1, with words of grblHAL and FluidNC.
    Grbl,
    /// Fanuc's controllers for mills, without macro B.
    Fanuc,
}

impl Choice {
    /// All choices with their names.
    pub const ALL: [(&str, Self); 5] = [
        ("auto", Self::Auto),
        ("isg", Self::Isg),
        ("linuxcnc", Self::Linuxcnc),
        ("grbl", Self::Grbl),
        ("fanuc", Self::Fanuc),
    ];

    /// The selected dialect, if there is one.
    pub const fn dialect(self) -> Option<Dialect> {
        match self {
            Self::Auto => None,
            Self::Isg => Some(Dialect::Isg),
            Self::Linuxcnc => Some(Dialect::LinuxCnc),
            Self::Grbl => Some(Dialect::Grbl),
            Self::Fanuc => Some(Dialect::Fanuc),
        }
    }
}

/// Returns the dialect of the program. If the text decides and the dialect is not ISG's, a note names dialect
/// and word.
///
/// # Errors
/// The text is a program for a 3-D printer.
pub fn choose(choice: Choice, program: &Source) -> Result<Dialect, Vec<Diagnostic>> {
    if let Some(dialect) = choice.dialect() {
        let found = Found::of(program);
        if dialect == Dialect::Isg {
            tell_traps(if found.isg.is_none() { found.traps } else { Vec::new() });
        }
        return ends_once(dialect, found.end.behind, program);
    }
    let found = Found::of(program);
    let traps = if found.isg.is_none() { found.traps.clone() } else { Vec::new() };
    let behind = found.end.behind.clone();
    // Words of others beside a statement of ISG are refused: the reason for ISG is of use.
    let own = found.isg.clone().filter(|_| found.foreign);
    match found.decide() {
        Shown::Isg => {
            if let Some(Mark { word, line, .. }) = own {
                anstream::eprintln!("note: dialect isg: {word} in line {line} (--dialect chooses another)");
            }
            tell_traps(traps);
            Ok(Dialect::Isg)
        }
        Shown::Two([(first, one), (second, two)]) => {
            let message = format!(
                "{} shows {}, and {} in line {} shows {}",
                two.word,
                second.name(),
                one.word,
                one.line,
                first.name()
            );
            let error = Diagnostic::error(message).at(program, two.line, two.column, two.length);
            let wanted = format!("expected --dialect {} or --dialect {}", first.name(), second.name());
            Err(vec![error.expected(wanted)])
        }
        Shown::Unclear(mark, meaning) => {
            let message = format!("{} {meaning}, and no other word shows the dialect", mark.word);
            let error = Diagnostic::error(message).at(program, mark.line, mark.column, mark.length);
            Err(vec![error.expected("expected --dialect isg, linuxcnc, grbl or fanuc")])
        }
        Shown::Printer(mark) => {
            let message = format!("{} is a word of 3-D printers (Marlin)", mark.word);
            let error = Diagnostic::error(message).at(program, mark.line, mark.column, mark.length);
            Err(vec![error.expected("expected a CNC program; --dialect grbl reads it as one")])
        }
        Shown::Is(dialect, mark) => {
            let (name, Mark { word, line, .. }) = (dialect.name(), mark);
            anstream::eprintln!("note: dialect {name}: {word} in line {line} (--dialect chooses another)");
            ends_once(dialect, behind, program)
        }
    }
}

/// Refuses text after M2 or M30, with Grbl's dialect. Grbl continues with such text; here a program ends at
/// M2 or M30.
fn ends_once(dialect: Dialect, behind: Option<Mark>, program: &Source) -> Result<Dialect, Vec<Diagnostic>> {
    let Some(mark) = behind.filter(|_| dialect == Dialect::Grbl) else { return Ok(dialect) };
    let error = Diagnostic::error("a word behind M2 or M30, which Grbl carries out");
    let error = error.at(program, mark.line, mark.column, mark.length);
    Err(vec![error.expected("expected M2 or M30 in the last block, or --dialect linuxcnc, which ends there")])
}

/// Prints a note for each word that another dialect carries out differently.
fn tell_traps(mut traps: Vec<(Mark, &'static str, bool)>) {
    traps.sort_by(|one, other| one.0.word.cmp(&other.0.word).then(one.0.line.cmp(&other.0.line)));
    traps.dedup_by(|next, first| next.0.word == first.0.word);
    traps.sort_by_key(|(mark, ..)| mark.line);
    for (Mark { word, line, .. }, meaning, _) in traps {
        anstream::eprintln!("note: line {line}: {word} {meaning}");
    }
}

/// A word that indicates a dialect.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Mark {
    word: String,
    line: usize,
    /// Column in bytes, from 1.
    column: usize,
    length: usize,
}

/// The first mark of each kind in the text.
#[derive(Default)]
struct Found {
    isg: Option<Mark>,
    /// A word of ISG's language and of other dialects; the mark counts only without other marks.
    perhaps_isg: Option<Mark>,
    linuxcnc: Option<Mark>,
    grbl: Option<Mark>,
    fanuc: Option<Mark>,
    numbers: Numbers,
    /// G4 with X or U: Fanuc's and ISG's dwell.
    dwell: Option<Mark>,
    /// A word that LinuxCNC and Fanuc have, but not Grbl.
    full: Option<Mark>,
    /// A word that LinuxCNC and Grbl have, but not ISG.
    either: Option<Mark>,
    /// One of these words that ISG's programs do not contain: a unit, a tool length, a return to a position.
    foreign: bool,
    printer: Option<Mark>,
    /// S together with axes in G1: pixel rows of a laser.
    rows: Vec<Mark>,
    end: End,
    /// Words that have another meaning in ISG's language, each once.
    /// The flag: whether the word leads to another path.
    traps: Vec<(Mark, &'static str, bool)>,
}

/// How the text ends.
#[derive(Default)]
struct End {
    /// The text ends with M2, M30 or `%`.
    is_shown: bool,
    /// M2 or M30 has occurred.
    is_over: bool,
    /// The first word after M2 or M30. Grbl carries out this word; other dialects do not read it.
    behind: Option<Mark>,
}

/// Marks that distinguish Fanuc's numbers from those of other dialects.
#[derive(Default)]
struct Numbers {
    /// A program number. Fanuc's programs, and some others, begin with a program number.
    program: Option<Mark>,
    /// G90.1 or G91.1, which Fanuc does not have.
    centre: Option<Mark>,
    /// A length without a decimal point, which Fanuc counts in its least increment.
    whole: Option<Mark>,
}

/// The result of the search.
#[derive(Debug, PartialEq, Eq)]
enum Shown {
    Isg,
    Is(Dialect, Mark),
    /// Words of two dialects.
    Two([(Dialect, Mark); 2]),
    /// A word with another path in ISG's language, and no mark of a dialect.
    Unclear(Mark, &'static str),
    Printer(Mark),
}

/// Names of programs that write text for LinuxCNC, Grbl and similar controllers, as in comments.
const SENDERS: [&str; 30] = [
    "autodesk",
    "bcnc",
    "cambam",
    "carbide",
    "carvera",
    "cncjs",
    "dmap2gcode",
    "estlcam",
    "f-engrave",
    "flatcam",
    "freecad",
    "fusion 360",
    "gcmc",
    "gcodetools",
    "heekscnc",
    "inkscape",
    "jscut",
    "kiri:moto",
    "lasergrbl",
    "laserweb",
    "lightburn",
    "mach3",
    "mach4",
    "openbuilds",
    "pcb-gcode",
    "pcb2gcode",
    "pycam",
    "sheetcam",
    "uccnc",
    "vectric",
];

/// G words of LinuxCNC and Grbl that ISG's programs do not contain, because they are refused there or mean
/// mirroring.
const FOREIGN: &[u32] = &[200, 210, 280, 281, 300, 301, 382, 383, 384, 385, 430, 431, 490, 901, 911, 921];

/// Number of blocks with S and axes from which on a text counts as a laser program.
const ROWS: usize = 3;

impl Found {
    fn of(program: &Source) -> Self {
        let mut found = Self::default();
        let mut at_feed = false;
        for (index, line) in program.lines().enumerate() {
            found.comments(line, index + 1);
            let line = Line::new(line, index + 1);
            found.marks(&line);
            if line.words.iter().any(|word| word.letter == 'G' && word.tenths < 40) {
                at_feed = line.has('G', 10);
            }
            let axes = line.words.iter().find(|word| matches!(word.letter, 'X' | 'Y'));
            if let (true, Some(_), Some(speed)) = (at_feed, axes, line.first('S')) {
                found.rows.push(line.mark("S in a G1 block", speed));
            }
        }
        found
    }

    fn decide(mut self) -> Shown {
        let others =
            [&self.linuxcnc, &self.grbl, &self.fanuc, &self.printer].into_iter().any(Option::is_some);
        let perhaps = self.perhaps_isg.is_some() && !self.foreign && !others;
        if self.isg.is_some() || perhaps {
            return Shown::Isg;
        }
        // M100 and higher numbers call functions of the machine in LinuxCNC's programs.
        let called = self.linuxcnc.is_some();
        if let Some(mark) = self.printer.filter(|mark| !called || !mark.word.starts_with("M1")) {
            return Shown::Printer(mark);
        }
        if let Some(mark) = self.numbers.program {
            match self.numbers.centre {
                Some(centre) => self.linuxcnc = self.linuxcnc.or(Some(centre)),
                None => self.fanuc = self.fanuc.or(Some(mark)),
            }
        }
        // Together with a word that ISG does not have, the word is Fanuc's.
        let foreign = self.full.is_some() || self.either.is_some();
        if let Some(mark) = self.fanuc.or(self.dwell.filter(|_| foreign)) {
            // If the two dialects would move along different paths, the program is refused.
            let other = self.linuxcnc.or(self.numbers.whole).map(|other| (Dialect::LinuxCnc, other));
            let other = other.or(self.grbl.map(|other| (Dialect::Grbl, other)));
            return match other {
                Some(other) => Shown::Two([(Dialect::Fanuc, mark), other]),
                None => Shown::Is(Dialect::Fanuc, mark),
            };
        }
        if let Some(mark) = self.linuxcnc {
            return match self.grbl {
                Some(grbl) if grbl.word.starts_with('$') => {
                    Shown::Two([(Dialect::LinuxCnc, mark), (Dialect::Grbl, grbl)])
                }
                _ => Shown::Is(Dialect::LinuxCnc, mark),
            };
        }
        if let Some(mark) = self.grbl {
            return Shown::Is(Dialect::Grbl, mark);
        }
        if let Some(mark) = self.full {
            return Shown::Is(Dialect::LinuxCnc, mark);
        }
        match self.either {
            Some(_) if self.end.behind.is_some() => {
                let meaning = "behind M2 or M30 is not read by LinuxCNC, and carried out by Grbl";
                self.end.behind.map_or(Shown::Isg, |mark| Shown::Unclear(mark, meaning))
            }
            Some(mark) if self.end.is_shown => Shown::Is(Dialect::LinuxCnc, mark),
            Some(mark) => Shown::Is(Dialect::Grbl, mark),
            None if !self.end.is_shown && self.rows.len() >= ROWS => {
                Shown::Is(Dialect::Grbl, self.rows.swap_remove(0))
            }
            None => match self.traps.into_iter().find(|(.., is_path)| *is_path) {
                Some((mark, meaning, _)) => Shown::Unclear(mark, meaning),
                None => Shown::Isg,
            },
        }
    }

    /// Post-processors write their names into comments.
    fn comments(&mut self, line: &[u8], number: usize) {
        let text = String::from_utf8_lossy(line).to_lowercase();
        let Some(at) = text.find(['(', ';']) else { return };
        let comment = &text[at..];
        let fanuc = if comment.contains("haas") { "haas" } else { "fanuc" };
        let named = [("grbl", &mut self.grbl), ("linuxcnc", &mut self.linuxcnc), (fanuc, &mut self.fanuc)];
        for (name, slot) in named {
            if comment.contains(name) && slot.is_none() {
                let word = format!("\"{name}\" in a comment");
                *slot = Some(Mark { word, line: number, column: 1, length: 1 });
            }
        }
        if let (Some(name), None) = (SENDERS.iter().find(|name| comment.contains(**name)), &self.either) {
            let word = format!("\"{name}\" in a comment");
            self.either = Some(Mark { word, line: number, column: 1, length: 1 });
            self.foreign = true;
        }
        if comment.replace(' ', "").starts_with("(msg,") && self.either.is_none() {
            self.either = Some(Mark { word: "(MSG, …)".into(), line: number, column: 1, length: 1 });
        }
    }

    fn marks(&mut self, line: &Line) {
        let plain = line.text.as_str();
        if self.end.behind.is_none()
            && self.end.is_over
            && let Some(word) = line.words.iter().find(|word| !word.ends_again())
        {
            self.end.behind = Some(line.mark("a word", *word));
        }
        self.end.is_over |= line.has('M', 20) || line.has('M', 300);
        self.end.is_shown |= line.has('M', 20) || line.has('M', 300) || plain == "%";
        let slot = |slot: &mut Option<Mark>, mark: Option<Mark>| *slot = slot.take().or(mark);
        for (mark, meaning) in line.traps() {
            let is_path = line.is_path(&mark);
            let is_known = |known: &(Mark, &str, bool)| known.0.word == mark.word && known.2 >= is_path;
            if !self.traps.iter().any(is_known) {
                self.traps.push((mark, meaning, is_path));
            }
        }
        slot(&mut self.isg, line.isg());
        slot(&mut self.perhaps_isg, line.any('G', &[700, 710]).or_else(|| line.any('M', &[170])));
        slot(&mut self.numbers.program, line.numbered());
        slot(&mut self.numbers.centre, line.any('G', &[901, 911]));
        self.foreign |= line.any('G', FOREIGN).is_some();
        slot(&mut self.linuxcnc, line.linuxcnc());
        slot(&mut self.grbl, line.grbl());
        slot(&mut self.fanuc, line.fanuc());
        slot(&mut self.dwell, line.dwell());
        slot(&mut self.full, line.full());
        slot(&mut self.numbers.whole, line.whole());
        slot(&mut self.either, line.either());
        slot(&mut self.printer, line.printer());
    }
}

/// A letter with a number.
#[derive(Clone, Copy)]
struct Word {
    letter: char,
    /// The number times ten, rounded down; words without a number have `u32::MAX`.
    tenths: u32,
    /// The number has a decimal point.
    point: bool,
    at: usize,
    length: usize,
}

impl Word {
    /// A line number, M2 or M30: behind M2 or M30 without effect in all dialects.
    fn ends_again(&self) -> bool {
        self.letter == 'N' || self.letter == 'M' && matches!(self.tenths, 20 | 300)
    }
}

/// A line without comments and blanks, in upper case.
struct Line {
    text: String,
    words: Vec<Word>,
    number: usize,
    /// The line begins with `#` and a blank: text, no statement of ISG.
    is_remark: bool,
    /// Column of the first exponent of a number, from 0.
    exponent: Option<usize>,
}

/// Column of the first exponent, as in `1e-5` and `2E+01`, from 0. Printers write E behind a blank or in upper case
/// without a sign.
fn exponent(line: &[u8]) -> Option<usize> {
    let code = line.iter().position(|byte| matches!(byte, b'(' | b';')).map_or(line, |end| &line[..end]);
    (1..code.len()).find(|&at| {
        let behind = code.get(at + 1).copied().unwrap_or_default();
        let digit = |byte: u8| byte.is_ascii_digit() || byte == b'.';
        match code[at] {
            b'e' | b'E' if !digit(code[at - 1]) => false,
            b'e' => behind.is_ascii_digit() || matches!(behind, b'-' | b'+'),
            b'E' => matches!(behind, b'-' | b'+'),
            _ => false,
        }
    })
}

impl Line {
    fn new(line: &[u8], number: usize) -> Self {
        let (mut text, mut places, mut comment) = (String::new(), Vec::new(), false);
        let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line);
        for (at, byte) in line.iter().enumerate() {
            match byte {
                b';' if !comment => break,
                b'(' => comment = true,
                b')' => comment = false,
                b' ' | b'\t' | b'\r' => {}
                _ if comment => {}
                _ => {
                    text.push(char::from(byte.to_ascii_uppercase()));
                    places.push(at);
                }
            }
        }
        let is_remark = text.starts_with('#')
            && line.iter().position(|byte| *byte == b'#').and_then(|at| line.get(at + 1)) == Some(&b' ');
        let mut words = Vec::new();
        let letters: Vec<char> = text.chars().collect();
        let mut at = 0;
        while at < letters.len() {
            let letter = letters[at];
            // The letters of #<name> and O<name> are no words.
            let is_named = letters.get(at + 1) == Some(&'<') && matches!(letter, '#' | 'O');
            if let Some(end) = letters[at..].iter().position(|&letter| letter == '>').filter(|_| is_named) {
                at += end + 1;
                continue;
            }
            let end = (at + 1..letters.len())
                .find(|&k| !matches!(letters[k], '0'..='9' | '.' | '+' | '-'))
                .unwrap_or(letters.len());
            if letter.is_ascii_alphabetic() {
                let number: String = letters[at + 1..end].iter().collect();
                let tenths = number.parse::<f64>().map_or(u32::MAX, |value| (value * 10.0).round() as u32);
                let point = number.contains('.');
                words.push(Word { letter, tenths, point, at: places[at], length: end - at });
            }
            at = end;
        }
        Self { text, words, number, is_remark, exponent: exponent(line) }
    }

    fn has(&self, letter: char, tenths: u32) -> bool {
        self.words.iter().any(|word| word.letter == letter && word.tenths == tenths)
    }

    fn first(&self, letter: char) -> Option<Word> {
        self.words.iter().copied().find(|word| word.letter == letter)
    }

    fn mark(&self, word: impl Into<String>, found: Word) -> Mark {
        Mark { word: word.into(), line: self.number, column: found.at + 1, length: found.length }
    }

    /// The first of these G or M words in the line.
    fn any(&self, letter: char, codes: &[u32]) -> Option<Mark> {
        let word = *self.words.iter().find(|word| word.letter == letter && codes.contains(&word.tenths))?;
        let (whole, tenth) = (word.tenths / 10, word.tenths % 10);
        let point = if tenth > 0 { format!(".{tenth}") } else { String::new() };
        Some(self.mark(format!("{letter}{whole}{point}"), word))
    }

    fn at_start(&self, word: &str) -> Mark {
        Mark { word: word.to_owned(), line: self.number, column: 1, length: 1 }
    }

    /// Words that have another effect in ISG's language than in LinuxCNC and Grbl, with this effect.
    fn traps(&self) -> Vec<(Mark, &'static str)> {
        const G: [(u32, &str); 4] = [
            (930, "takes F as a time in ISG; with --dialect linuxcnc or grbl F is 1/min"),
            (530, "stays in force in ISG, until G54 to G59; with --dialect linuxcnc it holds in its block"),
            (610, "rounds corners in ISG; with --dialect linuxcnc or grbl it is exact path"),
            (920, "adds an offset in ISG; with --dialect linuxcnc or grbl this place gets the coordinates"),
        ];
        let mut traps = Vec::new();
        for (code, meaning) in G {
            traps.extend(self.any('G', &[code]).map(|mark| (mark, meaning)));
        }
        let moves = self.words.iter().any(|word| matches!(word.letter, 'X' | 'Y' | 'Z'));
        let switch = self.any('M', &[30, 40, 50, 80, 90]).filter(|_| moves);
        let order = "beside axes comes as m_synch says in ISG; in LinuxCNC and Grbl before the motion";
        traps.extend(switch.map(|mark| (mark, order)));
        let end = "ends a subroutine in ISG; LinuxCNC and Grbl do not know it";
        traps.extend(self.any('M', &[170, 290]).map(|mark| (mark, end)));
        let plain = "is a plain function in ISG; LinuxCNC and Grbl do more by it: --dialect chooses them";
        let codes = [190, 480, 490, 500, 510, 520, 530, 600, 620, 630, 640, 650, 660, 670, 680, 980, 990];
        traps.extend(codes.iter().filter_map(|code| self.any('M', &[*code])).map(|mark| (mark, plain)));
        traps
    }

    /// Words that only ISG has.
    fn isg(&self) -> Option<Mark> {
        const HAAS: [u32; 3] = [1030, 1540, 1870];
        let text = self.text.as_str();
        let body = text.trim_start_matches('N').trim_start_matches(|c: char| c.is_ascii_digit() || c == ':');
        let named = |lead: char, of: fn(char) -> bool| {
            body.strip_prefix(lead).and_then(|rest| rest.chars().next()).is_some_and(of)
        };
        let statement = named('#', |c| c.is_ascii_alphabetic()) && !self.is_remark
            || named('%', |c| c.is_ascii_alphanumeric())
            || named('L', |c| !matches!(c, '0'..='9' | '.' | '+' | '-'))
            || ["$FOR", "$IF", "$WHILE", "$DO", "$REPEAT", "$SWITCH", "$GOTO"]
                .iter()
                .any(|s| body.starts_with(s))
            || ["V.", "[OSC", "[INDP", "\\"].iter().any(|part| text.contains(part));
        if statement {
            return Some(self.at_start("a statement of ISG"));
        }
        let assigns = text.split('P').skip(1).any(|rest| {
            let behind = rest.trim_start_matches(|c: char| c.is_ascii_digit());
            behind.len() < rest.len() && behind.starts_with('=')
        });
        let high = self.words.iter().find(|word| {
            word.letter == 'G' && (1000..10_000).contains(&word.tenths) && !HAAS.contains(&word.tenths)
        });
        let own = high.map(|word| self.mark("a G word of ISG", *word));
        let assigned = assigns.then(|| self.at_start("a P parameter"));
        own.or(assigned).or_else(|| self.any('G', &[600]))
    }

    /// Words that LinuxCNC has, but not Grbl.
    fn linuxcnc(&self) -> Option<Mark> {
        const CODES: &[u32] = &[52, 331, 411, 421, 591, 592, 593, 611, 901, 922, 923];
        let text = self.text.as_str();
        let body = text.trim_start_matches('N').trim_start_matches(|c: char| c.is_ascii_digit());
        if text.contains("#<") || text.contains("#[") || body.starts_with('#') && body.contains('=') {
            return Some(self.at_start("a # parameter"));
        }
        let keys = ["SUB", "CALL", "WHILE", "IF", "REPEAT", "DO", "ENDSUB", "RETURN"];
        if body.starts_with('O') && keys.iter().any(|key| text.contains(key)) {
            return Some(self.at_start("an O word"));
        }
        let blend = self.any('G', &[640]).filter(|_| self.first('P').is_some());
        let outputs = self
            .any('M', &[620, 630, 640, 650, 660, 670, 680])
            .filter(|_| ['P', 'E'].iter().any(|&letter| self.first(letter).is_some()));
        blend.or_else(|| self.any('G', CODES)).or(outputs)
    }

    /// Words that LinuxCNC and Fanuc have, but not Grbl.
    fn full(&self) -> Option<Mark> {
        const CODES: &[u32] =
            &[410, 420, 520, 730, 740, 760, 810, 820, 830, 840, 850, 860, 870, 880, 890, 960, 980, 990];
        let length = self.any('G', &[430]).filter(|_| self.first('H').is_some());
        length.or_else(|| self.any('G', CODES))
    }

    /// Words that only Fanuc has.
    fn fanuc(&self) -> Option<Mark> {
        let far = self
            .any('G', &[541, 501, 511])
            .or_else(|| self.any('M', &[290]).filter(|_| self.first('S').is_some()));
        let call = self.any('M', &[980]).filter(|_| self.first('P').is_some_and(|p| p.tenths >= 100_000));
        let mode = self.any('G', &[51]).filter(|_| self.first('Q').is_some());
        far.or(call).or(mode)
    }

    /// A line with only a program number.
    fn numbered(&self) -> Option<Mark> {
        let body = self.body();
        let digits = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
        body.strip_prefix(['O', ':']).is_some_and(digits).then(|| self.at_start(body))
    }

    /// Whether the word at the mark means another path in ISG's language.
    fn is_path(&self, mark: &Mark) -> bool {
        let axes = self.words.iter().any(|word| "XYZABCUVW".contains(word.letter));
        match mark.word.as_str() {
            "G53" | "G92" => axes,
            "G61" | "G93" => true,
            "M98" => self.first('P').is_some(),
            _ => false,
        }
    }

    /// A dwell that neither LinuxCNC nor Grbl has.
    fn dwell(&self) -> Option<Mark> {
        self.any('G', &[40])
            .filter(|_| self.first('P').is_none() && (self.first('X').is_some() || self.first('U').is_some()))
    }

    /// A length without a decimal point, other than 0.
    fn whole(&self) -> Option<Mark> {
        if self.any('G', &[40, 100]).is_some() {
            return None;
        }
        let word = self.words.iter().find(|word| {
            matches!(word.letter, 'X' | 'Y' | 'Z' | 'I' | 'J' | 'R')
                && !word.point
                && !matches!(word.tenths, 0 | u32::MAX)
        })?;
        Some(self.mark(format!("{} without a decimal point", word.letter), *word))
    }

    /// The words without the line number.
    fn body(&self) -> &str {
        let text = self.text.trim_start_matches('/');
        match text.strip_prefix('N') {
            Some(rest) => rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.'),
            None => text,
        }
    }

    /// Words that only Grbl has.
    fn grbl(&self) -> Option<Mark> {
        let commands = ["$H", "$X", "$J=", "$$", "$RST"];
        let alone = ["$I", "$G", "$N", "$#", "?"];
        let setting = self.text.strip_prefix('$').and_then(|rest| rest.split_once('='));
        if setting.is_some_and(|(number, _)| number.chars().all(|c| c.is_ascii_digit()) && !number.is_empty())
        {
            return Some(self.at_start("a setting $n="));
        }
        let found = commands.iter().find(|command| self.text.starts_with(*command));
        found.or(alone.iter().find(|command| self.text == **command)).map(|command| self.at_start(command))
    }

    /// Words of LinuxCNC and Grbl that ISG does not have, or that have another meaning there.
    fn either(&self) -> Option<Mark> {
        const CODES: &[u32] =
            &[200, 210, 280, 281, 300, 301, 382, 383, 384, 385, 400, 430, 431, 490, 640, 800, 911, 921];
        let store = self.any('G', &[100]).filter(|_| self.first('L').is_some());
        let dwell = self.any('G', &[40]).filter(|_| self.first('P').is_some());
        self.any('G', CODES).or(store).or(dwell).or_else(|| self.centre())
    }

    /// I, J and K in one block: ISG's arcs have the two of their plane.
    fn centre(&self) -> Option<Mark> {
        let all = ['I', 'J', 'K'].iter().all(|letter| self.first(*letter).is_some());
        self.first('K').filter(|_| all).map(|word| self.mark("K beside I and J", word))
    }

    /// Words of 3-D printers.
    fn printer(&self) -> Option<Mark> {
        const CODES: &[u32] = &[820, 830, 840, 1040, 1060, 1070, 1090, 1400, 1900];
        let feeds = self.first('E').filter(|word| {
            word.tenths != u32::MAX && self.exponent != Some(word.at) && self.any('G', &[0, 10]).is_some()
        });
        self.any('M', CODES).or(feeds.map(|word| self.mark("E", word)))
    }
}

/// The text of a word: `G38.2`.
fn written(word: &WordEntry) -> String {
    let (whole, tenth) = (word.tenths / 10, word.tenths % 10);
    format!("{}{whole}{}", word.letter, if tenth > 0 { format!(".{tenth}") } else { String::new() })
}

/// The dialects that have a table.
const TABLES: [Dialect; 3] = [Dialect::LinuxCnc, Dialect::Grbl, Dialect::Fanuc];

/// The words of a dialect, or of all that have a table.
pub fn list(choice: Option<Choice>) -> String {
    let wanted = choice.and_then(Choice::dialect);
    let mut text = String::new();
    if wanted == Some(Dialect::Isg) {
        return "The words of ISG's language stand in docs/conformance.md.\n".into();
    }
    let heads = |is_in: &dyn Fn(Dialect) -> bool| -> String {
        if wanted.is_some() {
            return String::new();
        }
        TABLES.iter().fold(String::new(), |mut head, dialect| {
            let name = if is_in(*dialect) { dialect.name() } else { "" };
            let _ = write!(head, "{name:<10}");
            head
        })
    };
    for word in WORDS.iter().filter(|word| wanted.is_none_or(|dialect| word.is_in(dialect))) {
        let built = match word.is_built() {
            Ok(()) => String::new(),
            Err(hint) => format!(" - not available; expected {hint}"),
        };
        let head = heads(&|dialect| word.is_in(dialect));
        let _ = writeln!(text, "{:<7}{head}{}{built}", written(word), word.text);
    }
    for address in ADDRESSES.iter().filter(|address| wanted.is_none_or(|dialect| address.is_in(dialect))) {
        let head = heads(&|dialect| address.is_in(dialect));
        let _ = writeln!(text, "{:<7}{head}{}", address.letter, address.text);
    }
    text
}

#[cfg(test)]
#[path = "../../../host-tests/tests/language/dialects/corpus.rs"]
mod corpus;

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str) -> Shown {
        Found::of(&Source { name: "test.nc".into(), text: text.as_bytes().to_vec() }).decide()
    }

    fn dialect(text: &str) -> Option<Dialect> {
        match shown(text) {
            Shown::Isg => Some(Dialect::Isg),
            Shown::Is(dialect, _) => Some(dialect),
            Shown::Printer(_) | Shown::Two(_) | Shown::Unclear(..) => None,
        }
    }

    #[test]
    fn each_program_shows_its_dialect_in_any_look() {
        for (name, wanted, text) in corpus::CORPUS {
            let looks = [
                (*text).to_owned(),
                text.to_lowercase(),
                text.replace('\n', "\r\n"),
                text.trim_end().to_owned(),
                format!("\u{feff}{text}"),
                text.lines().map(|line| if line.contains('(') { line.to_owned() } else { line.replace(' ', "") } + "\n").collect(),
            ];
            for text in looks {
                assert_eq!(dialect(&text).map(Dialect::name), Some(*wanted), "{name}\n{text}");
            }
        }
        assert!(corpus::REFUSED.len() > 50);
    }

    #[test]
    fn programs_of_isg_stay_so() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../programs");
        let mut count = 0;
        for entry in std::fs::read_dir(folder).expect("programs") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|extension| extension == "nc") {
                let text = String::from_utf8_lossy(&std::fs::read(&path).expect("a text")).into_owned();
                assert_eq!(dialect(&text), Some(Dialect::Isg), "{}", path.display());
                count += 1;
            }
        }
        assert!(count > 20);
        for text in [
            "",
            "G00 X1\nG01 X2 F100\nM30",
            "%main\nG20\n#HSC ON\nM30",
            "P1=5\nG04 P1\nM30",
            "N10 $IF P1==2\nG21",
            "G261 G40",
            "G70 X1 F100\nG80",
            "LL name\nG20",
            "(comment with G20 and G64 P1)\nG0 X1",
            "G53\nG92\nM19\nG1 X1 F1",
            "G71 G40\nG80\nM17",
            "M3 S100\nG1 X1 F100\nG1 X2\nM30",
            "X[OSC ON]\nG21",
        ] {
            assert_eq!(dialect(text), Some(Dialect::Isg), "{text}");
        }
    }

    #[test]
    fn the_reason_names_a_word_and_its_line() {
        let Shown::Is(Dialect::LinuxCnc, mark) = shown("(head)\nG0 X1\nN5 G90 g6 4 p0.01\nM2\n") else {
            panic!("LinuxCNC")
        };
        assert_eq!((mark.word.as_str(), mark.line, mark.column), ("G64", 3, 8));
        let Shown::Is(Dialect::Grbl, mark) = shown("G0 X1\nG21\n") else { panic!("Grbl") };
        assert_eq!((mark.word.as_str(), mark.line, mark.column), ("G21", 2, 1));
        for printer in ["G28\nG21\nM82\nG92 E0\nG1 X1 E5 F100", "M104 S200\nG21", "M107\nG28"] {
            assert!(matches!(shown(printer), Shown::Printer(_)), "{printer}");
        }
        assert_eq!(dialect("#<x>=1\nG0 X#<x>\nM2"), Some(Dialect::LinuxCnc));
        assert_eq!(dialect("o100 sub\nG21\no100 endsub\nM2"), Some(Dialect::LinuxCnc));
        assert_eq!(dialect("#100=5 (p=5)\nG1 X#100 F#101\nM2"), Some(Dialect::LinuxCnc));
        assert_eq!(dialect("$H\nG21\nM2"), Some(Dialect::Grbl));
        assert_eq!(dialect("(post: grbl)\nG21\nM2"), Some(Dialect::Grbl));
        assert_eq!(dialect("(MSG, hello)\nG0 X1\nM2"), Some(Dialect::LinuxCnc));
    }

    #[test]
    fn a_text_of_two_dialects_is_asked_about() {
        for (text, one, other) in [
            ("%\nO0001\nG21\nG0 X1.5\nG64 P0.1\nM30", "fanuc", "linuxcnc"),
            ("O0001\nG21\nG0 X10 Y5.\nM30", "fanuc", "linuxcnc"),
            ("O0001 (grbl)\nG21\nG0 X1.\nM30", "fanuc", "grbl"),
            ("$H\nG21\nG61.1\nG0 X1", "linuxcnc", "grbl"),
        ] {
            let Shown::Two([(first, _), (second, _)]) = shown(text) else {
                panic!("{text}: {:?}", shown(text))
            };
            assert_eq!((first.name(), second.name()), (one, other), "{text}");
        }
        for text in ["%\nO1234\nG21\nG0 X0 Y1.\nM30\n%", ":10\nG20\nG0 X.5\nM30", "G21\nG4 X1.5\nM30"] {
            assert_eq!(dialect(text), Some(Dialect::Fanuc), "{text}");
        }
    }

    #[test]
    fn names_remarks_and_exponents_are_no_words() {
        for (text, wanted) in [
            ("o<g881> sub\n(debug, x)\nG1 X1 F5\no<g881> endsub\nM2", Some(Dialect::LinuxCnc)),
            ("#<x104> = 1\nG21\nG0 X#<x104>\nM2", Some(Dialect::LinuxCnc)),
            ("# square, 4 mm\nG21\nM4 S0\nG0 X1", Some(Dialect::Grbl)),
            ("#HSC ON\nG21", Some(Dialect::Isg)),
            ("$100=250\n$32=1", Some(Dialect::Grbl)),
            ("G21\nG1 X1e-5 F100\nM2", Some(Dialect::LinuxCnc)),
            ("G21\nG1 X1.5E-05 F100", Some(Dialect::Grbl)),
            ("G21\nG1 X1E5 F100", None),
            ("G21\nG1 X1 E-5 F100", None),
        ] {
            assert_eq!(dialect(text), wanted, "{text}");
        }
    }

    #[test]
    fn words_that_others_have_too_do_not_hide_them() {
        for (text, wanted) in [
            ("N10G00G21G17G90G40G49G80\nN20G71G91.1\nM30", Some(Dialect::LinuxCnc)),
            ("G17 G71 G49\nG0 X1\nM30", Some(Dialect::LinuxCnc)),
            ("M17\nG21\nG1 X1 F5", Some(Dialect::Grbl)),
            ("M17\nM104 S5", None),
            ("%\nO1001\nG20 G91.1\nG0 X1\nM30", Some(Dialect::LinuxCnc)),
            ("(Haas)\nO1001\nG20 G91.1\nG0 X1.\nM30", None),
            ("G64 P0.1\nM190 P1\nM2", Some(Dialect::LinuxCnc)),
            ("G21\nM190 S60", None),
            ("G90\nG0 X1\nG2 X3 I1 J0 K0 F5\nM2", Some(Dialect::LinuxCnc)),
            ("G21\nG0 X1\nM30\nN5 M30\n%", Some(Dialect::LinuxCnc)),
            ("(Created by Estlcam)\nG92 X0\nG1 X1 F5\nM30", Some(Dialect::LinuxCnc)),
            ("$G\nG0 X1", Some(Dialect::Grbl)),
        ] {
            assert_eq!(dialect(text), wanted, "{text}");
        }
    }

    #[test]
    fn a_word_that_means_another_path_is_asked_about_where_nothing_shows_the_dialect() {
        for (text, word, line) in [
            ("G0 X1\nG92 X0\nG1 X1 F5", "G92", 2),
            ("G53 G0 Z0\nX1", "G53", 1),
            ("G90\nG61\nG1 X1 F5\nM30", "G61", 2),
            ("M98 P100\nM30\nO100 G1", "M98", 1),
            ("G93\nG1 X1 F2", "G93", 1),
        ] {
            let Shown::Unclear(mark, meaning) = shown(text) else { panic!("{text}: {:?}", shown(text)) };
            assert_eq!((mark.word.as_str(), mark.line), (word, line), "{text}: {meaning}");
        }
        let Shown::Unclear(mark, _) = shown("G21\nG0 X1\nM30\n(next)\n%\nG0 X2") else {
            panic!("behind M30")
        };
        assert_eq!(mark.line, 6);
        for text in [
            "%m\nG92 X0\nM30",
            "G64 P1\nM30\nG0 X1",
            "O1\nG21\nM30\nO2\nM99",
            "G21\nG92 X0",
            "G53\nG0 X1",
            "G92 X1\nM2\n#HSC ON",
        ] {
            assert!(!matches!(shown(text), Shown::Unclear(..)), "{text}");
        }
    }

    #[test]
    fn the_list_of_words_is_that_of_the_decoder() {
        let all = list(None);
        assert_eq!(all.lines().count(), WORDS.len() + ADDRESSES.len());
        let grbl = list(Some(Choice::Grbl));
        assert!(grbl.contains("G20    inch") && !grbl.contains("G61.1"), "{grbl}");
        assert!(list(Some(Choice::Linuxcnc)).contains("G5.2   NURBS - not available"));
        assert!(all.contains("G61.1  linuxcnc                      exact stop"), "{all}");
        let fanuc = list(Some(Choice::Fanuc));
        assert!(fanuc.contains("G61    exact stop") && !fanuc.contains("G38.2"), "{fanuc}");
    }
}
