//! The ring between planner and interrupt: which items a tick gives back.
use glidepath::queue::{MOST, Ring, Slot};

#[derive(Clone, Copy)]
struct Item(u32);

impl Slot for Item {
    const BLANK: Self = Self(0);
}

/// Every fill, every number of items that have begun, and the seam of the slots at several places.
#[test]
fn a_tick_passes_to_the_last_item_that_has_begun() {
    for seam in [0, 1, 17, 40, 63] {
        for items in 1..=64 {
            for begun in 1..=items.min(MOST + 1) {
                let mut ring = Ring::<Item, 64>::new();
                let (mut producer, mut consumer) = ring.split();
                for _ in 0..seam {
                    assert!(producer.push(Item(u32::MAX)).is_ok() && consumer.pop().is_some());
                }
                for number in 0..items {
                    assert!(producer.push(Item(number)).is_ok());
                }
                let last = begun - 1;
                let at = consumer.pass(|item| item.0 < last, |item| item.0 <= last).map(|item| item.0);
                assert_eq!(at, Some(last), "{items} items, {begun} begun, seam {seam}");
                assert_eq!(consumer.len(), items - last);
            }
        }
    }
}
