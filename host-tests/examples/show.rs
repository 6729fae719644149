use host_tests::cases::feeds::{ACCELERATION, Feeds};
use host_tests::cases::machines;
use host_tests::reference::optimum::optimum;
use host_tests::trace::run;
fn main() {
    let i: u64 = std::env::args().nth(1).unwrap().parse().unwrap();
    let f = Feeds::new(i);
    let mut m = machines::machine::<1>(1000, |_, axis| {
        axis.vb_max = 1_000_000;
        axis.vb_eilgang = 1_000_000;
        machines::accelerations(axis, ACCELERATION as u32, ACCELERATION as u32);
        machines::ramps(axis, (f.ramp * 1e6) as u32);
        axis.tr_geom = axis.tr_beschl_ab;
        if std::env::args().nth(2).is_some() { if i % 3 == 1 { axis.a_brems = 1300; } if i % 3 == 2 { axis.a_beschl = 900; } }
    });
    m.channel.slope_profile = 3;
    let mut at = 0.0;
    for (k, b) in f.blocks.iter().enumerate() {
        println!("block {k}: {at:.3} +{:.3} v {:.2}", b.length, b.speed);
        at += b.length;
    }
    for o in [false, true] {
        let mut p = f.program(format!("feeds {i}"), 1);
        p.optimised = o;
        let r = run::<1, 120>(&p, &m).unwrap();
        println!("optimised {o}");
        let (mut at, mut t) = (0.0, 0.0);
        for b in &r.blocks {
            let l = b.length.to_bits() as f64 / 2f64.powi(44);
            let v = |s: glidepath::quantity::Speed| s.to_bits() as f64 / 2f64.powi(58) * 1e3;
            let dt = b.time.to_bits() as f64 / 2f64.powi(36) * 1e-3;
            println!("  at {at:.4} +{l:.4} n{} v {:.2} {:.2} {:.2} t {t:.4} +{dt:.4}", b.n, v(b.v_in), v(b.v_peak), v(b.v_out));
            at += l;
            t += dt;
        }
    }
    println!("optimum");
    if std::env::args().nth(2).is_some() { return; }
    let o = optimum(&f.blocks, &f.limits).unwrap();
    let (mut s, mut t) = (0.0, 0.0);
    // Turning points of speed, and the motion at block ends.
    let mut last = (0.0, 0.0);
    let mut block = 0;
    for p in &o.pieces {
        if p.block != block {
            println!("  end of block {block} at {s:.4} v {:.2} a {:.0} t {t:.4}", p.v, p.a);
            block = p.block;
        }
        let a1 = p.a + p.jerk * p.time;
        if p.a * a1 <= 0.0 && p.jerk != 0.0 {
            let tz = (-p.a / p.jerk).clamp(0.0, p.time);
            let [ds, v, _] = p.at(tz);
            if (s + ds - last.0 as f64).abs() > 0.05 && (v - last.1 as f64).abs() > 0.01 {
                println!("  a=0 at {:.4} v {v:.2} t {:.4} block {}", s + ds, t + tz, p.block);
            }
            last = (s + ds, v);
        }
        let [ds, ..] = p.at(p.time);
        s += ds;
        t += p.time;
    }
    println!("optimum {t}");
}
