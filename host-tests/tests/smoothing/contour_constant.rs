//! CONST_VEL: constant speed along a curve, with every method that has CONST_VEL and every slope; and no
//! crawling motion in consecutive curves.
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use host_tests::cases::machines;
use host_tests::operate::operate_text;
use host_tests::rounded::{Run, quick, run_from};

/// Lowest and highest speed between where N10 is left and N20 is entered, mm/s, over how many ticks.
///
/// The derivative at a tick is that of the polynomial through five of them: of a chord the speed would be too
/// low by (κ·v·T)²/24.
fn inside(run: &Run) -> ([f64; 2], usize) {
    let points: Vec<Vec<f64>> = (0..run.trace.len()).map(|i| run.trace.mm(i)).collect();
    let mut way = vec![0.0];
    for pair in points.windows(2) {
        let step = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        way.push(way.last().unwrap() + step);
    }
    let (from, left) = (run.lengths(10)[0], *run.lengths(20).last().unwrap());
    let all = *way.last().unwrap();
    let within = |i: usize| way[i] > from + 1e-6 && all - way[i] > left + 1e-6;
    let (mut speeds, mut ticks) = ([f64::INFINITY, 0.0_f64], 0);
    for i in 2..points.len().saturating_sub(2) {
        if !within(i - 2) || !within(i + 2) {
            continue;
        }
        let speed = (0..3)
            .map(|k| {
                let x = |j: usize| points[j][k];
                ((x(i - 2) - x(i + 2) + 8.0 * (x(i + 1) - x(i - 1))) / 12.0).powi(2)
            })
            .sum::<f64>()
            .sqrt()
            / run.trace.cycle;
        speeds = [speeds[0].min(speed), speeds[1].max(speed)];
        ticks += 1;
    }
    (speeds, ticks)
}

const MODES: [&str; 9] = [
    "DEV PATH_DEV=2",
    "DEV PATH_DEV=0.3",
    "DIST PRE_DIST=10 POST_DIST=10",
    "DIST PRE_DIST=10 POST_DIST=2",
    "DIST PRE_DIST=3 POST_DIST=12",
    "POS PRE_DIST=10 POST_DIST=10 X98 Y2",
    "POS PRE_DIST=10 POST_DIST=5 X104 Y-3",
    "POS PRE_DIST=2 POST_DIST=3 X110 Y-10",
    "POS PRE_DIST=8 POST_DIST=8 X92 Y8",
];

#[test]
fn the_speed_is_constant_with_every_method_and_slope() {
    for slope in 0..4 {
        for machine in [machines::mill::<3>(1000), quick(1000)] {
            let machine: MachineData<3> = machines::with_slope(machine, slope);
            for mode in MODES {
                for (feed, end) in [
                    (40_000, "X100 Y100"),
                    (40_000, "X30 Y100"),
                    (40_000, "X180 Y60"),
                    (3000, "X30 Y100"),
                    (3000, "X180 Y60 F2000"),
                    (40_000, "G03 X50 Y50 I-50"),
                ] {
                    let text = format!(
                        "#CONTOUR MODE ON [{mode} CONST_VEL=1]\nN10 G01 X100 F{feed}\nN20 G260 {end}\nM30\n"
                    );
                    let run = run_from(&text, [Position::ZERO; 3], &machine);
                    let ([low, high], ticks) = inside(&run);
                    let what = format!("slope {slope}, {mode}, {end}, F{feed}");
                    assert!(ticks > 20 && high <= 1.001 * low, "{what}: {low} … {high} in {ticks} ticks");
                }
            }
        }
    }
}

/// Stairs whose corners take all of the lines between them but for `rest` mm, with CONST_VEL or without.
fn stairs(corners: u32, rest: f64, constant: bool) -> String {
    let (mut text, [mut x, mut y]) = (String::from("#CONTOUR MODE ON\n"), [0.0; 2]);
    for k in 0..=corners {
        let length = rest + if k == 0 || k == corners { 10.0 } else { 20.0 };
        let [way, beside] = if k % 2 == 0 { [&mut x, &mut y] } else { [&mut y, &mut x] };
        *way += length;
        let [inner, outer] = [*way - 2.0, *beside + 2.0];
        let [px, py] = if k % 2 == 0 { [inner, outer] } else { [outer, inner] };
        text += &format!(
            "#CONTOUR MODE [POS PRE_DIST=10 POST_DIST=10 X{px} Y{py} CONST_VEL={}]\nN{} G01 X{x} Y{y} F20000\n",
            u8::from(constant),
            10 * (k + 1)
        );
    }
    text + "M30\n"
}

/// A way to a standstill, and one from there, has the acceleration that the curves leave, not the little that their
/// speed may change by: that took five to ten times as long as without CONST_VEL.
#[test]
fn curves_that_follow_each_other_do_not_crawl() {
    for slope in 0..4 {
        let machine: MachineData<3> = machines::with_slope(quick(1000), slope);
        for rest in [0.0, 0.001] {
            let [free, constant] = [false, true]
                .map(|constant| run_from(&stairs(30, rest, constant), [Position::ZERO; 3], &machine).time());
            println!("slope {slope}, {rest} mm: {constant} s, {free} s without");
            assert!(constant <= 4.0 * free, "slope {slope}, {rest} mm: {constant} s, {free} s without");
        }
    }
}

/// The line before it is so short that it is entered at less than its speed: that stays, too, from a quarter of it on.
#[test]
fn a_speed_below_that_of_the_curve_stays() {
    for slope in 0..4 {
        let machine: MachineData<3> = machines::with_slope(quick(1000), slope);
        let of = |x: f64| {
            let text = format!(
                "#CONTOUR MODE ON [POS PRE_DIST=10 POST_DIST=10 X{} Y2 CONST_VEL=1]\nN10 G01 X{x} F40000\nN20 G260 X{x} Y100\nM30\n",
                x - 2.0
            );
            inside(&run_from(&text, [Position::ZERO; 3], &machine)).0
        };
        let [_, whole] = of(100.0);
        for (x, least) in [(10.4, 0.25), (11.0, 0.45), (15.0, 0.7)] {
            let [low, high] = of(x);
            println!("slope {slope}, X{x}: {low} to {high} of {whole}");
            assert!(high <= 1.001 * low, "slope {slope}, X{x}: {low} to {high}");
            assert!((least..0.99).contains(&(low / whole)), "slope {slope}, X{x}: {low} of {whole}");
        }
    }
}

/// A way to a standstill through curves and lines that take turns has room: with the little by which the speed of such
/// a curve may change it took so many pieces that the motion had to crawl.
#[test]
fn long_lines_between_such_curves_are_fast() {
    for slope in 0..4 {
        let machine: MachineData<3> = machines::with_slope(machines::even::<3>(1000), slope);
        let lines = (0..10).map(|k| format!("X{}\nY{}\n", [25, 0][k % 2], 25 * (k + 1)));
        let lines = format!("G01 F20000\n{}M30\n", lines.collect::<String>());
        let run = |mode: &str| {
            let text = format!("{mode}\n{lines}");
            operate_text::<3, 120>(&text, [Position::ZERO; 3], &machine, &[], usize::MAX).expect("a program")
        };
        let (stops, rounded) = (run(""), run("#CONTOUR MODE ON [DEV PATH_DEV=0.05 CONST_VEL=1]"));
        let ticks = [&rounded, &stops].map(|run| run.trace.len());
        println!("slope {slope}: {ticks:?} ticks, slower {:?}", rounded.slower);
        assert!(rounded.slower.is_empty(), "slope {slope}: slower before {:?}", rounded.slower);
        assert!(4 * ticks[0] < 5 * ticks[1], "slope {slope}: {ticks:?} ticks, rounded and with standstills");
    }
}
