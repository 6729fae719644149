//! The README: its example compiles and runs, its figures are those of the accepted tables.
use host_tests::accept::{self, Head};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The example, word for word, and the machine data that it names.
mod example {
    use glidepath::{AxisData, AxisKind, AxisName, Channel, ChannelData, Handles};
    use glidepath::{MachineData, Position, Progress, State};

    const START: [Position; 3] = [Position::ZERO; 3];

    const fn axis(name: &str) -> AxisData {
        match AxisName::new(name) {
            Some(name) => AxisData { a_max: 3000, ..AxisData::new(name, AxisKind::Linear) },
            None => panic!("not a name"),
        }
    }

    const MACHINE: MachineData<3> = MachineData {
        axes: [axis("X"), axis("Y"), axis("Z")],
        channel: ChannelData { slope_profile: 1, corr_v_trans_jerk: true, ..ChannelData::new() },
    };

    // <example>
    fn last_set_point(program: &[u8]) -> Result<[Position; 3], Box<dyn core::error::Error>> {
        let mut memory = Channel::<3, 120>::new(); // 3 axes, 120 blocks of look-ahead; in firmware a static
        let Handles { mut planner, mut interpolator, operator } = memory.split(&MACHINE, START, program)?;
        loop {
            match planner.poll()? {
                Progress::Done => break,
                Progress::Waiting => _ = interpolator.tick(), // the queue is full: in firmware the timer empties it
                _ => {}
            }
            while let Some(output) = operator.output() {
                println!("N{}: {:?} is due", output.n, output.function); // M, H, S and T at their point of the path
            }
        }
        while interpolator.tick() == State::Active {}
        Ok(*interpolator.set_points())
    }
    // </example>

    /// The last set point in mm, or the message.
    pub fn ends_at(program: &[u8]) -> Result<[f64; 3], String> {
        let end = last_set_point(program).map_err(|e| e.to_string())?;
        Ok(end.map(|axis| axis.to_num::<f64>()))
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
}

/// What stands between two marks, the only ones of their kind.
fn between<'a>(text: &'a str, begin: &str, end: &str) -> &'a str {
    let (_, rest) = text.split_once(begin).unwrap_or_else(|| panic!("{begin} is missing"));
    rest.split_once(end).unwrap_or_else(|| panic!("{end} is missing")).0
}

#[test]
fn the_example_runs() {
    assert_eq!(example::ends_at(b"N10 G01 X10 Y-5 F1000\nN20 G02 X20 I5\nM30\n"), Ok([20.0, -5.0, 0.0]));
    let refused = example::ends_at(b"N10 G01 X10 F1000\nN20 #HSC ON [SURFACE]\n");
    let needs = "#HSC [SURFACE] is not enabled; expected FCT_SURFACE in configuration.path_preparation.function (P-CHAN-00600)";
    assert_eq!(refused, Err(needs.into()));
}

#[test]
fn the_example_is_the_one_tested() {
    let readme = read("README.md");
    let tests = read("host-tests/tests/papers/readme.rs");
    let words = |text: &str| text.lines().map(|line| line.trim().to_owned()).collect::<Vec<_>>().join("\n");
    let shown = between(between(&readme, "<!-- example -->", "<!-- /example -->"), "```rust\n", "```");
    let tested = between(&tests, "// <example>\n", "// </example>");
    assert_eq!(words(shown).trim(), words(tested).trim());
}

/// Times of the named programs, from the accepted table.
fn times(text: &mut String) {
    let wanted = ["program", "blocks", "length_mm", "time_s", "straight_line_s", "path_error_pm"];
    let _ = write!(
        text,
        "Program times at F 20 m/min and a cycle of 1 ms beside the ideal, the time of one straight line of the same length. Machine\n\
         *even*: 2000 mm/s², ramps 50 ms, 200 mm/s; *examples*: 2000 mm/s², ramps 150 ms, 1000 mm/s. From\n\
         [times.csv](../host-tests/tables/times.csv) and [times_examples.csv](../host-tests/tables/times_examples.csv), asserted by\n\
         `host-tests/tests/planning/chords.rs`.\n\n| machine | {} |\n|---|---|---:|---:|---:|---:|---:|\n",
        wanted.join(" | ").replace('_', " ")
    );
    for (machine, file) in [("even", "times.csv"), ("examples", "times_examples.csv")] {
        let table = read(&format!("host-tests/tables/{file}"));
        let mut lines = Head::CSV.strip(&table).lines().map(|line| line.split(',').collect::<Vec<_>>());
        let header = lines.next().expect("a header");
        let columns = wanted
            .map(|name| header.iter().position(|h| *h == name).unwrap_or_else(|| panic!("no column {name}")));
        for row in lines {
            let _ = writeln!(text, "| {machine} | {} |", columns.map(|c| row[c]).join(" | "));
        }
    }
}

/// The accepted table of the target: `section.key` and value.
fn accepted() -> BTreeMap<String, String> {
    let table = read("hil-tests/tables/accepted.toml");
    let mut values = BTreeMap::new();
    let mut section = "";
    for line in table.lines() {
        if let Some(name) = line.strip_prefix('[') {
            section = name.trim_end_matches(']');
        } else if let Some((key, value)) = line.split_once(" = ") {
            values.insert(format!("{section}.{key}"), value.trim_matches('"').to_owned());
        }
    }
    values
}

/// Instructions and bytes, from the accepted table.
fn target(text: &mut String) {
    let values = accepted();
    let get = |key: &str| values.get(key).unwrap_or_else(|| panic!("{key} is not accepted yet")).as_str();
    let _ = write!(
        text,
        "\nInstructions on a Cortex-M4F (STM32F405 in QEMU, not cycles), {}, `opt-level = 3` as in [boards](../boards/README.md), look-ahead 120, over all \
         programs of\n`hil-tests`, those in contour mode included. Program by program: [figures.md](figures.md). Repeat \
         with\n`cargo xtask bench`, asserted by `cargo xtask hil`.\n\n\
         | | 3 axes | 4 axes | 6 axes |\n|---|---:|---:|---:|\n",
        get(".compiler")
    );
    for (label, key) in [
        ("one tick, worst", "tick_max"),
        ("the same without contour mode", "tick_max_plain"),
        ("one tick, mean", "tick_mean"),
        ("planner per motion block, mean", "block_mean"),
        ("of lines and arcs with TRAPEZ, without contour mode", "block_mean_plain"),
        ("of programs in contour mode", "block_mean_contour"),
        ("decoder per motion block, mean", "decode_mean"),
        ("one planner call, worst", "poll_max"),
    ] {
        let value = |axes| get(&format!("total.{key}_{axes}_axes"));
        let _ = writeln!(text, "| {label} | {} | {} | {} |", value(3), value(4), value(6));
    }
    text.push_str(
        "\nBytes of RAM: the channel, which is static and holds all memory of planner and interrupt, and the stack at its deepest, painted\n\
         over programs in contour mode. Every configuration of the table runs on the target, with the host's set points:\n\n\
         | axes | look-ahead | channel | stack | together |\n|---:|---:|---:|---:|---:|\n",
    );
    for key in values.keys().filter_map(|key| key.strip_prefix("ram.axes_")?.strip_suffix(".total")) {
        let (axes, blocks) = key.split_once("_blocks_").expect("axes and blocks");
        let value = |part| get(&format!("ram.axes_{key}.{part}"));
        let blocks = blocks.trim_start_matches('0');
        let _ = writeln!(
            text,
            "| {axes} | {blocks} | {} | {} | {} |",
            value("channel"),
            value("stack"),
            value("total")
        );
    }
    let _ = writeln!(
        text,
        "\nA block of look-ahead takes {} bytes with 3 axes, {} with 6. Flash for 3 axes: {} bytes.",
        get("ram.bytes_per_block_3_axes"),
        get("ram.bytes_per_block_6_axes"),
        get("flash.reference")
    );
    let _ = writeln!(
        text,
        "\nLines, arcs and contour mode alone, compiled for few bytes as in [memory.md](memory.md): {} bytes of flash, and for 3 axes {} bytes of RAM with the\n\
         stack and 120 blocks, {} with 30.",
        get("slim.flash"),
        get("slim.ram_total_3x120"),
        get("slim.ram_total_3x30")
    );
}

/// The few figures of the front page.
fn front(text: &mut String) {
    let values = accepted();
    let get = |key: &str| values.get(key).unwrap_or_else(|| panic!("{key} is not accepted yet")).as_str();
    text.push_str("| Cortex-M4F in QEMU, all functions, look-ahead of 120 blocks | 3 axes | 4 axes | 6 axes |\n|---|---:|---:|---:|\n");
    for (label, [three, four, six]) in [
        (
            "worst tick, instructions (not cycles)",
            ["total.tick_max_3_axes", "total.tick_max_4_axes", "total.tick_max_6_axes"],
        ),
        (
            "worst planner call while the operator gives no command, instructions",
            ["total.poll_max_3_axes", "total.poll_max_4_axes", "total.poll_max_6_axes"],
        ),
        (
            "RAM with stack, bytes",
            ["ram.axes_3_blocks_120.total", "ram.axes_4_blocks_120.total", "ram.axes_6_blocks_120.total"],
        ),
    ] {
        let _ = writeln!(text, "| {label} | {} | {} | {} |", get(three), get(four), get(six));
    }
    let _ = writeln!(
        text,
        "\nFlash for 3 axes: {} bytes with all functions; {} with lines, arcs and contour mode alone, compiled for size.",
        get("flash.reference"),
        get("slim.flash")
    );
}

/// Compares what stands between the marks of a paper with what the accepted tables say.
fn compare_figures(paper: &str, figures: &str) {
    const BEGIN: &str = "<!-- figures -->\n";
    const END: &str = "<!-- /figures -->";
    let text = read(paper);
    let (head, rest) = text.split_once(BEGIN).expect("the begin mark");
    let (shown, tail) = rest.split_once(END).expect("the end mark");
    let write =
        |figures: &str| std::fs::write(root().join(paper), format!("{head}{BEGIN}{figures}{END}{tail}"));
    accept::compare(paper, figures, shown, Head::MARKDOWN, accept::reason().as_deref(), write)
        .unwrap_or_else(|fault| panic!("{fault}"));
}

#[test]
fn figures_are_those_of_the_accepted_tables() {
    let mut figures = String::new();
    times(&mut figures);
    target(&mut figures);
    compare_figures("docs/measured.md", &figures);
}

#[test]
fn the_front_page_has_the_accepted_figures() {
    let mut figures = String::new();
    front(&mut figures);
    compare_figures("README.md", &figures);
}

/// All papers of the project, relative to the root.
fn papers() -> Vec<String> {
    let mut papers: Vec<String> =
        ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "hil-tests/README.md"].map(String::from).into();
    let boards = std::fs::read_dir(root().join("boards")).expect("the boards").flatten();
    let boards =
        boards.filter(|entry| entry.path().is_dir()).filter_map(|entry| entry.file_name().into_string().ok());
    let folders = boards.map(|board| format!("boards/{board}")).chain(["docs", "boards"].map(String::from));
    for folder in folders {
        let files = std::fs::read_dir(root().join(&folder)).expect("a folder").flatten();
        let names = files.filter_map(|file| file.file_name().into_string().ok());
        papers.extend(names.filter(|name| name.ends_with(".md")).map(|name| format!("{folder}/{name}")));
    }
    papers
}

/// The headings of a paper, as links name them: small letters, dashes for blanks, nothing but letters and digits.
fn anchors(text: &str) -> Vec<String> {
    let mut is_code = false;
    let headings = text.lines().filter(|line| {
        is_code ^= line.starts_with("```");
        !is_code && line.starts_with('#')
    });
    let name = |heading: &str| {
        let kept = heading
            .trim_start_matches('#')
            .trim()
            .chars()
            .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        kept.collect::<String>().to_lowercase().replace(' ', "-")
    };
    headings.map(name).collect()
}

#[test]
fn files_and_headings_that_papers_link_to_exist() {
    let papers = papers();
    assert!(papers.len() > 25, "{papers:?}");
    for paper in papers {
        let file = root().join(&paper);
        let folder = file.parent().expect("a folder");
        for link in read(&paper).split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.contains("://") {
                continue;
            }
            let (name, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if name.is_empty() { file.clone() } else { folder.join(name) };
            assert!(target.exists(), "{paper}: {link}");
            if !heading.is_empty() {
                let text = std::fs::read_to_string(&target).expect("a paper");
                assert!(anchors(&text).iter().any(|anchor| anchor == heading), "{paper}: {link}");
            }
        }
    }
}

#[test]
fn numbers_in_the_text_are_those_of_the_code() {
    let limits = read("docs/limits.md").split_whitespace().collect::<Vec<_>>().join(" ");
    let pieces = glidepath::queue::PHASES;
    assert!(limits.contains(&format!("A full queue holds {pieces} pieces")), "{pieces} pieces");
    let lengths = glidepath::queue::MAX_CURVES_PER_TICK - 1;
    assert!(limits.contains(&format!("at most {lengths} lengths of the block")), "{lengths} lengths");
    // The last column of the table of small builds.
    let memory = read("docs/memory.md");
    for (what, number) in [
        ("pieces of time in the queue", pieces),
        ("curves handed on", glidepath::queue::SEGMENTS),
        ("curves that a tick passes", glidepath::queue::MAX_CURVES_PER_TICK as usize),
        ("functions under way, and acknowledgements", glidepath::queue::ACTIONS),
    ] {
        let row = between(&memory, &format!("\n| {what} | "), " |\n");
        assert_eq!(row.split(" | ").last(), Some(number.to_string().as_str()), "{what}");
    }
}

/// Files below a folder whose text holds `what`.
fn files_with(folder: &Path, what: &str, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            files_with(&path, what, found);
        } else if std::fs::read_to_string(&path).expect("text").contains(what) {
            found.push(path.strip_prefix(root()).expect("below").to_string_lossy().into_owned());
        }
    }
}

#[test]
fn the_overview_names_the_files_with_unsafe_code() {
    let mut files = Vec::new();
    files_with(&root().join("src"), "#![allow(unsafe_code)]", &mut files);
    assert!(!files.is_empty());
    let overview = read("docs/overview.md").split_whitespace().collect::<Vec<_>>().join(" ");
    let sentence = between(&overview, "The only `unsafe` code is in", ").");
    assert_eq!(sentence.matches(".rs`").count(), files.len(), "{files:?}");
    for file in files {
        assert!(sentence.contains(&format!("`{file}`")), "{file}");
    }
}

/// Source files of the crate, one after the other.
fn sources(folder: &Path, text: &mut String) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        match entry.path() {
            path if path.is_dir() => sources(&path, text),
            path => text.push_str(&std::fs::read_to_string(path).expect("text")),
        }
    }
}

#[test]
fn functions_that_the_overview_names_exist() {
    let mut source = String::new();
    sources(&root().join("src"), &mut source);
    let overview = read("docs/overview.md");
    let files = overview.split('`').skip(1).step_by(2);
    for file in files.filter(|word| word.starts_with("src/") || word.starts_with("host-tests/")) {
        assert!(root().join(file).exists(), "{file}");
    }
    let named: Vec<&str> =
        overview.split('`').skip(1).step_by(2).filter(|word| word.contains("::")).collect();
    assert!(named.len() > 20, "{named:?}");
    for word in named {
        let (of, name) = word.rsplit_once("::").expect("filtered");
        let known =
            [format!("fn {name}("), format!("fn {name}<"), format!("    {name}"), format!("struct {name}")];
        assert!(known.iter().any(|declaration| source.contains(declaration)), "{word}");
        let of = of.rsplit("::").next().unwrap_or(of);
        let known = ["struct", "enum", "trait", "mod"].map(|kind| format!("{kind} {of}"));
        assert!(known.iter().any(|declaration| source.contains(declaration)), "{of} of {word}");
    }
}

/// A planner that gets no time, however little it got before: the set points slow down, and go on from there.
#[test]
fn a_late_planner_slows_the_set_points_down_and_loses_nothing() {
    for calls in (1..=16).map(Some).chain([None]) {
        assert_eq!(late_after(calls), 0, "a way to a standstill is ready after {calls:?} calls");
    }
}

/// A planner that is called so often, or until its queue is full, and not again until all is used up: how often the set points stop
/// from one tick to the next.
fn late_after(calls: Option<usize>) -> usize {
    use glidepath::channel::{Channel, Handles, Progress};
    use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
    use glidepath::quantity::Position;
    use glidepath::tick::State;

    let axis = AxisData::new(AxisName::new("X").expect("a letter"), AxisKind::Linear);
    let channel = ChannelData { slope_profile: 1, corr_v_trans_jerk: true, ..ChannelData::new() };
    let machine = MachineData { axes: [axis], channel };
    // Blocks of one feed would become one.
    let text: String =
        (1..=400).map(|i| format!("G01 X{}.{} F{}\n", i / 2, 5 * (i % 2), 6000 + i % 2)).collect();
    let mut memory = Channel::<1, 120>::new();
    let Handles { mut planner, mut interpolator, .. }: Handles<'_, &[u8], 1, 120> =
        memory.split(&machine, [Position::ZERO], text.as_bytes()).expect("in range");

    let (mut set_points, mut stops, mut done) = (vec![0.0], 0, false);
    while !done {
        let mut called = 0;
        while calls.is_none_or(|calls| called < calls) {
            called += 1;
            match planner.poll().expect("a program") {
                Progress::Waiting => break,
                Progress::Done => {
                    done = true;
                    break;
                }
                _ => {}
            }
        }
        // Nobody polls until all is used up, and three ticks longer.
        let rows = set_points.len();
        while interpolator.tick() == State::Active {
            set_points.push(interpolator.set_points()[0].to_num::<f64>());
        }
        let rest = set_points[set_points.len() - 1];
        for _ in 0..3 {
            assert_eq!(
                (interpolator.tick(), interpolator.set_points()[0].to_num::<f64>()),
                (State::Idle, rest)
            );
        }
        if set_points.len() > rows {
            let last_step = rest - set_points[set_points.len() - 2];
            stops += usize::from(!done && last_step > 0.001);
        }
    }
    // Without the ticks of rest the motion is that of a planner in time: smooth, complete.
    assert_eq!(set_points[set_points.len() - 1], 200.0);
    let steps: Vec<f64> = set_points.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // a 1000 mm/s² at 1 ms
    assert!(steps.windows(2).all(|pair| (pair[1] - pair[0]).abs() <= 0.001 + 1e-6));
    stops
}
