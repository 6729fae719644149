//! Geometry over distance; knows nothing of time.
