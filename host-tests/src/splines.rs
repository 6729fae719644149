//! Random runs with splines: machines, programs and operators of [`crate::soak`], with a spline instead of
//! contour mode.
use crate::cases::Kind;
use crate::cases::random::Random;
use crate::soak::{Outcome, Setup, setup};
use std::fmt::Write;

/// Lowest number of blocks in a spline.
const LEAST: usize = 6;

/// Lines that switch a spline on, and the one that switches it off.
fn spline(r: &mut Random, size: f64) -> (String, &'static str) {
    let deviation = |r: &mut Random| r.magnitude(0.01 * size, size).clamp(1e-4, 100.0);
    let tangent = |r: &mut Random| ["AUTO", "TANGENTIAL", "USER"][(r.bits() % 3) as usize];
    match r.bits() % 6 {
        0 => ("#SPLINE TYPE BSPLINE\nG151".to_owned(), "G150"),
        1 | 2 => {
            let vectors = "#AKIMA STARTVECTOR X1 Y0.5 Z0.1\n#AKIMA ENDVECTOR X-2 Y1 Z0";
            let (start, end) = (tangent(r), tangent(r));
            let text = format!("{vectors}\n#SPLINE TYPE AKIMA\n#AKIMA TRANS [START={start} END={end}]\nG151");
            (text, "G150")
        }
        3 => (format!("#HSC ON [OPMODE={} CONTERROR={:.6}]", 1 + r.bits() % 2, deviation(r)), "#HSC OFF"),
        _ => {
            let mut line =
                format!("#HSC ON [BSPLINE PATH_DEV={:.6} TRACK_DEV={:.3}", deviation(r), deviation(r));
            for flag in ["MERGE", "AUTO_OFF_PATH", "AUTO_OFF_TRACK", "AUTO_OFF_G00", "AUTO_OFF_G60"] {
                if r.once_in(3) {
                    let _ = write!(line, " {flag}=1");
                }
            }
            if r.once_in(3) {
                let _ =
                    write!(line, " MAX_PATH_LENGTH={:.4} MAX_ANGLE={}", deviation(r) * 10.0, r.bits() % 181);
            }
            line.push(']');
            (line, "#HSC OFF")
        }
    }
}

/// The run of a seed.
pub fn splined<const AXES: usize>(seed: u64, stalls: bool) -> Setup<AXES> {
    let mut setup = setup::<AXES>(seed, stalls);
    let mut random = Random::new(seed ^ 0x73_706c_696e_6573);
    let r = &mut random;
    setup.contour.clear();
    setup.lines.retain(|(_, line)| !line.starts_with("#CONTOUR"));
    setup.machine.channel.auto_contour_mode = (r.bits() % 3) as u8;
    let travel = |k: usize| {
        let from = if k == 0 { &setup.program.start } else { &setup.program.moves[k - 1].target };
        let to = &setup.program.moves[k].target;
        from.iter().zip(to).map(|(a, b)| (b - a).unsigned_abs()).max().unwrap_or(0) as f64 * 1e-6
    };
    let size = (0..setup.program.moves.len()).map(travel).sum::<f64>() / setup.program.moves.len() as f64;
    let mut on: Option<(usize, &str)> = None;
    for k in 0..setup.program.moves.len() {
        match on {
            None if k == 0 || r.once_in(6) => {
                let (line, off) = spline(r, size);
                if k == 0 {
                    setup.contour = line;
                } else {
                    setup.lines.push((k, line));
                }
                on = Some((k, off));
            }
            Some((since, off)) if k >= since + LEAST && r.once_in(12) => {
                setup.lines.push((k, off.to_owned()));
                on = None;
            }
            _ => {}
        }
    }
    let direct =
        setup.contour.contains("BSPLINE\n") || setup.lines.iter().any(|(_, l)| l.contains("BSPLINE\n"));
    if direct {
        // It has no arcs.
        for block in &mut setup.program.moves {
            if matches!(block.kind, Kind::Arc { .. }) {
                block.kind = Kind::Line;
            }
        }
    }
    setup
}

/// The run of a seed, with the number of axes that belongs to it.
pub fn soak(seed: u64, stalls: bool) -> Outcome {
    match seed % 4 {
        0 => splined::<3>(seed, stalls).run(),
        1 => splined::<4>(seed, stalls).run(),
        2 => splined::<5>(seed, stalls).run(),
        _ => splined::<6>(seed, stalls).run(),
    }
}
