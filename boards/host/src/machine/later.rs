//! Parameters that the ISG kernel has and this version does not use yet: refused by name, not as unknown.

/// Axis parameters: ISG id and dotted name inside `[axis.X]`.
pub const AXIS: &[(&str, &str)] = &[
    ("P-AXIS-00005", "lslope_profil.a_grenz_stufe_1"),
    ("P-AXIS-00006", "lslope_profil.a_grenz_stufe_2"),
    ("P-AXIS-00011", "lslope_profil.a_stufe_1"),
    ("P-AXIS-00012", "lslope_profil.a_stufe_2"),
    ("P-AXIS-00154", "dynamik.r_trans_weight"),
    ("P-AXIS-00211", "lslope_profil.vb_grenz_stufe_1_2"),
    ("P-AXIS-00214", "vb_max_red"),
    ("P-AXIS-00221", "lslope_profil.vb_stufe_1_2"),
    ("P-AXIS-00280", "lslope_profil.d_grenz_stufe_1"),
    ("P-AXIS-00281", "lslope_profil.d_grenz_stufe_2"),
    ("P-AXIS-00282", "lslope_profil.d_stufe_1"),
    ("P-AXIS-00283", "lslope_profil.d_stufe_2"),
    ("P-AXIS-00293", "tr_w_min"),
    ("P-AXIS-00573", "filter_fir.enable"),
    ("P-AXIS-00585", "filter_fir.fcut"),
    ("P-AXIS-00586", "filter_fir.type"),
    ("P-AXIS-00587", "filter_fir.order"),
    ("P-AXIS-00590", "filter_fir.share"),
    ("P-AXIS-00591", "filter_fir.order_time"),
    ("P-AXIS-00593", "filter_fir.quality"),
];

/// Channel parameters: ISG id and dotted name inside `[channel]`.
pub const CHANNEL: &[(&str, &str)] = &[
    ("P-CHAN-00002", "vector.acceleration"),
    ("P-CHAN-00009", "corr_v_trans_jerk"),
    ("P-CHAN-00027", "h_synch"),
    ("P-CHAN-00041", "m_synch"),
    ("P-CHAN-00066", "override_weight_prog_feed"),
    ("P-CHAN-00090", "vector.velocity"),
    ("P-CHAN-00141", "jerk_monitoring_mode"),
    ("P-CHAN-00217", "hsc.gen.on_delay_output_one_block"),
    ("P-CHAN-00239", "hsc.bspline.auto_contour_mode"),
    ("P-CHAN-00605", "configuration.path_preparation.fct_enable"),
];
