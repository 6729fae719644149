//! The ring of curves between planner and interrupt: which one a tick finds, and which it gives back.
use glidepath::path::LONGEST;
use glidepath::quantity::Distance;
use glidepath::queue::{Course, Follower, Layer, MOST, SEGMENTS, Segment, Slot};
use host_tests::cases::random::Random;

/// Puts in a curve of that length behind the path distance `end`, with its number as block.
fn put(layer: &mut Layer<'_, 1>, end: &mut i64, length: i64) {
    let number = layer.count();
    assert!(!layer.is_full());
    assert!(layer.push_with(|segment| {
        *segment = Segment::BLANK;
        segment.shape.length = Distance::from_bits(length);
        segment.start = Distance::from_bits(*end);
        segment.block = number;
    }));
    *end = end.wrapping_add(length);
}

fn found(follower: &mut Follower<'_, 1>, distance: i64) -> Option<(u32, i64)> {
    follower.follow(distance).map(|(segment, along)| (segment.block, along))
}

/// Every fill, every number of curves that have begun, and the seam of the array at several places.
#[test]
fn a_tick_passes_to_the_last_curve_that_has_begun() {
    const LENGTH: i64 = 10;
    for seam in [0, 1, 17, 40, 63, 64, 90, 94, 95, 96, 127, 128, 200] {
        for curves in 1..=SEGMENTS as u32 {
            for begun in 1..=curves.min(MOST + 1) {
                let mut course = Course::<1>::new();
                let (mut layer, mut follower) = course.split();
                let mut end = -7;
                assert_eq!(found(&mut follower, end), None);
                for number in 0..seam {
                    put(&mut layer, &mut end, LENGTH);
                    assert_eq!(found(&mut follower, end - 1), Some((number, LENGTH - 1)));
                }
                // The last of them is still held.
                let held = layer.count() - u32::from(seam > 0);
                let first = end - i64::from(layer.count() - held) * LENGTH;
                (layer.count()..held + curves).for_each(|_| put(&mut layer, &mut end, LENGTH));
                let last = held + begun - 1;
                let start = first + i64::from(begun - 1) * LENGTH;
                for distance in [start, start + LENGTH - 1] {
                    let what = format!("{curves} curves, {begun} begun, seam {seam}");
                    assert_eq!(found(&mut follower, distance), Some((last, distance - start)), "{what}");
                    assert_eq!(layer.taken(), last, "{what}");
                }
            }
        }
    }
}

/// Lengths from the shortest to the longest mixed, path distance beyond its range, curves taken back: against a list.
#[test]
fn curves_of_all_lengths_are_found() {
    let mut random = Random::new(7);
    let (mut fullest, mut withdrawn, mut passed) = (0, 0, 0);
    for run in 0..200 {
        let mut course = Course::<1>::new();
        let (mut layer, mut follower) = course.split();
        let mut end = 0;
        let mut list: Vec<(i64, i64)> = Vec::new();
        let (mut at, mut distance) = (0, end);
        let lengths = [1, 1 << 20, 1 << 40, 1 << 54, 1 << 56, 1 << 60, LONGEST - 1];
        let usual = random.bits() as usize % lengths.len();
        for _ in 0..600 {
            while !layer.is_full() && !random.once_in(8) {
                let longest =
                    lengths[if random.once_in(6) { random.bits() as usize % lengths.len() } else { usual }];
                let length = random.bits() as i64 & (longest - 1) | 1;
                list.push((end, length));
                put(&mut layer, &mut end, length);
            }
            if list.is_empty() {
                continue;
            }
            fullest = fullest.max(list.len() - at);
            if random.once_in(40) && at + 1 < list.len() {
                // What the interrupt has not reached is taken back, as after an abort.
                list.truncate(at + 1);
                layer.withdraw(at as u32 + 1);
                end = list[at].0.wrapping_add(list[at].1);
                withdrawn += 1;
            }
            let before = at;
            at = (at + random.bits() as usize % (MOST as usize + 1)).min(list.len() - 1);
            // A tick does not go further than that.
            while at > before && list[at].0.wrapping_sub(distance) > 1 << 61 {
                at -= 1;
            }
            let (start, length) = list[at];
            let from = if at == before { distance.wrapping_sub(start).max(0) } else { 0 };
            let along = from + (random.bits() as i64 & i64::MAX) % (length - from).max(1);
            distance = start.wrapping_add(along);
            assert_eq!(found(&mut follower, distance), Some((at as u32, along)), "run {run}, curve {at}");
            passed = passed.max(at - before);
        }
    }
    assert!(fullest == SEGMENTS && withdrawn > 1000 && passed == MOST as usize);
}
