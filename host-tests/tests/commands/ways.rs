//! Stops in the reserve: the interrupt reads exactly the data that the planner has written.
use glidepath::quantity::{Accel, Distance, Jerk, Speed};
use glidepath::queue::{Phase, Reserve, STOP_PIECES, Slot};
use host_tests::cases::random::Random;

/// A number below 2^`bits` in size.
fn within(random: &mut Random, bits: u32) -> i64 {
    random.bits() as i64 >> (63 - bits)
}

/// Where a piece ends, but for rounding of so many bits.
fn behind(random: &mut Random, piece: &Phase, bits: [u32; 3]) -> Phase {
    let mut next = *piece;
    next.advance(next.ticks);
    let [distance, half, speed] = bits.map(|bits| if bits == 0 { 0 } else { within(random, bits) });
    next.distance = Distance::from_bits(next.distance.to_bits().wrapping_add(distance));
    next.half_accel = Accel::from_bits(next.half_accel.to_bits().wrapping_add(half));
    next.speed = Speed::from_bits(next.speed.to_bits().wrapping_add(speed));
    next.ticks = 1 + (random.bits() % 128) as u16;
    next
}

fn any(random: &mut Random) -> Phase {
    Phase {
        distance: Distance::from_bits(within(random, 60)),
        speed: Speed::from_bits(within(random, 58)),
        half_accel: Accel::from_bits(if random.once_in(4) { 0 } else { within(random, 52) }),
        sixth_jerk: Jerk::from_bits(if random.once_in(3) { 0 } else { within(random, 45) }),
        ticks: [1, 128, 1023, 1024, 65_535][(random.bits() % 5) as usize],
    }
}

/// Puts them in as long as there is room, and takes them out behind the piece `at_hand`; places used.
fn there_and_back(pieces: &[Phase], at_hand: Phase) -> (usize, u32) {
    let mut reserve = Reserve::<glidepath::queue::word::Ram>::blank();
    let (mut keeper, mut taker) = reserve.split();
    keeper.begin();
    let fit = pieces.iter().take_while(|piece| keeper.push(**piece)).count();
    let written = keeper.written();
    if fit == pieces.len() && !keeper.push(Phase::BLANK) {
        return (fit, written);
    }
    taker.begin(0);
    let mut piece = at_hand;
    for (k, wanted) in pieces[..fit].iter().enumerate() {
        assert!(taker.take_into(&mut piece), "piece {k} of {fit}");
        assert_eq!(piece, *wanted, "piece {k} of {fit}");
    }
    if fit == pieces.len() {
        for _ in 0..3 {
            assert!(!taker.take_into(&mut piece));
            assert_eq!(piece, pieces[fit - 1], "the last one stays");
        }
    }
    (fit, written)
}

#[test]
fn what_is_taken_out_is_what_was_put_in() {
    let mut random = Random::new(0x7761_7973);
    for _ in 0..20_000 {
        let r = &mut random;
        let mut pieces = vec![any(r)];
        for _ in 0..r.bits() % 40 {
            let last = pieces[pieces.len() - 1];
            pieces.push(match r.bits() % 8 {
                0 => any(r),
                // At the edges of what counts as rounding, and beyond.
                1 => behind(r, &last, [13, 13, 25]),
                2 => behind(r, &last, [14, 13, 25]),
                3 => behind(r, &last, [13, 14, 25]),
                4 => behind(r, &last, [13, 13, 26]),
                5 => Phase { ticks: 1000 + (r.bits() % 50) as u16, ..behind(r, &last, [9, 9, 17]) },
                _ => behind(r, &last, [9, 9, 17]),
            });
        }
        // Whatever was at hand before.
        let at_hand = any(r);
        there_and_back(&pieces, at_hand);
    }
}

/// A long ramp has four pieces in the place of one; others have a place each.
#[test]
fn pieces_that_go_on_take_a_quarter_of_the_room() {
    let way = STOP_PIECES / 2;
    let mut random = Random::new(1);
    let mut piece = Phase { sixth_jerk: Jerk::from_bits(1 << 30), ticks: 128, ..any(&mut random) };
    let mut ramp = vec![piece];
    for _ in 0..5 * way {
        piece = behind(&mut random, &piece, [8, 10, 17]);
        ramp.push(piece);
    }
    assert_eq!(there_and_back(&ramp, Phase::BLANK), (1 + 4 * (way - 1), way as u32));
    let others: Vec<Phase> = (0..5 * way).map(|_| any(&mut random)).collect();
    assert_eq!(there_and_back(&others, Phase::BLANK), (way, way as u32));
}
