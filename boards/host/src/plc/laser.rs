//! A PLC that sets the power of a laser from the path ahead: less power near a sharp corner and on a small
//! radius. `docs/plc.md` has the same rule.
use glidepath::contour_log::{ContourReader, ProgramDistance};

/// The rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laser {
    /// Length of path before and after a sharp corner with less power, mm.
    pub near_mm: f64,
    /// A corner is sharp from this angle on, rad.
    pub knee: f64,
    /// Arcs below this radius have less power, mm.
    pub radius_mm: f64,
    /// Less power, percent.
    pub low: u8,
}

impl Laser {
    /// The power at a distance from program start, percent.
    pub fn power(&self, contour: &ContourReader<'_>, at: ProgramDistance) -> u8 {
        let [from, to] = [-self.near_mm, self.near_mm].map(|mm| {
            ProgramDistance::from_bits(at.to_bits().saturating_add(ProgramDistance::from_mm(mm).to_bits()))
        });
        let is_low = contour.elements(from, to).flatten().any(|element| {
            let sharp = element.knee >= self.knee && from <= element.start;
            let here = element.start <= at && at < element.end();
            sharp || (here && element.radius_mm > 0.0 && element.radius_mm < self.radius_mm)
        });
        if is_low { self.low } else { 100 }
    }
}
