//! Settings and offsets from a machine file.
use super::AXES;
use glidepath::machine::{MachineData, NO_LIMIT};
use glidepath::nc::{Setup, StoredOffsets};
use glidepath::quantity::Position;
use glidepath_controller::{AxisSettings, Settings};

/// Travel if the machine file has no software limits, 0.001 mm.
const TRAVEL: u32 = 200_000;

/// Counts per mm, in thousandths; the machine data of steps are not used here.
const COUNTS: u32 = 80_000;

/// The settings that `$$` shows, from the machine data.
pub fn of_machine(machine: &MachineData<AXES>) -> Settings<AXES> {
    let mut settings = Settings::new();
    settings.soft_limits =
        machine.axes.iter().any(|axis| axis.swe_neg > -NO_LIMIT || axis.swe_pos < NO_LIMIT);
    settings.axes = machine.axes.map(|axis| AxisSettings {
        counts_milli: COUNTS,
        rate_milli: axis.vb_max.saturating_mul(60),
        accel_milli: axis.a_beschl.saturating_mul(1000),
        travel_milli: if axis.swe_neg > -NO_LIMIT && axis.swe_pos < NO_LIMIT {
            // 0.1 µm
            u32::try_from((i64::from(axis.swe_pos) - i64::from(axis.swe_neg)) / 10).unwrap_or(TRAVEL)
        } else {
            TRAVEL
        },
    });
    settings
}

/// Zero offsets and stored positions of the file.
pub fn stored(machine: &MachineData<AXES>) -> StoredOffsets<AXES> {
    let setup = Setup::new(machine, [Position::ZERO; AXES]);
    let mut stored = StoredOffsets::ZERO;
    let sets = setup.zero_offsets.iter().chain(&setup.foreign.offsets);
    for (to, from) in stored.zero.iter_mut().zip(sets) {
        *to = *from;
    }
    stored.places = setup.foreign.stored;
    stored
}
