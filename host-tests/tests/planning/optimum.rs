//! The optimum along paths with changing feeds: closed forms, brute force, bounds, symmetries, and the
//! accepted table.
use host_tests::cases::feeds::{ACCELERATION, Feeds, PATHS, accepted};
use host_tests::cases::random::Random;
use host_tests::reference::optimum::anchors::{at_borders, borders, in_valleys};
use host_tests::reference::optimum::{Block, Limits, Optimum, TOLERANCE, optimum, search};
use host_tests::reference::profile::{Profile, Ramps, rest_to_rest};

/// Short paths of the table with either ramp time.
const SHORT: [u64; 8] = [1, 3, 5, 14, 16, 28, 30, 35];

fn solve(blocks: &[Block], limits: &Limits) -> Optimum {
    optimum(blocks, limits).expect("converges")
}

fn time(profiles: &[Profile]) -> f64 {
    profiles.iter().map(Profile::time).sum()
}

fn block(length: f64, speed: f64) -> Block {
    Block { length, speed }
}

/// Two times that are one optimum.
fn assert_same(a: f64, b: f64, what: &str) {
    assert!((a / b - 1.0).abs() < TOLERANCE, "{what}: {a} s, {b} s");
}

/// Samples the motion densely and compares with the limits at the place reached.
fn assert_permitted(found: &Optimum, blocks: &[Block], limits: &Limits) {
    const ROUNDING: f64 = 1e-9;
    let borders = borders(blocks);
    let length = borders[blocks.len()];
    let (mut s, mut v, mut a) = (0.0, 0.0, 0.0);
    for piece in &found.pieces {
        assert!((piece.v - v).abs() < ROUNDING * 1e3 && (piece.a - a).abs() < ROUNDING * limits.acceleration);
        assert!(piece.jerk.abs() < limits.jerk * (1.0 + ROUNDING), "jerk {}", piece.jerk);
        assert!(piece.time > 0.0);
        for i in 0..=8 {
            let [ds, v_here, a_here] = piece.at(piece.time * f64::from(i) / 8.0);
            let here = s + ds;
            assert!(
                here > borders[piece.block] - ROUNDING * length
                    && here < borders[piece.block + 1] + ROUNDING * length,
                "{here} mm is not in block {}",
                piece.block
            );
            let speed = blocks[piece.block].speed;
            assert!(v_here > -1e-6 * speed && v_here < speed * (1.0 + ROUNDING), "{v_here} mm/s");
            assert!(a_here < limits.acceleration * (1.0 + ROUNDING), "{a_here} mm/s²");
            assert!(a_here > -limits.deceleration * (1.0 + ROUNDING), "{a_here} mm/s²");
        }
        let [ds, v_end, a_end] = piece.at(piece.time);
        (s, v, a) = (s + ds, v_end, a_end);
    }
    assert!((s - length).abs() < ROUNDING * length, "{s} of {length} mm");
    assert!(v.abs() < 1e-6 && a.abs() < 1e-6 * limits.acceleration, "ends with {v} mm/s, {a} mm/s²");
    let sum: f64 = found.pieces.iter().map(|p| p.time).sum();
    assert!((sum - found.time).abs() < ROUNDING * sum);
}

/// Time with unlimited jerk: speed over distance from a pass in either direction. A lower bound from other
/// formulas.
fn without_jerk_limit(blocks: &[Block], limits: &Limits) -> f64 {
    let n = blocks.len();
    let mut squares = vec![0.0; n + 1];
    for i in 1..n {
        let reached: f64 = squares[i - 1] + 2.0 * limits.acceleration * blocks[i - 1].length;
        squares[i] = reached.min(blocks[i - 1].speed.min(blocks[i].speed).powi(2));
    }
    let mut sum = 0.0;
    for i in (0..n).rev() {
        let (a, d, Block { length, speed }) = (limits.acceleration, limits.deceleration, blocks[i]);
        squares[i] = squares[i].min(squares[i + 1] + 2.0 * d * length);
        // Up to a peak, on, and down.
        let meet = (2.0 * a * d * length + d * squares[i] + a * squares[i + 1]) / (a + d);
        let peak = meet.min(speed * speed);
        let cruise = length - (peak - squares[i]) / (2.0 * a) - (peak - squares[i + 1]) / (2.0 * d);
        let v = peak.sqrt();
        sum += (v - squares[i].sqrt()) / a + (v - squares[i + 1].sqrt()) / d + cruise / v;
    }
    sum
}

/// The smallest of a function over a range: even samples, then closer and closer about the best.
fn least(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const SAMPLES: u32 = 24;
    let (mut low, mut high, mut best) = (low, high, f64::INFINITY);
    for _ in 0..8 {
        let step = (high - low) / f64::from(SAMPLES);
        let mut at = low;
        for x in (0..=SAMPLES).map(|i| low + step * f64::from(i)) {
            let value = f(x);
            if value < best {
                (best, at) = (value, x);
            }
        }
        (low, high) = ((at - 2.0 * step).max(low), (at + 2.0 * step).min(high));
    }
    best
}

#[test]
fn a_single_block_takes_the_closed_form() {
    let (a, ramp) = (ACCELERATION, 0.05);
    for length in [0.01, 0.5, 5.0, 9.9, 10.1, 30.0, 100.0] {
        let found = solve(&[block(length, 200.0)], &Limits::even(a, ramp));
        assert_permitted(&found, &[block(length, 200.0)], &Limits::even(a, ramp));
        assert_same(found.time, rest_to_rest(length, 200.0, a, ramp), "closed form");
    }
    // Speeds too low to reach the acceleration, and deceleration unlike acceleration.
    for (length, speed, deceleration) in [(20.0, 30.0, 2000.0), (20.0, 150.0, 900.0), (3.0, 150.0, 2500.0)] {
        let limits = Limits { acceleration: a, deceleration, jerk: a / ramp };
        let blocks = [block(length, speed)];
        let ramps = |a: f64| Ramps { a, up: a / limits.jerk, down: a / limits.jerk };
        let closed = Profile::fastest(length, 0.0, 0.0, speed, ramps(a), ramps(deceleration)).unwrap();
        let found = solve(&blocks, &limits);
        assert_permitted(&found, &blocks, &limits);
        assert_same(found.time, closed.time(), "closed form");
    }
}

/// A short slow block between fast ones: the acceleration rises through zero once inside it. All such motions
/// have a lowest speed, somewhere in the block.
#[test]
fn a_short_valley_takes_what_brute_force_finds() {
    let limits = Limits::even(ACCELERATION, 0.05);
    let (up, down) = (limits.accelerate(), limits.brake());
    for (blocks, at_most) in [
        ([block(30.0, 200.0), block(1.0, 50.0), block(25.0, 200.0)], 0.98),
        ([block(30.0, 200.0), block(2.0, 50.0), block(20.0, 120.0)], 0.98),
        ([block(8.0, 300.0), block(1.5, 80.0), block(14.0, 300.0)], 0.99),
    ] {
        let [first, slow, last] = blocks;
        let length = first.length + slow.length + last.length;
        let one = |v: f64, s: f64| {
            let before = Profile::fastest(s, 0.0, v, first.speed, up, down)?;
            let after = Profile::fastest(length - s, v, 0.0, last.speed, up, down)?;
            // At both ends of the slow block; highest speeds are outside.
            let enter = in_profile(&before, first.length);
            let leave = in_profile(&after, first.length + slow.length - s);
            (enter <= slow.speed * (1.0 + 1e-9) && leave <= slow.speed * (1.0 + 1e-9))
                .then(|| before.time() + after.time())
        };
        let brute = least(0.0, 1.0, |part| {
            let s = first.length + part * slow.length;
            // The higher the lowest speed the better, up to where an end of the block becomes too fast.
            let (mut low, mut high) = (1.0, slow.speed);
            for _ in 0..60 {
                let v = 0.5 * (low + high);
                if one(v, s).is_some() { low = v } else { high = v }
            }
            one(low, s).unwrap_or(f64::INFINITY)
        });
        let found = solve(&blocks, &limits).time;
        assert_same(found, brute, "brute force");
        let flat = time(&in_valleys(&blocks, &limits));
        assert!(found < at_most * flat, "{found} s; with zero acceleration at its ends {flat} s");
    }
}

/// Speed at a distance from the start of a profile.
fn in_profile(profile: &Profile, s: f64) -> f64 {
    let (mut low, mut high) = (0.0, profile.time());
    for _ in 0..60 {
        let t = 0.5 * (low + high);
        if profile.at(t).s < s { low = t } else { high = t }
    }
    profile.at(high).v
}

/// A long slow block: speed dips below its limit behind the start and before the end. Entered with
/// acceleration -e, the speed is lowest e²/2J below the limit, v e/J - e³/3J² behind the start.
#[test]
fn a_long_valley_takes_what_brute_force_finds() {
    let limits = Limits::even(ACCELERATION, 0.05);
    let (up, down, jerk) = (limits.accelerate(), limits.brake(), limits.jerk);
    for blocks in [
        [block(30.0, 200.0), block(8.0, 50.0), block(30.0, 200.0)],
        [block(40.0, 250.0), block(20.0, 90.0), block(12.0, 130.0)],
    ] {
        let [first, slow, last] = blocks;
        let dip = |e: f64| {
            (slow.speed * e / jerk - e.powi(3) / (3.0 * jerk * jerk), slow.speed - e * e / (2.0 * jerk))
        };
        let inside = |length: f64, v_in: f64, v_out: f64| {
            Profile::fastest(length, v_in, v_out, slow.speed, up, down).map_or(f64::INFINITY, |p| p.time())
        };
        // Long enough for both ends to be found one by one.
        let half = slow.length / 2.0;
        let enter = least(0.0, 1500.0, |e| {
            let (s, v) = dip(e);
            Profile::fastest(first.length + s, 0.0, v, first.speed, up, down)
                .map_or(f64::INFINITY, |p| p.time() + inside(half - s, v, slow.speed))
        });
        let leave = least(0.0, 1500.0, |e| {
            let (s, v) = dip(e);
            Profile::fastest(last.length + s, v, 0.0, last.speed, up, down)
                .map_or(f64::INFINITY, |p| p.time() + inside(half - s, slow.speed, v))
        });
        let found = solve(&blocks, &limits);
        assert_permitted(&found, &blocks, &limits);
        assert_same(found.time, enter + leave, "brute force");
        let flat = time(&in_valleys(&blocks, &limits));
        assert!(found.time < 0.99 * flat, "{} s; without dips {flat} s", found.time);
    }
}

#[test]
fn motions_are_permitted_and_between_the_bounds() {
    for number in SHORT {
        let Feeds { blocks, limits, .. } = Feeds::new(number);
        let found = solve(&blocks, &limits);
        assert_permitted(&found, &blocks, &limits);
        assert!(found.gap < TOLERANCE * found.time);
        assert!(found.time > without_jerk_limit(&blocks, &limits));
        for anchored in [at_borders(&blocks, &limits), in_valleys(&blocks, &limits)] {
            assert!(found.time < time(&anchored) * (1.0 + TOLERANCE));
        }
    }
}

/// With ramps ten times shorter a tenth remains of what the jerk limit costs.
#[test]
fn high_jerk_approaches_the_optimum_without_jerk_limit() {
    for number in [16, 30] {
        let Feeds { blocks, .. } = Feeds::new(number);
        let over = |ramp: f64| {
            let limits = Limits::even(ACCELERATION, ramp);
            solve(&blocks, &limits).time - without_jerk_limit(&blocks, &limits)
        };
        let (some, little) = (over(0.005), over(0.0005));
        assert!(some > 0.0 && little > 0.05 * some && little < 0.15 * some, "{some} s, {little} s");
    }
}

#[test]
fn finer_cells_and_other_starts_find_the_same() {
    for number in SHORT {
        let Feeds { blocks, limits, .. } = Feeds::new(number);
        let found = solve(&blocks, &limits).time;
        let start = at_borders(&blocks, &limits);
        for cell in [0.03, 0.3] {
            assert_same(search(&blocks, &limits, &start, cell).unwrap().time, found, "cells");
        }
        let mut random = Random::new(number);
        for from in [at_borders, in_valleys] {
            let slow: Vec<Block> =
                blocks.iter().map(|b| block(b.length, b.speed * random.magnitude(0.1, 1.0))).collect();
            for start in [from(&blocks, &limits), from(&slow, &limits)] {
                assert_same(search(&blocks, &limits, &start, 0.1).unwrap().time, found, "starts");
            }
        }
    }
}

/// What the estimated gap promises, a grid three times as fine confirms.
#[test]
fn the_gap_is_not_too_small() {
    for number in SHORT {
        let Feeds { blocks, limits, .. } = Feeds::new(number);
        let found = solve(&blocks, &limits);
        let fine = search(&blocks, &limits, &at_borders(&blocks, &limits), 0.03).unwrap();
        assert!(fine.time > found.time - found.gap - fine.gap, "{number}: {} s, {} s", found.time, fine.time);
    }
}

#[test]
fn backward_it_takes_as_long() {
    for number in SHORT {
        let Feeds { mut blocks, mut limits, .. } = Feeds::new(number);
        limits.deceleration *= 0.7;
        let forward = solve(&blocks, &limits).time;
        blocks.reverse();
        (limits.acceleration, limits.deceleration) = (limits.deceleration, limits.acceleration);
        assert_same(solve(&blocks, &limits).time, forward, "backward");
    }
}

#[test]
fn units_of_length_and_time_do_not_matter() {
    let Feeds { blocks, limits, .. } = Feeds::new(3);
    let found = solve(&blocks, &limits).time;
    for (length, tempo) in [(25.4, 1.0), (1.0, 60.0), (0.3, 0.1)] {
        let blocks: Vec<Block> =
            blocks.iter().map(|b| block(b.length * length, b.speed * length * tempo)).collect();
        let limits = Limits {
            acceleration: limits.acceleration * length * tempo.powi(2),
            deceleration: limits.deceleration * length * tempo.powi(2),
            jerk: limits.jerk * length * tempo.powi(3),
        };
        assert_same(solve(&blocks, &limits).time, found / tempo, "units");
    }
}

#[test]
fn blocks_cut_into_pieces_take_as_long() {
    for number in SHORT {
        let Feeds { blocks, limits, .. } = Feeds::new(number);
        let mut random = Random::new(number);
        let mut pieces = Vec::new();
        for b in &blocks {
            let part = random.between(0.05, 0.95);
            pieces.extend([part, 1.0 - part].map(|part| block(b.length * part, b.speed)));
        }
        assert_same(solve(&pieces, &limits).time, solve(&blocks, &limits).time, "pieces");
    }
}

#[test]
fn higher_limits_are_never_slower() {
    for number in SHORT {
        let Feeds { blocks, limits, .. } = Feeds::new(number);
        let before = solve(&blocks, &limits).time;
        let mut random = Random::new(number);
        for _ in 0..3 {
            let mut faster = blocks.clone();
            let i = random.bits() as usize % blocks.len();
            faster[i].speed *= random.between(1.01, 2.0);
            let after = solve(&faster, &limits).time;
            assert!(after < before * (1.0 + TOLERANCE), "{number}, block {i}: {before} s, then {after} s");
        }
        let more_jerk = Limits { jerk: 1.2 * limits.jerk, ..limits };
        assert!(solve(&blocks, &more_jerk).time < before * (1.0 - TOLERANCE));
    }
}

#[test]
fn extreme_blocks() {
    let limits = Limits::even(ACCELERATION, 0.05);
    for blocks in [
        vec![block(0.001, 300.0)],
        vec![block(0.001, 0.5), block(0.001, 300.0), block(0.001, 0.5)],
        vec![block(10.0, 300.0), block(0.001, 1.0), block(10.0, 300.0)],
        vec![block(0.001, 200.0); 300],
        (0..200).map(|i| block(0.05, 50.0 + f64::from(i))).collect(),
    ] {
        let found = solve(&blocks, &limits);
        assert_permitted(&found, &blocks, &limits);
        assert!(found.time > without_jerk_limit(&blocks, &limits));
        assert!(found.time < time(&at_borders(&blocks, &limits)) * (1.0 + TOLERANCE));
    }
}

#[test]
fn the_accepted_table_is_reproduced() {
    let table = accepted().unwrap();
    assert_eq!(table.len() as u64, PATHS);
    let mut random = Random::new(1);
    for _ in 0..12 {
        let row = &table[random.bits() as usize % table.len()];
        let path = Feeds::new(row.number);
        let again = "accept with cargo run --release -p host-tests --example optimum -- accept";
        let length: f64 = path.blocks.iter().map(|b| b.length).sum();
        assert_eq!((path.blocks.len(), path.ramp), (row.blocks, row.ramp), "path {}: {again}", row.number);
        assert!((length - row.length).abs() < 1e-4, "path {}: {again}", row.number);
        // Rounding of logarithms and roots may differ between machines, and the last refinement with it.
        for (time, accepted) in [
            (solve(&path.blocks, &path.limits).time, row.time),
            (time(&at_borders(&path.blocks, &path.limits)), row.at_borders),
            (time(&in_valleys(&path.blocks, &path.limits)), row.in_valleys),
        ] {
            let change = time / accepted - 1.0;
            assert!(
                change.abs() < 0.2 * TOLERANCE + 1e-6,
                "path {}, {time} s for {accepted} s: {again}",
                row.number
            );
        }
    }
}

/// The program of a path has its lengths and feeds.
#[test]
fn paths_as_programs() {
    for number in SHORT {
        let path = Feeds::new(number);
        let program = path.program("feeds", 3);
        assert_eq!(program.moves.len(), path.blocks.len());
        for ((block, step), end) in
            path.blocks.iter().zip(&program.moves).zip(borders(&path.blocks).iter().skip(1))
        {
            assert!((step.feed / 60.0 - block.speed).abs() < 1e-12);
            assert_eq!(step.target[0], (end * 1e6).round() as i64);
        }
    }
}
