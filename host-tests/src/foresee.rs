//! Questions about the coming motion at random moments of random programs, compared with the later motion.
use crate::calls::call;
use crate::cases::random::Random;
use crate::cases::set_point;
use crate::soak;
use glidepath::channel::{Channel, Handles, Inquiry};
use glidepath::contour_log::{Moment, Question, Unknown};
use glidepath::machine::{InterpolatorData, MachineData, SynchTable};
use glidepath::operator::Status;
use glidepath::quantity::{Distance, Position, Speed};
use glidepath::tick::State;

/// Comparison of the answers of a kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Questions with an answer that was compared.
    pub compared: u32,
    /// Questions without an answer: beyond the planned motion, busy or searching, or dependent on unplanned
    /// blocks.
    pub unknown: [u32; 3],
    /// Largest difference of speed, as part of the speed.
    pub speed: f64,
    /// Largest difference of a position, nm.
    pub nm: f64,
    /// Largest difference of time, ticks.
    pub ticks: u32,
    /// Other differences: N or block.
    pub other: u32,
    /// Wrong answers: by more than 0.1 %, 1 nm or one tick.
    pub off: u32,
}

impl Tally {
    fn unanswered(&mut self, unknown: Unknown) {
        match unknown {
            Unknown::Beyond { .. } => self.unknown[0] += 1,
            Unknown::Busy | Unknown::Searching => self.unknown[1] += 1,
            Unknown::NotPlanned => self.unknown[2] += 1,
            Unknown::NotEnabled(name) => panic!("{name} is not enabled"),
        }
    }

    fn compare(&mut self, moment: &Moment<3>, status: &Status<3>) {
        let nm = points_apart(&moment.set_points, &status.set_points);
        let [told, driven] = [moment.speed, status.speed].map(|speed| speed.to_bits() as f64);
        let speed = (told - driven).abs() / driven.abs().max((1u64 << 30) as f64);
        self.compared += 1;
        (self.nm, self.speed) = (self.nm.max(nm), self.speed.max(speed));
        self.other += u32::from((moment.n, moment.block) != (status.n, status.block));
        self.off += u32::from(nm > 1.0 || speed > 1e-3);
    }
}

/// Comparison for all kinds of questions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Told {
    /// FCT_CALC_STATE_AT_T.
    pub state: Tally,
    /// FCT_CALC_TIME.
    pub feed: Tally,
    /// FCT_CALC_POS_V_0.
    pub stand: Tally,
    /// Ticks from a hold to its standstill, in total.
    pub stopping: u64,
}

fn points_apart(a: &[Position; 3], b: &[Position; 3]) -> f64 {
    let apart = a.iter().zip(b).map(|(a, b)| (a.to_bits() - b.to_bits()).unsigned_abs());
    apart.max().unwrap_or(0) as f64 / 4294.967296
}

/// The machine with every function, and no function that waits.
pub fn asked(machine: &MachineData<3>) -> MachineData<3> {
    let mut machine = *machine;
    machine.channel.interpolator = InterpolatorData::ALL;
    (machine.channel.m_synch, machine.channel.h_synch) = (SynchTable::NONE, SynchTable::NONE);
    machine.channel.look_ahead = machine.channel.look_ahead.min(120);
    machine
}

/// Actions of a run at random moments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asks {
    /// Asks for the state at a later tick, and for the next block at feed.
    States,
    /// Asks for the end of a hold, and holds.
    Stops,
    /// Holds, with machine data that permit a search for a shorter stop.
    Nothing,
}

/// A run of the program of a seed with a slope.
pub fn run(seed: u64, slope: u8, asks: Asks, told: &mut Told) {
    let setup = soak::setup::<3>(seed, false);
    let mut machine = asked(&setup.machine);
    machine.channel.slope_profile = slope;
    if asks == Asks::Nothing {
        machine.channel.interpolator = InterpolatorData::ISG;
    }
    let start = std::array::from_fn(|k| Position::from_bits(set_point(setup.program.start[k])));
    let mut inquiry = Box::new(Inquiry::new());
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let text = setup.text();
    let handles = channel.split(&machine, start, text.as_bytes()).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    planner.foresee(&mut inquiry);
    let mut random = Random::new(seed ^ 0x666f_7265_7365_6521);
    let mut next = 5 + random.bits() % 60;
    let mut open: Vec<(Question, Moment<3>)> = Vec::new();
    let mut held: Option<(Moment<3>, u32, Option<u32>, u32)> = None;
    let mut before = operator.status();
    let mut last = u32::MAX;
    for tick in 0..30_000u64 {
        let Ok(done) = call(&mut planner, 1_000_000, |_| {}) else { return };
        if tick >= next && held.is_none() {
            next = tick + 3 + random.bits() % 80;
            if asks == Asks::Nothing {
                operator.feed_hold();
                let at_rest = Moment {
                    tick: 0,
                    ticks: 0,
                    set_points: [Position::ZERO; 3],
                    n: 0,
                    block: 0,
                    distance: Distance::ZERO,
                    speed: Speed::ZERO,
                };
                held = Some((at_rest, tick as u32, None, 0));
            } else if asks == Asks::Stops {
                // As often as needed; the planner works between two ticks.
                let mut answer = Err(Unknown::Searching);
                while answer == Err(Unknown::Searching) {
                    answer = planner.forecast(Question::Standstill);
                }
                match answer {
                    Ok(moment) => {
                        operator.feed_hold();
                        held = Some((moment, tick as u32, None, 0));
                        let _ = call(&mut planner, 1_000_000, |_| {});
                    }
                    Err(unknown) => told.stand.unanswered(unknown),
                }
            } else {
                let ahead = 1 + (random.bits() % if random.once_in(2) { 20 } else { 300 }) as u32;
                for question in [Question::StateAt(ahead), Question::NextFeed] {
                    match planner.forecast(question) {
                        Ok(moment) => open.push((question, moment)),
                        Err(unknown) => told.of(question).unanswered(unknown),
                    }
                }
            }
        }
        let earlier = core::mem::replace(&mut last, before.block);
        before = operator.status();
        let state = interpolator.tick();
        while operator.output().is_some() {}
        let status = operator.status();
        open.retain(|(question, moment)| {
            let is_due = moment.tick + 1 == status.ticks;
            if is_due {
                let tally = told.of(*question);
                tally.compare(moment, &status);
                if *question == Question::NextFeed && before.block == status.block {
                    tally.ticks = tally.ticks.max(if earlier == status.block { u32::MAX } else { 1 });
                }
            }
            !is_due
        });
        if let Some((moment, since, arrived, active)) = &mut held {
            if state == State::Active {
                *active = status.ticks - 1;
            }
            let is_there = status.set_points == moment.set_points;
            if is_there && arrived.is_none() {
                *arrived = Some(status.ticks - 1);
            }
            if state == State::Idle && planner.is_holding() {
                let nm = points_apart(&moment.set_points, &status.set_points);
                // At the end of a stop, set points may not differ for some ticks.
                let apart = arrived.map_or(u32::MAX, |first| {
                    let active = &(*active).max(first);
                    moment.tick.abs_diff(moment.tick.clamp(first.min(*active), *active))
                });
                let tally = &mut told.stand;
                tally.compared += 1;
                (tally.nm, tally.ticks) = (tally.nm.max(nm), tally.ticks.max(apart));
                tally.off += u32::from(nm > 1.0 || apart > 1);
                told.stopping += tick - u64::from(*since);
                operator.resume();
                held = None;
                next = tick + 3 + random.bits() % 80;
                continue;
            }
        }
        if done && state == State::Idle {
            return;
        }
    }
}

impl Told {
    fn of(&mut self, question: Question) -> &mut Tally {
        match question {
            Question::StateAt(_) => &mut self.state,
            Question::NextFeed => &mut self.feed,
            Question::Standstill => &mut self.stand,
        }
    }
}
