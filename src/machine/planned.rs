//! Replaces machine data that are too small or too large for the cycle time, and reports each replacement.
//!
//! | parameter | value used | why |
//! |---|---|---|
//! | ramp times: P-AXIS-00195 to P-AXIS-00201 | at least [`SHORTEST_RAMP`] cycles | set points cannot show a shorter ramp |
//! | P-AXIS-00199 = 0 | P-AXIS-00201 | the default of P-AXIS-00199 |
//! | speeds: P-AXIS-00209, 00212 | at most 16 mm per tick | range of [`crate::quantity::Speed`] |
//! | accelerations: P-AXIS-00001, 00002, 00004, 00008 | at most 16 mm/tick² | range of [`crate::quantity::Accel`] |
use super::parameter::AXIS;
use super::{AxisData, ChannelData};

/// Shortest ramp, in cycles.
pub const SHORTEST_RAMP: u32 = 1;

/// Speeds and accelerations per tick have six integer bits with sign. Half of this range is left for sums.
const LARGEST: u64 = 16;

/// A parameter for which the planner uses another value than the machine data give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Adjusted {
    /// ISG's id of the parameter, `P-AXIS-…`.
    pub id: &'static str,
    /// Name of the parameter.
    pub name: &'static str,
    /// Unit of both values.
    pub unit: &'static str,
    /// The value in the machine data.
    pub value: i64,
    /// The value that the planner uses.
    pub used: i64,
    /// The reason why the planner uses another value.
    pub because: &'static str,
}

impl AxisData {
    /// Returns the machine data that the planner uses: values that the tick cannot use are replaced.
    pub fn planned(&self, channel: &ChannelData) -> Self {
        let cycle = u64::from(channel.cycle_us);
        let by_cycle = |micro: u64| micro.checked_div(cycle).unwrap_or(u64::MAX);
        let at_most = |most: u64| u32::try_from(most).unwrap_or(u32::MAX);
        let v = at_most(by_cycle(LARGEST * 1_000_000_000));
        let a = at_most(by_cycle(by_cycle(LARGEST * 1_000_000_000_000)));
        let ramp = |us: u32| us.max(channel.cycle_us.saturating_mul(SHORTEST_RAMP));
        Self {
            vb_max: self.vb_max.min(v),
            vb_eilgang: self.vb_eilgang.min(v),
            a_max: self.a_max.min(a),
            a_beschl: self.a_beschl.min(a),
            a_brems: self.a_brems.min(a),
            a_grenz: self.a_grenz.min(a),
            tr_geom: ramp(self.geometric_ramp()),
            tr_min: ramp(self.tr_min),
            tr_beschl_ab: ramp(self.tr_beschl_ab),
            tr_beschl_zu: ramp(self.tr_beschl_zu),
            tr_brems_ab: ramp(self.tr_brems_ab),
            tr_brems_zu: ramp(self.tr_brems_zu),
            tr_grenz: ramp(self.tr_grenz),
            ..*self
        }
    }

    /// All values that the planner replaces, for warnings to the author of the machine data.
    pub fn adjusted(&self, channel: &ChannelData) -> impl Iterator<Item = Adjusted> {
        let given = Self { tr_geom: self.geometric_ramp(), ..*self };
        let planned = self.planned(channel);
        AXIS.iter().filter_map(move |parameter| {
            let [value, used] = [&given, &planned].map(|axis| (parameter.get)(axis) / 1000);
            let because = match parameter.unit {
                "µs" => "cycle_us: a ramp takes at least a cycle",
                "µm/s" => "cycle_us: at most 16 mm per tick",
                _ => "cycle_us: at most 16 mm/tick²",
            };
            let (id, name, unit) = (parameter.id, parameter.name, parameter.unit);
            (value != used).then_some(Adjusted { id, name, unit, value, used, because })
        })
    }
}
