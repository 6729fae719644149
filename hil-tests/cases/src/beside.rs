//! Filters behind the path and axes beside it, in one channel that has both: the same path each time, and what
//! each of them adds.
use super::AXES_3;
use super::run::{Failure, Outcome, Watch, drive};
use glidepath::channel::{Channel, FilteredHandles, MachineError};
use glidepath::fir::Filters;
use glidepath::machine::{FilterData, FilterType, MachineData};
use glidepath::quantity::Position;

/// Axes that may move beside the path.
pub const OVERLAYS: usize = 2;

/// Highest order of the filters and one.
pub const TAPS: usize = 48;

/// Memory of the filters.
pub type FilterMemory = Filters<3, TAPS>;

/// A program for a channel with filters and overlays.
pub struct BesideCase {
    /// Its name in reports.
    pub name: &'static str,
    text: &'static [u8],
    /// Type and order of the filters of all axes, if they are on from the start.
    filter: Option<(FilterType, u8)>,
}

/// What all of them run; axes X and Y alone.
macro_rules! path {
    ($before:literal) => {
        concat!(
            $before,
            "N10 G01 X20 Y5 F12000\nN20 X40 Y30\nN30 G02 X60 Y50 I20 J0\nN40 G01 X0 Y0\n",
            "N50 X80 Y-3 F4000\nN60 X0 Y0\nM30\n"
        )
        .as_bytes()
    };
}

/// Everything at once: kernels that differ per axis and change, AX_DEV, an oscillation that another one ends,
/// one that the program ends, independent axes.
const ALL: &[u8] = b"N10 G01 X20 Y5 F12000
N20 #FILTER ON [AX_DEV=0.01]
N30 Z[OSC ON 1ST_POS=-3 2ND_POS=4 FREQ=2.7 1ST_DELT=0.05]
N40 X40 Y30
N50 G02 X60 Y50 I20 J0
N60 Z[OSC ON 1ST_POS=1 2ND_POS=-1 TIME=0.31]
N70 G01 X0 Y0
N80 #FILTER [ORDER=41 SHARE=80 AX_DEV=0]
N90 X[INDP_ASYN G01 G90 POS=30 FEED=5000]
N100 G01 Y9 F3000
N110 Z[OSC OFF FEED=4000]
N120 Y[INDP_SYN G00 G90 POS=-4 SLOPE_TYPE=SIN2]
N130 #WAIT INDP ALL
N140 #FILTER OFF
N150 X3 Y3 Z3
N160 #FILTER ON [ORDER=20]
N170 X[OSC ON ZERO_POS=5 EXCUR=2 FREQ=5 NBR_OSC=7]
N180 Y-20
N190 Z0
M30
";

/// The cases, the path alone first.
pub const CASES_BESIDE: [BesideCase; 5] = [
    BesideCase { name: "beside_nothing", text: path!(""), filter: None },
    // 32 taps each.
    BesideCase { name: "beside_taps", text: path!(""), filter: Some((FilterType::Gauss, 31)) },
    BesideCase { name: "beside_mean", text: path!(""), filter: Some((FilterType::Average, 31)) },
    BesideCase {
        name: "beside_oscillation",
        text: path!("N5 Z[OSC ON 1ST_POS=-3 2ND_POS=4 FREQ=2.7]\n"),
        filter: None,
    },
    BesideCase { name: "beside_all", text: ALL, filter: None },
];

const fn machine(case: &BesideCase) -> MachineData<3> {
    let mut machine = AXES_3;
    let [x, y, z] = &mut machine.axes;
    match case.filter {
        Some((kind, order)) => {
            let filter = FilterData { enable: true, kind, order, ..FilterData::NONE };
            (x.filter, y.filter, z.filter) = (filter, filter, filter);
        }
        None => {
            x.filter = FilterData { kind: FilterType::Gauss, order: 30, ..FilterData::NONE };
            y.filter = FilterData { kind: FilterType::Average, order: 21, ..FilterData::NONE };
            z.filter = FilterData { kind: FilterType::Sinc, order: 24, ..FilterData::NONE };
        }
    }
    machine
}

/// What an application holds.
type Split<'a, const BLOCKS: usize> =
    Result<FilteredHandles<'a, &'static [u8], 3, BLOCKS, TAPS, OVERLAYS>, MachineError>;

#[inline(never)]
fn split<'a, const BLOCKS: usize>(
    channel: &'a mut Channel<3, BLOCKS, OVERLAYS>,
    filters: &'a mut FilterMemory,
    machine: &'a MachineData<3>,
    text: &'static [u8],
) -> Split<'a, BLOCKS> {
    channel.split_filtered(filters, machine, [Position::ZERO; 3], text)
}

/// Runs a case.
///
/// # Errors
/// It was refused or does not end.
pub fn beside<const BLOCKS: usize, W: Watch<3>>(
    channel: &mut Channel<3, BLOCKS, OVERLAYS>,
    filters: &mut FilterMemory,
    case: &BesideCase,
    watch: &mut W,
) -> Result<Outcome, Failure> {
    watch.starting();
    let machine = machine(case);
    let mut handles = split(channel, filters, &machine, case.text);
    watch.started();
    match &mut handles {
        Ok(handles) => drive(handles, watch),
        Err(error) => Err(Failure::Machine(*error)),
    }
}
