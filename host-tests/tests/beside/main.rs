//! Axes and filters beside the path.
mod filters;
mod independent;
mod oscillation;
