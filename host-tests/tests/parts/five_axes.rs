//! Machines with rotary axes, compared with a forward transformation by matrices and the standard library's
//! sines.
use glidepath::Position;
use glidepath::kinematics::{CaHead, Chain, Course, Splitter, Universal, Vector};
use host_tests::five_axes::{Numbers, X, Z, distance, machines, universal};

/// 5 nm in mm.
const NEAR: f64 = 5e-6;

fn poses(count: u32) {
    let mut numbers = Numbers(43);
    for (m, machine) in machines().iter().enumerate() {
        let chain = machine.chain();
        for _ in 0..count / 6 + 1 {
            let (tip, angles) = numbers.pose(1_000.0, 720.0);
            let axes = chain.inverse(tip, &angles).expect("in range");
            let off = distance(machine.tip(&axes), tip);
            assert!(off < NEAR, "machine {m}: {off} mm at {tip:?} {angles:?}");
            let own = chain.forward(&axes).0;
            assert!(distance(machine.tip(&axes), own) < NEAR, "machine {m}: forward at {axes:?}");
        }
    }
}

#[test]
fn forward_of_inverse_is_the_tip() {
    poses(12_000);
}

#[test]
#[ignore = "a million poses"]
fn forward_of_inverse_is_the_tip_a_million_times() {
    poses(1_000_000);
}

#[test]
fn the_tip_stays_on_its_line() {
    let mut numbers = Numbers(9);
    for (m, machine) in machines().iter().enumerate() {
        let chain = machine.chain();
        for _ in 0..20 {
            let from = numbers.pose(300.0, 90.0);
            let far = numbers.pose(20.0, 40.0);
            let to = (from.0.plus(far.0), [0, 1, 2].map(|k| from.1[k] + far.1[k]));
            let mut splitter = Splitter::new(&chain, Course::line(from, to)).expect("a course");
            let count = splitter.cells();
            assert!((1..200).contains(&count), "machine {m}: {count} cells");
            let mut end = chain.inverse(from.0, &from.1).expect("in range");
            for n in 0..count {
                let cell = splitter.step().expect("a cell").expect("made");
                assert_eq!(cell.start, end, "machine {m}: cells meet");
                for part in 0..=16 {
                    let share = (f64::from(n) + f64::from(part) / 16.0) / f64::from(count);
                    let axes = cell.at(i64::from(part) << 58);
                    let tip = from.0.plus(to.0.minus(from.0).times(share));
                    let off = distance(machine.tip(&axes), tip);
                    assert!(off < NEAR, "machine {m}: {off} mm off, cell {n} of {count}, part {part}");
                    for (k, axis) in axes.iter().enumerate() {
                        let [least, most] = cell.range(k).expect("an axis");
                        assert!((least..=most).contains(axis), "machine {m}, axis {k}: outside its range");
                    }
                }
                end = cell.end();
            }
            assert!(splitter.step().is_none());
            assert_eq!(end, chain.inverse(to.0, &to.1).expect("in range"), "machine {m}: the end");
        }
    }
}

#[test]
fn a_direction_gives_the_angles_nearest_to_the_last() {
    let mut numbers = Numbers(5);
    for machine in &machines()[..4] {
        let chain = machine.chain();
        for _ in 0..500 {
            let (tip, angles) = numbers.pose(100.0, 170.0);
            let direction = chain.forward(&chain.inverse(tip, &angles).expect("in range")).1;
            let Ok(found) = chain.angles(direction, &angles) else { panic!("{angles:?}: not reached") };
            for (a, b) in found.iter().zip(&angles) {
                assert!((*a - *b).abs().to_num::<f64>() < 1e-5, "{found:?} for {angles:?}");
            }
        }
        let along = chain.angles(Vector::new(0.0, 0.0, 1.0), &[Position::ZERO; 3]);
        assert!(along.is_err_and(|error| error.to_string().contains("singular")), "{along:?}");
    }
}

#[test]
fn machine_data_that_contradict_are_refused_by_name() {
    let good = *universal([4, 0, 1, 2, 3, 5], &[(X, [0; 3]), (Z, [0; 3])]);
    let refused = |change: fn(&mut Universal), name: &str| {
        let mut machine = good;
        change(&mut machine);
        let error = Chain::universal(&machine).expect_err(name).to_string();
        assert!(error.contains(name), "{error}");
    };
    refused(|m| m.number_of_axes = 7, "00289");
    refused(|m| m.chain[1] = 4, "each axis once");
    refused(|m| m.chain[1] = 5, "below number_of_axes");
    refused(|m| m.chain = [0, 4, 1, 2, 3, 5], "side by side");
    refused(|m| m.axis[0].kind = 3, "00291");
    refused(|m| m.axis[0].kind = 2, "three linear axes");
    refused(|m| m.axis[0].orientation = [0.0, 1.0, 0.0], "span space");
    refused(|m| m.axis[3].orientation = [0.0, 0.0, -3.0], "rotary axis before it");
    refused(|m| m.axis[3].orientation = [f64::NAN, 0.0, 0.0], "00292");
    refused(|m| m.axis[3].point[2] = i32::MIN, "00293");
    refused(|m| m.zero_orientation = [1.0, 0.0, 0.0], "does not tilt");
    refused(|m| m.zero_orientation = [0.0; 3], "00285");
    let mut param = [0; 9];
    param[3] = 3_600_001;
    assert!(Chain::ca_head(&CaHead { param }).expect_err("HD4").to_string().contains("index 3"));
}
