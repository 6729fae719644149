//! Programs on machines with rotary axes, under a transformation.
mod ex28;
mod oscillation;
mod singular;
mod sphere;
mod transformed;
