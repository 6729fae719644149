//! A PLC beside the motion (feature `plc`): a real-time loop that it ends, and a laser whose power it sets from what comes.
//! What each run must give is here, for host and target.
use super::run::{Failure, Outcome, Watch, poll, tick};
use super::{AXES_3, BLOCKS};
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::contour_log::{ContourMemory, ContourReader, ProgramDistance};
use glidepath::digest::Digest;
use glidepath::machine::{ChannelData, InterpolatorData, MachineData};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::rt_loop::LoopMemory;
use glidepath::tick::State;

/// Memory of a PLC: the contour ahead, and a loop.
pub struct PlcMemory {
    contour: ContourMemory<128, 64>,
    loops: LoopMemory<3, 8>,
}

impl PlcMemory {
    /// Nothing is in it.
    pub const fn new() -> Self {
        Self { contour: ContourMemory::new(), loops: LoopMemory::new() }
    }
}

impl Default for PlcMemory {
    fn default() -> Self {
        Self::new()
    }
}

/// Passes of the loop.
pub const PASSES: u32 = 100;

/// A ring of four arcs with radii of 1 mm, entered and left along its tangent; a log of it around the loop.
const RING: &[u8] =
    b"N10 G01 X3 F3000\nN15 #CONTOUR LOOKAHEAD LOG ON\nN20 #RT WHILE\nN30 G03 X4 Y1 I0 J1\nN40 X3 Y2 I-1 J0
N50 X2 Y1 I0 J-1\nN60 X3 Y0 I1 J0\nN70 #RT ENDWHILE\nN75 #CONTOUR LOOKAHEAD LOG OFF\nN80 G01 X6\nM30\n";

/// The same without a log.
const RING_ALONE: &[u8] = b"N10 G01 X3 F3000\nN20 #RT WHILE\nN30 G03 X4 Y1 I0 J1\nN40 X3 Y2 I-1 J0
N50 X2 Y1 I0 J-1\nN60 X3 Y0 I1 J0\nN70 #RT ENDWHILE\nN80 G01 X6\nM30\n";

/// Set points of all ticks of the ring, with and without a log.
pub const RING_DIGEST: u64 = 0xf989_27a3_b3bc_d05d;

/// `programs/laser.nc`, and the power of the laser: ticks at which it changes, percent.
const LASER: &[u8] = include_bytes!("../../../programs/laser.nc");
/// As the simulator tells with `programs/laser.plc`.
pub const LASER_POWER: [(u32, u8); 7] =
    [(0, 100), (423, 40), (625, 100), (846, 40), (1047, 100), (2018, 40), (2164, 100)];

const fn machine() -> MachineData<3> {
    let channel = ChannelData { interpolator: InterpolatorData::ALL, ..AXES_3.channel };
    MachineData { channel, ..AXES_3 }
}

/// Drives the ring [`PASSES`] times. `logs`: the contour ahead is recorded.
///
/// # Errors
/// It was refused or does not end.
pub fn ring<W: Watch<3>>(
    channel: &mut Channel<3, BLOCKS>,
    memory: &mut PlcMemory,
    logs: bool,
    watch: &mut W,
) -> Result<Outcome, Failure> {
    let machine = machine();
    let PlcMemory { contour, loops } = memory;
    let (recorder, _) = contour.split();
    let (store, switch) = loops.split();
    let text = if logs { RING } else { RING_ALONE };
    let mut handles = split(channel, &machine, text)?;
    if logs {
        handles.planner.log_contour(recorder);
    }
    handles.planner.real_time_loops(store);
    switch.enable();
    drive(&mut handles, watch, |_, _| {
        if switch.passes() >= PASSES {
            switch.disable();
        }
    })
}

/// Drives the laser's program; `told` gets each tick at which the PLC changes the power, and the power in percent.
///
/// # Errors
/// It was refused or does not end.
pub fn laser<W: Watch<3>>(
    channel: &mut Channel<3, BLOCKS>,
    memory: &mut PlcMemory,
    watch: &mut W,
    mut told: impl FnMut(u32, u8),
) -> Result<Outcome, Failure> {
    let machine = machine();
    let (recorder, contour) = memory.contour.split();
    let mut handles = split(channel, &machine, LASER)?;
    handles.planner.log_contour(recorder);
    let mut last = None;
    drive(&mut handles, watch, |operator, number| {
        let power = contour.distance(operator.status().distance).ok().map(|at| power(&contour, at));
        if let (Some(percent), true) = (power, power != last) {
            last = power;
            told(number, percent);
        }
    })
}

/// The PLC's rule: 40 % within 2 mm of a knee of 30° or more, and on radii below 3 mm.
fn power(contour: &ContourReader<'_>, at: ProgramDistance) -> u8 {
    let [from, to] = [-2.0, 2.0].map(|mm| ProgramDistance::from_mm(at.to_mm() + mm));
    let is_low = contour.elements(from, to).flatten().any(|element| {
        let is_here = element.start <= at && at < element.end();
        let is_narrow = element.radius_mm > 0.0 && element.radius_mm < 3.0;
        (element.knee >= 30f64.to_radians() && element.start >= from) || (is_here && is_narrow)
    });
    if is_low { 40 } else { 100 }
}

type Split<'a> = Handles<'a, &'static [u8], 3, BLOCKS>;

#[inline(never)]
fn split<'a>(
    channel: &'a mut Channel<3, BLOCKS>,
    machine: &'a MachineData<3>,
    text: &'static [u8],
) -> Result<Split<'a>, Failure> {
    channel.split(machine, [Position::ZERO; 3], text).map_err(Failure::Machine)
}

/// The planner works, then the PLC, then the interrupt.
fn drive<W: Watch<3>>(
    handles: &mut Split<'_>,
    watch: &mut W,
    mut plc: impl FnMut(&Operator<'_, 3>, u32),
) -> Result<Outcome, Failure> {
    let Handles { planner, interpolator, operator } = handles;
    let mut outcome = Outcome { ticks: 0, starved: 0, blocks: 0, digest: Digest::new() };
    let mut done = false;
    for number in 0..1_000_000 {
        while !done {
            let before = watch.now();
            let result = poll(planner);
            let cost = watch.now().wrapping_sub(before);
            watch.polled(cost, &result);
            match result.map_err(Failure::Program)? {
                Progress::Waiting => break,
                Progress::Done => done = true,
                Progress::Planned => outcome.blocks += planner.planned().blocks,
                _ => {}
            }
        }
        plc(operator, number);
        let before = watch.now();
        let state = tick(interpolator);
        let cost = watch.now().wrapping_sub(before);
        match state {
            State::Active | State::Settling => {
                outcome.ticks += 1;
                outcome.digest.add(interpolator.set_points());
                watch.ticked(cost, interpolator.set_points());
            }
            State::Idle if done => return Ok(outcome),
            State::Idle => outcome.starved += 1,
        }
    }
    Err(Failure::Endless)
}
