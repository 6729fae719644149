//! Runs a program and reads its output.
#![allow(dead_code, reason = "every test binary uses its part")]
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

pub fn shipped(path: &str) -> String {
    format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))
}

/// Everything a run writes.
pub struct Run {
    pub stdout: String,
    pub stderr: String,
    pub trace: Trace,
    pub summary: Value,
    pub contour: Value,
    pub directory: PathBuf,
}

/// A trace with its numbers in LSB of their formats.
pub struct Trace {
    pub header: String,
    pub rows: Vec<Row>,
}

pub struct Row {
    pub t_s: String,
    pub n: u32,
    pub block: u32,
    pub s_mm: f64,
    pub v_mm_s: f64,
    pub a_mm_s2: f64,
    pub axes: Vec<i64>,
}

pub fn run(name: &str, program: &str, machine: Option<&str>) -> Run {
    run_with(name, program, machine, &[])
}

pub fn run_with(name: &str, program: &str, machine: Option<&str>, options: &[&str]) -> Run {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("run-{name}"));
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).expect("a directory for the test");
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    command.arg("run").arg(program).args(options);
    if let Some(machine) = machine {
        command.arg("--machine").arg(machine);
    }
    for (option, file) in
        [("--trace", "t.csv"), ("--summary", "s.json"), ("--contour", "c.json"), ("--plot", "p.svg")]
    {
        command.arg(option).arg(directory.join(file));
    }
    let output = command.output().expect("the simulator starts");
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let read = |file: &str| fs::read_to_string(directory.join(file)).expect("it was asked for");
    let parse = |file: &str| serde_json::from_str(&read(file)).expect("JSON");
    Run {
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr,
        trace: trace(&read("t.csv")),
        summary: parse("s.json"),
        contour: parse("c.json"),
        directory,
    }
}

/// A program that the test writes itself.
pub fn written(name: &str, text: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.nc"));
    fs::write(&path, text).expect("a program for the test");
    path.to_str().expect("a path of plain characters").to_owned()
}

pub fn trace(text: &str) -> Trace {
    let mut lines = text.lines();
    let header = lines.next().expect("a header").to_owned();
    let rows = lines.enumerate().map(|(tick, line)| {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields[0].parse(), Ok(tick), "one row per tick: {line}");
        let number = |field: &str| field.parse::<f64>().expect("a number");
        Row {
            t_s: fields[1].to_owned(),
            n: fields[2].parse().expect("a number"),
            block: fields[3].parse().expect("a number"),
            s_mm: number(fields[4]),
            v_mm_s: number(fields[5]),
            a_mm_s2: number(fields[6]),
            axes: fields[7..].iter().map(|field| bits(field)).collect(),
        }
    });
    Trace { header, rows: rows.collect() }
}

/// The multiple of 2^-32 that a decimal is; refuses decimals that are none.
pub fn bits(decimal: &str) -> i64 {
    let (sign, digits) = decimal.strip_prefix('-').map_or((1, decimal), |rest| (-1, rest));
    let (whole, fraction) = digits.split_once('.').expect("a decimal point");
    let whole: i64 = whole.parse().expect("digits");
    // The fraction times 2^32, digit by digit from the end: each step must come out even in the end.
    let mut digits: Vec<u8> = fraction.bytes().map(|digit| digit - b'0').collect();
    let mut value = 0_i64;
    for _ in 0..32 {
        let mut carry = 0;
        for digit in digits.iter_mut().rev() {
            let doubled = *digit * 2 + carry;
            (*digit, carry) = (doubled % 10, doubled / 10);
        }
        value = value * 2 + i64::from(carry);
    }
    assert!(digits.iter().all(|&digit| digit == 0), "{decimal} is not a multiple of 2^-32");
    sign * ((whole << 32) + value)
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

pub const LSB: f64 = 1.0 / 4_294_967_296.0;

/// 100 mm in 20 blocks, bent too much to become one, then a corner.
pub fn cut_line(name: &str) -> String {
    let bent = |i: i32| 0.0001 * f64::from(i * i);
    let blocks: String = (1..=20).map(|i| format!("N{} X{} Y{:.4}\n", 10 + 10 * i, 5 * i, bent(i))).collect();
    written(name, &format!("%cut\nN10 G01 F30000\n{blocks}N300 Y10\nM30\n"))
}
