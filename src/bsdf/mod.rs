//! Scattering at one point, untextured, in the local frame.
