//! Requests of a PLC from another thread at random moments while a program runs.
use crate::calls::call;
use crate::foresee::asked;
use crate::rounded::quick;
use glidepath::channel::{Channel, Handles, Inquiry};
use glidepath::contour_log::{
    BlockType, ContourMemory, ContourReader, ControlUnit, Entry, Forgotten, ProgramDistance, Question,
    QuestionUnit,
};
use glidepath::digest::Digest;
use glidepath::quantity::Position;
use glidepath::tick::State;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Results of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Driven {
    /// Digest of its set points.
    pub digest: u64,
    /// Ticks.
    pub ticks: u64,
}

/// Requests of the other thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Requests {
    /// Elements read directly.
    pub elements: u64,
    /// Requests of the control unit, and blocks of its answers.
    pub requests: [u64; 2],
    /// Answered questions about the coming motion.
    pub questions: u64,
}

impl Requests {
    /// Whether there is at least one of each kind: on a busy computer the other thread gets little time.
    const fn has_each(&self) -> bool {
        self.requests[1] > 0 && self.questions > 0
    }

    /// All of them.
    pub const fn all(&self) -> u64 {
        self.elements + self.requests[0] + self.questions
    }
}

const EVERYTHING: ProgramDistance = ProgramDistance::from_bits(i64::MAX);

/// Length, N number and knee of each line depend on one another.
fn check(entry: &Entry) {
    assert_eq!(entry.block_type, BlockType::Line);
    assert_eq!(entry.length, ProgramDistance::from_mm(f64::from(entry.n)), "torn: {entry:?}");
}

/// The other thread: until `ended`.
fn plc(
    contour: ContourReader<'_>,
    unit: &ControlUnit<4>,
    questions: &QuestionUnit<3>,
    (ended, asked): (&AtomicBool, &AtomicU64),
) -> Requests {
    let mut requests = Requests::default();
    let mut reach = ProgramDistance::ZERO;
    let mut awaited = None;
    while !ended.load(Ordering::Relaxed) {
        let now = contour.reach();
        assert!(now >= reach, "the reach falls");
        reach = now;
        let mut due: Option<ProgramDistance> = None;
        for entry in contour.elements(ProgramDistance::ZERO, EVERYTHING) {
            match entry {
                Ok(entry) => {
                    check(&entry);
                    assert!(due.is_none_or(|due| due == entry.start), "stale: {entry:?}");
                    due = Some(entry.end());
                }
                Err(Forgotten { first }) => due = Some(first),
            }
            requests.elements += 1;
        }
        if !unit.is_pending() {
            if let Some(from) = awaited.take() {
                for entry in unit.blocks() {
                    check(&entry);
                    assert!(entry.end().to_mm() > from, "not asked for: {entry:?}");
                    requests.requests[1] += 1;
                }
                requests.requests[0] += 1;
            }
            let from = (reach.to_mm() - 30.0).max(0.0);
            unit.request(from * 10_000.0, 1e6).expect("free");
            awaited = Some(from);
        }
        if let Some(answer) = questions.answer() {
            if let Ok(moment) = answer {
                assert!(moment.set_points[2] == Position::ZERO && moment.n < 10, "torn: {moment:?}");
            }
            requests.questions += 1;
            let question = [Question::StateAt(20), Question::NextFeed, Question::Standstill];
            questions.ask(question[requests.questions as usize % 3]).expect("free");
        } else {
            let _ = questions.ask(Question::NextFeed);
        }
        asked.store(requests.all(), Ordering::Relaxed);
    }
    requests
}

/// Runs programs until another thread has made `count` requests. Returns the requests and the results of the
/// programs. Without `count` one program runs alone.
pub fn run(count: Option<u64>) -> (Requests, Vec<Driven>) {
    let machine = asked(&quick::<3>(1000));
    let lines: String = (1..=4_000)
        .map(|i| format!("N{} {}{}\n", i % 9 + 1, if i % 2 == 0 { "G91 X" } else { "G91 Y" }, i % 9 + 1))
        .collect();
    let text = format!("G01 F60000\n{lines}");
    let (mut all, mut driven) = (Requests::default(), Vec::new());
    loop {
        let mut memory = Box::new(ContourMemory::<16, 16>::new());
        let mut inquiry = Box::new(Inquiry::new());
        let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
        let (recorder, contour) = memory.split();
        let handles = channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
        let Handles { mut planner, mut interpolator, .. } = handles;
        planner.log_contour(recorder);
        planner.foresee(&mut inquiry);
        let (unit, questions) = (&ControlUnit::<4>::new(), &QuestionUnit::<3>::new());
        let (ended, asked) = (&AtomicBool::new(false), &AtomicU64::new(0));
        let requests = std::thread::scope(|scope| {
            let other = count.map(|_| scope.spawn(move || plc(contour, unit, questions, (ended, asked))));
            let mut digest = Digest::new();
            let mut ticks = 0;
            let whole = loop {
                let done = call(&mut planner, usize::MAX, |_| {}).expect("a program");
                unit.serve(&contour);
                while questions.pending().is_some() && !planner.answer(questions) {}
                let state = interpolator.tick();
                digest.add(interpolator.set_points());
                ticks += 1;
                if state == State::Idle && done {
                    break true;
                }
                let has_whole = !driven.is_empty() && all.has_each();
                if has_whole && count.is_some_and(|count| all.all() + asked.load(Ordering::Relaxed) >= count)
                {
                    break false;
                }
            };
            ended.store(true, Ordering::Relaxed);
            if whole {
                driven.push(Driven { digest: digest.value(), ticks });
            }
            other.map_or_else(Requests::default, |other| other.join().expect("good elements"))
        });
        all.elements += requests.elements;
        all.questions += requests.questions;
        (0..2).for_each(|k| all.requests[k] += requests.requests[k]);
        if count.is_none_or(|count| all.all() >= count && all.has_each()) {
            return (all, driven);
        }
    }
}
