//! A surface of every kind, as it comes from the list that all tests share: no kind is left out.

use crate::one_of_each::{each_lobe, lobes, missing};
use crate::{Part, Table, agree, another, ask, viewer};
use specula::bsdf::{Bsdf, Spread};
use specula::math::lanes::Lanes;

struct Kinds(Vec<(&'static str, Bsdf<f32>)>);

impl Part for Kinds {
    #[inline(always)]
    fn shade<F: Lanes>(&self, table: &mut Table, input: [F; 8]) {
        let [_, _, u, v, ..] = input;
        let both = [viewer(input), another(input)];
        for (who, bsdf) in &self.0 {
            // Gaussian slopes at the ends of their distribution are known less well (`rough`).
            let numbers = [u.clamp(1e-3, 0.999), v];
            let told = each_lobe!(bsdf.spread(u), lobe => ask(&lobe, both, numbers));
            table.put_samples(who, [3e-4, 2e-3, 3e-4], told.sampled);
            for branch in told.branches.into_iter().flatten() {
                table.put_branch(who, 1e-5, branch);
            }
            table.put([who, "density"], [3e-4, 1e-3], told.pdf);
            table.put([who, "value"], [3e-4, 1e-3], told.glossy.r);
            table.put([who, "base"], [3e-4, 1e-3], told.diffuse.r);
        }
    }
}

#[test]
fn every_kind_is_the_same_at_every_width() {
    assert_eq!(missing(&lobes()), [""; 0], "kinds that are not in the list");
    agree(&Kinds(lobes()));
}
