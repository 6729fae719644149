//! The table of all G and M words of LinuxCNC, Grbl and Fanuc, accepted or refused. The decoder uses this
//! table, and a test compares the list in `docs/dialects.md` with it.
use super::course::CycleKind;
use crate::machine::{Dialect, functions};
use crate::nc::Plane;
use crate::nc::modal::Mode;

/// What a G or M word of a dialect does.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// G0…G3: the kind of motion.
    Motion(Mode),
    /// A canned cycle.
    Cycle(CycleKind),
    /// G80: axis words need a motion word.
    NoMotion,
    Dwell,
    Plane(Plane),
    /// G20 (`true`) or G21: inch or millimetre.
    Inch(bool),
    /// G10: stores a zero offset.
    Store,
    /// G28 or G30: motion to a stored position, number 0 or 1.
    Home(u8),
    /// G28.1 or G30.1: stores the current position, number 0 or 1.
    StoreHome(u8),
    /// G53: positions are machine coordinates.
    Machine,
    /// G54…G59.3 by number, from 0.
    Offset(u8),
    /// A word for a mode that is always in force; it has no effect.
    Nothing,
    /// G7 (`true`) or G8: X is a diameter or a radius.
    Diameter(bool),
    /// G43: tool length from the table.
    Length,
    /// G43.1: tool length from the block.
    LengthNow,
    /// G49: no tool length.
    NoLength,
    /// G61: exact corners.
    ExactPath,
    /// G61.1: a stop at each corner.
    ExactStop,
    /// G64: corners are rounded.
    Blend,
    /// G91 (`true`) or G90: relative or absolute positions.
    Relative(bool),
    /// G90.1 (`true`) or G91.1: centres of arcs are absolute, or relative to the start.
    CentreAbsolute(bool),
    /// G93 (`true`) or G94: F is inverse time, or feed per minute.
    ByTime(bool),
    /// G38.2…G38.5: a probing motion; the value is the digit after the point.
    Probe(u8),
    /// G95: feed per revolution.
    PerTurn,
    /// G96 (`true`) or G97: constant surface speed, or constant spindle speed.
    Surface(bool),
    /// G9: exact stop at the end of this block.
    StopOnce,
    /// G44: tool length from the table, in the opposite direction.
    LengthMinus,
    /// A mode of the controller that changes no programmed path; its values have no effect.
    Mode,
    /// M49…M53, M56: overrides stay as they are, and a warning reports this.
    Override,
    /// M62…M65: digital output. First value: on or off. Second value: `true` at once, `false` with the
    /// motion.
    Digital(bool, bool),
    /// M67, M68: analogue output. `true`: at once. `false`: with the motion.
    Analog(bool),
    /// M66: wait for an input.
    Input,
    /// M19: orient the spindle.
    Orient,
    /// M70 or M73 (`true`): saves the modal state. M73 also restores it at the end of the subroutine.
    Save(bool),
    /// M71: drop the saved state.
    Forget,
    /// M72: restore the saved state.
    Restore,
    /// M61 Q: sets the tool number without a tool change.
    ToolNumber,
    /// M98: call a subprogram.
    Call,
    /// M99: return from a subprogram.
    Return,
    /// G92: set coordinates.
    Here,
    /// G92.1: clear the offsets of G92.
    HereClear,
    /// G92.2: suspend the offsets of G92.
    HereOff,
    /// G92.3: restore the offsets of G92.
    HereBack,
    /// G52: local shift.
    Local,
    /// G99 (`true`) or G98: cycles end at R, or at the position before the cycle.
    ToLevel(bool),
    /// M0, M60: pause.
    Pause,
    /// M1: pause if enabled.
    OptionalPause,
    /// M2, M30: program end.
    End,
    /// M3, M4, M5: spindle.
    Spindle,
    /// M7, M8, M9: coolant.
    Coolant,
    /// M6: tool change.
    Change,
    /// M100…M199, and M words of a Fanuc machine: functions of the user.
    User,
    /// A word that the dialect has and this version does not; the text names an alternative.
    Later(&'static str),
}

/// Groups of words: a block holds at most one word of each group.
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
    /// M7, which may be in one block with M8.
    pub const MIST: u8 = 17;
    pub const FLOOD: u8 = 18;
    pub const OVERRIDE: u8 = 19;
    pub const USER: u8 = 20;
    pub const OUTPUT: u8 = 21;
    /// G80, which may be in one block with G0.
    pub const CYCLE_END: u8 = 22;
    /// G9, and modes of the controller.
    pub const ONCE: u8 = 23;
    pub const POLAR: u8 = 24;
    pub const ROTATION: u8 = 25;
    pub const SCALING: u8 = 26;
    pub const MIRRORING: u8 = 27;
    pub const MACRO: u8 = 28;
    pub const CHECK: u8 = 29;
    pub const COUNT: usize = 30;
}

/// An entry of the table of G and M words.
#[derive(Clone, Copy)]
pub struct WordEntry {
    /// `G` or `M`.
    pub letter: char,
    /// The number of the word in tenths: 382 for G38.2.
    pub tenths: u16,
    /// The effect of the word, in plain words.
    pub text: &'static str,
    dialects: u8,
    pub(super) group: u8,
    pub(super) meaning: Meaning,
}

const LINUXCNC: u8 = 1;
const GRBL: u8 = 2;
const FANUC: u8 = 4;
const BOTH: u8 = LINUXCNC | GRBL;
const ALL: u8 = BOTH | FANUC;
const FULL: u8 = LINUXCNC | FANUC;

const fn bit(dialect: Dialect) -> u8 {
    match dialect {
        Dialect::Isg => 0,
        Dialect::LinuxCnc => LINUXCNC,
        Dialect::Grbl => GRBL,
        #[cfg(feature = "fanuc")]
        Dialect::Fanuc => FANUC,
    }
}

impl WordEntry {
    /// Whether the dialect has the word.
    pub const fn is_in(&self, dialect: Dialect) -> bool {
        self.dialects & bit(dialect) != 0
    }

    /// Returns an error with an alternative if this version does not carry out the word.
    ///
    /// # Errors
    /// The word is refused.
    pub const fn is_built(&self) -> Result<(), &'static str> {
        match self.meaning {
            Meaning::Later(hint) => Err(hint),
            Meaning::Cycle(_)
            | Meaning::PerTurn
            | Meaning::Surface(true)
            | Meaning::Digital(..)
            | Meaning::Analog(_)
            | Meaning::Input
            | Meaning::Save(_)
            | Meaning::Forget
            | Meaning::Restore
            | Meaning::Call
            | Meaning::Return
                if !functions::DIALECTS.is_built() =>
            {
                Err(NOT_BUILT)
            }
            _ => Ok(()),
        }
    }
}

/// The condition for words that this build does not have.
pub(super) const NOT_BUILT: &str = "a build with the library's feature `dialects`";

/// The word with this number, if the dialect has it.
pub(super) fn find(dialect: Dialect, letter: u8, tenths: u16) -> Option<&'static WordEntry> {
    let same = |word: &&WordEntry| word.letter == char::from(letter) && word.tenths == tenths;
    let word = WORDS.iter().find(|word| same(word) && word.is_in(dialect));
    let range = match dialect {
        Dialect::LinuxCnc => 1000..1991,
        _ if dialect.is_fanuc() => 100..9991,
        _ => 0..0,
    };
    let user = letter == b'M' && range.contains(&tenths) && tenths.is_multiple_of(10);
    word.or(if user { Some(&USER) } else { None })
}

const fn g(tenths: u16, dialects: u8, group: u8, meaning: Meaning, text: &'static str) -> WordEntry {
    WordEntry { letter: 'G', tenths, text, dialects, group, meaning }
}

const fn m(number: u16, dialects: u8, group: u8, meaning: Meaning, text: &'static str) -> WordEntry {
    WordEntry { letter: 'M', tenths: number * 10, text, dialects, group, meaning }
}

/// M100…M199 of LinuxCNC, and M10…M999 of Fanuc: the first word stands for all of them.
const USER: WordEntry = m(
    100,
    FULL,
    group::USER,
    Meaning::User,
    "function of the machine (LinuxCNC: to M199; Fanuc: all others to M999)",
);

const COMPENSATED: &str = "a path that the CAM has compensated for the tool radius";
const SYNCHRONISED: &str = "a cycle without synchronisation to the spindle";
const PLAIN: &str = "coordinates as they are to be driven";
const ORIENTED: &str = "G85 or G89";
const MACRO: &str = "a program without macros";
/// The alternative named when a word of lathes is refused.
pub(super) const OF_MILLS: &str = "a program of a mill: lathes count X as a diameter";

/// All words, by letter and number. A build without LinuxCNC's language has only the words of Grbl.
pub static WORDS: &[WordEntry] = if functions::DIALECTS.is_built() { TABLE } else { &OF_GRBL };

/// The words of [`TABLE`] that Grbl has.
const OF_GRBL: [WordEntry; of_grbl::<0>().0] = of_grbl().1;

/// The number of words that Grbl has, and these words. Other entries fill the rest of the array.
const fn of_grbl<const N: usize>() -> (usize, [WordEntry; N]) {
    let (mut words, mut count, mut k) = ([USER; N], 0, 0);
    while k < TABLE.len() {
        if TABLE[k].dialects & GRBL != 0 {
            if count < N {
                words[count] = TABLE[k];
            }
            count += 1;
        }
        k += 1;
    }
    (count, words)
}

const TABLE: &[WordEntry] = &[
    g(0, ALL, group::MOTION, Meaning::Motion(Mode::Rapid), "rapid motion"),
    g(10, ALL, group::MOTION, Meaning::Motion(Mode::Line), "straight motion at feed"),
    g(20, ALL, group::MOTION, Meaning::Motion(Mode::Clockwise), "arc clockwise: I J K or R, P turns"),
    g(30, ALL, group::MOTION, Meaning::Motion(Mode::Counterclockwise), "arc counter-clockwise"),
    g(40, ALL, group::NON_MODAL, Meaning::Dwell, "dwell of P seconds"),
    g(50, BOTH, group::MOTION, Meaning::Later("short lines"), "cubic spline"),
    g(50, FANUC, group::ONCE, Meaning::Mode, "high-speed mode (P): no effect"),
    g(51, BOTH, group::MOTION, Meaning::Later("short lines"), "quadratic spline"),
    g(51, FANUC, group::ONCE, Meaning::Mode, "contour control (Q): no effect"),
    g(52, LINUXCNC, group::MOTION, Meaning::Later("short lines"), "NURBS"),
    g(70, BOTH, group::LATHE, Meaning::Diameter(true), "X is a diameter"),
    g(80, BOTH, group::LATHE, Meaning::Diameter(false), "X is a radius"),
    g(80, FANUC, group::ONCE, Meaning::Mode, "look-ahead (P): no effect"),
    g(90, FANUC, group::ONCE, Meaning::StopOnce, "exact stop at the end of this block"),
    g(100, ALL, group::NON_MODAL, Meaning::Store, "L2, L20: store a zero offset"),
    g(110, FANUC, group::ONCE, Meaning::Nothing, "end of data setting"),
    g(150, ALL, group::POLAR, Meaning::Nothing, "no polar coordinates"),
    g(160, FANUC, group::POLAR, Meaning::Later(PLAIN), "polar coordinates"),
    g(170, ALL, group::PLANE, Meaning::Plane(Plane::G17), "plane XY"),
    g(180, ALL, group::PLANE, Meaning::Plane(Plane::G18), "plane ZX"),
    g(190, ALL, group::PLANE, Meaning::Plane(Plane::G19), "plane YZ"),
    g(200, ALL, group::UNITS, Meaning::Inch(true), "inch"),
    g(210, ALL, group::UNITS, Meaning::Inch(false), "millimetre"),
    g(
        220,
        FANUC,
        group::ONCE,
        Meaning::Later("software limits of the machine data"),
        "stored stroke check on",
    ),
    g(230, FANUC, group::CHECK, Meaning::Nothing, "stored stroke check off"),
    g(270, FANUC, group::NON_MODAL, Meaning::Later("G28"), "check of the reference point"),
    g(280, ALL, group::NON_MODAL, Meaning::Home(0), "rapid to the first stored place"),
    g(281, BOTH, group::NON_MODAL, Meaning::StoreHome(0), "store the first place"),
    g(290, FANUC, group::NON_MODAL, Meaning::Later("G0"), "back from the reference point"),
    g(300, ALL, group::NON_MODAL, Meaning::Home(1), "rapid to the second stored place"),
    g(301, BOTH, group::NON_MODAL, Meaning::StoreHome(1), "store the second place"),
    g(310, FANUC, group::NON_MODAL, Meaning::Later("G1"), "skip signal"),
    g(330, ALL, group::MOTION, Meaning::Later(SYNCHRONISED), "motion with the spindle"),
    g(331, BOTH, group::MOTION, Meaning::Later(SYNCHRONISED), "rigid tapping"),
    g(382, BOTH, group::MOTION, Meaning::Probe(2), "probe towards, with an error"),
    g(383, BOTH, group::MOTION, Meaning::Probe(3), "probe towards"),
    g(384, BOTH, group::MOTION, Meaning::Probe(4), "probe away, with an error"),
    g(385, BOTH, group::MOTION, Meaning::Probe(5), "probe away"),
    g(400, ALL, group::RADIUS, Meaning::Nothing, "no tool radius compensation"),
    g(410, ALL, group::RADIUS, Meaning::Later(COMPENSATED), "tool radius compensation, left"),
    g(411, BOTH, group::RADIUS, Meaning::Later(COMPENSATED), "tool radius compensation, left"),
    g(420, ALL, group::RADIUS, Meaning::Later(COMPENSATED), "tool radius compensation, right"),
    g(421, BOTH, group::RADIUS, Meaning::Later(COMPENSATED), "tool radius compensation, right"),
    g(430, ALL, group::LENGTH, Meaning::Length, "tool length of H"),
    g(431, BOTH, group::LENGTH, Meaning::LengthNow, "tool length from this block"),
    g(432, BOTH, group::LENGTH, Meaning::Later("one tool length, G43"), "a further tool length"),
    g(440, FANUC, group::LENGTH, Meaning::LengthMinus, "tool length of H, the other way"),
    g(490, ALL, group::LENGTH, Meaning::NoLength, "no tool length"),
    g(500, ALL, group::SCALING, Meaning::Nothing, "no scaling"),
    g(501, FANUC, group::MIRRORING, Meaning::Nothing, "no mirroring"),
    g(510, FANUC, group::SCALING, Meaning::Later(PLAIN), "scaling"),
    g(511, FANUC, group::MIRRORING, Meaning::Later(PLAIN), "mirroring"),
    g(510, BOTH, group::SCALING, Meaning::Later("coordinates of the final size"), "scaling"),
    g(520, FULL, group::NON_MODAL, Meaning::Local, "temporary offset"),
    g(530, ALL, group::NON_MODAL, Meaning::Machine, "machine coordinates in this block"),
    g(540, ALL, group::OFFSET, Meaning::Offset(0), "zero offset 1"),
    g(541, FANUC, group::OFFSET, Meaning::Later("G54 to G59"), "further zero offsets"),
    g(550, ALL, group::OFFSET, Meaning::Offset(1), "zero offset 2"),
    g(560, ALL, group::OFFSET, Meaning::Offset(2), "zero offset 3"),
    g(570, ALL, group::OFFSET, Meaning::Offset(3), "zero offset 4"),
    g(580, ALL, group::OFFSET, Meaning::Offset(4), "zero offset 5"),
    g(590, ALL, group::OFFSET, Meaning::Offset(5), "zero offset 6"),
    g(591, BOTH, group::OFFSET, Meaning::Offset(6), "zero offset 7"),
    g(592, BOTH, group::OFFSET, Meaning::Offset(7), "zero offset 8"),
    g(593, BOTH, group::OFFSET, Meaning::Offset(8), "zero offset 9"),
    g(600, FANUC, group::ONCE, Meaning::Later("G0 from the wanted side"), "approach from one side"),
    g(610, BOTH, group::PATH, Meaning::ExactPath, "exact path"),
    g(610, FANUC, group::PATH, Meaning::ExactStop, "exact stop"),
    g(611, LINUXCNC, group::PATH, Meaning::ExactStop, "exact stop"),
    g(640, BOTH, group::PATH, Meaning::Blend, "rounded corners, P the largest deviation"),
    g(640, FANUC, group::PATH, Meaning::ExactPath, "no stop between blocks; corners as programmed"),
    g(650, FANUC, group::NON_MODAL, Meaning::Later(MACRO), "macro call"),
    g(660, FANUC, group::NON_MODAL, Meaning::Later(MACRO), "modal macro call"),
    g(670, FANUC, group::MACRO, Meaning::Nothing, "no modal macro call"),
    g(680, FANUC, group::ROTATION, Meaning::Later(PLAIN), "rotation"),
    g(690, ALL, group::ROTATION, Meaning::Nothing, "no rotation"),
    g(
        700,
        LINUXCNC,
        group::UNITS,
        Meaning::Inch(true),
        "inch, as Mach3 has it: not LinuxCNC's turning cycle",
    ),
    g(
        710,
        LINUXCNC,
        group::UNITS,
        Meaning::Inch(false),
        "millimetre, as Mach3 has it: not LinuxCNC's turning cycle",
    ),
    g(730, ALL, group::MOTION, Meaning::Cycle(CycleKind::Break), "drill with chip breaking"),
    g(740, FULL, group::MOTION, Meaning::Cycle(CycleKind::TapLeft), "left-hand tapping, not synchronised"),
    g(760, BOTH, group::MOTION, Meaning::Later(SYNCHRONISED), "threading"),
    g(760, FANUC, group::MOTION, Meaning::Later(ORIENTED), "fine boring"),
    g(800, ALL, group::CYCLE_END, Meaning::NoMotion, "end of cycles"),
    g(810, ALL, group::MOTION, Meaning::Cycle(CycleKind::Drill), "drill"),
    g(820, ALL, group::MOTION, Meaning::Cycle(CycleKind::Dwell), "drill with dwell P"),
    g(830, ALL, group::MOTION, Meaning::Cycle(CycleKind::Peck), "deep drill in pecks of Q"),
    g(840, ALL, group::MOTION, Meaning::Cycle(CycleKind::Tap), "tapping, not synchronised, P dwell"),
    g(850, ALL, group::MOTION, Meaning::Cycle(CycleKind::Bore), "bore, out at feed"),
    g(860, ALL, group::MOTION, Meaning::Cycle(CycleKind::BoreStop), "bore, dwell P, spindle stop, rapid out"),
    g(870, FULL, group::MOTION, Meaning::Later(ORIENTED), "back boring"),
    g(880, FULL, group::MOTION, Meaning::Later(ORIENTED), "bore, out by hand"),
    g(890, ALL, group::MOTION, Meaning::Cycle(CycleKind::BoreDwell), "bore with dwell P, out at feed"),
    g(1870, FANUC, group::ONCE, Meaning::Mode, "smoothness (P, E): no effect"),
    g(900, ALL, group::DISTANCE, Meaning::Relative(false), "absolute coordinates"),
    g(901, LINUXCNC, group::CENTRE, Meaning::CentreAbsolute(true), "absolute arc centres"),
    g(910, ALL, group::DISTANCE, Meaning::Relative(true), "incremental coordinates"),
    g(911, BOTH, group::CENTRE, Meaning::CentreAbsolute(false), "arc centres from the start"),
    g(920, ALL, group::NON_MODAL, Meaning::Here, "this place has these coordinates"),
    g(921, BOTH, group::NON_MODAL, Meaning::HereClear, "clear the offsets of G92"),
    g(922, LINUXCNC, group::NON_MODAL, Meaning::HereOff, "suspend the offsets of G92"),
    g(923, LINUXCNC, group::NON_MODAL, Meaning::HereBack, "bring the offsets of G92 back"),
    g(930, ALL, group::FEED, Meaning::ByTime(true), "inverse time feed: F blocks per minute"),
    g(940, ALL, group::FEED, Meaning::ByTime(false), "feed per minute"),
    g(950, ALL, group::FEED, Meaning::PerTurn, "feed per revolution, from the programmed S"),
    g(
        960,
        LINUXCNC,
        group::SPINDLE_MODE,
        Meaning::Surface(true),
        "constant surface speed S, at most D: put out block by block",
    ),
    g(960, FANUC, group::SPINDLE_MODE, Meaning::Later(OF_MILLS), "constant surface speed, of lathes"),
    g(970, ALL, group::SPINDLE_MODE, Meaning::Surface(false), "S in 1/min"),
    g(980, ALL, group::LEVEL, Meaning::ToLevel(false), "cycles end at the old level"),
    g(990, ALL, group::LEVEL, Meaning::ToLevel(true), "cycles end at R"),
    m(0, ALL, group::STOP, Meaning::Pause, "pause"),
    m(1, ALL, group::STOP, Meaning::OptionalPause, "pause if the switch is on"),
    m(2, ALL, group::STOP, Meaning::End, "program end"),
    m(3, ALL, group::SPINDLE, Meaning::Spindle, "spindle clockwise"),
    m(4, ALL, group::SPINDLE, Meaning::Spindle, "spindle counter-clockwise"),
    m(5, ALL, group::SPINDLE, Meaning::Spindle, "spindle off"),
    m(6, ALL, group::TOOL, Meaning::Change, "tool change, waits"),
    m(7, ALL, group::MIST, Meaning::Coolant, "mist on"),
    m(8, ALL, group::FLOOD, Meaning::Coolant, "flood on"),
    m(9, ALL, group::FLOOD, Meaning::Coolant, "coolant off"),
    m(19, FULL, group::SPINDLE, Meaning::Orient, "spindle orientation"),
    m(30, ALL, group::STOP, Meaning::End, "program end"),
    m(48, ALL, group::OVERRIDE, Meaning::Nothing, "overrides on"),
    m(49, ALL, group::OVERRIDE, Meaning::Override, "overrides off"),
    m(50, BOTH, group::OVERRIDE, Meaning::Override, "feed override on or off"),
    m(51, BOTH, group::OVERRIDE, Meaning::Override, "spindle override on or off"),
    m(52, LINUXCNC, group::OVERRIDE, Meaning::Override, "adaptive feed"),
    m(53, BOTH, group::OVERRIDE, Meaning::Override, "feed stop switch"),
    m(56, GRBL, group::OVERRIDE, Meaning::Override, "parking override"),
    m(60, BOTH, group::STOP, Meaning::Pause, "pause for a pallet"),
    m(61, BOTH, group::TOOL, Meaning::ToolNumber, "set the tool number"),
    m(62, BOTH, group::OUTPUT, Meaning::Digital(true, false), "digital output P on with the motion"),
    m(63, BOTH, group::OUTPUT, Meaning::Digital(false, false), "digital output P off with the motion"),
    m(64, BOTH, group::OUTPUT, Meaning::Digital(true, true), "digital output P on"),
    m(65, BOTH, group::OUTPUT, Meaning::Digital(false, true), "digital output P off"),
    m(66, BOTH, group::OUTPUT, Meaning::Input, "wait for input P or E: L0 to L4, at most Q seconds"),
    m(67, BOTH, group::OUTPUT, Meaning::Analog(false), "analogue output E with the motion, value Q"),
    m(68, BOTH, group::OUTPUT, Meaning::Analog(true), "analogue output E, value Q"),
    m(70, BOTH, group::USER, Meaning::Save(false), "save modal state"),
    m(71, BOTH, group::USER, Meaning::Forget, "forget saved modal state"),
    m(72, BOTH, group::USER, Meaning::Restore, "restore modal state"),
    m(
        73,
        BOTH,
        group::USER,
        Meaning::Save(true),
        "save modal state, and restore it where the subroutine ends",
    ),
    m(96, FANUC, group::USER, Meaning::Later(MACRO), "interruption by a macro"),
    m(97, FANUC, group::USER, Meaning::Later("M98 and an O number"), "call of a block number"),
    m(98, ALL, group::USER, Meaning::Call, "call the subprogram with number P, L times"),
    m(99, ALL, group::USER, Meaning::Return, "return from the subprogram"),
    m(
        198,
        FANUC,
        group::USER,
        Meaning::Later("M98 and the subprogram in the same text"),
        "call of another file",
    ),
    USER,
];

/// An entry of the table of letters with values.
#[derive(Clone, Copy)]
pub struct AddressEntry {
    /// The letter.
    pub letter: char,
    /// The meaning of the value, in plain words.
    pub text: &'static str,
    dialects: u8,
}

impl AddressEntry {
    /// Whether the dialect has the letter.
    pub const fn is_in(&self, dialect: Dialect) -> bool {
        self.dialects & bit(dialect) != 0
    }
}

const fn letter(letter: char, dialects: u8, text: &'static str) -> AddressEntry {
    AddressEntry { letter, text, dialects }
}

/// Letters with values, and their meaning.
pub static ADDRESSES: &[AddressEntry] = &[
    letter('A', ALL, "axis (also B C U V W X Y Z, as the machine has them)"),
    letter('D', BOTH, "back-off of G73, highest spindle speed of G96"),
    letter('D', FANUC, "tool radius: no effect without G41, which is refused"),
    letter('E', BOTH, "analogue port of M66 to M68"),
    letter('F', ALL, "feed per minute; G93: blocks per minute; G95: per revolution"),
    letter('H', ALL, "tool of G43"),
    letter('I', ALL, "arc centre along X (J along Y, K along Z)"),
    letter('K', FANUC, "repeats of a cycle"),
    letter('L', ALL, "repeats of a cycle and of M98, kind of G10"),
    letter('L', BOTH, "what M66 waits for"),
    letter('N', ALL, "line number"),
    letter('O', BOTH, "program number, or label of sub, call, if, while, do, repeat"),
    letter('O', FANUC, "program number; `:` means the same"),
    letter('#', BOTH, "parameter: number, or name in < >"),
    letter(
        'P',
        BOTH,
        "seconds, turns of an arc, tolerance of G64, zero offset of G10, port of M62 to M66, subprogram of M98",
    ),
    letter(
        'P',
        FANUC,
        "milliseconds, or seconds with a decimal point; zero offset of G10; subprogram of M98, its last four digits, with repeats before them",
    ),
    letter('Q', BOTH, "peck of G73 and G83, merging of G64, value of M67 and M68, time of M66"),
    letter('Q', FANUC, "peck of G73 and G83"),
    letter('R', ALL, "radius of an arc, level of a cycle"),
    letter('S', ALL, "spindle speed"),
    letter('T', ALL, "tool"),
];
