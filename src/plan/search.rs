//! Searches for a stop, in bounded steps, because a complete search would take too long for one call of the
//! planner.
//!
//! A search has stages. Each stage tries a kind of stop, and the search ends with the first stop that is
//! found:
//!
//! | order | stage | what the stage tries | one step |
//! |---|---|---|---|
//! | 1 | `Begin`, `Short` | a short stop, with the limits that the axes permit along the stop itself (`short_stop`) | one profile, compared with these limits |
//! | 2 | `Along` | one profile down to a stop, within the planned limits of the spans (`descent`) | the whole stage |
//! | 3 | `Begin`, `Short` with `surely` | stage 1 again, now also for a stop that is no shorter than the planned limits permit | as 1 |
//! | 4 | `Down` | a braking to the end of fewer and fewer spans; other profiles continue it | one profile |
//!
//! Stage 1 gives up early if the planned limits seem to permit an equally short stop. Stage 3 runs only after
//! this, if stage 2 has found room for a stop, but no single profile. The search for a reserve begins with
//! stage 2.
//!
//! Each step adds its cost to a sum. When the sum has reached [`ENOUGH`], the call returns [`Later`], and the
//! next call goes on with the search. Only a few numbers are stored between two calls. So the last step makes
//! the profile and checks it against the spans as they are then.
//!
//! A search is valid for one span and one motion in it. If the next call asks for another span or motion, the
//! search begins anew by itself. The instant of that motion can be stored ([`Search::pause`]). If the
//! interrupt has passed this instant, the next search is for a later one.
use super::descent::{Along, Descent};
use super::short_stop::{No, Short};
use super::{Instant, Planning, clock};
use crate::lookahead::ReleasedSpan;
use crate::queue::Segment;
use core::cell::Cell;

/// Costs, in about 100 instructions of a Cortex-M4. In this order: a committed span; a span of the
/// look-ahead, in addition to 1 for each block; a profile to a given speed; a profile whose end speed is
/// searched.
pub(super) const SPAN_COSTS: u32 = 3;
pub(super) const SCAN_COSTS: u32 = 6;
pub(super) const LAW_COSTS: u32 = 15;
pub(super) const PLAN_COSTS: u32 = 100;

/// Highest cost of one round. A stop with a higher cost counts as impossible.
pub(super) const WALK: u32 = 600;

/// Cost after which a call ends.
const ENOUGH: u32 = 60;

/// Cost of examining a part of a curve.
pub(super) const fn curve_costs<const AXES: usize>(segment: &Segment<AXES>) -> u32 {
    let axes = AXES as u32;
    if segment.is_line() {
        2 + axes
    } else if segment.is_arc() {
        7 + axes
    } else {
        6 + 4 * axes
    }
}

/// Cost of finding the deceleration that a part of the path permits.
pub(super) const fn part_costs(axes: usize) -> u32 {
    2 * axes as u32
}

/// The search continues in the next call.
#[derive(Clone, Copy, Debug)]
pub(super) struct Later;

/// The next stage.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Begin { surely: bool },
    Short { surely: bool },
    Along,
    Down(usize),
}

/// A search, between two calls.
#[derive(Clone, Debug)]
pub(super) struct Search {
    /// The span, the motion in it, and whether the search is for a reserve. At a standstill, there is no
    /// search.
    k: usize,
    motion: Instant,
    is_reserve: bool,
    /// Whether the stop has to stay within committed spans.
    stays: bool,
    stage: Stage,
    short: Short,
    /// Whether the stop itself is examined again, because the limits of the spans permit a stop only in
    /// several profiles.
    again: bool,
    /// Number of spans in the profile that [`Stage::Along`] has found.
    spans: usize,
    /// The instant of the motion, and the first span that begins after this instant.
    paused: Option<(u32, usize)>,
    /// Whether the current span has no stop, so that the stop begins with the next span.
    skips: bool,
    /// Cost of this call, and whether the search continues in the next call.
    spent: Cell<u32>,
    goes_on: bool,
}

impl Search {
    const NO_MOTION: Instant = Instant { distance: 0, speed: 0, accel: 0 };

    /// No search in progress.
    pub const fn none() -> Self {
        Self {
            k: 0,
            motion: Self::NO_MOTION,
            is_reserve: false,
            stays: false,
            stage: Stage::Along,
            short: Short::NONE,
            again: false,
            spans: 1,
            paused: None,
            skips: false,
            spent: Cell::new(0),
            goes_on: false,
        }
    }

    /// Adds the cost of a step to that of the call.
    pub fn spend(&self, costs: u32) {
        self.spent.set(self.spent.get().saturating_add(costs));
    }

    /// Adds the cost of a part of a round, if the sum stays at most `most`. Returns `None` if the sum would
    /// be higher.
    pub fn spend_up_to(&self, most: u32, costs: u32) -> Option<()> {
        self.spend(costs);
        (self.spent() <= most).then_some(())
    }

    /// Begins a call of the planner: its cost is 0.
    pub const fn begin_call(&mut self) {
        (self.spent, self.goes_on) = (Cell::new(0), false);
    }

    /// Whether the search continues in the next call.
    pub const fn goes_on(&self) -> bool {
        self.goes_on
    }

    /// Drops the search.
    pub const fn forget(&mut self) {
        (self.motion, self.paused, self.skips) = (Self::NO_MOTION, None, false);
    }

    /// Keeps the search for the next call, for a change of plan at the instant `at`. `later`: the first span
    /// that begins after `at`. `skips`: the stop begins with that span.
    pub const fn pause(&mut self, (at, later): (u32, usize), skips: bool) {
        (self.paused, self.skips) = (Some((at, later)), skips);
    }

    /// Returns whether the stop begins with the next span, because no stop was found in the current span. The
    /// call clears this mark.
    pub const fn skips(&mut self) -> bool {
        core::mem::replace(&mut self.skips, false)
    }

    /// Cost of the search in this call, in units of about 100 instructions of a Cortex-M4.
    pub const fn spent(&self) -> u32 {
        self.spent.get()
    }

    /// Whether a paused search continues at a stored instant.
    pub const fn is_paused(&self) -> bool {
        self.paused.is_some()
    }

    /// The span and the motion from which the search is for a stop.
    pub const fn begins(&self) -> (usize, Instant) {
        (self.k, self.motion)
    }

    #[inline(never)]
    fn restart(&mut self, (k, motion): (usize, &Instant), is_reserve: bool, stays: bool) {
        let stage = if is_reserve { Stage::Along } else { Stage::Begin { surely: false } };
        (self.k, self.motion, self.is_reserve, self.stays) = (k, *motion, is_reserve, stays);
        (self.stage, self.again) = (stage, false);
    }

    /// Ends the short stages without a stop.
    fn leave_short(&mut self, no: No, surely: bool) {
        self.again = no == No::Shorter;
        self.stage = if surely { Stage::Down(self.spans) } else { Stage::Along };
    }
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// The instant and the span of a paused search. Returns `None` if the interrupt has passed that instant;
    /// the next search is then for a later instant.
    #[inline(never)]
    pub(super) fn paused(&mut self) -> Option<(u32, usize)> {
        let paused = self.orders.search.paused.take()?;
        let now = self.queue.clock.now();
        // At a standstill, the instant may be the current one.
        if !clock::is_before(paused.0, now) {
            self.orders.mode.tried = Some(now);
            return Some(paused);
        }
        self.orders.search.forget();
        self.orders.mode.tried = None;
        self.look_further();
        None
    }

    /// Searches the stop from `motion` in the span `k`. Returns `None` if the current profile is as slow at
    /// the end of this span. The emitter's profile holds the result.
    ///
    /// # Errors
    /// [`Later`]: the call has done enough work. The next call for the same motion continues the search.
    #[inline(never)]
    pub(super) fn descend(&mut self, k: usize, motion: &Instant) -> Result<Option<Descent>, Later> {
        if motion.speed <= 0 {
            return Ok(None);
        }
        let is_reserve = self.reserve.is_made();
        let search = &mut self.orders.search;
        if search.k != k || search.motion != *motion || search.is_reserve != is_reserve {
            search.restart((k, motion), is_reserve, false);
        }
        // Made in place, here and below: a returned value would be on the stack several times.
        let mut descent = Descent::none();
        loop {
            if self.orders.search.spent() >= ENOUGH {
                self.orders.search.goes_on = true;
                return Err(Later);
            }
            let Some(is_found) = self.go_on_searching(&mut descent) else { continue };
            // A hold continues only through committed spans.
            let commits = is_reserve || descent.brake.v_out == 0 || self.orders.search.stays;
            if is_found && !commits && k + descent.spans > self.committed.len() {
                self.orders.search.restart((k, motion), is_reserve, true);
                continue;
            }
            self.orders.search.forget();
            return Ok(is_found.then_some(descent));
        }
    }

    /// Makes the stop from this motion stay within the span `k`. The next [`Self::descend`] then needs one
    /// step.
    pub(super) fn stay_within(&mut self, k: usize, motion: &Instant) {
        let is_reserve = self.reserve.is_made();
        let search = &mut self.orders.search;
        search.restart((k, motion), is_reserve, true);
        search.stage = Stage::Down(1);
        search.begin_call();
    }

    /// Does one step of the search. When the search is over, returns whether there is a stop.
    #[inline(never)]
    fn go_on_searching(&mut self, descent: &mut Descent) -> Option<bool> {
        let mut blank = ReleasedSpan::BLANK;
        let span = &mut blank;
        let Search { k, motion, stays, stage, .. } = self.orders.search;
        let mut start = self.begin_ahead(k, stays);
        let is_first = matches!(stage, Stage::Begin { surely: false } | Stage::Short { surely: false });
        if !is_first && self.know_fall(&mut start, span, &motion).is_none() {
            return Some(false);
        }
        let step = (&motion, descent);
        match stage {
            Stage::Begin { surely } => match self.begin_short(&start, span, &motion, surely) {
                Ok(short) => {
                    self.orders.search.short = short;
                    self.orders.search.stage = Stage::Short { surely };
                }
                Err(no) => self.orders.search.leave_short(no, surely),
            },
            Stage::Short { surely } => {
                let mut short = self.orders.search.short;
                let went = self.go_on_short(&start, span, step, &mut short);
                self.orders.search.short = short;
                match went {
                    Ok(true) => return Some(true),
                    Ok(false) => {}
                    Err(no) => self.orders.search.leave_short(no, surely),
                }
            }
            Stage::Along => {
                let Some(along) = self.look_along(&start, span, step) else { return Some(false) };
                let Along::Through { spans, fits } = along else { return Some(true) };
                let search = &mut self.orders.search;
                search.spans = spans;
                search.stage =
                    if fits && search.again { Stage::Begin { surely: true } } else { Stage::Down(spans) };
            }
            Stage::Down(spans) => match self.step_down(&start, span, step, spans) {
                None => return Some(false),
                Some(Ok(())) => return Some(true),
                Some(Err(fewer)) => self.orders.search.stage = Stage::Down(fewer),
            },
        }
        None
    }
}
