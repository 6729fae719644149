//! `--vcd`: the pins of the step output over time.
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn directory(name: &str) -> std::path::PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("vcd-{name}"));
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).expect("a directory for the test");
    directory
}

fn glidepath(directory: &Path, options: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    command.current_dir(directory).args(["run", "p.nc", "--why", "never"]).args(options);
    command.output().expect("the simulator starts")
}

/// Steps of each axis with their direction, from the levels of its pins; and the last time of the file.
fn steps(vcd: &str) -> (BTreeMap<String, i64>, u64) {
    let (mut names, mut levels) = (BTreeMap::new(), BTreeMap::new());
    let (mut counts, mut time) = (BTreeMap::new(), 0);
    for line in vcd.lines() {
        if let ["$var", "wire", "1", sign, name, "$end"] = line.split(' ').collect::<Vec<_>>()[..] {
            names.insert(sign.to_owned(), name.to_owned());
        } else if let Some(at) = line.strip_prefix('#') {
            let at = at.parse().expect("a time");
            assert!(at >= time, "times go backward");
            time = at;
        } else if let Some(level @ ("0" | "1")) = line.get(..1) {
            let name = names.get(&line[1..]).expect("a signal of the header").clone();
            let rises = level == "1" && levels.insert(name.clone(), level == "1") == Some(false);
            levels.insert(name.clone(), level == "1");
            if let Some(axis) = name.strip_suffix("_step").filter(|_| rises) {
                let forward = levels[&format!("{axis}_direction")];
                *counts.entry(axis.to_owned()).or_insert(0) += if forward { 1 } else { -1 };
            }
        }
    }
    (counts, time)
}

#[test]
fn the_steps_of_a_program_lead_to_its_end() {
    let directory = directory("end");
    fs::write(directory.join("p.nc"), "G01 X10 Y-4.5 F6000\nX7.26\nG00 Z-2\nM30\n").expect("written");
    let output = glidepath(&directory, &["--vcd", "p.vcd", "--trace", "t.csv"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let vcd = fs::read_to_string(directory.join("p.vcd")).expect("it was asked for");
    let (counts, time) = steps(&vcd);
    // 80 counts per mm: 580.8, -360 and -160.
    let wanted = [("X", 581), ("Y", -360), ("Z", -160)].map(|(axis, count)| (axis.to_owned(), count));
    assert_eq!(counts, BTreeMap::from(wanted));
    let rows = fs::read_to_string(directory.join("t.csv")).expect("it was asked for").lines().count() - 1;
    assert_eq!(time, rows as u64 * 1_000_000);
}

#[test]
fn the_machine_file_says_what_steps_an_axis_has() {
    let directory = directory("machine");
    fs::write(directory.join("p.nc"), "G01 X10 F600\nM30\n").expect("written");
    let run = |lines: &str, options: &[&str]| {
        let text =
            format!("[axis.X]\nvb_eilgang = 100_000\ndynamik.vb_max = 100_000\n[axis.X.steps]\n{lines}\n");
        fs::write(directory.join("m.toml"), text).expect("written");
        let options: Vec<&str> =
            ["--machine", "m.toml", "--vcd", "p.vcd"].into_iter().chain(options.iter().copied()).collect();
        let output = glidepath(&directory, &options);
        (output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (done, told) = run(
        "counts = 2001\nlength = 10\nstep = 7\ndirection = 3\ndirection_inverted = 1\nstep_2 = 1\ndirection_2 = 2",
        &[],
    );
    assert!(done, "{told}");
    let vcd = fs::read_to_string(directory.join("p.vcd")).expect("it was asked for");
    assert!(vcd.contains("X_step_2") && vcd.contains("X_direction_2"), "{vcd}");
    // The direction pin is low where the axis moves in the positive direction.
    assert_eq!(steps(&vcd).0, BTreeMap::from([("X".to_owned(), -2001)]));

    for (lines, told) in [
        ("count = 5", "unknown parameter axis.X.steps.count"),
        ("counts = 0", "axis.X.steps.counts = 0: out of range"),
        ("counts = 0.5", "axis.X.steps.counts = 0.5: a wrong type of value"),
        ("counts = 10_000", "step output: axis X: 100000 µm/s need more steps per tick than fit"),
        ("step_2 = 5", "axis X: the port has no bit 255"),
        ("step = 1", "axis X: bit 1 is used already"),
    ] {
        let (done, error) = run(lines, &[]);
        assert!(!done && error.contains(told), "{lines}: {error}");
    }
    // Twice the slots, twice the steps.
    assert!(!run("counts = 1500", &[]).0);
    assert!(run("counts = 1500", &["--slots", "400"]).0);
}
