//! #HSC [SURFACE] at corners of every angle, between blocks of every length: zigzags, compared with the same
//! zigzags with stops.
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use host_tests::trace::{Run, run_text};
use host_tests::walk::machine;

/// A machine, PATH_DEV and feed.
struct Setting {
    machine: MachineData<3>,
    dev: f64,
    feed: u32,
}

impl Setting {
    fn all() -> [Self; 3] {
        [(50_000, 0.1, 6000), (50_000, 0.02, 6000), (150_000, 0.02, 20_000)].map(|(ramp, dev, feed)| Self {
            machine: machine(ramp, 3),
            dev,
            feed,
        })
    }

    /// Twenty blocks of that length that turn by so many degrees, to the left and to the right in turn.
    fn zigzag(&self, turn: f64, length: f64, on: &str) -> Run {
        let mut text = format!("G01 F{}\n{on}\n", self.feed);
        for k in 1..=20 {
            let (along, aside) = ((0.5 * turn).to_radians().cos(), (0.5 * turn).to_radians().sin());
            let [x, y] = [length * along * f64::from(k), length * aside * f64::from(k % 2)];
            text += &format!("X{x:.6} Y{y:.6}\n");
        }
        text += "#HSC OFF\nM30\n";
        run_text::<3, 120>(&text, [Position::ZERO; 3], &self.machine, 1).expect("runs")
    }

    /// How far the path stays from the corner in the middle.
    fn off(&self, run: &Run, turn: f64, length: f64) -> f64 {
        let x = 10.0 * length * (0.5 * turn).to_radians().cos();
        let rows: Vec<_> = (0..run.trace.len()).map(|row| run.trace.mm(row)).collect();
        let away = |pair: &[Vec<f64>]| {
            let [d, p] = [[pair[1][0], pair[1][1]], [x, 0.0]].map(|q| [q[0] - pair[0][0], q[1] - pair[0][1]]);
            let square = d[0] * d[0] + d[1] * d[1];
            let part =
                if square > 0.0 { ((p[0] * d[0] + p[1] * d[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
            (p[0] - part * d[0]).hypot(p[1] - part * d[1])
        };
        rows.windows(2).map(away).fold(f64::INFINITY, f64::min)
    }

    /// The same with Surface.
    fn farthest(&self, turn: f64, length: f64) -> f64 {
        let run = self.zigzag(turn, length, &format!("#HSC ON [SURFACE PATH_DEV={}]", self.dev));
        self.off(&run, turn, length)
    }

    /// Its ticks with Surface, and with standstills, in place of which short ones are passed.
    fn ticks(&self, turn: f64, length: f64) -> [usize; 2] {
        let surface = format!("#HSC ON [SURFACE PATH_DEV={}]", self.dev);
        [surface.as_str(), ""].map(|on| self.zigzag(turn, length, on).trace.ticks())
    }
}

/// D3-166: turns are rounded up to MAX_ANGLE, 160 degrees, and none is slower than the corner is with a
/// standstill; the curve uses its tolerance where the blocks leave room for that.
#[test]
fn turns_up_to_the_largest_angle_are_rounded_d3_166() {
    for setting in Setting::all() {
        for turn in [100.0, 103.0, 110.0, 120.0, 130.0, 140.0, 150.0, 160.0] {
            for length in [0.05, 0.2, 1.0, 5.0, 20.0] {
                let [surface, stops] = setting.ticks(turn, length);
                let at = format!("{turn}° of {length} mm, PATH_DEV {}", setting.dev);
                assert!(surface <= stops, "{at}: {surface} of {stops}");
                if length < 1.0 {
                    assert!(
                        10 * surface < 7 * stops || turn < 103.0 || length > 0.1,
                        "{at}: {surface} of {stops}"
                    );
                    assert!(9 * surface < 8 * stops, "{at}: {surface} of {stops}");
                }
            }
        }
        let used = setting.farthest(140.0, 5.0);
        // A chord of a tick goes past the curve.
        assert!(used <= setting.dev + 5e-4 && used > 0.9 * setting.dev, "{used} of {}", setting.dev);
    }
}

/// D3-166: beyond the largest angle the corner stays, and just at it none does.
#[test]
fn turns_beyond_the_largest_angle_stay_d3_166() {
    let [setting, ..] = Setting::all();
    for (turn, most, rounded) in
        [(140.0, 139.9, false), (140.0, 140.0, true), (175.0, 160.0, false), (175.0, 175.0, true)]
    {
        let on = format!("#HSC ON [SURFACE PATH_DEV=0.1 MAX_ANGLE={most}]");
        let run = setting.zigzag(turn, 5.0, &on);
        let off = setting.off(&run, turn, 5.0);
        assert!(if rounded { off > 0.05 } else { off < 1e-6 }, "{turn}° of {most}: {off}");
        assert_eq!(run.warnings, []);
    }
}

/// Between long blocks acceleration inside a corner is faster than a kernel on both sides of it.
#[test]
fn edges_between_long_blocks_are_no_slower_than_standstills() {
    for setting in Setting::all() {
        for turn in [20.0, 25.0, 30.0, 40.0, 60.0, 80.0, 90.0, 100.0] {
            for length in [0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0] {
                let [surface, stops] = setting.ticks(turn, length);
                let at = format!("{turn}° of {length} mm, PATH_DEV {}", setting.dev);
                assert!(surface <= stops, "{at}: {surface} of {stops}");
            }
        }
    }
}

/// D3-159: a curve that goes to and fro about its chords has room in the tolerance on both sides of each, and
/// not in the middle alone.
#[test]
fn slight_turns_to_both_sides_are_passed_d3_159() {
    for setting in Setting::all() {
        for turn in [2.0, 5.0, 10.0] {
            for length in [1.0, 2.0, 5.0, 10.0, 20.0] {
                let [surface, stops] = setting.ticks(turn, length);
                assert!(
                    surface < stops,
                    "{turn}° of {length} mm, PATH_DEV {}: {surface} of {stops}",
                    setting.dev
                );
            }
        }
    }
}
