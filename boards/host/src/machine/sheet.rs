//! Writes a machine file as TOML, with a comment at each value.
use super::words;
use glidepath::machine::parameter::{AXIS, CHANNEL, Parameter};

/// A value and its origin.
#[derive(Clone, Debug)]
pub struct Taken {
    /// Value in the unit of its field.
    pub value: f64,
    /// Text of the comment.
    pub from: String,
}

impl Taken {
    /// A value with its origin.
    pub fn new(value: f64, from: impl Into<String>) -> Self {
        Self { value, from: from.into() }
    }
}

/// An axis of a machine file.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Its letter.
    pub name: String,
    /// Whether the unit is degrees instead of mm.
    pub rotary: bool,
    /// mm/s.
    pub rapid: Taken,
    /// mm/s.
    pub speed: Taken,
    /// mm/s².
    pub acceleration: Taken,
    /// ms.
    pub ramp: Taken,
    /// mm.
    pub travel: Option<[Taken; 2]>,
    /// Keys of the step output, whole numbers.
    pub steps: Vec<(&'static str, Taken)>,
}

/// A machine file.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// Description, line by line.
    pub title: Vec<String>,
    /// µs.
    pub cycle: Option<Taken>,
    /// Name of a dialect.
    pub dialect: Option<(&'static str, String)>,
    /// Its axes.
    pub axes: Vec<Axis>,
    /// Settings that could not be converted, line by line.
    pub left: Vec<String>,
}

/// A value of a file: key, value in the unit of the parameter, meaning and origin.
struct Row {
    key: String,
    value: String,
    comment: String,
}

/// ISG's id of a parameter, and its meaning.
fn meaning<Target>(table: &[Parameter<Target>], name: &str) -> String {
    let id = table.iter().find(|parameter| parameter.name == name).map_or("", |parameter| parameter.id);
    [id, words::of(name)].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Thousands apart, as TOML permits.
fn grouped(value: i64) -> String {
    let digits = value.unsigned_abs().to_string();
    let mut out = String::new();
    for (index, digit) in digits.char_indices() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) && digits.len() > 4 {
            out.push('_');
        }
        out.push(digit);
    }
    if value < 0 { format!("-{out}") } else { out }
}

fn write(out: &mut String, rows: &[Row]) {
    let code = |row: &Row| format!("{} = {}", row.key, row.value);
    let width = rows.iter().map(|row| code(row).chars().count()).max().unwrap_or(0);
    for row in rows {
        let line = code(row);
        let pad = width - line.chars().count();
        out.push_str(&format!("{line}{:pad$}    # {}\n", "", row.comment));
    }
}

impl Axis {
    fn rows(&self) -> Vec<Row> {
        let mut rows = Vec::new();
        // The same origin again is not repeated.
        let mut told: Vec<String> = Vec::new();
        let mut put = |key: &str, taken: &Taken, scale: f64| {
            let value = grouped((taken.value * scale).round() as i64);
            let is_new = !told.contains(&taken.from) || key.starts_with("steps.");
            told.push(taken.from.clone());
            let comment = joined(&meaning(AXIS, key), if is_new { &taken.from } else { "" });
            rows.push(Row { key: key.to_owned(), value, comment });
        };
        put("vb_eilgang", &self.rapid, 1e3);
        put("dynamik.vb_max", &self.speed, 1e3);
        put("dynamik.a_max", &self.acceleration, 1.0);
        put("dynamik.tr_geom", &self.ramp, 1e3);
        for key in ["a_beschl", "a_brems", "a_grenz"] {
            put(&format!("slope_profil.{key}"), &self.acceleration, 1.0);
        }
        for key in ["tr_beschl_zu", "tr_beschl_ab", "tr_brems_zu", "tr_brems_ab", "tr_grenz"] {
            put(&format!("slope_profil.{key}"), &self.ramp, 1e3);
        }
        if let Some([least, most]) = &self.travel {
            put("kenngr.swe_neg", least, 1e4);
            put("kenngr.swe_pos", most, 1e4);
        }
        for (key, taken) in &self.steps {
            put(key, taken, 1.0);
        }
        rows
    }
}

/// Meaning and origin of a value, if there are any.
fn joined(meaning: &str, from: &str) -> String {
    [meaning, from].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; ")
}

impl Sheet {
    /// Returns the file as text.
    pub fn text(&self) -> String {
        let mut out = String::new();
        for line in &self.title {
            out.push_str(&format!("# {line}\n"));
        }
        out.push_str(
            "# Speeds are in µm/s, accelerations in mm/s², ramp times in µs, limits of travel in 0.1 µm (rotary axes: \
             0.001°/s,\n# °/s², 0.0001°). `glidepath machine explain FILE` says each value in plain words.\n\n[channel]\n",
        );
        let mut rows = Vec::new();
        let mut put = |key: &str, value: String, from: &str| {
            let comment = joined(&meaning(CHANNEL, key), from);
            rows.push(Row { key: key.to_owned(), value, comment });
        };
        let cycle = self.cycle.clone().unwrap_or_else(|| Taken::new(1000.0, "chosen"));
        put("cycle_us", grouped(cycle.value.round() as i64), &cycle.from);
        put("look_ahead", "120".into(), "");
        put("corr_v_trans_jerk", "1".into(), "");
        if let Some((dialect, from)) = &self.dialect {
            put("dialect", format!("\"{dialect}\""), from);
        }
        put("prog_start.slope.profile", "1".into(), "1 is TRAPEZ, 0 STEP, 2 SIN2, 3 HSC");
        put("configuration.path_preparation.function", "\"FCT_DEFAULT|FCT_SURFACE\"".into(), "");
        write(&mut out, &rows);
        for axis in &self.axes {
            let kind = if axis.rotary { "rotary" } else { "linear" };
            out.push_str(&format!("\n[axis.{}]\ntype = \"{kind}\"\n", axis.name));
            write(&mut out, &axis.rows());
        }
        if !self.left.is_empty() {
            out.push_str("\n# Not taken:\n");
            for line in &self.left {
                out.push_str(&format!("# - {line}\n"));
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_stand_apart() {
        for (value, text) in
            [(0, "0"), (1000, "1000"), (12_345, "12_345"), (-1_000_000, "-1_000_000"), (100_000, "100_000")]
        {
            assert_eq!(grouped(value), text);
        }
    }
}
