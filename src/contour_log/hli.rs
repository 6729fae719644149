//! The structures of ISG's interface to a PLC (HLI), with the names of ISG's manual FCT-C40. A PLC program
//! that was written for that interface can use them.
//!
//! The order of the members is that of the manual. Lengths are in 0.1 µm, angles in radians.
//!
//! ```
//! use glidepath::contour_log::{ContourMemory, ControlUnit, HliContourLookaheadRequest};
//!
//! let mut memory = ContourMemory::<64, 64>::new();
//! let (_recorder, contour) = memory.split(); // the recorder goes to Planner::log_contour
//! let unit = ControlUnit::<20>::new();
//! // The PLC asks for 10 mm from program start; the CNC answers.
//! unit.ask(HliContourLookaheadRequest { start_position: 0.0, length: 100_000.0 }).unwrap();
//! unit.serve(&contour);
//! assert_eq!(unit.answer().unwrap().block[0].block_type, 0); // no program yet
//! ```
use super::entry::{BlockType, Entry, ProgramDistance};
use super::reader::{ContourReader, Forgotten};
use super::unit::{ControlUnit, Pending, TENTHS, UnitState};
use crate::quantity::Distance;

/// The request of a PLC for entries of the log: ISG's HLI_CONTOUR_LOOKAHEAD_REQUEST.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct HliContourLookaheadRequest {
    /// By index (mode 1): index of the first entry. By distance (mode 2): the first distance, 0.1 µm.
    pub start_position: f64,
    /// 0: request by index. Otherwise request by distance: elements from `start_position` to `start_position
    /// + length`, 0.1 µm.
    pub length: f64,
}

/// One entry of the answer: ISG's HLI_CONTOUR_LOOKAHEAD_BLOCK.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct HliContourLookaheadBlock {
    /// 0 none, 1 line, 2 arc, 3 LOG ON, 4 LOG \[PARAM\], 5 LOG OFF, 6 polynomial.
    pub block_type: u32,
    /// N number of the block in the program.
    pub block_number: u32,
    /// Number of the motion block, counted since the split; the same number as `block` of [`crate::Status`].
    pub block_count_r: u32,
    /// Distance from program start, or from the last `#DISTANCE PROG START CLEAR`, to the start of the entry,
    /// 0.1 µm.
    pub start_position: f64,
    /// Length of an element, 0.1 µm; for a mark of the log, its PARAM.
    pub length: f64,
    /// Programmed radius of an arc, 0.1 µm.
    pub programmed_radius: f64,
    /// The same value as `programmed_radius`: Glidepath has no tool radius compensation.
    pub compensated_radius: f64,
    /// Angle of an arc, radians: clockwise −2π to 0, counter-clockwise 0 to 2π.
    pub circle_angle: f64,
    /// Always 0: Glidepath has no sink erosion, and so no scaled contour.
    pub length_min: f64,
    /// Change of direction from the element before, radians, 0 to π.
    pub tangent_variation: f64,
}

/// The answer to a request: ISG's HLI_CONTOUR_LOOKAHEAD_RESPONSE.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct HliContourLookaheadResponse<const BLOCKS: usize> {
    /// The entries in the order of the path. Unused places after the last entry have type 0.
    pub block: [HliContourLookaheadBlock; BLOCKS],
}

/// The state of the log: ISG's HLI_CONTOUR_LOOKAHEAD_STATE.
pub type HliContourLookaheadState = UnitState;

impl From<Entry> for HliContourLookaheadBlock {
    fn from(entry: Entry) -> Self {
        let tenths = |distance: ProgramDistance| distance.to_mm() * TENTHS;
        let radius = entry.radius_mm * TENTHS;
        Self {
            block_type: match entry.block_type {
                BlockType::Clear => 0,
                kind => kind as u32,
            },
            block_number: entry.n,
            block_count_r: entry.id,
            start_position: tenths(entry.start),
            length: if entry.block_type.is_element() { tenths(entry.length) } else { entry.parameter },
            programmed_radius: radius,
            compensated_radius: radius,
            circle_angle: entry.angle,
            length_min: 0.0,
            tangent_variation: entry.knee,
        }
    }
}

impl<const BLOCKS: usize> ControlUnit<BLOCKS> {
    /// Makes a request, as [`Self::request`], from the structure of the HLI.
    ///
    /// # Errors
    /// The last request is not answered yet; nothing has changed.
    pub fn ask(&self, request: HliContourLookaheadRequest) -> Result<(), Pending> {
        self.request(request.start_position, request.length)
    }

    /// The whole response, for the PLC; `None` while the request is pending.
    pub fn answer(&self) -> Option<HliContourLookaheadResponse<BLOCKS>> {
        let mut block = [HliContourLookaheadBlock::default(); BLOCKS];
        for (i, to) in (0..).zip(&mut block) {
            *to = self.response(i)?.into();
        }
        Some(HliContourLookaheadResponse { block })
    }

    /// ISG's `bahn_state.dist_prog_start`, 0.1 µm: the distance that the axes have reached in the program.
    /// `driven`: the field `distance` of [`crate::Status`]. See [`ContourReader::distance`].
    ///
    /// # Errors
    /// The element there is no longer in the window.
    pub fn dist_prog_start(contour: &ContourReader<'_>, driven: Distance) -> Result<f64, Forgotten> {
        contour.distance(driven).map(|at| at.to_mm() * TENTHS)
    }
}
