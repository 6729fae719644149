//! The steps of a session.
use super::Done;
use super::bench::{Acts, Bench, Seen, Source, TOO_LONG, Watched};
use super::lines::{self, Line};
use super::model::{Effect, Modal, Model, bits, eighths};
use crate::beside::{BLOCKS, OVERLAYS, TAPS};
use crate::cases::random::Random;
use crate::operate::{Act, random_acts, with_overrides, with_stalls, with_starvation};
use glidepath::channel::Channel;
use glidepath::fir::{FilterPlan, FilterTick, Filters};
use glidepath::machine::{FilterType, MachineData};
use glidepath::quantity::Position;
use std::cell::Cell;
use std::collections::VecDeque;
use std::fmt::Write;
use std::rc::Rc;

/// An oscillation or an independent axis may be slower than can be planned.
const SLOW: &str = "longer than can be planned";

/// How the program before came to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ending {
    /// M30, or the end of a text.
    Program,
    /// A line was refused.
    Refused,
    /// An abort, maybe.
    Aborted,
    /// A stream has no text.
    Open,
}

/// A session.
pub struct Session<'m> {
    machine: &'m MachineData<3>,
    random: Random,
    polls: usize,
    model: Model,
    /// Lines that were handed over and not carried out, with their numbers in the text.
    rest: VecDeque<Line>,
    ending: Ending,
    /// The steps so far.
    log: String,
    done: Done,
}

/// How a step begins.
enum Begin {
    Load,
    Continue,
    Next,
    GoOn,
    /// More of a stream.
    More,
}

impl<'m> Session<'m> {
    /// From power-up on.
    pub fn new(machine: &'m MachineData<3>, start: [Position; 3], random: Random, polls: usize) -> Self {
        let model = Model {
            at: start.map(Position::to_bits),
            known: [true; 3],
            zeros: [[0; 3]; 6],
            modal: Modal::START,
        };
        Self {
            machine,
            random,
            polls,
            model,
            rest: VecDeque::new(),
            ending: Ending::Open,
            log: String::new(),
            done: Done::default(),
        }
    }

    /// Runs it.
    pub fn run<P: FilterPlan<3>, I: FilterTick<3>>(
        mut self,
        mut bench: Bench<'_, '_, P, I>,
    ) -> Result<Done, String> {
        let streams = bench.feeder.is_some();
        self.ending = if streams { Ending::Open } else { Ending::Program };
        if !streams {
            // The first text is empty.
            bench.run(Acts::new(), self.polls, true, Free)?;
        }
        for step in 0..3 + self.random.bits() % 6 {
            let judged = self.between(&mut bench, step == 0).and_then(|()| self.step(&mut bench, streams));
            match judged {
                Err(what) if what == TOO_LONG || what.contains(SLOW) => break,
                Err(what) => return Err(format!("step {step}: {what}\n{}", self.log)),
                Ok(()) => self.done.steps += 1,
            }
        }
        self.done.ticks = bench.all.axes[0].len();
        let slope = self.machine.channel.slope_profile;
        let kept = bench.all.keeps_limits(self.machine, slope, true);
        kept.map_err(|what| format!("{what}\n{}", self.log))?;
        Ok(self.done)
    }

    fn log(&mut self, what: impl std::fmt::Display) {
        let _ = writeln!(self.log, "{what}");
    }

    /// At rest: positions, zero offsets, jog, commands that have nothing to act on.
    fn between<P: FilterPlan<3>, I: FilterTick<3>>(
        &mut self,
        bench: &mut Bench<'_, '_, P, I>,
        first: bool,
    ) -> Result<(), String> {
        for _ in 0..self.random.bits() % 4 {
            let axis = (self.random.bits() % 3) as usize;
            match self.random.bits() % 8 {
                0 | 1 => {
                    let to = eighths(&mut self.random, 160);
                    self.log(format!("position {axis} {}", to as f64 / 8.0));
                    bench.set_position(axis, bits(to))?;
                    (self.model.at[axis], self.model.known[axis]) = (bits(to), true);
                }
                2 => {
                    let (set, to) = ((self.random.bits() % 6) as usize, eighths(&mut self.random, 64));
                    self.log(format!("offset {set} {axis} {}", to as f64 / 8.0));
                    let offset = Position::from_bits(bits(to));
                    bench.planner.set_zero_offset(set, axis, offset).map_err(|error| error.to_string())?;
                    self.model.zeros[set][axis] = to;
                }
                3 | 4 if !first && self.ending != Ending::Open => self.jog(bench, axis)?,
                5 if !first => {
                    self.log("abort at rest");
                    bench.operator.abort();
                    bench.rest(1 + (self.random.bits() % 3) as usize, self.polls)?;
                    self.abort();
                }
                _ => {
                    let ticks = (self.random.bits() % 5) as usize;
                    self.log(format!("{ticks} ticks"));
                    bench.rest(ticks, self.polls)?;
                }
            }
        }
        Ok(())
    }

    /// An axis moves alone; stopped on the way now and then.
    fn jog<P: FilterPlan<3>, I: FilterTick<3>>(
        &mut self,
        bench: &mut Bench<'_, '_, P, I>,
        axis: usize,
    ) -> Result<(), String> {
        let mut effect = Effect { beside: true, ..Effect::new(&self.model) };
        let second = (axis + 1) % 3;
        let axes = if self.random.once_in(2) { vec![axis] } else { vec![axis, second] };
        for &axis in &axes {
            let to = eighths(&mut self.random, 160);
            let feed = if self.random.once_in(2) { None } else { Some(self.random.magnitude(300.0, 9000.0)) };
            self.log(format!("jog {axis} {} {feed:?}", to as f64 / 8.0));
            let feed = feed.map(|feed| glidepath::quantity::Feed::from_num(feed));
            let moved = bench.planner.move_axis(axis, Position::from_bits(bits(to)), feed);
            if let Err(error) = moved {
                // Until the first one has begun.
                let waits = axis == second && error == glidepath::channel::MoveError::NotAtRest;
                self.log(format!("  {error}"));
                if waits {
                    continue;
                } else {
                    return Err(format!("jog: {error}"));
                };
            }
            effect.reaches(axis, bits(to));
            self.model.at[axis] = bits(to);
        }
        let mut acts = Acts::new();
        let stop = self.random.once_in(3);
        if self.random.once_in(4) {
            acts.extend([(3, Act::Hold), (60, Act::Resume)]);
        }
        if stop {
            if self.random.once_in(2) {
                self.log("jog is aborted");
                acts.push_back((self.random.magnitude(1.0, 300.0) as usize, Act::Abort));
            } else {
                self.log("jog is stopped");
                bench.planner.stop_axis(axis);
            }
        }
        self.log(format!("{acts:?}"));
        let aborts = acts.iter().any(|(_, act)| *act == Act::Abort);
        let seen = bench.run(acts, self.polls, true, Watched::new(&effect, None))?;
        if !seen.errors.is_empty() || !seen.outputs.is_empty() {
            return Err(format!("jog: {:?}, {:?}", seen.errors, seen.outputs));
        }
        if stop {
            self.model.at = bench.stands();
        }
        if aborts {
            self.abort();
        }
        self.stands(bench.stands())
    }

    /// Drops the read lines and the modal state.
    fn abort(&mut self) {
        self.ending = Ending::Aborted;
        self.rest.clear();
        self.model.modal = Modal::START;
    }

    fn stands(&self, at: [i64; 3]) -> Result<(), String> {
        for axis in 0..3 {
            if self.model.known[axis] && at[axis] != self.model.at[axis] {
                let [at, told] = [at[axis], self.model.at[axis]].map(|x| x as f64 / (1_u64 << 32) as f64);
                return Err(format!("axis {axis} stands at {at}, told {told}"));
            }
        }
        Ok(())
    }

    fn step<P: FilterPlan<3>, I: FilterTick<3>>(
        &mut self,
        bench: &mut Bench<'_, '_, P, I>,
        streams: bool,
    ) -> Result<(), String> {
        let begin = self.begin(streams);
        let acts = self.acts();
        let aborts = acts.iter().any(|(_, act)| *act == Act::Abort);
        // A hold that was given at rest.
        let held = (self.random.once_in(5) && !aborts).then(|| 1 + (self.random.bits() % 60) as usize);
        let text = self.hand_over(bench, &begin)?;
        let start = self.model.clone();
        let effect = self.carry_out(streams);
        let quiet = acts.is_empty() && held.is_none();
        let acts = match held {
            Some(until) => {
                bench.operator.feed_hold();
                Acts::from([(until, Act::Resume)])
            }
            None => acts,
        };
        self.log(format!("{acts:?}, hold {held:?}"));
        let held = held.map(|until| (until, start.at));
        let ends = self.ending != Ending::Open && !(streams && aborts);
        let seen = bench.run(acts, self.polls, ends, Watched::new(&effect, held))?;
        self.log(format!("{} ticks", seen.rows.len()));
        self.judge(&seen, &effect, aborts, bench.stands())?;
        bench.rest(1 + (self.random.bits() % 6) as usize, self.polls)?;
        if let (true, Some(text), Begin::Load) = (quiet, text, begin)
            && !effect.refused
        {
            self.repeat(&start, &text, &seen)?;
            self.done.repeated += 1;
        }
        Ok(())
    }

    /// How the next step begins.
    fn begin(&mut self, streams: bool) -> Begin {
        let any = self.random.bits() % 4;
        match (streams, self.ending) {
            (true, Ending::Open) => Begin::More,
            (true, Ending::Refused) if any > 0 => Begin::GoOn,
            (true, _) => Begin::Next,
            (false, Ending::Refused) if any > 1 => Begin::GoOn,
            (false, Ending::Program) if any == 0 && !self.rest.is_empty() => Begin::Next,
            (false, _) if any < 2 => Begin::Load,
            (false, _) => Begin::Continue,
        }
    }

    fn acts(&mut self) -> Acts {
        let random = &mut self.random;
        if random.once_in(2) {
            return Acts::new();
        }
        let ticks = random.magnitude(20.0, 3000.0) as usize;
        let mut acts = if random.once_in(2) { random_acts(random, ticks) } else { Vec::new() };
        if random.once_in(3) {
            acts = with_overrides(random, ticks, acts);
        }
        if random.once_in(4) {
            acts = with_starvation(random, ticks, acts);
            acts.retain(|(_, act)| !matches!(act, Act::Slow(_)));
        }
        if random.once_in(4) {
            acts = with_stalls(random, ticks, acts);
        }
        acts.into()
    }

    /// Hands lines over; the text, if it is one.
    fn hand_over<P: FilterPlan<3>, I: FilterTick<3>>(
        &mut self,
        bench: &mut Bench<'_, '_, P, I>,
        begin: &Begin,
    ) -> Result<Option<String>, String> {
        let refuses = self.random.once_in(3);
        match begin {
            Begin::Load | Begin::Continue => {
                let single = matches!(begin, Begin::Continue);
                if !single {
                    self.model.modal = Modal::START;
                }
                let mut follows = self.model.clone();
                self.rest = lines::random(&mut self.random, &mut follows, single, refuses).into();
                if !single && self.random.once_in(3) {
                    // A second program after it, which may run next.
                    self.rest.extend(lines::random(&mut self.random, &mut follows, false, false));
                }
                let text = self.text();
                self.log(format!("{} {{\n{text}}}", if single { "continue" } else { "load" }));
                let source = Source::Text(text.clone().into_bytes(), bench.open.clone());
                let handed =
                    if single { bench.planner.continue_with(source) } else { bench.planner.load(source) };
                handed.map_err(|_| "busy at rest".to_owned())?;
                return Ok(Some(text));
            }
            Begin::GoOn => {
                self.log("go on");
                bench.planner.go_on().map_err(|error| error.to_string())?;
            }
            Begin::Next => {
                self.model.modal = Modal::START;
                if let Some(feeder) = &mut bench.feeder {
                    // The rest of an aborted or refused program does not count.
                    if self.ending != Ending::Program {
                        self.log("restart");
                        feeder.restart();
                        self.rest.clear();
                        bench.coming.clear();
                    }
                    self.stream(bench, false, refuses);
                }
                self.log("next");
                bench.planner.load_next().map_err(|_| "busy at rest".to_owned())?;
            }
            Begin::More => {
                let single = self.random.once_in(2);
                self.stream(bench, single, refuses);
            }
        }
        Ok(None)
    }

    /// Lines into a stream.
    fn stream<P: FilterPlan<3>, I: FilterTick<3>>(
        &mut self,
        bench: &mut Bench<'_, '_, P, I>,
        single: bool,
        refuses: bool,
    ) {
        if !self.rest.is_empty() {
            return;
        }
        let mut follows = self.model.clone();
        self.rest = lines::random(&mut self.random, &mut follows, single, refuses).into();
        if !single && self.random.once_in(3) {
            self.rest.extend(lines::random(&mut self.random, &mut follows, false, false));
        }
        let text = self.text();
        bench.rate = [3, 40, 1000][(self.random.bits() % 3) as usize];
        self.log(format!("stream, {} a tick {{\n{text}}}", bench.rate));
        bench.coming.extend(text.bytes());
    }

    fn text(&self) -> String {
        self.rest.iter().map(|line| line.text() + "\n").collect()
    }

    /// Expected effect of the lines that run now.
    fn carry_out(&mut self, streams: bool) -> Effect {
        let mut effect = Effect::new(&self.model);
        self.ending = if streams { Ending::Open } else { Ending::Program };
        while let Some(line) = self.rest.pop_front() {
            if !line.apply(&mut self.model, &mut effect) {
                self.ending = if effect.refused { Ending::Refused } else { Ending::Program };
                break;
            }
        }
        effect
    }

    fn judge(&mut self, seen: &Seen, effect: &Effect, aborts: bool, at: [i64; 3]) -> Result<(), String> {
        let Seen { errors, outputs, .. } = seen;
        if aborts {
            self.abort();
            self.done.aborted += 1;
            self.model.at = at;
            self.model.known = [true; 3];
            if !effect.outputs.starts_with(outputs) {
                return Err(format!("aborted, functions {outputs:?}, told {:?}", effect.outputs));
            }
            return Ok(());
        }
        for error in errors {
            self.log(error);
        }
        if let Some(slow) = errors.iter().map(ToString::to_string).find(|told| told.contains(SLOW)) {
            return Err(slow);
        }
        let expected = usize::from(effect.refused);
        if errors.len() != expected {
            let told: Vec<String> = errors.iter().map(ToString::to_string).collect();
            return Err(format!("{} refused, {expected} expected: {told:?}", errors.len()));
        }
        self.done.refused += expected;
        if *outputs != effect.outputs {
            return Err(format!("functions {outputs:?}, told {:?}", effect.outputs));
        }
        self.stands(at)?;
        (self.model.at, self.model.known) = (at, [true; 3]);
        Ok(())
    }

    /// The same program on a new channel, from the same place: the same motion.
    fn repeat(&self, start: &Model, text: &str, seen: &Seen) -> Result<(), String> {
        let mut memory: Box<Channel<3, BLOCKS, OVERLAYS>> = Box::new(Channel::new());
        let at = start.at.map(Position::from_bits);
        let open = Rc::new(Cell::new(true));
        let source = Source::Text(text.as_bytes().to_vec(), open.clone());
        let again = if self.is_filtered() {
            let mut filters: Box<Filters<3, TAPS>> = Box::new(Filters::new());
            let handles = memory.split_filtered(&mut filters, self.machine, at, source);
            self.again(start, Bench::new(handles.map_err(|e| e.to_string())?, at, open, None))
        } else {
            let handles = memory.split(self.machine, at, source);
            self.again(start, Bench::new(handles.map_err(|e| e.to_string())?, at, open, None))
        }?;
        // Setting a position may take a tick. Remainders of rounding in a filter act on its next motion, so
        // the first tick with a changed set point is not compared.
        let moves = [seen, &again].map(|Seen { rows, drives, .. }| {
            let still = rows.iter().take_while(|row| **row == start.at).count();
            rows[still..].iter().zip(&drives[still..]).collect::<Vec<_>>()
        });
        // Either set point of a filter is less than an LSB off what it makes of the path.
        let apart = |one: &[i64; 3], other: &[i64; 3]| (0..3).any(|k| (one[k] - other[k]).abs() > 1);
        let mut rows = moves[0].iter().zip(&moves[1]);
        let differs = rows.position(|(one, other)| one.0 != other.0 || apart(one.1, other.1));
        if let Some(tick) = differs {
            let [one, other] = [&moves[0], &moves[1]].map(|rows| rows[tick]);
            return Err(format!("tick {tick} of motion: {one:?}, on a new channel {other:?}"));
        }
        let ticks = moves.map(|rows| rows.len());
        if ticks[0] != ticks[1] {
            return Err(format!("{} ticks, {} on a new channel", ticks[0], ticks[1]));
        }
        Ok(())
    }

    fn is_filtered(&self) -> bool {
        self.machine.axes.iter().any(|axis| axis.filter.kind != FilterType::None)
    }

    fn again<P: FilterPlan<3>, I: FilterTick<3>>(
        &self,
        start: &Model,
        mut bench: Bench<'_, '_, P, I>,
    ) -> Result<Seen, String> {
        for (set, offsets) in start.zeros.iter().enumerate() {
            for (axis, offset) in offsets.iter().enumerate() {
                let offset = Position::from_bits(bits(*offset));
                bench.planner.set_zero_offset(set, axis, offset).map_err(|error| error.to_string())?;
            }
        }
        bench.run(Acts::new(), self.polls, true, Free)
    }
}

/// The part that was already checked.
struct Free;

impl super::bench::Watch for Free {
    fn see(&mut self, _: usize, _: &[i64; 3]) -> Result<(), String> {
        Ok(())
    }
}
