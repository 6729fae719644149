//! The loader: walks the tables of the file along the parameter tables of the crate.
use super::{MAX_AXES, Machine, later, steps};
use crate::diagnose::{Diagnostic, Source, nearest};
use crate::dialect::Choice;
use crate::run::BLOCKS;
use glidepath::channel::MachineError;
use glidepath::machine::parameter::{
    AXIS, AXIS_FOREIGN, CHANNEL, CHANNEL_FOREIGN, Parameter, check_axis, check_given_stages,
};
use glidepath::machine::{Adjusted, AxisData, AxisKind, AxisName, ChannelData, SYNCHRONISED, Synch, TOOLS};
use glidepath_steps::AxisSteps;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// What a parameter may be.
struct Allowed {
    /// In thousandths.
    min: i64,
    max: i64,
    /// The same in words.
    words: String,
}

impl Allowed {
    fn takes(&self, milli: i128) -> bool {
        let (min, max) = (i128::from(self.min), i128::from(self.max));
        (min..=max).contains(&milli)
    }

    /// ISG's range.
    fn known<Target>(parameter: &Parameter<Target>) -> Self {
        // Some units are explanations.
        let unit = parameter.unit;
        let unit = if unit.contains(',') { format!("({unit})") } else { unit.to_owned() };
        let (min, max) = (parameter.min_milli, parameter.max_milli);
        let words = format!("{}…{} {unit}", thousandths(min), thousandths(max));
        Self { min, max, words }
    }

    /// What this simulator takes, which of some parameters is less.
    fn here<Target>(parameter: &Parameter<Target>) -> Self {
        match parameter.name {
            LOOK_AHEAD => Self {
                min: 10_000,
                max: BLOCKS as i64 * 1000,
                words: format!("10…{BLOCKS} blocks, this simulator is built for no more"),
            },
            _ => Self::known(parameter),
        }
    }
}

/// Largest number of an M or H function.
const LAST_FUNCTION: u16 = 999;

const LOOK_AHEAD: &str = "look_ahead";
const SLOPE: &str = "prog_start.slope.profile";

/// P-CHAN-00600, and P-CHAN-00605, whose first text is the same.
const FUNCTION: &str = "configuration.path_preparation.function";
const FCT_ENABLE: &str = "configuration.path_preparation.fct_enable";

/// Channel parameters that the command line sets in place of the machine data.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// P-CHAN-00071.
    pub slope: Option<u8>,
    /// P-STUP-00071.
    pub look_ahead: Option<u32>,
}

impl Overrides {
    fn value(&self, name: &str) -> Option<i64> {
        match name {
            LOOK_AHEAD => self.look_ahead.map(i64::from),
            SLOPE => self.slope.map(i64::from),
            _ => None,
        }
    }

    /// Sets them.
    ///
    /// # Errors
    /// Out of range, as in a machine file.
    pub fn apply(&self, channel: &mut ChannelData) -> Result<(), Vec<Diagnostic>> {
        let mut refused = Vec::new();
        for parameter in CHANNEL {
            let Some(value) = self.value(parameter.name) else { continue };
            let allowed = Allowed::here(parameter);
            if allowed.takes(i128::from(value) * 1000) {
                (parameter.set)(channel, value * 1000);
            } else {
                let option = if parameter.name == SLOPE { "--slope" } else { "--look-ahead" };
                let label = label("channel", parameter.id, parameter.name);
                let message = format!("{option}: {label} = {value}: out of range");
                refused.push(Diagnostic::error(message).expected(allowed.words));
            }
        }
        if refused.is_empty() { Ok(()) } else { Err(refused) }
    }
}

/// Reads a machine file. What the command line sets may be anything of ISG's range there.
///
/// # Errors
/// Everything that is wrong with it, one message each.
pub fn load(path: &Path, overrides: &Overrides) -> Result<Machine, Vec<Diagnostic>> {
    let source = Source::read(path)?;
    let text = match std::str::from_utf8(&source.text) {
        Ok(text) => text,
        Err(error) => {
            let (line, column) = source.position(error.valid_up_to());
            let message = "a machine file must be UTF-8 text";
            return Err(vec![Diagnostic::error(message).at(&source, line, column, 1)]);
        }
    };
    let mut loader = Loader { source: &source, overrides, refused: Vec::new(), warnings: Vec::new() };
    let machine = loader.machine(text);
    if loader.refused.is_empty() {
        Ok(Machine { name: source.name.clone(), warnings: loader.warnings, ..machine })
    } else {
        Err(loader.refused)
    }
}

/// Longest tool, µm.
const LONGEST_TOOL_UM: i128 = 10_000_000;

/// The table of the two that has the parameter; the first one where neither has.
fn table_of<Target>(
    name: &str,
    isg: &'static [Parameter<Target>],
    foreign: &'static [Parameter<Target>],
) -> &'static [Parameter<Target>] {
    if foreign.iter().any(|parameter| parameter.name == name) { foreign } else { isg }
}

/// A value of the file with its dotted name inside its table.
struct Entry<'a> {
    name: String,
    key: Range<usize>,
    value: &'a Spanned<DeValue<'a>>,
}

struct Loader<'a> {
    source: &'a Source,
    overrides: &'a Overrides,
    refused: Vec<Diagnostic>,
    warnings: Vec<Diagnostic>,
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
        };
        let document = match DeTable::parse(text) {
            Ok(document) => document,
            Err(error) => {
                let at = error.span().unwrap_or(0..0);
                self.refuse(&at, format!("not a TOML file: {}", error.message().trim_end()), "");
                return machine;
            }
        };
        // The channel first: ranges of the axes depend on its cycle time.
        for (key, value) in document.get_ref() {
            match (key.get_ref().as_ref(), value.get_ref()) {
                ("channel", DeValue::Table(table)) => {
                    let mut entries = Vec::new();
                    flatten(table, "", &mut entries);
                    for entry in &entries {
                        let is_set = self.synch(entry, &mut machine.channel)
                            || self.dialect(entry, &mut machine)
                            || self.enable(entry, &entries, &mut machine.channel);
                        if !is_set {
                            let known = table_of(&entry.name, CHANNEL, CHANNEL_FOREIGN);
                            self.set("channel", entry, known, later::CHANNEL, &mut machine.channel);
                        }
                    }
                }
                ("axis", DeValue::Table(_)) => {}
                ("axis" | "channel", _) => {
                    self.refuse(
                        &key.span(),
                        "this name stands for a table",
                        "for example [axis.X] or [channel]",
                    );
                }
                (other, _) => {
                    let known = nearest(other, ["axis", "channel"]);
                    self.refuse(
                        &key.span(),
                        format!("unknown table `{other}`"),
                        &suggestion(known.or(Some("axis.X or channel"))),
                    );
                }
            }
        }
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

    /// A key of the step output.
    fn steps(&mut self, table: &str, entry: &Entry<'_>, output: &mut AxisSteps) {
        let name = entry.name.as_str();
        let Some(key) = steps::KEYS.iter().find(|key| key.name == name) else {
            let meant = nearest(name, steps::KEYS.iter().map(|key| key.name));
            self.refuse(&entry.key, format!("unknown parameter {table}.{name}"), &suggestion(meant));
            return;
        };
        let span = entry.value.span();
        let text = self.text(&span).to_owned();
        let (least, most) = key.range;
        match milli(entry.value.get_ref(), false).map(|milli| milli / 1000) {
            Ok(value) if (i128::from(least)..=i128::from(most)).contains(&value) => {
                (key.set)(output, value as i64);
            }
            Ok(_) => {
                let message = format!("{table}.{name} = {text}: out of range");
                self.refuse(&span, message, &format!("{least}…{most} {}", key.unit));
            }
            Err(_) => {
                let message = format!("{table}.{name} = {text}: a wrong type of value");
                self.refuse(&span, message, &format!("an integer, {least}…{most} {}", key.unit));
            }
        }
    }

    fn kind(&mut self, entry: &Entry<'_>, axis: &mut AxisData) {
        const KINDS: [(&str, AxisKind); 3] =
            [("linear", AxisKind::Linear), ("rotary", AxisKind::Rotary), ("spindle", AxisKind::Spindle)];
        let word = entry.value.get_ref().as_str();
        match KINDS.iter().find(|(name, _)| Some(*name) == word) {
            Some((_, kind)) => axis.kind = *kind,
            None => {
                let message = format!("type = {}: no such type of axis", self.text(&entry.value.span()));
                let meant = word.and_then(|word| nearest(word, KINDS.map(|(name, _)| name)));
                let expected = "\"linear\", \"rotary\" or \"spindle\"";
                match meant {
                    Some(meant) => {
                        self.refuse(
                            &entry.value.span(),
                            message,
                            &format!("{expected}; is \"{meant}\" meant?"),
                        );
                    }
                    None => self.refuse(&entry.value.span(), message, expected),
                }
            }
        }
    }

    /// Looks a parameter up, checks type and range, stores it.
    fn set<Target>(
        &mut self,
        table: &str,
        entry: &Entry<'_>,
        known: &[Parameter<Target>],
        later: &[(&str, &str)],
        target: &mut Target,
    ) {
        let name = &entry.name;
        let Some(parameter) = known.iter().find(|parameter| parameter.name == name) else {
            if let Some((id, _)) = later.iter().find(|(_, later)| later == name) {
                let message = format!("{table}.{name} ({id}) is known, not available in this version");
                self.refuse(&entry.key, message, "leave it out");
            } else {
                let names =
                    known.iter().map(|parameter| parameter.name).chain(later.iter().map(|(_, name)| *name));
                let names: Vec<&str> = names.chain(["type"]).collect();
                // The last part of a name is often right where the table is wrong.
                let leaf = name.rsplit('.').next();
                let meant = nearest(name, names.iter().copied())
                    .or_else(|| names.iter().copied().find(|other| other.rsplit('.').next() == leaf));
                self.refuse(&entry.key, format!("unknown parameter {table}.{name}"), &suggestion(meant));
            }
            return;
        };
        if !parameter.words.is_empty() {
            self.set_word(table, entry, parameter, target);
            return;
        }
        let allowed = self.allowed(parameter);
        let range = &allowed.words;
        let kind = if parameter.decimals { "a number" } else { "an integer" };
        let label = label(table, parameter.id, name);
        let text = self.text(&entry.value.span()).to_owned();
        match milli(entry.value.get_ref(), parameter.decimals) {
            Err(Unfit::Type) => {
                self.refuse(
                    &entry.value.span(),
                    format!("{label} = {text}: a wrong type of value"),
                    &format!("{kind}, {range}"),
                );
            }
            Err(Unfit::Decimals) => {
                let message = format!("{label} = {text}: too many decimals");
                self.refuse(&entry.value.span(), message, &format!("three decimals at most, {range}"));
            }
            Ok(value) if !allowed.takes(value) => {
                self.refuse(&entry.value.span(), format!("{label} = {text}: out of range"), range);
            }
            Ok(value) => (parameter.set)(target, value as i64),
        }
    }

    /// `dialect`, or a length of `tool_length`; `false` if the name is another.
    fn dialect(&mut self, entry: &Entry<'_>, machine: &mut Machine) -> bool {
        let (span, value) = (entry.value.span(), entry.value.get_ref());
        let text = self.text(&span).to_owned();
        if entry.name == "dialect" {
            let names = Choice::ALL.map(|(name, _)| name);
            match Choice::ALL.into_iter().find(|(name, _)| value.as_str() == Some(name)) {
                Some((_, choice)) => machine.dialect = choice,
                None => {
                    let meant = value.as_str().and_then(|word| nearest(word, names));
                    let meant = meant.map_or_else(String::new, |name| format!("; is \"{name}\" meant?"));
                    let expected = format!("\"auto\", \"isg\", \"linuxcnc\", \"grbl\" or \"fanuc\"{meant}");
                    self.refuse(&span, format!("channel.dialect = {text}: no such dialect"), &expected);
                }
            }
            return true;
        }
        let Some(number) = entry.name.strip_prefix("tool_length.") else { return false };
        let label = format!("channel.tool_length[{number}]");
        let tools = &mut machine.channel.foreign.tools;
        // mm with three decimals to 0.1 µm.
        let length = milli(value, true).ok().filter(|milli| milli.abs() <= LONGEST_TOOL_UM);
        match (number.parse::<u32>().ok(), length) {
            (None, _) => {
                self.refuse(&entry.key, format!("{label}: no number of a tool"), "for example 1 = 52.3")
            }
            (_, None) => {
                let expected = "a number of mm with three decimals at most, -10 000…10 000";
                self.refuse(&span, format!("{label} = {text}: no tool length"), expected);
            }
            (Some(number), Some(milli)) => {
                *tools = tools.with(number, milli as i32 * 10);
                if tools.of(number).is_none() {
                    let message = format!("{label}: more than {TOOLS} tools");
                    self.refuse(&entry.key, message, "fewer tools");
                }
            }
        }
        true
    }

    /// A function of `m_synch` or `h_synch`; `false` if the name is another.
    fn synch(&mut self, entry: &Entry<'_>, channel: &mut ChannelData) -> bool {
        let (table, number) = entry.name.split_once('.').unwrap_or((&entry.name, ""));
        let (id, synchs) = match table {
            "m_synch" => ("P-CHAN-00041", &mut channel.m_synch),
            "h_synch" => ("P-CHAN-00027", &mut channel.h_synch),
            _ => return false,
        };
        let label = format!("channel.{table}[{number}] ({id})");
        let code = number.parse::<u16>().ok().filter(|code| *code <= LAST_FUNCTION);
        let Some(code) = code else {
            let example = format!("for example [channel.{table}] with 25 = \"MVS_SNS\"");
            let message = format!("{label}: no number of a function");
            self.refuse(&entry.key, message, &format!("0…{LAST_FUNCTION}, {example}"));
            return true;
        };
        let (span, value) = (entry.value.span(), entry.value.get_ref());
        let text = self.text(&span).to_owned();
        let number = milli(value, false).ok().map(|milli| milli / 1000);
        let meant = Synch::ALL
            .iter()
            .find(|(_, name, bits)| value.as_str() == Some(name) || number == Some(i128::from(*bits)));
        let here: Vec<&str> =
            Synch::ALL.iter().filter(|(synch, ..)| synch.is_available()).map(|(_, name, _)| *name).collect();
        let here = here.join(", ");
        match meant {
            Some((synch, ..)) if synch.is_available() => *synchs = synchs.with(code, *synch),
            Some((_, name, _)) => {
                let message = format!("{label} = {name} is known, not available in this version");
                self.refuse(&span, message, &here);
            }
            None => {
                let names = Synch::ALL.map(|(_, name, _)| name);
                let meant = value.as_str().and_then(|word| nearest(word, names));
                let expected = meant.map_or_else(|| here.clone(), |name| format!("{here}; is {name} meant?"));
                self.refuse(&span, format!("{label} = {text}: no synchronisation"), &expected);
            }
        }
        if synchs.overflows() {
            let message = format!("{label}: more than {SYNCHRONISED} functions");
            self.refuse(&entry.key, message, "leave out those of MOS: it is the default");
        }
        true
    }

    /// P-CHAN-00605: what the channel may use, one text per mode of program start (P-CHAN-00606). Programs start in
    /// the first one here. `false` if the name is another.
    fn enable(&mut self, entry: &Entry<'_>, entries: &[Entry<'_>], channel: &mut ChannelData) -> bool {
        const ID: &str = "P-CHAN-00605";
        if entry.name != FCT_ENABLE {
            return false;
        }
        let span = entry.value.span();
        let label = label("channel", ID, FCT_ENABLE);
        let example = "one or two texts: [\"FCT_DEFAULT|FCT_SURFACE\", \"FCT_DEFAULT\"]";
        if entries.iter().any(|other| other.name == FUNCTION) {
            let message = format!("{label}: its first text is P-CHAN-00600 `function`, which is given too");
            self.refuse(&entry.key, message, "leave one of both out");
            return true;
        }
        let modes = entry.value.get_ref().as_array().filter(|modes| (1..=2).contains(&modes.len()));
        let Some(modes) = modes else {
            let text = self.text(&span).to_owned();
            self.refuse(&span, format!("{label} = {text}: a wrong type of value"), example);
            return true;
        };
        let function = CHANNEL.iter().find(|parameter| parameter.name == FUNCTION);
        let mut other = *channel;
        for (index, (value, channel)) in modes.iter().zip([channel, &mut other]).enumerate() {
            let name = format!("{FCT_ENABLE}[{index}]");
            let text = Entry { name, key: value.span(), value };
            if let Some(function) = function {
                self.set_word("channel", &text, &Parameter { id: ID, ..*function }, channel);
            }
        }
        if let Some(second) = modes.get(1) {
            let (line, column) = self.source.position(second.span().start);
            let message = format!("{label}: the second text is of no effect");
            let warning = Diagnostic::warning(message).at(self.source, line, column, second.span().len());
            self.warnings
                .push(warning.expected("programs start in mode ISG_STANDARD, which is the first one"));
        }
        true
    }

    /// One of the words of a parameter.
    fn set_word<Target>(
        &mut self,
        table: &str,
        entry: &Entry<'_>,
        parameter: &Parameter<Target>,
        target: &mut Target,
    ) {
        let span = entry.value.span();
        let label = label(table, parameter.id, &entry.name);
        let quoted: Vec<String> = parameter.words.iter().map(|word| format!("\"{word}\"")).collect();
        let Some(given) = entry.value.get_ref().as_str() else {
            let message = format!("{label} = {}: a wrong type of value", self.text(&span));
            self.refuse(&span, message, &quoted.join(" or "));
            return;
        };
        let number = |given: &str| parameter.words.iter().position(|word| *word == given);
        if !parameter.joined {
            match number(given) {
                Some(index) => (parameter.set)(target, index as i64 * 1000),
                None => {
                    self.refuse(&span, format!("{label}: unknown word \"{given}\""), &quoted.join(" or "))
                }
            }
            return;
        }
        let mut all = 0;
        for word in given.split('|').map(str::trim) {
            let Some(index) = number(word) else {
                let expected = format!("{}, joined by |", parameter.words.join(", "));
                self.refuse(&span, format!("{label}: unknown word \"{word}\""), &expected);
                return;
            };
            all |= 1 << index;
        }
        if all & 1 == 0 {
            let first = parameter.words.first().copied().unwrap_or_default();
            self.refuse(
                &span,
                format!("{label} = \"{given}\""),
                &format!("{first} among them: nothing runs without"),
            );
            return;
        }
        (parameter.set)(target, all * 1000);
    }

    /// Ranges that depend on other parameters, which may be defaults.
    fn check(
        &mut self,
        table: &str,
        key: &Spanned<toml::de::DeString<'_>>,
        entries: &[Entry<'_>],
        axis: &AxisData,
    ) {
        let is_given = |known: &Parameter<AxisData>| entries.iter().any(|entry| entry.name == known.name);
        let Err(error) = check_axis(axis).and_then(|()| check_given_stages(axis, is_given)) else { return };
        let unit = AXIS.iter().find(|parameter| parameter.name == error.name).map_or("", |known| known.unit);
        let entry = entries.iter().find(|entry| entry.name == error.name);
        let origin = if entry.is_some() { "" } else { " (the default)" };
        let cause = entries.iter().find(|entry| entry.name == error.because);
        let at = entry.map(|entry| entry.value.span());
        let at = at.or_else(|| cause.map(|entry| entry.value.span())).unwrap_or_else(|| key.span());
        let label = label(table, error.id, error.name);
        let message = format!("{label} = {}{origin}: out of range", error.value);
        let expected = format!("{}…{} {unit}, limited by {}", error.min, error.max, error.because);
        self.refuse(&at, message, &expected);
    }

    /// Values that are not planned with as they are.
    fn remark(
        &mut self,
        table: &str,
        key: &Spanned<toml::de::DeString<'_>>,
        entries: &[Entry<'_>],
        axis: &AxisData,
        channel: &ChannelData,
    ) {
        for Adjusted { id, name, unit, value, used, because } in axis.adjusted(channel) {
            let entry = entries.iter().find(|entry| entry.name == name);
            let origin = if entry.is_some() { "" } else { " (the default)" };
            let at = entry.map_or_else(|| key.span(), |entry| entry.value.span());
            let label = label(table, id, name);
            let message = format!("{label} = {value}{origin}: planned with {used} {unit}");
            let (line, column) = self.source.position(at.start);
            let warning = Diagnostic::warning(message).at(self.source, line, column, at.len());
            self.warnings.push(warning.expected(format!("limited by {because}")));
        }
    }

    fn text(&self, span: &Range<usize>) -> &str {
        self.source.text.get(span.clone()).and_then(|bytes| std::str::from_utf8(bytes).ok()).unwrap_or("")
    }

    fn refuse(&mut self, at: &Range<usize>, message: impl Into<String>, expected: &str) {
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
            _ => entries.push(Entry { name, key: key.span(), value }),
        }
    }
}

/// `axis.X.dynamik.a_max (P-AXIS-00008)`
fn label(table: &str, id: &str, name: &str) -> String {
    if id.is_empty() { format!("{table}.{name}") } else { format!("{table}.{name} ({id})") }
}

fn suggestion(meant: Option<&str>) -> String {
    meant.map_or_else(String::new, |name| format!("is `{name}` meant?"))
}

enum Unfit {
    Type,
    Decimals,
}

/// The value in thousandths.
fn milli(value: &DeValue<'_>, decimals: bool) -> Result<i128, Unfit> {
    match value {
        DeValue::Integer(integer) => {
            // Beyond i64 it is out of every range anyway.
            let value = i64::from_str_radix(integer.as_str(), integer.radix());
            let beyond = if integer.as_str().starts_with('-') { i64::MIN } else { i64::MAX };
            Ok(i128::from(value.unwrap_or(beyond)) * 1000)
        }
        DeValue::Float(float) if decimals => exact_milli(float.as_str()),
        _ => Err(Unfit::Type),
    }
}

/// `12.345` in thousandths, exactly; exponents and what has no value are of the wrong type.
fn exact_milli(text: &str) -> Result<i128, Unfit> {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let fraction = fraction.trim_end_matches('0');
    if fraction.len() > 3 {
        return Err(Unfit::Decimals);
    }
    let all: i128 = format!("{whole}{fraction:0<3}").parse().map_err(|_| Unfit::Type)?;
    Ok(if negative { -all } else { all })
}

/// Thousandths as a decimal.
fn thousandths(value: i64) -> String {
    if value % 1000 == 0 {
        return (value / 1000).to_string();
    }
    let mut out = String::new();
    crate::decimal::push_scaled(&mut out, i128::from(value), 3);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use glidepath::machine::{
        AccelerationUnit, Dialect, ForeignAxis, ForeignChannel, MODE_LINEAR, MODE_MASTER, SynchTable,
        ToolLengths,
    };

    #[test]
    fn the_default_file_is_the_built_in_machine() {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/machines/default.toml"));
        let loaded = load(path, &Overrides::default()).unwrap_or_else(|_| panic!("default.toml is refused"));
        assert_eq!(loaded.axes, Machine::built_in().axes);
        assert_eq!(loaded.channel, Machine::built_in().channel);
    }

    /// What becomes of a machine with these lines of the channel's path preparation.
    fn prepared(lines: &str) -> Result<Machine, Vec<Diagnostic>> {
        let name = format!("glidepath-enable-{}-{}", std::process::id(), lines.len());
        let file = std::env::temp_dir().join(name);
        let text =
            format!("[channel.configuration.path_preparation]\n{lines}\n[axis.X]\ntype = \"linear\"\n");
        std::fs::write(&file, text).expect("a file for the test");
        let machine = load(&file, &Overrides::default());
        let _ = std::fs::remove_file(&file);
        machine
    }

    /// D3-275: P-CHAN-00605, whose index 0 is P-CHAN-00600; both spellings are valid.
    /// Rows: D3-275, C40-072.
    #[test]
    fn functions_are_enabled_by_both_spellings() {
        let enabled = |lines: &str| {
            let machine = prepared(lines).unwrap_or_else(|_| panic!("refused: {lines}"));
            (machine.channel.ptp, machine.channel.surface, machine.warnings.len())
        };
        assert_eq!(enabled("function = \"FCT_DEFAULT|FCT_SURFACE\""), (false, true, 0));
        assert_eq!(enabled("fct_enable = [\"FCT_DEFAULT|FCT_SURFACE\"]"), (false, true, 0));
        assert_eq!(enabled("fct_enable = [\"FCT_DEFAULT\"]"), (false, false, 0));
        // The second mode of program start does nothing here, and that is said.
        assert_eq!(
            enabled("fct_enable = [\"FCT_DEFAULT|FCT_PTP\", \"FCT_DEFAULT|FCT_SURFACE\"]"),
            (true, false, 1)
        );
        let refused = |lines: &str| prepared(lines).err().map_or(0, |refused| refused.len());
        // Names in any order, with blanks or without.
        assert_eq!(enabled("function = \"FCT_SURFACE| FCT_PTP |FCT_DEFAULT\""), (true, true, 0));
        assert_eq!(refused("function = \"FCT_SURFACE\""), 1);
        assert_eq!(refused("function = \"FCT_DEFAULT|\""), 1);
        assert_eq!(refused("fct_enable = \"FCT_DEFAULT\""), 1);
        assert_eq!(refused("fct_enable = []"), 1);
        assert_eq!(refused("fct_enable = [\"FCT_SURFACES\"]"), 1);
        assert_eq!(refused("fct_enable = [\"FCT_DEFAULT\", \"FCT_DEFAULT\", \"FCT_DEFAULT\"]"), 1);
        assert_eq!(refused("fct_enable = [\"FCT_DEFAULT\"]\nfunction = \"FCT_DEFAULT\""), 1);
    }

    #[test]
    fn every_parameter_is_read() {
        let dir = std::env::temp_dir().join(format!("glidepath-parameters-{}", std::process::id()));
        let text = "[channel]\ndialect = \"grbl\"\nblend_tolerance = 50\nblock_delete = 1\noptional_stop = 1\ndefault_index = 6\ncycle_us = 2000\nlook_ahead = 30\ncorr_v_trans_jerk = 1\nmode_implicite_sync_indp_asyn_axis = 1\nmode_exact_stop_indp_axis = 2\noverride_weight_prog_feed = 2\ncheck_jerk_on_poly_path = 2\nmerge_chords = 40\nhsc.bspline.auto_contour_mode = 2\n\
            [channel.prog_start]\nfeedrate_factor = 0.1\nslope = { profile = 1, acceleration = 2, ramp_time = 4 }\n\
            [channel.configuration.path_preparation]\nfunction = \"FCT_DEFAULT|FCT_PTP\"\n\
            [channel.vector]\nacceleration = 500.5\ndeceleration = 400\nvelocity = 1500\nacc_dec_unit = \"MM_S2\"\n\
            cir_radial_acc_limit = 1\n[channel.m_synch]\n25 = \"MVS_SNS\"\n26 = 0x2\n3 = \"NO_SYNCH\"\n[channel.h_synch]\n7 = \"MNS_SNS\"\n[channel.tool_length]\n5 = -52.125\n[axis.X]\nnp_grp.7.versch = 7\nnp_grp.8.versch = 8\nnp_grp.9.versch = 9\ng28 = 28\ng30 = -30\n\nvb_max_red = 83_333\n\
            default_feed_axis = 1\nkenngr.achs_mode = 0x1000_0001\nnp_grp.1.versch = 100_000\nnp_grp.2.versch = -2\n\
            np_grp.3.versch = 3\nnp_grp.4.versch = 4\nnp_grp.5.versch = 5\nnp_grp.6.versch = -1_000_000_000\n[axis.X.dynamik]\na_max = 4000\n\
            r_trans_weight = 30\ntr_w_min = 20_000\n[axis.X.lslope_profil]\na_grenz_stufe_1 = 1\na_grenz_stufe_2 = 2\n\
            a_stufe_1 = 3\na_stufe_2 = 4\nd_grenz_stufe_1 = 5\nd_grenz_stufe_2 = 6\nd_stufe_1 = 7\nd_stufe_2 = 8\n\
            vb_stufe_1_2 = 9\nvb_grenz_stufe_1_2 = 10\n";
        std::fs::write(&dir, text).expect("a file for the test");
        let machine = load(&dir, &Overrides::default()).unwrap_or_else(|_| panic!("refused"));
        let _ = std::fs::remove_file(&dir);
        let name = AxisName::new("X").expect("a letter");
        let axis = AxisData {
            vb_max_red: 83_333,
            a_max: 4000,
            r_trans_weight: 30,
            tr_w_min: 20_000,
            a_grenz_stufe: [1, 2],
            a_stufe: [3, 4],
            d_grenz_stufe: [5, 6],
            d_stufe: [7, 8],
            vb_stufe_1_2: 9,
            vb_grenz_stufe_1_2: 10,
            achs_mode: MODE_LINEAR | MODE_MASTER,
            default_feed_axis: true,
            versch: [100_000, -2, 3, 4, 5, -1_000_000_000],
            foreign: ForeignAxis { versch: [7, 8, 9], stored: [28, -30] },
            ..AxisData::new(name, AxisKind::Linear)
        };
        let channel = ChannelData {
            cycle_us: 2000,
            look_ahead: 30,
            feedrate_factor_milli: 100,
            slope_profile: 1,
            acceleration_weight: 2,
            ramp_weight: 4,
            corr_v_trans_jerk: true,
            override_weight_prog_feed: 2,
            vector_acceleration_milli: 500_500,
            vector_deceleration_milli: 400_000,
            vector_velocity_milli: 1_500_000,
            vector_unit: AccelerationUnit::MmS2,
            cir_radial_acc_limit: true,
            check_jerk_on_poly_path: 2,
            merge_chords: 40,
            // In the order of the file, which TOML tables have not.
            m_synch: machine.channel.m_synch,
            h_synch: SynchTable::NONE.with(7, Synch::MnsSns),
            auto_contour_mode: 2,
            ptp: true,
            surface: false,
            joins_named: true,
            exact_stop_indp: 2,
            default_index: 6,
            foreign: ForeignChannel {
                // Chosen when the program is there.
                dialect: Dialect::Isg,
                blend_tolerance_um: 50,
                block_delete: true,
                optional_stop: true,
                tools: ToolLengths::NONE.with(5, -521_250),
            },
        };
        assert_eq!(machine.dialect, Choice::Grbl);
        let synch = [25, 26, 3, 4].map(|code| channel.m_synch.of(code));
        assert_eq!(synch, [Synch::MvsSns, Synch::MvsSvs, Synch::NoSynch, Synch::Mos]);
        assert_eq!((machine.axes, machine.channel), (vec![axis], channel));
        // What is left out has ISG's defaults.
        let default = ChannelData::new();
        let path = [default.vector_acceleration_milli, default.vector_deceleration_milli];
        assert_eq!((path, default.vector_velocity_milli), ([100_000_000_000; 2], 2_000_000_000_000));
        let stages = AxisData { a_max: 900, ..AxisData::new(name, AxisKind::Linear) }.stages(false);
        assert_eq!((stages.a, stages.d, stages.change_over), ([900; 2], [900; 2], 100_000));
        assert_eq!((axis.stages(true).d, axis.stages(true).change_over), ([5, 6], 10));
    }

    #[test]
    fn the_command_line_has_the_last_word() {
        let path = std::env::temp_dir().join(format!("glidepath-overrides-{}", std::process::id()));
        // A look-ahead beyond this simulator's memory.
        std::fs::write(&path, "[channel]\nlook_ahead = 9000\n[axis.X]\n").expect("a file for the test");
        let both = Overrides { slope: Some(3), look_ahead: Some(60) };
        let machine = load(&path, &both).unwrap_or_else(|_| panic!("refused"));
        assert_eq!((machine.channel.slope_profile, machine.channel.look_ahead), (3, 60));
        let machine = load(&path, &Overrides { slope: None, ..both }).unwrap_or_else(|_| panic!("refused"));
        assert_eq!((machine.channel.slope_profile, machine.channel.look_ahead), (0, 60));
        assert!(load(&path, &Overrides { look_ahead: None, ..both }).is_err());
        let _ = std::fs::remove_file(&path);
    }

    #[test]
    fn decimals_are_exact() {
        assert!(matches!(exact_milli("0.1"), Ok(100)));
        assert!(matches!(exact_milli("-12.3450"), Ok(-12_345)));
        assert!(matches!(exact_milli("0.0001"), Err(Unfit::Decimals)));
        assert!(matches!(exact_milli("1e3"), Err(Unfit::Type)));
    }
}
