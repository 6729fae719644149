//! Driven distance and speed: path values of a tick, computed from the set points.
//!
//! On a curve over time the path distance counts time, and the driven speed is below the planned path speed.
//! On such curves the distance is the chord between the set points, and the speed follows from the set
//! points. On lines and arcs the planned values already are the driven values.
use crate::machine::Machine;
use glidepath::quantity::{Accel, Distance, Position, Speed};
use glidepath::tick::Telemetry;

/// Converts the planned path values of every tick into driven values.
pub struct Driven {
    /// The axes that measure the path: the first of these sets in which an axis moves.
    measures: [Vec<usize>; 3],
    /// The path is at least this part of the travel of any axis: 1/n, for the first set and for the other
    /// sets.
    steepest: [u128; 2],
    /// Values of the previous tick: planned, and driven.
    raw: Telemetry,
    told: Telemetry,
    points: Vec<Position>,
    /// The previous tick was on a polynomial.
    on_polynomial: bool,
    /// The driven speed differed from the planned speed by more than a thousandth.
    pub differs: bool,
}

/// Fraction bits of a slope.
const SLOPE: u32 = 40;

impl Driven {
    /// Start values of a machine at `start`.
    pub fn new(machine: &Machine, start: &[Position]) -> Self {
        let (feed, main) = (machine.feed_axes(), machine.main_axes());
        let steepest = [if feed == main { 1024 } else { 64 }, 1024];
        Self {
            measures: [feed, main, (0..machine.axes.len()).collect()],
            steepest,
            raw: Telemetry::default(),
            told: Telemetry::default(),
            points: start.to_vec(),
            on_polynomial: false,
            differs: false,
        }
    }

    /// Returns the driven values of a tick. `slope`: travel of every axis per path distance on a polynomial,
    /// LSB 2^-40.
    pub fn tick(&mut self, raw: &Telemetry, points: &[Position], slope: Option<&[i64]>) -> Telemetry {
        let mut told = *raw;
        let mut step = raw.distance.to_bits().wrapping_sub(self.raw.distance.to_bits());
        if (slope.is_some() || self.on_polynomial) && step != 0 {
            let travel: Vec<i64> =
                points.iter().zip(&self.points).map(|(to, from)| to.to_bits() - from.to_bits()).collect();
            // From 2^-32 mm to 2^-44 mm. A step too small for a set point still is motion.
            let chord = self.length(&travel, 44 - 32).max(1);
            step = i64::try_from(chord).unwrap_or(i64::MAX) * step.signum();
        }
        told.distance = Distance::from_bits(self.told.distance.to_bits().wrapping_add(step));
        if let Some(slope) = slope {
            let along = self.length(slope, 0) as i128;
            let speed = (i128::from(raw.speed.to_bits()) * along) >> SLOPE;
            told.speed = Speed::from_bits(i64::try_from(speed).unwrap_or(i64::MAX));
            let off = (along - (1 << SLOPE)).abs();
            self.differs |= raw.speed != Speed::ZERO && off > 1 << (SLOPE - 10);
        }
        if slope.is_some() && (raw.speed, raw.accel) != (Speed::ZERO, Accel::ZERO) {
            // Per tick, as both are.
            told.accel = Accel::from_bits(told.speed.to_bits() - self.told.speed.to_bits());
        }
        (self.raw, self.told, self.on_polynomial) = (*raw, told, slope.is_some());
        self.points.copy_from_slice(points);
        told
    }

    /// Length of a vector along the axes that measure the path, with `bits` more fraction bits, rounded down.
    fn length(&self, travel: &[i64], bits: u32) -> u128 {
        let square = |axes: &Vec<usize>| {
            axes.iter().map(|&axis| u128::from(travel[axis].unsigned_abs()).pow(2)).sum::<u128>()
        };
        let squares = self.measures.each_ref().map(square);
        let first = squares.iter().find(|square| **square > 0).copied().unwrap_or(0);
        let steepest = self.steepest[usize::from(squares[0] == 0)];
        // If there is room, the bits are added before the root.
        let inside = (first.leading_zeros() / 2).min(bits);
        let path = (first << (2 * inside)).isqrt() << (bits - inside);
        travel
            .iter()
            .fold(path, |path, travel| path.max((u128::from(travel.unsigned_abs()) << bits) / steepest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(mm: i64, speed: i64) -> Telemetry {
        let (distance, speed) = (Distance::from_bits(mm << 44), Speed::from_bits(speed));
        Telemetry { distance, speed, ..Telemetry::default() }
    }

    #[test]
    fn polynomials_count_by_their_chords_and_slopes() {
        let machine = Machine::built_in();
        let mut driven = Driven::new(&machine, &[Position::ZERO; 3]);
        let point = |x: i32, y: i32| [x, y, 0].map(Position::from_num);
        let line = driven.tick(&row(7, 70), &point(5, 0), None);
        assert_eq!((line.distance, line.speed), (Distance::from_bits(7 << 44), Speed::from_bits(70)));
        assert!(!driven.differs);
        let half = 1 << 39;
        let curve = driven.tick(&row(17, 100), &point(8, 4), Some(&[half, 0, 0]));
        assert_eq!((curve.distance, curve.speed), (Distance::from_bits(12 << 44), Speed::from_bits(50)));
        assert_eq!(curve.accel, Accel::from_bits(-20));
        assert!(driven.differs);
        // The step that leaves the curve is a chord too; without path no axis moves.
        let off = driven.tick(&row(27, 100), &point(8, 6), None);
        assert_eq!((off.distance, off.speed), (Distance::from_bits(14 << 44), Speed::from_bits(100)));
        let rest = driven.tick(&row(27, 0), &point(8, 6), None);
        assert_eq!(rest.distance, off.distance);
    }
}
