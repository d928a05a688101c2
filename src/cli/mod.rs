//! From words to calls.
