//! Random zigzags, with Surface and with DEV: hardly any program is slower at a higher feed, or slower than
//! without a curve.
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use host_tests::cases::machines;
use host_tests::cases::random::Random;
use host_tests::trace::run_text;
use host_tests::walk::machine;

struct Zigzag {
    machine: MachineData<3>,
    turn: f64,
    length: f64,
    dev: f64,
}

impl Zigzag {
    fn new(seed: u64) -> Self {
        let mut r = Random::new(seed ^ 0x219);
        let slope = [3, 3, 1, 2][seed as usize % 4];
        let mut machine = match seed / 4 % 3 {
            0 => machine(50_000, slope),
            1 => machine(150_000, slope),
            _ => machines::machine(1000, |_, _| {}),
        };
        (machine.channel.slope_profile, machine.channel.surface) = (slope, true);
        let [turn, length, dev] = [r.magnitude(1.0, 159.0), r.magnitude(0.05, 30.0), r.magnitude(0.01, 0.2)];
        Self { machine, turn, length, dev }
    }

    /// On a machine whose first two axes accelerate unequally, each with ramps of its own. One of both is aside.
    fn uneven(seed: u64) -> Self {
        let mut zigzag = Self::new(seed);
        let mut r = Random::new(seed ^ 0x51de);
        zigzag.machine = machine(50_000, [3, 1, 2][seed as usize % 3]);
        let weak = usize::from(!r.once_in(3));
        for (k, axis) in zigzag.machine.axes.iter_mut().enumerate().take(2) {
            let a = if k == weak { r.magnitude(100.0, 2000.0) } else { 2000.0 };
            (axis.a_max, axis.tr_geom) = (a as u32, r.magnitude(20_000.0, 300_000.0) as u32);
            machines::accelerations(axis, a as u32, a as u32);
            machines::ramps(axis, axis.tr_geom);
        }
        zigzag.turn = r.magnitude(0.3, 60.0);
        zigzag
    }

    /// Ticks of 24 blocks, with 0: Surface, 1: DEV, 2: nothing.
    fn ticks(&self, feed: u32, mode: usize) -> f64 {
        let on = [
            format!("#HSC ON [SURFACE PATH_DEV={:.6}]", self.dev),
            format!("#CONTOUR MODE ON [DEV PATH_DEV={:.6}]", self.dev),
            String::new(),
        ];
        let mut text = format!("G01 F{feed}\n{}\n", on[mode]);
        let (aside, along) = (0.5 * self.turn).to_radians().sin_cos();
        for k in 1..=24 {
            let [x, y] = [self.length * along * f64::from(k), self.length * aside * f64::from(k % 2)];
            text += &format!("X{x:.6} Y{y:.6}\n");
        }
        let run = run_text::<3, 120>(&(text + "M30\n"), [Position::ZERO; 3], &self.machine, 1);
        run.expect("runs").trace.ticks() as f64
    }
}

/// Largest ratio over the seeds, each named if it is above the limit.
fn worst(what: &str, limit: f64, ratio: impl Fn(&Zigzag) -> f64) -> f64 {
    worst_of(Zigzag::new, what, limit, ratio)
}

/// The same of other zigzags.
fn worst_of(of: fn(u64) -> Zigzag, what: &str, limit: f64, ratio: impl Fn(&Zigzag) -> f64) -> f64 {
    let mut worst = 0.0;
    for seed in 0..1500 {
        let zigzag = of(seed);
        let ratio = ratio(&zigzag);
        if ratio > limit {
            println!(
                "seed {seed}: {what} {ratio:.3}: {}°, {} mm, PATH_DEV {}",
                zigzag.turn, zigzag.length, zigzag.dev
            );
        }
        worst = f64::max(worst, ratio);
    }
    println!("{what}: at most {worst:.3}");
    worst
}

/// Ticks for rounding.
const TICKS: f64 = 3.0;

/// The worst that is known: 1.150 at 16° between lines of 12.8 mm, just too short for an edge (seed 475), 1.025 else.
#[test]
fn surface_is_hardly_slower_than_standstills_d3_159() {
    let limit = 1.16;
    let ratio = |z: &Zigzag| (z.ticks(30_000, 0) - TICKS) / z.ticks(30_000, 2);
    assert!(worst("Surface, of standstills", limit, ratio) <= limit);
}

/// An axis that accelerates little slows kernels down where the turn is slight, and the lines are long: there the corner
/// is one of contour mode.
#[test]
fn surface_is_hardly_slower_than_standstills_with_unequal_axes_d3_159() {
    let limit = 1.1;
    let ratio = |z: &Zigzag| (z.ticks(30_000, 0) - TICKS) / z.ticks(30_000, 2);
    assert!(worst_of(Zigzag::uneven, "Surface with unequal axes", limit, ratio) <= limit);
}

/// The worst that is known: 1.185 at 0.4° between lines of 70 µm, which are passed without a curve (seed 940).
#[test]
fn dev_is_hardly_slower_than_standstills_with_unequal_axes() {
    let limit = 1.19;
    let ratio = |z: &Zigzag| (z.ticks(30_000, 1) - TICKS) / z.ticks(30_000, 2);
    assert!(worst_of(Zigzag::uneven, "DEV with unequal axes", limit, ratio) <= limit);
}

/// A part of a curve takes the speed that the curve permits, not the one with which it alone is faster by next to
/// nothing.
#[test]
fn dev_with_step_is_hardly_slower_than_passing_the_corners() {
    for (slow, [turn, length, dev], most) in
        [(145, [0.48, 20.6, 0.095], 1.01), (110, [19.28, 1.5, 0.165], 1.2), (118, [27.51, 1.33, 0.11], 1.2)]
    {
        let mut machine = machine(50_000, 0);
        machine.axes[0].a_max = slow;
        machines::accelerations(&mut machine.axes[0], slow, slow);
        let zigzag = zigzag(machine, [turn, length, dev]);
        let [dev, stops] = [1, 2].map(|mode| zigzag.ticks(4000, mode));
        assert!(dev < most * stops, "{turn}° of {length} mm: {dev} ticks, {stops} without a curve");
    }
}

#[test]
fn dev_is_no_slower_than_standstills() {
    let ratio = |z: &Zigzag| (z.ticks(30_000, 1) - TICKS) / z.ticks(30_000, 2);
    assert!(worst("DEV, of standstills", 1.0, ratio) <= 1.0);
}

/// Between starts and ends that are near each other, elements leave less acceleration at a higher feed: up to 1.232 with
/// HSC (seed 847), and 1.209 with SIN2 (seed 1095).
#[test]
fn a_higher_feed_makes_surface_hardly_slower_d3_159() {
    let limit = 1.24;
    let ratio = |z: &Zigzag| {
        let times = [4000, 15_000, 60_000].map(|feed| z.ticks(feed, 0) - TICKS);
        f64::max(times[1] / times[0], times[2] / times[1].min(times[0]))
    };
    assert!(worst("a higher feed with Surface", limit, ratio) <= limit);
}

fn zigzag(machine: MachineData<3>, [turn, length, dev]: [f64; 3]) -> Zigzag {
    Zigzag { machine, turn, length, dev }
}

fn built_in() -> MachineData<3> {
    let mut machine = machines::machine(1000, |_, _| {});
    (machine.channel.slope_profile, machine.channel.surface) = (3, true);
    machine
}

/// Kernels that nearly touch have no element of some micrometres between them, whose rounding is slow.
#[test]
fn kernels_that_nearly_touch_leave_no_sliver_between_them() {
    for machine in [machine(50_000, 3), machine(150_000, 3), built_in()] {
        let zigzag = zigzag(machine, [16.0, 1.0, 0.02]);
        let [surface, stops] = [0, 2].map(|mode| zigzag.ticks(12_000, mode));
        assert!(surface < 0.46 * stops, "{surface} ticks, {stops} with standstills");
    }
}

/// A path is looked at where chords are sparse, and again where kernels beside it became narrower: what is found
/// only when the path before it is made costs speed.
#[test]
fn a_path_between_sparse_points_is_inside_before_it_is_made() {
    for (machine, shape, most) in
        [(machine(50_000, 3), [8.0, 10.0, 0.02], 0.9), (built_in(), [10.0, 2.0, 0.1], 0.32)]
    {
        let zigzag = zigzag(machine, shape);
        let [surface, stops] = [0, 2].map(|mode| zigzag.ticks(12_000, mode));
        assert!(surface < most * stops, "{surface} ticks, {stops} with standstills");
    }
}

/// A curve that takes all of its blocks is slow: acceleration has nowhere else to be. With more tolerance there may be
/// one, but not where another curve is faster.
#[test]
fn more_tolerance_makes_dev_hardly_slower() {
    for (machine, [turn, length]) in
        [(built_in(), [2.0, 20.0]), (built_in(), [1.0, 20.0]), (machine(50_000, 3), [2.0, 10.0])]
    {
        let [less, more] = [0.02, 0.1].map(|dev| zigzag(machine, [turn, length, dev]).ticks(12_000, 1));
        assert!(more < 1.1 * less, "{turn}° of {length} mm: {more} ticks, {less} with less tolerance");
    }
}

/// Lines that are too short for the feed have a curve for what they reach.
#[test]
fn a_higher_feed_makes_dev_no_slower_where_lines_are_too_short_for_it() {
    for (machine, shape) in [
        (machine(150_000, 3), [25.0, 3.0, 0.1]),
        (machine(50_000, 3), [40.0, 2.0, 0.1]),
        (machine(50_000, 1), [40.0, 2.0, 0.1]),
        (machine(150_000, 2), [25.0, 3.0, 0.1]),
    ] {
        let zigzag = zigzag(machine, shape);
        let [low, high] = [2000, 60_000].map(|feed| zigzag.ticks(feed, 1));
        assert!(high <= low, "{shape:?}: {high} ticks, {low} at a lower feed");
    }
}

/// A curve between a line and an arc leaves a part of both where speed changes, if that is quicker.
#[test]
fn more_tolerance_beside_an_arc_is_no_slower() {
    for radius in [5.0, 10.0, 20.0] {
        for side in [1.0, -1.0] {
            let mut before = f64::INFINITY;
            for dev in [0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0, 1.2, 1.5, 2.0, 3.0] {
                let (arc, x) = (if side > 0.0 { "G02" } else { "G03" }, 20.0 + side * radius);
                let text = format!(
                    "G01 F12000\n#CONTOUR MODE ON [DEV PATH_DEV={dev}]\nX20\n{arc} X{x} Y{radius} I{} J0\nG01 X{}\nM30\n",
                    side * radius,
                    x + side * 20.0
                );
                let run = run_text::<3, 120>(&text, [Position::ZERO; 3], &machine(50_000, 1), 1);
                let ticks = run.expect("runs").trace.ticks() as f64;
                assert!(ticks <= before + TICKS, "radius {radius}, PATH_DEV {dev}: {ticks} after {before}");
                before = before.min(ticks);
            }
        }
    }
}
