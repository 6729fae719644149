//! The C interface on the host, from C: misuse has its answers, and the example has the set points of the Rust one. Both
//! under valgrind where that is installed.
use glidepath::channel::Channel;
use glidepath::nc::Window;
use glidepath_c_header::folder;
use hil_cases::{BLOCKS, Line, Unwatched, tasks};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

fn root() -> PathBuf {
    folder().join("../..")
}

/// Runs a command; what it wrote.
fn output(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {}\n{text}{said}", output.status);
    text
}

/// The library for the host, built once. With checks of overflows and debug assertions, and quickly.
fn library() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let target = root().join("target/c");
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.current_dir(folder()).args(["build", "--release", "--quiet"]).env("CARGO_TARGET_DIR", &target);
        for (key, value) in
            [("LTO", "off"), ("OPT_LEVEL", "1"), ("CODEGEN_UNITS", "16"), ("DEBUG_ASSERTIONS", "true")]
        {
            cargo.env(format!("CARGO_PROFILE_RELEASE_{key}"), value);
        }
        output(&mut cargo);
        target.join("release/libglidepath_c.a")
    })
}

/// Compiles a C program with the library and runs it; what it wrote.
fn run(name: &str, sources: &[PathBuf], arguments: &[PathBuf]) -> String {
    let program = library().with_file_name(name);
    let mut gcc = Command::new("gcc");
    gcc.args(["-std=gnu11", "-g", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic"]);
    for place in ["include", "example"] {
        gcc.arg("-I").arg(folder().join(place));
    }
    gcc.args(sources).arg(library()).args(["-lpthread", "-ldl", "-lm", "-o"]).arg(&program);
    output(&mut gcc);
    let has_valgrind = Command::new("valgrind").arg("--version").output().is_ok();
    if !has_valgrind {
        eprintln!("off: no valgrind");
        return output(Command::new(program).args(arguments));
    }
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--quiet", "--error-exitcode=9", "--leak-check=full", "--track-origins=yes"]);
    output(valgrind.arg(program).args(arguments))
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
    let text = run("desktop", &sources, &[root().join("boards/tasks/tasks.nc")]);
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
    output(
        Command::new("g++")
            .args(["-std=c++17", "-fsyntax-only", "-Wall", "-Werror", "-x", "c++"])
            .arg(header),
    );
}
