//! Random numbers with named dimensions, warps and tables.
