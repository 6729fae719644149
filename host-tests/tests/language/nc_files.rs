//! Subroutines in other files, and the ways a file of the same program can be written.
use crate::nc_decode::{commands, setup};
use glidepath::nc::{
    Command, Decoder, DecoderMemory, Library, NcError, NcErrorKind, NcWarningKind, Place, Step, Text,
    TextError,
};

type Files<'a> = &'a [(&'a str, &'a str)];
/// N numbers of the motions, files of the warnings, refusal.
type Outcome = (Vec<u32>, Vec<(NcWarningKind, u16)>, Option<NcError>);

fn run(main: &str, files: Files) -> Outcome {
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, text)| (*name, text.as_bytes())).collect();
    run_text(Library { main: main.as_bytes(), files: &files })
}

fn run_text(text: impl Text) -> Outcome {
    let mut memory = DecoderMemory::<5>::new();
    let mut decoder = Decoder::new(&mut memory, setup(), text);
    let (mut motions, mut warnings) = (Vec::new(), Vec::new());
    for _ in 0..100_000 {
        match decoder.step() {
            Ok(Step::Working | Step::Late) => {}
            Ok(Step::Command(Command::Motion(motion))) => motions.push(motion.n),
            Ok(Step::Command(_)) => {}
            Ok(Step::Warning(warning)) => warnings.push((warning.kind, warning.place.file)),
            Ok(Step::End) => return (motions, warnings, None),
            Err(error) => return (motions, warnings, Some(error)),
        }
    }
    panic!("no end in sight");
}

fn order(main: &str, files: Files) -> Vec<u32> {
    let (motions, _, error) = run(main, files);
    assert_eq!(error, None, "{main}");
    motions
}

/// NC-001.
#[test]
fn calls_nest_and_come_back() {
    let files: Files = &[
        ("a.nc", "%a\nN10 G0 X1\nL b.nc\nN11 G0 X2\nM17"),
        ("b.nc", "N20 G0 X3\nL \"c d\"\nN21 G0 X4 M29\nN99 G0 X9"),
        ("c d", "N30 G0 X5"),
    ];
    assert_eq!(order("N1 G0 X0\nL a.nc\nN2 G0 X1\nM30", files), [1, 10, 20, 30, 21, 11, 2]);
    assert_eq!(
        order("L b.nc\nl  a (by its short name)\nM30\nN3 G0 X1", files),
        [20, 30, 21, 10, 20, 30, 21, 11]
    );
    // The last line may be the call, without a line end.
    assert_eq!(order("N1 G0 X0\nL \"c d\"", files), [1, 30]);
    // Called in a loop; parameters are common to all files.
    let count: Files = &[("count", "P1 = P1 + 1\nNP1 G0 XP1")];
    assert_eq!(order("P1=0\n$WHILE P1 < 4\nN50 L count\n$ENDWHILE\nN9 G0 X0", count), [1, 2, 3, 4, 9]);
}

#[test]
fn a_file_has_local_subroutines_of_its_own() {
    let part = "%L s\nN11 G0 X1\nM29\n%L t\nN12 G0 X2\nLL s\nM29\n%part\nN10 G0 X0\nLL s\nLL t\nLL mine\nM17\n%L s\n";
    let main = "%L s\nN1 G0 X1\nM29\n%L mine\nN2 G0 X1\nLL s\nM29\n%main\nLL s\nL part\nLL s\nL part\nM30";
    // `mine` is the caller's, and so is the `s` it calls.
    let round = [10, 11, 12, 11, 2, 1];
    assert_eq!(order(main, &[("part", part)]), [&[1][..], &round, &[1], &round].concat());
    // What a called file declares is not seen by its caller.
    let (_, _, error) = run("L part\nLL t", &[("part", "%L t\nM29\n%p\nM29")]);
    let error = error.expect("t is not of the main file");
    assert_eq!((error.kind, error.place.file, error.place.line), (NcErrorKind::NoSubroutine, 0, 2));
}

#[test]
fn jumps_stay_in_the_called_file() {
    let jump = "N5 $GOTO [END]\nN6 G0 X1\nN7 [END] G0 X2";
    assert_eq!(order("N1 [END] G0 X0\nL jump\nN2 G0 X1", &[("jump", jump)]), [1, 7, 2]);
    let (_, _, error) = run("N1 [END] G0 X0\nL jump", &[("jump", "$GOTO [END]")]);
    let error = error.expect("no label in that file");
    assert_eq!((error.kind, error.place.file, error.found.as_str()), (NcErrorKind::NoLabel, 1, "[END]"));
}

#[test]
fn programs_end_in_files() {
    // An empty file, one with a comment only.
    assert_eq!(order("L e\nN1 G0 X1\nL f\nN2 G0 X0", &[("e", ""), ("f", "(nothing)")]), [1, 2]);
    let (motions, warnings, error) = run("L a\nN1 G0 X1", &[("z", ""), ("a", "N2 G0 X0 M30")]);
    assert_eq!((motions, error), (vec![2], None));
    assert_eq!(warnings, [(NcWarningKind::EndInSubroutine, 2)]);
}

/// NC-001.
#[test]
fn refusals_name_the_file() {
    let refused = |main, files| run(main, files).2.expect("a refusal");
    let error = refused("N1 G0 X1\nN2 L gone.nc", &[("here.nc", "")]);
    assert_eq!(error.to_string(), "no file \"gone.nc\" to call: expected the name of a program file");
    let place = Place { line: 2, column: 6, offset: 14, length: 7, file: 0 };
    assert_eq!(error.place, place);

    let error = refused("L a", &[("a", "L b\n"), ("b", "(first)\n\n  G0 X1 Q5")]);
    assert_eq!(error.place, Place { line: 3, column: 9, offset: 17, length: 1, file: 2 });
    assert_eq!(error.found.as_str(), "Q");
    // Back in the caller, places are the caller's.
    let error = refused("L a\n\nX1 Q5", &[("a", "G0 X1\n\n\n")]);
    assert_eq!((error.place.file, error.place.line, error.place.column), (0, 3, 4));
    // A block left open in a called file; the message quotes that file.
    let error = refused("L a\nG0 X1", &[("a", "G0 X0\n$FOR P1=1,2,1\n")]);
    assert_eq!(error.to_string(), "\"$FOR\" without $ENDFOR");
    assert_eq!((error.place.file, error.place.line), (1, 2));
    let error = refused("L a", &[("a", "%L s\nM29\n")]);
    assert_eq!((error.kind, error.place.file), (NcErrorKind::NoMainProgram, 1));
    let error = refused("L a", &[("a", "L a.nc\n"), ("a.nc", "L a")]);
    assert_eq!(error.kind, NcErrorKind::CallTooDeep);
    assert_eq!(core::mem::size_of::<Place>(), 16, "kept per look-ahead block");
}

#[test]
fn names_of_a_library() {
    let mut library = Library { main: b"m", files: &[("p.nc", b"1"), ("p", b"2"), ("q.nc", b"3")] };
    assert_eq!(library.open("p"), Ok(Some(2)), "as given comes first");
    assert_eq!(library.open("q"), Ok(Some(3)));
    assert_eq!(library.open("Q"), Ok(None));
    assert_eq!((library.name(0), library.name(3), library.name(4)), (None, Some("q.nc"), None));
    let mut byte = [0];
    assert_eq!(library.read(3, 0, &mut byte), Ok(1));
    assert_eq!(byte, *b"3");
    assert_eq!(library.read(4, 0, &mut byte), Err(TextError::Failed));
}

/// Without places.
fn said(text: &str) -> Vec<String> {
    let place =
        |word: &str| !["line", "column", "offset", "length", "file"].iter().any(|f| word.starts_with(f));
    let plain = |c: &Command<5>| {
        let text = format!("{c:#?}");
        let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| place(line)).collect();
        lines.join(" ")
    };
    commands(text).iter().map(plain).collect()
}

#[test]
fn other_spellings_of_one_program() {
    let plain = "%MAIN\nN10 G00 X0 Y0\nN20 G01 X10.5 F1000 M8\n$FOR P1 = 1, 3, 1\nN30 G91 G02 X[P1 * 2] I1 J0\n$ENDFOR\n\
                 #CONTOUR MODE [DEV PATH_DEV=0.5]\nC[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=1]\nN40 G90 G04 X0.5\nN50 G0 Z[SIN[30]]\n";
    let expected = said(plain);
    assert_eq!(expected.len(), 10, "{expected:#?}");
    assert!(expected[0].contains("Motion"), "{expected:#?}");
    let marked = format!("\u{feff}{plain}");
    let variants = [
        plain.trim_end().to_owned(),
        plain.replace('\n', "\r\n"),
        marked.clone(),
        marked.replace('\n', "\r\n").replace(' ', "\t"),
        plain.to_lowercase(),
        plain.replace(' ', "\t"),
        plain.replace('\n', "\t \n"),
        format!("\t{}", plain.replace('\n', "\n\t")),
    ];
    for text in variants {
        assert_eq!(said(&text), expected, "{text:?}");
    }
    let with_end = said(&format!("{plain}M30\n"));
    assert_eq!(with_end[..10], expected);
    assert_eq!(with_end.len(), 11);
}

#[test]
fn a_byte_order_mark_stands_first_or_not_at_all() {
    // Columns count bytes, and the mark has three.
    assert_eq!(
        crate::nc_decode::error("\u{feff}Q5").place,
        Place { line: 1, column: 4, offset: 3, length: 1, file: 0 }
    );
    assert_eq!(crate::nc_decode::error("\nG0\u{feff}").kind, NcErrorKind::ForeignByte(0xef));
    let (_, _, error) = run_text(b"\xef\xbbX1".as_slice());
    assert_eq!(error.expect("half a mark").kind, NcErrorKind::ForeignByte(0xef));
    assert_eq!(commands("\u{feff}"), []);
    // A label in the first line is found again; a called file may have a mark too.
    let back = "\u{feff}[TOP] P1 = 1 + P2\nP2 = P1\n$IF P1 < 3 $GOTO [TOP]\nNP1 G0 X1";
    assert_eq!(order("P2=0\nL back", &[("back", back)]), [3]);
}

#[test]
fn switching_off_can_be_told() {
    for text in [
        "#CONTOUR MODE OFF",
        "G260",
        "G150",
        "#SPLINE OFF",
        "#HSC OFF",
        "#FILTER OFF",
        "#TRAFO OFF",
        "G359",
        "#VECTOR LIMIT OFF ALL",
    ] {
        let off = commands(text);
        assert!(off.len() == 1 && off[0].switches_off(), "{text}: {off:?}");
    }
    for text in [
        "#CONTOUR MODE ON",
        "#CONTOUR MODE [DEV]",
        "G261",
        "G151",
        "#HSC ON",
        "#FILTER ON",
        "#TRAFO ON",
        "G360",
    ] {
        let on = commands(text);
        assert!(on.len() == 1 && !on[0].switches_off(), "{text}: {on:?}");
    }
}
