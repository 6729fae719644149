//! Integer arithmetic that is the same everywhere.
