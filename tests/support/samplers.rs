//! Every kind of sampler, for the laws.

#![allow(dead_code, reason = "each test program uses a part")]

use specula::sampling::SamplerKind;

/// Every kind, for pixels of that many samples.
pub(crate) fn kinds(spp: u32) -> [SamplerKind; 4] {
    [
        SamplerKind::Independent,
        SamplerKind::Stratified { spp },
        SamplerKind::OwenSobol,
        SamplerKind::BlueNoise { spp },
    ]
}

/// The word for a kind in a scene file.
pub(crate) fn word(kind: SamplerKind) -> &'static str {
    match kind {
        SamplerKind::Independent => "independent",
        SamplerKind::Stratified { .. } => "stratified",
        SamplerKind::OwenSobol => "sobol",
        SamplerKind::BlueNoise { .. } => "blue_noise",
    }
}
