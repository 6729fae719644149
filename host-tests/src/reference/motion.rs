//! Set points of a plan: the contour, evaluated with the speed profiles of its blocks.
use super::geometry::Contour;
use super::limits::path_length;
use super::profile::Profile;

/// A plan as a motion: the position of every axis at any time.
#[derive(Clone, Debug)]
pub struct Motion<'a> {
    contour: &'a Contour,
    profiles: &'a [Profile],
    /// Start of each block, in the unit of time of the profiles, and the end.
    starts: Vec<f64>,
    /// First element of each block.
    elements: Vec<usize>,
}

impl<'a> Motion<'a> {
    /// Joins the speed profiles. Each profile belongs to the elements of its length. If the speed is zero
    /// between two blocks, the second block waits for the next multiple of `grid` (zero: no waiting).
    pub fn new(contour: &'a Contour, profiles: &'a [Profile], grid: f64) -> Self {
        let mut starts = vec![0.0];
        let mut at = 0.0;
        let mut next = 0;
        let mut elements = Vec::new();
        for profile in profiles {
            elements.push(next);
            let mut left = profile.length;
            while left > profile.length * 1e-9
                && let Some(element) = contour.elements.get(next)
            {
                left -= path_length(element);
                next += 1;
            }
            at += profile.time();
            if profile.v_out == 0.0 && grid > 0.0 {
                // A time that is a multiple except for rounding counts as a multiple.
                at = (at / grid - 1e-9).ceil() * grid;
            }
            starts.push(at);
        }
        Self { contour, profiles, starts, elements }
    }

    /// Duration.
    pub fn time(&self) -> f64 {
        self.starts.last().copied().unwrap_or(0.0)
    }

    /// Position of every axis at `t`; `None` after the end.
    pub fn at(&self, t: f64) -> Option<Vec<f64>> {
        let block = self.starts.partition_point(|&start| start <= t).checked_sub(1)?;
        let profile = self.profiles.get(block)?;
        let mut s = profile.at((t - self.starts[block]).min(profile.time())).s;
        let last = self.elements.get(block + 1).copied().unwrap_or(self.contour.elements.len());
        let elements = self.contour.elements.get(self.elements[block]..last)?;
        for (k, element) in elements.iter().enumerate() {
            let length = path_length(element);
            if s <= length || k + 1 == elements.len() {
                return Some(element.at((s / length).min(1.0)));
            }
            s -= length;
        }
        None
    }
}
