//! The trace: one row per tick, exact decimals of the fixed-point values.
use crate::decimal::{PLACES, per_second, per_second_squared, push_exact, push_scaled};
use crate::diagnose::{Diagnostic, nearest};
use crate::filtered::Filtered;
use crate::machine::Machine;
use flate2::Compression;
use flate2::write::GzEncoder;
use glidepath::kinematics::Vector;
use glidepath::quantity::Position;
use glidepath::tick::Telemetry;
use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// The part of a trace that is written.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Extract {
    /// Every Nth row, and the last row.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..), requires = "trace")]
    trace_every: u64,
    /// Columns in this order, by the names of the first line.
    #[arg(long, value_name = "LIST", value_delimiter = ',', requires = "trace")]
    columns: Vec<String>,
}

/// Columns that every trace has.
const OWN: [&str; 7] = ["tick", "t_s", "n", "block", "s_mm", "v_mm_s", "a_mm_s2"];

/// The source of a column.
#[derive(Clone, Copy)]
enum Column {
    /// Index in [`OWN`].
    Own(usize),
    /// Set point of the path.
    Path(usize),
    /// Set point after the filters.
    Drive(usize),
    /// A coordinate of the tool tip.
    Tip(usize),
}

/// A trace file being written.
pub struct Trace {
    out: Out,
    row: String,
    cycle_us: u32,
    columns: Vec<Column>,
    every: u64,
    /// Whether the last row is not written yet.
    is_open: bool,
}

/// Plain or compressed.
enum Out {
    Plain(BufWriter<Box<dyn Write>>),
    Gzip(GzEncoder<BufWriter<Box<dyn Write>>>),
}

impl Out {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Plain(out) => out.write_all(bytes),
            Self::Gzip(out) => out.write_all(bytes),
        }
    }
}

/// The columns of a machine.
fn all(machine: &Machine) -> Vec<(String, Column)> {
    let mut all: Vec<(String, Column)> =
        OWN.iter().enumerate().map(|(index, name)| ((*name).to_owned(), Column::Own(index))).collect();
    let names = || machine.axes.iter().map(|axis| axis.name.as_str()).enumerate();
    all.extend(names().map(|(index, name)| (name.to_owned(), Column::Path(index))));
    if Filtered::has(machine) {
        all.extend(names().map(|(index, name)| (format!("{name}_f"), Column::Drive(index))));
    }
    if machine.kinematics.usual().is_some() {
        all.extend(TIP.iter().enumerate().map(|(index, name)| ((*name).to_owned(), Column::Tip(index))));
    }
    all
}

impl Extract {
    /// Returns the wanted columns of a machine.
    fn of(&self, machine: &Machine) -> Result<Vec<(String, Column)>, Vec<Diagnostic>> {
        let all = all(machine);
        if self.columns.is_empty() {
            return Ok(all);
        }
        let find = |name: &String| {
            let found = all.iter().find(|(known, _)| known.eq_ignore_ascii_case(name.trim()));
            found.cloned().ok_or_else(|| {
                let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
                let meant = nearest(name, names.iter().copied());
                let meant = meant.map_or_else(String::new, |name| format!("; is {name} meant?"));
                let message = format!("--columns: no column `{name}`");
                vec![Diagnostic::error(message).expected(format!("expected {}{meant}", names.join(", ")))]
            })
        };
        self.columns.iter().map(find).collect()
    }
}

/// Columns of the tool tip.
const TIP: [&str; 3] = ["tip_X", "tip_Y", "tip_Z"];

impl Trace {
    /// Starts with the header. A name that ends in `.gz` is compressed.
    ///
    /// # Errors
    /// A column that the machine does not have; the inner error: the file cannot be written.
    pub fn new(
        (path, file): (&Path, Box<dyn Write>),
        machine: &Machine,
        extract: &Extract,
    ) -> Result<io::Result<Self>, Vec<Diagnostic>> {
        let columns = extract.of(machine)?;
        let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        let file = BufWriter::with_capacity(1 << 20, file);
        let is_gzip = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("gz"));
        let mut out = match is_gzip {
            true => Out::Gzip(GzEncoder::new(file, Compression::default())),
            false => Out::Plain(file),
        };
        let begun = out.put(format!("{}\n", names.join(",")).as_bytes());
        Ok(begun.map(|()| Self {
            out,
            row: String::new(),
            cycle_us: machine.channel.cycle_us,
            columns: columns.into_iter().map(|(_, column)| column).collect(),
            every: extract.trace_every.max(1),
            is_open: false,
        }))
    }

    /// Writes one tick. `distance` is without wrap; set points are those of the path and those for the
    /// drives.
    pub fn row(
        &mut self,
        tick: u64,
        telemetry: &Telemetry,
        distance: i128,
        [path, drives]: [&[Position]; 2],
        tip: Option<Vector>,
    ) -> io::Result<()> {
        let row = &mut self.row;
        row.clear();
        for (index, column) in self.columns.iter().enumerate() {
            if index > 0 {
                row.push(',');
            }
            // Writing to a String cannot fail.
            let _ = match column {
                Column::Own(0) => write!(row, "{tick}"),
                Column::Own(2) => write!(row, "{}", telemetry.n),
                Column::Own(3) => write!(row, "{}", telemetry.block),
                _ => Ok(()),
            };
            match column {
                Column::Own(1) => push_scaled(row, i128::from(tick) * i128::from(self.cycle_us), 6),
                Column::Own(4) => push_exact(row, distance, 44),
                Column::Own(5) => {
                    push_scaled(row, per_second(telemetry.speed.to_bits(), self.cycle_us), PLACES)
                }
                Column::Own(6) => {
                    push_scaled(row, per_second_squared(telemetry.accel.to_bits(), self.cycle_us), PLACES);
                }
                Column::Own(_) => {}
                Column::Path(axis) => push_exact(row, i128::from(path[*axis].to_bits()), 32),
                Column::Drive(axis) => push_exact(row, i128::from(drives[*axis].to_bits()), 32),
                Column::Tip(index) => {
                    let x = tip.map_or(f64::NAN, |tip| [tip.x, tip.y, tip.z][*index]);
                    let _ = write!(row, "{x:.9}");
                }
            }
        }
        row.push('\n');
        self.is_open = !tick.is_multiple_of(self.every);
        if self.is_open { Ok(()) } else { self.out.put(self.row.as_bytes()) }
    }

    /// Writes the buffered data.
    pub fn finish(mut self) -> io::Result<()> {
        if self.is_open {
            self.out.put(self.row.as_bytes())?;
        }
        match self.out {
            Out::Plain(mut out) => out.flush(),
            Out::Gzip(out) => out.finish()?.flush(),
        }
    }
}
