//! The meaning of parameters, in plain words.

/// The meaning of a parameter, by its dotted name inside its table.
pub fn of(name: &str) -> &'static str {
    ALL.iter().find(|(known, _)| *known == name).map_or("", |(_, words)| words)
}

const ALL: &[(&str, &str)] = &[
    ("slope_profil.a_beschl", "acceleration at feed"),
    ("slope_profil.a_brems", "deceleration at feed"),
    ("slope_profil.a_grenz", "acceleration of rapid motion"),
    ("lslope_profil.a_grenz_stufe_1", "STEP: rapid acceleration, low speed"),
    ("lslope_profil.a_grenz_stufe_2", "STEP: rapid acceleration, high speed"),
    ("dynamik.a_max", "largest acceleration, in curves too"),
    ("lslope_profil.a_stufe_1", "STEP: acceleration at low speed"),
    ("lslope_profil.a_stufe_2", "STEP: acceleration at high speed"),
    ("dynamik.a_trans_weight", "share of acceleration at a knee"),
    ("kenngr.achs_mode", "type of the axis, master axis"),
    ("dynamik.r_trans_weight", "share of jerk at a knee"),
    ("slope_profil.tr_beschl_ab", "time in which acceleration falls"),
    ("slope_profil.tr_beschl_zu", "time in which acceleration rises"),
    ("slope_profil.tr_brems_ab", "time in which deceleration falls"),
    ("slope_profil.tr_brems_zu", "time in which deceleration rises"),
    ("dynamik.tr_geom", "ramp time in curves"),
    ("slope_profil.tr_grenz", "ramp time of rapid motion"),
    ("dynamik.tr_min", "shortest ramp time"),
    ("vb_eilgang", "speed of rapid motion"),
    ("lslope_profil.vb_grenz_stufe_1_2", "STEP: rapid speed between low and high"),
    ("dynamik.vb_max", "largest speed"),
    ("vb_max_red", "reduced speed (0: none)"),
    ("lslope_profil.vb_stufe_1_2", "STEP: speed between low and high"),
    ("lslope_profil.d_grenz_stufe_1", "STEP: rapid deceleration, low speed"),
    ("lslope_profil.d_grenz_stufe_2", "STEP: rapid deceleration, high speed"),
    ("lslope_profil.d_stufe_1", "STEP: deceleration at low speed"),
    ("lslope_profil.d_stufe_2", "STEP: deceleration at high speed"),
    ("dynamik.tr_w_min", "shortest ramp time of weights"),
    ("default_feed_axis", "the feed counts along this axis"),
    ("np_grp.1.versch", "zero offset G54"),
    ("np_grp.2.versch", "zero offset G55"),
    ("np_grp.3.versch", "zero offset G56"),
    ("np_grp.4.versch", "zero offset G57"),
    ("np_grp.5.versch", "zero offset G58"),
    ("np_grp.6.versch", "zero offset G59"),
    ("np_grp.7.versch", "zero offset G59.1"),
    ("np_grp.8.versch", "zero offset G59.2"),
    ("np_grp.9.versch", "zero offset G59.3"),
    ("g28", "stored place of G28"),
    ("g30", "stored place of G30"),
    ("kenngr.swe_neg", "software limit, negative end"),
    ("kenngr.swe_pos", "software limit, positive end"),
    ("filter_fir.enable", "filter on at program start"),
    ("filter_fir.fcut", "filter: cut-off frequency"),
    ("filter_fir.type", "filter: type"),
    ("filter_fir.order", "filter: order"),
    ("filter_fir.share", "filter: share"),
    ("filter_fir.order_time", "filter: order as a time"),
    ("filter_fir.quality", "filter: quality"),
    ("cycle_us", "interpolation cycle"),
    ("look_ahead", "blocks planned ahead"),
    ("prog_start.feedrate_factor", "unit of F"),
    ("prog_start.slope.profile", "slope: how speed changes"),
    ("prog_start.slope.acceleration", "accelerations that G130 weights"),
    ("prog_start.slope.ramp_time", "ramp times that G132 weights"),
    ("corr_v_trans_jerk", "jerk limit at tangential transitions"),
    ("mode_implicite_sync_indp_asyn_axis", "motions wait for single axes"),
    ("mode_exact_stop_indp_axis", "exact stop and independent axes"),
    ("override_weight_prog_feed", "what the override weights"),
    ("vector.acceleration", "largest acceleration of the path"),
    ("vector.deceleration", "largest deceleration of the path"),
    ("vector.velocity", "largest speed of the path"),
    ("vector.acc_dec_unit", "unit of path accelerations"),
    ("vector.cir_radial_acc_limit", "path acceleration in arcs too"),
    ("check_jerk_on_poly_path", "jerk limit in curves of corners"),
    ("merge_chords", "straight parts merged by Surface"),
    ("hsc.bspline.auto_contour_mode", "contour mode beside HSC B-splines"),
    ("configuration.path_preparation.function", "functions that are enabled"),
    ("default_index", "zero offset at program start"),
    ("blend_tolerance", "tolerance of G64 without P"),
    ("block_delete", "lines that begin with / are skipped"),
    ("optional_stop", "M1 stops"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use glidepath::machine::parameter::{AXIS, AXIS_FOREIGN, CHANNEL, CHANNEL_FOREIGN};

    #[test]
    fn every_parameter_has_its_words() {
        let axis = AXIS.iter().chain(AXIS_FOREIGN).map(|parameter| parameter.name);
        let channel = CHANNEL.iter().chain(CHANNEL_FOREIGN).map(|parameter| parameter.name);
        let silent: Vec<&str> = axis.chain(channel).filter(|name| of(name).is_empty()).collect();
        assert!(silent.is_empty(), "{silent:?}");
    }
}
