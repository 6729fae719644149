//! Data of a run for a PLC: memory for the contour log and for real-time loops, variables, and the values
//! that the PLC writes.
use super::script::{Ask, Request, Script};
use super::variable::{all, find};
use crate::events::ticks;
use crate::files::Files;
use crate::machine::Machine;
use crate::run::KEPT;
use glidepath::channel::{Inquiry, Planner};
use glidepath::contour_log::{ContourMemory, ContourReader};
use glidepath::fir::FilterPlan;
use glidepath::nc::Text;
use glidepath::rt_loop::{LoopMemory, LoopSwitch};
use glidepath::variable::Variable;

/// Highest number of commands in a real-time loop; P-STUP-00033 may permit fewer.
pub const LOOPED: usize = 1 << 12;

/// The memory of a run.
pub struct Memory<const AXES: usize> {
    contour: Box<ContourMemory<KEPT, KEPT>>,
    inquiry: Box<Inquiry>,
    loops: Box<LoopMemory<AXES, LOOPED>>,
    variables: Vec<Variable>,
}

/// Functions for which the planner gets memory.
#[derive(Clone, Copy)]
pub struct Wants {
    /// The contour log.
    pub contour: bool,
    /// Real-time loops and variables.
    pub outside: bool,
}

impl Wants {
    /// Functions that the texts of a program need; with `--plc` always the contour log.
    pub fn of(files: &Files, script: Option<&Script>) -> Self {
        let contour = script.is_some() || names(files, &["LOOKAHEAD", "PROG START", "#DISTANCE"]);
        Self { contour, outside: is_from_outside(files) }
    }
}

/// Whether the program may depend on outside values: variables and real-time loops.
pub fn is_from_outside(files: &Files) -> bool {
    names(files, &["V.E.", "V.RTG.", "#RT"])
}

/// Whether one of the opened texts of the program has one of these words, in upper case.
fn names(files: &Files, words: &[&str]) -> bool {
    let has = |text: &[u8]| {
        let text = text.to_ascii_uppercase();
        words.iter().any(|word| text.windows(word.len()).any(|part| part == word.as_bytes()))
    };
    let called = files.called().len() as u16;
    (0..=called).any(|file| files.with(file, |source| has(&source.text)))
}

impl<const AXES: usize> Memory<AXES> {
    /// Nothing is in it.
    pub fn new(machine: &Machine, script: Option<&Script>) -> Self {
        Self {
            contour: Box::new(ContourMemory::new()),
            inquiry: Box::new(Inquiry::new()),
            loops: Box::new(LoopMemory::new()),
            variables: all(machine, script),
        }
    }

    /// Passes the memory to the planner. Returns the PLC's handles.
    pub fn give<'a, T: Text, F: FilterPlan<AXES>, const BLOCKS: usize, const OVERLAYS: usize>(
        &'a mut self,
        planner: &mut Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>,
        wants: Wants,
    ) -> (ContourReader<'a>, Outside<'a>) {
        let Self { contour, inquiry, loops, variables } = self;
        let (recorder, contour) = contour.split();
        let (store, switch) = loops.split();
        if wants.contour {
            planner.log_contour(recorder);
            planner.foresee(inquiry);
        }
        if wants.outside {
            planner.real_time_loops(store);
            planner.variables(variables);
        }
        (contour, Outside { variables, switch })
    }
}

/// Data shared by program and PLC.
#[derive(Clone, Copy)]
pub struct Outside<'a> {
    /// Variables V.E.
    pub variables: &'a [Variable],
    /// V.RTG.LOOP.ENABLED.
    pub switch: LoopSwitch<'a>,
}

/// Values that the PLC writes, at their times.
pub struct Writer<'a> {
    outside: Outside<'a>,
    requests: &'a [Request],
    next: usize,
    cycle_us: u32,
    /// Pass at which the flag becomes false.
    last: Option<u32>,
}

impl<'a> Writer<'a> {
    /// Nothing is written yet.
    pub fn new(outside: Outside<'a>, script: Option<&'a Script>, cycle_us: u32) -> Self {
        let requests = script.map_or(&[][..], |script| &script.requests);
        Self { outside, requests, next: 0, cycle_us, last: None }
    }

    /// Called before the planner works in `tick`.
    pub fn before(&mut self, tick: u64) {
        let Outside { variables, switch } = self.outside;
        while let Some(request) = self.requests.get(self.next) {
            if ticks(request.time_ns, self.cycle_us) > tick {
                break;
            }
            self.next += 1;
            match request.ask {
                Ask::Set(name, value) => find(variables, name).into_iter().for_each(|v| v.set(value)),
                Ask::LoopOn(passes) => {
                    switch.enable();
                    self.last = passes.map(|passes| switch.passes().wrapping_add(passes));
                }
                Ask::LoopOff => {
                    switch.disable();
                    self.last = None;
                }
                _ => {}
            }
        }
    }

    /// Called after each call of the planner: the flag becomes false with the last wanted pass.
    pub fn behind(&mut self) {
        if self.last == Some(self.outside.switch.passes()) {
            self.outside.switch.disable();
            self.last = None;
        }
    }

    /// Whether the flag may become false later.
    pub fn ends_loops(&self) -> bool {
        let later = self.requests.get(self.next..).unwrap_or_default();
        self.last.is_some() || later.iter().any(|r| matches!(r.ask, Ask::LoopOn(Some(_)) | Ask::LoopOff))
    }
}
