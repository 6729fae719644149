//! Times of a minute and more in hours, minutes and seconds, in addition to seconds.

/// ` (h:mm:ss)`, to the nearest second; nothing below a minute.
pub fn clock(seconds: f64) -> String {
    if seconds < 60.0 || !seconds.is_finite() {
        return String::new();
    }
    let all = seconds.round() as u64;
    format!(" ({}:{:02}:{:02})", all / 3600, all / 60 % 60, all % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_counts_minutes_and_hours() {
        let shown = [0.0, 59.9999, 60.0, 119.6, 3599.4, 3599.5, 45_296.0, f64::INFINITY].map(clock);
        let expected = ["", "", " (0:01:00)", " (0:02:00)", " (0:59:59)", " (1:00:00)", " (12:34:56)", ""];
        assert_eq!(shown, expected);
    }
}
