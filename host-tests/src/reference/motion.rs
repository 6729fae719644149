//! Set points of a plan: the contour evaluated over the time laws of its blocks.
use super::geometry::Contour;
use super::profile::Profile;

/// A plan as a motion: where is every axis at any time.
#[derive(Clone, Debug)]
pub struct Motion<'a> {
    contour: &'a Contour,
    profiles: &'a [Profile],
    /// Start of each block, in the unit of time of the profiles, and the end.
    starts: Vec<f64>,
}

impl<'a> Motion<'a> {
    /// Lays the blocks end to end. Where the speed is zero between two blocks, the second waits for the next multiple of
    /// `grid` (zero: does not wait).
    pub fn new(contour: &'a Contour, profiles: &'a [Profile], grid: f64) -> Self {
        let mut starts = vec![0.0];
        let mut at = 0.0;
        for profile in profiles {
            at += profile.time();
            if profile.v_out == 0.0 && grid > 0.0 {
                // A time that is a multiple but for rounding is one.
                at = (at / grid - 1e-9).ceil() * grid;
            }
            starts.push(at);
        }
        Self { contour, profiles, starts }
    }

    /// Duration.
    pub fn time(&self) -> f64 {
        self.starts.last().copied().unwrap_or(0.0)
    }

    /// Position of every axis at `t`; `None` after the end.
    pub fn at(&self, t: f64) -> Option<Vec<f64>> {
        let block = self.starts.partition_point(|&start| start <= t).checked_sub(1)?;
        let (profile, element) = (self.profiles.get(block)?, self.contour.elements.get(block)?);
        let state = profile.at((t - self.starts[block]).min(profile.time()));
        Some(element.at(state.s / profile.length))
    }
}
