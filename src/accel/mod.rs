//! Who is hit: one seam, several backends.
