//! Random sessions of one channel from power-up on: programs one after another, single lines, refused lines,
//! aborts, changed positions and zero offsets, jog, a text or a stream, and commands during and between
//! programs. The expected result of each step is computed here, from its lines alone.
mod bench;
mod lines;
mod model;
mod steps;

use crate::beside::{BLOCKS, OVERLAYS, TAPS};
use crate::cases::machines;
use crate::cases::random::Random;
use crate::filtered::permit_filters;
use bench::Bench;
use glidepath::channel::Channel;
use glidepath::fir::Filters;
use glidepath::machine::{FilterType, MachineData, Synch, SynchTable};
use glidepath::nc::Window;
use glidepath::quantity::Position;
use steps::Session;

/// Bytes of the window of a stream.
const WINDOW: usize = 256;

/// Results of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Done {
    /// Number of completed steps.
    pub steps: usize,
    /// Ticks of all of them.
    pub ticks: usize,
    /// Lines that were refused.
    pub refused: usize,
    /// Number of aborts that ended a program.
    pub aborted: usize,
    /// Programs that ran again on a new channel, with the same set points.
    pub repeated: usize,
}

/// The machine of a seed: any slope; functions of all kinds; with filters every third one.
fn machine(seed: u64) -> MachineData<3> {
    let mut machine = machines::arbitrary::<3>(seed);
    let mut random = Random::new(seed ^ 0xf117);
    machine.channel.slope_profile = (seed % 4) as u8;
    machine.channel.override_weight_prog_feed = (random.bits() % 3) as u8;
    machine.channel.corr_v_trans_jerk = true;
    machine.channel.surface = true;
    machine.channel.joins_named = random.once_in(2);
    machine.channel.exact_stop_indp = (seed / 7 % 3) as u8;
    machine.channel.m_synch = SynchTable::NONE.with(7, Synch::MvsSvs).with(8, Synch::MvsSns);
    machine.channel.h_synch = SynchTable::NONE.with(1, Synch::MnsSns);
    let filtered = seed.is_multiple_of(3);
    for axis in &mut machine.axes {
        axis.a_trans_weight = 0;
        axis.vb_max_red = axis.vb_max / 3 + 1;
        (axis.swe_neg, axis.swe_pos) = (-lines::LIMIT * 10_000, lines::LIMIT * 10_000);
        if filtered {
            permit_filters(axis, machine.channel.cycle_us);
            axis.filter.kind = FilterType::of_number((random.bits() % 5) as u8);
            axis.filter.enable = axis.filter.kind != FilterType::None;
            axis.filter.order = random.magnitude(1.0, 90.0) as u8;
            axis.filter.share = if random.once_in(2) { 100 } else { (random.bits() % 101) as u8 };
        }
    }
    machine
}

/// Runs and checks the session of a seed.
///
/// # Errors
/// The first fault, with the steps before it.
pub fn session(seed: u64) -> Result<Done, String> {
    let machine = machine(seed);
    let mut random = Random::new(seed ^ 0x5e55_1045);
    let start =
        std::array::from_fn(|_| Position::from_bits(model::eighths(&mut random, 80) << model::EIGHTH));
    let streams = random.once_in(3);
    let polls = [12, 40, 1000][(random.bits() % 3) as usize];
    let mut memory: Box<Channel<3, BLOCKS, OVERLAYS>> = Box::new(Channel::new());
    let mut window = Window::<WINDOW>::new();
    let (feeder, stream) = window.split();
    let (text, first) = bench::Source::first(streams, stream);
    let session = Session::new(&machine, start, random, polls);
    let judged = if machine.axes.iter().any(|axis| axis.filter.kind != FilterType::None) {
        let mut filters: Box<Filters<3, TAPS>> = Box::new(Filters::new());
        let handles = memory.split_filtered(&mut filters, &machine, start, text);
        let handles = handles.map_err(|error| error.to_string())?;
        session.run(Bench::new(handles, start, first, streams.then_some(feeder)))
    } else {
        let handles = memory.split(&machine, start, text).map_err(|error| error.to_string())?;
        session.run(Bench::new(handles, start, first, streams.then_some(feeder)))
    };
    judged.map_err(|what| format!("seed {seed}: {what}"))
}
