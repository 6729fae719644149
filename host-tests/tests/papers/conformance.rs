//! `docs/conformance.md`: every id of the inventory once; files, tests and words in its rows exist.
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Families of ids: prefix, digits, last number.
const FAMILIES: [(&str, usize, u32); 7] = [
    ("D3", 3, 287),
    ("A8", 3, 62),
    ("C40", 3, 74),
    ("NC", 3, 15),
    ("CF", 2, 40),
    ("G", 2, 13),
    ("OP", 2, 11),
];

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

/// Tests of the language: each of them names every row that it is to show, in its comment, its name or its
/// body.
const OF_ROWS: &str = "host-tests/tests/language/nc_";

/// A keyword test that stands for fifty rows shows none of them: it has a line for each.
#[test]
fn tests_of_the_language_name_their_rows() {
    let mut missing = Vec::new();
    for row in rows() {
        for test in row.tests.iter().filter(|test| test.starts_with(OF_ROWS)) {
            let Some((file, name)) = test.split_once("::") else { continue };
            let text = std::fs::read_to_string(root().join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
            if !names_row(&text, name, &row.id) {
                missing.push(format!("{} in {test}", row.id));
            }
        }
    }
    assert!(missing.is_empty(), "{} rows are not named:\n{}", missing.len(), missing.join("\n"));
}

/// A row is shown by a test that says so: one at least of those that the row names has its id.
#[test]
fn every_row_is_named_by_one_of_its_tests() {
    let mut texts: BTreeMap<String, String> = BTreeMap::new();
    let mut missing = Vec::new();
    for row in rows().into_iter().filter(|row| matches!(row.state.as_str(), "done" | "part")) {
        let named = row.tests.iter().any(|test| {
            let Some((file, name)) = test.split_once("::") else { return false };
            let text = texts.entry(file.into()).or_insert_with(|| {
                std::fs::read_to_string(root().join(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
            });
            names_row(text, name, &row.id)
        });
        if !named {
            missing.push(row.id);
        }
    }
    assert!(missing.is_empty(), "{} rows are named by none of their tests: {missing:?}", missing.len());
}

/// Whether the test with that name has the id in its name, or in its text from the item before it to its end.
fn names_row(text: &str, name: &str, id: &str) -> bool {
    let Some(found) = text.find(&format!("fn {name}(")) else { return false };
    // A test within a module ends where its own brace does.
    let at = text[..found].rfind('\n').map_or(0, |line| line + 1);
    let brace = format!("\n{}}}\n", &text[at..found]);
    let before = text[..at].rfind(&brace).map_or(0, |end| end + brace.len());
    let end = text[at..].find(&brace).map_or(text.len(), |end| at + end);
    let whole_id = |text: &str, id: &str| {
        text.match_indices(id)
            .any(|(at, _)| !text[at + id.len()..].starts_with(|next: char| next.is_ascii_digit()))
    };
    let in_name = id.to_lowercase().replace('-', "_");
    whole_id(name, &in_name) || text.get(before..end).is_some_and(|text| whole_id(text, id))
}

#[test]
fn a_row_is_named_in_the_comment_the_name_or_the_body_of_its_test() {
    let text = "fn a() {\n    \"D3-001\"\n}\n\n/// D3-002.\n#[test]\nfn b() {\n    \"D3-0034\"\n}\n\n#[test]\nfn c_d3_004() {\n}\n";
    assert!(names_row(text, "b", "D3-002") && names_row(text, "c_d3_004", "D3-004"));
    for id in ["D3-001", "D3-003", "D3-004"] {
        assert!(!names_row(text, "b", id), "{id}");
    }
    assert!(!names_row(text, "d", "D3-001"));
}

/// Functions marked as tests.
fn test_names(id: &str, file: &str) -> BTreeSet<String> {
    let text = std::fs::read_to_string(root().join(file)).unwrap_or_else(|e| panic!("{id}: {file}: {e}"));
    let lines = text.split("#[test]").skip(1);
    lines
        .filter_map(|rest| Some(rest.trim_start().strip_prefix("fn ")?.split_once('(')?.0.to_owned()))
        .collect()
}
