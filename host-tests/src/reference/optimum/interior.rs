//! The optimisation: least time over a grid of path cells, interior point method.
//!
//! Unknown are the duration `h` of every cell and speed `v` and acceleration `a` at every node between cells.
//! Jerk is constant in a cell, which makes a cell exact:
//!
//! ```text
//! v1 - v0 = h (a0 + a1) / 2                       (1)
//! length  = h (v0 + v1) / 2 - h² (a1 - a0) / 12   (2)   cubic, by Euler and Maclaurin
//! 0 < v < cap,   -d < a < 1,   |a1 - a0| < h            all linear
//! ```
//!
//! in units where the largest acceleration and the jerk are 1. Each solution is thus a motion that can be
//! travelled, whatever the grid; a finer grid only allows more of them.
//!
//! Inside a cell the parabola of speed stays below the middle point of its Bernstein form, v0 + h a0 / 2, and
//! below its ends, so `v0 + h' a0 / 2 < cap` with a duration h' >= h known beforehand keeps the limit there
//! too. It costs nothing where the node sits at the peak of speed, which refinement sees to. (Without it the
//! motion swings over the limit between nodes: 1 % too fast on long plateaus.) Should h' turn out too short,
//! the final check of the motion sees it.
//!
//! Method: primal-dual Newton steps with logarithmic barriers on the inequalities, which hold strictly all
//! the time; curvature is added until the reduced Hessian is positive; backtracking with a filter (Wächter,
//! Biegler, On the implementation of an interior-point filter line-search algorithm, Math. Program. 106,
//! 2006).
use super::banded::Banded;

/// Cells of the path, in units of the limits.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    /// Length of each cell.
    pub length: Vec<f64>,
    /// Highest speed in each cell.
    pub cap: Vec<f64>,
    /// Duration expected of each cell, from [`Grid::expect`].
    pub span: Vec<f64>,
    /// Largest deceleration.
    pub brake: f64,
}

impl Grid {
    /// Takes the durations of a motion as the expected ones and slows it down by `factor`, and further if
    /// that is needed to keep it inside the speed limits.
    pub fn expect(&mut self, x: &mut Point, factor: f64) {
        self.span.clone_from(&x.h);
        x.slower(factor);
        let highest = (1..x.h.len())
            .map(|k| {
                (x.v[k] / self.cap[k - 1]).max((x.v[k] + 0.5 * self.span[k] * x.a[k].max(0.0)) / self.cap[k])
            })
            .fold(0.0, f64::max);
        x.slower((highest * factor).max(1.0));
    }
}

/// A motion over the grid.
#[derive(Clone, Debug, Default)]
pub struct Point {
    /// Duration of each cell.
    pub h: Vec<f64>,
    /// Speed at each node.
    pub v: Vec<f64>,
    /// Acceleration at each node.
    pub a: Vec<f64>,
}

impl Point {
    /// A motion without cells yet.
    pub fn at_rest() -> Self {
        Self { h: Vec::new(), v: vec![0.0], a: vec![0.0] }
    }

    /// Appends a cell, with speed and acceleration at its end.
    pub fn push(&mut self, h: f64, v: f64, a: f64) {
        self.h.push(h);
        self.v.push(v);
        self.a.push(a);
    }

    /// Removes what rounding left of speed and acceleration at the end.
    pub fn end_at_rest(&mut self) {
        for last in [self.v.last_mut(), self.a.last_mut()].into_iter().flatten() {
            *last = 0.0;
        }
    }

    /// Duration.
    pub fn time(&self) -> f64 {
        self.h.iter().sum()
    }

    /// The same motion, slower by a factor above one.
    pub fn slower(&mut self, factor: f64) {
        self.h.iter_mut().for_each(|h| *h *= factor);
        self.v.iter_mut().for_each(|v| *v /= factor);
        self.a.iter_mut().for_each(|a| *a /= factor * factor);
    }
}

/// Unknowns and multipliers of a stage: h, v and a at its end, multipliers of (1) and (2).
const STAGE: usize = 5;
/// Inequalities of a stage: jerk high and low; at its end node v low and high, a low and high; speed inside
/// the next cell.
const BOUNDS: usize = 7;
/// Weight of the equations added to the curvature; changes nothing but the size of pivots.
const AUGMENTED: f64 = 1e3;
/// Newton steps before giving up, halvings of one.
const STEPS: usize = 400;
const HALVINGS: i32 = 30;
/// Part of the way to the nearest bound that a step may go.
const TO_BOUND: f64 = 0.995;
/// Improvement that a filter asks for.
const FILTER: f64 = 1e-5;
/// Curvature added at first, its growth, and how often it may grow.
const CURVATURE: f64 = 1e-6;
const GROWTH: f64 = 8.0;
const GROWTHS: usize = 40;
/// Corrections of a solution of the linear system.
const CORRECTIONS: usize = 2;

/// Solver state.
pub struct Interior<'a> {
    grid: &'a Grid,
    /// The motion.
    pub x: Point,
    /// Scale of equation (2).
    weight: Vec<f64>,
    /// Multipliers of the equations.
    multiplier: Vec<[f64; 2]>,
    /// Multipliers of the inequalities.
    price: Vec<[f64; BOUNDS]>,
    /// Curvature added last.
    added: f64,
    /// Newton steps taken.
    pub steps: usize,
}

/// One Newton direction.
struct Direction {
    h: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    multiplier: Vec<[f64; 2]>,
}

/// Values that judge a step.
#[derive(Clone, Copy, Debug)]
struct Merit {
    /// Time and barriers.
    barrier: f64,
    /// Sum of what is left of the equations.
    rest: f64,
}

impl Merit {
    /// Better than another in one respect at least, beyond rounding.
    fn improves(&self, other: &Self) -> bool {
        let noise = 1e-12 * other.barrier.abs();
        self.rest < other.rest * (1.0 - FILTER) + 1e-13
            || self.barrier < other.barrier + noise - FILTER * other.rest
    }
}

impl<'a> Interior<'a> {
    /// Starts from a motion strictly inside all inequalities.
    pub fn new(grid: &'a Grid, x: Point) -> Self {
        let cells = grid.length.len();
        let weight = x.h.iter().map(|h| 1.0 / h).collect();
        Self {
            grid,
            x,
            weight,
            multiplier: vec![[0.0; 2]; cells],
            price: vec![[0.0; BOUNDS]; cells],
            added: 0.0,
            steps: 0,
        }
    }

    /// Number of inequalities.
    pub fn inequalities(&self) -> usize {
        BOUNDS * self.grid.length.len()
    }

    /// Distances from the bounds of stage `k`; the bounds of the last node, at rest, are taken as far away.
    fn slacks(&self, x: &Point, k: usize) -> [f64; BOUNDS] {
        let da = x.a[k + 1] - x.a[k];
        let (h, v, a) = (x.h[k], x.v[k + 1], x.a[k + 1]);
        if k + 1 == x.h.len() {
            return [h - da, h + da, 1.0, 1.0, 1.0, 1.0, 1.0];
        }
        let (cap, next) = (self.grid.cap[k], self.grid.cap[k + 1]);
        let inside = next - v - self.lead(k) * a;
        [h - da, h + da, v, cap.min(next) - v, self.grid.brake + a, 1.0 - a, inside]
    }

    /// Half the expected duration of the cell after stage `k`.
    fn lead(&self, k: usize) -> f64 {
        self.grid.span.get(k + 1).map_or(0.0, |span| 0.5 * span)
    }

    /// How the slacks change along a direction.
    fn slack_changes(&self, d: &Direction, k: usize) -> [f64; BOUNDS] {
        let da = d.a[k + 1] - d.a[k];
        let (v, a) = (d.v[k + 1], d.a[k + 1]);
        [d.h[k] - da, d.h[k] + da, v, -v, a, -a, -v - self.lead(k) * a]
    }

    /// Residuals of (1) and (2).
    fn residual(&self, x: &Point, k: usize) -> [f64; 2] {
        let (h, v0, v1, a0, a1) = (x.h[k], x.v[k], x.v[k + 1], x.a[k], x.a[k + 1]);
        [
            v1 - v0 - 0.5 * h * (a0 + a1),
            self.weight[k] * (0.5 * h * (v0 + v1) - h * h * (a1 - a0) / 12.0 - self.grid.length[k]),
        ]
    }

    /// Derivatives of (1) and (2) by v0, a0, h, v1, a1.
    fn gradient(&self, k: usize) -> [[f64; STAGE]; 2] {
        let (x, w) = (&self.x, self.weight[k]);
        let (h, v0, v1, a0, a1) = (x.h[k], x.v[k], x.v[k + 1], x.a[k], x.a[k + 1]);
        let along = 0.5 * (v0 + v1) - h * (a1 - a0) / 6.0;
        [
            [-1.0, -0.5 * h, -0.5 * (a0 + a1), 1.0, -0.5 * h],
            [0.5 * h, h * h / 12.0, along, 0.5 * h, -h * h / 12.0].map(|g| w * g),
        ]
    }

    /// Places of v0, a0, h, v1, a1 of stage `k` among the unknowns; those at rest have none.
    fn places(&self, k: usize) -> [Option<usize>; STAGE] {
        let base = STAGE * k;
        let before = (k > 0).then(|| base - STAGE);
        let after = (k + 1 < self.x.h.len()).then_some(base);
        [before.map(|b| b + 1), before.map(|b| b + 2), Some(base), after.map(|b| b + 1), after.map(|b| b + 2)]
    }

    /// Gradient of the Lagrangian with the given prices.
    fn stationarity(&self, price: impl Fn(usize) -> [f64; BOUNDS]) -> Vec<f64> {
        let cells = self.x.h.len();
        let mut r = vec![0.0; STAGE * cells];
        for k in 0..cells {
            let g = self.gradient(k);
            let p = price(k);
            let m = self.multiplier[k];
            // By v0, a0, h, v1, a1.
            let by_v = p[2] - p[3] - p[6];
            let by_a = p[1] - p[0] + p[4] - p[5] - self.lead(k) * p[6];
            let bounds = [0.0, p[0] - p[1], p[0] + p[1], by_v, by_a];
            let time = [0.0, 0.0, 1.0, 0.0, 0.0];
            for (i, place) in self.places(k).into_iter().enumerate() {
                if let Some(place) = place {
                    r[place] += time[i] + m[0] * g[0][i] + m[1] * g[1][i] - bounds[i];
                }
            }
        }
        r
    }

    /// The matrix of the Newton step with curvature `added` on the diagonal.
    fn matrix(&self, added: f64) -> Banded {
        let cells = self.x.h.len();
        let mut matrix = Banded::new(STAGE * cells);
        for k in 0..cells {
            let (places, g) = (self.places(k), self.gradient(k));
            let (s, p) = (self.slacks(&self.x, k), self.price[k]);
            let [m1, m2] = [self.multiplier[k][0], self.multiplier[k][1] * self.weight[k]];
            let (h, da) = (self.x.h[k], self.x.a[k + 1] - self.x.a[k]);
            let mut c = [[0.0; STAGE]; STAGE];
            for i in 0..STAGE {
                for j in 0..=i {
                    c[i][j] = AUGMENTED * (g[0][i] * g[0][j] + g[1][i] * g[1][j]);
                }
            }
            // Curvature of the equations: all in h.
            c[2][0] += 0.5 * m2;
            c[2][1] += -0.5 * m1 + m2 * h / 6.0;
            c[2][2] += -m2 * da / 6.0;
            c[3][2] += 0.5 * m2;
            c[4][2] += -0.5 * m1 - m2 * h / 6.0;
            // Bounds.
            let q: [f64; BOUNDS] = std::array::from_fn(|i| p[i] / s[i]);
            let jerk = q[0] + q[1];
            let skew = q[0] - q[1];
            c[1][1] += jerk;
            c[2][1] += skew;
            c[2][2] += jerk;
            c[4][1] -= jerk;
            c[4][2] -= skew;
            let lead = self.lead(k);
            c[3][3] += q[2] + q[3] + q[6];
            c[4][3] += lead * q[6];
            c[4][4] += jerk + q[4] + q[5] + lead * lead * q[6];
            for (i, row) in c.iter_mut().enumerate().skip(2) {
                row[i] += added;
            }
            for (i, row) in places.into_iter().enumerate() {
                for (j, column) in places.into_iter().enumerate().take(i + 1) {
                    if let (Some(row), Some(column)) = (row, column) {
                        matrix.add(row, column, c[i][j]);
                    }
                }
                if let Some(row) = row {
                    matrix.add(STAGE * k + 3, row, g[0][i]);
                    matrix.add(STAGE * k + 4, row, g[1][i]);
                }
            }
            if k + 1 == cells {
                matrix.add(STAGE * k + 1, STAGE * k + 1, 1.0);
                matrix.add(STAGE * k + 2, STAGE * k + 2, 1.0);
            }
        }
        matrix
    }

    /// A Newton step for barrier weight `mu`; `None` if no curvature helps.
    fn direction(&mut self, mu: f64) -> Option<Direction> {
        let cells = self.x.h.len();
        let mut rhs = self.stationarity(|k| self.slacks(&self.x, k).map(|s| mu / s));
        rhs.iter_mut().for_each(|r| *r = -*r);
        for k in 0..cells {
            let (e, g) = (self.residual(&self.x, k), self.gradient(k));
            for (i, place) in self.places(k).into_iter().enumerate() {
                if let Some(place) = place {
                    rhs[place] -= AUGMENTED * (e[0] * g[0][i] + e[1] * g[1][i]);
                }
            }
            rhs[STAGE * k + 3] = -e[0];
            rhs[STAGE * k + 4] = -e[1];
        }
        let mut added = 0.0;
        for _ in 0..GROWTHS {
            let matrix = self.matrix(added);
            if let Some((factors, negative)) = matrix.factor()
                && negative == 2 * cells
            {
                if added > 0.0 {
                    self.added = added;
                }
                let mut x = rhs.clone();
                factors.solve(&mut x);
                for _ in 0..CORRECTIONS {
                    let product = matrix.times(&x);
                    let mut rest: Vec<f64> = rhs.iter().zip(product).map(|(r, p)| r - p).collect();
                    factors.solve(&mut rest);
                    x.iter_mut().zip(rest).for_each(|(x, r)| *x += r);
                }
                let mut d = Direction {
                    h: Vec::with_capacity(cells),
                    v: vec![0.0],
                    a: vec![0.0],
                    multiplier: Vec::with_capacity(cells),
                };
                for stage in x.chunks_exact(STAGE) {
                    d.h.push(stage[0]);
                    d.v.push(stage[1]);
                    d.a.push(stage[2]);
                    d.multiplier.push([stage[3], stage[4]]);
                }
                return Some(d);
            }
            added = if added > 0.0 { added * GROWTH } else { (self.added / 3.0).max(CURVATURE) };
        }
        None
    }

    /// Barrier function and what is left of the equations; `None` outside an inequality.
    fn merit(&self, x: &Point, mu: f64) -> Option<Merit> {
        let mut merit = Merit { barrier: x.time(), rest: 0.0 };
        for k in 0..x.h.len() {
            for s in self.slacks(x, k) {
                if s.is_nan() || s <= 0.0 {
                    return None;
                }
                merit.barrier -= mu * s.ln();
            }
            let e = self.residual(x, k);
            merit.rest += e[0].abs() + e[1].abs();
        }
        Some(merit)
    }

    /// The motion a part of the way along a direction.
    fn moved(&self, d: &Direction, part: f64) -> Point {
        let step = |x: &[f64], d: &[f64]| x.iter().zip(d).map(|(x, d)| x + part * d).collect();
        Point { h: step(&self.x.h, &d.h), v: step(&self.x.v, &d.v), a: step(&self.x.a, &d.a) }
    }

    /// Largest deviations: of the gradient, of the equations, of the complementarity from `mu`.
    fn errors(&self, mu: f64) -> [f64; 3] {
        let gradient = self.stationarity(|k| self.price[k]).into_iter().fold(0.0, |m: f64, g| m.max(g.abs()));
        let (mut rest, mut gap) = (0.0_f64, 0.0_f64);
        for k in 0..self.x.h.len() {
            let e = self.residual(&self.x, k);
            rest = rest.max(e[0].abs()).max(e[1].abs());
            for (s, p) in self.slacks(&self.x, k).into_iter().zip(self.price[k]) {
                gap = gap.max((s * p - mu).abs());
            }
        }
        [gradient, rest, gap]
    }

    /// Minimises time with the barrier weight falling from `mu` to `mu_end`. True if it got there.
    pub fn solve(&mut self, mut mu: f64, mu_end: f64) -> bool {
        for k in 0..self.x.h.len() {
            self.price[k] = self.slacks(&self.x, k).map(|s| mu / s);
        }
        let mut filter = Vec::new();
        for _ in 0..STEPS {
            while self.is_solved(mu) {
                if mu <= mu_end {
                    return true;
                }
                mu = mu_end.max((0.2 * mu).min(mu.powf(1.5)));
                filter.clear();
            }
            let Some(direction) = self.direction(mu) else { return false };
            if !self.step(&direction, mu, &mut filter) {
                return false;
            }
            self.steps += 1;
        }
        false
    }

    /// True if the conditions of optimality hold as well as barrier weight `mu` deserves.
    fn is_solved(&self, mu: f64) -> bool {
        let [gradient, rest, gap] = self.errors(mu);
        gradient < 1e3 * mu && rest < 10.0 * mu && gap < 10.0 * mu
    }

    /// Moves along a direction: as far as the inequalities and the filter let it. False if nowhere.
    fn step(&mut self, d: &Direction, mu: f64, filter: &mut Vec<Merit>) -> bool {
        let (mut primal, mut dual) = (1.0_f64, 1.0_f64);
        let mut price_step = vec![[0.0; BOUNDS]; self.price.len()];
        for (k, dp) in price_step.iter_mut().enumerate() {
            let (s, ds, p) = (self.slacks(&self.x, k), self.slack_changes(d, k), self.price[k]);
            for i in 0..BOUNDS {
                dp[i] = mu / s[i] - p[i] - p[i] / s[i] * ds[i];
                if ds[i] < 0.0 {
                    primal = primal.min(-TO_BOUND * s[i] / ds[i]);
                }
                if dp[i] < 0.0 {
                    dual = dual.min(-TO_BOUND * p[i] / dp[i]);
                }
            }
        }
        let now = self.merit(&self.x, mu);
        let Some((part, x, merit)) = (0..HALVINGS).find_map(|n| {
            let part = primal * 0.5_f64.powi(n);
            let x = self.moved(d, part);
            let merit = self.merit(&x, mu)?;
            let good = filter.iter().chain(&now).all(|before| merit.improves(before));
            good.then_some((part, x, merit))
        }) else {
            return false;
        };
        if let Some(now) = now
            && merit.barrier > now.barrier - FILTER * now.rest
        {
            filter.push(now);
        }
        self.x = x;
        for (m, dm) in self.multiplier.iter_mut().zip(&d.multiplier) {
            m[0] += part * dm[0];
            m[1] += part * dm[1];
        }
        for (k, dp) in price_step.iter().enumerate() {
            let s = self.slacks(&self.x, k);
            for i in 0..BOUNDS {
                let centre = mu / s[i];
                self.price[k][i] = (self.price[k][i] + dual * dp[i]).clamp(centre * 1e-8, centre * 1e8);
            }
        }
        true
    }
}
