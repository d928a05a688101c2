//! Texture and BSDF at an interaction.
