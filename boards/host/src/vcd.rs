//! The words of the step output as a value change dump (IEEE 1364), for a wave viewer.
use crate::diagnose::Diagnostic;
use crate::machine::Machine;
use glidepath::quantity::Position;
use glidepath_steps::{Levels, State, StepData, Steps};
use std::io::{self, BufWriter, Write};

/// Slots of a tick that `--slots` may name.
pub const SLOTS: [usize; 3] = [100, 200, 400];

/// The step output of a machine whose numbers of axes and slots are known only at run time.
type Fill = Box<dyn FnMut(&[Position], &mut Vec<u32>) -> State>;

/// A dump while it is written.
pub struct Vcd {
    out: BufWriter<Box<dyn Write>>,
    fill: Fill,
    words: Vec<u32>,
    slot_ns: u64,
    /// Number of slots written.
    slots: u64,
    levels: Levels,
    /// Bits of the port, and their names in the file.
    signals: Vec<(u8, char)>,
}

impl Vcd {
    /// Starts with the header; the pins have their idle level, and the axes are at `start`.
    ///
    /// # Errors
    /// The data of the step output are not possible, the cycle is no multiple of the slots, or the file
    /// cannot be written.
    pub fn new<const AXES: usize>(
        (file, slots): (Box<dyn Write>, usize),
        machine: &Machine,
        start: &[Position; AXES],
    ) -> Result<Result<Self, io::Error>, Box<Diagnostic>> {
        let (fill, rest) = match slots {
            100 => output::<AXES, 100>(machine, start)?,
            400 => output::<AXES, 400>(machine, start)?,
            _ => output::<AXES, 200>(machine, start)?,
        };
        let vcd = Self {
            out: BufWriter::with_capacity(1 << 20, file),
            fill,
            words: Vec::new(),
            slot_ns: u64::from(machine.channel.cycle_us) * 1000 / slots as u64,
            slots: 0,
            levels: Levels::default().behind(rest),
            signals: Vec::new(),
        };
        Ok(vcd.header(machine))
    }

    fn header(mut self, machine: &Machine) -> io::Result<Self> {
        writeln!(self.out, "$timescale 1 ns $end\n$scope module steps $end")?;
        for (axis, steps) in machine.axes.iter().zip(&machine.steps) {
            for (motor, number) in steps.motors.iter().flatten().zip(["", "_2"]) {
                for (pin, what) in [(motor.step, "step"), (motor.direction, "direction")] {
                    let sign = char::from(b'!' + pin.bit);
                    writeln!(self.out, "$var wire 1 {sign} {}_{what}{number} $end", axis.name.as_str())?;
                    self.signals.push((pin.bit, sign));
                }
            }
        }
        writeln!(self.out, "$upscope $end\n$enddefinitions $end\n#0\n$dumpvars")?;
        for (bit, sign) in &self.signals {
            writeln!(self.out, "{}{sign}", u8::from(self.levels.is_high(*bit)))?;
        }
        writeln!(self.out, "$end")?;
        Ok(self)
    }

    /// Writes the words that move the axes to these set points.
    pub fn tick(&mut self, set_points: &[Position]) -> io::Result<()> {
        if (self.fill)(set_points, &mut self.words) == State::Stopped {
            return Err(io::Error::other("a set point jumps by more steps than a tick can put out"));
        }
        for word in &self.words {
            let levels = self.levels.behind(*word);
            if levels != self.levels {
                writeln!(self.out, "#{}", self.slots * self.slot_ns)?;
                for (bit, sign) in &self.signals {
                    if levels.is_high(*bit) != self.levels.is_high(*bit) {
                        writeln!(self.out, "{}{sign}", u8::from(levels.is_high(*bit)))?;
                    }
                }
                self.levels = levels;
            }
            self.slots += 1;
        }
        Ok(())
    }

    /// Writes the buffered data.
    pub fn finish(mut self) -> io::Result<()> {
        writeln!(self.out, "#{}", self.slots * self.slot_ns)?;
        self.out.flush()
    }
}

/// The step output, and the word for the idle level of its pins.
fn output<const AXES: usize, const SLOTS: usize>(
    machine: &Machine,
    start: &[Position; AXES],
) -> Result<(Fill, u32), Box<Diagnostic>> {
    let refused = |reason: &str| Diagnostic::error(format!("{}: step output: {reason}", machine.name));
    let (Some(data), Ok(axes)) = (machine.data::<AXES>(), machine.steps.as_slice().try_into()) else {
        return Err(Box::new(refused("wrong number of axes")));
    };
    let steps = StepData { slot_ns: machine.channel.cycle_us * 1000 / SLOTS as u32, axes };
    let mut steps = Steps::<AXES, SLOTS>::new(&steps, &data, start).map_err(|unfit| {
        let told = unfit.to_string();
        let (message, expected) = told.split_once("; expected ").unwrap_or((&told, ""));
        Box::new(refused(message).expected(expected))
    })?;
    let rest = steps.rest_word();
    let fill = move |set_points: &[Position], words: &mut Vec<u32>| {
        let mut buffer = [0; SLOTS];
        let state = set_points.try_into().map_or(State::Stopped, |all| steps.fill(all, &mut buffer));
        words.clear();
        words.extend_from_slice(&buffer);
        state
    };
    Ok((Box::new(fill), rest))
}
