//! Rays, hits and shapes.
