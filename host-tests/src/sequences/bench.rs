//! A channel at work, tick by tick: its results, and properties of every tick.
use super::WINDOW;
use super::model::{Effect, Element};
use crate::beside::{BLOCKS, OVERLAYS, Run};
use crate::operate::Act;
use glidepath::channel::{Error, Handles, Planner, Progress};
use glidepath::fir::{FilterPlan, FilterTick};
use glidepath::nc::{Feeder, Stream, Text, TextError};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::technology::{Function, Output};
use glidepath::tick::{Interpolator, State};
use std::cell::Cell;
use std::collections::VecDeque;
use std::rc::Rc;

/// Text as a whole, that may come late, or through a window.
pub enum Source<'w> {
    /// The whole text, and whether it can be read.
    Text(Vec<u8>, Rc<Cell<bool>>),
    /// A stream.
    Stream(Stream<'w, WINDOW>),
}

impl<'w> Source<'w> {
    /// Before the first program, and whether a text can be read.
    pub fn first(streams: bool, stream: Stream<'w, WINDOW>) -> (Self, Rc<Cell<bool>>) {
        let open = Rc::new(Cell::new(true));
        let source = if streams { Self::Stream(stream) } else { Self::Text(Vec::new(), open.clone()) };
        (source, open)
    }
}

impl Text for Source<'_> {
    fn read(&mut self, file: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        match self {
            Self::Text(_, open) if !open.get() => Err(TextError::NotYet),
            Self::Text(text, _) => text.as_slice().read(file, offset, buffer),
            Self::Stream(stream) => stream.read(file, offset, buffer),
        }
    }

    fn pass(&mut self, file: u16, offset: u32) {
        if let Self::Stream(stream) = self {
            stream.pass(file, offset);
        }
    }

    fn holds(&self, file: u16, offset: u32) -> bool {
        if let Self::Stream(stream) = self { stream.holds(file, offset) } else { true }
    }

    fn start(&mut self) -> u32 {
        if let Self::Stream(stream) = self { stream.start() } else { 0 }
    }

    fn next_program(&mut self) -> Option<u32> {
        if let Self::Stream(stream) = self { stream.next_program() } else { None }
    }
}

/// Highest number of ticks of a step, and of a standstill after its last command.
const LONGEST: usize = 300_000;
const RESTS: usize = 20_000;
/// Number of ticks without work after which a stream has no more text for now: more than filters need to
/// start again.
const QUIET: usize = 120;

/// Reason to give up a step that may be without a fault.
pub const TOO_LONG: &str = "too long";

/// Results of a step.
#[derive(Debug, Default)]
pub struct Seen {
    /// Lines that were refused.
    pub errors: Vec<Error>,
    /// Functions, as in [`Effect`].
    pub outputs: Vec<u16>,
    /// Set points of the path in every tick.
    pub rows: Vec<[i64; 3]>,
    /// Set points after the filters.
    pub drives: Vec<[i64; 3]>,
}

/// The channel.
pub struct Bench<'a, 'w, P, I> {
    /// Half of it.
    pub planner: Planner<'a, Source<'w>, 3, BLOCKS, P, OVERLAYS>,
    interpolator: Interpolator<'a, 3, I, OVERLAYS>,
    /// The operator's handle.
    pub operator: Operator<'a, 3>,
    /// A text can be read.
    pub open: Rc<Cell<bool>>,
    /// For a stream: its feeder and the text to come.
    pub feeder: Option<Feeder<'w, WINDOW>>,
    /// The text to come.
    pub coming: VecDeque<u8>,
    /// Bytes of it before each tick.
    pub rate: usize,
    /// All ticks so far; the positions that were set are taken out.
    pub all: Run,
    shift: [i64; 3],
    /// Expected positions of the axes.
    row: [i64; 3],
    due: VecDeque<(usize, Function)>,
    ticks: usize,
    stalled: usize,
    starved: usize,
    /// Ticks with nothing to do.
    idle: usize,
    /// The step ends when the planner says that it is done.
    ends: bool,
    aborted: bool,
}

impl<'a, 'w, P: FilterPlan<3>, I: FilterTick<3>> Bench<'a, 'w, P, I> {
    /// At rest.
    pub fn new(
        handles: Handles<'a, Source<'w>, 3, BLOCKS, P, I, OVERLAYS>,
        start: [Position; 3],
        open: Rc<Cell<bool>>,
        feeder: Option<Feeder<'w, WINDOW>>,
    ) -> Self {
        let Handles { planner, interpolator, operator } = handles;
        let row = start.map(Position::to_bits);
        let axes: Vec<Vec<i64>> = row.map(|at| vec![at]).to_vec();
        Self {
            planner,
            interpolator,
            operator,
            open,
            feeder,
            coming: VecDeque::new(),
            rate: usize::MAX,
            all: Run { path: axes.clone(), axes, ..Run::default() },
            shift: [0; 3],
            row,
            due: VecDeque::new(),
            ticks: 0,
            stalled: 0,
            starved: 0,
            idle: 0,
            ends: true,
            aborted: false,
        }
    }

    /// Sets the position of an axis.
    pub fn set_position(&mut self, axis: usize, bits: i64) -> Result<(), String> {
        let set = self.planner.set_position(axis, Position::from_bits(bits));
        set.map_err(|error| format!("position: {error}"))?;
        self.shift[axis] += bits - self.row[axis];
        self.row[axis] = bits;
        Ok(())
    }

    /// Calls the planner; whether it has nothing to do until something happens, and whether it is done.
    fn call(&mut self, polls: usize, seen: &mut Seen) -> Result<(bool, bool), String> {
        for _ in 0..polls {
            match self.planner.poll() {
                Ok(Progress::Waiting) => return Ok((true, false)),
                Ok(Progress::Done) => return Ok((true, true)),
                Ok(Progress::Deviated(axis)) => return Err(format!("axis {axis} beyond AX_DEV")),
                Ok(_) => {}
                Err(error) => seen.errors.push(error),
            }
        }
        Ok((false, false))
    }

    /// A tick, with what an operator does before it. Whether all is at rest.
    fn tick(&mut self, acts: &mut Acts, seen: &mut Seen, polls: usize) -> Result<bool, String> {
        let tick = self.ticks;
        self.ticks += 1;
        while let Some((_, act)) = acts.pop_front_if(|(at, _)| *at <= seen.rows.len()) {
            act.give(&self.operator);
            match act {
                Act::Stall(ticks) => self.stalled = self.stalled.max(tick + ticks),
                // Nothing more is read.
                Act::Abort => self.aborted = true,
                Act::Starve(ticks) => self.starved = self.starved.max(tick + ticks),
                _ => {}
            }
        }
        while let Some((_, function)) = self.due.pop_front_if(|(at, _)| *at <= tick) {
            // Behind an abort nothing waits for it.
            let _ = self.operator.acknowledge(function);
        }
        self.open.set(tick >= self.starved);
        if let (Some(feeder), true) = (&mut self.feeder, tick >= self.starved) {
            let bytes: Vec<u8> = self.coming.iter().take(self.rate).copied().collect();
            let count = feeder.push(&bytes);
            self.coming.drain(..count);
        }
        let most = if tick < self.stalled { 0 } else { polls };
        let (waits, done) = self.call(most, seen)?;
        let state = self.interpolator.tick();
        let drives = self.interpolator.set_points().map(Position::to_bits);
        let path = self.interpolator.path_points().map(Position::to_bits);
        self.row = path;
        for axis in 0..3 {
            self.all.axes[axis].push(drives[axis] - self.shift[axis]);
            self.all.path[axis].push(path[axis] - self.shift[axis]);
        }
        seen.rows.push(path);
        seen.drives.push(drives);
        let status = self.operator.status();
        if status.state != state || status.set_points != *self.interpolator.set_points() {
            let there = (state, self.interpolator.set_points());
            return Err(format!("tick {}: {there:?}, the operator sees {status:?}", seen.rows.len()));
        }
        while let Some(Output { function, waits, .. }) = self.operator.output() {
            seen.outputs.push(match function {
                Function::M(code) => code,
                Function::H(code) => 1000 + code,
                _ => u16::MAX,
            });
            if waits {
                self.due.push_back((tick + 3, function));
            }
        }
        let open = self.ends || self.aborted || self.coming.is_empty() && tick >= self.starved;
        let idle = open && waits && state == State::Idle && self.planner.is_at_rest();
        self.idle = if idle && acts.is_empty() { self.idle + 1 } else { 0 };
        if done && state == State::Idle && !self.planner.is_at_rest() {
            return Err("done, and not at rest".to_owned());
        }
        Ok(idle && (done || !self.ends && self.idle >= QUIET))
    }

    /// Runs to a rest with nothing left; `ends`: a program ends there, or a line is refused.
    pub fn run(
        &mut self,
        mut acts: Acts,
        polls: usize,
        ends: bool,
        mut look: impl Watch,
    ) -> Result<Seen, String> {
        let mut seen = Seen::default();
        let mut rests = 0;
        (self.idle, self.ends, self.aborted) = (0, ends, false);
        for _ in 0..LONGEST {
            let rest = self.tick(&mut acts, &mut seen, polls)?;
            let Some(row) = seen.rows.last() else { continue };
            look.see(seen.rows.len(), row)?;
            if rest && acts.is_empty() {
                let stands = self.interpolator.set_points();
                if self.planner.position() != stands {
                    let there = self.planner.position();
                    return Err(format!("stands at {stands:?}, the planner has {there:?}"));
                }
                return Ok(seen);
            }
            let still = seen.rows.len() > 1 && seen.rows[seen.rows.len() - 2] == *row;
            rests = if still && acts.is_empty() { rests + 1 } else { 0 };
            if rests > RESTS {
                let (at_rest, commands) = (self.planner.is_at_rest(), self.operator.commands());
                return Err(format!("nothing moves any more; at rest: {at_rest}, {commands:?}"));
            }
        }
        Err(TOO_LONG.to_owned())
    }

    /// So many ticks at rest: nothing moves.
    pub fn rest(&mut self, ticks: usize, polls: usize) -> Result<(), String> {
        let (mut seen, before) = (Seen::default(), self.row);
        for _ in 0..ticks {
            self.tick(&mut Acts::new(), &mut seen, polls)?;
            if seen.rows.last() != Some(&before) || seen.drives.last() != Some(&before) {
                return Err(format!("moves at rest: {before:?} to {:?}", seen.rows.last()));
            }
        }
        let quiet = seen.errors.is_empty() && seen.outputs.is_empty();
        if quiet { Ok(()) } else { Err(format!("at rest: {:?}, {:?}", seen.errors, seen.outputs)) }
    }

    /// Where the axes stand.
    pub fn stands(&self) -> [i64; 3] {
        self.row
    }
}

/// Commands and mishaps, each before a tick of its step.
pub type Acts = VecDeque<(usize, Act)>;

/// Looks at every tick of a step.
pub trait Watch {
    /// The set points of the path.
    ///
    /// # Errors
    /// They may not be there.
    fn see(&mut self, tick: usize, row: &[i64; 3]) -> Result<(), String>;
}

/// Checks that axes move only if commanded, and only on the path.
pub struct Watched<'e> {
    effect: &'e Effect,
    /// The current element of the path.
    at: usize,
    /// Nothing moves before this tick.
    held: Option<(usize, [i64; 3])>,
}

/// A filterless path is on its lines, mm: lines that are one go through points that are rounded.
const ON_PATH: f64 = 1e-6;
/// Permitted deviation from the lines, LSB 2^-32 mm: rounding of a set point, of an arc, the tolerance of
/// #HSC.
const ROUNDED: i64 = 2;
const CURVED: i64 = 1 << 10;
const SMOOTH: i64 = (1 << 32) / 10;

impl<'e> Watched<'e> {
    /// A check for the effect of lines; no axis moves before `held`.
    pub fn new(effect: &'e Effect, held: Option<(usize, [i64; 3])>) -> Self {
        Self { effect, at: 0, held }
    }
}

impl Watch for Watched<'_> {
    fn see(&mut self, tick: usize, row: &[i64; 3]) -> Result<(), String> {
        if let Some((until, at)) = self.held
            && tick <= until
            && *row != at
        {
            return Err(format!("moves in a hold, tick {tick} of {until}: {at:?} to {row:?}"));
        }
        let effect = self.effect;
        let curved = effect.path.iter().any(|element| element.arc.is_some());
        let off = if effect.smooth {
            SMOOTH
        } else if curved {
            CURVED
        } else {
            ROUNDED
        };
        for (axis, (at, [low, high])) in row.iter().zip(effect.reach).enumerate() {
            if *at < low - off || *at > high + off {
                let mm = [*at, low, high].map(|bits| bits as f64 / (1_u64 << 32) as f64);
                return Err(format!("tick {tick}: axis {axis} is at {}, told {}…{}", mm[0], mm[1], mm[2]));
            }
        }
        if effect.beside || effect.smooth || effect.path.is_empty() {
            return Ok(());
        }
        let far = |element: &Element| element.distance(row);
        let on = effect.path[self.at..].iter().position(|element| far(element) < ON_PATH);
        match on {
            Some(ahead) => self.at += ahead,
            None => {
                let nearest = effect.path.iter().map(far).fold(f64::INFINITY, f64::min);
                return Err(format!("tick {tick}: {nearest} mm off the path, block {} or later", self.at));
            }
        }
        Ok(())
    }
}
