//! Parameters that the ISG kernel has and this version does not use yet: refused by name, not as unknown.

/// Axis parameters: ISG id and dotted name inside `[axis.X]`.
pub const AXIS: &[(&str, &str)] = &[];

/// Channel parameters: ISG id and dotted name inside `[channel]`.
pub const CHANNEL: &[(&str, &str)] = &[
    ("P-CHAN-00141", "jerk_monitoring_mode"),
    ("P-CHAN-00217", "hsc.gen.on_delay_output_one_block"),
    ("P-CHAN-00361", "vector.radial_acceleration"),
];
