//! Keywords of the commands for smoothing and for speed profiles, with their ranges.
use super::function::*;
use super::keyword::{COORDINATE, DEGREES, Keywords, MILLIMETRES, PERCENT, Range, Slot, Units};

impl Keywords for Slope {
    const COMMAND: &'static str = "#SLOPE";
    const LIST: &'static [&'static str] = &["TYPE", "NO_OPT"];

    fn slot(&mut self, keyword: &'static str, _: bool, _: Units) -> Slot<'_> {
        match keyword {
            "TYPE" => Slot::Slope(&mut self.kind),
            _ => Slot::Flag(&mut self.no_opt),
        }
    }
}

/// Keywords of each method of `#CONTOUR MODE`. Actions (PRE_ACTION and so on) fit all methods, except for
/// those that are optimised over time between two blocks.
const fn contour_list(method: ContourMethod) -> (&'static str, &'static [&'static str]) {
    match method {
        ContourMethod::Dev => (
            "DEV",
            &[
                "PATH_DEV",
                "RELEVANT_PATH",
                "TRACK_DEV",
                "RELEVANT_TRACK",
                "REMAIN_PART",
                "CHECK_JERK",
                "MAX_ANGLE",
                "CONST_VEL",
            ],
        ),
        ContourMethod::Dist => (
            "DIST",
            &[
                "PRE_DIST",
                "POST_DIST",
                "RELEVANT_PATH",
                "RELEVANT_TRACK",
                "TRACK_DEV",
                "REMAIN_PART",
                "CHECK_JERK",
                "MAX_ANGLE",
                "CONST_VEL",
            ],
        ),
        ContourMethod::Pos => ("POS", &["PRE_DIST", "POST_DIST", "X", "Y", "Z", "CHECK_JERK", "CONST_VEL"]),
        ContourMethod::DistSoft => {
            ("DIST_SOFT", &["PATH_DIST", "TRACK_DIST", "ACC_MAX", "ACC_MIN", "RAMP_TIME", "DIST_WEIGHT"])
        }
        ContourMethod::DistMaster => {
            ("DIST_MASTER", &["SYM_DIST", "ACC_MAX", "ACC_MIN", "RAMP_TIME", "DIST_WEIGHT"])
        }
        ContourMethod::Ptp => ("PTP", &["PATH_DEV", "PATH_DIST", "MERGE"]),
    }
}

/// Sets a value that may be given once.
fn choose<V>(slot: &mut Option<V>, value: V) -> Slot<'_> {
    if slot.is_some() {
        return Slot::Twice;
    }
    *slot = Some(value);
    Slot::Done
}

impl Keywords for Contour {
    const COMMAND: &'static str = "#CONTOUR MODE";
    const LIST: &'static [&'static str] = &[
        "DEV",
        "DIST",
        "POS",
        "DIST_SOFT",
        "DIST_MASTER",
        "PTP",
        "PRE_ACTION",
        "INTER_ACTION",
        "POST_ACTION",
        "PATH_DEV",
        "TRACK_DEV",
        "RELEVANT_PATH",
        "RELEVANT_TRACK",
        "REMAIN_PART",
        "CHECK_JERK",
        "MAX_ANGLE",
        "CONST_VEL",
        "PRE_DIST",
        "POST_DIST",
        "PATH_DIST",
        "TRACK_DIST",
        "SYM_DIST",
        "ACC_MAX",
        "ACC_MIN",
        "RAMP_TIME",
        "DIST_WEIGHT",
        "MERGE",
        "X",
        "Y",
        "Z",
    ];

    fn slot(&mut self, keyword: &'static str, _: bool, units: Units) -> Slot<'_> {
        let method = match keyword {
            "DEV" => Some(ContourMethod::Dev),
            "DIST" => Some(ContourMethod::Dist),
            "POS" => Some(ContourMethod::Pos),
            "DIST_SOFT" => Some(ContourMethod::DistSoft),
            "DIST_MASTER" => Some(ContourMethod::DistMaster),
            "PTP" => Some(ContourMethod::Ptp),
            _ => None,
        };
        if let Some(method) = method {
            return match self.method {
                Some(other) if other != method => Slot::Mismatch(contour_list(other).0),
                _ => choose(&mut self.method, method),
            };
        }
        if let ("PRE_ACTION" | "INTER_ACTION" | "POST_ACTION", Some(method)) = (keyword, self.method)
            && matches!(method, ContourMethod::DistSoft | ContourMethod::DistMaster)
        {
            return Slot::Mismatch(contour_list(method).0);
        }
        match keyword {
            "PRE_ACTION" => return choose(&mut self.action, ContourAction::Pre),
            "INTER_ACTION" => return choose(&mut self.action, ContourAction::Inter),
            "POST_ACTION" => return choose(&mut self.action, ContourAction::Post),
            _ => {}
        }
        if let Some((name, list)) = self.method.map(contour_list)
            && !list.contains(&keyword)
        {
            return Slot::Mismatch(name);
        }
        let coordinate = COORDINATE.times(units.length);
        match keyword {
            "PATH_DEV" => Slot::Number(&mut self.path_dev, MILLIMETRES),
            "TRACK_DEV" => Slot::Number(&mut self.track_dev, DEGREES),
            "RELEVANT_PATH" => Slot::Number(&mut self.relevant_path, MILLIMETRES),
            "RELEVANT_TRACK" => Slot::Number(&mut self.relevant_track, DEGREES),
            "REMAIN_PART" => Slot::Number(&mut self.remain_part, PERCENT),
            "CHECK_JERK" => Slot::Level(&mut self.check_jerk, 2),
            "MAX_ANGLE" => Slot::Number(&mut self.max_angle, Range::new(0, 180, "deg")),
            "CONST_VEL" => Slot::Flag(&mut self.const_vel),
            "PRE_DIST" => Slot::Number(&mut self.pre_dist, MILLIMETRES),
            "POST_DIST" => Slot::Number(&mut self.post_dist, MILLIMETRES),
            "PATH_DIST" => Slot::Number(&mut self.path_dist, MILLIMETRES.or_off()),
            "TRACK_DIST" => Slot::Number(&mut self.track_dist, DEGREES.or_off()),
            "SYM_DIST" => Slot::Number(&mut self.sym_dist, MILLIMETRES.or_off()),
            "ACC_MAX" => Slot::Number(&mut self.acc_max, PERCENT),
            "ACC_MIN" => Slot::Number(&mut self.acc_min, PERCENT),
            "RAMP_TIME" => Slot::Number(&mut self.ramp_time, Range::new(0, 10_000, "%")),
            "DIST_WEIGHT" => Slot::Number(&mut self.dist_weight, PERCENT),
            "MERGE" => Slot::Flag(&mut self.merge),
            other => {
                let [x, y, z] = &mut self.point;
                Slot::Number(
                    if other == "X" {
                        x
                    } else if other == "Y" {
                        y
                    } else {
                        z
                    },
                    coordinate,
                )
            }
        }
    }
}

const SURFACE: &[&str] = &[
    "PATH_DEV",
    "PATH_DEV_G00",
    "TRACK_DEV",
    "TRACK_DEV_G00",
    "MAX_ANGLE",
    "CHECK_JERK",
    "AUTO_OFF_G00",
    "CIR_MODE",
    "CIR_MIN_ANGLE",
    "CIR_MIN_RADIUS",
    "MERGE",
    "LENGTH_LONG_CIR",
];
const BSPLINE: &[&str] = &[
    "PATH_DEV",
    "TRACK_DEV",
    "MERGE",
    "AUTO_OFF_PATH",
    "AUTO_OFF_TRACK",
    "AUTO_OFF_G00",
    "AUTO_OFF_G60",
    "MAX_PATH_LENGTH",
    "MAX_ANGLE",
];

/// The keywords of `#HSC`. OPMODE becomes a method after the whole list is read.
#[derive(Default)]
pub(super) struct HscWords {
    pub hsc: Hsc,
    pub opmode: Option<u8>,
}

impl Keywords for HscWords {
    const COMMAND: &'static str = "#HSC";
    const LIST: &'static [&'static str] = &[
        "SURFACE",
        "BSPLINE",
        "OPMODE",
        "PATH_DEV",
        "PATH_DEV_G00",
        "TRACK_DEV",
        "TRACK_DEV_G00",
        "MAX_ANGLE",
        "CHECK_JERK",
        "AUTO_OFF_G00",
        "CIR_MODE",
        "CIR_MIN_ANGLE",
        "CIR_MIN_RADIUS",
        "MERGE",
        "LENGTH_LONG_CIR",
        "AUTO_OFF_PATH",
        "AUTO_OFF_TRACK",
        "AUTO_OFF_G60",
        "MAX_PATH_LENGTH",
        "CONTERROR",
    ];

    fn slot(&mut self, keyword: &'static str, first: bool, _: Units) -> Slot<'_> {
        let h = &mut self.hsc;
        match keyword {
            "SURFACE" | "BSPLINE" if !first => return Slot::Mismatch("a keyword before it"),
            "SURFACE" => return choose(&mut h.method, HscMethod::Surface),
            "BSPLINE" => return choose(&mut h.method, HscMethod::Bspline),
            _ => {}
        }
        let surface = h.method == Some(HscMethod::Surface);
        match h.method {
            Some(HscMethod::Surface) if !SURFACE.contains(&keyword) => return Slot::Mismatch("SURFACE"),
            Some(HscMethod::Bspline) if !BSPLINE.contains(&keyword) => return Slot::Mismatch("BSPLINE"),
            _ => {}
        }
        // Surface has no deviation 0. For the B-spline, 0 means not monitored.
        let deviation = if surface { MILLIMETRES.above() } else { MILLIMETRES };
        match keyword {
            "OPMODE" => Slot::Level(&mut self.opmode, u8::MAX),
            "PATH_DEV" => Slot::Number(&mut h.path_dev, deviation),
            "PATH_DEV_G00" => Slot::Number(&mut h.path_dev_g00, deviation),
            "TRACK_DEV" => Slot::Number(&mut h.track_dev, DEGREES),
            "TRACK_DEV_G00" => Slot::Number(&mut h.track_dev_g00, DEGREES),
            "MAX_ANGLE" => Slot::Number(&mut h.max_angle, Range::new(0, 180, "deg")),
            "CHECK_JERK" => Slot::Level(&mut h.check_jerk, 2),
            "AUTO_OFF_G00" => Slot::Flag(&mut h.auto_off_g00),
            "CIR_MODE" => Slot::Level(&mut h.cir_mode, 2),
            "CIR_MIN_ANGLE" => Slot::Number(&mut h.cir_min_angle, DEGREES),
            "CIR_MIN_RADIUS" => Slot::Number(&mut h.cir_min_radius, MILLIMETRES),
            "MERGE" => Slot::Flag(&mut h.merge),
            "LENGTH_LONG_CIR" => Slot::Number(&mut h.length_long_cir, MILLIMETRES.above()),
            "AUTO_OFF_PATH" => Slot::Flag(&mut h.auto_off_path),
            "AUTO_OFF_TRACK" => Slot::Flag(&mut h.auto_off_track),
            "AUTO_OFF_G60" => Slot::Flag(&mut h.auto_off_g60),
            "MAX_PATH_LENGTH" => Slot::Number(&mut h.max_path_length, MILLIMETRES),
            _ => Slot::Number(&mut h.conterror, MILLIMETRES.above()),
        }
    }
}

impl Keywords for Filter {
    const COMMAND: &'static str = "#FILTER";
    const LIST: &'static [&'static str] =
        &["ORDER", "ORDER_TIME", "SHARE", "AX_DEV", "FCUT", "ACC_FACT", "QUALITY", "HSC"];

    fn slot(&mut self, keyword: &'static str, _: bool, _: Units) -> Slot<'_> {
        match keyword {
            "ORDER" => Slot::Level(&mut self.order, 200),
            "ORDER_TIME" => Slot::Number(&mut self.order_time_us, Range::new(0, 2_000_000, "µs")),
            "SHARE" => Slot::Number(&mut self.share, PERCENT),
            "AX_DEV" => Slot::Number(&mut self.ax_dev, MILLIMETRES),
            "FCUT" => Slot::Number(&mut self.fcut, Range::new(1, 100_000, "Hz")),
            "ACC_FACT" => Slot::Number(&mut self.acc_fact, Range::new(1, 10, "")),
            "QUALITY" => Slot::Number(&mut self.quality, Range::new(0, 1, "").above()),
            _ => {
                self.hsc = true;
                Slot::Done
            }
        }
    }
}

impl Keywords for VectorLimit {
    const COMMAND: &'static str = "#VECTOR LIMIT";
    const LIST: &'static [&'static str] =
        &["ACC", "DEC", "VEL", "RADIAL_ACC", "RADIAL_JERK", "JERK", "TRANS_ACC", "FEED", "RAPID", "ALL"];

    fn slot(&mut self, keyword: &'static str, _: bool, _: Units) -> Slot<'_> {
        let on = self.on;
        let slot = match keyword {
            "ACC" => &mut self.acc,
            "DEC" => &mut self.dec,
            "VEL" => &mut self.vel,
            "RADIAL_ACC" => &mut self.radial_acc,
            "RADIAL_JERK" => &mut self.radial_jerk,
            "JERK" => &mut self.jerk,
            "TRANS_ACC" => &mut self.trans_acc,
            other => {
                let mark = match other {
                    "FEED" => &mut self.feed,
                    "RAPID" => &mut self.rapid,
                    _ => &mut self.all,
                };
                *mark = true;
                return Slot::Done;
            }
        };
        // With OFF, limits are named without values.
        if on { Slot::Limit(slot) } else { choose(slot, Limit::Channel) }
    }
}

/// START and END of #AKIMA TRANS.
#[derive(Default)]
pub(super) struct AkimaWords {
    pub start: Option<Tangent>,
    pub end: Option<Tangent>,
}

impl Keywords for AkimaWords {
    const COMMAND: &'static str = "#AKIMA TRANS";
    const LIST: &'static [&'static str] = &["START", "END"];

    fn slot(&mut self, keyword: &'static str, _: bool, _: Units) -> Slot<'_> {
        Slot::Tangent(if keyword == "START" { &mut self.start } else { &mut self.end })
    }
}

/// PARAM of #CONTOUR LOOKAHEAD LOG.
#[derive(Default)]
pub(super) struct LogWords {
    pub param: Option<f64>,
}

impl Keywords for LogWords {
    const COMMAND: &'static str = "#CONTOUR LOOKAHEAD LOG";
    const LIST: &'static [&'static str] = &["PARAM"];

    fn slot(&mut self, _: &'static str, _: bool, _: Units) -> Slot<'_> {
        Slot::Real(&mut self.param)
    }
}
