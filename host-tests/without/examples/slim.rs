//! What the target has to repeat in the build without other functions than lines, arcs and contour mode: its programs on
//! the host, built alike. A line for each: name, blocks of look-ahead, ticks, blocks, digest of all set points.
use glidepath::channel::{Channel, Error, Progress};
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use hil_cases::{AXES_3, AXES_3_SHORT, BLOCKS, CASES_SLIM, SHORT, Watch, run};

struct Nobody;

impl Watch<3> for Nobody {
    fn polled(&mut self, _: u32, _: &Result<Progress, Error>) {}

    fn ticked(&mut self, _: u32, _: &[Position; 3]) {}
}

fn all<const BLOCKS: usize>(machine: &MachineData<3>) {
    for case in CASES_SLIM {
        let mut channel = Box::new(Channel::<3, BLOCKS>::new());
        let outcome = run(&mut channel, machine, case.text, &mut Nobody).expect("it ends");
        let (ticks, blocks, digest) = (outcome.ticks, outcome.blocks, outcome.digest.value());
        println!("{} look_ahead {BLOCKS} ticks {ticks} blocks {blocks} digest {digest:016x}", case.name);
    }
}

fn main() {
    all::<BLOCKS>(&AXES_3);
    all::<SHORT>(&AXES_3_SHORT);
}
