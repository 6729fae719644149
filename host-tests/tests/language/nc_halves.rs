//! A line with more arithmetic than one step permits is decoded in several steps, with the same result.
use crate::nc_decode::{decode, error};

/// As much as two steps: its value is `value`.
fn heavy(value: &str) -> String {
    format!("[{value}+0*[ASIN[0.5]+ACOS[SIN[30]]+ATAN2[1,2]]]")
}

/// A program with each `{value}` as it is, and as something heavy.
fn both(text: &str) -> [String; 2] {
    let mut texts = [String::new(), String::new()];
    for (k, part) in text.split(['{', '}']).enumerate() {
        let is_value = k % 2 == 1;
        texts[0] += &if is_value { format!("[{part}]") } else { part.into() };
        texts[1] += &if is_value { heavy(part) } else { part.into() };
    }
    texts
}

/// What a program says, without the places.
fn said(text: &str) -> (Vec<String>, usize) {
    let decoded = decode(text);
    let mut lines: Vec<String> = decoded.commands.iter().map(|command| format!("{command:?}")).collect();
    lines.extend(decoded.warnings.iter().map(|warning| format!("{:?}", warning.kind)));
    lines.extend(decoded.error.iter().map(|error| format!("{:?} {}", error.kind, error.place.line)));
    for line in &mut lines {
        while let Some(from) = line.find("Place {") {
            let to = line[from..].find('}').map_or(line.len(), |length| from + length + 1);
            line.replace_range(from..to, "here");
        }
    }
    (lines, decoded.steps)
}

const PROGRAMS: &[&str] = &[
    "N{10} G01 F{1000} X={1} Y={2} Z={-3}",
    "F100 N10 X1",
    "F100\nP[{3}]={7} P4=P3+{1} P4=P4*2 P5=P4 P4=1 X=P4 Y=P5",
    "F100\nP5=1 P1=8\nPP5=3 P5={2} P2=6 PP5=P1+{1} X=P1 Y=P2 Z=P5",
    "F100\nG91 X={1}\nX={1} G90\nX={1} Y{2}",
    "G70 F{10}\nX={1} G71",
    "F100\n$IF {1} == {1}\nX1\n$ELSEIF {0}\nX2\n$ELSE\nX3\n$ENDIF",
    "F100\n$IF {1} > {2}\nX1\n$ELSEIF {1}\nX2\n$ELSE\nX3\n$ENDIF",
    "F100\n$FOR P[{5}] = {1}, {3}, {1}\nX=P5\n$ENDFOR\nX={9}",
    "F100\n$SWITCH P[{6}] = {2}\n$CASE {1}\nX1\n$CASE {2}\nX2\n$BREAK\n$DEFAULT\nX3\n$ENDSWITCH\nY=P6",
    "F100 P6=1\n$SWITCH P[{6}]+{1}\n$CASE {1}\nX1\n$CASE {2}\nX2\n$CASE {4}\nX4\n$ENDSWITCH\nX5",
    "F100 P1=0\n$REPEAT\nP1=P1+1 X=P1\n$UNTIL {3} < P1",
    "F100 P1=0\n$WHILE P1 < {3}\nP1=P1+1 X=P1\n$IF P1=={2}\n$CONTINUE\n$ENDIF\nY=P1\n$ENDWHILE",
    "F100 P1=0\n$DO\nP1=P1+1 X=P1\n$IF {2} == P1\n$CONTINUE\n$ENDIF\nY=P1\n$ENDDO {4} > P1",
    "F100\n$IF {1} $GOTO N{50}\nX1\nN50: X2\n$IF {0} $GOTO N{60}\nX3\nN60: X4",
    "G04 {2}\nG04 X={2}\nG92 X={1}\nG130 X={50}\nG131 {50}\n#TIME {3}",
    "F100 X1\nG02 X={2} Y={1} I={1} J={0}\nG03 X3 Y0 R={5}",
    "M={3} H={4} S={100} T={2} D={1}\nF100 X={1} M{5} G60",
    "#CONTOUR MODE ON [DEV PATH_DEV={0.125} TRACK_DEV={1}]\n#SET SLOPE PROFIL [P[{5}]]",
    "#VECTOR LIMIT ON [VEL={100} ACC={3000}] [DEC={2000}]\n#AKIMA STARTVECTOR X{1} Y={2}",
    "X[OSC ON 1ST_POS={1} 2ND_POS={2} FEED={100}]\nX[INDP_SYN G90 POS={5} FEED={100} G01]",
    "( never closed\nF100 X={1} ( nor this\nX2",
    "F100\nX={1} X={2}",
    "F100\nG04 {1} G92 X{1}",
    "F100\nG92 G04 1 X1",
    "P[{0}]=1",
    "F100 X=1/[{0}]",
    "F100 X={1} Y=SQRT[{-1}]",
    "F100 X={1}+P77",
    "F100 X={1}] Y2",
    "F100\nX={1} Q1",
];

#[test]
fn a_line_in_several_steps_says_the_same() {
    for text in PROGRAMS {
        let [light, heavy] = both(text);
        let ((ours, steps), (theirs, fewer)) = (said(&heavy), said(&light));
        assert_eq!(ours, theirs, "{heavy}");
        assert!(!theirs.is_empty(), "{text} says something");
        if text.contains('{') {
            assert!(steps > fewer, "{steps} steps instead of {fewer}: {heavy}");
        }
    }
}

#[test]
fn a_line_full_of_functions_takes_many_steps() {
    let sum = |term: &str, count: usize| format!("F100\nX={}", vec![term; count].join("+"));
    let steps = |text: &str| {
        let decoded = decode(text);
        assert!(decoded.error.is_none(), "{:?}", decoded.error);
        decoded.steps
    };
    assert!(steps(&sum("SIN[1]", 60)) > 12, "60 sines of 6500 instructions");
    assert!(steps(&sum("1.5", 120)) > 4, "120 operands of 1000 instructions");
    let nested = format!("F100\nX={}1{}", "SIN[".repeat(11), "]".repeat(11));
    assert!(steps(&nested) > 4, "11 sines inside of one another");
    let words: String = (0..60).map(|k| format!("P{k}9={k} ")).collect();
    assert!(steps(&format!("P1=0\n{words}")) > 4, "60 assignments");
}

#[test]
fn a_refusal_shows_its_word_wherever_the_step_began() {
    let [_, text] = both("F100\nY={1} X={2} X3");
    let refused = error(&text);
    let column = text.lines().nth(1).and_then(|line| line.find("X3")).map(|at| at as u32 + 1);
    assert_eq!((refused.place.line, Some(refused.place.column)), (2, column));
    assert_eq!(refused.found.as_str(), "X3");
}

#[test]
fn what_is_complete_is_not_worked_out_again() {
    // Each value takes two or three steps.
    for (text, values) in
        [("P[{3}]={7}", 2), ("$FOR P[{5}] = {9}, {3}, {1}\n$ENDFOR", 4), ("F1\nX{1} Y{1} Z{1}", 3)]
    {
        let [(light, fewer), (heavy, steps)] = both(text).map(|text| said(&text));
        assert_eq!(light, heavy);
        assert!(steps - fewer <= 3 * values, "{text}: {steps} steps instead of {fewer}");
    }
}
