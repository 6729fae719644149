//! `--report`: the page is complete and well-formed. A browser opens it in `tests/browser/page.mjs`.
mod common;

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

/// The content of a script with this id.
fn script<'a>(page: &'a str, id: &str) -> &'a str {
    let (_, behind) = page.split_once(&format!("id=\"{id}\">")).expect("the script is there");
    behind.split_once("</script>").expect("it ends").0
}

fn report(name: &str, program: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.html"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    let output = command.args(["run", program, "--report"]).arg(&path).output().expect("it starts");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    fs::read_to_string(path).expect("the page was asked for")
}

#[test]
fn the_page_holds_every_tick_and_every_block() {
    let program = common::shipped("tests/programs/shapes.nc");
    let page = report("shapes", &program);
    let facts: Value = serde_json::from_str(script(&page, "json")).expect("JSON");
    let count = |name: &str| {
        let columns = facts["columns"].as_array().expect("a list");
        let column = columns.iter().find(|column| column[0] == name).unwrap_or_else(|| panic!("{name}"));
        column[2].as_u64()
    };
    let ticks = facts["summary"]["ticks"].as_u64();
    for name in ["v", "pX", "sX", "aY", "jZ"] {
        assert_eq!(count(name), ticks, "{name}");
    }
    assert_eq!(count("line"), facts["summary"]["blocks"].as_u64());
    assert_eq!(count("lx"), count("lz"));
    for id in ["data", "text"] {
        let data = script(&page, id);
        let letter = |c: char| c.is_ascii_alphanumeric() || "+/=".contains(c);
        assert!(data.len().is_multiple_of(4) && data.starts_with("H4sI") && data.chars().all(letter), "{id}");
    }
}

/// No address outside the page, and every element that begins ends.
#[test]
fn the_page_is_well_formed_and_needs_no_network() {
    let program = common::written("report-odd", "%odd\nN10 G01 X1 F600 (</script><b> & {{data}})\nM30\n");
    let page = report("odd", &program);
    assert!(!page.contains("{{"), "all is filled in");
    for tag in
        ["html", "head", "body", "script", "style", "section", "div", "canvas", "table", "main", "header"]
    {
        let opened = page.matches(&format!("<{tag}>")).count() + page.matches(&format!("<{tag} ")).count();
        assert_eq!(opened, page.matches(&format!("</{tag}>")).count(), "{tag}");
    }
    for outside in ["src=\"", "href=\"http", "url(http", "@import", "fetch("] {
        assert!(!page.contains(outside), "{outside}");
    }
}
