//! Names with common units that a machine file may use instead of ISG's parameters.

/// A name with its unit, and the parameters that it sets.
pub struct Plain {
    /// Its name, of a linear axis.
    pub name: &'static str,
    /// Its name, of a rotary axis.
    pub rotary: &'static str,
    /// ISG's parameters that get its value.
    pub isg: &'static [&'static str],
    /// Factor from its unit to ISG's unit.
    pub scale: i64,
}

const fn plain(name: &'static str, rotary: &'static str, isg: &'static [&'static str], scale: i64) -> Plain {
    Plain { name, rotary, isg, scale }
}

/// Names of an axis.
pub const AXIS: &[Plain] = &[
    plain("rapid_speed_mm_s", "rapid_speed_deg_s", &["vb_eilgang"], 1000),
    plain("max_speed_mm_s", "max_speed_deg_s", &["dynamik.vb_max"], 1000),
    plain("max_acceleration_mm_s2", "max_acceleration_deg_s2", &["dynamik.a_max"], 1),
    plain("acceleration_mm_s2", "acceleration_deg_s2", ACCELERATIONS, 1),
    plain("ramp_time_ms", "ramp_time_ms", RAMPS, 1000),
    plain("curve_ramp_time_ms", "curve_ramp_time_ms", &["dynamik.tr_geom"], 1000),
    plain("travel_min_mm", "travel_min_deg", &["kenngr.swe_neg"], 10_000),
    plain("travel_max_mm", "travel_max_deg", &["kenngr.swe_pos"], 10_000),
];

/// Names of the channel.
pub const CHANNEL: &[Plain] = &[plain("cycle_ms", "cycle_ms", &["cycle_us"], 1000)];

const ACCELERATIONS: &[&str] = &["slope_profil.a_beschl", "slope_profil.a_brems", "slope_profil.a_grenz"];

const RAMPS: &[&str] = &[
    "slope_profil.tr_beschl_zu",
    "slope_profil.tr_beschl_ab",
    "slope_profil.tr_brems_zu",
    "slope_profil.tr_brems_ab",
    "slope_profil.tr_grenz",
];

/// All of them.
pub fn names() -> impl Iterator<Item = &'static str> {
    AXIS.iter().chain(CHANNEL).flat_map(|plain| [plain.name, plain.rotary]).chain(["slope"])
}
