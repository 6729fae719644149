//! Number types, rings, and the checkers of the other tests.
mod accept;
mod decimal;
mod five_axes;
mod judge;
mod math_angle;
mod math_exact;
mod ring;
mod seeds;
