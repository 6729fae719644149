//! Channel parameters that the command line sets.
use super::value::{Allowed, label};
use super::{LOOK_AHEAD, SLOPE};
use crate::diagnose::Diagnostic;
use glidepath::machine::ChannelData;
use glidepath::machine::parameter::CHANNEL;

/// Channel parameters that the command line sets in place of the machine data.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// P-CHAN-00071.
    pub slope: Option<u8>,
    /// P-STUP-00071.
    pub look_ahead: Option<u32>,
}

impl Overrides {
    pub(super) fn value(&self, name: &str) -> Option<i64> {
        match name {
            LOOK_AHEAD => self.look_ahead.map(i64::from),
            SLOPE => self.slope.map(i64::from),
            _ => None,
        }
    }

    /// Sets them.
    ///
    /// # Errors
    /// Out of range, as in a machine file.
    pub fn apply(&self, channel: &mut ChannelData) -> Result<(), Vec<Diagnostic>> {
        let mut refused = Vec::new();
        for parameter in CHANNEL {
            let Some(value) = self.value(parameter.name) else { continue };
            let allowed = Allowed::here(parameter);
            if allowed.takes(i128::from(value) * 1000) {
                (parameter.set)(channel, value * 1000);
            } else {
                let option = if parameter.name == SLOPE { "--slope" } else { "--look-ahead" };
                let label = label("channel", parameter.id, parameter.name);
                let message = format!("{option}: {label} = {value}: out of range");
                refused.push(Diagnostic::error(message).expected(allowed.words));
            }
        }
        if refused.is_empty() { Ok(()) } else { Err(refused) }
    }
}
