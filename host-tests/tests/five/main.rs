//! Programs on machines with rotary axes, under a transformation.
mod transformed;
