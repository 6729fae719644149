//! #HSC [SURFACE] at turns of every size, between blocks of every length: zigzags against the same ones with
//! standstills.
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
        [(50_000, 0.1, 6000), (50_000, 0.02, 6000), (150_000, 0.02, 20_000)]
            .map(|(ramp, dev, feed)| Self { machine: machine(ramp, 3), dev, feed })
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

    /// Its ticks with Surface, and with standstills, in place of which short ones are passed.
    fn ticks(&self, turn: f64, length: f64) -> [usize; 2] {
        let surface = format!("#HSC ON [SURFACE PATH_DEV={}]", self.dev);
        [surface.as_str(), ""].map(|on| self.zigzag(turn, length, on).trace.ticks())
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
