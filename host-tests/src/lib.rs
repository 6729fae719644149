//! Reference and helpers of the tests.
