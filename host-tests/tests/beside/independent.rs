//! Independent axes: D3-271, and random programs with independent motions.
use glidepath::machine::{ChannelData, FilterType, MachineData};
use host_tests::beside::{LONGEST, ONE, Run, run};
use host_tests::cases::machines::{self, even};
use host_tests::cases::random::Random;
use host_tests::filtered::permit_filters;
use host_tests::operate::{Act, TOO_LONG, random_acts, with_overrides, with_stalls};

fn good<const AXES: usize>(text: &str, machine: &MachineData<AXES>) -> Run {
    let run = run(text, machine, &[], 40).unwrap_or_else(|error| panic!("{text}: {error}"));
    if let Err(error) = run.keeps_limits(machine, machine.channel.slope_profile, false) {
        panic!("{text}: {error}");
    }
    run
}

fn first_move(run: &Run, axis: usize) -> usize {
    run.axes[axis].windows(2).position(|pair| pair[0] != pair[1]).expect("it moves")
}

fn last_move(run: &Run, axis: usize) -> usize {
    run.axes[axis].windows(2).rposition(|pair| pair[0] != pair[1]).expect("it moves")
}

/// INDP_SYN: the next block waits; INDP_ASYN: it does not, #WAIT INDP and the path do.
#[test]
fn synchronous_and_asynchronous() {
    let machine = even::<3>(1000);
    let syn = good("X[INDP_SYN G01 G90 POS=30 FEED=3000]\nG01 Y5 F3000\nM30\n", &machine);
    assert!(last_move(&syn, 0) < first_move(&syn, 1));
    let asyn = good("X[INDP_ASYN G01 G90 POS=30 FEED=3000]\nG01 Y5 F3000\nM30\n", &machine);
    assert!(last_move(&asyn, 0) > last_move(&asyn, 1));
    for wait in ["#WAIT INDP [X]", "#WAIT INDP ALL", "G01 Y5 F3000\n#WAIT INDP [X,Z]"] {
        let run =
            good(&format!("X[INDP_ASYN G01 G90 POS=30 FEED=3000]\n{wait}\nG01 Z5 F3000\nM30\n"), &machine);
        assert!(last_move(&run, 0) < first_move(&run, 2), "{wait}");
    }
    let joined = good("X[INDP_ASYN G01 G90 POS=30 FEED=3000]\nG01 Y5 F3000\nX40 Y6\nM30\n", &machine);
    assert_eq!(joined.ends(), [40.0, 6.0, 0.0]);
    let taken_along = good("X[INDP_ASYN G01 G90 POS=30 FEED=3000]\nG01 X30 Y5 F3000\nM30\n", &machine);
    assert!(
        last_move(&taken_along, 0) > last_move(&taken_along, 1),
        "P-CHAN-00451 = 0: the target is the same"
    );
    assert_eq!(syn.warnings.len() + asyn.warnings.len(), 0);
    // P-CHAN-00451 = 1: it is named, that is enough; a motion that does not name it goes on.
    let named = MachineData { channel: ChannelData { joins_named: true, ..machine.channel }, ..machine };
    let joined = good("X[INDP_ASYN G01 G90 POS=30 FEED=3000]\nG01 X30 Y5 F3000\nM30\n", &named);
    assert!(last_move(&joined, 0) < first_move(&joined, 1));
    assert_eq!(joined.ends(), [30.0, 5.0, 0.0]);
    let unnamed = good("X[INDP_ASYN G01 G90 POS=30 FEED=3000]\nG01 Y5 Z2 F3000\nM30\n", &named);
    assert!(last_move(&unnamed, 0) > last_move(&unnamed, 1));
    let swings = "X[OSC ON 1ST_POS=-3 2ND_POS=4 FREQ=2]\nG04 1.1\nG01 X4 Y9 F600\nM30\n";
    let [ended, swinging] = [&named, &machine].map(|machine| {
        let run = good(swings, machine);
        let last = last_move(&run, 1);
        run.axes[0][last - 500..last].windows(2).all(|pair| pair[0] == pair[1])
    });
    assert!(ended && !swinging, "{ended} {swinging}");
}

/// P-CHAN-00297 = 1: an exact stop of the path is one of the independent axes too, of all of them, but not
/// of an oscillation; = 2: so is `#WAIT INDP`, whatever axis it names. With filters the axes have settled.
#[test]
fn exact_stop_p_chan_00297() {
    let mut machine = even::<3>(1000);
    let of = |machine: &MachineData<3>, mode: u8| MachineData {
        channel: ChannelData { exact_stop_indp: mode, ..machine.channel },
        ..*machine
    };
    // The examples of the parameter, and what goes on behind them.
    let begins = "Z[INDP_ASYN G01 G90 POS=40 FEED=3000]\n";
    let path = |stop: &str| format!("{begins}G01 G90 X5 Z40 F3000 {stop}\nY10\nM30\n");
    let two = format!("X[INDP_ASYN G01 G90 POS=5 FEED=3000]\n{begins}#WAIT INDP [X]\nG01 Y10 F3000\nM30\n");
    for filtered in [false, true] {
        if filtered {
            for axis in &mut machine.axes {
                permit_filters(axis, 1000);
                axis.filter.kind = FilterType::Gauss;
                (axis.filter.enable, axis.filter.order) = (true, 60);
            }
        }
        // Whether the next block waits for Z, and how long it does.
        let waits = |text: &str, mode: u8| {
            let run = good(text, &of(&machine, mode));
            assert_eq!(run.ends()[1..], [10.0, 40.0], "{text}");
            first_move(&run, 1).checked_sub(last_move(&run, 2))
        };
        for (mode, stop, word) in [(0, false, false), (1, true, false), (2, false, true)] {
            assert_eq!(waits(&path("G60"), mode).is_some(), stop, "mode {mode}, G60");
            assert_eq!(waits(&path("G360"), mode).is_some(), stop, "mode {mode}, G360");
            assert!(waits(&path(""), mode).is_none(), "mode {mode}, no exact stop");
            assert_eq!(waits(&two, mode).is_some(), word, "mode {mode}, #WAIT INDP");
        }
        // An axis that the motion does not name is waited for as well, one that stands is not.
        assert!(waits(&path("G60").replace("Z40 ", ""), 1).is_some());
        let stands = "G01 G90 Z40 F3000\nX5 G60\nY10\nM30\n";
        assert_eq!(good(stands, &of(&machine, 1)).axes, good(stands, &of(&machine, 0)).axes);
        // No longer than its own motion takes, and its filter.
        let waited = waits(&path("G60"), 1).expect("it waits");
        assert!(waited < if filtered { 80 } else { 12 }, "{waited}");
        // An oscillation goes on.
        let swings =
            "Z[OSC ON 1ST_POS=-3 2ND_POS=4 FREQ=2]\nG04 1\nG01 X5 F3000 G60\n#WAIT INDP ALL\nY10\nM30\n";
        for mode in 0..3 {
            let run = good(swings, &of(&machine, mode));
            assert!(first_move(&run, 1) < last_move(&run, 2), "mode {mode}");
        }
    }
}

/// An arc moves both axes of its plane, named or not: their own motions end before it.
#[test]
fn an_arc_waits_for_the_axes_of_its_plane() {
    let machine = even::<3>(1000);
    for (before, x) in [
        ("X[INDP_ASYN G01 G90 POS=50 FEED=3000]", 50.0),
        ("X[OSC ON 1ST_POS=-20 2ND_POS=20 FEED=6000]\nG04 1.1", 20.0),
        ("X[OSC ON 1ST_POS=-20 2ND_POS=20 FEED=6000]\nX[OSC OFF]", 20.0),
    ] {
        let run = good(&format!("{before}\nG01 F6000\nG03 J20\nM30\n"), &machine);
        assert_eq!(run.ends(), [x, 0.0, 0.0], "{before}");
        // While Y moves, both go round the centre.
        let from = first_move(&run, 1);
        for tick in from..run.axes[0].len() {
            let of = |axis: usize| run.axes[axis][tick] as f64 / ONE as f64;
            let [dx, dy] = [of(0) - x, of(1) - 20.0];
            assert!((dx.hypot(dy) - 20.0).abs() < 1e-6, "{before}: tick {tick}, {dx} {dy}");
        }
    }
    let released = run("#PUT AX [X]\nG01 F6000\nG03 J20\nM30\n", &machine, &[], 40);
    assert!(released.is_err(), "an arc that moves an axis that is released");
}

/// So do the interim point of POS and the vectors of a spline: nobody names the axis, and it moves.
#[test]
fn a_curve_waits_for_the_axes_that_it_moves() {
    let machine = even::<3>(1000);
    let begins = "X[OSC ON 1ST_POS=-20 2ND_POS=20 FEED=6000]\nG01 F6000\n";
    for (curve, from) in [
        ("#CONTOUR MODE ON [POS PRE_DIST=2 POST_DIST=2 X60 Y10 Z0]\nY10\nZ10\nY0", 45.0),
        (
            "#AKIMA TRANS [START=USER END=USER]\n#AKIMA STARTVECTOR X1 Y0 Z0\n#AKIMA ENDVECTOR X1 Y1 Z0\n\
             #SPLINE ON\nY10\nZ10 Y20\nY40\nG150",
            20.5,
        ),
    ] {
        // The same path from a program in which X stands there.
        let beside = good(&format!("{begins}{curve}\nM30\n"), &machine);
        let alone = good(&format!("G01 F6000 X20\n{curve}\nM30\n"), &machine);
        let most = |run: &Run, axis: usize| {
            let at = run.axes[axis].iter().max().copied().unwrap_or_default();
            at as f64 / ONE as f64
        };
        assert!(most(&beside, 0) > from, "{curve}: {}", most(&beside, 0));
        for axis in 0..3 {
            let off = (most(&beside, axis) - most(&alone, axis)).abs();
            assert!(off < 0.02, "{curve}: axis {axis} is {off} mm off");
        }
        assert_eq!(beside.ends(), alone.ends(), "{curve}");
    }
}

/// NC-010. Every word, D3-271: the slope of SLOPE_TYPE.
#[test]
fn words_d3_271() {
    let machine = even::<3>(1000);
    let alone = |words: &str| good(&format!("G92 X2\nX[INDP_SYN {words}]\nM30\n"), &machine);
    let time = |words: &str| {
        let run = alone(words);
        assert_eq!(run.ends()[0], 20.0, "{words}");
        last_move(&run, 0) - first_move(&run, 0) + 1
    };
    let trapez = time("G01 G90 POS=20 FEED=6000");
    // 20 mm at 100 mm/s, a 2000, ramps 50 ms.
    assert_eq!(trapez, 300);
    let text = "X[INDP_SYN G01 G90 POS=20 FEED=6000 SLOPE_TYPE=STEP]\nM30\n";
    let stepped = run(text, &machine, &[], 40).expect(text);
    assert_eq!(last_move(&stepped, 0) - first_move(&stepped, 0) + 1, 300, "100 mm/s at 1000 mm/s²");
    assert_eq!(time("G01 G90 POS=20 FEED_MAX_WEIGHT=50"), 300);
    assert_eq!(time("G01 G90 POS=20 TIME=0.5"), 500);
    assert_eq!(time("G01 G91 POS=20 TIME=0.5"), 500);
    assert_eq!(time("G01 G90 POS=18 TIME=0.5 INCL_OFFSETS"), 500);
    assert!(time("G01 G90 POS=20 FEED=6000 ACC_WEIGHT=50") > trapez + 40);
    assert!(time("G01 G90 POS=20 FEED=6000 RAPID_ACC_WEIGHT=50") == trapez);
    let rapid = time("G00 G90 POS=20");
    assert!(rapid < trapez && time("G00 G90 POS=20 RAPID_ACC_WEIGHT=50") > rapid);
    assert_eq!(time("G90 POS=20"), rapid);
    let text = "G92 X2\nX[INDP_SYN G01 G90 POS=20 FEED=6000 SLOPE_TYPE=SIN2]\nM30\n";
    let sine = run(text, &machine, &[], 40).expect(text);
    sine.keeps_limits(&machine, 2, false).expect(text);
    assert_ne!(sine.axes[0], alone("G01 G90 POS=20 FEED=6000").axes[0]);
    let out = alone("G01 G90 POS=20 FEED=6000 M7 H8").outputs;
    assert_eq!(out.len(), 2);
    assert_eq!(
        alone("G01 G90 POS=20 TIME=0.05").warnings.iter().map(|w| w.id()).collect::<Vec<_>>(),
        [900_002]
    );
}

/// 50603, and what this version does not do.
#[test]
fn words_that_do_not_go_together() {
    let machine = even::<3>(1000);
    for (words, says) in [
        ("G00 G90 POS=20 FEED=100", "G00 has no"),
        ("G01 G90 POS=20", "G01 has one"),
        ("G01 G90 POS=20 FEED=100 TIME=1", "G01 has one"),
        ("G01 G90 POS=20 FEED_MAX_WEIGHT=100", "below 100"),
        ("G01 G90 FEED=100", "missing"),
        ("G01 G90 POS=20 FEED=100 CURVE=1", "unknown keyword"),
        ("G100 G90 POS=20 FEED=100", "not available"),
        ("G01 G90 POS=20 FEED=100 DRY_RUN", "not available"),
        ("G01 G90 POS=200000 FEED=100", "out of range"),
    ] {
        let error = run(&format!("X[INDP_SYN {words}]\n"), &machine, &[], 40).expect_err(words);
        assert!(error.contains(says), "{words}: {error}");
    }
}

/// Feed hold and override act; the reduced speed too.
#[test]
fn the_operator_acts() {
    let mut machine = even::<3>(1000);
    machine.axes[0].vb_max_red = 20_000;
    let text = "X[INDP_SYN G01 G90 POS=50 FEED=6000]\nM30\n";
    let length = |acts: &[(usize, Act)]| {
        let run = run(text, &machine, acts, 40).expect("it runs");
        run.keeps_limits(&machine, 1, false).unwrap_or_else(|error| panic!("{acts:?}: {error}"));
        assert_eq!(run.ends()[0], 50.0);
        last_move(&run, 0)
    };
    let plain = length(&[]);
    assert!(length(&[(0, Act::Override(500))]) > plain + 400);
    assert!(length(&[(200, Act::Override(500)), (400, Act::Override(1000))]) > plain + 50);
    assert!(length(&[(200, Act::Override(500))]) > plain + 250);
    assert!(length(&[(200, Act::Override(1500))]) < plain - 50);
    assert!(length(&[(200, Act::Hold), (600, Act::Resume)]) > plain + 300);
    assert!(length(&[(200, Act::Override(0)), (600, Act::Override(1000))]) > plain + 300);
    assert!(length(&[(200, Act::Reduced(true))]) > plain + 1000);
}

/// D3-271: the override that rises or falls at any tick of an independent motion, while the axis speeds up, runs and slows
/// down, keeps velocity, acceleration and jerk.
#[test]
fn an_override_at_any_tick_keeps_the_limits() {
    let text = "X[INDP_SYN G01 G90 POS=12 FEED=9000]\nM30\n";
    for slope in [1, 2, 3] {
        let mut machine = even::<3>(1000);
        machine.channel.slope_profile = slope;
        for at in 1..260 {
            for [first, second] in [[400, 1000], [1000, 2000], [2000, 300]] {
                let acts = [(0, Act::Override(first)), (at, Act::Override(second))];
                let run = run(text, &machine, &acts, 40).expect("it runs");
                let kept = run.keeps_limits(&machine, slope, false);
                kept.unwrap_or_else(|error| panic!("slope {slope}, {acts:?}: {error}"));
                assert_eq!(run.ends()[0], 12.0);
            }
        }
    }
}

/// A program of path motions, oscillations and independent axes, and where its axes end: unknown behind an
/// OFF INSTANT.
fn program(random: &mut Random) -> (String, [Option<f64>; 3], u32) {
    let names = ["X", "Y", "Z"];
    let mut text = String::new();
    let (mut ends, mut told) = ([Some(0.0); 3], 0);
    let position = |random: &mut Random| ((random.unit() - 0.5) * 40_000.0).round() / 1000.0;
    for _ in 0..2 + random.bits() % 8 {
        let k = (random.bits() % 3) as usize;
        let (axis, to, feed) = (names[k], position(random), random.magnitude(100.0, 20_000.0).round());
        told |= 1 << k;
        let line = match random.bits() % 10 {
            0..=2 => {
                let other = (k + 1) % 3;
                let second = position(random);
                told |= 1 << other;
                (ends[k], ends[other]) = (Some(to), Some(second));
                format!("G90 G01 {axis}{to} {}{second} F{feed}", names[other])
            }
            3 => {
                ends[k] = Some(to);
                format!("G90 G00 {axis}{to}")
            }
            4..=6 => {
                let mut from = position(random);
                if from == to {
                    from += 1.0;
                }
                ends[k] = Some(to);
                let pace = match random.bits() % 3 {
                    0 => format!("FEED={feed}"),
                    1 => format!("FREQ={:.3}", random.magnitude(0.3, 8.0)),
                    _ => format!("TIME={:.3}", random.magnitude(0.2, 3.0)),
                };
                let mut line = format!("{axis}[OSC ON 1ST_POS={from} 2ND_POS={to} {pace}");
                if random.once_in(3) {
                    line +=
                        &format!(" 1ST_DELT={:.3} 2ND_DELT={:.3}", random.unit() * 0.1, random.unit() * 0.1);
                }
                if random.once_in(2) {
                    line += &format!(" NBR_OSC={}", 1 + random.bits() % 4);
                }
                format!("{line}]\nG04 {:.3}", random.unit())
            }
            7 => {
                let off = ["OFF", "OFF FEED=4000", "OFF INSTANT"][(random.bits() % 3) as usize];
                if off.ends_with('T') {
                    ends[k] = None;
                }
                format!("{axis}[OSC {off}]")
            }
            8 => {
                ends[k] = Some(to);
                let word = if random.once_in(2) { "INDP_SYN" } else { "INDP_ASYN" };
                let slope = ["", " SLOPE_TYPE=TRAPEZ", " ACC_WEIGHT=60"][(random.bits() % 3) as usize];
                match random.once_in(3) {
                    true => format!("{axis}[{word} G00 G90 POS={to}]"),
                    false => format!("{axis}[{word} G01 G90 POS={to} FEED={feed}{slope}]"),
                }
            }
            _ => "#WAIT INDP ALL".to_owned(),
        };
        text += &line;
        text.push('\n');
    }
    (text + "M30\n", ends, told)
}

/// Filters of any type, order and share behind the axes, in every second program; AX_DEV in some of them.
fn with_filters(seed: u64, machine: &mut MachineData<3>) -> Option<f64> {
    let mut random = Random::new(seed ^ 0xf117);
    if seed % 8 < 4 {
        return None;
    }
    // One filter at least.
    for (k, axis) in machine.axes.iter_mut().enumerate() {
        permit_filters(axis, machine.channel.cycle_us);
        axis.filter.enable = true;
        axis.filter.kind = FilterType::of_number(if k == 0 { 1 } else { 0 } + (random.bits() % 4) as u8);
        let highest = if axis.filter.kind == FilterType::Delay { 100 } else { 200 };
        axis.filter.order = random.magnitude(1.0, highest as f64) as u8;
        axis.filter.share = if random.once_in(2) { 100 } else { (random.bits() % 101) as u8 };
    }
    random.once_in(2).then(|| random.magnitude(1e-3, 1.0))
}

/// Every axis stays within AX_DEV of its set point delayed by the filters.
fn keeps_ax_dev(run: &Run, machine: &MachineData<3>, tolerance: f64) -> Result<(), String> {
    if !run.deviated.is_empty() {
        return Err(format!("axes {:?} beyond AX_DEV", run.deviated));
    }
    let delay = machine.axes.iter().map(|axis| match axis.filter.kind {
        FilterType::None => 0,
        FilterType::Delay => 2 * usize::from(axis.filter.order),
        _ if axis.filter.share == 0 => 0,
        _ => usize::from(axis.filter.order),
    });
    let delay = delay.max().unwrap_or(0);
    for (k, (y, x)) in run.axes.iter().zip(&run.path).enumerate() {
        for tick in 0..y.len() {
            let ago = |ticks: usize| x[tick.saturating_sub(ticks)];
            let off = (2 * y[tick] - ago(delay / 2) - ago(delay.div_ceil(2))) as f64 / 2.0 / ONE as f64;
            if off.abs() > tolerance + 1e-9 {
                return Err(format!("axis {k}, tick {tick}: {off} beyond {tolerance}"));
            }
        }
    }
    Ok(())
}

/// Runs a program alone and with an operator; whether both came to an end.
fn check(seed: u64) -> Result<bool, String> {
    let mut machine = machines::arbitrary::<3>(seed);
    let tolerance = with_filters(seed, &mut machine);
    let slope = (seed % 4) as u8;
    machine.channel.slope_profile = slope;
    machine.channel.corr_v_trans_jerk = true;
    machine.channel.exact_stop_indp = (seed / 16 % 3) as u8;
    for axis in &mut machine.axes {
        axis.a_trans_weight = 0;
        axis.vb_max_red = axis.vb_max / 3 + 1;
    }
    let mut random = Random::new(seed ^ 0x5eed);
    let (mut text, ends, told) = program(&mut random);
    if seed / 48 % 2 == 1 {
        text = format!("G360\n{text}");
    }
    if let Some(tolerance) = tolerance {
        text = format!("#FILTER [AX_DEV={tolerance:.6}]\n{text}");
    }
    // Motions with SLOPE_TYPE=TRAPEZ have the accelerations of that slope.
    let judged = if text.contains("SLOPE_TYPE") && slope == 0 { None } else { Some(slope) };
    let fault = |what: String| format!("seed {seed}: {what}\n{text}");
    let all = |run: &Run, acts: &[(usize, Act)], ends_there: bool| {
        let fault = |what: String| fault(format!("{what}\n{acts:?}"));
        if let Some(slope) = judged {
            run.keeps_limits(&machine, slope, true).map_err(fault)?;
        }
        if let Some(tolerance) = tolerance {
            keeps_ax_dev(run, &machine, tolerance).map_err(fault)?;
        }
        let last: Vec<i64> = run.axes.iter().map(|x| *x.last().expect("a tick")).collect();
        if last != run.position {
            return Err(fault(format!("stands at {last:?}, the planner has {:?}", run.position)));
        }
        for (k, end) in ends.iter().enumerate() {
            let is_told = told >> k & 1 == 1;
            if !is_told && run.axes[k].iter().any(|x| *x != 0) {
                return Err(fault(format!("axis {k} moves")));
            }
            if let Some(end) = end.filter(|_| ends_there)
                && (last[k] as f64 / ONE as f64 - end).abs() > 1e-9
            {
                return Err(fault(format!("axis {k} ends at {}, not {end}", last[k] as f64 / ONE as f64)));
            }
        }
        Ok(())
    };
    let plain = match run(&text, &machine, &[], 40) {
        // An oscillation of some micrometres is as slow on its way to the first position; a narrow AX_DEV.
        Err(what) if what == TOO_LONG || what.contains("raise F") => return Ok(false),
        run => run.map_err(fault)?,
    };
    all(&plain, &[], true)?;
    let ticks = plain.states.len();
    let mut acts = random_acts(&mut random, ticks);
    let aborts = acts.iter().any(|(_, act)| *act == Act::Abort);
    if random.once_in(2) {
        acts = with_overrides(&mut random, ticks, acts);
    }
    if random.once_in(2) {
        acts = with_stalls(&mut random, ticks, acts);
    }
    let is_slowed = acts.iter().any(|(_, act)| matches!(act, Act::Override(_)));
    let polls = [12, 40][(seed % 2) as usize];
    let run = match run(&text, &machine, &acts, polls) {
        // A low override, or a long program with rests: no end in sight, no fault.
        Err(what) if what == TOO_LONG && (ticks > LONGEST / 2 || is_slowed) => {
            return Ok(false);
        }
        run => run.map_err(|what| fault(format!("{what}\n{acts:?}")))?,
    };
    all(&run, &acts, !aborts).map(|()| true)
}

/// GLIDEPATH_SEEDS: how many; GLIDEPATH_FROM: the first one. 20,000 take four minutes:
/// `GLIDEPATH_FROM=100000 GLIDEPATH_SEEDS=20000 cargo test -p host-tests --release --test beside independent::random`
#[test]
fn random_programs_beside_the_path() {
    let number = |name| std::env::var(name).ok().and_then(|number| number.parse().ok());
    let (from, count) = (number("GLIDEPATH_FROM").unwrap_or(0), number("GLIDEPATH_SEEDS").unwrap_or(150));
    // These stood for ever once: a counted oscillation with a wait, slowed down in its last cycle; filters behind
    // a motion to where the axis stands.
    let once = [21_131, 22_304, 215_092];
    let (mut faults, mut ended, mut all) = (Vec::new(), 0, 0);
    for seed in once.into_iter().chain(from..from + count) {
        all += 1;
        match check(seed) {
            Ok(ends) => ended += u64::from(ends),
            Err(what) => faults.push(what),
        }
    }
    println!("{ended} of {all} came to an end, {} were too long", all - ended - faults.len() as u64);
    assert!(
        faults.is_empty(),
        "{} of {all}\n{}",
        faults.len(),
        faults.iter().take(4).cloned().collect::<Vec<_>>().join("\n")
    );
    assert!(all < 100 || ended * 100 >= all * 90, "too many are too long");
}
