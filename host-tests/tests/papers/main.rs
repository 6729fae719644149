//! Checks of the documents, the examples and the list of requirements.
mod conformance;
mod dialects;
mod examples;
mod front_page;
mod programs;
mod readme;
mod rows;
mod spec_programs;
mod tower;
