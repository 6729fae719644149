//! The limits that are raised, one by one: each change affects one physical quantity.
use crate::machine::Machine;
use crate::run::BLOCKS;
use glidepath::machine::AxisData;
use glidepath::nc::SlopeType;

/// A limit of the machine data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Limit {
    /// Speed of the axes.
    Speed,
    /// Acceleration of the slope, jerk as it was.
    Acceleration,
    /// Acceleration of slope and contour together.
    Total,
    /// Jerk of the slope.
    Ramp,
    /// Jerk of the contour.
    Geometric,
    /// Limits along the path.
    Path,
    /// Length of the look-ahead.
    LookAhead,
    /// Steps of speed at corners: permitted or not.
    Knee,
    /// Steps of acceleration at tangential transitions: permitted or not.
    Tangential,
    /// Another slope.
    Hsc,
    /// Merging of chords to one line: with a part of the tolerance, or off.
    Chords,
}

/// Limits that are raised by a quarter, so that their effects are comparable.
pub const COMPARED: [Limit; 7] = [
    Limit::Geometric,
    Limit::Ramp,
    Limit::Acceleration,
    Limit::Total,
    Limit::Speed,
    Limit::Path,
    Limit::LookAhead,
];

/// Options that are switched. They are reported, but are never the reason.
pub const SWITCHED: [Limit; 4] = [Limit::Knee, Limit::Tangential, Limit::Hsc, Limit::Chords];

/// Percent of the tolerance for lines that replace several chords.
const MERGED: u8 = 50;

/// A machine with one limit changed: of all axes, or of one axis.
pub struct Loosened {
    pub machine: Machine,
    pub limit: Limit,
    pub axis: Option<usize>,
}

const fn more(value: u32) -> u32 {
    value.saturating_add(value / 4)
}

/// Shortens a time, so that the quotient grows by a quarter.
const fn shorter(time: u32) -> u32 {
    time - time / 5
}

fn ramps(axis: &mut AxisData) -> [&mut u32; 5] {
    [
        &mut axis.tr_beschl_zu,
        &mut axis.tr_beschl_ab,
        &mut axis.tr_brems_zu,
        &mut axis.tr_brems_ab,
        &mut axis.tr_grenz,
    ]
}

impl Limit {
    /// Changes the limit of an axis.
    fn axis(self, axis: &mut AxisData) {
        match self {
            Self::Speed => {
                axis.vb_max = more(axis.vb_max);
                axis.vb_eilgang = more(axis.vb_eilgang);
            }
            Self::Acceleration => {
                let stages = axis.a_stufe.iter_mut().chain(&mut axis.d_stufe);
                let rapid = axis.a_grenz_stufe.iter_mut().chain(&mut axis.d_grenz_stufe);
                let slope = [&mut axis.a_beschl, &mut axis.a_brems, &mut axis.a_grenz];
                stages.chain(rapid).chain(slope).for_each(|value| *value = more(*value));
                // Jerk is acceleration over time.
                ramps(axis).into_iter().for_each(|time| *time = more(*time));
                axis.tr_geom = more(axis.geometric_ramp());
            }
            Self::Total => axis.a_max = more(axis.a_max),
            Self::Ramp => ramps(axis).into_iter().for_each(|time| *time = shorter(*time)),
            Self::Geometric => axis.tr_geom = shorter(axis.geometric_ramp()),
            Self::Knee => axis.a_trans_weight = 1000,
            Self::Path | Self::LookAhead | Self::Tangential | Self::Hsc | Self::Chords => {}
        }
    }

    /// The machine with the limit changed, of one `axis` or of all; none if the limit does not exist.
    pub fn loosen(self, machine: &Machine, axis: Option<usize>) -> Option<Loosened> {
        let mut axes = machine.axes.clone();
        for (k, data) in axes.iter_mut().enumerate() {
            if axis.is_none_or(|axis| axis == k) {
                self.axis(data);
            }
        }
        let mut channel = machine.channel;
        match self {
            Self::Path => {
                for value in [
                    &mut channel.vector_acceleration_milli,
                    &mut channel.vector_deceleration_milli,
                    &mut channel.vector_velocity_milli,
                ] {
                    *value = value.saturating_add(*value / 4);
                }
            }
            Self::LookAhead => channel.look_ahead = (channel.look_ahead * 2).min(BLOCKS as u32),
            Self::Tangential => channel.corr_v_trans_jerk = false,
            Self::Hsc => channel.slope_profile = SlopeType::Hsc as u8,
            Self::Chords if channel.merge_chords == 0 => channel.merge_chords = MERGED,
            _ => {}
        }
        let same = axes == machine.axes && channel == machine.channel;
        let machine = Machine { axes, channel, ..machine.smoothed(machine.smooth) };
        (!same).then_some(Loosened { machine, limit: self, axis })
    }

    /// Name of the limit with its ISG parameters.
    pub fn name(self) -> &'static str {
        match self {
            Self::Speed => "axis speed (P-AXIS-00212, rapid 00209)",
            Self::Acceleration => "acceleration (P-AXIS-00001, 00002, rapid 00004)",
            Self::Total => "acceleration in all (P-AXIS-00008)",
            Self::Ramp => "ramp time (P-AXIS-00195…00198, rapid 00200)",
            Self::Geometric => "geometric ramp time (P-AXIS-00199)",
            Self::Path => "limit along the path (P-CHAN-00002, 00208, 00090)",
            Self::LookAhead => "look-ahead (P-STUP-00071)",
            Self::Knee => "step of speed at knees (P-AXIS-00013)",
            Self::Tangential => "step of acceleration at tangential transitions (P-CHAN-00009)",
            Self::Hsc => "slope (P-CHAN-00071)",
            Self::Chords => "one line of nearly straight chords (merge_chords)",
        }
    }

    /// Description of the change.
    pub fn change(self) -> &'static str {
        match self {
            Self::Ramp | Self::Geometric => "20 % shorter",
            Self::LookAhead => "twice as long",
            Self::Knee => "set to 100 %",
            Self::Tangential => "permitted",
            Self::Hsc => "HSC",
            Self::Chords => "50 %",
            Self::Speed | Self::Acceleration | Self::Total | Self::Path => "25 % higher",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::limits;

    /// Speed; acceleration of the slope, and of slope and contour together; the same for jerk.
    fn quantities(machine: &Machine) -> [f64; 5] {
        let axis = limits(&machine.axes[1], machine.slope());
        [axis.speed, axis.accel_feed, axis.accel, axis.ramp_feed, axis.jerk]
    }

    #[test]
    fn each_limit_changes_one_quantity() {
        let machine = Machine::built_in();
        let before = quantities(&machine);
        let factors = |limit: Limit| {
            let loosened = limit.loosen(&machine, Some(1)).expect("there is something to loosen");
            assert_eq!(loosened.machine.axes[0], machine.axes[0]);
            let after = quantities(&loosened.machine);
            std::array::from_fn::<f64, 5, _>(|i| (after[i] / before[i] * 1e4).round() / 1e4)
        };
        assert_eq!(factors(Limit::Speed), [1.25, 1.0, 1.0, 1.0, 1.0]);
        assert_eq!(factors(Limit::Acceleration), [1.0, 1.25, 1.0, 1.0, 1.0]);
        assert_eq!(factors(Limit::Total), [1.0, 1.0, 1.25, 1.0, 1.0]);
        assert_eq!(factors(Limit::Ramp), [1.0, 1.0, 1.0, 1.25, 1.0]);
        assert_eq!(factors(Limit::Geometric), [1.0, 1.0, 1.0, 1.0, 1.25]);
        let mut deep = Machine::built_in();
        deep.channel.look_ahead = BLOCKS as u32;
        assert!(Limit::LookAhead.loosen(&deep, None).is_none());
        assert!(Limit::LookAhead.loosen(&machine, None).is_some());
    }
}
