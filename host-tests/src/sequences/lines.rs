//! Lines of programs: their text and their effect.
use super::model::{Effect, Modal, Model, bits, decimal, eighths};
use crate::cases::random::Random;

/// Software limits, mm.
pub const LIMIT: i32 = 200;

const NAMES: [&str; 3] = ["X", "Y", "Z"];

/// Lines that are refused in every modal state. Their changes have no effect.
const REFUSED: [&str; 22] = [
    "G91 X2 Q7",
    "G91 G54 X9999",
    "G90 G53 G01 X1 Y300 F100",
    "G04",
    "X1e9",
    "G92 X7 X8",
    "\u{1}X2",
    "LL nowhere",
    "#NONSENSE",
    "$ENDIF",
    "G91 G02 X5 Y0 R1 F1000",
    "G55 G70 F5 G133 50 X9999",
    "G91 X2 M30 Q7",
    "G00 G18 \u{1}",
    "$FOR P1 = 1, 2, 1 x",
    "\\ X9",
    "L nofile",
    "X[OSC ON 1ST_POS=1 2ND_POS=1 FEED=100]",
    "Y[OSC ON 1ST_POS=0 2ND_POS=900 FEED=100]",
    "Z[INDP_SYN G01 G90 POS=300 FEED=100]",
    "X[INDP_ASYN G90 POS=1 FEED=1 TIME=1 TIME=2]",
    "#CONTOUR MODE ON [DEV PATH_DEV=-1]",
];

/// A line.
#[derive(Clone, Debug)]
pub enum Line {
    /// A linear motion.
    Move {
        /// G00, G01.
        mode: Option<u8>,
        /// G90, G91.
        relative: Option<bool>,
        /// G53, G54…G59.
        zero: Option<Option<usize>>,
        /// mm/min
        feed: Option<u32>,
        /// G60.
        stop: bool,
        /// Eighths.
        to: [Option<i64>; 3],
    },
    /// Half a circle in X and Y, and along Z.
    Arc { clockwise: bool, i: i64, j: i64, z: i64, feed: u32 },
    /// G92 with G90.
    Shift([Option<i64>; 3]),
    /// A function.
    Function(u16),
    /// An oscillation, places in eighths.
    Swing { axis: usize, ends: [i64; 2], words: String },
    /// Its end; INSTANT.
    Still { axis: usize, words: &'static str },
    /// An independent axis.
    Alone { axis: usize, to: i64, words: String },
    /// Corners are rounded, or not, from here on.
    Smooth(&'static str, Option<bool>),
    /// Refused.
    Bad(&'static str),
    /// The program ends.
    End,
}

impl Line {
    /// As text, without its end.
    pub fn text(&self) -> String {
        match self {
            Self::Move { mode, relative, zero, feed, stop, to } => {
                let mut words = Vec::new();
                words.extend(relative.map(|relative| if relative { "G91" } else { "G90" }.to_owned()));
                words.extend(mode.map(|mode| format!("G0{mode}")));
                words.extend(zero.map(|zero| format!("G{}", zero.map_or(53, |set| 54 + set))));
                words.extend(stop.then(|| "G60".to_owned()));
                words.extend(named(to));
                words.extend(feed.map(|feed| format!("F{feed}")));
                words.join(" ")
            }
            Self::Arc { clockwise, i, j, z, feed } => {
                let g = if *clockwise { 2 } else { 3 };
                let [x2, y2, z, i, j] = [2 * i, 2 * j, *z, *i, *j].map(decimal);
                format!("G91 G0{g} X{x2} Y{y2} Z{z} I{i} J{j} F{feed}")
            }
            Self::Shift(by) => format!("G90 G92 {}", named(by).join(" ")),
            Self::Function(code) if *code < 1000 => format!("M{code}"),
            Self::Function(code) => format!("H{}", code - 1000),
            Self::Swing { axis, ends: [first, second], words } => {
                let [first, second] = [*first, *second].map(decimal);
                format!("{}[OSC ON 1ST_POS={first} 2ND_POS={second} {words}]", NAMES[*axis])
            }
            Self::Still { axis, words } => format!("{}[OSC {words}]", NAMES[*axis]),
            Self::Alone { axis, to, words } => format!("{}[{words} POS={}]", NAMES[*axis], decimal(*to)),
            Self::Smooth(text, _) => (*text).to_owned(),
            Self::Bad(text) => (*text).to_owned(),
            Self::End => "M30".to_owned(),
        }
    }

    /// Carries the line out; `false` if the program does not continue after it.
    pub fn apply(&self, model: &mut Model, effect: &mut Effect) -> bool {
        match self {
            Self::Move { mode, relative, zero, feed, to, .. } => {
                let modal = &mut model.modal;
                modal.mode = mode.unwrap_or(modal.mode);
                modal.relative = relative.unwrap_or(modal.relative);
                modal.zero = zero.unwrap_or(modal.zero);
                modal.feed |= feed.is_some();
                let mut end = model.at;
                for (axis, to) in to.iter().enumerate() {
                    let Some(to) = to else { continue };
                    if model.modal.relative {
                        end[axis] += bits(*to);
                    } else {
                        end[axis] = bits(*to) + model.offset(axis);
                        model.known[axis] = true;
                    }
                }
                model.moves(end, None, effect);
            }
            Self::Arc { clockwise, i, j, z, .. } => {
                let modal = &mut model.modal;
                (modal.mode, modal.relative, modal.feed) = (if *clockwise { 2 } else { 3 }, true, true);
                let mut end = model.at;
                for (axis, by) in [2 * i, 2 * j, *z].into_iter().enumerate() {
                    end[axis] += bits(by);
                }
                let mm = |bits: i64| bits as f64 / (1_u64 << 32) as f64;
                let (i, j) = (*i as f64 / 8.0, *j as f64 / 8.0);
                let centre = [mm(model.at[0]) + i, mm(model.at[1]) + j];
                model.moves(end, Some((centre, i.hypot(j))), effect);
            }
            Self::Shift(by) => {
                model.modal.relative = false;
                for (shift, by) in model.modal.shift.iter_mut().zip(by) {
                    *shift = by.unwrap_or(*shift);
                }
            }
            Self::Function(code) => effect.outputs.push(*code),
            Self::Swing { axis, ends, .. } => {
                effect.beside = true;
                ends.iter().for_each(|end| effect.reaches(*axis, bits(*end)));
                (model.at[*axis], model.known[*axis]) = (bits(ends[1]), true);
            }
            Self::Still { axis, words } => {
                if words.ends_with("INSTANT") {
                    model.known[*axis] = false;
                }
            }
            Self::Alone { axis, to, .. } => {
                effect.beside = true;
                effect.reaches(*axis, bits(*to));
                (model.at[*axis], model.known[*axis]) = (bits(*to), true);
            }
            Self::Smooth(_, on) => {
                model.modal.smooth = on.unwrap_or(model.modal.smooth);
                effect.smooth |= on.unwrap_or(false);
            }
            Self::Bad(_) => {
                effect.refused = true;
                return false;
            }
            Self::End => return false,
        }
        true
    }
}

/// Words of axes.
fn named(values: &[Option<i64>; 3]) -> Vec<String> {
    let of = |(axis, value): (usize, &Option<i64>)| Some(format!("{}{}", NAMES[axis], decimal((*value)?)));
    values.iter().enumerate().filter_map(of).collect()
}

/// Random lines that can run from what is in force in `model`, which follows them as if none were refused.
/// `single`: a few without an end, else a program; `refuses`: one of them is refused.
pub fn random(random: &mut Random, model: &mut Model, single: bool, refuses: bool) -> Vec<Line> {
    let count = if single { 1 + random.bits() % 3 } else { 1 + random.bits() % 12 };
    let mut lines = Vec::new();
    let bad = if refuses { random.bits() % count } else { count };
    for number in 0..count {
        if number == bad {
            lines.push(Line::Bad(REFUSED[(random.bits() % REFUSED.len() as u64) as usize]));
        }
        let line = any(random, model);
        line.apply(model, &mut Effect::default());
        lines.push(line);
    }
    if single && model.modal.smooth {
        // The last corner waits for what follows.
        lines.push(Line::Smooth("#CONTOUR MODE OFF", Some(false)));
        lines.push(Line::Smooth("#HSC OFF", Some(false)));
        model.modal.smooth = false;
    }
    if !single {
        lines.push(Line::End);
        model.modal = Modal::START;
    }
    lines
}

fn any(random: &mut Random, model: &Model) -> Line {
    let axis = (random.bits() % 3) as usize;
    let feed = random.magnitude(300.0, 20_000.0) as u32;
    match random.bits() % 24 {
        0..=10 => motion(random, model, feed),
        11..=13 if model.known[0] && model.known[1] && model.known[2] => {
            let near = |k: usize| if model.at[k] > 0 { -1 } else { 1 };
            let [i, j] = [0, 1].map(|k| near(k) * (1 + (random.bits() % 40) as i64));
            let z = if random.once_in(2) { 0 } else { near(2) * 8 };
            Line::Arc { clockwise: random.once_in(2), i, j, z, feed }
        }
        14 => {
            let mut by = [None; 3];
            by[axis] = Some(eighths(random, 40));
            Line::Shift(by)
        }
        15 | 16 => Line::Function([7, 8, 9, 1001, 1002][(random.bits() % 5) as usize]),
        17 | 18 => {
            let mut ends = [eighths(random, 160), eighths(random, 160)];
            if (ends[0] - ends[1]).abs() < 8 {
                ends[0] = ends[1] + 16;
            }
            let mut words = match random.bits() % 3 {
                0 => format!("FEED={feed}"),
                1 => format!("FREQ={:.3}", random.magnitude(0.3, 8.0)),
                _ => format!("TIME={:.3}", random.magnitude(0.2, 3.0)),
            };
            if random.once_in(3) {
                words += " 1ST_DELT=0.05 2ND_DELT=0.1";
            }
            if random.once_in(2) {
                words += &format!(" NBR_OSC={}", 1 + random.bits() % 3);
            }
            Line::Swing { axis, ends, words }
        }
        19 => {
            Line::Still { axis, words: ["OFF", "OFF FEED=4000", "OFF INSTANT"][(random.bits() % 3) as usize] }
        }
        20 => {
            let word = if random.once_in(2) { "INDP_SYN" } else { "INDP_ASYN" };
            let words = if random.once_in(2) {
                format!("{word} G01 G90 FEED={feed}")
            } else {
                format!("{word} G00 G90")
            };
            Line::Alone { axis, to: eighths(random, 160), words }
        }
        _ => {
            let (text, on) = [
                ("#CONTOUR MODE ON [DEV PATH_DEV=0.05]", Some(true)),
                ("#CONTOUR MODE ON [DIST PRE_DIST=1 POST_DIST=1]", Some(true)),
                ("#CONTOUR MODE OFF", None),
                ("#HSC ON [SURFACE PATH_DEV=0.1]", Some(true)),
                ("#HSC OFF", None),
                ("G04 0.05", None),
                ("#WAIT INDP ALL", None),
                ("#FLUSH&WAIT", None),
                ("G131 50", None),
                ("G360", None),
                ("G70 G71", None),
            ][(random.bits() % 10) as usize];
            Line::Smooth(text, on)
        }
    }
}

/// A linear motion that is possible with what is in force.
fn motion(random: &mut Random, model: &Model, feed: u32) -> Line {
    let modal = &model.modal;
    let all = model.known.iter().all(|known| *known);
    let relative = match random.bits() % 4 {
        0 => Some(false),
        1 if all => Some(true),
        _ if modal.relative && !all => Some(false),
        _ => None,
    };
    let is_relative = relative.unwrap_or(modal.relative);
    let mode = if modal.mode > 1 || random.once_in(2) { Some(u8::from(!random.once_in(4))) } else { None };
    let is_feed = mode.unwrap_or(modal.mode) == 1;
    let with_feed = is_feed && (!modal.feed || random.once_in(3));
    let zero = match random.bits() % 8 {
        0 => Some(None),
        1 => Some(Some((random.bits() % 6) as usize)),
        _ => None,
    };
    let mut to = [None; 3];
    for (axis, to) in to.iter_mut().enumerate() {
        if random.once_in(2) {
            let way = eighths(random, 120);
            let far = model.at[axis] >> super::model::EIGHTH;
            *to = Some(if is_relative && far.abs() > 160 { -way.abs() * far.signum() } else { way });
        }
    }
    if to.iter().all(Option::is_none) {
        to[0] = Some(8);
    }
    Line::Move { mode, relative, zero, feed: with_feed.then_some(feed), stop: random.once_in(8), to }
}
