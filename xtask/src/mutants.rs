//! Small changes of the code by cargo-mutants, each tested with the tests of the rows of its file. The
//! changes are a random sample, made in a copy of the repository that keeps its build.
use crate::shell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Folder whose code is changed.
const FILES: &str = "src/{smooth,fir,single,lookahead,plan,queue,slope,nc}/**";

/// One change: its name, its file and its difference.
struct Mutant {
    name: String,
    file: String,
    difference: String,
}

/// Tests of one binary: arguments for cargo, and names of the tests.
type Tests = BTreeMap<Vec<String>, Vec<String>>;

/// Result of a change.
enum Fate {
    Killed(String),
    Survived,
    Unbuildable,
}

/// Tests `count` changes, drawn with `seed`, after the first `first` changes.
pub fn sample(seed: u64, first: usize, count: usize) -> Result<(), String> {
    let mut all = list()?;
    let whole = all.len();
    let mut state = seed;
    for k in 0..whole.min(first + count) {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let other = k + ((z ^ (z >> 31)) % (whole - k) as u64) as usize;
        all.swap(k, other);
    }
    println!("{whole} changes, {count} from the {first}th of seed {seed}");
    let copy = copy()?;
    let conformance = read(&copy.join("docs/conformance.md"))?;
    let (mut killed, mut survived, mut unbuildable) = (0, 0, 0);
    for mutant in all.iter().skip(first).take(count) {
        let tests = tests_of(&mutant.file, &conformance);
        let begun = Instant::now();
        let fate = one(&copy, mutant, &tests)?;
        let took = begun.elapsed().as_secs();
        match fate {
            Fate::Killed(by) => {
                killed += 1;
                println!("killed      {}: {by} ({took} s)", mutant.name);
            }
            Fate::Survived => {
                survived += 1;
                println!("SURVIVED    {} ({took} s)", mutant.name);
            }
            Fate::Unbuildable => {
                unbuildable += 1;
                println!("unbuildable {} ({took} s)", mutant.name);
            }
        }
    }
    println!("{killed} killed, {survived} survived, {unbuildable} do not compile");
    Ok(())
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// All changes of cargo-mutants, with their differences.
fn list() -> Result<Vec<Mutant>, String> {
    let mut command = shell::cargo(&shell::root());
    command.args(["mutants", "--list", "--diff", "--package", "glidepath", "--file", FILES]);
    let output = shell::capture(&mut command, Duration::from_mins(5))?;
    if !output.success {
        return Err(format!("cargo install cargo-mutants\n{}", output.err));
    }
    let text = String::from_utf8_lossy(&output.out).into_owned();
    let lines: Vec<&str> = text.lines().collect();
    let heads: Vec<usize> =
        (1..lines.len()).filter(|&k| lines[k].starts_with("--- src/")).map(|k| k - 1).collect();
    Ok(heads
        .iter()
        .enumerate()
        .map(|(k, &head)| {
            let end = heads.get(k + 1).copied().unwrap_or(lines.len());
            Mutant {
                name: lines[head].to_owned(),
                file: lines[head + 1][4..].to_owned(),
                difference: lines[head + 3..end].join("\n"),
            }
        })
        .collect())
}

/// Copies the repository, with uncommitted changes, to `target/mutants`.
fn copy() -> Result<PathBuf, String> {
    let (root, copy) = (shell::root(), shell::root().join("target/mutants/copy"));
    let mut command = std::process::Command::new("git");
    command.current_dir(&root).args(["ls-files", "--cached", "--others", "--exclude-standard"]);
    let output = shell::capture(&mut command, Duration::from_mins(1))?;
    for name in String::from_utf8_lossy(&output.out).lines() {
        let (from, to) = (root.join(name), copy.join(name));
        let Ok(bytes) = std::fs::read(&from) else { continue };
        // An unchanged file keeps its time, because cargo compiles newer files again.
        if std::fs::read(&to).is_ok_and(|there| there == bytes) {
            continue;
        }
        let folder = to.parent().unwrap_or(&copy);
        std::fs::create_dir_all(folder)
            .and_then(|()| std::fs::write(&to, bytes))
            .map_err(|e| format!("{}: {e}", to.display()))?;
    }
    Ok(copy)
}

/// Tests named by rows of the file; without such rows, the tests of its folder.
fn tests_of(file: &str, conformance: &str) -> Tests {
    let folder = file.rsplit_once('/').map_or("", |(folder, _)| folder);
    let of = |place: &str| {
        let mut tests = Tests::new();
        let rows = conformance.lines().filter(|line| line.starts_with("| ") && line.contains(place));
        for word in rows.flat_map(|line| line.split('`').skip(1).step_by(2)) {
            let Some((path, name)) = word.split_once("::") else { continue };
            let Some((target, module)) = target(path) else { continue };
            let name = format!("{module}{name}");
            let names = tests.entry(target).or_default();
            if !names.contains(&name) {
                names.push(name);
            }
        }
        tests
    };
    let own = of(&format!("`{file}`"));
    if own.is_empty() { of(&format!("`{folder}/")) } else { own }
}

/// Arguments for cargo for a file of tests, and the prefix of the names of these tests.
fn target(path: &str) -> Option<(Vec<String>, String)> {
    let words = |words: [&str; 4]| words.map(str::to_owned).to_vec();
    let without_end = |name: &str| name.strip_suffix(".rs").unwrap_or(name).to_owned();
    if let Some(rest) = path.strip_prefix("host-tests/tests/") {
        let (system, file) = rest.split_once('/')?;
        let module = if file == "main.rs" { String::new() } else { without_end(file) + "::" };
        Some((words(["-p", "host-tests", "--test", system]), module))
    } else {
        let rest = path.strip_prefix("boards/host/tests/")?;
        Some((words(["-p", "glidepath-host", "--test", &without_end(rest)]), String::new()))
    }
}

/// Makes a change, runs its tests until one fails, and reverts the change.
fn one(copy: &Path, mutant: &Mutant, tests: &Tests) -> Result<Fate, String> {
    let path = copy.join(&mutant.file);
    let before = read(&path)?;
    let changed = changed(&before, &mutant.difference).ok_or_else(|| format!("{}: no place", mutant.name))?;
    write(&path, &changed)?;
    let fate = run(copy, tests);
    write(&path, &before)?;
    fate
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

fn run(copy: &Path, tests: &Tests) -> Result<Fate, String> {
    for (target, names) in tests {
        let mut build = shell::cargo(copy);
        build
            .args(["test", "--release", "--no-run"])
            .args(target)
            .env("CARGO_TARGET_DIR", shell::root().join("target/mutants/target"))
            .env("CARGO_INCREMENTAL", "1")
            .env("CARGO_PROFILE_RELEASE_DEBUG", "0")
            .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "2");
        let built = shell::capture(&mut build, Duration::from_mins(15))?;
        if !built.success {
            return Ok(Fate::Unbuildable);
        }
        let executable = built
            .err
            .lines()
            .find_map(|line| line.trim().strip_prefix("Executable ")?.rsplit_once('(')?.1.strip_suffix(')'));
        let executable = executable.ok_or_else(|| format!("no executable of {target:?}"))?;
        // The test binary runs without cargo, so that this process can end an endless loop.
        let mut test = std::process::Command::new(executable);
        let folder = if target[1] == "host-tests" { "host-tests" } else { "boards/host" };
        test.current_dir(copy.join(folder)).arg("--exact").args(names);
        let ran = shell::capture(&mut test, Duration::from_mins(3))?;
        if ran.timed_out {
            return Ok(Fate::Killed(format!("{}: no end", target[3])));
        }
        if !ran.success {
            let out = String::from_utf8_lossy(&ran.out).into_owned();
            let failed = out.lines().find_map(|line| line.strip_prefix("test ")?.strip_suffix(" ... FAILED"));
            return Ok(Fate::Killed(format!("{}::{}", target[3], failed.unwrap_or("?"))));
        }
    }
    Ok(Fate::Survived)
}

/// Applies the hunks of a unified difference to a text.
fn changed(text: &str, difference: &str) -> Option<String> {
    let old: Vec<&str> = text.lines().collect();
    let (mut new, mut at) = (Vec::new(), 0);
    let mut inside = false;
    for line in difference.lines() {
        if let Some(place) = line.strip_prefix("@@ -") {
            let first: usize = place.split([',', ' ']).next()?.parse().ok()?;
            new.extend(old.get(at..first - 1)?);
            (at, inside) = (first - 1, true);
        } else if let Some(added) = line.strip_prefix('+') {
            new.push(added);
        } else if inside && let Some((sign, kept)) = line.split_at_checked(1) {
            if old.get(at)? != &kept {
                return None;
            }
            if sign == " " {
                new.push(kept);
            }
            at += 1;
        }
    }
    new.extend(old.get(at..)?);
    Some(new.join("\n") + "\n")
}
