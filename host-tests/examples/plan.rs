//! What becomes of corners: times of programs with each way through them, and with `plan` the elements of one.
use glidepath::quantity::Position;
use host_tests::check;
use host_tests::rounded::{Run, quick, run_from};

fn square(mode: &str) -> String {
    format!("{mode}\nN10 G01 X80 Y0 F20000\nN20 X80 Y80\nN30 X0 Y80\nN40 G260 X0 Y0\nM30\n")
}
fn stairs(mode: &str) -> String {
    format!("{mode}\nN10 G01 X80 Y0 F20000\nN20 Y80\nN30 X160\nN40 Y160\nN50 G260 X240\nM30\n")
}
fn corner(mode: &str) -> String {
    format!("{mode}\nN10 G01 X80 Y0 F20000\nN20 G260 X80 Y80\nM30\n")
}
fn circle(mode: &str) -> String {
    let mut t = format!("{mode}\nN1 G01 X80 F20000\n");
    for i in 1..=64 {
        let a = std::f64::consts::TAU * f64::from(i) / 64.0;
        t += &format!("N{} X{:.6} Y{:.6}\n", i + 1, 80.0 + 80.0 * a.sin(), 80.0 - 80.0 * a.cos());
    }
    t + "N70 G260 X160\nM30\n"
}
fn three(mode: &str) -> String {
    format!("{mode}\nN10 G01 X7.812 Y0.769 F20000\nN20 X15.511 Y2.3\nN30 G260 X23.023 Y4.579\nM30\n")
}
fn sliver(_: &str) -> String {
    "N10 G01 X50 F6000\nN20 G02 X70 Y-20 J-20\nN30 G01 Y-20.0001\nN40 G02 X50 Y-40.0001 I-20\nN50 G01 X0\nM30\n".into()
}
fn file(name: &str) -> String {
    std::fs::read_to_string(name).unwrap()
}
fn go(text: &str, slope: u8, geom: u32, ramp: u32, cycle: u32) -> Run {
    let mut m = quick::<3>(cycle);
    m.channel.slope_profile = slope;
    for axis in &mut m.axes {
        axis.tr_geom = geom;
        host_tests::cases::machines::ramps(axis, ramp);
    }
    run_from(text, [Position::ZERO; 3], &m)
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let num = |i: usize, d: u32| args.get(i).and_then(|a| a.parse().ok()).unwrap_or(d);
    match args[0].as_str() {
        "plan" => {
            // plan NAME MODE slope geom ramp
            let f = match args[1].as_str() {
                "square" => square,
                "stairs" => stairs,
                "corner" => corner,
                "circle" => circle,
                "three" => three,
                "file" => file,
                _ => sliver,
            };
            let run = go(&f(&args[2]), num(3, 1) as u8, num(4, 50_000), num(5, 50_000), num(6, 1000));
            for b in &run.blocks {
                println!(
                    "N{} x{} len {:.12} vin {:.6} peak {:.6} vout {:.6} t {:.4}",
                    b.n,
                    b.blocks,
                    b.length.to_bits() as f64 / (1u64 << 44) as f64,
                    b.v_in.to_bits() as f64 / (1u64 << 58) as f64 * 1e3,
                    b.v_peak.to_bits() as f64 / (1u64 << 58) as f64 * 1e3,
                    b.v_out.to_bits() as f64 / (1u64 << 58) as f64 * 1e3,
                    b.time.to_bits() as f64 / (1u64 << 36) as f64
                );
            }
            for k in 0..2 {
                println!("{:?}", check::peaks(&run.trace.columns[k], run.trace.cycle));
            }
            println!("{}", run.time());
        }
        "times" => {
            let (geom, ramp) = (num(2, 50_000), num(3, 50_000));
            let f = match args[1].as_str() {
                "square" => square,
                "stairs" => stairs,
                "corner" => corner,
                "circle" => circle,
                "three" => three,
                _ => sliver,
            };
            for slope in 0..4u8 {
                let t = |mode: &str| go(&f(mode), slope, geom, ramp, 1000).time();
                print!("slope {slope}: stop {:.3} plain {:.3} dev", t("G360"), t("G260"));
                for dev in
                    ["0.001", "0.002", "0.005", "0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "5"]
                {
                    print!(" {:.3}", t(&format!("#CONTOUR MODE ON [DEV PATH_DEV={dev}]")));
                }
                println!();
            }
        }
        _ => {}
    }
}
