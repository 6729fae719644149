use host_tests::every_tick::*;
fn main() {
    let a: Vec<String> = std::env::args().skip(1).collect();
    let case = Case::named(&a[0]).unwrap();
    let slope = SLOPES.iter().find(|(n, _)| *n == a[1]).unwrap().1;
    let at: usize = a[2].parse().unwrap();
    let d = if a[3] == "hold" {
        Disturbance::Hold
    } else if a[3] == "stall" {
        Disturbance::Stall
    } else {
        Disturbance::None
    };
    let (from, to): (usize, usize) = (a[4].parse().unwrap(), a[5].parse().unwrap());
    if case.axes() == 4 {
        go::<4>(case, slope, at, d, from, to)
    } else {
        go::<3>(case, slope, at, d, from, to)
    }
}
fn go<const N: usize>(case: Case, slope: Slope, at: usize, d: Disturbance, from: usize, to: usize) {
    let text = case.text(slope, case.path.blocks());
    let m = machine::<N>(case, slope);
    let run = run(&text, &m, at, d).unwrap();
    println!("stood {:?}", run.stood);
    let p = |k: usize, t: usize| run.trace.columns[k][t] as f64 / (1u64 << 32) as f64;
    for t in from..to {
        let dist = run.distances[t] as f64 / (1u64 << 44) as f64;
        let dv = (run.distances[t] - run.distances[t - 1]) as f64 / (1u64 << 44) as f64 * 1e3;
        let dv0 = (run.distances[t - 1] - run.distances[t - 2]) as f64 / (1u64 << 44) as f64 * 1e3;
        print!("{t} s {dist:.5} v {dv:.3} a {:.0} |", (dv - dv0) * 1e3);
        for k in 0..N {
            let a = (p(k, t + 1) - 2.0 * p(k, t) + p(k, t - 1)) * 1e6;
            print!(" {:.4} v {:.3} a {a:.0};", p(k, t), (p(k, t) - p(k, t - 1)) * 1e3);
        }
        println!();
    }
}
