//! Variables V.E. of a run: names and first values from machine data, command line and the file of `--plc`.
use crate::machine::Machine;
use glidepath::variable::{Access, Variable};

/// The name of a variable as the library has it: without `V.E.` in front. Names live as long as the process.
///
/// # Errors
/// The expected text.
pub fn name(text: &str) -> Result<&'static str, String> {
    let short = match text.get(..4) {
        Some(front) if front.eq_ignore_ascii_case("V.E.") => &text[4..],
        _ => text,
    };
    let fits = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.');
    if (1..=63).contains(&short.len()) && short.chars().all(fits) {
        Ok(short.to_owned().leak())
    } else {
        Err("the name of a variable V.E.: letters, digits, _ and ., at most 63".into())
    }
}

/// A value.
pub fn value(text: &str) -> Option<f64> {
    match text {
        "TRUE" | "true" => Some(1.0),
        "FALSE" | "false" => Some(0.0),
        _ => text.parse().ok().filter(|value: &f64| value.is_finite()),
    }
}

/// `NAME=VALUE` of the command line.
///
/// # Errors
/// The expected text.
pub fn parse(text: &str) -> Result<(&'static str, f64), String> {
    let (left, right) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    let value = value(right).ok_or("expected a number, TRUE or FALSE behind =")?;
    Ok((name(left).map_err(|expected| format!("expected {expected}"))?, value))
}

/// All variables of a run: those of the machine data and the command line, with the last value of each, then
/// those that only `--plc` names, with the value 0.
pub fn all(machine: &Machine, script: Option<&super::Script>) -> Vec<Variable> {
    let mut first: Vec<(&'static str, f64)> = Vec::new();
    let named = script.into_iter().flat_map(super::Script::variables).map(|name| (name, None));
    for (name, value) in machine.variables.iter().map(|&(name, value)| (name, Some(value))).chain(named) {
        match first.iter_mut().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
            Some((_, known)) => *known = value.unwrap_or(*known),
            None => first.push((name, value.unwrap_or(0.0))),
        }
    }
    let made = first.into_iter().map(|(name, value)| {
        let variable = Variable::new(name, Access::ReadWrite);
        variable.set(value);
        variable
    });
    made.collect()
}

/// The variable with that name.
pub fn find<'a>(variables: &'a [Variable], name: &str) -> Option<&'a Variable> {
    variables.iter().find(|variable| variable.name().eq_ignore_ascii_case(name))
}
