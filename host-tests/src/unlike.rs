//! Machines whose axes differ widely, with ramps of few cycles and short cycles, where the permitted jerk is
//! only a few LSB per tick³. The tests run short programs with curves over time and check every axis at every
//! tick. If the slope's jerk is lower, the check uses the jerk of the highest acceleration, so smaller
//! excesses are not found.
use crate::cases::machines;
use crate::cases::random::{Mix, Random, program};
use crate::cases::set_point;
use crate::check::{self, Limits};
use crate::properties::permitted;
use crate::trace::run_text;
use glidepath::machine::MachineData;
use glidepath::quantity::Position;

/// Largest accelerations, mm/s², and lengths of blocks, mm.
const ACCELERATIONS: [f64; 2] = [5.0, 50_000.0];
const LENGTHS: [f64; 2] = [0.05, 10.0];

/// A program on a machine.
pub struct Unlike {
    /// Its machine.
    pub machine: MachineData<3>,
    /// Where it begins.
    pub start: [Position; 3],
    /// Its text.
    pub text: String,
}

impl Unlike {
    /// The program of a seed.
    pub fn new(seed: u64) -> Self {
        let mut r = Random::new(seed ^ 0x756e_6c69_6b65);
        let cycle_us = [100, 250][(r.bits() % 2) as usize];
        let mut machine = machines::machine::<3>(cycle_us, |_, _| {});
        let mut speed: f64 = f64::MAX;
        for axis in &mut machine.axes {
            let a = r.magnitude(ACCELERATIONS[0], ACCELERATIONS[1]);
            let ramp = |r: &mut Random| {
                let cycles = if r.once_in(2) { r.between(1.0, 6.0) } else { r.magnitude(1.0, 400.0) };
                cycles as u32 * cycle_us
            };
            machines::accelerations(axis, a as u32, (a * [1.0, 1.0, 3.0][(r.bits() % 3) as usize]) as u32);
            machines::ramps(axis, ramp(&mut r));
            axis.tr_geom = [0, ramp(&mut r)][(r.bits() % 2) as usize];
            (axis.a_stufe, axis.a_grenz_stufe) = ([a as u32; 2], [a as u32; 2]);
            axis.tr_min = cycle_us;
            axis.vb_max = [20_000, 300_000][(r.bits() % 2) as usize];
            axis.vb_eilgang = axis.vb_max;
            speed = speed.min(a.sqrt());
        }
        machine.channel.slope_profile = (1 + r.bits() % 3) as u8;
        (machine.channel.surface, machine.channel.ptp) = (true, true);
        let feed = 60.0 * speed;
        let mix = Mix {
            blocks: r.between(4.0, 14.0) as usize,
            length: LENGTHS,
            feed: [feed.min(2000.0), 20_000.0],
            arcs: [0, 5][(r.bits() % 2) as usize],
            rapids: 0,
            stops: 0,
            radius: [2.0, 8.0],
            turn: [1.0, 90.0],
            knee: r.magnitude(0.01, 3.0),
            spin: 1.0,
            axes: 3,
        };
        let program = program(seed, mix);
        let size = r.magnitude(0.005, 0.5);
        let on = [
            format!("#CONTOUR MODE ON [DEV PATH_DEV={size:.6}]"),
            format!("#CONTOUR MODE ON [PTP PATH_DEV={size:.6}]"),
            format!("#HSC ON [OPMODE=1 CONTERROR={size:.6}]"),
            format!("#CONTOUR MODE ON [DIST_SOFT PATH_DIST={size:.6}]"),
        ];
        let on = &on[(r.bits() % 4) as usize];
        let text = program.text(&machine).replacen("N1 G90\n", &format!("N1 G90\n{on}\n"), 1);
        let start = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
        Self { machine, start, text }
    }

    /// Limits of its axes.
    pub fn limits(&self) -> Vec<Limits> {
        let slope = self.machine.channel.slope_profile;
        self.machine.axes.iter().map(|axis| permitted(axis, slope, false, true, true)).collect()
    }

    /// Runs the program and checks every limit. Returns the number of ticks.
    ///
    /// # Errors
    /// The first excess, or the reason of a refusal.
    pub fn judge(&self) -> Result<usize, String> {
        let run = run_text::<3, 120>(&self.text, self.start, &self.machine, 1)?;
        check::limits(&run.trace, &self.limits())?;
        Ok(run.trace.ticks())
    }
}
