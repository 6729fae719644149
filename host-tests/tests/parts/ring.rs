//! The rings between planner and interrupt: their content, the curve that a tick finds, and the curves that
//! are taken back.
use glidepath::path::{LONGEST, Measure, Shape, line};
use glidepath::quantity::{Distance, Position};
use glidepath::queue::{
    CurveConsumer, CurveProducer, CurveRing, MAX_CURVES_PER_TICK, Ring, SEGMENTS, Segment, Slot,
};
use host_tests::cases::random::Random;

/// Curves of the look-ahead.
const AHEAD: usize = 23;
const ALL: usize = AHEAD + SEGMENTS;

/// A tick is on no curve so far behind the path that the interrupt knows: 2^61.
const FAR: i64 = 1 << 61;

fn shape(length: i64) -> Shape<1> {
    let measure = Measure::new([Some(0), None, None], [0].into_iter(), [].into_iter());
    let line = line(&[Position::ZERO], &[Position::ONE], &measure).expect("no error").expect("it moves");
    let mut shape = line.shape;
    shape.length = Distance::from_bits(length);
    shape
}

/// Puts in a curve of that length, with its number as block; its start.
fn put(layer: &mut CurveProducer<'_, 1>, length: i64) -> i64 {
    let (number, start) = (layer.count(), layer.end().to_bits());
    assert!(!layer.is_full());
    let base = [Position::from_bits(i64::from(number))];
    assert!(layer.push(&shape(length), &base, number.wrapping_mul(10), number));
    assert_eq!(layer.end().to_bits(), start.wrapping_add(length));
    start
}

fn found(follower: &mut CurveConsumer<'_, 1>, distance: i64) -> Option<(u32, i64)> {
    let on = |segment: &Segment<1>, number: u32| {
        assert_eq!(segment.n, number.wrapping_mul(10));
        assert_eq!(*segment.base(), [Position::from_bits(i64::from(number))]);
    };
    let (lower, along) = follower.follow(distance).map(|(track, along)| {
        on(track.segment, track.segment.base()[0].to_bits() as u32);
        (track.segment.block(), along)
    })?;
    let segment = follower.peek(distance).expect("a curve");
    let number = follower.block_of(segment);
    on(segment, number);
    assert_eq!(number as u16, lower);
    Some((number, along))
}

/// Every fill, every number of curves that have begun, and the seams of both arrays at several places.
/// Whether curves are handed on makes no difference.
#[test]
fn a_tick_passes_to_the_last_curve_that_has_begun() {
    const LENGTH: i64 = 10;
    for seam in [0, 1, 17, 53, 54, 55, 85, 86, 87, 88, 119, 120, 121, 122, 175] {
        for curves in (1..=ALL as u32).step_by(if seam % 2 == 0 { 1 } else { 3 }) {
            for begun in 1..=curves.min(MAX_CURVES_PER_TICK + 1) {
                let mut course = CurveRing::<1, AHEAD>::new();
                let (mut layer, mut follower) = course.split();
                assert_eq!((layer.ahead(), layer.len(), layer.is_empty()), (AHEAD, 0, true));
                assert_eq!(found(&mut follower, -1), None);
                assert_eq!(found(&mut follower, 0), None);
                assert!(follower.peek(0).is_none());
                for number in 0..seam {
                    let start = put(&mut layer, LENGTH);
                    assert_eq!(found(&mut follower, start + LENGTH - 1), Some((number, LENGTH - 1)));
                }
                layer.hand_on(seam);
                // The last of them is still held.
                let held = layer.count() - u32::from(seam > 0);
                let first = i64::from(held) * LENGTH;
                for _ in layer.count()..held + curves {
                    put(&mut layer, LENGTH);
                }
                assert_eq!(layer.is_full(), curves == ALL as u32);
                assert_eq!(layer.known(), layer.end());
                let more = if begun % 2 == 0 { 0 } else { held + curves - layer.handed() };
                layer.hand_on(more);
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

#[test]
fn a_full_ring_takes_nothing() {
    let mut course = CurveRing::<1, AHEAD>::new();
    let (mut layer, mut follower) = course.split();
    for _ in 0..ALL {
        put(&mut layer, 10);
    }
    let end = layer.end();
    assert!(!layer.push(&shape(10), &[Position::ZERO], 0, 0));
    assert_eq!((layer.count() as usize, layer.end()), (ALL, end));
    assert_eq!(found(&mut follower, 10), Some((1, 0)));
    put(&mut layer, 10);
    assert!(layer.is_full());
}

/// Where the motion ends with the last curve handed on, the interrupt is on the next one: it counts as on the
/// last one.
#[test]
fn curves_handed_on_are_counted_apart_from_those_of_the_look_ahead() {
    let mut course = CurveRing::<1, 100>::new();
    let (mut layer, mut follower) = course.split();
    for _ in 0..100 {
        put(&mut layer, 10);
    }
    assert_eq!((layer.len(), layer.is_sated()), (0, false));
    for handed in 1..=SEGMENTS as u32 {
        layer.hand_on(1);
        assert_eq!((layer.len(), layer.is_sated()), (handed, handed == SEGMENTS as u32));
    }
    for passed in 1..SEGMENTS as u32 {
        assert_eq!(found(&mut follower, i64::from(passed) * 10), Some((passed, 0)));
        assert_eq!((layer.len(), layer.is_sated()), (SEGMENTS as u32 - passed, false));
    }
    assert_eq!(found(&mut follower, SEGMENTS as i64 * 10), Some((SEGMENTS as u32, 0)));
    assert_eq!((layer.taken(), layer.len()), (layer.handed(), 1));
}

/// Lengths from the shortest to the longest mixed, path distance beyond its range, curves taken back: against
/// a list.
#[test]
fn curves_of_all_lengths_are_found() {
    let mut random = Random::new(7);
    let (mut fullest, mut withdrawn, mut passed, mut hidden, mut sated, mut alone) = (0, 0, 0, 0, 0, 0);
    for run in 0..300 {
        let mut course = CurveRing::<1, AHEAD>::new();
        let (mut layer, mut follower) = course.split();
        let mut list: Vec<(i64, i64)> = Vec::new();
        // The curve the motion is on, and those handed on.
        let (mut at, mut handed, mut distance) = (0, 0, 0);
        let lengths = [1, 1 << 20, 1 << 40, 1 << 54, 1 << 56, 1 << 60, LONGEST - 1];
        let usual = random.bits() as usize % lengths.len();
        let steps = 1 + if random.once_in(2) {
            MAX_CURVES_PER_TICK as usize
        } else {
            random.bits() as usize % MAX_CURVES_PER_TICK as usize
        };
        for _ in 0..600 {
            while !layer.is_full() && !random.once_in(40) {
                // As many as the look-ahead holds.
                if list.len() - handed >= AHEAD && !random.once_in(100) {
                    break;
                }
                let longest =
                    lengths[if random.once_in(6) { random.bits() as usize % lengths.len() } else { usual }];
                let length = random.bits() as i64 & (longest - 1) | 1;
                let start = put(&mut layer, length);
                list.push((start, length));
            }
            while handed < list.len() && !random.once_in(20) {
                // As many as the queue takes, and never more path than distances are compared over.
                let way = |to: usize| list[to - 1].0.wrapping_add(list[to - 1].1).wrapping_sub(list[at].0);
                let room = handed < at + SEGMENTS && (handed <= at + 1 || way(handed) <= FAR);
                assert_eq!(layer.is_sated(), !room, "run {run}, {at} {handed}");
                if !room {
                    sated += usize::from(handed < at + SEGMENTS);
                    break;
                }
                layer.hand_on(1);
                handed += 1;
            }
            for (number, (start, length)) in (0..).zip(&list).skip(at) {
                let ends = [layer.start(number), layer.end_of(number)];
                assert_eq!(ends, [*start, start.wrapping_add(*length)], "run {run}, curve {number}");
            }
            if handed == 0 {
                continue;
            }
            fullest = fullest.max(list.len() - at);
            if random.once_in(40) {
                // What the interrupt has not reached is taken back, as after an abort; or only the
                // look-ahead.
                let left = if random.once_in(2) { at + 1 } else { handed.max(at + 1) };
                withdrawn += list.len() - left;
                list.truncate(left);
                layer.withdraw(left as u32);
                handed = left;
                let (start, length) = list[left - 1];
                assert_eq!(layer.end().to_bits(), start.wrapping_add(length));
                assert_eq!((layer.count(), layer.handed()), (left as u32, left as u32));
            }
            // What is handed on is known, and of the look-ahead what can be.
            let known = list.iter().position(|(start, _)| *start == layer.known().to_bits());
            let known = known.unwrap_or(list.len());
            assert!(known >= handed, "run {run}");
            hidden += list.len() - known;
            let before = at;
            // Without the planner it goes into the look-ahead, as far as it knows it.
            let last = if random.once_in(8) { known.max(at + 1) } else { handed.max(at + 1) };
            at = (at + random.bits() as usize % steps).min(last - 1);
            alone += usize::from(at >= handed);
            // A tick does not go further than that.
            while at > before && list[at].0.wrapping_sub(distance) > FAR {
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
    assert!(
        fullest == ALL
            && passed == MAX_CURVES_PER_TICK as usize
            && [withdrawn, hidden, sated, alone].iter().all(|times| *times > 1000),
        "{fullest} {withdrawn} {passed} {hidden} {sated} {alone}"
    );
}

/// A planner that gets no time any more leaves the interrupt with a way ahead of it.
#[test]
fn a_way_to_a_standstill_is_known_as_far_as_distances_are_compared() {
    let mut course = CurveRing::<1, AHEAD>::new();
    let (mut layer, mut follower) = course.split();
    // One that is handed on, and the look-ahead behind it.
    for _ in 0..AHEAD {
        put(&mut layer, FAR / 4);
    }
    layer.hand_on(1);
    let known = layer.known().to_bits();
    assert!(known >= 2 * FAR && layer.end().to_bits().wrapping_sub(known) > 0, "{known}");
    // Without another word of the planner the interrupt goes as far as that.
    for number in 1..(known / (FAR / 4)) as u32 {
        let start = i64::from(number) * (FAR / 4);
        assert_eq!(found(&mut follower, start + 5), Some((number, 5)));
    }
    // The next word tells it the rest.
    layer.hand_on(1);
    assert!(layer.known().to_bits().wrapping_sub(known) > FAR);
}

/// An item that says which one it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Numbered(u32);

impl Slot for Numbered {
    const BLANK: Self = Self(0);
}

/// Of the items put in, the planner sees the last ones, as many as there are slots, whatever the interrupt
/// has taken.
#[test]
fn a_ring_holds_as_many_items_as_it_has_slots_and_shows_the_last_ones() {
    const SLOTS: u32 = 8;
    for taken_at_once in 1..=SLOTS {
        let mut ring = Ring::<Numbered, { SLOTS as usize }>::new();
        let (mut producer, mut consumer) = ring.split();
        assert!(producer.is_empty() && consumer.is_empty() && consumer.peek().is_none());
        let mut taken = 0;
        for count in 0..5 * SLOTS {
            if producer.is_full() {
                assert_eq!((producer.len(), producer.room(), consumer.len()), (SLOTS, 0, SLOTS));
                assert_eq!(producer.push(Numbered(count)), Err(Numbered(count)));
                for _ in 0..taken_at_once {
                    assert_eq!(consumer.peek(), Some(&Numbered(taken)));
                    assert_eq!(consumer.pop(), Some(Numbered(taken)));
                    taken += 1;
                }
            }
            assert_eq!((producer.count(), producer.taken()), (count, taken));
            assert_eq!((producer.len(), consumer.len()), (count - taken, count - taken));
            assert_eq!(producer.room(), SLOTS - (count - taken));
            assert_eq!((producer.is_empty(), consumer.is_empty()), (count == taken, count == taken));
            for number in 0..count + 3 {
                let known = (count.saturating_sub(SLOTS)..count).contains(&number);
                let expected = known.then_some(Numbered(number));
                assert_eq!(producer.recent(number).copied(), expected, "number {number} of {count}");
            }
            assert_eq!(producer.push(Numbered(count)), Ok(()));
        }
    }
}

/// Items are taken back down to the oldest one of which the slot is still known, and no further.
#[test]
fn a_ring_takes_back_what_it_still_holds() {
    const SLOTS: u32 = 8;
    for back in 1..=SLOTS + 2 {
        let mut ring = Ring::<Numbered, { SLOTS as usize }>::new();
        let (mut producer, mut consumer) = ring.split();
        for number in 0..2 * SLOTS {
            assert_eq!(producer.push(Numbered(number)), Ok(()));
            if number < SLOTS {
                assert_eq!(consumer.pop(), Some(Numbered(number)));
            }
        }
        assert!(producer.is_full());
        let count = 2 * SLOTS;
        producer.withdraw(count - back);
        assert_eq!(producer.count(), if back <= SLOTS { count - back } else { count }, "{back}");
        if back <= SLOTS {
            assert_eq!(producer.room(), back);
            assert_eq!(producer.push(Numbered(100)), Ok(()));
            consumer.jump(count - back);
            let mut item = Numbered::BLANK;
            assert!(!consumer.pop_into(&mut item, |item| item.0 != 100));
            assert!(consumer.pop_into(&mut item, |item| item.0 == 100));
            assert_eq!((item, consumer.is_empty()), (Numbered(100), true));
            assert!(!consumer.pop_into(&mut item, |_| true));
        }
    }
}
