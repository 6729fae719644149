//! A sphere of lines of 0.3 mm with the tool normal to it.
use host_tests::sphere::{Job, bench, keeps_limits, run};

const SURFACE: &str = "#HSC ON [SURFACE PATH_DEV=0.01]";
const BSPLINE: &str = "#HSC ON [BSPLINE PATH_DEV=0.01]";
const DEV: &str = "#CONTOUR MODE ON [DEV PATH_DEV=0.01]";

/// Time as a part of the bound by limits of the axes at each point; limits, standstills and slow places.
fn drives(machine: &str, job: &Job, smooth: &str, most: f64) {
    let bench = bench(machine, 3).expect("a machine");
    let shown = run(&bench, job, smooth).unwrap_or_else(|e| panic!("{machine}, {smooth}: {e}"));
    let part = shown.time / job.bound(&bench);
    println!(
        "{machine}, {smooth}: {part:.3} of the bound, slowest {:?}, {:.6} mm off",
        shown.slowest, shown.off
    );
    keeps_limits(&bench, &shown.run).unwrap_or_else(|e| panic!("{machine}, {smooth}: {e}"));
    assert!(part < most, "{machine}, {smooth}: {part} of the bound");
    assert!(shown.rest == 0 && shown.slowest.0 > 0.1, "{machine}, {smooth}: {shown:?}");
    assert!(shown.off < 0.0115, "{machine}, {smooth}: {} mm off", shown.off);
}

/// Short forms of 20,000 lines, which `--example sphere` drives.
#[test]
fn short_lines_over_a_sphere_are_one_motion() {
    let job = Job { radius: 50.0, step: 0.3, lines: 1_500, tilt: [30.0, 60.0], digits: 5, feed: 12_000.0 };
    for machine in ["trunnion", "head"] {
        drives(machine, &job, SURFACE, 1.1);
        drives(machine, &job, BSPLINE, 1.1);
        drives(machine, &job, DEV, 1.1);
    }
}

/// With DEV the time hardly depends on the length of the lines. The time includes ramps at both ends.
#[test]
fn shorter_lines_with_dev_take_the_same_time() {
    for (step, lines) in [(0.1, 4_500), (1.0, 450)] {
        let job = Job { radius: 50.0, step, lines, tilt: [30.0, 60.0], digits: 5, feed: 12_000.0 };
        for machine in ["table", "mixed", "head"] {
            drives(machine, &job, DEV, 1.1);
        }
    }
}

/// Long lines: the sphere lies up to 25 tolerances outside the lines, so each corner is a curve of its own. The bound
/// is that of a row of such curves inside PATH_DEV (`Job::rounded_bound`).
#[test]
fn long_lines_over_a_sphere_take_the_time_of_their_corners() {
    let cases =
        [("trunnion", 100.0, 10.0, 1.16), ("trunnion", 100.0, 20.0, 1.08), ("trunnion", 200.0, 10.0, 1.08)];
    for (machine, radius, step, most) in cases {
        let (lines, feed) = ((1000.0 / step) as usize, 12_000.0);
        let job = Job { radius, step, lines, tilt: [20.0, 80.0], digits: 5, feed };
        let bench = bench(machine, 3).expect("a machine");
        let bound = job.rounded_bound(&bench, 0.01);
        for smooth in [SURFACE, DEV] {
            let shown =
                run(&bench, &job, smooth).unwrap_or_else(|e| panic!("{radius}, {step}, {smooth}: {e}"));
            let part = shown.time / bound;
            println!("R{radius}, {step} mm, {smooth}: {part:.3} of the bound, {:?}", shown.slowest);
            keeps_limits(&bench, &shown.run).unwrap_or_else(|e| panic!("{radius}, {step}, {smooth}: {e}"));
            assert!(part < most, "R{radius}, {step} mm, {smooth}: {part} of the bound");
            assert!(
                shown.rest == 0 && shown.slowest.0 > 0.5,
                "R{radius}, {step} mm, {smooth}: {:?}",
                shown.slowest
            );
        }
    }
}
