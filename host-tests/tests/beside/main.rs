//! Single axes, and filters of the axes.
mod filters;
mod independent;
mod oscillation;
