//! From rays to radiance.
