//! docs/dialects.md lists exactly the words of the decoder's table.
use glidepath::machine::Dialect;
use glidepath::nc::{ADDRESSES, WORDS};
use std::fmt::Write as _;

/// What stands around the list.
const MARKS: [&str; 2] = ["<!-- words -->\n", "<!-- /words -->"];

/// The list as Markdown.
pub fn table() -> String {
    let mut text = String::from("| word | LinuxCNC | Grbl | Fanuc | what it does |\n|---|---|---|---|---|\n");
    let cells = |is_in: &dyn Fn(Dialect) -> bool, mark: &str| {
        let dialects = [Dialect::LinuxCnc, Dialect::Grbl, Dialect::Fanuc];
        dialects.map(|dialect| if is_in(dialect) { mark.to_owned() } else { String::new() }).join(" | ")
    };
    for word in WORDS {
        let (whole, tenth) = (word.tenths / 10, word.tenths % 10);
        let point = if tenth > 0 { format!(".{tenth}") } else { String::new() };
        let (mark, hint) = match word.is_built() {
            Ok(()) => ("yes", String::new()),
            Err(hint) => ("refused", format!("; write instead: {hint}")),
        };
        let cells = cells(&|dialect| word.is_in(dialect), mark);
        let _ = writeln!(text, "| {}{whole}{point} | {cells} | {}{hint} |", word.letter, word.text);
    }
    for address in ADDRESSES {
        let cells = cells(&|dialect| address.is_in(dialect), "yes");
        let _ = writeln!(text, "| {} | {cells} | {} |", address.letter, address.text);
    }
    text
}

#[test]
fn the_page_lists_the_words_of_the_decoder() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/dialects.md");
    let page = std::fs::read_to_string(&path).expect("docs/dialects.md");
    let (head, rest) = page.split_once(MARKS[0]).expect("<!-- words -->");
    let (list, tail) = rest.split_once(MARKS[1]).expect("<!-- /words -->");
    let table = table();
    if list != table && host_tests::accept::reason().is_some() {
        let page = format!("{head}{}{table}{}{tail}", MARKS[0], MARKS[1]);
        std::fs::write(&path, page).expect("docs/dialects.md");
    }
    assert_eq!(list, table, "ACCEPT_TABLES=\"reason\" writes the list");
}
