//! Carries out the commands for transformations (feature `kinematics`): `#KIN ID` and `#TRAFO`. Also names
//! the commands that are refused while a transformation is active.
use super::{Error, Planner};
use crate::fir::FilterPlan;
use crate::kinematics::Kinematic;
use crate::nc::{Command, Head, Kinematics, Text};
use crate::plan::{Split, SwitchError};
use crate::quantity::Position;

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Sets the transformations of the machine, and the number of the default transformation (P-CHAN-00032
    /// `kinematik_id`); 0 for none. Call this function before the first [`Self::poll`].
    pub fn transform_with(&mut self, sets: &'a [Kinematic], default_id: u16) {
        self.planning.set_kinematics(sets, default_id);
    }

    /// The transformation that is active for the lines read next; `None` without a transformation. While a
    /// transformation is active, [`Self::position`] returns the tool tip in place of the main axes.
    pub fn kinematic(&self) -> Option<&'a Kinematic> {
        self.planning.kinematic()
    }

    /// How many elements of the path were transformed since [`crate::Channel::split`], and into how many
    /// polynomials.
    pub fn split(&self) -> Split {
        self.planning.split()
    }

    /// Changes the transformation, if the program demands a change. Returns whether the transformation
    /// changed.
    #[inline(never)]
    pub(super) fn switches(&mut self) -> bool {
        let switches = self.planning.switches();
        if switches {
            self.decoder.stand_at(*self.planning.position());
        }
        switches
    }

    /// Carries out `#KIN ID` and `#TRAFO`.
    #[inline(never)]
    pub(super) fn transform(&mut self, head: &Head, command: Kinematics) -> Result<(), Error> {
        if !self.planning.has_kinematics() {
            // OFF needs no condition.
            let off = command == Kinematics::Off;
            return if off { Ok(()) } else { Err(Error::NotEnabled(head.place, NEEDS)) };
        }
        let refused = |error: SwitchError| Error::Transformation(head.place, error);
        match command {
            Kinematics::Select(id) => return self.planning.select(id).map_err(refused),
            Kinematics::OnWith(id) => self.planning.select(id).map_err(refused)?,
            Kinematics::On => {}
            Kinematics::Off => {
                self.planning.switch_off();
                self.join(u32::MAX);
                return Ok(());
            }
        }
        let kinematic = self.planning.switch_on().map_err(refused)?;
        if (0..AXES).any(|axis| kinematic.has(axis) && self.released & 1u32.wrapping_shl(axis as u32) != 0) {
            self.planning.forget_switch();
            return Err(Error::NotEnabled(head.place, RELEASED));
        }
        self.join(u32::MAX);
        Ok(())
    }

    /// Whether a command is permitted while this transformation is active.
    ///
    /// # Errors
    /// The command moves or gives away an axis of the chain.
    #[inline(never)]
    pub(super) fn check_under(&self, command: &Command<AXES>) -> Result<(), Error> {
        let Some(kinematic) = self.planning.kinematic() else { return Ok(()) };
        let (place, message) = (
            command.place(),
            match command {
                Command::Oscillation(_, oscillation) => {
                    let axis = oscillation.axis;
                    if !kinematic.has(axis) || kinematic.is_cartesian_z(axis) {
                        return Ok(());
                    }
                    OSCILLATES
                }
                Command::Independent(_, independent) if kinematic.has(independent.axis) => MOVES,
                Command::PutAxes(_, axes) if (0..AXES).any(|k| kinematic.has(k) && axes >> k & 1 == 1) => {
                    GIVES
                }
                _ => return Ok(()),
            },
        );
        Err(Error::NotEnabled(place, message))
    }

    /// Tells the decoder the end position of a single motion: the position of the axis, or the tool tip that
    /// the axis has moved.
    pub(super) fn learn(&mut self, axis: usize, position: Position) {
        if self.planning.is_transformed() {
            self.decoder.stand_at(*self.planning.position());
        } else {
            self.decoder.set_position(axis, position);
        }
    }
}

const NEEDS: &str =
    "#KIN ID and #TRAFO need a data set of the machine; expected trafo[] in the channel (P-CHAN-00262)";

const RELEASED: &str =
    "#TRAFO while an axis of the transformation is released by #PUT AX; expected #CALL AX before it";

const OSCILLATES: &str = "under a transformation only an axis along machine z of a machine with linear axes at right angles oscillates; expected #TRAFO OFF before";

const MOVES: &str = "an independent motion of an axis of the transformation; expected #TRAFO OFF before it";

const GIVES: &str = "#PUT AX of an axis of the transformation; expected #TRAFO OFF before it";
