//! Compares the planner with the optimum on the paths with changing feeds:
//! `cargo run --release -p host-tests --example compare`.
use host_tests::cases::feeds::{ACCELERATION, Feeds, PATHS, accepted};
use host_tests::cases::machines;
use host_tests::trace::run;
fn main() {
    let rows = accepted().unwrap();
    let slope: u8 = std::env::args().nth(1).map_or(3, |a| a.parse().unwrap());
    let verbose = std::env::args().nth(2).is_some_and(|a| a == "v");
    let (mut sum, mut worst) = (0.0, 0.0f64);
    let (mut over3, mut over6) = (0, 0);
    let mut short = 0.0f64;
    for i in 0..PATHS {
        let f = Feeds::new(i);
        let mut m = machines::machine::<1>(1000, |_, axis| {
            axis.vb_max = 1_000_000;
            axis.vb_eilgang = 1_000_000;
            machines::accelerations(axis, ACCELERATION as u32, ACCELERATION as u32);
            machines::ramps(axis, (f.ramp * 1e6) as u32);
            axis.tr_geom = axis.tr_beschl_ab;
        });
        m.channel.slope_profile = slope;
        let mut p = f.program(format!("feeds {i}"), 1);
        p.optimised = std::env::args().nth(3).is_some_and(|a| a == "0");
        let r = run::<1, 120>(&p, &m).unwrap();
        let t: f64 = r.blocks.iter().map(|b| b.time.to_bits() as f64 / 2f64.powi(36)).sum::<f64>() * 1e-3;
        let over = 100.0 * (t / rows[i as usize].time - 1.0);
        short = short.min(over);
        if verbose {
            println!("{i} {} {over:.4}", rows[i as usize].blocks);
        }
        sum += over;
        worst = worst.max(over);
        if over > 3.0 {
            over3 += 1
        }
        if over > 6.0 {
            over6 += 1
        }
    }
    println!(
        "slope {slope}: mean {:.2} % worst {worst:.2} %, least {short:.4}; above 3 %: {over3}, above 6 %: {over6}",
        sum / PATHS as f64
    );
}
