//! Checks the machine data before a channel starts: ranges, contradictions, and functions that the build
//! leaves out.
use super::MachineError;
#[cfg(feature = "grbl")]
use crate::machine::Dialect;
use crate::machine::parameter::{CHANNEL, RangeError, check_all, check_axis};
use crate::machine::{AxisKind, MachineData, functions};
use crate::path::measure::FEED_AXES;

/// P-CHAN-00071: STEP, SIN2, HSC.
const SLOPE_STEP: u8 = 0;
const SLOPE_SIN2: u8 = 2;
const SLOPE_HSC: u8 = 3;

/// Checks that every parameter is in its range, and that no two parameters contradict each other.
pub(super) fn check<const AXES: usize, const BLOCKS: usize>(
    machine: &MachineData<AXES>,
) -> Result<(), MachineError> {
    let channel = &machine.channel;
    check_all(channel, CHANNEL).map_err(MachineError::Channel)?;
    if channel.look_ahead as usize > BLOCKS {
        return Err(MachineError::Channel(RangeError {
            id: "P-STUP-00071",
            name: "look_ahead",
            value: channel.look_ahead.into(),
            min: 10,
            max: BLOCKS as i64,
            because: "the memory compiled in",
        }));
    }
    #[cfg(feature = "plc")]
    check_all(channel, crate::machine::parameter::CHANNEL_PLC).map_err(MachineError::Channel)?;
    #[cfg(feature = "plc")]
    if let Some((said, expected)) = channel.interpolator.functions.refused() {
        return Err(MachineError::Interpolator(said, expected));
    }
    #[cfg(feature = "grbl")]
    match channel.foreign.dialect {
        Dialect::Isg => functions::ISG.check().map_err(MachineError::NotBuilt)?,
        Dialect::LinuxCnc => functions::DIALECTS.check().map_err(MachineError::NotBuilt)?,
        _ => {}
    }
    if matches!(channel.slope_profile, SLOPE_STEP | SLOPE_SIN2) {
        functions::SLOPES.check().map_err(MachineError::NotBuilt)?;
    }
    if channel.slope_profile == SLOPE_HSC {
        functions::HSC.check().map_err(MachineError::NotBuilt)?;
    }
    for (name, table) in [("m_synch", &channel.m_synch), ("h_synch", &channel.h_synch)] {
        if table.overflows() {
            return Err(MachineError::TooManySynch(name));
        }
        if let Some((code, synch)) = table.entries().find(|entry| !entry.1.is_available()) {
            return Err(MachineError::Synch(name, code, synch));
        }
        #[cfg(feature = "plc")]
        check_shifts(name, table, channel)?;
    }
    for (k, axis) in machine.axes.iter().enumerate() {
        if axis.kind != AxisKind::Spindle {
            if axis.name.is_reserved() {
                return Err(MachineError::Reserved(axis.name));
            }
            check_axis(axis).map_err(|e| MachineError::Axis(k, e))?;
        }
        if axis.default_feed_axis && (axis.kind == AxisKind::Spindle || k >= FEED_AXES) {
            let (id, name, because) =
                ("P-CHAN-00011", "default_feed_axis", "the axes of a path: 32, no spindle");
            return Err(MachineError::Axis(k, RangeError { id, name, value: 1, min: 0, max: 0, because }));
        }
        if machine.axes.iter().skip(k + 1).any(|other| other.name == axis.name) {
            return Err(MachineError::Name(axis.name));
        }
    }
    Ok(())
}

/// A shift needs FCT_SHIFT_NCBL and a kind of synchronisation that is shifted.
#[cfg(feature = "plc")]
fn check_shifts(
    name: &'static str,
    table: &crate::machine::SynchTable,
    channel: &crate::machine::ChannelData,
) -> Result<(), MachineError> {
    use crate::machine::{InterpolatorFunctions, SHIFT_MAX};
    let may = channel.interpolator.has(InterpolatorFunctions::SHIFT_NCBL);
    for (code, synch) in table.entries() {
        let shift = table.shift(code);
        let expected = match () {
            () if synch.is_shifted() && !may => {
                "FCT_SHIFT_NCBL in configuration.interpolator.function (P-CHAN-00650)"
            }
            () if shift > SHIFT_MAX => "a shift of 0…2000000000, in 0.1 µm",
            () if shift != 0 && !synch.is_shifted() => {
                "MEP_SVS or MEP_MOS beside a shift (P-CHAN-00070, P-CHAN-00107)"
            }
            () => continue,
        };
        return Err(MachineError::Shift(name, code, synch, expected));
    }
    Ok(())
}
