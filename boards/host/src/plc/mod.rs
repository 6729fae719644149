//! A PLC during a run (`--plc`): requests at given times, and the answers as JSON lines.
//!
//! | file | content |
//! |---|---|
//! | `script` | the file: one request per line |
//! | `laser` | a PLC that sets the power of a laser from the path ahead |
//! | `outside` | memory for the contour log, loops and variables; values that the PLC writes |
//! | `variable` | names and first values of variables |
//! | `picture` | reach and distance over time |
//!
//! A request acts at the first tick at or after its time. A written value acts before the planner works in
//! this tick. A question is answered after the work of the planner, before the tick.
mod laser;
mod outside;
mod picture;
mod script;
mod variable;

pub use outside::{Memory, Outside, Wants, Writer, is_from_outside};
pub use picture::draw;
pub use script::Script;
pub use variable::{name, parse as parse_variable};

use crate::diagnose::Diagnostic;

use crate::events::ticks;
use glidepath::channel::Planner;
use glidepath::contour_log::{ContourReader, Entry, Forgotten, Moment, ProgramDistance, Question, Unknown};
use glidepath::fir::FilterPlan;
use glidepath::nc::Text;
use glidepath::operator::Operator;
use glidepath::variable::Variable;
use laser::Laser;
use script::{Ask, END};
use serde_json::{Map, Value, json};

/// Highest number of entries in an answer.
const MOST: usize = 100;

/// The answers to the PLC.
#[derive(Default)]
pub struct Told {
    /// An answer per line.
    pub answers: String,
    /// Requests after the end of the program.
    pub unreached: Vec<Diagnostic>,
    /// Seconds, reach, distance and the power of the laser in percent: one per change.
    pub curve: Vec<(f64, f64, f64, Option<u8>)>,
}

/// The PLC of a run.
pub struct Plc<'a> {
    script: &'a Script,
    contour: ContourReader<'a>,
    outside: Outside<'a>,
    cycle_us: u32,
    next: usize,
    /// The program has ended.
    is_over: bool,
    laser: Option<Laser>,
    power: Option<u8>,
    told: Told,
}

impl<'a> Plc<'a> {
    /// No request was made yet.
    pub fn new(
        script: &'a Script,
        (contour, outside): (ContourReader<'a>, Outside<'a>),
        cycle_us: u32,
    ) -> Self {
        let (next, is_over, laser, power, told) = (0, false, None, None, Told::default());
        Self { script, contour, outside, cycle_us, next, is_over, laser, power, told }
    }

    fn seconds(&self, tick: u64) -> f64 {
        tick as f64 * f64::from(self.cycle_us) / 1e6
    }

    /// Handles the requests before `tick`.
    pub fn act<
        T: Text,
        F: FilterPlan<AXES>,
        const AXES: usize,
        const BLOCKS: usize,
        const OVERLAYS: usize,
    >(
        &mut self,
        tick: u64,
        planner: &mut Planner<'_, T, AXES, BLOCKS, F, OVERLAYS>,
        operator: &Operator<'_, AXES>,
    ) {
        let at = self.contour.distance(operator.status().distance);
        while let Some(request) = self.script.requests.get(self.next) {
            if !self.is_over && ticks(request.time_ns, self.cycle_us) > tick {
                break;
            }
            self.next += 1;
            let mut answer = Map::new();
            answer.insert("tick".into(), json!(tick));
            answer.insert("time_s".into(), json!(self.seconds(tick)));
            answer.insert("line".into(), json!(request.line));
            answer.insert("ask".into(), json!(request.ask.word()));
            let told = match request.ask {
                Ask::Reach => self.reach(&at),
                Ask::Elements { from, to } => self.elements(from, to),
                Ask::Log(first) => self.log(first),
                Ask::State(ns) => {
                    let ahead = u32::try_from(ticks(ns, self.cycle_us)).unwrap_or(u32::MAX);
                    self.moment(&forecast(planner, Question::StateAt(ahead)))
                }
                Ask::Feed => self.moment(&forecast(planner, Question::NextFeed)),
                Ask::Standstill => self.moment(&forecast(planner, Question::Standstill)),
                Ask::Laser(laser) => {
                    self.laser = Some(laser);
                    json!({})
                }
                Ask::Set(name, _) | Ask::Variable(name) => {
                    let value = variable::find(self.outside.variables, name).map(Variable::get);
                    json!({ "name": format!("V.E.{name}"), "value": value })
                }
                Ask::LoopOn(_) | Ask::LoopOff => {
                    let switch = self.outside.switch;
                    json!({ "loop_enabled": switch.is_enabled(), "passes": switch.passes() })
                }
            };
            if let Value::Object(told) = told {
                answer.extend(told);
            }
            self.told.answers.push_str(&Value::Object(answer).to_string());
            self.told.answers.push('\n');
        }
        if let (Some(laser), Ok(at)) = (&self.laser, &at) {
            let power = Some(laser.power(&self.contour, *at));
            if power != self.power {
                self.power = power;
                let line = json!({
                    "tick": tick, "time_s": self.seconds(tick), "laser_percent": power, "distance_mm": at.to_mm(),
                });
                self.told.answers.push_str(&line.to_string());
                self.told.answers.push('\n');
            }
        }
        let row = (self.contour.reach().to_mm(), at.map_or(f64::NAN, ProgramDistance::to_mm), self.power);
        if self.told.curve.last().is_none_or(|last| (last.1, last.2, last.3) != row) {
            self.told.curve.push((self.seconds(tick), row.0, row.1, row.2));
        }
    }

    /// After the last tick: answers the questions at the end of the program.
    pub fn end<
        T: Text,
        F: FilterPlan<AXES>,
        const AXES: usize,
        const BLOCKS: usize,
        const OVERLAYS: usize,
    >(
        &mut self,
        tick: u64,
        planner: &mut Planner<'_, T, AXES, BLOCKS, F, OVERLAYS>,
        operator: &Operator<'_, AXES>,
    ) {
        let timed = self.script.requests.partition_point(|request| request.time_ns < END);
        self.told.unreached = self.script.unreached(self.next..timed);
        self.next = self.next.max(timed);
        self.is_over = true;
        self.act(tick, planner, operator);
    }

    /// Returns the answers.
    pub fn finish(mut self, tick: u64) -> Told {
        if let Some(last) = self.told.curve.last().copied() {
            self.told.curve.push((self.seconds(tick), last.1, last.2, last.3));
        }
        self.told
    }

    fn reach(&self, at: &Result<ProgramDistance, Forgotten>) -> Value {
        let log = self.contour.log_state();
        json!({
            "reach_mm": self.contour.reach().to_mm(),
            "distance_mm": at.as_ref().ok().map(|at| at.to_mm()),
            "loop_enabled": self.outside.switch.is_enabled(), "passes": self.outside.switch.passes(),
            "logged": log.entries, "without_room": log.without_room, "log_is_active": log.active,
        })
    }

    fn elements(&self, from: f64, to: f64) -> Value {
        let [from, to] = [from, to].map(ProgramDistance::from_mm);
        let mut elements: Vec<Value> = self
            .contour
            .elements(from, to)
            .map(|element| match element {
                Ok(entry) => element_of(&entry),
                Err(Forgotten { first }) => json!({ "forgotten_before_mm": first.to_mm() }),
            })
            .take(MOST + 1)
            .collect();
        let more = elements.len() > MOST;
        elements.truncate(MOST);
        json!({ "elements": elements, "more": more })
    }

    fn log(&self, first: u32) -> Value {
        let mut entries = (first..).map_while(|index| self.contour.logged(index));
        let elements: Vec<Value> = entries.by_ref().take(MOST).map(|entry| element_of(&entry)).collect();
        json!({ "elements": elements, "more": entries.next().is_some() })
    }

    fn moment<const AXES: usize>(&self, answer: &Result<Moment<AXES>, Unknown>) -> Value {
        let per_s = 1e6 / f64::from(self.cycle_us);
        match answer {
            Ok(moment) => json!({
                "in_s": f64::from(moment.ticks) / per_s,
                "in_ticks": moment.ticks,
                "n": moment.n,
                "block": moment.block,
                "speed_mm_s": moment.speed.0.to_num::<f64>() * per_s,
                "set_points": moment.set_points.map(|point| point.to_num::<f64>()).to_vec(),
            }),
            Err(unknown) => json!({ "unknown": unknown.to_string() }),
        }
    }
}

/// Repeats a question until there is an answer; the planner gets unlimited time.
fn forecast<T: Text, F: FilterPlan<AXES>, const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize>(
    planner: &mut Planner<'_, T, AXES, BLOCKS, F, OVERLAYS>,
    question: Question,
) -> Result<Moment<AXES>, Unknown> {
    /// Highest number of calls for one answer.
    const CALLS: usize = 10_000;
    (0..CALLS)
        .map(|_| planner.forecast(question))
        .find(|answer| !matches!(answer, Err(Unknown::Searching)))
        .unwrap_or(Err(Unknown::Searching))
}

/// Names of ISG's description C40.
fn element_of(entry: &Entry) -> Value {
    let mut element = json!({
        "block_type": entry.block_type as u8,
        "block_number": entry.n,
        "block_count_r": entry.id,
        "start_position_mm": entry.start.to_mm(),
    });
    if let Value::Object(element) = &mut element {
        if entry.block_type.is_element() {
            element.insert("length_mm".into(), json!(entry.length.to_mm()));
            element.insert("tangent_variation_rad".into(), json!(entry.knee));
        } else {
            element.insert("parameter".into(), json!(entry.parameter));
        }
        if entry.radius_mm > 0.0 {
            element.insert("programmed_radius_mm".into(), json!(entry.radius_mm));
            element.insert("circle_angle_rad".into(), json!(entry.angle));
        }
    }
    element
}
