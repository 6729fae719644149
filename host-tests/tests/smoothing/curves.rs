//! Curves of every kind in the ring between planner and interrupt: each curve is found unchanged, for every
//! size of the earlier curves, and with its motion block, for every number of merged blocks. Runs with all
//! functions and without them (`host-tests/without`), where the ring has less room for curves that are no
//! lines.
use glidepath::nc::Plane;
use glidepath::path::poly::{Draft, Knot};
use glidepath::path::{Element, End, Measure, Shape, arc, line};
use glidepath::quantity::Position;
use glidepath::queue::{CurveProducer, CurveRing, MAX_CURVES_PER_TICK, SEGMENTS, Track};

/// A linear congruential generator (Knuth).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }

    fn mm<const AXES: usize>(&mut self) -> [Position; AXES] {
        [0; AXES].map(|_| Position::from_num(self.below(2000)) / 10)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Line,
    Arc,
    Cubic,
    Quintic,
}

const KINDS: [Kind; 4] = [Kind::Line, Kind::Arc, Kind::Cubic, Kind::Quintic];

fn polynomial<const AXES: usize>(random: &mut Random, is_cubic: bool) -> Shape<AXES> {
    let end = |random: &mut Random| End {
        tangent: [0; AXES].map(|_| (random.below(2000) as i64 - 1000) << 30),
        curvature: [0; AXES].map(|_| random.below(100) as f32 / 100.0),
    };
    let from = Knot { position: random.mm(), end: end(random) };
    let to = Knot { position: random.mm(), end: end(random) };
    let (mut element, draft) = Draft::new(&from, &to, 50.0, 1.0).expect("a polynomial");
    let mut draft = if is_cubic { draft.cubic() } else { draft };
    while !draft.is_done() {
        draft.go_on(&mut element).expect("a polynomial");
    }
    element.shape
}

fn shape<const AXES: usize>(kind: Kind, random: &mut Random) -> Shape<AXES> {
    let measure = Measure::new([Some(0), Some(1), None], [0, 1].into_iter(), [].into_iter());
    let element: Element<AXES> = loop {
        let (from, mut to) = (random.mm(), random.mm());
        match kind {
            Kind::Cubic | Kind::Quintic => return polynomial(random, kind == Kind::Cubic),
            Kind::Line => {
                if let Ok(Some(line)) = line(&from, &to, &measure) {
                    break line;
                }
            }
            Kind::Arc => {
                (to[0], to[1]) = (from[0], from[1]);
                let centre = [from[0] + Position::from_num(1 + random.below(9)), from[1]];
                break arc(&from, &to, centre, Plane::G17, random.below(2) == 0, &measure).expect("an arc");
            }
        }
    };
    element.shape
}

/// What was put in, in order.
struct Laid<const AXES: usize> {
    shape: Shape<AXES>,
    at: [Position; AXES],
    start: i64,
    block: u32,
    number: u32,
}

/// The point of a curve of the ring.
fn point<const AXES: usize>(track: &Track<'_, AXES>, along: i64) -> [Position; AXES] {
    let mut point = [Position::ZERO; AXES];
    track.at(along, &mut point);
    assert_eq!(point, track.point(along));
    point
}

/// Puts one in: there is room. It stands for one motion block, or for as many thousands as it may.
fn put<const AXES: usize>(
    layer: &mut CurveProducer<'_, AXES>,
    list: &mut Vec<Laid<AXES>>,
    (kind, latest): (Kind, &mut u32),
    random: &mut Random,
) {
    let (shape, at) = (shape(kind, random), random.mm());
    let start = layer.end().to_bits();
    *latest += 1;
    for _ in 0..if random.below(10) == 0 { random.below(20_000) } else { 0 } {
        *latest += u32::from(!layer.is_crowded(*latest + 1));
    }
    assert!(layer.push(&shape, &shape.base(&at), 7, *latest), "there is room for a {kind:?}");
    list.push(Laid { shape, at, start, block: *latest, number: layer.count() - 1 });
}

/// The planner's rules: while less than `AHEAD` curves are ahead, and there is room for them; handed on while it is not
/// sated. The interrupt goes on by up to so many curves as it may, also into the look-ahead. The fewest curves ahead
/// when there was no room for more of them, and the fewest handed on when the queue was sated.
fn run<const AXES: usize, const AHEAD: usize>(kinds: &[Kind], seed: u64) -> (usize, usize) {
    let mut random = Random(seed);
    let mut ring = CurveRing::<AXES, AHEAD>::new();
    let (mut layer, mut follower) = ring.split();
    let (mut list, mut handed, mut at, mut latest) = (Vec::new(), 0, 0, 0);
    let (mut fewest, mut sated) = (AHEAD, SEGMENTS);
    for step in 0..1000 {
        while list.len() - handed < AHEAD && !layer.is_over() {
            if layer.is_ahead_full() {
                fewest = fewest.min(list.len() - handed);
                break;
            }
            let kind = kinds[random.below(kinds.len())];
            put(&mut layer, &mut list, (kind, &mut latest), &mut random);
        }
        while handed < list.len() && !layer.is_sated() && random.below(8) > 0 {
            let curves =
                (1 + if random.below(20) == 0 { random.below(AHEAD) } else { 0 }).min(list.len() - handed);
            layer.hand_on(curves as u32);
            handed += curves;
        }
        if layer.is_sated() {
            sated = sated.min(handed - at);
        }
        for (number, laid) in list.iter().enumerate().skip(at) {
            let track = layer.recent(laid.number).expect("a curve");
            assert_eq!(layer.block_of(track.segment), laid.block, "step {step}");
            let half = laid.shape.length.to_bits() / 2;
            assert_eq!(point(&track, half), laid.shape.point(half, &laid.at), "step {step}, curve {number}");
            assert_eq!(track.shape(), laid.shape, "step {step}, curve {number}");
        }
        if handed == 0 {
            continue;
        }
        if random.below(50) == 0 {
            let left = (at + 1).max(handed - random.below(handed.saturating_sub(at) + 1));
            list.truncate(left);
            layer.withdraw(list[left - 1].number + 1);
            handed = left;
        }
        let last = if random.below(20) == 0 { list.len() } else { handed.max(at + 1) };
        at = (at + random.below(MAX_CURVES_PER_TICK as usize)).min(last - 1);
        let laid = &list[at];
        let along = laid.shape.length.to_bits() / 1000 * (900 + random.below(100)) as i64;
        let distance = laid.start.wrapping_add(along);
        let (track, found) = follower.follow(distance).expect("a curve");
        assert_eq!(found, along, "step {step}");
        assert_eq!(point(&track, along), laid.shape.point(along, &laid.at), "step {step}, curve {at}");
        let segment = follower.peek(distance).expect("a curve");
        assert_eq!(follower.block_of(segment), laid.block, "step {step}, curve {at}");
    }
    (fewest, sated)
}

/// The same of several runs.
fn runs<const AHEAD: usize>(kinds: &[Kind]) -> (usize, usize) {
    let runs = (1..=4).flat_map(|seed| {
        [run::<3, AHEAD>(kinds, seed), run::<6, AHEAD>(kinds, seed), run::<2, AHEAD>(kinds, seed)]
    });
    runs.reduce(|one, other| (one.0.min(other.0), one.1.min(other.1))).expect("runs")
}

const IS_SMALL: bool = glidepath::machine::functions::IS_SMALL;

#[test]
fn every_curve_is_found_as_it_was_put_in() {
    for kinds in
        [&KINDS[..], &[Kind::Quintic, Kind::Line], &[Kind::Arc, Kind::Quintic], &[Kind::Cubic, Kind::Arc]]
    {
        let (few, many) = (runs::<10>(kinds), runs::<150>(kinds));
        assert_eq!(few.0, 10, "{kinds:?}");
        assert_eq!(many.0 < 150, IS_SMALL, "{kinds:?}: {many:?}");
    }
}

/// All blocks of the look-ahead may be lines. Where there is less room for others, as many may be as docs/limits.md says.
#[test]
fn the_look_ahead_has_room_for_so_many_curves() {
    assert_eq!(runs::<150>(&[Kind::Line]), (150, if IS_SMALL { 33 } else { 48 }));
    for kind in [Kind::Arc, Kind::Cubic, Kind::Quintic] {
        assert_eq!(runs::<150>(&[kind]), if IS_SMALL { (83, 17) } else { (150, 48) }, "{kind:?}");
    }
}

/// What is in use is not written: a ring that is full takes no curve until one is left.
#[test]
fn a_full_ring_keeps_what_it_has() {
    let random = &mut Random(5);
    let mut ring = CurveRing::<3, 150>::new();
    let (mut layer, mut follower) = ring.split();
    let (quintic, at) = (shape::<3>(Kind::Quintic, random), random.mm());
    let (base, length) = (quintic.base(&at), quintic.length.to_bits());
    let mut curves = 0;
    while layer.push(&quintic, &base, 0, curves) {
        curves += 1;
    }
    assert_eq!((curves as usize) < 150 + SEGMENTS, IS_SMALL);
    assert!(layer.is_full());
    layer.hand_on(curves);
    let mut has = |number: u32| {
        let (track, _) = follower.follow(i64::from(number) * length).expect("a curve");
        assert_eq!(u32::from(track.segment.block()), number);
        assert_eq!(point(&track, length / 3), quintic.point(length / 3, &at), "{number}");
    };
    has(0);
    assert!(!layer.push(&quintic, &base, 0, curves));
    // Behind the last one there may be too little room for one.
    has(3);
    assert!(layer.push(&quintic, &base, 0, curves) && layer.push(&quintic, &base, 0, curves + 1));
    for number in 3..curves + 2 {
        has(number);
    }
}
