//! Converts values to positions on the canvas, and chooses round numbers for an axis.

/// A linear scale.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    low: f64,
    per_unit: f64,
    origin: f64,
}

impl Scale {
    /// `low` at `from`, `high` at `to`.
    pub fn new(low: f64, high: f64, from: f64, to: f64) -> Self {
        let span = if high > low { high - low } else { 1.0 };
        Self { low, per_unit: (to - from) / span, origin: from }
    }

    /// The position of a value.
    pub fn at(&self, value: f64) -> f64 {
        self.origin + (value - self.low) * self.per_unit
    }
}

/// Round numbers from `low` to `high`, about `count` of them: multiples of 1, 2 or 5 times a power of ten.
pub fn ticks(low: f64, high: f64, count: usize) -> Vec<f64> {
    let step = step(high - low, count);
    let (first, last) = ((low / step).ceil() as i64, (high / step + 1e-9).floor() as i64);
    (first..=last).map(|i| i as f64 * step).collect()
}

/// The distance of round numbers, about `count` of them in `span`.
pub fn step(span: f64, count: usize) -> f64 {
    let rough = span.max(f64::MIN_POSITIVE * 1e6) / count.max(1) as f64;
    let decade = 10_f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * decade).find(|&s| s >= rough).unwrap_or(10.0 * decade)
}

/// A round number not below `value`, for the end of a scale.
pub fn round_up(value: f64) -> f64 {
    if value <= 0.0 {
        return 1.0;
    }
    let step = step(value, 6);
    (value / step - 1e-9).ceil() * step
}

/// A number as label of an axis: no unnecessary digits, thousands separated.
pub fn label(value: f64) -> String {
    let value = if value == 0.0 { 0.0 } else { value };
    let magnitude = value.abs();
    if magnitude >= 1000.0 {
        let digits = format!("{magnitude:.0}");
        let mut out = String::new();
        for (index, digit) in digits.chars().enumerate() {
            if index > 0 && (digits.len() - index).is_multiple_of(3) {
                out.push('\u{202f}');
            }
            out.push(digit);
        }
        return if value < 0.0 { format!("−{out}") } else { out };
    }
    let text = format!("{magnitude:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if value < 0.0 && text != "0" { format!("−{text}") } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_numbers_are_round() {
        assert_eq!(ticks(-3.0, 10.0, 5), [0.0, 5.0, 10.0]);
        assert_eq!(round_up(13_333.0), 15_000.0);
        assert_eq!(label(-13_333.3), "−13\u{202f}333");
        assert_eq!(label(0.25), "0.25");
        assert_eq!(label(-0.0), "0");
    }
}
