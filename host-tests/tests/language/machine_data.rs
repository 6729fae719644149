//! Machine data at the ends of their ranges: no value switches a limit off.
use glidepath::channel::{Channel, MachineError};
use glidepath::dynamics::Dynamics;
use glidepath::fir::FilterError;
use glidepath::machine::parameter::{AXIS, CHANNEL};
use glidepath::machine::{Adjusted, AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::quantity::Position;
use glidepath::slope::limits::SlopeLaw;
use host_tests::cases::{Program, machines};
use host_tests::check;
use host_tests::corner::{blocks, dev, random, round};
use host_tests::operate::{Act, operate_text};
use host_tests::properties::{Verdict, verify};

fn good(program: &Program, machine: &MachineData<3>) -> Verdict {
    verify::<3, 120>(program, machine).unwrap_or_else(|fault| panic!("{fault}"))
}

/// Corners of 45° and 90°, and a line that goes back.
fn corners(feed: f64) -> Program {
    Program::new("corners", 3)
        .line(&[4.0, 0.0], feed)
        .line(&[6.0, 2.0], feed)
        .line(&[6.0, 6.0], feed)
        .line(&[2.0, 6.0], feed)
        .line(&[4.0, 6.0], feed)
}

/// mm/min.
const FEEDS: [f64; 4] = [500.0, 3000.0, 9000.0, 60_000.0];

/// A machine with all limits at hand: nothing but the geometric ramp time differs.
fn geometric(us: u32, set: impl Fn(&mut AxisData)) -> MachineData<3> {
    let mut machine = machines::even::<3>(1000);
    for axis in &mut machine.axes {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        axis.tr_geom = us;
        set(axis);
    }
    machine
}

/// P-AXIS-00199 = 0 is preset with P-AXIS-00201.
/// Writes a ramp time.
type SetRamp = fn(&mut AxisData, u32);

/// Rows: D3-282.
#[test]
fn a_geometric_ramp_of_zero_is_the_smallest_ramp() {
    for slope in 1..4 {
        for tr_min in [1000, 10_000, 40_000] {
            for feed in FEEDS {
                let run = |us| {
                    let mut machine = geometric(us, |axis| axis.tr_min = tr_min);
                    machine.channel.slope_profile = slope;
                    good(&corners(feed), &machine).run.digest
                };
                assert_eq!(run(0), run(tr_min), "slope {slope}, tr_min {tr_min}, F{feed}");
            }
        }
    }
}

/// A geometric ramp time far below a cycle permits any jerk, and no more speed at a knee than acceleration
/// does.
///
/// Rows: D3-253.
#[test]
fn a_geometric_ramp_below_the_cycle_keeps_the_acceleration() {
    for slope in 1..4 {
        for cycle in [100, 1000, 10_000] {
            for us in [1, 10, 100, 1000] {
                let mut machine = geometric(us, |axis| axis.tr_min = 1);
                (machine.channel.slope_profile, machine.channel.cycle_us) = (slope, cycle);
                for feed in FEEDS {
                    good(&corners(feed), &machine);
                }
            }
        }
    }
}

/// A ramp time of all axes in cycles, corners that are curves over time, and holds and overrides at many
/// ticks: the largest share of `a_max` that an axis shows.
fn short_ramps(cycles: f64, slope: u8, contour: &str, cycle_us: u32) -> f64 {
    let ramp = (cycles * f64::from(cycle_us)) as u32;
    let mut machine = geometric(ramp, |axis| {
        axis.tr_min = 1;
        machines::ramps(axis, ramp);
    });
    (machine.channel.cycle_us, machine.channel.slope_profile, machine.channel.ptp) = (cycle_us, slope, true);
    let text = format!(
        "N10 {contour}\nN20 G01 X20 F12000\nN30 X20 Y20\nN40 X5 Y30\nN50 X5 Y5\nN60 X40 Y6\nN70 #CONTOUR MODE OFF\nM30\n"
    );
    let start = [Position::ZERO; 3];
    let plain = operate_text::<3, 120>(&text, start, &machine, &[], 1000).unwrap();
    let ticks = plain.trace.ticks();
    let mut most = 0.0_f64;
    for k in 0..120 {
        let at = k * ticks / 120;
        let acts = if k % 2 == 0 {
            vec![(at, Act::Hold), (at + 40, Act::Resume)]
        } else {
            vec![(at, Act::Override(300)), (at + 7, Act::Override(1000))]
        };
        let run = operate_text::<3, 120>(&text, start, &machine, &acts, 1000).unwrap();
        for (column, axis) in run.trace.columns.iter().zip(&machine.axes) {
            let seen = check::peaks(column, run.trace.cycle).values[1] - check::allowance(2, run.trace.cycle);
            most = most.max(seen / f64::from(axis.a_max));
        }
    }
    most
}

const OVER_TIME: [(u8, &str); 5] = [
    (1, "#CONTOUR MODE ON [PTP PATH_DEV=0.2]"),
    (2, "#CONTOUR MODE ON [PTP PATH_DEV=0.2]"),
    (3, "#CONTOUR MODE ON [PTP PATH_DEV=0.2]"),
    (1, "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=4]"),
    (3, "#CONTOUR MODE ON [DEV PATH_DEV=0.2]"),
];

/// Ramps that are short against the cycle, down to one that is planned with as a whole cycle.
#[test]
fn a_hold_inside_a_curve_keeps_the_acceleration() {
    for (slope, contour) in OVER_TIME {
        for cycle_us in [100, 1000] {
            for cycles in [0.1, 1.0, 5.0] {
                let most = short_ramps(cycles, slope, contour, cycle_us);
                assert!(most <= 1.0, "slope {slope}, {contour}, {cycle_us} us, {cycles} cycles: {most}");
            }
        }
    }
}

/// What is refused, by its id.
fn refused(machine: &MachineData<3>) -> Option<&'static str> {
    let mut channel = Box::new(Channel::<3, 120>::new());
    match channel.split(machine, [Position::ZERO; 3], &b"M30\n"[..]) {
        Ok(_) => None,
        Err(MachineError::Axis(0, error)) => Some(error.id),
        // No memory for filters in this channel.
        Err(MachineError::Filter(0, FilterError::NoMemory)) => None,
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn no_ramp_is_below_the_smallest_one() {
    let refused = |set: fn(&mut AxisData, u32), us| {
        let mut machine = machines::even::<3>(1000);
        set(&mut machine.axes[0], us);
        refused(&machine)
    };
    let ramps: [(&str, SetRamp); 5] = [
        ("P-AXIS-00195", |axis, us| axis.tr_beschl_ab = us),
        ("P-AXIS-00196", |axis, us| axis.tr_beschl_zu = us),
        ("P-AXIS-00197", |axis, us| axis.tr_brems_ab = us),
        ("P-AXIS-00198", |axis, us| axis.tr_brems_zu = us),
        ("P-AXIS-00200", |axis, us| axis.tr_grenz = us),
    ];
    for (id, set) in ramps {
        for us in [0, 1, 9999] {
            assert_eq!(refused(set, us), Some(id), "{us}");
        }
        assert_eq!(refused(set, 10_000), None);
        assert_eq!(refused(set, u32::MAX), None);
    }
}

/// The worked value of P-AXIS-00212: 10 000 revolutions a minute. A tick can do 16 mm or degrees.
#[test]
fn the_largest_speed_is_that_of_a_tick() {
    let mut machine = machines::even::<3>(1000);
    for axis in &mut machine.axes {
        (axis.vb_max, axis.vb_eilgang) = (60_000_000, 60_000_000);
        machines::accelerations(axis, 100_000, 100_000);
    }
    assert_eq!(refused(&machine), None);
    let adjusted: Vec<Adjusted> = machine.axes[0].adjusted(&machine.channel).collect();
    let of = |id, name| Adjusted {
        id,
        name,
        unit: "µm/s",
        value: 60_000_000,
        used: 16_000_000,
        because: "cycle_us: at most 16 mm per tick",
    };
    assert_eq!(adjusted, [of("P-AXIS-00209", "vb_eilgang"), of("P-AXIS-00212", "dynamik.vb_max")]);
    // At its largest speed it goes 16 mm in a tick, and a diagonal the root of three times as far.
    let program = Program::new("long", 3).line(&[9000.0, 9000.0, 9000.0], 1.0).rapid();
    let verdict = good(&program, &machine);
    for peaks in &verdict.peaks {
        assert!((peaks.values[0] / 16_000.0 - 1.0).abs() < 1e-4, "{peaks:?}");
    }
    // With a cycle of 0.1 ms there is nothing to say.
    machine.channel.cycle_us = 100;
    assert_eq!(machine.axes[0].adjusted(&machine.channel).count(), 0);
}

/// Ramps are planned with as a cycle at least, whatever weights make of them, and it is said.
#[test]
fn ramps_take_a_cycle() {
    let with = |us, weight: &str| {
        let machine = geometric(us, |axis| {
            axis.tr_min = us;
            machines::ramps(axis, us);
        });
        let text = format!("{weight}\nG01 X4 F9000\nX6 Y2\nG00 X0 Y0\nM30\n");
        let run = operate_text::<3, 120>(&text, [Position::ZERO; 3], &machine, &[], 1000).unwrap();
        (run.trace.columns, machine.axes[1].adjusted(&machine.channel).map(|a| a.id).collect::<Vec<_>>())
    };
    let (expected, said) = with(1000, "");
    assert_eq!(said, [""; 0]);
    let ids = [195, 196, 197, 198, 199, 200, 201].map(|n| format!("P-AXIS-00{n}"));
    for us in [1, 100, 999] {
        let (columns, said) = with(us, "");
        assert!(columns == expected, "{us} us");
        assert_eq!(said, ids, "{us} us");
    }
    let (columns, said) = with(400, "G133 25\nG134 25\nG233 25");
    assert!(columns == expected);
    assert_eq!(said, ids);
}

/// ISG's defaults, by id, and of the channel.
#[test]
fn defaults_are_those_of_the_sources() {
    let of: [(u32, i64); 37] = [
        (1, 1000),
        (2, 1000),
        (4, 1000),
        (5, 1000),
        (6, 1000),
        (8, 1000),
        (11, 1000),
        (12, 1000),
        (13, 0),
        (15, 1),
        (154, 1000),
        // No software limits: ISG's are 10 m away.
        (177, -1_000_000_000),
        (178, 1_000_000_000),
        (195, 50_000),
        (196, 50_000),
        (197, 50_000),
        (198, 50_000),
        (199, 10_000),
        (200, 10_000),
        (201, 10_000),
        (209, 166_666),
        (211, 100_000),
        (212, 200_000),
        (214, 0),
        (221, 100_000),
        (280, 0),
        (281, 0),
        (282, 0),
        (283, 0),
        (293, 0),
        (573, 0),
        (585, 30),
        (586, 0),
        (587, 0),
        (590, 100),
        (591, 0),
        (593, 1),
    ];
    let axis = AxisData::new(AxisName::new("X").unwrap(), AxisKind::Linear);
    for (id, value) in of {
        let id = format!("P-AXIS-{id:05}");
        let parameter = AXIS.iter().find(|parameter| parameter.id == id).expect(&id);
        assert_eq!((parameter.get)(&axis) / 1000, value, "{id}");
    }
    // The zero offsets of G54…G59 are one parameter.
    let offsets: Vec<_> = AXIS.iter().filter(|parameter| parameter.id == "P-ZERO-00003").collect();
    let names = [1, 2, 3, 4, 5, 6].map(|set| format!("np_grp.{set}.versch"));
    assert!(offsets.iter().map(|parameter| parameter.name).eq(names.iter().map(String::as_str)));
    assert!(offsets.iter().all(|parameter| (parameter.get)(&axis) == 0));
    // P-CHAN-00011 stands with the axes.
    assert_eq!(of.len() + offsets.len() + 1, AXIS.len());
    let channel = ChannelData::new();
    let of = [
        ("P-STUP-00071", 120_000),
        ("P-CHAN-00108", 100_000),
        ("P-CHAN-00071", 0),
        ("P-CHAN-00001", 0),
        ("P-CHAN-00073", 0),
        ("P-CHAN-00009", 0),
        ("P-CHAN-00066", 0),
        ("P-CHAN-00002", 100_000_000_000),
        ("P-CHAN-00208", 100_000_000_000),
        ("P-CHAN-00090", 2_000_000_000_000),
        ("P-CHAN-00351", 0),
        ("P-CHAN-00350", 0),
        ("P-CHAN-00110", 1000),
        ("P-CHAN-00239", 0),
        ("P-CHAN-00600", 1000),
        ("P-CHAN-00451", 0),
        ("P-CHAN-00297", 0),
        ("P-ZERO-00002", 0),
    ];
    for (id, milli) in of {
        let parameter = CHANNEL.iter().find(|parameter| parameter.id == id).expect(id);
        assert_eq!((parameter.get)(&channel), milli, "{id}");
    }
    // The cycle and `merge_chords` have no id.
    assert_eq!(of.len() + 2, CHANNEL.len());
    assert_eq!(channel.merge_chords, 0);
}

/// Four unequal ramps, set by their names: each is the one that its id stands for.
#[test]
fn each_ramp_has_its_name() {
    let mut machine = machines::even::<3>(1000);
    let names = [
        ("P-AXIS-00196", "slope_profil.tr_beschl_zu", 60_000),
        ("P-AXIS-00195", "slope_profil.tr_beschl_ab", 150_000),
        ("P-AXIS-00198", "slope_profil.tr_brems_zu", 100_000),
        ("P-AXIS-00197", "slope_profil.tr_brems_ab", 200_000),
    ];
    for (id, name, us) in names {
        let parameter = AXIS.iter().find(|parameter| parameter.name == name).expect(name);
        assert_eq!(parameter.id, id);
        (parameter.set)(&mut machine.axes[0], us * 1000);
    }
    machine.axes[0].vb_max = 1_000_000;
    let verdict = good(&Program::new("line", 3).line(&[800.0], 30_000.0), &machine);
    let x: Vec<f64> = verdict.run.trace.columns[0].iter().map(|&x| x as f64 / 2f64.powi(32)).collect();
    let a: Vec<f64> = x.windows(3).map(|x| (x[2] - 2.0 * x[1] + x[0]) * 1e6).collect();
    // Ticks between nearly nothing and nearly all of 2000 mm/s², in the order of time.
    let (top, half) = (1990.0, a.len() / 2);
    let find =
        |from: usize, is: &dyn Fn(f64) -> bool| from + a[from..].iter().position(|a| is(*a)).expect("a ramp");
    let begins = find(0, &|a| a > 10.0);
    let tops = find(begins, &|a| a > top);
    let falls = find(tops, &|a| a < top);
    let ends = find(falls, &|a| a < 10.0);
    let brakes = find(half, &|a| a < -10.0);
    let most = find(brakes, &|a| a < -top);
    let less = find(most, &|a| a > -top);
    let rests = find(less, &|a| a > -10.0);
    let seen = [tops - begins, ends - falls, most - brakes, rests - less];
    for (ticks, (_, name, us)) in seen.into_iter().zip(names) {
        assert!((ticks as f64 - us as f64 / 1000.0).abs() <= 4.0, "{name}: {seen:?}");
    }
}

/// What the look-ahead permits a curve over its length keeps the jerk of every axis: x'''·v³ + 3·x''·v·a +
/// x'·j ≤ a / geometric ramp time. Where acceleration is bought with speed, so that v + a²/2j ≤ V, at every
/// such pair of v and a.
#[test]
fn the_jerk_of_a_curve_is_that_of_the_geometric_ramp() {
    let mut machine = machines::even::<3>(1000);
    for axis in &mut machine.axes {
        (axis.vb_max, axis.a_max, axis.tr_geom) = (1_000_000, 8000, 10_000);
    }
    let budget = 2000.0 / 0.01 * 1e-9;
    let dynamics = Dynamics::new(&machine);
    let (mut most, mut curves) = (0.0_f64, 0);
    for seed in 0..400 {
        let case = random(seed);
        for piece in round(&blocks(&case.program, &machine), &machine, &dev(case.path_dev)) {
            let element = &piece.out.element;
            let (Some(bounds), Some(curving)) = (element.bounds, piece.out.curving) else { continue };
            if bounds.is_timed() {
                continue;
            }
            let (limits, ..) = dynamics.polynomial(element.shape.length, &bounds, Some(60_000.0), curving);
            let SlopeLaw::JerkLimited { j, .. } = limits.law else { continue };
            let (v, a) = (f64::from(limits.v), f64::from(limits.a_up.max(limits.a_down)));
            let j = j.into_iter().fold(0.0, f32::max);
            for k in 0..3 {
                let [slope, bend, twist] =
                    [bounds.first[k], bounds.second[k], bounds.third[k]].map(f64::from);
                let jerk = |v: f64, a: f64, j: f64| twist * v.powi(3) + 3.0 * bend * v * a + slope * j;
                let worst = if bounds.trades() {
                    let j = f64::from(j).max(a * a / (2.0 * v));
                    let pairs = (0..=64).map(|n| f64::from(n) / 64.0);
                    pairs.map(|e| jerk(v * (1.0 - e * e), e * a, j)).fold(0.0, f64::max)
                } else {
                    jerk(v, a, f64::from(j))
                };
                most = most.max(worst / budget);
            }
            curves += 1;
        }
    }
    assert!(curves > 200 && most <= 1.0 && most > 0.85, "{most} of the permitted jerk in {curves} curves");
}

/// Every parameter of an axis alone at both ends of its range: refused by its name, or limits hold.
#[test]
fn every_parameter_at_both_ends() {
    let program = Program::new("ends", 3)
        .line(&[4.0, 0.0, 1.0], 9000.0)
        .arc(&[8.0, 4.0, 1.0], [0.0, 4.0], false, 9000.0)
        .line(&[8.0, 8.0, 1.0], 9000.0)
        .line(&[0.0, 0.0, 0.0], 1.0)
        .rapid();
    let mut runs = 0;
    for parameter in AXIS {
        for slope in 0..4 {
            for milli in [
                parameter.min_milli - 1000,
                parameter.min_milli,
                parameter.max_milli,
                parameter.max_milli + 1000,
            ] {
                let mut machine = machines::with_slope(machines::even::<3>(1000), slope);
                let beyond = milli < parameter.min_milli || milli > parameter.max_milli;
                if beyond && (milli < 0 || milli / 1000 > i64::from(u32::MAX))
                    // Words and types hold no other value; a filter that is on needs its memory.
                    || ["P-CHAN-00011", "P-AXIS-00573", "P-AXIS-00586"].contains(&parameter.id)
                {
                    continue;
                }
                machine.axes[0].tr_min = 1;
                (parameter.set)(&mut machine.axes[0], milli);
                let id = refused(&machine);
                assert!(id.is_some() || !beyond, "{} = {milli}", parameter.name);
                if id.is_some() {
                    continue;
                }
                // At 1 µm/s a motion takes hours.
                if parameter.unit == "µm/s" && milli == 1000 {
                    continue;
                }
                good(&program, &machine);
                runs += 1;
            }
        }
    }
    assert!(runs > 100, "{runs}");
}

/// D3-261, D3-272: a machine file may say 0.
#[test]
fn limits_along_the_path_may_be_zero() {
    for id in ["P-CHAN-00002", "P-CHAN-00090"] {
        let parameter = CHANNEL.iter().find(|parameter| parameter.id == id).unwrap();
        assert_eq!(parameter.min_milli, 0, "{id}");
        let mut machine = machines::even::<3>(1000);
        (parameter.set)(&mut machine.channel, 0);
        assert_eq!(((parameter.get)(&machine.channel), refused(&machine)), (0, None), "{id}");
    }
}
