//! Accepted tables: compares the result of a test with the accepted table. The first line of a table has the
//! reason of its last change.
//!
//! `ACCEPT_TABLES="why the figures moved"` writes a table that differs. The run that writes a table fails;
//! the next run compares the table.
use std::path::Path;

/// The environment variable that holds the reason.
pub const VARIABLE: &str = "ACCEPT_TABLES";

/// Fewest letters and words of a reason.
const LETTERS: usize = 12;
const WORDS: usize = 3;

/// Text around the reason in the first line of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Head(pub &'static str, pub &'static str);

impl Head {
    /// In a CSV file.
    pub const CSV: Self = Self("# accepted: ", "");
    /// In Markdown.
    pub const MARKDOWN: Self = Self("<!-- accepted: ", " -->");

    /// A table without the line with its reason.
    pub fn strip(self, table: &str) -> &str {
        match table.split_once('\n') {
            Some((first, rest)) if first.starts_with(self.0) => rest,
            _ => table,
        }
    }
}

/// The reason, if there is one.
pub fn reason() -> Option<String> {
    std::env::var(VARIABLE).ok()
}

/// Whether a reason is long enough.
///
/// # Errors
/// The missing part.
fn is_reason(reason: &str, head: Head) -> Result<(), String> {
    let letters = reason.chars().filter(|c| c.is_alphabetic()).count();
    if letters < LETTERS || reason.split_whitespace().count() < WORDS {
        return Err(format!("{VARIABLE}={reason:?} says not why: at least {WORDS} words are asked for"));
    }
    if reason.contains('\n') || (!head.1.is_empty() && reason.contains(head.1.trim())) {
        return Err(format!("{VARIABLE} is one line without {:?}", head.1));
    }
    Ok(())
}

/// Compares a table with the accepted one. With a reason, `write` replaces the old table by the new one, with
/// its head.
///
/// # Errors
/// The first line that differs, an invalid reason, or the message that a table was accepted.
pub fn compare(
    name: &str,
    now: &str,
    accepted: &str,
    head: Head,
    reason: Option<&str>,
    write: impl FnOnce(&str) -> std::io::Result<()>,
) -> Result<(), String> {
    let before = head.strip(accepted);
    if now == before {
        return Ok(());
    }
    if let Some(reason) = reason {
        is_reason(reason, head)?;
        write(&format!("{}{reason}{}\n{now}", head.0, head.1)).map_err(|e| format!("{name}: {e}"))?;
        return Err(format!("{name}: accepted; look at the difference, and run again without {VARIABLE}"));
    }
    let lines = now.lines().zip(before.lines().chain(std::iter::repeat("")));
    let (now, before) =
        lines.into_iter().find(|(now, before)| now != before).unwrap_or(("its end", "more lines"));
    Err(format!(
        "{name}: {now:?}, accepted is {before:?}; accept with {VARIABLE}=\"why the figures moved\" before the same command"
    ))
}

/// Compares a table with the file of the accepted one.
///
/// # Errors
/// As [`compare`].
pub fn compare_file(path: &Path, now: &str, reason: Option<&str>) -> Result<(), String> {
    let accepted = std::fs::read_to_string(path).unwrap_or_default();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    compare(&name, now, &accepted, Head::CSV, reason, |text| std::fs::write(path, text))
}
