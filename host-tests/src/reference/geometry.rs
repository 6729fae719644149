//! The programmed contour in f64: lines, arcs and helices over their length.
//!
//! An arc whose end is not on the circle through its start (I J K are decimals, the true centre is not) keeps
//! its centre and changes its radius linearly with the angle. Axes outside the plane are linear in the same
//! parameter.

/// Which curve an element is.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Straight in all axes.
    Line,
    /// Circular in two axes, straight in the others.
    Arc {
        /// The two axes.
        axes: [usize; 2],
        /// Centre in these axes.
        centre: [f64; 2],
        /// Radius at the start and at the end.
        radius: [f64; 2],
        /// Angle at the start, rad.
        angle: f64,
        /// Angle travelled, rad, positive from the first towards the second axis.
        sweep: f64,
    },
}

/// One block of the contour.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// Curve.
    pub shape: Shape,
    /// Start, all axes.
    pub from: Vec<f64>,
    /// End, all axes.
    pub to: Vec<f64>,
    /// Feed, mm/min; `None` is rapid.
    pub feed: Option<f64>,
    /// Exact stop at the end.
    pub stop: bool,
    /// Main axes.
    pub main: Vec<usize>,
    /// Feed axes: the path counts along them.
    pub feed_axes: Vec<usize>,
    /// Motion blocks it stands for.
    pub blocks: usize,
    /// Whether the block replaces several blocks and is long enough.
    pub long: bool,
}

impl Element {
    /// Travel of one axis.
    pub fn travel(&self, axis: usize) -> f64 {
        self.to[axis] - self.from[axis]
    }

    /// Length in the main axes, mm.
    pub fn main_length(&self) -> f64 {
        match &self.shape {
            Shape::Line => self.main.iter().map(|&k| self.travel(k).powi(2)).sum::<f64>().sqrt(),
            Shape::Arc { axes, radius, sweep, .. } => {
                let along: f64 =
                    self.main.iter().filter(|k| !axes.contains(k)).map(|&k| self.travel(k).powi(2)).sum();
                let spread = (radius[1] - radius[0]).powi(2);
                // Speed over the parameter is sqrt(r(u)² sweep² + dr² + dz²): Simpson, exact to 1e-15 for the
                // tiny changes of radius that a program may contain.
                let speed = |u: f64| {
                    let r = radius[0] + (radius[1] - radius[0]) * u;
                    ((r * sweep).powi(2) + spread + along).sqrt()
                };
                (speed(0.0) + 4.0 * speed(0.5) + speed(1.0)) / 6.0
            }
        }
    }

    /// Euclidean length of the motion of all other axes.
    pub fn tracking_length(&self) -> f64 {
        (0..self.from.len())
            .filter(|k| !self.main.contains(k))
            .map(|k| self.travel(k).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// Position of every axis at the parameter `u` in 0…1 (proportional to the length).
    pub fn at(&self, u: f64) -> Vec<f64> {
        // From the nearer end, so that both ends are exact.
        let mix = |k: usize| {
            if u <= 0.5 { self.from[k] + self.travel(k) * u } else { self.to[k] - self.travel(k) * (1.0 - u) }
        };
        let mut point: Vec<f64> = (0..self.from.len()).map(mix).collect();
        if let Shape::Arc { axes, centre, radius, angle, sweep } = &self.shape {
            let r = radius[0] + (radius[1] - radius[0]) * u;
            let (sin, cos) = (angle + sweep * u).sin_cos();
            point[axes[0]] = centre[0] + r * cos;
            point[axes[1]] = centre[1] + r * sin;
        }
        point
    }

    /// Derivative of every axis over the parameter.
    pub fn derivative(&self, u: f64) -> Vec<f64> {
        let mut d: Vec<f64> = (0..self.from.len()).map(|k| self.travel(k)).collect();
        if let Shape::Arc { axes, radius, angle, sweep, .. } = &self.shape {
            let dr = radius[1] - radius[0];
            let r = radius[0] + dr * u;
            let (sin, cos) = (angle + sweep * u).sin_cos();
            d[axes[0]] = dr * cos - r * sweep * sin;
            d[axes[1]] = dr * sin + r * sweep * cos;
        }
        d
    }

    /// For a line: the parameter of the point nearest to `q` in these axes.
    pub fn project_on(&self, q: &[f64], axes: &[usize]) -> f64 {
        let (mut dot, mut square) = (0.0, 0.0);
        for &k in axes {
            let d = self.travel(k);
            dot += (q[k] - self.from[k]) * d;
            square += d * d;
        }
        if square > 0.0 { dot / square } else { 0.0 }
    }

    /// The parameter of the point nearest to `q`, not clamped to 0…1. For an arc, the turn nearest to `near`.
    pub fn project(&self, q: &[f64], near: f64) -> f64 {
        match &self.shape {
            Shape::Line => self.project_on(q, &(0..q.len()).collect::<Vec<_>>()),
            Shape::Arc { axes, centre, angle, sweep, .. } => {
                let at = (q[axes[1]] - centre[1]).atan2(q[axes[0]] - centre[0]);
                let turn = std::f64::consts::TAU / sweep;
                let u = (at - angle) / sweep;
                let u = u + ((near - u) / turn).round() * turn;
                // On a steep helix the plane alone says little: one Newton step on the distance of all axes.
                let (p, d) = (self.at(u), self.derivative(u));
                let dot: f64 = (0..q.len()).map(|k| (q[k] - p[k]) * d[k]).sum();
                u + dot / d.iter().map(|x| x * x).sum::<f64>()
            }
        }
    }
}

/// A whole program's contour.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// Where it starts.
    pub start: Vec<f64>,
    /// Its blocks with motion.
    pub elements: Vec<Element>,
}

/// How an arc's centre is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Centre {
    /// Relative to the start.
    Offset([f64; 2]),
    /// By the radius; negative takes the longer way round.
    Radius(f64),
}

/// The arc from `from` to `to` (coordinates of the plane's two axes).
pub fn arc(axes: [usize; 2], from: [f64; 2], to: [f64; 2], centre: Centre, clockwise: bool) -> Shape {
    let centre = match centre {
        Centre::Offset([i, j]) => [from[0] + i, from[1] + j],
        Centre::Radius(r) => {
            // On the perpendicular bisector; left of the chord for the shorter way round counter-clockwise.
            let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
            let chord = dx.hypot(dy);
            let height = (r * r - chord * chord / 4.0).max(0.0).sqrt();
            let side = if (r > 0.0) == clockwise { -1.0 } else { 1.0 };
            let (mx, my) = ((from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0);
            [mx - side * height * dy / chord, my + side * height * dx / chord]
        }
    };
    let polar = |p: [f64; 2]| {
        let (x, y) = (p[0] - centre[0], p[1] - centre[1]);
        (x.hypot(y), y.atan2(x))
    };
    let ((r0, a0), (r1, a1)) = (polar(from), polar(to));
    let turn = std::f64::consts::TAU;
    let mut sweep = (a1 - a0).rem_euclid(turn);
    if from == to {
        sweep = turn;
    }
    if clockwise {
        sweep = if from == to { -turn } else { sweep - turn };
    }
    Shape::Arc { axes, centre, radius: [r0, r1], angle: a0, sweep }
}
