//! Proves at compile time that the crate `defmt` can log every public error, and all reports of planner and
//! operator (feature `defmt`).
use crate::channel::{
    Error, GoOnError, MachineError, PlannedBlock, PositionError, Progress, ZeroOffsetError,
};
use crate::control::{Commands, Unexpected};
use crate::machine::Beyond;
use crate::machine::parameter::RangeError;
use crate::nc::{NcError, NcWarning, TextError};
use crate::path::PathError;
use crate::plan::MotionError;
use crate::queue::PlacedAction;
use crate::slope::profile::Unplannable;
use crate::technology::{Action, Function, Output};
use crate::tick::State;

const fn can_be_logged<T: defmt::Format>() {}

const _: () = {
    can_be_logged::<Beyond>();
    can_be_logged::<Error>();
    can_be_logged::<GoOnError>();
    can_be_logged::<MachineError>();
    can_be_logged::<MotionError>();
    can_be_logged::<NcError>();
    can_be_logged::<PathError>();
    can_be_logged::<PositionError>();
    can_be_logged::<RangeError>();
    can_be_logged::<TextError>();
    can_be_logged::<Unexpected>();
    can_be_logged::<Unplannable>();
    can_be_logged::<ZeroOffsetError>();

    can_be_logged::<Action>();
    can_be_logged::<Commands>();
    can_be_logged::<PlacedAction>();
    can_be_logged::<Function>();
    can_be_logged::<NcWarning>();
    can_be_logged::<Output>();
    can_be_logged::<PlannedBlock>();
    can_be_logged::<Progress>();
    can_be_logged::<State>();
};
