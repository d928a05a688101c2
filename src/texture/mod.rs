//! Values over a surface.
