use host_tests::cases::machines;
use host_tests::cases::random::{Mix, program};
use host_tests::trace::run;
fn main() {
    let a: Vec<u64> = std::env::args().skip(1).map(|x| x.parse().unwrap()).collect();
    let mut machine = machines::arbitrary::<1>(a[0]);
    machine.channel.slope_profile = 3;
    let p = program(a[0], Mix::arbitrary(1, a[0]));
    println!("{:?}", machine.axes[0]);
    println!("cycle {}", machine.channel.cycle_us);
    let text = p.text(&machine);
    for (i, l) in text.lines().enumerate() { if (i as u64) + 8 > a[1] && (i as u64) < a[1] + 8 { println!("{i} {l}"); } }
    let c = machine.channel.cycle_us as f64 * 1e-6;
    let r = run::<1, 120>(&p, &machine).unwrap();
    let mut t = 0.0;
    for b in &r.blocks {
        let v = |x: i64| x as f64 / 2f64.powi(58) / c * 60.0;
        let d = b.time.to_bits() as f64 / 2f64.powi(36);
        println!("block {} +{} t {t:.1}..{:.1} l {:.6} v {:.3} {:.3} {:.3} mm/min", b.block, b.blocks, t + d, b.length.to_bits() as f64 / 2f64.powi(44), v(b.v_in.to_bits()), v(b.v_peak.to_bits()), v(b.v_out.to_bits()));
        t += d + b.wait.to_bits() as f64 / 2f64.powi(36);
    }
}
