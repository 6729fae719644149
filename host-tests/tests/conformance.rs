//! `docs/conformance.md`: every id of the inventory once, and what its rows name exists.
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Families of ids: prefix, digits, last number.
const FAMILIES: [(&str, usize, u32); 7] =
    [("D3", 3, 284), ("A8", 3, 61), ("C40", 3, 74), ("NC", 3, 14), ("CF", 2, 35), ("G", 2, 13), ("OP", 2, 6)];

const STATES: [&str; 5] = ["done", "part", "decoded", "none", "open"];

struct Row {
    id: String,
    what: String,
    state: String,
    files: Vec<String>,
    tests: Vec<String>,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// What stands in backticks.
fn quoted(cell: &str) -> Vec<String> {
    cell.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn rows() -> Vec<Row> {
    let text = std::fs::read_to_string(root().join("docs/conformance.md")).expect("the document");
    let is_row = |line: &&str| FAMILIES.iter().any(|(prefix, ..)| line.starts_with(&format!("| {prefix}-")));
    text.lines()
        .filter(is_row)
        .map(|line| {
            let line = line.strip_prefix('|').and_then(|line| line.strip_suffix('|')).expect(line);
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let [id, what, state, files, tests] = cells[..] else { panic!("five cells: {line}") };
            assert_eq!(
                files.replace('`', ""),
                quoted(files).join(", "),
                "{id}: files in backticks, with commas"
            );
            assert_eq!(
                tests.replace('`', ""),
                quoted(tests).join(", "),
                "{id}: tests in backticks, with commas"
            );
            Row {
                id: id.into(),
                what: what.into(),
                state: state.into(),
                files: quoted(files),
                tests: quoted(tests),
            }
        })
        .collect()
}

#[test]
fn every_id_is_there_once_and_in_order() {
    let expected = FAMILIES.iter().flat_map(|&(prefix, digits, last)| {
        (1..=last).map(move |number| format!("{prefix}-{number:0digits$}"))
    });
    let found: Vec<String> = rows().into_iter().map(|row| row.id).collect();
    for (index, id) in expected.clone().enumerate() {
        assert_eq!(found.get(index), Some(&id), "row {index}");
    }
    assert_eq!(found.len(), expected.count());
}

#[test]
fn states_are_those_of_the_legend() {
    let text = std::fs::read_to_string(root().join("docs/conformance.md")).expect("the document");
    for state in STATES {
        assert!(text.contains(&format!("\n| `{state}` |")), "{state} is not in the legend");
    }
    for row in rows() {
        assert!(STATES.contains(&row.state.as_str()), "{}: {}", row.id, row.state);
        assert!(!row.what.is_empty(), "{}", row.id);
        let nothing = matches!(row.state.as_str(), "none" | "open");
        assert_eq!(row.files.is_empty(), nothing, "{} ({}): files", row.id, row.state);
        assert_eq!(row.tests.is_empty(), nothing, "{} ({}): tests", row.id, row.state);
    }
}

#[test]
fn files_exist_and_hold_the_words_quoted() {
    for row in rows() {
        let texts: Vec<String> = row
            .files
            .iter()
            .map(|file| {
                std::fs::read_to_string(root().join(file))
                    .unwrap_or_else(|e| panic!("{}: {file}: {e}", row.id))
            })
            .collect();
        let parameters = row.what.split([' ', ',', ';']).filter(|word| word.starts_with("P-"));
        let words: Vec<String> = quoted(&row.what).into_iter().chain(parameters.map(str::to_owned)).collect();
        for word in words.iter().filter(|_| !texts.is_empty()) {
            assert!(texts.iter().any(|text| text.contains(word)), "{}: {word} in {:?}", row.id, row.files);
        }
    }
}

#[test]
fn tests_exist() {
    let mut known: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for row in rows() {
        for test in row.tests {
            let (file, name) = test.split_once("::").unwrap_or_else(|| panic!("{}: {test}", row.id));
            let names = known.entry(file.into()).or_insert_with(|| test_names(&row.id, file));
            assert!(names.contains(name), "{}: no test {name} in {file}", row.id);
        }
    }
}

/// Functions marked as tests.
fn test_names(id: &str, file: &str) -> BTreeSet<String> {
    let text = std::fs::read_to_string(root().join(file)).unwrap_or_else(|e| panic!("{id}: {file}: {e}"));
    let lines = text.split("#[test]").skip(1);
    lines
        .filter_map(|rest| Some(rest.trim_start().strip_prefix("fn ")?.split_once('(')?.0.to_owned()))
        .collect()
}
