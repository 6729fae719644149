//! Values of a machine file: exact thousandths, and the permitted range of a parameter.
use super::LOOK_AHEAD;
use crate::run::BLOCKS;
use glidepath::machine::parameter::Parameter;
use toml::de::DeValue;

/// The permitted range of a parameter.
pub struct Allowed {
    /// Range in thousandths.
    pub min: i64,
    pub max: i64,
    /// The range in words.
    pub words: String,
}

impl Allowed {
    pub fn takes(&self, milli: i128) -> bool {
        let (min, max) = (i128::from(self.min), i128::from(self.max));
        (min..=max).contains(&milli)
    }

    /// ISG's range.
    pub fn known<Target>(parameter: &Parameter<Target>) -> Self {
        // Some units are explanations.
        let unit = parameter.unit;
        let unit = if unit.contains(',') { format!("({unit})") } else { unit.to_owned() };
        let (min, max) = (parameter.min_milli, parameter.max_milli);
        let words = format!("{}…{} {unit}", thousandths(min), thousandths(max));
        Self { min, max, words }
    }

    /// The range of this simulator, which is smaller for some parameters.
    pub fn here<Target>(parameter: &Parameter<Target>) -> Self {
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

/// Reason for which a value is refused.
pub enum Unfit {
    /// No number.
    Type,
    /// More than three decimals.
    Decimals,
}

/// The value in thousandths.
pub fn milli(value: &DeValue<'_>, decimals: bool) -> Result<i128, Unfit> {
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

/// Converts `12.345` to thousandths, exactly; exponents, and text without a value, have the wrong type.
pub fn exact_milli(text: &str) -> Result<i128, Unfit> {
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
pub fn thousandths(value: i64) -> String {
    if value % 1000 == 0 {
        return (value / 1000).to_string();
    }
    let mut out = String::new();
    crate::decimal::push_scaled(&mut out, i128::from(value), 3);
    out
}

/// `axis.X.dynamik.a_max (P-AXIS-00008)`
pub fn label(table: &str, id: &str, name: &str) -> String {
    if id.is_empty() { format!("{table}.{name}") } else { format!("{table}.{name} ({id})") }
}

/// The name that may have been meant.
pub fn suggestion(meant: Option<&str>) -> String {
    meant.map_or_else(String::new, |name| format!("is `{name}` meant?"))
}
