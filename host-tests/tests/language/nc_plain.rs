//! Blocks of N, G00, G01, F and axes with plain decimals are decoded in one pass, with the same result as
//! word by word. An additional G94 changes nothing, but makes the decoder read the block word by word.
use crate::nc_decode::{Random, commands, decode_with, motions, setup};
use glidepath::machine::AxisName;
use glidepath::nc::{Command, Setup};

/// What the decoder says about `before` and a last line, and about the same with `behind` at the end of that
/// line.
fn both_ways(setup: Setup<5>, before: &str, line: &str, behind: &str) {
    let plain = decode_with(setup, format!("{before}{line}\n").as_bytes(), 1000);
    let long = decode_with(setup, format!("{before}{line}{behind}\n").as_bytes(), 1000);
    assert_eq!((&plain.0, &plain.1, &plain.2), (&long.0, &long.1, &long.2), "{before}{line:?}");
}

/// A number of up to ten digits.
fn digits_of(random: &mut Random) -> u64 {
    let most = 10_u64.pow(random.below(11) as u32);
    random.below(most)
}

/// Any line of plain words, most of them right.
fn line(random: &mut Random) -> String {
    let mut text = String::new();
    if random.below(3) > 0 {
        text += &format!("N{} ", digits_of(random));
    }
    for _ in 0..random.below(6) {
        let digits = digits_of(random);
        let places = random.below(11) as usize;
        let number = match random.below(12) {
            0 => format!("{digits}."),
            1 => format!(".{digits}"),
            2 => format!("{digits}"),
            3 => format!("0{digits}"),
            _ => {
                let digits = format!("{digits:0>width$}", width = places + 1);
                let (whole, fraction) = digits.split_at(digits.len() - places);
                format!("{whole}.{fraction}")
            }
        };
        let sign = ["", "", "-", "-", "+", "--", "- "][random.below(7) as usize];
        let letter = ["X", "Y", "Z", "A", "C", "x", "F", "G", "N", "I", "B"][random.below(11) as usize];
        let gap = ["", "", "", " ", "="][random.below(5) as usize];
        text += &match letter {
            "G" => format!("G{gap}{}", ["0", "00", "1", "01", "1.", "001", "2"][random.below(7) as usize]),
            "F" | "N" => format!("{letter}{gap}{number}"),
            _ => format!("{letter}{gap}{sign}{number}"),
        };
        text += ["", " ", " ", " ", "  ", "\t"][random.below(6) as usize];
    }
    text
}

/// NC-004.
#[test]
fn a_plain_block_is_what_its_words_are() {
    let states = [
        "",
        "F100\n",
        "G00\n",
        "F7 G91 X1.5 Y-2\n",
        "G70 F3\n",
        "G92 X10.1 C-3\nF1\n",
        "G55 F9\n",
        "G360 F1\n",
        "F5 G02 R3\n",
        "X3 F100\n",
    ];
    let mut random = Random(0x51ab_77f0_0d15_ea5e);
    let mut setup = setup();
    setup.zero_offsets[1] = [1, 2, -3, 4, 5].map(|tenth| glidepath::quantity::Position::from_num(tenth) / 10);
    let mut accepted = 0;
    for _ in 0..60_000 {
        setup.feedrate_factor_milli = [100_000, 100_000, 100, 254_000][random.below(4) as usize];
        let before = states[random.below(states.len() as u64) as usize];
        let line = line(&mut random);
        both_ways(setup, before, &line, " G94");
        accepted += usize::from(decode_with(setup, format!("{before}{line}\n").as_bytes(), 1000).2.is_none());
    }
    assert!(accepted > 10_000, "only {accepted} lines were right: the others show little");
}

#[test]
fn axes_of_longer_names_are_no_plain_words() {
    let mut setup = setup();
    setup.names[1] = AxisName::new("X1").unwrap();
    setup.names[3] = AxisName::new("YY").unwrap();
    for line in ["G0 X5", "G0 X1=5", "G0 X1 5", "G0 X15", "G0 YY=3 Z1", "G0 Y3", "G0 Z1 X2 C3"] {
        both_ways(setup, "", line, " G94");
    }
}

#[test]
fn what_follows_a_number_belongs_to_it() {
    for line in [
        "X1 F10 Y2 MOD 2",
        "F10 X5-3",
        "F10 X5 -3",
        "F10 X2*3",
        "F10 X5E3",
        "F10 X1.2.3",
        "N5: X1 F3",
        "F10 X3 XOR 2",
    ] {
        both_ways(setup(), "", line, " G94");
    }
    assert_eq!(motions("F10 X5 -3")[0].target[0], 2);
}

#[test]
fn a_warning_about_the_line_comes_before_its_motion() {
    let (out, warnings, error, _) = decode_with(setup(), b"F10 X5 (left open\nX6\n", 100);
    assert_eq!((out.len(), warnings.len(), error), (2, 1, None));
    let mut memory = glidepath::nc::DecoderMemory::new();
    let mut decoder =
        glidepath::nc::Decoder::new(&mut memory, setup(), b"F10 X5 (left open\nX6\n".as_slice());
    let mut said = Vec::new();
    loop {
        match decoder.step().unwrap() {
            glidepath::nc::Step::Warning(_) => said.push("warning"),
            glidepath::nc::Step::Command(_) => said.push("motion"),
            glidepath::nc::Step::End => break,
            _ => {}
        }
    }
    assert_eq!(said, ["warning", "motion", "motion"]);
}

#[test]
fn places_are_those_of_the_words() {
    let places = |text| {
        let place = |c: Command<5>| {
            let p = c.place();
            (p.line, p.column, p.offset, p.length)
        };
        commands(text).into_iter().map(place).collect::<Vec<_>>()
    };
    assert_eq!(places("F10\n  N10 X12.5 Y3"), [(2, 7, 10, 5)]);
    assert_eq!(places("F10\nN10 G01 X12.5 Y3"), [(2, 5, 8, 3)]);
    assert_eq!(places("F10\nN10 X12.5 G01 Y3"), [(2, 5, 8, 5)]);
    assert_eq!(places("F10\nY3 (remark) X12.5"), [(2, 1, 4, 2)]);
    assert_eq!(places("F10\n(remark) Y3"), [(2, 10, 13, 2)]);
    assert_eq!(places("F10 \\\n Y3"), [(2, 2, 7, 2)]);
}
