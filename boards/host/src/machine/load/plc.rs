//! Machine data of the interpolator's functions for a PLC, under their names in the channel list and the
//! start-up list.
use super::value::milli;
use super::{Diagnostic, Entry, LOOK_AHEAD, Loader, flatten, label, suggestion};
use crate::diagnose::nearest;
use crate::plc;
use glidepath::machine::parameter::{CHANNEL_PLC, Parameter};
use glidepath::machine::{
    ChannelData, FB_STORAGE_MIN, INTERPOLATOR_FUNCTIONS, InterpolatorFunctions, SHIFT_MAX, SYNCHRONISED,
};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// P-CHAN-00650 with its old key, and P-CHAN-00658.
const INTERPOLATOR: &str = "configuration.interpolator.";
const FUNCTION: &str = "function";
const FCT_ENABLE: &str = "fct_enable";
const LOG_MAX: &str = "contour_lookahead_log_max";

/// P-STUP-00070 and P-STUP-00076 are in this table.
const START_UP: &str = "configuration.channel.0.interpolator.";
const STORAGE: &str = "fb_storage_size";
const LATE: &str = "prog_start.late_sync_ready";

/// Channels of a start-up list.
const CHANNELS: usize = 12;

fn parameter(id: &str) -> &'static Parameter<ChannelData> {
    // A parameter of the table, named in this file.
    CHANNEL_PLC.iter().find(|parameter| parameter.id == id).unwrap_or(&CHANNEL_PLC[0])
}

/// Whether the file has a parameter of the channel whose name begins with this text.
fn has(document: &Spanned<DeTable<'_>>, leaves: &[&str]) -> bool {
    let Some(DeValue::Table(channel)) = document.get_ref().get("channel").map(Spanned::get_ref) else {
        return false;
    };
    let mut entries = Vec::new();
    flatten(channel, "", &mut entries);
    let leaf = |entry: &Entry<'_>| entry.name.strip_prefix(INTERPOLATOR).map(str::to_owned);
    entries.iter().filter_map(leaf).any(|name| leaves.contains(&name.as_str()))
}

impl Loader<'_> {
    /// Stores a parameter of the interpolator in the table `channel`. Returns `false` for another parameter
    /// name.
    pub(super) fn interpolator(
        &mut self,
        entry: &Entry<'_>,
        entries: &[Entry<'_>],
        channel: &mut ChannelData,
    ) -> bool {
        let Some(leaf) = entry.name.strip_prefix(INTERPOLATOR) else { return false };
        let given = |leaf: &str| entries.iter().any(|entry| entry.name == format!("{INTERPOLATOR}{leaf}"));
        let sized = entries.iter().any(|entry| entry.name == LOOK_AHEAD);
        let at = ("channel", "P-CHAN-00650", entry.name.as_str());
        match leaf {
            FUNCTION => self.functions(at, entry.value, sized, channel),
            FCT_ENABLE if given(FUNCTION) => {
                let message =
                    format!("{}: its first text is `function`, which is given too", label(at.0, at.1, at.2));
                self.refuse(&entry.key, message, "leave one of both out");
            }
            FCT_ENABLE => match entry.value.get_ref().as_array().map(|texts| (texts.first(), texts.len())) {
                Some((Some(text), 1)) => self.functions(at, text, sized, channel),
                _ => {
                    let message = format!("{} = {}", label(at.0, at.1, at.2), self.text(&entry.value.span()));
                    let expected = "one text: [\"FCT_IPO_DEFAULT|FCT_CONTOUR_LAH\"]";
                    self.refuse(&entry.value.span(), format!("{message}: a wrong type of value"), expected);
                }
            },
            LOG_MAX => self.set("channel", entry, CHANNEL_PLC, &[], channel),
            _ => {
                let meant = nearest(leaf, [FUNCTION, FCT_ENABLE, LOG_MAX]);
                let meant = meant.map(|leaf| format!("{INTERPOLATOR}{leaf}"));
                let message = format!("unknown parameter channel.{}", entry.name);
                self.refuse(&entry.key, message, &suggestion(meant.as_deref()));
            }
        }
        true
    }

    /// How far before its place a function comes out, and P-CHAN-00033; `false` if the name is another.
    pub(super) fn shift(&mut self, entry: &Entry<'_>, channel: &mut ChannelData) -> bool {
        if entry.name == LATE {
            self.set("channel", entry, CHANNEL_PLC, &[], channel);
            return true;
        }
        let (table, number) = entry.name.split_once('.').unwrap_or((&entry.name, ""));
        let (id, synchs) = match table {
            "m_pre_outp" => ("P-CHAN-00070", &mut channel.m_synch),
            "h_pre_outp" => ("P-CHAN-00107", &mut channel.h_synch),
            _ => return false,
        };
        let label = format!("channel.{table}[{number}] ({id})");
        let Some(code) = number.parse::<u16>().ok().filter(|code| *code <= 999) else {
            let message = format!("{label}: no number of a function");
            self.refuse(
                &entry.key,
                message,
                &format!("0…999, for example [channel.{table}] with 96 = 100000"),
            );
            return true;
        };
        let span = entry.value.span();
        let shift = milli(entry.value.get_ref(), false).ok().filter(|milli| milli % 1000 == 0);
        let shift =
            shift.and_then(|milli| u32::try_from(milli / 1000).ok()).filter(|shift| *shift <= SHIFT_MAX);
        let Some(shift) = shift else {
            let message = format!("{label} = {}: no distance", self.text(&span));
            self.refuse(&span, message, &format!("0…{SHIFT_MAX}, in 0.1 µm"));
            return true;
        };
        *synchs = synchs.with_shift(code, shift);
        if synchs.overflows() {
            let message = format!("{label}: more than {SYNCHRONISED} functions");
            self.refuse(&entry.key, message, "leave out those of MOS: it is the default");
        }
        true
    }

    /// A parameter of the table `startup`.
    pub(super) fn start_up(
        &mut self,
        entry: &Entry<'_>,
        document: &Spanned<DeTable<'_>>,
        channel: &mut ChannelData,
    ) {
        let twice = |leaves: &[&str]| has(document, leaves);
        let sized = matches!(document.get_ref().get("channel").map(Spanned::get_ref),
            Some(DeValue::Table(channel)) if channel.contains_key(LOOK_AHEAD));
        match entry.name.as_str() {
            STORAGE => self.storage(entry.value, channel),
            name => match name.strip_prefix(START_UP) {
                Some(FUNCTION) if !twice(&[FUNCTION, FCT_ENABLE]) => {
                    self.functions(("startup", "P-STUP-00070", name), entry.value, sized, channel);
                }
                Some(LOG_MAX) if !twice(&[LOG_MAX]) => {
                    let of = Parameter { id: "P-STUP-00076", name: LOG_MAX, ..*parameter("P-CHAN-00658") };
                    let named = Entry {
                        name: LOG_MAX.into(),
                        key: entry.key.clone(),
                        value: entry.value,
                        plain: None,
                    };
                    let table = format!("startup.{}", START_UP.trim_end_matches('.'));
                    self.set(&table, &named, &[of], &[], channel);
                }
                Some(leaf @ (FUNCTION | LOG_MAX)) => {
                    let message = format!("startup.{name}: channel.{INTERPOLATOR}{leaf} is given too");
                    self.refuse(&entry.key, message, "leave one of both out");
                }
                _ => {
                    let names = [FUNCTION, LOG_MAX].map(|leaf| format!("{START_UP}{leaf}"));
                    let names = names.iter().map(String::as_str).chain([STORAGE]);
                    let message = format!("unknown parameter startup.{name}");
                    self.refuse(&entry.key, message, &suggestion(nearest(name, names)));
                }
            },
        }
    }

    /// Names of P-CHAN-00650. `sized`: P-CHAN-00653 is given.
    fn functions(
        &mut self,
        (table, id, name): (&str, &str, &str),
        value: &Spanned<DeValue<'_>>,
        sized: bool,
        channel: &mut ChannelData,
    ) {
        let (span, label) = (value.span(), label(table, id, name));
        let Some(given) = value.get_ref().as_str() else {
            let message = format!("{label} = {}: a wrong type of value", self.text(&span));
            self.refuse(&span, message, "a text: \"FCT_IPO_DEFAULT|FCT_CONTOUR_LAH\"");
            return;
        };
        let mut bits = 0;
        for word in given.split('|').map(str::trim) {
            let Some(bit) = INTERPOLATOR_FUNCTIONS.iter().position(|name| *name == word) else {
                let meant = nearest(word, INTERPOLATOR_FUNCTIONS.iter().copied());
                let meant = meant.map_or_else(String::new, |name| format!("; is {name} meant?"));
                let expected = format!("{}, joined by |{meant}", INTERPOLATOR_FUNCTIONS.join(", "));
                self.refuse(&span, format!("{label}: unknown word \"{word}\""), &expected);
                return;
            };
            bits |= 1 << bit;
        }
        let functions = InterpolatorFunctions::of_bits(bits);
        if let Some((said, expected)) = functions.refused() {
            self.refuse(&span, format!("{label} = \"{given}\": {said}"), expected);
            return;
        }
        if sized && functions.look_ahead().is_some() {
            let message = format!("{label} = \"{given}\": look_ahead (P-CHAN-00653) is given too");
            self.refuse(&span, message, "FCT_LOOK_AHEAD_CUSTOM, or no look_ahead");
            return;
        }
        (parameter("P-CHAN-00650").set)(channel, i64::from(bits) * 1000);
    }

    /// P-STUP-00033: a number of bytes, or one for each channel. This is channel 0.
    fn storage(&mut self, value: &Spanned<DeValue<'_>>, channel: &mut ChannelData) {
        let span = value.span();
        let label = label("startup", "P-STUP-00033", STORAGE);
        let all: Vec<&Spanned<DeValue<'_>>> = match value.get_ref() {
            DeValue::Array(all) => all.iter().collect(),
            _ => vec![value],
        };
        let bytes = all.iter().map(|value| milli(value.get_ref(), false).ok().map(|milli| milli / 1000));
        let bytes: Option<Vec<u32>> = bytes.map(|bytes| u32::try_from(bytes?).ok()).collect();
        let Some((Some(first), others)) =
            bytes.filter(|bytes| bytes.len() <= CHANNELS).map(|b| (b.first().copied(), b.len() - 1))
        else {
            let message = format!("{label} = {}: not so many bytes", self.text(&span));
            let expected = format!("0…4294967295 bytes, or a list of them for up to {CHANNELS} channels");
            self.refuse(&span, message, &expected);
            return;
        };
        if others > 0 {
            self.warn(&span, format!("{label}: only channel 0 is there"), "one number of bytes");
        }
        let used = if first == 0 { 0 } else { first.max(FB_STORAGE_MIN) };
        if used != first {
            let message = format!("{label} = {first}: too small, {used} bytes are used");
            self.warn(&span, message, &format!("0, or {FB_STORAGE_MIN} bytes and more"));
        }
        (parameter("P-STUP-00033").set)(channel, i64::from(used) * 1000);
    }

    /// A variable V.E. with its first value, in the table `variables`.
    pub(super) fn variable(&mut self, entry: &Entry<'_>, variables: &mut Vec<(&'static str, f64)>) {
        let name = match plc::name(&entry.name) {
            Ok(name) => name,
            Err(expected) => {
                self.refuse(
                    &entry.key,
                    format!("variables.{}: no name of a variable", entry.name),
                    &expected,
                );
                return;
            }
        };
        if variables.iter().any(|(known, _)| known.eq_ignore_ascii_case(name)) {
            let expected = "a name once: upper and lower case are the same";
            self.refuse(&entry.key, format!("variables.{name} is given twice"), expected);
            return;
        }
        let value = match entry.value.get_ref() {
            DeValue::Boolean(on) => Some(f64::from(u8::from(*on))),
            DeValue::Integer(number) if number.radix() == 10 => number.as_str().parse().ok(),
            DeValue::Float(number) => number.as_str().parse().ok(),
            _ => None,
        };
        match value.filter(|value: &f64| value.is_finite()) {
            Some(value) => variables.push((name, value)),
            None => {
                let span = entry.value.span();
                let message = format!("variables.{name} = {}: a wrong type of value", self.text(&span));
                self.refuse(&span, message, "a number, true or false");
            }
        }
    }

    fn warn(&mut self, at: &Range<usize>, message: String, expected: &str) {
        let (line, column) = self.source.position(at.start);
        let warning = Diagnostic::warning(message).at(self.source, line, column, at.len());
        self.warnings.push(warning.expected(expected));
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Overrides, load};
    use crate::diagnose::Diagnostic;
    use crate::machine::Machine;
    use glidepath::machine::InterpolatorFunctions as Functions;

    fn loaded(lines: &str) -> Result<Machine, Vec<Diagnostic>> {
        use std::hash::{BuildHasher, RandomState};
        let number = RandomState::new().hash_one(lines);
        let file = std::env::temp_dir().join(format!("glidepath-plc-{}-{number}", std::process::id()));
        std::fs::write(&file, format!("{lines}\n[axis.X]\ntype = \"linear\"\n"))
            .expect("a file for the test");
        let machine = load(&file, &Overrides::default());
        let _ = std::fs::remove_file(&file);
        machine
    }

    fn good(lines: &str) -> Machine {
        loaded(lines).unwrap_or_else(|_| panic!("refused: {lines}"))
    }

    /// The only message of a refused file.
    fn refused(lines: &str) -> String {
        let told = loaded(lines).err().unwrap_or_else(|| panic!("taken: {lines}"));
        assert_eq!(told.len(), 1, "{lines}");
        anstream::adapter::strip_str(&told[0].render()).to_string()
    }

    fn named(names: &str) -> String {
        format!("[channel.configuration.interpolator]\nfunction = \"{names}\"")
    }

    /// P-CHAN-00650 names the size of the look-ahead. Rows: C40-055, C40-056, C40-057, C40-058, C40-059, C40-060.
    #[test]
    fn names_of_the_look_ahead_are_its_sizes() {
        for (names, blocks) in [
            ("FCT_IPO_DEFAULT", 120),
            ("FCT_LOOK_AHEAD_STANDARD", 120),
            ("FCT_LOOK_AHEAD_LOW", 30),
            ("FCT_LOOK_AHEAD_HIGH", 190),
            ("FCT_CONTOUR_LAH|FCT_LOOK_AHEAD_HIGH", 190),
        ] {
            assert_eq!(good(&named(names)).channel.look_ahead, blocks, "{names}");
        }
        let channel = good("").channel;
        assert_eq!((channel.look_ahead, channel.interpolator.functions), (120, Functions::IPO_DEFAULT));
        let custom = |blocks: u32| {
            format!(
                "[channel]\nlook_ahead = {blocks}\nconfiguration.interpolator.function = \"FCT_LOOK_AHEAD_CUSTOM\""
            )
        };
        assert_eq!(good(&custom(10)).channel.look_ahead, 10);
        assert_eq!(good(&custom(333)).channel.look_ahead, 333);
        assert!(refused(&custom(9)).contains("10…"), "{}", refused(&custom(9)));
        let both = refused(&custom(50).replace("CUSTOM", "LOW"));
        assert!(both.contains("FCT_LOOK_AHEAD_CUSTOM"), "{both}");
        assert!(refused(&named("FCT_IPO_DEFAULT|FCT_LOOK_AHEAD_LOW")).contains("two sizes"));
        assert!(refused(&named("FCT_CONTOUR_LAH")).contains("no size"));
    }

    /// Names are joined by a bar, in any order; both keys; the start-up list. Rows: C40-004, C40-055, C40-067,
    /// C40-072, C40-073, CF-29.
    #[test]
    fn names_are_joined_by_a_bar_under_every_key() {
        let wanted = Functions::IPO_DEFAULT.with(Functions::CONTOUR_LAH).with(Functions::CALC_TIME);
        let names = "FCT_CALC_TIME | FCT_IPO_DEFAULT|FCT_CONTOUR_LAH";
        let start_up = "[startup.configuration.channel.0.interpolator]\n";
        for lines in [
            named(names),
            format!("[channel.configuration.interpolator]\nfct_enable = [\"{names}\"]"),
            format!("{start_up}function = \"{names}\""),
        ] {
            assert_eq!(good(&lines).channel.interpolator.functions, wanted, "{lines}");
        }
        assert_eq!(good("").channel.interpolator.log_max, 128);
        for max in [0, 1, 128, u32::MAX] {
            let lines = format!("contour_lookahead_log_max = {max}");
            let channel = good(&format!("[channel.configuration.interpolator]\n{lines}")).channel;
            assert_eq!(channel.interpolator.log_max, max);
            assert_eq!(good(&format!("{start_up}{lines}")).channel.interpolator.log_max, max);
        }
        let said = refused("[channel.configuration.interpolator]\ncontour_lookahead_log_max = 4294967296");
        assert!(said.contains("P-CHAN-00658") && said.contains("0…4294967295"), "{said}");
        let said = refused(&format!("{start_up}contour_lookahead_log_max = -1"));
        assert!(said.contains("P-STUP-00076"), "{said}");
        let twice = format!("{}\n{start_up}function = \"FCT_IPO_DEFAULT\"", named(names));
        assert!(refused(&twice).contains("given too"), "{}", refused(&twice));
        for wrong in [
            "function = 1",
            "fct_enable = []",
            "functoin = \"FCT_IPO_DEFAULT\"",
            "function = \"FCT_CALCTIME\"",
        ] {
            let said = refused(&format!("[channel.configuration.interpolator]\n{wrong}"));
            assert!(said.contains("FCT_IPO_DEFAULT") || said.contains("meant?"), "{said}");
        }
    }

    /// Functions that this version does not have are refused by name. Rows: C40-063, C40-069, C40-071.
    #[test]
    fn absent_functions_are_refused_by_name() {
        for name in ["FCT_LIFT_UP_TIME", "FCT_EXTENSION_EQUIDIST", "FCT_DLM", "FCT_SYNC"] {
            let said = refused(&named(&format!("FCT_IPO_DEFAULT|{name}")));
            assert!(said.contains(&format!("\": {name}")), "{said}");
            assert!(said.contains("known, not available in this version"), "{said}");
        }
    }

    /// P-STUP-00033: 0 is none; what is too small is raised, and that is said. Rows: C40-054, C40-008.
    #[test]
    fn a_small_storage_is_raised() {
        for (size, bytes, warnings) in [
            ("0", 0, 0),
            ("1", 1024, 1),
            ("1023", 1024, 1),
            ("1024", 1024, 0),
            ("4294967295", u32::MAX, 0),
            ("[5000]", 5000, 0),
            ("[5000, 0, 7]", 5000, 1),
        ] {
            let machine = good(&format!("[startup]\nfb_storage_size = {size}"));
            // The file has no slope, so a warning about the slope comes too.
            let told = machine.warnings.iter().filter(|told| told.render().contains("P-STUP-00033"));
            let got = (machine.channel.interpolator.fb_storage_size, told.count());
            assert_eq!(got, (bytes, warnings), "{size}");
        }
        assert_eq!(good("").channel.interpolator.fb_storage_size, 0);
        for size in ["-1", "4294967296", "1.5", "\"1\"", "[]", "[0,0,0,0,0,0,0,0,0,0,0,0,0]"] {
            let said = refused(&format!("[startup]\nfb_storage_size = {size}"));
            assert!(said.contains("P-STUP-00033"), "{said}");
        }
        assert!(refused("[startup]\nfb_storage = 1").contains("fb_storage_size"));
    }
}
