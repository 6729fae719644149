//! Many commands during the whole program: holds, overrides from 0 to 200 %, reduced speed, in lines, in
//! corners with and without curves, and in Surface. Checks the limits of every axis at every tick, and the
//! end.
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::quantity::Position;
use host_tests::cases::random::Random;
use host_tests::check;
use host_tests::operate::{Act, operate_within};
use host_tests::properties::permitted;
use host_tests::seeds::seeds;

/// Unequal axes.
fn machine(slope: u8) -> MachineData<3> {
    let axis = |name, a: u32, v: u32| AxisData {
        a_max: a,
        a_beschl: a,
        a_brems: a,
        a_grenz: a,
        vb_max: v,
        vb_eilgang: v,
        vb_max_red: v / 8,
        tr_geom: 50_000,
        tr_grenz: 50_000,
        ..AxisData::new(AxisName::new(name).expect("a name"), AxisKind::Linear)
    };
    let axes = [axis("X", 2000, 300_000), axis("Y", 1500, 250_000), axis("Z", 800, 100_000)];
    let channel =
        ChannelData { slope_profile: slope, corr_v_trans_jerk: true, surface: true, ..ChannelData::new() };
    MachineData { axes, channel }
}

/// A program of lines of a millimetre to a hundred, and its end.
fn program(random: &mut Random) -> (String, [f64; 3]) {
    let (mut text, mut end) = (String::from("F6000\n"), [0.0; 3]);
    for _ in 0..100 {
        text += match random.bits() % 12 {
            0 | 1 => "#CONTOUR MODE ON [DEV PATH_DEV=0.1]\n",
            2 => "#CONTOUR MODE OFF\n",
            3 => "#HSC ON [SURFACE PATH_DEV=0.05]\n",
            4 => "#HSC OFF\n",
            _ => {
                let size = [1.0, 10.0, 100.0][(random.bits() % 3) as usize];
                end = end.map(|_| ((random.unit() - 0.5) * size * 16.0).round() / 16.0);
                text += &format!("G01 X{} Y{} Z{}\n", end[0], end[1], end[2]);
                continue;
            }
        };
    }
    (text + "#HSC OFF\nM30\n", end)
}

/// A command about every 20 ticks, and at last none that holds.
fn commands(random: &mut Random, ticks: usize) -> Vec<(usize, Act)> {
    let mut acts = Vec::new();
    for tick in 0..ticks {
        let act = match random.bits() % 300 {
            0 => Act::Hold,
            1..=4 => Act::Resume,
            10 => Act::Override((random.unit() * 2000.0) as u16),
            20 => Act::Override((random.unit() * 20.0) as u16),
            11..=14 => Act::Override(1000),
            16 => Act::Reduced(true),
            17..=19 => Act::Reduced(false),
            _ => continue,
        };
        acts.push((tick, act));
    }
    acts.extend([Act::Resume, Act::Override(1000), Act::Reduced(false)].map(|act| (ticks, act)));
    acts
}

fn run(seed: u64) -> Result<(), String> {
    let mut random = Random::new(seed);
    let slope = (seed % 4) as u8;
    let machine = machine(slope);
    let (text, end) = program(&mut random);
    let acts = commands(&mut random, 30_000);
    let run = operate_within::<3, 120>(&text, [Position::ZERO; 3], &machine, (&acts, 1000), 1_000_000)?;
    let limits: Vec<_> = machine.axes.iter().map(|axis| permitted(axis, slope, false, true, true)).collect();
    check::limits(&run.trace, &limits)?;
    let last = run.trace.mm(run.trace.len() - 1);
    if last != end {
        return Err(format!("ends at {last:?}, not at {end:?}"));
    }
    Ok(())
}

/// In the last of the fixed seeds a hold ends an acceleration in a curve, while a part of the curve that bends
/// otherwise comes.
#[test]
fn dense_commands_keep_all_limits() {
    for seed in seeds((0..200).chain([104_265]), 50) {
        run(seed).unwrap_or_else(|fault| panic!("seed {seed}: {fault}"));
    }
}
