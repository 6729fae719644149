//! The order of modules: permitted imports, and the highest size of a function and a struct.
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Every module with those it uses, lowest first: a module uses only modules above its own row. The order is
/// that of `src/lib.rs`.
const TOWER: [(&str, &str); 24] = [
    ("math", ""),
    ("quantity", "math"),
    ("machine", "math quantity"),
    ("technology", "quantity"),
    ("variable", ""),
    ("nc", "math quantity machine technology variable"),
    ("path", "math quantity machine nc"),
    ("kinematics", "math quantity machine path"),
    ("control", "machine technology"),
    ("queue", "math quantity machine technology path control"),
    ("fir", "math quantity machine nc queue"),
    ("slope", "math quantity machine queue"),
    ("dynamics", "math quantity machine nc path fir slope"),
    ("single", "math quantity queue slope"),
    ("smooth", "math quantity nc path slope dynamics"),
    ("contour_log", "math quantity nc path"),
    ("rt_loop", "quantity variable nc"),
    ("lookahead", "math quantity machine nc path control queue slope dynamics"),
    (
        "plan",
        "math quantity machine technology nc path kinematics control queue slope dynamics smooth contour_log lookahead",
    ),
    ("tick", "quantity queue fir"),
    ("axis", "quantity"),
    ("operator", "quantity technology path control queue tick"),
    ("digest", "quantity"),
    (
        "channel",
        "math quantity machine technology nc path kinematics queue fir slope single contour_log rt_loop variable plan tick operator",
    ),
];

/// Functions above [`FUNCTION_LINES`]: a match over names.
const MATCHES: [&str; 3] = ["nc/block.rs g_word", "nc/block.rs word", "nc/error.rs fmt"];
const FUNCTION_LINES: usize = 80;

/// Structs above [`STRUCT_FIELDS`]: they mirror machine data or the words of a command.
const MIRRORS: [&str; 7] = [
    "machine/mod.rs AxisData",
    "machine/mod.rs ChannelData",
    "nc/function.rs Contour",
    "nc/function.rs Hsc",
    "nc/interpreter.rs Interpreter",
    "smooth/contour/parameters.rs Parameters",
    "smooth/surface/parameters.rs Parameters",
];
const STRUCT_FIELDS: usize = 15;

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../src")
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Every file of the library with its module and its lines, comments left out.
fn library() -> Vec<(String, String, Vec<String>)> {
    let root = source();
    let mut found = Vec::new();
    files(&root, &mut found);
    found.sort();
    let of = |path: &PathBuf| {
        let name = path.strip_prefix(&root).expect("inside").to_string_lossy().replace('\\', "/");
        let module = name.split('/').next().expect("a name").trim_end_matches(".rs").to_owned();
        let text = std::fs::read_to_string(path).expect("a text");
        let code = |line: &str| line.split("//").next().unwrap_or("").trim_end().to_owned();
        (module, name, text.lines().map(code).collect())
    };
    // Above all of them: the picture, and the proof that what is public can be logged.
    found.iter().map(of).filter(|(module, ..)| module != "lib" && module != "logged").collect()
}

/// Words behind `prefix` in a line.
fn behind<'a>(line: &'a str, prefix: &'a str) -> impl Iterator<Item = &'a str> {
    line.split(prefix).skip(1).map(|rest| {
        let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        &rest[..end]
    })
}

#[test]
fn modules_use_those_below_them_alone() {
    let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (module, name, lines) in library() {
        let top = name == format!("{module}.rs") || name == format!("{module}/mod.rs");
        for line in &lines {
            assert!(!(top && line.contains("super::") && !line.contains("pub(super)")), "{name}: {line}");
            let used = behind(line, "crate::").filter(|used| *used != module);
            uses.entry(module.clone()).or_default().extend(used.map(str::to_owned));
        }
    }
    let order: Vec<&str> = TOWER.iter().map(|(module, _)| *module).collect();
    for (at, (module, below)) in TOWER.iter().enumerate() {
        let listed: BTreeSet<String> = below.split_whitespace().map(str::to_owned).collect();
        for used in &listed {
            let place = order.iter().position(|module| module == used);
            assert!(place.is_some_and(|place| place < at), "{module} uses {used}, which is not below it");
        }
        let used = uses.remove(*module).unwrap_or_default();
        assert_eq!(used, listed, "what {module} uses, and what the table says");
    }
    assert!(uses.is_empty(), "modules that are not in the table: {uses:?}");
}

#[test]
fn the_library_shows_the_tower_in_its_order() {
    let text = std::fs::read_to_string(source().join("lib.rs")).expect("lib.rs");
    let declared = text.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    let order: Vec<&str> = TOWER.iter().map(|(module, _)| *module).collect();
    assert_eq!(declared.collect::<Vec<_>>(), order);
    let overview = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/overview.md");
    let overview = std::fs::read_to_string(overview).expect("docs/overview.md");
    for (module, _) in TOWER {
        assert!(overview.contains(&format!("`{module}`")), "docs/overview.md says nothing of `{module}`");
    }
}

/// Functions of a file: name and lines from its signature to its last brace.
fn functions(lines: &[String]) -> Vec<(String, usize)> {
    let mut found = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let start = line.trim_start();
        let indent = line.len() - start.len();
        let Some(name) = behind(start, "fn ").next() else { continue };
        let is_item = start.starts_with("fn ") || start.starts_with("pub") || start.starts_with("const fn ");
        if !is_item || name.is_empty() {
            continue;
        }
        let end = format!("{}}}", " ".repeat(indent));
        let last = lines[at..].iter().position(|line| {
            *line == end || line.ends_with(';') && !line.starts_with(&" ".repeat(indent + 1))
        });
        found.push((name.to_owned(), last.map_or(1, |last| last + 1)));
    }
    found
}

/// Structs of a file with their fields.
fn structs(lines: &[String]) -> Vec<(String, usize)> {
    let mut found = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let Some(name) = behind(line, "struct ").next() else { continue };
        if line.starts_with(' ') || !line.ends_with('{') {
            continue;
        }
        let body = lines[at + 1..].iter().take_while(|line| *line != "}");
        let is_field =
            |line: &&String| line.starts_with("    ") && !line.starts_with("     ") && line.contains(": ");
        found.push((name.to_owned(), body.filter(is_field).count()));
    }
    found
}

fn above(most: usize, exempt: &[&str], of: fn(&[String]) -> Vec<(String, usize)>) {
    let mut large: Vec<(usize, String)> = Vec::new();
    for (_, file, lines) in library() {
        large.extend(
            of(&lines).into_iter().filter(|(_, n)| *n > most).map(|(name, n)| (n, format!("{file} {name}"))),
        );
    }
    large.sort();
    let names: BTreeSet<&str> = large.iter().map(|(_, name)| name.as_str()).collect();
    let exempt: BTreeSet<&str> = exempt.iter().copied().collect();
    assert_eq!(names, exempt, "with more than {most}: {large:#?}");
}

#[test]
fn functions_are_short() {
    above(FUNCTION_LINES, &MATCHES, functions);
}

#[test]
fn structs_have_few_fields() {
    above(STRUCT_FIELDS, &MIRRORS, structs);
}
