//! The operator's commands and a planner that is late: holds, override, stops, outputs.
mod actions;
mod between_programs;
mod contour_log;
mod cores;
mod dense;
mod forecast;
mod hold;
mod late;
mod lives_on;
mod operator;
mod pace;
mod pieces;
mod rt_loops;
mod sequences;
mod stall;
mod taken_back;
mod ways;
