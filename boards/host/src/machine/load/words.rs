//! Keys whose values are words, and tables by number.
use super::value::{label, milli};
use super::{Entry, FCT_ENABLE, FUNCTION, Loader};
use crate::diagnose::{Diagnostic, nearest};
use crate::dialect::Choice;
use crate::machine::Machine;
use glidepath::machine::parameter::{CHANNEL, Parameter};
use glidepath::machine::{AxisData, AxisKind, ChannelData, SYNCHRONISED, Synch, TOOLS};

/// Largest number of an M or H function.
const LAST_FUNCTION: u16 = 999;

/// Longest tool, µm.
const LONGEST_TOOL_UM: i128 = 10_000_000;

/// The bit of FAW_SYNCH.
const FAW_SYNCH: u32 = 0x1000_0000;

impl Loader<'_> {
    /// Stores `slope`, given by name. Returns `false` for another parameter name.
    pub(super) fn slope(&mut self, entry: &Entry<'_>, channel: &mut ChannelData) -> bool {
        if entry.name != "slope" {
            return false;
        }
        const NAMES: [&str; 4] = ["STEP", "TRAPEZ", "SIN2", "HSC"];
        let span = entry.value.span();
        let given = entry.value.get_ref().as_str().map(str::to_uppercase);
        match NAMES.iter().position(|name| given.as_deref() == Some(name)) {
            Some(profile) => channel.slope_profile = profile as u8,
            None => {
                let message = format!("channel.slope = {}: no such slope", self.text(&span));
                self.refuse(&span, message, "\"STEP\", \"TRAPEZ\", \"SIN2\" or \"HSC\"");
            }
        }
        true
    }

    pub(super) fn kind(&mut self, entry: &Entry<'_>, axis: &mut AxisData) {
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

    /// Stores `dialect`, or a length of `tool_length`. Returns `false` for another parameter name.
    pub(super) fn dialect(&mut self, entry: &Entry<'_>, machine: &mut Machine) -> bool {
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

    /// Stores a function of `m_synch` or `h_synch`. Returns `false` for another parameter name.
    pub(super) fn synch(&mut self, entry: &Entry<'_>, channel: &mut ChannelData) -> bool {
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
        // FAW_SYNCH is combined with another kind.
        let faw = i128::from(FAW_SYNCH);
        let (word, number, flushes) = match (value.as_str(), number) {
            (Some(word), _) => match word.split_once('|').map(|(one, other)| (one.trim(), other.trim())) {
                Some((one, "FAW_SYNCH") | ("FAW_SYNCH", one)) => (Some(one), None, true),
                _ => (Some(word), None, false),
            },
            (None, Some(bits)) if bits > faw && bits & faw != 0 => (None, Some(bits & !faw), true),
            (None, number) => (None, number, false),
        };
        let meant =
            Synch::ALL.iter().find(|(_, name, bits)| word == Some(name) || number == Some(i128::from(*bits)));
        let here: Vec<&str> =
            Synch::ALL.iter().filter(|(synch, ..)| synch.is_available()).map(|(_, name, _)| *name).collect();
        let here = here.join(", ");
        match meant {
            Some((Synch::FawSynch, ..)) => {
                let message = format!("{label} = FAW_SYNCH: beside no other synchronisation");
                self.refuse(&span, message, &format!("MOS|FAW_SYNCH, or another one of {here}"));
            }
            Some((synch, ..)) if synch.is_available() && flushes => *synchs = synchs.with_flush(code, *synch),
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

    /// P-CHAN-00605: functions of the channel, one text per mode of program start (P-CHAN-00606). Programs
    /// start in the first mode. Returns `false` for another parameter name.
    pub(super) fn enable(
        &mut self,
        entry: &Entry<'_>,
        entries: &[Entry<'_>],
        channel: &mut ChannelData,
    ) -> bool {
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
            let text = Entry { name, key: value.span(), value, plain: None };
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
    pub(super) fn set_word<Target>(
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
}
