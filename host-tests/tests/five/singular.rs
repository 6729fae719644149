//! Near the direction along the outer rotary axis, and through it.
use glidepath::Position;
use glidepath::kinematics::{Reach, Vector};
use host_tests::sphere::{Bench, bench, keeps_limits};
use std::fmt::Write;

/// Lines of 0.3 mm along which the tool leans from 5° on one side to 5° on the other, past the direction of the outer axis
/// by `nearest` degrees.
fn past(bench: &Bench, nearest: f64, smooth: &str) -> String {
    let names = [3, 4].map(|k| char::from(bench.data.axes[k].name.0[0]));
    let mut last = [Position::ZERO; 3];
    let mut text = String::new();
    for k in -100..=100_i32 {
        let lean = f64::from(k) * 0.05_f64.to_radians();
        let direction = Vector::new(lean.tan(), nearest.to_radians().tan(), 1.0);
        last = bench.machine.chain().angles(direction, &last).expect("not singular");
        let [p, q, _] = last.map(|x| x.to_num::<f64>());
        let angles = format!("{}{p:.6} {}{q:.6}", names[0], names[1]);
        let x = 0.3 * f64::from(k);
        let _ = match k {
            -100 => writeln!(
                text,
                "G00 {angles}\n#TRAFO ON\nG00 X{x:.4} Y0 Z0 {angles}\nG04 0.1\n{smooth}\nG01 F6000"
            ),
            _ => writeln!(text, "X{x:.4} Y0 {angles}"),
        };
    }
    text + "#CONTOUR MODE OFF\n#HSC OFF\nM30\n"
}

/// Speeds of the tip near its slowest place, mm/s: least of the whole way behind its start, and largest distance from the
/// line, mm.
fn drive(bench: &Bench, text: &str) -> Result<(f64, f64), String> {
    use glidepath::kinematics::Kinematic;
    let sets = [Kinematic::new(9, &bench.machine.chain(), &bench.data).map_err(|e| e.to_string())?];
    let start = [Position::ZERO; 5];
    let run = host_tests::operate::operate_transformed::<5, 120>(
        text,
        start,
        &bench.data,
        &sets,
        (&[], 100_000),
        400_000,
    )?;
    keeps_limits(bench, &run)?;
    let tips: Vec<[f64; 3]> = (0..run.trace.len())
        .map(|tick| {
            let mut row = run.trace.row(tick);
            bench.machine.tip(&std::array::from_fn(|_| Position::from_bits(row.next().unwrap_or(0))))
        })
        .collect();
    let on_line = tips.iter().rposition(|p| p[0] < -29.9).expect("the start of the line");
    let off = tips[on_line..].iter().map(|p| p[1].hypot(p[2])).fold(0.0, f64::max);
    let inner = tips[on_line..].windows(2).filter(|w| w[1][0].abs() < 20.0);
    let least = inner.map(|w| (w[1][0] - w[0][0]) / 1e-3).fold(f64::INFINITY, f64::min);
    let last = tips.last().expect("ticks");
    if (last[0] - 30.0).abs() > 1e-6 {
        return Err(format!("ends at {last:?}"));
    }
    Ok((least, off))
}

/// The nearer the tool comes to the direction of the outer axis, the slower is the tip. Every axis keeps its limits at
/// every tick, with each kind of smoothing and without.
#[test]
fn near_the_singular_direction_the_tip_is_slower() {
    for name in ["head", "trunnion"] {
        let bench = bench(name, 3).expect("a machine");
        for (smooth, dev) in [
            ("", 0.0),
            ("#HSC ON [SURFACE PATH_DEV=0.01]", 0.01),
            ("#CONTOUR MODE ON [DEV PATH_DEV=0.01]", 0.01),
            ("#HSC ON [BSPLINE PATH_DEV=0.01]", 0.01),
        ] {
            let mut before = f64::INFINITY;
            for nearest in [2.0, 0.3, 0.01] {
                let text = past(&bench, nearest, smooth);
                let (least, off) = drive(&bench, &text)
                    .unwrap_or_else(|e| panic!("{name}, {nearest} degrees, {smooth}: {e}"));
                println!("{name}, {nearest} degrees, {smooth}: {least:.4} mm/s at least, {off:.7} mm off");
                assert!(off <= dev + 10e-6, "{name}, {nearest} degrees, {smooth}: {off} mm off");
                assert!(least > -1e-3, "{name}, {nearest} degrees, {smooth}: {least} mm/s");
                if !smooth.is_empty() {
                    assert!(least < before, "{name}, {nearest} degrees, {smooth}: {least} mm/s of {before}");
                }
                before = least;
            }
        }
    }
}

/// Along the outer axis every angle of it will do: a direction is refused with that axis. A program gives angles, so it
/// turns there at a standstill of the tip, with the limits of that axis.
#[test]
fn the_singular_direction_is_refused_or_turned_in() {
    for (name, outer) in [("head", 3), ("trunnion", 4), ("table", 4)] {
        let bench = bench(name, 3).expect("a machine");
        let chain = bench.machine.chain();
        let along = chain.angles(Vector::new(0.0, 0.0, 1.0), &[Position::ZERO; 3]);
        assert_eq!(along, Err(Reach::Singular(outer)), "{name}");
        let [inner_name, outer_name] =
            [7 - outer, outer].map(|k| char::from(bench.data.axes[usize::from(k)].name.0[0]));
        for smooth in ["", "#CONTOUR MODE ON [DEV PATH_DEV=0.01]", "#HSC ON [SURFACE PATH_DEV=0.01]"] {
            let text = format!(
                "G00 {inner_name}5 {outer_name}0\n#TRAFO ON\nG00 X-30 Y0 Z0\nG04 0.1\n{smooth}\n\
                 G01 X0 {inner_name}0 F6000\n{outer_name}180\nX30 {inner_name}5\n\
                 #CONTOUR MODE OFF\n#HSC OFF\nM30\n"
            );
            let (_, off) = drive(&bench, &text).unwrap_or_else(|e| panic!("{name}, {smooth}: {e}"));
            assert!(off < 0.01 + 10e-6, "{name}, {smooth}: {off} mm off");
            // The turn within a short way of the tip.
            let text = text.replace(&format!("\n{outer_name}180\n"), &format!("\nX0.02 {outer_name}180\n"));
            let (least, off) = drive(&bench, &text).unwrap_or_else(|e| panic!("{name}, {smooth}: {e}"));
            assert!(off < 0.01 + 10e-6 && least < 1.0, "{name}, {smooth}: {off} mm off, {least} mm/s");
        }
    }
}
