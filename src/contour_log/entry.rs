//! One entry of the log of the path: an element of the path, or a mark. An entry takes eleven words (44
//! bytes) of memory.

/// Distance from program start, LSB 2^-24 mm (60 pm), range ±549,755 km. The value does not wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct ProgramDistance(i64);

/// LSB per millimetre.
const PER_MM: f64 = (1i64 << 24) as f64;

/// Additional bits of a driven distance, compared with a program distance.
pub(super) const BELOW: u32 = 20;

/// LSB of an angle per radian.
const PER_RADIAN: f64 = (1i64 << 28) as f64;

impl ProgramDistance {
    /// The distance 0, at program start.
    pub const ZERO: Self = Self(0);

    /// A distance from its number of LSBs (2^-24 mm).
    pub const fn from_bits(bits: i64) -> Self {
        Self(bits)
    }

    /// The number of LSBs (2^-24 mm) of the distance.
    pub const fn to_bits(self) -> i64 {
        self.0
    }

    /// A distance from millimetres, rounded toward zero and limited to the range.
    pub const fn from_mm(mm: f64) -> Self {
        Self((mm * PER_MM) as i64)
    }

    /// The distance in millimetres.
    pub const fn to_mm(self) -> f64 {
        self.0 as f64 / PER_MM
    }
}

/// The kind of an [`Entry`]. The numbers 0 to 6 are those of `block_type` in ISG's manual FCT-C40.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum BlockType {
    /// 0: the entry is not used.
    #[default]
    None = 0,
    /// 1: a line.
    Line = 1,
    /// 2: an arc, also a helix.
    Arc = 2,
    /// 3: the mark of `#CONTOUR LOOKAHEAD LOG ON`.
    LogOn = 3,
    /// 4: LOG PARAM, between LOG ON and LOG OFF.
    LogParam = 4,
    /// 5: the mark of `#CONTOUR LOOKAHEAD LOG OFF`.
    LogOff = 5,
    /// 6: a polynomial, from smoothing or splines.
    Polynomial = 6,
    /// `#DISTANCE PROG START CLEAR`: later distances count from here. Only [`super::ContourReader`] sees this entry.
    Clear = 7,
}

impl BlockType {
    const fn of(number: u32) -> Self {
        match number {
            1 => Self::Line,
            2 => Self::Arc,
            3 => Self::LogOn,
            4 => Self::LogParam,
            5 => Self::LogOff,
            6 => Self::Polynomial,
            7 => Self::Clear,
            _ => Self::None,
        }
    }

    /// Whether the entry is a part of the path.
    pub const fn is_element(self) -> bool {
        matches!(self, Self::Line | Self::Arc | Self::Polynomial)
    }
}

/// One entry of the log of the path: an element of the path, or a mark that the program has set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Entry {
    /// Kind of the entry.
    pub block_type: BlockType,
    /// N number of the block in the program.
    pub n: u32,
    /// Number of the motion block, counted since the split; the same number as `block` of [`crate::Status`].
    pub id: u32,
    /// Start of the entry, counted from program start or from the last `#DISTANCE PROG START CLEAR`.
    pub start: ProgramDistance,
    /// Length along the driven path, 0 for a mark.
    pub length: ProgramDistance,
    /// PARAM of a mark; 0 if not given.
    pub parameter: f64,
    /// Radius of an arc at its start, mm; 0 for other entries. There is no tool radius compensation, so the
    /// compensated radius is the same.
    pub radius_mm: f64,
    /// Angle of an arc, rad: clockwise −2π..0, counter-clockwise 0..2π; 0 for other entries.
    pub angle: f64,
    /// Change of direction from the end of the element before to the start of this element, rad, 0..π.
    pub knee: f64,
}

/// The two words of a number of 64 bits.
const fn halves(bits: i64) -> [u32; 2] {
    [bits as u32, (bits >> 32) as u32]
}

const fn whole(lower: u32, upper: u32) -> i64 {
    ((upper as u64) << 32 | lower as u64) as i64
}

/// An angle as a word.
fn angle_bits(angle: f64) -> u32 {
    let scaled = angle * PER_RADIAN;
    let near = if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 };
    (near as i32) as u32
}

fn angle_of(bits: u32) -> f64 {
    f64::from(bits as i32) / PER_RADIAN
}

impl Entry {
    /// Words of an entry.
    pub(super) const WORDS: usize = 11;

    /// A mark of the log.
    pub(super) fn mark(block_type: BlockType, n: u32, parameter: Option<f64>) -> Self {
        Self { block_type, n, parameter: parameter.unwrap_or(0.0), ..Self::default() }
    }

    pub(super) fn to_words(self) -> [u32; Self::WORDS] {
        let length =
            if self.block_type.is_element() { self.length.0 } else { self.parameter.to_bits() as i64 };
        let radius = ProgramDistance::from_mm(self.radius_mm).0;
        let [start, length, radius] = [self.start.0, length, radius].map(halves);
        [
            self.block_type as u32,
            self.n,
            self.id,
            start[0],
            start[1],
            length[0],
            length[1],
            radius[0],
            radius[1],
            angle_bits(self.angle),
            angle_bits(self.knee),
        ]
    }

    pub(super) fn of_words(words: [u32; Self::WORDS]) -> Self {
        let [kind, n, id, s0, s1, l0, l1, r0, r1, angle, knee] = words;
        let block_type = BlockType::of(kind);
        let second = whole(l0, l1);
        let (length, parameter) =
            if block_type.is_element() { (second, 0.0) } else { (0, f64::from_bits(second as u64)) };
        Self {
            block_type,
            n,
            id,
            start: ProgramDistance(whole(s0, s1)),
            length: ProgramDistance(length),
            parameter,
            radius_mm: ProgramDistance(whole(r0, r1)).to_mm(),
            angle: angle_of(angle),
            knee: angle_of(knee),
        }
    }

    /// End of the entry.
    pub const fn end(&self) -> ProgramDistance {
        ProgramDistance(self.start.0.wrapping_add(self.length.0))
    }
}
