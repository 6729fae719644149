//! The reference: f64, written from the formulas, slow and obvious.

pub mod geometry;

pub mod knees;

pub mod profile;

pub mod limits;

pub mod merge;

pub mod brief;

pub mod worth;

pub mod planner;

pub mod stop;

pub mod motion;

pub mod optimum;
