//! Transformations in a machine file: `kinematik_id` (P-CHAN-00032) and `[[channel.trafo]]`.
use super::load::{Entry, Loader};
use crate::machine::{Machine, with_axes};
use glidepath::kinematics::{CaHead, Chain, DataError, Kinematic, Unfit, Universal, UniversalAxis};
use glidepath::machine::MachineData;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The data sets of a machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Kinematics {
    /// P-CHAN-00032; 0 for none.
    pub default_id: u16,
    /// Identifier and chain of each data set.
    pub sets: Vec<(u16, Chain)>,
}

impl Kinematics {
    /// Returns the data sets for a machine.
    pub fn fitted<const AXES: usize>(&self, data: &MachineData<AXES>) -> Vec<Kinematic> {
        self.sets.iter().filter_map(|(id, chain)| Kinematic::new(*id, chain, data).ok()).collect()
    }

    /// Returns the chain with an identifier.
    pub fn chain(&self, id: u16) -> Option<&Chain> {
        self.sets.iter().find(|(own, _)| *own == id).map(|(_, chain)| chain)
    }

    /// Returns the chain for the position of the tool: the default, or the first one.
    pub fn usual(&self) -> Option<&Chain> {
        self.chain(self.default_id).or(self.sets.first().map(|(_, chain)| chain))
    }
}

fn unfit<const AXES: usize>(machine: &Machine, id: u16, chain: &Chain) -> Option<Unfit> {
    let data = machine.data::<AXES>()?;
    Kinematic::new(id, chain, &data).err()
}

/// Keys of a data set: id, name, and the types that have the key.
const KEYS: [(&str, &str); 10] = [
    ("P-CHAN-00262", "id"),
    ("P-CHAN-00829", "type"),
    ("P-CHAN-00263", "param"),
    ("P-CHAN-00289", "number_of_axes"),
    ("P-CHAN-00290", "chain"),
    ("P-CHAN-00291", "axis"),
    ("P-CHAN-00285", "zero_orientation"),
    ("P-CHAN-00286", "zero_position"),
    ("P-CHAN-00287", "rtcp"),
    ("P-CHAN-00288", "programming_mode"),
];

/// Types of transformations that exist.
const CA_HEAD: i64 = 9;
const UNIVERSAL: i64 = 91;

/// Highest number of axes in a chain.
const AXES: usize = 6;

/// A data set while it is read.
struct Set {
    id: i64,
    kind: i64,
    param: [i32; 9],
    universal: Universal,
}

impl Loader<'_> {
    /// Stores `kinematik_id` or `trafo`. Returns `false` for another parameter name.
    pub(super) fn kinematics(&mut self, entry: &Entry<'_>, machine: &mut Machine) -> bool {
        match entry.name.as_str() {
            "kinematik_id" => {
                let id = self.whole(entry.value, "channel.kinematik_id (P-CHAN-00032)", 0, 65_535);
                machine.kinematics.default_id = id.unwrap_or(0) as u16;
            }
            "trafo" => match entry.value.get_ref() {
                DeValue::Array(sets) => {
                    for (index, set) in sets.iter().enumerate() {
                        self.data_set(index, set, machine);
                    }
                }
                _ => self.refuse(&entry.key, "channel.trafo stands for data sets", "[[channel.trafo]]"),
            },
            _ => return false,
        }
        true
    }

    /// Reports data sets that do not fit the axes, after all axes are known.
    pub(super) fn fit_kinematics(&mut self, at: &Range<usize>, machine: &Machine) {
        for (index, (id, chain)) in machine.kinematics.sets.iter().enumerate() {
            let message = |why: &str| format!("channel.trafo[{index}]: {why}");
            if let Some(unfit) = with_axes!(machine, unfit(machine, *id, chain)) {
                let told = unfit.to_string();
                let (why, expected) = told.split_once("; expected ").unwrap_or((&told, ""));
                self.refuse(at, message(why), expected);
            }
            if machine.kinematics.sets.iter().take(index).any(|(other, _)| other == id) {
                self.refuse(at, message(&format!("id = {id} is there already")), "each id once");
            }
        }
        let default = machine.kinematics.default_id;
        if default != 0 && machine.kinematics.chain(default).is_none() {
            let message = format!("channel.kinematik_id (P-CHAN-00032) = {default}: no such data set");
            self.refuse(at, message, "the id of a [[channel.trafo]]");
        }
    }

    fn data_set(&mut self, index: usize, value: &Spanned<DeValue<'_>>, machine: &mut Machine) {
        let DeValue::Table(table) = value.get_ref() else {
            self.refuse(
                &value.span(),
                format!("channel.trafo[{index}] stands for a table"),
                "[[channel.trafo]]",
            );
            return;
        };
        let before = self.refused.len();
        let set = self.keys(index, table);
        if self.refused.len() > before {
            return;
        }
        // 0: the identifier is the type.
        let made = match if set.kind == 0 { set.id } else { set.kind } {
            CA_HEAD => Chain::ca_head(&CaHead { param: set.param }),
            UNIVERSAL => Chain::universal(&set.universal),
            other => {
                let message =
                    format!("channel.trafo[{index}].type (P-CHAN-00829) = {other}: no such type here");
                self.refuse(&value.span(), message, "9 (CA head) or 91 (universal)");
                return;
            }
        };
        match made {
            Ok(chain) => machine.kinematics.sets.push((set.id as u16, chain)),
            Err(error) => {
                let at = place_of(&error, table).unwrap_or(value.span());
                let told = error.to_string();
                let (what, expected) = told.rsplit_once(": expected ").unwrap_or((&told, ""));
                self.refuse(&at, format!("channel.trafo[{index}]: {what}"), expected);
            }
        }
    }

    fn keys(&mut self, index: usize, table: &DeTable<'_>) -> Set {
        let none = UniversalAxis { kind: 0, orientation: [0.0; 3], point: [0; 3] };
        let mut set = Set {
            id: 0,
            kind: 0,
            param: [0; 9],
            universal: Universal {
                number_of_axes: 0,
                chain: [0; AXES],
                axis: [none; AXES],
                zero_orientation: [0.0, 0.0, 1.0],
                zero_position: [0; 3],
            },
        };
        for (key, value) in table {
            let name = key.get_ref().as_ref();
            let Some((id, _)) = KEYS.iter().find(|(_, known)| *known == name) else {
                let meant = crate::diagnose::nearest(name, KEYS.map(|(_, name)| name));
                let expected = meant.map_or_else(String::new, |meant| format!("is `{meant}` meant?"));
                self.refuse(
                    &key.span(),
                    format!("unknown parameter channel.trafo[{index}].{name}"),
                    &expected,
                );
                continue;
            };
            let label = format!("channel.trafo[{index}].{name} ({id})");
            let universal = &mut set.universal;
            match name {
                "id" => set.id = self.whole(value, &label, 1, 65_535).unwrap_or(0),
                "type" => set.kind = self.whole(value, &label, 0, 65_535).unwrap_or(0),
                "param" => self.wholes(value, &label, &mut set.param),
                "number_of_axes" => {
                    universal.number_of_axes = self.whole(value, &label, 3, 6).unwrap_or(0) as u8;
                }
                "chain" => {
                    let mut chain = [0; AXES];
                    self.wholes(value, &label, &mut chain);
                    universal.chain = chain.map(|axis| u8::try_from(axis).unwrap_or(u8::MAX));
                }
                "zero_orientation" => self.numbers(value, &label, &mut universal.zero_orientation),
                "zero_position" => self.wholes(value, &label, &mut universal.zero_position),
                "axis" => self.chain_axes(value, &label, &mut universal.axis),
                _ => {
                    let message = format!("{label} is known, not available in this version");
                    self.refuse(&key.span(), message, "leave it out");
                }
            }
        }
        if set.id == 0 {
            let message = format!("channel.trafo[{index}]: the id (P-CHAN-00262) is missing");
            let at = table.iter().next().map_or(0..0, |(key, _)| key.span());
            self.refuse(&at, message, "id = 1…65535");
        }
        set
    }

    /// The axes of a chain.
    fn chain_axes(&mut self, value: &Spanned<DeValue<'_>>, label: &str, axes: &mut [UniversalAxis; AXES]) {
        let Some(given) = value.get_ref().as_array().filter(|given| given.len() <= AXES) else {
            let expected = "at most six tables, for example { type = 1, orientation = [1, 0, 0] }";
            self.refuse(&value.span(), format!("{label}: a wrong type of value"), expected);
            return;
        };
        for (k, (axis, value)) in axes.iter_mut().zip(given).enumerate() {
            let DeValue::Table(table) = value.get_ref() else {
                let expected = "{ type = 1, orientation = [1, 0, 0] }";
                self.refuse(&value.span(), format!("{label}[{k}] stands for a table"), expected);
                continue;
            };
            for (key, value) in table {
                let name = key.get_ref().as_ref();
                let label = format!("{label}[{k}].{name}");
                match name {
                    "type" => axis.kind = self.whole(value, &label, 1, 2).unwrap_or(0) as u8,
                    "orientation" => self.numbers(value, &label, &mut axis.orientation),
                    "point" => self.wholes(value, &label, &mut axis.point),
                    _ => {
                        let message = format!("unknown parameter {label}");
                        self.refuse(&key.span(), message, "type, orientation or point");
                    }
                }
            }
        }
    }

    /// A whole number.
    fn whole(&mut self, value: &Spanned<DeValue<'_>>, label: &str, least: i64, most: i64) -> Option<i64> {
        let number = integer(value.get_ref()).filter(|x| (least..=most).contains(x));
        if number.is_none() {
            let message = format!("{label} = {}: out of range", self.text(&value.span()));
            self.refuse(&value.span(), message, &format!("an integer, {least}…{most}"));
        }
        number
    }

    /// Whole numbers, in 0.1 µm or 10^-4 degree; values that are left out keep their defaults.
    fn wholes(&mut self, value: &Spanned<DeValue<'_>>, label: &str, into: &mut [i32]) {
        let given = value.get_ref().as_array();
        let numbers: Option<Vec<i32>> = given.filter(|given| given.len() <= into.len()).and_then(|given| {
            given.iter().map(|x| integer(x.get_ref()).and_then(|x| i32::try_from(x).ok())).collect()
        });
        match numbers {
            Some(numbers) => into.iter_mut().zip(numbers).for_each(|(into, x)| *into = x),
            None => {
                let message = format!("{label} = {}: a wrong type of value", self.text(&value.span()));
                self.refuse(&value.span(), message, &format!("at most {} integers in brackets", into.len()));
            }
        }
    }

    /// A vector.
    fn numbers(&mut self, value: &Spanned<DeValue<'_>>, label: &str, into: &mut [f64; 3]) {
        let given = value.get_ref().as_array();
        let numbers: Option<Vec<f64>> =
            given.and_then(|given| given.iter().map(|x| number(x.get_ref())).collect());
        match numbers.as_deref() {
            Some([x, y, z]) => *into = [*x, *y, *z],
            _ => {
                let message = format!("{label} = {}: a wrong type of value", self.text(&value.span()));
                self.refuse(&value.span(), message, "three numbers in brackets");
            }
        }
    }
}

/// Place of the key that an error names.
fn place_of(error: &DataError, table: &DeTable<'_>) -> Option<Range<usize>> {
    let key = table.iter().find(|(key, _)| {
        let name = key.get_ref().as_ref();
        error.parameter.split(['.', '[']).any(|part| part == name)
    });
    key.map(|(_, value)| value.span())
}

fn integer(value: &DeValue<'_>) -> Option<i64> {
    let DeValue::Integer(integer) = value else { return None };
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        other => integer(other).map(|x| x as f64),
    }
}
