//! The desktop simulator: runs NC programs through the code of the controller and shows what the axes do.
//!
//! The simulator is a board like the others: it supplies program text, machine data and a clock, which runs
//! as fast as the processor permits.

mod acknowledge;
mod beside;
mod check;
mod clock;
mod contour;
mod course;
mod decimal;
mod deviation;
mod diagnose;
mod dialect;
mod driven;
mod events;
mod files;
mod filtered;
mod knee;
mod machine;
mod mistakes;
mod monitor;
mod output;
mod plc;
mod plot;
mod program;
mod report;
mod resolution;
mod run;
mod serve;
mod smooth;
mod statistics;
mod summary;
mod tolerance;
mod trace;
mod usage;
mod vcd;
mod why;

use clap::{CommandFactory, Parser, Subcommand};
use diagnose::Diagnostic;
use events::Script;
use files::Files;
use glidepath::machine::{InterpolatorData, InterpolatorFunctions};
use machine::{Machine, Overrides};
use output::Outputs;
use program::Around;
use run::Wanted;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Runs NC programs through the Glidepath interpolator.
#[derive(Parser)]
#[command(name = "glidepath", version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Decode, plan and interpolate programs; say what it did and write what is asked for.
    Run(Box<Run>),
    /// Tell all that `run` would refuse, without planning the motion.
    Check(Check),
    /// List the G and M words of a dialect; without one, those of all.
    Words {
        /// The dialect.
        #[arg(value_enum)]
        dialect: Option<dialect::Choice>,
    },
    /// Write and explain machine files.
    #[command(subcommand)]
    Machine(MachineFile),
    /// Print what a shell needs to complete commands and options.
    Completions {
        /// The shell.
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
    /// Write the manual pages, one for each command.
    Man {
        /// The folder, which exists.
        #[arg(value_name = "FOLDER")]
        folder: PathBuf,
    },
    /// Be a controller that a sender talks to (Grbl 1.1), over TCP on this machine or a pseudo terminal.
    Serve(Serve),
}

/// What to do with machine files.
#[derive(Subcommand)]
enum MachineFile {
    /// Write a machine file of a kind, with a comment at each value.
    New {
        #[command(flatten)]
        options: machine::Options,
        /// The file; without it the standard output.
        #[arg(long, value_name = "FILE.toml")]
        output: Option<PathBuf>,
    },
    /// Say every value of a machine file in plain words, with its unit, its ISG id and whether it is a default.
    Explain {
        /// The machine file; without it the built-in machine.
        #[arg(value_name = "FILE.toml")]
        machine: Option<PathBuf>,
    },
    /// Write a machine file from the settings of another controller: Grbl's answer to `$$`, a LinuxCNC INI, a Klipper
    /// printer.cfg.
    From {
        /// The settings; `-` is the standard input.
        #[arg(value_name = "FILE")]
        settings: PathBuf,
        /// The file; without it the standard output.
        #[arg(long, value_name = "FILE.toml")]
        output: Option<PathBuf>,
    },
}

#[derive(clap::Args)]
struct Input {
    /// NC programs; `-` is the standard input.
    #[arg(required = true, value_name = "PROGRAM")]
    programs: Vec<PathBuf>,
    /// Machine data (TOML); without it the built-in three-axis machine.
    #[arg(long, value_name = "FILE.toml")]
    machine: Option<PathBuf>,
    /// Slope at program start, in place of P-CHAN-00071.
    #[arg(long, value_enum, ignore_case = true)]
    slope: Option<Slope>,
    /// Blocks of look-ahead, in place of P-STUP-00071 (P-CHAN-00653).
    #[arg(long, value_name = "N")]
    look_ahead: Option<u32>,
    /// The language of the program, in place of that of the machine data.
    #[arg(long, value_enum, ignore_case = true)]
    dialect: Option<dialect::Choice>,
    /// A variable V.E.NAME of programs and its first value; again for each. Machine data may have a table [variables].
    #[arg(long, value_name = "NAME=VALUE", value_parser = plc::parse_variable)]
    set: Vec<(&'static str, f64)>,
    /// Commands (motions, functions, switches) of lines carried out before, after which a program is taken for endless.
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    max_commands: u64,
    /// Mistakes of a program that are told in one go, in the order of its text.
    #[arg(long, value_name = "N", default_value_t = mistakes::SHOWN)]
    mistakes: usize,
}

/// The slopes of P-CHAN-00071 in their order.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Slope {
    Step,
    Trapez,
    Sin2,
    Hsc,
}

#[derive(clap::Args)]
struct Serve {
    /// Machine data (TOML) of three axes; without it the built-in machine.
    #[arg(long, value_name = "FILE.toml")]
    machine: Option<PathBuf>,
    /// Port on 127.0.0.1; 0: any free one.
    #[arg(long, value_name = "PORT", conflicts_with = "pty", required_unless_present = "pty")]
    tcp: Option<u16>,
    /// A pseudo terminal; its name is printed.
    #[arg(long)]
    pty: bool,
    /// Times as fast as real time.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    speed: u32,
    /// End when the sender has gone (TCP).
    #[arg(long)]
    once: bool,
    /// Height of the plate that the probe touches, mm below the start (negative), or `off`.
    #[arg(long, value_name = "MM", default_value = "-20", allow_hyphen_values = true, value_parser = parse_plate)]
    plate: Plate,
    /// Port on 127.0.0.1 for lines that press inputs: `press door`; 0: any free one.
    #[arg(long, value_name = "PORT")]
    control: Option<u16>,
    /// Port on 127.0.0.1 for a page with state, position, path and inputs to press; 0: any free one.
    #[arg(long, value_name = "PORT")]
    page: Option<u16>,
    /// Every byte of the serial line with its time.
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Keeps `$` settings, work offsets, places of G28 and G30, and startup lines over a restart; made if missing.
    #[arg(long, value_name = "FILE")]
    store: Option<PathBuf>,
}

/// Where the plate is, if there is one.
#[derive(Clone, Copy)]
struct Plate(Option<f64>);

#[derive(clap::Args)]
struct Check {
    #[command(flatten)]
    input: Input,
    /// Plan and drive the programs too: finds where the motion would exceed a limit, a defect of the planner.
    #[arg(long)]
    plan: bool,
    /// The requests of a PLC, as of `run`: mistakes in them, and functions that the machine data do not enable. Programs
    /// know the variables V.E. that it names; with --plan it acts.
    #[arg(long, value_name = "FILE")]
    plc: Option<PathBuf>,
}

#[derive(clap::Args)]
struct Run {
    #[command(flatten)]
    input: Input,
    /// Events from outside, one per line: `<seconds> override <percent>`, `feedhold`, `resume`, `abort`,
    /// `reduced on|off`, `starve <seconds>`, `stall <seconds>`, `ack <function>`.
    #[arg(long, value_name = "FILE")]
    events: Option<PathBuf>,
    /// Smooth a program that has no smoothing, up to so far from the programmed path: Surface or contour mode DEV,
    /// whichever is faster.
    #[arg(long, value_name = "MM", value_parser = smooth::parse)]
    smooth: Option<f64>,
    /// Seconds after its output at which a function is acknowledged, or `never`. Functions that --events
    /// acknowledges are not meant.
    #[arg(long, value_name = "SECONDS", default_value = "0", value_parser = acknowledge::parse_delay)]
    ack: acknowledge::Delay,
    /// Every set point of every tick, as exact decimals; `-` is the standard output, .gz at the end compresses it.
    #[arg(long, value_name = "FILE.csv|.csv.gz")]
    trace: Option<PathBuf>,
    #[command(flatten)]
    extract: trace::Extract,
    /// What is printed, and more, for programs to read.
    #[arg(long, value_name = "FILE.json")]
    summary: Option<PathBuf>,
    /// The programmed contour, before smoothing.
    #[arg(long, value_name = "FILE.json")]
    contour: Option<PathBuf>,
    /// The pins of the step output over time, for a wave viewer; `[axis.X.steps]` of the machine data.
    #[arg(long, value_name = "FILE.vcd")]
    vcd: Option<PathBuf>,
    /// Slots of a tick in --vcd.
    #[arg(long, value_name = "100|200|400", default_value = "200", value_parser = parse_slots)]
    slots: usize,
    /// A picture: path, speed, acceleration and jerk.
    #[arg(long, value_name = "FILE.svg|.png", value_parser = plot::parse_target)]
    plot: Option<plot::Target>,
    /// What the picture shows of the path; without it the plane in which something moves, and space.
    #[arg(
        long,
        value_name = "PLANES",
        value_enum,
        ignore_case = true,
        value_delimiter = ',',
        requires = "plot"
    )]
    planes: Vec<plot::Plane>,
    /// A page to look into, complete in one file: path in space, speed, acceleration, jerk, NC lines.
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    /// What a PLC does, one per line: `<seconds> reach`, `elements <mm> <mm>`, `log <index>`, `state <seconds>`, `feed`,
    /// `standstill`, `laser <mm> <degrees> <mm> <percent>`, `variable <name>`; `end` is the time of the program's end. It
    /// writes `set <name> <value>` and `loop on|off|<passes>`. Questions need FCT_CONTOUR_LAH and others of P-CHAN-00650:
    /// the built-in machine has them.
    #[arg(long, value_name = "FILE", requires = "answers")]
    plc: Option<PathBuf>,
    /// The answers to --plc, one JSON object per line; `-` is the standard output.
    #[arg(long, value_name = "FILE.jsonl", requires = "plc")]
    answers: Option<PathBuf>,
    /// A picture of --plc: how far the path is known over time.
    #[arg(long, value_name = "FILE.svg", requires = "plc")]
    reach: Option<PathBuf>,
    /// Say what bound the speed: the program runs again for every limit.
    #[arg(long, value_enum, default_value_t)]
    why: why::Asked,
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Run(arguments) => run_all(&arguments),
        Command::Check(arguments) => each(&arguments.input.programs, |program| check(&arguments, program)),
        Command::Words { dialect } => say(&dialect::list(dialect)),
        Command::Machine(what) => machine_file(&what),
        Command::Completions { shell } => completions(shell),
        Command::Man { folder } => man(&folder),
        Command::Serve(arguments) => serve(&arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(diagnostics) => {
            for diagnostic in diagnostics {
                diagnostic.print();
            }
            ExitCode::FAILURE
        }
    }
}

/// The errors that stop a run, at least one.
type Refusal = Vec<Diagnostic>;

fn parse_plate(text: &str) -> Result<Plate, String> {
    if text == "off" {
        return Ok(Plate(None));
    }
    let height = text.parse().ok().filter(|height| (-1e5..=1e5).contains(height));
    height.map(|height| Plate(Some(height))).ok_or_else(|| "expected a height in mm, or `off`".into())
}

fn parse_slots(text: &str) -> Result<usize, String> {
    let slots = text.parse().ok().filter(|slots| vcd::SLOTS.contains(slots));
    slots.ok_or_else(|| "expected 100, 200 or 400".into())
}

/// The requests of a PLC. The built-in machine gets all functions for them.
fn read_plc(
    path: Option<&Path>,
    input: &Input,
    machine: &mut Machine,
) -> Result<Option<plc::Script>, Refusal> {
    let plc = path.map(plc::Script::read).transpose()?;
    if plc.is_some() && input.machine.is_none() {
        machine.channel.interpolator =
            InterpolatorData { log_max: run::KEPT as u32, ..InterpolatorData::ALL };
    }
    Ok(plc)
}

fn load(input: &Input, files: &Files) -> Result<Machine, Refusal> {
    let overrides = Overrides { slope: input.slope.map(|slope| slope as u8), look_ahead: input.look_ahead };
    let mut machine = match &input.machine {
        Some(path) => machine::load(path, &overrides)?,
        None => {
            let mut machine = Machine::built_in();
            overrides.apply(&mut machine.channel)?;
            machine.channel.interpolator = InterpolatorData {
                functions: InterpolatorFunctions::IPO_DEFAULT
                    .with(InterpolatorFunctions::CONTOUR_LAH)
                    .with(InterpolatorFunctions::SHIFT_NCBL),
                log_max: run::KEPT as u32,
                ..InterpolatorData::ALL
            };
            machine
        }
    };
    machine.variables.extend(&input.set);
    let choice = input.dialect.unwrap_or(machine.dialect);
    machine.channel.foreign.dialect = dialect::choose(choice, &files.main)?;
    Ok(machine)
}

/// Runs programs one after another; a refused program does not stop the next one.
fn each(programs: &[PathBuf], mut one: impl FnMut(&Path) -> Result<(), Refusal>) -> Result<(), Refusal> {
    let mut all = Ok(());
    for program in programs {
        if let Err(diagnostics) = one(program) {
            diagnostics.iter().for_each(Diagnostic::print);
            all = Err(Refusal::new());
        }
    }
    all
}

fn run_all(arguments: &Run) -> Result<(), Refusal> {
    let programs = &arguments.input.programs;
    let plot = arguments.plot.as_ref().map(|plot| &plot.path);
    let outputs = [
        &arguments.trace,
        &arguments.summary,
        &arguments.contour,
        &arguments.vcd,
        &arguments.report,
        &arguments.answers,
        &arguments.reach,
    ];
    if let (true, Some(path)) = (programs.len() > 1, outputs.into_iter().flatten().chain(plot).next()) {
        return Err(output::refused(path, "several programs do not go into one output; run them one by one"));
    }
    each(programs, |program| run(arguments, program))
}

fn run(arguments: &Run, path: &Path) -> Result<(), Refusal> {
    let input = &arguments.input;
    let files = Files::read(path)?;
    let mut machine = load(input, &files)?;
    let script = arguments.events.as_deref().map(Script::read).transpose()?;
    let plc = read_plc(arguments.plc.as_deref(), input, &mut machine)?;
    let around = Around {
        script: script.as_ref(),
        acknowledge: arguments.ack,
        plc: plc.as_ref(),
        limit: input.max_commands,
    };
    let mut program = decode(&files, &machine, input, around)?;
    if program.passes.is_some() {
        outside_excludes(arguments)?;
    }
    if let Some(tolerance) = arguments.smooth {
        program = smooth::put(&files, &mut machine, program, tolerance, input.max_commands);
    }
    let outputs = [
        &arguments.trace,
        &arguments.summary,
        &arguments.contour,
        &arguments.vcd,
        &arguments.report,
        &arguments.answers,
        &arguments.reach,
    ];
    if outputs.into_iter().flatten().filter(|path| path.as_os_str() == "-").count() > 1 {
        return Err(output::refused(Path::new("-"), "the standard output takes one of the outputs"));
    }
    program.warnings.splice(0..0, std::mem::take(&mut machine.warnings));
    // Only now all files of the program are known.
    let text = Some(path.to_path_buf()).filter(|path| path.as_os_str() != "-");
    let inputs = text.iter().chain(&input.machine).chain(&arguments.events).chain(&arguments.plc).cloned();
    let mut outputs = Outputs::new(inputs.chain(files.called()));
    let trace = match arguments.trace.as_deref() {
        Some(path) => Some((path, outputs.create(path)?)),
        None => None,
    };
    let vcd = match arguments.vcd.as_deref() {
        Some(path) => Some((path, outputs.create(path)?, arguments.slots)),
        None => None,
    };
    let wanted = Wanted {
        trace,
        extract: arguments.extract.clone(),
        vcd,
        picture: arguments.plot.is_some(),
        report: arguments.report.is_some(),
        script: script.as_ref(),
        acknowledge: arguments.ack,
        plc: plc.as_ref(),
        quiet: false,
    };
    let (mut result, picture) = run::simulate(&files, &machine, &program, wanted)
        .map_err(|refused| all_mistakes(&files, &machine, (input, plc.as_ref()), refused))?;
    program.warnings.extend(result.remarks.iter().map(|warning| program::remark(&files, warning)));
    if let Some(script) = &script {
        let end = result.time_s(&machine);
        let reduces = machine.axes.iter().any(|axis| axis.vb_max_red > 0);
        program.warnings.extend(script.unused(&result.outcomes, end, reduces));
    }
    let events = script.as_ref().map_or(&[][..], |script| &script.events);

    if let Some(told) = &mut result.plc {
        program.warnings.append(&mut told.unreached);
    }

    let by_itself = script.is_none() && result.waited == 0;
    let asked = if program.passes.is_some() { why::Asked::Never } else { arguments.why };
    let why = why::ask(&files, &machine, &program, &result, by_itself, asked);
    let summary = summary::Summary::new(&files, &machine, &program, events, &result, why.as_ref());
    if let Some(path) = &arguments.contour {
        outputs.write(path, contour::to_json(&machine, &program).as_bytes())?;
    }
    if let Some(path) = &arguments.summary {
        outputs.write(path, summary.to_json().as_bytes())?;
    }
    if let (Some(path), Some(tape)) = (&arguments.report, &result.tape) {
        let scene = report::Scene {
            files: &files,
            machine: &machine,
            program: &program,
            statistics: &result,
            tape,
            summary: summary.to_json(),
        };
        outputs.write(path, report::page(&scene).as_bytes())?;
    }
    if let (Some(path), Some(told)) = (&arguments.answers, &result.plc) {
        outputs.write(path, told.answers.as_bytes())?;
    }
    if let (Some(path), Some(told)) = (&arguments.reach, &result.plc) {
        outputs.write(path, plc::draw(&files.main.name, told).as_bytes())?;
    }
    if let (Some(target), Some(picture)) = (&arguments.plot, picture) {
        let scene = plot::Scene {
            machine: &machine,
            program: &program,
            statistics: &result,
            picture: &picture,
            events,
            planes: &arguments.planes,
        };
        outputs.write(&target.path, &plot::draw(target.format, &files.main, &scene))?;
    }
    for told in program.messages.iter().chain(&program.warnings) {
        told.print();
    }
    let text = summary.to_text();
    if outputs.on_stdout() {
        // Other programs read the standard output, so this text goes to the error output.
        let _ = anstream::stderr().write_all(text.as_bytes());
    } else {
        say(&text)?;
    }
    outputs.commit()?;
    let excess = result.monitor.errors(&machine);
    if excess.is_empty() { Ok(()) } else { Err(excess) }
}

fn completions(shell: clap_complete::Shell) -> Result<(), Refusal> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "glidepath", &mut text);
    say(&String::from_utf8_lossy(&text))
}

fn man(folder: &Path) -> Result<(), Refusal> {
    if !folder.is_dir() {
        return Err(output::refused(folder, "it is no folder"));
    }
    clap_mangen::generate_to(Arguments::command(), folder).map_err(|error| output::refused(folder, error))
}

fn machine_file(what: &MachineFile) -> Result<(), Refusal> {
    match what {
        MachineFile::New { options, output } => put(output.as_deref(), None, &machine::new(options)),
        MachineFile::From { settings, output } => {
            let source = if settings.as_os_str() == "-" {
                diagnose::Source::read_input()?
            } else {
                diagnose::Source::read(settings)?
            };
            put(output.as_deref(), Some(settings), &machine::from(&source)?)
        }
        MachineFile::Explain { machine } => {
            let machine = match machine {
                Some(path) => machine::load(path, &Overrides::default())?,
                None => Machine::built_in(),
            };
            machine.warnings.iter().for_each(Diagnostic::print);
            say(&machine::explain(&machine))
        }
    }
}

/// Writes a text that is made from the file `input`: into a file, or on the standard output.
fn put(output: Option<&Path>, input: Option<&PathBuf>, text: &str) -> Result<(), Refusal> {
    let Some(path) = output else { return say(text) };
    let mut outputs = Outputs::new(input.cloned());
    outputs.write(path, text.as_bytes())?;
    outputs.commit()
}

/// Until it is ended.
fn serve(arguments: &Serve) -> Result<(), Refusal> {
    let machine = match &arguments.machine {
        Some(path) => machine::load(path, &Overrides::default())?,
        None => Machine::built_in(),
    };
    for warning in &machine.warnings {
        warning.print();
    }
    let failed = |error: std::io::Error| vec![Diagnostic::error(format!("serve: {error}"))];
    let data = machine.data::<{ serve::AXES }>().ok_or_else(|| {
        let message = format!("serve: {} has {} axes", machine.name, machine.axes.len());
        vec![Diagnostic::error(message).expected("three: `serve` is built for them")]
    })?;
    let store = arguments.store.as_deref().map(serve::Kept::open).transpose().map_err(failed)?;
    let wire = open(arguments).map_err(failed)?;
    say(&format!("{}\n", wire.name().map_err(failed)?))?;
    let control = arguments.control.map(serve::Control::new).transpose().map_err(failed)?;
    if let Some(control) = &control {
        say(&format!("{}\n", control.name().map_err(failed)?))?;
    }
    let page = arguments.page.map(serve::Page::new).transpose().map_err(failed)?;
    if let Some(page) = &page {
        say(&format!("{}\n", page.name()))?;
    }
    let log = arguments.log.as_deref().map(serve::Log::new).transpose().map_err(failed)?;
    let mut lines = serve::Lines { wire, control, page, log, store };
    let options = serve::Options { speed: arguments.speed, once: arguments.once, plate: arguments.plate.0 };
    let ticks = serve::run(&data, &mut lines, &options).map_err(failed)?;
    say(&format!("ticks {ticks}\n"))
}

/// The requested connection.
fn open(arguments: &Serve) -> std::io::Result<serve::Wire> {
    match arguments.tcp {
        Some(port) => serve::Wire::tcp(port),
        #[cfg(unix)]
        None => serve::Wire::pty(),
        #[cfg(not(unix))]
        None => Err(std::io::Error::new(ErrorKind::Unsupported, "no pseudo terminals on this system")),
    }
}

/// Options that do not exist for a program with variables or real-time loops, because these options run the
/// program again with other data.
fn outside_excludes(arguments: &Run) -> Result<(), Refusal> {
    let option = match (arguments.smooth, arguments.why) {
        (Some(_), _) => "--smooth",
        (None, why::Asked::Always) => "--why always",
        _ => return Ok(()),
    };
    let message = format!("{option} is not available for programs with real-time loops or variables V.E.");
    Err(vec![Diagnostic::error(message).expected(format!("expected no {option}"))])
}

/// The program, or all its mistakes: those of the planner with those of the decoder.
fn decode(
    files: &Files,
    machine: &Machine,
    input: &Input,
    around: Around<'_>,
) -> Result<program::Program, Refusal> {
    let decoded = program::decode(files, machine, input.max_commands);
    // Only now all files of the program are known.
    if plc::is_from_outside(files) {
        return program::rehearse(files, machine, around).map_err(|refused| {
            let told =
                |all: &Refusal| all.iter().any(|one| refused.iter().any(|r| r.render() == one.render()));
            check::check(files, machine, input.bounds(), around.plc).err().filter(told).unwrap_or(refused)
        });
    }
    match decoded {
        Ok(program) if !program.refused => Ok(program),
        Ok(_) => Err(all_mistakes(
            files,
            machine,
            (input, around.plc),
            vec![Diagnostic::error("a line of the program is refused")],
        )),
        Err(refused) => Err(all_mistakes(files, machine, (input, around.plc), refused)),
    }
}

/// All that a check refuses; where it refuses nothing, `refused`.
fn all_mistakes(
    files: &Files,
    machine: &Machine,
    (input, plc): (&Input, Option<&plc::Script>),
    refused: Refusal,
) -> Refusal {
    check::check(files, machine, input.bounds(), plc).err().unwrap_or(refused)
}

impl Input {
    /// Bounds at which a check ends early.
    fn bounds(&self) -> check::Bounds {
        check::Bounds { commands: self.max_commands, mistakes: self.mistakes }
    }
}

/// Checks for all refusals of a run. The program is planned and simulated only if requested, or if single
/// axes move.
fn check(arguments: &Check, path: &Path) -> Result<(), Refusal> {
    let input = &arguments.input;
    let files = Files::read(path)?;
    let mut machine = load(input, &files)?;
    let plc = read_plc(arguments.plc.as_deref(), input, &mut machine)?;
    let mut checked = check::check(&files, &machine, input.bounds(), plc.as_ref())?;
    let missing = plc.as_ref().map_or_else(Vec::new, |plc| plc.missing(&machine.channel.interpolator));
    checked.warnings.extend(missing);
    let mut excess = Refusal::new();
    if arguments.plan || checked.beside {
        let around = Around { limit: input.max_commands, plc: plc.as_ref(), ..Around::default() };
        let program = decode(&files, &machine, input, around)?;
        let wanted = Wanted { plc: plc.as_ref(), ..Wanted::default() };
        let (result, _) = run::simulate(&files, &machine, &program, wanted)?;
        checked.warnings.extend(result.plc.into_iter().flat_map(|told| told.unreached));
        let remarks = result.remarks.iter().map(|warning| program::remark(&files, warning));
        checked.remarks = remarks.collect();
        excess = result.monitor.errors(&machine);
    }
    let warnings = checked.warnings.iter().chain(&checked.remarks);
    for told in checked.messages.iter().chain(&machine.warnings).chain(warnings) {
        told.print();
    }
    say(&format!("{}: {}\n", files.main.name, checked.describe()))?;
    if excess.is_empty() { Ok(()) } else { Err(excess) }
}

/// Writes to the standard output; a reader that closes the pipe is no error.
fn say(text: &str) -> Result<(), Refusal> {
    let mut out = anstream::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(output::refused(Path::new("the standard output"), error))
        }
        _ => Ok(()),
    }
}
