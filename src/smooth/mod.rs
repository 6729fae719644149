//! Smoothing of the path: what goes on between programmed blocks and the elements that are driven.
//!
//! A smoother takes programmed blocks, works on them a bounded piece per call, and hands elements on. Contour mode is the one there is.
pub mod contour;
