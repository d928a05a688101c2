//! From samples to pixels.
