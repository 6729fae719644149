//! The trace: one row per tick, exact decimals of the fixed-point values.
use crate::decimal::{PLACES, per_second, per_second_squared, push_exact, push_scaled};
use crate::filtered::Filtered;
use crate::machine::Machine;
use glidepath::kinematics::Vector;
use glidepath::quantity::Position;
use glidepath::tick::Telemetry;
use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};

/// A trace file being written.
pub struct Trace {
    out: BufWriter<Box<dyn Write>>,
    row: String,
    cycle_us: u32,
    /// Columns of the axes behind their filters too.
    filtered: bool,
}

/// Columns of the tip of the tool.
const TIP: [&str; 3] = ["tip_X", "tip_Y", "tip_Z"];

impl Trace {
    /// Starts with the header.
    pub fn new(file: Box<dyn Write>, machine: &Machine) -> io::Result<Self> {
        let mut out = BufWriter::with_capacity(1 << 20, file);
        write!(out, "tick,t_s,n,block,s_mm,v_mm_s,a_mm_s2")?;
        for axis in &machine.axes {
            write!(out, ",{}", axis.name.as_str())?;
        }
        let filtered = Filtered::has(machine);
        for axis in machine.axes.iter().filter(|_| filtered) {
            write!(out, ",{}_f", axis.name.as_str())?;
        }
        if machine.kinematics.usual().is_some() {
            write!(out, ",{}", TIP.join(","))?;
        }
        writeln!(out)?;
        Ok(Self { out, row: String::new(), cycle_us: machine.channel.cycle_us, filtered })
    }

    /// One tick; `distance` without its wrap; set points of the path and those for the drives.
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
        // Writing to a String cannot fail.
        let _ = write!(row, "{tick},");
        push_scaled(row, i128::from(tick) * i128::from(self.cycle_us), 6);
        let _ = write!(row, ",{},{},", telemetry.n, telemetry.block);
        push_exact(row, distance, 44);
        row.push(',');
        push_scaled(row, per_second(telemetry.speed.to_bits(), self.cycle_us), PLACES);
        row.push(',');
        push_scaled(row, per_second_squared(telemetry.accel.to_bits(), self.cycle_us), PLACES);
        for set_point in path.iter().chain(drives.iter().filter(|_| self.filtered)) {
            row.push(',');
            push_exact(row, i128::from(set_point.to_bits()), 32);
        }
        for x in tip.into_iter().flat_map(|tip| [tip.x, tip.y, tip.z]) {
            let _ = write!(row, ",{x:.9}");
        }
        row.push('\n');
        self.out.write_all(row.as_bytes())
    }

    /// Writes what is still held back.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()
    }
}
