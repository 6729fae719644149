//! The loader: walks the tables of the file along the parameter tables of the crate.
mod numbers;
mod overrides;
mod plc;
#[cfg(test)]
mod tests;
mod value;
mod words;

use super::{MAX_AXES, Machine, later, plain, steps};
use crate::diagnose::{Diagnostic, Source, nearest};
use crate::dialect::Choice;
use glidepath::channel::MachineError;
use glidepath::machine::parameter::{AXIS, AXIS_FOREIGN, CHANNEL, CHANNEL_FOREIGN, Parameter};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData};
use glidepath_steps::AxisSteps;
pub use overrides::Overrides;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use value::{Allowed, suggestion};
pub use value::{label, thousandths};

const LOOK_AHEAD: &str = "look_ahead";
/// P-CHAN-00071.
const SLOPE: &str = "prog_start.slope.profile";

/// P-CHAN-00600, and P-CHAN-00605, whose first text is the same.
const FUNCTION: &str = "configuration.path_preparation.function";
const FCT_ENABLE: &str = "configuration.path_preparation.fct_enable";

/// Reads a machine file. Parameters that the command line sets may have any value of ISG's range in the file.
///
/// # Errors
/// All errors of the file, one message each.
pub fn load(path: &Path, overrides: &Overrides) -> Result<Machine, Vec<Diagnostic>> {
    read(&Source::read(path)?, overrides)
}

/// The same for a text in memory.
///
/// # Errors
/// As [`load`].
pub fn read(source: &Source, overrides: &Overrides) -> Result<Machine, Vec<Diagnostic>> {
    let text = match std::str::from_utf8(&source.text) {
        Ok(text) => text,
        Err(error) => {
            let (line, column) = source.position(error.valid_up_to());
            let message = "a machine file must be UTF-8 text";
            return Err(vec![Diagnostic::error(message).at(source, line, column, 1)]);
        }
    };
    let mut loader =
        Loader { source, overrides, refused: Vec::new(), warnings: Vec::new(), given: Vec::new() };
    let machine = loader.machine(text);
    if loader.refused.is_empty() {
        let Loader { warnings, given, .. } = loader;
        Ok(Machine { name: source.name.clone(), warnings, given, ..machine })
    } else {
        Err(loader.refused)
    }
}

/// Returns the table that has the parameter, or the first table if neither has it.
fn table_of<Target>(
    name: &str,
    isg: &'static [Parameter<Target>],
    foreign: &'static [Parameter<Target>],
) -> &'static [Parameter<Target>] {
    if foreign.iter().any(|parameter| parameter.name == name) { foreign } else { isg }
}

/// A value of the file with its dotted name inside its table.
pub(super) struct Entry<'a> {
    pub(super) name: String,
    pub(super) key: Range<usize>,
    pub(super) value: &'a Spanned<DeValue<'a>>,
    /// The name with a common unit in the file, and the factor to ISG's unit.
    plain: Option<(&'static str, i64)>,
}

pub(super) struct Loader<'a> {
    source: &'a Source,
    overrides: &'a Overrides,
    pub(super) refused: Vec<Diagnostic>,
    warnings: Vec<Diagnostic>,
    /// Parameters that the file gives, with their line.
    given: Vec<(String, usize)>,
}

impl Loader<'_> {
    fn allowed<Target>(&self, parameter: &Parameter<Target>) -> Allowed {
        match self.overrides.value(parameter.name) {
            Some(_) => Allowed::known(parameter),
            None => Allowed::here(parameter),
        }
    }

    fn machine(&mut self, text: &str) -> Machine {
        let mut machine = Machine {
            axes: Vec::new(),
            channel: ChannelData::new(),
            steps: Vec::new(),
            name: String::new(),
            warnings: Vec::new(),
            dialect: Choice::Auto,
            smooth: None,
            kinematics: super::Kinematics::default(),
            variables: Vec::new(),
            given: Vec::new(),
        };
        let document = match DeTable::parse(text) {
            Ok(document) => document,
            Err(error) => {
                let at = error.span().unwrap_or(0..0);
                self.refuse(&at, format!("not a TOML file: {}", error.message().trim_end()), "");
                return machine;
            }
        };
        // The channel comes first, because ranges of the axes depend on its cycle time.
        for (key, value) in document.get_ref() {
            match (key.get_ref().as_ref(), value.get_ref()) {
                ("channel", DeValue::Table(table)) => {
                    let mut entries = Vec::new();
                    flatten(table, "", &mut entries);
                    let entries = self.expand("channel", entries, plain::CHANNEL, false);
                    for entry in &entries {
                        let is_set = self.synch(entry, &mut machine.channel)
                            || self.slope(entry, &mut machine.channel)
                            || self.dialect(entry, &mut machine)
                            || self.kinematics(entry, &mut machine)
                            || self.enable(entry, &entries, &mut machine.channel)
                            || self.interpolator(entry, &entries, &mut machine.channel)
                            || self.shift(entry, &mut machine.channel);
                        if !is_set {
                            let known = table_of(&entry.name, CHANNEL, CHANNEL_FOREIGN);
                            self.set("channel", entry, known, later::CHANNEL, &mut machine.channel);
                        }
                    }
                }
                ("startup", DeValue::Table(table)) => {
                    let mut entries = Vec::new();
                    flatten(table, "", &mut entries);
                    for entry in &entries {
                        self.start_up(entry, &document, &mut machine.channel);
                    }
                }
                ("variables", DeValue::Table(table)) => {
                    let mut entries = Vec::new();
                    flatten(table, "", &mut entries);
                    for entry in &entries {
                        self.variable(entry, &mut machine.variables);
                    }
                }
                ("axis", DeValue::Table(_)) => {}
                ("axis" | "channel" | "startup" | "variables", _) => {
                    self.refuse(
                        &key.span(),
                        "this name stands for a table",
                        "for example [axis.X] or [channel]",
                    );
                }
                (other, _) => {
                    let known = nearest(other, ["axis", "channel", "startup", "variables"]);
                    self.refuse(
                        &key.span(),
                        format!("unknown table `{other}`"),
                        &suggestion(known.or(Some("axis.X or channel"))),
                    );
                }
            }
        }
        self.warn_of_step(text);
        if let Err(refused) = self.overrides.apply(&mut machine.channel) {
            self.refused.extend(refused);
        }
        for (key, value) in document.get_ref() {
            if let ("axis", DeValue::Table(axes)) = (key.get_ref().as_ref(), value.get_ref()) {
                for (name, table) in axes {
                    let mut output = steps::preset(machine.axes.len());
                    if let Some(axis) = self.axis(name, table, &machine, &mut output) {
                        machine.axes.push(axis);
                        machine.steps.push(output);
                    }
                }
                if axes.len() > MAX_AXES {
                    let message = format!("{} axes: this simulator is built for 1 to {MAX_AXES}", axes.len());
                    self.refuse(&key.span(), message, "");
                }
            }
        }
        if self.refused.is_empty() && !machine.axes.is_empty() {
            let channel = document.get_ref().iter().find(|(key, _)| key.get_ref().as_ref() == "channel");
            let at = channel.map_or(0..0, |(key, _)| key.span());
            self.fit_kinematics(&at, &machine);
        }
        if machine.axes.is_empty() && self.refused.is_empty() {
            let message = format!("{}: a machine needs an axis", self.source.name);
            self.refused
                .push(Diagnostic::error(message).expected("for example: [axis.X] with type = \"linear\""));
        }
        machine
    }

    fn axis(
        &mut self,
        key: &Spanned<toml::de::DeString<'_>>,
        value: &Spanned<DeValue<'_>>,
        machine: &Machine,
        output: &mut AxisSteps,
    ) -> Option<AxisData> {
        let letters = key.get_ref().as_ref();
        let Some(name) = AxisName::new(letters) else {
            let expected = "one to four letters and digits, a letter first";
            self.refuse(&key.span(), format!("`{letters}` cannot be the name of an axis"), expected);
            return None;
        };
        if machine.axes.iter().any(|axis| axis.name == name) {
            self.refuse(&key.span(), format!("axis {} is there already", name.as_str()), "");
        }
        let DeValue::Table(table) = value.get_ref() else {
            self.refuse(
                &key.span(),
                format!("axis.{letters} stands for a table"),
                &format!("[axis.{letters}]"),
            );
            return None;
        };
        let mut entries = Vec::new();
        flatten(table, "", &mut entries);
        let table_name = format!("axis.{letters}");
        let kind = entries.iter().find(|entry| entry.name == "type");
        let turns = kind.is_some_and(|entry| entry.value.get_ref().as_str() == Some("rotary"));
        let entries = self.expand(&table_name, entries, plain::AXIS, turns);
        let mut axis = AxisData::new(name, AxisKind::Linear);
        let before = self.refused.len();
        for entry in &entries {
            if entry.name == "type" {
                self.kind(entry, &mut axis);
            } else if entry.name.starts_with("steps.") {
                self.steps(&table_name, entry, output);
            } else {
                let known = table_of(&entry.name, AXIS, AXIS_FOREIGN);
                self.set(&table_name, entry, known, later::AXIS, &mut axis);
            }
        }
        if axis.kind != AxisKind::Spindle && name.is_reserved() {
            let told = MachineError::Reserved(name).to_string();
            let (message, expected) = told.split_once("; expected ").unwrap_or((&told, ""));
            self.refuse(&key.span(), message, expected);
        }
        if self.refused.len() == before {
            self.check(&table_name, key, &entries, &axis);
            self.remark(&table_name, key, &entries, &axis, &machine.channel);
        }
        Some(axis)
    }

    /// Replaces names with common units by ISG's parameters, and records which parameters the file has.
    fn expand<'a>(
        &mut self,
        table: &str,
        entries: Vec<Entry<'a>>,
        names: &'static [plain::Plain],
        turns: bool,
    ) -> Vec<Entry<'a>> {
        let mut all: Vec<Entry<'a>> = Vec::new();
        for entry in entries {
            let known = names.iter().find(|known| entry.name == known.name || entry.name == known.rotary);
            let Some(known) = known else {
                all.push(entry);
                continue;
            };
            let own = if turns { known.rotary } else { known.name };
            if entry.name != own {
                let message = format!("{table}.{}: the unit of another type of axis", entry.name);
                self.refuse(&entry.key, message, own);
                continue;
            }
            let Entry { key, value, .. } = entry;
            let parts = known.isg.iter().map(|name| Entry {
                name: (*name).to_owned(),
                key: key.clone(),
                value,
                plain: Some((own, known.scale)),
            });
            all.extend(parts);
        }
        for (index, entry) in all.iter().enumerate() {
            if let Some(twice) = all.iter().take(index).find(|other| other.name == entry.name) {
                let [first, second] =
                    [twice, entry].map(|entry| entry.plain.map_or(&*entry.name, |plain| plain.0));
                let message = format!("{table}.{second} gives what {table}.{first} gives");
                let at = if entry.plain.is_some() { entry.key.clone() } else { twice.key.clone() };
                self.refuse(&at, message, "one of them");
            }
            let name = if entry.name == "slope" { SLOPE } else { &entry.name };
            let (line, _) = self.source.position(entry.key.start);
            self.given.push((format!("{table}.{name}"), line));
        }
        all
    }

    /// Warns if the file has no slope, because the default is STEP.
    fn warn_of_step(&mut self, text: &str) {
        let name = format!("channel.{SLOPE}");
        if self.overrides.slope.is_some() || self.given.iter().any(|(given, _)| *given == name) {
            return;
        }
        let message = format!(
            "{} is missing: the slope is STEP, without a limit of jerk",
            label("channel", "P-CHAN-00071", SLOPE)
        );
        let line = text.lines().position(|line| line.trim_start().starts_with("[channel")).unwrap_or(0);
        let warning = Diagnostic::warning(message).at(self.source, line + 1, 1, 1);
        self.warnings.push(warning.expected("slope = \"TRAPEZ\" in [channel], or \"STEP\" to say so"));
    }

    pub(super) fn text(&self, span: &Range<usize>) -> &str {
        self.source.text.get(span.clone()).and_then(|bytes| std::str::from_utf8(bytes).ok()).unwrap_or("")
    }

    pub(super) fn refuse(&mut self, at: &Range<usize>, message: impl Into<String>, expected: &str) {
        let (line, column) = self.source.position(at.start);
        let diagnostic = Diagnostic::error(message).at(self.source, line, column, at.len());
        self.refused.push(if expected.is_empty() { diagnostic } else { diagnostic.expected(expected) });
    }
}

/// Values of a table and of those inside it.
fn flatten<'a>(table: &'a DeTable<'a>, prefix: &str, entries: &mut Vec<Entry<'a>>) {
    for (key, value) in table {
        let name = format!("{prefix}{}", key.get_ref());
        match value.get_ref() {
            DeValue::Table(inner) => flatten(inner, &format!("{name}."), entries),
            _ => entries.push(Entry { name, key: key.span(), value, plain: None }),
        }
    }
}
