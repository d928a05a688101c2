//! Errors and places in files.
