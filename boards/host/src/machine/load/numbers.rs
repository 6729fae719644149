//! Keys whose values are numbers, and ranges that depend on other keys.
use super::value::{Unfit, label, milli, suggestion, thousandths};
use super::{Entry, Loader};
use crate::diagnose::{Diagnostic, nearest};
use crate::machine::{plain, steps};
use glidepath::machine::parameter::{AXIS, Parameter, check_axis, check_given_stages};
use glidepath::machine::{Adjusted, AxisData, ChannelData};
use glidepath_steps::AxisSteps;
use toml::Spanned;

impl Loader<'_> {
    /// A key of the step output.
    pub(super) fn steps(&mut self, table: &str, entry: &Entry<'_>, output: &mut AxisSteps) {
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

    /// Finds a parameter, checks type and range, and stores the value.
    pub(super) fn set<Target>(
        &mut self,
        table: &str,
        entry: &Entry<'_>,
        known: &[Parameter<Target>],
        later: &[(&'static str, &'static str)],
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
                let names = names.chain(plain::names());
                let names: Vec<&str> = names.chain(["type"]).collect();
                // The last part of a name is often right although the table is wrong.
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
        let range = &match entry.plain {
            None => allowed.words.clone(),
            Some((_, scale)) => {
                format!("{}…{}", thousandths(allowed.min / scale), thousandths(allowed.max / scale))
            }
        };
        let kind = if parameter.decimals || entry.plain.is_some() { "a number" } else { "an integer" };
        let label = match entry.plain {
            None => label(table, parameter.id, name),
            Some((plain, _)) => format!("{table}.{plain}, which is {name} ({})", parameter.id),
        };
        let text = self.text(&entry.value.span()).to_owned();
        let scale = entry.plain.map_or(1, |(_, scale)| i128::from(scale));
        let value = milli(entry.value.get_ref(), parameter.decimals || entry.plain.is_some());
        match value.map(|value| value * scale) {
            Ok(value) if !parameter.decimals && value % 1000 != 0 => {
                let message = format!("{label} = {text}: too many decimals");
                self.refuse(&entry.value.span(), message, &format!("an integer, {range}"));
            }
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

    /// Ranges that depend on other parameters, which may be defaults.
    pub(super) fn check(
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

    /// Values that the planner replaces.
    pub(super) fn remark(
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
}
