//! The documents: every command in them runs and prints the output in the document.
//!
//! A fence `nc NAME`, `toml NAME` or `text NAME` is a file. A fence `console` has commands after `$ ` and
//! lines of their output below; `…` stands for left-out lines. If a command draws a picture that lies next to
//! the document, both pictures are compared. `ACCEPT_TABLES="why"` writes lines and pictures again, and
//! fails.
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(file: &Path) -> String {
    fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}

/// Papers with commands, relative to the root.
fn papers() -> Vec<String> {
    let mut papers = vec!["README.md".to_owned(), "CONTRIBUTING.md".to_owned()];
    let boards = fs::read_dir(root().join("boards")).expect("the boards").flatten();
    let boards = boards.filter(|entry| entry.path().is_dir());
    let boards = boards.filter_map(|entry| Some(format!("boards/{}", entry.file_name().to_str()?)));
    for folder in boards.chain(["docs", "boards"].map(String::from)) {
        let files = fs::read_dir(root().join(&folder)).expect("a folder").flatten();
        let names = files.filter_map(|file| file.file_name().into_string().ok());
        papers.extend(names.filter(|name| name.ends_with(".md")).map(|name| format!("{folder}/{name}")));
    }
    papers.sort();
    papers
}

/// A fenced block: its line in the paper, the words behind the fence, its lines.
struct Fence<'a> {
    line: usize,
    info: &'a str,
    lines: Vec<&'a str>,
}

fn fences(text: &str) -> Vec<Fence<'_>> {
    let mut fences = Vec::new();
    let mut open: Option<Fence> = None;
    for (number, line) in text.lines().enumerate() {
        match (&mut open, line.trim_start().strip_prefix("```")) {
            (None, Some(info)) => {
                open = Some(Fence { line: number + 1, info: info.trim(), lines: Vec::new() })
            }
            (Some(_), Some(_)) => fences.extend(open.take()),
            (Some(fence), None) => fence.lines.push(line),
            (None, None) => {}
        }
    }
    fences
}

/// What a line of output is recognised by: its words up to the first gap.
fn label(line: &str) -> &str {
    let line = line.trim();
    line.split("  ").next().unwrap_or(line)
}

/// Runs `command` in `folder`; its output.
fn run(command: &str, folder: &Path) -> Result<String, String> {
    let mut words = command.split_whitespace();
    if words.next() != Some("glidepath") {
        return Err("only the simulator is run here".to_owned());
    }
    let words = words.map(|word| {
        let shipped = word.starts_with("programs/") || word.starts_with("boards/");
        if shipped { root().join(word).into_os_string() } else { word.into() }
    });
    let mut simulator = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    let output = simulator.args(words).current_dir(folder).output().map_err(|e| e.to_string())?;
    let said =
        format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if output.status.success() { Ok(said) } else { Err(said) }
}

/// Compares the lines shown below a command with its output; what they should be.
fn shown(expected: &[&str], said: &str) -> Result<Vec<String>, String> {
    let mut rest = said.lines();
    expected
        .iter()
        .map(|line| match line.trim() {
            "…" | "" => Ok((*line).to_owned()),
            _ => match rest.find(|said| label(said) == label(line)) {
                Some(said) => Ok(said.to_owned()),
                None => Err(format!("no line of the output begins with {:?}:\n{said}", label(line))),
            },
        })
        .collect()
}

#[test]
fn commands_in_the_papers_print_what_the_papers_say() {
    let accept = std::env::var("ACCEPT_TABLES").is_ok();
    let (mut faults, mut commands) = (Vec::new(), 0);
    for paper in papers() {
        let path = root().join(&paper);
        let text = read(&path);
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("book").join(paper.replace('/', "-"));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a folder for the paper");
        for fence in fences(&text) {
            match fence.info.split_once(' ') {
                Some(("nc" | "toml" | "text", name)) => {
                    fs::write(folder.join(name), fence.lines.join("\n") + "\n").expect("a file of the paper");
                }
                _ if fence.info == "console" => {
                    for (at, line) in fence.lines.iter().enumerate() {
                        let Some(command) = line.strip_prefix("$ ") else { continue };
                        commands += 1;
                        let below = &fence.lines[at + 1..];
                        let end = below.iter().position(|line| line.starts_with("$ ")).unwrap_or(below.len());
                        let said = run(command, &folder).and_then(|said| shown(&below[..end], &said));
                        let first = fence.line + at + 1;
                        match said {
                            Ok(now) => {
                                for (number, (now, before)) in now.iter().zip(&below[..end]).enumerate() {
                                    if now != before {
                                        let line = first + number + 1;
                                        faults.push(format!("{paper}:{line}: now {now:?}, shown {before:?}"));
                                        lines[line - 1].clone_from(now);
                                    }
                                }
                            }
                            Err(said) => faults.push(format!("{paper}:{first}: {command}: {said}")),
                        }
                    }
                }
                _ => {}
            }
        }
        for picture in fs::read_dir(&folder).expect("the paper's folder").flatten() {
            let name = picture.file_name();
            let beside = path.parent().expect("a folder").join(&name);
            let is_picture = Path::new(&name).extension().is_some_and(|end| end == "png");
            if is_picture && fs::read(&beside).ok() != fs::read(picture.path()).ok() {
                faults.push(format!("{paper}: the picture {} is another one", beside.display()));
                if accept {
                    fs::copy(picture.path(), &beside).expect("a picture beside the paper");
                }
            }
        }
        if accept && lines.iter().map(String::as_str).ne(text.lines()) {
            fs::write(&path, lines.join("\n") + "\n").expect("the paper");
        }
    }
    assert!(commands > 10, "{commands} commands");
    assert!(faults.is_empty(), "accept with ACCEPT_TABLES=\"why\", then run again:\n{}", faults.join("\n"));
}

/// The folder of a package `glidepath-…`.
fn folder_of(board: &str) -> String {
    if board == "c-header" { "boards/c/header".to_owned() } else { format!("boards/{board}") }
}

/// What does not exist of the parts of a `cargo` command.
fn missing(command: &str) -> Option<String> {
    let words: Vec<&str> = command.split_whitespace().collect();
    let behind =
        |option: &str| words.iter().position(|word| *word == option).and_then(|at| words.get(at + 1));
    let is_there = |file: String| (!root().join(&file).exists()).then_some(file);
    if words.get(1) == Some(&"xtask") {
        let name = words.get(2).copied().unwrap_or_default();
        let main = read(&root().join("xtask/src/main.rs"));
        return (!main.contains(&format!("\"{name}\""))).then(|| format!("xtask {name}"));
    }
    if let Some(test) = behind("--test") {
        let is_system = behind("-p") == Some(&"host-tests");
        let file = if is_system {
            format!("host-tests/tests/{test}/main.rs")
        } else {
            let board = behind("-p").and_then(|package| package.strip_prefix("glidepath-")).unwrap_or("host");
            format!("{}/tests/{test}.rs", folder_of(board))
        };
        return is_there(file);
    }
    if let Some(example) = behind("--example") {
        let folder = match behind("-p").and_then(|package| package.strip_prefix("glidepath-")) {
            Some(board) => format!("{}/examples", folder_of(board)),
            None if behind("-p") == Some(&"host-tests") => "host-tests/examples".to_owned(),
            None => "examples".to_owned(),
        };
        return is_there(format!("{folder}/{example}.rs"));
    }
    behind("--path").and_then(|path| is_there((*path).to_owned()))
}

#[test]
fn what_cargo_commands_in_the_papers_name_exists() {
    let mut commands = 0;
    for paper in papers() {
        let text = read(&root().join(&paper));
        let inline = text.split('`').skip(1).step_by(2).filter(|code| code.starts_with("cargo "));
        let fenced = text.lines().filter(|line| line.starts_with("cargo "));
        for command in inline.chain(fenced) {
            commands += 1;
            assert_eq!(missing(command), None, "{paper}: {command}");
        }
    }
    assert!(commands > 20, "{commands} commands");
}
