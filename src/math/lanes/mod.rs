//! One source, any width: the SIMD vocabulary that all shading is written in.
