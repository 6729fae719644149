//! Homing on random machines: simulated switches with hysteresis and bounce, and a hard stop after each
//! switch.
use super::AXES;
use super::corruption::Random;
use super::world::{SLOTS, Switch, World, settings, with_rig};

/// Way between a switch and what it protects.
pub const HARD_STOP: f64 = 5.0;

/// What a homing cycle came to.
pub struct Homed {
    /// Largest distance between the place of an axis and its switch, in ways of a slot at the speed of the second visit.
    pub stray: f64,
    /// Farthest way of an axis behind its switch, mm.
    pub beyond: f64,
}

/// One homing cycle on a machine that nobody has seen before.
pub fn home(seed: u64) -> Homed {
    let mut random = Random(seed);
    let mut part =
        |from: f64, to: f64| from + (to - from) * random.below(1 << 20) as f64 / f64::from(1 << 20);
    let mut settings = settings();
    settings.homing = true;
    settings.homing_mask = part(0.0, 7.99) as u8;
    settings.seek_milli = part(300_000.0, 1_500_000.0) as u32;
    settings.locate_milli = part(20_000.0, 120_000.0) as u32;
    settings.pull_off_milli = part(500.0, 3000.0) as u32;
    settings.debounce_ms = part(1.0, 20.0) as u8;
    let mut world = World::new(seed);
    for axis in 0..AXES {
        let direction = if settings.homing_mask >> axis & 1 == 1 { -1.0 } else { 1.0 };
        let mut switch = Switch::new(direction * part(0.3, 40.0), direction);
        // Up to two milliseconds.
        switch.bounce = part(0.0, 40.0) as u16;
        world.limits[axis] = Some(switch);
    }
    with_rig(&settings, world, |rig| {
        rig.read();
        assert_eq!(rig.ask("$H"), "ok\n", "seed {seed}");
        let mut homed = Homed { stray: 0.0, beyond: rig.world.beyond };
        assert!(rig.world.beyond < HARD_STOP, "seed {seed}: {} mm behind a switch", rig.world.beyond);
        // The way of a slot at the speed of the second visit, and the last bits.
        let slot = f64::from(settings.locate_milli) / 60e6 / f64::from(SLOTS);
        for axis in 0..AXES {
            let switch = rig.world.limits[axis].expect("a switch");
            let off = f64::from(settings.pull_off_milli) / 1000.0;
            let travel = f64::from(settings.axes[axis].travel_milli) / 1000.0;
            let wanted = if switch.direction > 0.0 { -off } else { -travel + off };
            assert!((rig.at(axis) - wanted).abs() < 1e-9, "seed {seed}: {}", rig.at(axis));
            let stray = (rig.world.place(&rig.points, axis) - (switch.at - switch.direction * off)).abs();
            homed.stray = homed.stray.max(stray / slot);
            assert!(stray <= slot + 1e-8, "seed {seed}, axis {axis}: {stray} mm of {slot}");
        }
        assert_eq!(rig.state(), "Idle");
        assert_eq!(rig.ask("G0 X-10"), "ok\n");
        homed
    })
}
