//! Numbers, rings, and what judges the other tests.
mod accept;
mod decimal;
mod five_axes;
mod judge;
mod math_angle;
mod math_exact;
mod ring;
mod seeds;
