//! The programs of the table of cores: digests, and what tick, planner and decoder cost in counts of the core's counter.
#![no_std]
#![no_main]
use core::fmt::Write;
use core::panic::PanicInfo;
use glidepath::channel::{Channel, Error, Progress};
use glidepath::machine::MachineData;
use glidepath::nc::Step;
use glidepath::quantity::Position;
use hil_cases::{AXES_3_SHORT, Case, Failure, Outcome, SHORT, Watch, run};
use hil_cores::{Report, around, around_nothing, channel, depth, elapsed, exit, floats, now, paint};

#[cfg(feature = "full")]
use hil_cases::CASES_CORES as CASES;
#[cfg(not(feature = "full"))]
use hil_cases::CASES_CORES_SLIM as CASES;

const MACHINE: &MachineData<3> = &AXES_3_SHORT;

/// Number, sum and largest of something counted.
#[derive(Default)]
struct Cost {
    calls: u32,
    sum: u64,
    max: u32,
}

impl Cost {
    fn add(&mut self, counts: u32) {
        self.calls += 1;
        self.sum += u64::from(counts);
        self.max = self.max.max(counts);
    }
}

#[derive(Default)]
struct Costs {
    /// Counts of two readings in a row.
    reading: u32,
    begun: u32,
    start: Cost,
    tick: Cost,
    plan: Cost,
    wait: Cost,
    decode: Cost,
}

impl Costs {
    fn net(&self, before: u32, now: u32) -> u32 {
        elapsed(before, now).saturating_sub(self.reading)
    }
}

impl Watch<3> for Costs {
    #[inline(always)]
    fn now(&mut self) -> u32 {
        now()
    }

    #[inline(always)]
    fn starting(&mut self) {
        self.begun = now();
    }

    #[inline(always)]
    fn started(&mut self) {
        self.start.add(self.net(self.begun, now()));
    }

    fn polled(&mut self, cost: u32, result: &Result<Progress, Error>) {
        let counts = self.net(0, cost);
        match result {
            Ok(Progress::Waiting) => self.wait.add(counts),
            _ => self.plan.add(counts),
        }
    }

    fn ticked(&mut self, cost: u32, _: &[Position; 3]) {
        let counts = self.net(0, cost);
        self.tick.add(counts);
    }
}

#[cfg(target_arch = "arm")]
#[cortex_m_rt::entry]
fn main() -> ! {
    all()
}

#[cfg(target_arch = "riscv32")]
#[unsafe(no_mangle)]
extern "C" fn main() -> ! {
    all()
}

fn all() -> ! {
    paint();
    let mut report = Report::open();
    let Some(channel) = channel() else { exit(false) };
    let reading = loops(&mut report);
    let mut good = true;
    for case in CASES {
        good &= one(channel, case, reading, &mut report);
    }
    let _ = writeln!(report, "memory channel {} stack {}", size_of::<Channel<3, SHORT>>(), depth());
    floats(&mut report);
    report.flush();
    exit(good)
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    exit(false)
}

/// Counts of known numbers of instructions; those of two readings in a row.
fn loops(report: &mut Report) -> u32 {
    let mut reading = 0;
    // The first pass comes while the emulator still translates the code.
    for pass in 0..2 {
        let counts = around_nothing();
        reading = counts;
        for times in [1, 5, 50, 500, 50_000] {
            let counts = around(times).saturating_sub(reading);
            if pass == 1 {
                let _ = writeln!(report, "loop instructions {} counted {counts}", 2 * times);
            }
        }
    }
    reading
}

/// Runs a case; whether it ended as it should.
fn one(channel: &mut Channel<3, SHORT>, case: &Case, reading: u32, report: &mut Report) -> bool {
    let _ = writeln!(report, "case {} axes 3 blocks {SHORT}", case.name);
    let mut costs = Costs { reading, ..Costs::default() };
    let result = run(channel, MACHINE, case.text, &mut costs);
    decode(channel, case, &mut costs);
    let Costs { start, tick, plan, wait, decode, .. } = costs;
    for (name, cost) in [("start", start), ("tick", tick), ("plan", plan), ("wait", wait), ("decode", decode)]
    {
        let _ = writeln!(report, "cost {name} calls {} sum {} max {}", cost.calls, cost.sum, cost.max);
    }
    end(&result, report);
    result.is_ok()
}

/// The decoder alone, to tell its share of the planner's work.
fn decode(channel: &mut Channel<3, SHORT>, case: &Case, costs: &mut Costs) {
    let mut decoder = channel.decode(MACHINE, [Position::ZERO; 3], case.text);
    loop {
        let before = now();
        let step = decoder.step();
        let counts = costs.net(before, now());
        costs.decode.add(counts);
        if matches!(step, Ok(Step::End) | Err(_)) {
            return;
        }
    }
}

fn end(result: &Result<Outcome, Failure>, report: &mut Report) {
    let _ = match result {
        Ok(o) => writeln!(
            report,
            "end ticks {} starved {} blocks {} digest {:016x}",
            o.ticks,
            o.starved,
            o.blocks,
            o.digest.value()
        ),
        Err(_) => writeln!(report, "failed"),
    };
    report.flush();
}
