//! Any bytes and any random words: the decoder ends with commands or one error, never with a panic, and every
//! call is bounded.
use crate::nc_decode::{Random, decode_text, decode_with, setup};
use glidepath::nc::{Decoder, DecoderMemory, Step};

const LIMIT: usize = 30_000;

/// A place must lie in the text and agree with its line and column.
fn check_place(text: &[u8], error: &glidepath::nc::NcError) {
    let p = error.place;
    let offset = p.offset as usize;
    assert!(offset <= text.len(), "{error:?}");
    let before = &text[..offset];
    // A line ends behind LF, CR LF, or CR alone.
    let ends = |at: usize| text[at] == b'\n' || text[at] == b'\r' && text.get(at + 1) != Some(&b'\n');
    let line = 1 + (0..offset).filter(|at| ends(*at)).count();
    let column = 1 + before.iter().enumerate().rev().take_while(|(at, _)| !ends(*at)).count();
    assert_eq!(
        (p.line as usize, p.column as usize),
        (line, column),
        "{error:?}\n{:?}",
        String::from_utf8_lossy(text)
    );
    assert!(!error.to_string().is_empty());
}

fn run(text: &[u8]) {
    let (_, _, error, _) = decode_with(setup(), text, LIMIT);
    if let Some(error) = error {
        check_place(text, &error);
    }
}

#[test]
fn random_bytes() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    for _ in 0..100_000 {
        let length = random.below(120) as usize;
        let text: Vec<u8> = (0..length).map(|_| random.next() as u8).collect();
        run(&text);
    }
}

const TOKENS: &[&str] = &[
    "%",
    "%L a",
    "%main",
    "N10",
    "N",
    "NP1",
    "G0",
    "G01",
    "G02",
    "G03",
    "G04",
    "G60",
    "G90",
    "G91",
    "G92",
    "G54",
    "G70",
    "G17",
    "G18",
    "G130",
    "G131",
    "G999",
    "X",
    "Y",
    "Z",
    "C",
    "B",
    "I",
    "J5",
    "K",
    "R",
    "F",
    "S",
    "M",
    "M30",
    "M17",
    "H",
    "T",
    "P1",
    "P2=",
    "PP1",
    "P[",
    "=",
    "1",
    "2.5",
    "-",
    "+",
    "*",
    "/",
    "**",
    "[",
    "]",
    ",",
    "SIN[",
    "COS[90]",
    "SQRT[",
    "MOD",
    "AND",
    "NOT",
    "==",
    "<",
    ">=",
    "1000000000000000000000",
    ".",
    "0.000000000000000000001",
    "(",
    ")",
    ";",
    "\\",
    "\n",
    "\n",
    "\n",
    "\n",
    " ",
    "$FOR P1=0,3,1",
    "$ENDFOR",
    "$IF P1<2",
    "$ELSEIF 1",
    "$ELSE",
    "$ENDIF",
    "$WHILE P1<3",
    "$ENDWHILE",
    "$DO",
    "$ENDDO 0",
    "$REPEAT",
    "$UNTIL 1",
    "$SWITCH P1",
    "$CASE 1",
    "$DEFAULT",
    "$ENDSWITCH",
    "$BREAK",
    "$CONTINUE",
    "$GOTO N10",
    "$GOTO [A]",
    "[A]",
    "N10:",
    "LL a",
    "L a",
    "#CONTOUR MODE",
    "[DEV PATH_DEV=",
    "[POS X1",
    "#HSC ON",
    "[SURFACE",
    "#SLOPE[TYPE=HSC]",
    "#FILTER",
    "#VECTOR LIMIT ON ALL",
    "#AKIMA STARTVECTOR",
    "#KIN ID[9]",
    "#PUT AX [Z]",
    "#RT WHILE",
    "#CONTOUR LOOKAHEAD LOG",
    "X[OSC ON",
    "1ST_POS=1",
    "2ND_POS=3",
    "FEED=100",
    "SHORT",
    "X[INDP_SYN",
    "#",
    "$",
    "\"M\"",
    "V.E.X",
    "/",
    "\u{e4}",
    "P1=1",
    "P2=P2+1",
];

#[test]
fn random_words() {
    let mut random = Random(0x0123_4567_89ab_cdef);
    for _ in 0..200_000 {
        let mut text = String::new();
        for _ in 0..random.below(40) {
            text.push_str(TOKENS[random.below(TOKENS.len() as u64) as usize]);
            if random.below(3) == 0 {
                text.push(' ');
            }
        }
        run(text.as_bytes());
    }
}

/// One byte of a good program changed, dropped, or the program cut there.
#[test]
fn damaged_programs() {
    let good = include_str!("../../programs/nc/everything.nc").as_bytes();
    assert_eq!(decode_with(setup(), good, LIMIT).2, None);
    let mut random = Random(42);
    for at in 0..good.len() {
        let mut text = good.to_vec();
        text[at] = random.next() as u8;
        run(&text);
        text.remove(at);
        run(&text);
        run(&good[..at]);
    }
}

/// A text that arrives in pieces, one whenever something is asked for that is not there.
struct Pieces<'a> {
    text: &'a [u8],
    random: Random,
    arrived: usize,
}

impl glidepath::nc::Text for Pieces<'_> {
    fn read(&mut self, _: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, glidepath::nc::TextError> {
        let mut there = self.text.get(offset as usize..self.arrived).unwrap_or(&[]);
        if there.is_empty() && self.arrived < self.text.len() {
            let most = if self.random.below(2) == 0 { 3 } else { 90 };
            self.arrived = self.text.len().min(self.arrived + 1 + self.random.below(most) as usize);
            return Err(glidepath::nc::TextError::NotYet);
        }
        there.read(0, 0, buffer)
    }
}

#[test]
fn text_that_arrives_in_pieces_is_the_same_program() {
    let everything = include_str!("../../programs/nc/everything.nc");
    let lines = everything.replace('\n', "\r\n");
    let marked = format!("\u{feff}{everything}");
    let wrong = format!("{everything}\r\nN1 X1 \\ Y");
    for text in [everything, &lines, &marked, &wrong, "N1 X1\r", "\r\n", ""] {
        let text = text.as_bytes();
        let (commands, warnings, error, _) = decode_with(setup(), text, LIMIT);
        for seed in host_tests::seeds::seeds(1..200, 20) {
            let pieces = Pieces { text, random: Random(seed), arrived: 0 };
            let (late, late_warnings, late_error, _) = decode_text(setup(), pieces, 10 * LIMIT);
            assert!(late == commands && late_warnings == warnings, "seed {seed}");
            assert_eq!(late_error.is_some(), error.is_some());
            assert_eq!(late_error.map(|e| (e.place, e.kind)), error.as_ref().map(|e| (e.place, e.kind)));
        }
    }
}

/// A text source that counts bytes: no call of `step` reads more than a slice.
struct Counting<'a>(&'a [u8], &'a std::cell::Cell<usize>);

impl glidepath::nc::Text for Counting<'_> {
    fn read(&mut self, file: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, glidepath::nc::TextError> {
        let mut source = self.0;
        let count = source.read(file, offset, buffer)?;
        self.1.set(self.1.get() + count);
        Ok(count)
    }
}

#[test]
fn every_step_reads_a_bounded_piece() {
    let mut text = String::from("(");
    text.push_str(&"long comment ".repeat(5000));
    text.push_str(")\n$IF 0\n");
    text.push_str(&"N1 X1 Y2 (not carried out)\n".repeat(5000));
    text.push_str("$ENDIF\nM30\n");
    let count = std::cell::Cell::new(0);
    let mut memory = DecoderMemory::<5>::new();
    let mut decoder = Decoder::new(&mut memory, setup(), Counting(text.as_bytes(), &count));
    loop {
        count.set(0);
        let step = decoder.step().unwrap();
        assert!(count.get() <= 256 + 64, "{} bytes in one step", count.get());
        if step == Step::End {
            break;
        }
    }
}
