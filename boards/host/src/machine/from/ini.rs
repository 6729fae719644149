//! Files of sections and keys, in the formats of LinuxCNC and Klipper, with the place of each value.
use crate::diagnose::{Diagnostic, Source};
use crate::machine::sheet::Taken;
use std::cell::{Cell, RefCell};

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Style {
    /// `key = value`; if a key is given twice, the first value counts.
    LinuxCnc,
    /// Also `key: value`, with longer values indented on the next lines. The last value counts, including
    /// values saved with `#*#`.
    Klipper,
}

/// A value.
pub struct Entry {
    /// Without brackets.
    pub section: String,
    /// Name as written in the file.
    pub key: String,
    /// Without comment.
    pub value: String,
    line: usize,
    column: usize,
    used: Cell<bool>,
}

/// A file.
pub struct Ini<'a> {
    source: &'a Source,
    style: Style,
    entries: Vec<Entry>,
    refused: RefCell<Vec<Diagnostic>>,
    /// Included files, which are not read: line and name.
    pub includes: Vec<(usize, String)>,
}

impl<'a> Ini<'a> {
    /// Reads a file; [`Self::refusals`] refuses lines of another format.
    pub fn read(source: &'a Source, style: Style) -> Self {
        let mut ini =
            Self { source, style, entries: Vec::new(), refused: RefCell::default(), includes: Vec::new() };
        let mut section = String::new();
        let text = String::from_utf8_lossy(&source.text).into_owned();
        for (number, line) in text.lines().enumerate() {
            ini.line(number + 1, line, &mut section);
        }
        ini
    }

    fn line(&mut self, number: usize, whole: &str, section: &mut String) {
        let is_klipper = self.style == Style::Klipper;
        let saved = if is_klipper { whole.strip_prefix("#*#") } else { None };
        let line = saved.unwrap_or(whole);
        let trimmed = line.trim();
        if let Some(name) = trimmed.strip_prefix("#INCLUDE").filter(|_| !is_klipper) {
            self.includes.push((number, name.trim().to_owned()));
            return;
        }
        if trimmed.is_empty() || trimmed.starts_with(['#', ';']) {
            return;
        }
        if let Some(name) = trimmed.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
            *section = name.0.trim().to_owned();
            if let Some(file) = section.strip_prefix("include ") {
                self.includes.push((number, file.trim().to_owned()));
            }
            return;
        }
        // Longer values are macros and lists, which do not contain machine data.
        if is_klipper && saved.is_none() && line.starts_with([' ', '\t']) {
            return;
        }
        let separators: &[char] = if is_klipper { &[':', '='] } else { &['='] };
        let Some((key, value)) = line.split_once(separators) else {
            if saved.is_none() && !is_klipper {
                let expected = "a section such as [TRAJ], KEY = VALUE, or a comment behind #";
                let column = line.len() - line.trim_start().len() + 1;
                let error = Diagnostic::error("a line that is no setting");
                self.refused
                    .get_mut()
                    .push(error.at(self.source, number, column, trimmed.len()).expected(expected));
            }
            return;
        };
        let comment = [" #", "\t#", " ;", "\t;"].iter().filter_map(|start| value.find(start)).min();
        let value_text = value[..comment.unwrap_or(value.len())].trim();
        let column = whole.len() - value.len() + (value.len() - value.trim_start().len()) + 1;
        self.entries.push(Entry {
            section: section.clone(),
            key: key.trim().to_owned(),
            value: value_text.to_owned(),
            line: number,
            column,
            used: Cell::new(false),
        });
    }

    /// Returns the value of a key, and marks the key as used.
    pub fn get(&self, section: &str, key: &str) -> Option<&Entry> {
        let is = |entry: &&Entry| {
            entry.section.eq_ignore_ascii_case(section) && entry.key.eq_ignore_ascii_case(key)
        };
        let found = match self.style {
            Style::LinuxCnc => self.entries.iter().find(is),
            Style::Klipper => self.entries.iter().rev().find(is),
        };
        self.entries.iter().filter(is).for_each(|entry| entry.used.set(true));
        found
    }

    /// Whether the section exists and has a key.
    pub fn has(&self, section: &str) -> bool {
        self.entries.iter().any(|entry| entry.section.eq_ignore_ascii_case(section))
    }

    /// Returns the number of a key with its origin; a text that is no number is refused.
    pub fn number(&self, section: &str, key: &str) -> Option<Taken> {
        let entry = self.get(section, key)?;
        match entry.value.parse::<f64>().ok().filter(|value| value.is_finite()) {
            Some(value) => Some(Taken::new(value, self.origin(entry))),
            None => {
                self.refuse(entry, "no number", "a number");
                None
            }
        }
    }

    /// The same, above 0.
    pub fn positive(&self, section: &str, key: &str) -> Option<Taken> {
        let taken = self.number(section, key)?;
        if taken.value > 0.0 {
            return Some(taken);
        }
        if let Some(entry) = self.get(section, key) {
            self.refuse(entry, "out of range", "a number above 0");
        }
        None
    }

    /// The place of a value, for a comment.
    pub fn origin(&self, entry: &Entry) -> String {
        format!("[{}] {} = {} (line {})", entry.section, entry.key, entry.value, entry.line)
    }

    /// Refuses a value.
    pub fn refuse(&self, entry: &Entry, message: &str, expected: &str) {
        let message = format!("[{}] {} = {}: {message}", entry.section, entry.key, entry.value);
        let error = Diagnostic::error(message).at(self.source, entry.line, entry.column, entry.value.len());
        self.refused.borrow_mut().push(error.expected(expected));
    }

    /// Refuses the file for a key that is missing.
    pub fn missing(&self, section: &str, key: &str, expected: &str) {
        let message = format!("{}: [{section}] {key} is missing", self.source.name);
        self.refused.borrow_mut().push(Diagnostic::error(message).expected(expected));
    }

    /// All refusals, each line once.
    pub fn refusals(&self) -> Vec<Diagnostic> {
        let mut all = self.refused.take();
        all.sort_by_key(Diagnostic::place);
        all.dedup_by(|one, other| one.message == other.message && one.place() == other.place());
        all
    }

    /// Unused keys of sections with this name prefix, with the reason by key; and the other sections.
    pub fn left(&self, sections: &[&str], reasons: &[(&str, &str)]) -> Vec<String> {
        let mut left = Vec::new();
        let mut others: Vec<&str> = Vec::new();
        let upper = |text: &str| text.to_uppercase();
        for entry in &self.entries {
            let belongs = sections.iter().any(|name| upper(&entry.section).starts_with(&upper(name)));
            if !belongs {
                if !others.contains(&entry.section.as_str()) {
                    others.push(&entry.section);
                }
            } else if !entry.used.get() {
                let reason = reasons.iter().find(|(key, _)| upper(&entry.key).starts_with(&upper(key)));
                let reason = reason.map_or("no machine data", |(_, reason)| reason);
                left.push(format!("{}: {reason}", self.origin(entry)));
            }
        }
        for (line, file) in &self.includes {
            left.push(format!(
                "the file {file} (line {line}), which is not read: put its text here and try again"
            ));
        }
        if !others.is_empty() {
            left.push(format!("sections without machine data: {}", others.join(", ")));
        }
        left
    }
}
