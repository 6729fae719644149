//! Damaged bytes for a machine with soft limits: number of answers, agreement after a line end, and travel.
mod bench;

use bench::corruption::Random;
use bench::world::{Rig, World, settings, with_rig};

/// Lines that a sender may send.
fn line(random: &mut Random) -> String {
    let place = |random: &mut Random| format!("{}.{}", random.below(70) as i64 - 65, random.below(1000));
    let (x, z) = (place(random), place(random));
    match random.below(16) {
        0..=4 => format!("G1X{x}Z{z}F{}", random.below(6000)),
        5 => format!("G0Y{x}"),
        6 => format!("G2X{x}Z{z}R{}", random.below(90)),
        7 => format!("$J=G91X{x}F{}", random.below(100_000)),
        8 => format!("$J=G53Y{x}F3000"),
        9 => "G91".into(),
        10 => "G90".into(),
        11 => format!("G92X{x}"),
        12 => format!("G10L20P1X{x}"),
        13 => "$G".into(),
        14 => format!("G3X{x}Y{z}I{}J{}F2000", random.below(20), random.below(20)),
        _ => "M3S500".into(),
    }
}

/// The text of lines, with flips, losses and repeats.
fn damaged(text: &str, random: &mut Random) -> Vec<u8> {
    let mut bytes = Vec::new();
    for byte in text.bytes() {
        match random.below(60) {
            0 => bytes.push(byte ^ 1 << random.below(8)),
            1 => {}
            2 => bytes.extend([byte, byte]),
            3 => bytes.extend([b'?', byte]),
            _ => bytes.push(byte),
        }
    }
    bytes
}

/// Everything is carried out, and one line end brings both sides in step.
fn in_step(rig: &mut Rig<'_>, seed: u64) {
    rig.send("\n~");
    for _ in 0..300 {
        rig.ticks(20);
        rig.send("~");
        if ["Idle", "Alarm", "Check", "Sleep"].contains(&rig.state().as_str()) {
            break;
        }
    }
    rig.send([0x18]);
    rig.ticks(400);
    rig.read();
    rig.send("$X\n");
    rig.ticks(5);
    let said = rig.read();
    assert!(said.ends_with("ok\r\n") && said.matches("ok\r\n").count() == 1, "seed {seed}: {said}");
}

fn talk(seed: u64, lines: u32) {
    let mut settings = settings();
    (settings.homing, settings.soft_limits) = (true, true);
    let mut world = World::new(seed);
    world.limits = [None; bench::AXES];
    with_rig(&settings, world, |rig| {
        let mut random = Random(seed);
        rig.ask("$X");
        for count in 0..lines {
            let text = line(&mut random) + "\n";
            let bytes = damaged(&text, &mut random);
            rig.send(bytes);
            rig.ticks(random.below(60) as u32);
            if count % 40 == 39 {
                in_step(rig, seed);
            }
            // Settings and zero offsets may be damaged too; travel is that of the machine.
            for (least, most) in rig.world.seen {
                assert!(least >= -60.0 && most <= 0.0, "seed {seed}: {least}…{most}");
            }
        }
        assert!(rig.world.seen.iter().all(|(least, _)| *least < -5.0), "seed {seed}: {:?}", rig.world.seen);
    });
}

#[test]
fn damaged_bytes_lead_no_axis_beyond_its_travel() {
    let fresh = bench::fresh_seed();
    for seed in (0..6).chain(fresh..fresh + 3) {
        talk(seed, 400);
    }
}

/// Half an hour.
#[test]
#[ignore = "many seeds"]
fn many_damaged_bytes_lead_no_axis_beyond_its_travel() {
    for seed in 1000..3000 {
        talk(seed, 4000);
    }
}
