//! FIR filters behind the path (D3-004, D3-223…D3-234).
use glidepath::machine::{FilterType, MachineData};
use glidepath::tick::State;
use host_tests::cases::machines;
use host_tests::filtered::{Filtered, run, with_filter};

const ONE: f64 = 4_294_967_296.0;

const TYPES: [FilterType; 4] = [FilterType::Average, FilterType::Gauss, FilterType::Sinc, FilterType::Delay];

/// A square of 20 mm with corners of 90°, there and back.
const SQUARE: &str = "#SLOPE [TYPE=TRAPEZ]\nN10 G01 X20 F4000\nN20 Y20\nN30 X0\nN40 Y0\nN50 M30\n";

fn square(kind: FilterType, order: u8, options: &str) -> Filtered {
    let machine = with_filter(machines::even::<3>(1000), kind, order);
    let text = format!("#FILTER ON [{options}]\n{SQUARE}");
    run(&text, &machine, &[], 1000).unwrap()
}

fn delay(kind: FilterType, order: u8) -> usize {
    if kind == FilterType::Delay { 2 * usize::from(order) } else { usize::from(order) }
}

#[test]
fn a_motion_ends_where_the_path_ends_and_sums_are_equal() {
    // D3-004, D3-223, D3-231: a filter of each type, at rest to the last bit, without drift.
    for kind in TYPES {
        for order in [1, 2, 3, 8, 15, 16, 33, 64, 100, 101, 199, 200] {
            if kind == FilterType::Delay && order > 100 {
                continue;
            }
            let run = square(kind, order, "SHARE=100");
            let name = format!("{kind:?} {order}");
            let last = run.path.columns[0].len() - 1;
            for axis in 0..3 {
                let (path, drives) = (&run.path.columns[axis], &run.drives.columns[axis]);
                assert_eq!(path[last], drives[last], "{name}");
                // The sum of the deviations is 0: nothing is lost or won by rounding.
                let sum: i128 = run.deviations(axis, delay(kind, order)).map(i128::from).sum();
                assert_eq!(sum, 0, "{name} axis {axis}");
            }
            assert_eq!(run.states[last], State::Idle);
            let settling = run.states.iter().filter(|state| **state == State::Settling).count();
            let window = if kind == FilterType::Delay { order } else { order };
            assert!((1..=usize::from(window)).contains(&settling), "{name} {settling}");
        }
    }
}

/// The taps of a kernel by their formulas, from the outside in; with the sum one.
fn taps(kind: FilterType, order: usize, quality: f64, cut_off: f64, share: f64) -> Vec<f64> {
    use std::f64::consts::PI;
    let n = order as f64;
    let weight = |k: usize| {
        let d = k as f64 - n / 2.0;
        match kind {
            FilterType::Average => 1.0,
            FilterType::Gauss => (-d * d / 2.0 / (quality * n / 6.0).powi(2)).exp(),
            FilterType::Sinc => {
                let window =
                    0.42 + 0.5 * (2.0 * PI * d / (n + 2.0)).cos() + 0.08 * (4.0 * PI * d / (n + 2.0)).cos();
                let sinc = if d == 0.0 { 2.0 * cut_off } else { (2.0 * PI * cut_off * d).sin() / (PI * d) };
                sinc * window
            }
            _ => unreachable!(),
        }
    };
    let weights: Vec<f64> = (0..=order).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    let mut taps: Vec<f64> = weights.iter().map(|w| w / sum * share).collect();
    taps[order / 2] += (1.0 - share) / 2.0;
    taps[order.div_ceil(2)] += (1.0 - share) / 2.0;
    taps
}

/// What the filter makes of the path, mm, by the formulas.
fn filtered(path: &[i64], taps: &[f64]) -> Vec<f64> {
    let at = |tick: usize, ago: usize| path[tick.saturating_sub(ago)] as f64 / ONE;
    (0..path.len()).map(|tick| taps.iter().enumerate().map(|(k, h)| h * at(tick, k)).sum()).collect()
}

#[test]
fn kernels_are_those_of_their_types() {
    // D3-224, D3-226, D3-228, D3-230: order, share, cut-off frequency and quality do what they say.
    let cases: [(FilterType, usize, &str, f64, f64, f64); 12] = [
        (FilterType::Average, 20, "", 1.0, 0.03, 1.0),
        (FilterType::Average, 31, "", 1.0, 0.03, 1.0),
        (FilterType::Average, 40, "SHARE=60", 1.0, 0.03, 0.6),
        (FilterType::Gauss, 40, "", 1.0, 0.03, 1.0),
        (FilterType::Gauss, 41, "QUALITY=0.5", 0.5, 0.03, 1.0),
        (FilterType::Gauss, 200, "QUALITY=0.2 SHARE=30", 0.2, 0.03, 0.3),
        (FilterType::Gauss, 200, "", 1.0, 0.03, 1.0),
        (FilterType::Sinc, 40, "", 1.0, 0.03, 1.0),
        (FilterType::Sinc, 101, "FCUT=60", 1.0, 0.06, 1.0),
        (FilterType::Sinc, 200, "FCUT=10", 1.0, 0.01, 1.0),
        (FilterType::Sinc, 60, "FCUT=200 SHARE=50", 1.0, 0.2, 0.5),
        (FilterType::Average, 1, "", 1.0, 0.03, 1.0),
    ];
    for (kind, order, options, quality, cut_off, share) in cases {
        let run = square(kind, order as u8, if options.is_empty() { "SHARE=100" } else { options });
        let taps = taps(kind, order, quality, cut_off, share);
        for axis in 0..2 {
            let expected = filtered(&run.path.columns[axis], &taps);
            let off =
                run.drives.columns[axis].iter().zip(&expected).map(|(y, x)| (*y as f64 / ONE - x).abs());
            let off = off.fold(0.0, f64::max);
            let from_path = run.largest(axis, order) / ONE;
            // Taps are rounded to 2^-15 of their sum; a mean is not.
            let allowed = if kind == FilterType::Average && share == 1.0 && order > 1 {
                3e-10
            } else {
                6e-3 * from_path + 3e-7 * order as f64
            };
            assert!(off <= allowed, "{kind:?} {order} {options}: {off} of {from_path}");
            assert!(from_path > 1e-3 || order == 1 || kind == FilterType::Sinc);
        }
    }
}

/// A machine that passes corners of 90° at full feed: 100 m/s² within a cycle of 1 ms.
fn stiff(cycle_us: u32) -> MachineData<3> {
    let mut machine = machines::even::<3>(cycle_us);
    for axis in &mut machine.axes {
        (axis.a_max, axis.a_beschl, axis.a_brems, axis.a_grenz) =
            (1_000_000, 1_000_000, 1_000_000, 1_000_000);
        axis.a_trans_weight = 1000;
    }
    machine
}

fn of_types(orders: &[u8]) -> impl Iterator<Item = (FilterType, u8)> + '_ {
    TYPES[..3].iter().flat_map(move |kind| orders.iter().map(move |order| (*kind, *order)))
}

#[test]
fn ax_dev_is_kept_and_used_at_corners() {
    // D3-227, D3-234: every axis, at every tick, with each type.
    for (kind, order) in of_types(&[8, 9, 16, 33, 40, 64, 101, 150, 200]) {
        for machine in [machines::even::<3>(1000), stiff(1000)] {
            let machine = with_filter(machine, kind, order);
            let run = run(&format!("#FILTER ON [AX_DEV=0.001]\n{SQUARE}"), &machine, &[], 1000).unwrap();
            let name = format!("{kind:?} {order} {}", machine.axes[0].a_max);
            assert!(run.deviated.is_empty(), "{name}");
            for axis in 0..2 {
                let largest = run.largest(axis, order.into()) / ONE;
                println!("{name} axis {axis}: {largest}");
                assert!(largest <= 0.001, "{name} axis {axis}: {largest}");
                // Where G has both signs no one motion takes all of its size.
                let least = if kind == FilterType::Sinc && order > 40 { 0.00008 } else { 0.0009 };
                assert!(largest >= least, "{name} axis {axis}: {largest}");
                // The library says the same.
                let said = run.deviation[axis] as f64 / ONE;
                assert!((said - largest).abs() < 3e-7, "{said} {largest}");
            }
        }
    }
}

#[test]
fn without_ax_dev_the_deviation_doubles_with_order_cycle_and_feed() {
    // D3-224: where the corner is passed at the feed, N·T·v/8 of a mean.
    let corner = |order: u8, cycle_us: u32, feed: u32| {
        let machine = with_filter(stiff(cycle_us), FilterType::Average, order);
        let text = format!("#SLOPE [TYPE=TRAPEZ]\nN10 G01 X20 F{feed}\nN20 Y20\nN30 X0\nN40 Y0\nN50 M30\n");
        run(&text, &machine, &[], 1000).unwrap().largest(0, order.into()) / ONE
    };
    let one = corner(40, 1000, 2000);
    let exact = 40.0 * 42.0 / 41.0 * 1e-3 * 2000.0 / 60.0 / 8.0;
    assert!((one / exact - 1.0).abs() < 0.03, "{one} {exact}");
    for (what, two) in [
        ("order", corner(80, 1000, 2000)),
        ("cycle", corner(40, 2000, 2000)),
        ("feed", corner(40, 1000, 4000)),
    ] {
        assert!((two / one - 2.0).abs() < 0.06, "{what}: {one} {two}");
    }
}

#[test]
fn opposite_passes_have_mirrored_shapes() {
    for (kind, order) in of_types(&[8, 21, 64, 200]) {
        let machine = with_filter(machines::even::<3>(1000), kind, order);
        let pass = |there: &str, back: &str| {
            let text = format!(
                "#SLOPE [TYPE=TRAPEZ]\nN10 G01 G60 {there} F4000\nG04 1\nN20 {back}\nN30 G60 X0 Y0\nM30\n"
            );
            run(&text, &machine, &[], 1000).unwrap()
        };
        let plus = pass("X10 Y5", "X20 Y-5");
        let minus = pass("X-10 Y-5", "X-20 Y5");
        for axis in 0..2 {
            let both = plus.drives.columns[axis].iter().zip(&minus.drives.columns[axis]);
            let off = both.map(|(a, b)| (a + b).abs()).max().unwrap();
            assert!(off <= 1, "{kind:?} {order}: {off} LSB");
            // So is what the path gives.
            let both = plus.path.columns[axis].iter().zip(&minus.path.columns[axis]);
            assert!(both.map(|(a, b)| (a + b).abs()).max().unwrap() <= 1);
        }
    }
}
