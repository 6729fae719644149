//! The G and M words of LinuxCNC and Grbl: one table for the decoder and for whoever lists them.
use super::course::CycleKind;
use crate::machine::Dialect;
use crate::nc::Plane;
use crate::nc::modal::Mode;

/// What a word does.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// G0…G3.
    Motion(Mode),
    /// A canned cycle.
    Cycle(CycleKind),
    /// G80: axis words need a motion word.
    NoMotion,
    Dwell,
    Plane(Plane),
    /// G20: inch.
    Inch(bool),
    /// G10.
    Store,
    /// G28, G30: the place with this number.
    Home(u8),
    /// G28.1, G30.1.
    StoreHome(u8),
    /// G53.
    Machine,
    /// G54…G59.3 by number, from 0.
    Offset(u8),
    /// A word that says what is so anyway.
    Nothing,
    /// G43.
    Length,
    /// G43.1.
    LengthNow,
    /// G49.
    NoLength,
    /// G61.
    ExactPath,
    /// G61.1.
    ExactStop,
    /// G64.
    Blend,
    /// G91 (true), G90.
    Relative(bool),
    /// G90.1 (true), G91.1.
    CentreAbsolute(bool),
    /// G93 (true), G94.
    ByTime(bool),
    /// G38.2…G38.5, by the digit behind the point.
    Probe(u8),
    /// M49…M53, M56: overrides stay as they are, which is told.
    Override,
    /// M61 Q: the tool number, without a change.
    ToolNumber,
    /// M98.
    Call,
    /// M99.
    Return,
    /// G92.
    Here,
    /// G92.1.
    HereClear,
    /// G92.2.
    HereOff,
    /// G92.3.
    HereBack,
    /// G52.
    Local,
    /// G99 (true), G98.
    ToLevel(bool),
    /// M0, M60.
    Pause,
    /// M1.
    OptionalPause,
    /// M2, M30.
    End,
    /// M3, M4, M5.
    Spindle,
    /// M7, M8, M9.
    Coolant,
    /// M6.
    Change,
    /// M100…M199.
    User,
    /// Known to the dialect and not built: what to do instead.
    Later(&'static str),
}

/// Modal groups: a block holds one word of each.
pub mod group {
    pub const NON_MODAL: u8 = 0;
    pub const MOTION: u8 = 1;
    pub const PLANE: u8 = 2;
    pub const DISTANCE: u8 = 3;
    pub const CENTRE: u8 = 4;
    pub const FEED: u8 = 5;
    pub const UNITS: u8 = 6;
    pub const RADIUS: u8 = 7;
    pub const LENGTH: u8 = 8;
    pub const LEVEL: u8 = 9;
    pub const OFFSET: u8 = 10;
    pub const PATH: u8 = 11;
    pub const SPINDLE_MODE: u8 = 12;
    pub const LATHE: u8 = 13;
    pub const STOP: u8 = 14;
    pub const TOOL: u8 = 15;
    pub const SPINDLE: u8 = 16;
    /// M7, which may stand beside M8.
    pub const MIST: u8 = 17;
    pub const FLOOD: u8 = 18;
    pub const OVERRIDE: u8 = 19;
    pub const USER: u8 = 20;
    pub const OUTPUT: u8 = 21;
    /// G80, which the heads of programs have beside G0.
    pub const CYCLE_END: u8 = 22;
    pub const COUNT: usize = 23;
}

/// A word of a dialect.
#[derive(Clone, Copy)]
pub struct WordEntry {
    /// `G` or `M`.
    pub letter: char,
    /// Its number in tenths: 382 for G38.2.
    pub tenths: u16,
    /// What it does, in plain words.
    pub text: &'static str,
    dialects: u8,
    pub(super) group: u8,
    pub(super) meaning: Meaning,
}

const LINUXCNC: u8 = 1;
const GRBL: u8 = 2;
const BOTH: u8 = LINUXCNC | GRBL;

const fn bit(dialect: Dialect) -> u8 {
    match dialect {
        Dialect::Isg => 0,
        Dialect::LinuxCnc => LINUXCNC,
        Dialect::Grbl => GRBL,
    }
}

impl WordEntry {
    /// Whether the dialect has it.
    pub const fn is_in(&self, dialect: Dialect) -> bool {
        self.dialects & bit(dialect) != 0
    }

    /// Whether this version carries it out; `Err` with what to do instead.
    ///
    /// # Errors
    /// It is refused.
    pub const fn is_built(&self) -> Result<(), &'static str> {
        match self.meaning {
            Meaning::Later(hint) => Err(hint),
            _ => Ok(()),
        }
    }
}

/// The word with this number, if the dialect has it.
pub(super) fn find(dialect: Dialect, letter: u8, tenths: u16) -> Option<&'static WordEntry> {
    let same = |word: &&WordEntry| word.letter == char::from(letter) && word.tenths == tenths;
    let word = WORDS.iter().find(|word| same(word) && word.is_in(dialect));
    let user = letter == b'M' && (1000..=1990).contains(&tenths) && tenths.is_multiple_of(10);
    word.or(if user && dialect == Dialect::LinuxCnc { Some(&USER) } else { None })
}

const fn g(tenths: u16, dialects: u8, group: u8, meaning: Meaning, text: &'static str) -> WordEntry {
    WordEntry { letter: 'G', tenths, text, dialects, group, meaning }
}

const fn m(number: u16, dialects: u8, group: u8, meaning: Meaning, text: &'static str) -> WordEntry {
    WordEntry { letter: 'M', tenths: number * 10, text, dialects, group, meaning }
}

/// LinuxCNC's M100…M199: the first one stands for all of them.
const USER: WordEntry = m(100, LINUXCNC, group::USER, Meaning::User, "user function (M100 to M199)");

const COMPENSATED: &str = "a path that the CAM has compensated for the tool radius";
const SYNCHRONISED: &str = "a cycle without synchronisation to the spindle";
const OUTPUTS: &str = "M functions of the machine data";
const STATE: &str = "the modal words written out";

/// All words, by letter and number.
pub static WORDS: &[WordEntry] = &[
    g(0, BOTH, group::MOTION, Meaning::Motion(Mode::Rapid), "rapid motion"),
    g(10, BOTH, group::MOTION, Meaning::Motion(Mode::Line), "straight motion at feed"),
    g(20, BOTH, group::MOTION, Meaning::Motion(Mode::Clockwise), "arc clockwise: I J K or R, P turns"),
    g(30, BOTH, group::MOTION, Meaning::Motion(Mode::Counterclockwise), "arc counter-clockwise"),
    g(40, BOTH, group::NON_MODAL, Meaning::Dwell, "dwell of P seconds"),
    g(50, BOTH, group::MOTION, Meaning::Later("short lines"), "cubic spline"),
    g(51, BOTH, group::MOTION, Meaning::Later("short lines"), "quadratic spline"),
    g(52, LINUXCNC, group::MOTION, Meaning::Later("short lines"), "NURBS"),
    g(70, BOTH, group::LATHE, Meaning::Later("radii, G8"), "X is a diameter"),
    g(80, BOTH, group::LATHE, Meaning::Nothing, "X is a radius"),
    g(100, BOTH, group::NON_MODAL, Meaning::Store, "L2, L20: store a zero offset"),
    g(170, BOTH, group::PLANE, Meaning::Plane(Plane::G17), "plane XY"),
    g(180, BOTH, group::PLANE, Meaning::Plane(Plane::G18), "plane ZX"),
    g(190, BOTH, group::PLANE, Meaning::Plane(Plane::G19), "plane YZ"),
    g(200, BOTH, group::UNITS, Meaning::Inch(true), "inch"),
    g(210, BOTH, group::UNITS, Meaning::Inch(false), "millimetre"),
    g(280, BOTH, group::NON_MODAL, Meaning::Home(0), "rapid to the first stored place"),
    g(281, BOTH, group::NON_MODAL, Meaning::StoreHome(0), "store the first place"),
    g(300, BOTH, group::NON_MODAL, Meaning::Home(1), "rapid to the second stored place"),
    g(301, BOTH, group::NON_MODAL, Meaning::StoreHome(1), "store the second place"),
    g(330, BOTH, group::MOTION, Meaning::Later(SYNCHRONISED), "motion with the spindle"),
    g(331, BOTH, group::MOTION, Meaning::Later(SYNCHRONISED), "rigid tapping"),
    g(382, BOTH, group::MOTION, Meaning::Probe(2), "probe towards, with an error"),
    g(383, BOTH, group::MOTION, Meaning::Probe(3), "probe towards"),
    g(384, BOTH, group::MOTION, Meaning::Probe(4), "probe away, with an error"),
    g(385, BOTH, group::MOTION, Meaning::Probe(5), "probe away"),
    g(400, BOTH, group::RADIUS, Meaning::Nothing, "no tool radius compensation"),
    g(410, BOTH, group::RADIUS, Meaning::Later(COMPENSATED), "tool radius compensation, left"),
    g(411, BOTH, group::RADIUS, Meaning::Later(COMPENSATED), "tool radius compensation, left"),
    g(420, BOTH, group::RADIUS, Meaning::Later(COMPENSATED), "tool radius compensation, right"),
    g(421, BOTH, group::RADIUS, Meaning::Later(COMPENSATED), "tool radius compensation, right"),
    g(430, BOTH, group::LENGTH, Meaning::Length, "tool length of H"),
    g(431, BOTH, group::LENGTH, Meaning::LengthNow, "tool length from this block"),
    g(432, BOTH, group::LENGTH, Meaning::Later("one tool length, G43"), "a further tool length"),
    g(490, BOTH, group::LENGTH, Meaning::NoLength, "no tool length"),
    g(500, GRBL, group::LATHE, Meaning::Later("coordinates of the final size"), "no scaling"),
    g(510, GRBL, group::LATHE, Meaning::Later("coordinates of the final size"), "scaling"),
    g(520, LINUXCNC, group::NON_MODAL, Meaning::Local, "temporary offset"),
    g(530, BOTH, group::NON_MODAL, Meaning::Machine, "machine coordinates in this block"),
    g(540, BOTH, group::OFFSET, Meaning::Offset(0), "zero offset 1"),
    g(550, BOTH, group::OFFSET, Meaning::Offset(1), "zero offset 2"),
    g(560, BOTH, group::OFFSET, Meaning::Offset(2), "zero offset 3"),
    g(570, BOTH, group::OFFSET, Meaning::Offset(3), "zero offset 4"),
    g(580, BOTH, group::OFFSET, Meaning::Offset(4), "zero offset 5"),
    g(590, BOTH, group::OFFSET, Meaning::Offset(5), "zero offset 6"),
    g(591, BOTH, group::OFFSET, Meaning::Offset(6), "zero offset 7"),
    g(592, BOTH, group::OFFSET, Meaning::Offset(7), "zero offset 8"),
    g(593, BOTH, group::OFFSET, Meaning::Offset(8), "zero offset 9"),
    g(610, BOTH, group::PATH, Meaning::ExactPath, "exact path"),
    g(611, LINUXCNC, group::PATH, Meaning::ExactStop, "exact stop"),
    g(640, BOTH, group::PATH, Meaning::Blend, "rounded corners, P the largest deviation"),
    g(730, BOTH, group::MOTION, Meaning::Cycle(CycleKind::Break), "drill with chip breaking"),
    g(740, LINUXCNC, group::MOTION, Meaning::Later(SYNCHRONISED), "left-hand tapping"),
    g(760, BOTH, group::MOTION, Meaning::Later(SYNCHRONISED), "threading"),
    g(800, BOTH, group::CYCLE_END, Meaning::NoMotion, "end of cycles"),
    g(810, BOTH, group::MOTION, Meaning::Cycle(CycleKind::Drill), "drill"),
    g(820, BOTH, group::MOTION, Meaning::Cycle(CycleKind::Dwell), "drill with dwell P"),
    g(830, BOTH, group::MOTION, Meaning::Cycle(CycleKind::Peck), "deep drill in pecks of Q"),
    g(840, BOTH, group::MOTION, Meaning::Later(SYNCHRONISED), "tapping"),
    g(850, BOTH, group::MOTION, Meaning::Cycle(CycleKind::Bore), "bore, out at feed"),
    g(860, BOTH, group::MOTION, Meaning::Later("G85 or G89"), "bore, spindle stop"),
    g(870, LINUXCNC, group::MOTION, Meaning::Later("G85 or G89"), "back boring"),
    g(880, LINUXCNC, group::MOTION, Meaning::Later("G85 or G89"), "bore, out by hand"),
    g(890, BOTH, group::MOTION, Meaning::Cycle(CycleKind::BoreDwell), "bore with dwell P, out at feed"),
    g(900, BOTH, group::DISTANCE, Meaning::Relative(false), "absolute coordinates"),
    g(901, LINUXCNC, group::CENTRE, Meaning::CentreAbsolute(true), "absolute arc centres"),
    g(910, BOTH, group::DISTANCE, Meaning::Relative(true), "incremental coordinates"),
    g(911, BOTH, group::CENTRE, Meaning::CentreAbsolute(false), "arc centres from the start"),
    g(920, BOTH, group::NON_MODAL, Meaning::Here, "this place has these coordinates"),
    g(921, BOTH, group::NON_MODAL, Meaning::HereClear, "clear the offsets of G92"),
    g(922, LINUXCNC, group::NON_MODAL, Meaning::HereOff, "suspend the offsets of G92"),
    g(923, LINUXCNC, group::NON_MODAL, Meaning::HereBack, "bring the offsets of G92 back"),
    g(930, BOTH, group::FEED, Meaning::ByTime(true), "inverse time feed: F blocks per minute"),
    g(940, BOTH, group::FEED, Meaning::ByTime(false), "feed per minute"),
    g(950, BOTH, group::FEED, Meaning::Later("F per minute, G94"), "feed per revolution"),
    g(960, BOTH, group::SPINDLE_MODE, Meaning::Later("S in 1/min, G97"), "constant surface speed"),
    g(970, BOTH, group::SPINDLE_MODE, Meaning::Nothing, "S in 1/min"),
    g(980, BOTH, group::LEVEL, Meaning::ToLevel(false), "cycles end at the old level"),
    g(990, BOTH, group::LEVEL, Meaning::ToLevel(true), "cycles end at R"),
    m(0, BOTH, group::STOP, Meaning::Pause, "pause"),
    m(1, BOTH, group::STOP, Meaning::OptionalPause, "pause if the switch is on"),
    m(2, BOTH, group::STOP, Meaning::End, "program end"),
    m(3, BOTH, group::SPINDLE, Meaning::Spindle, "spindle clockwise"),
    m(4, BOTH, group::SPINDLE, Meaning::Spindle, "spindle counter-clockwise"),
    m(5, BOTH, group::SPINDLE, Meaning::Spindle, "spindle off"),
    m(6, BOTH, group::TOOL, Meaning::Change, "tool change, waits"),
    m(7, BOTH, group::MIST, Meaning::Coolant, "mist on"),
    m(8, BOTH, group::FLOOD, Meaning::Coolant, "flood on"),
    m(9, BOTH, group::FLOOD, Meaning::Coolant, "coolant off"),
    m(19, LINUXCNC, group::SPINDLE, Meaning::Later("M5"), "spindle orientation"),
    m(30, BOTH, group::STOP, Meaning::End, "program end"),
    m(48, BOTH, group::OVERRIDE, Meaning::Nothing, "overrides on"),
    m(49, BOTH, group::OVERRIDE, Meaning::Override, "overrides off"),
    m(50, BOTH, group::OVERRIDE, Meaning::Override, "feed override on or off"),
    m(51, BOTH, group::OVERRIDE, Meaning::Override, "spindle override on or off"),
    m(52, LINUXCNC, group::OVERRIDE, Meaning::Override, "adaptive feed"),
    m(53, BOTH, group::OVERRIDE, Meaning::Override, "feed stop switch"),
    m(56, GRBL, group::OVERRIDE, Meaning::Override, "parking override"),
    m(60, BOTH, group::STOP, Meaning::Pause, "pause for a pallet"),
    m(61, BOTH, group::TOOL, Meaning::ToolNumber, "set the tool number"),
    m(62, BOTH, group::OUTPUT, Meaning::Later(OUTPUTS), "output on with the motion"),
    m(63, BOTH, group::OUTPUT, Meaning::Later(OUTPUTS), "output off with the motion"),
    m(64, BOTH, group::OUTPUT, Meaning::Later(OUTPUTS), "output on"),
    m(65, BOTH, group::OUTPUT, Meaning::Later(OUTPUTS), "output off"),
    m(66, BOTH, group::OUTPUT, Meaning::Later(OUTPUTS), "wait for an input"),
    m(67, BOTH, group::OUTPUT, Meaning::Later(OUTPUTS), "analogue output with the motion"),
    m(68, BOTH, group::OUTPUT, Meaning::Later(OUTPUTS), "analogue output"),
    m(70, BOTH, group::USER, Meaning::Later(STATE), "save modal state"),
    m(71, BOTH, group::USER, Meaning::Later(STATE), "forget saved modal state"),
    m(72, BOTH, group::USER, Meaning::Later(STATE), "restore modal state"),
    m(73, BOTH, group::USER, Meaning::Later(STATE), "save and restore modal state"),
    m(98, BOTH, group::USER, Meaning::Call, "call the subprogram with number P, L times"),
    m(99, BOTH, group::USER, Meaning::Return, "return from the subprogram"),
    USER,
];

/// Letters with values, and what they mean: both dialects have them all.
pub static ADDRESSES: &[(char, &str)] = &[
    ('A', "axis (also B C U V W X Y Z, as the machine has them)"),
    ('D', "back-off of G73"),
    ('F', "feed per minute"),
    ('H', "tool of G43"),
    ('I', "arc centre along X (J along Y, K along Z)"),
    ('L', "repeats of a cycle, kind of G10"),
    ('N', "line number"),
    ('O', "program number, or label of sub, call, if, while, do, repeat"),
    ('#', "parameter: number, or name in < >"),
    ('P', "seconds, turns of an arc, tolerance of G64, zero offset of G10"),
    ('Q', "peck of G73 and G83, merging of G64"),
    ('R', "radius of an arc, level of a cycle"),
    ('S', "spindle speed"),
    ('T', "tool"),
];
