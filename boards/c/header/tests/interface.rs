//! The C interface on the PC, from C: misuse gets its results, and the example has the set points of the Rust
//! program. Both run with valgrind if it is installed.
use glidepath::channel::Channel;
use glidepath::nc::Window;
use glidepath_c_header::{c, folder};
use hil_cases::{BLOCKS, Line, Unwatched, tasks};
use std::path::PathBuf;
use std::process::Command;

/// Compiles a C program with the library and runs it, under valgrind where that is installed; what it wrote.
fn run(name: &str, sources: &[PathBuf], arguments: &[&str]) -> String {
    let program = c::compile(name, sources).unwrap_or_else(|e| panic!("{e}"));
    let has_valgrind = Command::new("valgrind").arg("--version").output().is_ok();
    let mut command = if has_valgrind {
        let mut valgrind = Command::new("valgrind");
        valgrind.args(["--quiet", "--error-exitcode=9", "--leak-check=full", "--track-origins=yes"]);
        valgrind.arg(program);
        valgrind
    } else {
        eprintln!("off: no valgrind");
        Command::new(program)
    };
    c::output(command.args(arguments)).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn misuse_has_its_answers() {
    let text = run("misuse", &[folder().join("header/tests/misuse.c")], &[]);
    assert!(text.ends_with(" checks\n"), "{text}");
}

#[test]
fn the_example_has_the_set_points_of_rust() {
    let example = |name: &str| folder().join("example").join(name);
    let sources = [folder().join("header/tests/desktop.c"), example("work.c")];
    let program = c::root().join("boards/tasks/tasks.nc");
    let text = run("desktop", &sources, &[&program.to_string_lossy()]);
    let mut channel = Box::new(Channel::<3, BLOCKS>::new());
    let ours = tasks(&mut channel, &mut Window::new(), Line::SERIAL, &mut Unwatched).expect("it runs");
    let line = format!("ticks {} digest {:016x}\n", ours.ticks, ours.digest.value());
    assert!(text.ends_with(&line), "{text}expected {line}");
    assert_eq!(text.lines().filter(|line| line.starts_with('N')).count(), 4, "{text}");
}

/// However slow the line is, and however late the second part: each part is taken when it is whole.
#[test]
fn late_text_makes_no_difference() {
    let mut channel = Box::new(Channel::<3, BLOCKS>::new());
    let mut run = |line| {
        let outcome = tasks(&mut channel, &mut Window::new(), line, &mut Unwatched).expect("it runs");
        (outcome.ticks, outcome.digest.value())
    };
    let usual = run(Line::SERIAL);
    for bytes in [1, 2, 3, 7, 50, 1000] {
        for late in [0, 1, 2, 17, 5000] {
            let line = Line { bytes, late };
            assert_eq!(run(line), usual, "{line:?}");
        }
    }
}

#[test]
fn the_header_goes_with_cpp() {
    let header = folder().join("include/glidepath.h");
    let mut compiler = Command::new("g++");
    compiler.args(["-std=c++17", "-fsyntax-only", "-Wall", "-Werror", "-x", "c++"]).arg(header);
    c::output(&mut compiler).unwrap_or_else(|e| panic!("{e}"));
}

/// The short form, under valgrind; the long one is `cargo run --release -p glidepath-c-header --example fuzz -- 10000000`.
#[test]
fn calls_at_random_have_their_answers() {
    let text = run("fuzz", &[folder().join("header/tests/fuzz.c")], &["20000"]);
    assert!(text.ends_with(" calls\n"), "{text}");
}
