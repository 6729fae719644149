//! The random sessions of the controller with the library of this build: contour mode is there, and G64 in force.
#[path = "../../controller/tests/bench/mod.rs"]
mod bench;

use bench::session::{Figures, session};

/// Jogs, homing, probing, holds and resets behind blocks that wait for the next line.
#[test]
fn sixty_sessions_in_contour_mode() {
    let mut figures = Figures::default();
    let fresh = bench::fresh_seed();
    for seed in (500..540).chain(fresh..fresh + 20) {
        session(seed, &mut figures);
    }
    println!("{figures:?}");
    assert!(figures.lines > 2_000 && figures.resets > 50, "{figures:?}");
}
