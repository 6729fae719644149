//! The measure of a path: which axes count as path length. These are the feed axes (P-CHAN-00011).
//!
//! ISG's texts name this parameter, but do not describe its effect. Glidepath uses the following meaning,
//! which agrees with ISG's public lists:
//!
//! - The path length of a block is the common travel of its feed axes. F, path speed and the limits of
//!   `#VECTOR LIMIT` refer to this length. Every other axis moves along, even a main axis. With one feed
//!   axis, the path speed is the speed of that axis.
//! - If no axis is a feed axis, the main axes are the feed axes, as in the rest of ISG's texts.
//! - If a block moves no feed axis, its path length counts along the main axes. If the block moves no main
//!   axis either, the length counts along all other axes together.
//! - If an axis moves more than 64 times as far as the feed axes, a 64th of its travel counts as path.
//!   Otherwise the axis would magnify the rounding of path distances and speeds. If the main axes are the
//!   feed axes, the factor is 1024.
//! - An arc needs both axes of its plane as feed axes. Along a single axis, the arc goes back and forth, and
//!   no feed can describe its speed. ISG even demands all main axes.
//! - **Tolerances and deviations are distances in space** between points of the main axes, whatever the feed
//!   axes are. Examples are PATH_DEV, RELEVANT_PATH, and the distance of points that a merged line leaves
//!   out.
//! - **Corner distances are lengths of the path**: PRE_DIST, POST_DIST, PATH_DIST ("on the feed axes' path"),
//!   SYM_DIST, and parts of blocks.
use super::{FINER, path_length, travelled};
#[cfg(feature = "grbl")]
use crate::machine::Dialect;
use crate::machine::{AxisData, MODE_MASTER, MachineData};
use crate::math::root::sqrt_f32;
use crate::quantity::Distance;

/// The indices of up to three main axes, in a vector over all axes of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Main([u8; 3]);

impl Main {
    /// No axis in this place.
    const NONE: u8 = u8::MAX;

    /// The main axes with these indices; `None` for a main axis that the machine does not have.
    pub fn new(places: [Option<usize>; 3]) -> Self {
        Self(places.map(|place| place.and_then(|k| u8::try_from(k).ok()).unwrap_or(Self::NONE)))
    }

    /// The first, second or third main axis, counted from 0, if it exists.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn get(&self, i: usize) -> Option<usize> {
        self.0.get(i).filter(|k| **k != Self::NONE).map(|k| usize::from(*k))
    }

    /// Indices of the three main axes; `None` for a missing axis.
    pub fn places(&self) -> [Option<usize>; 3] {
        [self.get(0), self.get(1), self.get(2)]
    }

    /// Indices of the main axes that exist in a vector of `AXES` axes.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn of<const AXES: usize>(&self) -> impl Iterator<Item = usize> {
        self.0.into_iter().map(usize::from).filter(|k| *k < AXES)
    }

    /// Whether this axis is a main axis.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn contains(&self, axis: usize) -> bool {
        self.0.iter().any(|k| usize::from(*k) == axis)
    }

    /// Whether the main axes are the first three axes in order.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn lead(&self) -> bool {
        self.0 == [0, 1, 2]
    }
}

/// How the path length is measured: the main axes, feed axes and master axis of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measure {
    /// The main axes: they span the space.
    pub main: Main,
    /// The feed axes if they are not the main axes, bit k for axis k.
    feed: Option<u32>,
    master: Option<usize>,
    /// Whether radii of an arc may differ as much as LinuxCNC and Grbl permit.
    #[cfg(feature = "grbl")]
    tolerant: bool,
}

/// Largest number of axes that may be feed axes: axes from this index on have no bit in the mask.
pub const FEED_AXES: usize = 32;

/// Largest ratio of the travel of another axis to that of the feed axes, as a power of two.
const STEEPEST: u32 = 6;

fn bits(axes: impl Iterator<Item = usize>) -> u32 {
    axes.filter(|k| *k < FEED_AXES).fold(0, |bits, k| bits | 1 << k)
}

impl Measure {
    /// The measure for these main axes, feed axes (P-CHAN-00011), and axes marked as master axes
    /// (P-AXIS-00015).
    pub fn new(
        main: [Option<usize>; 3],
        feed: impl Iterator<Item = usize>,
        marked: impl Iterator<Item = usize>,
    ) -> Self {
        let space = bits(main.into_iter().flatten());
        let feed = match bits(feed) {
            0 => space,
            feed => feed,
        };
        let only = feed.count_ones() == 1 && feed & bits(marked) != 0;
        let master = only.then_some(feed.trailing_zeros() as usize);
        Self {
            main: Main::new(main),
            feed: (feed != space).then_some(feed),
            master,
            #[cfg(feature = "grbl")]
            tolerant: false,
        }
    }

    /// The measure of a machine.
    pub fn of<const AXES: usize>(machine: &MachineData<AXES>) -> Self {
        let named = |wanted: fn(&AxisData) -> bool| {
            machine.axes.iter().enumerate().filter(move |(_, axis)| wanted(axis)).map(|(k, _)| k)
        };
        let measure = Self::new(
            machine.main_axes(),
            named(|axis| axis.default_feed_axis),
            named(|axis| axis.achs_mode & MODE_MASTER != 0),
        );
        #[cfg(feature = "grbl")]
        let measure = Self { tolerant: machine.channel.foreign.dialect != Dialect::Isg, ..measure };
        measure
    }

    /// Whether the radii of an arc may differ as much as LinuxCNC and Grbl permit.
    #[cfg(feature = "grbl")]
    pub const fn is_tolerant(&self) -> bool {
        self.tolerant
    }

    /// Always `false`: without other dialects, radii may not differ more.
    #[cfg(not(feature = "grbl"))]
    #[inline(always)]
    pub const fn is_tolerant(&self) -> bool {
        false
    }

    /// Whether the main axes are the feed axes.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_space(&self) -> bool {
        self.feed.is_none()
    }

    /// The only feed axis, if it is marked as master axis.
    pub fn master(&self) -> Option<usize> {
        self.master
    }

    /// Whether the feed counts along this axis.
    pub fn feeds(&self, axis: usize) -> bool {
        match self.feed {
            None => self.main.contains(axis),
            Some(feed) => axis < FEED_AXES && feed >> axis & 1 == 1,
        }
    }

    /// Length of a direction along the feed axes.
    pub fn length<const AXES: usize>(&self, direction: &[f32; AXES]) -> f32 {
        let feed = direction.iter().enumerate().filter(|(k, _)| self.feeds(*k));
        sqrt_f32(feed.fold(0.0, |sum, (_, x)| sum + x * x))
    }

    /// Path length of these travels (LSB of a position), LSB 2^-44 mm: along the feed axes; if none of them
    /// moves, along the main axes.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn travelled<const AXES: usize>(&self, travel: &[i64; AXES]) -> i64 {
        if self.feed.is_some() {
            let along = self.fed(travel);
            if along != 0 {
                return along;
            }
        }
        travelled(self.main.of::<AXES>().filter_map(|k| travel.get(k)).copied())
    }

    /// Path length of these travels (LSB of a position): along the feed axes, if one of them moves; otherwise
    /// along the main axes, if one of them moves; otherwise along all axes. The length is exact to an LSB,
    /// and limited to the range of a distance.
    pub fn path<const AXES: usize>(&self, travel: &[i64; AXES]) -> Distance {
        path_length(self.travelled(travel), travel).unwrap_or(Distance::from_bits(i64::MAX))
    }

    #[inline(never)]
    fn fed<const AXES: usize>(&self, travel: &[i64; AXES]) -> i64 {
        let feed = travel.iter().enumerate().filter(|(k, _)| self.feeds(*k));
        self.resolved(travelled(feed.map(|(_, x)| *x)), travel)
    }

    /// Raises the path length `along` so that it resolves the travel of every axis, if any feed axis moves.
    pub(super) fn resolved<const AXES: usize>(&self, along: i64, travel: &[i64; AXES]) -> i64 {
        if self.is_space() || along == 0 {
            return along;
        }
        travel.iter().fold(along, |most, x| most.max(x.saturating_abs() << (FINER - STEEPEST)))
    }
}
