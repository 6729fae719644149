//! The project's commands. Each command prints its steps, and ends with an exit code other than 0 after an
//! error.
mod controller;
mod cores;
mod dialects;
mod document;
mod elf;
mod figures;
mod firmware;
mod hil;
mod host;
mod lint;
mod mutants;
mod rtos;
mod senders;
mod shell;
mod stack;
mod target;
mod thumb;
mod toolchain;

use std::process::ExitCode;

/// Tests of a library without its functions.
pub(crate) const WITHOUT: &str = "host-tests/without";

const USAGE: &str = "\
cargo xtask COMMAND

  test          everything: host tests, then the target in the emulator; installs what is missing (Debian, root)
  test --host   host tests only
  hil           the target in the emulator: digests, interrupt, figures, panic proof
  hil --probe   the same on an STM32F405 behind a debug probe (probe-rs); figures are shown, not compared
  hil --beside  only filters and axes beside the path: digests, and what each of them costs
  hil --five    only a program under a transformation: digests, and what it costs
  hil --dialects  only the decoder in each dialect: instructions of a plain line, flash and RAM of builds
  hil --slim    only the build without other functions than lines, arcs and contour mode
  hil --interrupt  only the interpolator in the timer interrupt, with a planner that keeps up and one that is late
  hil --commands  only programs with commands all the time: digests, and the largest call of each
  hil --panic   only the proof that no panicking path is left; names the places if there are any
  cores         the table of cores: digests, instructions, flash and RAM on each core, against the accepted ones; minutes
  cores NAME    only that of one core, m0, m3, m4f, m33, rv32imc or rv32imac, or of one build, full or small
  cores --accept  makes what is measured the accepted figures and writes docs/cores.md; also with NAMEs before it
  rtos          only the programs in an operating system and in C: RTIC, Embassy, C, FreeRTOS; digests
  rtos NAME     only that of one of them: rtic, embassy, c, freertos
  senders       real senders stream jobs of up to 5,000 lines to `glidepath serve` and to the controller's firmware in the
                emulator: pygrbl-streamer, grbl-streamer, bCNC, cncjs; `serve` also with plotdeck, gantrix; needs Python, Node and a network for the first
                installation
  senders LINES  the same with another number of lines
  senders --short  the first two with 300 lines, as `test` has them; skipped where they cannot be installed
  controller    the controller's firmware in the emulator: a sender streams a job of 1,000 lines to its serial line
  controller LINES  the same with another number of lines
  controller --short  the same with 200 lines, then the senders of `senders --short`; `hil` has this
  header        writes the header of boards/c anew
  bench         instruction counts and memory, against the accepted ones
  bench --accept  makes the measured figures the accepted ones and writes docs/figures.md
  depth FILE FUNCTION…  the deepest way down the stack from functions of a firmware; parts of their mangled names
  mutants --seed N --first K --count M  changes by cargo-mutants, drawn by a seed, each against the tests of its
                file's rows; prints what no test notices
  package       what `cargo publish` would put out: that builds alone; and with cargo-semver-checks or cargo-deny, where
                they are installed, what they say
  lint          formatting, clippy and documentation of host and firmware
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words.as_slice() {
        ["test"] => host_tests().and_then(|()| hil::all(firmware::Place::Emulator)),
        ["test", "--host"] => host_tests(),
        ["hil"] => hil::all(firmware::Place::Emulator),
        ["hil", "--probe"] => hil::all(firmware::Place::Probe),
        ["hil", "--beside"] => hil::only_beside(),
        ["hil", "--plc"] => hil::only_plc(),
        ["hil", "--five"] => hil::only_five(),
        ["hil", "--dialects"] => dialects::only(),
        ["hil", "--slim"] => hil::only_slim(),
        ["hil", "--interrupt"] => hil::only_interrupt(),
        ["hil", "--commands"] => hil::only_commands(),
        ["hil", "--panic"] => hil::panic_proof(),
        ["cores", words @ ..] => cores::all(words),
        ["rtos"] => rtos::all(None),
        ["rtos", name] => rtos::all(Some(name)),
        ["senders", "--short"] => senders::short(),
        ["senders"] => senders::all("5000"),
        ["senders", lines] => senders::all(lines),
        ["controller"] => controller::all(&controller::LINES.to_string()),
        ["controller", "--short"] => controller::only_short(),
        ["controller", lines] => controller::all(lines),
        ["header"] => rtos::header(),
        ["bench"] => hil::bench(false),
        ["bench", "--accept"] => hil::bench(true),
        ["mutants", "--seed", seed, "--first", first, "--count", count] => {
            let number = |word: &str| word.parse::<u32>().map_err(|e| format!("{word}: {e}"));
            number(seed).and_then(|seed| {
                mutants::sample(u64::from(seed), number(first)? as usize, number(count)? as usize)
            })
        }
        ["lint"] => lint::all(),
        ["package"] => lint::package(),
        ["depth", file, roots @ ..] => stack::show(file, roots),
        _ => {
            eprint!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("\nxtask: {message}");
            ExitCode::FAILURE
        }
    }
}

fn host_tests() -> Result<(), String> {
    shell::step("host tests");
    shell::run(shell::cargo(&shell::root()).args(["test", "--workspace", "--release"]))?;
    shell::step("what a build leaves out");
    let without = |features: &str, test: &[&str]| {
        let mut command = shell::cargo(&shell::root().join(WITHOUT));
        command.args(["test", "--release", "--features", features]).args(test);
        // These programs are short: compiling takes longer than running.
        command.env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1");
        shell::run(command.env("CARGO_TARGET_DIR", shell::root().join("target")))
    };
    for features in ["", "contour"] {
        without(features, &[])?;
    }
    for features in ["grbl", "dialects", "grbl,hsc", "grbl,hsc,isg"] {
        without(features, &["--test", "grbl"])?;
    }
    senders::short()
}
