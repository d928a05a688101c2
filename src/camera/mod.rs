//! From a film point to a ray.
