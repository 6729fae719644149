//! Questions of a PLC to the planner about the coming motion: one request at a time, and its answer.
//!
//! The PLC asks with [`QuestionUnit::ask`]. The planner's task calls [`crate::Planner::answer`] between two
//! calls of [`crate::Planner::poll`]. The PLC then reads [`QuestionUnit::answer`]. Neither side waits for the
//! other.
use super::unit::Pending;
use crate::quantity::{Distance, Position, Speed};
use core::sync::atomic::{AtomicU32, Ordering};

/// A question of a PLC about the coming motion. P-CHAN-00650 enables each kind of question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// FCT_CALC_STATE_AT_T: the state at the tick `n` ticks ahead; 1 is the next tick.
    StateAt(u32),
    /// FCT_CALC_TIME: at which tick the next motion block at feed begins.
    NextFeed,
    /// FCT_CALC_POS_V_0: where and when the axes would stop if a feed hold came now.
    Standstill,
}

/// A future moment: the values that [`crate::Status`] will show if no command comes before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment<const AXES: usize> {
    /// Number of the tick, counted as in [`crate::Output::tick`].
    pub tick: u32,
    /// Ticks from now to this tick; 1 is the next tick.
    pub ticks: u32,
    /// The set point of every axis before its filters, mm or degrees.
    pub set_points: [Position; AXES],
    /// N number of the programmed block.
    pub n: u32,
    /// Number of the motion block, counted since the split; the same number as `block` of [`crate::Status`].
    pub block: u32,
    /// Path distance, mm.
    pub distance: Distance,
    /// Mean speed of the set points over the tick, along the feed axes, mm/tick.
    pub speed: Speed,
}

/// The reason why the planner has no answer to a [`Question`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// P-CHAN-00650 does not enable this kind of question. The text is the name of the function.
    NotEnabled(&'static str),
    /// The question is about a tick beyond the planned motion.
    Beyond {
        /// Number of planned ticks.
        ticks: u32,
    },
    /// The planner is changing the plan, or a stop is in progress: ask again after a tick.
    Busy,
    /// The search for the answer continues: ask again at once.
    Searching,
    /// The answer depends on blocks that are not planned yet: ask again later.
    NotPlanned,
}

impl core::fmt::Display for Unknown {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NotEnabled(name) => write!(
                f,
                "the question is not enabled; expected {name} in configuration.interpolator.function (P-CHAN-00650)"
            ),
            Self::Beyond { ticks } => write!(f, "only {ticks} ticks from now are planned; ask for fewer"),
            Self::Busy => f.write_str("the plan is changing; ask again after a tick"),
            Self::Searching => f.write_str("the answer is being looked for; ask again at once"),
            Self::NotPlanned => {
                f.write_str("the answer depends on blocks that are not planned yet; ask later")
            }
        }
    }
}

impl core::error::Error for Unknown {}

/// Names of functions in [`Unknown::NotEnabled`], by their number in an answer.
const NAMES: [&str; 3] = ["FCT_CALC_STATE_AT_T", "FCT_CALC_TIME", "FCT_CALC_POS_V_0"];

impl Question {
    /// The function of P-CHAN-00650 that answers the question.
    pub const fn function(self) -> &'static str {
        let [state, time, stand] = NAMES;
        match self {
            Self::StateAt(_) => state,
            Self::NextFeed => time,
            Self::Standstill => stand,
        }
    }

    const fn to_words(self) -> [u32; 2] {
        match self {
            Self::StateAt(ticks) => [0, ticks],
            Self::NextFeed => [1, 0],
            Self::Standstill => [2, 0],
        }
    }

    const fn of_words([kind, ticks]: [u32; 2]) -> Self {
        match kind {
            0 => Self::StateAt(ticks),
            1 => Self::NextFeed,
            _ => Self::Standstill,
        }
    }
}

/// Words of an answer without set points.
const WORDS: usize = 9;

/// A request and its answer, between a PLC and the planner. All bits are zero when new, so a static value
/// lies in `.bss`.
///
/// One task or interrupt asks; the planner's task answers.
pub struct QuestionUnit<const AXES: usize> {
    /// 0: none, 1: asked, 2: answered.
    state: AtomicU32,
    question: [AtomicU32; 2],
    /// Kind of the answer, and its data.
    words: [AtomicU32; WORDS],
    set_points: [[AtomicU32; 2]; AXES],
}

const ASKED: u32 = 1;
const ANSWERED: u32 = 2;

impl<const AXES: usize> QuestionUnit<AXES> {
    /// A unit without a question.
    pub const fn new() -> Self {
        Self {
            state: AtomicU32::new(0),
            question: [const { AtomicU32::new(0) }; 2],
            words: [const { AtomicU32::new(0) }; WORDS],
            set_points: [const { [const { AtomicU32::new(0) }; 2] }; AXES],
        }
    }

    /// Asks a question. Only the PLC calls this function. The call discards the answer to the previous
    /// question.
    ///
    /// # Errors
    /// The previous question is not answered yet; nothing has changed.
    pub fn ask(&self, question: Question) -> Result<(), Pending> {
        if self.state.load(Ordering::Acquire) == ASKED {
            return Err(Pending);
        }
        self.question
            .iter()
            .zip(question.to_words())
            .for_each(|(word, value)| word.store(value, Ordering::Relaxed));
        self.state.store(ASKED, Ordering::Release);
        Ok(())
    }

    /// The unanswered question. Only the planner calls this function.
    pub fn pending(&self) -> Option<Question> {
        let [kind, ticks] = &self.question;
        (self.state.load(Ordering::Acquire) == ASKED)
            .then(|| Question::of_words([kind, ticks].map(|word| word.load(Ordering::Relaxed))))
    }

    /// Writes an answer. Only the planner calls this function.
    pub fn put(&self, answer: &Result<Moment<AXES>, Unknown>) {
        let words = match answer {
            Ok(moment) => {
                let Moment { tick, ticks, set_points, n, block, distance, speed } = moment;
                for (place, point) in self.set_points.iter().zip(set_points) {
                    store(place, point.to_bits());
                }
                let [d, v] =
                    [distance.to_bits(), speed.to_bits()].map(|bits| [bits as u32, (bits >> 32) as u32]);
                [1, *tick, *ticks, *n, *block, d[0], d[1], v[0], v[1]]
            }
            Err(unknown) => {
                let (kind, value) = match unknown {
                    Unknown::NotEnabled(name) => {
                        (2, NAMES.iter().position(|known| known == name).unwrap_or(0) as u32)
                    }
                    Unknown::Beyond { ticks } => (3, *ticks),
                    Unknown::Busy => (4, 0),
                    Unknown::Searching => (5, 0),
                    Unknown::NotPlanned => (6, 0),
                };
                [kind, value, 0, 0, 0, 0, 0, 0, 0]
            }
        };
        self.words.iter().zip(words).for_each(|(word, value)| word.store(value, Ordering::Relaxed));
        self.state.store(ANSWERED, Ordering::Release);
    }

    /// The answer, if there is one. Only the PLC calls this function.
    pub fn answer(&self) -> Option<Result<Moment<AXES>, Unknown>> {
        if self.state.load(Ordering::Acquire) != ANSWERED {
            return None;
        }
        let mut words = [0; WORDS];
        words.iter_mut().zip(&self.words).for_each(|(value, word)| *value = word.load(Ordering::Relaxed));
        let [kind, tick, ticks, n, block, d0, d1, v0, v1] = words;
        let mut set_points = [Position::ZERO; AXES];
        set_points
            .iter_mut()
            .zip(&self.set_points)
            .for_each(|(point, place)| *point = Position::from_bits(load(place)));
        Some(match kind {
            2 => Err(Unknown::NotEnabled(NAMES.get(tick as usize).copied().unwrap_or_default())),
            3 => Err(Unknown::Beyond { ticks: tick }),
            4 => Err(Unknown::Busy),
            5 => Err(Unknown::Searching),
            6 => Err(Unknown::NotPlanned),
            _ => {
                let distance = Distance::from_bits(whole(d0, d1));
                let speed = Speed::from_bits(whole(v0, v1));
                Ok(Moment { tick, ticks, set_points, n, block, distance, speed })
            }
        })
    }
}

const fn whole(lower: u32, upper: u32) -> i64 {
    ((upper as u64) << 32 | lower as u64) as i64
}

fn store([lower, upper]: &[AtomicU32; 2], bits: i64) {
    lower.store(bits as u32, Ordering::Relaxed);
    upper.store((bits >> 32) as u32, Ordering::Relaxed);
}

fn load([lower, upper]: &[AtomicU32; 2]) -> i64 {
    whole(lower.load(Ordering::Relaxed), upper.load(Ordering::Relaxed))
}

impl<const AXES: usize> Default for QuestionUnit<AXES> {
    fn default() -> Self {
        Self::new()
    }
}
