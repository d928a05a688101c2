//! Tiles, threads and dispatch.
