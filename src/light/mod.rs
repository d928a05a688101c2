//! Emission and how to sample it.
