//! Zigzags of every angle and length with Surface, with DEV and with stops, at different feeds:
//! `cargo run --release -p host-tests --example zigzags -- [SLOPE …]` writes a line of ticks for each.
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use host_tests::cases::machines;
use host_tests::trace::run_text;
use host_tests::walk::machine;

fn ticks(machine: &MachineData<3>, (turn, length, feed): (f64, f64, u32), on: &str) -> usize {
    let mut text = format!("G01 F{feed}\n{on}\n");
    let blocks = (600.0 / length).clamp(10.0, 24.0) as u32;
    for k in 1..=blocks {
        let (along, aside) = ((0.5 * turn).to_radians().cos(), (0.5 * turn).to_radians().sin());
        let [x, y] = [length * along * f64::from(k), length * aside * f64::from(k % 2)];
        text += &format!("X{x:.6} Y{y:.6}\n");
    }
    text += "M30\n";
    match run_text::<3, 120>(&text, [Position::ZERO; 3], machine, 1) {
        Ok(run) => run.trace.ticks(),
        Err(e) => panic!("{e}\n{text}"),
    }
}

fn main() {
    let slopes: Vec<u8> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let names = ["quick", "soft", "built-in"];
    let threads: Vec<_> =
        slopes.into_iter().flat_map(|slope| (0..3).map(move |which| (slope, which))).collect();
    let work = std::sync::Mutex::new(threads);
    std::thread::scope(|s| {
        for _ in 0..2 {
            s.spawn(|| {
                loop {
                    let Some((slope, which)) = work.lock().unwrap().pop() else { return };
                    let mut m = [
                        machine::<3>(50_000, slope),
                        machine::<3>(150_000, slope),
                        machines::machine(1000, |_, _| {}),
                    ][which];
                    m.channel.slope_profile = slope;
                    m.channel.surface = true;
                    for turn in [
                        1.0, 2.0, 4.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 25.0, 30.0, 40.0, 60.0, 80.0,
                        90.0, 100.0, 101.0, 103.0, 120.0, 140.0, 159.0,
                    ] {
                        for length in [0.05, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 30.0] {
                            for dev in [0.02, 0.1] {
                                for feed in [2000, 6000, 12000, 30_000, 60_000] {
                                    let at = (turn, length, feed);
                                    let t: Vec<_> = [
                                        format!("#HSC ON [SURFACE PATH_DEV={dev}]"),
                                        format!("#CONTOUR MODE ON [DEV PATH_DEV={dev}]"),
                                        String::new(),
                                    ]
                                    .iter()
                                    .map(|on| ticks(&m, at, on).to_string())
                                    .collect();
                                    println!(
                                        "{slope} {} {turn} {length} {dev} {feed} {}",
                                        names[which],
                                        t.join(" ")
                                    );
                                }
                            }
                        }
                    }
                }
            });
        }
    });
}
