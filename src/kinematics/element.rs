//! Connects a transformation with the path of the channel. [`Kinematic::course`] turns an element of tool tip
//! and angles into a [`Course`]. [`Cell::become_element`] turns a [`Cell`] of this course into an element of
//! the axes.
//!
//! Channel and chain number the axes in the same way. In a program, the main axes give the tool tip. Axes of
//! the channel that are not in the chain keep their own curves.
use super::cells::{Cell, Course, Round};
use super::chain::{AXES, Chain, ROTARIES};
use super::vector::{Vector, number, position};
use crate::machine::{AxisKind, MachineData};
use crate::path::Element;
use crate::path::powers::{Quintic, Turn};
use crate::quantity::{Distance, Position};
use core::fmt;

/// A transformation that `#KIN ID` can select: its number, and a chain that fits the channel. The application
/// makes this value once and keeps it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematic {
    /// P-CHAN-00262 `trafo[].id`: the number with which `#KIN ID` selects this transformation.
    pub id: u16,
    /// The axes from the workpiece to the tool.
    pub chain: Chain,
    /// Channel axes of the tool tip's X, Y and Z.
    main: [usize; 3],
    /// Axes of the chain, bit k for axis k.
    axes: u32,
}

/// The reason why the axes of a channel do not fit the transformation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unfit {
    /// The identifier of the transformation is 0.
    Id,
    /// The channel does not have three main axes.
    Main,
    /// The channel has more than six axes.
    Axes,
    /// The chain has an axis with this index, but the channel does not.
    Missing(u8),
    /// The linear axis with this index is not a main axis.
    Linear(u8),
    /// The axis with this index is a rotary axis in the chain, but not in the channel.
    Rotary(u8),
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Id => f.write_str("id 0; expected 1 to 65535 (P-CHAN-00262)"),
            Self::Main => f.write_str("the channel lacks a main axis; expected three linear axes"),
            Self::Axes => {
                write!(f, "the channel has more axes than a transformation; expected at most {AXES}")
            }
            Self::Missing(axis) => write!(f, "the chain has an axis {axis}; expected axes of the channel"),
            Self::Linear(axis) => {
                write!(f, "linear axis {axis} of the chain; expected a main axis of the channel")
            }
            Self::Rotary(axis) => {
                write!(f, "rotary axis {axis} of the chain; expected a rotary axis of the channel")
            }
        }
    }
}

impl core::error::Error for Unfit {}

impl Kinematic {
    /// Makes the transformation number `id` from `chain`, for the channel of `machine`. Axis k of the chain
    /// is axis k of the channel.
    ///
    /// # Errors
    /// Returns the property that does not fit.
    pub fn new<const N: usize>(id: u16, chain: &Chain, machine: &MachineData<N>) -> Result<Self, Unfit> {
        let [Some(x), Some(y), Some(z)] = machine.main_axes() else { return Err(Unfit::Main) };
        if id == 0 {
            return Err(Unfit::Id);
        }
        if N > AXES {
            return Err(Unfit::Axes);
        }
        let mut axes = 0;
        for axis in chain.linear_axes() {
            if axis >= N {
                return Err(Unfit::Missing(axis as u8));
            }
            if ![x, y, z].contains(&axis) {
                return Err(Unfit::Linear(axis as u8));
            }
            axes |= 1 << axis;
        }
        for rotary in chain.rotaries() {
            let Some(axis) = machine.axes.get(usize::from(rotary.axis)) else {
                return Err(Unfit::Missing(rotary.axis));
            };
            if axis.kind != AxisKind::Rotary {
                return Err(Unfit::Rotary(rotary.axis));
            }
            axes |= 1 << rotary.axis;
        }
        Ok(Self { id, chain: *chain, main: [x, y, z], axes })
    }

    /// Whether the chain has this axis of the channel.
    pub const fn has(&self, axis: usize) -> bool {
        axis < AXES && self.axes >> axis & 1 == 1
    }

    /// All axes that move when the program moves the axes `moved`. In both words bit k is axis k.
    pub fn carried(&self, moved: u32) -> u32 {
        let bits = |axes: &mut dyn Iterator<Item = usize>| axes.fold(0u32, |bits, axis| bits | 1 << axis);
        let linear = bits(&mut self.chain.linear_axes().into_iter());
        let turns = moved & self.axes & !linear != 0;
        let leans = !self.chain.is_upright() && moved & linear != 0;
        if turns || leans { moved | linear } else { moved }
    }

    /// Whether the linear axes are at right angles to each other, and `axis` is parallel to z of the machine.
    pub fn is_cartesian_z(&self, axis: usize) -> bool {
        self.chain.is_cartesian() && self.chain.is_along_z(axis)
    }

    /// The positions `axes`, with the tool tip (mm) in place of the main axes; all other axes are unchanged.
    pub fn workpiece<const N: usize>(&self, axes: &[Position; N]) -> Option<[Position; N]> {
        let (tip, _) = self.chain.forward(&widened(axes));
        let mut workpiece = *axes;
        for (k, x) in self.main.into_iter().zip([tip.x, tip.y, tip.z]) {
            *workpiece.get_mut(k)? = position(x)?;
        }
        Some(workpiece)
    }

    /// The direction from tool tip to holder at the positions `axes`, for displays. The entries of the main
    /// axes are a unit vector in workpiece coordinates; the other entries are 0.
    pub fn direction<const N: usize>(&self, axes: &[Position; N]) -> [f64; N] {
        let (_, tool) = self.chain.forward(&widened(axes));
        let mut direction = [0.0; N];
        for (k, x) in self.main.into_iter().zip([tool.x, tool.y, tool.z]) {
            if let Some(place) = direction.get_mut(k) {
                *place = x;
            }
        }
        direction
    }

    /// The positions of all axes, from positions with the tool tip in place of the main axes. Returns `None`
    /// if a linear axis is beyond ±200 000 mm.
    pub fn axes<const N: usize>(&self, workpiece: &[Position; N]) -> Option<[Position; N]> {
        let of = |axis: usize| workpiece.get(axis).map(|x| number(*x));
        let [Some(x), Some(y), Some(z)] = self.main.map(of) else { return None };
        let mut angles = [Position::ZERO; ROTARIES];
        for rotary in self.chain.rotaries() {
            *angles.get_mut(usize::from(rotary.slot))? = *workpiece.get(usize::from(rotary.axis))?;
        }
        let made = self.chain.inverse(Vector::new(x, y, z), &angles)?;
        let mut axes = *workpiece;
        for (k, (place, axis)) in axes.iter_mut().zip(&made).enumerate() {
            if self.has(k) {
                *place = *axis;
            }
        }
        Some(axes)
    }

    /// Turns an element that begins at `start` (workpiece coordinates) into a curve of tool tip and angles.
    pub fn course<const N: usize>(&self, element: &Element<N>, start: &[Position; N]) -> Course {
        let powers = element.shape.powers(start);
        let of = |axis: usize| powers.axes.get(axis).copied().unwrap_or([0.0; 6]);
        let [x, y, z] = self.main.map(of);
        let mut tip = [Vector::ZERO; 6];
        for (tip, (x, (y, z))) in tip.iter_mut().zip(x.iter().zip(y.iter().zip(&z))) {
            *tip = Vector::new(*x, *y, *z);
        }
        let mut angles = [[0.0; 6]; ROTARIES];
        for rotary in self.chain.rotaries() {
            if let Some(angle) = angles.get_mut(usize::from(rotary.slot)) {
                *angle = of(usize::from(rotary.axis));
            }
        }
        let mut others = [[0.0; 6]; AXES];
        for (k, other) in others.iter_mut().enumerate().filter(|(k, _)| *k < N && !self.has(*k)) {
            *other = of(k);
        }
        Course { tip, round: powers.turn.map(|turn| self.round(&turn)), angles, others }
    }

    /// An arc in space.
    fn round(&self, turn: &Turn) -> Round {
        const UNITS: [Vector; 3] =
            [Vector::new(1.0, 0.0, 0.0), Vector::new(0.0, 1.0, 0.0), Vector::new(0.0, 0.0, 1.0)];
        let unit = |axis: usize| {
            let place = self.main.iter().position(|main| *main == axis);
            place.and_then(|place| UNITS.get(place)).copied().unwrap_or(Vector::ZERO)
        };
        let [p, q] = turn.plane.map(unit);
        let at = |[a, b]: [f64; 2]| p.times(a).plus(q.times(b));
        Round { radius: at(turn.radius), growth: at(turn.growth), normal: p.cross(q), degrees: turn.degrees }
    }
}

/// The positions of a channel's axes, by index, as positions of the six possible axes of a chain; missing
/// axes are 0.
pub fn widened<const N: usize>(axes: &[Position; N]) -> [Position; AXES] {
    let mut all = [Position::ZERO; AXES];
    for (place, axis) in all.iter_mut().zip(axes) {
        *place = *axis;
    }
    all
}

impl Cell {
    /// Writes the cell into `element`, with the path length `length`. `fastest`: largest ratio of the speed
    /// along the curve to the path speed. `is_straight`: the axes move in proportion to the path distance.
    /// Returns `None` if a coefficient does not fit into its integer.
    pub fn become_element<const N: usize>(
        &self,
        element: &mut Element<N>,
        length: Distance,
        (fastest, is_straight): (f32, bool),
    ) -> Option<()> {
        let mut axes = [Quintic::REST; N];
        let ends = self.ends[0].iter().zip(&self.ends[1]);
        for (axis, (power, (from, to))) in axes.iter_mut().zip(self.power.iter().zip(ends)) {
            *axis = Quintic { power: *power, ends: [*from, *to] };
        }
        element.become_quintics(length, &axes, (fastest, is_straight))
    }

    /// Start and end of the cell: positions of the channel's axes, mm or degrees.
    pub fn span<const N: usize>(&self) -> [[Position; N]; 2] {
        let (mut start, mut end) = ([Position::ZERO; N], [Position::ZERO; N]);
        for ((start, end), (from, power)) in
            start.iter_mut().zip(&mut end).zip(self.start.iter().zip(&self.power))
        {
            *start = *from;
            let travel = power.iter().fold(0i64, |sum, c| sum.wrapping_add(*c)) >> super::cells::FINER;
            *end = Position::from_bits(from.to_bits().wrapping_add(travel));
        }
        [start, end]
    }
}
