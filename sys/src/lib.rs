//! Raw bindings to Embree 4.
