//! Set points, compared with those of the reference for the same plan.
use glidepath::machine::MachineData;
use host_tests::cases::random::{Mix, program};
use host_tests::cases::{Program, edges, machines, named};
use host_tests::reference::limits::Machine;
use host_tests::reference::merge::merged;
use host_tests::reference::motion::Motion;
use host_tests::reference::planner::{blocks_of, laws};
use host_tests::tolerance;
use host_tests::trace::run;

/// Largest difference, mm or degrees; the same beyond what the ramps of the plan leave open; duration, s.
fn difference<const AXES: usize>(program: &Program, machine: &MachineData<AXES>) -> (f64, f64, f64) {
    let run = run::<AXES, 120>(program, machine).unwrap();
    let axes = Machine::new(&machine.axes, &machine.channel);
    let contour = merged(&program.contour_as_decoded(machine), &axes);
    let laws = laws(&blocks_of(&contour, &axes, &run.blocks), &contour, &run.blocks);
    let motion = Motion::new(&contour, &laws, 1.0);
    let ramps = laws.iter().flat_map(|law| [law.rise.distance, law.fall.distance]);
    let open = ramps.fold(0.0, f64::max) * tolerance::RAMP;
    let mut largest = 0.0_f64;
    for tick in 0..run.trace.len() {
        let exact = motion.at(tick as f64).unwrap_or_else(|| contour.elements.last().unwrap().to.clone());
        for (a, b) in run.trace.mm(tick).into_iter().zip(exact) {
            largest = largest.max((a - b).abs());
        }
    }
    (largest, largest - open, run.trace.time())
}

fn close<const AXES: usize>(program: &Program, machine: &MachineData<AXES>) {
    let (off, own, time) = difference(program, machine);
    let name = format!("{}, slope {}", program.name, machine.channel.slope_profile);
    println!("{name}: {:.3} nm in {time:.1} s", off * 1e6);
    assert!(own <= tolerance::REFERENCE, "{name}: {} nm", off * 1e6);
}

#[test]
fn ten_minutes() {
    let mix = Mix { feed: [2_000.0, 20_000.0], ..Mix::general(3, 2600) };
    for (program, machine) in [
        (program(3000, mix), machines::mill::<3>(1000)),
        (program(3001, Mix::surface(3, 9000)), machines::uneven(1000)),
    ] {
        let (off, _, time) = difference(&program, &machine);
        println!("{}: {:.3} nm in {time:.1} s", program.name, off * 1e6);
        assert!(off <= tolerance::REFERENCE, "{}: {} nm", program.name, off * 1e6);
        assert!(time > 600.0, "{time} s");
    }
}

#[test]
fn named_programs_and_edges() {
    let named = [
        named::chords(60_000.0, 3),
        named::slot(60_000.0, 3),
        // Behind two turns of a circle spans end within a block, which the reference does not know.
        Program::new("one turn of a helix", 3).arc(&[0.0, 0.0, -5.0], [12.0, 0.0], true, 60_000.0),
        named::pocket(60_000.0),
    ];
    for program in named.into_iter().chain(edges::three_axes()) {
        for machine in [machines::even::<3>(1000), machines::uneven(1000), machines::mill(1000)] {
            for slope in [1, 2, 0] {
                close(&program, &machines::with_slope(machine, slope));
            }
        }
    }
    for program in edges::rotary() {
        for slope in [1, 2, 0] {
            close(&program, &machines::with_slope(machines::mill::<4>(1000), slope));
        }
    }
}

#[test]
fn other_cycles_and_axes() {
    for seed in 3100..3106 {
        for slope in [1, 2, 0] {
            let of = |machine| machines::with_slope(machine, slope);
            close(&program(seed, Mix::general(3, 40)), &of(machines::mill::<3>(250)));
            close(&program(seed, Mix::general(3, 40)), &of(machines::even::<3>(4000)));
            let machine = machines::with_slope(machines::mill::<6>(1000), slope);
            close(&program(seed, Mix::general(6, 40)), &machine);
        }
    }
}
