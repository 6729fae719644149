//! Tests of the loader of machine files.
use super::value::{Unfit, exact_milli};
use super::*;
use glidepath::machine::{
    AccelerationUnit, Dialect, ForeignAxis, ForeignChannel, MODE_LINEAR, MODE_MASTER, Synch, SynchTable,
    ToolLengths,
};

#[test]
fn the_default_file_is_the_built_in_machine() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/machines/default.toml"));
    let loaded = load(path, &Overrides::default()).unwrap_or_else(|_| panic!("default.toml is refused"));
    assert_eq!(loaded.axes, Machine::built_in().axes);
    assert_eq!(loaded.channel, Machine::built_in().channel);
}

/// The result of a machine with these lines of the channel's path preparation.
fn prepared(lines: &str) -> Result<Machine, Vec<Diagnostic>> {
    let name = format!("glidepath-enable-{}-{}", std::process::id(), lines.len());
    let file = std::env::temp_dir().join(name);
    let text = format!(
        "[channel.prog_start]\nslope.profile = 1\n[channel.configuration.path_preparation]\n{lines}\n[axis.X]\ntype = \"linear\"\n"
    );
    std::fs::write(&file, text).expect("a file for the test");
    let machine = load(&file, &Overrides::default());
    let _ = std::fs::remove_file(&file);
    machine
}

/// D3-275: P-CHAN-00605, whose index 0 is P-CHAN-00600; both spellings are valid.
/// Rows: D3-275, C40-072.
#[test]
fn functions_are_enabled_by_both_spellings() {
    let enabled = |lines: &str| {
        let machine = prepared(lines).unwrap_or_else(|_| panic!("refused: {lines}"));
        (machine.channel.ptp, machine.channel.surface, machine.warnings.len())
    };
    assert_eq!(enabled("function = \"FCT_DEFAULT|FCT_SURFACE\""), (false, true, 0));
    assert_eq!(enabled("fct_enable = [\"FCT_DEFAULT|FCT_SURFACE\"]"), (false, true, 0));
    assert_eq!(enabled("fct_enable = [\"FCT_DEFAULT\"]"), (false, false, 0));
    // The second mode of program start does nothing here, and that is said.
    assert_eq!(
        enabled("fct_enable = [\"FCT_DEFAULT|FCT_PTP\", \"FCT_DEFAULT|FCT_SURFACE\"]"),
        (true, false, 1)
    );
    let refused = |lines: &str| prepared(lines).err().map_or(0, |refused| refused.len());
    // Names in any order, with blanks or without.
    assert_eq!(enabled("function = \"FCT_SURFACE| FCT_PTP |FCT_DEFAULT\""), (true, true, 0));
    assert_eq!(refused("function = \"FCT_SURFACE\""), 1);
    assert_eq!(refused("function = \"FCT_DEFAULT|\""), 1);
    assert_eq!(refused("fct_enable = \"FCT_DEFAULT\""), 1);
    assert_eq!(refused("fct_enable = []"), 1);
    assert_eq!(refused("fct_enable = [\"FCT_SURFACES\"]"), 1);
    assert_eq!(refused("fct_enable = [\"FCT_DEFAULT\", \"FCT_DEFAULT\", \"FCT_DEFAULT\"]"), 1);
    assert_eq!(refused("fct_enable = [\"FCT_DEFAULT\"]\nfunction = \"FCT_DEFAULT\""), 1);
}

#[test]
fn every_parameter_is_read() {
    let dir = std::env::temp_dir().join(format!("glidepath-parameters-{}", std::process::id()));
    let text = "[channel]\ndialect = \"grbl\"\nblend_tolerance = 50\nblock_delete = 1\noptional_stop = 1\ndefault_index = 6\ncycle_us = 2000\nlook_ahead = 30\ncorr_v_trans_jerk = 1\nmode_implicite_sync_indp_asyn_axis = 1\nmode_exact_stop_indp_axis = 2\noverride_weight_prog_feed = 2\ncheck_jerk_on_poly_path = 2\nmerge_chords = 40\nhsc.bspline.auto_contour_mode = 2\n\
        [channel.prog_start]\nfeedrate_factor = 0.1\nslope = { profile = 1, acceleration = 2, ramp_time = 4 }\n\
        [channel.configuration.path_preparation]\nfunction = \"FCT_DEFAULT|FCT_PTP\"\n\
        [channel.vector]\nacceleration = 500.5\ndeceleration = 400\nvelocity = 1500\nacc_dec_unit = \"MM_S2\"\n\
        cir_radial_acc_limit = 1\n[channel.m_synch]\n25 = \"MVS_SNS\"\n26 = 0x2\n3 = \"NO_SYNCH\"\n[channel.h_synch]\n7 = \"MNS_SNS\"\n[channel.tool_length]\n5 = -52.125\n[axis.X]\nnp_grp.7.versch = 7\nnp_grp.8.versch = 8\nnp_grp.9.versch = 9\ng28 = 28\ng30 = -30\n\nvb_max_red = 83_333\n\
        default_feed_axis = 1\nkenngr.achs_mode = 0x1000_0001\nnp_grp.1.versch = 100_000\nnp_grp.2.versch = -2\n\
        np_grp.3.versch = 3\nnp_grp.4.versch = 4\nnp_grp.5.versch = 5\nnp_grp.6.versch = -1_000_000_000\n[axis.X.dynamik]\na_max = 4000\n\
        r_trans_weight = 30\ntr_w_min = 20_000\n[axis.X.lslope_profil]\na_grenz_stufe_1 = 1\na_grenz_stufe_2 = 2\n\
        a_stufe_1 = 3\na_stufe_2 = 4\nd_grenz_stufe_1 = 5\nd_grenz_stufe_2 = 6\nd_stufe_1 = 7\nd_stufe_2 = 8\n\
        vb_stufe_1_2 = 9\nvb_grenz_stufe_1_2 = 10\n";
    std::fs::write(&dir, text).expect("a file for the test");
    let machine = load(&dir, &Overrides::default()).unwrap_or_else(|_| panic!("refused"));
    let _ = std::fs::remove_file(&dir);
    let name = AxisName::new("X").expect("a letter");
    let axis = AxisData {
        vb_max_red: 83_333,
        a_max: 4000,
        r_trans_weight: 30,
        tr_w_min: 20_000,
        a_grenz_stufe: [1, 2],
        a_stufe: [3, 4],
        d_grenz_stufe: [5, 6],
        d_stufe: [7, 8],
        vb_stufe_1_2: 9,
        vb_grenz_stufe_1_2: 10,
        achs_mode: MODE_LINEAR | MODE_MASTER,
        default_feed_axis: true,
        versch: [100_000, -2, 3, 4, 5, -1_000_000_000],
        foreign: ForeignAxis { versch: [7, 8, 9], stored: [28, -30] },
        ..AxisData::new(name, AxisKind::Linear)
    };
    let channel = ChannelData {
        cycle_us: 2000,
        look_ahead: 30,
        feedrate_factor_milli: 100,
        slope_profile: 1,
        acceleration_weight: 2,
        ramp_weight: 4,
        corr_v_trans_jerk: true,
        override_weight_prog_feed: 2,
        vector_acceleration_milli: 500_500,
        vector_deceleration_milli: 400_000,
        vector_velocity_milli: 1_500_000,
        vector_unit: AccelerationUnit::MmS2,
        cir_radial_acc_limit: true,
        check_jerk_on_poly_path: 2,
        merge_chords: 40,
        // In the order of the file, which TOML tables have not.
        m_synch: machine.channel.m_synch,
        h_synch: SynchTable::NONE.with(7, Synch::MnsSns),
        auto_contour_mode: 2,
        ptp: true,
        surface: false,
        joins_named: true,
        exact_stop_indp: 2,
        default_index: 6,
        interpolator: ChannelData::new().interpolator,
        foreign: ForeignChannel {
            // Chosen when the program is there.
            dialect: Dialect::Isg,
            blend_tolerance_um: 50,
            block_delete: true,
            optional_stop: true,
            tools: ToolLengths::NONE.with(5, -521_250),
        },
    };
    assert_eq!(machine.dialect, Choice::Grbl);
    let synch = [25, 26, 3, 4].map(|code| channel.m_synch.of(code));
    assert_eq!(synch, [Synch::MvsSns, Synch::MvsSvs, Synch::NoSynch, Synch::Mos]);
    assert_eq!((machine.axes, machine.channel), (vec![axis], channel));
    // Parameters that are left out have ISG's defaults.
    let default = ChannelData::new();
    let path = [default.vector_acceleration_milli, default.vector_deceleration_milli];
    assert_eq!((path, default.vector_velocity_milli), ([100_000_000_000; 2], 2_000_000_000_000));
    let stages = AxisData { a_max: 900, ..AxisData::new(name, AxisKind::Linear) }.stages(false);
    assert_eq!((stages.a, stages.d, stages.change_over), ([900; 2], [900; 2], 100_000));
    assert_eq!((axis.stages(true).d, axis.stages(true).change_over), ([5, 6], 10));
}

#[test]
fn the_command_line_has_the_last_word() {
    let path = std::env::temp_dir().join(format!("glidepath-overrides-{}", std::process::id()));
    // A look-ahead beyond this simulator's memory.
    std::fs::write(&path, "[channel]\nlook_ahead = 9000\n[axis.X]\n").expect("a file for the test");
    let both = Overrides { slope: Some(3), look_ahead: Some(60) };
    let machine = load(&path, &both).unwrap_or_else(|_| panic!("refused"));
    assert_eq!((machine.channel.slope_profile, machine.channel.look_ahead), (3, 60));
    let machine = load(&path, &Overrides { slope: None, ..both }).unwrap_or_else(|_| panic!("refused"));
    assert_eq!((machine.channel.slope_profile, machine.channel.look_ahead), (0, 60));
    assert!(load(&path, &Overrides { look_ahead: None, ..both }).is_err());
    let _ = std::fs::remove_file(&path);
}

#[test]
fn decimals_are_exact() {
    assert!(matches!(exact_milli("0.1"), Ok(100)));
    assert!(matches!(exact_milli("-12.3450"), Ok(-12_345)));
    assert!(matches!(exact_milli("0.0001"), Err(Unfit::Decimals)));
    assert!(matches!(exact_milli("1e3"), Err(Unfit::Type)));
}
