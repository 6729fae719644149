//! Symmetric band systems: `L D L'` without pivoting.
//!
//! Stable for quasi-definite matrices (Vanderbei, Symmetric quasidefinite matrices, SIAM J. Optim. 5, 1995),
//! whose factors also show how many eigenvalues are negative (Sylvester): as many as pivots.

/// Entries of a row left of the diagonal.
pub const BAND: usize = 8;

/// Lower half of a symmetric band matrix; element `(i, i - k)` is in place `BAND - k` of row `i`.
#[derive(Clone, Debug)]
pub struct Banded {
    rows: Vec<[f64; BAND + 1]>,
}

impl Banded {
    /// All zero.
    pub fn new(size: usize) -> Self {
        Self { rows: vec![[0.0; BAND + 1]; size] }
    }

    /// Adds to the element in a row and a column, and to its mirror image.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let (row, column) = (row.max(column), row.min(column));
        self.rows[row][BAND + column - row] += value;
    }

    /// Product with a vector.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for (i, row) in self.rows.iter().enumerate() {
            y[i] += row[BAND] * x[i];
            for k in 1..=BAND.min(i) {
                y[i] += row[BAND - k] * x[i - k];
                y[i - k] += row[BAND - k] * x[i];
            }
        }
        y
    }

    /// Factors, and the number of negative pivots; `None` for a pivot that is zero or not finite.
    pub fn factor(&self) -> Option<(Factors, usize)> {
        let mut rows = self.rows.clone();
        let mut negative = 0;
        for i in 0..rows.len() {
            let mut row = rows[i];
            let first = i.saturating_sub(BAND);
            // row holds l d until its turn comes, column by column.
            let mut pivot = row[BAND];
            for j in first..i {
                let other = &rows[j];
                let mut value = row[BAND + j - i];
                for k in first.max(j.saturating_sub(BAND))..j {
                    value -= row[BAND + k - i] * other[BAND + k - j];
                }
                row[BAND + j - i] = value;
            }
            for j in first..i {
                let l = row[BAND + j - i] / rows[j][BAND];
                pivot -= l * row[BAND + j - i];
                row[BAND + j - i] = l;
            }
            if !(pivot.is_finite() && pivot != 0.0) {
                return None;
            }
            negative += usize::from(pivot < 0.0);
            row[BAND] = pivot;
            rows[i] = row;
        }
        Some((Factors { rows }, negative))
    }
}

/// `L` below the diagonal, `D` on it.
#[derive(Clone, Debug)]
pub struct Factors {
    rows: Vec<[f64; BAND + 1]>,
}

impl Factors {
    /// Solves in place.
    pub fn solve(&self, x: &mut [f64]) {
        for i in 0..x.len() {
            let row = &self.rows[i];
            let mut sum = x[i];
            for k in 1..=BAND.min(i) {
                sum -= row[BAND - k] * x[i - k];
            }
            x[i] = sum;
        }
        for (x, row) in x.iter_mut().zip(&self.rows) {
            *x /= row[BAND];
        }
        for i in (0..x.len()).rev() {
            let row = &self.rows[i];
            let known = x[i];
            for k in 1..=BAND.min(i) {
                x[i - k] -= row[BAND - k] * known;
            }
        }
    }
}
