//! From files to a frozen scene.
