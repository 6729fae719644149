//! The loop that runs a case. Target and host share it, so that nothing but the arithmetic can differ.
use glidepath::channel::{Channel, Error, Handles, MachineError, Planner, Progress};
use glidepath::digest::Digest;
use glidepath::fir::{FilterPlan, FilterTick};
use glidepath::machine::MachineData;
use glidepath::nc::Text;
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::tick::{Interpolator, State};

/// A program that has not ended after so many ticks never will.
const TICK_LIMIT: u32 = 1_000_000;

/// What a test wants to know while a case runs.
pub trait Watch<const AXES: usize> {
    /// A counter that runs up and wraps; instructions in the emulator, cycles on hardware.
    fn now(&mut self) -> u32 {
        0
    }

    /// The channel is about to be split, and it is.
    #[inline(always)]
    fn starting(&mut self) {}
    /// See [`Self::starting`].
    #[inline(always)]
    fn started(&mut self) {}

    /// The interpolator is about to be called, and it was.
    #[inline(always)]
    fn ticking(&mut self) {}
    /// See [`Self::ticking`].
    #[inline(always)]
    fn rested(&mut self) {}

    /// The program has ended.
    #[inline(always)]
    fn ended(&mut self) {}

    /// The planner was called and needed `cost`.
    fn polled(&mut self, cost: u32, result: &Result<Progress, Error>);

    /// The interpolator made a set point and needed `cost`.
    fn ticked(&mut self, cost: u32, set_points: &[Position; AXES]);
}

impl<const AXES: usize, W: Watch<AXES>> Watch<AXES> for &mut W {
    fn now(&mut self) -> u32 {
        W::now(self)
    }

    fn polled(&mut self, cost: u32, result: &Result<Progress, Error>) {
        W::polled(self, cost, result);
    }

    fn ticked(&mut self, cost: u32, set_points: &[Position; AXES]) {
        W::ticked(self, cost, set_points);
    }
}

/// Nobody watches.
pub struct Unwatched;

impl<const AXES: usize> Watch<AXES> for Unwatched {
    fn polled(&mut self, _: u32, _: &Result<Progress, Error>) {}
    fn ticked(&mut self, _: u32, _: &[Position; AXES]) {}
}

/// What a whole program gave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Ticks with motion or dwell.
    pub ticks: u32,
    /// Ticks in between that found nothing planned.
    pub starved: u32,
    /// Motion blocks planned.
    pub blocks: u32,
    /// Over the set points of all active ticks.
    pub digest: Digest,
}

/// Why a case did not end.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// The machine was refused.
    Machine(MachineError),
    /// The program was refused.
    Program(Error),
    /// More than the ticks any case needs.
    Endless,
    /// A session: what did not happen.
    Session(&'static str),
}

/// What an application holds.
type Split<'a, const AXES: usize, const BLOCKS: usize> =
    Result<Handles<'a, &'static [u8], AXES, BLOCKS>, MachineError>;

/// Plans as far as the queue takes it, then makes one set point, and so on to the end.
///
/// # Errors
/// The case was refused or does not end.
pub fn run<const AXES: usize, const BLOCKS: usize, W: Watch<AXES>>(
    channel: &mut Channel<AXES, BLOCKS>,
    machine: &MachineData<AXES>,
    text: &'static [u8],
    watch: &mut W,
) -> Result<Outcome, Failure> {
    // By reference: the stack holds the planner's handle once.
    watch.starting();
    let mut handles = split(channel, machine, text);
    watch.started();
    match &mut handles {
        Ok(handles) => drive(handles, watch),
        Err(error) => Err(Failure::Machine(*error)),
    }
}

/// Runs what is split.
#[inline(always)]
pub(crate) fn drive<T, P, I, W, const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize>(
    handles: &mut Handles<'_, T, AXES, BLOCKS, P, I, OVERLAYS>,
    watch: &mut W,
) -> Result<Outcome, Failure>
where
    T: Text,
    P: FilterPlan<AXES>,
    I: FilterTick<AXES>,
    W: Watch<AXES>,
{
    drive_with(handles, watch, |_, _| {})
}

/// The same; before each tick, the first one is 0, the operator is asked what there is to do.
#[inline(always)]
pub(crate) fn drive_with<T, P, I, W, const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize>(
    handles: &mut Handles<'_, T, AXES, BLOCKS, P, I, OVERLAYS>,
    watch: &mut W,
    mut act: impl FnMut(&Operator<'_, AXES>, u32),
) -> Result<Outcome, Failure>
where
    T: Text,
    P: FilterPlan<AXES>,
    I: FilterTick<AXES>,
    W: Watch<AXES>,
{
    let Handles { planner, interpolator, operator } = handles;
    let mut outcome = Outcome { ticks: 0, starved: 0, blocks: 0, digest: Digest::new() };
    let mut done = false;
    for number in 0..TICK_LIMIT {
        act(operator, number);
        while !done {
            let before = watch.now();
            let result = poll(planner);
            let cost = watch.now().wrapping_sub(before);
            watch.polled(cost, &result);
            match result.map_err(Failure::Program)? {
                Progress::Waiting => break,
                Progress::Done => done = true,
                Progress::Planned => outcome.blocks += planner.planned().blocks,
                Progress::Working
                | Progress::Replanned
                | Progress::Starved
                | Progress::Late
                | Progress::Slower
                | Progress::Deviated(_)
                | Progress::Warning(_) => {}
            }
        }
        watch.ticking();
        let before = watch.now();
        let state = tick(interpolator);
        let cost = watch.now().wrapping_sub(before);
        watch.rested();
        match state {
            State::Active | State::Settling => {
                outcome.ticks += 1;
                outcome.digest.add(interpolator.set_points());
                watch.ticked(cost, interpolator.set_points());
            }
            State::Idle if done => {
                watch.ended();
                return Ok(outcome);
            }
            State::Idle => outcome.starved += 1,
        }
    }
    Err(Failure::Endless)
}

// Calls, not inlined into the loop: what is counted is what an application pays.
#[inline(never)]
fn split<'a, const AXES: usize, const BLOCKS: usize>(
    channel: &'a mut Channel<AXES, BLOCKS>,
    machine: &'a MachineData<AXES>,
    text: &'static [u8],
) -> Split<'a, AXES, BLOCKS> {
    channel.split(machine, [Position::ZERO; AXES], text)
}

#[inline(never)]
pub(crate) fn poll<T, P, const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize>(
    planner: &mut Planner<'_, T, AXES, BLOCKS, P, OVERLAYS>,
) -> Result<Progress, Error>
where
    T: Text,
    P: FilterPlan<AXES>,
{
    planner.poll()
}

#[inline(never)]
pub(crate) fn tick<I: FilterTick<AXES>, const AXES: usize, const OVERLAYS: usize>(
    interpolator: &mut Interpolator<'_, AXES, I, OVERLAYS>,
) -> State {
    interpolator.tick()
}
