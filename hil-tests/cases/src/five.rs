//! A head with two rotary axes and its transformation: chords with Surface and with DEV, an arc that turns the tool, and
//! a way close to the direction in which the outer axis may have any angle.
use super::machines::AXES_5;
use super::run::{Failure, Outcome, Watch, drive};
use glidepath::channel::{Channel, Handles, MachineError};
use glidepath::kinematics::{CaHead, Chain, Kinematic};
use glidepath::quantity::Position;

/// The name of the case in reports.
pub const FIVE: &str = "five";

/// Identifier of the data set.
const ID: u16 = 9;

/// HD1, tool and holder below the axis of A, is 150 mm; HD2 is 80 mm.
const HEAD: CaHead = CaHead { param: [1_500_000, 800_000, 0, 0, 0, 0, 0, 0, 0] };

const TEXT: &[u8] = b"N10 G90 G00 A20 C0
N20 #KIN ID[9]
N30 #TRAFO ON
N40 G00 X0 Y0 Z0
N50 #HSC ON[SURFACE PATH_DEV 0.05]
N60 $FOR P1=1, 60, 1
N70 G01 X=20*SIN[P1] Y=20*[1-COS[P1]] CP1 F6000
N80 $ENDFOR
N90 #HSC OFF
N100 #CONTOUR MODE ON[DEV PATH_DEV 0.02]
N110 $FOR P1=61, 120, 1
N120 X=20*SIN[P1] Y=20*[1-COS[P1]] CP1
N130 $ENDFOR
N140 #CONTOUR MODE OFF
N150 G02 X20 Y10 R20 A10 C90 F3000
N160 G01 X0 Y0 A5 C0
N170 #HSC ON[SURFACE PATH_DEV 0.02]
N180 $FOR P1=1, 30, 1
N190 X=P1*0.3 A=5-P1*0.1663 C=P1*P1*0.2
N200 $ENDFOR
N210 #HSC OFF
N220 #TRAFO OFF
N230 G00 X0
M30
";

/// What an application holds.
type Split<'a, const BLOCKS: usize> = Result<Handles<'a, &'static [u8], 5, BLOCKS>, MachineError>;

#[inline(never)]
fn split<const BLOCKS: usize>(channel: &mut Channel<5, BLOCKS>) -> Split<'_, BLOCKS> {
    channel.split(&AXES_5, [Position::ZERO; 5], TEXT)
}

/// Runs the case.
///
/// # Errors
/// It was refused or does not end.
pub fn five<const BLOCKS: usize, W: Watch<5>>(
    channel: &mut Channel<5, BLOCKS>,
    watch: &mut W,
) -> Result<Outcome, Failure> {
    watch.starting();
    let refused = Failure::Session("the head is no machine of this channel");
    let Ok(chain) = Chain::ca_head(&HEAD) else { return Err(refused) };
    let Ok(kinematic) = Kinematic::new(ID, &chain, &AXES_5) else { return Err(refused) };
    let sets = [kinematic];
    let mut handles = split(channel);
    watch.started();
    match &mut handles {
        Ok(handles) => {
            handles.planner.transform_with(&sets, ID);
            drive(handles, watch)
        }
        Err(error) => Err(Failure::Machine(*error)),
    }
}
