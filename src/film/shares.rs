//! What pixels show, by number: how much of which object and of which material.
//!
//! Coverage is what coverage of the picture is (`sums.rs`), for each number by itself: with weights w of mean 1 and n samples of
//! which some show it, sum(w)/n over those plus (1 - mean(w)) times their part. So the coverages of a pixel sum to its alpha.

use super::aov::Aov;
use super::cryptomatte::RANKS;

/// What a sample shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Number of the object.
    pub object: u32,
    /// Number of the material.
    pub material: u32,
    /// Distance from the eye in metres.
    pub depth: f32,
}

/// What a pixel shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Shares {
    /// Of all samples the nearest, the first one of equals.
    pub(super) nearest: Option<Seen>,
    pub(super) objects: Vec<Share>,
    pub(super) materials: Vec<Share>,
}

/// One number in a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Share {
    pub(super) id: u32,
    pub(super) count: f64,
    pub(super) weight: f64,
}

impl Shares {
    /// Adds a sample of that weight.
    pub(super) fn add(&mut self, weight: f64, seen: Seen) {
        if self.nearest.is_none_or(|nearest| seen.depth < nearest.depth) {
            self.nearest = Some(seen);
        }
        for (shares, id) in [(&mut self.objects, seen.object), (&mut self.materials, seen.material)] {
            match shares.iter_mut().find(|share| share.id == id) {
                Some(share) => {
                    share.count += 1.0;
                    share.weight += weight;
                }
                None => shares.push(Share { id, count: 1.0, weight }),
            }
        }
    }

    /// Adds later samples.
    pub(super) fn merge(&mut self, later: &Self) {
        if let Some(seen) = later.nearest
            && self.nearest.is_none_or(|nearest| seen.depth < nearest.depth)
        {
            self.nearest = Some(seen);
        }
        for (shares, later) in [(&mut self.objects, &later.objects), (&mut self.materials, &later.materials)]
        {
            for &more in later {
                match shares.iter_mut().find(|share| share.id == more.id) {
                    Some(share) => {
                        share.count += more.count;
                        share.weight += more.weight;
                    }
                    None => shares.push(more),
                }
            }
        }
    }

    /// The number of what is nearest, from 1; 0 where nothing is.
    pub(super) fn id(&self, aov: Aov) -> u32 {
        self.nearest.map_or(0, |seen| 1 + if aov == Aov::MaterialId { seen.material } else { seen.object })
    }

    /// Numbers and coverages, the greatest first; of `count` samples with weights of that sum. Coverages are positive and sum to 1 at
    /// most: what a filter with negative parts makes of edges is cut.
    pub(super) fn ranked(&self, aov: Aov, (count, weights): (f64, f64)) -> Vec<(u32, f64)> {
        let shares = if aov == Aov::CryptoMaterial { &self.materials } else { &self.objects };
        let coverage = |share: &Share| share.weight / count + (1.0 - weights / count) * share.count / count;
        let mut ranked: Vec<_> = shares.iter().map(|share| (share.id, coverage(share))).collect();
        ranked.retain(|(_, coverage)| *coverage > 0.0);
        let sum: f64 = ranked.iter().map(|(_, coverage)| coverage).sum();
        ranked.iter_mut().for_each(|(_, coverage)| *coverage /= sum.max(1.0));
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        ranked.truncate(RANKS);
        ranked
    }
}
