//! Pixels, colour, and the files that hold them.
