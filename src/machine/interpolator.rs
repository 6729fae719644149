//! Machine data of ISG's interpolator (feature `plc`): which additional functions are on, for example the log
//! of the path ahead, and how much memory they have.

/// Smallest size of the storage for blocks (P-STUP-00033), bytes, if it is not 0.
pub const FB_STORAGE_MIN: u32 = 1024;

/// Names of the additional functions of the interpolator that P-CHAN-00650
/// (`configuration.interpolator.function`) enables. The index of a name is its bit in
/// [`InterpolatorFunctions`].
///
/// | name | meaning in Glidepath |
/// |---|---|
/// | FCT_IPO_DEFAULT, FCT_LOOK_AHEAD_STANDARD | look-ahead of 120 blocks |
/// | FCT_LOOK_AHEAD_LOW, FCT_LOOK_AHEAD_HIGH | 30 or 190 blocks |
/// | FCT_LOOK_AHEAD_CUSTOM | as many blocks as P-CHAN-00653 says |
/// | FCT_LOOK_AHEAD_OPT | NO_OPT=0 is the default of the slope HSC |
/// | FCT_CONTOUR_LAH | the log of the path ahead: [`crate::contour_log`] |
/// | FCT_CALC_STATE_AT_T, FCT_CALC_TIME, FCT_CALC_POS_V_0 | questions of the PLC about the coming motion |
/// | FCT_SHIFT_NCBL | M and H functions with MEP_SVS or MEP_MOS are output at a distance before their place |
/// | FCT_DYN_POS_LIMIT | limits of axis positions that a PLC moves: [`crate::contour_log::PositionLimits`] |
/// | others | known, not available |
pub const INTERPOLATOR_FUNCTIONS: &[&str] = &[
    "FCT_IPO_DEFAULT",
    "FCT_LOOK_AHEAD_LOW",
    "FCT_LOOK_AHEAD_STANDARD",
    "FCT_LOOK_AHEAD_HIGH",
    "FCT_LOOK_AHEAD_CUSTOM",
    "FCT_LOOK_AHEAD_OPT",
    "FCT_CONTOUR_LAH",
    "FCT_CALC_STATE_AT_T",
    "FCT_CALC_TIME",
    "FCT_CALC_POS_V_0",
    "FCT_SYNC",
    "FCT_LIFT_UP_TIME",
    "FCT_SHIFT_NCBL",
    "FCT_DYN_POS_LIMIT",
    "FCT_EXTENSION_EQUIDIST",
    "FCT_DLM",
];

/// A set of additional functions of the interpolator: one bit for each name of [`INTERPOLATOR_FUNCTIONS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InterpolatorFunctions(u32);

impl InterpolatorFunctions {
    /// FCT_IPO_DEFAULT: the usual functions, with a look-ahead of 120 blocks.
    pub const IPO_DEFAULT: Self = Self(1);
    /// FCT_LOOK_AHEAD_LOW: a look-ahead of 30 blocks.
    pub const LOOK_AHEAD_LOW: Self = Self(1 << 1);
    /// FCT_LOOK_AHEAD_STANDARD: a look-ahead of 120 blocks.
    pub const LOOK_AHEAD_STANDARD: Self = Self(1 << 2);
    /// FCT_LOOK_AHEAD_HIGH: a look-ahead of 190 blocks.
    pub const LOOK_AHEAD_HIGH: Self = Self(1 << 3);
    /// FCT_LOOK_AHEAD_CUSTOM: a look-ahead of as many blocks as P-CHAN-00653 says.
    pub const LOOK_AHEAD_CUSTOM: Self = Self(1 << 4);
    /// FCT_LOOK_AHEAD_OPT: NO_OPT=0 is the default of the slope HSC.
    pub const LOOK_AHEAD_OPT: Self = Self(1 << 5);
    /// FCT_CONTOUR_LAH: the log of the path ahead.
    pub const CONTOUR_LAH: Self = Self(1 << 6);
    /// FCT_CALC_STATE_AT_T: questions about the state of the motion at a later tick.
    pub const CALC_STATE_AT_T: Self = Self(1 << 7);
    /// FCT_CALC_TIME: questions about the time that the next block takes at its feed.
    pub const CALC_TIME: Self = Self(1 << 8);
    /// FCT_CALC_POS_V_0: questions about the place where a feed hold would stop the axes.
    pub const CALC_POS_V_0: Self = Self(1 << 9);

    /// FCT_SHIFT_NCBL: M and H functions can be output at a distance before their place (MEP_SVS, MEP_MOS).
    pub const SHIFT_NCBL: Self = Self(1 << 12);

    /// FCT_DYN_POS_LIMIT: limits of axis positions that a PLC moves.
    pub const DYN_POS_LIMIT: Self = Self(1 << 13);

    /// The bits of the names that set the length of the look-ahead.
    const SIZES: u32 = 0x1F;
    /// The bits of the names that this version supports.
    const AVAILABLE: u32 = 0x33FF;

    /// The set with these bits; bit k stands for name k of [`INTERPOLATOR_FUNCTIONS`].
    pub const fn of_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// The bits of the set.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The union of both sets.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether the set contains all names of `other`.
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The look-ahead that the set names, in blocks. Returns `None` for FCT_LOOK_AHEAD_CUSTOM: P-CHAN-00653
    /// has the number.
    pub const fn look_ahead(self) -> Option<u32> {
        match self.0 & Self::SIZES {
            2 => Some(30),
            8 => Some(190),
            16 => None,
            _ => Some(120),
        }
    }

    /// The first fault of the set and the expected value; `None` if the set is valid.
    pub fn refused(self) -> Option<(&'static str, &'static str)> {
        let sizes = (self.0 & Self::SIZES).count_ones();
        if sizes != 1 {
            let said = if sizes == 0 { "no size of the look-ahead" } else { "two sizes of the look-ahead" };
            return Some((said, "one of FCT_IPO_DEFAULT, FCT_LOOK_AHEAD_LOW, _STANDARD, _HIGH, _CUSTOM"));
        }
        let absent = INTERPOLATOR_FUNCTIONS
            .iter()
            .enumerate()
            .find(|(bit, _)| self.0 & !Self::AVAILABLE & (1 << bit) != 0);
        absent.map(|(_, name)| match *name {
            "FCT_SYNC" => (
                "FCT_SYNC",
                "leave it out: it is known, not available in this version; no axis joins the path by X[SYNC IN …]",
            ),
            name => (name, "leave it out: it is known, not available in this version"),
        })
    }
}

/// Machine data for a PLC: additional functions of the interpolator, and the memory for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterpolatorData {
    /// P-CHAN-00650 `configuration.interpolator.function` (P-STUP-00070): functions of the interpolator.
    /// [`super::ChannelData::look_ahead`] has the length of the look-ahead. A machine file sets this length
    /// by a name in P-CHAN-00650.
    pub functions: InterpolatorFunctions,
    /// P-CHAN-00658 `configuration.interpolator.contour_lookahead_log_max` (P-STUP-00076): largest number of
    /// elements in the log by index, and in the log by distance. Memory may limit both further.
    pub log_max: u32,
    /// P-STUP-00033 `fb_storage_size[0]`: bytes for stored blocks. 0: no storage, no log by index, and no
    /// real-time loops. A value below [`FB_STORAGE_MIN`] counts as [`FB_STORAGE_MIN`].
    pub fb_storage_size: u32,
    /// P-CHAN-00033 `prog_start.late_sync_ready`: whether a program waits at its end until functions with
    /// late synchronisation (MVS_SLM, MVS_SLP) are acknowledged. `false`: these functions stay pending in the
    /// next program.
    pub late_sync_ready: bool,
}

impl InterpolatorData {
    /// The ISG defaults: no additional function.
    pub const ISG: Self = Self {
        functions: InterpolatorFunctions::IPO_DEFAULT,
        log_max: 128,
        fb_storage_size: 0,
        late_sync_ready: false,
    };

    /// All functions of this version, and storage for a log.
    pub const ALL: Self = Self {
        functions: InterpolatorFunctions::IPO_DEFAULT
            .with(InterpolatorFunctions::CONTOUR_LAH)
            .with(InterpolatorFunctions::CALC_STATE_AT_T)
            .with(InterpolatorFunctions::CALC_TIME)
            .with(InterpolatorFunctions::CALC_POS_V_0)
            .with(InterpolatorFunctions::SHIFT_NCBL)
            .with(InterpolatorFunctions::DYN_POS_LIMIT),
        fb_storage_size: 1 << 20,
        ..Self::ISG
    };

    /// Whether the machine data have this function.
    pub const fn has(&self, function: InterpolatorFunctions) -> bool {
        self.functions.has(function)
    }
}
