//! Random programs with every slope and every corner method: no program may be slower than with stops at all
//! corners, than with less tolerance, or than with half the feed.
use crate::cases::machines;
use crate::cases::random::{Mix, Random, program};
use crate::cases::set_point;
use crate::trace::run_text;
use crate::walk::machine;
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use std::fmt::Write;

/// Slopes: name, P-CHAN-00071, and the command in the program.
pub const SLOPES: [(&str, u8, &str); 5] = [
    ("STEP", 0, ""),
    ("TRAPEZ", 1, ""),
    ("SIN2", 2, ""),
    ("HSC", 3, ""),
    ("HSC, NO_OPT=0", 3, "#SLOPE [TYPE=HSC NO_OPT=0]\n"),
];
/// Methods.
pub const METHODS: [&str; 6] = ["none", "DEV", "DIST_SOFT", "PTP", "Surface", "B-spline"];
/// Tolerances and feeds of a program, as parts of its own values.
pub const TOLERANCES: [f64; 3] = [0.2, 1.0, 5.0];
pub const FEEDS: [f64; 2] = [1.0, 2.0];

/// A program and its machine.
pub struct Case {
    machine: MachineData<3>,
    start: [Position; 3],
    body: String,
    tolerance: f64,
    feed: f64,
}

/// The largest quotients of times: compared with stops, with less tolerance, with half the feed, with DEV
/// (only Surface and the B-spline).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Worst {
    /// Each with its seed.
    pub quotients: [(f64, u64); 4],
    /// Number of quotients above 1.01 (stops, less tolerance, half the feed) or above 1.02 (DEV).
    pub above: [u32; 4],
    /// How many were compared.
    pub compared: [u32; 4],
    /// Programs that were refused.
    pub refused: u64,
}

impl Case {
    /// The case of a seed.
    pub fn new(seed: u64) -> Self {
        let mut r = Random::new(seed ^ 0x736c_6f77);
        let mut machine = match seed % 4 {
            0 => machine(50_000, 1),
            1 => machine(150_000, 1),
            2 => machines::machine(1000, |_, _| {}),
            _ => {
                let mut uneven = machine(50_000, 1);
                for axis in &mut uneven.axes {
                    let (a, ramp) =
                        (r.magnitude(200.0, 5000.0) as u32, r.magnitude(10_000.0, 200_000.0) as u32);
                    machines::accelerations(axis, a, a);
                    machines::ramps(axis, ramp);
                    axis.tr_geom = ramp;
                }
                uneven
            }
        };
        (machine.channel.surface, machine.channel.ptp) = (true, true);
        let zigzag = r.once_in(4);
        let longest = r.magnitude(0.5, 80.0);
        let shortest = if r.once_in(2) { 0.5 * longest } else { 0.02 * longest };
        let mix = Mix {
            axes: 3,
            blocks: r.between(5.0, 30.0) as usize,
            length: [shortest, longest],
            feed: [6000.0; 2],
            arcs: [0, 0, 4][(r.bits() % 3) as usize],
            rapids: 0,
            stops: 0,
            radius: [0.4, 40.0],
            turn: [1.0, 90.0],
            knee: r.magnitude(0.01, 3.0),
            spin: 1.0,
        };
        let program = program(seed, mix);
        let (mut body, mut start) = (String::new(), [Position::ZERO; 3]);
        if zigzag {
            let (length, turn) = (r.magnitude(0.8, 4.0), r.between(1.0, 170.0).to_radians());
            for k in 1..=24 {
                let [x, y] = [(0.5 * turn).cos() * f64::from(k), (0.5 * turn).sin() * f64::from(k % 2)];
                let _ = writeln!(body, "G01 X{:.6} Y{:.6}", length * x, length * y);
            }
        } else {
            start = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
            let text = program.text(&machine);
            body = text.trim_start_matches("%case\nN1 G90\n").trim_end_matches("M30\n").replace(" F6000", "");
        }
        let tolerance = r.magnitude(0.01, 0.2);
        Self { machine, start, body, tolerance, feed: r.magnitude(1500.0, 30_000.0) }
    }

    /// Its machine with a slope.
    pub fn machine(&self, slope: usize) -> MachineData<3> {
        let mut machine = self.machine;
        machine.channel.slope_profile = SLOPES[slope].1;
        machine
    }

    /// Where it begins.
    pub const fn start(&self) -> [Position; 3] {
        self.start
    }

    /// Its text with a slope, a method and a part of its tolerance.
    pub fn program(&self, slope: usize, method: usize, part: f64) -> String {
        self.text(slope, &Self::on(METHODS[method], part * self.tolerance), [1.0, 0.0])
    }

    /// The command that switches a method on.
    fn on(method: &str, size: f64) -> String {
        match method {
            "none" => String::new(),
            "DIST_SOFT" => format!("#CONTOUR MODE ON [DIST_SOFT PATH_DIST={size:.6}]"),
            // As large as the default of contour mode.
            "Surface" => format!("#HSC ON [SURFACE PATH_DEV={size:.6} MAX_ANGLE=178]"),
            "B-spline" => format!("#HSC ON [BSPLINE PATH_DEV={size:.6} MAX_ANGLE=178]"),
            _ => format!("#CONTOUR MODE ON [{method} PATH_DEV={size:.6}]"),
        }
    }

    /// Its text.
    fn text(&self, slope: usize, on: &str, [feed, stops]: [f64; 2]) -> String {
        let said = SLOPES[slope].2;
        let exact = if stops > 0.0 { "G360\n" } else { "" };
        format!("{said}G90 G01 F{:.3}\n{exact}{on}\n{}M30\n", self.feed * feed, self.body)
    }

    /// Its text with a method, and the times of all tolerances, feeds and of stops, one per line.
    pub fn show(&self, slope: usize, method: &str) -> String {
        let mut shown = self.text(slope, &Self::on(method, self.tolerance), [1.0, 0.0]);
        for feed in FEEDS {
            let _ = writeln!(shown, "; feed {feed}: standstills {:?}", self.ticks(slope, "", [feed, 1.0]));
            for part in TOLERANCES {
                let ticks = self.ticks(slope, &Self::on(method, part * self.tolerance), [feed, 0.0]);
                let _ = writeln!(shown, "; feed {feed}: PATH_DEV {:.4}: {ticks:?}", part * self.tolerance);
            }
        }
        let axes = self.machine.axes.map(|axis| [axis.a_beschl, axis.tr_beschl_zu, axis.tr_geom]);
        let _ = writeln!(shown, "; starts at {:?}, axes {axes:?}", self.start);
        shown
    }

    /// Its ticks; none if the program is refused. `stops`: with a stop at the end of every block.
    fn ticks(&self, slope: usize, on: &str, [feed, stops]: [f64; 2]) -> Option<f64> {
        let machine = self.machine(slope);
        let text = self.text(slope, on, [feed, stops]);
        let run = run_text::<3, 120>(&text, self.start, &machine, 1).ok()?;
        Some(run.trace.ticks() as f64)
    }

    /// Adds the results of a slope and a method.
    pub fn measure(&self, seed: u64, slope: usize, method: usize, worst: &mut Worst) {
        let mut before: Option<[f64; 3]> = None;
        for feed in FEEDS {
            let Some(stops) = self.ticks(slope, "", [feed, 1.0]) else { return worst.refused += 1 };
            let mut times = [0.0; 3];
            for (k, part) in TOLERANCES.into_iter().enumerate() {
                if METHODS[method] == "none" && k > 0 {
                    times[k] = times[0];
                    continue;
                }
                let on = Self::on(METHODS[method], part * self.tolerance);
                let Some(ticks) = self.ticks(slope, &on, [feed, 0.0]) else { return worst.refused += 1 };
                times[k] = ticks;
            }
            for (k, ticks) in times.into_iter().enumerate() {
                if ["Surface", "B-spline"].contains(&METHODS[method])
                    && let Some(dev) =
                        self.ticks(slope, &Self::on("DEV", TOLERANCES[k] * self.tolerance), [feed, 0.0])
                {
                    worst.take(3, (ticks - 2.0) / dev, seed);
                }
                // Two ticks of short programs do not count.
                let ticks = ticks - 2.0;
                worst.take(0, ticks / stops, seed);
                if k > 0 {
                    worst.take(1, ticks / times[k - 1], seed);
                }
                if let Some(before) = before {
                    worst.take(2, ticks / before[k], seed);
                }
            }
            before = Some(times);
        }
    }
}

impl Worst {
    fn take(&mut self, which: usize, quotient: f64, seed: u64) {
        self.compared[which] += 1;
        self.above[which] += u32::from(quotient > [1.01, 1.01, 1.01, 1.02][which]);
        if quotient > self.quotients[which].0 {
            self.quotients[which] = (quotient, seed);
        }
    }
}
